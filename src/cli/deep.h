/* SPDX-License-Identifier: Apache-2.0 */
/* Deep pictures: each ray's parts, one after the other. */
#ifndef TETCAST_CLI_DEEP_H
#define TETCAST_CLI_DEEP_H

#include <tetcast/image.h>
#include <tetcast/scene.h>

#include "render_options.h"
#include "stage.h"

typedef struct Deep {
  TetcastDeep image;
  float **layers;      /* [image.layer_count], each [height][width][4] */
  double *begin, *end; /* [height][width] */
} Deep;

/* Renders the parts of rays between equal distances, from where they enter the mesh's bounding box to where they leave
 * it or stop; `flat` is the whole picture, of floats, by `desc`. */
TetcastStatus deep_render(Deep *deep, const Stage *stage, const RenderOptions *options, const TetcastRenderDesc *desc,
                          const TetcastFrame *flat);

void deep_release(Deep *deep);

#endif
