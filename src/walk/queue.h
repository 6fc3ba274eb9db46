/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the faces of the shell that rays cross. Rays wait in a queue until there are as many as Embree takes at once;
 * then their hits are found, and they become packets. */
#ifndef TC_WALK_QUEUE_H
#define TC_WALK_QUEUE_H

#include "walk/place.h"

enum {
  TC_QUEUE_RAYS = TC_LANES > 4 ? 16 : 8, /* how many rays Embree takes at once */
  TC_QUEUE = TC_QUEUE_RAYS / TC_LANES    /* how many packets they make */
};

/* Rays that wait to become a packet. */
typedef struct TcWaiting {
  TcRays rays;
  /* As TcPacket has them. */
  TcWide origin;
  TcWide along[3];
  TcVec slice[TETCAST_MAX_SLICES];
  TcWide start;
  unsigned lanes;    /* the lanes that have a ray */
  unsigned doubtful; /* single precision: lanes whose rays pass an edge of the shell as near as rounding may move it */
  TcVec grazed; /* with TC_BOUND: over which lengths rounding may hide from rays that they pass the shell's inside */
  TcHits *hits; /* [TC_LANES] lists */
  int64_t destination[TC_LANES];
} TcWaiting;

typedef struct TcQueue {
  const TcGround *ground;
  bool bounds; /* whether the kernel has TC_BOUND */
  TcWaiting waiting[TC_QUEUE];
  int next, count; /* the packet that is walked next; how many there are */
  _Alignas(64) double from_center[3][TC_QUEUE_RAYS], direction[3][TC_QUEUE_RAYS];
} TcQueue;

/* Takes as many of the rays placed as make one packet, and lets them wait. */
static void tc_enqueue(TcPlaced *placed, TcQueue *queue) {
  const int first = queue->count * TC_LANES;
  TcWaiting *waiting = &queue->waiting[queue->count++];
  waiting->lanes = tc_take(queue->ground, placed, &waiting->rays);
  waiting->origin = placed->shift;
  if (queue->ground->surfaces) {
    memcpy(waiting->along, placed->lines.direction, sizeof waiting->along);
    waiting->start = placed->near - placed->shift;
    for (int i = 0; i < queue->ground->surfaces->slice_count; ++i)
      waiting->slice[i] = tc_real_of_wide(placed->slice[i] + placed->shift);
  }
  memcpy(waiting->destination, placed->destination, sizeof waiting->destination);
  for (int k = 0; k < 3; ++k) {
    memcpy(&queue->from_center[k][first], &placed->from_center[k], sizeof placed->from_center[k]);
    memcpy(&queue->direction[k][first], &placed->lines.direction[k], sizeof placed->lines.direction[k]);
  }
}

/* ── hits ── */

/* Notes face i of the shell as a hit of those rays of `lanes` that cross it, and returns their lanes. Of the given ones
 * it is known that their rays cross the face or one of its edges; ties are decided here. */
TC_NOINLINE unsigned tc_face_reached(const TcQueue *queue, const TcWaiting *waiting, uint32_t i, unsigned lanes) {
  const uint32_t *vertex = queue->ground->shell->faces[i].vertex;
  TcLanePoints p[3];
  for (int k = 0; k < 3; ++k)
    tc_points_of_one(queue->ground, &waiting->rays, vertex[k], &p[k]);
  TcVec e[3];
  TcCrossing crossing;
  tc_edges_of(tc_mask_of(lanes), p, e);
  const TcMask negative[3] = {tc_negative(e[0]), tc_negative(e[1]), tc_negative(e[2])};
  lanes &= tc_bits(tc_and(tc_and(negative[0], negative[1]), negative[2])) |
           ~tc_bits(tc_or(tc_or(negative[0], negative[1]), negative[2]));
  tc_cross_face(TC_CELLS, queue->ground, &waiting->rays, p, e, &crossing);
  TcReal depth[TC_LANES];
  tc_store(depth, crossing.z);
  for (unsigned left = lanes; left; left &= left - 1) {
    const int l = __builtin_ctz(left);
    TcHit *hit = tc_hits_append(&waiting->hits[l]);
    if (!hit)
      return 0;
    /* Member by member: a struct that is made in memory first and copied then would have to be waited for. */
    hit->begin = hit->end = (double)depth[l];
    hit->id = i;
    hit->done = false;
  }
  return lanes;
}

#if !TC_SINGLE
/* Adds what face i of the shell may be for the rays of `lanes`, which pass by it or end before it. */
TC_NOINLINE void tc_face_passed(const TcQueue *queue, TcWaiting *waiting, uint32_t i, unsigned lanes) {
  const uint32_t *vertex = queue->ground->shell->faces[i].vertex;
  TcLanePoints p[3];
  for (int k = 0; k < 3; ++k)
    tc_points_of_one(queue->ground, &waiting->rays, vertex[k], &p[k]);
  TcVec length;
  tc_graze_face(queue->ground, &waiting->rays, p, &length);
  waiting->grazed += tc_select(tc_mask_of(lanes), length, tc_set(0));
}
#endif

/* The largest cross product of an edge's ends that may have the wrong sign by rounding. In single precision, rounding
 * may decide whether a ray meets the shell or misses it, even if it would cross a large part of the mesh; such rays are
 * walked again. Rounding moves each end of an edge by at most δ = beside + relative · (its distance from the ray), and
 * the distance is at most √2 c, with c the largest coordinate. So it changes the cross product by at most 2 √2 c δ +
 * δ². Taking 1.5 c for √2 c and 3 c for 2 √2 c covers the rounding of the product itself. */
#if TC_SINGLE
TC_INLINE TcVec tc_face_margin(const TcGround *ground, const TcVec x[3], const TcVec y[3]) {
  TcVec most = tc_set(0);
  for (int k = 0; k < 3; ++k)
    most = tc_max(most, tc_max(tc_abs(x[k]), tc_abs(y[k])));
  const TcVec relative = tc_set((TcReal)(1.5 * ground->resolution.relative));
  const TcVec moved = tc_madd(relative, most, tc_set((TcReal)ground->resolution.beside));
  return moved * tc_madd(tc_set(3), most, moved);
}
#endif

/* Looks which of the rays of `lanes` cross face i of the shell; of these it is known that they may. */
static void tc_face_candidate(void *user, uint32_t i, unsigned lanes) {
  TcQueue *queue = user;
  const uint32_t *vertex = queue->ground->shell->faces[i].vertex;
  for (int j = 0; j < TC_QUEUE; ++j) {
    unsigned reached = lanes >> j * TC_LANES & TC_ALL_LANES;
    if (!reached)
      continue;
    TcWaiting *waiting = &queue->waiting[j];
    TcVec x[3], y[3];
    for (int k = 0; k < 3; ++k)
      tc_point_beside(queue->ground, &waiting->rays, vertex[k], &x[k], &y[k]);
    /* If two rounded products differ, their difference has the exact sign. That decides for most lanes. */
    TcMask left = tc_none(), right = left;
#if TC_SINGLE
    const TcVec margin = tc_face_margin(queue->ground, x, y);
    TcMask surely_left = left, surely_right = left, sure = tc_all();
#endif
    for (int k = 0; k < 3; ++k) {
      const int next = k == 2 ? 0 : k + 1;
      const TcVec a = x[k] * y[next], b = y[k] * x[next];
      left = tc_or(left, tc_lt(b, a));
      right = tc_or(right, tc_lt(a, b));
#if TC_SINGLE
      surely_left = tc_or(surely_left, tc_lt(margin, a - b));
      surely_right = tc_or(surely_right, tc_lt(margin, b - a));
      sure = tc_and(sure, tc_lt(margin, tc_abs(a - b)));
#endif
    }
#if TC_SINGLE
    waiting->doubtful |= reached & ~tc_bits(tc_or(sure, tc_and(surely_left, surely_right)));
#endif
    const unsigned crossing = reached & ~tc_bits(tc_and(left, right));
    const unsigned crossed = crossing ? tc_face_reached(queue, waiting, i, crossing) : 0;
#if TC_SINGLE
    (void)crossed;
#else
    if (TC_UNLIKELY(queue->bounds) && reached & ~crossed)
      tc_face_passed(queue, waiting, i, reached & ~crossed);
#endif
  }
}

#if TC_LANES == 1
#include "walk/cells.h"
#endif

/* Forgets the last hit of lane l, which lies behind the ray's end, as far as rounding tells. */
static void tc_queue_forget(const TcQueue *queue, TcWaiting *waiting, int l) {
  const TcHit *hit = &waiting->hits[l].data[--waiting->hits[l].count];
#if TC_SINGLE
  (void)queue, (void)hit;
#else
  if (!queue->bounds)
    return;
#if TC_LANES == 1
  if (!queue->ground->shell->faces) {
    tc_cell_passed(queue->ground, hit->id, true, waiting);
    return;
  }
#endif
  tc_face_passed(queue, waiting, hit->id, 1U << l);
#endif
}

/* Finds what the rays that wait meet in Embree. False if memory has run out. */
static bool tc_queue_trace(TcQueue *queue) {
  const TcShell *shell = queue->ground->shell;
  unsigned lanes = 0;
  for (int j = 0; j < queue->count; ++j) {
    lanes |= queue->waiting[j].lanes << j * TC_LANES;
    queue->waiting[j].doubtful = 0;
    queue->waiting[j].grazed = tc_set(0);
    for (int l = 0; l < TC_LANES; ++l)
      queue->waiting[j].hits[l].count = 0;
  }
  if (!lanes || !shell->embree)
    return true;
  TcPacketCandidateFunction *candidate = tc_face_candidate;
#if TC_LANES == 1
  if (!shell->faces)
    candidate = tc_cell_candidate;
#endif
  tc_embree_query_packet(shell->embree, TC_QUEUE_RAYS, lanes, queue->from_center[0], queue->direction[0], candidate,
                         queue);
  bool ok = true;
  for (int j = 0; j < queue->count; ++j) {
    for (int l = 0; l < TC_LANES; ++l) {
      TcHits *hits = &queue->waiting[j].hits[l];
      tc_hits_sort(hits);
      ok = ok && !hits->out_of_memory;
      while (TC_UNLIKELY(hits->count > 0 &&
                         hits->data[hits->count - 1].begin >= (double)TC_AT(queue->waiting[j].rays.end, l)))
        tc_queue_forget(queue, &queue->waiting[j], l);
    }
  }
  return ok;
}

#endif
