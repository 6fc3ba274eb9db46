/* SPDX-License-Identifier: Apache-2.0 */
/* What must not change a picture, each with its bound. (Renumbering and powers of two: tests/unit/render.c.) */
#include "support.h"

#include <float.h>

enum { W = 40, H = 30, VALUES = W * H * 4 };

/* One rendering of a cube, its coordinates and values as they are at the call. */
static double *render(const Cube *cube, const TetcastCamera *camera, double extinction) {
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Body body = cube_body(fixture.context, cube, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = transfer_of(fixture.context, extinction);
  double *pixels = picture(fixture.context, &body, transfer, camera, W, H, NULL);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  fixture_end(&fixture);
  return pixels;
}

static const TetcastCamera oblique = {
    .eye = {2.125, 1.75, 3.375}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy = 30};

/* A cube whose coordinates have few bits, so that moving it by 2³⁰ is exact. */
static Cube dyadic_cube(void) {
  Cube cube = cube_create(5, 0.5);
  for (int64_t i = 0; i < 3 * cube.vertex_count; ++i)
    cube.vertices[i] = round(cube.vertices[i] * 0x1p20) * 0x1p-20;
  return cube;
}

static void move(Cube *cube, TetcastCamera *camera, const double by[3]) {
  for (int64_t i = 0; i < 3 * cube->vertex_count; ++i)
    cube->vertices[i] += by[i % 3];
  for (int k = 0; k < 3; ++k) {
    camera->eye[k] += by[k];
    camera->target[k] += by[k];
  }
}

/* Where the input can be moved without rounding, the picture stays to rounding: vertex − origin is formed without loss.
 */
static void exact_translation(void **state) {
  (void)state;
  for (int orthographic = 0; orthographic < 2; ++orthographic) {
    Cube cube = dyadic_cube();
    TetcastCamera camera = oblique;
    camera.projection = orthographic ? TETCAST_ORTHOGRAPHIC : TETCAST_PERSPECTIVE;
    camera.height = 1.625;
    double *here = render(&cube, &camera, 1);
    const double steps[][3] = {{0x1p20, -0x1p20, 0x1p19}, {0x1p30, 0x1p30, -0x1p30}};
    for (int i = 0; i < 2; ++i) {
      Cube far = dyadic_cube();
      TetcastCamera there = camera;
      move(&far, &there, steps[i]);
      double *pixels = render(&far, &there, 1);
      assert_true(largest_difference(here, pixels, VALUES) < 1e-13);
      free(pixels);
      cube_destroy(&far);
    }
    free(here);
    cube_destroy(&cube);
  }
}

/* By 1e6 and 1e9 with rounding of the input: each coordinate moves by up to δ = ½ ulp. An entry or crossing then moves
 * along the ray by δ √3 (1 + cot of the angle to the face), a value by its gradient (≤ 3 / size here) times that, and
 * colour and opacity by at most the change of depth, Δ(κh) ≤ κ_max Δh + κ' Δs h with κ_max = 30 and |κ'| ≤ 600 here:
 * below 10⁵ δ for all but a few rays that graze an edge. */
static void rounded_translation(void **state) {
  (void)state;
  Cube cube = cube_create(5, 0.5);
  double *here = render(&cube, &oblique, 1);
  const double distances[] = {1e6, 1e9};
  for (int i = 0; i < 2; ++i) {
    Cube far = cube_create(5, 0.5);
    TetcastCamera there = oblique;
    const double by[3] = {distances[i] * 1.1, -distances[i] * 0.7, distances[i] / 3};
    move(&far, &there, by);
    double *pixels = render(&far, &there, 1);
    const double delta = distances[i] * DBL_EPSILON;
    assert_true(largest_difference(here, pixels, VALUES) < 1e5 * delta);
    free(pixels);
    cube_destroy(&far);
  }
  free(here);
  cube_destroy(&cube);
}

/* Lengths by 1e±30, extinction inversely: every number of the input is rounded once, relative 2⁻⁵³, so the bound is
 * that of rounding, times the steepness of the transfer function (600 per unit of the field, here). */
static void scaling(void **state) {
  (void)state;
  Cube cube = cube_create(5, 0.5);
  double *one = render(&cube, &oblique, 1);
  const double factors[] = {1e30, 1e-30, 1e150, 1e-150};
  for (int i = 0; i < 4; ++i) {
    Cube scaled = cube_create(5, 0.5);
    TetcastCamera camera = oblique;
    for (int64_t j = 0; j < 3 * scaled.vertex_count; ++j)
      scaled.vertices[j] *= factors[i];
    for (int k = 0; k < 3; ++k) {
      camera.eye[k] *= factors[i];
      camera.target[k] *= factors[i];
    }
    double *pixels = render(&scaled, &camera, 1 / factors[i]);
    assert_true(largest_difference(one, pixels, VALUES) < 1e-12);
    free(pixels);
    cube_destroy(&scaled);
  }
  free(one);
  cube_destroy(&cube);
}

static void rotate(double v[3]) { /* about an oblique axis: two plane rotations */
  const double c = cos(0.7), s = sin(0.7), d = cos(1.9), e = sin(1.9);
  const double x = c * v[0] - s * v[1], y = s * v[0] + c * v[1], z = v[2];
  v[0] = x;
  v[1] = d * y - e * z;
  v[2] = e * y + d * z;
}

static void rotation(void **state) {
  (void)state;
  Cube cube = cube_create(5, 0.5), turned = cube_create(5, 0.5);
  TetcastCamera camera = oblique;
  for (int64_t i = 0; i < turned.vertex_count; ++i)
    rotate(&turned.vertices[3 * i]);
  rotate(camera.eye), rotate(camera.target), rotate(camera.up);
  double *a = render(&cube, &oblique, 1), *b = render(&turned, &camera, 1);
  assert_true(largest_difference(a, b, VALUES) < 1e-12);
  free(a), free(b);
  cube_destroy(&cube), cube_destroy(&turned);
}

/* A linear field is the same on any mesh: coarse, fine, jittered; also seen from inside, where the first cell is cut at
 * the eye. */
static void refinement(void **state) {
  (void)state;
  const TetcastCamera inside = {.eye = {0.41, 0.37, 0.83}, .target = {0.9, 0.6, 0.1}, .up = {0, 1, 0}, .fovy = 70};
  double *first[2] = {NULL, NULL};
  const int sizes[] = {1, 2, 7, 16};
  for (int i = 0; i < 4; ++i) {
    Cube cube = cube_create(sizes[i], 0.5);
    for (int64_t j = 0; j < cube.vertex_count; ++j) {
      const double *p = &cube.vertices[3 * j];
      cube.values[j] = 0.1 + 0.45 * p[0] + 0.35 * p[1] - 0.25 * p[2];
    }
    for (int k = 0; k < 2; ++k) {
      double *pixels = render(&cube, k ? &inside : &oblique, 1);
      if (!first[k])
        first[k] = pixels;
      else {
        assert_true(largest_difference(first[k], pixels, VALUES) < 1e-12);
        free(pixels);
      }
    }
    cube_destroy(&cube);
  }
  free(first[0]), free(first[1]);
}

/* The same rays from the other side: the same transmittance. Orthographic, so that pixel (x, y) has its partner at (W −
 * 1 − x, y). */
static void reversal(void **state) {
  (void)state;
  Cube cube = cube_create(5, 0.5);
  TetcastCamera front = oblique, back;
  front.projection = TETCAST_ORTHOGRAPHIC;
  front.height = 1.7;
  back = front;
  for (int k = 0; k < 3; ++k)
    back.eye[k] = 2 * front.target[k] - front.eye[k];
  double *a = render(&cube, &front, 0.2), *b = render(&cube, &back, 0.2);
  for (int y = 0; y < H; ++y) {
    for (int x = 0; x < W; ++x) {
      assert_true(fabs(a[4 * (y * W + x) + 3] - b[4 * (y * W + W - 1 - x) + 3]) < 1e-13);
    }
  }
  free(a), free(b);
  cube_destroy(&cube);
}

/* The same mesh in two parts that share no vertex numbers, cells in another order: the seam is not there. */
static void splitting(void **state) {
  (void)state;
  Cube whole = cube_create(6, 0.5), parts = cube_create(6, 0.5);
  const int64_t n = parts.vertex_count;
  parts.vertices = realloc(parts.vertices, (size_t)(2 * n) * 3 * sizeof *parts.vertices);
  parts.values = realloc(parts.values, (size_t)(2 * n) * sizeof *parts.values);
  memcpy(parts.vertices + 3 * n, parts.vertices, (size_t)(3 * n) * sizeof *parts.vertices);
  memcpy(parts.values + n, parts.values, (size_t)n * sizeof *parts.values);
  parts.vertex_count = 2 * n;
  for (int64_t i = 0; i < parts.cell_count; ++i) {
    int64_t *cell = &parts.cells[4 * (parts.cell_count - 1 - i)];
    for (int k = 0; k < 4; ++k)
      cell[k] = whole.cells[4 * i + k] + (i * 7 % 13 < 6 ? n : 0);
  }
  double *a = render(&whole, &oblique, 1), *b = render(&parts, &oblique, 1);
  assert_true(largest_difference(a, b, VALUES) < 1e-12);
  free(a), free(b);
  cube_destroy(&whole), cube_destroy(&parts);
}

/* Opacity per unit distance, and the extinction it stands for. */
static void opacity_is_extinction(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(5, 0.5);
  Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
  const double color[2][4] = {{0, 1, 0.5, 0}, {1, 0, 0.5, 1}}, opacity[3][2] = {{0, 0.01}, {0.5, 0.9}, {1, 0.2}};
  double extinction[3][2];
  for (int i = 0; i < 3; ++i) {
    extinction[i][0] = opacity[i][0];
    extinction[i][1] = -log(1 - opacity[i][1]) / 0.3;
  }
  double *pixels[2];
  for (int i = 0; i < 2; ++i) {
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    desc.color = color[0];
    desc.color_count = 2;
    desc.opacity = i ? NULL : opacity[0];
    desc.opacity_count = i ? 0 : 3;
    desc.extinction = i ? extinction[0] : NULL;
    desc.extinction_count = i ? 3 : 0;
    desc.unit_distance = 0.3;
    TetcastTransferFunction *transfer;
    assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_OK);
    pixels[i] = picture(fixture.context, &body, transfer, &oblique, W, H, NULL);
    tetcast_transfer_function_destroy(&transfer);
  }
  assert_true(largest_difference(pixels[0], pixels[1], VALUES) < 1e-14);
  free(pixels[0]), free(pixels[1]);
  body_destroy(&body);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exact_translation), cmocka_unit_test(rounded_translation),
      cmocka_unit_test(scaling),           cmocka_unit_test(rotation),
      cmocka_unit_test(refinement),        cmocka_unit_test(reversal),
      cmocka_unit_test(splitting),         cmocka_unit_test(opacity_is_extinction),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
