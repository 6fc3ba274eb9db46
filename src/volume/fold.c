/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/fold.h"

#include <math.h>

#include "base/parallel.h"
#include "base/vec3.h"

/* Two cells that share a face lie on different sides of it unless the mesh folds there. Comparing each pair of
 * neighbours would make preparation slower by a twentieth, as it reads memory out of order. Instead, each cell adds a
 * number for each of its inner faces: a hash of the face's vertices, with the sign of the side that the cell lies on.
 * Where there are no folds, the two numbers of every face cancel and the sum is zero. Where there are some, twice the
 * hashes of their faces remain; that these cancel by chance has a probability of about 2⁻⁶³. */

enum { GRAIN = 1 << 12 };

typedef struct Folds {
  const TcAdjacency *adjacency;
  const void *positions;
  bool positions_are_double;
  atomic_ullong sum; /* modulo 2⁶⁴, so that the order of additions doesn't matter */
} Folds;

/* The side of its first three vertices, in ascending order, on which cell i has its last one: −1 or 1, or 0 if it is
 * flat. Coordinates are at most 1, so rounding to single precision moves a vertex by at most √3 · 2⁻²⁵, and two of them
 * against each other by less than 2⁻²³. The sum of a normal's magnitudes is at most √3 times its length. */
static inline int side_of(const Folds *folds, int64_t i) {
  double p[4][3], e[3][3], normal[3];
  for (int j = 0; j < 4; ++j) {
    const size_t at = 3 * (size_t)folds->adjacency->vertices[i][j];
    for (int k = 0; k < 3; ++k) {
      p[j][k] = folds->positions_are_double ? ((const double *)folds->positions)[at + (size_t)k]
                                            : (double)((const float *)folds->positions)[at + (size_t)k];
    }
  }
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k)
      e[j][k] = p[j + 1][k] - p[0][k];
  }
  tc_cross(e[0], e[1], normal);
  const double height = tc_dot(normal, e[2]); /* times the length of the normal */
  const double least = 0x1p-24 * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]));
  return (height > least) - (height < -least);
}

/* What a cell with the last vertex on the positive side adds for each of its faces; face k is the one without vertex k.
 * Vertex k lies on the side of the last one, turned round once for each place that it is before it. */
static inline void hash_faces(const uint32_t vertex[4], uint64_t face[4]) {
  uint64_t hash[4], all = 0;
  for (int k = 0; k < 4; ++k) {
    hash[k] = (vertex[k] + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15);
    hash[k] ^= hash[k] >> 32;
    all ^= hash[k];
  }
  for (int k = 0; k < 4; ++k)
    face[k] = k % 2 ? all ^ hash[k] : 0 - (all ^ hash[k]);
}

/* What the neighbours of cell i add for the faces that they share with it. */
static uint64_t of_neighbors(const Folds *folds, uint32_t i) {
  const TcCell *cells = folds->adjacency->cells;
  uint64_t sum = 0;
  for (int k = 0; k < 4; ++k) {
    const uint32_t next = cells[i].neighbor[k];
    if (next & TC_SHELL)
      continue;
    uint64_t face[4];
    hash_faces(folds->adjacency->vertices[next], face);
    for (int j = 0; j < 4; ++j)
      sum += cells[next].neighbor[j] == i ? (uint64_t)side_of(folds, next) * face[j] : 0;
  }
  return sum;
}

static bool add_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Folds *folds = data;
  uint64_t sum = 0;
  for (int64_t i = begin; i < end; ++i) {
    const int side = side_of(folds, i);
    if (side == 0) { /* on neither side of its faces: these don't count */
      sum -= of_neighbors(folds, (uint32_t)i);
      continue;
    }
    uint64_t face[4], inner = 0;
    hash_faces(folds->adjacency->vertices[i], face);
    for (int k = 0; k < 4; ++k)
      inner += folds->adjacency->cells[i].neighbor[k] & TC_SHELL ? 0 : face[k];
    sum += (uint64_t)side * inner;
  }
  atomic_fetch_add_explicit(&folds->sum, sum, memory_order_relaxed);
  return true;
}

bool tc_adjacency_folds(const TcAdjacency *adjacency, const void *positions, bool positions_are_double) {
  Folds folds = {.adjacency = adjacency, .positions = positions, .positions_are_double = positions_are_double};
  atomic_init(&folds.sum, 0);
  tc_parallel_for(adjacency->context, adjacency->cell_count, GRAIN, add_cells, &folds, NULL);
  return atomic_load(&folds.sum) != 0;
}
