/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_BASE_VEC3_H
#define TC_BASE_VEC3_H

#include <math.h>
#include <stdbool.h>

static inline double tc_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void tc_cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Makes v a unit vector; false if it has no direction. Scaled first where squares might overflow or underflow; that it
 * is by a power of two changes no bit otherwise. */
static inline bool tc_normalize(double v[3]) {
  const double square = tc_dot(v, v);
  if (square > 0x1p-900 && square < 0x1p900) {
    const double root = sqrt(square);
    for (int k = 0; k < 3; ++k)
      v[k] /= root;
    return true;
  }
  const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
  if (!(largest > 0) || !isfinite(largest))
    return false;
  int exponent;
  frexp(largest, &exponent);
  for (int k = 0; k < 3; ++k)
    v[k] = ldexp(v[k], -exponent);
  const double length = sqrt(tc_dot(v, v));
  for (int k = 0; k < 3; ++k)
    v[k] /= length;
  return true;
}

#endif
