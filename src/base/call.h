/* SPDX-License-Identifier: Apache-2.0 */
/* How public functions run in a host application of which nothing is known.
 *
 * The calling thread may have any floating-point environment (floating.h) and a stack of any size. Callbacks may have
 * to be called on it and on no other, as interpreters need it. So work that takes long, or needs a deep stack, is done
 * on a thread of the library's own, whose stack and environment are known. Meanwhile the calling thread waits, and
 * calls the host's functions when it is asked to. Only if no thread can be started, the calling thread does the work
 * alone. */
#ifndef TC_BASE_CALL_H
#define TC_BASE_CALL_H

#include <pthread.h>

#include "base/base.h"
#include "base/floating.h"

/* A public function that has been entered: the environment of its caller. */
typedef struct TcEntry {
  TcFloating host;
  struct TcEntry *before; /* the function entered before on this thread, from which a callback has called this one */
} TcEntry;

void tc_enter(TcEntry *entry);
void tc_leave(TcEntry *entry);

/* The first line of every public function. */
#define TC_ENTRY                                                                                                       \
  TcEntry tc_entry __attribute__((cleanup(tc_leave)));                                                                 \
  tc_enter(&tc_entry)

typedef TetcastStatus TcBody(void *data);

/* Runs body(data) on a thread of the library's own. `progress`, which may be NULL, is what the body reports to; it is
 * replaced by a function that hands reports on to the calling thread. */
TetcastStatus tc_call(TcBody *body, void *data, TetcastProgress *progress);

/* Calls a function that calls one of the host's, on the thread that made the call and in its own floating-point
 * environment, and returns what it returns. */
typedef bool TcHostFunction(void *data);
bool tc_call_host(TcHostFunction *function, void *data);

/* Calls the host's function for messages. */
void tc_call_message(TetcastContext *context, TetcastSeverity severity, const char *text);

/* ── threads of the library's own ── */

/* What a thread has to know of the call that it works for. NULL if it works for none. */
typedef struct TcCall TcCall;
TcCall *tc_call_here(void);
/* Whether the call has to do without further threads, as its own could not be started. */
bool tc_call_alone(void);

typedef void TcThreadFunction(void *data);
typedef struct TcThread {
  TcThreadFunction *function;
  void *data;
  TcCall *call;
  pthread_t thread;
} TcThread;

/* Starts function(data) on a thread with the default floating-point environment, 4 MiB of stack and no signals but
 * those that a thread causes itself. False if the system can't start one. *thread must stay where it is until
 * tc_thread_join(). */
bool tc_thread_start(TcThread *thread, TcThreadFunction *function, void *data, TcCall *call);
void tc_thread_join(TcThread *thread);

#endif
