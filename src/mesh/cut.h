/* SPDX-License-Identifier: Apache-2.0 */
/* What cutting cells into tetrahedra is made of: one straight cell, the lattice of a curved one, the vertices that are
 * added. */
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

/* Corners and the faces between them. Of a polyhedron made for the occasion; `tc_shape()` has those of fixed types. */
typedef struct TcShape {
  uint32_t corners, faces;
  const uint32_t *size;   /* [faces]: corners of each */
  const uint32_t *corner; /* theirs, face after face, counterclockwise as seen from outside */
  bool hexahedron;
  bool either_way; /* programs don't agree about which way round it is: its tetrahedra come out positive */
  bool *turned;    /* [faces]: those that are clockwise; NULL: none */
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

enum { TC_FIXED_CORNERS = 12, TC_FIXED_TETS = 20 }; /* the most that a shape with a name has and is cut into */

/* Memory for a cell and what it is cut into. */
typedef struct TcTets {
  uint32_t *id;       /* [corners]: indices of vertices */
  int exponent;       /* of the unit, a power of two, in which … */
  double (*p)[3];     /* [corners + 1]: … they are there; the last for the centre */
  uint32_t (*tet)[4]; /* [corners of all faces]: of places in `id`; `corners` is the centre */
  int64_t count;      /* of tet */
  bool centred;
  double positive,
      negative; /* six times the volumes of those that are the right way round as the cell came, and of the others */
  bool flat;    /* whether one has next to no volume */
} TcTets;

/* Cuts the cell at pieces->id and p. */
void tc_cut_shape(const TcShape *shape, TcTets *pieces);

/* The tetrahedra of a hexahedron from its corner `first`, of the smallest vertex, by the indices alone. */
int64_t tc_cone_hexahedron(const uint32_t *id, uint32_t first, uint32_t (*tet)[4]);

/* Whether tetrahedra of both signs overlap by more than coordinates of single precision explain. */
bool tc_is_folded(double positive, double negative);
bool tc_has_twice(const uint32_t *id, uint32_t count);

/* Makes faces that are given either way round agree with each other, as shape->turned; edge: [corners of all faces],
 * link: [faces]. False if an edge has not two faces. */
typedef struct TcEdge {
  uint32_t a, b, face;
  bool backward;
} TcEdge;
bool tc_orient_faces(const TcShape *shape, TcEdge *edge, uint32_t *link);

/* ── hexahedra by table (cut_hexahedron.c) ── */

typedef struct TcHexahedra {
  uint8_t face[8][3][4];  /* the faces without a corner, from the corner opposite it on */
  uint8_t third[8];       /* the neighbour of that opposite corner that the first of these faces has not */
  uint8_t quad[64][3][4]; /* these from an end of their diagonal on */
  uint8_t count[64];      /* of tetrahedra */
  uint8_t tet[64][6][4];  /* their corners */
} TcHexahedra;

void tc_hexahedra_make(TcHexahedra *table);
/* Which of the 64 ways. */
int tc_hexahedra_find(const TcHexahedra *table, const uint32_t id[8]);
/* Whether all the tetrahedra are the right way round, none of them flat. */
bool tc_hexahedra_fits(const TcHexahedra *table, int way, const double (*p)[3]);

/* ── vertices that are added (cut_points.c) ── */

/* What neighbours know a point by: up to four vertices and their shares in it, in lowest terms. */
typedef struct TcPointKey {
  uint32_t vertex[4], share[4];
} TcPointKey;

typedef struct TcPoints {
  TetcastContext *context;
  int64_t count, entries;
  int64_t *start;   /* [count + 1] */
  uint32_t *source; /* [entries]: vertices, all of them of the input */
  double *weight;   /* [entries] */
  int64_t point_room, entry_room;
  /* only while curved cells are looked at */
  double (*p)[3];
  TcPointKey *key;
  uint32_t *slot; /* [slots]: a point + 1, 0 is free */
  int64_t slots;
} TcPoints;

/* Room for that many points and entries in all. False after a message. */
bool tc_points_reserve(TcPoints *points, int64_t count, int64_t entries);
int64_t tc_points_find(const TcPoints *points, const TcPointKey *key); /* −1 if there is none */
/* A new point, whose sources and weights the caller appends before, from points->start[points->count] on: `entries` of
 * them. */
bool tc_points_add(TcPoints *points, const TcPointKey *key, const double p[3], int64_t entries);
void tc_points_forget_keys(TcPoints *points);
void tc_points_clear(TcPoints *points);

/* ── the lattice of a curved cell (cut_lattice.c) ── */

typedef struct TcLattice {
  TcShapeName shape;
  int order[3];    /* of the shape functions */
  int segments[3]; /* that edges are cut into */
  int nodes;       /* a lattice of `order` with more points lacks those beyond */
  bool bezier;
  bool centred; /* of second order, with nodes in the middles of its triangles and of the cell as well */
} TcLattice;

enum { TC_MAX_ORDER = 10 };

bool tc_is_curved(unsigned type);
int tc_curved_nodes(unsigned type); /* 0: any number */
/* False if a cell of this type can't have that many nodes or this order (NULL: as the number says). `subdivision` as in
 * the description. */
bool tc_lattice_make(unsigned type, int64_t nodes, const double order[3], int subdivision, TcLattice *lattice);

/* Points are numbered as if the lattice were a box: (i, j, k) has i + (segments + 1) (j + (segments + 1) k). */
int64_t tc_lattice_size(const TcLattice *lattice);
/* Moves on to the next point of the lattice in this order, from {−1, 0, 0}; false after the last. */
bool tc_lattice_next(const TcLattice *lattice, int at[3]);
int64_t tc_lattice_index(const TcLattice *lattice, const int at[3]);
/* The node at a point; −1 if there is none. */
int tc_lattice_node(const TcLattice *lattice, const int at[3]);
/* The same of a cell with a corner twice, some points of which are one: the first node of those that are one with this.
 */
int tc_lattice_shared_node(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell);
/* The shape functions of all nodes at a point. */
void tc_lattice_weights(const TcLattice *lattice, const int at[3], double *weight);
/* What a point is known by; `ids` are the cell's nodes, `cell` its number. */
TcPointKey tc_lattice_key(const TcLattice *lattice, const int at[3], const uint32_t *ids, int64_t cell);

/* Calls `use` for each straight cell between points of the lattice. */
typedef void TcPartFunction(void *user, TcShapeName shape, const uint32_t *points);
void tc_lattice_parts(const TcLattice *lattice, TcPartFunction *use, void *user);

/* What cutting makes. */
struct TetcastCut {
  TetcastContext *context;
  int64_t vertex_count; /* of the input */
  int32_t (*tetrahedra)[4];
  int32_t *sources; /* NULL if not wanted */
  TcPoints points;
  TetcastCutInfo info;
};

#endif
