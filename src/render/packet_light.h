/* SPDX-License-Identifier: Apache-2.0 */
/* light.c for a packet of rays: the light of each lane, composited in blocks of 64 steps. */
#ifndef TC_RENDER_PACKET_LIGHT_H
#define TC_RENDER_PACKET_LIGHT_H

#include "optics/segment_simd.h"
#include "optics/transfer.h"

typedef struct TcLights {
  TcVec color[3], depth, transmittance;                   /* of the finished blocks */
  TcVec block_color[3], block_depth, block_transmittance; /* of the block under way */
  int64_t piece;                                          /* where the last segment was */
} TcLights;

TC_INLINE void tc_lights_begin(TcLights *lights) {
  memset(lights, 0, sizeof *lights);
  lights->transmittance = lights->block_transmittance = tc_set(1);
}

TC_INLINE void tc_lights_end_block(TcLights *lights) {
  for (int k = 0; k < 3; ++k) {
    lights->color[k] = tc_madd(lights->transmittance, lights->block_color[k], lights->color[k]);
    lights->block_color[k] = tc_set(0);
  }
  lights->depth += lights->block_depth;
  lights->transmittance = tc_exp(-lights->depth);
  lights->block_depth = tc_set(0);
  lights->block_transmittance = tc_set(1);
}

/* Lanes not in `mask` have length 0 and finite scalars: nothing happens in them. */
TC_INLINE void tc_lights_add_part(TcLights *lights, const TcPiece *piece, double thin, TcMask mask, TcVec length, TcVec s0, TcVec s1) {
  TcVec low, high, depth; /* weights of the piece's colours at its two ends */
  TcSegments segments;
  if (piece->constant) {
    if (piece->at_low.extinction == 0) return;
    depth = piece->at_low.extinction * length;
    segments = tc_segments_constant(mask, depth);
    low = lights->block_transmittance * segments.w0;
    high = tc_set(0);
  } else {
    const TcVec near_high = (s0 - piece->low) * piece->inverse, near_low = (piece->high - s0) * piece->inverse;
    const TcVec far_high = (s1 - piece->low) * piece->inverse, far_low = (piece->high - s1) * piece->inverse;
    const double k0 = piece->at_low.extinction, k1 = piece->at_high.extinction;
    const TcVec a = tc_madd(near_high, tc_set(k1), near_low * k0) * length, a1 = tc_madd(far_high, tc_set(k1), far_low * k0) * length;
    depth = 0.5 * a + 0.5 * a1;
    segments = tc_segments(mask, a, a1, depth, thin);
    const TcVec w0 = lights->block_transmittance * segments.w0, w1 = lights->block_transmittance * segments.w1;
    low = tc_madd(near_low, w0, far_low * w1);
    high = tc_madd(near_high, w0, far_high * w1);
  }
  for (int k = 0; k < 3; ++k) {
    lights->block_color[k] = tc_madd(low, tc_set(piece->at_low.color[k]), lights->block_color[k]);
    lights->block_color[k] = tc_madd(high, tc_set(piece->at_high.color[k]), lights->block_color[k]);
  }
  lights->block_transmittance *= segments.transmittance;
  lights->block_depth += depth;
}

/* Segments that lie in several pieces, part by part: each turn takes the piece where the first lane is, with all lanes that are there. */
static __attribute__((noinline)) void tc_lights_split(TcLights *lights, const TcPieces *pieces, double thin, TcMask pending,
                                                      const TcVec *whole_length, const TcVec *from, const TcVec *to) {
  const TcVec zero = tc_set(0), length = *whole_length, s1 = *to, whole = tc_abs(s1 - *from);
  const TcMask rising = tc_le(*from, s1);
  TcVec s0 = *from;
  do {
    const int lane = __builtin_ctz(tc_bits(pending));
    lights->piece = s0[lane] <= s1[lane] ? tc_piece_above(pieces, s0[lane]) : tc_piece_below(pieces, s0[lane]);
    const TcPiece *piece = &pieces->pieces[lights->piece];
    const TcVec low = tc_set(piece->low), high = tc_set(piece->high);
    TcMask here = tc_or(tc_and(rising, tc_and(tc_le(low, s0), tc_lt(s0, high))),
                        tc_and_not(tc_and(tc_lt(low, s0), tc_le(s0, high)), rising));
    here = tc_and(here, pending);
    const TcVec end = tc_select(rising, tc_min(s1, high), tc_max(s1, low));
    const TcVec part = tc_select(tc_eq(whole, zero), length, length * (tc_abs(end - s0) / whole));
    const TcVec safe = tc_set(isfinite(piece->low) ? piece->low : isfinite(piece->high) ? piece->high : 0);
    tc_lights_add_part(lights, piece, thin, here, tc_select(here, part, zero), tc_select(here, s0, safe), tc_select(here, end, safe));
    s0 = tc_select(here, end, s0);
    pending = tc_and_not(pending, tc_and(here, tc_eq(s0, s1)));
  } while (tc_any(pending));
}

/* tc_light_add() in the lanes of `mask`. */
TC_INLINE void tc_lights_add(TcLights *lights, const TcPieces *pieces, double thin, TcMask mask, TcVec length, TcVec s0, TcVec s1) {
  const TcPiece *piece = &pieces->pieces[lights->piece];
  const TcVec low = tc_set(piece->low), high = tc_set(piece->high), least = tc_min(s0, s1), most = tc_max(s0, s1);
  const TcMask here = tc_and(mask, tc_and(tc_and(tc_le(low, least), tc_lt(least, high)), tc_le(most, high)));
  if (tc_bits(here) == tc_bits(mask)) {
    if (piece->constant && piece->at_low.extinction == 0) return;
    const TcVec zero = tc_set(0), inside = piece->constant ? zero : low;
    tc_lights_add_part(lights, piece, thin, mask, tc_select(mask, length, zero), tc_select(mask, s0, inside),
                       tc_select(mask, s1, inside));
    return;
  }
  TcLights copy = *lights;
  const TcVec arguments[3] = {length, s0, s1};
  tc_lights_split(&copy, pieces, thin, mask, &arguments[0], &arguments[1], &arguments[2]);
  *lights = copy;
}

/* tc_light_opaque(): the lanes that are complete. */
TC_INLINE TcMask tc_lights_opaque(const TcLights *lights, const TcPieces *pieces, double opaque, TcMask active) {
  const TcVec depth = lights->depth + lights->block_depth;
  if (!tc_any(tc_and(active, tc_gt(depth, tc_set(opaque < TC_NEARLY_OPAQUE ? opaque : TC_NEARLY_OPAQUE))))) return tc_mask_of(0);
  const TcVec left = lights->transmittance * lights->block_transmittance;
  TcMask done = tc_gt(depth, tc_set(TC_NEARLY_OPAQUE));
  for (int k = 0; k < 3; ++k) {
    const TcVec color = tc_madd(lights->transmittance, lights->block_color[k], lights->color[k]);
    done = tc_and(done, tc_le(left * pieces->largest[k], 0x1p-54 * color));
  }
  return tc_and(active, tc_or(done, tc_gt(depth, tc_set(opaque))));
}

#endif
