/* SPDX-License-Identifier: Apache-2.0 */
/* Each way to describe a mesh, its fields and its ghosts gives the picture that the same data in a file give. */
#include "simulation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIZE "\"size\": [96, 72]"
static const int four[3] = {4, 3, 3};
static const double nowhere[3] = {0, 0, 0};
static const char *const scene_of_t = "{" SIZE ", \"array\": \"T\"}";

static void draw(const Body *body, const BodyView *view, const char *scene, const char *words) {
  conduit_node *step = simulation_step(0);
  body_describe(body, view, simulation_mesh(step));
  simulation_agree(body, step, scene, words);
}

static void layouts_of_coordinates(void **state) {
  (void)state;
  for (int single = 0; single < 2; single++)
    for (int layout = LAYOUT_APART; layout <= LAYOUT_PADDED; layout++) {
      Body *body = body_create(BODY_TET, four, nowhere, 0.3);
      body->single = single;
      draw(body, &(BodyView){.layout = (BodyLayout)layout}, scene_of_t, NULL);
      body_destroy(body);
    }
}

static void types_of_indices(void **state) {
  (void)state;
  static const StandinType types[] = {STANDIN_INT16,  STANDIN_UINT16, STANDIN_INT32,
                                      STANDIN_UINT32, STANDIN_INT64,  STANDIN_UINT64};
  for (int set = 0; set < 2; set++) {
    Body *body = body_create(set ? BODY_MIXED : BODY_TET, four, nowhere, 0.3);
    body_write(body, "body.vtu");
    simulation_render("body.vtu", scene_of_t, "file.exr");
    for (int i = 0; i < 12; i++) {
      const BodyView view = {.index = types[i % 6], .spread = i > 5, .no_offsets = i % 2};
      conduit_node *step = simulation_step(0);
      body_describe(body, &view, simulation_mesh(step));
      simulation_draw(scene_of_t, step, set ? "not drawn" : NULL);
      simulation_compare("picture.0000.exr", "file.exr");
    }
    body_destroy(body);
  }
}

static void kinds_of_cells(void **state) {
  (void)state;
  static const char *const scenes[] = {"{" SIZE ", \"array\": \"T\"}",
                                       "{" SIZE ", \"array\": \"C\"}",
                                       "{" SIZE ", \"array\": \"V\"}",
                                       "{" SIZE ", \"array\": \"V:y\", \"range\": [-1, 1]}",
                                       "{" SIZE ", \"array\": \"M\"}",
                                       "{" SIZE ", \"array\": \"C\", \"cell_to_point\": true}",
                                       "{" SIZE ", \"array\": \"T\", \"stretch\": [1, 2, 0.5]}",
                                       "{" SIZE "}"};
  for (int kind = BODY_TET; kind <= BODY_POLYHEDRA; kind++) {
    Body *body = body_create((BodyKind)kind, four, nowhere, 0.1 * kind);
    for (size_t i = (size_t)kind % 3; i < sizeof scenes / sizeof *scenes; i += kind == BODY_TET ? 1 : 3)
      draw(body, NULL, scenes[i], kind == BODY_MIXED ? "not drawn" : NULL);
    body_destroy(body);
  }
}

static void warped_cells(void **state) {
  (void)state;
  for (int kind = BODY_TET; kind <= BODY_POLYHEDRA; kind++) {
    Body *body = body_create((BodyKind)kind, four, nowhere, 0.2);
    for (int64_t i = 0; i < 3 * body->points; i++)
      body->x[i] += 0.15 * (double)(i * 7919 % 101) / 101;
    draw(body, NULL, scene_of_t, kind == BODY_MIXED ? "not drawn" : NULL);
    body_destroy(body);
  }
}

static void grids(void **state) {
  (void)state;
  static const char *const types[] = {"uniform", "rectilinear", "structured"};
  static const double place[3] = {1, -2, 0.5};
  Body *body = body_create(BODY_HEX, four, place, 0.4);
  for (int i = 0; i < 3; i++) {
    conduit_node *step = simulation_step(0);
    body_describe_grid(body, types[i], simulation_mesh(step));
    simulation_agree(body, step, scene_of_t, NULL);
    if (i == 0) /* the others have any spacing */
      for (int64_t k = 0; k < 3 * body->points; k++)
        body->x[k] *= body->x[k] > 1 ? 1.5 : 1;
  }
  body_destroy(body);
}

/* Values that all types hold, as each of them. */
static void types_of_values(void **state) {
  (void)state;
  static const char *const labels = "{" SIZE ", \"array\": \"M\"}";
  Body *body = body_create(BODY_HEX, four, nowhere, 0.4), *labelled = body_create(BODY_TET, four, nowhere, 0);
  for (int64_t i = 0; i < body->points; i++)
    body->t[i] = (double)(i * 13 % 97);
  body_write(body, "body.vtu");
  simulation_render("body.vtu", scene_of_t, "file.exr");
  body_write(labelled, "labelled.vtu");
  simulation_render("labelled.vtu", labels, "labelled.exr");
  for (int type = STANDIN_INT8; type <= STANDIN_FLOAT64; type++) {
    const StandinType as = (StandinType)type;
    char *data = body_keep(body->points, 24);
    for (int64_t i = 0; i < body->points; i++) {
      const int64_t whole = (int64_t)body->t[i];
      const float single = (float)whole;
      memcpy(data + 24 * i,
             as == STANDIN_FLOAT64   ? (const void *)&body->t[i]
             : as == STANDIN_FLOAT32 ? (const void *)&single
                                     : &whole,
             (size_t)standin_size(as));
    }
    conduit_node *step = simulation_step(0);
    body_describe(body, NULL, simulation_mesh(step));
    standin_set(simulation_mesh(step), "fields/T/values", as, data, body->points, 24);
    simulation_draw(scene_of_t, step, NULL);
    simulation_compare("picture.0000.exr", "file.exr");
    if (as >= STANDIN_FLOAT32)
      continue; /* which are no labels */
    char *marks = body_keep(labelled->cells, 8);
    for (int64_t i = 0; i < labelled->cells; i++)
      memcpy(marks + i * standin_size(as), &labelled->m[i],
             (size_t)standin_size(as) > 4 ? 4 : (size_t)standin_size(as));
    step = simulation_step(0);
    body_describe(labelled, NULL, simulation_mesh(step));
    standin_set(simulation_mesh(step), "fields/M/values", as, marks, labelled->cells, 0);
    simulation_draw(labels, step, NULL);
    simulation_compare("picture.0000.exr", "labelled.exr");
  }
  body_destroy(body);
  body_destroy(labelled);
}

/* ── ghosts ── */

static void mark(conduit_node *mesh, const char *name, const char *association, StandinType type, void *data,
                 int64_t count) {
  char path[128];
  snprintf(path, sizeof path, "fields/%s/association", name);
  conduit_node_set_path_char8_str(mesh, path, association);
  snprintf(path, sizeof path, "fields/%s/topology", name);
  conduit_node_set_path_char8_str(mesh, path, "mesh");
  snprintf(path, sizeof path, "fields/%s/values", name);
  standin_set(mesh, path, type, data, count, 0);
}

static void ghosts(void **state) {
  (void)state;
  for (int kind = BODY_TET; kind <= BODY_POLYHEDRA; kind++)
    for (int way = kind % 2; way < 5; way += 2) {
      Body *body = body_create((BodyKind)kind, four, nowhere, 0.2);
      conduit_node *step = simulation_step(0), *mesh = simulation_mesh(step);
      int32_t *cells = body_keep(body->cells, 4), *points = body_keep(body->points, 4);
      const bool of_points = way == 1 || way == 4;
      body->ghost_cells = of_points ? NULL : calloc((size_t)body->cells, 1);
      body->ghost_points = of_points ? calloc((size_t)body->points, 1) : NULL;
      for (int64_t i = 0; i < body->cells && !of_points; i++) {
        static const uint8_t bits[8] = {0, 1, 2, 8, 32, 4, 0, 0}; /* 2 and 4 are no reasons */
        body->ghost_cells[i] = bits[i % 8];
        cells[i] = way == 0 ? (i % 8 == 1) + 2 * (i % 8 == 3 || i % 8 == 4) : bits[i % 8];
        if (way == 3)
          cells[i] = bits[i % 8] & 41 ? 6 : 0; /* what the simulation calls them */
      }
      for (int64_t i = 0; i < body->points && of_points; i++) {
        body->ghost_points[i] = (uint8_t)(i % 19 == 0 ? 2 : i % 7 == 0 ? 1 : 0); /* 1 is of another part, and drawn */
        points[i] = way == 1 ? i % 19 == 0 : body->ghost_points[i];
      }
      body_describe(body, NULL, mesh);
      const char *name = way < 2 ? "ascent_ghosts" : way == 2 ? "vtkGhostType" : "marks";
      mark(mesh, name, of_points ? "vertex" : "element", STANDIN_INT32, of_points ? points : cells,
           of_points ? body->points : body->cells);
      if (way > 2)
        conduit_node_set_path_char8_str(mesh, "state/metadata/vtk_fields/marks/attribute_type", "Ghosts");
      if (way == 3) {
        conduit_node_set_path_int64(mesh, "state/metadata/vtk_fields/marks/values_to_replace", 6);
        conduit_node_set_path_int64(mesh, "state/metadata/vtk_fields/marks/replacement_values", 32);
      }
      simulation_agree(body, step, way % 2 ? "{" SIZE ", \"array\": \"C\"}" : "{" SIZE ", \"array\": \"T\"}",
                       kind == BODY_MIXED ? "not drawn" : NULL);
      body_destroy(body);
    }
}

/* ── several meshes ── */

static void write_vtm(void) {
  FILE *f = fopen("parts.vtm", "w");
  fputs("<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>", f);
  for (int i = 0; i < 3; i++)
    fprintf(f, "<DataSet index=\"%d\" name=\"part%d\" file=\"part%d.vtu\"/>", i, i, i);
  fputs("</vtkMultiBlockDataSet></VTKFile>\n", f);
  fclose(f);
}

/* Parts of different kinds whose points at the seams coincide, with ghosts in one of them. */
static void several_meshes(void **state) {
  (void)state;
  static const double places[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
  static const char *const names[] = {"left", "right", "behind"}, *const scenes[] = {"{" SIZE ", \"array\": \"T\"}",
                                                                                     "{" SIZE ", \"array\": \"C\"}",
                                                                                     "{" SIZE ", \"array\": \"V\"}",
                                                                                     "{" SIZE ", \"array\": \"M\"}"};
  static const BodyKind kinds[2][3] = {{BODY_TET, BODY_TET, BODY_TET}, {BODY_HEX, BODY_MIXED, BODY_POLYHEDRA}};
  for (int set = 0; set < 2; set++)
    for (int i = 0; i < 4; i++) {
      const bool domains = (i + set) % 2; /* of one mesh, or several meshes */
      conduit_node *step = simulation_step(0);
      Body *bodies[3];
      conduit_node_set_path_char8_str(step, "catalyst/channels/grid/type", domains ? "mesh" : "multimesh");
      for (int p = 0; p < 3; p++) {
        char name[32];
        bodies[p] = body_create(kinds[set][p], four, places[p], 0.2);
        snprintf(name, sizeof name, "part%d.vtu", p);
        conduit_node *mesh = conduit_node_fetch(simulation_mesh(step), names[p]);
        body_describe(bodies[p], NULL, mesh);
        if (p == 1) {
          bodies[p]->ghost_cells = calloc((size_t)bodies[p]->cells, 1);
          for (int64_t k = 0; k < bodies[p]->cells; k++)
            bodies[p]->ghost_cells[k] = k % 5 == 0;
          mark(mesh, "vtkGhostType", "element", STANDIN_UINT8, bodies[p]->ghost_cells, bodies[p]->cells);
        }
        body_write(bodies[p], name);
      }
      write_vtm();
      simulation_render("parts.vtm", scenes[i], "file.exr");
      simulation_draw(scenes[i], step, set == 1 ? "not drawn" : NULL);
      simulation_compare("picture.0000.exr", "file.exr");
      for (int p = 0; p < 3; p++)
        body_destroy(bodies[p]);
    }
}

/* Of the topologies of a mesh the first that has a volume is drawn, or the one that is named. */
static void several_topologies(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, four, nowhere, 0.2), *half = body_create(BODY_TET, four, nowhere, 0.2);
  half->cells /= 2;
  for (int named = 0; named < 2; named++) {
    conduit_node *step = simulation_step(0), *mesh = simulation_mesh(step);
    static int32_t triangle[3] = {0, 1, 2}, *nodes;
    conduit_node_set_path_char8_str(mesh, "topologies/boundary/type", "unstructured");
    conduit_node_set_path_char8_str(mesh, "topologies/boundary/coordset", "coords");
    conduit_node_set_path_char8_str(mesh, "topologies/boundary/elements/shape", "tri");
    conduit_node_set_path_external_int32_ptr(mesh, "topologies/boundary/elements/connectivity", triangle, 3);
    body_describe(body, NULL, mesh);
    nodes = body_keep(4 * half->cells, 4);
    for (int64_t i = 0; i < 4 * half->cells; i++)
      nodes[i] = (int32_t)half->nodes[i];
    conduit_node_set_path_char8_str(mesh, "topologies/half/type", "unstructured");
    conduit_node_set_path_char8_str(mesh, "topologies/half/coordset", "coords");
    conduit_node_set_path_char8_str(mesh, "topologies/half/elements/shape", "tet");
    conduit_node_set_path_external_int32_ptr(mesh, "topologies/half/elements/connectivity", nodes, 4 * half->cells);
    conduit_node_set_path_char8_str(mesh, "fields/F/association", "vertex");
    conduit_node_set_path_char8_str(mesh, "fields/F/topology", named ? "half" : "mesh");
    conduit_node_set_path_external_float64_ptr(mesh, "fields/F/values", body->t, body->points);
    static const char *const scene = "{" SIZE ", \"array\": \"F\", \"legend\": \"T\"}",
                             *const file = "{" SIZE ", \"array\": \"T\", \"legend\": \"T\"}";
    body_write(named ? half : body, "body.vtu");
    simulation_render("body.vtu", file, "file.exr");
    conduit_node *params = simulation_params(scene, "picture.####.exr");
    if (named)
      conduit_node_set_path_char8_str(params, "catalyst/tetcast/topology", "half");
    assert_int_equal(simulation_begin_with(params), 0);
    assert_int_equal(simulation_run(step), 0);
    assert_int_equal(simulation_end(), 0);
    simulation_compare("picture.0000.exr", "file.exr");
  }
  body_destroy(body);
  body_destroy(half);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(layouts_of_coordinates),
                                     cmocka_unit_test(types_of_indices),
                                     cmocka_unit_test(kinds_of_cells),
                                     cmocka_unit_test(warped_cells),
                                     cmocka_unit_test(grids),
                                     cmocka_unit_test(types_of_values),
                                     cmocka_unit_test(ghosts),
                                     cmocka_unit_test(several_meshes),
                                     cmocka_unit_test(several_topologies)};
  return cmocka_run_group_tests(tests, simulation_enter, simulation_leave);
}
