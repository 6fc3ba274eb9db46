/* SPDX-License-Identifier: Apache-2.0 */
/* Hexahedra by table. Their tetrahedra depend on two things: the corner of the smallest vertex, and which diagonal has
 * the smaller one in each of the three faces without that corner. That is 8 × 8 ways, made once by what cuts any cell.
 */
#include "mesh/cut.h"

static uint32_t opposite(uint32_t corner) {
  return corner < 4 ? 4 + (corner + 2) % 4 : (corner + 2) % 4;
}

void tc_hexahedra_make(TcHexahedra *table) {
  const TcShape *shape = tc_shape(TC_HEXAHEDRON);
  for (uint32_t first = 0; first < 8; ++first) {
    const uint32_t far = opposite(first);
    int faces = 0;
    for (uint32_t face = 0; face < shape->faces; ++face) {
      const uint32_t *corner = shape->corner + 4 * face;
      for (uint32_t k = 0; k < 4; ++k) {
        if (corner[k] != far)
          continue;
        uint8_t *to = table->face[first][faces++];
        to[0] = (uint8_t)far;
        for (uint32_t j = 1; j < 4; ++j)
          to[j] = (uint8_t)corner[(k + j) % 4];
      }
    }
    const uint8_t(*of)[4] = (const uint8_t(*)[4])table->face[first];
    table->third[first] = of[1][1] == of[0][1] || of[1][1] == of[0][3] ? of[1][3] : of[1][1];
    for (uint32_t way = 0; way < 8; ++way) {
      /* `far` has the largest number, and its neighbours larger ones than the corners opposite it in faces whose
       * diagonal ends there. */
      uint32_t id[8] = {0}, tet[TC_FIXED_TETS][4];
      id[far] = 99;
      for (uint32_t face = 0; face < 3; ++face) {
        const uint8_t *corner = table->face[first][face];
        id[corner[1]] = 10u + corner[1];
        id[corner[3]] = 10u + corner[3];
        id[corner[2]] = (way >> face & 1 ? 1u : 50u) + face;
      }
      const int64_t count = tc_cone_hexahedron(id, first, tet);
      table->count[8 * first + way] = (uint8_t)count;
      for (uint32_t face = 0; face < 3; ++face) {
        for (uint32_t k = 0; k < 4; ++k)
          table->quad[8 * first + way][face][k] = table->face[first][face][(k + (way >> face & 1 ? 0 : 3)) % 4];
      }
      for (int64_t t = 0; t < count; ++t) {
        for (int k = 0; k < 4; ++k)
          table->tet[8 * first + way][t][k] = (uint8_t)tet[t][k];
      }
    }
  }
}

int tc_hexahedra_find(const TcHexahedra *table, const uint32_t id[8]) {
  uint64_t least = (uint64_t)id[0] << 3;
  for (unsigned k = 1; k < 8; ++k) {
    const uint64_t next = (uint64_t)id[k] << 3 | k;
    least = next < least ? next : least;
  }
  const unsigned first = (unsigned)(least & 7);
  unsigned way = 0;
  for (unsigned face = 0; face < 3; ++face) {
    const uint8_t *corner = table->face[first][face];
    const uint32_t a = id[corner[0]], b = id[corner[1]], c = id[corner[2]], d = id[corner[3]];
    way |= (unsigned)((a < c ? a : c) < (b < d ? b : d)) << face;
  }
  return (int)(8 * first + way);
}

/* A face's two triangles make tetrahedra with the first corner that share its diagonal: one cross product for both.
 * Where no diagonal ends at the corner opposite, the three that have that corner are one, and what is cut off. A cell
 * with a vertex twice has tetrahedra without volume, or of both signs. */
bool tc_hexahedra_fits(const TcHexahedra *table, int way, const double (*p)[3]) {
  const double *o = p[way >> 3];
  const double *third = p[table->third[way >> 3]];
  double sum = 0, middle = 0;
  bool one = true, other = true;
  for (int face = 0; face < 3; ++face) {
    const uint8_t *q = table->quad[way][face];
    const double *a = p[q[0]], *b = p[q[2]], *c = p[q[1]], *d = p[q[3]];
    const double x[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]}, y[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]};
    const double n[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    const double first = n[0] * (c[0] - o[0]) + n[1] * (c[1] - o[1]) + n[2] * (c[2] - o[2]);
    const double second = n[0] * (o[0] - d[0]) + n[1] * (o[1] - d[1]) + n[2] * (o[2] - d[2]);
    one &= first > 0;
    other &= second > 0;
    sum += first;
    if (face == 0)
      middle = n[0] * (third[0] - o[0]) + n[1] * (third[1] - o[1]) + n[2] * (third[2] - o[2]);
  }
  const bool cut_off = (way & 7) == 0;
  return other & (cut_off ? (middle > 0) & (sum > middle) : one);
}
