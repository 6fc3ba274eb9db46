/* SPDX-License-Identifier: Apache-2.0 */
/* The report in numbers (report.csv) and in words (report.md). */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "converge.h"
#include "file.h"

/* ── report.csv ── */

/* A number where there is one. */
static void put_if(FILE *file, bool there, double number) {
  if (there)
    fprintf(file, "%.9g", number);
}

static void put_csv(FILE *file, const Converge *converge) {
  static const char *const studies[] = {"time", "stiffness", "refine", "integration"};
  static const char *const integrators[] = {"exact", "midpoint", "trapezoid", "gauss", "table"};
  fputs("study,integrator,parameter,precision,isa,tolerance,extinction_scale,mesh_size,cells,segments,repeats,seconds,"
        "max_error,rms_error,bound,peak\n",
        file);
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    const bool adaptive = row->adaptive > 0, exact = row->integrator == TETCAST_INTEGRATOR_EXACT && !adaptive;
    fprintf(file, "%s,%s,", studies[row->study], adaptive ? "adaptive" : integrators[row->integrator]);
    put_if(file, row->n > 0 || adaptive, adaptive ? row->adaptive : row->n);
    fprintf(file, ",%s,%s,", row->precision, row->isa);
    put_if(file, exact, row->tolerance);
    fprintf(file, ",%.9g,", row->scale);
    put_if(file, row->level > 0, 1.0 / row->level);
    fprintf(file, ",%lld,%lld,%d,%.6g,%.6g,%.6g,", (long long)row->cells, (long long)row->segments, row->repeats,
            row->seconds, row->max_error, row->rms_error);
    put_if(file, isfinite(row->bound), row->bound);
    fprintf(file, ",%.6g\n", row->peak);
  }
}

bool converge_write_csv(const Converge *converge, const char *folder) {
  CliText *text = cli_text_begin();
  put_csv(text->file, converge);
  return cli_text_write(text, folder, "report.csv");
}

/* ── report.md ── */

/* The processor's name. */
static char *processor(void) {
  FILE *file = fopen("/proc/cpuinfo", "r");
  char *line = NULL, *name = NULL;
  size_t size = 0;
  while (file && !name && getline(&line, &size, file) > 0)
    if (!strncmp(line, "model name", 10) && strchr(line, ':'))
      name = cli_print("%.*s", (int)strcspn(strchr(line, ':') + 2, "\n"), strchr(line, ':') + 2);
  free(line);
  if (file)
    fclose(file);
  return name ? name : cli_duplicate("unknown processor");
}

static void put_line_of(FILE *file, const char *text) {
  for (const char *c = text; *c; c++)
    fputc((unsigned char)*c < ' ' || *c == '|' ? ' ' : *c, file);
}

/* Names the kernels that ran, each once. */
static void put_kernels(FILE *file, const Converge *converge) {
  for (int i = 0; i < converge->count; i++) {
    bool known = false;
    for (int j = 0; j < i && !known; j++)
      known = !strcmp(converge->rows[i].isa, converge->rows[j].isa);
    if (!known)
      fprintf(file, "%s%s", i > 0 ? ", " : "", converge->rows[i].isa);
  }
}

static void put_run(FILE *file, const Converge *converge) {
  const RenderOptions *options = &converge->options;
  char *cpu = processor();
  fputs("# Error against run time\n\n    ", file);
  put_line_of(file, converge->command);
  fputs("\n\n| | |\n| --- | --- |\n", file);
  if (converge->scene_studies) {
    fputs("| dataset | ", file);
    put_line_of(file, cli_path_name(options->input));
    fputs(converge->stage.array ? ", array " : ", uniform matter", file);
    put_line_of(file, converge->stage.array ? converge->stage.array : "");
    fprintf(file, " |\n| cells | %lld tetrahedra, %lld vertices |\n", (long long)converge->stage.info.tetrahedra,
            (long long)converge->stage.info.vertices);
    fprintf(file, "| picture | %.0f × %.0f pixels, one ray each, %lld segments |\n", options->size[0], options->size[1],
            (long long)converge->rows[0].segments);
  }
  bool single = false;
  for (int i = 0; i < converge->count; ++i)
    single = single || strcmp(converge->rows[i].precision, "single") == 0;
  fprintf(file, "| arithmetic | double precision%s; kernels: ", single ? ", single where a tolerance allows it" : "");
  put_kernels(file, converge);
  fputs(" |\n", file);
  fprintf(file, "| machine | %s, %d threads |\n", cpu, tetcast_context_threads(converge->context));
  fprintf(file, "| versions | tetcast %s, Embree %s, %s, %s |\n\n", tetcast_version_string(),
          tetcast_embree_version_string(), CLI_COMPILER, CLI_BUILD_TYPE);
  if (converge->scene_studies)
    fprintf(file, "Times are of rendering alone, the median of %.0f; reading and preparing the mesh are not in them. ",
            options->repeat);
  fputs("Errors are taken over all pixels and all of red, green, blue and alpha, in absolute terms; 1 is an opaque "
        "white.\n",
        file);
  free(cpu);
}

/* Says where the reference is undecided. */
static void put_undecided(FILE *file, const Converge *converge) {
  if (converge->rays_beside + converge->rays_replaced + converge->rays_undecided == 0)
    return;
  fputs("A ray that runs in a face of two cells, or within a few roundings of one, belongs to either. Four rays a few "
        "roundings beside it tell "
        "what its light is:\n\n",
        file);
  if (converge->rays_beside > 0)
    fprintf(file, "* %d of the rays run so, and are compared with what those four have.\n", converge->rays_beside);
  if (converge->rays_replaced > 0)
    fprintf(file, "* %d rays, where these four differ by more than %g, were replaced by others%s.\n",
            converge->rays_replaced, CONVERGE_TRUST,
            converge->ray_count < converge->rays_wanted ? ", as far as there were any" : "");
  if (converge->rays_undecided > 0)
    fprintf(file, "* With the extinction scaled, as below, %d rays at most were left out for that reason.\n",
            converge->rays_undecided);
  fputs("\n", file);
}

static void put_reference(FILE *file, const Converge *converge) {
  const int rays = converge->ray_count;
  const double worst = fmax(converge->check_max, converge->check_stiff);
  fputs("\n## The reference\n\n", file);
  if (converge->rays_blank)
    fprintf(file,
            "> **Warning.** The exact picture could not be checked: no ray that shows something could be decided, of "
            "%d that were tried.\n\n",
            converge->rays_replaced);
  if (!(worst <= CONVERGE_TRUST))
    fprintf(file,
            "> **Warning.** The exact picture and the brute-force reference differ by up to %.2g, more than %g. Errors "
            "below "
            "that difference mean nothing here. Meshes whose cells overlap are a likely cause: try `--traversal "
            "faces`.\n\n",
            worst, CONVERGE_TRUST);
  fprintf(
      file,
      "Errors are differences to the picture by the closed form, in double precision. That picture is checked against "
      "a "
      "brute-force reference, which shares no code with the renderer: %d rays, each tested against every tetrahedron, "
      "the "
      "light along them integrated numerically with %d-bit mantissas, in steps of an optical depth of at most 1/4.\n\n",
      rays, LDBL_MANT_DIG);
  if (converge->rays_wanted < CONVERGE_RAYS)
    fprintf(file, "The mesh is large: there are %d rays instead of the usual %d.\n\n", rays, CONVERGE_RAYS);
  put_undecided(file, converge);
  const ConvergeRow *packets = converge_packets(converge);
  fprintf(file, "* The largest difference on these rays is **%.2g**", converge->rows[0].max_error);
  if (packets)
    fprintf(file, " in the scalar kernel, and %.2g in %s", packets->max_error, packets->isa);
  fprintf(file, ". It is what the exact integrator's point%s.\n", packets ? "s show" : " shows");
  fprintf(file, "* With the extinction scaled, as below, the largest difference is %.2g, at the factor %g.\n",
          converge->check_stiff, converge->check_scale);
}

static void put_label(FILE *file, const ConvergeRow *row) {
  if (row->tolerance > 0)
    fprintf(file, "tolerance %.0e", row->tolerance);
  else if (row->adaptive > 0)
    fprintf(file, "adaptive %.0e", row->adaptive);
  else if (row->n > 0)
    fprintf(file, "%s:%d", converge_name(row), row->n);
  else
    fputs("exact", file);
}

/* The quickest row of a kind with an error of at most `target`. */
static const ConvergeRow *quickest(const Converge *converge, const ConvergeRow *kind, double target) {
  const ConvergeRow *best = NULL;
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (row->study == STUDY_TIME && !strcmp(converge_name(row), converge_name(kind)) && row->packets == kind->packets &&
        row->max_error <= target && (!best || row->seconds < best->seconds))
      best = row;
  }
  return best;
}

/* Which kernels are compared, and why. */
static void put_fairness(FILE *file, const Converge *converge) {
  const ConvergeRow *exact = &converge->rows[0], *packets = converge_packets(converge);
  if (!packets) {
    fputs("\nAll integrators ran in the same kernel, *scalar*, one ray at a time: `--isa`, the traversal or the "
          "transfer function leaves no other.\n",
          file);
    return;
  }
  fprintf(file,
          "\nIntegrators are compared in the same kernel, *scalar*, because that is the only one which the textbook "
          "integrators run in; the exact integrator and tolerances were measured once more in *%s*, which takes rays "
          "in packets, and these rows, at the end, show what packets add.\n\n"
          "The exact picture took %.3g seconds in *scalar* and %.3g in *%s*: %.1f times as fast. All errors of this "
          "study are against the exact picture of *scalar*.\n",
          packets->isa, exact->seconds, packets->seconds, packets->isa, exact->seconds / packets->seconds);
}

static void put_costs(FILE *file, const Converge *converge) {
  fputs("\nWhat an error of at most so much costs, in seconds (the cheapest of those measured):\n\n| largest error |",
        file);
  const ConvergeRow *kinds[9]; /* exact, tolerance, four others, adaptive; the first two by packets */
  int count = 0;
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (row->study == STUDY_TIME && (i == 0 || strcmp(converge_name(row), converge_name(row - 1))))
      kinds[count++] = row;
  }
  for (int i = 0; i < count; i++)
    fprintf(file, " %s, %s |", converge_name(kinds[i]), kinds[i]->isa);
  fputs("\n| --- |", file);
  for (int i = 0; i < count; i++)
    fputs(" --- |", file);
  for (int digits = 2; digits <= 12; digits += digits < 6 ? 1 : 3) {
    fprintf(file, "\n| 1e-%d |", digits);
    for (int i = 0; i < count; i++) {
      const ConvergeRow *row = quickest(converge, kinds[i], pow(10, -digits));
      if (!row)
        fputs(" – |", file);
      else if (row->n > 0)
        fprintf(file, " %.3g (:%d) |", row->seconds, row->n);
      else
        fprintf(file, " %.3g |", row->seconds);
    }
  }
  fputs("\n", file);
}

static void put_time(FILE *file, const Converge *converge) {
  const ConvergeRow *exact = &converge->rows[0];
  fputs("\n## Error against run time\n\n", file);
  if (!converge->options.no_plots)
    fputs("![Error against run time](time.svg)\n", file);
  put_fairness(file, converge);
  put_costs(file, converge);
  if (exact->peak == 0)
    fputs("\nThe picture is empty: every integrator is right about it.\n", file);
  fputs("\nAll that was measured:\n\n| integrator | kernel | seconds | × exact, scalar | largest error | rms error | "
        "guaranteed bound |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n",
        file);
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (row->study != STUDY_TIME)
      continue;
    fputs("| ", file);
    put_label(file, row);
    fprintf(file, " | %s | %.3g | %.2f | %.2e | %.2e | ", row->isa, row->seconds, row->seconds / exact->seconds,
            row->max_error, row->rms_error);
    fprintf(file, isfinite(row->bound) ? "%.2e |\n" : "– |\n", row->bound);
  }
  fputs("\nThe error of *exact* is its difference to the brute-force reference on the rays that were checked. The time "
        "of *table* "
        "includes making the table. *adaptive* is exact along rays, but casts few where pixels differ by less than "
        "its number, and interpolates between them: what it doesn't see it misses, and nothing bounds its error.\n",
        file);
}

static void put_number(FILE *file, double number) {
  if (isfinite(number))
    fprintf(file, " %.2f |", number);
  else
    fputs(" – |", file);
}

static void put_samples(FILE *file, const Converge *converge) {
  static const char *const names[] = {"midpoint", "trapezoid", "gauss", "table"};
  fputs("\n## Error against samples\n\n", file);
  if (!converge->options.no_plots)
    fputs("![Error against samples](samples.svg)\n\n", file);
  fputs("Slopes of log error over log n, by least squares from n = 4 (table: 16) as far down as 1e-13, where rounding "
        "begins:\n\n"
        "| integrator | largest error | rms error |\n| --- | --- | --- |\n",
        file);
  for (int i = 0; i < 4; i++) {
    fprintf(file, "| %s |", names[i]);
    const TetcastIntegrator integrator = (TetcastIntegrator)(TETCAST_INTEGRATOR_MIDPOINT + i);
    put_number(file, converge_slope(converge, STUDY_TIME, integrator, false));
    put_number(file, converge_slope(converge, STUDY_TIME, integrator, true));
    fputs("\n", file);
  }
  fputs("\nWhere the transfer function is smooth, theory has −2 for midpoint, trapezoid and table, and for gauss an "
        "error that falls "
        "faster than any power of n. A knot of the transfer function inside a segment limits every rule that does not "
        "cut there: "
        "to about −2 at a kink, to −1 at a step. The table stands for the one thing that has no simple closed form, "
        "and is exact where the "
        "colour stays the same along a segment.\n",
        file);
}

static void put_stiffness(FILE *file, const Converge *converge) {
  fputs("\n## Error against stiffness\n\n", file);
  if (!converge->options.no_plots)
    fputs("![Error against stiffness](stiffness.svg)\n\n", file);
  fputs("The extinction is multiplied by a factor, and each picture rendered once. The largest error, of *exact* "
        "against the "
        "brute-force reference, of the others against the exact picture:\n\n",
        file);
  const ConvergeRow *first = NULL;
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (row->study != STUDY_STIFFNESS)
      continue;
    if (!first) {
      first = row;
      int columns = 0;
      fputs("| factor | largest value |", file);
      for (; i + columns < converge->count && row[columns].study == STUDY_STIFFNESS && row[columns].scale == row->scale;
           columns++) {
        fputs(" ", file);
        put_label(file, &row[columns]);
        fputs(" |", file);
      }
      fputs("\n| --- | --- |", file);
      for (int c = 0; c < columns; c++)
        fputs(" --- |", file);
    }
    if (row == first || row->scale != row[-1].scale)
      fprintf(file, "\n| %.0e | %.2e |", row->scale, row->peak);
    fprintf(file, " %.2e |", row->max_error);
  }
  fputs("\n", file);
}

static void put_refine(FILE *file, const Converge *converge) {
  fputs("\n## Error against mesh size\n\n", file);
  if (!converge->options.no_plots)
    fputs("![Error against mesh size](refine.svg)\n\n", file);
  fprintf(file,
          "A smooth analytic field in the unit cube is sampled at the vertices of finer and finer meshes (jittered, "
          "six tetrahedra "
          "a small cube), and seen through a linear transfer function. The reference has no mesh: it integrates the "
          "analytic field "
          "along the same %d × %d rays with %d-bit mantissas, in steps that are halved until the result stays as it is "
          "(the last "
          "change is %.1g at most). What the exact integrator is off by is the discretisation's doing alone; what "
          "another differs "
          "from exact by on the same mesh is that integrator's.\n\n",
          CONVERGE_REFINE_WIDTH, CONVERGE_REFINE_HEIGHT, LDBL_MANT_DIG, converge->analytic_step);
  fputs("| mesh size | cells | error | integrator | largest error | rms error |\n| --- | --- | --- | --- | --- | "
        "--- |\n",
        file);
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    if (row->level == 0)
      continue;
    fprintf(file, "| 1/%d | %lld | %s | ", row->level, (long long)row->cells,
            row->study == STUDY_INTEGRATION ? "integration"
            : row->n == 0                   ? "discretisation"
                                            : "both");
    put_label(file, row);
    fprintf(file, " | %.2e | %.2e |\n", row->max_error, row->rms_error);
  }
  fputs("\nSlopes of log error over log mesh size, by least squares; theory has 2 for a piecewise linear field, and "
        "for gauss:2 "
        "4:\n\n| error | largest | rms |\n| --- | --- | --- |\n",
        file);
  static const struct {
    const char *name;
    ConvergeStudy study;
    TetcastIntegrator integrator;
  } slopes[] = {{"discretisation (exact)", STUDY_REFINE, TETCAST_INTEGRATOR_EXACT},
                {"both, midpoint:1", STUDY_REFINE, TETCAST_INTEGRATOR_MIDPOINT},
                {"both, gauss:2", STUDY_REFINE, TETCAST_INTEGRATOR_GAUSS},
                {"integration, midpoint:1", STUDY_INTEGRATION, TETCAST_INTEGRATOR_MIDPOINT},
                {"integration, gauss:2", STUDY_INTEGRATION, TETCAST_INTEGRATOR_GAUSS}};
  for (size_t i = 0; i < sizeof slopes / sizeof *slopes; i++) {
    fprintf(file, "| %s |", slopes[i].name);
    put_number(file, converge_slope(converge, slopes[i].study, slopes[i].integrator, false));
    put_number(file, converge_slope(converge, slopes[i].study, slopes[i].integrator, true));
    fputs("\n", file);
  }
}

static void put_files(FILE *file, const Converge *converge) {
  fputs("\n## Files\n\n"
        "`report.csv` has a line for each rendering, with the columns\n\n"
        "* `study`: `time` (the scene as it is), `stiffness` (its extinction scaled), `refine` (the analytic field, "
        "all of the "
        "error), `integration` (the same, against the exact integral on that mesh);\n"
        "* `integrator`, `parameter` (n; of `adaptive` the difference between pixels), `precision`, `isa` (of the "
        "kernel that ran), `tolerance` (0: "
        "exact; empty: has none), `extinction_scale`, `mesh_size`, "
        "`cells`, `segments`;\n"
        "* `repeats`, `seconds` (their median), `max_error`, `rms_error` (inf: some pixels are not finite);\n"
        "* `bound`: the error's bound as the renderer states it; `peak`: the largest value in the exact picture.\n",
        file);
  if (!converge->options.no_plots)
    fputs("\n`gnuplot NAME.gp` draws `NAME.svg` and `NAME.png` again from `NAME.dat`. Logarithmic axes have no zero: "
          "errors below the "
          "least value of an axis, 0 included, are drawn there.\n",
          file);
}

static void put_report(FILE *file, const Converge *converge) {
  put_run(file, converge);
  if (converge->scene_studies) {
    put_reference(file, converge);
    put_time(file, converge);
    put_samples(file, converge);
    put_stiffness(file, converge);
  }
  if (converge->refine_study)
    put_refine(file, converge);
  put_files(file, converge);
}

bool converge_write_report(const Converge *converge, const char *folder) {
  CliText *text = cli_text_begin();
  put_report(text->file, converge);
  return cli_text_write(text, folder, "report.md");
}
