/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_BASE_PARALLEL_H
#define TC_BASE_PARALLEL_H

#include "base/base.h"

/* Works on [begin, end); `worker` in [0, tc_context_threads()) is the same for all that one thread does. False stops
 * the loop. */
typedef bool TcTask(void *data, int64_t begin, int64_t end, int worker);

/* Runs the task over [0, count) in pieces of `grain`, the calling thread among the workers. Threads that can't be
 * started are done without: the work is done all the same. `progress` (may be NULL) is called from the calling thread.
 * TETCAST_OK; TETCAST_ERROR_CANCELLED when the progress callback or a task said stop (a task reports why itself). */
TetcastStatus tc_parallel_for(TetcastContext *context, int64_t count, int64_t grain, TcTask *task, void *data,
                              const TetcastProgress *progress);

#endif
