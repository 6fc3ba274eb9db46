/* SPDX-License-Identifier: Apache-2.0 */
/* A slow ray caster to check the library by: in extended precision, every ray against every tetrahedron. */
#ifndef TETCAST_CLI_BRUTE_H
#define TETCAST_CLI_BRUTE_H

#include <tetcast/tetcast.h>

/* What a ray has of one cell: arc lengths and the scalar there. */
typedef struct BruteSpan {
  long double t[2], s[2];
  int64_t vertices[4]; /* in order */
} BruteSpan;

typedef struct BruteRay {
  int64_t pixel; /* row by row, from the top */
  int count, capacity;
  BruteSpan *spans; /* along the ray */
} BruteRay;

typedef struct Brute {
  int count;
  BruteRay *rays;
} Brute;

/* Finds the spans of one ray through the middle of each of `count` pixels. TETCAST_ERROR_CANCELLED if `progress` says
 * so.
 */
TetcastStatus brute_trace(Brute *brute, const TetcastMesh *mesh, const TetcastField *field, const TetcastCamera *camera,
                          int64_t width, int64_t height, const int64_t *pixels, int count, TetcastProgress progress);

/* Premultiplied colour and opacity of a ray. */
void brute_shade(const BruteRay *ray, const TetcastTransferFunction *transfer_function, long double rgba[4]);

void brute_release(Brute *brute);

#endif
