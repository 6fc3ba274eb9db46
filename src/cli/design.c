/* SPDX-License-Identifier: Apache-2.0 */
#include "design.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "color.h"

/* BINS tell values apart, and SHARES are what extinctions are found for. */
enum { BINS = 1024, SHARES = 16, COLORS = 17, DECADES = 12 };

double design_value(const DesignMap *map, double place) {
  const double *r = map->range;
  if (place <= 0 || place >= 1)
    return r[place >= 1];
  const double value =
      map->logarithmic ? exp(log(r[0]) * (1 - place) + log(r[1]) * place) : r[0] * (1 - place) + r[1] * place;
  return fmin(fmax(value, r[0]), r[1]);
}

double design_place(const DesignMap *map, double value) {
  const double *r = map->range;
  if (!(r[0] < r[1]) || !(value > r[0]))
    return 0;
  if (value >= r[1])
    return 1;
  return map->logarithmic ? log(value / r[0]) / log(r[1] / r[0])
                          : (value / 2 - r[0] / 2) / (r[1] / 2 - r[0] / 2); /* whose difference could overflow */
}

/* ── distributions ── */

/* Shares of the volume: in bins of equal width over a range, the first and last with all that lies beyond. */
typedef struct Shares {
  double range[2], bin[BINS];
} Shares;

/* What is found from the data. */
typedef struct Data {
  TetcastContext *context;
  const TetcastMesh *mesh;
  const TetcastField *field;
  const DesignDesc *desc;
  double range[2]; /* of all values */
  Shares last;     /* what was found last, as it is asked for again; with an empty range: nothing yet */
} Data;

static TetcastStatus find_shares(Data *data, const double range[2], Shares *shares) {
  Shares *last = &data->last;
  if (range[0] < range[1] && last->range[0] == range[0] && last->range[1] == range[1]) {
    *shares = *last;
    return TETCAST_OK;
  }
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  TetcastStatistics *statistics = NULL;
  memcpy(desc.range, range, sizeof desc.range);
  memcpy(shares->range, range, sizeof desc.range);
  desc.bins = BINS;
  const TetcastStatus status =
      data->desc->statistics ? data->desc->statistics(data->desc->user, &desc, &statistics)
                             : tetcast_statistics_create(data->context, data->mesh, data->field, &desc, &statistics);
  if (status != TETCAST_OK)
    return status;
  for (int i = 0; i < BINS; i++)
    shares->bin[i] = statistics->total > 0 ? statistics->volume[i] / statistics->total : 0;
  if (statistics->total > 0) {
    shares->bin[0] += statistics->below / statistics->total;
    shares->bin[BINS - 1] += statistics->above / statistics->total;
  }
  tetcast_statistics_destroy(data->context, &statistics);
  *last = *shares;
  return TETCAST_OK;
}

/* The value that this part of the sum of all bins lies below, each raised to a power: 1 for parts of the volume, less
 * for rare values to count more than by the room that they take. */
static double find_quantile(const Shares *shares, double part, double power) {
  double sum = 0, passed = 0;
  for (int i = 0; i < BINS; i++)
    sum += pow(shares->bin[i], power);
  const double wanted = part * sum;
  for (int i = 0; i < BINS; i++) {
    const double weight = pow(shares->bin[i], power);
    if (weight > 0 && passed + weight >= wanted) {
      const double place = (i + (wanted - passed) / weight) / BINS;
      return shares->range[0] * (1 - place) + shares->range[1] * place;
    }
    passed += weight;
  }
  return shares->range[1];
}

/* The same in equal parts of the logarithm to base 10, from that of `low` to that of `high`. What lies below goes to
 * *below, not to the first bin. Bins of equal width tell three decades apart: so many at a time. */
static TetcastStatus find_decades(Data *data, double low, double high, Shares *decades, double *below) {
  double passed[BINS + 1]; /* the part of the volume below each edge */
  const double least = log10(low), step = (log10(high) - least) / BINS;
  decades->range[0] = least;
  decades->range[1] = least + BINS * step;
  int edge = BINS;
  for (double top = high; edge >= 0; top /= 1000) {
    Shares shares;
    const double range[2] = {0, top};
    const TetcastStatus status = find_shares(data, range, &shares);
    if (status != TETCAST_OK)
      return status;
    double sum[BINS + 1] = {0};
    for (int i = 0; i < BINS; i++)
      sum[i + 1] = sum[i] + shares.bin[i];
    for (; edge >= 0; edge--) {
      const double place = fmin(pow(10, least + edge * step) / top, 1) * BINS;
      if (place < BINS / 1000.0)
        break;
      const int i = (int)fmin(floor(place), BINS - 1);
      passed[edge] = sum[i] + (place - i) * shares.bin[i];
    }
  }
  *below = passed[0];
  for (int i = 0; i < BINS; i++)
    decades->bin[i] = fmax(0, passed[i + 1] - passed[i]) + (i == BINS - 1 ? 1 - passed[BINS] : 0);
  return TETCAST_OK;
}

/* ── the map ── */

/* Narrows the range until rare values fill it, but single ones don't stretch it. */
static TetcastStatus narrow(Data *data, double range[2], Shares *shares) {
  for (int i = 0; i < 4; i++) {
    const double low = find_quantile(shares, 0.01, 0.3), high = find_quantile(shares, 0.99, 0.3);
    const double width = range[1] / 2 - range[0] / 2, step = width / BINS;
    const bool wide = high / 2 - low / 2 > width / 4;
    /* Ends that are within a few hundredths of those of the values themselves stay there. */
    range[0] = low / 2 - range[0] / 2 > 0.04 * width ? low : range[0];
    range[1] = range[1] / 2 - high / 2 > 0.04 * width ? high : range[1];
    if (!(range[1] / 2 - range[0] / 2 > 4 * step)) { /* all in one bin, as good as */
      range[0] = low - 2 * step;
      range[1] = high + 2 * step;
    }
    const TetcastStatus status = find_shares(data, range, shares);
    if (status != TETCAST_OK || wide)
      return status;
  }
  return TETCAST_OK;
}

/* Whether all but a twentieth of the volume, not counting what is 0 or as good as that, has values below a twentieth of
 * the largest: in linear colours that would be one of them, with a speck. And the range of those that are not quite
 * rare. */
static TetcastStatus find_log_range(Data *data, bool asked, double range[2], bool *found) {
  const double most = data->range[1], least = fmax(data->range[0], most * pow(10, -DECADES));
  Shares decades;
  double below;
  *found = false;
  if (!(data->range[0] >= 0 || asked) || !(least > 0) || !(least < most))
    return TETCAST_OK;
  const TetcastStatus status = find_decades(data, least, most, &decades, &below);
  if (status != TETCAST_OK)
    return status;
  const double low = find_quantile(&decades, 0.02, 0.5), high = find_quantile(&decades, 0.995, 0.5);
  range[0] = fmax(pow(10, low), least);
  range[1] = fmin(pow(10, high), most);
  *found = asked || (find_quantile(&decades, 0.95, 1) < log10(most / 20) && high - low >= 1.5);
  return TETCAST_OK;
}

/* A range that has a value in its middle. */
static void center_range(double center, const double reach[2], double range[2]) {
  const double half = fmax(fabs(reach[0] - center), fabs(reach[1] - center));
  range[0] = fmax(center - half, -DBL_MAX);
  range[1] = fmin(center + half, DBL_MAX);
}

static TetcastStatus find_map(Data *data, const DesignDesc *desc, Design *design) {
  DesignMap *map = &design->map;
  Shares shares;
  memcpy(map->range, desc->range ? desc->range : data->range, sizeof map->range);
  map->logarithmic = desc->logarithmic;
  map->diverging = desc->diverging;
  design->reason = desc->range ? "the range that was asked for" : "all values alike";
  if (desc->range || !(data->range[0] < data->range[1])) {
    if (desc->center)
      center_range(*desc->center, map->range, map->range);
    return TETCAST_OK;
  }
  TetcastStatus status = find_shares(data, data->range, &shares);
  if (status != TETCAST_OK)
    return status;
  const double low = find_quantile(&shares, 0.01, 0.3), high = find_quantile(&shares, 0.99, 0.3);
  const bool two_sided = low < 0 && high > 0 && fmin(-low, high) >= 0.2 * fmax(-low, high);
  if (!desc->logarithmic && (desc->center || two_sided || desc->diverging)) {
    double reach[2] = {data->range[0], data->range[1]};
    design->reason = desc->center ? "both sides of the value that was asked for" : "both signs: even about 0";
    map->diverging = true;
    status = narrow(data, reach, &shares);
    const double middle = desc->center ? *desc->center : two_sided ? 0 : reach[0] / 2 + reach[1] / 2;
    if (!desc->center && !two_sided)
      design->reason = "a diverging colour map, and values of one sign: its middle is that of the values";
    center_range(middle, reach, map->range);
    return status;
  }
  bool decades = false;
  double range[2];
  if (desc->logarithmic || find_quantile(&shares, 0.5, 1) < data->range[1] / 32)
    status = find_log_range(data, desc->logarithmic, range, &decades);
  if (status == TETCAST_OK && decades) {
    design->reason = desc->logarithmic ? "even in the logarithm, as was asked for"
                                       : "most of the volume has values far below the largest: even in the logarithm";
    map->logarithmic = true;
    memcpy(map->range, range, sizeof range);
    return status;
  }
  if (status == TETCAST_OK)
    status = narrow(data, map->range, &shares);
  design->reason = map->range[0] > data->range[0] || map->range[1] < data->range[1]
                       ? "from the first to the last values that are not quite rare"
                       : "from the least to the largest value";
  return status;
}

/* ── extinctions ── */

/* Shares of the volume in equal parts of the map. */
static TetcastStatus share_map(Data *data, const DesignMap *map, double share[SHARES]) {
  Shares shares;
  double below = 0;
  const TetcastStatus status = map->logarithmic ? find_decades(data, map->range[0], map->range[1], &shares, &below)
                                                : find_shares(data, map->range, &shares);
  memset(share, 0, sizeof(double) * SHARES);
  for (int i = 0; status == TETCAST_OK && i < BINS; i++)
    share[i / (BINS / SHARES)] += shares.bin[i] + (i == 0 ? below : 0);
  return status;
}

/* What takes much room is thin, and what is rare is dense, so that of neither too little is seen; and where the map
 * rises, or leaves its middle, matter grows denser, so that there is an inside to be seen. */
static double extinction_at(const DesignMap *map, const double share[SHARES], int i) {
  const double smooth = (share[i > 0 ? i - 1 : 0] + 2 * share[i] + share[i < SHARES - 1 ? i + 1 : i]) / 4;
  const double rarity = pow(fmax(smooth * SHARES, 1.0 / 256), -0.6), place = (i + 0.5) / SHARES;
  return rarity * (map->diverging ? 0.02 + 0.98 * fabs(2 * place - 1) : 0.2 + 0.8 * place);
}

static void set_knots(Design *design, const double share[SHARES]) {
  double extinction[SHARES], most = 0, last = -INFINITY;
  for (int i = 0; i < SHARES; i++) {
    extinction[i] = extinction_at(&design->map, share, i);
    most = fmax(most, extinction[i]);
  }
  design->count = 0;
  for (int i = 0; i < SHARES; i++) {
    const double value = design_value(&design->map, (i + 0.5) / SHARES);
    if (!(value > last)) /* in a range that is so narrow */
      continue;
    last = design->knots[design->count][0] = value;
    design->knots[design->count++][1] = fmax(extinction[i] / most, design->map.diverging ? 0.002 : 0.02);
  }
}

TetcastStatus design_find(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                          const DesignDesc *desc, Design *design) {
  Data data = {.context = context, .mesh = mesh, .field = field, .desc = desc};
  double share[SHARES];
  if (desc->whole)
    memcpy(data.range, desc->whole, sizeof data.range);
  else
    tetcast_field_range(field, data.range, NULL);
  TetcastStatus status = find_map(&data, desc, design);
  if (!(design->map.range[0] > 0)) /* as where all values above 0 are too small to be told apart by their logarithm */
    design->map.logarithmic = false;
  if (status == TETCAST_OK && design->map.range[0] < design->map.range[1]) {
    status = share_map(&data, &design->map, share);
    set_knots(design, share);
  } else {
    design->count = 1;
    design->knots[0][0] = design->map.range[0];
    design->knots[0][1] = 1;
  }
  return status;
}

/* ── colours ── */

TetcastStatus design_shape(TetcastContext *context, const Design *design, const TetcastTransferFunction *map,
                           TetcastTransferFunction **shape) {
  enum { MOST = 4 * (COLORS - 1) + 1 };
  int64_t count;
  const double *knots = tetcast_transfer_function_color(map, &count), *range = design->map.range;
  const double decades = design->map.logarithmic ? log10(range[1] / range[0]) : 0;
  const int steps = (COLORS - 1) * (decades > 6 ? 4 : decades > 2 ? 2 : 1); /* between logarithms they are straight */
  double color[MOST][4], last = -INFINITY;
  int colors = 0;
  for (int i = 0; i <= steps; i++) {
    const double place = range[0] < range[1] ? (double)i / steps : 0.5, value = design_value(&design->map, place);
    if (!(value > last))
      continue;
    last = color[colors][0] = value;
    colors_at(knots, count, place, color[colors++] + 1);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = colors;
  desc.extinction = design->knots[0];
  desc.extinction_count = design->count;
  return tetcast_transfer_function_create(context, &desc, shape);
}
