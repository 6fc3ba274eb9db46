/* SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "render/render.h"

enum { GRID = 24 };

/* How deep rays through the volume are when the ramp from `low` to `high` rises to an extinction of 1 per scaled length: rays on a
 * grid over the bounding sphere's disc, along each axis. Depths of those that meet anything go to `depths`. */
static bool measure(const TetcastVolume *volume, const TcPieces *pieces, TcWorker *worker, double depths[3 * GRID * GRID],
                    int *count) {
  *count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < GRID * GRID; ++i) {
      const double u = (2 * (i % GRID) + 1.0) / GRID - 1, v = (2 * (i / GRID) + 1.0) / GRID - 1;
      TcLine line = {.direction = {axis == 0, axis == 1, axis == 2}};
      memcpy(line.eye, volume->center, sizeof line.eye);
      line.offset[(axis + 1) % 3] = u * volume->radius;
      line.offset[(axis + 2) % 3] = v * volume->radius;
      line.offset[axis] = -2 * volume->radius;
      TcLight light;
      if (!tc_cast(&volume->shell, pieces, &line, worker, &light)) return false;
      double rgba[4];
      tc_light_end(&light, rgba);
      if (light.depth > 0) depths[(*count)++] = light.depth;
    }
  }
  return true;
}

static double mean_opacity(const double *depths, int count, double factor) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum -= expm1(-depths[i] * factor);
  return sum / count;
}

/* Scales the ramp so that rays that meet something are on average opaque to one half; a mean of opacities rather than of depths,
 * so that neither a small hot core nor a faint halo decides alone. The mean depth is kept from running away. */
TetcastStatus tc_preset_extinction(TetcastContext *context, const TetcastVolume *volume, double low, double high,
                                   double *extinction) {
  static const double gray[4] = {0, 1, 1, 1};
  const double ramp[2][2] = {{low, low < high ? 0 : 1}, {high, 1}};
  const TetcastTransferFunctionDesc desc = {
    .color = gray, .color_count = 1, .extinction = ramp[0], .extinction_count = low < high ? 2 : 1};
  TetcastTransferFunction *given, *transfer;
  TetcastStatus status = tc_transfer_create(context, &desc, &given);
  if (status) return status;
  status = tc_transfer_rescale(context, given, volume->value_exponent, 0, &transfer);
  tc_transfer_destroy(given);
  if (status) return status;
  TcWorker worker = {.spans = {{.context = context}}, .tolerance = tc_tolerance_begin(&transfer->pieces, 0)};
  double depths[3 * GRID * GRID];
  int count = 0;
  const bool ok = measure(volume, &transfer->pieces, &worker, depths, &count);
  tc_spans_clear(&worker.spans[0]);
  tc_transfer_destroy(transfer);
  if (!ok) return tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: hits of a ray");

  double mean = 0, factor = 1 / volume->radius;
  for (int i = 0; i < count; ++i) mean += depths[i] / count;
  if (mean > 0) {
    double lower = log(0.25 / mean), upper = log(6 / mean); /* mean depth between 0.25 and 6 */
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (lower + upper);
      if (mean_opacity(depths, count, exp(middle)) < 0.5) lower = middle;
      else upper = middle;
    }
    factor = exp(lower);
  }
  *extinction = ldexp(factor, -volume->exponent);
  if (!isfinite(*extinction))
    *extinction = DBL_MAX;
  return TETCAST_OK;
}
