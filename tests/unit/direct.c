/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes with coefficients: extinction and emission as they are. */
#include "support.h"

#include <float.h>

enum { W = 24, H = 18, PIXELS = W * H, MOST = 9 };
static const uint32_t all_channels = TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH |
                                     TETCAST_CHANNEL_TRANSMITTANCE | TETCAST_CHANNEL_PATH_LENGTH;

/* Values of one coefficient. */
typedef struct Values {
  const double *data;
  TetcastAssociation association;
} Values;

typedef struct World {
  Fixture fixture;
  Cube cube;
  TetcastVolume *volume;
  TetcastScene *scene;
} World;

/* A cube of n³ cells, all coordinates times `scale`. */
static void world_begin(World *world, int n, double jitter, double scale, TetcastTraversal traversal, int threads) {
  assert_int_equal(fixture_begin(&world->fixture, threads, 0), TETCAST_OK);
  world->cube = cube_create(n, jitter);
  for (int64_t i = 0; i < 3 * world->cube.vertex_count; ++i)
    world->cube.vertices[i] *= scale;
  TetcastMesh *mesh = cube_mesh(world->fixture.context, &world->cube);
  world->volume = volume_of(world->fixture.context, mesh, traversal);
  tetcast_mesh_destroy(&mesh);
  assert_int_equal(tetcast_scene_create(world->fixture.context, world->volume, &world->scene), TETCAST_OK);
}

static void world_end(World *world) {
  tetcast_scene_destroy(&world->scene);
  tetcast_volume_destroy(&world->volume);
  cube_destroy(&world->cube);
  fixture_end(&world->fixture);
}

static TetcastStatus set(World *world, const Values *extinction, int extinction_count, const Values *emission,
                         int emission_count) {
  TetcastField *fields[2][MOST];
  const Values *const values[2] = {extinction, emission};
  const int counts[2] = {extinction_count, emission_count};
  for (int l = 0; l < 2; ++l) {
    for (int i = 0; i < counts[l]; ++i) {
      const bool point = values[l][i].association == TETCAST_POINT;
      fields[l][i] = field_of(world->fixture.context, values[l][i].data,
                              point ? world->cube.vertex_count : world->cube.cell_count, values[l][i].association);
    }
  }
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = (const TetcastField *const *)fields[0];
  desc.emission = (const TetcastField *const *)fields[1];
  desc.extinction_count = extinction_count;
  desc.emission_count = emission_count;
  const TetcastStatus status = tetcast_scene_set_coefficients(world->scene, &desc);
  for (int l = 0; l < 2; ++l) {
    for (int i = 0; i < counts[l]; ++i)
      tetcast_field_destroy(&fields[l][i]);
  }
  return status;
}

/* Sets coefficients of one group; NULL: none. */
static void set_one(World *world, const double *extinction, const double *emission, TetcastAssociation association) {
  const Values k = {extinction, association}, j = {emission, association};
  assert_int_equal(set(world, &k, extinction != NULL, &j, emission != NULL), TETCAST_OK);
}

static double *constant(int64_t count, double value) {
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = value;
  return values;
}

/* Looks down at the cube from above, in parallel rays, with a margin around it. */
static TetcastCamera above(double scale) {
  return (TetcastCamera){.eye = {0.5 * scale, 0.5 * scale, 3 * scale},
                         .target = {0.5 * scale, 0.5 * scale, 0},
                         .up = {0, 1, 0},
                         .projection = TETCAST_ORTHOGRAPHIC,
                         .height = 1.3 * scale};
}

static TetcastFrame *shoot(World *world, const TetcastCamera *camera, uint32_t channels, int samples) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.channels = channels;
  desc.groups = tetcast_scene_groups(world->scene);
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  TetcastRenderDesc render = render_desc();
  render.samples = samples;
  TetcastRenderStats stats;
  assert_int_equal(tetcast_scene_render(world->scene, camera, &render, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  assert_true(isnan(stats.error) == !(channels & TETCAST_CHANNEL_ERROR));
  return frame;
}

static const double *channel(const TetcastFrame *frame, TetcastChannel which) {
  return tetcast_frame_channel(frame, which);
}

static void close_to(double got, double wanted, double relative, const char *what, int pixel) {
  if (!(fabs(got - wanted) <= relative * fabs(wanted) + DBL_MIN))
    fail_msg("%s at pixel %d: %.17g, not %.17g", what, pixel, got, wanted);
}

/* Through the cube of this size, as `above` sees it. */
static bool meets(int pixel) {
  const double height = 1.3, width = height * W / H;
  const double x = (pixel % W + 0.5) / W - 0.5, y = (pixel / W + 0.5) / H - 0.5;
  return fabs(x * width) < 0.5 && fabs(y * height) < 0.5;
}

/* Thin, ordinary and opaque media, of points and of cells, by both traversals: I = j/κ (1 − e^−κL). */
static void homogeneous_cube(void **state) {
  (void)state;
  static const double extinctions[] = {0, 5e-324, 1e-300, 1e-9, 0.3, 4, 100, 1e6, 1e300, 1.7e308};
  for (int kind = 0; kind < 4; ++kind) {
    World world;
    world_begin(&world, 5, 0.6, 1, kind & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    const TetcastAssociation association = kind & 2 ? TETCAST_CELL : TETCAST_POINT;
    const int64_t count = kind & 2 ? world.cube.cell_count : world.cube.vertex_count;
    for (size_t e = 0; e < sizeof extinctions / sizeof *extinctions; ++e) {
      const double k = extinctions[e], j = 2.5;
      double *extinction = constant(count, k), *emission = constant(count, j);
      set_one(&world, extinction, emission, association);
      const TetcastCamera camera = above(1);
      TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
      const double *rgba = tetcast_frame_pixels(frame);
      for (int p = 0; p < PIXELS; ++p) {
        const double length = meets(p) ? 1 : 0, shown = fmin(k, 0x1p999),
                     radiance = length == 0 ? 0
                                : k == 0    ? j
                                            : j * (-expm1(-k) / k);
        close_to(channel(frame, TETCAST_CHANNEL_PATH_LENGTH)[p], length, 2e-15, "path length", p);
        close_to(channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p], shown * length, 4e-15, "optical depth", p);
        close_to(channel(frame, TETCAST_CHANNEL_TRANSMITTANCE)[p], exp(-k * length), 2e-15 + 4e-15 * k, "transmittance",
                 p);
        if (k >= 1e300) {
          if (length > 0)
            close_to(channel(frame, TETCAST_CHANNEL_RADIANCE)[p], j / shown, 1e-14, "radiance of an opaque medium", p);
        } else {
          close_to(channel(frame, TETCAST_CHANNEL_RADIANCE)[p], radiance, 1e-14, "radiance", p);
        }
        for (int c = 0; c < 3; ++c)
          assert_true(rgba[4 * p + c] == channel(frame, TETCAST_CHANNEL_RADIANCE)[p]);
        close_to(rgba[4 * p + 3], -expm1(-k * length), 5e-15, "alpha", p);
      }
      tetcast_frame_destroy(&frame);
      free(extinction);
      free(emission);
    }
    world_end(&world);
  }
}

/* Through more cells than are summed up at a time; and what lies behind an optical depth of 746 can't be seen, however
 * bright it is, whether the ray goes on or not. */
static void long_rays(void **state) {
  (void)state;
  World world;
  world_begin(&world, 30, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 2);
  const int64_t count = world.cube.vertex_count;
  const TetcastCamera camera = above(1);
  double *extinction = constant(count, 4), *emission = constant(count, 2.5);
  set_one(&world, extinction, emission, TETCAST_POINT);
  TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
  for (int p = 0; p < PIXELS; ++p) {
    if (!meets(p))
      continue;
    close_to(channel(frame, TETCAST_CHANNEL_RADIANCE)[p], -2.5 * expm1(-4) / 4, 1e-13, "radiance", p);
    close_to(channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p], 4, 1e-13, "optical depth", p);
    close_to(channel(frame, TETCAST_CHANNEL_PATH_LENGTH)[p], 1, 1e-15, "path length", p);
  }
  tetcast_frame_destroy(&frame);
  for (int64_t i = 0; i < count; ++i) {
    extinction[i] = 1000;
    emission[i] = world.cube.vertices[3 * i + 2] < 0.2 ? 1e300 : 0;
  }
  set_one(&world, extinction, emission, TETCAST_POINT);
  frame = shoot(&world, &camera, all_channels, 1);
  TetcastFrame *shorter = shoot(&world, &camera, TETCAST_CHANNEL_RADIANCE, 1);
  for (int p = 0; p < PIXELS; ++p) {
    assert_true(channel(frame, TETCAST_CHANNEL_RADIANCE)[p] == 0 && channel(shorter, TETCAST_CHANNEL_RADIANCE)[p] == 0);
    if (meets(p))
      close_to(channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p], 1000, 1e-13, "optical depth", p);
  }
  tetcast_frame_destroy(&frame);
  tetcast_frame_destroy(&shorter);
  free(extinction);
  free(emission);
  world_end(&world);
}

/* Either of the two alone. The other's channels say so. */
static void one_of_the_two(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.6, 1, TETCAST_TRAVERSAL_SHELL, 2);
  double *values = constant(world.cube.vertex_count, 1.25);
  const TetcastCamera camera = above(1);
  set_one(&world, NULL, values, TETCAST_POINT);
  TetcastFrame *glow = shoot(&world, &camera, all_channels, 1);
  set_one(&world, values, NULL, TETCAST_POINT);
  TetcastFrame *shadow = shoot(&world, &camera, all_channels, 1);
  for (int p = 0; p < PIXELS; ++p) {
    const double length = meets(p) ? 1 : 0;
    close_to(channel(glow, TETCAST_CHANNEL_RADIANCE)[p], 1.25 * length, 2e-15, "emission", p);
    assert_true(channel(glow, TETCAST_CHANNEL_OPTICAL_DEPTH)[p] == 0 &&
                channel(glow, TETCAST_CHANNEL_TRANSMITTANCE)[p] == 1);
    assert_true(((const double *)tetcast_frame_pixels(glow))[4 * p + 3] == 0);
    assert_true(channel(shadow, TETCAST_CHANNEL_RADIANCE)[p] == 0);
    close_to(channel(shadow, TETCAST_CHANNEL_TRANSMITTANCE)[p], exp(-1.25 * length), 4e-15, "transmittance", p);
  }
  tetcast_frame_destroy(&glow);
  tetcast_frame_destroy(&shadow);
  free(values);
  world_end(&world);
}

/* ── linear fields, against quadrature along the chord ── */

/* ∫₀ᴸ (j0 + j' z) exp(−(k0 z + k' z²/2)) dz by the composite midpoint rule with Richardson's extrapolation, in extended
 * precision. */
static long double chord_radiance(const long double k[2], const long double j[2], long double length) {
  enum { LEVELS = 6 };
  long double table[LEVELS];
  for (int level = 0; level < LEVELS; ++level) {
    const int n = 16 << level;
    long double sum = 0;
    for (int i = 0; i < n; ++i) {
      const long double z = (i + 0.5L) * length / n;
      sum += (j[0] + j[1] * z) * expl(-(k[0] * z + k[1] * z * z / 2));
    }
    table[level] = sum * length / n;
    for (int back = level - 1, power = 4; back >= 0; --back, power *= 4) {
      table[back] = (power * table[back + 1] - table[back]) / (power - 1);
    }
  }
  return table[0];
}

static void linear_fields_are_exact(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 6, 0.6, 1, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    double *extinction = constant(world.cube.vertex_count, 0), *emission = constant(world.cube.vertex_count, 0);
    for (int64_t i = 0; i < world.cube.vertex_count; ++i) {
      const double *x = &world.cube.vertices[3 * i];
      extinction[i] = 0.5 * x[0] + 0.25 * x[1] + 2 * x[2]; /* nothing at a corner */
      emission[i] = 3 - x[0] - 2 * x[2];                   /* nothing at another */
    }
    set_one(&world, extinction, emission, TETCAST_POINT);
    static const double starts[] = {1, 0.37}; /* heights that rays see the mesh from: its top, and inside */
    for (int i = 0; i < 2; ++i) {
      TetcastCamera camera = above(1);
      if (starts[i] < 1)
        camera.eye[2] = starts[i];
      TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
      for (int p = 0; p < PIXELS; ++p) {
        if (!meets(p))
          continue;
        const long double x = 0.5L + 1.3L * W / H * ((p % W + 0.5L) / W - 0.5L),
                          y = 0.5L - 1.3L * ((p / W + 0.5L) / H - 0.5L), z = starts[i];
        const long double k[2] = {0.5L * x + 0.25L * y + 2 * z, -2}, j[2] = {3 - x - 2 * z, 2}; /* downwards */
        close_to(channel(frame, TETCAST_CHANNEL_RADIANCE)[p], (double)chord_radiance(k, j, z), 2e-14, "radiance", p);
        close_to(channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p], (double)(k[0] * z - z * z), 1e-14, "optical depth",
                 p);
        close_to(channel(frame, TETCAST_CHANNEL_PATH_LENGTH)[p], starts[i], 2e-15, "path length", p);
      }
      tetcast_frame_destroy(&frame);
    }
    free(extinction);
    free(emission);
    world_end(&world);
  }
}

/* ── groups ── */

static double *random_values(int64_t count, uint64_t *seed, double low, double high) {
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = uniform(seed) < 0.1 ? 0 : power(seed, low, high);
  return values;
}

/* Coefficients of points and cells mixed, thin and opaque groups together, a group with NaN: each as if it were alone,
 * for any number of threads and samples. */
static void groups_are_single_runs(void **state) {
  (void)state;
  enum { GROUPS = 5 };
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 7, 0.5, 1, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 3);
    uint64_t seed = 11;
    Values extinction[GROUPS], emission[GROUPS];
    for (int g = 0; g < GROUPS; ++g) {
      const TetcastAssociation a = g % 2 ? TETCAST_CELL : TETCAST_POINT, b = g % 3 ? TETCAST_POINT : TETCAST_CELL;
      extinction[g] =
          (Values){random_values(a == TETCAST_CELL ? world.cube.cell_count : world.cube.vertex_count, &seed, -2, g), a};
      emission[g] = (Values){random_values(b == TETCAST_CELL ? world.cube.cell_count : world.cube.vertex_count, &seed,
                                           -3, 300.0 * (g == 2)),
                             b};
    }
    ((double *)extinction[2].data)[100] = NAN;
    ((double *)emission[4].data)[80] = -INFINITY;
    const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    for (int shared = 0; shared < 2; ++shared) {
      assert_int_equal(set(&world, extinction, shared ? 1 : GROUPS, emission, GROUPS), TETCAST_OK);
      assert_int_equal(tetcast_scene_groups(world.scene), GROUPS);
      /* Without depth and path, rays end when all groups are opaque; with them, they don't. */
      TetcastFrame *all = shoot(&world, &camera, all_channels, 3),
                   *few = shoot(&world, &camera, TETCAST_CHANNEL_RADIANCE, 3);
      assert_memory_equal(channel(all, TETCAST_CHANNEL_RADIANCE), channel(few, TETCAST_CHANNEL_RADIANCE),
                          PIXELS * GROUPS * sizeof(double));
      assert_memory_equal(tetcast_frame_pixels(all), tetcast_frame_pixels(few), PIXELS * 4 * sizeof(double));
      tetcast_context_set_threads(world.fixture.context, 1);
      for (int g = 0; g < GROUPS; ++g) {
        assert_int_equal(set(&world, &extinction[shared ? 0 : g], 1, &emission[g], 1), TETCAST_OK);
        TetcastFrame *one =
            shoot(&world, &camera, g & 1 ? all_channels : all_channels & ~(uint32_t)TETCAST_CHANNEL_PATH_LENGTH, 3);
        for (int p = 0; p < PIXELS; ++p) {
          assert_true(channel(all, TETCAST_CHANNEL_RADIANCE)[p * GROUPS + g] ==
                      channel(one, TETCAST_CHANNEL_RADIANCE)[p]);
          assert_true(channel(all, TETCAST_CHANNEL_OPTICAL_DEPTH)[p * GROUPS + g] ==
                      channel(one, TETCAST_CHANNEL_OPTICAL_DEPTH)[p]);
          assert_true(channel(all, TETCAST_CHANNEL_TRANSMITTANCE)[p * GROUPS + g] ==
                      channel(one, TETCAST_CHANNEL_TRANSMITTANCE)[p]);
        }
        tetcast_frame_destroy(&one);
      }
      tetcast_context_set_threads(world.fixture.context, 3);
      tetcast_frame_destroy(&all);
      tetcast_frame_destroy(&few);
    }
    for (int g = 0; g < GROUPS; ++g) {
      free((double *)extinction[g].data);
      free((double *)emission[g].data);
    }
    world_end(&world);
  }
}

/* The walk against the cells one by one, also from within the mesh. */
static void traversals_agree(void **state) {
  (void)state;
  static const double eyes[][3] = {{2.1, 1.7, 3.3}, {0.43, 0.52, 0.61}, {3, 3, 3}};
  World worlds[2];
  uint64_t seed = 3;
  double *extinction = NULL, *emission = NULL;
  for (int i = 0; i < 2; ++i) {
    world_begin(&worlds[i], 7, 0.5, 1, i ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    if (!extinction)
      extinction = random_values(worlds[i].cube.vertex_count, &seed, -2, 2);
    if (!emission)
      emission = random_values(worlds[i].cube.vertex_count, &seed, -3, 0);
    set_one(&worlds[i], extinction, emission, TETCAST_POINT);
  }
  for (int c = 0; c < 3; ++c) {
    const TetcastCamera camera = camera_of(eyes[c][0], eyes[c][1], eyes[c][2], 0.5, 0.45, 0.4);
    TetcastFrame *walked = shoot(&worlds[0], &camera, all_channels, 1),
                 *tested = shoot(&worlds[1], &camera, all_channels, 1);
    for (int bit = TETCAST_CHANNEL_RADIANCE; bit <= TETCAST_CHANNEL_PATH_LENGTH; bit *= 2) {
      const double *a = channel(walked, (TetcastChannel)bit), *b = channel(tested, (TetcastChannel)bit);
      for (int p = 0; p < PIXELS; ++p)
        close_to(a[p], b[p], 1e-12 * (1 + (bit == TETCAST_CHANNEL_TRANSMITTANCE ? -log(b[p] + DBL_MIN) : 0)),
                 "shell and faces", p);
    }
    tetcast_frame_destroy(&walked);
    tetcast_frame_destroy(&tested);
  }
  free(extinction);
  free(emission);
  world_end(&worlds[0]);
  world_end(&worlds[1]);
}

/* A mesh in another unit of length, with coefficients in that unit: powers of two change no bit, and nothing overflows
 * on the way. */
static void units_scale_exactly(void **state) {
  (void)state;
  static const int exponents[] = {0, 1, -7, 300, -300, 900, -900};
  TetcastFrame *reference = NULL;
  World worlds[sizeof exponents / sizeof *exponents];
  for (size_t i = 0; i < sizeof exponents / sizeof *exponents; ++i) {
    World *world = &worlds[i];
    const double scale = ldexp(1, exponents[i]);
    world_begin(world, 6, 0.5, scale, TETCAST_TRAVERSAL_SHELL, 2);
    uint64_t seed = 9;
    double *extinction = random_values(world->cube.vertex_count, &seed, -2, 2),
           *emission = random_values(world->cube.vertex_count, &seed, -3, 3);
    for (int64_t v = 0; v < world->cube.vertex_count; ++v)
      extinction[v] /= scale;
    set_one(world, extinction, emission, TETCAST_POINT);
    const TetcastCamera camera = above(scale);
    TetcastFrame *frame = shoot(world, &camera, all_channels, 1);
    if (!reference)
      reference = frame;
    for (int p = 0; p < PIXELS; ++p) {
      assert_true(channel(frame, TETCAST_CHANNEL_RADIANCE)[p] ==
                  scale * channel(reference, TETCAST_CHANNEL_RADIANCE)[p]);
      assert_true(channel(frame, TETCAST_CHANNEL_PATH_LENGTH)[p] ==
                  scale * channel(reference, TETCAST_CHANNEL_PATH_LENGTH)[p]);
      assert_true(channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p] ==
                  channel(reference, TETCAST_CHANNEL_OPTICAL_DEPTH)[p]);
      assert_true(channel(frame, TETCAST_CHANNEL_TRANSMITTANCE)[p] ==
                  channel(reference, TETCAST_CHANNEL_TRANSMITTANCE)[p]);
    }
    if (frame != reference)
      tetcast_frame_destroy(&frame);
    free(extinction);
    free(emission);
  }
  tetcast_frame_destroy(&reference);
  for (size_t i = 0; i < sizeof exponents / sizeof *exponents; ++i)
    world_end(&worlds[i]);
}

/* Spikes next to nothing, of both coefficients: nothing is NaN, infinite, negative or above what is possible. */
static void extremes(void **state) {
  (void)state;
  static const double values[] = {0, 5e-324, 1e-310, 1e-160, 1e-9, 1, 1e9, 1e160, 1e300, 1.79e308};
  enum { N = sizeof values / sizeof *values };
  for (int kind = 0; kind < 4; ++kind) {
    World world;
    world_begin(&world, 6, 0.6, 1, kind & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    const TetcastAssociation association = kind & 2 ? TETCAST_CELL : TETCAST_POINT;
    const int64_t count = kind & 2 ? world.cube.cell_count : world.cube.vertex_count;
    double *extinction = constant(count, 0), *emission = constant(count, 0);
    uint64_t seed = 17;
    for (int64_t i = 0; i < count; ++i) {
      extinction[i] = values[(int)(N * uniform(&seed))];
      emission[i] = values[(int)(N * uniform(&seed))];
    }
    set_one(&world, extinction, emission, association);
    const TetcastCamera camera = above(1);
    TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
    for (int p = 0; p < PIXELS; ++p) {
      const double radiance = channel(frame, TETCAST_CHANNEL_RADIANCE)[p],
                   depth = channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p];
      const double transmittance = channel(frame, TETCAST_CHANNEL_TRANSMITTANCE)[p];
      assert_true(radiance >= 0 && radiance <= DBL_MAX && depth >= 0 && depth <= DBL_MAX && transmittance >= 0 &&
                  transmittance <= 1);
    }
    tetcast_frame_destroy(&frame);
    free(extinction);
    free(emission);
    world_end(&world);
  }
}

/* As bright, and as dense, as a double can be, everywhere: values above 2^1022 count as that. */
static void largest_values(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.6, 1, TETCAST_TRAVERSAL_SHELL, 2);
  double *values = constant(world.cube.vertex_count, DBL_MAX);
  const TetcastCamera camera = above(1);
  for (int absorbs = 0; absorbs < 2; ++absorbs) {
    set_one(&world, absorbs ? values : NULL, values, TETCAST_POINT);
    TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
    for (int p = 0; p < PIXELS; ++p) {
      const double wanted = !meets(p) ? 0 : absorbs ? 0x1p1022 / 0x1p999 : 0x1p1022;
      close_to(channel(frame, TETCAST_CHANNEL_RADIANCE)[p], wanted, 4e-15, "radiance", p);
    }
    tetcast_frame_destroy(&frame);
  }
  free(values);
  world_end(&world);
}

/* A vertex whose extinction or emission is not a number, or infinite: the cells at it are left out, as cells of nothing
 * are. */
static void values_that_are_not_finite(void **state) {
  (void)state;
  static const double bad[] = {NAN, INFINITY, -INFINITY};
  World world;
  world_begin(&world, 5, 0.6, 1, TETCAST_TRAVERSAL_SHELL, 2);
  const int64_t points = world.cube.vertex_count, cells = world.cube.cell_count, vertex = 100;
  double *k = constant(points, 2), *j = constant(points, 3), *cell_k = constant(cells, 2), *cell_j = constant(cells, 3);
  for (int64_t i = 0; i < 4 * cells; ++i) {
    if (world.cube.cells[i] == vertex)
      cell_k[i / 4] = cell_j[i / 4] = 0;
  }
  const TetcastCamera camera = above(1);
  set_one(&world, cell_k, cell_j, TETCAST_CELL);
  TetcastFrame *wanted = shoot(&world, &camera, all_channels, 1);
  int holes = 0;
  for (int i = 0; i < 6; ++i) {
    double *values = i % 2 ? k : j;
    const double kept = values[vertex];
    values[vertex] = bad[i / 2];
    set_one(&world, k, j, TETCAST_POINT);
    values[vertex] = kept;
    TetcastFrame *frame = shoot(&world, &camera, all_channels, 1);
    for (int bit = TETCAST_CHANNEL_RADIANCE; bit <= TETCAST_CHANNEL_PATH_LENGTH; bit *= 2) {
      for (int p = 0; p < PIXELS; ++p) {
        close_to(channel(frame, (TetcastChannel)bit)[p], channel(wanted, (TetcastChannel)bit)[p], 1e-13, "a hole", p);
      }
    }
    for (int p = 0; p < PIXELS; ++p)
      holes += meets(p) && channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH)[p] < 1.99;
    tetcast_frame_destroy(&frame);
  }
  assert_true(holes > 6);
  tetcast_frame_destroy(&wanted);
  free(k);
  free(j);
  free(cell_k);
  free(cell_j);
  world_end(&world);
}

/* A negative emission takes away what the same positive one brings. */
static void emission_is_linear(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 2);
  uint64_t seed = 5;
  double *extinction = random_values(world.cube.vertex_count, &seed, -1, 1),
         *emission = random_values(world.cube.vertex_count, &seed, -1, 1);
  const TetcastCamera camera = above(1);
  set_one(&world, extinction, emission, TETCAST_POINT);
  TetcastFrame *plus = shoot(&world, &camera, all_channels, 1);
  for (int64_t i = 0; i < world.cube.vertex_count; ++i)
    emission[i] = -emission[i];
  set_one(&world, extinction, emission, TETCAST_POINT);
  TetcastFrame *minus = shoot(&world, &camera, all_channels, 1);
  for (int p = 0; p < PIXELS; ++p) {
    assert_true(channel(plus, TETCAST_CHANNEL_RADIANCE)[p] == -channel(minus, TETCAST_CHANNEL_RADIANCE)[p]);
    assert_true(meets(p) == (channel(plus, TETCAST_CHANNEL_RADIANCE)[p] > 0));
  }
  tetcast_frame_destroy(&plus);
  tetcast_frame_destroy(&minus);
  free(extinction);
  free(emission);
  world_end(&world);
}

/* More groups than a vector has lanes, and not a multiple of them: what lies behind the last one in memory, here
 * emission that would be no extinction at all, stays out of it. */
static void lanes_beyond_the_last_group(void **state) {
  (void)state;
  World world;
  world_begin(&world, 12, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 2);
  Values extinction[MOST], emission[MOST];
  uint64_t seed = 3;
  for (int g = 0; g < MOST; ++g) {
    double *values = constant(world.cube.vertex_count, 0);
    for (int64_t i = 0; i < world.cube.vertex_count; ++i)
      values[i] = 300 * (uniform(&seed) - 0.5);
    extinction[g] = (Values){constant(world.cube.vertex_count, 40), TETCAST_POINT};
    emission[g] = (Values){values, TETCAST_POINT};
  }
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  assert_int_equal(set(&world, extinction, MOST, emission, MOST), TETCAST_OK);
  TetcastFrame *all = shoot(&world, &camera, all_channels, 64);
  assert_int_equal(set(&world, &extinction[MOST - 1], 1, &emission[MOST - 1], 1), TETCAST_OK);
  TetcastFrame *last = shoot(&world, &camera, all_channels, 64);
  for (int p = 0; p < PIXELS; ++p)
    assert_true(fabs(channel(all, TETCAST_CHANNEL_RADIANCE)[MOST * p + MOST - 1] -
                     channel(last, TETCAST_CHANNEL_RADIANCE)[p]) < 1e-13);
  tetcast_frame_destroy(&all);
  tetcast_frame_destroy(&last);
  for (int g = 0; g < MOST; ++g) {
    free((double *)extinction[g].data);
    free((double *)emission[g].data);
  }
  world_end(&world);
}

/* Three groups are red, green and blue; another number is grey, their mean. */
static void colors(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 1);
  Values extinction[4], emission[4];
  for (int g = 0; g < 4; ++g) {
    extinction[g] = (Values){constant(world.cube.vertex_count, 0.5 * g), TETCAST_POINT};
    emission[g] = (Values){constant(world.cube.vertex_count, 1 << g), TETCAST_POINT};
  }
  const TetcastCamera camera = above(1);
  const int middle = H / 2 * W + W / 2;
  assert_int_equal(set(&world, &extinction[1], 1, emission, 3), TETCAST_OK);
  TetcastFrame *frame = shoot(&world, &camera, 0, 1);
  const double *pixel = (const double *)tetcast_frame_pixels(frame) + 4 * middle, once = -expm1(-0.5) / 0.5;
  for (int g = 0; g < 3; ++g)
    close_to(pixel[g], (1 << g) * once, 1e-14, "colour", g);
  close_to(pixel[3], -expm1(-0.5), 1e-14, "alpha", middle);
  tetcast_frame_destroy(&frame);
  assert_int_equal(set(&world, extinction, 4, &emission[2], 1), TETCAST_OK);
  frame = shoot(&world, &camera, 0, 1);
  pixel = (const double *)tetcast_frame_pixels(frame) + 4 * middle;
  double mean = 1, opacity = 0;
  for (int g = 1; g < 4; ++g) {
    mean += -expm1(-0.5 * g) / (0.5 * g);
    opacity += -expm1(-0.5 * g);
  }
  for (int k = 0; k < 3; ++k)
    close_to(pixel[k], mean, 1e-14, "mean", k); /* of four, times the emission of four */
  close_to(pixel[3], opacity / 4, 1e-14, "mean opacity", middle);
  tetcast_frame_destroy(&frame);
  for (int g = 0; g < 4; ++g) {
    free((double *)extinction[g].data);
    free((double *)emission[g].data);
  }
  world_end(&world);
}

/* ── what is refused ── */

static void refuse(World *world, TetcastStatus got, TetcastStatus wanted, const char *text) {
  assert_int_equal(got, wanted);
  if (!strstr(world->fixture.message, text))
    fail_msg("'%s' is missing in '%s'", text, world->fixture.message);
}

static TetcastStatus shoot_bad(World *world, uint32_t channels, int groups, TetcastIntegrator integrator) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 2;
  desc.channels = channels;
  desc.groups = groups;
  TetcastFrame *frame = NULL;
  TetcastStatus status = tetcast_frame_create(world->fixture.context, &desc, &frame);
  if (status)
    return status;
  const TetcastCamera camera = above(1);
  TetcastRenderDesc render = tetcast_render_desc_default();
  render.integrator = integrator;
  status = tetcast_scene_render(world->scene, &camera, &render, frame, NULL);
  tetcast_frame_destroy(&frame);
  return status;
}

static void bad_coefficients_are_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL, 1);
  double *values = constant(world.cube.cell_count, 1);
  Values list[MOST];
  for (int i = 0; i < MOST; ++i)
    list[i] = (Values){values, i % 2 ? TETCAST_CELL : TETCAST_POINT};
  refuse(&world, set(&world, NULL, 0, NULL, 0), TETCAST_ERROR_ARGUMENT, "neither extinction nor emission");
  refuse(&world, set(&world, list, 2, list, 3), TETCAST_ERROR_ARGUMENT,
         "an extinction of 2 groups with an emission of 3");
  assert_int_equal(tetcast_scene_groups(world.scene), 0);
  refuse(&world, shoot_bad(&world, 0, 1, TETCAST_INTEGRATOR_EXACT), TETCAST_ERROR_ARGUMENT, "no field yet");

  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction_count = 1;
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT, "extinction: no fields");
  TetcastField *field = NULL;
  desc.extinction = (const TetcastField *const *)&field;
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT, "group 0 is NULL");
  desc.extinction_count = TETCAST_MAX_GROUPS + 1;
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT, "at most 256");
  desc.extinction_count = -1;
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT, "at most 256");
  desc.extinction_count = 1;
  desc.extinction_name = "sigma";
  field = field_of(world.fixture.context, values, 5, TETCAST_POINT);
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT,
         "sigma has 5 values, the mesh 27 vertices");
  tetcast_field_destroy(&field);
  values[13] = -0.5;
  field = field_of(world.fixture.context, values, world.cube.vertex_count, TETCAST_POINT);
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_DATA,
         "sigma: a negative extinction, -0.5 at vertex 13");
  tetcast_field_destroy(&field);
  desc.cookie = 0;
  refuse(&world, tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_ERROR_ARGUMENT, "_default()");
  refuse(&world, set(&world, list, 4, NULL, 0), TETCAST_ERROR_DATA,
         "extinction: a negative extinction of group 0, -0.5 at vertex 13");
  refuse(&world, set(&world, &list[1], 1, NULL, 0), TETCAST_ERROR_DATA, "-0.5 at tetrahedron 13");
  assert_int_equal(tetcast_scene_groups(world.scene), 0);

  assert_int_equal(set(&world, NULL, 0, list, 2), TETCAST_OK);
  refuse(&world, set(&world, list, 1, NULL, 0), TETCAST_ERROR_DATA, "negative");
  assert_int_equal(tetcast_scene_groups(world.scene), 2); /* the scene keeps what it had */
  const TetcastIntegrator exact = TETCAST_INTEGRATOR_EXACT;
  assert_int_equal(shoot_bad(&world, 0, 1, exact), TETCAST_OK);
  assert_int_equal(shoot_bad(&world, TETCAST_CHANNEL_PATH_LENGTH, 1, exact), TETCAST_OK);
  refuse(&world, shoot_bad(&world, TETCAST_CHANNEL_RADIANCE, 1, exact), TETCAST_ERROR_ARGUMENT,
         "a frame of 1 groups, but the scene has 2");
  assert_int_equal(shoot_bad(&world, TETCAST_CHANNEL_ERROR, 2, exact), TETCAST_OK);
  refuse(&world, shoot_bad(&world, 0, 2, TETCAST_INTEGRATOR_MIDPOINT), TETCAST_ERROR_ARGUMENT,
         "only the exact integrator");
  refuse(&world, shoot_bad(&world, 1u << 31, 2, exact), TETCAST_ERROR_ARGUMENT, "unknown");
  refuse(&world, shoot_bad(&world, 0, 0, exact), TETCAST_ERROR_ARGUMENT, "0 groups");
  refuse(&world, shoot_bad(&world, 0, 257, exact), TETCAST_ERROR_ARGUMENT, "257 groups");
  free(values);
  world_end(&world);
}

/* A scene has either; the picture of each is that of a scene that never had the other. */
static void either_replaces_the_other(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 2);
  TetcastContext *context = world.fixture.context;
  const TetcastCamera camera = above(1);
  const Body body = {world.volume, field_of(context, world.cube.values, world.cube.vertex_count, TETCAST_POINT)};
  TetcastField *field = body.field;
  TetcastTransferFunction *transfer = transfer_of(context, 1);
  double *plain = picture(context, &body, transfer, &camera, W, H, NULL);
  assert_int_equal(tetcast_scene_set_field(world.scene, field), TETCAST_OK);
  tetcast_field_destroy(&field);
  set_one(&world, world.cube.values, world.cube.values, TETCAST_POINT);
  TetcastFrame *direct = shoot(&world, &camera, 0, 1);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
  assert_int_equal(tetcast_scene_groups(world.scene), 0);
  refuse(&world, shoot_bad(&world, TETCAST_CHANNEL_PATH_LENGTH, 1, TETCAST_INTEGRATOR_EXACT), TETCAST_ERROR_ARGUMENT,
         "no channel path_length");
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  const TetcastRenderDesc render = render_desc();
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_OK);
  assert_memory_equal(tetcast_frame_pixels(frame), plain, PIXELS * 4 * sizeof *plain);
  tetcast_frame_destroy(&frame);
  set_one(&world, world.cube.values, world.cube.values, TETCAST_POINT);
  TetcastFrame *again = shoot(&world, &camera, 0, 1);
  assert_memory_equal(tetcast_frame_pixels(again), tetcast_frame_pixels(direct), PIXELS * 4 * sizeof *plain);
  tetcast_frame_destroy(&direct);
  tetcast_frame_destroy(&again);
  tetcast_transfer_function_destroy(&transfer);
  free(plain);
  world_end(&world);
}

/* Each allocation fails once: a status comes back, nothing is lost. */
static void memory_may_run_out(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL, 2);
  const Values k = {world.cube.values, TETCAST_POINT};
  TetcastField *field = field_of(world.fixture.context, k.data, world.cube.vertex_count, TETCAST_POINT);
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = desc.emission = (const TetcastField *const *)&field;
  desc.extinction_count = desc.emission_count = 1;
  const TetcastCamera camera = above(1);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 8;
  frame_desc.channels = all_channels;
  int failures = 0;
  for (long i = 1; i < 40; ++i) {
    TetcastFrame *frame = NULL;
    world.fixture.fail_at = world.fixture.allocations + i;
    TetcastStatus status = tetcast_scene_set_coefficients(world.scene, &desc);
    if (!status)
      status = tetcast_frame_create(world.fixture.context, &frame_desc, &frame);
    if (!status)
      status = tetcast_scene_render(world.scene, &camera, NULL, frame, NULL);
    world.fixture.fail_at = 0;
    tetcast_frame_destroy(&frame);
    assert_true(status == TETCAST_OK || status == TETCAST_ERROR_MEMORY);
    failures += status == TETCAST_ERROR_MEMORY;
  }
  assert_true(failures >= 10);
  tetcast_field_destroy(&field);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(homogeneous_cube),
                                     cmocka_unit_test(long_rays),
                                     cmocka_unit_test(one_of_the_two),
                                     cmocka_unit_test(linear_fields_are_exact),
                                     cmocka_unit_test(groups_are_single_runs),
                                     cmocka_unit_test(traversals_agree),
                                     cmocka_unit_test(units_scale_exactly),
                                     cmocka_unit_test(extremes),
                                     cmocka_unit_test(largest_values),
                                     cmocka_unit_test(values_that_are_not_finite),
                                     cmocka_unit_test(emission_is_linear),
                                     cmocka_unit_test(lanes_beyond_the_last_group),
                                     cmocka_unit_test(colors),
                                     cmocka_unit_test(bad_coefficients_are_refused),
                                     cmocka_unit_test(either_replaces_the_other),
                                     cmocka_unit_test(memory_may_run_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
