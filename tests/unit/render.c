/* SPDX-License-Identifier: Apache-2.0 */
/* Properties of whole pictures. */
#define _DEFAULT_SOURCE /* the clock */
#include "support.h"

#include <pthread.h>
#include <time.h>

enum { W = 48, H = 36, VALUES = W * H * 4 };

typedef struct World {
  Fixture fixture;
  Cube cube;
  TetcastMesh *mesh;
  Body body;
} World;

/* Another field of the world's points or cells. */
static void world_field(World *world, const double *values, int64_t count, TetcastAssociation association) {
  tetcast_field_destroy(&world->body.field);
  world->body.field = field_of(world->fixture.context, values, count, association);
}

static void world_begin(World *world, int n, double jitter, TetcastTraversal traversal, int threads) {
  assert_int_equal(fixture_begin(&world->fixture, threads, 0), TETCAST_OK);
  world->cube = cube_create(n, jitter);
  world->mesh = cube_mesh(world->fixture.context, &world->cube);
  world->body = body_of(world->fixture.context, world->mesh, traversal, world->cube.values, world->cube.vertex_count,
                        TETCAST_POINT);
}

static void world_end(World *world) {
  body_destroy(&world->body);
  tetcast_mesh_destroy(&world->mesh);
  cube_destroy(&world->cube);
  fixture_end(&world->fixture);
}

static const double cameras[][6] = {
    {2.1, 1.7, 3.3, 0.5, 0.5, 0.5},
    {0.5, 0.5, 4, 0.5, 0.5, 0.5},
    {-2, 0.5, 0.5, 0.5, 0.5, 0.5},
    {0.43, 0.52, 0.61, 1, 0.2, 0}, /* inside */
    {3, 3, 3, 0, 0, 0},            /* down the main diagonal, along edges */
};

static double *shot(World *world, double factor, int camera, bool orthographic, TetcastRenderStats *stats) {
  TetcastCamera view = camera_of(cameras[camera][0], cameras[camera][1], cameras[camera][2], cameras[camera][3],
                                 cameras[camera][4], cameras[camera][5]);
  view.projection = orthographic ? TETCAST_ORTHOGRAPHIC : TETCAST_PERSPECTIVE;
  TetcastTransferFunction *transfer = transfer_of(world->fixture.context, factor);
  double *pixels = picture(world->fixture.context, &world->body, transfer, &view, W, H, stats);
  tetcast_transfer_function_destroy(&transfer);
  return pixels;
}

static void shell_equals_faces_for_any_number_of_threads(void **state) {
  (void)state;
  World a, b, c;
  world_begin(&a, 7, 0.5, TETCAST_TRAVERSAL_SHELL, 1);
  world_begin(&b, 7, 0.5, TETCAST_TRAVERSAL_SHELL, 3);
  world_begin(&c, 7, 0.5, TETCAST_TRAVERSAL_FACES, 2);
  for (int camera = 0; camera < 5; ++camera) {
    for (int orthographic = 0; orthographic < 2; ++orthographic) {
      TetcastRenderStats sa, sc;
      double *x = shot(&a, 1, camera, orthographic, &sa), *y = shot(&b, 1, camera, orthographic, NULL),
             *z = shot(&c, 1, camera, orthographic, &sc);
      assert_memory_equal(x, y, VALUES * sizeof *x);
      assert_true(largest_difference(x, z, VALUES) < 1e-13);
      assert_true(sa.segments > 1000 && sa.rays == W * H);
      free(x), free(y), free(z);
    }
  }
  world_end(&a), world_end(&b), world_end(&c);
}

/* Distance that a ray has inside the unit cube, from its slabs. */
static double chord(const double eye[3], const double direction[3], double near) {
  double enter = near, leave = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (eye[k] < 0 || eye[k] > 1)
        return 0;
      continue;
    }
    const double t0 = (0 - eye[k]) / direction[k], t1 = (1 - eye[k]) / direction[k];
    enter = fmax(enter, fmin(t0, t1));
    leave = fmin(leave, fmax(t0, t1));
  }
  return leave > enter ? leave - enter : 0;
}

/* A uniform medium: the opacity is that of the chord, also with rays in faces, along edges and through vertices of a
 * regular cube, where every cell on the way is degenerate for the ray. Rays exactly in the cube's surface may count as
 * inside or outside. */
static void uniform_medium_gives_the_chord(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 8, 0, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    TetcastTransferFunction *gray = gray_of(world.fixture.context, 1.5);
    for (int axis = 0; axis < 3; ++axis) {
      for (int sign = -1; sign <= 1; sign += 2) {
        /* 17 × 17 orthographic rays at multiples of 1/16 from −1/32 … : every other one through grid lines and vertices
         */
        TetcastCamera camera = {.projection = TETCAST_ORTHOGRAPHIC, .height = 17.0 / 16, .up = {0, 0, 0}};
        for (int k = 0; k < 3; ++k)
          camera.target[k] = camera.eye[k] = 0.5;
        camera.eye[axis] = 0.5 + 3 * sign;
        camera.up[(axis + 1) % 3] = 1;
        double *pixels = picture(world.fixture.context, &world.body, gray, &camera, 17, 17, NULL);
        for (int p = 0; p < 17 * 17; ++p) {
          const int x = p % 17, y = p / 17;
          if (x == 0 || y == 0 || x == 16 || y == 16) {
            assert_true(pixels[4 * p + 3] == 0 || fabs(pixels[4 * p + 3] + expm1(-1.5)) < 1e-14);
            continue;
          }
          for (int k = 0; k < 4; ++k) {
            if (!(fabs(pixels[4 * p + k] + expm1(-1.5)) < 1e-14)) {
              fail_msg("axis %d sign %d pixel (%d, %d): %.17g", axis, sign, x, y, pixels[4 * p + 3]);
            }
          }
        }
        free(pixels);
      }
    }
    tetcast_transfer_function_destroy(&gray);
    world_end(&world);
  }
}

static void perspective_chords(void **state) {
  (void)state;
  World world;
  world_begin(&world, 6, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  TetcastTransferFunction *gray = gray_of(world.fixture.context, 0.8);
  for (size_t c = 0; c < sizeof cameras / sizeof *cameras; ++c) {
    TetcastCamera camera =
        camera_of(cameras[c][0], cameras[c][1], cameras[c][2], cameras[c][3], cameras[c][4], cameras[c][5]);
    double *pixels = picture(world.fixture.context, &world.body, gray, &camera, W, H, NULL);
    double forward[3], right[3], up[3], length = 0;
    for (int k = 0; k < 3; ++k)
      length += pow(camera.target[k] - camera.eye[k], 2);
    for (int k = 0; k < 3; ++k)
      forward[k] = (camera.target[k] - camera.eye[k]) / sqrt(length);
    for (int k = 0; k < 3; ++k) {
      right[k] = forward[(k + 1) % 3] * camera.up[(k + 2) % 3] - forward[(k + 2) % 3] * camera.up[(k + 1) % 3];
    }
    length = sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
    for (int k = 0; k < 3; ++k)
      right[k] /= length;
    for (int k = 0; k < 3; ++k)
      up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3];
    for (int p = 0; p < W * H; ++p) {
      const double u = (2 * (p % W + 0.5) / W - 1) * W / H, v = 1 - 2 * (p / W + 0.5) / H, half = tan(acos(-1) / 12);
      double d[3], d2 = 0;
      for (int k = 0; k < 3; ++k) {
        d[k] = forward[k] + half * (u * right[k] + v * up[k]);
        d2 += d[k] * d[k];
      }
      for (int k = 0; k < 3; ++k)
        d[k] /= sqrt(d2);
      const double expected = -expm1(-0.8 * chord(camera.eye, d, 0));
      if (!(fabs(pixels[4 * p + 3] - expected) < 2e-14))
        fail_msg("camera %zu pixel %d: %.17g", c, p, pixels[4 * p + 3]);
    }
    free(pixels);
  }
  tetcast_transfer_function_destroy(&gray);
  world_end(&world);
}

/* Other numbers for vertices and cells, other orders within cells: the same picture to rounding. */
static void renumbering_changes_nothing(void **state) {
  (void)state;
  World a, b;
  world_begin(&a, 6, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  assert_int_equal(fixture_begin(&b.fixture, 2, 0), TETCAST_OK);
  b.cube = cube_create(6, 0.5);
  uint64_t seed = 5;
  const int64_t n = b.cube.vertex_count, m = b.cube.cell_count;
  int64_t *number = malloc((size_t)n * sizeof *number);
  for (int64_t i = 0; i < n; ++i)
    number[i] = i;
  for (int64_t i = n - 1; i > 0; --i) {
    const int64_t j = (int64_t)(uniform(&seed) * (double)(i + 1)), t = number[i];
    number[i] = number[j];
    number[j] = t;
  }
  for (int64_t i = 0; i < n; ++i) {
    memcpy(&b.cube.vertices[3 * number[i]], &a.cube.vertices[3 * i], 3 * sizeof(double));
    b.cube.values[number[i]] = a.cube.values[i];
  }
  for (int64_t i = 0; i < m; ++i) {
    for (int k = 0; k < 4; ++k)
      b.cube.cells[4 * (m - 1 - i) + k] = number[a.cube.cells[4 * i + (k + i) % 4]];
  }
  b.mesh = cube_mesh(b.fixture.context, &b.cube);
  b.body = body_of(b.fixture.context, b.mesh, TETCAST_TRAVERSAL_SHELL, b.cube.values, n, TETCAST_POINT);
  for (int camera = 0; camera < 5; ++camera) {
    double *x = shot(&a, 1, camera, false, NULL), *y = shot(&b, 1, camera, false, NULL);
    assert_true(largest_difference(x, y, VALUES) < 1e-13);
    free(x), free(y);
  }
  free(number);
  world_end(&a), world_end(&b);
}

/* Lengths times a power of two, extinction by its inverse: the same bits. */
static void powers_of_two_change_no_bit(void **state) {
  (void)state;
  const int exponents[] = {0, 3, -7, 100, -100, 900, -900};
  double *first = NULL;
  for (size_t i = 0; i < sizeof exponents / sizeof *exponents; ++i) {
    const double scale = ldexp(1, exponents[i]);
    World world;
    assert_int_equal(fixture_begin(&world.fixture, 2, 0), TETCAST_OK);
    world.cube = cube_create(4, 0.5);
    for (int64_t j = 0; j < 3 * world.cube.vertex_count; ++j)
      world.cube.vertices[j] *= scale;
    world.mesh = cube_mesh(world.fixture.context, &world.cube);
    world.body = body_of(world.fixture.context, world.mesh, TETCAST_TRAVERSAL_SHELL, world.cube.values,
                         world.cube.vertex_count, TETCAST_POINT);
    TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    for (int k = 0; k < 3; ++k) {
      camera.eye[k] *= scale;
      camera.target[k] *= scale;
    }
    TetcastTransferFunction *transfer = transfer_of(world.fixture.context, 1 / scale);
    double *pixels = picture(world.fixture.context, &world.body, transfer, &camera, W, H, NULL);
    tetcast_transfer_function_destroy(&transfer);
    if (!first)
      first = pixels;
    else {
      assert_memory_equal(first, pixels, VALUES * sizeof *pixels);
      free(pixels);
    }
    world_end(&world);
  }
  free(first);
}

/* The picture of a scene as it is now; the caller frees it. */
static double *shot_of(TetcastContext *context, const TetcastScene *scene) {
  double *pixels = malloc(VALUES * sizeof *pixels);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  const TetcastRenderDesc render = render_desc();
  assert_int_equal(tetcast_scene_render(scene, &camera, &render, frame, NULL), TETCAST_OK);
  tetcast_frame_destroy(&frame);
  return pixels;
}

/* Gives the scene a field of these values, which goes again. */
static TetcastStatus show(TetcastContext *context, TetcastScene *scene, const double *values, int64_t count,
                          TetcastAssociation association) {
  TetcastField *field = field_of(context, values, count, association);
  const TetcastStatus status = tetcast_scene_set_field(scene, field);
  tetcast_field_destroy(&field);
  return status;
}

/* Fields of cells, fields replaced, NaN. */
static void fields_come_and_go(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  TetcastContext *context = world.fixture.context;
  TetcastTransferFunction *transfer = transfer_of(context, 1);
  TetcastScene *scene = scene_of(context, &world.body, transfer);
  const int64_t vertices = world.cube.vertex_count, cell_count = world.cube.cell_count;
  double *before = shot_of(context, scene);

  /* constant per cell: as if the point field were constant */
  double *constant = malloc((size_t)cell_count * sizeof *constant);
  for (int64_t i = 0; i < cell_count; ++i)
    constant[i] = 0.52;
  assert_int_equal(show(context, scene, constant, cell_count, TETCAST_CELL), TETCAST_OK);
  double *cells = shot_of(context, scene);
  assert_int_equal(show(context, scene, constant, vertices, TETCAST_POINT), TETCAST_OK);
  double *points = shot_of(context, scene);
  assert_true(largest_difference(cells, points, VALUES) < 1e-13);
  assert_true(largest_difference(cells, before, VALUES) > 0.1);

  /* a field of the wrong size is refused, and the one before stays */
  assert_int_equal(show(context, scene, constant, 7, TETCAST_POINT), TETCAST_ERROR_ARGUMENT);
  double *still = shot_of(context, scene);
  assert_memory_equal(points, still, VALUES * sizeof *still);

  /* all NaN: nothing to see; back to the first field: the same bits */
  for (int64_t i = 0; i < cell_count; ++i)
    constant[i] = NAN;
  assert_int_equal(show(context, scene, constant, cell_count, TETCAST_CELL), TETCAST_OK);
  double *nothing = shot_of(context, scene);
  for (int i = 0; i < VALUES; ++i)
    assert_true(nothing[i] == 0);
  assert_int_equal(show(context, scene, world.cube.values, vertices, TETCAST_POINT), TETCAST_OK);
  double *after = shot_of(context, scene);
  assert_memory_equal(before, after, VALUES * sizeof *after);
  free(before), free(cells), free(points), free(still), free(nothing), free(after), free(constant);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

/* One NaN vertex makes exactly its cells transparent: as if they were not there. */
static void nan_vertices_are_holes(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 5, 0.5, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 2);
    TetcastContext *context = world.fixture.context;
    const int64_t hole = world.cube.vertex_count / 2;
    const double value = world.cube.values[hole];
    world.cube.values[hole] = traversal ? (double)NAN : (double)INFINITY;
    world_field(&world, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
    double *with_nan = shot(&world, 1, 0, false, NULL);
    int64_t kept = 0;
    for (int64_t i = 0; i < world.cube.cell_count; ++i) {
      const int64_t *c = &world.cube.cells[4 * i];
      if (c[0] == hole || c[1] == hole || c[2] == hole || c[3] == hole)
        continue;
      memmove(&world.cube.cells[4 * kept++], c, 4 * sizeof *c);
    }
    assert_true(kept < world.cube.cell_count);
    world.cube.cell_count = kept;
    world.cube.values[hole] = value;
    TetcastMesh *mesh = cube_mesh(context, &world.cube);
    body_destroy(&world.body);
    world.body =
        body_of(context, mesh, TETCAST_TRAVERSAL_SHELL, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
    double *without = shot(&world, 1, 0, false, NULL);
    assert_true(largest_difference(with_nan, without, VALUES) < 1e-13);
    free(with_nan), free(without);
    tetcast_mesh_destroy(&mesh);
    world_end(&world);
  }
}

/* A supersampled picture is the mean of the finer one. */
static void samples_average(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  TetcastContext *context = world.fixture.context;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastTransferFunction *transfer = transfer_of(context, 1);
  TetcastScene *scene = scene_of(context, &world.body, transfer);
  const int grids[2][2] = {{3, 3}, {3, 2}}; /* samples across and down */
  for (int g = 0; g < 2; ++g) {
    const int nx = grids[g][0], ny = grids[g][1], w = 12 / nx, h = 12 / ny;
    double *fine = picture(context, &world.body, transfer, &camera, 12, 12, NULL);
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = w;
    desc.height = h;
    TetcastFrame *frame;
    assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
    TetcastRenderDesc render = tetcast_render_desc_default();
    render.samples = nx * ny;
    TetcastRenderStats stats;
    assert_int_equal(tetcast_scene_render(scene, &camera, &render, frame, &stats), TETCAST_OK);
    assert_int_equal(stats.rays, 144);
    const double *pixels = tetcast_frame_pixels(frame);
    for (int p = 0; w == h && p < w * h;
         ++p) { /* the picture's aspect is that of its pixels: only the square one compares */
      for (int k = 0; k < 4; ++k) {
        double mean = 0;
        for (int s = 0; s < nx * ny; ++s)
          mean += fine[4 * ((p / w * ny + s / nx) * 12 + p % w * nx + s % nx) + k] / (nx * ny);
        assert_true(fabs(mean - pixels[4 * p + k]) < 1e-14);
      }
    }
    free(fine);
    tetcast_frame_destroy(&frame);
  }
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

static bool cancel(void *user, double fraction) {
  *(double *)user = fraction;
  return fraction < 0.3;
}

static void cancelling(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  TetcastContext *context = world.fixture.context;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = 200;
  desc.height = 200;
  desc.type = TETCAST_TYPE_FLOAT32;
  TetcastFrame *frame;
  TetcastScene *scene;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(context, world.body.volume, &scene), TETCAST_OK);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  assert_int_equal(tetcast_scene_render(scene, &camera, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world.fixture.message, "no field"));
  assert_int_equal(tetcast_scene_set_field(scene, world.body.field), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(scene, &camera, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world.fixture.message, "no transfer function"));
  TetcastTransferFunction *transfer = transfer_of(context, 1);
  assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
  TetcastRenderDesc render = tetcast_render_desc_default();
  double seen = -1;
  render.progress = (TetcastProgress){cancel, &seen};
  render.samples = 64; /* so long that one thread can't do it all before the one that reports gets its turn */
  assert_int_equal(tetcast_scene_render(scene, &camera, &render, frame, NULL), TETCAST_ERROR_CANCELLED);
  assert_true(seen >= 0.3 && seen <= 1);
  render.progress.function = NULL;
  render.samples = 1;
  assert_int_equal(tetcast_scene_render(scene, &camera, &render, frame, NULL), TETCAST_OK); /* as if nothing had been */
  TetcastCamera bad = camera;
  bad.fovy = 180;
  assert_int_equal(tetcast_scene_render(scene, &bad, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  bad = camera;
  memcpy(bad.eye, bad.target, sizeof bad.eye);
  assert_int_equal(tetcast_scene_render(scene, &bad, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  bad = camera;
  for (int k = 0; k < 3; ++k)
    bad.up[k] = 3 * (bad.target[k] - bad.eye[k]);
  assert_int_equal(tetcast_scene_render(scene, &bad, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  bad.up[1] = NAN;
  assert_int_equal(tetcast_scene_render(scene, &bad, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_scene_destroy(&scene);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

static bool count_call(void *user, double fraction) {
  (void)fraction;
  ++*(int *)user;
  return true;
}

static double milliseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* Where a picture takes no time, nor does telling of its progress: the first time, ten tenths and the end, and once a
 * millisecond. */
static void short_pictures_have_little_to_tell(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0.5, TETCAST_TRAVERSAL_SHELL, 1);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 256;
  TetcastFrame *frame = NULL;
  TetcastScene *scene = NULL;
  TetcastTransferFunction *transfer = transfer_of(world.fixture.context, 1);
  assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(world.fixture.context, world.body.volume, &scene), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(scene, world.body.field), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 30, 30, 30); /* which sees nothing */
  TetcastRenderDesc render = tetcast_render_desc_default();
  int calls = 0;
  render.progress = (TetcastProgress){count_call, &calls};
  const double begin = milliseconds();
  for (int i = 0; i < 10; ++i)
    assert_int_equal(tetcast_scene_render(scene, &camera, &render, frame, NULL), TETCAST_OK);
  assert_true(calls >= 10 * 9 && calls <= 10 * 12 + (milliseconds() - begin));
  tetcast_transfer_function_destroy(&transfer);
  tetcast_scene_destroy(&scene);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

/* Two scenes of one volume, and one of another context, in three threads. */
typedef struct Job {
  World *world;
  double factor;
  double *pixels;
} Job;

static void *run_job(void *argument) {
  Job *job = argument;
  job->pixels = shot(job->world, job->factor, 0, false, NULL);
  return NULL;
}

static void scenes_in_threads(void **state) {
  (void)state;
  World a, b;
  world_begin(&a, 6, 0.5, TETCAST_TRAVERSAL_SHELL, 2);
  world_begin(&b, 6, 0.5, TETCAST_TRAVERSAL_FACES, 2);
  Job jobs[3] = {{&a, 1, NULL}, {&a, 0.2, NULL}, {&b, 1, NULL}};
  pthread_t threads[3];
  for (int i = 0; i < 3; ++i)
    assert_int_equal(pthread_create(&threads[i], NULL, run_job, &jobs[i]), 0);
  for (int i = 0; i < 3; ++i)
    pthread_join(threads[i], NULL);
  double *alone = shot(&a, 0.2, 0, false, NULL);
  assert_memory_equal(alone, jobs[1].pixels, VALUES * sizeof *alone);
  assert_true(largest_difference(jobs[0].pixels, jobs[2].pixels, VALUES) < 1e-13);
  free(alone);
  for (int i = 0; i < 3; ++i)
    free(jobs[i].pixels);
  world_end(&a), world_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shell_equals_faces_for_any_number_of_threads),
      cmocka_unit_test(uniform_medium_gives_the_chord),
      cmocka_unit_test(perspective_chords),
      cmocka_unit_test(renumbering_changes_nothing),
      cmocka_unit_test(powers_of_two_change_no_bit),
      cmocka_unit_test(fields_come_and_go),
      cmocka_unit_test(nan_vertices_are_holes),
      cmocka_unit_test(samples_average),
      cmocka_unit_test(cancelling),
      cmocka_unit_test(short_pictures_have_little_to_tell),
      cmocka_unit_test(scenes_in_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
