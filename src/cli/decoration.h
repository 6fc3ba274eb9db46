/* SPDX-License-Identifier: Apache-2.0 */
/* What is drawn round a picture for people who look at it: the box, the legend, the soft background. */
#ifndef TETCAST_CLI_DECORATION_H
#define TETCAST_CLI_DECORATION_H

#include <tetcast/image.h>

#include "stage.h"

/* What a legend is made of, for decoration_release(). */
typedef struct Decoration {
  TetcastLegend legend;
  double *colors, *places;
  char **labels;
} Decoration;

/* Makes the legend of what the stage shows, if there is to be one: else its colors stay NULL. */
void decoration_make(const Stage *stage, const RenderOptions *options, Decoration *decoration);

/* Draws the outline into a frame of the stage, if there is to be one; `desc` as it was rendered. */
TetcastStatus decoration_outline(const Stage *stage, const RenderOptions *options, const TetcastRenderDesc *desc,
                                 TetcastFrame *frame);

void decoration_release(Decoration *decoration);

#endif
