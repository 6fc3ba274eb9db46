/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_RENDER_RENDER_H
#define TC_RENDER_RENDER_H

#include <pthread.h>

#include <tetcast/scene.h>

#include "base/base.h"
#include "render/channels.h"
#include "render/clip.h"
#include "render/kernel.h"
#include "volume/shell.h"

struct TetcastFrame {
  TetcastContext *context;
  int64_t width, height, row_stride;
  TetcastType type;
  void *pixels;
  void *memory; /* NULL when the pixels are borrowed */
  int groups;
  void *channel[TC_CHANNELS]; /* in the order of tc_channels; NULL: not asked for */
};

static inline int tc_frame_depth(const TetcastFrame *frame, int channel) {
  const TetcastChannelInfo *info = &tc_channels[channel].info;
  return info->of_groups ? frame->groups : info->components;
}

static inline void *tc_frame_channel(const TetcastFrame *frame, TetcastChannel channel) {
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (tc_channels[i].info.channel == channel)
      return frame->channel[i];
  }
  return NULL;
}

/* What is prepared for a scene's field and transfer function by the first frame that needs it, and memory that is kept
 * from frame to frame. */
typedef struct TcPrepared {
  pthread_mutex_t mutex;
  bool ready;
  TetcastTransferFunction *scaled; /* the transfer function in the volume's units */
  TcSecond second;                 /* of a transfer function with rows, `scaled` being their hull */
  TcShell shell;                   /* the shell of what can be seen */
  TetcastIsosurface *isosurfaces;  /* the scene's isosurfaces, as its field is stored; NULL: there are none */
  TcGradients gradients;           /* of the field, once they were needed for light */
  float *open;       /* [vertices][1 + lights]: the shares of light that arrive (light.h); NULL: not needed so far */
  void *vertices[2]; /* for projected vertices in double and in single precision; NULL: none, or in use */
} TcPrepared;

struct TetcastScene {
  TetcastContext *context;
  const TetcastVolume *volume;
  TcRows *values;                    /* NULL: no field yet */
  TetcastTransferFunction *transfer; /* NULL: none set yet, or coefficients; with rows it is their hull */
  TetcastTransferFunction **rows;    /* [row_count]: a transfer function of two dimensions; NULL: it has one */
  double *row_at;                    /* [row_count], ascending: where the rows are, in the second quantity's unit */
  int row_count;
  TcRows *second;               /* the second quantity, of cells; NULL: the gradient's magnitude */
  TcCoefficients *coefficients; /* NULL: none set yet, or a transfer function */
  TetcastBlend blend;
  TetcastIsosurface *isosurfaces; /* [isosurface_count], values ascending, in the field's unit */
  int isosurface_count;
  TetcastSlice slices[TETCAST_MAX_SLICES];
  int slice_count;
  TetcastBoundary boundary; /* opacity 0: it is not seen */
  TcLighting lighting;
  TcHalfSpace *clip; /* [clip_count]; NULL: none */
  int clip_count;
  TcPrepared *prepared;
};

TetcastStatus tc_view_create(TetcastContext *context, const TetcastCamera *camera, const TetcastVolume *volume,
                             double aspect, TcView *view);
TetcastCamera tc_camera_default(const double bounds[6], double aspect);

TetcastStatus tc_frame_create(TetcastContext *context, const TetcastFrameDesc *desc, TetcastFrame **frame);
void tc_frame_destroy(TetcastFrame *frame);
/* Colours pixels by their values in a channel that the frame has. */
void tc_frame_recolor(TetcastFrame *frame, const TcPieces *colors);
void tc_frame_bytes(const TetcastFrame *frame, const double background[4], int channels, unsigned char *bytes,
                    int64_t row_stride);
/* A pixel's red, green, blue and alpha. */
void tc_frame_get(const TetcastFrame *frame, int64_t x, int64_t y, double rgba[4]);
/* Stores a pixel's red, green, blue and alpha. Returns how far rounding to the frame's type has moved any of them. */
double tc_frame_put(TetcastFrame *frame, int64_t x, int64_t y, const double rgba[4]);
/* Stores a pixel and its values of all channels. Returns a bound on its error, rounding to the frame's type included;
 * NaN: not known. */
double tc_frame_store(TetcastFrame *frame, int64_t x, int64_t y, TcGathered *gathered);

TetcastStatus tc_scene_create(TetcastContext *context, const TetcastVolume *volume, TetcastScene **scene);
void tc_scene_destroy(TetcastScene *scene);
TetcastStatus tc_scene_set_field(TetcastScene *scene, const TetcastField *field);
void tc_scene_share_field(TetcastScene *scene, const TetcastScene *other);
TetcastStatus tc_scene_set_transfer_function(TetcastScene *scene, const TetcastTransferFunction *transfer);
TetcastStatus tc_scene_set_transfer_rows(TetcastScene *scene, const TetcastTransferRow *rows, int count,
                                         const TetcastField *second);
/* Makes what kernels are to know of the scene's rows, in the volume's units; the hull is in them already. */
TetcastStatus tc_scene_scale_rows(const TetcastScene *scene, const TcPieces *hull, TcSecond *second);
void tc_scene_clear_rows(TetcastScene *scene);
TetcastStatus tc_scene_set_isosurfaces(TetcastScene *scene, const TetcastIsosurface *isosurfaces, int count);
/* See tetcast_scene_look(). */
int64_t tc_scene_look(const TetcastScene *scene);
/* Whether there are surfaces of any kind. */
bool tc_scene_has_surfaces(const TetcastScene *scene);
TcLighting tc_lighting_of(const TetcastShadingDesc *desc);
/* The scene's isosurfaces as its field is stored. */
TetcastStatus tc_scene_scale_isosurfaces(const TetcastScene *scene, TetcastIsosurface **scaled);
/* What kernels are to know of surfaces, once the scene is prepared. `normals` tells whether these are wanted, light or
 * not. */
TetcastStatus tc_scene_surfaces(const TetcastScene *scene, TetcastIsa isa, bool normals, TcSurfaces *surfaces);
/* Whether light falls on the volume. */
bool tc_scene_is_lit(const TetcastScene *scene);
/* The light in the volume as this camera sees it, for tc_lights_clear(), once the scene is prepared; `width` is that of
 * TcLights. */
TetcastStatus tc_scene_lights(const TetcastScene *scene, TetcastIsa isa, const TcView *view, int width,
                              TcLights *lights);
void tc_lights_clear(TetcastContext *context, TcLights *lights);
/* The gradients of the scene's field, and the shares of light that arrive at vertices (NULL: all of it), both made for
 * the first who asks. */
TetcastStatus tc_scene_gradients(const TetcastScene *scene, const TcGradients **gradients);
TetcastStatus tc_scene_open(const TetcastScene *scene, TetcastIsa isa, const float **open, int *width);
/* What arrives of the light is to be computed anew. */
void tc_scene_forget_open(TetcastScene *scene);
/* What follows from field, transfer function and isosurfaces is to be made anew. */
void tc_scene_forget(TetcastScene *scene);
TetcastStatus tc_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc);
TetcastStatus tc_scene_set_clip(TetcastScene *scene, const TetcastHalfSpace *half_spaces, int count);
/* Prepares the scene for its field and transfer function, unless that has been done. */
TetcastStatus tc_scene_prepare(const TetcastScene *scene);
/* Whether preparing all vertices once, by projecting them or as tc_points_prepare() does, is faster than making of them
 * what rays need wherever one meets them. Projecting one vertex takes about as long as a dozen steps of a ray become
 * faster by it, so it doesn't pay for small pictures of large meshes, nor where little of the mesh is seen. The number
 * of steps is estimated as if the mesh were a cube, of which each ray crosses half as many cells as ∛cell_count. */
bool tc_worth_preparing(const TcShell *shell, int64_t rays);
/* Puts vertices next to their scalars, as rays in ray space read them fastest (TcJob.points), in memory for as many
 * times four doubles or, if that is NULL, in new memory, which the caller frees. NULL: there is none. What rays gather
 * has the same bits without. */
double *tc_points_prepare(const TetcastVolume *volume, const TcRows *values, void *memory);

/* Takes the memory for prepared vertices that the scene keeps (`vertices` NULL), or gives it back. Returns what the
 * scene had before, or NULL. */
void *tc_scene_swap_vertices(const TetcastScene *scene, bool single, void *vertices);

TetcastStatus tc_scene_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *given,
                              TetcastFrame *frame, TetcastRenderStats *stats);

/* A shape over [0, 1], of which the size of the extinctions doesn't count, over [low, high], with the extinction that
 * makes a good first picture of the scene's volume and field; and colour map `name` with one that rises linearly. */
TetcastStatus tc_scene_fit(const TetcastScene *scene, const TetcastTransferFunction *shape, double low, double high,
                           TetcastTransferFunction **transfer);
TetcastStatus tc_opacity_factor(TetcastContext *context, const double *depths, int64_t count, double opacity,
                                bool clear, double *factor);
TetcastStatus tc_scene_preset(const TetcastScene *scene, const char *name, double low, double high,
                              TetcastTransferFunction **transfer);

/* The shape, with extinctions multiplied by one factor; see tetcast_scene_scale_transfer_function(). */
TetcastStatus tc_scene_scale(const TetcastScene *scene, const TetcastTransferFunction *shape, const TcView *view,
                             double opacity, TetcastTransferFunction **transfer);

/* Sets what a kernel needs to know of the scene: the shell, the field, the transfer function, coefficients or blend
 * mode. `bound` tells whether a bound on the error is wanted. */
void tc_job_of_scene(const TetcastScene *scene, bool bound, TcJob *job);
/* The same for rays of which only the opacity is wanted, through a transfer function alone: the scene's, or another one
 * of its extinction times something. */
void tc_job_of_opacity(const TetcastScene *scene, const TcPieces *pieces, TcJob *job);
/* The same for a volume without a scene, of which everything is visible, and a transfer function in its units. */
void tc_job_of(const TetcastVolume *volume, const TcRows *values, const TcPieces *pieces, TcJob *job);
/* The kernels in double precision for the largest instruction set that this processor has and that `most` allows. */
const TcIsaKernels *tc_kernels_for(TetcastIsa most);
/* The same in single precision; NULL if there are none. */
const TcIsaKernels *tc_single_kernels_for(TetcastIsa most);
/* Allocates a worker's memory and clears its counters. False if memory has run out. */
bool tc_worker_begin(TetcastContext *context, const TcIsaKernels *kernels, const TcJob *job, TcWorker *worker);
void tc_worker_end(TetcastContext *context, TcWorker *worker);
/* Whether a list of hits ran out of memory. */
bool tc_worker_failed(const TcWorker *worker);

#endif
