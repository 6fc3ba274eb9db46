/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of parts of rays: composited front to back they are the whole picture, of every kind of scene, whatever the
 * rays meet; a part is what a clip leaves there; rows are those of the whole; and what the library says where it can't.
 */
#include "world.h"

enum { W = 37, H = 29, PIXELS = W * H, PARTS = 7 };

static TetcastFrame *shoot(const World *world, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                           uint32_t channels, int groups) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.channels = channels;
  frame_desc.groups = groups;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, desc, frame, NULL), TETCAST_OK);
  return frame;
}

/* Each pixel's ray is cut at places of its own; some parts are empty, some begin behind the eye. */
static void cut_rays(uint64_t *seed, double from, double to, double cuts[PARTS + 1][PIXELS]) {
  for (int p = 0; p < PIXELS; ++p) {
    cuts[0][p] = p % 3 ? 0 : -1;
    for (int i = 1; i < PARTS; ++i)
      cuts[i][p] = fmax(cuts[i - 1][p], p % 5 && i == 3 ? cuts[2][p] : from + (to - from) * i / PARTS);
    for (int i = 1; i < PARTS; ++i)
      cuts[i][p] += 0.9 * (to - from) / PARTS * uniform(seed) * (i != 3);
    for (int i = 1; i < PARTS; ++i)
      cuts[i][p] = fmax(cuts[i][p], cuts[i - 1][p]);
    cuts[PARTS][p] = INFINITY;
  }
}

/* Composites the parts' pictures and compares them with the whole one. */
static void check(const World *world, const TetcastCamera *camera, double from, double to, const double off) {
  static double cuts[PARTS + 1][PIXELS], all[PIXELS][4];
  uint64_t seed = 5;
  cut_rays(&seed, from, to, cuts);
  memset(all, 0, sizeof all);
  TetcastRenderDesc desc = render_desc();
  TetcastFrame *whole = shoot(world, camera, &desc, 0, 1);
  int parts_seen = 0;
  for (int i = 0; i < PARTS; ++i) {
    const TetcastArray start = {cuts[i], TETCAST_TYPE_FLOAT64, PIXELS, 0},
                       stop = {cuts[i + 1], TETCAST_TYPE_FLOAT64, PIXELS, 0};
    desc.start = &start;
    desc.stop = &stop;
    TetcastFrame *part = shoot(world, camera, &desc, 0, 1);
    const double *pixels = tetcast_frame_pixels(part);
    bool any = false;
    for (int p = 0; p < PIXELS; ++p) {
      const double left = 1 - all[p][3];
      for (int k = 0; k < 4; ++k) {
        all[p][k] += left * pixels[4 * p + k];
        any = any || pixels[4 * p + k] != 0;
      }
    }
    parts_seen += any;
    tetcast_frame_destroy(&part);
  }
  assert_true(parts_seen > 3);
  const double *pixels = tetcast_frame_pixels(whole);
  for (int p = 0; p < PIXELS; ++p) {
    for (int k = 0; k < 4; ++k) {
      if (!(fabs(all[p][k] - pixels[4 * p + k]) <= off))
        fail_msg("pixel %d, channel %d: %.17g in parts, %.17g in one", p, k, all[p][k], pixels[4 * p + k]);
    }
  }
  tetcast_frame_destroy(&whole);
}

static const double ranges[][2] = {{3, 5}, {0, 1.2}, {3.6, 5.4}};

static TetcastCamera camera_number(int i) {
  return i == 0   ? camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5)
         : i == 1 ? camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)
                  : parallel(3, 2, 4, 1.6);
}

static void set_kind(World *world, TetcastAssociation association) {
  const Cube *cube = &world->cube;
  const int64_t count = count_of(cube, association);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = association == TETCAST_POINT  ? cube->values[i]
                : association == TETCAST_CELL ? cube->values[cube->cells[4 * i]]
                                              : cube->values[cube->cells[i]] + 0.05 * (double)(i % 3);
  set_values(world, values, association);
  free(values);
}

static void set_transfer(World *world, double factor) {
  TetcastTransferFunction *transfer = transfer_of(world->fixture.context, factor);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

static void parts_of_the_volume_are_the_whole(void **state) {
  (void)state;
  for (int i = 0; i < 2 * 3 * 3; ++i) {
    const TetcastCamera camera = camera_number(i % 3);
    World world;
    world_begin(&world, 5, 0.5, 1, i / 9 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    set_kind(&world, (TetcastAssociation)(i / 3 % 3));
    set_transfer(&world, i % 2 ? 1 : 0.1);
    check(&world, &camera, ranges[i % 3][0], ranges[i % 3][1], 1e-12);
    world_end(&world);
  }
}

/* Each surface is met in one part and no other. */
static void parts_of_surfaces_are_the_whole(void **state) {
  (void)state;
  for (int i = 0; i < 9; ++i) {
    const TetcastCamera camera = camera_number(i % 3);
    World world;
    world_begin(&world, 5, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
    set_kind(&world, TETCAST_POINT);
    set_transfer(&world, 0.1);
    const TetcastIsosurface surfaces[] = {{.value = 0.4, .color = {1, 0, 0}, .opacity = 0.3},
                                          {.value = 0.6, .color = {0, 1, 0}, .opacity = i % 2 ? 1 : 0.5}};
    const TetcastSlice slice = {.normal = {1, 2, 3}, .offset = 3, .opacity = 0.4};
    const TetcastBoundary boundary = {.opacity = 0.2, .colored = 1, .color = {0, 0, 1}};
    if (i / 3 != 1)
      assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, surfaces, 2), TETCAST_OK);
    if (i / 3 > 0)
      assert_int_equal(tetcast_scene_set_slices(world.scene, &slice, 1), TETCAST_OK);
    if (i / 3 > 0)
      assert_int_equal(tetcast_scene_set_boundary(world.scene, &boundary), TETCAST_OK);
    check(&world, &camera, ranges[i % 3][0], ranges[i % 3][1], 1e-12);
    world_end(&world);
  }
}

/* Radiance and optical depth of coefficients, and the error's bound, of two halves. */
static void parts_of_coefficients_are_the_whole(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastField *field = field_of(world.fixture.context, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
  const TetcastField *fields[] = {field, field};
  TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
  coefficients.extinction = coefficients.emission = fields;
  coefficients.extinction_count = coefficients.emission_count = 2;
  assert_int_equal(tetcast_scene_set_coefficients(world.scene, &coefficients), TETCAST_OK);
  tetcast_field_destroy(&field);
  const TetcastCamera camera = camera_number(0);
  double middle[PIXELS];
  for (int p = 0; p < PIXELS; ++p)
    middle[p] = 3.2 + 0.01 * (p % 50);
  const TetcastArray cut = {middle, TETCAST_TYPE_FLOAT64, PIXELS, 0};
  TetcastRenderDesc desc = render_desc();
  const uint32_t channels = TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_PATH_LENGTH | TETCAST_CHANNEL_ERROR;
  TetcastFrame *whole = shoot(&world, &camera, &desc, channels, 2);
  desc.stop = &cut;
  TetcastFrame *first = shoot(&world, &camera, &desc, channels, 2);
  desc.stop = NULL;
  desc.start = &cut;
  TetcastFrame *second = shoot(&world, &camera, &desc, channels, 2);
#define OF(frame, channel) ((const double *)tetcast_frame_channel(frame, channel))
  int both = 0;
  for (int p = 0; p < PIXELS; ++p) {
    const double *a = tetcast_frame_pixels(first), *b = tetcast_frame_pixels(second), *c = tetcast_frame_pixels(whole);
    for (int k = 0; k < 4; ++k)
      assert_true(fabs(a[4 * p + k] + (1 - a[4 * p + 3]) * b[4 * p + k] - c[4 * p + k]) < 1e-13);
    const double length = OF(first, TETCAST_CHANNEL_PATH_LENGTH)[p] + OF(second, TETCAST_CHANNEL_PATH_LENGTH)[p];
    assert_true(fabs(length - OF(whole, TETCAST_CHANNEL_PATH_LENGTH)[p]) < 1e-13);
    for (int g = 0; g < 2; ++g) {
      const int i = 2 * p + g;
      const double depth = OF(first, TETCAST_CHANNEL_OPTICAL_DEPTH)[i] + OF(second, TETCAST_CHANNEL_OPTICAL_DEPTH)[i];
      assert_true(fabs(depth - OF(whole, TETCAST_CHANNEL_OPTICAL_DEPTH)[i]) < 1e-13);
    }
    const bool in_both = a[4 * p + 3] > 0 && b[4 * p + 3] > 0;
    if (in_both) /* where the ray begins may be off, too */
      assert_true(OF(second, TETCAST_CHANNEL_ERROR)[p] > 0);
    both += in_both;
  }
  assert_true(both > PIXELS / 10);
  tetcast_frame_destroy(&first);
  tetcast_frame_destroy(&second);
  tetcast_frame_destroy(&whole);
  world_end(&world);
}

/* With a plane's distances as where rays start, they see what a clip leaves. */
static void a_start_is_a_clip(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  set_kind(&world, TETCAST_POINT);
  set_transfer(&world, 1);
  for (int i = 0; i < 3; ++i) {
    const TetcastCamera camera = camera_number(i);
    double eye[3], forward[3], distances[PIXELS];
    for (int k = 0; k < 3; ++k)
      forward[k] = camera.target[k] - camera.eye[k];
    const double offset = forward[0] * 0.5 + forward[1] * 0.5 + forward[2] * 0.5;
    for (int p = 0; p < PIXELS; ++p) {
      double direction[3], at = offset, slope = 0;
      ray_of(&camera, W, H, p, eye, direction);
      for (int k = 0; k < 3; ++k)
        at -= forward[k] * eye[k], slope += forward[k] * direction[k];
      distances[p] = at / slope;
    }
    const TetcastArray start = {distances, TETCAST_TYPE_FLOAT64, PIXELS, 0};
    const TetcastHalfSpace plane = {{forward[0], forward[1], forward[2]}, offset};
    TetcastRenderDesc desc = render_desc();
    desc.start = &start;
    desc.samples = 1;
    TetcastFrame *started = shoot(&world, &camera, &desc, 0, 1);
    desc.start = NULL;
    assert_int_equal(tetcast_scene_set_clip(world.scene, &plane, 1), TETCAST_OK);
    TetcastFrame *clipped = shoot(&world, &camera, &desc, 0, 1);
    assert_int_equal(tetcast_scene_set_clip(world.scene, NULL, 0), TETCAST_OK);
    assert_true(largest_difference(tetcast_frame_pixels(started), tetcast_frame_pixels(clipped), 4 * PIXELS) < 1e-12);
    tetcast_frame_destroy(&started);
    tetcast_frame_destroy(&clipped);
  }
  world_end(&world);
}

/* Rows of a picture, from wherever and however many, are those of the whole one; between rows that 16 divides, to the
 * bit. */
static void rows_are_those_of_the_whole(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.2, 1, TETCAST_TRAVERSAL_SHELL);
  set_kind(&world, TETCAST_POINT);
  const double color[3] = {1, 0, 0};
  const TetcastCamera camera = camera_number(1);
  TetcastRenderDesc desc = render_desc();
  TetcastFrame *whole = shoot(&world, &camera, &desc, TETCAST_CHANNEL_CELLS, 1);
  assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, &desc, color, whole), TETCAST_OK);
  static const int64_t parts[][2] = {{0, 1}, {0, 16}, {16, H - 16}, {3, 17}, {H - 1, 1}, {0, H}};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
    TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
    frame_desc.width = W;
    frame_desc.height = parts[i][1];
    frame_desc.channels = TETCAST_CHANNEL_CELLS;
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(world.fixture.context, &frame_desc, &frame), TETCAST_OK);
    desc.picture_height = H;
    desc.first_row = parts[i][0];
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, frame, NULL), TETCAST_OK);
    assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, &desc, color, frame), TETCAST_OK);
    const double *pixels = (const double *)tetcast_frame_pixels(whole) + 4 * W * parts[i][0];
    const double *cells = (const double *)tetcast_frame_channel(whole, TETCAST_CHANNEL_CELLS) + W * parts[i][0];
    const int64_t end = parts[i][0] + parts[i][1];
    if (parts[i][0] % 16 == 0 && (end % 16 == 0 || end == H))
      assert_memory_equal(tetcast_frame_pixels(frame), pixels, sizeof(double) * 4 * W * (size_t)parts[i][1]);
    else
      assert_true(largest_difference(tetcast_frame_pixels(frame), pixels, 4 * W * (size_t)parts[i][1]) < 1e-14);
    assert_memory_equal(tetcast_frame_channel(frame, TETCAST_CHANNEL_CELLS), cells,
                        sizeof(double) * W * (size_t)parts[i][1]);
    tetcast_frame_destroy(&frame);
  }
  tetcast_frame_destroy(&whole);
  world_end(&world);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_kind(&world, TETCAST_POINT);
  const TetcastCamera camera = camera_number(0);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 2;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
  double distances[4] = {0, 0, (double)NAN, 0};
  TetcastArray start = {distances, TETCAST_TYPE_FLOAT64, 4, 0};
  TetcastRenderDesc render = tetcast_render_desc_default();
  render.start = &start;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(world.fixture.message, "start: the distance of pixel (0, 1) is NaN");
  start.count = 3;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world.fixture.message, "start: 3 distances for a frame of 2 × 2 pixels"));
  static const int64_t rows[][2] = {{1, 0}, {5, 4}, {5, -1}, {-5, 0}, {1 << 21, 0}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
    render = tetcast_render_desc_default();
    render.picture_height = rows[i][0];
    render.first_row = rows[i][1];
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(world.fixture.message, "2 rows from row"));
  }
  render.picture_height = 5;
  render.first_row = 0;
  distances[2] = 0;
  start.count = 4;
  render.stop = &start;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(world.fixture.message, "rows of a picture: not possible with stop, start or adaptive");
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(parts_of_the_volume_are_the_whole),   cmocka_unit_test(parts_of_surfaces_are_the_whole),
      cmocka_unit_test(parts_of_coefficients_are_the_whole), cmocka_unit_test(a_start_is_a_clip),
      cmocka_unit_test(rows_are_those_of_the_whole),         cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
