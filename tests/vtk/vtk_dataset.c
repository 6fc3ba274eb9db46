/* SPDX-License-Identifier: Apache-2.0 */
/* Reading meshes and choosing fields. */
#include <math.h>
#include <pthread.h>

#include "common.h"

/* Two cubes side by side, a tetrahedron on the second, and a triangle and a vertex that are no volume. */
static const char mixed[] =
    "# vtk DataFile Version 3.0\nmixed\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 13 double\n"
    "0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  2 0 0  2 1 0  2 0 1  2 1 1  3 0 0\n"
    "CELLS 5 29\n"
    "3 0 1 2\n"
    "8 0 1 2 3 4 5 6 7\n"
    "4 8 9 10 12\n"
    "1 3\n"
    "8 1 8 9 2 5 10 11 6\n"
    "CELL_TYPES 5\n5 12 10 1 12\n"
    "CELL_DATA 5\nSCALARS part int\nLOOKUP_TABLE default\n10 11 12 13 14\n"
    "VECTORS flow float\n0 0 0  3 4 0  0 0 2  0 0 0  1e30 0 0\n"
    "POINT_DATA 13\nFIELD FieldData 4\n"
    "flow 1 13 double\n0 1 2 3 4 5 6 7 8 9 10 11 12\n"
    "small 1 13 unsigned_char\n0 1 2 3 4 5 6 7 8 9 10 11 255\n"
    "pair 2 13 short\n0 -1 1 -2 2 -3 3 -4 4 -5 5 -6 6 -7 7 -8 8 -9 9 -10 10 -11 11 -12 12 -13\n"
    "pair:mag 1 13 float\n1 1 1 1 1 1 1 1 1 1 1 1 1\n";

static void test_mixed_cells(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset = read_good(fixture, text_file(fixture, "mixed.vtk", mixed));
  assert_int_equal(tetcast_dataset_point_count(dataset), 13);
  assert_int_equal(tetcast_dataset_cell_count(dataset), 5);
  const char *name;
  int64_t count;
  assert_true(tetcast_dataset_cell_type(dataset, 0, &name, &count));
  assert_string_equal(name, "hexahedron");
  assert_int_equal(count, 2);
  assert_true(tetcast_dataset_cell_type(dataset, 3, &name, &count));
  assert_int_equal(count, 1);
  assert_false(tetcast_dataset_cell_type(dataset, 4, &name, &count));
  assert_false(tetcast_dataset_cell_type(dataset, -1, &name, &count));

  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  TetcastMeshHealth health;
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume - 2 - 1.0 / 6) < 1e-12);
  assert_int_equal(health.inverted_cells, 0);
  assert_int_equal(health.nonmanifold_faces, 0);
  /* The cubes agree about the diagonal between them: 10 faces of 2 triangles. The tetrahedron adds 4 faces, and hides
   * two triangles if the cube's diagonal is its own. */
  assert_int_equal(health.components, health.boundary_faces == 22 ? 1 : 2);
  assert_true(health.boundary_faces == 22 || health.boundary_faces == 24);

  /* Cell arrays follow the tetrahedra. */
  TetcastField *part;
  assert_int_equal(tetcast_dataset_field(dataset, "part", &part, NULL), TETCAST_OK);
  assert_int_equal(tetcast_field_association(part), TETCAST_CELL);
  const int64_t tetrahedra = tetcast_mesh_tetrahedron_count(mesh);
  assert_int_equal(tetcast_field_values(part).count, tetrahedra);
  for (int64_t i = 0; i < tetrahedra; ++i) {
    int64_t v[4];
    double x = 0;
    tetcast_mesh_tetrahedron(mesh, i, v);
    for (int j = 0; j < 4; ++j) {
      double p[3];
      tetcast_mesh_vertex(mesh, v[j], p);
      x += p[0] / 4;
    }
    const double expected = x < 1 ? 11 : v[0] == 12 || v[1] == 12 || v[2] == 12 || v[3] == 12 ? 12 : 14;
    assert_true(tetcast_field_value(part, i) == expected);
  }
  tetcast_field_destroy(&part);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  tetcast_dataset_destroy(&dataset);
  tetcast_dataset_destroy(NULL);
}

static void assert_field(const TetcastDataset *dataset, const char *selector, const char *name,
                         TetcastAssociation association, int64_t i, double value) {
  TetcastField *field = NULL;
  const char *again = NULL;
  assert_int_equal(tetcast_dataset_field(dataset, selector, &field, &again), TETCAST_OK);
  assert_string_equal(again, name);
  assert_int_equal(tetcast_field_association(field), association);
  assert_true(tetcast_field_value(field, i) == value);
  tetcast_field_destroy(&field);
}

static void test_selectors(void **state) {
  Fixture *fixture = *state;
  const char *path = text_file(fixture, "mixed.vtk", mixed);
  TetcastDataset *dataset = NULL;
  assert_int_equal(tetcast_dataset_read(fixture->context, path, &(TetcastDatasetDesc){0}, &dataset),
                   TETCAST_ERROR_ARGUMENT);
  assert_null(dataset);
  dataset = read_good(fixture, path);
  TetcastDatasetArray array;
  static const char *const names[] = {"flow", "small", "pair", "pair:mag", "part", "flow"};
  static const char *const types[] = {"float64", "uint8", "int16", "float32", "int32", "float32"};
  for (int i = 0; i < 6; ++i) {
    assert_true(tetcast_dataset_array(dataset, i, &array));
    assert_string_equal(array.name, names[i]);
    assert_string_equal(array.type, types[i]);
    assert_int_equal(array.association, i < 4 ? TETCAST_POINT : TETCAST_CELL);
    assert_int_equal(array.components, i == 2 ? 2 : i == 5 ? 3 : 1);
    assert_int_equal(array.active, i == 4);
  }
  assert_false(tetcast_dataset_array(dataset, 6, &array));
  assert_false(tetcast_dataset_array(dataset, -1, &array));

  assert_field(dataset, NULL, "part", TETCAST_CELL, 0, 11);     /* the active one */
  assert_field(dataset, "flow", "flow", TETCAST_POINT, 12, 12); /* points before cells */
  assert_field(dataset, "flow:mag", "flow:mag", TETCAST_POINT, 3, 3);
  assert_field(dataset, "small", "small", TETCAST_POINT, 12, 255);
  assert_field(dataset, "pair", "pair", TETCAST_POINT, 3, 5);         /* several components: their length */
  assert_field(dataset, "pair:mag", "pair:mag", TETCAST_POINT, 3, 1); /* a whole name first */
  assert_field(dataset, "pair:0", "pair:0", TETCAST_POINT, 3, 3);
  assert_field(dataset, "pair:1", "pair:1", TETCAST_POINT, 3, -4);
  assert_field(dataset, "pair:mag:0", "pair:mag:0", TETCAST_POINT, 3, 1);

  static const char *const wrong[] = {"nothing",          "",     "pair:2", "pair:-1", "pair:", "pair:0x",
                                      "pair:99999999999", ":mag", "Flow"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    TetcastField *field = (TetcastField *)fixture;
    fixture->errors = 0;
    assert_int_equal(tetcast_dataset_field(dataset, wrong[i], &field, NULL), TETCAST_ERROR_ARGUMENT);
    assert_null(field);
    assert_complaint(fixture, "mixed.vtk", "there are: ");
  }
  assert_non_null(
      strstr(fixture->message, "flow, small, pair (2 components), pair:mag, part (cells), flow (cells, 3 components)"));
  tetcast_dataset_destroy(&dataset);
}

#define TETRAHEDRON                                                                                                    \
  "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 0 1 0 0 0 "                     \
  "1</DataArray></Points>"                                                                                             \
  "<Cells><DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 3</DataArray>"                              \
  "<DataArray type='Int32' Name='offsets' format='ascii'>4</DataArray>"                                                \
  "<DataArray type='UInt8' Name='types' format='ascii'>10</DataArray></Cells>"

static const char *xml(const char *attributes) {
  static char text[4096];
  snprintf(text, sizeof text,
           "<VTKFile type='UnstructuredGrid' version='0.1' byte_order='LittleEndian'><UnstructuredGrid>"
           "<Piece NumberOfPoints='4' NumberOfCells='1'>%s" TETRAHEDRON "</Piece></UnstructuredGrid></VTKFile>",
           attributes);
  return text;
}

/* Which array is shown when none is asked for. */
static void test_default_field(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *attributes, *name;
  } cases[] = {
      {"<PointData><DataArray type='Float64' Name='v' NumberOfComponents='2' format='ascii'>3 4 3 4 3 4 3 4</DataArray>"
       "<DataArray type='Float64' Name='s' format='ascii'>5 5 5 5</DataArray></PointData>",
       "s"},
      {"<PointData><DataArray type='Float64' Name='v' NumberOfComponents='2' format='ascii'>3 4 3 4 3 4 3 "
       "4</DataArray></PointData>"
       "<CellData><DataArray type='Float64' Name='c' format='ascii'>5</DataArray></CellData>",
       "v"},
      {"<PointData><DataArray type='Float64' Name='v' NumberOfComponents='2' format='ascii'>3 4 3 4 3 4 3 "
       "4</DataArray></PointData>",
       "v"},
      {"<PointData Scalars='b'><DataArray type='Int64' Name='a' format='ascii'>1 1 1 1</DataArray>"
       "<DataArray type='UInt64' Name='b' format='ascii'>5 5 5 5</DataArray></PointData>",
       "b"},
      {"<PointData><DataArray type='Int64' Name='a' format='ascii'>1 1 1 1</DataArray></PointData>"
       "<CellData Scalars='b'><DataArray type='Int8' Name='b' format='ascii'>5</DataArray></CellData>",
       "b"},
      {"<PointData GlobalIds='n'><DataArray type='Int64' Name='n' format='ascii'>0 1 2 3</DataArray></PointData>"
       "<CellData><DataArray type='UInt16' Name='c' format='ascii'>5</DataArray></CellData>",
       "c"}, /* numbers of points show nothing */
      {"<PointData><DataArray type='UInt8' Name='vtkGhostType' format='ascii'>0 0 0 0</DataArray>"
       "<DataArray type='Int16' Name='a' format='ascii'>5 5 5 5</DataArray></PointData>",
       "a"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastDataset *dataset = read_good(fixture, text_file(fixture, "a.vtu", xml(cases[i].attributes)));
    TetcastField *field;
    const char *name;
    assert_int_equal(tetcast_dataset_field(dataset, NULL, &field, &name), TETCAST_OK);
    assert_string_equal(name, cases[i].name);
    assert_true(tetcast_field_value(field, 0) == 5);
    tetcast_field_destroy(&field);
    tetcast_dataset_destroy(&dataset);
  }
  TetcastDataset *dataset = read_good(fixture, text_file(fixture, "a.vtu", xml("")));
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, NULL, &field, NULL), TETCAST_ERROR_DATA);
  assert_complaint(fixture, "a.vtu", "no arrays");
  tetcast_dataset_destroy(&dataset);
}

/* A wedge of 21 nodes, slightly bent, in each of the orders in which programs list them: VTK's, one with the edges in
 * Exodus's, and Exodus's. */
static void test_wedge_orders(void **state) {
  static const int corners[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  static const char *const places[15] = {"01", "12",  "02",  "34",   "45",   "35",   "03",    "14",
                                         "25", "012", "345", "0134", "1245", "0235", "012345"};
  static const int orders[3][15] = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14},
                                    {0, 1, 2, 6, 7, 8, 3, 4, 5, 11, 12, 13, 9, 10, 14},
                                    {0, 1, 2, 6, 7, 8, 3, 4, 5, 14, 9, 10, 12, 13, 11}};
  Fixture *fixture = *state;
  for (int bent = 0; bent < 2; ++bent) {
    double volume[3];
    for (int order = 0; order < 3; ++order) {
      char points[2048] = "", values[1024] = "", numbers[128] = "", text[8192];
      for (int i = 0; i < 21; ++i) {
        double p[3] = {0};
        const char *place = i < 6 ? (const char[2]){(char)('0' + i), 0} : places[orders[order][i - 6]];
        for (const char *c = place; *c; ++c) {
          for (int k = 0; k < 3; ++k)
            p[k] += corners[*c - '0'][k] / (double)strlen(place);
        }
        for (int k = 0; k < 3 && bent; ++k)
          p[k] += 0.05 * p[(k + 1) % 3] * p[(k + 1) % 3];
        snprintf(points + strlen(points), sizeof points - strlen(points), "%.17g %.17g %.17g ", p[0], p[1], p[2]);
        snprintf(values + strlen(values), sizeof values - strlen(values), "%.17g ", p[0] + 2 * p[1] + 4 * p[2]);
        snprintf(numbers + strlen(numbers), sizeof numbers - strlen(numbers), "%d ", i);
      }
      snprintf(text, sizeof text,
               "<VTKFile type='UnstructuredGrid' version='2.2' byte_order='LittleEndian'><UnstructuredGrid><Piece "
               "NumberOfPoints='21' NumberOfCells='1'>"
               "<PointData><DataArray type='Float64' Name='s' "
               "format='ascii'>%s</DataArray></PointData><Points><DataArray type='Float64'"
               " NumberOfComponents='3' format='ascii'>%s</DataArray></Points><Cells><DataArray type='Int32' "
               "Name='connectivity' format='ascii'>%s</DataArray>"
               "<DataArray type='Int32' Name='offsets' format='ascii'>21</DataArray><DataArray type='UInt8' "
               "Name='types' format='ascii'>73</DataArray></Cells>"
               "</Piece></UnstructuredGrid></VTKFile>",
               values, points, numbers);
      fixture->warnings = 0;
      TetcastDataset *dataset = read_good(fixture, text_file(fixture, "w.vtu", text));
      TetcastMesh *mesh;
      TetcastField *field;
      TetcastMeshHealth health;
      assert_int_equal(fixture->warnings, 0);
      assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
      assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
      volume[order] = health.volume;
      assert_true(fabs(health.volume - volume[0]) < 1e-12 && (bent || fabs(health.volume - 0.5) < 1e-12));
      assert_int_equal(tetcast_dataset_field(dataset, NULL, &field, NULL), TETCAST_OK);
      for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh); ++i) {
        double p[3];
        tetcast_mesh_vertex(mesh, i, p);
        assert_true(fabs(tetcast_field_value(field, i) - (p[0] + 2 * p[1] + 4 * p[2])) < 1e-12);
      }
      tetcast_field_destroy(&field);
      tetcast_mesh_destroy(&mesh);
      tetcast_dataset_destroy(&dataset);
    }
  }
}

/* The length of a vector whose squares over- or underflow. */
static void test_magnitude(void **state) {
  Fixture *fixture = *state;
  const char *path = text_file(fixture, "a.vtu",
                               xml("<PointData><DataArray type='Float64' Name='v' NumberOfComponents='2' "
                                   "format='ascii'>3e200 4e200 3e-200 4e-200 0 0 -5 12</DataArray></PointData>"));
  TetcastDataset *dataset = read_good(fixture, path);
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, "v:mag", &field, NULL), TETCAST_OK);
  static const double expected[] = {5e200, 5e-200, 0, 13};
  for (int i = 0; i < 4; ++i) {
    assert_true(fabs(tetcast_field_value(field, i) - expected[i]) <= 4e-16 * expected[i]);
  }
  tetcast_field_destroy(&field);
  tetcast_dataset_destroy(&dataset);
}

/* Every kind of attribute a legacy file may have, in both of its cell formats. */
static void test_legacy_attributes(void **state) {
  Fixture *fixture = *state;
  static const char points[] =
      "POINTS 4 int\n0 0 0 1 0 0 0 1 0 0 0 1\n\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\n"
      "DATA 2 0 1\n\n";
  static const char cells[][256] = {
      "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n",
      "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n",
      "CELLS 2 4\nOFFSETS int\n0 4\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n"};
  static const char attributes[] =
      "CELL_DATA 1\nSCALARS cell%20scalar double\nLOOKUP_TABLE mine\n5\nPOINT_DATA 4\nscalars first float "
      "2\nlookup_table default\n"
      "1 5 1 5 1 5 1 5\nLOOKUP_TABLE mine 2\n0 0 0 1  1 1 1 1\nSCALARS second unsigned_long\nLOOKUP_TABLE default\n5 5 "
      "5 5\n"
      "VECTORS v float\n5 0 0 0 0 5 0 5 0 3 4 0\nNORMALS n float\n0 0 5 0 0 5 0 0 5 0 0 5\nTENSORS t float\n"
      "5 0 0 0 0 0 0 0 0 5 0 0 0 0 0 0 0 0 5 0 0 0 0 0 0 0 0 5 0 0 0 0 0 0 0 0\nCOLOR_SCALARS c 2\n0 5 0 5 0 5 0 5\n"
      "TEXTURE_COORDINATES x 2 float\n0 5 0 5 0 5 0 5\nGLOBAL_IDS g vtkIdType\n5 6 7 8\nFIELD FieldData 3\nf 1 4 "
      "long\n5 5 5 5\n"
      "METADATA\nCOMPONENT_NAMES\nf\n\nb 1 4 bit\n1 0 1 0\nNULL_ARRAY\n";
  static const char *const names[] = {"first", "second", "v", "n", "t", "c", "x", "g", "f", "b", "cell scalar"};
  for (int i = 0; i < 3; ++i) {
    char text[4096];
    snprintf(
        text, sizeof text,
        "# vtk DataFile Version %s\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\ntime 1 1 double\n7\n%s%s%s",
        i ? "5.1" : "3.0", points, cells[i], attributes);
    TetcastDataset *dataset = read_good(fixture, text_file(fixture, "a.vtk", text));
    for (int j = 0; j < 11; ++j) {
      TetcastDatasetArray array;
      assert_true(tetcast_dataset_array(dataset, j, &array));
      assert_string_equal(array.name, names[j]);
      assert_int_equal(array.active, j == 0 || j == 10);
      TetcastField *field;
      assert_int_equal(tetcast_dataset_field(dataset, j ? names[j] : "first:1", &field, NULL), TETCAST_OK);
      assert_true(tetcast_field_value(field, 0) == (j == 9 ? 1 : 5));
      tetcast_field_destroy(&field);
    }
    TetcastMesh *mesh; /* whole numbers as coordinates become floating ones */
    assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
    assert_int_equal(tetcast_mesh_vertices(mesh).type, TETCAST_TYPE_FLOAT64);
    double p[3];
    tetcast_mesh_vertex(mesh, 3, p);
    assert_true(p[0] == 0 && p[1] == 0 && p[2] == 1);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }
}

/* XML under the other name, other blanks and quotes. */
static void test_content_beats_extension(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset = read_good(fixture, text_file(fixture, "a.vtk", xml("")));
  tetcast_dataset_destroy(&dataset);
  dataset = read_good(fixture, text_file(fixture, "mixed.vtu", mixed));
  tetcast_dataset_destroy(&dataset);
  dataset = read_good(fixture, text_file(fixture, "without_extension", mixed));
  tetcast_dataset_destroy(&dataset);
}

static TetcastDataset *reference;

static void assert_same_array(TetcastArray a, TetcastArray b, int components) {
  assert_int_equal(a.count, b.count);
  assert_int_equal(a.type, b.type);
  const int64_t size = (a.type == TETCAST_TYPE_FLOAT32 || a.type == TETCAST_TYPE_INT32 ? 4 : 8) * components;
  for (int64_t i = 0; i < a.count; ++i) {
    assert_memory_equal((const char *)a.data + i * (a.stride ? a.stride : size),
                        (const char *)b.data + i * (b.stride ? b.stride : size), (size_t)size);
  }
}

static void compare_with_reference(Fixture *fixture, const char *path) {
  if (strstr(path, "pieces"))
    return; /* parts of the whole */
  /* The ASCII ones of the legacy format are rounded. */
  const bool exact = !strstr(path, "legacy42_ascii") && !strstr(path, "legacy51_ascii");
  TetcastDataset *dataset = read_good(fixture, path);
  TetcastMesh *a, *b;
  assert_int_equal(tetcast_dataset_mesh(reference, &a), TETCAST_OK);
  assert_int_equal(tetcast_dataset_mesh(dataset, &b), TETCAST_OK);
  if (exact)
    assert_same_array(tetcast_mesh_vertices(a), tetcast_mesh_vertices(b), 3);
  assert_int_equal(tetcast_mesh_vertex_count(a), tetcast_mesh_vertex_count(b));
  assert_int_equal(tetcast_mesh_tetrahedron_count(a), tetcast_mesh_tetrahedron_count(b));
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(a); ++i) {
    int64_t v[4], w[4];
    tetcast_mesh_tetrahedron(a, i, v);
    tetcast_mesh_tetrahedron(b, i, w);
    assert_memory_equal(v, w, sizeof v);
  }
  static const char *const selectors[] = {"vel_norm", "velocity:0", "velocity:2", "velocity", "cellno", NULL};
  for (int i = 0; i < 6; ++i) {
    TetcastField *f, *g;
    assert_int_equal(tetcast_dataset_field(reference, selectors[i], &f, NULL), TETCAST_OK);
    assert_int_equal(tetcast_dataset_field(dataset, selectors[i], &g, NULL), TETCAST_OK);
    if (exact)
      assert_same_array(tetcast_field_values(f), tetcast_field_values(g), 1);
    for (int64_t j = 0; j < tetcast_field_values(f).count; ++j) {
      assert_true(fabs(tetcast_field_value(f, j) - tetcast_field_value(g, j)) < 1e-10);
    }
    tetcast_field_destroy(&f);
    tetcast_field_destroy(&g);
  }
  tetcast_mesh_destroy(&a);
  tetcast_mesh_destroy(&b);
  tetcast_dataset_destroy(&dataset);
}

static void test_encodings(void **state) {
  Fixture *fixture = *state;
  reference = read_good(fixture, data_path(fixture, "encodings/appraw_le_uint32_none.vtu"));
  assert_true(each_file(fixture, "encodings", ".vtu", compare_with_reference) > 40);
  assert_int_equal(each_file(fixture, "encodings", ".vtk", compare_with_reference), 4);
  tetcast_dataset_destroy(&reference);
}

/* Cells that another piece has as well are counted, but not there twice. */
static void test_pieces(void **state) {
  Fixture *fixture = *state;
  static const char *const names[] = {"encodings/pieces.pvtu", "encodings/pieces_ghost.pvtu"};
  for (int i = 0; i < 2; ++i) {
    TetcastDataset *dataset = read_good(fixture, data_path(fixture, names[i]));
    assert_int_equal(tetcast_dataset_cell_count(dataset), i ? 2051 : 1522);
    TetcastMesh *mesh;
    assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
    TetcastMeshHealth health;
    assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
    assert_int_equal(tetcast_mesh_tetrahedron_count(mesh), 1522);
    assert_true(fabs(health.volume / 3.056082092e-05 - 1) < 1e-9);
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, "cellno", &field, NULL), TETCAST_OK);
    double range[2], sum = 0;
    tetcast_field_range(field, range, NULL);
    assert_true(range[0] == 0 && range[1] == 1521);
    for (int64_t j = 0; j < 1522; ++j)
      sum += tetcast_field_value(field, j);
    assert_true(sum == 1521.0 * 1522 / 2);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }
}

/* Either a mesh, fields included, or one clear message. */
static void read_any(Fixture *fixture, const char *path) {
  TetcastDataset *dataset;
  fixture->errors = 0;
  const TetcastStatus status = tetcast_dataset_read(fixture->context, path, NULL, &dataset);
  if (status) {
    print_message("%s\n", fixture->message);
    assert_complaint(fixture, path, ": ");
    return;
  }
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_true(tetcast_mesh_tetrahedron_count(mesh) > 0);
  TetcastDatasetArray array;
  for (int i = 0; tetcast_dataset_array(dataset, i, &array); ++i) {
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, array.name, &field, NULL), TETCAST_OK);
    assert_int_equal(tetcast_field_values(field).count, tetcast_field_association(field) == TETCAST_POINT
                                                            ? tetcast_mesh_vertex_count(mesh)
                                                            : tetcast_mesh_tetrahedron_count(mesh));
    tetcast_field_destroy(&field);
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

static void test_others_files(void **state) {
  Fixture *fixture = *state;
  static const char *const folders[] = {"volumes", "cells", "cells/cube_pvtu", "defects"};
  for (int i = 0; i < 4; ++i)
    each_file(fixture, folders[i], "", read_any);
}

/* Where cells meet, the cuts agree: the boundary is that of the cells. Volumes are those of the cells. */
static void test_conforming(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *name;
    int64_t boundary_faces;
    double volume;
  } cases[] = {
      {"volumes/disk_out_ref.vtu", 2 * 1988, 0},
      {"volumes/fire_ug.vtu", 2 * 3546, 0},
      {"cells/QuadraticTetra.vtu", 4 * 48, 8},
      {"cells/hybridHexPrismMesh.vtk", 632, 1},
      {"cells/pebi3d_with_properties.vtu", 2056, 1},
      {"cells/supportedElements.vtk", 238, 119.491291493},
      {"cells/supportedElementsAsVTKPolyhedra.vtk", 238, 119.491291493},
      {"cells/polyhedron2pieces.vtu", 28, 8.0 / 3},
      {"cells/CylinderQuadratic.vtk", 2904, 3.056082092e-05},
      {"cells/uGridEx.vtk", 28, 7.0 / 3},
      {"cells/AngularSector.vtk", 8880, 4.883771487e-4},
      {"volumes/bluntfin_hex.vtu", 13516, 931.1626964},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastDataset *dataset = read_good(fixture, data_path(fixture, cases[i].name));
    TetcastMesh *mesh;
    assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
    TetcastMeshHealth health;
    assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
    assert_int_equal(health.boundary_faces, cases[i].boundary_faces);
    assert_int_equal(health.nonmanifold_faces, 0);
    if (cases[i].volume > 0)
      assert_true(fabs(health.volume / cases[i].volume - 1) < 1e-6);
    tetcast_mesh_destroy(&mesh);
    tetcast_dataset_destroy(&dataset);
  }
}

/* A quadratic hexahedron, which has no nodes in the middle of its faces: vertices come after the file's, and every
 * kind of array has values there. */
static void test_added_vertices(void **state) {
  Fixture *fixture = *state;
  static const double at[20][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                                   {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                                   {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
  char text[8192], part[256];
  int length =
      snprintf(text, sizeof text, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 20 float\n");
  for (int i = 0; i < 20; ++i)
    length += snprintf(text + length, sizeof text - (size_t)length, "%g %g %g\n", at[i][0], at[i][1], at[i][2]);
  length += snprintf(text + length, sizeof text - (size_t)length, "CELLS 1 21\n20");
  for (int i = 0; i < 20; ++i)
    length += snprintf(text + length, sizeof text - (size_t)length, " %d", i);
  length +=
      snprintf(text + length, sizeof text - (size_t)length,
               "\nCELL_TYPES 1\n25\nCELL_DATA 1\nSCALARS c int\nLOOKUP_TABLE default\n7\nPOINT_DATA 20\nFIELD F 4\n");
  static const char *const arrays[] = {"real 1 20 float", "whole 1 20 int", "tiny 1 20 unsigned_char",
                                       "pair 2 20 double"};
  for (int a = 0; a < 4; ++a) {
    length += snprintf(text + length, sizeof text - (size_t)length, "%s\n", arrays[a]);
    for (int i = 0; i < 20; ++i) { /* x² + 2 y z, a function that the cell has exactly */
      const double value = at[i][0] * at[i][0] + 2 * at[i][1] * at[i][2];
      if (a == 3)
        snprintf(part, sizeof part, "%g %g ", 3 * value, 4 * value);
      else
        snprintf(part, sizeof part, "%g ", value);
      length += snprintf(text + length, sizeof text - (size_t)length, "%s", part);
    }
  }
  TetcastDataset *dataset = read_good(fixture, text_file(fixture, "curved.vtk", text));
  assert_int_equal(tetcast_dataset_point_count(dataset), 20);
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_vertex_count(mesh), 27);
  assert_int_equal(tetcast_mesh_tetrahedron_count(mesh), 48);
  static const char *const selectors[] = {"real", "whole", "tiny", "pair:0", "pair:mag"};
  static const double factors[] = {1, 1, 1, 3, 5};
  for (int s = 0; s < 5; ++s) {
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, selectors[s], &field, NULL), TETCAST_OK);
    assert_int_equal(tetcast_field_values(field).count, 27);
    for (int64_t i = 0; i < 27; ++i) {
      double p[3];
      tetcast_mesh_vertex(mesh, i, p);
      assert_true(fabs(tetcast_field_value(field, i) - factors[s] * (p[0] * p[0] + 2 * p[1] * p[2])) < 1e-12);
    }
    tetcast_field_destroy(&field);
  }
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, "c", &field, NULL), TETCAST_OK);
  assert_int_equal(tetcast_field_values(field).count, 48);
  assert_true(tetcast_field_value(field, 47) == 7);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

/* Several threads read at a time, each hears of its own files only. */
static void *read_many(void *shared) {
  Fixture fixture = *(Fixture *)shared;
  open_context(&fixture);
  char good[600], bad[600];
  snprintf(good, sizeof good, "%s/good.vtu", fixture.folder);
  snprintf(bad, sizeof bad, "%s/bad.vtu", fixture.folder);
  for (int i = 0; i < 50; ++i) {
    TetcastDataset *dataset;
    fixture.errors = 0;
    if (tetcast_dataset_read(fixture.context, good, NULL, &dataset) != TETCAST_OK || fixture.errors != 0)
      return "good";
    tetcast_dataset_destroy(&dataset);
    if (tetcast_dataset_read(fixture.context, bad, NULL, &dataset) != TETCAST_ERROR_DATA || fixture.errors != 1)
      return "bad";
  }
  tetcast_context_destroy(&fixture.context);
  return NULL;
}

static void test_threads(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "good.vtu", xml(""));
  text_file(fixture, "bad.vtu",
            xml("<PointData><DataArray type='Int64' Name='short' format='ascii'>1</DataArray></PointData>"));
  pthread_t threads[4];
  for (int i = 0; i < 4; ++i)
    assert_int_equal(pthread_create(&threads[i], NULL, read_many, fixture), 0);
  for (int i = 0; i < 4; ++i) {
    void *failure;
    pthread_join(threads[i], &failure);
    assert_null(failure);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(test_mixed_cells),
      TEST(test_selectors),
      TEST(test_default_field),
      TEST(test_wedge_orders),
      TEST(test_magnitude),
      TEST(test_legacy_attributes),
      TEST(test_content_beats_extension),
      TEST(test_encodings),
      TEST(test_pieces),
      TEST(test_others_files),
      TEST(test_conforming),
      TEST(test_added_vertices),
      TEST(test_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
