/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers emission and absorption by the integrators to compare with (optics/sampled.h). One lane only. */
#ifndef TC_GATHER_SAMPLED_H
#define TC_GATHER_SAMPLED_H

#include "gather/seam.h"
#include "optics/sampled.h"

typedef TcLight TcSampled;

TC_INLINE void tc_sampled_begin(const TcGatherJob *job, TcSampled *light) {
  (void)job, *light = tc_light_begin();
}

TC_INLINE void tc_sampled_segment(const unsigned on, const TcGatherJob *job, TcSampled *light, TcMask mask,
                                  const TcPassage *passage) {
  const TcVec s0 = on & TC_CELLS ? tc_cell_values(job, mask, passage->cell) : passage->s0,
              s1 = on & TC_CELLS ? s0 : passage->s1;
  if (!tc_any(mask) || isnan(s0) || isnan(s1))
    return;
  if (on & TC_CELLS)
    tc_light_add_constant(light, job->pieces, passage->length, s0);
  else
    tc_light_add_sampled(light, job->pieces, job->sampler, passage->length, s0, s1);
}

TC_INLINE TcMask tc_sampled_complete(const unsigned on, const TcGatherJob *job, TcSampled *light, TcMask active,
                                     int64_t steps) {
  (void)on, (void)steps;
  return tc_light_opaque(light, job->pieces) ? active : tc_none();
}

TC_INLINE void tc_sampled_end(const unsigned on, const TcGatherJob *job, TcSampled *light, const TcEnding *ending,
                              double (*sums)[TC_LANES]) {
  (void)on, (void)job, (void)ending;
  double rgba[4];
  tc_light_end(light, rgba);
  for (int k = 0; k < 4; ++k)
    sums[k][0] = rgba[k];
}

#define tc_sampled_enter(on, job, light, mask, walk) ((void)0)

#endif
