/* SPDX-License-Identifier: Apache-2.0 */
/* What statistics are summed up from: the share that each tetrahedron has in them (statistics.h). The functions below
 * are compiled once for each instruction set, and all of them give the same bits. */
#ifndef TC_VOLUME_TALLY_H
#define TC_VOLUME_TALLY_H

#include "mesh/mesh.h"

/* So many numbers may be read and written beyond the last one that counts, as a vector is read and written as a whole.
 */
enum { TC_TALLY_SPARE = 8 };

/* What is asked for. Lengths and values are in units of powers of two near the largest, so that nothing overflows. */
typedef struct TcTally {
  const TetcastMesh *mesh;
  const TetcastField *field;
  double length_factor[2], value_factor[2]; /* which in turn scale: a single power of two could overflow */
  const double *edges;                      /* [bins + 1 + TC_TALLY_SPARE], ascending; the spare ones are infinite */
  int bins;
  /* Where to look for the first edge above a value: the value's place is (value − edges[0]) · per_value + ½, cut to
   * [0, place_count − 1] and rounded down, and places[place] edges have a smaller place. */
  const int *places; /* [place_count + 1] */
  int place_count;
  double per_value;
  int rows;                                 /* bins of the gradient; 0: there is no joint histogram */
  double least_gradient, rows_per_gradient; /* where the first row begins, and how narrow rows are */
  bool surfaces;                            /* whether areas are wanted */
  bool steepest;                            /* whether the largest gradient is wanted */
} TcTally;

/* What is summed up, in these units. All are arrays of tc_tally_width() numbers. */
typedef struct TcTallySums {
  double total, unknown, steepest;
  double *volume;          /* below the first edge, in each bin, above the last edge */
  double *area, *gradient; /* at each edge; NULL if they are not wanted */
  double *joint;           /* so many arrays as there are rows, each as `volume`; NULL without */
} TcTallySums;

static inline int tc_tally_width(const TcTally *tally) {
  return (tally->bins + 2 + TC_TALLY_SPARE + 7) / 8 * 8;
}

/* The place of a value (see TcTally). */
static inline double tc_tally_place(const TcTally *tally, double value) {
  const double place = (value - tally->edges[0]) * tally->per_value + 0.5;
  return place > 0 ? place < tally->place_count - 1 ? place : tally->place_count - 1 : 0;
}

/* Adds the share of the cells [begin, end) to the sums. */
typedef void TcTallyCells(const TcTally *tally, int64_t begin, int64_t end, TcTallySums *sums);
TcTallyCells tc_tally_one, tc_tally_avx2, tc_tally_avx512;

#endif
