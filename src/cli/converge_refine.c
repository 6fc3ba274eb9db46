/* SPDX-License-Identifier: Apache-2.0 */
/* The study of refinement: an analytic field in a cube, sampled on finer and finer meshes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "converge.h"
#include "quadrature.h"

enum { PIXELS = CONVERGE_REFINE_WIDTH * CONVERGE_REFINE_HEIGHT };

/* The scalar, which is smooth and within [0, 1], and a transfer function that is linear over that range. So the only
 * error on a mesh comes from the scalar's curvature. */
static long double scalar(const long double x[3]) {
  return 0.5L + 0.24L * (sinl(5 * x[0] + x[2]) * cosl(4 * x[1]) + cosl(4 * x[2] + 2 * x[0] - x[1]));
}

static const double color_knots[2][4] = {{0, 1, 0.3, 0.1}, {1, 0.2, 0.5, 1}};
static const double extinction_knots[2][2] = {{0, 0.5}, {1, 4}};

static const TetcastCamera view = {
    .eye = {2.6, 2.1, 3.1}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .projection = TETCAST_PERSPECTIVE, .fovy = 24};

static const struct {
  TetcastIntegrator integrator;
  int n;
} compared[] = {{TETCAST_INTEGRATOR_MIDPOINT, 1}, {TETCAST_INTEGRATOR_GAUSS, 2}};
enum { COMPARED = sizeof compared / sizeof *compared };

/* ── the reference: no mesh at all ── */

/* Where the ray is inside the unit cube. */
static bool clip_to_cube(const ReferenceRay *ray, long double t[2]) {
  t[0] = 0;
  t[1] = INFINITY;
  for (int k = 0; k < 3; k++) {
    const long double zero = -ray->origin[k] / ray->direction[k], one = (1 - ray->origin[k]) / ray->direction[k];
    t[0] = fmaxl(t[0], fminl(zero, one));
    t[1] = fminl(t[1], fmaxl(zero, one));
  }
  return t[0] < t[1];
}

static long double extinction_at(long double s) {
  return extinction_knots[0][1] + (extinction_knots[1][1] - (long double)extinction_knots[0][1]) * s;
}

static long double scalar_along(const ReferenceRay *ray, long double t) {
  const long double x[3] = {ray->origin[0] + t * ray->direction[0], ray->origin[1] + t * ray->direction[1],
                            ray->origin[2] + t * ray->direction[2]};
  return scalar(x);
}

static long double depth_between(const ReferenceRay *ray, long double from, long double to) {
  const Quadrature *rule = quadrature();
  long double depth = 0;
  for (int i = 0; i < QUADRATURE_NODES; i++)
    depth += rule->weight[i] * (to - from) * extinction_at(scalar_along(ray, from + (to - from) * rule->node[i]));
  return depth;
}

static void integrate(const ReferenceRay *ray, const long double t[2], int panels, long double rgba[4]) {
  const Quadrature *rule = quadrature();
  const long double h = (t[1] - t[0]) / panels;
  long double depth = 0;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (int p = 0; p < panels; p++) {
    const long double start = t[0] + p * h;
    for (int i = 0; i < QUADRATURE_NODES; i++) {
      const long double at = start + h * rule->node[i], s = scalar_along(ray, at);
      const long double light = rule->weight[i] * h * extinction_at(s) * expl(-depth - depth_between(ray, start, at));
      for (int k = 0; k < 3; k++)
        rgba[k] += light * (color_knots[0][k + 1] + (color_knots[1][k + 1] - (long double)color_knots[0][k + 1]) * s);
    }
    depth += depth_between(ray, start, start + h);
  }
  rgba[3] = -expm1l(-depth);
}

/* Integrates along a pixel's ray, with panels that are halved until nothing changes. Returns the last change. */
static long double analytic_pixel(int64_t pixel, double rgba[4]) {
  const ReferenceRay ray = reference_ray(&view, CONVERGE_REFINE_WIDTH, CONVERGE_REFINE_HEIGHT,
                                         pixel % CONVERGE_REFINE_WIDTH, pixel / CONVERGE_REFINE_WIDTH);
  long double t[2], change = 0, value[4] = {0, 0, 0, 0};
  if (clip_to_cube(&ray, t)) {
    integrate(&ray, t, 2, value);
    for (int panels = 4; panels <= 64; panels *= 2) {
      long double finer[4];
      integrate(&ray, t, panels, finer);
      change = 0;
      for (int k = 0; k < 4; k++)
        change = fmaxl(change, fabsl(finer[k] - value[k]));
      memcpy(value, finer, sizeof value);
      if (change < 1e-17L)
        break;
    }
  }
  for (int k = 0; k < 4; k++)
    rgba[k] = (double)value[k];
  return change;
}

static TetcastStatus analytic_picture(Converge *converge, double *picture) {
  const TetcastProgress progress = converge_progress(converge, 4);
  for (int64_t i = 0; i < PIXELS; i++) {
    const double change = (double)analytic_pixel(i, picture + 4 * i);
    converge->analytic_step = fmax(converge->analytic_step, change);
    if (i % CONVERGE_REFINE_WIDTH == 0 && !progress.function(progress.user, (double)i / PIXELS))
      return TETCAST_ERROR_CANCELLED;
  }
  return TETCAST_OK;
}

/* ── the meshes ── */

/* A number in [-1, 1] that belongs to a vertex and an axis. */
static double scatter(int64_t vertex, int axis) {
  uint64_t x = (uint64_t)vertex * 3 + (uint64_t)axis + 1;
  for (int i = 0; i < 3; i++) {
    x ^= x >> 31;
    x *= UINT64_C(0x9e3779b97f4a7c15);
  }
  return (double)(x >> 11) * 0x1p-52 - 1;
}

static void fill_vertices(int n, double *vertices, double *values) {
  int64_t number = 0;
  for (int k = 0; k <= n; k++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++, number++) {
        const int index[3] = {i, j, k};
        long double x[3];
        for (int axis = 0; axis < 3; axis++) {
          const bool inside = index[axis] > 0 && index[axis] < n; /* the cube itself stays as it is */
          vertices[3 * number + axis] = (index[axis] + (inside ? 0.2 * scatter(number, axis) : 0)) / n;
          x[axis] = vertices[3 * number + axis];
        }
        values[number] = (double)scalar(x);
      }
}

/* Cuts each small cube into six tetrahedra around its diagonal (Kuhn). */
static void fill_cells(int n, int32_t *cells) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
  for (int k = 0; k < n; k++)
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++)
        for (int o = 0; o < 6; o++) {
          *cells++ = i * step[0] + j * step[1] + k * step[2];
          for (int a = 0; a < 3; a++, cells++)
            cells[0] = cells[-1] + step[orders[o][a]];
        }
}

static TetcastStatus create_scene(TetcastContext *context, int n, TetcastVolume **volume, TetcastScene **scene) {
  const int64_t vertex_count = (int64_t)(n + 1) * (n + 1) * (n + 1), cell_count = (int64_t)6 * n * n * n;
  double *vertices = cli_allocate(sizeof *vertices * 3 * (size_t)vertex_count);
  double *values = cli_allocate(sizeof *values * (size_t)vertex_count);
  int32_t *cells = cli_allocate(sizeof *cells * 4 * (size_t)cell_count);
  fill_vertices(n, vertices, values);
  fill_cells(n, cells);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){.data = vertices, .type = TETCAST_TYPE_FLOAT64, .count = vertex_count};
  mesh_desc.tetrahedra = (TetcastArray){.data = cells, .type = TETCAST_TYPE_INT32, .count = cell_count};
  mesh_desc.ownership = TETCAST_BORROW;
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){.data = values, .type = TETCAST_TYPE_FLOAT64, .count = vertex_count};
  field_desc.ownership = TETCAST_BORROW;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastStatus status = tetcast_mesh_create(context, &mesh_desc, &mesh);
  if (status == TETCAST_OK)
    status = tetcast_field_create(context, &field_desc, &field);
  if (status == TETCAST_OK)
    status = tetcast_volume_create(context, mesh, NULL, volume);
  if (status == TETCAST_OK)
    status = tetcast_scene_create(context, *volume, scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_field(*scene, field);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  free(vertices);
  free(values);
  free(cells);
  return status;
}

/* ── the study ── */

static const int levels[] = {4, 8, 16, 32, 64};
enum { LEVELS = sizeof levels / sizeof *levels };

static double level_weight(int level) {
  return 1e-5 * level * level * level;
}

void converge_plan_refine(Converge *converge) {
  for (int l = 0; l < LEVELS; l++) {
    ConvergeRow row = {.study = STUDY_REFINE, .scale = 1, .level = levels[l], .repeats = 1};
    converge_plan(converge, row);
    for (int i = 0; i < COMPARED; i++) {
      row.integrator = compared[i].integrator;
      row.n = compared[i].n;
      row.study = STUDY_REFINE;
      converge_plan(converge, row);
      row.study = STUDY_INTEGRATION;
      converge_plan(converge, row);
    }
    converge->work += level_weight(levels[l]) + 0.1 * (1 + COMPARED);
  }
  converge->work += 4;
}

typedef struct Level {
  TetcastTransferFunction *transfer_function;
  TetcastVolume *volume;
  TetcastScene *scene;
  TetcastFrame *frame;
  double *analytic, *exact;
} Level;

static TetcastStatus begin_level(Converge *converge, Level *level, int n) {
  tetcast_scene_destroy(&level->scene);
  tetcast_volume_destroy(&level->volume);
  converge_progress(converge, level_weight(n));
  TetcastStatus status = create_scene(converge->context, n, &level->volume, &level->scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(level->scene, level->transfer_function);
  return status;
}

/* Rows of STUDY_INTEGRATION take over the picture of the row before them. */
static TetcastStatus run_row(Converge *converge, Level *level, int number) {
  ConvergeRow *row = &converge->rows[number];
  const bool exact = row->integrator == TETCAST_INTEGRATOR_EXACT;
  const double *pixels = tetcast_frame_pixels(level->frame);
  if (row->study == STUDY_INTEGRATION) {
    *row = row[-1];
    row->study = STUDY_INTEGRATION;
    row->times = NULL;
    converge_compare(row, pixels, level->exact, 4 * PIXELS);
    return TETCAST_OK;
  }
  TetcastStatus status = exact ? begin_level(converge, level, row->level) : TETCAST_OK;
  if (status == TETCAST_OK)
    status = converge_render(converge, level->scene, &view, level->frame, row, 0.1);
  if (status != TETCAST_OK)
    return status;
  TetcastVolumeInfo info;
  tetcast_volume_info(level->volume, &info);
  row->cells = info.tetrahedra;
  for (int i = 0; i < 4 * PIXELS; i++)
    row->peak = fmax(row->peak, level->analytic[i]);
  if (exact)
    memcpy(level->exact, pixels, sizeof(double) * 4 * PIXELS);
  converge_compare(row, pixels, level->analytic, 4 * PIXELS);
  return TETCAST_OK;
}

int converge_run_refine(Converge *converge) {
  Level level = {0};
  level.analytic = cli_allocate(sizeof(double) * 4 * PIXELS);
  level.exact = cli_allocate(sizeof(double) * 4 * PIXELS);
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color_knots[0];
  desc.color_count = 2;
  desc.extinction = extinction_knots[0];
  desc.extinction_count = 2;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = CONVERGE_REFINE_WIDTH;
  frame_desc.height = CONVERGE_REFINE_HEIGHT;
  TetcastStatus status = analytic_picture(converge, level.analytic);
  if (status == TETCAST_OK)
    status = tetcast_transfer_function_create(converge->context, &desc, &level.transfer_function);
  if (status == TETCAST_OK)
    status = tetcast_frame_create(converge->context, &frame_desc, &level.frame);
  for (int i = 0; i < converge->count && status == TETCAST_OK; i++)
    if (converge->rows[i].level > 0)
      status = run_row(converge, &level, i);
  tetcast_frame_destroy(&level.frame);
  tetcast_scene_destroy(&level.scene);
  tetcast_volume_destroy(&level.volume);
  tetcast_transfer_function_destroy(&level.transfer_function);
  free(level.exact);
  free(level.analytic);
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}
