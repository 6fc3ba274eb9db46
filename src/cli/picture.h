/* SPDX-License-Identifier: Apache-2.0 */
/* A picture of a run of tetcast render: what one picture and a series of them share. */
#ifndef TETCAST_CLI_PICTURE_H
#define TETCAST_CLI_PICTURE_H

#include <pthread.h>
#include <semaphore.h>

#include "adapter.h"
#include "decoration.h"
#include "deep.h"
#include "json.h"
#include "render_options.h"
#include "stage.h"
#include "stats.h"

typedef struct Run {
  RenderOptions options;
  const CliImage *image;
  TetcastImageDesc image_desc;
  TetcastChannel channels[32]; /* of --channels, in its order */
  double *stop;                /* [height][width], of --stop-depth; NULL: none */
  pthread_t image_thread;
  sem_t image_begun;
  bool image_pending; /* image_thread still has to be waited for */
  Stage stage;
  TetcastFrame *frame;
  Deep deep;                         /* of a deep picture; else zeros */
  RunStats stats;                    /* of the last picture */
  int64_t picture_height, first_row; /* where the frame is a band of the picture; else 0 */
} Run;

/* Each step returns an exit code. */
int picture_read_stop(Run *run); /* what --stop-depth names, with run->image at hand */
int picture_create_frame(Run *run, int64_t width, int64_t height);
int picture_render(Run *run);
int picture_write(Run *run, const char *path);

/* Draws what goes round the picture: into the frame, which has been looked at by then, and as *desc says from here on,
 * which *decoration owns. */
TetcastStatus picture_decorate(Run *run, Decoration *decoration, TetcastImageDesc *desc);

/* The statistics of the last picture, and which array, colours and view it shows and why; the caller releases it. */
json_t *picture_stats(const Run *run);

/* run->stop as the library takes it. */
TetcastArray picture_stop(const Run *run);

/* The name of the input with .png, in the current folder; for free(). */
char *picture_default_output(const char *input);

/* Waits until the image library is loaded and the output has been checked, which is done beside the first reading. */
void picture_await_image(Run *run);

#endif
