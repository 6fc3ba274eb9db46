/* SPDX-License-Identifier: Apache-2.0 */
#include "tiles.h"

#include <math.h>
#include <stdlib.h>

#include "cli.h"
#include "progress.h"
#include "series.h"
#include "sight.h"

/* A band has this many bytes, unless that are less than the rows that files compress together. */
static const double band_bytes = 0x1p27;
enum { BAND_ROWS = 64, GLANCE = 256 };

const char *tiles_fault(const RenderOptions *options) {
  if (!render_options_given(options, OPTION_TILES))
    return NULL;
  const char *output = options->output ? options->output : "default.png";
  if (!render_option_has_extension(output, ".png") && !render_option_has_extension(output, ".exr") &&
      !render_option_is_tiff(output))
    return "--tiles: only .png, .exr and .tif are written in parts";
  if (series_wanted(options))
    return "--tiles: for one picture, not for those of --time all, --orbit and the like";
  if (render_options_deep(options) || options->stop_depth || render_options_adaptive(options) || options->repeat > 1)
    return "--tiles: not possible with --deep, --stop-depth, --adaptive or --repeat";
  return render_options_blend(options) == TETCAST_BLEND_ADDITIVE && !render_options_given(options, OPTION_TRANSFER) &&
                 render_options_range(options) != RANGE_FIXED
             ? "--tiles: with --blend additive the range of the picture is known when it is made; expected --range "
               "LO,HI"
             : NULL;
}

/* How many rows are made at a time. */
static int64_t rows_of(const RenderOptions *options) {
  const double asked = render_option_tiles(options->tiles);
  double numbers = 4;
  TetcastChannel list[32];
  if (options->channels)
    for (int i = render_option_channel_list(options->channels, list); i > 0; i--)
      numbers += list[i - 1] <= TETCAST_CHANNEL_TRANSMITTANCE ? 3 : 1;
  const double bytes = (options->pixel_type == TETCAST_PIXEL_DOUBLE ? 8 : 4) * numbers * options->size[0];
  const double rows = asked > 0 ? ceil(asked / BAND_ROWS) : fmax(floor(band_bytes / bytes / BAND_ROWS), 1);
  return (int64_t)rows * BAND_ROWS;
}

/* Warns, by a small picture, of one in which nothing can be seen. */
static int glance(Run *run) {
  double *size = run->options.size;
  const double whole[2] = {size[0], size[1]}, scale = fmin(GLANCE / fmax(size[0], size[1]), 1);
  for (int i = 0; i < 2; i++)
    size[i] = fmax(round(whole[i] * scale), 1);
  int code = picture_create_frame(run, (int64_t)size[0], (int64_t)size[1]);
  if (code == CLI_DONE)
    code = picture_render(run);
  char *fault = code == CLI_DONE ? sight_fault(run) : NULL;
  if (fault)
    cli_warning("%s", fault);
  free(fault);
  tetcast_frame_destroy(&run->frame);
  size[0] = whole[0];
  size[1] = whole[1];
  return cli_verdict(code);
}

/* The sums over bands. */
static void add(RunStats *sum, const RunStats *band) {
  sum->render_seconds[0] += band->render_seconds[0];
  sum->render.rays += band->render.rays;
  sum->render.segments += band->render.segments;
  sum->render.lost += band->render.lost;
  if (!(band->render.error <= sum->render.error))
    sum->render.error = band->render.error;
  sum->render.isa = band->render.isa;
  sum->render.precision = band->render.precision;
}

static int make_bands(Run *run, TetcastImage **image) {
  const int64_t width = (int64_t)run->options.size[0], height = (int64_t)run->options.size[1];
  const int64_t rows = rows_of(&run->options);
  double seconds[1] = {0};
  RunStats sum = run->stats;
  sum.render_seconds = seconds;
  sum.write_seconds = 0;
  sum.render.rays = sum.render.segments = sum.render.lost = 0;
  sum.render.error = 0;
  run->picture_height = height;
  int code = CLI_DONE;
  for (run->first_row = 0; run->first_row < height && code == CLI_DONE; run->first_row += rows) {
    const int64_t left = height - run->first_row;
    if (!run->frame || left < rows) {
      tetcast_frame_destroy(&run->frame);
      code = picture_create_frame(run, width, left < rows ? left : rows);
    }
    cli_progress_part("rendering", (double)run->first_row / (double)height,
                      fmin((double)(run->first_row + rows) / (double)height, 1));
    if (code == CLI_DONE)
      code = picture_render(run);
    if (code != CLI_DONE)
      break;
    add(&sum, &run->stats);
    const double start = cli_seconds();
    Decoration decoration;
    TetcastImageDesc desc = run->image_desc;
    TetcastStatus status = picture_decorate(run, &decoration, &desc);
    if (status == TETCAST_OK && !*image)
      status = run->image->image_begin(run->stage.context, run->options.output, run->frame, height, &desc, image);
    decoration_release(&decoration);
    if (status == TETCAST_OK)
      status = run->image->image_add(*image, run->frame);
    if (status == TETCAST_OK && left <= rows)
      status = run->image->image_end(image);
    sum.write_seconds += cli_seconds() - start;
    if (status != TETCAST_OK || cli_interrupted())
      code = cli_failed(status);
  }
  cli_progress_clear();
  cli_progress_part(NULL, 0, 1);
  double *own = run->stats.render_seconds;
  own[0] = seconds[0];
  sum.render_seconds = own;
  run->stats = sum;
  return code;
}

int tiles_perform(Run *run) {
  picture_await_image(run);
  TetcastImage *image = NULL;
  int code = glance(run);
  if (code == CLI_DONE)
    code = make_bands(run, &image);
  run->image->image_destroy(&image);
  return code;
}
