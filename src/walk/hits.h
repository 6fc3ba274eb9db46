/* SPDX-License-Identifier: Apache-2.0 */
/* Hits: the faces or cells that a ray meets in Embree. */
#ifndef TC_WALK_HITS_H
#define TC_WALK_HITS_H

#include "base/base.h"

/* A face of the shell that the ray crosses, at depth `begin`; where Embree holds cells, a cell that it crosses from
 * begin to end. */
typedef struct TcHit {
  double begin, end;
  uint32_t id; /* of the face or cell */
  bool done;   /* whether the path that begins or ends there was walked already */
} TcHit;

/* A growing list of a ray's hits. */
typedef struct TcHits {
  TetcastContext *context;
  TcHit *data;
  int64_t count, capacity;
  bool out_of_memory;
} TcHits;

/* Makes room for more. False if memory has run out, which is noted. */
bool tc_hits_grow(TcHits *hits);
/* Sorts by begin, end and id, so that the order doesn't depend on the order in which Embree finds hits. */
void tc_hits_sort(TcHits *hits);
void tc_hits_clear(TcHits *hits);

/* Appends a hit for the caller to fill. NULL if memory has run out. */
static inline TcHit *tc_hits_append(TcHits *hits) {
  return hits->count < hits->capacity || tc_hits_grow(hits) ? &hits->data[hits->count++] : NULL;
}

#endif
