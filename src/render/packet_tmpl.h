/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel for packets of neighbouring rays, compiled once for each instruction set: the including file defines
 *     PACKET_KERNEL, PACKET_CAST   the names of the two functions
 * It computes what the scalar kernel (kernel_tmpl.h) does: the same faces and cells, and light that agrees to rounding. */
#include "render/packet_light.h"
#include "render/packet_rays.h"
#include "traverse/walk.h"

enum {
  PACKET_X = TC_LANES == 8 ? 4 : 2, /* a packet's pixels */
  PACKET_Y = 2
};

typedef struct Packet {
  TcRays rays;
  TcWalks walks;
  TcLights lights;
  TcVec seen; /* depth up to which a path has been seen */
  TcMask active;
  unsigned lanes;    /* those of rays */
  unsigned starting; /* those that set out anew, from `face` */
  unsigned stopped;
  int64_t steps, next[TC_LANES];
  uint32_t face[TC_LANES];
  TcSpans *spans;
  int64_t x, y; /* first pixel */
} Packet;

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

/* The rays along kz among those placed; false: out of memory. */
static bool packet_begin(const TcShell *shell, const TcRays *placed, const TcVec rest[3], int kz, unsigned lanes, TcSpans *spans,
                         Packet *packet) {
  memset(&packet->walks, 0, sizeof packet->walks);
  turn_rays(placed, rest, kz, &packet->rays);
  tc_lights_begin(&packet->lights);
  packet->active = tc_mask_of(0);
  packet->seen = tc_set(0);
  packet->lanes = lanes;
  packet->starting = packet->stopped = 0;
  packet->steps = 0;
  packet->spans = spans;
  if (!trace(shell, &packet->rays, lanes, spans)) return false;
  for (int i = 0; i < TC_LANES; ++i) {
    packet->next[i] = 0;
    if (lanes >> i & 1 && next_start(&spans[i], &packet->next[i], &packet->face[i])) packet->starting |= 1U << i;
  }
  return true;
}

static bool packet_runs(const Packet *packet) { return packet->starting || tc_any(packet->active); }

/* Lanes that end, and perhaps set out anew. */
static __attribute__((noinline)) void leave(const TcShell *shell, Packet *packet, TcWorker *worker, TcWord from, TcMask lost,
                                            TcMask opaque, unsigned ended) {
  const TcWalks *walks = &packet->walks;
  packet->stopped |= tc_bits(opaque);
  worker->lost += __builtin_popcount(tc_bits(lost));
  ended &= ~(tc_bits(opaque) | tc_bits(lost));
  packet->active = tc_and_not(tc_and_not(packet->active, tc_or(lost, opaque)), tc_mask_of(ended));
  const TcWord vertex_xor = walks->v[0].id ^ walks->v[1].id ^ walks->v[2].id;
  for (; ended; ended &= ended - 1) {
    const int i = __builtin_ctz(ended);
    mark_done(shell, &packet->spans[i], packet->next[i], from[i], vertex_xor[i]);
    if (next_start(&packet->spans[i], &packet->next[i], &packet->face[i])) packet->starting |= 1U << i;
  }
}

/* Steps of a packet until a lane sets out anew. */
TC_INLINE void advance(const TcShell *shell, const bool wide, const bool cells, const TcPieces *pieces, TcWorker *worker,
                       Packet *packet) {
  if (packet->starting) {
    const TcMask mask = tc_mask_of(packet->starting);
    tc_walks_begin(shell, wide, &packet->rays, mask, packet->face, &packet->walks);
    packet->seen = tc_select(mask, tc_max(packet->walks.z, packet->rays.near), packet->seen);
    packet->active = tc_or(packet->active, mask);
    packet->starting = 0;
  }
  TcWalks *walks = &packet->walks;
  TcMask active = packet->active;
  for (;;) {
    const TcWord from = walks->cell;
    const TcMask lost = cross(shell->volume, wide, cells, pieces, worker->tolerance.thin, &packet->rays, active, walks, &packet->seen,
                              &packet->lights, &worker->segments);
    if (++packet->steps % 64 == 0) tc_lights_end_block(&packet->lights);
    const TcMask opaque = tc_lights_opaque(&packet->lights, pieces, worker->tolerance.opaque, active);
    const unsigned ended = at_shell(shell, active, walks->cell);
    if (!(tc_bits(opaque) | tc_bits(lost) | ended)) continue;
    leave(shell, packet, worker, from, lost, opaque, ended);
    active = packet->active;
    if (packet->starting || !tc_any(active)) return;
  }
}

/* One function for each way the data lie. */
typedef void Advance(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Packet *packet);
#define ADVANCE(name, wide, cells)                                                                                               \
  static __attribute__((noinline)) void name(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Packet *packet) { \
    advance(shell, wide, cells, pieces, worker, packet);                                                                       \
  }
ADVANCE(advance_wide, true, false)
ADVANCE(advance_narrow, false, false)
ADVANCE(advance_wide_cells, true, true)
ADVANCE(advance_narrow_cells, false, true)

static Advance *advance_for(const TetcastVolume *volume) {
  if (volume->association == TETCAST_CELL) return volume->vertices_are_double ? advance_wide_cells : advance_narrow_cells;
  return volume->vertices_are_double ? advance_wide : advance_narrow;
}

/* ── a tile ── */

typedef struct Tile {
  const TcJob *job;
  TcWorker *worker;
  int64_t x0, y0, x1, y1;
  int64_t x, y; /* of the packet whose rays come next */
  int sample;
  TcRays placed; /* rays that wait: those of one kz go together */
  TcVec rest[3];
  unsigned waiting;
  int64_t waiting_x, waiting_y;
  double sum[TC_TILE * TC_TILE][5]; /* red, green, blue, alpha, bound of their error */
} Tile;

/* Places the rays of the next packet of pixels; false: there is none. */
static bool place_next(Tile *tile) {
  const TcJob *job = tile->job;
  if (tile->y >= tile->y1) return false;
  double u[TC_LANES], v[TC_LANES];
  unsigned lanes = 0;
  for (int lane = 0; lane < TC_LANES; ++lane) {
    const int64_t px = tile->x + lane % PACKET_X, py = tile->y + lane / PACKET_X;
    if (px < tile->x1 && py < tile->y1) lanes |= 1U << lane;
    u[lane] = 2 * ((double)(px * job->samples_x + tile->sample % job->samples_x) + 0.5) / (double)(job->width * job->samples_x) - 1;
    v[lane] = 1 - 2 * ((double)(py * job->samples_y + tile->sample / job->samples_x) + 0.5) / (double)(job->height * job->samples_y);
  }
  TcVec us, vs;
  memcpy(&us, u, sizeof us);
  memcpy(&vs, v, sizeof vs);
  Lines lines;
  view_lines(&job->view, us, vs, &lines);
  tile->waiting = lanes & tc_bits(place_rays(job->shell->volume, &lines, &tile->placed, tile->rest));
  tile->waiting_x = tile->x;
  tile->waiting_y = tile->y;
  if (++tile->sample < job->samples_x * job->samples_y) return true;
  tile->sample = 0;
  tile->x += PACKET_X;
  if (tile->x < tile->x1) return true;
  tile->x = tile->x0;
  tile->y += PACKET_Y;
  return true;
}

/* The next packet that meets anything. *more: whether there was one. False: out of memory. */
static bool next_packet(Tile *tile, TcSpans *spans, Packet *packet, bool *more) {
  *more = true;
  for (;;) {
    while (!tile->waiting) {
      if (!place_next(tile)) {
        *more = false;
        return true;
      }
    }
    unsigned along = 0;
    int kz = -1;
    while (!along) along = tile->waiting & tc_bits(lanes_along(tile->placed.direction, ++kz));
    tile->waiting &= ~along;
    packet->x = tile->waiting_x;
    packet->y = tile->waiting_y;
    if (!packet_begin(tile->job->shell, &tile->placed, tile->rest, kz, along, spans, packet)) return false;
    if (packet_runs(packet)) return true;
  }
}

static void finish_packet(Tile *tile, Packet *packet) {
  tc_lights_end_block(&packet->lights);
  const TcVec alpha = tc_segments_constant(tc_all(), packet->lights.depth).w0;
  for (unsigned left = packet->lanes; left; left &= left - 1) {
    const int i = __builtin_ctz(left);
    double *sum = tile->sum[(packet->y + i / PACKET_X - tile->y0) * TC_TILE + packet->x + i % PACKET_X - tile->x0];
    const TcLight light = {.depth = packet->lights.depth[i], .stopped = packet->stopped >> i & 1};
    for (int k = 0; k < 3; ++k) sum[k] += packet->lights.color[k][i];
    sum[3] += alpha[i];
    sum[4] += tc_tolerance_bound(&tile->worker->tolerance, &light, alpha[i], packet->steps);
  }
}

static void store_tile(const Tile *tile) {
  const double samples = tile->job->samples_x * tile->job->samples_y;
  for (int64_t y = tile->y0; y < tile->y1; ++y) {
    for (int64_t x = tile->x0; x < tile->x1; ++x) {
      const double *sum = tile->sum[(y - tile->y0) * TC_TILE + x - tile->x0];
      const double rgba[4] = {sum[0] / samples, sum[1] / samples, sum[2] / samples, sum[3] / samples};
      const double bound = tc_frame_store(tile->job->frame, x, y, rgba, sum[4] / samples);
      if (!(bound <= tile->worker->error)) tile->worker->error = bound;
    }
  }
}

bool PACKET_KERNEL(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) {
  Tile tile = {.job = job, .worker = worker, .x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1, .x = x0, .y = y0};
  Advance *const step = advance_for(job->shell->volume);
  Packet packet;
  for (;;) {
    bool more;
    if (!next_packet(&tile, worker->spans, &packet, &more)) return false;
    if (!more) break;
    while (packet_runs(&packet)) step(job->shell, job->pieces, worker, &packet);
    finish_packet(&tile, &packet);
  }
  store_tile(&tile);
  return true;
}

bool PACKET_CAST(const TcShell *shell, const TcPieces *pieces, const TcLine *line, int count, TcWorker *worker, TcLight *light) {
  Advance *const step = advance_for(shell->volume);
  for (int begin = 0; begin < count; begin += TC_LANES) {
    const int rays = count - begin < TC_LANES ? count - begin : TC_LANES;
    Lines lines;
    for (int i = 0; i < TC_LANES; ++i) {
      const TcLine *one = &line[begin + (i < rays ? i : 0)];
      for (int k = 0; k < 3; ++k) {
        lines.eye[k][i] = one->eye[k];
        lines.offset[k][i] = one->offset[k];
        lines.direction[k][i] = one->direction[k];
      }
      if (i < rays) light[begin + i] = tc_light_begin(worker->tolerance.thin, worker->tolerance.opaque);
    }
    TcRays placed;
    TcVec rest[3];
    const unsigned lanes = ((1U << rays) - 1) & tc_bits(place_rays(shell->volume, &lines, &placed, rest));
    for (int kz = 0; kz < 3; ++kz) {
      const unsigned along = lanes & tc_bits(lanes_along(placed.direction, kz));
      Packet packet;
      if (!along) continue;
      if (!packet_begin(shell, &placed, rest, kz, along, worker->spans, &packet)) return false;
      while (packet_runs(&packet)) step(shell, pieces, worker, &packet);
      tc_lights_end_block(&packet.lights);
      for (unsigned left = along; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        light[begin + i].depth = packet.lights.depth[i];
        for (int k = 0; k < 3; ++k) light[begin + i].color[k] = packet.lights.color[k][i];
        light[begin + i].stopped = packet.stopped >> i & 1;
      }
    }
  }
  return true;
}
