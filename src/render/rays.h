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

/* A list of rays, and what is the same for all of them. */
typedef struct TcRayList {
  const TetcastRays *rays;
  const TetcastVolume *volume;
  int64_t origin_stride, direction_stride;
  double scale[2]; /* whose product is 2^−(the volume's exponent), as that may be no number */
} TcRayList;

/* Whether the arrays fit each other, and all rays are some. */
TetcastStatus tc_rays_check(TetcastContext *context, const TetcastRays *rays);

/* The list of rays that have been checked. */
TcRayList tc_rays_list(const TetcastRays *rays, const TetcastVolume *volume);

/* Ray i of the list. Like that of a picture's ray, the direction is divided by its length. */
void tc_rays_line(const TcRayList *list, int64_t i, TcLine *line, TcRayUnit *unit);

/* Has ray i fetched from memory, so that it is there when it is asked for soon. */
static inline void tc_rays_expect(const TcRayList *list, int64_t i) {
  __builtin_prefetch((const char *)list->rays->origins.data + i * list->origin_stride);
  __builtin_prefetch((const char *)list->rays->directions.data + i * list->direction_stride);
}

/* How far the origins are from the volume's centre, at most, scaled. */
double tc_rays_away(const TcRayList *list);

/* A number by which rays are sorted so that neighbours go the same way through the same cells; below 2^31. */
uint32_t tc_rays_key(const TcRayList *list, int64_t i);

#endif
