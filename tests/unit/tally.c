/* SPDX-License-Identifier: Apache-2.0 */
/* Statistics: all instruction sets give the same sums, to the last bit. */
#include "support.h"

#include "base/cpu.h"
#include "volume/tally.h"

enum { BINS = 300, ROWS = 3, WIDTH = (BINS + 2 + TC_TALLY_SPARE + 7) / 8 * 8, NUMBERS = (3 + ROWS) * WIDTH };

static void sum_up(TcTallyCells *cells, const TcTally *tally, double numbers[NUMBERS], TcTallySums *sums) {
  memset(numbers, 0, NUMBERS * sizeof *numbers);
  *sums = (TcTallySums){
      .volume = numbers, .area = numbers + WIDTH, .gradient = numbers + 2 * WIDTH, .joint = numbers + 3 * WIDTH};
  cells(tally, 0, tally->mesh->tetrahedra.count, sums);
}

static void instruction_sets_change_no_bit(void **state) {
  (void)state;
  static const struct {
    TetcastIsa isa;
    TcTallyCells *cells;
  } others[] = {
#ifdef TC_HAVE_X86
      {TETCAST_ISA_AVX2, tc_tally_avx2},
      {TETCAST_ISA_AVX512, tc_tally_avx512},
#endif
      {TETCAST_ISA_SCALAR, tc_tally_one}};
  static double wanted[NUMBERS], got[NUMBERS], edges[BINS + 1 + TC_TALLY_SPARE];
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube cube = cube_create(5, 0.6);
  cube.values[7] = (double)NAN;
  for (int64_t j = 0; j < cube.vertex_count; j += 3) /* edges at values, and values that are equal */
    cube.values[j] = 0.25 * (double)(j % 4);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  TetcastField *field = field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT);
  for (int i = 0; i < BINS + 1 + TC_TALLY_SPARE; ++i)
    edges[i] = i <= BINS ? -0.1 + 1.0 / 256 * i : (double)INFINITY;
  static const int places[] = {0, BINS + 1};
  const TcTally tally = {mesh, field, {1, 1}, {1, 1}, edges, BINS, places, 1, 0, ROWS, 0, 0.5, true, true};
  TcTallySums sums, others_sums;
  sum_up(tc_tally_one, &tally, wanted, &sums);
  assert_true(tc_tally_width(&tally) == WIDTH && sums.unknown > 0 && sums.total > 0.9);
  for (size_t i = 0; i < sizeof others / sizeof *others; ++i) {
    if (!tc_cpu_has(others[i].isa))
      continue;
    sum_up(others[i].cells, &tally, got, &others_sums);
    assert_memory_equal(got, wanted, sizeof got);
    assert_true(sums.total == others_sums.total && sums.unknown == others_sums.unknown &&
                sums.steepest == others_sums.steepest);
  }
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(instruction_sets_change_no_bit)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
