/* SPDX-License-Identifier: Apache-2.0 */
/* The pieces of a transfer function (transfer.h) in lanes, each lane in a piece of its own. */
#ifndef TC_GATHER_PIECES_H
#define TC_GATHER_PIECES_H

#include "base/lanes.h"
#include "optics/transfer.h"

typedef struct TcLanePieces {
  TcVec low, high, from, extinction, rise, color[3], color_rise[3], scale;
  TcInt at, above, below;    /* the piece's number, and the numbers of the next ones */
  TcMask filled;             /* the lanes whose pieces have any extinction */
  TcVec steep, beside, jump; /* used in double precision only */
} TcLanePieces;

#if TC_SINGLE
#define tc_piece_rows(pieces)    ((pieces)->rows_f32)
#define tc_piece_columns(pieces) ((pieces)->columns_f32)
#else
#define tc_piece_rows(pieces)    ((pieces)->rows_f64)
#define tc_piece_columns(pieces) ((pieces)->columns_f64)
#endif

/* Loads the words `first` to first + 3 of the lanes' pieces. */
TC_INLINE void tc_pieces_words(const TcPieces *pieces, TcInt at, int first, TcVec word[4]) {
  const TcReal *from[TC_LANES];
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) from[l] = &tc_piece_rows(pieces)[TC_AT(at, l)][first];
  tc_load_records(from, word);
}

/* Loads the pieces with the numbers `at`. */
TC_INLINE void tc_pieces_load(const TcPieces *pieces, TcInt at, TcLanePieces *piece) {
  TcVec word[TC_PIECE_WORDS];
#ifdef TC_HAVE_LOOKUP
  if (TC_LIKELY(pieces->count < TC_LANES)) {
    TC_UNROLLED for (int k = 0; k <= TC_PIECE_JUMP; ++k) word[k] = tc_lookup(tc_piece_columns(pieces)[k], at);
  } else
#endif
  {
    TC_UNROLLED for (int k = 0; k < TC_PIECE_WORDS; k += 4) tc_pieces_words(pieces, at, k, word + k);
  }
  piece->low = word[TC_PIECE_LOW];
  piece->high = word[TC_PIECE_HIGH];
  piece->from = word[TC_PIECE_FROM];
  piece->extinction = word[TC_PIECE_EXTINCTION];
  piece->rise = word[TC_PIECE_RISE];
  for (int k = 0; k < 3; ++k) {
    piece->color[k] = word[TC_PIECE_COLOR + k];
    piece->color_rise[k] = word[TC_PIECE_COLOR_RISE + k];
  }
  piece->scale = word[TC_PIECE_SCALE];
  piece->at = at;
  piece->above = tc_bits_of(word[TC_PIECE_ABOVE]);
  piece->below = tc_bits_of(word[TC_PIECE_BELOW]);
  piece->filled = tc_lt(tc_set(0), word[TC_PIECE_FILLED]);
  piece->steep = word[TC_PIECE_STEEP];
  piece->beside = word[TC_PIECE_BESIDE];
  piece->jump = word[TC_PIECE_JUMP];
}

/* Loads, in the lanes of `mask`, the pieces in which `value` lies. At a knot it is the later piece; a lane whose values
 * fall leaves it for the earlier one with its first part, of length 0. */
TC_NOINLINE void tc_pieces_locate(const TcPieces *pieces, TcMask mask, const TcVec *value, TcLanePieces *piece) {
  TcInt at = tc_set_int(0);
  if (pieces->count <= 32) {
    for (int64_t i = 0; i < pieces->count; ++i) {
      at += tc_select_int(tc_le(tc_set((TcReal)pieces->knots[i]), *value), tc_set_int(1), tc_set_int(0));
    }
  } else {
    for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
      const int l = __builtin_ctz(lanes);
      TC_AT(at, l) = (TcInteger)tc_piece_above(pieces, (double)TC_AT(*value, l));
    }
  }
  tc_pieces_load(pieces, tc_select_int(mask, at, piece->at), piece);
}

#endif
