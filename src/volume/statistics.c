/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/statistics.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "volume/gradients.h"

/* The sums are of so many parts of the mesh, always, whatever the number of threads. With a joint histogram they take
 * more memory, and there are fewer. */
enum { PARTS = 64, JOINT_PARTS = 16, TARGETS = 64, SECTIONS = 16 };

/* Coordinates and values in units of powers of two near the largest, so that nothing overflows. */
typedef struct Scaled {
  const TetcastMesh *mesh;
  const TetcastField *field;
  int length, value;                        /* the exponents */
  double length_factor[2], value_factor[2]; /* which in turn scale: a power of two alone could overflow */
} Scaled;

static void set_factors(int exponent, double factor[2]) {
  factor[0] = ldexp(1, -exponent / 2);
  factor[1] = ldexp(1, -exponent - -exponent / 2);
}

static int exponent_of(double a, double b) {
  int exponent = 0;
  frexp(fmax(fabs(a), fabs(b)), &exponent);
  return exponent;
}

static Scaled scaled(const TetcastMesh *mesh, const TetcastField *field, const double range[2]) {
  Scaled s = {.mesh = mesh, .field = field, .value = exponent_of(range[0], range[1])};
  double largest = 0;
  for (int k = 0; k < 6; ++k)
    largest = fmax(largest, fabs(mesh->bounds[k]));
  s.length = exponent_of(largest, 0);
  set_factors(s.length, s.length_factor);
  set_factors(s.value, s.value_factor);
  return s;
}

/* ── one tetrahedron ── */

/* Its values, ascending, its volume and the gradient's magnitude, all scaled. */
typedef struct Tet {
  double s[4], volume, gradient;
} Tet;

static void sort(double s[4]) {
#define ORDER(i, j)                                                                                                    \
  {                                                                                                                    \
    const double a = s[i], b = s[j];                                                                                   \
    s[i] = a < b ? a : b;                                                                                              \
    s[j] = a < b ? b : a;                                                                                              \
  }
  ORDER(0, 1) ORDER(2, 3) ORDER(0, 2) ORDER(1, 3) ORDER(1, 2)
#undef ORDER
}

/* False if a value is not finite; its volume is known all the same. */
static bool load(const Scaled *scaled, int64_t cell, Tet *tet) {
  uint32_t vertex[4];
  double position[4][3], sum[3], six_volumes;
  tc_mesh_cell(scaled->mesh, cell, vertex);
  bool finite = true;
  for (int k = 0; k < 4; ++k) {
    tc_mesh_vertex(scaled->mesh, vertex[k], position[k]);
    for (int j = 0; j < 3; ++j)
      position[k][j] = position[k][j] * scaled->length_factor[0] * scaled->length_factor[1];
    const TetcastAssociation association = scaled->field->association;
    tet->s[k] = tc_field_at(scaled->field, association == TETCAST_POINT  ? vertex[k]
                                           : association == TETCAST_CELL ? cell
                                                                         : 4 * cell + k);
    finite = finite && isfinite(tet->s[k]);
    tet->s[k] = tet->s[k] * scaled->value_factor[0] * scaled->value_factor[1];
  }
  tc_cell_gradient(position, tet->s, sum, &six_volumes);
  tet->volume = six_volumes / 6;
  tet->gradient = six_volumes > 0 ? sqrt(tc_dot(sum, sum)) / six_volumes : 0;
  sort(tet->s);
  return finite;
}

/* With d = s₃ − s₀, the density of values at v is 3 q / d, and the share of the volume below v is its integral. Both
 * are told by sums and products of numbers of one sign, each a quotient of differences and at most 1 (the recursion of
 * Cox and de Boor), so that nothing cancels, overflows or underflows. Between the two middle values q is of degree two,
 * and Simpson's rule is exact for it. */
typedef struct Spline {
  double s[4];
  double r10, r20, r30, r21, r31, r32; /* 1 / (sᵢ − sⱼ); of differences of 0, which are not used, anything finite */
  double below1, q1;                   /* the share below s₁, and q there */
} Spline;

/* A difference of denormals has a reciprocal that overflows; the largest number instead leaves quotients at most 1. */
static double inverse(double difference) {
  const double r = 1 / difference;
  return r < DBL_MAX ? r : DBL_MAX;
}

static double middle_q(const Spline *p, double v) {
  const double *s = p->s;
  return (v - s[0]) * p->r20 * ((s[2] - v) * p->r21) + (s[3] - v) * p->r31 * ((v - s[1]) * p->r21);
}

static Spline spline_of(const double s[4]) {
  Spline p = {.s = {s[0], s[1], s[2], s[3]},
              .r10 = inverse(s[1] - s[0]),
              .r20 = inverse(s[2] - s[0]),
              .r30 = inverse(s[3] - s[0]),
              .r21 = inverse(s[2] - s[1]),
              .r31 = inverse(s[3] - s[1]),
              .r32 = inverse(s[3] - s[2])};
  p.below1 = (s[1] - s[0]) * p.r20 * ((s[1] - s[0]) * p.r30);
  p.q1 = middle_q(&p, s[1]);
  return p;
}

/* q at v and the share of the volume below v, s₀ < v ≤ s₃; at s₃, q is its limit from below. */
static double spline_at(const Spline *p, double v, double *below) {
  const double *s = p->s;
  if (v < s[1] || s[1] == s[3]) {
    const double a = (v - s[0]) * p->r10, q = a * ((v - s[0]) * p->r20);
    *below = v < s[3] ? q * ((v - s[0]) * p->r30) : 1;
    return v < s[3] ? q : 1;
  }
  if (v >= s[2]) {
    const double q = s[2] < s[3] ? (s[3] - v) * p->r31 * ((s[3] - v) * p->r32) : 0;
    *below = 1 - q * ((s[3] - v) * p->r30);
    return q;
  }
  const double q = middle_q(p, v);
  *below = p->below1 + 0.5 * ((v - s[1]) * p->r30) * (p->q1 + 4 * middle_q(p, s[1] + 0.5 * (v - s[1])) + q);
  return q;
}

/* ── sums over a mesh ── */

/* What is summed up, all scaled. */
typedef struct Sums {
  double total, unknown, below, above, steepest;
  double *volume, *area, *gradient, *joint;
} Sums;

typedef struct Count {
  Scaled scaled;
  const double *edges; /* [bins + 1] */
  double per_value;    /* edges per value, where they are evenly spaced; else 0 */
  int bins, gradient_bins;
  double gradient_range[2];
  bool surfaces; /* whether areas are wanted */
  Sums *parts;   /* [part_count] */
  int part_count;
} Count;

/* The first edge above v; where they are evenly spaced, from a guess. */
static int first_above(const Count *c, double v) {
  int low = 0, high = c->bins + 1;
  if (c->per_value > 0) {
    const double place = (v - c->edges[0]) * c->per_value;
    int i = place > 0 ? place < c->bins ? (int)place : c->bins : 0;
    while (i > 0 && c->edges[i - 1] > v)
      --i;
    while (i <= c->bins && c->edges[i] <= v)
      ++i;
    return i;
  }
  while (low < high) {
    const int middle = (low + high) / 2;
    if (c->edges[middle] <= v)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static int gradient_bin(const Count *c, double gradient) {
  const double place = (gradient - c->gradient_range[0]) / (c->gradient_range[1] - c->gradient_range[0]);
  return place > 0 ? (int)fmin(c->gradient_bins - 1, place * c->gradient_bins) : 0;
}

/* Adds a volume to the bin below edge i. */
static void add(const Count *c, Sums *sums, int i, double volume, int row) {
  if (i == 0)
    sums->below += volume;
  else if (i > c->bins)
    sums->above += volume;
  else
    sums->volume[i - 1] += volume;
  if (i > 0 && i <= c->bins && sums->joint)
    sums->joint[row * c->bins + i - 1] += volume;
}

static void add_tet(const Count *c, Sums *sums, const Tet *tet) {
  const double *s = tet->s;
  const int row = c->gradient_bins > 0 ? gradient_bin(c, tet->gradient) : 0;
  int i = first_above(c, s[0]);
  sums->total += tet->volume;
  sums->steepest = tet->gradient > sums->steepest ? tet->gradient : sums->steepest;
  if (s[0] == s[3]) { /* the range's upper end belongs to the last bin */
    add(c, sums, s[0] == c->edges[c->bins] ? c->bins : i, tet->volume, row);
    return;
  }
  const Spline spline = spline_of(s);
  double done = 0;
  /* At its largest value a cell has the isosurface still, at its smallest no more: s ≥ v is above. */
  for (; i <= c->bins && c->edges[i] <= s[3]; ++i) {
    double share;
    const double q = spline_at(&spline, c->edges[i], &share);
    add(c, sums, i, tet->volume * (share - done), row);
    done = share;
    if (c->surfaces) {
      const double area = 3 * tet->volume * q * (tet->gradient * spline.r30);
      sums->area[i] += area;
      sums->gradient[i] += area * tet->gradient;
    }
  }
  add(c, sums, i == c->bins + 1 && s[3] <= c->edges[c->bins] ? c->bins : i, tet->volume * (1 - done), row);
}

static bool count_parts(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Count *c = data;
  const int64_t cells = c->scaled.mesh->tetrahedra.count;
  for (int64_t part = begin; part < end; ++part) {
    const int64_t first = cells / c->part_count * part + (part < cells % c->part_count ? part : cells % c->part_count);
    const int64_t count = cells / c->part_count + (part < cells % c->part_count);
    for (int64_t i = first; i < first + count; ++i) {
      Tet tet;
      if (load(&c->scaled, i, &tet))
        add_tet(c, &c->parts[part], &tet);
      else
        c->parts[part].unknown += tet.volume;
    }
  }
  return true;
}

/* How many numbers a part's sums have. */
static int64_t sums_size(const Count *c) {
  return c->bins + 2 * ((int64_t)c->bins + 1) + (int64_t)c->bins * c->gradient_bins;
}

static void place_sums(const Count *c, double *memory, Sums *sums) {
  sums->volume = memory;
  sums->area = sums->volume + c->bins;
  sums->gradient = sums->area + c->bins + 1;
  sums->joint = c->gradient_bins > 0 ? sums->gradient + c->bins + 1 : NULL;
}

/* Sums up over all of the mesh: the first part becomes the sum of all. `memory` is for tc_release(). */
static TetcastStatus count_all(TetcastContext *context, Count *c, Sums *sums, double **memory) {
  Sums parts[PARTS] = {{0}};
  const int64_t size = sums_size(c);
  c->parts = parts;
  c->part_count = c->gradient_bins > 0 ? JOINT_PARTS : PARTS;
  if (!tc_allocate_array(context, (void **)memory, c->part_count * size, sizeof **memory, "statistics"))
    return TETCAST_ERROR_MEMORY;
  memset(*memory, 0, (size_t)(c->part_count * size) * sizeof **memory);
  for (int i = 0; i < c->part_count; ++i)
    place_sums(c, *memory + i * size, &parts[i]);
  tc_parallel_for(context, c->part_count, 1, count_parts, c, NULL);
  for (int i = 1; i < c->part_count; ++i) {
    parts[0].total += parts[i].total;
    parts[0].unknown += parts[i].unknown;
    parts[0].below += parts[i].below;
    parts[0].above += parts[i].above;
    parts[0].steepest = fmax(parts[0].steepest, parts[i].steepest);
    for (int64_t k = 0; k < size; ++k)
      (*memory)[k] += (*memory)[i * size + k];
  }
  *sums = parts[0];
  c->parts = NULL;
  return TETCAST_OK;
}

/* ── statistics ── */

static double edge_of(const double range[2], int bins, int i) {
  return i == bins ? range[1] : range[0] + i * (range[1] / bins - range[0] / bins);
}

/* The largest gradient of the field, in the field's unit per length. */
static TetcastStatus find_steepest(TetcastContext *context, const Scaled *scaled, double *steepest) {
  const double edges[2] = {0, 0};
  Count c = {.scaled = *scaled, .edges = edges, .bins = 1};
  Sums sums;
  double *memory;
  const TetcastStatus status = count_all(context, &c, &sums, &memory);
  if (status)
    return status;
  tc_release(context, memory);
  *steepest = ldexp(sums.steepest, scaled->value - scaled->length);
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
  const Scaled scale = scaled(mesh, field, s->range);
  const TetcastStatus status = find_steepest(context, &scale, &s->gradient_range[1]);
  if (!(s->gradient_range[1] > 0))
    s->gradient_range[1] = 1;
  return status;
}

static void unscale(double *numbers, int64_t count, int exponent) {
  for (int64_t i = 0; i < count; ++i)
    numbers[i] = ldexp(numbers[i], exponent);
}

static TetcastStatus count_statistics(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                      TetcastStatistics *s, double **memory) {
  const Scaled scale = scaled(mesh, field, s->range);
  Count c = {.scaled = scale,
             .bins = s->bins,
             .gradient_bins = s->gradient_bins,
             .surfaces = field->association != TETCAST_CELL};
  for (int k = 0; k < 2; ++k)
    c.gradient_range[k] = ldexp(s->gradient_range[k], scale.length - scale.value);
  double *edges;
  if (!tc_allocate_array(context, (void **)&edges, s->bins + 1, sizeof *edges, "statistics"))
    return TETCAST_ERROR_MEMORY;
  for (int i = 0; i <= s->bins; ++i)
    edges[i] = ldexp(edge_of(s->range, s->bins, i), -scale.value);
  c.edges = edges;
  c.per_value = s->bins / (edges[s->bins] - edges[0]);
  c.per_value = isfinite(c.per_value) ? c.per_value : 0;
  Sums sums;
  const TetcastStatus status = count_all(context, &c, &sums, memory);
  tc_release(context, edges);
  if (status)
    return status;
  double *scalars[] = {&sums.total, &sums.unknown, &sums.below, &sums.above};
  for (int i = 0; i < 4; ++i)
    unscale(scalars[i], 1, 3 * scale.length);
  unscale(sums.volume, s->bins, 3 * scale.length);
  unscale(sums.area, s->bins + 1, 2 * scale.length);
  unscale(sums.gradient, s->bins + 1, scale.length + scale.value);
  unscale(sums.joint, (int64_t)s->bins * s->gradient_bins, 3 * scale.length);
  s->total = sums.total;
  s->unknown = sums.unknown;
  s->below = sums.below;
  s->above = sums.above;
  s->volume = sums.volume;
  s->area = sums.area;
  s->gradient = sums.gradient;
  s->joint = sums.joint;
  return TETCAST_OK;
}

/* The numbers follow the struct in memory that begins with s->volume. */
TetcastStatus tc_statistics_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                   const TetcastStatisticsDesc *desc, TetcastStatistics **statistics) {
  TetcastStatistics *s;
  double *memory = NULL;
  if (!tc_allocate_array(context, (void **)&s, 1, sizeof *s, "statistics"))
    return TETCAST_ERROR_MEMORY;
  *s = (TetcastStatistics){.range = {desc->range[0], desc->range[1]},
                           .bins = desc->bins,
                           .gradient_range = {desc->gradient_range[0], desc->gradient_range[1]},
                           .gradient_bins = desc->gradient_bins};
  TetcastStatus status = complete(context, mesh, field, s);
  if (!status)
    status = count_statistics(context, mesh, field, s, &memory);
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

/* Narrows the brackets that are wide: divides each into sections, and keeps the one where the volume below passes
 * `target`. Returns how many were. */
static TetcastStatus narrow(TetcastContext *context, const Scaled *scaled, Bracket *bracket, const double *target,
                            int count, int *narrowed) {
  double edges[TARGETS * (SECTIONS + 1)];
  int n = 0;
  *narrowed = 0;
  for (int i = 0; i < count; ++i) {
    const Bracket *b = &bracket[i];
    const double close = fmax(4 * 0x1p-53 * fmax(fabs(b->low), fabs(b->high)), 0x1p-80); /* of a largest value of 1 */
    if (!(b->high - b->low > close) || b->below_low == b->below_high)
      continue;
    ++*narrowed;
    for (int k = 0; k <= SECTIONS; ++k)
      edges[n++] = k == SECTIONS ? b->high : b->low + k * ((b->high - b->low) / SECTIONS);
  }
  if (n == 0)
    return TETCAST_OK;
  qsort(edges, (size_t)n, sizeof *edges, ascending);
  Count c = {.scaled = *scaled, .edges = edges, .bins = n - 1};
  Sums sums;
  double *memory;
  const TetcastStatus status = count_all(context, &c, &sums, &memory);
  if (status)
    return status;
  double sum = sums.below;
  for (int e = 0; e < n; ++e) { /* the volume below each edge */
    for (int i = 0; i < count; ++i) {
      Bracket *b = &bracket[i];
      if (edges[e] > b->low && edges[e] < b->high && sum <= target[i]) {
        b->low = edges[e];
        b->below_low = sum;
      } else if (edges[e] > b->low && edges[e] < b->high && sum > target[i]) {
        b->high = edges[e];
        b->below_high = sum;
      }
    }
    if (e < n - 1)
      sum += sums.volume[e];
  }
  tc_release(context, memory);
  return TETCAST_OK;
}

TetcastStatus tc_statistics_quantiles(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                      const double *shares, int count, double *values) {
  double range[2], target[TARGETS];
  Bracket bracket[TARGETS];
  tc_field_range(field, range, NULL);
  const Scaled scale = scaled(mesh, field, range);
  const double edges[2] = {ldexp(range[0], -scale.value), ldexp(range[1], -scale.value)};
  Count c = {.scaled = scale, .edges = edges, .bins = 1};
  Sums sums;
  double *memory;
  TetcastStatus status = count_all(context, &c, &sums, &memory);
  if (status)
    return status;
  tc_release(context, memory);
  for (int i = 0; i < count; ++i) {
    target[i] = shares[i] * sums.total;
    bracket[i] = (Bracket){edges[0], edges[1], 0, sums.total};
  }
  for (int narrowed = 1; !status && narrowed > 0;)
    status = narrow(context, &scale, bracket, target, count, &narrowed);
  for (int i = 0; !status && i < count; ++i) {
    const Bracket *b = &bracket[i];
    const double part = b->below_high > b->below_low ? (target[i] - b->below_low) / (b->below_high - b->below_low) : 0;
    const double value = shares[i] == 0 ? edges[0] : shares[i] == 1 ? edges[1] : b->low + part * (b->high - b->low);
    values[i] = sums.total > 0 ? ldexp(value, scale.value) : (double)NAN;
  }
  return status;
}
