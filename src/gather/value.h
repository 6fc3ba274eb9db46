/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the scalar along rays without a transfer function: its smallest and its largest value, ∫ s dt and ∫ dt, of
 * which the blend mode makes a number (blend.h). In a cell the scalar is linear, so both extremes lie at the ends of a
 * segment, and ∫ s dt is a trapezoid: all four are exact. Cells that touch a NaN count for nothing. All four are
 * gathered for each blend mode, as they cost less than the walk. */
#ifndef TC_GATHER_VALUE_H
#define TC_GATHER_VALUE_H

#include "gather/seam.h"

typedef struct TcValue {
  TcVec least, most;                /* ∞ and −∞ as long as nothing was met */
  TcVec integral, length;           /* ∫ s dt and ∫ dt */
  TcVec integral_rest, length_rest; /* what rounding has added to these two (Kahan) */
} TcValue;

TC_INLINE void tc_value_begin(const TcGatherJob *job, TcValue *v) {
  (void)job;
  v->least = tc_set((TcReal)INFINITY);
  v->most = tc_set((TcReal)-INFINITY);
  v->integral = v->length = v->integral_rest = v->length_rest = tc_set(0);
}

TC_INLINE void tc_value_add(TcVec part, TcVec *sum, TcVec *rest) {
  const TcVec more = part - *rest, next = *sum + more;
  *rest = (next - *sum) - more;
  *sum = next;
}

TC_INLINE void tc_value_segment(const unsigned on, const TcGatherJob *job, TcValue *v, TcMask mask,
                                const TcPassage *passage) {
  TcVec s0 = passage->s0, s1 = passage->s1;
  if (on & TC_CELLS)
    s0 = s1 = tc_cell_values(job, mask, passage->cell);
  mask = tc_and(mask, tc_and(tc_eq(s0, s0), tc_eq(s1, s1))); /* a NaN at any vertex is in one of the two faces */
  const TcVec zero = tc_set(0), middle = tc_madd(tc_set((TcReal)0.5), s0, (TcReal)0.5 * s1);
  v->least = tc_select(mask, tc_min(v->least, tc_min(s0, s1)), v->least);
  v->most = tc_select(mask, tc_max(v->most, tc_max(s0, s1)), v->most);
  tc_value_add(tc_select(mask, passage->length * middle, zero), &v->integral, &v->integral_rest);
  tc_value_add(tc_select(mask, passage->length, zero), &v->length, &v->length_rest);
}

/* The sums are the value, 0 if nothing was met, and 1 if anything was met, else 0. A mean is kept between the extremes,
 * as rounding could take it beyond them: so the mean of a constant field is the constant. */
TC_INLINE void tc_value_end(const unsigned on, const TcGatherJob *job, TcValue *v, const TcEnding *ending,
                            double (*sums)[TC_LANES]) {
  (void)on, (void)ending;
  TC_EACH_LANE {
    const double least = (double)TC_AT(v->least, l), most = (double)TC_AT(v->most, l),
                 integral = (double)TC_AT(v->integral, l);
    double value = most;
    if (job->blend == TETCAST_BLEND_MINIMUM)
      value = least;
    else if (job->blend == TETCAST_BLEND_AVERAGE)
      value = fmax(least, fmin(integral / (double)TC_AT(v->length, l), most));
    else if (job->blend == TETCAST_BLEND_ADDITIVE)
      value = integral;
    sums[1][l] = least <= most;
    sums[0][l] = least <= most ? value : 0;
  }
}

#define tc_value_enter(on, job, v, mask, walk)       ((void)0)
#define tc_value_complete(on, job, v, active, steps) tc_none()

#endif
