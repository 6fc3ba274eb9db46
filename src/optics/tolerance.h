/* SPDX-License-Identifier: Apache-2.0 */
/* How a tolerance is spent, and the bound on what a ray's light may be off.
 *
 * Let a segment's weights be off by |δw₀| + |δw₁| ≤ δ α and its transmittance by δ α, α its opacity, and let C be the largest colour.
 * Replacing the exact segments by these one after the other, from the last to the first, changes the light by
 *
 *     Σ T_before (|δw₀| c₀ + |δw₁| c₁ + δα · light behind) ≤ 2 δ C Σ T_before α ≤ 2 δ C α_ray / (1 − δ),
 *
 * however many there are: T_before is the product of the transmittances used, and Σ T_before α telescopes. Ending a ray where its
 * transmittance is T leaves out at most T C of the colour and T of the opacity.
 *
 * Single precision (packet_single.h), u = 2⁻²⁴. A ray sees a mesh whose vertices are moved across it by √2 u of their distance from it,
 * which is at most D, the longest edge. So where it sees s̃, the field has s within √2 u D G, G its steepest gradient. To that comes what
 * rounding does to values, the largest of which is S: of a vertex 1 u S, interpolation in a face 11, where the ray begins 10, at knots 3; together
 * E = 1.5 u D G + 32 u S. The depths at which it sees them are off by 12 u R, R the volume's radius, where they fall back by twice that: η = 32 u R; and
 * more where it enters and leaves, as a face of the shell may be seen almost edge-on. How much more is measured there, against the depths
 * in double precision: Δ in all. With V the sum of |Δs| along the ray, at most 2R long, K the largest extinction, K' and C' the largest slopes
 * of extinction and colour over s,
 *
 *     ε = ∫ |κ̃ − κ| dt ≤ K' (2 R E + η V) + K (Δ + 2 η + 16 u R)   (rounding of lengths and extinctions: 8 u K 2R)
 *
 * changes the opacity by ε at most, and the colour by C ε (1 + e^ε) + C' (E + K η V), as ∫ κ e^−τ dt ≤ 1. The light's own rounding is 400 u C α at
 * most: of a block of 64 segments, transmittances 128 u, sums of colours 128 u; each segment's weights and colours 30 u. Blocks are summed
 * up in double precision. Where the field or the transfer function jumps there is no such bound, and single precision is not used. */
#ifndef TC_OPTICS_TOLERANCE_H
#define TC_OPTICS_TOLERANCE_H

#include "optics/transfer.h"

typedef struct TcTolerance {
  double thin;     /* segments up to this optical depth are evaluated by tc_segment_thin(); below 0: none */
  double relative; /* δ of these */
  double opaque;   /* optical depth beyond which a ray ends */
  double color;    /* C: largest component of any colour that is seen */

  /* Single precision: what is off by it is at most fixed + per_variation V + per_shift Δ. A ray for which that is above `single_most` is
   * left to double precision. 0: all are. */
  double single_most, single_fixed, per_variation, per_shift;
} TcTolerance;

/* What of a volume and its point field the bound depends on, all in scaled units. */
typedef struct TcSteepness {
  double radius;   /* R, of the volume */
  double diameter; /* D, the longest edge */
  double gradient; /* G, the largest of a cell's |∇s|; infinite if there is a value that is not finite, or a cell without volume */
  double value;    /* S, the largest |s| */
} TcSteepness;

/* Spends half of `tolerance` on evaluation and half on ending rays; 0: exact. */
TcTolerance tc_tolerance_begin(const TcPieces *pieces, double tolerance);

/* Allows single precision to take `tolerance` beyond what is spent otherwise, if that looks like enough. */
bool tc_tolerance_allow_single(const TcPieces *pieces, const TcSteepness *field, double tolerance, TcTolerance *result);

/* Bound on the error of each channel, after tc_light_end(): of a light of this opacity, made from `segments` segments. */
double tc_tolerance_bound(const TcTolerance *tolerance, const TcLight *light, double alpha, int64_t segments);

#endif
