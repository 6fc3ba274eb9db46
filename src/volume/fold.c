/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/fold.h"

#include <math.h>

#include "base/parallel.h"
#include "base/vec3.h"

enum { GRAIN = 1 << 12, FLAT = 2 };

typedef struct Folds {
  const TcAdjacency *adjacency;
  const void *positions;
  bool positions_are_double;
  /* [cell_count]: whether the last vertex is on the positive side of the first three, in ascending order, or FLAT. */
  uint8_t *side;
} Folds;

/* Coordinates are at most 1, so rounding to single precision moves a vertex by at most √3 · 2⁻²⁵. Of two that move
 * against each other, this is less than 2⁻²³; the sum of a normal's magnitudes is at most √3 times its length. */
static uint8_t side_of(const Folds *folds, const uint32_t vertex[4]) {
  double p[4][3], e[3][3], normal[3];
  for (int j = 0; j < 4; ++j) {
    const size_t at = 3 * (size_t)vertex[j];
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
  if (!(fabs(height) > 0x1p-24 * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]))))
    return FLAT;
  return height > 0;
}

static bool find_sides(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Folds *folds = data;
  for (int64_t i = begin; i < end; ++i)
    folds->side[i] = side_of(folds, folds->adjacency->vertices[i]);
  return true;
}

/* Returns false, which ends the loop, where two neighbours lie on one side of their face. With its vertex k left out, a
 * cell's vertices name the face in ascending order. Vertex k lies on the positive side of that order if the last vertex
 * does with k = 3, and each place that k is before the last turns this round. */
static bool compare_sides(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Folds *folds = data;
  const TcCell *cells = folds->adjacency->cells;
  for (int64_t i = begin; i < end; ++i) {
    for (int k = 0; k < 4; ++k) {
      const uint32_t next = cells[i].neighbor[k];
      if (next <= (uint32_t)i || next & TC_SHELL) /* each pair is looked at once */
        continue;
      const uint32_t *back = cells[next].neighbor;
      const int back_k = (back[1] == (uint32_t)i) + 2 * (back[2] == (uint32_t)i) + 3 * (back[3] == (uint32_t)i);
      const unsigned sides = (unsigned)(folds->side[i] + folds->side[next]), turned = (unsigned)(k + back_k) & 1;
      if (folds->side[i] != FLAT && folds->side[next] != FLAT && (sides & 1) == turned)
        return false;
    }
  }
  return true;
}

TetcastStatus tc_find_folds(const TcAdjacency *adjacency, const void *positions, bool positions_are_double,
                            bool *result) {
  const int64_t count = adjacency->cell_count;
  Folds folds = {.adjacency = adjacency, .positions = positions, .positions_are_double = positions_are_double};
  if (!tc_allocate_array(adjacency->context, (void **)&folds.side, count, sizeof *folds.side, "sides of cells"))
    return TETCAST_ERROR_MEMORY;
  tc_parallel_for(adjacency->context, count, GRAIN, find_sides, &folds, NULL);
  *result = tc_parallel_for(adjacency->context, count, GRAIN, compare_sides, &folds, NULL) != TETCAST_OK;
  tc_release(adjacency->context, folds.side);
  return TETCAST_OK;
}
