/* SPDX-License-Identifier: Apache-2.0 */
/* The walk: from a shell face through cell after cell to the shell face where the ray leaves (shell.h). The cells a ray meets form paths, each
 * face joins at most two cells, so a path that starts at the shell can't return to a cell and ends at the shell: the walk terminates
 * on any adjacency, and every path is found from either end. */
#ifndef TC_TRAVERSE_WALK_H
#define TC_TRAVERSE_WALK_H

#include "traverse/trace.h"

/* The ray at a face. v[0], v[1], v[2] lie counter-clockwise around it: edge[k] = v[k] × v[k+1] > 0. */
typedef struct TcWalk {
  TcPoint v[3];
  double edge[3];
  double z, s;   /* where the ray crosses the face */
  uint32_t cell; /* the cell ahead, or TC_SHELL | the shell face that was reached */
} TcWalk;

static inline void tc_walk_cross(TcWalk *walk) {
  tc_crossing(&walk->v[0], &walk->v[1], &walk->v[2], walk->edge[0], walk->edge[1], walk->edge[2], &walk->z, &walk->s);
}

/* Sets out from a shell face that the ray crosses. */
static inline void tc_walk_begin(const TetcastVolume *volume, const TcRay *ray, const TcShellFace *face, TcWalk *walk) {
  for (int k = 0; k < 3; ++k) walk->v[k] = tc_project(volume, ray, face->vertex[k]);
  if (tc_edge(&walk->v[0], &walk->v[1]) < 0) {
    const TcPoint t = walk->v[1];
    walk->v[1] = walk->v[2];
    walk->v[2] = t;
  }
  for (int k = 0; k < 3; ++k) walk->edge[k] = tc_edge(&walk->v[k], &walk->v[(k + 1) % 3]);
  walk->cell = face->cell;
  tc_walk_cross(walk);
}

/* Crosses the cell ahead. Of the six edges, with q the vertex opposite the face, the signs of v[k] × q name the face through which
 * the ray leaves: that without v[k], where it passes q between the other two. False if there is none, which the exact signs of
 * tc_edge() exclude. */
static inline bool tc_walk_step(const TetcastVolume *volume, const TcRay *ray, TcWalk *walk) {
  const TcCell *cell = &volume->adjacency.cells[walk->cell];
  TcPoint *v = walk->v;
  const uint32_t id = cell->vertex_xor ^ v[0].id ^ v[1].id ^ v[2].id;
  const TcPoint q = tc_project(volume, ray, id);
  const double e[3] = {tc_edge(&v[0], &q), tc_edge(&v[1], &q), tc_edge(&v[2], &q)};
  int out; /* the vertex that is left behind: q comes between the two others */
  if (e[1] > 0 && e[0] < 0) out = 2;
  else if (e[2] > 0 && e[1] < 0) out = 0;
  else if (e[0] > 0 && e[2] < 0) out = 1;
  else return false;
  const uint32_t left = v[out].id, next = v[(out + 1) % 3].id, last = v[(out + 2) % 3].id;
  const int rank = (left > id) + (left > next) + (left > last);
  walk->edge[out] = -e[(out + 1) % 3];   /* q × v[out + 1] */
  walk->edge[(out + 2) % 3] = e[(out + 2) % 3]; /* v[out + 2] × q */
  v[out] = q;
  walk->cell = cell->neighbor[rank];
  tc_walk_cross(walk);
  return true;
}

/* Whether a walk that has `cell` ahead is at the shell. */
static inline bool tc_shell_ends(const TcShell *shell, uint32_t cell) {
  return (cell & TC_SHELL) || (shell->visible && !shell->visible[cell >> TC_CLUSTER_BITS]);
}

/* Whether a face of the shell is that of cell `from` with these vertices: of one cell's faces each has another XOR. */
static inline bool tc_shell_face_is(const TcShellFace *face, uint32_t from, uint32_t vertex_xor) {
  return face->cell == from && (face->vertex[0] ^ face->vertex[1] ^ face->vertex[2]) == vertex_xor;
}

/* What is done where the ray enters at a shell face, and when it has crossed `cell` and is at the next face; the latter false: enough seen. */
typedef void TcEnter(void *data, const TcWalk *walk);
typedef bool TcCross(void *data, uint32_t cell, const TcWalk *walk);

/* Walks each path once, from the end that comes first; `faces` are the shell faces on the ray. False: the ray was lost. Inlined with the two
 * functions. */
static inline bool tc_walk_paths(const TcShell *shell, const TcRay *ray, TcSpans *faces, TcEnter *enter, TcCross *cross, void *data) {
  for (int64_t i = 0; i < faces->count; ++i) faces->data[i].done = false;
  for (int64_t i = 0; i < faces->count; ++i) {
    if (faces->data[i].done) continue;
    TcWalk walk;
    tc_walk_begin(shell->volume, ray, &shell->faces[faces->data[i].id], &walk);
    enter(data, &walk);
    uint32_t cell;
    do {
      cell = walk.cell;
      if (!tc_walk_step(shell->volume, ray, &walk)) return false;
      if (!cross(data, cell, &walk)) return true;
    } while (!tc_shell_ends(shell, walk.cell));
    const uint32_t vertex_xor = walk.v[0].id ^ walk.v[1].id ^ walk.v[2].id;
    for (int64_t j = i + 1; j < faces->count; ++j) {
      if (tc_shell_face_is(&shell->faces[faces->data[j].id], cell, vertex_xor)) faces->data[j].done = true;
    }
  }
  return true;
}

/* The two faces at which the ray enters and leaves a cell of a volume with TETCAST_TRAVERSAL_FACES, by depth. False: it passes. */
bool tc_cross_cell(const TetcastVolume *volume, const TcRay *ray, uint32_t cell, TcWalk face[2]);

#endif
