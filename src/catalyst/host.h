/* SPDX-License-Identifier: Apache-2.0 */
/* What this library leaves as it is in the process that has loaded it: floating-point environment, locale, errno and
 * signals of the calling thread. It takes the place of what the command does with a process of its own (cli/progress.h,
 * cli/loading.h). */
#ifndef TETCAST_CATALYST_HOST_H
#define TETCAST_CATALYST_HOST_H

#include <stdbool.h>

/* Does work(argument) in a plain environment, and gives back the host's. What work returns; or -1 where memory ran out
 * in the midst of it, after a message: nothing that it has made is to be touched then. */
int host_call(int (*work)(void *), void *argument);

#endif
