/* SPDX-License-Identifier: Apache-2.0 */
/* Exodus files: what they hold, and what becomes of damaged ones. */
#include <math.h>

#include "common.h"

static void test_same_as_vtu(void **state) {
  Fixture *fixture = *state;
  const char *const names[2] = {"volumes/disk_out_ref.ex2", "volumes/disk_out_ref.vtu"};
  double range[2][2];
  int64_t faces[2];
  for (int i = 0; i < 2; ++i) {
    TetcastDataset *dataset = read_good(fixture, data_path(fixture, names[i]));
    assert_int_equal(tetcast_dataset_point_count(dataset), 8499);
    assert_int_equal(tetcast_dataset_cell_count(dataset), 7472);
    TetcastMesh *mesh;
    TetcastField *field;
    TetcastMeshHealth health;
    assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
    assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
    faces[i] = health.boundary_faces;
    assert_int_equal(tetcast_dataset_field(dataset, "Temp", &field, NULL), TETCAST_OK);
    tetcast_field_range(field, range[i], NULL);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }
  assert_int_equal(faces[0], faces[1]);
  for (int k = 0; k < 2; ++k) assert_true(fabs(range[0][k] - range[1][k]) < 1e-4);
}

/* Blocks that share points become one mesh, with the arrays over all of them. */
static void test_blocks(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset = read_good(fixture, data_path(fixture, "defects/mug.e"));
  assert_int_equal(tetcast_dataset_cell_count(dataset), 2476);
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, "aux_elem", &field, NULL), TETCAST_OK);
  assert_int_equal(tetcast_field_association(field), TETCAST_CELL);
  tetcast_field_destroy(&field);
  tetcast_dataset_destroy(&dataset);
}

static TetcastStatus attempt(Fixture *fixture, const void *bytes, size_t size) {
  TetcastDataset *dataset;
  fixture->errors = 0;
  const TetcastStatus status = tetcast_dataset_read(fixture->context, file_of(fixture, "bad.ex2", bytes, size), NULL, &dataset);
  assert_int_equal(fixture->errors, status != TETCAST_OK); /* one line, of one line: see remember() */
  tetcast_dataset_destroy(&dataset);
  return status;
}

/* Not a byte of what the header speaks of may be missing: the NetCDF library would take zeros for it. */
static void test_truncation(void **state) {
  Fixture *fixture = *state;
  size_t size;
  char *bytes = contents(data_path(fixture, "volumes/disk_out_ref.ex2"), &size);
  for (size_t part = 0; part < 40; ++part) assert_int_not_equal(attempt(fixture, bytes, size * part / 40), TETCAST_OK);
  assert_int_not_equal(attempt(fixture, bytes, size - 8), TETCAST_OK);
  assert_int_equal(attempt(fixture, bytes, size), TETCAST_OK);
  free(bytes);
}

static void test_flipped_bits(void **state) {
  Fixture *fixture = *state;
  size_t size;
  char *bytes = contents(data_path(fixture, "volumes/disk_out_ref.ex2"), &size), *changed = malloc(size);
  uint32_t seed = 5;
  for (int i = 0; i < 60; ++i) {
    memcpy(changed, bytes, size);
    for (int j = 0; j < 3; ++j) {
      seed = seed * 1664525u + 1013904223u;
      changed[(seed >> 8) % 12000] ^= (char)(1 << (seed >> 5 & 7)); /* the header is in the first 12,000 bytes */
    }
    attempt(fixture, changed, size);
  }
  free(bytes);
  free(changed);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_same_as_vtu), TEST(test_blocks), TEST(test_truncation), TEST(test_flipped_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
