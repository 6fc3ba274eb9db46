/* SPDX-License-Identifier: Apache-2.0 */
/* The cells that a ray crosses in volumes of which Embree holds every cell (TETCAST_TRAVERSAL_FACES). Each cell is
 * found for itself, whatever its neighbours are. One lane only. */
#ifndef TC_WALK_CELLS_H
#define TC_WALK_CELLS_H

#include "walk/packet.h"

/* The two faces through which a ray enters and leaves a cell. */
typedef struct TcCellFaces {
  TcLanePoints v[2][3];
  TcVec weight[2][3];
  TcCrossing at[2];
} TcCellFaces;

/* Finds the two faces of a cell that the ray crosses. False if it passes by the cell; as signs are exact, it crosses
 * either none or exactly two of its faces. */
static bool tc_cell_faces(const unsigned on, const TcGround *ground, const TcRays *rays, uint32_t cell,
                          TcCellFaces *faces) {
  const uint32_t *vertex = ground->shell->volume->adjacency.vertices[cell];
  TcLanePoints p[4];
  for (int k = 0; k < 4; ++k)
    tc_points_of_one(ground, rays, vertex[k], &p[k]);
  int count = 0;
  for (int k = 0; k < 4 && count < 2; ++k) {
    /* In an order that does not depend on the cell, so that depth and scalar are the same number in the other one. */
    const TcLanePoints v[3] = {p[k < 1], p[k < 3 ? 3 : 2], p[k < 2 ? 2 : 1]};
    TcVec e[3];
    tc_edges_of(tc_all(), v, e);
    const unsigned negative = tc_bits(tc_negative(e[0])) + tc_bits(tc_negative(e[1])) + tc_bits(tc_negative(e[2]));
    if (negative != 0 && negative != 3)
      continue;
    for (int j = 0; j < 3; ++j) {
      faces->v[count][j] = v[j];
      faces->weight[count][j] = tc_abs(e[j]);
    }
    tc_cross_face(on, ground, rays, faces->v[count], faces->weight[count], &faces->at[count]);
    ++count;
  }
  if (count == 2 && TC_AT(faces->at[1].z, 0) < TC_AT(faces->at[0].z, 0)) {
    const TcCellFaces other = *faces;
    for (int i = 0; i < 2; ++i) {
      memcpy(faces->v[i], other.v[1 - i], sizeof faces->v[i]);
      memcpy(faces->weight[i], other.weight[1 - i], sizeof faces->weight[i]);
      faces->at[i] = other.at[1 - i];
    }
  }
  return count == 2;
}

/* Takes the ray to the face where it enters the cell (i = 0) or leaves it (i = 1). */
static void tc_cell_at(const unsigned on, const TcGround *ground, TcPacket *p, const TcCellFaces *faces, int i) {
  memcpy(p->v, faces->v[i], sizeof p->v);
  memcpy(p->weight, faces->weight[i], sizeof p->weight);
  p->at = faces->at[i];
  if (on & TC_BOUND)
    p->shift += tc_packet_shift(ground, p);
}

/* With TC_CORNERS: the scalar where the ray crosses the face that it is at, interpolated between the cell's corners. */
static TcVec tc_cell_corner_value(const TcGround *ground, uint32_t cell, const TcPacket *p) {
  const uint32_t *vertex = ground->shell->volume->adjacency.vertices[cell];
  TcVec value[3];
  for (int k = 0; k < 3; ++k) {
    int rank = 0;
    while (vertex[rank] != TC_AT(p->v[k].id, 0))
      ++rank;
    value[k] = tc_set((TcReal)tc_rows_value(ground->values, cell, rank));
  }
  return tc_weighted(p->at.barycentric, value[0], value[1], value[2]);
}

/* With TC_CORNERS: the difference between the largest and the smallest scalar of a cell. */
static TcVec tc_cell_range(const TcGround *ground, uint32_t cell) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 4; ++k) {
    low = fmin(low, tc_rows_value(ground->values, cell, k));
    high = fmax(high, tc_rows_value(ground->values, cell, k));
  }
  return tc_set((TcReal)(high - low));
}

/* Adds what those faces of a cell may be for a ray that it crosses, or doesn't cross. */
static void tc_cell_passed(const TcGround *ground, uint32_t cell, bool crosses, TcWaiting *waiting) {
  const uint32_t *vertex = ground->shell->volume->adjacency.vertices[cell];
  for (int k = 0; k < 4; ++k) {
    TcLanePoints v[3];
    for (int j = 0; j < 3; ++j)
      tc_points_of_one(ground, &waiting->rays, vertex[j + (j >= k)], &v[j]);
    TcVec e[3], length;
    tc_edges_of(tc_all(), v, e);
    const unsigned negative = tc_bits(tc_negative(e[0])) + tc_bits(tc_negative(e[1])) + tc_bits(tc_negative(e[2]));
    if ((negative == 0 || negative == 3) != crosses)
      continue;
    tc_graze_face(ground, &waiting->rays, v, &length);
    waiting->grazed += length;
  }
}

/* Notes cell i as a hit of those rays of `lanes` that cross it. */
static void tc_cell_candidate(void *user, uint32_t i, unsigned lanes) {
  TcQueue *queue = user;
  const TcGround *ground = queue->ground;
  for (; lanes; lanes &= lanes - 1) {
    TcWaiting *waiting = &queue->waiting[__builtin_ctz(lanes)];
    TcCellFaces faces;
    if (TC_UNLIKELY(queue->bounds))
      tc_cell_passed(ground, i, false, waiting);
    if (!tc_cell_faces(TC_CELLS, ground, &waiting->rays, i, &faces))
      continue;
    TcHit *hit = tc_hits_append(waiting->hits);
    if (hit)
      *hit = (TcHit){.begin = (double)TC_AT(faces.at[0].z, 0), .end = (double)TC_AT(faces.at[1].z, 0), .id = i};
  }
}

#endif
