/* SPDX-License-Identifier: Apache-2.0 */
/* What the studies of convergence share: rows, timing, errors, slopes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "converge.h"
#include "progress.h"

ConvergeRow *converge_plan(Converge *converge, ConvergeRow row) {
  converge->rows = cli_grow(converge->rows, converge->count, &converge->capacity, sizeof *converge->rows);
  row.bound = (double)NAN; /* unless the library states one */
  converge->rows[converge->count] = row;
  return &converge->rows[converge->count++];
}

static bool advance(void *user, double fraction) {
  const Converge *converge = user;
  return cli_progress_show((converge->done + converge->step * fraction) / converge->work);
}

TetcastProgress converge_progress(Converge *converge, double weight) {
  converge->done += converge->step;
  converge->step = weight;
  return (TetcastProgress){.function = advance, .user = converge};
}

/* Takes one more time into the row. */
static void add_time(ConvergeRow *row, double seconds) {
  if (!row->times)
    row->times = cli_allocate(sizeof *row->times * (size_t)row->repeats);
  int at = row->timed++;
  for (; at > 0 && row->times[at - 1] > seconds; at--)
    row->times[at] = row->times[at - 1];
  row->times[at] = seconds;
  row->seconds = (row->times[(row->timed - 1) / 2] + row->times[row->timed / 2]) / 2;
}

/* Finds the bound on the picture's error. That takes longer than the picture alone, so it is not timed. */
static TetcastStatus find_bound(Converge *converge, const TetcastScene *scene, const TetcastCamera *camera,
                                TetcastRenderDesc desc, const TetcastFrame *like, double *bound) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = tetcast_frame_width(like);
  frame_desc.height = tetcast_frame_height(like);
  frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = NULL;
  TetcastRenderStats stats = {.error = NAN};
  desc.progress = converge_progress(converge, 0);
  TetcastStatus status = tetcast_frame_create(converge->context, &frame_desc, &frame);
  if (status == TETCAST_OK)
    status = tetcast_scene_render(scene, camera, &desc, frame, &stats);
  tetcast_frame_destroy(&frame);
  *bound = stats.error;
  return status;
}

TetcastStatus converge_render(Converge *converge, const TetcastScene *scene, const TetcastCamera *camera,
                              TetcastFrame *frame, ConvergeRow *row, double weight) {
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.integrator = row->integrator;
  if (row->n > 0)
    desc.integrator_n = row->n;
  desc.isa = row->study == STUDY_TIME && !row->packets ? TETCAST_ISA_SCALAR : (TetcastIsa)converge->options.isa;
  desc.tolerance = row->tolerance;
  desc.adaptive_coarse = row->adaptive > 0 ? 4 : 0;
  desc.adaptive_epsilon = row->adaptive;
  desc.progress = converge_progress(converge, weight);
  TetcastRenderStats stats;
  const double start = cli_seconds();
  const TetcastStatus status = tetcast_scene_render(scene, camera, &desc, frame, &stats);
  if (status != TETCAST_OK || cli_interrupted())
    return status == TETCAST_OK ? TETCAST_ERROR_CANCELLED : status;
  add_time(row, cli_seconds() - start);
  row->segments = stats.segments;
  row->precision = stats.precision;
  row->isa = stats.isa;
  converge->lost += stats.lost;
  if (!isnan(stats.error))
    row->bound = stats.error;
  return row->integrator == TETCAST_INTEGRATOR_EXACT && isnan(stats.error) && row->adaptive == 0 && row->timed == 1
             ? find_bound(converge, scene, camera, desc, frame, &row->bound)
             : TETCAST_OK;
}

void converge_compare(ConvergeRow *row, const double *picture, const double *truth, int64_t count) {
  double largest = 0, squares = 0;
  bool finite = true;
  for (int64_t i = 0; i < count; i++) {
    const double error = fabs(picture[i] - truth[i]);
    finite = finite && isfinite(error);
    largest = fmax(largest, error);
  }
  for (int64_t i = 0; i < count && largest > 0; i++) { /* relative to the largest: squares may overflow and underflow */
    const double part = (picture[i] - truth[i]) / largest;
    squares += part * part;
  }
  row->max_error = finite ? largest : (double)INFINITY;
  row->rms_error = finite ? largest * sqrt(squares / (double)count) : (double)INFINITY;
}

const char *converge_name(const ConvergeRow *row) {
  static const char *const names[] = {"exact", "midpoint", "trapezoid", "gauss", "table"};
  return row->tolerance > 0 ? "tolerance" : row->adaptive > 0 ? "adaptive" : names[row->integrator];
}

const ConvergeRow *converge_packets(const Converge *converge) {
  for (int i = 0; i < converge->count; i++)
    if (converge->rows[i].packets)
      return &converge->rows[i];
  return NULL;
}

double converge_slope(const Converge *converge, ConvergeStudy study, TetcastIntegrator integrator, bool rms) {
  const double clear = 1e-13; /* of rounding */
  const int least = study != STUDY_TIME ? 0 : integrator == TETCAST_INTEGRATOR_TABLE ? 16 : 4;
  int count = 0;
  double x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (int i = 0; i < converge->count; i++) {
    const ConvergeRow *row = &converge->rows[i];
    const double error = rms ? row->rms_error : row->max_error;
    if (row->study != study || row->integrator != integrator || row->tolerance > 0 || row->n < least ||
        !(error > clear))
      continue;
    const double x = study == STUDY_TIME ? log(row->n) : -log(row->level), y = log(error);
    count++;
    x1 += x;
    y1 += y;
    xx += x * x;
    xy += x * y;
  }
  const double spread = count * xx - x1 * x1;
  return count < 2 || !(spread > 0) ? (double)NAN : (count * xy - x1 * y1) / spread;
}
