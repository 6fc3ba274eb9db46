/* SPDX-License-Identifier: Apache-2.0 */
/* What the options describe, read and prepared, up to the call that renders it. */
#ifndef TETCAST_CLI_STAGE_H
#define TETCAST_CLI_STAGE_H

#include <tetcast/tetcast.h>

#include "adapter.h"
#include "coefficients.h"
#include "render_options.h"

typedef struct Stage {
  TetcastContext *context;
  TetcastDataset *dataset; /* these four only until stage_drop_dataset() */
  TetcastMesh *mesh;
  TetcastField *field;        /* NULL: coefficients instead */
  Coefficients coefficients;
  TetcastVolume *volume;
  TetcastVolumeInfo info;
  TetcastTransferFunction *transfer_function;
  TetcastScene *scene;
  TetcastCamera camera;
  char *array; /* what was read, as --array would name it; NULL: coefficients */
  double read_seconds, prepare_seconds;
} Stage;

/* Each step returns an exit code. The first is what can be known to fail before the mesh is read. */
int stage_begin(Stage *stage, const RenderOptions *options);
int stage_read(Stage *stage, const RenderOptions *options);

/* Holds interruptions from here on. */
int stage_prepare(Stage *stage, const RenderOptions *options);

/* Gives back the memory of what was read; the scene does not need it. */
void stage_drop_dataset(Stage *stage);

/* Frees everything; a stage of zeros and one that a step failed on, too. */
void stage_release(Stage *stage);

#endif
