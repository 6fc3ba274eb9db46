/* SPDX-License-Identifier: Apache-2.0 */
#include "view.h"

#include <math.h>
#include <string.h>

#include "cli.h"

static const double degree = 3.14159265358979323846 / 180;

/* To length 1, without overflow on the way; zero stays zero. */
static void normalize(const double v[3], double unit[3]) {
  const double largest = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
  for (int i = 0; i < 3; i++)
    unit[i] = largest > 0 ? v[i] / largest : 0;
  const double length = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
  for (int i = 0; i < 3; i++)
    unit[i] = length > 0 ? unit[i] / length : 0;
}

static bool parallel(const double a[3], const double b[3]) {
  double p[3], q[3];
  normalize(a, p);
  normalize(b, q);
  const double cross[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
  return !(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2] > 1e-12);
}

/* From how far a ball is seen whole, in radii: 1 / sin of half the smaller angle of view. */
static double distance_factor(double fovy, double aspect) {
  return 1 / sin(atan(fmin(aspect, 1) * tan(fovy / 2 * degree)));
}

static bool same(const double a[3], const double b[3]) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

const char *view_fault(const RenderOptions *options) {
  if (!render_options_given(options, OPTION_EYE) || !render_options_given(options, OPTION_TARGET))
    return NULL;
  if (same(options->eye, options->target))
    return "the camera's eye and target are the same point";
  double forward[3];
  for (int i = 0; i < 3; i++)
    forward[i] = options->target[i] - options->eye[i];
  return render_options_given(options, OPTION_UP) && parallel(options->up, forward)
             ? "the camera's up is parallel to its direction of view"
             : NULL;
}

/* The view direction: along -z; along +y if the only thing known is that up is z. */
static void place_eye(const RenderOptions *options, double distance, TetcastCamera *camera) {
  static const double along_z[3] = {0, 0, 1};
  memcpy(camera->eye, camera->target, sizeof camera->eye);
  if (render_options_given(options, OPTION_UP) && parallel(options->up, along_z))
    camera->eye[1] -= distance;
  else
    camera->eye[2] += distance;
}

bool view_complete(const RenderOptions *options, const double bounds[6], TetcastCamera *camera) {
  const double aspect = options->size[0] / options->size[1];
  *camera = tetcast_camera_default(bounds, aspect);
  double distance = camera->eye[2] - camera->target[2];
  if (render_options_given(options, OPTION_FOVY)) {
    distance *= distance_factor(options->fovy, aspect) / distance_factor(camera->fovy, aspect);
    camera->fovy = options->fovy;
  }
  if (render_options_given(options, OPTION_ORTHO)) {
    camera->projection = TETCAST_ORTHOGRAPHIC;
    camera->height = options->ortho;
  }

  const bool eye = render_options_given(options, OPTION_EYE);
  if (render_options_given(options, OPTION_TARGET))
    memcpy(camera->target, options->target, sizeof camera->target);
  if (eye)
    memcpy(camera->eye, options->eye, sizeof camera->eye);
  else
    place_eye(options, distance, camera);
  if (same(camera->eye, camera->target)) /* the eye is in the centre, and nothing said where to look */
    camera->target[2] -= distance;
  double forward[3];
  for (int i = 0; i < 3; i++)
    forward[i] = camera->target[i] - camera->eye[i];

  if (render_options_given(options, OPTION_UP)) {
    memcpy(camera->up, options->up, sizeof camera->up);
    if (parallel(camera->up, forward)) {
      cli_error("the camera's up is parallel to its direction of view");
      return false;
    }
  } else if (parallel(camera->up, forward)) {
    camera->up[1] = 0;
    camera->up[2] = 1;
  }
  return true;
}
