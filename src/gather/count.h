/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers how many cells rays cross over a length above 0. */
#ifndef TC_GATHER_COUNT_H
#define TC_GATHER_COUNT_H

#include "gather/seam.h"

typedef struct TcCount {
  TcVec cells;
} TcCount;

TC_INLINE void tc_count_begin(const TcGatherJob *job, TcCount *count) {
  (void)job;
  count->cells = tc_set(0);
}

TC_INLINE void tc_count_segment(const unsigned on, const TcGatherJob *job, TcCount *count, TcMask mask,
                                const TcPassage *passage) {
  (void)on, (void)job, (void)passage;
  count->cells += tc_select(mask, tc_set(1), tc_set(0));
}

TC_INLINE void tc_count_end(const unsigned on, const TcGatherJob *job, TcCount *count, const TcEnding *ending,
                            double (*sums)[TC_LANES]) {
  (void)on, (void)job, (void)ending;
  TC_EACH_LANE sums[0][l] = (double)TC_AT(count->cells, l);
}

#define tc_count_enter(on, job, count, mask, walk)       ((void)0)
#define tc_count_complete(on, job, count, active, steps) tc_none()

#endif
