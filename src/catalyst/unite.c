/* SPDX-License-Identifier: Apache-2.0 */
/* Makes one mesh of several, or of one with ghosts, as the command does with the pieces of a file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "part.h"

/* ── points ── */

/* Points of different parts that coincide become one, but points of the same part stay apart, because at a crack a part
 * has several points at one place. There, the second point of a part becomes one with the second point of another. */
typedef struct Merger {
  double *points; /* [count][3] */
  int64_t count, slots;
  int32_t *slot; /* [slots], a power of two: the number of a point, -1: none */
  struct Visit {
    int32_t part, times; /* how often which part has come to this place last: of the first point there */
    int32_t which;       /* which of the points at this place it is */
  } * visits;            /* [count] */
} Merger;

static uint64_t hash_of(const double p[3], int32_t which) {
  uint64_t hash = (uint64_t)which * 0x9E3779B97F4A7C15u;
  for (int k = 0; k < 3; k++) {
    const double value = p[k] == 0 ? 0 : p[k]; /* -0 and 0 are one place */
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0xFF51AFD7ED558CCDu;
    hash ^= hash >> 32;
  }
  return hash;
}

/* The point at this place that is the so-manieth of its part there, -1: none; *at is its slot, or a free one. */
static int64_t find_point(const Merger *m, const double p[3], int32_t which, int64_t *at) {
  *at = (int64_t)(hash_of(p, which) & (uint64_t)(m->slots - 1));
  for (; m->slot[*at] >= 0; *at = (*at + 1) & (m->slots - 1)) {
    const double *q = m->points + 3 * (int64_t)m->slot[*at];
    if (m->visits[m->slot[*at]].which == which && q[0] == p[0] && q[1] == p[1] && q[2] == p[2])
      return m->slot[*at];
  }
  return -1;
}

static int64_t take_point(Merger *m, const double p[3], int32_t part) {
  int64_t at;
  const int64_t first = find_point(m, p, 0, &at);
  int32_t which = 0;
  if (first >= 0) {
    struct Visit *visit = &m->visits[first];
    if (visit->part != part)
      *visit = (struct Visit){part, 0, visit->which};
    which = visit->times++;
    const int64_t found = which == 0 ? first : find_point(m, p, which, &at);
    if (found >= 0)
      return found;
  }
  memcpy(m->points + 3 * m->count, p, sizeof(double[3]));
  m->visits[m->count] = (struct Visit){part, 1, which};
  m->slot[at] = (int32_t)m->count;
  return m->count++;
}

static void point_at(const TetcastArray *points, int64_t i, double p[3]) {
  const View first = view_of_array(points);
  const int64_t size = view_type_size(first.type), stride = points->stride ? points->stride : 3 * size;
  for (int k = 0; k < 3; k++) {
    const View own = {.data = first.data + i * stride + k * size, .type = first.type};
    p[k] = view_value(&own, 0);
  }
}

/* Points that only ghosts use become -1, all others 0. */
static void drop_points(const Part *part, int64_t *to) {
  const int64_t count = part->cells.vertices.count;
  memset(to, 0, sizeof *to * (size_t)count);
  for (int ghosts = 1; ghosts >= 0 && part->hidden; ghosts--)
    for (int64_t i = 0; i < part->cell_count; i++)
      for (int64_t k = part_cell_size(part, i); k > 0 && part->hidden[i] == ghosts; k--) {
        const int64_t node = part_cell_node(part, i, k - 1);
        if (node >= 0 && node < count)
          to[node] = -ghosts;
      }
}

/* Numbers the points of the whole: to[p][i] is what point i of part p becomes, -1: nothing. */
static void merge_points(const Part *parts, int count, Part *whole, int64_t **to) {
  int64_t limit = 0;
  bool single = true;
  for (int p = 0; p < count; p++) {
    limit += parts[p].cells.vertices.count;
    single = single && parts[p].cells.vertices.type == TETCAST_TYPE_FLOAT32;
  }
  Memory own = {0};
  Merger m = {.slots = 16};
  while (m.slots < 2 * limit && count > 1)
    m.slots *= 2;
  m.points = memory_take(&whole->memory, 3 * limit, sizeof *m.points);
  m.visits = memory_take(&own, limit, sizeof *m.visits);
  m.slot = memory_take(&own, m.slots, sizeof *m.slot);
  memset(m.slot, -1, sizeof *m.slot * (size_t)m.slots);
  for (int p = 0; p < count; p++) {
    drop_points(&parts[p], to[p]);
    for (int64_t i = 0; i < parts[p].cells.vertices.count; i++) {
      double place[3];
      point_at(&parts[p].cells.vertices, i, place);
      if (to[p][i] < 0)
        continue;
      if (count > 1) {
        to[p][i] = take_point(&m, place, p);
      } else {
        memcpy(m.points + 3 * m.count, place, sizeof place);
        to[p][i] = m.count++;
      }
    }
  }
  memory_release(&own);
  float *floats = (float *)m.points; /* written from the first on, never beyond what has been read */
  for (int64_t i = 0; i < 3 * m.count && single; i++) {
    const float value = (float)m.points[i];
    memcpy(floats + i, &value, sizeof value);
  }
  whole->cells.vertices =
      (TetcastArray){.data = m.points, .type = single ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64, .count = m.count};
}

/* ── cells ── */

typedef struct Growing {
  uint8_t *types;
  int64_t *offsets, *nodes, *faces, *face_offsets, cell, node, face;
} Growing;

static bool append_node(const Part *part, int64_t cell, int64_t node, const int64_t *to, int64_t *place) {
  if (node < 0 || node >= part->cells.vertices.count) {
    cli_error("%s: cell %lld has vertex %lld, but there are %lld vertices", part->path, (long long)cell,
              (long long)node, (long long)part->cells.vertices.count);
    return false;
  }
  *place = to[node];
  return true;
}

static bool append_cell(const Part *part, int64_t i, const int64_t *to, Growing *g) {
  const int64_t size = part_cell_size(part, i);
  const uint8_t type = part->cells.types ? part->cells.types[i] : (uint8_t)part->cells.type;
  g->types[g->cell] = type;
  g->offsets[g->cell] = g->node;
  g->face_offsets[g->cell] = g->face;
  g->cell++;
  for (int64_t k = 0; k < size; k++)
    if (!append_node(part, i, part_cell_node(part, i, k), to, &g->nodes[g->node++]))
      return false;
  if (type != TETCAST_CELL_POLYHEDRON)
    return true;
  const int64_t *list = part->cells.faces.data, *at = list + ((const int64_t *)part->cells.face_offsets.data)[i];
  const int64_t faces = *at++;
  g->faces[g->face++] = faces;
  for (int64_t f = 0; f < faces; f++) {
    int64_t corners = *at++;
    for (g->faces[g->face++] = corners; corners > 0; corners--)
      if (!append_node(part, i, *at++, to, &g->faces[g->face++]))
        return false;
  }
  return true;
}

static bool is_hidden(const Part *part, int64_t i) {
  return part->hidden && part->hidden[i];
}

static bool join_cells(const Part *parts, int count, Part *whole, int64_t *const *to) {
  int64_t cells = 0, nodes = 0, faces = 0;
  for (int p = 0; p < count; p++) {
    cells += parts[p].cell_count;
    faces += parts[p].cells.faces.count;
    for (int64_t i = 0; i < parts[p].cell_count; i++)
      nodes += part_cell_size(&parts[p], i);
  }
  Memory *memory = &whole->memory;
  Growing g = {.types = memory_take(memory, cells, 1),
               .offsets = memory_take(memory, cells + 1, sizeof *g.offsets),
               .nodes = memory_take(memory, nodes, sizeof *g.nodes),
               .faces = memory_take(memory, faces, sizeof *g.faces),
               .face_offsets = memory_take(memory, cells, sizeof *g.face_offsets)};
  for (int p = 0; p < count; p++)
    for (int64_t i = 0; i < parts[p].cell_count; i++)
      if (!is_hidden(&parts[p], i) && !append_cell(&parts[p], i, to[p], &g))
        return false;
  g.offsets[g.cell] = g.node;
  whole->cell_count = g.cell;
  TetcastCellsDesc *desc = &whole->cells;
  desc->types = g.types;
  desc->offsets = (TetcastArray){.data = g.offsets, .type = TETCAST_TYPE_INT64, .count = g.cell + 1};
  desc->connectivity = (TetcastArray){.data = g.nodes, .type = TETCAST_TYPE_INT64, .count = g.node};
  if (faces > 0) {
    desc->faces = (TetcastArray){.data = g.faces, .type = TETCAST_TYPE_INT64, .count = g.face};
    desc->face_offsets = (TetcastArray){.data = g.face_offsets, .type = TETCAST_TYPE_INT64, .count = g.cell};
  }
  return true;
}

/* ── arrays ── */

static const Column *find_column(const Part *part, const Column *like) {
  for (int i = 0; i < part->column_count; i++)
    if (part->columns[i].association == like->association && !strcmp(part->columns[i].name, like->name))
      return &part->columns[i];
  return NULL;
}

/* Values of the whole: those of the first part count where points are of several, and NaN where a part lacks them. */
static void join_values(const Part *parts, int count, int64_t *const *to, const Column *like, bool single,
                        int component, void *values, int64_t total) {
  const bool of_cells = like->association == TETCAST_CELL;
  for (int64_t i = 0; i < total; i++)
    if (single)
      ((float *)values)[i] = (float)NAN;
    else
      ((double *)values)[i] = (double)NAN;
  int64_t end = total;
  for (int p = count; p-- > 0;) {
    const int64_t own = of_cells ? parts[p].cell_count : parts[p].cells.vertices.count;
    const Column *column = find_column(&parts[p], like);
    for (int64_t i = own; i-- > 0;) {
      const int64_t at = !of_cells ? to[p][i] : is_hidden(&parts[p], i) ? -1 : --end;
      if (at < 0 || !column)
        continue;
      const double value = view_value(&column->component[component], i);
      if (single)
        ((float *)values)[at] = (float)value;
      else
        ((double *)values)[at] = value;
    }
  }
}

static void join_column(const Part *parts, int count, Part *whole, int64_t *const *to, const Column *like) {
  const int64_t total = like->association == TETCAST_CELL ? whole->cell_count : whole->cells.vertices.count;
  Column *column = part_add_column(whole, like->name);
  column->association = like->association;
  column->active = like->active;
  column->numbers = like->numbers;
  column->type = like->type;
  int missing = 0;
  for (int p = 0; p < count && !column->fault; p++) {
    const Column *other = find_column(&parts[p], like);
    missing += !other;
    if (other && other->fault)
      column->fault = cli_print("in %s: %s", parts[p].path, other->fault);
    else if (other && other->components != like->components)
      column->fault = cli_print("in %s it has %d components, in %s %d", parts[0].path, like->components, parts[p].path,
                                other->components);
    else if (other && strcmp(other->type, like->type))
      column->type = "float64";
  }
  if (column->fault)
    return;
  if (missing > 0 && strcmp(column->type, "float32"))
    column->type = "float64"; /* which has a NaN */
  if (missing > 0)
    cli_warning("field %s is missing in %d of %d parts, which are transparent then", like->name, missing, count);
  const bool single = !strcmp(column->type, "float32");
  column->components = like->components;
  column->component = cli_allocate(sizeof *column->component * (size_t)like->components);
  if (like->names) {
    column->names = cli_allocate(sizeof *column->names * (size_t)like->components);
    for (int k = 0; k < like->components; k++)
      column->names[k] = cli_duplicate(like->names[k]);
  }
  for (int k = 0; k < like->components; k++) {
    const int64_t size = single ? (int64_t)sizeof(float) : (int64_t)sizeof(double);
    void *values = memory_take(&whole->memory, total, (size_t)size);
    join_values(parts, count, to, like, single, k, values, total);
    column->component[k] =
        (View){.data = values, .type = single ? VIEW_FLOAT32 : VIEW_FLOAT64, .count = total, .stride = size};
  }
}

bool parts_unite(Part *parts, int count, Part *whole) {
  Memory own = {0};
  int64_t **to = memory_take(&own, count, sizeof *to), points = 0;
  for (int p = 0; p < count; p++) {
    to[p] = memory_take(&own, parts[p].cells.vertices.count, sizeof *to[p]);
    points += parts[p].cells.vertices.count;
  }
  bool fine = points < INT32_MAX;
  if (!fine)
    cli_error("%s: %d meshes of %lld points together are more than can be addressed", whole->path, count,
              (long long)points);
  if (fine)
    merge_points(parts, count, whole, to);
  fine = fine && join_cells(parts, count, whole, to);
  for (int of_cells = 0; of_cells < 2 && fine; of_cells++)
    for (int p = 0; p < count; p++)
      for (int i = 0; i < parts[p].column_count; i++) {
        const Column *column = &parts[p].columns[i];
        if ((column->association == TETCAST_CELL) == of_cells && !find_column(whole, column))
          join_column(parts, count, whole, to, column);
      }
  memory_release(&own);
  for (int p = 0; p < count; p++)
    part_release(&parts[p]);
  return fine;
}
