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
  Cursor *cursors;      /* [lists] */
  TcFragmentRef *pixel; /* [2 capacity], of which `count` are there: the pixel's; the rest is for sorting */
  int64_t count, capacity;
  double overlap;
} Merger;

typedef struct Composite {
  TetcastContext *context;
  const TetcastFragmentList *lists;
  int64_t count;
  TetcastFrame *frame; /* with those channels alone that are composited */
  int groups;          /* 0: it is by a transfer function */
  Merger *mergers;     /* [threads] */
  atomic_llong first_bad;
} Composite;

/* ── checks ── */

/* A group's radiance and optical depth. */
static bool is_group(const double of_group[2]) {
  return !isnan(of_group[0]) && of_group[1] >= 0;
}

static bool is_good(const TetcastFragmentList *list, int64_t i, int64_t least, int64_t pixels) {
  const TetcastFragment *f = &list->data[i];
  bool good = f->pixel >= least && f->pixel < pixels && f->begin <= f->end && f->optical_depth >= 0;
  for (int k = 0; k < 3; ++k)
    good = good && !isnan(f->color[k]);
  for (int64_t g = 0; g < list->group_count; ++g)
    good = good && is_group(list->groups + 2 * (i * list->group_count + g));
  return good;
}

/* The first fragment of a list that is not as it must be, or its count. */
static int64_t find_fault(const TetcastFragmentList *list, int64_t pixels) {
  int64_t least = 0;
  for (int64_t i = 0; i < list->count; ++i) {
    if (!is_good(list, i, least, pixels))
      return i;
    least = list->data[i].pixel;
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
  const TetcastFragmentList *list = &c->lists[bad];
  const TetcastFragment *f = &list->data[at];
  for (int64_t g = 0; g < list->group_count; ++g) {
    const double *of_group = list->groups + 2 * (at * list->group_count + g);
    if (!is_group(of_group))
      return tc_error(context, TETCAST_ERROR_DATA,
                      "fragment %" PRId64 " of list %" PRId64 ": group %" PRId64 " has radiance %g, optical depth %g",
                      at, bad, g, of_group[0], of_group[1]);
  }
  return tc_error(context, TETCAST_ERROR_DATA,
                  "fragment %" PRId64 " of list %" PRId64 ": pixel %" PRId64 ", from %g to %g, of optical depth %g", at,
                  bad, f->pixel, f->begin, f->end, f->optical_depth);
}

/* ── pixels ── */

/* The largest overlap of a pixel's fragments, which are sorted. */
static double find_overlap(const TcFragmentRef *refs, int64_t count) {
  double overlap = 0, reached = -INFINITY;
  for (int64_t i = 0; i < count; ++i) {
    const TetcastFragment *f = refs[i].fragment;
    if (f->begin < reached)
      overlap = fmax(overlap, fmin(reached, f->end) - f->begin);
    reached = fmax(reached, f->end);
  }
  return overlap;
}

/* Composites a pixel's fragments to red, green, blue, alpha. */
static void composite(const TcFragmentRef *refs, int64_t count, double rgba[4]) {
  double depth = 0;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (int64_t i = 0; i < count; ++i) {
    const TetcastFragment *f = refs[i].fragment;
    const double transmittance = exp(-depth);
    for (int k = 0; k < 3; ++k)
      rgba[k] += transmittance * f->color[k];
    depth += f->optical_depth;
  }
  rgba[3] = -expm1(-depth);
}

/* Composites them group by group, to the sums that rays of scenes gather (gather/coefficients.h), in the mesh's units.
 * The mean opacity is here that of all groups, which is the same where they share one extinction. */
static void composite_groups(const TcFragmentRef *refs, int64_t count, int groups, double *sums) {
  double length = 0, opacity = 0;
  for (int g = 0; g < groups; ++g) {
    double radiance = 0, depth = 0;
    for (int64_t i = 0; i < count; ++i) {
      const double *of_group = refs[i].groups + 2 * (ptrdiff_t)g, transmittance = exp(-depth);
      if (of_group[0] != 0 && transmittance > 0) /* it may be infinite */
        radiance += transmittance * of_group[0];
      depth += of_group[1];
    }
    sums[3 * g] = radiance;
    sums[3 * g + 1] = depth;
    sums[3 * g + 2] = exp(-depth);
    opacity -= expm1(-depth) / groups;
  }
  for (int64_t i = 0; i < count; ++i)
    length += refs[i].fragment->end - refs[i].fragment->begin;
  sums[3 * groups] = length;
  sums[3 * groups + 1] = opacity;
}

static void put_pixel(const Composite *c, int64_t pixel, const TcFragmentRef *refs, int64_t count) {
  const int64_t x = pixel % c->frame->width, y = pixel / c->frame->width;
  double sums[3 * TETCAST_MAX_GROUPS + 2];
  if (c->groups) {
    const TcCoefficients mesh_units = {.groups = c->groups};
    TcGathered gathered = {.sums = sums, .coefficients = &mesh_units};
    composite_groups(refs, count, c->groups, sums);
    tc_frame_store(c->frame, x, y, &gathered);
  } else {
    composite(refs, count, sums);
    tc_frame_put(c->frame, x, y, sums);
  }
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

/* Makes room for more of a pixel's fragments. False if memory has run out. */
static bool grow(TetcastContext *context, Merger *merger) {
  const int64_t capacity = merger->capacity ? 2 * merger->capacity : 64;
  TcFragmentRef *pixel = tc_allocate(context, 2 * capacity, sizeof *pixel);
  if (!pixel)
    return false;
  if (merger->count)
    memcpy(pixel, merger->pixel, (size_t)merger->count * sizeof *pixel);
  tc_release(context, merger->pixel);
  merger->pixel = pixel;
  merger->capacity = capacity;
  return true;
}

/* Collects the fragments of a pixel from all lists. False if memory has run out. */
static bool collect(TetcastContext *context, Merger *merger, int64_t cursors, int64_t pixel) {
  merger->count = 0;
  for (int64_t i = 0; i < cursors; ++i) {
    Cursor *c = &merger->cursors[i];
    const TetcastFragmentList *list = c->list;
    const int64_t width = 2 * (int64_t)list->group_count;
    for (; c->at < list->count && list->data[c->at].pixel == pixel; ++c->at) {
      if (merger->count == merger->capacity && !grow(context, merger))
        return false;
      merger->pixel[merger->count++] = tc_fragment_ref(list->data, list->groups, width, c->at);
    }
  }
  if (merger->count > 1)
    tc_fragments_sort(merger->pixel, merger->pixel + merger->capacity, merger->count);
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
    if (!collect(c->context, merger, cursors, pixel))
      return false;
    merger->overlap = fmax(merger->overlap, find_overlap(merger->pixel, merger->count));
    put_pixel(c, pixel, merger->pixel, merger->count);
  }
  return true;
}

static TetcastStatus merge(TetcastContext *context, Composite *c, int threads, double *overlap) {
  TetcastStatus status = TETCAST_OK;
  memset(c->mergers, 0, (size_t)threads * sizeof *c->mergers);
  for (int i = 0; !status && i < threads; ++i) {
    if (!tc_allocate_array(context, (void **)&c->mergers[i].cursors, c->count, sizeof(Cursor), "fragments"))
      status = TETCAST_ERROR_MEMORY;
  }
  if (!status && tc_parallel_for(context, c->frame->width * c->frame->height, GRAIN, composite_pixels, c, NULL))
    status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: fragments");
  double largest = 0;
  for (int i = 0; i < threads; ++i) {
    largest = fmax(largest, c->mergers[i].overlap);
    tc_release(context, c->mergers[i].cursors);
    tc_release(context, c->mergers[i].pixel);
  }
  if (overlap && !status)
    *overlap = largest;
  return status;
}

TetcastStatus tc_fragments_composite(TetcastContext *context, const TetcastFragmentList *lists, int64_t count,
                                     TetcastFrame *frame, double *overlap) {
  TetcastFrame some = *frame;
  Composite c = {.context = context, .lists = lists, .count = count, .frame = &some, .groups = frame->groups};
  const int threads = tc_context_threads(context);
  for (int64_t i = 0; i < count; ++i) {
    if (lists[i].count > 0)
      c.groups = lists[i].group_count; /* which all have that have any */
  }
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (!c.groups || !tc_channels[i].info.needs_coefficients)
      some.channel[i] = NULL;
  }
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
