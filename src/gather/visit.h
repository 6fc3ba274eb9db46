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

/* Ends the paths of the lanes of `lanes`: what they have had goes to the list, if it is anything. The others' blocks go
 * on. */
TC_NOINLINE void tc_visit_leave(const unsigned on, const TcGatherJob *job, TcVisit *visit, unsigned lanes,
                                const TcPacket *walk) {
  TcEmission *e = &visit->emission;
  const TcMask mask = tc_mask_of(lanes);
  const TcVec zero = tc_set(0), one = tc_set(1), transmittance = tc_load(e->transmittance);
  _Alignas(64) double color[3][TC_LANES], depth[TC_LANES];
  for (int k = 0; k < 3; ++k) {
    const TcVec before = tc_load(e->color[k]);
    tc_store(color[k], tc_madd(transmittance, e->block_color[k], before));
    tc_store(e->color[k], tc_select(mask, zero, before));
    e->block_color[k] = tc_select(mask, zero, e->block_color[k]);
  }
  tc_store(depth, e->before + e->block_depth);
  e->before = tc_select(mask, zero, e->before);
  e->block_depth = tc_select(mask, zero, e->block_depth);
  e->block_transmittance = tc_select(mask, one, e->block_transmittance);
  tc_store(e->transmittance, tc_select(mask, one, transmittance));
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    if (on & TC_SURFACES) { /* one of opacity α is as opaque as an optical depth of −ln(1 − α) */
      depth[l] -= log((double)TC_AT(e->layers.veil, l));
      TC_AT(e->layers.veil, l) = 1;
    }
    TetcastFragment *fragment = depth[l] > 0 ? tc_fragment_list_append(job->fragments) : NULL;
    if (!fragment)
      continue;
    *fragment = (TetcastFragment){.pixel = walk->destination[l],
                                  .begin = (double)TC_AT(visit->begin, l) - TC_AT(walk->origin, l),
                                  .end = (double)TC_AT(visit->end, l) - TC_AT(walk->origin, l),
                                  .optical_depth = depth[l],
                                  .color = {color[0][l], color[1][l], color[2][l]}};
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
