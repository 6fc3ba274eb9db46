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

/* Rays as they are asked for; double precision whatever the lanes are. Loops over lanes become vectors. */
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

/* The rays of camera `view` through positions (u, v). */
static void tc_view_lines(const TcView *view, const double u[TC_LANES], const double v[TC_LANES], TcLines *lines) {
  double inverse[TC_LANES];
  const double forward = view->orthographic ? 0 : 1; /* what of the shift turns the ray; the rest moves it */
  for (int k = 0; k < 3; ++k) {
    TC_EACH_LANE {
      const double shift = u[l] * view->right[k] + v[l] * view->up[k];
      lines->eye[k][l] = view->eye[k];
      lines->offset[k][l] = (1 - forward) * shift;
      lines->direction[k][l] = view->forward[k] + forward * shift;
    }
  }
  if (view->orthographic) return;
  TC_EACH_LANE {
    const double x = lines->direction[0][l], y = lines->direction[1][l], z = lines->direction[2][l];
    inverse[l] = 1 / sqrt(x * x + y * y + z * z);
  }
  for (int k = 0; k < 3; ++k) {
    TC_EACH_LANE lines->direction[k][l] *= inverse[l];
  }
}

/* Rays whose origins were moved to where they are nearest to the volume's centre. */
typedef struct TcPlaces {
  double origin[3][TC_LANES], rest[3][TC_LANES], from_center[3][TC_LANES], near[TC_LANES];
} TcPlaces;

/* Rays set up, those of `lanes` that may meet the volume; rays of one main axis at a time become a packet. */
typedef struct TcPlaced {
  TcLines lines;
  TcPlaces places;
  int64_t destination[TC_LANES];
  unsigned lanes;
} TcPlaced;

/* eye + offset + along · direction, as origin + rest to twice the precision: whatever `along` was rounded to, the point is on the ray, and
 * vertex − origin is as good as the vertex is. On the screen only Embree needs the point. Rays that pass the volume's sphere, or the part of which that
 * counts does, are left out; the sphere has a margin that covers the rounding here. Written so that NaN passes it. */
static void tc_place(const TcGround *ground, TcPlaced *placed) {
  const TetcastVolume *volume = ground->shell->volume;
  const TcLines *lines = &placed->lines;
  TcPlaces *places = &placed->places;
  double along[TC_LANES] = {0}, distance2[TC_LANES] = {0};
  for (int k = 0; k < 3; ++k) {
    TC_EACH_LANE {
      const double offset = (lines->eye[k][l] - volume->center[k]) + lines->offset[k][l];
      places->from_center[k][l] = offset;
      along[l] -= offset * lines->direction[k][l];
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (ground->screen) {
      TC_EACH_LANE places->from_center[k][l] += along[l] * lines->direction[k][l];
    } else {
      TC_EACH_LANE {
        const double product = along[l] * lines->direction[k][l], shift = product + lines->offset[k][l], origin = lines->eye[k][l] + shift;
        const double rest = tc_product_error(along[l], lines->direction[k][l], product) + tc_sum_error(product, lines->offset[k][l], shift) +
                            tc_sum_error(lines->eye[k][l], shift, origin);
        const double kept = origin > -TC_TINY && origin < TC_TINY ? 0 : origin;
        places->rest[k][l] = rest;
        places->origin[k][l] = kept;
        places->from_center[k][l] = kept - volume->center[k] + rest;
      }
    }
    TC_EACH_LANE distance2[l] += places->from_center[k][l] * places->from_center[k][l];
  }
  const double radius = volume->radius;
  unsigned meet = 0;
  TC_EACH_LANE {
    places->near[l] = -along[l];
    const bool meets = (distance2[l] <= radius * radius) & (lines->begin[l] - along[l] <= radius) & (lines->end[l] - along[l] >= -radius);
    meet |= (unsigned)meets << l;
  }
  placed->lanes &= meet;
}

/* Rays on the screen. */
static void tc_take_screen(const TcScreen *screen, const TcPlaced *placed, TcWaiting *waiting) {
  const TcLines *lines = &placed->lines;
  TcRays *rays = &waiting->rays;
  double shift[TC_LANES]; /* of depths against distances from the eye */
  TC_EACH_LANE {
    const double cosine = lines->direction[0][l] * screen->forward[0] + lines->direction[1][l] * screen->forward[1] +
                          lines->direction[2][l] * screen->forward[2];
    shift[l] = screen->perspective ? -screen->distance / cosine : -screen->distance;
  }
  TcReal scale[TC_LANES], begin[TC_LANES], end[TC_LANES];
  TC_EACH_LANE scale[l] = (TcReal)(screen->perspective ? shift[l] : 1);
  TC_EACH_LANE begin[l] = (TcReal)(lines->begin[l] + shift[l]);
  TC_EACH_LANE end[l] = (TcReal)(lines->end[l] + shift[l]);
  rays->scale = tc_load(scale);
  rays->begin = tc_load(begin);
  rays->end = tc_load(end);
#if TC_SINGLE
  int32_t x[TC_LANES], y[TC_LANES];
  TC_EACH_LANE x[l] = (int32_t)rint(lines->x[l] * screen->unit);
  TC_EACH_LANE y[l] = (int32_t)rint(lines->y[l] * screen->unit);
  memcpy(&rays->x, x, sizeof x);
  memcpy(&rays->y, y, sizeof y);
#else
  rays->x = tc_load(lines->x);
  rays->y = tc_load(lines->y);
#endif
}

#if !TC_SINGLE
/* Rays in ray space, all of them along kz. */
static void tc_take_ray_space(const TcPlaced *placed, int kz, TcRays *rays) {
  const TcLines *lines = &placed->lines;
  const TcPlaces *places = &placed->places;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const TcVec tiny = tc_set(TC_TINY), zero = tc_set(0), dz = tc_load(lines->direction[kz]), rest = tc_load(places->rest[kz]);
  const TcVec near = tc_load(places->near);
#define TC_NOT_TINY(x) tc_select(tc_lt(tc_abs(x), tiny), zero, x)
  rays->kz = kz;
  rays->scale = tc_set(1);
  rays->origin[0] = tc_load(places->origin[kx]);
  rays->origin[1] = tc_load(places->origin[ky]);
  rays->origin[2] = tc_load(places->origin[kz]);
  rays->shear_x = TC_NOT_TINY(tc_load(lines->direction[kx]) / dz);
  rays->shear_y = TC_NOT_TINY(tc_load(lines->direction[ky]) / dz);
  rays->inverse_z = 1 / dz;
  rays->rest_x = TC_NOT_TINY(tc_load(places->rest[kx]) - rays->shear_x * rest);
  rays->rest_y = TC_NOT_TINY(tc_load(places->rest[ky]) - rays->shear_y * rest);
  rays->rest_z = rest * rays->inverse_z;
  rays->begin = tc_load(lines->begin) + near;
  rays->end = tc_load(lines->end) + near;
#undef TC_NOT_TINY
}

/* The lanes of `lanes` whose directions are largest in the same component as that of the first of them. */
static unsigned tc_along_one_axis(const TcLines *lines, unsigned lanes, int *kz) {
  unsigned result = 0;
  for (unsigned left = lanes; left; left &= left - 1) {
    const int l = __builtin_ctz(left);
    const double x = fabs(lines->direction[0][l]), y = fabs(lines->direction[1][l]), z = fabs(lines->direction[2][l]);
    const int axis = z > (y > x ? y : x) ? 2 : y > x;
    if (!result) *kz = axis;
    if (axis == *kz) result |= 1U << l;
  }
  return result;
}
#endif

/* Rays of those placed, of one main axis where that matters, are the next that wait. */
static void tc_enqueue(TcPlaced *placed, TcQueue *queue) {
  const int first = queue->count * TC_LANES;
  TcWaiting *waiting = &queue->waiting[queue->count++];
  waiting->lanes = placed->lanes;
  memcpy(waiting->destination, placed->destination, sizeof waiting->destination);
  for (int k = 0; k < 3; ++k) {
    memcpy(&queue->from_center[k][first], placed->places.from_center[k], sizeof placed->places.from_center[k]);
    memcpy(&queue->direction[k][first], placed->lines.direction[k], sizeof placed->lines.direction[k]);
  }
#if !TC_SINGLE
  if (!queue->ground->screen) {
    int kz = 0;
    waiting->lanes = tc_along_one_axis(&placed->lines, placed->lanes, &kz);
    tc_take_ray_space(placed, kz, &waiting->rays);
    placed->lanes &= ~waiting->lanes;
    return;
  }
#endif
  tc_take_screen(queue->ground->screen, placed, waiting);
  placed->lanes = 0;
}

/* ── hits ── */

/* A face of the shell that the rays of `lanes` cross; those of `ties`, which pass through an edge, perhaps. */
TC_NOINLINE void tc_face_reached(const TcQueue *queue, const TcWaiting *waiting, uint32_t face, unsigned lanes, unsigned ties,
                                 const TcLanePoints p[3]) {
  TcVec e[3];
  TcCrossing crossing;
  tc_edges_of(tc_mask_of(lanes), p, e);
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
