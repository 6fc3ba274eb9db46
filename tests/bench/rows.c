/* SPDX-License-Identifier: Apache-2.0 */
#include "rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double seconds(clockid_t id) {
  struct timespec time;
  clock_gettime(id, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

Clock clock_now(void) {
  return (Clock){.wall = seconds(CLOCK_MONOTONIC), .cpu = seconds(CLOCK_PROCESS_CPUTIME_ID)};
}

Clock clock_since(Clock start) {
  Clock now = clock_now();
  return (Clock){.wall = now.wall - start.wall, .cpu = now.cpu - start.cpu};
}

double peak_bytes(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  return (double)usage.ru_maxrss;
#else
  return 1024 * (double)usage.ru_maxrss;
#endif
}

void sample_add(Sample *sample, double value) {
  if (sample->count < SAMPLES) {
    sample->values[sample->count++] = value;
  }
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double sample_quantile(const Sample *sample, double fraction) {
  if (sample->count == 0) {
    return NAN;
  }
  double sorted[SAMPLES];
  const size_t n = (size_t)sample->count;
  memcpy(sorted, sample->values, n * sizeof *sorted);
  qsort(sorted, n, sizeof *sorted, compare);
  const double at = fraction * (double)(n - 1);
  const size_t below = (size_t)at, above = below + 1 < n ? below + 1 : below;
  return sorted[below] + (at - (double)below) * (sorted[above] - sorted[below]);
}

double sample_median(const Sample *sample) {
  return sample_quantile(sample, 0.5);
}

void times_add(Times *times, Clock time) {
  sample_add(&times->wall, time.wall);
  sample_add(&times->cpu, time.cpu);
}

Clock times_median(const Times *times) {
  return (Clock){.wall = sample_median(&times->wall), .cpu = sample_median(&times->cpu)};
}

Row row_empty(FILE *file, const char *scene, int64_t cells, int64_t vertices) {
  return (Row){.file = file,
               .scene = scene,
               .cells = cells,
               .vertices = vertices,
               .task = "",
               .what = "",
               .renderer = "",
               .crossed = -1,
               .largest_error = NAN,
               .rms_error = NAN,
               .error_bound = NAN,
               .off = -1,
               .resident = NAN,
               .peak = NAN,
               .shell_faces = -1};
}

void row_write_names(FILE *file) {
  fprintf(file, "scene,tetrahedra,vertices,task,case,pixels,renderer,threads,isa,precision,rounds,wall_s,cpu_s,cpu_min_"
                "s,cpu_max_s,"
                "cells_crossed,largest_error,rms_error,error_bound,pixels_off,resident_bytes,peak_bytes,shell_faces\n");
}

static void put_text(FILE *file, const char *text) {
  fprintf(file, "%s,", text ? text : "");
}

static void put_count(FILE *file, int64_t count, int64_t least) {
  if (count >= least) {
    fprintf(file, "%lld", (long long)count);
  }
  fputc(',', file);
}

static void put_value(FILE *file, double value, int digits) {
  if (!isnan(value)) {
    fprintf(file, "%.*g", digits, value);
  }
  fputc(',', file);
}

void row_write(const Row *row) {
  static const Times none;
  const Times *times = row->times ? row->times : &none;
  const Clock median = times_median(times);
  double low = NAN, high = NAN;
  for (int i = 0; i < times->cpu.count; i++) {
    low = fmin(low, times->cpu.values[i]); /* of a NaN and a number fmin takes the number */
    high = fmax(high, times->cpu.values[i]);
  }
  put_text(row->file, row->scene);
  put_count(row->file, row->cells, 0);
  put_count(row->file, row->vertices, 0);
  put_text(row->file, row->task);
  put_text(row->file, row->what);
  put_count(row->file, row->pixels, 1);
  put_text(row->file, row->renderer);
  put_count(row->file, row->threads, 1);
  put_text(row->file, row->isa);
  put_text(row->file, row->precision);
  put_count(row->file, times->wall.count, 1);
  put_value(row->file, median.wall, 4);
  put_value(row->file, median.cpu, 4);
  put_value(row->file, low, 4);
  put_value(row->file, high, 4);
  put_count(row->file, row->crossed, 0);
  put_value(row->file, row->largest_error, 3);
  put_value(row->file, row->rms_error, 3);
  put_value(row->file, row->error_bound, 3);
  put_count(row->file, row->off, 0);
  put_value(row->file, row->resident, 12);
  put_value(row->file, row->peak, 12);
  if (row->shell_faces >= 0) {
    fprintf(row->file, "%lld", (long long)row->shell_faces);
  }
  fputc('\n', row->file);
  fflush(row->file);
}

void must(bool ok, const char *what) {
  if (!ok) {
    fprintf(stderr, "tetcast_bench: %s\n", what);
    exit(1);
  }
}
