/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_SLICE_H
#define TETCAST_SLICE_H

#ifdef __cplusplus
extern "C" {
#endif

/* Surfaces for context: planes through the mesh, and the mesh's boundary. */

#define TETCAST_MAX_SLICES 8

/* The points x of the mesh with normal · x = offset, in the colours that the scene's transfer function has for the
 * scalar there; no light falls on them. */
typedef struct TetcastSlice {
  /* Perpendicular to the plane; of any length above 0, finite. */
  double normal[3];
  /* Finite; in the unit of the coordinates times that of `normal`. */
  double offset;
  /* What it hides of what is behind it, from 0 to 1. */
  double opacity;
} TetcastSlice;

/* The faces that have a cell on one side only. Light falls on them as on isosurfaces with flat normals. */
typedef struct TetcastBoundary {
  /* What it hides of what is behind it, from 0 to 1; 0: it is not seen. */
  double opacity;
  /* Not 0: it has one colour; 0: those that the scene's transfer function has for the scalar there. */
  int colored;
  /* Red, green and blue, each at least 0 and finite, not premultiplied; used if `colored` says so. */
  double color[3];
  /* Not 0: the edges of its triangles are drawn on it, about a pixel wide, from either side. */
  int edges;
  /* Red, green and blue of these, each at least 0 and finite, not premultiplied; no light falls on them. Used if
   * `edges` says so. */
  double edge_color[3];
} TetcastBoundary;

#ifdef __cplusplus
}
#endif

#endif
