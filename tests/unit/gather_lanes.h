/* SPDX-License-Identifier: Apache-2.0 */
#ifndef GATHER_LANES_H
#define GATHER_LANES_H

#include <stdint.h>

#include "optics/transfer.h"

/* Red, green, blue, alpha of `count` segments one after the other, over which a scalar goes from s0 to s1, by the
 * gatherer for emission and some lanes (gather_lanes.c), in each lane the same. In single precision they are rounded to
 * that. */
typedef void GatherLanes(const TcPieces *pieces, const double *length, const double *s0, const double *s1,
                         int64_t count, double rgba[4]);
GatherLanes gather_one, gather_avx2, gather_avx2_f32, gather_avx512, gather_avx512_f32;

#endif
