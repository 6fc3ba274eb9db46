/* SPDX-License-Identifier: Apache-2.0 */
/* The packets' segment integral, compiled once for each instruction set: the including file defines PSI_LANES, the function's name. Every
 * third lane is left out: what comes back for it is nothing. */
#include "psi.h"

#include "optics/segment_simd.h"

void PSI_LANES(const double *a, const double *a1, int64_t count, TcSegment *out) {
  for (int64_t i = 0, left_out = 0; i < count;) {
    double near[TC_LANES] = {0}, far[TC_LANES] = {0};
    int64_t record[TC_LANES];
    unsigned lanes = 0;
    for (int lane = 0; lane < TC_LANES; ++lane) {
      record[lane] = -1;
      if (left_out++ % 3 == 2 || i == count) continue;
      lanes |= 1U << lane;
      near[lane] = a[i];
      far[lane] = a1[i];
      record[lane] = i++;
    }
    TcVec x, y;
    memcpy(&x, near, sizeof x);
    memcpy(&y, far, sizeof y);
    const TcVec t = 0.5 * x + 0.5 * y;
    const TcSegments segments = tc_segments(tc_mask_of(lanes), x, y, t, -1);
    for (int lane = 0; lane < TC_LANES; ++lane) {
      const TcSegment result = {.w0 = segments.w0[lane], .w1 = segments.w1[lane], .transmittance = segments.transmittance[lane],
                                .alpha = 1 - segments.transmittance[lane], .depth = t[lane]};
      if (record[lane] >= 0) out[record[lane]] = result;
      else if (result.w0 != 0 || result.w1 != 0 || result.transmittance != 1) out[0].w0 = -1; /* noticed as negative */
    }
  }
}
