/* SPDX-License-Identifier: Apache-2.0 */
/* What changes the state of a kernel's loop, as bits of a mask that is a constant wherever kernels use it: a scene's
 * kernel has no instruction for what the scene does not need. */
#ifndef TC_WALK_FEATURES_H
#define TC_WALK_FEATURES_H

enum {
  TC_COLORED = 1 << 0,  /* colours differ; without, all that is seen has one colour, and depth alone is integrated */
  TC_CELLS = 1 << 1,    /* the scalar is one of cells: constant in each */
  TC_CORNERS = 1 << 2,  /* the scalar is one of cells' corners: linear in each, and may jump from cell to cell */
  TC_SCALED = 1 << 3,   /* pieces of the transfer function have scales (transfer.h) */
  TC_BOUND = 1 << 4,    /* how far rounding may move a ray among the cells is measured along it (tolerance.h) */
  TC_WEIGHTS = 1 << 5,  /* barycentric weights of faces, for what is interpolated besides the scalar */
  TC_SURFACES = 1 << 6, /* isosurfaces lie between parts of the segments */
  TC_EVERY_FEATURE = TC_COLORED | TC_SCALED | TC_BOUND,

  /* The scalar's association, of which a kernel has one: none of these is a point field. */
  TC_ASSOCIATIONS = TC_CELLS | TC_CORNERS
};

#endif
