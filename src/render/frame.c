/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "render/render.h"

TetcastStatus tc_frame_create(TetcastContext *context, const TetcastFrameDesc *desc, TetcastFrame **out) {
  TetcastFrame *frame;
  if (!tc_allocate_array(context, (void **)&frame, 1, sizeof *frame, "frame"))
    return TETCAST_ERROR_MEMORY;
  memset(frame, 0, sizeof *frame);
  frame->context = context;
  frame->width = desc->width;
  frame->height = desc->height;
  frame->type = desc->type;
  const int64_t row = desc->width * 4 * (int64_t)tc_type_size(desc->type);
  frame->row_stride = desc->pixels && desc->row_stride ? desc->row_stride : row;
  frame->pixels = desc->pixels;
  if (!desc->pixels) {
    if (!tc_allocate_array(context, &frame->memory, desc->height, (size_t)row, "pixels")) {
      tc_frame_destroy(frame);
      return TETCAST_ERROR_MEMORY;
    }
    memset(frame->memory, 0, (size_t)(row * desc->height));
    frame->pixels = frame->memory;
  }
  frame->groups = desc->groups;
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (!(desc->channels & tc_channels[i].info.channel))
      continue;
    const size_t pixel = (size_t)tc_frame_depth(frame, i) * tc_type_size(desc->type);
    if (!tc_allocate_array(context, &frame->channel[i], desc->width * desc->height, pixel, "channel")) {
      tc_frame_destroy(frame);
      return TETCAST_ERROR_MEMORY;
    }
    memset(frame->channel[i], 0, (size_t)(desc->width * desc->height) * pixel);
  }
  *out = frame;
  return TETCAST_OK;
}

void tc_frame_destroy(TetcastFrame *frame) {
  if (!frame)
    return;
  tc_release(frame->context, frame->memory);
  for (int i = 0; i < TC_CHANNELS; ++i)
    tc_release(frame->context, frame->channel[i]);
  tc_release(frame->context, frame);
}

static void store_channel(TetcastFrame *frame, int channel, int64_t x, int64_t y, const TcGathered *gathered) {
  const int count = tc_frame_depth(frame, channel);
  const int64_t first = (y * frame->width + x) * count;
  for (int i = 0; i < count; ++i) {
    const double value = tc_channels[channel].value(gathered, i);
    if (frame->type == TETCAST_TYPE_FLOAT64)
      ((double *)frame->channel[channel])[first + i] = value;
    else
      ((float *)frame->channel[channel])[first + i] = (float)value;
  }
}

void tc_frame_recolor(TetcastFrame *frame, const TcPieces *colors) {
  const bool wide = frame->type == TETCAST_TYPE_FLOAT64;
  const void *values = tc_frame_channel(frame, TETCAST_CHANNEL_VALUE);
  for (int64_t y = 0; y < frame->height; ++y) {
    char *row = (char *)frame->pixels + y * frame->row_stride;
    for (int64_t x = 0; x < frame->width; ++x) {
      const int64_t i = y * frame->width + x;
      double rgba[4];
      if (wide) {
        double *pixel = (double *)(void *)row + 4 * x;
        tc_color_value(colors, ((const double *)values)[i], pixel[3], rgba);
        memcpy(pixel, rgba, 3 * sizeof *pixel);
      } else {
        float *pixel = (float *)(void *)row + 4 * x;
        tc_color_value(colors, (double)((const float *)values)[i], (double)pixel[3], rgba);
        for (int k = 0; k < 3; ++k)
          pixel[k] = (float)rgba[k];
      }
    }
  }
}

void tc_frame_get(const TetcastFrame *frame, int64_t x, int64_t y, double rgba[4]) {
  const char *row = (const char *)frame->pixels + y * frame->row_stride;
  for (int k = 0; k < 4; ++k) {
    rgba[k] = frame->type == TETCAST_TYPE_FLOAT64 ? ((const double *)(const void *)row)[4 * x + k]
                                                  : (double)((const float *)(const void *)row)[4 * x + k];
  }
}

double tc_frame_put(TetcastFrame *frame, int64_t x, int64_t y, const double rgba[4]) {
  char *row = (char *)frame->pixels + y * frame->row_stride;
  if (frame->type == TETCAST_TYPE_FLOAT64) {
    memcpy(row + x * 4 * (int64_t)sizeof(double), rgba, 4 * sizeof(double));
    return 0;
  }
  const float pixel[4] = {(float)rgba[0], (float)rgba[1], (float)rgba[2], (float)rgba[3]};
  memcpy(row + x * 4 * (int64_t)sizeof(float), pixel, sizeof pixel);
  double rounding = 0;
  for (int k = 0; k < 4; ++k)
    rounding = fmax(rounding, fabs((double)pixel[k] - rgba[k]));
  return rounding;
}

double tc_frame_store(TetcastFrame *frame, int64_t x, int64_t y, TcGathered *gathered) {
  double rgba[4];
  gathered->single = frame->type == TETCAST_TYPE_FLOAT32; /* so that colouring anew gives the same */
  gathered->error = tc_gathered_pixel(gathered, rgba);
  const double rounding = tc_frame_put(frame, x, y, rgba);
  if (gathered->single) {
    gathered->error += rounding;
    if (gathered->error > 0)
      gathered->error = (double)nextafterf((float)gathered->error, INFINITY);
  }
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (frame->channel[i])
      store_channel(frame, i, x, y, gathered);
  }
  return gathered->error;
}
