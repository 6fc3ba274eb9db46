/* SPDX-License-Identifier: Apache-2.0 */
#include "transfer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"
#include "fileset.h"
#include "folder.h"
#include "gnuplot.h"
#include "json.h"
#include "progress.h"
#include "render_parse.h"
#include "scene_file.h"
#include "stage.h"

enum { COLUMNS = 4, GAP = 12, CAPTION = 30 };

typedef struct Proposal {
  RenderOptions options;
  Stage stage;
  Candidates candidates;
  TetcastTransferFunction *functions[CANDIDATES]; /* of the candidates */
  Folder folder;                                  /* of the plots */
} Proposal;

/* All that can be known to fail before anything is read. */
static int check(Proposal *p) {
  const RenderOptions *options = &p->options;
  FileSet files = {0};
  fileset_add_options(&files, options);
  fileset_add(&files, "--output", options->output, true);
  fileset_add(&files, "--sheet", options->sheet, true);
  const int same = fileset_check(&files, "transfer");
  if (same >= 0)
    return same;
  cli_file_tidy(options->output);
  if (options->take > CANDIDATES) {
    cli_error("--take %g: there are at most %d candidates", options->take, CANDIDATES);
    return CLI_FAILED;
  }
  if (!cli_file_check(options->output) ||
      (options->plots && !folder_check(&p->folder, options->plots, transfer_plot_files)))
    return CLI_FAILED;
  if (options->plots && !gnuplot_find()) {
    cli_error("gnuplot, which draws the plots, cannot be run: install it, or leave out --plots");
    return CLI_FAILED;
  }
  const int code = stage_begin(&p->stage, options);
  if (code != CLI_DONE || !options->sheet)
    return code;
  if (!cli_image())
    return CLI_FAILED;
  const TetcastStatus status = cli_image()->image_check(p->stage.context, options->sheet, NULL);
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* Reads the mesh and finds the candidates. */
static int find(Proposal *p) {
  Stage *stage = &p->stage;
  int code = stage_read(stage, &p->options);
  if (code == CLI_DONE && stage->uniform) {
    cli_error(stage->array ? "array %s has numbers of materials or the like: render draws a colour for each, which "
                             "--label changes; expected an --array of quantities"
                           : "%s has no array of which values could be told apart",
              stage->array ? stage->array : p->options.input);
    return CLI_FAILED;
  }
  if (code == CLI_DONE)
    code = stage_prepare(stage, &p->options);
  if (code != CLI_DONE)
    return code;
  const DesignDesc desc = stage_design_desc(stage, &p->options);
  TetcastStatus status = candidates_find(stage->context, stage->mesh, stage->field, &desc,
                                         stage->designed ? &stage->design : NULL, &p->candidates);
  for (int i = 0; i < p->candidates.count && status == TETCAST_OK; i++)
    status = stage_shade_design(stage, &p->options, &p->candidates.candidate[i].design,
                                p->candidates.candidate[i].preset, &p->functions[i]);
  stage_drop_dataset(stage);
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* ── the sheet ── */

/* Renders a candidate into its place on the sheet. */
static TetcastStatus render(const Proposal *p, int number, float *place, int64_t sheet_width) {
  const RenderOptions *options = &p->options;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = (int64_t)options->size[0];
  desc.height = (int64_t)options->size[1];
  desc.type = TETCAST_TYPE_FLOAT32;
  desc.pixels = place;
  desc.row_stride = sheet_width * 4 * (int64_t)sizeof *place;
  TetcastRenderDesc render_desc = tetcast_render_desc_default();
  render_desc.isa = (TetcastIsa)options->isa;
  TetcastFrame *frame = NULL;
  TetcastStatus status = tetcast_frame_create(p->stage.context, &desc, &frame);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(p->stage.scene, p->functions[number]);
  if (status == TETCAST_OK)
    status = tetcast_scene_render(p->stage.scene, &p->stage.camera, &render_desc, frame, NULL);
  tetcast_frame_destroy(&frame);
  return status;
}

/* All candidates in a picture, each with its number and name below it. */
static int write_sheet(const Proposal *p) {
  const int64_t width = (int64_t)p->options.size[0], height = (int64_t)p->options.size[1], count = p->candidates.count,
                columns = count < COLUMNS ? count : COLUMNS, rows = (count + columns - 1) / columns;
  const int64_t sheet_width = columns * (width + GAP) + GAP, sheet_height = rows * (height + CAPTION + GAP) + GAP;
  const size_t numbers = (size_t)(4 * sheet_width * sheet_height);
  float *pixels = cli_allocate(sizeof *pixels * numbers);
  memset(pixels, 0, sizeof *pixels * numbers);
  TetcastCaption captions[CANDIDATES];
  char *words[CANDIDATES];
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; i < count; i++) {
    const int64_t x = GAP + i % columns * (width + GAP), y = GAP + i / columns * (height + CAPTION + GAP);
    words[i] = cli_print("%d  %s", i + 1, p->candidates.candidate[i].name);
    captions[i] = (TetcastCaption){.text = words[i], .x = x + 4, .y = y + height + CAPTION / 2, .size = 15};
    cli_progress_part("candidates", (double)i / (double)count, (i + 1.0) / (double)count);
    if (status == TETCAST_OK && !cli_interrupted())
      status = render(p, i, pixels + 4 * (y * sheet_width + x), sheet_width);
  }
  cli_progress_clear();
  TetcastImageDesc image = cli_image()->image_desc_default();
  static const double light[4] = {0.93, 0.945, 0.965, 1};
  memcpy(image.background, light, sizeof light);
  image.captions = captions;
  image.caption_count = (int)count;
  if (status == TETCAST_OK && !cli_interrupted())
    status = cli_write_pixels(p->stage.context, p->options.sheet, pixels, sheet_width, sheet_height, &image);
  for (int i = 0; i < count; i++)
    free(words[i]);
  free(pixels);
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* ── the rest ── */

static int write_plots(Proposal *p, int taken) {
  if (!folder_begin(&p->folder))
    return CLI_FAILED;
  char *title = cli_print("%s, %s", cli_path_name(p->options.input), p->stage.array);
  const bool done = transfer_plots(p->folder.temporary, title, &p->candidates, p->functions[taken]);
  free(title);
  return done && !cli_interrupted() && folder_publish(&p->folder) ? CLI_DONE : CLI_FAILED;
}

static int print(const Proposal *p, int taken) {
  const Candidates *c = &p->candidates;
  const DesignMap *map = &c->candidate[0].design.map;
  printf("array          %s\n", p->stage.array);
  printf("colours        from %.4g to %.4g%s: %s\n", map->range[0], map->range[1],
         map->logarithmic ? ", by the logarithm"
         : map->diverging ? ", of two sides"
                          : "",
         c->candidate[0].design.reason);
  for (int i = 0; i < c->salient_count; i++)
    printf("%s %.4g", i == 0 ? "boundaries at " : ",", c->salient[i]);
  if (c->salient_count > 0)
    putchar('\n');
  puts("candidates");
  for (int i = 0; i < c->count; i++)
    printf("  %d  %-18s %s%s\n", i + 1, c->candidate[i].name, c->candidate[i].words, i == taken ? "; written" : "");
  return cli_finish_output();
}

static int perform(Proposal *p) {
  cli_interrupt_hold(true); /* the check makes a folder for a moment */
  int code = check(p);
  cli_interrupt_hold(false);
  if (code == CLI_DONE)
    code = find(p);
  cli_interrupt_hold(true);
  const int taken = p->options.take > 0 ? (int)p->options.take - 1 : 0;
  if (code == CLI_DONE && taken >= p->candidates.count) {
    cli_error("--take %d: there are %d candidates", taken + 1, p->candidates.count);
    code = CLI_FAILED;
  }
  if (code == CLI_DONE && p->options.sheet)
    code = write_sheet(p);
  if (code == CLI_DONE && p->options.plots)
    code = write_plots(p, taken);
  if (code == CLI_DONE && !cli_interrupted() &&
      !cli_json_write(p->options.output, scene_file_transfer(p->functions[taken])))
    code = CLI_FAILED;
  if (code == CLI_DONE && !cli_interrupted() && !p->options.quiet)
    code = print(p, taken);
  return cli_verdict(code);
}

int tetcast_cli_transfer(int argc, char **argv) {
  Proposal p = {.options = render_options_default(COMMAND_TRANSFER)};
  int code = render_options_parse(&p.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(p.options.quiet);
    cli_set_strict(p.options.strict);
    code = perform(&p);
  }
  for (int i = 0; i < CANDIDATES; i++)
    tetcast_transfer_function_destroy(&p.functions[i]);
  candidates_release(p.stage.context, &p.candidates);
  folder_release(&p.folder);
  stage_release(&p.stage);
  render_options_release(&p.options);
  if (!cli_interrupted())
    return code;
  fputs("tetcast: error: interrupted\n", stderr);
  return 128 + cli_interrupted();
}
