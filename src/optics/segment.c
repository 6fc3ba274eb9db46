/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/segment.h"

#include <math.h>

/* The same in both precisions. */
const _Alignas(64) double tc_special_f64[2 * TC_SPECIAL_ROWS][TC_SPECIAL_TERMS] = {
#include "optics/special_table.h"
};
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wimplicit-float-conversion"
#endif
const _Alignas(64) float tc_special_f32[2 * TC_SPECIAL_ROWS][TC_SPECIAL_TERMS] = {
#include "optics/special_table.h"
};
#pragma GCC diagnostic pop

/* Largest a, so that nothing that is computed from two of them overflows. */
static const double MAX_DEPTH = 1e300;

/* The value of the table's rows first … first + rows − 1 at t in [0, 1] (Horner; coefficients fall quickly: error below
 * 2 ulp). */
static double table_value(int first, int rows, double t) {
  const double scaled = t * rows;
  int i = (int)scaled;
  if (i > rows - 1)
    i = rows - 1;
  const double v = 2 * (scaled - i) - 1;
  const double *c = tc_special_f64[first + i];
  double p = c[TC_SPECIAL_TERMS - 1];
  for (int k = TC_SPECIAL_TERMS - 2; k >= 0; --k)
    p = p * v + c[k];
  return p;
}

/* Ψ for T ≥ 1. For rising extinction Ψ = f(a) − e^−T f(a1) with f(a1) ≤ f(a):
 *     f(x) = ∫₀^∞ exp(−x u − b u²/2) du = M(x/√b)/√b,   M Mills' ratio.
 * For falling extinction, seen from the far end, Ψ = f(a) − e^−T f(a1) with
 *     f(x) = √(2/β) D(x/√(2β)),   β = a − a1,   D Dawson's integral.
 * With T ≥ 1 neither difference loses more than two bits, nor do 1 − Ψ and Ψ − e^−T. Either f is p(t)/(r + x), t = r/(r
 * + x), with the table's p, which is bounded, and r = √b or √(8β): bounded arithmetic for every x and b, b = 0
 * included. */
static double psi(double a, double a1, double transmittance) {
  const double b = a1 - a, r = sqrt(b >= 0 ? b : -8 * b);
  const int first = b >= 0 ? 0 : TC_MILLS_ROWS, rows = b >= 0 ? TC_MILLS_ROWS : TC_DAWSON_ROWS;
  const double near = table_value(first, rows, r / (r + a)) / (r + a);
  return transmittance > 0 ? near - transmittance * (table_value(first, rows, r / (r + a1)) / (r + a1)) : near;
}

/* ∫₀¹ e^−τ du for T < 1 and its parts that are odd and even about the middle, by the Taylor series there. With v = 2u −
 * 1, d = (a1 − a)/2: e^−τ = e^−τ(0) E(v),   E = exp(−(T v + d v²/2)/2) = Σ eₙ vⁿ,   (n + 1) eₙ₊₁ = −(T eₙ + d eₙ₋₁)/2,
 * τ(0) = T/2 − d/4. |d| ≤ T, so |eₙ| ≲ (T/4)^(n/2)/⌊n/2⌋!, from which the number of terms for an error below 1e-16
 * follows. */
typedef struct Series {
  double middle;              /* e^−τ(0) */
  double zero, first, second; /* ½ ∫₋₁¹ E, v E, v² E dv */
} Series;

static inline Series series(double t, double d) {
  static const double reciprocal[] = {0,       1,       1. / 2,  1. / 3,  1. / 4,  1. / 5,  1. / 6,  1. / 7,
                                      1. / 8,  1. / 9,  1. / 10, 1. / 11, 1. / 12, 1. / 13, 1. / 14, 1. / 15,
                                      1. / 16, 1. / 17, 1. / 18, 1. / 19, 1. / 20, 1. / 21, 1. / 22, 1. / 23,
                                      1. / 24, 1. / 25, 1. / 26, 1. / 27, 1. / 28, 1. / 29};
  const int terms = t < 1e-4 ? 6 : t < 0.01 ? 10 : t < 0.1 ? 14 : t < 0.3 ? 18 : 26;
  double before = 0, e = 1;
  Series s = {.zero = 0};
  for (int n = 0; n < terms; n += 2) {
    s.zero += e * reciprocal[n + 1];
    s.second += e * reciprocal[n + 3];
    double next = -0.5 * (t * e + d * before) * reciprocal[n + 1];
    before = e;
    e = next;
    s.first += e * reciprocal[n + 3];
    next = -0.5 * (t * e + d * before) * reciprocal[n + 2];
    before = e;
    e = next;
  }
  s.middle = exp(0.25 * d - 0.5 * t);
  return s;
}

/* w₁ − w₀ = ½ e^−τ(0) ∫₋₁¹ v (T + d v) E(v) dv for T < 1. */
static double weight_difference(double t, double d) {
  const Series s = series(t, d);
  return s.middle * (t * s.first + d * s.second);
}

TcSegment tc_segment(double a, double a1) {
  if (a > MAX_DEPTH)
    a = MAX_DEPTH;
  if (a1 > MAX_DEPTH)
    a1 = MAX_DEPTH;
  TcSegment segment;
  const double t = 0.5 * a + 0.5 * a1;
  segment.depth = t;
  if (t < 1) {
    segment.alpha = -expm1(-t);
    segment.transmittance = 1 - segment.alpha;
    const double difference = weight_difference(t, 0.5 * a1 - 0.5 * a);
    segment.w0 = 0.5 * (segment.alpha - difference);
    segment.w1 = 0.5 * (segment.alpha + difference);
    return segment;
  }
  segment.transmittance = exp(-t);
  segment.alpha = 1 - segment.transmittance;
  const double p = psi(a, a1, segment.transmittance);
  segment.w0 = 1 - p;
  segment.w1 = p - segment.transmittance;
  return segment;
}

/* e^−τ ≈ 1 − τ + τ²/2 − τ³/6, alternating, so off by at most τ⁴/24; ∫ τ' τ⁴/24 = T⁵/120. The weights' difference is
 * ½ ∫₋₁¹ v (T + d v) e^−τ dv with τ = T (1 + v)/2 + d (v² − 1)/4, as in weight_difference(). */
TcSegment tc_segment_thin(double a, double a1) {
  const double t = 0.5 * a + 0.5 * a1, d = 0.5 * a1 - 0.5 * a;
  const double c0 = d * (1. / 3 + d * (1. / 30 + d * (1. / 420 + d * (1. / 7560))));
  const double c1 = -d * (1. / 6 + d * (1. / 60 + d * (1. / 840)));
  const double c2 = d * (1. / 20 + d * (1. / 210)) - 1. / 6, c3 = 1. / 12 - d * (1. / 90), c4 = -1. / 40;
  const double difference = c0 + t * (c1 + t * (c2 + t * (c3 + t * c4)));
  TcSegment segment;
  segment.depth = t;
  segment.alpha = t * (1 - t * (0.5 - t * (1. / 6 - t * (1. / 24))));
  segment.transmittance = 1 - segment.alpha;
  segment.w0 = 0.5 * (segment.alpha - difference);
  segment.w1 = 0.5 * (segment.alpha + difference);
  return segment;
}

TcSegment tc_segment_constant(double depth) {
  TcSegment segment;
  if (depth > MAX_DEPTH)
    depth = MAX_DEPTH;
  segment.depth = depth;
  segment.alpha = -expm1(-depth);
  segment.transmittance = depth < 0.5 ? 1 - segment.alpha : exp(-depth);
  segment.w0 = segment.alpha;
  segment.w1 = 0;
  return segment;
}

/* For T ≥ 1, as psi(): with g = −f' for rising and falling extinction alike, integration by parts gives
 *     m₁ = g(a) − e^−T (f(a1) + g(a1)),   m₀ = f(a) − g(a) + e^−T g(a1),
 * where g is q(t)/(r + x)², and q = p + t p' is in the second half of the table. The largest term is at most seven
 * times the result, at T = 1.
 *
 * Errors, in units of 2^−53: t 2, a quotient's 1/(r + x) 2, a table's value 4, so f 8 and g 10; e^−T, T's own rounding
 * included, 3 where it counts; sums 2. With the terms' sizes at T = 1, where they are worst: below 45, or 5e-15. Below
 * T = 1 the series is off by 6 relative to its largest term, and e^−τ(0) by 3, of which no more than a factor of 2 is
 * lost in m₀ and m₁. */
static void deep_moments(double a, double a1, TcMoments *m) {
  const double b = a1 - a, r = sqrt(b >= 0 ? b : -8 * b);
  const int first = b >= 0 ? 0 : TC_MILLS_ROWS, rows = b >= 0 ? TC_MILLS_ROWS : TC_DAWSON_ROWS;
  const double near = 1 / (r + a), t = r * near;
  const double f = table_value(first, rows, t) * near, g = table_value(TC_SPECIAL_ROWS + first, rows, t) * near * near;
  m->m0 = f - g;
  m->m1 = g;
  if (m->transmittance > 0) {
    const double far = 1 / (r + a1), t1 = r * far;
    const double f1 = table_value(first, rows, t1) * far,
                 g1 = table_value(TC_SPECIAL_ROWS + first, rows, t1) * far * far;
    m->m0 += m->transmittance * g1;
    m->m1 -= m->transmittance * (f1 + g1);
  }
}

TcMoments tc_segment_moments(double a, double a1) {
  if (a > TC_LARGEST_DENSITY)
    a = TC_LARGEST_DENSITY;
  if (a1 > TC_LARGEST_DENSITY)
    a1 = TC_LARGEST_DENSITY;
  TcMoments m;
  m.depth = 0.5 * a + 0.5 * a1;
  if (m.depth < 1) {
    const Series s = series(m.depth, 0.5 * a1 - 0.5 * a);
    m.m0 = 0.5 * s.middle * (s.zero - s.first);
    m.m1 = 0.5 * s.middle * (s.zero + s.first);
    m.transmittance = 1 + expm1(-m.depth);
    return m;
  }
  m.transmittance = exp(-m.depth);
  deep_moments(a, a1, &m);
  return m;
}
