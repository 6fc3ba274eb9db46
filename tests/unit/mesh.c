/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes and fields: what is accepted, what is refused with which word, and the health report. */
#include "support.h"

static const double corners[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

static TetcastStatus create(Fixture *fixture, const double *vertices, int64_t n, const int32_t *cells, int64_t m,
                            TetcastMesh **mesh) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT64, n, 0};
  desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT32, m, 0};
  return tetcast_mesh_create(fixture->context, &desc, mesh);
}

static TetcastMeshHealth health_of(Fixture *fixture, const int32_t *cells, int64_t m) {
  TetcastMesh *mesh;
  TetcastMeshHealth health;
  assert_int_equal(create(fixture, corners[0], 5, cells, m, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  assert_null(mesh);
  return health;
}

static void bad_meshes_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  TetcastMesh *mesh = (TetcastMesh *)&fixture;
  const int32_t good[4] = {0, 1, 2, 3}, high[4] = {0, 1, 2, 5}, negative[4] = {0, -1, 2, 3};
  assert_int_equal(create(&fixture, corners[0], 5, high, 1, &mesh), TETCAST_ERROR_DATA);
  assert_null(mesh);
  assert_non_null(strstr(fixture.message, "vertex 5"));
  assert_int_equal(create(&fixture, corners[0], 5, negative, 1, &mesh), TETCAST_ERROR_DATA);
  assert_non_null(strstr(fixture.message, "vertex -1"));
  double nan_vertex[5][3];
  memcpy(nan_vertex, corners, sizeof corners);
  nan_vertex[2][1] = NAN;
  assert_int_equal(create(&fixture, nan_vertex[0], 5, good, 1, &mesh), TETCAST_ERROR_DATA);
  assert_non_null(strstr(fixture.message, "vertex 2"));
  nan_vertex[2][1] = -INFINITY;
  assert_int_equal(create(&fixture, nan_vertex[0], 5, good, 1, &mesh), TETCAST_ERROR_DATA);
  static const double far[2] = {1.001e300, -1.7e308};
  for (int i = 0; i < 2; ++i) { /* whose extent overflows, or would in what is computed of it */
    nan_vertex[2][1] = far[i];
    assert_int_equal(create(&fixture, nan_vertex[0], 5, good, 1, &mesh), TETCAST_ERROR_DATA);
    assert_non_null(strstr(fixture.message, "the mesh reaches from"));
    assert_non_null(strstr(fixture.message, "in y: coordinates may be 1e+300 at most"));
    memcpy(nan_vertex, corners, sizeof corners);
    nan_vertex[4][1] = far[i]; /* of no cell */
    assert_int_equal(create(&fixture, nan_vertex[0], 5, good, 1, &mesh), TETCAST_OK);
    tetcast_mesh_destroy(&mesh);
    mesh = (TetcastMesh *)&fixture;
  }
  memcpy(nan_vertex, corners, sizeof corners);
  nan_vertex[2][1] = 1e300;
  assert_int_equal(create(&fixture, nan_vertex[0], 5, good, 1, &mesh), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  mesh = (TetcastMesh *)&fixture;
  assert_int_equal(create(&fixture, NULL, 5, good, 1, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(create(&fixture, corners[0], -1, good, 1, &mesh), TETCAST_ERROR_ARGUMENT);
  TetcastMeshDesc zero = {0};
  assert_int_equal(tetcast_mesh_create(fixture.context, &zero, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(fixture.message, "default"));
  TetcastMeshDesc wrong = tetcast_mesh_desc_default();
  wrong.vertices = (TetcastArray){good, TETCAST_TYPE_INT32, 1, 0};
  assert_int_equal(tetcast_mesh_create(fixture.context, &wrong, &mesh), TETCAST_ERROR_ARGUMENT);
  wrong.vertices = (TetcastArray){corners, TETCAST_TYPE_FLOAT64, INT64_C(1) << 40, 0};
  wrong.ownership = TETCAST_BORROW;
  assert_int_equal(tetcast_mesh_create(fixture.context, &wrong, &mesh), TETCAST_ERROR_LIMIT);
  assert_int_equal(create(&fixture, corners[0], 0, good, 0, &mesh), TETCAST_OK); /* empty is a mesh, but no volume */
  TetcastVolume *volume;
  assert_int_equal(tetcast_volume_create(fixture.context, mesh, NULL, &volume), TETCAST_ERROR_DATA);
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

/* Of several, whichever thread comes upon it: of two neighbours the first may be the last of a piece of 2^14. */
static void first_of_many_bad_is_named(void **state) {
  (void)state;
  for (int threads = 1; threads < 8; threads += 3) {
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, threads, 0), TETCAST_OK);
    Cube cube = cube_create(30, 0.3);
    TetcastMeshDesc desc = tetcast_mesh_desc_default();
    desc.vertices = (TetcastArray){cube.vertices, TETCAST_TYPE_FLOAT64, cube.vertex_count, 0};
    desc.tetrahedra = (TetcastArray){cube.cells, TETCAST_TYPE_INT64, cube.cell_count, 0};
    TetcastMesh *mesh;
    for (int64_t bad = 9 << 14; bad >= 16383; bad -= bad % 2 ? 16383 : 1) {
      cube.cells[4 * bad + 3] = -bad;
      char name[80];
      snprintf(name, sizeof name, "tetrahedron %ld names vertex -%ld", (long)bad, (long)bad);
      assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_DATA);
      assert_non_null(strstr(fixture.message, name));
    }
    for (int64_t bad = 1 << 14; bad >= 16382; --bad) {
      cube.vertices[3 * bad + 1] = INFINITY;
      char name[80];
      snprintf(name, sizeof name, "vertex %ld has", (long)bad);
      assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_DATA);
      assert_non_null(strstr(fixture.message, name));
    }
    cube_destroy(&cube);
    fixture_end(&fixture);
  }
}

static void health_counts(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  const int32_t one[] = {0, 1, 2, 3};
  TetcastMeshHealth h = health_of(&fixture, one, 1);
  assert_int_equal(h.boundary_faces, 4);
  assert_int_equal(h.components, 1);
  assert_int_equal(h.unused_vertices, 1);
  assert_int_equal(
      h.inverted_cells + h.degenerate_cells + h.duplicate_cells + h.nonmanifold_faces + h.coincident_vertices, 0);
  assert_true(fabs(h.volume - 1.0 / 6) < 1e-16);
  assert_true(fabs(h.boundary_area - (1.5 + sqrt(3) / 2)) < 1e-15);

  const int32_t two[] = {0, 1, 2, 3, 1, 2, 3, 4}; /* share a face; the second is the wrong way round or not */
  h = health_of(&fixture, two, 2);
  assert_int_equal(h.boundary_faces, 6);
  assert_int_equal(h.components, 1);
  assert_int_equal(h.unused_vertices, 0);

  const int32_t bad[] = {0, 1, 2, 3, 1, 0, 2, 3,
                         0, 0, 1, 2, 3, 2, 1, 0}; /* a cell, its mirror image twice, a collapsed one */
  h = health_of(&fixture, bad, 4);
  assert_int_equal(h.duplicate_cells, 2);
  assert_int_equal(h.degenerate_cells, 1);
  assert_int_equal(h.inverted_cells, 1);
  assert_int_equal(h.boundary_faces, 4);

  const int32_t fan[] = {0, 1, 2, 3, 0, 1, 2, 4,
                         0, 1, 3, 4, 0, 1, 2, 3}; /* edge 0–1 in three cells, one of them twice */
  h = health_of(&fixture, fan, 3);
  assert_int_equal(h.nonmanifold_faces, 0);
  assert_int_equal(h.components, 1);
  const int32_t apart[] = {0, 1, 2, 3, 0, 1, 2, 4}; /* both on faces 0-1-2 */
  h = health_of(&fixture, apart, 2);
  assert_int_equal(h.boundary_faces, 6);
  fixture_end(&fixture);
}

static void three_cells_at_a_face_are_nonmanifold(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double vertices[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0.1, 0.1, 2}};
  const int32_t cells[] = {0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5};
  TetcastMesh *mesh;
  TetcastMeshHealth h;
  assert_int_equal(create(&fixture, vertices[0], 6, cells, 3, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture.context, mesh, &h), TETCAST_OK);
  assert_int_equal(h.nonmanifold_faces, 1);
  assert_int_equal(h.boundary_faces, 9);
  assert_int_equal(h.components, 3);
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

static void cube_is_healthy(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(9, 0.4);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  TetcastMeshHealth h;
  assert_int_equal(tetcast_mesh_health(fixture.context, mesh, &h), TETCAST_OK);
  assert_int_equal(h.boundary_faces, 6 * 2 * 81);
  assert_int_equal(h.components, 1);
  assert_int_equal(
      h.degenerate_cells + h.duplicate_cells + h.nonmanifold_faces + h.unused_vertices + h.coincident_vertices, 0);
  assert_true(fabs(h.volume - 1) < 1e-13);
  assert_true(fabs(h.boundary_area - 6) < 1e-13);
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Copies are independent of the caller's arrays, borrowed ones are the caller's; any stride, type and alignment reads
 * the same. */
static void arrays_of_any_shape(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  char bytes[1 + 5 * 20];
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 3; ++k) {
      const float x = (float)corners[i][k];
      memcpy(bytes + 1 + 20 * i + 4 * k, &x, 4);
    }
  }
  uint64_t cells[2][6] = {{0, 1, 2, 3, 99, 99}, {1, 2, 3, 4, 99, 99}};
  for (int ownership = 0; ownership < 2; ++ownership) {
    TetcastMeshDesc desc = tetcast_mesh_desc_default();
    desc.vertices = (TetcastArray){bytes + 1, TETCAST_TYPE_FLOAT32, 5, 20};
    desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_UINT64, 2, sizeof cells[0]};
    desc.ownership = ownership ? TETCAST_BORROW : TETCAST_COPY;
    TetcastMesh *mesh;
    assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_OK);
    assert_int_equal(tetcast_mesh_vertices(mesh).data == (const void *)(bytes + 1), ownership);
    for (int64_t i = 0; i < 5; ++i) {
      double p[3];
      tetcast_mesh_vertex(mesh, i, p);
      for (int k = 0; k < 3; ++k)
        assert_true(p[k] == corners[i][k]);
    }
    int64_t v[4];
    tetcast_mesh_tetrahedron(mesh, 1, v);
    assert_true(v[0] == 1 && v[3] == 4);
    double bounds[6];
    tetcast_mesh_bounds(mesh, bounds);
    assert_true(bounds[0] == 0 && bounds[5] == 1);
    tetcast_mesh_destroy(&mesh);
  }
  fixture_end(&fixture);
}

/* The cube's cells in an array of this type, with the index base added. */
static TetcastMesh *mesh_counted_from(Fixture *fixture, const Cube *cube, TetcastType type, TetcastOwnership ownership,
                                      int base, void *cells) {
  const bool wide = type == TETCAST_TYPE_INT64 || type == TETCAST_TYPE_UINT64;
  for (int64_t i = 0; i < 4 * cube->cell_count; ++i) {
    if (wide)
      ((int64_t *)cells)[i] = cube->cells[i] + base;
    else
      ((int32_t *)cells)[i] = (int32_t)cube->cells[i] + base;
  }
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.tetrahedra = (TetcastArray){cells, type, cube->cell_count, 0};
  desc.ownership = ownership;
  desc.index_base = base;
  TetcastMesh *mesh;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_index_base(mesh), base);
  assert_int_equal(tetcast_mesh_tetrahedra(mesh).data == cells, ownership == TETCAST_BORROW);
  return mesh;
}

static double *picture_of(Fixture *fixture, const Cube *cube, const TetcastMesh *mesh) {
  Body body = body_of(fixture->context, mesh, TETCAST_TRAVERSAL_SHELL, cube->values, cube->vertex_count, TETCAST_POINT);
  TetcastTransferFunction *transfer = transfer_of(fixture->context, 2);
  const TetcastCamera camera = camera_of(3, 2, 1.5, 0.5, 0.5, 0.5);
  double *pixels = picture(fixture->context, &body, transfer, &camera, 40, 30, NULL);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  return pixels;
}

/* Of any type, copied or borrowed: the same picture to the bit, the same health, the same cells. */
static void cells_counted_from_one(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(5, 0.4);
  void *cells = malloc((size_t)cube.cell_count * 4 * sizeof(int64_t));
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  double *expected = picture_of(&fixture, &cube, mesh);
  TetcastMeshHealth health, expected_health;
  assert_int_equal(tetcast_mesh_health(fixture.context, mesh, &expected_health), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  for (TetcastType type = TETCAST_TYPE_INT32; type <= TETCAST_TYPE_UINT64; ++type) {
    for (int ownership = 0; ownership < 2; ++ownership) {
      mesh = mesh_counted_from(&fixture, &cube, type, ownership ? TETCAST_BORROW : TETCAST_COPY, 1, cells);
      double *pixels = picture_of(&fixture, &cube, mesh);
      assert_memory_equal(pixels, expected, 40 * 30 * 4 * sizeof *pixels);
      free(pixels);
      assert_int_equal(tetcast_mesh_health(fixture.context, mesh, &health), TETCAST_OK);
      assert_memory_equal(&health, &expected_health, sizeof health);
      int64_t v[4];
      tetcast_mesh_tetrahedron(mesh, 7, v);
      assert_memory_equal(v, &cube.cells[4 * 7], sizeof v);
      tetcast_mesh_destroy(&mesh);
    }
  }
  free(expected);
  free(cells);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Numbers in messages are those that the caller has. */
static void index_bases_are_checked(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  static const struct {
    int64_t given;
    const char *words;
  } bad[] = {{0, "tetrahedron 2 names vertex 0, but there are 5 vertices, counted from 1"},
             {6, "tetrahedron 2 names vertex 6, but there are 5 vertices, counted from 1"},
             {INT64_MIN, "names vertex -9223372036854775808,"},
             {INT64_MAX, "names vertex 9223372036854775807,"}};
  TetcastMesh *mesh;
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){corners, TETCAST_TYPE_FLOAT64, 5, 0};
  desc.index_base = 1;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    const int64_t cells[8] = {1, 2, 3, 4, 2, bad[i].given, 3, 5};
    desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT64, 2, 0};
    assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_DATA);
    assert_non_null(strstr(fixture.message, bad[i].words));
  }
  const int32_t good[4] = {1, 2, 3, 5};
  desc.tetrahedra = (TetcastArray){good, TETCAST_TYPE_INT32, 1, 0};
  double vertices[5][3];
  memcpy(vertices, corners, sizeof corners);
  vertices[2][1] = NAN;
  desc.vertices.data = vertices;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_DATA);
  assert_non_null(strstr(fixture.message, "vertex 3 has"));
  desc.vertices.data = corners;
  static const int bases[] = {-1, 2, INT32_MAX};
  for (int i = 0; i < 3; ++i) {
    desc.index_base = bases[i];
    assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(fixture.message, "index base"));
  }
  fixture_end(&fixture);
}

/* Vertices that no cell names may be anywhere. */
static void bounds_are_those_of_the_cells(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double vertices[6][3] = {{-1e9, 0, 0}, {1, 2, 3}, {2, 2, 3}, {1, 4, 3}, {1, 2, 8}, {0, 1e300, 0}};
  const int32_t cell[] = {4, 2, 1, 3};
  const double expected[6] = {1, 2, 2, 4, 3, 8};
  double bounds[6];
  TetcastMesh *mesh;
  assert_int_equal(create(&fixture, vertices[0], 6, cell, 1, &mesh), TETCAST_OK);
  tetcast_mesh_bounds(mesh, bounds);
  assert_memory_equal(bounds, expected, sizeof bounds);
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

static void fields(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double values[] = {3, NAN, -2, INFINITY, 7};
  TetcastField *field = field_of(fixture.context, values, 5, TETCAST_POINT);
  double range[2];
  int64_t nonfinite;
  tetcast_field_range(field, range, &nonfinite);
  assert_true(range[0] == -2 && range[1] == 7);
  assert_int_equal(nonfinite, 2);
  tetcast_field_destroy(&field);
  const int64_t integers[] = {INT64_MIN, 5};
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){integers, TETCAST_TYPE_INT64, 2, 0};
  desc.association = TETCAST_CELL;
  assert_int_equal(tetcast_field_create(fixture.context, &desc, &field), TETCAST_OK);
  assert_true(tetcast_field_value(field, 0) == -0x1p63 && tetcast_field_value(field, 1) == 5);
  assert_int_equal(tetcast_field_association(field), TETCAST_CELL);
  tetcast_field_destroy(&field);
  desc.values.type = TETCAST_TYPE_NONE;
  assert_int_equal(tetcast_field_create(fixture.context, &desc, &field), TETCAST_ERROR_ARGUMENT);
  fixture_end(&fixture);
}

/* In pieces the same as in one. */
static void ranges_of_long_fields(void **state) {
  (void)state;
  enum { COUNT = 1234567 };
  float *values = malloc(COUNT * sizeof *values);
  for (int threads = 1; threads < 5; threads += 3) {
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, threads, 0), TETCAST_OK);
    for (int round = 0; round < 4; ++round) {
      for (int i = 0; i < COUNT; ++i)
        values[i] = round == 3 ? NAN : (float)(i % 1000 - 500);
      values[round * 400000] = -1e30f;
      values[COUNT - 1 - round * 300000] = 2e30f;
      values[600001] = INFINITY;
      TetcastFieldDesc desc = tetcast_field_desc_default();
      desc.values = (TetcastArray){values, TETCAST_TYPE_FLOAT32, COUNT, 0};
      TetcastField *field;
      assert_int_equal(tetcast_field_create(fixture.context, &desc, &field), TETCAST_OK);
      double range[2];
      int64_t nonfinite;
      tetcast_field_range(field, range, &nonfinite);
      assert_true(range[0] == (double)-1e30f && range[1] == (double)2e30f);
      assert_int_equal(nonfinite, round == 3 ? COUNT - 2 : 1);
      tetcast_field_destroy(&field);
    }
    fixture_end(&fixture);
  }
  free(values);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bad_meshes_are_refused),
      cmocka_unit_test(first_of_many_bad_is_named),
      cmocka_unit_test(health_counts),
      cmocka_unit_test(three_cells_at_a_face_are_nonmanifold),
      cmocka_unit_test(cube_is_healthy),
      cmocka_unit_test(arrays_of_any_shape),
      cmocka_unit_test(cells_counted_from_one),
      cmocka_unit_test(index_bases_are_checked),
      cmocka_unit_test(bounds_are_those_of_the_cells),
      cmocka_unit_test(fields),
      cmocka_unit_test(ranges_of_long_fields),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
