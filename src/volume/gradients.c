/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/gradients.h"

#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 1 << 14 };

typedef struct Build {
  const TcRows *values;
  double (*sum)[4]; /* [vertices]: Σ volume · gradient, Σ volume, both times six */
  TcGradients *gradients;
} Build;

static void add_cell(void *data, const uint32_t vertex[4]) {
  Build *build = data;
  double position[4][3], value[4], sum[3], six_volumes;
  for (int k = 0; k < 4; ++k) {
    tc_volume_vertex(build->values->volume, vertex[k], position[k]);
    value[k] = tc_rows_value(build->values, vertex[k], 0) / build->values->largest;
  }
  tc_cell_gradient(position, value, sum, &six_volumes);
  if (!isfinite(sum[0]) || !isfinite(sum[1]) || !isfinite(sum[2]))
    return;
  for (int k = 0; k < 4; ++k) {
    double *at = build->sum[vertex[k]];
    for (int i = 0; i < 3; ++i)
      at[i] += sum[i];
    at[3] += six_volumes;
  }
}

/* A mean gradient may be too steep for single precision; then its length is not kept. */
static bool take_means(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  static const double most = 0x1p100;
  for (int64_t i = begin; i < end; ++i) {
    const double *sum = build->sum[i], largest = fmax(fabs(sum[0]), fmax(fabs(sum[1]), fabs(sum[2])));
    const double scale = largest > most * sum[3] ? most / largest : 1 / sum[3];
    for (int k = 0; k < 3; ++k)
      build->gradients->at[i][k] = largest > 0 ? (float)(sum[k] * scale) : 0;
  }
  return true;
}

TetcastStatus tc_gradients_build(const TcRows *values, TcGradients *gradients) {
  TetcastContext *context = values->volume->context;
  const int64_t count = values->volume->vertex_count;
  Build build = {.values = values, .gradients = gradients};
  *gradients = (TcGradients){.context = context};
  TetcastStatus status = TETCAST_OK;
  if (!tc_allocate_array(context, (void **)&build.sum, count, sizeof *build.sum, "gradients") ||
      !tc_allocate_array(context, (void **)&gradients->at, count, sizeof *gradients->at, "gradients")) {
    status = TETCAST_ERROR_MEMORY;
  } else {
    memset(build.sum, 0, (size_t)count * sizeof *build.sum);
    tc_volume_each_cell(values->volume, add_cell, &build); /* so that sums do not depend on the number of threads */
    tc_parallel_for(context, count, GRAIN, take_means, &build, NULL);
  }
  tc_release(context, build.sum);
  if (status)
    tc_gradients_clear(gradients);
  return status;
}

void tc_gradients_clear(TcGradients *gradients) {
  if (gradients->context)
    tc_release(gradients->context, gradients->at);
  memset(gradients, 0, sizeof *gradients);
}
