/* SPDX-License-Identifier: Apache-2.0 */
/* The simplest picture file there is, so that the examples need no library for it. */
#ifndef EXAMPLES_PPM_H
#define EXAMPLES_PPM_H

#include <stdint.h>
#include <stdio.h>

#include <tetcast/frame.h>

/* Writes a float64 frame over a grey background as binary PPM. The frame's colour is premultiplied by alpha: over an
 * opaque background it is simply added to what of that shines through. Returns 0, or −1 when the file can't be written.
 */
static inline int ppm_write(const char *path, const TetcastFrame *frame, double background) {
  int64_t width = tetcast_frame_width(frame), height = tetcast_frame_height(frame);
  FILE *file = fopen(path, "wb");
  if (!file) {
    return -1;
  }
  fprintf(file, "P6\n%lld %lld\n255\n", (long long)width, (long long)height);
  for (int64_t j = 0; j < height; j++) {
    const char *row = (const char *)tetcast_frame_pixels(frame) + j * tetcast_frame_row_stride(frame);
    for (int64_t i = 0; i < width; i++) {
      const double *rgba = (const double *)(const void *)row + 4 * i;
      for (int c = 0; c < 3; c++) {
        double value = rgba[c] + (1 - rgba[3]) * background;
        fputc((int)(255 * (value < 0 ? 0 : value > 1 ? 1 : value) + 0.5), file);
      }
    }
  }
  int bad = ferror(file);
  return fclose(file) || bad ? -1 : 0;
}

#endif
