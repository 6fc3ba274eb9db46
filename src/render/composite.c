/* SPDX-License-Identifier: Apache-2.0 */
/* Composites the fragments of all parts. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "render/fragments.h"

enum { GRAIN = 1 << 10 };

/* A list of which some pixels are being composited, and its first fragment that has not been. */
typedef struct Cursor {
  const TetcastFragmentList *list;
  int64_t at;
} Cursor;

typedef struct Merger {
  Cursor *cursors; /* [lists] */
  TcFragmentList pixel;
  double overlap;
} Merger;

typedef struct Composite {
  const TetcastFragmentList *lists;
  int64_t count;
  TetcastFrame *frame;
  Merger *mergers; /* [threads] */
  atomic_llong first_bad;
} Composite;

/* ── checks ── */

/* The first fragment of a list that is not as it must be, or its count. */
static int64_t find_fault(const TetcastFragmentList *list, int64_t pixels) {
  int64_t least = 0;
  for (int64_t i = 0; i < list->count; ++i) {
    const TetcastFragment *f = &list->data[i];
    bool good = f->pixel >= least && f->pixel < pixels && f->begin <= f->end && f->optical_depth >= 0;
    for (int k = 0; k < 3; ++k)
      good = good && !isnan(f->color[k]);
    if (!good)
      return i;
    least = f->pixel;
  }
  return list->count;
}

static bool check_lists(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Composite *c = data;
  for (int64_t i = begin; i < end; ++i) {
    long long first = atomic_load(&c->first_bad);
    if (find_fault(&c->lists[i], c->frame->width * c->frame->height) == c->lists[i].count)
      continue;
    while (i < first && !atomic_compare_exchange_weak(&c->first_bad, &first, i))
      continue;
  }
  return true;
}

static TetcastStatus check(TetcastContext *context, Composite *c) {
  tc_parallel_for(context, c->count, 1, check_lists, c, NULL);
  const int64_t bad = c->first_bad;
  if (bad == c->count)
    return TETCAST_OK;
  const int64_t at = find_fault(&c->lists[bad], c->frame->width * c->frame->height);
  const TetcastFragment *f = &c->lists[bad].data[at];
  return tc_error(context, TETCAST_ERROR_DATA,
                  "fragment %" PRId64 " of list %" PRId64 ": pixel %" PRId64 ", from %g to %g, of optical depth %g", at,
                  bad, f->pixel, f->begin, f->end, f->optical_depth);
}

/* ── pixels ── */

/* Composites a pixel's fragments, which are sorted. Returns the largest overlap. */
static double composite(const TetcastFragmentList *fragments, double rgba[4]) {
  double depth = 0, overlap = 0, reached = -INFINITY;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (int64_t i = 0; i < fragments->count; ++i) {
    const TetcastFragment *f = &fragments->data[i];
    const double transmittance = exp(-depth);
    for (int k = 0; k < 3; ++k)
      rgba[k] += transmittance * f->color[k];
    depth += f->optical_depth;
    if (f->begin < reached)
      overlap = fmax(overlap, fmin(reached, f->end) - f->begin);
    reached = fmax(reached, f->end);
  }
  rgba[3] = -expm1(-depth);
  return overlap;
}

/* The first fragment of a list that is of this pixel or a later one. */
static int64_t find_pixel(const TetcastFragmentList *list, int64_t pixel) {
  int64_t low = 0, high = list->count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (list->data[middle].pixel < pixel)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Collects the fragments of a pixel from all lists. False if memory has run out. */
static bool collect(Merger *merger, int64_t cursors, int64_t pixel) {
  merger->pixel.count = 0;
  for (int64_t i = 0; i < cursors; ++i) {
    Cursor *c = &merger->cursors[i];
    for (; c->at < c->list->count && c->list->data[c->at].pixel == pixel; ++c->at) {
      TetcastFragment *copy = tc_fragment_list_append(&merger->pixel);
      if (!copy)
        return false;
      *copy = c->list->data[c->at];
    }
  }
  tc_fragments_sort(merger->pixel.data, merger->pixel.count);
  return true;
}

static bool composite_pixels(void *data, int64_t begin, int64_t end, int worker) {
  const Composite *c = data;
  Merger *merger = &c->mergers[worker];
  int64_t cursors = 0;
  for (int64_t i = 0; i < c->count; ++i) {
    const Cursor cursor = {&c->lists[i], find_pixel(&c->lists[i], begin)};
    if (cursor.at < cursor.list->count && cursor.list->data[cursor.at].pixel < end)
      merger->cursors[cursors++] = cursor;
  }
  for (int64_t pixel = begin; pixel < end; ++pixel) {
    double rgba[4];
    if (!collect(merger, cursors, pixel))
      return false;
    const TetcastFragmentList fragments = {merger->pixel.data, merger->pixel.count};
    merger->overlap = fmax(merger->overlap, composite(&fragments, rgba));
    tc_frame_put(c->frame, pixel % c->frame->width, pixel / c->frame->width, rgba);
  }
  return true;
}

static TetcastStatus merge(TetcastContext *context, Composite *c, int threads, double *overlap) {
  TetcastStatus status = TETCAST_OK;
  memset(c->mergers, 0, (size_t)threads * sizeof *c->mergers);
  for (int i = 0; !status && i < threads; ++i) {
    c->mergers[i].pixel.context = context;
    if (!tc_allocate_array(context, (void **)&c->mergers[i].cursors, c->count, sizeof(Cursor), "fragments"))
      status = TETCAST_ERROR_MEMORY;
  }
  if (!status && tc_parallel_for(context, c->frame->width * c->frame->height, GRAIN, composite_pixels, c, NULL))
    status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: fragments");
  double largest = 0;
  for (int i = 0; i < threads; ++i) {
    largest = fmax(largest, c->mergers[i].overlap);
    tc_release(context, c->mergers[i].cursors);
    if (c->mergers[i].pixel.context)
      tc_fragment_list_clear(&c->mergers[i].pixel);
  }
  if (overlap && !status)
    *overlap = largest;
  return status;
}

TetcastStatus tc_fragments_composite(TetcastContext *context, const TetcastFragmentList *lists, int64_t count,
                                     TetcastFrame *frame, double *overlap) {
  Composite c = {.lists = lists, .count = count, .frame = frame};
  const int threads = tc_context_threads(context);
  atomic_init(&c.first_bad, count);
  TetcastStatus status = check(context, &c);
  if (status)
    return status;
  if (!tc_allocate_array(context, (void **)&c.mergers, threads, sizeof *c.mergers, "fragments"))
    return TETCAST_ERROR_MEMORY;
  status = merge(context, &c, threads, overlap);
  tc_release(context, c.mergers);
  return status;
}
