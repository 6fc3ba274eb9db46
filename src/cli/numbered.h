/* SPDX-License-Identifier: Apache-2.0 */
/* Files whose names differ in one number, as simulations number what they write step by step. */
#ifndef TETCAST_CLI_NUMBERED_H
#define TETCAST_CLI_NUMBERED_H

#include <stdbool.h>

/* Sorts such paths by their numbers: step_2.vtu before step_10.vtu, flow_0.25.vtu before flow_0.5.vtu. False, and
 * nothing changed, if they differ in anything else, or two are the same. */
bool numbered_sort(char **paths, int count);

#endif
