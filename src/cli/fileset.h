/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a run: none that it writes may be one that it reads, or that it writes for something else. */
#ifndef TETCAST_CLI_FILESET_H
#define TETCAST_CLI_FILESET_H

#include <stdbool.h>

#include "file.h"
#include "render_options.h"

typedef struct FileSetEntry {
  const char *what; /* "the input", "--stats"; static storage */
  char *name;
  CliFile file;
  bool written;
} FileSetEntry;

typedef struct FileSet {
  int count, capacity;
  FileSetEntry *entries;
} FileSet;

/* Adds a file by its path; NULL: nothing. */
void fileset_add(FileSet *set, const char *what, const char *path, bool written);

/* Adds what the options name but the output, which may be many files or a folder. */
void fileset_add_options(FileSet *set, const RenderOptions *options);

/* -1, or the exit code after a message about two that are the same. The set is empty afterwards. */
int fileset_check(FileSet *set, const char *command);

#endif
