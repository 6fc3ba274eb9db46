/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/trace.h"

#include <stdlib.h>
#include <string.h>

#include "traverse/walk.h"

typedef struct Query {
  const TcShell *shell;
  const TcRay *ray;
  TcSpans *spans;
} Query;

bool tc_spans_grow(TcSpans *spans) {
  const int64_t capacity = spans->capacity ? 2 * spans->capacity : 64;
  TcSpan *data = tc_allocate(spans->context, capacity, sizeof *data);
  if (!data) {
    spans->out_of_memory = true;
    return false;
  }
  if (spans->count) memcpy(data, spans->data, (size_t)spans->count * sizeof *data);
  tc_release(spans->context, spans->data);
  spans->data = data;
  spans->capacity = capacity;
  return true;
}

/* Whether the ray crosses the triangle of three points, and its edges' values. */
static inline bool crosses(const TcPoint *a, const TcPoint *b, const TcPoint *c, double edge[3]) {
  edge[0] = tc_edge(a, b);
  edge[1] = tc_edge(b, c);
  edge[2] = tc_edge(c, a);
  return tc_inside(edge[0], edge[1], edge[2]);
}

static void shell_candidate(void *user, uint32_t i) {
  Query *query = user;
  const TcShellFace *face = &query->shell->faces[i];
  TcPoint p[3];
  for (int k = 0; k < 3; ++k) p[k] = tc_project(query->shell->volume, query->ray, face->vertex[k]);
  double edge[3];
  if (!crosses(&p[0], &p[1], &p[2], edge)) return;
  TcSpan *span = tc_spans_append(query->spans);
  if (!span) return;
  *span = (TcSpan){.id = i};
  tc_crossing(&p[0], &p[1], &p[2], edge[0], edge[1], edge[2], &span->begin, &span->s0);
  span->end = span->begin;
}

/* A ray crosses none or exactly two of a cell's faces. */
bool tc_cross_cell(const TetcastVolume *volume, const TcRay *ray, uint32_t cell, TcWalk face[2]) {
  const uint32_t *vertex = volume->adjacency.vertices[cell];
  TcPoint p[4];
  TcWalk found[2];
  for (int k = 0; k < 4; ++k) p[k] = tc_project(volume, ray, vertex[k]);
  int count = 0;
  for (int k = 0; k < 4 && count < 2; ++k) {
    const TcPoint *v[3] = {&p[k], &p[(k + 1) & 3], &p[(k + 2) & 3]};
    if (!crosses(v[0], v[1], v[2], found[count].edge)) continue;
    for (int j = 0; j < 3; ++j) found[count].v[j] = *v[j];
    tc_walk_cross(&found[count++]);
  }
  if (count < 2) return false;
  const int first = found[1].z < found[0].z;
  face[0] = found[first];
  face[1] = found[!first];
  return true;
}

static void cell_candidate(void *user, uint32_t i) {
  Query *query = user;
  TcWalk at[2];
  if (!tc_cross_cell(query->shell->volume, query->ray, i, at)) return;
  TcSpan *span = tc_spans_append(query->spans);
  if (span) *span = (TcSpan){.begin = at[0].z, .end = at[1].z, .s0 = at[0].s, .s1 = at[1].s, .id = i};
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
