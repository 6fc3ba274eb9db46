/* SPDX-License-Identifier: Apache-2.0 */
/* Small text files that appear whole or not at all, which files are the same, and paths. */
#ifndef TETCAST_CLI_FILE_H
#define TETCAST_CLI_FILE_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

/* Writes a text beside `path` and renames it, keeping the mode of a file that is replaced and following symbolic links;
 * devices and pipes, and what is open already, such as /dev/stdout, are written to directly. False after a message. */
bool cli_file_write(const char *path, const char *text);

/* Whether cli_file_write() could start: the folder is there and writable. False after a message. */
bool cli_file_check(const char *path);

/* A text, or any bytes, put together in memory, by printing to `file`, before it is written. */
typedef struct CliText {
  FILE *file;
  char *memory;
  size_t size;
} CliText;

CliText *cli_text_begin(void);

/* Writes it as a file of a folder (NULL: `name` is the whole path) and frees it. False after a message. */
bool cli_text_write(CliText *text, const char *folder, const char *name);

/* Frees it without writing it. */
void cli_text_drop(CliText *text);

/* What is being written has names of this form beside its target, and a lock (flock) that ends with the process:
 * .tetcast-PROCESS-NUMBER and an extension. The adapters do the same. This removes those in the folder of `path` that
 * have no lock, which killed runs have left. */
void cli_file_tidy(const char *path);

/* Takes that lock of a new file or folder. False: another process has taken it for a left-over; a new name is needed.
 */
bool cli_file_lock(int descriptor);

/* Gives a new file the mode and, where possible, the owner of the one that it will replace. */
struct stat;
void cli_file_keep_mode(int descriptor, const struct stat *former);

/* Which file a path names, through all links: by device and number if there is one, else by where it would be. */
typedef struct CliFile {
  bool exists, regular; /* neither a device or pipe nor open already */
  dev_t device;
  ino_t number;
  char *path; /* of a file that does not exist; NULL: its folder does not either */
} CliFile;

CliFile cli_file_identify(const char *path);
void cli_file_forget(CliFile *file);

/* Whether writing one would replace the other; never for devices and pipes. */
bool cli_file_same(const CliFile *a, const CliFile *b);

/* The following return memory for free(). */

/* Where a path leads that names no existing file: through symbolic links to where there is nothing yet. */
char *cli_path_follow(const char *path);

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
