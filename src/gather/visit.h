/* SPDX-License-Identifier: Apache-2.0 */
/* Emission and absorption along each path of a ray by itself: where it leaves the mesh, or what is visible of it, a
 * fragment ends. Fragments go to the job's list. */
#ifndef TC_GATHER_VISIT_H
#define TC_GATHER_VISIT_H

#include "gather/emission.h"
#include "gather/fragment_list.h"

typedef struct TcVisit {
  /* Along the path that each lane is on. */
  TcEmission emission;
  /* The depths at which the path begins, and that it has come to. */
  TcVec begin, end;
} TcVisit;

TC_INLINE void tc_visit_begin(const TcGatherJob *job, TcVisit *visit) {
  tc_emission_begin(job, &visit->emission);
  visit->begin = visit->end = tc_set(0);
}

/* Ends the paths of the lanes of `lanes`: what they have had goes to the list, if it is anything. */
TC_NOINLINE void tc_visit_leave(const unsigned on, const TcGatherJob *job, TcVisit *visit, unsigned lanes,
                                const TcPacket *walk) {
  TcEmission *e = &visit->emission;
  tc_emission_end_block(on, e);
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    TetcastFragment *fragment = e->depth[l] > 0 ? tc_fragment_list_append(job->fragments) : NULL;
    if (!fragment)
      continue;
    *fragment = (TetcastFragment){.pixel = walk->destination[l],
                                  .begin = (double)TC_AT(visit->begin, l) - TC_AT(walk->origin, l),
                                  .end = (double)TC_AT(visit->end, l) - TC_AT(walk->origin, l),
                                  .optical_depth = e->depth[l],
                                  .color = {e->color[0][l], e->color[1][l], e->color[2][l]}};
    for (int k = 0; k < 3; ++k)
      e->color[k][l] = 0;
    e->depth[l] = 0;
    e->transmittance[l] = 1;
    TC_AT(e->before, l) = 0;
  }
}

TC_INLINE void tc_visit_enter(const unsigned on, const TcGatherJob *job, TcVisit *visit, TcMask mask,
                              const TcPacket *walk) {
  const TcMask fragments = tc_and(mask, tc_lt(tc_set(0), visit->emission.before + visit->emission.block_depth));
  if (tc_any(fragments))
    tc_visit_leave(on, job, visit, tc_bits(fragments), walk);
  visit->begin = tc_select(mask, walk->seen, visit->begin);
}

TC_INLINE void tc_visit_segment(const unsigned on, const TcGatherJob *job, TcVisit *visit, TcMask mask,
                                const TcPassage *passage) {
  visit->end = tc_select(mask, passage->end, visit->end);
  tc_emission_segment(on, job, &visit->emission, mask, passage);
}

TC_INLINE TcMask tc_visit_complete(const unsigned on, const TcGatherJob *job, TcVisit *visit, TcMask active,
                                   int64_t steps) {
  return tc_emission_complete(on, job, &visit->emission, active, steps);
}

/* There is nothing to be added up: the only sum is 0. */
TC_INLINE void tc_visit_end(const unsigned on, const TcGatherJob *job, TcVisit *visit, const TcEnding *ending,
                            double (*sums)[TC_LANES]) {
  tc_visit_leave(on, job, visit, ending->walk->lanes, ending->walk);
  TC_EACH_LANE sums[0][l] = 0;
}

#endif
