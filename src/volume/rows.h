/* SPDX-License-Identifier: Apache-2.0 */
/* Fields in the order of a volume: a row of numbers for each of its vertices or cells. They are what scenes refer to;
 * scenes of one volume that are given the same field share its rows. */
#ifndef TC_VOLUME_ROWS_H
#define TC_VOLUME_ROWS_H

#include "volume/shared.h"
#include "volume/volume.h"

/* A scalar whose values are all below 2^−TC_TINY_FIELD is stored times 2^TC_TINY_FIELD, so that interpolation does not
 * underflow. One with a value above TC_LARGEST_SCALAR is stored times 2^−TC_HUGE_FIELD, so that it does not overflow.
 */
enum { TC_TINY_FIELD = 500, TC_HUGE_FIELD = 64 };

/* Values of coefficients whose magnitude is larger count as this. */
#define TC_LARGEST_VALUE 0x1p1022

typedef struct TcRows {
  const TetcastVolume *volume;
  TetcastAssociation association;
  int width;      /* the length of a row: the number of fields, or 4 for a field of corners */
  bool is_double; /* whether numbers are double; they are float if all fields came as float */
  int64_t count;  /* the number of rows: that of the volume's vertices or cells */
  void *data;     /* [count][width]; numbers that are not finite are stored as NaN */

  /* The following are of a scalar only. */
  int exponent;      /* values are stored times 2^−exponent */
  float (*range)[2]; /* [clusters]: a range that contains all values of a cluster but NaN; (∞, −∞) if all are NaN. NULL
                        if the volume has no clusters */
  double largest; /* the largest magnitude of finite values, as stored */
  bool has_holes; /* whether some values are not finite */

  TcSharedEntry entry; /* among what the volume's scenes share */
} TcRows;

/* Makes rows of one scalar. A field that can't change (TETCAST_COPY) has one copy for all who ask for it. The
 * field must have as many values as the volume's mesh had vertices or cells (TETCAST_ERROR_ARGUMENT). */
TetcastStatus tc_rows_of_scalar(const TetcastVolume *volume, const TetcastField *field, TcRows **rows);

/* Whether a field of points has different values for vertices at one place. Its rows are corners then. */
bool tc_field_jumps(const TetcastVolume *volume, const TetcastField *field);

/* Makes rows of `width` fields of one association, with their values as they are. The caller has checked their numbers
 * of values, and that none of them jumps. */
TetcastStatus tc_rows_of_fields(const TetcastVolume *volume, const TetcastField *const *fields, int width,
                                TcRows **rows);

/* Puts next to each other what rays in a space of their own need of the vertices from `begin` up to `end`: the
 * position, scaled, and the scalar, if it is one of points; else 0. `rows` may be NULL. The first of `points` is that
 * of vertex `begin`. */
void tc_rows_points(const TetcastVolume *volume, const TcRows *rows, int64_t begin, int64_t end, double (*points)[4]);

/* Counts one user more. */
void tc_rows_retain(TcRows *rows);

/* Counts one user less, and frees the rows after the last. NULL does nothing. */
void tc_rows_release(TcRows *rows);

/* Number i of all rows, one after the other. */
static inline double tc_rows_number(const TcRows *rows, int64_t i) {
  return rows->is_double ? ((const double *)rows->data)[i] : (double)((const float *)rows->data)[i];
}

static inline double tc_rows_value(const TcRows *rows, int64_t row, int column) {
  return tc_rows_number(rows, row * rows->width + column);
}

#endif
