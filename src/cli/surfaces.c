/* SPDX-License-Identifier: Apache-2.0 */
#include "surfaces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "color.h"
#include "surface_text.h"

TetcastStatus surfaces_set_colors(TetcastContext *context, TetcastScene *scene,
                                  const TetcastTransferFunction *transfer_function) {
  static const double nothing[2] = {0, 0};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = tetcast_transfer_function_color(transfer_function, &desc.color_count);
  desc.extinction = nothing;
  desc.extinction_count = 1;
  TetcastTransferFunction *colors = NULL;
  TetcastStatus status = tetcast_transfer_function_create(context, &desc, &colors);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(scene, colors);
  tetcast_transfer_function_destroy(&colors);
  return status;
}

static TetcastStatus set_isosurfaces(TetcastScene *scene, const TextList *list,
                                     const TetcastTransferFunction *transfer_function, const double range[2]) {
  TetcastIsosurface *isosurfaces = cli_allocate(sizeof *isosurfaces * (size_t)(list->count + 1));
  int64_t count;
  const double *knots = tetcast_transfer_function_color(transfer_function, &count);
  for (int i = 0; i < list->count; i++) {
    bool colored;
    surfaces_parse(list->text[i], &isosurfaces[i], &colored);
    const double value = isosurfaces[i].value;
    if (!colored)
      colors_at(knots, count, value, isosurfaces[i].color);
    if (!(value >= range[0] && value <= range[1]))
      cli_warning("isosurface %g: nothing of it is seen, as the array's values lie between %g and %g", value, range[0],
                  range[1]);
  }
  const TetcastStatus status = tetcast_scene_set_isosurfaces(scene, isosurfaces, list->count);
  free(isosurfaces);
  return status;
}

bool surfaces_show_values(const RenderOptions *options) {
  if (!render_options_surfaces_alone(options) || options->slices.count > 0)
    return true;
  TetcastBoundary boundary;
  bool own = !options->surface || !surfaces_parse_boundary(options->surface, &boundary) || boundary.colored;
  for (int i = 0; own && i < options->isosurfaces.count; i++) {
    TetcastIsosurface isosurface;
    surfaces_parse(options->isosurfaces.text[i], &isosurface, &own);
  }
  return !own;
}

void surfaces_outline(const RenderOptions *options, double color[3]) {
  const double *back = options->background;
  const double brightness = 1 - back[3] + back[3] * (0.2126 * back[0] + 0.7152 * back[1] + 0.0722 * back[2]);
  if (!options->outline || !*options->outline || !surfaces_parse_color(options->outline, color))
    color[0] = color[1] = color[2] = brightness < 0.5 ? 0.75 : 0.4; /* what stands out */
  for (int k = 0; k < 3; k++)
    color[k] /= render_options_gain(options); /* it is not light */
}

static TetcastStatus set_light(TetcastScene *scene, const RenderOptions *options) {
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
  desc.shadows = options->shadows;
  desc.occlusion_rays = (int)options->ambient_occlusion;
  return tetcast_scene_set_shading(scene, &desc);
}

TetcastStatus surfaces_set(TetcastScene *scene, const RenderOptions *options,
                           const TetcastTransferFunction *transfer_function, const double range[2]) {
  if (!render_options_surfaces(options))
    return render_options_lit(options) ? set_light(scene, options) : TETCAST_OK;
  TetcastSlice slices[TETCAST_MAX_SLICES];
  TetcastBoundary boundary;
  for (int i = 0; i < options->slices.count; i++)
    surfaces_parse_slice(options->slices.text[i], &slices[i]);
  TetcastStatus status = set_isosurfaces(scene, &options->isosurfaces, transfer_function, range);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_slices(scene, slices, options->slices.count);
  if (status == TETCAST_OK && options->surface && surfaces_parse_boundary(options->surface, &boundary)) {
    boundary.edges = render_options_given(options, OPTION_EDGES);
    if (boundary.edges && *options->edges)
      surfaces_parse_color(options->edges, boundary.edge_color);
    status = tetcast_scene_set_boundary(scene, &boundary);
  }
  return status == TETCAST_OK ? set_light(scene, options) : status;
}
