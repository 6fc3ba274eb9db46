/* SPDX-License-Identifier: Apache-2.0 */
/* Sorts records by number, and vertices along a space-filling curve, in parallel. Results don't depend on the number of
 * threads. */
#ifndef TC_MESH_ORDER_H
#define TC_MESH_ORDER_H

#include "mesh/mesh.h"

/* A record: a key in the upper 32 bits, a value in the lower. */
static inline uint64_t tc_record(uint32_t key, uint32_t value) {
  return (uint64_t)key << 32 | value;
}
static inline uint32_t tc_record_key(uint64_t record) {
  return (uint32_t)(record >> 32);
}
static inline uint32_t tc_record_value(uint64_t record) {
  return (uint32_t)record;
}

/* Sorts *records by their keys, which are ≤ largest. Records with equal keys keep their order. The two arrays, each of
 * `count`, may change places. */
TetcastStatus tc_sort_records(TetcastContext *context, uint64_t **records, uint64_t **scratch, int64_t count,
                              uint32_t largest);

/* The first of `count` sorted records whose key is ≥ key, or `count`. */
int64_t tc_find_record(const uint64_t *records, int64_t count, uint32_t key);

/* The place of a point along Hilbert's curve through a grid of (2^20)³; `at` below 2^20. */
uint64_t tc_hilbert_index(const uint32_t at[3]);

/* The mesh's vertices along Hilbert's curve through the cube around its bounds: order[i] is the mesh's vertex at place
 * i. Vertices of the same grid point keep their order. Working memory 28 bytes per vertex. The caller frees *order. */
TetcastStatus tc_order_vertices(const TetcastMesh *mesh, uint32_t **order);

#endif
