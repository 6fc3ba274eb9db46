/* SPDX-License-Identifier: Apache-2.0 */
/* The gatherer for emission without a walk, compiled once for each kind of lanes, with the name gather_NAME. */
#include "gather_lanes.h"

#include "gather/emission.h"

#define NAME_(name) gather_##name
#define NAME(name)  NAME_(name)

enum { FEATURES = TC_COLORED | TC_SCALED };

void NAME(TC_LANES_NAME)(const TcPieces *pieces, const double *length, const double *s0, const double *s1,
                         int64_t count, double rgba[4]) {
  static TcEmission e;
  const TcGatherJob job = {.sums = 5, .pieces = pieces, .tolerance = tc_tolerance_begin(pieces, 0, 0)};
  tc_pieces_load(pieces, tc_set_int(0), &e.piece);
  tc_emission_begin(&job, &e);
  for (int64_t i = 0; i < count; ++i) {
    const TcPassage passage = {
        .length = tc_set((TcReal)length[i]), .s0 = tc_set((TcReal)s0[i]), .s1 = tc_set((TcReal)s1[i])};
    tc_emission_segment(FEATURES, &job, &e, tc_all(), &passage);
    tc_emission_complete(FEATURES, &job, &e, tc_all(), i + 1);
  }
  double sums[5][TC_LANES];
  const TcEnding ending = {.steps = count};
  tc_emission_end(FEATURES, &job, &e, &ending, sums);
  for (int k = 0; k < 4; ++k) {
    rgba[k] = sums[k][0];
    for (int l = 1; l < TC_LANES; ++l) {
      if (!(sums[k][l] == sums[k][0]))
        rgba[k] = (double)NAN; /* noticed */
    }
  }
}
