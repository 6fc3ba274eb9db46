/* SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "render/render.h"

enum { GRID = 24, RAYS = 3 * GRID * GRID, WIDTH = 2 * GRID, HEIGHT = 3 * GRID / 2 };

/* Rays on a grid over the bounding sphere's disc, along each axis. */
static void set_axial(const TetcastVolume *volume, TcLine lines[RAYS]) {
  for (int i = 0; i < RAYS; ++i) {
    const int axis = i / (GRID * GRID), x = i % GRID, y = i / GRID % GRID;
    lines[i] = (TcLine){.direction = {axis == 0, axis == 1, axis == 2}, .end = INFINITY};
    memcpy(lines[i].eye, volume->center, sizeof lines[i].eye);
    lines[i].offset[(axis + 1) % 3] = ((2 * x + 1.0) / GRID - 1) * volume->radius;
    lines[i].offset[(axis + 2) % 3] = ((2 * y + 1.0) / GRID - 1) * volume->radius;
    lines[i].offset[axis] = -2 * volume->radius;
  }
}

/* The rays of a small picture. */
static void set_pixels(const TcView *view, TcLine lines[RAYS]) {
  for (int i = 0; i < RAYS; ++i) {
    const double x = view->center[0] + (2 * (i % WIDTH) + 1.0) / WIDTH - 1,
                 y = view->center[1] + 1 - (2 * (i / WIDTH) + 1.0) / HEIGHT;
    lines[i] = (TcLine){.end = INFINITY};
    for (int k = 0; k < 3; ++k) {
      const double shift = x * view->right[k] + y * view->up[k];
      lines[i].eye[k] = view->eye[k];
      lines[i].offset[k] = view->orthographic ? shift : 0;
      lines[i].direction[k] = view->forward[k] + (view->orthographic ? 0 : shift);
    }
    tc_normalize(lines[i].direction);
  }
}

/* How deep rays through the volume are, of a transfer function with extinctions of at most 1 per scaled length: rays on
 * a grid over the bounding sphere's disc, in three directions. Depths of those that meet anything go to `depths`. */
static TetcastStatus measure(const TetcastScene *scene, const TcPieces *pieces, const TcView *view, double depths[RAYS],
                             int *count) {
  const TetcastVolume *volume = scene->volume;
  TetcastContext *context = scene->context;
  TcLine *lines;
  double *sums;
  TcJob job = {0};
  tc_job_of(volume, scene->values, pieces, &job);
  if (!tc_allocate_array(context, (void **)&lines, RAYS, sizeof *lines, "rays"))
    return TETCAST_ERROR_MEMORY;
  if (!tc_allocate_array(context, (void **)&sums, RAYS, (size_t)job.sums * sizeof *sums, "rays")) {
    tc_release(context, lines);
    return TETCAST_ERROR_MEMORY;
  }
  memset(sums, 0, RAYS * (size_t)job.sums * sizeof *sums);
  if (view)
    set_pixels(view, lines);
  else
    set_axial(volume, lines);
  const TcIsaKernels *kernels =
      tc_kernels_for(volume->traversal == TETCAST_TRAVERSAL_FACES ? TETCAST_ISA_SCALAR : TETCAST_ISA_AUTO);
  TcWorker worker;
  const bool ok = tc_worker_begin(context, kernels, &job, &worker) && kernels->cast(&job, lines, RAYS, &worker, sums);
  tc_worker_end(context, &worker);
  *count = 0;
  for (int i = 0; i < RAYS; ++i) {
    const double depth =
        -log1p(-sums[job.sums * i + 3]); /* of at most 2: lengths and extinctions are that short and small */
    if (depth > 0)
      depths[(*count)++] = depth;
  }
  tc_release(context, lines);
  tc_release(context, sums);
  return ok ? TETCAST_OK : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: rays");
}

static double mean_opacity(const double *depths, int64_t count, double factor) {
  double sum = 0;
  for (int64_t i = 0; i < count; ++i)
    sum -= expm1(-depths[i] * factor);
  return sum / (double)count;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The factor by which depths make rays opaque to `opacity` on average; a mean of opacities rather than of depths, so
 * that neither a small hot core nor a faint halo decides alone. The mean depth is kept between 0.25 and 6; or, if the
 * picture is to be `clear`, at most one ray in twenty is opaque to more than 99 %, as far as the mean depth stays above
 * 0.25. */
static double find_factor(double *depths, int64_t count, double opacity, bool clear) {
  double mean = 0;
  for (int64_t i = 0; i < count; ++i)
    mean += depths[i] / (double)count;
  double lower = log((clear ? 1e-3 : 0.25) / mean), upper = log((clear ? 1e3 : 6) / mean);
  if (clear) {
    qsort(depths, (size_t)count, sizeof *depths, ascending);
    const double most = 4.6 / depths[count - 1 - count / 20];
    upper = fmin(upper, log(fmax(most, 0.25 / mean)));
  }
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (lower + upper);
    if (mean_opacity(depths, count, exp(middle)) < opacity)
      lower = middle;
    else
      upper = middle;
  }
  return exp(lower);
}

TetcastStatus tc_opacity_factor(TetcastContext *context, const double *depths, int64_t count, double opacity,
                                bool clear, double *factor) {
  double *copy;
  if (!tc_allocate_array(context, (void **)&copy, count, sizeof *copy, "optical depths"))
    return TETCAST_ERROR_MEMORY;
  memcpy(copy, depths, (size_t)count * sizeof *copy);
  *factor = find_factor(copy, count, opacity, clear);
  tc_release(context, copy);
  return TETCAST_OK;
}

/* By which factor extinctions of at most 1 make rays that meet something opaque as find_factor() has it. */
static TetcastStatus scale(const TetcastScene *scene, const TetcastTransferFunctionDesc *shape, const TcView *view,
                           double opacity, double *extinction) {
  const TetcastVolume *volume = scene->volume;
  TetcastTransferFunction *given, *transfer;
  TetcastStatus status = tc_transfer_create(scene->context, shape, &given);
  if (status)
    return status;
  status = tc_transfer_rescale(scene->context, given, scene->values->exponent, 0, &transfer);
  tc_transfer_destroy(given);
  if (status)
    return status;
  double depths[RAYS];
  int count = 0;
  status = measure(scene, &transfer->pieces, view, depths, &count);
  tc_transfer_destroy(transfer);
  if (status)
    return status;
  const double factor = count > 0 ? find_factor(depths, count, opacity, view != NULL) : 1 / volume->radius;
  *extinction = ldexp(factor, -volume->exponent);
  if (!isfinite(*extinction))
    *extinction = DBL_MAX;
  return TETCAST_OK;
}

TetcastStatus tc_scene_fit(const TetcastScene *scene, const TetcastTransferFunction *shape, double low, double high,
                           TetcastTransferFunction **transfer) {
  static const double gray[4] = {0, 1, 1, 1};
  TetcastTransferFunction *unit;
  double extinction;
  TetcastStatus status = tc_transfer_stretch(scene->context, shape, low, high, 1, &unit);
  if (status)
    return status;
  const TetcastTransferFunctionDesc desc = {
      .color = gray, .color_count = 1, .extinction = unit->extinction, .extinction_count = unit->extinction_count};
  status = scale(scene, &desc, NULL, 0.5, &extinction);
  tc_transfer_destroy(unit);
  return status ? status : tc_transfer_stretch(scene->context, shape, low, high, extinction, transfer);
}

TetcastStatus tc_scene_preset(const TetcastScene *scene, const char *name, double low, double high,
                              TetcastTransferFunction **transfer) {
  TetcastTransferFunction *shape;
  TetcastStatus status = tc_transfer_create_preset(scene->context, name, 0, 1, 1, &shape);
  if (status)
    return status;
  status = tc_scene_fit(scene, shape, low, high, transfer);
  tc_transfer_destroy(shape);
  return status;
}

TetcastStatus tc_scene_scale(const TetcastScene *scene, const TetcastTransferFunction *shape, const TcView *view,
                             double opacity, TetcastTransferFunction **transfer) {
  const int64_t count = shape->extinction_count;
  const double *given = shape->extinction;
  double *knots, largest = 0, extinction = 1;
  for (int64_t i = 0; i < count; ++i)
    largest = fmax(largest, given[2 * i + 1]);
  if (!tc_allocate_array(scene->context, (void **)&knots, 2 * count, sizeof *knots, "a transfer function"))
    return TETCAST_ERROR_MEMORY;
  for (int64_t i = 0; i < count; ++i) {
    knots[2 * i] = given[2 * i];
    knots[2 * i + 1] = largest > 0 ? given[2 * i + 1] / largest : 0;
  }
  const TetcastTransferFunctionDesc desc = {
      .color = shape->color, .color_count = shape->color_count, .extinction = knots, .extinction_count = count};
  TetcastStatus status = largest > 0 ? scale(scene, &desc, view, opacity, &extinction) : TETCAST_OK;
  for (int64_t i = 0; i < count; ++i)
    knots[2 * i + 1] = fmin(knots[2 * i + 1] * extinction, DBL_MAX);
  if (!status)
    status = tc_transfer_create(scene->context, &desc, transfer);
  tc_release(scene->context, knots);
  return status;
}
