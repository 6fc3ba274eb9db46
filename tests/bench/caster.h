/* SPDX-License-Identifier: Apache-2.0 */
/* VTK's unstructured ray caster (vtkUnstructuredGridVolumeRayCastMapper's parts) without a window: the same calls in
 * the same order as the mapper's, one thread, but the picture stays in floating point. */
#ifndef BENCH_CASTER_H
#define BENCH_CASTER_H

#include <stdbool.h>

#include <tetcast/camera.h>
#include <tetcast/transfer_function.h>

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum CasterIntegrator {
  CASTER_LINEAR = 0, /* vtkUnstructuredGridLinearRayIntegrator: splits at the knots, closed form in single precision */
  CASTER_PARTIAL,    /* vtkUnstructuredGridPartialPreIntegration: splits at the knots, Psi from a table */
  CASTER_PRE,        /* vtkUnstructuredGridPreIntegration: whole segments from a table; the mapper's default */
  CASTER_INTEGRATORS
} CasterIntegrator;

typedef struct Caster Caster;

/* The mesh as a vtkUnstructuredGrid. Points and scalars are borrowed. NULL when VTK throws. */
Caster *caster_create(const BenchMesh *mesh);
void caster_destroy(Caster *caster);

/* What the mapper does before each picture: the first call builds the triangles and links of the mesh, each call
 * projects points and triangles. Orthographic and perspective; square pixels. */
bool caster_view(Caster *caster, const TetcastCamera *camera, int width, int height);

/* Makes the integrator ready for a transfer function given as opacity, with κ = α / unit distance. */
bool caster_transfer(Caster *caster, const TetcastTransferFunctionDesc *transfer, CasterIntegrator integrator);

/* The picture: [height][width][4], row 0 at the top. Rays end at 99 % opacity as in the mapper. Returns the cells
 * crossed. */
int64_t caster_cast(Caster *caster, float *pixels);

/* Finds isosurfaces at these values with vtkContourFilter, as triangles with nothing but points. Returns how many
 * triangles there are, -1 when VTK throws. */
int64_t caster_contour(Caster *caster, const double *values, int count);

const char *caster_vtk_version(void);

#ifdef __cplusplus
}
#endif

#endif
