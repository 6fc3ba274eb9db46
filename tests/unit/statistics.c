/* SPDX-License-Identifier: Apache-2.0 */
/* Statistics against closed forms: a linear field in a box, whose distribution is known whatever its cells are, the
 * distance from a point of a cone; against sums in extended precision that are written another way; quantiles against
 * the distribution; extremes. */
#include "support.h"

#include <float.h>

typedef struct Subject {
  Fixture fixture;
  Cube cube;
  TetcastMesh *mesh;
} Subject;

static void subject_begin(Subject *s, int n, double jitter, int threads) {
  assert_int_equal(fixture_begin(&s->fixture, threads, 0), TETCAST_OK);
  s->cube = cube_create(n, jitter);
  s->mesh = cube_mesh(s->fixture.context, &s->cube);
}

static void subject_end(Subject *s) {
  tetcast_mesh_destroy(&s->mesh);
  cube_destroy(&s->cube);
  fixture_end(&s->fixture);
}

static TetcastStatistics *statistics_of(Subject *s, const double *values, TetcastAssociation association,
                                        const TetcastStatisticsDesc *desc) {
  const int64_t count = association == TETCAST_POINT  ? s->cube.vertex_count
                        : association == TETCAST_CELL ? s->cube.cell_count
                                                      : 4 * s->cube.cell_count;
  TetcastField *field = field_of(s->fixture.context, values, count, association);
  TetcastStatistics *statistics = NULL;
  assert_int_equal(tetcast_statistics_create(s->fixture.context, s->mesh, field, desc, &statistics), TETCAST_OK);
  tetcast_field_destroy(&field);
  return statistics;
}

static void near(double got, double wanted, double tolerance, const char *what, int i) {
  if (!(fabs(got - wanted) <= tolerance))
    fail_msg("%s %d: %.17g, not %.17g", what, i, got, wanted);
}

/* The share of the unit cube in which a x + b y + c z is below v, and the area of the plane in the cube: sums over its
 * corners. */
static double cube_below(const double g[3], double v) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double at = 0;
    for (int k = 0; k < 3; ++k)
      at += corner >> k & 1 ? g[k] : 0;
    sum += (__builtin_popcount((unsigned)corner) & 1 ? -1 : 1) * pow(fmax(0, v - at), 3);
  }
  return sum / (6 * g[0] * g[1] * g[2]);
}
static double cube_area(const double g[3], double v) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double at = 0;
    for (int k = 0; k < 3; ++k)
      at += corner >> k & 1 ? g[k] : 0;
    sum += (__builtin_popcount((unsigned)corner) & 1 ? -1 : 1) * pow(fmax(0, v - at), 2);
  }
  return sum / (2 * g[0] * g[1] * g[2]) * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

static void a_linear_field_is_that_of_its_box(void **state) {
  (void)state;
  static const double g[3] = {0.5, 0.75, 1.5};
  const double steep = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int i = 0; i < 4; ++i) {
    Subject s;
    subject_begin(&s, 5, i & 1 ? 0.6 : 0, 2);
    double *values = malloc((size_t)(4 * s.cube.cell_count) * sizeof *values);
    const bool corners = i & 2;
    for (int64_t j = 0; j < (corners ? 4 * s.cube.cell_count : s.cube.vertex_count); ++j) {
      const double *p = &s.cube.vertices[3 * (corners ? s.cube.cells[j] : j)];
      values[j] = g[0] * p[0] + g[1] * p[1] + g[2] * p[2];
    }
    TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
    desc.range[0] = 0.25;
    desc.range[1] = 2.6; /* cuts off some at either end */
    desc.bins = 47;
    desc.gradient_bins = 5;
    desc.gradient_range[1] = 2 * steep;
    TetcastStatistics *t = statistics_of(&s, values, corners ? TETCAST_CORNER : TETCAST_POINT, &desc);
    near(t->total, 1, 1e-13, "total", 0);
    near(t->below, cube_below(g, 0.25), 1e-13, "below", 0);
    near(t->above, 1 - cube_below(g, 2.6), 1e-12, "above", 0);
    for (int b = 0; b <= t->bins; ++b) {
      const double low = 0.25 + b * (2.6 - 0.25) / 47, high = low + (2.6 - 0.25) / 47;
      near(t->area[b], cube_area(g, low), 1e-12, "area", b);
      near(t->gradient[b], steep * cube_area(g, low), 1e-12, "gradient", b);
      if (b < t->bins) {
        near(t->volume[b], cube_below(g, high) - cube_below(g, low), 1e-12, "volume", b);
        for (int row = 0; row < 5; ++row)
          near(t->joint[row * 47 + b], row == 2 ? t->volume[b] : 0, 1e-13, "joint", b);
      }
    }
    tetcast_statistics_destroy(s.fixture.context, &t);
    free(values);
    subject_end(&s);
  }
}

/* Isosurfaces in faces between cells, and through vertices, count once. */
static void a_layer_counts_once(void **state) {
  (void)state;
  Subject s;
  subject_begin(&s, 5, 0, 2);
  double *values = malloc((size_t)s.cube.vertex_count * sizeof *values);
  for (int64_t j = 0; j < s.cube.vertex_count; ++j)
    values[j] = s.cube.vertices[3 * j];
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  desc.bins = 10;
  TetcastStatistics *t = statistics_of(&s, values, TETCAST_POINT, &desc);
  for (int b = 0; b <= 10; ++b) {
    near(t->area[b], b > 0, 1e-13, "area", b); /* at the smallest value nothing is below, so there is no surface */
    near(t->gradient[b], b > 0, 1e-13, "gradient", b);
    if (b < 10)
      near(t->volume[b], 0.1, 1e-13, "volume", b);
  }
  tetcast_statistics_destroy(s.fixture.context, &t);
  free(values);
  subject_end(&s);
}

/* ── any field ── */

typedef long double Real;

/* The share of a tetrahedron above v by the formula of divided differences, in extended precision; values that are
 * equal are moved apart a little. */
static Real share_above(const double value[4], Real v) {
  Real s[4], sum = 0;
  for (int k = 0; k < 4; ++k)
    s[k] = value[k];
  for (int k = 0; k < 4; ++k) {
    Real product = 1;
    for (int j = 0; j < 4; ++j)
      product *= j == k ? 1 : s[k] - s[j];
    sum += (s[k] > v ? (s[k] - v) * (s[k] - v) * (s[k] - v) : 0) / product;
  }
  return sum;
}

static void a_random_field_is_the_sum_of_its_cells(void **state) {
  (void)state;
  Subject s;
  subject_begin(&s, 4, 0.6, 2);
  TetcastStatistics *t = statistics_of(&s, s.cube.values, TETCAST_POINT, NULL);
  assert_int_equal(t->bins, 256);
  double sum = t->below;
  for (int b = 0; b <= t->bins; ++b) {
    const double edge = b == t->bins ? t->range[1] : t->range[0] + b * (t->range[1] / 256 - t->range[0] / 256);
    Real wanted = 0;
    for (int64_t c = 0; c < s.cube.cell_count; ++c) {
      Real p[4][3], e[3][3];
      double value[4];
      for (int k = 0; k < 4; ++k) {
        value[k] = s.cube.values[s.cube.cells[4 * c + k]];
        for (int j = 0; j < 3; ++j)
          p[k][j] = s.cube.vertices[3 * s.cube.cells[4 * c + k] + j];
      }
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
          e[k][j] = p[k + 1][j] - p[0][j];
      const Real volume =
          fabsl(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
          6;
      wanted += volume * (1 - share_above(value, edge));
    }
    near(sum, (double)wanted, 1e-11, "below edge", b); /* the reference cancels where values are close */
    if (b < t->bins)
      sum += t->volume[b];
  }
  near(sum + t->above, t->total, 1e-13, "all", 0);
  tetcast_statistics_destroy(s.fixture.context, &t);
  subject_end(&s);
}

/* Quantiles of a linear field, and of cells, where they are steps; shares 0 and 1 are the range. */
static void quantiles_are_where_the_volume_is(void **state) {
  (void)state;
  static const double g[3] = {0.5, 0.75, 1.5}, shares[] = {0, 1e-6, 0.01, 0.25, 0.5, 0.5, 0.99, 1};
  Subject s;
  subject_begin(&s, 5, 0.6, 2);
  double *values = malloc((size_t)s.cube.cell_count * sizeof *values), found[8];
  for (int64_t j = 0; j < s.cube.vertex_count; ++j) {
    const double *p = &s.cube.vertices[3 * j];
    values[j] = g[0] * p[0] + g[1] * p[1] + g[2] * p[2];
  }
  TetcastField *field = field_of(s.fixture.context, values, s.cube.vertex_count, TETCAST_POINT);
  assert_int_equal(tetcast_statistics_quantiles(s.fixture.context, s.mesh, field, shares, 8, found), TETCAST_OK);
  assert_true(found[0] == 0 && found[7] == 2.75 && found[4] == found[5]);
  for (int i = 1; i < 7; ++i)
    near(cube_below(g, found[i]), shares[i], 1e-13, "quantile", i);
  tetcast_field_destroy(&field);
  for (int64_t j = 0; j < s.cube.cell_count; ++j) /* the jitter leaves the outer layer's volume as it may be */
    values[j] = j < s.cube.cell_count / 2 ? 7 : j == s.cube.cell_count - 1 ? (double)NAN : -3;
  field = field_of(s.fixture.context, values, s.cube.cell_count, TETCAST_CELL);
  assert_int_equal(tetcast_statistics_quantiles(s.fixture.context, s.mesh, field, shares, 8, found), TETCAST_OK);
  assert_true(found[0] == -3 && fabs(found[2] + 3) < 1e-14 && fabs(found[6] - 7) < 1e-14 && found[7] == 7);
  TetcastStatistics *t = statistics_of(&s, values, TETCAST_CELL, NULL);
  assert_true(t->unknown > 0);
  near(t->volume[0] + t->volume[255], t->total, 1e-13, "cells", 0);
  assert_true(t->volume[0] > 0.3 && t->volume[255] > 0.3 && t->area[128] == 0);
  tetcast_statistics_destroy(s.fixture.context, &t);
  tetcast_field_destroy(&field);
  free(values);
  subject_end(&s);
}

/* A value of another magnitude, where there is no cell, hides none of the others; a plateau at 0 is exactly 0. */
static void quantiles_beside_a_mark(void **state) {
  (void)state;
  static const double shares[] = {0.01, 0.25, 0.5, 0.99};
  Subject s;
  subject_begin(&s, 4, 0.6, 2);
  const int64_t count = s.cube.vertex_count;
  double *vertices = malloc((size_t)(count + 1) * 3 * sizeof *vertices),
         *values = malloc((size_t)(count + 1) * sizeof *values);
  memcpy(vertices, s.cube.vertices, (size_t)count * 3 * sizeof *vertices);
  memset(vertices + 3 * count, 0, 3 * sizeof *vertices);
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT64, count + 1, 0};
  desc.tetrahedra = (TetcastArray){s.cube.cells, TETCAST_TYPE_INT64, s.cube.cell_count, 0};
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(s.fixture.context, &desc, &mesh), TETCAST_OK);
  for (int flat = 0; flat < 2; ++flat) {
    double wanted[4], found[4];
    for (int64_t i = 0; i < count; ++i)
      values[i] = flat ? fmax(0, vertices[3 * i] - 0.9) : sin(9 * vertices[3 * i] + 4 * vertices[3 * i + 1]);
    static const double marks[] = {0, 1e12, 1e30, -1e36, 1e60};
    for (size_t k = 0; k < sizeof marks / sizeof *marks; ++k) {
      values[count] = marks[k];
      TetcastField *field = field_of(s.fixture.context, values, count + 1, TETCAST_POINT);
      assert_int_equal(tetcast_statistics_quantiles(s.fixture.context, mesh, field, shares, 4, k ? found : wanted),
                       TETCAST_OK);
      for (int i = 0; k > 0 && i < 4; ++i)
        if (!(fabs(found[i] - wanted[i]) <= 1e-12))
          fail_msg("flat %d mark %g share %g: %.17g, wanted %.17g", flat, marks[k], shares[i], found[i], wanted[i]);
      tetcast_field_destroy(&field);
    }
    if (flat)
      assert_true(wanted[1] == 0 && found[1] == 0 && wanted[3] > 0);
  }
  tetcast_mesh_destroy(&mesh);
  free(vertices);
  free(values);
  subject_end(&s);
}

/* ── extremes ── */

/* In units far from 1, with values that differ by the last bits, and constant: nothing is NaN, and volumes add up. */
static void no_unit_is_too_large_or_small(void **state) {
  (void)state;
  static const double lengths[] = {1, 1e-90, 1e90}, scales[] = {1, 1e-300, 1e300, 0x1p-1070, 0};
  for (size_t i = 0; i < 15; ++i) {
    Subject s;
    assert_int_equal(fixture_begin(&s.fixture, 2, 0), TETCAST_OK);
    s.cube = cube_create(3, 0.6);
    const double length = lengths[i / 5], scale = scales[i % 5];
    for (int64_t j = 0; j < 3 * s.cube.vertex_count; ++j)
      s.cube.vertices[j] *= length;
    s.mesh = cube_mesh(s.fixture.context, &s.cube);
    for (int close = 0; close < 2; ++close) {
      double *values = malloc((size_t)s.cube.vertex_count * sizeof *values), quantile, half = 0.5;
      for (int64_t j = 0; j < s.cube.vertex_count; ++j)
        values[j] = scale * (close ? 1 + (double)(j % 4) * DBL_EPSILON : s.cube.values[j]);
      TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
      desc.gradient_bins = 16;
      TetcastStatistics *t = statistics_of(&s, values, TETCAST_POINT, &desc);
      const double all = length * length * length;
      double sum = t->below + t->above, joint = 0;
      for (int b = 0; b < t->bins; ++b) {
        assert_true(t->volume[b] >= -1e-15 * all && t->area[b] >= 0);
        sum += t->volume[b];
        for (int row = 0; row < 16; ++row)
          joint += t->joint[row * t->bins + b];
      }
      near(t->total / all, 1, 1e-13, "total", (int)i);
      near(sum / all, 1, 1e-12, "sum", (int)i);
      near(joint / all, 1, 1e-12, "joint", (int)i);
      tetcast_statistics_destroy(s.fixture.context, &t);
      TetcastField *field = field_of(s.fixture.context, values, s.cube.vertex_count, TETCAST_POINT);
      assert_int_equal(tetcast_statistics_quantiles(s.fixture.context, s.mesh, field, &half, 1, &quantile), TETCAST_OK);
      assert_true(quantile >= 0 && quantile <= 2 * scale);
      tetcast_field_destroy(&field);
      free(values);
    }
    subject_end(&s);
  }
}

static void threads_change_no_bit(void **state) {
  (void)state;
  TetcastStatistics *t[2];
  Subject s[2];
  for (int i = 0; i < 2; ++i) {
    subject_begin(&s[i], 6, 0.6, i ? 3 : 1);
    TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
    desc.gradient_bins = 32;
    t[i] = statistics_of(&s[i], s[i].cube.values, TETCAST_POINT, &desc);
  }
  assert_memory_equal(t[0]->volume, t[1]->volume, 256 * sizeof(double));
  assert_memory_equal(t[0]->area, t[1]->area, 257 * sizeof(double));
  assert_memory_equal(t[0]->joint, t[1]->joint, 32 * 256 * sizeof(double));
  for (int i = 0; i < 2; ++i) {
    tetcast_statistics_destroy(s[i].fixture.context, &t[i]);
    subject_end(&s[i]);
  }
}

static void nonsense_is_refused(void **state) {
  (void)state;
  Subject s;
  subject_begin(&s, 2, 0, 1);
  TetcastContext *context = s.fixture.context;
  TetcastField *field = field_of(context, s.cube.values, s.cube.vertex_count, TETCAST_POINT),
               *short_field = field_of(context, s.cube.values, s.cube.vertex_count - 1, TETCAST_POINT);
  TetcastStatistics *t = NULL;
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  assert_int_equal(tetcast_statistics_create(context, s.mesh, short_field, NULL, &t), TETCAST_ERROR_ARGUMENT);
  desc.bins = 0;
  assert_int_equal(tetcast_statistics_create(context, s.mesh, field, &desc, &t), TETCAST_ERROR_ARGUMENT);
  desc.bins = 65536;
  desc.gradient_bins = 17;
  assert_int_equal(tetcast_statistics_create(context, s.mesh, field, &desc, &t), TETCAST_ERROR_ARGUMENT);
  desc = tetcast_statistics_desc_default();
  desc.range[0] = 2;
  desc.range[1] = 1;
  assert_int_equal(tetcast_statistics_create(context, s.mesh, field, &desc, &t), TETCAST_ERROR_ARGUMENT);
  static const double falling[] = {0.5, 0.25}, beyond[] = {1.5};
  double values[2];
  assert_int_equal(tetcast_statistics_quantiles(context, s.mesh, field, falling, 2, values), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_statistics_quantiles(context, s.mesh, field, beyond, 1, values), TETCAST_ERROR_ARGUMENT);
  assert_null(t);
  tetcast_field_destroy(&field);
  tetcast_field_destroy(&short_field);
  subject_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_linear_field_is_that_of_its_box),
      cmocka_unit_test(a_random_field_is_the_sum_of_its_cells),
      cmocka_unit_test(quantiles_are_where_the_volume_is),
      cmocka_unit_test(quantiles_beside_a_mark),
      cmocka_unit_test(no_unit_is_too_large_or_small),
      cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(nonsense_is_refused),
      cmocka_unit_test(a_layer_counts_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
