/* SPDX-License-Identifier: Apache-2.0 */
/* The simplest picture file there is, so that the examples need no library for it. */
#ifndef EXAMPLES_PPM_H
#define EXAMPLES_PPM_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <tetcast/frame.h>

/* Writes a frame over a grey background as binary PPM. Returns 0, or −1 when the file can't be written. */
static inline int ppm_write(const char *path, const TetcastFrame *frame, double background) {
  const int64_t width = tetcast_frame_width(frame), height = tetcast_frame_height(frame);
  const double color[4] = {background, background, background, 1};
  const size_t size = (size_t)(3 * width * height);
  unsigned char *bytes = malloc(size);
  FILE *file = bytes && tetcast_frame_bytes(frame, color, 3, bytes, 0) == TETCAST_OK ? fopen(path, "wb") : NULL;
  int bad = !file;
  if (file) {
    fprintf(file, "P6\n%lld %lld\n255\n", (long long)width, (long long)height);
    bad = fwrite(bytes, 1, size, file) != size;
    bad = fclose(file) || bad;
  }
  free(bytes);
  return bad ? -1 : 0;
}

#endif
