/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces that rays meet between the parts of their segments, as kernels are given them. */
#ifndef TC_WALK_SURFACES_H
#define TC_WALK_SURFACES_H

#include <tetcast/isosurface.h>
#include <tetcast/slice.h>

#include "optics/light.h"
#include "volume/clip.h"
#include "volume/gradients.h"
#include "walk/screen.h"

typedef struct TcSurfaces {
  int count;
  const TetcastIsosurface *surface; /* [count], values ascending, as the field is stored */
  const TcGradients *smooth;        /* NULL: normals are those of cells */
  const TcLighting *lighting;       /* NULL: no light falls on them */
  const float *open;                /* [vertices][open_width], as tc_light_reflection() takes them; NULL: all is open */
  int open_width;
  int slice_count;
  TcHalfSpace slice[TETCAST_MAX_SLICES];
  double slice_opacity[TETCAST_MAX_SLICES];
  TetcastBoundary boundary; /* opacity 0: it is not seen */
  const TcView *view;       /* the picture's camera */
  double pixel;             /* the height of its pixels, in perspective at the depth 1 */
  bool depth;               /* the depth at which alpha exceeds one half is wanted */
  bool normal;              /* with `depth`: the normal of the surface that it lies at is wanted, too */
  double largest[3];        /* of all their colours, as they are seen */
} TcSurfaces;

#endif
