/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_TRANSFER_H
#define TETCAST_CLI_TRANSFER_H

#include "candidates.h"

/* Writes plots of the statistics, with the extinctions of a transfer function over them, to a folder: values.svg and
 * .png, and gradients.svg and .png where there are gradients. False after a message. */
bool transfer_plots(const char *folder, const char *title, const Candidates *candidates,
                    const TetcastTransferFunction *transfer_function);

/* The names of all files that these are, NULL at the end. */
extern const char *const transfer_plot_files[];

#endif
