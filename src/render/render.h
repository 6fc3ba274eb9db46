/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_RENDER_RENDER_H
#define TC_RENDER_RENDER_H

#include <pthread.h>

#include <tetcast/scene.h>

#include "base/base.h"
#include "optics/tolerance.h"
#include "traverse/coefficients.h"
#include "traverse/shell.h"
#include "traverse/steepness.h"
#include "traverse/trace.h"

enum { TC_CHANNELS = 5 };

struct TetcastFrame {
  TetcastContext *context;
  int64_t width, height, row_stride;
  TetcastType type;
  void *pixels;
  void *memory; /* NULL when the pixels are borrowed */
  int groups;
  void *channel[TC_CHANNELS]; /* by their bits' numbers; NULL: not asked for */
};

/* How many values a pixel has in a channel. */
static inline int tc_frame_depth(const TetcastFrame *frame, TetcastChannel channel) {
  return channel == TETCAST_CHANNEL_ERROR || channel == TETCAST_CHANNEL_PATH_LENGTH ? 1 : frame->groups;
}

static inline void *tc_frame_channel(const TetcastFrame *frame, TetcastChannel channel) {
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (channel == (TetcastChannel)(1 << i)) return frame->channel[i];
  }
  return NULL;
}

struct TetcastScene {
  TetcastContext *context;
  const TetcastVolume *volume;
  TetcastTransferFunction *transfer; /* NULL: none set yet, or coefficients */
  TcCoefficients *coefficients;      /* NULL: none set yet, or a transfer function */

  /* What follows from the volume's field and the transfer function; made by the first frame that needs it. */
  pthread_mutex_t mutex;
  int64_t field_number;            /* for which the rest holds; 0: for none */
  TetcastTransferFunction *scaled; /* in the volume's units */
  TcShell shell;                   /* of what can be seen */
  int64_t steepness_number;        /* the field for which the steepness holds; 0: none. Found by the first frame that may need it */
  TcSteepness steepness;
};

/* A camera in scaled coordinates: position (u, v) ∈ [−1, 1]² of the picture looks along forward + u right + v up (perspective), or
 * starts at eye + u right + v up (orthographic). */
typedef struct TcView {
  double eye[3], forward[3], right[3], up[3];
  bool orthographic;
} TcView;

TetcastStatus tc_view_create(TetcastContext *context, const TetcastCamera *camera, const TetcastVolume *volume, double aspect,
                             TcView *view);
/* The ray at (u, v). */
void tc_view_line(const TcView *view, double u, double v, TcLine *line);
TetcastCamera tc_camera_default(const double bounds[6], double aspect);

TetcastStatus tc_frame_create(TetcastContext *context, const TetcastFrameDesc *desc, TetcastFrame **frame);
void tc_frame_destroy(TetcastFrame *frame);
/* `error` is a bound on that of rgba. Returns one on that of the pixel, rounding to its type included. */
double tc_frame_store(TetcastFrame *frame, int64_t x, int64_t y, const double rgba[4], double error);
/* A pixel is going to be stored. */
static inline void tc_frame_expect(const TetcastFrame *frame, int64_t x, int64_t y) {
  if (y < frame->height) __builtin_prefetch((const char *)frame->pixels + y * frame->row_stride + x * 4 * (int64_t)tc_type_size(frame->type), 1);
}
/* Stores a pixel's values of a channel, if the frame has it. */
void tc_frame_put(TetcastFrame *frame, TetcastChannel channel, int64_t x, int64_t y, const double *values);

enum {
  TC_TILE = 16,   /* pixels a side, at most, of what a kernel renders at once */
  TC_PACKET = 8,  /* rays, at most */
  TC_PACKETS = 2, /* packets that a worker has under way; in single precision pairs of them */
  TC_RAYS = 3 * TC_PACKETS * TC_PACKET /* with those that wait */
};

/* What a worker keeps to itself. */
typedef struct TcWorker {
  TcSpans spans[TC_RAYS]; /* of the rays of packets; the scalar kernel uses the first */
  const struct TcSampler *sampler; /* NULL: exact */
  TcTolerance tolerance;
  int64_t segments, lost;
  double error; /* largest bound so far */
  struct TcDirect *direct; /* of the kernel for coefficients */
} TcWorker;

/* What a frame is made from; the same for all kernels. */
typedef struct TcJob {
  const TcShell *shell;
  const TcPieces *pieces; /* in the volume's units */
  const TcCoefficients *coefficients; /* instead of pieces */
  TcView view;
  int64_t width, height;
  int samples_x, samples_y;
  TetcastFrame *frame;
} TcJob;

/* The line of sample i of pixel (x, y). */
static inline void tc_job_line(const TcJob *job, int64_t x, int64_t y, int i, TcLine *line) {
  const double columns = (double)(job->width * job->samples_x), rows = (double)(job->height * job->samples_y);
  const double column = (double)(x * job->samples_x + i % job->samples_x) + 0.5;
  const double row = (double)(y * job->samples_y + i / job->samples_x) + 0.5;
  tc_view_line(&job->view, 2 * column / columns - 1, 1 - 2 * row / rows, line);
}

/* A kernel renders the pixels [x0, x1) × [y0, y1). False: out of memory. */
typedef bool TcKernel(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker);

TcKernel tc_kernel_exact, tc_kernel_sampled;
TcKernel tc_kernel_direct; /* coefficients; its workers each need a … */
struct TcDirect *tc_direct_create(TetcastContext *context, const TcCoefficients *coefficients); /* NULL: out of memory */
void tc_direct_destroy(struct TcDirect *direct);
TcKernel tc_kernel_baseline, tc_kernel_avx2, tc_kernel_avx512; /* exact, by packets (packet_tmpl.h); the latter where the target has them */

/* The light of one ray: the slow and simple way, in which a kernel may fall back on and against which it is tested. */
typedef bool TcCast(const TcShell *shell, const TcPieces *pieces, const TcLine *line, TcWorker *worker, TcLight *light);
TcCast tc_cast, tc_cast_sampled;

/* The same for `count` lines, any lines, by packets. */
typedef bool TcPacketCast(const TcShell *shell, const TcPieces *pieces, const TcLine *line, int count, TcWorker *worker,
                          TcLight *light);
TcPacketCast tc_packet_baseline, tc_packet_avx2, tc_packet_avx512;

TetcastStatus tc_scene_create(TetcastContext *context, const TetcastVolume *volume, TetcastScene **scene);
void tc_scene_destroy(TetcastScene *scene);
TetcastStatus tc_scene_set_transfer_function(TetcastScene *scene, const TetcastTransferFunction *transfer);
TetcastStatus tc_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc);
TetcastStatus tc_scene_render(TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                              TetcastFrame *frame, TetcastRenderStats *stats);

/* The extinction [1/length] with which a preset over [low, high] makes a good first picture of the volume. */
TetcastStatus tc_preset_extinction(TetcastContext *context, const TetcastVolume *volume, double low, double high,
                                   double *extinction);

#endif
