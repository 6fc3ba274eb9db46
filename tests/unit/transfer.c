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

/* Every preset, its reverse and its kind; a shape over [0, 1] is fitted as a preset is. */
static void presets_have_kinds_and_reverses(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  int kinds[TETCAST_PRESET_CATEGORICAL + 1] = {0};
  for (int i = 0; tetcast_preset_name(i); ++i) {
    char name[64];
    snprintf(name, sizeof name, "%s_r", tetcast_preset_name(i));
    const TetcastPresetKind kind = tetcast_preset_kind(tetcast_preset_name(i));
    ++kinds[kind];
    assert_int_equal(kind, tetcast_preset_kind(name));
    TetcastTransferFunction *map, *reverse;
    assert_int_equal(tetcast_transfer_function_create_preset(fixture.context, tetcast_preset_name(i), -1, 3, 2, &map),
                     TETCAST_OK);
    assert_int_equal(tetcast_transfer_function_create_preset(fixture.context, name, -1, 3, 2, &reverse), TETCAST_OK);
    int64_t count, reverse_count;
    const double *a = tetcast_transfer_function_color(map, &count);
    const double *b = tetcast_transfer_function_color(reverse, &reverse_count);
    assert_int_equal(count, reverse_count);
    for (int64_t k = 0; k < count; ++k) {
      const double *last = b + 4 * (count - 1 - k);
      assert_true(fabs(a[4 * k] + last[0] - 2) < 1e-12);
      assert_memory_equal(a + 4 * k + 1, last + 1, 3 * sizeof *a);
      if (kind == TETCAST_PRESET_CATEGORICAL) /* both ends of a step have its colour */
        assert_memory_equal(a + 4 * k + 1, a + 4 * (k ^ 1) + 1, 3 * sizeof *a);
    }
    const double *ramp = tetcast_transfer_function_extinction(map, &count);
    assert_int_equal(count, 2);
    assert_true(ramp[0] == -1 && ramp[1] == 0 && ramp[2] == 3 && ramp[3] == 2);
    tetcast_transfer_function_destroy(&map);
    tetcast_transfer_function_destroy(&reverse);
  }
  assert_true(kinds[TETCAST_PRESET_SEQUENTIAL] >= 8 && kinds[TETCAST_PRESET_DIVERGING] == 2 &&
              kinds[TETCAST_PRESET_CATEGORICAL] == 2);
  const char *const unknown[] = {"plaid", "viridis_", "viridis_rr", "viridis_r_r", "_r", "", "viridi"};
  for (size_t i = 0; i < sizeof unknown / sizeof *unknown; ++i)
    assert_int_equal(tetcast_preset_kind(unknown[i]), TETCAST_PRESET_NONE);
  assert_int_equal(tetcast_preset_kind(NULL), TETCAST_PRESET_NONE);
  TetcastTransferFunction *none;
  const double bad[][3] = {{1, 0, 1}, {0, 1, -1}, {0, (double)INFINITY, 1}, {0, 1, (double)NAN}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
    assert_int_equal(
        tetcast_transfer_function_create_preset(fixture.context, "gray", bad[i][0], bad[i][1], bad[i][2], &none),
        TETCAST_ERROR_ARGUMENT);
  fixture_end(&fixture);
}

static void same_knots(const TetcastTransferFunction *one, const TetcastTransferFunction *other) {
  int64_t count, other_count;
  const double *a = tetcast_transfer_function_color(one, &count);
  const double *b = tetcast_transfer_function_color(other, &other_count);
  assert_int_equal(count, other_count);
  assert_memory_equal(a, b, 4 * (size_t)count * sizeof *a);
  a = tetcast_transfer_function_extinction(one, &count);
  b = tetcast_transfer_function_extinction(other, &other_count);
  assert_int_equal(count, other_count);
  assert_memory_equal(a, b, 2 * (size_t)count * sizeof *a);
}

static void shapes_are_fitted(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(4, 0.3);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  Body body = body_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL, cube.values, cube.vertex_count, TETCAST_POINT);
  TetcastScene *scene = NULL;
  assert_int_equal(tetcast_scene_create(fixture.context, body.volume, &scene), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(scene, body.field), TETCAST_OK);
  TetcastTransferFunction *shape, *fitted, *preset;
  /* Neither the size of the extinctions nor where they come from counts. */
  const double ranges[][2] = {{0.1, 0.7}, {0.5, 0.5}, {1, 1 + 0x1p-51}, {-1e300, 1e300}};
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; ++i) {
    const double low = ranges[i][0], high = ranges[i][1];
    for (int named = 0; named < 2; ++named) {
      const char *name = named ? "okabe-ito" : "magma_r";
      assert_int_equal(
          tetcast_transfer_function_create_preset(fixture.context, name, 0, 1, named ? 1 : 0x1p-40, &shape),
          TETCAST_OK);
      assert_int_equal(tetcast_scene_create_preset(scene, name, low, high, &preset), TETCAST_OK);
      assert_int_equal(tetcast_scene_fit_transfer_function(scene, shape, low, high, &fitted), TETCAST_OK);
      same_knots(preset, fitted);
      tetcast_transfer_function_destroy(&shape);
      tetcast_transfer_function_destroy(&preset);
      tetcast_transfer_function_destroy(&fitted);
    }
  }
  assert_int_equal(tetcast_transfer_function_create_preset(fixture.context, "gray", 0, 1, 0, &shape), TETCAST_OK);
  assert_int_equal(tetcast_scene_fit_transfer_function(scene, shape, 0, 1, &fitted), TETCAST_OK); /* nothing is seen */
  tetcast_transfer_function_destroy(&fitted);
  assert_int_equal(tetcast_scene_fit_transfer_function(scene, shape, 1, 0, &fitted), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_scene_fit_transfer_function(scene, NULL, 0, 1, &fitted), TETCAST_ERROR_ARGUMENT);
  assert_null(fitted);
  tetcast_transfer_function_destroy(&shape);
  tetcast_scene_destroy(&scene);
  body_destroy(&body);
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bad_knots_are_refused), cmocka_unit_test(opacity_becomes_extinction),
      cmocka_unit_test(presets_fit_any_unit),  cmocka_unit_test(presets_have_kinds_and_reverses),
      cmocka_unit_test(shapes_are_fitted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
