/* SPDX-License-Identifier: Apache-2.0 */
/* Emission and absorption of coefficients along each path of a ray by itself, as visit.h has them of a transfer
 * function: fragments of all groups go to the job's list, also those of which nothing is seen, as they have a length.
 */
#ifndef TC_GATHER_VISIT_GROUPS_H
#define TC_GATHER_VISIT_GROUPS_H

#include "gather/coefficients.h"
#include "gather/fragment_list.h"

typedef struct TcVisitGroups {
  /* Along the path that each lane is on. It comes first, as in the union of all gatherers it is that of TcGroups. */
  TcGroups groups;
  /* The depths at which the path begins, and that it has come to; the same where there is none. */
  TcVec begin, end;
} TcVisitGroups;

TC_INLINE void tc_visit_groups_begin(const TcGatherJob *job, TcVisitGroups *visit) {
  tc_groups_begin(job, &visit->groups);
  visit->begin = visit->end = tc_set(0);
}

/* Takes the radiance and the optical depth that group g of lane l has had along its path, which begins anew. The
 * others' blocks go on. */
TC_INLINE void tc_visit_groups_take(const TcGatherJob *job, const TcGroups *groups, int l, int g, double taken[2]) {
  TcBeam *b = tc_groups_beam(groups, l, g);
  const int at = tc_groups_lane(groups, l, g);
  const double radiance = TC_AT(b->radiance, at) + TC_AT(b->transmittance, at) * TC_AT(b->block_radiance, at);
  taken[0] = radiance != 0 ? ldexp(radiance, job->exponent + job->coefficients->emission_exponent) : 0;
  taken[1] = TC_AT(b->depth, at) + TC_AT(b->block_depth, at);
  TC_AT(b->radiance, at) = TC_AT(b->block_radiance, at) = 0;
  TC_AT(b->depth, at) = TC_AT(b->block_depth, at) = 0;
  TC_AT(b->transmittance, at) = TC_AT(b->block_transmittance, at) = 1;
}

/* Ends the paths of the lanes of `lanes` that have any length. */
TC_NOINLINE void tc_visit_groups_leave(const TcGatherJob *job, TcVisitGroups *visit, unsigned lanes,
                                       const TcPacket *walk) {
  for (lanes &= tc_bits(tc_lt(visit->begin, visit->end)); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    TetcastFragment *fragment = tc_fragment_list_append(job->fragments);
    if (!fragment)
      return;
    *fragment = (TetcastFragment){.pixel = walk->destination[l],
                                  .begin = (double)TC_AT(visit->begin, l) - TC_AT(walk->origin, l),
                                  .end = (double)TC_AT(visit->end, l) - TC_AT(walk->origin, l)};
    double *taken = tc_fragment_list_groups(job->fragments);
    for (int g = 0; g < job->coefficients->groups; ++g)
      tc_visit_groups_take(job, &visit->groups, l, g, taken + 2 * g);
  }
}

TC_INLINE void tc_visit_groups_enter(const unsigned on, const TcGatherJob *job, TcVisitGroups *visit, TcMask mask,
                                     const TcPacket *walk) {
  tc_visit_groups_leave(job, visit, tc_bits(mask), walk);
  visit->begin = tc_select(mask, walk->seen, visit->begin);
  visit->end = tc_select(mask, walk->seen, visit->end);
  tc_groups_enter(on & ~(unsigned)TC_PARTS, job, &visit->groups, mask, walk);
}

TC_INLINE void tc_visit_groups_segment(const unsigned on, const TcGatherJob *job, TcVisitGroups *visit, TcMask mask,
                                       const TcPassage *passage) {
  visit->end = tc_select(mask, passage->end, visit->end);
  tc_groups_segment(on, job, &visit->groups, mask, passage);
}

TC_INLINE TcMask tc_visit_groups_complete(const unsigned on, const TcGatherJob *job, TcVisitGroups *visit,
                                          TcMask active, int64_t steps) {
  return tc_groups_complete(on, job, &visit->groups, active, steps);
}

/* There is nothing to be added up: the only sum is 0. */
TC_INLINE void tc_visit_groups_end(const unsigned on, const TcGatherJob *job, TcVisitGroups *visit,
                                   const TcEnding *ending, double (*sums)[TC_LANES]) {
  (void)on;
  tc_visit_groups_leave(job, visit, ending->walk->lanes, ending->walk);
  TC_EACH_LANE sums[0][l] = 0;
}

#endif
