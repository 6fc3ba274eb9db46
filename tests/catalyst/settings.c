/* SPDX-License-Identifier: Apache-2.0 */
/* What can be said under catalyst/tetcast, and what is told back. */
#include "simulation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SIZE "\"size\": [64, 48]"
static const int three[3] = {3, 2, 2};
static const double nowhere[3] = {0, 0, 0};

static conduit_node *step_of(const Body *body, int64_t number) {
  conduit_node *step = simulation_step(number);
  body_describe(body, NULL, simulation_mesh(step));
  return step;
}

static void forget(const char *path) {
  assert_int_equal(unlink(path), 0);
}

static void begin(conduit_node *params) {
  if (simulation_begin_with(params) != 0)
    fail_msg("initialize: %s", said);
  assert_string_equal(said, "");
}

static void run(conduit_node *step) {
  if (simulation_run(step) != 0)
    fail_msg("execute: %s", said);
}

/* The same scene as text, as a file, as a node of its keys, and beside another that it takes the place of. */
static void ways_to_say_a_scene(void **state) {
  (void)state;
  static const char *const scene = "{\"input\": \"unused.vtu\", " SIZE
                                   ", \"array\": \"V:y\", \"preset\": \"inferno\", \"range\": [-1, 1], \"log\": false, "
                                   "\"bare\": true, \"isosurface\": [\"0.1:red\", \"0.4\"], \"background\": \"white\", "
                                   "\"camera\": {\"eye\": [9, 4, 7], \"fovy\": 25}}";
  Body *body = body_create(BODY_HEX, three, nowhere, 0.1);
  body_write(body, "body.vtu");
  simulation_render("body.vtu", scene, "file.png"); /* which leaves scene.json */
  for (int way = 0; way < 4; way++) {
    conduit_node *params = simulation_params(way == 0 ? scene : way == 1 ? "./scene.json" : NULL, "a.####.png");
    const char *place = way == 2 ? "catalyst/tetcast/scene" : "catalyst/tetcast";
    if (way >= 2) {
      static double size[2] = {64, 48}, range[2] = {-1, 1}, eye[3] = {9, 4, 7};
      conduit_node *node = conduit_node_fetch(params, place);
      conduit_node_set_path_external_float64_ptr(node, "size", size, 2);
      conduit_node_set_path_char8_str(node, "array", "V:y");
      conduit_node_set_path_char8_str(node, "preset", "inferno");
      conduit_node_set_path_external_float64_ptr(node, "range", range, 2);
      conduit_node_set_path_int64(node, "log", 0);
      conduit_node_set_path_int64(node, "bare", 1);
      conduit_node_set_path_char8_str(node, "background", "white");
      conduit_node_set_path_external_float64_ptr(node, "camera/eye", eye, 3);
      conduit_node_set_path_float64(node, "camera/fovy", 25);
      conduit_node *list = conduit_node_fetch(node, "isosurface");
      conduit_node_set_path_char8_str(conduit_node_append(list), "", "0.1:red");
      conduit_node_set_path_char8_str(conduit_node_append(list), "", "0.4");
      if (way == 3)
        conduit_node_set_path_char8_str(params, "catalyst/tetcast/scene",
                                        "{\"size\": [10, 10], \"array\": \"T\", \"isosurface\": \"9\"}");
    }
    begin(params);
    run(step_of(body, 0));
    assert_int_equal(simulation_end(), 0);
    simulation_compare("a.0000.png", "file.png");
    forget("a.0000.png");
  }
  body_destroy(body);
}

/* Transfer functions and the like lie where the scene does, when it is a file. */
static void paths_in_scenes(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  assert_int_equal(system("mkdir -p deep"), 0);
  FILE *f = fopen("deep/colors.json", "w");
  fputs("{\"color\": [[0, 0, 0, 1], [1, 1, 1, 0]], \"extinction\": [[0, 0.1], [1, 2]]}", f);
  fclose(f);
  f = fopen("deep/scene.json", "w");
  fputs("{" SIZE ", \"array\": \"T\", \"transfer\": \"colors.json\", \"output\": \"own.##.exr\"}", f);
  fclose(f);
  body_write(body, "body.vtu");
  simulation_render("body.vtu", "{" SIZE ", \"array\": \"T\", \"transfer\": \"deep/colors.json\"}", "file.exr");
  begin(simulation_params("deep/scene.json", NULL));
  run(step_of(body, 7));
  run(step_of(body, 8));
  assert_int_equal(simulation_end(), 0);
  simulation_compare("deep/own.07.exr", "file.exr");
  simulation_compare("deep/own.08.exr", "file.exr");
  begin(simulation_params("{" SIZE ", \"array\": \"T\", \"transfer\": \"deep/colors.json\"}", "here.exr"));
  run(step_of(body, 7));
  assert_int_equal(simulation_end(), 0);
  simulation_compare("here.0007.exr", "file.exr");
  body_destroy(body);
}

static void names_and_numbers(void **state) {
  (void)state;
  static const char *const names[][2] = {{NULL, "tetcast.0012.png"},
                                         {"plain.png", "plain.0012.png"},
                                         {"a.###.exr", "a.012.exr"},
                                         {"b%d.png", "b12.png"},
                                         {"c%06d.png", "c000012.png"}};
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  for (int i = 0; i < 5; i++) {
    begin(simulation_params("{" SIZE "}", names[i][0]));
    run(step_of(body, 12));
    assert_int_equal(simulation_end(), 0);
    assert_int_equal(access(names[i][1], F_OK), 0);
    forget(names[i][1]);
  }
  /* the number: of the timestep, or the cycle, or the calls */
  for (int way = 0; way < 3; way++) {
    begin(simulation_params("{" SIZE "}", "n.##.png"));
    for (int i = 0; i < 2; i++) {
      conduit_node *step = conduit_node_create();
      if (way == 0)
        conduit_node_set_path_int64(step, "catalyst/state/timestep", 20 + i);
      if (way <= 1)
        conduit_node_set_path_int64(step, "catalyst/state/cycle", 30 + i);
      body_describe(body, NULL, simulation_mesh(step));
      run(step);
    }
    assert_int_equal(simulation_end(), 0);
    forget(way == 0 ? "n.20.png" : way == 1 ? "n.30.png" : "n.00.png");
    forget(way == 0 ? "n.21.png" : way == 1 ? "n.31.png" : "n.01.png");
  }
  body_destroy(body);
}

static void each_third_step(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  conduit_node *params = simulation_params("{" SIZE "}", "t.##.png");
  conduit_node_set_path_int64(params, "catalyst/tetcast/every", 3);
  begin(params);
  for (int i = 0; i < 8; i++)
    run(step_of(body, i));
  conduit_node *told = conduit_node_create();
  assert_int_equal(catalyst_results(told), 0);
  assert_int_equal(*(int64_t *)conduit_node_element_ptr(conduit_node_fetch(told, "catalyst/tetcast/steps"), 0), 8);
  assert_int_equal(*(int64_t *)conduit_node_element_ptr(conduit_node_fetch(told, "catalyst/tetcast/pictures"), 0), 3);
  assert_int_equal(*(int64_t *)conduit_node_element_ptr(conduit_node_fetch(told, "catalyst/tetcast/step"), 0), 6);
  assert_string_equal(conduit_node_as_char8_str(conduit_node_fetch(told, "catalyst/tetcast/picture")), "t.06.png");
  conduit_node_destroy(told);
  assert_int_equal(simulation_end(), 0);
  for (int i = 0; i < 8; i++) {
    char name[32];
    snprintf(name, sizeof name, "t.%02d.png", i);
    assert_int_equal(access(name, F_OK), i % 3 ? -1 : 0);
  }
  body_destroy(body);
}

static void what_is_told(void **state) {
  (void)state;
  begin(simulation_params(NULL, NULL));
  conduit_node *told = conduit_node_create();
  assert_int_equal(catalyst_about(told), 0);
  assert_string_equal(conduit_node_as_char8_str(conduit_node_fetch(told, "catalyst/implementation")), "tetcast");
  assert_int_equal(conduit_node_has_path(told, "catalyst/tetcast/version"), 1);
  assert_int_equal(catalyst_results(told), 0);
  assert_int_equal(*(int64_t *)conduit_node_element_ptr(conduit_node_fetch(told, "catalyst/tetcast/pictures"), 0), 0);
  assert_int_equal(conduit_node_has_path(told, "catalyst/tetcast/picture"), 0);
  conduit_node_destroy(told);
  assert_int_equal(simulation_end(), 0);
}

/* The first channel that is a mesh, or the one that is named. */
static void channels(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1), *other = body_create(BODY_TET, three, nowhere, 0.9);
  body_write(body, "body.vtu");
  simulation_render("body.vtu", "{" SIZE "}", "body.png");
  body_write(other, "other.vtu");
  simulation_render("other.vtu", "{" SIZE "}", "other.png");
  for (int named = 0; named < 2; named++) {
    conduit_node *params = simulation_params("{" SIZE "}", "ch.#.png");
    if (named)
      conduit_node_set_path_char8_str(params, "catalyst/tetcast/channel", "second");
    begin(params);
    conduit_node *step = simulation_step(0);
    conduit_node_set_path_char8_str(step, "catalyst/channels/levels/type", "amrmesh");
    body_describe(body, NULL, simulation_mesh(step));
    conduit_node_set_path_char8_str(step, "catalyst/channels/second/type", "mesh");
    body_describe(other, NULL, conduit_node_fetch(step, "catalyst/channels/second/data"));
    run(step);
    assert_int_equal(simulation_end(), 0);
    simulation_compare("ch.#.0000.png", named ? "other.png" : "body.png");
  }
  body_destroy(body);
  body_destroy(other);
}

/* Each step's picture is what the command makes of that step, also where something is kept from one to the next: a mesh
 * that moves in its own memory, one that only lies elsewhere, a field that is the same everywhere. The camera stays. */
static void one_step_after_the_other(void **state) {
  (void)state;
  static const char *const scene =
      "{" SIZE ", \"array\": \"T\", \"camera\": {\"eye\": [9, 5, 7], \"target\": [1, 1, 1]}}";
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  double *places[2];
  for (int i = 0; i < 2; i++)
    places[i] = malloc(sizeof *places[i] * (size_t)(3 * body->points));
  begin(simulation_params(scene, "s.##.exr"));
  for (int i = 0; i < 6; i++) {
    conduit_node *step = simulation_step(i), *mesh = simulation_mesh(step);
    if (i == 1 || i == 2)
      body->x[0] -= 0.25 * i;
    if (i == 2)
      body->nodes[0] = body->nodes[5]; /* one cell less, so to speak */
    for (int64_t k = 0; k < body->points; k++)
      body->t[k] = i == 4 ? 0.5 : body->t[k] * 1.1 + i;
    body_describe(body, NULL, mesh);
    double *coordinates = places[i == 3]; /* the same place for all steps but one */
    memcpy(coordinates, body->x, sizeof *coordinates * (size_t)(3 * body->points));
    for (int a = 0; a < 3; a++)
      standin_set(mesh,
                  a == 0   ? "coordsets/coords/values/x"
                  : a == 1 ? "coordsets/coords/values/y"
                           : "coordsets/coords/values/z",
                  STANDIN_FLOAT64, coordinates + a, body->points, 24);
    run(step);
    char name[32], path[32];
    snprintf(name, sizeof name, "s.%02d.exr", i);
    snprintf(path, sizeof path, "s%d.vtu", i);
    body_write(body, path);
    simulation_render(path, scene, "file.exr");
    simulation_compare(name, "file.exr");
  }
  assert_int_equal(simulation_end(), 0);
  free(places[0]);
  free(places[1]);
  body_destroy(body);
}

/* The array and the camera are those of the first picture, as in a series of the command; colours are each step's. */
static void as_a_series_of_files(void **state) {
  (void)state;
  static const char *const scene = "{" SIZE ", \"range\": \"step\"}";
  Body *body = body_create(BODY_WEDGE, three, nowhere, 0.1);
  char name[32], all[128] = "";
  assert_int_equal(system("mkdir series"), 0);
  begin(simulation_params("{" SIZE "}", "memory.##.exr"));
  for (int i = 0; i < 4; i++) {
    for (int64_t k = 0; k < 3 * body->points && i > 0; k++)
      body->x[k] = body->x[k] * 1.1 + 0.3; /* it moves, and grows */
    for (int64_t k = 0; k < body->points; k++) {
      body->v[3 * k] += 0.1 * i;
      body->t[k] = i == 0 ? 1 : (double)(k % 7); /* the same everywhere at first, so that V is drawn */
    }
    snprintf(name, sizeof name, "series/step_%d.vtu", i);
    strcat(strcat(all, name), " ");
    body_write(body, name);
    run(step_of(body, i));
  }
  assert_int_equal(simulation_end(), 0);
  simulation_render(all, scene, "file.##.exr");
  for (int i = 0; i < 4; i++) {
    char file[32];
    snprintf(name, sizeof name, "memory.%02d.exr", i);
    snprintf(file, sizeof file, "file.%02d.exr", i);
    simulation_compare(name, file);
  }
  body_destroy(body);
}

/* Warnings are told once, and are errors where that is asked for; quiet leaves them out. */
static void warnings(void **state) {
  (void)state;
  Body *body = body_create(BODY_MIXED, three, nowhere, 0.1);
  begin(simulation_params("{" SIZE "}", "w.##.png"));
  assert_int_equal(simulation_run(step_of(body, 0)), 0);
  assert_non_null(strstr(said, "tetcast: warning: cells of surfaces, lines and points are not drawn\n"));
  assert_int_equal(simulation_run(step_of(body, 1)), 0);
  assert_string_equal(said, "");
  assert_int_equal(simulation_end(), 0);
  begin(simulation_params("{" SIZE ", \"quiet\": true}", "w.##.png"));
  assert_int_equal(simulation_run(step_of(body, 0)), 0);
  assert_string_equal(said, "");
  assert_int_equal(simulation_end(), 0);
  begin(simulation_params("{" SIZE ", \"strict\": true}", "strict.##.png"));
  assert_int_equal(simulation_run(step_of(body, 0)), 102);
  assert_non_null(strstr(said, "tetcast: error: "));
  assert_int_equal(access("strict.00.png", F_OK), -1);
  assert_int_equal(simulation_end(), 0);
  body_destroy(body);
}

/* A single step may be empty; that all are is told at the end. */
static void pictures_that_show_nothing(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  begin(simulation_params("{" SIZE ", \"camera\": {\"eye\": [90, 0, 0], \"target\": [180, 0, 0]}}", "e.##.png"));
  run(step_of(body, 0));
  run(step_of(body, 1));
  assert_string_equal(said, "");
  assert_int_equal(simulation_end(), 0);
  assert_non_null(strstr(said, "tetcast: warning: of all steps: "));
  body_destroy(body);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(ways_to_say_a_scene),
                                     cmocka_unit_test(paths_in_scenes),
                                     cmocka_unit_test(names_and_numbers),
                                     cmocka_unit_test(each_third_step),
                                     cmocka_unit_test(what_is_told),
                                     cmocka_unit_test(channels),
                                     cmocka_unit_test(one_step_after_the_other),
                                     cmocka_unit_test(as_a_series_of_files),
                                     cmocka_unit_test(warnings),
                                     cmocka_unit_test(pictures_that_show_nothing)};
  return cmocka_run_group_tests(tests, simulation_enter, simulation_leave);
}
