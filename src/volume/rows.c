/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/rows.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/mesh.h"
#include "optics/transfer.h"

enum { GRAIN = 1 << 14, CLUSTER_GRAIN = 256, AHEAD = 32 };

static size_t bytes_of(const TcRows *rows) {
  const size_t number = rows->is_double ? sizeof(double) : sizeof(float);
  return sizeof *rows + (size_t)rows->count * (size_t)rows->width * number +
         (rows->range ? (size_t)rows->volume->clusters.count * sizeof *rows->range : 0);
}

static void destroy(TcRows *rows) {
  TetcastContext *context = rows->volume->context;
  tc_release(context, rows->data);
  tc_release(context, rows->range);
  tc_release(context, rows);
}

/* From here on others may find them. */
static void share(TcRows *rows, int64_t serial) {
  tc_shared_add(rows->volume->shared, &rows->entry, rows, serial, bytes_of(rows));
}

void tc_rows_retain(TcRows *rows) {
  tc_shared_retain(rows->volume->shared, &rows->entry);
}

void tc_rows_release(TcRows *rows) {
  if (rows && tc_shared_release(rows->volume->shared, &rows->entry))
    destroy(rows);
}

/* ── taking values ── */

typedef struct Take {
  TcRows *rows;
  const TetcastField *const *fields; /* [width] */
  TetcastAssociation association;    /* of the rows */
  TcTask *fill;
  const uint32_t *source; /* [count]: where the mesh has them */
  double scale;
  bool clamp;
} Take;

static double kept(const Take *take, double value) {
  if (!isfinite(value))
    return (double)NAN;
  return take->clamp ? fmax(-TC_LARGEST_VALUE, fmin(value, TC_LARGEST_VALUE)) : value * take->scale;
}

/* Fills rows of corners from a field of corners: the four values of the mesh's cell, in the order that its vertices
 * have in the volume. */
static bool take_corner_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  const uint8_t *order = take->rows->volume->corner_order;
  for (int64_t i = begin; i < end; ++i) {
    for (int k = 0; k < 4; ++k) {
      const double value =
          kept(take, tc_field_at(take->fields[0], 4 * (int64_t)take->source[i] + (order[i] >> 2 * k & 3)));
      if (take->rows->is_double)
        ((double *)take->rows->data)[4 * i + k] = value;
      else
        ((float *)take->rows->data)[4 * i + k] = (float)value;
    }
  }
  return true;
}

/* Fills rows of corners from a field of points, if vertices at one place have different values. */
static bool take_vertex_corner_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i) {
    for (int k = 0; k < 4; ++k) {
      const double value = kept(take, tc_field_at(take->fields[0], take->rows->volume->corner_vertices[i][k]));
      if (take->rows->is_double)
        ((double *)take->rows->data)[4 * i + k] = value;
      else
        ((float *)take->rows->data)[4 * i + k] = (float)value;
    }
  }
  return true;
}

bool tc_field_jumps(const TetcastVolume *volume, const TetcastField *field) {
  for (int64_t i = 0; i < volume->weld_count && field->association == TETCAST_POINT; ++i) {
    const double a = tc_field_at(field, volume->welds[i].vertex), b = tc_field_at(field, volume->welds[i].with);
    if (a != b && (isfinite(a) || isfinite(b)))
      return true;
  }
  return false;
}

static bool take_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  const int width = take->rows->width;
  const TetcastArray *first = &take->fields[0]->values;
  for (int64_t i = begin; i < end; ++i) {
    if (i + AHEAD < end)
      __builtin_prefetch((const char *)first->data + take->source[i + AHEAD] * first->stride);
    for (int k = 0; k < width; ++k) {
      const double value = kept(take, tc_field_at(take->fields[k], take->source[i]));
      if (take->rows->is_double)
        ((double *)take->rows->data)[i * width + k] = value;
      else
        ((float *)take->rows->data)[i * width + k] = (float)value;
    }
  }
  return true;
}

/* Allocates rows and fills them. */
static TetcastStatus create(const TetcastVolume *volume, Take *take, int width, TcRows **out) {
  TetcastContext *context = volume->context;
  TcRows *rows;
  if (!tc_allocate_array(context, (void **)&rows, 1, sizeof *rows, "field"))
    return TETCAST_ERROR_MEMORY;
  const bool point = take->association == TETCAST_POINT;
  *rows = (TcRows){.volume = volume,
                   .association = take->association,
                   .width = width,
                   .count = point ? volume->vertex_count : volume->cell_count};
  const int fields = take->association == TETCAST_CORNER ? 1 : width;
  for (int k = 0; k < fields; ++k)
    rows->is_double |= take->fields[k]->values.type != TETCAST_TYPE_FLOAT32;
  const size_t size = (size_t)width * (rows->is_double ? sizeof(double) : sizeof(float));
  /* One row more, which lanes without a ray read, and room for a vector that reaches beyond the last row. */
  if (!tc_allocate_array(context, &rows->data, rows->count + 1 + 128 / (int64_t)size, size, "values of a field")) {
    tc_release(context, rows);
    return TETCAST_ERROR_MEMORY;
  }
  memset((char *)rows->data + (size_t)rows->count * size, 0, (1 + 128 / size) * size);
  take->rows = rows;
  take->source = point ? volume->vertex_source : volume->adjacency.source;
  tc_parallel_for(context, rows->count, GRAIN, take->fill, take, NULL);
  *out = rows;
  return TETCAST_OK;
}

TetcastStatus tc_rows_of_fields(const TetcastVolume *volume, const TetcastField *const *fields, int width,
                                TcRows **rows) {
  Take take = {.fields = fields, .association = fields[0]->association, .fill = take_rows, .scale = 1, .clamp = true};
  const TetcastStatus status = create(volume, &take, width, rows);
  if (!status)
    share(*rows, 0);
  return status;
}

/* ── ranges of clusters ── */

static void extend(double range[2], double value) { /* NaN does nothing */
  if (value < range[0])
    range[0] = value;
  if (value > range[1])
    range[1] = value;
}

static bool take_ranges(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const TcRows *rows = data;
  const TetcastVolume *volume = rows->volume;
  for (int64_t c = begin; c < end; ++c) {
    double range[2] = {INFINITY, -INFINITY};
    if (rows->association != TETCAST_POINT) {
      const int64_t first = (c << TC_CLUSTER_BITS) * rows->width,
                    count = tc_cluster_size(&volume->adjacency, c) * rows->width;
      for (int64_t i = 0; i < count; ++i)
        extend(range, tc_rows_number(rows, first + i));
    } else {
      uint32_t vertices[TC_CLUSTER][4];
      const int count = tc_cluster_cells(&volume->clusters, &volume->adjacency, c, vertices);
      for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 4; ++k)
          extend(range, tc_rows_value(rows, vertices[i][k], 0));
      }
    }
    /* Each end is moved outwards by one float, as conversion rounds to the nearest. */
    rows->range[c][0] = range[0] <= range[1] ? nextafterf((float)range[0], -INFINITY) : INFINITY;
    rows->range[c][1] = range[0] <= range[1] ? nextafterf((float)range[1], INFINITY) : -INFINITY;
  }
  return true;
}

static TetcastStatus check_scalar(const TetcastVolume *volume, const TetcastField *field) {
  const bool point = field->association == TETCAST_POINT, corner = field->association == TETCAST_CORNER;
  const int64_t wanted = point ? volume->vertex_count : volume->mesh_cell_count, each = corner ? 4 : 1;
  if (field->values.count != each * wanted) {
    return tc_error(volume->context, TETCAST_ERROR_ARGUMENT,
                    "the field has %" PRId64 " values, the mesh %" PRId64 " %s%s", field->values.count, wanted,
                    point ? "vertices" : "tetrahedra", corner ? " of four corners" : "");
  }
  if (corner && !volume->corner_order) {
    return tc_error(volume->context, TETCAST_ERROR_ARGUMENT,
                    "a field of corners needs a volume made for it: TetcastVolumeDesc.corners");
  }
  return TETCAST_OK;
}

TetcastStatus tc_rows_of_scalar(const TetcastVolume *volume, const TetcastField *field, TcRows **out) {
  const TetcastStatus checked = check_scalar(volume, field);
  if (checked)
    return checked;
  const int64_t serial = field->memory ? field->serial : 0; /* a borrowed array may have changed */
  if (serial && (*out = tc_shared_find(volume->shared, serial)))
    return TETCAST_OK;
  double range[2];
  int64_t nonfinite;
  tc_field_range(field, range, &nonfinite);
  const double largest = fmax(fabs(range[0]), fabs(range[1]));
  const bool tiny = largest > 0 && largest < ldexp(1, -TC_TINY_FIELD);
  const int exponent = tiny ? -TC_TINY_FIELD : largest > TC_LARGEST_SCALAR ? TC_HUGE_FIELD : 0;
  Take take = {.fields = &field, .association = field->association, .fill = take_rows, .scale = ldexp(1, -exponent)};
  if (field->association == TETCAST_CORNER)
    take.fill = take_corner_rows;
  if (tc_field_jumps(volume, field)) {
    take.association = TETCAST_CORNER;
    take.fill = take_vertex_corner_rows;
  }
  TcRows *rows;
  const TetcastStatus status = create(volume, &take, take.association == TETCAST_CORNER ? 4 : 1, &rows);
  if (status)
    return status;
  rows->exponent = exponent;
  rows->largest = largest * take.scale;
  rows->has_holes = nonfinite > 0;
  const int64_t clusters = volume->clusters.seeds ? volume->clusters.count : 0;
  if (clusters > 0 &&
      !tc_allocate_array(volume->context, (void **)&rows->range, clusters, sizeof *rows->range, "ranges of a field")) {
    destroy(rows);
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(volume->context, clusters, CLUSTER_GRAIN, take_ranges, rows, NULL);
  share(rows, serial);
  *out = rows;
  return TETCAST_OK;
}

void tc_rows_points(const TetcastVolume *volume, const TcRows *rows, int64_t begin, int64_t end, double (*points)[4]) {
  const bool of_points = rows && rows->association == TETCAST_POINT;
  for (int64_t i = begin; i < end; ++i) {
    tc_volume_vertex(volume, (uint32_t)i, points[i - begin]);
    points[i - begin][3] = of_points ? tc_rows_value(rows, i, 0) : 0;
  }
}
