/* SPDX-License-Identifier: Apache-2.0 */
/* What one group gathers along a ray from coefficients of its own. In blocks, as TcLight. */
#ifndef TC_OPTICS_BEAM_H
#define TC_OPTICS_BEAM_H

#include <math.h>
#include <stdbool.h>

#include "optics/segment.h"
#include "optics/transfer.h"

typedef struct TcBeam {
  double radiance, depth, transmittance;                   /* of the finished blocks */
  double block_radiance, block_depth, block_transmittance; /* of the block under way */
  int block_length;
} TcBeam;

static inline TcBeam tc_beam_begin(void) { return (TcBeam){.transmittance = 1, .block_transmittance = 1}; }

/* Beyond this, e^−τ is zero in double precision: nothing more reaches the eye. */
static inline bool tc_beam_opaque(const TcBeam *beam) { return beam->depth + beam->block_depth > TC_OPAQUE_DEPTH; }

static inline void tc_beam_end_block(TcBeam *beam) {
  beam->radiance += beam->transmittance * beam->block_radiance;
  beam->depth += beam->block_depth;
  beam->transmittance = exp(-beam->depth);
  beam->block_radiance = beam->block_depth = 0;
  beam->block_transmittance = 1;
  beam->block_length = 0;
}

/* Adds a segment that sends out `radiance`, and has this optical depth and transmittance. */
static inline void tc_beam_add(TcBeam *beam, double radiance, double depth, double transmittance) {
  if (!tc_beam_opaque(beam)) beam->block_radiance += beam->block_transmittance * radiance;
  beam->block_transmittance *= transmittance;
  beam->block_depth += depth;
  if (++beam->block_length == 64) tc_beam_end_block(beam);
}

#endif
