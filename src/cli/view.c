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

/* The axis to look along: z, but not from where the mesh is little more than a line, nor along the given up. Of the
 * three faces of the bounds the one that is seen has a tenth of the largest one's area at least. */
static int view_axis(const RenderOptions *options, const double bounds[6]) {
  static const int preferred[3] = {2, 1, 0};
  double largest = 0, area[3], widest = 0;
  bool allowed[3];
  for (int k = 0; k < 3; k++)
    largest = fmax(largest, bounds[2 * k + 1] - bounds[2 * k]);
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double axis[3] = {k == 0, k == 1, k == 2};
    allowed[k] = !render_options_given(options, OPTION_UP) || !parallel(options->up, axis);
    area[k] = largest > 0
                  ? (bounds[2 * i + 1] - bounds[2 * i]) / largest * ((bounds[2 * j + 1] - bounds[2 * j]) / largest)
                  : 0;
    if (allowed[k])
      widest = fmax(widest, area[k]);
  }
  for (int i = 0; i < 3; i++)
    if (allowed[preferred[i]] && area[preferred[i]] >= 0.1 * widest)
      return preferred[i];
  return 2;
}

/* Along -z, +y or -x. */
static void place_eye(const RenderOptions *options, const double bounds[6], double distance, TetcastCamera *camera) {
  const int axis = view_axis(options, bounds);
  memcpy(camera->eye, camera->target, sizeof camera->eye);
  camera->eye[axis] += axis == 1 ? -distance : distance;
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
    place_eye(options, bounds, distance, camera);
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
