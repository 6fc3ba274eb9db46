/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces and the light on them, from options to the scene. */
#ifndef TETCAST_CLI_SURFACES_H
#define TETCAST_CLI_SURFACES_H

#include <tetcast/scene.h>

#include "render_options.h"

/* Gives the scene its isosurfaces and light. Those without a colour of their own have that of `transfer_function`;
 * `range` is that of the field's values. */
TetcastStatus surfaces_set(TetcastScene *scene, const RenderOptions *options,
                           const TetcastTransferFunction *transfer_function, const double range[2]);

#endif
