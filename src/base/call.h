/* SPDX-License-Identifier: Apache-2.0 */
/* What becomes of a public call in a host that is not ours.
 *
 * Its thread may have any floating-point environment (floating.h) and a stack of any size, and may be one that
 * callbacks have to come from, as interpreters want it. So what takes long or deep stacks is done on a thread of the
 * library's own, whose stack and environment are known, while the caller's waits and, when asked to, calls the host's
 * functions. Only where no thread can be started the caller's does the work, alone. */
#ifndef TC_BASE_CALL_H
#define TC_BASE_CALL_H

#include <pthread.h>

#include "base/base.h"
#include "base/floating.h"

/* A public function that has been entered: the environment of its caller. */
typedef struct TcEntry {
  TcFloating host;
  struct TcEntry *before; /* entered before on this thread: a callback may call the library */
} TcEntry;

void tc_enter(TcEntry *entry);
void tc_leave(TcEntry *entry);

/* The first line of every public function. */
#define TC_ENTRY                                                                                                       \
  TcEntry tc_entry __attribute__((cleanup(tc_leave)));                                                                 \
  tc_enter(&tc_entry)

typedef TetcastStatus TcBody(void *data);

/* Does body(data) on a thread of the library's own. `progress`, which may be NULL, is what the body will report to: it
 * is replaced by what hands reports on to the calling thread. */
TetcastStatus tc_call(TcBody *body, void *data, TetcastProgress *progress);

/* Calls the host's function for messages, on the thread that made the call. */
void tc_call_message(TetcastContext *context, TetcastSeverity severity, const char *text);

/* ── threads of the library's own ── */

/* What a thread has to know of the call that it works for; NULL: nothing. */
typedef struct TcCall TcCall;
TcCall *tc_call_here(void);
/* Whether this call has to do without further threads: its own could not be started. */
bool tc_call_alone(void);

typedef void TcThreadFunction(void *data);
typedef struct TcThread {
  TcThreadFunction *function;
  void *data;
  TcCall *call;
  pthread_t thread;
} TcThread;

/* Starts function(data) on a thread with the default floating-point environment, 4 MiB of stack and no signals but
 * those that a thread causes itself. False: the system has no thread for us. *thread must stay where it is until
 * tc_thread_join(). */
bool tc_thread_start(TcThread *thread, TcThreadFunction *function, void *data, TcCall *call);
void tc_thread_join(TcThread *thread);

#endif
