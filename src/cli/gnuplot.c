/* SPDX-License-Identifier: Apache-2.0 */
#include "gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"

extern char **environ;

/* The child process has no blocked signals, and ignores only those that nohup and shells ignore. */
static int reset_signals(posix_spawnattr_t *attributes) {
  sigset_t defaults, none;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGCHLD);
  sigaddset(&defaults, SIGPIPE);
  sigaddset(&defaults, SIGXFSZ);
  sigemptyset(&none);
  int error = posix_spawnattr_setsigdefault(attributes, &defaults);
  if (!error)
    error = posix_spawnattr_setsigmask(attributes, &none);
  return error ? error : posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
}

static int set_files(posix_spawn_file_actions_t *actions, const char *folder, int pipe_end, int reported) {
  int error = posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (int file = STDOUT_FILENO; file <= STDERR_FILENO && !error; file++)
    error = file == reported ? posix_spawn_file_actions_adddup2(actions, pipe_end, file)
                             : posix_spawn_file_actions_addopen(actions, file, "/dev/null", O_WRONLY, 0);
  if (!error && folder)
    error = posix_spawn_file_actions_addchdir_np(actions, folder);
  return error;
}

/* Runs gnuplot with one argument in a folder (NULL: here), without the user's own settings, until it has ended. 0, or
 * the number of an error that kept it from starting; the start of what it says on file `reported` goes to `text`. How
 * it ended is not asked for: where SIGCHLD is ignored, or another part of the program waits for all children, nobody
 * can tell. */
static int run(const char *folder, const char *argument, int reported, char *text, size_t size) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return errno;
  char *argv[] = {(char *)"gnuplot", (char *)"-d", (char *)argument, NULL};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  int error = posix_spawn_file_actions_init(&actions);
  if (!error)
    error = posix_spawnattr_init(&attributes);
  if (!error)
    error = reset_signals(&attributes);
  if (!error)
    error = set_files(&actions, folder, ends[1], reported);
  pid_t child = -1;
  if (!error)
    error = posix_spawnp(&child, argv[0], &actions, &attributes, argv, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  size_t filled = 0;
  char rest[512];
  ssize_t count = 1;
  while (!error && (count > 0 || (count < 0 && errno == EINTR))) {
    const bool room = filled + 1 < size;
    count = read(ends[0], room ? text + filled : rest, room ? size - 1 - filled : sizeof rest);
    if (room && count > 0)
      filled += (size_t)count;
  }
  text[filled] = '\0';
  close(ends[0]);
  while (!error && waitpid(child, NULL, 0) < 0 && errno == EINTR)
    continue;
  return error;
}

bool gnuplot_find(void) {
  char text[256];
  return run(NULL, "--version", STDOUT_FILENO, text, sizeof text) == 0 && !strncmp(text, "gnuplot ", 8);
}

/* Whether a file is there up to its end: gnuplot does not notice a full disk. */
static bool complete(const char *folder, const char *name, const char *extension, const char *end) {
  char *path = cli_print("%s/%s%s", folder, name, extension);
  FILE *file = fopen(path, "rb");
  char tail[33] = {0};
  const bool found =
      file && fseek(file, -32, SEEK_END) == 0 && fread(tail, 1, 32, file) == 32 && memmem(tail, 32, end, strlen(end));
  if (file)
    fclose(file);
  free(path);
  return found;
}

/* What gnuplot says is at the end, after the command and a mark where in it. */
static const char *last_line(char *text) {
  size_t end = strlen(text);
  while (end > 0 && strchr(" \n\t", text[end - 1]))
    text[--end] = '\0';
  const char *line = strrchr(text, '\n');
  return line ? line + 1 : text;
}

bool gnuplot_draw(const char *folder, const char *name) {
  char *script = cli_print("%s.gp", name), text[2048];
  const int error = run(folder, script, STDERR_FILENO, text, sizeof text);
  const bool done = !error && complete(folder, name, ".svg", "</svg>") && complete(folder, name, ".png", "IEND");
  const char *reason = done || error ? "" : last_line(text);
  if (error)
    cli_error("cannot run gnuplot: %s", strerror(error));
  else if (!done && *reason)
    cli_error("gnuplot failed at %s: %s", script, reason);
  else if (!done)
    cli_error("gnuplot could not write %s.svg and %s.png in full", name, name);
  free(script);
  return done;
}
