/* SPDX-License-Identifier: Apache-2.0 */
/* A picture of each step of a running simulation. */
#ifndef TETCAST_CATALYST_STEPS_H
#define TETCAST_CATALYST_STEPS_H

#include "conduit.h"

/* Catalyst's own codes are below 100. */
enum { STEPS_DONE = 0, STEPS_INVALID = 100, STEPS_FAILED = 102 };

/* Each returns one of these codes, after a message if it is not STEPS_DONE. */
int steps_begin(const ConduitNode *params);
int steps_execute(const ConduitNode *params);
int steps_end(void);

/* Writes what was made under catalyst/tetcast. */
void steps_results(ConduitNode *params);

#endif
