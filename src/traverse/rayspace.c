/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/rayspace.h"

#include <float.h>

/* a + b = *sum + return value, exactly (Knuth). */
static double two_sum(double a, double b, double *sum) {
  const double s = a + b, t = s - a;
  *sum = s;
  return (a - (s - t)) + (b - t);
}

bool tc_ray_begin(const TetcastVolume *volume, const TcLine *line, TcRay *ray) {
  const double *direction = line->direction;
  double along = 0, distance2 = 0, rest[3];
  for (int k = 0; k < 3; ++k) along += (volume->center[k] - line->eye[k] - line->offset[k]) * direction[k];
  /* eye + offset + along · direction, as origin + rest to twice the precision: whatever `along` was rounded to, the point is on the
   * ray, and vertex − origin is as good as the vertex is. */
  for (int k = 0; k < 3; ++k) {
    const double product = along * direction[k];
    double shift;
    rest[k] = tc_product_error(along, direction[k], product);
    rest[k] += two_sum(product, line->offset[k], &shift);
    rest[k] += two_sum(line->eye[k], shift, &ray->origin[k]);
    ray->origin[k] = tc_without_tiny(ray->origin[k]);
    ray->direction[k] = direction[k];
    ray->from_center[k] = ray->origin[k] - volume->center[k] + rest[k];
    distance2 += ray->from_center[k] * ray->from_center[k];
  }
  /* The sphere has a margin that covers the rounding here (volume.c). Written so that NaN passes the volume. */
  if (!(distance2 <= volume->radius * volume->radius) || !(-along <= volume->radius)) return false;
  ray->near = -along;
  ray->kz = 0;
  for (int k = 1; k < 3; ++k) {
    if (fabs(direction[k]) > fabs(direction[ray->kz])) ray->kz = k;
  }
  ray->kx = (ray->kz + 1) % 3;
  ray->ky = (ray->kz + 2) % 3;
  ray->shear_x = tc_without_tiny(direction[ray->kx] / direction[ray->kz]);
  ray->shear_y = tc_without_tiny(direction[ray->ky] / direction[ray->kz]);
  ray->inverse_z = 1 / direction[ray->kz];
  ray->rest_x = tc_without_tiny(rest[ray->kx] - ray->shear_x * rest[ray->kz]);
  ray->rest_y = tc_without_tiny(rest[ray->ky] - ray->shear_y * rest[ray->kz]);
  ray->rest_z = rest[ray->kz] * ray->inverse_z;
  return true;
}

/* Called when the rounded a × b is zero: when its two products are equal, or differ by less than their errors' difference is rounded by.
 *
 * Where a × b is exactly zero, the ray passes exactly through the line ab. It is thought moved by (δ, δ²), and vertex i by (0, i δ³) with
 * an infinitesimal δ (Edelsbrunner & Mücke, Simulation of simplicity, 1990):
 *
 *     (a − δ) × (b − δ) = a × b − δ (b.y − a.y) + δ² (b.x − a.x) + …
 *
 * so that all decisions at all cells belong to one and the same slightly moved ray and mesh, and every step of the walk has exactly
 * one way out. A triangle that is seen exactly edge-on is never crossed. */
double tc_edge_tie(const TcPoint *a, const TcPoint *b) {
  const double p = a->x * b->y, q = a->y * b->x;
  const double p_error = tc_product_error(a->x, b->y, p), q_error = tc_product_error(a->y, b->x, q);
  const double d = p_error - q_error, part = p_error - d;
  const double rest = (p_error - (d + part)) + (part - q_error); /* d + rest = p_error − q_error exactly */
  if (rest != 0) return rest;
  bool positive;
  if (a->y != b->y) positive = b->y < a->y;
  else if (a->x != b->x) positive = b->x > a->x;
  else positive = (a->x > 0) == (b->id > a->id);
  return positive ? DBL_MIN : -DBL_MIN;
}
