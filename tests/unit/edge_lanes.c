/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels' edges, compiled once for each kind of lanes, with the name edge_NAME. */
#include "edge_lanes.h"

#include "walk/points.h"

#define NAME_(name) edge_##name
#define NAME(name)  NAME_(name)

static TcLanePoints load(const EdgePoint *points, int64_t count) {
  TcLanePoints p = {tc_set(0), tc_set(0), tc_set(0), tc_set(0), tc_set_word(0)};
  for (int l = 0; l < TC_LANES; ++l) {
    const EdgePoint *from = &points[l < count ? l : count - 1];
    TC_AT(p.x, l) = (TcReal)from->x;
    TC_AT(p.y, l) = (TcReal)from->y;
    TC_AT(p.id, l) = from->id;
  }
  return p;
}

void NAME(TC_LANES_NAME)(const EdgePoint *a, const EdgePoint *b, int64_t count, double *edge) {
  for (int64_t i = 0; i < count; i += TC_LANES) {
    const TcLanePoints p = load(a + i, count - i), q = load(b + i, count - i);
    TcVec e[3];
    static const int same[3] = {0, 0, 0};
    tc_edges(tc_all(), &p, &q, same, same, e);
    for (int l = 0; l < TC_LANES && i + l < count; ++l)
      edge[i + l] = (double)TC_AT(e[i / TC_LANES % 3], l);
  }
}
