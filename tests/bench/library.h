/* SPDX-License-Identifier: Apache-2.0 */
/* A libtetcast that is loaded while the program runs, so that several builds of it can be measured in one process. The
 * program itself must not be linked with one: the loaded ones would call its functions in place of their own. Any
 * failure ends the program. */
#ifndef BENCH_LIBRARY_H
#define BENCH_LIBRARY_H

#include <stdbool.h>

#include <tetcast/tetcast.h>

#include "mesh.h"
#include "rows.h"
#include "scenes.h"

/* What is called of it; all versions that can be compared have these, with structures as they are in this one's
 * headers. */
#define LIBRARY_FUNCTIONS(FUNCTION)                                                                                    \
  FUNCTION(context_desc_default)                                                                                       \
  FUNCTION(context_create)                                                                                             \
  FUNCTION(context_destroy)                                                                                            \
  FUNCTION(mesh_desc_default)                                                                                          \
  FUNCTION(mesh_create)                                                                                                \
  FUNCTION(mesh_destroy)                                                                                               \
  FUNCTION(field_desc_default)                                                                                         \
  FUNCTION(field_create)                                                                                               \
  FUNCTION(field_destroy)                                                                                              \
  FUNCTION(volume_create)                                                                                              \
  FUNCTION(volume_destroy)                                                                                             \
  FUNCTION(transfer_function_desc_default)                                                                             \
  FUNCTION(transfer_function_create)                                                                                   \
  FUNCTION(transfer_function_destroy)                                                                                  \
  FUNCTION(scene_create)                                                                                               \
  FUNCTION(scene_destroy)                                                                                              \
  FUNCTION(scene_set_transfer_function)                                                                                \
  FUNCTION(coefficients_desc_default)                                                                                  \
  FUNCTION(scene_set_coefficients)                                                                                     \
  FUNCTION(scene_render)                                                                                               \
  FUNCTION(render_desc_default)                                                                                        \
  FUNCTION(frame_desc_default)                                                                                         \
  FUNCTION(frame_create)                                                                                               \
  FUNCTION(frame_destroy)                                                                                              \
  FUNCTION(frame_pixels)                                                                                               \
  FUNCTION(frame_channel)

typedef struct Library {
  void *handle;     /* the same for the same file */
  const char *path; /* for messages */
#define LIBRARY_MEMBER(name) __typeof__(&tetcast_##name) name;
  LIBRARY_FUNCTIONS(LIBRARY_MEMBER)
#undef LIBRARY_MEMBER
  /* A field was a volume's once and is a scene's now; NULL: the other way. */
  TetcastStatus (*volume_set_field)(TetcastVolume *, const TetcastField *);
  TetcastStatus (*scene_set_field)(TetcastScene *, const TetcastField *);
} Library;

/* It stays loaded to the end. `path` is referred to. */
void library_open(Library *library, const char *path);

/* A mesh in a library, ready to be drawn by one thread. The mesh's arrays and the library must stay. */
typedef struct Stage {
  const Library *api;
  const BenchMesh *mesh;
  bool quiet; /* no messages of the library */
  TetcastContext *context;
  TetcastMesh *tet;
  TetcastField *field;
  TetcastVolume *volume;
} Stage;

void stage_open(Stage *stage, const Library *library, const BenchMesh *mesh);
void stage_close(Stage *stage);

/* One way of drawing it, and how long its frames took. */
typedef struct Picture {
  Stage *stage;
  int pixels, groups; /* width and height; 0: through a transfer function */
  TetcastScene *scene;
  TetcastFrame *frame;
  TetcastRenderDesc desc;
  TetcastRenderStats stats; /* of the last frame */
  Sample cpu;               /* seconds */
} Picture;

/* Through a transfer function, or by coefficients of so many groups, with the radiance of each as a channel. */
void picture_open_transfer(Picture *picture, Stage *stage, const Transfer *transfer, int pixels);
void picture_open_groups(Picture *picture, Stage *stage, int groups, int pixels);
void picture_close(Picture *picture);

/* Has the kernels of the instruction set drawn with that stats call `isa`. False: the library or the processor doesn't
 * have it. */
bool picture_use(Picture *picture, const char *isa);

/* Draws a frame; the CPU seconds that all threads of the process took. */
double picture_draw(Picture *picture, const TetcastCamera *camera);

/* By how much the last frames of two pictures of the same kind differ at most, in any channel; NaN where just one has a
 * number. */
double picture_difference(const Picture *a, const Picture *b);

/* Median nanoseconds of a frame, per cell that a ray crosses. */
double picture_per_segment(const Picture *picture);

#endif
