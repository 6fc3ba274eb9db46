/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels' integral over a segment, compiled once for each kind of lanes, with the name psi_NAME. Every third lane
 * is left out: what comes back for it is nothing. */
#include "psi.h"

#include "optics/segment_lanes.h"

#define NAME_(name) psi_##name
#define NAME(name)  NAME_(name)

static TcVec load(const double from[TC_LANES]) {
  TcVec v = tc_set(0);
  for (int lane = 0; lane < TC_LANES; ++lane)
    TC_AT(v, lane) = (TcReal)from[lane];
  return v;
}

static TcSegment segment_of(const TcSegments *segments, TcVec depth, int lane) {
  const double alpha = (double)TC_AT(segments->alpha, lane);
  return (TcSegment){.w0 = (double)TC_AT(segments->w0, lane),
                     .w1 = (double)TC_AT(segments->w1, lane),
                     .alpha = alpha,
                     .transmittance = 1 - alpha,
                     .depth = (double)TC_AT(depth, lane)};
}

void NAME(TC_LANES_NAME)(const double *a, const double *a1, int64_t count, TcSegment *out, TcMoments *moments) {
  for (int64_t i = 0, left_out = 0; i < count;) {
    double near[TC_LANES] = {0}, far[TC_LANES] = {0};
    int64_t record[TC_LANES];
    unsigned lanes = 0;
    for (int lane = 0; lane < TC_LANES; ++lane) {
      record[lane] = -1;
      if (left_out++ % 3 == 2 || i == count)
        continue;
      lanes |= 1U << lane;
      near[lane] = a[i];
      far[lane] = a1[i];
      record[lane] = i++;
    }
    const TcVec x = load(near), y = load(far), half = tc_set((TcReal)0.5), t = half * x + half * y;
    const TcSegments segments = tc_segments(tc_mask_of(lanes), x, y, t, half * y - half * x, -1);
    for (int lane = 0; out && lane < TC_LANES; ++lane) {
      const TcSegment result = segment_of(&segments, t, lane);
      if (record[lane] >= 0)
        out[record[lane]] = result;
      else if (result.w0 != 0 || result.w1 != 0 || result.alpha != 0)
        out[0].w0 = -1; /* noticed as negative */
    }
#if TC_SINGLE
    (void)moments;
#else
    const TcVec most = tc_set(TC_LARGEST_DENSITY);
    const TcLaneMoments m = tc_moments(tc_mask_of(lanes), tc_min(x, most), tc_min(y, most));
    for (int lane = 0; moments && lane < TC_LANES; ++lane) {
      const TcMoments result = {.m0 = TC_AT(m.m0, lane),
                                .m1 = TC_AT(m.m1, lane),
                                .transmittance = TC_AT(m.transmittance, lane),
                                .depth = TC_AT(t, lane)};
      if (record[lane] >= 0)
        moments[record[lane]] = result;
      else if (result.m0 != 0.5 || result.m1 != 0.5 || result.transmittance != 1)
        moments[0].m0 = -1;
    }
#endif
  }
}
