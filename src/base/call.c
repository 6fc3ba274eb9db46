/* SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* signal masks, the clock */
#include "base/call.h"

#include <signal.h>
#include <time.h>

/* As much as threads of TBB have, on which Embree builds: by that it decides how deep tasks may nest. */
enum { STACK = 4 << 20 };

/* What the host is asked to do, by a thread of ours. */
typedef struct Request {
  TcHostFunction *function;
  void *data;
  bool answer;
} Request;

struct TcCall {
  TcBody *body;
  void *data;
  TetcastStatus status;
  TetcastProgress progress; /* the host's */
  double reported;          /* fraction */
  struct timespec when;     /* it was */
  pthread_mutex_t mutex;
  pthread_cond_t asked, answered;
  Request *request; /* NULL: none is waiting */
  bool done;
};

/* Of this thread. */
static _Thread_local struct {
  TcEntry *entry; /* of the library, into which the host's thread has gone */
  TcCall *call;   /* for which a thread of our own works */
  bool alone;
} here;

TcCall *tc_call_here(void) {
  return here.call;
}
bool tc_call_alone(void) {
  return here.alone;
}

void tc_enter(TcEntry *entry) {
  tc_floating_begin(&entry->host);
  entry->before = here.entry;
  here.entry = entry;
}

void tc_leave(TcEntry *entry) {
  here.entry = entry->before;
  tc_floating_end(&entry->host);
}

/* ── the host's functions ── */

/* On the host's thread, in its own environment, to which it may do what it likes. */
static void serve(Request *request) {
  TcEntry *entry = here.entry;
  if (entry)
    tc_floating_end(&entry->host);
  request->answer = request->function(request->data);
  if (entry)
    tc_floating_begin(&entry->host);
}

static void ask(Request *request) {
  TcCall *call = here.call;
  if (!call) {
    serve(request);
    return;
  }
  pthread_mutex_lock(&call->mutex);
  while (call->request)
    pthread_cond_wait(&call->answered, &call->mutex);
  call->request = request;
  pthread_cond_signal(&call->asked);
  while (call->request == request)
    pthread_cond_wait(&call->answered, &call->mutex);
  pthread_mutex_unlock(&call->mutex);
}

bool tc_call_host(TcHostFunction *function, void *data) {
  Request request = {.function = function, .data = data};
  ask(&request);
  return request.answer;
}

typedef struct Message {
  TetcastContext *context;
  TetcastSeverity severity;
  const char *text;
} Message;

static bool send(void *data) {
  const Message *message = data;
  message->context->message(message->context->message_user, message->severity, message->text);
  return true;
}

void tc_call_message(TetcastContext *context, TetcastSeverity severity, const char *text) {
  if (context->message)
    tc_call_host(send, &(Message){context, severity, text});
}

typedef struct Report {
  const TetcastProgress *progress; /* the host's */
  double fraction;
} Report;

static bool tell(void *data) {
  const Report *report = data;
  return report->progress->function(report->progress->user, report->fraction);
}

/* Each time costs two changes of thread: a thousand times a call is often enough. A call that takes less than a second,
 * as one of many, has no time for that: once a millisecond is often enough, too, but each tenth is told, and the end.
 */
static bool report(void *user, double fraction) {
  TcCall *call = user;
  if (fraction < call->reported + 0.001)
    return true;
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double passed = difftime(now.tv_sec, call->when.tv_sec) + 1e-9 * (double)(now.tv_nsec - call->when.tv_nsec);
  if (call->reported >= 0 && fraction < 1 && fraction < call->reported + 0.1 && passed < 1e-3)
    return true;
  call->reported = fraction;
  call->when = now;
  return tc_call_host(tell, &(Report){&call->progress, fraction});
}

/* ── threads ── */

static void *thread_main(void *argument) {
  const TcThread *thread = argument;
  TcFloating inherited;
  tc_floating_begin(&inherited);
  here.call = thread->call;
  thread->function(thread->data);
  return NULL;
}

bool tc_thread_start(TcThread *thread, TcThreadFunction *function, void *data, TcCall *call) {
  *thread = (TcThread){.function = function, .data = data, .call = call};
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0)
    return false;
  pthread_attr_setstacksize(&attributes, STACK);
  sigset_t others, former;
  sigfillset(&others);
  static const int own[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT, SIGSYS};
  for (size_t i = 0; i < sizeof own / sizeof *own; ++i)
    sigdelset(&others, own[i]);
  pthread_sigmask(SIG_BLOCK, &others, &former);
  const bool started = pthread_create(&thread->thread, &attributes, thread_main, thread) == 0;
  pthread_sigmask(SIG_SETMASK, &former, NULL);
  pthread_attr_destroy(&attributes);
  return started;
}

void tc_thread_join(TcThread *thread) {
  pthread_join(thread->thread, NULL);
}

/* ── a call ── */

static void work(void *data) {
  TcCall *call = data;
  call->status = call->body(call->data);
  pthread_mutex_lock(&call->mutex);
  call->done = true;
  pthread_cond_signal(&call->asked);
  pthread_mutex_unlock(&call->mutex);
}

static void attend(TcCall *call) {
  pthread_mutex_lock(&call->mutex);
  while (!call->done) {
    Request *request = call->request;
    if (!request) {
      pthread_cond_wait(&call->asked, &call->mutex);
      continue;
    }
    pthread_mutex_unlock(&call->mutex);
    serve(request);
    pthread_mutex_lock(&call->mutex);
    call->request = NULL;
    pthread_cond_broadcast(&call->answered);
  }
  pthread_mutex_unlock(&call->mutex);
}

TetcastStatus tc_call(TcBody *body, void *data, TetcastProgress *progress) {
  TcCall call = {.body = body,
                 .data = data,
                 .reported = -1,
                 .mutex = PTHREAD_MUTEX_INITIALIZER,
                 .asked = PTHREAD_COND_INITIALIZER,
                 .answered = PTHREAD_COND_INITIALIZER};
  if (progress && progress->function) {
    call.progress = *progress;
    *progress = (TetcastProgress){report, &call};
  }
  TcThread thread;
  if (!tc_thread_start(&thread, work, &call, &call)) {
    const bool before = here.alone;
    here.alone = true;
    call.status = body(data);
    here.alone = before;
    return call.status;
  }
  int former;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &former); /* what the thread works on is here, on this stack */
  attend(&call);
  tc_thread_join(&thread);
  pthread_setcancelstate(former, &former);
  pthread_cond_destroy(&call.answered);
  pthread_cond_destroy(&call.asked);
  pthread_mutex_destroy(&call.mutex);
  return call.status;
}
