/* SPDX-License-Identifier: Apache-2.0 */
#include "render/channels.h"

#include <math.h>

static double error_of(const TcGathered *g, int i) {
  (void)i;
  return g->error;
}

/* Radiance is gathered in the volume's unit of length and in units of 2^emission_exponent. */
static double radiance_of(const TcGathered *g, int i) {
  return ldexp(g->sums[3 * i], g->exponent + g->coefficients->emission_exponent);
}
static double optical_depth_of(const TcGathered *g, int i) {
  return g->sums[3 * i + 1];
}
static double transmittance_of(const TcGathered *g, int i) {
  return g->sums[3 * i + 2];
}

static double path_length_of(const TcGathered *g, int i) {
  (void)i;
  return ldexp(g->sums[3 * g->coefficients->groups], g->exponent);
}

static double value_of(const TcGathered *g, int i) {
  (void)i;
  return g->sums[1] > 0 ? ldexp(g->sums[0] / g->sums[1], g->value_exponent) : NAN;
}

const TcChannel tc_channels[TC_CHANNELS] = {
    {{TETCAST_CHANNEL_RADIANCE, "radiance", "radiance, in the emission's unit times length", 1, 1, 0}, radiance_of},
    {{TETCAST_CHANNEL_OPTICAL_DEPTH, "optical_depth", "optical depth through all of the mesh", 1, 1, 0},
     optical_depth_of},
    {{TETCAST_CHANNEL_TRANSMITTANCE, "transmittance", "exp(-optical depth)", 1, 1, 0}, transmittance_of},
    {{TETCAST_CHANNEL_PATH_LENGTH, "path_length", "length of the ray in cells, in the mesh's unit", 0, 1, 0},
     path_length_of},
    {{TETCAST_CHANNEL_ERROR, "error", "bound on the error of red, green, blue and alpha", 0, 0, 0}, error_of},
    {{TETCAST_CHANNEL_VALUE, "value", "value along the ray in a blend mode, NaN: it meets nothing", 0, 0, 1}, value_of},
};

void tc_color_value(const TcPieces *colors, double value, double alpha, double rgba[4]) {
  const bool any = alpha > 0 && !isnan(value);
  const TcOptics at = any ? tc_pieces_at(colors, value) : (TcOptics){0};
  for (int k = 0; k < 3; ++k)
    rgba[k] = at.color[k] * alpha;
  rgba[3] = alpha;
}

double tc_gathered_pixel(const TcGathered *g, double rgba[4]) {
  const TcCoefficients *c = g->coefficients;
  if (g->colors) {
    const double value = value_of(g, 0), alpha = g->sums[1];
    tc_color_value(g->colors, g->single ? (double)(float)value : value, g->single ? (double)(float)alpha : alpha, rgba);
    return NAN;
  }
  if (!c) {
    for (int k = 0; k < 4; ++k)
      rgba[k] = g->sums[k];
    return g->bounded ? g->sums[4] : NAN;
  }
  double mean = 0;
  for (int i = 0; i < c->groups; ++i)
    mean += radiance_of(g, i) / c->groups; /* the sum might overflow */
  for (int k = 0; k < 3; ++k)
    rgba[k] = c->groups == 3 ? radiance_of(g, k) : mean;
  rgba[3] = g->sums[3 * c->groups + 1];
  return g->bounded ? g->sums[3 * c->groups + 2] : NAN;
}
