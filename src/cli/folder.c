/* SPDX-License-Identifier: Apache-2.0 */
#include "folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli.h"
#include "file.h"

static bool fail(const Folder *folder, int error) {
  cli_error("cannot write folder '%s': %s", folder->target,
            error == ENOENT ? "its folder does not exist" : strerror(error));
  return false;
}

/* Makes a new folder beside the target, and takes its lock (-1: it can't be locked); NULL with errno. */
static char *make_beside(const Folder *folder, int *lock) {
  char *beside = cli_path_folder(folder->target), *path;
  int number = 0;
  while (true) {
    path = cli_print("%s/.tetcast-%ld-%d", beside, (long)getpid(), number++);
    *lock = -1;
    const bool made = mkdir(path, 0777) == 0;
    if (made)
      *lock = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (made && (*lock < 0 ? errno != ENOENT : cli_file_lock(*lock)))
      break;
    const int error = made ? EEXIST : errno;
    if (*lock >= 0)
      close(*lock);
    free(path);
    path = NULL;
    errno = error;
    if (errno != EEXIST)
      break;
  }
  free(beside);
  return path;
}

static bool expected(const Folder *folder, const char *name) {
  if (!strcmp(name, ".") || !strcmp(name, ".."))
    return true;
  for (const char *const *file = folder->files; *file; file++)
    if (!strcmp(name, *file))
      return true;
  return false;
}

/* Whether nothing is lost when an existing folder is replaced. */
static bool replaceable(const Folder *folder) {
  DIR *entries = opendir(folder->target);
  if (!entries)
    return errno == ENOENT || fail(folder, errno);
  const struct dirent *entry;
  bool done = true;
  while (done && (entry = readdir(entries))) {
    done = expected(folder, entry->d_name);
    if (!done)
      cli_error("cannot write folder '%s': it holds '%s', which is not part of a report", folder->target,
                entry->d_name);
  }
  closedir(entries);
  return done;
}

bool folder_check(Folder *folder, const char *path, const char *const *files) {
  folder->files = files;
  folder->target = realpath(path, NULL); /* a symbolic link stays, what it points to is replaced */
  if (!folder->target) {
    char *given = cli_duplicate(path);
    for (size_t end = strlen(path); end > 1 && given[end - 1] == '/'; end--)
      given[end - 1] = '\0';
    folder->target = cli_path_follow(given);
    free(given);
  }
  if (!replaceable(folder))
    return false;
  int lock;
  char *trial = make_beside(folder, &lock);
  if (!trial)
    return fail(folder, errno);
  rmdir(trial);
  if (lock >= 0)
    close(lock);
  free(trial);
  return true;
}

bool folder_begin(Folder *folder) {
  folder->temporary = make_beside(folder, &folder->lock);
  if (!folder->temporary)
    return fail(folder, errno);
  struct stat former;
  if (folder->lock >= 0 && stat(folder->target, &former) == 0) {
    former.st_mode |= S_IRWXU;
    cli_file_keep_mode(folder->lock, &former);
  }
  return true;
}

/* Removes a folder and the files that may be in it. */
static void remove_folder(const Folder *folder, const char *path) {
  for (const char *const *file = folder->files; *file; file++) {
    char *name = cli_print("%s/%s", path, *file);
    unlink(name);
    free(name);
  }
  rmdir(path);
}

/* Where names can't be exchanged: the former folder steps aside, and back if the new one can't take its place. */
static int replace_by_two(const Folder *folder) {
  int lock;
  char *former = make_beside(folder, &lock);
  if (former && lock >= 0)
    close(lock);
  lock = open(folder->target, O_RDONLY | O_DIRECTORY | O_CLOEXEC); /* the one that is to bear that name */
  if (lock >= 0)
    cli_file_lock(lock);
  int error = former && rename(folder->target, former) == 0 ? 0 : errno;
  if (error && former)
    rmdir(former);
  if (!error && rename(folder->temporary, folder->target) != 0) {
    error = errno;
    rename(former, folder->target);
  } else if (!error) {
    remove_folder(folder, former);
  }
  if (lock >= 0)
    close(lock);
  free(former);
  return error;
}

/* Gives the new folder its name; 0 or an error. */
static int replace(const Folder *folder) {
  if (access(folder->target, F_OK) != 0)
    return rename(folder->temporary, folder->target) == 0 ? 0 : errno;
#ifdef RENAME_EXCHANGE
  if (renameat2(AT_FDCWD, folder->temporary, AT_FDCWD, folder->target, RENAME_EXCHANGE) == 0) {
    remove_folder(folder, folder->temporary); /* which is the former one now */
    return 0;
  }
  if (errno != EINVAL && errno != ENOSYS)
    return errno;
#endif
  return replace_by_two(folder);
}

bool folder_publish(Folder *folder) {
  if (!replaceable(folder))
    return false;
  const int error = replace(folder);
  if (error)
    return fail(folder, error);
  if (folder->lock >= 0)
    close(folder->lock);
  free(folder->temporary);
  folder->temporary = NULL;
  return true;
}

void folder_release(Folder *folder) {
  if (folder->temporary) {
    remove_folder(folder, folder->temporary);
    if (folder->lock >= 0)
      close(folder->lock);
  }
  free(folder->temporary);
  free(folder->target);
}
