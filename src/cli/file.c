/* SPDX-License-Identifier: Apache-2.0 */
#include "file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli.h"

static bool fail(const char *path, int error) {
  cli_error("cannot write '%s': %s", path, error == ENOENT ? "its folder does not exist" : strerror(error));
  return false;
}

static bool put_text(int descriptor, const char *text, size_t size) {
  errno = 0;
  for (size_t left = size; left > 0;) {
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

bool cli_file_lock(int descriptor) {
  struct stat status;
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    return errno != EWOULDBLOCK; /* on a file system without locks nobody looks for them */
  return fstat(descriptor, &status) != 0 || status.st_nlink > 0;
}

void cli_file_keep_mode(int descriptor, const struct stat *former) {
  const bool owned = fchown(descriptor, former->st_uid, former->st_gid) == 0;
  fchmod(descriptor, former->st_mode & (owned ? 07777 : 0777));
}

/* Opens a new file in the folder of `target`; `temporary` receives its name. former NULL: none is replaced. */
static int open_beside(const char *target, const struct stat *former, char **temporary) {
  char *folder = cli_path_folder(target);
  int descriptor;
  int number = 0;
  do {
    *temporary = cli_print("%s/.tetcast-%ld-%d.txt", folder, (long)getpid(), number++);
    descriptor = open(*temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, former ? former->st_mode & 0777 : 0666);
    if (descriptor >= 0 && !cli_file_lock(descriptor)) {
      close(descriptor);
      descriptor = -1;
      errno = EEXIST;
    }
    if (descriptor < 0) {
      free(*temporary);
      *temporary = NULL;
    }
  } while (descriptor < 0 && errno == EEXIST);
  free(folder);
  if (descriptor >= 0 && former)
    cli_file_keep_mode(descriptor, former);
  return descriptor;
}

static bool write_beside(const char *path, const char *target, const struct stat *former, const char *text,
                         size_t size) {
  char *temporary;
  const int descriptor = open_beside(target, former, &temporary);
  if (descriptor < 0)
    return fail(path, errno);
  const int lock = fcntl(descriptor, F_DUPFD_CLOEXEC, 0); /* until the file has its name */
  bool done = !text || put_text(descriptor, text, size);
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
  if (lock >= 0)
    close(lock);
  free(temporary);
  return done || fail(path, error ? error : EIO);
}

/* Whether a path stands for something that is open already, which is appended to instead of being replaced. */
static bool is_open_already(const char *path) {
  static const char *const starts[] = {"/dev/stdout", "/dev/stderr", "/dev/fd/", "/proc/"};
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
    if (!strncmp(path, starts[i], strlen(starts[i])))
      return true;
  return false;
}

/* Writes a text of so many bytes. With NULL it only checks whether that could be done. */
static bool write_or_check(const char *path, const char *text, size_t size) {
  struct stat status;
  if (stat(path, &status) != 0) {
    if (errno != ENOENT)
      return fail(path, errno);
    char *target = cli_path_follow(path);
    const bool done = write_beside(path, target, NULL, text, size);
    free(target);
    return done;
  }
  if (S_ISDIR(status.st_mode))
    return fail(path, EISDIR);
  if (access(path, W_OK) != 0)
    return fail(path, errno);
  if (S_ISREG(status.st_mode) && !is_open_already(path)) {
    char *target = realpath(path, NULL); /* a symbolic link stays, what it points to is replaced */
    if (!target)
      return fail(path, errno);
    const bool done = write_beside(path, target, &status, text, size);
    free(target);
    return done;
  }
  if (!text)
    return true;
  const int descriptor = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0)
    return fail(path, errno);
  const bool done = put_text(descriptor, text, size);
  const int error = errno;
  close(descriptor);
  return done || fail(path, error ? error : EIO);
}

bool cli_file_write(const char *path, const char *text) {
  return write_or_check(path, text, strlen(text));
}

bool cli_file_check(const char *path) {
  return write_or_check(path, NULL, 0);
}

/* ".tetcast-12-3", with or without an extension. */
static bool is_temporary(const char *name) {
  static const char start[] = ".tetcast-", digits[] = "0123456789";
  if (strncmp(name, start, sizeof start - 1) != 0)
    return false;
  name += sizeof start - 1;
  const size_t process = strspn(name, digits), number = name[process] == '-' ? strspn(name + process + 1, digits) : 0;
  const char end = number > 0 ? name[process + 1 + number] : 'x';
  return process > 0 && (end == '\0' || end == '.');
}

/* Removes a file, or a folder with the files in it, if nobody holds its lock. */
static void remove_unlocked(int folder, const char *name) {
  const int descriptor = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0)
    return;
  DIR *entries = flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? fdopendir(descriptor) : NULL;
  if (entries) {
    const struct dirent *entry;
    while ((entry = readdir(entries)))
      unlinkat(descriptor, entry->d_name, 0);
    unlinkat(folder, name, AT_REMOVEDIR);
    closedir(entries);
    return;
  }
  struct stat status;
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode))
    unlinkat(folder, name, 0);
  close(descriptor);
}

void cli_file_tidy(const char *path) {
  char *target = realpath(path, NULL); /* temporary files lie beside what links lead to */
  if (!target)
    target = cli_path_follow(path);
  char *folder = cli_path_folder(target);
  DIR *entries = opendir(folder);
  const struct dirent *entry;
  while (entries && (entry = readdir(entries)))
    if (is_temporary(entry->d_name))
      remove_unlocked(dirfd(entries), entry->d_name);
  if (entries)
    closedir(entries);
  free(folder);
  free(target);
}

CliFile cli_file_identify(const char *path) {
  CliFile file = {.exists = false};
  struct stat status;
  if (stat(path, &status) == 0) {
    file.exists = true;
    file.regular = S_ISREG(status.st_mode) && !is_open_already(path);
    file.device = status.st_dev;
    file.number = status.st_ino;
    return file;
  }
  char *target = cli_path_follow(path), *folder = cli_path_folder(target), *whole = realpath(folder, NULL);
  if (whole)
    file.path = cli_print("%s/%s", whole, cli_path_name(target));
  free(whole);
  free(folder);
  free(target);
  return file;
}

void cli_file_forget(CliFile *file) {
  free(file->path);
  file->path = NULL;
}

bool cli_file_same(const CliFile *a, const CliFile *b) {
  if (a->exists && b->exists)
    return a->regular && a->device == b->device && a->number == b->number;
  return !a->exists && !b->exists && a->path && b->path && !strcmp(a->path, b->path);
}

CliText *cli_text_begin(void) {
  CliText *text = cli_allocate(sizeof *text);
  *text = (CliText){.file = NULL};
  text->file = open_memstream(&text->memory, &text->size);
  if (!text->file)
    cli_out_of_memory();
  return text;
}

bool cli_text_write(CliText *text, const char *folder, const char *name) {
  char *path = folder ? cli_path_join(folder, name) : cli_duplicate(name);
  const bool whole = !ferror(text->file);
  bool done = fclose(text->file) == 0 && whole;
  if (done)
    done = write_or_check(path, text->memory, text->size);
  else
    cli_error("cannot write '%s': out of memory", path);
  free(path);
  free(text->memory);
  free(text);
  return done;
}

void cli_text_drop(CliText *text) {
  fclose(text->file);
  free(text->memory);
  free(text);
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

char *cli_path_follow(const char *path) {
  char *result = cli_duplicate(path);
  for (int i = 0; i < 40; i++) { /* as many links as the system follows */
    char target[PATH_MAX];
    const ssize_t length = readlink(result, target, sizeof target - 1);
    if (length <= 0)
      break;
    target[length] = '\0';
    char *folder = cli_path_folder(result);
    free(result);
    result = cli_path_join(folder, target);
    free(folder);
  }
  return result;
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
