/* SPDX-License-Identifier: Apache-2.0 */
/* Finds vertices of different cells that lie at one place. There are files in which each cell has points of its own, as
 * discontinuous-Galerkin codes write them. Their cells don't share vertices, or have gaps and overlaps between them
 * that are as wide as the rounding of coordinates. */
#ifndef TC_MESH_WELD_H
#define TC_MESH_WELD_H

#include "mesh/mesh.h"

/* A vertex, and the earlier vertex that takes its place. */
typedef struct TcWeld {
  uint32_t vertex, with;
} TcWeld;

/* How far apart, along each axis, vertices may be that count as one: four units in the last place of numbers as large
 * as the largest coordinate of `bounds` along that axis, in the precision that the mesh has. What two programs, or one
 * program for two cells, compute from the same numbers isn't rounded further apart. */
void tc_weld_tolerance(const TetcastMesh *mesh, const double bounds[6], double tolerance[3]);

/* Finds among `count` vertices those that lie within the tolerance of an earlier one. If two of the
 * vertices that would become one are of the same cell, or a cell's volume would change by more than an eighth, all of
 * them stay: that cell is as small as rounding, and nothing is torn or deformed. The caller frees *welds, which is NULL
 * where there are none. */
TetcastStatus tc_weld(const TetcastMesh *mesh, const double bounds[6], const uint32_t *vertices, int64_t count,
                      TcWeld **welds, int64_t *weld_count);

#endif
