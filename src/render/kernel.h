/* SPDX-License-Identifier: Apache-2.0 */
/* Kernels: what renders a tile, or casts any rays. One for each row of kernels.def, number type and instruction set. */
#ifndef TC_RENDER_KERNEL_H
#define TC_RENDER_KERNEL_H

#include <tetcast/blend.h>

#include "gather/fragment_list.h"
#include "optics/second.h"
#include "optics/tolerance.h"
#include "volume/clip.h"
#include "volume/coefficients.h"
#include "walk/features.h"
#include "walk/hits.h"
#include "walk/lights.h"
#include "walk/ray.h"
#include "walk/screen.h"
#include "walk/surfaces.h"
#include "walk/trail.h"

enum {
  TC_TILE = 16,     /* the most pixels along a side of the tile that a kernel renders at once */
  TC_HIT_LISTS = 64 /* how many lists of hits a worker has, for rays that are walking and for those that wait */
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

/* What a frame is made from. It is the same for all workers. */
typedef struct TcJob {
  int kernel;    /* TC_KERNEL_… */
  bool one_lane; /* only kernels of one lane have it */
  const TcShell *shell;
  const TcRows *values;    /* the scalar; NULL with coefficients */
  const TcPieces *pieces;  /* the transfer function, in the volume's units; NULL if only values are gathered */
  const TcSecond *second;  /* a transfer function of two dimensions, with `pieces` as its hull; NULL: it has one */
  const TcScreen *screen;  /* the projected vertices; NULL if rays are walked in ray space */
  const double *points;    /* [vertex_count][4], for ray space, by tc_rows_points(); NULL: the arrays of the volume */
  TcTolerance tolerance;   /* of emission and absorption */
  TcResolution resolution; /* with TC_BOUND: what rounding does to vertices */
  int sums;                /* how many numbers are gathered for a ray */
  const struct TcSampler *sampler;    /* the integrator to compare with; NULL: the exact one */
  const TcCoefficients *coefficients; /* NULL without */
  const TcSurfaces *surfaces;         /* isosurfaces, slices and the boundary; NULL: there are none */
  const TcLights *lights;             /* light in the volume; NULL: there is none */
  TetcastBlend blend;                 /* if not composite, values are gathered, without pieces and coefficients */
  bool to_the_end;                    /* of coefficients: opaque rays go on, as what lies behind is wanted too */
  const struct TcIsaKernels *precise; /* single precision: the kernels with which rays are walked again */
  const struct TcJob *precise_job;    /* single precision: the job with which rays are walked again */
  const TcHalfSpace *clip;            /* [clip_count]: only what lies in all of them is seen */
  int clip_count;
  double interval_error; /* how far off the end of a ray's interval may be at a plane that it meets at right angles */

  /* The following are of pictures only, not of rays that are cast one by one. */
  TcView view;
  int64_t width, height;
  int samples_x, samples_y;  /* a pixel has a grid of so many rays */
  const TetcastArray *stop;  /* [height][width]: where rays end, in the mesh's unit of length; NULL: they don't */
  const TetcastArray *start; /* [height][width]: from where on they count; NULL: from where they begin */
} TcJob;

/* What each worker has for itself. */
typedef struct TcWorker {
  TcHits hits[TC_HIT_LISTS];
  void *state;              /* TcIsaKernels.state_size() bytes, aligned to 64, cleared when the worker begins */
  void *precise_state;      /* single precision: the same for the kernels with which rays are walked again */
  TcFragmentList fragments; /* of the rays so far; their pixels are the destinations of the rays */
  TcTrail *trail;           /* where TC_KERNEL_trace notes the cells that are crossed; NULL: nowhere */
  int64_t segments;         /* the number of cells crossed */
  int64_t lost;             /* the number of rays whose walk found no way out of a cell */
  int64_t again;            /* the number of rays that were walked again */
} TcWorker;

/* A ray of a picture. */
typedef struct TcSample {
  int64_t x, y;  /* its pixel in the picture */
  int64_t pixel; /* the pixel to whose sums it adds what it gathers */
  int sample;    /* which of the pixel's rays it is */
} TcSample;

/* The kernels of one number type and instruction set. */
typedef struct TcIsaKernels {
  const char *name, *precision; /* as in TetcastRenderStats */
  int lanes;

  /* The number of bytes that a worker's state takes. */
  size_t (*state_size)(const TcJob *job);

  /* Projects the volume's vertices [begin, end) to screen->vertices, vertex_size bytes each. */
  size_t vertex_size;
  void (*project)(const TcJob *job, TcScreen *screen, int64_t begin, int64_t end);

  /* Adds what the rays of the pixels [x0, x1) × [y0, y1) gather to sums[pixel][job->sums], pixels row by row. This one
   * and the next two return false if memory has run out. */
  bool (*tile)(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker, double *sums);

  /* Adds what the rays of samples of a picture gather to sums[sample.pixel][job->sums]. */
  bool (*samples)(const TcJob *job, const TcSample *samples, int64_t count, TcWorker *worker, double *sums);

  /* Adds what rays of any kind gather to sums[ray][job->sums]. They are walked in ray space. NULL in single precision.
   */
  bool (*cast)(const TcJob *job, const TcLine *lines, int64_t count, TcWorker *worker, double *sums);
} TcIsaKernels;

extern const TcIsaKernels tc_kernels_one, tc_kernels_avx2, tc_kernels_avx512, tc_kernels_avx2_f32,
    tc_kernels_avx512_f32;

#endif
