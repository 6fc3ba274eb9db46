/* SPDX-License-Identifier: Apache-2.0 */
#include "transfer_file.h"

#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "curves.h"
#include "json.h"

/* The rows of `width` numbers under a key, for free(); NULL after a message. */
static double *load_knots(const char *place, const char *key, const json_t *rows, int width, const char *form,
                          int64_t *count) {
  if (!json_is_array(rows) || json_array_size(rows) == 0) {
    cli_error("%s: %s: expected a list of knots %s", place, key, form);
    return NULL;
  }
  *count = (int64_t)json_array_size(rows);
  double *knots = cli_allocate(sizeof(double) * (size_t)*count * (size_t)width);
  for (int64_t i = 0; i < *count; i++) {
    const json_t *row = json_array_get(rows, (size_t)i);
    if (!json_is_array(row) || cli_json_numbers(row, width, knots + i * width) != width) {
      cli_error("%s: %s[%lld]: expected %s", place, key, (long long)i, form);
      free(knots);
      return NULL;
    }
  }
  return knots;
}

static bool check_keys(const char *place, const json_t *root) {
  static const char *const known[] = {"color",  "extinction", "opacity",   "unit_distance", "at",
                                      "second", "rows",       "gaussians", "spline",        "log"};
  void *position = json_object_iter((json_t *)root);
  for (; position; position = json_object_iter_next((json_t *)root, position)) {
    const char *key = json_object_iter_key(position);
    size_t i = 0;
    while (i < sizeof known / sizeof *known && strcmp(key, known[i]))
      i++;
    if (i == sizeof known / sizeof *known) {
      CliGuess guess = {.word = key};
      for (i = 0; i < sizeof known / sizeof *known; i++)
        cli_guess(&guess, known[i]);
      char *hint = cli_guess_text(&guess);
      cli_error("%s: unknown key '%s'%s", place, key, hint);
      free(hint);
      return false;
    }
  }
  if (curves_gaussian(root)) /* which says itself what may be beside it */
    return true;
  const bool extinction = json_object_get(root, "extinction"), opacity = json_object_get(root, "opacity");
  if (!json_object_get(root, "color") || extinction == opacity) {
    cli_error("%s: expected \"color\" and either \"extinction\" or \"opacity\"", place);
    return false;
  }
  if (extinction && json_object_get(root, "unit_distance")) {
    cli_error("%s: unit_distance: belongs to \"opacity\", not to \"extinction\"", place);
    return false;
  }
  return true;
}

/* Colours above 1 are possible, but whoever has them most likely counts from 0 to 255. */
static void check_colors(const char *place, const double *color, int64_t count) {
  double largest = 0;
  for (int64_t i = 0; i < count; i++)
    for (int k = 1; k < 4; k++)
      largest = color[4 * i + k] > largest ? color[4 * i + k] : largest;
  if (largest > 1)
    cli_warning("%s: color: values up to %g, where 1 is the brightest that integer pixels hold%s", place, largest,
                largest <= 255 ? "; are they from 0 to 255? Divide them by 255" : "");
}

static TetcastTransferFunction *create(TetcastContext *context, const char *place, const json_t *root,
                                       const RenderOptions *options) {
  if (!check_keys(place, root))
    return NULL;
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.opacity_model = (TetcastOpacityModel)options->opacity_model;
  const json_t *unit_distance = json_object_get(root, "unit_distance");
  if (unit_distance && !json_is_number(unit_distance)) {
    cli_error("%s: unit_distance: expected a number", place);
    return NULL;
  }
  if (unit_distance)
    desc.unit_distance = json_number_value(unit_distance);
  if (curves_gaussian(root))
    return curves_of_gaussians(context, place, root, &desc);

  TetcastTransferFunction *result = NULL;
  const bool is_opacity = json_object_get(root, "opacity");
  const char *key = is_opacity ? "opacity" : "extinction";
  int64_t count;
  double *color =
      load_knots(place, "color", json_object_get(root, "color"), 4, "[value, red, green, blue]", &desc.color_count);
  double *second = color ? load_knots(place, key, json_object_get(root, key), 2,
                                      is_opacity ? "[value, opacity]" : "[value, extinction]", &count)
                         : NULL;
  if (second) {
    desc.color = color;
    if (is_opacity) {
      desc.opacity = second;
      desc.opacity_count = count;
    } else {
      desc.extinction = second;
      desc.extinction_count = count;
      if (render_options_given(options, OPTION_OPACITY_MODEL))
        cli_warning("%s states extinction: --opacity-model has no effect", place);
    }
    check_colors(place, color, desc.color_count);
    cli_set_place(place);
    const TetcastStatus status = tetcast_transfer_function_create(context, &desc, &result);
    if (status != TETCAST_OK)
      cli_failed(status);
    cli_set_place(NULL);
  }
  free(color);
  free(second);
  if (result && !curves_through(context, place, root, &result))
    tetcast_transfer_function_destroy(&result);
  return result;
}

/* Reads the rows; false after a message. */
static bool load_rows(TetcastContext *context, const char *place, const json_t *list, const RenderOptions *options,
                      TransferRows *rows) {
  for (size_t i = 0; i < json_array_size(list); i++) {
    const json_t *row = json_array_get(list, i), *at = json_object_get(row, "at");
    char *here = cli_print("%s: rows[%zu]", place, i);
    TetcastTransferFunction *function = NULL;
    if (!json_is_object(row) || !json_is_number(at))
      cli_error("%s: expected {\"at\": value, \"color\": …, \"extinction\": …}", here);
    else if (i > 0 && !(json_number_value(at) > rows->row[i - 1].at))
      cli_error("%s: at %g is not above the row before it, at %g", here, json_number_value(at), rows->row[i - 1].at);
    else
      function = create(context, here, row, options);
    free(here);
    if (!function)
      return false;
    rows->row[rows->count++] = (TetcastTransferRow){.at = json_number_value(at), .transfer_function = function};
  }
  return true;
}

/* A transfer function of either kind. */
static TetcastTransferFunction *load(TetcastContext *context, const char *place, const json_t *root,
                                     const RenderOptions *options, TransferRows *rows) {
  const json_t *list = json_object_get(root, "rows"), *second = json_object_get(root, "second");
  if (!list && !second && !json_object_get(root, "at"))
    return create(context, place, root, options);
  const size_t count = json_array_size(list);
  if (!json_is_string(second) || count < 1 || count > TETCAST_MAX_ROWS || json_object_size(root) != 2) {
    cli_error(
        "%s: expected {\"second\": \"gradient\" or the name of a cell array, \"rows\": [from 1 to %d rows]}, and no "
        "more",
        place, TETCAST_MAX_ROWS);
    return NULL;
  }
  if (!load_rows(context, place, list, options, rows)) {
    for (int i = 0; i < rows->count; i++)
      tetcast_transfer_function_destroy((TetcastTransferFunction **)(void *)&rows->row[i].transfer_function);
    rows->count = 0;
    return NULL;
  }
  if (strcmp(json_string_value(second), "gradient"))
    rows->second = cli_duplicate(json_string_value(second));
  rows->source = json_deep_copy(root);
  return (TetcastTransferFunction *)rows->row[0].transfer_function;
}

TetcastTransferFunction *transfer_file_load(TetcastContext *context, const RenderOptions *options, TransferRows *rows) {
  if (options->transfer_object) {
    char *place = cli_print("%s: transfer", options->scene);
    TetcastTransferFunction *result = load(context, place, options->transfer_object, options, rows);
    free(place);
    return result;
  }
  json_t *root = cli_json_read(options->transfer);
  TetcastTransferFunction *result = root ? load(context, options->transfer, root, options, rows) : NULL;
  json_decref(root);
  return result;
}

void transfer_file_release(TransferRows *rows) {
  for (int i = 1; i < rows->count; i++)
    tetcast_transfer_function_destroy((TetcastTransferFunction **)(void *)&rows->row[i].transfer_function);
  free(rows->second);
  json_decref(rows->source);
  *rows = (TransferRows){.count = 0};
}
