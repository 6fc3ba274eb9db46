/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/trail.h"

#include <string.h>

/* Four times as much as the longest step takes, to begin with. */
enum { FIRST = 1 << 12 };

bool tc_trail_grow(TcTrail *trail) {
  const int64_t capacity = trail->capacity ? 2 * trail->capacity : FIRST;
  double *data = tc_allocate(trail->context, capacity, sizeof *data);
  if (!data) {
    trail->out_of_memory = true;
    return false;
  }
  if (trail->count)
    memcpy(data, trail->data, (size_t)trail->count * sizeof *data);
  tc_release(trail->context, trail->data);
  trail->data = data;
  trail->capacity = capacity;
  return true;
}

void tc_trail_clear(TcTrail *trail) {
  tc_release(trail->context, trail->data);
  trail->data = NULL;
  trail->count = trail->capacity = 0;
}
