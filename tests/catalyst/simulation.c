/* SPDX-License-Identifier: Apache-2.0 */
#include "simulation.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

char said[65536];
static char folder[] = "/tmp/tetcast-catalyst-XXXXXX";

int simulation_enter(void **state) {
  (void)state;
  return mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

int simulation_leave(void **state) {
  (void)state;
  char command[256];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return chdir("/") == 0 && system(command) == 0 ? 0 : -1;
}

/* Calls with standard error in a file, and standard output as well: nothing may come there. */
static int hear(int (*call)(const conduit_node *), const conduit_node *params) {
  fflush(NULL);
  const int file = open("said", O_RDWR | O_CREAT | O_TRUNC, 0600), out = open("out", O_RDWR | O_CREAT | O_TRUNC, 0600);
  const int error = dup(2), output = dup(1);
  dup2(file, 2);
  dup2(out, 1);
  const int code = call(params);
  fflush(NULL);
  dup2(error, 2);
  dup2(output, 1);
  const ssize_t size = pread(file, said, sizeof said - 1, 0);
  said[size > 0 ? size : 0] = '\0';
  assert_int_equal(lseek(out, 0, SEEK_END), 0);
  const int files[] = {file, out, error, output};
  for (int i = 0; i < 4; i++)
    close(files[i]);
  for (char *line = said; *line;) { /* each is the library's own; notes are not looked at */
    char *end = strchr(line, '\n');
    assert_true(end && !strncmp(line, "tetcast: ", 9));
    if (!strncmp(line, "tetcast: note: ", 15))
      memmove(line, end + 1, strlen(end + 1) + 1);
    else
      line = end + 1;
  }
  return code;
}

conduit_node *simulation_params(const char *scene, const char *output) {
  conduit_node *params = conduit_node_create();
  if (scene)
    conduit_node_set_path_char8_str(params, "catalyst/tetcast/scene", scene);
  if (output)
    conduit_node_set_path_char8_str(params, "catalyst/tetcast/output", output);
  return params;
}

int simulation_begin_with(conduit_node *params) {
  const int code = hear(catalyst_initialize, params);
  conduit_node_destroy(params);
  return code;
}

int simulation_begin(const char *scene, const char *output) {
  return simulation_begin_with(simulation_params(scene, output));
}

conduit_node *simulation_step(int64_t number) {
  conduit_node *step = conduit_node_create();
  conduit_node_set_path_int64(step, "catalyst/state/timestep", number);
  conduit_node_set_path_float64(step, "catalyst/state/time", 0.5 * (double)number);
  return step;
}

conduit_node *simulation_mesh(conduit_node *step) {
  if (!conduit_node_has_path(step, "catalyst/channels/grid/type"))
    conduit_node_set_path_char8_str(step, "catalyst/channels/grid/type", "mesh");
  return conduit_node_fetch(step, "catalyst/channels/grid/data");
}

int simulation_run(conduit_node *step) {
  const int code = hear(catalyst_execute, step);
  conduit_node_destroy(step);
  body_forget();
  return code;
}

int simulation_end(void) {
  conduit_node *params = conduit_node_create();
  const int code = hear(catalyst_finalize, params);
  conduit_node_destroy(params);
  return code;
}

static void check_words(const char *words) {
  if (words ? !strstr(said, words) : *said != '\0')
    fail_msg("said: '%s', expected: '%s'", said, words ? words : "");
}

void simulation_draw(const char *scene, conduit_node *step, const char *words) {
  if (simulation_begin(scene, "picture.####.exr") != 0)
    fail_msg("initialize: %s", said);
  check_words(NULL);
  if (simulation_run(step) != 0)
    fail_msg("execute: %s", said);
  check_words(words);
  assert_int_equal(simulation_end(), 0);
  check_words(NULL);
}

void simulation_render(const char *input, const char *scene, const char *output) {
  char command[4096];
  FILE *f = fopen("scene.json", "w");
  fputs(scene, f);
  fclose(f);
  snprintf(command, sizeof command, "'%s' render %s --scene scene.json -o %s --quiet", getenv("TETCAST"), input,
           output);
  const int status = system(command);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    fail_msg("%s ends with %d", command, status);
}

void simulation_compare(const char *one, const char *other) {
  FILE *a = fopen(one, "rb"), *b = fopen(other, "rb");
  assert_non_null(a);
  assert_non_null(b);
  long size = 0;
  for (int x = 0, y = 0; x != EOF || y != EOF; size++) {
    x = getc(a);
    y = getc(b);
    if (x != y)
      fail_msg("%s and %s differ at byte %ld; said: %s", one, other, size, said);
  }
  fclose(a);
  fclose(b);
  assert_true(size > 500);
}

void simulation_agree(const Body *body, conduit_node *step, const char *scene, const char *words) {
  body_write(body, "body.vtu");
  simulation_render("body.vtu", scene, "file.exr");
  simulation_draw(scene, step, words);
  simulation_compare("picture.0000.exr", "file.exr");
}
