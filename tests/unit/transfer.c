/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer functions: what is refused, and how opacity becomes extinction. */
#include "support.h"

static TetcastTransferFunctionDesc desc_of(const double (*color)[4], int64_t colors, const double (*extinction)[2],
                                           int64_t n) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = colors;
  desc.extinction = extinction[0];
  desc.extinction_count = n;
  return desc;
}

static void bad_knots_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double good[2][4] = {{0, 1, 1, 1}, {1, 0, 0, 0}}, ramp[2][2] = {{0, 0}, {1, 2}};
  static const struct {
    double extinction[3][2];
    const char *word;
  } cases[] = {
      {{{0, 0}, {1, -1}, {2, 0}}, "negative"},     {{{0, 0}, {2, 1}, {1, 0}}, "sorted"},
      {{{0, 0}, {1, NAN}, {2, 0}}, "not finite"},  {{{0, 0}, {INFINITY, 1}, {2, 0}}, "not finite"},
      {{{1, 0}, {1, 1}, {1, 0}}, "more than two"}, {{{0, INFINITY}, {1, 1}, {2, 0}}, "not finite"},
  };
  TetcastTransferFunction *transfer;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastTransferFunctionDesc desc = desc_of(good, 2, cases[i].extinction, 3);
    assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
    assert_null(transfer);
    if (!strstr(fixture.message, cases[i].word))
      fail_msg("case %zu: %s", i, fixture.message);
  }
  const double negative_color[2][4] = {{0, 1, 1, 1}, {1, 0, -0.5, 0}};
  TetcastTransferFunctionDesc desc = desc_of(negative_color, 2, ramp, 2);
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  desc = desc_of(good, 0, ramp, 2);
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  desc = desc_of(good, 2, ramp, 2);
  desc.opacity = ramp[0];
  desc.opacity_count = 2;
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  desc.extinction = NULL; /* now opacity alone, but above 1 */
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(fixture.message, "above 1"));
  desc.opacity_count = 1;
  desc.unit_distance = 0;
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  desc.opacity_count = 0;
  desc.opacity = NULL;
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_ERROR_ARGUMENT);
  fixture_end(&fixture);
}

static void opacity_becomes_extinction(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double color[1][4] = {{0, 1, 1, 1}}, opacity[4][2] = {{0, 0}, {1, 0.5}, {2, 1e-20}, {3, 1}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = 1;
  desc.opacity = opacity[0];
  desc.opacity_count = 4;
  desc.unit_distance = 0.25;
  const double expected[3][4] = {{0, 4 * log(2), 4e-20, 4 * 53 * log(2)}, {0, 2, 4e-20, 4}, {0, 2, 4e-20, 4}};
  for (int model = 0; model < 3; ++model) {
    TetcastTransferFunction *transfer;
    desc.opacity_model = (TetcastOpacityModel)model;
    assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_OK);
    int64_t count;
    const double *knots = tetcast_transfer_function_extinction(transfer, &count);
    assert_int_equal(count, 4);
    for (int i = 0; i < 4; ++i) {
      assert_true(knots[2 * i] == i);
      assert_true(fabs(knots[2 * i + 1] - expected[model][i]) <= 2e-16 * expected[model][i]);
    }
    tetcast_transfer_function_destroy(&transfer);
  }
  fixture_end(&fixture);
}

/* The preset is neither empty nor a wall, whatever the units. */
static void presets_fit_any_unit(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  const double scales[] = {1, 1e-9, 1e9, 1e-30, 1e200};
  double *first = NULL;
  for (size_t i = 0; i < sizeof scales / sizeof *scales; ++i) {
    Cube cube = cube_create(4, 0.3);
    for (int64_t j = 0; j < 3 * cube.vertex_count; ++j)
      cube.vertices[j] *= scales[i];
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    Body body = body_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL, cube.values, cube.vertex_count, TETCAST_POINT);
    TetcastScene *scene = NULL;
    assert_int_equal(tetcast_scene_create(fixture.context, body.volume, &scene), TETCAST_OK);
    TetcastTransferFunction *transfer;
    assert_int_equal(tetcast_scene_create_preset(scene, "viridis", 0, 1, &transfer), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(fixture.message, "with a field"));
    assert_null(transfer);
    assert_int_equal(tetcast_scene_set_field(scene, body.field), TETCAST_OK);
    assert_int_equal(tetcast_scene_create_preset(scene, "plaid", 0, 1, &transfer), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(fixture.message, "viridis"));
    assert_null(transfer);
    double range[2];
    tetcast_field_range(body.field, range, NULL);
    assert_int_equal(tetcast_scene_create_preset(scene, "viridis", range[0], range[1], &transfer), TETCAST_OK);
    tetcast_scene_destroy(&scene);
    double bounds[6];
    tetcast_mesh_bounds(mesh, bounds);
    const TetcastCamera camera = tetcast_camera_default(bounds, 1);
    double *pixels = picture(fixture.context, &body, transfer, &camera, 16, 16, NULL);
    double sum = 0, covered = 0;
    for (int p = 0; p < 256; ++p) {
      sum += pixels[4 * p + 3];
      covered += pixels[4 * p + 3] > 0;
    }
    assert_true(sum / covered > 0.25 && sum / covered < 0.75);
    if (!first)
      first = pixels;
    else {
      assert_true(largest_difference(first, pixels, 1024) < 1e-9);
      free(pixels);
    }
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    tetcast_mesh_destroy(&mesh);
    cube_destroy(&cube);
  }
  free(first);
  assert_string_equal(tetcast_preset_name(0), "viridis");
  assert_null(tetcast_preset_name(100));
  assert_null(tetcast_preset_name(-1));
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bad_knots_are_refused),
      cmocka_unit_test(opacity_becomes_extinction),
      cmocka_unit_test(presets_fit_any_unit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
