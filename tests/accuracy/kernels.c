/* SPDX-License-Identifier: Apache-2.0 */
/* All kernels give what the plain way gives (plain.h): random transfer functions and blend modes on fields of points,
 * cells and corners, and coefficients in groups, in ray space and on the screen, stored in single and in double
 * precision, with NaN, from outside, inside and in parallel, pictures that are no multiple of a packet, both
 * traversals. Prints how far they are apart. */
#include "all_kernels.h"

enum {
  WIDTH = 37,
  HEIGHT = 23,
  PIXELS = WIDTH * HEIGHT,
  SCENES = 160,
  GROUP_SCENES = 60,
  VALUE_SCENES = 60,
  MOST_GROUPS = 21
};

/* Some values, some of them NaN, some of them on eighths. */
static double *random_values(const Cube *cube, int i, TetcastAssociation association, uint64_t *seed, int64_t *count) {
  *count =
      association == TETCAST_POINT ? cube->vertex_count : cube->cell_count * (association == TETCAST_CORNER ? 4 : 1);
  double *values = malloc((size_t)*count * sizeof *values);
  for (int64_t j = 0; j < *count; ++j) {
    values[j] = association == TETCAST_CELL    ? uniform(seed)
                : association == TETCAST_POINT ? cube->values[j]
                                               : cube->values[cube->cells[j]];
    if (association == TETCAST_CORNER)
      values[j] += 0.1 * (uniform(seed) - 0.5); /* a jump */
    if (i % 4 == 3 && uniform(seed) < 0.02)
      values[j] = NAN;
    if (i % 5 == 4)
      values[j] = floor(4 * values[j]) / 4; /* whole cells on a knot */
  }
  return values;
}

static TetcastField *random_field(TetcastContext *context, const double *values, int64_t count,
                                  TetcastAssociation association, bool single) {
  if (!single)
    return field_of(context, values, count, association);
  float *rounded = malloc((size_t)count * sizeof *rounded);
  for (int64_t i = 0; i < count; ++i)
    rounded[i] = (float)values[i];
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){rounded, TETCAST_TYPE_FLOAT32, count, 0};
  desc.association = association;
  TetcastField *field = NULL;
  assert_int_equal(tetcast_field_create(context, &desc, &field), TETCAST_OK);
  free(rounded);
  return field;
}

static TetcastVolume *random_volume(TetcastContext *context, const Cube *cube, int i) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  float *vertices = malloc((size_t)cube->vertex_count * 3 * sizeof *vertices);
  for (int64_t j = 0; j < 3 * cube->vertex_count; ++j)
    vertices[j] = (float)cube->vertices[j];
  desc.vertices = (TetcastArray){i % 2 ? (void *)vertices : (void *)cube->vertices,
                                 i % 2 ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  TetcastMesh *mesh = NULL;
  TetcastVolume *volume = NULL;
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.corners = 1;
  volume_desc.traversal = i % 9 == 7 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL;
  assert_int_equal(tetcast_mesh_create(context, &desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_volume_create(context, mesh, &volume_desc, &volume), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  free(vertices);
  return volume;
}

/* Hundreds of knots, as colour maps have, many pieces without extinction. */
static TetcastTransferFunction *dense_transfer(TetcastContext *context, uint64_t *seed) {
  enum { KNOTS = 300 };
  double color[KNOTS][4], extinction[KNOTS][2];
  bool empty = false;
  for (int i = 0; i < KNOTS; ++i) {
    color[i][0] = (i + 0.9 * uniform(seed)) / KNOTS;
    for (int k = 1; k < 4; ++k)
      color[i][k] = uniform(seed);
    if (uniform(seed) < 0.2)
      empty = !empty;
    extinction[i][0] = i % 3 ? color[i][0] : (i + 0.9 * uniform(seed)) / KNOTS;
    extinction[i][1] = empty ? 0 : power(seed, -1, 3);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = extinction[0];
  desc.color_count = desc.extinction_count = KNOTS;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* Of one colour, with pieces so narrow that slopes need a scale. */
static TetcastTransferFunction *narrow_transfer(TetcastContext *context) {
  const double color[4] = {0, 0.5, 0.25, 1},
               extinction[4][2] = {{0.2, 0}, {0.5, 3}, {nextafter(0.5, 1), 1e300}, {0.9, 2}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = 1;
  desc.extinction = extinction[0];
  desc.extinction_count = 4;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static TetcastCamera random_camera(int i, uint64_t *seed) {
  TetcastCamera camera = {.up = {0, 1, 0.1}, .fovy = i % 8 == 1 ? 130 : 35, .height = 1.5};
  for (int k = 0; k < 3; ++k) {
    camera.eye[k] = i % 4 == 1 ? uniform(seed) : 5 * uniform(seed) - 2; /* some inside */
    camera.target[k] = 0.3 + 0.4 * uniform(seed);
  }
  if (i % 6 == 0)
    camera.projection = TETCAST_ORTHOGRAPHIC;
  if (i % 12 == 0) { /* rays within faces, through vertices */
    for (int k = 0; k < 3; ++k)
      camera.eye[k] = camera.target[k] = 0.5;
    camera.eye[2] = 4;
  }
  return camera;
}

/* How far kernels are from the plain way, relative to the largest colour: [in ray space, on the screen][kernel]. */
static double worst[2][ALL_KERNELS];

static void worse(const TcJob *job, int kernel, double off) {
  double *largest = &worst[job->screen != NULL][kernel];
  if (!(off <= *largest))
    *largest = off;
}

/* A picture of a scene, prepared for kernels. */
typedef struct Stage {
  TetcastContext *context;
  TcJob job;
  TcScreen screen;
  int samples;      /* of a pixel */
  double *expected; /* the plain way's sums */
  /* What each pixel may be off by, relative to others: 1, but for means of a field that jumps, which depths of faces
   * move by their error times the jump over the ray's length in cells. */
  double loose[PIXELS];
  int64_t segments; /* of these */
  bool deep;        /* some of its rays are so deep that kernels need not follow them to their ends */
} Stage;

static void stage_begin(Stage *stage, TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera,
                        int samples_x) {
  *stage = (Stage){.context = context, .samples = samples_x};
  stage->job = (TcJob){.width = WIDTH, .height = HEIGHT, .samples_x = samples_x, .samples_y = 1, .to_the_end = true};
  assert_int_equal(tc_view_create(context, camera, scene->volume, (double)WIDTH / HEIGHT, &stage->job.view),
                   TETCAST_OK);
  assert_int_equal(tc_scene_prepare(scene), TETCAST_OK);
  tc_job_of_scene(scene, false, &stage->job);
  stage->expected = malloc((size_t)(PIXELS * stage->job.sums) * sizeof *stage->expected);
}

static void stage_end(Stage *stage) {
  free(stage->screen.vertices);
  free(stage->expected);
}

/* Goes on to the screen. False: it can't. */
static bool stage_on_screen(Stage *stage) {
  return stage->job.shell->volume->traversal == TETCAST_TRAVERSAL_SHELL && project_all(&stage->job, &stage->screen);
}

/* The plain way's sums. */
static void expect(Stage *stage) {
  const TcJob *job = &stage->job;
  const PlainScene scene = {.shell = job->shell,
                            .values = job->values,
                            .pieces = job->pieces,
                            .coefficients = job->coefficients,
                            .blend = job->blend,
                            .screen = job->screen};
  double *one = calloc((size_t)job->sums, sizeof *one);
  memset(stage->expected, 0, (size_t)(PIXELS * job->sums) * sizeof *stage->expected);
  stage->segments = 0;
  stage->deep = false;
  for (int p = 0; p < PIXELS * stage->samples; ++p) {
    const int pixel = p / stage->samples, x = pixel % WIDTH, y = pixel / WIDTH;
    const PlainRay ray = plain_ray(&job->view, WIDTH, HEIGHT, job->samples_x, 1, x, y, p % stage->samples, job->screen);
    const PlainResult result = plain_cast(&scene, &ray, one);
    assert_false(result.lost);
    stage->segments += result.segments;
    stage->deep = stage->deep || (job->pieces && result.depth > 37);
    if (p % stage->samples == 0)
      stage->loose[pixel] = 1;
    if (job->blend == TETCAST_BLEND_AVERAGE && job->values->association != TETCAST_POINT && result.met > 0) {
      stage->loose[pixel] = fmax(stage->loose[pixel], (double)(1 / result.met));
    }
    for (int k = 0; k < job->sums; ++k)
      stage->expected[pixel * job->sums + k] += one[k];
  }
  resolve(&stage->job);
  free(one);
}

/* What is off, at most. */
static double largest_off(const Stage *stage, const double *sums) {
  const int all = stage->job.sums;
  double largest = 0;
  for (int i = 0; i < PIXELS * all; ++i) {
    const double wanted = stage->expected[i],
                 off = fabs(sums[i] - wanted) / fmax(1, fabs(wanted)) / stage->loose[i / all];
    if (!(off <= largest))
      largest = off;
  }
  return largest;
}

/* The same rays in another order, as samples. */
static void render_samples(const Stage *stage, int kernel, double *sums) {
  const int count = PIXELS * stage->samples;
  TcSample *samples = malloc((size_t)count * sizeof *samples);
  for (int i = 0; i < count; ++i) {
    const int j = (int)((int64_t)i * 1009 % count), pixel = j / stage->samples; /* 1009 has no divisor of the count's */
    samples[i] = (TcSample){.x = pixel % WIDTH, .y = pixel / WIDTH, .pixel = pixel, .sample = j % stage->samples};
  }
  TcWorker worker;
  memset(sums, 0, (size_t)(PIXELS * stage->job.sums) * sizeof *sums);
  assert_true(tc_worker_begin(stage->context, all_kernels[kernel].kernels, &stage->job, &worker));
  assert_true(all_kernels[kernel].kernels->samples(&stage->job, samples, count, &worker, sums));
  assert_int_equal(worker.lost, 0);
  tc_worker_end(stage->context, &worker);
  free(samples);
}

/* For kernels that know light in the volume or a second dimension: light that changes nothing, at each vertex, and two
 * rows that are the transfer function itself. */
typedef struct Nothing {
  TcLights lights;
  TcSecond second;
  double *places;
} Nothing;

static void nothing_begin(const Stage *stage, Nothing *nothing) {
  const TetcastVolume *volume = stage->job.shell->volume;
  *nothing = (Nothing){.lights = {.width = TC_LIGHT_GRAY, .factor = 1}};
  nothing->lights.at = calloc((size_t)volume->vertex_count, sizeof *nothing->lights.at);
  for (int64_t i = 0; i < volume->vertex_count; ++i)
    nothing->lights.at[i][0] = 1;
  if (!stage->job.pieces)
    return;
  TetcastTransferFunction only = {.pieces = *stage->job.pieces}, *rows[] = {&only};
  assert_int_equal(tc_second_build(stage->context, rows, 1, stage->job.pieces, &nothing->second), TETCAST_OK);
  nothing->second.cell = nothing->places = calloc((size_t)volume->cell_count + 1, sizeof *nothing->places);
}

static void nothing_end(const Stage *stage, Nothing *nothing) {
  tc_second_clear(stage->context, &nothing->second);
  free(nothing->lights.at);
  free(nothing->places);
}

/* Each kernel's picture, by each row that serves, against the plain one; `rows` counts what was tested. */
static void check(Stage *stage, double color, double limit, int rows[TC_KERNELS]) {
  TcJob *job = &stage->job;
  const int chosen = job->kernel;
  double *sums = malloc((size_t)(PIXELS * job->sums) * sizeof *sums);
  expect(stage);
  Nothing nothing;
  nothing_begin(stage, &nothing);
  for (int row = 0; row < TC_KERNELS; ++row) {
    job->kernel = chosen;
    if (!row_serves(&kernel_rows[row], job))
      continue;
    static const TcSurfaces none = {.count = 0};
    job->kernel = row;
    job->surfaces = kernel_rows[row].features & TC_SURFACES ? &none : NULL;
    TcLights lights = nothing.lights;
    if (kernel_rows[row].features & TC_TINTED) /* no light at all is the same there */
      lights = (TcLights){.width = TC_LIGHT_TINTED, .factor = 1};
    job->lights = &lights;
    job->second = &nothing.second;
    for (int kernel = 0; kernel < ALL_KERNELS; ++kernel) {
      if (!kernel_runs(kernel, job->shell->volume) || (kernel_rows[row].one_lane && kernel > 0))
        continue;
      const Count count = render_all(stage->context, kernel, job, sums);
      assert_int_equal(count.lost, 0);
      if (stage->deep)
        assert_true(count.segments <= stage->segments);
      else
        assert_int_equal(count.segments, stage->segments); /* the traversal is the same, to the bit */
      double off = largest_off(stage, sums) / color;
      render_samples(stage, kernel, sums);
      off = fmax(off, largest_off(stage, sums) / color);
      off /= stage->samples;
      worse(job, kernel, off);
      if (!(off <= limit))
        fail_msg("%s, row %s: off by %g", all_kernels[kernel].kernels->name, kernel_rows[row].name, off);
      ++rows[row];
    }
  }
  nothing_end(stage, &nothing);
  job->lights = NULL;
  job->second = NULL;
  job->kernel = chosen;
  free(sums);
}

static void print_worst(void) {
  for (int k = 0; k < ALL_KERNELS; ++k) {
    if (tc_cpu_has(all_kernels[k].isa)) {
      printf("%-8s %.1e in ray space, %.1e on the screen\n", all_kernels[k].kernels->name, worst[0][k], worst[1][k]);
    }
  }
  memset(worst, 0, sizeof worst);
}

/* Kernels round scalars and depths at faces each in its own way. That counts where the transfer function is steep, or
 * the field jumps and what is seen of it is dense. */
static bool is_sharp(const TcPieces *pieces, TetcastAssociation association, double color) {
  double steep = 0, dense = 0;
  for (int64_t i = 0; i <= pieces->count; ++i) {
    steep = fmax(steep, pieces->rows_f64[i][TC_PIECE_STEEP]);
    dense = fmax(dense, fmax(pieces->pieces[i].at_low.extinction, pieces->pieces[i].at_high.extinction));
  }
  return steep > 1e5 * color || (association != TETCAST_POINT && dense > 100);
}

static void light_is_that_of_the_plain_way(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = fixture.context;
  uint64_t seed = 3;
  Cube cube = cube_create(6, 0.6);
  int screens = 0, rows[TC_KERNELS] = {0};
  for (int i = 0; i < repetitions(SCENES); ++i) {
    const TetcastAssociation association = i % 3 == 2            ? TETCAST_CELL
                                           : i % 3 == 1 && i % 2 ? TETCAST_CORNER
                                                                 : TETCAST_POINT;
    int64_t count;
    double *values = random_values(&cube, i, association, &seed, &count), color = 1;
    Body body = {random_volume(context, &cube, i), random_field(context, values, count, association, i / 2 % 2)};
    TetcastTransferFunction *transfer = i % 7 == 5   ? dense_transfer(context, &seed)
                                        : i % 7 == 6 ? narrow_transfer(context)
                                                     : random_transfer(context, &seed);
    const TetcastCamera camera = random_camera(i, &seed);
    TetcastScene *scene = scene_of(context, &body, transfer);
    Stage stage;
    stage_begin(&stage, context, scene, &camera, i % 10 == 2 ? 2 : 1);
    for (int k = 0; k < 3; ++k)
      color = fmax(color, stage.job.pieces->largest[k]);
    const double limit = is_sharp(stage.job.pieces, association, color) ? 2e-13 : 1e-14;
    check(&stage, color, limit, rows);
    if (stage_on_screen(&stage)) {
      check(&stage, color, limit, rows);
      ++screens;
    }
    stage_end(&stage);
    tetcast_scene_destroy(&scene);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    free(values);
  }
  print_worst();
  assert_true(screens > repetitions(SCENES) / 4);
  for (int row = 0; row < TC_KERNELS; ++row) {
    if (kernel_rows[row].features & TC_SURFACES)
      continue; /* tests/unit/isosurface.c compares their pictures */
    if (!strcmp(kernel_rows[row].gatherer, "emission") && !rows[row])
      fail_msg("row %s was not tested", kernel_rows[row].name);
  }
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Every blend mode on fields of points, cells and corners. */
static void values_are_those_of_the_plain_way(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = fixture.context;
  uint64_t seed = 21;
  Cube cube = cube_create(6, 0.6);
  TetcastTransferFunction *transfer = gray_of(context, 0); /* which hides nothing of it */
  int screens = 0, rows[TC_KERNELS] = {0};
  for (int i = 0; i < repetitions(VALUE_SCENES); ++i) {
    const TetcastAssociation association = i % 3 == 2            ? TETCAST_CELL
                                           : i % 3 == 1 && i % 2 ? TETCAST_CORNER
                                                                 : TETCAST_POINT;
    int64_t count;
    double *values = random_values(&cube, i, association, &seed, &count);
    Body body = {random_volume(context, &cube, i), random_field(context, values, count, association, i / 2 % 2)};
    const TetcastCamera camera = random_camera(i, &seed);
    TetcastScene *scene = scene_of(context, &body, transfer);
    for (int blend = TETCAST_BLEND_MAXIMUM; blend <= TETCAST_BLEND_ADDITIVE; ++blend) {
      assert_int_equal(tetcast_scene_set_blend(scene, (TetcastBlend)blend), TETCAST_OK);
      Stage stage;
      stage_begin(&stage, context, scene, &camera, i % 10 == 2 ? 2 : 1);
      check(&stage, 1, 4e-15, rows);
      if (stage_on_screen(&stage)) {
        check(&stage, 1, 4e-15, rows);
        ++screens;
      }
      stage_end(&stage);
    }
    tetcast_scene_destroy(&scene);
    body_destroy(&body);
    free(values);
  }
  print_worst();
  assert_true(screens > repetitions(VALUE_SCENES));
  assert_true(rows[TC_KERNEL_value] && rows[TC_KERNEL_value_cells] && rows[TC_KERNEL_value_corners]);
  tetcast_transfer_function_destroy(&transfer);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Extinctions and emissions in groups, of points and of cells, some of them one for all groups, some not there. */
static void groups_are_those_of_the_plain_way(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = fixture.context;
  uint64_t seed = 12;
  Cube cube = cube_create(6, 0.6);
  int screens = 0, rows[TC_KERNELS] = {0};
  for (int i = 0; i < repetitions(GROUP_SCENES); ++i) {
    static const int numbers[] = {1, 2, 3, 4, 5, 8, 9, 16, MOST_GROUPS};
    const int groups = numbers[i % 9], kinds = i / 9 % 4;
    const int counts[2] = {kinds == 1            ? 1
                           : kinds == 2 && i % 2 ? 0
                                                 : groups,
                           kinds == 3               ? 1
                           : kinds == 2 && !(i % 2) ? 0
                                                    : groups};
    TetcastField *fields[2][MOST_GROUPS];
    for (int list = 0; list < 2; ++list) {
      for (int g = 0; g < counts[list]; ++g) {
        const bool cells = i % 5 == 1 ? g % 2 : i % 5 == 2 ? list : i % 5 == 3;
        const int64_t count = cells ? cube.cell_count : cube.vertex_count;
        double *values = malloc((size_t)count * sizeof *values);
        for (int64_t j = 0; j < count; ++j) {
          values[j] = uniform(&seed) < 0.1 ? 0 : power(&seed, -3, list ? 0 : i % 3);
          if (i % 4 == 3 && uniform(&seed) < 0.02)
            values[j] = NAN;
        }
        fields[list][g] = random_field(context, values, count, cells ? TETCAST_CELL : TETCAST_POINT, i / 2 % 2);
        free(values);
      }
    }
    TetcastVolume *volume = random_volume(context, &cube, i);
    TetcastScene *scene = NULL;
    assert_int_equal(tetcast_scene_create(context, volume, &scene), TETCAST_OK);
    TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
    desc.extinction = (const TetcastField *const *)fields[0];
    desc.emission = (const TetcastField *const *)fields[1];
    desc.extinction_count = counts[0];
    desc.emission_count = counts[1];
    assert_int_equal(tetcast_scene_set_coefficients(scene, &desc), TETCAST_OK);
    const TetcastCamera camera = random_camera(i, &seed);
    Stage stage;
    stage_begin(&stage, context, scene, &camera, i % 10 == 2 ? 2 : 1);
    check(&stage, 1, 2e-14, rows); /* extinctions of cells jump by up to 100: depths of faces are rounded */
    if (stage_on_screen(&stage)) {
      check(&stage, 1, 2e-14, rows);
      ++screens;
    }
    stage_end(&stage);
    tetcast_scene_destroy(&scene);
    tetcast_volume_destroy(&volume);
    for (int list = 0; list < 2; ++list) {
      for (int g = 0; g < counts[list]; ++g)
        tetcast_field_destroy(&fields[list][g]);
    }
  }
  print_worst();
  assert_true(screens > repetitions(GROUP_SCENES) / 4);
  assert_true(rows[TC_KERNEL_groups] && rows[TC_KERNEL_groups_bound]);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* ── threads ── */

enum { WIDE = 83, HIGH = 61 };

/* The bytes of a picture with all channels that the scene has. */
static unsigned char *bytes_of(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera,
                               const TetcastRenderDesc *desc, uint32_t channels, size_t *size,
                               TetcastRenderStats *stats) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = WIDE;
  frame_desc.height = HIGH;
  frame_desc.channels = channels;
  frame_desc.groups = tetcast_scene_groups(scene) ? tetcast_scene_groups(scene) : 1;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(scene, camera, desc, frame, stats), TETCAST_OK);
  const size_t number = WIDE * HIGH * sizeof(double);
  unsigned char *bytes = malloc(number * (10 + 5 * (size_t)frame_desc.groups));
  memcpy(bytes, tetcast_frame_pixels(frame), 4 * number);
  *size = 4 * number;
  for (int i = 0; tetcast_channel_info(i); ++i) {
    const TetcastChannelInfo *info = tetcast_channel_info(i);
    if (!(channels & info->channel))
      continue;
    const size_t more = number * (size_t)(info->of_groups ? frame_desc.groups : info->components);
    memcpy(bytes + *size, tetcast_frame_channel(frame, info->channel), more);
    *size += more;
  }
  tetcast_frame_destroy(&frame);
  return bytes;
}

/* Without jumps, so that single precision may be used. */
static TetcastTransferFunction *continuous_transfer(TetcastContext *context) {
  const double color[2][4] = {{0, 1, 0.2, 0}, {1, 0.1, 0.5, 1}}, extinction[3][2] = {{0.1, 0}, {0.5, 4}, {0.9, 1}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = 2;
  desc.extinction = extinction[0];
  desc.extinction_count = 3;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* A scene of fields of points, cells or corners, or of groups. */
static TetcastScene *scene_for_threads(TetcastContext *context, const Cube *cube, TetcastVolume *volume, int kind) {
  enum { GROUPS = 5 };
  uint64_t seed = 5;
  TetcastScene *scene = NULL;
  assert_int_equal(tetcast_scene_create(context, volume, &scene), TETCAST_OK);
  if (kind < 3) {
    int64_t count;
    double *values = random_values(cube, 0, (TetcastAssociation)kind, &seed, &count);
    TetcastField *field = field_of(context, values, count, (TetcastAssociation)kind);
    TetcastTransferFunction *transfer = continuous_transfer(context);
    assert_int_equal(tetcast_scene_set_field(scene, field), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
    tetcast_transfer_function_destroy(&transfer);
    tetcast_field_destroy(&field);
    free(values);
    return scene;
  }
  TetcastField *fields[GROUPS];
  for (int g = 0; g < GROUPS; ++g)
    fields[g] = field_of(context, cube->values, cube->vertex_count, TETCAST_POINT);
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = desc.emission = (const TetcastField *const *)fields;
  desc.extinction_count = desc.emission_count = GROUPS;
  assert_int_equal(tetcast_scene_set_coefficients(scene, &desc), TETCAST_OK);
  for (int g = 0; g < GROUPS; ++g)
    tetcast_field_destroy(&fields[g]);
  return scene;
}

/* Pictures by any number of threads have the same bits, by every kernel, exact, within a tolerance, with the
 * integrators that others use, and in a blend mode. */
static void threads_change_no_bit(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  TetcastContext *context = fixture.context;
  Cube cube = cube_create(5, 0.6);
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)};
  int singles = 0;
  for (int i = 0; i < 2 * 4 * 5; ++i) {
    const int kind = i % 4, way = i / 4 % 5,
              traversal = i / 20; /* way: exact, exact with bounds and samples, tolerance, sampled, blend mode */
    if ((kind == 3 && way >= 3) || (test_short() && (kind + way) % 3 != 2))
      continue;
    TetcastVolume *volume = random_volume(context, &cube, traversal ? 7 : 0);
    TetcastScene *scene = scene_for_threads(context, &cube, volume, kind);
    if (way == 4)
      assert_int_equal(tetcast_scene_set_blend(scene, (TetcastBlend)(1 + (kind + traversal) % 4)), TETCAST_OK);
    uint32_t channels = way == 4 ? TETCAST_CHANNEL_VALUE : 0;
    for (int c = 0; tetcast_channel_info(c) && way < 3; ++c) {
      const TetcastChannelInfo *info = tetcast_channel_info(c);
      const bool wanted = info->needs_coefficients ? kind == 3
                          : info->needs_composite  ? way == 0 && kind != 3
                                                   : way > 0;
      if (!info->needs_blend && wanted)
        channels |= info->channel;
    }
    for (int isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
      if (!tc_cpu_has((TetcastIsa)isa))
        continue;
      TetcastRenderDesc desc = tetcast_render_desc_default();
      desc.isa = (TetcastIsa)isa;
      desc.samples = way == 1 || way == 4 ? 3 : 1;
      desc.tolerance = way == 2 ? 1e-2 : 0;
      if (way == 3)
        desc.integrator = TETCAST_INTEGRATOR_TRAPEZOID, desc.integrator_n = 3;
      unsigned char *first = NULL;
      for (int round = 0; round < 3; ++round) {
        static const int threads[] = {1, 2, 5};
        size_t size;
        TetcastRenderStats stats;
        assert_int_equal(tetcast_context_set_threads(context, threads[round]), TETCAST_OK);
        unsigned char *bytes = bytes_of(context, scene, &cameras[i % 2], &desc, channels, &size, &stats);
        singles += !strcmp(stats.precision, "single");
        if (first)
          assert_memory_equal(first, bytes, size);
        if (first)
          free(bytes);
        else
          first = bytes;
      }
      free(first);
    }
    tetcast_scene_destroy(&scene);
    tetcast_volume_destroy(&volume);
  }
  if (tc_cpu_has(TETCAST_ISA_AVX2))
    assert_true(singles > 0);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(light_is_that_of_the_plain_way), cmocka_unit_test(values_are_those_of_the_plain_way),
      cmocka_unit_test(groups_are_those_of_the_plain_way), cmocka_unit_test(threads_change_no_bit)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
