/* SPDX-License-Identifier: Apache-2.0 */
/* Sets up rays, one in each lane. This is done in double precision, whatever rays are walked in. */
#ifndef TC_WALK_PLACE_H
#define TC_WALK_PLACE_H

#include "base/exact.h"
#include "walk/packet.h"

/* Rays as they are asked for (TcLine). */
typedef struct TcLines {
  TcWide eye[3], offset[3], direction[3], begin, end;
  TcWide x, y; /* with projected vertices: the ray's place on the screen, in pixels from (x0, y0) (screen.h) */
} TcLines;

/* Rays that have been set up. */
typedef struct TcPlaced {
  TcLines lines;
  TcWide from_center[3]; /* from the volume's centre to the point of the ray that is nearest to it */
  TcWide near;           /* the distance of this point from eye + offset */
  TcWide begin, end;     /* the interval that counts, as depths from this point */
  TcWide
      slice[TETCAST_MAX_SLICES]; /* the depths from this point at which the ray meets slices; NaN, infinite: nowhere */
  TcWide shift;                  /* the depth of this point, as packets count it */
  TcWide doubt;                  /* how far off the interval's ends may be, in all (interval.h) */
  TcWide origin[3], rest[3];     /* in ray space: the same point, as the sum of these two */
  int64_t destination[TC_LANES]; /* where what the ray gathers is added (kernel.c) */
  unsigned lanes;                /* the lanes of rays that may meet the volume and are still to be taken */
} TcPlaced;

/* Sets up the rays of camera `view` through the positions (u, v) of the picture. */
static void tc_view_lines(const TcView *view, const TcWide *u, const TcWide *v, TcLines *lines) {
  for (int k = 0; k < 3; ++k) {
    const TcWide shift = *u * view->right[k] + *v * view->up[k];
    lines->eye[k] = tc_set_wide(view->eye[k]);
    lines->offset[k] = view->orthographic ? shift : tc_set_wide(0);
    lines->direction[k] = view->orthographic ? tc_set_wide(view->forward[k]) : view->forward[k] + shift;
  }
  if (view->orthographic)
    return;
  const TcWide *d = lines->direction, length = tc_sqrt_wide(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (int k = 0; k < 3; ++k)
    lines->direction[k] /= length;
}

/* In ray space: computes eye + offset + near · direction as origin + rest, to twice the precision. So the point is on
 * the ray whatever `near` was rounded to, and vertex − origin is as exact as the vertex. */
TC_NOINLINE void tc_place_exactly(const TetcastVolume *volume, TcPlaced *placed) {
  const TcLines *lines = &placed->lines;
  for (int k = 0; k < 3; ++k) {
    TC_EACH_LANE {
      const double eye = TC_AT(lines->eye[k], l), offset = TC_AT(lines->offset[k], l),
                   direction = TC_AT(lines->direction[k], l);
      const double along = TC_AT(placed->near, l), product = along * direction, shift = product + offset,
                   origin = eye + shift;
      const double rest = tc_product_error(along, direction, product) + tc_sum_error(product, offset, shift) +
                          tc_sum_error(eye, shift, origin);
      const double kept = origin > -TC_TINY && origin < TC_TINY ? 0 : origin;
      TC_AT(placed->rest[k], l) = rest;
      TC_AT(placed->origin[k], l) = kept;
      TC_AT(placed->from_center[k], l) = kept - volume->center[k] + rest;
    }
  }
}

/* Finds the rays' points nearest to the volume's centre, and leaves out rays that pass by the volume's sphere, rays of
 * which the interval that counts does, and rays with NaN. The sphere's radius has a margin that covers the rounding
 * here. With projected vertices only Embree needs the points, so they need not be as exact as in ray space. */
static void tc_place(const TcGround *ground, TcPlaced *placed) {
  const TetcastVolume *volume = ground->shell->volume;
  const TcLines *lines = &placed->lines;
  TcWide *p = placed->from_center, along = tc_set_wide(0);
  for (int k = 0; k < 3; ++k) {
    p[k] = (lines->eye[k] - volume->center[k]) + lines->offset[k];
    along -= p[k] * lines->direction[k];
  }
  placed->near = along;
  for (int k = 0; k < 3; ++k)
    p[k] += along * lines->direction[k];
  if (!ground->screen)
    tc_place_exactly(volume, placed);
  placed->begin = lines->begin - along;
  placed->end = lines->end - along;
  placed->doubt = tc_set_wide(0);
  const TcWide radius = tc_set_wide(volume->radius);
  const unsigned inside = tc_wide_le(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], radius * radius);
  placed->lanes &= inside & tc_wide_le(placed->begin, radius) & tc_wide_le(-radius, placed->end);
}

/* Converts rays for the walk with projected vertices. */
static void tc_take_screen(const TcScreen *screen, TcPlaced *placed, TcRays *rays) {
  const TcLines *lines = &placed->lines;
  TcWide shift = tc_set_wide(0), along = shift; /* depth of the points that were placed, from the centre's plane */
  for (int k = 0; k < 3; ++k) {
    shift += placed->from_center[k] * screen->forward[k];
    along += lines->direction[k] * screen->forward[k];
  }
  rays->scale = tc_set(1);
  if (screen->perspective) {
    rays->scale = tc_real_of_wide(-screen->distance / along);
    shift /= along;
  }
  placed->shift = shift;
  rays->begin = tc_real_of_wide(placed->begin + shift);
  rays->end = tc_real_of_wide(placed->end + shift);
#if TC_SINGLE
  TC_EACH_LANE TC_AT(rays->x, l) = (int32_t)rint(TC_AT(lines->x, l) * screen->unit);
  TC_EACH_LANE TC_AT(rays->y, l) = (int32_t)rint(TC_AT(lines->y, l) * screen->unit);
#else
  rays->x = lines->x;
  rays->y = lines->y;
#endif
}

#if !TC_SINGLE
/* Converts rays for the walk in ray space. The largest component of all their directions is kz. */
TC_NOINLINE void tc_take_ray_space(TcPlaced *placed, int kz, TcRays *rays) {
  const TcWide *direction = placed->lines.direction, *origin = placed->origin, *rest = placed->rest;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const TcVec tiny = tc_set(TC_TINY), zero = tc_set(0), dz = direction[kz];
#define TC_NOT_TINY(x) tc_select(tc_lt(tc_abs(x), tiny), zero, x)
  rays->kz = kz;
  rays->scale = tc_set(1);
  rays->origin[0] = origin[kx];
  rays->origin[1] = origin[ky];
  rays->origin[2] = origin[kz];
  rays->shear_x = TC_NOT_TINY(direction[kx] / dz);
  rays->shear_y = TC_NOT_TINY(direction[ky] / dz);
  rays->inverse_z = 1 / dz;
  rays->rest_x = TC_NOT_TINY(rest[kx] - rays->shear_x * rest[kz]);
  rays->rest_y = TC_NOT_TINY(rest[ky] - rays->shear_y * rest[kz]);
  rays->rest_z = rest[kz] * rays->inverse_z;
  placed->shift = zero;
  rays->begin = placed->begin;
  rays->end = placed->end;
#undef TC_NOT_TINY
}

/* Finds the largest component *kz of the direction of the first ray, and returns the lanes whose directions are largest
 * in the same component. */
static unsigned tc_along_one_axis(const TcLines *lines, unsigned lanes, int *kz) {
  unsigned result = 0;
  for (unsigned left = lanes; left; left &= left - 1) {
    const int l = __builtin_ctz(left);
    const double x = fabs(TC_AT(lines->direction[0], l)), y = fabs(TC_AT(lines->direction[1], l)),
                 z = fabs(TC_AT(lines->direction[2], l));
    const int axis = z > (y > x ? y : x) ? 2 : y > x;
    if (!result)
      *kz = axis;
    if (axis == *kz)
      result |= 1U << l;
  }
  return result;
}
#endif

/* Takes rays out of *placed and converts them for the walk; returns their lanes. In ray space these are rays with the
 * same main axis, so that it may need several calls to take all. */
static unsigned tc_take(const TcGround *ground, TcPlaced *placed, TcRays *rays) {
  unsigned lanes = placed->lanes;
  rays->doubt = tc_real_of_wide(placed->doubt);
#if TC_SINGLE
  /* Its ends are rounded once more. */
  rays->doubt += tc_select(tc_lt(tc_set(0), rays->doubt), tc_set((TcReal)ground->resolution.depth), tc_set(0));
#else
  if (!ground->screen) {
    int kz = 0;
    lanes = tc_along_one_axis(&placed->lines, lanes, &kz);
    tc_take_ray_space(placed, kz, rays);
    placed->lanes &= ~lanes;
    return lanes;
  }
#endif
  tc_take_screen(ground->screen, placed, rays);
  placed->lanes = 0;
  return lanes;
}

#endif
