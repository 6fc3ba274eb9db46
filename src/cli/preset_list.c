/* SPDX-License-Identifier: Apache-2.0 */
#include "preset_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "adapter.h"
#include "cli.h"
#include "color.h"
#include "file.h"
#include "progress.h"

/* Of the picture, all in pixels but the first. */
enum { MOST = 64, MARGIN = 12, WIDTH = 788, BAR_WIDTH = 512, BAR_HEIGHT = 24, PITCH = 36 };

static int print_names(void) {
  static const char *const kinds[] = {[TETCAST_PRESET_SEQUENTIAL] = "sequential",
                                      [TETCAST_PRESET_DIVERGING] = "diverging",
                                      [TETCAST_PRESET_CATEGORICAL] = "categorical"};
  for (int i = 0; tetcast_preset_name(i); i++)
    printf("%-20s %s\n", tetcast_preset_name(i), kinds[tetcast_preset_kind(tetcast_preset_name(i))]);
  return cli_finish_output();
}

static TetcastStatus draw_bar(TetcastContext *context, const char *name, float *place) {
  TetcastTransferFunction *map = NULL;
  const TetcastStatus status = tetcast_transfer_function_create_preset(context, name, 0, 1, 0, &map);
  if (status != TETCAST_OK)
    return status;
  int64_t count;
  const double *knots = tetcast_transfer_function_color(map, &count);
  for (int64_t i = 0; i < BAR_WIDTH * BAR_HEIGHT; i++) {
    double rgb[3];
    float *rgba = place + 4 * (i / BAR_WIDTH * WIDTH + i % BAR_WIDTH);
    colors_at(knots, count, ((double)(i % BAR_WIDTH) + 0.5) / BAR_WIDTH, rgb);
    for (int k = 0; k < 4; k++)
      rgba[k] = k < 3 ? (float)rgb[k] : 1;
  }
  tetcast_transfer_function_destroy(&map);
  return status;
}

/* A bar of each map, its name beside it. */
static TetcastStatus write_picture(TetcastContext *context, const char *path) {
  TetcastCaption captions[MOST];
  int count = 0;
  while (count < MOST && tetcast_preset_name(count))
    count++;
  const int64_t height = MARGIN + count * PITCH;
  const size_t numbers = (size_t)(4 * WIDTH * height);
  float *pixels = cli_allocate(sizeof *pixels * numbers);
  memset(pixels, 0, sizeof *pixels * numbers);
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; i < count && status == TETCAST_OK; i++) {
    const int64_t top = MARGIN + i * PITCH;
    captions[i] = (TetcastCaption){.text = tetcast_preset_name(i), .x = MARGIN, .y = top + BAR_HEIGHT / 2, .size = 16};
    status = draw_bar(context, captions[i].text, pixels + 4 * (top * WIDTH + WIDTH - MARGIN - BAR_WIDTH));
  }
  TetcastImageDesc image = cli_image()->image_desc_default();
  image.captions = captions;
  image.caption_count = count;
  if (status == TETCAST_OK)
    status = cli_write_pixels(context, path, pixels, WIDTH, height, &image);
  free(pixels);
  return status;
}

int preset_list(const RenderOptions *options) {
  if (!options->output)
    return print_names();
  TetcastContext *context = cli_context_create((int)options->threads);
  if (!context || !cli_image()) {
    tetcast_context_destroy(&context);
    return CLI_FAILED;
  }
  cli_interrupt_hold(true);
  cli_file_tidy(options->output);
  const TetcastStatus status = write_picture(context, options->output);
  cli_interrupt_hold(false);
  tetcast_context_destroy(&context);
  return status == TETCAST_OK ? cli_verdict(CLI_DONE) : cli_failed(status);
}
