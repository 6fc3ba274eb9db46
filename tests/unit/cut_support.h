/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of cutting cells share: cells put together one by one, and what must hold of the tetrahedra. */
#ifndef CUT_SUPPORT_H
#define CUT_SUPPORT_H

#include "support.h"

typedef struct Build {
  int64_t point_count, cell_count, node_count, face_count;
  double (*points)[3];
  uint8_t *types;
  int64_t *offsets, *nodes, *places, *faces; /* faces: VTK's list; places: −1 but for polyhedra */
  double *volumes;                           /* of each cell, negative: not known */
} Build;

static inline void *enlarged(void *array, int64_t count, size_t size) {
  if (count & (count - 1))
    return array; /* at powers of two */
  return realloc(array, (size_t)(count ? 2 * count : 1) * size);
}

static inline int64_t build_point(Build *build, double x, double y, double z) {
  build->points = enlarged(build->points, build->point_count, sizeof *build->points);
  build->points[build->point_count][0] = x;
  build->points[build->point_count][1] = y;
  build->points[build->point_count][2] = z;
  return build->point_count++;
}

static inline void build_cell(Build *build, unsigned type, int64_t count, const int64_t *nodes, double volume) {
  const int64_t i = build->cell_count++;
  build->types = enlarged(build->types, i, sizeof *build->types);
  build->places = enlarged(build->places, i, sizeof *build->places);
  build->volumes = enlarged(build->volumes, i, sizeof *build->volumes);
  build->types[i] = (uint8_t)type;
  build->places[i] = -1;
  build->volumes[i] = volume;
  if (i == 0) {
    build->offsets = enlarged(build->offsets, 0, sizeof *build->offsets);
    build->offsets[0] = 0;
  }
  build->offsets = enlarged(build->offsets, i + 1, sizeof *build->offsets);
  for (int64_t k = 0; k < count; ++k) {
    build->nodes = enlarged(build->nodes, build->node_count, sizeof *build->nodes);
    build->nodes[build->node_count++] = nodes[k];
  }
  build->offsets[i + 1] = build->node_count;
}

static inline void build_face_value(Build *build, int64_t value) {
  build->faces = enlarged(build->faces, build->face_count, sizeof *build->faces);
  build->faces[build->face_count++] = value;
}

/* `faces`: places in `nodes`, −1 after each face, −2 at the end; some are turned over, and all begin somewhere. */
static inline void build_polyhedron(Build *build, int64_t count, const int64_t *nodes, const int *faces, double volume,
                                    uint64_t *seed) {
  build_cell(build, TETCAST_CELL_POLYHEDRON, count, nodes, volume);
  build->places[build->cell_count - 1] = build->face_count;
  const int64_t head = build->face_count;
  build_face_value(build, 0);
  for (; *faces != -2; ++faces) {
    int size = 0;
    while (faces[size] != -1)
      ++size;
    build_face_value(build, size);
    const int begin = (int)(size * uniform(seed));
    const bool turned = uniform(seed) < 0.4;
    for (int k = 0; k < size; ++k)
      build_face_value(build, nodes[faces[turned ? (begin + size - k) % size : (begin + k) % size]]);
    faces += size;
    ++build->faces[head];
  }
}

static inline void renumber_faces(int64_t *faces, int64_t count, const int64_t *number) {
  for (int64_t at = 0; at < count;) {
    const int64_t n = faces[at++];
    for (int64_t face = 0; face < n; ++face) {
      const int64_t size = faces[at++];
      for (int64_t k = 0; k < size; ++k, ++at)
        faces[at] = number[faces[at]];
    }
  }
}

/* Appends a copy whose point k becomes the order[k]-th of its own. */
static inline void build_append(Build *build, const Build *model, const int *order) {
  const int64_t first = build->point_count, face_first = build->face_count;
  for (int64_t k = 0; k < model->point_count; ++k)
    build_point(build, 0, 0, 0);
  int64_t number[8];
  for (int64_t k = 0; k < model->point_count; ++k) {
    number[k] = first + order[k];
    memcpy(build->points[number[k]], model->points[k], sizeof *model->points);
  }
  for (int64_t i = 0; i < model->cell_count; ++i) {
    int64_t nodes[8];
    const int64_t count = model->offsets[i + 1] - model->offsets[i];
    for (int64_t k = 0; k < count; ++k)
      nodes[k] = number[model->nodes[model->offsets[i] + k]];
    build_cell(build, model->types[i], count, nodes, model->volumes[i]);
    if (model->places[i] >= 0)
      build->places[build->cell_count - 1] = face_first + model->places[i];
  }
  for (int64_t k = 0; k < model->face_count; ++k)
    build_face_value(build, model->faces[k]);
  if (model->face_count)
    renumber_faces(build->faces + face_first, model->face_count, number);
}

/* Numbers all points anew, at random. */
static inline void build_shuffle(Build *build, uint64_t *seed) {
  const int64_t n = build->point_count;
  int64_t *number = malloc((size_t)n * sizeof *number);
  double(*points)[3] = malloc((size_t)n * sizeof *points);
  for (int64_t k = 0; k < n; ++k) {
    const int64_t other = (int64_t)((double)(k + 1) * uniform(seed));
    number[k] = number[other];
    number[other] = k;
  }
  for (int64_t k = 0; k < n; ++k)
    memcpy(points[number[k]], build->points[k], sizeof *points);
  memcpy(build->points, points, (size_t)n * sizeof *points);
  for (int64_t k = 0; k < build->node_count; ++k)
    build->nodes[k] = number[build->nodes[k]];
  renumber_faces(build->faces, build->face_count, number);
  free(points);
  free(number);
}

static inline void build_release(Build *build) {
  free(build->points);
  free(build->types);
  free(build->offsets);
  free(build->nodes);
  free(build->places);
  free(build->faces);
  free(build->volumes);
}

static inline TetcastCellsDesc build_desc(const Build *build) {
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){build->points, TETCAST_TYPE_FLOAT64, build->point_count, 0};
  desc.types = build->types;
  desc.offsets = (TetcastArray){build->offsets, TETCAST_TYPE_INT64, build->cell_count + 1, 0};
  desc.connectivity = (TetcastArray){build->nodes, TETCAST_TYPE_INT64, build->node_count, 0};
  desc.faces = (TetcastArray){build->faces, TETCAST_TYPE_INT64, build->face_count, 0};
  desc.face_offsets = (TetcastArray){build->places, TETCAST_TYPE_INT64, build->cell_count, 0};
  desc.sources = true;
  return desc;
}

typedef struct Face {
  int32_t v[3], way[3]; /* ascending, and counterclockwise from outside */
} Face;

typedef struct Result {
  Fixture *fixture;
  TetcastCut *cut;
  TetcastCutInfo info;
  const int32_t *tets;           /* [tetrahedra][4] */
  int64_t point_count, boundary; /* with those added; faces of one tetrahedron */
  double (*points)[3];
  Face *faces;                    /* of the boundary */
  double volume, total, smallest; /* signed, absolute, and of the smallest, signed */
  double enclosed;                /* by the boundary */
} Result;

static inline double determinant(const double *o, const double *a, const double *b, const double *c) {
  const double x[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]}, y[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]},
               z[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) + x[2] * (y[0] * z[1] - y[1] * z[0]);
}

static inline double volume_of_tet(const Result *result, int64_t i) {
  const int32_t *t = result->tets + 4 * i;
  return determinant(result->points[t[0]], result->points[t[1]], result->points[t[2]], result->points[t[3]]) / 6;
}

static inline Result cut_desc(const TetcastCellsDesc *desc, int threads) {
  Result result;
  memset(&result, 0, sizeof result);
  result.fixture = malloc(sizeof *result.fixture);
  assert_int_equal(fixture_begin(result.fixture, threads, 0), TETCAST_OK);
  if (tetcast_cells_cut(result.fixture->context, desc, &result.cut))
    fail_msg("%s", result.fixture->message);
  tetcast_cut_info(result.cut, &result.info);
  const TetcastArray tets = tetcast_cut_tetrahedra(result.cut);
  assert_int_equal(tets.count, result.info.tetrahedra);
  assert_int_equal(tets.type, TETCAST_TYPE_INT32);
  result.tets = tets.data;
  const int64_t n = desc->vertices.count;
  result.point_count = n + result.info.added_vertices;
  result.points = malloc((size_t)result.point_count * sizeof *result.points);
  memcpy(result.points, desc->vertices.data, (size_t)n * sizeof *result.points);
  assert_true(tetcast_cut_interpolate(result.cut, &desc->vertices, 3, result.points[n]));
  result.smallest = INFINITY;
  for (int64_t i = 0; i < tets.count; ++i) {
    for (int k = 0; k < 4; ++k)
      assert_in_range(result.tets[4 * i + k], 0, result.point_count - 1);
    const double volume = volume_of_tet(&result, i);
    result.volume += volume;
    result.total += fabs(volume);
    result.smallest = fmin(result.smallest, volume);
  }
  return result;
}

static inline Result cut_build(const Build *build, int threads, int subdivision) {
  TetcastCellsDesc desc = build_desc(build);
  desc.subdivision = subdivision;
  return cut_desc(&desc, threads);
}

static inline void result_release(Result *result) {
  tetcast_cut_destroy(&result->cut);
  free(result->points);
  free(result->faces);
  fixture_end(result->fixture);
  free(result->fixture);
}

static inline int compare_faces(const void *a, const void *b) {
  for (int k = 0; k < 3; ++k) {
    const int32_t x = ((const Face *)a)->v[k], y = ((const Face *)b)->v[k];
    if (x != y)
      return x < y ? -1 : 1;
  }
  return 0;
}

static inline void swap_if_above(int32_t *a, int32_t *b) {
  if (*a <= *b)
    return;
  const int32_t swap = *a;
  *a = *b;
  *b = swap;
}

/* Every face belongs to one tetrahedron or to two, on opposite sides; those of one are the boundary. */
static inline void check_faces(Result *result) {
  static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const int64_t count = 4 * result->info.tetrahedra;
  Face *faces = malloc((size_t)(count + 1) * sizeof *faces);
  for (int64_t i = 0; i < count; ++i) {
    const int32_t *t = result->tets + i / 4 * 4;
    for (int k = 0; k < 3; ++k)
      faces[i].v[k] = faces[i].way[k] = t[face[i % 4][k]];
    int32_t *v = faces[i].v;
    swap_if_above(&v[0], &v[1]);
    swap_if_above(&v[1], &v[2]);
    swap_if_above(&v[0], &v[1]);
    assert_true(v[0] < v[1] && v[1] < v[2]);
  }
  qsort(faces, (size_t)count, sizeof *faces, compare_faces);
  result->boundary = 0;
  result->enclosed = 0;
  for (int64_t i = 0, next; i < count; i = next) {
    next = i + 1;
    while (next < count && compare_faces(&faces[i], &faces[next]) == 0)
      ++next;
    assert_in_range(next - i, 1, 2);
    const int32_t *a = faces[i].way, *b = faces[next - 1].way;
    if (next - i == 2) { /* one clockwise, one counterclockwise */
      int k = 0;
      while (b[k] != a[0])
        ++k;
      assert_true(b[(k + 1) % 3] == a[2] && b[(k + 2) % 3] == a[1]);
    } else {
      faces[result->boundary++] = faces[i];
      result->enclosed +=
          determinant(result->points[0], result->points[a[0]], result->points[a[1]], result->points[a[2]]) / 6;
    }
  }
  result->faces = faces;
}

/* Each cell's tetrahedra have its volume, and come in the order of the cells. */
static inline void check_volumes(const Build *build, const Result *result, double tolerance) {
  double *sum = calloc((size_t)build->cell_count, sizeof *sum);
  const int32_t *source = tetcast_cut_sources(result->cut).data;
  for (int64_t i = 0; i < result->info.tetrahedra; ++i) {
    if (i > 0)
      assert_true(source[i] >= source[i - 1]);
    assert_in_range(source[i], 0, build->cell_count - 1);
    sum[source[i]] += volume_of_tet(result, i);
  }
  for (int64_t i = 0; i < build->cell_count; ++i) {
    if (build->volumes[i] >= 0 && !(fabs(sum[i] - build->volumes[i]) <= tolerance)) {
      fail_msg("cell %d of type %d: volume %.17g, not %.17g", (int)i, build->types[i], sum[i], build->volumes[i]);
    }
  }
  free(sum);
}

/* The boundary is cut by the diagonals through the smallest vertex of each quadrilateral. */
static inline void check_diagonals(const Build *build, const Result *result) {
  static const int quads[3][6][4] = {
      {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
      {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
      {{0, 1, 2, 3}}};
  for (int64_t i = 0; i < build->cell_count; ++i) {
    const int64_t *v = build->nodes + build->offsets[i];
    const unsigned type = build->types[i];
    const int kind = type == TETCAST_CELL_WEDGE ? 1 : type == TETCAST_CELL_PYRAMID ? 2 : 0;
    for (int q = 0; q < (kind == 0 ? 6 : kind == 1 ? 3 : 1); ++q) {
      const int *quad = quads[kind][q];
      int least = 0;
      for (int k = 1; k < 4; ++k)
        least = v[quad[k]] < v[quad[least]] ? k : least;
      for (int half = 0; half < 2; ++half) { /* without the diagonal's ends: present; with the other diagonal: not */
        for (int wrong = 0; wrong < 2; ++wrong) {
          const int a = least + wrong, corner[3] = {a % 4, (a + 1 + half) % 4, (a + 2 + half) % 4};
          Face face;
          for (int k = 0; k < 3; ++k)
            face.v[k] = (int32_t)v[quad[corner[k]]];
          swap_if_above(&face.v[0], &face.v[1]);
          swap_if_above(&face.v[1], &face.v[2]);
          swap_if_above(&face.v[0], &face.v[1]);
          const bool found =
              bsearch(&face, result->faces, (size_t)result->boundary, sizeof face, compare_faces) != NULL;
          if (wrong)
            assert_false(found);
        }
      }
    }
  }
}

/* A linear function of the vertices' places is itself at random points of the tetrahedra. */
static inline void check_linear(const Build *build, const Result *result, uint64_t *seed) {
  const double g[4] = {1.5, -0.75, 2, 3};
  const int64_t n = build->point_count;
  double *values = malloc((size_t)result->point_count * sizeof *values);
  for (int64_t i = 0; i < n; ++i)
    values[i] = g[0] * build->points[i][0] + g[1] * build->points[i][1] + g[2] * build->points[i][2] + g[3];
  const TetcastArray array = {values, TETCAST_TYPE_FLOAT64, n, 0};
  assert_true(tetcast_cut_interpolate(result->cut, &array, 1, values + n));
  for (int i = 0; i < 200 && result->info.tetrahedra; ++i) {
    const int32_t *t = result->tets + 4 * (int64_t)((double)result->info.tetrahedra * uniform(seed));
    double share[4], sum = 0, p[3] = {0}, value = 0;
    for (int k = 0; k < 4; ++k)
      sum += share[k] = uniform(seed) + 1e-3;
    for (int k = 0; k < 4; ++k) {
      value += share[k] / sum * values[t[k]];
      for (int d = 0; d < 3; ++d)
        p[d] += share[k] / sum * result->points[t[k]][d];
    }
    assert_true(fabs(value - (g[0] * p[0] + g[1] * p[1] + g[2] * p[2] + g[3])) < 1e-12 * (1 + fabs(value)));
  }
  free(values);
}

#endif
