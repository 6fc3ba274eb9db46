/* SPDX-License-Identifier: Apache-2.0 */
/* What a file that ends as an error may take: ten seconds, and four times its size and 256 MB of memory. */
#ifndef TEST_VTK_CLAIMS_H
#define TEST_VTK_CLAIMS_H

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "common.h"

typedef struct Outcome {
  TetcastStatus status;
  char message[1024];
  long kilobytes; /* the most that this process, or one that it started, had at a time */
} Outcome;

/* Reads step `step` of a volume mesh, or, if that is negative, a surface, in a process of its own, which may take ten
 * seconds of a processor. */
static inline Outcome read_limited(Fixture *fixture, const char *path, int step) {
  int ends[2];
  Outcome outcome = {0};
  assert_int_equal(pipe(ends), 0);
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    const struct rlimit time = {10, 10};
    setrlimit(RLIMIT_CPU, &time);
    TetcastDataset *dataset = NULL;
    TetcastSurface surface = {0};
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.step = step;
    outcome.status = step < 0 ? tetcast_surface_read(fixture->context, path, &surface)
                              : tetcast_dataset_read(fixture->context, path, &desc, &dataset);
    snprintf(outcome.message, sizeof outcome.message, "%.1023s", fixture->message);
    struct rusage own, started;
    getrusage(RUSAGE_SELF, &own);
    getrusage(RUSAGE_CHILDREN, &started);
    outcome.kilobytes = own.ru_maxrss > started.ru_maxrss ? own.ru_maxrss : started.ru_maxrss;
    _exit(write(ends[1], &outcome, sizeof outcome) != (ssize_t)sizeof outcome);
  }
  close(ends[1]);
  const ssize_t got = read(ends[0], &outcome, sizeof outcome);
  close(ends[0]);
  int how;
  assert_int_equal(waitpid(child, &how, 0), child);
  if (how != 0 || got != (ssize_t)sizeof outcome)
    fail_msg("%s ends the process, with %#x", path, (unsigned)how);
  return outcome;
}

/* A file that is read or refused, within the bounds. `words`: in the message; NULL: it is read. */
static inline void assert_cheap(Fixture *fixture, const char *path, int step, const char *words) {
  struct stat about;
  assert_int_equal(stat(path, &about), 0);
  const Outcome outcome = read_limited(fixture, path, step);
  if ((outcome.status != TETCAST_OK) != (words != NULL) || (words && !strstr(outcome.message, words))) {
    fail_msg("%s: status %d, '%s' instead of '%s'", path, (int)outcome.status, outcome.message,
             words ? words : "success");
  }
#if !defined(__SANITIZE_ADDRESS__) /* which takes memory for itself */
  const long most = (long)(4 * about.st_size / 1024) + 256 * 1024;
  if (outcome.kilobytes > most)
    fail_msg("%s: takes %ld MB, '%s'", path, outcome.kilobytes / 1024, outcome.message);
#endif
}

#endif
