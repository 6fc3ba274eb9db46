/* SPDX-License-Identifier: Apache-2.0 */
/* Stiff and extreme scenes: one ray down a bar whose field depends on x alone, against the integral in extended
 * precision along the same piecewise linear profile. Prints a table. */
#include "support.h"

#include <float.h>

enum { MOST = 8 };

typedef struct Scene {
  const char *name;
  int cells;        /* along the bar */
  double length;    /* of the bar */
  double low, high; /* values at its nodes run between these … */
  int pattern; /* … 0: up once, 1: up and down at every node, 2: constant `low`, 3: up, with a NaN node in the middle */
  double color[MOST][4];
  int colors;
  double extinction[MOST][2];
  int extinctions;
  double unit_distance; /* > 0: `extinction` is opacity */
} Scene;

static const Scene scenes[] = {
    {"extinction 0 next to 1e12 per cell",
     10,
     1,
     0,
     1,
     0,
     {{0, 1, 0, 0}, {1, 0, 0, 1}},
     2,
     {{0.33, 0}, {0.33, 1e13}, {0.66, 1e13}, {0.66, 0}},
     4,
     0},
    {"ramp from 0 to 1e12", 10, 1, 0, 1, 0, {{0, 1, 0, 0}, {1, 0, 0.5, 1}}, 2, {{0.05, 0}, {1, 1e12}}, 2, 0},
    {"peak of 1e-7 of the range",
     10,
     1,
     0,
     1,
     0,
     {{0, 1, 0.2, 0}, {1, 0, 0.4, 1}},
     2,
     {{0.51, 0}, {0.51000005, 3e7}, {0.5100001, 0}},
     3,
     0},
    {"the same peak crossed 1000 times",
     1000,
     1,
     0,
     1,
     1,
     {{0, 1, 0.2, 0}, {1, 0, 0.4, 1}},
     2,
     {{0.51, 0}, {0.51000005, 3e4}, {0.5100001, 0}},
     3,
     0},
    {"steps",
     17,
     2,
     0,
     1,
     0,
     {{0.3, 1, 0, 0}, {0.3, 0, 1, 0}, {0.6, 0.5, 0.5, 1}},
     3,
     {{0.2, 1}, {0.2, 5}, {0.7, 2}, {0.7, 0.1}},
     4,
     0},
    {"constant field on a step",
     5,
     1,
     0.25,
     0.25,
     2,
     {{0.25, 1, 0, 0}, {0.25, 0, 1, 0.5}},
     2,
     {{0.25, 1}, {0.25, 3}},
     2,
     0},
    {"constant field on a peak", 5, 1, 0.25, 0.25, 2, {{0, 1, 0.25, 0}}, 1, {{0.2, 0}, {0.25, 0.7}, {0.3, 0}}, 3, 0},
    {"opacity 1", 5, 1, 0, 1, 0, {{0, 1, 0.25, 0}, {1, 0.5, 1, 1}}, 2, {{0, 0}, {0.5, 1}, {1, 1}}, 3, 0.1},
    {"100,000 cells, soft",
     100000,
     1,
     0,
     1,
     1,
     {{0, 1, 0.25, 0}, {1, 0.5, 1, 1}},
     2,
     {{0.1, 0}, {0.5, 2}, {0.9, 0.5}},
     3,
     0},
    {"100,000 cells, constant", 100000, 1, 0.5, 0.5, 2, {{0, 1, 0.25, 0.125}}, 1, {{0, 0.1}}, 1, 0},
    {"optical depth 1e-15", 20, 1, 0, 1, 1, {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}}, 2, {{0, 2e-15}, {1, 0}}, 2, 0},
    {"optical depth 1e-290", 20, 1, 0, 1, 1, {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}}, 2, {{0, 2e-290}, {1, 0}}, 2, 0},
    {"optical depth 1e15", 20, 1, 0, 1, 1, {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}}, 2, {{0, 2e15}, {1, 1e15}}, 2, 0},
    {"field of ±1e300",
     9,
     1,
     -1e300,
     1e300,
     1,
     {{-1e300, 1, 0.25, 0.5}, {1e300, 0.5, 1, 1}},
     2,
     {{-1e300, 0}, {3e299, 2}, {1e300, 1}},
     3,
     0},
    {"field of 1e-300",
     9,
     1,
     1e-300,
     3e-300,
     1,
     {{1e-300, 1, 0.25, 0.5}, {3e-300, 0.5, 1, 1}},
     2,
     {{1.5e-300, 0}, {2e-300, 2}, {3e-300, 1}},
     3,
     0},
    {"field of denormals",
     9,
     1,
     5e-324,
     3e-323,
     1,
     {{5e-324, 1, 0.25, 0.5}, {3e-323, 0.5, 1, 1}},
     2,
     {{1e-323, 0}, {2e-323, 2}, {3e-323, 1}},
     3,
     0},
    {"bar of 1e-200",
     9,
     1e-200,
     0,
     1,
     1,
     {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}},
     2,
     {{0, 0}, {0.5, 2e200}, {1, 1e200}},
     3,
     0},
    {"bar of 1e200",
     9,
     1e200,
     0,
     1,
     1,
     {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}},
     2,
     {{0, 0}, {0.5, 2e-200}, {1, 1e-200}},
     3,
     0},
    {"NaN cells", 12, 1, 0, 1, 3, {{0, 1, 0.25, 0.5}, {1, 0.5, 1, 1}}, 2, {{0, 0.5}, {0.5, 2}, {1, 1}}, 3, 0},
};

static double node_value(const Scene *scene, int i) {
  switch (scene->pattern) {
  case 0:
    return scene->low + (scene->high - scene->low) * i / scene->cells;
  case 1:
    return i % 2 ? scene->high : scene->low;
  case 3:
    return i == scene->cells / 2 ? (double)NAN : scene->low + (scene->high - scene->low) * i / scene->cells;
  default:
    return scene->low;
  }
}

static double node_position(const Scene *scene, int i) {
  return scene->length * i / scene->cells;
}

/* ── the reference ── */

/* A list's two knots around `at`, or one of its ends twice; at a step, the later knot. */
static void around(const double *knots, int width, int count, long double at, const double **a, const double **b) {
  int i = 0;
  while (i < count && knots[i * width] <= at)
    ++i;
  *a = knots + (i > 0 ? i - 1 : 0) * width;
  *b = knots + (i < count ? i : count - 1) * width;
}

static long double linear(const double *a, const double *b, int k, long double s) {
  if (a == b || a[0] == b[0])
    return b[k];
  return a[k] + (b[k] - (long double)a[k]) * ((s - a[0]) / (b[0] - (long double)a[0]));
}

typedef struct Sum {
  long double color[3], depth;
} Sum;

/* ∫ over a part with κ and c linear, in steps in which the optical depth and its slope change little; 5 Gauss–Legendre
 * nodes. */
static void integrate(Sum *sum, long double h, const long double near[4], const long double far[4]) {
  static const long double node[5] = {-0.906179845938663992797626878299392965L,
                                      -0.538469310105683091036314420700208805L, 0,
                                      0.538469310105683091036314420700208805L, 0.906179845938663992797626878299392965L};
  static const long double weight[5] = {
      0.236926885056189087514264040719917363L, 0.478628670499366468041291514835638193L,
      0.568888888888888888888888888888888889L, 0.478628670499366468041291514835638193L,
      0.236926885056189087514264040719917363L};
  const long double a = near[0] * h, b = (far[0] - near[0]) * h, top = fmaxl(fmaxl(near[0], far[0]) * h, 1);
  for (long double u = 0; u < 1 && sum->depth + a * u + b * u * u / 2 < 70;) {
    const long double step = fminl(1 - u, 0.03125L / fmaxl(a + b * u, sqrtl(top)));
    for (int i = 0; i < 5; ++i) {
      const long double v = u + step * (1 + node[i]) / 2;
      const long double f = weight[i] * step / 2 * (a + b * v) * expl(-sum->depth - a * v - b * v * v / 2);
      for (int k = 0; k < 3; ++k)
        sum->color[k] += f * (near[k + 1] + (far[k + 1] - near[k + 1]) * v);
    }
    u += step;
  }
  sum->depth += a + b / 2;
}

static long double extinction_of(const Scene *scene, double value) {
  if (scene->unit_distance == 0)
    return value;
  return -log1pl(-fminl(value, 1 - 0x1p-53L)) / scene->unit_distance;
}

static void reference(const Scene *scene, double rgba[4]) {
  double extinction[MOST][2];
  for (int i = 0; i < scene->extinctions; ++i) {
    extinction[i][0] = scene->extinction[i][0];
    extinction[i][1] = (double)extinction_of(scene, scene->extinction[i][1]);
  }
  Sum sum = {{0, 0, 0}, 0};
  for (int i = 0; i < scene->cells; ++i) {
    const double s0 = node_value(scene, i), s1 = node_value(scene, i + 1);
    if (isnan(s0) || isnan(s1))
      continue;
    const long double h = (long double)node_position(scene, i + 1) - node_position(scene, i);
    long double cut[2 * MOST + 2];
    int cuts = 0;
    cut[cuts++] = 0;
    for (int j = 0; j < scene->colors + scene->extinctions && s0 != s1; ++j) {
      const double knot = j < scene->colors ? scene->color[j][0] : extinction[j - scene->colors][0];
      const long double u = ((long double)knot - s0) / ((long double)s1 - s0);
      if (u > 0 && u < 1)
        cut[cuts++] = u;
    }
    cut[cuts++] = 1;
    for (int j = 1; j < cuts; ++j) { /* insertion sort */
      for (int k = j; k > 0 && cut[k] < cut[k - 1]; --k) {
        const long double t = cut[k];
        cut[k] = cut[k - 1];
        cut[k - 1] = t;
      }
    }
    for (int j = 0; j + 1 < cuts; ++j) {
      if (cut[j] == cut[j + 1])
        continue;
      const long double at = s0 == s1 ? s0 : s0 + ((long double)s1 - s0) * (cut[j] + cut[j + 1]) / 2;
      const double *a, *b, *c, *d;
      around(extinction[0], 2, scene->extinctions, at, &a, &b);
      around(scene->color[0], 4, scene->colors, at, &c, &d);
      long double ends[2][4];
      for (int e = 0; e < 2; ++e) {
        const long double s = s0 + ((long double)s1 - s0) * cut[j + e];
        ends[e][0] = fmaxl(linear(a, b, 1, s), 0);
        for (int k = 1; k < 4; ++k)
          ends[e][k] = linear(c, d, k, s);
      }
      integrate(&sum, (cut[j + 1] - cut[j]) * h, ends[0], ends[1]);
    }
  }
  for (int k = 0; k < 3; ++k)
    rgba[k] = (double)sum.color[k];
  rgba[3] = (double)-expm1l(-sum.depth);
}

/* ── the renderer ── */

/* A picture of one pixel by each kernel, with each tolerance: red, green, blue, alpha, and the bound on their error. */
enum { KERNELS = 3, TOLERANCES = 5, PIXELS = KERNELS * TOLERANCES };
static const double tolerances[TOLERANCES] = {0, 1e-9, 1e-6, 1e-3, 0.1};

static void pixels_of(TetcastContext *context, const Body *body, const TetcastTransferFunction *transfer,
                      const TetcastCamera *camera, double pixels[PIXELS][5]) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 1;
  frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = NULL;
  TetcastScene *scene = scene_of(context, body, transfer);
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  for (int i = 0; i < PIXELS; ++i) {
    TetcastRenderDesc desc = tetcast_render_desc_default();
    desc.isa = (TetcastIsa)(TETCAST_ISA_SCALAR + i / TOLERANCES); /* or the widest that there is below */
    desc.tolerance = tolerances[i % TOLERANCES];
    assert_int_equal(tetcast_scene_render(scene, camera, &desc, frame, NULL), TETCAST_OK);
    memcpy(pixels[i], tetcast_frame_pixels(frame), 4 * sizeof(double));
    memcpy(&pixels[i][4], tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR), sizeof(double));
  }
  tetcast_scene_destroy(&scene);
  tetcast_frame_destroy(&frame);
}

/* A bar of (cells × 1 × 1) cubes in six tetrahedra each, and its picture of one pixel, seen along it. */
static void render(const Scene *scene, TetcastTraversal traversal, double pixels[PIXELS][5]) {
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube bar = {4 * ((int64_t)scene->cells + 1), 6 * (int64_t)scene->cells, NULL, NULL, NULL};
  bar.vertices = malloc((size_t)bar.vertex_count * 3 * sizeof *bar.vertices);
  bar.values = malloc((size_t)bar.vertex_count * sizeof *bar.values);
  bar.cells = malloc((size_t)bar.cell_count * 4 * sizeof *bar.cells);
  const double width = scene->length / (scene->cells < 100 ? scene->cells : 100);
  for (int64_t i = 0; i < bar.vertex_count; ++i) {
    bar.vertices[3 * i] = node_position(scene, (int)(i / 4));
    bar.vertices[3 * i + 1] = i & 1 ? width : 0;
    bar.vertices[3 * i + 2] = i & 2 ? width : 0;
    bar.values[i] = node_value(scene, (int)(i / 4));
  }
  for (int64_t i = 0; i < bar.cell_count; ++i) {
    static const int64_t step[3] = {4, 1, 2};
    int64_t *cell = &bar.cells[4 * i];
    cell[0] = i / 6 * 4;
    for (int k = 0; k < 3; ++k)
      cell[k + 1] = cell[k] + step[order[i % 6][k]];
  }
  Body body = cube_body(fixture.context, &bar, traversal);
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = scene->color[0];
  desc.color_count = scene->colors;
  if (scene->unit_distance > 0) {
    desc.opacity = scene->extinction[0];
    desc.opacity_count = scene->extinctions;
    desc.unit_distance = scene->unit_distance;
  } else {
    desc.extinction = scene->extinction[0];
    desc.extinction_count = scene->extinctions;
  }
  TetcastTransferFunction *transfer;
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_OK);
  TetcastCamera camera = {.up = {0, 1, 0}, .projection = TETCAST_ORTHOGRAPHIC, .height = width};
  camera.eye[0] = -scene->length;
  camera.eye[1] = camera.target[1] = 0.3125 * width;
  camera.eye[2] = camera.target[2] = 0.625 * width;
  pixels_of(fixture.context, &body, transfer, &camera, pixels);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&bar);
  fixture_end(&fixture);
}

static void extreme_scenes(void **state) {
  (void)state;
  double worst = 0;
  printf("%-38s %22s %10s %10s %10s\n", "scene", "opacity", "walk", "faces", "bound");
  for (size_t i = 0; i < sizeof scenes / sizeof *scenes; ++i) {
    double expected[4], error[2] = {0, 0}, bound = 0, pixels[PIXELS][5];
    reference(&scenes[i], expected);
    for (int traversal = 0; traversal < 2; ++traversal) {
      render(&scenes[i], traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, pixels);
      for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < PIXELS; ++j) {
          const double tolerance = tolerances[j % TOLERANCES];
          assert_true(pixels[j][k] >= 0 && pixels[j][k] <= 1);
          assert_true(fabs(pixels[j][k] - expected[k]) <= pixels[j][4]);
          assert_true(pixels[j][4] <= tolerance + pixels[j - j % TOLERANCES][4]); /* what rounding takes comes on top */
          bound = fmax(bound, tolerance == 0 ? pixels[j][4] : 0);
        }
        /* absolute in [0, 1], relative where everything is thin */
        for (int j = 0; j < PIXELS; j += TOLERANCES) {
          error[traversal] =
              fmax(error[traversal], fabs(pixels[j][k] - expected[k]) / fmin(1, fmax(expected[3], DBL_MIN)));
        }
      }
      worst = fmax(worst, error[traversal]);
    }
    printf("%-38s %22.16g %10.1e %10.1e %10.1e\n", scenes[i].name, expected[3], error[0], error[1], bound);
  }
  assert_true(worst < 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(extreme_scenes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
