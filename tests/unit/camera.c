/* SPDX-License-Identifier: Apache-2.0 */
/* Cameras that look past the picture's middle: a wall of pictures is the whole picture, with vertices projected or not,
 * and rays are those of the formula. */
#include "lines.h"
#include "world.h"

enum { TILE = 24, WHOLE = 2 * TILE };

static TetcastFrame *frame_of(TetcastContext *context, int width, int height) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

static void render(const World *world, const TetcastCamera *camera, TetcastFrame *frame) {
  TetcastRenderDesc desc = render_desc();
  TetcastRenderStats stats;
  static const double color[3] = {1, 0.5, 0.2};
  assert_int_equal(tetcast_scene_render(world->scene, camera, &desc, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  assert_int_equal(tetcast_scene_draw_outline(world->scene, camera, &desc, color, frame), TETCAST_OK);
}

/* The same picture by way of fragments, of which those of tiles that don't see the volume are left out. */
static void check_fragments(const World *world, const TetcastCamera *camera, TetcastFrame *tile) {
  TetcastContext *context = world->fixture.context;
  const TetcastRenderDesc desc = render_desc();
  TetcastFragments *fragments = NULL;
  TetcastFrame *frame = frame_of(context, TILE, TILE);
  assert_int_equal(tetcast_scene_render(world->scene, camera, &desc, tile, NULL), TETCAST_OK);
  assert_int_equal(tetcast_fragments_create(context, &fragments), TETCAST_OK);
  assert_int_equal(tetcast_scene_render_fragments(world->scene, camera, &desc, TILE, TILE, fragments, NULL),
                   TETCAST_OK);
  const TetcastFragmentList list = tetcast_fragments_list(fragments);
  assert_int_equal(tetcast_fragments_composite(context, &list, 1, frame, NULL), TETCAST_OK);
  assert_true(largest_difference(tetcast_frame_pixels(frame), tetcast_frame_pixels(tile), 4 * TILE * TILE) < 1e-14);
  tetcast_fragments_destroy(&fragments);
  tetcast_frame_destroy(&frame);
}

/* The camera of tile (i, j) of a wall of 2 × 2, j = 0 on top. */
static TetcastCamera tile_camera(TetcastCamera camera, int i, int j) {
  camera.height /= 2;
  camera.fovy = 2 * atan(tan(camera.fovy * acos(-1) / 360) / 2) * 180 / acos(-1);
  camera.center[0] = 2 * camera.center[0] + (i ? 1 : -1);
  camera.center[1] = 2 * camera.center[1] + (j ? -1 : 1);
  return camera;
}

/* Renders a wall and the whole, and returns by how much they differ. */
static double wall_error(const World *world, const TetcastCamera *camera) {
  TetcastContext *context = world->fixture.context;
  TetcastFrame *whole = frame_of(context, WHOLE, WHOLE), *tile = frame_of(context, TILE, TILE);
  render(world, camera, whole);
  double off = 0, seen = 0;
  for (int t = 0; t < 4; ++t) {
    const TetcastCamera part = tile_camera(*camera, t % 2, t / 2);
    render(world, &part, tile);
    for (int y = 0; y < TILE; ++y) {
      const double *a = (const double *)tetcast_frame_pixels(whole) + 4 * ((t / 2 * TILE + y) * WHOLE + t % 2 * TILE),
                   *b = (const double *)tetcast_frame_pixels(tile) + 4 * y * TILE;
      off = fmax(off, largest_difference(a, b, 4 * TILE));
      for (int x = 0; x < TILE; ++x)
        seen += b[4 * x + 3];
    }
    check_fragments(world, &part, tile);
  }
  assert_true(seen > 20);
  tetcast_frame_destroy(&whole);
  tetcast_frame_destroy(&tile);
  return off;
}

/* Few cells are seen by so many rays that their vertices are projected; of many cells, and from inside the mesh, they
 * are not. */
static void a_wall_is_the_whole(void **state) {
  (void)state;
  for (int large = 0; large < 2; ++large) {
    World world;
    world_begin(&world, large ? 24 : 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
    set_values(&world, world.cube.values, TETCAST_POINT);
    TetcastTransferFunction *transfer = transfer_of(world.fixture.context, 0.4);
    assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
    for (int i = 0; i < 6; ++i) {
      TetcastCamera camera = i % 3 == 0   ? camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5)
                             : i % 3 == 1 ? parallel(2, 1.5, 3, 1.75)
                                          : camera_of(0.43, 0.52, 0.61, 1, 0.2, 0);
      camera.center[0] = i / 3 * 0.25;
      camera.center[1] = i / 3 * -0.125;
      const double off = wall_error(&world, &camera);
      if (getenv("TETCAST_TEST_PRINT"))
        printf("%s, camera %d: off by %.3g\n", large ? "many cells" : "few cells", i, off);
      assert_true(camera.projection == TETCAST_ORTHOGRAPHIC ? off < 1e-14 : off < 1e-11);
    }
    tetcast_transfer_function_destroy(&transfer);
    world_end(&world);
  }
}

/* The picture of any centre is what the rays of the formula gather. */
static void rays_are_those_of_the_formula(void **state) {
  (void)state;
  enum { W = 31, H = 23 };
  World world;
  world_begin(&world, 4, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunction *transfer = transfer_of(world.fixture.context, 0.4);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
  TetcastFrame *frame = frame_of(world.fixture.context, W, H);
  for (int i = 0; i < 4; ++i) {
    TetcastCamera camera = i % 2 ? parallel(2, 1.5, 3, 1.5) : camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    camera.center[0] = i < 2 ? 0.37 : -0.2;
    camera.center[1] = i < 2 ? -0.61 : 0.45;
    const Lines lines = lines_of_picture(&camera, W, H);
    const TetcastRays rays = rays_of(&lines);
    static double cast[4 * W * H];
    const TetcastCastResult result = {.color = cast};
    const TetcastRenderDesc desc = render_desc();
    assert_int_equal(tetcast_scene_cast(world.scene, &rays, NULL, &result, NULL), TETCAST_OK);
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, frame, NULL), TETCAST_OK);
    double seen = 0;
    for (int j = 0; j < W * H; ++j)
      seen += cast[4 * j + 3];
    assert_true(seen > 20);
    assert_true(largest_difference(cast, tetcast_frame_pixels(frame), 4 * W * H) < 1e-13);
    Lines gone = lines;
    lines_destroy(&gone);
  }
  tetcast_frame_destroy(&frame);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

/* A window that is far aside sees nothing; one that can't be is refused. */
static void extreme_centers(void **state) {
  (void)state;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunction *transfer = gray_of(world.fixture.context, 1);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
  TetcastFrame *frame = frame_of(world.fixture.context, 8, 8);
  for (int i = 0; i < 12; ++i) {
    TetcastCamera camera = i % 2 ? parallel(2, 1.5, 3, 1.5) : camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    camera.center[i / 2 % 2] = (i % 4 < 2 ? 1 : -1) * (i < 4 ? 1e3 : i < 8 ? 1e15 : 1e100);
    render(&world, &camera, frame);
    for (int j = 0; j < 8 * 8 * 4; ++j)
      assert_true(((const double *)tetcast_frame_pixels(frame))[j] == 0);
  }
  TetcastCamera camera = parallel(2, 1.5, 3, 1.5);
  camera.center[0] = 1e200;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(world.fixture.message, "camera: a center of 1e+200, 0 is too far from the mesh");
  camera.center[1] = (double)NAN;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, NULL, frame, NULL), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(world.fixture.message, "camera: a center of 1e+200, nan: must be finite");
  tetcast_frame_destroy(&frame);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_wall_is_the_whole),
      cmocka_unit_test(rays_are_those_of_the_formula),
      cmocka_unit_test(extreme_centers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
