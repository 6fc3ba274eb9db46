/* SPDX-License-Identifier: Apache-2.0 */
/* Observed orders of convergence of the integrators to compare with, against the exact one; on a smooth profile and at
 * knots. (Etiene et al., Verifying volume rendering using discretization error analysis, 2014.) Prints a table. */
#include "support.h"

#include "optics/sampled.h"

#include "plain.h"

static TetcastTransferFunction *transfer_with(TetcastContext *context, const double (*color)[4], int64_t colors,
                                              const double (*extinction)[2], int64_t extinctions) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = colors;
  desc.extinction = extinction[0];
  desc.extinction_count = extinctions;
  TetcastTransferFunction *transfer;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

enum { SMOOTH, KINK, STEP };

static TetcastTransferFunction *profile(TetcastContext *context, int kind) {
  static const double color[2][4] = {{0, 1, 0.3, 0.1}, {1, 0.2, 0.5, 1}};
  static const double smooth[2][2] = {{0, 0.5}, {1, 4}}, kink[3][2] = {{0, 0.5}, {0.5, 6}, {1, 0.5}},
                      step[4][2] = {{0, 0.5}, {0.5, 0.5}, {0.5, 6}, {1, 6}};
  switch (kind) {
  case SMOOTH:
    return transfer_with(context, color, 2, smooth, 2);
  case KINK:
    return transfer_with(context, color, 2, kink, 3);
  default:
    return transfer_with(context, color, 2, step, 4);
  }
}

/* Largest error over paths that start anywhere, of `parts` cells each, integrated with (integrator, n). */
static double error_of(TetcastContext *context, int kind, TetcastIntegrator integrator, int n, int parts) {
  TetcastTransferFunction *transfer = profile(context, kind);
  TcSampler *sampler;
  assert_int_equal(tc_sampler_create(context, integrator, n, &sampler), TETCAST_OK);
  double worst = 0;
  uint64_t seed = 17;
  for (int i = 0; i < 100; ++i) {
    const double from = 0.1 + 0.2 * uniform(&seed), to = 0.7 + 0.2 * uniform(&seed), length = 1 + uniform(&seed);
    PlainLight exact = {.depth = 0};
    TcLight sampled = tc_light_begin();
    for (int j = 0; j < parts; ++j) {
      const double s0 = from + (to - from) * j / parts, s1 = from + (to - from) * (j + 1) / parts;
      plain_add(&exact, &transfer->pieces, length / parts, s0, s1);
      tc_light_add_sampled(&sampled, &transfer->pieces, sampler, length / parts, s0, s1);
    }
    double a[4], b[4];
    plain_end(&exact, a);
    tc_light_end(&sampled, b);
    for (int k = 0; k < 4; ++k)
      worst = fmax(worst, fabs(a[k] - b[k]));
  }
  tc_sampler_destroy(sampler);
  tetcast_transfer_function_destroy(&transfer);
  return worst;
}

static void observed_orders(void **state) {
  (void)state;
  static const char *const kinds[] = {"smooth", "kink", "step"};
  /* `refine` samples per cell, or cells; coarse to fine by a factor of 8. Orders at knots: an error of one cell's part
   * of the path, whose size is h² at a kink and h at a step, whatever the rule. */
  static const struct {
    const char *name;
    TetcastIntegrator integrator;
    int n, coarse; /* coarse: samples (n = 0), else cells */
    double order[3];
  } cases[] = {
      {"midpoint", TETCAST_INTEGRATOR_MIDPOINT, 0, 16, {2, 2, 1}},
      {"trapezoid", TETCAST_INTEGRATOR_TRAPEZOID, 0, 16, {2, 2, 1}},
      {"table", TETCAST_INTEGRATOR_TABLE, 0, 16, {2, 2, 2}},
      {"gauss:1", TETCAST_INTEGRATOR_GAUSS, 1, 16, {2, 2, 1}},
      {"gauss:2", TETCAST_INTEGRATOR_GAUSS, 2, 4, {4, 2, 1}},
      {"gauss:3", TETCAST_INTEGRATOR_GAUSS, 3, 2, {6, 2, 1}},
  };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  printf("%-10s %-7s %10s %10s %6s %8s\n", "integrator", "profile", "coarse", "fine", "order", "expected");
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    for (int kind = 0; kind < 3; ++kind) {
      const bool samples = cases[i].n == 0;
      const int coarse = kind == SMOOTH ? cases[i].coarse : 24, fine = 8 * coarse; /* high orders reach rounding soon */
      const double e0 =
          error_of(fixture.context, kind, cases[i].integrator, samples ? coarse : cases[i].n, samples ? 1 : coarse);
      const double e1 =
          error_of(fixture.context, kind, cases[i].integrator, samples ? fine : cases[i].n, samples ? 1 : fine);
      const double order = log(e0 / e1) / log(8), expected = cases[i].order[kind];
      printf("%-10s %-7s %10.2e %10.2e %6.2f %8.0f\n", cases[i].name, kinds[kind], e0, e1, order, expected);
      assert_true(e1 > 1e-15); /* still error of the method */
      assert_true(fabs(order - expected) < 0.35);
    }
  }
  fixture_end(&fixture);
}

/* In whole pictures: from the library, every integrator comes near the exact picture as n grows, and stays in [0, 1].
 */
static void pictures_converge(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(4, 0.5);
  Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = transfer_of(fixture.context, 1);
  TetcastScene *scene = scene_of(fixture.context, &body, transfer);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 24;
  TetcastFrame *frame;
  assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  double *exact = picture(fixture.context, &body, transfer, &camera, 24, 24, NULL);
  const int counts[][2] = {{0, 0}, {1, 64}, {1, 64}, {1, 16}, {16, 512}};
  for (int integrator = 1; integrator <= 4; ++integrator) {
    double error[2];
    for (int i = 0; i < 2; ++i) {
      TetcastRenderDesc desc = tetcast_render_desc_default();
      desc.integrator = (TetcastIntegrator)integrator;
      desc.integrator_n = counts[integrator][i];
      assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, NULL), TETCAST_OK);
      error[i] = largest_difference(exact, tetcast_frame_pixels(frame), 24 * 24 * 4);
    }
    assert_true(error[0] > 1e-4 && error[1] < error[0] / 10);
  }
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.integrator = TETCAST_INTEGRATOR_GAUSS;
  desc.integrator_n = TETCAST_MAX_GAUSS + 1;
  assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, NULL), TETCAST_ERROR_ARGUMENT);
  desc.integrator = TETCAST_INTEGRATOR_TABLE;
  desc.integrator_n = 1;
  assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, NULL), TETCAST_ERROR_ARGUMENT);
  free(exact);
  tetcast_frame_destroy(&frame);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(observed_orders), cmocka_unit_test(pictures_converge)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
