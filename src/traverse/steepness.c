/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/steepness.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 64 };

typedef struct Pass {
  const TetcastVolume *volume;
  TcSteepness *found; /* of each worker; squared but for `value` */
} Pass;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* ∇s = (Δs₁ b×c + Δs₂ c×a + Δs₃ a×b) / (a · b×c), with a, b, c the edges from one vertex. Where the volume is less than 2^−40 of the edges'
 * product, rounding may be a thousandth of it: such a cell counts as without any. */
static void add_cell(double record[4][4], TcSteepness *found) {
  double edge[3][3], face[3][3], gradient[3] = {0, 0, 0}, product = 0x1p-80;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) edge[i][k] = record[i + 1][k] - record[0][k];
    const double length2 = dot(edge[i], edge[i]);
    product *= length2;
    found->diameter = fmax(found->diameter, length2);
  }
  for (int i = 0; i < 3; ++i) {
    double opposite[3];
    for (int k = 0; k < 3; ++k) opposite[k] = edge[i][k] - edge[(i + 1) % 3][k];
    found->diameter = fmax(found->diameter, dot(opposite, opposite));
    cross(edge[(i + 1) % 3], edge[(i + 2) % 3], face[i]);
    for (int k = 0; k < 3; ++k) gradient[k] += (record[i + 1][3] - record[0][3]) * face[i][k];
  }
  const double volume = dot(edge[0], face[0]), volume2 = volume * volume, steepness2 = dot(gradient, gradient) / volume2;
  const bool known = volume2 > product && isfinite(steepness2);
  found->gradient = fmax(found->gradient, known ? steepness2 : INFINITY);
  for (int i = 0; i < 4; ++i) found->value = fmax(found->value, fabs(record[i][3]));
}

static bool take(void *data, int64_t begin, int64_t end, int worker) {
  const Pass *pass = data;
  const TetcastVolume *volume = pass->volume;
  TcSteepness *found = &pass->found[worker];
  for (int64_t c = begin; c < end; ++c) {
    uint32_t vertices[TC_CLUSTER][4];
    const int count = tc_cluster_cells(&volume->clusters, &volume->adjacency, c, vertices);
    for (int i = 0; i < count; ++i) {
      double record[4][4];
      for (int k = 0; k < 4; ++k) tc_volume_vertex(volume, vertices[i][k], record[k]);
      add_cell(record, found);
    }
  }
  return true;
}

TetcastStatus tc_steepness(const TetcastVolume *volume, TcSteepness *steepness) {
  TetcastContext *context = volume->context;
  const int threads = tc_context_threads(context);
  Pass pass = {.volume = volume};
  if (!tc_allocate_array(context, (void **)&pass.found, threads, sizeof *pass.found, "gradients")) return TETCAST_ERROR_MEMORY;
  memset(pass.found, 0, (size_t)threads * sizeof *pass.found);
  tc_parallel_for(context, volume->clusters.count, GRAIN, take, &pass, NULL);
  *steepness = (TcSteepness){.radius = volume->radius};
  for (int i = 0; i < threads; ++i) {
    steepness->gradient = fmax(steepness->gradient, pass.found[i].gradient);
    steepness->diameter = fmax(steepness->diameter, pass.found[i].diameter);
    steepness->value = fmax(steepness->value, pass.found[i].value);
  }
  steepness->gradient = 1.002 * sqrt(steepness->gradient);
  steepness->diameter = 1.002 * sqrt(steepness->diameter);
  tc_release(context, pass.found);
  return TETCAST_OK;
}
