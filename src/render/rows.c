/* SPDX-License-Identifier: Apache-2.0 */
/* A scene's transfer function of two dimensions: where its cells lie among the rows. */
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "render/render.h"

enum { GRAIN = 1 << 8 };

typedef struct Placing {
  const TetcastScene *scene;
  double *cell;
} Placing;

/* The gradient's magnitude in a cell, in the scalar's unit per the mesh's unit of length; NaN in a cell without volume
 * or with values that are not finite. */
static double steepness(const TetcastScene *scene, const uint32_t vertex[4]) {
  double position[4][3], value[4], sum[3], six_volumes;
  for (int k = 0; k < 4; ++k) {
    tc_volume_vertex(scene->volume, vertex[k], position[k]);
    value[k] = tc_rows_value(scene->values, vertex[k], 0);
  }
  tc_cell_gradient(position, value, sum, &six_volumes);
  const double largest = fmax(fabs(sum[0]), fmax(fabs(sum[1]), fabs(sum[2])));
  if (!(largest > 0) || !isfinite(largest)) /* fmax() passes NaN over */
    return sum[0] == 0 && sum[1] == 0 && sum[2] == 0 ? 0 : (double)NAN;
  double square = 0;
  for (int k = 0; k < 3; ++k)
    square += sum[k] / largest * (sum[k] / largest);
  return ldexp(sqrt(square) * (largest / six_volumes), scene->values->exponent - scene->volume->exponent);
}

static void place_cell(const Placing *p, int64_t cell, const uint32_t vertex[4]) {
  const TetcastScene *scene = p->scene;
  const double value =
      scene->second ? ldexp(tc_rows_value(scene->second, cell, 0), scene->second->exponent) : steepness(scene, vertex);
  p->cell[cell] = tc_second_place(scene->row_at, scene->row_count, value);
}

/* Of clusters, or of cells where there are none. */
static bool place_some(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Placing *p = data;
  const TetcastVolume *volume = p->scene->volume;
  for (int64_t i = begin; i < end; ++i) {
    if (volume->traversal == TETCAST_TRAVERSAL_FACES) {
      place_cell(p, i, volume->adjacency.vertices[i]);
      continue;
    }
    uint32_t vertices[TC_CLUSTER][4];
    const int count = tc_cluster_cells(&volume->clusters, &volume->adjacency, i, vertices);
    for (int j = 0; j < count; ++j)
      place_cell(p, (i << TC_CLUSTER_BITS) + j, vertices[j]);
  }
  return true;
}

static TetcastStatus place_cells(const TetcastScene *scene, TcSecond *second) {
  const TetcastVolume *volume = scene->volume;
  Placing p = {.scene = scene};
  /* Lanes that rest have the cell after the last one. */
  if (!tc_allocate_array(scene->context, (void **)&p.cell, volume->cell_count + 1, sizeof *p.cell,
                         "cells of a transfer function of two dimensions"))
    return TETCAST_ERROR_MEMORY;
  p.cell[volume->cell_count] = (double)NAN;
  const int64_t count = volume->traversal == TETCAST_TRAVERSAL_FACES ? volume->cell_count : volume->clusters.count;
  tc_parallel_for(scene->context, count, GRAIN, place_some, &p, NULL);
  second->cell = p.cell;
  return TETCAST_OK;
}

TetcastStatus tc_scene_scale_rows(const TetcastScene *scene, const TcPieces *hull, TcSecond *second) {
  TetcastContext *context = scene->context;
  TetcastTransferFunction *scaled[TETCAST_MAX_ROWS] = {NULL};
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; !status && i < scene->row_count; ++i) {
    status = tc_transfer_rescale(context, scene->rows[i], scene->values->exponent, scene->volume->exponent, &scaled[i]);
  }
  if (!status)
    status = tc_second_build(context, scaled, scene->row_count, hull, second);
  if (!status)
    status = place_cells(scene, second);
  for (int i = 0; i < scene->row_count; ++i)
    tc_transfer_destroy(scaled[i]);
  return status;
}

void tc_scene_clear_rows(TetcastScene *scene) {
  for (int i = 0; i < scene->row_count; ++i)
    tc_transfer_destroy(scene->rows[i]);
  tc_release(scene->context, scene->rows);
  tc_release(scene->context, scene->row_at);
  tc_rows_release(scene->second);
  scene->rows = NULL;
  scene->row_at = NULL;
  scene->row_count = 0;
  scene->second = NULL;
}
