/* SPDX-License-Identifier: Apache-2.0 */
/* Casts any rays through a scene: sorts them, so that rays that are cast together meet the same cells, and makes
 * numbers of what they gather. */
#include "render/cast.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/order.h"
#include "mesh/stage.h"
#include "render/rays.h"
#include "render/work.h"

enum {
  BATCH = 256,     /* how many rays are cast together */
  SLICE = 1 << 22, /* how many are sorted together, for 16 bytes each */
  GRAIN = 1 << 12
};

/* What each worker has. */
typedef struct Caster {
  TcWorker worker;
  TcLine lines[BATCH];
  double *memory;  /* of the next three */
  double *sums;    /* [BATCH][job.sums]; NULL: not wanted */
  double *depths;  /* [BATCH][depth.sums]; NULL: not wanted */
  double *lengths; /* [BATCH]; NULL: not wanted */
} Caster;

typedef struct Casting {
  const TetcastScene *scene;
  TcRayList list;
  const TetcastCastResult *result;
  const TcIsaKernels *kernels;
  bool gathers;    /* whether what the ray of a pixel gathers is wanted at all */
  TcRender render; /* of which there is no frame */
  /* The walk for the optical depth through a transfer function, in which extinctions are times 2^−thinner: so no depth
   * is so large that it can't be told from the opacity. */
  TcJob depth;
  TetcastTransferFunction *thin;
  int thinner;
  TcJob length;      /* the walk for the length, if the sums don't have it */
  Caster **casters;  /* [threads] */
  int64_t first;     /* the first ray of the slice */
  int64_t count;     /* how many rays the slice has */
  uint64_t *records; /* [count]: keys, and rays counted from the first */
} Casting;

/* ── plans ── */

/* The scene's transfer function in white, with extinctions so small that rays through all of the volume have an optical
 * depth of about 1 at most. */
static TetcastStatus make_thin(Casting *casting) {
  const TetcastScene *scene = casting->scene;
  static const double white[4] = {0, 1, 1, 1};
  const TetcastTransferFunctionDesc desc = {.color = white,
                                            .color_count = 1,
                                            .extinction = scene->transfer->extinction,
                                            .extinction_count = (int)scene->transfer->extinction_count};
  double largest = 0;
  for (int64_t i = 0; i < scene->transfer->extinction_count; ++i)
    largest = fmax(largest, ldexp(scene->transfer->extinction[2 * i + 1], scene->volume->exponent));
  casting->thinner = largest > 0.25 ? ilogb(fmin(largest, TC_LARGEST_EXTINCTION)) + 2 : 0;
  TetcastTransferFunction *given = NULL;
  TetcastStatus status = tc_transfer_create(scene->context, &desc, &given);
  if (!status)
    status = tc_transfer_rescale(scene->context, given, scene->values->exponent,
                                 scene->volume->exponent - casting->thinner, &casting->thin);
  tc_transfer_destroy(given);
  return status;
}

/* The walks beside the one that gathers what the ray of a pixel does. */
static TetcastStatus plan_more(Casting *casting) {
  const TetcastScene *scene = casting->scene;
  TetcastStatus status = TETCAST_OK;
  if (scene->coefficients)
    return status;
  if (casting->result->optical_depth && scene->transfer) {
    if (scene->row_count == 0)
      status = make_thin(casting);
    if (!status)
      tc_job_of_opacity(scene, casting->thin ? &casting->thin->pieces : &scene->prepared->scaled->pieces,
                        &casting->depth);
  }
  if (casting->result->length) {
    casting->length = (TcJob){.kernel = TC_KERNEL_trace,
                              .shell = &scene->volume->shell,
                              .sums = 1,
                              .clip = scene->clip,
                              .clip_count = scene->clip_count};
  }
  return status;
}

static TetcastStatus plan(Casting *casting, TetcastIsa isa) {
  const TetcastScene *scene = casting->scene;
  const TetcastCastResult *result = casting->result;
  TcRender *render = &casting->render;
  TcJob *job = &render->job;
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.isa = isa;
  job->height = 1;
  TetcastStatus status = tc_scene_prepare(scene);
  if (!status && !scene->coefficients && !scene->blend)
    status = tc_find_looks(scene, &desc, false, false, render);
  if (status)
    return status;
  job->clip = scene->clip;
  job->clip_count = scene->clip_count;
  casting->gathers = scene->coefficients || result->color || result->error || result->value;
  job->to_the_end = result->optical_depth || result->length || result->group_optical_depth;
  render->bounded = result->error != NULL;
  tc_job_of_scene(scene, render->bounded, job);
  status = plan_more(casting);
  /* How far origins are away tells for bounds on errors alone, and for what is clipped within them. */
  const double away = render->bounded || scene->clip_count > 0 ? tc_rays_away(&casting->list) : 0;
  job->interval_error = casting->depth.interval_error = casting->length.interval_error =
      tc_clip_error(scene->volume, away);
  job->resolution = tc_ray_resolution(scene->volume, away, scene->values ? scene->values->largest : 0);
  const bool one_lane = job->one_lane || casting->depth.one_lane || scene->volume->traversal == TETCAST_TRAVERSAL_FACES;
  casting->kernels = tc_kernels_for(one_lane ? TETCAST_ISA_SCALAR : isa);
  return status;
}

/* ── rays ── */

static bool find_keys(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Casting *casting = data;
  for (int64_t i = begin; i < end; ++i) {
    casting->records[i] = tc_record(tc_rays_key(&casting->list, casting->first + i), (uint32_t)i);
  }
  return true;
}

/* A channel's value by what was gathered. */
static double channel_of(TetcastChannel channel, const TcGathered *gathered, int group) {
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (tc_channels[i].info.channel == channel)
      return tc_channels[i].value(gathered, group);
  }
  return NAN;
}

static void store_groups(const TetcastCastResult *result, const TcGathered *gathered, int64_t ray) {
  const int groups = gathered->coefficients->groups;
  double mean = 0;
  for (int g = 0; g < groups; ++g) {
    const double depth = channel_of(TETCAST_CHANNEL_OPTICAL_DEPTH, gathered, g);
    const int64_t at = ray * groups + g;
    mean += depth / groups;
    if (result->radiance)
      result->radiance[at] = channel_of(TETCAST_CHANNEL_RADIANCE, gathered, g);
    if (result->group_optical_depth)
      result->group_optical_depth[at] = depth;
    if (result->transmittance)
      result->transmittance[at] = channel_of(TETCAST_CHANNEL_TRANSMITTANCE, gathered, g);
  }
  if (result->optical_depth)
    result->optical_depth[ray] = mean;
  if (result->length)
    result->length[ray] = channel_of(TETCAST_CHANNEL_PATH_LENGTH, gathered, 0);
}

/* Stores the results of a ray, which is number i of its batch. */
static void store(const Casting *casting, const Caster *caster, const TcGathered *gathered, int i, int64_t ray) {
  const TetcastCastResult *result = casting->result;
  if (casting->gathers) {
    double rgba[4];
    const double error = tc_gathered_pixel(gathered, rgba);
    if (result->color)
      memcpy(result->color + 4 * ray, rgba, sizeof rgba);
    if (result->error)
      result->error[ray] = error;
    if (result->value)
      result->value[ray] = channel_of(TETCAST_CHANNEL_VALUE, gathered, 0);
  }
  if (gathered->coefficients) {
    store_groups(result, gathered, ray);
    return;
  }
  if (result->optical_depth)
    result->optical_depth[ray] =
        caster->depths ? ldexp(-log1p(-caster->depths[i * casting->depth.sums + 3]), casting->thinner) : 0;
  if (result->length)
    result->length[ray] = ldexp(caster->lengths[i], gathered->exponent);
}

/* Casts the rays of a batch by one job, whose sums go to `sums`. */
static bool walk(const Casting *casting, const TcJob *job, Caster *caster, int count, double *sums) {
  if (!sums)
    return true;
  memset(sums, 0, (size_t)count * (size_t)job->sums * sizeof *sums);
  return casting->kernels->cast(job, caster->lines, count, &caster->worker, sums);
}

/* Takes the rays of a batch; both they and the places of their results are all over memory. */
static void take_rays(const Casting *casting, Caster *caster, const uint64_t *records, int count) {
  enum { AHEAD = 12 };
  const double *color = casting->result->color;
  for (int i = -AHEAD; i < count; ++i) {
    if (i + AHEAD < count) {
      const int64_t ahead = casting->first + tc_record_value(records[i + AHEAD]);
      tc_rays_expect(&casting->list, ahead);
      if (color)
        __builtin_prefetch(color + 4 * ahead, 1);
    }
    TcRayUnit unit;
    if (i >= 0)
      tc_rays_line(&casting->list, casting->first + tc_record_value(records[i]), &caster->lines[i], &unit);
  }
}

static bool cast_batches(void *data, int64_t begin, int64_t end, int worker) {
  const Casting *casting = data;
  const TcJob *job = &casting->render.job;
  Caster *caster = casting->casters[worker];
  for (int64_t batch = begin; batch < end; ++batch) {
    const uint64_t *records = casting->records + batch * BATCH;
    const int64_t left = casting->count - batch * BATCH;
    const int count = left < BATCH ? (int)left : BATCH;
    take_rays(casting, caster, records, count);
    if (!walk(casting, job, caster, count, caster->sums) ||
        !walk(casting, &casting->depth, caster, count, caster->depths) ||
        !walk(casting, &casting->length, caster, count, caster->lengths))
      return false;
    TcGathered gathered = tc_render_gathered(&casting->render);
    for (int i = 0; i < count; ++i) {
      gathered.sums = caster->memory + (int64_t)i * job->sums;
      store(casting, caster, &gathered, i, casting->first + tc_record_value(records[i]));
    }
  }
  return true;
}

/* ── all of it ── */

static bool begin_caster(Casting *casting, Caster **out) {
  TetcastContext *context = casting->scene->context;
  const int sums = casting->render.job.sums, depths = casting->depth.sums, lengths = casting->length.sums;
  Caster *caster = *out = tc_allocate(context, 1, sizeof *caster);
  if (!caster)
    return false;
  const bool begun = tc_worker_begin(context, casting->kernels, &casting->render.job, &caster->worker);
  caster->memory = tc_allocate(context, BATCH * (int64_t)(sums + depths + lengths), sizeof *caster->memory);
  if (!caster->memory)
    return false;
  caster->sums = casting->gathers ? caster->memory : NULL;
  caster->depths = depths > 0 ? caster->memory + BATCH * sums : NULL;
  caster->lengths = lengths > 0 ? caster->memory + BATCH * (sums + depths) : NULL;
  return begun;
}

/* Sorts the rays of the slice and casts them. */
static TetcastStatus run_slice(Casting *casting, uint64_t **scratch, const TetcastProgress *progress) {
  TetcastContext *context = casting->scene->context;
  tc_parallel_for(context, casting->count, GRAIN, find_keys, casting, NULL);
  const TetcastStatus status =
      tc_sort_records(context, &casting->records, scratch, casting->count, (UINT32_C(1) << 31) - 1);
  return status ? status
                : tc_parallel_for(context, (casting->count + BATCH - 1) / BATCH, 1, cast_batches, casting, progress);
}

static TetcastStatus run(Casting *casting, const TetcastProgress *progress) {
  TetcastContext *context = casting->scene->context;
  const int64_t all = casting->list.rays->origins.count, most = all < SLICE ? all : SLICE;
  uint64_t *scratch = NULL;
  TetcastStatus status = TETCAST_OK;
  if (!tc_allocate_array(context, (void **)&casting->records, most, sizeof *casting->records, "order of rays") ||
      !tc_allocate_array(context, (void **)&scratch, most, sizeof *scratch, "order of rays"))
    status = TETCAST_ERROR_MEMORY;
  for (int64_t first = 0; !status && first < all; first += SLICE) {
    TcStage stage;
    casting->first = first;
    casting->count = all - first < SLICE ? all - first : SLICE;
    status = run_slice(
        casting, &scratch,
        tc_stage(&stage, progress, (double)first / (double)all, (double)(first + casting->count) / (double)all));
  }
  tc_release(context, casting->records);
  tc_release(context, scratch);
  return status;
}

/* Prepares vertices for rays of the given number. */
static void prepare_points(Casting *casting) {
  const TetcastScene *scene = casting->scene;
  TcJob *job = &casting->render.job;
  if (!tc_worth_preparing(job->shell, casting->list.rays->origins.count))
    return;
  casting->render.points = tc_points_prepare(scene->volume, scene->values, tc_scene_swap_vertices(scene, false, NULL));
  job->points = casting->depth.points = casting->length.points = casting->render.points;
}

/* Frees what the workers have, and sums up what they have counted. */
static TetcastStatus end_casters(Casting *casting, int threads, TetcastStatus status, TetcastRenderStats *stats) {
  TetcastContext *context = casting->scene->context;
  for (int i = 0; i < threads; ++i) {
    Caster *caster = casting->casters[i];
    if (!caster)
      continue;
    stats->segments += caster->worker.segments;
    stats->lost += caster->worker.lost;
    if (tc_worker_failed(&caster->worker))
      status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: hits of a ray");
    tc_worker_end(context, &caster->worker);
    tc_release(context, caster->memory);
    tc_release(context, caster);
  }
  tc_release(context, casting->casters);
  return status;
}

static TetcastStatus run_threads(Casting *casting, const TetcastProgress *progress, TetcastRenderStats *stats) {
  TetcastContext *context = casting->scene->context;
  const int threads = tc_context_threads(context);
  if (!tc_allocate_array(context, (void **)&casting->casters, threads, sizeof(Caster *), "workers"))
    return TETCAST_ERROR_MEMORY;
  memset(casting->casters, 0, (size_t)threads * sizeof(Caster *));
  bool ok = true;
  for (int i = 0; ok && i < threads; ++i)
    ok = begin_caster(casting, &casting->casters[i]);
  const TetcastStatus status =
      ok ? run(casting, progress) : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: workers");
  return end_casters(casting, threads, status, stats);
}

/* The largest of the rays' bounds. */
static double largest_error(const TetcastCastResult *result, int64_t count) {
  double largest = result->error ? 0 : (double)NAN;
  for (int64_t i = 0; result->error && i < count; ++i) {
    if (!(result->error[i] <= largest))
      largest = result->error[i];
  }
  return largest;
}

TetcastStatus tc_scene_cast(const TetcastScene *scene, const TetcastRays *rays, const TetcastCastDesc *desc,
                            const TetcastCastResult *result, TetcastRenderStats *stats) {
  Casting casting = {
      .scene = scene, .list = tc_rays_list(rays, scene->volume), .result = result, .render = {.scene = scene}};
  TetcastStatus status = plan(&casting, desc->isa);
  TetcastRenderStats sum = {.rays = rays->origins.count};
  if (!status) {
    prepare_points(&casting);
    status = run_threads(&casting, &desc->progress, &sum);
  }
  if (casting.render.points)
    tc_release(scene->context, tc_scene_swap_vertices(scene, false, casting.render.points));
  tc_transfer_destroy(casting.thin);
  tc_forget_looks(scene->context, &casting.render);
  if (status || !stats)
    return status;
  sum.isa = casting.kernels->name;
  sum.precision = casting.kernels->precision;
  sum.error = largest_error(result, sum.rays);
  *stats = sum;
  return TETCAST_OK;
}
