/* SPDX-License-Identifier: Apache-2.0 */
/* A folder of files that appears whole or not at all. */
#ifndef TETCAST_CLI_FOLDER_H
#define TETCAST_CLI_FOLDER_H

#include <stdbool.h>

typedef struct Folder {
  char *target;             /* without slashes at the end */
  char *temporary;          /* where the files go until they are all there; NULL: not begun */
  int lock;                 /* of that one, while it is begun: see cli_file_tidy() */
  const char *const *files; /* names that may be in it, NULL at the end */
} Folder;

/* Whether the folder could be written: it is not there, empty, or holds nothing but `files`, and its own folder is
 * writable. False after a message; either way for folder_release(). */
bool folder_check(Folder *folder, const char *path, const char *const *files);

/* Makes the temporary folder. False after a message. */
bool folder_begin(Folder *folder);

/* Gives it its name; what was there goes. Whenever the process is killed, one of the two is there (but where the file
 * system can't exchange names). False after a message. */
bool folder_publish(Folder *folder);

/* Removes what was begun and not published. */
void folder_release(Folder *folder);

#endif
