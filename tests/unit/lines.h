/* SPDX-License-Identifier: Apache-2.0 */
/* Lists of rays for tests, as the library takes them. */
#ifndef LINES_H
#define LINES_H

#include "brute.h"

typedef struct Lines {
  int64_t count;
  double (*origin)[3], (*direction)[3], *begin, *end; /* [count] */
} Lines;

static inline Lines lines_create(int64_t count) {
  Lines lines = {.count = count};
  const size_t room = (size_t)count + 1;
  lines.origin = calloc(room, sizeof *lines.origin);
  lines.direction = calloc(room, sizeof *lines.direction);
  lines.begin = calloc(room, sizeof *lines.begin);
  lines.end = calloc(room, sizeof *lines.end);
  for (int64_t i = 0; i < count; ++i)
    lines.end[i] = INFINITY;
  return lines;
}

static inline void lines_destroy(Lines *lines) {
  free(lines->origin);
  free(lines->direction);
  free(lines->begin);
  free(lines->end);
}

static inline TetcastRays rays_of(const Lines *lines) {
  TetcastRays rays = tetcast_rays_default();
  rays.origins = (TetcastArray){lines->origin, TETCAST_TYPE_FLOAT64, lines->count, 0};
  rays.directions = (TetcastArray){lines->direction, TETCAST_TYPE_FLOAT64, lines->count, 0};
  rays.begins = (TetcastArray){lines->begin, TETCAST_TYPE_FLOAT64, lines->count, 0};
  rays.ends = (TetcastArray){lines->end, TETCAST_TYPE_FLOAT64, lines->count, 0};
  return rays;
}

/* Through a picture's pixels. */
static inline Lines lines_of_picture(const TetcastCamera *camera, int width, int height) {
  Lines lines = lines_create((int64_t)width * height);
  for (int i = 0; i < width * height; ++i)
    ray_of(camera, width, height, i, lines.origin[i], lines.direction[i]);
  return lines;
}

/* Through two random points of the cube of edge `size`, from outside and inside, in either direction, of any length. */
static inline Lines random_lines(int64_t count, double size, uint64_t seed) {
  Lines lines = lines_create(count);
  for (int64_t i = 0; i < count; ++i) {
    const double length = power(&seed, -3, 3), back = i % 3 == 0 ? 0 : 5;
    for (int k = 0; k < 3; ++k) {
      const double from = uniform(&seed), to = uniform(&seed);
      lines.direction[i][k] = length * size * (to - from);
      lines.origin[i][k] = size * (from - back * (to - from));
    }
  }
  return lines;
}

/* Exactly through a vertex, along an edge, and within a face of cells of the cube. */
static inline Lines special_lines(const Cube *cube, int64_t count, uint64_t seed) {
  Lines lines = lines_create(count);
  for (int64_t i = 0; i < count; ++i) {
    const int64_t cell = (int64_t)(uniform(&seed) * (double)cube->cell_count);
    const double *a = &cube->vertices[3 * cube->cells[4 * cell]], *b = &cube->vertices[3 * cube->cells[4 * cell + 1]],
                 *c = &cube->vertices[3 * cube->cells[4 * cell + 2]];
    for (int k = 0; k < 3; ++k) {
      const double other[4] = {uniform(&seed) - 0.5, b[k] - a[k], c[k] - b[k], (b[k] + c[k]) / 2 - a[k]};
      lines.direction[i][k] = other[i % 4];
      lines.origin[i][k] = (i % 4 == 2 ? b[k] : a[k]) - 4 * other[i % 4];
    }
  }
  return lines;
}

/* So many threads, all else as it is. */
static inline void use_threads(TetcastContext *context, int threads) {
  assert_int_equal(tetcast_context_set_threads(context, threads), TETCAST_OK);
}

#endif
