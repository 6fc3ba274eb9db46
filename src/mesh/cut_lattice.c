/* SPDX-License-Identifier: Apache-2.0 */
/* Curved cells: where their nodes are in a lattice, their shape functions, and the straight cells between points of a
 * lattice. */
#include <math.h>

#include "mesh/cut.h"

/* ── which lattice ── */

static const struct {
  unsigned type;
  TcShapeName shape;
  int order[3];      /* 0: told by the number of nodes, or given */
  int listed, nodes; /* how many the cell has, how many of them are used */
  bool bezier;
} types[] = {
    {TETCAST_CELL_QUADRATIC_TETRAHEDRON, TC_TETRAHEDRON, {2, 2, 2}, 10, 10, false},
    {TETCAST_CELL_QUADRATIC_HEXAHEDRON, TC_HEXAHEDRON, {2, 2, 2}, 20, 20, false},
    {TETCAST_CELL_QUADRATIC_WEDGE, TC_WEDGE, {2, 2, 2}, 15, 15, false},
    {TETCAST_CELL_QUADRATIC_PYRAMID, TC_PYRAMID, {2, 2, 2}, 13, 13, false},
    {TETCAST_CELL_TRIQUADRATIC_HEXAHEDRON, TC_HEXAHEDRON, {2, 2, 2}, 27, 27, false},
    {TETCAST_CELL_QUADRATIC_LINEAR_WEDGE, TC_WEDGE, {2, 2, 1}, 12, 12, false},
    {TETCAST_CELL_BIQUADRATIC_QUADRATIC_WEDGE, TC_WEDGE, {2, 2, 2}, 18, 18, false},
    {TETCAST_CELL_BIQUADRATIC_QUADRATIC_HEXAHEDRON, TC_HEXAHEDRON, {2, 2, 2}, 24, 24, false},
    {TETCAST_CELL_TRIQUADRATIC_PYRAMID, TC_PYRAMID, {2, 2, 2}, 19, 14, false},
    {TETCAST_CELL_LAGRANGE_TETRAHEDRON, TC_TETRAHEDRON, {0}, 0, 0, false},
    {TETCAST_CELL_LAGRANGE_HEXAHEDRON, TC_HEXAHEDRON, {0}, 0, 0, false},
    {TETCAST_CELL_LAGRANGE_WEDGE, TC_WEDGE, {0}, 0, 0, false},
    {TETCAST_CELL_BEZIER_TETRAHEDRON, TC_TETRAHEDRON, {0}, 0, 0, true},
    {TETCAST_CELL_BEZIER_HEXAHEDRON, TC_HEXAHEDRON, {0}, 0, 0, true},
    {TETCAST_CELL_BEZIER_WEDGE, TC_WEDGE, {0}, 0, 0, true},
};

enum { TYPES = sizeof types / sizeof *types };

static int type_index(unsigned type) {
  int i = 0;
  while (i < TYPES && types[i].type != type)
    ++i;
  return i;
}

bool tc_is_curved(unsigned type) {
  return type_index(type) < TYPES;
}
int tc_curved_nodes(unsigned type) {
  return types[type_index(type)].listed;
}

/* Nodes of a whole lattice. */
static int64_t whole(TcShapeName shape, const int order[3]) {
  const int64_t n = order[0], triangle = (n + 1) * (n + 2) / 2;
  if (shape == TC_TETRAHEDRON)
    return triangle * (n + 3) / 3;
  if (shape == TC_WEDGE)
    return triangle * (order[2] + 1);
  return (n + 1) * (order[1] + 1) * (order[2] + 1);
}

/* VTK has Lagrange cells of 15 and 21 nodes, whose order is the second whatever is given. */
static bool has_middles(const TcLattice *lattice, int64_t nodes) {
  if (lattice->bezier)
    return false;
  return (lattice->shape == TC_TETRAHEDRON && nodes == 15) || (lattice->shape == TC_WEDGE && nodes == 21);
}

static bool find_order(TcLattice *lattice, int64_t nodes, const double given[3]) {
  lattice->with_middles = has_middles(lattice, nodes);
  if (lattice->with_middles) {
    for (int k = 0; k < 3; ++k)
      lattice->order[k] = 2;
    return true;
  }
  if (given) {
    for (int k = 0; k < 3; ++k) {
      if (!(given[k] >= 1 && given[k] <= TC_MAX_ORDER))
        return false;
      lattice->order[k] = (int)given[k];
    }
    if (lattice->shape != TC_HEXAHEDRON && lattice->order[0] != lattice->order[1])
      return false;
    if (lattice->shape == TC_TETRAHEDRON && lattice->order[0] != lattice->order[2])
      return false;
    return whole(lattice->shape, lattice->order) == nodes;
  }
  for (int n = 1; n <= TC_MAX_ORDER; ++n) {
    for (int k = 0; k < 3; ++k)
      lattice->order[k] = n;
    if (whole(lattice->shape, lattice->order) == nodes)
      return true;
  }
  return false;
}

bool tc_lattice_make(unsigned type, int64_t nodes, const double order[3], int subdivision, TcLattice *lattice) {
  const int i = type_index(type);
  *lattice = (TcLattice){.shape = types[i].shape, .nodes = types[i].nodes, .bezier = types[i].bezier};
  if (types[i].nodes) {
    if (nodes < types[i].listed)
      return false;
    for (int k = 0; k < 3; ++k)
      lattice->order[k] = types[i].order[k];
  } else {
    if (!find_order(lattice, nodes, order))
      return false;
    lattice->nodes = (int)nodes;
  }
  for (int k = 0; k < 3; ++k)
    lattice->segments[k] = subdivision ? subdivision : lattice->order[k];
  return true;
}

/* ── points ── */

int64_t tc_lattice_size(const TcLattice *lattice) {
  const int *s = lattice->segments;
  return (int64_t)(s[0] + 1) * (s[1] + 1) * (s[2] + 1);
}

int64_t tc_lattice_index(const TcLattice *lattice, const int at[3]) {
  const int *s = lattice->segments;
  return at[0] + (int64_t)(s[0] + 1) * (at[1] + (int64_t)(s[1] + 1) * at[2]);
}

static bool is_inside(TcShapeName shape, const int size[3], const int at[3]) {
  switch (shape) {
  case TC_TETRAHEDRON:
    return at[0] + at[1] + at[2] <= size[0];
  case TC_WEDGE:
    return at[0] + at[1] <= size[0];
  case TC_PYRAMID:
    return at[0] + at[2] <= size[0] && at[1] + at[2] <= size[0];
  default:
    return true;
  }
}

static bool next_point(TcShapeName shape, const int size[3], int at[3]) {
  do {
    int k = 0;
    while (k < 3 && at[k] == size[k])
      at[k++] = 0;
    if (k == 3)
      return false;
    ++at[k];
  } while (!is_inside(shape, size, at));
  return true;
}

bool tc_lattice_next(const TcLattice *lattice, int at[3]) {
  return next_point(lattice->shape, lattice->segments, at);
}

/* ── numbers of nodes, as VTK has them for cells of any order: corners, edges, faces, inside; those of second order by
 * name are the same with gaps ── */

static int hexahedron_node(const int n[3], const int at[3]) {
  const int i = at[0], j = at[1], k = at[2];
  const bool ends[3] = {i == 0 || i == n[0], j == 0 || j == n[1], k == 0 || k == n[2]};
  const int inner[3] = {n[0] - 1, n[1] - 1, n[2] - 1};
  const int count = ends[0] + ends[1] + ends[2];
  if (count == 3)
    return (i ? j ? 2 : 1 : j ? 3 : 0) + (k ? 4 : 0);
  int first = 8;
  if (count == 2) {
    const int top = k ? 2 * (inner[0] + inner[1]) : 0;
    if (!ends[0])
      return first + i - 1 + (j ? inner[0] + inner[1] : 0) + top;
    if (!ends[1])
      return first + j - 1 + (i ? inner[0] : 2 * inner[0] + inner[1]) + top;
    return first + 4 * (inner[0] + inner[1]) + k - 1 + inner[2] * (i ? j ? 2 : 1 : j ? 3 : 0);
  }
  first += 4 * (inner[0] + inner[1] + inner[2]);
  if (count == 1) {
    if (ends[0])
      return first + j - 1 + inner[1] * (k - 1) + (i ? inner[1] * inner[2] : 0);
    first += 2 * inner[1] * inner[2];
    if (ends[1])
      return first + i - 1 + inner[0] * (k - 1) + (j ? inner[0] * inner[2] : 0);
    first += 2 * inner[0] * inner[2];
    return first + i - 1 + inner[0] * (j - 1) + (k ? inner[0] * inner[1] : 0);
  }
  first += 2 * (inner[0] * inner[1] + inner[1] * inner[2] + inner[2] * inner[0]);
  return first + i - 1 + inner[0] * (j - 1 + inner[1] * (k - 1));
}

static int wedge_node(int n, int m, const int at[3]) {
  const int i = at[0], j = at[1], k = at[2], rest = n - i - j, in = n - 1, up = m - 1;
  const int corner = i == n ? 1 : j == n ? 2 : rest == n ? 0 : -1;
  const int edge = j == 0 ? 0 : rest == 0 ? 1 : i == 0 ? 2 : -1; /* of the triangle */
  const int along = edge == 0 ? i - 1 : edge == 1 ? j - 1 : rest - 1;
  const bool end = k == 0 || k == m;
  if (corner >= 0)
    return end ? corner + (k ? 3 : 0) : 6 + 6 * in + corner * up + k - 1;
  if (edge >= 0 && end)
    return 6 + (k ? 3 * in : 0) + edge * in + along;
  const int inside = (n - 1) * (n - 2) / 2,
            place = (j - 1) * (n - 1) - (j - 1) * j / 2 + i - 1; /* row by row in the triangle */
  int first = 6 + 6 * in + 3 * up;
  if (end)
    return first + (k ? inside : 0) + place;
  first += 2 * inside;
  if (edge >= 0)
    return first + edge * in * up + (k - 1) * in + along;
  return first + 3 * in * up + (k - 1) * inside + place;
}

/* b: shares of the corners, which add up to n; the nodes of a triangle are numbered from the outside in, corners,
 * edges, next triangle. */
static int triangle_node(int n, int b0, int b1, int b2) {
  int b[3] = {b0, b1, b2}, first = 0;
  while (b[0] > 0 && b[1] > 0 && b[2] > 0) {
    first += 3 * n;
    n -= 3;
    for (int k = 0; k < 3; ++k)
      --b[k];
  }
  for (int k = 0; k < 3; ++k) {
    if (b[k] == n)
      return first + k;
  }
  for (int k = 0; k < 3; ++k) { /* the edge from corner k to the next */
    if (b[(k + 2) % 3] == 0)
      return first + 3 + k * (n - 1) + b[(k + 1) % 3] - 1;
  }
  return -1;
}

static int tetrahedron_node(int n, const int at[3]) {
  static const int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  static const int face[4][4] = {
      {0, 1, 3, 2}, {2, 3, 1, 0}, {0, 3, 2, 1}, {0, 2, 1, 3}}; /* its corners, then the one opposite */
  int b[4] = {n - at[0] - at[1] - at[2], at[0], at[1], at[2]}, first = 0;
  while (b[0] > 0 && b[1] > 0 && b[2] > 0 && b[3] > 0) {
    first += 2 * (n * n + 1);
    n -= 4;
    for (int k = 0; k < 4; ++k)
      --b[k];
  }
  for (int k = 0; k < 4; ++k) {
    if (b[k] == n)
      return first + k;
  }
  for (int k = 0; k < 6; ++k) {
    if (b[ends[k][0]] + b[ends[k][1]] == n)
      return first + 4 + k * (n - 1) + b[ends[k][1]] - 1;
  }
  first += 4 + 6 * (n - 1);
  for (int k = 0; k < 4; ++k) {
    if (b[face[k][3]] == 0)
      return first + k * (n - 1) * (n - 2) / 2 + triangle_node(n, b[face[k][0]], b[face[k][1]], b[face[k][2]]) - 3 * n;
  }
  return -1;
}

static int pyramid_node(const int at[3]) {
  static const int node[3][3][3] = {{{0, 5, 1}, {8, 13, 6}, {3, 7, 2}},
                                    {{9, 10, -1}, {12, 11, -1}, {-1, -1, -1}},
                                    {{4, -1, -1}, {-1, -1, -1}, {-1, -1, -1}}};
  return node[at[2]][at[1]][at[0]];
}

/* The node at a point of the lattice of the order's own size. */
static int own_node(const TcLattice *lattice, const int at[3]) {
  const int *n = lattice->order;
  const int node = lattice->shape == TC_HEXAHEDRON ? hexahedron_node(n, at)
                   : lattice->shape == TC_WEDGE    ? wedge_node(n[0], n[2], at)
                   : lattice->shape == TC_PYRAMID  ? pyramid_node(at)
                                                   : tetrahedron_node(n[0], at);
  if (lattice->with_middles && node >= 15)
    return node + 2; /* the middles of the wedge's triangles come before those of its quadrilaterals */
  return node < lattice->nodes ? node : -1;
}

int tc_lattice_node(const TcLattice *lattice, const int at[3]) {
  int own[3], ends = 0;
  for (int k = 0; k < 3; ++k) {
    const int scaled = at[k] * lattice->order[k];
    if (scaled % lattice->segments[k])
      return -1;
    own[k] = scaled / lattice->segments[k];
    ends += own[k] == 0 || own[k] == lattice->order[k];
  }
  const bool apex = lattice->shape == TC_PYRAMID && own[2] == lattice->order[2];
  if (lattice->bezier && ends < 3 && !apex)
    return -1; /* its nodes are not on it, but for corners */
  return own_node(lattice, own);
}

static bool same_key(const TcPointKey *a, const TcPointKey *b) {
  for (int k = 0; k < 4; ++k) {
    if (a->vertex[k] != b->vertex[k] || a->share[k] != b->share[k])
      return false;
  }
  return true;
}

int tc_lattice_shared_node(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell) {
  const TcPointKey key = tc_lattice_key(lattice, at, ids, cell);
  int other[3] = {-1, 0, 0};
  while (tc_lattice_next(lattice, other)) {
    const int node = tc_lattice_node(lattice, other);
    if (node < 0)
      continue;
    const TcPointKey of_other = tc_lattice_key(lattice, other, ids, cell);
    if (same_key(&key, &of_other))
      return node;
  }
  return -1;
}

/* ── shape functions ── */

/* Gives the share `w` of a point of the order's own lattice to the cell's nodes. A point without a node has the value
 * that serendipity cells have there: of a face's middle, −1/4 of its corners and 1/2 of its edges' middles; of the
 * cell's middle, 1/2 of the faces' middles, −1/4 of the edges', 1/8 of the corners. */
static void give(const TcLattice *lattice, const int at[3], double w, double *weight);

static void give_to_face(const TcLattice *lattice, int corner[4][3], double w, double *weight) {
  for (int k = 0; k < 4; ++k) {
    const int *a = corner[k], *b = corner[(k + 1) % 4];
    const int middle[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    give(lattice, a, -0.25 * w, weight);
    give(lattice, middle, 0.5 * w, weight);
  }
}

static void give(const TcLattice *lattice, const int at[3], double w, double *weight) {
  const int node = own_node(lattice, at);
  if (node >= 0) {
    weight[node] += w;
    return;
  }
  if (lattice->shape == TC_WEDGE) { /* (1, 0, 1), (1, 1, 1) or (0, 1, 1) */
    const int a[2] = {at[1] == 0 ? 0 : at[0] == 0 ? 0 : 2, 0}, b[2] = {at[1] == 0 ? 2 : 0, at[1] == 0 ? 0 : 2};
    int corner[4][3] = {{a[0], a[1], 0}, {b[0], b[1], 0}, {b[0], b[1], 2}, {a[0], a[1], 2}};
    give_to_face(lattice, corner, w, weight);
    return;
  }
  const int across = at[0] != 1 ? 0 : at[1] != 1 ? 1 : at[2] != 1 ? 2 : 3;
  if (across < 3) {
    int corner[4][3];
    for (int k = 0; k < 4; ++k) {
      corner[k][across] = at[across];
      corner[k][(across + 1) % 3] = k == 1 || k == 2 ? 2 : 0;
      corner[k][(across + 2) % 3] = k >= 2 ? 2 : 0;
    }
    give_to_face(lattice, corner, w, weight);
    return;
  }
  static const double share[4] = {0, 0.5, -0.25, 0.125}; /* by how many coordinates are at an end */
  for (int i = 0; i < 27; ++i) {
    const int other[3] = {i % 3, i / 3 % 3, i / 9};
    const int ends = (other[0] != 1) + (other[1] != 1) + (other[2] != 1);
    if (ends)
      give(lattice, other, share[ends] * w, weight);
  }
}

/* Function a of n + 1 on [0, 1] at x = at / segments. */
static double line(bool bezier, int n, int a, int at, int segments) {
  const double x = (double)at / segments, y = (double)(segments - at) / segments;
  double value = 1;
  if (bezier) {
    for (int k = 1; k <= a; ++k)
      value *= x * (n - a + k) / k;
    for (int k = a; k < n; ++k)
      value *= y;
    return value;
  }
  const double scaled = (double)(at * n) / segments;
  for (int k = 0; k <= n; ++k) {
    if (k != a)
      value *= (scaled - k) / (a - k);
  }
  return value;
}

/* The factor of function b (shares that add up to n) of a triangle or tetrahedron that is due to a corner with share at
 * / segments. */
static double corner_factor(bool bezier, int n, int b, int at, int segments) {
  double value = 1;
  for (int k = 0; k < b; ++k)
    value *= (bezier ? (double)at / segments : (double)(at * n) / segments - k) / (k + 1);
  return value;
}

static double factorial(int n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}

/* Bedrosian's functions (Int. J. Numer. Methods Eng. 35, 1992), and a bubble on the base if it has a node in the
 * middle. */
static void pyramid_weights(const TcLattice *lattice, const int at[3], double *weight) {
  const double s = lattice->segments[0], z = at[2] / s, h = (lattice->segments[0] - at[2]) / s;
  const double x = at[0] / s, y = at[1] / s, u = h - x, v = h - y;
  weight[4] = z * (2 * z - 1);
  if (at[2] == lattice->segments[2])
    return;
  const double a[4][2] = {{u, v}, {x, v}, {x, y}, {u, y}};
  for (int k = 0; k < 4; ++k) {
    weight[k] = 2 * a[k][0] * a[k][1] * (a[k][0] + a[k][1] - h - 0.5) / h;
    weight[9 + k] = 4 * z * a[k][0] * a[k][1] / h;
    weight[5 + k] = 4 * (k % 2 ? y * v * a[k][0] : x * u * a[k][1]) / h;
  }
  if (lattice->nodes < 14)
    return;
  const double bubble = 16 * x * u * y * v / (h * h);
  for (int k = 0; k < 4; ++k) {
    weight[k] += 0.25 * bubble;
    weight[5 + k] -= 0.5 * bubble;
  }
  weight[13] = bubble;
}

/* What a function that is 1 at node `middle`, and at no other, takes from those that surround it in a triangle of
 * second order, which have −1/9 (corners) and 4/9 (edges) of the value there by themselves. */
static void add_middle(double w, int middle, const int corner[3], const int edge[3], double *weight) {
  weight[middle] += w;
  for (int k = 0; k < 3; ++k) {
    weight[corner[k]] += w / 9;
    weight[edge[k]] -= 4 * w / 9;
  }
}

/* Adds the cubic functions of the triangles' middles, and that of the cell's: products of the shares of the corners.
 * What the others make there is taken off, the triangles' before the cell's. */
static void add_tetrahedron_middles(const double b[4], double *weight) {
  static const int corner[4][3] = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}},
                   edge[4][3] = {{4, 5, 6}, {4, 8, 7}, {5, 9, 8}, {6, 9, 7}};
  const double inside = 256 * b[0] * b[1] * b[2] * b[3];
  for (int f = 0; f < 4; ++f) {
    const double w = 27 * b[corner[f][0]] * b[corner[f][1]] * b[corner[f][2]];
    add_middle(w - inside * 27 / 64, 10 + f, corner[f], edge[f], weight); /* which is 27/64 in the cell's middle */
  }
  for (int k = 0; k < 4; ++k)
    weight[k] += inside / 8; /* where these have −1/8, and edges 1/4 */
  for (int k = 4; k < 10; ++k)
    weight[k] -= inside / 4;
  weight[14] += inside;
}

static void add_wedge_middles(const double b[3], double z, double *weight) {
  static const int corner[3][3] = {{0, 1, 2}, {3, 4, 5}, {12, 13, 14}},
                   edge[3][3] = {{6, 7, 8}, {9, 10, 11}, {17, 18, 19}};
  static const int middle[3] = {15, 16, 20};
  const double along[3] = {(1 - z) * (1 - 2 * z), z * (2 * z - 1), 4 * z * (1 - z)};
  for (int k = 0; k < 3; ++k)
    add_middle(27 * b[0] * b[1] * b[2] * along[k], middle[k], corner[k], edge[k], weight);
}

static void add_middles(const TcLattice *lattice, const int at[3], double *weight) {
  const double s = lattice->segments[0], x = at[0] / s, y = at[1] / s, z = (double)at[2] / lattice->segments[2];
  if (lattice->shape == TC_WEDGE) {
    add_wedge_middles((const double[3]){(s - at[0] - at[1]) / s, x, y}, z, weight);
  } else {
    add_tetrahedron_middles((const double[4]){(s - at[0] - at[1] - at[2]) / s, x, y, z}, weight);
  }
}

void tc_lattice_weights(const TcLattice *lattice, const int at[3], double *weight) {
  const int *n = lattice->order, *s = lattice->segments;
  for (int k = 0; k < lattice->nodes; ++k)
    weight[k] = 0;
  if (lattice->shape == TC_PYRAMID) {
    pyramid_weights(lattice, at, weight);
    return;
  }
  const bool bezier = lattice->bezier;
  int own[3] = {-1, 0, 0};
  while (next_point(lattice->shape, n, own)) {
    double w = 1;
    if (lattice->shape == TC_HEXAHEDRON) {
      for (int k = 0; k < 3; ++k)
        w *= line(bezier, n[k], own[k], at[k], s[k]);
    } else {
      const bool wedge = lattice->shape == TC_WEDGE;
      const int corners = wedge ? 2 : 3;
      int rest = n[0], rest_at = s[0];
      for (int k = 0; k < corners; ++k) {
        w *= corner_factor(bezier, n[0], own[k], at[k], s[0]);
        rest -= own[k];
        rest_at -= at[k];
      }
      w *= corner_factor(bezier, n[0], rest, rest_at, s[0]) * (bezier ? factorial(n[0]) : 1);
      if (wedge)
        w *= line(bezier, n[2], own[2], at[2], s[2]);
    }
    if (w != 0)
      give(lattice, own, w, weight);
  }
  if (lattice->with_middles)
    add_middles(lattice, at, weight);
}

/* ── keys ── */

static uint32_t common_divisor(uint32_t a, uint32_t b) {
  while (b) {
    const uint32_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

/* Each corner's share in a point if the cell was straight: on a face, only the face's corners have one, and it does not
 * depend on the cell. Returns how many corners there are. */
static int corner_shares(const TcLattice *lattice, const int at[3], uint32_t share[8]) {
  const int *s = lattice->segments;
  const uint32_t i = (uint32_t)at[0], j = (uint32_t)at[1], k = (uint32_t)at[2];
  const uint32_t n = (uint32_t)s[0], u = n - i, v = (uint32_t)s[1] - j, w = (uint32_t)s[2] - k;
  switch (lattice->shape) {
  case TC_TETRAHEDRON: {
    const uint32_t all[4] = {n - i - j - k, i, j, k};
    memcpy(share, all, sizeof all);
    return 4;
  }
  case TC_WEDGE: {
    const uint32_t rest = n - i - j, all[6] = {rest * w, i * w, j * w, rest * k, i * k, j * k};
    memcpy(share, all, sizeof all);
    return 6;
  }
  case TC_PYRAMID: {
    const uint32_t a = u - k, b = v - k, all[5] = {a * b, i * b, i * j, a * j, k * w};
    memcpy(share, all, sizeof all);
    return 5;
  }
  default: {
    const uint32_t all[8] = {u * v * w, i * v * w, i * j * w, u * j * w, u * v * k, i * v * k, i * j * k, u * j * k};
    memcpy(share, all, sizeof all);
    return 8;
  }
  }
}

TcPointKey tc_lattice_key(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell) {
  uint32_t share[8], divisor = 0;
  const int corners = corner_shares(lattice, at, share);
  TcPointKey key = {{0}, {0}};
  int count = 0;
  for (int corner = 0; corner < corners; ++corner) {
    if (!share[corner])
      continue;
    if (count == 4 && corners > 4) { /* inside: only this cell has it */
      return (TcPointKey){{(uint32_t)cell, (uint32_t)tc_lattice_index(lattice, at), UINT32_MAX, UINT32_MAX}, {0}};
    }
    int place = count;
    while (place > 0 && key.vertex[place - 1] >= ids[corner])
      --place;
    if (place == count || key.vertex[place] != ids[corner]) {
      for (int k = count++; k > place; --k) {
        key.vertex[k] = key.vertex[k - 1];
        key.share[k] = key.share[k - 1];
      }
      key.vertex[place] = ids[corner];
      key.share[place] = 0;
    }
    key.share[place] += share[corner]; /* more than one of a collapsed edge */
  }
  for (int k = 0; k < count; ++k)
    divisor = common_divisor(key.share[k], divisor);
  for (int k = 0; k < count; ++k)
    key.share[k] /= divisor;
  return key;
}

/* ── straight cells between the points ── */

typedef struct Parts {
  const TcLattice *lattice;
  TcPartFunction *use;
  void *user;
} Parts;

/* The cell whose corners are at `at` plus these. */
static void part(const Parts *parts, TcShapeName shape, const int at[3], const signed char (*offset)[3]) {
  uint32_t point[8];
  for (uint32_t c = 0; c < tc_shape(shape)->corners; ++c) {
    const int corner[3] = {at[0] + offset[c][0], at[1] + offset[c][1], at[2] + offset[c][2]};
    point[c] = (uint32_t)tc_lattice_index(parts->lattice, corner);
  }
  parts->use(parts->user, shape, point);
}

static void tetrahedron_parts(const Parts *parts, int n, const int at[3]) {
  static const signed char upright[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  static const signed char between[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
  static const signed char inverted[4][3] = {{1, 1, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 0}};
  const int sum = at[0] + at[1] + at[2];
  if (sum < n)
    part(parts, TC_TETRAHEDRON, at, upright);
  if (sum + 1 < n)
    part(parts, TC_OCTAHEDRON, at, between);
  if (sum + 2 < n)
    part(parts, TC_TETRAHEDRON, at, inverted);
}

static void wedge_parts(const Parts *parts, const int n[3], const int at[3]) {
  static const signed char upright[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  static const signed char inverted[6][3] = {{1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 1}, {1, 0, 1}};
  if (at[2] == n[2])
    return;
  if (at[0] + at[1] < n[0])
    part(parts, TC_WEDGE, at, upright);
  if (at[0] + at[1] + 1 < n[0])
    part(parts, TC_WEDGE, at, inverted);
}

static void pyramid_parts(const Parts *parts, int n, const int at[3]) {
  static const signed char upright[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  static const signed char inverted[5][3] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {1, 1, 0}};
  static const signed char along_x[4][3] = {
      {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}}; /* between pyramids beside each other */
  static const signed char along_y[4][3] = {{0, 0, 1}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}};
  const int layer = n - at[2];
  const bool x = at[0] + 1 < layer, y = at[1] + 1 < layer;
  if (at[0] == layer || at[1] == layer)
    return;
  part(parts, TC_PYRAMID, at, upright);
  if (x && y)
    part(parts, TC_PYRAMID, at, inverted);
  if (x)
    part(parts, TC_TETRAHEDRON, at, along_x);
  if (y)
    part(parts, TC_TETRAHEDRON, at, along_y);
}

void tc_lattice_parts(const TcLattice *lattice, TcPartFunction *use, void *user) {
  static const signed char box[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const Parts parts = {lattice, use, user};
  const int *n = lattice->segments;
  int at[3] = {-1, 0, 0};
  while (tc_lattice_next(lattice, at)) {
    switch (lattice->shape) {
    case TC_TETRAHEDRON:
      tetrahedron_parts(&parts, n[0], at);
      break;
    case TC_WEDGE:
      wedge_parts(&parts, n, at);
      break;
    case TC_PYRAMID:
      pyramid_parts(&parts, n[0], at);
      break;
    default:
      if (at[0] < n[0] && at[1] < n[1] && at[2] < n[2])
        part(&parts, TC_HEXAHEDRON, at, box);
    }
  }
}
