/* SPDX-License-Identifier: Apache-2.0 */
#include "deep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "progress.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void normalize(double a[3]) {
  const double length = sqrt(dot(a, a));
  for (int k = 0; k < 3; k++)
    a[k] /= length;
}

/* The camera's axes (camera.h): of a pixel at (u, v) from the picture's middle, from −1 to 1, u right + v up is what
 * is added to the direction of view, or to the eye. */
typedef struct Axes {
  double forward[3], right[3], up[3];
} Axes;

static Axes axes_of(const TetcastCamera *camera, double aspect) {
  Axes axes;
  const double half =
      camera->projection == TETCAST_PERSPECTIVE ? tan(camera->fovy * acos(-1) / 360) : camera->height / 2;
  for (int k = 0; k < 3; k++)
    axes.forward[k] = camera->target[k] - camera->eye[k];
  normalize(axes.forward);
  cross(axes.forward, camera->up, axes.right);
  normalize(axes.right);
  cross(axes.right, axes.forward, axes.up);
  for (int k = 0; k < 3; k++) {
    axes.right[k] *= half * aspect;
    axes.up[k] *= half;
  }
  return axes;
}

/* The distances between which the ray of a pixel is in a box. Where it passes by they are the same. */
static void find_part(const TetcastCamera *camera, const Axes *axes, double u, double v, const double bounds[6],
                      double *begin, double *end) {
  double eye[3], direction[3];
  for (int k = 0; k < 3; k++) {
    const double shift = u * axes->right[k] + v * axes->up[k];
    eye[k] = camera->eye[k] + (camera->projection == TETCAST_PERSPECTIVE ? 0 : shift);
    direction[k] = axes->forward[k] + (camera->projection == TETCAST_PERSPECTIVE ? shift : 0);
  }
  normalize(direction);
  *begin = 0;
  *end = INFINITY;
  for (int k = 0; k < 3; k++) {
    if (direction[k] == 0)
      continue;
    const double a = (bounds[2 * k] - eye[k]) / direction[k], b = (bounds[2 * k + 1] - eye[k]) / direction[k];
    *begin = fmax(*begin, fmin(a, b));
    *end = fmin(*end, fmax(a, b));
  }
  *end = isfinite(*end) ? fmax(*begin, *end) : *begin;
}

static void find_parts(Deep *deep, const Stage *stage, const TetcastArray *stop) {
  const int64_t width = deep->image.width, height = deep->image.height;
  const Axes axes = axes_of(&stage->camera, (double)width / (double)height);
  const double *stops = stop ? stop->data : NULL;
  for (int64_t i = 0; i < width * height; i++) {
    const double u = (2 * (double)(i % width) + 1) / (double)width - 1,
                 v = 1 - (2 * (double)(i / width) + 1) / (double)height;
    find_part(&stage->camera, &axes, u, v, stage->info.bounds, &deep->begin[i], &deep->end[i]);
    if (stops)
      deep->end[i] = fmax(deep->begin[i], fmin(deep->end[i], stops[i]));
  }
}

/* Progress through one layer of several. */
typedef struct Part {
  TetcastProgress all;
  int layer, count;
} Part;

static bool show(void *user, double fraction) {
  const Part *part = user;
  return part->all.function(part->all.user, (part->layer + fraction) / part->count);
}

static TetcastStatus render_layer(const Deep *deep, const Stage *stage, const TetcastRenderDesc *desc, int layer) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = deep->image.width;
  frame_desc.height = deep->image.height;
  frame_desc.type = TETCAST_TYPE_FLOAT32;
  frame_desc.pixels = deep->layers[layer];
  TetcastFrame *frame = NULL;
  TetcastStatus status = tetcast_frame_create(stage->context, &frame_desc, &frame);
  if (status == TETCAST_OK)
    status = tetcast_scene_render(stage->scene, &stage->camera, desc, frame, NULL);
  tetcast_frame_destroy(&frame);
  return status;
}

/* Renders all layers. `seen` [height][width] is what is left to be seen; a ray of which nothing is doesn't start. The
 * first part begins at the eye and the last one ends nowhere, so that no rounding of the box loses anything. */
static TetcastStatus render_layers(const Deep *deep, const Stage *stage, const TetcastRenderDesc *given, double *seen) {
  const int64_t pixels = deep->image.width * deep->image.height;
  const int count = deep->image.layer_count;
  double *from = cli_allocate(sizeof *from * (size_t)pixels), *to = cli_allocate(sizeof *to * (size_t)pixels);
  const double *stops = given->stop ? given->stop->data : NULL;
  TetcastStatus status = TETCAST_OK;
  Part part = {cli_progress("rendering parts"), 0, count};
  for (; part.layer < count && status == TETCAST_OK; part.layer++) {
    const int i = part.layer;
    for (int64_t p = 0; p < pixels; p++) {
      const double begin = deep->begin[p], length = deep->end[p] - begin, stop = stops ? stops[p] : (double)INFINITY;
      from[p] = i == 0 ? 0 : begin + length * i / count;
      to[p] = i == count - 1 ? stop : fmin(stop, begin + length * (i + 1) / count);
      to[p] = seen[p] > 0 ? to[p] : 0;
    }
    const TetcastArray starts = {from, TETCAST_TYPE_FLOAT64, pixels, 0}, ends = {to, TETCAST_TYPE_FLOAT64, pixels, 0};
    TetcastRenderDesc desc = *given;
    desc.tolerance /= count; /* the parts' errors add up */
    desc.start = &starts;
    desc.stop = &ends;
    desc.progress = (TetcastProgress){part.all.function ? show : NULL, &part};
    status = render_layer(deep, stage, &desc, i);
    for (int64_t p = 0; p < pixels && status == TETCAST_OK; p++)
      seen[p] *= 1 - (double)deep->layers[i][4 * p + 3];
  }
  cli_progress_clear();
  free(from);
  free(to);
  return status;
}

TetcastStatus deep_render(Deep *deep, const Stage *stage, const RenderOptions *options, const TetcastRenderDesc *desc,
                          const TetcastFrame *flat) {
  deep_release(deep);
  const int count = render_options_deep(options);
  const int64_t width = tetcast_frame_width(flat), height = tetcast_frame_height(flat);
  const size_t pixels = (size_t)(width * height);
  deep->begin = cli_allocate(sizeof *deep->begin * pixels);
  deep->end = cli_allocate(sizeof *deep->end * pixels);
  deep->layers = cli_allocate(sizeof *deep->layers * (size_t)count);
  for (int i = 0; i < count; i++)
    deep->layers[i] = cli_allocate(sizeof **deep->layers * 4 * pixels);
  deep->image = (TetcastDeep){.width = width,
                              .height = height,
                              .layer_count = count,
                              .layers = (const float *const *)deep->layers,
                              .begin = deep->begin,
                              .end = deep->end};
  find_parts(deep, stage, desc->stop);
  double *seen = cli_allocate(sizeof *seen * pixels);
  const float *rgba = tetcast_frame_pixels(flat);
  for (size_t p = 0; p < pixels; p++)
    seen[p] = rgba[4 * p] != 0 || rgba[4 * p + 1] != 0 || rgba[4 * p + 2] != 0 || rgba[4 * p + 3] != 0;
  const TetcastStatus status = render_layers(deep, stage, desc, seen);
  free(seen);
  return status;
}

void deep_release(Deep *deep) {
  for (int i = 0; i < deep->image.layer_count; i++)
    free(deep->layers[i]);
  free(deep->layers);
  free(deep->begin);
  free(deep->end);
  *deep = (Deep){0};
}
