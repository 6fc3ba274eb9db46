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
  int64_t piece;                                          /* where the last segment was */
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

/* A lane's piece each, as it lies in TcPiece. */
typedef struct TcLanePieces {
  TcVec low, high, k0, color0[3], k1, color1[3], inverse, rest;
} TcLanePieces;

/* Segments with these weights of the pieces' colours at their two ends. */
TC_INLINE void tc_lights_composite(TcLights *lights, const TcLanePieces *piece, TcVec low, TcVec high, TcVec depth, TcVec transmittance) {
  for (int k = 0; k < 3; ++k) {
    lights->block_color[k] = tc_madd(high, piece->color1[k], tc_madd(low, piece->color0[k], lights->block_color[k]));
  }
  lights->block_transmittance *= transmittance;
  lights->block_depth += depth;
}

/* Parts of a segment, a lane each; of length 0 in lanes not in `here`. `any_constant`, a constant wherever this is used: whether pieces may be
 * constant. */
TC_INLINE void tc_lights_add_parts(const bool colored, TcLights *lights, const TcLanePieces *piece, const bool any_constant, double thin,
                                   TcMask here, TcVec length, TcVec s0, TcVec s1) {
  TcVec near_high = (s0 - piece->low) * piece->inverse, near_low = (piece->high - s0) * piece->inverse;
  TcVec far_high = (s1 - piece->low) * piece->inverse, far_low = (piece->high - s1) * piece->inverse;
  if (any_constant) {
    const TcVec zero = tc_set(0), one = tc_set(1);
    const TcMask constant = tc_eq(piece->inverse, zero);
    near_high = tc_select(constant, zero, near_high);
    near_low = tc_select(constant, one, near_low);
    far_high = tc_select(constant, zero, far_high);
    far_low = tc_select(constant, one, far_low);
  }
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

TC_INLINE TcLanePieces tc_set_pieces(const TcPiece *piece) {
  TcLanePieces all = {.low = tc_set(piece->low), .high = tc_set(piece->high), .inverse = tc_set(piece->inverse),
                      .k0 = tc_set(piece->at_low.extinction), .k1 = tc_set(piece->at_high.extinction)};
  for (int k = 0; k < 3; ++k) {
    all.color0[k] = tc_set(piece->at_low.color[k]);
    all.color1[k] = tc_set(piece->at_high.color[k]);
  }
  return all;
}

/* All in one piece. Lanes not in `mask` have length 0 and finite scalars: nothing happens in them. */
TC_INLINE void tc_lights_add_part(const bool colored, TcLights *lights, const TcPiece *piece, double thin, TcMask mask, TcVec length,
                                  TcVec s0, TcVec s1) {
  const TcLanePieces all = tc_set_pieces(piece);
  if (!piece->constant) {
    tc_lights_add_parts(colored, lights, &all, false, thin, mask, length, s0, s1);
    return;
  }
  const TcVec depth = all.k0 * length;
  if (!colored) {
    lights->block_depth += depth;
    return;
  }
  const TcSegments segments = tc_segments_constant(mask, depth);
  tc_lights_composite(lights, &all, lights->block_transmittance * segments.w0, tc_set(0), depth, segments.transmittance);
}

TC_INLINE TcLanePieces tc_load_pieces(const TcPieces *pieces, TcVec at) {
  enum { STRIDE = sizeof(TcPiece) / sizeof(double), WORDS = sizeof(TcLanePieces) / sizeof(TcVec) };
  _Static_assert(STRIDE >= WORDS && offsetof(TcPiece, inverse) == offsetof(TcLanePieces, inverse) / TC_LANES, "loaded as records of four");
  TcVec word[WORDS], whole;
  tc_load_records(&pieces->pieces->low, tc_nearest(at * STRIDE, &whole), WORDS / 4, word);
  TcLanePieces piece;
  memcpy(&piece, word, sizeof piece);
  return piece;
}

/* The pieces between which segments from `least` to `most` have extinction, and, from one of them, where `s` lies. Of many pieces, those
 * far from that are not looked at. */
TC_INLINE int64_t tc_find_pieces(const TcPieces *pieces, int64_t from, TcMask mask, TcVec least, TcVec most, double s, TcVec *first,
                                 TcVec *last) {
  const bool many = pieces->count > 32;
  int64_t i = many ? from : 0;
  while (i > 0 && tc_any(tc_and(mask, tc_lt(least, tc_set(pieces->knots[i - 1]))))) --i;
  int64_t at = i;
  *first = tc_set(pieces->pieces[i].filled_above);
  *last = tc_set(pieces->pieces[i].filled_below);
  for (; i < pieces->count; ++i) {
    const TcVec knot = tc_set(pieces->knots[i]);
    const TcMask reached = tc_le(knot, most);
    if (many && !tc_any(tc_and(mask, reached))) break;
    *first = tc_select(tc_le(knot, least), tc_set(pieces->pieces[i + 1].filled_above), *first);
    *last = tc_select(reached, tc_set(pieces->pieces[i + 1].filled_below), *last);
    at += pieces->knots[i] <= s;
  }
  return at;
}

/* Segments that lie in several pieces: lanes pass from piece to piece, each where it is, from the first to the last that has any extinction.
 * Where a segment begins or ends on a knot, the piece above may come in with a part of length 0. */
TC_INLINE void tc_lights_split(const bool colored, TcLights *lights, const TcPieces *pieces, double thin, TcMask mask,
                               const TcVec *whole_length, const TcVec *from, const TcVec *to) {
  const TcVec zero = tc_set(0), one = tc_set(1), length = *whole_length;
  const TcVec s0 = tc_select(mask, *from, zero), s1 = tc_select(mask, *to, zero), whole = tc_abs(s1 - s0);
  const TcMask rising = tc_le(s0, s1);
  TcVec first, last;
  const double s = s1[__builtin_ctz(tc_bits(mask))];
  lights->piece = tc_find_pieces(pieces, lights->piece, mask, tc_min(s0, s1), tc_max(s0, s1), s, &first, &last);
  TcMask pending = tc_and(mask, tc_le(first, last));
  const TcVec end = tc_select(rising, last, first), step = tc_select(rising, one, -one);
  TcVec at = tc_select(rising, first, last);
  while (tc_any(pending)) {
    at = tc_select(pending, at, zero);
    const TcLanePieces piece = tc_load_pieces(pieces, at);
    const TcVec near = tc_max(tc_min(s0, piece.high), piece.low), far = tc_max(tc_min(s1, piece.high), piece.low);
    const TcVec part = length * tc_select(tc_eq(whole, zero), one, tc_abs(far - near) / whole);
    tc_lights_add_parts(colored, lights, &piece, true, thin, pending, tc_select(pending, part, zero), near, far);
    pending = tc_and_not(pending, tc_eq(at, end));
    at += step;
  }
}

static __attribute__((noinline)) void tc_lights_split_colored(TcLights *lights, const TcPieces *pieces, double thin, TcMask mask,
                                                              const TcVec segment[3]) {
  tc_lights_split(true, lights, pieces, thin, mask, &segment[0], &segment[1], &segment[2]);
}

static __attribute__((noinline)) void tc_lights_split_depth(TcLights *lights, const TcPieces *pieces, TcMask mask, const TcVec segment[3]) {
  tc_lights_split(false, lights, pieces, 0, mask, &segment[0], &segment[1], &segment[2]);
}

/* tc_light_add() in the lanes of `mask`. */
TC_INLINE void tc_lights_add(const bool colored, TcLights *lights, const TcPieces *pieces, double thin, TcMask mask, TcVec length, TcVec s0,
                             TcVec s1) {
  const TcPiece *piece = &pieces->pieces[lights->piece];
  const TcVec low = tc_set(piece->low), high = tc_set(piece->high), least = tc_min(s0, s1), most = tc_max(s0, s1);
  const TcMask here = tc_and(mask, tc_and(tc_and(tc_le(low, least), tc_lt(least, high)), tc_le(most, high)));
  if (tc_bits(here) == tc_bits(mask)) {
    if (piece->at_low.extinction == 0 && piece->at_high.extinction == 0) return;
    const TcVec zero = tc_set(0), inside = piece->constant ? zero : low;
    tc_lights_add_part(colored, lights, piece, thin, mask, tc_select(mask, length, zero), tc_select(mask, s0, inside),
                       tc_select(mask, s1, inside));
    return;
  }
  const TcVec segment[3] = {length, s0, s1};
  if (colored) tc_lights_split_colored(lights, pieces, thin, mask, segment);
  else tc_lights_split_depth(lights, pieces, mask, segment);
}

/* tc_light_add_constant() in the lanes of `mask`. */
TC_INLINE void tc_lights_add_constant(const bool colored, TcLights *lights, const TcPieces *pieces, TcMask mask, TcVec length, TcVec s) {
  const TcVec zero = tc_set(0), one = tc_set(1);
  const TcPiece *same = &pieces->pieces[lights->piece];
  const TcMask here = tc_and(mask, tc_and(tc_le(tc_set(same->low), s), tc_lt(s, tc_set(same->high))));
  TcLanePieces piece;
  if (tc_bits(here) == tc_bits(mask)) {
    if (same->at_low.extinction == 0 && same->at_high.extinction == 0) return;
    piece = tc_set_pieces(same);
  } else {
    TcVec first, last;
    lights->piece = tc_find_pieces(pieces, lights->piece, mask, s, s, s[__builtin_ctz(tc_bits(mask))], &first, &last);
    mask = tc_and(mask, tc_le(first, last));
    if (!tc_any(mask)) return;
    piece = tc_load_pieces(pieces, tc_select(mask, first, zero));
  }
  const TcMask inside = tc_and_not(mask, tc_eq(piece.inverse, zero)); /* lanes in pieces that are not constant */
  const TcVec high = tc_select(inside, (s - piece.low) * piece.inverse, zero), low = tc_select(inside, (piece.high - s) * piece.inverse, one);
  const TcVec depth = tc_madd(high, piece.k1, low * piece.k0) * tc_select(mask, length, zero);
  if (!colored) {
    lights->block_depth += depth;
    return;
  }
  const TcSegments segments = tc_segments_constant(mask, depth);
  const TcVec weight = lights->block_transmittance * segments.w0;
  tc_lights_composite(lights, &piece, low * weight, high * weight, depth, segments.transmittance);
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
