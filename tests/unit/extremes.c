/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of inputs, each near an end of what a double can hold, whose product or quotient is beyond it: no crash, no
 * pixel that is not a number, and the picture that the same scene gives in ordinary units. */
#include "support.h"

#include <float.h>

enum { W = 13, H = 10, VALUES = 4 * W * H, CELLS = 3 };

static const double ends[] = {1e-320, 1e-300, 1e-160, 1e-9, 1, 1e9, 1e160, 1e300, 1.7e307};
enum { ENDS = sizeof ends / sizeof *ends, LENGTHS = ENDS - 1 }; /* coordinates may be 1e300 at most */

/* A scene whose numbers are those of an ordinary one, times powers of ten. */
typedef struct Units {
  double length, value, extinction, color; /* factors */
  bool orthographic;
  int samples;
  bool step; /* of the extinction, in the middle */
} Units;

static const Units ordinary = {1, 1, 1, 1, false, 1, false};

/* How a scene is rendered. */
typedef struct Way {
  const char *name;
  TetcastTraversal traversal;
  TetcastIsa isa;
  TetcastIntegrator integrator;
  int n;
  TetcastAssociation association;
  double tolerance;
} Way;

static const Way ways[] = {
    {"scalar", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_SCALAR, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_POINT, 0},
    {"faces", TETCAST_TRAVERSAL_FACES, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_POINT, 0},
    {"avx2", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AVX2, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_POINT, 0},
    {"avx512", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AVX512, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_POINT, 0},
    {"cells, scalar", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_SCALAR, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_CELL, 0},
    {"cells, packets", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_CELL, 0},
    {"single", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_EXACT, 1, TETCAST_POINT, 1e-2},
    {"midpoint", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_MIDPOINT, 3, TETCAST_POINT, 0},
    {"trapezoid", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_TRAPEZOID, 3, TETCAST_POINT, 0},
    {"gauss", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_GAUSS, 5, TETCAST_POINT, 0},
    {"table", TETCAST_TRAVERSAL_SHELL, TETCAST_ISA_AUTO, TETCAST_INTEGRATOR_TABLE, 16, TETCAST_POINT, 0},
};
enum { WAYS = sizeof ways / sizeof *ways };

/* The picture, or NULL where a number is not finite or a camera that far away is refused. */
static double *render(const Way *way, const Units *units) {
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube cube = cube_create(CELLS, 0.5);
  for (int64_t i = 0; i < 3 * cube.vertex_count; ++i)
    cube.vertices[i] *= units->length;
  for (int64_t i = 0; i < cube.vertex_count; ++i)
    cube.values[i] *= units->value;
  double *cell_values = malloc((size_t)cube.cell_count * sizeof *cell_values);
  for (int64_t i = 0; i < cube.cell_count; ++i)
    cell_values[i] = cube.values[cube.cells[4 * i]];
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  TetcastField *field = way->association == TETCAST_POINT
                            ? field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT)
                            : field_of(fixture.context, cell_values, cube.cell_count, TETCAST_CELL);
  Body body = {volume_of(fixture.context, mesh, way->traversal), field};
  const double v = units->value, k = units->extinction, c = units->color;
  const double color[][4] = {{0, c, 0.5 * c, 0.25 * c}, {0.9 * v, 0.2 * c, 0.3 * c, c}},
               extinction[][2] = {{0.1 * v, 0.001 * k}, {0.6 * v, 3 * k}};
  const double step[][2] = {{0.5 * v, 1e-10 * k}, {0.5 * v, 3 * k}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = units->step ? step[0] : extinction[0];
  desc.color_count = desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_OK);
  TetcastScene *scene = scene_of(fixture.context, &body, transfer);
  const double m = units->length;
  const TetcastCamera camera = {.eye = {2.1 * m, 1.7 * m, 3.3 * m},
                                .target = {0.5 * m, 0.5 * m, 0.5 * m},
                                .up = {0, 1, 0.1},
                                .fovy = 30,
                                .height = 1.5 * m,
                                .projection = units->orthographic ? TETCAST_ORTHOGRAPHIC : TETCAST_PERSPECTIVE};
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  if (way->integrator == TETCAST_INTEGRATOR_EXACT)
    frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
  TetcastRenderDesc render_desc = tetcast_render_desc_default();
  render_desc.isa = way->isa;
  render_desc.integrator = way->integrator;
  render_desc.integrator_n = way->n;
  render_desc.tolerance = way->tolerance;
  render_desc.samples = units->samples;
  TetcastRenderStats stats;
  assert_int_equal(tetcast_scene_render(scene, &camera, &render_desc, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  double *pixels = malloc(VALUES * sizeof *pixels);
  memcpy(pixels, tetcast_frame_pixels(frame), VALUES * sizeof *pixels);
  tetcast_frame_destroy(&frame);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  tetcast_mesh_destroy(&mesh);
  free(cell_values);
  cube_destroy(&cube);
  fixture_end(&fixture);
  return pixels;
}

/* Nothing but numbers, opacities in [0, 1], colours not above the brightest. */
static void check_pixels(const Way *way, const Units *units, const double *pixels, int count) {
  for (int i = 0; i < count; ++i) {
    const double most = i % 4 == 3 ? 1 : fmin(units->color, 0x1p500);
    if (!(pixels[i] >= 0 && pixels[i] <= most * (1 + 1e-9))) {
      fail_msg("%s: length %g, value %g, extinction %g, colour %g: channel %d of pixel %d is %g", way->name,
               units->length, units->value, units->extinction, units->color, i % 4, i / 4, pixels[i]);
    }
  }
}

static void close_to(const Way *way, const Units *units, const double *pixels, const double *wanted, double factor,
                     double tolerance) {
  check_pixels(way, units, pixels, VALUES);
  for (int i = 0; i < VALUES; ++i) {
    const double f = i % 4 == 3 ? 1 : factor;
    if (!(fabs(pixels[i] / f - wanted[i]) <= tolerance)) {
      fail_msg("%s: length %g, value %g, extinction %g, colour %g: channel %d of pixel %d is %.17g, not %.17g",
               way->name, units->length, units->value, units->extinction, units->color, i % 4, i / 4, pixels[i] / f,
               wanted[i]);
    }
  }
}

/* Extinction times length is what counts: where it is the same, so is the picture; where it is beyond every bound, that
 * of an opaque wall; where it is nothing, nothing. The integrators that sample see a wall as they can. */
static void extinction_and_length(void **state) {
  (void)state;
  for (int w = 0; w < WAYS; ++w) {
    const Way *way = &ways[w];
    double *base = render(way, &ordinary), *wall = render(way, &(Units){1, 1, 1e200, 1, false, 1, false});
    for (int i = 0; i < LENGTHS; ++i) {
      for (int j = 0; j < ENDS; ++j) {
        if (test_short() && (w + i + j) % 4 != 0)
          continue;
        const Units units = {ends[i], 1, ends[j], 1, (i + j) % 2, 1 + 3 * (j % 2), false};
        double *pixels = render(way, &units);
        check_pixels(way, &units, pixels, VALUES);
        const double depth = log10(units.length) + log10(units.extinction);
        for (int p = 0; p < VALUES; ++p) {
          if (depth < -30)
            assert_true(pixels[p] < 1e-28);
        }
        free(pixels);
        if (depth < 100 && i > 0)
          continue;
        if (i > 0) {
          const Units again = {units.length, 1, units.extinction, 1, false, 1, false};
          pixels = render(way, &again);
          /* A ramp to the cap instead of to something else that is as opaque. */
          close_to(way, &again, pixels, wall, 1, 1e-9);
          free(pixels);
        }
      }
      if (i == 0)
        continue; /* too few bits */
      const Units inverse = {ends[i], 1, 1 / ends[i], 1, false, 1, false};
      double *pixels = render(way, &inverse);
      close_to(way, &inverse, pixels, base, 1, way->tolerance > 0 ? 2 * way->tolerance : 1e-11);
      free(pixels);
    }
    free(base);
    free(wall);
  }
}

/* Fields and knots of any magnitude, alone and next to extinctions of any. */
static void values_and_extinction(void **state) {
  (void)state;
  for (int w = 0; w < WAYS; ++w) {
    const Way *way = &ways[w];
    double *base = render(way, &ordinary);
    for (int i = 0; i < ENDS; ++i) {
      const double value = i == ENDS - 1 ? DBL_MAX : ends[i];
      for (int j = 0; j < ENDS; ++j) {
        if (test_short() && (w + i + j) % 4 != 0)
          continue;
        const Units units = {1, value, ends[j], 1, false, 1, false};
        double *pixels = render(way, &units);
        check_pixels(way, &units, pixels, VALUES);
        free(pixels);
      }
      const Units units = {1, value, 1, 1, false, 1, false};
      double *pixels = render(way, &units);
      close_to(way, &units, pixels, base, 1, i == 0 ? 1e-3 : way->tolerance > 0 ? 2 * way->tolerance : 1e-11);
      free(pixels);
    }
    free(base);
  }
}

/* Colours times opacities, summed up over samples. */
static void colors_and_samples(void **state) {
  (void)state;
  for (int w = 0; w < WAYS; ++w) {
    const Way *way = &ways[w];
    if (way->tolerance > 0)
      continue; /* absolute */
    double *base[2] = {render(way, &ordinary), render(way, &(Units){1, 1, 1, 1, false, 16, false})};
    for (int i = 0; i < ENDS; ++i) {
      for (int many = 0; many < 2; ++many) {
        if (test_short() && (w + i + many) % 4 != 0)
          continue;
        const Units units = {1, 1, 1, ends[i], false, many ? 16 : 1, false};
        double *pixels = render(way, &units);
        check_pixels(way, &units, pixels, VALUES);
        if (i > 0 && ends[i] <= 0x1p500)
          close_to(way, &units, pixels, base[many], units.color, 1e-11);
        free(pixels);
        for (int step = 0; step < 2; ++step) {
          const Units wall = {1, 1, 1.7e307, ends[i], false, many ? 16 : 1, step};
          pixels = render(way, &wall);
          /* Gauss's rule is no sum of what is seen: across a step it may be anything. */
          if (step && way->integrator == TETCAST_INTEGRATOR_GAUSS) {
            for (int p = 0; p < VALUES; ++p)
              assert_true(isfinite(pixels[p]));
          } else {
            check_pixels(way, &wall, pixels, VALUES);
          }
          free(pixels);
        }
      }
    }
    free(base[0]);
    free(base[1]);
  }
}

/* A transfer function over all that a double can hold: a field in its middle sees the middle of the ramp. */
static void ranges_wider_than_a_double(void **state) {
  (void)state;
  static const double limits[] = {1e300, 8e307, 1e308, DBL_MAX};
  for (size_t l = 0; l < sizeof limits / sizeof *limits; ++l) {
    for (int w = 0; w < WAYS; ++w) {
      const Way *way = &ways[w];
      for (int huge = 0; huge < 3; ++huge) {
        Fixture fixture;
        assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
        Cube cube = cube_create(CELLS, 0.5);
        const double at = huge == 2 ? 1e-310 : huge ? 0.5 * limits[l] : 0.3; /* a constant field */
        const int64_t count = way->association == TETCAST_POINT ? cube.vertex_count : cube.cell_count;
        double *values = malloc((size_t)count * sizeof *values);
        for (int64_t i = 0; i < count; ++i)
          values[i] = at;
        TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
        TetcastField *field = field_of(fixture.context, values, count, way->association);
        Body body = {volume_of(fixture.context, mesh, way->traversal), field};
        const double color[][4] = {{-limits[l], 0, 0, 0}, {limits[l], 1, 1, 1}},
                     extinction[][2] = {{-limits[l], 0}, {limits[l], 4}};
        TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
        desc.color = color[0];
        desc.extinction = extinction[0];
        desc.color_count = desc.extinction_count = 2;
        TetcastTransferFunction *transfer = NULL;
        assert_int_equal(tetcast_transfer_function_create(fixture.context, &desc, &transfer), TETCAST_OK);
        const TetcastCamera camera = {.eye = {0.5, 0.5, 3},
                                      .target = {0.5, 0.5, 0.5},
                                      .up = {0, 1, 0},
                                      .projection = TETCAST_ORTHOGRAPHIC,
                                      .height = 0.5};
        TetcastScene *scene = scene_of(fixture.context, &body, transfer);
        TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
        frame_desc.width = frame_desc.height = 3;
        TetcastFrame *frame = NULL;
        assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
        TetcastRenderDesc render_desc = tetcast_render_desc_default();
        render_desc.isa = way->isa;
        render_desc.integrator = way->integrator;
        render_desc.integrator_n = way->n;
        assert_int_equal(tetcast_scene_render(scene, &camera, &render_desc, frame, NULL), TETCAST_OK);
        const double *pixels = tetcast_frame_pixels(frame), share = huge == 1 ? 0.75 : 0.5;
        for (int p = 0; p < 9; ++p) {
          const double alpha = -expm1(-4 * share);
          if (!(fabs(pixels[4 * p + 3] - alpha) < 1e-11 &&
                fabs(pixels[4 * p] - share * alpha) < (way->integrator == TETCAST_INTEGRATOR_TABLE ? 1e-2 : 1e-11))) {
            fail_msg("%s, ±%g, %g: %g %g", way->name, limits[l], at, pixels[4 * p], pixels[4 * p + 3]);
          }
        }
        tetcast_frame_destroy(&frame);
        tetcast_scene_destroy(&scene);
        tetcast_transfer_function_destroy(&transfer);
        if (!huge) { /* a preset over it, too */
          transfer = preset_of(fixture.context, &body, "viridis", -limits[l], limits[l]);
          int64_t knots;
          const double *found = tetcast_transfer_function_extinction(transfer, &knots);
          for (int64_t i = 0; i < 2 * knots; ++i)
            assert_true(isfinite(found[i]));
          assert_true(found[2 * knots - 1] > 0.5 && found[2 * knots - 1] < 5);
          tetcast_transfer_function_destroy(&transfer);
        }
        body_destroy(&body);
        tetcast_mesh_destroy(&mesh);
        free(values);
        cube_destroy(&cube);
        fixture_end(&fixture);
      }
    }
  }
}

/* Opacity over a unit distance of any size, in meshes of any: the extinction is refused or can be drawn. */
static void opacity_and_unit_distance(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  for (int i = 0; i < LENGTHS; ++i) {
    Cube cube = cube_create(CELLS, 0.5);
    for (int64_t p = 0; p < 3 * cube.vertex_count; ++p)
      cube.vertices[p] *= ends[i];
    Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
    const double m = ends[i];
    const TetcastCamera camera = camera_of(2.1 * m, 1.7 * m, 3.3 * m, 0.5 * m, 0.5 * m, 0.5 * m);
    for (int j = 0; j < ENDS; ++j) {
      for (int model = 0; model <= TETCAST_OPACITY_OSPRAY; ++model) {
        const double color[4] = {0, 1, 1, 1}, opacity[][2] = {{0, 5e-324}, {0.5, 0.5}, {1, 1}};
        TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
        desc.color = color;
        desc.color_count = 1;
        desc.opacity = opacity[0];
        desc.opacity_count = 3;
        desc.unit_distance = ends[j];
        desc.opacity_model = (TetcastOpacityModel)model;
        TetcastTransferFunction *transfer = NULL;
        const TetcastStatus status = tetcast_transfer_function_create(fixture.context, &desc, &transfer);
        assert_int_equal(status, 37 / ends[j] < DBL_MAX || (model && 1 / ends[j] < DBL_MAX) ? TETCAST_OK
                                                                                            : TETCAST_ERROR_ARGUMENT);
        if (status)
          continue;
        double *pixels = picture(fixture.context, &body, transfer, &camera, W, H, NULL);
        check_pixels(&ways[0], &ordinary, pixels, VALUES);
        free(pixels);
        tetcast_transfer_function_destroy(&transfer);
      }
    }
    /* A preset is half opaque on average, whatever the unit. */
    TetcastTransferFunction *transfer = preset_of(fixture.context, &body, "magma", 0, 1);
    double *pixels = picture(fixture.context, &body, transfer, &camera, W, H, NULL), most = 0;
    check_pixels(&ways[0], &ordinary, pixels, VALUES);
    for (int p = 0; p < W * H; ++p)
      most = fmax(most, pixels[4 * p + 3]);
    assert_true(i == 0 || (most > 0.4 && most < 0.95));
    free(pixels);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* Cameras from any distance, pictures of any height: refused or rendered. */
static void distances_and_heights(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  for (int i = 1; i < LENGTHS; ++i) {
    Cube cube = cube_create(CELLS, 0.5);
    for (int64_t p = 0; p < 3 * cube.vertex_count; ++p)
      cube.vertices[p] *= ends[i];
    Body body = cube_body(fixture.context, &cube, TETCAST_TRAVERSAL_SHELL);
    TetcastTransferFunction *transfer = gray_of(fixture.context, 1 / ends[i]);
    TetcastScene *scene = scene_of(fixture.context, &body, transfer);
    TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
    frame_desc.width = 15;
    frame_desc.height = 1;
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
    for (int j = 0; j < ENDS * ENDS; ++j) {
      if (test_short() && (i + j / ENDS + j) % 4 != 0)
        continue;
      for (int isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
        const double m = ends[i], distance = ends[j / ENDS], height = ends[j % ENDS];
        TetcastCamera camera = camera_of(0.5 * m, 0.5 * m, distance, 0.5 * m, 0.5 * m, 0.5 * m);
        camera.projection = TETCAST_ORTHOGRAPHIC;
        camera.height = height;
        if (camera.eye[2] == camera.target[2])
          continue;
        TetcastRenderDesc render_desc = tetcast_render_desc_default();
        render_desc.isa = (TetcastIsa)isa;
        const TetcastStatus status = tetcast_scene_render(scene, &camera, &render_desc, frame, NULL);
        if (status) {
          assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
          assert_true(fmax(distance, height) / m > 1e148 && strstr(fixture.message, "camera: "));
          continue;
        }
        assert_true(fmax(distance, height) / m < 1e152);
        const double *pixels = tetcast_frame_pixels(frame);
        check_pixels(&ways[0], &ordinary, pixels, 4 * 15);
        if (distance > m)
          assert_true(fabs(pixels[4 * 7 + 3] + expm1(-1)) <
                      1e-12); /* the middle one goes through the cube, from there */
      }
    }
    tetcast_frame_destroy(&frame);
    tetcast_scene_destroy(&scene);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* Coefficients of any magnitude, in meshes of any size: what is gathered is ∫ j e^−τ dt, or as much of it as a double
 * can hold. */
static void coefficients_lengths_and_samples(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  for (int i = 1; i < LENGTHS; ++i) {
    for (int traversal = 0; traversal < 2; ++traversal) {
      Cube cube = cube_create(CELLS, 0.5);
      for (int64_t p = 0; p < 3 * cube.vertex_count; ++p)
        cube.vertices[p] *= ends[i];
      Body body = cube_body(fixture.context, &cube, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
      TetcastScene *scene = NULL;
      assert_int_equal(tetcast_scene_create(fixture.context, body.volume, &scene), TETCAST_OK);
      const double m = ends[i];
      TetcastCamera camera = camera_of(0.5 * m, 0.5 * m, 3 * m, 0.5 * m, 0.5 * m, 0.5 * m);
      camera.projection = TETCAST_ORTHOGRAPHIC;
      camera.height = 0.5 * m;
      for (int j = 0; j < ENDS; ++j) {
        for (int k = 0; k < ENDS; ++k) {
          if (test_short() && (i + traversal + j + k) % 4 != 0)
            continue;
          double *values[2] = {malloc((size_t)cube.vertex_count * sizeof(double)),
                               malloc((size_t)cube.vertex_count * sizeof(double))};
          for (int64_t p = 0; p < cube.vertex_count; ++p)
            values[0][p] = ends[j], values[1][p] = ends[k];
          TetcastField *fields[2] = {field_of(fixture.context, values[0], cube.vertex_count, TETCAST_POINT),
                                     field_of(fixture.context, values[1], cube.vertex_count, TETCAST_POINT)};
          TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
          const TetcastField *extinction[2] = {fields[0], fields[0]}, *emission[2] = {fields[1], fields[1]};
          desc.extinction = extinction;
          desc.emission = emission;
          desc.extinction_count = desc.emission_count = 2;
          assert_int_equal(tetcast_scene_set_coefficients(scene, &desc), TETCAST_OK);
          TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
          frame_desc.width = frame_desc.height = 2;
          frame_desc.groups = 2;
          frame_desc.channels = TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH;
          TetcastFrame *frame = NULL;
          assert_int_equal(tetcast_frame_create(fixture.context, &frame_desc, &frame), TETCAST_OK);
          TetcastRenderDesc render_desc = tetcast_render_desc_default();
          render_desc.samples = 1 + 35 * (k % 2);
          assert_int_equal(tetcast_scene_render(scene, &camera, &render_desc, frame, NULL), TETCAST_OK);
          const double *radiance = tetcast_frame_channel(frame, TETCAST_CHANNEL_RADIANCE);
          const double *depth = tetcast_frame_channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH),
                       *rgba = tetcast_frame_pixels(frame);
          const long double tau = fminl((long double)ends[j] * (long double)m, 0x1p998L),
                            seen = tau < 1e-18L ? 1 : -expm1l(-tau) / tau;
          const long double wanted = (long double)ends[k] * (long double)m * seen;
          for (int p = 0; p < 8; ++p) {
            if (ends[j] > DBL_MIN && tau > DBL_MIN && tau < 0x1p998L &&
                !(fabsl((long double)depth[p] / tau - 1) < 1e-12L)) {
              fail_msg("length %g, extinction %g: depth %g, not %Lg", m, ends[j], depth[p], tau);
            }
            if (fmin(ends[j], ends[k]) > DBL_MIN && wanted > 2 * DBL_MIN && wanted < 0.25L * DBL_MAX && tau < 1e290L) {
              if (!(fabsl((long double)radiance[p] / wanted - 1) < 1e-12L &&
                    fabsl((long double)rgba[4 * (p / 2)] / wanted - 1) < 1e-12L)) {
                fail_msg("length %g, extinction %g, emission %g: %g, %g, not %Lg", m, ends[j], ends[k], radiance[p],
                         rgba[4 * (p / 2)], wanted);
              }
            }
            assert_true(!isnan(radiance[p]) && depth[p] >= 0 && depth[p] <= DBL_MAX);
          }
          tetcast_frame_destroy(&frame);
          for (int f = 0; f < 2; ++f) {
            tetcast_field_destroy(&fields[f]);
            free(values[f]);
          }
        }
      }
      tetcast_scene_destroy(&scene);
      body_destroy(&body);
      cube_destroy(&cube);
    }
  }
  fixture_end(&fixture);
}

/* Volumes are products of three lengths: the mesh's health, and how its cells are cut, is the same in all units that
 * leave the coordinates as exact. */
static void health_and_cutting(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  static const int exponents[] = {0, -980, -700, -400, -300, 300, 500, 700, 980};
  TetcastMeshHealth first = {0};
  TetcastCutInfo first_cut = {0};
  for (size_t e = 0; e < sizeof exponents / sizeof *exponents; ++e) {
    Cube cube = cube_create(4, 0.5);
    for (int64_t i = 0; i < 3 * cube.vertex_count; ++i)
      cube.vertices[i] = ldexp(cube.vertices[i], exponents[e]);
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    TetcastMeshHealth health;
    assert_int_equal(tetcast_mesh_health(fixture.context, mesh, &health), TETCAST_OK);
    assert_int_equal(health.degenerate_cells, 0);
    if (e == 0)
      first = health;
    assert_int_equal(health.inverted_cells, first.inverted_cells);
    assert_true(health.volume == ldexp(first.volume, 3 * exponents[e]) &&
                health.boundary_area == ldexp(first.boundary_area, 2 * exponents[e]));
    tetcast_mesh_destroy(&mesh);
    int64_t nodes[64][8], count = 0;
    for (int z = 0; z < 4; ++z) {
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x, ++count) {
          const int64_t o = x + 5 * (y + 5 * z), corner[8] = {o, o + 1, o + 6, o + 5, o + 25, o + 26, o + 31, o + 30};
          memcpy(nodes[count], corner, sizeof corner);
        }
      }
    }
    for (int i = 0; i < 64; i += 7) { /* tangled ones, which get a vertex in their middle, or are turned inside out */
      const int64_t node = nodes[i][6];
      nodes[i][6] = nodes[i][i % 2 ? 7 : 0];
      nodes[i][i % 2 ? 7 : 0] = node;
    }
    TetcastCellsDesc desc = tetcast_cells_desc_default();
    desc.vertices = (TetcastArray){cube.vertices, TETCAST_TYPE_FLOAT64, cube.vertex_count, 0};
    desc.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT64, count, 0};
    TetcastCut *cut = NULL;
    assert_int_equal(tetcast_cells_cut(fixture.context, &desc, &cut), TETCAST_OK);
    TetcastCutInfo info;
    tetcast_cut_info(cut, &info);
    if (e == 0)
      first_cut = info;
    assert_true(info.folded > 0 && info.centred > 0);
    assert_memory_equal(&info, &first_cut, sizeof info);
    tetcast_cut_destroy(&cut);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(extinction_and_length),     cmocka_unit_test(values_and_extinction),
      cmocka_unit_test(colors_and_samples),        cmocka_unit_test(ranges_wider_than_a_double),
      cmocka_unit_test(opacity_and_unit_distance), cmocka_unit_test(distances_and_heights),
      cmocka_unit_test(health_and_cutting),        cmocka_unit_test(coefficients_lengths_and_samples),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
