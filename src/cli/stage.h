/* SPDX-License-Identifier: Apache-2.0 */
/* A stage: what the options describe, read and prepared up to the call that renders it. */
#ifndef TETCAST_CLI_STAGE_H
#define TETCAST_CLI_STAGE_H

#include <tetcast/tetcast.h>

#include "adapter.h"
#include "coefficients.h"
#include "design.h"
#include "matter.h"
#include "render_options.h"
#include "transfer_file.h"

/* Where this process has only parts of the mesh, what it asks other processes for, or does for all of its parts. */
typedef struct StageOthers {
  struct Ranks *ranks; /* `user` of each of these */
  bool first;          /* this process asks, the others answer */
  TetcastStatus (*statistics)(void *user, const TetcastStatisticsDesc *desc, TetcastStatistics **statistics);
  /* The values at shares of the volume, which are in `range`. */
  TetcastStatus (*quantiles)(void *user, const double range[2], const double *shares, int count, double *values);
  /* Ends that: the first one comes here when it has no more to ask, with what has become of it, an exit code; the
   * others answer until then. All return that code. */
  int (*meet)(void *user, int code);
  /* The transfer functions that one scene would make: scaled for a camera, or of a shape over [0, 1] (NULL: that of a
   * preset) fitted to a range. All come here; those that are not first may pass NULL. */
  TetcastStatus (*scale)(void *user, const TetcastTransferFunction *shape, const TetcastCamera *camera,
                         TetcastTransferFunction **transfer_function);
  TetcastStatus (*fit)(void *user, const TetcastTransferFunction *shape, const char *preset, const double range[2],
                       TetcastTransferFunction **transfer_function);
  /* Scene i = 0, 1, … of this process; NULL beyond the last. */
  TetcastScene *(*scene)(void *user, int i);
} StageOthers;

typedef struct Stage {
  TetcastContext *context;
  TetcastDataset *dataset; /* this one and the next three exist only until stage_drop_dataset() */
  TetcastMesh *mesh;
  TetcastField *field; /* NULL: coefficients instead; or none, of a part without cells or without the array */
  Coefficients coefficients;
  TetcastVolume *volume;
  TetcastVolumeInfo info;
  TetcastTransferFunction *transfer_function;
  TetcastTransferFunction *preset; /* the shape of a preset that is a file's; NULL: it has a name */
  TransferRows rows;               /* of a transfer function of two dimensions */
  TetcastField *second;            /* its second quantity, until stage_drop_dataset(); NULL: it needs none */
  TetcastScene *scene;
  TetcastCamera camera;
  double shown[2];     /* the range of the colour map, where that was made for one */
  double range[2];     /* of the field's finite values */
  double quantiles[2]; /* where --range has shares of the volume: their values */
  Design design;       /* what was found from the values, where no range was given */
  bool designed;
  int64_t nonfinite; /* how many of its values are not finite */
  char *array;       /* what was read, as --array would name it; NULL: coefficients, or uniform matter without labels */
  bool uniform; /* nothing else is there to be drawn: matter, in the colours of the array's labels if there is one */
  Matter matter;
  double read_seconds, prepare_seconds;
  /* for series */
  int64_t step;         /* that was read */
  bool of_series;       /* the volume and the scene serve the next step as well, if it has the same mesh */
  uint64_t fingerprint; /* of the volume's mesh */
  const double *whole;  /* the range of all steps' values; NULL: each step's own */
  /* for parts of a mesh */
  const StageOthers *others; /* NULL: this process has all of the mesh */
  const char *path;          /* of a part that is a file; NULL: the options' input */
  const double *bounds;      /* of a part: those of the whole mesh; NULL: it is all there is */
} Stage;

/* Each step returns an exit code. The first is what can be known to fail before the mesh is read. */
int stage_begin(Stage *stage, const RenderOptions *options);
int stage_read(Stage *stage, const RenderOptions *options);

/* Reads a step, counted from 0, in place of the one that the options name: of the same array as the step that was read
 * before, if any. What was read of another one is dropped. */
int stage_read_step(Stage *stage, const RenderOptions *options, int64_t step);

typedef struct StageValues {
  int64_t count, nonfinite;
  double range[2], mean; /* of those that are finite */
} StageValues;

/* Reads a step for its values alone; stage->mesh is not there then. */
int stage_read_values(Stage *stage, const RenderOptions *options, int64_t step, StageValues *values);

/* Prepares the volume, with its field or the scene's coefficients, and completes the camera. Holds interruptions from
 * here on. */
int stage_prepare(Stage *stage, const RenderOptions *options);

/* What it consists of, for parts of a mesh. The first refuses what can't be drawn of such a field, the second prepares
 * the volume and the scene; the third, with `info`, `range` and `nonfinite` of the whole at hand, does the rest. */
int stage_check_field(const Stage *stage, const RenderOptions *options);
TetcastStatus stage_prepare_scene(Stage *stage, const RenderOptions *options);
int stage_complete(Stage *stage, const RenderOptions *options);

/* Gives the scene its transfer function, if it has no coefficients; if there is none yet, for the range that the
 * options state, or `range`. */
int stage_shade(Stage *stage, const RenderOptions *options, const double range[2]);

/* The preset that the options name over a range, with the extinction that suits the scene. */
TetcastStatus stage_preset(const Stage *stage, const RenderOptions *options, const double range[2],
                           TetcastTransferFunction **transfer_function);

/* What a transfer function is to be found by, as the options say. */
DesignDesc stage_design_desc(const Stage *stage, const RenderOptions *options);

/* Makes a transfer function of a design, in the colours of a preset; NULL: in those that the options or the design ask
 * for. The camera of a first picture counts, whatever this one's is: another view of the same shows the same matter. */
TetcastStatus stage_shade_design(const Stage *stage, const RenderOptions *options, const Design *design,
                                 const char *preset, TetcastTransferFunction **transfer_function);

/* Which array, colours and view are drawn, and why, as JSON; the caller releases it. */
json_t *stage_choices(const Stage *stage, const RenderOptions *options);

/* Gives back the memory of what was read; the scene does not need it. */
void stage_drop_dataset(Stage *stage);

/* Frees everything; a stage of zeros and one that a step failed on, too. */
void stage_release(Stage *stage);

#endif
