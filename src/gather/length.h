/* SPDX-License-Identifier: Apache-2.0 */
/* The length of rays in cells, for gatherers. Where cells overlap, each of them counts. */
#ifndef TC_GATHER_LENGTH_H
#define TC_GATHER_LENGTH_H

#include "gather/seam.h"

typedef struct TcLength {
  TcVec sum;
  TcVec rest; /* what rounding has added to the sum, to be taken from the next length (Kahan) */
} TcLength;

TC_INLINE void tc_length_begin(const TcGatherJob *job, TcLength *length) {
  (void)job;
  length->sum = length->rest = tc_set(0);
}

TC_INLINE void tc_length_segment(const unsigned on, const TcGatherJob *job, TcLength *length, TcMask mask,
                                 const TcPassage *passage) {
  (void)on, (void)job;
  const TcVec more = tc_select(mask, passage->length, tc_set(0)) - length->rest, sum = length->sum + more;
  length->rest = (sum - length->sum) - more;
  length->sum = sum;
}

#endif
