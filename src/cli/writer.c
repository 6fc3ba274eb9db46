/* SPDX-License-Identifier: Apache-2.0 */
#include "writer.h"

#include <stdlib.h>

#include "cli.h"
#include "progress.h"

/* Signals wait until the picture is whole. */
static void *write_aside(void *argument) {
  Writer *writer = argument;
  const double start = cli_seconds();
  const TetcastStatus status =
      writer->run->image->image_write(writer->run->stage.context, writer->path, writer->frame, &writer->desc);
  writer->seconds = cli_seconds() - start;
  writer->code = status == TETCAST_OK ? CLI_DONE : cli_failed(status);
  cli_interrupt_hold(false);
  return NULL;
}

int writer_begin(Writer *writer, Run *run, const char *path) {
  int code = writer_end(writer);
  if (code != CLI_DONE)
    return code;
  if (render_options_deep(&run->options)) { /* which has one set of layers */
    code = picture_write(run, path);
    writer->seconds = run->stats.write_seconds;
    return code;
  }
  picture_await_image(run);
  writer->desc = run->image_desc;
  decoration_release(&writer->decoration);
  const TetcastStatus status = picture_decorate(run, &writer->decoration, &writer->desc);
  if (status != TETCAST_OK)
    return cli_failed(status);
  TetcastFrame *spare = writer->frame;
  writer->run = run;
  writer->frame = run->frame;
  writer->path = cli_duplicate(path);
  run->frame = spare;
  if (!spare)
    code = picture_create_frame(run, tetcast_frame_width(writer->frame), tetcast_frame_height(writer->frame));
  cli_interrupt_hold(true);
  writer->busy = pthread_create(&writer->thread, NULL, write_aside, writer) == 0;
  if (!writer->busy) {
    write_aside(writer);
    code = code == CLI_DONE ? writer->code : code;
  }
  return code;
}

int writer_end(Writer *writer) {
  if (writer->busy)
    pthread_join(writer->thread, NULL);
  writer->busy = false;
  free(writer->path);
  writer->path = NULL;
  return writer->code;
}

void writer_release(Writer *writer) {
  writer_end(writer);
  tetcast_frame_destroy(&writer->frame);
  decoration_release(&writer->decoration);
}
