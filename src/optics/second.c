/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/second.h"

#include <float.h>
#include <math.h>
#include <string.h>

static int64_t knots_of(TetcastTransferFunction *const *rows, int count) {
  int64_t sum = 0;
  for (int i = 0; i < count; ++i)
    sum += rows[i]->pieces.count;
  return sum;
}

/* The knots of all rows, merged. */
static int64_t merge(TetcastTransferFunction *const *rows, int count, double *knots) {
  int64_t n = 0;
  double last = -INFINITY;
  for (;;) {
    double next = INFINITY;
    for (int i = 0; i < count; ++i) {
      const TcPieces *pieces = &rows[i]->pieces;
      const int64_t above = tc_piece_above(pieces, last);
      if (above < pieces->count)
        next = fmin(next, pieces->knots[above]);
    }
    if (next == INFINITY)
      return n;
    knots[n++] = last = next;
  }
}

/* The largest of each number over the rows, just below x and just above it. */
static void limits(TetcastTransferFunction *const *rows, int count, double x, TcOptics most[2]) {
  memset(most, 0, 2 * sizeof *most);
  for (int i = 0; i < count; ++i) {
    const TcPieces *pieces = &rows[i]->pieces;
    for (int side = 0; side < 2; ++side) {
      const int64_t p = side ? tc_piece_above(pieces, x) : tc_piece_below(pieces, x);
      const TcOptics at = tc_piece_at(&pieces->pieces[p], x);
      most[side].extinction = fmax(most[side].extinction, at.extinction);
      for (int k = 0; k < 3; ++k)
        most[side].color[k] = fmax(most[side].color[k], at.color[k]);
    }
  }
}

TetcastStatus tc_second_hull(TetcastContext *context, TetcastTransferFunction *const *rows, int count,
                             TetcastTransferFunction **hull) {
  const int64_t most = knots_of(rows, count);
  double *knots, *color, *extinction;
  if (!tc_allocate_array(context, (void **)&knots, most, (1 + 2 * 4 + 2 * 2) * sizeof(double), "transfer function"))
    return TETCAST_ERROR_MEMORY;
  color = knots + most;
  extinction = color + 8 * most;
  const int64_t n = merge(rows, count, knots);
  for (int64_t i = 0; i < n; ++i) {
    TcOptics at[2];
    limits(rows, count, knots[i], at);
    for (int side = 0; side < 2; ++side) {
      double *c = color + 4 * (2 * i + side), *e = extinction + 2 * (2 * i + side);
      c[0] = e[0] = knots[i];
      memcpy(c + 1, at[side].color, sizeof at[side].color);
      e[1] = at[side].extinction;
    }
  }
  TetcastTransferFunctionDesc desc = {
      .color = color, .color_count = 2 * n, .extinction = extinction, .extinction_count = 2 * n};
  const TetcastStatus status = tc_transfer_create(context, &desc, hull);
  tc_release(context, knots);
  return status;
}

/* In a piece of the hull, which lies within one of the row's. */
static void take_ends(const TcPieces *row, const TcPiece *piece, TcSecondEnds *ends) {
  const bool first = piece->low == -INFINITY, last = piece->high == INFINITY;
  const TcPiece *of_row = &row->pieces[first ? 0 : tc_piece_above(row, piece->low)];
  const TcOptics low = first  ? of_row->at_low
                       : last ? of_row->at_high
                              : tc_piece_at(of_row, piece->low),
                 high = first || last ? low : tc_piece_at(of_row, piece->high);
  ends->low[0] = low.extinction;
  ends->high[0] = high.extinction;
  memcpy(ends->low + 1, low.color, sizeof low.color);
  memcpy(ends->high + 1, high.color, sizeof high.color);
}

TetcastStatus tc_second_build(TetcastContext *context, TetcastTransferFunction *const *rows, int count,
                              const TcPieces *hull, TcSecond *second) {
  const int64_t pieces = hull->count + 1;
  *second = (TcSecond){.rows = count < 2 ? 2 : count, .pieces = pieces};
  if (!tc_allocate_array(context, (void **)&second->ends, second->rows * pieces, sizeof *second->ends,
                         "transfer function") ||
      !tc_allocate_array(context, (void **)&second->place, pieces, sizeof *second->place, "transfer function")) {
    tc_second_clear(context, second);
    return TETCAST_ERROR_MEMORY;
  }
  for (int64_t i = 0; i < pieces; ++i) {
    const TcPiece *piece = &hull->pieces[i];
    const bool first = piece->low == -INFINITY, last = piece->high == INFINITY;
    double *place = second->place[i];
    place[0] = !first ? piece->low : last ? 0 : piece->high;
    place[1] = !last ? piece->high : place[0];
    place[2] = place[0] < place[1] ? fmin(1 / (place[1] - place[0]), DBL_MAX) : 0;
    place[3] = 0;
    for (int r = 0; r < second->rows; ++r) /* a single row is there twice */
      take_ends(&rows[r < count ? r : count - 1]->pieces, piece, &second->ends[r * pieces + i]);
  }
  return TETCAST_OK;
}

void tc_second_clear(TetcastContext *context, TcSecond *second) {
  tc_release(context, second->ends);
  tc_release(context, second->place);
  memset(second, 0, sizeof *second);
}

double tc_second_place(const double *at, int count, double value) {
  if (isnan(value))
    return (double)NAN;
  int above = 0;
  while (above < count && at[above] <= value)
    ++above;
  if (above == 0 || above == count)
    return above == 0 ? 0 : count - 1;
  const double part = isfinite(at[above] - at[above - 1]) ? 1 : 0.5; /* halves of differences that are too large */
  return above - 1 + (part * value - part * at[above - 1]) / (part * at[above] - part * at[above - 1]);
}

TcOptics tc_second_at(const TcSecond *second, const TcPieces *hull, double place, double s) {
  const int64_t i = tc_piece_above(hull, s);
  const int r = (int)place < second->rows - 2 ? (int)place : second->rows - 2;
  const TcSecondEnds *a = &second->ends[r * second->pieces + i], *b = a + second->pieces;
  const double u = fmin(1, (s - second->place[i][0]) * second->place[i][2]), w = place - r;
  double value[4];
  for (int k = 0; k < 4; ++k) {
    value[k] = (1 - w) * ((1 - u) * a->low[k] + u * a->high[k]) + w * ((1 - u) * b->low[k] + u * b->high[k]);
  }
  return (TcOptics){.extinction = value[0], .color = {value[1], value[2], value[3]}};
}
