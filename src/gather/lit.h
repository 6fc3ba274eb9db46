/* SPDX-License-Identifier: Apache-2.0 */
/* Light in the volume, in lanes: a factor L of the colour and a highlight H that is added, both linear in a cell. With
 * the colour c, linear in a part of a segment, what leaves the part is
 *
 *     ∫₀¹ (c(u) L(u) + H(u)) τ'(u) e^−τ(u) du = w₀ (c₀L₀ + H₀) + w₁ (c₁L₁ + H₁) − Δc ΔL m,   m = ∫₀¹ u (1 − u) τ' e^−τ
 * du,
 *
 * as cL = (1 − u) c₀L₀ + u c₁L₁ − u (1 − u) Δc ΔL. Integrated by parts, m = ∫₀¹ (1 − 2u) e^−τ du = m₀ − m₁, the moments
 * of segment.h. Where segments are thin it is computed without this difference (tc_segments_lit()).
 *
 * L and H are as exact as the vertices' are: interpolation adds 4 units of 2^−53 of the largest at the face, to which
 * rounding in the sum above adds as much as without light. */
#ifndef TC_GATHER_LIT_H
#define TC_GATHER_LIT_H

#include "gather/seam.h"
#include "optics/segment_lanes.h"

/* With TC_LIT: the light where lanes are; with TC_TINTED the factors of red, green, blue, then the highlights, else one
 * of each. */
typedef struct TcLit {
  TcVec at[TC_LIGHT_TINTED];
} TcLit;

/* The light at the two ends of a stretch. */
typedef struct TcLitEnds {
  TcLit near, far;
} TcLitEnds;

#define TC_LIGHT_WIDTH(on) ((on)&TC_TINTED ? TC_LIGHT_TINTED : TC_LIGHT_GRAY)

#if TC_SINGLE
#define tc_lit_face(on, lights, walk, lit) ((void)(lights), (void)(walk)) /* it has no light */
#else
/* The light where lanes are at a face. */
TC_INLINE void tc_lit_face(const unsigned on, const TcLights *lights, const TcPacket *walk, TcLit *lit) {
  enum { RECORD = 4 };
  const int width = TC_LIGHT_WIDTH(on), records = (width + RECORD - 1) / RECORD;
  if (on & TC_TINTED && !lights->at) {
    for (int j = 0; j < width; ++j)
      lit->at[j] = tc_set(j < width / 2 ? 1 : 0);
    return;
  }
  for (int r = 0; r < records; ++r) {
    TcVec v[3][RECORD];
    for (int k = 0; k < 3; ++k) {
      const double *at[TC_LANES];
      for (int l = 0; l < TC_LANES; ++l)
        at[l] = lights->at[TC_AT(walk->v[k].id, l) * (size_t)records + (size_t)r];
      tc_load_records(at, v[k]);
    }
    const TcVec *b = walk->at.barycentric;
    for (int j = 0; j < RECORD && RECORD * r + j < width; ++j)
      lit->at[RECORD * r + j] = tc_madd(b[0], v[0][j], tc_madd(b[1], v[1][j], b[2] * v[2][j]));
  }
}

#endif

/* The light at the fractions u0 and u1 of a stretch. Lanes in which nothing counts may have any there. */
TC_INLINE void tc_lit_between(const unsigned on, const TcLitEnds *whole, TcVec u0, TcVec u1, TcLitEnds *part) {
  u0 = tc_max(tc_min(u0, tc_set(1)), tc_set(0));
  u1 = tc_max(tc_min(u1, tc_set(1)), tc_set(0));
  for (int j = 0; j < TC_LIGHT_WIDTH(on); ++j) {
    const TcVec change = whole->far.at[j] - whole->near.at[j];
    part->near.at[j] = tc_madd(u0, change, whole->near.at[j]);
    part->far.at[j] = tc_madd(u1, change, whole->near.at[j]);
  }
}

#endif
