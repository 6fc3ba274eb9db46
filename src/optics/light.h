/* SPDX-License-Identifier: Apache-2.0 */
/* Light on a surface (tetcast/shading.h has the formula). */
#ifndef TC_OPTICS_LIGHT_H
#define TC_OPTICS_LIGHT_H

#include <tetcast/shading.h>

#include <math.h>

#include "base/vec3.h"

/* One direction has been made a unit vector. */
typedef struct TcLighting {
  /* Whether surfaces are lit. */
  bool surfaces;
  /* Whether their normals are interpolated between vertices. */
  bool smooth;
  double ambient, diffuse, specular, exponent;
  /* [light_count]; where there are none, the light is white and at the eye. */
  TetcastLight light[TETCAST_MAX_LIGHTS];
  int light_count;
} TcLighting;

/* What one light adds: *diffuse times the surface's colour, and *specular, both times the light's colour. `cosine` is
 * that between the normal and the light, `half` that between the normal and the direction halfway to the eye. */
static inline void tc_light_reflect(const TcLighting *lighting, double cosine, double half, double *diffuse,
                                    double *specular) {
  *diffuse = lighting->diffuse * fmax(0, cosine);
  *specular = cosine > 0 && half > 0 && lighting->specular > 0 ? lighting->specular * pow(half, lighting->exponent) : 0;
}

/* The colour, as it is seen along the unit vector `along` from the eye, of a surface with this normal on the side that
 * is seen, of any length. An interpolated one may turn away from the eye at the rim of what is seen; it is lit as it
 * stands, so that light changes steadily up to the rim. */
static inline void tc_light_surface(const TcLighting *lighting, const double along[3], const double normal[3],
                                    double color[3]) {
  double n[3] = {normal[0], normal[1], normal[2]};
  const bool any = tc_normalize(n);
  double factor[3] = {lighting->ambient, lighting->ambient, lighting->ambient}, highlight[3] = {0, 0, 0};
  for (int i = 0; i < (lighting->light_count > 0 ? lighting->light_count : 1); ++i) {
    static const TetcastLight at_eye = {.color = {1, 1, 1}};
    const TetcastLight *light = lighting->light_count > 0 ? &lighting->light[i] : &at_eye;
    double cosine = 1, half = 0, diffuse, specular;
    if (any && lighting->light_count == 0) {
      cosine = half = -tc_dot(n, along);
    } else if (any) {
      double middle[3];
      for (int k = 0; k < 3; ++k)
        middle[k] = light->direction[k] - along[k];
      cosine = tc_dot(n, light->direction);
      half = tc_normalize(middle) ? tc_dot(n, middle) : 0;
    }
    tc_light_reflect(lighting, cosine, half, &diffuse, &specular);
    for (int k = 0; k < 3; ++k) {
      factor[k] += diffuse * light->color[k];
      highlight[k] += specular * light->color[k];
    }
  }
  for (int k = 0; k < 3; ++k)
    color[k] = color[k] * factor[k] + highlight[k];
}

/* What no component of a lit colour exceeds, where the surface's is `color`. */
static inline double tc_light_largest(const TcLighting *lighting, double color) {
  double sum = lighting->light_count > 0 ? 0 : 1;
  for (int i = 0; i < lighting->light_count; ++i)
    sum += fmax(lighting->light[i].color[0], fmax(lighting->light[i].color[1], lighting->light[i].color[2]));
  return color * (lighting->ambient + lighting->diffuse * sum) + lighting->specular * sum;
}

#endif
