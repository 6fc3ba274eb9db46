/* SPDX-License-Identifier: Apache-2.0 */
/* Files that a mesh consists of are listed, and each read by itself: together they are the mesh, without a gap. */
#include "box.h"

#define PVTU(sources)                                                                                                  \
  "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid>" sources "</PUnstructuredGrid></VTKFile>"
#define SOURCE(file) "<Piece Source=\"" file "\"/>"
#define VALUES(type, name, values)                                                                                     \
  "<DataArray type=\"" type "\" Name=\"" name "\" format=\"ascii\">" values "</DataArray>"
/* Cells of 8 points, of which `types` says whether they are hexahedra, 12, or quadrilaterals that go round twice. */
#define CELL(xyz, connectivity, types)                                                                                 \
  "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"                  \
  "<Piece NumberOfPoints=\"8\" NumberOfCells=\"1\"><Points>"                                                           \
  "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" xyz                                         \
  "</DataArray></Points><Cells>" VALUES("Int32", "connectivity", connectivity) VALUES("Int32", "offsets", "8")         \
      VALUES("UInt8", "types", types) "</Cells></Piece></UnstructuredGrid></VTKFile>"

typedef struct List {
  char path[16][512];
  int64_t bytes[16];
  int count;
} List;

static void take(void *user, const char *path, int64_t bytes) {
  List *list = user;
  assert_true(list->count < 16);
  snprintf(list->path[list->count], sizeof list->path[0], "%s", path);
  list->bytes[list->count++] = bytes;
}

static List list_of(Fixture *fixture, const char *path, const TetcastDatasetDesc *desc) {
  List list = {.count = 0};
  fixture->errors = 0;
  assert_int_equal(tetcast_dataset_parts(fixture->context, path, desc, take, &list), TETCAST_OK);
  assert_int_equal(fixture->errors, 0);
  return list;
}

static void assert_named(const List *list, int i, const char *name) {
  assert_string_equal(strrchr(list->path[i], '/') + 1, name);
}

static TetcastDatasetDesc of_part(void) {
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.part = true;
  return desc;
}

/* Pieces, blocks of pieces, steps; and what is no list. */
static void test_lists(void **state) {
  Fixture *fixture = *state;
  sample_layers(in_folder(fixture, "a.vtu"), 0, 1, GHOST_TYPES);
  sample_layers(in_folder(fixture, "b.vtu"), 1, 3, GHOST_TYPES);
  sample_layers(in_folder(fixture, "c.vtu"), 3, 4, GHOST_TYPES);
  const char *path = in_folder(fixture, "a.vtu");
  assert_int_equal(list_of(fixture, path, NULL).count, 0);

  path = text_file(fixture, "all.pvtu", PVTU(SOURCE("a.vtu") SOURCE("gone.vtu") SOURCE("c.vtu")));
  List list = list_of(fixture, path, NULL);
  assert_int_equal(list.count, 3);
  assert_named(&list, 0, "a.vtu");
  assert_named(&list, 1, "gone.vtu");
  assert_named(&list, 2, "c.vtu");
  assert_true(list.bytes[0] > 1000 && list.bytes[1] == 0 && list.bytes[2] > 1000);

  text_file(fixture, "flat.vtp", "<VTKFile type=\"PolyData\"></VTKFile>");
  path = text_file(fixture, "all.vtm",
                   "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet>"
                   "<DataSet name=\"skin\" file=\"flat.vtp\"/><DataSet name=\"body\" file=\"all.pvtu\"/>"
                   "<DataSet name=\"rest\" file=\"b.vtu\"/></vtkMultiBlockDataSet></VTKFile>");
  list = list_of(fixture, path, NULL);
  assert_int_equal(list.count, 4);
  assert_named(&list, 0, "a.vtu");
  assert_named(&list, 3, "b.vtu");
  const TetcastDatasetDesc rest = of_block("rest");
  list = list_of(fixture, path, &rest);
  assert_int_equal(list.count, 1);
  assert_named(&list, 0, "b.vtu");

  path = text_file(fixture, "all.pvd",
                   "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"a.vtu\"/>"
                   "<DataSet timestep=\"2\" file=\"b.vtu\"/><DataSet timestep=\"2\" file=\"c.vtu\"/>"
                   "</Collection></VTKFile>");
  const TetcastDatasetDesc last = of_step(-1), at = of_time(0), none = of_step(2);
  list = list_of(fixture, path, &last);
  assert_int_equal(list.count, 2);
  assert_named(&list, 1, "c.vtu");
  assert_int_equal(list_of(fixture, path, &at).count, 1);
  assert_int_equal(tetcast_dataset_parts(fixture->context, path, &none, take, &list), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_parts(fixture->context, in_folder(fixture, "no.pvtu"), NULL, take, &list),
                   TETCAST_ERROR_IO);
  assert_int_equal(tetcast_dataset_parts(fixture->context, NULL, NULL, take, &list), TETCAST_ERROR_ARGUMENT);
  const TetcastDatasetDesc nothing = {.cookie = 0};
  assert_int_equal(tetcast_dataset_parts(fixture->context, path, &nothing, take, &list), TETCAST_ERROR_ARGUMENT);
}

/* All vertices of parts, those at one place as one, and their tetrahedra. */
typedef struct Whole {
  double vertex[512][3];
  int32_t tetrahedron[512][4];
  int vertices, tetrahedra;
} Whole;

static int32_t vertex_at(Whole *whole, const double p[3]) {
  for (int i = 0; i < whole->vertices; ++i)
    if (memcmp(whole->vertex[i], p, sizeof whole->vertex[i]) == 0)
      return i;
  assert_true(whole->vertices < 512);
  memcpy(whole->vertex[whole->vertices], p, sizeof whole->vertex[0]);
  return whole->vertices++;
}

static void add_part(Fixture *fixture, const char *path, Whole *whole) {
  TetcastDataset *dataset = read_with(fixture, path, of_part());
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); ++i) {
    int64_t v[4];
    tetcast_mesh_tetrahedron(mesh, i, v);
    assert_true(whole->tetrahedra < 512);
    for (int k = 0; k < 4; ++k) {
      double p[3];
      tetcast_mesh_vertex(mesh, v[k], p);
      whole->tetrahedron[whole->tetrahedra][k] = vertex_at(whole, p);
    }
    ++whole->tetrahedra;
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

static TetcastMeshHealth health_of(Fixture *fixture, const Whole *whole) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){.data = whole->vertex, .type = TETCAST_TYPE_FLOAT64, .count = whole->vertices};
  desc.tetrahedra = (TetcastArray){.data = whole->tetrahedron, .type = TETCAST_TYPE_INT32, .count = whole->tetrahedra};
  TetcastMesh *mesh;
  TetcastMeshHealth health;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  return health;
}

/* Layers of hexahedra: s and c at the right places, and together the box. */
static void test_layers(void **state) {
  Fixture *fixture = *state;
  static const char *const names[3] = {"a.vtu", "b.vtu", "c.vtu"};
  static const int first[4] = {0, 1, 3, 4};
  Whole *whole = calloc(1, sizeof *whole);
  for (int i = 0; i < 3; ++i) {
    const char *path = in_folder(fixture, names[i]);
    sample_layers(path, first[i], first[i + 1], GHOST_TYPES);
    TetcastDataset *dataset = read_with(fixture, path, of_part());
    assert_layers(fixture, dataset, first[i], first[i + 1], 1, true);
    tetcast_dataset_destroy(&dataset);
    add_part(fixture, path, whole);
  }
  const TetcastMeshHealth health = health_of(fixture, whole);
  assert_int_equal(health.boundary_faces, 2 * (2 * 3 * 2 + 2 * 3 * 4 + 2 * 2 * 4));
  assert_int_equal(health.nonmanifold_faces, 0);
  assert_true(fabs(health.volume / 12 - 1) < 1e-12);
  free(whole);
}

/* Two hexahedra with a bulging face between them, whose corners the second file has in every order that a hexahedron's
 * points can have: it is cut by the same diagonal. */
static void test_neighbours(void **state) {
  Fixture *fixture = *state;
  static const char *const points[8] = {"1 0 0", "2 0 0", "2 1 0", "1 1 0.125", "1.25 0 1", "2 0 1", "2 1 1", "1 1 1"};
  const char *left = text_file(fixture, "left.vtu",
                               CELL("0 0 0 1 0 0 1 1 0.125 0 1 0 0 0 1 1.25 0 1 1 1 1 0 1 1", "0 1 2 3 4 5 6 7", "12"));
  char first[512];
  snprintf(first, sizeof first, "%s", left);
  for (int turn = 0; turn < 8; ++turn) {
    char text[4096], xyz[512] = "", connectivity[64] = "";
    for (int i = 0; i < 8; ++i) { /* the file has point (i + turn) % 8 in place i */
      snprintf(xyz + strlen(xyz), sizeof xyz - strlen(xyz), "%s ", points[(i + turn) % 8]);
      snprintf(connectivity + strlen(connectivity), sizeof connectivity - strlen(connectivity), "%d ",
               (i + 8 - turn) % 8);
    }
    snprintf(text, sizeof text, CELL("%s", "%s", "12"), xyz, connectivity);
    Whole whole = {.vertices = 0};
    add_part(fixture, first, &whole);
    add_part(fixture, text_file(fixture, "right.vtu", text), &whole);
    const TetcastMeshHealth health = health_of(fixture, &whole);
    assert_int_equal(whole.vertices, 12);
    assert_int_equal(health.boundary_faces, 20);
    assert_int_equal(health.nonmanifold_faces, 0);
    assert_int_equal(health.components, 1);
  }
}

/* A part may be without volume, which a whole file may not. */
static void test_empty(void **state) {
  Fixture *fixture = *state;
  const char *flat = CELL("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1", "0 1 2 3 0 1 2 3", "7");
  const char *path = text_file(fixture, "flat.vtu", flat);
  TetcastDataset *dataset = read_with(fixture, path, of_part());
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_vertex_count(mesh), 0);
  assert_int_equal(tetcast_mesh_tetrahedron_count(mesh), 0);
  assert_int_equal(tetcast_dataset_pieces(dataset).surfaces, 1);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  read_bad(fixture, path, TETCAST_ERROR_DATA, "no volumetric cells");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_lists, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_layers, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_neighbours, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_empty, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
