/* SPDX-License-Identifier: Apache-2.0 */
#include "curves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "json.h"

enum { MOST_PIECES = 1 << 16 };

/* Of the 1e-4 of the height a tenth is left for the ends of gaussians, which are set to 0, and for rounding. */
static const double piece_share = 0.9e-4, tail_share = 0.05e-4;

typedef struct Gaussian {
  double centre, width, extinction, color[3];
} Gaussian;

/* What is cut into pieces: one channel of extinction, or three of colour. */
typedef struct Curve Curve;
struct Curve {
  int channels;
  double tolerance; /* of each channel */
  bool geometric;   /* pieces are halved at their geometric mean */
  void (*at)(const Curve *curve, double value, double *channels);
  /* A bound on how far any channel is from its chord from a to b. */
  double (*deviation)(const Curve *curve, double a, double b);
  const double *points; /* of splines and logarithms: the two control points [1 + channels] around the piece */
  const double *second; /* of splines: the second derivatives there */
  const Gaussian *gaussians;
  int gaussian_count;
};

/* ── pieces ── */

typedef struct Knots {
  double (*row)[4]; /* value, channels */
  int count, capacity;
} Knots;

static double *add_row(Knots *knots) {
  knots->row = cli_grow(knots->row, knots->count, &knots->capacity, sizeof *knots->row);
  return knots->row[knots->count++];
}

static void add_knot(const Curve *curve, double value, Knots *knots) {
  double *row = add_row(knots);
  row[0] = value;
  curve->at(curve, value, row + 1);
}

/* The knots after `a` up to `b`. A piece without a number inside it has nothing to be far from. */
static void add_pieces(const Curve *curve, double a, double b, Knots *knots) {
  const double middle = curve->geometric ? sqrt(a) * sqrt(b) : a / 2 + b / 2;
  if (knots->count > MOST_PIECES)
    return;
  if (curve->deviation(curve, a, b) <= curve->tolerance || !(a < middle && middle < b)) {
    add_knot(curve, b, knots);
    return;
  }
  add_pieces(curve, a, middle, knots);
  add_pieces(curve, middle, b, knots);
}

/* Cuts what is below 0. Where a chord crosses 0, and not before, its piece becomes two: so each is max(chord, 0), which
 * is as near to max(curve, 0) as the chord is to the curve. How many channels of pieces were cut. */
static int cut_negative(Knots *knots, int channels) {
  Knots cut = {0};
  int count = 0;
  for (int i = 0; i < knots->count; i++) {
    const double *left = knots->row[i ? i - 1 : 0], *right = knots->row[i];
    double zeros[3];
    int zero_count = 0;
    for (int k = 1; k <= channels; k++) {
      count += i > 0 && (left[k] < 0 || right[k] < 0);
      if ((left[k] < 0) == (right[k] < 0) || left[0] == right[0])
        continue;
      const double zero = left[0] + (right[0] - left[0]) * (left[k] / (left[k] - right[k]));
      int at = zero_count++;
      for (; at > 0 && zeros[at - 1] > zero; at--)
        zeros[at] = zeros[at - 1];
      zeros[at] = zero;
    }
    for (int z = 0; z <= zero_count; z++) {
      const double value = z < zero_count ? zeros[z] : right[0];
      if (z < zero_count && !(value > cut.row[cut.count - 1][0] && value < right[0]))
        continue;
      double *row = add_row(&cut);
      row[0] = value;
      const double t = z < zero_count ? (value - left[0]) / (right[0] - left[0]) : 1;
      for (int k = 1; k <= channels; k++)
        row[k] = fmax(t < 1 ? left[k] + (right[k] - left[k]) * t : right[k], 0);
    }
  }
  free(knots->row);
  *knots = cut;
  return count;
}

/* Makes a transfer function of the knots, which it frees; NULL after a message. */
static TetcastTransferFunction *create(TetcastContext *context, const char *place, Knots *color, Knots *extinction) {
  TetcastTransferFunction *result = NULL;
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  double *pairs = cli_allocate(sizeof(double) * 2 * (size_t)extinction->count);
  for (int i = 0; i < extinction->count; i++)
    memcpy(pairs + 2 * (size_t)i, extinction->row[i], 2 * sizeof *pairs);
  desc.color = color->row[0];
  desc.color_count = color->count;
  desc.extinction = pairs;
  desc.extinction_count = extinction->count;
  if (color->count > MOST_PIECES || extinction->count > MOST_PIECES) {
    cli_error("%s: the curve would take more than %d linear pieces", place, MOST_PIECES);
  } else {
    cli_set_place(place);
    const TetcastStatus status = tetcast_transfer_function_create(context, &desc, &result);
    if (status != TETCAST_OK)
      cli_failed(status);
    cli_set_place(NULL);
  }
  if (result)
    cli_note("%s: the curve is drawn as linear pieces, %d of extinction and %d of colour", place, extinction->count - 1,
             color->count - 1);
  free(pairs);
  free(color->row);
  free(extinction->row);
  return result;
}

/* ── through control points ── */

/* Linear in log v. In terms of x = b / a a chord of log v is furthest from it where its slope is that of the logarithm,
 * at v = a / t with t = log x / (x - 1), and there by t - 1 - log t. With u = t - 1, which is negative, and near 0 for
 * short pieces, that is u - log(1 + u) = u^2/2 - u^3/3 + ... <= u^2 / 2 / (1 + u). */
static double log_deviation(const Curve *curve, double a, double b) {
  const double *left = curve->points, *right = left + 1 + curve->channels;
  const double growth = (b - a) / a, u = log1p(growth) / growth - 1;
  const double share = (u > -1e-3 ? u * u / 2 / (1 + u) : u - log1p(u)) / log1p((right[0] - left[0]) / left[0]);
  double largest = 0;
  for (int k = 1; k <= curve->channels; k++)
    largest = fmax(largest, fabs(right[k] - left[k]));
  return largest > 0 ? largest * share : 0;
}

static void log_at(const Curve *curve, double value, double *channels) {
  const double *left = curve->points, *right = left + 1 + curve->channels;
  const double t = log1p((value - left[0]) / left[0]) / log1p((right[0] - left[0]) / left[0]);
  for (int k = 1; k <= curve->channels; k++)
    channels[k - 1] = t < 1 ? left[k] + (right[k] - left[k]) * t : right[k];
}

/* A function whose second derivative is at most m in magnitude is no further from its chord than m h^2 / 8: the
 * remainder of interpolation is f''(x) (v - a) (v - b) / 2. That of a cubic is linear, so it is largest at an end. */
static double spline_deviation(const Curve *curve, double a, double b) {
  const double *left = curve->points, *right = left + 1 + curve->channels, length = right[0] - left[0];
  const double from = (a - left[0]) / length, to = (b - left[0]) / length;
  double largest = 0;
  for (int k = 0; k < curve->channels; k++) {
    const double m = curve->second[k], slope = curve->second[curve->channels + k] - m;
    largest = fmax(largest, fmax(fabs(m + slope * from), fabs(m + slope * to)));
  }
  return largest * (b - a) * (b - a) / 8;
}

static void spline_at(const Curve *curve, double value, double *channels) {
  const double *left = curve->points, *right = left + 1 + curve->channels, length = right[0] - left[0];
  const double t = (value - left[0]) / length, s = 1 - t;
  for (int k = 0; k < curve->channels; k++)
    channels[k] = s * left[k + 1] + t * right[k + 1] +
                  ((s * s - 1) * s * curve->second[k] + (t * t - 1) * t * curve->second[curve->channels + k]) * length *
                      length / 6;
}

/* The second derivatives [count][channels] of the natural spline, for free(): 0 at both ends, and between them such
 * that first derivatives agree, m[i-1] h[i-1] + 2 m[i] (h[i-1] + h[i]) + m[i+1] h[i] = 6 (slope[i] - slope[i-1]), by
 * elimination from the left. False: they overflow. */
static bool find_second(const double *points, int64_t count, int channels, double *second) {
  const int64_t width = channels + 1;
  double *factor = cli_allocate(sizeof *factor * (size_t)count);
  bool finite = true;
  memset(second, 0, sizeof *second * (size_t)(count * channels));
  factor[0] = 0;
  for (int64_t i = 1; i + 1 < count; i++) {
    const double *p = points + i * width, before = p[0] - p[-width], after = p[width] - p[0];
    const double pivot = 2 * (before + after) - before * factor[i - 1];
    factor[i] = after / pivot;
    for (int k = 0; k < channels; k++) {
      const double bend = (p[width + k + 1] - p[k + 1]) / after - (p[k + 1] - p[k + 1 - width]) / before;
      second[i * channels + k] = (6 * bend - before * second[(i - 1) * channels + k]) / pivot;
    }
  }
  for (int64_t i = count - 2; i > 0; i--)
    for (int k = 0; k < channels; k++) {
      second[i * channels + k] -= factor[i] * second[(i + 1) * channels + k];
      finite = finite && isfinite(second[i * channels + k]);
    }
  free(factor);
  return finite;
}

/* What of control points can't be a curve; NULL: nothing. For free(). */
static char *find_fault(const char *key, const double *points, int64_t count, int channels, bool spline) {
  const int64_t width = channels + 1;
  if (spline && count < 3)
    return cli_print("%s: a spline goes through three points or more, not %lld", key, (long long)count);
  for (int64_t i = 0; i < count; i++) {
    if (!spline && !(points[i * width] > 0))
      return cli_print("%s[%lld]: the value %g has no logarithm; \"log\" needs values above 0", key, (long long)i,
                       points[i * width]);
    if (spline && i > 0 && points[i * width] == points[(i - 1) * width])
      return cli_print("%s[%lld]: the value %g is there twice; a spline has no steps", key, (long long)i,
                       points[i * width]);
  }
  return NULL;
}

/* The pieces of the curve through control points [count][1 + channels]; false after a message. */
static bool cut_through(const char *place, const char *key, const double *points, int64_t count, int channels,
                        bool spline, Knots *knots) {
  const int64_t width = channels + 1;
  double height = 0, *second = spline ? cli_allocate(sizeof(double) * (size_t)(count * channels)) : NULL;
  char *fault = find_fault(key, points, count, channels, spline);
  if (!fault && spline && !find_second(points, count, channels, second))
    fault = cli_print("%s: points are too close to each other, or too high, for a spline", key);
  if (fault) {
    cli_error("%s: %s", place, fault);
    free(fault);
    free(second);
    return false;
  }
  for (int64_t i = 0; i < count; i++)
    for (int k = 1; k <= channels; k++)
      height = fmax(height, points[i * width + k]);
  Curve curve = {.channels = channels, .tolerance = piece_share * height, .geometric = !spline};
  curve.at = spline ? spline_at : log_at;
  curve.deviation = spline ? spline_deviation : log_deviation;
  memcpy(add_row(knots), points, sizeof *points * (size_t)width);
  for (int64_t i = 0; i + 1 < count; i++) {
    curve.points = points + i * width;
    curve.second = spline ? second + i * channels : NULL;
    if (curve.points[width] > curve.points[0])
      add_pieces(&curve, curve.points[0], curve.points[width], knots);
    else /* a step */
      memcpy(add_row(knots), curve.points + width, sizeof *points * (size_t)width);
  }
  free(second);
  if (spline && knots->count <= MOST_PIECES && cut_negative(knots, channels) > 0)
    cli_note("%s: %s: the spline swings below 0, where it is cut", place, key);
  return true;
}

bool curves_through(TetcastContext *context, const char *place, const json_t *root, TetcastTransferFunction **control) {
  static const char *const keys[] = {"spline", "log"};
  for (int i = 0; i < 2; i++)
    if (json_object_get(root, keys[i]) && !json_is_boolean(json_object_get(root, keys[i]))) {
      cli_error("%s: %s: expected true or false", place, keys[i]);
      return false;
    }
  const bool spline = json_is_true(json_object_get(root, "spline")), log = json_is_true(json_object_get(root, "log"));
  if (spline && log)
    cli_error("%s: \"spline\" and \"log\" exclude each other", place);
  if (spline == log)
    return !spline;
  int64_t color_count, extinction_count;
  const double *color = tetcast_transfer_function_color(*control, &color_count);
  const double *extinction = tetcast_transfer_function_extinction(*control, &extinction_count);
  const char *key = json_object_get(root, "opacity") ? "opacity" : "extinction";
  Knots knots[2] = {0};
  TetcastTransferFunction *result = NULL;
  if (cut_through(place, "color", color, color_count, 3, spline, &knots[0]) &&
      cut_through(place, key, extinction, extinction_count, 1, spline, &knots[1])) {
    result = create(context, place, &knots[0], &knots[1]);
  } else {
    free(knots[0].row);
    free(knots[1].row);
  }
  if (!result)
    return false;
  tetcast_transfer_function_destroy(control);
  *control = result;
  return true;
}

/* ── gaussians ── */

static double bell(const Gaussian *gaussian, double value) {
  const double z = (value - gaussian->centre) / gaussian->width;
  return gaussian->extinction * exp(-z * z / 2);
}

static void sum_at(const Curve *curve, double value, double *sum) {
  *sum = 0;
  for (int i = 0; i < curve->gaussian_count; i++)
    *sum += bell(&curve->gaussians[i], value);
}

/* Of e exp(-z^2/2) with z = (v - c) / w the second derivative is e (z^2 - 1) exp(-z^2/2) / w^2, at most e / w^2 in
 * magnitude, and in a piece at most e exp(-least z^2 / 2) max(1, largest z^2 - 1) / w^2. With that of the sum the chord
 * is as near as for splines. */
static double sum_deviation(const Curve *curve, double a, double b) {
  double deviation = 0;
  for (int i = 0; i < curve->gaussian_count; i++) {
    const Gaussian *gaussian = &curve->gaussians[i];
    const double p = (a - gaussian->centre) / gaussian->width, q = (b - gaussian->centre) / gaussian->width;
    const double least = p <= 0 && q >= 0 ? 0 : fmin(p * p, q * q), largest = fmax(p * p, q * q);
    const double local = fmin(exp(-least / 2) * fmax(1, largest - 1), 1);
    deviation += gaussian->extinction * local * ((b - a) / gaussian->width) * ((b - a) / gaussian->width) / 8;
  }
  return deviation;
}

/* The logarithm of a gaussian over that of another one. */
static double log_ratio(const Gaussian *over, const Gaussian *under, double value) {
  const double y = (value - over->centre) / over->width, z = (value - under->centre) / under->width;
  return log(over->extinction / under->extinction) + z * z / 2 - y * y / 2;
}

static int largest_at(const Curve *curve, double value) {
  int largest = 0;
  for (int i = 1; i < curve->gaussian_count; i++)
    if (log_ratio(&curve->gaussians[i], &curve->gaussians[largest], value) > 0)
      largest = i;
  return largest;
}

/* The mean of the colours, weighted by the gaussians. */
static void mean_at(const Curve *curve, double value, double *mean) {
  const Gaussian *largest = &curve->gaussians[largest_at(curve, value)];
  double sum = 0;
  memset(mean, 0, 3 * sizeof *mean);
  for (int i = 0; i < curve->gaussian_count; i++) {
    const double weight = exp(log_ratio(&curve->gaussians[i], largest, value));
    sum += weight;
    for (int k = 0; k < 3; k++)
      mean[k] += weight * curve->gaussians[i].color[k];
  }
  for (int k = 0; k < 3; k++)
    mean[k] /= sum;
}

/* Of a gaussian beside the one that counts most in a piece: bounds there on its weight, and on how much the first and
 * second derivatives of their logarithms differ. The first one's is linear in v, thus largest at an end. */
typedef struct Beside {
  double weight, slope, bend;
} Beside;

static Beside beside(const Gaussian *gaussian, const Gaussian *most, double a, double b) {
  const double square = gaussian->width * gaussian->width, own = most->width * most->width;
  const double bend = fabs(1 / own - 1 / square);
  const double at_a = fabs((most->centre - a) / own - (gaussian->centre - a) / square);
  const double at_b = fabs((most->centre - b) / own - (gaussian->centre - b) / square);
  const double top = (most->centre / own - gaussian->centre / square) / (1 / own - 1 / square);
  double largest = fmax(log_ratio(gaussian, most, a), log_ratio(gaussian, most, b));
  if (a < top && top < b)
    largest = fmax(largest, log_ratio(gaussian, most, top));
  return (Beside){exp(fmin(largest, 0)), fmax(at_a, at_b), bend};
}

/* Weights are p_i = exp(q_i) / sum of exp(q_j), with q_i = log e_i - (v - c_i)^2 / (2 w_i^2), and n being any of them,
 * here the one that is largest in the middle, the mean is c_n + sum of p_i (c_i - c_n). In a piece p_i is at most
 * P_i = exp(largest q_i - q_n), so the mean, and its chord, stay in an interval of length sum of P_i |c_i - c_n|, which
 * is one bound. With r_i = q_i' - q_n', s_i = q_i'' - q_n'', and E and V for mean and variance by the weights,
 *   p_i'' = p_i ((r_i - E r)^2 - V r + s_i - E s),
 * whose magnitude is at most P_i ((|r_i| + E)^2 + E2 + |s_i| + S) where E, E2 and S are the sums of P_j |r_j|, P_j
 * r_j^2 and P_j |s_j|. So gaussians that are far away don't count. With that of the mean, the chord is as near as for
 * splines, which is the other bound. */
static double mean_deviation(const Curve *curve, double a, double b) {
  const Gaussian *list = curve->gaussians, *most = &list[largest_at(curve, a / 2 + b / 2)];
  double slope = 0, square = 0, bend = 0, distance[3] = {0}, second[3] = {0}, deviation = 0;
  for (int i = 0; i < curve->gaussian_count; i++) {
    const Beside other = beside(&list[i], most, a, b);
    slope += other.weight * other.slope;
    square += other.weight * other.slope * other.slope;
    bend += other.weight * other.bend;
  }
  for (int i = 0; i < curve->gaussian_count; i++) {
    const Beside other = beside(&list[i], most, a, b);
    const double change = (other.slope + slope) * (other.slope + slope) + square + other.bend + bend;
    for (int k = 0; k < 3; k++) {
      const double difference = other.weight * fabs(list[i].color[k] - most->color[k]);
      distance[k] += difference;
      second[k] += difference * change;
    }
  }
  for (int k = 0; k < 3; k++)
    deviation = fmax(deviation, fmin(distance[k], second[k] * (b - a) * (b - a) / 8));
  return deviation;
}

/* The value of an object's key, or of its other spelling. */
static const json_t *member(const json_t *object, const char *key, const char *other) {
  const json_t *value = json_object_get(object, key);
  return value ? value : json_object_get(object, other);
}

/* What one gaussian has, with the opacity for its extinction where that is stated; NULL, or what is wrong with it. */
static const char *read_gaussian(const json_t *object, bool opacity, Gaussian *gaussian) {
  static const char *const form = "expected {\"centre\": value, \"width\": w, \"extinction\": or \"opacity\": height, "
                                  "\"colour\": [red, green, blue]}, all with the same of the two";
  const json_t *centre = member(object, "centre", "center"), *width = json_object_get(object, "width");
  const json_t *height = json_object_get(object, opacity ? "opacity" : "extinction");
  const json_t *color = member(object, "colour", "color");
  if (!json_is_number(centre) || !json_is_number(width) || !json_is_number(height) || !json_is_array(color) ||
      cli_json_numbers(color, 3, gaussian->color) != 3 || json_object_size(object) != 4)
    return form;
  gaussian->centre = json_number_value(centre);
  gaussian->width = json_number_value(width);
  gaussian->extinction = json_number_value(height);
  if (!(gaussian->width > 0))
    return "width: expected a number above 0";
  if (gaussian->width < 0x1p-40 * fabs(gaussian->centre))
    return "width: too small beside the centre for numbers to tell its values apart";
  if (!(gaussian->extinction >= 0) || (opacity && gaussian->extinction > 1))
    return opacity ? "opacity: expected a number from 0 to 1" : "extinction: expected a number, 0 or above";
  for (int k = 0; k < 3; k++)
    if (!(gaussian->color[k] >= 0))
      return "colour: expected three numbers, 0 or above";
  return NULL;
}

/* Makes extinctions of opacities, as it is done for knots; false after a message. */
static bool convert(TetcastContext *context, const char *place, const TetcastTransferFunctionDesc *given,
                    Gaussian *list, int count) {
  static const double black[4] = {0, 0, 0, 0};
  double *knots = cli_allocate(2 * sizeof *knots * (size_t)count);
  TetcastTransferFunctionDesc desc = *given;
  TetcastTransferFunction *function = NULL;
  for (int i = 0; i < count; i++) {
    knots[2 * i] = i;
    knots[2 * i + 1] = list[i].extinction;
  }
  desc.color = black;
  desc.color_count = 1;
  desc.opacity = knots;
  desc.opacity_count = count;
  cli_set_place(place);
  const TetcastStatus status = tetcast_transfer_function_create(context, &desc, &function);
  if (status != TETCAST_OK)
    cli_failed(status);
  cli_set_place(NULL);
  int64_t size;
  const double *extinction = function ? tetcast_transfer_function_extinction(function, &size) : NULL;
  for (int i = 0; extinction && i < count; i++)
    list[i].extinction = extinction[2 * i + 1];
  tetcast_transfer_function_destroy(&function);
  free(knots);
  return status == TETCAST_OK;
}

/* The pieces of the sum and of the colours. Beyond where the sum exceeds a small share of its height it is 0, and
 * colours are not followed there. */
static void cut_gaussians(const Gaussian *list, int count, Knots *color, Knots *extinction) {
  double height = 0, brightness = 0, begin = INFINITY, end = -INFINITY;
  for (int i = 0; i < count; i++) {
    height = fmax(height, list[i].extinction);
    for (int k = 0; k < 3; k++)
      brightness = fmax(brightness, list[i].color[k]);
  }
  for (int i = 0; i < count; i++) { /* each has its part of the share */
    const double reach = list[i].width * sqrt(2 * log(fmax(list[i].extinction / height / tail_share * count, 1)));
    begin = fmin(begin, list[i].centre - reach);
    end = fmax(end, list[i].centre + reach);
  }
  Curve curve = {.channels = 1, .gaussians = list, .gaussian_count = count};
  curve.tolerance = piece_share * height;
  curve.at = sum_at;
  curve.deviation = sum_deviation;
  add_knot(&curve, begin, extinction);
  add_pieces(&curve, begin, end, extinction);
  extinction->row[0][1] = extinction->row[extinction->count - 1][1] = 0;
  curve.channels = 3;
  curve.tolerance = piece_share * brightness;
  curve.at = mean_at;
  curve.deviation = mean_deviation;
  add_knot(&curve, begin, color);
  add_pieces(&curve, begin, end, color);
}

bool curves_gaussian(const json_t *root) {
  return json_object_get(root, "gaussians");
}

TetcastTransferFunction *curves_of_gaussians(TetcastContext *context, const char *place, const json_t *root,
                                             const TetcastTransferFunctionDesc *desc) {
  const json_t *array = json_object_get(root, "gaussians"), *unit_distance = json_object_get(root, "unit_distance");
  const int size = (int)json_array_size(array);
  const bool opacity = json_object_get(json_array_get(array, 0), "opacity"), of_row = json_object_get(root, "at");
  if (size == 0 || json_object_size(root) != 1 + (size_t)(unit_distance != NULL) + (size_t)of_row) {
    cli_error("%s: gaussians: expected a list of them, and beside it no more than \"unit_distance\"", place);
    return NULL;
  }
  if (unit_distance && !opacity) {
    cli_error("%s: unit_distance: belongs to \"opacity\", not to \"extinction\"", place);
    return NULL;
  }
  Gaussian *list = cli_allocate(sizeof *list * (size_t)size);
  const char *fault = NULL;
  for (int i = 0; i < size && !fault; i++) {
    fault = read_gaussian(json_array_get(array, (size_t)i), opacity, &list[i]);
    if (fault)
      cli_error("%s: gaussians[%d]: %s", place, i, fault);
  }
  int count = 0;
  TetcastTransferFunction *result = NULL;
  if (!fault && (!opacity || convert(context, place, desc, list, size))) {
    for (int i = 0; i < size; i++) /* those of height 0 are none */
      if (list[i].extinction > 0)
        list[count++] = list[i];
    Knots color = {0}, extinction = {0};
    if (count > 0) {
      cut_gaussians(list, count, &color, &extinction);
    } else {
      memcpy(add_row(&color), (double[4]){0}, sizeof(double[4]));
      memcpy(add_row(&extinction), (double[4]){0}, sizeof(double[4]));
    }
    result = create(context, place, &color, &extinction);
  }
  free(list);
  return result;
}
