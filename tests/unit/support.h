/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of the core share: cmocka, meshes made on the spot, a whole rendering in one call. */
#ifndef SUPPORT_H
#define SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tetcast/tetcast.h>

/* A context whose last message can be looked at, and whose allocations are counted and can be made to fail. */
typedef struct Fixture {
  TetcastContext *context;
  char message[1024];
  int messages;
  long allocations, live, fail_at; /* fail_at: number of the allocation that fails, 0: none */
} Fixture;

static inline void fixture_message(void *user, TetcastSeverity severity, const char *text) {
  Fixture *fixture = user;
  (void)severity;
  snprintf(fixture->message, sizeof fixture->message, "%s", text);
  ++fixture->messages;
}

static inline void *fixture_allocate(void *user, size_t size, size_t alignment) {
  Fixture *fixture = user;
  const long number = __atomic_add_fetch(&fixture->allocations, 1, __ATOMIC_RELAXED);
  if (number == fixture->fail_at)
    return NULL;
  void *memory = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory)
    __atomic_add_fetch(&fixture->live, 1, __ATOMIC_RELAXED);
  return memory;
}

static inline void fixture_release(void *user, void *memory) {
  Fixture *fixture = user;
  __atomic_add_fetch(&fixture->live, -1, __ATOMIC_RELAXED);
  free(memory);
}

static inline TetcastStatus fixture_begin(Fixture *fixture, int threads, long fail_at) {
  memset(fixture, 0, sizeof *fixture);
  fixture->fail_at = fail_at;
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = threads;
  desc.message = fixture_message;
  desc.message_user = fixture;
  desc.allocate = fixture_allocate;
  desc.release = fixture_release;
  desc.memory_user = fixture;
  return tetcast_context_create(&desc, &fixture->context);
}

static inline void fixture_end(Fixture *fixture) {
  tetcast_context_destroy(&fixture->context);
  assert_int_equal(fixture->live, 0);
}

/* ── meshes ── */

typedef struct Cube {
  int64_t vertex_count, cell_count;
  double *vertices; /* [vertex_count][3] */
  int64_t *cells;   /* [cell_count][4] */
  double *values;   /* [vertex_count] */
} Cube;

/* With TETCAST_TEST_SHORT in the environment, as the asan preset has it, tests do a quarter of what is much the same
 * many times over: there it is not about numbers, but about what the code does to memory. */
static inline bool test_short(void) {
  return getenv("TETCAST_TEST_SHORT") != NULL;
}

static inline int repetitions(int count) {
  return test_short() ? (count + 3) / 4 : count;
}

static inline double uniform(uint64_t *state) { /* in [0, 1) */
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) * 0x1p-53;
}

/* The unit cube in n³ cubes of six tetrahedra each (Kuhn's cut), inner vertices moved by up to `jitter` of a cube's
 * edge, with a smooth field. */
static inline Cube cube_create(int n, double jitter) {
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int64_t m = n + 1;
  Cube cube = {m * m * m, INT64_C(6) * n * n * n, NULL, NULL, NULL};
  cube.vertices = malloc((size_t)cube.vertex_count * 3 * sizeof *cube.vertices);
  cube.cells = malloc((size_t)cube.cell_count * 4 * sizeof *cube.cells);
  cube.values = malloc((size_t)cube.vertex_count * sizeof *cube.values);
  uint64_t seed = 7;
  for (int64_t i = 0; i < cube.vertex_count; ++i) {
    const int64_t at[3] = {i % m, i / m % m, i / (m * m)};
    for (int k = 0; k < 3; ++k) {
      const bool inside = at[k] > 0 && at[k] < n;
      cube.vertices[3 * i + k] = ((double)at[k] + (inside ? jitter * (uniform(&seed) - 0.5) : 0)) / n;
    }
    const double *p = &cube.vertices[3 * i];
    cube.values[i] = 0.5 + 0.3 * sin(5 * p[0] + 1) * cos(4 * p[1]) + 0.2 * sin(7 * p[2]);
  }
  const int64_t step[3] = {1, m, m * m};
  int64_t *cell = cube.cells;
  for (int64_t i = 0; i < (int64_t)n * n * n; ++i) {
    const int64_t corner = i % n + i / n % n * m + i / ((int64_t)n * n) * m * m;
    for (int t = 0; t < 6; ++t, cell += 4) {
      cell[0] = corner;
      for (int k = 0; k < 3; ++k)
        cell[k + 1] = cell[k] + step[order[t][k]];
    }
  }
  return cube;
}

static inline void cube_destroy(Cube *cube) {
  free(cube->vertices);
  free(cube->cells);
  free(cube->values);
}

static inline TetcastMesh *cube_mesh(TetcastContext *context, const Cube *cube) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(context, &desc, &mesh), TETCAST_OK);
  return mesh;
}

static inline TetcastField *field_of(TetcastContext *context, const double *values, int64_t count,
                                     TetcastAssociation association) {
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){values, TETCAST_TYPE_FLOAT64, count, 0};
  desc.association = association;
  TetcastField *field = NULL;
  assert_int_equal(tetcast_field_create(context, &desc, &field), TETCAST_OK);
  return field;
}

static inline TetcastVolume *volume_of(TetcastContext *context, const TetcastMesh *mesh, TetcastTraversal traversal) {
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = traversal;
  TetcastVolume *volume = NULL;
  assert_int_equal(tetcast_volume_create(context, mesh, &desc, &volume), TETCAST_OK);
  return volume;
}

/* A prepared mesh and the field that is seen of it. */
typedef struct Body {
  TetcastVolume *volume;
  TetcastField *field;
} Body;

static inline Body body_of(TetcastContext *context, const TetcastMesh *mesh, TetcastTraversal traversal,
                           const double *values, int64_t count, TetcastAssociation association) {
  return (Body){volume_of(context, mesh, traversal), field_of(context, values, count, association)};
}

/* The cube with its point field. The volume keeps nothing of the mesh, which goes again. */
static inline Body cube_body(TetcastContext *context, const Cube *cube, TetcastTraversal traversal) {
  TetcastMesh *mesh = cube_mesh(context, cube);
  const Body body = body_of(context, mesh, traversal, cube->values, cube->vertex_count, TETCAST_POINT);
  tetcast_mesh_destroy(&mesh);
  return body;
}

/* The cube with a field of `count` values, coordinates and values stored in single precision. */
static inline Body single_body(TetcastContext *context, const Cube *cube, const double *values, int64_t count,
                               TetcastAssociation association) {
  float *vertices = malloc((size_t)cube->vertex_count * 3 * sizeof *vertices);
  float *rounded = malloc((size_t)count * sizeof *rounded);
  for (int64_t i = 0; i < 3 * cube->vertex_count; ++i)
    vertices[i] = (float)cube->vertices[i];
  for (int64_t i = 0; i < count; ++i)
    rounded[i] = (float)values[i];
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT32, cube->vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){rounded, TETCAST_TYPE_FLOAT32, count, 0};
  field_desc.association = association;
  TetcastMesh *mesh = NULL;
  Body body = {NULL, NULL};
  assert_int_equal(tetcast_mesh_create(context, &mesh_desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_field_create(context, &field_desc, &body.field), TETCAST_OK);
  body.volume = volume_of(context, mesh, TETCAST_TRAVERSAL_SHELL);
  tetcast_mesh_destroy(&mesh);
  free(vertices);
  free(rounded);
  return body;
}

/* Scenes of it must be gone. */
static inline void body_destroy(Body *body) {
  tetcast_volume_destroy(&body->volume);
  tetcast_field_destroy(&body->field);
}

/* Colour and extinction with several knots and a step, extinction times `factor`. */
static inline TetcastTransferFunction *transfer_of(TetcastContext *context, double factor) {
  static const double color[][4] = {{0, 1, 0, 0}, {0.4, 0, 1, 0}, {0.4, 0.2, 0.3, 0.9}, {1, 0.5, 0.7, 1}};
  double extinction[][2] = {{0.1, 0}, {0.3, 4}, {0.5, 1}, {0.55, 30}, {0.6, 0}, {0.8, 5}};
  for (size_t i = 0; i < sizeof extinction / sizeof *extinction; ++i)
    extinction[i][1] *= factor;
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = sizeof color / sizeof *color;
  desc.extinction = extinction[0];
  desc.extinction_count = sizeof extinction / sizeof *extinction;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* Uniform white of extinction k. */
static inline TetcastTransferFunction *gray_of(TetcastContext *context, double k) {
  const double color[4] = {0, 1, 1, 1}, extinction[2] = {0, k};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = 1;
  desc.extinction = extinction;
  desc.extinction_count = 1;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static inline double power(uint64_t *seed, double low, double high) {
  return pow(10, low + (high - low) * uniform(seed));
}

/* Some knots, some of them steps; extinctions of any strength next to each other, colours up to 1000, in some scenes
 * bright ones behind opaque ones. */
static inline TetcastTransferFunction *random_transfer(TetcastContext *context, uint64_t *seed) {
  double color[16][4], extinction[16][2];
  int colors = 0, extinctions = 0;
  const double brightest = uniform(seed) < 0.5 ? 0 : 3;
  const double middle = -3 + 6 * uniform(seed), spread = 3 * uniform(seed);
  double at = -0.1;
  while (colors < 14 && at < 1.1) {
    for (int twice = uniform(seed) < 0.2; twice >= 0; --twice, ++colors) {
      color[colors][0] = at;
      for (int k = 1; k < 4; ++k)
        color[colors][k] = uniform(seed) < 0.2 ? 0 : power(seed, brightest - 3, brightest);
    }
    at += 0.4 * uniform(seed);
  }
  if (uniform(seed) < 0.2)
    colors = 1;
  at = 0;
  while (extinctions < 14 && at < 1.1) {
    for (int twice = uniform(seed) < 0.2; twice >= 0; --twice, ++extinctions) {
      extinction[extinctions][0] = at;
      extinction[extinctions][1] = uniform(seed) < 0.2 ? 0 : power(seed, middle - spread, middle + spread);
    }
    at += 0.3 * uniform(seed);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = colors;
  desc.extinction = extinction[0];
  desc.extinction_count = extinctions;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static inline TetcastScene *scene_of(TetcastContext *context, const Body *body,
                                     const TetcastTransferFunction *transfer) {
  TetcastScene *scene = NULL;
  assert_int_equal(tetcast_scene_create(context, body->volume, &scene), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(scene, body->field), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
  return scene;
}

/* The preset of this name over [low, high], for the body. */
static inline TetcastTransferFunction *preset_of(TetcastContext *context, const Body *body, const char *name,
                                                 double low, double high) {
  TetcastScene *scene = NULL;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_scene_create(context, body->volume, &scene), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(scene, body->field), TETCAST_OK);
  assert_int_equal(tetcast_scene_create_preset(scene, name, low, high, &transfer), TETCAST_OK);
  tetcast_scene_destroy(&scene);
  return transfer;
}

/* The default description, with the instruction set that the environment variable TETCAST_TEST_ISA names by its number:
 * the same test serves all kernels. */
static inline TetcastRenderDesc render_desc(void) {
  TetcastRenderDesc desc = tetcast_render_desc_default();
  const char *isa = getenv("TETCAST_TEST_ISA");
  if (isa)
    desc.isa = (TetcastIsa)atoi(isa);
  return desc;
}

/* A picture of width × height doubles ×4 that the caller frees. */
static inline double *picture(TetcastContext *context, const Body *body, const TetcastTransferFunction *transfer,
                              const TetcastCamera *camera, int width, int height, TetcastRenderStats *stats) {
  double *pixels = malloc((size_t)width * (size_t)height * 4 * sizeof *pixels);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  TetcastScene *scene = scene_of(context, body, transfer);
  TetcastRenderStats own;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  const TetcastRenderDesc render = render_desc();
  assert_int_equal(tetcast_scene_render(scene, camera, &render, frame, stats ? stats : &own), TETCAST_OK);
  assert_int_equal((stats ? stats : &own)->lost, 0);
  tetcast_scene_destroy(&scene);
  tetcast_frame_destroy(&frame);
  return pixels;
}

static inline double largest_difference(const double *a, const double *b, size_t count) {
  double largest = 0;
  for (size_t i = 0; i < count; ++i) {
    const double d = fabs(a[i] - b[i]);
    if (isnan(d))
      return INFINITY;
    if (d > largest)
      largest = d;
  }
  return largest;
}

static inline TetcastCamera camera_of(double ex, double ey, double ez, double tx, double ty, double tz) {
  return (TetcastCamera){.eye = {ex, ey, ez}, .target = {tx, ty, tz}, .up = {0, 1, 0.1}, .fovy = 30, .height = 1.5};
}

#endif
