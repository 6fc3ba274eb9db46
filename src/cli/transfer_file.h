/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_TRANSFER_FILE_H
#define TETCAST_CLI_TRANSFER_FILE_H

#include <tetcast/scene.h>

#include "render_options.h"

/* A transfer function of two dimensions. */
typedef struct TransferRows {
  TetcastTransferRow row[TETCAST_MAX_ROWS];
  int count;      /* 0: the transfer function has one dimension */
  char *second;   /* the cell array; NULL: the gradient's magnitude */
  json_t *source; /* what the file has, for scene files */
} TransferRows;

/* The transfer function that the options state, from its file or the scene file; NULL after a message. If it has two
 * dimensions, the result is that of the first row, and *rows has all, for transfer_file_release(). */
TetcastTransferFunction *transfer_file_load(TetcastContext *context, const RenderOptions *options, TransferRows *rows);

/* Frees all but the first row's transfer function. */
void transfer_file_release(TransferRows *rows);

#endif
