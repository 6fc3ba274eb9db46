/* SPDX-License-Identifier: Apache-2.0 */
/* Files that VTK's writers make of one box: points at (i, j, k/2), 4 × 3 × 5 of them, of the point array s = x + 2y +
 * 4z and the cell array c, the number of each of the 24 cells, along x first. */
#ifndef TEST_VTK_SAMPLES_H
#define TEST_VTK_SAMPLES_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BOX_POINTS = 60, BOX_CELLS = 24 };

typedef enum SampleMode {
  SAMPLE_ASCII,
  SAMPLE_BINARY,
  SAMPLE_APPENDED,
  SAMPLE_RAW
} SampleMode; /* legacy: ASCII or binary */
typedef enum SampleGhosts { GHOST_NONE, GHOST_TYPES, GHOST_LEVELS } SampleGhosts;

/* .vti, .vtr, .vts or .vtk by the path's end; kind 'i', 'r' or 's'. */
void sample_structured(const char *path, char kind, SampleMode mode);

/* .vts with cell 0 blanked, and the point at the other end. */
void sample_blanked(const char *path);

/* .vtu of the layers of cells from `first` up to `end` (of 4); with ghosts, of one layer more at either end, marked as
 * such. */
void sample_layers(const char *path, int first, int end, SampleGhosts ghosts);

/* .vtm: group "body" of blocks "lower" and "upper" of two layers each, of which upper has no array c, a block without a
 * name that is a surface, and one that is empty. */
void sample_blocks(const char *path);

/* Exodus of one block and two time steps, at 1 and 2: s and 2s. False: built without. */
bool sample_exodus(const char *path);

/* CGNS of a zone of hexahedra "lower", and a structured one "upper"; array s at the points. False: built without. */
bool sample_cgns(const char *path);

#ifdef __cplusplus
}
#endif

#endif
