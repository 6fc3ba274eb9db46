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

/* Three numbers of tuple i, and one that may not be there. */
static inline void take3(const TetcastArray *array, int64_t stride, int64_t i, double v[3]) {
  if (array->type == TETCAST_TYPE_FLOAT64) {
    memcpy(v, (const char *)array->data + i * stride, 3 * sizeof *v);
    return;
  }
  float single[3];
  memcpy(single, (const char *)array->data + i * stride, sizeof single);
  for (int k = 0; k < 3; ++k)
    v[k] = (double)single[k];
}
static double take1(const TetcastArray *array, int64_t i, double otherwise) {
  return array->type == TETCAST_TYPE_NONE ? otherwise : tc_array_double(array, tc_array_stride(array, 1), i, 0);
}

/* Whether all is well with ray i, which goes from o along d. */
static TetcastStatus check_ray(TetcastContext *context, const TetcastRays *rays, int64_t i, const double o[3],
                               const double d[3]) {
  const double begin = take1(&rays->begins, i, 0), end = take1(&rays->ends, i, INFINITY);
  if (!isfinite(o[0]) || !isfinite(o[1]) || !isfinite(o[2]))
    return ARGUMENT(context, "ray %" PRId64 ": a coordinate of the origin is not finite", i);
  if (!isfinite(d[0]) || !isfinite(d[1]) || !isfinite(d[2]))
    return ARGUMENT(context, "ray %" PRId64 ": a component of the direction is not finite", i);
  if (d[0] == 0 && d[1] == 0 && d[2] == 0)
    return ARGUMENT(context, "ray %" PRId64 ": the direction is 0, 0, 0", i);
  if (isnan(begin) || isnan(end))
    return ARGUMENT(context, "ray %" PRId64 ": begin or end is NaN", i);
  if (begin > end)
    return ARGUMENT(context, "ray %" PRId64 ": it begins at %g, after its end at %g", i, begin, end);
  return TETCAST_OK;
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
  const int64_t origin_stride = tc_array_stride(&rays->origins, 3),
                direction_stride = tc_array_stride(&rays->directions, 3);
  const bool plain = rays->begins.type == TETCAST_TYPE_NONE && rays->ends.type == TETCAST_TYPE_NONE;
  for (int64_t i = 0; !status && i < count; ++i) {
    double o[3], d[3];
    take3(&rays->origins, origin_stride, i, o);
    take3(&rays->directions, direction_stride, i, d);
    /* A number that is not finite minus itself is NaN. */
    const double none =
        ((o[0] - o[0]) + (o[1] - o[1]) + (o[2] - o[2])) + ((d[0] - d[0]) + (d[1] - d[1]) + (d[2] - d[2]));
    if (!plain || none != 0 || ((d[0] == 0) & (d[1] == 0) & (d[2] == 0)))
      status = check_ray(context, rays, i, o, d);
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

TcRayList tc_rays_list(const TetcastRays *rays, const TetcastVolume *volume) {
  const int half = -volume->exponent / 2;
  return (TcRayList){.rays = rays,
                     .volume = volume,
                     .origin_stride = tc_array_stride(&rays->origins, 3),
                     .direction_stride = tc_array_stride(&rays->directions, 3),
                     .scale = {power_of_two(half), power_of_two(-volume->exponent - half)}};
}

/* The ray's own ends, if it has some, as distances. */
static void find_ends(const TcRayList *list, int64_t i, TcLine *line, TcRayUnit *unit) {
  unit->begin = take1(&list->rays->begins, i, 0);
  unit->end = take1(&list->rays->ends, i, INFINITY);
  line->begin = scaled(unit->begin * unit->length, unit->exponent);
  line->end = scaled(unit->end * unit->length, unit->exponent);
}

void tc_rays_line(const TcRayList *list, int64_t i, TcLine *line, TcRayUnit *unit) {
  const TetcastRays *rays = list->rays;
  double origin[3], *d = line->direction;
  int exponent = 0;
  take3(&rays->origins, list->origin_stride, i, origin);
  take3(&rays->directions, list->direction_stride, i, d);
  const double square = tc_dot(d, d);
  if (!(square > 0x1p-900 && square < 0x1p900)) { /* else no square overflows, and none that counts underflows */
    frexp(fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))), &exponent);
    for (int k = 0; k < 3; ++k)
      d[k] = ldexp(d[k], -exponent);
  }
  const double length = sqrt(exponent ? tc_dot(d, d) : square);
  for (int k = 0; k < 3; ++k) {
    line->eye[k] = origin[k] * list->scale[0] * list->scale[1];
    line->offset[k] = 0;
    d[k] /= length;
  }
  *unit = (TcRayUnit){.length = length, .exponent = exponent - list->volume->exponent, .begin = 0, .end = INFINITY};
  line->begin = 0;
  line->end = INFINITY;
  if (rays->begins.type != TETCAST_TYPE_NONE || rays->ends.type != TETCAST_TYPE_NONE)
    find_ends(list, i, line, unit);
}

double tc_rays_away(const TcRayList *list) {
  double most = 0;
  for (int64_t i = 0; i < list->rays->origins.count; ++i) {
    double away[3];
    take3(&list->rays->origins, list->origin_stride, i, away);
    for (int k = 0; k < 3; ++k)
      away[k] = away[k] * list->scale[0] * list->scale[1] - list->volume->center[k];
    const double square = tc_dot(away, away);
    most = square > most ? square : most;
  }
  return sqrt(most);
}

/* As fmin() and fmax() for numbers, in one instruction; the second one if one is NaN. */
static inline double fmin_of(double a, double b) {
  return a < b ? a : b;
}
static inline double fmax_of(double a, double b) {
  return a > b ? a : b;
}

/* The places of two numbers from −1 to 1 among 2^7 each; all others count as the nearest of these. Bit i of the first
 * becomes bit 4 i, that of the second bit 4 i + 32. */
static uint64_t places_of(double x, double y) {
  const double last = 127, at_x = x * 64 + 64, at_y = y * 64 + 64;
  const uint32_t place_x = (uint32_t)(int32_t)fmax_of(fmin_of(at_x, last), 0),
                 place_y = (uint32_t)(int32_t)fmax_of(fmin_of(at_y, last), 0);
  uint64_t both = place_x | (uint64_t)place_y << 32;
  both = (both | both << 12) & UINT64_C(0x0007000F0007000F);
  both = (both | both << 6) & UINT64_C(0x0103030301030303);
  return (both | both << 3) & UINT64_C(0x1111111111111111);
}

/* The main axis comes first, as the rays of a packet must have it in common (walk/place.h), and its sign; then the
 * place where the ray goes through the plane across this axis in the volume's middle, and its direction, along Morton's
 * curve. */
uint32_t tc_rays_key(const TcRayList *list, int64_t i) {
  const TetcastVolume *volume = list->volume;
  double from_center[3], d[3];
  take3(&list->rays->origins, list->origin_stride, i, from_center);
  take3(&list->rays->directions, list->direction_stride, i, d);
  for (int k = 0; k < 3; ++k)
    from_center[k] = from_center[k] * list->scale[0] * list->scale[1] - volume->center[k];
  const double x = fabs(d[0]), y = fabs(d[1]), z = fabs(d[2]), inverse_radius = 1 / volume->radius;
  const int kz = z > (x > y ? x : y) ? 2 : y > x, kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
  const double inverse = 1 / d[kz], slope_x = d[kx] * inverse, slope_y = d[ky] * inverse;
  const double beside_x = from_center[kx] - from_center[kz] * slope_x,
               beside_y = from_center[ky] - from_center[kz] * slope_y;
  const uint64_t slopes = places_of(slope_x, slope_y),
                 besides = places_of(beside_x * inverse_radius, beside_y * inverse_radius);
  const uint64_t all = slopes | besides << 2;
  return (uint32_t)(2 * kz + (d[kz] < 0)) << 28 | (uint32_t)all | (uint32_t)(all >> 32) << 1;
}
