/* SPDX-License-Identifier: Apache-2.0 */
/* The one table of a frame's channels. */
#ifndef TC_RENDER_CHANNELS_H
#define TC_RENDER_CHANNELS_H

#include <tetcast/frame.h>

#include "optics/transfer.h"
#include "volume/coefficients.h"

enum { TC_CHANNELS = 6 };

/* What a pixel's values are made from: what was gathered, as means over its samples (gather/emission.h,
 * gather/coefficients.h, gather/value.h). */
typedef struct TcGathered {
  const double *sums;
  const TcCoefficients *coefficients; /* NULL: a transfer function */
  const TcPieces *colors;             /* of values, in a blend mode; NULL: none */
  int value_exponent;                 /* of their unit */
  bool single;                        /* colours are those of values as single precision holds them */
  int exponent;                       /* of the volume's unit of length */
  bool bounded;                       /* the last sum is a bound on the error of red, green, blue, alpha */
  double error;                       /* bound on that of red, green, blue, alpha */
} TcGathered;

typedef struct TcChannel {
  TetcastChannelInfo info;
  /* Value i of a pixel: of group i, or i = 0. */
  double (*value)(const TcGathered *gathered, int i);
} TcChannel;

extern const TcChannel tc_channels[TC_CHANNELS];

/* The colour of a value, times alpha, and alpha; nothing where there is no value. */
void tc_color_value(const TcPieces *colors, double value, double alpha, double rgba[4]);

/* Red, green, blue, alpha of a pixel, and the bound on their error; NaN: not known. */
double tc_gathered_pixel(const TcGathered *gathered, double rgba[4]);

#endif
