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

/* Cosine and sine of an angle in degrees, without rounding at right angles. */
static void turn(double angle, double *cosine, double *sine) {
  const double quarters = angle / 90;
  *cosine = cos(angle * degree);
  *sine = sin(angle * degree);
  if (quarters == floor(quarters)) {
    *cosine = round(*cosine);
    *sine = round(*sine);
  }
}

/* Where the eye is, as seen from what it looks at, and what is up: a turntable. From azimuth 0 the eye looks along +y
 * where z is up, and along -z where y is; it goes round against the clock, as seen from above. */
static void place_on_turntable(const double axis[3], double azimuth, double elevation, double eye[3], double up[3]) {
  double u[3], front[3] = {0, -1, 0}, side[3], ca, sa, ce, se;
  normalize(axis, u);
  if (fabs(u[1]) > 0.9) {
    front[1] = 0;
    front[2] = 1;
  }
  const double along = u[0] * front[0] + u[1] * front[1] + u[2] * front[2];
  for (int i = 0; i < 3; i++)
    front[i] -= along * u[i];
  normalize(front, front);
  for (int i = 0; i < 3; i++)
    side[i] = u[(i + 1) % 3] * front[(i + 2) % 3] - u[(i + 2) % 3] * front[(i + 1) % 3];
  turn(azimuth, &ca, &sa);
  turn(elevation, &ce, &se);
  for (int i = 0; i < 3; i++) {
    const double flat = sa * side[i] + ca * front[i];
    eye[i] = ce * flat + se * u[i];
    up[i] = ce * u[i] - se * flat;
  }
}

enum { ISO, PLUS_X, MINUS_X, PLUS_Y, MINUS_Y, PLUS_Z, MINUS_Z };

/* The side that shows a mesh which is flat, else iso. Flat is what one extent of is a fiftieth of the two others at
 * most.
 */
static int side_of(const double bounds[6]) {
  static const int views[3] = {MINUS_X, PLUS_Y, MINUS_Z};
  double extent[3];
  for (int k = 0; k < 3; k++)
    extent[k] = bounds[2 * k + 1] / 2 - bounds[2 * k] / 2;
  for (int k = 2; k >= 0; k--)
    if (extent[k] <= fmin(extent[(k + 1) % 3], extent[(k + 2) % 3]) / 50)
      return views[k];
  return ISO;
}

/* The view by its name: looks along an axis, z up or, along z, y. */
static void place_on_axis(int view, double eye[3], double up[3]) {
  const int axis = (view - 1) / 2;
  for (int i = 0; i < 3; i++) {
    eye[i] = i != axis ? 0 : view % 2 ? -1 : 1;
    up[i] = i == (axis == 2 ? 1 : 2);
  }
}

/* Where the eye is, and what is up, where it is said neither. */
static void find_direction(const RenderOptions *options, const double bounds[6], double eye[3], double up[3]) {
  static const double z[3] = {0, 0, 1}, azimuth = 30, elevation = 25;
  const bool turned = render_options_given(options, OPTION_AZIMUTH) || render_options_given(options, OPTION_ELEVATION);
  const int view = render_options_given(options, OPTION_VIEW) ? options->view : turned ? ISO : side_of(bounds);
  const double *axis = render_options_given(options, OPTION_UP) ? options->up : z;
  if (view != ISO) {
    place_on_axis(view, eye, up);
    if (!render_options_given(options, OPTION_UP) || !parallel(axis, eye) || render_options_given(options, OPTION_VIEW))
      return;
  }
  place_on_turntable(axis, render_options_given(options, OPTION_AZIMUTH) ? options->azimuth : azimuth,
                     render_options_given(options, OPTION_ELEVATION) ? options->elevation : elevation, eye, up);
}

/* The bounds' corners as a camera at the target would see them: to the side, upwards, towards the eye. */
static void turn_corners(const TetcastCamera *camera, const double bounds[6], const double eye[3], const double up[3],
                         double side[3], double corner[8][3]) {
  double unit[3], top[3];
  normalize(up, unit);
  for (int i = 0; i < 3; i++)
    side[i] = unit[(i + 1) % 3] * eye[(i + 2) % 3] - unit[(i + 2) % 3] * eye[(i + 1) % 3];
  normalize(side, side);
  for (int i = 0; i < 3; i++)
    top[i] = eye[(i + 1) % 3] * side[(i + 2) % 3] - eye[(i + 2) % 3] * side[(i + 1) % 3];
  for (int c = 0; c < 8; c++) {
    memset(corner[c], 0, sizeof corner[c]);
    for (int k = 0; k < 3; k++) {
      const double from = bounds[2 * k + (c >> k & 1)] - camera->target[k];
      corner[c][0] += from * side[k];
      corner[c][1] += from * top[k];
      corner[c][2] += from * eye[k];
    }
  }
}

/* Whether all corners are in the picture from this distance, if the camera goes sideways; how far at least. At the
 * right there is room for the legend. */
static bool fits(const double corner[8][3], double distance, double tangent, double aspect, double *shift) {
  static const double left = 0.92, right = 0.7, high = 0.9;
  double least = -INFINITY, most = INFINITY;
  for (int c = 0; c < 8; c++) {
    const double reach = (distance - corner[c][2]) * tangent;
    if (!(reach > 0) || fabs(corner[c][1]) > high * reach)
      return false;
    least = fmax(least, corner[c][0] - right * aspect * reach);
    most = fmin(most, corner[c][0] + left * aspect * reach);
  }
  *shift = fmin(fmax(0, least), most);
  return least <= most;
}

/* Moves the camera to the least distance from which all corners of the bounds are in the picture, and sideways, as far
 * as it has to go there. */
static double fit(TetcastCamera *camera, const double bounds[6], const double eye[3], const double up[3], double aspect,
                  bool centered) {
  const double tangent = tan(camera->fovy / 2 * degree);
  double side[3], corner[8][3], far = 0, near = 0, shift = 0, moved = 0;
  turn_corners(camera, bounds, eye, up, side, corner);
  for (int c = 0; c < 8; c++)
    far = fmax(far, fabs(corner[c][2]) + 2 * (fabs(corner[c][0]) / aspect + fabs(corner[c][1])) / tangent);
  if (!(far > 0) || !isfinite(2 * far))
    return NAN;
  for (int i = 0; i < 60; i++) {
    const double middle = near / 2 + far / 2;
    if (fits((const double(*)[3])corner, middle, tangent, aspect, &shift) && (!centered || shift == 0)) {
      far = middle;
      moved = shift;
    } else {
      near = middle;
    }
  }
  for (int k = 0; k < 3; k++)
    camera->target[k] += moved * side[k];
  return far;
}

const char *view_reason(const RenderOptions *options, const double bounds[6]) {
  if (render_options_given(options, OPTION_EYE))
    return "the eye was given";
  if (render_options_given(options, OPTION_VIEW))
    return "the view was given by its name";
  if (render_options_given(options, OPTION_AZIMUTH) || render_options_given(options, OPTION_ELEVATION))
    return "the angles were given";
  return side_of(bounds) == ISO ? "nothing was said: oblique, so that three sides are seen"
                                : "nothing was said, and the mesh is flat: from the side that shows it";
}

bool view_complete(const RenderOptions *options, const double bounds[6], TetcastCamera *camera) {
  const double aspect = options->size[0] / options->size[1];
  *camera = tetcast_camera_default(bounds, aspect);
  double distance = (camera->eye[2] - camera->target[2]) / options->zoom, direction[3], up[3];
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
    find_direction(options, bounds, direction, up);
  if (!eye && !render_options_given(options, OPTION_ORTHO)) {
    const bool centered = render_options_given(options, OPTION_TARGET) || render_options_given(options, OPTION_ORBIT);
    const double fitting = fit(camera, bounds, direction, up, aspect, centered) / options->zoom;
    distance = fitting > 0 ? fitting : distance;
  }
  for (int i = 0; i < 3 && !eye; i++) {
    camera->eye[i] = camera->target[i] + distance * direction[i];
    camera->up[i] = up[i];
  }
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
