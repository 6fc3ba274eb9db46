/* SPDX-License-Identifier: Apache-2.0 */
/* A picture of each time step. */
#ifndef TETCAST_CLI_SERIES_H
#define TETCAST_CLI_SERIES_H

#include "picture.h"

/* Whether the options are about more than one step, or one as it is among the others. */
bool series_wanted(const RenderOptions *options);

/* The name of a step's picture, for free(): that of the output, with the step's number where it has a place for it. */
char *series_name(const RenderOptions *options, int64_t step);

/* Renders the steps, after which only what the run itself holds is left to be freed. An exit code. */
int series_perform(Run *run);

#endif
