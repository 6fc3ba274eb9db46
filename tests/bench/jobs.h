/* SPDX-License-Identifier: Apache-2.0 */
/* The measurements, each to be called in a process of its own. */
#ifndef BENCH_JOBS_H
#define BENCH_JOBS_H

#include <stdbool.h>
#include <stdio.h>

#include "caster.h"
#include "rows.h"
#include "scenes.h"
#include "tet.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Options {
  unsigned run;                       /* RUN_SMALL, … */
  int rounds;                         /* 0: what the scene says */
  int pixels;                         /* width and height of most pictures */
  double least;                       /* seconds for which a frame of tetcast is repeated, and its median taken */
  const char *folder;                 /* for results.csv and pictures */
  const char *scratch;                /* for meshes */
  const char *tetcast, *plain, *body; /* programs; NULL: there is none */
  bool pictures;
} Options;

/* All the jobs need: the scene, its mesh, where the rows go. */
typedef struct Job {
  const Options *options;
  const SceneDesc *scene;
  const BenchMesh *mesh;
  Row row; /* with scene and sizes filled in */
} Job;

/* Preparation, and frames through the soft and the sharp transfer function, tetcast beside VTK. */
void job_frames(const Job *job);

/* How much memory preparation takes and leaves in use. */
void job_memory(const Job *job);
void job_memory_vtk(const Job *job);

/* tetcast alone: what changes when the transfer function changes, and what each feature costs. */
void job_visible(const Job *job);
void job_features(const Job *job);

/* What the field's statistics and quantiles cost, and finding isosurfaces with VTK, beside features. */
void job_numbers(const Job *job);

/* Any rays beside a frame, and the cells that they cross. */
void job_rays(const Job *job);

/* Fragments of parts of the mesh, each beside a frame of the part. */
void job_parts(const Job *job);

/* Writes the mesh as .vtu; reads it; renders it with the command. */
void job_file(const Job *job);

/* Cuts as many hexahedra as the mesh has cubes, tetcast beside VTK. */
void job_cells(const Job *job);

/* One measurement of a frame: repeated while that is a matter of moments, the median of wall and CPU time. */
Clock measure_frame(const Job *job, Tet *tet, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                    TetcastFrame *frame, TetcastRenderStats *stats);

#ifdef __cplusplus
}
#endif

#endif
