/* SPDX-License-Identifier: Apache-2.0 */
/* How steep a volume's field is at most: what the error of moving its vertices a little is bounded by. */
#ifndef TC_TRAVERSE_STEEPNESS_H
#define TC_TRAVERSE_STEEPNESS_H

#include "optics/tolerance.h"
#include "traverse/volume.h"

/* Of a volume with clusters and a point field; in parallel. */
TetcastStatus tc_steepness(const TetcastVolume *volume, TcSteepness *steepness);

#endif
