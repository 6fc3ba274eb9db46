/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_GNUPLOT_H
#define TETCAST_CLI_GNUPLOT_H

#include <stdbool.h>

/* Whether gnuplot can be started. */
bool gnuplot_find(void);

/* Runs NAME.gp in a folder, which draws NAME.svg and NAME.png there. False after a message. */
bool gnuplot_draw(const char *folder, const char *name);

#endif
