/* SPDX-License-Identifier: Apache-2.0 */
/* Brute force in extended precision, written anew: where a ray is in a cell, a field's gradient, and light, for tests
 * that compare pictures with what they should be. */
#ifndef BRUTE_H
#define BRUTE_H

#include "world.h"

#include <float.h>

typedef long double Real;

/* A tetrahedron with its scalar: gradient and value from a point. */
typedef struct Linear {
  Real gradient[3], at;
  const double *origin;
} Linear;

/* Where a ray is in a cell, as four half-spaces. */
static inline bool cross_cell(const Cube *cube, int64_t cell, const double eye[3], const double direction[3],
                              Real *from, Real *to) {
  *from = 0;
  *to = INFINITY;
  for (int k = 0; k < 4; ++k) {
    const double *v[4];
    for (int j = 0; j < 4; ++j)
      v[j] = &cube->vertices[3 * cube->cells[4 * cell + (k + j) % 4]]; /* v[0] is opposite the face */
    Real a[3], b[3], normal[3], inside = 0, along = 0, at = 0;
    for (int j = 0; j < 3; ++j)
      a[j] = (Real)v[2][j] - v[1][j], b[j] = (Real)v[3][j] - v[1][j];
    for (int j = 0; j < 3; ++j)
      normal[j] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
    for (int j = 0; j < 3; ++j) {
      inside += normal[j] * ((Real)v[0][j] - v[1][j]);
      along += normal[j] * direction[j];
      at += normal[j] * ((Real)eye[j] - v[1][j]);
    }
    if (inside < 0)
      along = -along, at = -at;
    if (along > 0)
      *from = fmaxl(*from, -at / along);
    else
      *to = fminl(*to, -at / along);
  }
  return *to > *from;
}

/* By Cramer's rule. */
static inline Linear linear_of(const Cube *cube, int64_t cell, const double *values, Real *volume) {
  const int64_t *id = &cube->cells[4 * cell];
  const double *p = &cube->vertices[3 * id[0]];
  Real edge[3][3], rise[3];
  for (int j = 0; j < 3; ++j) {
    rise[j] = (Real)values[id[j + 1]] - values[id[0]];
    for (int k = 0; k < 3; ++k)
      edge[j][k] = (Real)cube->vertices[3 * id[j + 1] + k] - p[k];
  }
#define DET(a, b, c)                                                                                                   \
  ((a)[0] * ((b)[1] * (c)[2] - (b)[2] * (c)[1]) - (a)[1] * ((b)[0] * (c)[2] - (b)[2] * (c)[0]) +                       \
   (a)[2] * ((b)[0] * (c)[1] - (b)[1] * (c)[0]))
  const Real all = DET(edge[0], edge[1], edge[2]);
  Linear linear = {.at = values[id[0]], .origin = p};
  for (int k = 0; k < 3; ++k) {
    Real other[3][3];
    memcpy(other, edge, sizeof other);
    for (int j = 0; j < 3; ++j)
      other[j][k] = rise[j];
    linear.gradient[k] = DET(other[0], other[1], other[2]) / all;
  }
  *volume = fabsl(all);
  return linear;
}

static inline Real value_at(const Linear *linear, const double eye[3], const double direction[3], Real t) {
  Real value = linear->at;
  for (int k = 0; k < 3; ++k)
    value += linear->gradient[k] * (eye[k] + t * direction[k] - linear->origin[k]);
  return value;
}

static inline void normalize(Real v[3]) {
  const Real length = sqrtl(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int k = 0; k < 3; ++k)
    v[k] /= length;
}

/* The formula of shading.h, once more. */
static inline void light_up(const TetcastShadingDesc *d, Real normal[3], const double direction[3], Real color[3]) {
  Real lit[3];
  normalize(normal);
  for (int k = 0; k < 3; ++k)
    lit[k] = d->ambient * color[k];
  for (int i = 0; i < (d->light_count ? d->light_count : 1); ++i) {
    Real l[3], h[3], cosine = 0, half = 0;
    for (int k = 0; k < 3; ++k)
      l[k] = d->light_count ? (Real)d->lights[i].direction[k] : -(Real)direction[k];
    normalize(l);
    for (int k = 0; k < 3; ++k)
      h[k] = l[k] - direction[k];
    normalize(h);
    for (int k = 0; k < 3; ++k)
      cosine += l[k] * normal[k], half += h[k] * normal[k];
    for (int k = 0; k < 3 && cosine > 0; ++k) {
      const Real strength = d->light_count ? d->lights[i].color[k] : 1;
      lit[k] += strength * (d->diffuse * cosine * color[k] + d->specular * powl(fmaxl(half, 0), d->exponent));
    }
  }
  memcpy(color, lit, sizeof lit);
}

/* The gradient at the vertices, the mean of that in the cells there weighted by their volumes; for free(). */
static inline Real (*vertex_gradients(const Cube *cube, const double *values))[3] {
  Real *weight = calloc((size_t)cube->vertex_count, sizeof *weight);
  Real(*gradients)[3] = calloc((size_t)cube->vertex_count, sizeof *gradients);
  for (int64_t cell = 0; cell < cube->cell_count; ++cell) {
    Real volume;
    const Linear linear = linear_of(cube, cell, values, &volume);
    if (isnan(linear.gradient[0]))
      continue;
    for (int j = 0; j < 4; ++j) {
      const int64_t id = cube->cells[4 * cell + j];
      weight[id] += volume;
      for (int k = 0; k < 3; ++k)
        gradients[id][k] += volume * linear.gradient[k];
    }
  }
  for (int64_t i = 0; i < cube->vertex_count; ++i) {
    for (int k = 0; k < 3; ++k)
      gradients[i][k] /= weight[i] > 0 ? weight[i] : 1;
  }
  free(weight);
  return gradients;
}

#endif
