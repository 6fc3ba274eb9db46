/* SPDX-License-Identifier: Apache-2.0 */
/* Blend modes against closed forms: along a ray through a box, a linear field has its extremes at the ends of the
 * chord, its mean halfway between them, and its integral is that times the chord's length, whatever the cells are. Rays
 * through vertices, along edges and within faces, from outside and inside, fields of points, cells and corners, both
 * traversals, NaN; and what the library says where it can't. */
#include "world.h"

#include <float.h>

enum { W = 41, H = 33, PIXELS = W * H };

static const TetcastBlend blends[] = {TETCAST_BLEND_MAXIMUM, TETCAST_BLEND_MINIMUM, TETCAST_BLEND_AVERAGE,
                                      TETCAST_BLEND_ADDITIVE};
enum { BLENDS = sizeof blends / sizeof *blends };

static void set_constant(World *world, double value, TetcastAssociation association) {
  const int64_t count = count_of(&world->cube, association);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = value;
  set_values(world, values, association);
  free(values);
}

static const double slope[3] = {0.7, -1.9, 0.4};

static double linear(const double p[3]) {
  return 0.3 + slope[0] * p[0] + slope[1] * p[1] + slope[2] * p[2];
}

static void set_linear(World *world, TetcastAssociation association) {
  const Cube *cube = &world->cube;
  const int64_t count = count_of(cube, association);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = linear(&cube->vertices[3 * (association == TETCAST_POINT ? i : cube->cells[i])]);
  set_values(world, values, association);
  free(values);
}

static TetcastFrame *frame_of(World *world, TetcastType type, uint32_t channels) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.type = type;
  desc.channels = channels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  return frame;
}

static TetcastFrame *shoot_with(World *world, TetcastBlend blend, const TetcastCamera *camera, TetcastType type,
                                int samples, double tolerance) {
  TetcastFrame *frame = frame_of(world, type, TETCAST_CHANNEL_VALUE);
  TetcastRenderDesc render = render_desc();
  render.samples = samples;
  render.tolerance = tolerance;
  TetcastRenderStats stats;
  assert_int_equal(tetcast_scene_set_blend(world->scene, blend), TETCAST_OK);
  assert_int_equal(tetcast_scene_blend(world->scene), blend);
  assert_int_equal(tetcast_scene_render(world->scene, camera, &render, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  assert_true(isnan(stats.error));
  assert_string_equal(stats.precision, "double");
  return frame;
}

static TetcastFrame *shoot(World *world, TetcastBlend blend, const TetcastCamera *camera) {
  return shoot_with(world, blend, camera, TETCAST_TYPE_FLOAT64, 1, 0);
}

static const double *values_of(const TetcastFrame *frame) {
  return tetcast_frame_channel(frame, TETCAST_CHANNEL_VALUE);
}
static const double *pixels_of(const TetcastFrame *frame) {
  return tetcast_frame_pixels(frame);
}

/* ── rays ── */

/* The part of a ray in [0, sides[k]], from the eye on; false: there is none. */
static bool chord(const double eye[3], const double direction[3], const double sides[3], double *from, double *to) {
  *from = 0;
  *to = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (!(eye[k] > 0 && eye[k] < sides[k]))
        return false;
      continue;
    }
    const double a = (0 - eye[k]) / direction[k], b = (sides[k] - eye[k]) / direction[k];
    *from = fmax(*from, fmin(a, b));
    *to = fmin(*to, fmax(a, b));
  }
  return *to > *from;
}

static double blended(TetcastBlend blend, double a, double b, double length) {
  if (blend == TETCAST_BLEND_MAXIMUM)
    return fmax(a, b);
  if (blend == TETCAST_BLEND_MINIMUM)
    return fmin(a, b);
  return (a + b) / 2 * (blend == TETCAST_BLEND_ADDITIVE ? length : 1);
}

/* Values of the linear field in a box. Rays that merely graze it may meet it or not. Returns how many pixels have a
 * value. */
static int check_linear(const TetcastFrame *frame, TetcastBlend blend, const TetcastCamera *camera,
                        const double sides[3]) {
  const double *values = values_of(frame), *rgba = pixels_of(frame);
  int met = 0;
  for (int p = 0; p < PIXELS; ++p) {
    double eye[3], direction[3], from, to, a[3], b[3];
    ray_of(camera, W, H, p, eye, direction);
    const bool meets = chord(eye, direction, sides, &from, &to);
    const bool grazes = meets ? to - from < 1e-9 : !isnan(values[p]);
    if (isnan(values[p]))
      assert_true(rgba[4 * p + 3] == 0 && rgba[4 * p] == 0 && rgba[4 * p + 1] == 0 && rgba[4 * p + 2] == 0);
    else
      assert_true(rgba[4 * p + 3] == 1 && rgba[4 * p] == 1);
    if (grazes)
      continue;
    assert_true(meets == !isnan(values[p]));
    if (!meets)
      continue;
    for (int k = 0; k < 3; ++k)
      a[k] = eye[k] + from * direction[k], b[k] = eye[k] + to * direction[k];
    const double wanted = blended(blend, linear(a), linear(b), to - from);
    if (!(fabs(values[p] - wanted) <= 2e-14))
      fail_msg("blend mode %d, pixel %d: %.17g, not %.17g", blend, p, values[p], wanted);
    ++met;
  }
  return met;
}

/* Cameras outside, inside, and in parallel along an axis, where rays go through vertices, along edges and within faces:
 * the pixels' size is a divisor of the cells'. */
static void linear_field_has_its_closed_form(void **state) {
  (void)state;
  static const TetcastAssociation associations[] = {TETCAST_POINT, TETCAST_CORNER};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(3, 2, 4, 1.6), parallel(0.5, 0.5, 4, H / 32.0),
                                   parallel(0.5, 0.5, 0.4, H / 32.0)};
  const double sides[3] = {1, 1, 1};
  for (int i = 0; i < 8; ++i) {
    World world;
    world_begin(&world, 4, i & 1 ? 0.6 : 0, 1, i & 2 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    set_linear(&world, associations[i / 4]);
    for (int blend = 0; blend < BLENDS; ++blend) {
      for (size_t c = 0; c < sizeof cameras / sizeof *cameras; ++c) {
        TetcastFrame *frame = shoot(&world, blends[blend], &cameras[c]);
        assert_true(check_linear(frame, blends[blend], &cameras[c], sides) > PIXELS / 20);
        tetcast_frame_destroy(&frame);
      }
    }
    world_end(&world);
  }
}

/* The extremes and the mean of a constant field are the constant, to the bit. */
static void constant_field_stays_exact(void **state) {
  (void)state;
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)};
  static const double constants[] = {0.1, -3e-7, 0, 1e300, -5e-324, DBL_MIN / 3};
  const double sides[3] = {1, 1, 1};
  for (int i = 0; i < 6; ++i) {
    World world;
    world_begin(&world, 5, 0.6, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    for (size_t j = 0; j < sizeof constants / sizeof *constants; ++j) {
      set_constant(&world, constants[j], (TetcastAssociation)(i / 2));
      for (int blend = 0; blend < BLENDS; ++blend) {
        const TetcastCamera *camera = &cameras[blend % 2];
        TetcastFrame *frame = shoot(&world, blends[blend], camera);
        int met = 0;
        for (int p = 0; p < PIXELS; ++p) {
          const double value = values_of(frame)[p];
          if (isnan(value))
            continue;
          double eye[3], direction[3], from, to;
          ray_of(camera, W, H, p, eye, direction);
          ++met;
          if (blends[blend] != TETCAST_BLEND_ADDITIVE)
            assert_true(value == constants[j]);
          else if (chord(eye, direction, sides, &from, &to)) {
            const double wanted = constants[j] * (to - from);
            assert_true(fabs(value - wanted) <= 1e-14 * fabs(constants[j]) + 5e-324);
          }
        }
        assert_true(met > PIXELS / 20);
        tetcast_frame_destroy(&frame);
      }
    }
    world_end(&world);
  }
}

/* Of a box whose part beyond the middle is NaN, the rest is seen, whatever lies behind or before; of all NaN, nothing.
 */
static void nan_counts_for_nothing(void **state) {
  (void)state;
  const TetcastCamera cameras[] = {camera_of(-2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(3.1, 1.2, -1.7, 0.5, 0.5, 0.5),
                                   camera_of(0.8, 0.52, 0.61, 0, 0.2, 0.4)};
  for (int i = 0; i < 6; ++i) {
    World world;
    const int n = 4;
    world_begin(&world, n, 0, 1, i & 1 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    const Cube *cube = &world.cube;
    const TetcastAssociation association = (TetcastAssociation)(i / 2);
    const int64_t count = count_of(cube, association);
    double *values = malloc((size_t)count * sizeof *values);
    /* Cells up to x = 1/2; a vertex of them there has a value, one beyond has none. */
    for (int64_t j = 0; j < count; ++j) {
      const int64_t *cell = &cube->cells[association == TETCAST_CELL     ? 4 * j
                                         : association == TETCAST_CORNER ? j / 4 * 4
                                                                         : 0];
      double x = 0;
      for (int k = 0; k < 4; ++k)
        x = fmax(x, cube->vertices[3 * cell[k]]);
      if (association == TETCAST_POINT)
        x = cube->vertices[3 * j];
      const double value = association == TETCAST_CELL
                               ? 2.5
                               : linear(&cube->vertices[3 * (association == TETCAST_POINT ? j : cube->cells[j])]);
      values[j] = x > 0.5 ? (j % 3 ? (double)NAN : (double)INFINITY) : value;
    }
    set_values(&world, values, association);
    const double sides[3] = {0.5, 1, 1};
    for (int blend = 0; blend < BLENDS; ++blend) {
      for (int c = 0; c < 3; ++c) {
        TetcastFrame *frame = shoot(&world, blends[blend], &cameras[c]);
        if (association != TETCAST_CELL)
          assert_true(check_linear(frame, blends[blend], &cameras[c], sides) > PIXELS / 20);
        for (int p = 0; p < PIXELS && association == TETCAST_CELL; ++p) {
          double eye[3], direction[3], from, to;
          ray_of(&cameras[c], W, H, p, eye, direction);
          const bool meets = chord(eye, direction, sides, &from, &to);
          if (meets && to - from < 1e-9)
            continue;
          const double wanted = meets ? blended(blends[blend], 2.5, 2.5, to - from) : (double)NAN,
                       value = values_of(frame)[p];
          assert_true(meets ? fabs(value - wanted) <= 2e-14 : isnan(value));
        }
        tetcast_frame_destroy(&frame);
      }
    }
    free(values);
    set_constant(&world, NAN, association);
    TetcastFrame *frame = shoot(&world, TETCAST_BLEND_MAXIMUM, &cameras[0]);
    for (int p = 0; p < PIXELS; ++p)
      assert_true(isnan(values_of(frame)[p]) && pixels_of(frame)[4 * p + 3] == 0);
    tetcast_frame_destroy(&frame);
    world_end(&world);
  }
}

/* Values of cells against their definition: the chord through each of all cells as four half-spaces, in extended
 * precision. */
static void cells_count_by_their_lengths(void **state) {
  (void)state;
  for (int way = 0; way < 2; ++way) {
    World world;
    world_begin(&world, 5, 0.6, 1, way ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    const Cube *cube = &world.cube;
    uint64_t seed = 4;
    double *values = malloc((size_t)cube->cell_count * sizeof *values);
    for (int64_t i = 0; i < cube->cell_count; ++i)
      values[i] = i % 50 == 7 ? (double)NAN : uniform(&seed) - 0.5;
    set_values(&world, values, TETCAST_CELL);
    const TetcastCamera camera = camera_of(0.43, 0.52, 0.61, 1, 0.2, 0);
    TetcastFrame *frames[BLENDS];
    for (int blend = 0; blend < BLENDS; ++blend)
      frames[blend] = shoot(&world, blends[blend], &camera);
    for (int p = 0; p < PIXELS; ++p) {
      double eye[3], direction[3];
      ray_of(&camera, W, H, p, eye, direction);
      long double least = INFINITY, most = -INFINITY, integral = 0, length = 0, shortest = INFINITY;
      for (int64_t i = 0; i < cube->cell_count; ++i) {
        long double from = 0, to = INFINITY;
        for (int k = 0; k < 4; ++k) { /* the face without corner k, whose side is inside */
          const double *a = &cube->vertices[3 * cube->cells[4 * i + (k + 1) % 4]],
                       *b = &cube->vertices[3 * cube->cells[4 * i + (k + 2) % 4]];
          const double *c = &cube->vertices[3 * cube->cells[4 * i + (k + 3) % 4]],
                       *d = &cube->vertices[3 * cube->cells[4 * i + k]];
          long double u[3], v[3], normal[3], inside = 0, along = 0, at = 0;
          for (int j = 0; j < 3; ++j)
            u[j] = (long double)b[j] - a[j], v[j] = (long double)c[j] - a[j];
          for (int j = 0; j < 3; ++j)
            normal[j] = u[(j + 1) % 3] * v[(j + 2) % 3] - u[(j + 2) % 3] * v[(j + 1) % 3];
          for (int j = 0; j < 3; ++j) {
            inside += normal[j] * ((long double)d[j] - a[j]);
            along += normal[j] * direction[j];
            at += normal[j] * ((long double)eye[j] - a[j]);
          }
          if (inside < 0)
            along = -along, at = -at;
          if (along > 0)
            from = fmaxl(from, -at / along);
          else
            to = fminl(to, -at / along);
        }
        if (!(to > from) || isnan(values[i]))
          continue;
        shortest = fminl(shortest, to - from);
        least = fminl(least, values[i]);
        most = fmaxl(most, values[i]);
        integral += values[i] * (to - from);
        length += to - from;
      }
      if (shortest < 1e-12)
        continue; /* rounding of the ray decides whether that cell is met */
      assert_true(length > 0);
      const long double wanted[] = {most, least, integral / length, integral};
      for (int blend = 0; blend < BLENDS; ++blend)
        assert_true(fabsl(values_of(frames[blend])[p] - wanted[blend]) <= (blend < 2 ? 0 : 1e-14));
    }
    for (int blend = 0; blend < BLENDS; ++blend)
      tetcast_frame_destroy(&frames[blend]);
    free(values);
    world_end(&world);
  }
}

/* Sums over very many cells: a column of layers, in parts that are no powers of two. */
static void many_cells_add_up(void **state) {
  (void)state;
  enum { LAYERS = 30000 };
  World world;
  world_begin(&world, 1, 0, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastContext *context = world.fixture.context;
  const Cube one = world.cube;
  Cube column = {4 * (LAYERS + 1), 6 * LAYERS, malloc(12 * (LAYERS + 1) * sizeof(double)),
                 malloc(24 * LAYERS * sizeof(int64_t)), malloc(4 * (LAYERS + 1) * sizeof(double))};
  for (int64_t i = 0; i < column.vertex_count; ++i) {
    for (int k = 0; k < 2; ++k)
      column.vertices[3 * i + k] = one.vertices[3 * (i % 4) + k];
    column.vertices[3 * i + 2] = (double)(i / 4) / LAYERS;
    column.values[i] = 0.1;
  }
  for (int64_t i = 0; i < 4 * column.cell_count; ++i)
    column.cells[i] = one.cells[i % 24] + i / 24 * 4;
  Body body = cube_body(context, &column, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = gray_of(context, 0);
  TetcastScene *cubes = world.scene;
  world.scene = scene_of(context, &body, transfer);
  const TetcastCamera camera = parallel(0.5, 0.5, 3, 1.2);
  TetcastFrame *frame = shoot(&world, TETCAST_BLEND_ADDITIVE, &camera);
  int met = 0;
  for (int p = 0; p < PIXELS; ++p) {
    if (isnan(values_of(frame)[p]))
      continue;
    ++met;
    assert_true(fabs(values_of(frame)[p] - 0.1) <= 4e-16);
  }
  assert_true(met > PIXELS / 4);
  tetcast_frame_destroy(&frame);
  tetcast_scene_destroy(&world.scene);
  world.scene = cubes;
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&column);
  world_end(&world);
}

/* Powers of two as units of length and of values change no bit of the picture, and values by themselves alone. */
static void units_change_no_bit(void **state) {
  (void)state;
  static const int lengths[] = {0, 40, -300, 480}, units[] = {0, -700, 900, 3};
  double *first[BLENDS] = {NULL};
  for (int i = 0; i < 4; ++i) {
    World world;
    const double scale = ldexp(1, lengths[i]);
    world_begin(&world, 4, 0.6, scale, TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = ldexp(world.cube.values[j], units[i]);
    set_values(&world, values, TETCAST_POINT);
    TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    for (int k = 0; k < 3; ++k)
      camera.eye[k] *= scale, camera.target[k] *= scale;
    for (int blend = 0; blend < BLENDS; ++blend) {
      const int unit = units[i] + (blends[blend] == TETCAST_BLEND_ADDITIVE ? lengths[i] : 0);
      TetcastFrame *frame = shoot(&world, blends[blend], &camera);
      double *got = malloc(PIXELS * sizeof *got);
      for (int p = 0; p < PIXELS; ++p) {
        const double value = values_of(frame)[p];
        got[p] = ldexp(value, -unit);
        if (unit > 1100)
          assert_true(isnan(value) || isinf(value)); /* too large for a double, and in the colour of what is largest */
        if (i > 0 && unit < 1000 && unit > -1000)
          assert_true(isnan(value) ? isnan(first[blend][p]) : got[p] == first[blend][p]);
        assert_true(pixels_of(frame)[4 * p] == !isnan(value));
      }
      if (i == 0)
        first[blend] = got;
      else
        free(got);
      tetcast_frame_destroy(&frame);
    }
    free(values);
    world_end(&world);
  }
  for (int blend = 0; blend < BLENDS; ++blend)
    free(first[blend]);
}

/* ── pictures ── */

static TetcastTransferFunction *shades(TetcastContext *context, double extinction) {
  const double color[3][4] = {{0, 1, 0, 0}, {0.5, 0, 1, 0.2}, {1, 0.25, 0, 1}}, k[2] = {0, extinction};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = 3;
  desc.extinction = k;
  desc.extinction_count = 1;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static double between(double a, double b, double u) {
  return a + (b - a) * u;
}

/* The colours of `shades`. */
static void shade_of(double value, double rgb[3]) {
  const double s = fmax(0, fmin(value, 1)), u = s < 0.5 ? 2 * s : 2 * s - 1;
  rgb[0] = s < 0.5 ? between(1, 0, u) : between(0, 0.25, u);
  rgb[1] = s < 0.5 ? between(0, 1, u) : between(1, 0, u);
  rgb[2] = s < 0.5 ? between(0, 0.2, u) : between(0.2, 1, u);
}

/* A pixel has the colour of its value times its alpha, with any extinction; a tolerance and the frame's type change
 * nothing; the colours of another transfer function are had without rendering. */
static void pixels_have_the_colour_of_their_values(void **state) {
  (void)state;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 4, 0.6, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunction *clear = shades(world.fixture.context, 0), *dense = shades(world.fixture.context, 1e6);
  TetcastTransferFunction *white = gray_of(world.fixture.context, 1);
  for (int blend = 0; blend < BLENDS; ++blend) {
    for (int samples = 1; samples <= 6; samples += 5) {
      assert_int_equal(tetcast_scene_set_transfer_function(world.scene, clear), TETCAST_OK);
      TetcastFrame *a = shoot_with(&world, blends[blend], &camera, TETCAST_TYPE_FLOAT64, samples, 0);
      assert_int_equal(tetcast_scene_set_transfer_function(world.scene, dense), TETCAST_OK);
      TetcastFrame *b = shoot_with(&world, blends[blend], &camera, TETCAST_TYPE_FLOAT64, samples, 0.1);
      TetcastFrame *f = shoot_with(&world, blends[blend], &camera, TETCAST_TYPE_FLOAT32, samples, 0);
      assert_memory_equal(values_of(a), values_of(b), PIXELS * sizeof(double));
      assert_memory_equal(pixels_of(a), pixels_of(b), 4 * PIXELS * sizeof(double));
      const float *values = tetcast_frame_channel(f, TETCAST_CHANNEL_VALUE), *rgba = tetcast_frame_pixels(f);
      int partly = 0;
      for (int p = 0; p < PIXELS; ++p) {
        const double value = values_of(a)[p], *pixel = pixels_of(a) + 4 * p, alpha = pixel[3];
        double rgb[3] = {0, 0, 0};
        assert_true((alpha == 0) == isnan(value) && alpha >= 0 && alpha <= 1);
        partly += alpha > 0 && alpha < 1;
        assert_true(fabs(alpha * samples - rint(alpha * samples)) < 1e-14);
        if (alpha > 0)
          shade_of(value, rgb);
        for (int k = 0; k < 3; ++k)
          assert_true(fabs(pixel[k] - rgb[k] * alpha) <= 1e-15);
        for (int k = 0; k < 4; ++k)
          assert_true(fabs(rgba[4 * p + k] - pixel[k]) <= 1e-6);
        assert_true(isnan(value) ? isnan(values[p]) : values[p] == (float)value);
      }
      assert_true((partly > 0) == (samples > 1));
      /* Of another colour, and back. */
      assert_int_equal(tetcast_frame_recolor(b, white), TETCAST_OK);
      for (int i = 0; i < 4 * PIXELS; ++i)
        assert_true(pixels_of(b)[i] == pixels_of(b)[i / 4 * 4 + 3]);
      assert_int_equal(tetcast_frame_recolor(b, clear), TETCAST_OK);
      assert_memory_equal(pixels_of(a), pixels_of(b), 4 * PIXELS * sizeof(double));
      float *before = malloc(4 * PIXELS * sizeof *before);
      memcpy(before, rgba, 4 * PIXELS * sizeof *before);
      assert_int_equal(tetcast_frame_recolor(f, white), TETCAST_OK);
      assert_int_equal(tetcast_frame_recolor(f, clear), TETCAST_OK);
      assert_memory_equal(before, rgba, 4 * PIXELS * sizeof *before);
      free(before);
      tetcast_frame_destroy(&a);
      tetcast_frame_destroy(&b);
      tetcast_frame_destroy(&f);
    }
  }
  tetcast_transfer_function_destroy(&clear);
  tetcast_transfer_function_destroy(&dense);
  tetcast_transfer_function_destroy(&white);
  world_end(&world);
}

/* Of several samples a pixel's value is the mean of those that have one, and its alpha their share: those of a picture
 * of that many times the pixels. */
static void samples_are_means_of_what_is_met(void **state) {
  (void)state;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 4, 0.6, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  for (int blend = 0; blend < BLENDS; ++blend) {
    TetcastFrame *coarse = shoot_with(&world, blends[blend], &camera, TETCAST_TYPE_FLOAT64, 4, 0), *fine = NULL;
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = 2 * W;
    desc.height = 2 * H;
    desc.channels = TETCAST_CHANNEL_VALUE;
    assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &fine), TETCAST_OK);
    const TetcastRenderDesc render = render_desc();
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, fine, NULL), TETCAST_OK);
    for (int p = 0; p < PIXELS; ++p) {
      double sum = 0, met = 0;
      for (int i = 0; i < 4; ++i) {
        const double value = values_of(fine)[(2 * (p / W) + i / 2) * 2 * W + 2 * (p % W) + i % 2];
        if (!isnan(value))
          sum += value, ++met;
      }
      assert_true(pixels_of(coarse)[4 * p + 3] == met / 4);
      assert_true(met > 0 ? fabs(values_of(coarse)[p] - sum / met) < 1e-14 : isnan(values_of(coarse)[p]));
    }
    tetcast_frame_destroy(&coarse);
    tetcast_frame_destroy(&fine);
  }
  world_end(&world);
}

static void refuses(World *world, uint32_t channels, TetcastIntegrator integrator, const char *word) {
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = frame_of(world, TETCAST_TYPE_FLOAT64, channels);
  TetcastRenderDesc render = render_desc();
  render.integrator = integrator;
  render.integrator_n = 2;
  assert_int_equal(tetcast_scene_render(world->scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
  tetcast_frame_destroy(&frame);
}

static void what_is_not_possible_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  const TetcastIntegrator exact = TETCAST_INTEGRATOR_EXACT;
  assert_int_equal(tetcast_scene_blend(world.scene), TETCAST_BLEND_COMPOSITE);
  assert_int_equal(tetcast_scene_set_blend(NULL, TETCAST_BLEND_MAXIMUM), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_set_blend(world.scene, (TetcastBlend)5), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_set_blend(world.scene, (TetcastBlend)-1), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_AVERAGE), TETCAST_OK);
  refuses(&world, 0, exact, "no field");
  set_values(&world, world.cube.values, TETCAST_POINT);
  refuses(&world, TETCAST_CHANNEL_ERROR, exact, "blend mode");
  refuses(&world, TETCAST_CHANNEL_PATH_LENGTH, exact, "path_length");
  refuses(&world, 0, TETCAST_INTEGRATOR_GAUSS, "blend mode");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_COMPOSITE), TETCAST_OK);
  refuses(&world, TETCAST_CHANNEL_VALUE, exact, "value");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MINIMUM), TETCAST_OK);
  TetcastField *field = field_of(world.fixture.context, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
  const TetcastField *const fields[] = {field};
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.emission = fields;
  desc.emission_count = 1;
  assert_int_equal(tetcast_scene_set_coefficients(world.scene, &desc), TETCAST_OK);
  refuses(&world, 0, exact, "coefficients");
  tetcast_field_destroy(&field);
  /* Without the channel there is nothing to colour by. */
  TetcastFrame *frame = frame_of(&world, TETCAST_TYPE_FLOAT64, 0);
  TetcastTransferFunction *transfer = gray_of(world.fixture.context, 1);
  assert_int_equal(tetcast_frame_recolor(frame, transfer), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_recolor(frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_recolor(NULL, transfer), TETCAST_ERROR_ARGUMENT);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(linear_field_has_its_closed_form),
                                     cmocka_unit_test(constant_field_stays_exact),
                                     cmocka_unit_test(nan_counts_for_nothing),
                                     cmocka_unit_test(cells_count_by_their_lengths),
                                     cmocka_unit_test(many_cells_add_up),
                                     cmocka_unit_test(units_change_no_bit),
                                     cmocka_unit_test(pixels_have_the_colour_of_their_values),
                                     cmocka_unit_test(samples_are_means_of_what_is_met),
                                     cmocka_unit_test(what_is_not_possible_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
