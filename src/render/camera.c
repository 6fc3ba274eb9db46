/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "render/render.h"

static const double DEGREE = 0.017453292519943295;

/* Lengths are in units of the mesh's size, so that squares of distances don't overflow. */
#define TOO_FAR 0x1p500

TetcastCamera tc_camera_default(const double bounds[6], double aspect) {
  TetcastCamera camera = {.up = {0, 1, 0}, .projection = TETCAST_PERSPECTIVE, .fovy = 30};
  double half[3];
  for (int k = 0; k < 3; ++k) {
    camera.target[k] = 0.5 * bounds[2 * k] + 0.5 * bounds[2 * k + 1];
    half[k] = 0.5 * bounds[2 * k + 1] - 0.5 * bounds[2 * k];
  }
  double radius = hypot(hypot(half[0], half[1]), half[2]);
  if (!(radius > 0))
    radius = 0.5; /* a point: any distance will do */
  double half_angle = 15 * DEGREE;
  if (aspect > 0 && aspect < 1)
    half_angle = atan(tan(half_angle) * aspect);
  memcpy(camera.eye, camera.target, sizeof camera.eye);
  camera.eye[2] += radius / sin(half_angle);
  camera.height = aspect > 0 && aspect < 1 ? 2 * radius / aspect : 2 * radius;
  return camera;
}

TetcastStatus tc_view_create(TetcastContext *context, const TetcastCamera *camera, const TetcastVolume *volume,
                             double aspect, TcView *view) {
  view->orthographic = camera->projection == TETCAST_ORTHOGRAPHIC;
  for (int k = 0; k < 3; ++k) {
    view->eye[k] = ldexp(camera->eye[k], -volume->exponent);
    view->forward[k] = 0.5 * camera->target[k] - 0.5 * camera->eye[k];
    view->up[k] = camera->up[k];
    if (!(fabs(view->eye[k]) < TOO_FAR)) {
      return tc_error(context, TETCAST_ERROR_ARGUMENT, "camera: the eye is too far from the mesh: %g", camera->eye[k]);
    }
  }
  if (!tc_normalize(view->forward)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "camera: eye and target are the same point (%g, %g, %g)",
                    camera->eye[0], camera->eye[1], camera->eye[2]);
  }
  if (tc_normalize(view->up))
    tc_cross(view->forward, view->up, view->right);
  if (!tc_normalize(view->up) || tc_dot(view->right, view->right) < 1e-24 || !tc_normalize(view->right)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "camera: up (%g, %g, %g) is parallel to the direction of view",
                    camera->up[0], camera->up[1], camera->up[2]);
  }
  tc_cross(view->right, view->forward, view->up);
  for (int k = 0; k < 2; ++k)
    view->center[k] = camera->center[k];
  const double half =
      view->orthographic ? ldexp(0.5 * camera->height, -volume->exponent) : tan(0.5 * camera->fovy * DEGREE);
  if (!(half * aspect < TOO_FAR && half < TOO_FAR)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "camera: a height of %g is too large for the mesh",
                    camera->height);
  }
  if (!(half * aspect * fabs(view->center[0]) < TOO_FAR && half * fabs(view->center[1]) < TOO_FAR)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "camera: a center of %g, %g is too far from the mesh",
                    camera->center[0], camera->center[1]);
  }
  for (int k = 0; k < 3; ++k) {
    view->right[k] *= half * aspect;
    view->up[k] *= half;
  }
  return TETCAST_OK;
}
