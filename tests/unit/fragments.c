/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh, of any shape, seen one by one: no crossing is lost or found twice where they meet. */
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crossings_of_parts_are_those_of_the_whole),
      cmocka_unit_test(numbers_of_vertices_do_not_matter),
      cmocka_unit_test(bounds_are_checked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
