/* SPDX-License-Identifier: Apache-2.0 */
/* Extinctions that are scaled so that a camera sees neither a fog nor a wall: against a picture of the same rays. */
#include "world.h"

enum { W = 48, H = 36, PIXELS = W * H };

static TetcastTransferFunction *ramp(const World *world, double low, double high, double least, double most) {
  static const double color[4] = {0, 1, 0.5, 0.25};
  const double extinction[4] = {low, least, high, most};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = 1;
  desc.extinction = extinction;
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(world->fixture.context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* The mean alpha of pixels that see anything, and the share of those that are as good as opaque. */
static double look(World *world, const TetcastTransferFunction *transfer, const TetcastCamera *camera, double *opaque) {
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, NULL, frame, NULL), TETCAST_OK);
  const double *pixels = tetcast_frame_pixels(frame);
  double sum = 0;
  int seen = 0, most = 0;
  for (int i = 0; i < PIXELS; ++i) {
    sum += pixels[4 * i + 3];
    seen += pixels[4 * i + 3] > 0;
    most += pixels[4 * i + 3] > 0.99;
  }
  tetcast_frame_destroy(&frame);
  assert_true(seen > PIXELS / 20);
  *opaque = (double)most / seen;
  return sum / seen;
}

static TetcastCamera camera_from(int i) {
  TetcastCamera camera = camera_of(2.5, -2, 2.2, 0.5, 0.5, 0.5);
  if (i % 2) {
    camera.projection = TETCAST_ORTHOGRAPHIC;
    camera.height = 2;
  }
  return camera;
}

static void a_scaled_function_is_as_opaque_as_asked(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.2, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  static const double opacities[] = {0.2, 0.5, 0.6};
  for (int i = 0; i < 12; ++i) {
    const TetcastCamera camera = camera_from(i);
    TetcastTransferFunction *shape = ramp(&world, -1, 2, 1e-7 * i, pow(1e4, i % 3)), *scaled = NULL;
    assert_int_equal(tetcast_scene_scale_transfer_function(world.scene, shape, &camera, opacities[i / 4], &scaled),
                     TETCAST_OK);
    double opaque;
    assert_true(fabs(look(&world, scaled, &camera, &opaque) - opacities[i / 4]) < 1e-6 || opaque > 0.045);
    assert_true(opaque < 0.055);
    int64_t count, color_count;
    const double *knots = tetcast_transfer_function_extinction(scaled, &count),
                 *given = tetcast_transfer_function_extinction(shape, &count);
    assert_int_equal(count, 2);
    assert_true(fabs(knots[1] * given[3] - knots[3] * given[1]) <= 1e-14 * fabs(knots[3] * given[1]));
    assert_memory_equal(tetcast_transfer_function_color(scaled, &color_count),
                        tetcast_transfer_function_color(shape, &count), 4 * sizeof(double));
    tetcast_transfer_function_destroy(&shape);
    tetcast_transfer_function_destroy(&scaled);
  }
  world_end(&world);
}

/* A core that few rays meet, and that hides all: these are kept to one in twenty. */
static void few_rays_are_opaque(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.2, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  double range[2];
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values =
      (TetcastArray){.data = world.cube.values, .type = TETCAST_TYPE_FLOAT64, .count = world.cube.vertex_count};
  TetcastField *field = NULL;
  assert_int_equal(tetcast_field_create(world.fixture.context, &desc, &field), TETCAST_OK);
  tetcast_field_range(field, range, NULL);
  const double edge = range[0] + 0.8 * (range[1] - range[0]);
  const TetcastCamera camera = camera_from(0);
  static const double color[4] = {0, 1, 0.5, 0.25};
  const double knots[8] = {edge, 1e-3, edge, 1, range[1], 1, range[1] + 1, 1};
  TetcastTransferFunctionDesc core = tetcast_transfer_function_desc_default();
  core.color = color;
  core.color_count = 1;
  core.extinction = knots;
  core.extinction_count = 4;
  TetcastTransferFunction *shape = NULL, *scaled = NULL;
  assert_int_equal(tetcast_transfer_function_create(world.fixture.context, &core, &shape), TETCAST_OK);
  assert_int_equal(tetcast_scene_scale_transfer_function(world.scene, shape, &camera, 0.9, &scaled), TETCAST_OK);
  double opaque;
  const double mean = look(&world, scaled, &camera, &opaque);
  assert_true(opaque < 0.055 || mean < 0.25);
  tetcast_transfer_function_destroy(&shape);
  tetcast_transfer_function_destroy(&scaled);
  tetcast_field_destroy(&field);
  world_end(&world);
}

/* What has been measured elsewhere, by rays of those depths, and a shape that is moved without a scene. */
static void depths_may_come_from_elsewhere(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastContext *context = world.fixture.context;
  double depths[40], given[40], factor = 0;
  for (int clear = 0; clear < 2; ++clear) {
    for (int power = -300; power <= 300; power += 100) { /* the unit of length doesn't matter */
      double mean = 0;
      for (int i = 0; i < 40; ++i)
        depths[i] = (0.1 + 0.01 * ((7 * i) % 40)) * pow(10, power);
      memcpy(given, depths, sizeof given);
      assert_int_equal(tetcast_opacity_factor(context, depths, 40, 0.4, clear, &factor), TETCAST_OK);
      for (int i = 0; i < 40; ++i)
        mean -= expm1(-depths[i] * factor) / 40;
      assert_true(fabs(mean - 0.4) < 1e-12);
      assert_memory_equal(depths, given, sizeof given); /* sorted is a copy */
    }
  }
  for (int i = 0; i < 40; ++i)
    depths[i] = i < 3 ? 1000 : 1;
  assert_int_equal(tetcast_opacity_factor(context, depths, 40, 0.9, 1, &factor), TETCAST_OK);
  assert_true(factor < 0.26); /* three in forty are opaque: as clear as the mean depth may be */
  assert_int_equal(tetcast_opacity_factor(context, depths, 40, 0.9, 0, &factor), TETCAST_OK);
  assert_true(factor <= 6 / (3037 / 40.) * (1 + 1e-12));
  assert_int_equal(tetcast_opacity_factor(context, depths, 0, 0.5, 1, &factor), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_opacity_factor(context, depths, 40, 1, 1, &factor), TETCAST_ERROR_ARGUMENT);
  depths[7] = 0;
  assert_int_equal(tetcast_opacity_factor(context, depths, 40, 0.5, 1, &factor), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(world.fixture.message, "optical depth 7 is 0");
  TetcastTransferFunction *shape = ramp(&world, 0, 1, 0.5, 2), *moved = NULL;
  int64_t count;
  assert_int_equal(tetcast_transfer_function_stretch(context, shape, 10, 30, 7, &moved), TETCAST_OK);
  const double *knots = tetcast_transfer_function_extinction(moved, &count);
  assert_true(count == 2 && knots[0] == 10 && knots[1] == 1.75 && knots[2] == 30 && knots[3] == 7);
  tetcast_transfer_function_destroy(&moved);
  assert_int_equal(tetcast_transfer_function_stretch(context, shape, 3, 3, 7, &moved), TETCAST_OK);
  knots = tetcast_transfer_function_extinction(moved, &count);
  assert_true(count == 1 && knots[0] == 3 && knots[1] == 7);
  tetcast_transfer_function_destroy(&moved);
  assert_int_equal(tetcast_transfer_function_stretch(context, shape, 4, 3, 7, &moved), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_transfer_function_stretch(context, shape, 3, 4, -1, &moved), TETCAST_ERROR_ARGUMENT);
  tetcast_transfer_function_destroy(&shape);
  world_end(&world);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  const TetcastCamera camera = camera_from(0), nowhere = camera_of(0.5, 0.5, 4, 0.5, 0.5, 4);
  TetcastTransferFunction *shape = ramp(&world, 0, 1, 0, 0), *scaled = NULL;
  assert_int_equal(tetcast_scene_scale_transfer_function(world.scene, shape, &camera, 0.5, &scaled),
                   TETCAST_ERROR_ARGUMENT);
  set_values(&world, world.cube.values, TETCAST_POINT);
  const struct {
    const TetcastCamera *camera;
    double opacity;
  } bad[] = {{&camera, 0}, {&camera, 1}, {&camera, NAN}, {&nowhere, 0.5}, {NULL, 0.5}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
    assert_int_equal(tetcast_scene_scale_transfer_function(world.scene, shape, bad[i].camera, bad[i].opacity, &scaled),
                     TETCAST_ERROR_ARGUMENT);
  assert_null(scaled);
  assert_int_equal(tetcast_scene_scale_transfer_function(world.scene, shape, &camera, 0.5, &scaled), TETCAST_OK);
  int64_t count;
  assert_true(tetcast_transfer_function_extinction(scaled, &count)[3] == 0); /* of nothing nothing comes */
  tetcast_transfer_function_destroy(&scaled);
  tetcast_transfer_function_destroy(&shape);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_scaled_function_is_as_opaque_as_asked), cmocka_unit_test(few_rays_are_opaque),
      cmocka_unit_test(depths_may_come_from_elsewhere), cmocka_unit_test(what_cannot_be_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
