/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer functions of two dimensions: rows, which are transfer functions of the scalar, each at a value of a second
 * quantity that is constant in a cell, and linear between these. In a cell it is a transfer function of the scalar
 * alone, linear between the knots of all rows, so that all that is exact without a second quantity is exact with it.
 *
 * A cell is given as its place among the rows: r + w is between row r and row r + 1, at the fraction w. */
#ifndef TC_OPTICS_SECOND_H
#define TC_OPTICS_SECOND_H

#include "optics/transfer.h"

/* A row's extinction and colour at the low end of a piece, then at its high end. */
typedef struct TcSecondEnds {
  double low[4], high[4];
} TcSecondEnds;

typedef struct TcSecond {
  int rows;           /* at least 2 */
  int64_t pieces;     /* count + 1 of the hull */
  TcSecondEnds *ends; /* [rows][pieces] */
  /* [pieces]: finite stand-ins of the piece's ends, and 1 / the difference of the two, finite as well, or 0. */
  double (*place)[4];
  const double *cell; /* [cells of the volume]: their places, NaN: transparent; NULL: all are at row 0 */
} TcSecond;

/* The hull of rows: a transfer function with the largest extinction and colour that any of them has, with the knots of
 * all. Where it has no extinction, none has. */
TetcastStatus tc_second_hull(TetcastContext *context, TetcastTransferFunction *const *rows, int count,
                             TetcastTransferFunction **hull);

/* Fills in all but `cell` for rows, and their hull, in the same units; for tc_second_clear(). */
TetcastStatus tc_second_build(TetcastContext *context, TetcastTransferFunction *const *rows, int count,
                              const TcPieces *hull, TcSecond *second);
void tc_second_clear(TetcastContext *context, TcSecond *second);

/* Where `value` lies among `count` ascending values: r + w; before the first 0, beyond the last count − 1. */
double tc_second_place(const double *at, int count, double value);

/* Extinction and colour of a cell at this place, at the scalar s, which the hull's piece `i` contains. */
TcOptics tc_second_at(const TcSecond *second, const TcPieces *hull, double place, double s);

#endif
