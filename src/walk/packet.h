/* SPDX-License-Identifier: Apache-2.0 */
/* The walk of a packet of rays: each ray enters at a face of the shell (shell.h) and goes from cell to cell to the face
 * of the shell where it leaves. The cells that a ray meets form paths. Each face joins at most two cells, so a path
 * that starts at the shell can't return to a cell that it has been to, and ends at the shell. Hence the walk terminates
 * on any adjacency, and every path can be found from either end.
 *
 * A step is a chain in which each part needs the result of the part before: the cell names a vertex, the vertex's
 * position decides on which side of three edges the ray passes, and these name the next cell. Each part also waits for
 * memory. So that the processor has something to do meanwhile, several packets take their parts by turns. */
#ifndef TC_WALK_PACKET_H
#define TC_WALK_PACKET_H

#include "volume/shell.h"
#include "walk/hits.h"
#include "walk/points.h"

typedef struct TcPacket {
  TcRays rays;
  /* The vertices of the face where each ray is, counter-clockwise around the ray. */
  TcLanePoints v[3];
  /* For each of these vertices the cross product of the two others, which is > 0. */
  TcVec weight[3];
  /* Where each ray crosses its face. */
  TcCrossing at;
  /* With TC_BOUND: the sum of the errors of the depths at which what is seen jumps. */
  TcVec shift;
  /* The depth up to which each ray has been seen. */
  TcVec seen;
  /* The lanes that are walking. */
  TcMask active;

  /* What follows is kept in memory for each lane, as scalar instructions work on it. */

  /* The cell ahead. Lanes that rest have the cell after the last one, from which no neighbour leads on. */
  _Alignas(64) uint32_t cell[TC_LANES];
  /* The XOR of the indices of the face's vertices. */
  uint32_t face[TC_LANES];
  /* The vertex of the cell ahead that is not in the face. */
  uint32_t vertex[TC_LANES];
  /* The cell that was crossed last. */
  uint32_t from[TC_LANES];
  /* The cell and the face at the end of the last path. */
  uint32_t exit_cell[TC_LANES], exit_face[TC_LANES];

  /* Sets of lanes, one bit each. */

  /* Lanes that have a ray. */
  unsigned lanes;
  /* Lanes that are at the end of a path, until tc_packet_arrive() looks for their next one. */
  unsigned waiting;
  /* Lanes that begin a path with the next step. */
  unsigned starting;
  /* Lanes whose rays were complete before they had crossed everything. */
  unsigned stopped;
  /* Lanes that found no way out of a cell, which can't happen as signs are exact. */
  unsigned lost;
  /* Single precision: lanes for which rounding may have changed more than the bound allows for. */
  unsigned doubtful;
  /* Lanes that may have another path: they have more hits left than the one where the present path ends. */
  unsigned more_hits;
  /* The number of steps that the packet has made. */
  int64_t steps;
  /* The number of each lane's hit that comes next. */
  int64_t next[TC_LANES];
  /* [TC_LANES] lists of the hits at the shell. */
  TcHits *hits;
  /* Where what each ray gathers is added (kernel.c). */
  int64_t destination[TC_LANES];

  /* The depth of the rays' points that are nearest to the volume's centre. */
  TcWide origin;

  /* If there are surfaces: the rays' directions, unit vectors; the depths at which they meet slices. */
  TcWide along[3];
  TcVec slice[TETCAST_MAX_SLICES];
  TcWide start; /* what is added to a depth to have the distance from where the ray starts */
} TcPacket;

/* Lets the lanes of `mask` rest: their steps lead from the cell after the last one to itself. */
TC_INLINE void tc_packet_rest(const TcGround *ground, TcPacket *p, TcMask mask) {
  const TcWord end = tc_set_word((uint32_t)ground->shell->volume->cell_count), none = {0};
  tc_store_word(p->cell, tc_select_word(mask, end, tc_load_word(p->cell)));
  tc_store_word(p->face, tc_select_word(mask, none, tc_load_word(p->face)));
  TC_IN_MEMORY(p->cell);
  TC_IN_MEMORY(p->face);
}

/* Sets the vertices of the faces of the lanes of `mask` to vertex 0. Lanes that rest still take part in steps, which
 * compute the XOR of these vertices and load the vertex it names: so it must be one that exists. */
TC_INLINE void tc_packet_forget(TcPacket *p, TcMask mask) {
  const TcWord none = {0};
  for (int k = 0; k < 3; ++k)
    p->v[k].id = tc_select_word(mask, none, p->v[k].id);
}

/* Finds which vertex comes next in each lane and has it fetched, so that it is there when the packet's next step needs
 * it. */
TC_INLINE void tc_packet_expect(const TcGround *ground, TcPacket *p) {
  const uint32_t *cells = (const uint32_t *)(const void *)ground->shell->volume->adjacency.cells;
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) {
    const uint32_t next = cells[5 * (size_t)p->cell[l]] ^ p->face[l];
    p->vertex[l] = next;
    if (TC_SINGLE || ground->vertices)
      __builtin_prefetch((const TcReal *)ground->vertices + 4 * (size_t)next);
  }
#if !TC_SINGLE
  if (TC_UNLIKELY(!ground->vertices))
    tc_points_expect(ground, p->vertex);
#endif
  TC_IN_MEMORY(p->vertex);
}

/* A bound on the error of the depths at which rays cross their faces. */
TC_INLINE TcVec tc_packet_shift(const TcGround *ground, const TcPacket *p) {
  const TcVec beside =
      tc_madd(tc_set((TcReal)ground->resolution.relative), p->at.reach, tc_set((TcReal)ground->resolution.beside));
  return tc_madd(beside, p->at.tilt.z, tc_set((TcReal)ground->resolution.depth));
}

/* a before b in an order that follows from where they are alone. */
TC_INLINE TcMask tc_point_before(const TcLanePoints *a, const TcLanePoints *b) {
  const TcMask nearer = tc_lt(a->d, b->d), below = tc_lt(a->y, b->y), level = tc_and(tc_eq(a->y, b->y), nearer);
  return tc_or(tc_lt(a->x, b->x), tc_and(tc_eq(a->x, b->x), tc_or(below, level)));
}

/* With TC_PARTS: puts a face's vertices in an order in which any part of the mesh has them, though they have other
 * numbers there. The shell's faces may be those to other parts. If edges, and depth and scalar, are computed from them
 * in this order, they have the same bits in both parts, and what lies exactly in the face is in one of these. */
TC_INLINE void tc_points_arrange(TcLanePoints v[3]) {
  static const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 1}};
  TC_UNROLLED for (int i = 0; i < 3; ++i) {
    TcLanePoints *a = &v[pairs[i][0]], *b = &v[pairs[i][1]];
    const TcMask swap = tc_point_before(b, a);
    const TcLanePoints first = tc_select_points(swap, *b, *a);
    *b = tc_select_points(swap, *a, *b);
    *a = first;
  }
}

/* With TC_PARTS: computes anew where the lanes of `mask` are at the shell. */
TC_NOINLINE void tc_packet_settle(const unsigned on, const TcGround *ground, TcPacket *p, TcMask mask) {
  TcLanePoints v[3] = {p->v[0], p->v[1], p->v[2]};
  tc_points_arrange(v);
  TcVec e[3];
  tc_edges_of(mask, v, e);
  for (int k = 0; k < 3; ++k)
    e[k] = tc_abs(e[k]);
  TcCrossing at = p->at;
  tc_cross_face(on & TC_ASSOCIATIONS, ground, &p->rays, v, e, &at);
  p->at.z = tc_select(mask, at.z, p->at.z);
  if (!(on & TC_ASSOCIATIONS))
    p->at.s = tc_select(mask, at.s, p->at.s);
}

/* The same for lanes that set out from a face, whose vertices, arranged, are v. Those of `turn` have v[1] and v[2] the
 * other way round. */
TC_INLINE void tc_packet_settle_start(const unsigned on, const TcGround *ground, TcPacket *p, TcMask mask, TcMask turn,
                                      const TcLanePoints v[3], const TcVec e[3]) {
  const TcVec weight[3] = {tc_abs(e[0]), tc_abs(e[1]), tc_abs(e[2])};
  TcCrossing at = p->at;
  tc_cross_face(on, ground, &p->rays, v, weight, &at);
  p->at.z = tc_select(mask, at.z, p->at.z);
  if (!(on & TC_ASSOCIATIONS))
    p->at.s = tc_select(mask, at.s, p->at.s);
  if (on & (TC_WEIGHTS | TC_CORNERS | TC_SURFACES | TC_LIT)) {
    const TcVec *b = at.barycentric, turned[3] = {b[0], tc_select(turn, b[2], b[1]), tc_select(turn, b[1], b[2])};
    for (int k = 0; k < 3; ++k)
      p->at.barycentric[k] = tc_select(mask, turned[k], p->at.barycentric[k]);
  }
}

/* The lanes of `starting` set out from the shell's faces that their hits name. */
TC_NOINLINE void tc_packet_set_out(const unsigned on, const TcGround *ground, TcPacket *p) {
  uint32_t id[3][TC_LANES] = {{0}};
  for (unsigned lanes = p->starting; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const TcShellFace *face = &ground->shell->faces[p->hits[l].data[p->next[l] - 1].id];
    for (int k = 0; k < 3; ++k)
      id[k][l] = face->vertex[k];
    p->cell[l] = face->cell;
    p->face[l] = face->vertex[0] ^ face->vertex[1] ^ face->vertex[2];
    p->more_hits = (p->more_hits & ~(1U << l)) | (unsigned)(p->hits[l].count - p->next[l] > 1) << l;
  }
  TcLanePoints v[3];
  for (int k = 0; k < 3; ++k)
    tc_points_load(ground, &p->rays, id[k], &v[k]);
  if (on & TC_PARTS)
    tc_points_arrange(v);
  TcVec e[3];
  const TcMask mask = tc_mask_of(p->starting);
  tc_edges_of(mask, v, e);
  const TcMask turn = tc_negative(e[0]); /* such a face is clockwise: its v[1] and v[2] change places */
  p->v[0] = tc_select_points(mask, v[0], p->v[0]);
  p->v[1] = tc_select_points(mask, tc_select_points(turn, v[2], v[1]), p->v[1]);
  p->v[2] = tc_select_points(mask, tc_select_points(turn, v[1], v[2]), p->v[2]);
  const TcVec weight[3] = {tc_abs(e[0]), tc_abs(tc_select(turn, e[2], e[1])), tc_abs(tc_select(turn, e[1], e[2]))};
  for (int k = 0; k < 3; ++k)
    p->weight[k] = tc_select(mask, weight[k], p->weight[k]);
  if (on & TC_PARTS)
    tc_packet_settle_start(on, ground, p, mask, turn, v, e);
  else
    tc_cross_face(on, ground, &p->rays, p->v, p->weight, &p->at);
  if (on & TC_BOUND)
    p->shift += tc_select(mask, tc_packet_shift(ground, p), tc_set(0));
#if TC_SINGLE
  /* A path that begins before the one before has ended overlaps it. Which of two overlapping paths comes first may be a
   * matter of rounding, and a lot depends on it. */
  const TcMask overlaps = tc_and(tc_lt(p->rays.begin, p->seen), tc_lt(p->at.z + p->shift, p->seen));
  p->doubtful |= tc_bits(tc_and(mask, overlaps));
#endif
  p->seen = tc_select(mask, tc_max(p->at.z, p->rays.begin), p->seen);
  p->active = tc_or(p->active, mask);
  p->starting = 0;
}

/* With TC_CORNERS: the scalars of the cells that are crossed, at their four corners, those of the face's vertices
 * first, then that of q. */
TC_NOINLINE void tc_packet_corners(const TcGround *ground, const TcPacket *p, const TcWord *q, TcVec corner[4]) {
  const TcWord id[4] = {p->v[0].id, p->v[1].id, p->v[2].id, *q};
  for (int k = 0; k < 4; ++k) {
    const TcWord rank = tc_rank(id[k], id[(k + 1) & 3], id[(k + 2) & 3], id[(k + 3) & 3], id[k]);
    for (int l = 0; l < TC_LANES; ++l)
      TC_AT(corner[k], l) = (TcReal)tc_rows_value(ground->values, p->cell[l], (int)TC_AT(rank, l));
  }
}

/* The scalar at a point with barycentric weights b, kept within the range of the vertices' scalars. */
TC_INLINE TcVec tc_weighted(const TcVec b[3], TcVec s0, TcVec s1, TcVec s2) {
  const TcVec value = tc_madd(b[0], s0, tc_madd(b[1], s1, b[2] * s2));
  return tc_max(tc_least3(s0, s1, s2), tc_min(tc_most3(s0, s1, s2), value));
}

/* The cells that lanes have crossed in a step. */
typedef struct TcCrossed {
  /* The lanes that have crossed a cell. */
  TcMask mask;
  /* The depth and the scalar where they entered it, and the scalar where they left it. */
  TcVec z, s0, s1;
  /* The tilt of the face where they entered it. */
  TcTilt tilt;
  /* With TC_CORNERS: the difference between the largest and the smallest scalar of the cell. */
  TcVec range;
  /* With TC_BOUND, where what is seen may jump between cells: over which lengths rounding may put them into neighbours
   * of the cell, past the faces that they don't cross. */
  TcVec grazed;
  /* With TC_SURFACES: the vertices of the face where they entered it, and the weights of these there. */
  TcWord id[3];
  TcVec barycentric[3];
} TcCrossed;

/* What the faces at the new vertex q that rays don't leave through may be for them. */
TC_NOINLINE void tc_packet_graze(const TcGround *ground, const TcPacket *p, const TcLanePoints *q, const TcMask out[3],
                                 TcVec *grazed) {
  *grazed = tc_set(0);
  for (int k = 0; k < 3; ++k) {
    const TcLanePoints face[3] = {*q, p->v[(k + 1) % 3], p->v[(k + 2) % 3]};
    TcVec length;
    tc_graze_face(ground, &p->rays, face, &length);
    *grazed += tc_select(out[k], tc_set(0), length);
  }
}

/* A step's first part: loads the vertices p->vertex, as the rays see them. */
TC_INLINE void tc_packet_look(const TcGround *ground, TcPacket *p, TcLanePoints *q) {
  tc_points_load(ground, &p->rays, p->vertex, q);
}

/* A step's second part: crosses the cells. The ray leaves through one of the three faces at the new vertex q, and the
 * signs of the edges from the face's vertices to q tell which: the face without v[k] is the one where the ray passes q
 * between the other two. Returns the lanes that found no way out. The highest bit of *reached is set if any lane has
 * reached the shell. */
TC_INLINE TcMask tc_packet_cross(const unsigned on, const TcGround *ground, TcPacket *p, const TcLanePoints *q,
                                 TcCrossed *crossed, uint32_t *reached) {
  const uint32_t *cells = (const uint32_t *)(const void *)ground->shell->volume->adjacency.cells;
  TcLanePoints *v = p->v;
  TcVec e[3];
  tc_edges_to(p->active, v, q, e);
  crossed->mask = p->active;
  crossed->z = p->at.z;
  crossed->s0 = p->at.s;
  crossed->tilt = p->at.tilt;
  if (on & TC_SURFACES) {
    for (int k = 0; k < 3; ++k) {
      crossed->barycentric[k] = p->at.barycentric[k];
      crossed->id[k] = v[k].id;
    }
  }
  TcVec corner[4];
  if (on & TC_CORNERS) {
    const TcWord id = q->id;
    tc_packet_corners(ground, p, &id, corner);
    crossed->s0 = tc_weighted(p->at.barycentric, corner[0], corner[1], corner[2]);
    crossed->range = tc_max(tc_most3(corner[0], corner[1], corner[2]), corner[3]) -
                     tc_min(tc_least3(corner[0], corner[1], corner[2]), corner[3]);
  }
  TcMask negative[3], out[3];
  for (int k = 0; k < 3; ++k)
    negative[k] = tc_and(p->active, tc_negative(e[k]));
  for (int k = 0; k < 3; ++k)
    out[k] = tc_and_not(negative[(k + 1) % 3], negative[(k + 2) % 3]);
  if (on & TC_BOUND && (on & TC_ASSOCIATIONS || TC_UNLIKELY(ground->holes))) {
    const TcLanePoints vertex = *q;
    tc_packet_graze(ground, p, &vertex, out, &crossed->grazed);
  }
  const TcWord left = tc_select_word(out[0], v[0].id, tc_select_word(out[1], v[1].id, v[2].id));
  /* A cell's neighbours are in the order of the vertices that they don't share. */
  const TcWord rank = tc_rank(left, q->id, v[0].id, v[1].id, v[2].id);
  uint32_t ranks[TC_LANES], any = 0;
  tc_store_word(ranks, rank);
  tc_store_word(p->from, tc_load_word(p->cell));
  TC_IN_MEMORY(ranks);
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) {
    const uint32_t next = cells[5 * (size_t)p->cell[l] + 1 + ranks[l]];
    p->cell[l] = next;
    any |= next;
  }
  *reached = any;
  for (int k = 0; k < 3; ++k) {
    const TcVec from_next = tc_abs(e[(k + 1) % 3]), from_last = tc_abs(e[(k + 2) % 3]);
    p->weight[k] = tc_select3(out[(k + 1) % 3], from_last, out[(k + 2) % 3], from_next, p->weight[k]);
  }
  for (int k = 0; k < 3; ++k)
    v[k] = tc_select_points(out[k], *q, v[k]);
  tc_store_word(p->face, v[0].id ^ v[1].id ^ v[2].id);
  TC_IN_MEMORY(p->face);
  tc_cross_face(on, ground, &p->rays, v, p->weight, &p->at);
  crossed->s1 = p->at.s;
  if (on & TC_CORNERS) {
    for (int k = 0; k < 3; ++k)
      corner[k] = tc_select(out[k], corner[3], corner[k]);
    crossed->s1 = tc_weighted(p->at.barycentric, corner[0], corner[1], corner[2]);
  }
  return tc_and_not(p->active, tc_or(tc_or(out[0], out[1]), out[2]));
}

/* Whether any lane has a cell ahead that is invisible, or is at the shell, as `reached` tells. */
TC_INLINE bool tc_packet_ends(const TcShell *shell, const TcPacket *p, uint32_t reached) {
  if (reached & TC_SHELL)
    return true;
  bool shown = true;
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) shown &= tc_shell_shows(shell, p->cell[l]);
  return !shown;
}

/* The active lanes whose cell ahead is invisible or beyond the shell. */
TC_NOINLINE unsigned tc_packet_invisible(const TcShell *shell, const TcPacket *p) {
  unsigned result = 0;
  for (unsigned lanes = tc_bits(p->active); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    if (p->cell[l] & TC_SHELL || !tc_shell_shows(shell, p->cell[l]))
      result |= 1U << l;
  }
  return result;
}

/* A step's third part: lets the lanes that have reached the shell rest, and returns them; the others have their next
 * vertex fetched. */
TC_INLINE unsigned tc_packet_reach(const unsigned on, const TcGround *ground, TcPacket *p, uint32_t reached,
                                   TcCrossed *crossed) {
  unsigned ended = 0;
  if (TC_UNLIKELY(ground->shell->visible != NULL)) {
    if (TC_UNLIKELY(tc_packet_ends(ground->shell, p, reached)))
      ended = tc_packet_invisible(ground->shell, p);
  } else if (TC_UNLIKELY(reached & TC_SHELL)) {
    ended = tc_bits(tc_and(p->active, tc_high_bit(tc_load_word(p->cell))));
  }
  if (TC_UNLIKELY(ended)) {
    for (unsigned lanes = ended; lanes; lanes &= lanes - 1) {
      const int l = __builtin_ctz(lanes);
      p->exit_cell[l] = p->from[l];
      p->exit_face[l] = p->face[l];
    }
    if (on & TC_PARTS) {
      tc_packet_settle(on, ground, p, tc_mask_of(ended));
      crossed->s1 = on & TC_ASSOCIATIONS ? crossed->s1 : p->at.s;
    }
    if (on & TC_BOUND)
      p->shift += tc_select(tc_mask_of(ended), tc_packet_shift(ground, p), tc_set(0));
    tc_packet_rest(ground, p, tc_mask_of(ended));
  }
  tc_packet_expect(ground, p);
  return ended;
}

/* ── paths ── */

/* The lanes of `lanes` leave their paths at the end of their rays' intervals; where cells overlap, other paths may
 * begin before it. */
TC_INLINE void tc_packet_leave(TcPacket *p, unsigned lanes) {
  for (; lanes; lanes &= lanes - 1)
    p->exit_cell[__builtin_ctz(lanes)] = UINT32_MAX; /* none: the face where the path ends is not reached */
}

/* Whether the lane has another hit at which a path begins that was not walked yet; if so, p->next is the one after. */
static bool tc_packet_next_start(TcPacket *p, int lane) {
  const TcHits *hits = &p->hits[lane];
  int64_t next = p->next[lane];
  while (next < hits->count && hits->data[next].done)
    ++next;
  p->next[lane] = next + 1;
  return next < hits->count;
}

/* Lets the lanes that wait begin their next path, if they have one. A path has a hit at either end and is walked once,
 * from the nearer one: so the hit where a path ended is marked as done. */
TC_NOINLINE void tc_packet_arrive(const TcShell *shell, TcPacket *p) {
  for (; p->waiting; p->waiting &= p->waiting - 1) {
    const int l = __builtin_ctz(p->waiting);
    const TcHits *hits = &p->hits[l];
    for (int64_t j = p->next[l]; j < hits->count; ++j) {
      const TcShellFace *face = &shell->faces[hits->data[j].id];
      /* The cell and the XOR name the face, as the faces of one cell have different XORs. */
      const bool here =
          face->cell == p->exit_cell[l] && (face->vertex[0] ^ face->vertex[1] ^ face->vertex[2]) == p->exit_face[l];
      if (here)
        hits->data[j].done = true;
    }
    if (tc_packet_next_start(p, l))
      p->starting |= 1U << l;
  }
}

TC_INLINE bool tc_packet_runs(const TcPacket *p) {
  return p->starting || p->waiting || tc_any(p->active);
}

#endif
