/* SPDX-License-Identifier: Apache-2.0 */
/* Clocks, samples, and the lines of results.csv. */
#ifndef BENCH_ROWS_H
#define BENCH_ROWS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Clock {
  double wall, cpu; /* seconds; cpu: of all threads of the process */
} Clock;

Clock clock_now(void);
Clock clock_since(Clock start);

/* The largest resident memory of this process so far. */
double peak_bytes(void);

enum { SAMPLES = 64 };

typedef struct Sample {
  int count;
  double values[SAMPLES];
} Sample;

void sample_add(Sample *sample, double value);                 /* beyond SAMPLES: dropped */
double sample_quantile(const Sample *sample, double fraction); /* between values in proportion; NaN without values */
double sample_median(const Sample *sample);

/* The same thing timed several times. */
typedef struct Times {
  Sample wall, cpu;
} Times;

void times_add(Times *times, Clock time);
Clock times_median(const Times *times);

/* A line: one thing that was measured. What is NULL, NaN or negative is left empty. */
typedef struct Row {
  FILE *file;
  const char *scene;
  int64_t cells, vertices;
  const char *task, *what; /* "frame" etc.; the transfer function or what else was varied */
  int pixels;              /* width = height; 0: no picture */
  const char *renderer;
  int threads;
  const char *isa, *precision;
  const Times *times;
  int64_t crossed;                              /* cells crossed */
  double largest_error, rms_error, error_bound; /* of a channel of a pixel */
  int64_t off;                                  /* pixels with a channel further off than 1e-4, or no number */
  double resident, peak;                        /* bytes */
  int64_t shell_faces;
} Row;

/* A row in which only these are filled in. */
Row row_empty(FILE *file, const char *scene, int64_t cells, int64_t vertices);
void row_write_names(FILE *file);
void row_write(const Row *row);

/* Ends the program with a line on stderr unless `ok`. */
void must(bool ok, const char *what);

#ifdef __cplusplus
}
#endif

#endif
