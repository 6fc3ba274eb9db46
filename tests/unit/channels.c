/* SPDX-License-Identifier: Apache-2.0 */
/* Channels of what rays meet: how many cells, counted anew by all cells' half-spaces in extended precision, and the
 * normal of the surface at which the depth lies, of surfaces whose normals are known. Other channels are tested where
 * their scenes are. */
#include "world.h"

enum { W = 41, H = 33, PIXELS = W * H };

static TetcastFrame *shoot(const World *world, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                           uint32_t channels, TetcastRenderStats *stats) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.channels = channels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, desc, frame, stats), TETCAST_OK);
  return frame;
}

static const double *channel_of(const TetcastFrame *frame, TetcastChannel channel) {
  return tetcast_frame_channel(frame, channel);
}

static void set_transfer(World *world, double extinction) {
  TetcastTransferFunction *transfer = gray_of(world->fixture.context, extinction);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

/* ── cells ── */

/* The length of the ray's part in a cell, between two distances. */
static long double length_in(const Cube *cube, int64_t cell, const double eye[3], const double direction[3],
                             long double from, long double to) {
  for (int k = 0; k < 4; ++k) {
    const double *v[4];
    for (int j = 0; j < 4; ++j)
      v[j] = &cube->vertices[3 * cube->cells[4 * cell + (k + j) % 4]]; /* v[0] is opposite the face */
    long double a[3], b[3], normal[3], inside = 0, along = 0, at = 0;
    for (int j = 0; j < 3; ++j)
      a[j] = (long double)v[2][j] - v[1][j], b[j] = (long double)v[3][j] - v[1][j];
    for (int j = 0; j < 3; ++j)
      normal[j] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
    for (int j = 0; j < 3; ++j) {
      inside += normal[j] * ((long double)v[0][j] - v[1][j]);
      along += normal[j] * direction[j];
      at += normal[j] * ((long double)eye[j] - v[1][j]);
    }
    if (inside < 0)
      along = -along, at = -at;
    if (along > 0)
      from = fmaxl(from, -at / along);
    else
      to = fminl(to, -at / along);
  }
  return to - from;
}

/* How many cells the ray through a pixel crosses from 0 to `stop`; *doubt is how many more it may be by rounding. */
static int count_cells(const World *world, const TetcastCamera *camera, int pixel, double stop, int *doubt) {
  double eye[3], direction[3];
  int count = 0;
  *doubt = 0;
  ray_of(camera, W, H, pixel, eye, direction);
  for (int64_t i = 0; i < world->cube.cell_count; ++i) {
    const long double length = length_in(&world->cube, i, eye, direction, 0, stop);
    count += length > 1e-12L;
    *doubt += fabsl(length) <= 1e-12L;
  }
  return count;
}

static void check_counts(const World *world, const TetcastCamera *camera, const TetcastFrame *frame, double stop) {
  int certain = 0, most = 0;
  for (int p = 0; p < PIXELS; ++p) {
    int doubt;
    const int wanted = count_cells(world, camera, p, stop, &doubt);
    const double got = channel_of(frame, TETCAST_CHANNEL_CELLS)[p];
    if (!(got >= wanted && got <= wanted + doubt))
      fail_msg("pixel %d: %g cells, not %d, or up to %d more", p, got, wanted, doubt);
    certain += doubt == 0;
    most = wanted > most ? wanted : most;
  }
  assert_true(certain > 9 * PIXELS / 10);
  assert_true(most > 2);
}

/* Whatever hides them, and in every kind of scene. */
static void cells_are_counted(void **state) {
  (void)state;
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(3, 2, 4, 1.6)};
  double stops[PIXELS];
  static const double distances[] = {3.4, 0.3, 4.4}; /* in the middle of the cube */
  const TetcastArray stop = {stops, TETCAST_TYPE_FLOAT64, PIXELS, 0};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 4, 0.6, 1, i % 4 == 3 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    set_values(&world, world.cube.values, TETCAST_POINT);
    set_transfer(&world, i % 2 ? 1e4 : 0);
    const TetcastIsosurface surface = {.value = 0.5, .color = {1, 0, 0}, .opacity = 1};
    if (i % 3 == 1)
      assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, &surface, 1), TETCAST_OK);
    if (i % 3 == 2)
      assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
    TetcastRenderDesc desc = render_desc();
    desc.stop = i > 5 ? &stop : NULL;
    for (int p = 0; p < PIXELS; ++p)
      stops[p] = distances[i % 3];
    TetcastRenderStats stats, with;
    TetcastFrame *frame = shoot(&world, &cameras[i % 3], &desc, 0, &stats),
                 *counted = shoot(&world, &cameras[i % 3], &desc, TETCAST_CHANNEL_CELLS, &with);
    check_counts(&world, &cameras[i % 3], counted, i > 5 ? distances[i % 3] : INFINITY);
    assert_memory_equal(tetcast_frame_pixels(frame), tetcast_frame_pixels(counted), sizeof(double) * 4 * PIXELS);
    assert_int_equal(stats.segments, with.segments);
    assert_int_equal(with.lost, 0);
    double sum = 0;
    for (int p = 0; p < PIXELS; ++p)
      sum += channel_of(counted, TETCAST_CHANNEL_CELLS)[p];
    if (i % 3 == 2) /* nothing ends these rays */
      assert_true(sum == (double)stats.segments);
    else if (i % 2 == 1)
      assert_true(sum > (double)stats.segments);
    tetcast_frame_destroy(&frame);
    tetcast_frame_destroy(&counted);
    world_end(&world);
  }
}

/* Clipped, and the mean of several samples: of two halves of a cube whose cells none of the samples tells apart. */
static void cells_are_clipped_and_averaged(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastField *field = field_of(world.fixture.context, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
  TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
  const TetcastField *fields[] = {field};
  coefficients.extinction = fields;
  coefficients.extinction_count = 1;
  assert_int_equal(tetcast_scene_set_coefficients(world.scene, &coefficients), TETCAST_OK);
  tetcast_field_destroy(&field);
  const TetcastCamera camera = parallel(0.5, 0.5, 5, 0.9);
  const TetcastHalfSpace nothing = {{0, 0, 1}, 2}, half = {{0, 0, -1}, -0.4};
  TetcastRenderDesc desc = render_desc();
  double sum[3] = {0};
  for (int i = 0; i < 3; ++i) {
    assert_int_equal(tetcast_scene_set_clip(world.scene, i == 0 ? &nothing : &half, i < 2), TETCAST_OK);
    desc.samples = i == 2 ? 4 : 1;
    TetcastRenderStats stats;
    TetcastFrame *frame = shoot(&world, &camera, &desc, TETCAST_CHANNEL_CELLS | TETCAST_CHANNEL_PATH_LENGTH, &stats);
    for (int p = 0; p < PIXELS; ++p)
      sum[i] += channel_of(frame, TETCAST_CHANNEL_CELLS)[p];
    assert_true(fabs(sum[i] * desc.samples - (double)stats.segments) < 1e-6);
    tetcast_frame_destroy(&frame);
  }
  assert_true(sum[0] == 0 && sum[1] > 0 && sum[1] < 0.7 * sum[2]);
  world_end(&world);
}

/* ── normals ── */

static double slanted(const double p[3]) {
  return 0.3 + 0.7 * p[0] - 0.9 * p[1] + 0.4 * p[2];
}

static void set_slanted(World *world) {
  double *values = malloc((size_t)world->cube.vertex_count * sizeof *values);
  for (int64_t i = 0; i < world->cube.vertex_count; ++i)
    values[i] = slanted(&world->cube.vertices[3 * i]);
  set_values(world, values, TETCAST_POINT);
  free(values);
}

/* Whether the normal of a pixel is `wanted`, of any length, turned towards the eye; NULL: 0, 0, 0. */
static void check_normal(const TetcastFrame *frame, const TetcastCamera *camera, int pixel, const double *wanted,
                         double off) {
  const double *normal = channel_of(frame, TETCAST_CHANNEL_NORMAL) + 3 * pixel;
  if (!wanted) {
    for (int k = 0; k < 3; ++k)
      assert_true(normal[k] == 0);
    return;
  }
  double eye[3], direction[3], length = 0, along = 0, seen = 0;
  ray_of(camera, W, H, pixel, eye, direction);
  for (int k = 0; k < 3; ++k)
    length += wanted[k] * wanted[k], along += wanted[k] * direction[k], seen += normal[k] * direction[k];
  length = along > 0 ? -sqrt(length) : sqrt(length);
  for (int k = 0; k < 3; ++k) {
    if (!(fabs(normal[k] - wanted[k] / length) <= off))
      fail_msg("pixel %d: normal %d is %.17g, not %.17g", pixel, k, normal[k], wanted[k] / length);
  }
  assert_true(seen <= 0);
}

/* Of a linear field the gradient is the same everywhere, also as the mean at vertices. */
static void isosurfaces_have_the_gradient(void **state) {
  (void)state;
  static const double gradient[3] = {0.7, -0.9, 0.4};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(-3, 2, -4, 1.6)};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 4, 0.6, i % 2 ? 0x1p-40 : 1, i % 6 == 5 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    for (int64_t v = 0; v < 3 * world.cube.vertex_count && i % 2; ++v)
      world.cube.vertices[v] *= 0x1p40;
    set_slanted(&world);
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = i % 3 ? TETCAST_SHADE_SURFACES : TETCAST_SHADE_NONE;
    shading.normals = i % 4 < 2 ? TETCAST_NORMALS_SMOOTH : TETCAST_NORMALS_FLAT;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    const TetcastIsosurface surfaces[] = {{.value = 0.47, .color = {1, 1, 0}, .opacity = 0.3},
                                          {.value = 0.5, .color = {1, 0, 0}, .opacity = i % 5 ? 1 : 0.3}};
    assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, surfaces, 2), TETCAST_OK);
    TetcastCamera camera = cameras[i % 3];
    for (int k = 0; k < 3 && i % 2; ++k)
      camera.eye[k] *= 0x1p-40, camera.target[k] *= 0x1p-40;
    if (i % 2)
      camera.height *= 0x1p-40;
    const TetcastRenderDesc desc = render_desc();
    TetcastFrame *both = shoot(&world, &camera, &desc, TETCAST_CHANNEL_DEPTH | TETCAST_CHANNEL_NORMAL, NULL),
                 *alone = shoot(&world, &camera, &desc, TETCAST_CHANNEL_NORMAL, NULL),
                 *plain = shoot(&world, &camera, &desc, 0, NULL);
    int met = 0;
    for (int p = 0; p < PIXELS; ++p) {
      const bool any = isfinite(channel_of(both, TETCAST_CHANNEL_DEPTH)[p]);
      check_normal(both, &camera, p, any ? gradient : NULL, 1e-5); /* gradients at vertices are floats */
      met += any;
    }
    assert_true(met > PIXELS / 30);
    assert_memory_equal(channel_of(both, TETCAST_CHANNEL_NORMAL), channel_of(alone, TETCAST_CHANNEL_NORMAL),
                        sizeof(double) * 3 * PIXELS);
    assert_memory_equal(tetcast_frame_pixels(plain), tetcast_frame_pixels(alone), sizeof(double) * 4 * PIXELS);
    tetcast_frame_destroy(&both);
    tetcast_frame_destroy(&alone);
    tetcast_frame_destroy(&plain);
    world_end(&world);
  }
}

/* The cube's faces from outside and from within, a slice in it, and fog before both. */
static void boundary_and_slices_have_theirs(void **state) {
  (void)state;
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)};
  for (int i = 0; i < 8; ++i) {
    const TetcastCamera *camera = &cameras[i % 2];
    World world;
    world_begin(&world, 3, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
    set_slanted(&world);
    const bool slice = i & 2, fog = i & 4;
    set_transfer(&world, fog ? 1e3 : 0);
    const TetcastSlice plane = {.normal = {3, 4, 5}, .offset = 6, .opacity = 0.5};
    const TetcastBoundary boundary = {.opacity = slice ? 0.25 : 0.75};
    assert_int_equal(tetcast_scene_set_slices(world.scene, &plane, slice), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_boundary(world.scene, slice ? NULL : &boundary), TETCAST_OK);
    TetcastRenderDesc desc = render_desc();
    desc.samples = i == 0 ? 4 : 1;
    TetcastFrame *frame = shoot(&world, camera, &desc, TETCAST_CHANNEL_DEPTH | TETCAST_CHANNEL_NORMAL, NULL);
    int met = 0;
    for (int p = 0; p < PIXELS && desc.samples == 1; ++p) {
      double eye[3], direction[3];
      const double depth = channel_of(frame, TETCAST_CHANNEL_DEPTH)[p];
      ray_of(camera, W, H, p, eye, direction);
      int axis = 0;
      double nearest = INFINITY, from_face[3];
      for (int k = 0; k < 3; ++k) {
        const double at = eye[k] + depth * direction[k];
        from_face[k] = fmin(fabs(at), fabs(1 - at));
        axis = from_face[k] < nearest ? k : axis;
        nearest = fmin(nearest, from_face[k]);
      }
      const double face[3] = {axis == 0, axis == 1, axis == 2};
      if (!isfinite(depth) || (fog && (slice || i % 2)))
        check_normal(frame, camera, p, NULL, 0); /* the fog before it is half opaque */
      else
        check_normal(frame, camera, p, slice ? plane.normal : face, 1e-14);
      met += isfinite(depth);
    }
    assert_true(met > PIXELS / 5 || desc.samples > 1);
    for (int p = 0; p < PIXELS && desc.samples > 1; ++p) { /* at the cube's edges the mean of two faces' */
      const double *n = channel_of(frame, TETCAST_CHANNEL_NORMAL) + 3 * p,
                   length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
      assert_true(length == 0 || fabs(length - 1) < 1e-14);
      met += n[0] != 0 && n[1] != 0;
    }
    assert_true(met > 0);
    tetcast_frame_destroy(&frame);
    world_end(&world);
  }
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_slanted(&world);
  const TetcastCamera camera = parallel(0.5, 0.5, 5, 1);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 4;
  for (int i = 0; i < 2; ++i) {
    desc.channels = TETCAST_CHANNEL_NORMAL | (i ? 0 : TETCAST_CHANNEL_ERROR);
    assert_int_equal(tetcast_scene_set_blend(world.scene, i ? TETCAST_BLEND_MINIMUM : TETCAST_BLEND_COMPOSITE),
                     TETCAST_OK);
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
    assert_int_equal(tetcast_scene_render(world.scene, &camera, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(world.fixture.message, "the channel normal"));
    tetcast_frame_destroy(&frame);
  }
  desc.channels = 512;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_ERROR_ARGUMENT);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_are_counted),
      cmocka_unit_test(cells_are_clipped_and_averaged),
      cmocka_unit_test(isosurfaces_have_the_gradient),
      cmocka_unit_test(boundary_and_slices_have_theirs),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
