/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_SURFACE_H
#define TETCAST_SURFACE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles that bound a body, for the mesher. Plain memory; who fills it says how it is freed. */
typedef struct TetcastSurface {
  int64_t vertex_count;
  double *vertices; /* [vertex_count][3] */
  int64_t triangle_count;
  int64_t *triangles; /* [triangle_count][3], each in [0, vertex_count) */
  int64_t hole_count;
  double *holes; /* [hole_count][3]: a point inside each cavity; NULL if there are none */
} TetcastSurface;

#ifdef __cplusplus
}
#endif

#endif
