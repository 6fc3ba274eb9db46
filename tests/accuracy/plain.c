/* SPDX-License-Identifier: Apache-2.0 */
#include "plain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ── light ── */

static void add_part(PlainLight *light, const TcPiece *piece, double length, double s0, double s1) {
  const TcOptics near = tc_piece_at(piece, s0), far = tc_piece_at(piece, s1);
  const TcSegment segment = tc_segment(near.extinction * length, far.extinction * length);
  const long double before = expl(-light->depth);
  for (int k = 0; k < 3; ++k) {
    light->color[k] += before * ((long double)near.color[k] * segment.w0 + (long double)far.color[k] * segment.w1);
  }
  light->depth += segment.depth;
}

/* Cuts a segment at the knots. Lengths of parts come from differences of scalars: nothing cancels. */
void plain_add(PlainLight *light, const TcPieces *pieces, double length, double s0, double s1) {
  const double whole = fabs(s1 - s0);
  const bool up = s0 <= s1;
  int64_t i = up ? tc_piece_above(pieces, s0) : tc_piece_below(pieces, s0);
  for (;;) {
    const TcPiece *piece = &pieces->pieces[i];
    const double end = up ? fmin(piece->high, s1) : fmax(piece->low, s1);
    add_part(light, piece, whole > 0 ? length * (fabs(end - s0) / whole) : length, s0, end);
    if (end == s1)
      return;
    s0 = end;
    i += up ? 1 : -1;
  }
}

void plain_end(const PlainLight *light, double rgba[4]) {
  for (int k = 0; k < 3; ++k)
    rgba[k] = (double)light->color[k];
  rgba[3] = (double)-expm1l(-light->depth);
}

/* ── a ray and what it sees ── */

PlainRay plain_ray(const TcView *view, int64_t width, int64_t height, int samples_x, int samples_y, int64_t x,
                   int64_t y, int i, const TcScreen *screen) {
  const double column = (double)(x * samples_x + i % samples_x) + 0.5,
               row = (double)(y * samples_y + i / samples_x) + 0.5;
  const double across = (double)(width * samples_x), down = (double)(height * samples_y);
  const double u = (2 * column - across) / across, v = (down - 2 * row) / down;
  PlainRay ray = {.line = {.end = INFINITY}};
  double direction[3], length = 0;
  for (int k = 0; k < 3; ++k) {
    const double shift = u * view->right[k] + v * view->up[k];
    ray.line.eye[k] = view->eye[k];
    ray.line.offset[k] = view->orthographic ? shift : 0;
    direction[k] = view->forward[k] + (view->orthographic ? 0 : shift);
  }
  for (int k = 0; k < 3; ++k)
    length += direction[k] * direction[k];
  for (int k = 0; k < 3; ++k)
    ray.line.direction[k] = view->orthographic ? direction[k] : direction[k] / sqrt(length);
  if (!screen)
    return ray;
  ray.x = column / samples_x - screen->x0;
  ray.y = row / samples_y - screen->y0;
  return ray;
}

/* A vertex beside the ray. `depth` is along the ray; on the screen in perspective it is the number that is interpolated
 * in its place. */
typedef struct Point {
  double x, y, depth;
  uint32_t id;
} Point;

/* A ray in its own space. */
typedef struct Space {
  const PlainScene *scene;
  double x, y, scale;                                     /* on the screen */
  double origin[3], shear_x, shear_y, inverse_z, rest[3]; /* in ray space */
  int kx, ky, kz;
  double begin, end; /* depths that count */
} Space;

/* a + b = *sum + return value, exactly (Knuth). */
static double two_sum(double a, double b, double *sum) {
  const double s = a + b, t = s - a;
  *sum = s;
  return (a - (s - t)) + (b - t);
}

static double two_product(double a, double b, double *product) {
  *product = a * b;
  return fma(a, b, -*product);
}

/* The origin is moved to where the ray is nearest to the volume's centre, as origin + rest to twice the precision. */
static void begin_in_ray_space(const TcLine *line, const TetcastVolume *volume, Space *space) {
  const double *d = line->direction;
  double along = 0, rest[3];
  for (int k = 0; k < 3; ++k)
    along += (volume->center[k] - line->eye[k] - line->offset[k]) * d[k];
  for (int k = 0; k < 3; ++k) {
    double product, shift;
    rest[k] = two_product(along, d[k], &product);
    rest[k] += two_sum(product, line->offset[k], &shift);
    rest[k] += two_sum(line->eye[k], shift, &space->origin[k]);
    space->origin[k] = tc_without_tiny(space->origin[k]);
  }
  space->kz = 0;
  for (int k = 1; k < 3; ++k) {
    if (fabs(d[k]) > fabs(d[space->kz]))
      space->kz = k;
  }
  space->kx = (space->kz + 1) % 3;
  space->ky = (space->kz + 2) % 3;
  space->shear_x = tc_without_tiny(d[space->kx] / d[space->kz]);
  space->shear_y = tc_without_tiny(d[space->ky] / d[space->kz]);
  space->inverse_z = 1 / d[space->kz];
  space->rest[0] = tc_without_tiny(rest[space->kx] - space->shear_x * rest[space->kz]);
  space->rest[1] = tc_without_tiny(rest[space->ky] - space->shear_y * rest[space->kz]);
  space->rest[2] = rest[space->kz] * space->inverse_z;
  space->begin = line->begin - along;
  space->end = line->end - along;
}

/* Depths are those from the plane of the volume's centre. */
static void begin_on_screen(const PlainRay *ray, const TcScreen *screen, Space *space) {
  double cosine = 0;
  for (int k = 0; k < 3; ++k)
    cosine += ray->line.direction[k] * screen->forward[k];
  const double away = screen->perspective ? screen->distance / cosine : screen->distance;
  space->x = ray->x;
  space->y = ray->y;
  space->scale = screen->perspective ? -away : 1;
  space->begin = ray->line.begin - away;
  space->end = ray->line.end - away;
}

static Point project(const Space *space, uint32_t id) {
  Point point = {.id = id};
  if (space->scene->screen) {
    const double *v = (const double *)space->scene->screen->vertices + 4 * (size_t)id;
    point.x = v[0] - space->x;
    point.y = v[1] - space->y;
    point.depth = v[2];
    return point;
  }
  double p[3];
  tc_volume_vertex(space->scene->shell->volume, id, p);
  for (int k = 0; k < 3; ++k)
    p[k] -= space->origin[k];
  point.x = p[space->kx] - space->shear_x * p[space->kz] - space->rest[0];
  point.y = p[space->ky] - space->shear_y * p[space->kz] - space->rest[1];
  point.depth = p[space->kz] * space->inverse_z - space->rest[2];
  return point;
}

/* ── edges and faces ── */

/* a × b, with the exact sign, never zero: where it is, the sign for the ray moved by (δ, δ²) and vertices by (0, id
 * δ³), δ infinitesimal. */
static double edge(const Point *a, const Point *b) {
  double p, q, d, s;
  const double p_error = two_product(a->x, b->y, &p), q_error = two_product(a->y, b->x, &q);
  const double error = two_sum(p_error, -q_error, &d), rest = two_sum(p - q, d, &s);
  /* p − q is exact where it is not larger than its errors by far. */
  if (s != 0)
    return s;
  if (rest + error != 0)
    return rest + error;
  bool positive;
  if (a->y != b->y)
    positive = b->y < a->y;
  else if (a->x != b->x)
    positive = b->x > a->x;
  else
    positive = (a->x > 0) == (b->id > a->id);
  return positive ? DBL_MIN : -DBL_MIN;
}

/* Three vertices counter-clockwise around the ray, each with the cross product of the two others, > 0, and where the
 * ray crosses them. */
typedef struct Face {
  Point v[3];
  double weight[3], barycentric[3], z;
} Face;

static void cross(const Space *space, Face *face) {
  const TcScreen *screen = space->scene->screen;
  long double sum = 0, weighted = 0, w[3];
  for (int k = 0; k < 3; ++k) {
    const double depth = face->v[k].depth;
    w[k] = (long double)face->weight[k] * (screen && screen->perspective ? 1 + (long double)depth : 1);
    sum += w[k];
    weighted += (long double)face->weight[k] * depth;
  }
  for (int k = 0; k < 3; ++k)
    face->barycentric[k] = (double)(w[k] / sum);
  face->z = (double)(weighted / sum * (screen ? space->scale : 1));
}

/* False: the ray passes the triangle. */
static bool face_of(const Space *space, const uint32_t vertex[3], Face *face) {
  Point *p = face->v;
  for (int k = 0; k < 3; ++k)
    p[k] = project(space, vertex[k]);
  if (fmin(fmin(p[0].x, p[1].x), p[2].x) > 0 || fmax(fmax(p[0].x, p[1].x), p[2].x) < 0)
    return false;
  if (fmin(fmin(p[0].y, p[1].y), p[2].y) > 0 || fmax(fmax(p[0].y, p[1].y), p[2].y) < 0)
    return false;
  double *w = face->weight;
  for (int k = 0; k < 3; ++k)
    w[k] = edge(&p[(k + 1) % 3], &p[(k + 2) % 3]);
  if ((w[0] > 0) != (w[1] > 0) || (w[1] > 0) != (w[2] > 0))
    return false;
  if (w[0] < 0) {
    const Point point = p[1];
    p[1] = p[2];
    p[2] = point;
    for (int k = 0; k < 3; ++k)
      w[k] = -w[k];
    const double weight = w[1];
    w[1] = w[2];
    w[2] = weight;
  }
  cross(space, face);
  return true;
}

/* A number of the vertices where the ray crosses the face; it lies within theirs. */
static double interpolate(const Face *face, const double f[3]) {
  long double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += (long double)face->barycentric[k] * f[k];
  if (isnan(sum))
    return (double)NAN;
  return fmax(fmin(fmin(f[0], f[1]), f[2]), fmin(fmax(fmax(f[0], f[1]), f[2]), (double)sum));
}

/* ── what is gathered ── */

typedef struct Gather {
  const Space *space;
  PlainLight light;
  PlainResult result;
  long double *groups;               /* [groups][2]: radiance, depth */
  long double least, most, integral; /* of values, in a blend mode */
  double *sums;
  double seen; /* the depth up to which the path has been seen */
} Gather;

/* Where the vertex is among those of the cell, in ascending order. */
static int rank_of(uint32_t id, const uint32_t cell[4]) {
  int rank = 0;
  for (int k = 0; k < 4; ++k)
    rank += cell[k] < id;
  return rank;
}

static double scalar_at(const PlainScene *scene, const Face *face, uint32_t cell, const uint32_t vertices[4]) {
  double f[3];
  if (scene->values->association == TETCAST_CELL)
    return tc_rows_value(scene->values, cell, 0);
  for (int k = 0; k < 3; ++k) {
    const uint32_t id = face->v[k].id;
    f[k] = scene->values->association == TETCAST_POINT ? tc_rows_value(scene->values, id, 0)
                                                       : tc_rows_value(scene->values, cell, rank_of(id, vertices));
  }
  return interpolate(face, f);
}

static double coefficient_at(const TcCoefficients *c, int slot, const Face *face, uint32_t cell) {
  const int points = c->points ? c->points->width : 0;
  if (slot < 0)
    return 0;
  if (slot >= points)
    return tc_rows_value(c->cells, cell, slot - points);
  double f[3];
  for (int k = 0; k < 3; ++k)
    f[k] = tc_rows_value(c->points, face->v[k].id, slot);
  return interpolate(face, f);
}

/* The fractions from and to of a cell, whose part between them has this length. */
static void gather_groups(Gather *gather, const Face face[2], uint32_t cell, double from, double to, double length) {
  const TcCoefficients *c = gather->space->scene->coefficients;
  for (int g = 0; g < c->groups; ++g) {
    double ends[2][2]; /* of extinction, of emission */
    for (int list = 0; list < 2; ++list) {
      const int slot = c->slots[list * c->groups + g];
      const double near = coefficient_at(c, slot, &face[0], cell), far = coefficient_at(c, slot, &face[1], cell);
      ends[list][0] = near + from * (far - near);
      ends[list][1] = far + (to - 1) * (far - near);
    }
    double a[2];
    for (int i = 0; i < 2; ++i)
      a[i] = ends[0][i] * (length * c->scale[0]) * c->scale[1];
    if (isnan(a[0]) || isnan(a[1]))
      continue;
    const TcMoments m = tc_segment_moments(a[0], a[1]);
    const double radiance = length * (c->emission_scale * ends[1][0] * m.m0 + c->emission_scale * ends[1][1] * m.m1);
    if (isnan(radiance))
      continue;
    long double *sums = &gather->groups[2 * g];
    sums[0] += expl(-sums[1]) * radiance;
    sums[1] += m.depth;
  }
}

/* What of the cell between two faces lies beyond what was seen and within the ray's interval. Rounding can make a
 * face's depth less than that of the face before: then the segment counts for nothing, and the next one for what it has
 * beyond. */
static void add_cell(Gather *gather, const Face face[2], uint32_t cell, const uint32_t vertices[4]) {
  const PlainScene *scene = gather->space->scene;
  const double whole = face[1].z - face[0].z, z0 = fmax(face[0].z, gather->seen),
               z1 = fmin(face[1].z, gather->space->end);
  if (!(z1 > z0))
    return;
  const double from = z0 > face[0].z ? (z0 - face[0].z) / whole : 0, to = z1 < face[1].z ? (z1 - face[0].z) / whole : 1;
  gather->seen = z1;
  gather->result.length += (long double)z1 - z0;
  ++gather->result.segments;
  if (scene->coefficients)
    gather_groups(gather, face, cell, from, to, z1 - z0);
  if (!scene->pieces && !scene->blend)
    return;
  const double s0 = scalar_at(scene, &face[0], cell, vertices), s1 = scalar_at(scene, &face[1], cell, vertices);
  if (isnan(s0) || isnan(s1))
    return; /* two faces have all four vertices between them */
  const double begin = from > 0 ? s0 + from * (s1 - s0) : s0, end = to < 1 ? s0 + to * (s1 - s0) : s1;
  if (scene->pieces) {
    plain_add(&gather->light, scene->pieces, z1 - z0, begin, end);
    return;
  }
  gather->least = fminl(gather->least, fminl(begin, end));
  gather->most = fmaxl(gather->most, fmaxl(begin, end));
  gather->integral += ((long double)begin + end) / 2 * ((long double)z1 - z0);
  gather->result.met += (long double)z1 - z0;
}

/* ── the walk ── */

typedef struct Hit {
  double begin, end;
  uint32_t id;
  bool done;
} Hit;

static int compare_hits(const void *left, const void *right) {
  const Hit *a = left, *b = right;
  if (a->begin != b->begin)
    return a->begin < b->begin ? -1 : 1;
  if (a->end != b->end)
    return a->end < b->end ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

/* The face through which the ray leaves the cell behind `face`, and the cell beyond. False: there is none, which exact
 * signs exclude. */
static bool step(const Space *space, Face *face, uint32_t *cell, uint32_t vertices[4]) {
  const TcCell *from = &space->scene->shell->volume->adjacency.cells[*cell];
  Point *v = face->v;
  const Point q = project(space, from->vertex_xor ^ v[0].id ^ v[1].id ^ v[2].id);
  const uint32_t ids[4] = {v[0].id, v[1].id, v[2].id, q.id};
  for (int k = 0; k < 4; ++k)
    vertices[rank_of(ids[k], ids)] = ids[k];
  double e[3];
  for (int k = 0; k < 3; ++k)
    e[k] = edge(&v[k], &q);
  int out = -1; /* the vertex that is left behind: q comes between the two others */
  for (int k = 0; k < 3; ++k) {
    if (e[(k + 1) % 3] < 0 && e[(k + 2) % 3] > 0)
      out = k;
  }
  if (out < 0)
    return false;
  const int next = (out + 1) % 3, last = (out + 2) % 3;
  *cell = from->neighbor[rank_of(v[out].id, vertices)];
  v[out] = q;
  face->weight[next] = e[last];
  face->weight[last] = -e[next];
  cross(space, face);
  return true;
}

static bool is_outside(const TcShell *shell, uint32_t cell) {
  return (cell & TC_SHELL) || (shell->visible && !tc_shell_shows(shell, cell));
}

/* Walks from a face of the shell to where the ray leaves again; *from: the last cell. */
static bool walk(Gather *gather, const TcShellFace *start, Face *face, uint32_t *from) {
  const Space *space = gather->space;
  uint32_t cell = start->cell, vertices[4];
  gather->seen = fmax(face->z, space->begin);
  do {
    const Face before = *face;
    *from = cell;
    if (!step(space, face, &cell, vertices))
      return false;
    add_cell(gather, (const Face[]){before, *face}, *from, vertices);
  } while (!is_outside(space->scene->shell, cell));
  return true;
}

/* Each path of cells once, from the end that comes first. */
static bool walk_all(Gather *gather) {
  const Space *space = gather->space;
  const TcShell *shell = space->scene->shell;
  Hit *hits = malloc(((size_t)shell->count + 1) * sizeof *hits);
  int64_t count = 0;
  bool ok = true;
  Face face;
  for (uint32_t i = 0; i < shell->count; ++i) {
    if (face_of(space, shell->faces[i].vertex, &face))
      hits[count++] = (Hit){.begin = face.z, .end = face.z, .id = i};
  }
  qsort(hits, (size_t)count, sizeof *hits, compare_hits);
  for (int64_t i = 0; i < count && ok; ++i) {
    if (hits[i].done)
      continue;
    uint32_t from;
    const TcShellFace *start = &shell->faces[hits[i].id];
    if (!face_of(space, start->vertex, &face))
      abort();
    ok = walk(gather, start, &face, &from);
    const uint32_t vertex_xor = face.v[0].id ^ face.v[1].id ^ face.v[2].id;
    for (int64_t j = i + 1; j < count; ++j) {
      const TcShellFace *other = &shell->faces[hits[j].id];
      const bool here = other->cell == from && (other->vertex[0] ^ other->vertex[1] ^ other->vertex[2]) == vertex_xor;
      if (here)
        hits[j].done = true;
    }
  }
  free(hits);
  return ok;
}

/* Every cell for itself, in the order in which the ray enters them. */
static void cross_all(Gather *gather) {
  const Space *space = gather->space;
  const TetcastVolume *volume = space->scene->shell->volume;
  Hit *hits = malloc(((size_t)volume->cell_count + 1) * sizeof *hits);
  Face(*faces)[2] = malloc(((size_t)volume->cell_count + 1) * sizeof *faces);
  int64_t count = 0;
  for (uint32_t i = 0; i < volume->cell_count; ++i) {
    const uint32_t *v = volume->adjacency.vertices[i];
    int found = 0;
    for (int k = 0; k < 4 && found < 2; ++k) {
      const uint32_t vertex[3] = {v[k], v[(k + 1) & 3], v[(k + 2) & 3]};
      found += face_of(space, vertex, &faces[i][found]);
    }
    if (found < 2)
      continue;
    if (faces[i][1].z < faces[i][0].z) {
      const Face face = faces[i][0];
      faces[i][0] = faces[i][1];
      faces[i][1] = face;
    }
    hits[count++] = (Hit){.begin = faces[i][0].z, .end = faces[i][1].z, .id = i};
  }
  qsort(hits, (size_t)count, sizeof *hits, compare_hits);
  for (int64_t i = 0; i < count; ++i) {
    const uint32_t cell = hits[i].id;
    gather->seen = fmax(hits[i].begin, space->begin);
    add_cell(gather, faces[cell], cell, volume->adjacency.vertices[cell]);
  }
  free(hits);
  free(faces);
}

/* ── the ray ── */

static void end_groups(const Gather *gather, double *sums) {
  const TcCoefficients *c = gather->space->scene->coefficients;
  const int distinct = c->extinction_count;
  long double opacity = 0;
  for (int g = 0; g < c->groups; ++g) {
    const long double depth = gather->groups[2 * g + 1];
    sums[3 * g] = (double)gather->groups[2 * g];
    sums[3 * g + 1] = (double)depth;
    sums[3 * g + 2] = (double)expl(-depth);
    if (g < distinct)
      opacity -= expm1l(-depth) / distinct;
  }
  sums[3 * c->groups] = (double)gather->result.length;
  sums[3 * c->groups + 1] = (double)opacity;
}

static void end_values(const Gather *gather, double *sums) {
  const long double met = gather->result.met;
  const long double of[] = {[TETCAST_BLEND_MAXIMUM] = gather->most,
                            [TETCAST_BLEND_MINIMUM] = gather->least,
                            [TETCAST_BLEND_AVERAGE] = gather->integral / met,
                            [TETCAST_BLEND_ADDITIVE] = gather->integral};
  sums[1] = met > 0;
  sums[0] = met > 0 ? (double)of[gather->space->scene->blend] : 0;
}

PlainResult plain_cast(const PlainScene *scene, const PlainRay *ray, double *sums) {
  const TetcastVolume *volume = scene->shell->volume;
  Space space = {.scene = scene};
  if (scene->screen)
    begin_on_screen(ray, scene->screen, &space);
  else
    begin_in_ray_space(&ray->line, volume, &space);
  Gather gather = {.space = &space, .least = INFINITY, .most = -INFINITY};
  if (scene->coefficients)
    gather.groups = calloc(2 * (size_t)scene->coefficients->groups, sizeof *gather.groups);
  if (volume->traversal == TETCAST_TRAVERSAL_FACES)
    cross_all(&gather);
  else
    gather.result.lost = !walk_all(&gather);
  gather.result.depth = gather.light.depth;
  if (scene->coefficients)
    end_groups(&gather, sums);
  else if (scene->blend)
    end_values(&gather, sums);
  else if (scene->pieces)
    plain_end(&gather.light, sums);
  else
    sums[0] = (double)gather.result.length;
  free(gather.groups);
  return gather.result;
}
