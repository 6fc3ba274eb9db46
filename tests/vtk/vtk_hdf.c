/* SPDX-License-Identifier: Apache-2.0 */
/* VTKHDF: time steps, the types of arrays, what is not read. */
#include <math.h>

#include "box.h"
#include "claims.h"
#include "hdf_samples.h"

/* Whether a step is what hdf_sample_cubes() says, or of a file without steps, 0. */
static void assert_cubes(Fixture *fixture, const char *path, int64_t step, int cubes, double height, double scale) {
  TetcastDataset *dataset = read_with(fixture, path, of_step(step));
  assert_int_equal(fixture->warnings, 0);
  assert_int_equal(tetcast_dataset_cell_count(dataset), cubes);
  TetcastMesh *mesh;
  TetcastField *h, *c;
  TetcastMeshHealth health;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume - cubes * height) < 1e-12);
  assert_int_equal(health.components, 1);
  assert_int_equal(tetcast_dataset_field(dataset, "h", &h, NULL), TETCAST_OK);
  assert_int_equal(tetcast_dataset_field(dataset, "c", &c, NULL), TETCAST_OK);
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); ++i) {
    int64_t v[4];
    double x = 0;
    tetcast_mesh_tetrahedron(mesh, i, v);
    for (int k = 0; k < 4; ++k) {
      double p[3];
      tetcast_mesh_vertex(mesh, v[k], p);
      x += p[0] / 4;
      assert_true(tetcast_field_value(h, v[k]) == scale * (p[0] + 2 * p[1] + 4 * p[2]));
    }
    assert_true(tetcast_field_value(c, i) == floor(x) + 10 * (scale - 1));
  }
  tetcast_field_destroy(&h);
  tetcast_field_destroy(&c);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

static void test_steps(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "a.vtkhdf");
  hdf_sample_cubes(path, HDF_MOVING);
  for (int step = 0; step < 3; ++step)
    assert_cubes(fixture, path, step, 2 + step, 1 + step, 1 + step);
  assert_cubes(fixture, path, -1, 4, 3, 3);
  TetcastDataset *dataset = read_with(fixture, path, of_time(0.5));
  assert_int_equal(tetcast_dataset_step(dataset), 1);
  double time;
  assert_true(tetcast_dataset_time(dataset, 2, &time) && time == 1);
  assert_false(tetcast_dataset_time(dataset, 3, &time));
  tetcast_dataset_destroy(&dataset);
  refuse_with(fixture, path, of_step(3), "no time step 3");
  hdf_sample_cubes(path, HDF_STILL);
  for (int step = 0; step < 3; ++step)
    assert_cubes(fixture, path, step, 2, 1, 1 + step);
  hdf_sample_cubes(path, HDF_STILL_LISTED);
  for (int step = 0; step < 3; ++step)
    assert_cubes(fixture, path, step, 2, 1, 1 + step);
  hdf_sample_cubes(path, HDF_NO_STEPS);
  assert_cubes(fixture, path, 0, 5, 1, 1);
  refuse_with(fixture, path, of_step(1), "it is of one step");
}

static void test_image(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "i.hdf");
  hdf_sample_image(path, false);
  assert_cubes(fixture, path, 0, 2, 1, 1);
  hdf_sample_image(path, true);
  static const double scale[3] = {1, 2, 1};
  for (int step = 0; step < 3; ++step) {
    assert_cubes(fixture, path, step, 2, 1, scale[step]);
    TetcastDataset *dataset = read_with(fixture, path, of_step(step));
    TetcastField *still;
    assert_int_equal(tetcast_dataset_field(dataset, "still", &still, NULL), TETCAST_OK);
    assert_true(tetcast_field_value(still, 11) == 7);
    tetcast_field_destroy(&still);
    tetcast_dataset_destroy(&dataset);
  }
}

static void test_types(void **state) {
  static const char *const names[] = {"good", "truth", "half", "big"}, *const lost[] = {"text", "pair", "short",
                                                                                        "claim"};
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "t.vtkhdf");
  hdf_sample_types(path);
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 1);
  assert_non_null(strstr(fixture->warning, "4 arrays are left out: "));
  for (int k = 0; k < 4; ++k) {
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, names[k], &field, NULL), TETCAST_OK);
    for (int i = 0; i < 12; ++i) {
      const double expected[] = {i, i % 2, 0.5 * i, i};
      assert_true(tetcast_field_value(field, i) == expected[k]);
    }
    tetcast_field_destroy(&field);
    assert_non_null(strstr(fixture->warning, lost[k]));
    fixture->errors = 0;
    assert_int_equal(tetcast_dataset_field(dataset, lost[k], &field, NULL), TETCAST_ERROR_DATA);
    assert_complaint(fixture, path, "can't be read");
  }
  tetcast_dataset_destroy(&dataset);
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.only = "half";
  dataset = read_with(fixture, path, desc);
  assert_int_equal(fixture->warnings, 0);
  TetcastDatasetArray array;
  assert_true(tetcast_dataset_array(dataset, 0, &array));
  assert_string_equal(array.name, "half");
  assert_false(tetcast_dataset_array(dataset, 1, &array));
  tetcast_dataset_destroy(&dataset);
}

static void test_refused(void **state) {
  static const struct {
    const char *type, *words;
    TetcastStatus status;
  } types[] = {{"PolyData", "holds PolyData, not a volume mesh", TETCAST_ERROR_DATA},
               {"MultiBlockDataSet", "holds a MultiBlockDataSet, which is not read", TETCAST_ERROR_UNSUPPORTED},
               {"PartitionedDataSetCollection", "holds a PartitionedDataSetCollection", TETCAST_ERROR_UNSUPPORTED},
               {"OverlappingAMR", "holds a OverlappingAMR", TETCAST_ERROR_UNSUPPORTED},
               {"UnstructuredGrid", "NumberOfCells", TETCAST_ERROR_DATA},
               {"ImageData", "WholeExtent", TETCAST_ERROR_DATA}};
  static const struct {
    const char *list;
    long long value;
    const char *words;
  } damages[] = {{"NumberOfPoints", 1000000000000000, "fewer values"},
                 {"NumberOfPoints", -1, "NumberOfPoints"},
                 {"NumberOfCells", 1000000000000, "fewer values"},
                 {"Offsets", 400, "Offsets"},
                 {"NumberOfConnectivityIds", 15, "Offsets"},
                 {"Steps/PartOffsets", 1000, "fewer values"},
                 {"Steps/PointOffsets", 100, "Points"},
                 {"Steps/NumberOfParts", 4, "fewer values"},
                 {"Connectivity", 99, "out of range"}};
  Fixture *fixture = *state;
  char path[600];
  snprintf(path, sizeof path, "%s", in_folder(fixture, "r.vtkhdf"));
  for (size_t i = 0; i < sizeof types / sizeof *types; ++i) {
    hdf_sample_type(path, types[i].type);
    read_bad(fixture, path, types[i].status, types[i].words);
  }
  for (size_t i = 0; i < sizeof damages / sizeof *damages; ++i) {
    hdf_sample_damaged(path, damages[i].list, damages[i].value);
    TetcastDatasetDesc desc = of_step(damages[i].list[0] == 'O' || damages[i].list[0] == 'C' ? 0 : 1);
    TetcastDataset *dataset;
    fixture->errors = 0;
    assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset), TETCAST_ERROR_DATA);
    assert_complaint(fixture, path, damages[i].words);
  }
}

/* Numbers and places that no file could have. */
static void test_claims(void **state) {
  static const char *const lists[] = {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds", "Offsets",
                                      "Connectivity"};
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "c.vtkhdf");
  for (size_t i = 0; i < sizeof lists / sizeof *lists; ++i) {
    for (int shift = 30; shift < 63; shift += 8) {
      hdf_sample_damaged(path, lists[i], 1LL << shift);
      assert_cheap(fixture, path, lists[i][0] == 'N', ""); /* of step 0 or 1 */
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_claims), TEST(test_steps), TEST(test_image), TEST(test_types),
                                     TEST(test_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
