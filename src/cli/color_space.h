/* SPDX-License-Identifier: Apache-2.0 */
/* Colours between two colours, as VTK's colour transfer functions have them in each of their spaces. */
#ifndef TETCAST_CLI_COLOR_SPACE_H
#define TETCAST_CLI_COLOR_SPACE_H

typedef enum ColorSpace {
  COLOR_SPACE_RGB,
  COLOR_SPACE_HSV,      /* hue, saturation and value, each linear */
  COLOR_SPACE_HSV_WRAP, /* the hue goes the shorter way round */
  COLOR_SPACE_LAB,      /* CIE L*a*b*, white D65 */
  COLOR_SPACE_DIVERGING /* Msh with white between two saturated colours, by K. Moreland */
} ColorSpace;

/* The colour at t in [0, 1] between two colours with components in [0, 1]. */
void color_space_between(ColorSpace space, const double from[3], const double to[3], double t, double rgb[3]);

#endif
