/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_VOLUME_H
#define TETCAST_VOLUME_H

#include <stddef.h>
#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/field.h>
#include <tetcast/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh prepared for casting rays: face adjacency, and the faces at which rays enter and leave in Embree.
 * Made once per mesh; it keeps nothing of the mesh's arrays, which may go when it is made. Fields come and go. */
typedef struct TetcastVolume TetcastVolume;

typedef enum TetcastTraversal {
  TETCAST_TRAVERSAL_SHELL = 0, /* Embree holds the boundary; inside, rays walk from cell to cell through shared faces */
  TETCAST_TRAVERSAL_FACES /* Embree holds every cell, whose four faces are tested one by one and the crossings sorted:
                           * slow, needs no adjacency, for meshes whose parts overlap and for checking the walk */
} TetcastTraversal;

typedef struct TetcastVolumeDesc {
  uint32_t cookie;
  TetcastTraversal traversal;
  /* Not 0: scenes may be given fields of corners (TETCAST_CORNER). One byte more for each tetrahedron. Default 0. */
  int corners;
  TetcastProgress progress;
} TetcastVolumeDesc;

TETCAST_API TetcastVolumeDesc tetcast_volume_desc_default(void);

/* Prepares a mesh. Memory that is refused, also beneath the library, is TETCAST_ERROR_MEMORY, but for this: Embree and
 * TBB allocate for themselves, and can't bear a refusal everywhere. So what they need (16 MiB, and 96 bytes for each
 * face or cell that Embree holds) is tried first, and they are not begun with where it isn't there. Were the system to
 * refuse memory right after it gave that much, the process would end if the refusal met the few bytes in which Embree
 * notes a thread's errors, or TBB while it loads what it needs once in a process (it may then not end, but wait for
 * ever in the next call); or several threads that build together, which they do from 65536 faces or cells on. The same
 * holds for tetcast_scene_render() where only part of a volume can be seen.
 *
 * `desc` may be NULL (defaults). Cells with a vertex twice have no inside and are left out, as are
 * cells whose four vertices an earlier cell has; a warning counts them, and another one faces of three cells or more.
 * A mesh without cells is TETCAST_ERROR_DATA.
 *
 * Cells need not share vertices to be neighbours: vertices of different cells are one place if they lie within four
 * units in the last place of the mesh's largest coordinate along each axis, in the precision that the mesh has, unless
 * a cell has two of them. So files in which each
 * cell brings its own points have no gaps. Values stay each vertex's own: a point field may jump between such cells.
 * This costs memory, 16 bytes for each tetrahedron, and time only where there are such vertices. */
TETCAST_API TetcastStatus tetcast_volume_create(TetcastContext *context, const TetcastMesh *mesh,
                                                const TetcastVolumeDesc *desc, TetcastVolume **volume);

/* Frees the volume and sets *volume to NULL. NULL and pointer to NULL do nothing. Scenes of it must be gone. */
TETCAST_API void tetcast_volume_destroy(TetcastVolume **volume);

typedef struct TetcastVolumeInfo {
  int64_t vertices;     /* of the mesh */
  int64_t tetrahedra;   /* that can be crossed: the mesh's less those left out */
  int64_t left_out;     /* cells left out, see tetcast_volume_create() */
  int64_t welded;       /* vertices that lie where another one does, see tetcast_volume_create() */
  int64_t shell_faces;  /* faces (shell) or cells (faces) that Embree holds */
  size_t bytes;         /* resident memory: arrays of the volume and what Embree holds for it */
  double bounds[6];     /* of its cells: xmin, xmax, ymin, ymax, zmin, zmax */
  double boundary_area; /* area of the faces at which rays enter and leave */
  TetcastTraversal traversal;
} TetcastVolumeInfo;

TETCAST_API void tetcast_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info);

#ifdef __cplusplus
}
#endif

#endif
