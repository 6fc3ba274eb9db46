/* SPDX-License-Identifier: Apache-2.0 */
/* Fragments of the rays of a picture, and pictures made of those of all parts. */
#ifndef TC_RENDER_FRAGMENTS_H
#define TC_RENDER_FRAGMENTS_H

#include "render/work.h"

struct TetcastFragments {
  TetcastContext *context;
  TetcastFragment *data; /* [capacity] */
  double *groups;        /* [count][width], of groups_capacity numbers: as in TcFragmentList */
  int64_t width, groups_capacity, count, capacity;
  TcFragmentList *lists; /* [list_count]: memory for the workers of the next picture */
  int list_count;
};

/* The fragments of a picture that is being made. */
struct TcFragmentWork {
  TetcastFragments *result;
  double seen[2][2];     /* the columns, and the rows, of the picture, in which rays may meet the volume: from, to */
  int64_t first, pixels; /* those that may have fragments: so many from there on */
  int64_t *place;        /* [pixels]: how many fragments the pixel has, then where its next one goes */
};

/* A fragment where it lies. */
typedef struct TcFragmentRef {
  double begin; /* its own, by which most are told apart */
  const TetcastFragment *fragment;
  const double *groups; /* [width] */
  int64_t width;
} TcFragmentRef;

/* Fragment i of an array, with rows of `width` numbers; 0: there are none. */
static inline TcFragmentRef tc_fragment_ref(const TetcastFragment *data, const double *groups, int64_t width,
                                            int64_t i) {
  return (TcFragmentRef){data[i].begin, &data[i], width ? groups + i * width : NULL, width};
}

/* Puts a pixel's fragments, refs [count], into the one order in which they are composited. `scratch` [count] is room
 * for doing that. */
void tc_fragments_sort(TcFragmentRef *refs, TcFragmentRef *scratch, int64_t count);

/* Renders a tile: the worker's list grows by its fragments. False if memory has run out. */
bool tc_fragments_tile(const TcRender *render, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorking *working);
/* Before the first tile: finds where the part is to be seen, makes room for what is noted of pixels there, and lends
 * the workers memory of the picture before, if there is any. False if memory has run out. */
bool tc_fragments_lend(TcRender *render, int threads);
/* Once all tiles are rendered, with `status`: puts all workers' fragments together, pixel by pixel, and takes their
 * memory back. */
TetcastStatus tc_fragments_take(TcRender *render, int threads, TetcastStatus status);

TetcastStatus tc_fragments_create(TetcastContext *context, TetcastFragments **fragments);
void tc_fragments_destroy(TetcastFragments *fragments);
TetcastStatus tc_scene_render_fragments(const TetcastScene *scene, const TetcastCamera *camera,
                                        const TetcastRenderDesc *desc, int64_t width, int64_t height,
                                        TetcastFragments *fragments, TetcastRenderStats *stats);
TetcastStatus tc_fragments_composite(TetcastContext *context, const TetcastFragmentList *lists, int64_t count,
                                     TetcastFrame *frame, double *overlap);

#endif
