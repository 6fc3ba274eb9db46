/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulation hands over, as a dataset like those that are read from files: the source that the command's own
 * steps take it from. */
#ifndef TETCAST_CATALYST_DATASET_H
#define TETCAST_CATALYST_DATASET_H

#include <tetcast/dataset.h>

#include "cli/adapter.h"
#include "part.h"

struct TetcastDataset {
  TetcastContext *context;
  char *path;
  Part part; /* all of it */
  TetcastArray vertices, tetrahedra;
  TetcastCut *cut; /* NULL: all cells are tetrahedra, and the arrays are the simulation's own */
  TetcastCutInfo cut_info;
  char **selectors; /* [part.column_count]; of arrays of cells whose name points have, too, "NAME:cell" */
  bool average;     /* arrays of cells become those of points */
  Memory memory;
  char *kept; /* the selector of the last field */
};

/* The functions of a dataset, for cli_set_source(). Its dataset_read() takes what source_set() has handed over. */
const CliVtk *source_functions(void);

/* The mesh, or the meshes, at a path; `topology` is the name of the one to be drawn, NULL: the first with cells. */
/* `processes`: how many have a part each, of which this is one; some may be without cells then. */
void source_set(const ConduitNode *data, const char *path, const char *topology, int processes);

/* An array and one of its components, or all of them. */
typedef struct Selection {
  const Column *column;
  int component; /* SELECTION_MAGNITUDE: the length of the vector */
  bool whole;    /* nothing is said of components */
} Selection;
enum { SELECTION_MAGNITUDE = -1 };

/* What a selector names, NULL: the array that is drawn if none is named. Tells what is wrong, and returns its status.
 */
TetcastStatus selection_find(const TetcastDataset *dataset, const char *selector, Selection *selection);

/* The selected scalar of point or cell i. */
double selection_value(const Selection *selection, int64_t i);

/* The length of a vector. */
double selection_length(const double *values, int count);

#endif
