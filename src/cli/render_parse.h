/* SPDX-License-Identifier: Apache-2.0 */
/* The command line of the commands that render. */
#ifndef TETCAST_CLI_RENDER_PARSE_H
#define TETCAST_CLI_RENDER_PARSE_H

#include "render_options.h"

/* Reads the command line and the scene file it names. -1 to go on, else the exit code. */
int render_options_parse(RenderOptions *options, int argc, char **argv);

/* What is wrong with options that are in order one by one, for free(); NULL: nothing. */
char *render_options_fault(const RenderOptions *options);

extern const char render_help[], converge_help[], transfer_help[], cast_help[];

#endif
