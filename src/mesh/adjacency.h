/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_MESH_ADJACENCY_H
#define TC_MESH_ADJACENCY_H

#include "mesh/mesh.h"

/* A cell in 20 bytes (Aman, Demirci, Güdükbay: Compact tetrahedralization-based acceleration structures for ray
 * tracing, 2022). With three vertices of the face it was entered through, the XOR gives the fourth. Neighbour k is the
 * one across the face opposite the k-th smallest vertex. */
typedef struct TcCell {
  uint32_t vertex_xor;
  uint32_t neighbor[4]; /* a cell, or TC_SHELL | shell face */
} TcCell;

#define TC_SHELL UINT32_C(0x80000000)

/* A face with a cell on one side only, where rays enter and leave. */
typedef struct TcShellFace {
  uint32_t vertex[3];
  uint32_t cell;
} TcShellFace;

typedef struct TcAdjacency {
  TetcastContext *context;
  int64_t cell_count, shell_count;
  TcCell *cells;           /* [cell_count], and room for one more */
  TcShellFace *shell;      /* [shell_count] */
  uint32_t (*vertices)[4]; /* [cell_count], ascending, if they were asked for */
  uint32_t *source;        /* [cell_count]: the mesh's cell */
  int64_t hidden;          /* the number of cells that the mesh hides */
  int64_t collapsed;       /* the number of cells left out as they have a vertex twice */
  int64_t duplicates;      /* the number of cells left out as an earlier cell has the same four vertices */
  int64_t boundary;        /* the number of faces of one cell */
  int64_t nonmanifold;     /* the number of faces of three cells or more; each is a shell face of all of them */
} TcAdjacency;

/* Finds which cells meet at which faces. Vertex v of the mesh is rank[v] in the result (NULL: v itself). Cells are
 * sorted by their vertices, in ascending order: so if vertices that are neighbours in memory are neighbours in space,
 * cells are as well. This takes at most 48 bytes per cell, result included (adjacency.c). The result does not depend on
 * the number of threads. Cleared on error. */
TetcastStatus tc_adjacency_build(const TetcastMesh *mesh, const uint32_t *rank, bool keep_vertices,
                                 const TetcastProgress *progress, TcAdjacency *adjacency);
/* Frees cells and shell, leaving the vertices. */
void tc_adjacency_drop_links(TcAdjacency *adjacency);
void tc_adjacency_clear(TcAdjacency *adjacency);

/* The four vertices of a cell in ascending order; without branches, which no processor could foresee. */
static inline void tc_sort4(uint32_t v[4]) {
  uint32_t a = v[0], b = v[1], c = v[2], d = v[3];
#define TC_SORT2(x, y)                                                                                                 \
  do {                                                                                                                 \
    const uint32_t t = x < y ? x : y;                                                                                  \
    y = x < y ? y : x;                                                                                                 \
    x = t;                                                                                                             \
  } while (0)
  TC_SORT2(a, b);
  TC_SORT2(c, d);
  TC_SORT2(a, c);
  TC_SORT2(b, d);
  TC_SORT2(b, c);
#undef TC_SORT2
  v[0] = a;
  v[1] = b;
  v[2] = c;
  v[3] = d;
}

#endif
