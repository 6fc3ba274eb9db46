/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/tolerance.h"

#include <math.h>

/* In units of 2^−53: a segment's weights 72 (segment_lanes.h; segment.h: 36), its extinction, length and colours, each
 * from interpolation, 20; the product of transmittances and the sum of colours over a block of 128 parts of segments 4
 * · 128; sums over blocks, of which there are segments / 64, 2 each, and once more through the depth. */
double tc_rounding(int64_t segments) {
  return (768 + (double)segments / 16) * 0x1p-53;
}

static double largest_extinction(const TcPieces *pieces) {
  double largest = 0;
  for (int64_t i = 0; i <= pieces->count; ++i) {
    largest = fmax(largest, fmax(pieces->pieces[i].at_low.extinction, pieces->pieces[i].at_high.extinction));
  }
  return largest;
}

TcTolerance tc_tolerance_begin(const TcPieces *pieces, double brightest, double tolerance) {
  TcTolerance result = {.thin = -1, .opaque = TC_OPAQUE_DEPTH, .most = INFINITY};
  result.color = fmax(fmax(1, brightest), fmax(pieces->largest[0], fmax(pieces->largest[1], pieces->largest[2])));
  result.per_shift = 2.1 * result.color * largest_extinction(pieces);
  const double spare = tolerance - tc_rounding(1 << 14) * result.color;
  if (!(spare > 0))
    return result; /* the tolerance isn't larger than rounding, so nothing is left to spend */
  /* tc_segments_thin() is off by less than T⁴/90 relative to the opacity, for T ≤ 1/2. */
  result.thin = fmin(0.5, sqrt(sqrt(90 * spare / (4.1 * result.color))));
  result.relative = result.thin * result.thin * result.thin * result.thin / 90;
  result.opaque = fmax(0, log(2 * result.color) - log(spare)); /* deeper than needed if the tolerance is above 1 */
  return result;
}

/* In units of 2^−24: segments' weights and transmittances 2 · 102, the sums and products of a block of 64 segments 256,
 * with some to spare. Blocks are summed up in double precision. */
static const double single_rounding = 600 * 0x1p-24;

bool tc_tolerance_single(const TcPieces *pieces, double tolerance, double largest, double length, TcTolerance *result,
                         double *values) {
  const double most = 0x1p60; /* products of a few numbers up to this don't overflow in single precision */
  const double u = 0x1p-24;
  if (pieces->scaled || pieces->count > 1 << 20)
    return false;
  TcTolerance half = tc_tolerance_begin(pieces, 0, 0.5 * tolerance);
  *values = largest;
  for (int64_t i = 0; i <= pieces->count; ++i) {
    const double *row = pieces->rows_f64[i];
    if (row[TC_PIECE_HIGH] < -largest || row[TC_PIECE_LOW] > largest)
      continue;
    if (row[TC_PIECE_JUMP] > 0)
      return false;
    half.per_spread = fmax(half.per_spread, row[TC_PIECE_STEEP]);
    if (i < pieces->count && fabs(pieces->knots[i]) <= largest)
      *values = fmax(*values, fabs(pieces->knots[i]));
  }
  if (!(largest < most && half.per_spread < most && half.per_shift < most && half.color < most))
    return false;
  half.thin = -1; /* the polynomials of single precision are short in any case */
  half.relative = 0;
  half.rounding = single_rounding;
  half.most = fmin(tolerance, 0.09);
  const double least = half.per_spread * length * 32 * u * largest + half.per_shift * 64 * u * length +
                       single_rounding * half.color + 0.5 * tolerance;
  if (!(half.opaque < TC_OPAQUE_DEPTH && least <= 0.9 * half.most))
    return false;
  *result = half;
  return true;
}

double tc_tolerance_bound(const TcTolerance *tolerance, double depth, bool stopped, double alpha, int64_t segments,
                          double moved) {
  const double color = tolerance->color, left = stopped ? exp(-depth) * color : 0,
               relative = 2 * tolerance->relative / (1 - tolerance->relative) +
                          (tolerance->rounding > 0 ? tolerance->rounding : tc_rounding(segments));
  if (!(moved < 0.09))
    return color * (1 + relative); /* no channel's error is larger than its largest value, as computed */
  return left + moved + alpha * color * relative;
}
