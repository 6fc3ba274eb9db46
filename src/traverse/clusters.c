/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/clusters.h"

#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 256 };

typedef struct Build {
  const TcAdjacency *adjacency;
  const uint32_t (*vertices)[4];
  TcClusters *clusters;
} Build;

static int cell_count(const TcAdjacency *adjacency, int64_t c) {
  const int64_t left = adjacency->cell_count - (c << TC_CLUSTER_BITS);
  return left < TC_CLUSTER ? (int)left : TC_CLUSTER;
}

/* The cells of cluster c that faces within it connect with `first`, as bits. */
static uint64_t connected(const TcAdjacency *adjacency, int64_t c, int first) {
  uint64_t found = UINT64_C(1) << first, open = found;
  while (open) {
    const int i = __builtin_ctzll(open);
    open &= open - 1;
    const TcCell *cell = &adjacency->cells[(c << TC_CLUSTER_BITS) + i];
    for (int k = 0; k < 4; ++k) {
      if (cell->neighbor[k] & TC_SHELL || cell->neighbor[k] >> TC_CLUSTER_BITS != (uint64_t)c) continue;
      const uint64_t bit = UINT64_C(1) << (cell->neighbor[k] & (TC_CLUSTER - 1));
      open |= bit & ~found;
      found |= bit;
    }
  }
  return found;
}

/* The cells of cluster c that become seeds, as bits. */
static uint64_t seeds_of(const TcAdjacency *adjacency, int64_t c) {
  const int count = cell_count(adjacency, c);
  uint64_t left = count < 64 ? (UINT64_C(1) << count) - 1 : UINT64_MAX, seeds = 0;
  while (left) {
    const int first = __builtin_ctzll(left);
    seeds |= UINT64_C(1) << first;
    left &= ~connected(adjacency, c, first);
  }
  return seeds;
}

static bool count_seeds(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) build->clusters->begin[c + 1] = (uint32_t)__builtin_popcountll(seeds_of(build->adjacency, c));
  return true;
}

static bool take_seeds(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) {
    TcSeed *seed = &build->clusters->seeds[build->clusters->begin[c]];
    for (uint64_t bits = seeds_of(build->adjacency, c); bits; bits &= bits - 1, ++seed) {
      seed->cell = (uint32_t)((c << TC_CLUSTER_BITS) + __builtin_ctzll(bits));
      memcpy(seed->vertex, build->vertices[seed->cell], sizeof seed->vertex);
    }
  }
  return true;
}

TetcastStatus tc_clusters_build(TetcastContext *context, const TcAdjacency *adjacency, const uint32_t (*vertices)[4],
                                TcClusters *clusters) {
  memset(clusters, 0, sizeof *clusters);
  clusters->context = context;
  clusters->count = (adjacency->cell_count + TC_CLUSTER - 1) >> TC_CLUSTER_BITS;
  Build build = {adjacency, vertices, clusters};
  if (!tc_allocate_array(context, (void **)&clusters->begin, clusters->count + 1, sizeof *clusters->begin, "clusters") ||
      !tc_allocate_array(context, (void **)&clusters->range, clusters->count, sizeof *clusters->range, "clusters")) {
    tc_clusters_clear(clusters);
    return TETCAST_ERROR_MEMORY;
  }
  clusters->begin[0] = 0;
  tc_parallel_for(context, clusters->count, GRAIN, count_seeds, &build, NULL);
  for (int64_t c = 0; c < clusters->count; ++c) clusters->begin[c + 1] += clusters->begin[c];
  if (!tc_allocate_array(context, (void **)&clusters->seeds, clusters->begin[clusters->count], sizeof *clusters->seeds, "clusters")) {
    tc_clusters_clear(clusters);
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(context, clusters->count, GRAIN, take_seeds, &build, NULL);
  return TETCAST_OK;
}

void tc_clusters_clear(TcClusters *clusters) {
  if (!clusters->context) return;
  tc_release(clusters->context, clusters->begin);
  tc_release(clusters->context, clusters->seeds);
  tc_release(clusters->context, clusters->range);
  memset(clusters, 0, sizeof *clusters);
}

size_t tc_clusters_bytes(const TcClusters *clusters) {
  if (!clusters->seeds) return 0;
  const size_t count = (size_t)clusters->count;
  return (count + 1) * sizeof *clusters->begin + count * sizeof *clusters->range + clusters->begin[count] * sizeof *clusters->seeds;
}

/* The neighbour across the face opposite vertex k of a cell: three of its vertices are the same. */
static void vertices_across(const uint32_t v[4], int k, uint32_t vertex_xor, uint32_t across[4]) {
  uint32_t last = vertex_xor;
  int n = 0;
  for (int j = 0; j < 4; ++j) {
    if (j == k) continue;
    last ^= v[j];
    across[n++] = v[j];
  }
  for (; n > 0 && across[n - 1] > last; --n) across[n] = across[n - 1];
  across[n] = last;
}

int tc_cluster_cells(const TcClusters *clusters, const TcAdjacency *adjacency, int64_t c, uint32_t vertices[TC_CLUSTER][4]) {
  uint64_t found = 0, open = 0;
  for (uint32_t i = clusters->begin[c]; i < clusters->begin[c + 1]; ++i) {
    const TcSeed *seed = &clusters->seeds[i];
    const int at = seed->cell & (TC_CLUSTER - 1);
    memcpy(vertices[at], seed->vertex, sizeof seed->vertex);
    open |= UINT64_C(1) << at;
  }
  found = open;
  while (open) {
    const int i = __builtin_ctzll(open);
    open &= open - 1;
    const TcCell *cell = &adjacency->cells[(c << TC_CLUSTER_BITS) + i];
    for (int k = 0; k < 4; ++k) {
      const uint32_t next = cell->neighbor[k];
      if (next & TC_SHELL || next >> TC_CLUSTER_BITS != (uint64_t)c) continue;
      const uint64_t bit = UINT64_C(1) << (next & (TC_CLUSTER - 1));
      if (found & bit) continue;
      vertices_across(vertices[i], k, adjacency->cells[next].vertex_xor, vertices[next & (TC_CLUSTER - 1)]);
      open |= bit;
      found |= bit;
    }
  }
  return cell_count(adjacency, c);
}
