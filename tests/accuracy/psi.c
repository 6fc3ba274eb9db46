/* SPDX-License-Identifier: Apache-2.0 */
/* The segment integral against a table computed with 60 digits (make_psi_table.py): over the whole range of numbers, biased to the
 * borders between formulas and to nearly constant extinction. */
#include "support.h"

#include "optics/segment.h"

static double relative(double value, double reference) {
  if (reference == 0) return fabs(value);
  if (fabs(reference) < 0x1p-1022) return fabs(value - reference) / 0x1p-1022; /* a denormal has no relative accuracy to keep */
  return fabs(value / reference - 1);
}

static void table(void **state) {
  (void)state;
  FILE *file = fopen(TETCAST_PSI_TABLE, "rb");
  assert_non_null(file);
  double record[5], worst[4] = {0, 0, 0, 0}, where[4][2];
  static const char *const name[4] = {"psi", "w0", "w1", "alpha"};
  long count = 0;
  while (fread(record, sizeof record, 1, file) == 1) {
    const TcSegment s = tc_segment(record[0], record[1]);
    const double t = 0.5 * record[0] + 0.5 * record[1];
    const double value[4] = {s.w1 + s.transmittance, s.w0, s.w1, s.alpha};
    const double reference[4] = {record[2], record[3], record[4], -expm1(-t)};
    for (int k = 0; k < 4; ++k) {
      assert_true(value[k] >= 0 && value[k] <= 1);
      const double error = relative(value[k], reference[k]);
      if (error > worst[k]) {
        worst[k] = error;
        memcpy(where[k], record, sizeof where[k]);
      }
    }
    ++count;
  }
  fclose(file);
  for (int k = 0; k < 4; ++k) printf("%-6s largest relative error %.2e at a = %a, a1 = %a\n", name[k], worst[k], where[k][0], where[k][1]);
  assert_true(count >= 100000);
  for (int k = 0; k < 4; ++k) assert_true(worst[k] <= 4e-15);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(table)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
