/* SPDX-License-Identifier: Apache-2.0 */
/* Extinction and emission as fields of a volume's points and cells, in groups. */
#ifndef TC_VOLUME_COEFFICIENTS_H
#define TC_VOLUME_COEFFICIENTS_H

#include <tetcast/scene.h>

#include "optics/transfer.h"
#include "volume/rows.h"

/* Where a ray meets a face, it has a list of values: those of the fields of points, then those of the fields of cells.
 * A slot is a value's place in this list. */
typedef struct TcCoefficients {
  TetcastContext *context;
  TcRows *points, *cells; /* the fields of points and of cells; NULL if there are none */
  int groups, extinction_count, emission_count;
  int *slots; /* [2 groups]: the slot of each group's extinction, then of each group's emission; −1 if it has none */
  double *largest; /* [2 groups], as `slots`: the largest magnitude of each one's values; 0 if it has none */
  double scale[2]; /* extinction times both of them is that per volume's unit of length */
  /* Emission is computed in units of 2^emission_exponent, which is near the largest one. So it doesn't underflow when
   * it is multiplied with the small part of itself that leaves an opaque segment. */
  int emission_exponent;
  double emission_scale; /* emission times this is in these units */
} TcCoefficients;

/* Makes coefficients. A negative extinction is TETCAST_ERROR_DATA, fields of another size TETCAST_ERROR_ARGUMENT. */
TetcastStatus tc_coefficients_create(const TetcastVolume *volume, const TetcastCoefficientsDesc *desc,
                                     TcCoefficients **out);
void tc_coefficients_destroy(TcCoefficients *coefficients);

/* The number of values at a face. */
static inline int tc_coefficients_values(const TcCoefficients *c) {
  return (c->points ? c->points->width : 0) + (c->cells ? c->cells->width : 0);
}

#endif
