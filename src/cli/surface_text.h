/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces and lights as options have them. */
#ifndef TETCAST_CLI_SURFACE_TEXT_H
#define TETCAST_CLI_SURFACE_TEXT_H

#include <stdbool.h>

#include <tetcast/isosurface.h>
#include <tetcast/shading.h>

/* An isosurface as --isosurface has it, VALUE[:COLOUR][:OPACITY]; *colored: it has a colour. False: it is none. */
bool surfaces_parse(const char *text, TetcastIsosurface *isosurface, bool *colored);

/* A light as --light has it, x,y,z[:COLOUR]. False: it is none. */
bool surfaces_parse_light(const char *text, TetcastLight *light);

#endif
