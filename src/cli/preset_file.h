/* SPDX-License-Identifier: Apache-2.0 */
/* Colour maps in files of ParaView's. */
#ifndef TETCAST_CLI_PRESET_FILE_H
#define TETCAST_CLI_PRESET_FILE_H

#include <tetcast/transfer_function.h>

/* The colour map of FILE or FILE:NAME over [0, 1], with extinctions of which only the proportions count; NULL after a
 * message. */
TetcastTransferFunction *preset_file_load(TetcastContext *context, const char *preset);

#endif
