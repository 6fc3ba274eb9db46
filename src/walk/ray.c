/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/ray.h"

#include <float.h>

#include "base/exact.h"

/* Where a × b is exactly zero, the ray passes exactly through the line ab. It is thought moved by (δ, δ²), and vertex i
 * by (0, i δ³) with an infinitesimal δ (Edelsbrunner & Mücke, Simulation of simplicity, 1990):
 *
 *     (a − δ) × (b − δ) = a × b − δ (b.y − a.y) + δ² (b.x − a.x) + …
 *
 * so that all decisions at all cells belong to one and the same slightly moved ray and mesh, and every step of the walk
 * has exactly one way out. A triangle that is seen exactly edge-on is never crossed.
 *
 * The numbers only decide about two vertices that are seen at the same place. A triangle that has both is seen edge-on,
 * and the cross products of its other two edges are of opposite signs; and of three at the same place, numbers are not
 * cyclic. So which triangles are crossed does not depend on how vertices are numbered, and parts of a mesh that number
 * theirs each for itself agree. */
double tc_tie(double ax, double ay, uint32_t a, double bx, double by, uint32_t b) {
  const double p = ax * by, q = ay * bx;
  const double p_error = tc_product_error(ax, by, p), q_error = tc_product_error(ay, bx, q);
  if (p != q)
    return (p - q) + (p_error - q_error); /* so different that the errors don't count */
  const double d = p_error - q_error, part = p_error - d;
  const double rest = (p_error - (d + part)) + (part - q_error); /* d + rest = p_error − q_error exactly */
  if (d + rest != 0)
    return d + rest;
  bool positive;
  if (ay != by)
    positive = by < ay;
  else if (ax != bx)
    positive = bx > ax;
  else
    positive = (ax > 0) == (b > a);
  return positive ? DBL_MIN : -DBL_MIN;
}
