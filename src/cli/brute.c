/* SPDX-License-Identifier: Apache-2.0 */
#include "brute.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "quadrature.h"

/* ── where rays cross cells ── */

typedef struct Cell {
  int64_t vertices[4];
  long double corner[4][3]; /* seen from the ray's origin */
  long double value[4];
} Cell;

static long double dot(const long double a[3], const long double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Corner i's barycentric coordinate along the ray, at[0] + at[1] t: the distance from the other three corners' plane.
 */
static bool coordinate(const Cell *cell, int i, const long double direction[3], long double at[2]) {
  const long double *foot = cell->corner[(i + 1) % 4], *b = cell->corner[(i + 2) % 4], *c = cell->corner[(i + 3) % 4];
  long double normal[3], height[3];
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    normal[k] = (b[l] - foot[l]) * (c[m] - foot[m]) - (b[m] - foot[m]) * (c[l] - foot[l]);
    height[k] = cell->corner[i][k] - foot[k];
  }
  const long double volume = dot(normal, height);
  at[0] = -dot(normal, foot) / volume;
  at[1] = dot(normal, direction) / volume;
  return volume != 0;
}

/* What of a ray lies in all of these half-spaces; nothing: the first number is not below the second. */
static void interval_of(const TetcastHalfSpace *half_spaces, int count, const long double origin[3],
                        const long double direction[3], long double interval[2]) {
  interval[0] = 0;
  interval[1] = INFINITY;
  for (int i = 0; i < count; i++) {
    long double normal[3];
    for (int k = 0; k < 3; k++)
      normal[k] = half_spaces[i].normal[k];
    const long double inside = dot(normal, origin) - half_spaces[i].offset, slope = dot(normal, direction);
    if (slope > 0)
      interval[0] = fmaxl(interval[0], -inside / slope);
    else if (slope < 0)
      interval[1] = fminl(interval[1], -inside / slope);
    else if (inside < 0)
      interval[1] = -1;
  }
}

/* Clips the interval of the ray against the cell's four half-spaces. */
static bool clip(const Cell *cell, const long double direction[3], const long double interval[2], BruteSpan *span) {
  long double at[4][2];
  span->t[0] = interval[0];
  span->t[1] = interval[1];
  for (int i = 0; i < 4; i++) {
    if (!coordinate(cell, i, direction, at[i]))
      return false;
    const long double zero = -at[i][0] / at[i][1];
    if (at[i][1] > 0)
      span->t[0] = fmaxl(span->t[0], zero);
    else if (at[i][1] < 0)
      span->t[1] = fminl(span->t[1], zero);
    else if (at[i][0] < 0)
      return false;
  }
  if (!(span->t[0] < span->t[1]) || isinf(span->t[1]))
    return false;
  for (int e = 0; e < 2; e++) {
    span->s[e] = 0;
    for (int i = 0; i < 4; i++)
      span->s[e] += cell->value[i] * (at[i][0] + at[i][1] * span->t[e]);
  }
  return true;
}

/* Whether all corners lie to one side of the ray, further away than `margin`, as seen along either of two directions
 * across it. */
static bool beside(const Cell *cell, long double across[2][3], long double margin) {
  for (int a = 0; a < 2; a++) {
    int positive = 0, negative = 0;
    for (int i = 0; i < 4; i++) {
      const long double distance = dot(cell->corner[i], across[a]);
      positive += distance > margin;
      negative += distance < -margin;
    }
    if (positive == 4 || negative == 4)
      return true;
  }
  return false;
}

/* Two directions of length 1, perpendicular to the ray's and to each other. */
static void directions_across(const long double direction[3], long double across[2][3]) {
  int least = 0;
  for (int k = 1; k < 3; k++)
    if (fabsl(direction[k]) < fabsl(direction[least]))
      least = k;
  memset(across[0], 0, sizeof across[0]);
  across[0][(least + 1) % 3] = direction[(least + 2) % 3];
  across[0][(least + 2) % 3] = -direction[(least + 1) % 3];
  const long double length = sqrtl(dot(across[0], across[0]));
  for (int k = 0; k < 3; k++)
    across[0][k] /= length;
  for (int k = 0; k < 3; k++)
    across[1][k] = direction[(k + 1) % 3] * across[0][(k + 2) % 3] - direction[(k + 2) % 3] * across[0][(k + 1) % 3];
}

static int ascending(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

static int along(const void *a, const void *b) {
  const BruteSpan *x = a, *y = b;
  if (x->t[0] != y->t[0])
    return x->t[0] < y->t[0] ? -1 : 1;
  if (x->t[1] != y->t[1])
    return x->t[1] < y->t[1] ? -1 : 1;
  return memcmp(x->vertices, y->vertices, sizeof x->vertices);
}

static void append(BruteSpans *list, const BruteSpan *span) {
  list->spans = cli_grow(list->spans, list->count, &list->capacity, sizeof *list->spans);
  list->spans[list->count++] = *span;
}

/* Sets the span's scalars from the field. False if they aren't finite, so that the cell is transparent. */
static bool load_values(Cell *cell, const TetcastField *field, int64_t number) {
  const bool of_cells = tetcast_field_association(field) == TETCAST_CELL;
  for (int i = 0; i < 4; i++) {
    cell->value[i] = tetcast_field_value(field, of_cells ? number : cell->vertices[i]);
    if (!isfinite(cell->value[i]))
      return false;
  }
  return true;
}

/* Sorts the spans. Of cells with the same four vertices only one stays, as they count once. */
static void put_in_order(BruteSpans *list) {
  if (list->count > 0)
    qsort(list->spans, (size_t)list->count, sizeof *list->spans, along);
  int kept = 0;
  for (int i = 0; i < list->count; i++)
    if (kept == 0 || memcmp(list->spans[kept - 1].vertices, list->spans[i].vertices, sizeof list->spans[i].vertices))
      list->spans[kept++] = list->spans[i];
  list->count = kept;
}

/* How far the rays beside a ray are from it: several times the rounding, in double precision, of all lengths that a
 * renderer computes with, as its rays are no more exact than that. */
static long double offset_of(const TetcastMesh *mesh, const ReferenceRay *line) {
  double bounds[6];
  tetcast_mesh_bounds(mesh, bounds);
  long double reach = 0;
  for (int k = 0; k < 3; k++) {
    const long double low = fabsl(bounds[2 * k] - line->origin[k]), high = fabsl(bounds[2 * k + 1] - line->origin[k]);
    reach += fmaxl(low, high) + fabsl(line->origin[k]);
  }
  return 16 * 0x1p-52L * reach;
}

/* Casts the ray and those beside it against one cell. */
static void cast(BruteRay *ray, const Cell *cell, bool of_cells, const long double direction[3],
                 long double offsets[BRUTE_RAYS][3], long double intervals[BRUTE_RAYS][2]) {
  for (int r = 0; r < BRUTE_RAYS; r++) {
    Cell moved = *cell;
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++)
        moved.corner[i][k] -= offsets[r][k];
    BruteSpan span;
    if (!clip(&moved, direction, intervals[r], &span))
      continue;
    if (of_cells) /* to the last bit: it may be the value of a step */
      span.s[0] = span.s[1] = cell->value[0];
    memcpy(span.vertices, cell->vertices, sizeof span.vertices);
    qsort(span.vertices, 4, sizeof *span.vertices, ascending);
    append(&ray->cast[r], &span);
  }
}

void brute_trace(BruteRay *ray, const TetcastMesh *mesh, const TetcastField *field, const TetcastHalfSpace *half_spaces,
                 int half_space_count, const TetcastCamera *camera, int64_t width, int64_t height, int64_t pixel) {
  const ReferenceRay line = reference_ray(camera, width, height, pixel % width, pixel / width);
  const bool of_cells = tetcast_field_association(field) == TETCAST_CELL;
  const int64_t count = tetcast_mesh_tetrahedron_count(mesh);
  const long double offset = offset_of(mesh, &line);
  long double across[2][3], offsets[BRUTE_RAYS][3] = {{0}}, intervals[BRUTE_RAYS][2];
  directions_across(line.direction, across);
  for (int r = 1; r < BRUTE_RAYS; r++) { /* around it, in no direction that meshes have faces in */
    const long double angle = 0.7L + 1.5707963267948966L * r;
    for (int k = 0; k < 3; k++)
      offsets[r][k] = offset * (cosl(angle) * across[0][k] + sinl(angle) * across[1][k]);
  }
  for (int r = 0; r < BRUTE_RAYS; r++) {
    long double origin[3];
    for (int k = 0; k < 3; k++)
      origin[k] = line.origin[k] + offsets[r][k];
    interval_of(half_spaces, half_space_count, origin, line.direction, intervals[r]);
  }
  *ray = (BruteRay){.pixel = pixel};
  for (int64_t number = 0; number < count; number++) {
    Cell cell;
    tetcast_mesh_tetrahedron(mesh, number, cell.vertices);
    for (int i = 0; i < 4; i++) {
      double position[3];
      tetcast_mesh_vertex(mesh, cell.vertices[i], position);
      for (int k = 0; k < 3; k++)
        cell.corner[i][k] = position[k] - line.origin[k];
    }
    if (!beside(&cell, across, 2 * offset) && load_values(&cell, field, number))
      cast(ray, &cell, of_cells, line.direction, offsets, intervals);
  }
  for (int r = 0; r < BRUTE_RAYS; r++)
    put_in_order(&ray->cast[r]);
}

void brute_release(BruteRay *ray) {
  for (int r = 0; r < BRUTE_RAYS; r++)
    free(ray->cast[r].spans);
  *ray = (BruteRay){0};
}

/* ── what is seen along them ── */

/* A list of knots: each is a value, and what holds at it. */
typedef struct Knots {
  const double *rows;
  int64_t count;
  int width;
} Knots;

/* How many knots lie at or below a value. */
static int64_t below(const Knots *knots, long double value) {
  int64_t low = 0, high = knots->count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (knots->rows[middle * knots->width] <= value)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Column k at `value`, on the straight line that holds around `within`. */
static long double on_line(const Knots *knots, long double within, int k, long double value) {
  const int64_t after = below(knots, within);
  const double *a = knots->rows + (after > 0 ? after - 1 : 0) * knots->width;
  const double *b = knots->rows + (after < knots->count ? after : knots->count - 1) * knots->width;
  if (a == b)
    return a[k];
  return a[k] + (b[k] - (long double)a[k]) * ((value - a[0]) / (b[0] - (long double)a[0]));
}

/* Adds the positions in (0, 1) at which a span from s0 to s1 meets knots. */
static int add_cuts(const Knots *knots, const long double s[2], long double *cuts, int count) {
  const int64_t first = below(knots, fminl(s[0], s[1])), last = below(knots, fmaxl(s[0], s[1]));
  for (int64_t i = first; i < last; i++) {
    const long double u = (knots->rows[i * knots->width] - s[0]) / (s[1] - s[0]);
    if (u > 0 && u < 1)
      cuts[count++] = u;
  }
  return count;
}

static int rising(const void *a, const void *b) {
  const long double x = *(const long double *)a, y = *(const long double *)b;
  return (x > y) - (x < y);
}

typedef struct Light {
  long double color[3], depth;
} Light;

/* A piece of length h on which extinction and colour (ends[…][0], [1 … 3]) are linear, in steps of an optical depth of
 * a quarter at most: there the rule is exact to the last bits. */
static void add_piece(Light *light, long double h, long double ends[2][4]) {
  const Quadrature *rule = quadrature();
  const long double opaque = 80, quarter = 0.25L;
  const long double a = ends[0][0] * h, b = ends[1][0] * h - a;
  long double u = 0;
  while (u < 1 && light->depth + u * (a + b * u / 2) < opaque) {
    const long double here = fmaxl(a + b * u, 0);
    const long double root = b > 0 ? here + sqrtl(here * here + 2 * b * quarter) : here;
    const long double step = fminl(1 - u, (b > 0 ? 2 : 1) * quarter / root);
    for (int i = 0; i < QUADRATURE_NODES; i++) {
      const long double v = u + step * rule->node[i];
      const long double weight = rule->weight[i] * step * (a + b * v) * expl(-light->depth - v * (a + b * v / 2));
      for (int k = 0; k < 3; k++)
        light->color[k] += weight * (ends[0][k + 1] + (ends[1][k + 1] - ends[0][k + 1]) * v);
    }
    u += step;
  }
  light->depth += a + b / 2;
}

static void add_span(Light *light, const BruteSpan *span, const Knots *color, const Knots *extinction,
                     long double *cuts) {
  int count = 0;
  cuts[count++] = 0;
  if (span->s[0] != span->s[1]) {
    count = add_cuts(color, span->s, cuts, count);
    count = add_cuts(extinction, span->s, cuts, count);
  }
  cuts[count++] = 1;
  qsort(cuts, (size_t)count, sizeof *cuts, rising);
  for (int i = 0; i + 1 < count; i++) {
    const long double range = span->s[1] - span->s[0], middle = span->s[0] + range * (cuts[i] + cuts[i + 1]) / 2;
    long double ends[2][4];
    for (int e = 0; e < 2; e++) {
      const long double s = span->s[0] + range * cuts[i + e];
      ends[e][0] = fmaxl(on_line(extinction, middle, 1, s), 0);
      for (int k = 1; k < 4; k++)
        ends[e][k] = on_line(color, middle, k, s);
    }
    add_piece(light, (cuts[i + 1] - cuts[i]) * (span->t[1] - span->t[0]), ends);
  }
}

static void shade(const BruteSpans *list, const TetcastTransferFunction *transfer_function, long double rgba[4]) {
  Knots color = {.width = 4}, extinction = {.width = 2};
  color.rows = tetcast_transfer_function_color(transfer_function, &color.count);
  extinction.rows = tetcast_transfer_function_extinction(transfer_function, &extinction.count);
  long double *cuts = cli_allocate(sizeof *cuts * (size_t)(color.count + extinction.count + 2));
  Light light = {{0, 0, 0}, 0};
  for (int i = 0; i < list->count; i++)
    add_span(&light, &list->spans[i], &color, &extinction, cuts);
  free(cuts);
  memcpy(rgba, light.color, sizeof light.color);
  rgba[3] = -expm1l(-light.depth);
}

/* If light changes smoothly from one side of the ray to the other, or with a kink, the ray's own light lies between
 * that of the rays beside it, or beyond by no more than they differ. If it is further beyond, a cell was counted twice
 * or not at all. */
void brute_shade(const BruteRay *ray, const TetcastTransferFunction *transfer_function, BruteLight *light) {
  long double own[4];
  shade(&ray->cast[0], transfer_function, own);
  light->beside = false;
  light->spread = 0;
  for (int r = 1; r < BRUTE_RAYS; r++) {
    long double rgba[4];
    shade(&ray->cast[r], transfer_function, rgba);
    for (int k = 0; k < 4; k++) {
      light->low[k] = r == 1 ? rgba[k] : fminl(light->low[k], rgba[k]);
      light->high[k] = r == 1 ? rgba[k] : fmaxl(light->high[k], rgba[k]);
    }
  }
  for (int k = 0; k < 4; k++) {
    const long double spread = light->high[k] - light->low[k], slack = spread + 0x1p-56L * fmaxl(1, fabsl(own[k]));
    light->spread = fmaxl(light->spread, spread);
    light->beside = light->beside || !(own[k] >= light->low[k] - slack && own[k] <= light->high[k] + slack);
  }
  for (int k = 0; k < 4 && !light->beside; k++)
    light->low[k] = light->high[k] = own[k];
}

double brute_error(const BruteLight *light, const double rgba[4]) {
  long double error = 0;
  for (int k = 0; k < 4; k++) {
    const long double below = light->low[k] - rgba[k], above = rgba[k] - light->high[k];
    if (!(below <= error)) /* nor if it is NaN */
      error = below;
    if (!(above <= error))
      error = above;
  }
  return (double)error;
}
