/* SPDX-License-Identifier: Apache-2.0 */
/* Cutting cells into tetrahedra, and its parts: cutting one straight cell, the lattice of a curved cell, and the
 * vertices that are added. */
#ifndef TC_MESH_CUT_H
#define TC_MESH_CUT_H

#include <tetcast/cells.h>

#include "mesh/mesh.h"

/* ── all of it (cut.c) ── */

int64_t tc_cell_nodes(unsigned type); /* 0: any number, or no such type */
TetcastStatus tc_cells_cut(TetcastContext *context, const TetcastCellsDesc *desc, TetcastCut **cut);
void tc_cut_destroy(TetcastCut *cut);
TetcastArray tc_cut_tetrahedra(const TetcastCut *cut);
TetcastArray tc_cut_sources(const TetcastCut *cut);
const TetcastCutInfo *tc_cut_info(const TetcastCut *cut);
bool tc_cut_interpolate(const TetcastCut *cut, const TetcastArray *values, int components, double *result);

/* ── one straight cell (cut_cell.c) ── */

/* The corners of a cell and the faces between them. A polyhedron's is made when it is cut; tc_shape() has those of the
 * types with fixed shapes. */
typedef struct TcShape {
  uint32_t corners, faces;
  const uint32_t *size;   /* [faces]: the number of corners of each face */
  const uint32_t *corner; /* the corners of one face after the other, counterclockwise as seen from outside */
  bool hexahedron;
  bool either_way; /* programs don't agree about its orientation, so its tetrahedra are made positive */
  bool *turned;    /* [faces]: whether a face's corners are clockwise; NULL if none are */
} TcShape;

typedef enum TcShapeName {
  TC_TETRAHEDRON,
  TC_HEXAHEDRON,
  TC_WEDGE,
  TC_PYRAMID,
  TC_PENTAGONAL_PRISM,
  TC_HEXAGONAL_PRISM,
  TC_OCTAHEDRON,
  TC_SHAPES
} TcShapeName;

const TcShape *tc_shape(TcShapeName name);

/* The most corners that a shape with a name has, and the most tetrahedra that it is cut into. */
enum { TC_FIXED_CORNERS = 12, TC_FIXED_TETS = 20 };

/* Memory for a cell and what it is cut into. */
typedef struct TcTets {
  uint32_t *id;       /* [corners]: the indices of the cell's vertices */
  int exponent;       /* positions are in units of 2^exponent */
  double (*p)[3];     /* [corners + 1]: the positions of these vertices; the last is for the centre */
  uint32_t (*tet)[4]; /* [corners of all faces]: tetrahedra, as places in `id`; the number of corners is the centre */
  int64_t count;      /* the number of tetrahedra */
  bool centred;       /* whether a vertex in the cell's middle was added */
  double positive; /* six times the volume of the tetrahedra whose volume is positive, as the cell's nodes are given */
  double negative; /* six times the absolute volume of the others */
  bool flat;       /* whether some tetrahedron has next to no volume */
} TcTets;

/* Cuts the cell with vertices tets->id at tets->p. */
void tc_cut_shape(const TcShape *shape, TcTets *tets);

/* Cuts a hexahedron into tetrahedra that all have its corner `first`, which has the smallest index, by the indices
 * alone. Returns their number. */
int64_t tc_cone_hexahedron(const uint32_t *id, uint32_t first, uint32_t (*tet)[4]);

/* Whether tetrahedra of both signs overlap by more than coordinates of single precision explain. */
bool tc_is_folded(double positive, double negative);

/* Whether an index is there twice. */
bool tc_has_twice(const uint32_t *id, uint32_t count);

/* An edge of a face. */
typedef struct TcEdge {
  uint32_t a, b, face; /* a < b */
  bool backward;       /* whether the face goes from b to a */
} TcEdge;

/* Finds which faces have to be turned round so that all of them agree about what is outside, and notes it in
 * shape->turned. `edge` [corners of all faces] and `link` [faces] are working memory. False if some edge doesn't have
 * two faces. */
bool tc_orient_faces(const TcShape *shape, TcEdge *edge, uint32_t *link);

/* ── hexahedra by table (cut_hexahedron.c) ── */

typedef struct TcHexahedra {
  uint8_t face[8][3][4];  /* the three faces without a given corner; each begins at the corner opposite the given one */
  uint8_t third[8];       /* the neighbour of that opposite corner that is not in the first of these faces */
  uint8_t quad[64][3][4]; /* for each way to cut: these faces, each beginning at an end of its diagonal */
  uint8_t count[64];      /* for each way to cut: the number of tetrahedra */
  uint8_t tet[64][6][4];  /* for each way to cut: the corners of the tetrahedra */
} TcHexahedra;

void tc_hexahedra_make(TcHexahedra *table);
/* Which of the 64 ways to cut is taken for a hexahedron with these indices. */
int tc_hexahedra_find(const TcHexahedra *table, const uint32_t id[8]);
/* Whether, cut in this way, all tetrahedra have a positive volume. */
bool tc_hexahedra_fits(const TcHexahedra *table, int way, const double (*p)[3]);

/* ── vertices that are added (cut_points.c) ── */

/* The name by which neighbours find the same point: up to four vertices and their shares in it, in lowest terms. */
typedef struct TcPointKey {
  uint32_t vertex[4], share[4];
} TcPointKey;

/* The vertices that are added. Each is a weighted mean of vertices of the input. */
typedef struct TcCutPoints {
  TetcastContext *context;
  int64_t count, entries;         /* the number of points, and of all their sources */
  int64_t *start;                 /* [count + 1]: where the sources of each point begin */
  uint32_t *source;               /* [entries]: vertices of the input */
  double *weight;                 /* [entries]: the weight of each source */
  int64_t point_room, entry_room; /* how many points and entries there is memory for */

  /* The following exist only while curved cells are cut. */
  double (*p)[3];  /* [count]: the positions */
  TcPointKey *key; /* [count] */
  uint32_t *slot;  /* [slots]: a hash table of the points' numbers + 1; 0 is free */
  int64_t slots;
} TcCutPoints;

/* Makes room for that many points and entries in all. False after a message if memory has run out. */
bool tc_cut_points_reserve(TcCutPoints *points, int64_t count, int64_t entries);
int64_t tc_cut_points_find(const TcCutPoints *points, const TcPointKey *key); /* −1 if there is none */
/* Adds a point. The caller has stored its sources and weights before, `entries` of them from
 * points->start[points->count] on. */
bool tc_cut_points_add(TcCutPoints *points, const TcPointKey *key, const double p[3], int64_t entries);
void tc_cut_points_forget_keys(TcCutPoints *points);
void tc_cut_points_clear(TcCutPoints *points);

/* ── the lattice of a curved cell (cut_lattice.c) ── */

typedef struct TcLattice {
  TcShapeName shape;
  int order[3];    /* the degrees of the shape functions along the axes */
  int segments[3]; /* the number of pieces that edges along the axes are cut into */
  int nodes;       /* the number of nodes; if it is less than that of the lattice's points, the last ones have none */
  bool bezier;
  bool with_middles; /* a cell of second order with nodes in the middles of its triangles and of the cell */
} TcLattice;

enum { TC_MAX_ORDER = 10 };

bool tc_is_curved(unsigned type);
int tc_curved_nodes(unsigned type); /* 0: any number */
/* Makes the lattice of a cell. False if a cell of this type can't have that many nodes or this order (NULL: the number
 * of nodes tells it). `subdivision` is as in TetcastCellsDesc. */
bool tc_lattice_make(unsigned type, int64_t nodes, const double order[3], int subdivision, TcLattice *lattice);

/* Points are numbered as if the lattice were a box: (i, j, k) has i + (segments + 1) (j + (segments + 1) k). */
int64_t tc_lattice_size(const TcLattice *lattice);
/* Moves on to the next point of the lattice in this order, from {−1, 0, 0}; false after the last. */
bool tc_lattice_next(const TcLattice *lattice, int at[3]);
int64_t tc_lattice_index(const TcLattice *lattice, const int at[3]);
/* The number of the node at a point; −1 if there is none. */
int tc_lattice_node(const TcLattice *lattice, const int at[3]);
/* The same for a cell with a corner twice, in which several points are one: the first of the nodes that lie there. */
int tc_lattice_shared_node(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell);
/* The values of all nodes' shape functions at a point. */
void tc_lattice_weights(const TcLattice *lattice, const int at[3], double *weight);
/* The key of a point. `ids` are the cell's nodes, `cell` is its number. */
TcPointKey tc_lattice_key(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell);

/* Is called for each straight cell between points of the lattice. */
typedef void TcPartFunction(void *user, TcShapeName shape, const uint32_t *points);

/* Cuts a lattice into straight cells and calls `use` for each of them. */
void tc_lattice_parts(const TcLattice *lattice, TcPartFunction *use, void *user);

struct TetcastCut {
  TetcastContext *context;
  int64_t vertex_count; /* of the input */
  int32_t (*tetrahedra)[4];
  int32_t *sources; /* NULL if not wanted */
  TcCutPoints points;
  TetcastCutInfo info;
};

#endif
