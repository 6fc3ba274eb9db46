/* SPDX-License-Identifier: Apache-2.0 */
/* The plots of a report: for each its data, and a script for gnuplot that stays there to be changed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "converge.h"
#include "file.h"
#include "gnuplot.h"

typedef enum Plot { PLOT_TIME, PLOT_SAMPLES, PLOT_STIFFNESS, PLOT_REFINE, PLOT_COUNT } Plot;

static const char *const plot_names[] = {"time", "samples", "stiffness", "refine"};

static bool wanted(const Converge *converge, Plot plot) {
  return plot == PLOT_REFINE ? converge->refine_study : converge->scene_studies;
}

/* A curve's rows, and how it looks in all plots: colours that colour-blind people tell apart (Okabe and Ito). */
typedef struct Curve {
  const char *name;
  ConvergeStudy study;
  TetcastIntegrator integrator;
  bool tolerance;
  const char *color;
  int point;
  bool packets;
  bool adaptive;
} Curve;

static const Curve scene_curves[] = {
    {"exact", STUDY_TIME, TETCAST_INTEGRATOR_EXACT, false, "#000000", 15, false, false},
    {"tolerance", STUDY_TIME, TETCAST_INTEGRATOR_EXACT, true, "#E69F00", 11, false, false},
    {"midpoint", STUDY_TIME, TETCAST_INTEGRATOR_MIDPOINT, false, "#0072B2", 7, false, false},
    {"trapezoid", STUDY_TIME, TETCAST_INTEGRATOR_TRAPEZOID, false, "#D55E00", 5, false, false},
    {"gauss", STUDY_TIME, TETCAST_INTEGRATOR_GAUSS, false, "#009E73", 9, false, false},
    {"table", STUDY_TIME, TETCAST_INTEGRATOR_TABLE, false, "#CC79A7", 13, false, false},
};
/* In the plot of time alone. */
static const Curve adaptive_curve = {"adaptive", STUDY_TIME, TETCAST_INTEGRATOR_EXACT, false,
                                     "#56B4E9",  3,          .adaptive = true};
/* In the plot of time alone: the same colours, open points. */
static const Curve packet_curves[] = {
    {"exact-packets", STUDY_TIME, TETCAST_INTEGRATOR_EXACT, false, "#000000", 14, true, false},
    {"tolerance-packets", STUDY_TIME, TETCAST_INTEGRATOR_EXACT, true, "#E69F00", 10, true, false},
};
enum { PACKET_CURVES = sizeof packet_curves / sizeof *packet_curves };
enum { SCENE_CURVES = sizeof scene_curves / sizeof *scene_curves };

static const Curve refine_curves[] = {
    {"exact", STUDY_REFINE, TETCAST_INTEGRATOR_EXACT, false, "#000000", 15, false, false},
    {"midpoint-both", STUDY_REFINE, TETCAST_INTEGRATOR_MIDPOINT, false, "#E69F00", 6, false, false},
    {"midpoint-integration", STUDY_INTEGRATION, TETCAST_INTEGRATOR_MIDPOINT, false, "#0072B2", 7, false, false},
    {"gauss-integration", STUDY_INTEGRATION, TETCAST_INTEGRATOR_GAUSS, false, "#009E73", 9, false, false},
};
enum { REFINE_CURVES = sizeof refine_curves / sizeof *refine_curves };

static bool belongs(const ConvergeRow *row, const Curve *curve, ConvergeStudy study) {
  return row->study == study && row->integrator == curve->integrator && (row->tolerance > 0) == curve->tolerance &&
         row->packets == curve->packets && (row->adaptive > 0) == curve->adaptive;
}

static const ConvergeRow *first_row(const Converge *converge, const Curve *curve, ConvergeStudy study) {
  for (int i = 0; i < converge->count; i++)
    if (belongs(&converge->rows[i], curve, study))
      return &converge->rows[i];
  return NULL;
}

/* ── data ── */

static void put_curve(FILE *file, const Converge *converge, const Curve *curve, ConvergeStudy study) {
  fprintf(file, "# %s\n", curve->name);
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (belongs(row, curve, study))
      fprintf(file, "%d %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", row->n, row->seconds, row->max_error, row->rms_error,
              row->bound, row->scale, row->level > 0 ? 1.0 / row->level : 0, row->peak);
  }
  fputs("\n\n", file);
}

static void put_data(FILE *file, const Converge *converge, Plot plot) {
  fputs("# Rows of report.csv, a block for each curve: n, seconds, max_error, rms_error, bound, extinction_scale, "
        "mesh_size, "
        "peak\n",
        file);
  if (plot == PLOT_REFINE)
    for (int i = 0; i < REFINE_CURVES; i++)
      put_curve(file, converge, &refine_curves[i], refine_curves[i].study);
  else
    for (int i = 0; i < SCENE_CURVES; i++)
      put_curve(file, converge, &scene_curves[i], plot == PLOT_STIFFNESS ? STUDY_STIFFNESS : STUDY_TIME);
  if (plot == PLOT_TIME)
    put_curve(file, converge, &adaptive_curve, STUDY_TIME);
  if (plot == PLOT_TIME && converge_packets(converge))
    for (int i = 0; i < PACKET_CURVES; i++)
      put_curve(file, converge, &packet_curves[i], STUDY_TIME);
}

/* ── scripts ── */

/* ", slope −2.00" for a legend. */
static const char *slope_text(const Converge *converge, ConvergeStudy study, TetcastIntegrator integrator,
                              char text[32]) {
  const double slope = converge_slope(converge, study, integrator, false);
  if (isfinite(slope))
    snprintf(text, 32, ", slope %s%.1f", slope < 0 ? "−" : "", fabs(slope));
  else
    text[0] = '\0';
  return text;
}

static void put_style(FILE *file, const Curve *curve, const char *title) {
  const char *size = "0.9";
  if (curve->packets)
    size = "1.4"; /* so that open points are seen to be open */
  else if (curve->point == 6)
    size = "1.8 dashtype 2"; /* drawn around the points of another curve */
  else if (curve->point == 15)
    size = "1.3";
  fprintf(file, " with linespoints linecolor rgb '%s' pointtype %d linewidth %s pointsize %s title '%s'", curve->color,
          curve->point, curve->packets ? "1.2" : "2", size, title);
}

/* A line of the legend that stands for no curve. */
static void put_heading(FILE *file, const char *separator, const char *kernel) {
  fprintf(file, "%s \\\n  'time.dat' index 'exact' using 2:(NaN) with lines linecolor rgb 'white' title '%s kernel:'",
          separator, kernel);
}

static void put_time_curve(FILE *file, const Converge *converge, const Curve *curve) {
  char title[96];
  int low = 0, high = 0;
  for (int j = 0; j < converge->count; j++)
    if (belongs(&converge->rows[j], curve, STUDY_TIME)) {
      high = converge->rows[j].n;
      low = low ? low : high;
    }
  if (curve->tolerance)
    snprintf(title, sizeof title, "tolerance, 10^{−1} … 10^{−9}");
  else if (curve->adaptive)
    snprintf(title, sizeof title, "adaptive, 10^{−1} … 10^{−5}: no bound");
  else if (low == 0)
    snprintf(title, sizeof title, "exact");
  else
    snprintf(title, sizeof title, "%s:n, n = %d … %d", curve->name, low, high);
  fprintf(file, ", \\\n  'time.dat' index '%s' using 2:(shown($3))", curve->name);
  put_style(file, curve, title);
  if (curve->tolerance && !curve->packets) /* the bounds are the same by packets */
    fprintf(file,
            ", \\\n  '' index '%s' using 2:(shown($5)) with linespoints linecolor rgb '%s' pointtype 2 dashtype 2 "
            "linewidth 1.5 pointsize 0.7 title 'tolerance: guaranteed bound'",
            curve->name, curve->color);
}

static void put_time_curves(FILE *file, const Converge *converge) {
  const ConvergeRow *packets = converge_packets(converge);
  put_heading(file, "plot", converge->rows[0].isa);
  for (int i = 0; i < SCENE_CURVES; i++)
    put_time_curve(file, converge, &scene_curves[i]);
  put_time_curve(file, converge, &adaptive_curve);
  if (packets) {
    put_heading(file, ",", packets->isa);
    for (int i = 0; i < PACKET_CURVES; i++)
      put_time_curve(file, converge, &packet_curves[i]);
  }
  fputs("\n", file);
}

static void put_samples_curves(FILE *file, const Converge *converge) {
  const char *separator = "plot";
  for (int i = 0; i < SCENE_CURVES; i++) {
    const Curve *curve = &scene_curves[i];
    if (curve->integrator == TETCAST_INTEGRATOR_EXACT)
      continue;
    char title[96], slope[32];
    snprintf(title, sizeof title, "%s:n%s", curve->name, slope_text(converge, STUDY_TIME, curve->integrator, slope));
    fprintf(file, "%s \\\n  'samples.dat' index '%s' using 1:(shown($3))", separator, curve->name);
    put_style(file, curve, title);
    separator = ",";
  }
  fputs("\n", file);
}

static void put_stiffness_curves(FILE *file, const Converge *converge) {
  fputs("plot \\\n  'stiffness.dat' index 'exact' using 6:(shown($8)) with lines linecolor rgb '#999999' dashtype 3 "
        "linewidth 2 "
        "title 'largest value in the picture'",
        file);
  for (int i = 0; i < SCENE_CURVES; i++) {
    const Curve *curve = &scene_curves[i];
    const ConvergeRow *row = first_row(converge, curve, STUDY_STIFFNESS);
    char title[96];
    if (curve->tolerance)
      snprintf(title, sizeof title, "tolerance, 10^{%s%d}", row->tolerance < 1 ? "−" : "",
               (int)fabs(round(log10(row->tolerance))));
    else if (row->n > 0)
      snprintf(title, sizeof title, "%s:%d", curve->name, row->n);
    else
      snprintf(title, sizeof title, "exact");
    fprintf(file, ", \\\n  '' index '%s' using 6:(shown($3))", curve->name);
    put_style(file, curve, title);
  }
  fputs("\n", file);
}

static void put_refine_curves(FILE *file, const Converge *converge) {
  const char *separator = "plot";
  for (int i = 0; i < REFINE_CURVES; i++) {
    const Curve *curve = &refine_curves[i];
    char title[128], slope[32];
    const char *integrator = curve->integrator == TETCAST_INTEGRATOR_MIDPOINT ? "midpoint:1" : "gauss:2";
    slope_text(converge, curve->study, curve->integrator, slope);
    if (curve->integrator == TETCAST_INTEGRATOR_EXACT)
      snprintf(title, sizeof title, "exact: discretisation only%s", slope);
    else if (curve->study == STUDY_REFINE)
      snprintf(title, sizeof title, "%s: discretisation and integration%s", integrator, slope);
    else
      snprintf(title, sizeof title, "%s against exact: integration only%s", integrator, slope);
    fprintf(file, "%s \\\n  'refine.dat' index '%s' using 7:(shown($3))", separator, curve->name);
    put_style(file, curve, title);
    separator = ",";
  }
  fputs("\n", file);
}

/* A title in gnuplot's quotes. */
static void put_title(FILE *file, const Converge *converge, Plot plot) {
  if (plot == PLOT_REFINE) {
    fprintf(file, "set title 'analytic field in a cube, %d × %d rays' noenhanced\n", CONVERGE_REFINE_WIDTH,
            CONVERGE_REFINE_HEIGHT);
    return;
  }
  fputs("set title '", file);
  for (const char *c = cli_path_name(converge->options.input); *c; c++)
    fprintf(file, *c == '\'' ? "''" : "%c", (unsigned char)*c < ' ' ? ' ' : *c);
  fprintf(file, ", %lld tetrahedra, %.0f × %.0f rays' noenhanced\n", (long long)converge->stage.info.tetrahedra,
          converge->options.size[0], converge->options.size[1]);
}

static const char axes[] = "set encoding utf8\n"
                           "set minussign\n"
                           "set logscale xy\n"
                           "set format y '10^{%L}'\n"
                           "set grid linecolor rgb '#dddddd' linetype 1 linewidth 0.6\n"
                           "set tics nomirror\n"
                           "set mytics 1\n"
                           "set border 3 linecolor rgb '#333333'\n"
                           "set key outside right top vertical Left reverse width -4 spacing 1.3 samplen 2.5\n"
                           "set ylabel 'largest error in any channel of any pixel'\n";

static void put_script(FILE *file, const Converge *converge, Plot plot) {
  static void (*const curves[])(FILE *, const Converge *) = {put_time_curves, put_samples_curves, put_stiffness_curves,
                                                             put_refine_curves};
  static const char *const labels[] = {
      "set xlabel 'time to render, seconds'\n",
      "set xlabel 'n: samples per segment (table: entries a side)'\n"
      "set xtics (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024)\n"
      "set xrange [0.9:1200]\nset key width 0 # its words are short\n",
      "set xlabel 'factor on the extinction'\n"
      "set format x '10^{%L}'\nset xtics 100\nset mxtics 1\n"
      "set yrange [*:100] # an integrator that leaves all bounds leaves the plot\nset clip two\n",
      "set xlabel 'mesh size h (edge of the cube: 1)'\n"
      "set xtics ('1/4' 1./4, '1/8' 1./8, '1/16' 1./16, '1/32' 1./32, '1/64' 1./64)\n"
      "set xrange [1./80:1./3.2]\n"
      "set key inside right bottom\n"};
  const char *name = plot_names[plot];
  fprintf(file, "# SPDX-License-Identifier: Apache-2.0\n# gnuplot %s.gp draws %s.svg and %s.png from %s.dat.\n", name,
          name, name, name);
  fputs(axes, file);
  fputs(labels[plot], file);
  put_title(file, converge, plot);
  fprintf(file, "floor = 1e-%d # a logarithmic axis has no zero: errors below this are drawn there\n",
          plot == PLOT_STIFFNESS ? 22 : 17);
  fprintf(file, "shown(error) = error > floor ? error : floor\n");
  fprintf(file, "set terminal svg size 960,540 font 'sans-serif,13' background rgb 'white'\nset output '%s.svg'\n",
          name);
  curves[plot](file, converge);
  fprintf(file,
          "set terminal pngcairo size 1920,1080 font 'sans,13' fontscale 2 linewidth 2 pointscale 2\n"
          "set output '%s.png'\nreplot\n",
          name);
}

/* ── files ── */

static bool write_with(const Converge *converge, const char *folder, Plot plot, const char *extension,
                       void (*put)(FILE *, const Converge *, Plot)) {
  CliText *text = cli_text_begin();
  put(text->file, converge, plot);
  char *name = cli_print("%s%s", plot_names[plot], extension);
  const bool done = cli_text_write(text, folder, name);
  free(name);
  return done;
}

bool converge_write_plots(const Converge *converge, const char *folder) {
  bool done = true;
  for (int plot = 0; plot < PLOT_COUNT && done; plot++)
    if (wanted(converge, (Plot)plot))
      done = write_with(converge, folder, (Plot)plot, ".dat", put_data) &&
             write_with(converge, folder, (Plot)plot, ".gp", put_script);
  return done;
}

bool converge_draw_plots(const Converge *converge, const char *folder) {
  bool done = true;
  for (int plot = 0; plot < PLOT_COUNT && done; plot++)
    if (wanted(converge, (Plot)plot))
      done = gnuplot_draw(folder, plot_names[plot]);
  return done;
}
