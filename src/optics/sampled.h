/* SPDX-License-Identifier: Apache-2.0 */
/* The integrators that others use, to compare with: each replaces tc_light_add() for a segment of a point field. */
#ifndef TC_OPTICS_SAMPLED_H
#define TC_OPTICS_SAMPLED_H

#include <tetcast/scene.h>

#include "optics/transfer.h"

typedef struct TcSampler {
  TetcastContext *context;
  TetcastIntegrator integrator;
  int n;
  double *table;                           /* table: [n][n] of Ψ */
  double nodes[TETCAST_MAX_GAUSS];         /* gauss: in [0, 1] */
  double weights[TETCAST_MAX_GAUSS];       /* sum 1 */
  double inner[TETCAST_MAX_GAUSS][TETCAST_MAX_GAUSS]; /* inner[i][j] = ∫₀^node[i] of the j-th Lagrange polynomial */
} TcSampler;

TetcastStatus tc_sampler_create(TetcastContext *context, TetcastIntegrator integrator, int n, TcSampler **sampler);
void tc_sampler_destroy(TcSampler *sampler);

void tc_light_add_sampled(TcLight *light, const TcPieces *pieces, const TcSampler *sampler, double length, double s0, double s1);

#endif
