/* SPDX-License-Identifier: Apache-2.0 */
/* Clips and stops: the two sides of a plane, composited, are the whole picture, of every kind of scene; planes beside
 * the mesh change no bit, those beyond it leave nothing; a ray in a plane is kept; rays that stop at a plane's
 * distances see what a clip leaves; no unit matters; and what the library says where it can't. How exact an interval's
 * ends are, and that the error channel contains what is off, tests/reference/bound.cpp has against a reference of its
 * own. */
#include "support.h"

enum { W = 37, H = 29, PIXELS = W * H };

typedef struct World {
  Fixture fixture;
  Cube cube;
  TetcastVolume *volume;
  TetcastScene *scene;
  double scale;
} World;

static void set_values(World *world, TetcastAssociation association) {
  const Cube *cube = &world->cube;
  const int64_t count =
      association == TETCAST_POINT ? cube->vertex_count : cube->cell_count * (association == TETCAST_CORNER ? 4 : 1);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i) {
    values[i] = association == TETCAST_POINT  ? cube->values[i]
                : association == TETCAST_CELL ? cube->values[cube->cells[4 * i]]
                                              : cube->values[cube->cells[i]] + 0.05 * (double)(i % 3);
  }
  TetcastField *field = field_of(world->fixture.context, values, count, association);
  assert_int_equal(tetcast_scene_set_field(world->scene, field), TETCAST_OK);
  tetcast_field_destroy(&field);
  free(values);
}

/* A cube whose sides are `scale` long, with a field and a transfer function for that. */
static void world_begin(World *world, double jitter, double scale, TetcastTraversal traversal,
                        TetcastAssociation association) {
  assert_int_equal(fixture_begin(&world->fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = world->fixture.context;
  world->scale = scale;
  world->cube = cube_create(5, jitter);
  for (int64_t i = 0; i < 3 * world->cube.vertex_count; ++i)
    world->cube.vertices[i] *= scale;
  TetcastMesh *mesh = cube_mesh(context, &world->cube);
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = traversal;
  desc.corners = 1;
  world->volume = NULL;
  world->scene = NULL;
  assert_int_equal(tetcast_volume_create(context, mesh, &desc, &world->volume), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(context, world->volume, &world->scene), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  TetcastTransferFunction *transfer = transfer_of(context, 1 / scale);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
  set_values(world, association);
}

static void world_end(World *world) {
  tetcast_scene_destroy(&world->scene);
  tetcast_volume_destroy(&world->volume);
  cube_destroy(&world->cube);
  fixture_end(&world->fixture);
}

/* ── pictures ── */

/* A camera around the unit cube, made for one of the world's size. */
static TetcastCamera camera_in(const World *world, TetcastCamera camera) {
  for (int k = 0; k < 3; ++k)
    camera.eye[k] *= world->scale, camera.target[k] *= world->scale;
  camera.height *= world->scale;
  return camera;
}

static TetcastCamera parallel(double x, double y, double z, double height) {
  TetcastCamera camera = camera_of(x, y, z, 0.5, 0.5, 0.5);
  camera.projection = TETCAST_ORTHOGRAPHIC;
  camera.height = height;
  return camera;
}

/* From outside, from within, in parallel from outside and within. */
static int cameras_around(const World *world, TetcastCamera cameras[4]) {
  cameras[0] = camera_in(world, camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5));
  cameras[1] = camera_in(world, camera_of(0.43, 0.52, 0.61, 1, 0.2, 0));
  cameras[2] = camera_in(world, parallel(3, 2, 4, 1.6));
  cameras[3] = camera_in(world, parallel(0.7, 0.4, 0.6, 1.6));
  return 4;
}

static TetcastFrame *shoot(World *world, const TetcastCamera *camera, uint32_t channels, const TetcastArray *stop,
                           int samples, TetcastRenderStats *stats) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.channels = channels;
  if (tetcast_scene_groups(world->scene) > 0)
    desc.groups = tetcast_scene_groups(world->scene);
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  TetcastRenderDesc render = render_desc();
  render.samples = samples;
  render.stop = stop;
  TetcastRenderStats own;
  assert_int_equal(tetcast_scene_render(world->scene, camera, &render, frame, stats ? stats : &own), TETCAST_OK);
  assert_int_equal((stats ? stats : &own)->lost, 0);
  return frame;
}

static const double *pixels_of(const TetcastFrame *frame) {
  return tetcast_frame_pixels(frame);
}

static void clip(World *world, const TetcastHalfSpace *half_spaces, int count) {
  assert_int_equal(tetcast_scene_set_clip(world->scene, half_spaces, count), TETCAST_OK);
}

static TetcastHalfSpace other_side(TetcastHalfSpace h) {
  for (int k = 0; k < 3; ++k)
    h.normal[k] = -h.normal[k];
  h.offset = -h.offset;
  return h;
}

/* Planes through the unit cube: oblique, across an axis on faces of cells and between them, a corner of it. */
static int planes_through(TetcastHalfSpace planes[4]) {
  planes[0] = (TetcastHalfSpace){{0.3, -0.7, 0.5}, 0.02};
  planes[1] = (TetcastHalfSpace){{-1e-3, 0, 0}, -0.4e-3};
  planes[2] = (TetcastHalfSpace){{0, 0, 1e200}, 0.31e200};
  planes[3] = (TetcastHalfSpace){{2, 2, 2}, 4.5};
  return 4;
}

static double side_of(const TetcastHalfSpace *h, const double p[3]) {
  return h->normal[0] * p[0] + h->normal[1] * p[1] + h->normal[2] * p[2] - h->offset;
}

/* Which of the two sides of a plane a camera's rays meet first. */
static bool is_near(const TetcastHalfSpace *h, const TetcastCamera *camera, bool *first) {
  double forward[3];
  for (int k = 0; k < 3; ++k)
    forward[k] = camera->target[k] - camera->eye[k];
  const TetcastHalfSpace direction = {{h->normal[0], h->normal[1], h->normal[2]}, 0};
  *first = camera->projection == TETCAST_ORTHOGRAPHIC ? side_of(&direction, forward) < 0 : side_of(h, camera->eye) > 0;
  return *first;
}

static void both_sides_are_the_whole(void **state) {
  (void)state;
  static const TetcastAssociation associations[] = {TETCAST_POINT, TETCAST_CELL, TETCAST_CORNER};
  for (int i = 0; i < 6; ++i) {
    World world;
    world_begin(&world, i & 2 ? 0.6 : 0, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL,
                associations[i / 2]);
    TetcastCamera cameras[4];
    TetcastHalfSpace planes[4];
    double worst = 0;
    for (int p = 0; p < planes_through(planes); ++p) {
      for (int c = 0; c < cameras_around(&world, cameras); ++c) {
        const TetcastHalfSpace back = other_side(planes[p]);
        TetcastRenderStats stats[3];
        clip(&world, NULL, 0);
        TetcastFrame *whole = shoot(&world, &cameras[c], 0, NULL, 1, &stats[0]);
        clip(&world, &planes[p], 1);
        TetcastFrame *one = shoot(&world, &cameras[c], 0, NULL, 1, &stats[1]);
        clip(&world, &back, 1);
        TetcastFrame *other = shoot(&world, &cameras[c], 0, NULL, 1, &stats[2]);
        bool first;
        const TetcastFrame *near = is_near(&planes[p], &cameras[c], &first) ? one : other, *far = first ? other : one;
        int seen[2] = {0, 0};
        for (int j = 0; j < 4 * PIXELS; ++j) {
          const double alpha = pixels_of(near)[j / 4 * 4 + 3];
          const double sum = pixels_of(near)[j] + (1 - alpha) * pixels_of(far)[j];
          worst = fmax(worst, fabs(sum - pixels_of(whole)[j]));
          seen[0] += pixels_of(near)[j] > 0;
          seen[1] += pixels_of(far)[j] > 0;
        }
        assert_true(worst <= 1e-13);
        assert_true(seen[0] > PIXELS / 20 || seen[1] > PIXELS / 20);
        /* A cell that is cut counts twice. Rays that were opaque go on behind the plane. */
        assert_true(stats[1].segments + stats[2].segments >= stats[0].segments);
        tetcast_frame_destroy(&whole);
        tetcast_frame_destroy(&one);
        tetcast_frame_destroy(&other);
      }
    }
    printf("%.1e ", worst);
    world_end(&world);
  }
  printf("apart\n");
}

/* Values along rays, and coefficients: extremes, sums, depths and lengths of the two sides are those of the whole. */
static void sides_of_sums_and_extremes(void **state) {
  (void)state;
  for (int i = 0; i < 4; ++i) {
    World world;
    world_begin(&world, 0.6, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL,
                i & 2 ? TETCAST_CELL : TETCAST_POINT);
    TetcastCamera cameras[4];
    TetcastHalfSpace planes[4];
    planes_through(planes);
    const TetcastHalfSpace sides[2] = {planes[0], other_side(planes[0])};
    for (int c = 0; c < cameras_around(&world, cameras); ++c) {
      for (int blend = TETCAST_BLEND_MAXIMUM; blend <= TETCAST_BLEND_ADDITIVE; ++blend) {
        assert_int_equal(tetcast_scene_set_blend(world.scene, (TetcastBlend)blend), TETCAST_OK);
        const double *value[3];
        TetcastFrame *frames[3];
        for (int s = 0; s < 3; ++s) {
          clip(&world, s < 2 ? &sides[s] : NULL, s < 2);
          frames[s] = shoot(&world, &cameras[c], TETCAST_CHANNEL_VALUE, NULL, 1, NULL);
          value[s] = tetcast_frame_channel(frames[s], TETCAST_CHANNEL_VALUE);
        }
        int both = 0;
        for (int p = 0; p < PIXELS; ++p) {
          const double a = value[0][p], b = value[1][p], whole = value[2][p];
          if (isnan(whole) || isnan(a) || isnan(b)) {
            /* None is less than what rounding makes of a grazing ray. */
            assert_true(isnan(whole) ? isnan(a) && isnan(b) : isnan(a) != isnan(b));
            continue;
          }
          ++both;
          if (blend == TETCAST_BLEND_AVERAGE)
            assert_true(whole >= fmin(a, b) - 1e-14 && whole <= fmax(a, b) + 1e-14);
          else
            assert_true(fabs(whole - (blend == TETCAST_BLEND_MAXIMUM   ? fmax(a, b)
                                      : blend == TETCAST_BLEND_MINIMUM ? fmin(a, b)
                                                                       : a + b)) <= 1e-14);
        }
        assert_true(both > PIXELS / 20);
        for (int s = 0; s < 3; ++s)
          tetcast_frame_destroy(&frames[s]);
      }
    }
    world_end(&world);
  }
}

static void set_coefficients(World *world, int groups) {
  TetcastField *fields[16];
  double *values = malloc((size_t)world->cube.vertex_count * sizeof *values);
  for (int g = 0; g < groups; ++g) {
    for (int64_t i = 0; i < world->cube.vertex_count; ++i)
      values[i] = world->cube.values[i] * (1 + 0.1 * g) / world->scale;
    fields[g] = field_of(world->fixture.context, values, world->cube.vertex_count, TETCAST_POINT);
  }
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = desc.emission = (const TetcastField *const *)fields;
  desc.extinction_count = desc.emission_count = groups;
  assert_int_equal(tetcast_scene_set_coefficients(world->scene, &desc), TETCAST_OK);
  for (int g = 0; g < groups; ++g)
    tetcast_field_destroy(&fields[g]);
  free(values);
}

static void sides_of_coefficients(void **state) {
  (void)state;
  static const int groups[] = {1, 3, 11};
  static const uint32_t channels = TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_RADIANCE |
                                   TETCAST_CHANNEL_TRANSMITTANCE | TETCAST_CHANNEL_PATH_LENGTH;
  for (int i = 0; i < 6; ++i) {
    World world;
    const int n = groups[i / 2];
    world_begin(&world, 0.6, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
    set_coefficients(&world, n);
    TetcastCamera cameras[4];
    TetcastHalfSpace planes[4];
    planes_through(planes);
    const TetcastHalfSpace sides[2] = {planes[0], other_side(planes[0])};
    for (int c = 0; c < cameras_around(&world, cameras); ++c) {
      TetcastFrame *frames[3];
      for (int s = 0; s < 3; ++s) {
        clip(&world, s < 2 ? &sides[s] : NULL, s < 2);
        frames[s] = shoot(&world, &cameras[c], channels, NULL, 1, NULL);
      }
#define OF(s, channel) ((const double *)tetcast_frame_channel(frames[s], TETCAST_CHANNEL_##channel))
      bool first;
      is_near(&planes[0], &cameras[c], &first);
      const int near = first ? 0 : 1, far = 1 - near;
      int both = 0;
      for (int p = 0; p < PIXELS; ++p) {
        both += OF(0, PATH_LENGTH)[p] > 0 && OF(1, PATH_LENGTH)[p] > 0;
        assert_true(fabs(OF(0, PATH_LENGTH)[p] + OF(1, PATH_LENGTH)[p] - OF(2, PATH_LENGTH)[p]) <= 1e-13);
        for (int g = 0; g < n; ++g) {
          const int j = p * n + g;
          assert_true(fabs(OF(0, OPTICAL_DEPTH)[j] + OF(1, OPTICAL_DEPTH)[j] - OF(2, OPTICAL_DEPTH)[j]) <= 1e-13);
          assert_true(fabs(OF(0, TRANSMITTANCE)[j] * OF(1, TRANSMITTANCE)[j] - OF(2, TRANSMITTANCE)[j]) <= 1e-13);
          assert_true(fabs(OF(near, RADIANCE)[j] + OF(near, TRANSMITTANCE)[j] * OF(far, RADIANCE)[j] -
                           OF(2, RADIANCE)[j]) <= 1e-13);
        }
      }
#undef OF
      assert_true(both > PIXELS / 20);
      for (int s = 0; s < 3; ++s)
        tetcast_frame_destroy(&frames[s]);
    }
    world_end(&world);
  }
}

/* Where two bodies overlap, each is seen up to where rays end, whichever they meet first; of what all cells count for,
 * every cell for itself is right. */
static void bodies_that_overlap(void **state) {
  (void)state;
  static const uint32_t channels = TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_PATH_LENGTH;
  double *sums[2][2] = {{NULL}};
  const TetcastHalfSpace planes[2] = {{{0.2, 0.1, -1}, -0.6}, {{-0.1, 0.3, 1}, 0.2}};
  const TetcastCamera cameras[2] = {camera_of(2.1, 1.7, 3.3, 0.6, 0.6, 0.6), parallel(1.3, 0.9, 3, 2)};
  for (int t = 0; t < 2; ++t) {
    World world;
    world_begin(&world, 0.6, 1, t ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
    tetcast_scene_destroy(&world.scene);
    tetcast_volume_destroy(&world.volume);
    /* The cube, and another beside it that has a part in common with it. */
    const Cube *one = &world.cube;
    Cube two = {2 * one->vertex_count, 2 * one->cell_count, malloc(6 * (size_t)one->vertex_count * sizeof(double)),
                malloc(8 * (size_t)one->cell_count * sizeof(int64_t)),
                malloc(2 * (size_t)one->vertex_count * sizeof(double))};
    for (int64_t i = 0; i < two.vertex_count; ++i) {
      const int64_t from = i % one->vertex_count;
      for (int k = 0; k < 3; ++k)
        two.vertices[3 * i + k] = one->vertices[3 * from + k] + (i == from ? 0 : k < 2 ? 0.3 : -0.6);
      two.values[i] = one->values[from];
    }
    for (int64_t i = 0; i < 4 * two.cell_count; ++i)
      two.cells[i] = one->cells[i % (4 * one->cell_count)] + (i / (4 * one->cell_count)) * one->vertex_count;
    cube_destroy(&world.cube);
    world.cube = two;
    TetcastMesh *mesh = cube_mesh(world.fixture.context, &world.cube);
    world.volume = volume_of(world.fixture.context, mesh, t ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    tetcast_mesh_destroy(&mesh);
    assert_int_equal(tetcast_scene_create(world.fixture.context, world.volume, &world.scene), TETCAST_OK);
    set_coefficients(&world, 1);
    clip(&world, planes, 2);
    for (int c = 0; c < 2; ++c) {
      TetcastFrame *frame = shoot(&world, &cameras[c], channels, NULL, 1, NULL);
      sums[t][c] = malloc(2 * PIXELS * sizeof(double));
      memcpy(sums[t][c], tetcast_frame_channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH), PIXELS * sizeof(double));
      memcpy(sums[t][c] + PIXELS, tetcast_frame_channel(frame, TETCAST_CHANNEL_PATH_LENGTH), PIXELS * sizeof(double));
      tetcast_frame_destroy(&frame);
    }
    world_end(&world);
  }
  for (int c = 0; c < 2; ++c) {
    double most = 0;
    for (int j = PIXELS; j < 2 * PIXELS; ++j)
      most = fmax(most, sums[1][c][j]);
    assert_true(most > 0.4); /* both count */
    assert_true(largest_difference(sums[0][c], sums[1][c], 2 * PIXELS) <= 1e-13);
    free(sums[0][c]);
    free(sums[1][c]);
  }
}

/* Planes beside the mesh, also very far and very near ones, change no bit of picture or bound; planes beyond it leave
 * nothing, for nothing. */
static void planes_beside_the_mesh(void **state) {
  (void)state;
  static const double far[] = {1e-9, 1, 1e6, 1e150, 1e306};
  for (int t = 0; t < 2; ++t) {
    World world;
    world_begin(&world, 0.6, 1, t ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
    TetcastCamera cameras[4];
    for (int c = 0; c < cameras_around(&world, cameras); ++c) {
      clip(&world, NULL, 0);
      TetcastFrame *whole = shoot(&world, &cameras[c], TETCAST_CHANNEL_ERROR, NULL, 1, NULL);
      for (size_t i = 0; i < sizeof far / sizeof *far; ++i) {
        /* Beyond the sphere around the cube, whose radius is √3 / 2. */
        const TetcastHalfSpace around[2] = {{{3, 4, 0}, 3.5 - 5 * (0.8660255 + far[i])},
                                            {{0, 0, -1e-8}, -1e-8 * (0.5 + 0.8660255 + far[i])}};
        const TetcastHalfSpace beyond[2] = {around[0], other_side(around[1])};
        TetcastRenderStats stats;
        clip(&world, around, 2);
        TetcastFrame *same = shoot(&world, &cameras[c], TETCAST_CHANNEL_ERROR, NULL, 1, NULL);
        assert_memory_equal(pixels_of(same), pixels_of(whole), 4 * PIXELS * sizeof(double));
        assert_memory_equal(tetcast_frame_channel(same, TETCAST_CHANNEL_ERROR),
                            tetcast_frame_channel(whole, TETCAST_CHANNEL_ERROR), PIXELS * sizeof(double));
        tetcast_frame_destroy(&same);
        clip(&world, beyond, 2);
        TetcastFrame *none = shoot(&world, &cameras[c], TETCAST_CHANNEL_ERROR, NULL, 1, &stats);
        assert_int_equal(stats.segments, 0);
        assert_true(stats.error == 0 || far[i] < 1); /* where the plane all but touches the sphere, there is doubt */
        for (int j = 0; j < 4 * PIXELS; ++j)
          assert_true(pixels_of(none)[j] == 0);
        tetcast_frame_destroy(&none);
      }
      /* Two half-spaces that have nothing in common. */
      const TetcastHalfSpace apart[2] = {{{1, 0.1, 0}, 0.6}, {{-1, -0.1, 0}, -0.5}};
      TetcastRenderStats stats;
      clip(&world, apart, 2);
      TetcastFrame *none = shoot(&world, &cameras[c], 0, NULL, 1, &stats);
      assert_int_equal(stats.segments, 0);
      tetcast_frame_destroy(&none);
      tetcast_frame_destroy(&whole);
    }
    world_end(&world);
  }
}

/* Of coefficients, a ray of which nothing is left has a transmittance of 1. */
static void nothing_left_is_clear(void **state) {
  (void)state;
  World world;
  world_begin(&world, 0.6, 1, TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
  set_coefficients(&world, 3);
  const TetcastHalfSpace beyond = {{0, 1, 0}, 2};
  clip(&world, &beyond, 1);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = shoot(&world, &camera, TETCAST_CHANNEL_TRANSMITTANCE, NULL, 2, NULL);
  for (int j = 0; j < 3 * PIXELS; ++j)
    assert_true(((const double *)tetcast_frame_channel(frame, TETCAST_CHANNEL_TRANSMITTANCE))[j] == 1);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

/* The middle column of rays lies exactly in a plane: it is kept by both sides, beside it only by its own. */
static void a_ray_in_a_plane_is_kept(void **state) {
  (void)state;
  for (int i = 0; i < 4; ++i) {
    World world;
    world_begin(&world, 0.6, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
    TetcastCamera camera = {.eye = {0.5, 0.5, 4}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .fovy = 20, .height = 1.2};
    camera.projection = i & 2 ? TETCAST_ORTHOGRAPHIC : TETCAST_PERSPECTIVE;
    TetcastFrame *whole = shoot(&world, &camera, 0, NULL, 1, NULL);
    for (int side = -1; side <= 1; side += 2) {
      const TetcastHalfSpace h = {{side * 3.0, 0, 0}, side * 1.5};
      clip(&world, &h, 1);
      TetcastFrame *half = shoot(&world, &camera, 0, NULL, 1, NULL);
      for (int p = 0; p < PIXELS; ++p) {
        const int from_middle = side * (p % W - W / 2);
        if (from_middle == 0)
          assert_true(largest_difference(pixels_of(half) + 4 * p, pixels_of(whole) + 4 * p, 4) <= 1e-15);
        if (from_middle < 0 && i & 2)
          assert_true(pixels_of(half)[4 * p + 3] == 0);
      }
      tetcast_frame_destroy(&half);
    }
    tetcast_frame_destroy(&whole);
    world_end(&world);
  }
}

/* Powers of two as units change no bit, of the clip's numbers either; the largest and smallest units do no harm. */
static void units_change_no_bit(void **state) {
  (void)state;
  static const int lengths[] = {0, 60, -60, 900, -900}, normals[] = {0, 900, -900, 40, -60};
  double *first = NULL;
  for (int i = 0; i < 5; ++i) {
    World world;
    world_begin(&world, 0.6, ldexp(1, lengths[i]), TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
    const TetcastCamera camera = camera_in(&world, camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5));
    TetcastHalfSpace h[2] = {{{0.3, -0.7, 0.5}, 0.02}, {{1, 0, 0.25}, 0.3}};
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 3; ++k)
        h[j].normal[k] = ldexp(h[j].normal[k], normals[i]);
      h[j].offset = ldexp(h[j].offset, normals[i] + lengths[i]);
    }
    clip(&world, h, 2);
    TetcastFrame *frame = shoot(&world, &camera, 0, NULL, 1, NULL);
    if (first) {
      assert_memory_equal(pixels_of(frame), first, 4 * PIXELS * sizeof *first);
    } else {
      first = malloc(4 * PIXELS * sizeof *first);
      memcpy(first, pixels_of(frame), 4 * PIXELS * sizeof *first);
    }
    tetcast_frame_destroy(&frame);
    world_end(&world);
  }
  free(first);
}

/* ── stops ── */

/* The ray of a pixel, as camera.h has it, in extended precision. */
static void ray_of(const TetcastCamera *camera, int pixel, long double eye[3], long double direction[3]) {
  long double forward[3], right[3], up[3], length = 0;
  for (int k = 0; k < 3; ++k)
    forward[k] = (long double)camera->target[k] - camera->eye[k];
  for (int k = 0; k < 3; ++k)
    length += forward[k] * forward[k];
  for (int k = 0; k < 3; ++k)
    forward[k] /= sqrtl(length);
  length = 0;
  for (int k = 0; k < 3; ++k)
    right[k] = forward[(k + 1) % 3] * camera->up[(k + 2) % 3] - forward[(k + 2) % 3] * camera->up[(k + 1) % 3];
  for (int k = 0; k < 3; ++k)
    length += right[k] * right[k];
  for (int k = 0; k < 3; ++k)
    right[k] /= sqrtl(length);
  for (int k = 0; k < 3; ++k)
    up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3];
  const bool is_parallel = camera->projection == TETCAST_ORTHOGRAPHIC;
  const long double half = is_parallel ? camera->height / 2 : tanl(camera->fovy * acosl(-1) / 360);
  const long double u = ((pixel % W + 0.5L) / W * 2 - 1) * half * W / H, v = (1 - (pixel / W + 0.5L) / H * 2) * half;
  length = 0;
  for (int k = 0; k < 3; ++k) {
    const long double shift = u * right[k] + v * up[k];
    eye[k] = camera->eye[k] + (is_parallel ? shift : 0);
    direction[k] = forward[k] + (is_parallel ? 0 : shift);
    length += direction[k] * direction[k];
  }
  for (int k = 0; k < 3; ++k)
    direction[k] /= sqrtl(length);
}

/* How far the plane is along each ray that goes out of the half-space there; nowhere, where it comes in. */
static void distances_of(const TetcastHalfSpace *h, const TetcastCamera *camera, double *distance) {
  for (int p = 0; p < PIXELS; ++p) {
    long double eye[3], direction[3], value = -(long double)h->offset, slope = 0;
    ray_of(camera, p, eye, direction);
    for (int k = 0; k < 3; ++k)
      value += h->normal[k] * eye[k], slope += h->normal[k] * direction[k];
    distance[p] = (double)(-value / slope);
    assert_true(slope < 0);
  }
}

static void rays_stop_where_they_are_told(void **state) {
  (void)state;
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 0.6, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, (TetcastAssociation)(i / 4));
    TetcastCamera cameras[4];
    cameras_around(&world, cameras);
    for (int c = i & 2 ? 2 : 0; c < (i & 2 ? 4 : 1); ++c) {
      TetcastHalfSpace h = {{0.1, 0.2, 0}, 0};
      for (int k = 0; k < 3; ++k)
        h.normal[k] += cameras[c].eye[k] - cameras[c].target[k];
      h.offset = h.normal[0] * 0.55 + h.normal[1] * 0.45 + h.normal[2] * 0.4;
      double distance[2 * PIXELS];
      distances_of(&h, &cameras[c], distance);
      clip(&world, &h, 1);
      TetcastFrame *clipped = shoot(&world, &cameras[c], TETCAST_CHANNEL_ERROR, NULL, 1, NULL);
      clip(&world, NULL, 0);
      TetcastArray stop = {distance, TETCAST_TYPE_FLOAT64, PIXELS, 0};
      TetcastFrame *stopped = shoot(&world, &cameras[c], TETCAST_CHANNEL_ERROR, &stop, 1, NULL);
      const double off = largest_difference(pixels_of(clipped), pixels_of(stopped), 4 * PIXELS);
      if (!(off <= 1e-13))
        fail_msg("camera %d: off by %g", c, off);
      /* Every other number of an array, in single precision. */
      float single[2 * PIXELS];
      for (int p = 0; p < PIXELS; ++p)
        single[2 * p] = (float)distance[p], single[2 * p + 1] = NAN;
      stop = (TetcastArray){single, TETCAST_TYPE_FLOAT32, PIXELS, 2 * sizeof(float)};
      TetcastFrame *rounded = shoot(&world, &cameras[c], 0, &stop, 1, NULL);
      assert_true(largest_difference(pixels_of(clipped), pixels_of(rounded), 4 * PIXELS) <= 1e-4);
      /* A pixel's samples all end there. */
      stop = (TetcastArray){distance, TETCAST_TYPE_FLOAT64, PIXELS, 0};
      for (int p = 0; p < PIXELS; ++p)
        distance[p] = p % 3 ? INFINITY : p % 2 ? 0 : -1;
      TetcastFrame *whole = shoot(&world, &cameras[c], 0, NULL, 6, NULL);
      TetcastFrame *some = shoot(&world, &cameras[c], 0, &stop, 6, NULL);
      for (int j = 0; j < 4 * PIXELS; ++j)
        assert_true(fabs(pixels_of(some)[j] - (j / 4 % 3 ? pixels_of(whole)[j] : 0)) <= (j / 4 % 3 ? 1e-15 : 0));
      TetcastFrame *frames[] = {clipped, stopped, rounded, whole, some};
      for (int f = 0; f < 5; ++f)
        tetcast_frame_destroy(&frames[f]);
    }
    world_end(&world);
  }
}

/* Within a tolerance, and so in single precision, both are as exact as the tolerance says and the channel knows. */
static void tolerances_are_kept(void **state) {
  (void)state;
  World world;
  world_begin(&world, 0.6, 1, TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
  TetcastTransferFunction *soft = NULL;
  assert_int_equal(tetcast_scene_create_preset(world.scene, "viridis", 0, 1, &soft), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, soft), TETCAST_OK);
  tetcast_transfer_function_destroy(&soft);
  TetcastCamera cameras[4];
  TetcastHalfSpace planes[4];
  double distance[PIXELS];
  for (int p = 0; p < PIXELS; ++p)
    distance[p] = p % 5 ? 3.2 : INFINITY;
  const TetcastArray stop = {distance, TETCAST_TYPE_FLOAT64, PIXELS, 0};
  int single = 0;
  for (int i = 0; i < planes_through(planes) * cameras_around(&world, cameras); ++i) {
    const TetcastCamera *camera = &cameras[i % 4];
    clip(&world, &planes[i / 4], 1);
    TetcastFrame *exact = shoot(&world, camera, 0, i & 1 ? &stop : NULL, 1, NULL);
    for (double tolerance = 0.01; tolerance > 1e-7; tolerance /= 10) {
      TetcastFrameDesc desc = tetcast_frame_desc_default();
      desc.width = W;
      desc.height = H;
      desc.channels = TETCAST_CHANNEL_ERROR;
      TetcastFrame *frame = NULL;
      assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
      TetcastRenderDesc render = render_desc();
      render.tolerance = tolerance;
      render.stop = i & 1 ? &stop : NULL;
      TetcastRenderStats stats;
      assert_int_equal(tetcast_scene_render(world.scene, camera, &render, frame, &stats), TETCAST_OK);
      single += !strcmp(stats.precision, "single");
      const double *bound = tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR);
      assert_true(stats.error <= tolerance);
      for (int j = 0; j < 4 * PIXELS; ++j)
        assert_true(fabs(pixels_of(frame)[j] - pixels_of(exact)[j]) <= bound[j / 4] + 1e-13);
      tetcast_frame_destroy(&frame);
    }
    tetcast_frame_destroy(&exact);
  }
  const char *isa = getenv("TETCAST_TEST_ISA");
  printf("%d pictures in single precision\n", single);
  assert_true(single > 0 || (isa && atoi(isa) == TETCAST_ISA_SCALAR));
  world_end(&world);
}

/* ── what is not possible ── */

static void refuses_clip(World *world, TetcastHalfSpace h, const char *word) {
  const TetcastHalfSpace two[2] = {{{1, 0, 0}, 0}, h};
  assert_int_equal(tetcast_scene_set_clip(world->scene, two, 2), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word) || !strstr(world->fixture.message, "half-space 1"))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
}

static void refuses_stop(World *world, TetcastArray stop, const char *word) {
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = 4;
  desc.height = 3;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  TetcastRenderDesc render = render_desc();
  render.stop = &stop;
  assert_int_equal(tetcast_scene_render(world->scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
  tetcast_frame_destroy(&frame);
}

static void what_is_not_possible_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 0, 1, TETCAST_TRAVERSAL_SHELL, TETCAST_POINT);
  const TetcastHalfSpace middle = {{1, 0, 0}, 0.5};
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  clip(&world, &middle, 1);
  TetcastFrame *before = shoot(&world, &camera, 0, NULL, 1, NULL);
  assert_int_equal(tetcast_scene_set_clip(NULL, &middle, 1), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_set_clip(world.scene, NULL, 1), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_set_clip(world.scene, &middle, -1), TETCAST_ERROR_ARGUMENT);
  refuses_clip(&world, (TetcastHalfSpace){{0, 0, 0}, 1}, "length 0");
  refuses_clip(&world, (TetcastHalfSpace){{0, NAN, 0}, 1}, "not finite");
  refuses_clip(&world, (TetcastHalfSpace){{1, 0, INFINITY}, 1}, "not finite");
  refuses_clip(&world, (TetcastHalfSpace){{1, 0, 0}, INFINITY}, "not finite");
  TetcastFrame *after = shoot(&world, &camera, 0, NULL, 1, NULL); /* the former clip holds */
  assert_memory_equal(pixels_of(before), pixels_of(after), 4 * PIXELS * sizeof(double));
  tetcast_frame_destroy(&before);
  tetcast_frame_destroy(&after);
  double distance[12] = {0};
  refuses_stop(&world, (TetcastArray){distance, TETCAST_TYPE_INT32, 12, 0}, "type");
  refuses_stop(&world, (TetcastArray){distance, TETCAST_TYPE_FLOAT64, 11, 0}, "11 distances for a frame of 4 × 3");
  refuses_stop(&world, (TetcastArray){NULL, TETCAST_TYPE_FLOAT64, 12, 0}, "NULL");
  distance[6] = NAN;
  refuses_stop(&world, (TetcastArray){distance, TETCAST_TYPE_FLOAT64, 12, 0}, "(2, 1) is NaN");
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(both_sides_are_the_whole),       cmocka_unit_test(sides_of_sums_and_extremes),
      cmocka_unit_test(sides_of_coefficients),          cmocka_unit_test(bodies_that_overlap),
      cmocka_unit_test(planes_beside_the_mesh),         cmocka_unit_test(nothing_left_is_clear),
      cmocka_unit_test(a_ray_in_a_plane_is_kept),       cmocka_unit_test(units_change_no_bit),
      cmocka_unit_test(rays_stop_where_they_are_told),  cmocka_unit_test(tolerances_are_kept),
      cmocka_unit_test(what_is_not_possible_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
