/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces, as kernels are given them. */
#ifndef TC_VOLUME_SURFACES_H
#define TC_VOLUME_SURFACES_H

#include <tetcast/isosurface.h>

#include "optics/light.h"
#include "volume/gradients.h"

typedef struct TcSurfaces {
  int count;
  const TetcastIsosurface *surface; /* [count], values ascending, as the field is stored */
  const TcGradients *smooth;        /* NULL: normals are those of cells */
  const TcLighting *lighting;       /* NULL: no light falls on them */
  double largest[3];                /* of their colours, as they are seen */
} TcSurfaces;

#endif
