/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh, of any shape, seen one by one: no crossing is lost or found twice where they meet, and their
 * fragments, composited, are the whole's picture. */
#include "partition.h"
#include "world.h"

/* ── crossings ── */

enum { SIDE = 17, CAMERAS = 50 };

/* The lengths of rays in all parts, in which extinction is 1. */
static void add_lengths(TetcastContext *context, const Partition *partition, const TetcastCamera *camera,
                        double *lengths) {
  memset(lengths, 0, SIDE * SIDE * sizeof *lengths);
  TetcastTransferFunction *transfer = gray_of(context, 1);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = SIDE;
  const TetcastRenderDesc desc = render_desc();
  for (int i = 0; i < partition->count; ++i) {
    if (!partition->part[i].scene)
      continue;
    TetcastFrame *frame = NULL;
    TetcastRenderStats stats;
    assert_int_equal(tetcast_scene_set_transfer_function(partition->part[i].scene, transfer), TETCAST_OK);
    assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
    assert_int_equal(tetcast_scene_render(partition->part[i].scene, camera, &desc, frame, &stats), TETCAST_OK);
    assert_int_equal(stats.lost, 0);
    const double *pixels = tetcast_frame_pixels(frame);
    for (int p = 0; p < SIDE * SIDE; ++p)
      lengths[p] -= log1p(-pixels[4 * p + 3]);
    tetcast_frame_destroy(&frame);
  }
  tetcast_transfer_function_destroy(&transfer);
}

/* Along an axis, each ray through a vertex of the grid, a middle of an edge or of a face, or beyond the mesh, and in
 * planes of faces; along diagonals, where many vertices lie behind each other; then to vertices, from outside and from
 * other vertices. The ray in the middle goes to the target. */
static TetcastCamera aimed_camera(int i, const Cube *cube) {
  if (i < 3) {
    TetcastCamera camera = parallel(0.5, 0.5, 0.5, SIDE / 8.0);
    camera.eye[i] = 3;
    camera.up[0] = i == 1, camera.up[1] = i != 1;
    return camera;
  }
  if (i < 6)
    return parallel(i == 3 ? 0.5 : 3, 3, 3 - 5 * (i == 5), 2);
  const double *eye = cube->vertices + 3 * (i * 7 % cube->vertex_count),
               *target = cube->vertices + 3 * (i * 31 % cube->vertex_count);
  return camera_of(eye[0], eye[1], eye[2] + (i % 3 ? 2 : 0), target[0], target[1], target[2]);
}

static void crossings_of_parts_are_those_of_the_whole(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  for (int jittered = 0; jittered < 2; ++jittered) {
    Cube cube = cube_create(4, jittered ? 0.5 : 0);
    Partition whole = partition_of(fixture.context, &cube, CUT_BOXES, 1);
    for (int cut = 0; cut < CUTS; ++cut) {
      Partition parts = partition_of(fixture.context, &cube, (Cut)cut, cut == 1 ? 5 : 8);
      for (int i = 0; i < CAMERAS; ++i) {
        const TetcastCamera camera = aimed_camera(i, &cube);
        static double one[SIDE * SIDE], all[SIDE * SIDE];
        add_lengths(fixture.context, &whole, &camera, one);
        add_lengths(fixture.context, &parts, &camera, all);
        const double off = largest_difference(one, all, SIDE * SIDE); /* a crossing is longer, lost or found twice */
        if (!(off < 1e-14))
          fail_msg("cut %d, camera %d: lengths are off by %g", cut, i, off);
      }
      partition_end(&parts);
    }
    partition_end(&whole);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* A ray that passes through many vertices one behind the other, as it goes along edges, does so whatever their numbers;
 * those of parts are shuffled. */
static void numbers_of_vertices_do_not_matter(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(8, 0);
  for (int64_t i = 0; i < cube.vertex_count; ++i) /* so near that their order along the curve is that of the numbers */
    cube.vertices[3 * i + 2] = 0.5 + 0x1p-24 * cube.vertices[3 * i + 2];
  const TetcastCamera camera = aimed_camera(2, &cube);
  static double one[SIDE * SIDE], all[SIDE * SIDE];
  Partition whole = partition_of(fixture.context, &cube, CUT_BOXES, 1);
  add_lengths(fixture.context, &whole, &camera, one);
  for (int count = 1; count <= 8; ++count) {
    Partition parts = partition_of(fixture.context, &cube, CUT_SCATTER, count);
    add_lengths(fixture.context, &parts, &camera, all);
    assert_true(largest_difference(one, all, SIDE * SIDE) < 1e-14);
    partition_end(&parts);
  }
  partition_end(&whole);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

static void bounds_are_checked(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube cube = cube_create(2, 0);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  static const struct {
    double bounds[6];
    const char *message;
  } wrong[] = {{{0, 1, 0, 0.5, 0, 1}, "bounds from 0 to 0.5 in y: the mesh reaches from 0 to 1"},
               {{0, 1, 0, 1, 2, 1}, "bounds from 2 to 1 in z: must ascend, within 1e300"},
               {{0, (double)INFINITY, 0, 1, 0, 1}, "bounds from 0 to inf in x: must ascend, within 1e300"}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    TetcastVolumeDesc desc = tetcast_volume_desc_default();
    desc.bounds = wrong[i].bounds;
    TetcastVolume *volume = NULL;
    assert_int_equal(tetcast_volume_create(fixture.context, mesh, &desc, &volume), TETCAST_ERROR_ARGUMENT);
    assert_string_equal(fixture.message, wrong[i].message);
  }
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* ── fragments ── */

enum { WIDTH = 53, HEIGHT = 41, PIXELS = WIDTH * HEIGHT };

static TetcastFrame *frame_of(TetcastContext *context, uint32_t channels) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  desc.channels = channels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

/* The fragments of all parts, for fragments_end(). */
static int fragments_of(TetcastContext *context, const Partition *partition, const TetcastTransferFunction *transfer,
                        const TetcastCamera *camera, TetcastFragments **made, TetcastFragmentList *lists) {
  const TetcastRenderDesc desc = render_desc();
  int count = 0;
  for (int i = 0; i < partition->count; ++i) {
    TetcastScene *scene = partition->part[i].scene;
    if (!scene)
      continue;
    TetcastRenderStats stats;
    assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
    assert_int_equal(tetcast_fragments_create(context, &made[count]), TETCAST_OK);
    assert_int_equal(tetcast_scene_render_fragments(scene, camera, &desc, WIDTH, HEIGHT, made[count], &stats),
                     TETCAST_OK);
    assert_int_equal(stats.lost, 0);
    assert_int_equal(stats.rays, PIXELS);
    lists[count] = tetcast_fragments_list(made[count]);
    ++count;
  }
  return count;
}

static void fragments_end(TetcastFragments **made, int count) {
  for (int i = 0; i < count; ++i)
    tetcast_fragments_destroy(&made[i]);
}

/* Pixel by pixel, those of a pixel one behind the other. Returns how many the pixel with most of them has. */
static int check_order(const TetcastFragmentList *list) {
  int most = 0, same = 0;
  for (int64_t i = 0; i < list->count; ++i) {
    const TetcastFragment *f = &list->data[i];
    assert_true(f->pixel >= 0 && f->pixel < PIXELS && f->begin <= f->end && f->optical_depth > 0);
    same = i && f[-1].pixel == f->pixel ? same + 1 : 1;
    if (same > 1)
      assert_true(f[-1].end <= f->begin);
    else
      assert_true(!i || f[-1].pixel < f->pixel);
    most = same > most ? same : most;
  }
  return most;
}

/* Composites parts of the cube, in two orders, and compares them with the whole. */
static void check_parts(TetcastContext *context, const Cube *cube, const Partition *whole, Cut cut, int count,
                        const TetcastTransferFunction *transfer, const TetcastCamera *camera) {
  Partition parts = partition_of(context, cube, cut, count);
  TetcastFragments *made[MOST_PARTS];
  TetcastFragmentList lists[MOST_PARTS], reversed[MOST_PARTS];
  const int lists_count = fragments_of(context, &parts, transfer, camera, made, lists);
  int most = 0;
  for (int i = 0; i < lists_count; ++i) {
    const int own = check_order(&lists[i]);
    most = own > most ? own : most;
    reversed[lists_count - 1 - i] = lists[i];
  }
  if (cut == CUT_SCATTER && count > 1)
    assert_true(most > 2);
  TetcastFrame *one = frame_of(context, TETCAST_CHANNEL_ERROR), *all = frame_of(context, 0),
               *again = frame_of(context, 0);
  const TetcastRenderDesc desc = render_desc();
  double overlap = -1;
  assert_int_equal(tetcast_scene_set_transfer_function(whole->part[0].scene, transfer), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(whole->part[0].scene, camera, &desc, one, NULL), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(context, lists, lists_count, all, &overlap), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(context, reversed, lists_count, again, NULL), TETCAST_OK);
  assert_memory_equal(tetcast_frame_pixels(all), tetcast_frame_pixels(again), PIXELS * 4 * sizeof(double));
  assert_true(overlap == 0);
  const double *a = tetcast_frame_pixels(one), *b = tetcast_frame_pixels(all),
               *error = tetcast_frame_channel(one, TETCAST_CHANNEL_ERROR);
  double off = 0;
  for (int i = 0; i < 4 * PIXELS; ++i) {
    off = fmax(off, fabs(a[i] - b[i]));
    if (!(fabs(a[i] - b[i]) <= 2 * error[i / 4]))
      fail_msg("cut %d, %d parts: %.17g, %.17g in one, bound %g", (int)cut, count, b[i], a[i], error[i / 4]);
  }
  if (getenv("TETCAST_TEST_PRINT"))
    printf("cut %d, %d parts: off by %.3g, overlap %.3g, up to %d fragments of a ray in a part\n", (int)cut, count, off,
           overlap, most);
  assert_true(off < 8e-15);
  tetcast_frame_destroy(&one);
  tetcast_frame_destroy(&all);
  tetcast_frame_destroy(&again);
  fragments_end(made, lists_count);
  partition_end(&parts);
}

static void fragments_of_parts_are_the_whole(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(7, 0.5);
  Partition whole = partition_of(fixture.context, &cube, CUT_BOXES, 1);
  for (int i = 0; i < repetitions(3 * CUTS * 2); ++i) {
    const TetcastCamera camera = i % 3 == 0   ? camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5)
                                 : i % 3 == 1 ? camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)
                                              : parallel(0.5, 0.5, 3, 1.25);
    TetcastTransferFunction *transfer =
        i / 9 ? transfer_of(fixture.context, 0.3) : gray_of(fixture.context, i % 2 ? 0.5 : 40);
    for (int count = 1; count <= MOST_PARTS; count += i % 2 ? 3 : 7)
      check_parts(fixture.context, &cube, &whole, (Cut)(i / 3 % 3), count, transfer, &camera);
    tetcast_transfer_function_destroy(&transfer);
  }
  partition_end(&whole);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* A part that is there twice overlaps itself by the longest of its fragments. */
static void cells_in_two_parts_are_exposed(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(5, 0.5);
  Partition parts = partition_of(fixture.context, &cube, CUT_WAVES, 4);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastTransferFunction *transfer = gray_of(fixture.context, 1);
  TetcastFragments *made[MOST_PARTS];
  TetcastFragmentList lists[MOST_PARTS];
  const int count = fragments_of(fixture.context, &parts, transfer, &camera, made, lists);
  TetcastFrame *frame = frame_of(fixture.context, 0);
  for (int i = 0; i < count; ++i) {
    double overlap = 0, longest = 0;
    lists[count] = lists[i];
    for (int64_t j = 0; j < lists[i].count; ++j)
      longest = fmax(longest, lists[i].data[j].end - lists[i].data[j].begin);
    assert_int_equal(tetcast_fragments_composite(fixture.context, lists, count + 1, frame, &overlap), TETCAST_OK);
    assert_true(overlap >= longest && longest > 0.1);
  }
  tetcast_transfer_function_destroy(&transfer);
  tetcast_frame_destroy(&frame);
  fragments_end(made, count);
  partition_end(&parts);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* A scene in larger units, clipped, seen through fields of each kind, of rows of a picture: composited alone it is the
 * scene's picture, and its fragments are as long as the rays are in the cube. */
static void one_part_is_its_picture(void **state) {
  (void)state;
  const TetcastHalfSpace plane = {{1, 0.3, 0.2}, 350};
  for (int kind = 0; kind < 3; ++kind) {
    World world;
    world_begin(&world, 4, 0.5, 1000, TETCAST_TRAVERSAL_SHELL);
    const int64_t count = count_of(&world.cube, (TetcastAssociation)kind);
    double *values = malloc((size_t)count * sizeof *values);
    uint64_t seed = 3;
    for (int64_t i = 0; i < count; ++i)
      values[i] = uniform(&seed);
    set_values(&world, values, (TetcastAssociation)kind);
    free(values);
    TetcastTransferFunction *transfer = transfer_of(world.fixture.context, 1e-3);
    assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_clip(world.scene, &plane, 1), TETCAST_OK);
    const TetcastCamera camera = camera_of(2100, 1700, 3300, 500, 500, 500);
    TetcastFragments *fragments = NULL;
    TetcastFrame *one = frame_of(world.fixture.context, 0), *all = frame_of(world.fixture.context, 0);
    TetcastRenderDesc desc = render_desc();
    desc.picture_height = 2 * HEIGHT;
    desc.first_row = HEIGHT / 2 + 3;
    assert_int_equal(tetcast_fragments_create(world.fixture.context, &fragments), TETCAST_OK);
    for (int twice = 0; twice < 2; ++twice) {
      assert_int_equal(tetcast_scene_render_fragments(world.scene, &camera, &desc, WIDTH, HEIGHT, fragments, NULL),
                       TETCAST_OK);
    }
    const TetcastFragmentList list = tetcast_fragments_list(fragments);
    assert_true(list.count > PIXELS / 4);
    for (int64_t i = 0; i < list.count; ++i)
      assert_true(list.data[i].begin > -900 && list.data[i].end < 900);
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, one, NULL), TETCAST_OK);
    assert_int_equal(tetcast_fragments_composite(world.fixture.context, &list, 1, all, NULL), TETCAST_OK);
    assert_true(largest_difference(tetcast_frame_pixels(one), tetcast_frame_pixels(all), 4 * PIXELS) < 3e-15);
    tetcast_fragments_destroy(&fragments);
    tetcast_frame_destroy(&one);
    tetcast_frame_destroy(&all);
    tetcast_transfer_function_destroy(&transfer);
    world_end(&world);
  }
}

static void wrong_fragments_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastFrame *frame = frame_of(fixture.context, 0);
  static const TetcastFragment good = {.pixel = 3, .begin = 1, .end = 2, .optical_depth = 1};
  TetcastFragment data[2] = {good, good};
  const TetcastFragmentList lists[2] = {{.count = 0}, {.data = data, .count = 2}};
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(fixture.context, NULL, 0, frame, NULL), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(fixture.context, NULL, 1, frame, NULL), TETCAST_ERROR_ARGUMENT);
  data[1].pixel = 2;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_ERROR_DATA);
  assert_string_equal(fixture.message, "fragment 1 of list 1: pixel 2, from 1 to 2, of optical depth 1");
  data[1] = good;
  data[1].pixel = PIXELS;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_ERROR_DATA);
  data[1] = good;
  data[1].end = (double)NAN;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_ERROR_DATA);
  tetcast_frame_destroy(&frame);
  fixture_end(&fixture);
}

/* Renders whatever the scene is to fragments, which is refused. */
static void check_refused(const World *world, const TetcastRenderDesc *desc, const char *what) {
  TetcastFragments *fragments = NULL;
  const TetcastCamera camera = camera_of(2, 2, 3, 0.5, 0.5, 0.5);
  assert_int_equal(tetcast_fragments_create(world->fixture.context, &fragments), TETCAST_OK);
  assert_int_equal(tetcast_scene_render_fragments(world->scene, &camera, desc, 8, 8, fragments, NULL),
                   TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world->fixture.message, what));
  tetcast_fragments_destroy(&fragments);
}

static void what_has_no_fragments_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  check_refused(&world, NULL, "the scene has no field yet");
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.samples = 4;
  check_refused(&world, &desc, "not possible with several samples");
  desc = tetcast_render_desc_default();
  desc.integrator = TETCAST_INTEGRATOR_MIDPOINT;
  check_refused(&world, &desc, "not possible with another integrator");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
  check_refused(&world, NULL, "not possible with another blend mode");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_COMPOSITE), TETCAST_OK);
  const TetcastIsosurface surface = {.value = 0.5, .opacity = 1};
  assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, &surface, 1), TETCAST_OK);
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  check_refused(&world, NULL, "not possible with smooth normals");
  shading.occlusion_rays = 1;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  check_refused(&world, NULL, "not possible with shadows");
  shading.shade = TETCAST_SHADE_VOLUME;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  check_refused(&world, NULL, "not possible with light in the volume");
  const TetcastBoundary boundary = {.opacity = 0.5};
  assert_int_equal(tetcast_scene_set_boundary(world.scene, &boundary), TETCAST_OK);
  check_refused(&world, NULL, "not possible with the boundary");
  world_end(&world);
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_FACES);
  set_values(&world, world.cube.values, TETCAST_POINT);
  check_refused(&world, NULL, "not possible with the traversal of faces");
  world_end(&world);
}

/* Wherever memory ends, the call says so, and nothing is lost. */
static void memory_may_end_anywhere(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunction *transfer = gray_of(world.fixture.context, 1);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
  const TetcastCamera camera = camera_of(2, 2, 3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = frame_of(world.fixture.context, 0);
  run_out_of_memory(&world, &camera, WIDTH, HEIGHT, frame);
  tetcast_frame_destroy(&frame);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crossings_of_parts_are_those_of_the_whole),
      cmocka_unit_test(numbers_of_vertices_do_not_matter),
      cmocka_unit_test(bounds_are_checked),
      cmocka_unit_test(fragments_of_parts_are_the_whole),
      cmocka_unit_test(cells_in_two_parts_are_exposed),
      cmocka_unit_test(one_part_is_its_picture),
      cmocka_unit_test(wrong_fragments_are_refused),
      cmocka_unit_test(what_has_no_fragments_is_refused),
      cmocka_unit_test(memory_may_end_anywhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
