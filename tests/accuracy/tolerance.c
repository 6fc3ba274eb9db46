/* SPDX-License-Identifier: Apache-2.0 */
/* A tolerance is kept, and so is the bound in the error channel: random transfer functions of all strengths on point
 * and cell fields, against the exact picture. Prints how much of the tolerance is used. */
#include "support.h"

enum { SIZE = 24, PIXELS = SIZE * SIZE, SCENES = 150 };

typedef struct Picture {
  double rgba[4 * PIXELS], error[PIXELS], largest;
} Picture;

static void render(TetcastContext *context, const TetcastScene *scene, double tolerance, int samples, TetcastType type,
                   Picture *picture) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = SIZE;
  frame_desc.type = type;
  frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  TetcastRenderDesc desc = render_desc();
  desc.tolerance = tolerance;
  desc.samples = samples;
  TetcastRenderStats stats;
  const TetcastCamera camera = camera_of(2.2, 1.7, 2.9, 0.5, 0.5, 0.5);
  assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, &stats), TETCAST_OK);
  const void *rgba = tetcast_frame_pixels(frame), *error = tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR);
  picture->largest = stats.error;
  double largest = 0;
  for (int i = 0; i < PIXELS; ++i) {
    const bool wide = type == TETCAST_TYPE_FLOAT64;
    for (int k = 0; k < 4; ++k) {
      picture->rgba[4 * i + k] = wide ? ((const double *)rgba)[4 * i + k] : (double)((const float *)rgba)[4 * i + k];
    }
    picture->error[i] = wide ? ((const double *)error)[i] : (double)((const float *)error)[i];
    largest = fmax(largest, picture->error[i]);
    if (picture->rgba[4 * i + 3] > 0)
      assert_true(picture->error[i] > 0);
  }
  assert_true(largest == stats.error);
  tetcast_frame_destroy(&frame);
}

static double largest_color(const TetcastTransferFunction *transfer) {
  int64_t count;
  const double *color = tetcast_transfer_function_color(transfer, &count);
  double largest = 1;
  for (int64_t i = 0; i < 4 * count; ++i) {
    if (i % 4 > 0)
      largest = fmax(largest, color[i]);
  }
  return largest;
}

/* The share of the tolerance that the worst pixel uses. */
static double check(const Picture *exact, const Picture *picture, double tolerance) {
  double worst = 0;
  for (int i = 0; i < PIXELS; ++i) {
    double off = 0;
    for (int k = 0; k < 4; ++k)
      off = fmax(off, fabs(picture->rgba[4 * i + k] - exact->rgba[4 * i + k]));
    assert_true(off <= picture->error[i] + exact->error[i]);
    worst = fmax(worst, off / tolerance);
  }
  assert_true(picture->largest <= tolerance + exact->largest); /* what rounding takes comes on top */
  return worst;
}

static void tolerances_are_kept(void **state) {
  (void)state;
  static const double tolerances[] = {1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 3, 1e9};
  enum { N = sizeof tolerances / sizeof *tolerances };
  double used[N] = {0};
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 5;
  Cube cube = cube_create(7, 0.6);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  TetcastField *fields[2] = {field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT), NULL};
  double *cells = malloc((size_t)cube.cell_count * sizeof *cells);
  for (int64_t i = 0; i < cube.cell_count; ++i)
    cells[i] = uniform(&seed);
  fields[1] = field_of(fixture.context, cells, cube.cell_count, TETCAST_CELL);
  Picture *exact = malloc(sizeof *exact), *picture = malloc(sizeof *picture);
  for (int i = 0; i < SCENES; ++i) {
    const TetcastTraversal traversal = i % 5 == 4 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL;
    Body body = {volume_of(fixture.context, mesh, traversal), fields[i % 3 == 2]};
    TetcastTransferFunction *transfer = random_transfer(fixture.context, &seed);
    TetcastScene *scene = scene_of(fixture.context, &body, transfer);
    const double color = largest_color(transfer);
    const int samples = i % 7 == 6 ? 3 : 1;
    render(fixture.context, scene, 0, samples, TETCAST_TYPE_FLOAT64, exact);
    assert_true(exact->largest <= color); /* which is what a channel may be off at most */
    for (int j = 0; j < N; ++j) {
      render(fixture.context, scene, tolerances[j], samples, TETCAST_TYPE_FLOAT64, picture);
      used[j] = fmax(used[j], check(exact, picture, tolerances[j]));
      if (tolerances[j] > 1e-12 * color)
        assert_true(used[j] <= 1);
    }
    render(fixture.context, scene, 1e-5, samples, TETCAST_TYPE_FLOAT32, picture); /* rounding to float comes on top */
    check(exact, picture, 1e-5 + 6e-8 * color);
    tetcast_scene_destroy(&scene);
    tetcast_transfer_function_destroy(&transfer);
    tetcast_volume_destroy(&body.volume);
  }
  printf("%10s %s\n", "tolerance", "largest share of it that is used");
  for (int j = 0; j < N; ++j)
    printf("%10.0e %.3g\n", tolerances[j], used[j]);
  free(exact);
  free(picture);
  free(cells);
  for (int i = 0; i < 2; ++i)
    tetcast_field_destroy(&fields[i]);
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

static void what_has_no_bound_is_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube cube = cube_create(1, 0);
  Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = transfer_of(fixture.context, 1);
  TetcastScene *scene = scene_of(fixture.context, &body, transfer);
  const TetcastCamera camera = camera_of(2, 2, 3, 0.5, 0.5, 0.5);
  for (int with_channel = 0; with_channel < 2; ++with_channel) {
    TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
    frame_desc.width = frame_desc.height = 4;
    frame_desc.channels = with_channel ? TETCAST_CHANNEL_ERROR : 0;
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
    assert_int_equal(tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR) != NULL, with_channel);
    TetcastRenderDesc desc = tetcast_render_desc_default();
    TetcastRenderStats stats;
    static const double wrong[] = {-1e-3, NAN, INFINITY};
    for (int i = 0; i < 3; ++i) {
      desc.tolerance = wrong[i];
      assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, &stats), TETCAST_ERROR_ARGUMENT);
    }
    desc.tolerance = 0;
    desc.integrator = TETCAST_INTEGRATOR_MIDPOINT;
    const TetcastStatus status = tetcast_scene_render(scene, &camera, &desc, frame, &stats);
    assert_int_equal(status, with_channel ? TETCAST_ERROR_ARGUMENT : TETCAST_OK);
    if (!status)
      assert_true(isnan(stats.error));
    desc.tolerance = 1e-3;
    assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, &stats), TETCAST_ERROR_ARGUMENT);
    tetcast_frame_destroy(&frame);
  }
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 4;
  frame_desc.channels = 1U << 31;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_ERROR_ARGUMENT);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(tolerances_are_kept),
                                     cmocka_unit_test(what_has_no_bound_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
