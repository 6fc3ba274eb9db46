/* SPDX-License-Identifier: Apache-2.0 */
/* What --preset says: a name, or a file of ParaView's. */
#ifndef TETCAST_CLI_PRESET_NAME_H
#define TETCAST_CLI_PRESET_NAME_H

#include <stdbool.h>

/* Whether a preset is a file: FILE or FILE:NAME, where FILE ends with .json or .xml. */
bool preset_name_is_file(const char *preset);

/* FILE without :NAME, for free(). */
char *preset_name_path(const char *preset);

#endif
