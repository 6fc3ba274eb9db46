/* SPDX-License-Identifier: Apache-2.0 */
#include "gather/fragment_list.h"

#include <string.h>

bool tc_fragment_list_grow(TcFragmentList *list) {
  const int64_t capacity = list->capacity ? 2 * list->capacity : 1024;
  const size_t row = (size_t)list->width * sizeof *list->groups;
  TetcastFragment *data = tc_allocate(list->context, capacity, sizeof *data);
  double *groups = data && row ? tc_allocate(list->context, capacity, row) : NULL;
  if (!data || (row && !groups)) {
    tc_release(list->context, data);
    list->out_of_memory = true;
    return false;
  }
  if (list->count)
    memcpy(data, list->data, (size_t)list->count * sizeof *data);
  if (list->count && row)
    memcpy(groups, list->groups, (size_t)list->count * row);
  tc_release(list->context, list->data);
  tc_release(list->context, list->groups);
  list->data = data;
  list->groups = groups;
  list->capacity = capacity;
  return true;
}

void tc_fragment_list_clear(TcFragmentList *list) {
  tc_release(list->context, list->data);
  tc_release(list->context, list->groups);
  list->data = NULL;
  list->groups = NULL;
  list->count = list->capacity = 0;
}
