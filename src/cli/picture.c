/* SPDX-License-Identifier: Apache-2.0 */
#include "picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"
#include "progress.h"
#include "ranks.h"

char *picture_default_output(const char *input) {
  const char *name = cli_path_name(input);
  const char *dot = strrchr(name, '.');
  return cli_print("%.*s.png", (int)(dot && dot != name ? (size_t)(dot - name) : strlen(name)), name);
}

void picture_await_image(Run *run) {
  if (run->image_pending)
    pthread_join(run->image_thread, NULL);
  run->image_pending = false;
}

/* Whether colours go from the least to the largest value of the picture: integrals along rays are not in the field's
 * range. */
static bool range_of_picture(const Run *run) {
  const RenderOptions *options = &run->options;
  return render_options_blend(options) == TETCAST_BLEND_ADDITIVE && !render_options_given(options, OPTION_TRANSFER) &&
         render_options_range(options) != RANGE_FIXED && !(run->stage.uniform && run->stage.array);
}

/* Colours the picture by the preset over the range of its values. */
static TetcastStatus color_by_picture(Run *run) {
  const bool wide = tetcast_frame_type(run->frame) == TETCAST_TYPE_FLOAT64;
  const void *values = tetcast_frame_channel(run->frame, TETCAST_CHANNEL_VALUE);
  const int64_t count = tetcast_frame_width(run->frame) * tetcast_frame_height(run->frame);
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
  const TetcastStatus status = stage_preset(stage, &run->options, range, &stage->transfer_function);
  return status == TETCAST_OK ? tetcast_frame_recolor(run->frame, stage->transfer_function) : status;
}

int picture_create_frame(Run *run, int64_t width, int64_t height) {
  const RenderOptions *options = &run->options;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.type = options->pixel_type == TETCAST_PIXEL_DOUBLE ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
  desc.channels = render_options_channels(options);
  if (range_of_picture(run)) /* it is coloured by them; they are written if they were asked for */
    desc.channels |= TETCAST_CHANNEL_VALUE;
  if (ranks_groups(&run->stage) > 0)
    desc.groups = ranks_groups(&run->stage);
  const TetcastStatus status = tetcast_frame_create(run->stage.context, &desc, &run->frame);
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
  const double shown = (double)brightest * render_options_gain(&run->options);
  if (shown > 1)
    cli_warning("%s up to %g: above 1 all is white in integer pixels; .exr and .tif hold it as it is",
                radiance ? "radiance" : "colours", (double)brightest);
  else if (radiance && brightest > 0 && shown < 1.0 / 255)
    cli_warning("radiance up to %g: below 1/255 all is black in integer pixels; .exr and .tif hold it as it is",
                (double)brightest);
}

int picture_read_stop(Run *run) {
  const RenderOptions *options = &run->options;
  const int64_t width = (int64_t)options->size[0], height = (int64_t)options->size[1];
  run->stop = cli_allocate(sizeof *run->stop * (size_t)(width * height));
  const TetcastStatus status =
      run->image->image_read_depth(run->stage.context, options->stop_depth, width, height, run->stop);
  if (status != TETCAST_OK)
    return cli_failed(status);
  for (int64_t i = 0; i < width * height; i++)
    if (isnan(run->stop[i])) {
      cli_error("--stop-depth '%s': pixel (%lld, %lld) is NaN; a ray that doesn't stop has an infinite depth",
                options->stop_depth, (long long)(i % width), (long long)(i / width));
      return CLI_FAILED;
    }
  return cli_verdict(CLI_DONE);
}

TetcastArray picture_stop(const Run *run) {
  return (TetcastArray){.data = run->stop,
                        .type = TETCAST_TYPE_FLOAT64,
                        .count = (int64_t)run->options.size[0] * (int64_t)run->options.size[1]};
}

int picture_render(Run *run) {
  if (run->options.stop_depth)
    picture_await_image(run); /* which reads it */
  RunStats *stats = &run->stats;
  stats->threads = tetcast_context_threads(run->stage.context);
  stats->repeats = (int)run->options.repeat;
  stats->read_seconds = run->stage.read_seconds;
  stats->prepare_seconds = run->stage.prepare_seconds;
  stats->volume = run->stage.info;
  if (!stats->render_seconds)
    stats->render_seconds = cli_allocate(sizeof(double) * (size_t)stats->repeats);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  if (render_options_adaptive(&run->options)) {
    desc.adaptive_epsilon = run->options.adaptive[0];
    desc.adaptive_coarse = (int)run->options.adaptive[1];
    desc.adaptive_fine = (int)run->options.adaptive[2];
  } else {
    desc.samples = (int)run->options.samples;
  }
  desc.picture_height = run->picture_height;
  desc.first_row = run->first_row;
  desc.isa = (TetcastIsa)run->options.isa;
  desc.tolerance = stats->tolerance = run->options.tolerance;
  stats->blend = render_option_choice(OPTION_BLEND, (int)render_options_blend(&run->options));
  if (run->options.integrator)
    render_option_integrator(run->options.integrator, &desc.integrator, &desc.integrator_n);
  const TetcastArray stop = picture_stop(run);
  for (int i = 0; i < stats->repeats; i++) {
    const double start = cli_seconds();
    desc.progress = cli_progress("rendering");
    desc.stop = run->stop ? &stop : NULL;
    TetcastStatus status = ranks_render(&run->stage, &desc, run->frame, &stats->render);
    if (status == TETCAST_OK && range_of_picture(run))
      status = color_by_picture(run);
    stats->render_seconds[i] = cli_seconds() - start;
    cli_progress_clear();
    if (status != TETCAST_OK ||
        (cli_interrupted() && !run->stage.others)) /* over ranks, the next call says so to all */
      return cli_failed(status);
  }
  if (!ranks_first(&run->stage))
    return cli_verdict(CLI_DONE);
  if (render_options_deep(&run->options)) {
    const TetcastStatus status = deep_render(&run->deep, &run->stage, &run->options, &desc, run->frame);
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

json_t *picture_stats(const Run *run) {
  json_t *object = stats_object(&run->stats);
  json_object_update_new(object, stage_choices(&run->stage, &run->options));
  return object;
}

TetcastStatus picture_decorate(Run *run, Decoration *decoration, TetcastImageDesc *desc) {
  const TetcastArray stop = picture_stop(run);
  TetcastRenderDesc render = tetcast_render_desc_default();
  render.stop = run->stop ? &stop : NULL;
  render.picture_height = run->picture_height;
  render.first_row = run->first_row;
  decoration_make(&run->stage, &run->options, decoration);
  desc->legend = decoration->colors ? &decoration->legend : NULL;
  return decoration_outline(&run->stage, &run->options, &render, run->frame);
}

int picture_write(Run *run, const char *path) {
  const Stage *stage = &run->stage;
  picture_await_image(run);
  const double start = cli_seconds();
  Decoration decoration;
  TetcastImageDesc desc = run->image_desc;
  TetcastStatus status = picture_decorate(run, &decoration, &desc);
  if (status == TETCAST_OK)
    status = render_options_deep(&run->options)
                 ? run->image->image_write_deep(stage->context, path, &run->deep.image, desc.pixel_type)
                 : run->image->image_write(stage->context, path, run->frame, &desc);
  decoration_release(&decoration);
  run->stats.write_seconds = cli_seconds() - start;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}
