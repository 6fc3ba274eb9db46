/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/hits.h"

#include <stdlib.h>
#include <string.h>

enum { FEW = 32 };

bool tc_hits_grow(TcHits *hits) {
  const int64_t capacity = hits->capacity ? 2 * hits->capacity : 64;
  TcHit *data = tc_allocate(hits->context, capacity, sizeof *data);
  if (!data) {
    hits->out_of_memory = true;
    return false;
  }
  if (hits->count)
    memcpy(data, hits->data, (size_t)hits->count * sizeof *data);
  tc_release(hits->context, hits->data);
  hits->data = data;
  hits->capacity = capacity;
  return true;
}

static int compare_hits(const void *left, const void *right) {
  const TcHit *a = left, *b = right;
  if (a->begin != b->begin)
    return a->begin < b->begin ? -1 : 1;
  if (a->end != b->end)
    return a->end < b->end ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

void tc_hits_sort(TcHits *hits) {
  if (hits->count == 2 && compare_hits(&hits->data[0], &hits->data[1]) <= 0)
    return;
  if (hits->count > FEW) {
    qsort(hits->data, (size_t)hits->count, sizeof *hits->data, compare_hits);
    return;
  }
  for (int64_t i = 1; i < hits->count; ++i) {
    const TcHit moved = hits->data[i];
    int64_t at = i;
    for (; at > 0 && compare_hits(&moved, &hits->data[at - 1]) < 0; --at)
      hits->data[at] = hits->data[at - 1];
    hits->data[at] = moved;
  }
}

void tc_hits_clear(TcHits *hits) {
  tc_release(hits->context, hits->data);
  hits->data = NULL;
  hits->count = hits->capacity = 0;
}
