/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces, slices, the mesh's boundary and the light on them, from options to the scene. */
#ifndef TETCAST_CLI_SURFACES_H
#define TETCAST_CLI_SURFACES_H

#include <tetcast/scene.h>

#include "render_options.h"

/* Gives the scene a transfer function with the colours of this one, by which nothing of the volume is seen. */
TetcastStatus surfaces_set_colors(TetcastContext *context, TetcastScene *scene,
                                  const TetcastTransferFunction *transfer_function);

/* Gives the scene its surfaces, and the light on these and in the volume. Isosurfaces without a colour of their own
 * have that of `transfer_function`; `range` is that of the field's values. */
TetcastStatus surfaces_set(TetcastScene *scene, const RenderOptions *options,
                           const TetcastTransferFunction *transfer_function, const double range[2]);

/* Whether anything has the colours that stand for values: not where each surface has one of its own, and there is
 * nothing else. */
bool surfaces_show_values(const RenderOptions *options);

/* The colour of the outline that the options say: black, or white on a dark background, unless they have a colour. */
void surfaces_outline(const RenderOptions *options, double color[3]);

#endif
