/* SPDX-License-Identifier: Apache-2.0 */
#include "quadrature.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const long double pi = 3.14159265358979323846264338327950288L;

/* Legendre's polynomial of degree QUADRATURE_NODES and its derivative, by the recurrence. */
static long double legendre(long double x, long double *slope) {
  long double before = 1, value = x;
  for (int n = 2; n <= QUADRATURE_NODES; n++) {
    const long double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
    before = value;
    value = next;
  }
  *slope = QUADRATURE_NODES * (x * value - before) / (x * x - 1);
  return value;
}

const Quadrature *quadrature(void) {
  static Quadrature rule;
  static bool ready;
  for (int i = 0; i < QUADRATURE_NODES && !ready; i++) {
    long double x = cosl(pi * (i + 0.75L) / (QUADRATURE_NODES + 0.5L)), slope;
    for (int step = 0; step < 8; step++) /* Newton's; three would do */
      x -= legendre(x, &slope) / slope;
    legendre(x, &slope);
    rule.node[i] = (1 - x) / 2;
    rule.weight[i] = 1 / ((1 - x * x) * slope * slope);
  }
  ready = true;
  return &rule;
}

static void normalize(long double v[3]) {
  const long double length = hypotl(hypotl(v[0], v[1]), v[2]);
  for (int k = 0; k < 3; k++)
    v[k] /= length;
}

static void cross(const long double a[3], const long double b[3], long double product[3]) {
  for (int k = 0; k < 3; k++)
    product[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

ReferenceRay reference_ray(const TetcastCamera *camera, int64_t width, int64_t height, int64_t i, int64_t j) {
  long double forward[3], right[3], up[3];
  const long double given[3] = {camera->up[0], camera->up[1], camera->up[2]};
  for (int k = 0; k < 3; k++)
    forward[k] = (long double)camera->target[k] - camera->eye[k];
  normalize(forward);
  cross(forward, given, right);
  normalize(right);
  cross(right, forward, up);
  const bool perspective = camera->projection == TETCAST_PERSPECTIVE;
  const long double half = perspective ? tanl((long double)camera->fovy * pi / 360) : (long double)camera->height / 2;
  const long double x =
      (2 * ((long double)i + 0.5L) / (long double)width - 1) * (long double)width / (long double)height * half;
  const long double y = (1 - 2 * ((long double)j + 0.5L) / (long double)height) * half;
  ReferenceRay ray;
  for (int k = 0; k < 3; k++) {
    const long double offset = x * right[k] + y * up[k];
    ray.origin[k] = camera->eye[k] + (perspective ? 0 : offset);
    ray.direction[k] = forward[k] + (perspective ? offset : 0);
  }
  normalize(ray.direction);
  return ray;
}
