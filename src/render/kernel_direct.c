/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel for coefficients: one ray at a time, all groups of it, in double precision. A group's numbers don't depend on
 * what others there are. */
#include <math.h>
#include <string.h>

#include "optics/beam.h"
#include "render/render.h"
#include "traverse/walk.h"

/* A ray on its way, and the pixel it belongs to. One for each worker, with room for all groups. */
typedef struct TcDirect {
  TetcastContext *context;
  const TcCoefficients *coefficients;
  const TcRay *ray;
  bool to_the_end;     /* what the frame wants is not complete where all groups are opaque */
  int64_t segments;
  double z, seen;      /* depth of the face before; up to which the path has been seen */
  double length, lost; /* of the path, and what rounding has taken from it (Kahan) */
  TcBeam *beams;       /* [groups] */
  double *near, *far;  /* [values] at the face before and at this one */
  double *sums;        /* [3][groups]: radiance, optical depth, transmittance, means over a pixel's samples */
  double memory[];
} TcDirect;

TcDirect *tc_direct_create(TetcastContext *context, const TcCoefficients *c) {
  const int64_t values = tc_coefficients_values(c), groups = c->groups;
  const int64_t beams = groups * (int64_t)(sizeof(TcBeam) / sizeof(double)), numbers = beams + 2 * values + 3 * groups;
  TcDirect *direct = tc_allocate(context, 1, sizeof *direct + (size_t)numbers * sizeof(double));
  if (!direct) return NULL;
  *direct = (TcDirect){.context = context, .coefficients = c};
  memset(direct->memory, 0, (size_t)numbers * sizeof(double));
  direct->beams = (TcBeam *)direct->memory;
  direct->near = direct->memory + beams;
  direct->far = direct->near + values;
  direct->sums = direct->far + values;
  return direct;
}

void tc_direct_destroy(TcDirect *direct) {
  if (direct) tc_release(direct->context, direct);
}

/* Adds a segment from values `near` to `far` to every group. Its extinction, if it is that of the group before, is not evaluated again. */
static void add_groups(TcDirect *direct, double length) {
  const TcCoefficients *c = direct->coefficients;
  const double *near = direct->near, *far = direct->far;
  TcMoments m = {.m0 = 0.5, .m1 = 0.5, .transmittance = 1, .depth = 0};
  int known = -1;
  bool transparent = false;
  for (int g = 0; g < c->groups; ++g) {
    const int extinction = c->slots[g], emission = c->slots[c->groups + g];
    if (extinction != known) {
      known = extinction;
      const double a = tc_coefficients_scaled(c, near[extinction]) * length, a1 = tc_coefficients_scaled(c, far[extinction]) * length;
      transparent = isnan(a) || isnan(a1);
      if (!transparent && c->emission_count) m = tc_segment_moments(a, a1);
      else if (!transparent) m.depth = 0.5 * a + 0.5 * a1;
    }
    if (transparent) continue;
    double radiance = 0;
    if (emission >= 0)
      radiance = length * (near[emission] * c->emission_scale * m.m0 + far[emission] * c->emission_scale * m.m1);
    if (isnan(radiance)) continue;
    tc_beam_add(&direct->beams[g], radiance, m.depth, m.transmittance);
  }
}

/* Adds what of the cell lies beyond what was seen (see kernel_tmpl.h), up to depth z1. */
static void add_cell(TcDirect *direct, uint32_t cell, double z1) {
  const TcCoefficients *c = direct->coefficients;
  if (!(z1 > direct->seen)) return;
  double z0 = direct->z;
  tc_coefficients_in(c, cell, direct->near);
  tc_coefficients_in(c, cell, direct->far);
  if (z0 < direct->seen) {
    const double w = (direct->seen - z0) / (z1 - z0);
    for (int i = 0; i < c->points.width; ++i) direct->near[i] = (1 - w) * direct->near[i] + w * direct->far[i];
    z0 = direct->seen;
  }
  const double more = z1 - z0 - direct->lost, length = direct->length + more;
  direct->lost = (length - direct->length) - more;
  direct->length = length;
  direct->seen = z1;
  ++direct->segments;
  add_groups(direct, z1 - z0);
}

static void enter_path(void *data, const TcWalk *face) {
  TcDirect *direct = data;
  tc_coefficients_at(direct->coefficients, face, direct->near);
  direct->z = face->z;
  direct->seen = direct->ray->near > face->z ? direct->ray->near : face->z;
}

static bool is_complete(const TcDirect *direct) {
  if (direct->to_the_end) return false;
  for (int g = 0; g < direct->coefficients->groups; ++g) {
    if (!tc_beam_opaque(&direct->beams[g])) return false;
  }
  return true;
}

static bool cross_cell(void *data, uint32_t cell, const TcWalk *face) {
  TcDirect *direct = data;
  tc_coefficients_at(direct->coefficients, face, direct->far);
  add_cell(direct, cell, face->z);
  double *const before = direct->near;
  direct->near = direct->far;
  direct->far = before;
  direct->z = face->z;
  return !is_complete(direct);
}

static void cast_faces(const TcShell *shell, const TcSpans *spans, TcDirect *direct) {
  for (int64_t i = 0; i < spans->count && !is_complete(direct); ++i) {
    TcWalk face[2];
    if (!tc_cross_cell(shell->volume, direct->ray, spans->data[i].id, face)) continue;
    enter_path(direct, &face[0]);
    cross_cell(direct, spans->data[i].id, &face[1]);
  }
}

/* False: out of memory. */
static bool cast(const TcShell *shell, const TcLine *line, TcWorker *worker) {
  TcDirect *direct = worker->direct;
  TcRay ray;
  for (int g = 0; g < direct->coefficients->groups; ++g) direct->beams[g] = tc_beam_begin();
  direct->length = direct->lost = 0;
  if (!tc_ray_begin(shell->volume, line, &ray)) return true;
  if (!tc_trace(shell, &ray, worker->spans)) return false;
  direct->ray = &ray;
  if (shell->volume->traversal == TETCAST_TRAVERSAL_FACES) cast_faces(shell, worker->spans, direct);
  else worker->lost += !tc_walk_paths(shell, &ray, worker->spans, enter_path, cross_cell, direct);
  return true;
}

/* Red, green, blue, alpha from the groups' radiances and the sum of their opacities. */
static void color_of(const TcCoefficients *c, const double *radiance, double opacity, double rgba[4]) {
  double mean = 0;
  for (int g = 0; g < c->groups; ++g)
    mean += radiance[g] / c->groups; /* whose sum might overflow */
  for (int k = 0; k < 3; ++k) rgba[k] = c->groups == 3 ? radiance[k] : mean;
  rgba[3] = opacity;
}

static void store(const TcJob *job, int64_t x, int64_t y, TcDirect *direct, double opacity, double length) {
  const TcCoefficients *c = direct->coefficients;
  const int exponent = job->shell->volume->exponent;
  double *radiance = direct->sums, *depth = radiance + c->groups, *transmittance = depth + c->groups, rgba[4];
  for (int g = 0; g < c->groups; ++g)
    radiance[g] = ldexp(radiance[g], exponent + c->emission_exponent);
  length = ldexp(length, exponent);
  color_of(c, radiance, opacity, rgba);
  tc_frame_store(job->frame, x, y, rgba, 0);
  tc_frame_put(job->frame, TETCAST_CHANNEL_RADIANCE, x, y, radiance);
  tc_frame_put(job->frame, TETCAST_CHANNEL_OPTICAL_DEPTH, x, y, depth);
  tc_frame_put(job->frame, TETCAST_CHANNEL_TRANSMITTANCE, x, y, transmittance);
  tc_frame_put(job->frame, TETCAST_CHANNEL_PATH_LENGTH, x, y, &length);
}

static bool render_pixel(const TcJob *job, int64_t x, int64_t y, TcWorker *worker) {
  TcDirect *direct = worker->direct;
  const TcCoefficients *c = direct->coefficients;
  const int distinct = c->extinction_count; /* groups whose transmittances are not one and the same */
  const double samples = job->samples_x * job->samples_y;
  double opacity = 0, length = 0;
  memset(direct->sums, 0, 3 * (size_t)c->groups * sizeof *direct->sums);
  for (int i = 0; i < job->samples_x * job->samples_y; ++i) {
    TcLine line;
    tc_job_line(job, x, y, i, &line);
    if (!cast(job->shell, &line, worker)) return false;
    double sum = 0;
    for (int g = 0; g < c->groups; ++g) {
      TcBeam *beam = &direct->beams[g];
      tc_beam_end_block(beam);
      direct->sums[g] += beam->radiance / samples; /* each by itself: the sum might overflow */
      direct->sums[c->groups + g] += beam->depth / samples;
      direct->sums[2 * c->groups + g] += beam->transmittance / samples;
      if (g < distinct) sum -= expm1(-beam->depth);
    }
    if (distinct)
      opacity += sum / distinct / samples;
    length += direct->length / samples;
  }
  store(job, x, y, direct, opacity, length);
  return true;
}

bool tc_kernel_direct(const TcJob *job, int64_t x0, int64_t y0, int64_t x1, int64_t y1, TcWorker *worker) {
  TcDirect *direct = worker->direct;
  direct->to_the_end = tc_frame_channel(job->frame, TETCAST_CHANNEL_OPTICAL_DEPTH) || tc_frame_channel(job->frame, TETCAST_CHANNEL_PATH_LENGTH);
  for (int64_t y = y0; y < y1; ++y) {
    for (int64_t x = x0; x < x1; ++x) {
      if (!render_pixel(job, x, y, worker)) return false;
    }
  }
  worker->segments += direct->segments;
  direct->segments = 0;
  return true;
}
