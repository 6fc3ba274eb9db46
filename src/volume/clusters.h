/* SPDX-License-Identifier: Apache-2.0 */
/* Clusters: 64 cells that lie next to each other in memory and, as cells are ordered, in space. From the
 * range of a field's values in a cluster (rows.h) it follows whether a transfer function leaves anything of it visible.
 */
#ifndef TC_VOLUME_CLUSTERS_H
#define TC_VOLUME_CLUSTERS_H

#include "mesh/adjacency.h"

enum { TC_CLUSTER_BITS = 6, TC_CLUSTER = 1 << TC_CLUSTER_BITS };

/* The vertices of a few cells, the seeds, are kept. From a seed's vertices follow those of all cells of its cluster
 * that are connected with it by faces. This takes about 0.7 bytes per cell. */
typedef struct TcClusters {
  TetcastContext *context;
  int64_t count;
  uint32_t *begin;      /* [count + 1]: each cluster's first seed; every connected part of a cluster has one */
  uint32_t (*seeds)[3]; /* the smallest three vertices of each seed, ascending; the XOR gives the last */
  uint8_t *places;      /* the number of each seed within its cluster */
} TcClusters;

/* The number of cells of cluster c. The last cluster may have fewer than the others. */
static inline int tc_cluster_size(const TcAdjacency *adjacency, int64_t c) {
  const int64_t left = adjacency->cell_count - (c << TC_CLUSTER_BITS);
  return left < TC_CLUSTER ? (int)left : TC_CLUSTER;
}

/* Makes the clusters. vertices[i] are those of cell i in ascending order. */
TetcastStatus tc_clusters_build(TetcastContext *context, const TcAdjacency *adjacency, const uint32_t (*vertices)[4],
                                TcClusters *clusters);
void tc_clusters_clear(TcClusters *clusters);
size_t tc_clusters_bytes(const TcClusters *clusters);

/* Computes the vertices of each cell of cluster c, in ascending order. Returns the number of cells. */
int tc_cluster_cells(const TcClusters *clusters, const TcAdjacency *adjacency, int64_t c,
                     uint32_t vertices[TC_CLUSTER][4]);

#endif
