/* SPDX-License-Identifier: Apache-2.0 */
/* A growing list of the fragments that a worker has gathered. */
#ifndef TC_GATHER_FRAGMENT_LIST_H
#define TC_GATHER_FRAGMENT_LIST_H

#include <tetcast/fragments.h>

#include "base/base.h"

typedef struct TcFragmentList {
  TetcastContext *context;
  TetcastFragment *data;
  double *groups; /* [count][width]: with coefficients, radiance and optical depth of each group in turn */
  int64_t width;  /* twice the number of groups; 0 without coefficients */
  int64_t count, capacity;
  bool out_of_memory;
} TcFragmentList;

/* Makes room for more. False if memory has run out, which is noted. */
bool tc_fragment_list_grow(TcFragmentList *list);
void tc_fragment_list_clear(TcFragmentList *list);

/* Appends a fragment for the caller to fill. NULL if memory has run out. */
static inline TetcastFragment *tc_fragment_list_append(TcFragmentList *list) {
  return list->count < list->capacity || tc_fragment_list_grow(list) ? &list->data[list->count++] : NULL;
}

/* [width]: the groups of the fragment that was appended last, for the caller to fill. */
static inline double *tc_fragment_list_groups(TcFragmentList *list) {
  return list->groups + (list->count - 1) * list->width;
}

#endif
