/* SPDX-License-Identifier: Apache-2.0 */
/* The segment's integral (segment.h) for a segment in each lane. */
#ifndef TC_OPTICS_SEGMENT_LANES_H
#define TC_OPTICS_SEGMENT_LANES_H

#include "base/lanes.h"
#include "optics/segment.h"
#include "optics/segment_fit.h"

typedef struct TcSegments {
  TcVec alpha, w0, w1; /* w0 + w1 = alpha */
} TcSegments;

/* ── up to a depth of ½, or of 1: fitted polynomials ── */

/* Horner in x for each power of d, and in d over these; a row's coefficients are constants, so that all of it is
 * written out. */
#define TC_FIT_ROW(...)                                                                                                \
  {                                                                                                                    \
    const double row[] = {__VA_ARGS__};                                                                                \
    const TcVec value = tc_polynomial(x, row, sizeof row / sizeof *row);                                               \
    sum = first ? value : tc_madd(sum, d, value);                                                                      \
    first = false;                                                                                                     \
  }
#define TC_FIT(name, FIT)                                                                                              \
  TC_INLINE TcVec name(TcVec x, TcVec d) {                                                                             \
    TcVec sum = x;                                                                                                     \
    bool first = true;                                                                                                 \
    FIT(TC_FIT_ROW)                                                                                                    \
    return sum;                                                                                                        \
  }
/* (e^−h − 1) / h, and e^−h − 1 */
#define TC_FIT_G(name, ...)                                                                                            \
  TC_INLINE TcVec name##_slope(TcVec h) {                                                                              \
    static const double c[] = {__VA_ARGS__};                                                                           \
    return tc_polynomial(h, c, sizeof c / sizeof *c);                                                                  \
  }                                                                                                                    \
  TC_INLINE TcVec name(TcVec h) {                                                                                      \
    return h * name##_slope(h);                                                                                        \
  }

/* α = −g (2 + g), w₁ − w₀ = (1 + g) K. */
TC_INLINE TcSegments tc_segments_fitted(TcVec g, TcVec k) {
  const TcVec half = (TcReal)0.5 * tc_madd(g, k, k), alpha = -g * (2 + g), half_alpha = (TcReal)0.5 * alpha;
  return (TcSegments){alpha, half_alpha - half, half_alpha + half};
}
#define TC_FIT_SEGMENTS(name, FIT)                                                                                     \
  TC_FIT_G(tc_g_##name, TC_FIT_G_##FIT)                                                                                \
  TC_FIT(tc_k_##name, TC_FIT_K_##FIT)                                                                                  \
  TC_INLINE TcSegments tc_segments_##name(TcVec t, TcVec d) {                                                          \
    return tc_segments_fitted(tc_g_##name((TcReal)0.5 * t), tc_k_##name(t * t, d));                                    \
  }
#if TC_SINGLE
TC_FIT_SEGMENTS(half, SINGLE)
#else
TC_FIT_SEGMENTS(16th, 16TH)
TC_FIT_SEGMENTS(4th, 4TH)
TC_FIT_SEGMENTS(half, HALF)
#endif

#if !TC_SINGLE
/* tc_segment_thin(), T ≤ ½. */
TC_INLINE TcSegments tc_segments_thin(TcVec t, TcVec d) {
  const TcVec alpha =
      t * tc_madd(-t, tc_madd(-t, tc_madd(-t, tc_set(1. / 24), tc_set(1. / 6)), tc_set(0.5)), tc_set(1));
  TcVec difference = tc_madd(t, tc_set(-1. / 40), tc_madd(d, tc_set(-1. / 90), tc_set(1. / 12)));
  difference = tc_madd(t, difference, tc_madd(d, tc_madd(d, tc_set(1. / 210), tc_set(1. / 20)), tc_set(-1. / 6)));
  difference = tc_madd(t, difference, -d * tc_madd(d, tc_madd(d, tc_set(1. / 840), tc_set(1. / 60)), tc_set(1. / 6)));
  difference = tc_madd(
      t, difference,
      d * (tc_madd(d, tc_madd(d, tc_madd(d, tc_set(1. / 7560), tc_set(1. / 420)), tc_set(1. / 30)), tc_set(1. / 3))));
  return (TcSegments){alpha, 0.5 * (alpha - difference), 0.5 * (alpha + difference)};
}
#endif

/* ── beyond: Mills' ratio, Dawson's integral ── */

/* The table's value at t in the rows first … first + rows − 1, both whole, and different from lane to lane. */
#if TC_SINGLE
#define tc_special_row(i) tc_special_f32[i]
#else
#define tc_special_row(i) tc_special_f64[i]
#endif
TC_INLINE TcVec tc_special(TcVec first, TcVec rows, TcVec t) {
  TcVec i, c[TC_SPECIAL_TERMS];
  const TcVec scaled = t * rows - (TcReal)0.5; /* half a row off: the nearest number is that of the row */
  const TcInt row = tc_nearest(tc_min(scaled, rows - 1) + first, &i);
  const TcReal *at[TC_LANES];
  for (int part = 0; part < TC_SPECIAL_TERMS; part += 4) {
    for (int l = 0; l < TC_LANES; ++l)
      at[l] = tc_special_row(TC_AT(row, l)) + part;
    tc_load_records(at, c + part);
  }
  const TcVec v = 2 * (scaled - (i - first));
  TcVec sum = c[TC_SPECIAL_TERMS - 1];
  for (int k = TC_SPECIAL_TERMS - 2; k >= 0; --k)
    sum = tc_madd(sum, v, c[k]);
  return sum;
}

/* Of segments deeper than ½ whose extinction times length changes by b: the table's rows, Mills' where it rises and
 * Dawson's where it falls, and the root of what there is of b. */
typedef struct TcThick {
  TcVec first, rows, r;
} TcThick;
TC_INLINE TcThick tc_thick(TcVec b) {
  const TcVec zero = tc_set(0);
  const TcMask rises = tc_le(zero, b);
  return (TcThick){tc_select(rises, zero, tc_set(TC_MILLS_ROWS)),
                   tc_select(rises, tc_set(TC_MILLS_ROWS), tc_set(TC_DAWSON_ROWS)),
                   tc_sqrt(tc_select(rises, b, -8 * b))};
}

/* T > ½, as psi() of segment.c does it. */
TC_INLINE TcSegments tc_segments_thick(TcVec a, TcVec a1) {
  const TcVec most = tc_set((TcReal)(TC_SINGLE ? 1e37 : 1e300));
  a = tc_min(a, most);
  a1 = tc_min(a1, most);
  const TcThick thick = tc_thick(a1 - a);
  const TcVec first = thick.first, rows = thick.rows, r = thick.r, near = 1 / (r + a), far = 1 / (r + a1);
  const TcVec e = tc_exp((TcReal)-0.5 * a - (TcReal)0.5 * a1);
  const TcVec psi = tc_special(first, rows, r * near) * near - e * (tc_special(first, rows, r * far) * far);
  return (TcSegments){1 - e, 1 - psi, psi - e};
}

#if TC_HAVE_COMPRESS
/* The same, with the same bits, for `thick` lanes that are at most half of all: their near ends and their far ends
 * share vectors, so that roots, reciprocals and the table's values are found once. Other lanes stay as they are. */
TC_INLINE void tc_segments_few_thick(TcMask thick, TcVec a, TcVec a1, TcSegments *segments) {
  const TcVec most = tc_set((TcReal)(TC_SINGLE ? 1e37 : 1e300));
  const int count = __builtin_popcount(tc_bits(thick));
  const TcMask used = tc_mask_of((1U << 2 * count) - 1), second = tc_mask_of(((1U << count) - 1) << count);
  a = tc_compress(thick, tc_min(a, most));
  a1 = tc_compress(thick, tc_min(a1, most));
  const TcThick both = tc_thick(tc_expand(second, a1 - a, a1 - a));
  const TcVec end = tc_select(used, tc_expand(second, a1, a), tc_set(1)), inverse = 1 / (both.r + end),
              value = tc_special(both.first, both.rows, both.r * inverse) * inverse,
              e = tc_exp((TcReal)-0.5 * a - (TcReal)0.5 * a1);
  const TcVec psi = value - e * tc_compress(second, value);
  segments->alpha = tc_expand(thick, 1 - e, segments->alpha);
  segments->w0 = tc_expand(thick, 1 - psi, segments->w0);
  segments->w1 = tc_expand(thick, psi - e, segments->w1);
}
#endif

/* tc_segments() where a depth is above ¼ (single precision: ½). */
TC_NOINLINE void tc_segments_deep(TcMask mask, const TcVec *near, const TcVec *far, TcSegments *result) {
  const TcVec a = *near, a1 = *far, t = (TcReal)0.5 * a + (TcReal)0.5 * a1, one = tc_set(1);
  const TcMask thick = tc_and(mask, tc_gt(t, tc_set((TcReal)0.5))), others = tc_and_not(mask, thick);
  TcSegments segments = {tc_set(0), tc_set(0), tc_set(0)};
  if (tc_any(others))
    segments = tc_segments_half(t, (TcReal)0.5 * a1 - (TcReal)0.5 * a);
#if TC_HAVE_COMPRESS
  if (2 * __builtin_popcount(tc_bits(thick)) <= TC_LANES) {
    if (tc_any(thick))
      tc_segments_few_thick(thick, a, a1, &segments);
    *result = segments;
    return;
  }
#endif
  if (tc_any(thick)) {
    const TcSegments deep = tc_segments_thick(tc_select(thick, a, one), tc_select(thick, a1, one));
    segments.alpha = tc_select(thick, deep.alpha, segments.alpha);
    segments.w0 = tc_select(thick, deep.w0, segments.w0);
    segments.w1 = tc_select(thick, deep.w1, segments.w1);
  }
  *result = segments;
}

/* Any a, a1 ≥ 0 in the lanes of `mask`, 0 in the others; t = (a + a1)/2, d = (a1 − a)/2. If all depths are up to
 * `thin`, by tc_segments_thin(), else with relative errors of w0 and w1 below 8e-15 (single precision: 72 · 2⁻²⁴): the
 * most, where Ψ is taken from Mills' ratios of 2, at T = ½. */
TC_INLINE TcSegments tc_segments(TcMask mask, TcVec a, TcVec a1, TcVec t, TcVec d, TcReal thin) {
  TcSegments result;
#if TC_SINGLE
  (void)thin;
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-1F)))))
    return tc_segments_half(t, d);
#else
  if (TC_UNLIKELY(thin > 0) && !tc_any(tc_gt(t, tc_set(thin))))
    return tc_segments_thin(t, d);
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-4)))))
    return tc_segments_16th(t, d);
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-2)))))
    return tc_segments_4th(t, d);
#endif
  const TcVec near = a, far = a1; /* by memory: vectors as arguments would be passed there anyway */
  tc_segments_deep(mask, &near, &far, &result);
  return result;
}

#if !TC_SINGLE
/* ── moments (segment.h) ── */

typedef struct TcLaneMoments {
  TcVec m0, m1, transmittance;
} TcLaneMoments;

/* As a m₀ + a₁ m₁ = 1 − e^−t and m₀ − m₁ = t (1 + g) Q, with g = e^(−t/2) − 1, both moments follow from one polynomial
 * beside g: with s = (1 − e^−t) / 2t = −g (2 + g) / 2t and r = (1 + g) Q / 2
 *
 *     m₀ = s + a₁ r,   m₁ = s − a r.
 *
 * Up to t = 1, s is at most 1.8 times m₁, where it is that at a = 2, a₁ = 0. */
#define TC_FIT_MOMENTS(name, FIT)                                                                                      \
  TC_FIT(tc_q_##name, TC_FIT_Q_##FIT)                                                                                  \
  TC_INLINE TcLaneMoments tc_moments_##name(TcVec t, TcVec d, TcVec a, TcVec a1) {                                     \
    const TcVec slope = tc_g_##name##_slope(0.5 * t), g = 0.5 * t * slope;                                             \
    const TcVec half = tc_madd(tc_set(0.5), g, tc_set(0.5)), r = half * tc_q_##name(t * t, d);                         \
    const TcVec s = -0.5 * slope * (half + 0.5);                                                                       \
    return (TcLaneMoments){tc_madd(a1, r, s), tc_madd(-a, r, s), tc_madd(g, g, 2 * g) + 1};                            \
  }
TC_FIT_MOMENTS(16th, 16TH)
TC_FIT_MOMENTS(4th, 4TH)
TC_FIT_G(tc_g_one, TC_FIT_G_ONE)
TC_FIT_MOMENTS(one, ONE)

/* T > 1, as deep_moments() of segment.c. */
TC_INLINE TcLaneMoments tc_moments_thick(TcVec a, TcVec a1) {
  const TcVec zero = tc_set(0), skip = tc_set(TC_SPECIAL_ROWS);
  const TcThick thick = tc_thick(a1 - a);
  const TcVec first = thick.first, rows = thick.rows, r = thick.r, near = 1 / (r + a), far = 1 / (r + a1),
              e = tc_exp(-0.5 * a - 0.5 * a1);
  const TcVec f = tc_special(first, rows, r * near) * near, g = tc_special(first + skip, rows, r * near) * near * near;
  const TcMask seen = tc_gt(e, zero); /* `far` may be infinite where nothing is seen of it */
  const TcVec f1 = tc_special(first, rows, r * far) * far, g1 = tc_special(first + skip, rows, r * far) * far * far;
  return (TcLaneMoments){tc_select(seen, tc_madd(e, g1, f - g), f - g), tc_select(seen, tc_madd(-e, f1 + g1, g), g), e};
}

TC_NOINLINE void tc_moments_deep(TcMask mask, const TcVec *near, const TcVec *far, TcLaneMoments *result) {
  const TcVec one = tc_set(1), a = *near, a1 = *far, t = 0.5 * a + 0.5 * a1;
  const TcMask thick = tc_and(mask, tc_gt(t, one)), others = tc_and_not(mask, thick);
  TcLaneMoments m = {tc_set(0.5), tc_set(0.5), one};
  if (tc_any(others)) {
    const TcVec zero = tc_set(0), near_end = tc_select(thick, zero, a), far_end = tc_select(thick, zero, a1);
    m = tc_moments_one(0.5 * near_end + 0.5 * far_end, 0.5 * far_end - 0.5 * near_end, near_end, far_end);
  }
  if (tc_any(thick)) {
    const TcLaneMoments deep = tc_moments_thick(tc_select(thick, a, one), tc_select(thick, a1, one));
    m.m0 = tc_select(thick, deep.m0, m.m0);
    m.m1 = tc_select(thick, deep.m1, m.m1);
    m.transmittance = tc_select(thick, deep.transmittance, m.transmittance);
  }
  *result = m;
}

/* tc_segment_moments() in the lanes of `mask`; a, a1 from 0 to TC_LARGEST_DENSITY, 0 in others. Relative errors of m0
 * and m1 are below 5e-15. */
TC_INLINE TcLaneMoments tc_moments(TcMask mask, TcVec a, TcVec a1) {
  const TcVec t = 0.5 * a + 0.5 * a1, d = 0.5 * a1 - 0.5 * a;
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-4)))))
    return tc_moments_16th(t, d, a, a1);
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-2)))))
    return tc_moments_4th(t, d, a, a1);
  const TcVec near = a, far = a1;
  TcLaneMoments result;
  tc_moments_deep(mask, &near, &far, &result);
  return result;
}
#endif

#if !TC_SINGLE
/* ── the same where light falls on segments (gather/lit.h) ── */

/* Weights, and ∫₀¹ u (1 − u) τ'(u) e^−τ(u) du = m₀ − m₁ ≤ alpha / 4. */
typedef struct TcLitSegments {
  TcVec w0, w1, middle;
} TcLitSegments;

/* As m₀ ∓ m₁ = ½ (1 + g) (p ± q) with fitted q, m₀ − m₁ is a product: its relative error is that of q, below 1e-15. */
#define TC_FIT_LIT(name)                                                                                               \
  TC_INLINE TcLitSegments tc_segments_lit_##name(TcVec t, TcVec d) {                                                   \
    const TcVec x = t * t, g = tc_g_##name(0.5 * t), q = t * tc_q_##name(x, d);                                        \
    const TcSegments segments = tc_segments_fitted(g, tc_k_##name(x, d));                                              \
    return (TcLitSegments){segments.w0, segments.w1, tc_madd(g, q, q)};                                                \
  }
TC_FIT_LIT(16th)
TC_FIT_LIT(4th)

TC_NOINLINE void tc_segments_lit_deep(TcMask mask, const TcVec *near, const TcVec *far, TcLitSegments *result) {
  TcSegments segments;
  TcLaneMoments moments;
  const TcVec most = tc_set(1e300), a = tc_min(*near, most), a1 = tc_min(*far, most);
  tc_segments_deep(mask, &a, &a1, &segments);
  tc_moments_deep(mask, &a, &a1, &moments);
  *result = (TcLitSegments){segments.w0, segments.w1, moments.m0 - moments.m1};
}

/* Any a, a1 ≥ 0 in the lanes of `mask`, 0 in the others; t and d as for tc_segments(). Where a depth is above ¼ the
 * difference of the moments, which are below ½, adds an error of 5e-15 at most, where alpha is above 0.22. */
TC_INLINE TcLitSegments tc_segments_lit(TcMask mask, TcVec a, TcVec a1, TcVec t, TcVec d) {
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-4)))))
    return tc_segments_lit_16th(t, d);
  if (TC_LIKELY(!tc_any(tc_gt(t, tc_set(0x1p-2)))))
    return tc_segments_lit_4th(t, d);
  const TcVec near = a, far = a1;
  TcLitSegments result;
  tc_segments_lit_deep(mask, &near, &far, &result);
  return result;
}
#endif

/* The opacity of segments of constant extinction, t their depths. */
TC_INLINE TcVec tc_segments_opacity(TcVec t) {
  const TcVec g = tc_g_half((TcReal)0.5 * tc_min(t, tc_set((TcReal)0.5))), alpha = -g * (2 + g);
  const TcMask deep = tc_gt(t, tc_set((TcReal)0.5));
  return TC_LIKELY(!tc_any(deep)) ? alpha : tc_select(deep, 1 - tc_exp(-t), alpha);
}

#endif
