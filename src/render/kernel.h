/* SPDX-License-Identifier: Apache-2.0 */
/* Kernels: what renders a tile, or casts any rays. One for each row of kernels.def, number type and instruction set. */
#ifndef TC_RENDER_KERNEL_H
#define TC_RENDER_KERNEL_H

#include <tetcast/blend.h>

#include "optics/tolerance.h"
#include "volume/coefficients.h"
#include "walk/clip.h"
#include "walk/features.h"
#include "walk/hits.h"
#include "walk/ray.h"
#include "walk/screen.h"
#include "walk/surfaces.h"

enum {
  TC_TILE = 16,     /* pixels a side, at most, of what a kernel renders at once */
  TC_HIT_LISTS = 64 /* of a worker: of packets that are walking and of those that wait */
};

/* The numbers of kernels.def's rows. */
enum {
#define KERNEL(name, gatherer, features) TC_KERNEL_##name,
#define KERNEL_DOUBLE                    KERNEL
#define KERNEL_ONE                       KERNEL
#include "render/kernels.def"
#undef KERNEL
#undef KERNEL_DOUBLE
#undef KERNEL_ONE
  TC_KERNELS
};

/* What a frame is made from; the same for all workers. */
typedef struct TcJob {
  int kernel;    /* TC_KERNEL_… */
  bool one_lane; /* only kernels of one lane have it */
  const TcShell *shell;
  const TcRows *values;   /* the scalar */
  const TcPieces *pieces; /* in the volume's units */
  const TcScreen *screen; /* NULL: in ray space */
  TcTolerance tolerance;
  TcResolution resolution; /* with TC_BOUND */
  int sums;                /* numbers that are gathered for a ray */
  const struct TcSampler *sampler;
  const TcCoefficients *coefficients;
  const TcSurfaces *surfaces;         /* NULL: none */
  TetcastBlend blend;                 /* other than composite: of values, with neither pieces nor coefficients */
  bool to_the_end;                    /* of coefficients: all is wanted, though all groups be opaque */
  const struct TcIsaKernels *precise; /* single precision: those in which rays are walked again, */
  const struct TcJob *precise_job;    /* and what for */
  const TcHalfSpace *clip;            /* [clip_count]: what lies in all of them is seen */
  int clip_count;
  double interval_error; /* how far off the end of a ray's interval may be at a plane that it meets at right angles */

  /* Of pictures: */
  TcView view;
  int64_t width, height;
  int samples_x, samples_y;
  const TetcastArray *stop; /* [height][width]: where rays end, in the mesh's unit; NULL: they don't */
} TcJob;

/* What a worker keeps to itself. */
typedef struct TcWorker {
  TcHits hits[TC_HIT_LISTS];
  void *state;         /* of the kernel: as many bytes as it says, aligned to 64, cleared when the worker begins */
  void *precise_state; /* single precision: of the kernel in which rays are walked again */
  int64_t segments, lost, again; /* cells crossed; rays lost; rays walked again */
} TcWorker;

/* A ray of a picture, and where what it gathers is added. */
typedef struct TcSample {
  int64_t x, y, pixel;
  int sample;
} TcSample;

/* The kernels of one number type and instruction set. */
typedef struct TcIsaKernels {
  const char *name, *precision;
  int lanes;
  size_t (*state_size)(const TcJob *job);

  /* Projects the volume's vertices [begin, end) to job->screen->vertices, `size` bytes each. */
  size_t vertex_size;
  void (*project)(const TcJob *job, TcScreen *screen, int64_t begin, int64_t end);

  /* Adds what the rays of the pixels [x0, x1) × [y0, y1) gather to sums[pixel][job->sums], pixels row by row. False:
   * out of memory. */
  bool (*tile)(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker, double *sums);

  /* Adds what the rays of samples of a picture gather to sums[sample.pixel][job->sums]. */
  bool (*samples)(const TcJob *job, const TcSample *samples, int64_t count, TcWorker *worker, double *sums);

  /* Adds what any rays gather to sums[ray][job->sums], in ray space. */
  bool (*cast)(const TcJob *job, const TcLine *lines, int64_t count, TcWorker *worker, double *sums);
} TcIsaKernels;

extern const TcIsaKernels tc_kernels_one, tc_kernels_avx2, tc_kernels_avx512, tc_kernels_avx2_f32,
    tc_kernels_avx512_f32;

#endif
