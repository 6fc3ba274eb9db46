/* SPDX-License-Identifier: Apache-2.0 */
/* Extinction and emission as fields of a volume's points and cells, in groups. */
#ifndef TC_VOLUME_COEFFICIENTS_H
#define TC_VOLUME_COEFFICIENTS_H

#include <tetcast/scene.h>

#include "volume/rows.h"

/* A slot is a place in the values at a place along a ray: those of points, then those of the cell. */
typedef struct TcCoefficients {
  TetcastContext *context;
  TcRows *points, *cells; /* NULL: none */
  int groups, extinction_count, emission_count;
  int *slots;      /* [2 groups]: that of each group's extinction, then of its emission; −1: none */
  double scale[2]; /* extinction times both is that of the volume's unit of length */
} TcCoefficients;

/* Larger extinctions, in the volume's unit, count as this: a cell is shorter than 4, which leaves room for TC_LARGEST_DENSITY. */
#define TC_LARGEST_EXTINCTION 0x1p1017

/* A negative extinction is TETCAST_ERROR_DATA, fields of another size TETCAST_ERROR_ARGUMENT. */
TetcastStatus tc_coefficients_create(const TetcastVolume *volume, const TetcastCoefficientsDesc *desc, TcCoefficients **out);
void tc_coefficients_destroy(TcCoefficients *coefficients);

static inline int tc_coefficients_values(const TcCoefficients *c) { return (c->points ? c->points->width : 0) + (c->cells ? c->cells->width : 0); }

#endif
