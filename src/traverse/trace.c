/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/trace.h"

#include <stdlib.h>
#include <string.h>

typedef struct Query {
  const TcShell *shell;
  const TcRay *ray;
  TcSpans *spans;
} Query;

void tc_spans_append(TcSpans *spans, TcSpan span) {
  if (spans->count == spans->capacity) {
    const int64_t capacity = spans->capacity ? 2 * spans->capacity : 64;
    TcSpan *data = tc_allocate(spans->context, capacity, sizeof *data);
    if (!data) {
      spans->out_of_memory = true;
      return;
    }
    if (spans->count) memcpy(data, spans->data, (size_t)spans->count * sizeof *data);
    tc_release(spans->context, spans->data);
    spans->data = data;
    spans->capacity = capacity;
  }
  spans->data[spans->count++] = span;
}

/* Depth and value where the ray crosses the triangle of three of the points, if it does. */
static bool crosses(const TcPoint *a, const TcPoint *b, const TcPoint *c, double *z, double *s) {
  const double ab = tc_edge(a, b), bc = tc_edge(b, c), ca = tc_edge(c, a);
  if (!tc_inside(ab, bc, ca)) return false;
  tc_crossing(a, b, c, ab, bc, ca, z, s);
  return true;
}

static void shell_candidate(void *user, uint32_t i) {
  Query *query = user;
  const TcShellFace *face = &query->shell->faces[i];
  TcPoint p[3];
  for (int k = 0; k < 3; ++k) p[k] = tc_project(query->shell->volume, query->ray, face->vertex[k]);
  TcSpan span = {.id = i};
  if (!crosses(&p[0], &p[1], &p[2], &span.begin, &span.s0)) return;
  span.end = span.begin;
  tc_spans_append(query->spans, span);
}

/* A ray crosses none or exactly two of a cell's faces. */
static void cell_candidate(void *user, uint32_t i) {
  Query *query = user;
  const uint32_t *vertex = query->shell->volume->adjacency.vertices[i];
  TcPoint p[4];
  for (int k = 0; k < 4; ++k) p[k] = tc_project(query->shell->volume, query->ray, vertex[k]);
  double z[2], s[2];
  int found = 0;
  for (int k = 0; k < 4 && found < 2; ++k) {
    found += crosses(&p[k], &p[(k + 1) & 3], &p[(k + 2) & 3], &z[found], &s[found]);
  }
  if (found < 2) return;
  const int first = z[1] < z[0];
  tc_spans_append(query->spans, (TcSpan){.begin = z[first], .end = z[!first], .s0 = s[first], .s1 = s[!first], .id = i});
}

static int compare_spans(const void *left, const void *right) {
  const TcSpan *a = left, *b = right;
  if (a->begin != b->begin) return a->begin < b->begin ? -1 : 1;
  if (a->end != b->end) return a->end < b->end ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

void tc_spans_sort(TcSpans *spans) {
  if (spans->count == 2 && compare_spans(&spans->data[0], &spans->data[1]) <= 0) return;
  if (spans->count > 1) qsort(spans->data, (size_t)spans->count, sizeof *spans->data, compare_spans);
}

bool tc_trace(const TcShell *shell, const TcRay *ray, TcSpans *spans) {
  Query query = {shell, ray, spans};
  spans->count = 0;
  if (shell->embree) {
    tc_embree_query(shell->embree, ray->from_center, ray->direction, shell->faces ? shell_candidate : cell_candidate, &query);
  }
  tc_spans_sort(spans);
  return !spans->out_of_memory;
}

void tc_spans_clear(TcSpans *spans) {
  tc_release(spans->context, spans->data);
  spans->data = NULL;
  spans->count = spans->capacity = 0;
}
