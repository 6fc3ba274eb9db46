/* SPDX-License-Identifier: Apache-2.0 */
/* A trail: the cells that packets of rays have crossed, step after step, as lanes have them. */
#ifndef TC_WALK_TRAIL_H
#define TC_WALK_TRAIL_H

#include "base/base.h"

/* A step is so many numbers for each lane, one kind after the other, and so many words. */
enum {
  TC_TRAIL_BEGIN, /* the depths between which a part of the ray lies in the cell */
  TC_TRAIL_END,
  TC_TRAIL_PLAIN_NUMBERS,
  /* With weights: */
  TC_TRAIL_AT_ENTRY = TC_TRAIL_PLAIN_NUMBERS, /* those of the vertices of the face where the ray enters the cell */
  TC_TRAIL_AT_EXIT = TC_TRAIL_AT_ENTRY + 3,   /* those of the vertices of the face where it leaves it */
  TC_TRAIL_FROM = TC_TRAIL_AT_EXIT + 3, /* the fractions of the way through the cell between which the part lies */
  TC_TRAIL_TO,
  TC_TRAIL_NUMBERS
};
enum {
  TC_TRAIL_RAY, /* UINT32_MAX: the lane has crossed nothing */
  TC_TRAIL_CELL,
  TC_TRAIL_PLAIN_WORDS,
  /* With weights: the vertices of these faces. */
  TC_TRAIL_ENTRY = TC_TRAIL_PLAIN_WORDS,
  TC_TRAIL_EXIT = TC_TRAIL_ENTRY + 3,
  TC_TRAIL_WORDS = TC_TRAIL_EXIT + 3
};

typedef struct TcTrail {
  TetcastContext *context;
  bool weights;
  double *data;
  int64_t count, capacity; /* in numbers */
  bool out_of_memory;
} TcTrail;

/* Makes room for more. False if memory has run out, which is noted. */
bool tc_trail_grow(TcTrail *trail);
void tc_trail_clear(TcTrail *trail);

/* A step's words come first, and so many doubles of them are before its numbers. */
static inline int64_t tc_trail_before_numbers(const TcTrail *trail, int lanes) {
  return (trail->weights ? TC_TRAIL_WORDS : TC_TRAIL_PLAIN_WORDS) / 2 * lanes;
}

/* How many doubles a step of so many lanes takes. */
static inline int64_t tc_trail_size(const TcTrail *trail, int lanes) {
  return tc_trail_before_numbers(trail, lanes) + (trail->weights ? TC_TRAIL_NUMBERS : TC_TRAIL_PLAIN_NUMBERS) * lanes;
}

/* Appends a step for the caller to fill. NULL if memory has run out. */
static inline double *tc_trail_step(TcTrail *trail, int lanes) {
  const int64_t size = tc_trail_size(trail, lanes);
  if (trail->count + size > trail->capacity && !tc_trail_grow(trail))
    return NULL;
  double *step = trail->data + trail->count;
  trail->count += size;
  return step;
}

#endif
