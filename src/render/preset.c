/* SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "render/render.h"

enum { GRID = 24 };

/* How deep rays through the volume are when the ramp from `low` to `high` rises to an extinction of 1 per scaled
 * length: rays on a grid over the bounding sphere's disc, along each axis. Depths of those that meet anything go to
 * `depths`. */
static TetcastStatus measure(const TetcastScene *scene, const TcPieces *pieces, double depths[3 * GRID * GRID],
                             int *count) {
  const TetcastVolume *volume = scene->volume;
  TetcastContext *context = scene->context;
  TcLine *lines;
  double *sums;
  TcJob job = {0};
  tc_job_of(volume, scene->values, pieces, &job);
  if (!tc_allocate_array(context, (void **)&lines, 3 * GRID * GRID, sizeof *lines, "rays"))
    return TETCAST_ERROR_MEMORY;
  if (!tc_allocate_array(context, (void **)&sums, 3 * GRID * GRID, (size_t)job.sums * sizeof *sums, "rays")) {
    tc_release(context, lines);
    return TETCAST_ERROR_MEMORY;
  }
  memset(sums, 0, 3 * GRID * GRID * (size_t)job.sums * sizeof *sums);
  for (int i = 0; i < 3 * GRID * GRID; ++i) {
    const int axis = i / (GRID * GRID), x = i % GRID, y = i / GRID % GRID;
    lines[i] = (TcLine){.direction = {axis == 0, axis == 1, axis == 2}, .end = INFINITY};
    memcpy(lines[i].eye, volume->center, sizeof lines[i].eye);
    lines[i].offset[(axis + 1) % 3] = ((2 * x + 1.0) / GRID - 1) * volume->radius;
    lines[i].offset[(axis + 2) % 3] = ((2 * y + 1.0) / GRID - 1) * volume->radius;
    lines[i].offset[axis] = -2 * volume->radius;
  }
  const TcIsaKernels *kernels =
      tc_kernels_for(volume->traversal == TETCAST_TRAVERSAL_FACES ? TETCAST_ISA_SCALAR : TETCAST_ISA_AUTO);
  TcWorker worker;
  const bool ok =
      tc_worker_begin(context, kernels, &job, &worker) && kernels->cast(&job, lines, 3 * GRID * GRID, &worker, sums);
  tc_worker_end(context, &worker);
  *count = 0;
  for (int i = 0; i < 3 * GRID * GRID; ++i) {
    const double depth =
        -log1p(-sums[job.sums * i + 3]); /* of at most 2: lengths and extinctions are that short and small */
    if (depth > 0)
      depths[(*count)++] = depth;
  }
  tc_release(context, lines);
  tc_release(context, sums);
  return ok ? TETCAST_OK : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: rays");
}

static double mean_opacity(const double *depths, int count, double factor) {
  double sum = 0;
  for (int i = 0; i < count; ++i)
    sum -= expm1(-depths[i] * factor);
  return sum / count;
}

/* Scales the ramp so that rays that meet something are on average opaque to one half; a mean of opacities rather than
 * of depths, so that neither a small hot core nor a faint halo decides alone. The mean depth is kept from running away.
 */
static TetcastStatus find_extinction(const TetcastScene *scene, double low, double high, double *extinction) {
  static const double gray[4] = {0, 1, 1, 1};
  const TetcastVolume *volume = scene->volume;
  const double ramp[2][2] = {{low, low < high ? 0 : 1}, {high, 1}};
  const TetcastTransferFunctionDesc desc = {
      .color = gray, .color_count = 1, .extinction = ramp[0], .extinction_count = low < high ? 2 : 1};
  TetcastTransferFunction *given, *transfer;
  TetcastStatus status = tc_transfer_create(scene->context, &desc, &given);
  if (status)
    return status;
  status = tc_transfer_rescale(scene->context, given, scene->values->exponent, 0, &transfer);
  tc_transfer_destroy(given);
  if (status)
    return status;
  double depths[3 * GRID * GRID];
  int count = 0;
  status = measure(scene, &transfer->pieces, depths, &count);
  tc_transfer_destroy(transfer);
  if (status)
    return status;

  double mean = 0, factor = 1 / volume->radius;
  for (int i = 0; i < count; ++i)
    mean += depths[i] / count;
  if (mean > 0) {
    double lower = log(0.25 / mean), upper = log(6 / mean); /* mean depth between 0.25 and 6 */
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (lower + upper);
      if (mean_opacity(depths, count, exp(middle)) < 0.5)
        lower = middle;
      else
        upper = middle;
    }
    factor = exp(lower);
  }
  *extinction = ldexp(factor, -volume->exponent);
  if (!isfinite(*extinction))
    *extinction = DBL_MAX;
  return TETCAST_OK;
}

TetcastStatus tc_scene_preset(const TetcastScene *scene, const char *name, double low, double high,
                              TetcastTransferFunction **transfer) {
  double extinction;
  const TetcastStatus status = find_extinction(scene, low, high, &extinction);
  return status ? status : tc_transfer_create_preset(scene->context, name, low, high, extinction, transfer);
}
