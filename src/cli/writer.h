/* SPDX-License-Identifier: Apache-2.0 */
/* Writes pictures while the next one is made: one at a time. */
#ifndef TETCAST_CLI_WRITER_H
#define TETCAST_CLI_WRITER_H

#include "picture.h"

typedef struct Writer {
  Run *run;
  char *path;
  TetcastImageDesc desc; /* of the picture under way, with its legend */
  Decoration decoration;
  TetcastFrame *frame; /* being written, or a spare one */
  double seconds;      /* that the last picture took */
  pthread_t thread;
  bool busy;
  int code;
} Writer;

/* Waits for the picture before, and begins to write that of the run, whose frame is another one then. Each of these
 * returns an exit code. */
int writer_begin(Writer *writer, Run *run, const char *path);

/* Waits until the picture is written, if there is one. */
int writer_end(Writer *writer);

void writer_release(Writer *writer);

#endif
