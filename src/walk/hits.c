/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/hits.h"

#include <stdlib.h>
#include <string.h>

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
  if (hits->count > 1)
    qsort(hits->data, (size_t)hits->count, sizeof *hits->data, compare_hits);
}

void tc_hits_clear(TcHits *hits) {
  tc_release(hits->context, hits->data);
  hits->data = NULL;
  hits->count = hits->capacity = 0;
}
