/* SPDX-License-Identifier: Apache-2.0 */
/* The seam between the walk and what is made of it. A gatherer is a state for a packet of rays and these functions,
 * which are inlined into the kernel's loop; `on` is a mask of features (features.h), a constant there:
 *
 *     begin(job, state)                            new rays
 *     enter(job, state, mask, walk)                the lanes of `mask` set out from a face of the shell
 *     segment(on, job, state, mask, passage)       the lanes of `mask` have crossed a cell, or what counts of it; those
 * of others their state is kept complete(on, job, state, active, steps)      after each step: the lanes for which
 * nothing behind can change anything end(on, job, state, ending, sums)            what has been gathered, as
 * TcGatherJob.sums numbers of each lane; with TC_BOUND, a bound on the error of all of them is the last
 *
 * A new one is a file like length.h, a line in gather.h and a row in kernels.def. */
#ifndef TC_GATHER_SEAM_H
#define TC_GATHER_SEAM_H

#include <tetcast/blend.h>

#include "base/lanes.h"
#include "optics/tolerance.h"
#include "volume/coefficients.h"
#include "walk/packet.h"

/* What gatherers are given; each uses some of it. */
typedef struct TcGatherJob {
  int sums;               /* numbers that end() makes */
  const TcPieces *pieces; /* in the volume's units */
  const TcRows *values;   /* the scalar */
  TcTolerance tolerance;
  const struct TcSampler *sampler;
  const TcCoefficients *coefficients;
  TetcastBlend blend;         /* which number is made of the values along a ray */
  const TcSurfaces *surfaces; /* with TC_SURFACES */
  bool to_the_end;            /* coefficients: what is wanted is not complete where all groups are opaque */
  double rounding;            /* with TC_BOUND: of a value that was interpolated, relative to it */
  int exponent;               /* of the volume's unit of length */
} TcGatherJob;

enum { TC_MAX_SUMS = 3 * TETCAST_MAX_GROUPS + 3 };

/* What of a cell was crossed in each lane. */
typedef struct TcPassage {
  TcVec length, s0, s1;
  TcVec spread; /* with TC_BOUND: ∫ |error of s| dt, at most (tolerance.h); with TC_WEIGHTS, of a number with a range of
                   1 */
  const uint32_t *cell;   /* [TC_LANES] */
  const TcCrossed *entry; /* with TC_SURFACES: the face where they entered */
  const TcPacket *walk;   /* at the face where they left */
  TcVec begin, end;       /* the depths between which the length lies */
  unsigned leaving;       /* lanes that are at the shell, where a path ends */
  TcMask crossed;         /* lanes that are at another face, though none of it may count */
  bool partial;           /* of some lanes only a part counts, from `from` to `to`, fractions of the whole */
  TcVec from, to;
} TcPassage;

typedef struct TcEnding {
  unsigned stopped; /* lanes of rays that were complete before all was seen */
  int64_t steps;    /* of the packet */
  TcVec shift;      /* with TC_BOUND */
} TcEnding;

/* The scalar of the cells in the lanes of `mask`; of some cell in others. */
TC_INLINE TcVec tc_cell_values(const TcGatherJob *job, TcMask mask, const uint32_t cell[TC_LANES]) {
  (void)mask;
  TcVec value;
  const TcRows *rows = job->values;
  if (rows->is_double) {
    for (int l = 0; l < TC_LANES; ++l)
      TC_AT(value, l) = (TcReal)((const double *)rows->data)[cell[l]];
  } else {
    for (int l = 0; l < TC_LANES; ++l)
      TC_AT(value, l) = (TcReal)((const float *)rows->data)[cell[l]];
  }
  return value;
}

#endif
