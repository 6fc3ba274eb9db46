/* SPDX-License-Identifier: Apache-2.0 */
#include "decoration.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "color.h"
#include "surfaces.h"

enum { COLORS = 256, TICKS = 12 };

TetcastStatus decoration_outline(const Stage *stage, const RenderOptions *options, const TetcastRenderDesc *desc,
                                 TetcastFrame *frame) {
  if (!render_options_given(options, OPTION_OUTLINE) && !render_options_decorated(options))
    return TETCAST_OK;
  double color[3];
  surfaces_outline(options, color);
  return tetcast_scene_draw_outline(stage->scene, &stage->camera, desc, color, frame);
}

/* ── the legend ── */

static void add_label(Decoration *d, double place, char *text) {
  if (d->legend.label_count < TICKS && place >= -1e-9 && place <= 1 + 1e-9) {
    d->places[d->legend.label_count] = fmin(fmax(place, 0), 1);
    d->labels[d->legend.label_count++] = text;
  } else {
    free(text);
  }
}

/* A number with as many digits as tell it from its neighbours, which are a step away. */
static char *number_text(double value, double step) {
  const double size = fmax(fabs(value), step);
  if (fabs(value) < step * 1e-6)
    return cli_duplicate("0");
  if (size >= 1e9 || (size >= 1e5 && step >= 1000) || size < 1e-3) {
    const int digits = (int)fmax(0, floor(log10(fabs(value))) - floor(log10(step) + 1e-9));
    return cli_print("%.*e", digits < 6 ? digits : 6, value);
  }
  const int digits = (int)fmax(0, -floor(log10(step) + 1e-9));
  return cli_print("%.*f", digits, value);
}

/* Round numbers, about five of them. */
static void label_evenly(Decoration *d, const double range[2]) {
  const double width = range[1] / 5 - range[0] / 5, power = pow(10, floor(log10(width))), share = width / power;
  const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  if (!isfinite(step) || !(step > 0) || !(range[0] + step > range[0]))
    return;
  for (double i = ceil(range[0] / step - 1e-9); i * step <= range[1] + 1e-9 * step; i++)
    add_label(d, (i * step / 2 - range[0] / 2) / (range[1] / 2 - range[0] / 2), number_text(i * step, step));
}

/* Powers of ten, each or each so many; of less than two decades also 2 and 5 times them. */
static void label_decades(Decoration *d, const DesignMap *map) {
  const double low = log10(map->range[0]), high = log10(map->range[1]), every = ceil((high - low) / 7);
  static const double within[3] = {1, 2, 5};
  for (double i = floor(low); i <= high; i++)
    for (int k = 0; k < (high - low < 2 ? 3 : 1); k++)
      if (fmod(i, every) == 0) {
        const double value = within[k] * pow(10, i);
        add_label(d, (log10(value) - low) / (high - low),
                  i >= -3 && i < 5 ? cli_print("%g", value) : cli_print("%.0e", value));
      }
}

/* A bar of the transfer function's colours, over its map, or from its first to its last colour. */
static void make_bar(const Stage *stage, Decoration *d) {
  int64_t count;
  const double *knots = tetcast_transfer_function_color(stage->transfer_function, &count);
  const DesignMap map = stage->designed ? stage->design.map : (DesignMap){.range = {knots[0], knots[4 * (count - 1)]}};
  if (!(map.range[0] < map.range[1])) { /* a single value */
    d->legend.color_count = 1;
    d->legend.categories = 1;
    colors_at(knots, count, map.range[0], d->colors);
    add_label(d, 0, cli_print("%g", map.range[0]));
    return;
  }
  d->legend.color_count = COLORS;
  for (int i = 0; i < COLORS; i++)
    colors_at(knots, count, design_value(&map, i / (COLORS - 1.0)), d->colors + 3 * i);
  if (map.logarithmic)
    label_decades(d, &map);
  else
    label_evenly(d, map.range);
}

/* The colours of labels, each with its number. */
static void make_categories(const Stage *stage, Decoration *d) {
  int64_t count;
  const double *knots = tetcast_transfer_function_color(stage->transfer_function, &count);
  const int most = stage->matter.count < COLORS ? stage->matter.count : COLORS;
  d->legend.categories = 1;
  for (int i = 0; i < most; i++) {
    colors_at(knots, count, stage->matter.labels[i], d->colors + 3 * d->legend.color_count++);
    d->labels[d->legend.label_count++] = cli_print("%g", stage->matter.labels[i]);
  }
}

/* Whether colours stand for values of one array. */
static bool has_legend(const Stage *stage, const RenderOptions *options) {
  if (render_options_direct(options) || !stage->array || stage->rows.count > 0 || !stage->transfer_function ||
      !surfaces_show_values(options))
    return false;
  return render_options_given(options, OPTION_LEGEND) || render_options_decorated(options);
}

void decoration_make(const Stage *stage, const RenderOptions *options, Decoration *d) {
  *d = (Decoration){.colors = NULL};
  if (!has_legend(stage, options))
    return;
  d->colors = cli_allocate(sizeof(double) * 3 * COLORS);
  d->places = cli_allocate(sizeof(double) * COLORS);
  d->labels = cli_allocate(sizeof(char *) * COLORS);
  if (stage->uniform && stage->matter.count > 0)
    make_categories(stage, d);
  else
    make_bar(stage, d);
  for (int i = 0; i < 3 * d->legend.color_count; i++)
    d->colors[i] = fmin(fmax(d->colors[i], 0), 1); /* the legend is no light, and can't shine */
  d->legend.title = options->legend && *options->legend ? options->legend : stage->array;
  d->legend.colors = d->colors;
  d->legend.places = d->places;
  d->legend.labels = (const char *const *)d->labels;
}

void decoration_release(Decoration *d) {
  for (int i = 0; i < d->legend.label_count; i++)
    free(d->labels[i]);
  free(d->labels);
  free(d->places);
  free(d->colors);
  *d = (Decoration){.colors = NULL};
}
