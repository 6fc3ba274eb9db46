/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CELLS_H
#define TETCAST_CELLS_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Cells that can be cut into tetrahedra. The numbers are VTK's, and so are the orders of a cell's nodes. */
typedef enum TetcastCellType {
  TETCAST_CELL_TETRAHEDRON = 10,
  TETCAST_CELL_VOXEL = 11,
  TETCAST_CELL_HEXAHEDRON = 12,
  TETCAST_CELL_WEDGE = 13,
  TETCAST_CELL_PYRAMID = 14,
  TETCAST_CELL_PENTAGONAL_PRISM = 15,
  TETCAST_CELL_HEXAGONAL_PRISM = 16,
  TETCAST_CELL_POLYHEDRON = 42,
  /* The following are curved: their nodes make a lattice, or one with gaps. */
  TETCAST_CELL_QUADRATIC_TETRAHEDRON = 24,
  TETCAST_CELL_QUADRATIC_HEXAHEDRON = 25,
  TETCAST_CELL_QUADRATIC_WEDGE = 26,
  TETCAST_CELL_QUADRATIC_PYRAMID = 27,
  TETCAST_CELL_TRIQUADRATIC_HEXAHEDRON = 29,
  TETCAST_CELL_QUADRATIC_LINEAR_WEDGE = 31,
  TETCAST_CELL_BIQUADRATIC_QUADRATIC_WEDGE = 32,
  TETCAST_CELL_BIQUADRATIC_QUADRATIC_HEXAHEDRON = 33,
  /* Its nodes within triangles and within the cell are not used. */
  TETCAST_CELL_TRIQUADRATIC_PYRAMID = 37,
  /* With 15 nodes it is of second order, with nodes in the middles of its faces and in its own middle. */
  TETCAST_CELL_LAGRANGE_TETRAHEDRON = 71,
  TETCAST_CELL_LAGRANGE_HEXAHEDRON = 72,
  /* With 21 nodes it is of second order, with nodes in the middles of its faces and in its own middle. */
  TETCAST_CELL_LAGRANGE_WEDGE = 73,
  TETCAST_CELL_BEZIER_TETRAHEDRON = 78,
  TETCAST_CELL_BEZIER_HEXAHEDRON = 79,
  TETCAST_CELL_BEZIER_WEDGE = 80
} TetcastCellType;

/* The most pieces that an edge of a curved cell can be cut into. */
enum { TETCAST_MAX_SUBDIVISION = 16 };

/* Cells as simulations have them: m cells with nodes among n vertices. The arrays are referred to during the call only.
 * Without a word about it, an array's default is none. */
typedef struct TetcastCellsDesc {
  /* Set by tetcast_cells_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [n, 3] float32 or float64: the coordinates of the vertices, in any unit of length. */
  TetcastArray vertices;
  /* [m] of TetcastCellType: the type of each cell. A cell of any other number gives no tetrahedra. NULL (the default):
   * all cells are of `type`. */
  const uint8_t *types;
  /* The type of all cells where `types` is NULL. Default: TETCAST_CELL_HEXAHEDRON. */
  TetcastCellType type;
  /* [m + 1] integers: the nodes of cell i are connectivity[offsets[i]] to connectivity[offsets[i + 1] − 1]. None: all
   * cells are of `type`, which must have a fixed number of nodes. */
  TetcastArray offsets;
  /* [k] integers in [0, n): the nodes of one cell after the other. Without offsets: [m, nodes of a cell]. */
  TetcastArray connectivity;
  /* [f] integers, for polyhedra only: a cell's number of faces, then for each face its number of corners and these
   * corners in turn, either way round. All of them are among the cell's nodes. */
  TetcastArray faces;
  /* [m] integers, for polyhedra only: the place in `faces` at which cell i begins. Of other cells it is not used. */
  TetcastArray face_offsets;
  /* [m, 3] of any type: the degrees of Lagrange and Bezier cells along their axes. None: the number of nodes tells the
   * degree, the same along all axes. */
  TetcastArray orders;
  /* [n] of any type: the weights of the nodes of rational Bezier cells. None: all are 1. */
  TetcastArray rational;
  /* [m] sets of bits, such as VTK's marks of ghost cells: cells with any of `hidden_bits` give no tetrahedra. NULL (the
   * default): no cell is hidden. */
  const uint8_t *hidden;
  /* The bits of `hidden` that hide a cell. Default: 0, none. */
  uint8_t hidden_bits;
  /* The number of pieces that each edge of a curved cell is cut into, at most TETCAST_MAX_SUBDIVISION. Default: 0, as
   * many as the edge's nodes make. */
  int subdivision;
  /* Whether tetcast_cut_sources() is wanted, which takes 4 bytes for each tetrahedron. Default: false. */
  bool sources;
} TetcastCellsDesc;

/* Makes a desc of no cells. */
TETCAST_API TetcastCellsDesc tetcast_cells_desc_default(void);

/* Tetrahedra that cells were cut into. Immutable; may be read from several threads at a time. */
typedef struct TetcastCut TetcastCut;

/* Cuts cells so that neighbours agree, whatever their types and however their nodes are numbered: a face is cut by the
 * diagonals through its vertex of smallest index (Dompierre et al. 1999), and a cell into the pyramids from its vertex
 * of smallest index to the faces without it. Where these overlap (none do in a convex cell with plane faces), and
 * pyramids from the mean of the cell's vertices overlap less, that becomes a vertex; so it does in polyhedra some of
 * whose faces are in one plane. Either way the tetrahedra's signed volumes add up to what the cell's surface encloses,
 * positive for cells whose nodes are in VTK's order; wedges (about which programs disagree) and polyhedra are always
 * positive.
 *
 * vtkDataSetTriangleFilter takes the other way: its diagonals avoid a face's vertex of largest index, in two faces of
 * three the same. Cells that it has cut already don't match uncut neighbours here. If the face between them is plane,
 * that makes no difference; if it is warped, there is a gap or an overlap between the two ways to cut it. (This
 * library's way was chosen as it serves polyhedra with any faces as well.)
 *
 * Curved cells are first cut into straight ones between points of their lattice, at which all fields are as the cell's
 * shape functions say. Neighbours share the points of the face between them.
 *
 * Vertices keep their indices; those added come after them, and every field has a value there that is a linear
 * combination of the values at the cell's own nodes: see tetcast_cut_interpolate(). A field linear in space stays so,
 * to rounding.
 *
 * Tetrahedra that would have a vertex twice (cells with a node twice: a wedge written as a hexahedron) are dropped,
 * which leaves faces matched; flat ones with four vertices are needed for that and stay. Tetrahedra are in the order of
 * the cells; the result does not depend on the number of threads.
 *
 * TETCAST_ERROR_DATA names the first cell with an index out of range, too few nodes, an order that doesn't go with
 * their number, or a damaged list of faces. TETCAST_ERROR_LIMIT: vertices, cells or tetrahedra beyond 2^31 − 2. */
TETCAST_API TetcastStatus tetcast_cells_cut(TetcastContext *context, const TetcastCellsDesc *desc, TetcastCut **cut);

/* Frees it and sets *cut to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_cut_destroy(TetcastCut **cut);

/* [t, 4] int32: the tetrahedra, for TetcastMeshDesc.tetrahedra. Valid while `cut` lives. */
TETCAST_API TetcastArray tetcast_cut_tetrahedra(const TetcastCut *cut);

/* [t] int32: the cell that each tetrahedron is a part of; none if it was not asked for. Valid while `cut` lives. */
TETCAST_API TetcastArray tetcast_cut_sources(const TetcastCut *cut);

/* Computes the values at the added vertices of a quantity (positions, a field) that has `values` ([n, components]) at
 * the cells' n vertices, into result[added_vertices][components]. False unless `values` has n tuples of a known type.
 */
TETCAST_API bool tetcast_cut_interpolate(const TetcastCut *cut, const TetcastArray *values, int components,
                                         double *result);

/* What cutting has come to. A cell is counted in every number that it belongs to. */
typedef struct TetcastCutInfo {
  /* The number of cells of the types above that are not hidden. */
  int64_t cells;
  /* The number of tetrahedra. */
  int64_t tetrahedra;
  /* The number of vertices that were added after the cells' n vertices. */
  int64_t added_vertices;
  /* The number of curved cells, which were cut into straight ones first. */
  int64_t curved;
  /* The fewest and the most pieces that an edge of a curved cell was cut into; 0 and 0 without curved cells. */
  int segments[2];
  /* The number of cells, or parts of curved ones, that were given a vertex in their middle. */
  int64_t centred;
  /* The number of cells with a node twice. */
  int64_t collapsed;
  /* The number of cells whose nodes are in the mirrored order. Wedges and polyhedra are never counted. */
  int64_t inverted;
  /* The number of cells whose tetrahedra overlap by more than a millionth: they are far from convex, or tangled. */
  int64_t folded;
  /* The number of polyhedra whose faces don't close: some edge doesn't have two faces. */
  int64_t open;
  /* The number of cells that gave no tetrahedron. */
  int64_t empty;
  /* The number of cells with more nodes than their type has, of which the surplus is ignored. */
  int64_t oversized;
} TetcastCutInfo;

/* Tells what cutting has come to. */

TETCAST_API void tetcast_cut_info(const TetcastCut *cut, TetcastCutInfo *info);

#ifdef __cplusplus
}
#endif

#endif
