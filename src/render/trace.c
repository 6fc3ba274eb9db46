/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the cells that any rays cross. Kernels note them as the host is given them, in a list for each lane
 * (walk/trail.h); here they are handed out, ray by ray. */
#include <math.h>
#include <string.h>

#include "base/call.h"
#include "base/parallel.h"
#include "render/cast.h"
#include "render/rays.h"
#include "render/render.h"

enum {
  BATCH = 256, /* how many rays are traced together */
  ROUND = 2    /* how many batches each thread traces before they are handed out */
};

/* What is kept of some rays until it has been handed out. */
typedef struct Batch {
  int64_t first, count;
  TcTrail trail;
  const TetcastCrossing *crossings[BATCH]; /* of each ray */
  int64_t crossed[BATCH];                  /* how many these are */
} Batch;

typedef struct Tracer {
  TcWorker worker;
  TcLine lines[BATCH];
  TcTrailWay ways[BATCH];
  int64_t order[BATCH]; /* which of the batch each of these rays is */
  double sums[BATCH][TC_TRACE_SUMS];
} Tracer;

typedef struct Tracing {
  const TetcastVolume *volume;
  TcRayList list;
  const TcIsaKernels *kernels;
  TcJob job;
  Tracer **tracers; /* [threads] */
  Batch *batches;   /* [threads · ROUND] */
  int64_t begin;    /* the first ray of the round */
  TetcastTraceFunction *function;
  void *user;
  int64_t handed; /* how many batches are handed out together */
} Tracing;

/* ── batches ── */

/* How the host counts along a ray. */
static TcTrailWay way_of(const TetcastVolume *volume, const TcLine *line, const TcRayUnit *unit) {
  const int half = -unit->exponent / 2;
  TcTrailWay way = {.scale = {ldexp(1 / unit->length, half), ldexp(1, -unit->exponent - half)},
                    .begin = unit->begin,
                    .end = unit->end};
  for (int k = 0; k < 3; ++k) /* as in walk/place.h */
    way.near -= ((line->eye[k] - volume->center[k]) + line->offset[k]) * line->direction[k];
  return way;
}

/* Takes the rays of a batch, those along the same axis next to each other, as the rays of a packet must have it in
 * common (walk/place.h). */
static void take_rays(const Tracing *tracing, Tracer *tracer, const Batch *batch) {
  enum { KINDS = 8, KIND_BITS = 28 };
  int64_t next[KINDS + 1] = {0};
  uint32_t kind[BATCH];
  for (int64_t i = 0; i < batch->count; ++i) {
    kind[i] = tc_rays_key(&tracing->list, batch->first + i) >> KIND_BITS;
    ++next[kind[i] + 1];
  }
  for (int k = 0; k < KINDS; ++k)
    next[k + 1] += next[k];
  for (int64_t i = 0; i < batch->count; ++i) {
    const int64_t at = next[kind[i]]++;
    TcRayUnit unit;
    tc_rays_line(&tracing->list, batch->first + i, &tracer->lines[at], &unit);
    tracer->ways[at] = way_of(tracing->volume, &tracer->lines[at], &unit);
    tracer->order[at] = i;
  }
}

static bool trace_batch(const Tracing *tracing, Tracer *tracer, Batch *batch) {
  take_rays(tracing, tracer, batch);
  memset(tracer->sums, 0, sizeof tracer->sums);
  tc_trail_restart(&batch->trail);
  batch->trail.ways = tracer->ways;
  tracer->worker.trail = &batch->trail;
  if (!tracing->kernels->cast(&tracing->job, tracer->lines, batch->count, &tracer->worker, tracer->sums[0]) ||
      batch->trail.out_of_memory)
    return false;
  for (int64_t i = 0; i < batch->count; ++i) {
    const double *sums = tracer->sums[i];
    const int64_t to = tracer->order[i];
    batch->crossed[to] = (int64_t)sums[TC_TRACE_CELLS];
    batch->crossings[to] = batch->trail.list[(int)sums[TC_TRACE_LIST]].data + (int64_t)sums[TC_TRACE_FIRST];
  }
  return true;
}

static bool trace_batches(void *data, int64_t begin, int64_t end, int worker) {
  const Tracing *tracing = data;
  for (int64_t i = begin; i < end; ++i) {
    Batch *batch = &tracing->batches[i];
    const int64_t left = tracing->list.rays->origins.count - tracing->begin - i * BATCH;
    batch->first = tracing->begin + i * BATCH;
    batch->count = left < BATCH ? left : BATCH;
    if (!trace_batch(tracing, tracing->tracers[worker], batch))
      return false;
  }
  return true;
}

/* On the host's thread: each ray by itself, as its crossings are not next to those of the next one. */
static bool hand_out(void *data) {
  const Tracing *tracing = data;
  for (int64_t i = 0; i < tracing->handed; ++i) {
    const Batch *batch = &tracing->batches[i];
    for (int64_t j = 0; j < batch->count; ++j) {
      const int64_t offsets[2] = {0, batch->crossed[j]};
      const TetcastTrace trace = {
          .first = batch->first + j, .count = 1, .offsets = offsets, .crossings = batch->crossings[j]};
      if (!tracing->function(tracing->user, &trace))
        return false;
    }
  }
  return true;
}

/* ── all of it ── */

static TetcastStatus run(Tracing *tracing, int threads, const TetcastProgress *progress) {
  TetcastContext *context = tracing->volume->context;
  const int64_t all = tracing->list.rays->origins.count, most = (int64_t)threads * ROUND;
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

static bool begin_tracer(Tracing *tracing, Tracer **out) {
  TetcastContext *context = tracing->volume->context;
  Tracer *tracer = *out = tc_allocate(context, 1, sizeof *tracer);
  if (!tracer)
    return false;
  const bool begun = tc_worker_begin(context, tracing->kernels, &tracing->job, &tracer->worker);
  return begun;
}

static void end(Tracing *tracing, int threads) {
  TetcastContext *context = tracing->volume->context;
  for (int i = 0; tracing->tracers && i < threads; ++i) {
    if (!tracing->tracers[i])
      continue;
    tc_worker_end(context, &tracing->tracers[i]->worker);
    tc_release(context, tracing->tracers[i]);
  }
  for (int i = 0; tracing->batches && i < threads * ROUND; ++i)
    tc_trail_clear(&tracing->batches[i].trail);
  tc_release(context, tracing->tracers);
  tc_release(context, tracing->batches);
}

TetcastStatus tc_volume_trace(const TetcastVolume *volume, const TetcastRays *rays, const TetcastTraceDesc *desc,
                              TetcastTraceFunction *function, void *user) {
  TetcastContext *context = volume->context;
  const int threads = tc_context_threads(context);
  Tracing tracing = {
      .volume = volume,
      .list = tc_rays_list(rays, volume),
      .function = function,
      .user = user,
      .kernels = tc_kernels_for(volume->traversal == TETCAST_TRAVERSAL_FACES ? TETCAST_ISA_SCALAR : desc->isa),
      .job = {.kernel = TC_KERNEL_trace, .shell = &volume->shell, .sums = TC_TRACE_SUMS},
  };
  double *points =
      tc_worth_preparing(&volume->shell, rays->origins.count) ? tc_points_prepare(volume, NULL, NULL) : NULL;
  tracing.job.points = points;
  bool ok = tc_allocate_array(context, (void **)&tracing.tracers, threads, sizeof(Tracer *), "workers");
  if (ok)
    memset(tracing.tracers, 0, (size_t)threads * sizeof(Tracer *));
  ok = ok && tc_allocate_array(context, (void **)&tracing.batches, threads * ROUND, sizeof *tracing.batches, "workers");
  if (ok)
    memset(tracing.batches, 0, (size_t)threads * ROUND * sizeof *tracing.batches);
  const int half = volume->exponent / 2;
  for (int i = 0; ok && i < threads * ROUND; ++i)
    tracing.batches[i].trail = (TcTrail){
        .context = context, .weights = desc->weights, .scale = {ldexp(1, half), ldexp(1, volume->exponent - half)}};
  for (int i = 0; ok && i < threads; ++i)
    ok = begin_tracer(&tracing, &tracing.tracers[i]);
  const TetcastStatus status =
      ok ? run(&tracing, threads, &desc->progress) : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: workers");
  end(&tracing, threads);
  tc_release(context, points);
  return status;
}
