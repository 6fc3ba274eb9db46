/* SPDX-License-Identifier: Apache-2.0 */
#include "jobs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One that makes pictures, and what was measured of it. */
typedef struct Contender {
  const char *name;
  bool vtk;
  CasterIntegrator integrator;
  double tolerance;
  TetcastIsa isa; /* not the fastest one */
  int threads;
  Times frame, view; /* a picture; the part of it that VTK spends before it casts rays */
  Times transfer;    /* VTK's readiness for another transfer function */
  int64_t crossed;   /* cells */
  TetcastRenderStats stats;
  double largest_error, mean_square; /* against tetcast's exact picture */
  double bound;                      /* on the error, by tetcast itself */
  int64_t not_numbers;               /* pixels; not in the errors */
  int64_t off;                       /* pixels that are no number or further off than OFF */
} Contender;

static const double OFF = 1e-4;

static const Contender all[] = {
    {.name = "tetcast exact", .threads = 1},
    {.name = "tetcast 1e-6", .tolerance = 1e-6, .threads = 1},
    {.name = "tetcast 1e-4", .tolerance = 1e-4, .threads = 1},
    {.name = "tetcast 1e-3", .tolerance = 1e-3, .threads = 1},
    {.name = "tetcast 1e-2", .tolerance = 1e-2, .threads = 1},
    {.name = "tetcast exact", .threads = 2},
    {.name = "tetcast exact", .isa = TETCAST_ISA_AVX2, .threads = 1},
    {.name = "tetcast exact", .isa = TETCAST_ISA_SCALAR, .threads = 1},
    {.name = "VTK linear", .vtk = true, .integrator = CASTER_LINEAR, .threads = 1},
    {.name = "VTK partial", .vtk = true, .integrator = CASTER_PARTIAL, .threads = 1},
    {.name = "VTK table", .vtk = true, .integrator = CASTER_PRE, .threads = 1},
};
enum { CONTENDERS = sizeof all / sizeof *all };

/* Which of them take part. */
typedef enum Field { FIELD_ALL, FIELD_TWO } Field;

static bool takes_part(const Contender *contender, Field field) {
  return field == FIELD_ALL ||
         (contender->vtk ? contender->integrator == CASTER_LINEAR : contender->tolerance == 0 && !contender->isa);
}

/* A mesh ready for both. */
typedef struct Arena {
  Tet tet;
  Caster *caster;
} Arena;

Clock measure_frame(const Job *job, Tet *tet, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                    TetcastFrame *frame, TetcastRenderStats *stats) {
  Times times = {0};
  double sum = 0;
  do {
    Clock time = tet_render(tet, camera, desc, frame, stats);
    times_add(&times, time);
    sum += time.wall;
  } while (sum < job->options->least && times.wall.count < SAMPLES);
  return times_median(&times);
}

static void compare(Contender *contender, const double *exact, const double *tetcast, const float *vtk,
                    int64_t pixels) {
  contender->largest_error = contender->mean_square = 0;
  contender->not_numbers = contender->off = 0;
  for (int64_t i = 0; i < pixels; i++) {
    double largest = 0, sum = 0;
    for (int k = 0; k < 4; k++) {
      double error = fabs((vtk ? (double)vtk[4 * i + k] : tetcast[4 * i + k]) - exact[4 * i + k]);
      largest = isnan(error) ? error : fmax(largest, error);
      sum += error * error / 4;
      if (isnan(error)) {
        break;
      }
    }
    contender->off += !(largest <= OFF);
    if (isnan(sum)) {
      contender->not_numbers++;
    } else {
      contender->largest_error = fmax(contender->largest_error, largest);
      contender->mean_square += sum / (double)pixels;
    }
  }
}

/* Eight bits over black, to be looked at. */
static void write_picture(const Job *job, const char *name, const double *tetcast, const float *vtk, int pixels) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s-%s-%s.ppm", job->options->folder, job->scene->name, job->row.what, name);
  for (char *c = path + strlen(job->options->folder); *c; c++) {
    *c = *c == ' ' ? '-' : *c;
  }
  FILE *file = fopen(path, "wb");
  must(file != NULL, "a picture can't be written");
  fprintf(file, "P6\n%d %d\n255\n", pixels, pixels);
  for (int64_t i = 0; i < (int64_t)pixels * pixels; i++) {
    for (int k = 0; k < 3; k++) {
      double value = vtk ? (double)vtk[4 * i + k] : tetcast[4 * i + k];
      fputc((int)(255 * fmin(fmax(value, 0), 1) + 0.5), file);
    }
  }
  must(fclose(file) == 0, "a picture can't be written");
}

static void write_rows(const Job *job, const Contender *contender, bool all_of_it) {
  Row row = job->row;
  row.renderer = contender->name;
  row.threads = contender->threads;
  row.crossed = contender->crossed;
  row.task = "frame";
  row.times = &contender->frame;
  row.largest_error = contender->largest_error;
  row.rms_error = sqrt(contender->mean_square);
  row.off = contender->off;
  if (!contender->vtk) {
    row.isa = contender->stats.isa;
    row.precision = contender->stats.precision;
    row.error_bound = contender->bound;
  }
  row_write(&row);
  if (contender->vtk && all_of_it) {
    row = job->row;
    row.renderer = contender->name;
    row.threads = contender->threads;
    row.task = "view";
    row.times = &contender->view;
    row_write(&row);
    row.task = "transfer function";
    row.times = &contender->transfer;
    row_write(&row);
  }
}

/* A benchmark of wrong pictures is worth nothing. VTK loses a ray now and then where it grazes an edge; apart from
 * that, through a soft transfer function, its linear integrator and tetcast must mean the same picture. */
static void check(const Job *job, const Contender *contender, const Contender *exact, bool comparable, int64_t pixels) {
  if (!contender->vtk) {
    must(contender->stats.lost == 0, "tetcast lost a ray");
    must(contender->not_numbers == 0, "tetcast made pixels that are not numbers");
    const double allowed = contender->isa ? 1e-12 : contender->tolerance;
    must(contender->largest_error <= allowed, "tetcast is further from its exact picture than it may be");
  } else if (comparable && contender->integrator == CASTER_LINEAR) {
    const double off = (double)contender->off / (double)pixels,
                 crossed = (double)contender->crossed / (double)exact->crossed;
    const bool same = off < 0.005 && fabs(crossed - 1) < 0.005;
    if (!same) {
      fprintf(stderr, "tetcast_bench: %s: %.3g %% of the pixels differ, VTK crosses %.5g times as many cells\n",
              job->scene->name, 100 * off, crossed);
    }
    must(same, "tetcast and VTK make different pictures");
  }
}

static void measure_tetcast(const Job *job, Arena *arena, const TetcastCamera *camera, Contender *contender,
                            TetcastFrame *frame) {
  must(tetcast_context_set_threads(arena->tet.context, contender->threads) == TETCAST_OK, "threads");
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.tolerance = contender->tolerance;
  desc.isa = contender->isa;
  times_add(&contender->frame, measure_frame(job, &arena->tet, camera, &desc, frame, &contender->stats));
  contender->crossed = contender->stats.segments;
}

/* What tetcast says of its own error, which takes a picture with the channel for it. */
static void ask_for_bound(Arena *arena, const TetcastCamera *camera, int pixels, Contender *contender) {
  TetcastFrame *frame = tet_frame(&arena->tet, pixels, TETCAST_TYPE_FLOAT64, TETCAST_CHANNEL_ERROR);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  TetcastRenderStats stats;
  desc.tolerance = contender->tolerance;
  desc.isa = contender->isa;
  tet_render(&arena->tet, camera, &desc, frame, &stats);
  contender->bound = stats.error;
  tetcast_frame_destroy(&frame);
}

static void measure_vtk(Arena *arena, const TetcastCamera *camera, int pixels, Contender *contender,
                        const Transfer *transfer, float *picture) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  transfer_fill(&desc, transfer);
  Clock start = clock_now();
  must(caster_transfer(arena->caster, &desc, contender->integrator), "VTK has no memory");
  times_add(&contender->transfer, clock_since(start));
  start = clock_now();
  must(caster_view(arena->caster, camera, pixels, pixels), "VTK has no memory");
  times_add(&contender->view, clock_since(start));
  contender->crossed = caster_cast(arena->caster, picture);
  times_add(&contender->frame, clock_since(start));
}

static void frames(Job job, Arena *arena, Field field, const Transfer *transfer, TetcastCamera camera, int pixels) {
  Contender contenders[CONTENDERS];
  memcpy(contenders, all, sizeof all);
  job.row.pixels = pixels;
  const int64_t count = (int64_t)pixels * pixels;
  const bool comparable =
      transfer == &transfer_soft && camera.projection == TETCAST_ORTHOGRAPHIC; /* see scene_camera() */
  double *exact = calloc((size_t)count, 4 * sizeof *exact);
  float *vtk = calloc((size_t)count, 4 * sizeof *vtk);
  must(exact && vtk, "no memory for pictures");
  TetcastFrame *frame = tet_frame(&arena->tet, pixels, TETCAST_TYPE_FLOAT64, 0);
  tet_transfer(&arena->tet, transfer);
  for (int round = 0; round < job.scene->rounds; round++) {
    for (int i = 0; i < CONTENDERS; i++) {
      if (!takes_part(&contenders[i], field)) {
        continue;
      }
      const double *tetcast = tetcast_frame_pixels(frame);
      if (contenders[i].vtk) {
        measure_vtk(arena, &camera, pixels, &contenders[i], transfer, vtk);
      } else {
        measure_tetcast(&job, arena, &camera, &contenders[i], frame);
      }
      if (round == 0) {
        if (i == 0) {
          memcpy(exact, tetcast, 4 * (size_t)count * sizeof *exact);
        }
        if (!contenders[i].vtk) {
          ask_for_bound(arena, &camera, pixels, &contenders[i]);
        }
        compare(&contenders[i], exact, tetcast, contenders[i].vtk ? vtk : NULL, count);
        check(&job, &contenders[i], &contenders[0], comparable, count);
        if (job.options->pictures && field == FIELD_ALL && !contenders[i].isa) {
          write_picture(&job, contenders[i].name, tetcast, contenders[i].vtk ? vtk : NULL, pixels);
        }
      }
    }
  }
  for (int i = 0; i < CONTENDERS; i++) {
    const Contender *contender = &contenders[i]; /* on another machine the fastest may be the next one's */
    if (takes_part(contender, field) &&
        (!contender->isa || strcmp(contender->stats.isa, contenders[0].stats.isa) != 0)) {
      write_rows(&job, contender, field == FIELD_ALL);
    }
  }
  tetcast_frame_destroy(&frame);
  free(exact);
  free(vtk);
}

/* VTK prepares a mesh within its first view; what is left of that without a view is counted. */
static void prepare(const Job *job, Arena *arena) {
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  Row row = job->row;
  Times times[2] = {0}, vtk = {0};
  for (int round = 0; round < job->scene->rounds; round++) {
    for (int threads = 2; threads >= 1; threads--) {
      must(tetcast_context_set_threads(arena->tet.context, threads) == TETCAST_OK, "threads");
      times_add(&times[threads - 1], tet_prepare(&arena->tet));
    }
  }
  row.task = "prepare";
  row.renderer = "tetcast";
  for (int threads = 1; threads <= 2; threads++) {
    row.threads = threads;
    row.times = &times[threads - 1];
    row_write(&row);
  }
  Clock start = clock_now();
  arena->caster = caster_create(job->mesh);
  must(arena->caster && caster_view(arena->caster, &camera, job->options->pixels, job->options->pixels),
       "VTK has no memory");
  Clock first = clock_since(start);
  start = clock_now();
  must(caster_view(arena->caster, &camera, job->options->pixels, job->options->pixels), "VTK has no memory");
  Clock view = clock_since(start);
  times_add(&vtk, (Clock){.wall = first.wall - view.wall, .cpu = first.cpu - view.cpu});
  row.renderer = "VTK";
  row.threads = 1;
  row.times = &vtk;
  row_write(&row);
}

void job_frames(const Job *given) {
  Job job = *given;
  Arena arena = {0};
  tet_open(&arena.tet, job.mesh, 1);
  prepare(&job, &arena);
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  const Transfer *transfers[2] = {&transfer_soft, &transfer_sharp};
  for (int i = 0; i < 2; i++) {
    job.row.what = transfers[i]->name;
    frames(job, &arena, FIELD_ALL, transfers[i], camera, job.options->pixels);
  }
  if (job.scene->work & SCENE_SIZES) {
    job.row.what = transfer_soft.name;
    frames(job, &arena, FIELD_TWO, &transfer_soft, camera, job.options->pixels / 2);
    frames(job, &arena, FIELD_TWO, &transfer_soft, camera, job.options->pixels * 2);
    job.row.what = "soft perspective";
    frames(job, &arena, FIELD_TWO, &transfer_soft, scene_camera(TETCAST_PERSPECTIVE), job.options->pixels);
  }
  caster_destroy(arena.caster);
  tet_close(&arena.tet);
}
