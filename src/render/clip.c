/* SPDX-License-Identifier: Apache-2.0 */
#include "render/clip.h"

#include <math.h>

#include "base/exact.h"
#include "base/vec3.h"

/* A sum that is rounded once: what rounding takes from it is summed up as well. */
typedef struct Sum {
  double high, low;
} Sum;

static void add(Sum *sum, double x) {
  const double high = sum->high + x;
  sum->low += tc_sum_error(sum->high, x, high);
  sum->high = high;
}

/* normal · center − offset. Products of numbers below 1 lose what is below 2⁻¹⁰⁷⁴, and no more. */
static double value_at(const double normal[3], const double center[3], double offset) {
  Sum sum = {-offset, 0};
  for (int k = 0; k < 3 && isfinite(offset); ++k) {
    const double product = normal[k] * center[k];
    add(&sum, product);
    sum.low += tc_product_error(normal[k], center[k], product);
  }
  return sum.high + sum.low;
}

/* The largest component is scaled to [1/2, 1): nothing overflows, and no bit is lost but far below what counts. */
TcHalfSpace tc_half_space_scale(const TetcastVolume *volume, const TetcastHalfSpace *source) {
  int exponent;
  frexp(fmax(fabs(source->normal[0]), fmax(fabs(source->normal[1]), fabs(source->normal[2]))), &exponent);
  TcHalfSpace result;
  for (int k = 0; k < 3; ++k)
    result.normal[k] = ldexp(source->normal[k], -exponent);
  result.length = sqrt(tc_dot(result.normal, result.normal));
  result.at_center = value_at(result.normal, volume->center, ldexp(source->offset, -exponent - volume->exponent));
  return result;
}

TetcastStatus tc_clip_create(const TetcastVolume *volume, const TetcastHalfSpace *half_spaces, int count,
                             TcHalfSpace **clip, int *kept) {
  *clip = NULL;
  *kept = 0;
  if (count == 0)
    return TETCAST_OK;
  if (!tc_allocate_array(volume->context, (void **)clip, count, sizeof **clip, "half-spaces of a clip"))
    return TETCAST_ERROR_MEMORY;
  for (int i = 0; i < count; ++i) {
    const TcHalfSpace half_space = tc_half_space_scale(volume, &half_spaces[i]);
    if (!(half_space.at_center > (1 + 0x1p-40) * half_space.length * volume->radius))
      (*clip)[(*kept)++] = half_space;
  }
  return TETCAST_OK;
}

double tc_clip_error(const TetcastVolume *volume, double eye_distance) {
  return 40 * 0x1p-53 * (eye_distance + volume->radius);
}
