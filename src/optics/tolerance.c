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

/* The largest extinction, and the largest slopes. */
typedef struct Slopes {
  double extinction, rise, color_rise;
} Slopes;

static bool has_extinction(const TcPiece *piece) { return piece->at_low.extinction > 0 || piece->at_high.extinction > 0; }

/* Over scalars up to `value` either way; false: it jumps there. */
static bool find_slopes(const TcPieces *pieces, double value, Slopes *slopes) {
  const TcPiece *before = NULL;
  *slopes = (Slopes){0, 0, 0};
  for (int64_t i = 0; i <= pieces->count; ++i) {
    const TcPiece *piece = &pieces->pieces[i];
    if (piece->high < -value || piece->low > value) continue;
    slopes->extinction = fmax(slopes->extinction, fmax(piece->at_low.extinction, piece->at_high.extinction));
    slopes->rise = fmax(slopes->rise, fabs(piece->at_high.extinction - piece->at_low.extinction) * piece->inverse);
    if (before && before->at_high.extinction != piece->at_low.extinction) return false;
    for (int k = 0; k < 3 && has_extinction(piece); ++k) {
      slopes->color_rise = fmax(slopes->color_rise, fabs(piece->at_high.color[k] - piece->at_low.color[k]) * piece->inverse);
      if (before && has_extinction(before) && before->at_high.color[k] != piece->at_low.color[k]) return false;
    }
    before = piece;
  }
  return true;
}

bool tc_tolerance_allow_single(const TcPieces *pieces, const TcSteepness *field, double tolerance, TcTolerance *result) {
  const double u = 0x1p-24, radius = field->radius, color = fmax(1, result->color);
  double value = field->value;
  Slopes slopes;
  if (pieces->narrow || pieces->count > 1 << 20 || !find_slopes(pieces, value, &slopes)) return false;
  for (int64_t i = 0; i < pieces->count; ++i) {
    if (pieces->knots[i] >= -field->value && pieces->knots[i] <= field->value) value = fmax(value, fabs(pieces->knots[i]));
  }
  const double most = 0x1p60; /* far from where numbers, or products of some of them, overflow */
  if (!(value < most && slopes.extinction < most && slopes.rise < most && slopes.color_rise < most && color < most)) return false;
  const double moved = 1.5 * u * field->diameter * field->gradient + 32 * u * value + 0x1p-140, eta = 32 * u * radius;
  result->per_shift = 2.1 * color * slopes.extinction; /* e^ε < 1.1: see below */
  result->per_variation = eta * (2.1 * color * slopes.rise + slopes.color_rise * slopes.extinction);
  result->single_fixed = 2.1 * color * slopes.rise * 2 * radius * moved + result->per_shift * (2 * eta + 16 * u * radius) +
                         slopes.color_rise * moved + 400 * u * color;
  result->single_most = fmin(tolerance, 0.09);
  return result->single_fixed <= 0.75 * result->single_most;
}

double tc_tolerance_bound(const TcTolerance *tolerance, const TcLight *light, double alpha, int64_t segments) {
  const double color = fmax(1, tolerance->color);
  const double left = light->stopped ? exp(-light->depth) * color : 0;
  return left + alpha * color * (2 * tolerance->relative / (1 - tolerance->relative) + rounding(segments));
}
