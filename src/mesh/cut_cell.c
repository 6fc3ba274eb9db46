/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts one straight cell into tetrahedra. How a face is cut depends only on the indices of its vertices, so that both
 * of its cells cut it in the same way. */
#include <math.h>
#include <stdlib.h>

#include "mesh/cut.h"

/* Tetrahedra that overlap by less than this share of the volume count as not overlapping, as rounding coordinates to
 * single precision makes flat ones overlap. */
static const double fold_limit = 1e-6;

#define SIZES(...)                                                                                                     \
  (const uint32_t[]) {                                                                                                 \
    __VA_ARGS__                                                                                                        \
  }
#define CORNERS(...)                                                                                                   \
  (const uint32_t[]) {                                                                                                 \
    __VA_ARGS__                                                                                                        \
  }

static const TcShape shapes[TC_SHAPES] = {
    [TC_TETRAHEDRON] = {.corners = 4,
                        .faces = 4,
                        .size = SIZES(3, 3, 3, 3),
                        .corner = CORNERS(0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2)},
    [TC_HEXAHEDRON] = {.corners = 8,
                       .faces = 6,
                       .size = SIZES(4, 4, 4, 4, 4, 4),
                       .corner = CORNERS(0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7),
                       .hexahedron = true},
    [TC_WEDGE] = {.corners = 6,
                  .faces = 5,
                  .size = SIZES(3, 3, 4, 4, 4),
                  .corner = CORNERS(0, 1, 2, 3, 5, 4, 0, 3, 4, 1, 1, 4, 5, 2, 2, 5, 3, 0),
                  .either_way = true},
    [TC_PYRAMID] = {.corners = 5,
                    .faces = 5,
                    .size = SIZES(4, 3, 3, 3, 3),
                    .corner = CORNERS(0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4)},
    [TC_PENTAGONAL_PRISM] = {.corners = 10,
                             .faces = 7,
                             .size = SIZES(5, 5, 4, 4, 4, 4, 4),
                             .corner = CORNERS(0, 4, 3, 2, 1, 5, 6, 7, 8, 9, 0, 1, 6, 5, 1, 2, 7, 6, 2, 3, 8, 7, 3, 4,
                                               9, 8, 4, 0, 5, 9)},
    [TC_HEXAGONAL_PRISM] = {.corners = 12,
                            .faces = 8,
                            .size = SIZES(6, 6, 4, 4, 4, 4, 4, 4),
                            .corner = CORNERS(0, 5, 4, 3, 2, 1, 6, 7, 8, 9, 10, 11, 0, 1, 7, 6, 1, 2, 8, 7, 2, 3, 9, 8,
                                              3, 4, 10, 9, 4, 5, 11, 10, 5, 0, 6, 11)},
    /* Between two tetrahedra of a lattice: corners at (1,0,0), (0,1,0), (0,0,1), (1,1,0), (1,0,1), (0,1,1). */
    [TC_OCTAHEDRON] = {.corners = 6,
                       .faces = 8,
                       .size = SIZES(3, 3, 3, 3, 3, 3, 3, 3),
                       .corner = CORNERS(0, 2, 1, 3, 5, 4, 1, 2, 5, 0, 3, 4, 0, 4, 2, 1, 5, 3, 0, 1, 3, 2, 4, 5)},
};

const TcShape *tc_shape(TcShapeName name) {
  return &shapes[name];
}

/* Cuts all faces but those that touch vertex `but` into triangles by the diagonals through their smallest vertex, and
 * makes a tetrahedron of each and corner `top`. Triangles with a vertex twice are left out. */
static int64_t cone(const TcShape *shape, const uint32_t *id, uint32_t top, int64_t but, uint32_t (*tet)[4]) {
  int64_t count = 0;
  const uint32_t *corner = shape->corner;
  for (uint32_t face = 0; face < shape->faces; corner += shape->size[face++]) {
    const uint32_t size = shape->size[face];
    uint32_t first = 0;
    for (uint32_t k = 1; k < size; ++k)
      first = id[corner[k]] < id[corner[first]] ? k : first;
    const uint32_t a = corner[first];
    if (id[a] == but)
      continue;
    const bool turned = shape->turned && shape->turned[face];
    uint32_t at = first + 1 == size ? 0 : first + 1;
    for (uint32_t k = 2; k < size; ++k) {
      const uint32_t b = corner[at];
      at = at + 1 == size ? 0 : at + 1;
      const uint32_t c = corner[at];
      if (id[a] == id[b] || id[b] == id[c] || id[c] == id[a])
        continue;
      uint32_t *t = tet[count++];
      t[0] = top;
      t[1] = a;
      t[2] = turned ? c : b;
      t[3] = turned ? b : c;
    }
  }
  return count;
}

static void measure(TcTets *tets) {
  double smallest = INFINITY;
  tets->positive = tets->negative = 0;
  for (int64_t i = 0; i < tets->count; ++i) {
    const uint32_t *t = tets->tet[i];
    const double *o = tets->p[t[0]], *a = tets->p[t[1]], *b = tets->p[t[2]], *c = tets->p[t[3]];
    const double x[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]};
    const double y[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]};
    const double z[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
    const double volume =
        (x[1] * y[2] - x[2] * y[1]) * z[0] + (x[2] * y[0] - x[0] * y[2]) * z[1] + (x[0] * y[1] - x[1] * y[0]) * z[2];
    tets->positive += volume > 0 ? volume : 0;
    tets->negative -= volume < 0 ? volume : 0;
    smallest = fabs(volume) < smallest ? fabs(volume) : smallest;
  }
  tets->flat = smallest <= fold_limit * (tets->positive + tets->negative);
}

bool tc_is_folded(double positive, double negative) {
  return fmin(positive, negative) > fold_limit * fmax(positive, negative);
}

/* Where none of the diagonals goes through the corner opposite the one that the pyramids start from, that corner can be
 * cut off: five tetrahedra instead of six. */
static int64_t cut_corner_off(int64_t count, uint32_t (*tet)[4]) {
  static const uint32_t opposite[8] = {6, 7, 4, 5, 2, 3, 0, 1};
  if (count != 6)
    return count;
  const uint32_t far = opposite[tet[0][0]];
  int found[3], n = 0;
  for (int i = 0; i < 6; ++i) {
    if (tet[i][1] != far && tet[i][2] != far && tet[i][3] != far)
      continue;
    if (n == 3)
      return count;
    found[n++] = i;
  }
  if (n != 3)
    return count;
  const uint32_t *t = tet[found[0]], *other = tet[found[1]];
  const int at = t[1] == far ? 1 : t[2] == far ? 2 : 3;
  const uint32_t x = t[at % 3 + 1], y = t[(at + 1) % 3 + 1];
  uint32_t z = x;
  for (int k = 1; k < 4; ++k)
    z = other[k] != far && other[k] != x && other[k] != y ? other[k] : z;
  const uint32_t rest[2][4] = {{t[0], x, y, z}, {far, x, z, y}};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 4; ++k)
      tet[found[i]][k] = rest[i][k];
  }
  for (int k = 0; k < 4; ++k)
    tet[found[2]][k] = tet[5][k];
  return 5;
}

int64_t tc_cone_hexahedron(const uint32_t *id, uint32_t first, uint32_t (*tet)[4]) {
  return cut_corner_off(cone(&shapes[TC_HEXAHEDRON], id, first, id[first], tet), tet);
}

bool tc_has_twice(const uint32_t *id, uint32_t count) {
  bool twice = false;
  for (uint32_t i = 1; i < count; ++i) {
    for (uint32_t j = 0; j < i; ++j)
      twice |= id[i] == id[j];
  }
  return twice;
}

/* The smallest vertex; of a polyhedron, that a face has: it may name others. */
static uint32_t smallest(const TcShape *shape, const uint32_t *id) {
  uint32_t least = 0;
  if (!shape->turned) {
    for (uint32_t k = 1; k < shape->corners; ++k)
      least = id[k] < id[least] ? k : least;
    return least;
  }
  uint32_t corners = 0;
  for (uint32_t face = 0; face < shape->faces; ++face)
    corners += shape->size[face];
  least = shape->corner[0];
  for (uint32_t k = 1; k < corners; ++k)
    least = id[shape->corner[k]] < id[least] ? shape->corner[k] : least;
  return least;
}

static void cut_from_centre(const TcShape *shape, TcTets *tets) {
  double *centre = tets->p[shape->corners];
  const double *first = tets->p[0];
  for (int k = 0; k < 3; ++k) {
    double sum = 0;
    for (uint32_t i = 1; i < shape->corners; ++i)
      sum += tets->p[i][k] - first[k];
    centre[k] = first[k] + sum / shape->corners;
  }
  tets->centred = true;
  tets->count = cone(shape, tets->id, shape->corners, -1, tets->tet);
  measure(tets);
}

static void cut_from_corner(const TcShape *shape, uint32_t corner, TcTets *tets) {
  tets->centred = false;
  tets->count = cone(shape, tets->id, corner, tets->id[corner], tets->tet);
  if (shape->hexahedron)
    tets->count = cut_corner_off(tets->count, tets->tet);
  measure(tets);
}

/* A polyhedron with several faces in a plane, or corners in a line, has flat tetrahedra at them, whose faces may be
 * without area and then those of more than two; unless it gets a vertex inside. */
void tc_cut_shape(const TcShape *shape, TcTets *tets) {
  if (shape == tc_shape(TC_TETRAHEDRON)) { /* it stays as it is */
    for (uint32_t k = 0; k < 4; ++k)
      tets->tet[0][k] = k;
    tets->count = tc_has_twice(tets->id, 4) ? 0 : 1;
    tets->centred = false;
    measure(tets);
    return;
  }
  const uint32_t corner = smallest(shape, tets->id);
  cut_from_corner(shape, corner, tets);
  const bool folded = tc_is_folded(tets->positive, tets->negative);
  if (folded || (shape->turned && tets->flat)) {
    const double overlap = fmin(tets->positive, tets->negative);
    cut_from_centre(shape, tets);
    const bool better = folded ? fmin(tets->positive, tets->negative) < 0.5 * overlap
                               : !tets->flat && !tc_is_folded(tets->positive, tets->negative);
    if (!better)
      cut_from_corner(shape, corner, tets);
  }
  if (shape->either_way && tets->negative > tets->positive) {
    for (int64_t i = 0; i < tets->count; ++i) {
      uint32_t *t = tets->tet[i], swap = t[2];
      t[2] = t[3];
      t[3] = swap;
    }
  }
}

/* ── polyhedra whose faces are given either way round ── */

static int compare_edges(const void *left, const void *right) {
  const TcEdge *x = left, *y = right;
  if (x->a != y->a)
    return x->a < y->a ? -1 : 1;
  if (x->b != y->b)
    return x->b < y->b ? -1 : 1;
  return x->face < y->face ? -1 : x->face > y->face;
}

/* The face that stands for all that `face` is joined with; *turned: whether the two are different ways round. */
static uint32_t root_of(uint32_t *link, bool *turned_by, uint32_t face, bool *turned) {
  uint32_t root = face;
  bool way = false;
  while (link[root] != root) {
    way ^= turned_by[root];
    root = link[root];
  }
  *turned = way;
  while (link[face] != root && face != root) { /* shortens the way for the next */
    const uint32_t next = link[face];
    const bool step = turned_by[face];
    link[face] = root;
    turned_by[face] = way;
    way ^= step;
    face = next;
  }
  return root;
}

bool tc_orient_faces(const TcShape *shape, TcEdge *edge, uint32_t *link) {
  size_t count = 0;
  const uint32_t *corner = shape->corner;
  for (uint32_t face = 0; face < shape->faces; corner += shape->size[face++]) {
    const uint32_t size = shape->size[face];
    link[face] = face;
    shape->turned[face] = false;
    for (uint32_t k = 0; k < size; ++k) {
      const uint32_t a = corner[k], b = corner[k + 1 == size ? 0 : k + 1];
      if (a != b)
        edge[count++] = (TcEdge){a < b ? a : b, a < b ? b : a, face, a > b};
    }
  }
  qsort(edge, count, sizeof *edge, compare_edges);
  bool closed = true;
  for (size_t i = 0, next; i < count; i = next) {
    next = i + 1;
    while (next < count && edge[next].a == edge[i].a && edge[next].b == edge[i].b)
      ++next;
    if (next - i != 2) {
      closed = false;
      continue;
    }
    bool way[2];
    const uint32_t root[2] = {root_of(link, shape->turned, edge[i].face, &way[0]),
                              root_of(link, shape->turned, edge[i + 1].face, &way[1])};
    if (root[0] == root[1])
      continue;
    link[root[1]] = root[0];
    shape->turned[root[1]] = way[0] ^ way[1] ^ (edge[i].backward == edge[i + 1].backward);
  }
  for (uint32_t face = 0; face < shape->faces; ++face) {
    bool way;
    root_of(link, shape->turned, face, &way);
    (void)way;
  }
  return closed;
}
