/* SPDX-License-Identifier: Apache-2.0 */
/* Any rays through scenes: what frames have, closed forms, parts of rays, and what is refused. */
#include "lines.h"

enum { W = 40, H = 30, RAYS = W * H };

static TetcastCastDesc cast_desc(void) {
  TetcastCastDesc desc = tetcast_cast_desc_default();
  desc.isa = render_desc().isa;
  return desc;
}

static void cast(const TetcastScene *scene, const Lines *lines, const TetcastCastResult *result) {
  const TetcastRays rays = rays_of(lines);
  const TetcastCastDesc desc = cast_desc();
  TetcastRenderStats stats;
  assert_int_equal(tetcast_scene_cast(scene, &rays, &desc, result, &stats), TETCAST_OK);
  assert_int_equal(stats.rays, lines->count);
  assert_int_equal(stats.lost, 0);
}

/* ── as a frame ── */

static TetcastFrame *frame_with(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera,
                                uint32_t channels, int groups) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.channels = channels;
  desc.groups = groups;
  TetcastFrame *frame = NULL;
  const TetcastRenderDesc render = render_desc();
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(scene, camera, &render, frame, NULL), TETCAST_OK);
  return frame;
}

static void expect_near(const double *got, const double *wanted, size_t count, double tolerance, const char *what) {
  for (size_t i = 0; i < count; ++i) {
    if (isnan(wanted[i]) ? isnan(got[i]) : fabs(got[i] - wanted[i]) <= tolerance * fmax(1, fabs(wanted[i])))
      continue;
    fail_msg("%s: number %zu is %.17g instead of %.17g", what, i, got[i], wanted[i]);
  }
}

static const TetcastCamera cameras[] = {
    {.eye = {1.9, 1.4, 2.3}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0.1}, .fovy = 30},
    {.eye = {0.41, 0.52, 0.63}, .target = {1, 0.2, 0.1}, .up = {0, 1, 0.1}, .fovy = 60}, /* inside */
    {.eye = {-2, 0.3, 0.9},
     .target = {0.5, 0.5, 0.5},
     .up = {0, 1, 0},
     .projection = TETCAST_ORTHOGRAPHIC,
     .height = 1.5}};
enum { CAMERAS = sizeof cameras / sizeof *cameras };

/* The scene's picture, pixel by pixel, from any of the cameras. */
static void as_a_picture(const World *world, const char *what) {
  for (int c = 0; c < CAMERAS; ++c) {
    double color[4 * RAYS];
    Lines lines = lines_of_picture(&cameras[c], W, H);
    cast(world->scene, &lines, &(TetcastCastResult){.color = color});
    TetcastFrame *frame = frame_with(world->fixture.context, world->scene, &cameras[c], 0, 1);
    expect_near(color, tetcast_frame_pixels(frame), 4 * RAYS, 1e-13, what);
    tetcast_frame_destroy(&frame);
    lines_destroy(&lines);
  }
}

static void set_transfer(World *world, TetcastTransferFunction *transfer) {
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

static double *cell_values(const Cube *cube) {
  uint64_t seed = 3;
  double *values = malloc((size_t)cube->cell_count * sizeof *values);
  for (int64_t i = 0; i < cube->cell_count; ++i)
    values[i] = uniform(&seed);
  return values;
}

static void rays_of_a_frame(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 5, 0.4, 1, (TetcastTraversal)traversal);
    set_values(&world, world.cube.values, TETCAST_POINT);
    set_transfer(&world, transfer_of(world.fixture.context, 1));
    as_a_picture(&world, "points");
    const TetcastHalfSpace clip = {{1, 0.4, -0.3}, 0.5};
    assert_int_equal(tetcast_scene_set_clip(world.scene, &clip, 1), TETCAST_OK);
    as_a_picture(&world, "clip");
    assert_int_equal(tetcast_scene_set_clip(world.scene, NULL, 0), TETCAST_OK);
    const TetcastIsosurface surfaces[2] = {{.value = 0.45, .color = {1, 0.5, 0}, .opacity = 0.5},
                                           {.value = 0.6, .color = {0, 0.5, 1}, .opacity = 0.8}};
    assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, surfaces, 2), TETCAST_OK);
    as_a_picture(&world, "isosurfaces");
    assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, NULL, 0), TETCAST_OK);
    for (int blend = TETCAST_BLEND_MAXIMUM; blend <= TETCAST_BLEND_ADDITIVE; ++blend) {
      assert_int_equal(tetcast_scene_set_blend(world.scene, (TetcastBlend)blend), TETCAST_OK);
      as_a_picture(&world, "blend");
    }
    assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_COMPOSITE), TETCAST_OK);
    double *values = cell_values(&world.cube);
    set_values(&world, values, TETCAST_CELL);
    as_a_picture(&world, "cells");
    free(values);
    world_end(&world);
  }
}

/* Rows of a second quantity; the opacity tells the optical depth there. */
static void two_dimensions(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastContext *context = world.fixture.context;
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunction *one = transfer_of(context, 0.2), *two = transfer_of(context, 0.4);
  const TetcastTransferRow rows[2] = {{0, one}, {3, two}};
  assert_int_equal(tetcast_scene_set_transfer_rows(world.scene, rows, 2, NULL), TETCAST_OK);
  as_a_picture(&world, "rows");
  double color[4 * RAYS], depth[RAYS];
  Lines lines = random_lines(RAYS, 1, 5);
  cast(world.scene, &lines, &(TetcastCastResult){.color = color, .optical_depth = depth});
  for (int i = 0; i < RAYS; ++i)
    assert_true(fabs(color[4 * i + 3] + expm1(-depth[i])) <= 1e-14);
  lines_destroy(&lines);
  tetcast_transfer_function_destroy(&one);
  tetcast_transfer_function_destroy(&two);
  world_end(&world);
}

/* Coefficients of three groups, with a mesh in any unit. */
static void set_groups(World *world, double unit) {
  TetcastContext *context = world->fixture.context;
  const int64_t count = world->cube.vertex_count;
  double *values = malloc((size_t)count * sizeof *values);
  TetcastField *fields[3] = {NULL};
  for (int g = 0; g < 3; ++g) {
    for (int64_t i = 0; i < count; ++i)
      values[i] = (g + 1) * world->cube.values[i] / unit;
    fields[g] = field_of(context, values, count, TETCAST_POINT);
  }
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = (const TetcastField *const *)fields;
  desc.emission = (const TetcastField *const *)fields;
  desc.extinction_count = desc.emission_count = 3;
  assert_int_equal(tetcast_scene_set_coefficients(world->scene, &desc), TETCAST_OK);
  for (int g = 0; g < 3; ++g)
    tetcast_field_destroy(&fields[g]);
  free(values);
}

static void groups_of_a_frame(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  set_groups(&world, 1);
  as_a_picture(&world, "groups");
  const uint32_t channels = TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_TRANSMITTANCE |
                            TETCAST_CHANNEL_PATH_LENGTH | TETCAST_CHANNEL_ERROR;
  double color[4 * RAYS], radiance[3 * RAYS], depth[3 * RAYS], through[3 * RAYS], mean[RAYS], length[RAYS], error[RAYS];
  const TetcastCastResult result = {.color = color,
                                    .optical_depth = mean,
                                    .length = length,
                                    .error = error,
                                    .radiance = radiance,
                                    .group_optical_depth = depth,
                                    .transmittance = through};
  TetcastFrame *frame = frame_with(world.fixture.context, world.scene, &cameras[0], channels, 3);
  Lines lines = lines_of_picture(&cameras[0], W, H);
  cast(world.scene, &lines, &result);
  expect_near(radiance, tetcast_frame_channel(frame, TETCAST_CHANNEL_RADIANCE), 3 * RAYS, 1e-13, "radiance");
  expect_near(depth, tetcast_frame_channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH), 3 * RAYS, 1e-13, "depth");
  expect_near(through, tetcast_frame_channel(frame, TETCAST_CHANNEL_TRANSMITTANCE), 3 * RAYS, 1e-13, "transmittance");
  expect_near(length, tetcast_frame_channel(frame, TETCAST_CHANNEL_PATH_LENGTH), RAYS, 1e-13, "length");
  const double *pixels = tetcast_frame_pixels(frame);
  for (int i = 0; i < RAYS; ++i) {
    assert_true(fabs(mean[i] - (depth[3 * i] + depth[3 * i + 1] + depth[3 * i + 2]) / 3) <= 1e-14);
    assert_true(error[i] >= 0 && error[i] < 1e-9);
    for (int k = 0; k < 4; ++k)
      assert_true(fabs(color[4 * i + k] - pixels[4 * i + k]) <= 2 * fmax(error[i], 1e-15));
  }
  tetcast_frame_destroy(&frame);
  lines_destroy(&lines);
  world_end(&world);
}

/* ── closed forms ── */

/* Where a ray is in the cube of this edge, as distances. */
static bool chord(const Lines *lines, int64_t i, double edge, Real *from, Real *to, Real *unit) {
  const double *o = lines->origin[i], *d = lines->direction[i];
  *from = lines->begin[i];
  *to = lines->end[i];
  *unit = sqrtl((Real)d[0] * d[0] + (Real)d[1] * d[1] + (Real)d[2] * d[2]);
  for (int k = 0; k < 3; ++k) {
    const Real a = -(Real)o[k] / d[k], b = ((Real)edge - o[k]) / d[k];
    *from = fmaxl(*from, fminl(a, b));
    *to = fminl(*to, fmaxl(a, b));
  }
  return *to > *from;
}

/* The unit cube, times `scale`, with s = x + 2 y + 3 z in units of the edge, and κ = `factor` · s per edge. */
static void linear_world(World *world, double scale, double factor, TetcastTraversal traversal) {
  world_begin(world, 4, 0.4, scale, traversal);
  double *values = malloc((size_t)world->cube.vertex_count * sizeof *values);
  for (int64_t i = 0; i < world->cube.vertex_count; ++i) {
    const double *p = &world->cube.vertices[3 * i];
    values[i] = (p[0] + 2 * p[1] + 3 * p[2]) / scale;
  }
  set_values(world, values, TETCAST_POINT);
  free(values);
  const double color[4] = {0, 1, 1, 1}, extinction[2][2] = {{0, 0}, {6, 6 * factor / scale}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = 1;
  desc.extinction = extinction[0];
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(world->fixture.context, &desc, &transfer), TETCAST_OK);
  set_transfer(world, transfer);
}

/* Length, optical depth and opacity, of meshes of any size and matter of any density. */
static void linear_fields(void **state) {
  (void)state;
  static const double scales[] = {1, 1e30, 1e-30, 0.3}, factors[] = {1, 1e-3, 1e5, 1e-200};
  for (int s = 0; s < 4; ++s) {
    World world;
    linear_world(&world, scales[s], factors[s], s == 3 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    Lines lines = random_lines(RAYS, scales[s], 17);
    for (int i = 0; i < RAYS; i += 2) { /* parts of rays */
      lines.begin[i] = 5.5 * (i % 5) / 5;
      lines.end[i] = i % 4 ? 5.8 : lines.begin[i] + 0.01;
    }
    double color[4 * RAYS], depth[RAYS], length[RAYS];
    cast(world.scene, &lines, &(TetcastCastResult){.color = color, .optical_depth = depth, .length = length});
    for (int i = 0; i < RAYS; ++i) {
      Real from, to, unit, wanted = 0, inside = 0, sum = 0;
      if (chord(&lines, i, scales[s], &from, &to, &unit)) {
        for (int k = 0; k < 3; ++k)
          sum += (k + 1) * (lines.origin[i][k] + (from + to) / 2 * lines.direction[i][k]) / scales[s];
        inside = (to - from) * unit;
        wanted = factors[s] * sum * inside / scales[s];
      }
      if (!(fabsl(length[i] - inside) <= 2e-14L * scales[s]))
        fail_msg("scale %g, ray %d: length %.17g instead of %.17Lg", scales[s], i, length[i], inside);
      if (!(fabsl(depth[i] - wanted) <= 1e-13L * factors[s] * 6))
        fail_msg("scale %g, ray %d: depth %.17g instead of %.17Lg", scales[s], i, depth[i], wanted);
      assert_true(fabsl(color[4 * i + 3] + expm1l(-wanted)) <= 1e-14L + 1e-13L * factors[s] * 6);
    }
    lines_destroy(&lines);
    world_end(&world);
  }
}

/* Many short parts of rays make the whole. */
static void parts_add_up(void **state) {
  (void)state;
  enum { PARTS = 7, COUNT = 200 };
  World world;
  linear_world(&world, 1, 1, TETCAST_TRAVERSAL_SHELL);
  Lines whole = random_lines(COUNT, 1, 23), parts = lines_create(COUNT * PARTS);
  double depth[COUNT], length[COUNT], part_depth[COUNT * PARTS], part_length[COUNT * PARTS];
  for (int i = 0; i < COUNT; ++i) {
    whole.begin[i] = -INFINITY;
    for (int j = 0; j < PARTS; ++j) {
      const int at = i * PARTS + j;
      memcpy(parts.origin[at], whole.origin[i], sizeof parts.origin[at]);
      memcpy(parts.direction[at], whole.direction[i], sizeof parts.direction[at]);
      parts.begin[at] = j == 0 ? -INFINITY : j == 1 ? -1 : 1.1 * j;
      parts.end[at] = j == PARTS - 1 ? INFINITY : j == 0 ? -1 : 1.1 * (j + 1);
    }
  }
  cast(world.scene, &whole, &(TetcastCastResult){.optical_depth = depth, .length = length});
  cast(world.scene, &parts, &(TetcastCastResult){.optical_depth = part_depth, .length = part_length});
  for (int i = 0; i < COUNT; ++i) {
    double sum = 0, inside = 0;
    for (int j = 0; j < PARTS; ++j) {
      sum += part_depth[i * PARTS + j];
      inside += part_length[i * PARTS + j];
    }
    assert_true(fabs(sum - depth[i]) <= 1e-13 && fabs(inside - length[i]) <= 1e-13);
    assert_true(length[i] > 0);
  }
  lines_destroy(&whole);
  lines_destroy(&parts);
  world_end(&world);
}

/* The error is within its bound, wherever the rays come from. */
static void bounds_hold(void **state) {
  (void)state;
  World world;
  linear_world(&world, 1, 3, TETCAST_TRAVERSAL_SHELL);
  Lines lines = random_lines(RAYS, 1, 29);
  double color[4 * RAYS], error[RAYS];
  for (int i = 0; i < RAYS; i += 3)
    lines.end[i] = 5.5;
  for (int far = 0; far < 2; ++far) {
    for (int i = 0; far && i < RAYS; ++i) { /* in directions that are exact */
      for (int k = 0; k < 3; ++k) {
        lines.origin[i][k] = k == i % 3 ? -1e6 : 0.1 + 0.8 * lines.origin[i][k] / 10;
        lines.direction[i][k] = k == i % 3;
      }
      lines.end[i] = i % 2 ? INFINITY : 1e6 + 0.3;
    }
    cast(world.scene, &lines, &(TetcastCastResult){.color = color, .error = error});
    for (int i = 0; i < RAYS; ++i) {
      Real from, to, unit, sum = 0;
      Real wanted = 0;
      bool inside = true;
      for (int k = 0; far && k < 3; ++k)
        inside = inside && (k == i % 3 || (lines.origin[i][k] > 0 && lines.origin[i][k] < 1));
      if (far) { /* along an axis */
        for (int k = 0; k < 3; ++k) {
          const Real end = i % 2 ? 1 : 0.3L;
          sum += (k + 1) * (k == i % 3 ? end / 2 : lines.origin[i][k]) * end;
        }
        wanted = inside ? 3 * sum : 0;
      } else if (chord(&lines, i, 1, &from, &to, &unit)) {
        for (int k = 0; k < 3; ++k)
          sum += (k + 1) * (lines.origin[i][k] + (from + to) / 2 * lines.direction[i][k]);
        wanted = 3 * sum * (to - from) * unit;
      }
      const Real off = fabsl(color[4 * i + 3] + expm1l(-wanted));
      if (!(off <= error[i] && error[i] < (far ? 1e-5 : 1e-9)))
        fail_msg("ray %d: off by %Lg, bound %g", i, off, error[i]);
    }
  }
  lines_destroy(&lines);
  world_end(&world);
}

/* In a blend mode, the value; additive is the line integral. */
static void values_of_blend_modes(void **state) {
  (void)state;
  World world;
  linear_world(&world, 2, 1, TETCAST_TRAVERSAL_SHELL);
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_ADDITIVE), TETCAST_OK);
  Lines lines = random_lines(RAYS, 2, 31);
  for (int k = 0; k < 3; ++k)
    lines.origin[0][k] = lines.direction[0][k] = 5; /* away from the mesh */
  double value[RAYS];
  cast(world.scene, &lines, &(TetcastCastResult){.value = value});
  assert_true(isnan(value[0]));
  for (int i = 1; i < RAYS; ++i) {
    Real from, to, unit, sum = 0;
    assert_true(chord(&lines, i, 2, &from, &to, &unit));
    for (int k = 0; k < 3; ++k)
      sum += (k + 1) * (lines.origin[i][k] + (from + to) / 2 * lines.direction[i][k]) / 2;
    assert_true(fabsl(value[i] - sum * (to - from) * unit) <= 1e-13L * 12);
  }
  lines_destroy(&lines);
  world_end(&world);
}

/* ── threads, strides, what is refused ── */

static void same_bits_by_any_threads(void **state) {
  (void)state;
  enum { MANY = 3000 };
  World world;
  world_begin(&world, 6, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  set_transfer(&world, transfer_of(world.fixture.context, 1));
  Lines lines = random_lines(MANY, 1, 37);
  double *numbers[2];
  for (int t = 0; t < 2; ++t) {
    numbers[t] = calloc(7 * MANY, sizeof(double));
    use_threads(world.fixture.context, t ? 5 : 1);
    cast(world.scene, &lines,
         &(TetcastCastResult){.color = numbers[t],
                              .optical_depth = numbers[t] + 4 * MANY,
                              .length = numbers[t] + 5 * MANY,
                              .error = numbers[t] + 6 * MANY});
  }
  assert_memory_equal(numbers[0], numbers[1], 7 * MANY * sizeof(double));
  free(numbers[0]);
  free(numbers[1]);
  lines_destroy(&lines);
  world_end(&world);
}

/* How vertices are read depends on how many rays there are: lengths are the same to the bit, and what is seen is up to
 * the order of sums. */
static void each_ray_as_by_itself(void **state) {
  (void)state;
  World world;
  world_begin(&world, 14, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  set_transfer(&world, transfer_of(world.fixture.context, 1));
  enum { MANY = 2000 };
  Lines lines = random_lines(MANY, 1, 79);
  static double length[MANY], color[MANY][4], depth[MANY];
  cast(world.scene, &lines, &(TetcastCastResult){.color = color[0], .optical_depth = depth, .length = length});
  for (int64_t i = 0; i < MANY; ++i) {
    const Lines line = {1, &lines.origin[i], &lines.direction[i], &lines.begin[i], &lines.end[i]};
    double own_length, own_color[4], own_depth;
    cast(world.scene, &line,
         &(TetcastCastResult){.color = own_color, .optical_depth = &own_depth, .length = &own_length});
    assert_true(own_length == length[i]);
    expect_near(own_color, color[i], 4, 1e-15, "a ray by itself");
    expect_near(&own_depth, &depth[i], 1, 1e-14, "the depth of a ray by itself");
  }
  lines_destroy(&lines);
  world_end(&world);
}

/* Rows of one array, in single precision, and without begins and ends. */
static void strides_and_types(void **state) {
  (void)state;
  World world;
  linear_world(&world, 1, 1, TETCAST_TRAVERSAL_SHELL);
  Lines lines = random_lines(RAYS, 1, 41);
  float *rows = malloc(RAYS * 8 * sizeof *rows);
  for (int i = 0; i < RAYS; ++i) {
    for (int k = 0; k < 3; ++k) {
      rows[8 * i + k] = (float)lines.origin[i][k];
      rows[8 * i + 4 + k] = (float)lines.direction[i][k];
    }
  }
  for (int i = 0; i < RAYS; ++i) {
    for (int k = 0; k < 3; ++k) {
      lines.origin[i][k] = (double)rows[8 * i + k];
      lines.direction[i][k] = (double)rows[8 * i + 4 + k];
    }
  }
  double depth[2][RAYS];
  cast(world.scene, &lines, &(TetcastCastResult){.optical_depth = depth[0]});
  TetcastRays rays = tetcast_rays_default();
  rays.origins = (TetcastArray){rows, TETCAST_TYPE_FLOAT32, RAYS, 8 * sizeof *rows};
  rays.directions = (TetcastArray){rows + 4, TETCAST_TYPE_FLOAT32, RAYS, 8 * sizeof *rows};
  const TetcastCastDesc desc = cast_desc();
  assert_int_equal(tetcast_scene_cast(world.scene, &rays, &desc, &(TetcastCastResult){.optical_depth = depth[1]}, NULL),
                   TETCAST_OK);
  assert_memory_equal(depth[0], depth[1], sizeof depth[0]);
  free(rows);
  lines_destroy(&lines);
  world_end(&world);
}

static void refuse(World *world, const TetcastRays *rays, const TetcastCastResult *result, const char *text) {
  world->fixture.message[0] = 0;
  assert_int_equal(tetcast_scene_cast(world->scene, rays, NULL, result, NULL), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, text))
    fail_msg("'%s' is not in '%s'", text, world->fixture.message);
}

static void what_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  double numbers[4 * 4];
  const TetcastCastResult color = {.color = numbers}, groups = {.radiance = numbers}, value = {.value = numbers},
                          depth = {.optical_depth = numbers};
  Lines lines = random_lines(4, 1, 43);
  TetcastRays rays = rays_of(&lines);
  refuse(&world, &rays, &color, "no field");
  set_values(&world, world.cube.values, TETCAST_POINT);
  refuse(&world, &rays, NULL, "result is NULL");
  refuse(&world, &(TetcastRays){0}, &color, "_default()");
  refuse(&world, &rays, &groups, "only scenes with coefficients");
  refuse(&world, &rays, &value, "there is no value");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
  refuse(&world, &rays, &depth, "no optical depth");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_COMPOSITE), TETCAST_OK);
  const double kept[3] = {lines.direction[2][0], lines.direction[2][1], lines.direction[2][2]};
  memset(lines.direction[2], 0, sizeof lines.direction[2]);
  refuse(&world, &rays, &color, "ray 2: the direction is 0, 0, 0");
  lines.direction[2][1] = NAN;
  refuse(&world, &rays, &color, "ray 2: a component of the direction");
  memcpy(lines.direction[2], kept, sizeof kept);
  lines.end[1] = -1;
  refuse(&world, &rays, &color, "ray 1: it begins at 0, after its end at -1");
  lines.end[1] = NAN;
  refuse(&world, &rays, &color, "ray 1: begin or end is NaN");
  lines.end[1] = 0;
  lines.origin[3][2] = INFINITY;
  refuse(&world, &rays, &color, "ray 3: a coordinate of the origin");
  lines.origin[3][2] = 0;
  rays.directions.count = 3;
  refuse(&world, &rays, &color, "3 directions for 4 origins");
  rays.directions.count = 4;
  rays.ends.type = TETCAST_TYPE_INT32;
  refuse(&world, &rays, &color, "type of ends");
  rays.ends = (TetcastArray){NULL, TETCAST_TYPE_FLOAT64, 4, 0};
  refuse(&world, &rays, &color, "ends are NULL");
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.shade = TETCAST_SHADE_ALL;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  rays = rays_of(&lines);
  refuse(&world, &rays, &color, "light in the volume");
  assert_int_equal(tetcast_scene_set_shading(world.scene, NULL), TETCAST_OK);
  const TetcastBoundary boundary = {.opacity = 1, .edges = 1};
  assert_int_equal(tetcast_scene_set_boundary(world.scene, &boundary), TETCAST_OK);
  refuse(&world, &rays, &color, "edges");
  assert_int_equal(tetcast_scene_set_boundary(world.scene, NULL), TETCAST_OK);
  assert_int_equal(tetcast_scene_cast(NULL, &rays, NULL, &color, NULL), TETCAST_ERROR_ARGUMENT);
  lines_destroy(&lines);
  world_end(&world);
}

static void no_rays(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  const TetcastRays none = tetcast_rays_default();
  TetcastRenderStats stats = {.rays = 9};
  assert_int_equal(tetcast_scene_cast(world.scene, &none, NULL, &(TetcastCastResult){0}, &stats), TETCAST_OK);
  assert_int_equal(stats.rays, 0);
  world_end(&world);
}

static bool stop(void *user, double fraction) {
  (void)fraction;
  ++*(int *)user;
  return false;
}

static void progress_may_cancel(void **state) {
  (void)state;
  World world;
  int calls = 0;
  world_begin(&world, 4, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  use_threads(world.fixture.context, 1); /* with more, the others may have done it all before */
  Lines lines = random_lines(5000, 1, 47);
  double *color = calloc(4 * 5000, sizeof *color);
  const TetcastRays rays = rays_of(&lines);
  TetcastCastDesc desc = cast_desc();
  desc.progress = (TetcastProgress){stop, &calls};
  assert_int_equal(tetcast_scene_cast(world.scene, &rays, &desc, &(TetcastCastResult){.color = color}, NULL),
                   TETCAST_ERROR_CANCELLED);
  assert_int_equal(calls, 1);
  free(color);
  lines_destroy(&lines);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rays_of_a_frame),       cmocka_unit_test(two_dimensions),
      cmocka_unit_test(groups_of_a_frame),     cmocka_unit_test(linear_fields),
      cmocka_unit_test(parts_add_up),          cmocka_unit_test(bounds_hold),
      cmocka_unit_test(values_of_blend_modes), cmocka_unit_test(same_bits_by_any_threads),
      cmocka_unit_test(each_ray_as_by_itself), cmocka_unit_test(strides_and_types),
      cmocka_unit_test(what_is_refused),       cmocka_unit_test(no_rays),
      cmocka_unit_test(progress_may_cancel),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
