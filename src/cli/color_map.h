/* SPDX-License-Identifier: Apache-2.0 */
/* Colour maps and opacities of VTK's kinds as knots between which all is linear. Needs nothing else of the command. */
#ifndef TETCAST_CLI_COLOR_MAP_H
#define TETCAST_CLI_COLOR_MAP_H

#include "color_space.h"

/* Knots with a value and up to three numbers each, `width` altogether, one behind the other; for color_map_release().
 */
typedef struct ColorMapKnots {
  double *data; /* NULL: there was no memory */
  int count, capacity, width;
} ColorMapKnots;

void color_map_release(ColorMapKnots *knots);

/* Colours at points [count][4], count ≥ 1, each a value, which are ascending, no more than two of them equal, and red,
 * green and blue in [0, 1]; off by at most 1e-3. */
ColorMapKnots color_map_colors(ColorSpace space, const double *points, int count);

/* The same in steps: between two points the colour of the second. */
ColorMapKnots color_map_steps(const double *points, int count);

/* Opacities at points [count][4], count ≥ 1, each a value, as above, an opacity in [0, 1], and the midpoint and the
 * sharpness of the way to the next, in [0, 1] as vtkPiecewiseFunction has them; off by at most 1e-4 of the largest
 * opacity. */
ColorMapKnots color_map_opacities(const double *points, int count);

#endif
