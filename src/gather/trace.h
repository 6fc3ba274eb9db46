/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the length of rays in cells and, as a second sum, if it is wanted, how many cells they cross over a length
 * above 0; and notes these cells if the worker has a trail. */
#ifndef TC_GATHER_TRACE_H
#define TC_GATHER_TRACE_H

#include "gather/length.h"
#include "walk/trail.h"

typedef struct TcTrace {
  TcLength length;
  TcVec cells;
  /* With a trail: the vertices of the faces where the lanes have entered their cells, and their weights there. */
  TcWord id[3];
  TcVec barycentric[3];
} TcTrace;

TC_INLINE void tc_trace_begin(const TcGatherJob *job, TcTrace *trace) {
  tc_length_begin(job, &trace->length);
  trace->cells = tc_set(0);
}

/* The lanes of `mask` are at the face where the next cell begins. */
TC_INLINE void tc_trace_arrive(TcTrace *trace, TcMask mask, const TcPacket *walk) {
  for (int k = 0; k < 3; ++k) {
    trace->id[k] = tc_select_word(mask, walk->v[k].id, trace->id[k]);
    trace->barycentric[k] = tc_select(mask, walk->at.barycentric[k], trace->barycentric[k]);
  }
}

TC_INLINE void tc_trace_enter(const unsigned on, const TcGatherJob *job, TcTrace *trace, TcMask mask,
                              const TcPacket *walk) {
  (void)on;
  if (job->trail)
    tc_trace_arrive(trace, mask, walk);
}

/* Notes a step. Lanes that have not crossed anything have no ray in it. */
TC_NOINLINE void tc_trace_note(TcTrail *trail, TcTrace *trace, TcMask mask, const TcPassage *passage) {
  const TcPacket *walk = passage->walk;
  double *step = tc_trail_step(trail, TC_LANES);
  if (!step)
    return;
  double *numbers = step + tc_trail_before_numbers(trail, TC_LANES);
  uint32_t *words = (uint32_t *)(void *)step;
  const unsigned lanes = tc_bits(mask);
  TC_EACH_LANE words[TC_TRAIL_RAY * TC_LANES + l] = lanes >> l & 1 ? (uint32_t)walk->destination[l] : UINT32_MAX;
  memcpy(words + TC_TRAIL_CELL * TC_LANES, passage->cell, TC_LANES * sizeof *words);
  tc_store(numbers + TC_TRAIL_BEGIN * TC_LANES, passage->begin);
  tc_store(numbers + TC_TRAIL_END * TC_LANES, passage->end);
  if (!trail->weights)
    return;
  for (int k = 0; k < 3; ++k) {
    tc_store_word(words + (TC_TRAIL_ENTRY + k) * TC_LANES, trace->id[k]);
    tc_store_word(words + (TC_TRAIL_EXIT + k) * TC_LANES, walk->v[k].id);
    tc_store(numbers + (TC_TRAIL_AT_ENTRY + k) * TC_LANES, trace->barycentric[k]);
    tc_store(numbers + (TC_TRAIL_AT_EXIT + k) * TC_LANES, walk->at.barycentric[k]);
  }
  tc_store(numbers + TC_TRAIL_FROM * TC_LANES, passage->partial ? passage->from : tc_set(0));
  tc_store(numbers + TC_TRAIL_TO * TC_LANES, passage->partial ? passage->to : tc_set(1));
  tc_trace_arrive(trace, passage->crossed, walk);
}

TC_INLINE void tc_trace_segment(const unsigned on, const TcGatherJob *job, TcTrace *trace, TcMask mask,
                                const TcPassage *passage) {
  tc_length_segment(on, job, &trace->length, mask, passage);
  trace->cells += tc_select(mask, tc_set(1), tc_set(0));
  if (job->trail)
    tc_trace_note(job->trail, trace, mask, passage);
}

TC_INLINE void tc_trace_end(const unsigned on, const TcGatherJob *job, TcTrace *trace, const TcEnding *ending,
                            double (*sums)[TC_LANES]) {
  (void)on, (void)ending;
  TC_EACH_LANE sums[0][l] = (double)TC_AT(trace->length.sum, l);
  for (int l = 0; job->sums > 1 && l < TC_LANES; ++l)
    sums[1][l] = (double)TC_AT(trace->cells, l);
}

#define tc_trace_complete(on, job, trace, active, steps) tc_none()

#endif
