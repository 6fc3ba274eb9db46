/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces and lights as options have them. */
#ifndef TETCAST_CLI_SURFACE_TEXT_H
#define TETCAST_CLI_SURFACE_TEXT_H

#include <stdbool.h>

#include <tetcast/isosurface.h>
#include <tetcast/shading.h>
#include <tetcast/slice.h>

/* A colour: a name, #rrggbb, or three numbers r,g,b from 0 to 1. False: it is none. */
bool surfaces_parse_color(const char *text, double color[3]);

/* An isosurface as --isosurface has it, VALUE[:COLOUR][:OPACITY]; *colored: it has a colour. False: it is none. */
bool surfaces_parse(const char *text, TetcastIsosurface *isosurface, bool *colored);

/* A light as --light has it, x,y,z[:COLOUR]. False: it is none. */
bool surfaces_parse_light(const char *text, TetcastLight *light);

/* A slice as --slice has it, nx,ny,nz,d[:OPACITY]. False: it is none. */
bool surfaces_parse_slice(const char *text, TetcastSlice *slice);

/* The mesh's boundary as --surface has it, [COLOUR][:OPACITY] or OPACITY; "" is opaque, in the colours of the scalar.
 * False: it is something else. */
bool surfaces_parse_boundary(const char *text, TetcastBoundary *boundary);

#endif
