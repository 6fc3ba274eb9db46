/* SPDX-License-Identifier: Apache-2.0 */
/* Sorting by number, and the curve that vertices are put in order along. */
#include "support.h"

#include <float.h>

#include "mesh/order.h"

static const int thread_counts[] = {1, 2, 3, 7};

static int compare_records(const void *left, const void *right) {
  const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
  return a < b ? -1 : a > b;
}

/* Values are the places before: then sorting by the whole record is what a sort that keeps the order of equal keys
 * does. */
static void sorting_is_stable(void **state) {
  (void)state;
  const int64_t counts[] = {0, 1, 2, 3, 1000, 200000};
  const uint32_t largest[] = {0, 1, 2, 2047, 2048, 4095, 1u << 20, UINT32_MAX};
  uint64_t seed = 5;
  for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c) {
    const size_t count = (size_t)counts[c];
    uint64_t *expected = malloc((count + 1) * sizeof *expected);
    for (size_t l = 0; l < sizeof largest / sizeof *largest; ++l) {
      for (size_t i = 0; i < count; ++i) {
        expected[i] = tc_record((uint32_t)(uniform(&seed) * ((double)largest[l] + 1)), (uint32_t)i);
      }
      for (int t = 0; t < 4; ++t) {
        Fixture fixture;
        assert_int_equal(fixture_begin(&fixture, thread_counts[t], 0), TETCAST_OK);
        uint64_t *records = malloc((count + 1) * sizeof *records), *scratch = malloc((count + 1) * sizeof *scratch);
        if (t == 0) {
          memcpy(records, expected, count * sizeof *records);
          qsort(expected, count, sizeof *expected, compare_records);
        } else { /* the same again, from the sorted ones: put back to their places */
          for (size_t i = 0; i < count; ++i)
            records[tc_record_value(expected[i])] = expected[i];
        }
        assert_int_equal(tc_sort_records(fixture.context, &records, &scratch, counts[c], largest[l]), TETCAST_OK);
        assert_memory_equal(records, expected, count * sizeof *records);
        for (int i = 0; count && i < 50; ++i) {
          const uint32_t key = (uint32_t)(uniform(&seed) * (double)largest[l]);
          const int64_t at = tc_find_record(records, counts[c], key);
          assert_true(at == counts[c] || tc_record_key(records[at]) >= key);
          assert_true(at == 0 || tc_record_key(records[at - 1]) < key);
        }
        free(records), free(scratch);
        fixture_end(&fixture);
      }
    }
    free(expected);
  }
}

/* In any aligned cube of 2ⁿ to the side the curve passes every point once, from each to one beside it. */
static void curve_goes_from_neighbor_to_neighbor(void **state) {
  (void)state;
  enum { SIDE = 16, COUNT = SIDE * SIDE * SIDE };
  uint64_t seed = 3;
  for (int round = 0; round < 40; ++round) {
    uint32_t corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = round == 0 ? 0 : (uint32_t)(uniform(&seed) * (1 << 16)) * SIDE;
    static uint32_t points[COUNT][3];
    memset(points, 0xff, sizeof points);
    for (uint32_t i = 0; i < COUNT; ++i) {
      const uint32_t at[3] = {corner[0] + i % SIDE, corner[1] + i / SIDE % SIDE, corner[2] + i / SIDE / SIDE};
      const uint64_t index = tc_hilbert_index(at), first = tc_hilbert_index(corner) / COUNT * COUNT;
      assert_true(index >= first && index < first + COUNT && index < UINT64_C(1) << 60);
      assert_true(points[index - first][0] == UINT32_MAX);
      memcpy(points[index - first], at, sizeof at);
    }
    for (int i = 1; i < COUNT; ++i) {
      int64_t steps = 0;
      for (int k = 0; k < 3; ++k)
        steps += llabs((int64_t)points[i][k] - (int64_t)points[i - 1][k]);
      assert_int_equal(steps, 1);
    }
  }
  const uint32_t origin[3] = {0, 0, 0};
  assert_true(tc_hilbert_index(origin) == 0);
}

/* The order for each number of threads, which must be the same and a permutation; the caller frees it. */
static uint32_t *order_of(const Cube *cube) {
  uint32_t *first = NULL;
  for (int t = 0; t < 4; ++t) {
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, thread_counts[t], 0), TETCAST_OK);
    TetcastMesh *mesh = cube_mesh(fixture.context, cube);
    uint32_t *order;
    assert_int_equal(tc_order_vertices(mesh, &order), TETCAST_OK);
    const size_t size = (size_t)cube->vertex_count * sizeof *order;
    if (!first)
      first = memcpy(malloc(size), order, size);
    assert_memory_equal(order, first, size);
    fixture_release(&fixture, order);
    tetcast_mesh_destroy(&mesh);
    fixture_end(&fixture);
  }
  unsigned char *seen = calloc((size_t)cube->vertex_count, 1);
  for (int64_t i = 0; i < cube->vertex_count; ++i) {
    assert_true(first[i] < cube->vertex_count && !seen[first[i]]);
    seen[first[i]] = 1;
  }
  free(seen);
  return first;
}

static void vertices_follow_the_curve(void **state) {
  (void)state;
  Cube cube = cube_create(40, 0.3);
  uint64_t seed = 1; /* shuffled, so that the mesh's own order says nothing; a cell for the bounds is enough */
  for (int64_t i = cube.vertex_count - 1; i > 0; --i) {
    const int64_t j = (int64_t)(uniform(&seed) * (double)(i + 1));
    for (int k = 0; k < 3; ++k) {
      const double x = cube.vertices[3 * i + k];
      cube.vertices[3 * i + k] = cube.vertices[3 * j + k];
      cube.vertices[3 * j + k] = x;
    }
  }
  uint32_t *order = order_of(&cube);
  double length = 0;
  for (int64_t i = 1; i < cube.vertex_count; ++i) {
    const double *p = &cube.vertices[3 * (int64_t)order[i - 1]], *q = &cube.vertices[3 * (int64_t)order[i]];
    length += hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
  }
  assert_true(length / (double)cube.vertex_count < 2.0 / 40); /* of points about 1 / 40 apart; in no order 0.66 */
  free(order);
  cube_destroy(&cube);
}

/* No power of two changes the order, up to the largest that coordinates may be, and down to where a size underflows. */
static void any_unit_gives_the_same_order(void **state) {
  (void)state;
  const int exponents[] = {0, 996, -1070};
  uint32_t *first = NULL;
  for (int i = 0; i < 3; ++i) {
    Cube cube = cube_create(4, 0);
    for (int64_t j = 0; j < 3 * cube.vertex_count; ++j)
      cube.vertices[j] = ldexp(2 * cube.vertices[j] - 1, exponents[i]);
    uint32_t *order = order_of(&cube);
    if (!first)
      first = order;
    assert_memory_equal(order, first, (size_t)cube.vertex_count * sizeof *order);
    if (order != first)
      free(order);
    cube_destroy(&cube);
  }
  free(first);
}

/* A mesh without size, and vertices that no cell uses, outside the bounds. */
static void any_point_has_a_place(void **state) {
  (void)state;
  for (int i = 0; i < 2; ++i) {
    Cube cube = cube_create(3, 0);
    if (i == 0)
      memset(cube.vertices, 0, (size_t)cube.vertex_count * 3 * sizeof *cube.vertices);
    cube.cell_count = 1;
    cube.vertices[3 * 40] = DBL_MAX;
    cube.vertices[3 * 41 + 1] = -DBL_MAX;
    free(order_of(&cube));
    cube_destroy(&cube);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sorting_is_stable),         cmocka_unit_test(curve_goes_from_neighbor_to_neighbor),
      cmocka_unit_test(vertices_follow_the_curve), cmocka_unit_test(any_unit_gives_the_same_order),
      cmocka_unit_test(any_point_has_a_place),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
