/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/tolerance.h"

#include <math.h>

/* Rounding, in units of 2^−53, relative to the ray's opacity times the largest colour: a segment's weights 72 (segment_simd.h; segment.h: 36), its
 * extinction, length and colours, each from interpolation, 16; the product of transmittances and the sum of colours over a block of 64 segments
 * 4 · 64; sums over blocks, of which there are segments / 64, 2 each, and once more through the depth. */
static double rounding(int64_t segments) { return (512 + (double)segments / 16) * 0x1p-53; }

TcTolerance tc_tolerance_begin(const TcPieces *pieces, double tolerance) {
  TcTolerance result = {.thin = -1, .opaque = TC_OPAQUE_DEPTH, .color = fmax(pieces->largest[0], fmax(pieces->largest[1], pieces->largest[2]))};
  const double largest = fmax(1, result.color), spare = tolerance - rounding(1 << 14) * largest;
  if (!(spare > 0)) return result; /* rounding alone may take that much */
  /* tc_segment_thin() is off by less than T⁴/90 relative to the opacity, for T ≤ 1/2. */
  result.thin = fmin(0.5, sqrt(sqrt(90 * spare / (4.1 * largest))));
  result.relative = result.thin * result.thin * result.thin * result.thin / 90;
  result.opaque = fmax(0, log(2 * largest) - log(spare)); /* more than is needed when the tolerance is above 1 */
  return result;
}

double tc_tolerance_bound(const TcTolerance *tolerance, const TcLight *light, double alpha, int64_t segments) {
  const double color = fmax(1, tolerance->color);
  const double left = light->stopped ? exp(-light->depth) * color : 0;
  return left + alpha * color * (2 * tolerance->relative / (1 - tolerance->relative) + rounding(segments));
}
