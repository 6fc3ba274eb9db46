/* SPDX-License-Identifier: Apache-2.0 */
/* Fields in the order of a volume: a row of numbers for each of its vertices or cells. Scenes bind fields by them;
 * those that bind the same ones share the rows. */
#ifndef TC_VOLUME_ROWS_H
#define TC_VOLUME_ROWS_H

#include "volume/shared.h"
#include "volume/volume.h"

/* A scalar whose values are all below 2^−TC_TINY_FIELD is stored times 2^TC_TINY_FIELD, so that interpolation does not
 * underflow; one with a value above TC_LARGEST_SCALAR times 2^−TC_HUGE_FIELD, so that it does not overflow. */
enum { TC_TINY_FIELD = 500, TC_HUGE_FIELD = 64 };

/* Other values of larger magnitude count as this. */
#define TC_LARGEST_VALUE 0x1p1022

typedef struct TcRows {
  const TetcastVolume *volume;
  TetcastAssociation association;
  int width;      /* numbers in a row, one of each field */
  bool is_double; /* or float, which they are when all fields came as that */
  int64_t count;  /* rows: vertices or cells of the volume */
  void *data;     /* [count][width]; what is not finite is NaN */

  /* Of a scalar that is seen through a transfer function: */
  int exponent;      /* stored times 2^−exponent */
  float (*range)[2]; /* [clusters]: all values of a cluster lie in it, NaN apart; (∞, −∞) if there are none but NaN.
                        NULL: no clusters */
  double largest;    /* of its finite magnitudes, as stored */
  bool has_holes;    /* some are not finite */

  TcSharedEntry entry; /* among what scenes of the volume share */
} TcRows;

/* A scalar for a transfer function. A field that may not change (TETCAST_COPY) is shared by all that ask for it. The
 * field must have as many values as the volume's mesh had vertices or cells (TETCAST_ERROR_ARGUMENT). */
TetcastStatus tc_rows_of_scalar(const TetcastVolume *volume, const TetcastField *field, TcRows **rows);

/* Whether a field of points has different values for vertices at one place. Its rows are corners then. */
bool tc_field_jumps(const TetcastVolume *volume, const TetcastField *field);

/* `width` fields of one association next to each other, as they are. Their numbers of values have been checked, and
 * that none jumps. */
TetcastStatus tc_rows_of_fields(const TetcastVolume *volume, const TetcastField *const *fields, int width,
                                TcRows **rows);

/* One user more. */
void tc_rows_retain(TcRows *rows);

/* One user less; NULL does nothing. */
void tc_rows_release(TcRows *rows);

/* Number i of all. */
static inline double tc_rows_number(const TcRows *rows, int64_t i) {
  return rows->is_double ? ((const double *)rows->data)[i] : (double)((const float *)rows->data)[i];
}

static inline double tc_rows_value(const TcRows *rows, int64_t row, int column) {
  return tc_rows_number(rows, row * rows->width + column);
}

#endif
