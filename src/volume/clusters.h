/* SPDX-License-Identifier: Apache-2.0 */
/* Clusters: 64 cells that lie next to each other in memory and, as cells are ordered, in space. By a cluster's range of
 * values (rows.h) a transfer function tells whether anything of it can be seen. */
#ifndef TC_VOLUME_CLUSTERS_H
#define TC_VOLUME_CLUSTERS_H

#include "mesh/adjacency.h"

enum { TC_CLUSTER_BITS = 6, TC_CLUSTER = 1 << TC_CLUSTER_BITS };

/* Of a few cells the vertices are kept: from these "seeds" follow those of the cells of their cluster that faces
 * connect them with. About 0.7 bytes per cell. */
typedef struct TcClusters {
  TetcastContext *context;
  int64_t count;
  uint32_t *begin;      /* [count + 1]: first seed of each; one for each connected part of a cluster */
  uint32_t (*seeds)[3]; /* the smallest three vertices of each seed, ascending; the XOR gives the last */
  uint8_t *places;      /* of each seed within its cluster */
} TcClusters;

/* How many cells cluster c has: the last may have fewer. */
static inline int tc_cluster_size(const TcAdjacency *adjacency, int64_t c) {
  const int64_t left = adjacency->cell_count - (c << TC_CLUSTER_BITS);
  return left < TC_CLUSTER ? (int)left : TC_CLUSTER;
}

/* vertices[i]: of cell i, ascending. */
TetcastStatus tc_clusters_build(TetcastContext *context, const TcAdjacency *adjacency, const uint32_t (*vertices)[4],
                                TcClusters *clusters);
void tc_clusters_clear(TcClusters *clusters);
size_t tc_clusters_bytes(const TcClusters *clusters);

/* Number of cells of cluster c, and the vertices of each, ascending. */
int tc_cluster_cells(const TcClusters *clusters, const TcAdjacency *adjacency, int64_t c,
                     uint32_t vertices[TC_CLUSTER][4]);

#endif
