/* SPDX-License-Identifier: Apache-2.0 */
/* Small text files that appear whole or not at all, and paths. */
#ifndef TETCAST_CLI_FILE_H
#define TETCAST_CLI_FILE_H

#include <stdbool.h>
#include <stdio.h>

/* Writes a text beside `path` and renames it; devices and pipes are written to directly. False after a message. */
bool cli_file_write(const char *path, const char *text);

/* Whether cli_file_write() could start: the folder is there and writable. False after a message. */
bool cli_file_check(const char *path);

/* A text that is put together in memory, by printing to `file`, before it is written. */
typedef struct CliText {
  FILE *file;
  char *memory;
  size_t size;
} CliText;

CliText *cli_text_begin(void);

/* Writes it as a file of a folder (NULL: `name` is the whole path) and frees it. False after a message. */
bool cli_text_write(CliText *text, const char *folder, const char *name);

/* The following return memory for free(). */

/* The folder of a path without the last slash: "." for a bare name, "/" for the root. */
char *cli_path_folder(const char *path);

/* `path` as seen from `folder`: itself if it is absolute. */
char *cli_path_join(const char *folder, const char *path);

/* A path to the existing file `path` that works from the existing `folder`: relative if they share more than the root.
 */
char *cli_path_relative(const char *folder, const char *path);

/* The last part of a path, inside it. */
const char *cli_path_name(const char *path);

#endif
