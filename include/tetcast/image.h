/* SPDX-License-Identifier: Apache-2.0 */
/* Writing images, and reading depths, through OpenImageIO: target tetcast::openimageio, library libtetcast-openimageio.
 */
#ifndef TETCAST_IMAGE_H
#define TETCAST_IMAGE_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/frame.h>
#include <tetcast/status.h>

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
