/* SPDX-License-Identifier: Apache-2.0 */
#include "settings.h"

#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "cli/cli.h"
#include "cli/file.h"
#include "cli/json.h"
#include "cli/render_parse.h"
#include "cli/scene_file.h"
#include "cli/series.h"

static const char root[] = "catalyst/tetcast", scene_name[] = "catalyst/tetcast/scene";

/* ── nodes as JSON ── */

static json_t *json_of_leaf(const ConduitNode *node) {
  View view;
  const char *text = conduit_text(node);
  if (text)
    return json_string(text);
  if (!conduit_view(node, &view) || view.count == 0)
    return NULL;
  if (view.count == 1)
    return json_real(view_value(&view, 0));
  json_t *array = json_array();
  for (int64_t i = 0; i < view.count && i < 4096; i++)
    json_array_append_new(array, json_real(view_value(&view, i)));
  return array;
}

/* NULL: a leaf that is neither text in UTF-8 nor finite numbers. */
static json_t *json_of(const ConduitNode *node, int depth) {
  const int64_t count = conduit_children(node);
  if (count == 0 || depth > 16)
    return json_of_leaf(node);
  const bool list = conduit_is_list(node);
  json_t *json = list ? json_array() : json_object();
  for (int64_t i = 0; i < count && json; i++) {
    char *name = conduit_name(conduit_child(node, i));
    json_t *value = json_of(conduit_child(node, i), depth + 1);
    if (!value || (list ? json_array_append_new(json, value) : json_object_set_new(json, name, value)) != 0) {
      json_decref(json);
      json = NULL;
    }
    free(name);
  }
  return json;
}

/* Sets a key as a scene file has it: Conduit has no true and false, so that flags are numbers there. */
static bool set_key(json_t *object, const char *key, const ConduitNode *node, const char *path) {
  const OptionId id = render_option_find(key);
  json_t *value = json_of(node, 0);
  if (!value) {
    cli_error("%s/%s: expected text in UTF-8, or finite numbers", path, key);
    return false;
  }
  if (id < OPTION_COUNT && render_option_is_flag(id) && json_is_number(value)) {
    const bool flag = json_number_value(value) != 0;
    json_decref(value);
    value = json_boolean(flag);
  }
  return json_object_set_new(object, key, value) == 0;
}

/* ── the scene and what is said beside it ── */

/* Whether there is anything that only files or commands have. */
static bool check_keys(const RenderOptions *options) {
  static const OptionId refused[] = {OPTION_ORBIT,  OPTION_DOLLY,  OPTION_TILES,     OPTION_STATS,
                                     OPTION_RESUME, OPTION_REPEAT, OPTION_SAVE_SCENE};
  static const OptionId idle[] = {OPTION_BLOCK, OPTION_MERGE_TOLERANCE, OPTION_NO_DISPLACEMENT, OPTION_SUBDIVIDE};
  for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
    if (render_options_given(options, refused[i])) {
      cli_error("%s: %s: not possible in a simulation, where each step is one picture", root,
                render_option_key(refused[i]));
      return false;
    }
  for (size_t i = 0; i < sizeof idle / sizeof *idle; i++)
    if (render_options_given(options, idle[i]))
      cli_warning("%s: %s: is about files and has no effect", root, render_option_key(idle[i]));
  if (render_options_range(options) == RANGE_SERIES) {
    cli_error("%s: range: series: not possible in a simulation, whose later values are not known", root);
    return false;
  }
  return true;
}

/* Takes and releases an object (NULL: there was a message) as a source of options of its own. `name` is what messages
 * call it, and its paths are relative to `folder`, NULL: to the file of this name. */
static bool take_object(RenderOptions *options, json_t *object, const char *name, const char *folder) {
  json_object_del(object, "input"); /* the simulation's data, at the time that it is */
  json_object_del(object, "time");
  free(options->scene);
  options->scene = cli_duplicate(name);
  options->scene_object = object;
  options->scene_folder = folder;
  options->source = 0;
  const bool fine = object && scene_file_read(options);
  options->scene_object = NULL;
  options->scene_folder = NULL;
  json_decref(object);
  return fine;
}

/* The path of a scene file, the text of one, or a node of its keys. */
static bool take_scene(RenderOptions *options, const ConduitNode *node) {
  const char *text = conduit_text(node);
  json_error_t error;
  if (text && text[strspn(text, " \t\r\n")] == '{') {
    json_t *object = json_loads(text, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &error);
    if (!object)
      cli_error("%s:%d: %s", scene_name, error.line, error.text);
    return take_object(options, object, scene_name, ".");
  }
  if (text)
    return take_object(options, cli_json_read(text), text, NULL);
  if (conduit_children(node) == 0 || conduit_is_list(node)) {
    cli_error("%s: expected the path of a scene file, the text of one, or a node of its keys", scene_name);
    return false;
  }
  json_t *object = json_object();
  bool fine = true;
  for (int64_t i = 0; i < conduit_children(node) && fine; i++) {
    char *key = conduit_name(conduit_child(node, i));
    fine = set_key(object, key, conduit_child(node, i), scene_name);
    free(key);
  }
  if (fine)
    return take_object(options, object, scene_name, ".");
  json_decref(object);
  return false;
}

static bool take_text(const ConduitNode *node, const char *key, char **text) {
  const char *value = conduit_text(node);
  if (!value || !*value) {
    cli_error("%s/%s: expected a name", root, key);
    return false;
  }
  *text = cli_duplicate(value);
  return true;
}

static bool take_every(const ConduitNode *node, int64_t *every) {
  if (conduit_integer(node, every) && *every > 0)
    return true;
  cli_error("%s/every: expected a whole number from 1", root);
  return false;
}

/* What stands beside the scene, which counts in place of what the scene says. */
static bool take_beside(Settings *settings, const ConduitNode *node) {
  json_t *object = json_object();
  bool fine = true;
  for (int64_t i = 0; i < conduit_children(node) && fine; i++) {
    const ConduitNode *child = conduit_child(node, i);
    char *key = conduit_name(child);
    if (!strcmp(key, "channel"))
      fine = take_text(child, key, &settings->channel);
    else if (!strcmp(key, "topology"))
      fine = take_text(child, key, &settings->topology);
    else if (!strcmp(key, "every"))
      fine = take_every(child, &settings->every);
    else if (strcmp(key, "scene"))
      fine = set_key(object, key, child, root);
    free(key);
  }
  if (fine && json_object_size(object) > 0)
    return take_object(&settings->options, object, root, ".");
  json_decref(object);
  return fine;
}

/* The name of a picture has a place for the number of its step. */
static void complete_output(RenderOptions *options) {
  if (options->output && series_wanted(options))
    return;
  const char *output = options->output ? options->output : "tetcast.png", *dot = strrchr(cli_path_name(output), '.');
  const int stem = (int)(dot ? (size_t)(dot - output) : strlen(output));
  char *numbered = cli_print("%.*s.####%s", stem, output, output + stem);
  free(options->output);
  options->output = numbered;
  options->given |= BIT(OPTION_OUTPUT);
}

bool settings_read(Settings *settings, const ConduitNode *params) {
  *settings = (Settings){.options = render_options_default(COMMAND_RENDER), .every = 1};
  RenderOptions *options = &settings->options;
  const ConduitNode *node = conduit_at(params, root), *scene = conduit_at(params, scene_name);
  if ((scene && !take_scene(options, scene)) || (node && !take_beside(settings, node)))
    return false;
  options->input = cli_duplicate("catalyst");
  if (!check_keys(options))
    return false;
  complete_output(options);
  char *fault = render_options_fault(options);
  if (fault)
    cli_error("%s: %s", options->scene ? options->scene : root, fault);
  free(fault);
  return !fault;
}

void settings_release(Settings *settings) {
  free(settings->channel);
  free(settings->topology);
  settings->channel = settings->topology = NULL;
}
