/* SPDX-License-Identifier: Apache-2.0 */
/* From rays to the faces of the shell that they cross: rays are set up in lanes, wait until there are as many as Embree sees at once, and become
 * packets. */
#ifndef TC_WALK_QUEUE_H
#define TC_WALK_QUEUE_H

#include "base/exact.h"
#include "walk/packet.h"

enum {
  TC_QUEUE_RAYS = TC_LANES > 4 ? 16 : 8, /* of which Embree is asked at once */
  TC_QUEUE = TC_QUEUE_RAYS / TC_LANES    /* packets */
};

/* What Embree and setting up work on, double precision whatever the lanes are. */
typedef struct TcLines {
  double eye[3][TC_LANES], offset[3][TC_LANES], direction[3][TC_LANES], begin[TC_LANES], end[TC_LANES];
  double x[TC_LANES], y[TC_LANES]; /* on the screen, in pixels, where there is one */
} TcLines;

/* Rays that wait to become a packet. */
typedef struct TcWaiting {
  TcRays rays;
  unsigned lanes;
  TcHits *hits;
  int64_t destination[TC_LANES];
} TcWaiting;

typedef struct TcQueue {
  const TcGround *ground;
  TcWaiting waiting[TC_QUEUE];
  int next, count;
  _Alignas(64) double from_center[3][TC_QUEUE_RAYS], direction[3][TC_QUEUE_RAYS];
} TcQueue;

/* The ray of camera `view` through position (u, v). */
static void tc_view_lines(const TcView *view, const double u[TC_LANES], const double v[TC_LANES], TcLines *lines) {
  for (int l = 0; l < TC_LANES; ++l) {
    double d[3], length = 1;
    for (int k = 0; k < 3; ++k) {
      const double shift = u[l] * view->right[k] + v[l] * view->up[k];
      lines->eye[k][l] = view->eye[k];
      lines->offset[k][l] = view->orthographic ? shift : 0;
      d[k] = view->orthographic ? view->forward[k] : view->forward[k] + shift;
    }
    if (!view->orthographic) length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int k = 0; k < 3; ++k) lines->direction[k][l] = d[k] / length;
  }
}

/* A ray whose origin was moved to where it is nearest to the volume's centre. */
typedef struct TcPlace {
  double origin[3], rest[3], from_center[3], near;
} TcPlace;

/* Rays set up, those of `lanes` that may meet the volume; rays of one kz at a time become a packet. */
typedef struct TcPlaced {
  TcLines lines;
  TcPlace place[TC_LANES];
  int64_t destination[TC_LANES];
  unsigned lanes;
} TcPlaced;

/* eye + offset + along · direction, as origin + rest to twice the precision: whatever `along` was rounded to, the point is on the ray, and
 * vertex − origin is as good as the vertex is. False: the ray passes the volume's sphere, which has a margin that covers the rounding here; written
 * so that NaN passes it. */
static bool tc_place(const TetcastVolume *volume, const TcLines *lines, int l, TcPlace *place) {
  double along = 0, distance2 = 0;
  for (int k = 0; k < 3; ++k) along += (volume->center[k] - lines->eye[k][l] - lines->offset[k][l]) * lines->direction[k][l];
  for (int k = 0; k < 3; ++k) {
    const double product = along * lines->direction[k][l], shift = product + lines->offset[k][l], origin = lines->eye[k][l] + shift;
    const double rest = tc_product_error(along, lines->direction[k][l], product) + tc_sum_error(product, lines->offset[k][l], shift) +
                        tc_sum_error(lines->eye[k][l], shift, origin);
    place->rest[k] = rest;
    place->origin[k] = tc_without_tiny(origin);
    place->from_center[k] = place->origin[k] - volume->center[k] + rest;
    distance2 += place->from_center[k] * place->from_center[k];
  }
  place->near = -along;
  return distance2 <= volume->radius * volume->radius && lines->begin[l] - along <= volume->radius && lines->end[l] - along >= -volume->radius;
}

static void tc_place_all(const TetcastVolume *volume, TcPlaced *placed) {
  for (unsigned lanes = placed->lanes; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    if (!tc_place(volume, &placed->lines, l, &placed->place[l])) placed->lanes &= ~(1U << l);
  }
}

/* A lane's ray in its packet's order of axes; on the screen it is where its pixel is. */
static void tc_take_ray(const TcGround *ground, const TcPlaced *placed, int l, TcRays *rays) {
  const TcLines *lines = &placed->lines;
  const TcPlace *place = &placed->place[l];
  const TcScreen *screen = ground->screen;
  double shift = place->near; /* of depths against distances from the eye */
  if (screen) {
    double cosine = 0; /* of the angle between the ray and the middle of the view */
    for (int k = 0; k < 3; ++k) cosine += lines->direction[k][l] * screen->forward[k];
    const double scale = screen->perspective ? screen->distance / cosine : 1;
    TC_AT(rays->scale, l) = (TcReal)(screen->perspective ? -scale : 1);
    shift = screen->perspective ? -scale : -screen->distance;
#if TC_SINGLE
    TC_AT(rays->x, l) = (TcInteger)nearbyint(lines->x[l] * screen->unit);
    TC_AT(rays->y, l) = (TcInteger)nearbyint(lines->y[l] * screen->unit);
#else
    TC_AT(rays->x, l) = lines->x[l];
    TC_AT(rays->y, l) = lines->y[l];
  } else {
    const int kz = rays->kz, kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    const double inverse = 1 / lines->direction[kz][l];
    const double shear_x = tc_without_tiny(lines->direction[kx][l] / lines->direction[kz][l]);
    const double shear_y = tc_without_tiny(lines->direction[ky][l] / lines->direction[kz][l]);
    TC_AT(rays->scale, l) = 1;
    TC_AT(rays->origin[0], l) = place->origin[kx];
    TC_AT(rays->origin[1], l) = place->origin[ky];
    TC_AT(rays->origin[2], l) = place->origin[kz];
    TC_AT(rays->shear_x, l) = shear_x;
    TC_AT(rays->shear_y, l) = shear_y;
    TC_AT(rays->inverse_z, l) = inverse;
    TC_AT(rays->rest_x, l) = tc_without_tiny(place->rest[kx] - shear_x * place->rest[kz]);
    TC_AT(rays->rest_y, l) = tc_without_tiny(place->rest[ky] - shear_y * place->rest[kz]);
    TC_AT(rays->rest_z, l) = place->rest[kz] * inverse;
#endif
  }
  TC_AT(rays->begin, l) = (TcReal)(lines->begin[l] + shift);
  TC_AT(rays->end, l) = (TcReal)(lines->end[l] + shift);
}

/* The component in which the ray's direction is largest. */
static int tc_main_axis(const TcLines *lines, int l) {
  const double x = fabs(lines->direction[0][l]), y = fabs(lines->direction[1][l]), z = fabs(lines->direction[2][l]);
  return z > (y > x ? y : x) ? 2 : y > x;
}

/* Rays of those placed, of one main axis where that matters, are the next that wait. */
static void tc_enqueue(TcPlaced *placed, TcQueue *queue) {
  const int first = queue->count * TC_LANES;
  TcWaiting *waiting = &queue->waiting[queue->count++];
  const int kz = tc_main_axis(&placed->lines, __builtin_ctz(placed->lanes));
  waiting->rays.kz = kz;
  waiting->lanes = 0;
  for (unsigned lanes = placed->lanes; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    if (!queue->ground->screen && tc_main_axis(&placed->lines, l) != kz) continue;
    waiting->lanes |= 1U << l;
    tc_take_ray(queue->ground, placed, l, &waiting->rays);
    waiting->destination[l] = placed->destination[l];
    for (int k = 0; k < 3; ++k) {
      queue->from_center[k][first + l] = placed->place[l].from_center[k];
      queue->direction[k][first + l] = placed->lines.direction[k][l];
    }
  }
  placed->lanes &= ~waiting->lanes;
}

/* ── hits ── */

/* A face of the shell that the rays of `lanes` cross; those of `ties`, which pass through an edge, perhaps. */
TC_NOINLINE void tc_face_reached(const TcQueue *queue, const TcWaiting *waiting, uint32_t face, unsigned lanes, unsigned ties,
                                 const TcLanePoints p[3]) {
  TcVec e[3];
  TcCrossing crossing;
  tc_edges(tc_mask_of(lanes), (const TcLanePoints *const[]){&p[1], &p[2], &p[0]}, (const TcLanePoints *const[]){&p[2], &p[0], &p[1]}, e);
  if (ties) {
    const unsigned negative[3] = {tc_bits(tc_negative(e[0])), tc_bits(tc_negative(e[1])), tc_bits(tc_negative(e[2]))};
    lanes &= ~ties | (negative[0] & negative[1] & negative[2]) | ~(negative[0] | negative[1] | negative[2]);
  }
  tc_cross_face(TC_CELLS, queue->ground, &waiting->rays, p, e, &crossing);
  TcReal depth[TC_LANES];
  tc_store(depth, crossing.z);
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    TcHit *hit = tc_hits_append(&waiting->hits[l]);
    if (!hit) return;
    hit->begin = hit->end = (double)depth[l]; /* member by member: what is put together in memory first has to be waited for */
    hit->id = face;
    hit->done = false;
  }
}

/* Face i of the shell, which the rays of `lanes` may cross. */
static void tc_face_candidate(void *user, uint32_t i, unsigned lanes) {
  const TcQueue *queue = user;
  const uint32_t *vertex = queue->ground->shell->faces[i].vertex;
  TC_UNROLLED for (int j = 0; j < TC_QUEUE; ++j) {
    const unsigned of_packet = lanes >> j * TC_LANES & TC_ALL_LANES;
    if (!of_packet) continue;
    const TcWaiting *waiting = &queue->waiting[j];
    TcLanePoints p[3];
    for (int k = 0; k < 3; ++k) tc_points_of_one(queue->ground, &waiting->rays, vertex[k], &p[k]);
    /* An edge has the sign of the difference of two products, rounded or not, if they differ: most lanes need no more. */
    TcMask left = tc_none(), right = left, decided = tc_all();
    for (int k = 0; k < 3; ++k) {
      const TcVec a = p[k].x * p[(k + 1) % 3].y, b = p[k].y * p[(k + 1) % 3].x;
      const TcMask above = tc_gt(a, b), below = tc_lt(a, b);
      left = tc_or(left, above);
      right = tc_or(right, below);
      decided = tc_and(decided, tc_or(above, below));
    }
    const unsigned reached = of_packet & ~tc_bits(tc_and(left, right));
    if (!reached) continue;
    const TcLanePoints copy[3] = {p[0], p[1], p[2]};
    tc_face_reached(queue, waiting, i, reached, reached & ~tc_bits(decided), copy);
  }
}

#if TC_LANES == 1
#include "walk/cells.h"
#endif

/* What the rays that wait meet in Embree; false: out of memory. */
static bool tc_queue_trace(TcQueue *queue) {
  const TcShell *shell = queue->ground->shell;
  unsigned lanes = 0;
  for (int j = 0; j < queue->count; ++j) {
    lanes |= queue->waiting[j].lanes << j * TC_LANES;
    for (int l = 0; l < TC_LANES; ++l) queue->waiting[j].hits[l].count = 0;
  }
  if (!lanes || !shell->embree) return true;
  TcPacketCandidateFunction *candidate = tc_face_candidate;
#if TC_LANES == 1
  if (!shell->faces) candidate = tc_cell_candidate;
#endif
  tc_embree_query_packet(shell->embree, TC_QUEUE_RAYS, lanes, queue->from_center[0], queue->direction[0], candidate, queue);
  bool ok = true;
  for (int j = 0; j < queue->count; ++j) {
    for (int l = 0; l < TC_LANES; ++l) {
      tc_hits_sort(&queue->waiting[j].hits[l]);
      ok = ok && !queue->waiting[j].hits[l].out_of_memory;
    }
  }
  return ok;
}

#endif
