/* SPDX-License-Identifier: Apache-2.0 */
/* How a tolerance is spent, and the bound on what a ray's light may be off.
 *
 * Let a segment's weights be off by |δw₀| + |δw₁| ≤ δ α and its transmittance by δ α, α its opacity, and let C be the
 * largest colour. Replacing the exact segments by these one after the other, from the last to the first, changes the
 * light by
 *
 *     Σ T_before (|δw₀| c₀ + |δw₁| c₁ + δα · light behind) ≤ 2 δ C Σ T_before α ≤ 2 δ C α_ray / (1 − δ),
 *
 * however many there are: T_before is the product of the transmittances used, and Σ T_before α telescopes. Ending a ray
 * where its transmittance is T leaves out at most T C of the colour and T of the opacity.
 *
 * What rounding does to the places where a ray meets faces: vertices are rounded beside the ray, each for itself and
 * for all its cells, so the ray sees a mesh that is a little deformed, by at most ε (walk/screen.h: beside + relative ·
 * distance). A vertex keeps its value; so what is seen at a point, the field has within ε of it. In a cell whose scalar
 * changes by at most G beside the ray, the scalar is off by ε G, for each of the two faces of it; ε G is at most
 *
 *     ε (|∂s/∂x| + |Δs/Δz| |∂z/∂x|),
 *
 * with the slopes of one of the cell's two faces that the ray crosses, whichever is less (walk/points.h: tilt). To that
 * comes what rounding does to the values themselves, δs, and to depths, δz. Over a cell that is crossed over a length h
 * the integral of the scalar's error is at most the
 *
 *     spread = 2 ε (h |∂s/∂x| + |Δs| |∂z/∂x|) + h δs + |Δs| δz.
 *
 * Where what is seen jumps, as at the shell, at any face of a field of cells, the depth itself counts, the shift = ε
 * |∂z/∂x| + δz.
 *
 * With K the largest extinction, and K' and C' the slopes of extinction and colour over the scalar, extinctions are off
 * by ∫ |κ̃ − κ| dt ≤ η = Σ K' spread + K Σ shift. That changes the opacity by η at most, and the colour by C η (1 + e^η)
 * + C' Σ K spread, as ∫ κ e^−τ dt ≤ 1 and, in a cell, ∫ κ dt ≤ K h. For η < 0.09 it is less than Σ (2.1 C K' + C' K)
 * spread + 2.1 C K Σ shift, slopes and K being those of the piece of the transfer function where the segment is
 * (transfer.h: steep). Within the scalar's error of a knot it may be in the piece beside, or jump: over a length of at
 * most 2 spread / |Δs|. */
#ifndef TC_OPTICS_TOLERANCE_H
#define TC_OPTICS_TOLERANCE_H

#include "optics/transfer.h"

typedef struct TcTolerance {
  double thin;      /* segments up to this optical depth are evaluated by tc_segments_thin(); below 0: none */
  double relative;  /* δ of these */
  double opaque;    /* optical depth beyond which a ray ends */
  double color;     /* C: the largest component of any colour that is seen, at least 1 */
  double per_shift; /* 2.1 C K */
  double
      per_spread;  /* single precision: the largest of 2.1 C K' + C' K; with knots rounded, pieces are not told apart */
  double rounding; /* single precision: of the integral, relative to the opacity times C */
  double most;     /* single precision: a ray whose bound is above this is walked again in double precision */
} TcTolerance;

/* Spends half of `tolerance` on evaluation and half on ending rays; 0: exact. */
TcTolerance tc_tolerance_begin(const TcPieces *pieces, double tolerance);

/* The same for single precision, which takes half of it; false: it would not do. Scalars are at most `largest`, of rays
 * with a length of at most `length` in the mesh, of which rounding to single precision takes `depth` at each end.
 * *values: the largest magnitude of scalars and of knots among them. */
bool tc_tolerance_single(const TcPieces *pieces, double tolerance, double largest, double length, TcTolerance *result,
                         double *values);

/* Rounding of the integral in double precision, relative to the opacity times the largest colour, of a ray made from
 * `segments` segments. */
double tc_rounding(int64_t segments);

/* Bound on the error of each channel of a ray of this optical depth and opacity, made from `segments` segments;
 * `stopped`: there may be more behind; `moved`: what the places where it meets faces make off. */
double tc_tolerance_bound(const TcTolerance *tolerance, double depth, bool stopped, double alpha, int64_t segments,
                          double moved);

#endif
