/* SPDX-License-Identifier: Apache-2.0 */
#include "color_space.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void blend(const double from[3], const double to[3], double t, double result[3]) {
  for (int k = 0; k < 3; k++)
    result[k] = (1 - t) * from[k] + t * to[k];
}

/* ── hue, saturation, value ── */

static void hsv_of(const double rgb[3], double hsv[3]) {
  const double most = fmax(rgb[0], fmax(rgb[1], rgb[2])), span = most - fmin(rgb[0], fmin(rgb[1], rgb[2]));
  double hue = 0;
  if (span > 0)
    hue = rgb[0] == most   ? (rgb[1] - rgb[2]) / span
          : rgb[1] == most ? 2 + (rgb[2] - rgb[0]) / span
                           : 4 + (rgb[0] - rgb[1]) / span;
  hsv[0] = (hue < 0 ? hue + 6 : hue) / 6;
  hsv[1] = most > 0 ? span / most : 0;
  hsv[2] = most;
}

static void rgb_of_hsv(const double hsv[3], double rgb[3]) {
  for (int k = 0; k < 3; k++) { /* red is full about hue 0, green about 1/3, blue about 2/3 */
    double away = fabs(hsv[0] - k / 3.0);
    away = fmin(away, fabs(1 - away));
    const double pure = fmin(fmax(2 - 6 * away, 0), 1);
    rgb[k] = hsv[2] * (1 - hsv[1] + hsv[1] * pure);
  }
}

static void hsv_between(bool wrap, const double from[3], const double to[3], double t, double rgb[3]) {
  double a[3], b[3], hsv[3];
  hsv_of(from, a);
  hsv_of(to, b);
  if (wrap && fabs(a[0] - b[0]) > 0.5)
    *(a[0] > b[0] ? a : b) -= 1;
  blend(a, b, t, hsv);
  hsv[0] -= floor(hsv[0]);
  rgb_of_hsv(hsv, rgb);
}

/* ── L*a*b* ── */

static const double white[3] = {0.9505, 1, 1.089};

static void lab_of(const double rgb[3], double lab[3]) {
  static const double rows[3][3] = {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
  double linear[3], f[3];
  for (int k = 0; k < 3; k++)
    linear[k] = rgb[k] > 0.04045 ? pow((rgb[k] + 0.055) / 1.055, 2.4) : rgb[k] / 12.92;
  for (int k = 0; k < 3; k++) {
    const double ratio = (rows[k][0] * linear[0] + rows[k][1] * linear[1] + rows[k][2] * linear[2]) / white[k];
    f[k] = ratio > 0.008856 ? cbrt(ratio) : 7.787 * ratio + 16 / 116.0;
  }
  lab[0] = 116 * f[1] - 16;
  lab[1] = 500 * (f[0] - f[1]);
  lab[2] = 200 * (f[1] - f[2]);
}

/* What the display can't show is made darker, and loses what is below 0. */
static void rgb_of_lab(const double lab[3], double rgb[3]) {
  static const double rows[3][3] = {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
  const double middle = (lab[0] + 16) / 116, f[3] = {lab[1] / 500 + middle, middle, middle - lab[2] / 200};
  double xyz[3], most = 1;
  for (int k = 0; k < 3; k++) {
    const double cube = f[k] * f[k] * f[k];
    xyz[k] = white[k] * (cube > 0.008856 ? cube : (f[k] - 16 / 116.0) / 7.787);
  }
  for (int k = 0; k < 3; k++) {
    const double linear = rows[k][0] * xyz[0] + rows[k][1] * xyz[1] + rows[k][2] * xyz[2];
    rgb[k] = linear > 0.0031308 ? 1.055 * pow(linear, 1 / 2.4) - 0.055 : 12.92 * linear;
    most = fmax(most, rgb[k]);
  }
  for (int k = 0; k < 3; k++)
    rgb[k] = fmax(rgb[k] / most, 0);
}

/* ── diverging ── */

/* Magnitude, saturation and hue: L*a*b* in spherical coordinates. */
static void msh_of(const double rgb[3], double msh[3]) {
  double lab[3];
  lab_of(rgb, lab);
  msh[0] = sqrt(lab[0] * lab[0] + lab[1] * lab[1] + lab[2] * lab[2]);
  msh[1] = msh[0] > 0.001 ? acos(fmin(lab[0] / msh[0], 1)) : 0;
  msh[2] = msh[1] > 0.001 ? atan2(lab[2], lab[1]) : 0;
}

static double angle_between(double a, double b) {
  const double angle = fabs(a - b);
  return angle > pi ? 2 * pi - angle : angle;
}

/* The hue at which a colour without saturation, of this magnitude, is left for a saturated one. */
static double hue_for(const double saturated[3], double magnitude) {
  if (saturated[0] >= magnitude - 0.1)
    return saturated[2];
  const double spin =
      saturated[1] * sqrt(magnitude * magnitude - saturated[0] * saturated[0]) / (saturated[0] * sin(saturated[1]));
  return saturated[2] > -0.3 * pi ? saturated[2] + spin : saturated[2] - spin;
}

static void diverging_between(const double from[3], const double to[3], double t, double rgb[3]) {
  double a[3], b[3], msh[3];
  msh_of(from, a);
  msh_of(to, b);
  if (a[1] > 0.05 && b[1] > 0.05 && angle_between(a[2], b[2]) > 0.33 * pi) {
    const double middle[3] = {fmax(fmax(a[0], b[0]), 88), 0, 0};
    memcpy(t < 0.5 ? b : a, middle, sizeof middle);
    t = t < 0.5 ? 2 * t : 2 * t - 1;
  }
  if (a[1] < 0.05 && b[1] > 0.05)
    a[2] = hue_for(b, a[0]);
  else if (b[1] < 0.05 && a[1] > 0.05)
    b[2] = hue_for(a, b[0]);
  blend(a, b, t, msh);
  const double across = msh[0] * sin(msh[1]);
  rgb_of_lab((double[]){msh[0] * cos(msh[1]), across * cos(msh[2]), across * sin(msh[2])}, rgb);
}

void color_space_between(ColorSpace space, const double from[3], const double to[3], double t, double rgb[3]) {
  double a[3], b[3], lab[3];
  switch (space) {
  case COLOR_SPACE_HSV:
  case COLOR_SPACE_HSV_WRAP:
    hsv_between(space == COLOR_SPACE_HSV_WRAP, from, to, t, rgb);
    break;
  case COLOR_SPACE_LAB:
    lab_of(from, a);
    lab_of(to, b);
    blend(a, b, t, lab);
    rgb_of_lab(lab, rgb);
    break;
  case COLOR_SPACE_DIVERGING:
    diverging_between(from, to, t, rgb);
    break;
  default:
    blend(from, to, t, rgb);
  }
}
