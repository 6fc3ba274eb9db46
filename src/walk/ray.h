/* SPDX-License-Identifier: Apache-2.0 */
/* A ray, and which side of an edge it passes.
 *
 * Rays see a mesh in a space of their own: the ray is an axis, a vertex is a point (x, y) beside it and a depth. Which
 * side of an edge ab the ray passes is the sign of the cross product a × b, decided exactly for the points as they were
 * rounded, and the same from every cell at the edge: there are no cracks and no double hits, and no tolerance is
 * needed. */
#ifndef TC_WALK_RAY_H
#define TC_WALK_RAY_H

#include "volume/volume.h"

/* A ray as it is asked for. It goes from eye + offset along the unit vector `direction`, scaled. The two are kept apart
 * because their sum, far from the coordinates' origin, would be rounded to the spacing of numbers there. */
typedef struct TcLine {
  double eye[3];
  double begin; /* the part of the ray that counts, as distances from eye + offset, scaled */
  double direction[3];
  double end;
  double offset[3];
  double unused; /* so that kernels may read a ray as three times four numbers */
} TcLine;

/* Points' coordinates of magnitude below TC_TINY are zero. Then every x and y is a multiple of 2^−406, their products
 * are multiples of 2^−812, and neither a product nor its rounding error can underflow. */

/* The cross product of the points a and b, where `a` and `b` are the numbers of the vertices, for products that are
 * zero or were rounded to zero. The result is never zero: if the exact product is, it has the sign that it would have
 * if the points were moved by an infinitesimal amount. For b and a it is of the opposite sign. */
double tc_tie(double ax, double ay, uint32_t a, double bx, double by, uint32_t b);

#endif
