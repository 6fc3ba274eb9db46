/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of one number type and instruction set: this file is compiled once for each, with TC_LANES, TC_SINGLE and
 * TC_LANES_NAME given by the build (CMakeLists.txt); it makes the table tc_kernels_NAME. */
#include "render/kernel.h"

#include "gather/gather.h"
#include "walk/interval.h"
#include "walk/queue.h"

enum {
  /* Packets that take steps by turns: while one waits for memory, the other computes. */
  PACKETS = 2,
  /* Rays that are kept to be walked again in double precision. */
  AGAIN = TC_SINGLE ? 2 * TC_TILE * TC_TILE : 1
};

_Static_assert(TC_TRAIL_LISTS / TC_LANES >= PACKETS, "each lane has a list of its own");

#define EACH_PACKET TC_UNROLLED for (int i = 0; i < PACKETS; ++i)

typedef struct Packet {
  TcPacket walk;
  TcGather gather;
  bool under_way;
} Packet;

/* A worker's state. All that is written often lies next to each other in memory. */
typedef struct State {
  Packet packet[PACKETS];
  TcQueue queue;
  TcPlaced placed;
  TcGround ground;
  TcGatherJob job;
  TcSample again[AGAIN]; /* single precision: the rays that are to be walked again */
  int again_count;
} State;

/* ── the loop ── */

/* With TC_BOUND, the integral of the scalar's error over a cell of which `length` is crossed (tolerance.h). */
TC_INLINE TcVec spread_of(const unsigned on, const TcGround *ground, const TcPacket *p, const TcCrossed *crossed,
                          TcVec length) {
  const TcResolution *r = &ground->resolution;
  const TcVec beside = tc_madd(tc_set((TcReal)r->relative), p->at.reach, tc_set((TcReal)r->beside)),
              depth = tc_set((TcReal)r->depth);
  if (on & TC_WEIGHTS)
    return tc_madd(beside + beside, tc_madd(length, p->at.tilt.one, p->at.tilt.z), depth);
  const TcVec change = tc_abs(crossed->s1 - crossed->s0);
  TcVec tilted =
      tc_madd(change, p->at.tilt.z, length * (on & TC_CORNERS ? p->at.tilt.one * crossed->range : p->at.tilt.s));
  if (!(on & TC_CORNERS))
    tilted = tc_min(tilted, tc_madd(change, crossed->tilt.z, length * crossed->tilt.s));
  return tc_madd(beside + beside, tilted, tc_madd(length, tc_set((TcReal)r->value), change * depth));
}

/* Whether what is seen may jump where rays go from one cell to the next: the field does, or there is nothing to be seen
 * in some cells. */
TC_INLINE bool jumps(const unsigned on, const TcGround *ground, const TcGatherJob *job) {
  return on & TC_WEIGHTS ? job->coefficients->cells != NULL : on & TC_ASSOCIATIONS || ground->holes;
}

/* With TC_BOUND: the error of the depth at which rays leave the cells just crossed, at p->at, in the lanes in which
 * what is seen depends on it, and 0 in others. If the field jumps, that is wherever the face may lie within what is
 * left of the interval, beyond `from`, be it only by rounding: the cell may then be crossed though it seems not to be.
 * A field that doesn't jump is continued across the face by the cell ahead, and the spread of that cell covers it; but
 * if the face seems to lie beyond an end of the interval and may lie within, a cell is seen whose spread isn't counted.
 * Not being surely outside is what counts: a face seen edge-on may have an error that is infinite, or NaN. */
TC_INLINE TcVec shift_of(const TcGround *ground, const TcPacket *p, bool jump, TcMask crossed, TcVec from) {
  const TcVec z = p->at.z, begin = p->rays.begin, end = p->rays.end, shift = tc_packet_shift(ground, p);
  const TcMask outside = tc_or(tc_le(z + shift, jump ? from : begin), tc_le(end, z - shift));
  const TcMask beyond = tc_or(tc_le(z, begin), tc_le(end, z)), counts = jump ? crossed : tc_and(crossed, beyond);
  return tc_select(tc_and_not(counts, outside), shift, tc_set(0));
}

/* Gathers the segments of the cells just crossed, as far as they lie beyond the depth that was seen already and within
 * the rays' intervals. Rounding, or a cell that is turned inside out, can make a face's depth less than that of the
 * face before. Such a segment counts for nothing, and of the next one only the part beyond the depth seen counts. So
 * the lengths along a path add up to its largest depth minus its first, whatever happens in between. Returns the lanes
 * whose rays end in these cells. */
TC_INLINE TcMask add_segment(const int which, const unsigned on, const TcGround *ground, const TcGatherJob *job,
                             Packet *packet, TcCrossed *crossed, unsigned leaving, TcWorker *worker) {
  TcPacket *p = &packet->walk;
  const TcVec from = p->seen;
  TcVec z1 = p->at.z;
  TcMask moved = crossed->mask;
  const TcMask ends = tc_and(moved, tc_lt(p->rays.end, z1));
  TcPassage passage = {.s0 = crossed->s0,
                       .s1 = crossed->s1,
                       .cell = p->from,
                       .entry = crossed,
                       .walk = p,
                       .crossed = moved,
                       .partial = false};
  moved = tc_and(moved, tc_gt(z1, from));
  const TcMask behind = tc_and(moved, tc_lt(crossed->z, from));
  if (TC_UNLIKELY(tc_any(tc_or(behind, ends)))) { /* at the eye, where the mesh folds, or at the ray's end */
    const TcVec length = z1 - crossed->z, end = tc_min(p->rays.end, z1), change = crossed->s1 - crossed->s0;
    passage.partial = true;
    passage.from = tc_select(behind, (from - crossed->z) / length, tc_set(0));
    passage.to = tc_select(ends, (end - crossed->z) / length, tc_set(1));
    if (!(on & TC_CELLS)) {
      passage.s0 = tc_select(behind, tc_madd(passage.from, change, crossed->s0), crossed->s0);
      passage.s1 = tc_select(ends, tc_madd(passage.to, change, crossed->s0), crossed->s1);
    }
    z1 = tc_select(ends, end, z1);
    moved = tc_and(moved, tc_gt(z1, from));
  }
  worker->segments += __builtin_popcount(tc_bits(moved));
  p->seen = tc_select(moved, z1, from);
  passage.length = z1 - from;
  passage.begin = from;
  passage.end = z1;
  passage.leaving = leaving;
  if (on & TC_BOUND) {
    const bool jump = jumps(on, ground, job);
    passage.spread = spread_of(on, ground, p, crossed, passage.length);
    p->shift += shift_of(ground, p, jump, passage.crossed, from);
    if (jump)
      p->shift += tc_select(passage.crossed, crossed->grazed, tc_set(0));
  }
  tc_gather_segment(which, on, job, &packet->gather, moved, &passage);
  return ends;
}

/* Lets packets take steps until one of them needs a decision: all its lanes have ended, or one has ended a path and may
 * have another. Most rays have one path only, so that nothing needs to be decided for each when it ends: that would be
 * a branch which the processor can't predict. */
TC_INLINE void advance(const int which, const unsigned on, const TcGround *given_ground, const TcGatherJob *job,
                       TcWorker *worker, Packet *packet) {
  const TcGround ground = *given_ground;
  bool halt = false;
  EACH_PACKET {
    TcPacket *p = &packet[i].walk;
    const TcMask starting = tc_mask_of(p->starting);
    if (p->starting) {
      tc_packet_set_out(on, &ground, p);
      tc_gather_enter(which, on, job, &packet[i].gather, starting, p);
    }
    const TcMask resting = tc_and_not(tc_all(), p->active);
    tc_packet_forget(p, resting);
    tc_packet_rest(&ground, p, resting);
    tc_packet_expect(&ground, p);
  }
  while (!halt) {
    TcLanePoints q[PACKETS];
    TcCrossed crossed[PACKETS];
    TcMask active[PACKETS], lost[PACKETS];
    unsigned ended[PACKETS];
    EACH_PACKET tc_packet_look(&ground, &packet[i].walk, &q[i]);
    EACH_PACKET {
      TcPacket *p = &packet[i].walk;
      uint32_t reached;
      active[i] = p->active;
      lost[i] = tc_packet_cross(on, &ground, p, &q[i], &crossed[i], &reached);
      ended[i] = tc_packet_reach(on, &ground, p, reached, &crossed[i]);
    }
    EACH_PACKET {
      TcPacket *p = &packet[i].walk;
      crossed[i].mask = tc_and_not(active[i], lost[i]);
      const TcMask ends = add_segment(which, on, &ground, job, &packet[i], &crossed[i], ended[i], worker);
      const TcMask complete = tc_gather_complete(which, on, job, &packet[i].gather, active[i], ++p->steps);
      const unsigned stop = tc_bits(tc_or(tc_or(lost[i], complete), ends));
      if (TC_UNLIKELY(stop | ended[i])) {
        p->stopped |= tc_bits(complete);
        p->lost |= tc_bits(lost[i]);
        tc_packet_leave(p, tc_bits(ends) & ~ended[i]);
        p->waiting |= (ended[i] | tc_bits(ends)) & ~(p->stopped | p->lost);
        p->active = tc_and_not(p->active, tc_mask_of(stop | ended[i]));
        tc_packet_forget(p, tc_mask_of(stop | ended[i]));
        if (stop) {
          tc_packet_rest(&ground, p, tc_mask_of(stop));
          tc_packet_expect(&ground, p);
        }
        halt = halt || !tc_any(p->active) || p->waiting & p->more_hits;
      }
    }
  }
  EACH_PACKET {
    TcPacket *p = &packet[i].walk;
    if (p->waiting && (!tc_any(p->active) || p->waiting & p->more_hits))
      tc_packet_arrive(ground.shell, p);
  }
}

#if TC_LANES == 1
/* Walks through the cells of a volume of which Embree holds every cell (TETCAST_TRAVERSAL_FACES), in the order in which
 * the ray enters them. */
TC_INLINE void advance_cells(const int which, const unsigned on, const TcGround *ground, const TcGatherJob *job,
                             TcWorker *worker, Packet *packet) {
  TcPacket *p = &packet->walk;
  const TcHits *hits = p->hits;
  for (int64_t i = 0; i < hits->count; ++i) {
    const uint32_t cell = hits->data[i].id;
    TcCellFaces faces;
    if (!tc_cell_faces(on, ground, &p->rays, cell, &faces))
      continue;
    tc_cell_at(on, ground, p, &faces, 0);
    tc_gather_enter(which, on, job, &packet->gather, 1, p);
    TcCrossed crossed = {.mask = 1, .grazed = tc_set(0), .z = p->at.z, .s0 = p->at.s, .tilt = p->at.tilt};
    for (int k = 0; on & TC_SURFACES && k < 3; ++k) {
      crossed.barycentric[k] = p->at.barycentric[k];
      crossed.id[k] = p->v[k].id;
    }
    if (on & TC_CORNERS)
      crossed.s0 = tc_cell_corner_value(ground, cell, p);
    p->seen = tc_max(p->at.z, p->rays.begin); /* each cell counts for itself, as cells may overlap */
    p->from[0] = cell;
    tc_cell_at(on, ground, p, &faces, 1);
    crossed.s1 = on & TC_CORNERS ? tc_cell_corner_value(ground, cell, p) : p->at.s;
    if (on & TC_CORNERS)
      crossed.range = tc_cell_range(ground, cell);
    const TcMask ends = add_segment(which, on, ground, job, packet, &crossed, 0, worker);
    const TcMask complete = tc_gather_complete(which, on, job, &packet->gather, 1, ++p->steps);
    if (complete) {
      p->stopped = 1;
      break;
    }
    (void)ends; /* the cells behind the ray's end count for nothing by themselves */
  }
  p->starting = p->active = 0;
}
#endif

typedef void Advance(const TcGround *ground, const TcGatherJob *job, TcWorker *worker, Packet *packet);
#if TC_LANES == 1
#define KERNEL(name, gatherer, features)                                                                               \
  TC_NOINLINE void walk_##name(const TcGround *ground, const TcGatherJob *job, TcWorker *worker, Packet *packet) {     \
    advance(TC_GATHER_##gatherer, (features), ground, job, worker, packet);                                            \
  }                                                                                                                    \
  TC_NOINLINE void cells_##name(const TcGround *ground, const TcGatherJob *job, TcWorker *worker, Packet *packet) {    \
    advance_cells(TC_GATHER_##gatherer, (features), ground, job, worker, packet);                                      \
  }
#define KERNEL_ROW(name, gatherer, features) {walk_##name, cells_##name, TC_GATHER_##gatherer, (features)},
#else
#define KERNEL(name, gatherer, features)                                                                               \
  TC_NOINLINE void walk_##name(const TcGround *ground, const TcGatherJob *job, TcWorker *worker, Packet *packet) {     \
    advance(TC_GATHER_##gatherer, (features), ground, job, worker, packet);                                            \
  }
#define KERNEL_ROW(name, gatherer, features) {walk_##name, NULL, TC_GATHER_##gatherer, (features)},
#endif
#define NO_KERNEL(name, gatherer, features)
#define NO_ROW(name, gatherer, features) {NULL, NULL, 0, 0},
#if TC_SINGLE
#define KERNEL_DOUBLE NO_KERNEL
#define KERNEL_ONE    NO_KERNEL
#elif TC_LANES > 1
#define KERNEL_DOUBLE KERNEL
#define KERNEL_ONE    NO_KERNEL
#else
#define KERNEL_DOUBLE KERNEL
#define KERNEL_ONE    KERNEL
#endif
#include "render/kernels.def"
#undef KERNEL

/* The rows of kernels.def. Those that this number type does not have are empty. */
static const struct {
  Advance *advance, *advance_cells;
  int gatherer;
  unsigned features;
} rows[] = {
#define KERNEL KERNEL_ROW
#if TC_SINGLE
#undef KERNEL_DOUBLE
#define KERNEL_DOUBLE NO_ROW
#endif
#if TC_LANES > 1
#undef KERNEL_ONE
#define KERNEL_ONE NO_ROW
#endif
#include "render/kernels.def"
#undef KERNEL
};

/* ── packets ── */

/* Where rays come from. */
typedef struct Source {
  bool (*next)(void *user, TcQueue *queue); /* puts the rays of one packet into the queue; false: there are no more */
  void *user;                               /* is given to next() */
  double *sums;                             /* [pixel][job->sums]: where what the rays gather is added */
} Source;

/* A ray's destination is the pixel that it adds to. In single precision it names the pixel's sample as well, or where
 * it is among given samples, so that the ray can be walked again. */
#define DESTINATION(pixel, sample) ((int64_t)(sample) << 32 | (pixel))
#define PIXEL_OF(destination)      ((destination)&UINT32_MAX)

static void begin_packet(const int which, const TcSurfaces *surfaces, const TcGatherJob *job, TcWaiting *waiting,
                         Packet *packet) {
  TcPacket *p = &packet->walk;
  TcHits *hits = waiting->hits;
  waiting->hits = p->hits;
  p->hits = hits;
  p->rays = waiting->rays;
  if (surfaces) {
    memcpy(p->along, waiting->along, sizeof p->along);
    p->start = waiting->start;
    memcpy(p->slice, waiting->slice, (size_t)surfaces->slice_count * sizeof *p->slice);
  }
  p->origin = waiting->origin;
  p->lanes = waiting->lanes;
  memcpy(p->destination, waiting->destination, sizeof p->destination);
  p->active = tc_none();
  p->starting = p->waiting = p->stopped = 0;
  p->lost = 0;
  p->doubtful = waiting->doubtful;
  p->seen = p->rays.begin;
  p->shift = p->rays.doubt + waiting->grazed;
  p->steps = 0;
  unsigned starting = 0;
  TC_EACH_LANE {
    p->next[l] = 1;
    starting |= (unsigned)(hits[l].count > 0) << l;
  }
  p->starting = starting & p->lanes & ~p->doubtful;
  tc_gather_begin(which, job, &packet->gather);
  packet->under_way = true;
}

static void finish_packet(const TcJob *job, State *state, TcWorker *worker, Packet *packet, double *sums) {
  double gathered[TC_MAX_SUMS][TC_LANES], nowhere[TC_MAX_SUMS];
  TcPacket *p = &packet->walk;
  const TcEnding ending = {.stopped = p->stopped, .steps = p->steps, .shift = p->shift, .start = p->start, .walk = p};
  tc_gather_end(rows[job->kernel].gatherer, rows[job->kernel].features, &state->job, &packet->gather, &ending,
                gathered);
  if (!TC_SINGLE)
    worker->lost += __builtin_popcount(p->lost);
  double *to[TC_LANES];
  TC_EACH_LANE {
    bool counts = p->lanes >> l & 1;
#if TC_SINGLE
    if (counts && ((p->lost | p->doubtful) >> l & 1 || !(gathered[job->sums - 1][l] <= job->tolerance.most))) {
      state->again[state->again_count++] =
          (TcSample){.pixel = PIXEL_OF(p->destination[l]), .sample = (int)(p->destination[l] >> 32)};
      counts = false;
    }
#endif
    to[l] = counts ? sums + PIXEL_OF(p->destination[l]) * job->sums : nowhere;
  }
  for (int k = 0; k < job->sums; ++k) {
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) to[l][k] += gathered[k][l];
  }
  packet->under_way = false;
}

/* Begins the next packet of a source, if there is one. Returns false if memory has run out. */
static bool next_packet(const int which, State *state, const Source *source, Packet *packet) {
  TcQueue *queue = &state->queue;
  if (queue->next == queue->count) {
    queue->next = queue->count = 0;
    while (queue->count < TC_QUEUE && source->next(source->user, queue))
      continue;
    if (!tc_queue_trace(queue))
      return false;
  }
  if (queue->next < queue->count)
    begin_packet(which, state->ground.surfaces, &state->job, &queue->waiting[queue->next++], packet);
  return true;
}

/* Gives lists of hits to the packets and to those that wait in the queue. */
static void share_hits(State *state, TcWorker *worker) {
  for (int i = 0; i < PACKETS; ++i)
    state->packet[i].walk.hits = worker->hits + i * TC_LANES;
  for (int i = 0; i < TC_QUEUE; ++i)
    state->queue.waiting[i].hits = worker->hits + (PACKETS + i) * TC_LANES;
}

static State *prepare(const TcJob *job, TcWorker *worker) {
  State *state = worker->state;
  state->ground = (TcGround){.shell = job->shell,
                             .values = job->values,
                             .holes = job->values && job->values->has_holes,
                             .screen = job->screen,
                             .vertices = job->screen ? job->screen->vertices : job->points,
                             .resolution = job->resolution,
                             .surfaces = job->surfaces};
  state->job = (TcGatherJob){.volume = job->shell->volume,
                             .sums = job->sums,
                             .pieces = job->pieces,
                             .second = job->second,
                             .values = job->values,
                             .tolerance = job->tolerance,
                             .sampler = job->sampler,
                             .coefficients = job->coefficients,
                             .surfaces = job->surfaces,
                             .lights = job->lights,
                             .trail = worker->trail,
                             .blend = job->blend,
                             .to_the_end = job->to_the_end,
                             .fragments = &worker->fragments,
                             .exponent = job->shell->volume->exponent,
                             .rounding = 8 * 0x1p-53};
  state->queue.ground = &state->ground;
  state->queue.bounds = rows[job->kernel].features & TC_BOUND;
  state->queue.next = state->queue.count = 0;
  state->placed.lanes = 0;
  state->again_count = 0;
  for (int i = 0; i < PACKETS; ++i) {
    TcPacket *p = &state->packet[i].walk;
    p->active = tc_none();
    p->starting = p->waiting = 0;
    state->packet[i].under_way = false;
    /* What gatherers keep from packet to packet begins anew, so that no bit of a tile depends on the tile before. */
    memset(&state->packet[i].gather, 0, sizeof state->packet[i].gather);
#if !TC_SINGLE
    if (job->coefficients) {
      double *memory =
          (double *)(void *)((char *)state + sizeof *state) + (size_t)i * tc_groups_size(job->coefficients);
      tc_groups_place(job->coefficients, memory, &state->packet[i].gather.groups); /* or those of visit_groups */
    }
#endif
  }
  share_hits(state, worker);
  return state;
}

/* Walks all packets of a source, several at a time. Returns false if memory has run out. */
static bool run_packets(const TcJob *job, State *state, TcWorker *worker, const Source *source) {
  const int which = rows[job->kernel].gatherer;
  const bool cells = job->shell->volume->traversal == TETCAST_TRAVERSAL_FACES;
  Advance *const step = cells ? rows[job->kernel].advance_cells : rows[job->kernel].advance;
  for (;;) {
    bool any = false;
    for (int i = 0; i < (cells ? 1 : PACKETS); ++i) {
      Packet *packet = &state->packet[i];
      while (!tc_packet_runs(&packet->walk)) {
        if (packet->under_way)
          finish_packet(job, state, worker, packet, source->sums);
        if (!next_packet(which, state, source, packet))
          return false;
        if (!packet->under_way)
          break;
      }
      any = any || packet->under_way;
    }
    if (!any)
      return true;
    step(&state->ground, &state->job, worker, state->packet);
  }
}

/* Places rays that end at `stop` (NULL: they don't end), clips them, and leaves out those that pass by the volume or of
 * which nothing counts. Such a ray has sums of 0; but with coefficients, unless it is fragments that are gathered, each
 * group has a transmittance of 1, which is added here. */
static void place_rays(const TcJob *job, const TcGround *ground, const TcWide *stop, double *sums, TcPlaced *placed) {
  unsigned left_out = placed->lanes;
  tc_place(ground, placed);
  const double radius = ground->shell->volume->radius;
  if (job->clip_count > 0)
    tc_clip(job->clip, job->clip_count, radius, job->interval_error, placed);
  if (job->surfaces)
    tc_slice(job->surfaces, placed);
  if (stop)
    tc_stop(stop, radius, job->interval_error, placed);
  if (job->start)
    placed->doubt += tc_set_wide(job->interval_error);
  left_out &= ~placed->lanes;
  for (; TC_UNLIKELY(job->coefficients && job->sums > 1) && left_out; left_out &= left_out - 1) {
    double *of_ray = sums + PIXEL_OF(placed->destination[__builtin_ctz(left_out)]) * job->sums;
    for (int g = 0; g < job->coefficients->groups; ++g)
      of_ray[3 * g + 2] += 1;
  }
}

/* ── a tile ── */

/* A packet's rays are those of PACKET_X × PACKET_Y pixels. */
enum { PACKET_X = TC_LANES == 1 ? 1 : TC_LANES == 4 ? 2 : 4, PACKET_Y = TC_LANES / PACKET_X };

typedef struct Tile {
  const TcJob *job;
  const State *state;
  TcPlaced *placed;
  int64_t x0, y0, x1, y1;
  int64_t x, y; /* the first pixel of the packet whose rays come next */
  int sample;
  double *sums;
} Tile;

/* The distances of `of` for the rays through places of the grid of samples, scaled. */
TC_NOINLINE void find_distances(const TcJob *job, const TetcastArray *of, const TcWide *column, const TcWide *row,
                                unsigned lanes, TcWide *result) {
  *result = tc_set_wide(0);
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const int64_t x = (int64_t)TC_AT(*column, l) / job->samples_x, y = (int64_t)TC_AT(*row, l) / job->samples_y;
    const double distance = tc_array_double(of, tc_array_stride(of, 1), y * job->width + x, 0);
    TC_AT(*result, l) = ldexp(distance, -job->shell->volume->exponent);
  }
}

/* Has the rays through places of the grid of samples count from where the job says. */
TC_NOINLINE void begin_at_start(const TcJob *job, const TcWide *column, const TcWide *row, TcPlaced *placed) {
  TcWide *begin = &placed->lines.begin;
  find_distances(job, job->start, column, row, placed->lanes, begin);
  for (int l = 0; l < TC_LANES; ++l)
    TC_AT(*begin, l) = TC_AT(*begin, l) > 0 ? TC_AT(*begin, l) : 0;
}

/* Places the rays through one point of the grid of samples in each lane. */
static void place_samples(const TcJob *job, const TcGround *ground, const TcWide *column, const TcWide *row,
                          double *sums, TcPlaced *placed) {
  TcLines *lines = &placed->lines;
  const double samples_x = job->samples_x, samples_y = job->samples_y;
  const TcWide across = *column + 0.5, down = *row + 0.5;
  const double width = (double)job->width * samples_x, height = (double)job->height * samples_y;
  const double *center = job->view.center, left = width - width * center[0], top = height + height * center[1];
  const TcWide u = (across + across - left) / width, v = (top - (down + down)) / height; /* rounded once */
  if (job->screen) {
    lines->x = across / samples_x - job->screen->x0;
    lines->y = down / samples_y - job->screen->y0;
  }
  lines->begin = tc_set_wide(0);
  lines->end = tc_set_wide(INFINITY);
  tc_view_lines(&job->view, &u, &v, lines);
  TcWide stop;
  if (job->stop)
    find_distances(job, job->stop, column, row, placed->lanes, &stop);
  if (job->start)
    begin_at_start(job, column, row, placed);
  place_rays(job, ground, job->stop ? &stop : NULL, sums, placed);
}

/* Places the rays of the next packet of pixels. */
static void place_next(Tile *tile) {
  const TcJob *job = tile->job;
  TcPlaced *placed = tile->placed;
  const int64_t width = tile->x1 - tile->x0, first = (tile->y - tile->y0) * width + tile->x - tile->x0;
  const int columns = (int)(tile->x1 - tile->x), rows_left = (int)(tile->y1 - tile->y);
  const int sample_x = tile->sample % job->samples_x, sample_y = tile->sample / job->samples_x;
  const double column = (double)(tile->x * job->samples_x + sample_x),
               row = (double)(tile->y * job->samples_y + sample_y);
  TcWide x, y;
  unsigned inside = 0;
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) {
    const int i = l % PACKET_X, j = l / PACKET_X;
    TC_AT(x, l) = i;
    TC_AT(y, l) = j;
    placed->destination[l] = DESTINATION(first + j * width + i, tile->sample);
    inside |= (unsigned)((i < columns) & (j < rows_left)) << l;
  }
  x = x * job->samples_x + column;
  y = y * job->samples_y + row;
  placed->lanes = inside;
  place_samples(job, &tile->state->ground, &x, &y, tile->sums, placed);
  if (++tile->sample < job->samples_x * job->samples_y)
    return;
  tile->sample = 0;
  tile->y += PACKET_Y; /* downwards, as two packets then fill a square, or nearly */
  if (tile->y < tile->y1)
    return;
  tile->y = tile->y0;
  tile->x += PACKET_X;
}

#if TC_SINGLE
/* Walks the rays of state->again once more, in double precision, as single precision would not do for them. */
static bool walk_again(const TcJob *job, State *state, TcWorker *worker, double *sums) {
  void *const mine = worker->state;
  worker->state = worker->precise_state;
  const bool ok = state->again_count == 0 ||
                  job->precise->samples(job->precise_job, state->again, state->again_count, worker, sums);
  worker->state = mine;
  worker->again += state->again_count;
  state->again_count = 0;
  return ok;
}

/* Whether there may be no room for the rays of those packets that may end before others are taken. */
static bool again_is_full(const State *state) {
  return state->again_count > AGAIN - (PACKETS + TC_QUEUE) * TC_LANES;
}

static bool walk_again_of_tile(const Tile *tile, State *state, TcWorker *worker, double *sums) {
  for (int i = 0; i < state->again_count; ++i) {
    TcSample *again = &state->again[i];
    again->x = tile->x0 + again->pixel % (tile->x1 - tile->x0);
    again->y = tile->y0 + again->pixel / (tile->x1 - tile->x0);
  }
  return walk_again(tile->job, state, worker, sums);
}
#else
#define again_is_full(state) false
#endif

static bool next_of_tile(void *user, TcQueue *queue) {
  Tile *tile = user;
  if (again_is_full(tile->state))
    return false; /* these rays come first */
  while (!tile->placed->lanes && tile->x < tile->x1)
    place_next(tile);
  if (!tile->placed->lanes)
    return false;
  tc_enqueue(tile->placed, queue);
  return true;
}

static bool render_tile(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker,
                        double *sums) {
  State *state = prepare(job, worker);
  Tile tile = {.job = job,
               .state = state,
               .placed = &state->placed,
               .x0 = x0,
               .y0 = y0,
               .x1 = x1,
               .y1 = y1,
               .x = x0,
               .y = y0,
               .sums = sums};
  const Source source = {next_of_tile, &tile, sums};
  do {
    if (!run_packets(job, state, worker, &source))
      return false;
#if TC_SINGLE
    if (!walk_again_of_tile(&tile, state, worker, sums))
      return false;
#endif
  } while (tile.x < tile.x1);
  return true;
}

/* ── given rays of a picture ── */

typedef struct Samples {
  const TcJob *job;
  const State *state;
  TcPlaced *placed;
  const TcSample *samples;
  int64_t count, next;
  double *sums;
} Samples;

static void place_some(Samples *some) {
  TcPlaced *placed = some->placed;
  const TcJob *job = some->job;
  TcWide column = tc_set_wide(0), row = column;
  placed->lanes = 0;
  TC_EACH_LANE {
    const TcSample *s = &some->samples[some->next < some->count ? some->next : 0];
    TC_AT(column, l) = (double)(s->x * job->samples_x + s->sample % job->samples_x);
    TC_AT(row, l) = (double)(s->y * job->samples_y + s->sample / job->samples_x);
    placed->destination[l] = DESTINATION(s->pixel, s - some->samples);
    if (some->next++ < some->count)
      placed->lanes |= 1U << l;
  }
  place_samples(job, &some->state->ground, &column, &row, some->sums, placed);
}

static bool next_of_samples(void *user, TcQueue *queue) {
  Samples *some = user;
  if (again_is_full(some->state))
    return false;
  while (!some->placed->lanes && some->next < some->count)
    place_some(some);
  if (!some->placed->lanes)
    return false;
  tc_enqueue(some->placed, queue);
  return true;
}

static bool render_samples(const TcJob *job, const TcSample *samples, int64_t count, TcWorker *worker, double *sums) {
  State *state = prepare(job, worker);
  Samples some = {
      .job = job, .state = state, .placed = &state->placed, .samples = samples, .count = count, .sums = sums};
  const Source source = {next_of_samples, &some, sums};
  do {
    if (!run_packets(job, state, worker, &source))
      return false;
#if TC_SINGLE
    for (int i = 0; i < state->again_count; ++i) /* they are told by their numbers so far */
      state->again[i] = samples[state->again[i].sample];
    if (!walk_again(job, state, worker, sums))
      return false;
#endif
  } while (some.next < count);
  return true;
}

/* ── any rays ── */

#if !TC_SINGLE
typedef struct Cast {
  const TcJob *job;
  const TcGround *ground;
  TcPlaced *placed;
  const TcLine *lines;
  int64_t count, next; /* the number of rays, and the first that has not been placed */
  double *sums;
} Cast;

static void place_cast(Cast *cast) {
  TcPlaced *placed = cast->placed;
  TcLines *lines = &placed->lines;
  const double *eye[TC_LANES], *direction[TC_LANES], *offset[TC_LANES];
  placed->lanes = 0;
  TC_EACH_LANE {
    const TcLine *line = &cast->lines[cast->next < cast->count ? cast->next : 0];
    eye[l] = line->eye;
    direction[l] = line->direction;
    offset[l] = line->offset;
    placed->destination[l] = cast->next;
    placed->lanes |= (unsigned)(cast->next < cast->count) << l;
    ++cast->next;
  }
  TcVec eyes[4], directions[4], offsets[4]; /* and begins, ends, and what is unused */
  tc_load_records(eye, eyes);
  tc_load_records(direction, directions);
  tc_load_records(offset, offsets);
  memcpy(lines->eye, eyes, sizeof lines->eye);
  memcpy(lines->direction, directions, sizeof lines->direction);
  memcpy(lines->offset, offsets, sizeof lines->offset);
  lines->begin = eyes[3];
  lines->end = directions[3];
  place_rays(cast->job, cast->ground, NULL, cast->sums, placed);
  /* Where the ray begins or ends by itself. */
  const TcMask whole = tc_and_not(tc_eq(lines->begin, tc_set(0)), tc_lt(lines->end, tc_set(INFINITY)));
  placed->doubt += tc_select(whole, tc_set(0), tc_set(cast->job->interval_error));
}

static bool next_of_cast(void *user, TcQueue *queue) {
  Cast *cast = user;
  while (!cast->placed->lanes && cast->next < cast->count)
    place_cast(cast);
  if (!cast->placed->lanes)
    return false;
  tc_enqueue(cast->placed, queue);
  return true;
}

static bool cast_lines(const TcJob *job, const TcLine *lines, int64_t count, TcWorker *worker, double *sums) {
  State *state = prepare(job, worker);
  Cast cast = {
      .job = job, .ground = &state->ground, .placed = &state->placed, .lines = lines, .count = count, .sums = sums};
  const Source source = {next_of_cast, &cast, sums};
  return run_packets(job, state, worker, &source);
}
#else
#define cast_lines NULL
#endif

#include "walk/project.h"

static void project(const TcJob *job, TcScreen *screen, int64_t begin, int64_t end) {
  for (int64_t i = begin; i < end; i += TC_PROJECTED) {
    tc_project_some(job->shell->volume, job->values, &job->view, screen, i,
                    end - i < TC_PROJECTED ? (int)(end - i) : TC_PROJECTED);
  }
}

static size_t state_size(const TcJob *job) {
#if TC_SINGLE
  (void)job;
  return sizeof(State);
#else
  return sizeof(State) + (job->coefficients ? PACKETS * tc_groups_size(job->coefficients) * sizeof(double) : 0);
#endif
}

#define TABLE_NAME_(name) tc_kernels_##name
#define TABLE_NAME(name)  TABLE_NAME_(name)

const TcIsaKernels TABLE_NAME(TC_LANES_NAME) = {
    .name = TC_LANES == 1                     ? "scalar"
            : TC_LANES == (TC_SINGLE ? 8 : 4) ? "avx2"
                                              : "avx512",
    .precision = TC_SINGLE ? "single" : "double",
    .lanes = TC_LANES,
    .state_size = state_size,
    .vertex_size = 4 * sizeof(TcReal),
    .project = project,
    .tile = render_tile,
    .samples = render_samples,
    .cast = cast_lines,
};
