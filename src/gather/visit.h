/* SPDX-License-Identifier: Apache-2.0 */
/* Emission and absorption along each path of a ray by itself: where it leaves the mesh, or what is visible of it, a
 * fragment ends. Fragments go to the job's list. With TC_SURFACES, what a path meets of them is part of its fragment,
 * as nothing that lies elsewhere comes between. */
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

/* The optical depth of a path, with that of a surface of opacity α, −ln(1 − α). */
TC_INLINE double tc_visit_depth(const unsigned on, const TcEmission *e, int l) {
  return on & TC_SURFACES ? e->depth[l] - log((double)TC_AT(e->layers.veil, l)) : e->depth[l];
}

/* Ends the paths of the lanes of `lanes`: what they have had goes to the list, if it is anything. */
TC_NOINLINE void tc_visit_leave(const unsigned on, const TcGatherJob *job, TcVisit *visit, unsigned lanes,
                                const TcPacket *walk) {
  TcEmission *e = &visit->emission;
  tc_emission_end_block(on, e);
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const double depth = tc_visit_depth(on, e, l);
    TetcastFragment *fragment = depth > 0 ? tc_fragment_list_append(job->fragments) : NULL;
    if (!fragment)
      continue;
    *fragment = (TetcastFragment){.pixel = walk->destination[l],
                                  .begin = (double)TC_AT(visit->begin, l) - TC_AT(walk->origin, l),
                                  .end = (double)TC_AT(visit->end, l) - TC_AT(walk->origin, l),
                                  .optical_depth = depth,
                                  .color = {e->color[0][l], e->color[1][l], e->color[2][l]}};
    for (int k = 0; k < 3; ++k)
      e->color[k][l] = 0;
    e->depth[l] = 0;
    e->transmittance[l] = 1;
    TC_AT(e->before, l) = 0;
    if (on & TC_SURFACES)
      TC_AT(e->layers.veil, l) = 1;
  }
}

TC_INLINE void tc_visit_enter(const unsigned on, const TcGatherJob *job, TcVisit *visit, TcMask mask,
                              const TcPacket *walk) {
  TcEmission *e = &visit->emission;
  TcMask fragments = tc_lt(tc_set(0), e->before + e->block_depth);
  if (on & TC_SURFACES)
    fragments = tc_or(fragments, tc_lt(e->layers.veil, tc_set(1)));
  fragments = tc_and(mask, fragments);
  if (tc_any(fragments))
    tc_visit_leave(on, job, visit, tc_bits(fragments), walk);
  visit->begin = tc_select(mask, walk->seen, visit->begin);
  visit->end = tc_select(mask, walk->seen, visit->end);
  tc_emission_enter(on, job, e, mask, walk);
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
