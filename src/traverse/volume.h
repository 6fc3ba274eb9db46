/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_TRAVERSE_VOLUME_H
#define TC_TRAVERSE_VOLUME_H

#include <tetcast/volume.h>

#include "mesh/adjacency.h"
#include "traverse/clusters.h"
#include "traverse/embree.h"

/* What rays are looked for in; made in shell.c, or the volume's own. */
typedef struct TcShell {
  TetcastContext *context;
  const TetcastVolume *volume;
  const TcShellFace *faces; /* [count]; with TETCAST_TRAVERSAL_FACES none: Embree holds the cells */
  int64_t count;
  TcEmbree *embree;         /* over the faces or cells; NULL if there are none */
  uint8_t *visible;         /* of each cluster; NULL: all are */
  void *memory;             /* of `faces`, if they are its own */
} TcShell;

/* Coordinates are stored times 2^−exponent, so that the largest is near 1: exact, and no unit can overflow or underflow later.
 * "Scaled" below means in these units. */
struct TetcastVolume {
  TetcastContext *context;
  TetcastTraversal traversal;
  int exponent;
  double center[3], radius; /* of a sphere around all cells, scaled */
  int64_t vertex_count, cell_count, mesh_cell_count;

  /* [vertex_count][4]: x, y, z scaled, and the point field's value; float when the mesh and the field came as float32. In an order of
   * the volume's own, along a curve through space; cells follow it (adjacency.h). */
  void *vertices;
  bool vertices_are_double, mesh_is_double;
  uint32_t *vertex_source; /* [vertex_count]: the mesh's vertex */

  TcAdjacency adjacency; /* without cells where Embree holds every cell; `vertices` of it only there */
  TcClusters clusters; /* none where Embree holds every cell */
  TcShell shell;       /* of the whole volume */

  bool has_field;
  int64_t field_number; /* changes with each field */
  TetcastAssociation association;
  double *cell_values; /* [cell_count] with a cell field; not finite: transparent */
  int value_exponent;  /* values are stored times 2^−value_exponent: −TC_TINY_FIELD, 0 or TC_HUGE_FIELD */
  TetcastVolumeInfo info;
};

/* A field whose values are all below 2^−TC_TINY_FIELD is stored times 2^TC_TINY_FIELD, so that interpolation does not
 * underflow; one with a value above TC_LARGEST_SCALAR is stored times 2^−TC_HUGE_FIELD, so that it does not overflow.
 */
enum { TC_TINY_FIELD = 500, TC_HUGE_FIELD = 64 };

TetcastStatus tc_volume_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastVolumeDesc *desc,
                               TetcastVolume **volume);
void tc_volume_destroy(TetcastVolume *volume);
TetcastStatus tc_volume_set_field(TetcastVolume *volume, const TetcastField *field);
void tc_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info);

/* Bounds of face or cell i of a TcShell, for Embree. */
void tc_shell_bounds(const void *shell, uint32_t i, double low[3], double high[3]);

/* x, y, z scaled and the point value. */
static inline void tc_volume_vertex(const TetcastVolume *volume, uint32_t i, double record[4]) {
  if (volume->vertices_are_double) {
    const double *v = (const double *)volume->vertices + 4 * (size_t)i;
    for (int k = 0; k < 4; ++k) record[k] = v[k];
  } else {
    const float *v = (const float *)volume->vertices + 4 * (size_t)i;
    for (int k = 0; k < 4; ++k) record[k] = (double)v[k];
  }
}

#endif
