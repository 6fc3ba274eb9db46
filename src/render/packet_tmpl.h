/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel for packets of neighbouring rays, compiled once for each instruction set: the including file defines
 *     PACKET_KERNEL, PACKET_CAST   the names of the two functions
 * It computes what the scalar kernel (kernel_tmpl.h) does: the same faces and cells, and light that agrees to rounding. */
#include "render/packet_light.h"
#include "render/packet_rays.h"
#include "traverse/walk.h"

/* for each packet i of those under way */
#define TC_EACH_PACKET TC_UNROLLED for (int i = 0; i < TC_PACKETS; ++i)

enum {
  PACKET_X = TC_LANES == 8 ? 4 : 2, /* a packet's pixels */
  PACKET_Y = 2
};

typedef struct Packet {
  TcRays rays;
  TcWalks walks;
  TcLights lights;
  TcParts parts;
  TcVec seen; /* depth up to which a path has been seen */
  unsigned active;   /* lanes on their way, those of `ended` included */
  unsigned lanes;    /* those of rays */
  unsigned starting; /* those that set out anew, from `face` */
  unsigned ended;    /* those at the shell, which wait until the packet is looked at */
  unsigned stopped;
  unsigned again; /* those with more faces left than the one where they leave, perhaps */
  TcWord from;    /* the cells last crossed */
  int64_t steps, next[TC_LANES];
  uint32_t face[TC_LANES];
  TcSpans *spans;
  int64_t x, y; /* first pixel */
  TcVec single; /* bound of what is off by single precision */
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

/* The lanes whose cells can't be seen. */
static unsigned invisible(const TcShell *shell, unsigned lanes, const uint32_t *cell) {
  unsigned result = 0;
  for (; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    if (!shell->visible[cell[i] >> TC_CLUSTER_BITS]) result |= 1U << i;
  }
  return result;
}

/* The lanes of `active` that are at the shell. */
TC_INLINE unsigned at_shell(const TcShell *shell, TcMask active, TcWord cell) {
  const unsigned ended = tc_bits(tc_and(active, tc_high_bit(cell)));
  if (!shell->visible) return ended;
  uint32_t at[TC_LANES];
  memcpy(at, &cell, sizeof at);
  return ended | invisible(shell, tc_bits(active) & ~ended, at);
}

/* The light of what walks have crossed, in the lanes of `moved`: `cell` from depth z and scalar s on, what lies beyond *seen. */
TC_INLINE void add_light(const TetcastVolume *volume, const bool cells, const bool colored, const TcPieces *pieces, TcMask moved, TcVec z,
                         TcVec s, TcWord cell, Packet *packet, TcWorker *worker) {
  const TcWalks *walks = &packet->walks;
  const TcVec from = packet->seen;
  moved = tc_and(moved, tc_gt(walks->z, from));
  worker->segments += __builtin_popcount(tc_bits(moved));
  packet->seen = tc_select(moved, walks->z, from);
  if (cells) {
    const TcWord zero = {0}, index = tc_select_word(moved, cell, zero);
    TcVec value;
    for (int i = 0; i < TC_LANES; ++i) value[i] = volume->cell_values[index[i]];
    moved = tc_and(moved, tc_eq(value, value)); /* NaN is transparent */
    tc_lights_add_constant(colored, &packet->lights, &packet->parts, pieces, moved, walks->z - from, value);
  } else {
    TcVec s0 = s;
    const TcMask behind = tc_and(moved, tc_lt(z, from));
    if (tc_any(behind)) { /* part of the segment has been seen: at the eye, or where the mesh folds */
      const TcVec w = (from - z) / (walks->z - z);
      s0 = tc_select(behind, (1 - w) * s + w * walks->s, s);
    }
    moved = tc_and(moved, tc_and(tc_eq(s0, s0), tc_eq(walks->s, walks->s)));
    TcParts *parts = &packet->parts;
    parts->length = tc_select(moved, walks->z - from, parts->length);
    parts->s0 = tc_select(moved, s0, parts->s0);
    parts->done = tc_select(moved, s0, parts->done);
    tc_lights_add(colored, &packet->lights, parts, pieces, worker->tolerance.thin, tc_or(moved, parts->pending), walks->s);
  }
}

/* Rays that wait become a packet, whose spans are free for others. Its walks are as they were: those under way count. */
static void packet_begin(Waiting *waiting, const TcLights *dark, Packet *packet) {
  TcSpans *spans = waiting->spans;
  waiting->spans = packet->spans;
  packet->rays = waiting->rays;
  packet->lights = *dark;
  packet->active = 0;
  packet->seen = tc_set(0);
  packet->lanes = waiting->lanes;
  packet->ended = packet->starting = packet->stopped = 0;
  packet->single = tc_set(0);
  packet->steps = 0;
  packet->spans = spans;
  packet->x = waiting->x;
  packet->y = waiting->y;
  for (int i = 0; i < TC_LANES; ++i) {
    packet->next[i] = 0;
    if (packet->lanes >> i & 1 && next_start(&spans[i], &packet->next[i], &packet->face[i])) packet->starting |= 1U << i;
  }
}

static bool packet_runs(const Packet *packet) { return packet->starting || packet->active; }

/* The lanes of `starting` set out. */
static void set_out(const TcShell *shell, const bool wide, const bool cells, Packet *packet) {
  TcWalks *walks = &packet->walks;
  const TcMask mask = tc_mask_of(packet->starting);
  tc_walks_begin(shell, wide, cells, &packet->rays, mask, packet->face, walks);
  packet->seen = tc_select(mask, tc_max(walks->z, packet->rays.near), packet->seen);
  packet->active |= packet->starting;
  packet->starting = packet->again = 0;
  for (int i = 0; i < TC_LANES; ++i) {
    if (packet->active >> i & 1 && packet->spans[i].count - packet->next[i] > 1) packet->again |= 1U << i;
  }
}

/* The lanes of `ended` may set out anew. */
static void arrive(const TcShell *shell, Packet *packet) {
  const TcWalks *walks = &packet->walks;
  const TcWord vertex_xor = walks->v[0].id ^ walks->v[1].id ^ walks->v[2].id;
  packet->active &= ~packet->ended;
  for (; packet->ended; packet->ended &= packet->ended - 1) {
    const int i = __builtin_ctz(packet->ended);
    mark_done(shell, &packet->spans[i], packet->next[i], packet->from[i], vertex_xor[i]);
    if (next_start(&packet->spans[i], &packet->next[i], &packet->face[i])) packet->starting |= 1U << i;
  }
}

/* Steps of packets until one has to be looked at: because all its lanes have ended, or one that may set out anew has. Of most rays only
 * the face where they leave is left when they end; they need not be looked at one by one, and what is hard to predict is not branched on.
 *
 * A packet's next step waits for the one before, about 200 cycles; another packet's fits in between. */
TC_INLINE void advance(const TcShell *shell, const bool wide, const bool cells, const bool colored, const TcPieces *pieces, TcWorker *worker,
                       Packet *packet) {
  TcMask active[TC_PACKETS];
  bool halt = false;
  TC_EACH_PACKET {
    if (packet[i].starting) set_out(shell, wide, cells, &packet[i]);
    active[i] = tc_mask_of(packet[i].active & ~packet[i].ended);
  }
  while (!halt) {
    TcStep step[TC_PACKETS];
    TcVec z[TC_PACKETS], s[TC_PACKETS];
    TcMask walking[TC_PACKETS], lost[TC_PACKETS];
    TC_EACH_PACKET {
      walking[i] = tc_and_not(active[i], packet[i].parts.pending);
      z[i] = packet[i].walks.z;
      s[i] = packet[i].walks.s;
      packet[i].from = tc_select_word(walking[i], packet[i].walks.cell, packet[i].from);
      tc_step_cells(shell->volume, walking[i], &packet[i].walks, &step[i]);
    }
    TC_EACH_PACKET tc_step_vertices(shell->volume, wide, &packet[i].rays, &step[i]);
    TC_EACH_PACKET lost[i] = tc_step_out(cells, walking[i], &step[i], &packet[i].walks);
    TC_EACH_PACKET add_light(shell->volume, cells, colored, pieces, tc_and_not(walking[i], lost[i]), z[i], s[i], packet[i].from, &packet[i], worker);
    TC_EACH_PACKET {
      if (++packet[i].steps % 64 == 0) tc_lights_end_block(colored, &packet[i].lights);
      const TcMask opaque = tc_lights_opaque(colored, &packet[i].lights, pieces, worker->tolerance.opaque, active[i]);
      if (tc_any(tc_or(lost[i], opaque))) {
        packet[i].stopped |= tc_bits(opaque);
        worker->lost += __builtin_popcount(tc_bits(lost[i]));
        active[i] = tc_and_not(active[i], tc_or(lost[i], opaque));
        packet[i].parts.pending = tc_and(packet[i].parts.pending, active[i]);
        packet[i].active &= ~(tc_bits(lost[i]) | tc_bits(opaque));
        halt = halt || !packet[i].active;
      }
      const TcMask ready = tc_and_not(active[i], packet[i].parts.pending);
      active[i] = tc_and_not(active[i], tc_mask_of(at_shell(shell, ready, packet[i].walks.cell)));
      const unsigned ended = packet[i].active & ~tc_bits(active[i]);
      halt = halt || (ended && (ended == packet[i].active || ended & packet[i].again));
    }
  }
  TC_EACH_PACKET {
    packet[i].ended = packet[i].active & ~tc_bits(active[i]);
    if (packet[i].ended == packet[i].active || packet[i].ended & packet[i].again) arrive(shell, &packet[i]);
  }
}

/* One function for each way the data lie, and for what is asked of them. */
typedef void Advance(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Packet packet[TC_PACKETS]);
#define ADVANCE(name, wide, cells, colored)                                                                                      \
  static __attribute__((noinline)) void name(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Packet *packet) { \
    advance(shell, wide, cells, colored, pieces, worker, packet);                                                              \
  }
#define ADVANCES(name, colored)              \
  ADVANCE(name##_narrow, false, false, colored) \
  ADVANCE(name##_wide, true, false, colored)    \
  ADVANCE(name##_narrow_cells, false, true, colored) \
  ADVANCE(name##_wide_cells, true, true, colored)
ADVANCES(depth, false)
ADVANCES(color, true)

static Advance *advance_for(const TetcastVolume *volume, const TcPieces *pieces) {
  static Advance *const ways[2][2][2] = {{{depth_narrow, depth_wide}, {depth_narrow_cells, depth_wide_cells}},
                                         {{color_narrow, color_wide}, {color_narrow_cells, color_wide_cells}}};
  return ways[!pieces->one_color][volume->association == TETCAST_CELL][volume->vertices_are_double];
}

#include "render/packet_single.h"

/* Where packets come from, and what becomes of their light. */
typedef struct Source {
  bool (*next)(void *user, Queue *queue); /* puts the rays of a packet into the queue; false: there are no more */
  void (*finish)(void *user, const Packet *packet);
  void *user;
} Source;

/* *more: whether there was one. False: out of memory. */
static bool next_packet(const Source *source, const TcLights *dark, Queue *queue, Packet *packet, bool *more) {
  if (queue->next == queue->count) {
    queue->next = queue->count = 0;
    while (queue->count < TC_PACKETS && source->next(source->user, queue)) continue;
    if (!trace(queue)) return false;
  }
  *more = queue->next < queue->count;
  if (*more) packet_begin(&queue->waiting[queue->next++], dark, packet);
  return true;
}

static void end_lights(const TcPieces *pieces, TcLights *lights) {
  TcLights last = *lights; /* of which only this is needed */
  tc_lights_end_block(!pieces->one_color, &last);
  lights->depth = last.depth;
  for (int k = 0; k < 3; ++k) lights->color[k] = last.color[k];
  lights->alpha = tc_segments_constant(tc_all(), lights->depth).w0;
  for (int k = 0; pieces->one_color && k < 3; ++k) lights->color[k] = lights->alpha * pieces->largest[k];
}

/* All packets of a source, several at a time. */
static bool run_packets(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, const Source *source) {
  enum { MOST = 2 * TC_PACKETS };
  Advance *step = advance_for(shell->volume, pieces);
  int count = TC_PACKETS;
#ifdef TC_HAVE_SINGLE
  if (worker->tolerance.single_most > 0) step = single_advance_for(shell->volume, pieces), count = MOST;
#endif
  Packet packets[MOST];
  bool under_way[MOST] = {false};
  Queue queue = {.shell = shell};
  TcLights dark;
  tc_lights_begin(&dark);
  memset(packets, 0, sizeof packets);
  for (int i = 0; i < MOST; ++i) packets[i].spans = worker->spans + i * TC_PACKET;
  for (int i = 0; i < TC_PACKETS; ++i) queue.waiting[i].spans = worker->spans + (MOST + i) * TC_PACKET;
  for (;;) {
    bool any = false;
    for (int i = 0; i < count; ++i) {
      while (!packet_runs(&packets[i])) {
        if (under_way[i]) {
          end_lights(pieces, &packets[i].lights);
          source->finish(source->user, &packets[i]);
        }
        if (!next_packet(source, &dark, &queue, &packets[i], &under_way[i])) return false;
        if (!under_way[i]) break;
      }
      any = any || under_way[i];
    }
    if (!any) return true;
    step(shell, pieces, worker, packets);
  }
}

/* ── a tile ── */

typedef struct Tile {
  const TcJob *job;
  TcWorker *worker;
  int64_t x0, y0, x1, y1;
  int64_t x, y; /* of the packet whose rays come next */
  int sample;
  Placed placed; /* rays of which those of `left` remain: those of one kz go together */
  unsigned left;
  int64_t left_x, left_y;
  double sum[5][TC_TILE][TC_TILE]; /* red, green, blue, alpha, bound of their error */
} Tile;

/* Places the rays of the next packet of pixels. */
static void place_next(Tile *tile) {
  const TcJob *job = tile->job;
  TcVec x, y;
  for (int i = 0; i < TC_LANES; ++i) {
    x[i] = i % PACKET_X;
    y[i] = i / PACKET_X;
  }
  const TcMask inside = tc_and(tc_lt(x, tc_set((double)(tile->x1 - tile->x))), tc_lt(y, tc_set((double)(tile->y1 - tile->y))));
  const TcVec column = (x + (double)tile->x) * job->samples_x + tile->sample % job->samples_x;
  const TcVec row = (y + (double)tile->y) * job->samples_y + tile->sample / job->samples_x;
  Lines lines;
  view_lines(&job->view, 2 * (column + 0.5) / (double)(job->width * job->samples_x) - 1,
             1 - 2 * (row + 0.5) / (double)(job->height * job->samples_y), &lines);
  tile->left = tc_bits(tc_and(inside, place_rays(job->shell->volume, &lines, &tile->placed)));
  for (int64_t py = tile->y; py < tile->y + PACKET_Y; ++py) tc_frame_expect(job->frame, tile->x, py);
  tile->left_x = tile->x;
  tile->left_y = tile->y;
  if (++tile->sample < job->samples_x * job->samples_y) return;
  tile->sample = 0;
  tile->y += PACKET_Y; /* so that two packets in turn fill a square, or nearly */
  if (tile->y < tile->y1) return;
  tile->y = tile->y0;
  tile->x += PACKET_X;
}

static bool next_of_tile(void *user, Queue *queue) {
  Tile *tile = user;
  while (!tile->left && tile->x < tile->x1) place_next(tile);
  if (!tile->left) return false;
  enqueue(&tile->placed, &tile->left, tile->left_x, tile->left_y, queue);
  return true;
}

static void finish_of_tile(void *user, const Packet *packet) {
  Tile *tile = user;
  const TcLights *lights = &packet->lights;
  const TcTolerance *tolerance = &tile->worker->tolerance;
  /* In proportion to the opacity, where nothing was left behind. */
  TcVec bound = lights->alpha * tc_tolerance_bound(tolerance, &(TcLight){.stopped = false}, 1, packet->steps);
  for (unsigned left = packet->stopped; left; left &= left - 1) {
    const int i = __builtin_ctz(left);
    bound[i] = tc_tolerance_bound(tolerance, &(TcLight){.depth = lights->depth[i], .stopped = true}, lights->alpha[i], packet->steps);
  }
  bound += packet->single;
  const TcVec *of_lanes[5] = {&lights->color[0], &lights->color[1], &lights->color[2], &lights->alpha, &bound};
  for (int k = 0; k < 5; ++k) {
    double (*sum)[TC_TILE] = &tile->sum[k][packet->y - tile->y0];
    const TcVec value = tc_select(tc_mask_of(packet->lanes), *of_lanes[k], tc_set(0));
    for (int i = 0; i < TC_LANES; ++i) sum[i / PACKET_X][packet->x - tile->x0 + i % PACKET_X] += value[i];
  }
}

static void store_tile(Tile *tile) {
  const double samples = tile->job->samples_x * tile->job->samples_y;
  double *sum = tile->sum[0][0];
  for (size_t i = 0; samples > 1 && i < sizeof tile->sum / sizeof *sum; ++i) sum[i] /= samples;
  for (int64_t y = tile->y0; y < tile->y1; ++y) {
    for (int64_t x = tile->x0; x < tile->x1; ++x) {
      double mean[5];
      for (int k = 0; k < 5; ++k) mean[k] = tile->sum[k][y - tile->y0][x - tile->x0];
      const double bound = tc_frame_store(tile->job->frame, x, y, mean, mean[4]);
      if (!(bound <= tile->worker->error)) tile->worker->error = bound;
    }
  }
}

bool PACKET_KERNEL(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) {
  Tile tile = {.job = job, .worker = worker, .x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1, .x = x0, .y = y0};
  const Source source = {next_of_tile, finish_of_tile, &tile};
  if (!run_packets(job->shell, job->pieces, worker, &source)) return false;
  store_tile(&tile);
  return true;
}

/* ── any rays ── */

typedef struct Cast {
  const TcShell *shell;
  const TcLine *lines;
  TcLight *light;
  int count, next; /* rays, and the first of those that have not been placed */
  int first;       /* of those placed */
  Placed placed;
  unsigned left;   /* of those */
} Cast;

static void place_cast(Cast *cast) {
  const int rays = cast->count - cast->next < TC_LANES ? cast->count - cast->next : TC_LANES;
  Lines lines;
  for (int i = 0; i < TC_LANES; ++i) {
    const TcLine *line = &cast->lines[cast->next + (i < rays ? i : 0)];
    for (int k = 0; k < 3; ++k) {
      lines.eye[k][i] = line->eye[k];
      lines.offset[k][i] = line->offset[k];
      lines.direction[k][i] = line->direction[k];
    }
  }
  cast->left = ((1U << rays) - 1) & tc_bits(place_rays(cast->shell->volume, &lines, &cast->placed));
  cast->first = cast->next;
  cast->next += rays;
}

static bool next_of_cast(void *user, Queue *queue) {
  Cast *cast = user;
  while (!cast->left && cast->next < cast->count) place_cast(cast);
  if (!cast->left) return false;
  enqueue(&cast->placed, &cast->left, cast->first, 0, queue);
  return true;
}

static void finish_of_cast(void *user, const Packet *packet) {
  Cast *cast = user;
  for (unsigned left = packet->lanes; left; left &= left - 1) {
    const int i = __builtin_ctz(left);
    TcLight *light = &cast->light[packet->x + i];
    light->depth = packet->lights.depth[i];
    for (int k = 0; k < 3; ++k) light->color[k] = packet->lights.color[k][i];
    light->stopped = packet->stopped >> i & 1;
  }
}

bool PACKET_CAST(const TcShell *shell, const TcPieces *pieces, const TcLine *line, int count, TcWorker *worker, TcLight *light) {
  for (int i = 0; i < count; ++i) light[i] = tc_light_begin(worker->tolerance.thin, worker->tolerance.opaque);
  Cast cast = {.shell = shell, .lines = line, .light = light, .count = count};
  const Source source = {next_of_cast, finish_of_cast, &cast};
  return run_packets(shell, pieces, worker, &source);
}
