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

static double depth_of(const TcGathered *g, int i) {
  (void)i;
  return g->sums[5] > 0 ? ldexp(g->sums[4] / g->sums[5], g->exponent) : INFINITY;
}

/* Of several samples the normals are added up. */
static double normal_of(const TcGathered *g, int i) {
  const double *n = g->sums + 6, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return length > 0 ? n[i] / length : 0;
}

static double cells_of(const TcGathered *g, int i) {
  (void)i;
  return *g->cells;
}

const TcChannel tc_channels[TC_CHANNELS] = {
    {{TETCAST_CHANNEL_RADIANCE, .name = "radiance", .file_name = "radiance", .of_groups = 1, .needs_coefficients = 1,
      .description = "radiance, in the emission's unit times length"},
     radiance_of},
    {{TETCAST_CHANNEL_OPTICAL_DEPTH, .name = "optical_depth", .file_name = "optical_depth", .of_groups = 1,
      .needs_coefficients = 1, .description = "optical depth through all of the mesh"},
     optical_depth_of},
    {{TETCAST_CHANNEL_TRANSMITTANCE, .name = "transmittance", .file_name = "transmittance", .of_groups = 1,
      .needs_coefficients = 1, .description = "exp(-optical depth)"},
     transmittance_of},
    {{TETCAST_CHANNEL_PATH_LENGTH, .name = "path_length", .file_name = "path_length", .components = 1,
      .needs_coefficients = 1, .description = "length of the ray in cells, in the mesh's unit"},
     path_length_of},
    {{TETCAST_CHANNEL_ERROR, .name = "error", .file_name = "error", .components = 1,
      .description = "bound on the error of red, green, blue and alpha"},
     error_of},
    {{TETCAST_CHANNEL_VALUE, .name = "value", .file_name = "value", .components = 1, .needs_blend = 1,
      .description = "value along the ray in a blend mode, NaN: it meets nothing"},
     value_of},
    {{TETCAST_CHANNEL_DEPTH, .name = "depth", .file_name = "Z", .components = 1, .needs_composite = 1,
      .description = "distance at which alpha exceeds 1/2, or of the first surface that is half opaque"},
     depth_of},
    {{TETCAST_CHANNEL_NORMAL, .name = "normal", .file_name = "N", .components = 3, .needs_composite = 1,
      .description = "normal of the surface at which the depth lies, unit vector towards the eye, else 0"},
     normal_of},
    {{TETCAST_CHANNEL_CELLS, .name = "cells", .file_name = "cells", .components = 1,
      .description = "how many cells the ray crosses"},
     cells_of},
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
