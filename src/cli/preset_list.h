/* SPDX-License-Identifier: Apache-2.0 */
/* What presets there are. */
#ifndef TETCAST_CLI_PRESET_LIST_H
#define TETCAST_CLI_PRESET_LIST_H

#include "render_options.h"

/* Prints the names and kinds of all presets, or writes a picture of them where an output is given; the exit code. */
int preset_list(const RenderOptions *options);

#endif
