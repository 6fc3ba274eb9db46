/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a mesh folds over itself: whether some cell is turned inside out against a neighbour, so that the two lie on
 * the same side of the face that they share. */
#ifndef TC_VOLUME_FOLD_H
#define TC_VOLUME_FOLD_H

#include "mesh/adjacency.h"

/* Whether the cells of an adjacency, with links and vertices, fold. `positions` are x, y, z of each vertex, of
 * magnitude at most 1, in single or in double precision. Cells that are flat, or thinner than what rounding to single
 * precision moves vertices by, count as not turned. */
bool tc_adjacency_folds(const TcAdjacency *adjacency, const void *positions, bool positions_are_double);

#endif
