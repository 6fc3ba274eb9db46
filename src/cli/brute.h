/* SPDX-License-Identifier: Apache-2.0 */
/* A slow ray caster to check the library by: in extended precision, every ray against every tetrahedron. It knows when
 * it doesn't know: where a ray lies in a face of two cells, or so near that rounding decides, both cells or neither may
 * take it for theirs. So each ray is cast once as it is and four times beside, by so little as a renderer in double
 * precision may be off. Where those four agree, that is the light; where they differ, as along a silhouette or between
 * cells of different values, no answer is right. */
#ifndef TETCAST_CLI_BRUTE_H
#define TETCAST_CLI_BRUTE_H

#include <stdbool.h>

#include <tetcast/tetcast.h>

/* What a ray has of one cell: arc lengths and the scalar there. */
typedef struct BruteSpan {
  long double t[2], s[2];
  int64_t vertices[4]; /* in order */
} BruteSpan;

typedef struct BruteSpans {
  int count, capacity;
  BruteSpan *spans; /* along the ray */
} BruteSpans;

enum { BRUTE_RAYS = 5 }; /* the ray itself and four beside it */

typedef struct BruteRay {
  int64_t pixel; /* row by row, from the top */
  BruteSpans cast[BRUTE_RAYS];
} BruteRay;

/* Finds the spans of the ray through the middle of a pixel, as far as it lies in the half-spaces. */
void brute_trace(BruteRay *ray, const TetcastMesh *mesh, const TetcastField *field, const TetcastHalfSpace *half_spaces,
                 int half_space_count, const TetcastCamera *camera, int64_t width, int64_t height, int64_t pixel);

/* What is known of a ray's premultiplied colour and opacity: each lies between two numbers. */
typedef struct BruteLight {
  long double low[4], high[4];
  bool beside; /* the ray itself does not go with those beside it, which state the bounds; else it does, and both are
                  its light */
  long double spread; /* how much those beside it differ */
} BruteLight;

void brute_shade(const BruteRay *ray, const TetcastTransferFunction *transfer_function, BruteLight *light);

/* How far a pixel's largest error is at least. */
double brute_error(const BruteLight *light, const double rgba[4]);

void brute_release(BruteRay *ray);

#endif
