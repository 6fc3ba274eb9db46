/* SPDX-License-Identifier: Apache-2.0 */
/* Long work: a progress bar, and an orderly end on Ctrl-C. */
#ifndef TETCAST_CLI_PROGRESS_H
#define TETCAST_CLI_PROGRESS_H

#include <stdbool.h>

#include <tetcast/context.h>

/* Catches SIGINT, SIGTERM and SIGHUP. They end the process at once, but between cli_interrupt_hold(true) and (false),
 * in any thread, they are remembered, for cli_interrupted() and the progress callback, so that temporary files are
 * removed first; the last (false) ends the process then. SIGPIPE is ignored, and SIGCHLD is not, whatever the parent
 * left. */
void cli_interrupt_catch(void);
void cli_interrupt_hold(bool hold);

/* The signal that came while held, 0: none. */
int cli_interrupted(void);

/* A callback that draws a bar labelled `label` (static storage) on stderr if that is a terminal, the work takes longer
 * than about a second and the command is not quiet, and that cancels the work after a signal. */
TetcastProgress cli_progress(const char *label);

/* Until this is called with NULL, all bars are the part from `begin` to `end` of one bar with this label, which stays
 * valid; it tells how long the rest takes if it goes on as before. */
void cli_progress_part(const char *label, double begin, double end);

/* Draws the bar of the last cli_progress(), for work of several calls with one bar. False after a signal. */
bool cli_progress_show(double fraction);

/* Removes the bar; messages do so before they print. */
void cli_progress_clear(void);

#endif
