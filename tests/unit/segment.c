/* SPDX-License-Identifier: Apache-2.0 */
/* The integral over one segment, against quadrature in extended precision and at the ends of the number range; and what
 * kernels gather from many of them. */
#include "support.h"

#include "base/cpu.h"
#include "gather_lanes.h"
#include "optics/segment.h"
#include "optics/transfer.h"

/* w0, w1 by composite Gauss–Legendre (5 nodes) in long double, finely cut where the integrand falls off. */
static void reference(double a, double a1, long double w[2]) {
  static const long double node[5] = {-0.906179845938663992797626878299392965L,
                                      -0.538469310105683091036314420700208805L, 0,
                                      0.538469310105683091036314420700208805L, 0.906179845938663992797626878299392965L};
  static const long double weight[5] = {
      0.236926885056189087514264040719917363L, 0.478628670499366468041291514835638193L,
      0.568888888888888888888888888888888889L, 0.478628670499366468041291514835638193L,
      0.236926885056189087514264040719917363L};
  const long double b = (long double)a1 - a;
  w[0] = w[1] = 0;
  long double u = 0;
  const long double top = fmaxl(fmaxl(a, a1), 1);
  while (u < 1) { /* steps in which the optical depth and its slope change little */
    const long double step = fminl(1 - u, 0.03125L / fmaxl(a + b * u, sqrtl(top)));
    for (int i = 0; i < 5; ++i) {
      const long double v = u + step * (1 + node[i]) / 2, k = a + b * v,
                        f = weight[i] * step / 2 * k * expl(-(a * v + b * v * v / 2));
      w[0] += f * (1 - v);
      w[1] += f * v;
    }
    u += step;
  }
}

static void check(double a, double a1, double bound) {
  const TcSegment s = tc_segment(a, a1);
  long double w[2];
  reference(a, a1, w);
  const double e0 = w[0] > 0 ? (double)fabsl((long double)s.w0 / w[0] - 1) : s.w0;
  const double e1 = w[1] > 0 ? (double)fabsl((long double)s.w1 / w[1] - 1) : s.w1;
  if (e0 > bound || e1 > bound)
    fail_msg("a=%a a1=%a: w0 off by %g, w1 by %g", a, a1, e0, e1);
}

static void agrees_with_quadrature(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int i = 0; i < 4000; ++i) {
    const double a = pow(10, -6 + 8.5 * uniform(&seed)), a1 = pow(10, -6 + 8.5 * uniform(&seed));
    check(a, a1, 4e-15);
    check(a, a * (1 + 1e-7 * (uniform(&seed) - 0.5)), 4e-15); /* nearly constant extinction */
    check(a, 0, 4e-15);
    check(0, a, 4e-15);
    const double x = 2 * uniform(&seed); /* around T = 1, where the formulas change */
    check(x, 2 - x, 4e-15);
    check(x, nextafter(2 - x, 0), 4e-15);
    check(x, nextafter(2 - x, 3), 4e-15);
  }
}

static void stays_in_range_at_extremes(void **state) {
  (void)state;
  static const double values[] = {0,   5e-324, 1e-308, 1e-300, 1e-160, 1e-20, 1e-8, 0.1,   0.5,   1,       2,       10,
                                  700, 745,    746,    1e4,    1e8,    1e16,  1e30, 1e160, 1e300, 1.7e308, INFINITY};
  enum { N = sizeof values / sizeof *values };
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      const TcSegment s = tc_segment(values[i], values[j]);
      assert_true(s.w0 >= 0 && s.w0 <= 1 && s.w1 >= 0 && s.w1 <= 1);
      assert_true(s.alpha >= 0 && s.alpha <= 1 && s.transmittance >= 0 && s.transmittance <= 1);
      assert_true(fabs(s.w0 + s.w1 - s.alpha) <= 1e-15 * s.alpha + 5e-324);
    }
  }
}

static void thin_segments_keep_relative_accuracy(void **state) {
  (void)state;
  for (double t = 1e-300; t < 1e-10; t *= 1e10) { /* w0 → (2a + a1)/6, w1 → (a + 2a1)/6 up to terms in a² */
    const TcSegment s = tc_segment(t, 3 * t);
    assert_true(fabs(s.w0 / (5 * t / 6) - 1) < 1e-15 + 10 * t);
    assert_true(fabs(s.w1 / (7 * t / 6) - 1) < 1e-15 + 10 * t);
    assert_true(fabs(s.alpha / (2 * t) - 1) < 1e-15 + 10 * t);
  }
}

/* What the short polynomials leave out is below T⁵/120, rounding apart. */
static void thin_polynomials_keep_their_bound(void **state) {
  (void)state;
  double worst = 0;
  for (double t = 1e-12; t <= 0.5; t *= 1.01) {
    for (int i = 0; i <= 20; ++i) {
      const double a = 2 * t * i / 20, a1 = 2 * t - a;
      const TcSegment exact = tc_segment(a, a1), thin = tc_segment_thin(a, a1);
      const double bound = t * t * t * t * t / 120, rounding = 4e-15 * t;
      const double off = fabs(thin.w0 - exact.w0) + fabs(thin.w1 - exact.w1);
      assert_true(off <= bound + rounding);
      assert_true(fabs(thin.alpha - exact.alpha) <= bound + rounding);
      assert_true(fabs(thin.transmittance - exact.transmittance) <= bound + 3e-16);
      assert_true(bound <= exact.alpha * t * t * t * t / 90);
      assert_true(thin.w0 >= 0 && thin.w1 >= 0 && thin.depth == exact.depth);
      if (t > 0.01)
        worst = fmax(worst, off / bound);
    }
  }
  assert_true(worst > 0.5); /* the bound is not far off either */
}

/* ── many segments ── */

static const struct {
  const char *name;
  TetcastIsa isa;
  GatherLanes *gather;
  double cut, drift; /* bounds */
} kernels[] = {
    {"scalar", TETCAST_ISA_SCALAR, gather_one, 2e-14, 1e-12},
#ifdef TC_HAVE_X86
    {"avx2", TETCAST_ISA_AVX2, gather_avx2, 2e-14, 1e-12},
    {"avx512", TETCAST_ISA_AVX512, gather_avx512, 2e-14, 1e-12},
    {"avx2_f32", TETCAST_ISA_AVX2, gather_avx2_f32, 1e-5, 600 * 0x1p-24},
    {"avx512_f32", TETCAST_ISA_AVX512, gather_avx512_f32, 1e-5, 600 * 0x1p-24},
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

/* One segment cut into a thousand gives what the whole gives, also across knots and steps, in both directions. */
static void cutting_changes_nothing(void **state) {
  (void)state;
  enum { PARTS = 1000 };
  static double length[PARTS], s0[PARTS], s1[PARTS];
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  TetcastTransferFunction *transfer = transfer_of(fixture.context, 3);
  for (int reverse = 0; reverse < 2; ++reverse) {
    const double from = reverse ? 1.1 : -0.1, to = reverse ? -0.1 : 1.1, whole = 0.7;
    double s = from;
    for (int i = 0; i < PARTS; ++i) {
      s0[i] = s;
      s = s1[i] = from + (to - from) * (i + 1) / PARTS;
      length[i] = whole * fabs(s1[i] - s0[i]) / 1.2;
    }
    for (int kernel = 0; kernel < KERNELS; ++kernel) {
      if (!tc_cpu_has(kernels[kernel].isa))
        continue;
      double a[4], b[4];
      kernels[kernel].gather(&transfer->pieces, &whole, &from, &to, 1, a);
      kernels[kernel].gather(&transfer->pieces, length, s0, s1, PARTS, b);
      for (int k = 0; k < 4; ++k) {
        if (!(fabs(a[k] - b[k]) < kernels[kernel].cut))
          fail_msg("%s: %.17g and %.17g", kernels[kernel].name, a[k], b[k]);
      }
      assert_true(a[3] > 0.5);
    }
  }
  tetcast_transfer_function_destroy(&transfer);
  fixture_end(&fixture);
}

/* 10⁵ equal segments: roundings all point the same way, and still do not pile up. */
static void many_segments_do_not_drift(void **state) {
  (void)state;
  enum { SEGMENTS = 100000 };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  double *length = malloc(SEGMENTS * sizeof *length), *value = malloc(SEGMENTS * sizeof *value);
  for (int i = 0; i < SEGMENTS; ++i)
    length[i] = 1e-5, value[i] = 0.5;
  static const double depth[] = {1e-15, 1e-3, 1.7, 20};
  for (int i = 0; i < 4; ++i) {
    TetcastTransferFunction *transfer = gray_of(fixture.context, depth[i]);
    for (int kernel = 0; kernel < KERNELS; ++kernel) {
      if (!tc_cpu_has(kernels[kernel].isa))
        continue;
      double rgba[4];
      kernels[kernel].gather(&transfer->pieces, length, value, value, SEGMENTS, rgba);
      for (int k = 0; k < 4; ++k) {
        const double off = fabs(rgba[k] / -expm1(-depth[i]) - 1);
        if (!(off < kernels[kernel].drift))
          fail_msg("%s, depth %g: off by %g", kernels[kernel].name, depth[i], off);
      }
    }
    tetcast_transfer_function_destroy(&transfer);
  }
  free(length), free(value);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(agrees_with_quadrature),
      cmocka_unit_test(stays_in_range_at_extremes),
      cmocka_unit_test(thin_segments_keep_relative_accuracy),
      cmocka_unit_test(cutting_changes_nothing),
      cmocka_unit_test(many_segments_do_not_drift),
      cmocka_unit_test(thin_polynomials_keep_their_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
