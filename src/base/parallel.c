/* SPDX-License-Identifier: Apache-2.0 */
#include "base/parallel.h"

#include "base/call.h"

/* Threads live for one loop: starting one costs some 20 µs, loops worth splitting take far longer, and a host
 * application finds no threads of ours between calls. (libgomp would end the process where a thread can't be started.)
 */

typedef struct Loop {
  TcTask *task;
  void *data;
  int64_t count, grain;
  atomic_llong next, done;
  atomic_bool stop;
  const TetcastProgress *progress;
} Loop;

typedef struct Worker {
  Loop *loop;
  int index;
  TcThread thread;
} Worker;

static void work(Loop *loop, int worker) {
  while (!atomic_load_explicit(&loop->stop, memory_order_relaxed)) {
    const int64_t begin = atomic_fetch_add_explicit(&loop->next, loop->grain, memory_order_relaxed);
    if (begin >= loop->count)
      break;
    const int64_t end = loop->count - begin < loop->grain ? loop->count : begin + loop->grain;
    if (!loop->task(loop->data, begin, end, worker))
      atomic_store(&loop->stop, true);
    const int64_t done = atomic_fetch_add_explicit(&loop->done, end - begin, memory_order_relaxed) + end - begin;
    if (worker == 0 && loop->progress && loop->progress->function &&
        !loop->progress->function(loop->progress->user, (double)done / (double)loop->count)) {
      atomic_store(&loop->stop, true);
    }
  }
}

static void work_of_thread(void *data) {
  const Worker *worker = data;
  work(worker->loop, worker->index);
}

TetcastStatus tc_parallel_for(TetcastContext *context, int64_t count, int64_t grain, TcTask *task, void *data,
                              const TetcastProgress *progress) {
  Loop loop = {.task = task, .data = data, .count = count, .grain = grain < 1 ? 1 : grain, .progress = progress};
  atomic_init(&loop.next, 0);
  atomic_init(&loop.done, 0);
  atomic_init(&loop.stop, false);
  const int64_t pieces = (count + loop.grain - 1) / loop.grain;
  int threads = tc_call_alone() ? 1 : tc_context_threads(context);
  if (threads > pieces)
    threads = (int)pieces;
  Worker *workers = threads > 1 ? tc_allocate(context, threads, sizeof *workers) : NULL;
  int started = 1;
  while (workers && started < threads) {
    workers[started] = (Worker){.loop = &loop, .index = started};
    if (!tc_thread_start(&workers[started].thread, work_of_thread, &workers[started], tc_call_here()))
      break;
    ++started;
  }
  work(&loop, 0);
  for (int i = 1; i < started; ++i)
    tc_thread_join(&workers[i].thread);
  tc_release(context, workers);
  return atomic_load(&loop.stop) ? TETCAST_ERROR_CANCELLED : TETCAST_OK;
}
