/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "base/parallel.h"
#include "optics/sampled.h"
#include "render/render.h"

TetcastStatus tc_scene_create(TetcastContext *context, const TetcastVolume *volume, TetcastScene **out) {
  TetcastScene *scene;
  if (!tc_allocate_array(context, (void **)&scene, 1, sizeof *scene, "scene")) return TETCAST_ERROR_MEMORY;
  *scene = (TetcastScene){.context = context, .volume = volume};
  pthread_mutex_init(&scene->mutex, NULL); /* which can't fail with default attributes */
  *out = scene;
  return TETCAST_OK;
}

static void forget(TetcastScene *scene) {
  tc_shell_clear(&scene->shell);
  tc_transfer_destroy(scene->scaled);
  scene->scaled = NULL;
  scene->field_number = 0;
}

/* Calls for one scene may come at the same time: one of them does the work. None is under way that uses what is replaced, as neither
 * field nor transfer function change while the scene renders. */
static TetcastStatus prepare(TetcastScene *scene) {
  const TetcastVolume *volume = scene->volume;
  TetcastStatus status = TETCAST_OK;
  pthread_mutex_lock(&scene->mutex);
  if (scene->field_number != volume->field_number) {
    forget(scene);
    status = tc_transfer_rescale(scene->context, scene->transfer, volume->value_exponent, volume->exponent, &scene->scaled);
    if (!status) status = tc_shell_build(volume, &scene->scaled->pieces, &scene->shell);
    if (!status) scene->field_number = volume->field_number;
  }
  pthread_mutex_unlock(&scene->mutex);
  return status;
}

/* Single precision for packets, where a bound on what it costs leaves enough of the tolerance. To find out how steep the field is takes about as
 * long as is saved at ten crossings of each cell: small pictures of large meshes are not worth it, nor is what would not do even for a
 * flat field. */
static TetcastStatus allow_single(TetcastScene *scene, double wanted, int64_t rays, TcTolerance *tolerance) {
  const TetcastVolume *volume = scene->volume;
  const double cells = (double)volume->cell_count;
  if (!(wanted > 0) || (double)rays * cbrt(cells) < 4 * cells) return TETCAST_OK;
  const TcPieces *pieces = &scene->scaled->pieces;
  TcTolerance half = tc_tolerance_begin(pieces, 0.5 * wanted), flat = half;
  const TcSteepness none = {.radius = volume->radius};
  if (volume->association != TETCAST_POINT || !(half.thin > 0)) return TETCAST_OK;
  if (!tc_tolerance_allow_single(pieces, &none, 0.5 * wanted, &flat)) return TETCAST_OK;
  TetcastStatus status = TETCAST_OK;
  pthread_mutex_lock(&scene->mutex);
  if (scene->steepness_number != volume->field_number) status = tc_steepness(volume, &scene->steepness);
  if (!status) scene->steepness_number = volume->field_number;
  pthread_mutex_unlock(&scene->mutex);
  if (!status && tc_tolerance_allow_single(pieces, &scene->steepness, 0.5 * wanted, &half)) *tolerance = half;
  return status;
}

void tc_scene_destroy(TetcastScene *scene) {
  if (!scene) return;
  forget(scene);
  pthread_mutex_destroy(&scene->mutex);
  tc_transfer_destroy(scene->transfer);
  tc_coefficients_destroy(scene->coefficients);
  tc_release(scene->context, scene);
}

/* One of the two, or neither. */
static void replace(TetcastScene *scene, TetcastTransferFunction *transfer, TcCoefficients *coefficients) {
  forget(scene);
  tc_transfer_destroy(scene->transfer);
  tc_coefficients_destroy(scene->coefficients);
  scene->transfer = transfer;
  scene->coefficients = coefficients;
}

TetcastStatus tc_scene_set_transfer_function(TetcastScene *scene, const TetcastTransferFunction *transfer) {
  TetcastTransferFunction *copy;
  const TetcastStatus status = tc_transfer_copy(scene->context, transfer, &copy);
  if (!status) replace(scene, copy, NULL);
  return status;
}

TetcastStatus tc_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc) {
  TcCoefficients *copy;
  const TetcastStatus status = tc_coefficients_create(scene->volume, desc, &copy);
  if (!status) replace(scene, NULL, copy);
  return status;
}

/* ── a frame ── */

typedef struct Render {
  TcJob job;
  TcKernel *kernel;
  TcWorker *workers;
  int64_t tiles_x;
} Render;

static bool render_tiles(void *data, int64_t begin, int64_t end, int worker) {
  Render *render = data;
  const TcJob *job = &render->job;
  for (int64_t i = begin; i < end; ++i) {
    const int64_t x0 = i % render->tiles_x * TC_TILE, y0 = i / render->tiles_x * TC_TILE;
    const int64_t x1 = x0 + TC_TILE < job->width ? x0 + TC_TILE : job->width, y1 = y0 + TC_TILE < job->height ? y0 + TC_TILE : job->height;
    if (!render->kernel(job, x0, y0, x1, y1, &render->workers[worker])) return false;
  }
  return true;
}

/* A grid of exactly `samples`, as near to square as its divisors allow, not higher than wide. */
static void sample_grid(int samples, int *x, int *y) {
  *y = 1;
  for (int i = 2; i * i <= samples; ++i) {
    if (samples % i == 0) *y = i;
  }
  *x = samples / *y;
}

/* The widest kernel that this processor runs, that is allowed and that can do the job. */
static TcKernel *choose_kernel(const TcJob *job, TetcastIsa most, const char **name) {
  static const struct {
    TetcastIsa isa;
    const char *name;
    TcKernel *kernel;
  } kernels[] = {
#ifdef TC_HAVE_X86
    {TETCAST_ISA_AVX512, "avx512", tc_kernel_avx512},
    {TETCAST_ISA_AVX2, "avx2", tc_kernel_avx2},
#endif
    {TETCAST_ISA_BASELINE, "baseline", tc_kernel_baseline},
  };
  const bool packets = job->shell->volume->traversal == TETCAST_TRAVERSAL_SHELL && !job->pieces->narrow;
  for (size_t i = 0; packets && i < sizeof kernels / sizeof *kernels; ++i) {
    if ((most != TETCAST_ISA_AUTO && kernels[i].isa > most) || !tc_cpu_has(kernels[i].isa)) continue;
    *name = kernels[i].name;
    return kernels[i].kernel;
  }
  *name = "scalar";
  return tc_kernel_exact;
}

/* What only the kernel for coefficients needs. */
static bool create_direct(TetcastContext *context, const Render *render, int threads) {
  for (int i = 0; render->job.coefficients && i < threads; ++i) {
    render->workers[i].direct = tc_direct_create(context, render->job.coefficients);
    if (!render->workers[i].direct) return false;
  }
  return true;
}

/* Renders with all that is needed at hand, and sums up what the workers counted. */
static TetcastStatus run(TetcastContext *context, Render *render, const TcWorker *start, const TetcastProgress *progress,
                         TetcastRenderStats *stats) {
  const int threads = tc_context_threads(context);
  if (!tc_allocate_array(context, (void **)&render->workers, threads, sizeof *render->workers, "workers")) {
    return TETCAST_ERROR_MEMORY;
  }
  for (int i = 0; i < threads; ++i) render->workers[i] = *start;
  render->tiles_x = (render->job.width + TC_TILE - 1) / TC_TILE;
  const int64_t tiles = render->tiles_x * ((render->job.height + TC_TILE - 1) / TC_TILE);
  TetcastStatus status = create_direct(context, render, threads)
                           ? tc_parallel_for(context, tiles, 1, render_tiles, render, progress)
                           : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: groups of a ray");
  for (int i = 0; i < threads; ++i) {
    TcWorker *worker = &render->workers[i];
    stats->segments += worker->segments;
    stats->lost += worker->lost;
    stats->error = fmax(stats->error, worker->error);
    for (int j = 0; j < TC_RAYS; ++j) {
      if (worker->spans[j].out_of_memory) status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: hits of a ray");
      tc_spans_clear(&worker->spans[j]);
    }
    tc_direct_destroy(worker->direct);
  }
  tc_release(context, render->workers);
  return status;
}

TetcastStatus tc_scene_render(TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                              TetcastFrame *frame, TetcastRenderStats *stats) {
  TetcastContext *context = scene->context;
  const bool exact = desc->integrator == TETCAST_INTEGRATOR_EXACT;
  Render render = {.kernel = tc_kernel_sampled};
  TcWorker start = {.sampler = NULL};
  for (int i = 0; i < TC_RAYS; ++i) start.spans[i].context = context;
  TcJob *job = &render.job;
  job->width = frame->width;
  job->height = frame->height;
  job->frame = frame;
  sample_grid(desc->samples, &job->samples_x, &job->samples_y);
  TetcastRenderStats sum = {.rays = frame->width * frame->height * desc->samples, .isa = "scalar", .precision = "double"};
  TcSampler *sampler = NULL;
  const double aspect = (double)frame->width / (double)frame->height;
  TetcastStatus status = tc_view_create(context, camera, scene->volume, aspect, &job->view);
  if (!status && !scene->coefficients) status = prepare(scene);
  if (!status && !exact) status = tc_sampler_create(context, desc->integrator, desc->integrator_n, &sampler);
  if (!status && scene->coefficients) {
    job->shell = &scene->volume->shell;
    job->coefficients = scene->coefficients;
    render.kernel = tc_kernel_direct;
  } else if (!status) {
    job->shell = &scene->shell;
    job->pieces = &scene->scaled->pieces;
    start.sampler = sampler;
    start.tolerance = tc_tolerance_begin(job->pieces, desc->tolerance);
    if (exact) render.kernel = choose_kernel(job, desc->isa, &sum.isa);
#ifdef TC_HAVE_X86
    if (render.kernel == tc_kernel_avx2 || render.kernel == tc_kernel_avx512) {
      status = allow_single(scene, desc->tolerance, sum.rays, &start.tolerance);
      if (start.tolerance.single_most > 0) sum.precision = "single";
    }
#endif
  }
  if (!status) status = run(context, &render, &start, &desc->progress, &sum);
  tc_sampler_destroy(sampler);
  if (!exact || scene->coefficients) sum.error = NAN;
  if (!status && stats) *stats = sum;
  return status;
}
