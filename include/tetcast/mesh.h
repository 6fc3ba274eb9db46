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

/* Vertices and tetrahedra, as they were given. Immutable; may be read from several threads at a time. */
typedef struct TetcastMesh TetcastMesh;

/* What a mesh is made from. */
typedef struct TetcastMeshDesc {
  /* Set by tetcast_mesh_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [n, 3] float32 or float64: the coordinates of the vertices, finite, in any unit of length. None: `coordinates` has
   * them. */
  TetcastArray vertices;
  /* [m, 4] int32, uint32, int64 or uint64, each in [index_base, index_base + n): the vertices of each tetrahedron, in
   * any order. */
  TetcastArray tetrahedra;
  /* Whether the arrays are copied (the default) or borrowed. */
  TetcastOwnership ownership;
  /* The number that `tetrahedra` has for the first vertex: 0 (the default), or 1 as in Fortran. Arrays are borrowed
   * with either. What tetcast_mesh_create() says of vertices and tetrahedra counts both from there; all else in the
   * library counts from 0. */
  int index_base;
  /* [n] each: x, y and z of the vertices in arrays apart, in place of `vertices`: all float32 or all float64, each with
   * a stride of its own, copied or borrowed as the others. Default: none. */
  TetcastArray coordinates[3];
  /* [m] sets of bits, such as VTK's marks of ghost cells: cells with any of `hidden_bits` are left out of all that is
   * made of the mesh: volumes, bounds, health, statistics. They keep their numbers, and their values in fields of cells
   * and of corners. Copied or borrowed as the others. NULL (the default): no cell is hidden. */
  const uint8_t *hidden;
  /* The bits of `hidden` that hide a cell: above 0 if and only if `hidden` is given (TETCAST_ERROR_ARGUMENT). Default:
   * 0.
   */
  uint8_t hidden_bits;
} TetcastMeshDesc;

/* Makes a desc of an empty mesh that copies its arrays. */
TETCAST_API TetcastMeshDesc tetcast_mesh_desc_default(void);

/* Makes a mesh after checking that coordinates are finite, those of cells from −1e300 to 1e300, and indices in range
 * (TETCAST_ERROR_DATA names the first that is not). n and m may be zero; both must be below 2^31 − 1
 * (TETCAST_ERROR_LIMIT). */
TETCAST_API TetcastStatus tetcast_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **mesh);

/* Frees the mesh and sets *mesh to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_mesh_destroy(TetcastMesh **mesh);

/* The number of vertices n. */
TETCAST_API int64_t tetcast_mesh_vertex_count(const TetcastMesh *mesh);

/* The number of tetrahedra m, hidden ones included. */
TETCAST_API int64_t tetcast_mesh_tetrahedron_count(const TetcastMesh *mesh);

/* [n, 3]: the vertices, of the type they came in; valid while the mesh lives. Its data is NULL where coordinates came
 * in arrays apart. */
TETCAST_API TetcastArray tetcast_mesh_vertices(const TetcastMesh *mesh);

/* [m, 4]: the tetrahedra, of the type they came in, counting vertices from tetcast_mesh_index_base(); valid while the
 * mesh lives. */
TETCAST_API TetcastArray tetcast_mesh_tetrahedra(const TetcastMesh *mesh);

/* The number that the array of tetrahedra has for the first vertex, 0 or 1: as it was given. */
TETCAST_API int tetcast_mesh_index_base(const TetcastMesh *mesh);

/* The coordinates of vertex i in [0, n) as doubles. */
TETCAST_API void tetcast_mesh_vertex(const TetcastMesh *mesh, int64_t i, double position[3]);

/* The vertices of tetrahedron i in [0, m), each in [0, n). */
TETCAST_API void tetcast_mesh_tetrahedron(const TetcastMesh *mesh, int64_t i, int64_t indices[4]);

/* Not 0 if tetrahedron i in [0, m) is hidden. */
TETCAST_API int tetcast_mesh_hides(const TetcastMesh *mesh, int64_t i);

/* Bounds of the vertices that tetrahedra use, but for hidden ones: xmin, xmax, ymin, ymax, zmin, zmax; all zero for a
 * mesh without cells. */
TETCAST_API void tetcast_mesh_bounds(const TetcastMesh *mesh, double bounds[6]);

/* The health of a mesh. None of what is counted here keeps it from being rendered. */
typedef struct TetcastMeshHealth {
  /* The number of faces of one cell only. */
  int64_t boundary_faces;
  /* The number of faces of three cells or more. */
  int64_t nonmanifold_faces;
  /* The number of parts of the mesh that no shared faces connect with each other. */
  int64_t components;
  /* The number of cells with a volume of zero, as computed in double precision, or with a vertex twice. */
  int64_t degenerate_cells;
  /* The number of cells with a negative volume: (v1 − v0) × (v2 − v0) · (v3 − v0) < 0. As the order of a cell's
   * vertices is free, this tells of a fault only where some cells are inverted and others are not. */
  int64_t inverted_cells;
  /* The number of cells with the same four vertices as a cell before them. */
  int64_t duplicate_cells;
  /* The number of vertices that no cell uses. */
  int64_t unused_vertices;
  /* The number of used vertices with the same coordinates as a used vertex before them, as at unmerged seams. */
  int64_t coincident_vertices;
  /* The sum of the cells' absolute volumes, in the mesh's unit of length cubed. */
  double volume;
  /* The area of the faces at which rays enter and leave, in the mesh's unit of length squared: boundary faces once, and
   * faces of three cells or more once for each of their cells. */
  double boundary_area;
} TetcastMeshHealth;

/* Examines the mesh. That takes about as long as preparing a volume of it. */
TETCAST_API TetcastStatus tetcast_mesh_health(TetcastContext *context, const TetcastMesh *mesh,
                                              TetcastMeshHealth *health);

#ifdef __cplusplus
}
#endif

#endif
