/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices of different cells that lie at one place: files in which each cell brings its own points, as
 * discontinuous-Galerkin codes write them, have a mesh whose cells meet nowhere, or with gaps and overlaps as wide as
 * coordinates were rounded. */
#ifndef TC_MESH_WELD_H
#define TC_MESH_WELD_H

#include "mesh/mesh.h"

/* Of a vertex, and of the one whose place it takes. */
typedef struct TcWeld {
  uint32_t vertex, with;
} TcWeld;

/* How far apart, along each axis, vertices may be that are one: four units in the last place of numbers as large as the
 * mesh's largest coordinate along that axis, in the precision that it has. Two programs, or two cells of one, don't
 * round further apart what they compute from the same numbers. */
void tc_weld_tolerance(const TetcastMesh *mesh, double tolerance[3]);

/* Finds among `count` vertices those that lie within the tolerance of an earlier one. Where two of those that would
 * become one are of the same cell, all of them stay: that cell is thin, not torn. The caller frees *welds, which is
 * NULL where there are none. */
TetcastStatus tc_weld(const TetcastMesh *mesh, const uint32_t *vertices, int64_t count, TcWeld **welds,
                      int64_t *weld_count);

#endif
