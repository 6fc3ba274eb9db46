/* SPDX-License-Identifier: Apache-2.0 */
/* The integrators of other programs, to compare with, one segment at a time. */
#ifndef TC_OPTICS_SAMPLED_H
#define TC_OPTICS_SAMPLED_H

#include <tetcast/integrator.h>

#include "optics/transfer.h"

typedef struct TcSampler {
  TetcastContext *context;
  TetcastIntegrator integrator;
  int n;
  double *table;                                      /* table: [n][n] of Ψ */
  double nodes[TETCAST_MAX_GAUSS];                    /* gauss: in [0, 1] */
  double weights[TETCAST_MAX_GAUSS];                  /* sum 1 */
  double inner[TETCAST_MAX_GAUSS][TETCAST_MAX_GAUSS]; /* inner[i][j] = ∫₀^node[i] of the j-th Lagrange polynomial */
} TcSampler;

TetcastStatus tc_sampler_create(TetcastContext *context, TetcastIntegrator integrator, int n, TcSampler **sampler);
void tc_sampler_destroy(TcSampler *sampler);

/* Light gathered along a ray, front to back. Segments are composited in blocks, and blocks into the total. */
typedef struct TcLight {
  double color[3], depth, transmittance;                   /* total of the finished blocks */
  double block_color[3], block_depth, block_transmittance; /* of the block under way */
  int block_length;
} TcLight;

static inline TcLight tc_light_begin(void) {
  return (TcLight){.transmittance = 1, .block_transmittance = 1};
}

/* Whether the light is complete: whatever follows changes no channel by half a unit in the last place. */
bool tc_light_opaque(const TcLight *light, const TcPieces *pieces);

/* Adds a segment of length > 0 of a point field with scalars s0 → s1 (finite, linear in between), or of a cell's
 * constant scalar, which is exact. */
void tc_light_add_sampled(TcLight *light, const TcPieces *pieces, const TcSampler *sampler, double length, double s0,
                          double s1);
void tc_light_add_constant(TcLight *light, const TcPieces *pieces, double length, double s);

/* Premultiplied colour and opacity of all that was added. */
void tc_light_end(TcLight *light, double rgba[4]);

#endif
