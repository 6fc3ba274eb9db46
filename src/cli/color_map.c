/* SPDX-License-Identifier: Apache-2.0 */
#include "color_map.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3, DEPTH = 20, PROBES = 8 };

/* What lies between two points. */
typedef struct Curve {
  void (*at)(const struct Curve *curve, double t, double *values);
  const double *from, *to; /* the points */
  ColorSpace space;        /* of colours */
  double tolerance;
} Curve;

void color_map_release(ColorMapKnots *knots) {
  free(knots->data);
  *knots = (ColorMapKnots){.count = 0};
}

/* One knot more; of more than two at one value the first and the last stay. */
static void add(ColorMapKnots *knots, double x, const double *values) {
  const int width = knots->width;
  if (!knots->data)
    return;
  if (knots->count == knots->capacity) {
    double *data = realloc(knots->data, sizeof *data * (size_t)(2 * knots->capacity * width));
    if (!data) {
      color_map_release(knots);
      return;
    }
    knots->data = data;
    knots->capacity *= 2;
  }
  double *next = knots->data + knots->count * width;
  const bool second = knots->count > 0 && !(x > next[-width]);
  if (second && !memcmp(next - width + 1, values, sizeof *values * (size_t)(width - 1)))
    return;
  if (second && knots->count > 1 && next[-2 * width] == next[-width])
    next -= width;
  else
    knots->count++;
  next[0] = second ? next[-width] : x;
  memcpy(next + 1, values, sizeof *values * (size_t)(width - 1));
}

static ColorMapKnots begin(int width) {
  ColorMapKnots knots = {.capacity = 64, .width = width};
  knots.data = malloc(sizeof *knots.data * (size_t)(knots.capacity * width));
  return knots;
}

/* Whether a straight line from t0 to t1 is near enough. */
static bool is_straight(const Curve *curve, int width, double t0, const double *v0, double t1, const double *v1) {
  for (int i = 1; i < PROBES; i++) {
    const double w = i / (double)PROBES;
    double values[MOST];
    curve->at(curve, t0 + (t1 - t0) * w, values);
    for (int k = 0; k + 1 < width; k++)
      if (fabs(values[k] - ((1 - w) * v0[k] + w * v1[k])) > 0.7 * curve->tolerance)
        return false;
  }
  return true;
}

/* Adds what lies behind t0 up to t1, in halves of halves. */
static void add_part(ColorMapKnots *knots, const Curve *curve, double t0, const double *v0, double t1, const double *v1,
                     int depth) {
  if (depth == 0 || is_straight(curve, knots->width, t0, v0, t1, v1)) {
    add(knots, t1 == 1 ? curve->to[0] : (1 - t1) * curve->from[0] + t1 * curve->to[0], v1);
    return;
  }
  double middle[MOST];
  const double t = t0 + (t1 - t0) / 2;
  curve->at(curve, t, middle);
  add_part(knots, curve, t0, v0, t, middle, depth - 1);
  add_part(knots, curve, t, middle, t1, v1, depth - 1);
}

/* Adds a curve that may have a kink at one place. */
static void add_curve(ColorMapKnots *knots, const Curve *curve, double kink) {
  double v0[MOST], middle[MOST], v1[MOST];
  curve->at(curve, 0, v0);
  curve->at(curve, kink, middle);
  curve->at(curve, 1, v1);
  add(knots, curve->from[0], v0);
  double off = 0;
  for (int k = 0; k + 1 < knots->width; k++)
    off = fmax(off, fabs(middle[k] - ((1 - kink) * v0[k] + kink * v1[k])));
  if (off <= 0.7 * curve->tolerance && is_straight(curve, knots->width, 0, v0, 1, v1)) {
    add(knots, curve->to[0], v1);
    return;
  }
  add_part(knots, curve, 0, v0, kink, middle, DEPTH);
  add_part(knots, curve, kink, middle, 1, v1, DEPTH);
}

static void color_at(const Curve *curve, double t, double *values) {
  color_space_between(curve->space, curve->from + 1, curve->to + 1, t, values);
}

ColorMapKnots color_map_colors(ColorSpace space, const double *points, int count) {
  ColorMapKnots knots = begin(4);
  add(&knots, points[0], points + 1);
  for (int i = 1; i < count; i++) {
    const Curve curve = {color_at, points + 4 * (i - 1), points + 4 * i, space, 1e-3};
    if (curve.to[0] > curve.from[0] && space != COLOR_SPACE_RGB)
      add_curve(&knots, &curve, 0.5);
    else
      add(&knots, curve.to[0], curve.to + 1);
  }
  return knots;
}

ColorMapKnots color_map_steps(const double *points, int count) {
  ColorMapKnots knots = begin(4);
  for (int i = 0; i < count; i++) {
    if (i > 0)
      add(&knots, points[4 * (i - 1)], points + 4 * i + 1);
    add(&knots, points[4 * i], points + 4 * i + 1);
  }
  return knots;
}

static double limited(double value, double a, double b) {
  return fmin(fmax(value, fmin(a, b)), fmax(a, b));
}

static double midpoint_of(const double *point) {
  return limited(point[2], 1e-5, 1 - 1e-5);
}

/* A cubic between the two opacities, the flatter at its ends the sharper it is, over a way that is bent: slow at its
 * ends, and half done at the midpoint. */
static void opacity_at(const Curve *curve, double t, double *values) {
  const double from = curve->from[1], to = curve->to[1], middle = midpoint_of(curve->from), sharpness = curve->from[3];
  double s = t < middle ? 0.5 * t / middle : 0.5 + 0.5 * (t - middle) / (1 - middle);
  if (sharpness < 0.01) {
    values[0] = (1 - s) * from + s * to;
    return;
  }
  const double power = 1 + 10 * sharpness;
  s = s < 0.5 ? 0.5 * pow(2 * s, power) : 1 - 0.5 * pow(2 * (1 - s), power);
  const double slope = (1 - sharpness) * (to - from), cubic = s * s * (3 - 2 * s);
  values[0] = limited(from + cubic * (to - from) + (s * (1 - s) * (1 - 2 * s)) * slope, from, to);
}

ColorMapKnots color_map_opacities(const double *points, int count) {
  ColorMapKnots knots = begin(2);
  double largest = 0;
  for (int i = 0; i < count; i++)
    largest = fmax(largest, points[4 * i + 1]);
  add(&knots, points[0], points + 1);
  for (int i = 1; i < count; i++) {
    const Curve curve = {opacity_at, points + 4 * (i - 1), points + 4 * i, .tolerance = 1e-4 * largest};
    const double kink = midpoint_of(curve.from), x = (1 - kink) * curve.from[0] + kink * curve.to[0];
    if (curve.to[0] > curve.from[0] && curve.from[3] > 0.99) { /* a step at the midpoint */
      add(&knots, x, curve.from + 1);
      add(&knots, x, curve.to + 1);
    } else if (curve.to[0] > curve.from[0]) {
      add_curve(&knots, &curve, kink);
    }
    add(&knots, curve.to[0], curve.to + 1);
  }
  return knots;
}
