/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/clusters.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 256 };

typedef struct Build {
  const TcAdjacency *adjacency;
  const uint32_t (*vertices)[4];
  TcClusters *clusters;
  uint64_t *found; /* [clusters]: seeds_of() each */
} Build;

/* The cells of cluster c that share a face with its cell i, as bits. */
static uint64_t neighbors_of(const TcAdjacency *adjacency, int64_t c, int i) {
  const uint32_t *neighbor = adjacency->cells[(c << TC_CLUSTER_BITS) + i].neighbor;
  uint64_t bits = 0;
  for (int k = 0; k < 4; ++k)
    bits |= (uint64_t)(neighbor[k] >> TC_CLUSTER_BITS == (uint64_t)c) << (neighbor[k] & (TC_CLUSTER - 1));
  return bits;
}

/* The cells of cluster c that become seeds, as bits: the first of each part that faces connect. */
static uint64_t seeds_of(const TcAdjacency *adjacency, int64_t c) {
  const int count = tc_cluster_size(adjacency, c);
  uint64_t left = count < 64 ? (UINT64_C(1) << count) - 1 : UINT64_MAX, seeds = 0;
  while (left) {
    uint64_t open = left & -left;
    seeds |= open;
    while (open) {
      left &= ~open;
      const int i = __builtin_ctzll(open);
      open = (open & (open - 1)) | (neighbors_of(adjacency, c, i) & left);
    }
  }
  return seeds;
}

static bool find_seeds(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) {
    build->found[c] = seeds_of(build->adjacency, c);
    build->clusters->begin[c + 1] = (uint32_t)__builtin_popcountll(build->found[c]);
  }
  return true;
}

static bool take_seeds(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Build *build = data;
  for (int64_t c = begin; c < end; ++c) {
    uint32_t seed = build->clusters->begin[c];
    for (uint64_t bits = build->found[c]; bits; bits &= bits - 1, ++seed) {
      const int place = __builtin_ctzll(bits);
      build->clusters->places[seed] = (uint8_t)place;
      memcpy(build->clusters->seeds[seed], build->vertices[(c << TC_CLUSTER_BITS) + place],
             sizeof *build->clusters->seeds);
    }
  }
  return true;
}

static TetcastStatus build_clusters(Build *build) {
  TcClusters *clusters = build->clusters;
  TetcastContext *context = clusters->context;
  if (!tc_allocate_array(context, (void **)&clusters->begin, clusters->count + 1, sizeof *clusters->begin,
                         "clusters") ||
      !tc_allocate_array(context, (void **)&build->found, clusters->count, sizeof *build->found, "clusters")) {
    return TETCAST_ERROR_MEMORY;
  }
  clusters->begin[0] = 0;
  tc_parallel_for(context, clusters->count, GRAIN, find_seeds, build, NULL);
  for (int64_t c = 0; c < clusters->count; ++c)
    clusters->begin[c + 1] += clusters->begin[c];
  const int64_t seeds = clusters->begin[clusters->count];
  if (!tc_allocate_array(context, (void **)&clusters->seeds, seeds, sizeof *clusters->seeds, "clusters") ||
      !tc_allocate_array(context, (void **)&clusters->places, seeds, sizeof *clusters->places, "clusters")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(context, clusters->count, GRAIN, take_seeds, build, NULL);
  return TETCAST_OK;
}

TetcastStatus tc_clusters_build(TetcastContext *context, const TcAdjacency *adjacency, const uint32_t (*vertices)[4],
                                TcClusters *clusters) {
  *clusters = (TcClusters){.context = context, .count = (adjacency->cell_count + TC_CLUSTER - 1) >> TC_CLUSTER_BITS};
  Build build = {.adjacency = adjacency, .vertices = vertices, .clusters = clusters};
  const TetcastStatus status = build_clusters(&build);
  tc_release(context, build.found);
  if (status)
    tc_clusters_clear(clusters);
  return status;
}

void tc_clusters_clear(TcClusters *clusters) {
  if (!clusters->context)
    return;
  tc_release(clusters->context, clusters->begin);
  tc_release(clusters->context, clusters->seeds);
  tc_release(clusters->context, clusters->places);
  memset(clusters, 0, sizeof *clusters);
}

size_t tc_clusters_bytes(const TcClusters *clusters) {
  if (!clusters->seeds)
    return 0;
  const size_t count = (size_t)clusters->count;
  return (count + 1) * sizeof *clusters->begin + clusters->begin[count] * (sizeof *clusters->seeds + 1);
}

/* The neighbour across the face opposite vertex k of a cell: three of its vertices are the same, the last goes where it
 * belongs. */
static void vertices_across(const uint32_t v[4], int k, uint32_t vertex_xor, uint32_t across[4]) {
  static const unsigned char others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  uint32_t last = vertex_xor;
  for (int j = 0; j < 3; ++j)
    last ^= v[others[k][j]];
  for (int j = 0; j < 3; ++j) {
    const uint32_t shared = v[others[k][j]], less = last < shared ? last : shared;
    last = last < shared ? shared : last;
    across[j] = less;
  }
  across[3] = last;
}

int tc_cluster_cells(const TcClusters *clusters, const TcAdjacency *adjacency, int64_t c,
                     uint32_t vertices[TC_CLUSTER][4]) {
  const TcCell *cells = adjacency->cells + (c << TC_CLUSTER_BITS);
  uint64_t open = 0;
  for (uint32_t i = clusters->begin[c]; i < clusters->begin[c + 1]; ++i) {
    const int at = clusters->places[i];
    const uint32_t *seed = clusters->seeds[i];
    memcpy(vertices[at], seed, sizeof *clusters->seeds);
    vertices[at][3] = cells[at].vertex_xor ^ seed[0] ^ seed[1] ^ seed[2];
    open |= UINT64_C(1) << at;
  }
  uint64_t left = ~open;
  while (open) {
    const int i = __builtin_ctzll(open);
    uint64_t fresh = neighbors_of(adjacency, c, i) & left;
    left &= ~fresh;
    open = (open & (open - 1)) | fresh;
    for (; fresh; fresh &= fresh - 1) {
      const int j = __builtin_ctzll(fresh);
      const uint32_t *neighbor = cells[i].neighbor, next = (uint32_t)(c << TC_CLUSTER_BITS) + (uint32_t)j;
      const int k = (neighbor[1] == next) + 2 * (neighbor[2] == next) + 3 * (neighbor[3] == next);
      vertices_across(vertices[i], k, cells[j].vertex_xor, vertices[j]);
    }
  }
  return tc_cluster_size(adjacency, c);
}
