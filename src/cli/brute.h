/* SPDX-License-Identifier: Apache-2.0 */
/* A slow ray caster to check the library by, which tests every ray against every tetrahedron in extended precision. If
 * a ray lies in a face of two cells, or so near to it that rounding decides, both cells or neither of them may count it
 * as their own. So each ray is cast once as it is, and four times moved aside by as little as a renderer in double
 * precision may be off. Where these four agree, their light is the ray's. Where they differ, as along a silhouette or
 * between cells of different values, no answer is right, and the ray is undecided. */
#ifndef TETCAST_CLI_BRUTE_H
#define TETCAST_CLI_BRUTE_H

#include <stdbool.h>

#include <tetcast/tetcast.h>

/* The part of a ray in one cell: arc lengths, and the scalar there. */
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

/* The light of a ray: each of premultiplied colour and opacity lies between two numbers. */
typedef struct BruteLight {
  long double low[4], high[4];
  /* Whether the ray differs from those beside it, so that the numbers are theirs; else they are its own as well. */
  bool beside;
  /* How much the rays beside it differ. */
  long double spread;
} BruteLight;

void brute_shade(const BruteRay *ray, const TetcastTransferFunction *transfer_function, BruteLight *light);

/* A lower bound on the largest error of a pixel's values. */
double brute_error(const BruteLight *light, const double rgba[4]);

void brute_release(BruteRay *ray);

#endif
