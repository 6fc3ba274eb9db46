/* SPDX-License-Identifier: Apache-2.0 */
/* Exodus files: what they hold, and what becomes of damaged ones. */
#include <math.h>

#include "common.h"
#include "netcdf_file.h"

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
  for (int k = 0; k < 2; ++k)
    assert_true(fabs(range[0][k] - range[1][k]) < 1e-4);
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
  const TetcastStatus status =
      tetcast_dataset_read(fixture->context, file_of(fixture, "bad.ex2", bytes, size), NULL, &dataset);
  assert_int_equal(fixture->errors, status != TETCAST_OK); /* one line, of one line: see remember() */
  tetcast_dataset_destroy(&dataset);
  return status;
}

/* Not a byte of what the header speaks of may be missing: the NetCDF library would take zeros for it. */
static void test_truncation(void **state) {
  Fixture *fixture = *state;
  size_t size;
  char *bytes = contents(data_path(fixture, "volumes/disk_out_ref.ex2"), &size);
  for (size_t part = 0; part < 40; ++part)
    assert_int_not_equal(attempt(fixture, bytes, size * part / 40), TETCAST_OK);
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

/* ── elements with more nodes than their type ── */

enum { MOST_NODES = 32, FILE_DIMENSIONS = 9 };

typedef struct Element {
  const char *name;
  int nodes;
  double volume;
  const char *warning; /* NULL: none is due */
} Element;

/* The means of a shape's corners that its nodes are at, in Exodus' order: edges, then what else there is. */
static const char *const tetrahedron_nodes[] = {"0",  "1",  "2",    "3",   "01",  "12",  "20", "03",
                                                "13", "23", "0123", "012", "013", "123", "023"};
static const char *const tetrahedron_faces[] = {"0",  "1",  "2",  "3",   "01",  "12",  "20",
                                                "03", "13", "23", "012", "013", "123", "023"};
static const char *const tetrahedron_8[] = {"0", "1", "2", "3", "012", "013", "123", "023"};
static const char *const pyramid_nodes[] = {"0",  "1",  "2",  "3",    "4",   "01",  "12",  "23",  "30",   "04",
                                            "14", "24", "34", "0123", "014", "124", "234", "304", "01234"};
static const char *const wedge_nodes[] = {"0",  "1",  "2",  "3",  "4",    "5",    "01",   "12",  "20",  "03",    "14",
                                          "25", "34", "45", "53", "0134", "1245", "2053", "012", "345", "012345"};
static const char *const wedge_16[] = {"0",  "1",  "2",  "3",  "4",  "5",  "01", "12",
                                       "20", "03", "14", "25", "34", "45", "53", "012345"};
static const char *const hexahedron_nodes[] = {"0",  "1",  "2",        "3",    "4",    "5",    "6",    "7",    "01",
                                               "12", "23", "30",       "04",   "15",   "26",   "37",   "45",   "56",
                                               "67", "74", "01234567", "0123", "4567", "0374", "1265", "0154", "3267"};
static const char *const hexahedron_9[] = {"0", "1", "2", "3", "4", "5", "6", "7", "01234567"};

static const double tetrahedron_corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double pyramid_corners[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
static const double wedge_corners[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
static const double hexahedron_corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

static double linear(const double p[3]) {
  return p[0] + 2 * p[1] + 4 * p[2];
}

static void place_node(const Element *element, int i, double p[3]) {
  const double(*corners)[3] = hexahedron_corners;
  const char *const *nodes = element->nodes == 9 ? hexahedron_9 : hexahedron_nodes;
  if (element->name[0] == 'T' || element->name[0] == 't') {
    corners = tetrahedron_corners;
    nodes = element->nodes == 8 ? tetrahedron_8 : element->nodes == 14 ? tetrahedron_faces : tetrahedron_nodes;
  } else if (element->name[0] == 'P') {
    corners = pyramid_corners;
    nodes = pyramid_nodes;
  } else if (element->name[0] == 'W') {
    corners = wedge_corners;
    nodes = element->nodes == 16 ? wedge_16 : wedge_nodes;
  }
  const size_t count = strlen(nodes[i]);
  for (int k = 0; k < 3; ++k)
    p[k] = 0;
  for (size_t c = 0; c < count; ++c) {
    for (int k = 0; k < 3; ++k)
      p[k] += corners[nodes[i][c] - '0'][k] / (double)count;
  }
}

/* Two elements, three apart along x, of which each node is one's own; u is linear, twice as much at the second step,
 * and what is called `moved` beside it is a vector, 0 at the first and (0, 0, 1) at the second. */
static const char *write_elements(Fixture *fixture, const Element *element, const char *moved) {
  const int n = element->nodes, points = 2 * n;
  double x[3][2 * MOST_NODES], u[4][4 * MOST_NODES];
  int connect[2 * MOST_NODES];
  for (int i = 0; i < points; ++i) {
    double p[3];
    place_node(element, i % n, p);
    p[0] += 3 * (i / n);
    for (int k = 0; k < 3; ++k)
      x[k][i] = p[k];
    connect[i] = i + 1;
    for (int step = 0; step < 2; ++step)
      u[0][step * points + i] = (1 + step) * linear(p); /* step after step */
    for (int k = 0; k < 3; ++k) {
      for (int step = 0; step < 2; ++step)
        u[1 + k][step * points + i] = k == 2 ? step : 0;
    }
  }
  char names[4][33] = {"u"};
  for (int k = 0; k < 3; ++k)
    snprintf(names[1 + k], sizeof names[0], "%s%c", moved, "xyz"[k]);
  const NetcdfDimension dimensions[FILE_DIMENSIONS] = {
      {"len_string", 33}, {"time_step", 0},      {"num_dim", 3},         {"num_nodes", points}, {"num_elem", 2},
      {"num_el_blk", 1},  {"num_el_in_blk1", 2}, {"num_nod_per_el1", n}, {"num_nod_var", 4}};
  const NetcdfAttribute attributes[] = {{"api_version", NULL, 5, 8.03},
                                        {"version", NULL, 5, 8.03},
                                        {"floating_point_word_size", NULL, 4, 8},
                                        {"file_size", NULL, 4, 1},
                                        {"title", "test", 0, 0}};
  const double times[2] = {0, 0.5};
  const int one = 1;
  const NetcdfVariable variables[] = {{"time_whole", {1, -1, -1}, 'd', times, NULL, NULL},
                                      {"eb_status", {5, -1, -1}, 'i', &one, NULL, NULL},
                                      {"eb_prop1", {5, -1, -1}, 'i', &one, "name", "ID"},
                                      {"coordx", {3, -1, -1}, 'd', x[0], NULL, NULL},
                                      {"coordy", {3, -1, -1}, 'd', x[1], NULL, NULL},
                                      {"coordz", {3, -1, -1}, 'd', x[2], NULL, NULL},
                                      {"connect1", {6, 7, -1}, 'i', connect, "elem_type", element->name},
                                      {"name_nod_var", {8, 0, -1}, 'c', names, NULL, NULL},
                                      {"vals_nod_var1", {1, 3, -1}, 'd', u[0], NULL, NULL},
                                      {"vals_nod_var2", {1, 3, -1}, 'd', u[1], NULL, NULL},
                                      {"vals_nod_var3", {1, 3, -1}, 'd', u[2], NULL, NULL},
                                      {"vals_nod_var4", {1, 3, -1}, 'd', u[3], NULL, NULL}};
  netcdf_write(in_folder(fixture, "cells.e"), dimensions, FILE_DIMENSIONS, 2, attributes, 5, variables,
               sizeof variables / sizeof *variables);
  return fixture->path;
}

/* The two cells have the volume they should, and u is as linear at every vertex as at the nodes, `shift` along z taken
 * off. */
static void assert_elements(Fixture *fixture, const TetcastDataset *dataset, const Element *element, double scale,
                            double shift) {
  TetcastMesh *mesh;
  TetcastField *field;
  TetcastMeshHealth health;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume - 2 * element->volume) < 1e-12);
  assert_int_equal(health.components, 2);
  assert_int_equal(health.nonmanifold_faces + health.degenerate_cells, 0);
  assert_int_equal(tetcast_dataset_field(dataset, "u", &field, NULL), TETCAST_OK);
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); ++i) {
    int64_t v[4];
    tetcast_mesh_tetrahedron(mesh, i, v);
    for (int k = 0; k < 4; ++k) {
      double p[3];
      tetcast_mesh_vertex(mesh, v[k], p);
      p[2] -= shift;
      assert_true(fabs(tetcast_field_value(field, v[k]) - scale * linear(p)) < 1e-12);
    }
  }
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
}

/* VTK takes the nodes that it knows no use for as the next element's. */
static void test_nodes(void **state) {
  static const Element elements[] = {
      {"TETRA", 4, 1.0 / 6, NULL},
      {"tet8", 8, 1.0 / 6, "the first 4, at corners, are used"},
      {"TETRA10", 10, 1.0 / 6, NULL},
      {"TETRA", 11, 1.0 / 6, "the first 10, at corners and edges, are used"},
      {"TETRA14", 14, 1.0 / 6, "TETRA14, of 14 nodes each: the first 10, at corners and edges, are used"},
      {"TETRA15", 15, 1.0 / 6, "the first 10"},
      {"TETRA12", 12, 1.0 / 6, "the first 4, at corners, are used"},
      {"PYRAMID5", 5, 1.0 / 3, NULL},
      {"PYRAMID13", 13, 1.0 / 3, NULL},
      {"PYRAMID14", 14, 1.0 / 3, NULL},
      {"PYRAMID18", 18, 1.0 / 3, "the first 14"},
      {"PYRAMID19", 19, 1.0 / 3, "the first 14"},
      {"PYRAMID", 15, 1.0 / 3, "the first 5"},
      {"WEDGE6", 6, 0.5, NULL},
      {"WEDGE12", 12, 0.5, "the first 6"},
      {"WEDGE15", 15, 0.5, NULL},
      {"WEDGE16", 16, 0.5, "the first 15"},
      {"WEDGE18", 18, 0.5, NULL},
      {"WEDGE20", 20, 0.5, "the first 15"},
      {"WEDGE21", 21, 0.5, "the first 15"},
      {"HEX8", 8, 1, NULL},
      {"HEX9", 9, 1, "HEX9, of 9 nodes each: the first 8, at corners, are used"},
      {"HEX20", 20, 1, NULL},
      {"HEX21", 21, 1, "the first 20"},
      {"HEX26", 26, 1, "the first 20"},
      {"HEX27", 27, 1, NULL}};
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof elements / sizeof *elements; ++i) {
    fixture->warnings = 0;
    fixture->warning[0] = '\0';
    TetcastDataset *dataset = read_good(fixture, write_elements(fixture, &elements[i], "v"));
    assert_int_equal(fixture->warnings, elements[i].warning != NULL);
    if (elements[i].warning && !strstr(fixture->warning, elements[i].warning))
      fail_msg("'%s' lacks '%s'", fixture->warning, elements[i].warning);
    assert_elements(fixture, dataset, &elements[i], 1, 0);
    tetcast_dataset_destroy(&dataset);
  }
  static const Element too_few = {"HEX", 7, 0, NULL};
  read_bad(fixture, write_elements(fixture, &too_few, "v"), TETCAST_ERROR_DATA,
           "its 7 nodes don't make an element of type HEX");
}

/* Points are moved by what is called a displacement, if that is not declined. */
static void test_displacement(void **state) {
  static const Element element = {"HEX20", 20, 1, NULL};
  static const struct {
    const char *name;
    bool declined;
    double shift;
  } cases[] = {{"v", false, 0}, {"disp", false, 1}, {"DISPL_", false, 1}, {"disp", true, 0}};
  Fixture *fixture = *state;
  for (int i = 0; i < 4; ++i) {
    const char *path = write_elements(fixture, &element, cases[i].name);
    for (int step = 0; step < 2; ++step) {
      TetcastDatasetDesc desc = tetcast_dataset_desc_default();
      TetcastDataset *dataset;
      desc.step = step;
      desc.no_displacement = cases[i].declined;
      assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset), TETCAST_OK);
      assert_elements(fixture, dataset, &element, 1 + step, step * cases[i].shift);
      tetcast_dataset_destroy(&dataset);
    }
  }
}

/* Whether what the command says of a file, as JSON, has this text in it, apart from white space. */
static bool said(const char *options, const char *path, const char *text) {
  char command[4096], found[65536] = "";
  snprintf(command, sizeof command, "\"$TETCAST_COMMAND\" info --json %s '%s' | tr -d ' \\n'", options, path);
  FILE *output = popen(command, "r");
  assert_non_null(output);
  found[fread(found, 1, sizeof found - 1, output)] = '\0';
  assert_int_equal(pclose(output), 0);
  return strstr(found, text) != NULL;
}

/* The same of the command; $TETCAST_COMMAND is where it is. */
static void test_command(void **state) {
  static const Element element = {"TETRA", 4, 1.0 / 6, NULL};
  if (!getenv("TETCAST_COMMAND"))
    skip();
  const char *path = write_elements(*state, &element, "disp");
  assert_true(said("--time 0", path, "\"bounds\":[0.0,4.0,0.0,1.0,0.0,1.0]"));
  assert_true(said("--time 1", path, "\"bounds\":[0.0,4.0,0.0,1.0,1.0,2.0]"));
  assert_true(said("--time 1 --no-displacement", path, "\"bounds\":[0.0,4.0,0.0,1.0,0.0,1.0]"));
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_same_as_vtu),  TEST(test_blocks), TEST(test_truncation),
                                     TEST(test_flipped_bits), TEST(test_nodes),  TEST(test_displacement),
                                     TEST(test_command)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
