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

/* A mesh prepared for casting rays: which cells meet at which faces, and the boundary's faces, at which rays enter and
 * leave, in Embree. It is made once for a mesh, whatever fields are seen on it, and refers to nothing of the mesh,
 * which may be destroyed then. */
typedef struct TetcastVolume TetcastVolume;

/* How the cells that a ray crosses are found. */
typedef enum TetcastTraversal {
  /* Embree holds the boundary; inside, rays walk from cell to cell through shared faces. */
  TETCAST_TRAVERSAL_SHELL = 0,
  /* Embree holds every cell; each cell's four faces are tested and the crossings are sorted. This is slow, but needs no
   * adjacency: for meshes whose parts overlap, and to check the walk by. */
  TETCAST_TRAVERSAL_FACES
} TetcastTraversal;

/* How a volume is made. */
typedef struct TetcastVolumeDesc {
  /* Set by tetcast_volume_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* How the cells that a ray crosses are found. Default: TETCAST_TRAVERSAL_SHELL. */
  TetcastTraversal traversal;
  /* Not 0: scenes may be given fields of corners (TETCAST_CORNER), for one byte more per tetrahedron. Default: 0. */
  int corners;
  /* [6], xmin, xmax, ymin, ymax, zmin, zmax: the bounds of a larger mesh of which this one is a part; finite, from
   * −1e300 to 1e300, around all of the mesh's cells (TETCAST_ERROR_ARGUMENT). Where rays meet vertices is rounded in a
   * frame of coordinates that follows from the bounds. So parts with the same bounds, and the whole with these, see
   * vertices of the same coordinates, in arrays of the same type, at the same place to the bit, if they use the same
   * instruction set (TetcastRenderDesc.isa): a ray passes a vertex or an edge on the same side in all of them, however
   * the parts number their vertices, and where they meet it is neither lost nor counted twice. For that, vertices are
   * projected for each picture, however few rays it has. What lies at one place without having the same coordinates
   * (tetcast_volume_create()) is joined within a part only. NULL (the default): the mesh's own bounds, as it is no
   * part. */
  const double *bounds;
  /* Called while the volume is made (context.h). Default: not called. */
  TetcastProgress progress;
} TetcastVolumeDesc;

/* Makes a desc with every setting at its default. */
TETCAST_API TetcastVolumeDesc tetcast_volume_desc_default(void);

/* Prepares a mesh. `desc` may be NULL (defaults). Cells with a vertex twice have no inside and are left out, as are
 * cells whose four vertices an earlier cell has; a warning counts them, and another one counts faces of three cells or
 * more. A mesh without cells is TETCAST_ERROR_DATA.
 *
 * Cells need not share vertices to be neighbours. Vertices of different cells count as one place if they lie within
 * four units in the last place of the mesh's largest coordinate along each axis, in the precision that the mesh has,
 * unless one cell has both of them, or one's volume would change by more than an eighth. So there are no gaps in files
 * in which each cell has points of its own. Values stay each vertex's own, so that a point field may jump between such
 * cells. Where there are such vertices, this takes time, and 16 bytes for each tetrahedron.
 *
 * Where memory is refused, the call fails with TETCAST_ERROR_MEMORY, also if that happens beneath the library. There is
 * one exception: Embree and TBB allocate for themselves, and not all of their code copes with a refusal. So what they
 * need (16 MiB, and 96 bytes for each face or cell that Embree holds) is allocated and freed before they are called. If
 * the system refuses memory nevertheless right after that, the process may end: when Embree allocates the few bytes in
 * which it notes a thread's errors, when TBB loads what it needs once in a process (it may then
 * not end, but wait for ever in the next call), or when several threads build
 * together, which they do from 65536 faces or cells on. The same holds for tetcast_scene_render() where only part of a
 * volume can be seen. */
TETCAST_API TetcastStatus tetcast_volume_create(TetcastContext *context, const TetcastMesh *mesh,
                                                const TetcastVolumeDesc *desc, TetcastVolume **volume);

/* Frees the volume and sets *volume to NULL. NULL and pointer to NULL do nothing. Scenes of it must be gone. */
TETCAST_API void tetcast_volume_destroy(TetcastVolume **volume);

/* Describes a volume. */
typedef struct TetcastVolumeInfo {
  /* The number of the mesh's vertices. */
  int64_t vertices;
  /* The number of tetrahedra that can be crossed: the mesh's without those left out. */
  int64_t tetrahedra;
  /* The number of cells left out (tetcast_volume_create()), and of those that the mesh hides. */
  int64_t left_out;
  /* The number of vertices that count as one place with another vertex (tetcast_volume_create()). */
  int64_t welded;
  /* The number of faces (TETCAST_TRAVERSAL_SHELL) or cells (TETCAST_TRAVERSAL_FACES) that Embree holds. */
  int64_t shell_faces;
  /* The resident memory in bytes: the volume's arrays, and what Embree holds for it. */
  size_t bytes;
  /* The bounds of the volume's cells: xmin, xmax, ymin, ymax, zmin, zmax. */
  double bounds[6];
  /* The area of the faces at which rays enter and leave, in the mesh's unit of length squared. */
  double boundary_area;
  /* How the cells that a ray crosses are found. */
  TetcastTraversal traversal;
} TetcastVolumeInfo;

/* Describes the volume. */
TETCAST_API void tetcast_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info);

#ifdef __cplusplus
}
#endif

#endif
