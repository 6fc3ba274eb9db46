/* SPDX-License-Identifier: Apache-2.0 */
/* A trail: the cells that rays have crossed. Each lane of each packet has a list of its own, in which its rays'
 * crossings lie one after the other, so that those of one ray are next to each other and need not be moved again. */
#ifndef TC_WALK_TRAIL_H
#define TC_WALK_TRAIL_H

#include <tetcast/cast.h>

#include "base/base.h"

enum { TC_TRAIL_LISTS = 32 }; /* as many as there are packets times lanes, or more */

/* What a kernel with a trail tells of each ray: its length in cells, how many of these it crosses over a length above
 * 0, the list that has them, and where in it they begin. */
enum { TC_TRACE_LENGTH, TC_TRACE_CELLS, TC_TRACE_LIST, TC_TRACE_FIRST, TC_TRACE_SUMS };

/* How the host counts along a ray: its number is the depth, plus `near`, times both scales, and not beyond its ends. */
typedef struct TcTrailWay {
  double near, scale[2], begin;
  double end, unused[3]; /* so that kernels may read it as twice four numbers */
} TcTrailWay;

/* The crossings of one ray after the other. */
typedef struct TcTrailList {
  TetcastCrossing *data; /* [capacity], and room for one more */
  int64_t count, capacity;
} TcTrailList;

typedef struct TcTrail {
  TetcastContext *context;
  bool weights; /* whether vertices and weights are wanted; else they are 0 */
  TcTrailList list[TC_TRAIL_LISTS];
  int taken; /* how many lists belong to packets */
  bool out_of_memory;

  /* The following are the same for all rays. */
  const TcTrailWay *ways; /* [rays] */
  double scale[2];        /* a length times both is one in the mesh's unit */
} TcTrail;

/* Makes room for some more crossings in each of `count` lists from `first` on. False if memory has run out, which is
 * noted. */
bool tc_trail_grow(TcTrail *trail, int first, int count);
/* Forgets all crossings, but keeps the memory. */
void tc_trail_restart(TcTrail *trail);
void tc_trail_clear(TcTrail *trail);

#endif
