/* SPDX-License-Identifier: Apache-2.0 */
/* The segment's integral (segment.h) for several segments at once. */
#ifndef TC_OPTICS_SEGMENT_SIMD_H
#define TC_OPTICS_SEGMENT_SIMD_H

#include "base/simd.h"
#include "optics/segment.h"

typedef struct TcSegments {
  TcVec w0, w1, transmittance;
} TcSegments;

/* Σ c[i] xⁱ, i < n, by Horner; unrolled where n and c are constants. */
TC_INLINE TcVec tc_polynomial(TcVec x, const double *c, int n) {
  TcVec sum = tc_set(c[n - 1]);
  for (int i = n - 2; i >= 0; --i) sum = tc_madd(sum, x, tc_set(c[i]));
  return sum;
}

/* e^x to 1.5 ulp for x ≤ 0, gradually to 0 below −708: e^r 2ⁿ with |r| ≤ ln 2 / 2, Taylor to r¹³ (left out: < 2⁻⁵⁷). */
TC_INLINE TcVec tc_exp(TcVec x) {
  static const double c[] = {1,           1,           1. / 2,       1. / 6,        1. / 24,        1. / 120,       1. / 720,
                             1. / 5040,   1. / 40320,  1. / 362880,  1. / 3628800,  1. / 39916800,  1. / 479001600, 1. / 6227020800};
  x = tc_max(x, tc_set(-1400)); /* where both powers of two are in range, and their product is not */
  const TcVec shift = tc_set(0x1.8p52), n = (x * 0x1.71547652b82fep0 + shift) - shift;
  TcVec r = tc_madd(n, tc_set(-0x1.62e42feep-1), x); /* ln 2 in 32 bits: the product is exact */
  r = tc_madd(n, tc_set(-0x1.a39ef35793c76p-33), r);
  const TcLong whole = tc_to_long(n), half = whole >> 1; /* twice, as 2ⁿ alone could underflow */
  return tc_polynomial(r, c, 14) * tc_power_of_two(half) * tc_power_of_two(whole - half);
}

/* T ≤ 1/4, thinner with S. With h = T/2, g = e^−h − 1: α = −g (2 + g), and, as in weight_difference() of segment.c,
 *
 *     w₁ − w₀ = e^(d/4 − h) (d A − T² B),   x = T²/4, y = −d/4,
 *     A = ½ ∫₋₁¹ v² cosh(T v/2) e^(−d v²/4) dv       = Σ xⁱ yʲ / ((2i)! j! (2i + 2j + 3)),
 *     B = ½ ∫₋₁¹ v sinh(T v/2)/T e^(−d v²/4) dv      = ½ Σ xⁱ yʲ / ((2i + 1)! j! (2i + 2j + 3)).
 *
 * What the sums leave out is below 3e-16 T in w₁ − w₀: |y| ≤ 1/16, x ≤ 1/64 (S: 1/64, 1/1024). */
#define TC_A(i, f, j, g) (1. / ((f) * (g) * (2. * (i) + 2. * (j) + 3.)))
#define TC_A_ROW(i, f)                                                                                                \
  {TC_A(i, f, 0, 1.),    TC_A(i, f, 1, 1.),    TC_A(i, f, 2, 2.),     TC_A(i, f, 3, 6.),     TC_A(i, f, 4, 24.), \
   TC_A(i, f, 5, 120.), TC_A(i, f, 6, 720.), TC_A(i, f, 7, 5040.), TC_A(i, f, 8, 40320.)}

static const double tc_segments_a[5][9] = {TC_A_ROW(0, 1.), TC_A_ROW(1, 2.), TC_A_ROW(2, 24.), TC_A_ROW(3, 720.), TC_A_ROW(4, 40320.)};
static const double tc_segments_b[5][9] = {TC_A_ROW(0, 2.), TC_A_ROW(1, 12.), TC_A_ROW(2, 240.), TC_A_ROW(3, 10080.),
                                           TC_A_ROW(4, 725760.)};

/* g = e^−h − 1 by its series, for h ≤ 1/8 by ten terms. */
TC_INLINE TcVec tc_segments_g(TcVec h, int count) {
  static const double terms[] = {-1,         1. / 2,      -1. / 6,      1. / 24,     -1. / 120,
                                 1. / 720,   -1. / 5040,  1. / 40320,   -1. / 362880, 1. / 3628800};
  return h * tc_polynomial(h, terms, count);
}

TC_INLINE TcSegments tc_segments_series(TcVec t, TcVec d, const int thinner) {
  static const double e_terms[] = {1, 1, 1. / 2, 1. / 6, 1. / 24, 1. / 120, 1. / 720, 1. / 5040, 1. / 40320};
  const double(*a)[9] = tc_segments_a, (*b)[9] = tc_segments_b;
  const TcVec h = 0.5 * t, x = h * h, y = -0.25 * d;
  const TcVec g = tc_segments_g(h, thinner ? 8 : 10);
  const TcVec e = tc_polynomial(-y, e_terms, thinner ? 7 : 9);
  TcVec sum_a, sum_b;
  if (thinner) {
    sum_a = tc_madd(tc_polynomial(y, a[3], 2), x, tc_polynomial(y, a[2], 4));
    sum_a = tc_madd(tc_madd(sum_a, x, tc_polynomial(y, a[1], 5)), x, tc_polynomial(y, a[0], 7));
    sum_b = tc_madd(tc_set(b[3][0]), x, tc_polynomial(y, b[2], 2));
    sum_b = tc_madd(tc_madd(sum_b, x, tc_polynomial(y, b[1], 4)), x, tc_polynomial(y, b[0], 6));
  } else {
    sum_a = tc_madd(tc_polynomial(y, a[4], 3), x, tc_polynomial(y, a[3], 4));
    sum_a = tc_madd(sum_a, x, tc_polynomial(y, a[2], 6));
    sum_a = tc_madd(tc_madd(sum_a, x, tc_polynomial(y, a[1], 8)), x, tc_polynomial(y, a[0], 9));
    sum_b = tc_madd(tc_set(b[4][0]), x, tc_polynomial(y, b[3], 2));
    sum_b = tc_madd(sum_b, x, tc_polynomial(y, b[2], 4));
    sum_b = tc_madd(tc_madd(sum_b, x, tc_polynomial(y, b[1], 6)), x, tc_polynomial(y, b[0], 8));
  }
  const TcVec alpha = -g * (2 + g);
  const TcVec difference = tc_madd(g, e, e) * (d * sum_a - t * t * sum_b);
  return (TcSegments){0.5 * (alpha - difference), 0.5 * (alpha + difference), 1 - alpha};
}

/* tc_segment_thin(): T ≤ 1/2. */
TC_INLINE TcSegments tc_segments_thin(TcVec t, TcVec d) {
  const TcVec c0 = d * (tc_madd(d, tc_madd(d, tc_madd(d, tc_set(1. / 7560), tc_set(1. / 420)), tc_set(1. / 30)), tc_set(1. / 3)));
  const TcVec c1 = -d * tc_madd(d, tc_madd(d, tc_set(1. / 840), tc_set(1. / 60)), tc_set(1. / 6));
  const TcVec c2 = tc_madd(d, tc_madd(d, tc_set(1. / 210), tc_set(1. / 20)), tc_set(-1. / 6));
  const TcVec c3 = tc_madd(d, tc_set(-1. / 90), tc_set(1. / 12));
  const TcVec difference = tc_madd(t, tc_madd(t, tc_madd(t, tc_madd(t, tc_set(-1. / 40), c3), c2), c1), c0);
  const TcVec alpha = t * tc_madd(-t, tc_madd(-t, tc_madd(-t, tc_set(1. / 24), tc_set(1. / 6)), tc_set(0.5)), tc_set(1));
  return (TcSegments){0.5 * (alpha - difference), 0.5 * (alpha + difference), 1 - alpha};
}

/* The lanes of `lanes` one by one. */
static __attribute__((noinline)) void tc_segments_deep(unsigned lanes, const TcVec *a, const TcVec *a1, TcSegments *result) {
  double w0[TC_LANES], w1[TC_LANES], transmittance[TC_LANES], depth[2][TC_LANES];
  memcpy(w0, &result->w0, sizeof w0);
  memcpy(w1, &result->w1, sizeof w1);
  memcpy(transmittance, &result->transmittance, sizeof transmittance);
  memcpy(depth[0], a, sizeof depth[0]);
  memcpy(depth[1], a1, sizeof depth[1]);
  for (int i = 0; i < TC_LANES; ++i) {
    if (!(lanes >> i & 1)) continue;
    const TcSegment segment = tc_segment(depth[0][i], depth[1][i]);
    w0[i] = segment.w0;
    w1[i] = segment.w1;
    transmittance[i] = segment.transmittance;
  }
  memcpy(&result->w0, w0, sizeof w0);
  memcpy(&result->w1, w1, sizeof w1);
  memcpy(&result->transmittance, transmittance, sizeof transmittance);
}

/* Any a, a1 ≥ 0 in the lanes of `mask`; t = (a + a1)/2. If all depths are up to `thin`, by tc_segments_thin(). */
TC_INLINE TcSegments tc_segments(TcMask mask, TcVec a, TcVec a1, TcVec t, double thin) {
  const TcVec d = 0.5 * a1 - 0.5 * a;
  if (thin > 0 && !tc_any(tc_and(mask, tc_gt(t, tc_set(thin))))) return tc_segments_thin(t, d);
  if (!tc_any(tc_and(mask, tc_gt(t, tc_set(0x1p-4))))) return tc_segments_series(t, d, 1);
  TcSegments result = tc_segments_series(t, d, 0);
  const unsigned deep = tc_bits(tc_and(mask, tc_gt(t, tc_set(0x1p-2))));
  if (deep) {
    const TcVec copy[2] = {a, a1};
    TcSegments all = result;
    tc_segments_deep(deep, &copy[0], &copy[1], &all);
    result = all;
  }
  return result;
}

/* a = a1 = t: w0 holds the opacity, w1 nothing. */
TC_INLINE TcSegments tc_segments_constant(TcMask mask, TcVec t) {
  const TcVec g = tc_segments_g(0.5 * t, 10), alpha = -g * (2 + g);
  TcSegments result = {alpha, tc_set(0), 1 - alpha};
  const TcMask deep = tc_and(mask, tc_gt(t, tc_set(0x1p-2)));
  if (tc_any(deep)) {
    const TcVec e = tc_exp(-t);
    result.w0 = tc_select(deep, 1 - e, result.w0);
    result.transmittance = tc_select(deep, e, result.transmittance);
  }
  return result;
}

#endif
