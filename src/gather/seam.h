/* SPDX-License-Identifier: Apache-2.0 */
/* The seam between the walk of rays and the gatherers, which make something of the segments that rays cross. A gatherer
 * is a state for the rays of a packet, and these functions, which are inlined into the kernel's loop. There, `on` is a
 * constant mask of features (features.h).
 *
 * - begin(job, state): the packet has new rays.
 *
 * - enter(on, job, state, mask, walk): the rays of the lanes in `mask` begin a path at a face of the shell.
 *
 * - segment(on, job, state, mask, passage): the rays of the lanes in `mask` have crossed a cell, or the part of it that
 *   counts. The state of other lanes must stay as it is.
 *
 * - complete(on, job, state, active, steps): is called after each step, and returns the lanes in `active` for which
 *   nothing that follows can change the result.
 *
 * - end(on, job, state, ending, sums): hands out what has been gathered, TcGatherJob.sums numbers for each lane. With
 *   TC_BOUND the last of them is a bound on the error of the others.
 *
 * A new gatherer is a file like count.h, a line in gather.h and a row in kernels.def. */
#ifndef TC_GATHER_SEAM_H
#define TC_GATHER_SEAM_H

#include <tetcast/blend.h>

#include "base/lanes.h"
#include "optics/second.h"
#include "optics/tolerance.h"
#include "volume/coefficients.h"
#include "walk/lights.h"
#include "walk/packet.h"
#include "walk/trail.h"

/* What gatherers are given; each of them uses a part of it. */
typedef struct TcGatherJob {
  const TetcastVolume *volume;        /* whose cells rays cross */
  int sums;                           /* how many numbers end() hands out for each lane */
  const TcPieces *pieces;             /* the transfer function, in the volume's units */
  const TcSecond *second;             /* with TC_SECOND: what the transfer function is in cells; pieces are its hull */
  const TcRows *values;               /* the scalar */
  TcTolerance tolerance;              /* of emission and absorption */
  const struct TcSampler *sampler;    /* of the integrators that are compared with */
  const TcCoefficients *coefficients; /* extinction and emission as fields */
  TetcastBlend blend;                 /* which number is made of the values along a ray */
  const TcSurfaces *surfaces;         /* with TC_SURFACES: isosurfaces, slices and the boundary */
  const TcLights *lights;             /* with TC_LIT: the light in the volume */
  TcTrail *trail;                     /* where cells that are crossed are noted; NULL: nowhere */
  bool to_the_end;                    /* of coefficients: opaque rays go on, as what lies behind is wanted too */
  double rounding;                    /* with TC_BOUND: the rounding of an interpolated value, relative to it */
  struct TcFragmentList *fragments;   /* where fragments of rays go */
  int exponent;                       /* the volume's unit of length is 2^exponent of the mesh's */
} TcGatherJob;

/* The most numbers that a gatherer hands out for a lane. */
enum { TC_MAX_SUMS = 3 * TETCAST_MAX_GROUPS + 3 };

/* The segments of rays in the cells that they have just crossed. */
typedef struct TcPassage {
  /* The length of the segment, and the scalar where it begins and ends. */
  TcVec length, s0, s1;
  /* With TC_BOUND: a bound on ∫ |error of s| dt (tolerance.h); with TC_WEIGHTS, that of a number with a range of 1. */
  TcVec spread;
  /* [TC_LANES]: the cells. */
  const uint32_t *cell;
  /* With TC_SURFACES: the faces where the rays have entered their cells. */
  const TcCrossed *entry;
  /* The packet, at the faces where the rays have left their cells. */
  const TcPacket *walk;
  /* The depths between which the length lies. */
  TcVec begin, end;
  /* The lanes that are at the shell, where their path ends, as bits. */
  unsigned leaving;
  /* The lanes that have come to another face, even if no part of their segment counts. */
  TcMask crossed;
  /* Whether in some lanes only a part of the segment counts: that between the fractions `from` and `to` of it. */
  bool partial;
  TcVec from, to;
} TcPassage;

/* What is known of a packet's rays when they end. */
typedef struct TcEnding {
  unsigned stopped; /* the lanes that were complete before they had crossed everything */
  int64_t steps;    /* the number of steps that the packet has made */
  TcVec shift;      /* with TC_BOUND: TcPacket.shift */
  TcWide start;     /* with TC_SURFACES: TcPacket.start */
  const TcPacket *walk;
} TcEnding;

/* The scalar of the cells in the lanes of `mask`; other lanes get that of some cell. */
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
