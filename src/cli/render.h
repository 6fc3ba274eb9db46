/* SPDX-License-Identifier: Apache-2.0 */
/* Steps of a run of tetcast render that another program takes, too, when it has its mesh in memory (src/catalyst). */
#ifndef TETCAST_CLI_RENDER_H
#define TETCAST_CLI_RENDER_H

#include "picture.h"

/* Chooses the background where none is given: black for radiance, and a soft one for people to look at. */
void render_choose_background(RenderOptions *options);

/* Loads the image library, and checks whether the picture can be written to its place and in its format. An exit code.
 */
int render_check_image(Run *run);

/* Frees all that a run holds. */
void render_release(Run *run);

#endif
