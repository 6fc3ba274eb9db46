/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices as the rays of a packet see them, with a ray in each lane. There are two ways, and a whole frame uses one.
 *
 * On the screen: vertices have been projected for the camera (screen.h), and the ray's place on the screen is
 * subtracted. In perspective, let q = distance / z − 1, and w be the cross products of a face's edges. Then barycentric
 * weights are in proportion to w (1 + q), and the depth of a crossing, from the plane through the volume's centre, is
 * −distance |direction| Σ w q / Σ w (1 + q).
 *
 * In ray space, for any rays: vertices are sheared so that the ray is the z axis (Woop, Benthin, Wald: Watertight
 * ray/triangle intersection, 2013). Barycentric weights are in proportion to w, and the depth of a crossing, from the
 * point of the ray that is nearest to the volume's centre, is Σ w z / Σ w. */
#ifndef TC_WALK_POINTS_H
#define TC_WALK_POINTS_H

#include "base/lanes.h"
#include "volume/rows.h"
#include "walk/features.h"
#include "walk/ray.h"
#include "walk/screen.h"
#include "walk/surfaces.h"

/* What rays are walked through. */
typedef struct TcGround {
  const TcShell *shell;
  const TcRows *values;       /* the scalar; NULL if there is none */
  bool holes;                 /* whether cells are transparent because the scalar has no value at some vertices */
  const TcScreen *screen;     /* how vertices have been projected; NULL if rays are walked in ray space */
  const void *vertices;       /* [vertex_count][4], of TcReal: what vertices are loaded from, on the screen that of
                                 TcScreen, in ray space that of tc_rows_points(); NULL: the volume's own arrays */
  TcResolution resolution;    /* with TC_BOUND: what rounding does to vertices */
  const TcSurfaces *surfaces; /* NULL: there are none, and packets need not know the directions of their rays */
} TcGround;

/* The rays of a packet. */
typedef struct TcRays {
  /* On the screen: the ray's place. */
#if TC_SINGLE
  TcInt x, y;
#else
  TcVec x, y;
#endif
  /* What depths are multiplied with: −distance |direction| in perspective, else 1. */
  TcVec scale;
  /* The interval of depths that counts. */
  TcVec begin, end;
  /* How far off its ends may be, in all. */
  TcVec doubt;
  /* In ray space: the largest component of the directions; kx = (kz + 1) % 3, ky = (kz + 2) % 3. */
  int kz;
  /* In ray space: a point of the ray near the volume, its components along kx, ky and kz. */
  TcVec origin[3];
  /* In ray space: what the rounding of that point took from it, sheared. */
  TcVec rest_x, rest_y, rest_z;
  /* In ray space: the direction's components along kx and ky divided by that along kz, and 1 divided by the latter. */
  TcVec shear_x, shear_y, inverse_z;
} TcRays;

/* A vertex in each lane, as the lane's ray sees it. */
typedef struct TcLanePoints {
  TcVec x, y; /* where the vertex is beside the ray */
  TcVec d;    /* on the screen: d of TcScreen; in ray space: the depth */
  TcVec s;    /* the scalar, if it is one of points */
  TcWord id;  /* the vertex's number */
} TcLanePoints;

/* ── on the screen ── */

TC_INLINE void tc_points_on_screen(const TcVec component[4], const TcRays *rays, TcLanePoints *p) {
#if TC_SINGLE
  /* Differences of integers are exact. Rounding them is relative to the distance from the ray. */
  p->x = tc_to_real(tc_bits_of(component[0]) - rays->x);
  p->y = tc_to_real(tc_bits_of(component[1]) - rays->y);
#else
  p->x = component[0] - rays->x;
  p->y = component[1] - rays->y;
#endif
  p->d = component[2];
  p->s = component[3];
}

/* ── in ray space ── */

#if !TC_SINGLE
/* Shears points, whose components along kx, ky and kz are given, into the space of the rays. */
TC_INLINE void tc_shear(const TcRays *rays, const TcVec component[3], TcLanePoints *p) {
  const TcVec x = component[0] - rays->origin[0], y = component[1] - rays->origin[1],
              z = component[2] - rays->origin[2];
  p->x = x - rays->shear_x * z - rays->rest_x;
  p->y = y - rays->shear_y * z - rays->rest_y;
  p->d = z * rays->inverse_z - rays->rest_z;
}

/* The components of positions along kx, ky and kz. */
TC_INLINE void tc_turn(int kz, const TcVec axis[3], TcVec component[3]) {
  component[0] = kz == 2 ? axis[0] : kz == 1 ? axis[2] : axis[1];
  component[1] = kz == 2 ? axis[1] : kz == 1 ? axis[0] : axis[2];
  component[2] = kz == 2 ? axis[2] : kz == 1 ? axis[1] : axis[0];
}

TC_INLINE void tc_points_in_ray_space(const TcVec axis[4], const TcRays *rays, TcLanePoints *p) {
  TcVec component[3];
  tc_turn(rays->kz, axis, component);
  tc_shear(rays, component, p);
  p->s = axis[3];
}

/* The number that follows the last vertex is there (volume.h), so that four may be read at once. */
TC_NOINLINE void tc_points_of_arrays(const TcGround *ground, const TcRays *rays, const uint32_t id[TC_LANES],
                                     TcLanePoints *p) {
  const TetcastVolume *volume = ground->shell->volume;
  TcVec axis[4], s = tc_set(0);
  if (volume->positions_are_double) {
    const double *at[TC_LANES];
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) at[l] = (const double *)volume->positions + 3 * (size_t)id[l];
    tc_load_records(at, axis);
  } else {
    const float *at[TC_LANES];
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) at[l] = (const float *)volume->positions + 3 * (size_t)id[l];
    tc_load_float_records(at, axis);
  }
  TcVec component[3];
  tc_turn(rays->kz, axis, component);
  if (ground->values && ground->values->association == TETCAST_POINT) {
    for (int l = 0; l < TC_LANES; ++l)
      TC_AT(s, l) = tc_rows_value(ground->values, id[l], 0);
  }
  tc_shear(rays, component, p);
  p->s = s;
}

/* Has the vertices fetched that lanes are about to load. */
TC_NOINLINE void tc_points_expect(const TcGround *ground, const uint32_t id[TC_LANES]) {
  const TetcastVolume *volume = ground->shell->volume;
  const size_t size = 3 * (volume->positions_are_double ? sizeof(double) : sizeof(float));
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l)
      __builtin_prefetch((const char *)volume->positions + size * (size_t)id[l]);
}

/* Loads one vertex for all lanes, without its scalar. */
TC_INLINE void tc_point_in_ray_space(const TcGround *ground, const TcRays *rays, uint32_t id, TcLanePoints *p) {
  const int kx = rays->kz == 2 ? 0 : rays->kz + 1, ky = rays->kz == 0 ? 2 : rays->kz - 1;
  double own[3];
  const double *position = (const double *)ground->vertices + 4 * (size_t)id;
  if (TC_UNLIKELY(!ground->vertices)) {
    tc_volume_vertex(ground->shell->volume, id, own);
    position = own;
  }
  const TcVec component[3] = {tc_set(position[kx]), tc_set(position[ky]), tc_set(position[rays->kz])};
  tc_shear(rays, component, p);
}
#endif

/* Loads a vertex for each lane. */
TC_INLINE void tc_points_load(const TcGround *ground, const TcRays *rays, const uint32_t id[TC_LANES],
                              TcLanePoints *p) {
#if !TC_SINGLE
  if (TC_UNLIKELY(!ground->vertices)) {
    tc_points_of_arrays(ground, rays, id, p);
    p->id = tc_load_word(id);
    return;
  }
#endif
  const TcReal *at[TC_LANES];
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) at[l] = (const TcReal *)ground->vertices + 4 * (size_t)id[l];
  TcVec number[4];
  tc_load_records(at, number);
#if !TC_SINGLE
  if (TC_UNLIKELY(!ground->screen))
    tc_points_in_ray_space(number, rays, p);
  else
#endif
    tc_points_on_screen(number, rays, p);
  p->id = tc_load_word(id);
}

/* Loads one vertex for all lanes. */
TC_INLINE void tc_points_of_one(const TcGround *ground, const TcRays *rays, uint32_t id, TcLanePoints *p) {
#if !TC_SINGLE
  if (TC_UNLIKELY(!ground->screen)) {
    tc_point_in_ray_space(ground, rays, id, p);
    p->s = tc_set(ground->values && ground->values->association == TETCAST_POINT ? tc_rows_value(ground->values, id, 0)
                                                                                 : 0);
    p->id = tc_set_word(id);
    return;
  }
#endif
  const TcReal *at = (const TcReal *)ground->vertices + 4 * (size_t)id;
#if TC_SINGLE
  int32_t x[2];
  memcpy(x, at, sizeof x);
  p->x = tc_to_real(tc_set_int(x[0]) - rays->x);
  p->y = tc_to_real(tc_set_int(x[1]) - rays->y);
#else
  p->x = tc_set(at[0]) - rays->x;
  p->y = tc_set(at[1]) - rays->y;
#endif
  p->d = tc_set(at[2]);
  p->s = tc_set(at[3]);
  p->id = tc_set_word(id);
}

/* Finds where one vertex is beside the rays of all lanes. It may be mirrored at the ray, which changes no cross
 * product. */
TC_INLINE void tc_point_beside(const TcGround *ground, const TcRays *rays, uint32_t id, TcVec *x, TcVec *y) {
#if !TC_SINGLE
  if (TC_UNLIKELY(!ground->screen)) {
    TcLanePoints p;
    tc_point_in_ray_space(ground, rays, id, &p);
    *x = p.x;
    *y = p.y;
    return;
  }
  const TcReal *at = (const TcReal *)ground->vertices + 4 * (size_t)id;
  *x = rays->x - at[0];
  *y = rays->y - at[1];
#else
  int32_t at[2];
  memcpy(at, (const TcReal *)ground->vertices + 4 * (size_t)id, sizeof at);
  *x = tc_to_real(rays->x - at[0]);
  *y = tc_to_real(rays->y - at[1]);
#endif
}

/* ── edges, faces ── */

/* tc_tie() for the lanes of `zero`. */
TC_NOINLINE void tc_edges_tie(const TcLanePoints *a, const TcLanePoints *b, unsigned zero, TcVec *edge) {
  for (; zero; zero &= zero - 1) {
    const int l = __builtin_ctz(zero);
    const double tie = tc_tie((double)TC_AT(a->x, l), (double)TC_AT(a->y, l), TC_AT(a->id, l), (double)TC_AT(b->x, l),
                              (double)TC_AT(b->y, l), TC_AT(b->id, l));
    const TcReal rounded = (TcReal)tie, least = TC_REAL_MIN; /* in single precision it may underflow */
    TC_AT(*edge, l) = tie > 0 ? (rounded > least ? rounded : least) : (rounded < -least ? rounded : -least);
  }
}

/* The lanes in which one of three numbers is zero or, in single precision, may have underflowed. */
TC_INLINE TcMask tc_vanishes(const TcVec e[3]) {
  const TcVec least = tc_min(tc_min(tc_abs(e[0]), tc_abs(e[1])), tc_abs(e[2]));
  return TC_SINGLE ? tc_lt(least, tc_set(TC_REAL_MIN)) : tc_eq(least, tc_set(0));
}

/* Computes the three cross products v[a[k]] × w[b[k]] to a relative error of 2⁻⁵¹ (single precision: 2⁻²²). They are
 * never zero and have the exact sign for the points given (ray.h). The error must be relative, as they are the weights
 * of depth and value, also on faces that are seen almost edge-on, where the products of all three nearly cancel. */
TC_INLINE void tc_edges(TcMask active, const TcLanePoints v[], const TcLanePoints w[], const int a[3], const int b[3],
                        TcVec e[3]) {
  for (int k = 0; k < 3; ++k)
    e[k] = tc_determinant(v[a[k]].x, v[a[k]].y, w[b[k]].x, w[b[k]].y);
  const TcMask zero = tc_and(active, tc_vanishes(e));
  if (TC_LIKELY(!tc_any(zero)))
    return;
  for (int k = 0; k < 3; ++k) {
    const TcLanePoints p = v[a[k]],
                       q = w[b[k]]; /* copies: the originals stay in registers, as nothing takes their address */
    TcVec edge = e[k];
    const TcMask here = TC_SINGLE ? tc_lt(tc_abs(edge), tc_set(TC_REAL_MIN)) : tc_eq(edge, tc_set(0));
    tc_edges_tie(&p, &q, tc_bits(tc_and(zero, here)), &edge);
    e[k] = edge;
  }
}

/* The cross products of a triangle's edges, e[k] being that of the edge opposite v[k]. */
TC_INLINE void tc_edges_of(TcMask active, const TcLanePoints v[3], TcVec e[3]) {
  static const int next[3] = {1, 2, 0}, last[3] = {2, 0, 1};
  tc_edges(active, v, v, next, last, e);
}
/* The cross products of a face's vertices with q: those of the edges from v[k] to q. */
TC_INLINE void tc_edges_to(TcMask active, const TcLanePoints v[3], const TcLanePoints *q, TcVec e[3]) {
  static const int of_v[3] = {0, 1, 2}, of_q[3] = {0, 0, 0};
  tc_edges(active, v, q, of_v, of_q, e);
}

TC_INLINE TcLanePoints tc_select_points(TcMask m, TcLanePoints a, TcLanePoints b) {
  return (TcLanePoints){tc_select(m, a.x, b.x), tc_select(m, a.y, b.y), tc_select(m, a.d, b.d), tc_select(m, a.s, b.s),
                        tc_select_word(m, a.id, b.id)};
}

/* The most that the depth and the scalar of a crossing change if the ray is moved aside by one unit. */
typedef struct TcTilt {
  TcVec z, s;
  TcVec one; /* the same for any value that differs by at most 1 between the face's vertices */
} TcTilt;

/* Where rays cross a face. */
typedef struct TcCrossing {
  TcVec z;              /* the depth */
  TcVec s;              /* the scalar, if it is one of points; it is kept within the range of the vertices' scalars */
  TcVec barycentric[3]; /* with TC_WEIGHTS, TC_CORNERS, TC_SURFACES, TC_LIT: the weights of the vertices */
  TcVec reach;          /* with TC_BOUND: the largest coordinate of the face's vertices beside the ray */
  TcTilt tilt;          /* with TC_BOUND */
} TcCrossing;

TC_INLINE TcVec tc_least3(TcVec a, TcVec b, TcVec c) {
  return tc_min(tc_min(a, b), c);
}
TC_INLINE TcVec tc_most3(TcVec a, TcVec b, TcVec c) {
  return tc_max(tc_max(a, b), c);
}

/* Computes reach and tilt. Let λ be the barycentric weights of the ray's place in the projected face, and p = 1 + q in
 * perspective, else 1. A value f of the vertices is interpolated as Σ λ p f / Σ λ p. Its derivative, when the ray is
 * moved aside, is Σ (f − f₀) p ∇λ / Σ λ p, with f₀ the interpolated value. |∇λ| is at most the face's longest edge
 * divided by twice its area. The edge is shorter than 2 √2 · reach, and twice the area is the sum of the edges' cross
 * products w. So in all, for three vertices, the derivative is at most (range of f) · 8.5 · reach · max(p) / Σ w p. */
TC_INLINE void tc_face_tilt(const unsigned on, bool perspective, const TcRays *rays, const TcLanePoints v[3],
                            TcVec inverse, TcCrossing *c) {
  TcVec across[3];
  for (int k = 0; k < 3; ++k)
    across[k] = tc_max(tc_abs(v[k].x), tc_abs(v[k].y));
  c->reach = tc_most3(across[0], across[1], across[2]);
  const TcVec near = tc_most3(v[0].d, v[1].d, v[2].d), far = tc_least3(v[0].d, v[1].d, v[2].d);
  TcVec factor = (TcReal)8.5 * c->reach * inverse, range = near - far;
  if (perspective) {
    factor *= 1 + near;
    range *= tc_abs(rays->scale) / ((1 + far) * (1 + far));
  }
  c->tilt.one = factor;
  c->tilt.z = factor * range;
  if (on & TC_ASSOCIATIONS)
    return;
  c->tilt.s = factor * (tc_most3(v[0].s, v[1].s, v[2].s) - tc_least3(v[0].s, v[1].s, v[2].s));
}

/* With TC_BOUND: a bound on the length of the ray over which a face that it passes by may lie on its other side, 0 if
 * the face is far enough from it.
 *
 * Let rounding undo itself: vertices go from where they were rounded to back to where they are, each by at most ε
 * beside the ray and δ along it. Where a point of the ray is outside of a cell (or the mesh) before and inside after,
 * or the other way round, a face has passed through it. So such points lie, but for δ at either end, at the depths that
 * faces have within ε of the ray. Of a face that the ray crosses this is what tc_packet_shift() says. One that it
 * passes by within ε is seen edge-on if these depths matter at all: they are at most those of its vertices, and at most
 * 2 ε times the slope of its depth. d of its vertices is linear on the screen, with |∂d/∂x| + |∂d/∂y| = rise / |w|, and
 * the depth z = scale d, in perspective scale d / (1 + d), whose derivative is scale / (1 + d)².
 *
 * The face is farther than ε if its vertices lie beyond ε on one side, in x, in y, or across one of its edges. With e
 * the cross product of an edge's ends, and w the sum of all three, the place of the ray across that edge is e where the
 * edge is at 0 and the third vertex at w. The sum's rounding is below 2⁻⁵⁰ (single precision: 2⁻²¹)
 * times the largest of them. */
TC_NOINLINE void tc_graze_face(const TcGround *ground, const TcRays *rays, const TcLanePoints v[3], TcVec *length) {
  const TcVec zero = tc_set(0);
  TcVec e[3], z[3], most = zero, reach = zero;
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    e[k] = tc_determinant(v[k].x, v[k].y, v[next].x, v[next].y);
    most = tc_max(most, tc_abs(e[k]));
    reach = tc_max(reach, tc_max(tc_abs(v[k].x), tc_abs(v[k].y)));
  }
  const TcVec rounding = most * (TcReal)(TC_SINGLE ? 0x1p-21 : 0x1p-50), w = e[0] + e[1] + e[2];
  const TcVec beside =
      tc_madd(tc_set((TcReal)(1.5 * ground->resolution.relative)), reach, tc_set((TcReal)ground->resolution.beside));
  const TcVec low = tc_min(w, zero) - rounding, high = tc_max(w, zero) + rounding;
  TcMask near =
      tc_and(tc_le(tc_least3(v[0].x, v[1].x, v[2].x), beside), tc_le(-beside, tc_most3(v[0].x, v[1].x, v[2].x)));
  near = tc_and(
      near, tc_and(tc_le(tc_least3(v[0].y, v[1].y, v[2].y), beside), tc_le(-beside, tc_most3(v[0].y, v[1].y, v[2].y))));
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    const TcVec margin = beside * (tc_abs(v[k].x - v[next].x) + tc_abs(v[k].y - v[next].y));
    near = tc_and(near, tc_and(tc_le(low - margin, e[k]), tc_le(e[k], high + margin)));
  }
  if (TC_LIKELY(!tc_any(near))) {
    *length = zero;
    return;
  }
  const bool perspective = ground->screen && ground->screen->perspective;
  for (int k = 0; k < 3; ++k)
    z[k] = rays->scale * (perspective ? v[k].d / (1 + v[k].d) : v[k].d);
  const TcVec first = tc_least3(z[0], z[1], z[2]), last = tc_most3(z[0], z[1], z[2]), range = last - first;
  const TcVec d1 = v[1].d - v[0].d, d2 = v[2].d - v[0].d;
  TcVec rise =
      tc_abs(d1 * (v[2].y - v[0].y) - d2 * (v[1].y - v[0].y)) + tc_abs(d1 * (v[2].x - v[0].x) - d2 * (v[1].x - v[0].x));
  rise += (TcReal)(TC_SINGLE ? 0x1p-19 : 0x1p-48) * reach * tc_max(tc_abs(d1), tc_abs(d2));
  TcVec slope = tc_abs(rays->scale) * rise / tc_max(tc_abs(w) - rounding, zero);
  if (perspective) {
    const TcVec far = 1 + tc_least3(v[0].d, v[1].d, v[2].d);
    slope /= far * far;
  }
  const TcVec tilted = 2 * beside * slope;
  /* What lies outside of the ray's interval doesn't count. An area of 0 has a slope that is infinite or NaN. */
  const TcVec counts = tc_min(last, rays->end) - tc_max(first, rays->begin);
  const TcVec depths = tc_select(tc_lt(tilted, range), tc_min(tilted, counts), counts) +
                       (2 * (TcReal)ground->resolution.depth + rays->doubt);
  *length = tc_select(near, tc_max(depths, zero), zero);
}

/* Computes where rays cross a face with vertices v; the weight of each is the cross product of the two others. */
TC_INLINE void tc_cross_face(const unsigned on, const TcGround *ground, const TcRays *rays, const TcLanePoints v[3],
                             const TcVec weight[3], TcCrossing *c) {
  const bool perspective = ground->screen && ground->screen->perspective;
  TcVec w[3] = {weight[0], weight[1], weight[2]};
  const TcVec n = tc_madd(w[0], v[0].d, tc_madd(w[1], v[1].d, w[2] * v[2].d));
  if (perspective) {
    for (int k = 0; k < 3; ++k)
      w[k] = tc_madd(w[k], v[k].d, w[k]);
  }
  const TcVec inverse = 1 / (w[0] + w[1] + w[2]);
  c->z = n * inverse * rays->scale;
  if (on & (TC_WEIGHTS | TC_CORNERS | TC_SURFACES | TC_LIT)) {
    for (int k = 0; k < 3; ++k)
      c->barycentric[k] = w[k] * inverse;
  }
  if (on & TC_BOUND)
    tc_face_tilt(on, perspective, rays, v, inverse, c);
  if (on & TC_ASSOCIATIONS)
    return;
  const TcVec value = tc_madd(w[0], v[0].s, tc_madd(w[1], v[1].s, w[2] * v[2].s)) * inverse;
  /* With the operands in this order, NaN stays NaN. */
  c->s = tc_max(tc_least3(v[0].s, v[1].s, v[2].s), tc_min(tc_most3(v[0].s, v[1].s, v[2].s), value));
}

#endif
