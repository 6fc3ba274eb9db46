/* SPDX-License-Identifier: Apache-2.0 */
/* How steep a volume's field is at most: what the error of moving its vertices a little is bounded by. */
#ifndef TC_TRAVERSE_STEEPNESS_H
#define TC_TRAVERSE_STEEPNESS_H

#include "traverse/volume.h"

typedef struct TcSteepness {
  double gradient; /* the largest of a cell's |∇s|, scaled; infinite if there is a value that is not finite, or a cell without volume */
  double diameter; /* the longest edge, scaled */
  double value;    /* the largest |s| */
} TcSteepness;

/* Of a volume with clusters and a point field; in parallel. */
TetcastStatus tc_steepness(const TetcastVolume *volume, TcSteepness *steepness);

#endif
