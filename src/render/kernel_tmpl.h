/* SPDX-License-Identifier: Apache-2.0 */
/* The scalar kernel: one ray at a time, in double precision. It is the specification that faster kernels are tested against. Compiled
 * once for each way to integrate, so that the exact one pays nothing for the others: the including file defines
 *     ADD_POINT(light, pieces, length, s0, s1)   what is done with a segment of a point field
 *     KERNEL, CAST                               the names of the two functions */
#include <math.h>

#include "render/render.h"
#include "traverse/walk.h"

/* Adds the part from z0 to z1 of a cell, over which a point field goes from s0 to s1. */
static void add_part(const TetcastVolume *volume, const TcPieces *pieces, uint32_t cell, double z0, double z1, double s0, double s1,
                     TcWorker *worker, TcLight *light) {
  ++worker->segments;
  if (volume->association == TETCAST_CELL) {
    const double s = volume->cell_values[cell];
    if (!isnan(s)) tc_light_add_constant(light, pieces, z1 - z0, s);
  } else if (!isnan(s0) && !isnan(s1)) { /* two faces have all four vertices of the cell between them: its NaN shows */
    ADD_POINT(light, pieces, z1 - z0, s0, s1);
  }
}

/* Adds what of a segment lies beyond *seen, the depth up to which the path has been seen. Rounding, or a cell that is turned inside
 * out, can make a face's depth less than that of the face before: such a segment counts for nothing, and the next one for what
 * it has beyond. So lengths along a path add up to its last depth minus its first, whatever happens in between. */
static void add_segment(const TetcastVolume *volume, const TcPieces *pieces, uint32_t cell, double z0, double z1, double s0,
                        double s1, double *seen, TcWorker *worker, TcLight *light) {
  if (!(z1 > *seen)) return;
  if (z0 < *seen) {
    const double w = (*seen - z0) / (z1 - z0);
    s0 = (1 - w) * s0 + w * s1;
    z0 = *seen;
  }
  add_part(volume, pieces, cell, z0, z1, s0, s1, worker, light);
  *seen = z1;
}

/* A ray on its way: where it was last, and what it gathers. */
typedef struct Cast {
  const TetcastVolume *volume;
  const TcPieces *pieces;
  const TcRay *ray;
  TcWorker *worker;
  TcLight *light;
  double z, s, seen;
} Cast;

static void enter_path(void *data, const TcWalk *walk) {
  Cast *cast = data;
  cast->z = walk->z;
  cast->s = walk->s;
  cast->seen = cast->ray->near > walk->z ? cast->ray->near : walk->z;
}

static bool cross_cell(void *data, uint32_t cell, const TcWalk *walk) {
  Cast *cast = data;
  add_segment(cast->volume, cast->pieces, cell, cast->z, walk->z, cast->s, walk->s, &cast->seen, cast->worker, cast->light);
  cast->z = walk->z;
  cast->s = walk->s;
  return !tc_light_opaque(cast->light, cast->pieces);
}

static void cast_shell(const TcShell *shell, const TcPieces *pieces, const TcRay *ray, TcWorker *worker, TcLight *light) {
  Cast cast = {.volume = shell->volume, .pieces = pieces, .ray = ray, .worker = worker, .light = light};
  worker->lost += !tc_walk_paths(shell, ray, worker->spans, enter_path, cross_cell, &cast);
}

static void cast_faces(const TetcastVolume *volume, const TcPieces *pieces, const TcRay *ray, TcWorker *worker, TcLight *light) {
  for (int64_t i = 0; i < worker->spans->count && !tc_light_opaque(light, pieces); ++i) {
    const TcSpan *span = &worker->spans->data[i];
    double seen = ray->near > span->begin ? ray->near : span->begin;
    add_segment(volume, pieces, span->id, span->begin, span->end, span->s0, span->s1, &seen, worker, light);
  }
}

bool CAST(const TcShell *shell, const TcPieces *pieces, const TcLine *line, TcWorker *worker, TcLight *light) {
  const TetcastVolume *volume = shell->volume;
  TcRay ray;
  *light = tc_light_begin(worker->tolerance.thin, worker->tolerance.opaque);
  if (!tc_ray_begin(volume, line, &ray)) return true;
  if (!tc_trace(shell, &ray, worker->spans)) return false;
  if (volume->traversal == TETCAST_TRAVERSAL_SHELL) cast_shell(shell, pieces, &ray, worker, light);
  else cast_faces(volume, pieces, &ray, worker, light);
  return true;
}

bool KERNEL(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) {
  const int samples = job->samples_x * job->samples_y;
  for (int64_t y = y0; y < y1; ++y) {
    for (int64_t x = x0; x < x1; ++x) {
      double sum[4] = {0, 0, 0, 0}, error = 0;
      for (int i = 0; i < samples; ++i) {
        double rgba[4];
        const int64_t segments = worker->segments;
        TcLine line;
        TcLight light;
        tc_job_line(job, x, y, i, &line);
        if (!CAST(job->shell, job->pieces, &line, worker, &light)) return false;
        tc_light_end(&light, rgba);
        error += tc_tolerance_bound(&worker->tolerance, &light, rgba[3], worker->segments - segments);
        for (int k = 0; k < 4; ++k) sum[k] += rgba[k];
      }
      for (int k = 0; k < 4; ++k) sum[k] /= samples;
      error = tc_frame_store(job->frame, x, y, sum, error / samples);
      if (!(error <= worker->error)) worker->error = error;
    }
  }
  return true;
}
