/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/shell.h"

#include <string.h>

#include "base/parallel.h"
#include "base/vec3.h"

enum { GRAIN = 64 };

typedef struct Build {
  const TetcastVolume *volume;
  const TcShell *shell;
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

/* Finds the faces of cluster c's visible cells behind which nothing is visible, and writes them to `faces` unless it is
 * NULL. Returns their number. */
static uint32_t cluster_faces(const Build *build, int64_t c, TcShellFace *faces) {
  const TcAdjacency *adjacency = &build->volume->adjacency;
  uint32_t vertices[TC_CLUSTER][4], count = 0;
  const int64_t first = c << TC_CLUSTER_BITS;
  const int cells = tc_cluster_size(adjacency, c);
  bool known = false;
  for (int i = 0; i < cells; ++i) {
    if (!tc_shell_shows(build->shell, (uint32_t)(first + i)))
      continue;
    const TcCell *cell = &adjacency->cells[first + i];
    for (int k = 0; k < 4; ++k) {
      const uint32_t next = cell->neighbor[k];
      if (!(next & TC_SHELL) && tc_shell_shows(build->shell, next))
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
    build->begin[c + 1] = build->shell->visible[c] ? cluster_faces(build, c, NULL) : 0;
  return true;
}

static bool take_faces(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) {
    if (build->shell->visible[c])
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

/* ── what a clip cuts off ── */

/* So many half-spaces are looked at in one go. */
enum { AT_ONCE = 8 };

typedef struct Cut {
  TcShell *shell;
  const TcHalfSpace *clip;
  int count;       /* of half-spaces, at most AT_ONCE */
  uint8_t *beyond; /* [vertices]: one bit for each half-space that a vertex lies outside of */
} Cut;

/* A cell is cut off if all its vertices lie outside of one half-space, by more than this part of the volume's radius:
 * far more than rounding moves the ends of rays' intervals (walk/interval.h), unless the eye is 1e8 radii away. Even
 * then just what lies outside is left out. */
static const double MARGIN = 0x1p-18;

static bool find_vertices_beyond(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Cut *cut = data;
  const TetcastVolume *volume = cut->shell->volume;
  for (int64_t i = begin; i < end; ++i) {
    double x[3];
    unsigned beyond = 0;
    tc_volume_vertex(volume, (uint32_t)i, x);
    for (int k = 0; k < 3; ++k)
      x[k] -= volume->center[k];
    for (int j = 0; j < cut->count; ++j) {
      const TcHalfSpace *h = &cut->clip[j];
      beyond |= (unsigned)(tc_dot(h->normal, x) + h->at_center < -MARGIN * h->length * volume->radius) << j;
    }
    cut->beyond[i] = (uint8_t)beyond;
  }
  return true;
}

static bool cut_clusters(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Cut *cut = data;
  const TetcastVolume *volume = cut->shell->volume;
  for (int64_t c = begin; c < end; ++c) {
    if (!cut->shell->visible[c])
      continue;
    uint32_t vertices[TC_CLUSTER][4];
    const int cells = tc_cluster_cells(&volume->clusters, &volume->adjacency, c, vertices);
    for (int i = 0; i < cells; ++i) {
      const uint32_t *v = vertices[i];
      if (cut->beyond[v[0]] & cut->beyond[v[1]] & cut->beyond[v[2]] & cut->beyond[v[3]])
        cut->shell->visible[c] &= ~(UINT64_C(1) << i);
    }
  }
  return true;
}

/* Makes the cells invisible that the clip cuts off. */
static TetcastStatus cut_off(TcShell *shell, const TcHalfSpace *clip, int count) {
  const TetcastVolume *volume = shell->volume;
  Cut cut = {.shell = shell};
  if (!tc_allocate_array(shell->context, (void **)&cut.beyond, volume->vertex_count, 1, "vertices beyond a clip"))
    return TETCAST_ERROR_MEMORY;
  for (; count > 0; clip += AT_ONCE, count -= AT_ONCE) {
    cut.clip = clip;
    cut.count = count < AT_ONCE ? count : AT_ONCE;
    tc_parallel_for(shell->context, volume->vertex_count, 1 << 14, find_vertices_beyond, &cut, NULL);
    tc_parallel_for(shell->context, volume->clusters.count, GRAIN, cut_clusters, &cut, NULL);
  }
  tc_release(shell->context, cut.beyond);
  return TETCAST_OK;
}

/* ── all of it ── */

/* The cells of cluster c, as bits. */
static uint64_t cells_of(const TcShell *shell, int64_t c) {
  return UINT64_MAX >> (TC_CLUSTER - tc_cluster_size(&shell->volume->adjacency, c));
}

/* Marks the clusters of which something is seen in the field. */
static void find_visible(const TcShellOf *of, TcShell *shell) {
  for (int64_t c = 0; c < of->volume->clusters.count; ++c) {
    const float *range = of->rows->range[c];
    const double low = (double)range[0], high = (double)range[1];
    const bool visible = low <= high && (is_visible(of->pieces, low, high) ||
                                         is_crossed(of->isosurfaces, of->isosurface_count, low, high));
    shell->visible[c] = visible ? cells_of(shell, c) : 0;
  }
}

static void count_visible(TcShell *shell) {
  shell->visible_cells = 0;
  for (int64_t c = 0; c < shell->volume->clusters.count; ++c)
    shell->visible_cells += __builtin_popcountll(shell->visible[c]);
}

/* Marks what is visible. *less tells whether that is so little that it is worth a shell of its own. */
static TetcastStatus mark(const TcShellOf *of, TcShell *shell, bool *less) {
  const int64_t clusters = of->volume->clusters.count, cells = of->volume->cell_count;
  *less = false;
  if (!tc_allocate_array(shell->context, (void **)&shell->visible, clusters + 1, sizeof *shell->visible,
                         "visible cells"))
    return TETCAST_ERROR_MEMORY;
  memset(shell->visible, 0, (size_t)(clusters + 1) * sizeof *shell->visible);
  if (of->rows)
    find_visible(of, shell);
  count_visible(shell);
  /* With more of the volume visible, entering it again and again takes as much time as is saved: with a third visible,
   * in bands, nothing was gained. */
  *less = of->rows && 4 * shell->visible_cells <= cells;
  for (int64_t c = 0; !*less && c < clusters; ++c)
    shell->visible[c] = cells_of(shell, c);
  TetcastStatus status = TETCAST_OK;
  if (of->clip_count > 0) {
    const int64_t before = *less ? shell->visible_cells : cells;
    status = cut_off(shell, of->clip, of->clip_count);
    count_visible(shell);
    /* A clip's side is entered once, so a little that needn't be walked pays for it. */
    *less = *less || 16 * shell->visible_cells <= 15 * before;
  }
  shell->visible[cells >> TC_CLUSTER_BITS] |= UINT64_C(1) << (cells & (TC_CLUSTER - 1));
  return status;
}

TetcastStatus tc_shell_build(const TcShellOf *of, TcShell *shell) {
  const TetcastVolume *volume = of->volume;
  TetcastContext *context = volume->context;
  *shell = volume->shell;
  if (volume->traversal == TETCAST_TRAVERSAL_FACES || (of->rows && !of->rows->range) ||
      (!of->rows && of->clip_count == 0))
    return TETCAST_OK;
  TcShell made = {.context = context, .volume = volume};
  bool less;
  TetcastStatus status = mark(of, &made, &less);
  if (!status && less) {
    Build build = {.volume = volume, .shell = &made};
    status = make_faces(&build, &made);
    tc_release(context, build.begin);
  }
  if (!status && less && made.count > 0)
    status =
        tc_embree_create(context, made.count, volume->center, volume->radius, tc_shell_bounds, &made, &made.embree);
  if (!status && less) {
    *shell = made;
    return TETCAST_OK;
  }
  tc_shell_clear(&made);
  return status == TETCAST_ERROR_LIMIT ? TETCAST_OK : status;
}

void tc_shell_clear(TcShell *shell) {
  if (shell->visible) {
    tc_embree_destroy(shell->embree);
    tc_release(shell->context, shell->memory);
    tc_release(shell->context, shell->visible);
  }
  memset(shell, 0, sizeof *shell);
}
