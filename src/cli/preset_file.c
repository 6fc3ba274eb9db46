/* SPDX-License-Identifier: Apache-2.0 */
#include "preset_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli.h"
#include "color_map.h"
#include "json.h"
#include "preset_name.h"
#include "preset_xml.h"

/* ── points ── */

typedef struct Form {
  const char *key, *point;
  const char *parts[4]; /* of a point; all but a first one that is "x" are from 0 to 1 */
  int width, least;     /* of a point; how many there are at least */
} Form;

static const Form color_points = {"RGBPoints", "x, red, green, blue", {"x", "red", "green", "blue"}, 4, 2};
static const Form opacity_points = {
    "Points", "x, opacity, midpoint, sharpness", {"x", "opacity", "midpoint", "sharpness"}, 4, 2};
static const Form indexed_colors = {"IndexedColors", "red, green, blue", {"red", "green", "blue"}, 3, 1};

/* Whether point i is in order, after a message if not. */
static bool check_point(const char *place, const Form *form, const double *points, int i) {
  const double *point = points + i * form->width;
  const bool placed = form->parts[0][0] == 'x';
  for (int k = placed; k < form->width; k++)
    if (!(point[k] >= 0 && point[k] <= 1)) {
      cli_error("%s: %s: point %d: %s is %g, expected a number from 0 to 1%s", place, form->key, i, form->parts[k],
                point[k], point[k] > 1 && point[k] <= 255 && form != &opacity_points ? "; is it from 0 to 255?" : "");
      return false;
    }
  if (placed && i > 0 && point[0] < point[-form->width]) {
    cli_error("%s: %s: not sorted: point %d at %g comes after %g", place, form->key, i, point[0], point[-form->width]);
    return false;
  }
  if (placed && i > 1 && point[0] == point[-2 * form->width]) {
    cli_error("%s: %s: more than two points at %g", place, form->key, point[0]);
    return false;
  }
  return true;
}

/* The points of a list of numbers, for free(); NULL after a message. */
static double *load_points(const char *place, const Form *form, const json_t *list, int *count) {
  const size_t size = json_array_size(list), width = (size_t)form->width;
  *count = (int)(size / width);
  if (size == 0 || size % width != 0 || size > 1 << 24) {
    cli_error("%s: %s: expected a list of numbers: %s of each point", place, form->key, form->point);
    return NULL;
  }
  if (*count < form->least) {
    cli_error("%s: %s: a single point, expected two or more", place, form->key);
    return NULL;
  }
  double *points = cli_allocate(sizeof *points * size);
  bool fine = true;
  for (size_t i = 0; fine && i < size; i++) {
    const json_t *number = json_array_get(list, i);
    points[i] = json_number_value(number);
    if (!json_is_number(number)) {
      cli_error("%s: %s: point %zu: %s: expected a number", place, form->key, i / width, form->parts[i % width]);
      fine = false;
    } else if (i % width == width - 1) {
      fine = check_point(place, form, points, (int)(i / width));
    }
  }
  if (fine && form->least > 1 && !(points[size - width] > points[0])) {
    cli_error("%s: %s: all points are at %g", place, form->key, points[0]);
    fine = false;
  }
  if (fine)
    return points;
  free(points);
  return NULL;
}

/* Moves points so that `from` comes to 0 and `to` to 1. */
static void normalize(double *points, int count, double from, double to) {
  const double width = to / 2 - from / 2; /* halves, which do not overflow */
  for (int i = 0; i < count; i++)
    points[4 * i] = points[4 * i] == to ? 1 : (points[4 * i] / 2 - from / 2) / width;
}

/* ── maps ── */

/* COLOR_SPACE_RGB and *steps where colours are constant between points; false after a message. */
static bool space_of(const char *place, const json_t *map, ColorSpace *space, bool *steps) {
  static const struct {
    const char *name;
    ColorSpace space;
  } spaces[] = {{"RGB", COLOR_SPACE_RGB},
                {"HSV", COLOR_SPACE_HSV},
                {"Lab", COLOR_SPACE_LAB},
                {"CIELAB", COLOR_SPACE_LAB},
                {"Step", COLOR_SPACE_RGB},
                {"Lab/CIEDE2000", COLOR_SPACE_LAB},
                {"Diverging", COLOR_SPACE_DIVERGING}};
  const json_t *value = json_object_get(map, "ColorSpace"), *wrap = json_object_get(map, "HSVWrap");
  const char *name = value ? json_string_value(value) : "RGB";
  *space = COLOR_SPACE_RGB;
  for (size_t i = 0; name && i < sizeof spaces / sizeof *spaces; i++) {
    if (strcasecmp(name, spaces[i].name))
      continue;
    *space = spaces[i].space;
    *steps = !strcmp(spaces[i].name, "Step");
    if (*space == COLOR_SPACE_HSV && (json_is_true(wrap) || json_number_value(wrap) != 0))
      *space = COLOR_SPACE_HSV_WRAP;
    if (strchr(spaces[i].name, '/'))
      cli_warning("%s: ColorSpace %s: taken as Lab", place, name);
    return true;
  }
  cli_error("%s: ColorSpace '%s': expected RGB, HSV, Lab, CIELAB, Diverging or Step", place, name ? name : "");
  return false;
}

static bool load_indexed(const char *place, const json_t *map, ColorMapKnots *colors) {
  int count;
  double *rgb = load_points(place, &indexed_colors, json_object_get(map, "IndexedColors"), &count);
  if (!rgb)
    return false;
  double *points = cli_allocate(sizeof *points * 4 * (size_t)(count + 1));
  for (int i = 0; i <= count; i++) { /* a step has the colour of its second point */
    points[4 * i] = i / (double)count;
    memcpy(points + 4 * i + 1, rgb + 3 * (i > 0 ? i - 1 : 0), 3 * sizeof *rgb);
  }
  *colors = color_map_steps(points, count + 1);
  free(points);
  free(rgb);
  return true;
}

/* The colours over [0, 1], and in range[2] what values of the file that is. False after a message. */
static bool load_colors(const char *place, const json_t *map, ColorMapKnots *colors, double range[2]) {
  ColorSpace space;
  bool steps = false;
  int count;
  if (!space_of(place, map, &space, &steps))
    return false;
  const json_t *list = json_object_get(map, "RGBPoints");
  range[0] = range[1] = NAN;
  if (!list && json_object_get(map, "IndexedColors"))
    return load_indexed(place, map, colors);
  if (!list) {
    cli_error("%s: is no colour map of ParaView's: expected \"RGBPoints\" or \"IndexedColors\"%s", place,
              json_object_get(map, "color") ? "; a transfer function is for --transfer" : "");
    return false;
  }
  double *points = load_points(place, &color_points, list, &count);
  if (!points)
    return false;
  range[0] = points[0];
  range[1] = points[4 * (count - 1)];
  normalize(points, count, range[0], range[1]);
  *colors = steps ? color_map_steps(points, count) : color_map_colors(space, points, count);
  free(points);
  return true;
}

/* The opacities over the same range, or over their own if that is NaN; a ramp where the map has none. */
static bool load_opacities(const char *place, const json_t *map, const double range[2], ColorMapKnots *opacities) {
  static const double ramp[2][4] = {{0, 0, 0.5, 0}, {1, 1, 0.5, 0}};
  const json_t *list = json_object_get(map, "Points");
  int count;
  if (!list || json_is_null(list)) {
    *opacities = color_map_opacities(ramp[0], 2);
    return true;
  }
  double *points = load_points(place, &opacity_points, list, &count);
  if (!points)
    return false;
  const bool own = isnan(range[0]);
  normalize(points, count, own ? points[0] : range[0], own ? points[4 * (count - 1)] : range[1]);
  *opacities = color_map_opacities(points, count);
  free(points);
  return true;
}

static TetcastTransferFunction *create(TetcastContext *context, const char *place, const json_t *map) {
  ColorMapKnots colors = {.count = 0}, opacities = {.count = 0};
  double range[2];
  TetcastTransferFunction *shape = NULL;
  if (load_colors(place, map, &colors, range) && load_opacities(place, map, range, &opacities)) {
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    desc.color = colors.data;
    desc.color_count = colors.count;
    desc.extinction = opacities.data; /* in proportion */
    desc.extinction_count = opacities.count;
    cli_set_place(place);
    const TetcastStatus status =
        colors.data && opacities.data ? tetcast_transfer_function_create(context, &desc, &shape) : TETCAST_ERROR_MEMORY;
    if (status != TETCAST_OK)
      cli_failed(status);
    cli_set_place(NULL);
  }
  color_map_release(&colors);
  color_map_release(&opacities);
  return shape;
}

/* ── files ── */

static const char *name_of(const json_t *maps, size_t i) {
  const char *name = json_string_value(json_object_get(json_array_get(maps, i), "Name"));
  return name ? name : "";
}

/* The names of the maps but for number `without`, the first eight of them; for free(). */
static char *list_names(const json_t *maps, size_t without) {
  char *text = cli_duplicate("");
  int count = 0;
  for (size_t i = 0; i < json_array_size(maps) && count <= 8; i++) {
    if (i == without || !*name_of(maps, i))
      continue;
    char *longer = cli_print("%s%s%s", text, count ? ", " : "", count == 8 ? "…" : name_of(maps, i));
    free(text);
    text = longer;
    count++;
  }
  return text;
}

/* The number of the map that is asked for, -1 after a message. `name` NULL: the first. */
static int choose(const char *path, const char *name, const json_t *maps) {
  const size_t count = json_array_size(maps);
  CliGuess guess = {.word = name};
  for (size_t i = 0; name && i < count; i++) {
    if (!strcmp(name_of(maps, i), name))
      return (int)i;
    if (*name_of(maps, i))
      cli_guess(&guess, name_of(maps, i));
  }
  if (!name && count == 1)
    return 0;
  char *names = list_names(maps, name ? count : 0);
  if (name) {
    char *hint = cli_guess_text(&guess);
    cli_error("%s: there is no colour map '%s' in it, there are %s%s", path, name, names, hint);
    free(hint);
  } else {
    cli_note("%s has %zu colour maps and the first is taken, '%s'; %s:NAME chooses another: %s", path, count,
             name_of(maps, 0), path, names);
  }
  free(names);
  return name ? -1 : 0;
}

/* The maps of a file as those of ParaView's JSON; NULL after a message. */
static json_t *load_maps(TetcastContext *context, const char *path) {
  const size_t length = strlen(path);
  if (!strcasecmp(path + length - 4, ".xml"))
    return preset_xml_read(context, path);
  json_t *root = cli_json_read_any(path);
  if (!json_is_object(root)) {
    bool fine = !root || json_array_size(root) > 0;
    for (size_t i = 0; i < json_array_size(root); i++)
      fine = fine && json_is_object(json_array_get(root, i));
    if (!fine) {
      cli_error("%s: expected ParaView's colour maps: a list of objects with \"Name\" and \"RGBPoints\"", path);
      json_decref(root);
      return NULL;
    }
    return root;
  }
  json_t *maps = json_array();
  json_array_append_new(maps, root);
  return maps;
}

TetcastTransferFunction *preset_file_load(TetcastContext *context, const char *preset) {
  char *path = preset_name_path(preset);
  const char *name = preset[strlen(path)] ? preset + strlen(path) + 1 : NULL;
  json_t *maps = load_maps(context, path);
  const int chosen = maps ? choose(path, name, maps) : -1;
  TetcastTransferFunction *shape = NULL;
  if (chosen >= 0) {
    const char *own = name_of(maps, (size_t)chosen);
    char *place = *own ? cli_print("%s: '%s'", path, own) : cli_print("%s: map %d", path, chosen);
    shape = create(context, place, json_array_get(maps, (size_t)chosen));
    free(place);
  }
  json_decref(maps);
  free(path);
  return shape;
}
