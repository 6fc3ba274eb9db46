/* SPDX-License-Identifier: Apache-2.0 */
/* camera.c, rayspace.c and trace.c for a packet of rays: from pixels to the faces at which rays enter and leave. */
#ifndef TC_RENDER_PACKET_RAYS_H
#define TC_RENDER_PACKET_RAYS_H

#include "render/packet_walk.h"
#include "render/render.h"

/* Before a loop over packets, whose instructions then mix. */
#if defined(__clang__)
#define TC_UNROLLED _Pragma("clang loop unroll(full)")
#else
#define TC_UNROLLED _Pragma("GCC unroll 4")
#endif

typedef struct Lines {
  TcVec eye[3], offset[3], direction[3];
} Lines;

/* Rays of any direction, with their components in the order x, y, z. */
typedef struct Placed {
  TcVec origin[3], rest[3], from_center[3], direction[3], near;
} Placed;

/* Rays with the same kz that wait to become a packet. */
typedef struct Waiting {
  TcRays rays;
  unsigned lanes;
  int64_t x, y;   /* first pixel */
  TcSpans *spans; /* [TC_LANES]: the shell faces they cross */
} Waiting;

/* Rays that Embree sees together: those of twice as many lanes take it little longer. */
typedef struct Queue {
  const TcShell *shell;
  Waiting waiting[TC_PACKETS];
  int next, count;
  _Alignas(64) double from_center[3][TC_PACKETS * TC_LANES], direction[3][TC_PACKETS * TC_LANES];
} Queue;

/* tc_view_line() */
static void view_lines(const TcView *view, TcVec u, TcVec v, Lines *lines) {
  for (int k = 0; k < 3; ++k) {
    const TcVec shift = u * view->right[k] + v * view->up[k];
    lines->eye[k] = tc_set(view->eye[k]);
    lines->offset[k] = view->orthographic ? shift : tc_set(0);
    lines->direction[k] = view->orthographic ? tc_set(view->forward[k]) : view->forward[k] + shift;
  }
  if (view->orthographic) return;
  TcVec *d = lines->direction;
  const TcVec length = tc_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (int k = 0; k < 3; ++k) d[k] /= length;
}

static TcVec two_sum(TcVec a, TcVec b, TcVec *sum) {
  const TcVec s = a + b, t = s - a;
  *sum = s;
  return (a - (s - t)) + (b - t);
}

static TcVec without_tiny(TcVec x) { return tc_select(tc_lt(tc_abs(x), tc_set(TC_TINY)), tc_set(0), x); }

/* tc_ray_begin() up to the choice of kz, for rays in all lanes. */
static TcMask place_rays(const TetcastVolume *volume, const Lines *lines, Placed *placed) {
  const TcVec *direction = lines->direction;
  TcVec along = tc_set(0), distance2 = tc_set(0);
  for (int k = 0; k < 3; ++k) along += (volume->center[k] - lines->eye[k] - lines->offset[k]) * direction[k];
  for (int k = 0; k < 3; ++k) {
    const TcVec product = along * direction[k];
    TcVec shift, origin;
    TcVec rest = tc_product_errors(along, direction[k], product);
    rest += two_sum(product, lines->offset[k], &shift);
    rest += two_sum(lines->eye[k], shift, &origin);
    placed->rest[k] = rest;
    placed->origin[k] = without_tiny(origin);
    placed->direction[k] = direction[k];
    placed->from_center[k] = placed->origin[k] - volume->center[k] + rest;
    distance2 += placed->from_center[k] * placed->from_center[k];
  }
  placed->near = -along;
  const TcVec radius = tc_set(volume->radius);
  return tc_and(tc_le(distance2, radius * radius), tc_le(-along, radius));
}

/* The lanes whose direction is largest in component kz, by the scalar rule. */
static TcMask lanes_along(const TcVec direction[3], int kz) {
  const TcVec x = tc_abs(direction[0]), y = tc_abs(direction[1]), z = tc_abs(direction[2]);
  const TcMask third = tc_gt(z, tc_max(y, x)), second = tc_and_not(tc_gt(y, x), third);
  return kz == 2 ? third : kz == 1 ? second : tc_and_not(tc_and_not(tc_all(), third), second);
}

/* The rest of tc_ray_begin(), for the lanes along kz. */
static void turn_rays(const Placed *placed, int kz, TcRays *rays) {
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  rays->kz = kz;
  rays->near = placed->near;
  rays->origin[0] = placed->origin[kx];
  rays->origin[1] = placed->origin[ky];
  rays->origin[2] = placed->origin[kz];
  rays->shear_x = without_tiny(placed->direction[kx] / placed->direction[kz]);
  rays->shear_y = without_tiny(placed->direction[ky] / placed->direction[kz]);
  rays->inverse_z = 1 / placed->direction[kz];
  rays->rest_x = without_tiny(placed->rest[kx] - rays->shear_x * placed->rest[kz]);
  rays->rest_y = without_tiny(placed->rest[ky] - rays->shear_y * placed->rest[kz]);
  rays->rest_z = placed->rest[kz] * rays->inverse_z;
}

/* The rays of one kz, among those of the bits of *left, are the next that wait. */
static void enqueue(const Placed *placed, unsigned *left, int64_t x, int64_t y, Queue *queue) {
  const int first = queue->count * TC_LANES;
  Waiting *waiting = &queue->waiting[queue->count++];
  waiting->lanes = 0;
  for (int kz = 0; !waiting->lanes; ++kz) {
    waiting->lanes = *left & tc_bits(lanes_along(placed->direction, kz));
    if (waiting->lanes) turn_rays(placed, kz, &waiting->rays);
  }
  *left &= ~waiting->lanes;
  waiting->x = x;
  waiting->y = y;
  for (int k = 0; k < 3; ++k) {
    memcpy(&queue->from_center[k][first], &placed->from_center[k], sizeof(TcVec));
    memcpy(&queue->direction[k][first], &placed->direction[k], sizeof(TcVec));
  }
}

/* A shell face that the rays of `lanes` cross, those of `ties`, which pass through an edge, perhaps. */
static __attribute__((noinline)) void face_reached(const Waiting *waiting, uint32_t face, unsigned lanes, unsigned ties, const TcPoints p[3]) {
  TcVec e[3], z, s;
  tc_edges(tc_mask_of(lanes), (const TcPoints *const[]){&p[0], &p[1], &p[2]}, (const TcPoints *const[]){&p[1], &p[2], &p[0]}, e);
  if (ties) {
    const unsigned signs[3] = {tc_bits(tc_gt(e[0], tc_set(0))), tc_bits(tc_gt(e[1], tc_set(0))), tc_bits(tc_gt(e[2], tc_set(0)))};
    lanes &= ~ties | (signs[0] & signs[1] & signs[2]) | ~(signs[0] | signs[1] | signs[2]);
  }
  tc_crossings(true, p, e, &z, &s);
  double depth[TC_LANES];
  memcpy(depth, &z, sizeof depth);
  for (; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    TcSpan *span = tc_spans_append(&waiting->spans[i]);
    if (!span) return;
    span->begin = span->end = depth[i]; /* member by member: what is put together in memory first has to be waited for */
    span->id = face;
    span->done = false;
  }
}

/* Shell face i, which the rays of `lanes` may cross. */
static void face_candidate(void *user, uint32_t i, unsigned lanes) {
  const Queue *queue = user;
  const uint32_t *vertex = queue->shell->faces[i].vertex;
  TcRecord record[3];
  for (int k = 0; k < 3; ++k) record[k] = tc_load_record(queue->shell->volume, vertex[k]);
  TC_UNROLLED for (int j = 0; j < TC_PACKETS; ++j) {
    const unsigned of_packet = lanes >> j * TC_LANES & tc_bits(tc_all());
    if (!of_packet) continue;
    const TcRays *rays = &queue->waiting[j].rays;
    const int kz = rays->kz, kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
    TcPoints p[3];
    for (int k = 0; k < 3; ++k) {
      const TcVec component[4] = {tc_set(record[k][kx]), tc_set(record[k][ky]), tc_set(record[k][kz]), tc_set(0)};
      p[k] = tc_project_components(rays, component, tc_set_word(vertex[k]));
    }
    /* An edge has the sign of the difference of two products, rounded or not, if they differ: most lanes need no more. */
    TcMask left = tc_mask_of(0), right = left, decided = tc_all();
    for (int k = 0; k < 3; ++k) {
      const TcVec a = p[k].x * p[(k + 1) % 3].y, b = p[k].y * p[(k + 1) % 3].x;
      const TcMask above = tc_gt(a, b), below = tc_lt(a, b);
      left = tc_or(left, above);
      right = tc_or(right, below);
      decided = tc_and(decided, tc_or(above, below));
    }
    const unsigned reached = of_packet & ~tc_bits(tc_and(left, right));
    if (!reached) continue;
    const TcPoints copy[3] = {p[0], p[1], p[2]};
    face_reached(&queue->waiting[j], i, reached, reached & ~tc_bits(decided), copy);
  }
}

/* The shell faces on the rays that wait; false: out of memory. */
static bool trace(Queue *queue) {
  unsigned lanes = 0;
  for (int j = 0; j < queue->count; ++j) {
    lanes |= queue->waiting[j].lanes << j * TC_LANES;
    for (int i = 0; i < TC_LANES; ++i) queue->waiting[j].spans[i].count = 0;
  }
  if (!lanes || !queue->shell->embree) return true;
  tc_embree_query_packet(queue->shell->embree, TC_PACKETS * TC_LANES, lanes, queue->from_center[0], queue->direction[0], face_candidate, queue);
  bool ok = true;
  for (int j = 0; j < queue->count; ++j) {
    for (int i = 0; i < TC_LANES; ++i) {
      tc_spans_sort(&queue->waiting[j].spans[i]);
      ok = ok && !queue->waiting[j].spans[i].out_of_memory;
    }
  }
  return ok;
}

#endif
