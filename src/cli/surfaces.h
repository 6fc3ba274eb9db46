/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces and the light on them, from options to the scene. */
#ifndef TETCAST_CLI_SURFACES_H
#define TETCAST_CLI_SURFACES_H

#include <tetcast/scene.h>

#include "render_options.h"

/* An isosurface as --isosurface has it, VALUE[:COLOUR][:OPACITY]; *colored: it has a colour. False: it is none. */
bool surfaces_parse(const char *text, TetcastIsosurface *isosurface, bool *colored);

/* A light as --light has it, x,y,z[:COLOUR]. False: it is none. */
bool surfaces_parse_light(const char *text, TetcastLight *light);

/* Whether isosurfaces are all there is to see: no transfer function was given beside them. */
bool surfaces_alone(const RenderOptions *options);

/* Gives the scene its isosurfaces and light. Those without a colour of their own have that of `transfer_function`;
 * `range` is that of the field's values. */
TetcastStatus surfaces_set(TetcastScene *scene, const RenderOptions *options,
                           const TetcastTransferFunction *transfer_function, const double range[2]);

#endif
