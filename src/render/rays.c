/* SPDX-License-Identifier: Apache-2.0 */
#include "render/rays.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"

#define ARGUMENT(context, ...) tc_error(context, TETCAST_ERROR_ARGUMENT, __VA_ARGS__)

/* Whether an array of so many components is there for all rays, or is left out and may be. */
static TetcastStatus check_array(TetcastContext *context, const TetcastArray *array, const char *name, int64_t count,
                                 bool optional) {
  if (array->type == TETCAST_TYPE_NONE && (optional || (count == 0 && array->count == 0)))
    return TETCAST_OK;
  if (!tc_type_is_float(array->type))
    return ARGUMENT(context, "rays: the type of %s must be float32 or float64", name);
  if (array->count < 0 || array->count != count)
    return ARGUMENT(context, "rays: %" PRId64 " %s for %" PRId64 " origins", array->count, name, count);
  if (count > 0 && !array->data)
    return ARGUMENT(context, "rays: %s are NULL", name);
  return TETCAST_OK;
}

/* Three numbers of ray i, and one that may not be there. */
static void take3(const TetcastArray *array, int64_t i, double v[3]) {
  const int64_t stride = tc_array_stride(array, 3);
  if (array->type == TETCAST_TYPE_FLOAT64) {
    memcpy(v, (const char *)array->data + i * stride, 3 * sizeof *v);
    return;
  }
  for (int k = 0; k < 3; ++k)
    v[k] = tc_array_double(array, stride, i, k);
}
static double take1(const TetcastArray *array, int64_t i, double otherwise) {
  return array->type == TETCAST_TYPE_NONE ? otherwise : tc_array_double(array, tc_array_stride(array, 1), i, 0);
}

TetcastStatus tc_rays_check(TetcastContext *context, const TetcastRays *rays) {
  const int64_t count = rays->origins.count;
  TetcastStatus status = check_array(context, &rays->origins, "origins", count, false);
  if (!status)
    status = check_array(context, &rays->directions, "directions", count, false);
  if (!status)
    status = check_array(context, &rays->begins, "begins", count, true);
  if (!status)
    status = check_array(context, &rays->ends, "ends", count, true);
  for (int64_t i = 0; !status && i < count; ++i) {
    double o[3], d[3];
    take3(&rays->origins, i, o);
    take3(&rays->directions, i, d);
    const double begin = take1(&rays->begins, i, 0), end = take1(&rays->ends, i, INFINITY);
    if (!isfinite(o[0]) || !isfinite(o[1]) || !isfinite(o[2]))
      status = ARGUMENT(context, "ray %" PRId64 ": a coordinate of the origin is not finite", i);
    else if (!isfinite(d[0]) || !isfinite(d[1]) || !isfinite(d[2]))
      status = ARGUMENT(context, "ray %" PRId64 ": a component of the direction is not finite", i);
    else if (d[0] == 0 && d[1] == 0 && d[2] == 0)
      status = ARGUMENT(context, "ray %" PRId64 ": the direction is 0, 0, 0", i);
    else if (isnan(begin) || isnan(end))
      status = ARGUMENT(context, "ray %" PRId64 ": begin or end is NaN", i);
    else if (begin > end)
      status = ARGUMENT(context, "ray %" PRId64 ": it begins at %g, after its end at %g", i, begin, end);
  }
  return status;
}

/* 2^exponent, which is at least 2^−1022 and at most 2^1023. */
static double power_of_two(int exponent) {
  const uint64_t bits = (uint64_t)(exponent < -1022 ? 1 : exponent > 1023 ? 2046 : exponent + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

/* As ldexp(), but inline: halves of the exponent, so that neither is too large or too small. */
static double scaled(double x, int exponent) {
  return x * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2);
}

TcLine tc_rays_line(const TetcastRays *rays, const TetcastVolume *volume, int64_t i, TcRayUnit *unit) {
  TcLine line = {.begin = 0};
  double origin[3], *d = line.direction;
  int exponent = 0;
  take3(&rays->origins, i, origin);
  take3(&rays->directions, i, d);
  const double square = tc_dot(d, d);
  if (!(square > 0x1p-900 && square < 0x1p900)) /* else no square overflows, and none that counts underflows */
    frexp(fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))), &exponent);
  for (int k = 0; k < 3; ++k) {
    line.eye[k] = scaled(origin[k], -volume->exponent);
    if (exponent)
      d[k] = ldexp(d[k], -exponent);
  }
  *unit = (TcRayUnit){.length = sqrt(tc_dot(d, d)),
                      .exponent = exponent - volume->exponent,
                      .begin = take1(&rays->begins, i, 0),
                      .end = take1(&rays->ends, i, INFINITY)};
  for (int k = 0; k < 3; ++k)
    d[k] /= unit->length;
  line.begin = scaled(unit->begin * unit->length, unit->exponent);
  line.end = scaled(unit->end * unit->length, unit->exponent);
  return line;
}

double tc_rays_away(const TetcastRays *rays, const TetcastVolume *volume) {
  double most = 0;
  for (int64_t i = 0; i < rays->origins.count; ++i) {
    double away[3];
    take3(&rays->origins, i, away);
    for (int k = 0; k < 3; ++k)
      away[k] = scaled(away[k], -volume->exponent) - volume->center[k];
    most = fmax(most, tc_dot(away, away));
  }
  return sqrt(most);
}

/* The place of a number from −1 to 1 among 2^7; all others count as the nearest of these. */
static uint32_t place_of(double x) {
  const double at = (x + 1) * 64;
  return at < 127 ? (at > 0 ? (uint32_t)at : 0) : 127;
}

/* Bit i of a number below 2^7 becomes bit 4 i. */
static uint32_t spread(uint32_t x) {
  x = (x | x << 12) & 0x0007000F;
  x = (x | x << 6) & 0x01030303;
  return (x | x << 3) & 0x01111111;
}

/* The main axis comes first, as the rays of a packet must have it in common (walk/place.h), and its sign; then the
 * place where the ray goes through the plane across this axis in the volume's middle, and its direction, along Morton's
 * curve. */
uint32_t tc_rays_key(const TcLine *line, const TetcastVolume *volume) {
  const double *d = line->direction, x = fabs(d[0]), y = fabs(d[1]), z = fabs(d[2]);
  const int kz = z > fmax(x, y) ? 2 : y > x, kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const double slope_x = d[kx] / d[kz], slope_y = d[ky] / d[kz], depth = volume->center[kz] - line->eye[kz];
  const double beside_x = line->eye[kx] - volume->center[kx] + line->offset[kx] + depth * slope_x,
               beside_y = line->eye[ky] - volume->center[ky] + line->offset[ky] + depth * slope_y;
  return (uint32_t)(2 * kz + (d[kz] < 0)) << 28 | spread(place_of(slope_x)) | spread(place_of(slope_y)) << 1 |
         spread(place_of(beside_x / volume->radius)) << 2 | spread(place_of(beside_y / volume->radius)) << 3;
}
