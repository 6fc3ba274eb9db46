/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_TRAVERSE_TRACE_H
#define TC_TRAVERSE_TRACE_H

#include "traverse/rayspace.h"

/* What a ray meets in Embree. Shell: a face it crosses, at depth `begin`. Faces: a cell it crosses from begin to end, where the point
 * field is s0 and s1. */
typedef struct TcSpan {
  double begin, end, s0, s1;
  uint32_t id; /* shell face or cell */
  bool done;
} TcSpan;

/* A growing list, one per worker. */
typedef struct TcSpans {
  TetcastContext *context;
  TcSpan *data;
  int64_t count, capacity;
  bool out_of_memory;
} TcSpans;

/* Everything along the line, sorted by begin, end, id: the same order whatever order Embree finds it in. False: out of memory. */
bool tc_trace(const TcShell *shell, const TcRay *ray, TcSpans *spans);
bool tc_spans_grow(TcSpans *spans);
void tc_spans_sort(TcSpans *spans);
void tc_spans_clear(TcSpans *spans);

/* One more, for the caller to fill; NULL: out of memory. */
static inline TcSpan *tc_spans_append(TcSpans *spans) {
  return spans->count < spans->capacity || tc_spans_grow(spans) ? &spans->data[spans->count++] : NULL;
}

#endif
