/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes with hidden cells are what they are without these, and coordinates in arrays apart are as good as in one. */
#include "support.h"

enum { WIDTH = 41, HEIGHT = 31, PIXELS = WIDTH * HEIGHT, HIDING = 5 };

/* A cube of which some cells are hidden, and the same without them. */
typedef struct Halves {
  Cube cube;
  uint8_t *marks;
  int64_t *left, *source; /* the cells that are not hidden, and their numbers in the cube */
  int64_t left_count;
} Halves;

static Halves halves_create(int n) {
  Halves h = {.cube = cube_create(n, 0.5)};
  const size_t cells = (size_t)h.cube.cell_count;
  h.marks = malloc(cells);
  h.left = malloc(4 * cells * sizeof *h.left);
  h.source = malloc(cells * sizeof *h.source);
  uint64_t seed = 3;
  for (int64_t i = 0; i < h.cube.cell_count; ++i) {
    h.marks[i] = (uint8_t)(uniform(&seed) < 0.6 ? 2 * (i % 2) : uniform(&seed) < 0.5 ? 1 : 6);
    if (h.marks[i] & HIDING)
      continue;
    memcpy(h.left + 4 * h.left_count, h.cube.cells + 4 * i, 4 * sizeof *h.left);
    h.source[h.left_count++] = i;
  }
  assert_true(h.left_count > h.cube.cell_count / 2 && h.left_count < h.cube.cell_count);
  return h;
}

static void halves_destroy(Halves *h) {
  cube_destroy(&h->cube);
  free(h->marks);
  free(h->left);
  free(h->source);
}

static TetcastMeshDesc desc_of(const Halves *h, bool hidden) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){h->cube.vertices, TETCAST_TYPE_FLOAT64, h->cube.vertex_count, 0};
  desc.tetrahedra = (TetcastArray){h->left, TETCAST_TYPE_INT64, h->left_count, 0};
  if (hidden) {
    desc.tetrahedra = (TetcastArray){h->cube.cells, TETCAST_TYPE_INT64, h->cube.cell_count, 0};
    desc.hidden = h->marks;
    desc.hidden_bits = HIDING;
  }
  return desc;
}

static TetcastMesh *mesh_of(TetcastContext *context, const TetcastMeshDesc *desc) {
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(context, desc, &mesh), TETCAST_OK);
  return mesh;
}

/* The picture of a mesh, through the same transfer function always. `values`: of points, or of cells. */
static double *picture_of(TetcastContext *context, const TetcastMesh *mesh, TetcastTraversal traversal,
                          const double *values, bool of_cells) {
  Body body = body_of(context, mesh, traversal, values,
                      of_cells ? tetcast_mesh_tetrahedron_count(mesh) : tetcast_mesh_vertex_count(mesh),
                      of_cells ? TETCAST_CELL : TETCAST_POINT);
  TetcastTransferFunction *transfer = transfer_of(context, 0.5);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastRenderStats stats;
  double *pixels = picture(context, &body, transfer, &camera, WIDTH, HEIGHT, &stats);
  assert_int_equal(stats.lost, 0);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  return pixels;
}

static void check_numbers(TetcastContext *context, const Halves *h, const TetcastMesh *some, const TetcastMesh *rest) {
  double a[6], b[6];
  TetcastMeshHealth health[2];
  TetcastVolumeInfo info;
  assert_int_equal(tetcast_mesh_tetrahedron_count(some), h->cube.cell_count);
  for (int64_t i = 0; i < h->cube.cell_count; ++i)
    assert_int_equal(tetcast_mesh_hides(some, i) != 0, (h->marks[i] & HIDING) != 0);
  assert_int_equal(tetcast_mesh_hides(rest, 0), 0);
  tetcast_mesh_bounds(some, a);
  tetcast_mesh_bounds(rest, b);
  assert_memory_equal(a, b, sizeof a);
  assert_int_equal(tetcast_mesh_health(context, some, &health[0]), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(context, rest, &health[1]), TETCAST_OK);
  assert_memory_equal(&health[0], &health[1], sizeof *health);
  TetcastVolume *volume = volume_of(context, some, TETCAST_TRAVERSAL_SHELL);
  tetcast_volume_info(volume, &info);
  assert_int_equal(info.tetrahedra, h->left_count);
  assert_int_equal(info.left_out, h->cube.cell_count - h->left_count);
  tetcast_volume_destroy(&volume);
  TetcastField *field = field_of(context, h->cube.values, h->cube.vertex_count, TETCAST_POINT);
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  TetcastStatistics *statistics[2] = {NULL, NULL};
  assert_int_equal(tetcast_statistics_create(context, some, field, &desc, &statistics[0]), TETCAST_OK);
  assert_int_equal(tetcast_statistics_create(context, rest, field, &desc, &statistics[1]), TETCAST_OK);
  assert_true(statistics[0]->total > 0.3);
  assert_true(fabs(statistics[0]->total / statistics[1]->total - 1) < 1e-14);
  assert_true(fabs(health[0].volume / statistics[1]->total - 1) < 1e-12);
  tetcast_statistics_destroy(context, &statistics[0]);
  tetcast_statistics_destroy(context, &statistics[1]);
  tetcast_field_destroy(&field);
}

static void hidden_cells_are_not_there(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Halves h = halves_create(6);
  double *values = malloc((size_t)h.cube.cell_count * sizeof *values),
         *of_left = malloc((size_t)h.left_count * sizeof *of_left);
  for (int64_t i = 0; i < h.cube.cell_count; ++i)
    values[i] = 0.5 + 0.5 * sin((double)i);
  for (int64_t i = 0; i < h.left_count; ++i)
    of_left[i] = values[h.source[i]];
  for (int borrowed = 0; borrowed < 2; ++borrowed) {
    TetcastMeshDesc with = desc_of(&h, true), without = desc_of(&h, false);
    with.ownership = borrowed ? TETCAST_BORROW : TETCAST_COPY;
    uint8_t *const marks = malloc((size_t)h.cube.cell_count);
    memcpy(marks, h.marks, (size_t)h.cube.cell_count);
    with.hidden = marks;
    TetcastMesh *some = mesh_of(fixture.context, &with), *rest = mesh_of(fixture.context, &without);
    if (!borrowed)
      memset(marks, 0, (size_t)h.cube.cell_count);
    check_numbers(fixture.context, &h, some, rest);
    for (int i = 0; i < 4; ++i) {
      const TetcastTraversal traversal = i / 2 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL;
      const double *own = i % 2 ? values : h.cube.values, *own_left = i % 2 ? of_left : h.cube.values;
      double *a = picture_of(fixture.context, some, traversal, own, i % 2),
             *b = picture_of(fixture.context, rest, traversal, own_left, i % 2);
      assert_memory_equal(a, b, PIXELS * 4 * sizeof *a);
      free(a);
      free(b);
    }
    assert_string_equal(fixture.message, "");
    tetcast_mesh_destroy(&some);
    tetcast_mesh_destroy(&rest);
    free(marks);
  }
  free(values);
  free(of_left);
  halves_destroy(&h);
  fixture_end(&fixture);
}

/* A duplicate, and a flat cell, that are hidden are no fault; where all is hidden there is nothing. */
static void what_is_hidden_is_no_fault(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  static const float vertices[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 9, 9}};
  static const int32_t cells[4][4] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {0, 0, 1, 2}, {1, 2, 3, 4}};
  static const uint8_t marks[4] = {0, 1, 1, 1}, all[4] = {1, 1, 1, 1};
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT32, 5, 0};
  desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT32, 4, 0};
  desc.hidden = marks;
  desc.hidden_bits = 0xff;
  TetcastMesh *mesh = mesh_of(fixture.context, &desc);
  double bounds[6];
  tetcast_mesh_bounds(mesh, bounds);
  assert_true(bounds[1] == 1 && bounds[3] == 1 && bounds[5] == 1);
  TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
  assert_string_equal(fixture.message, "");
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  desc.hidden = all;
  mesh = mesh_of(fixture.context, &desc);
  tetcast_mesh_bounds(mesh, bounds);
  assert_true(bounds[0] == 0 && bounds[1] == 0);
  assert_int_equal(tetcast_volume_create(fixture.context, mesh, NULL, &volume), TETCAST_ERROR_DATA);
  assert_string_equal(fixture.message, "the mesh has no cell with an inside (4 tetrahedra, 4 of them hidden)");
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

/* ── coordinates apart ── */

/* x, y and z in arrays with strides of their own, of single precision or double. */
static TetcastMeshDesc apart(const Cube *cube, bool wide, double *memory, TetcastMeshDesc *together, float *narrow) {
  const int64_t n = cube->vertex_count;
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  *together = desc;
  char *to = (char *)memory;
  for (int k = 0; k < 3; ++k) {
    const int64_t size = wide ? 8 : 4, stride = size * (k + 1);
    for (int64_t i = 0; i < n; ++i) {
      const float single = (float)cube->vertices[3 * i + k];
      narrow[3 * i + k] = single;
      memcpy(to + i * stride, wide ? (const void *)&cube->vertices[3 * i + k] : (const void *)&single, (size_t)size);
    }
    desc.coordinates[k] = (TetcastArray){to, wide ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32, n, k ? stride : 0};
    to += n * stride;
  }
  together->vertices = (TetcastArray){wide ? (void *)cube->vertices : (void *)narrow,
                                      wide ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32, n, 0};
  return desc;
}

static void coordinates_may_be_apart(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(6, 0.5);
  const size_t size = (size_t)cube.vertex_count * 6 * sizeof(double);
  double *memory = malloc(size);
  float *narrow = malloc((size_t)cube.vertex_count * 3 * sizeof *narrow);
  for (int i = 0; i < 4; ++i) {
    TetcastMeshDesc together, desc = apart(&cube, i & 1, memory, &together, narrow);
    desc.ownership = i & 2 ? TETCAST_BORROW : TETCAST_COPY;
    TetcastMesh *a = mesh_of(fixture.context, &desc), *b = mesh_of(fixture.context, &together);
    if (!(i & 2))
      memset(memory, 0, size);
    assert_null(tetcast_mesh_vertices(a).data);
    assert_int_equal(tetcast_mesh_vertices(a).type, tetcast_mesh_vertices(b).type);
    assert_int_equal(tetcast_mesh_vertex_count(a), cube.vertex_count);
    TetcastMeshHealth health[2];
    assert_int_equal(tetcast_mesh_health(fixture.context, a, &health[0]), TETCAST_OK);
    assert_int_equal(tetcast_mesh_health(fixture.context, b, &health[1]), TETCAST_OK);
    assert_memory_equal(&health[0], &health[1], sizeof *health);
    double *p = picture_of(fixture.context, a, TETCAST_TRAVERSAL_SHELL, cube.values, false),
           *q = picture_of(fixture.context, b, TETCAST_TRAVERSAL_SHELL, cube.values, false);
    assert_memory_equal(p, q, PIXELS * 4 * sizeof *p);
    free(p);
    free(q);
    TetcastField *field = field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT);
    TetcastStatisticsDesc statistics_desc = tetcast_statistics_desc_default();
    TetcastStatistics *s = NULL;
    assert_int_equal(tetcast_statistics_create(fixture.context, a, field, &statistics_desc, &s), TETCAST_OK);
    assert_true(fabs(s->total / health[1].volume - 1) < 1e-12);
    tetcast_statistics_destroy(fixture.context, &s);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&a);
    tetcast_mesh_destroy(&b);
  }
  free(memory);
  free(narrow);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

static void wrong_coordinates_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  static const double x[4] = {0, 1, 0, 0}, y[4] = {0, 0, 1, 0}, z[4] = {0, 0, 0, 1}, bad[4] = {0, 0, (double)NAN, 1};
  static const int32_t cell[4] = {0, 1, 2, 3};
  TetcastMeshDesc good = tetcast_mesh_desc_default();
  good.coordinates[0] = (TetcastArray){x, TETCAST_TYPE_FLOAT64, 4, 0};
  good.coordinates[1] = (TetcastArray){y, TETCAST_TYPE_FLOAT64, 4, 0};
  good.coordinates[2] = (TetcastArray){z, TETCAST_TYPE_FLOAT64, 4, 0};
  good.tetrahedra = (TetcastArray){cell, TETCAST_TYPE_INT32, 1, 0};
  TetcastMesh *mesh = mesh_of(fixture.context, &good);
  tetcast_mesh_destroy(&mesh);
  TetcastMeshDesc desc = good;
  desc.coordinates[2].count = 3;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "coordinates: 4 in x, 3 in z");
  desc = good;
  desc.coordinates[1].type = TETCAST_TYPE_FLOAT32;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "coordinates must be float32 or float64, all three alike");
  desc = good;
  desc.coordinates[1].data = NULL;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "coordinates: no data");
  desc = good;
  desc.coordinates[2].data = bad;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_DATA);
  assert_string_equal(fixture.message, "vertex 2 has a coordinate that is not finite: (0, 1, nan)");
  desc = good;
  desc.vertices = (TetcastArray){x, TETCAST_TYPE_FLOAT64, 1, 0};
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "a mesh with both vertices and coordinates");
  fixture_end(&fixture);
}

/* Wherever memory ends, nothing is lost. */
static void memory_may_end_anywhere(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Halves h = halves_create(2);
  double memory[27 * 6];
  float narrow[27 * 3];
  TetcastMeshDesc together, desc = apart(&h.cube, true, memory, &together, narrow);
  desc.hidden = h.marks;
  desc.hidden_bits = HIDING;
  TetcastStatus status = TETCAST_ERROR_MEMORY;
  int tries = 0;
  for (long n = 1; status; ++n, ++tries) {
    TetcastMesh *mesh = NULL;
    const long live = fixture.live;
    fixture.fail_at = fixture.allocations + n;
    status = tetcast_mesh_create(fixture.context, &desc, &mesh);
    assert_true(status == TETCAST_OK || status == TETCAST_ERROR_MEMORY);
    tetcast_mesh_destroy(&mesh);
    assert_int_equal(fixture.live, live);
  }
  assert_true(tries >= 6);
  fixture.fail_at = 0;
  halves_destroy(&h);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hidden_cells_are_not_there), cmocka_unit_test(what_is_hidden_is_no_fault),
      cmocka_unit_test(coordinates_may_be_apart),   cmocka_unit_test(wrong_coordinates_are_refused),
      cmocka_unit_test(memory_may_end_anywhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
