/* SPDX-License-Identifier: Apache-2.0 */
/* Curved cells: their nodes are where VTK has them, neighbours share the points between, fields are as the shape
 * functions say. */
#include "cut_support.h"

/* Where VTK has the nodes of a cell of second order, in halves; the others are numbered by what it prints for each
 * point, x fastest. */
static const int second[27][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                                  {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                                  {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {0, 1, 1},
                                  {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}, {1, 1, 1}};
static const int wedge[18][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2},
                                 {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2},
                                 {0, 0, 1}, {2, 0, 1}, {0, 2, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int flat_wedge[12][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2},
                                      {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
static const int tetrahedron[10][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0},
                                       {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
/* In sixths, of a pyramid from a side of a cube to its middle: corners, apex, the middles of the base's edges and of
 * the base. */
static const int pyramid[10][3] = {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {3, 3, 3},
                                   {3, 0, 0}, {6, 3, 0}, {3, 6, 0}, {0, 3, 0}, {3, 3, 0}};
static const signed char hexahedron343[80] = {
    0,  8,  9,  1,  15, 56, 57, 10, 16, 58, 59, 11, 17, 60, 61, 12, 3,  13, 14, 2,  28, 48, 49, 30, 36, 68, 69,
    42, 37, 70, 71, 43, 38, 72, 73, 44, 34, 52, 53, 32, 29, 50, 51, 31, 39, 74, 75, 45, 40, 76, 77, 46, 41, 78,
    79, 47, 35, 54, 55, 33, 4,  18, 19, 5,  25, 62, 63, 20, 26, 64, 65, 21, 27, 66, 67, 22, 7,  23, 24, 6};
static const signed char wedge34[50] = {0,  6,  7,  1,  11, 27, 8,  10, 9,  2,  18, 29, 30, 21, 42, 47, 35,
                                        41, 36, 24, 19, 31, 32, 22, 44, 48, 37, 43, 38, 25, 20, 33, 34, 23,
                                        46, 49, 39, 45, 40, 26, 3,  12, 13, 4,  17, 28, 14, 16, 15, 5};
static const signed char tetrahedron5[56] = {0,  4,  5,  6,  7,  1,  15, 46, 51, 48, 8,  14, 49, 50, 9,  13, 47, 10, 12,
                                             11, 2,  16, 28, 31, 29, 20, 40, 52, 53, 36, 45, 54, 39, 42, 34, 24, 17, 33,
                                             32, 21, 43, 55, 38, 44, 37, 25, 18, 30, 22, 41, 35, 26, 19, 23, 27, 3};

typedef struct Kind {
  unsigned type;
  int shape; /* 8, 6, 5 or 4: its corners */
  int nodes, order[3];
} Kind;

static const Kind kinds[] = {{TETCAST_CELL_QUADRATIC_HEXAHEDRON, 8, 20, {2, 2, 2}},
                             {TETCAST_CELL_BIQUADRATIC_QUADRATIC_HEXAHEDRON, 8, 24, {2, 2, 2}},
                             {TETCAST_CELL_TRIQUADRATIC_HEXAHEDRON, 8, 27, {2, 2, 2}},
                             {TETCAST_CELL_LAGRANGE_HEXAHEDRON, 8, 80, {3, 4, 3}},
                             {TETCAST_CELL_BEZIER_HEXAHEDRON, 8, 80, {3, 4, 3}},
                             {TETCAST_CELL_QUADRATIC_WEDGE, 6, 15, {2, 2, 2}},
                             {TETCAST_CELL_QUADRATIC_LINEAR_WEDGE, 6, 12, {2, 2, 1}},
                             {TETCAST_CELL_BIQUADRATIC_QUADRATIC_WEDGE, 6, 18, {2, 2, 2}},
                             {TETCAST_CELL_LAGRANGE_WEDGE, 6, 50, {3, 3, 4}},
                             {TETCAST_CELL_BEZIER_WEDGE, 6, 50, {3, 3, 4}},
                             {TETCAST_CELL_QUADRATIC_TETRAHEDRON, 4, 10, {2, 2, 2}},
                             {TETCAST_CELL_LAGRANGE_TETRAHEDRON, 4, 56, {5, 5, 5}},
                             {TETCAST_CELL_BEZIER_TETRAHEDRON, 4, 56, {5, 5, 5}},
                             {TETCAST_CELL_QUADRATIC_PYRAMID, 5, 13, {2, 2, 2}},
                             {TETCAST_CELL_TRIQUADRATIC_PYRAMID, 5, 19, {2, 2, 2}},
                             {TETCAST_CELL_LAGRANGE_WEDGE, 6, 21, {2, 2, 2}},
                             {TETCAST_CELL_LAGRANGE_TETRAHEDRON, 4, 15, {2, 2, 2}}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* In twelfths, the middles of triangles and of the cell that two kinds have as well, and their first numbers. */
static const int tetrahedron_middles[5][3] = {{4, 4, 0}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4}, {3, 3, 3}};
static const int wedge_middles[6][3] = {{4, 4, 0}, {4, 4, 12}, {6, 0, 6}, {6, 6, 6}, {0, 6, 6}, {4, 4, 6}};

/* Where node i of the cell is, in its own coordinates from 0 to 1. */
static void place_node(const Kind *kind, int i, double at[3]) {
  if ((kind->nodes == 15 && kind->shape == 4 && i >= 10) || (kind->nodes == 21 && i >= 15)) {
    const int *place = kind->shape == 4 ? tetrahedron_middles[i - 10] : wedge_middles[i - 15];
    for (int d = 0; d < 3; ++d)
      at[d] = place[d] / 12.0;
    return;
  }
  const signed char *number = kind->nodes == 80   ? hexahedron343
                              : kind->nodes == 50 ? wedge34
                              : kind->nodes == 56 ? tetrahedron5
                                                  : NULL;
  if (kind->shape == 5) {
    const bool side = i >= 9 && i < 13; /* in the middle of an edge to the apex */
    for (int d = 0; d < 3; ++d)
      at[d] = side ? (pyramid[i - 9][d] + pyramid[4][d]) / 12.0 : pyramid[i == 13 ? 9 : i][d] / 6.0;
    return;
  }
  if (!number) {
    const int(*table)[3] = kind->shape == 8    ? second
                           : kind->shape == 4  ? tetrahedron
                           : kind->nodes == 12 ? flat_wedge
                                               : wedge;
    for (int d = 0; d < 3; ++d)
      at[d] = table[i][d] / 2.0;
    return;
  }
  const int *n = kind->order;
  int at_number = 0;
  for (int z = 0; z <= n[2]; ++z) {
    for (int y = 0; y <= n[1]; ++y) {
      for (int x = 0; x <= n[0]; ++x) {
        if (kind->shape == 6 && x + y > n[0])
          continue;
        if (kind->shape == 4 && x + y + z > n[0])
          continue;
        if (number[at_number++] != i)
          continue;
        at[0] = (double)x / n[0];
        at[1] = (double)y / n[1];
        at[2] = (double)z / n[2];
        return;
      }
    }
  }
  fail();
}

/* The point at a place, made when it is not there yet. */
static int64_t point_at(Build *build, const double p[3]) {
  for (int64_t i = 0; i < build->point_count; ++i) {
    const double *q = build->points[i];
    if (fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]) < 1e-9)
      return i;
  }
  return build_point(build, p[0], p[1], p[2]);
}

/* A curved cell: its own coordinates are mapped by origin + x a + y b + z c. */
static void add_curved(Build *build, const Kind *kind, const double origin[3], const double a[3], const double b[3],
                       const double c[3], double volume) {
  int64_t nodes[80];
  for (int i = 0; i < kind->nodes; ++i) {
    double t[3] = {0, 0, 0}, p[3];
    if (i < 14 || kind->shape != 5)
      place_node(kind, i, t);
    for (int d = 0; d < 3; ++d)
      p[d] = origin[d] + t[0] * a[d] + t[1] * b[d] + t[2] * c[d];
    nodes[i] =
        i >= 14 && kind->shape == 5 ? build_point(build, 77, 77, 77) : point_at(build, p); /* those are not looked at */
  }
  build_cell(build, kind->type, kind->nodes, nodes, volume);
}

/* The cube at x, of cells of one kind. */
static void add_cube(Build *build, const Kind *kind, int cube) {
  static const int edge[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const double o[3] = {cube, 0, 0}, e[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (kind->shape == 8)
    add_curved(build, kind, o, e[0], e[1], e[2], 1);
  if (kind->shape == 6) { /* triangles at the ends along z, mirrored in the second */
    const double far[3] = {cube + 1, 1, 0}, back[2][3] = {{-1, 0, 0}, {0, -1, 0}};
    add_curved(build, kind, o, e[0], e[1], e[2], 0.5);
    add_curved(build, kind, far, back[0], back[1], e[2], 0.5);
  }
  if (kind->shape == 4) { /* from one corner to the opposite one, along edges in every order */
    for (int k = 0; k < 6; ++k) {
      double to[3][3] = {{0}};
      for (int step = 0; step < 3; ++step) {
        for (int later = step; later < 3; ++later)
          to[later][edge[k][step]] = 1;
      }
      const bool even = k < 3;
      add_curved(build, kind, o, to[0], even ? to[1] : to[2], even ? to[2] : to[1], 1.0 / 6);
    }
  }
  if (kind->shape == 5) { /* on each side of the cube, to its middle */
    for (int d = 0; d < 3; ++d) {
      const int x = (d + 1) % 3, y = (d + 2) % 3;
      double down[3] = {-e[d][0], -e[d][1], -e[d][2]}, top[3] = {o[0] + e[d][0], o[1] + e[d][1], o[2] + e[d][2]};
      add_curved(build, kind, o, e[x], e[y], e[d], 1.0 / 6);
      add_curved(build, kind, top, e[y], e[x], down, 1.0 / 6);
    }
  }
}

/* Two cubes side by side along x. */
static void add_pair(Build *build, const Kind *kind) {
  add_cube(build, kind, 0);
  add_cube(build, kind, 1);
}

static int64_t boundary_of(const Kind *kind, int subdivision) {
  const int64_t n[3] = {subdivision ? subdivision : kind->order[0], subdivision ? subdivision : kind->order[1],
                        subdivision ? subdivision : kind->order[2]};
  return 2 * (4 * n[0] * n[1] + 4 * n[0] * n[2] + 2 * n[1] * n[2]);
}

/* Straight or bent, at their own nodes or subdivided otherwise: neighbours agree, nothing is missing. */
static void test_pairs(void **state) {
  (void)state;
  static const int subdivisions[] = {0, 1, 2, 3, 5};
  for (int k = 0; k < KINDS; ++k) {
    for (int s = 0; s < 5; ++s) {
      for (uint64_t round = 1; round <= 6; ++round) {
        uint64_t seed = round;
        const bool bent = round % 2;
        Build build = {0};
        add_pair(&build, &kinds[k]);
        for (int64_t i = 0; i < build.point_count && bent; ++i) {
          double *p = build.points[i];
          const double x = p[0], y = p[1], z = p[2]; /* the outside stays where it is */
          p[0] += 0.2 * x * (2 - x) * y * (1 - y);
          p[1] += 0.2 * x * (2 - x) * y * (1 - y) * (z + 0.5);
        }
        build_shuffle(&build, &seed);
        double orders[64][3];
        for (int64_t i = 0; i < build.cell_count; ++i) {
          for (int d = 0; d < 3; ++d)
            orders[i][d] = kinds[k].order[d];
        }
        TetcastCellsDesc desc = build_desc(&build);
        desc.orders = (TetcastArray){orders, TETCAST_TYPE_FLOAT64, build.cell_count, 0};
        desc.subdivision = subdivisions[s];
        Result result = cut_desc(&desc, 1 + (int)(round % 2));
        check_faces(&result);
        check_linear(&build, &result, &seed);
        if (!bent)
          check_volumes(&build, &result, 1e-12);
        if (!bent)
          assert_true(result.smallest > 1e-6);
        assert_int_equal(result.boundary, boundary_of(&kinds[k], subdivisions[s]));
        assert_int_equal(result.info.curved, build.cell_count);
        assert_int_equal(result.info.folded + result.info.inverted + result.info.collapsed, 0);
        assert_int_equal(result.info.segments[1], subdivisions[s]                                ? subdivisions[s]
                                                  : kinds[k].nodes == 80 || kinds[k].nodes == 50 ? 4
                                                                                                 : kinds[k].order[0]);
        result_release(&result);
        build_release(&build);
      }
    }
  }
}

/* Neighbours of other shapes share the points between them, too. */
static void test_mixed(void **state) {
  (void)state;
  const int rows[2][4] = {{0, 5, 13, 0}, {2, 7, 14, 7}}; /* faces with eight nodes, with nine */
  for (int row = 0; row < 2; ++row) {
    for (int subdivision = 0; subdivision <= 6; ++subdivision) {
      uint64_t seed = (uint64_t)subdivision + 1;
      Build build = {0};
      for (int cube = 0; cube < 4; ++cube)
        add_cube(&build, &kinds[rows[row][cube]], cube);
      build_shuffle(&build, &seed);
      Result result = cut_build(&build, 1, subdivision);
      check_volumes(&build, &result, 1e-12);
      check_faces(&result);
      const int64_t n = subdivision ? subdivision : 2;
      assert_int_equal(result.boundary, 2 * 18 * n * n);
      result_release(&result);
      build_release(&build);
    }
  }
}

static double quadratic(const double p[3]) {
  return 1 + p[0] * p[0] - 2 * p[0] * p[1] + 3 * p[2] * p[2] + p[1] * p[2] - p[1];
}

/* Shape functions of second order and above have every quadratic function exactly, so it is there at points that are
 * added. */
static void test_shape_functions(void **state) {
  (void)state;
  for (int k = 0; k < KINDS; ++k) {
    const Kind *kind = &kinds[k];
    const bool bezier = kind->type >= TETCAST_CELL_BEZIER_TETRAHEDRON;
    if (bezier || kind->type == TETCAST_CELL_QUADRATIC_LINEAR_WEDGE)
      continue;
    for (int subdivision = 0; subdivision <= 7; ++subdivision) {
      Build build = {0};
      add_pair(&build, kind);
      double orders[64][3], values[1024], added[20000];
      for (int64_t i = 0; i < build.cell_count; ++i) {
        for (int d = 0; d < 3; ++d)
          orders[i][d] = kind->order[d];
      }
      for (int64_t i = 0; i < build.point_count; ++i)
        values[i] = quadratic(build.points[i]);
      TetcastCellsDesc desc = build_desc(&build);
      desc.orders = (TetcastArray){orders, TETCAST_TYPE_FLOAT64, build.cell_count, 0};
      desc.subdivision = subdivision;
      Result result = cut_desc(&desc, 1);
      const TetcastArray array = {values, TETCAST_TYPE_FLOAT64, build.point_count, 0};
      assert_in_range(result.info.added_vertices, 0, 20000);
      assert_true(tetcast_cut_interpolate(result.cut, &array, 1, added));
      for (int64_t i = 0; i < result.info.added_vertices; ++i) {
        const double expected = quadratic(result.points[build.point_count + i]);
        if (fabs(added[i] - expected) > 1e-11)
          fail_msg("type %u, subdivision %d: %g, not %g", kind->type, subdivision, added[i], expected);
      }
      result_release(&result);
      build_release(&build);
    }
  }
}

/* Functions that cells with nodes in the middles of their triangles have: those of second order, the products of three
 * corners' shares, and of all four; of a wedge those of a triangle times 1, z and z². */
static int span(const Kind *kind, const double p[3], double value[21]) {
  const double x = p[0], y = p[1], z = p[2];
  if (kind->shape == 6) {
    const double flat[7] = {1, x, y, x * x, x * y, y * y, x * y * (1 - x - y)};
    for (int i = 0; i < 21; ++i)
      value[i] = flat[i % 7] * (i < 7 ? 1 : i < 14 ? z : z * z);
    return 21;
  }
  const double w = 1 - x - y - z;
  const double all[15] = {1,     x,     y,         z,         x * x,     y * y,     z * z,        x * y,
                          y * z, z * x, w * x * y, w * x * z, x * y * z, w * y * z, w * x * y * z};
  memcpy(value, all, sizeof all);
  return 15;
}

/* Coefficients of these that make the function which has these values at the nodes, by elimination. */
static void solve(const Kind *kind, const double *values, double coefficient[21]) {
  double row[21][22];
  int n = kind->nodes;
  for (int i = 0; i < n; ++i) {
    double at[3];
    place_node(kind, i, at);
    assert_int_equal(span(kind, at, row[i]), n);
    row[i][n] = values[i];
  }
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int i = k; i < n; ++i)
      best = fabs(row[i][k]) > fabs(row[best][k]) ? i : best;
    for (int j = 0; j <= n; ++j) {
      const double swap = row[k][j];
      row[k][j] = row[best][j];
      row[best][j] = swap;
    }
    for (int i = 0; i < n; ++i) {
      const double factor = i == k ? 0 : row[i][k] / row[k][k];
      for (int j = k; j <= n; ++j)
        row[i][j] -= factor * row[k][j];
    }
  }
  for (int k = 0; k < n; ++k)
    coefficient[k] = row[k][n] / row[k][k];
}

/* What the nodes in the middles say counts wherever such a cell is cut. */
static void test_middles(void **state) {
  (void)state;
  static const double o[3] = {0, 0, 0}, e[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = KINDS - 2; k < KINDS; ++k) {
    const Kind *kind = &kinds[k];
    for (int subdivision = 0; subdivision <= 7; ++subdivision) {
      uint64_t seed = (uint64_t)subdivision + 1;
      Build build = {0};
      add_curved(&build, kind, o, e[0], e[1], e[2], kind->shape == 6 ? 0.5 : 1.0 / 6);
      double values[21], coefficient[21], added[1000];
      for (int i = 0; i < kind->nodes; ++i)
        values[build.nodes[i]] = uniform(&seed);
      solve(kind, values, coefficient);
      Result result = cut_build(&build, 1, subdivision);
      const TetcastArray array = {values, TETCAST_TYPE_FLOAT64, kind->nodes, 0};
      assert_in_range(result.info.added_vertices, 0, 1000);
      assert_true(tetcast_cut_interpolate(result.cut, &array, 1, added));
      for (int64_t i = 0; i < result.info.added_vertices; ++i) {
        double terms[21], expected = 0;
        const int n = span(kind, result.points[build.point_count + i], terms);
        for (int j = 0; j < n; ++j)
          expected += coefficient[j] * terms[j];
        assert_true(fabs(added[i] - expected) < 1e-11);
      }
      assert_true(subdivision != 3 || result.info.added_vertices > 0);
      result_release(&result);
      build_release(&build);
    }
  }
}

/* The middle of some nodes, which is a node of its own for each set of different ones. */
static int64_t middle_of(Build *build, const int64_t *corner, const int *which, int count) {
  double p[3] = {0, 0, 0};
  for (int i = 0; i < count; ++i) {
    for (int d = 0; d < 3; ++d)
      p[d] += build->points[corner[which[i]]][d] / count;
  }
  return point_at(build, p);
}

/* A hexahedron of second order of 20, 24 or 27 nodes with corners that may be the same. */
static void add_second(Build *build, const int64_t corner[8], int nodes, double volume) {
  static const int edge[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  static const int face[6][4] = {{0, 3, 7, 4}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}},
                   all[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  int64_t node[27];
  for (int i = 0; i < 8; ++i)
    node[i] = corner[i];
  for (int i = 0; i < 12; ++i)
    node[8 + i] = middle_of(build, corner, edge[i], 2);
  for (int i = 0; i < 6; ++i)
    node[20 + i] = middle_of(build, corner, face[i], 4);
  node[26] = middle_of(build, corner, all, 8);
  const unsigned type = nodes == 20   ? TETCAST_CELL_QUADRATIC_HEXAHEDRON
                        : nodes == 24 ? TETCAST_CELL_BIQUADRATIC_QUADRATIC_HEXAHEDRON
                                      : TETCAST_CELL_TRIQUADRATIC_HEXAHEDRON;
  build_cell(build, type, nodes, node, volume);
}

/* Wedges, pyramids and tetrahedra written as hexahedra of second order, and a ring of such wedges around an axis: what
 * becomes one is one. */
static void test_collapsed(void **state) {
  (void)state;
  static const int64_t single[4][8] = {
      {0, 1, 2, 2, 4, 5, 6, 6}, {0, 1, 2, 0, 4, 5, 6, 4}, {0, 1, 2, 3, 8, 8, 8, 8}, {0, 1, 2, 2, 4, 4, 4, 4}};
  static const double volumes[4] = {0.5, 0.5, 1.0 / 3, 1.0 / 6};
  static const double corner[9][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},    {0, 0, 1},
                                      {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 1}};
  static const double ring[5][2] = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  static const int sizes[3] = {20, 24, 27};
  for (int which = 0; which < 5; ++which) {
    for (int round = 0; round < 36; ++round) {
      uint64_t seed = (uint64_t)round + 1;
      const int nodes = sizes[round % 3], subdivision = round / 3 % 4;
      Build build = {0};
      if (which < 4) {
        for (int i = 0; i < 9; ++i)
          build_point(&build, corner[i][0], corner[i][1], corner[i][2]);
        add_second(&build, single[which], nodes, volumes[which]);
      } else {
        for (int i = 0; i < 10; ++i)
          build_point(&build, ring[i % 5][0], ring[i % 5][1], i / 5);
        for (int i = 0; i < 4; ++i) {
          const int64_t a = 1 + i, b = 1 + (i + 1) % 4, v[8] = {0, a, b, 0, 5, 5 + a, 5 + b, 5};
          add_second(&build, v, nodes, 0.5);
        }
      }
      build_shuffle(&build, &seed);
      Result result = cut_build(&build, 1, subdivision);
      check_volumes(&build, &result, 1e-12);
      check_faces(&result);
      assert_true(fabs(result.enclosed - result.volume) < 1e-12);
      assert_true(result.smallest > 1e-6);
      assert_int_equal(result.info.collapsed, build.cell_count);
      assert_int_equal(result.info.folded + result.info.empty, 0);
      const int64_t n = subdivision ? subdivision : 2;
      /* A cell's bottom and top have n triangles at the edge that has collapsed and 2n(n - 1) others each; its outside
       * has 2n². */
      if (which == 4)
        assert_int_equal(result.boundary, 4 * (2 * (n + 2 * n * (n - 1)) + 2 * n * n));
      result_release(&result);
      build_release(&build);
    }
  }
}

/* A quarter of a circle is rational: the points of a rational Bezier cell are on it. */
static void test_rational(void **state) {
  (void)state;
  double points[27][3], weights[27];
  static const double arc[3][2] = {{1, 0}, {1, 1}, {0, 1}};
  int64_t nodes[27], offsets[2] = {0, 27};
  for (int i = 0; i < 27; ++i) {
    const int *at = second[i];
    const double radius = 1 + at[1] / 2.0;
    points[i][0] = radius * arc[at[0]][0];
    points[i][1] = radius * arc[at[0]][1];
    points[i][2] = at[2] / 2.0;
    weights[i] = at[0] == 1 ? sqrt(0.5) : 1;
    nodes[i] = i;
  }
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.type = TETCAST_CELL_BEZIER_HEXAHEDRON;
  desc.vertices = (TetcastArray){points, TETCAST_TYPE_FLOAT64, 27, 0};
  desc.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT64, 27, 0};
  desc.offsets = (TetcastArray){offsets, TETCAST_TYPE_INT64, 2, 0};
  desc.rational = (TetcastArray){weights, TETCAST_TYPE_FLOAT64, 27, 0};
  desc.subdivision = 8;
  Result result = cut_desc(&desc, 1);
  check_faces(&result);
  for (int64_t i = 27; i < result.point_count; ++i) {
    const double *p = result.points[i], radius = hypot(p[0], p[1]);
    assert_true(fabs(radius * 8 - round(radius * 8)) < 1e-12);
  }
  const double expected = acos(-1) / 4 * 3;
  assert_true(fabs(fabs(result.volume) - expected) < 0.01 * expected);
  result_release(&result);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pairs),           cmocka_unit_test(test_mixed),
                                     cmocka_unit_test(test_shape_functions), cmocka_unit_test(test_rational),
                                     cmocka_unit_test(test_middles),         cmocka_unit_test(test_collapsed)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
