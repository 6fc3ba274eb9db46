/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces of a transfer function of two dimensions (optics/second.h) in lanes, each lane's between two rows. */
#ifndef TC_GATHER_SECOND_H
#define TC_GATHER_SECOND_H

#include "gather/pieces.h"
#include "optics/second.h"

/* The places among the rows of the cells that lanes are in. */
TC_INLINE TcVec tc_second_cells(const unsigned on, const TcSecond *second, const uint32_t cell[TC_LANES]) {
  TcVec place = tc_set(0);
  if (on & TC_SURFACES && !second->cell)
    return place;
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) TC_AT(place, l) = (TcReal)second->cell[cell[l]];
  return place;
}

#if TC_SINGLE
#define tc_second_load(second, place, piece) ((void)0)
#else
/* Gives the lanes' pieces, whose numbers are known, the extinction and the colour that they have at these places: the
 * means of two rows', weighted, whose terms all have one sign, so that nothing cancels. As in transfer.h, they are told
 * from the end where the extinction is least; `scale` makes a fraction of the piece of the way from there. */
TC_INLINE void tc_second_load(const TcSecond *second, TcVec place, TcLanePieces *piece) {
  const TcMask known = tc_eq(place, place);
  const TcVec zero = tc_set(0), one = tc_set(1), kept = tc_select(known, place, zero);
  TcVec row;
  (void)tc_nearest(kept - 0.5, &row); /* rounded down; a whole number may become the one before, with w = 1 */
  row = tc_max(tc_min(row, tc_set(second->rows - 2.0)), zero);
  const TcVec w = kept - row, v = one - w;
  const double *low[2][TC_LANES], *high[2][TC_LANES], *where[TC_LANES];
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) {
    const int64_t at = (int64_t)TC_AT(piece->at, l), r = (int64_t)TC_AT(row, l);
    const TcSecondEnds *ends = &second->ends[r * second->pieces + at];
    for (int k = 0; k < 2; ++k) {
      low[k][l] = ends[k * second->pieces].low;
      high[k][l] = ends[k * second->pieces].high;
    }
    where[l] = second->place[at];
  }
  TcVec a[2][4], b[2][4], ends[4];
  for (int k = 0; k < 2; ++k) {
    tc_load_records(low[k], a[k]);
    tc_load_records(high[k], b[k]);
  }
  tc_load_records(where, ends);
  TcVec at_low[4], at_high[4];
  for (int k = 0; k < 4; ++k) {
    at_low[k] = tc_madd(v, a[0][k], w * a[1][k]);
    at_high[k] = tc_madd(v, b[0][k], w * b[1][k]);
  }
  const TcMask falls = tc_lt(at_high[0], at_low[0]);
  piece->from = tc_select(falls, ends[1], ends[0]);
  piece->scale = tc_select(falls, -ends[2], ends[2]);
  piece->extinction = tc_select(known, tc_min(at_low[0], at_high[0]), zero);
  piece->rise = tc_select(known, tc_abs(at_high[0] - at_low[0]), zero);
  for (int k = 0; k < 3; ++k) {
    piece->color[k] = tc_select(falls, at_high[1 + k], at_low[1 + k]);
    piece->color_rise[k] = tc_select(falls, at_low[1 + k] - at_high[1 + k], at_high[1 + k] - at_low[1 + k]);
  }
  piece->filled = tc_and(known, tc_lt(zero, tc_max(at_low[0], at_high[0])));
}
#endif

#endif
