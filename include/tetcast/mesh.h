/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_MESH_H
#define TETCAST_MESH_H

#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Vertices and tetrahedra, as they came. Immutable; may be read from several threads at a time. */
typedef struct TetcastMesh TetcastMesh;

typedef struct TetcastMeshDesc {
  uint32_t cookie;
  TetcastArray vertices; /* [n, 3] float32 or float64, finite, any unit of length */
  TetcastArray
      tetrahedra; /* [m, 4] int32, uint32, int64 or uint64, each in [0, n); the order of a cell's vertices is free */
  TetcastOwnership ownership;
} TetcastMeshDesc;

TETCAST_API TetcastMeshDesc tetcast_mesh_desc_default(void);

/* Makes a mesh after checking that coordinates are finite, those of cells from −1e300 to 1e300, and indices in range
 * (TETCAST_ERROR_DATA names the first that is not). n and m may be zero; both must be below 2^31 − 1
 * (TETCAST_ERROR_LIMIT). */
TETCAST_API TetcastStatus tetcast_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **mesh);

/* Frees the mesh and sets *mesh to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_mesh_destroy(TetcastMesh **mesh);

TETCAST_API int64_t tetcast_mesh_vertex_count(const TetcastMesh *mesh);
TETCAST_API int64_t tetcast_mesh_tetrahedron_count(const TetcastMesh *mesh);

/* Views of the mesh's arrays, valid while it lives: [n, 3] and [m, 4], of the type they came in. */
TETCAST_API TetcastArray tetcast_mesh_vertices(const TetcastMesh *mesh);
TETCAST_API TetcastArray tetcast_mesh_tetrahedra(const TetcastMesh *mesh);

/* Vertices `vertices[3]` and indices `indices[4]` as double and int64; i must be in range. */
TETCAST_API void tetcast_mesh_vertex(const TetcastMesh *mesh, int64_t i, double position[3]);
TETCAST_API void tetcast_mesh_tetrahedron(const TetcastMesh *mesh, int64_t i, int64_t indices[4]);

/* Bounds of the vertices that tetrahedra use: xmin, xmax, ymin, ymax, zmin, zmax; all zero for a mesh without cells. */
TETCAST_API void tetcast_mesh_bounds(const TetcastMesh *mesh, double bounds[6]);

/* The health of a mesh. None of these keeps it from being rendered. */
typedef struct TetcastMeshHealth {
  int64_t boundary_faces;    /* faces of one cell only */
  int64_t nonmanifold_faces; /* faces of three cells or more */
  int64_t components;        /* sets of cells connected through faces */
  int64_t degenerate_cells;  /* volume zero as computed in double, or a vertex twice */
  int64_t inverted_cells; /* negative volume: (v1 − v0) × (v2 − v0) · (v3 − v0) < 0. Order is free: worth a look only
                             when mixed */
  int64_t duplicate_cells;     /* cells whose four vertices another cell before them has */
  int64_t unused_vertices;     /* vertices of no cell */
  int64_t coincident_vertices; /* used vertices whose coordinates another used vertex before them has: unmerged seams */
  double volume;               /* sum of the cells' absolute volumes */
  double boundary_area;        /* area of the faces at which rays enter and leave: boundary and, for each of its cells,
                                  non-manifold */
} TetcastMeshHealth;

/* Examines the mesh; about as long as preparing a volume of it. */
TETCAST_API TetcastStatus tetcast_mesh_health(TetcastContext *context, const TetcastMesh *mesh,
                                              TetcastMeshHealth *health);

#ifdef __cplusplus
}
#endif

#endif
