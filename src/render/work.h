/* SPDX-License-Identifier: Apache-2.0 */
/* A picture that is being made: what its parts share. */
#ifndef TC_RENDER_WORK_H
#define TC_RENDER_WORK_H

#include "render/render.h"

/* What each worker has. */
typedef struct TcWorking {
  TcWorker worker;
  double *sums;  /* [TC_TILE²][job.sums]: of the pixels under way */
  double *cells; /* [TC_TILE²]: how many cells their rays cross; NULL: not counted */
  double error;  /* the largest of the pixels' bounds so far */
} TcWorking;

typedef struct TcRender {
  TcJob job, precise, count;
  const TetcastScene *scene;
  TetcastFrame *frame;
  const TcIsaKernels *kernels;
  TcScreen screen;
  double *points; /* vertices prepared for ray space; NULL: they are not */
  TcSurfaces surfaces;
  TcLights lights;
  struct TcFragmentWork *fragments; /* where fragments go, in place of a picture; NULL: it is a picture */
  TcSecond second;                  /* of a transfer function of one dimension, for kernels that expect two */
  TcWorking *workers;               /* [threads] */
  bool bounded;                     /* a bound on the error is gathered as well */
  bool counted;                     /* the cells that rays cross are counted as well */
  bool plain;                       /* the first sums are the frame's pixels as they are, and there are no channels */
  int64_t first_row;                /* of the job's picture, which the frame begins with */
  int64_t tiles_x, tiles_y;
} TcRender;

/* What pixels are made from, but for their sums. */
static inline TcGathered tc_render_gathered(const TcRender *render) {
  const TcJob *job = &render->job;
  TcGathered gathered = {
      .bounded = render->bounded, .coefficients = job->coefficients, .exponent = job->shell->volume->exponent};
  if (job->blend) {
    gathered.colors = &render->scene->transfer->pieces;
    gathered.value_exponent = job->values->exponent + (job->blend == TETCAST_BLEND_ADDITIVE ? gathered.exponent : 0);
  }
  return gathered;
}

/* Surfaces, light in the volume and a transfer function's second dimension, as far as the scene has them, for
 * tc_forget_looks(). Of the kernels, one has white light alone, one surfaces, one the second dimension; what has more
 * than one of these, or light of a colour, takes the kernel that has all. Fragments have one that expects surfaces
 * where the field isn't one of points, or the transfer function has two dimensions. */
TetcastStatus tc_find_looks(const TetcastScene *scene, const TetcastRenderDesc *desc, bool depth, bool normal,
                            TcRender *render);
void tc_forget_looks(TetcastContext *context, TcRender *render);

/* The number made of the bits 0, 2, 4, … of i: the place along one axis of the i-th square of Morton's curve. */
static inline int64_t tc_even_bits(int64_t i) {
  int64_t result = 0;
  for (int bit = 0; i >> 2 * bit; ++bit)
    result |= (i >> 2 * bit & 1) << bit;
  return result;
}

/* Chooses a grid of exactly `samples` points, as near to square as its divisors allow, and not higher than wide. */
static inline void tc_sample_grid(int samples, int *x, int *y) {
  *y = 1;
  for (int i = 2; i * i <= samples; ++i) {
    if (samples % i == 0)
      *y = i;
  }
  *x = samples / *y;
}

/* Renders the scene into the frame, or, if `fragments` isn't NULL, to fragments (fragments.h); of the frame, which has
 * no pixels then, only the size counts. */
TetcastStatus tc_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *given,
                        TetcastFrame *frame, struct TcFragmentWork *fragments, TetcastRenderStats *stats);

/* Renders the frame by fewer rays than it has pixels (adaptive.c), once the workers are there. *rays is how many. */
TetcastStatus tc_adaptive_run(TcRender *render, const TetcastRenderDesc *desc, int64_t *rays);

#endif
