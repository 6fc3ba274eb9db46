/* SPDX-License-Identifier: Apache-2.0 */
/* Integrals of reference in extended precision. They share nothing with the library, which is judged by them. */
#ifndef TETCAST_CLI_QUADRATURE_H
#define TETCAST_CLI_QUADRATURE_H

#include <stdint.h>

#include <tetcast/camera.h>

enum { QUADRATURE_NODES = 8 };

/* Gauss-Legendre on [0, 1]: exact for polynomials up to degree 15. */
typedef struct Quadrature {
  long double node[QUADRATURE_NODES], weight[QUADRATURE_NODES];
} Quadrature;

const Quadrature *quadrature(void);

/* The ray through the middle of pixel (i, j), as camera.h states it; the direction has length 1. */
typedef struct ReferenceRay {
  long double origin[3], direction[3];
} ReferenceRay;

ReferenceRay reference_ray(const TetcastCamera *camera, int64_t width, int64_t height, int64_t i, int64_t j);

#endif
