/* SPDX-License-Identifier: Apache-2.0 */
#include "candidates.h"

#include <math.h>
#include <string.h>

enum { BINS = 256, GRADIENT_BINS = 128, LAYERS = 6 };

/* The candidate's extinctions times what each place of the colour map counts. */
static void weigh(Design *design, double (*weight)(double place, bool diverging)) {
  double most = 0;
  for (int i = 0; i < design->count; i++) {
    double *knot = design->knots[i];
    knot[1] *= weight(design_place(&design->map, knot[0]), design->map.diverging);
    most = fmax(most, knot[1]);
  }
  for (int i = 0; i < design->count && most > 0; i++)
    design->knots[i][1] /= most;
}

static double upper(double place, bool diverging) {
  return pow(diverging ? fabs(2 * place - 1) : place, 3);
}

static double lower(double place, bool diverging) {
  return pow(1 - (diverging ? fabs(2 * place - 1) : place), 3);
}

/* A thin band of values, and nothing between it and the one before. */
static void add_band(Design *design, double place, double half) {
  static const double heights[3] = {0, 1, 0};
  const double least = design->count > 0 ? design->knots[design->count - 1][0] : -INFINITY;
  for (int i = 0; i < 3 && design->count < DESIGN_KNOTS; i++) {
    const double value = design_value(&design->map, place + (i - 1) * half);
    if (value < least || (design->count > 0 && value < design->knots[design->count - 1][0]))
      continue;
    design->knots[design->count][0] = value;
    design->knots[design->count++][1] = heights[i];
  }
}

static void set_layers(Design *design) {
  design->count = 0;
  for (int i = 0; i < LAYERS; i++)
    add_band(design, (i + 0.5) / LAYERS, 0.15 / LAYERS);
}

static void set_boundaries(Candidates *c, Design *design) {
  design->count = 0;
  for (int i = 0; i < c->salient_count; i++)
    add_band(design, design_place(&design->map, c->salient[i]), 0.03);
}

static void set_ramp(Design *design) {
  const bool diverging = design->map.diverging;
  design->count = 0;
  for (int i = 0; i <= 2; i++) {
    design->knots[design->count][0] = design_value(&design->map, i / 2.0);
    design->knots[design->count++][1] = diverging ? fabs(i - 1.0) : i / 2.0;
  }
}

/* How far the mean stands out at a peak: above the lower of the valleys that part it from higher ones, or the ends. */
static double prominence(const double mean[BINS + 1], int i) {
  double valley[2] = {mean[i], mean[i]};
  for (int side = 0; side < 2; side++)
    for (int k = i; k >= 0 && k <= BINS && mean[k] <= mean[i]; k += side ? 1 : -1)
      valley[side] = fmin(valley[side], mean[k]);
  return mean[i] - fmax(valley[0], valley[1]);
}

/* Whether the isosurfaces round edge i have an area worth counting: at the end of those that do, a peak is none. */
static bool exists(const TetcastStatistics *s, int i) {
  double largest = 0;
  for (int k = 0; k <= BINS; k++)
    largest = fmax(largest, s->area[k]);
  bool all = i >= 6 && i <= BINS - 6;
  for (int k = -6; k <= 6 && all; k++)
    all = s->area[i + k] > 0.01 * largest;
  return all;
}

/* Where the gradient's mean over an isosurface has a peak that stands out, there is a boundary between two materials.
 * Isosurfaces that hardly exist don't count, and of peaks the highest do (Bajaj, Pascucci & Schikore 1997). */
static void find_salient(Candidates *c) {
  const TetcastStatistics *s = c->statistics;
  double mean[BINS + 1], largest_area = 0, largest = 0;
  for (int i = 0; i <= BINS; i++)
    largest_area = fmax(largest_area, s->area[i]);
  for (int i = 0; i <= BINS; i++)
    mean[i] = s->area[i] > 0.01 * largest_area ? s->gradient[i] / s->area[i] : 0;
  for (int pass = 0; pass < 12; pass++)
    for (int i = 1; i < BINS; i++)
      mean[i] = (mean[i - 1] + 2 * mean[i] + mean[i + 1]) / 4;
  for (int i = 1; i < BINS; i++)
    largest = fmax(largest, mean[i]);
  c->salient_count = 0;
  double heights[SALIENT];
  for (int i = 2; i < BINS - 1; i++) {
    if (!(mean[i] > mean[i - 1] && mean[i] >= mean[i + 1] && prominence(mean, i) > 0.12 * largest) || !exists(s, i))
      continue;
    int at = c->salient_count;
    if (at == SALIENT) { /* in place of the lowest, if that is lower */
      at = 0;
      for (int k = 1; k < SALIENT; k++)
        at = heights[k] < heights[at] ? k : at;
      if (heights[at] >= mean[i])
        continue;
      memmove(heights + at, heights + at + 1, sizeof *heights * (size_t)(SALIENT - 1 - at));
      memmove(c->salient + at, c->salient + at + 1, sizeof *c->salient * (size_t)(SALIENT - 1 - at));
      at = SALIENT - 1;
    } else {
      c->salient_count++;
    }
    heights[at] = mean[i];
    c->salient[at] = s->range[0] + (s->range[1] - s->range[0]) * i / BINS;
  }
}

static Candidate *add(Candidates *c, const char *name, const char *words) {
  Candidate *candidate = &c->candidate[c->count++];
  *candidate = (Candidate){.name = name, .words = words, .design = c->candidate[0].design};
  return candidate;
}

static void add_all(Candidates *c) {
  const DesignMap *map = &c->candidate[0].design.map;
  if (c->salient_count > 0)
    set_boundaries(c, &add(c, "boundaries", "thin layers where the gradient is largest")->design);
  set_layers(&add(c, "layers", "thin layers at equal distances")->design);
  weigh(&add(c, map->diverging ? "far from the middle" : "high", "what has the largest values")->design, upper);
  weigh(&add(c, map->diverging ? "near the middle" : "low", "what has the smallest values")->design, lower);
  set_ramp(&add(c, "ramp", "denser in proportion to the value")->design);
  add(c, "dark", "as the first, in other colours")->preset = map->diverging ? "RdBu_r" : "inferno_r";
  add(c, "many colours", "as the first, in other colours")->preset = map->diverging ? "rainbow-desaturated" : "turbo";
}

TetcastStatus candidates_find(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                              const DesignDesc *desc, const Design *first, Candidates *c) {
  *c = (Candidates){.count = 1};
  c->candidate[0] = (Candidate){.name = "balanced", .words = "every range of colours about as much as any other"};
  if (first)
    c->candidate[0].design = *first;
  TetcastStatus status = first ? TETCAST_OK : design_find(context, mesh, field, desc, &c->candidate[0].design);
  const double *range = c->candidate[0].design.map.range;
  if (status != TETCAST_OK)
    return status;
  TetcastStatisticsDesc statistics = tetcast_statistics_desc_default();
  if (range[0] < range[1])
    memcpy(statistics.range, range, sizeof statistics.range);
  statistics.bins = BINS;
  statistics.gradient_bins = tetcast_field_association(field) == TETCAST_CELL ? 0 : GRADIENT_BINS;
  status = tetcast_statistics_create(context, mesh, field, &statistics, &c->statistics);
  if (status == TETCAST_OK && range[0] < range[1]) {
    if (tetcast_field_association(field) != TETCAST_CELL)
      find_salient(c);
    add_all(c);
  }
  return status;
}

void candidates_release(TetcastContext *context, Candidates *c) {
  if (context)
    tetcast_statistics_destroy(context, &c->statistics);
}
