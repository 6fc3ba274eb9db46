/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the cells that any rays cross. Kernels note them step by step (walk/trail.h), lanes side by side; here they are
 * put in order, ray by ray, with the mesh's own numbers of cells and vertices. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/call.h"
#include "base/parallel.h"
#include "render/cast.h"
#include "render/rays.h"
#include "render/render.h"

enum {
  CELLS = 1, /* which of the sums is the number of cells */
  SUMS,
  BATCH = 256, /* how many rays are traced together, and handed out */
  ROUND = 2    /* how many batches each thread traces before they are handed out */
};

/* What of the ray and its crossings in a batch is kept until they have been handed out. */
typedef struct Batch {
  int64_t first, count, offsets[BATCH + 1];
  TetcastCrossing *crossings; /* [capacity] */
  int64_t capacity;
} Batch;

/* How to count along a ray, and where its next crossing goes. */
typedef struct Way {
  TetcastCrossing *next;
  double near, scale[2], begin, end;
} Way;

typedef struct Tracer {
  TcWorker worker;
  TcTrail trail;
  TcLine lines[BATCH];
  TcRayUnit units[BATCH];
  int64_t order[BATCH];     /* which of the batch each of these rays is */
  double sums[BATCH][SUMS]; /* what each ray gathers: its length, and how many cells it crosses */
  Way ways[BATCH];
} Tracer;

typedef struct Tracing {
  const TetcastVolume *volume;
  const TetcastRays *rays;
  const TcIsaKernels *kernels;
  TcJob job;
  Tracer **tracers; /* [threads] */
  Batch *batches;   /* [threads · ROUND] */
  int64_t begin;    /* the first ray of the round */
  bool out_of_memory;
  TetcastTraceFunction *function;
  void *user;
  int64_t handed; /* how many batches are handed out together */
} Tracing;

/* ── crossings ── */

/* The mesh's vertices of a cell that has these of the volume's. */
static void name_vertices(const TetcastVolume *volume, uint32_t cell, const uint32_t id[4], uint32_t vertex[4]) {
  for (int k = 0; k < 4; ++k) {
    if (volume->corner_vertices) {
      const int place = (id[k] > id[0]) + (id[k] > id[1]) + (id[k] > id[2]) + (id[k] > id[3]);
      vertex[k] = volume->corner_vertices[cell][place];
    } else {
      vertex[k] = volume->vertex_source[id[k]];
    }
  }
}

/* The vertices of lane l's cell, those of the face where it was entered first, and their weights where the part of the
 * ray begins and ends. Of the face where the ray leaves, all vertices but one are those of the first, at their places,
 * as the walk replaces one (walk/packet.h); where cells are found one by one, they may be in any order. */
static void take_weights(const TetcastVolume *volume, const uint32_t *words, const double *numbers, int lanes, int l,
                         TetcastCrossing *crossing) {
  const bool aligned = volume->traversal == TETCAST_TRAVERSAL_SHELL;
  uint32_t id[4] = {0};
  double(*weight)[4] = crossing->weight;
  memset(weight, 0, sizeof crossing->weight);
  for (int k = 0; k < 3; ++k) {
    id[k] = words[(TC_TRAIL_ENTRY + k) * lanes + l];
    weight[0][k] = numbers[(TC_TRAIL_AT_ENTRY + k) * lanes + l];
  }
  for (int k = 0; k < 3; ++k) {
    const uint32_t vertex = words[(TC_TRAIL_EXIT + k) * lanes + l];
    const double at_exit = numbers[(TC_TRAIL_AT_EXIT + k) * lanes + l];
    int at = k;
    for (int j = 0; !aligned && j < 3; ++j)
      at = vertex == id[j] ? j : at;
    const bool kept = vertex == id[at];
    weight[1][at] = kept ? at_exit : weight[1][at];
    weight[1][3] = kept ? weight[1][3] : at_exit;
    id[3] = kept ? id[3] : vertex;
  }
  const double from = numbers[TC_TRAIL_FROM * lanes + l], to = numbers[TC_TRAIL_TO * lanes + l];
  for (int k = 0; (from > 0 || to < 1) && k < 4; ++k) { /* between the faces weights are linear */
    const double entry = weight[0][k], change = weight[1][k] - entry;
    weight[0][k] = entry + from * change;
    weight[1][k] = to < 1 ? entry + to * change : weight[1][k];
  }
  name_vertices(volume, crossing->cell, id, crossing->vertex);
}

/* What is needed to count along each ray: its number is the depth, plus `near`, times both scales. */
static void find_ways(const Tracing *tracing, Tracer *tracer, const Batch *batch) {
  const TetcastVolume *volume = tracing->volume;
  for (int64_t i = 0; i < batch->count; ++i) {
    const TcLine *line = &tracer->lines[i];
    const TcRayUnit *unit = &tracer->units[i];
    const int half = -unit->exponent / 2;
    Way way = {.next = batch->crossings + batch->offsets[tracer->order[i]],
               .scale = {ldexp(1 / unit->length, half), ldexp(1, -unit->exponent - half)},
               .begin = unit->begin,
               .end = unit->end};
    for (int k = 0; k < 3; ++k) /* as in walk/place.h */
      way.near -= ((line->eye[k] - volume->center[k]) + line->offset[k]) * line->direction[k];
    tracer->ways[i] = way;
  }
}

static double number_at(const Way *way, double depth) {
  const double t = (way->near + depth) * way->scale[0] * way->scale[1];
  return t < way->begin ? way->begin : t > way->end ? way->end : t;
}

/* Puts what the trail has in order. */
static void sort_trail(const Tracing *tracing, Tracer *tracer, const Batch *batch) {
  const TetcastVolume *volume = tracing->volume;
  const TcTrail *trail = &tracer->trail;
  const int lanes = tracing->kernels->lanes, half = volume->exponent / 2;
  const int64_t size = tc_trail_size(trail, lanes);
  const double scale[2] = {ldexp(1, half), ldexp(1, volume->exponent - half)};
  find_ways(tracing, tracer, batch);
  for (int64_t step = 0; step < trail->count; step += size) {
    const uint32_t *words = (const uint32_t *)(const void *)(trail->data + step);
    const double *numbers = trail->data + step + tc_trail_before_numbers(trail, lanes);
    for (int l = 0; l < lanes; ++l) {
      const uint32_t ray = words[TC_TRAIL_RAY * lanes + l], cell = words[TC_TRAIL_CELL * lanes + l];
      if (ray == UINT32_MAX)
        continue;
      Way *way = &tracer->ways[ray];
      const double begin = numbers[TC_TRAIL_BEGIN * lanes + l], end = numbers[TC_TRAIL_END * lanes + l];
      TetcastCrossing *crossing = way->next++;
      memset(crossing, 0, offsetof(TetcastCrossing, begin)); /* with what lies between the members */
      crossing->cell = cell;
      crossing->begin = number_at(way, begin);
      crossing->end = number_at(way, end);
      crossing->length = (end - begin) * scale[0] * scale[1];
      if (trail->weights) {
        take_weights(volume, words, numbers, lanes, l, crossing);
      } else {
        memset(crossing->weight, 0, sizeof crossing->weight);
      }
      crossing->cell = volume->adjacency.source[cell];
    }
  }
}

/* ── batches ── */

static bool reserve(const Tracing *tracing, Batch *batch, int64_t count) {
  if (count <= batch->capacity)
    return true;
  TetcastContext *context = tracing->volume->context;
  tc_release(context, batch->crossings);
  batch->capacity = count + count / 2;
  batch->crossings = tc_allocate(context, batch->capacity, sizeof *batch->crossings);
  if (!batch->crossings)
    batch->capacity = 0;
  return batch->crossings != NULL;
}

/* Takes the rays of a batch, those along the same axis next to each other, as the rays of a packet must have it in
 * common (walk/place.h). */
static void take_rays(const Tracing *tracing, Tracer *tracer, const Batch *batch) {
  enum { KINDS = 8, KIND_BITS = 28 };
  TcLine lines[BATCH];
  TcRayUnit units[BATCH];
  int64_t next[KINDS + 1] = {0};
  uint32_t kind[BATCH];
  for (int64_t i = 0; i < batch->count; ++i) {
    lines[i] = tc_rays_line(tracing->rays, tracing->volume, batch->first + i, &units[i]);
    kind[i] = tc_rays_key(&lines[i], tracing->volume) >> KIND_BITS;
    ++next[kind[i] + 1];
  }
  for (int k = 0; k < KINDS; ++k)
    next[k + 1] += next[k];
  for (int64_t i = 0; i < batch->count; ++i) {
    const int64_t at = next[kind[i]]++;
    tracer->lines[at] = lines[i];
    tracer->units[at] = units[i];
    tracer->order[at] = i;
  }
}

static bool trace_batch(const Tracing *tracing, Tracer *tracer, Batch *batch) {
  take_rays(tracing, tracer, batch);
  memset(tracer->sums, 0, sizeof tracer->sums);
  tracer->trail.count = 0;
  if (!tracing->kernels->cast(&tracing->job, tracer->lines, batch->count, &tracer->worker, tracer->sums[0]) ||
      tracer->trail.out_of_memory)
    return false;
  batch->offsets[0] = 0;
  for (int64_t i = 0; i < batch->count; ++i)
    batch->offsets[tracer->order[i] + 1] = (int64_t)tracer->sums[i][CELLS];
  for (int64_t i = 0; i < batch->count; ++i)
    batch->offsets[i + 1] += batch->offsets[i];
  if (!reserve(tracing, batch, batch->offsets[batch->count]))
    return false;
  sort_trail(tracing, tracer, batch);
  return true;
}

static bool trace_batches(void *data, int64_t begin, int64_t end, int worker) {
  const Tracing *tracing = data;
  for (int64_t i = begin; i < end; ++i) {
    Batch *batch = &tracing->batches[i];
    const int64_t left = tracing->rays->origins.count - tracing->begin - i * BATCH;
    batch->first = tracing->begin + i * BATCH;
    batch->count = left < BATCH ? left : BATCH;
    if (!trace_batch(tracing, tracing->tracers[worker], batch))
      return false;
  }
  return true;
}

/* On the host's thread. */
static bool hand_out(void *data) {
  const Tracing *tracing = data;
  for (int64_t i = 0; i < tracing->handed; ++i) {
    const Batch *batch = &tracing->batches[i];
    const TetcastTrace trace = {
        .first = batch->first, .count = batch->count, .offsets = batch->offsets, .crossings = batch->crossings};
    if (!tracing->function(tracing->user, &trace))
      return false;
  }
  return true;
}

/* ── all of it ── */

static TetcastStatus run(Tracing *tracing, int threads, const TetcastProgress *progress) {
  TetcastContext *context = tracing->volume->context;
  const int64_t all = tracing->rays->origins.count, most = (int64_t)threads * ROUND;
  for (tracing->begin = 0; tracing->begin < all; tracing->begin += most * BATCH) {
    const int64_t left = (all - tracing->begin + BATCH - 1) / BATCH;
    tracing->handed = left < most ? left : most;
    if (tc_parallel_for(context, tracing->handed, 1, trace_batches, tracing, NULL))
      return tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: crossings of rays");
    const double done = (double)(tracing->begin + tracing->handed * BATCH) / (double)all;
    if (!tc_call_host(hand_out, tracing) ||
        (progress->function && !progress->function(progress->user, done < 1 ? done : 1)))
      return TETCAST_ERROR_CANCELLED;
  }
  return TETCAST_OK;
}

static bool begin_tracer(Tracing *tracing, bool weights, Tracer **out) {
  TetcastContext *context = tracing->volume->context;
  Tracer *tracer = *out = tc_allocate(context, 1, sizeof *tracer);
  if (!tracer)
    return false;
  const bool begun = tc_worker_begin(context, tracing->kernels, &tracing->job, &tracer->worker);
  tracer->trail = (TcTrail){.context = context, .weights = weights};
  tracer->worker.trail = &tracer->trail;
  return begun;
}

static void end(Tracing *tracing, int threads) {
  TetcastContext *context = tracing->volume->context;
  for (int i = 0; tracing->tracers && i < threads; ++i) {
    if (!tracing->tracers[i])
      continue;
    tc_worker_end(context, &tracing->tracers[i]->worker);
    tc_trail_clear(&tracing->tracers[i]->trail);
    tc_release(context, tracing->tracers[i]);
  }
  for (int i = 0; tracing->batches && i < threads * ROUND; ++i)
    tc_release(context, tracing->batches[i].crossings);
  tc_release(context, tracing->tracers);
  tc_release(context, tracing->batches);
}

TetcastStatus tc_volume_trace(const TetcastVolume *volume, const TetcastRays *rays, const TetcastTraceDesc *desc,
                              TetcastTraceFunction *function, void *user) {
  TetcastContext *context = volume->context;
  const int threads = tc_context_threads(context);
  Tracing tracing = {.volume = volume,
                     .rays = rays,
                     .function = function,
                     .user = user,
                     .kernels =
                         tc_kernels_for(volume->traversal == TETCAST_TRAVERSAL_FACES ? TETCAST_ISA_SCALAR : desc->isa),
                     .job = {.kernel = TC_KERNEL_trace, .shell = &volume->shell, .sums = SUMS}};
  bool ok = tc_allocate_array(context, (void **)&tracing.tracers, threads, sizeof(Tracer *), "workers");
  if (ok)
    memset(tracing.tracers, 0, (size_t)threads * sizeof(Tracer *));
  ok = ok && tc_allocate_array(context, (void **)&tracing.batches, threads * ROUND, sizeof *tracing.batches, "workers");
  if (ok)
    memset(tracing.batches, 0, (size_t)threads * ROUND * sizeof *tracing.batches);
  for (int i = 0; ok && i < threads; ++i)
    ok = begin_tracer(&tracing, desc->weights, &tracing.tracers[i]);
  const TetcastStatus status =
      ok ? run(&tracing, threads, &desc->progress) : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: workers");
  end(&tracing, threads);
  return status;
}
