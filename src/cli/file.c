/* SPDX-License-Identifier: Apache-2.0 */
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli.h"

static bool fail(const char *path, int error) {
  cli_error("cannot write '%s': %s", path, error == ENOENT ? "its folder does not exist" : strerror(error));
  return false;
}

static bool put_text(int descriptor, const char *text) {
  errno = 0;
  for (size_t left = strlen(text); left > 0;) {
    const ssize_t count = write(descriptor, text, left);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      return false;
    text += count;
    left -= (size_t)count;
  }
  return true;
}

/* Opens a new file in the folder of `target`; `temporary` receives its name. */
static int open_beside(const char *target, char **temporary) {
  char *folder = cli_path_folder(target);
  int descriptor;
  int number = 0;
  do {
    *temporary = cli_print("%s/.tetcast-%ld-%d.txt", folder, (long)getpid(), number++);
    descriptor = open(*temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) {
      free(*temporary);
      *temporary = NULL;
    }
  } while (descriptor < 0 && errno == EEXIST);
  free(folder);
  return descriptor;
}

static bool write_beside(const char *path, const char *target, const char *text) {
  char *temporary;
  const int descriptor = open_beside(target, &temporary);
  if (descriptor < 0)
    return fail(path, errno);
  bool done = !text || put_text(descriptor, text);
  int error = errno;
  if (close(descriptor) != 0 && done) {
    done = false;
    error = errno;
  }
  if (done && text && rename(temporary, target) != 0) {
    done = false;
    error = errno;
  }
  if (!done || !text)
    unlink(temporary);
  free(temporary);
  return done || fail(path, error ? error : EIO);
}

/* text NULL: only whether it could be done. */
static bool write_or_check(const char *path, const char *text) {
  struct stat status;
  if (stat(path, &status) != 0)
    return errno == ENOENT ? write_beside(path, path, text) : fail(path, errno);
  if (S_ISDIR(status.st_mode))
    return fail(path, EISDIR);
  if (access(path, W_OK) != 0)
    return fail(path, errno);
  if (S_ISREG(status.st_mode)) {
    char *target = realpath(path, NULL); /* a symbolic link stays, what it points to is replaced */
    if (!target)
      return fail(path, errno);
    const bool done = write_beside(path, target, text);
    free(target);
    return done;
  }
  if (!text)
    return true;
  const int descriptor = open(path, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0)
    return fail(path, errno);
  const bool done = put_text(descriptor, text);
  const int error = errno;
  close(descriptor);
  return done || fail(path, error ? error : EIO);
}

bool cli_file_write(const char *path, const char *text) {
  return write_or_check(path, text);
}

bool cli_file_check(const char *path) {
  return write_or_check(path, NULL);
}

CliText *cli_text_begin(void) {
  CliText *text = cli_allocate(sizeof *text);
  *text = (CliText){.file = NULL};
  text->file = open_memstream(&text->memory, &text->size);
  if (!text->file) {
    cli_error("out of memory");
    exit(CLI_FAILED);
  }
  return text;
}

bool cli_text_write(CliText *text, const char *folder, const char *name) {
  char *path = folder ? cli_path_join(folder, name) : cli_duplicate(name);
  const bool whole = !ferror(text->file);
  bool done = fclose(text->file) == 0 && whole;
  if (done)
    done = cli_file_write(path, text->memory);
  else
    cli_error("cannot write '%s': out of memory", path);
  free(path);
  free(text->memory);
  free(text);
  return done;
}

char *cli_path_folder(const char *path) {
  const char *slash = strrchr(path, '/');
  if (!slash)
    return cli_duplicate(".");
  return slash == path ? cli_duplicate("/") : cli_print("%.*s", (int)(slash - path), path);
}

const char *cli_path_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

char *cli_path_join(const char *folder, const char *path) {
  return path[0] == '/' || !strcmp(folder, ".") ? cli_duplicate(path) : cli_print("%s/%s", folder, path);
}

char *cli_path_relative(const char *folder, const char *path) {
  char *from = realpath(folder, NULL);
  char *to = realpath(path, NULL);
  char *result = NULL;
  if (from && to) {
    size_t shared = 0; /* length of the folders both have in common, without a slash at the end */
    for (size_t i = 0;; i++) {
      const bool from_ends = from[i] == '/' || !from[i];
      const bool to_ends = to[i] == '/' || !to[i];
      if (from_ends && to_ends)
        shared = i;
      if (from[i] != to[i] || !from[i])
        break;
    }
    if (shared > 0) {
      result = cli_duplicate("");
      for (const char *c = from + shared; *c; c++) {
        if (*c == '/') {
          char *longer = cli_print("../%s", result);
          free(result);
          result = longer;
        }
      }
      char *whole = cli_print("%s%s", result, to + shared + 1);
      free(result);
      result = whole;
    }
  }
  if (!result)
    result = cli_duplicate(to ? to : path);
  free(from);
  free(to);
  return result;
}
