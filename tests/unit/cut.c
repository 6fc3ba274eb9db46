/* SPDX-License-Identifier: Apache-2.0 */
/* Straight cells cut into tetrahedra: nothing missing, nothing twice, neighbours agree, however vertices are numbered.
 */
#include "cut_support.h"

/* The faces of cells, counterclockwise from outside, ended by −1; the list by −2. */
static const int hexahedron_faces[] = {0, 4, 7, 3,  -1, 1, 2, 6, 5,  -1, 0, 1, 5, 4,  -1, 3,
                                       7, 6, 2, -1, 0,  3, 2, 1, -1, 4,  5, 6, 7, -1, -2};

/* Unit cubes side by side: hexahedra, voxels, pyramids to a middle point, some of them as two tetrahedra, polyhedra, a
 * polyhedron of two cubes; and columns along x of wedges. */
static void add_cubes(Build *build, int n, uint64_t *seed, bool jitter) {
  int64_t *at = malloc((size_t)((n + 1) * (n + 1) * (n + 1)) * sizeof *at);
#define AT(i, j, k) at[(i) + (n + 1) * ((j) + (n + 1) * (k))]
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        double p[3] = {i, j, k};
        for (int c = 0; c < 3 && jitter; ++c)
          p[c] += p[c] > 0 && p[c] < n ? 0.2 * (uniform(seed) - 0.5) : 0;
        AT(i, j, k) = build_point(build, p[0], p[1], p[2]);
      }
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      const bool wedges = uniform(seed) < 0.3;
      for (int i = 0; i < n; ++i) {
        const int64_t v[8] = {AT(i, j, k),     AT(i + 1, j, k),     AT(i + 1, j + 1, k),     AT(i, j + 1, k),
                              AT(i, j, k + 1), AT(i + 1, j, k + 1), AT(i + 1, j + 1, k + 1), AT(i, j + 1, k + 1)};
        const int kind = (int)(5 * uniform(seed));
        if (wedges) { /* triangles 0 3 4 and 3 7 4 at the ends, which only wedges meet */
          const int64_t a[6] = {v[0], v[3], v[4], v[1], v[2], v[5]}, b[6] = {v[3], v[7], v[4], v[2], v[6], v[5]};
          build_cell(build, TETCAST_CELL_WEDGE, 6, a, 0.5);
          build_cell(build, TETCAST_CELL_WEDGE, 6, b, 0.5);
        } else if (kind == 0) {
          build_cell(build, TETCAST_CELL_HEXAHEDRON, 8, v, 1);
        } else if (kind == 1) {
          const int64_t w[8] = {v[0], v[1], v[3], v[2], v[4], v[5], v[7], v[6]};
          build_cell(build, TETCAST_CELL_VOXEL, 8, w, 1);
        } else if (kind == 2 || (kind == 4 && i + 1 == n)) {
          build_polyhedron(build, 8, v, hexahedron_faces, 1, seed);
        } else if (kind == 3) {
          const int64_t middle = build_point(build, i + 0.5, j + 0.5, k + 0.5);
          for (int face = 0; face < 6; ++face) {
            const int *f = hexahedron_faces + 5 * face;
            const int64_t w[5] = {v[f[0]], v[f[3]], v[f[2]], v[f[1]], middle};
            if (face == 1 && i + 1 == n) { /* at the end, where a diagonal is free */
              const int64_t a[4] = {w[0], w[1], w[2], middle}, b[4] = {w[0], w[2], w[3], middle};
              build_cell(build, TETCAST_CELL_TETRAHEDRON, 4, a, 1.0 / 12);
              build_cell(build, TETCAST_CELL_TETRAHEDRON, 4, b, 1.0 / 12);
            } else {
              build_cell(build, TETCAST_CELL_PYRAMID, 5, w, 1.0 / 6);
            }
          }
        } else {
          static const int faces[] = {0,  4, 7,  3, -1, 8,  9, 11, 10, -1, 0,  1, 5,  4,  -1, 1,  8,
                                      10, 5, -1, 3, 7,  6,  2, -1, 2,  6,  11, 9, -1, 0,  3,  2,  1,
                                      -1, 1, 2,  9, 8,  -1, 4, 5,  6,  7,  -1, 5, 10, 11, 6,  -1, -2};
          ++i;
          const int64_t w[12] = {v[0],
                                 v[1],
                                 v[2],
                                 v[3],
                                 v[4],
                                 v[5],
                                 v[6],
                                 v[7],
                                 AT(i + 1, j, k),
                                 AT(i + 1, j + 1, k),
                                 AT(i + 1, j, k + 1),
                                 AT(i + 1, j + 1, k + 1)};
          build_polyhedron(build, 12, w, faces, 2, seed);
        }
      }
    }
  }
#undef AT
  free(at);
}

/* A hexagon in the middle of six quadrilaterals, a pentagon, a triangle, a quadrilateral and a hexagon on four of
 * these, in layers: prisms of every kind, some as polyhedra; on top a tetrahedron and a pyramid. */
static void add_prisms(Build *build, int layers, uint64_t *seed) {
  enum { FLAT = 12 + 3 + 1 + 2 + 4 };
  double flat[FLAT][2];
  const double third = acos(-1) / 3;
  for (int k = 0; k < 6; ++k) {
    for (int ring = 0; ring < 2; ++ring) {
      flat[6 * ring + k][0] = (1 + ring) * cos(k * third);
      flat[6 * ring + k][1] = (1 + ring) * sin(k * third);
    }
  }
  /* On the outer edge from 6 + e to 7 + e: how many more corners, as parts along and away from the edge. */
  static const struct {
    int edge, more;
    double at[4][2];
  } outer[] = {{0, 3, {{1.1, 0.5}, {0.5, 0.9}, {-0.1, 0.5}}},
               {1, 1, {{0.5, 0.8}}},
               {2, 2, {{1, 0.7}, {0, 0.7}}},
               {4, 4, {{1.1, 0.4}, {0.9, 0.8}, {0.1, 0.8}, {-0.1, 0.4}}}};
  int polygon[11][6], sizes[11], count = 0, points = 12;
  sizes[count] = 6;
  for (int k = 0; k < 6; ++k)
    polygon[count][k] = k;
  ++count;
  for (int k = 0; k < 6; ++k, ++count) {
    const int corners[4] = {k, 6 + k, 6 + (k + 1) % 6, (k + 1) % 6};
    sizes[count] = 4;
    memcpy(polygon[count], corners, sizeof corners);
  }
  for (int o = 0; o < 4; ++o, ++count) {
    const int a = 6 + outer[o].edge, b = 6 + (outer[o].edge + 1) % 6;
    const double along[2] = {flat[b][0] - flat[a][0], flat[b][1] - flat[a][1]};
    sizes[count] = 2 + outer[o].more;
    polygon[count][0] = b;
    polygon[count][1] = a;
    for (int m = 0; m < outer[o].more; ++m) { /* from a's side back to b's */
      const double *t = outer[o].at[outer[o].more - 1 - m];
      flat[points][0] = flat[a][0] + t[0] * along[0] + t[1] * along[1];
      flat[points][1] = flat[a][1] + t[0] * along[1] - t[1] * along[0];
      polygon[count][2 + m] = points++;
    }
  }
  const int64_t first = build->point_count;
  for (int l = 0; l <= layers; ++l) {
    for (int k = 0; k < points; ++k)
      build_point(build, flat[k][0], flat[k][1], l * 0.7 + 0.05 * flat[k][0]);
  }
  for (int l = 0; l < layers; ++l) {
    for (int c = 0; c < count; ++c) {
      const int n = sizes[c];
      int64_t v[12];
      double area = 0;
      for (int k = 0; k < n; ++k) {
        const double *a = flat[polygon[c][k]], *b = flat[polygon[c][(k + 1) % n]];
        area += (a[0] * b[1] - a[1] * b[0]) / 2;
        v[k] = first + l * points + polygon[c][k];
        v[n + k] = v[k] + points;
      }
      static const unsigned types[] = {TETCAST_CELL_WEDGE, TETCAST_CELL_HEXAHEDRON, TETCAST_CELL_PENTAGONAL_PRISM,
                                       TETCAST_CELL_HEXAGONAL_PRISM};
      assert_true(area > 0);
      if (uniform(seed) < 0.3) {
        int faces[64], f = 0;
        for (int k = 0; k < n; ++k)
          faces[f++] = n - 1 - k;
        faces[f++] = -1;
        for (int k = 0; k < n; ++k)
          faces[f++] = n + k;
        faces[f++] = -1;
        for (int k = 0; k < n; ++k) {
          const int side[5] = {k, (k + 1) % n, n + (k + 1) % n, n + k, -1};
          memcpy(faces + f, side, sizeof side);
          f += 5;
        }
        faces[f] = -2;
        build_polyhedron(build, 2 * n, v, faces, 0.7 * area, seed);
      } else {
        build_cell(build, types[n - 3], 2 * n, v, 0.7 * area);
      }
      if (l + 1 == layers && n <= 4) {
        double top[3] = {0, 0, (layers + 1) * 0.7};
        for (int k = 0; k < n; ++k) {
          for (int d = 0; d < 2; ++d)
            top[d] += flat[polygon[c][k]][d] / n;
        }
        int64_t w[5];
        memcpy(w, v + n, sizeof *w * (size_t)n);
        w[n] = build_point(build, top[0], top[1], top[2] + 0.05 * top[0]);
        build_cell(build, n == 3 ? TETCAST_CELL_TETRAHEDRON : TETCAST_CELL_PYRAMID, n + 1, w, 0.7 * area / 3);
      }
    }
  }
}

static void test_mixed(void **state) {
  (void)state;
  for (uint64_t round = 1; round <= 60; ++round) {
    uint64_t seed = round;
    Build build = {0};
    if (round % 2)
      add_cubes(&build, 4, &seed, false);
    else
      add_prisms(&build, 3, &seed);
    build_shuffle(&build, &seed);
    Result result = cut_build(&build, 1 + (int)(round % 3), 0);
    check_volumes(&build, &result, 1e-12);
    check_faces(&result);
    check_linear(&build, &result, &seed);
    assert_int_equal(result.boundary, round % 2 ? 2 * 6 * 16 : result.boundary);
    assert_int_equal(result.info.cells, build.cell_count);
    if (!(round % 2))
      assert_int_equal(result.info.centred, 0);
    assert_int_equal(result.info.folded + result.info.open + result.info.inverted + result.info.collapsed, 0);
    assert_true(result.smallest > 1e-6); /* nothing flat, nothing turned over */
    result_release(&result);
    build_release(&build);
  }
}

/* Moved vertices make faces of hexahedra uneven: cells still fit together, and fill the cube. */
static void test_uneven(void **state) {
  (void)state;
  for (uint64_t round = 1; round <= 20; ++round) {
    uint64_t seed = round;
    Build build = {0};
    add_cubes(&build, 5, &seed, true);
    build_shuffle(&build, &seed);
    Result result = cut_build(&build, 2, 0);
    check_faces(&result);
    check_linear(&build, &result, &seed);
    assert_true(fabs(result.volume - 125) < 1e-10);
    assert_int_equal(result.boundary, 2 * 6 * 25);
    result_release(&result);
    build_release(&build);
  }
}

/* Every numbering of the vertices of one cell or of two that share a face. */
static void every_numbering(const Build *model, int64_t boundary) {
  const int n = (int)model->point_count;
  int order[8], limit = 1;
  for (int k = 1; k <= n; ++k)
    limit *= k;
  Build all = {0};
  for (int number = 0; number < limit; ++number) {
    int left[8], rest = number;
    for (int k = 0; k < n; ++k)
      left[k] = k;
    for (int k = n; k > 0; --k) {
      const int pick = rest % k;
      rest /= k;
      order[n - k] = left[pick];
      memmove(left + pick, left + pick + 1, sizeof *left * (size_t)(k - 1 - pick));
    }
    build_append(&all, model, order);
  }
  Result result = cut_build(&all, 2, 0);
  check_volumes(&all, &result, 1e-12);
  check_faces(&result);
  check_diagonals(&all, &result);
  assert_int_equal(result.boundary, boundary * limit);
  assert_int_equal(result.info.folded + result.info.centred, 0);
  assert_true(result.smallest > 0.01);
  result_release(&result);
  build_release(&all);
}

static void test_every_numbering(void **state) {
  (void)state;
  static const double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  static const int64_t v[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  const int corners[4] = {8, 8, 7, 8};
  for (int which = 0; which < 4; ++which) {
    Build model = {0};
    uint64_t seed = 1;
    for (int k = 0; k < corners[which]; ++k) {
      const double *p = cube[k];
      build_point(&model, p[0] + 0.3 * p[1], p[1] + (which == 2 && k == 6 ? 0.2 : 0), p[2] * (which == 2 ? 1.5 : 1));
    }
    if (which == 0)
      build_cell(&model, TETCAST_CELL_HEXAHEDRON, 8, v, 1);
    if (which == 1) {
      const int64_t a[6] = {0, 3, 4, 1, 2, 5}, b[6] = {3, 7, 4, 2, 6, 5};
      build_cell(&model, TETCAST_CELL_WEDGE, 6, a, 0.5);
      build_cell(&model, TETCAST_CELL_WEDGE, 6, b, 0.5);
    }
    if (which == 2) { /* a wedge, and a pyramid on one of its sides */
      const int64_t a[6] = {0, 3, 4, 1, 2, 5}, b[5] = {3, 4, 5, 2, 6};
      build_cell(&model, TETCAST_CELL_WEDGE, 6, a, 0.75);
      build_cell(&model, TETCAST_CELL_PYRAMID, 5, b, -1);
    }
    if (which == 3)
      build_polyhedron(&model, 8, v, hexahedron_faces, 1, &seed);
    every_numbering(&model, which == 0 || which == 3 ? 12 : which == 1 ? 12 : 10);
    build_release(&model);
  }
}

/* A hexahedron whose far corner no diagonal goes through needs five tetrahedra, any other six. */
static void test_five_or_six(void **state) {
  (void)state;
  static const double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  static const int64_t ascending[8] = {0, 1, 2, 3, 4, 5, 6, 7}, five[8] = {0, 3, 1, 4, 5, 2, 6, 7};
  for (int which = 0; which < 2; ++which) {
    const int64_t *v = which ? five : ascending;
    Build build = {0};
    for (int k = 0; k < 8; ++k) {
      int at = 0;
      while (v[at] != k)
        ++at;
      build_point(&build, cube[at][0], cube[at][1], cube[at][2]);
    }
    build_cell(&build, TETCAST_CELL_HEXAHEDRON, 8, v, 1);
    Result result = cut_build(&build, 1, 0);
    check_volumes(&build, &result, 1e-14);
    check_faces(&result);
    assert_int_equal(result.boundary, 12);
    assert_int_equal(tetcast_cut_tetrahedra(result.cut).count, which ? 5 : 6);
    result_release(&result);
    build_release(&build);
  }
}

/* A wedge, a pyramid and a tetrahedron written as hexahedra. */
static void test_collapsed(void **state) {
  (void)state;
  static const struct {
    double p[8][3];
    int64_t v[8], points, boundary;
    double volume;
  } cases[] = {
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {0, 1, 2, 2, 3, 4, 5, 5}, 6, 8, 0.5},
      {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 1, 2, 3, 4, 4, 4, 4}, 5, 6, 1.0 / 3},
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 1, 2, 2, 3, 3, 3, 3}, 4, 4, 1.0 / 6},
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2, 2, 0, 1, 2, 2}, 3, 0, 0},
  };
  for (int which = 0; which < 4; ++which) {
    for (uint64_t round = 1; round <= 50; ++round) {
      uint64_t seed = round;
      Build build = {0};
      for (int64_t k = 0; k < cases[which].points; ++k)
        build_point(&build, cases[which].p[k][0], cases[which].p[k][1], cases[which].p[k][2]);
      build_cell(&build, TETCAST_CELL_HEXAHEDRON, 8, cases[which].v, cases[which].volume);
      build_shuffle(&build, &seed);
      Result result = cut_build(&build, 1, 0);
      check_volumes(&build, &result, 1e-14);
      check_faces(&result);
      assert_int_equal(result.boundary, cases[which].boundary);
      assert_int_equal(result.info.collapsed, 1);
      assert_int_equal(result.info.empty, which == 3);
      assert_int_equal(result.info.folded, 0);
      result_release(&result);
      build_release(&build);
    }
  }
}

/* What a surface encloses, whatever is inside: cells far from convex, turned over, tangled. */
static void test_misshapen(void **state) {
  (void)state;
  int centred = 0, folded = 0, inverted = 0;
  for (uint64_t round = 1; round <= 400; ++round) {
    uint64_t seed = round;
    Build build = {0};
    static const double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const int64_t v[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const double wild = 0.4 * (double)(round % 5);
    for (int k = 0; k < 8; ++k) {
      double p[3];
      for (int d = 0; d < 3; ++d)
        p[d] = cube[k][d] + wild * (uniform(&seed) - 0.5);
      build_point(&build, round % 7 == 0 ? -p[0] : p[0], p[1], p[2]);
    }
    build_cell(&build, TETCAST_CELL_HEXAHEDRON, 8, v, 0);
    build_shuffle(&build, &seed);
    Result result = cut_build(&build, 1, 0);
    check_faces(&result);
    check_linear(&build, &result, &seed);
    assert_int_equal(result.boundary, 12);
    assert_true(fabs(result.volume - result.enclosed) < 1e-13);
    assert_int_equal(result.info.inverted, result.volume < 0);
    if (!result.info.folded)
      assert_true(result.total <= fabs(result.volume) * (1 + 3e-6));
    else
      assert_true(result.total > fabs(result.volume) * (1 + 1e-6));
    centred += result.info.centred > 0;
    folded += result.info.folded > 0;
    inverted += result.info.inverted > 0;
    result_release(&result);
    build_release(&build);
  }
  assert_true(centred > 10 && folded > 10 && inverted > 50);
  print_message("of 400 wild hexahedra %d got a vertex inside, %d are folded, %d inverted\n", centred, folded,
                inverted);
}

/* The same to the bit with any number of threads, in blocks of cells with and without added vertices. */
static void test_threads(void **state) {
  (void)state;
  uint64_t seed = 5;
  Build build = {0};
  for (int i = 0; i < 40; ++i) {
    const int64_t before = build.point_count;
    add_cubes(&build, 7, &seed, false);
    for (int64_t k = before; k < build.point_count && i % 2; ++k) {
      for (int d = 0; d < 3; ++d)
        build.points[k][d] += 0.9 * (uniform(&seed) - 0.5);
    }
  }
  assert_true(build.cell_count > 3 * 4096);
  build_shuffle(&build, &seed);
  Result one = cut_build(&build, 1, 0);
  assert_true(one.info.centred > 100);
  for (int threads = 2; threads <= 5; ++threads) {
    Result many = cut_build(&build, threads, 0);
    const TetcastArray a = tetcast_cut_tetrahedra(one.cut), b = tetcast_cut_tetrahedra(many.cut);
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.data, b.data, (size_t)a.count * 16);
    assert_memory_equal(tetcast_cut_sources(one.cut).data, tetcast_cut_sources(many.cut).data, (size_t)a.count * 4);
    assert_int_equal(one.point_count, many.point_count);
    assert_memory_equal(one.points, many.points, (size_t)one.point_count * sizeof *one.points);
    assert_memory_equal(&one.info, &many.info, sizeof one.info);
    result_release(&many);
  }
  result_release(&one);
  build_release(&build);
}

/* Arrays of other types, without offsets, with strides, with hidden cells and others than these. */
static void test_arrays(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  float points[9][4] = {{0, 0, 0, 9}, {1, 0, 0, 9}, {1, 1, 0, 9}, {0, 1, 0, 9}, {0, 0, 1, 9},
                        {1, 0, 1, 9}, {1, 1, 1, 9}, {0, 1, 1, 9}, {0, 0, 2, 9}};
  uint64_t cells[3][10] = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}};
  const uint8_t hidden[3] = {1, 0, 2};
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){points, TETCAST_TYPE_FLOAT32, 9, sizeof *points};
  desc.connectivity = (TetcastArray){cells, TETCAST_TYPE_UINT64, 3, sizeof *cells};
  desc.hidden = hidden;
  desc.hidden_bits = 6;
  TetcastCut *cut;
  assert_int_equal(tetcast_cells_cut(fixture.context, &desc, &cut), TETCAST_OK);
  assert_int_equal(tetcast_cut_tetrahedra(cut).count, 12);
  assert_int_equal(tetcast_cut_sources(cut).count, 0);
  TetcastCutInfo info;
  tetcast_cut_info(cut, &info);
  assert_int_equal(info.cells, 2);
  double result;
  assert_false(tetcast_cut_interpolate(cut, &desc.connectivity, 1, &result));
  tetcast_cut_destroy(&cut);
  assert_null(cut);
  tetcast_cut_destroy(&cut);
  tetcast_cut_destroy(NULL);
  int32_t nodes[] = {0, 1, 0, 1, 3, 4, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  const uint32_t offsets[] = {0, 2, 6, 15};
  const uint8_t types[] = {3, TETCAST_CELL_TETRAHEDRON, TETCAST_CELL_HEXAHEDRON};
  desc.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT32, 15, 0};
  desc.offsets = (TetcastArray){offsets, TETCAST_TYPE_UINT32, 4, 0};
  desc.types = types;
  desc.hidden = NULL;
  desc.sources = true;
  assert_int_equal(tetcast_cells_cut(fixture.context, &desc, &cut), TETCAST_OK);
  assert_int_equal(tetcast_cut_tetrahedra(cut).count, 7);
  const int32_t *source = tetcast_cut_sources(cut).data;
  assert_true(source[0] == 1 && source[1] == 2 && source[6] == 2);
  tetcast_cut_info(cut, &info);
  assert_int_equal(info.oversized, 1);
  tetcast_cut_destroy(&cut);
  desc.offsets.count = 1; /* no cells at all */
  assert_int_equal(tetcast_cells_cut(fixture.context, &desc, &cut), TETCAST_OK);
  assert_int_equal(tetcast_cut_tetrahedra(cut).count, 0);
  tetcast_cut_destroy(&cut);
  fixture_end(&fixture);
}

static void assert_refused(Fixture *fixture, const TetcastCellsDesc *desc, TetcastStatus status, const char *words) {
  TetcastCut *cut = (TetcastCut *)fixture;
  fixture->messages = 0;
  assert_int_equal(tetcast_cells_cut(fixture->context, desc, &cut), status);
  assert_null(cut);
  assert_int_equal(fixture->messages, 1);
  if (!strstr(fixture->message, words))
    fail_msg("'%s' lacks '%s'", fixture->message, words);
}

static void test_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  double points[8][3] = {{0}};
  int64_t nodes[] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3}, offsets[] = {0, 8, 12}, places[] = {-1, 0};
  uint8_t types[] = {TETCAST_CELL_HEXAHEDRON, TETCAST_CELL_TETRAHEDRON};
  int64_t faces[] = {4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 2, 3};
  TetcastCellsDesc good = tetcast_cells_desc_default();
  good.vertices = (TetcastArray){points, TETCAST_TYPE_FLOAT64, 8, 0};
  good.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT64, 12, 0};
  good.offsets = (TetcastArray){offsets, TETCAST_TYPE_INT64, 3, 0};
  good.faces = (TetcastArray){faces, TETCAST_TYPE_INT64, 17, 0};
  good.face_offsets = (TetcastArray){places, TETCAST_TYPE_INT64, 2, 0};
  good.types = types;
  TetcastCut *cut;
  assert_int_equal(tetcast_cells_cut(fixture.context, &good, &cut), TETCAST_OK);
  tetcast_cut_destroy(&cut);
  TetcastCellsDesc desc = {0};
  assert_refused(&fixture, &desc, TETCAST_ERROR_ARGUMENT, "_default()");
  desc = good;
  desc.vertices.type = TETCAST_TYPE_INT32;
  assert_refused(&fixture, &desc, TETCAST_ERROR_ARGUMENT, "vertices");
  desc = good;
  desc.offsets.type = TETCAST_TYPE_FLOAT64;
  assert_refused(&fixture, &desc, TETCAST_ERROR_ARGUMENT, "offsets");
  desc = good;
  desc.offsets.count = 0;
  assert_refused(&fixture, &desc, TETCAST_ERROR_ARGUMENT, "offsets");
  desc = good;
  desc.subdivision = TETCAST_MAX_SUBDIVISION + 1;
  assert_refused(&fixture, &desc, TETCAST_ERROR_ARGUMENT, "subdivision");
  desc = good;
  desc.connectivity.count = 11;
  assert_refused(&fixture, &desc, TETCAST_ERROR_DATA, "cell 1: its offsets");
  const int64_t bad_nodes[] = {8, -1, INT64_MAX, (int64_t)1 << 32};
  for (int i = 0; i < 4; ++i) {
    nodes[9] = bad_nodes[i];
    assert_refused(&fixture, &good, TETCAST_ERROR_DATA, "cell 1 names a vertex");
  }
  nodes[9] = 1;
  /* A cube that nothing else is wrong with: what is beyond the vertices would make one. */
  const double cube[9][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},
                             {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 1, 0}};
  int32_t narrow[8] = {0, 1, 2, 8, 4, 5, 6, 7};
  desc = good;
  desc.vertices.data = cube;
  for (int i = 0; i < 4; ++i) {
    nodes[3] = bad_nodes[i];
    assert_refused(&fixture, &desc, TETCAST_ERROR_DATA, "cell 0 names a vertex");
  }
  nodes[3] = 3;
  desc.types = NULL;
  desc.offsets.count = 0;
  desc.type = TETCAST_CELL_HEXAHEDRON;
  desc.connectivity = (TetcastArray){narrow, TETCAST_TYPE_INT32, 1, 0};
  for (int i = 0; i < 2; ++i) {
    narrow[3] = i ? -1 : 8;
    assert_refused(&fixture, &desc, TETCAST_ERROR_DATA, "cell 0 names a vertex");
  }
  const struct {
    int64_t *at, value;
    const char *words;
  } bad[] = {{&offsets[1], 13, "cell 0: its offsets"},
             {&offsets[1], -1, "cell 0: its offsets"},
             {&offsets[0], -1, "cell 0: its offsets"},
             {&offsets[1], 7, "cell 0: 7 nodes"},
             {&offsets[1], 9, "cell 1: 3 nodes"}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    const int64_t was = *bad[i].at;
    *bad[i].at = bad[i].value;
    assert_refused(&fixture, &good, TETCAST_ERROR_DATA, bad[i].words);
    *bad[i].at = was;
  }
  types[1] = TETCAST_CELL_LAGRANGE_TETRAHEDRON; /* of first order, with four nodes */
  assert_int_equal(tetcast_cells_cut(fixture.context, &good, &cut), TETCAST_OK);
  tetcast_cut_destroy(&cut);
  const double orders[2][3] = {{0, 0, 0}, {2, 2, 2}};
  desc = good;
  desc.orders = (TetcastArray){orders, TETCAST_TYPE_FLOAT64, 2, 0};
  assert_refused(&fixture, &desc, TETCAST_ERROR_DATA, "cell 1: 4 nodes");
  types[1] = TETCAST_CELL_LAGRANGE_WEDGE;
  assert_refused(&fixture, &good, TETCAST_ERROR_DATA, "cell 1: 4 nodes");
  types[1] = TETCAST_CELL_POLYHEDRON;
  assert_int_equal(tetcast_cells_cut(fixture.context, &good, &cut), TETCAST_OK);
  tetcast_cut_destroy(&cut);
  const struct {
    int64_t *at, value;
  } damage[] = {{&faces[0], 3},   {&faces[0], 5},   {&faces[0], INT64_MAX}, {&faces[0], -1},
                {&faces[1], 2},   {&faces[1], 40},  {&faces[1], INT64_MAX}, {&faces[16], 4},
                {&faces[16], -1}, {&places[1], 17}, {&places[1], -1},       {&places[1], 1}};
  for (size_t i = 0; i < sizeof damage / sizeof *damage; ++i) {
    const int64_t was = *damage[i].at;
    *damage[i].at = damage[i].value;
    assert_refused(&fixture, &good, TETCAST_ERROR_DATA, "cell 1: the list of the polyhedron's faces is damaged");
    *damage[i].at = was;
  }
  desc = good;
  desc.faces.count = 0;
  assert_refused(&fixture, &desc, TETCAST_ERROR_DATA, "damaged");
  fixture_end(&fixture);
}

/* Faces that leave an edge open, and points that no face has, even the smallest. */
static void test_open_polyhedra(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double points[6][3] = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const int32_t nodes[] = {0, 1, 2, 3, 4, 4}, offsets[] = {0, 6}, places[] = {0};
  int32_t faces[] = {4, 3, 1, 2, 3, 3, 1, 2, 4, 3, 2, 3, 4, 3, 1, 3, 4};
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.type = TETCAST_CELL_POLYHEDRON;
  desc.vertices = (TetcastArray){points, TETCAST_TYPE_FLOAT64, 6, 0};
  desc.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT32, 6, 0};
  desc.offsets = (TetcastArray){offsets, TETCAST_TYPE_INT32, 2, 0};
  desc.faces = (TetcastArray){faces, TETCAST_TYPE_INT32, 17, 0};
  desc.face_offsets = (TetcastArray){places, TETCAST_TYPE_INT32, 1, 0};
  for (int open = 0; open < 2; ++open) {
    TetcastCut *cut;
    TetcastCutInfo info;
    if (open)
      faces[16] = 2;
    assert_int_equal(tetcast_cells_cut(fixture.context, &desc, &cut), TETCAST_OK);
    tetcast_cut_info(cut, &info);
    assert_int_equal(info.open, open);
    if (!open) {
      assert_int_equal(info.tetrahedra, 1);
      const int32_t *t = tetcast_cut_tetrahedra(cut).data;
      assert_true(t[0] == 1 && t[1] + t[2] + t[3] == 2 + 3 + 4);
    }
    tetcast_cut_destroy(&cut);
  }
  fixture_end(&fixture);
}

/* Lack of memory at any moment is reported once, and nothing is left behind. */
static void test_memory(void **state) {
  (void)state;
  uint64_t seed = 3;
  Build build = {0};
  add_cubes(&build, 3, &seed, false);
  for (int64_t k = 0; k < build.point_count; ++k)
    build.points[k][0] += 0.9 * (uniform(&seed) - 0.5);
  long fail_at = 1;
  for (bool failed = true; failed; ++fail_at) {
    Fixture fixture;
    if (fixture_begin(&fixture, 1, fail_at))
      continue;
    const TetcastCellsDesc desc = build_desc(&build);
    TetcastCut *cut;
    const TetcastStatus status = tetcast_cells_cut(fixture.context, &desc, &cut);
    failed = status != TETCAST_OK;
    if (failed) {
      assert_int_equal(status, TETCAST_ERROR_MEMORY);
      assert_int_equal(fixture.messages, 1);
      assert_null(cut);
    }
    tetcast_cut_destroy(&cut);
    fixture_end(&fixture);
  }
  assert_true(fail_at > 8);
  build_release(&build);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_mixed),          cmocka_unit_test(test_uneven),    cmocka_unit_test(test_every_numbering),
      cmocka_unit_test(test_five_or_six),    cmocka_unit_test(test_collapsed), cmocka_unit_test(test_misshapen),
      cmocka_unit_test(test_threads),        cmocka_unit_test(test_arrays),    cmocka_unit_test(test_refused),
      cmocka_unit_test(test_open_polyhedra), cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
