/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L /* setenv */
/* All kernels give the picture of the scalar one: random transfer functions on point and cell fields, stored wide and narrow, with NaN,
 * from outside, inside and in parallel, pictures that are no multiple of a packet. Prints how far they are apart. */
#include "support.h"

#include "base/cpu.h"

enum { WIDTH = 37, HEIGHT = 23, SCENES = 120 };

static TetcastVolume *random_volume(TetcastContext *context, Cube *cube, int i, uint64_t *seed) {
  const TetcastAssociation association = i % 3 == 2 ? TETCAST_CELL : TETCAST_POINT;
  const int64_t count = association == TETCAST_CELL ? cube->cell_count : cube->vertex_count;
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t j = 0; j < count; ++j) {
    values[j] = association == TETCAST_CELL ? uniform(seed) : cube->values[j];
    if (i % 4 == 3 && uniform(seed) < 0.02) values[j] = NAN;
    if (i % 5 == 4) values[j] = floor(4 * values[j]) / 4; /* whole cells on a knot */
  }
  TetcastVolume *volume;
  if (i % 2) {
    volume = narrow_volume(context, cube, values, count, association);
  } else {
    TetcastMesh *mesh = cube_mesh(context, cube);
    TetcastField *field = field_of(context, values, count, association);
    volume = volume_of(context, mesh, TETCAST_TRAVERSAL_SHELL);
    assert_int_equal(tetcast_volume_set_field(volume, field), TETCAST_OK);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
  }
  free(values);
  return volume;
}

/* Hundreds of knots, as colour maps have, many pieces without extinction. */
static TetcastTransferFunction *dense_transfer(TetcastContext *context, uint64_t *seed) {
  enum { KNOTS = 300 };
  double color[KNOTS][4], extinction[KNOTS][2];
  bool empty = false;
  for (int i = 0; i < KNOTS; ++i) {
    color[i][0] = (i + 0.9 * uniform(seed)) / KNOTS;
    for (int k = 1; k < 4; ++k) color[i][k] = uniform(seed);
    if (uniform(seed) < 0.2) empty = !empty;
    extinction[i][0] = i % 3 ? color[i][0] : (i + 0.9 * uniform(seed)) / KNOTS;
    extinction[i][1] = empty ? 0 : power(seed, -1, 3);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = extinction[0];
  desc.color_count = desc.extinction_count = KNOTS;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static TetcastCamera random_camera(int i, uint64_t *seed) {
  TetcastCamera camera = {.up = {0, 1, 0.1}, .fovy = i % 8 == 1 ? 130 : 35, .height = 1.5};
  for (int k = 0; k < 3; ++k) {
    camera.eye[k] = i % 4 == 1 ? uniform(seed) : 5 * uniform(seed) - 2; /* some inside */
    camera.target[k] = 0.3 + 0.4 * uniform(seed);
  }
  if (i % 6 == 0) camera.projection = TETCAST_ORTHOGRAPHIC;
  if (i % 12 == 0) { /* rays within faces, through vertices */
    for (int k = 0; k < 3; ++k) camera.eye[k] = camera.target[k] = 0.5;
    camera.eye[2] = 4;
  }
  return camera;
}

static void kernels_agree(void **state) {
  (void)state;
  static const char *const names[] = {"auto", "scalar", "baseline", "avx2", "avx512"};
  double worst[TETCAST_ISA_AVX512 + 1] = {0};
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 3;
  Cube cube = cube_create(6, 0.6);
  for (int i = 0; i < SCENES; ++i) {
    TetcastVolume *volume = random_volume(fixture.context, &cube, i, &seed);
    TetcastTransferFunction *transfer = i % 7 == 5 ? dense_transfer(fixture.context, &seed) : random_transfer(fixture.context, &seed);
    const TetcastCamera camera = random_camera(i, &seed);
    int64_t count;
    const double *color = tetcast_transfer_function_color(transfer, &count);
    double largest = 1, *pictures[TETCAST_ISA_AVX512 + 1] = {NULL};
    for (int64_t j = 0; j < count; ++j) largest = fmax(largest, fmax(color[4 * j + 1], fmax(color[4 * j + 2], color[4 * j + 3])));
    int64_t segments = 0;
    for (int isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
      if (!tc_cpu_has((TetcastIsa)isa)) continue;
      char number[16];
      snprintf(number, sizeof number, "%d", isa);
      setenv("TETCAST_TEST_ISA", number, 1);
      TetcastRenderStats stats;
      pictures[isa] = picture(fixture.context, volume, transfer, &camera, WIDTH, HEIGHT, &stats);
      assert_string_equal(stats.isa, names[isa]);
      if (isa == TETCAST_ISA_SCALAR) segments = stats.segments;
      assert_int_equal(stats.segments, segments); /* the traversal is the same, to the bit */
      const double off = largest_difference(pictures[TETCAST_ISA_SCALAR], pictures[isa], 4 * WIDTH * HEIGHT) / largest;
      worst[isa] = fmax(worst[isa], off);
      assert_true(off <= 1e-14);
    }
    for (int isa = 0; isa <= TETCAST_ISA_AVX512; ++isa) free(pictures[isa]);
    tetcast_transfer_function_destroy(&transfer);
    tetcast_volume_destroy(&volume);
  }
  unsetenv("TETCAST_TEST_ISA");
  for (int isa = TETCAST_ISA_BASELINE; isa <= TETCAST_ISA_AVX512; ++isa) {
    if (tc_cpu_has((TetcastIsa)isa)) printf("%-8s %.1e from the scalar kernel\n", names[isa], worst[isa]);
  }
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_agree)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
