/* SPDX-License-Identifier: Apache-2.0 */
#include "folder.h"

#include <dirent.h>
#include <errno.h>
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

/* Makes a new folder beside the target; NULL with errno. */
static char *make_beside(const Folder *folder) {
  char *beside = cli_path_folder(folder->target), *path;
  int number = 0;
  while (true) {
    path = cli_print("%s/.tetcast-%ld-%d", beside, (long)getpid(), number++);
    if (mkdir(path, 0777) == 0)
      break;
    free(path);
    path = NULL;
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
    folder->target = cli_duplicate(path);
    for (size_t end = strlen(path); end > 1 && folder->target[end - 1] == '/'; end--)
      folder->target[end - 1] = '\0';
  }
  if (!replaceable(folder))
    return false;
  char *trial = make_beside(folder);
  if (!trial)
    return fail(folder, errno);
  rmdir(trial);
  free(trial);
  return true;
}

bool folder_begin(Folder *folder) {
  folder->temporary = make_beside(folder);
  return folder->temporary || fail(folder, errno);
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

bool folder_publish(Folder *folder) {
  if (!replaceable(folder))
    return false;
  char *former = NULL;
  if (access(folder->target, F_OK) == 0) {
    former = make_beside(folder);
    if (!former || rename(folder->target, former) != 0) {
      const int error = errno;
      if (former)
        rmdir(former);
      free(former);
      return fail(folder, error);
    }
  }
  if (rename(folder->temporary, folder->target) != 0) {
    const int error = errno;
    if (former)
      rename(former, folder->target);
    free(former);
    return fail(folder, error);
  }
  if (former)
    remove_folder(folder, former);
  free(former);
  free(folder->temporary);
  folder->temporary = NULL;
  return true;
}

void folder_release(Folder *folder) {
  if (folder->temporary)
    remove_folder(folder, folder->temporary);
  free(folder->temporary);
  free(folder->target);
}
