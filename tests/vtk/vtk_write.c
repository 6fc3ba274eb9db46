/* SPDX-License-Identifier: Apache-2.0 */
/* Writing meshes. */
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "common.h"

enum { SIDE = 12, POINTS = SIDE * SIDE * SIDE, CUBES = (SIDE - 1) * (SIDE - 1) * (SIDE - 1), CELLS = 5 * CUBES };

typedef struct Arrays {
  double points[POINTS][3], point_values[POINTS];
  float points_narrow[POINTS][4]; /* the fourth isn't the mesh's */
  int64_t cells[CELLS][4];
  int32_t cells_narrow[CELLS][4];
  uint32_t cells_unsigned[CELLS][4];
  float cell_values[CELLS];
} Arrays;

static Arrays *make_arrays(void) {
  Arrays *a = calloc(1, sizeof *a);
  for (int i = 0; i < POINTS; ++i) {
    const int at[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
    for (int k = 0; k < 3; ++k) {
      a->points[i][k] = at[k] + 0.1 * sin(7.0 * i + k);
      a->points_narrow[i][k] = (float)a->points[i][k];
    }
    a->points_narrow[i][3] = NAN;
    a->point_values[i] = exp(-0.01 * i) * 1e-300;
  }
  a->point_values[3] = NAN;
  a->point_values[4] = -0.0;
  a->point_values[5] = INFINITY;
  static const int corners[5][4] = {{0, 1, 3, 5}, {0, 3, 2, 6}, {0, 5, 4, 6}, {3, 5, 6, 7}, {0, 3, 5, 6}};
  for (int i = 0; i < CELLS; ++i) {
    const int cube = i / 5, x = cube % (SIDE - 1), y = cube / (SIDE - 1) % (SIDE - 1),
              z = cube / ((SIDE - 1) * (SIDE - 1));
    for (int j = 0; j < 4; ++j) {
      const int c = corners[i % 5][j];
      const int index = x + (c & 1) + SIDE * (y + (c >> 1 & 1) + SIDE * (z + (c >> 2)));
      a->cells[i][j] = index;
      a->cells_narrow[i][j] = index;
      a->cells_unsigned[i][j] = (uint32_t)index;
    }
    a->cell_values[i] = (float)sin(i);
  }
  return a;
}

static TetcastMesh *make_mesh(Fixture *fixture, const Arrays *a, TetcastType point_type, TetcastType index_type) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.ownership = TETCAST_BORROW;
  desc.vertices = (TetcastArray){.data = a->points, .type = point_type, .count = POINTS};
  if (point_type == TETCAST_TYPE_FLOAT32) {
    desc.vertices.data = a->points_narrow;
    desc.vertices.stride = sizeof a->points_narrow[0];
  }
  desc.tetrahedra = (TetcastArray){.data = a->cells, .type = index_type, .count = CELLS};
  if (index_type == TETCAST_TYPE_INT32)
    desc.tetrahedra.data = a->cells_narrow;
  if (index_type == TETCAST_TYPE_UINT32)
    desc.tetrahedra.data = a->cells_unsigned;
  TetcastMesh *mesh;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  return mesh;
}

static TetcastField *make_field(Fixture *fixture, const void *data, TetcastType type, int64_t count,
                                TetcastAssociation association) {
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){.data = data, .type = type, .count = count};
  desc.association = association;
  TetcastField *field;
  assert_int_equal(tetcast_field_create(fixture->context, &desc, &field), TETCAST_OK);
  return field;
}

static void assert_same_field(const TetcastDataset *dataset, const char *name, const void *data, TetcastType type,
                              size_t size) {
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, name, &field, NULL), TETCAST_OK);
  const TetcastArray values = tetcast_field_values(field);
  assert_int_equal(values.type, type);
  assert_memory_equal(values.data, data, size);
  tetcast_field_destroy(&field);
}

/* Coordinates that come apart are written as others; cells that are hidden are so when they are read again. */
static void test_parts(void **state) {
  Fixture *fixture = *state;
  static const float x[5] = {0, 1, 0, 0, 1}, y[5] = {0, 0, 1, 0, 1}, z[5] = {0, 0, 0, 1, 1};
  static const int32_t cells[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  static const uint8_t marks[2] = {0, 4};
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.coordinates[0] = (TetcastArray){.data = x, .type = TETCAST_TYPE_FLOAT32, .count = 5};
  desc.coordinates[1] = (TetcastArray){.data = y, .type = TETCAST_TYPE_FLOAT32, .count = 5};
  desc.coordinates[2] = (TetcastArray){.data = z, .type = TETCAST_TYPE_FLOAT32, .count = 5};
  desc.tetrahedra = (TetcastArray){.data = cells, .type = TETCAST_TYPE_INT32, .count = 2};
  desc.hidden = marks;
  desc.hidden_bits = 4;
  TetcastMesh *mesh, *again;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  const char *path = in_folder(fixture, "parts.vtu");
  assert_int_equal(tetcast_dataset_write(fixture->context, path, mesh, 0, NULL, NULL), TETCAST_OK);
  TetcastDataset *dataset = read_good(fixture, path);
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, 1);
  assert_int_equal(tetcast_dataset_mesh(dataset, &again), TETCAST_OK);
  assert_int_equal(tetcast_mesh_tetrahedron_count(again), 1);
  for (int64_t i = 0; i < 4; ++i) {
    double p[3];
    tetcast_mesh_vertex(again, i, p);
    assert_true(p[0] == (double)x[i] && p[1] == (double)y[i] && p[2] == (double)z[i]);
  }
  tetcast_mesh_destroy(&again);
  tetcast_dataset_destroy(&dataset);
  tetcast_mesh_destroy(&mesh);
  assert_int_equal(empty_folder(fixture), 1);
}

/* What is written is read again bit by bit: types, order, NaN and signed zero. */
static void test_round_trip(void **state) {
  Fixture *fixture = *state;
  Arrays *a = make_arrays();
  static const char *const names[] = {"density <&amp;\"'> ρ:1", "part", "number"};
  TetcastField *fields[] = {make_field(fixture, a->point_values, TETCAST_TYPE_FLOAT64, POINTS, TETCAST_POINT),
                            make_field(fixture, a->cell_values, TETCAST_TYPE_FLOAT32, CELLS, TETCAST_CELL),
                            make_field(fixture, a->cells_unsigned, TETCAST_TYPE_UINT32, POINTS, TETCAST_POINT)};
  static const TetcastType point_types[] = {TETCAST_TYPE_FLOAT32, TETCAST_TYPE_FLOAT64};
  static const TetcastType index_types[] = {TETCAST_TYPE_INT32, TETCAST_TYPE_INT64, TETCAST_TYPE_UINT32};
  for (int i = 0; i < 6; ++i) {
    TetcastMesh *mesh = make_mesh(fixture, a, point_types[i % 2], index_types[i / 2]);
    const char *path = in_folder(fixture, "a.vtu");
    assert_int_equal(tetcast_dataset_write(fixture->context, path, mesh, 3, names, (const TetcastField *const *)fields),
                     TETCAST_OK);
    TetcastDataset *dataset = read_good(fixture, path);
    TetcastMesh *again;
    assert_int_equal(tetcast_dataset_mesh(dataset, &again), TETCAST_OK);
    const TetcastArray vertices = tetcast_mesh_vertices(again), cells = tetcast_mesh_tetrahedra(again);
    assert_int_equal(vertices.type, point_types[i % 2]);
    assert_int_equal(vertices.count, POINTS);
    for (int64_t j = 0; j < POINTS; ++j) {
      double p[3], q[3];
      tetcast_mesh_vertex(mesh, j, p);
      tetcast_mesh_vertex(again, j, q);
      assert_memory_equal(p, q, sizeof p);
    }
    assert_int_equal(cells.type, index_types[i / 2] == TETCAST_TYPE_UINT32 ? TETCAST_TYPE_INT64 : index_types[i / 2]);
    assert_int_equal(cells.count, CELLS);
    if (cells.type == TETCAST_TYPE_INT64)
      assert_memory_equal(cells.data, a->cells, sizeof a->cells);
    else
      assert_memory_equal(cells.data, a->cells_narrow, sizeof a->cells_narrow);
    assert_same_field(dataset, names[0], a->point_values, TETCAST_TYPE_FLOAT64, sizeof a->point_values);
    assert_same_field(dataset, NULL, a->point_values, TETCAST_TYPE_FLOAT64, sizeof a->point_values);
    assert_same_field(dataset, names[1], a->cell_values, TETCAST_TYPE_FLOAT32, sizeof a->cell_values);
    assert_same_field(dataset, names[2], a->cells_unsigned, TETCAST_TYPE_UINT32, POINTS * sizeof(uint32_t));
    tetcast_mesh_destroy(&again);
    tetcast_dataset_destroy(&dataset);
    tetcast_mesh_destroy(&mesh);
    assert_int_equal(empty_folder(fixture), 1);
  }
  for (int i = 0; i < 3; ++i)
    tetcast_field_destroy(&fields[i]);
  free(a);
}

/* Files count from 0, whatever the mesh counts from. */
static void test_counted_from_one(void **state) {
  Fixture *fixture = *state;
  Arrays *a = make_arrays();
  int64_t(*cells)[4] = malloc(sizeof a->cells);
  for (int i = 0; i < CELLS; ++i) {
    for (int j = 0; j < 4; ++j)
      cells[i][j] = a->cells[i][j] + 1;
  }
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){.data = a->points, .type = TETCAST_TYPE_FLOAT64, .count = POINTS};
  desc.tetrahedra = (TetcastArray){.data = cells, .type = TETCAST_TYPE_INT64, .count = CELLS};
  desc.ownership = TETCAST_BORROW;
  desc.index_base = 1;
  TetcastMesh *mesh, *again;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  const char *path = in_folder(fixture, "one.vtu");
  assert_int_equal(tetcast_dataset_write(fixture->context, path, mesh, 0, NULL, NULL), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  TetcastDataset *dataset = read_good(fixture, path);
  assert_int_equal(tetcast_dataset_mesh(dataset, &again), TETCAST_OK);
  assert_int_equal(tetcast_mesh_index_base(again), 0);
  assert_memory_equal(tetcast_mesh_tetrahedra(again).data, a->cells, sizeof a->cells);
  tetcast_mesh_destroy(&again);
  tetcast_dataset_destroy(&dataset);
  assert_int_equal(empty_folder(fixture), 1);
  free(cells);
  free(a);
}

/* Appended raw data, zlib. */
static void test_format(void **state) {
  Fixture *fixture = *state;
  Arrays *a = make_arrays();
  TetcastMesh *mesh = make_mesh(fixture, a, TETCAST_TYPE_FLOAT64, TETCAST_TYPE_INT64);
  assert_int_equal(tetcast_dataset_write(fixture->context, in_folder(fixture, "a.vtu"), mesh, 0, NULL, NULL),
                   TETCAST_OK);
  size_t size;
  char *bytes = contents(fixture->path, &size);
  assert_true(size < sizeof a->points + sizeof a->cells);
  bytes = realloc(bytes, size + 1);
  bytes[size] = '\0';
  assert_non_null(strstr(bytes, "compressor=\"vtkZLibDataCompressor\""));
  assert_non_null(strstr(bytes, "<AppendedData encoding=\"raw\">"));
  free(bytes);
  tetcast_mesh_destroy(&mesh);
  free(a);
}

static void assert_refused(Fixture *fixture, TetcastStatus status, TetcastStatus expected, const char *words) {
  assert_int_equal(status, expected);
  assert_complaint(fixture, ".vtu", words);
  fixture->errors = 0;
}

static void test_failures(void **state) {
  Fixture *fixture = *state;
  Arrays *a = make_arrays();
  TetcastMesh *mesh = make_mesh(fixture, a, TETCAST_TYPE_FLOAT64, TETCAST_TYPE_INT32);
  TetcastContext *context = fixture->context;
  TetcastField *fields[] = {make_field(fixture, a->point_values, TETCAST_TYPE_FLOAT64, POINTS, TETCAST_POINT),
                            make_field(fixture, a->point_values, TETCAST_TYPE_FLOAT64, POINTS, TETCAST_POINT),
                            make_field(fixture, a->point_values, TETCAST_TYPE_FLOAT64, POINTS - 1, TETCAST_POINT)};
  const TetcastField *const *given = (const TetcastField *const *)fields;
  static const char *const twice[] = {"a", "a"}, *const unnamed[] = {"a", NULL}, *const nameless[] = {""},
                           *const control[] = {"a\nb"};
  const char *path = in_folder(fixture, "a.vtu");

  assert_refused(fixture, tetcast_dataset_write(context, "/nonexistent/folder/a.vtu", mesh, 0, NULL, NULL),
                 TETCAST_ERROR_IO, "No such file or directory");
  assert_refused(fixture, tetcast_dataset_write(context, path, mesh, 2, twice, given), TETCAST_ERROR_ARGUMENT,
                 "two fields");
  assert_refused(fixture, tetcast_dataset_write(context, path, mesh, 2, unnamed, given), TETCAST_ERROR_ARGUMENT,
                 "field 1");
  assert_refused(fixture, tetcast_dataset_write(context, path, mesh, 1, nameless, given), TETCAST_ERROR_ARGUMENT,
                 "field 0");
  assert_refused(fixture, tetcast_dataset_write(context, path, mesh, 1, twice, given + 2), TETCAST_ERROR_ARGUMENT,
                 "1727 values for 1728 vertices");
  assert_int_equal(tetcast_dataset_write(context, path, mesh, 1, control, given), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_write(context, path, mesh, 1, NULL, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_write(context, path, NULL, 0, NULL, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_write(context, NULL, mesh, 0, NULL, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(empty_folder(fixture), 0);

  fixture->errors = 0;
  assert_int_equal(mkdir(in_folder(fixture, "d.vtu"), 0700), 0);
  assert_refused(fixture, tetcast_dataset_write(context, fixture->path, mesh, 0, NULL, NULL), TETCAST_ERROR_IO,
                 "is a folder");
  assert_int_equal(rmdir(fixture->path), 0);
  for (int i = 0; i < 3; ++i)
    tetcast_field_destroy(&fields[i]);
  tetcast_mesh_destroy(&mesh);
  free(a);
}

/* A limit on the size of files stands in for a full disk: wherever it strikes, nothing is left behind, and what was
 * there before stays. */
static void test_full_disk(void **state) {
  Fixture *fixture = *state;
  Arrays *a = make_arrays();
  TetcastMesh *mesh = make_mesh(fixture, a, TETCAST_TYPE_FLOAT64, TETCAST_TYPE_INT64);
  const char *path = in_folder(fixture, "a.vtu");
  assert_int_equal(tetcast_dataset_write(fixture->context, path, mesh, 0, NULL, NULL), TETCAST_OK);
  size_t size;
  char *before = contents(path, &size);
  signal(SIGXFSZ, SIG_IGN);
  struct rlimit limit;
  getrlimit(RLIMIT_FSIZE, &limit);
  for (int part = 0; part < 20; ++part) {
    struct rlimit low = {.rlim_cur = part == 19 ? size - 1 : size * (size_t)part / 19, .rlim_max = limit.rlim_max};
    setrlimit(RLIMIT_FSIZE, &low);
    fixture->errors = 0;
    const TetcastStatus status = tetcast_dataset_write(fixture->context, path, mesh, 0, NULL, NULL);
    setrlimit(RLIMIT_FSIZE, &limit);
    assert_int_equal(status, TETCAST_ERROR_IO);
    assert_complaint(fixture, path, "can't be written: File too large");
    size_t now;
    char *after = contents(path, &now);
    assert_int_equal(now, size);
    assert_memory_equal(before, after, size);
    free(after);
  }
  assert_int_equal(empty_folder(fixture), 1);
  free(before);
  tetcast_mesh_destroy(&mesh);
  free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_round_trip), TEST(test_parts),    TEST(test_counted_from_one),
                                     TEST(test_format),     TEST(test_failures), TEST(test_full_disk)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
