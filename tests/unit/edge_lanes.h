/* SPDX-License-Identifier: Apache-2.0 */
#ifndef EDGE_LANES_H
#define EDGE_LANES_H

#include <stdint.h>

/* A vertex beside a ray. */
typedef struct EdgePoint {
  double x, y;
  uint32_t id;
} EdgePoint;

/* The cross products a[i] × b[i] by the kernels' code for some lanes (edge_lanes.c). */
typedef void EdgeLanes(const EdgePoint *a, const EdgePoint *b, int64_t count, double *edge);
EdgeLanes edge_one, edge_avx2, edge_avx2_f32, edge_avx512, edge_avx512_f32;

#endif
