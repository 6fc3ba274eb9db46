/* SPDX-License-Identifier: Apache-2.0 */
#include "scene_file.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli.h"
#include "clip.h"
#include "file.h"
#include "json.h"
#include "preset_name.h"

/* What paths in the scene are relative to, for free(). */
static char *folder_of(const RenderOptions *options) {
  return options->scene_folder ? cli_duplicate(options->scene_folder) : cli_path_folder(options->scene);
}

/* Several files are the steps of a series. NULL, or what is wrong. */
static const char *set_inputs(RenderOptions *options, const json_t *list) {
  const int count = (int)json_array_size(list);
  char *folder = folder_of(options), **paths = cli_allocate(sizeof *paths * (size_t)count);
  int named = 0;
  for (; named < count; named++) {
    const char *name = json_string_value(json_array_get(list, (size_t)named));
    if (!name || !*name)
      break;
    paths[named] = cli_path_join(folder, name);
  }
  const bool fine =
      count > 0 && named == count && render_options_set_inputs(options, count, (const char *const *)paths);
  for (int i = 0; i < named; i++)
    free(paths[i]);
  free(paths);
  free(folder);
  return fine ? NULL : "expected a path, or a list of paths that differ in one number";
}

/* Of an option that may be given several times. NULL, or what is wrong. */
static const char *set_texts(RenderOptions *options, OptionId id, const json_t *json) {
  const bool several = json_is_array(json);
  const size_t count = several ? json_array_size(json) : 1;
  const char *reason = NULL;
  for (size_t i = 0; !reason && i < count; i++) {
    const OptionValue value = {.text = json_string_value(several ? json_array_get(json, i) : json)};
    reason = value.text ? render_options_set(options, id, &value)
                        : "expected text, written as for the option, or a list of such texts";
  }
  return reason;
}

static bool set_value(RenderOptions *options, OptionId id, const char *key, const json_t *json) {
  OptionValue value = {.text = json_string_value(json)};
  char *path = NULL;
  const bool is_file = value.text && id == OPTION_PRESET && preset_name_is_file(value.text);
  if (value.text && *value.text && (is_file || render_option_is_path(id))) {
    char *folder = folder_of(options);
    value.text = path = cli_path_join(folder, value.text);
    free(folder);
  } else if (json_is_boolean(json) && render_option_is_flag(id)) {
    value.count = 1;
    value.numbers[0] = json_is_true(json);
  } else if (!value.text) {
    value.count = cli_json_numbers(json, 6, value.numbers);
  }

  const char *reason = NULL;
  if (render_option_is_flag(id) && !json_is_boolean(json)) {
    reason = "expected true or false";
  } else if (id == OPTION_TRANSFER && json_is_object(json)) {
    json_decref(options->transfer_object);
    options->transfer_object = json_deep_copy(json);
  } else if (render_option_is_list(id)) {
    reason = set_texts(options, id, json);
  } else if (id == OPTION_INPUT && json_is_array(json)) {
    reason = set_inputs(options, json);
  } else if (id == OPTION_CLIP) {
    reason = clip_add_all(options, json);
  } else {
    reason = render_options_set(options, id, &value);
  }
  if (reason)
    cli_error("%s: %s: %s", options->scene, key, reason);
  free(path);
  return !reason;
}

static void complain_of_key(const RenderOptions *options, bool in_camera, const char *key, const char *name) {
  CliGuess guess = {.word = key};
  if (!in_camera)
    cli_guess(&guess, "camera");
  for (int id = 0; id < OPTION_COUNT; id++) {
    const bool of_camera = id >= OPTION_EYE && id <= OPTION_ORTHO;
    const char *known = render_option_key((OptionId)id);
    if (known && of_camera == in_camera)
      cli_guess(&guess, known);
  }
  char *hint = cli_guess_text(&guess);
  cli_error("%s: unknown key '%s'%s", options->scene, name, hint);
  free(hint);
}

static bool set_key(RenderOptions *options, bool in_camera, const char *key, const json_t *json) {
  char *name = cli_print("%s%s", in_camera ? "camera." : "", key);
  const OptionId id = render_option_find(key);
  const bool of_camera = id >= OPTION_EYE && id <= OPTION_ORTHO;
  bool done = false;
  if (id == OPTION_COUNT || !render_option_key(id) || of_camera != in_camera) {
    complain_of_key(options, in_camera, key, name);
  } else if (options->source >> id & 1) {
    cli_error("%s: key '%s' appears twice", options->scene, name);
  } else {
    const char *other = render_options_claim(options, id);
    if (other)
      cli_error("%s: '%s' and '%s' exclude each other", options->scene, key, other);
    done = !other && set_value(options, id, name, json);
  }
  free(name);
  return done;
}

static bool set_camera(RenderOptions *options, json_t *camera) {
  if (!json_is_object(camera)) {
    cli_error("%s: camera: expected an object", options->scene);
    return false;
  }
  const char *key;
  json_t *value;
  json_object_foreach(camera, key, value) if (!set_key(options, true, key, value)) return false;
  return true;
}

bool scene_file_read(RenderOptions *options) {
  json_t *root = options->scene_object ? json_deep_copy(options->scene_object) : cli_json_read(options->scene);
  if (!root)
    return false;
  bool done = true;
  const char *key;
  json_t *value;
  json_object_foreach(root, key, value) {
    done = strcmp(key, "camera") ? set_key(options, false, key, value) : set_camera(options, value);
    if (!done)
      break;
  }
  json_decref(root);
  return done;
}

/* Whether the file begins as a JSON object does, without a word about files that can't be read. */
static bool begins_as_object(const char *path) {
  struct stat status;
  FILE *file = stat(path, &status) == 0 && S_ISREG(status.st_mode) ? fopen(path, "rb") : NULL;
  int c = file ? getc(file) : EOF;
  while (c != EOF && isspace(c))
    c = getc(file);
  if (file)
    fclose(file);
  return c == '{';
}

char *scene_file_mistaken(const char *path) {
  json_t *root = begins_as_object(path) ? json_load_file(path, 0, NULL) : NULL;
  char *result = NULL;
  if (json_object_get(root, "color") || json_object_get(root, "rows") || json_object_get(root, "gaussians"))
    result = cli_print("'%s' is a transfer function, not a mesh: render takes it by --transfer %s", path, path);
  else if (json_object_get(root, "input") || json_object_get(root, "camera") || json_object_get(root, "transfer"))
    result = cli_print("'%s' is a scene, not a mesh: render takes it by --scene %s", path, path);
  json_decref(root);
  return result;
}

static json_t *knots(const double *values, int64_t count, int width) {
  json_t *array = json_array();
  for (int64_t i = 0; i < count; i++)
    json_array_append_new(array, cli_json_array(values + i * width, width));
  return array;
}

json_t *scene_file_transfer(const TetcastTransferFunction *transfer_function) {
  int64_t count;
  json_t *object = json_object();
  const double *color = tetcast_transfer_function_color(transfer_function, &count);
  json_object_set_new(object, "color", knots(color, count, 4));
  const double *extinction = tetcast_transfer_function_extinction(transfer_function, &count);
  json_object_set_new(object, "extinction", knots(extinction, count, 2));
  return object;
}

static json_t *camera_object(const TetcastCamera *camera) {
  json_t *object = json_object();
  json_object_set_new(object, "eye", cli_json_array(camera->eye, 3));
  json_object_set_new(object, "target", cli_json_array(camera->target, 3));
  json_object_set_new(object, "up", cli_json_array(camera->up, 3));
  if (camera->projection == TETCAST_PERSPECTIVE)
    json_object_set_new(object, "fovy", json_real(camera->fovy));
  else
    json_object_set_new(object, "ortho", json_real(camera->height));
  return object;
}

static json_t *size_array(const double size[2]) {
  json_t *array = json_array();
  json_array_append_new(array, json_integer((json_int_t)size[0]));
  json_array_append_new(array, json_integer((json_int_t)size[1]));
  return array;
}

/* A path from the scene's folder; NULL: it is not UTF-8. */
static json_t *relative_path(const RenderOptions *options, const char *path) {
  char *folder = cli_path_folder(options->save_scene), *relative = cli_path_relative(folder, path);
  json_t *text = json_string(relative);
  free(relative);
  free(folder);
  return text;
}

/* The name of the preset, or FILE or FILE:NAME from the scene's folder; NULL: it is not UTF-8. */
static json_t *preset_value(const RenderOptions *options) {
  const char *preset = render_options_preset(options);
  if (!preset_name_is_file(preset))
    return json_string(preset);
  char *path = preset_name_path(preset), *folder = cli_path_folder(options->save_scene);
  char *relative = cli_path_relative(folder, path), *text = cli_print("%s%s", relative, preset + strlen(path));
  json_t *value = json_string(text);
  free(text);
  free(relative);
  free(folder);
  free(path);
  return value;
}

/* The path of the input, or of each of several, from the scene's folder; NULL: one is not UTF-8. */
static json_t *input_value(const RenderOptions *options) {
  char *folder = cli_path_folder(options->save_scene);
  json_t *value = options->inputs ? json_array() : NULL;
  for (int i = 0; i < options->input_count || i == 0; i++) {
    char *path = cli_path_relative(folder, options->inputs ? options->inputs[i] : options->input);
    json_t *text = json_string(path);
    free(path);
    if (!options->inputs) {
      value = text;
    } else if (json_array_append_new(value, text) != 0) {
      json_decref(value);
      value = NULL;
      break;
    }
  }
  free(folder);
  return value;
}

static json_t *text_array(const TextList *list) {
  json_t *array = json_array();
  for (int i = 0; i < list->count; i++)
    json_array_append_new(array, json_string(list->text[i]));
  return array;
}

static void write_surfaces(json_t *scene, const RenderOptions *options) {
  if (render_options_given(options, OPTION_OUTLINE) || render_options_decorated(options))
    json_object_set_new(scene, "outline", json_string(options->outline ? options->outline : ""));
  if (render_options_given(options, OPTION_LEGEND) || render_options_decorated(options))
    json_object_set_new(scene, "legend", json_string(options->legend ? options->legend : ""));
  if (options->isosurfaces.count > 0)
    json_object_set_new(scene, "isosurface", text_array(&options->isosurfaces));
  if (options->slices.count > 0)
    json_object_set_new(scene, "slice", text_array(&options->slices));
  if (options->surface)
    json_object_set_new(scene, "surface", json_string(options->surface));
  if (render_options_given(options, OPTION_EDGES))
    json_object_set_new(scene, "edges", json_string(options->edges));
  if (render_options_given(options, OPTION_SHADE))
    json_object_set_new(scene, "shade", json_string(render_option_choice(OPTION_SHADE, options->shade)));
  if (render_options_given(options, OPTION_NORMALS))
    json_object_set_new(scene, "normals", json_string(render_option_choice(OPTION_NORMALS, options->normals)));
  if (render_options_given(options, OPTION_MATERIAL))
    json_object_set_new(scene, "material", cli_json_array(options->material, 4));
  if (options->lights.count > 0) /* labels are in the transfer function */
    json_object_set_new(scene, "light", text_array(&options->lights));
  if (options->shadows)
    json_object_set_new(scene, "shadows", json_true());
  if (options->ambient_occlusion > 0)
    json_object_set_new(scene, "ambient_occlusion", json_integer((json_int_t)options->ambient_occlusion));
}

bool scene_file_write(const RenderOptions *options, const char *array, const TetcastCamera *camera,
                      const TetcastTransferFunction *transfer_function, const json_t *rows, const double range[2]) {
  json_t *scene = json_object();
  /* Names come from the file system and the data, and JSON takes UTF-8 only. */
  int failed = json_object_set_new(scene, "input", input_value(options));
  failed |= json_object_set_new(scene, "output", json_string(cli_path_name(options->output)));
  if (render_options_given(options, OPTION_EXTINCTION))
    failed |= json_object_set_new(scene, "extinction", json_string(options->extinction));
  if (render_options_given(options, OPTION_EMISSION))
    failed |= json_object_set_new(scene, "emission", json_string(options->emission));
  if (array)
    failed |= json_object_set_new(scene, "array", json_string(array));
  if (options->stop_depth)
    failed |= json_object_set_new(scene, "stop_depth", relative_path(options, options->stop_depth));
  if (options->block)
    failed |= json_object_set_new(scene, "block", json_string(options->block));
  if (options->time) /* "t=0.5", "all" */
    json_object_set_new(scene, "time", json_string(options->time));
  if (options->merge_tolerance >= 0)
    json_object_set_new(scene, "merge_tolerance", json_real(options->merge_tolerance));
  if (options->cell_to_point)
    json_object_set_new(scene, "cell_to_point", json_true());
  if (options->no_displacement)
    json_object_set_new(scene, "no_displacement", json_true());
  if (render_options_given(options, OPTION_STRETCH))
    json_object_set_new(scene, "stretch", cli_json_array(options->stretch, 3));
  if (options->subdivide > 0)
    json_object_set_new(scene, "subdivide", json_integer((json_int_t)options->subdivide));
  if (render_options_surfaces_alone(options) || !(rows || transfer_function || render_options_direct(options)))
    failed |= json_object_set_new(scene, "preset", preset_value(options));
  if (failed) {
    cli_error("cannot write '%s': the name of the input, the output, another file, the array or the block is not UTF-8",
              options->save_scene);
    json_decref(scene);
    return false;
  }
  if (render_options_surfaces_alone(options)) {
    json_object_set_new(scene, "range", range ? cli_json_array(range, 2) : json_string("step"));
  } else if (rows) {
    json_object_set_new(scene, "transfer", json_deep_copy(rows));
  } else if (transfer_function) {
    json_object_set_new(scene, "transfer", scene_file_transfer(transfer_function));
  } else if (!render_options_direct(options)) {
    json_object_set_new(scene, "range", json_string("step"));
  }
  if (render_options_given(options, OPTION_GROUPS))
    json_object_set_new(scene, "groups", json_boolean(options->groups));
  if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    json_object_set_new(scene, "blend", json_string(render_option_choice(OPTION_BLEND, options->blend)));
  write_surfaces(scene, options);
  clip_write(options, scene);
  json_object_set_new(scene, "camera", camera_object(camera));
  if (render_options_given(options, OPTION_ORBIT))
    json_object_set_new(scene, "orbit", json_string(options->orbit));
  if (render_options_given(options, OPTION_DOLLY))
    json_object_set_new(scene, "dolly", json_string(options->dolly));
  json_object_set_new(scene, "size", size_array(options->size));
  if (render_options_adaptive(options))
    json_object_set_new(scene, "adaptive", cli_json_array(options->adaptive, 3));
  else
    json_object_set_new(scene, "samples", json_integer((json_int_t)options->samples));
  json_object_set_new(scene, "background",
                      options->soft ? json_string("soft") : cli_json_array(options->background, 4));
  if (render_options_given(options, OPTION_EXPOSURE))
    json_object_set_new(scene, "exposure", json_real(options->exposure));
  if (options->integrator)
    json_object_set_new(scene, "integrator", json_string(options->integrator));
  if (options->tolerance > 0)
    json_object_set_new(scene, "tolerance", json_real(options->tolerance));
  if (render_options_given(options, OPTION_TILES))
    json_object_set_new(scene, "tiles", json_string(options->tiles));
  if (render_options_deep(options))
    json_object_set_new(scene, "deep", json_string(options->deep));
  if (options->channels)
    json_object_set_new(scene, "channels", json_string(options->channels));
  json_object_set_new(scene, "traversal", json_string(render_option_choice(OPTION_TRAVERSAL, options->traversal)));
  if (options->pixel_type)
    json_object_set_new(scene, "pixel_type", json_string(render_option_choice(OPTION_PIXEL_TYPE, options->pixel_type)));
  return cli_json_write(options->save_scene, scene);
}
