/* SPDX-License-Identifier: Apache-2.0 */
/* The geometry matrix of rays through a mesh, as a Matrix Market file. */
#ifndef TETCAST_CLI_MATRIX_H
#define TETCAST_CLI_MATRIX_H

#include <stdbool.h>

#include "ray_file.h"
#include "stage.h"

typedef enum Basis { BASIS_CELLS, BASIS_POINTS } Basis;

/* Writes a row for each ray: the lengths in the file's cells, or the integrals of the basis functions of the mesh's
 * points. The stage has been prepared and still has its dataset. An exit code. */
int matrix_write(const Stage *stage, const RenderOptions *options, Basis basis, const RayFile *rays);

#endif
