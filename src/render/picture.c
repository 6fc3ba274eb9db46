/* SPDX-License-Identifier: Apache-2.0 */
/* Makes pictures of scenes: chooses the kernel, has vertices projected where that pays, and shares tiles among workers.
 */
#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "base/parallel.h"
#include "base/vec3.h"
#include "optics/sampled.h"
#include "render/fragments.h"

/* ── the choice among kernels ── */

const TcIsaKernels *tc_kernels_for(TetcastIsa most) {
  static const struct {
    TetcastIsa isa;
    const TcIsaKernels *kernels;
  } all[] = {
#ifdef TC_HAVE_X86
      {TETCAST_ISA_AVX512, &tc_kernels_avx512},
      {TETCAST_ISA_AVX2, &tc_kernels_avx2},
#endif
      {TETCAST_ISA_SCALAR, &tc_kernels_one},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    if ((most == TETCAST_ISA_AUTO || all[i].isa <= most) && tc_cpu_has(all[i].isa))
      return all[i].kernels;
  }
  return &tc_kernels_one;
}

const TcIsaKernels *tc_single_kernels_for(TetcastIsa most) {
#ifdef TC_HAVE_X86
  const TcIsaKernels *kernels = tc_kernels_for(most);
  if (kernels == &tc_kernels_avx512)
    return &tc_kernels_avx512_f32;
  if (kernels == &tc_kernels_avx2)
    return &tc_kernels_avx2_f32;
#else
  (void)most;
#endif
  return NULL;
}

/* The number of the first row of a gatherer that has all of the needed features, and among the associations only the
 * needed one; and whether only kernels of one lane have it. */
static int choose_row(const char *gatherer, unsigned needed, bool *one_lane) {
  static const struct {
    const char *gatherer;
    unsigned features;
    bool one_lane;
  } rows[] = {
#define KERNEL(name, gatherer, features)     {#gatherer, (features), false},
#define KERNEL_DOUBLE                        KERNEL
#define KERNEL_ONE(name, gatherer, features) {#gatherer, (features), true},
#include "render/kernels.def"
#undef KERNEL
#undef KERNEL_DOUBLE
#undef KERNEL_ONE
  };
  for (int i = 0; i < TC_KERNELS; ++i) {
    if (strcmp(rows[i].gatherer, gatherer) == 0 && (rows[i].features & needed) == needed &&
        (rows[i].features & TC_ASSOCIATIONS) == (needed & TC_ASSOCIATIONS)) {
      *one_lane = rows[i].one_lane;
      return i;
    }
  }
  return -1; /* kernels.def has a row for all that is asked for */
}

static unsigned association_of(const TcRows *values) {
  return values->association == TETCAST_CELL ? TC_CELLS : values->association == TETCAST_CORNER ? TC_CORNERS : 0;
}

/* Sets up a job for the scalar `values` seen through the transfer function with these pieces. `more` are further
 * features: TC_BOUND where a bound on the error is to be gathered, TC_SURFACES. */
static void see_through(const TcRows *values, const TcPieces *pieces, unsigned more, TcJob *job) {
  job->values = values;
  job->pieces = pieces;
  job->sums = more & TC_BOUND ? 5 : !job->surfaces || !job->surfaces->depth ? 4 : job->surfaces->normal ? 9 : 6;
  job->tolerance = tc_tolerance_begin(pieces, 0, 0);
  const bool one_color = pieces->one_color && !job->lights && !job->second;
  const unsigned needed =
      (job->second ? TC_SECOND : 0) | (one_color ? 0 : TC_COLORED) | (pieces->scaled ? TC_SCALED : 0) | more;
  job->kernel = choose_row(job->sampler ? "sampled" : "emission", (job->sampler ? 0 : needed) | association_of(values),
                           &job->one_lane);
}

void tc_job_of_scene(const TetcastScene *scene, bool bound, TcJob *job) {
  const unsigned measured = bound ? TC_BOUND : 0;
  if (scene->coefficients) {
    job->shell = &scene->prepared->shell;
    job->coefficients = scene->coefficients;
    job->sums = 3 * scene->coefficients->groups + (bound ? 3 : 2);
    job->kernel = choose_row("groups", TC_WEIGHTS | TC_CELLS | measured, &job->one_lane);
    return;
  }
  if (scene->blend) { /* these look at all of the volume, as nothing is hidden */
    job->shell = &scene->prepared->shell;
    job->values = scene->values;
    job->blend = scene->blend;
    job->sums = 2;
    job->kernel = choose_row("value", association_of(scene->values), &job->one_lane);
    return;
  }
  const unsigned lit = !job->lights ? 0 : job->lights->width == TC_LIGHT_TINTED ? TC_LIT | TC_TINTED : TC_LIT;
  see_through(scene->values, &scene->prepared->scaled->pieces, measured | (job->surfaces ? TC_SURFACES : 0) | lit, job);
  job->shell = &scene->prepared->shell;
}

/* Sets up the job for fragments, by coefficients or of what is seen through a transfer function. */
static void see_fragments(const TetcastScene *scene, TcJob *job) {
  job->sums = 1;
  if (job->coefficients) {
    job->to_the_end = true; /* whoever composites them may want all of the optical depth, and of the length */
    job->kernel = choose_row("visit_groups", TC_WEIGHTS | TC_CELLS | TC_PARTS, &job->one_lane);
    return;
  }
  const unsigned looks = (job->surfaces ? TC_SURFACES : 0) | (job->second ? TC_SECOND : 0);
  const unsigned needed =
      TC_COLORED | TC_PARTS | (job->pieces->scaled ? TC_SCALED : 0) | looks | association_of(scene->values);
  job->kernel = choose_row("visit", needed, &job->one_lane);
}

void tc_job_of_opacity(const TetcastScene *scene, const TcPieces *pieces, TcJob *job) {
  job->shell = &scene->prepared->shell;
  job->values = scene->values;
  job->pieces = pieces;
  job->sums = 4;
  job->tolerance = tc_tolerance_begin(pieces, 0, 0);
  job->second = scene->row_count > 0 ? &scene->prepared->second : NULL;
  job->kernel = choose_row(
      "emission", (pieces->scaled ? TC_SCALED : 0) | (job->second ? TC_SECOND : 0) | association_of(scene->values),
      &job->one_lane);
  job->clip = scene->clip;
  job->clip_count = scene->clip_count;
}

void tc_job_of(const TetcastVolume *volume, const TcRows *values, const TcPieces *pieces, TcJob *job) {
  see_through(values, pieces, 0, job);
  job->shell = &volume->shell;
}

/* ── workers ── */

bool tc_worker_begin(TetcastContext *context, const TcIsaKernels *kernels, const TcJob *job, TcWorker *worker) {
  memset(worker, 0, sizeof *worker);
  for (int i = 0; i < TC_HIT_LISTS; ++i)
    worker->hits[i].context = context;
  worker->fragments.context = context;
  const size_t size = kernels->state_size(job);
  worker->state = tc_allocate(context, 1, size);
  if (!worker->state)
    return false;
  memset(worker->state, 0, size);
  if (!job->precise)
    return true;
  const size_t precise_size = job->precise->state_size(job->precise_job);
  worker->precise_state = tc_allocate(context, 1, precise_size);
  if (worker->precise_state)
    memset(worker->precise_state, 0, precise_size);
  return worker->precise_state != NULL;
}

void tc_worker_end(TetcastContext *context, TcWorker *worker) {
  for (int i = 0; i < TC_HIT_LISTS && worker->hits[i].context; ++i)
    tc_hits_clear(&worker->hits[i]);
  tc_release(context, worker->state);
  tc_release(context, worker->precise_state);
  tc_fragment_list_clear(&worker->fragments);
}

bool tc_worker_failed(const TcWorker *worker) {
  for (int i = 0; i < TC_HIT_LISTS; ++i) {
    if (worker->hits[i].out_of_memory)
      return true;
  }
  return false;
}

/* ── a frame ── */

/* Counts the cells that the rays of a tile cross, whatever they hide, on a walk of its own. */
static bool count_cells(const TcRender *render, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorking *working) {
  const int64_t segments = working->worker.segments, pixels = (x1 - x0) * (y1 - y0);
  const double samples = render->count.samples_x * render->count.samples_y;
  const TcJob *job = &render->job;
  TcWorker *worker = &working->worker;
  void *const state = worker->state;
  memset(working->cells, 0, (size_t)pixels * sizeof *working->cells);
  if (job->precise)
    worker->state = worker->precise_state;
  const bool ok =
      (job->precise ? job->precise : render->kernels)->tile(&render->count, x0, y0, x1, y1, worker, working->cells);
  worker->state = state;
  worker->segments = segments; /* which are those of the picture */
  for (int64_t i = 0; i < pixels; ++i)
    working->cells[i] /= samples;
  return ok;
}

/* Writes a tile whose sums are pixels, and after each, if it is bounded, a bound on its error. */
static void store_plain(const TcRender *render, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorking *working) {
  enum { PIXEL = 4 * sizeof(double) };
  const TetcastFrame *frame = render->frame;
  const double *sums = working->sums;
  double error = working->error;
  for (int64_t y = y0; y < y1; ++y) {
    char *row = (char *)frame->pixels + (y - render->first_row) * frame->row_stride + x0 * PIXEL;
    if (!render->bounded) {
      memcpy(row, sums, (size_t)(x1 - x0) * PIXEL);
      sums += 4 * (x1 - x0);
      continue;
    }
    for (int64_t x = x0; x < x1; ++x, sums += 5, row += PIXEL) {
      memcpy(row, sums, PIXEL);
      if (!(sums[4] <= error))
        error = sums[4];
    }
  }
  working->error = error;
}

static bool render_tile(const TcRender *render, int64_t tile_x, int64_t tile_y, TcWorking *working) {
  const TcJob *job = &render->job;
  const int64_t first = render->first_row, end = first + render->frame->height;
  const int64_t x0 = tile_x * TC_TILE, y0 = first + tile_y * TC_TILE;
  const int64_t x1 = x0 + TC_TILE < job->width ? x0 + TC_TILE : job->width,
                y1 = y0 + TC_TILE < end ? y0 + TC_TILE : end;
  const int64_t numbers = (x1 - x0) * (y1 - y0) * job->sums;
  const double samples = job->samples_x * job->samples_y;
  memset(working->sums, 0, (size_t)numbers * sizeof *working->sums);
  if (render->fragments)
    return tc_fragments_tile(render, x0, y0, x1, y1, working);
  if (!render->kernels->tile(job, x0, y0, x1, y1, &working->worker, working->sums) ||
      (render->counted && !count_cells(render, x0, y0, x1, y1, working)))
    return false;
  for (int64_t i = 0; samples > 1 && i < numbers; ++i)
    working->sums[i] /= samples;
  if (render->plain) {
    store_plain(render, x0, y0, x1, y1, working);
    return true;
  }
  TcGathered gathered = tc_render_gathered(render);
  gathered.sums = working->sums;
  gathered.cells = working->cells;
  for (int64_t y = y0; y < y1; ++y) {
    for (int64_t x = x0; x < x1; ++x, gathered.sums += job->sums, ++gathered.cells) {
      const double bound = tc_frame_store(render->frame, x, y - first, &gathered);
      if (!(bound <= working->error))
        working->error = bound;
    }
  }
  return true;
}

/* Renders tiles `begin` to `end` along Morton's curve. As these are neighbours, their rays meet many of the same cells,
 * which are still in the cache. */
static bool render_tiles(void *data, int64_t begin, int64_t end, int worker) {
  TcRender *render = data;
  for (int64_t i = begin; i < end; ++i) {
    const int64_t x = tc_even_bits(i), y = tc_even_bits(i >> 1);
    if (x >= render->tiles_x || y >= render->tiles_y)
      continue;
    if (!render_tile(render, x, y, &render->workers[worker]))
      return false;
  }
  return true;
}

/* ── vertices on the screen ── */

typedef struct Projection {
  const TcIsaKernels *kernels;
  const TcJob *job;
  TcScreen *screen;
} Projection;

static bool project_some(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Projection *p = data;
  p->kernels->project(p->job, p->screen, begin, end);
  return true;
}

/* Projects the vertices; the job uses `screen` from then on. It is an error if memory runs out: rays could be walked
 * without projected vertices, but their results are rounded differently, and no bit of a picture may depend on how much
 * memory there is. */
static TetcastStatus project(const TetcastScene *scene, const TcIsaKernels *kernels, const TcScreen *setup, TcJob *job,
                             TcScreen *screen) {
  const bool single = kernels->vertex_size < 4 * sizeof(double);
  const int64_t count = scene->volume->vertex_count;
  void *vertices = tc_scene_swap_vertices(scene, single, NULL);
  if (!vertices && !tc_allocate_array(scene->context, &vertices, count, kernels->vertex_size, "vertices on the screen"))
    return TETCAST_ERROR_MEMORY;
  *screen = *setup;
  screen->vertices = vertices;
  Projection projection = {kernels, job, screen};
  tc_parallel_for(scene->context, count, 1 << 14, project_some, &projection, NULL);
  job->screen = screen;
  return TETCAST_OK;
}

/* Keeps the memory of prepared vertices for the scene's next picture. */
static void keep_vertices(const TetcastScene *scene, const TcRender *render, bool single) {
  void *vertices = render->job.screen ? render->job.screen->vertices : render->points;
  if (vertices)
    tc_release(scene->context, tc_scene_swap_vertices(scene, single, vertices));
}

/* ── all of it ── */

/* Changes the job to single precision where a bound on its error leaves enough of the tolerance; returns whether it
 * did. That bound is gathered along each ray, as it tells which rays are walked again. It leaves out two things, with
 * which single precision isn't used: the borders of holes in the field, at which what is seen jumps, and meshes that
 * fold over themselves, where paths of rays change by leaps. */
static bool allow_single(const TetcastScene *scene, const TetcastRenderDesc *desc, const TcScreen *setup,
                         TcRender *render) {
  const TcIsaKernels *kernels = tc_single_kernels_for(desc->isa);
  TcJob *job = &render->job;
  TcTolerance tolerance;
  double values;
  if (!kernels || job->surfaces || job->lights || job->second || !(desc->tolerance > 0) ||
      job->values->association != TETCAST_POINT || job->values->has_holes || scene->volume->folds)
    return false;
  if (!tc_tolerance_single(job->pieces, desc->tolerance, scene->values->largest, 2 * scene->volume->radius, &tolerance,
                           &values))
    return false;
  tc_job_of_scene(scene, true, job);
  render->bounded = true;
  job->tolerance = tolerance;
  render->precise = *job;
  render->precise.tolerance = tc_tolerance_begin(job->pieces, 0, desc->tolerance);
  job->precise = render->kernels;
  job->precise_job = &render->precise;
  render->kernels = kernels;
  job->resolution = tc_screen_resolution(scene->volume, setup, true, job->width, job->height, values);
  return true;
}

/* The largest component of what is seen beside the transfer function's own colours. */
static double brightest_of(const TcJob *job) {
  double brightest = 0;
  for (int k = 0; k < 3; ++k) {
    if (job->surfaces)
      brightest = fmax(brightest, job->surfaces->largest[k]);
    if (job->lights)
      brightest = fmax(brightest, job->lights->factor * job->pieces->largest[k] + job->lights->highlight);
  }
  return brightest;
}

/* Decides whether vertices are projected and which precision is used, and sets the tolerance and the error bounds'
 * terms accordingly. */
static TetcastStatus plan(const TetcastScene *scene, const TetcastRenderDesc *desc, bool boundable, TcRender *render) {
  TcJob *job = &render->job;
  TcScreen setup;
  const int64_t rays = job->width * job->height * desc->samples;
  const bool worth = tc_worth_preparing(job->shell, rays);
  /* Parts of a larger mesh must not differ in it: rays that pass from one to another would pass edges on different
   * sides. */
  const bool wanted = worth || scene->volume->is_part;
  const bool on_screen = wanted && tc_screen_setup(scene->volume, &job->view, job->width, job->height, &setup);
  double away2 = 0;
  for (int k = 0; k < 3; ++k)
    away2 += (scene->volume->center[k] - job->view.eye[k]) * (scene->volume->center[k] - job->view.eye[k]);
  const double largest = scene->values ? scene->values->largest : 0;
  const TcResolution in_ray_space = tc_ray_resolution(scene->volume, sqrt(away2), largest);
  job->interval_error = tc_clip_error(scene->volume, sqrt(away2));
  job->resolution =
      on_screen ? tc_screen_resolution(scene->volume, &setup, false, job->width, job->height, largest) : in_ray_space;
  if (job->pieces)
    job->tolerance = tc_tolerance_begin(job->pieces, brightest_of(job), desc->tolerance);
  if (worth && !on_screen) {
    render->points = tc_points_prepare(scene->volume, scene->values, tc_scene_swap_vertices(scene, false, NULL));
    job->points = render->points;
  }
  if (!on_screen)
    return TETCAST_OK;
  if (boundable && job->pieces && allow_single(scene, desc, &setup, render)) {
    render->precise.resolution = in_ray_space; /* the few rays that are walked again don't use projected vertices */
  }
  return project(scene, render->kernels, &setup, job, &render->screen);
}

/* Sets up the count of cells: as the picture, but of all the mesh and without light. */
static void plan_count(TcRender *render) {
  TcJob *count = &render->count;
  *count = render->job.precise ? render->precise : render->job; /* it takes double precision */
  count->kernel = TC_KERNEL_count;
  count->shell = &render->scene->volume->shell;
  count->pieces = NULL;
  count->coefficients = NULL;
  count->surfaces = NULL;
  count->sampler = NULL;
  count->sums = 1;
}

/* Renders all tiles. */
static TetcastStatus run_tiles(TcRender *render, const TetcastProgress *progress) {
  render->tiles_x = (render->job.width + TC_TILE - 1) / TC_TILE;
  render->tiles_y = (render->frame->height + TC_TILE - 1) / TC_TILE;
  int64_t side = 1;
  while (side < render->tiles_x || side < render->tiles_y)
    side *= 2;
  return tc_parallel_for(render->scene->context, side * side, 1, render_tiles, render, progress);
}

/* Renders the frame, and sums up what the workers have counted. */
static TetcastStatus run(TcRender *render, const TetcastRenderDesc *desc, TetcastRenderStats *stats) {
  TetcastContext *context = render->scene->context;
  const int threads = tc_context_threads(context);
  if (!tc_allocate_array(context, (void **)&render->workers, threads, sizeof *render->workers, "workers"))
    return TETCAST_ERROR_MEMORY;
  bool ok = true;
  for (int i = 0; i < threads; ++i) {
    TcWorking *w = &render->workers[i];
    ok = tc_worker_begin(context, render->kernels, &render->job, &w->worker) && ok;
    w->sums = tc_allocate(context, TC_TILE * TC_TILE * (int64_t)render->job.sums, sizeof *w->sums);
    w->error = 0;
    w->cells = render->counted ? tc_allocate(context, TC_TILE * TC_TILE, sizeof *w->cells) : NULL;
    ok = ok && w->sums && (w->cells || !render->counted);
  }
  TetcastStatus status = TETCAST_OK;
  if (ok && render->fragments)
    ok = tc_fragments_lend(render, threads);
  if (!ok)
    status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: workers");
  else if (desc->adaptive_coarse > 0)
    status = tc_adaptive_run(render, desc, &stats->rays);
  else
    status = run_tiles(render, &desc->progress);
  if (ok && render->fragments)
    status = tc_fragments_take(render, threads, status);
  for (int i = 0; i < threads; ++i) {
    TcWorking *w = &render->workers[i];
    stats->segments += w->worker.segments;
    stats->lost += w->worker.lost;
    if (!(w->error <= stats->error))
      stats->error = w->error;
    if (tc_worker_failed(&w->worker))
      status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: hits of a ray");
    tc_worker_end(context, &w->worker);
    tc_release(context, w->sums);
    tc_release(context, w->cells);
  }
  tc_release(context, render->workers);
  return status;
}

TetcastStatus tc_find_looks(const TetcastScene *scene, const TetcastRenderDesc *desc, bool depth, bool normal,
                            TcRender *render) {
  TcJob *job = &render->job;
  const bool lit = tc_scene_is_lit(scene), rows = scene->row_count > 0,
             one_row = render->fragments && (rows || scene->values->association != TETCAST_POINT),
             surfaces = depth || one_row || tc_scene_has_surfaces(scene);
  const bool all = (int)surfaces + (int)lit + (int)rows > 1 || (lit && !tc_light_is_gray(&scene->lighting));
  TetcastStatus status = TETCAST_OK;
  if (surfaces || all) {
    status = tc_scene_surfaces(scene, desc->isa, normal, &render->surfaces);
    render->surfaces.depth = depth;
    render->surfaces.view = &job->view;
    render->surfaces.pixel = 2 * sqrt(tc_dot(job->view.up, job->view.up)) / (double)job->height;
    job->surfaces = &render->surfaces;
  }
  render->lights = (TcLights){.width = TC_LIGHT_TINTED, .factor = 1};
  if (!status && lit)
    status = tc_scene_lights(scene, desc->isa, &job->view, all ? TC_LIGHT_TINTED : TC_LIGHT_GRAY, &render->lights);
  if (lit || all)
    job->lights = &render->lights;
  if (rows)
    job->second = &scene->prepared->second;
  if (!status && all && !rows) {
    TetcastTransferFunction *only = scene->prepared->scaled;
    status = tc_second_build(scene->context, &only, 1, &only->pieces, &render->second);
    job->second = &render->second;
  }
  return status;
}

void tc_forget_looks(TetcastContext *context, TcRender *render) {
  tc_lights_clear(context, &render->lights);
  tc_second_clear(context, &render->second);
}

TetcastStatus tc_scene_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *given,
                              TetcastFrame *frame, TetcastRenderStats *stats) {
  return tc_render(scene, camera, given, frame, NULL, stats);
}

TetcastStatus tc_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *given,
                        TetcastFrame *frame, struct TcFragmentWork *fragments, TetcastRenderStats *stats) {
  TetcastContext *context = scene->context;
  TetcastRenderDesc all = *given;
  if (all.adaptive_coarse > 0 && all.adaptive_epsilon == 0) { /* no two corners differ by less: all rays are cast */
    all.samples = all.adaptive_fine;
    all.adaptive_coarse = 0;
  }
  const TetcastRenderDesc *desc = &all;
  const bool exact = desc->integrator == TETCAST_INTEGRATOR_EXACT;
  const bool normal = tc_frame_channel(frame, TETCAST_CHANNEL_NORMAL) != NULL,
             depth = normal || tc_frame_channel(frame, TETCAST_CHANNEL_DEPTH);
  const bool boundable = exact && !fragments && !scene->blend && !depth && !tc_scene_has_surfaces(scene) &&
                         !tc_scene_is_lit(scene) && scene->row_count == 0,
             measured = boundable && tc_frame_channel(frame, TETCAST_CHANNEL_ERROR);
  TcRender render = {
      .scene = scene, .frame = frame, .fragments = fragments, .first_row = desc->picture_height ? desc->first_row : 0};
  TcJob *job = &render.job;
  job->width = frame->width;
  job->height = desc->picture_height ? desc->picture_height : frame->height;
  tc_sample_grid(desc->samples, &job->samples_x, &job->samples_y);
  TetcastStatus status =
      tc_view_create(context, camera, scene->volume, (double)job->width / (double)job->height, &job->view);
  if (!status)
    status = tc_scene_prepare(scene);
  if (!status && !scene->coefficients && !scene->blend)
    status = tc_find_looks(scene, desc, depth, normal, &render);
  TcSampler *sampler = NULL;
  if (!status && !exact)
    status = tc_sampler_create(context, desc->integrator, desc->integrator_n, &sampler);
  if (status) {
    tc_forget_looks(context, &render);
    return status;
  }
  job->sampler = sampler;
  job->clip = scene->clip;
  job->clip_count = scene->clip_count;
  job->stop = desc->stop;
  job->start = desc->start;
  job->to_the_end =
      tc_frame_channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH) || tc_frame_channel(frame, TETCAST_CHANNEL_PATH_LENGTH);
  tc_job_of_scene(scene, measured, job);
  if (fragments)
    see_fragments(scene, job);
  const bool one_by_one = job->one_lane || scene->volume->traversal == TETCAST_TRAVERSAL_FACES;
  render.bounded = measured;
  render.counted = tc_frame_channel(frame, TETCAST_CHANNEL_CELLS) != NULL;
  render.plain = job->pieces && !depth && !render.counted && frame->type == TETCAST_TYPE_FLOAT64 &&
                 !tc_frame_channel(frame, TETCAST_CHANNEL_ERROR);
  render.kernels = tc_kernels_for(one_by_one ? TETCAST_ISA_SCALAR : desc->isa);
  status = plan(scene, desc, boundable, &render); /* this may change to kernels in single precision */
  TetcastRenderStats sum = {.rays = frame->width * frame->height * desc->samples,
                            .isa = render.kernels->name,
                            .precision = render.kernels->precision};
  if (!status && render.counted)
    plan_count(&render);
  if (!status)
    status = run(&render, desc, &sum);
  keep_vertices(scene, &render, job->precise != NULL);
  tc_sampler_destroy(sampler);
  tc_forget_looks(context, &render);
  if (!render.bounded || desc->adaptive_coarse > 0)
    sum.error = NAN;
  if (!status && stats)
    *stats = sum;
  return status;
}
