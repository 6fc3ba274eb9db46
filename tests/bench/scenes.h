/* SPDX-License-Identifier: Apache-2.0 */
/* What is looked at, from where, through which transfer function. */
#ifndef BENCH_SCENES_H
#define BENCH_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/camera.h>
#include <tetcast/transfer_function.h>

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How much is measured on a mesh, beyond preparation, memory and frames. */
enum {
  SCENE_SIZES = 1,    /* pictures of several sizes */
  SCENE_VISIBLE = 2,  /* few of the cells visible; change of the transfer function */
  SCENE_FEATURES = 4, /* what each feature costs */
  SCENE_FILE = 8,     /* reading a file, and the command from start to end */
  SCENE_CELLS = 16    /* cutting hexahedra */
};

/* Which runs have it; a bit each. */
enum { RUN_SMALL = 1, RUN_NORMAL = 2, RUN_LARGE = 4 };

typedef struct SceneDesc {
  const char *name;
  int n;            /* small cubes along an edge; 0: a body by TetGen */
  const char *body; /* "shell" or "torus" */
  int64_t cells;    /* of a body: asked of tetcast_bench_body, which makes some more or less */
  TetcastType type;
  unsigned work;
  unsigned runs;
  int rounds; /* every renderer is measured once a round, one after the other */
} SceneDesc;

/* Scene i = 0, 1, …, NULL beyond the last. */
const SceneDesc *scene_get(int i);

/* Has tetcast_bench_body, which is `program`, write the body's mesh to a file: TetGen needs much more memory than the
 * mesh that it makes, so that happens in another process. */
bool scene_make_body(const SceneDesc *scene, const char *program, const char *path);

/* The scene's mesh, a body's from the file that was written. */
bool scene_load(BenchMesh *mesh, const SceneDesc *scene, const char *path);

/* A slanted view of the unit cube, which fills much of a square picture. Orthographic: in perspective VTK takes a
 * segment's length along a slightly different ray. */
TetcastCamera scene_camera(TetcastProjection projection);

enum { TRANSFER_KNOTS = 8 };

/* A transfer function with its memory, so that it may be changed before use. */
typedef struct Transfer {
  const char *name;
  int color_count, opacity_count;
  double color[TRANSFER_KNOTS][4], opacity[TRANSFER_KNOTS][2]; /* κ = opacity / unit_distance, as VTK has it */
  double unit_distance;
} Transfer;

extern const Transfer transfer_soft;   /* everything visible, half-transparent */
extern const Transfer transfer_softer; /* the same, thinner */
extern const Transfer transfer_sharp;  /* two thin opaque peaks, nothing between */
extern const Transfer transfer_linear; /* one piece, one colour */
extern const Transfer transfer_blend;  /* one piece, along which the colour changes */

/* Where isosurfaces are, of so many: at equal distances over the range of the scalar. */
static inline double isosurface_value(int i, int count) {
  return (i + 1.0) / (count + 1);
}

/* A transfer function that shows the cells with a value above `threshold`, and one that shows all with the same knots.
 */
Transfer transfer_above(double threshold);

/* A value that just the `fraction` of the cells with the highest corners reach above. NaN without memory. */
double scene_threshold(const BenchMesh *mesh, double fraction);

/* Describes `transfer`, which is referred to, in a description that has its defaults. */
void transfer_fill(TetcastTransferFunctionDesc *desc, const Transfer *transfer);

#ifdef __cplusplus
}
#endif

#endif
