/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel for packets of neighbouring rays, compiled once for each instruction set: the including file defines
 *     PACKET_KERNEL, PACKET_CAST   the names of the two functions
 * It computes what the scalar kernel (kernel_tmpl.h) does: the same faces and cells, and light that agrees to rounding. */
#include "render/packet_light.h"
#include "render/packet_walk.h"
#include "render/render.h"
#include "traverse/walk.h"

/* The widths of a packet's pixels. */
enum { PACKET_X = TC_LANES == 8 ? 4 : 2, PACKET_Y = 2 };

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
    rest[k] = tc_product_rest(along, direction[k], product);
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

/* ── where the rays enter and leave ── */

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
    const TcVec component[4] = {tc_set(record[0]), tc_set(record[1]), tc_set(record[2]), tc_set(record[3])};
    p[k] = tc_project_components(query->rays, component, tc_set_word(face->vertex[k]));
  }
  TcVec e[3], z, s;
  tc_edges(mask, (const TcPoints *const[]){&p[0], &p[1], &p[2]}, (const TcPoints *const[]){&p[1], &p[2], &p[0]}, e);
  const unsigned signs[3] = {tc_bits(tc_gt(e[0], tc_set(0))), tc_bits(tc_gt(e[1], tc_set(0))), tc_bits(tc_gt(e[2], tc_set(0)))};
  unsigned inside = lanes & ((signs[0] & signs[1] & signs[2]) | ~(signs[0] | signs[1] | signs[2]));
  if (!inside) return;
  tc_crossings(p, e, &z, &s);
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

/* The next face at which a lane sets out, or false. next: where to look from. */
static bool next_start(const TcSpans *spans, int64_t *next, uint32_t *face) {
  while (*next < spans->count && spans->data[*next].done) ++*next;
  if (*next == spans->count) return false;
  *face = spans->data[(*next)++].id;
  return true;
}

/* The path that left `cell` through the face whose vertices have this XOR need not be walked from there. */
static void mark_done(const TcShell *shell, TcSpans *spans, int64_t from, uint32_t cell, uint32_t vertex_xor) {
  for (int64_t j = from; j < spans->count; ++j) {
    if (tc_shell_face_is(&shell->faces[spans->data[j].id], cell, vertex_xor)) spans->data[j].done = true;
  }
}

/* The lanes of `active` that are at the shell. */
TC_INLINE unsigned at_shell(const TcShell *shell, TcMask active, TcWord cell) {
  unsigned ended = tc_bits(tc_and(active, tc_gt_word(cell, tc_set_word(TC_SHELL - 1))));
  if (!shell->visible) return ended;
  for (unsigned lanes = tc_bits(active) & ~ended; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    if (!shell->visible[cell[i] >> TC_CLUSTER_BITS]) ended |= 1U << i;
  }
  return ended;
}

/* ── a packet ── */

/* One step of the lanes of `active`: the cells ahead are crossed and their light added, beyond *seen. */
TC_INLINE TcMask cross(const TetcastVolume *volume, const bool wide, const bool cells, const TcPieces *pieces, double thin,
                       const TcRays *rays, TcMask active, TcWalks *walks, TcVec *seen, TcLights *lights, int64_t *segments) {
  const TcVec z = walks->z, s = walks->s;
  const TcWord cell = walks->cell;
  const TcMask lost = tc_walks_step(volume, wide, rays, active, walks);
  TcMask moved = tc_and(tc_and_not(active, lost), tc_gt(walks->z, *seen));
  *segments += __builtin_popcount(tc_bits(moved));
  const TcVec from = *seen;
  *seen = tc_select(moved, walks->z, from);
  if (cells) {
    double value[TC_LANES] = {0};
    for (unsigned lanes = tc_bits(moved); lanes; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      value[i] = volume->cell_values[cell[i]];
    }
    TcVec values;
    memcpy(&values, value, sizeof values);
    moved = tc_and(moved, tc_eq(values, values)); /* NaN is transparent */
    tc_lights_add(lights, pieces, thin, moved, walks->z - from, values, values);
  } else {
    TcVec s0 = s;
    const TcMask behind = tc_and(moved, tc_lt(z, from));
    if (tc_any(behind)) { /* part of the segment has been seen: at the eye, or where the mesh folds */
      const TcVec w = (from - z) / (walks->z - z);
      s0 = tc_select(behind, (1 - w) * s + w * walks->s, s);
    }
    moved = tc_and(moved, tc_and(tc_eq(s0, s0), tc_eq(walks->s, walks->s)));
    tc_lights_add(lights, pieces, thin, moved, walks->z - from, s0, walks->s);
  }
  return lost;
}

/* All paths of the rays in `lanes`; returns the number of steps. */
TC_INLINE int64_t cast_lanes(const TcShell *shell, const bool wide, const bool cells, const TcPieces *pieces,
                             const TcTolerance *tolerance, const TcRays *rays, unsigned lanes, TcLights *lights, unsigned *stopped,
                             TcWorker *worker) {
  TcSpans *spans = worker->spans;
  int64_t next[TC_LANES] = {0}, segments = 0;
  uint32_t face[TC_LANES] = {0};
  TcWalks walks;
  memset(&walks, 0, sizeof walks);
  unsigned starting = 0;
  for (int i = 0; i < TC_LANES; ++i) {
    if (lanes >> i & 1 && next_start(&spans[i], &next[i], &face[i])) starting |= 1U << i;
  }
  TcMask active = tc_mask_of(0);
  TcVec seen = tc_set(0);
  int64_t step = 0;
  while (starting || tc_any(active)) {
    if (starting) {
      const TcMask mask = tc_mask_of(starting);
      tc_walks_begin(shell, wide, rays, mask, face, &walks);
      seen = tc_select(mask, tc_max(walks.z, rays->near), seen);
      active = tc_or(active, mask);
      starting = 0;
    }
    const TcWord from = walks.cell;
    const TcMask lost = cross(shell->volume, wide, cells, pieces, tolerance->thin, rays, active, &walks, &seen, lights, &segments);
    if (++step % 64 == 0) tc_lights_end_block(lights);
    const TcMask opaque = tc_lights_opaque(lights, pieces, tolerance->opaque, active);
    *stopped |= tc_bits(opaque);
    worker->lost += __builtin_popcount(tc_bits(lost));
    active = tc_and_not(active, tc_or(lost, opaque));
    unsigned ended = at_shell(shell, active, walks.cell);
    active = tc_and_not(active, tc_mask_of(ended));
    if (!ended) continue;
    const TcWord vertex_xor = walks.v[0].id ^ walks.v[1].id ^ walks.v[2].id;
    for (; ended; ended &= ended - 1) {
      const int i = __builtin_ctz(ended);
      mark_done(shell, &spans[i], next[i], from[i], vertex_xor[i]);
      if (next_start(&spans[i], &next[i], &face[i])) starting |= 1U << i;
    }
  }
  tc_lights_end_block(lights);
  worker->segments += segments;
  return step;
}

/* The light of a packet of rays, any rays; *steps is at least the number of each one's segments. */
TC_INLINE bool cast_packet(const TcShell *shell, const bool wide, const bool cells, const TcPieces *pieces, const Lines *lines,
                           unsigned lanes, TcWorker *worker, TcLight light[TC_LANES], int64_t *steps) {
  TcRays placed, rays;
  TcVec rest[3];
  for (int i = 0; i < TC_LANES; ++i) light[i] = tc_light_begin(worker->tolerance.thin, worker->tolerance.opaque);
  lanes &= tc_bits(place_rays(shell->volume, lines, &placed, rest));
  *steps = 0;
  for (int kz = 0; kz < 3 && lanes; ++kz) {
    const unsigned along = lanes & tc_bits(lanes_along(placed.direction, kz));
    if (!along) continue;
    turn_rays(&placed, rest, kz, &rays);
    if (!trace(shell, &rays, along, worker->spans)) return false;
    TcLights lights;
    unsigned stopped = 0;
    tc_lights_begin(&lights);
    const int64_t most = cast_lanes(shell, wide, cells, pieces, &worker->tolerance, &rays, along, &lights, &stopped, worker);
    *steps = most > *steps ? most : *steps;
    for (unsigned left = along; left; left &= left - 1) {
      const int i = __builtin_ctz(left);
      light[i].depth = lights.depth[i];
      for (int k = 0; k < 3; ++k) light[i].color[k] = lights.color[k][i];
      light[i].stopped = stopped >> i & 1;
    }
  }
  return true;
}

TC_INLINE bool render_tile(const TcJob *job, const bool wide, const bool cells, int64_t x0, int64_t y0, int64_t x1, int64_t y1,
                           TcWorker *worker) {
  const int samples = job->samples_x * job->samples_y;
  const double columns = (double)(job->width * job->samples_x), rows = (double)(job->height * job->samples_y);
  for (int64_t y = y0; y < y1; y += PACKET_Y) {
    for (int64_t x = x0; x < x1; x += PACKET_X) {
      double sum[TC_LANES][4] = {{0}}, error[TC_LANES] = {0}, u[TC_LANES], v[TC_LANES];
      for (int i = 0; i < samples; ++i) {
        unsigned lanes = 0;
        for (int lane = 0; lane < TC_LANES; ++lane) {
          const int64_t px = x + lane % PACKET_X, py = y + lane / PACKET_X;
          if (px < x1 && py < y1) lanes |= 1U << lane;
          u[lane] = 2 * ((double)(px * job->samples_x + i % job->samples_x) + 0.5) / columns - 1;
          v[lane] = 1 - 2 * ((double)(py * job->samples_y + i / job->samples_x) + 0.5) / rows;
        }
        TcVec us, vs;
        memcpy(&us, u, sizeof us);
        memcpy(&vs, v, sizeof vs);
        Lines lines;
        TcLight light[TC_LANES];
        int64_t steps;
        view_lines(&job->view, us, vs, &lines);
        if (!cast_packet(job->shell, wide, cells, job->pieces, &lines, lanes, worker, light, &steps)) return false;
        for (int lane = 0; lane < TC_LANES; ++lane) {
          if (light[lane].depth == 0) continue;
          for (int k = 0; k < 3; ++k) sum[lane][k] += light[lane].color[k];
          sum[lane][3] -= expm1(-light[lane].depth);
          error[lane] += tc_tolerance_bound(&worker->tolerance, &light[lane], steps);
        }
      }
      for (int lane = 0; lane < TC_LANES; ++lane) {
        const int64_t px = x + lane % PACKET_X, py = y + lane / PACKET_X;
        if (px >= x1 || py >= y1) continue;
        for (int k = 0; k < 4; ++k) sum[lane][k] /= samples;
        const double bound = tc_frame_store(job->frame, px, py, sum[lane], error[lane] / samples);
        if (!(bound <= worker->error)) worker->error = bound;
      }
    }
  }
  return true;
}

/* One function for each way the data lie. */
#define TILE(name, wide, cells)                                                                                                 \
  static __attribute__((noinline)) bool name(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) { \
    return render_tile(job, wide, cells, x0, y0, x1, y1, worker);                                                               \
  }
TILE(tile_wide, true, false)
TILE(tile_narrow, false, false)
TILE(tile_wide_cells, true, true)
TILE(tile_narrow_cells, false, true)

bool PACKET_KERNEL(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) {
  const bool wide = job->shell->volume->vertices_are_double, cells = job->shell->volume->association == TETCAST_CELL;
  if (cells) return (wide ? tile_wide_cells : tile_narrow_cells)(job, x0, y0, x1, y1, worker);
  return (wide ? tile_wide : tile_narrow)(job, x0, y0, x1, y1, worker);
}

bool PACKET_CAST(const TcShell *shell, const TcPieces *pieces, const TcLine *line, int count, TcWorker *worker, TcLight *light) {
  for (int begin = 0; begin < count; begin += TC_LANES) {
    const int lanes = count - begin < TC_LANES ? count - begin : TC_LANES;
    Lines lines;
    TcLight part[TC_LANES];
    int64_t steps;
    for (int i = 0; i < TC_LANES; ++i) {
      const TcLine *one = &line[begin + (i < lanes ? i : 0)];
      for (int k = 0; k < 3; ++k) {
        lines.eye[k][i] = one->eye[k];
        lines.offset[k][i] = one->offset[k];
        lines.direction[k][i] = one->direction[k];
      }
    }
    const unsigned bits = (1U << lanes) - 1;
    const bool cells = shell->volume->association == TETCAST_CELL;
    const bool ok = shell->volume->vertices_are_double ? cast_packet(shell, true, cells, pieces, &lines, bits, worker, part, &steps)
                                                : cast_packet(shell, false, cells, pieces, &lines, bits, worker, part, &steps);
    if (!ok) return false;
    memcpy(light + begin, part, (size_t)lanes * sizeof *light);
  }
  return true;
}
