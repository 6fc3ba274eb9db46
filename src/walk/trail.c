/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/trail.h"

#include <string.h>

enum {
  FIRST = 256,
  FEW = 32 /* so many are left at least after lists have grown, so that they need not grow soon again */
};

static bool grow(TcTrail *trail, TcTrailList *list) {
  const int64_t capacity = list->capacity ? 2 * list->capacity : FIRST;
  TetcastCrossing *data = tc_allocate(trail->context, capacity + 1, sizeof *data);
  if (!data) {
    trail->out_of_memory = true;
    return false;
  }
  if (list->count)
    memcpy(data, list->data, (size_t)list->count * sizeof *data);
  /* What is not wanted is 0, and never written again; and so is what lies between the members. */
  memset(data + list->count, 0, (size_t)(capacity + 1 - list->count) * sizeof *data);
  tc_release(trail->context, list->data);
  list->data = data;
  list->capacity = capacity;
  return true;
}

bool tc_trail_grow(TcTrail *trail, int first, int count) {
  for (int i = first; i < first + count; ++i) {
    if (trail->list[i].capacity - trail->list[i].count < FEW && !grow(trail, &trail->list[i]))
      return false;
  }
  return true;
}

void tc_trail_restart(TcTrail *trail) {
  trail->taken = 0;
  for (int i = 0; i < TC_TRAIL_LISTS; ++i)
    trail->list[i].count = 0;
}

void tc_trail_clear(TcTrail *trail) {
  for (int i = 0; i < TC_TRAIL_LISTS; ++i) {
    tc_release(trail->context, trail->list[i].data);
    trail->list[i] = (TcTrailList){0};
  }
}
