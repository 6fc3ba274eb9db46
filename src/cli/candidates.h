/* SPDX-License-Identifier: Apache-2.0 */
/* Several transfer functions for one field, each of which shows something else of it. */
#ifndef TETCAST_CLI_CANDIDATES_H
#define TETCAST_CLI_CANDIDATES_H

#include "design.h"

enum { CANDIDATES = 8, SALIENT = 4 };

typedef struct Candidate {
  const char *name, *words; /* what it is called, and what it shows */
  const char *preset;       /* its colours; NULL: those of the others */
  Design design;
} Candidate;

typedef struct Candidates {
  int count;
  Candidate candidate[CANDIDATES]; /* [count] */
  int salient_count;
  double salient[SALIENT];       /* [salient_count]: values at which boundaries are, ascending */
  TetcastStatistics *statistics; /* over the range of the colour map, with gradients */
} Candidates;

/* Finds them; the first is what a picture has of which nothing is said: `first`, where that has been found already,
 * else NULL. The result is for candidates_release(). */
TetcastStatus candidates_find(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                              const DesignDesc *desc, const Design *first, Candidates *candidates);

void candidates_release(TetcastContext *context, Candidates *candidates);

#endif
