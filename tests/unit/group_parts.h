/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh with coefficients, the same at each vertex and in each cell whatever part it is in. */
#ifndef GROUP_PARTS_H
#define GROUP_PARTS_H

#include "partition.h"

/* How many extinctions and emissions there are, which of them are of cells (bit 0, bit 1), and how large they are. */
typedef struct Groups {
  int extinction, emission, of_cells;
  double size;
} Groups;

enum { MOST_GROUPS = 40 };

static inline int group_count(const Groups *groups) {
  return groups->extinction > groups->emission ? groups->extinction : groups->emission;
}

/* One of a vertex or a cell: between 0 and `size`, an emission between −size / 2 and that. */
static inline double group_value(const Groups *groups, int emission, int group, int64_t id) {
  uint64_t seed = (uint64_t)(id * 2 * MOST_GROUPS + 2 * group + emission);
  uniform(&seed);
  return groups->size * (uniform(&seed) - (emission ? 0.5 : 0));
}

/* Gives a scene coefficients; `points` and `cells` are the numbers that its vertices and cells have in the whole. */
static inline void set_groups(TetcastContext *context, TetcastScene *scene, const Groups *groups, const int64_t *points,
                              int64_t point_count, const int64_t *cells, int64_t cell_count) {
  TetcastField *fields[2][MOST_GROUPS];
  const int counts[2] = {groups->extinction, groups->emission};
  double *values = malloc((size_t)(point_count + cell_count) * sizeof *values);
  for (int l = 0; l < 2; ++l) {
    const bool of_cells = groups->of_cells >> l & 1;
    const int64_t count = of_cells ? cell_count : point_count, *ids = of_cells ? cells : points;
    for (int g = 0; g < counts[l]; ++g) {
      for (int64_t i = 0; i < count; ++i)
        values[i] = group_value(groups, l, g, ids[i]);
      fields[l][g] = field_of(context, values, count, of_cells ? TETCAST_CELL : TETCAST_POINT);
    }
  }
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = (const TetcastField *const *)fields[0];
  desc.emission = (const TetcastField *const *)fields[1];
  desc.extinction_count = counts[0];
  desc.emission_count = counts[1];
  assert_int_equal(tetcast_scene_set_coefficients(scene, &desc), TETCAST_OK);
  for (int l = 0; l < 2; ++l) {
    for (int g = 0; g < counts[l]; ++g)
      tetcast_field_destroy(&fields[l][g]);
  }
  free(values);
}

/* The part of one owner's cells. */
static inline Part group_part(TetcastContext *context, const Cube *cube, const int *owner, int which,
                              const Groups *groups, uint64_t *seed) {
  Part part = {NULL, NULL};
  Cube numbered = *cube; /* whose values are the numbers of the vertices */
  double *numbers = malloc(2 * (size_t)cube->vertex_count * sizeof *numbers);
  int64_t *points = malloc((size_t)cube->vertex_count * sizeof *points), cells = 0;
  int64_t *cell = malloc((size_t)cube->cell_count * sizeof *cell);
  for (int64_t i = 0; i < cube->vertex_count; ++i)
    numbers[i] = (double)i;
  numbered.values = numbers;
  TetcastMesh *mesh = mesh_of_owner(context, &numbered, owner, which, seed, numbers + cube->vertex_count);
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    if (owner[i] == which)
      cell[cells++] = i;
  }
  if (mesh) {
    const int64_t count = tetcast_mesh_vertex_count(mesh);
    TetcastVolumeDesc desc = tetcast_volume_desc_default();
    desc.bounds = unit_bounds;
    for (int64_t i = 0; i < count; ++i)
      points[i] = (int64_t)numbers[cube->vertex_count + i];
    assert_int_equal(tetcast_volume_create(context, mesh, &desc, &part.volume), TETCAST_OK);
    assert_int_equal(tetcast_scene_create(context, part.volume, &part.scene), TETCAST_OK);
    set_groups(context, part.scene, groups, points, count, cell, cells);
    tetcast_mesh_destroy(&mesh);
  }
  free(numbers);
  free(points);
  free(cell);
  return part;
}

static const uint32_t group_channels = TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH |
                                       TETCAST_CHANNEL_TRANSMITTANCE | TETCAST_CHANNEL_PATH_LENGTH;

/* Compares a picture of parts and its channels with that of the whole, which has a bound on the error as well; it is
 * one on that of each group's radiance, too. `most` is the largest emission times length. Where a ray's optical depth
 * is large, as much of it as rounding may add or take away is seen in what lies behind. */
static inline void check_groups(const TetcastFrame *whole, const TetcastFrame *parts, double most) {
  const int64_t pixels = tetcast_frame_width(whole) * tetcast_frame_height(whole);
  const int groups = tetcast_frame_groups(whole);
  const double *a = tetcast_frame_pixels(whole), *b = tetcast_frame_pixels(parts),
               *error = tetcast_frame_channel(whole, TETCAST_CHANNEL_ERROR),
               *depth = tetcast_frame_channel(whole, TETCAST_CHANNEL_OPTICAL_DEPTH);
  for (int64_t i = 0; i < 4 * pixels; ++i) {
    if (!(fabs(a[i] - b[i]) <= 2 * error[i / 4]))
      fail_msg("pixel %d: %.17g, not %.17g, bound %g", (int)(i / 4), b[i], a[i], error[i / 4]);
  }
  for (uint32_t bit = TETCAST_CHANNEL_RADIANCE; bit <= TETCAST_CHANNEL_PATH_LENGTH; bit *= 2) {
    const int width = bit == TETCAST_CHANNEL_PATH_LENGTH ? 1 : groups;
    double largest = 0;
    a = tetcast_frame_channel(whole, (TetcastChannel)bit);
    b = tetcast_frame_channel(parts, (TetcastChannel)bit);
    for (int64_t i = 0; i < width * pixels; ++i)
      largest = fmax(largest, fabs(a[i]));
    for (int64_t i = 0; i < width * pixels; ++i) {
      const bool radiance = bit == TETCAST_CHANNEL_RADIANCE;
      const double thick = radiance || bit == TETCAST_CHANNEL_TRANSMITTANCE ? fmax(1, depth[i]) : 1,
                   off = fabs(a[i] - b[i]);
      if (!(off <= 5e-15 * thick * (radiance ? most : largest)) || (radiance && !(off <= 2 * error[i / groups])))
        fail_msg("channel %d, %d: %.17g, not %.17g; the largest %g, bound %g", (int)bit, (int)i, b[i], a[i],
                 radiance ? most : largest, error[i / groups]);
    }
  }
}

#endif
