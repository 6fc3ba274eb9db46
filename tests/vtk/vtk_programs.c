/* SPDX-License-Identifier: Apache-2.0 */
/* Formats that programs of their own read: in hosts of any state, from several threads at a time, and when a program is
 * missing or dies. */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

#include "cases.h"
#include "samples.h"

static bool has_format(const char *extensions) {
  const char *here;
  for (int i = 0; tetcast_dataset_format(i, NULL, &here); ++i) {
    if (strcmp(here, extensions) == 0)
      return true;
  }
  return false;
}

/* The paths of a file in each format that there is a program for. */
enum { MOST_FILES = 3 };
static int write_files(Fixture *fixture, char paths[MOST_FILES][600]) {
  int count = 0;
  if (sample_exodus(in_folder(fixture, "box.ex2")))
    snprintf(paths[count++], 600, "%s", fixture->path);
  if (has_format(".case .encas"))
    snprintf(paths[count++], 600, "%s", write_ensight(fixture));
  if (sample_cgns(in_folder(fixture, "box.cgns")))
    snprintf(paths[count++], 600, "%s", fixture->path);
  if (count == 0)
    skip();
  return count;
}

static TetcastStatus read_once(TetcastContext *context, const char *path) {
  TetcastDataset *dataset;
  const TetcastStatus status = tetcast_dataset_read(context, path, NULL, &dataset);
  tetcast_dataset_destroy(&dataset);
  return status;
}

static int open_files(void) {
  int count = 0;
  DIR *folder = opendir("/proc/self/fd");
  while (folder && readdir(folder))
    ++count;
  if (folder)
    closedir(folder);
  return count;
}

/* ── what the host does with its children and signals ── */

static void bury_all(int signal) {
  (void)signal;
  const int error = errno;
  while (waitpid(-1, NULL, WNOHANG) > 0)
    continue;
  errno = error;
}

static atomic_bool stealing;

static void *steal(void *unused) {
  (void)unused;
  while (stealing) {
    if (waitpid(-1, NULL, 0) < 0)
      nanosleep(&(struct timespec){0, 100000}, NULL);
  }
  return NULL;
}

static void read_all(Fixture *fixture, char paths[MOST_FILES][600], int count, const char *what) {
  for (int i = 0; i < count; ++i) {
    fixture->message[0] = '\0';
    if (read_once(fixture->context, paths[i]) != TETCAST_OK)
      fail_msg("%s: %s", what, fixture->message);
  }
}

static void test_hosts(void **state) {
  Fixture *fixture = *state;
  char paths[MOST_FILES][600];
  const int count = write_files(fixture, paths), files = open_files();

  signal(SIGCHLD, SIG_IGN);
  signal(SIGPIPE, SIG_IGN);
  read_all(fixture, paths, count, "SIGCHLD and SIGPIPE ignored");
  const struct sigaction handler = {.sa_handler = bury_all, .sa_flags = SA_RESTART};
  sigaction(SIGCHLD, &handler, NULL);
  signal(SIGPIPE, SIG_DFL);
  read_all(fixture, paths, count, "a handler that waits for all children");
  signal(SIGCHLD, SIG_DFL);

  stealing = true;
  pthread_t thief;
  assert_int_equal(pthread_create(&thief, NULL, steal, NULL), 0);
  read_all(fixture, paths, count, "a thread that waits for all children");
  stealing = false;
  pthread_join(thief, NULL);

  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  read_all(fixture, paths, count, "all signals blocked");
  pthread_sigmask(SIG_SETMASK, &before, NULL);

  const int input = dup(0);
  close(0);
  read_all(fixture, paths, count, "no standard input");
  assert_int_equal(open_files(), files);
  dup2(input, 0);
  close(input);

  assert_int_equal(open_files(), files);
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
  assert_int_equal(errno, ECHILD);
}

/* ── programs that are missing, or end without a word ── */

static void write_program(Fixture *fixture, const char *text) {
  text_file(fixture, "tetcast-vtk-exodus", text);
  assert_int_equal(chmod(fixture->path, 0700), 0);
}

static void test_programs(void **state) {
  static const struct {
    const char *text, *words;
    TetcastStatus status;
  } cases[] = {{NULL, "which can't be started: No such file", TETCAST_ERROR_UNSUPPORTED},
               {"#!/bin/sh\nexit 0\n", "crashes on it", TETCAST_ERROR_DATA},
               {"#!/bin/sh\nkill -9 $$\n", "crashes on it", TETCAST_ERROR_DATA},
               {"#!/bin/sh\nhead -c 100000 /dev/zero >&3\n", "crashes on it", TETCAST_ERROR_DATA},
               {"#!/bin/sh\nprintf 'gaaaaaaaaaaaaaaaaaaaaaaaaa' >&3\n", "crashes on it", TETCAST_ERROR_DATA},
               {"#!/bin/sh\nsleep 1000 &\necho $! >>\"$(dirname \"$0\")/sleepers\"\n", "crashes on it",
                TETCAST_ERROR_DATA}, /* holds the pipe open */
               {"#!/bin/sh\nprintf h >&3\nsleep 1\n", "does not come to an end", TETCAST_ERROR_DATA},
               {"#!/bin/sh\nprintf o >&3\n", "is not a file of format Exodus", TETCAST_ERROR_UNSUPPORTED}};
  Fixture *fixture = *state;
  char path[600];
  if (!sample_exodus(in_folder(fixture, "box.ex2")))
    skip();
  snprintf(path, sizeof path, "%s", fixture->path);
  setenv("TETCAST_LIBEXEC", fixture->folder, 1);
  alarm(300); /* that it doesn't hang */
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    if (cases[i].text)
      write_program(fixture, cases[i].text);
    assert_int_equal(has_format(".ex2 .exo .e .g"), cases[i].text != NULL);
    for (int ignored = 0; ignored < 2; ++ignored) {
      signal(SIGCHLD, ignored ? SIG_IGN : SIG_DFL);
      read_bad(fixture, path, cases[i].status, cases[i].words);
    }
  }
  signal(SIGCHLD, SIG_DFL);
  alarm(0);
  char command[600];
  snprintf(command, sizeof command, "kill $(cat '%s/sleepers')", fixture->folder);
  assert_int_equal(system(command), 0);
  unsetenv("TETCAST_LIBEXEC");
  assert_int_equal(read_once(fixture->context, path), TETCAST_OK);
}

/* ── threads ── */

enum { THREADS = 8, ROUNDS = 6 };

typedef struct Job {
  TetcastContext *context;
  char (*paths)[600];
  int count, first, failures;
} Job;

static void *read_many(void *argument) {
  Job *job = argument;
  for (int i = 0; i < ROUNDS; ++i)
    job->failures += read_once(job->context, job->paths[(i + job->first) % job->count]) != TETCAST_OK;
  return NULL;
}

static atomic_bool busy;

/* Holds locks of the C library's much of the time, and has children of its own. */
static void *make_trouble(void *unused) {
  (void)unused;
  while (busy) {
    for (size_t size = 1; size < 1 << 20; size *= 2)
      free(malloc(size));
    const pid_t child = fork();
    if (child == 0)
      _exit(0);
    if (child > 0)
      waitpid(child, NULL, 0);
  }
  return NULL;
}

static void test_threads(void **state) {
  Fixture *fixture = *state;
  char paths[MOST_FILES][600];
  const int count = write_files(fixture, paths);
  Job jobs[THREADS];
  pthread_t threads[THREADS], trouble;
  busy = true;
  assert_int_equal(pthread_create(&trouble, NULL, make_trouble, NULL), 0);
  for (int i = 0; i < THREADS; ++i) {
    jobs[i] = (Job){.paths = paths, .count = count, .first = i};
    TetcastContextDesc desc = tetcast_context_desc_default();
    desc.threads = 1;
    assert_int_equal(tetcast_context_create(&desc, &jobs[i].context), TETCAST_OK);
    assert_int_equal(pthread_create(&threads[i], NULL, read_many, &jobs[i]), 0);
  }
  int failures = 0;
  for (int i = 0; i < THREADS; ++i) {
    pthread_join(threads[i], NULL);
    failures += jobs[i].failures;
    tetcast_context_destroy(&jobs[i].context);
  }
  busy = false;
  pthread_join(trouble, NULL);
  assert_int_equal(failures, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_hosts), TEST(test_programs), TEST(test_threads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
