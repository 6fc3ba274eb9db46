/* SPDX-License-Identifier: Apache-2.0 */
/* Writing images, and reading depths, through OpenImageIO: target tetcast::openimageio, library libtetcast-openimageio.
 */
#ifndef TETCAST_IMAGE_H
#define TETCAST_IMAGE_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/frame.h>
#include <tetcast/status.h>
#include <tetcast/transfer_function.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The type of numbers that an image file holds. */
typedef enum TetcastPixelType {
  /* The type that suits the format: uint8 for PNG and JPEG; half for EXR, or float where the largest colour is above
   * 65504 or below 2^-14; float for TIFF; for other formats the one that they have. */
  TETCAST_PIXEL_DEFAULT = 0,
  TETCAST_PIXEL_UINT8,
  TETCAST_PIXEL_UINT16,
  TETCAST_PIXEL_HALF,
  TETCAST_PIXEL_FLOAT,
  TETCAST_PIXEL_DOUBLE
} TetcastPixelType;

/* A colour map or a list of colours with words beside it, drawn over the right of a picture by OpenImageIO's functions.
 */
typedef struct TetcastLegend {
  /* What the colours stand for, in UTF-8; NULL: nothing is written above them. Where OpenImageIO draws ASCII alone,
   * other letters of any text in a picture become question marks, with a warning. */
  const char *title;
  /* [color_count][3]: red, green and blue in [0, 1]; of a bar from below at equal distances, of categories from above.
   */
  const double *colors;
  /* The number of colours, at least 1. */
  int color_count;
  /* [label_count]: words or numbers in UTF-8; of a bar at their places, of categories one for each colour. */
  const char *const *labels;
  /* [label_count]: where a bar's labels are, from 0, its lower end, to 1; not read for categories. */
  const double *places;
  /* The number of labels, at least 0. */
  int label_count;
  /* Not 0: each colour is one of a list; else they are a bar that goes from one colour to the next. */
  int categories;
} TetcastLegend;

/* Words in a picture. */
typedef struct TetcastCaption {
  /* In UTF-8. */
  const char *text;
  /* Where they begin, in pixels from the left. */
  int64_t x;
  /* Where their middle line is, in pixels from the top. */
  int64_t y;
  /* The height of letters and the room between lines, in pixels, in [6, 400]. */
  int size;
} TetcastCaption;

/* How an image is written. */
typedef struct TetcastImageDesc {
  /* Set by tetcast_image_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The type of numbers in the file. Default: TETCAST_PIXEL_DEFAULT. */
  TetcastPixelType pixel_type;
  /* Red, green, blue and alpha in [0, 1], not premultiplied: integer pixels are composited over this background.
   * Floating-point pixels hold the frame as it is, premultiplied, without a background. Default: 1, 1, 1, 1, opaque
   * white. */
  double background[4];
  /* Not 0: `background` is that of the uppermost row, and goes over to `background_below`. Default: 0. */
  int background_shaded;
  /* As `background`, of the lowest row, with the same alpha. Not read unless the background is shaded. */
  double background_below[4];
  /* What is drawn over integer pixels that are at least 240 × 160 and leave room for it; floating-point pixels hold the
   * frame alone. Without a font there are no words, with a warning. NULL, the default: nothing. */
  const TetcastLegend *legend;
  /* [caption_count]: words that are drawn over integer pixels. NULL, the default: none. */
  const TetcastCaption *captions;
  /* The number of `captions`. Default: 0. */
  int caption_count;
  /* Integer pixels' colours are multiplied by 2^exposure before they are composited over the background, which is not.
   * Floating-point pixels are not changed. Finite. Default: 0. */
  double exposure;
  /* Not 0: colours are linear radiance, which floating-point files then state; else they are those of transfer
   * functions, which are display values (sRGB). Integer pixels are display values always. PNG and
   * JPEG state it as colour space, EXR and TIFF in words. Default: 0. */
  int linear;
  /* Not 0: only the frame's channels are written, without red, green, blue and alpha; it must have some. Default: 0. */
  int channels_only;
  /* [channel_count]: the frame's channels that are written, in this order, none twice. NULL (the default): all of them,
   * in the order of tetcast_channel_info(). EXR knows channels by their names alone. */
  const TetcastChannel *channels;
  /* The number of `channels`. Default: 0. */
  int channel_count;
} TetcastImageDesc;

/* Makes a desc with every setting at its default. */

TETCAST_API TetcastImageDesc tetcast_image_desc_default(void);

/* Writes the frame; the format is told by the path's extension: .png .exr .tif .tiff .jpg .jpeg, also .bmp .tga .webp
 * .ppm .hdr. A pixel type the format can't hold, an unknown extension: TETCAST_ERROR_ARGUMENT. Over a translucent
 * background, integer formats with alpha hold unassociated colour; .webp takes none. What a format or type can't hold,
 * such as 70000 as half or a negative colour in .hdr, is TETCAST_ERROR_ARGUMENT; beyond the range of a float it is
 * infinite. A frame's channels follow the four in .exr and .tif with floating-point pixels (float beside half in .exr),
 * in EXR by their file names (TetcastChannelInfo); of several groups "radiance.00", "radiance.01" …, as many digits as
 * the last needs. What can't hold them: TETCAST_ERROR_ARGUMENT.
 *
 * The file appears whole or not at all; one that is replaced keeps its mode, and a symbolic link is followed. While it
 * is written it is a hidden file beside its place, .tetcast-PROCESS-NUMBER with the same extension, under a lock
 * (flock): one without a lock is what a killed process left. OpenImageIO starts threads of its own for .exr and .tif;
 * where the system lets none start, that is TETCAST_ERROR_IO (and loading this library may end the process: OpenImageIO
 * is often built with OpenVDB, whose logger insists on threads when it is loaded). */
TETCAST_API TetcastStatus tetcast_image_write(TetcastContext *context, const char *path, const TetcastFrame *frame,
                                              const TetcastImageDesc *desc);

/* A picture that is written in bands of rows, as when it doesn't fit into memory. */
typedef struct TetcastImage TetcastImage;

/* Begins a picture of so many rows at `path`; `frame` is the first band, which is written by tetcast_image_add() like
 * the others. For .png, .exr and .tif; all else is as with tetcast_image_write(), and so is the file, to the byte, but
 * that TETCAST_PIXEL_DEFAULT is half for EXR whatever the colours are. */
TETCAST_API TetcastStatus tetcast_image_begin(TetcastContext *context, const char *path, const TetcastFrame *frame,
                                              int64_t height, const TetcastImageDesc *desc, TetcastImage **image);

/* Adds the next rows, with the width, type and channels of the first band; all bands but the last have a multiple
 * of 64.
 */
TETCAST_API TetcastStatus tetcast_image_add(TetcastImage *image, const TetcastFrame *frame);

/* Makes the file appear, of which all rows must have been added, and frees the image, also where that fails. */
TETCAST_API TetcastStatus tetcast_image_end(TetcastImage **image);

/* Frees an image without a trace of its file, and sets *image to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_image_destroy(TetcastImage **image);

/* A deep picture: of each pixel's ray the light of parts that follow each other, so that other deep pictures can be
 * composited into it. It is plain memory of the caller's. The parts are equally long: part i of n goes from the
 * distance begin + (end − begin) i/n to begin + (end − begin) (i + 1)/n, and what is in it counts as spread evenly, as
 * OpenEXR has it for a sample with two depths. */
typedef struct TetcastDeep {
  /* The number of pixels in a row, in [1, 2^20]. */
  int64_t width;
  /* The number of rows, in [1, 2^20]. */
  int64_t height;
  /* The number of parts, above 0. */
  int layer_count;
  /* [layer_count][height][width][4]: red, green, blue and alpha of each part by itself, premultiplied, rows from the
   * top: what tetcast_scene_render() makes with the part's ends as `start` and `stop` of its desc. */
  const float *const *layers;
  /* [height][width]: the distance at which the first part begins, as TetcastRenderDesc.start has it. */
  const double *begin;
  /* [height][width]: the distance at which the last part ends, at least that of `begin`. */
  const double *end;
} TetcastDeep;

/* Writes a deep picture to an .exr file, with the channels R, G, B, A, Z and ZBack. Each pixel has a sample for each of
 * its parts that shows anything. Composited front to back, they give the whole picture. `pixel_type`: of R, G, B and A,
 * TETCAST_PIXEL_HALF, or float with TETCAST_PIXEL_FLOAT and TETCAST_PIXEL_DEFAULT; others, other formats and missing
 * arrays are TETCAST_ERROR_ARGUMENT. The rest is as with tetcast_image_write(). */
TETCAST_API TetcastStatus tetcast_image_write_deep(TetcastContext *context, const char *path, const TetcastDeep *deep,
                                                   TetcastPixelType pixel_type);

/* Checks whether `path` could be written with `desc` (NULL: default): that its extension is known, that the format can
 * hold the pixel type, and that its folder exists and can be written to. To be asked before long work; messages are
 * those of writing. */
TETCAST_API TetcastStatus tetcast_image_check(TetcastContext *context, const char *path, const TetcastImageDesc *desc);

/* Reads the distances at which a picture's rays stop (TetcastRenderDesc.stop) into `depth` [height][width], rows from
 * the top: of an image with floating-point pixels, such as .exr and .tif, the channel named Z, else the first whose
 * name ends with .Z, else the only or the first one, with a warning if it is one of several. What has no such pixels,
 * is deep, or has another size: TETCAST_ERROR_DATA; what can't be read: TETCAST_ERROR_IO. Numbers are handed on as they
 * are, NaN and infinity among them. */
TETCAST_API TetcastStatus tetcast_image_read_depth(TetcastContext *context, const char *path, int64_t width,
                                                   int64_t height, double *depth);

#ifdef __cplusplus
}
#endif

#endif
