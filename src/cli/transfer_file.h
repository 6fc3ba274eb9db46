/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_TRANSFER_FILE_H
#define TETCAST_CLI_TRANSFER_FILE_H

#include <tetcast/transfer_function.h>

#include "render_options.h"

/* The transfer function that the options state, from its file or the scene file; NULL after a message. */
TetcastTransferFunction *transfer_file_load(TetcastContext *context, const RenderOptions *options);

#endif
