/* SPDX-License-Identifier: Apache-2.0 */
/* Ray space: the ray is the z axis, a vertex is a point (x, y) and a depth z. Which side of an edge the ray passes is the sign of a
 * 2-D cross product, decided exactly for the projected points and the same from every cell at the edge: there are no cracks and no
 * double hits, and no tolerance is needed.
 *
 * The shear that takes the ray to the z axis is that of Woop, Benthin, Wald: Watertight ray/triangle intersection, 2013. */
#ifndef TC_TRAVERSE_RAYSPACE_H
#define TC_TRAVERSE_RAYSPACE_H

#include <math.h>

#include "traverse/volume.h"

/* A ray as it is asked for: from eye + offset along the unit vector `direction`, scaled. The two are kept apart because their sum, far
 * from the coordinates' origin, would be rounded to the spacing of numbers there. */
typedef struct TcLine {
  double eye[3], offset[3], direction[3];
} TcLine;

typedef struct TcRay {
  double origin[3];        /* scaled, near the volume; what rounding took from it is in rest_x, rest_y, rest_z */
  double from_center[3];   /* the same from the volume's centre */
  double direction[3];
  double near;             /* depth from which on the ray sees: z ≥ near */
  int kx, ky, kz;          /* kz: the direction's largest component */
  double shear_x, shear_y, inverse_z;
  double rest_x, rest_y, rest_z; /* sheared */
} TcRay;

typedef struct TcPoint {
  double x, y, z, s; /* projected vertex, depth along the ray (scaled length), point value */
  uint32_t id;
} TcPoint;

/* Coordinates, origins and shears smaller than this count as zero. Then every x and y is a multiple of 2^−406, their products are
 * multiples of 2^−812, and neither a product nor its rounding error can underflow. */
#define TC_TINY 0x1p-150

static inline double tc_without_tiny(double x) { return fabs(x) < TC_TINY ? 0 : x; }

/* The ray with its origin moved to where it is nearest to the volume's centre. False when it passes the volume's sphere. */
bool tc_ray_begin(const TetcastVolume *volume, const TcLine *line, TcRay *ray);

static inline TcPoint tc_project(const TetcastVolume *volume, const TcRay *ray, uint32_t id) {
  double record[4], p[3];
  tc_volume_vertex(volume, id, record);
  for (int k = 0; k < 3; ++k) p[k] = record[k] - ray->origin[k];
  TcPoint point;
  point.x = p[ray->kx] - ray->shear_x * p[ray->kz] - ray->rest_x;
  point.y = p[ray->ky] - ray->shear_y * p[ray->kz] - ray->rest_y;
  point.z = p[ray->kz] * ray->inverse_z - ray->rest_z;
  point.s = record[3];
  point.id = id;
  return point;
}

/* a b − p, exactly, where p is a b rounded; the latter's rounding error may not underflow. */
static inline double tc_product_error(double a, double b, double p) {
#ifdef FP_FAST_FMA
  return fma(a, b, -p);
#else /* Dekker, Veltkamp: halves of 26 bits, whose products are exact. |a|, |b| < 2^995 */
  const double c = 0x1.0000002p27 * a, d = 0x1.0000002p27 * b;
  const double a_high = c - (c - a), a_low = a - a_high, b_high = d - (d - b), b_low = b - b_high;
  return ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low;
#endif
}

double tc_edge_tie(const TcPoint *a, const TcPoint *b);

/* a × b to a relative error of 2^−51 (of 1/2 where it is less than 2^−104 of its products), never zero, with the exact sign for the points
 * given; where it is exactly zero, the sign for points moved by an infinitesimal amount (tc_edge_tie). tc_edge(a, b) = −tc_edge(b, a).
 *
 * The errors of the two products are added to their difference e. If the products are within a factor of two, e is exact (Sterbenz), as
 * is the sum of the errors but for its last bit; else e is at least half of the larger product and the errors are below its last bits.
 * That edges have relative accuracy matters: they are the weights of depth and value, also on faces that are seen almost edge-on, where
 * all three nearly cancel. */
static inline double tc_edge(const TcPoint *a, const TcPoint *b) {
  const double p = a->x * b->y, q = a->y * b->x;
  const double e = (p - q) + (tc_product_error(a->x, b->y, p) - tc_product_error(a->y, b->x, q));
  return e != 0 ? e : tc_edge_tie(a, b);
}

/* Whether the ray crosses a triangle whose edges ab, bc, ca have these values. */
static inline bool tc_inside(double ab, double bc, double ca) { return (ab > 0) == (bc > 0) && (bc > 0) == (ca > 0); }

/* Depth and value where the ray crosses the triangle abc: the edges' values are the barycentric weights. */
static inline void tc_crossing(const TcPoint *a, const TcPoint *b, const TcPoint *c, double ab, double bc, double ca, double *z,
                               double *s) {
  const double inverse = 1 / (ab + bc + ca);
  *z = (bc * a->z + ca * b->z + ab * c->z) * inverse;
  *s = (bc * a->s + ca * b->s + ab * c->s) * inverse;
}

#endif
