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
  /* curved: their nodes make a lattice, or one with gaps */
  TETCAST_CELL_QUADRATIC_TETRAHEDRON = 24,
  TETCAST_CELL_QUADRATIC_HEXAHEDRON = 25,
  TETCAST_CELL_QUADRATIC_WEDGE = 26,
  TETCAST_CELL_QUADRATIC_PYRAMID = 27,
  TETCAST_CELL_TRIQUADRATIC_HEXAHEDRON = 29,
  TETCAST_CELL_QUADRATIC_LINEAR_WEDGE = 31,
  TETCAST_CELL_BIQUADRATIC_QUADRATIC_WEDGE = 32,
  TETCAST_CELL_BIQUADRATIC_QUADRATIC_HEXAHEDRON = 33,
  TETCAST_CELL_TRIQUADRATIC_PYRAMID = 37, /* its nodes within triangles and within the cell are not used */
  TETCAST_CELL_LAGRANGE_TETRAHEDRON =
      71, /* with 15 nodes of second order, with nodes in the middles of faces and of the cell */
  TETCAST_CELL_LAGRANGE_HEXAHEDRON = 72,
  TETCAST_CELL_LAGRANGE_WEDGE = 73, /* with 21 nodes the same */
  TETCAST_CELL_BEZIER_TETRAHEDRON = 78,
  TETCAST_CELL_BEZIER_HEXAHEDRON = 79,
  TETCAST_CELL_BEZIER_WEDGE = 80
} TetcastCellType;

enum { TETCAST_MAX_SUBDIVISION = 16 };

/* Cells as simulations have them. All is referred to during the call only. */
typedef struct TetcastCellsDesc {
  uint32_t cookie;
  TetcastArray vertices; /* [n, 3] float32 or float64 */
  const uint8_t *types;  /* [m] of TetcastCellType; a cell of any other number gives nothing. NULL: all are of `type` */
  TetcastCellType type;
  TetcastArray offsets; /* [m + 1] integers: the nodes of cell i are connectivity[offsets[i]] … connectivity[offsets[i +
                           1] − 1] */
  TetcastArray connectivity; /* [k] integers in [0, n). Without offsets: [m, nodes of a cell of `type`], which is not a
                                polyhedron then */
  TetcastArray faces; /* [f] integers, for polyhedra: number of faces, then for each its number of corners and these, in
                       * turn, either way round; all are among the cell's nodes */
  TetcastArray face_offsets; /* [m] integers: where a polyhedron begins in `faces`; of other cells not looked at */
  TetcastArray orders;   /* [m, 3] of any type: degrees of Lagrange and Bezier cells. None: as the number of nodes says,
                            the same all ways */
  TetcastArray rational; /* [n] of any type: weights of a rational Bezier cell's nodes. None: all 1 */
  const uint8_t *hidden; /* [m]: cells with any of the `hidden_bits` give nothing (ghosts); NULL: none */
  uint8_t hidden_bits;
  int subdivision; /* what each edge of a curved cell is cut into, to TETCAST_MAX_SUBDIVISION; 0: as its nodes lie */
  bool sources;    /* whether tetcast_cut_sources() is wanted: 4 bytes a tetrahedron */
} TetcastCellsDesc;

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
 * three the same. Cells that it has cut already don't match uncut neighbours here: where the face between them is plane
 * nothing is lost, where it is warped, what is between the two ways to cut it. (Cones from the smallest vertex serve
 * polyhedra with any faces as well.)
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

/* [t, 4] int32, for TetcastMeshDesc.tetrahedra, and [t] int32: the cell that each is of; none if not asked for. Valid
 * while `cut` lives. */
TETCAST_API TetcastArray tetcast_cut_tetrahedra(const TetcastCut *cut);
TETCAST_API TetcastArray tetcast_cut_sources(const TetcastCut *cut);

/* Values at the added vertices of what has `values` ([n, components]; n as many as the cells' vertices) at the others:
 * positions, fields. result[added_vertices][components]. False if `values` has not n tuples of a known type. */
TETCAST_API bool tetcast_cut_interpolate(const TetcastCut *cut, const TetcastArray *values, int components,
                                         double *result);

/* What there was to do. A cell is counted in each line that it belongs to. */
typedef struct TetcastCutInfo {
  int64_t cells; /* cells of these types that are not hidden */
  int64_t tetrahedra;
  int64_t added_vertices; /* after the n there were */
  int64_t curved;         /* cells that were subdivided first */
  int segments[2];   /* the fewest and most pieces that one of their edges was cut into; 0, 0 without curved cells */
  int64_t centred;   /* cells, or parts of curved ones, that got a vertex in their middle */
  int64_t collapsed; /* cells with a node twice */
  int64_t inverted;  /* cells whose nodes are in the mirrored order; not told of wedges and polyhedra */
  int64_t folded;    /* cells whose tetrahedra overlap by more than a millionth: far from convex, or tangled */
  int64_t open;      /* polyhedra whose faces don't close: an edge that has not two of them */
  int64_t empty;     /* cells that gave no tetrahedron */
  int64_t oversized; /* cells with more nodes than their type has: the rest is ignored */
} TetcastCutInfo;

TETCAST_API void tetcast_cut_info(const TetcastCut *cut, TetcastCutInfo *info);

#ifdef __cplusplus
}
#endif

#endif
