/* SPDX-License-Identifier: Apache-2.0 */
/* Light where a normal is known: on a surface, at a vertex (tetcast/shading.h has the formula). */
#ifndef TC_OPTICS_LIGHT_H
#define TC_OPTICS_LIGHT_H

#include <tetcast/shading.h>

#include <math.h>

#include "base/vec3.h"

/* Shares and lights' colours that are larger count as this, so that a colour up to 2^500 in all the light there can be
 * doesn't overflow. */
#define TC_LARGEST_LIGHT 0x1p200

/* Directions are unit vectors. */
typedef struct TcLighting {
  /* Whether surfaces are lit, and whether the volume is. */
  bool surfaces, volume;
  /* Whether the volume's shadows fall on what is lit. */
  bool shadows;
  /* In how many directions the volume is looked through for the share of the ambient light that arrives; 0: none. */
  int occlusion_rays;
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

/* What is seen of a colour c is c · factor + highlight. */
typedef struct TcReflection {
  double factor[3], highlight[3];
} TcReflection;

/* The light that is seen along the unit vector `along` from the eye where this is the normal, of any length, on the
 * side that is seen. An interpolated one may turn away from the eye at the rim of what is seen; it is lit as it stands,
 * so that light changes steadily up to the rim. open[0] is the share of the ambient light that arrives there, open[1 +
 * i] that of light i; NULL: all of it. */
static inline TcReflection tc_light_reflection(const TcLighting *lighting, const double along[3],
                                               const double normal[3], const double *open) {
  double n[3] = {normal[0], normal[1], normal[2]};
  const bool any = tc_normalize(n);
  const double ambient = open ? open[0] * lighting->ambient : lighting->ambient;
  TcReflection result = {{ambient, ambient, ambient}, {0, 0, 0}};
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
    const double share = open && lighting->light_count > 0 ? open[1 + i] : 1;
    for (int k = 0; k < 3; ++k) {
      result.factor[k] += share * diffuse * light->color[k];
      result.highlight[k] += share * specular * light->color[k];
    }
  }
  return result;
}

/* Whether all light has the same red, green and blue. */
static inline bool tc_light_is_gray(const TcLighting *lighting) {
  bool gray = true;
  for (int i = 0; i < lighting->light_count; ++i) {
    const double *color = lighting->light[i].color;
    gray = gray && color[0] == color[1] && color[1] == color[2];
  }
  return gray;
}

/* What no component of a lit colour exceeds, where `color` is what it is lit. */
static inline double tc_light_largest(const TcLighting *lighting, double color) {
  double sum = lighting->light_count > 0 ? 0 : 1;
  for (int i = 0; i < lighting->light_count; ++i)
    sum += fmax(lighting->light[i].color[0], fmax(lighting->light[i].color[1], lighting->light[i].color[2]));
  return color * (lighting->ambient + lighting->diffuse * sum) + lighting->specular * sum;
}

#endif
