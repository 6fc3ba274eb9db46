/* SPDX-License-Identifier: Apache-2.0 */
#include "preset_xml.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "adapter.h"
#include "cli.h"

typedef struct Reading {
  const char *path;
  json_t *maps, *map; /* the last of them; NULL: none yet */
  int points;         /* of it */
  bool indexed;       /* it has colours alone, without values */
  bool failed;        /* after a message */
} Reading;

static const char *attribute(const char *const *attributes, const char *name) {
  for (; *attributes; attributes += 2)
    if (!strcmp(attributes[0], name))
      return attributes[1];
  return NULL;
}

static void begin_map(Reading *reading, const char *const *attributes) {
  const char *name = attribute(attributes, "name"), *space = attribute(attributes, "space");
  const char *indexed = attribute(attributes, "indexedLookup");
  const bool wrapped = space && !strcasecmp(space, "Wrapped");
  reading->indexed = indexed && (!strcmp(indexed, "true") || !strcmp(indexed, "1"));
  reading->points = 0;
  reading->map = json_object();
  json_array_append_new(reading->maps, reading->map);
  json_object_set_new(reading->map, "Name", json_string(name ? name : ""));
  json_object_set_new(reading->map, "ColorSpace", json_string(wrapped ? "HSV" : space ? space : "RGB"));
  json_object_set_new(reading->map, "HSVWrap", json_boolean(wrapped));
  json_object_set_new(reading->map, reading->indexed ? "IndexedColors" : "RGBPoints", json_array());
}

/* Appends the number that an attribute is; a message if it is none. */
static void append(Reading *reading, json_t *list, const char *const *attributes, const char *name) {
  const char *text = attribute(attributes, name);
  double number = 0;
  if (!text || !cli_parse_number(text, &number)) {
    const char *map = json_string_value(json_object_get(reading->map, "Name"));
    cli_error("%s: '%s': point %d: %s=\"%s\": expected a number", reading->path, map, reading->points, name,
              text ? text : "");
    reading->failed = true;
  }
  json_array_append_new(list, json_real(number));
}

static void add_point(Reading *reading, const char *const *attributes) {
  static const char *const names[] = {"x", "r", "g", "b"};
  json_t *colors = json_object_get(reading->map, reading->indexed ? "IndexedColors" : "RGBPoints");
  for (int k = reading->indexed; k < 4; k++)
    append(reading, colors, attributes, names[k]);
  if (!reading->indexed && attribute(attributes, "o")) {
    json_t *opacities = json_object_get(reading->map, "Points");
    if (!opacities)
      json_object_set_new(reading->map, "Points", opacities = json_array());
    append(reading, opacities, attributes, "x");
    append(reading, opacities, attributes, "o");
    json_array_append_new(opacities, json_real(0.5)); /* the midpoint */
    json_array_append_new(opacities, json_real(0));   /* the sharpness */
  }
  reading->points++;
}

static void take_element(void *user, int depth, const char *name, const char *const *attributes) {
  Reading *reading = user;
  const bool is_map = !strcmp(name, "ColorMap");
  if (reading->failed)
    return;
  if (depth == 0 && !is_map && strcmp(name, "ColorMaps")) {
    cli_error("%s: expected ParaView's colour maps, <ColorMaps> or <ColorMap>, not <%s>", reading->path, name);
    reading->failed = true;
  } else if (is_map) {
    begin_map(reading, attributes);
  } else if (reading->map && !strcmp(name, "Point")) {
    add_point(reading, attributes);
  }
}

/* ParaView's own maps have o=1 at all points, which says nothing: opacities count where they differ. */
static void drop_uniform(json_t *map) {
  const json_t *opacities = json_object_get(map, "Points");
  const double first = json_number_value(json_array_get(opacities, 1));
  bool differ = false;
  for (size_t i = 1; i < json_array_size(opacities); i += 4)
    differ = differ || json_number_value(json_array_get(opacities, i)) != first;
  if (opacities && !differ)
    json_object_del(map, "Points");
}

json_t *preset_xml_read(TetcastContext *context, const char *path) {
  if (!cli_vtk())
    return NULL;
  Reading reading = {.path = path, .maps = json_array()};
  const TetcastStatus status = cli_vtk()->xml_read(context, path, take_element, &reading);
  if (status != TETCAST_OK && !reading.failed)
    cli_failed(status);
  if (status == TETCAST_OK && !reading.failed && json_array_size(reading.maps) == 0) {
    cli_error("%s: has no <ColorMap>", path);
    reading.failed = true;
  }
  if (status != TETCAST_OK || reading.failed) {
    json_decref(reading.maps);
    return NULL;
  }
  for (size_t i = 0; i < json_array_size(reading.maps); i++)
    drop_uniform(json_array_get(reading.maps, i));
  return reading.maps;
}
