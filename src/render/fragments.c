/* SPDX-License-Identifier: Apache-2.0 */
/* Renders a scene to fragments. Workers have lists of their own, tile after tile; a pixel's fragments are all in one of
 * them. */
#include "render/fragments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/vec3.h"

enum { GRAIN = 1 << 12, FEW = 16 };

TetcastStatus tc_fragments_create(TetcastContext *context, TetcastFragments **out) {
  TetcastFragments *fragments;
  if (!tc_allocate_array(context, (void **)&fragments, 1, sizeof *fragments, "fragments"))
    return TETCAST_ERROR_MEMORY;
  *fragments = (TetcastFragments){.context = context};
  *out = fragments;
  return TETCAST_OK;
}

void tc_fragments_destroy(TetcastFragments *fragments) {
  if (!fragments)
    return;
  for (int i = 0; i < fragments->list_count; ++i)
    tc_fragment_list_clear(&fragments->lists[i]);
  tc_release(fragments->context, fragments->lists);
  tc_release(fragments->context, fragments->data);
  tc_release(fragments->context, fragments);
}

/* ── the order of fragments ── */

/* Nothing but what fragments are decides, not where they come from. */
static int compare(const void *left, const void *right) {
  const TetcastFragment *a = left, *b = right;
  if (a->begin != b->begin)
    return a->begin < b->begin ? -1 : 1;
  if (a->end != b->end)
    return a->end < b->end ? -1 : 1;
  if (a->optical_depth != b->optical_depth)
    return a->optical_depth < b->optical_depth ? -1 : 1;
  for (int k = 0; k < 3; ++k) {
    if (a->color[k] != b->color[k])
      return a->color[k] < b->color[k] ? -1 : 1;
  }
  return 0;
}

void tc_fragments_sort(TetcastFragment *fragments, int64_t count) {
  if (count > FEW) {
    qsort(fragments, (size_t)count, sizeof *fragments, compare);
    return;
  }
  for (int64_t i = 1; i < count; ++i) {
    if (compare(&fragments[i - 1], &fragments[i]) <= 0)
      continue;
    const TetcastFragment moved = fragments[i];
    int64_t at = i;
    for (; at > 0 && compare(&moved, &fragments[at - 1]) < 0; --at)
      fragments[at] = fragments[at - 1];
    fragments[at] = moved;
  }
}

/* ── rendering ── */

/* Finds where the volume's bounds are in the picture, and two pixels around them, which is far more than rounding. A
 * part of a mesh is most often to be seen in a part of the picture, and rays that miss it take time as well. */
static void find_seen(const TcRender *render, double seen[2][2]) {
  const TetcastVolume *volume = render->job.shell->volume;
  const TcView *view = &render->job.view;
  const double size[2] = {(double)render->job.width, (double)render->job.height};
  double to[3][3], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  tc_cross(view->up, view->forward, to[0]);
  tc_cross(view->forward, view->right, to[1]);
  tc_cross(view->right, view->up, to[2]);
  const double scale = tc_dot(view->forward, to[2]);
  for (int corner = 0; corner < 8; ++corner) {
    double from_eye[3];
    for (int k = 0; k < 3; ++k)
      from_eye[k] = ldexp(volume->info.bounds[2 * k + (corner >> k & 1)], -volume->exponent) - view->eye[k];
    const double depth = view->orthographic ? 1 : tc_dot(from_eye, to[2]) / scale;
    for (int k = 0; k < 2; ++k) {
      const double place = tc_dot(from_eye, to[k]) / scale / depth - view->center[k];
      const double pixel = (k == 0 ? 1 + place : 1 - place) / 2 * size[k];
      low[k] = fmin(low[k], depth > 0 ? pixel : -INFINITY); /* beside the eye or behind it: anywhere */
      high[k] = fmax(high[k], depth > 0 ? pixel : INFINITY);
    }
  }
  for (int k = 0; k < 2; ++k) {
    seen[k][0] = low[k] - 2;
    seen[k][1] = high[k] + 2;
  }
}

bool tc_fragments_tile(const TcRender *render, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorking *working) {
  TcFragmentList *list = &working->worker.fragments;
  const int64_t before = list->count, columns = x1 - x0;
  const int exponent = render->job.shell->volume->exponent;
  /* In two steps, as 2^exponent alone may be too large or too small a number. */
  const double scale[2] = {ldexp(1, exponent / 2), ldexp(1, exponent - exponent / 2)};
  const double(*seen)[2] = (const double(*)[2])render->fragments->seen;
  if ((double)x1 < seen[0][0] || (double)x0 > seen[0][1] || (double)y1 < seen[1][0] || (double)y0 > seen[1][1])
    return true;
  if (!render->kernels->tile(&render->job, x0, y0, x1, y1, &working->worker, working->sums))
    return false;
  for (int64_t i = before; i < list->count; ++i) {
    TetcastFragment *f = &list->data[i];
    const int64_t x = x0 + f->pixel % columns, y = y0 + f->pixel / columns - render->first_row;
    f->pixel = y * render->job.width + x;
    f->begin = f->begin * scale[0] * scale[1];
    f->end = f->end * scale[0] * scale[1];
    ++render->fragments->place[f->pixel - render->fragments->first];
  }
  return !list->out_of_memory;
}

/* Moves the fragments of one worker's list to where they belong. */
static bool move_fragments(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const TcRender *render = data;
  TetcastFragment *to = render->fragments->result->data;
  int64_t *place = render->fragments->place;
  const int64_t first = render->fragments->first;
  for (int64_t i = begin; i < end; ++i) {
    const TcFragmentList *list = &render->workers[i].worker.fragments;
    for (int64_t j = 0; j < list->count; ++j)
      to[place[list->data[j].pixel - first]++] = list->data[j];
  }
  return true;
}

/* By now, a pixel's place is that of the next one's first fragment. */
static bool sort_pixels(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const struct TcFragmentWork *work = data;
  for (int64_t i = begin; i < end; ++i) {
    const int64_t first = i ? work->place[i - 1] : 0;
    tc_fragments_sort(work->result->data + first, work->place[i] - first);
  }
  return true;
}

/* Makes room for the numbers of pixels that may have fragments: those of the rows of all tiles that reach into what is
 * seen. Where a part is small on the screen, going through all of the others would take longer than its rays. */
static bool make_places(const TcRender *render, struct TcFragmentWork *work) {
  const double rows = (double)render->frame->height, *seen = work->seen[1];
  const double from = fmin(fmax(floor(seen[0]) - (double)render->first_row - TC_TILE, 0), rows),
               to = fmax(fmin(ceil(seen[1]) - (double)render->first_row + TC_TILE + 1, rows), from);
  work->first = (int64_t)from * render->frame->width;
  work->pixels = (int64_t)(to - from) * render->frame->width;
  work->place = tc_allocate(render->scene->context, work->pixels + 1, sizeof *work->place); /* never none */
  if (work->place)
    memset(work->place, 0, (size_t)work->pixels * sizeof *work->place);
  return work->place != NULL;
}

bool tc_fragments_lend(TcRender *render, int threads) {
  find_seen(render, render->fragments->seen);
  if (!make_places(render, render->fragments))
    return false;
  const TetcastFragments *result = render->fragments->result;
  for (int i = 0; i < threads && i < result->list_count; ++i) {
    render->workers[i].worker.fragments = result->lists[i];
    result->lists[i] = (TcFragmentList){.context = result->context};
  }
  return true;
}

/* Keeps the workers' memory for the next picture; where there is no place to note it, workers free it. */
static void take_back(TcRender *render, int threads) {
  TetcastFragments *result = render->fragments->result;
  if (threads > result->list_count) {
    TcFragmentList *lists = tc_allocate(result->context, threads, sizeof *lists);
    if (!lists)
      return;
    for (int i = 0; i < result->list_count; ++i)
      tc_fragment_list_clear(&result->lists[i]);
    tc_release(result->context, result->lists);
    result->lists = lists;
    result->list_count = threads;
  }
  for (int i = 0; i < threads; ++i) {
    TcFragmentList *list = &render->workers[i].worker.fragments;
    result->lists[i] = *list;
    result->lists[i].count = 0;
    result->lists[i].out_of_memory = false;
    *list = (TcFragmentList){.context = result->context};
  }
}

static TetcastStatus take_fragments(TcRender *render, int threads) {
  TetcastFragments *result = render->fragments->result;
  TetcastContext *context = result->context;
  const int64_t pixels = render->fragments->pixels;
  int64_t count = 0;
  for (int64_t i = 0; i < pixels; ++i) {
    const int64_t of_pixel = render->fragments->place[i];
    render->fragments->place[i] = count;
    count += of_pixel;
  }
  if (count > result->capacity) {
    tc_release(context, result->data);
    result->data = NULL;
    result->capacity = 0;
    if (!tc_allocate_array(context, (void **)&result->data, count, sizeof *result->data, "fragments"))
      return TETCAST_ERROR_MEMORY;
    result->capacity = count;
  }
  tc_parallel_for(context, threads, 1, move_fragments, render, NULL);
  tc_parallel_for(context, pixels, GRAIN, sort_pixels, render->fragments, NULL);
  result->count = count;
  return TETCAST_OK;
}

TetcastStatus tc_fragments_take(TcRender *render, int threads, TetcastStatus status) {
  for (int i = 0; i < threads; ++i) {
    if (render->workers[i].worker.fragments.out_of_memory)
      status = TETCAST_ERROR_MEMORY;
  }
  if (status == TETCAST_ERROR_MEMORY)
    tc_error(render->scene->context, status, "out of memory: fragments");
  if (!status)
    status = take_fragments(render, threads);
  take_back(render, threads);
  return status;
}

TetcastStatus tc_scene_render_fragments(const TetcastScene *scene, const TetcastCamera *camera,
                                        const TetcastRenderDesc *desc, int64_t width, int64_t height,
                                        TetcastFragments *fragments, TetcastRenderStats *stats) {
  TetcastFrame frame = {
      .context = scene->context, .width = width, .height = height, .type = TETCAST_TYPE_FLOAT64, .groups = 1};
  struct TcFragmentWork work = {.result = fragments};
  fragments->count = 0;
  const TetcastStatus status = tc_render(scene, camera, desc, &frame, &work, stats);
  tc_release(scene->context, work.place);
  return status;
}
