/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "program.h"

#define F32 TETCAST_TYPE_FLOAT32
#define F64 TETCAST_TYPE_FLOAT64
enum {
  ALWAYS = RUN_NORMAL | RUN_LARGE,
  ALL_WORK = SCENE_SIZES | SCENE_VISIBLE | SCENE_FEATURES | SCENE_FILE | SCENE_CELLS
};

static const SceneDesc scenes[] = {
    {"cube-1k", 6, NULL, 1296, F32, ALL_WORK, RUN_SMALL, 1},
    {"cube-1k-double", 6, NULL, 1296, F64, 0, RUN_SMALL, 1},
    {"shell-3k", 0, "shell", 1000, F32, 0, RUN_SMALL, 1},
    {"cube-25k", 16, NULL, 24576, F32, 0, ALWAYS, 5},
    {"cube-200k", 32, NULL, 196608, F32, SCENE_SIZES | SCENE_VISIBLE | SCENE_FEATURES, ALWAYS, 5},
    {"cube-200k-double", 32, NULL, 196608, F64, 0, ALWAYS, 3},
    {"cube-1.6m", 64, NULL, 1572864, F32, SCENE_SIZES | SCENE_VISIBLE | SCENE_FILE | SCENE_CELLS, ALWAYS, 3},
    {"cube-1.6m-double", 64, NULL, 1572864, F64, 0, ALWAYS, 3},
    {"cube-5m", 96, NULL, 5308416, F32, 0, ALWAYS, 3},
    {"cube-12m", 128, NULL, 12582912, F32, 0, RUN_LARGE, 3},
    {"torus-25k", 0, "torus", 20000, F32, 0, ALWAYS, 5},
    {"shell-200k", 0, "shell", 166000, F32, SCENE_VISIBLE, ALWAYS, 3},
    {"shell-650k", 0, "shell", 685000, F32, 0, ALWAYS, 3},
};

const SceneDesc *scene_get(int i) {
  return i < (int)(sizeof scenes / sizeof *scenes) ? &scenes[i] : NULL;
}

bool scene_make_body(const SceneDesc *scene, const char *program, const char *path) {
  char cells[32];
  snprintf(cells, sizeof cells, "%lld", (long long)scene->cells);
  pid_t child = fork();
  if (child == 0) {
    execl(program, program, scene->body, cells, path, (char *)NULL);
    _exit(127);
  }
  return program_wait(child);
}

bool scene_load(BenchMesh *mesh, const SceneDesc *scene, const char *path) {
  return scene->n > 0 ? bench_mesh_cube(mesh, scene->n, scene->type) : bench_mesh_load(mesh, path);
}

TetcastCamera scene_camera(TetcastProjection projection) {
  const double direction[3] = {0.53, -0.41, 0.74};
  TetcastCamera camera = {
      .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .projection = projection, .fovy = 30, .height = 1.8};
  for (int k = 0; k < 3; k++) {
    camera.eye[k] = 0.5 + 3.2 * direction[k];
  }
  return camera;
}

#define VIRIDIS                                                                                                        \
  {                                                                                                                    \
    {0, 0.267, 0.005, 0.329}, {0.25, 0.231, 0.318, 0.545}, {0.5, 0.129, 0.569, 0.549}, {0.75, 0.369, 0.788, 0.384}, {  \
      1, 0.992, 0.906, 0.145                                                                                           \
    }                                                                                                                  \
  }

const Transfer transfer_soft = {"soft", 5, 4, VIRIDIS, {{0, 0.02}, {0.4, 0.1}, {0.6, 0.2}, {1, 0.7}}, 0.2};
const Transfer transfer_softer = {"softer", 5, 4, VIRIDIS, {{0, 0.01}, {0.4, 0.05}, {0.6, 0.1}, {1, 0.35}}, 0.2};
const Transfer transfer_sharp = {
    "sharp", 5, 6, VIRIDIS, {{0.34, 0}, {0.35, 1}, {0.36, 0}, {0.67, 0}, {0.68, 1}, {0.69, 0}}, 5e-4};
const Transfer transfer_linear = {"one piece", 1, 2, {{0, 0.9, 0.8, 0.7}}, {{-1, 0}, {2, 1}}, 0.25};
const Transfer transfer_blend = {"one piece, two colours", 2,   2, {{-1, 0.9, 0.2, 0.1}, {2, 0.1, 0.6, 0.9}},
                                 {{-1, 0}, {2, 1}},        0.25};

Transfer transfer_above(double threshold) {
  Transfer transfer = transfer_soft;
  const double opacity[4][2] = {{-1, 0}, {threshold, 0}, {threshold / 2 + 1, 0.4}, {3, 0.4}};
  for (int i = 0; i < 4; i++) {
    transfer.opacity[i][0] = opacity[i][0];
    transfer.opacity[i][1] = opacity[i][1];
  }
  transfer.name = "visible above";
  return transfer;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double scene_threshold(const BenchMesh *mesh, double fraction) {
  const size_t count = (size_t)mesh->cell_count;
  double *highest = calloc(count, sizeof *highest), threshold = NAN;
  if (highest) {
    for (size_t i = 0; i < count; i++) {
      highest[i] = -INFINITY;
      for (int k = 0; k < 4; k++) {
        highest[i] = fmax(highest[i], bench_mesh_scalar(mesh, mesh->cells[i][k]));
      }
    }
    qsort(highest, count, sizeof *highest, compare);
    threshold = highest[(size_t)((double)count * (1 - fraction))];
  }
  free(highest);
  return threshold;
}

void transfer_fill(TetcastTransferFunctionDesc *desc, const Transfer *transfer) {
  desc->color = transfer->color[0];
  desc->color_count = transfer->color_count;
  desc->opacity = transfer->opacity[0];
  desc->opacity_count = transfer->opacity_count;
  desc->unit_distance = transfer->unit_distance;
  desc->opacity_model = TETCAST_OPACITY_VTK_UNSTRUCTURED;
}
