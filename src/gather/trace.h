/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the length of rays in cells; and, if the worker has a trail, notes these cells as the host is given them,
 * with the mesh's own numbers of cells and vertices. The sums then tell where those of each ray are (walk/trail.h). */
#ifndef TC_GATHER_TRACE_H
#define TC_GATHER_TRACE_H

#include "gather/length.h"
#include "walk/trail.h"

/* How many crossings ahead a lane has the memory fetched that it is going to write: it is the only one to write there,
 * and what it has to wait for there keeps all from going on. */
enum { TC_TRACE_AHEAD = 4 };

typedef struct TcTrace {
  TcLength length;
  /* The following are there with a trail only. */
  TcVec cells;
  /* The vertices of the faces where the lanes have entered their cells, the mesh's numbers of these, and their weights
   * there. */
  TcWord id[3], name[3];
  TcVec barycentric[3];
  /* How the host counts along the rays (TcTrailWay). */
  TcVec near, scale[2], begin, end;
  /* Where each lane's next crossing goes, and how many steps there is room for. */
  TetcastCrossing *next[TC_LANES];
  int64_t room;
  /* The lanes' lists: from this one on, once they have been taken. */
  int list;
  bool taken;
} TcTrace;

TC_INLINE void tc_trace_begin(const TcGatherJob *job, TcTrace *trace) {
  tc_length_begin(job, &trace->length);
  trace->cells = tc_set(0);
  if (!job->trail || trace->taken)
    return;
  trace->taken = true;
  trace->list = job->trail->taken;
  trace->room = 0;
  job->trail->taken += TC_LANES;
  TC_EACH_LANE trace->next[l] = job->trail->list[trace->list + l].data;
}

/* The mesh's numbers of vertices, one for each lane. */
TC_INLINE TcWord tc_trace_names(const TetcastVolume *volume, TcWord vertex) {
  uint32_t name[TC_LANES];
  tc_store_word(name, vertex);
  TC_IN_MEMORY(name);
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) name[l] = volume->vertex_source[name[l]];
  TC_IN_MEMORY(name);
  return tc_load_word(name);
}

/* The lanes of `mask` set out on a path, or are at the face where the next cell begins, whose vertices have these
 * names.
 */
TC_INLINE void tc_trace_arrive(TcTrace *trace, TcMask mask, const TcPacket *walk, const TcWord name[3]) {
  for (int k = 0; k < 3; ++k) {
    trace->id[k] = tc_select_word(mask, walk->v[k].id, trace->id[k]);
    trace->name[k] = tc_select_word(mask, name[k], trace->name[k]);
    trace->barycentric[k] = tc_select(mask, walk->at.barycentric[k], trace->barycentric[k]);
  }
}

TC_NOINLINE void tc_trace_set_out(const TcGatherJob *job, TcTrace *trace, TcMask mask, const TcPacket *walk) {
  const TcTrail *trail = job->trail;
  const unsigned lanes = tc_bits(mask);
  const double *near[TC_LANES], *end[TC_LANES];
  TC_EACH_LANE {
    const TcTrailWay *way = &trail->ways[lanes >> l & 1 ? walk->destination[l] : 0];
    near[l] = &way->near;
    end[l] = &way->end;
  }
  TcVec number[4];
  tc_load_records(near, number);
  trace->near = tc_select(mask, number[0], trace->near);
  trace->scale[0] = tc_select(mask, number[1], trace->scale[0]);
  trace->scale[1] = tc_select(mask, number[2], trace->scale[1]);
  trace->begin = tc_select(mask, number[3], trace->begin);
  tc_load_records(end, number);
  trace->end = tc_select(mask, number[0], trace->end);
  if (!trail->weights)
    return;
  TcWord name[3];
  for (int k = 0; k < 3; ++k) {
    const TcWord vertex = walk->v[k].id;
    name[k] = tc_trace_names(job->volume, vertex);
  }
  tc_trace_arrive(trace, mask, walk, name);
}

TC_INLINE void tc_trace_enter(const unsigned on, const TcGatherJob *job, TcTrace *trace, TcMask mask,
                              const TcPacket *walk) {
  (void)on;
  if (job->trail)
    tc_trace_set_out(job, trace, mask, walk);
}

/* Finds how many steps there is room for, and makes some where there is none. False if memory has run out. */
TC_NOINLINE bool tc_trace_reserve(TcTrail *trail, TcTrace *trace) {
  TcTrailList *list = &trail->list[trace->list];
  trace->room = INT64_MAX;
  TC_EACH_LANE list[l].count = trace->next[l] - list[l].data;
  const bool ok = tc_trail_grow(trail, trace->list, TC_LANES);
  TC_EACH_LANE {
    const int64_t room = list[l].capacity - list[l].count;
    trace->room = room < trace->room ? room : trace->room;
    trace->next[l] = list[l].data + list[l].count;
  }
  return ok;
}

/* The host's number at a depth. */
TC_INLINE TcVec tc_trace_number(const TcTrace *trace, TcVec depth) {
  const TcVec t = (trace->near + depth) * trace->scale[0] * trace->scale[1];
  return tc_select3(tc_lt(t, trace->begin), trace->begin, tc_lt(trace->end, t), trace->end, t);
}

/* The mesh's vertices of a cell whose vertices became one with others (volume.h): they differ from cell to cell. */
TC_NOINLINE void tc_trace_own_names(const TetcastVolume *volume, TcMask mask, const uint32_t *cell, const TcWord id[4],
                                    TcWord name[4]) {
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    for (int k = 0; k < 4; ++k) {
      int place = 0;
      for (int j = 0; j < 4; ++j)
        place += TC_AT(id[k], l) > TC_AT(id[j], l);
      TC_AT(name[k], l) = volume->corner_vertices[cell[l]][place];
    }
  }
}

/* A crossing's vertices and weights. The vertices are those of the face where the cell was entered first. Of the face
 * where the ray leaves, all vertices but one are those of the first, at their places, as the walk replaces one
 * (walk/packet.h). */
typedef struct TcTraceWeights {
  TcWord name[4];
  TcVec weight[2][4];
} TcTraceWeights;

/* The face where a ray leaves its cell, with the vertices that it was entered by at their places: where cells are found
 * one by one (walk/cells.h), they may be in any order. */
TC_INLINE void tc_trace_align(const TetcastVolume *volume, const TcTrace *trace, TcWord id[3], TcVec weight[3]) {
#if TC_LANES == 1
  if (TC_LIKELY(volume->traversal == TETCAST_TRAVERSAL_SHELL))
    return;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      if (j == k || id[j] != trace->id[k])
        continue;
      const TcWord vertex = id[k];
      const TcVec other = weight[k];
      id[k] = id[j];
      weight[k] = weight[j];
      id[j] = vertex;
      weight[j] = other;
    }
  }
#else
  (void)volume, (void)trace, (void)id, (void)weight;
#endif
}

/* Finds them for the lanes of `mask`, and goes on to the face where the next cell begins in all that have crossed one.
 */
TC_INLINE void tc_trace_weights(const TcGatherJob *job, TcTrace *trace, TcMask mask, const TcPassage *passage,
                                TcTraceWeights *w) {
  const TetcastVolume *volume = job->volume;
  const TcPacket *walk = passage->walk;
  const TcVec zero = tc_set(0);
  TcWord id[3] = {walk->v[0].id, walk->v[1].id, walk->v[2].id};
  TcVec at[3] = {walk->at.barycentric[0], walk->at.barycentric[1], walk->at.barycentric[2]};
  tc_trace_align(volume, trace, id, at);
  TcMask kept[3];
  for (int k = 0; k < 3; ++k)
    kept[k] = tc_eq_word(id[k], trace->id[k]);
  const TcWord new_id = tc_select_word(kept[0], tc_select_word(kept[1], id[2], id[1]), id[0]);
  const TcWord new_name = tc_trace_names(volume, new_id);
  for (int k = 0; k < 3; ++k) {
    w->name[k] = trace->name[k];
    w->weight[0][k] = trace->barycentric[k];
    w->weight[1][k] = tc_select(kept[k], at[k], zero);
  }
  w->name[3] = new_name;
  w->weight[0][3] = zero;
  w->weight[1][3] = tc_select(kept[0], tc_select(kept[1], at[2], at[1]), at[0]);
  if (TC_UNLIKELY(volume->corner_vertices != NULL)) {
    const TcWord all[4] = {trace->id[0], trace->id[1], trace->id[2], new_id};
    TcWord name[4] = {w->name[0], w->name[1], w->name[2], w->name[3]};
    tc_trace_own_names(volume, mask, passage->cell, all, name);
    memcpy(w->name, name, sizeof w->name);
  }
  if (TC_UNLIKELY(passage->partial)) { /* between the faces weights are linear */
    const TcMask late = tc_lt(zero, passage->from), early = tc_lt(passage->to, tc_set(1));
    for (int k = 0; k < 4; ++k) {
      const TcVec entry = w->weight[0][k], change = w->weight[1][k] - entry;
      w->weight[0][k] = tc_select(late, entry + passage->from * change, entry);
      w->weight[1][k] = tc_select(early, entry + passage->to * change, w->weight[1][k]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    trace->id[k] = tc_select_word(passage->crossed, id[k], trace->id[k]);
    trace->name[k] = tc_select_word(tc_and_not(passage->crossed, kept[k]), new_name, trace->name[k]);
    trace->barycentric[k] = tc_select(passage->crossed, at[k], trace->barycentric[k]);
  }
}

/* Notes a step. Lanes that have not crossed anything write as well, but what they have written is not kept. A crossing
 * is written as four times four numbers, of which the last two are beyond it. */
TC_NOINLINE void tc_trace_note(const TcGatherJob *job, TcTrace *trace, TcMask mask, const TcPassage *passage) {
  TcTrail *trail = job->trail;
  if (TC_UNLIKELY(trace->room == 0) && !tc_trace_reserve(trail, trace))
    return;
  --trace->room;
  const uint32_t *source = job->volume->adjacency.source;
  const unsigned lanes = tc_bits(mask);
  double *at[4][TC_LANES];
  uint32_t cell[TC_LANES];
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) {
    double *to = (double *)(void *)trace->next[l];
    for (int k = 0; k < 4; ++k)
      at[k][l] = to + 4 * k;
    cell[l] = source[lanes >> l & 1 ? passage->cell[l] : 0]; /* lanes that rest are beyond the last cell */
    const char *ahead = (const char *)(trace->next[l] + TC_TRACE_AHEAD);
    __builtin_prefetch(ahead, 1);
    __builtin_prefetch(ahead + 64, 1);
    trace->next[l] += lanes >> l & 1;
  }
  const TcVec zero = tc_set(0), begin = tc_trace_number(trace, passage->begin),
              end = tc_trace_number(trace, passage->end),
              length = (passage->end - passage->begin) * trail->scale[0] * trail->scale[1];
  if (!trail->weights) {
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) memcpy(at[0][l], &cell[l], sizeof cell[l]);
    const TcVec number[4] = {zero, begin, end, length};
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) at[0][l] += 2;
    tc_store_records(at[0], number);
    return;
  }
  TC_IN_MEMORY(cell);
  TcTraceWeights w;
  tc_trace_weights(job, trace, mask, passage, &w);
  const TcWord none = {0};
  const TcVec number[4][4] = {{tc_two_words(tc_load_word(cell), w.name[0]), tc_two_words(w.name[1], w.name[2]),
                               tc_two_words(w.name[3], none), begin},
                              {end, length, w.weight[0][0], w.weight[0][1]},
                              {w.weight[0][2], w.weight[0][3], w.weight[1][0], w.weight[1][1]},
                              {w.weight[1][2], w.weight[1][3], zero, zero}};
  for (int k = 0; k < 4; ++k)
    tc_store_records(at[k], number[k]);
}

TC_INLINE void tc_trace_segment(const unsigned on, const TcGatherJob *job, TcTrace *trace, TcMask mask,
                                const TcPassage *passage) {
  tc_length_segment(on, job, &trace->length, mask, passage);
  if (!trace->taken) /* there is no trail, or the packet has not had any rays yet */
    return;
  trace->cells += tc_select(mask, tc_set(1), tc_set(0));
  tc_trace_note(job, trace, mask, passage);
}

TC_INLINE void tc_trace_end(const unsigned on, const TcGatherJob *job, TcTrace *trace, const TcEnding *ending,
                            double (*sums)[TC_LANES]) {
  (void)on, (void)ending;
  TC_EACH_LANE sums[TC_TRACE_LENGTH][l] = (double)TC_AT(trace->length.sum, l);
  for (int l = 0; job->trail && l < TC_LANES; ++l) {
    const TetcastCrossing *first = job->trail->list[trace->list + l].data;
    sums[TC_TRACE_CELLS][l] = (double)TC_AT(trace->cells, l);
    sums[TC_TRACE_LIST][l] = trace->list + l;
    sums[TC_TRACE_FIRST][l] = (double)(trace->next[l] - first) - sums[TC_TRACE_CELLS][l];
  }
}

#define tc_trace_complete(on, job, trace, active, steps) tc_none()

#endif
