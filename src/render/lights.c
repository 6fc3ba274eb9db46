/* SPDX-License-Identifier: Apache-2.0 */
/* Light at the vertices of a scene's volume: what arrives there, which is kept from frame to frame, and what of it a
 * camera sees. */
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "render/render.h"

enum {
  LIT_GRAIN = 1 << 12, /* vertices that a worker lights at a time */
  OPEN_GRAIN = 256     /* vertices from which it casts rays at a time */
};

bool tc_scene_is_lit(const TetcastScene *scene) {
  return scene->lighting.volume && (scene->transfer || scene->coefficients);
}

TetcastStatus tc_scene_gradients(const TetcastScene *scene, const TcGradients **gradients) {
  TcPrepared *prepared = scene->prepared;
  TetcastStatus status = TETCAST_OK;
  pthread_mutex_lock(&prepared->mutex);
  if (!prepared->gradients.at)
    status = tc_gradients_build(scene->values, &prepared->gradients);
  pthread_mutex_unlock(&prepared->mutex);
  *gradients = &prepared->gradients;
  return status;
}

/* ── what arrives ── */

/* From where the light that arrives at a vertex is cast. A ray from the very vertex may lie in the mesh's boundary,
 * where it would be chance whether the mesh is in its way. So it starts a little inside of the largest cell at the
 * vertex: 2^−16 of the way to the cell's middle, which changes what arrives by no more than single precision does. */
typedef struct Inside {
  float shift[3], size;
} Inside;

typedef struct Insides {
  const TetcastVolume *volume;
  Inside *at; /* [vertices] */
} Insides;

static void look_inside(void *data, const uint32_t vertex[4]) {
  const Insides *insides = data;
  double p[4][3], edge[3][3], across[3];
  for (int j = 0; j < 4; ++j)
    tc_volume_vertex(insides->volume, vertex[j], p[j]);
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k)
      edge[j][k] = p[j + 1][k] - p[0][k];
  }
  tc_cross(edge[0], edge[1], across);
  const float size = (float)fabs(tc_dot(across, edge[2]));
  for (int j = 0; j < 4; ++j) {
    Inside *inside = &insides->at[vertex[j]];
    if (!(size > inside->size))
      continue;
    inside->size = size;
    for (int k = 0; k < 3; ++k)
      inside->shift[k] = (float)(0x1p-16 * (0.25 * (p[0][k] + p[1][k] + p[2][k] + p[3][k]) - p[j][k]));
  }
}

/* What a worker has to cast rays from some vertices in one direction. */
typedef struct Casting {
  TcWorker worker;
  TcLine lines[OPEN_GRAIN];
  double sums[OPEN_GRAIN][4];
} Casting;

typedef struct Open {
  const TetcastScene *scene;
  const TcIsaKernels *kernels;
  TcJob job;
  Casting *casting; /* [threads] */
  Inside *inside;   /* [vertices] */
  float *open;      /* [vertices][width] */
  int width;
} Open;

/* Direction i of n, spread evenly over the sphere: n belts of the same area, each turned against the one before by the
 * golden angle (Swinbank & Purser, Fibonacci grids, 2006). */
static void direction_of(int i, int n, double direction[3]) {
  const double z = 1 - (2 * i + 1.0) / n, across = sqrt(1 - z * z), turn = i * 2.399963229728653322;
  direction[0] = across * cos(turn);
  direction[1] = across * sin(turn);
  direction[2] = z;
}

/* The rays of a piece of vertices go the same way, so that neighbours meet the same cells. Returns false if memory has
 * run out. */
static bool cast_some(const Open *open, Casting *casting, int64_t begin, int64_t end, const double direction[3]) {
  for (int64_t i = begin; i < end; ++i) {
    TcLine *line = &casting->lines[i - begin];
    *line = (TcLine){.end = INFINITY};
    tc_volume_vertex(open->scene->volume, (uint32_t)i, line->eye);
    for (int k = 0; k < 3; ++k)
      line->offset[k] = open->inside[i].shift[k];
    memcpy(line->direction, direction, sizeof line->direction);
  }
  memset(casting->sums, 0, sizeof casting->sums);
  return open->kernels->cast(&open->job, casting->lines, end - begin, &casting->worker, casting->sums[0]);
}

static bool open_some(void *data, int64_t begin, int64_t end, int worker) {
  const Open *open = data;
  const TcLighting *lighting = &open->scene->lighting;
  Casting *casting = &open->casting[worker];
  double mean[OPEN_GRAIN] = {0};
  for (int r = 0; r < lighting->occlusion_rays; ++r) {
    double direction[3];
    direction_of(r, lighting->occlusion_rays, direction);
    if (!cast_some(open, casting, begin, end, direction))
      return false;
    for (int64_t i = 0; i < end - begin; ++i)
      mean[i] += 1 - casting->sums[i][3];
  }
  for (int64_t i = begin; i < end; ++i)
    open->open[i * open->width] =
        (float)(lighting->occlusion_rays > 0 ? mean[i - begin] / lighting->occlusion_rays : 1);
  for (int j = 1; j < open->width; ++j) {
    if (lighting->shadows && !cast_some(open, casting, begin, end, lighting->light[j - 1].direction))
      return false;
    for (int64_t i = begin; i < end; ++i)
      open->open[i * open->width + j] = (float)(lighting->shadows ? 1 - casting->sums[i - begin][3] : 1);
  }
  return true;
}

/* Casts the rays from all vertices. */
static TetcastStatus cast_all(Open *open) {
  TetcastContext *context = open->scene->context;
  const int64_t count = open->scene->volume->vertex_count;
  const int threads = tc_context_threads(context);
  if (!tc_allocate_array(context, (void **)&open->casting, threads, sizeof *open->casting, "rays of shadows"))
    return TETCAST_ERROR_MEMORY;
  bool ok = true;
  for (int i = 0; i < threads; ++i)
    ok = tc_worker_begin(context, open->kernels, &open->job, &open->casting[i].worker) && ok;
  TetcastStatus status = ok ? tc_parallel_for(context, count, OPEN_GRAIN, open_some, open, NULL)
                            : tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: rays of shadows");
  for (int i = 0; i < threads; ++i) {
    if (tc_worker_failed(&open->casting[i].worker))
      status = tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: hits of a shadow's ray");
    tc_worker_end(context, &open->casting[i].worker);
  }
  tc_release(context, open->casting);
  return status;
}

static TetcastStatus build_open(const TetcastScene *scene, TetcastIsa isa, int width, float **result) {
  TetcastContext *context = scene->context;
  Open open = {.scene = scene, .width = width};
  if (!tc_allocate_array(context, (void **)&open.open, scene->volume->vertex_count, (size_t)width * sizeof(float),
                         "what arrives of the light"))
    return TETCAST_ERROR_MEMORY;
  if (!tc_allocate_array(context, (void **)&open.inside, scene->volume->vertex_count, sizeof *open.inside,
                         "what arrives of the light")) {
    tc_release(context, open.open);
    return TETCAST_ERROR_MEMORY;
  }
  memset(open.inside, 0, (size_t)scene->volume->vertex_count * sizeof *open.inside);
  Insides insides = {scene->volume, open.inside};
  tc_volume_each_cell(scene->volume, look_inside, &insides);
  tc_job_of_opacity(scene, &scene->prepared->scaled->pieces, &open.job);
  const bool one_by_one = open.job.one_lane || scene->volume->traversal == TETCAST_TRAVERSAL_FACES;
  open.kernels = tc_kernels_for(one_by_one ? TETCAST_ISA_SCALAR : isa);
  const TetcastStatus status = cast_all(&open);
  tc_release(context, open.inside);
  if (status)
    tc_release(context, open.open);
  else
    *result = open.open;
  return status;
}

TetcastStatus tc_scene_open(const TetcastScene *scene, TetcastIsa isa, const float **open, int *width) {
  const TcLighting *lighting = &scene->lighting;
  TcPrepared *prepared = scene->prepared;
  TetcastStatus status = TETCAST_OK;
  *open = NULL;
  *width = 1 + lighting->light_count;
  if (!scene->transfer || (!lighting->shadows && lighting->occlusion_rays == 0))
    return TETCAST_OK;
  pthread_mutex_lock(&prepared->mutex);
  if (!prepared->open)
    status = build_open(scene, isa, *width, &prepared->open);
  pthread_mutex_unlock(&prepared->mutex);
  *open = prepared->open;
  return status;
}

/* ── what is seen of it ── */

typedef struct Lighting {
  const TetcastScene *scene;
  const TcGradients *gradients;
  const TcView *view;
  const float *open;
  int open_width;
  TcLights *lights;
} Lighting;

/* The direction in which a vertex is seen. */
static void along_to(const Lighting *l, uint32_t vertex, double along[3]) {
  memcpy(along, l->view->forward, sizeof l->view->forward);
  if (l->view->orthographic)
    return;
  tc_volume_vertex(l->scene->volume, vertex, along);
  for (int k = 0; k < 3; ++k)
    along[k] -= l->view->eye[k];
  if (!tc_normalize(along))
    memcpy(along, l->view->forward, sizeof l->view->forward);
}

static bool light_some(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Lighting *l = data;
  const int width = l->lights->width, half = width / 2;
  for (int64_t i = begin; i < end; ++i) {
    double along[3], normal[3], open[1 + TETCAST_MAX_LIGHTS];
    along_to(l, (uint32_t)i, along);
    const float *gradient = l->gradients->at[i];
    const double toward = gradient[0] * along[0] + gradient[1] * along[1] + gradient[2] * along[2];
    for (int k = 0; k < 3; ++k)
      normal[k] = toward > 0 ? -gradient[k] : gradient[k];
    for (int j = 0; l->open && j < l->open_width; ++j)
      open[j] = l->open[i * l->open_width + j];
    const TcReflection seen = tc_light_reflection(&l->scene->lighting, along, normal, l->open ? open : NULL);
    double *at = l->lights->at[i * tc_light_records(width)];
    for (int k = 0; k < half; ++k) {
      at[k] = seen.factor[k];
      at[half + k] = seen.highlight[k];
    }
  }
  return true;
}

TetcastStatus tc_scene_lights(const TetcastScene *scene, TetcastIsa isa, const TcView *view, int width,
                              TcLights *lights) {
  Lighting l = {.scene = scene, .view = view, .lights = lights};
  const int64_t count = scene->volume->vertex_count;
  *lights = (TcLights){.width = width, .highlight = tc_light_largest(&scene->lighting, 0)};
  lights->factor = tc_light_largest(&scene->lighting, 1) - lights->highlight;
  TetcastStatus status = tc_scene_gradients(scene, &l.gradients);
  if (!status)
    status = tc_scene_open(scene, isa, &l.open, &l.open_width);
  if (!status && !tc_allocate_array(scene->context, (void **)&lights->at, count * tc_light_records(width),
                                    sizeof *lights->at, "light at the vertices"))
    status = TETCAST_ERROR_MEMORY;
  if (!status)
    tc_parallel_for(scene->context, count, LIT_GRAIN, light_some, &l, NULL);
  return status;
}

void tc_lights_clear(TetcastContext *context, TcLights *lights) {
  tc_release(context, lights->at);
  lights->at = NULL;
}
