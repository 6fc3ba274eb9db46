/* SPDX-License-Identifier: Apache-2.0 */
/* What is read of each format, its blocks and its time steps. */
#include "box.h"
#include "cases.h"

static void test_structured(void **state) {
  Fixture *fixture = *state;
  static const char *const names[] = {"i.vti", "r.vtr", "s.vts", "i.vtk", "r.vtk", "s.vtk"};
  for (int i = 0; i < 6; ++i) {
    for (int mode = SAMPLE_ASCII; mode <= SAMPLE_RAW; ++mode) {
      if (i >= 3 && mode > SAMPLE_BINARY)
        break;
      const char *path = in_folder(fixture, names[i]);
      sample_structured(path, names[i][0], (SampleMode)mode);
      TetcastDataset *dataset = read_good(fixture, path);
      assert_int_equal(tetcast_dataset_point_count(dataset), BOX_POINTS);
      assert_int_equal(tetcast_dataset_cell_count(dataset), BOX_CELLS);
      const char *type;
      int64_t count;
      assert_true(tetcast_dataset_cell_type(dataset, 0, &type, &count));
      assert_string_equal(type, "hexahedron");
      assert_int_equal(count, BOX_CELLS);
      assert_layers(fixture, dataset, 0, 4, 1, true);
      assert_int_equal(tetcast_dataset_pieces(dataset).pieces, 1);
      tetcast_dataset_destroy(&dataset);
    }
  }
  read_bad(fixture,
           text_file(fixture, "flat.vtk",
                     "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 1\nORIGIN 0 0 "
                     "0\nSPACING 1 1 1\n"),
           TETCAST_ERROR_DATA, "no volume");
}

static void test_formats(void **state) {
  (void)state;
  const char *name, *extensions;
  int count = 0;
  bool vtu = false, node = false;
  for (; tetcast_dataset_format(count, &name, &extensions); ++count) {
    assert_true(*name != '\0' && extensions[0] == '.');
    vtu = vtu || strcmp(extensions, ".vtu") == 0;
    node = node || strcmp(extensions, ".node .ele") == 0;
  }
  assert_true(vtu && node && count >= 7);
  assert_true(tetcast_dataset_format(0, NULL, NULL));
  assert_false(tetcast_dataset_format(-1, &name, &extensions));
}

/* Blocks are found by their own name, their path and their group's name. */
static void test_blocks(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "box.vtm");
  sample_blocks(path);
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 1); /* of array c */
  assert_layers(fixture, dataset, 0, 4, 1, false);
  const TetcastDatasetPieces pieces = tetcast_dataset_pieces(dataset);
  assert_int_equal(pieces.pieces, 2);
  assert_int_equal(pieces.surfaces, 1);
  assert_int_equal(pieces.merged_points, 12);
  assert_int_equal(pieces.differing_points, 0);
  assert_string_equal(tetcast_dataset_block(dataset, 0), "body/lower");
  assert_string_equal(tetcast_dataset_block(dataset, 1), "body/upper");
  assert_non_null(tetcast_dataset_block(dataset, 2)); /* the surface */
  assert_null(tetcast_dataset_block(dataset, 3));
  assert_null(tetcast_dataset_block(dataset, -1));
  TetcastField *c; /* where a block lacks an array it is NaN */
  assert_int_equal(tetcast_dataset_field(dataset, "c", &c, NULL), TETCAST_OK);
  int64_t missing = 0;
  double range[2];
  tetcast_field_range(c, range, &missing);
  assert_true(range[0] == 0 && range[1] == 11);
  assert_int_equal(missing, 12 * 6);
  tetcast_field_destroy(&c);
  tetcast_dataset_destroy(&dataset);

  static const struct {
    const char *name;
    int first, end;
  } cases[] = {{"body/lower", 0, 2}, {"lower", 0, 2}, {"upper", 2, 4}, {"body", 0, 4}};
  for (size_t i = 0; i < 4; ++i) {
    dataset = read_with(fixture, path, of_block(cases[i].name));
    assert_layers(fixture, dataset, cases[i].first, cases[i].end, 1, cases[i].end == 2);
    assert_non_null(tetcast_dataset_block(dataset, 2));
    tetcast_dataset_destroy(&dataset);
  }
  static const char *const wrong[] = {"low", "ody/low", "body/", "", "1"};
  for (size_t i = 0; i < 5; ++i)
    refuse_with(fixture, path, of_block(wrong[i]), "there are: body/lower, body/upper");
  sample_layers(in_folder(fixture, "one.vtu"), 0, 4, GHOST_NONE);
  refuse_with(fixture, fixture->path, of_block("body"), "it is not of blocks");
  /* What is not asked for is not read: a file cut short does not matter, unless it may hold blocks of its own. */
  sample_layers(in_folder(fixture, "good.vtu"), 0, 4, GHOST_NONE);
  text_file(fixture, "cut.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOf");
  text_file(fixture, "cut.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Blo");
  static const char list[] = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><DataSet "
                             "name=\"a\" file=\"good.vtu\"/>"
                             "<DataSet name=\"b\" file=\"cut.%s\"/></vtkMultiBlockDataSet></VTKFile>";
  for (int i = 0; i < 2; ++i) {
    char text[512];
    snprintf(text, sizeof text, list, i ? "vtm" : "vtu");
    path = text_file(fixture, "two.vtm", text);
    const TetcastDatasetDesc desc = of_block("a");
    assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset),
                     i ? TETCAST_ERROR_DATA : TETCAST_OK);
    if (i == 0)
      assert_string_equal(tetcast_dataset_block(dataset, 1), "b");
    tetcast_dataset_destroy(&dataset);
    read_bad(fixture, path, TETCAST_ERROR_DATA, "truncated");
  }
  char folder[600]; /* what the writer made beside */
  snprintf(folder, sizeof folder, "rm -rf '%s/box'", fixture->folder);
  assert_int_equal(system(folder), 0);
}

#define PVD(entries)                                                                                                   \
  "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection>" entries                         \
  "</Collection></VTKFile>\n"
#define ENTRY(time, file) "<DataSet timestep=\"" time "\" part=\"0\" file=\"" file "\"/>"

static void assert_step(Fixture *fixture, const char *path, TetcastDatasetDesc desc, int64_t step, int first, int end) {
  TetcastDataset *dataset = read_with(fixture, path, desc);
  assert_int_equal(tetcast_dataset_step(dataset), step);
  assert_layers(fixture, dataset, first, end, 1, true);
  double time = 0;
  assert_true(tetcast_dataset_time(dataset, 0, &time) && time == 0.1);
  assert_true(tetcast_dataset_time(dataset, 2, &time) && time == 7);
  assert_false(tetcast_dataset_time(dataset, 3, &time));
  tetcast_dataset_destroy(&dataset);
}

/* Steps by time, whatever the order in the file; files of one time are one step. */
static void test_series(void **state) {
  Fixture *fixture = *state;
  sample_layers(in_folder(fixture, "all.vtu"), 0, 4, GHOST_NONE);
  sample_layers(in_folder(fixture, "low.vtu"), 0, 2, GHOST_NONE);
  sample_layers(in_folder(fixture, "high.vtu"), 2, 4, GHOST_NONE);
  char paths[2][512];
  snprintf(paths[0], 512, "%s",
           text_file(fixture, "a.pvd", PVD(ENTRY("7", "high.vtu") ENTRY("0.5", "low.vtu") ENTRY("0.1", "all.vtu"))));
  snprintf(
      paths[1], 512, "%s",
      text_file(
          fixture, "a.vtu.series",
          "{\n  \"file-series-version\" : \"1.0\", \"more\": [{\"x\": [1, -2e3, true, null, \"\\u00e4\\n\"]}, {}],\n"
          "  \"files\" : [ { \"time\": 7, \"name\" : \"high.vtu\" }, { \"name\" : \"l\\u006fw.vtu\", \"time\" : 5e-1 },"
          " { \"name\" : \"all.vtu\", \"time\" : 0.1 } ]\n}\n"));
  for (int i = 0; i < 2; ++i) {
    assert_step(fixture, paths[i], tetcast_dataset_desc_default(), 0, 0, 4);
    assert_step(fixture, paths[i], of_step(1), 1, 0, 2);
    assert_step(fixture, paths[i], of_step(-1), 2, 2, 4);
    assert_step(fixture, paths[i], of_step(-3), 0, 0, 4);
    assert_step(fixture, paths[i], of_time(0.5000001), 1, 0, 2);
    assert_step(fixture, paths[i], of_time(7), 2, 2, 4);
    refuse_with(fixture, paths[i], of_step(3), "no time step 3; there are steps 0 to 2");
    refuse_with(fixture, paths[i], of_step(-4), "no time step -4");
    refuse_with(fixture, paths[i], of_time(0.6), "nearest is 0.5, of step 1");
  }
  refuse_with(fixture, in_folder(fixture, "all.vtu"), of_step(1), "one step");
  refuse_with(fixture, in_folder(fixture, "all.vtu"), of_time(0), "one step");
  /* Parts of one time, and no times at all, with which all are parts. */
  for (int i = 0; i < 2; ++i) {
    const char *path = text_file(fixture, "b.pvd",
                                 i ? PVD(ENTRY("2", "low.vtu") ENTRY("2", "high.vtu") ENTRY("3", "low.vtu"))
                                   : PVD("<DataSet file=\"low.vtu\"/><DataSet file=\"high.vtu\"/>"));
    TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
    assert_layers(fixture, dataset, 0, 4, 1, true);
    assert_true(tetcast_dataset_time(dataset, 0, NULL) == (i == 1));
    tetcast_dataset_destroy(&dataset);
  }
  /* Paths as Windows has them, unless a file is called so. */
  char folder[600], name[700];
  snprintf(folder, sizeof folder, "%s/sub", fixture->folder);
  assert_int_equal(mkdir(folder, 0700), 0);
  snprintf(name, sizeof name, "%s/p.vtu", folder);
  sample_layers(name, 0, 4, GHOST_NONE);
  static const char *const lists[][2] = {
      {"w.pvd", PVD(ENTRY("1", "sub\\p.vtu"))},
      {"w.vtu.series", "{\"files\": [{\"name\": \"sub\\\\p.vtu\", \"time\": 1}]}"},
      {"w.pvtu", "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid><Piece "
                 "Source=\"sub\\p.vtu\"/></PUnstructuredGrid></VTKFile>\n"},
      {"w.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><DataSet index=\"0\" "
                "file=\".\\sub\\p.vtu\"/></vtkMultiBlockDataSet></VTKFile>\n"}};
  for (int i = 0; i < 4; ++i) {
    TetcastDataset *dataset =
        read_with(fixture, text_file(fixture, lists[i][0], lists[i][1]), tetcast_dataset_desc_default());
    assert_layers(fixture, dataset, 0, 4, 1, true);
    tetcast_dataset_destroy(&dataset);
  }
  sample_layers(in_folder(fixture, "sub\\p.vtu"), 0, 2, GHOST_NONE);
  TetcastDataset *named = read_with(fixture, in_folder(fixture, "w.pvd"), tetcast_dataset_desc_default());
  assert_layers(fixture, named, 0, 2, 1, true);
  tetcast_dataset_destroy(&named);
  read_bad(fixture, text_file(fixture, "d.pvd", PVD(ENTRY("1", "C:\\run\\p.vtu"))), TETCAST_ERROR_IO, "C:");
  unlink(name);
  rmdir(folder);
  TetcastDatasetDesc desc = of_time(INFINITY);
  TetcastDataset *dataset;
  assert_int_equal(tetcast_dataset_read(fixture->context, paths[0], &desc, &dataset), TETCAST_ERROR_ARGUMENT);
  desc = tetcast_dataset_desc_default();
  desc.merge_tolerance = NAN;
  assert_int_equal(tetcast_dataset_read(fixture->context, paths[0], &desc, &dataset), TETCAST_ERROR_ARGUMENT);
  static const double factors[] = {0, -1, NAN, INFINITY};
  for (int i = 0; i < 4; ++i) {
    desc = tetcast_dataset_desc_default();
    desc.stretch[i % 3] = factors[i];
    assert_int_equal(tetcast_dataset_read(fixture->context, paths[0], &desc, &dataset), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(fixture->message, "is not a finite number above 0"));
  }
}

static void test_exodus_steps(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "box.ex2");
  if (!sample_exodus(path))
    skip();
  for (int step = 0; step < 2; ++step) {
    TetcastDataset *dataset = read_with(fixture, path, step ? of_time(2) : tetcast_dataset_desc_default());
    assert_int_equal(tetcast_dataset_step(dataset), step);
    double time;
    assert_true(tetcast_dataset_time(dataset, 1, &time) && time == 2);
    assert_layers(fixture, dataset, 0, 4, step + 1, true);
    assert_non_null(tetcast_dataset_block(dataset, 0));
    tetcast_dataset_destroy(&dataset);
  }
  refuse_with(fixture, path, of_step(2), "no time step 2");
}

static bool can_read(const char *extensions) {
  const char *found;
  for (int i = 0; tetcast_dataset_format(i, NULL, &found); ++i) {
    if (strcmp(found, extensions) == 0)
      return true;
  }
  print_message("skipped: built without %s\n", extensions);
  return false;
}

static void test_cgns(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "box.cgns");
  if (!can_read(".cgns") || !sample_cgns(path))
    skip();
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_layers(fixture, dataset, 0, 4, 1, false);
  assert_int_equal(tetcast_dataset_pieces(dataset).pieces, 2);
  tetcast_dataset_destroy(&dataset);
  dataset = read_with(fixture, path, of_block("upper"));
  assert_layers(fixture, dataset, 2, 4, 1, false);
  tetcast_dataset_destroy(&dataset);
}

static void test_vtkhdf(void **state) {
  Fixture *fixture = *state;
  if (!can_read(".vtkhdf .hdf"))
    skip();
  TetcastDataset *dataset[2] = {read_good(fixture, data_path(fixture, "cells/can-vtu.hdf")), NULL};
  dataset[1] = read_good(fixture, data_path(fixture, "volumes/can.vtu"));
  TetcastMesh *mesh[2];
  TetcastMeshHealth health[2];
  for (int i = 0; i < 2; ++i) {
    assert_int_equal(tetcast_dataset_mesh(dataset[i], &mesh[i]), TETCAST_OK);
    assert_int_equal(tetcast_mesh_health(fixture->context, mesh[i], &health[i]), TETCAST_OK);
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset[i], "EQPS", &field, NULL), TETCAST_OK);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh[i]);
    tetcast_dataset_destroy(&dataset[i]);
  }
  assert_memory_equal(&health[0], &health[1], sizeof health[0]);
}

static void test_tetgen(void **state) {
  Fixture *fixture = *state;
  for (int base = 0; base < 2; ++base) {
    text_file(fixture, "t.node",
              base ? "# comment\n4 3 1 1\n1 0 0 0 5 0\n2 1 0 0 6 0\n\n3 0 1 0 7 1\n4 0 0 1 8 1 # here too\n"
                   : "4 3 1 1\n0 0 0 0 5 0\n1 1 0 0 6 0\n2 0 1 0 7 1\n3 0 0 1 8 1\n");
    text_file(fixture, "t.ele", base ? "1 4 1\n1 1 2 3 4 9\n" : "1 4 1\n0 0 1 2 3 9\n");
    for (int i = 0; i < 2; ++i) {
      TetcastDataset *dataset = read_good(fixture, in_folder(fixture, i ? "t.ele" : "t.node"));
      TetcastField *field;
      assert_int_equal(tetcast_dataset_field(dataset, "attribute_0", &field, NULL), TETCAST_OK);
      assert_true(tetcast_field_value(field, 3) == 8);
      tetcast_field_destroy(&field);
      assert_int_equal(tetcast_dataset_field(dataset, "marker", &field, NULL), TETCAST_OK);
      assert_true(tetcast_field_value(field, 2) == 1 && tetcast_field_value(field, 1) == 0);
      tetcast_field_destroy(&field);
      assert_int_equal(tetcast_dataset_field(dataset, "region_0", &field, NULL), TETCAST_OK);
      assert_true(tetcast_field_value(field, 0) == 9);
      tetcast_field_destroy(&field);
      tetcast_dataset_destroy(&dataset);
    }
  }
  static const struct {
    const char *elements, *words;
    TetcastStatus status;
  } cases[] = {{"1 10\n1 1 2 3 4 1 2 3 4 1 2\n", "10 points", TETCAST_ERROR_UNSUPPORTED},
               {"2 4\n1 1 2 3 4\n", "ends after 1 of 2", TETCAST_ERROR_DATA},
               {"1 4\n1 1 2 3 5\n", "out of range", TETCAST_ERROR_DATA},
               {"1 4\n7 1 2 3 4\n", "line 2: number 7", TETCAST_ERROR_DATA},
               {"999999999999 4\n1 1 2 3 4\n", "can't hold", TETCAST_ERROR_DATA},
               {"1 4\n1 1 2 x 4\n", "line 2", TETCAST_ERROR_DATA}};
  text_file(fixture, "t.node", "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    read_bad(fixture, text_file(fixture, "t.ele", cases[i].elements), cases[i].status, cases[i].words);
  }
}

static void test_ensight(void **state) {
  Fixture *fixture = *state;
  if (!can_read(".case .encas"))
    skip();
  const char *path = write_ensight(fixture);
  for (int step = 0; step < 2; ++step) {
    TetcastDataset *dataset = read_with(fixture, path, of_step(step));
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, "s", &field, NULL), TETCAST_OK);
    assert_true(tetcast_field_value(field, 0) == 1 + 4 * step);
    assert_true(tetcast_field_value(field, 3) == 4 + 4 * step);
    tetcast_field_destroy(&field);
    double time;
    assert_true(tetcast_dataset_time(dataset, 1, &time) && time == 2);
    assert_string_equal(tetcast_dataset_block(dataset, 0), "solid");
    tetcast_dataset_destroy(&dataset);
  }
  TetcastDataset *dataset = read_good(fixture, data_path(fixture, "cells/ensight/elements6.case"));
  assert_int_equal(tetcast_dataset_cell_count(dataset), 15);
  tetcast_dataset_destroy(&dataset);
}

static void test_openfoam(void **state) {
  Fixture *fixture = *state;
  if (!can_read(".foam"))
    skip();
  const char *path = write_openfoam(fixture);
  for (int step = 0; step < 2; ++step) {
    TetcastDataset *dataset = read_with(fixture, path, of_step(step));
    assert_int_equal(tetcast_dataset_cell_count(dataset), 2);
    double time;
    assert_true(tetcast_dataset_time(dataset, 1, &time) && time == 0.5);
    TetcastMesh *mesh;
    TetcastMeshHealth health;
    TetcastField *field;
    assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
    assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
    assert_true(fabs(health.volume - 2) < 1e-12);
    assert_int_equal(health.boundary_faces, 20);
    assert_int_equal(tetcast_dataset_field(dataset, "p", &field, NULL), TETCAST_OK);
    assert_int_equal(tetcast_field_association(field), TETCAST_CELL);
    double range[2];
    tetcast_field_range(field, range, NULL);
    assert_true(range[0] == 1 + 2 * step && range[1] == 2 + 2 * step);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }
  read_bad(fixture, in_folder(fixture, "none.foam"), TETCAST_ERROR_IO, "No such file");
  remove_openfoam(fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_structured),   TEST(test_formats), TEST(test_blocks), TEST(test_series),
                                     TEST(test_exodus_steps), TEST(test_cgns),    TEST(test_vtkhdf), TEST(test_tetgen),
                                     TEST(test_ensight),      TEST(test_openfoam)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
