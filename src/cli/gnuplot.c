/* SPDX-License-Identifier: Apache-2.0 */
#include "gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"

extern char **environ;

/* Runs gnuplot with one argument in a folder (NULL: here), without the user's own settings. 0 and its exit code, or the
 * number of an error; the start of what it says on standard error goes to `text`. */
static int run(const char *folder, const char *argument, int *code, char *text, size_t size) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return errno;
  char *argv[] = {(char *)"gnuplot", (char *)"-d", (char *)argument, NULL};
  posix_spawn_file_actions_t actions;
  int error = posix_spawn_file_actions_init(&actions);
  if (!error)
    error = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  if (!error)
    error = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (!error)
    error = posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  if (!error && folder)
    error = posix_spawn_file_actions_addchdir_np(&actions, folder);
  pid_t child = -1;
  if (!error)
    error = posix_spawnp(&child, argv[0], &actions, NULL, argv, environ);
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
  if (error)
    return error;
  int status;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR)
      return errno;
  *code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return 0;
}

bool gnuplot_find(void) {
  char text[256];
  int code;
  return run(NULL, "--version", &code, text, sizeof text) == 0 && code == 0;
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
  int code = 0;
  const int error = run(folder, script, &code, text, sizeof text);
  bool done = false;
  if (error) {
    cli_error("cannot run gnuplot: %s", strerror(error));
  } else if (code != 0) {
    const char *reason = last_line(text);
    cli_error("gnuplot failed at %s: %s", script, *reason ? reason : "it gives no reason");
  } else {
    done = complete(folder, name, ".svg", "</svg>") && complete(folder, name, ".png", "IEND");
    if (!done)
      cli_error("gnuplot could not write %s.svg and %s.png in full", name, name);
  }
  free(script);
  return done;
}
