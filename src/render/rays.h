/* SPDX-License-Identifier: Apache-2.0 */
/* Rays as the host has them (cast.h), and as kernels take them. */
#ifndef TC_RENDER_RAYS_H
#define TC_RENDER_RAYS_H

#include <tetcast/cast.h>

#include "walk/ray.h"

/* How the host counts along a ray: t = 1 is a length of length · 2^exponent in the volume's unit; and the ray's own
 * ends. */
typedef struct TcRayUnit {
  double length;
  int exponent;
  double begin, end;
} TcRayUnit;

/* Whether the arrays fit each other, and all rays are some. */
TetcastStatus tc_rays_check(TetcastContext *context, const TetcastRays *rays);

/* Ray i of the list. Like that of a picture's ray, the direction is divided by its length. */
TcLine tc_rays_line(const TetcastRays *rays, const TetcastVolume *volume, int64_t i, TcRayUnit *unit);

/* How far the origins are from the volume's centre, at most, scaled. */
double tc_rays_away(const TetcastRays *rays, const TetcastVolume *volume);

/* A number by which rays are sorted so that neighbours go the same way through the same cells; below 2^31. */
uint32_t tc_rays_key(const TcLine *line, const TetcastVolume *volume);

#endif
