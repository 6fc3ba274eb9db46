/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes without a scalar, drawn as uniform matter: the picture shows how far rays go through it. */
#ifndef TETCAST_CLI_MATTER_H
#define TETCAST_CLI_MATTER_H

#include <stdbool.h>

#include <tetcast/dataset.h>
#include <tetcast/tetcast.h>

#include "render_options.h"

/* Whether a dataset has no array that could be drawn: none at all, or only numbers of blocks, materials and the like
 * over its cells. *label becomes the name of those that colour tells apart, valid while the dataset lives; NULL: there
 * are none. */
bool matter_wanted(const TetcastDataset *dataset, const char **label);

/* Whether the values of this array are numbers of materials and the like: whole ones of cells, of which there are few.
 */
bool matter_is_label(const TetcastDataset *dataset, const char *selector, const TetcastField *field);

/* A scalar that is 1 at each vertex. */
TetcastStatus matter_field(TetcastContext *context, const TetcastMesh *mesh, TetcastField **field);

/* What is needed of matter that has labels, while its field is there. */
typedef struct Matter {
  double extinction; /* by which rays through the mesh are half opaque on average */
  double *labels;    /* [count], ascending; NULL: they have not been collected */
  int count;         /* at most MATTER_LABELS; 0: there are more */
} Matter;

/* As many as colours can tell apart for somebody who looks for it. */
enum { MATTER_LABELS = 256 };

/* The labels alone. */
void matter_collect(const TetcastField *labels, Matter *matter);

/* Adds those of another part of the mesh; one that has none has too many. */
void matter_unite(const Matter *other, Matter *matter);

TetcastStatus matter_measure(TetcastContext *context, const TetcastVolume *volume, const TetcastMesh *mesh,
                             const TetcastField *labels, Matter *matter);

/* The same extinction for all labels, and a colour for each: that of `map`, or (NULL) what is said of them as --label
 * has it, else one that neighbours in the list don't share. */
TetcastStatus matter_shade(TetcastContext *context, const Matter *matter, const TetcastTransferFunction *map,
                           const TextList *said, TetcastTransferFunction **transfer_function);

void matter_release(Matter *matter);

#endif
