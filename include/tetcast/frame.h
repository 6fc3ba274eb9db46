/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_FRAME_H
#define TETCAST_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/status.h>
#include <tetcast/transfer_function.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A picture in memory: red, green, blue, alpha, colour premultiplied, row 0 at the top, values as composited; and the
 * channels that were asked for besides, each an array of its own. */
typedef struct TetcastFrame TetcastFrame;

/* Channels beside red, green, blue, alpha; bits of a set. */
typedef enum TetcastChannel {
  /* A bound on the error of each of the pixel's four channels: what the tolerance let go; what rounding does to the
   * places where rays meet faces and to the values there, to the integral, to the sum over a ray's segments; rounding
   * to the frame's type. Measured along each ray, which takes longer. */
  TETCAST_CHANNEL_ERROR = 1,

  /* Of a scene with coefficients (scene.h), for each group: */
  TETCAST_CHANNEL_RADIANCE = 2,      /* unit of the emission times length */
  TETCAST_CHANNEL_OPTICAL_DEPTH = 4, /* ∫ κ dt along the ray, through all of the mesh */
  TETCAST_CHANNEL_TRANSMITTANCE = 8, /* exp(−optical depth) */

  /* Of a scene with coefficients: length of the ray's parts in the mesh's cells, in its unit; cells that overlap count
     each. */
  TETCAST_CHANNEL_PATH_LENGTH = 16,

  /* Of a scene in a blend mode other than composite: the value along the ray, in the scalar's unit, or that times the
   * mesh's unit of length; of several samples the mean of those that have one; NaN where none has. */
  TETCAST_CHANNEL_VALUE = 32
} TetcastChannel;

#define TETCAST_MAX_GROUPS 256

typedef struct TetcastFrameDesc {
  uint32_t cookie;
  int64_t width, height; /* pixels, each in [1, 2^20] */
  TetcastType type;   /* TETCAST_TYPE_FLOAT32 or TETCAST_TYPE_FLOAT64 (default); integration is in double either way */
  void *pixels;       /* [height][width][4] of `type`, borrowed while the frame lives; NULL: the frame allocates */
  int64_t row_stride; /* bytes from row to row of `pixels`; 0: rows lie next to each other */
  uint32_t channels;  /* TetcastChannel bits; default 0. The frame allocates these */
  int groups;         /* of the channels that have one for each, in [1, TETCAST_MAX_GROUPS]; default 1 */
} TetcastFrameDesc;

/* What there is to know of a channel. */
typedef struct TetcastChannelInfo {
  /* Its bit. */
  TetcastChannel channel;
  /* What commands and picture files call it. */
  const char *name;
  /* A sentence that says what it is. */
  const char *description;
  /* Not 0: it has a value for each group, else one. */
  int of_groups;
  /* Not 0: only scenes with coefficients have it. */
  int needs_coefficients;
  /* Not 0: only scenes in a blend mode other than composite have it. */
  int needs_blend;
} TetcastChannelInfo;

/* Channel i = 0, 1, …, in the order in which files hold them; NULL beyond the last. Static storage. */
TETCAST_API const TetcastChannelInfo *tetcast_channel_info(int i);

TETCAST_API TetcastFrameDesc tetcast_frame_desc_default(void);

TETCAST_API TetcastStatus tetcast_frame_create(TetcastContext *context, const TetcastFrameDesc *desc,
                                               TetcastFrame **frame);

/* Frees the frame (not borrowed pixels) and sets *frame to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_frame_destroy(TetcastFrame **frame);

TETCAST_API int64_t tetcast_frame_width(const TetcastFrame *frame);
TETCAST_API int64_t tetcast_frame_height(const TetcastFrame *frame);
TETCAST_API TetcastType tetcast_frame_type(const TetcastFrame *frame);
TETCAST_API const void *tetcast_frame_pixels(const TetcastFrame *frame);
TETCAST_API int64_t tetcast_frame_row_stride(const TetcastFrame *frame); /* bytes, never 0 */

TETCAST_API int tetcast_frame_groups(const TetcastFrame *frame);

/* The values of one channel, [height][width] of the frame's type, [height][width][groups] for those of groups, rows
 * next to each other, valid while the frame lives; NULL if the frame was made without it. */
TETCAST_API const void *tetcast_frame_channel(const TetcastFrame *frame, TetcastChannel channel);

/* Colours the pixels of a picture in a blend mode anew, without rendering: by the transfer function's colours at the
 * values of the channel TETCAST_CHANNEL_VALUE, which the frame must have (TETCAST_ERROR_ARGUMENT), times the pixels'
 * alpha, which stay as they are. It is, to the bit, what tetcast_scene_render() gives with that transfer function. */
TETCAST_API TetcastStatus tetcast_frame_recolor(TetcastFrame *frame, const TetcastTransferFunction *transfer_function);

#ifdef __cplusplus
}
#endif

#endif
