/* SPDX-License-Identifier: Apache-2.0 */
#include "walk/screen.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"

typedef long double Long3[3];

static void cross_long(const double a[3], const double b[3], Long3 c) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    c[k] = (long double)a[i] * (long double)b[j] - (long double)a[j] * (long double)b[i];
  }
}

/* factor · c, as two doubles. */
static TcDual dual(const Long3 c, long double factor) {
  TcDual result;
  for (int k = 0; k < 3; ++k) {
    const long double value = c[k] * factor;
    result.high[k] = (double)value;
    result.low[k] = (double)(value - (long double)result.high[k]);
  }
  return result;
}

bool tc_screen_setup(const TetcastVolume *volume, const TcView *view, int64_t width, int64_t height, TcScreen *screen) {
  const double half_width = 0.5 * (double)width, half_height = 0.5 * (double)height, radius = volume->radius;
  /* Where what lies straight ahead is in the picture. */
  const double ahead_x = half_width - half_width * view->center[0],
               ahead_y = half_height + half_height * view->center[1];
  double to_center[3];
  for (int k = 0; k < 3; ++k)
    to_center[k] = volume->center[k] - view->eye[k];
  const double distance = tc_dot(to_center, view->forward), away = sqrt(tc_dot(to_center, to_center));
  if (!(away < 0x1p8 * radius))
    return false;
  if (!view->orthographic && !(distance > (1 + 0x1p-4) * radius))
    return false;
  Long3 f, r, u;
  cross_long(view->right, view->up, f);
  cross_long(view->up, view->forward, r);
  cross_long(view->forward, view->right, u);
  long double det = 0;
  for (int k = 0; k < 3; ++k)
    det += (long double)view->forward[k] * f[k];
  if (!(fabsl(det) > LDBL_MIN))
    return false;
  *screen = (TcScreen){.distance = distance,
                       .perspective = !view->orthographic,
                       .to_z = dual(f, 1 / det),
                       .to_x = dual(r, (long double)half_width / det),
                       .to_y = dual(u, -(long double)half_height / det)};
  memcpy(screen->forward, view->forward, sizeof screen->forward);
  const double x_scale = sqrt(tc_dot(screen->to_x.high, screen->to_x.high)),
               y_scale = sqrt(tc_dot(screen->to_y.high, screen->to_y.high));
  const double scale = fmax(x_scale, y_scale); /* pixels per length, times z */
  double x = tc_dot(screen->to_x.high, to_center), y = tc_dot(screen->to_y.high, to_center);
  if (screen->perspective) {
    /* A point of the sphere at δ from the centre is seen at (x + scale δx) / (z + δz). */
    screen->extent = 1.01 * scale * radius * (distance + away) / (distance * (distance - radius)) + 1;
    x /= distance;
    y /= distance;
  } else {
    screen->extent = 1.01 * scale * radius + 1;
  }
  screen->x0 = nearbyint(ahead_x + x);
  screen->y0 = nearbyint(ahead_y + y);
  screen->offset_x = ahead_x - screen->x0;
  screen->offset_y = ahead_y - screen->y0;
  if (!(screen->extent < 0x1p40) || !(fabs(screen->x0) < 0x1p40) || !(fabs(screen->y0) < 0x1p40))
    return false;
  int exponent;
  frexp(screen->extent + fabs(screen->x0) + fabs(screen->y0) + (double)width + (double)height, &exponent);
  screen->unit = ldexp(1, 30 - exponent); /* what is below 2^exponent fits 31 bits */
  return true;
}

/* With u = 2⁻⁵³, or 2⁻²⁴ in single precision, R the volume's radius and S the largest value:
 *
 * On the screen a vertex's coordinates are rounded once, by u of what they are at most or by half a unit each, and so
 * is the place of the ray; √2 times that beside it. Moving the vertex by the ray rounds by √2 u of the distance. Edges
 * are good to 2 u, as weights to 4 u, which moves a point within its face by 8 √2 u of its reach. In ray space
 * coordinates of at most 4 R are sheared, in operations that round by 16 u R in all; the direction of a camera's ray
 * was rounded, by 2 u of the eye's distance.
 *
 * A depth is a quotient of sums of three products times a scale, of magnitude at most 2 R: 24 u R, and u R for the
 * vertex's own. A value is such a quotient, too: 8 u S; in single precision those of vertices and of knots are rounded
 * besides, interpolation goes on from there: 32 u S. */
static TcResolution resolution(const TetcastVolume *volume, double u, double beside, double values) {
  return (TcResolution){.beside = beside,
                        .relative = 13 * u,
                        .depth = 32 * u * volume->radius,
                        .value = (u > 0x1p-50 ? 32 : 8) * u * values};
}

TcResolution tc_screen_resolution(const TetcastVolume *volume, const TcScreen *screen, bool single, int64_t width,
                                  int64_t height, double values) {
  const double size = (double)width + (double)height + fabs(screen->x0) + fabs(screen->y0);
  if (single)
    return resolution(volume, 0x1p-24, 1.5, values); /* units, in which the ray is walked */
  return resolution(volume, 0x1p-53, 1.5 * 0x1p-53 * (screen->extent + size), values);
}

TcResolution tc_ray_resolution(const TetcastVolume *volume, double eye_distance, double values) {
  return resolution(volume, 0x1p-53, 0x1p-53 * (16 * volume->radius + 2 * eye_distance), values);
}
