/* SPDX-License-Identifier: Apache-2.0 */
/* What a ray gathers, in the plainest way: one ray at a time, no vectors, no Embree, sums in extended precision. It is
 * what kernels are tested against. It has in common with them the prepared mesh (volume/volume.h), a field's rows, and
 * the integral over one segment (optics/segment.c, optics/transfer.c), which other tests hold to references of their
 * own. */
#ifndef PLAIN_H
#define PLAIN_H

#include <tetcast/blend.h>

#include "optics/transfer.h"
#include "volume/coefficients.h"
#include "walk/ray.h"
#include "walk/screen.h"

/* Light gathered along a ray, front to back. */
typedef struct PlainLight {
  long double color[3], depth;
} PlainLight;

/* Adds a segment of length ≥ 0 over which the scalar goes from s0 to s1, both finite. */
void plain_add(PlainLight *light, const TcPieces *pieces, double length, double s0, double s1);

/* Premultiplied red, green, blue, and alpha. */
void plain_end(const PlainLight *light, double rgba[4]);

/* What is looked at: either pieces and values, or coefficients, or values in a blend mode, or none of them, which gives
 * the length alone. */
typedef struct PlainScene {
  const TcShell *shell;
  const TcRows *values;
  const TcPieces *pieces; /* in the volume's units */
  const TcCoefficients *coefficients;
  TetcastBlend blend; /* other than composite: of values, without pieces or coefficients */
  /* Vertices as they were projected in double precision (walk/screen.h); NULL: in ray space. */
  const TcScreen *screen;
} PlainScene;

/* A ray; x and y are where it is on the screen, in its pixels from where the volume's centre is. */
typedef struct PlainRay {
  TcLine line;
  double x, y;
} PlainRay;

/* The ray of sample i of pixel (x, y); `screen` may be NULL. */
PlainRay plain_ray(const TcView *view, int64_t width, int64_t height, int samples_x, int samples_y, int64_t x,
                   int64_t y, int i, const TcScreen *screen);

typedef struct PlainResult {
  long double length; /* in cells, scaled */
  long double depth;  /* optical, with pieces */
  long double met;    /* of the length, in a blend mode: in cells that have values */
  int64_t segments;   /* cells crossed over a length > 0 */
  bool lost;
} PlainResult;

/* Writes to `sums` what a kernel gathers for the ray, but bounds on errors, which are left as they are: with pieces
 * red, green, blue, alpha; with coefficients what gather/coefficients.h says; in a blend mode what gather/value.h says;
 * else the length. */
PlainResult plain_cast(const PlainScene *scene, const PlainRay *ray, double *sums);

#endif
