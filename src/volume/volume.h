/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_VOLUME_VOLUME_H
#define TC_VOLUME_VOLUME_H

#include <tetcast/volume.h>

#include "mesh/adjacency.h"
#include "mesh/weld.h"
#include "volume/clusters.h"
#include "volume/embree.h"
#include "volume/shared.h"

/* The shell (shell.h): the volume's own, or one made in shell.c. */
typedef struct TcShell {
  TetcastContext *context;
  const TetcastVolume *volume;
  const TcShellFace *faces; /* [count]; NULL with TETCAST_TRAVERSAL_FACES, where Embree holds the cells */
  int64_t count;            /* the number of faces, or of cells */
  TcEmbree *embree;         /* over the faces or cells; NULL if there are none */
  uint64_t *visible;        /* [clusters, and room for one more]: a bit for each visible cell; NULL if all are */
  int64_t visible_cells;    /* how many cells are visible, if not all */
  void *memory;             /* the memory of `faces`, if the shell owns it */
} TcShell;

/* Coordinates are stored times 2^−exponent, so that the largest is near 1: exact, and no unit can overflow or underflow
 * later. "Scaled" below means in these units. */
struct TetcastVolume {
  TetcastContext *context;
  TetcastTraversal traversal;
  int exponent;
  double center[3], radius; /* of a sphere around all cells, or those of the whole that this is a part of, scaled */
  bool is_part;             /* bounds were given: all that is rounded is rounded as in other parts with these */
  int64_t vertex_count, cell_count, mesh_cell_count;

  /* [vertex_count][3], and room for one number more, so that four may be read at once: x, y, z scaled, as the mesh has
   * them in single or in double precision. In an order of the volume's own, along a curve through space; cells follow
   * it (adjacency.h). */
  void *positions;
  bool positions_are_double;
  uint32_t *vertex_source; /* [vertex_count]: the mesh's vertex */

  /* Vertices that lie where others do have become one with these (mesh/weld.h). Values stay each cell's own: NULL where
   * there are no such vertices. */
  TcWeld *welds; /* [weld_count], of the mesh's vertices */
  int64_t weld_count;
  /* [cell_count]: the mesh's vertices of each cell, in the ascending order of the volume's. */
  uint32_t (*corner_vertices)[4];

  /* [cell_count]: for each of a cell's vertices in ascending order, two bits that tell its place among the cell's
   * vertices in the mesh. NULL unless fields of corners were asked for. */
  uint8_t *corner_order;

  TcAdjacency adjacency; /* without cells where Embree holds every cell; `vertices` of it only there */
  TcClusters clusters;   /* none where Embree holds every cell */
  bool folds;            /* cells that share a face overlap somewhere: one of them is turned inside out */
  TcShell shell;         /* of the whole volume */

  TcShared *shared; /* fields in the volume's order (rows.h), which scenes share */
  TetcastVolumeInfo info;
};

TetcastStatus tc_volume_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastVolumeDesc *desc,
                               TetcastVolume **volume);
void tc_volume_destroy(TetcastVolume *volume);
void tc_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info);

/* Visits all cells, one after the other, with their vertices in ascending order. */
void tc_volume_each_cell(const TetcastVolume *volume, void visit(void *data, const uint32_t vertex[4]), void *data);

/* Whether a cell is visible, in a shell that leaves some out. The cell after the last one, where rays rest, is. */
static inline bool tc_shell_shows(const TcShell *shell, uint32_t cell) {
  return shell->visible[cell >> TC_CLUSTER_BITS] >> (cell & (TC_CLUSTER - 1)) & 1;
}

/* Computes the bounds of face or cell i of a TcShell, for Embree. */
void tc_shell_bounds(const void *shell, uint32_t i, double low[3], double high[3]);

/* Coordinates of smaller magnitude, scaled, count as zero (walk/ray.h). */
#define TC_TINY 0x1p-150

static inline double tc_without_tiny(double x) {
  return x > -TC_TINY && x < TC_TINY ? 0 : x;
}

/* The position of a vertex, scaled. */
static inline void tc_volume_vertex(const TetcastVolume *volume, uint32_t i, double position[3]) {
  if (volume->positions_are_double) {
    const double *p = (const double *)volume->positions + 3 * (size_t)i;
    for (int k = 0; k < 3; ++k)
      position[k] = p[k];
  } else {
    const float *p = (const float *)volume->positions + 3 * (size_t)i;
    for (int k = 0; k < 3; ++k)
      position[k] = (double)p[k];
  }
}

#endif
