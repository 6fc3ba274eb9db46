/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_ISOSURFACE_H
#define TETCAST_ISOSURFACE_H

#ifdef __cplusplus
extern "C" {
#endif

#define TETCAST_MAX_ISOSURFACES 256

/* The isosurface s = value of a field of points. In a tetrahedron it is a plane, so where a ray crosses it follows from
 * the scalar at the two faces that the ray crosses; at faces s ≥ value counts as above, and the surface is crossed
 * where the side changes. Both cells at a face have the same scalar there: each crossing is found once and only once.
 * Where all of a cell has just this value, no part of the cell is a surface. */
typedef struct TetcastIsosurface {
  /* The scalar on it, finite, in the field's unit. */
  double value;
  /* Its red, green and blue, each ≥ 0 and finite, not premultiplied. */
  double color[3];
  /* What it hides of what is behind it, from 0 to 1. */
  double opacity;
} TetcastIsosurface;

#ifdef __cplusplus
}
#endif

#endif
