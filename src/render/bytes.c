/* SPDX-License-Identifier: Apache-2.0 */
/* A frame as 8-bit numbers over a background. */
#include <math.h>

#include "base/parallel.h"
#include "render/render.h"

enum { GRAIN = 16 };

typedef struct Bytes {
  const TetcastFrame *frame;
  const double *background;
  int channels;
  unsigned char *to;
  int64_t row_stride;
} Bytes;

static unsigned char byte_of(double value) { /* NaN becomes 0 */
  return (unsigned char)(value > 0 ? floor(fmin(value, 1) * 255 + 0.5) : 0);
}

static bool convert_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Bytes *b = data;
  const bool opaque = b->background[3] >= 1;
  for (int64_t y = begin; y < end; ++y) {
    unsigned char *to = b->to + y * b->row_stride;
    for (int64_t x = 0; x < b->frame->width; ++x, to += b->channels) {
      double rgba[4];
      tc_frame_get(b->frame, x, y, rgba);
      const double behind = (1 - rgba[3]) * b->background[3], alpha = opaque ? 1 : rgba[3] + behind;
      const double scale = b->channels == 3 ? 1 : alpha > 0 ? 1 / alpha : 0;
      for (int k = 0; k < 3; ++k)
        to[k] = byte_of((rgba[k] + behind * b->background[k]) * scale);
      if (b->channels == 4)
        to[3] = byte_of(alpha);
    }
  }
  return true;
}

void tc_frame_bytes(const TetcastFrame *frame, const double background[4], int channels, unsigned char *bytes,
                    int64_t row_stride) {
  Bytes b = {frame, background, channels, bytes, row_stride ? row_stride : frame->width * channels};
  tc_parallel_for(frame->context, frame->height, GRAIN, convert_rows, &b, NULL);
}
