/* SPDX-License-Identifier: Apache-2.0 */
/* How a tolerance is spent, and the bound on what a ray's light may be off.
 *
 * Let a segment's weights be off by |δw₀| + |δw₁| ≤ δ α and its transmittance by δ α, α its opacity, and let C be the largest colour.
 * Replacing the exact segments by these one after the other, from the last to the first, changes the light by
 *
 *     Σ T_before (|δw₀| c₀ + |δw₁| c₁ + δα · light behind) ≤ 2 δ C Σ T_before α ≤ 2 δ C α_ray / (1 − δ),
 *
 * however many there are: T_before is the product of the transmittances used, and Σ T_before α telescopes. Ending a ray where its
 * transmittance is T leaves out at most T C of the colour and T of the opacity. */
#ifndef TC_OPTICS_TOLERANCE_H
#define TC_OPTICS_TOLERANCE_H

#include "optics/transfer.h"

typedef struct TcTolerance {
  double thin;     /* segments up to this optical depth are evaluated by tc_segment_thin(); below 0: none */
  double relative; /* δ of these */
  double opaque;   /* optical depth beyond which a ray ends */
  double color;    /* C: largest component of any colour that is seen */
} TcTolerance;

/* Spends half of `tolerance` on evaluation and half on ending rays; 0: exact. */
TcTolerance tc_tolerance_begin(const TcPieces *pieces, double tolerance);

/* Bound on the error of each channel, after tc_light_end(): of a light of this opacity, made from `segments` segments. */
double tc_tolerance_bound(const TcTolerance *tolerance, const TcLight *light, double alpha, int64_t segments);

#endif
