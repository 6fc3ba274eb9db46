/* SPDX-License-Identifier: Apache-2.0 */
/* The one table of a frame's channels. */
#ifndef TC_RENDER_CHANNELS_H
#define TC_RENDER_CHANNELS_H

#include <tetcast/frame.h>

#include "optics/transfer.h"
#include "volume/coefficients.h"

enum { TC_CHANNELS = 9 };

/* What a pixel's values are made from. */
typedef struct TcGathered {
  /* The sums that its rays have gathered (gather/emission.h, coefficients.h, value.h), as means over its samples. */
  const double *sums;
  const double *cells;                /* the number of cells that they have crossed; NULL: not counted */
  const TcCoefficients *coefficients; /* NULL with a transfer function or a blend mode */
  const TcPieces *colors;             /* the colours of values in a blend mode; NULL without one */
  int value_exponent;                 /* in a blend mode: values are stored times 2^−value_exponent */
  bool single;                        /* values are rounded to single precision before they are coloured */
  int exponent;                       /* the volume's unit of length is 2^exponent of the mesh's */
  bool bounded;                       /* whether the last sum is a bound on the error of red, green, blue, alpha */
  double error;                       /* a bound on the error of red, green, blue, alpha */
} TcGathered;

typedef struct TcChannel {
  TetcastChannelInfo info;
  /* A pixel's value of group i, its component i, or with i = 0 its only value. */
  double (*value)(const TcGathered *gathered, int i);
} TcChannel;

extern const TcChannel tc_channels[TC_CHANNELS];

/* The colour of a value, times alpha, and alpha. All are 0 if there is no value. */
void tc_color_value(const TcPieces *colors, double value, double alpha, double rgba[4]);

/* Computes red, green, blue and alpha of a pixel. Returns the bound on their error, NaN if it isn't known. */
double tc_gathered_pixel(const TcGathered *gathered, double rgba[4]);

#endif
