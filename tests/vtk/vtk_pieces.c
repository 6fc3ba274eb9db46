/* SPDX-License-Identifier: Apache-2.0 */
/* What is in pieces is read as the whole: ghosts, blanked cells, and points that pieces share. */
#include "box.h"

#define PIECE(data, xyz)                                                                                               \
  "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">" data                                                              \
  "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" xyz "</DataArray></Points><Cells>"  \
  "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"                               \
  "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>"                                          \
  "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>"
#define VTU(pieces)                                                                                                    \
  "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>" pieces           \
  "</UnstructuredGrid></VTKFile>"
#define VALUES(type, name, values)                                                                                     \
  "<DataArray type=\"" type "\" Name=\"" name "\" format=\"ascii\">" values "</DataArray>"
#define OF_POINTS(arrays) "<PointData>" arrays "</PointData>"
#define OF_CELLS(arrays)  "<CellData>" arrays "</CellData>"
#define PVTU(sources)                                                                                                  \
  "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid>" sources "</PUnstructuredGrid></VTKFile>"
#define SOURCE(file) "<Piece Source=\"" file "\"/>"

/* Two tetrahedra either side of the triangle (1 0 0) (0 1 0) (0 0 1). */
#define LEFT  "0 0 0 1 0 0 0 1 0 0 0 1"
#define RIGHT "1 0 0 0 1 0 0 0 1 1 1 1"

static TetcastMesh *mesh_of(const TetcastDataset *dataset) {
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  return mesh;
}

static void assert_same_mesh(const TetcastDataset *a, const TetcastDataset *b) {
  TetcastMesh *mesh[2] = {mesh_of(a), mesh_of(b)};
  assert_int_equal(tetcast_mesh_vertex_count(mesh[0]), tetcast_mesh_vertex_count(mesh[1]));
  assert_int_equal(tetcast_mesh_tetrahedron_count(mesh[0]), tetcast_mesh_tetrahedron_count(mesh[1]));
  for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh[0]); ++i) {
    double p[2][3];
    for (int j = 0; j < 2; ++j)
      tetcast_mesh_vertex(mesh[j], i, p[j]);
    assert_memory_equal(p[0], p[1], sizeof p[0]);
  }
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh[0]); ++i) {
    int64_t v[2][4];
    for (int j = 0; j < 2; ++j)
      tetcast_mesh_tetrahedron(mesh[j], i, v[j]);
    assert_memory_equal(v[0], v[1], sizeof v[0]);
  }
  for (int j = 0; j < 2; ++j)
    tetcast_mesh_destroy(&mesh[j]);
}

/* Pieces in the order of the whole's cells make the whole's very mesh, with ghosts of either kind and without. */
static void test_layers(void **state) {
  Fixture *fixture = *state;
  sample_layers(in_folder(fixture, "all.vtu"), 0, 4, GHOST_NONE);
  TetcastDataset *whole = read_good(fixture, fixture->path);
  for (int ghosts = GHOST_NONE; ghosts <= GHOST_LEVELS; ++ghosts) {
    sample_layers(in_folder(fixture, "a.vtu"), 0, 1, (SampleGhosts)ghosts);
    sample_layers(in_folder(fixture, "b.vtu"), 1, 3, (SampleGhosts)ghosts);
    sample_layers(in_folder(fixture, "c.vtu"), 3, 4, (SampleGhosts)ghosts);
    const char *path = text_file(fixture, "all.pvtu", PVTU(SOURCE("a.vtu") SOURCE("b.vtu") SOURCE("c.vtu")));
    TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
    assert_int_equal(fixture->warnings, 0);
    assert_layers(fixture, dataset, 0, 4, 1, true);
    assert_same_mesh(dataset, whole);
    const TetcastDatasetPieces pieces = tetcast_dataset_pieces(dataset);
    assert_int_equal(pieces.pieces, 3);
    assert_int_equal(pieces.surfaces, 0);
    assert_int_equal(pieces.ghost_cells, ghosts ? 4 * 6 : 0);
    assert_int_equal(pieces.ghost_points, ghosts ? 4 * 12 : 0);
    assert_int_equal(pieces.merged_points, 2 * 12);
    assert_int_equal(pieces.differing_points, 0);
    assert_int_equal(tetcast_dataset_point_count(dataset), 60 + 24 + (ghosts ? 48 : 0));
    assert_int_equal(tetcast_dataset_cell_count(dataset), 24 + (ghosts ? 24 : 0));
    TetcastDatasetArray array; /* the marks are no field */
    for (int i = 0; tetcast_dataset_array(dataset, i, &array); ++i)
      assert_null(strstr(array.name, "Ghost"));
    tetcast_dataset_destroy(&dataset);

    /* One piece alone: without its ghosts. */
    dataset = read_good(fixture, in_folder(fixture, "b.vtu"));
    assert_layers(fixture, dataset, 1, 3, 1, true);
    tetcast_dataset_destroy(&dataset);
  }
  tetcast_dataset_destroy(&whole);
}

static void test_blanked(void **state) {
  Fixture *fixture = *state;
  const char *path = in_folder(fixture, "blanked.vts");
  sample_blanked(path);
  TetcastDataset *dataset = read_good(fixture, path);
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, 2);
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_points, 2); /* the corners that no other cell has */
  TetcastMesh *mesh = mesh_of(dataset);
  TetcastMeshHealth health;
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume - 11) < 1e-12);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

static TetcastMeshHealth health_of(Fixture *fixture, const TetcastDataset *dataset) {
  TetcastMesh *mesh = mesh_of(dataset);
  TetcastMeshHealth health;
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  return health;
}

/* Pieces whose points are a little apart stay apart, unless a tolerance says otherwise. */
static void test_tolerance(void **state) {
  Fixture *fixture = *state;
  const char *path =
      text_file(fixture, "near.vtu", VTU(PIECE("", LEFT) PIECE("", "1.000001 0 0 0 1 -1e-6 0 0 1 1 1 1")));
  static const struct {
    double tolerance;
    int merged, faces;
  } cases[] = {{-1, 1, 8}, {0, 1, 8}, {5e-7, 1, 8}, {1.1e-6, 3, 6}, {0.5, 3, 6}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.merge_tolerance = cases[i].tolerance;
    TetcastDataset *dataset = read_with(fixture, path, desc);
    assert_int_equal(tetcast_dataset_pieces(dataset).merged_points, cases[i].merged);
    assert_int_equal(health_of(fixture, dataset).boundary_faces, cases[i].faces);
    tetcast_dataset_destroy(&dataset);
  }
}

/* Coincident points of one piece are a crack, which stays, alone and between others; with a tolerance of 0 it is
 * closed. */
static void test_cracks(void **state) {
  Fixture *fixture = *state;
  static const char crack[] = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n" LEFT
                              " " RIGHT "\nCELLS 2 10\n4 0 1 2 3\n4 4 5 6 7\nCELL_TYPES 2\n10\n10\n";
  text_file(fixture, "far.vtu", VTU(PIECE("", "2 1 1 1 2 1 1 1 2 1 1 1")));
  const char *path = text_file(fixture, "crack.vtk", crack);
  for (int list = 0; list < 2; ++list) {
    if (list)
      path = text_file(fixture, "crack.pvd",
                       "<VTKFile type=\"Collection\"><Collection><DataSet file=\"crack.vtk\"/>"
                       "<DataSet file=\"far.vtu\"/></Collection></VTKFile>");
    for (int closed = 0; closed < 2; ++closed) {
      TetcastDatasetDesc desc = tetcast_dataset_desc_default();
      if (closed)
        desc.merge_tolerance = 0;
      TetcastDataset *dataset = read_with(fixture, path, desc);
      const TetcastMeshHealth health = health_of(fixture, dataset);
      assert_int_equal(health.boundary_faces, (closed ? 6 : 8) + (list ? 4 : 0));
      assert_int_equal(tetcast_dataset_pieces(dataset).merged_points, (closed ? 3 : 0) + list);
      tetcast_dataset_destroy(&dataset);
    }
  }
}

static double value_at(const TetcastDataset *dataset, const char *name, double x, double y, double z) {
  TetcastMesh *mesh = mesh_of(dataset);
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, name, &field, NULL), TETCAST_OK);
  double value = -1;
  for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh); ++i) {
    double p[3];
    tetcast_mesh_vertex(mesh, i, p);
    if (p[0] == x && p[1] == y && p[2] == z)
      value = tetcast_field_value(field, i);
  }
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  return value;
}

/* The first piece's values count, unless it calls the point a duplicate; NaN where a piece has none. */
static void test_values(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "left.vtu",
            VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "1 2 3 4") VALUES("Float32", "mixed", "1 2 3 4")), LEFT)));
  text_file(fixture, "right.vtu",
            VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "2 3.5 4 5") VALUES("Int32", "mixed", "2 3 4 16777217"))
                          OF_CELLS(VALUES("Int32", "b", "7")),
                      RIGHT)));
  const char *path = text_file(fixture, "values.pvtu", PVTU(SOURCE("left.vtu") SOURCE("right.vtu")));
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 2); /* of the point, and of b */
  assert_int_equal(tetcast_dataset_pieces(dataset).differing_points, 1);
  assert_true(value_at(dataset, "a", 0, 1, 0) == 3);
  assert_true(value_at(dataset, "a", 1, 1, 1) == 5);
  assert_true(value_at(dataset, "mixed", 1, 1, 1) == 16777217);
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, "b", &field, NULL), TETCAST_OK);
  assert_true(isnan(tetcast_field_value(field, 0)) && tetcast_field_value(field, 1) == 7);
  tetcast_field_destroy(&field);
  tetcast_dataset_destroy(&dataset);

  text_file(fixture, "marked.vtu",
            VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "1 2 3 4") VALUES("UInt8", "vtkGhostType", "0 0 1 0")), LEFT)));
  dataset = read_with(fixture, text_file(fixture, "values.pvtu", PVTU(SOURCE("marked.vtu") SOURCE("right.vtu"))),
                      tetcast_dataset_desc_default());
  assert_true(value_at(dataset, "a", 0, 1, 0) == 3.5);
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, 0);
  tetcast_dataset_destroy(&dataset);

  text_file(fixture, "pairs.vtu",
            VTU(PIECE(OF_POINTS("<DataArray type=\"Float64\" Name=\"mixed\" NumberOfComponents=\"2\" format=\"ascii\">"
                                "1 2 3 4 5 6 7 8</DataArray>"),
                      RIGHT)));
  dataset = read_with(fixture, text_file(fixture, "values.pvtu", PVTU(SOURCE("left.vtu") SOURCE("pairs.vtu"))),
                      tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 2); /* of `mixed`, and that one lacks a */
  TetcastDatasetArray array;
  assert_true(tetcast_dataset_array(dataset, 0, &array));
  assert_string_equal(array.name, "a");
  assert_false(tetcast_dataset_array(dataset, 1, &array));
  tetcast_dataset_destroy(&dataset);
}

/* Points whose coordinates are not finite go with the cells that use them, also where ghosts go and points are merged.
 */
static void test_nonfinite(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "left.vtu", VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "1 2 3 4")), LEFT)));
  text_file(fixture, "bad.vtu",
            VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "2 3 4 9")) OF_CELLS(VALUES("Float32", "b", "8")),
                      "1 0 0 0 1 0 0 0 1 1 nan 1")));
  text_file(fixture, "right.vtu",
            VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "2 3 4 5")) OF_CELLS(VALUES("Float32", "b", "7")), RIGHT)));
  const char *path = text_file(fixture, "all.pvtu", PVTU(SOURCE("left.vtu") SOURCE("bad.vtu") SOURCE("right.vtu")));
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 2); /* of the coordinate, and of b */
  const TetcastDatasetPieces pieces = tetcast_dataset_pieces(dataset);
  assert_int_equal(pieces.nonfinite_points, 1);
  assert_int_equal(pieces.nonfinite_cells, 1);
  assert_int_equal(pieces.merged_points, 6);
  assert_int_equal(pieces.ghost_cells, 0);
  assert_int_equal(tetcast_dataset_point_count(dataset), 12);
  assert_int_equal(tetcast_dataset_cell_count(dataset), 3);
  assert_int_equal(health_of(fixture, dataset).boundary_faces, 6);
  assert_int_equal(health_of(fixture, dataset).unused_vertices, 0);
  assert_true(value_at(dataset, "a", 1, 1, 1) == 5);
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, "b", &field, NULL), TETCAST_OK);
  assert_true(isnan(tetcast_field_value(field, 0)) && tetcast_field_value(field, 1) == 7);
  tetcast_field_destroy(&field);
  tetcast_dataset_destroy(&dataset);

  text_file(fixture, "ghost.vtu",
            VTU(PIECE(OF_CELLS(VALUES("UInt8", "vtkGhostType", "1")), "1 0 0 0 1 0 0 0 1 inf 1 1")));
  path = text_file(fixture, "all.pvtu", PVTU(SOURCE("left.vtu") SOURCE("ghost.vtu")));
  dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, 1);
  assert_int_equal(tetcast_dataset_pieces(dataset).nonfinite_points, 0);
  assert_int_equal(tetcast_dataset_point_count(dataset), 8);
  tetcast_dataset_destroy(&dataset);
  read_bad(fixture, text_file(fixture, "b.pvtu", PVTU(SOURCE("bad.vtu") SOURCE("bad.vtu"))), TETCAST_ERROR_DATA,
           "no cells without coordinates that are NaN or infinite");
}

/* The mean of the neighbours' numbers along one axis of the box: cells `at − 1` and `at`, of `count`. */
static double mean_number(double at, int count) {
  return at == 0 ? 0 : at == count ? count - 1 : at - 0.5;
}

/* Cell arrays averaged to points are those of the whole for pieces, too; cells without a value don't count. */
static void test_cell_to_point(void **state) {
  Fixture *fixture = *state;
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.cell_to_point = true;
  for (int ghosts = -1; ghosts <= GHOST_LEVELS; ++ghosts) {
    const char *path = in_folder(fixture, "a.vtu");
    sample_layers(path, 0, ghosts < 0 ? 4 : 2, ghosts < 0 ? GHOST_NONE : (SampleGhosts)ghosts);
    if (ghosts >= 0) {
      sample_layers(in_folder(fixture, "b.vtu"), 2, 4, (SampleGhosts)ghosts);
      path = text_file(fixture, "all.pvtu", PVTU(SOURCE("a.vtu") SOURCE("b.vtu")));
    }
    TetcastDataset *dataset = read_with(fixture, path, desc);
    TetcastMesh *mesh = mesh_of(dataset);
    TetcastField *c, *s;
    const char *name;
    assert_int_equal(tetcast_dataset_field(dataset, "c", &c, &name), TETCAST_OK);
    assert_string_equal(name, "c");
    assert_int_equal(tetcast_dataset_field(dataset, "s", &s, NULL), TETCAST_OK); /* of points: as it is */
    assert_int_equal(tetcast_field_association(c), TETCAST_POINT);
    assert_int_equal(tetcast_field_values(c).count, BOX_POINTS);
    for (int64_t i = 0; i < BOX_POINTS; ++i) {
      double p[3];
      tetcast_mesh_vertex(mesh, i, p);
      const double expected = mean_number(p[0], 3) + 3 * mean_number(p[1], 2) + 6 * mean_number(2 * p[2], 4);
      assert_true(fabs(tetcast_field_value(c, i) - expected) < 1e-13 * 24);
      assert_true(tetcast_field_value(s, i) == p[0] + 2 * p[1] + 4 * p[2]);
    }
    tetcast_field_destroy(&c);
    tetcast_field_destroy(&s);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }

  /* Three cells at a triangle: a number, NaN, and a surface, which is no cell of the mesh; vectors by components, then
   * their length. */
  const char *path = text_file(
      fixture, "three.vtu",
      VTU("<Piece NumberOfPoints=\"6\" NumberOfCells=\"3\">" OF_CELLS(VALUES(
          "Float64", "c",
          "4 nan 100") "<DataArray type=\"Float64\" Name=\"v\" NumberOfComponents=\"2\" format=\"ascii\">"
                       "3 4 -3 4 9 9</DataArray>") "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
                                                   "format=\"ascii\">" LEFT
                                                   " 1 1 1 5 5 5</DataArray></Points><Cells>" VALUES(
                                                       "Int32", "connectivity", "0 1 2 3 1 2 3 4 1 2 5")
                                                       VALUES("Int32", "offsets", "4 8 11")
                                                           VALUES("UInt8", "types", "10 10 5") "</Cells></Piece>"));
  TetcastDataset *dataset = read_with(fixture, path, desc);
  static const struct {
    const char *selector;
    double values[5];
  } cases[] = {{"c", {4, 4, 4, 4, NAN}}, {"v:0", {3, 0, 0, 0, -3}}, {"v", {5, 4, 4, 4, 5}}};
  for (int i = 0; i < 3; ++i) {
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, cases[i].selector, &field, NULL), TETCAST_OK);
    int64_t nonfinite;
    tetcast_field_range(field, NULL, &nonfinite);
    assert_int_equal(nonfinite, i == 0); /* and not the point that only the surface has */
    for (int k = 0; k < 5; ++k) {
      const double value = tetcast_field_value(field, k), expected = cases[i].values[k];
      assert_true(value == expected || (isnan(value) && isnan(expected)));
    }
    tetcast_field_destroy(&field);
  }
  tetcast_dataset_destroy(&dataset);
}

/* A cell that has a point twice counts once there. */
static void test_cell_to_point_twice(void **state) {
  Fixture *fixture = *state;
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.cell_to_point = true;
  const char *path =
      text_file(fixture, "twice.vtk",
                "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n" LEFT
                "\nCELLS 2 10\n4 0 1 2 3\n4 1 1 2 3\nCELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS c float\n"
                "LOOKUP_TABLE default\n4 10\n");
  TetcastDataset *dataset = read_with(fixture, path, desc);
  assert_true(value_at(dataset, "c", 0, 0, 0) == 4 && value_at(dataset, "c", 1, 0, 0) == 7 &&
              value_at(dataset, "c", 0, 1, 0) == 7);
  tetcast_dataset_destroy(&dataset);
}

/* Each piece of a .vtu has arrays of its own, in an order of its own. */
static void test_arrays_of_pieces(void **state) {
  Fixture *fixture = *state;
  const char *path =
      text_file(fixture, "pieces.vtu",
                VTU(PIECE(OF_POINTS(VALUES("Float64", "a", "1 2 3 4") VALUES("Float64", "b", "5 6 7 8"))
                              OF_CELLS(VALUES("Float32", "c", "1")),
                          LEFT) PIECE(OF_POINTS(VALUES("Float32", "d", "1 1 1 9") VALUES("Float64", "b", "6 7 8 10")
                                                    VALUES("Float64", "a", "2 3 4 11"))
                                          OF_CELLS(VALUES("Int8", "e", "2") VALUES("Float32", "c", "3")),
                                      RIGHT) PIECE("", "1 0 0 0 1 0 1 1 1 3 0 0")));
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(fixture->warnings, 1); /* five arrays are missing somewhere */
  assert_int_equal(tetcast_dataset_pieces(dataset).pieces, 3);
  static const char *const names[] = {"a", "b", "d", "c", "e"};
  TetcastDatasetArray array;
  for (int i = 0; i < 5; ++i) {
    assert_true(tetcast_dataset_array(dataset, i, &array));
    assert_string_equal(array.name, names[i]);
    assert_int_equal(array.association, i < 3 ? TETCAST_POINT : TETCAST_CELL);
  }
  assert_false(tetcast_dataset_array(dataset, 5, &array));
  assert_true(value_at(dataset, "a", 0, 0, 0) == 1 && value_at(dataset, "a", 1, 1, 1) == 11 &&
              isnan(value_at(dataset, "a", 3, 0, 0)));
  assert_true(value_at(dataset, "b", 0, 0, 0) == 5 && value_at(dataset, "b", 1, 1, 1) == 10);
  assert_true(value_at(dataset, "d", 1, 1, 1) == 9 && isnan(value_at(dataset, "d", 0, 0, 0)));
  TetcastField *field;
  for (int i = 3; i < 5; ++i) {
    assert_int_equal(tetcast_dataset_field(dataset, names[i], &field, NULL), TETCAST_OK);
    const double left = tetcast_field_value(field, 0), right = tetcast_field_value(field, 1);
    assert_true(i == 3 ? left == 1 && right == 3 : isnan(left) && right == 2);
    assert_true(isnan(tetcast_field_value(field, 2)));
    tetcast_field_destroy(&field);
  }
  tetcast_dataset_destroy(&dataset);

  /* Of all these one alone, and one that is not there. */
  static const char *const selectors[] = {"b", "b:0", "e", "c:mag", "bb", "zz"}, *const found[] = {"b", "b",  "e",
                                                                                                   "c", NULL, NULL};
  for (int i = 0; i < 6; ++i) {
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.only = selectors[i];
    dataset = read_with(fixture, path, desc);
    assert_true(tetcast_dataset_array(dataset, 0, &array) == (found[i] != NULL));
    if (found[i])
      assert_string_equal(array.name, found[i]);
    assert_false(tetcast_dataset_array(dataset, 1, &array));
    assert_int_equal(tetcast_dataset_field(dataset, selectors[i], &field, NULL),
                     found[i] ? TETCAST_OK : TETCAST_ERROR_ARGUMENT);
    if (!found[i])
      assert_complaint(fixture, path, "has no array");
    tetcast_field_destroy(&field);
    tetcast_dataset_destroy(&dataset);
  }
  for (int ghosts = GHOST_TYPES; ghosts <= GHOST_LEVELS; ++ghosts) { /* which are seen at any rate */
    sample_layers(in_folder(fixture, "ghosts.vtu"), 1, 3, (SampleGhosts)ghosts);
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.only = "s";
    dataset = read_with(fixture, fixture->path, desc);
    assert_layers(fixture, dataset, 1, 3, 1, false);
    tetcast_dataset_destroy(&dataset);
  }
}

/* Parts of a machine that had no work, files of nothing but ghosts, and lists that lead nowhere. */
static void test_odd_lists(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "left.vtu", VTU(PIECE("", LEFT)));
  text_file(fixture, "ghost.vtu", VTU(PIECE(OF_CELLS(VALUES("UInt8", "vtkGhostType", "1")), RIGHT)));
  text_file(fixture, "none.vtu",
            VTU("<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points><DataArray type=\"Float64\" "
                "NumberOfComponents=\"3\" "
                "format=\"ascii\"></DataArray></Points><Cells>" VALUES("Int32", "connectivity", "")
                    VALUES("Int32", "offsets", "") VALUES("UInt8", "types", "") "</Cells></Piece>"));
  const char *path = text_file(fixture, "good.pvtu",
                               PVTU(SOURCE("none.vtu") SOURCE("ghost.vtu") SOURCE("left.vtu") SOURCE("none.vtu")));
  TetcastDataset *dataset = read_with(fixture, path, tetcast_dataset_desc_default());
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, 1);
  assert_int_equal(tetcast_dataset_pieces(dataset).ghost_points, 4);
  assert_int_equal(tetcast_dataset_pieces(dataset).merged_points, 0);
  assert_int_equal(health_of(fixture, dataset).boundary_faces, 4);
  tetcast_dataset_destroy(&dataset);

  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU(SOURCE("ghost.vtu"))), TETCAST_ERROR_DATA, "no cells but ghosts");
  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU(SOURCE("none.vtu"))), TETCAST_ERROR_DATA, "no cells");
  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU("")), TETCAST_ERROR_DATA, "no cells");
  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU("<Piece/>")), TETCAST_ERROR_DATA, "names no file");
  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU(SOURCE("left.vtu") SOURCE("gone.vtu"))), TETCAST_ERROR_IO,
           "gone.vtu: can't be opened: No such file");
  read_bad(fixture, text_file(fixture, "a.pvtu", PVTU(SOURCE("a.pvtu"))), TETCAST_ERROR_DATA, "eight times over");
  read_bad(fixture,
           text_file(fixture, "a.pvtu", PVTU(SOURCE("a.pvtu") SOURCE("a.pvtu") SOURCE("a.pvtu") SOURCE("a.pvtu"))),
           TETCAST_ERROR_DATA, "eight times over");
}

/* The same mesh, by other software: in one file and in four, without and with ghosts. */
static void test_others_pieces(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *whole = read_good(fixture, data_path(fixture, "encodings/ascii.vtu"));
  const TetcastMeshHealth expected = health_of(fixture, whole);
  static const char *const names[] = {"encodings/pieces.pvtu", "encodings/pieces_ghost.pvtu"};
  for (int i = 0; i < 2; ++i) {
    TetcastDataset *dataset = read_with(fixture, data_path(fixture, names[i]), tetcast_dataset_desc_default());
    const TetcastMeshHealth health = health_of(fixture, dataset);
    assert_int_equal(tetcast_dataset_pieces(dataset).pieces, 4);
    assert_int_equal(tetcast_dataset_pieces(dataset).ghost_cells, i ? 529 : 0);
    assert_int_equal(tetcast_dataset_cell_count(dataset) - tetcast_dataset_pieces(dataset).ghost_cells,
                     tetcast_dataset_cell_count(whole));
    assert_true(fabs(health.volume / expected.volume - 1) < 1e-12);
    assert_int_equal(health.boundary_faces, expected.boundary_faces);
    assert_int_equal(health.components, expected.components);
    assert_int_equal(health.coincident_vertices, expected.coincident_vertices);
    assert_int_equal(health.unused_vertices, expected.unused_vertices);
    tetcast_dataset_destroy(&dataset);
  }
  tetcast_dataset_destroy(&whole);
  whole = read_good(fixture, data_path(fixture, "cells/cube_pvtu/cube.pvtu"));
  const TetcastMeshHealth health = health_of(fixture, whole);
  assert_int_equal(health.components, 1);
  assert_int_equal(health.boundary_faces, 6 * 9 * 2);
  tetcast_dataset_destroy(&whole);
  whole = read_good(fixture, data_path(fixture, "cells/polyhedron2pieces.vtu"));
  assert_int_equal(tetcast_dataset_pieces(whole).pieces, 2);
  tetcast_dataset_destroy(&whole);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(test_layers),           TEST(test_blanked),   TEST(test_tolerance),     TEST(test_cracks),
      TEST(test_values),           TEST(test_nonfinite), TEST(test_cell_to_point), TEST(test_cell_to_point_twice),
      TEST(test_arrays_of_pieces), TEST(test_odd_lists), TEST(test_others_pieces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
