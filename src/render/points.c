/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/parallel.h"
#include "render/render.h"

bool tc_worth_preparing(const TcShell *shell, int64_t rays) {
  const TetcastVolume *volume = shell->volume;
  if (volume->traversal != TETCAST_TRAVERSAL_SHELL)
    return false;
  const double cells = (double)volume->cell_count, crossings = 0.5 * (double)rays * cbrt(cells);
  const double share = shell->visible ? (double)shell->visible_cells / cells : 1;
  return share * crossings > 3 * (double)volume->vertex_count;
}

typedef struct Points {
  const TetcastVolume *volume;
  const TcRows *values;
  double (*points)[4];
} Points;

static bool take_points(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Points *p = data;
  tc_rows_points(p->volume, p->values, begin, end, p->points + begin);
  return true;
}

double *tc_points_prepare(const TetcastVolume *volume, const TcRows *values, void *memory) {
  if (!memory)
    memory = tc_allocate(volume->context, volume->vertex_count, 4 * sizeof(double));
  if (!memory)
    return NULL;
  Points points = {volume, values, memory};
  tc_parallel_for(volume->context, volume->vertex_count, 1 << 14, take_points, &points, NULL);
  return memory;
}
