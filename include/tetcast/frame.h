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
  /* A bound on the error of each of the pixel's four channels. It contains what the tolerance allows; the rounding of
   * the places where rays meet faces and of the values there, of the integral, of the sum over a ray's segments, and to
   * the frame's type. It is measured along each ray, which takes longer. Where cells overlap, which of them comes first
   * may be decided by rounding, which the bound leaves out. */
  TETCAST_CHANNEL_ERROR = 1,

  /* The following three are of scenes with coefficients (scene.h) and have a value for each group. */
  TETCAST_CHANNEL_RADIANCE = 2,      /* the radiance, in the emission's unit times length */
  TETCAST_CHANNEL_OPTICAL_DEPTH = 4, /* ∫ κ dt along the ray, through all of the mesh */
  TETCAST_CHANNEL_TRANSMITTANCE = 8, /* exp(−optical depth) */

  /* Of scenes with coefficients: the length of the ray's parts in cells, in the mesh's unit. Where cells overlap, each
   * of them counts. */
  TETCAST_CHANNEL_PATH_LENGTH = 16,

  /* Of scenes in a blend mode other than composite: the value that the blend mode makes of the scalar, in the scalar's
   * unit, or in that times the mesh's unit of length. With several samples it is the mean of those that have a value;
   * NaN if none has. */
  TETCAST_CHANNEL_VALUE = 32,

  /* Of a scene with a transfer function or surfaces: the distance along the ray at which alpha first exceeds 1/2, or at
   * which the ray meets the first surface whose opacity is at least 1/2, whichever comes first, in the mesh's unit of
   * length: from the eye, or, of an orthographic camera, from the plane through it. Infinite where neither is; of
   * several samples the mean of those where it is not. Not together with TETCAST_CHANNEL_ERROR. */
  TETCAST_CHANNEL_DEPTH = 64,

  /* How many of the mesh's cells the ray crosses over a length above 0, from where it starts, or is clipped to, to
   * where it stops, whatever hides them: also cells that nothing is seen of. Of several samples the mean. Counted on a
   * walk of its own, so that the picture is the same without. */
  TETCAST_CHANNEL_CELLS = 128,

  /* Three values, of scenes as with TETCAST_CHANNEL_DEPTH: where that is the depth of a surface, the surface's normal
   * there, a unit vector in the mesh's coordinates towards the eye: an isosurface's as the shading desc says, whether
   * light falls on it or not. 0, 0, 0 where it is the depth of the volume, or infinite. Of several samples the
   * direction of the sum. */
  TETCAST_CHANNEL_NORMAL = 256
} TetcastChannel;

/* The most groups that coefficients may have. */
#define TETCAST_MAX_GROUPS 256

/* What a frame is made from. */
typedef struct TetcastFrameDesc {
  /* Set by tetcast_frame_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The number of pixels in a row, in [1, 2^20]. */
  int64_t width;
  /* The number of rows, in [1, 2^20]. */
  int64_t height;
  /* The type of pixels and channels, TETCAST_TYPE_FLOAT32 or TETCAST_TYPE_FLOAT64 (the default). Light is integrated in
   * double precision either way. */
  TetcastType type;
  /* [height][width][4] of `type`: where the pixels go, borrowed while the frame lives. NULL (the default): the frame
   * allocates them. */
  void *pixels;
  /* Bytes from row to row of `pixels`. Default: 0, rows lie next to each other. */
  int64_t row_stride;
  /* The channels that the frame has besides, bits of TetcastChannel. The frame allocates them. Default: 0, none. */
  uint32_t channels;
  /* The number of values per pixel in channels that have one for each group, in [1, TETCAST_MAX_GROUPS]. Default: 1. */
  int groups;
} TetcastFrameDesc;

/* Describes a channel. */
typedef struct TetcastChannelInfo {
  /* The channel's bit. */
  TetcastChannel channel;
  /* The name by which the command calls it. In static storage, never NULL. */
  const char *name;
  /* The name that it has in picture files, as users of OpenEXR expect it, with a number behind it for each of several
   * groups, or ".X", ".Y", ".Z" for three components. In static storage, never NULL. */
  const char *file_name;
  /* A sentence that says what it is. In static storage, never NULL. */
  const char *description;
  /* How many values it has for a pixel: 1, or 3 for a vector; 0 if it has one for each group. */
  int components;
  /* Not 0 if it has a value for each group. */
  int of_groups;
  /* Not 0 if only scenes with coefficients have it. */
  int needs_coefficients;
  /* Not 0 if only scenes with a transfer function or surfaces, in the blend mode composite, have it. */
  int needs_composite;
  /* Not 0 if only scenes in a blend mode other than composite have it. */
  int needs_blend;
} TetcastChannelInfo;

/* Describes channel i = 0, 1, …, in the order in which files hold them; NULL beyond the last. Static storage. */
TETCAST_API const TetcastChannelInfo *tetcast_channel_info(int i);

/* Makes a desc with every setting at its default; width and height have none. */
TETCAST_API TetcastFrameDesc tetcast_frame_desc_default(void);

/* Makes a frame. What it allocates is 0 until a scene is rendered into it. */
TETCAST_API TetcastStatus tetcast_frame_create(TetcastContext *context, const TetcastFrameDesc *desc,
                                               TetcastFrame **frame);

/* Frees the frame (not borrowed pixels) and sets *frame to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_frame_destroy(TetcastFrame **frame);

/* The number of pixels in a row. */
TETCAST_API int64_t tetcast_frame_width(const TetcastFrame *frame);

/* The number of rows. */
TETCAST_API int64_t tetcast_frame_height(const TetcastFrame *frame);

/* The type of pixels and channels. */
TETCAST_API TetcastType tetcast_frame_type(const TetcastFrame *frame);

/* [height][width][4]: the pixels, borrowed or the frame's own; valid while the frame lives. */
TETCAST_API const void *tetcast_frame_pixels(const TetcastFrame *frame);

/* Bytes from row to row of the pixels, never 0. */
TETCAST_API int64_t tetcast_frame_row_stride(const TetcastFrame *frame);

/* The number of values per pixel in channels that have one for each group. */
TETCAST_API int tetcast_frame_groups(const TetcastFrame *frame);

/* The values of one channel, valid while the frame lives: [height][width] of the frame's type, or
 * [height][width][groups] for a channel that has a value for each group, or [height][width][3] for a vector, rows next
 * to each other. NULL if the frame was made without it. */
TETCAST_API const void *tetcast_frame_channel(const TetcastFrame *frame, TetcastChannel channel);

/* Colours the pixels of a picture in a blend mode anew, without rendering. A pixel's colour becomes the transfer
 * function's colour at its value in the channel TETCAST_CHANNEL_VALUE, which the frame must have
 * (TETCAST_ERROR_ARGUMENT), times its alpha, which stays as it is. The result is, to the bit, what
 * tetcast_scene_render() gives with that transfer function. */
TETCAST_API TetcastStatus tetcast_frame_recolor(TetcastFrame *frame, const TetcastTransferFunction *transfer_function);

/* Writes the picture over a background as 8-bit numbers, row 0 at the top, as windows and simple formats take them: a
 * component v becomes ⌊255 v + ½⌋ of what v is within [0, 1]; NaN becomes 0. Values are taken as they are, as
 * compositing takes them: colours of transfer functions are display values (sRGB), and no gamma is applied.
 *
 * `background` [4]: red, green, blue and alpha, each in [0, 1], not premultiplied. `channels`: 3, red, green, blue,
 * where a translucent background itself lies over black; or 4, with alpha, by which colours are then not premultiplied.
 * `bytes` is the first component of row 0, and `row_stride` how many bytes later the same of row 1 is: of magnitude
 * width · channels at least, negative for a memory with its lowest row first; 0: width · channels. Other numbers are
 * TETCAST_ERROR_ARGUMENT. The frame's context has the threads; calls may run at the same time. */
TETCAST_API TetcastStatus tetcast_frame_bytes(const TetcastFrame *frame, const double background[4], int channels,
                                              unsigned char *bytes, int64_t row_stride);

#ifdef __cplusplus
}
#endif

#endif
