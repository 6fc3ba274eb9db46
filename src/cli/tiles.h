/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures beyond memory: made and written in bands of rows. */
#ifndef TETCAST_CLI_TILES_H
#define TETCAST_CLI_TILES_H

#include "picture.h"

/* What can't be with --tiles; NULL: nothing. */
const char *tiles_fault(const RenderOptions *options);

/* Renders the picture of a scene that is ready, and writes it. An exit code. */
int tiles_perform(Run *run);

#endif
