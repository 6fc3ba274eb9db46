/* SPDX-License-Identifier: Apache-2.0 */
#include "surfaces.h"

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

/* A name, #rrggbb, or three numbers r,g,b from 0 to 1. */
static bool parse_color(const char *text, double color[3]) {
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

bool surfaces_parse(const char *text, TetcastIsosurface *isosurface, bool *colored) {
  *isosurface = (TetcastIsosurface){.opacity = 1};
  *colored = false;
  bool fine = true, done = false;
  char *part = next_part(&text);
  fine = part && cli_parse_number(part, &isosurface->value) && isfinite(isosurface->value);
  free(part);
  while (fine && (part = next_part(&text))) {
    double opacity;
    if (cli_parse_number(part, &opacity)) { /* the last */
      fine = !done && opacity >= 0 && opacity <= 1;
      isosurface->opacity = opacity;
      done = true;
    } else {
      fine = !done && !*colored && parse_color(part, isosurface->color);
      *colored = true;
    }
    free(part);
  }
  return fine;
}

bool surfaces_parse_light(const char *text, TetcastLight *light) {
  *light = (TetcastLight){.color = {1, 1, 1}};
  char *direction = next_part(&text), *color = next_part(&text);
  const double *d = light->direction;
  const bool fine = direction && cli_parse_numbers(direction, ',', 3, light->direction) == 3 && isfinite(d[0]) &&
                    isfinite(d[1]) && isfinite(d[2]) && (d[0] != 0 || d[1] != 0 || d[2] != 0) &&
                    (!color || parse_color(color, light->color)) && !text;
  free(direction);
  free(color);
  return fine;
}

bool surfaces_alone(const RenderOptions *options) {
  return render_options_given(options, OPTION_ISOSURFACE) && !render_options_given(options, OPTION_TRANSFER);
}

/* The colour of the knots, linear between them, at a value. */
static void color_at(const TetcastTransferFunction *transfer_function, double value, double color[3]) {
  int64_t count, after = 0;
  const double *knots = tetcast_transfer_function_color(transfer_function, &count);
  while (after < count && knots[4 * after] <= value)
    after++;
  const double *a = knots + 4 * (after > 0 ? after - 1 : 0), *b = knots + 4 * (after < count ? after : count - 1);
  const double part = b[0] > a[0] ? (value - a[0]) / (b[0] - a[0]) : 0;
  for (int k = 0; k < 3; k++)
    color[k] = a[1 + k] + part * (b[1 + k] - a[1 + k]);
}

static TetcastStatus set_isosurfaces(TetcastScene *scene, const TextList *list,
                                     const TetcastTransferFunction *transfer_function, const double range[2]) {
  TetcastIsosurface *isosurfaces = cli_allocate(sizeof *isosurfaces * (size_t)(list->count + 1));
  for (int i = 0; i < list->count; i++) {
    bool colored;
    surfaces_parse(list->text[i], &isosurfaces[i], &colored);
    const double value = isosurfaces[i].value;
    if (!colored)
      color_at(transfer_function, value, isosurfaces[i].color);
    if (!(value >= range[0] && value <= range[1]))
      cli_warning("isosurface %g: nothing of it is seen, as the array's values lie between %g and %g", value, range[0],
                  range[1]);
  }
  const TetcastStatus status = tetcast_scene_set_isosurfaces(scene, isosurfaces, list->count);
  free(isosurfaces);
  return status;
}

TetcastStatus surfaces_set(TetcastScene *scene, const RenderOptions *options,
                           const TetcastTransferFunction *transfer_function, const double range[2]) {
  if (!render_options_given(options, OPTION_ISOSURFACE))
    return TETCAST_OK;
  const TetcastStatus status = set_isosurfaces(scene, &options->isosurfaces, transfer_function, range);
  if (status != TETCAST_OK)
    return status;
  TetcastLight lights[TETCAST_MAX_LIGHTS];
  TetcastShadingDesc desc = tetcast_shading_desc_default();
  if (render_options_given(options, OPTION_SHADE))
    desc.shade = (TetcastShade)options->shade;
  desc.normals = (TetcastNormals)options->normals;
  if (render_options_given(options, OPTION_MATERIAL)) {
    desc.ambient = options->material[0];
    desc.diffuse = options->material[1];
    desc.specular = options->material[2];
    desc.exponent = options->material[3];
  }
  for (int i = 0; i < options->lights.count; i++)
    surfaces_parse_light(options->lights.text[i], &lights[i]);
  desc.lights = lights;
  desc.light_count = options->lights.count;
  return tetcast_scene_set_shading(scene, &desc);
}
