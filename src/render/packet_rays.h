/* SPDX-License-Identifier: Apache-2.0 */
/* camera.c, rayspace.c and trace.c for a packet of rays: from pixels to the faces at which rays enter and leave. */
#ifndef TC_RENDER_PACKET_RAYS_H
#define TC_RENDER_PACKET_RAYS_H

#include "render/packet_walk.h"
#include "render/render.h"

typedef struct Lines {
  TcVec eye[3], offset[3], direction[3];
} Lines;

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

/* tc_ray_begin() up to the choice of kz: rays in all lanes, with their components in the order x, y, z. */
static TcMask place_rays(const TetcastVolume *volume, const Lines *lines, TcRays *rays, TcVec rest[3]) {
  const TcVec *direction = lines->direction;
  TcVec along = tc_set(0), distance2 = tc_set(0);
  for (int k = 0; k < 3; ++k) along += (volume->center[k] - lines->eye[k] - lines->offset[k]) * direction[k];
  for (int k = 0; k < 3; ++k) {
    const TcVec product = along * direction[k];
    TcVec shift;
    rest[k] = tc_product_errors(along, direction[k], product);
    rest[k] += two_sum(product, lines->offset[k], &shift);
    rest[k] += two_sum(lines->eye[k], shift, &rays->origin[k]);
    rays->origin[k] = without_tiny(rays->origin[k]);
    rays->direction[k] = direction[k];
    rays->from_center[k] = rays->origin[k] - volume->center[k] + rest[k];
    distance2 += rays->from_center[k] * rays->from_center[k];
  }
  rays->near = -along;
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
static void turn_rays(const TcRays *placed, const TcVec rest[3], int kz, TcRays *rays) {
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  *rays = *placed;
  rays->kz = kz;
  rays->origin[0] = placed->origin[kx];
  rays->origin[1] = placed->origin[ky];
  rays->origin[2] = placed->origin[kz];
  rays->shear_x = without_tiny(placed->direction[kx] / placed->direction[kz]);
  rays->shear_y = without_tiny(placed->direction[ky] / placed->direction[kz]);
  rays->inverse_z = 1 / placed->direction[kz];
  rays->rest_x = without_tiny(rest[kx] - rays->shear_x * rest[kz]);
  rays->rest_y = without_tiny(rest[ky] - rays->shear_y * rest[kz]);
  rays->rest_z = rest[kz] * rays->inverse_z;
}

typedef struct Query {
  const TcShell *shell;
  const TcRays *rays;
  TcSpans *spans; /* [TC_LANES] */
} Query;

/* A shell face that the lanes of `lanes` may cross. */
static void face_candidate(void *user, uint32_t i, unsigned lanes) {
  Query *query = user;
  const TcShellFace *face = &query->shell->faces[i];
  const TcMask mask = tc_mask_of(lanes);
  TcPoints p[3];
  for (int k = 0; k < 3; ++k) {
    double record[4];
    tc_volume_vertex(query->shell->volume, face->vertex[k], record);
    TcVec component[4] = {tc_set(record[0]), tc_set(record[1]), tc_set(record[2]), tc_set(record[3])};
    tc_turn(query->rays->kz, component);
    p[k] = tc_project_components(query->rays, component, tc_set_word(face->vertex[k]));
  }
  TcVec e[3], z, s;
  tc_edges(mask, (const TcPoints *const[]){&p[0], &p[1], &p[2]}, (const TcPoints *const[]){&p[1], &p[2], &p[0]}, e);
  const unsigned signs[3] = {tc_bits(tc_gt(e[0], tc_set(0))), tc_bits(tc_gt(e[1], tc_set(0))), tc_bits(tc_gt(e[2], tc_set(0)))};
  unsigned inside = lanes & ((signs[0] & signs[1] & signs[2]) | ~(signs[0] | signs[1] | signs[2]));
  if (!inside) return;
  tc_crossings(false, p, e, &z, &s);
  for (; inside; inside &= inside - 1) {
    const int lane = __builtin_ctz(inside);
    tc_spans_append(&query->spans[lane], (TcSpan){.begin = z[lane], .end = z[lane], .s0 = s[lane], .id = i});
  }
}

static bool trace(const TcShell *shell, const TcRays *rays, unsigned lanes, TcSpans *spans) {
  Query query = {shell, rays, spans};
  for (int i = 0; i < TC_LANES; ++i) spans[i].count = 0;
  double from_center[3][TC_LANES], direction[3][TC_LANES];
  memcpy(from_center, rays->from_center, sizeof from_center);
  memcpy(direction, rays->direction, sizeof direction);
  if (!shell->embree) return true;
  tc_embree_query_packet(shell->embree, TC_LANES, lanes, from_center[0], direction[0], face_candidate, &query);
  bool ok = true;
  for (int i = 0; i < TC_LANES; ++i) {
    tc_spans_sort(&spans[i]);
    for (int64_t j = 0; j < spans[i].count; ++j) spans[i].data[j].done = false;
    ok = ok && !spans[i].out_of_memory;
  }
  return ok;
}

#endif
