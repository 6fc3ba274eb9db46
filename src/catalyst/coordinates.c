/* SPDX-License-Identifier: Apache-2.0 */
/* Coordinate sets: explicit, uniform and rectilinear. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "part.h"

static const char *const axes[3] = {"x", "y", "z"};

/* ── explicit ── */

/* The coordinate that is not finite, if there is one, is told. */
static bool check_finite(const View axis[3], const char *path) {
  for (int k = 0; k < 3; k++)
    for (int64_t i = 0; i < axis[k].count && view_is_real(&axis[k]); i++) {
      const double value = view_value(&axis[k], i);
      if (isfinite(value))
        continue;
      cli_error("%s/values/%s: number %lld is %g", path, axes[k], (long long)i, value);
      return false;
    }
  return true;
}

/* Whether x, y and z of a point lie next to each other, so that all of them are one array of tuples. */
static bool is_interleaved(const View axis[3]) {
  const int64_t size = view_type_size(axis[0].type);
  for (int k = 1; k < 3; k++)
    if (axis[k].type != axis[0].type || axis[k].stride != axis[0].stride || axis[k].data != axis[0].data + k * size)
      return false;
  return axis[0].stride >= 3 * size;
}

static TetcastArray copy(Memory *memory, const View axis[3], int64_t count) {
  const bool single = axis[0].type == VIEW_FLOAT32 && axis[1].type == VIEW_FLOAT32 && axis[2].type == VIEW_FLOAT32;
  void *data = memory_take(memory, 3 * count, single ? sizeof(float) : sizeof(double));
  for (int k = 0; k < 3; k++)
    for (int64_t i = 0; i < count; i++) {
      const double value = view_value(&axis[k], i);
      if (single)
        ((float *)data)[3 * i + k] = (float)value;
      else
        ((double *)data)[3 * i + k] = value;
    }
  return (TetcastArray){.data = data, .type = single ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64, .count = count};
}

/* The numbers along the three axes. */
static bool read_axes(const ConduitNode *coordset, const char *path, View axis[3]) {
  for (int k = 0; k < 3; k++) {
    char name[16] = "values/";
    strcat(name, axes[k]);
    const ConduitNode *values = conduit_at(coordset, name);
    if (!values && k == 2 && conduit_at(coordset, "values/x")) {
      cli_error("%s: has no values/z: only meshes in space are drawn", path);
      return false;
    }
    if (!values) {
      cli_error("%s: has no values/%s: coordinates are expected as x, y and z", path, axes[k]);
      return false;
    }
    if (!conduit_view(values, &axis[k])) {
      cli_error("%s/values/%s: expected numbers", path, axes[k]);
      return false;
    }
  }
  return true;
}

static bool read_explicit(Part *part, const ConduitNode *coordset, const char *path) {
  View axis[3];
  if (!read_axes(coordset, path, axis))
    return false;
  for (int k = 1; k < 3; k++)
    if (axis[k].count != axis[0].count) {
      cli_error("%s: values/x has %lld numbers, but values/%s has %lld", path, (long long)axis[0].count, axes[k],
                (long long)axis[k].count);
      return false;
    }
  if (!check_finite(axis, path))
    return false;
  if (view_is_real(&axis[0]) && is_interleaved(axis))
    part->cells.vertices = view_array(&axis[0]);
  else
    part->cells.vertices = copy(&part->memory, axis, axis[0].count);
  return true;
}

/* ── grids ── */

static bool check_size(const char *path, const int64_t grid[3]) {
  int64_t count = 1;
  for (int k = 0; k < 3; k++) {
    if (grid[k] < 0 || grid[k] >= INT32_MAX || (grid[k] > 0 && count > INT32_MAX / grid[k])) {
      cli_error("%s: a grid of %lld x %lld x %lld points is more than can be addressed", path, (long long)grid[0],
                (long long)grid[1], (long long)grid[2]);
      return false;
    }
    count *= grid[k];
  }
  return true;
}

static TetcastArray take_grid(Memory *memory, const int64_t grid[3], double **points) {
  const int64_t count = grid[0] * grid[1] * grid[2];
  *points = memory_take(memory, 3 * count, sizeof **points);
  return (TetcastArray){.data = *points, .type = TETCAST_TYPE_FLOAT64, .count = count};
}

static bool read_rectilinear(Part *part, const ConduitNode *coordset, const char *path, int64_t grid[3]) {
  View axis[3];
  double *point;
  if (!read_axes(coordset, path, axis) || !check_finite(axis, path))
    return false;
  for (int k = 0; k < 3; k++)
    grid[k] = axis[k].count;
  if (!check_size(path, grid))
    return false;
  part->cells.vertices = take_grid(&part->memory, grid, &point);
  for (int64_t k = 0; k < grid[2]; k++)
    for (int64_t j = 0; j < grid[1]; j++)
      for (int64_t i = 0; i < grid[0]; i++) {
        *point++ = view_value(&axis[0], i);
        *point++ = view_value(&axis[1], j);
        *point++ = view_value(&axis[2], k);
      }
  return true;
}

/* A number of a uniform grid, `value` as it is where there is none. */
static bool read_number(const ConduitNode *coordset, const char *path, const char *name, double *value) {
  const ConduitNode *node = conduit_at(coordset, name);
  if (!node || (conduit_number(node, value) && isfinite(*value)))
    return true;
  cli_error("%s/%s: expected a finite number", path, name);
  return false;
}

static bool read_uniform(Part *part, const ConduitNode *coordset, const char *path, int64_t grid[3]) {
  static const char *const dims[3] = {"dims/i", "dims/j", "dims/k"},
                           *const origins[3] = {"origin/x", "origin/y", "origin/z"},
                           *const spacings[3] = {"spacing/dx", "spacing/dy", "spacing/dz"};
  double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1}, *point;
  for (int k = 0; k < 3; k++) {
    grid[k] = 1;
    const ConduitNode *node = conduit_at(coordset, dims[k]);
    if ((node || k == 0) && (!node || !conduit_integer(node, &grid[k]))) {
      cli_error("%s/%s: expected a whole number of points", path, dims[k]);
      return false;
    }
    if (!read_number(coordset, path, origins[k], &origin[k]) || !read_number(coordset, path, spacings[k], &spacing[k]))
      return false;
  }
  if (!check_size(path, grid))
    return false;
  part->cells.vertices = take_grid(&part->memory, grid, &point);
  for (int64_t k = 0; k < grid[2]; k++)
    for (int64_t j = 0; j < grid[1]; j++)
      for (int64_t i = 0; i < grid[0]; i++) {
        *point++ = (double)i * spacing[0] + origin[0];
        *point++ = (double)j * spacing[1] + origin[1];
        *point++ = (double)k * spacing[2] + origin[2];
      }
  return true;
}

bool coordinates_read(Part *part, const ConduitNode *coordset, const char *path, int64_t grid[3]) {
  const char *type = conduit_text(conduit_at(coordset, "type"));
  grid[0] = grid[1] = grid[2] = 0;
  if (type && !strcmp(type, "explicit"))
    return read_explicit(part, coordset, path);
  if (type && !strcmp(type, "uniform"))
    return read_uniform(part, coordset, path, grid);
  if (type && !strcmp(type, "rectilinear"))
    return read_rectilinear(part, coordset, path, grid);
  cli_error("%s/type: expected explicit, uniform or rectilinear, not '%s'", path, type ? type : "");
  return false;
}
