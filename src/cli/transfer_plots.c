/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"
#include "gnuplot.h"
#include "transfer.h"

const char *const transfer_plot_files[] = {
    "values.dat",   "values.gp",     "values.svg",    "values.png",   "gradients.dat",
    "gradients.gp", "gradients.svg", "gradients.png", "function.dat", NULL};

static const char opening[] = "set encoding utf8\n"
                              "set minussign\n"
                              "set tics nomirror\n"
                              "set border 11 linecolor rgb '#333333'\n"
                              "set grid linecolor rgb '#dddddd' linetype 1 linewidth 0.6\n"
                              "set key outside top center horizontal Left reverse samplen 2\n";

static double value_at(const TetcastStatistics *s, double bin) {
  return s->range[0] + (s->range[1] - s->range[0]) * bin / s->bins;
}

/* A text in gnuplot's quotes. */
static void put_quoted(FILE *file, const char *text) {
  fputc('\'', file);
  for (const char *c = text; *c; c++)
    fprintf(file, *c == '\'' ? "''" : "%c", (unsigned char)*c < ' ' ? ' ' : *c);
  fputc('\'', file);
}

/* The share of the volume in each bin, and of isosurfaces the area and the mean gradient, each of the largest. */
static bool write_values(const char *folder, const TetcastStatistics *s) {
  double volume = 0, area = 0, gradient = 0;
  for (int i = 0; i < s->bins; i++) {
    volume = fmax(volume, s->volume[i]);
    area = fmax(area, s->area[i]);
  }
  for (int i = 0; i < s->bins; i++)
    if (s->area[i] > 0.01 * area)
      gradient = fmax(gradient, s->gradient[i] / s->area[i]);
  CliText *text = cli_text_begin();
  fputs("# value, volume, area of the isosurface, mean gradient on it: each as a share of the largest\n", text->file);
  for (int i = 0; i < s->bins; i++)
    fprintf(text->file, "%.17g %.9g %.9g %.9g\n", value_at(s, i + 0.5), volume > 0 ? s->volume[i] / volume : 0,
            area > 0 ? s->area[i] / area : 0,
            s->area[i] > 0.01 * area && gradient > 0 ? s->gradient[i] / s->area[i] / gradient : 0);
  return cli_text_write(text, folder, "values.dat");
}

/* The extinction, as a share of the largest, and the colour as one number. */
static bool write_function(const char *folder, const Candidates *c, const TetcastTransferFunction *function) {
  int64_t count;
  const double *knots = tetcast_transfer_function_extinction(function, &count);
  double most = 0;
  for (int64_t i = 0; i < count; i++)
    most = fmax(most, knots[2 * i + 1]);
  CliText *text = cli_text_begin();
  fputs("# value, extinction as a share of the largest\n", text->file);
  fprintf(text->file, "%.17g %.9g\n", fmin(c->statistics->range[0], knots[0]), most > 0 ? knots[1] / most : 0);
  for (int64_t i = 0; i < count; i++)
    fprintf(text->file, "%.17g %.9g\n", knots[2 * i], most > 0 ? knots[2 * i + 1] / most : 0);
  fprintf(text->file, "%.17g %.9g\n", fmax(c->statistics->range[1], knots[2 * count - 2]),
          most > 0 ? knots[2 * count - 1] / most : 0);
  return cli_text_write(text, folder, "function.dat");
}

/* The volume at each value and gradient, in decades below the largest. */
static bool write_gradients(const char *folder, const TetcastStatistics *s) {
  double most = 0;
  for (int i = 0; i < s->bins * s->gradient_bins; i++)
    most = fmax(most, s->joint[i]);
  CliText *text = cli_text_begin();
  fputs("# value, gradient, decades of the volume below the largest\n", text->file);
  for (int g = 0; g < s->gradient_bins; g++) {
    for (int i = 0; i < s->bins; i++) {
      const double share = most > 0 ? s->joint[g * s->bins + i] / most : 0;
      fprintf(text->file, "%.9g %.9g %.4g\n", value_at(s, i + 0.5),
              s->gradient_range[0] + (s->gradient_range[1] - s->gradient_range[0]) * (g + 0.5) / s->gradient_bins,
              share > 1e-6 ? log10(share) : -6);
    }
    fputc('\n', text->file);
  }
  return cli_text_write(text, folder, "gradients.dat");
}

static bool write_script(const char *folder, const char *name, const char *title, const Candidates *c, bool logarithmic,
                         const char *body) {
  CliText *text = cli_text_begin();
  FILE *file = text->file;
  fprintf(file, "# SPDX-License-Identifier: Apache-2.0\n# gnuplot %s.gp draws %s.svg and %s.png.\n%s", name, name, name,
          opening);
  fputs("set title ", file);
  put_quoted(file, title);
  fprintf(file, " noenhanced\nset xrange [%.17g:%.17g]\n", c->statistics->range[0], c->statistics->range[1]);
  if (logarithmic && c->statistics->range[0] > 0)
    fputs("set logscale x\nset format x '10^{%L}'\n", file);
  for (int i = 0; i < c->salient_count; i++)
    fprintf(file, "set arrow from %.17g, graph 0 to %.17g, graph 1 nohead dashtype 2 linecolor rgb '#888888' front\n",
            c->salient[i], c->salient[i]);
  fprintf(file, "set terminal svg size 960,540 font 'sans-serif,13' background rgb 'white'\nset output '%s.svg'\n%s",
          name, body);
  fprintf(file,
          "set terminal pngcairo size 1920,1080 font 'sans,13' fontscale 2 linewidth 2 pointscale 2\n"
          "set output '%s.png'\nreplot\n",
          name);
  char *path = cli_print("%s.gp", name);
  const bool done = cli_text_write(text, folder, path);
  free(path);
  return done && gnuplot_draw(folder, name);
}

bool transfer_plots(const char *folder, const char *title, const Candidates *c,
                    const TetcastTransferFunction *function) {
  static const char values[] =
      "set yrange [0:1.05]\nset xlabel 'value'\nset ylabel 'share of the largest'\n"
      "plot 'values.dat' using 1:2 with filledcurves y1=0 fillcolor rgb '#c8d3e3' title 'volume', \\\n"
      "  '' using 1:3 with lines linewidth 1.4 linecolor rgb '#009e73' title 'area of the isosurface', \\\n"
      "  '' using 1:4 with lines linewidth 1.4 linecolor rgb '#d55e00' title 'mean gradient on it', \\\n"
      "  'function.dat' using 1:2 with lines linewidth 2.4 linecolor rgb '#000000' title 'extinction'\n";
  static const char gradients[] =
      "set xlabel 'value'\nset ylabel 'gradient'\nset y2range [0:1.05]\nset y2label 'extinction, share of the "
      "largest'\n"
      "set y2tics\nset yrange [0:*]\nset cblabel 'volume, decades below the largest' offset 2\nset cbrange [-6:0]\n"
      "set palette defined (0 '#ffffff', 1 '#dfe7f2', 3 '#7f9fc9', 5 '#24427c', 6 '#0b1633')\n"
      "plot 'gradients.dat' using 1:2:3 with image notitle, \\\n"
      "  'function.dat' using 1:2 axes x1y2 with lines linewidth 2.4 linecolor rgb '#d55e00' title 'extinction'\n";
  const bool logarithmic = c->candidate[0].design.map.logarithmic;
  bool done = write_values(folder, c->statistics) && write_function(folder, c, function) &&
              write_script(folder, "values", title, c, logarithmic, values);
  if (done && c->statistics->gradient_bins > 0)
    done = write_gradients(folder, c->statistics) && write_script(folder, "gradients", title, c, false, gradients);
  return done;
}
