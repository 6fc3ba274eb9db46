/* SPDX-License-Identifier: Apache-2.0 */
/* Renders a scene to fragments. Workers have lists of their own, tile after tile; a pixel's fragments are all in one of
 * them. */
#include "render/fragments.h"

#include <math.h>
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
  tc_release(fragments->context, fragments->groups);
  tc_release(fragments->context, fragments);
}

/* ── the order of fragments ── */

/* Nothing but what fragments are decides, not where they come from. */
static bool comes_before(const TcFragmentRef *p, const TcFragmentRef *q) {
  if (p->begin != q->begin)
    return p->begin < q->begin;
  const TetcastFragment *a = p->fragment, *b = q->fragment;
  if (a->end != b->end)
    return a->end < b->end;
  if (a->optical_depth != b->optical_depth)
    return a->optical_depth < b->optical_depth;
  for (int k = 0; k < 3; ++k) {
    if (a->color[k] != b->color[k])
      return a->color[k] < b->color[k];
  }
  for (int64_t i = 0; i < p->width; ++i) {
    if (p->groups[i] != q->groups[i])
      return p->groups[i] < q->groups[i];
  }
  return false;
}

static void sort_few(TcFragmentRef *refs, int64_t count) {
  for (int64_t i = 1; i < count; ++i) {
    if (!comes_before(&refs[i], &refs[i - 1]))
      continue;
    const TcFragmentRef moved = refs[i];
    int64_t at = i;
    for (; at > 0 && comes_before(&moved, &refs[at - 1]); --at)
      refs[at] = refs[at - 1];
    refs[at] = moved;
  }
}

/* Merges from [0, middle) and from [middle, count), each in order. */
static void merge_two(const TcFragmentRef *from, int64_t middle, int64_t count, TcFragmentRef *to) {
  int64_t i = 0, j = middle;
  for (int64_t k = 0; k < count; ++k) {
    const bool right = i == middle || (j < count && comes_before(&from[j], &from[i]));
    to[k] = from[right ? j++ : i++];
  }
}

/* By insertion where there are few, else by merging what has been sorted so; qsort() takes 1.4 times as long. */
void tc_fragments_sort(TcFragmentRef *refs, TcFragmentRef *scratch, int64_t count) {
  TcFragmentRef *from = refs, *to = scratch;
  for (int64_t i = 0; i < count; i += FEW)
    sort_few(refs + i, count - i < FEW ? count - i : FEW);
  for (int64_t size = FEW; size < count; size *= 2) {
    for (int64_t i = 0; i < count; i += 2 * size) {
      const int64_t left = count - i, both = left < 2 * size ? left : 2 * size;
      merge_two(from + i, left < size ? left : size, both, to + i);
    }
    TcFragmentRef *const merged = to;
    to = from;
    from = merged;
  }
  if (from != refs)
    memcpy(refs, from, (size_t)count * sizeof *refs);
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
  const TetcastFragments *to = render->fragments->result;
  const int64_t first = render->fragments->first;
  for (int64_t i = begin; i < end; ++i) {
    const TcFragmentList *list = &render->workers[i].worker.fragments;
    for (int64_t j = 0; j < list->count; ++j) {
      const int64_t place = render->fragments->place[list->data[j].pixel - first]++;
      to->data[place] = list->data[j];
      if (to->width)
        memcpy(to->groups + place * to->width, list->groups + j * to->width, (size_t)to->width * sizeof *to->groups);
    }
  }
  return true;
}

static TcFragmentRef refer(const TetcastFragments *fragments, int64_t i) {
  return tc_fragment_ref(fragments->data, fragments->groups, fragments->width, i);
}

static bool is_before(const TetcastFragments *fragments, int64_t a, int64_t b) {
  const TcFragmentRef left = refer(fragments, a), right = refer(fragments, b);
  return comes_before(&left, &right);
}

/* Puts the fragments [first, first + count) of a pixel into order, by a copy of them. False if memory has run out. */
static bool sort_pixel(const TetcastFragments *fragments, int64_t first, int64_t count) {
  TetcastContext *context = fragments->context;
  const int64_t width = fragments->width;
  TetcastFragments copy = {.width = width};
  copy.data = tc_allocate(context, count, sizeof *copy.data);
  copy.groups = tc_allocate(context, count, (size_t)(width + 1) * sizeof *copy.groups);
  TcFragmentRef *refs = tc_allocate(context, 2 * count, sizeof *refs);
  const bool ok = copy.data && copy.groups && refs;
  if (ok) {
    memcpy(copy.data, fragments->data + first, (size_t)count * sizeof *copy.data);
    if (width)
      memcpy(copy.groups, fragments->groups + first * width, (size_t)(count * width) * sizeof *copy.groups);
    for (int64_t i = 0; i < count; ++i)
      refs[i] = refer(&copy, i);
    tc_fragments_sort(refs, refs + count, count);
  }
  for (int64_t i = 0; ok && i < count; ++i) {
    fragments->data[first + i] = *refs[i].fragment;
    for (int64_t k = 0; k < width; ++k)
      fragments->groups[(first + i) * width + k] = refs[i].groups[k];
  }
  tc_release(context, copy.data);
  tc_release(context, copy.groups);
  tc_release(context, refs);
  return ok;
}

/* By now, a pixel's place is that of the next one's first fragment. Rays come to their paths in order, so that
 * fragments are in theirs, unless the mesh overlaps itself. */
static bool sort_pixels(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const struct TcFragmentWork *work = data;
  for (int64_t i = begin; i < end; ++i) {
    const int64_t first = i ? work->place[i - 1] : 0, last = work->place[i];
    int64_t at = first + 1;
    while (at < last && !is_before(work->result, at, at - 1))
      ++at;
    if (at < last && !sort_pixel(work->result, first, last - first))
      return false;
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
  TetcastFragments *result = render->fragments->result;
  const TcCoefficients *coefficients = render->job.coefficients;
  result->width = coefficients ? 2 * (int64_t)coefficients->groups : 0;
  for (int i = 0; i < threads; ++i) {
    TcFragmentList *list = &render->workers[i].worker.fragments;
    if (i < result->list_count && result->lists[i].width == result->width) {
      *list = result->lists[i];
      result->lists[i] = (TcFragmentList){.context = result->context};
    }
    list->width = result->width;
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
    for (int i = 0; i < threads; ++i)
      lists[i] = (TcFragmentList){.context = result->context};
  }
  for (int i = 0; i < threads; ++i) {
    TcFragmentList *list = &render->workers[i].worker.fragments;
    tc_fragment_list_clear(&result->lists[i]); /* which is left where it was made for another number of groups */
    result->lists[i] = *list;
    result->lists[i].count = 0;
    result->lists[i].out_of_memory = false;
    *list = (TcFragmentList){.context = result->context};
  }
}

/* Makes room for so many fragments. */
static TetcastStatus reserve(TetcastFragments *result, int64_t count) {
  TetcastContext *context = result->context;
  if (count > result->capacity) {
    tc_release(context, result->data);
    result->data = NULL;
    result->capacity = 0;
    if (!tc_allocate_array(context, (void **)&result->data, count, sizeof *result->data, "fragments"))
      return TETCAST_ERROR_MEMORY;
    result->capacity = count;
  }
  const int64_t numbers = count * result->width;
  if (numbers > result->groups_capacity) {
    tc_release(context, result->groups);
    result->groups = NULL;
    result->groups_capacity = 0;
    if (!tc_allocate_array(context, (void **)&result->groups, numbers, sizeof *result->groups, "fragments"))
      return TETCAST_ERROR_MEMORY;
    result->groups_capacity = numbers;
  }
  return TETCAST_OK;
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
  const TetcastStatus status = reserve(result, count);
  if (status)
    return status;
  tc_parallel_for(context, threads, 1, move_fragments, render, NULL);
  if (tc_parallel_for(context, pixels, GRAIN, sort_pixels, render->fragments, NULL))
    return tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: fragments");
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
