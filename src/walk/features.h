/* SPDX-License-Identifier: Apache-2.0 */
/* Features: what changes the code of a kernel's loop, as bits of a mask. The mask is a constant wherever kernels use
 * it, so that a kernel contains no instruction for a feature that it doesn't have. */
#ifndef TC_WALK_FEATURES_H
#define TC_WALK_FEATURES_H

enum {
  TC_COLORED = 1 << 0,  /* the transfer function has several colours; without, optical depth alone is gathered */
  TC_CELLS = 1 << 1,    /* the scalar has one value for each cell */
  TC_CORNERS = 1 << 2,  /* the scalar has one value for each corner of a cell, and may jump from cell to cell */
  TC_SCALED = 1 << 3,   /* pieces of the transfer function have scales (transfer.h) */
  TC_BOUND = 1 << 4,    /* a bound on the error is gathered (tolerance.h) */
  TC_WEIGHTS = 1 << 5,  /* barycentric weights are computed, for values that the gatherer interpolates */
  TC_SURFACES = 1 << 6, /* rays meet surfaces between the parts of their segments */
  TC_LIT = 1 << 7,      /* light falls on the volume: a colour times a factor that is linear in a cell */
  TC_TINTED = 1 << 8,   /* this factor differs between red, green and blue */
  TC_SECOND = 1 << 9,   /* the transfer function depends on a second quantity, too, which is constant in a cell */
  TC_PARTS = 1 << 10, /* a face of the shell has the same depth and scalar as in another part of the mesh that has it */
  TC_EVERY_FEATURE = TC_COLORED | TC_SCALED | TC_BOUND,

  /* The scalar's association: a kernel has one of these at most. With none of them, the scalar is one of points. */
  TC_ASSOCIATIONS = TC_CELLS | TC_CORNERS
};

#endif
