/* SPDX-License-Identifier: Apache-2.0 */
/* Extinction and emission as fields of a volume's points and cells, in groups. */
#ifndef TC_VOLUME_COEFFICIENTS_H
#define TC_VOLUME_COEFFICIENTS_H

#include <tetcast/scene.h>

#include "optics/transfer.h"
#include "volume/rows.h"

/* A slot is a place in the values at a place along a ray: those of points, then those of the cell. */
typedef struct TcCoefficients {
  TetcastContext *context;
  TcRows *points, *cells; /* NULL: none */
  int groups, extinction_count, emission_count;
  int *slots;      /* [2 groups]: that of each group's extinction, then of its emission; −1: none */
  double *largest; /* [2 groups], as `slots`: the largest magnitude of its values; 0: none */
  double scale[2]; /* extinction times both is that of the volume's unit of length */
  /* Emission is counted in this power of two, near the largest: times what an opaque segment lets out, it does not
   * underflow. */
  int emission_exponent;
  double emission_scale; /* emission times this is in that unit */
} TcCoefficients;

/* A negative extinction is TETCAST_ERROR_DATA, fields of another size TETCAST_ERROR_ARGUMENT. */
TetcastStatus tc_coefficients_create(const TetcastVolume *volume, const TetcastCoefficientsDesc *desc,
                                     TcCoefficients **out);
void tc_coefficients_destroy(TcCoefficients *coefficients);

static inline int tc_coefficients_values(const TcCoefficients *c) {
  return (c->points ? c->points->width : 0) + (c->cells ? c->cells->width : 0);
}

#endif
