/* SPDX-License-Identifier: Apache-2.0 */
#include "gather/fragment_list.h"

#include <string.h>

bool tc_fragment_list_grow(TcFragmentList *list) {
  const int64_t capacity = list->capacity ? 2 * list->capacity : 1024;
  TetcastFragment *data = tc_allocate(list->context, capacity, sizeof *data);
  if (!data) {
    list->out_of_memory = true;
    return false;
  }
  if (list->count)
    memcpy(data, list->data, (size_t)list->count * sizeof *data);
  tc_release(list->context, list->data);
  list->data = data;
  list->capacity = capacity;
  return true;
}

void tc_fragment_list_clear(TcFragmentList *list) {
  tc_release(list->context, list->data);
  list->data = NULL;
  list->count = list->capacity = 0;
}
