/* SPDX-License-Identifier: Apache-2.0 */
/* walk.h for a packet of rays, a ray a lane: the same arithmetic in the same order, so the same bits. (Fused multiply-adds would save
 * four operations of two hundred, and bias depths: over 10⁵ cells to 8e-14 of the optical depth in place of 6e-15. Edges by Kahan's
 * difference of products would save nine, a fiftieth of a frame, and differ in the last bit from what can be had without them.) */
#ifndef TC_RENDER_PACKET_WALK_H
#define TC_RENDER_PACKET_WALK_H

#include "base/simd.h"
#include "traverse/rayspace.h"

/* Rays with the same kz. */
typedef struct TcRays {
  TcVec origin[3]; /* along kx, ky, kz */
  TcVec shear_x, shear_y, inverse_z, rest_x, rest_y, rest_z, near;
  int kz;
} TcRays;

typedef struct TcPoints {
  TcVec x, y, z, s;
  TcWord id;
} TcPoints;

/* As TcWalk. */
typedef struct TcWalks {
  TcPoints v[3];
  TcVec edge[3], z, s;
  TcWord cell;
} TcWalks;

/* The records of vertices `id`: components along kx, ky, kz, and values. `wide` and the like are constants wherever these functions are used. */
TC_INLINE void tc_load_vertices(const TetcastVolume *volume, const bool wide, int kz, TcWord id, TcVec component[4]) {
  if (wide) {
    TcRecord record[TC_LANES];
    for (int i = 0; i < TC_LANES; ++i) memcpy(&record[i], (const double *)volume->vertices + 4 * (size_t)id[i], sizeof record[i]);
    tc_transpose(record, component);
    tc_turn(kz, component);
  } else {
    TcNarrow record[TC_LANES];
    for (int i = 0; i < TC_LANES; ++i) memcpy(&record[i], (const float *)volume->vertices + 4 * (size_t)id[i], sizeof record[i]);
    tc_transpose_narrow(record, kz, component);
  }
}

TC_INLINE TcRecord tc_load_record(const TetcastVolume *volume, uint32_t id) {
  TcRecord record;
  TcNarrow narrow;
  if (volume->vertices_are_double) {
    memcpy(&record, (const double *)volume->vertices + 4 * (size_t)id, sizeof record);
  } else {
    memcpy(&narrow, (const float *)volume->vertices + 4 * (size_t)id, sizeof narrow);
    record = __builtin_convertvector(narrow, TcRecord);
  }
  return record;
}

TC_INLINE TcPoints tc_project_components(const TcRays *rays, const TcVec component[4], TcWord id) {
  const TcVec x = component[0] - rays->origin[0], y = component[1] - rays->origin[1], z = component[2] - rays->origin[2];
  return (TcPoints){x - rays->shear_x * z - rays->rest_x, y - rays->shear_y * z - rays->rest_y, z * rays->inverse_z - rays->rest_z,
                    component[3], id};
}

/* tc_edge_tie() for the lanes of `zero`. */
static __attribute__((noinline)) TcVec tc_edges_tie(const TcPoints *a, const TcPoints *b, TcVec e, unsigned zero) {
  for (; zero; zero &= zero - 1) {
    const int i = __builtin_ctz(zero);
    const TcPoint c = {a->x[i], a->y[i], 0, 0, a->id[i]}, d = {b->x[i], b->y[i], 0, 0, b->id[i]};
    e[i] = tc_edge_tie(&c, &d);
  }
  return e;
}

/* tc_edge() of three pairs at once. */
TC_INLINE void tc_edges(TcMask active, const TcPoints *const a[3], const TcPoints *const b[3], TcVec e[3]) {
  TcMask zero[3];
  for (int k = 0; k < 3; ++k) {
    const TcVec p = a[k]->x * b[k]->y, q = a[k]->y * b[k]->x;
    e[k] = (p - q) + (tc_product_errors(a[k]->x, b[k]->y, p) - tc_product_errors(a[k]->y, b[k]->x, q));
    zero[k] = tc_eq(e[k], tc_set(0));
  }
  if (!tc_any(tc_and(active, tc_or(tc_or(zero[0], zero[1]), zero[2])))) return;
  for (int k = 0; k < 3; ++k) {
    const unsigned ties = tc_bits(tc_and(active, zero[k]));
    if (!ties) continue;
    const TcPoints c = *a[k], d = *b[k];
    e[k] = tc_edges_tie(&c, &d, e[k], ties);
  }
}

/* `cells`, as in the rest of this file: the field is one of cells, and vertices have no value. */
TC_INLINE void tc_crossings(const bool cells, const TcPoints v[3], const TcVec edge[3], TcVec *z, TcVec *s) {
  const TcVec inverse = 1 / (edge[0] + edge[1] + edge[2]);
  *z = (edge[1] * v[0].z + edge[2] * v[1].z + edge[0] * v[2].z) * inverse;
  if (!cells) *s = (edge[1] * v[0].s + edge[2] * v[1].s + edge[0] * v[2].s) * inverse;
}

TC_INLINE TcPoints tc_select_points(const bool cells, TcMask m, TcPoints a, TcPoints b) {
  return (TcPoints){tc_select(m, a.x, b.x), tc_select(m, a.y, b.y), tc_select(m, a.z, b.z), cells ? b.s : tc_select(m, a.s, b.s),
                    tc_select_word(m, a.id, b.id)};
}

/* Sets the lanes of `mask` out from shell faces. */
TC_INLINE void tc_walks_begin(const TcShell *shell, const bool wide, const bool cells, const TcRays *rays, TcMask mask,
                              const uint32_t face[TC_LANES], TcWalks *walks) {
  TcWord id[3] = {{0}, {0}, {0}}, cell = {0};
  unsigned lanes = tc_bits(mask);
  for (; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const TcShellFace *first = &shell->faces[face[i]];
    for (int k = 0; k < 3; ++k) id[k][i] = first->vertex[k];
    cell[i] = first->cell;
  }
  TcPoints v[3];
  for (int k = 0; k < 3; ++k) {
    TcVec component[4];
    tc_load_vertices(shell->volume, wide, rays->kz, id[k], component);
    v[k] = tc_project_components(rays, component, id[k]);
  }
  TcVec e[3];
  tc_edges(mask, (const TcPoints *const[]){&v[0], &v[1], &v[2]}, (const TcPoints *const[]){&v[1], &v[2], &v[0]}, e);
  const TcMask turn = tc_lt(e[0], tc_set(0)); /* clockwise: v[1] and v[2] change places */
  const TcPoints second = tc_select_points(cells, turn, v[2], v[1]), third = tc_select_points(cells, turn, v[1], v[2]);
  const TcVec edge[3] = {tc_select(turn, -e[2], e[0]), tc_select(turn, -e[1], e[1]), tc_select(turn, -e[0], e[2])};
  walks->v[0] = tc_select_points(cells, mask, v[0], walks->v[0]);
  walks->v[1] = tc_select_points(cells, mask, second, walks->v[1]);
  walks->v[2] = tc_select_points(cells, mask, third, walks->v[2]);
  for (int k = 0; k < 3; ++k) walks->edge[k] = tc_select(mask, edge[k], walks->edge[k]);
  walks->cell = tc_select_word(mask, cell, walks->cell);
  tc_crossings(cells, walks->v, walks->edge, &walks->z, &walks->s);
}

/* A step of walks comes in three parts, which several packets take by turns: each waits for what the one before loads or decides, and in
 * the meantime the other packets go on. */
typedef struct TcStep {
  TcFives cells; /* XOR of vertices, neighbours */
  TcPoints q;    /* the vertices opposite the faces */
} TcStep;

/* One of the cell's neighbours comes next, and is fetched until then: for one ray, as those beside it are in the same cells mostly. */
TC_INLINE void tc_expect_neighbors(const uint32_t *cells, uint32_t cell) {
  const uint32_t *neighbor = cells + 5 * (size_t)cell + 1;
  for (int k = 0; k < 4; ++k) __builtin_prefetch(cells + 5 * (size_t)(neighbor[k] & ~TC_SHELL));
}

TC_INLINE void tc_step_cells(const TetcastVolume *volume, TcMask active, const TcWalks *walks, TcStep *step) {
  const uint32_t *cells = (const uint32_t *)(const void *)volume->adjacency.cells;
  const TcWord zero = {0};
  const TcWord at = tc_select_word(active, walks->cell, zero);
  step->cells = tc_load_fives(cells, at);
  tc_expect_neighbors(cells, at[0]);
  step->q.id = tc_select_word(active, tc_fives_first(&step->cells) ^ walks->v[0].id ^ walks->v[1].id ^ walks->v[2].id, zero);
}

TC_INLINE void tc_step_vertices(const TetcastVolume *volume, const bool wide, const TcRays *rays, TcStep *step) {
  TcVec component[4];
  tc_load_vertices(volume, wide, rays->kz, step->q.id, component);
  step->q = tc_project_components(rays, component, step->q.id);
}

/* Crosses the cells in the lanes of `active`, where `cell` becomes what is behind, TC_SHELL | face included. Returns the lanes that
 * found no way out. */
TC_INLINE TcMask tc_step_out(const bool cells, TcMask active, const TcStep *step, TcWalks *walks) {
  TcPoints *v = walks->v;
  const TcPoints q = step->q;
  TcVec e[3];
  tc_edges(active, (const TcPoints *const[]){&v[0], &v[1], &v[2]}, (const TcPoints *const[]){&q, &q, &q}, e);
  TcMask positive[3], out[3];
  for (int k = 0; k < 3; ++k) positive[k] = tc_and(active, tc_gt(e[k], tc_set(0)));
  for (int k = 0; k < 3; ++k) out[k] = tc_and_not(positive[(k + 2) % 3], positive[(k + 1) % 3]);
  const TcWord left = tc_select_word(out[0], v[0].id, tc_select_word(out[1], v[1].id, v[2].id));
  /* The neighbour has the rank of `left` among the four. */
  const TcWord minus_rank = (tc_above(left, q.id) + tc_above(left, v[0].id)) + (tc_above(left, v[1].id) + tc_above(left, v[2].id));
  walks->cell = tc_select_word(active, tc_fives_ranked(&step->cells, minus_rank), walks->cell);
  for (int k = 0; k < 3; ++k) {
    const TcVec edge = tc_select(out[(k + 1) % 3], e[k], walks->edge[k]);
    walks->edge[k] = tc_select(out[k], -e[(k + 1) % 3], edge);
    v[k] = tc_select_points(cells, out[k], q, v[k]);
  }
  tc_crossings(cells, v, walks->edge, &walks->z, &walks->s);
  return tc_and_not(active, tc_or(tc_or(out[0], out[1]), out[2]));
}

#endif
