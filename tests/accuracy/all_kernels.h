/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels in double precision that this processor runs, and rays and pictures by them without a frame. */
#ifndef ALL_KERNELS_H
#define ALL_KERNELS_H

#include "support.h"

#include "base/cpu.h"
#include "render/render.h"

#include "plain.h"

static const struct {
  TetcastIsa isa;
  const TcIsaKernels *kernels;
} all_kernels[] = {
    {TETCAST_ISA_SCALAR, &tc_kernels_one},
#ifdef TC_HAVE_X86
    {TETCAST_ISA_AVX2, &tc_kernels_avx2},
    {TETCAST_ISA_AVX512, &tc_kernels_avx512},
#endif
};
enum { ALL_KERNELS = sizeof all_kernels / sizeof *all_kernels };

/* Kernels for volumes of which every cell is crossed for itself are those of one lane. */
static inline bool kernel_runs(int kernel, const TetcastVolume *volume) {
  return tc_cpu_has(all_kernels[kernel].isa) && (volume->traversal == TETCAST_TRAVERSAL_SHELL || kernel == 0);
}

/* A row of kernels.def. */
typedef struct KernelRow {
  const char *name, *gatherer;
  unsigned features;
  bool one_lane; /* only the first of all_kernels has it */
} KernelRow;

static const KernelRow kernel_rows[] = {
#define KERNEL(name, gatherer, features)     {#name, #gatherer, (features), false},
#define KERNEL_DOUBLE                        KERNEL
#define KERNEL_ONE(name, gatherer, features) {#name, #gatherer, (features), true},
#include "render/kernels.def"
#undef KERNEL
#undef KERNEL_DOUBLE
#undef KERNEL_ONE
};

/* Whether a row serves as well as the one that the job has. */
static inline bool row_serves(const KernelRow *row, const TcJob *job) {
  const KernelRow *own = &kernel_rows[job->kernel];
  const unsigned needed = own->features;
  return !strcmp(row->gatherer, own->gatherer) && (row->features & needed) == needed &&
         (row->features & TC_ASSOCIATIONS) == (needed & TC_ASSOCIATIONS);
}

/* What a kernel did besides its sums. */
typedef struct Count {
  int64_t segments, lost;
} Count;

static inline Count count_of(TetcastContext *context, TcWorker *worker) {
  const Count count = {worker->segments, worker->lost};
  tc_worker_end(context, worker);
  return count;
}

/* Clears sums and has the kernel add those of any rays. */
static inline Count cast_all(TetcastContext *context, int kernel, const TcJob *job, const TcLine *lines, int64_t count,
                             double *sums) {
  const TcIsaKernels *kernels = all_kernels[kernel].kernels;
  TcWorker worker;
  memset(sums, 0, (size_t)(count * job->sums) * sizeof *sums);
  assert_true(tc_worker_begin(context, kernels, job, &worker));
  assert_true(kernels->cast(job, lines, count, &worker, sums));
  return count_of(context, &worker);
}

/* The same of a picture, tile by tile. */
static inline Count render_all(TetcastContext *context, int kernel, const TcJob *job, double *sums) {
  const TcIsaKernels *kernels = all_kernels[kernel].kernels;
  double *tile = malloc((size_t)(TC_TILE * TC_TILE * job->sums) * sizeof *tile);
  TcWorker worker;
  assert_true(tc_worker_begin(context, kernels, job, &worker));
  for (int64_t y0 = 0; y0 < job->height; y0 += TC_TILE) {
    for (int64_t x0 = 0; x0 < job->width; x0 += TC_TILE) {
      const int64_t x1 = x0 + TC_TILE < job->width ? x0 + TC_TILE : job->width;
      const int64_t y1 = y0 + TC_TILE < job->height ? y0 + TC_TILE : job->height, row = (x1 - x0) * job->sums;
      memset(tile, 0, (size_t)((y1 - y0) * row) * sizeof *tile);
      assert_true(kernels->tile(job, x0, y0, x1, y1, &worker, tile));
      for (int64_t y = y0; y < y1; ++y) {
        memcpy(sums + (y * job->width + x0) * job->sums, tile + (y - y0) * row, (size_t)row * sizeof *sums);
      }
    }
  }
  free(tile);
  return count_of(context, &worker);
}

/* Projects the volume's vertices for the job's view, for kernels in double precision. False: that is not to be done for
 * this view. */
static inline bool project_all(TcJob *job, TcScreen *screen) {
  const TetcastVolume *volume = job->shell->volume;
  if (!tc_screen_setup(volume, &job->view, job->width, job->height, screen))
    return false;
  screen->vertices = malloc(((size_t)volume->vertex_count + 1) * 4 * sizeof(double));
  tc_kernels_one.project(job, screen, 0, volume->vertex_count);
  job->screen = screen;
  return true;
}

/* Bounds on what rounding does to the places that the job's rays see. */
static inline void resolve(TcJob *job) {
  const TetcastVolume *volume = job->shell->volume;
  const double values = job->values ? job->values->largest : 0;
  double away2 = 0;
  for (int k = 0; k < 3; ++k)
    away2 += pow(volume->center[k] - job->view.eye[k], 2);
  job->resolution = job->screen ? tc_screen_resolution(volume, job->screen, false, job->width, job->height, values)
                                : tc_ray_resolution(volume, sqrt(away2), values);
}

#endif
