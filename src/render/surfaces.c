/* SPDX-License-Identifier: Apache-2.0 */
/* A scene's isosurfaces and light, and what kernels need of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/render.h"

static int by_value(const void *a, const void *b) {
  const double x = ((const TetcastIsosurface *)a)->value, y = ((const TetcastIsosurface *)b)->value;
  return x < y ? -1 : x > y;
}

TetcastStatus tc_scene_set_isosurfaces(TetcastScene *scene, const TetcastIsosurface *isosurfaces, int count) {
  TetcastIsosurface *copy = NULL;
  if (count > 0 && !tc_allocate_array(scene->context, (void **)&copy, count, sizeof *copy, "isosurfaces"))
    return TETCAST_ERROR_MEMORY;
  if (count > 0) {
    memcpy(copy, isosurfaces, (size_t)count * sizeof *copy);
    qsort(copy, (size_t)count, sizeof *copy, by_value);
  }
  for (int i = 1; i < count; ++i) {
    if (copy[i].value == copy[i - 1].value) {
      const double value = copy[i].value;
      tc_release(scene->context, copy);
      return tc_error(scene->context, TETCAST_ERROR_ARGUMENT, "two isosurfaces of the value %.17g", value);
    }
  }
  tc_release(scene->context, scene->isosurfaces);
  scene->isosurfaces = copy;
  scene->isosurface_count = count;
  tc_scene_forget(scene); /* what is visible depends on them */
  return TETCAST_OK;
}

TcLighting tc_lighting_of(const TetcastShadingDesc *desc) {
  TcLighting lighting = {.surfaces = (desc->shade & TETCAST_SHADE_SURFACES) != 0,
                         .volume = (desc->shade & TETCAST_SHADE_VOLUME) != 0,
                         .shadows = desc->shadows && desc->light_count > 0,
                         .occlusion_rays = desc->occlusion_rays,
                         .smooth = desc->normals == TETCAST_NORMALS_SMOOTH,
                         .ambient = fmin(desc->ambient, TC_LARGEST_LIGHT),
                         .diffuse = fmin(desc->diffuse, TC_LARGEST_LIGHT),
                         .specular = fmin(desc->specular, TC_LARGEST_LIGHT),
                         .exponent = desc->exponent,
                         .light_count = desc->light_count};
  for (int i = 0; i < desc->light_count; ++i) {
    lighting.light[i] = desc->lights[i];
    tc_normalize(lighting.light[i].direction);
    for (int k = 0; k < 3; ++k)
      lighting.light[i].color[k] = fmin(lighting.light[i].color[k], TC_LARGEST_LIGHT);
  }
  return lighting;
}

TetcastStatus tc_scene_scale_isosurfaces(const TetcastScene *scene, TetcastIsosurface **scaled) {
  const int count = scene->isosurface_count;
  if (count == 0)
    return TETCAST_OK;
  if (!tc_allocate_array(scene->context, (void **)scaled, count, sizeof **scaled, "isosurfaces"))
    return TETCAST_ERROR_MEMORY;
  for (int i = 0; i < count; ++i) {
    TetcastIsosurface *surface = &(*scaled)[i];
    *surface = scene->isosurfaces[i];
    surface->value = ldexp(surface->value, -scene->values->exponent);
    for (int k = 0; k < 3; ++k)
      surface->color[k] = fmin(surface->color[k], TC_LARGEST_COLOR);
  }
  return TETCAST_OK;
}

bool tc_scene_has_surfaces(const TetcastScene *scene) {
  return scene->isosurface_count > 0 || scene->slice_count > 0 || scene->boundary.opacity > 0;
}

/* What no component of a surface's colour exceeds, with light on it or without. */
static void take_largest(const TcLighting *lighting, const double color[3], TcSurfaces *surfaces) {
  for (int k = 0; k < 3; ++k) {
    const double seen = lighting ? tc_light_largest(lighting, color[k]) : color[k];
    surfaces->largest[k] = fmax(surfaces->largest[k], seen);
  }
}

TetcastStatus tc_scene_surfaces(const TetcastScene *scene, TetcastIsa isa, bool normals, TcSurfaces *surfaces) {
  const TcLighting *lighting = &scene->lighting;
  const TcPrepared *prepared = scene->prepared;
  *surfaces = (TcSurfaces){.count = scene->isosurface_count,
                           .surface = prepared->isosurfaces,
                           .lighting = lighting->surfaces ? lighting : NULL,
                           .slice_count = scene->slice_count,
                           .boundary = scene->boundary,
                           .normal = normals};
  for (int i = 0; i < surfaces->count; ++i)
    take_largest(surfaces->lighting, prepared->isosurfaces[i].color, surfaces);
  for (int i = 0; i < surfaces->slice_count; ++i) {
    const TetcastSlice *slice = &scene->slices[i];
    const TetcastHalfSpace plane = {.normal = {slice->normal[0], slice->normal[1], slice->normal[2]},
                                    .offset = slice->offset};
    surfaces->slice[i] = tc_half_space_scale(scene->volume, &plane);
    surfaces->slice_opacity[i] = slice->opacity;
  }
  for (int k = 0; k < 3; ++k)
    surfaces->boundary.color[k] = fmin(surfaces->boundary.color[k], TC_LARGEST_COLOR);
  take_largest(surfaces->lighting, surfaces->boundary.color, surfaces);
  for (int k = 0; surfaces->boundary.edges && k < 3; ++k) {
    surfaces->boundary.edge_color[k] = fmin(surfaces->boundary.edge_color[k], TC_LARGEST_COLOR);
    surfaces->largest[k] = fmax(surfaces->largest[k], surfaces->boundary.edge_color[k]);
  }
  for (int64_t i = 0; scene->transfer && i < scene->transfer->color_count; ++i) { /* of slices and of the boundary */
    double color[3];
    for (int k = 0; k < 3; ++k)
      color[k] = fmin(scene->transfer->color[4 * i + 1 + k], TC_LARGEST_COLOR);
    take_largest(surfaces->lighting, color, surfaces);
  }
  if (!surfaces->lighting && !normals)
    return TETCAST_OK;
  TetcastStatus status =
      surfaces->lighting ? tc_scene_open(scene, isa, &surfaces->open, &surfaces->open_width) : TETCAST_OK;
  if (status || surfaces->count == 0 || !lighting->smooth || scene->values->association != TETCAST_POINT)
    return status;
  return tc_scene_gradients(scene, &surfaces->smooth);
}
