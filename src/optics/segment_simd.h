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
  TcVec n, half_n;
  const TcLong whole = tc_nearest(x * 0x1.71547652b82fep0, &n), half = tc_nearest(0.5 * n, &half_n); /* 2ⁿ alone could underflow */
  TcVec r = tc_madd(n, tc_set(-0x1.62e42feep-1), x); /* ln 2 in 32 bits: the product is exact */
  r = tc_madd(n, tc_set(-0x1.a39ef35793c76p-33), r);
  return tc_polynomial(r, c, 14) * tc_power_of_two(half) * tc_power_of_two(whole - half);
}

/* T ≤ 1/16, 1/4 or 1/2. With h = T/2, g = e^−h − 1: α = −g (2 + g), and, as in weight_difference() of segment.c,
 *
 *     w₁ − w₀ = e^(d/4 − h) (d A − T² B),   x = T²/4, y = −d/4,
 *     A = ½ ∫₋₁¹ v² cosh(T v/2) e^(−d v²/4) dv       = Σ xⁱ yʲ / ((2i)! j! (2i + 2j + 3)),
 *     B = ½ ∫₋₁¹ v sinh(T v/2)/T e^(−d v²/4) dv      = ½ Σ xⁱ yʲ / ((2i + 1)! j! (2i + 2j + 3)).
 *
 * With |y| ≤ T/4, x = T²/4 what the rows leave out is, in all, below 1.6e-16 of A and 1.7e-16 / T of B, so below 3e-16 T of w₁ − w₀: a row's
 * first term left out bounds its rest, as terms fall by y/j. */
#define TC_A(i, f, j, g) (1. / ((f) * (g) * (2. * (i) + 2. * (j) + 3.)))
#define TC_A_ROW(i, f)                                                                                                 \
  {TC_A(i, f, 0, 1.),    TC_A(i, f, 1, 1.),    TC_A(i, f, 2, 2.),    TC_A(i, f, 3, 6.),     TC_A(i, f, 4, 24.),    \
   TC_A(i, f, 5, 120.), TC_A(i, f, 6, 720.), TC_A(i, f, 7, 5040.), TC_A(i, f, 8, 40320.), TC_A(i, f, 9, 362880.)}
enum { TC_SERIES_ROWS = 6, TC_SERIES_TERMS = 10 };
static const double tc_series_a[TC_SERIES_ROWS][TC_SERIES_TERMS] = {TC_A_ROW(0, 1.),   TC_A_ROW(1, 2.),     TC_A_ROW(2, 24.),
                                                                    TC_A_ROW(3, 720.), TC_A_ROW(4, 40320.), TC_A_ROW(5, 3628800.)};
static const double tc_series_b[TC_SERIES_ROWS][TC_SERIES_TERMS] = {TC_A_ROW(0, 2.),     TC_A_ROW(1, 12.),     TC_A_ROW(2, 240.),
                                                                    TC_A_ROW(3, 10080.), TC_A_ROW(4, 725760.), TC_A_ROW(5, 79833600.)};

typedef enum TcSeries { TC_TO_16TH, TC_TO_4TH, TC_TO_HALF } TcSeries;

/* Terms of A's and B's rows, which end with 0, of g, of e^−y. */
typedef struct TcSeriesTerms {
  int a[TC_SERIES_ROWS + 1], b[TC_SERIES_ROWS + 1], g, e;
} TcSeriesTerms;
static const TcSeriesTerms tc_series_terms[] = {
  [TC_TO_16TH] = {{7, 6, 4, 2}, {6, 5, 3, 1}, 8, 7},
  [TC_TO_4TH] = {{9, 8, 6, 5, 3}, {8, 7, 6, 4, 1}, 10, 9},
  [TC_TO_HALF] = {{10, 9, 8, 6, 5, 3}, {10, 9, 7, 6, 4, 1}, 12, 11},
};

/* g = e^−h − 1 by its series: 8, 10, 12 terms for h ≤ 1/32, 1/8, 1/4. */
TC_INLINE TcVec tc_segments_g(TcVec h, int count) {
  static const double terms[] = {-1,          1. / 2,     -1. / 6,      1. / 24,      -1. / 120,      1. / 720,
                                 -1. / 5040,  1. / 40320, -1. / 362880, 1. / 3628800, -1. / 39916800, 1. / 479001600};
  return h * tc_polynomial(h, terms, count);
}

/* Σ c[j] yʲ + x sum, j < terms[0]; `sum` is 0 where there are no terms[1]. */
TC_INLINE TcVec tc_series_row(TcVec sum, TcVec x, TcVec y, const double c[TC_SERIES_TERMS], const int terms[2]) {
  if (!terms[0]) return sum;
  const TcVec row = tc_polynomial(y, c, terms[0]);
  return terms[1] ? tc_madd(sum, x, row) : row;
}

/* Σ xⁱ Σ c[i][j] yʲ, j < terms[i]. Written out, as compilers leave a loop over rows a loop. */
TC_INLINE TcVec tc_series_sum(TcVec x, TcVec y, const double c[TC_SERIES_ROWS][TC_SERIES_TERMS], const int terms[TC_SERIES_ROWS + 1]) {
  TcVec sum = tc_series_row(tc_set(0), x, y, c[5], terms + 5);
  sum = tc_series_row(sum, x, y, c[4], terms + 4);
  sum = tc_series_row(sum, x, y, c[3], terms + 3);
  sum = tc_series_row(sum, x, y, c[2], terms + 2);
  sum = tc_series_row(sum, x, y, c[1], terms + 1);
  return tc_series_row(sum, x, y, c[0], terms);
}

TC_INLINE TcSegments tc_segments_series(TcVec t, TcVec d, const TcSeries range) {
  static const double e_terms[] = {1, 1, 1. / 2, 1. / 6, 1. / 24, 1. / 120, 1. / 720, 1. / 5040, 1. / 40320, 1. / 362880, 1. / 3628800};
  const TcSeriesTerms *terms = &tc_series_terms[range];
  const TcVec h = 0.5 * t, x = h * h, y = -0.25 * d;
  const TcVec g = tc_segments_g(h, terms->g), e = tc_polynomial(-y, e_terms, terms->e);
  const TcVec alpha = -g * (2 + g);
  const TcVec a = tc_series_sum(x, y, tc_series_a, terms->a), b = tc_series_sum(x, y, tc_series_b, terms->b);
  const TcVec difference = tc_madd(g, e, e) * (d * a - t * t * b);
  return (TcSegments){0.5 * (alpha - difference), 0.5 * (alpha + difference), 1 - alpha};
}

/* tc_segment_thin(), T ≤ 1/2, for vectors of any precision: the opacity, and the difference of the two weights. */
#define TC_SEGMENTS_THIN(t, d, alpha, difference, madd, set)                                                                             \
  do {                                                                                                                                   \
    (alpha) = (t) * madd(-(t), madd(-(t), madd(-(t), set(1. / 24), set(1. / 6)), set(0.5)), set(1));                                     \
    (difference) = madd(t, set(-1. / 40), madd(d, set(-1. / 90), set(1. / 12)));                                                         \
    (difference) = madd(t, difference, madd(d, madd(d, set(1. / 210), set(1. / 20)), set(-1. / 6)));                                     \
    (difference) = madd(t, difference, -(d) * madd(d, madd(d, set(1. / 840), set(1. / 60)), set(1. / 6)));                               \
    (difference) = madd(t, difference, (d) * (madd(d, madd(d, madd(d, set(1. / 7560), set(1. / 420)), set(1. / 30)), set(1. / 3))));     \
  } while (0)

TC_INLINE TcSegments tc_segments_thin(TcVec t, TcVec d) {
  TcVec alpha, difference;
  TC_SEGMENTS_THIN(t, d, alpha, difference, tc_madd, tc_set);
  return (TcSegments){0.5 * (alpha - difference), 0.5 * (alpha + difference), 1 - alpha};
}

/* The table's value at t in the rows first … first + rows − 1, both whole, and different from lane to lane. */
TC_INLINE TcVec tc_special(TcVec first, TcVec rows, TcVec t) {
  TcVec i, c[TC_SPECIAL_TERMS];
  const TcVec scaled = t * rows - 0.5; /* half a row off: the nearest number is that of the row */
  const TcLong row = tc_nearest(tc_min(scaled, rows - 1) + first, &i);
  tc_load_records(tc_special_table[0], row * TC_SPECIAL_TERMS, TC_SPECIAL_TERMS / 4, c);
  const TcVec v = 2 * (scaled - (i - first));
  TcVec sum = c[TC_SPECIAL_TERMS - 1];
  for (int k = TC_SPECIAL_TERMS - 2; k >= 0; --k) sum = tc_madd(sum, v, c[k]);
  return sum;
}

/* T > 1/2, as psi() of segment.c does it. */
TC_INLINE TcSegments tc_segments_thick(TcVec a, TcVec a1) {
  const TcVec most = tc_set(1e300), zero = tc_set(0);
  a = tc_min(a, most);
  a1 = tc_min(a1, most);
  const TcVec b = a1 - a;
  const TcMask rises = tc_le(zero, b);
  const TcVec first = tc_select(rises, zero, tc_set(TC_MILLS_ROWS)), rows = tc_select(rises, tc_set(TC_MILLS_ROWS), tc_set(TC_DAWSON_ROWS));
  const TcVec r = tc_sqrt(tc_select(rises, b, -8 * b)), near = 1 / (r + a), far = 1 / (r + a1);
  const TcVec e = tc_exp(-0.5 * a - 0.5 * a1);
  const TcVec psi = tc_special(first, rows, r * near) * near - e * (tc_special(first, rows, r * far) * far);
  return (TcSegments){1 - psi, psi - e, e};
}

/* tc_segments() where a depth is above 1/4. */
static __attribute__((noinline)) void tc_segments_deep(TcMask mask, double thin, const TcVec *ends, const TcVec *depth,
                                                       TcSegments *result) {
  const TcVec a = ends[0], a1 = ends[1], t = *depth, one = tc_set(1);
  const TcMask thick = tc_and(mask, tc_gt(t, tc_set(0.5))), others = tc_and_not(mask, thick);
  TcSegments segments = {tc_set(0), tc_set(0), one};
  if (tc_any(others)) {
    const TcVec d = 0.5 * a1 - 0.5 * a;
    if (thin > 0 && !tc_any(tc_and(others, tc_gt(t, tc_set(thin))))) segments = tc_segments_thin(t, d);
    else if (!tc_any(tc_and(others, tc_gt(t, tc_set(0x1p-4))))) segments = tc_segments_series(t, d, TC_TO_16TH);
    else segments = tc_segments_series(t, d, TC_TO_HALF);
  }
  if (tc_any(thick)) {
    const TcSegments deep = tc_segments_thick(tc_select(thick, a, one), tc_select(thick, a1, one));
    segments.w0 = tc_select(thick, deep.w0, segments.w0);
    segments.w1 = tc_select(thick, deep.w1, segments.w1);
    segments.transmittance = tc_select(thick, deep.transmittance, segments.transmittance);
  }
  *result = segments;
}

/* Any a, a1 ≥ 0 in the lanes of `mask`, 0 in the others; t = (a + a1)/2. If all depths are up to `thin`, by tc_segments_thin(), else with relative
 * errors of w0 and w1 below 8e-15: the most, where Ψ is taken from Mills' ratios of 2, at T = 1/2. */
TC_INLINE TcSegments tc_segments(TcMask mask, TcVec a, TcVec a1, TcVec t, double thin) {
  const TcVec d = 0.5 * a1 - 0.5 * a;
  if (thin > 0 && !tc_any(tc_and(mask, tc_gt(t, tc_set(thin))))) return tc_segments_thin(t, d);
  if (!tc_any(tc_and(mask, tc_gt(t, tc_set(0x1p-4))))) return tc_segments_series(t, d, TC_TO_16TH);
  if (!tc_any(tc_and(mask, tc_gt(t, tc_set(0x1p-2))))) return tc_segments_series(t, d, TC_TO_4TH);
  const TcVec ends[2] = {a, a1};
  TcSegments result;
  tc_segments_deep(mask, thin, ends, &t, &result);
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
