/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <tetcast/tetcast.h>

#include "cli.h"
#include "file.h"
#include "fileset.h"
#include "preset_list.h"
#include "progress.h"
#include "ranks.h"
#include "render.h"
#include "render_parse.h"
#include "scene_file.h"
#include "series.h"
#include "sight.h"
#include "tiles.h"

/* Removes what killed runs have left where this one writes. */
static void tidy(const RenderOptions *options) {
  const char *const outputs[] = {options->output, options->stats, options->save_scene};
  for (int i = 0; i < 3; i++)
    if (outputs[i])
      cli_file_tidy(outputs[i]);
}

void render_choose_background(RenderOptions *options) {
  if (render_options_given(options, OPTION_EMISSION) && !render_options_given(options, OPTION_BACKGROUND))
    options->background[0] = options->background[1] = options->background[2] = 0; /* radiance is shown on black */
  else if (!render_options_given(options, OPTION_BACKGROUND) && render_options_decorated(options))
    render_options_soften(options);
}

/* Checks everything that can be checked before the mesh is read and without the image library. */
static int check(Run *run) {
  RenderOptions *options = &run->options;
  if (!options->output)
    options->output = picture_default_output(options->input);
  FileSet files = {0};
  fileset_add_options(&files, options);
  if (!series_wanted(options)) /* else it has many names */
    fileset_add(&files, "--output", options->output, true);
  int code = fileset_check(&files, "render");
  if (code < 0 && series_wanted(options) && render_options_blend(options) == TETCAST_BLEND_ADDITIVE &&
      !render_options_given(options, OPTION_TRANSFER) && render_options_range(options) != RANGE_FIXED &&
      render_options_range(options) != RANGE_STEP)
    code = cli_usage_error("render", "--blend additive: the range of all steps' pictures is known when they are made; "
                                     "expected --range LO,HI or --range step");
  if (code >= 0)
    return code;
  if (options->mpi && options->threads == 0)
    options->threads = ranks_threads();
  if (!options->mpi)
    ranks_warn();
  code = stage_begin(&run->stage, options);
  code = ranks_begin(&run->stage, options, code);
  if (code != CLI_DONE)
    return code;
  if (ranks_first(&run->stage))
    tidy(options);
  if (ranks_first(&run->stage) && ((options->stats && !cli_file_check(options->stats)) ||
                                   (options->save_scene && !cli_file_check(options->save_scene))))
    return CLI_FAILED;
  render_choose_background(options);
  if (options->source >> OPTION_BACKGROUND & 1 && render_options_floating(options)) /* on the command line, that is */
    cli_warning("--background has no effect: floating-point pixels hold the picture without background");
  if (options->source >> OPTION_EXPOSURE & 1 && render_options_floating(options))
    cli_warning("--exposure has no effect: floating-point pixels hold colours as they are");
  return cli_verdict(CLI_DONE);
}

static void set_background(Run *run) {
  TetcastImageDesc *desc = &run->image_desc;
  memcpy(desc->background, run->options.background, sizeof desc->background);
  memcpy(desc->background_below, run->options.background, sizeof desc->background);
  desc->background_shaded = run->options.soft;
  for (int k = 0; k < 3 && run->options.soft; k++) {
    const double lighter = (1 - desc->background[k]) / 1.6;
    desc->background[k] -= lighter;
    desc->background_below[k] += lighter;
  }
}

int render_check_image(Run *run) {
  run->image = cli_image();
  if (!run->image)
    return CLI_FAILED;
  run->image_desc = run->image->image_desc_default();
  run->image_desc.pixel_type = (TetcastPixelType)run->options.pixel_type;
  set_background(run);
  run->image_desc.exposure = run->options.exposure;
  run->image_desc.linear = render_options_direct(&run->options);
  if (run->options.channels)
    run->image_desc.channel_count = render_option_channel_list(run->options.channels, run->channels);
  if (!render_options_groups(&run->options) || run->options.channels) /* else all that there are */
    run->image_desc.channels = run->channels;
  run->image_desc.channels_only = render_options_given(&run->options, OPTION_GROUPS) && run->options.groups;
  cli_interrupt_hold(true); /* the check puts a file in a folder for a moment */
  const TetcastStatus status = run->image->image_check(run->stage.context, run->options.output, &run->image_desc);
  cli_interrupt_hold(false);
  if (status != TETCAST_OK)
    return cli_failed(status);
  return run->options.stop_depth ? picture_read_stop(run) : cli_verdict(CLI_DONE);
}

/* What the command ends with. Over ranks, that has been agreed on: mpirun ends those that are left when the first has
 * gone, which is no interruption. */
static int outcome(int code) {
  if (ranks_foreseen() && cli_rank() == 0 && code > 128)
    fputs("tetcast: error: interrupted\n", stderr);
  if (ranks_foreseen() || !cli_interrupted())
    return code;
  fputs("tetcast: error: interrupted\n", stderr);
  return 128 + cli_interrupted();
}

/* If the picture can't be written, that is told at once, before any fault of the mesh. Reading, which may take long and
 * can't be stopped, ends with the process. */
static void *check_image_aside(void *argument) {
  Run *run = argument;
  cli_messages_hold(true);
  sem_post(&run->image_begun);
  const int code = render_check_image(run);
  if (code != CLI_DONE)
    _exit(outcome(code));
  cli_messages_hold(false);
  return NULL;
}

/* Loading the image library takes about as long as reading a large mesh, and both are work for one processor: they are
 * done at the same time. */
static int begin_image(Run *run) {
  if (run->stage.others) /* all have to know of it before they read */
    return ranks_first(&run->stage) ? render_check_image(run) : CLI_DONE;
  if (!cli_vtk()) /* before the thread begins: only one library is loaded at a time */
    return CLI_FAILED;
  sem_init(&run->image_begun, 0, 0);
  if (pthread_create(&run->image_thread, NULL, check_image_aside, run) != 0)
    return render_check_image(run);
  run->image_pending = true;
  while (sem_wait(&run->image_begun) != 0) /* a signal */
    continue;
  return CLI_DONE;
}

/* Reads the input and prepares the scene, after which nothing of the dataset stays in memory. */
static int load(Run *run) {
  int code = ranks_read(&run->stage, &run->options);
  if (code == CLI_DONE)
    code = ranks_prepare(&run->stage, &run->options);
  stage_drop_dataset(&run->stage);
  if (code == CLI_DONE)
    code = ranks_agree(&run->stage, stage_shade(&run->stage, &run->options, run->stage.range));
  return code;
}

/* Warns of a picture in which nothing can be seen. */
static int check_sight(const Run *run) {
  char *fault = sight_fault(run);
  if (fault)
    cli_warning("%s", fault);
  free(fault);
  return cli_verdict(CLI_DONE);
}

/* Makes the picture and writes it. */
static int make_picture(Run *run) {
  if (render_options_given(&run->options, OPTION_TILES))
    return tiles_perform(run);
  const bool first = ranks_first(&run->stage);
  int code = CLI_DONE;
  if (first)
    code = picture_create_frame(run, (int64_t)run->options.size[0], (int64_t)run->options.size[1]);
  code = ranks_agree(&run->stage, code);
  if (code == CLI_DONE)
    code = ranks_agree(&run->stage, picture_render(run));
  if (code == CLI_DONE && first)
    code = check_sight(run);
  if (code == CLI_DONE && first)
    code = picture_write(run, run->options.output);
  return ranks_agree(&run->stage, code);
}

static int write_files(Run *run) {
  const RenderOptions *options = &run->options;
  const Stage *stage = &run->stage;
  json_t *ranks = options->stats ? ranks_stats(stage) : NULL;
  if (!ranks_first(stage)) {
    json_decref(ranks);
    return CLI_DONE;
  }
  if (options->save_scene && !scene_file_write(options, stage->array, &stage->camera, stage->transfer_function,
                                               stage->rows.source, stage->shown))
    return CLI_FAILED;
  json_t *stats = options->stats ? picture_stats(run) : NULL;
  if (ranks)
    json_object_set_new(stats, "ranks", ranks);
  return !stats || cli_json_write(options->stats, stats) ? CLI_DONE : CLI_FAILED;
}

static int perform(Run *run) {
  cli_warn_once();          /* what the check of the output says, and writing it again, and each step of a series */
  cli_interrupt_hold(true); /* checks put files in folders for a moment */
  int code = ranks_agree(&run->stage, check(run));
  cli_interrupt_hold(false);
  if (code == CLI_DONE)
    code = ranks_agree(&run->stage, begin_image(run));
  if (code == CLI_DONE && series_wanted(&run->options))
    return series_perform(run);
  if (code == CLI_DONE)
    code = load(run);
  if (code == CLI_DONE)
    code = make_picture(run);
  if (code == CLI_DONE)
    code = ranks_agree(&run->stage, write_files(run));
  return code;
}

void render_release(Run *run) {
  picture_await_image(run);
  tetcast_frame_destroy(&run->frame);
  ranks_end(&run->stage);
  stage_release(&run->stage);
  deep_release(&run->deep);
  free(run->stop);
  free(run->stats.render_seconds);
  render_options_release(&run->options);
}

int tetcast_cli_render(int argc, char **argv) {
  Run run = {.options = render_options_default(COMMAND_RENDER)};
  ranks_foresee(argc, argv);
  int code = render_options_parse(&run.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(run.options.quiet);
    cli_set_strict(run.options.strict);
    code = run.options.list_presets ? preset_list(&run.options) : perform(&run);
  }
  picture_await_image(&run);
  if (code != CLI_DONE)
    ranks_wait(&run.stage);
  render_release(&run);
  return outcome(code);
}
