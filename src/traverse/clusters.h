/* SPDX-License-Identifier: Apache-2.0 */
/* Clusters: 64 cells that lie next to each other in memory and, as cells are ordered, in space. Each has its range of values, by which
 * a transfer function tells whether anything of it can be seen. */
#ifndef TC_TRAVERSE_CLUSTERS_H
#define TC_TRAVERSE_CLUSTERS_H

#include "mesh/adjacency.h"

enum { TC_CLUSTER_BITS = 6, TC_CLUSTER = 1 << TC_CLUSTER_BITS };

/* A cell whose vertices are known, from which those of the cells of its cluster follow that faces connect it with. */
typedef struct TcSeed {
  uint32_t cell, vertex[4];
} TcSeed;

/* About 1 byte per cell. */
typedef struct TcClusters {
  TetcastContext *context;
  int64_t count;
  uint32_t *begin;     /* [count + 1]: first seed of each */
  TcSeed *seeds;       /* one for each connected part of a cluster */
  float (*range)[2];   /* [count]: all values of the cluster lie in it, NaN apart; (∞, −∞) if there are none but NaN */
} TcClusters;

/* vertices[i]: of cell i, ascending. */
TetcastStatus tc_clusters_build(TetcastContext *context, const TcAdjacency *adjacency, const uint32_t (*vertices)[4],
                                TcClusters *clusters);
void tc_clusters_clear(TcClusters *clusters);
size_t tc_clusters_bytes(const TcClusters *clusters);

/* Number of cells of cluster c, and the vertices of each, ascending. */
int tc_cluster_cells(const TcClusters *clusters, const TcAdjacency *adjacency, int64_t c, uint32_t vertices[TC_CLUSTER][4]);

#endif
