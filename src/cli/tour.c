/* SPDX-License-Identifier: Apache-2.0 */
#include "tour.h"

#include <math.h>
#include <string.h>

Tour tour_of(const RenderOptions *options) {
  const bool dolly = render_options_given(options, OPTION_DOLLY);
  double numbers[2];
  if ((!dolly && !render_options_given(options, OPTION_ORBIT)) ||
      !render_option_tour(dolly ? OPTION_DOLLY : OPTION_ORBIT, dolly ? options->dolly : options->orbit, numbers))
    return (Tour){0};
  return (Tour){.count = (int64_t)numbers[0], .dolly = dolly, .amount = numbers[1]};
}

const char *tour_fault(const RenderOptions *options) {
  if (tour_of(options).count == 0)
    return NULL;
  if (options->time ? !strcmp(options->time, "all") : options->inputs != NULL)
    return "--orbit, --dolly: of one step alone; --time STEP chooses it";
  if (render_options_range(options) == RANGE_SERIES)
    return "--orbit, --dolly: of one step alone, not with --range series";
  if (render_options_deep(options))
    return "--deep: not possible with --orbit or --dolly";
  return options->stop_depth ? "--stop-depth: not possible with --orbit or --dolly, as it is for one place" : NULL;
}

/* Turns the eye by an angle round the axis through the target along up, counterclockwise as seen from its tip. */
static void turn(TetcastCamera *camera, double degrees) {
  double *eye = camera->eye, axis[3], arm[3];
  const double *up = camera->up, largest = fmax(fmax(fabs(up[0]), fabs(up[1])), fabs(up[2]));
  const double angle = degrees * (3.14159265358979323846 / 180), cosine = cos(angle), sine = sin(angle);
  for (int i = 0; i < 3; i++) { /* without overflow on the way to length 1 */
    axis[i] = up[i] / largest;
    arm[i] = eye[i] - camera->target[i];
  }
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  for (int i = 0; i < 3; i++)
    axis[i] /= length;
  const double along = axis[0] * arm[0] + axis[1] * arm[1] + axis[2] * arm[2];
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    eye[i] = camera->target[i] + arm[i] * cosine + (axis[j] * arm[k] - axis[k] * arm[j]) * sine +
             axis[i] * along * (1 - cosine);
  }
}

TetcastCamera tour_camera(const Tour *tour, const TetcastCamera *base, int64_t frame) {
  TetcastCamera camera = *base;
  if (frame == 0)
    return camera;
  if (!tour->dolly) {
    turn(&camera, tour->amount * (double)frame / (double)tour->count);
    return camera;
  }
  const double share = pow(tour->amount, -(double)frame / (double)(tour->count - 1));
  for (int i = 0; i < 3; i++)
    camera.eye[i] = camera.target[i] + (camera.eye[i] - camera.target[i]) * share;
  camera.height *= share;
  return camera;
}
