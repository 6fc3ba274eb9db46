/* SPDX-License-Identifier: Apache-2.0 */
/* The gradient of a scalar: constant in a cell of points, and at a vertex the mean of that in the cells around it,
 * weighted by their volumes. Of surfaces only its direction matters, so all are times one unknown factor. */
#ifndef TC_VOLUME_GRADIENTS_H
#define TC_VOLUME_GRADIENTS_H

#include "base/vec3.h"
#include "volume/rows.h"

/* With edges e_k from a tetrahedron's first vertex to the others, over which the scalar rises by rise[k], the gradient
 * is Σ rise[k] a_k / D, with a_k the cross product of the two other edges in cyclic order and D = e_0 · a_0, which is
 * six times the volume, or minus that. Returns the sum with D's sign, and *six_volumes = |D|. */
static inline void tc_cell_gradient(double position[4][3], const double value[4], double sum[3], double *six_volumes) {
  double edge[3][3], determinant = 0;
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k)
      edge[j][k] = position[j + 1][k] - position[0][k];
  }
  for (int k = 0; k < 3; ++k)
    sum[k] = 0;
  for (int j = 0; j < 3; ++j) {
    double across[3];
    tc_cross(edge[(j + 1) % 3], edge[(j + 2) % 3], across);
    if (j == 0)
      determinant = tc_dot(edge[0], across);
    for (int k = 0; k < 3; ++k)
      sum[k] += (value[j + 1] - value[0]) * across[k];
  }
  for (int k = 0; k < 3; ++k)
    sum[k] = determinant < 0 ? -sum[k] : sum[k];
  *six_volumes = fabs(determinant);
}

typedef struct TcGradients {
  TetcastContext *context;
  float (*at)[3]; /* [vertices of the volume]; 0 where there is none, as where all cells have NaN */
} TcGradients;

/* Those at the vertices of a point field. Cells with a value that is not finite count for nothing. */
TetcastStatus tc_gradients_build(const TcRows *values, TcGradients *gradients);
void tc_gradients_clear(TcGradients *gradients);

#endif
