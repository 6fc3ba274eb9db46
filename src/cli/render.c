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
#include "progress.h"
#include "render.h"
#include "scene_file.h"
#include "series.h"
#include "sight.h"

char *render_default_output(const char *input) {
  const char *name = cli_path_name(input);
  const char *dot = strrchr(name, '.');
  return cli_print("%.*s.png", (int)(dot && dot != name ? (size_t)(dot - name) : strlen(name)), name);
}

/* Removes what killed runs have left where this one writes. */
static void tidy(const RenderOptions *options) {
  const char *const outputs[] = {options->output, options->stats, options->save_scene};
  for (int i = 0; i < 3; i++)
    if (outputs[i])
      cli_file_tidy(outputs[i]);
}

/* All that can be known to fail before the mesh is read and needs no image library. */
static int check(Run *run) {
  RenderOptions *options = &run->options;
  if (!options->output)
    options->output = render_default_output(options->input);
  FileSet files = {0};
  fileset_add_options(&files, options);
  if (!series_wanted(options)) /* else it has many names */
    fileset_add(&files, "--output", options->output, true);
  int code = fileset_check(&files, "render");
  if (code < 0 && series_wanted(options) && render_options_blend(options) == TETCAST_BLEND_ADDITIVE &&
      !render_options_given(options, OPTION_TRANSFER) && render_options_range(options) != RANGE_FIXED &&
      render_options_range(options) != RANGE_STEP)
    code = cli_usage_error("render", "--blend additive: the range of all steps' pictures is known when they are made; expected --range LO,HI or --range step");
  if (code >= 0)
    return code;
  code = stage_begin(&run->stage, options);
  if (code != CLI_DONE)
    return code;
  tidy(options);
  if ((options->stats && !cli_file_check(options->stats)) ||
      (options->save_scene && !cli_file_check(options->save_scene)))
    return CLI_FAILED;
  if (render_options_given(options, OPTION_EMISSION) && !render_options_given(options, OPTION_BACKGROUND))
    options->background[0] = options->background[1] = options->background[2] = 0; /* what shines is seen against the dark */
  if (options->source >> OPTION_BACKGROUND & 1 && render_options_floating(options)) /* on the command line, that is */
    cli_warning("--background has no effect: floating-point pixels hold the picture without background");
  return cli_verdict(CLI_DONE);
}

/* Whether the picture can be written where and as it is to be. */
static int check_image(Run *run) {
  run->image = cli_image();
  if (!run->image)
    return CLI_FAILED;
  run->image_desc = run->image->image_desc_default();
  run->image_desc.pixel_type = (TetcastPixelType)run->options.pixel_type;
  memcpy(run->image_desc.background, run->options.background, sizeof run->options.background);
  run->image_desc.channels_only = render_options_given(&run->options, OPTION_GROUPS) && run->options.groups;
  cli_interrupt_hold(true); /* the check puts a file in a folder for a moment */
  const TetcastStatus status = run->image->image_check(run->stage.context, run->options.output, &run->image_desc);
  cli_interrupt_hold(false);
  return status == TETCAST_OK ? cli_verdict(CLI_DONE) : cli_failed(status);
}

/* What the command ends with. */
static int outcome(int code) {
  if (!cli_interrupted())
    return code;
  fputs("tetcast: error: interrupted\n", stderr);
  return 128 + cli_interrupted();
}

/* A picture that can't be written is told before anything that is found out about the mesh, and at once: reading, which
 * may take long and can't be stopped, ends with the process. */
static void *check_image_aside(void *argument) {
  Run *run = argument;
  cli_messages_hold(true);
  sem_post(&run->image_begun);
  const int code = check_image(run);
  if (code != CLI_DONE)
    _exit(outcome(code));
  cli_messages_hold(false);
  return NULL;
}

void render_await_image(Run *run) {
  if (run->image_pending)
    pthread_join(run->image_thread, NULL);
  run->image_pending = false;
}

/* Loading the image library takes about as long as reading a large mesh, and both are work for one processor: they are
 * done at the same time. */
static int begin_image(Run *run) {
  if (!cli_vtk()) /* before the thread begins: only one library is loaded at a time */
    return CLI_FAILED;
  sem_init(&run->image_begun, 0, 0);
  if (pthread_create(&run->image_thread, NULL, check_image_aside, run) != 0)
    return check_image(run);
  run->image_pending = true;
  while (sem_wait(&run->image_begun) != 0) /* a signal */
    continue;
  return CLI_DONE;
}

/* Reads the input and prepares the scene, after which nothing of the dataset stays in memory. */
static int load(Run *run) {
  int code = stage_read(&run->stage, &run->options);
  if (code == CLI_DONE)
    code = stage_prepare(&run->stage, &run->options);
  stage_drop_dataset(&run->stage);
  if (code == CLI_DONE)
    code = stage_shade(&run->stage, &run->options, run->stage.range);
  return code;
}

/* Whether colours go from the least to the largest value of the picture: integrals along rays are not in the field's range. */
static bool range_of_picture(const Run *run) {
  const RenderOptions *options = &run->options;
  return render_options_blend(options) == TETCAST_BLEND_ADDITIVE && !render_options_given(options, OPTION_TRANSFER) &&
         render_options_range(options) != RANGE_FIXED && !(run->stage.uniform && run->stage.array);
}

/* Colours the picture by the preset over the range of its values. */
static TetcastStatus color_by_picture(Run *run) {
  const bool wide = tetcast_frame_type(run->values) == TETCAST_TYPE_FLOAT64;
  const void *values = tetcast_frame_channel(run->values, TETCAST_CHANNEL_VALUE);
  const int64_t count = tetcast_frame_width(run->values) * tetcast_frame_height(run->values);
  double range[2] = {INFINITY, -INFINITY};
  for (int64_t i = 0; i < count; i++) {
    const double value = wide ? ((const double *)values)[i] : (double)((const float *)values)[i];
    if (!isfinite(value))
      continue;
    range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], value);
  }
  if (range[0] > range[1])
    return TETCAST_OK;
  Stage *stage = &run->stage;
  tetcast_transfer_function_destroy(&stage->transfer_function);
  const TetcastStatus status =
      tetcast_scene_create_preset(stage->scene, render_options_preset(&run->options), range[0], range[1], &stage->transfer_function);
  return status == TETCAST_OK ? tetcast_frame_recolor(run->values, stage->transfer_function) : status;
}

int render_create_frame(Run *run) {
  const RenderOptions *options = &run->options;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = (int64_t)options->size[0];
  desc.height = (int64_t)options->size[1];
  desc.type = options->pixel_type == TETCAST_PIXEL_DOUBLE ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
  desc.channels = render_options_channels(options);
  if (tetcast_scene_groups(run->stage.scene) > 0)
    desc.groups = tetcast_scene_groups(run->stage.scene);
  TetcastStatus status = tetcast_frame_create(run->stage.context, &desc, &run->frame);
  if (status == TETCAST_OK && range_of_picture(run)) {
    desc.channels = TETCAST_CHANNEL_VALUE;
    desc.pixels = (void *)tetcast_frame_pixels(run->frame);
    status = tetcast_frame_create(run->stage.context, &desc, &run->values);
  }
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* Whether colours may come out above 1: radiance, or a transfer function that has them. */
static bool may_shine(const Run *run) {
  if (render_options_given(&run->options, OPTION_EMISSION))
    return true;
  int64_t count = 0;
  const TetcastTransferFunction *transfer_function = run->stage.transfer_function;
  const double *color = transfer_function ? tetcast_transfer_function_color(transfer_function, &count) : NULL;
  for (int64_t i = 0; i < 4 * count; i++)
    if (i % 4 > 0 && color[i] > 1)
      return true;
  return false;
}

/* Radiance has no scale of its own: what an integer pixel makes of it may be all white or all black. */
static void check_brightness(const Run *run) {
  if (render_options_floating(&run->options) || !may_shine(run))
    return;
  const float *pixels = tetcast_frame_pixels(run->frame);
  const int64_t count = tetcast_frame_width(run->frame) * tetcast_frame_height(run->frame);
  float brightest = 0;
  for (int64_t i = 0; i < 4 * count; i++)
    if (i % 4 < 3 && pixels[i] > brightest)
      brightest = pixels[i];
  const bool radiance = render_options_given(&run->options, OPTION_EMISSION);
  if (brightest > 1)
    cli_warning("%s up to %g: above 1 all is white in integer pixels; .exr and .tif hold it as it is",
                radiance ? "radiance" : "colours", (double)brightest);
  else if (radiance && brightest > 0 && brightest < 1.0f / 255)
    cli_warning("radiance up to %g: below 1/255 all is black in integer pixels; .exr and .tif hold it as it is", (double)brightest);
}

int render_frame(Run *run) {
  RunStats *stats = &run->stats;
  stats->threads = tetcast_context_threads(run->stage.context);
  stats->repeats = (int)run->options.repeat;
  if (!stats->render_seconds)
    stats->render_seconds = cli_allocate(sizeof(double) * (size_t)stats->repeats);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.samples = (int)run->options.samples;
  desc.isa = (TetcastIsa)run->options.isa;
  desc.tolerance = stats->tolerance = run->options.tolerance;
  stats->blend = render_option_choice(OPTION_BLEND, (int)render_options_blend(&run->options));
  if (run->options.integrator)
    render_option_integrator(run->options.integrator, &desc.integrator, &desc.integrator_n);
  for (int i = 0; i < stats->repeats; i++) {
    const double start = cli_seconds();
    desc.progress = cli_progress("rendering");
    TetcastStatus status = tetcast_scene_render(run->stage.scene, &run->stage.camera, &desc,
                                                run->values ? run->values : run->frame, &stats->render);
    if (status == TETCAST_OK && run->values)
      status = color_by_picture(run);
    stats->render_seconds[i] = cli_seconds() - start;
    cli_progress_clear();
    if (status != TETCAST_OK || cli_interrupted())
      return cli_failed(status);
  }
  if (stats->render.lost > 0)
    cli_warning(
        "%lld of %lld rays were lost on their way through the mesh: the picture has faults there, please report this",
        (long long)stats->render.lost, (long long)stats->render.rays);
  check_brightness(run);
  return cli_verdict(CLI_DONE);
}

int render_write_image(Run *run, const char *path) {
  const Stage *stage = &run->stage;
  render_await_image(run);
  const double start = cli_seconds();
  const TetcastStatus status = run->image->image_write(stage->context, path, run->frame, &run->image_desc);
  run->stats.write_seconds = cli_seconds() - start;
  run->stats.read_seconds = stage->read_seconds;
  run->stats.prepare_seconds = stage->prepare_seconds;
  run->stats.volume = stage->info;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* A picture in which nothing can be seen is worth a word. */
static int check_sight(const Run *run) {
  char *fault = sight_fault(run);
  if (fault)
    cli_warning("%s", fault);
  free(fault);
  return cli_verdict(CLI_DONE);
}

static int write_files(Run *run) {
  const RenderOptions *options = &run->options;
  const Stage *stage = &run->stage;
  const int code = render_write_image(run, options->output);
  if (code != CLI_DONE)
    return code;
  if (options->save_scene && !scene_file_write(options, stage->array, &stage->camera, stage->transfer_function))
    return CLI_FAILED;
  return !options->stats || cli_json_write(options->stats, stats_object(&run->stats)) ? CLI_DONE : CLI_FAILED;
}

static int perform(Run *run) {
  cli_warn_once();          /* what the check of the output says, and writing it again, and each step of a series */
  cli_interrupt_hold(true); /* checks put files in folders for a moment */
  int code = check(run);
  cli_interrupt_hold(false);
  if (code == CLI_DONE)
    code = begin_image(run);
  if (code == CLI_DONE && series_wanted(&run->options))
    return series_perform(run);
  if (code == CLI_DONE)
    code = load(run);
  if (code == CLI_DONE)
    code = render_create_frame(run);
  if (code == CLI_DONE)
    code = render_frame(run);
  if (code == CLI_DONE)
    code = check_sight(run);
  if (code == CLI_DONE)
    code = write_files(run);
  return code;
}

int tetcast_cli_render(int argc, char **argv) {
  Run run = {.options = render_options_default(COMMAND_RENDER)};
  int code = render_options_parse(&run.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(run.options.quiet);
    cli_set_strict(run.options.strict);
    code = perform(&run);
  }
  render_await_image(&run);
  tetcast_frame_destroy(&run.values);
  tetcast_frame_destroy(&run.frame);
  stage_release(&run.stage);
  free(run.stats.render_seconds);
  render_options_release(&run.options);
  return outcome(code);
}
