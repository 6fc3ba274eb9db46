/* SPDX-License-Identifier: Apache-2.0 */
/* How a tolerance is spent, and the bound on the error of a ray's light.
 *
 * Let α be a segment's opacity, the error of its weights |δw₀| + |δw₁| ≤ δ α, that of its transmittance at most δ α,
 * and let C be the largest colour. Replacing the exact segments by these one after the other, from the last to the
 * first, changes the light by
 *
 *     Σ T_before (|δw₀| c₀ + |δw₁| c₁ + δα · light behind) ≤ 2 δ C Σ T_before α ≤ 2 δ C α_ray / (1 − δ),
 *
 * however many there are: T_before is the product of the transmittances used, and Σ T_before α telescopes. Ending a ray
 * where its transmittance is T leaves out at most T C of the colour and T of the opacity.
 *
 * Rounding moves the places where a ray meets faces. Each vertex is moved beside the ray by at most ε (walk/screen.h:
 * beside + relative · distance), in the same way for all of its cells, so the ray sees a mesh that is a little
 * deformed. A vertex keeps its value; so the value that is seen at a point is one that the field has within ε of it. In
 * a cell whose scalar has a slope of at most G across the ray, the scalar's error is ε G for each of the two faces that
 * the ray crosses. ε G is at most
 *
 *     ε (|∂s/∂x| + |Δs/Δz| |∂z/∂x|),
 *
 * with the slopes of either of these faces; the smaller one is taken (walk/points.h: tilt). In addition, rounding
 * changes the values themselves by δs and depths by δz. Over a cell of which a length h is crossed, the integral of the
 * scalar's error is at most the
 *
 *     spread = 2 ε (h |∂s/∂x| + |Δs| |∂z/∂x|) + h δs + |Δs| δz.
 *
 * Where what is seen jumps, as it does at the shell, and at any face if the field is one of cells, the error of the
 * depth counts, the shift = ε |∂z/∂x| + δz.
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
  double relative;  /* δ of such segments */
  double opaque;    /* the optical depth beyond which a ray ends */
  double color;     /* C: the largest component of any colour that is seen, at least 1 */
  double per_shift; /* 2.1 C K */
  /* Single precision: the largest of 2.1 C K' + C' K over all pieces, as knots are rounded and a scalar may be in
   * another piece. */
  double per_spread;
  double rounding; /* single precision: the rounding of the integral, relative to the opacity times C */
  double most;     /* single precision: a ray whose bound is above this is walked again in double precision */
} TcTolerance;

/* Spends half of `tolerance` on the evaluation of thin segments and half on ending rays. With 0, all is exact.
 * `brightest` is the largest component of what is seen beside the transfer function's colours: surfaces, and these
 * colours in a light. */
TcTolerance tc_tolerance_begin(const TcPieces *pieces, double brightest, double tolerance);

/* The same for single precision, to whose rounding half of the tolerance goes. False if that is not enough. `largest`
 * is the largest magnitude of the scalars, `length` the largest length of a ray in the mesh. *values becomes the
 * largest magnitude of scalars, and of knots among them. */
bool tc_tolerance_single(const TcPieces *pieces, double tolerance, double largest, double length, TcTolerance *result,
                         double *values);

/* A bound on the rounding of the integral in double precision, relative to the opacity times the largest colour, for a
 * ray of `segments` segments. */
double tc_rounding(int64_t segments);

/* A bound on the error of each channel of a ray with this optical depth, opacity and number of segments. `stopped`
 * tells whether the ray was ended, so that there may be more behind. `moved` is the error that comes from the places
 * where the ray meets faces. */
double tc_tolerance_bound(const TcTolerance *tolerance, double depth, bool stopped, double alpha, int64_t segments,
                          double moved);

#endif
