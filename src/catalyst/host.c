/* SPDX-License-Identifier: Apache-2.0 */
#include "host.h"

#include <dlfcn.h>
#include <errno.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "cli/cli.h"
#include "cli/loading.h"
#include "cli/progress.h"

/* ── the calling thread ── */

typedef struct HostState {
  fenv_t environment;
  locale_t own, before;
  int error;
  sigset_t mask, pending;
} HostState;

/* A file too large and a pipe that nobody reads are errors of writing like any other, and end no process. */
static void blocked_signals(sigset_t *set) {
  sigemptyset(set);
  sigaddset(set, SIGXFSZ);
  sigaddset(set, SIGPIPE);
}

static void enter(HostState *state) {
  sigset_t blocked;
  state->error = errno;
  fegetenv(&state->environment);
  fesetenv(FE_DFL_ENV);
  state->own = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  state->before = state->own ? uselocale(state->own) : (locale_t)0;
  blocked_signals(&blocked);
  sigpending(&state->pending);
  pthread_sigmask(SIG_BLOCK, &blocked, &state->mask);
}

static void leave(const HostState *state) {
  sigset_t pending, blocked;
  blocked_signals(&blocked);
  sigpending(&pending);
  static const int signals[] = {SIGXFSZ, SIGPIPE};
  for (int i = 0; i < 2; i++) { /* those that came of what was done here */
    sigset_t one;
    sigemptyset(&one);
    sigaddset(&one, signals[i]);
    if (sigismember(&pending, signals[i]) && !sigismember(&state->pending, signals[i]))
      sigtimedwait(&one, NULL, &(struct timespec){0, 0});
  }
  pthread_sigmask(SIG_SETMASK, &state->mask, NULL);
  if (state->own) {
    uselocale(state->before);
    freelocale(state->own);
  }
  fesetenv(&state->environment);
  errno = state->error;
}

/* ── memory ── */

static jmp_buf way_out;
static bool inside;
static pthread_t caller;

void cli_out_of_memory(void) {
  fputs("tetcast: error: out of memory: no further pictures are made\n", stderr);
  if (!inside || !pthread_equal(caller, pthread_self()))
    abort(); /* never: memory is only asked for within calls, on their thread */
  longjmp(way_out, 1);
}

int host_call(int (*work)(void *), void *argument) {
  HostState state;
  enter(&state);
  volatile int code = -1;
  caller = pthread_self();
  inside = true;
  if (setjmp(way_out) == 0)
    code = work(argument);
  inside = false;
  leave(&state);
  return code;
}

/* ── what the command has of its own ── */

enum { THREADS = 8 }; /* more than the libraries that are loaded start for themselves */

static void *wait_for(void *lock) {
  pthread_mutex_lock(lock);
  pthread_mutex_unlock(lock);
  return NULL;
}

/* Whether so many threads can be started. */
static bool can_start(void) {
  static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
  pthread_t threads[THREADS];
  int count = 0;
  pthread_mutex_lock(&lock);
  while (count < THREADS && pthread_create(&threads[count], NULL, wait_for, &lock) == 0)
    count++;
  pthread_mutex_unlock(&lock);
  for (int i = 0; i < count; i++)
    pthread_join(threads[i], NULL);
  return count == THREADS;
}

/* OpenImageIO is linked with OpenVDB, and that with a logger that starts threads when it is loaded, and ends the
 * process if it can't (cli/loading.c). They take no signals of the host's. */
void *cli_load_library(const char *path) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const bool fine = can_start();
  void *library = fine ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (!fine)
    cli_error("'%s' can't be loaded, as no further threads can be started", path);
  return library;
}

/* Signals are the host's. */
void cli_interrupt_catch(void) {}

void cli_interrupt_hold(bool hold) {
  (void)hold;
}

int cli_interrupted(void) {
  return 0;
}

/* No bar is drawn on the host's terminal. */
TetcastProgress cli_progress(const char *label) {
  (void)label;
  return (TetcastProgress){.function = NULL};
}

void cli_progress_part(const char *label, double begin, double end) {
  (void)label, (void)begin, (void)end;
}

bool cli_progress_show(double fraction) {
  (void)fraction;
  return true;
}

void cli_progress_clear(void) {}
