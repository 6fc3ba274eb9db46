/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "base/parallel.h"
#include "volume/tally.h"

/* The sums are of so many parts of the mesh, always, whatever the number of threads. With a joint histogram they take
 * more memory, and there are fewer. */
enum { PARTS = 64, JOINT_PARTS = 16 };

/* Quantiles: how many at a time, into how many bins the range is divided at first and each of their brackets later, and
 * at how many distances from where a quantile may be expected, and from 0, its bracket is divided as well. */
enum {
  TARGETS = 64,
  FIRST_BINS = 256,
  SECTIONS = 16,
  DISTANCES = 10,
  DECLINES = 5,
  EDGES = SECTIONS + 1 + 2 * DISTANCES + 2 * DECLINES
};

/* Where the largest value is 1, quantiles as small as this are 0. */
static const double nothing = 0x1p-960;

/* ── units ── */

/* Coordinates and values in units of powers of two near the largest, so that nothing overflows: the exponents. */
typedef struct Units {
  int length, value;
} Units;

static void set_factors(int exponent, double factor[2]) {
  factor[0] = ldexp(1, -exponent / 2);
  factor[1] = ldexp(1, -exponent - -exponent / 2);
}

static int exponent_of(double a, double b) {
  int exponent = 0;
  frexp(fmax(fabs(a), fabs(b)), &exponent);
  return exponent;
}

static Units begin_tally(const TetcastMesh *mesh, const TetcastField *field, const double range[2], TcTally *tally) {
  double largest = 0;
  for (int k = 0; k < 6; ++k)
    largest = fmax(largest, fabs(mesh->bounds[k]));
  const Units units = {exponent_of(largest, 0), exponent_of(range[0], range[1])};
  *tally = (TcTally){.mesh = mesh, .field = field};
  set_factors(units.length, tally->length_factor);
  set_factors(units.value, tally->value_factor);
  return units;
}

/* ── sums over a mesh ── */

typedef struct Count {
  const TcTally *tally;
  TcTallyCells *cells;
  TcTallySums *parts; /* [part_count] */
  int part_count;
} Count;

static TcTallyCells *fastest(void) {
#ifdef TC_HAVE_X86
  if (tc_cpu_has(TETCAST_ISA_AVX512))
    return tc_tally_avx512;
  if (tc_cpu_has(TETCAST_ISA_AVX2))
    return tc_tally_avx2;
#endif
  return tc_tally_one;
}

static bool count_parts(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Count *c = data;
  const int64_t cells = c->tally->mesh->tetrahedra.count;
  for (int64_t part = begin; part < end; ++part) {
    const int64_t first = cells / c->part_count * part + (part < cells % c->part_count ? part : cells % c->part_count);
    const int64_t count = cells / c->part_count + (part < cells % c->part_count);
    c->cells(c->tally, first, first + count, &c->parts[part]);
  }
  return true;
}

/* How many numbers a part's sums have. */
static int64_t sums_size(const TcTally *tally) {
  return (int64_t)tc_tally_width(tally) * (1 + (tally->surfaces ? 2 : 0) + tally->rows);
}

static void place_sums(const TcTally *tally, double *memory, TcTallySums *sums) {
  const int64_t width = tc_tally_width(tally);
  double *next = memory + width;
  sums->volume = memory;
  if (tally->surfaces) {
    sums->area = next;
    sums->gradient = next + width;
    next += 2 * width;
  }
  sums->joint = tally->rows > 0 ? next : NULL;
}

/* Sums up over all of the mesh: the first part becomes the sum of all. `memory` is for tc_release(). */
static TetcastStatus count_all(TetcastContext *context, const TcTally *tally, TcTallySums *sums, double **memory) {
  TcTallySums parts[PARTS] = {{0}};
  const int64_t size = sums_size(tally);
  Count c = {tally, fastest(), parts, tally->rows > 0 ? JOINT_PARTS : PARTS};
  if (!tc_allocate_array(context, (void **)memory, c.part_count * size, sizeof **memory, "statistics"))
    return TETCAST_ERROR_MEMORY;
  memset(*memory, 0, (size_t)(c.part_count * size) * sizeof **memory);
  for (int i = 0; i < c.part_count; ++i)
    place_sums(tally, *memory + i * size, &parts[i]);
  tc_parallel_for(context, c.part_count, 1, count_parts, &c, NULL);
  for (int i = 1; i < c.part_count; ++i) {
    parts[0].total += parts[i].total;
    parts[0].unknown += parts[i].unknown;
    parts[0].steepest = fmax(parts[0].steepest, parts[i].steepest);
    for (int64_t k = 0; k < size; ++k)
      (*memory)[k] += (*memory)[i * size + k];
  }
  *sums = parts[0];
  return TETCAST_OK;
}

/* ── edges ── */

/* Memory for the edges of so many bins, to be filled in; the spare ones are. */
static bool allocate_edges(TetcastContext *context, int bins, double **edges) {
  if (!tc_allocate_array(context, (void **)edges, (int64_t)bins + 1 + TC_TALLY_SPARE, sizeof **edges, "statistics"))
    return false;
  for (int i = bins + 1; i <= bins + TC_TALLY_SPARE; ++i)
    (*edges)[i] = (double)INFINITY;
  return true;
}

/* Sums up between these edges, with a table of places in which to look for them: if they are evenly spaced, one edge is
 * in the middle of each place. */
static TetcastStatus count_between(TetcastContext *context, TcTally *tally, const double *edges, int bins,
                                   TcTallySums *sums, double **memory) {
  const double width = edges[bins] - edges[0];
  int *places;
  tally->edges = edges;
  tally->bins = bins;
  tally->place_count = bins + 1;
  tally->per_value = width > 0 && isfinite(bins / width) ? bins / width : 0;
  if (!tc_allocate_array(context, (void **)&places, (int64_t)tally->place_count + 1, sizeof *places, "statistics"))
    return TETCAST_ERROR_MEMORY;
  for (int place = 0, i = 0; place <= tally->place_count; ++place) {
    while (i <= bins && (int)tc_tally_place(tally, edges[i]) < place)
      ++i;
    places[place] = i;
  }
  tally->places = places;
  const TetcastStatus status = count_all(context, tally, sums, memory);
  tc_release(context, places);
  return status;
}

/* ── statistics ── */

static double edge_of(const double range[2], int bins, int i) {
  return i == bins ? range[1] : range[0] + i * (range[1] / bins - range[0] / bins);
}

/* The largest gradient of the field, in the field's unit per length. */
static TetcastStatus find_steepest(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                   const double range[2], double *steepest) {
  TcTally tally;
  TcTallySums sums;
  double *memory, *edges;
  const Units units = begin_tally(mesh, field, range, &tally);
  tally.steepest = true;
  if (!allocate_edges(context, 1, &edges))
    return TETCAST_ERROR_MEMORY;
  edges[0] = edges[1] = 0;
  const TetcastStatus status = count_between(context, &tally, edges, 1, &sums, &memory);
  tc_release(context, edges);
  if (status)
    return status;
  tc_release(context, memory);
  *steepest = ldexp(sums.steepest, units.value - units.length);
  return TETCAST_OK;
}

static TetcastStatus complete(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                              TetcastStatistics *s) {
  if (s->range[0] == 0 && s->range[1] == 0)
    tc_field_range(field, s->range, NULL);
  if (s->range[0] == s->range[1]) /* a constant field is in the first bin */
    s->range[1] = s->range[0] < 0                                ? s->range[0] / 2
                  : s->range[0] > 0 && isfinite(2 * s->range[0]) ? 2 * s->range[0]
                                                                 : 1;
  if (s->gradient_bins == 0 || s->gradient_range[0] != 0 || s->gradient_range[1] != 0)
    return TETCAST_OK;
  const TetcastStatus status = find_steepest(context, mesh, field, s->range, &s->gradient_range[1]);
  if (!(s->gradient_range[1] > 0))
    s->gradient_range[1] = 1;
  return status;
}

static void unscale(const double *from, double *to, int64_t count, int exponent) {
  for (int64_t i = 0; i < count; ++i)
    to[i] = ldexp(from[i], exponent);
}

/* The sums in the mesh's and the field's units; all arrays in one piece of memory that begins with s->volume. */
static bool set_results(TetcastContext *context, const TcTally *tally, const TcTallySums *sums, Units units,
                        TetcastStatistics *s) {
  const int64_t bins = s->bins, size = bins + 2 * (bins + 1) + bins * s->gradient_bins;
  if (!tc_allocate_array(context, (void **)&s->volume, size, sizeof *s->volume, "statistics"))
    return false;
  memset(s->volume, 0, (size_t)size * sizeof *s->volume);
  s->area = s->volume + bins;
  s->gradient = s->area + bins + 1;
  s->joint = s->gradient_bins > 0 ? s->gradient + bins + 1 : NULL;
  const int volume = 3 * units.length;
  unscale(&sums->total, &s->total, 1, volume);
  unscale(&sums->unknown, &s->unknown, 1, volume);
  unscale(&sums->volume[0], &s->below, 1, volume);
  unscale(&sums->volume[bins + 1], &s->above, 1, volume);
  unscale(&sums->volume[1], s->volume, bins, volume);
  for (int row = 0; row < s->gradient_bins; ++row)
    unscale(&sums->joint[(int64_t)row * tc_tally_width(tally) + 1], s->joint + row * bins, bins, volume);
  if (tally->surfaces) {
    unscale(sums->area, s->area, bins + 1, 2 * units.length);
    unscale(sums->gradient, s->gradient, bins + 1, units.length + units.value);
  }
  return true;
}

static TetcastStatus count_statistics(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                      TetcastStatistics *s) {
  TcTally tally;
  TcTallySums sums;
  double *edges, *memory = NULL;
  const Units units = begin_tally(mesh, field, s->range, &tally);
  tally.rows = s->gradient_bins;
  tally.surfaces = field->association != TETCAST_CELL;
  const double least = ldexp(s->gradient_range[0], units.length - units.value),
               most = ldexp(s->gradient_range[1], units.length - units.value);
  tally.least_gradient = least;
  tally.rows_per_gradient = s->gradient_bins / (most - least);
  if (!allocate_edges(context, s->bins, &edges))
    return TETCAST_ERROR_MEMORY;
  for (int i = 0; i <= s->bins; ++i)
    edges[i] = ldexp(edge_of(s->range, s->bins, i), -units.value);
  TetcastStatus status = count_between(context, &tally, edges, s->bins, &sums, &memory);
  if (!status && !set_results(context, &tally, &sums, units, s))
    status = TETCAST_ERROR_MEMORY;
  tc_release(context, memory);
  tc_release(context, edges);
  return status;
}

TetcastStatus tc_statistics_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                   const TetcastStatisticsDesc *desc, TetcastStatistics **statistics) {
  TetcastStatistics *s;
  if (!tc_allocate_array(context, (void **)&s, 1, sizeof *s, "statistics"))
    return TETCAST_ERROR_MEMORY;
  *s = (TetcastStatistics){.range = {desc->range[0], desc->range[1]},
                           .bins = desc->bins,
                           .gradient_range = {desc->gradient_range[0], desc->gradient_range[1]},
                           .gradient_bins = desc->gradient_bins};
  TetcastStatus status = complete(context, mesh, field, s);
  if (!status)
    status = count_statistics(context, mesh, field, s);
  if (status)
    tc_release(context, s);
  else
    *statistics = s;
  return status;
}

void tc_statistics_destroy(TetcastContext *context, TetcastStatistics *s) {
  if (s)
    tc_release(context, s->volume);
  tc_release(context, s);
}

/* ── quantiles ── */

/* Between which values a quantile lies, and the volumes below these. */
typedef struct Bracket {
  double low, high, below_low, below_high;
} Bracket;

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Where the volume below is the target, if values are evenly distributed in the bracket. */
static double expected(const Bracket *b, double target) {
  const double part = b->below_high > b->below_low ? (target - b->below_low) / (b->below_high - b->below_low) : 0;
  return b->low + part * (b->high - b->low);
}

/* Edges that divide a bracket: evenly, so that it gets smaller whatever the distribution is; closer and closer to where
 * the quantile may be expected, so that it soon is tiny if the distribution is smooth; and closer and closer to 0, so
 * that one value of another magnitude, such as a mark of places without values, doesn't hide all others. Returns how
 * many. */
static int divide(const Bracket *b, double target, double *edges) {
  static const double declines[DECLINES] = {0x1p-16, 0x1p-48, 0x1p-120, 0x1p-400, 0x1p-960};
  const double width = b->high - b->low, middle = expected(b, target);
  int n = 0;
  for (int k = 0; k <= SECTIONS; ++k)
    edges[n++] = k == SECTIONS ? b->high : b->low + k * (width / SECTIONS);
  double distance = width / SECTIONS;
  for (int k = 0; k < DISTANCES; ++k, distance /= 16) {
    edges[n++] = fmax(b->low, middle - distance);
    edges[n++] = fmin(b->high, middle + distance);
  }
  for (int k = 0; b->low <= 0 && b->high >= 0 && k < DECLINES; ++k) {
    edges[n++] = fmax(b->low, -declines[k]);
    edges[n++] = fmin(b->high, declines[k]);
  }
  return n;
}

static bool is_wide(const Bracket *b) {
  const double close = fmax(4 * 0x1p-53 * fmax(fabs(b->low), fabs(b->high)), 2 * nothing);
  return b->high - b->low > close && b->below_low < b->below_high;
}

/* Narrows the brackets: keeps what lies between those edges where the volume below passes the target. */
static void narrow(const double *edges, int bins, const TcTallySums *sums, const double *target, int count,
                   Bracket *bracket) {
  double below = 0;
  for (int e = 0; e <= bins; ++e) {
    below += sums->volume[e];
    for (int i = 0; i < count; ++i) {
      Bracket *b = &bracket[i];
      if (edges[e] <= b->low || edges[e] >= b->high)
        continue;
      if (below <= target[i]) {
        b->low = edges[e];
        b->below_low = below;
      } else {
        b->high = edges[e];
        b->below_high = below;
      }
    }
  }
}

/* Sums up between edges that divide the brackets which are wide, and narrows these. *wide: whether there were any. */
static TetcastStatus narrow_wide(TetcastContext *context, TcTally *tally, const double *target, int count,
                                 Bracket *bracket, double *edges, bool *wide) {
  int n = 0;
  for (int i = 0; i < count; ++i)
    n += is_wide(&bracket[i]) ? divide(&bracket[i], target[i], edges + n) : 0;
  *wide = n > 0;
  if (n == 0)
    return TETCAST_OK;
  qsort(edges, (size_t)n, sizeof *edges, ascending);
  for (int i = 0; i < TC_TALLY_SPARE; ++i)
    edges[n + i] = (double)INFINITY;
  TcTallySums sums;
  double *memory;
  const TetcastStatus status = count_between(context, tally, edges, n - 1, &sums, &memory);
  if (status)
    return status;
  narrow(edges, n - 1, &sums, target, count, bracket);
  tc_release(context, memory);
  return TETCAST_OK;
}

static TetcastStatus find_brackets(TetcastContext *context, TcTally *tally, const double range[2], const double *shares,
                                   int count, Bracket *bracket, double *target, double *edges) {
  TcTallySums sums;
  double *memory;
  for (int i = 0; i <= FIRST_BINS + TC_TALLY_SPARE; ++i)
    edges[i] = i > FIRST_BINS ? (double)INFINITY : edge_of(range, FIRST_BINS, i);
  TetcastStatus status = count_between(context, tally, edges, FIRST_BINS, &sums, &memory);
  if (status)
    return status;
  for (int i = 0; i < count; ++i) {
    target[i] = shares[i] * sums.total;
    bracket[i] = (Bracket){range[0], range[1], 0, sums.total};
    if (shares[i] == 0 || shares[i] == 1 || !(sums.total > 0)) { /* known already */
      const double value = !(sums.total > 0) ? (double)NAN : range[shares[i] == 1];
      bracket[i] = (Bracket){value, value, target[i], target[i]};
    }
  }
  narrow(edges, FIRST_BINS, &sums, target, count, bracket);
  tc_release(context, memory);
  for (bool wide = true; !status && wide;)
    status = narrow_wide(context, tally, target, count, bracket, edges, &wide);
  return status;
}

TetcastStatus tc_statistics_quantiles(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                      const double *shares, int count, double *values) {
  double range[2], target[TARGETS], *edges;
  Bracket bracket[TARGETS];
  TcTally tally;
  tc_field_range(field, range, NULL);
  const Units units = begin_tally(mesh, field, range, &tally);
  for (int k = 0; k < 2; ++k)
    range[k] = ldexp(range[k], -units.value);
  if (!allocate_edges(context, count * EDGES + FIRST_BINS, &edges))
    return TETCAST_ERROR_MEMORY;
  const TetcastStatus status = find_brackets(context, &tally, range, shares, count, bracket, target, edges);
  tc_release(context, edges);
  for (int i = 0; !status && i < count; ++i) {
    const double value = expected(&bracket[i], target[i]);
    values[i] = fabs(value) <= nothing ? 0 : ldexp(value, units.value);
  }
  return status;
}
