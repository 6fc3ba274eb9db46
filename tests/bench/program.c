/* SPDX-License-Identifier: Apache-2.0 */
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rows.h"

char *program_folder(const char *argv0) {
  const char *slash = strrchr(argv0, '/');
  char *folder = slash ? strndup(argv0, (size_t)(slash - argv0)) : strdup(".");
  must(folder != NULL, "no memory");
  return folder;
}

char *program_find(const char *folder, const char *name) {
  const size_t size = strlen(folder) + strlen(name) + 2;
  char *path = malloc(size);
  must(path != NULL, "no memory");
  snprintf(path, size, "%s/%s", folder, name);
  if (access(path, X_OK) == 0) {
    return path;
  }
  fprintf(stderr, "tetcast_bench: without %s, which was not built\n", path);
  free(path);
  return NULL;
}

bool program_wait(pid_t child) {
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}
