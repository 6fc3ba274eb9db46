/* SPDX-License-Identifier: Apache-2.0 */
/* What is found out about a mesh without a picture of it. */
#include <tetcast/statistics.h>

#include "jobs.h"

enum { SURFACES = 3, QUANTILES = 3 };

/* Counts with the default of 256 bins, and finds three quantiles. They have to agree with each other. */
static void measure_tetcast(const Tet *tet, Times *times) {
  static const double shares[QUANTILES] = {0.01, 0.5, 0.99};
  double found[QUANTILES], below;
  TetcastStatistics *s = NULL;
  Clock start = clock_now();
  must(tetcast_statistics_create(tet->context, tet->mesh, tet->field, NULL, &s) == TETCAST_OK, "statistics");
  times_add(&times[0], clock_since(start));
  start = clock_now();
  must(tetcast_statistics_quantiles(tet->context, tet->mesh, tet->field, shares, QUANTILES, found) == TETCAST_OK,
       "quantiles");
  times_add(&times[1], clock_since(start));
  below = s->below;
  for (int bin = 0; bin < s->bins; bin++) {
    const double high = s->range[0] + (bin + 1) * ((s->range[1] - s->range[0]) / s->bins);
    must(found[1] < high || below + s->volume[bin] <= (shares[1] + 1e-9) * s->total, "the median is too high");
    must(found[1] > high || below + s->volume[bin] >= (shares[1] - 1e-9) * s->total, "the median is too low");
    below += s->volume[bin];
  }
  tetcast_statistics_destroy(tet->context, &s);
}

static void measure_vtk(Caster *caster, Times *times) {
  double values[SURFACES];
  for (int i = 0; i < SURFACES; i++) {
    values[i] = isosurface_value(i, SURFACES);
  }
  const Clock start = clock_now();
  const int64_t triangles = caster_contour(caster, values, SURFACES);
  times_add(times, clock_since(start));
  must(triangles > 0, "VTK finds no isosurface");
}

void job_numbers(const Job *job) {
  static const struct {
    const char *task, *what, *renderer;
  } names[] = {{"statistics", "256 bins", "tetcast"},
               {"statistics", "3 quantiles", "tetcast"},
               {"isosurfaces", "3 found by vtkContourFilter", "VTK"}};
  Times times[3] = {0};
  Tet tet;
  tet_open(&tet, job->mesh, 1);
  Caster *caster = caster_create(job->mesh);
  must(caster != NULL, "VTK has no memory");
  for (int round = 0; round < job->scene->rounds; round++) {
    measure_tetcast(&tet, times);
    measure_vtk(caster, &times[2]);
  }
  for (int i = 0; i < 3; i++) {
    Row row = job->row;
    row.task = names[i].task;
    row.what = names[i].what;
    row.renderer = names[i].renderer;
    row.threads = 1;
    row.times = &times[i];
    row_write(&row);
  }
  caster_destroy(caster);
  tet_close(&tet);
}
