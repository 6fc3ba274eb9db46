/* SPDX-License-Identifier: Apache-2.0 */
/* The segment integral against a table computed with 60 digits (make_psi_table.py): over the whole range of numbers, biased to the
 * borders between formulas and to nearly constant extinction. One segment at a time, and by the packets' code for each instruction set. */
#include "support.h"

#include "base/cpu.h"
#include "psi.h"

static void one_by_one(const double *a, const double *a1, int64_t count, TcSegment *out) {
  for (int64_t i = 0; i < count; ++i) out[i] = tc_segment(a[i], a1[i]);
}

static const struct {
  const char *name;
  TetcastIsa isa;
  PsiLanes *evaluate;
  double bound;
} kernels[] = {
  {"scalar", TETCAST_ISA_SCALAR, one_by_one, 4e-15},
  {"baseline", TETCAST_ISA_BASELINE, psi_baseline, 8e-15},
#ifdef TC_HAVE_X86
  {"avx2", TETCAST_ISA_AVX2, psi_avx2, 8e-15},
  {"avx512", TETCAST_ISA_AVX512, psi_avx512, 8e-15},
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

static double relative(double value, double reference) {
  if (reference == 0) return fabs(value);
  if (fabs(reference) < 0x1p-1022) return fabs(value - reference) / 0x1p-1022; /* a denormal has no relative accuracy to keep */
  return fabs(value / reference - 1);
}

/* Prints the largest errors of one kernel and holds them to its bound. */
static void check(int kernel, double (*record)[5], const double *a, const double *a1, int64_t count, TcSegment *segments) {
  static const char *const name[4] = {"psi", "w0", "w1", "alpha"};
  double worst[4] = {0, 0, 0, 0};
  int64_t where[4] = {0, 0, 0, 0};
  kernels[kernel].evaluate(a, a1, count, segments);
  for (int64_t i = 0; i < count; ++i) {
    const TcSegment s = segments[i];
    const double value[4] = {s.w1 + s.transmittance, s.w0, s.w1, s.w0 + s.w1};
    const double reference[4] = {record[i][2], record[i][3], record[i][4], -expm1(-0.5 * a[i] - 0.5 * a1[i])};
    for (int k = 0; k < 4; ++k) {
      assert_true(value[k] >= 0 && value[k] <= 1 + 0x1p-52);
      const double error = relative(value[k], reference[k]);
      if (error <= worst[k]) continue;
      worst[k] = error;
      where[k] = i;
    }
  }
  for (int k = 0; k < 4; ++k) {
    printf("%-8s %-6s largest relative error %.2e at a = %a, a1 = %a\n", kernels[kernel].name, name[k], worst[k], a[where[k]], a1[where[k]]);
  }
  for (int k = 0; k < 4; ++k) assert_true(worst[k] <= kernels[kernel].bound);
}

static void table(void **state) {
  (void)state;
  enum { MOST = 200000 };
  FILE *file = fopen(TETCAST_PSI_TABLE, "rb");
  assert_non_null(file);
  double(*record)[5] = malloc(MOST * sizeof *record), *a = malloc(MOST * sizeof *a), *a1 = malloc(MOST * sizeof *a1);
  TcSegment *segments = malloc(MOST * sizeof *segments);
  const int64_t count = (int64_t)fread(record, sizeof *record, MOST, file);
  fclose(file);
  assert_true(count >= 100000);
  for (int64_t i = 0; i < count; ++i) a[i] = record[i][0], a1[i] = record[i][1];
  for (int i = 0; i < KERNELS; ++i) {
    if (tc_cpu_has(kernels[i].isa)) check(i, record, a, a1, count, segments);
  }
  free(record);
  free(a);
  free(a1);
  free(segments);
}

/* Nothing is NaN, negative or above 1, and nothing is lost, next to whatever the other lanes hold. */
static void extremes(void **state) {
  (void)state;
  static const double values[] = {0,  5e-324, 1e-308, 1e-300, 1e-160, 1e-20, 1e-8, 0.1,  0.5,   1,        2,
                                  10, 700,    745,    746,    1e4,    1e8,   1e16, 1e30, 1e160, 1e300, 1.7e308, INFINITY};
  enum { N = sizeof values / sizeof *values };
  double a[N * N], a1[N * N];
  TcSegment segments[N * N];
  for (int i = 0; i < N * N; ++i) {
    a[i] = values[i / N];
    a1[i] = values[i * 7 % N];
  }
  for (int k = 0; k < KERNELS; ++k) {
    if (!tc_cpu_has(kernels[k].isa)) continue;
    kernels[k].evaluate(a, a1, N * N, segments);
    for (int i = 0; i < N * N; ++i) {
      const TcSegment s = segments[i];
      assert_true(s.w0 >= 0 && s.w0 <= 1 && s.w1 >= 0 && s.w1 <= 1 && s.transmittance >= 0 && s.transmittance <= 1);
      assert_true(fabs(s.w0 + s.w1 + s.transmittance - 1) <= 4e-16);
      const TcSegment one = tc_segment(a[i], a1[i]);
      assert_true(fabs(s.w0 - one.w0) <= 1e-15 && fabs(s.w1 - one.w1) <= 1e-15);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(table), cmocka_unit_test(extremes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
