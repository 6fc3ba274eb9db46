/* SPDX-License-Identifier: Apache-2.0 */
/* What a ray meets in Embree. */
#ifndef TC_WALK_HITS_H
#define TC_WALK_HITS_H

#include "base/base.h"

/* A face of the shell that the ray crosses, at depth `begin`; where Embree holds cells, a cell that it crosses from
 * begin to end. */
typedef struct TcHit {
  double begin, end;
  uint32_t id; /* of the face or cell */
  bool done;   /* no path is to be walked from there any more */
} TcHit;

/* A growing list of a ray's hits. */
typedef struct TcHits {
  TetcastContext *context;
  TcHit *data;
  int64_t count, capacity;
  bool out_of_memory;
} TcHits;

bool tc_hits_grow(TcHits *hits);
/* By begin, end, id: the same order whatever order Embree finds them in. */
void tc_hits_sort(TcHits *hits);
void tc_hits_clear(TcHits *hits);

/* One more, for the caller to fill; NULL: out of memory. */
static inline TcHit *tc_hits_append(TcHits *hits) {
  return hits->count < hits->capacity || tc_hits_grow(hits) ? &hits->data[hits->count++] : NULL;
}

#endif
