/* SPDX-License-Identifier: Apache-2.0 */
#include "progress.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli.h"

static atomic_int held, caught;

static struct {
  const char *label;
  double started, drawn;
  double begin, end; /* where the part begins and ends, while `whole` */
  bool visible, whole;
} bar = {.end = 1};

/* Does it once: a signal may come to one thread while another one ends the process. */
static void end(int signal_number) {
  static atomic_flag ending = ATOMIC_FLAG_INIT;
  if (atomic_flag_test_and_set(&ending))
    return;
  static const char text[] = "\r\033[Ktetcast: error: interrupted\n";
  const size_t skip = bar.visible ? 0 : 4; /* a bar is removed */
  if (cli_rank() == 0) {
    const ssize_t ignored = write(STDERR_FILENO, text + skip, sizeof text - 1 - skip);
    (void)ignored;
  }
  _exit(128 + signal_number);
}

static void handle(int signal_number) {
  atomic_store(&caught, signal_number); /* before looking: another thread may be about to let go */
  if (atomic_load(&held) == 0)
    end(signal_number);
}

void cli_out_of_memory(void) {
  fputs("tetcast: error: out of memory\n", stderr);
  exit(CLI_FAILED);
}

void cli_interrupt_catch(void) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
    struct sigaction former;
    sigaction(signals[i], NULL, &former);
    if (former.sa_handler != SIG_IGN) /* nohup, background jobs */
      sigaction(signals[i], &action, NULL);
  }
  action.sa_handler = SIG_IGN; /* a file too large and a pipe that nobody reads are errors of writing like any other */
  sigaction(SIGXFSZ, &action, NULL);
  sigaction(SIGPIPE, &action, NULL);
  action.sa_handler = SIG_DFL; /* ignored, as some parents leave it, no child could be waited for */
  sigaction(SIGCHLD, &action, NULL);
}

void cli_interrupt_hold(bool hold) {
  if (hold)
    atomic_fetch_add(&held, 1);
  else if (atomic_fetch_sub(&held, 1) == 1 && atomic_load(&caught))
    end(atomic_load(&caught));
}

int cli_interrupted(void) {
  return atomic_load(&caught);
}

enum { BAR_WIDTH = 40 };

bool cli_progress_show(double fraction) {
  const double now = cli_seconds();
  fraction = bar.begin + (bar.end - bar.begin) * fraction;
  if (bar.label && now - bar.started > 1 && now - bar.drawn > 0.1) {
    char cells[BAR_WIDTH + 1];
    const int filled = (int)(BAR_WIDTH * (fraction > 1 ? 1 : fraction < 0 ? 0 : fraction));
    memset(cells, ' ', BAR_WIDTH);
    memset(cells, '#', (size_t)filled);
    cells[BAR_WIDTH] = '\0';
    fprintf(stderr, "\r%-10s [%s] %3d %%", bar.label, cells, (int)(100 * fraction));
    const double left = fraction > 0 ? (now - bar.started) / fraction * (1 - fraction) : 0;
    if (bar.whole && left > 0) /* of work that takes long; what was longer before is removed */
      fprintf(stderr, left < 100 ? ", %.0f s left\033[K" : ", %.0f min left\033[K", left < 100 ? left : left / 60);
    bar.drawn = now;
    bar.visible = true;
  }
  return atomic_load(&caught) == 0;
}

static bool advance(void *user, double fraction) {
  (void)user;
  return cli_progress_show(fraction);
}

static void begin_bar(const char *label) {
  bar.label = !cli_quiet() && cli_rank() == 0 && isatty(STDERR_FILENO) ? label : NULL;
  bar.started = cli_seconds();
  bar.drawn = 0;
}

TetcastProgress cli_progress(const char *label) {
  if (!bar.whole)
    begin_bar(label);
  return (TetcastProgress){.function = advance, .user = NULL};
}

void cli_progress_part(const char *label, double begin, double end) {
  if (label && bar.label != label)
    begin_bar(label);
  bar.whole = label != NULL;
  bar.begin = label ? begin : 0;
  bar.end = label ? end : 1;
}

void cli_progress_clear(void) {
  if (!bar.visible)
    return;
  fputs("\r\033[K", stderr);
  bar.visible = false;
}
