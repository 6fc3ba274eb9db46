/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/shell.h"

#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 64 };

typedef struct Build {
  const TetcastVolume *volume;
  const uint8_t *visible;
  uint32_t *begin; /* [clusters + 1]: the first face of each cluster */
  TcShellFace *faces;
} Build;

/* Whether any scalar in [low, high] has an extinction. */
static bool is_visible(const TcPieces *pieces, double low, double high) {
  for (int64_t i = tc_piece_below(pieces, low); i <= pieces->count && pieces->pieces[i].low <= high; ++i) {
    if (pieces->pieces[i].at_low.extinction > 0 || pieces->pieces[i].at_high.extinction > 0)
      return true;
  }
  return false;
}

/* Whether any of the isosurfaces, which ascend, has a value in [low, high]. */
static bool is_crossed(const TetcastIsosurface *isosurfaces, int count, double low, double high) {
  int below = 0, above = count;
  while (below < above) {
    const int middle = (below + above) / 2;
    if (isosurfaces[middle].value < low)
      below = middle + 1;
    else
      above = middle;
  }
  return below < count && isosurfaces[below].value <= high;
}

/* Finds the faces of cluster c's cells behind which nothing is visible, and writes them to `faces` unless it is NULL.
 * Returns their number.
 */
static uint32_t cluster_faces(const Build *build, int64_t c, TcShellFace *faces) {
  const TcAdjacency *adjacency = &build->volume->adjacency;
  uint32_t vertices[TC_CLUSTER][4], count = 0;
  const int64_t first = c << TC_CLUSTER_BITS;
  const int cells = tc_cluster_size(adjacency, c);
  bool known = false;
  for (int i = 0; i < cells; ++i) {
    const TcCell *cell = &adjacency->cells[first + i];
    for (int k = 0; k < 4; ++k) {
      const uint32_t next = cell->neighbor[k];
      if (!(next & TC_SHELL) && build->visible[next >> TC_CLUSTER_BITS])
        continue;
      if (faces) {
        if (!known)
          tc_cluster_cells(&build->volume->clusters, adjacency, c, vertices);
        known = true;
        TcShellFace *face = &faces[count];
        for (int j = 0, n = 0; j < 4; ++j) {
          if (j != k)
            face->vertex[n++] = vertices[i][j];
        }
        face->cell = (uint32_t)(first + i);
      }
      ++count;
    }
  }
  return count;
}

static bool count_faces(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c)
    build->begin[c + 1] = build->visible[c] ? cluster_faces(build, c, NULL) : 0;
  return true;
}

static bool take_faces(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) {
    if (build->visible[c])
      cluster_faces(build, c, build->faces + build->begin[c]);
  }
  return true;
}

static TetcastStatus make_faces(Build *build, TcShell *shell) {
  TetcastContext *context = build->volume->context;
  const int64_t clusters = build->volume->clusters.count;
  if (!tc_allocate_array(context, (void **)&build->begin, clusters + 1, sizeof *build->begin, "visible faces"))
    return TETCAST_ERROR_MEMORY;
  build->begin[0] = 0;
  tc_parallel_for(context, clusters, GRAIN, count_faces, build, NULL);
  int64_t total = 0;
  for (int64_t c = 0; c < clusters; ++c) {
    total += build->begin[c + 1];
    build->begin[c + 1] += build->begin[c];
  }
  shell->count = total;
  if (total >= INT64_C(1) << 31)
    return TETCAST_ERROR_LIMIT; /* the volume's own shell is used then */
  if (!tc_allocate_array(context, &shell->memory, total, sizeof *shell->faces, "visible faces"))
    return TETCAST_ERROR_MEMORY;
  shell->faces = build->faces = shell->memory;
  tc_parallel_for(context, clusters, GRAIN, take_faces, build, NULL);
  return TETCAST_OK;
}

TetcastStatus tc_shell_build(const TcRows *rows, const TcPieces *pieces, const TetcastIsosurface *isosurfaces,
                             int isosurface_count, TcShell *shell) {
  const TetcastVolume *volume = rows->volume;
  *shell = volume->shell;
  const TcClusters *clusters = &volume->clusters;
  if (!rows->range)
    return TETCAST_OK;
  TetcastContext *context = volume->context;
  uint8_t *visible;
  if (!tc_allocate_array(context, (void **)&visible, clusters->count, 1, "visible clusters"))
    return TETCAST_ERROR_MEMORY;
  int64_t count = 0;
  for (int64_t c = 0; c < clusters->count; ++c) {
    const float *range = rows->range[c];
    visible[c] =
        range[0] <= range[1] && (is_visible(pieces, (double)range[0], (double)range[1]) ||
                                 is_crossed(isosurfaces, isosurface_count, (double)range[0], (double)range[1]));
    count += visible[c];
  }
  /* With more of the volume visible, entering it again and again takes as much time as is saved: with a third visible,
   * in bands, nothing was gained. */
  if (4 * count > clusters->count) {
    tc_release(context, visible);
    return TETCAST_OK;
  }
  *shell = (TcShell){.context = context, .volume = volume, .visible = visible, .visible_count = count};
  Build build = {.volume = volume, .visible = visible};
  TetcastStatus status = make_faces(&build, shell);
  tc_release(context, build.begin);
  if (status == TETCAST_ERROR_LIMIT) {
    tc_shell_clear(shell);
    *shell = volume->shell;
    return TETCAST_OK;
  }
  if (!status && shell->count > 0) {
    status =
        tc_embree_create(context, shell->count, volume->center, volume->radius, tc_shell_bounds, shell, &shell->embree);
  }
  if (status)
    tc_shell_clear(shell);
  return status;
}

void tc_shell_clear(TcShell *shell) {
  if (shell->visible) {
    tc_embree_destroy(shell->embree);
    tc_release(shell->context, shell->memory);
    tc_release(shell->context, shell->visible);
  }
  memset(shell, 0, sizeof *shell);
}
