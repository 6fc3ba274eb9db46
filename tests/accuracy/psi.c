/* SPDX-License-Identifier: Apache-2.0 */
/* The segment integral against a table computed with 60 digits (make_psi_table.py): over the whole range of numbers,
 * biased to the borders between formulas and to nearly constant extinction. One segment at a time, and by the kernels'
 * code for each kind of lanes, in single precision against the former. */
#include "support.h"

#include <float.h>

#include "base/cpu.h"
#include "psi.h"

static void one_by_one(const double *a, const double *a1, int64_t count, TcSegment *out, TcMoments *moments) {
  (void)moments;
  for (int64_t i = 0; i < count; ++i)
    out[i] = tc_segment(a[i], a1[i]);
}

static const struct {
  const char *name;
  TetcastIsa isa;
  PsiLanes *evaluate;
  double bound; /* relative, of each weight */
  double ulp;   /* of numbers near 1 */
} kernels[] = {
    {"segment.c", TETCAST_ISA_SCALAR, one_by_one, 4e-15, 0x1p-52},
    {"scalar", TETCAST_ISA_SCALAR, psi_one, 8e-15, 0x1p-52},
#ifdef TC_HAVE_X86
    {"avx2", TETCAST_ISA_AVX2, psi_avx2, 8e-15, 0x1p-52},
    {"avx512", TETCAST_ISA_AVX512, psi_avx512, 8e-15, 0x1p-52},
    {"avx2_f32", TETCAST_ISA_AVX2, psi_avx2_f32, 72 * 0x1p-24, 0x1p-23},
    {"avx512_f32", TETCAST_ISA_AVX512, psi_avx512_f32, 72 * 0x1p-24, 0x1p-23},
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

static double relative(double value, double reference) {
  if (reference == 0)
    return fabs(value);
  if (fabs(reference) < 0x1p-1022)
    return fabs(value - reference) / 0x1p-1022; /* a denormal has no relative accuracy to keep */
  return fabs(value / reference - 1);
}

/* Ψ, w0, w1, alpha. */
typedef struct Weights {
  double value[4];
} Weights;

static Weights weights_of(const TcSegment *s) {
  return (Weights){{s->w1 + s->transmittance, s->w0, s->w1, s->w0 + s->w1}};
}

/* Prints the largest errors of one kernel and holds them to its bound. */
static void check(int kernel, const Weights *reference, const double *a, const double *a1, int64_t count) {
  static const char *const name[4] = {"psi", "w0", "w1", "alpha"};
  double worst[4] = {0, 0, 0, 0};
  int64_t where[4] = {0, 0, 0, 0};
  TcSegment *segments = malloc((size_t)count * sizeof *segments);
  kernels[kernel].evaluate(a, a1, count, segments, NULL);
  for (int64_t i = 0; i < count; ++i) {
    const Weights got = weights_of(&segments[i]);
    for (int k = 0; k < 4; ++k) {
      assert_true(got.value[k] >= 0 && got.value[k] <= 1 + kernels[kernel].ulp);
      const double error = relative(got.value[k], reference[i].value[k]);
      if (error <= worst[k])
        continue;
      worst[k] = error;
      where[k] = i;
    }
  }
  for (int k = 0; k < 4; ++k) {
    printf("%-10s %-6s largest relative error %.2e at a = %a, a1 = %a\n", kernels[kernel].name, name[k], worst[k],
           a[where[k]], a1[where[k]]);
  }
  for (int k = 0; k < 4; ++k)
    assert_true(worst[k] <= kernels[kernel].bound);
  free(segments);
}

static bool is_single(int kernel) {
  return kernels[kernel].ulp > 0x1p-50;
}

/* What single precision can be asked for, and far from where it ends; 1 in place of others. */
static double rounded(double a) {
  return a == 0 || (a > 1e-30 && a < 1e30) ? (double)(float)a : 1;
}

static void table(void **state) {
  (void)state;
  enum { MOST = 200000 };
  FILE *file = fopen(TETCAST_PSI_TABLE, "rb");
  assert_non_null(file);
  double(*record)[5] = malloc(MOST * sizeof *record), *a = malloc(MOST * sizeof *a), *a1 = malloc(MOST * sizeof *a1);
  Weights *reference = malloc(MOST * sizeof *reference);
  const int64_t count = (int64_t)fread(record, sizeof *record, MOST, file);
  fclose(file);
  assert_true(count >= 100000);
  for (int single = 0; single < 2; ++single) {
    for (int64_t i = 0; i < count; ++i) {
      const double *r = record[i];
      a[i] = single ? rounded(r[0]) : r[0];
      a1[i] = single ? rounded(r[1]) : r[1];
      const TcSegment exact = tc_segment(a[i], a1[i]); /* which the table has tested by then */
      if (single)
        reference[i] = weights_of(&exact);
      else
        reference[i] = (Weights){{r[2], r[3], r[4], -expm1(-0.5 * r[0] - 0.5 * r[1])}};
    }
    for (int i = 0; i < KERNELS; ++i) {
      if (tc_cpu_has(kernels[i].isa) && is_single(i) == single)
        check(i, reference, a, a1, count);
    }
  }
  free(record);
  free(a);
  free(a1);
  free(reference);
}

/* Nothing is NaN, negative or above 1, and nothing is lost, next to whatever the other lanes hold. */
static void extremes(void **state) {
  (void)state;
  static const double values[] = {0,   5e-324, 1e-308, 1e-300, 1e-160, 1e-20, 1e-8, 0.1,   0.5,   1,       2,       10,
                                  700, 745,    746,    1e4,    1e8,    1e16,  1e30, 1e160, 1e300, 1.7e308, INFINITY};
  enum { N = sizeof values / sizeof *values };
  double a[N * N], a1[N * N];
  TcSegment segments[N * N];
  for (int k = 0; k < KERNELS; ++k) {
    if (!tc_cpu_has(kernels[k].isa))
      continue;
    for (int i = 0; i < N * N; ++i) {
      a[i] = is_single(k) ? (double)(float)fmin(values[i / N], FLT_MAX) : values[i / N];
      a1[i] = is_single(k) ? (double)(float)fmin(values[i * 7 % N], FLT_MAX) : values[i * 7 % N];
    }
    kernels[k].evaluate(a, a1, N * N, segments, NULL);
    for (int i = 0; i < N * N; ++i) {
      const TcSegment s = segments[i];
      assert_true(s.w0 >= 0 && s.w0 <= 1 && s.w1 >= 0 && s.w1 <= 1 && s.transmittance >= 0 && s.transmittance <= 1);
      assert_true(fabs(s.w0 + s.w1 + s.transmittance - 1) <= 1.8 * kernels[k].ulp);
      const TcSegment one = tc_segment(a[i], a1[i]);
      const double bound = is_single(k) ? kernels[k].bound : 1e-15;
      assert_true(fabs(s.w0 - one.w0) <= bound && fabs(s.w1 - one.w1) <= bound);
    }
  }
}

/* A deep segment gives the same bits, however few or many deep ones there are beside it in other lanes. */
static void neighbors(void **state) {
  (void)state;
  enum { N = 960, MOST = 6 };
  static double a[N], a1[N];
  static TcSegment all[N], some[N];
  for (int k = 0; k < KERNELS; ++k) {
    if (!tc_cpu_has(kernels[k].isa))
      continue;
    for (int apart = 1; apart <= MOST; ++apart) {
      for (int i = 0; i < N; ++i) {
        const bool deep = i % apart == 0;
        a[i] = deep ? (double)(float)(1.1 + 40 * sin(i * 0.7) * sin(i * 0.7)) : 0.03125;
        a1[i] = deep ? (double)(float)(1.1 + 40 * sin(i * 1.3) * sin(i * 1.3)) : 0.0625;
      }
      kernels[k].evaluate(a, a1, N, some, NULL);
      for (int i = 0; i < N && apart == 1; ++i)
        all[i] = some[i];
      for (int i = 0; i < N; i += apart) {
        assert_true(some[i].w0 == all[i].w0 && some[i].w1 == all[i].w1 && some[i].alpha == all[i].alpha);
      }
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(table), cmocka_unit_test(extremes), cmocka_unit_test(neighbors)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
