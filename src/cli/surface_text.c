/* SPDX-License-Identifier: Apache-2.0 */
#include "surface_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "color.h"

/* The part of *text up to the next colon, for free(), and *text behind that; NULL at the end. */
static char *next_part(const char **text) {
  if (!*text)
    return NULL;
  const size_t length = strcspn(*text, ":");
  char *part = cli_print("%.*s", (int)length, *text);
  *text = (*text)[length] ? *text + length + 1 : NULL;
  return part;
}

bool surfaces_parse_color(const char *text, double color[3]) {
  double rgba[4];
  if (cli_parse_numbers(text, ',', 4, rgba) == 3) {
    for (int k = 0; k < 3; k++)
      if (!(rgba[k] >= 0 && rgba[k] <= 1))
        return false;
  } else if (!color_parse(text, rgba) || rgba[3] != 1) {
    return false;
  }
  memcpy(color, rgba, 3 * sizeof *color);
  return true;
}

/* [COLOUR][:OPACITY] or OPACITY, to the end of the text; NULL is neither. False: it is something else. */
static bool parse_look(const char *text, double color[3], int *colored, double *opacity) {
  char *part;
  bool fine = true, done = false;
  *colored = 0;
  *opacity = 1;
  while (fine && (part = next_part(&text))) {
    if (cli_parse_number(part, opacity)) { /* the last */
      fine = !done && *opacity >= 0 && *opacity <= 1;
      done = true;
    } else {
      fine = !done && !*colored && surfaces_parse_color(part, color);
      *colored = 1;
    }
    free(part);
  }
  return fine;
}

bool surfaces_parse(const char *text, TetcastIsosurface *isosurface, bool *colored) {
  *isosurface = (TetcastIsosurface){.opacity = 1};
  int has_color;
  char *value = next_part(&text);
  const bool fine = value && cli_parse_number(value, &isosurface->value) && isfinite(isosurface->value) &&
                    parse_look(text, isosurface->color, &has_color, &isosurface->opacity);
  *colored = fine && has_color;
  free(value);
  return fine;
}

bool surfaces_parse_slice(const char *text, TetcastSlice *slice) {
  double numbers[4], color[3];
  int colored;
  char *plane = next_part(&text);
  const bool fine = plane && cli_parse_numbers(plane, ',', 4, numbers) == 4 && isfinite(numbers[3]) &&
                    isfinite(numbers[0]) && isfinite(numbers[1]) && isfinite(numbers[2]) &&
                    (numbers[0] != 0 || numbers[1] != 0 || numbers[2] != 0) &&
                    parse_look(text, color, &colored, &slice->opacity) && !colored;
  free(plane);
  if (fine) {
    memcpy(slice->normal, numbers, sizeof slice->normal);
    slice->offset = numbers[3];
  }
  return fine;
}

bool surfaces_parse_boundary(const char *text, TetcastBoundary *boundary) {
  *boundary = (TetcastBoundary){.opacity = 1};
  return !*text || parse_look(text, boundary->color, &boundary->colored, &boundary->opacity);
}

bool surfaces_parse_light(const char *text, TetcastLight *light) {
  *light = (TetcastLight){.color = {1, 1, 1}};
  char *direction = next_part(&text), *color = next_part(&text);
  const double *d = light->direction;
  const bool fine = direction && cli_parse_numbers(direction, ',', 3, light->direction) == 3 && isfinite(d[0]) &&
                    isfinite(d[1]) && isfinite(d[2]) && (d[0] != 0 || d[1] != 0 || d[2] != 0) &&
                    (!color || surfaces_parse_color(color, light->color)) && !text;
  free(direction);
  free(color);
  return fine;
}
