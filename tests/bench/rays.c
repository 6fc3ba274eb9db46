/* SPDX-License-Identifier: Apache-2.0 */
#include "jobs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is done with a list of rays: a frame of the camera's, or what gathers along them, or notes the cells. */
typedef struct Measure {
  const char *name;
  bool random, length, trace, weights;
  Times times;
  const char *isa;
  int64_t crossed;
} Measure;

typedef double Ray[6]; /* origin and direction */

static double uniform(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) * 0x1p-53;
}

/* Those through the pixels of a picture by the orthographic camera. */
static void fill_frame(const TetcastCamera *camera, int pixels, Ray *rays) {
  double forward[3], right[3], up[3], length[2] = {0};
  for (int k = 0; k < 3; k++) {
    forward[k] = camera->target[k] - camera->eye[k];
    length[0] += forward[k] * forward[k];
  }
  for (int k = 0; k < 3; k++) {
    forward[k] /= sqrt(length[0]);
  }
  for (int k = 0; k < 3; k++) {
    right[k] = forward[(k + 1) % 3] * camera->up[(k + 2) % 3] - forward[(k + 2) % 3] * camera->up[(k + 1) % 3];
    length[1] += right[k] * right[k];
  }
  for (int k = 0; k < 3; k++) {
    right[k] /= sqrt(length[1]);
  }
  for (int k = 0; k < 3; k++) {
    up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3];
  }
  for (int i = 0; i < pixels * pixels; i++) {
    const double u = ((i % pixels + 0.5) / pixels - 0.5) * camera->height,
                 v = (0.5 - (i / pixels + 0.5) / pixels) * camera->height;
    for (int k = 0; k < 3; k++) {
      rays[i][k] = camera->eye[k] + u * right[k] + v * up[k];
      rays[i][3 + k] = forward[k];
    }
  }
}

/* Through two random points of the unit cube each. */
static void fill_random(int count, Ray *rays) {
  uint64_t seed = 1;
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++) {
      const double from = uniform(&seed), to = uniform(&seed);
      rays[i][k] = from - 4 * (to - from);
      rays[i][3 + k] = to - from;
    }
  }
}

static bool count_crossings(void *user, const TetcastTrace *trace) {
  *(int64_t *)user += trace->offsets[trace->count];
  return true;
}

static void measure_once(const Tet *tet, Measure *measure, const TetcastRays *rays, double *numbers) {
  Clock start = clock_now();
  if (measure->trace) {
    TetcastTraceDesc desc = tetcast_trace_desc_default();
    desc.weights = measure->weights;
    measure->crossed = 0;
    must(tetcast_volume_trace(tet->volume, rays, &desc, count_crossings, &measure->crossed) == TETCAST_OK, "trace");
  } else {
    TetcastRenderStats stats;
    const TetcastCastResult result = {.color = measure->length ? NULL : numbers,
                                      .length = measure->length ? numbers : NULL};
    must(tetcast_scene_cast(tet->scene, rays, NULL, &result, &stats) == TETCAST_OK, "cast");
    measure->crossed = stats.segments;
    measure->isa = stats.isa;
  }
  times_add(&measure->times, clock_since(start));
}

void job_rays(const Job *job) {
  Measure measures[] = {
      {.name = "frame"},
      {.name = "the frame's rays"},
      {.name = "random rays", .random = true},
      {.name = "the length of the frame's rays", .length = true},
      {.name = "the cells of the frame's rays", .trace = true},
      {.name = "the cells and weights of the frame's rays", .trace = true, .weights = true},
      {.name = "the length of random rays", .random = true, .length = true},
      {.name = "the cells of random rays", .random = true, .trace = true},
      {.name = "the cells and weights of random rays", .random = true, .trace = true, .weights = true}};
  enum { COUNT = sizeof measures / sizeof *measures };
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  const int pixels = job->options->pixels, count = pixels * pixels;
  Tet tet;
  tet_open(&tet, job->mesh, 1);
  tet_prepare(&tet);
  tet_transfer(&tet, &transfer_soft);
  Ray *lists[2];
  TetcastRays rays[2];
  double *numbers = calloc((size_t)count, 4 * sizeof *numbers);
  must(numbers != NULL, "no memory");
  for (int i = 0; i < 2; i++) {
    lists[i] = calloc((size_t)count, sizeof *lists[i]);
    must(lists[i] != NULL, "no memory");
    rays[i] = tetcast_rays_default();
    rays[i].origins = (TetcastArray){lists[i], TETCAST_TYPE_FLOAT64, count, sizeof *lists[i]};
    rays[i].directions = (TetcastArray){&lists[i][0][3], TETCAST_TYPE_FLOAT64, count, sizeof *lists[i]};
  }
  fill_frame(&camera, pixels, lists[0]);
  fill_random(count, lists[1]);
  TetcastFrame *frame = tet_frame(&tet, pixels, TETCAST_TYPE_FLOAT64, 0);
  for (int round = 0; round < job->scene->rounds; round++) {
    TetcastRenderStats stats;
    times_add(&measures[0].times, measure_frame(job, &tet, &camera, NULL, frame, &stats));
    measures[0].crossed = stats.segments;
    measures[0].isa = stats.isa;
    for (int i = 1; i < COUNT; i++) {
      measure_once(&tet, &measures[i], &rays[measures[i].random], numbers);
    }
  }
  Row row = job->row;
  row.task = "rays";
  row.renderer = "tetcast exact";
  row.threads = 1;
  row.pixels = pixels;
  for (int i = 0; i < COUNT; i++) {
    row.what = measures[i].name;
    row.isa = measures[i].isa;
    row.times = &measures[i].times;
    row.crossed = measures[i].crossed;
    row_write(&row);
  }
  tetcast_frame_destroy(&frame);
  for (int i = 0; i < 2; i++) {
    free(lists[i]);
  }
  free(numbers);
  tet_close(&tet);
}
