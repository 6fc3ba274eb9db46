/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_SURFACE_H
#define TETCAST_SURFACE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles that bound a body, for the mesher. It is plain memory; the function that fills it says how it is freed. */
typedef struct TetcastSurface {
  /* The number of vertices, ≥ 0. */
  int64_t vertex_count;
  /* [vertex_count][3]: their coordinates, in any unit of length. NULL if there are none. */
  double *vertices;
  /* The number of triangles, ≥ 0. */
  int64_t triangle_count;
  /* [triangle_count][3], each in [0, vertex_count): the vertices of each triangle. NULL if there are none. */
  int64_t *triangles;
  /* The number of cavities, ≥ 0. */
  int64_t hole_count;
  /* [hole_count][3]: a point inside each cavity. NULL if there are none. */
  double *holes;
} TetcastSurface;

#ifdef __cplusplus
}
#endif

#endif
