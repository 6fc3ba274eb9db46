/* SPDX-License-Identifier: Apache-2.0 */
/* Which parts of a mesh a rank has, and how it gets them. */
#ifndef TETCAST_CLI_RANKS_PARTS_H
#define TETCAST_CLI_RANKS_PARTS_H

#include "adapter.h"
#include "stage.h"

struct Ranks {
  StageOthers others;
  TetcastContext *context; /* the stage's */
  const CliMpi *mpi;
  TetcastMpi *world;
  int rank, size;
  int64_t all_parts; /* of all ranks */
  Stage *parts;      /* [count]; those without cells or without the array have no scene */
  int count;
  TetcastScene **scenes; /* [scene_count], of the parts that have one */
  int scene_count;
  int groups;          /* of the coefficients of all ranks' parts; 0 without */
  double bounds[6];    /* of the whole */
  TetcastVolume *kept; /* of the step before, for the first part; NULL: none */
  uint64_t kept_fingerprint;
  TetcastMpiStats stats; /* of the last picture */
};

/* NULL: there are none. */
static inline struct Ranks *ranks_of(const Stage *stage) {
  return stage->others ? stage->others->ranks : NULL;
}

/* A single file becomes so many parts, whatever the number of ranks, as pictures have the same bits for the same parts.
 */
enum { RANKS_SPLIT = 64 };

/* Shares work out: [count] works go, the largest first, each to the rank that has the least by then; owner[i] is
 * it. The order in which they went is left in `order`. */
void ranks_spread(const int64_t *work, int count, int ranks, int *order, int *owner);

/* Makes room for so many parts. */
void ranks_reserve(struct Ranks *ranks, int count);

/* Adds a part with what all of them share: the context, the array. */
Stage *ranks_add(Stage *stage);

/* Splits what rank 0 has read into RANKS_SPLIT parts, and sends them to their ranks. */
int ranks_split(Stage *stage);

#endif
