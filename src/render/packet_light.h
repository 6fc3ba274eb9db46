/* SPDX-License-Identifier: Apache-2.0 */
/* light.c for a packet of rays: the light of each lane, composited in blocks of 64 steps.
 *
 * `colored`, a constant wherever these functions are used: whether colours differ. If they don't, colour is that one colour times opacity,
 * and what is gathered is the optical depth alone: an integral of a function linear in pieces. */
#ifndef TC_RENDER_PACKET_LIGHT_H
#define TC_RENDER_PACKET_LIGHT_H

#include <stddef.h>

#include "optics/segment_simd.h"
#include "optics/transfer.h"

typedef struct TcLights {
  TcVec color[3], depth, transmittance;                   /* of the finished blocks */
  TcVec block_color[3], block_depth, block_transmittance; /* of the block under way */
  TcVec alpha;                                            /* at the end */
} TcLights;

TC_INLINE void tc_lights_begin(TcLights *lights) {
  memset(lights, 0, sizeof *lights);
  lights->transmittance = lights->block_transmittance = tc_set(1);
}

TC_INLINE void tc_lights_end_block(const bool colored, TcLights *lights) {
  if (!colored) {
    lights->depth += lights->block_depth;
    lights->block_depth = tc_set(0);
    return;
  }
  for (int k = 0; k < 3; ++k) {
    lights->color[k] = tc_madd(lights->transmittance, lights->block_color[k], lights->color[k]);
    lights->block_color[k] = tc_set(0);
  }
  lights->depth += lights->block_depth;
  lights->transmittance = tc_exp(-lights->depth);
  lights->block_depth = tc_set(0);
  lights->block_transmittance = tc_set(1);
}

/* A lane's piece each, as TcPieces.rows has it. */
typedef struct TcLanePieces {
  TcVec low, high, from, to, inverse, constant, k0, k1, color0[3], color1[3], above, below;
} TcLanePieces;

/* Where lanes are within their segments. Kept from packet to packet. */
typedef struct TcParts {
  TcLanePieces piece;     /* each lane's own */
  TcVec at;               /* its number */
  TcVec length, s0, done; /* of the segment; the scalar up to which it has been added */
  TcMask pending;         /* lanes with more of it to add */
  TcMask filled;          /* lanes whose pieces have any extinction */
} TcParts;

/* Segments with these weights of the pieces' colours at their two ends. */
TC_INLINE void tc_lights_composite(TcLights *lights, const TcLanePieces *piece, TcVec low, TcVec high, TcVec depth, TcVec transmittance) {
  for (int k = 0; k < 3; ++k) {
    lights->block_color[k] = tc_madd(high, piece->color1[k], tc_madd(low, piece->color0[k], lights->block_color[k]));
  }
  lights->block_transmittance *= transmittance;
  lights->block_depth += depth;
}

/* Parts of segments, a lane each within its piece; of length 0 where nothing is to happen. */
TC_INLINE void tc_lights_add_parts(const bool colored, TcLights *lights, const TcLanePieces *piece, double thin, TcMask here, TcVec length,
                                   TcVec s0, TcVec s1) {
  const TcVec near_high = (s0 - piece->from) * piece->inverse, near_low = tc_madd(piece->to - s0, piece->inverse, piece->constant);
  const TcVec far_high = (s1 - piece->from) * piece->inverse, far_low = tc_madd(piece->to - s1, piece->inverse, piece->constant);
  const TcVec a = tc_madd(near_high, piece->k1, near_low * piece->k0) * length, a1 = tc_madd(far_high, piece->k1, far_low * piece->k0) * length;
  const TcVec depth = 0.5 * a + 0.5 * a1;
  if (!colored) {
    lights->block_depth += depth;
    return;
  }
  const TcSegments segments = tc_segments(here, a, a1, depth, thin);
  const TcVec w0 = lights->block_transmittance * segments.w0, w1 = lights->block_transmittance * segments.w1;
  tc_lights_composite(lights, piece, tc_madd(near_low, w0, far_low * w1), tc_madd(near_high, w0, far_high * w1), depth,
                      segments.transmittance);
}

TC_INLINE void tc_load_pieces(const TcPieces *pieces, TcParts *parts) {
  _Static_assert(sizeof parts->piece == TC_PIECE_WORDS * sizeof(TcVec), "loaded as records of four");
  TcVec word[TC_PIECE_WORDS], whole;
  tc_load_records(pieces->rows[0], tc_nearest(parts->at * TC_PIECE_WORDS, &whole), TC_PIECE_WORDS / 4, word);
  memcpy(&parts->piece, word, sizeof parts->piece);
  parts->filled = tc_or(tc_lt(tc_set(0), parts->piece.k0), tc_lt(tc_set(0), parts->piece.k1));
}

/* The lanes of `mask` find the pieces where they are, at a knot the later: from there a lane whose values fall goes on to the one before at once. */
static __attribute__((noinline)) void tc_parts_locate(const TcPieces *pieces, TcMask mask, TcParts *parts) {
  const TcVec zero = tc_set(0), one = tc_set(1);
  TcVec at = zero;
  if (pieces->count <= 32) {
    for (int64_t i = 0; i < pieces->count; ++i) at += tc_select(tc_le(tc_set(pieces->knots[i]), parts->done), one, zero);
  } else {
    for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      at[i] = (double)tc_piece_above(pieces, parts->done[i]);
    }
  }
  parts->at = tc_select(mask, at, parts->at);
  tc_load_pieces(pieces, parts);
}

/* The lanes whose segments go on beyond their pieces. part: length and end of the segments, which become those of their parts within the pieces. */
TC_INLINE TcMask tc_parts_limit(const TcPieces *pieces, TcMask mask, TcParts *parts, TcVec part[2]) {
  const TcLanePieces *piece = &parts->piece;
  const TcVec done = parts->done, s1 = part[1], whole = tc_abs(s1 - parts->s0);
  const TcMask up = tc_le(parts->s0, s1);
  const TcMask rising = tc_and(up, tc_and(tc_le(piece->low, done), tc_lt(done, piece->high)));
  const TcMask falling = tc_and_not(tc_and(tc_lt(piece->low, done), tc_le(done, piece->high)), up);
  const TcMask misplaced = tc_and_not(mask, tc_or(rising, falling));
  if (tc_any(misplaced)) tc_parts_locate(pieces, misplaced, parts);
  const TcMask crossing = tc_and(mask, tc_or(tc_and(up, tc_lt(piece->high, s1)), tc_and_not(tc_lt(s1, piece->low), up)));
  part[1] = tc_select(crossing, tc_select(up, piece->high, piece->low), s1);
  /* From differences of scalars, not of positions along the segment: nothing cancels. */
  part[0] = parts->length * tc_select(tc_eq(whole, tc_set(0)), tc_set(1), tc_abs(part[1] - done) / whole);
  return crossing;
}

/* The lanes of `crossing` come to the next piece, and are pending if there is something to add of what is left of their segments, up to s1. */
static __attribute__((noinline)) void tc_parts_next(const TcPieces *pieces, TcMask crossing, const TcVec *end, TcParts *parts) {
  const TcVec s1 = *end;
  const TcMask up = tc_le(parts->s0, s1);
  const TcVec next = tc_select(up, parts->piece.above, parts->piece.below);
  const TcMask valid = tc_and(crossing, tc_and(tc_le(tc_set(0), next), tc_le(next, tc_set((double)pieces->count))));
  parts->at = tc_select(valid, next, parts->at);
  tc_load_pieces(pieces, parts);
  const TcLanePieces *piece = &parts->piece;
  const TcMask reached = tc_or(tc_and(up, tc_lt(piece->low, s1)), tc_and_not(tc_lt(s1, piece->high), up));
  const TcMask further = tc_or(tc_and(up, tc_lt(piece->high, s1)), tc_and_not(tc_lt(s1, piece->low), up));
  parts->pending = tc_and(tc_and(valid, reached), tc_or(parts->filled, further));
  parts->done = tc_select(parts->pending, tc_select(up, piece->low, piece->high), parts->done);
}

/* tc_light_add() in the lanes of `mask`: the part of their segments, which end with the value s1, that lies in one piece. Lanes that meet a knot
 * are pending then, while others go on: most knots are met by few lanes of a packet at a time. */
TC_INLINE void tc_lights_add(const bool colored, TcLights *lights, TcParts *parts, const TcPieces *pieces, double thin, TcMask mask, TcVec s1) {
  const TcLanePieces *piece = &parts->piece;
  const TcVec least = tc_min(parts->done, s1), most = tc_max(parts->done, s1);
  const TcMask here = tc_and(tc_and(tc_le(piece->low, least), tc_lt(least, piece->high)), tc_le(most, piece->high));
  TcVec part[2] = {parts->length, s1};
  TcMask crossing = tc_mask_of(0);
  if (tc_any(tc_or(tc_and_not(mask, here), parts->pending))) crossing = tc_parts_limit(pieces, mask, parts, part);
  if (tc_any(tc_and(mask, parts->filled))) {
    tc_lights_add_parts(colored, lights, piece, thin, mask, tc_select(mask, part[0], tc_set(0)), tc_select(mask, parts->done, piece->from),
                        tc_select(mask, part[1], piece->from));
  }
  parts->pending = tc_mask_of(0);
  if (tc_any(crossing)) tc_parts_next(pieces, crossing, &s1, parts);
}

/* tc_light_add_constant() in the lanes of `mask`. */
TC_INLINE void tc_lights_add_constant(const bool colored, TcLights *lights, TcParts *parts, const TcPieces *pieces, TcMask mask, TcVec length,
                                      TcVec s) {
  const TcLanePieces *piece = &parts->piece;
  const TcMask here = tc_and(tc_le(piece->low, s), tc_lt(s, piece->high));
  if (tc_any(tc_and_not(mask, here))) {
    parts->done = s;
    tc_parts_locate(pieces, mask, parts);
  }
  if (!tc_any(tc_and(mask, parts->filled))) return;
  s = tc_select(mask, s, piece->from);
  const TcVec high = (s - piece->from) * piece->inverse, low = tc_madd(piece->to - s, piece->inverse, piece->constant);
  const TcVec depth = tc_madd(high, piece->k1, low * piece->k0) * tc_select(mask, length, tc_set(0));
  if (!colored) {
    lights->block_depth += depth;
    return;
  }
  const TcSegments segments = tc_segments_constant(mask, depth);
  const TcVec weight = lights->block_transmittance * segments.w0;
  tc_lights_composite(lights, piece, low * weight, high * weight, depth, segments.transmittance);
}

/* tc_light_opaque(): the lanes that are complete. */
TC_INLINE TcMask tc_lights_opaque(const bool colored, const TcLights *lights, const TcPieces *pieces, double opaque, TcMask active) {
  const TcVec depth = lights->depth + lights->block_depth;
  const TcMask near = tc_and(active, tc_gt(depth, tc_set(opaque < TC_NEARLY_OPAQUE ? opaque : TC_NEARLY_OPAQUE)));
  if (!colored || !tc_any(near)) return near;
  const TcVec left = lights->transmittance * lights->block_transmittance;
  TcMask done = tc_gt(depth, tc_set(TC_NEARLY_OPAQUE));
  for (int k = 0; k < 3; ++k) {
    const TcVec color = tc_madd(lights->transmittance, lights->block_color[k], lights->color[k]);
    done = tc_and(done, tc_le(left * pieces->largest[k], 0x1p-54 * color));
  }
  return tc_and(active, tc_or(done, tc_gt(depth, tc_set(opaque))));
}

#endif
