/* SPDX-License-Identifier: Apache-2.0 */
/* The emission–absorption integral over one segment on which extinction and colour are linear. */
#ifndef TC_OPTICS_SEGMENT_H
#define TC_OPTICS_SEGMENT_H

/* With a = κ₀h and a1 = κ₁h, τ(u) = a u + (a1 − a) u²/2 and T = τ(1) = (a + a1)/2, the light that leaves the segment is
 *
 *     C = ∫₀¹ c(u) τ'(u) e^−τ(u) du = c₀ w₀ + c₁ w₁,     w₀ = 1 − Ψ,  w₁ = Ψ − e^−T,  Ψ = ∫₀¹ e^−τ(u) du
 *
 * (Williams & Max, A volume density optical model, 1992; Ψ as in Moreland & Angel, A fast high accuracy volume renderer
 * for unstructured data, 2004). Both weights are integrals of something ≥ 0 and are computed without cancellation; they
 * sum to the opacity 1 − e^−T. */
typedef struct TcSegment {
  double w0, w1;        /* weights of the colour at the near and the far end, ≥ 0 */
  double alpha;         /* 1 − e^−T */
  double transmittance; /* e^−T */
  double depth;         /* T */
} TcSegment;

/* a, a1 ≥ 0, not NaN; values above 1e300 count as 1e300. Relative errors of w0, w1 and alpha are below 4e-15. */
TcSegment tc_segment(double a, double a1);

/* The same for T ≤ 1/2 by short polynomials. The errors of weights, alpha and transmittance add up to less than T⁵/120,
 * which is less than alpha T⁴/90. */
TcSegment tc_segment_thin(double a, double a1);

/* The same for a = a1 = depth, where Ψ isn't needed. */
TcSegment tc_segment_constant(double depth);

/* If an emission j per length is given apart from the extinction, and is linear on the segment as well, the light that
 * leaves the segment is
 *
 *     h ∫₀¹ ((1 − u) j₀ + u j₁) e^−τ(u) du = h (j₀ m₀ + j₁ m₁),     m₀ + m₁ = Ψ,  a m₀ + a1 m₁ = 1 − e^−T
 *
 * Without extinction m₀ = m₁ = ½, exactly. Both are integrals of something ≥ 0 and are computed without cancellation.
 */
typedef struct TcMoments {
  double m0, m1;        /* in [0, ½]; moments below 1e-307 may be denormal or 0 */
  double transmittance; /* e^−T */
  double depth;         /* T */
} TcMoments;

/* The largest a of tc_segment_moments(). Nothing that is computed from two such values overflows. */
#define TC_LARGEST_DENSITY 0x1p1019

/* a, a1 ≥ 0, not NaN; values above TC_LARGEST_DENSITY count as that. Relative errors of m0 and m1 are below 5e-15. */
TcMoments tc_segment_moments(double a, double a1);

/* Tables of Mills' ratio and of Dawson's integral, for Ψ, then of the negatives of their derivatives, for the moments
 * (segment.c, make_special.py). */
enum {
  TC_MILLS_ROWS = 64,
  TC_DAWSON_ROWS = 192,
  TC_SPECIAL_ROWS = TC_MILLS_ROWS + TC_DAWSON_ROWS,
  TC_SPECIAL_TERMS = 8
};
extern const double tc_special_f64[2 * TC_SPECIAL_ROWS][TC_SPECIAL_TERMS];
extern const float tc_special_f32[2 * TC_SPECIAL_ROWS][TC_SPECIAL_TERMS];

#endif
