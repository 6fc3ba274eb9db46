/* SPDX-License-Identifier: Apache-2.0 */
/* What is wrong with a node is told by one line that names the place, and the simulation goes on. */
#include "simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SIZE "\"size\": [32, 24]"
#define MESH "catalyst/channels/grid/data"
static const int three[3] = {3, 2, 2};
static const double nowhere[3] = {0, 0, 0};

/* The last call has said one line, an error with this text. */
static void check_line(const char *text) {
  const char *end = strchr(said, '\n');
  if (!end || end[1] || strncmp(said, "tetcast: error: ", 16) || !strstr(said, text))
    fail_msg("said: '%s', expected: '%s'", said, text);
}

/* ── nodes of execute ── */

/* One fault: of a body of this kind, at a path under the mesh, what is there becomes something else. */
typedef enum Change { TEXT, INTEGER, REMOVED, SHORTER, NUMBERS, ELEMENT, SWAPPED } Change;
typedef struct Fault {
  BodyKind kind;
  const char *path;
  Change change;
  const char *text; /* what it becomes; of an element: its number is in `at` */
  double value;
  int64_t at;
  const char *expected;
} Fault;

#define T "topologies/mesh"
#define C "coordsets/coords"
static const Fault faults[] = {
    {BODY_TET, "topologies", REMOVED, NULL, 0, 0, MESH ": has no topologies"},
    {BODY_TET, T "/coordset", REMOVED, NULL, 0, 0, MESH "/" T ": has no coordset"},
    {BODY_TET, T "/coordset", TEXT, "other", 0, 0, MESH "/" T "/coordset: there is no coordset 'other'"},
    {BODY_TET, "coordsets", REMOVED, NULL, 0, 0, MESH "/" T "/coordset: there is no coordset 'coords'"},
    {BODY_TET, C "/type", TEXT, "round", 0, 0,
     MESH "/" C "/type: expected explicit, uniform or rectilinear, not 'round'"},
    {BODY_TET, C "/type", REMOVED, NULL, 0, 0, MESH "/" C "/type: expected explicit"},
    {BODY_TET, C "/type", INTEGER, NULL, 3, 0, MESH "/" C "/type: expected explicit"},
    {BODY_TET, C "/values/y", REMOVED, NULL, 0, 0, MESH "/" C ": has no values/y"},
    {BODY_TET, C "/values/z", REMOVED, NULL, 0, 0, MESH "/" C ": has no values/z"},
    {BODY_TET, C "/values/y", SHORTER, NULL, 0, 0, MESH "/" C ": values/x has 36 numbers, but values/y has 35"},
    {BODY_TET, C "/values/x", TEXT, "one", 0, 0, MESH "/" C "/values/x: expected numbers"},
    {BODY_TET, C "/values/x", SWAPPED, NULL, 0, 0, MESH "/" C "/values/x: expected numbers"},
    {BODY_TET, C "/values/z", ELEMENT, NULL, (double)NAN, 17, MESH "/" C "/values/z: number 17 is nan"},
    {BODY_TET, C "/values/z", ELEMENT, NULL, -(double)INFINITY, 17, MESH "/" C "/values/z: number 17 is -inf"},
    {BODY_TET, C "/values/x", ELEMENT, NULL, 1e301, 0, "coordinates may be 1e+300 at most"},
    {BODY_TET, T "/type", TEXT, "knotted", 0, 0, MESH "/" T "/type: expected unstructured"},
    {BODY_TET, T "/type", REMOVED, NULL, 0, 0, MESH "/" T "/type: expected unstructured"},
    {BODY_TET, T "/type", TEXT, "rectilinear", 0, 0, MESH "/" T "/type: rectilinear, but its coordinates are explicit"},
    {BODY_TET, T "/type", TEXT, "points", 0, 0, MESH ": holds no volume, only surfaces, lines or points"},
    {BODY_TET, T "/elements/shape", TEXT, "blob", 0, 0, MESH "/" T "/elements/shape: unknown shape 'blob'"},
    {BODY_TET, T "/elements/shape", REMOVED, NULL, 0, 0, MESH "/" T "/elements/shape: unknown shape ''"},
    {BODY_TET, T "/elements/shape", TEXT, "tri", 0, 0, MESH ": holds no volume, only surfaces"},
    {BODY_TET, T "/elements/shape", TEXT, "mixed", 0, 0, MESH "/" T "/elements: has no sizes"},
    {BODY_TET, T "/elements/shape", TEXT, "polyhedral", 0, 0, MESH "/" T "/elements: has no sizes"},
    {BODY_TET, T "/elements", REMOVED, NULL, 0, 0, MESH "/" T "/elements/shape: unknown shape ''"},
    {BODY_TET, T "/elements/connectivity", REMOVED, NULL, 0, 0, MESH "/" T "/elements: has no connectivity"},
    {BODY_TET, T "/elements/connectivity", SHORTER, NULL, 0, 0,
     "connectivity: has 287 numbers, which is no multiple of the 4 of a tet"},
    {BODY_TET, T "/elements/connectivity", TEXT, "0 1 2 3", 0, 0,
     MESH "/" T "/elements/connectivity: expected whole numbers"},
    {BODY_TET, T "/elements/connectivity", NUMBERS, NULL, 0, 4,
     MESH "/" T "/elements/connectivity: expected whole numbers"},
    {BODY_TET, T "/elements/connectivity", ELEMENT, NULL, 36, 6, MESH ": tetrahedron 1 names vertex 36"},
    {BODY_TET, T "/elements/connectivity", ELEMENT, NULL, -1, 6, MESH ": tetrahedron 1 names vertex -1"},
    {BODY_HEX, T "/elements/connectivity", ELEMENT, NULL, 36, 9, MESH ": cell 1"},
    {BODY_HEX, T "/elements/connectivity", ELEMENT, NULL, -7, 9, MESH ": cell 1"},
    {BODY_MIXED, T "/elements/shape_map", REMOVED, NULL, 0, 0, MESH "/" T "/elements: has no shape_map"},
    {BODY_MIXED, T "/elements/shape_map/tet", TEXT, "ten", 0, 0, "shape_map/tet: expected a whole number"},
    {BODY_MIXED, T "/elements/shape_map/blob", INTEGER, NULL, 3, 0, "elements/shape_map: unknown shape 'blob'"},
    {BODY_MIXED, T "/elements/shape_map/hex", REMOVED, NULL, 0, 0, "elements/shapes: element 0 has the shape 12"},
    {BODY_MIXED, T "/elements/shapes", REMOVED, NULL, 0, 0, MESH "/" T "/elements: has no shapes"},
    {BODY_MIXED, T "/elements/shapes", SHORTER, NULL, 0, 0, "shapes, but"},
    {BODY_MIXED, T "/elements/shapes", ELEMENT, NULL, 99, 4, "elements/shapes: element 4 has the shape 99"},
    {BODY_MIXED, T "/elements/sizes", REMOVED, NULL, 0, 0, MESH "/" T "/elements: has no sizes"},
    {BODY_MIXED, T "/elements/sizes", ELEMENT, NULL, -1, 0, MESH "/" T "/elements: element 0 has the entries"},
    {BODY_MIXED, T "/elements/sizes", ELEMENT, NULL, 3, 0, MESH ": cell 0"},
    {BODY_MIXED, T "/elements/offsets", ELEMENT, NULL, 1e9, 1, MESH "/" T "/elements: element 1 has the entries"},
    {BODY_MIXED, T "/elements/offsets", ELEMENT, NULL, -4, 1, MESH "/" T "/elements: element 1 has the entries"},
    {BODY_MIXED, T "/elements/offsets", SHORTER, NULL, 0, 0, "sizes, but"},
    {BODY_MIXED, T "/subelements", REMOVED, NULL, 0, 0, MESH "/" T ": has no subelements"},
    {BODY_POLYHEDRA, T "/subelements", REMOVED, NULL, 0, 0, MESH "/" T ": has no subelements"},
    {BODY_POLYHEDRA, T "/elements/connectivity", ELEMENT, NULL, 999, 8,
     "elements/connectivity: element 1 has face 999"},
    {BODY_POLYHEDRA, T "/elements/connectivity", ELEMENT, NULL, -1, 8, "elements/connectivity: element 1 has face -1"},
    {BODY_POLYHEDRA, T "/subelements/connectivity", ELEMENT, NULL, 36, 5,
     "subelements/connectivity: face 1 has vertex 36"},
    {BODY_POLYHEDRA, T "/subelements/connectivity", ELEMENT, NULL, -1, 5,
     "subelements/connectivity: face 1 has vertex -1"},
    {BODY_POLYHEDRA, T "/subelements/sizes", ELEMENT, NULL, 1e6, 2, "subelements: element 2 has the entries"},
    {BODY_TET, "fields", REMOVED, NULL, 0, 0, MESH ": has no fields of topology 'mesh'"},
    {BODY_TET, "fields/T", REMOVED, NULL, 0, 0, MESH ": has no field 'T'; there are: V, C (element), M (element)"},
    {BODY_TET, "fields/T/association", TEXT, "face", 0, 0, MESH "/fields/T: its association is 'face'"},
    {BODY_TET, "fields/T/association", TEXT, "element", 0, 0, MESH "/fields/T: it has 36 values for 72 cells"},
    {BODY_TET, "fields/T/association", REMOVED, NULL, 0, 0, MESH "/fields/T: its association is ''"},
    {BODY_TET, "fields/T/values", REMOVED, NULL, 0, 0, MESH "/fields/T: it has no values"},
    {BODY_TET, "fields/T/values", SHORTER, NULL, 0, 0, MESH "/fields/T: it has 35 values for 36 points"},
    {BODY_TET, "fields/T/values", TEXT, "warm", 0, 0, MESH "/fields/T: its values are not numbers"},
    {BODY_TET, "fields/T/topology", TEXT, "other", 0, 0, MESH ": has no field 'T'"},
    {BODY_TET, "fields/ascent_ghosts/values", TEXT, "all", 0, 0,
     MESH "/fields/ascent_ghosts/values: expected a number for each of 36 points"},
    {BODY_TET, "fields/ascent_ghosts/values", NUMBERS, NULL, 1, 36, MESH ": holds no cells but ghosts"},
};

/* The tree again without what is at a path, as Conduit's C interface can't remove a node. */
static void copy_without(conduit_node *from, conduit_node *to, const char *without, const char *here) {
  for (int64_t i = 0; i < conduit_node_number_of_children(from); i++) {
    conduit_node *child = conduit_node_child(from, i);
    char *name = conduit_node_name(child), path[512];
    snprintf(path, sizeof path, "%s%s%s", here, *here ? "/" : "", name);
    if (strcmp(path, without)) {
      conduit_node *copy = conduit_node_fetch(to, name);
      if (conduit_node_number_of_children(child) > 0)
        copy_without(child, copy, without, path);
      else
        standin_copy(copy, child);
    }
    free(name);
  }
}

static conduit_node *broken_step(const Body *body, const Fault *fault) {
  conduit_node *step = simulation_step(0), *mesh = simulation_mesh(step);
  body_describe(body, NULL, mesh);
  conduit_node_set_path_char8_str(mesh, "fields/T/topology", "mesh");
  char path[256];
  snprintf(path, sizeof path, MESH "/%s", fault->path);
  conduit_node *node = fault->change == REMOVED ? NULL : conduit_node_fetch(step, path);
  switch (fault->change) {
  case TEXT:
    conduit_node_set_path_char8_str(node, "", fault->text);
    break;
  case INTEGER:
    conduit_node_set_path_int64(node, "", (int64_t)fault->value);
    break;
  case REMOVED: {
    conduit_node *copy = conduit_node_create();
    copy_without(step, copy, path, "");
    conduit_node_destroy(step);
    return copy;
  }
  case SHORTER:
    standin_shorten(node);
    break;
  case NUMBERS: {
    double *values = body_keep(fault->at, sizeof *values);
    for (int64_t i = 0; i < fault->at; i++)
      values[i] = fault->value;
    standin_set(node, "", STANDIN_FLOAT64, values, fault->at, 0);
    break;
  }
  case ELEMENT:
    if (conduit_datatype_is_float64(conduit_node_dtype(node)))
      *(double *)conduit_node_element_ptr(node, fault->at) = fault->value;
    else
      *(int32_t *)conduit_node_element_ptr(node, fault->at) = (int32_t)fault->value;
    break;
  case SWAPPED:
    standin_swap(node, "");
    break;
  }
  if (!strncmp(fault->path, "fields/ascent", 13))
    conduit_node_set_path_char8_str(mesh, "fields/ascent_ghosts/association", "vertex");
  return step;
}

static void broken_meshes(void **state) {
  (void)state;
  Body *good = body_create(BODY_TET, three, nowhere, 0.1);
  assert_int_equal(simulation_begin("{" SIZE ", \"array\": \"T\", \"quiet\": true}", "b.##.png"), 0);
  for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
    Body *body = body_create(faults[i].kind, three, nowhere, 0.1);
    const int code = simulation_run(broken_step(body, &faults[i]));
    check_line(faults[i].expected);
    assert_true(code == 100 || code == 102);
    assert_int_equal(access("b.00.png", F_OK), -1);
    body_destroy(body);
    conduit_node *step = simulation_step(1); /* which goes on */
    body_describe(good, NULL, simulation_mesh(step));
    assert_int_equal(simulation_run(step), 0);
    assert_string_equal(said, "");
    assert_int_equal(unlink("b.01.png"), 0);
  }
  assert_int_equal(simulation_end(), 0);
  body_destroy(good);
}

static void broken_grids(void **state) {
  (void)state;
  static const struct {
    const char *type, *path;
    int64_t value;
    const char *expected;
  } grids[] = {{"uniform", C "/dims/i", -3, "points is more than can be addressed"},
               {"uniform", C "/dims/j", 1 << 30, "a grid of 4 x 1073741824 x 3 points is more than can be addressed"},
               {"uniform", C "/dims/k", 1, ": holds no volume"},
               {"uniform", C "/dims/k", 0, ": holds no"},
               {"uniform", C "/dims/j", 4, "/fields/T: it has 36 values for 48 points"},
               {"structured", T "/elements/dims/i", 4, "a grid of 45 points, but its coordinates are of 36"},
               {"structured", T "/elements/dims/i", -1, "expected a whole number of elements"},
               {"structured", T "/elements/dims/i", INT64_MAX, "expected a whole number of elements"},
               {"structured", T "/elements/dims/strides/i", 1,
                "strides and offsets in a structured topology are not supported"}};
  Body *body = body_create(BODY_HEX, three, nowhere, 0.1);
  assert_int_equal(simulation_begin("{" SIZE ", \"array\": \"T\", \"quiet\": true}", "b.##.png"), 0);
  for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
    conduit_node *step = simulation_step(0), *mesh = simulation_mesh(step);
    body_describe_grid(body, grids[i].type, mesh);
    conduit_node_set_path_int64(mesh, grids[i].path, grids[i].value);
    assert_int_not_equal(simulation_run(step), 0);
    check_line(grids[i].expected);
  }
  conduit_node *step = simulation_step(0);
  body_describe_grid(body, "uniform", simulation_mesh(step));
  conduit_node_set_path_float64(simulation_mesh(step), C "/spacing/dx", (double)NAN);
  assert_int_not_equal(simulation_run(step), 0);
  check_line(MESH "/" C "/spacing/dx: expected a finite number");
  assert_int_equal(simulation_end(), 0);
  body_destroy(body);
}

static void broken_channels(void **state) {
  (void)state;
  assert_int_equal(simulation_begin("{" SIZE "}", "b.##.png"), 0);
  assert_int_equal(simulation_run(simulation_step(0)), 100);
  check_line("catalyst/channels: there are none");
  conduit_node *step = simulation_step(0);
  conduit_node_set_path_char8_str(step, "catalyst/channels/grid/type", "amrmesh");
  assert_int_equal(simulation_run(step), 100);
  check_line("catalyst/channels: none has the type mesh or multimesh; there are: grid");
  step = simulation_step(0);
  conduit_node_set_path_char8_str(step, "catalyst/channels/grid/type", "mesh");
  assert_int_equal(simulation_run(step), 100);
  check_line("catalyst/channels/grid: has no data");
  step = simulation_step(0);
  conduit_node_fetch(simulation_mesh(step), "left");
  assert_int_equal(simulation_run(step), 102);
  check_line(MESH ": holds no cells");
  assert_int_equal(simulation_run(conduit_node_create()), 100);
  check_line("catalyst/channels: there are none");
  assert_int_equal(simulation_end(), 0);
  conduit_node *params = simulation_params("{" SIZE "}", "b.##.png");
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/channel", "other");
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/topology", "inner");
  assert_int_equal(simulation_begin_with(params), 0);
  step = simulation_step(0);
  simulation_mesh(step);
  assert_int_equal(simulation_run(step), 100);
  check_line("catalyst/channels: there is no channel 'other'; there are: grid");
  assert_int_equal(simulation_end(), 0);
}

static void broken_parts(void **state) {
  (void)state;
  static const double aside[3] = {3, 0, 0};
  Body *left = body_create(BODY_TET, three, nowhere, 0.1), *right = body_create(BODY_HEX, three, aside, 0.1);
  assert_int_equal(simulation_begin("{" SIZE ", \"array\": \"T\"}", "b.##.png"), 0);
  right->nodes[8] = 777;
  for (int fault = 0; fault < 2; fault++) {
    conduit_node *step = simulation_step(0), *mesh = simulation_mesh(step);
    conduit_node_set_path_char8_str(step, "catalyst/channels/grid/type", "multimesh");
    body_describe(left, NULL, conduit_node_fetch(mesh, "left"));
    body_describe(right, NULL, conduit_node_fetch(mesh, "right"));
    if (fault == 1) {
      conduit_node_set_path_char8_str(mesh, "right/topologies/mesh/elements/shape", "blob");
      right->nodes[8] = 1;
    }
    assert_int_not_equal(simulation_run(step), 0);
    check_line(fault == 0 ? MESH "/right: cell 1 has vertex 777, but there are 36 vertices"
                          : MESH "/right/topologies/mesh/elements/shape: unknown shape 'blob'");
  }
  assert_int_equal(simulation_end(), 0);
  body_destroy(left);
  body_destroy(right);
}

/* ── nodes of initialize ── */

static void broken_settings(void **state) {
  (void)state;
  static const struct {
    const char *scene, *key, *value;
    double number;
    const char *expected;
  } settings[] = {
      {"nowhere.json", NULL, NULL, 0, "cannot open 'nowhere.json'"},
      {"{\"size\": [10, 10]", NULL, NULL, 0, "catalyst/tetcast/scene:1: "},
      {"{\"colour\": 3}", NULL, NULL, 0, "catalyst/tetcast/scene: unknown key 'colour'"},
      {"{\"size\": [0, 10]}", NULL, NULL, 0, "catalyst/tetcast/scene: size: "},
      {NULL, "every", NULL, 0, "catalyst/tetcast/every: expected a whole number from 1"},
      {NULL, "every", NULL, 1.5, "catalyst/tetcast/every: expected a whole number from 1"},
      {NULL, "every", "two", 0, "catalyst/tetcast/every: expected a whole number from 1"},
      {NULL, "channel", NULL, 3, "catalyst/tetcast/channel: expected a name"},
      {NULL, "preset", "nonesuch", 0, "catalyst/tetcast: preset: "},
      {NULL, "arrays", "T", 0, "catalyst/tetcast: unknown key 'arrays'; did you mean 'array'?"},
      {NULL, "array", "\xff\xfe", 0, "catalyst/tetcast/array: expected text in UTF-8"},
      {NULL, "exposure", NULL, (double)NAN, "catalyst/tetcast/exposure: expected text in UTF-8, or finite numbers"},
      {NULL, "scene", NULL, 3, "catalyst/tetcast/scene: expected the path"},
      {NULL, "scene/camera", "front", 0, "catalyst/tetcast/scene: camera: expected an object"},
      {NULL, "orbit", "12", 0, "catalyst/tetcast: orbit: not possible in a simulation"},
      {NULL, "stats", "stats.json", 0, "catalyst/tetcast: stats: not possible in a simulation"},
      {NULL, "range", "series", 0, "catalyst/tetcast: range: series: not possible in a simulation"},
      {NULL, "transfer", "nowhere.json", 0, "cannot open 'nowhere.json'"},
      {NULL, "shadows", NULL, 1, "--shadows, --ambient-occlusion: need"}};
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
    conduit_node *params = simulation_params(settings[i].scene, NULL);
    char path[64];
    snprintf(path, sizeof path, "catalyst/tetcast/%s", settings[i].key ? settings[i].key : "");
    if (settings[i].value)
      conduit_node_set_path_char8_str(params, path, settings[i].value);
    else if (settings[i].key)
      conduit_node_set_path_float64(params, path, settings[i].number);
    assert_int_not_equal(simulation_begin_with(params), 0);
    check_line(settings[i].expected);
    conduit_node *step = simulation_step(0); /* of which initialize has said why there is no picture */
    assert_int_equal(simulation_run(step), 102);
    assert_string_equal(said, "");
    assert_int_equal(simulation_end(), 0);
  }
  assert_int_equal(simulation_begin(NULL, NULL), 0);
  assert_int_equal(simulation_end(), 0);
}

/* Each process of several would write its own part under the same name. */
static void several_processes(void **state) {
  (void)state;
  for (int way = 0; way < 4; way++) {
    conduit_node *params = simulation_params("{" SIZE "}", "m.##.png");
    if (way < 3)
      conduit_node_set_path_int64(params, "catalyst/mpi_comm", way == 2 ? 8 : 9);
    standin_processes = way == 0 ? 1 : 4;
    if (way == 3)
      setenv("OMPI_COMM_WORLD_SIZE", "3", 1);
    const int code = simulation_begin_with(params);
    standin_processes = 1;
    unsetenv("OMPI_COMM_WORLD_SIZE");
    assert_int_equal(code, way % 2 ? 102 : 0); /* of the third, nothing tells how many there are */
    if (way % 2)
      check_line(way == 1 ? "" /* of MPI, or that there is none */
                          : "catalyst/mpi_comm: expected what MPI_Comm_c2f() returns, as the simulation has 3");
    assert_int_equal(simulation_end(), 0);
  }
}

/* Pictures that can't be written are told of at each step, until they can. */
static void unwritable_pictures(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  assert_int_equal(simulation_begin("{" SIZE "}", "missing/p.##.png"), 0);
  for (int i = 0; i < 3; i++) {
    conduit_node *step = simulation_step(i);
    body_describe(body, NULL, simulation_mesh(step));
    if (i == 2)
      assert_int_equal(system("mkdir missing"), 0);
    assert_int_equal(simulation_run(step), i == 2 ? 0 : 102);
    if (i < 2)
      check_line("missing/p.##.png");
  }
  assert_int_equal(access("missing/p.02.png", F_OK), 0);
  assert_int_equal(simulation_end(), 0);
  assert_int_equal(simulation_begin("{" SIZE "}", "p.nonesuch"), 0);
  conduit_node *step = simulation_step(0);
  body_describe(body, NULL, simulation_mesh(step));
  assert_int_equal(simulation_run(step), 102);
  check_line("nonesuch");
  assert_int_equal(simulation_end(), 0);
  body_destroy(body);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(broken_meshes),      cmocka_unit_test(broken_grids),
                                     cmocka_unit_test(broken_channels),    cmocka_unit_test(broken_parts),
                                     cmocka_unit_test(broken_settings),    cmocka_unit_test(several_processes),
                                     cmocka_unit_test(unwritable_pictures)};
  return cmocka_run_group_tests(tests, simulation_enter, simulation_leave);
}
