/* SPDX-License-Identifier: Apache-2.0 */
/* What of a ray counts: its interval, from where it enters the last of the half-spaces that it is clipped to, to where
 * it leaves the first of them. All of it happens where rays are placed, in double precision; the kernels' loop knows
 * nothing of half-spaces.
 *
 * With P the placed ray's point, D its direction and n, f the half-space's normal and value at the volume's centre,
 *
 *     f(z) = (f + n · P) + z n · D
 *
 * is its value at the depth z from P, and the plane is met at z = −(f + n · P) / n · D. Let u = 2⁻⁵³, R the volume's
 * radius and A the distance of its centre from the camera's eye, so that an orthographic ray starts within 2 A + R.
 * Where the plane cuts the ray within the sphere, |f + n · P| ≤ |n| R, |z| ≤ R and
 *
 *     P is off by              4 u (2 A + R) by its direction, which was rounded, and in an orthographic view by
 *                              5 u (A + R) as its start was, and on the screen by u (4 A + 2 R) in the sums that make
 * it, f + n · P is off by      |n| times that, and 6 u |n| R by products and sums, z n · D is off by        7 u |n| R,
 *
 * in all less than u |n| (17 A + 24 R). With what dividing costs, and what moves depths to where the screen has its 0,
 * z is off by less than
 *
 *     40 u (A + R) |n| / |n · D|.
 *
 * That is how far an end of the interval may be off: `doubt`, which counts as the shift of a face at which what is seen
 * jumps (tolerance.h). It is no more than the sphere's diameter. Distances at which rays stop have the same with n = D.
 */
#ifndef TC_WALK_INTERVAL_H
#define TC_WALK_INTERVAL_H

#include "walk/place.h"

/* Clips ray l to a half-space that has this value at the ray's point and this slope along the ray. `slack`: |n| times
 * how far an end may be off where the ray is perpendicular to the plane. False: none of the ray counts, whatever was
 * rounded. */
static bool tc_clip_lane(double value, double slope, double radius, double slack, TcPlaced *placed, int l) {
  const double steepness = fabs(slope), reach = steepness * radius;
  if (value - reach > slack)
    return true; /* all that the ray has in the sphere lies inside */
  if (value + reach < -slack)
    return false;
  const double at = -value / slope, doubt = slack / steepness;
  if (slope > 0)
    TC_AT(placed->begin, l) = TC_AT(placed->begin, l) > at ? TC_AT(placed->begin, l) : at;
  else if (slope < 0)
    TC_AT(placed->end, l) = TC_AT(placed->end, l) < at ? TC_AT(placed->end, l) : at;
  else if (value < 0) /* parallel to the plane, and beyond it; in the plane it is kept */
    TC_AT(placed->end, l) = -INFINITY;
  TC_AT(placed->doubt, l) += doubt < 2 * radius ? doubt : 2 * radius;
  return true;
}

/* Clips the rays, and leaves out those of which nothing counts. */
static void tc_clip(const TcHalfSpace *half_spaces, int count, double radius, double most, TcPlaced *placed) {
  for (int i = 0; i < count; ++i) {
    const TcHalfSpace *half_space = &half_spaces[i];
    TcWide value = tc_set_wide(half_space->at_center), slope = tc_set_wide(0);
    for (int k = 0; k < 3; ++k) {
      value += half_space->normal[k] * placed->from_center[k];
      slope += half_space->normal[k] * placed->lines.direction[k];
    }
    for (unsigned lanes = placed->lanes; lanes; lanes &= lanes - 1) {
      const int l = __builtin_ctz(lanes);
      if (!tc_clip_lane(TC_AT(value, l), TC_AT(slope, l), radius, most * half_space->length, placed, l))
        placed->lanes &= ~(1U << l);
    }
  }
  for (unsigned lanes = placed->lanes; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    if (TC_AT(placed->begin, l) - TC_AT(placed->end, l) > TC_AT(placed->doubt, l))
      placed->lanes &= ~(1U << l);
  }
}

/* Where rays meet slices: as where they would be clipped, to the bit. */
static void tc_slice(const TcSurfaces *surfaces, TcPlaced *placed) {
  for (int i = 0; i < surfaces->slice_count; ++i) {
    TcWide value = tc_set_wide(surfaces->slice[i].at_center), slope = tc_set_wide(0);
    for (int k = 0; k < 3; ++k) {
      value += surfaces->slice[i].normal[k] * placed->from_center[k];
      slope += surfaces->slice[i].normal[k] * placed->lines.direction[k];
    }
    placed->slice[i] = -value / slope;
  }
}

/* Rays end at these distances from where they start, scaled. Those that end before the sphere are left out. */
static void tc_stop(const TcWide *distance, double radius, double most, TcPlaced *placed) {
  for (unsigned lanes = placed->lanes; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const double end = TC_AT(*distance, l) - TC_AT(placed->near, l);
    if (end - most > radius)
      continue;
    if (end + most < -radius || TC_AT(placed->begin, l) - end > most) {
      placed->lanes &= ~(1U << l);
      continue;
    }
    TC_AT(placed->end, l) = fmin(TC_AT(placed->end, l), end);
    TC_AT(placed->doubt, l) += most;
  }
}

#endif
