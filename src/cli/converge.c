/* SPDX-License-Identifier: Apache-2.0 */
#include "converge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"
#include "fileset.h"
#include "folder.h"
#include "gnuplot.h"
#include "progress.h"
#include "render_parse.h"

static const char *const report_files[] = {"report.csv",
                                           "report.md",
                                           "time.dat",
                                           "time.gp",
                                           "time.svg",
                                           "time.png",
                                           "samples.dat",
                                           "samples.gp",
                                           "samples.svg",
                                           "samples.png",
                                           "stiffness.dat",
                                           "stiffness.gp",
                                           "stiffness.svg",
                                           "stiffness.png",
                                           "refine.dat",
                                           "refine.gp",
                                           "refine.svg",
                                           "refine.png",
                                           NULL};

static char *join_words(int argc, char **argv) {
  char *text = cli_duplicate("tetcast");
  for (int i = 0; i < argc; i++) {
    char *longer = cli_print("%s %s", text, argv[i]);
    free(text);
    text = longer;
  }
  return text;
}

/* No file of the report may be one that is read. */
static int check_files(const RenderOptions *options) {
  FileSet files = {0};
  fileset_add_options(&files, options);
  for (const char *const *name = report_files; *name; name++) {
    char *path = cli_path_join(options->output, *name);
    fileset_add(&files, "the report", path, true);
    free(path);
  }
  return fileset_check(&files, "converge");
}

/* All that can be known to fail before anything is read. */
static int check(Converge *converge, Folder *folder) {
  const int same = check_files(&converge->options);
  if (same >= 0)
    return same;
  cli_file_tidy(converge->options.output);
  if (!folder_check(folder, converge->options.output, report_files))
    return CLI_FAILED;
  if (!converge->options.no_plots && !gnuplot_find()) {
    cli_error("gnuplot, which draws the plots, cannot be run: install it, or leave the plots out by --no-plots");
    return CLI_FAILED;
  }
  if (!converge->scene_studies) {
    converge->context = cli_context_create((int)converge->options.threads);
    return converge->context ? CLI_DONE : CLI_FAILED;
  }
  const int code = stage_begin(&converge->stage, &converge->options);
  converge->context = converge->stage.context;
  return code;
}

static int measure(Converge *converge) {
  int code = converge->scene_studies ? converge_plan_scene(converge) : CLI_DONE;
  if (code != CLI_DONE)
    return code;
  if (converge->refine_study)
    converge_plan_refine(converge);
  cli_progress("measuring");
  if (converge->scene_studies)
    code = converge_run_scene(converge);
  if (code == CLI_DONE && converge->refine_study)
    code = converge_run_refine(converge);
  cli_progress_clear();
  if (converge->lost > 0)
    cli_warning("%lld rays were lost on their way through the mesh: the report has faults there, please report this",
                (long long)converge->lost);
  return cli_verdict(code);
}

static int write_report(Converge *converge, Folder *folder) {
  if (!folder_begin(folder))
    return CLI_FAILED;
  const bool done = converge_write_csv(converge, folder->temporary) &&
                    converge_write_plots(converge, folder->temporary) &&
                    (converge->options.no_plots || converge_draw_plots(converge, folder->temporary)) &&
                    converge_write_report(converge, folder->temporary);
  return done && !cli_interrupted() && folder_publish(folder) ? CLI_DONE : CLI_FAILED;
}

static int perform(Converge *converge, Folder *folder) {
  cli_interrupt_hold(true); /* the check makes a folder for a moment */
  int code = check(converge, folder);
  cli_interrupt_hold(false);
  if (code == CLI_DONE && converge->scene_studies) {
    code = stage_read(&converge->stage, &converge->options);
    if (code == CLI_DONE)
      code = stage_prepare(&converge->stage, &converge->options);
    if (code == CLI_DONE)
      code = stage_shade(&converge->stage, &converge->options, converge->stage.range);
  }
  cli_interrupt_hold(true);
  if (code == CLI_DONE)
    code = measure(converge);
  if (code == CLI_DONE)
    code = write_report(converge, folder);
  return code;
}

int tetcast_cli_converge(int argc, char **argv) {
  Converge converge = {.options = render_options_default(COMMAND_CONVERGE), .command = join_words(argc, argv)};
  Folder folder = {0};
  int code = render_options_parse(&converge.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(converge.options.quiet);
    cli_set_strict(converge.options.strict);
    converge.scene_studies = converge.options.input != NULL;
    converge.refine_study = converge.options.refine;
    code = perform(&converge, &folder);
  }
  folder_release(&folder);
  for (int i = 0; i < converge.ray_count; i++)
    brute_release(&converge.rays[i]);
  free(converge.rays);
  if (converge.context != converge.stage.context)
    tetcast_context_destroy(&converge.context);
  stage_release(&converge.stage);
  for (int i = 0; i < converge.count; i++)
    free(converge.rows[i].times);
  free(converge.rows);
  free(converge.command);
  render_options_release(&converge.options);
  if (cli_interrupted()) {
    fputs("tetcast: error: interrupted\n", stderr);
    return 128 + cli_interrupted();
  }
  return code;
}
