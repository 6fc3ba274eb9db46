/* SPDX-License-Identifier: Apache-2.0 */
/* Making tetrahedra with TetGen: target tetcast::tetgen, library libtetcast-tetgen. TetGen is licensed under the AGPL,
 * and so is what is linked with this library; libtetcast itself does not use it. */
#ifndef TETCAST_TETGEN_H
#define TETCAST_TETGEN_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/mesh.h>
#include <tetcast/status.h>
#include <tetcast/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What tetrahedra are to be like. */
typedef struct TetcastTetgenDesc {
  /* Set by tetcast_tetgen_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The ratio of circumradius to shortest edge that cells are to stay below, > 1. TetGen aims at it: below 2, a few
   * cells at the surface may exceed it. 0: cells of any shape will do. Default: 1.4. */
  double quality;
  /* The largest volume of a cell, in the surface's unit of length cubed, ≥ 0. Default: 0, no limit. */
  double max_volume;
} TetcastTetgenDesc;

/* Makes a desc with every setting at its default. */

TETCAST_API TetcastTetgenDesc tetcast_tetgen_desc_default(void);

/* Fills a closed surface with tetrahedra. TETCAST_ERROR_DATA with a message that says which: open surface,
 * self-intersection, non-finite or coincident input, nothing inside. It must not be called from two
 * threads at a time, as TetGen has global state. While it runs, standard output goes to /dev/null, as TetGen prints
 * even when told not to. Some assertions inside TetGen end the process; a program that must survive any surface makes
 * the mesh in a process of its own, as the command does. */
TETCAST_API TetcastStatus tetcast_tetgen_mesh(TetcastContext *context, const TetcastSurface *surface,
                                              const TetcastTetgenDesc *desc, TetcastMesh **mesh);

/* The same from a file in one of TetGen's own formats: .poly, .smesh (with holes and facets of any number of corners),
 * or .node/.ele (a mesh that TetGen made: read as it is). */
TETCAST_API TetcastStatus tetcast_tetgen_mesh_file(TetcastContext *context, const char *path,
                                                   const TetcastTetgenDesc *desc, TetcastMesh **mesh);

#ifdef __cplusplus
}
#endif

#endif
