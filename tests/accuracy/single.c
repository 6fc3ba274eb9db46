/* SPDX-License-Identifier: Apache-2.0 */
/* Single precision: the bound holds for random scenes and where it is hardest to keep, along the boundary of a mesh
 * seen edge-on, in a slit, among slivers, where paths overlap; and where there is no bound, as in meshes that fold over
 * themselves, double precision is used. Prints how much of the bounds is used. */
#include "support.h"

#include "base/cpu.h"
#include "volume/volume.h"

enum { WIDTH = 37, HEIGHT = 23, PIXELS = WIDTH * HEIGHT };

typedef struct Look {
  double rgba[4 * PIXELS], error[PIXELS];
  TetcastRenderStats stats;
} Look;

/* A frame without channels, whose rows lie apart, has the same pixels; in single precision its largest bound is known
 * all the same. */
static void look_plainly(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera,
                         const TetcastRenderDesc *desc, const Look *look) {
  enum { ROW = 4 * WIDTH + 3 };
  static double pixels[ROW * HEIGHT];
  for (int i = 0; i < ROW * HEIGHT; ++i)
    pixels[i] = -1;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = WIDTH;
  frame_desc.height = HEIGHT;
  frame_desc.pixels = pixels;
  frame_desc.row_stride = ROW * sizeof *pixels;
  TetcastFrame *frame = NULL;
  TetcastRenderStats stats;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(scene, camera, desc, frame, &stats), TETCAST_OK);
  for (int i = 0; i < HEIGHT; ++i) {
    assert_memory_equal(pixels + i * ROW, look->rgba + i * 4 * WIDTH, 4 * WIDTH * sizeof *pixels);
    for (int k = 4 * WIDTH; k < ROW; ++k)
      assert_true(pixels[i * ROW + k] == -1);
  }
  assert_string_equal(stats.precision, look->stats.precision);
  assert_true(strcmp(stats.precision, "single") == 0 ? stats.error == look->stats.error : isnan(stats.error));
  tetcast_frame_destroy(&frame);
}

static void look(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera, TetcastIsa isa,
                 double tolerance, Look *look) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = WIDTH;
  frame_desc.height = HEIGHT;
  frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.tolerance = tolerance;
  desc.isa = isa;
  assert_int_equal(tetcast_scene_render(scene, camera, &desc, frame, &look->stats), TETCAST_OK);
  assert_int_equal(look->stats.lost, 0);
  memcpy(look->rgba, tetcast_frame_pixels(frame), sizeof look->rgba);
  memcpy(look->error, tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR), sizeof look->error);
  tetcast_frame_destroy(&frame);
  if (tolerance > 0)
    look_plainly(context, scene, camera, &desc, look);
}

/* What is seen with a tolerance is as near to the exact picture of the same kernel as is said: where cells overlap,
 * kernels may differ in what comes first. Returns the kernels that used single
 * precision; *used: the largest share of a bound. */
static int check(TetcastContext *context, const Body *body, const TetcastTransferFunction *transfer,
                 const TetcastCamera *camera, double tolerance, double *used) {
  static Look exact, picture;
  TetcastScene *scene = scene_of(context, body, transfer);
  int single = 0, undecided = 0, compared = 0;
  for (TetcastIsa isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
    if (!tc_cpu_has(isa))
      continue;
    compared += PIXELS;
    look(context, scene, camera, isa, 0, &exact);
    assert_string_equal(exact.stats.precision, "double");
    look(context, scene, camera, isa, tolerance, &picture);
    const bool is_single = strcmp(picture.stats.precision, "single") == 0;
    single += is_single;
    if (isa < TETCAST_ISA_AVX2)
      assert_false(is_single);
    for (int i = 0; i < PIXELS; ++i) {
      if (exact.error[i] > tolerance) /* a ray along faces, on which side of them not even double precision tells */
        ++undecided;
      else
        assert_true(picture.error[i] <= tolerance);
      for (int k = 0; k < 4; ++k) {
        const double off = fabs(picture.rgba[4 * i + k] - exact.rgba[4 * i + k]);
        assert_true(off <= picture.error[i] + exact.error[i]);
        if (used && is_single && picture.error[i] > 0)
          *used = fmax(*used, off / picture.error[i]);
      }
    }
  }
  assert_true(undecided <= compared / 20);
  tetcast_scene_destroy(&scene);
  return single;
}

static int kernels(void) {
  return tc_cpu_has(TETCAST_ISA_AVX512) + tc_cpu_has(TETCAST_ISA_AVX2);
}

/* Continuous, with knots near or on the eighths; now and then of one colour. */
static TetcastTransferFunction *continuous(TetcastContext *context, uint64_t *seed, double strength, bool on_eighths) {
  double color[8][4], extinction[8][2];
  const bool gray = uniform(seed) < 0.25;
  for (int i = 0; i < 8; ++i) {
    color[i][0] = (i + (on_eighths ? 0 : 0.5) * uniform(seed)) / 8;
    extinction[i][0] = i % 2 ? color[i][0] : (i + (on_eighths ? 0 : 0.5) * uniform(seed)) / 8;
    for (int k = 1; k < 4; ++k)
      color[i][k] = gray ? 0.25 * k : uniform(seed);
    extinction[i][1] = uniform(seed) < 0.3 ? 0 : strength * uniform(seed);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = extinction[0];
  desc.color_count = desc.extinction_count = 8;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* Turned so that nothing lies along an axis. */
static void turn(double p[3]) {
  static const double axis[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}};
  double q[3];
  for (int k = 0; k < 3; ++k)
    q[k] = axis[k][0] * p[0] + axis[k][1] * p[1] + axis[k][2] * p[2];
  memcpy(p, q, sizeof q);
}

static TetcastCamera random_camera(int i, uint64_t *seed) {
  TetcastCamera camera = camera_of(0, 0, 0, 0, 0, 0);
  for (int k = 0; k < 3; ++k) {
    camera.eye[k] = i % 5 == 1 ? uniform(seed) : 5 * uniform(seed) - 2; /* some inside */
    camera.target[k] = 0.3 + 0.4 * uniform(seed);
  }
  if (i % 3 == 0)
    camera.projection = TETCAST_ORTHOGRAPHIC;
  if (i % 6 == 0) { /* rays within faces, through vertices */
    for (int k = 0; k < 3; ++k)
      camera.eye[k] = camera.target[k] = 0.5;
    camera.eye[i / 6 % 3] = 4;
    camera.up[1] = i / 6 % 3 != 1;
    camera.up[2] = i / 6 % 3 == 1;
  }
  return camera;
}

static void bounds_hold(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 11;
  int single = 0;
  double used = 0;
  for (int i = 0; i < 60; ++i) {
    Cube cube = cube_create(2 + i % 9, i % 4 ? 0.4 : 0);
    if (i % 10 == 9) { /* a thin plate */
      for (int64_t j = 0; j < cube.vertex_count; ++j)
        cube.vertices[3 * j + 2] = 0.5 + 1e-3 * cube.vertices[3 * j + 2];
    }
    const bool eighths = i % 7 == 3; /* whole cells lie on a knot */
    for (int64_t j = 0; eighths && j < cube.vertex_count; ++j)
      cube.values[j] = floor(4 * cube.values[j]) / 4;
    Body body = i % 2 ? single_body(fixture.context, &cube, cube.values, cube.vertex_count, TETCAST_POINT)
                      : cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
    TetcastTransferFunction *transfer = continuous(fixture.context, &seed, power(&seed, -3, 2), eighths);
    const TetcastCamera camera = random_camera(i, &seed);
    single += check(fixture.context, &body, transfer, &camera, i % 3 ? 1e-2 : 1e-3, &used);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    cube_destroy(&cube);
  }
  printf("%d of %d pictures in single precision, off by up to %.2g of the bound\n", single, 60 * kernels(), used);
  if (kernels())
    assert_true(single > 30);
  fixture_end(&fixture);
}

/* Two cubes turned askew, one a hair above the other, so that they are not connected, with different fields, seen along
 * the faces between them and along their sides, rays a little to either side, exactly along or at an angle at which
 * they enter and leave through these faces: vertices in single precision are not in one plane any more, and depths
 * there are off by much. */
static void edge_on(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 3;
  Cube one = cube_create(6, 0.4), two = {2 * one.vertex_count, 2 * one.cell_count, NULL, NULL, NULL};
  two.vertices = malloc((size_t)two.vertex_count * 3 * sizeof *two.vertices);
  two.values = malloc((size_t)two.vertex_count * sizeof *two.values);
  two.cells = malloc((size_t)two.cell_count * 4 * sizeof *two.cells);
  for (int64_t i = 0; i < two.vertex_count; ++i) {
    const int64_t j = i % one.vertex_count;
    double *p = &two.vertices[3 * i];
    memcpy(p, &one.vertices[3 * j], 3 * sizeof *p);
    p[1] += i >= one.vertex_count ? 1 + 1e-13 : 0;
    turn(p);
    two.values[i] = i < one.vertex_count ? 0.9 : 0.1 + 0.1 * one.values[j];
  }
  for (int64_t i = 0; i < 4 * two.cell_count; ++i) {
    two.cells[i] = one.cells[i % (4 * one.cell_count)] + (i < 4 * one.cell_count ? 0 : one.vertex_count);
  }
  Body body = cube_body(fixture.context, &two, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = continuous(fixture.context, &seed, 2, false);
  enum { VIEWS = 18 };
  int single = 0;
  for (int i = 0; i < VIEWS; ++i) { /* the picture's middle is in the plane */
    static const double tilts[3] = {0, 3e-7, -1e-5};
    const double plane = i / 2 % 3, tilt = tilts[i / 6 % 3], x = 0.37, distance = 3;
    double eye[3] = {i % 2 ? x : x - distance, plane + tilt * distance, i % 2 ? x - distance : x},
           target[3] = {x, plane, x}, up[3] = {0, 1, 0};
    turn(eye), turn(target), turn(up);
    TetcastCamera camera = camera_of(eye[0], eye[1], eye[2], target[0], target[1], target[2]);
    memcpy(camera.up, up, sizeof up);
    camera.projection = TETCAST_ORTHOGRAPHIC;
    camera.height = tilt == 0 ? 3e-8 : fabs(tilt); /* lower than rounding; or as high as the cubes seem from the side */
    single += check(fixture.context, &body, transfer, &camera, 1e-2, NULL);
  }
  assert_int_equal(single, VIEWS * kernels());
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&one);
  cube_destroy(&two);
  fixture_end(&fixture);
}

static int64_t inner_vertex(int n, uint64_t *seed) {
  int64_t i = 0;
  for (int k = 0; k < 3; ++k)
    i = i * (n + 1) + 1 + (int64_t)(uniform(seed) * (n - 1));
  return i;
}

/* A cube with the vertices of each cell in another order, and with `count` inner vertices moved far. */
static Cube shuffled_cube(int n, double jitter, int64_t count, uint64_t *seed) {
  Cube cube = cube_create(n, jitter);
  for (int64_t i = 0; i < count; ++i)
    cube.vertices[3 * inner_vertex(n, seed) + i % 3] += 2.0 / n;
  for (int64_t i = 0; i < cube.cell_count; ++i) {
    for (int k = 3; k > 0; --k) {
      const int j = (int)(uniform(seed) * (k + 1));
      const int64_t vertex = cube.cells[4 * i + k];
      cube.cells[4 * i + k] = cube.cells[4 * i + j];
      cube.cells[4 * i + j] = vertex;
    }
  }
  return cube;
}

/* Meshes that fold over themselves are told apart from others, in whatever order cells have their vertices, in double
 * and in single precision, in any unit; and single precision isn't used with them. */
static void folded(void **state) {
  (void)state;
  static const struct {
    int n;
    double jitter;
    int moved; /* vertices */
    bool folds;
  } cases[] = {{6, 1.5, 0, true}, {20, 0.7, 0, true}, {6, 0, 0, false},  {6, 0.4, 0, false}, {20, 0.45, 0, false},
               {6, 0.4, 1, true}, {20, 0, 1, true},   {20, 0, 40, true}, {3, 0, 1, true},    {1, 0, 0, false}};
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 23;
  for (size_t i = 0; i < 4 * sizeof cases / sizeof *cases; ++i) {
    const size_t of = i / 4;
    Cube cube = shuffled_cube(cases[of].n, cases[of].jitter, cases[of].moved, &seed);
    for (int64_t j = 0; i % 4 > 1 && j < cube.vertex_count; ++j) {
      turn(&cube.vertices[3 * j]);
      for (int k = 0; k < 3; ++k)
        cube.vertices[3 * j + k] *= 1e-3;
    }
    Body body = i % 2 ? single_body(fixture.context, &cube, cube.values, cube.vertex_count, TETCAST_POINT)
                      : cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
    assert_int_equal(body.volume->folds, cases[of].folds);
    TetcastTransferFunction *transfer = continuous(fixture.context, &seed, i % 4 > 1 ? 1e3 : 1, false);
    TetcastCamera camera = random_camera(2, &seed);
    for (int k = 0; i % 4 > 1 && k < 3; ++k)
      camera.eye[k] *= 1e-3, camera.target[k] *= 1e-3;
    const int single = check(fixture.context, &body, transfer, &camera, 1e-3, NULL);
    if (cases[of].folds)
      assert_int_equal(single, 0);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* Two cubes in one place or nearly, not connected, with different fields: rays have two paths that overlap, and which
 * comes first is often a matter of rounding. */
static void overlapping(void **state) {
  (void)state;
  enum { VIEWS = 24 };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 29;
  int single = 0;
  for (int i = 0; i < VIEWS; ++i) {
    const double apart = i % 3 == 0 ? 1e-10 : i % 3 == 1 ? 1e-8 : 0.3;
    Cube one = cube_create(4, 0.4), two = {2 * one.vertex_count, 2 * one.cell_count, NULL, NULL, NULL};
    two.vertices = malloc((size_t)two.vertex_count * 3 * sizeof *two.vertices);
    two.values = malloc((size_t)two.vertex_count * sizeof *two.values);
    two.cells = malloc((size_t)two.cell_count * 4 * sizeof *two.cells);
    for (int64_t j = 0; j < two.vertex_count; ++j) {
      const int64_t of = j % one.vertex_count;
      double *p = &two.vertices[3 * j];
      memcpy(p, &one.vertices[3 * of], 3 * sizeof *p);
      if (j >= one.vertex_count) {
        for (int k = 0; k < 3; ++k)
          p[k] = 0.5 + (0.8 + 0.1 * k) * (p[k] - 0.5); /* no vertex is in the place of another one */
        p[0] += 0.1 + apart;
      }
      turn(p);
      two.values[j] = j < one.vertex_count ? 0.9 : 0.1;
    }
    for (int64_t j = 0; j < 4 * two.cell_count; ++j)
      two.cells[j] = one.cells[j % (4 * one.cell_count)] + (j < 4 * one.cell_count ? 0 : one.vertex_count);
    Body body = cube_body(fixture.context, &two, TETCAST_TRAVERSAL_SHELL);
    assert_false(body.volume->folds);
    TetcastTransferFunction *transfer = continuous(fixture.context, &seed, 3, false);
    double eye[3] = {4 * (i % 2 ? 1 : -1), 0.5 + 0.2 * uniform(&seed), 0.4}, target[3] = {0.5, 0.5, 0.5};
    turn(eye), turn(target);
    TetcastCamera camera = camera_of(eye[0], eye[1], eye[2], target[0], target[1], target[2]);
    single += check(fixture.context, &body, transfer, &camera, 1e-2, NULL);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    cube_destroy(&one);
    cube_destroy(&two);
  }
  assert_int_equal(single, VIEWS * kernels());
  fixture_end(&fixture);
}

/* A body that is much smaller than a pixel, in the middle of a wide picture: what vertices are rounded by is a larger
 * part of its cells than elsewhere. */
static void small_in_a_wide_picture(void **state) {
  (void)state;
  enum { WIDE = 8191, VIEWS = 60 };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  uint64_t seed = 5;
  Cube cube = cube_create(2, 0);
  for (int64_t i = 0; i < cube.vertex_count; ++i) {
    cube.values[i] = uniform(&seed);
    turn(&cube.vertices[3 * i]);
  }
  Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
  TetcastTransferFunction *transfer = gray_of(fixture.context, 2);
  TetcastScene *scene = scene_of(fixture.context, &body, transfer);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = WIDE;
  frame_desc.height = 1;
  frame_desc.channels = TETCAST_CHANNEL_ERROR;
  int seen = 0;
  for (int i = 0; i < VIEWS; ++i) {
    TetcastCamera camera = random_camera(3, &seed); /* orthographic */
    double middle[3] = {0.3 + 0.4 * uniform(&seed), 0.3 + 0.4 * uniform(&seed), 0.3 + 0.4 * uniform(&seed)};
    turn(middle);
    for (int k = 0; k < 3; ++k)
      camera.eye[k] += middle[k] - camera.target[k], camera.target[k] = middle[k];
    camera.height = 60;
    double alpha[2], error[2];
    for (int single = 0; single < 2; ++single) {
      TetcastFrame *frame = NULL;
      assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
      TetcastRenderDesc desc = tetcast_render_desc_default();
      desc.tolerance = single ? 0.1 : 0;
      TetcastRenderStats stats;
      assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, &stats), TETCAST_OK);
      assert_string_equal(stats.precision, single && kernels() ? "single" : "double");
      alpha[single] = ((const double *)tetcast_frame_pixels(frame))[4 * (WIDE / 2) + 3];
      error[single] = ((const double *)tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR))[WIDE / 2];
      tetcast_frame_destroy(&frame);
    }
    seen += alpha[0] > 0;
    assert_true(fabs(alpha[1] - alpha[0]) <= error[0] + error[1]);
  }
  assert_true(seen > VIEWS / 2);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* The precision that a scene is rendered in with a tolerance of 1e-3: whatever it is, the bound holds. */
static const char *precision_of(Fixture *fixture, const Cube *cube, TetcastAssociation association, double color[3][4],
                                double extinction[3][2], double tolerance) {
  TetcastMesh *mesh = cube_mesh(fixture->context, cube);
  double *cells = malloc((size_t)cube->cell_count * sizeof *cells);
  for (int64_t i = 0; i < cube->cell_count; ++i)
    cells[i] = 0.5;
  const bool of_cells = association == TETCAST_CELL;
  Body body = body_of(fixture->context, mesh, TETCAST_TRAVERSAL_SHELL, of_cells ? cells : cube->values,
                      of_cells ? cube->cell_count : cube->vertex_count, association);
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = extinction[0];
  desc.color_count = desc.extinction_count = 3;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(fixture->context, &desc, &transfer), TETCAST_OK);
  const TetcastCamera camera = camera_of(2.2, 1.7, 2.9, 0.5, 0.5, 0.5);
  const int single = check(fixture->context, &body, transfer, &camera, tolerance, NULL);
  assert_true(single == 0 || single == kernels());
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  tetcast_mesh_destroy(&mesh);
  free(cells);
  return single ? "single" : "double";
}

/* Where nothing bounds the error, or not enough. Slivers don't matter: what they do is measured along rays, few of
 * which cross them. */
static void without_bound(void **state) {
  (void)state;
  enum { PLAIN, STEP, JUMP_OF_COLOR, STEEP, CELLS, NOT_A_NUMBER, OFFSET, SLIVER, FLAT, STRICT, CASES };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  for (int i = 0; i < CASES && kernels(); ++i) {
    Cube cube = cube_create(4, 0.5);
    double color[3][4] = {{0, 1, 0.5, 0}, {0.5, 0, 1, 0.5}, {1, 0.5, 0, 1}},
           extinction[3][2] = {{0, 0}, {0.5, 1}, {1, 2}};
    if (i == STEP)
      extinction[0][0] = 0.5; /* from 0 to 1 at once */
    if (i == JUMP_OF_COLOR)
      color[0][0] = 0.5;
    if (i == STEEP)
      extinction[1][0] = 0.5 - 1e-5, extinction[2][0] = 0.5, extinction[2][1] = 5;
    if (i == NOT_A_NUMBER)
      cube.values[62] = NAN;
    for (int k = 0; i == OFFSET && k < 3; ++k)
      color[k][0] += 1e5, extinction[k][0] += 1e5;
    for (int64_t j = 0; i == OFFSET && j < cube.vertex_count; ++j)
      cube.values[j] += 1e5;
    /* Two inner vertices almost, or entirely, in one place. */
    if (i == SLIVER || i == FLAT)
      memcpy(&cube.vertices[3 * 62], &cube.vertices[3 * 63], 3 * sizeof(double));
    if (i == SLIVER)
      cube.vertices[3 * 62] -= 1e-7;
    assert_string_equal(precision_of(&fixture, &cube, i == CELLS ? TETCAST_CELL : TETCAST_POINT, color, extinction,
                                     i == STRICT ? 1e-6 : 1e-3),
                        i == PLAIN || i == SLIVER || i == FLAT ? "single" : "double");
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_hold),
                                     cmocka_unit_test(edge_on),
                                     cmocka_unit_test(folded),
                                     cmocka_unit_test(overlapping),
                                     cmocka_unit_test(small_in_a_wide_picture),
                                     cmocka_unit_test(without_bound)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
