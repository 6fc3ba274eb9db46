/* SPDX-License-Identifier: Apache-2.0 */
/* Extinction and emission of a volume's points and cells, in its order. */
#ifndef TC_TRAVERSE_COEFFICIENTS_H
#define TC_TRAVERSE_COEFFICIENTS_H

#include <tetcast/scene.h>

#include "optics/transfer.h"
#include "traverse/walk.h"

/* One row of values for each vertex, or for each cell: the fields of that association next to each other, float when all of them came as
 * float32; what is not finite is NaN. */
typedef struct TcRows {
  void *data; /* [vertices or cells][width] */
  int width;
  bool is_double;
} TcRows;

/* A slot is a place in the values at a place along a ray: those of points, then those of the cell. */
typedef struct TcCoefficients {
  TetcastContext *context;
  TcRows points, cells;
  int groups, extinction_count, emission_count;
  int *slots;             /* [2 groups]: that of each group's extinction, then of its emission; −1: none */
  double scale[2];        /* extinction times both is that of the volume's unit of length */
  int emission_exponent;  /* emission is counted in this power of two, near the largest: times what an opaque segment
                             lets out, … */
  double emission_scale;  /* … it does not underflow. Emission times this is in that unit */
} TcCoefficients;

/* Values of larger magnitude count as this: interpolation between them doesn't overflow. */
#define TC_LARGEST_VALUE 0x1p1022

TetcastStatus tc_coefficients_create(const TetcastVolume *volume, const TetcastCoefficientsDesc *desc, TcCoefficients **out);
void tc_coefficients_destroy(TcCoefficients *coefficients);

static inline int tc_coefficients_values(const TcCoefficients *c) { return c->points.width + c->cells.width; }

/* values[i] += weight · those of row `row` */
static inline void tc_rows_add(const TcRows *rows, uint32_t row, double weight, double *values) {
  const size_t first = (size_t)row * (size_t)rows->width;
  for (int i = 0; i < rows->width; ++i) {
    values[i] += weight * (rows->is_double ? ((const double *)rows->data)[first + (size_t)i] : (double)((const float *)rows->data)[first + (size_t)i]);
  }
}

/* The points' values where the ray crosses a face. Weights are ≥ 0 and good to a few units in the last place, and so are values of one sign. */
static inline void tc_coefficients_at(const TcCoefficients *c, const TcWalk *face, double *values) {
  const double inverse = 1 / (face->edge[0] + face->edge[1] + face->edge[2]);
  for (int i = 0; i < c->points.width; ++i) values[i] = 0;
  for (int k = 0; c->points.width && k < 3; ++k) tc_rows_add(&c->points, face->v[k].id, face->edge[(k + 1) % 3] * inverse, values);
}

/* Those of a cell. */
static inline void tc_coefficients_in(const TcCoefficients *c, uint32_t cell, double *values) {
  for (int i = 0; i < c->cells.width; ++i) values[c->points.width + i] = 0;
  tc_rows_add(&c->cells, cell, 1, values + c->points.width);
}

/* An extinction in the volume's unit of length; NaN stays NaN. */
static inline double tc_coefficients_scaled(const TcCoefficients *c, double extinction) {
  const double scaled = extinction * c->scale[0] * c->scale[1];
  return scaled > TC_LARGEST_EXTINCTION ? TC_LARGEST_EXTINCTION : scaled;
}

#endif
