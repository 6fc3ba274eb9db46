/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces and transfer functions of two dimensions in parts of a mesh: composited, they are the whole's picture, also
 * where surfaces lie in faces that two parts share. */
#include "partition.h"
#include "world.h"

enum { WIDTH = 33, HEIGHT = 33, PIXELS = WIDTH * HEIGHT };

typedef struct Looks {
  int isosurfaces, slices, rows, light, transfer, middle;
} Looks;

/* What may be seen, each in colours of its own; opaque and transparent. */
static const TetcastIsosurface isosurfaces[3] = {
    {0.31, {1, 0.2, 0.1}, 0.3}, {0.5, {0.1, 0.9, 0.3}, 0.45}, {0.66, {0.2, 0.3, 1}, 1}};
static const TetcastIsosurface middle = {0.69, {1, 1, 1}, 0.45};
static const TetcastSlice slices[2] = {{{1, 0, 0}, 0.5, 0.4}, {{0.3, -1, 0.2}, -0.3, 0.7}};

static void set_looks(TetcastContext *context, TetcastScene *scene, const Looks *looks) {
  TetcastTransferFunction *transfer = transfer_of(context, looks->transfer ? 0.2 : 0), *more = gray_of(context, 2);
  const TetcastTransferRow rows[3] = {{0, transfer}, {1.5, more}, {4, transfer}};
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.normals = TETCAST_NORMALS_FLAT;
  shading.shade = looks->light ? TETCAST_SHADE_SURFACES : TETCAST_SHADE_NONE;
  assert_int_equal(tetcast_scene_set_shading(scene, &shading), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
  if (looks->rows)
    assert_int_equal(tetcast_scene_set_transfer_rows(scene, rows, 3, NULL), TETCAST_OK);
  assert_int_equal(looks->middle ? tetcast_scene_set_isosurfaces(scene, &middle, 1)
                                 : tetcast_scene_set_isosurfaces(scene, isosurfaces, looks->isosurfaces),
                   TETCAST_OK);
  assert_int_equal(tetcast_scene_set_slices(scene, slices, looks->slices), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_transfer_function_destroy(&more);
}

static TetcastFrame *frame_of(TetcastContext *context) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

/* The picture of a part as fragments, which are in order: where one ends, the next one begins at the earliest. */
static TetcastFragments *fragments_of(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera) {
  TetcastFragments *fragments = NULL;
  const TetcastRenderDesc desc = render_desc();
  TetcastRenderStats stats;
  assert_int_equal(tetcast_fragments_create(context, &fragments), TETCAST_OK);
  assert_int_equal(tetcast_scene_render_fragments(scene, camera, &desc, WIDTH, HEIGHT, fragments, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  const TetcastFragmentList list = tetcast_fragments_list(fragments);
  for (int64_t i = 0; i < list.count; ++i) {
    const TetcastFragment *f = &list.data[i];
    assert_true(f->begin <= f->end && f->optical_depth > 0);
    if (i && f[-1].pixel == f->pixel)
      assert_true(f[-1].end <= f->begin && f[-1].optical_depth < INFINITY);
  }
  return fragments;
}

/* Two pictures: of the whole, and of parts that are composited. */
typedef struct Pictures {
  double whole[4 * PIXELS], parts[4 * PIXELS];
} Pictures;

static Pictures pictures; /* of the last compare() */

/* Composites the parts and compares them with the whole. Returns by how much they are off; the pixels' mean opacity is
 * added to *seen. */
static double compare(TetcastContext *context, const Partition *whole, const Partition *parts, const Looks *looks,
                      const TetcastCamera *camera, double *seen) {
  TetcastFragments *made[MOST_PARTS];
  TetcastFragmentList lists[MOST_PARTS];
  int count = 0;
  for (int i = 0; i < parts->count; ++i) {
    if (!parts->part[i].scene)
      continue;
    set_looks(context, parts->part[i].scene, looks);
    made[count] = fragments_of(context, parts->part[i].scene, camera);
    lists[count] = tetcast_fragments_list(made[count]);
    ++count;
  }
  TetcastFrame *frame = frame_of(context);
  const TetcastRenderDesc desc = render_desc();
  double overlap = -1;
  set_looks(context, whole->part[0].scene, looks);
  assert_int_equal(tetcast_scene_render(whole->part[0].scene, camera, &desc, frame, NULL), TETCAST_OK);
  memcpy(pictures.whole, tetcast_frame_pixels(frame), sizeof pictures.whole);
  assert_int_equal(tetcast_fragments_composite(context, lists, count, frame, &overlap), TETCAST_OK);
  memcpy(pictures.parts, tetcast_frame_pixels(frame), sizeof pictures.parts);
  assert_true(overlap == 0);
  for (int i = 0; i < PIXELS; ++i)
    *seen += pictures.parts[4 * i + 3] / PIXELS;
  tetcast_frame_destroy(&frame);
  for (int i = 0; i < count; ++i)
    tetcast_fragments_destroy(&made[i]);
  return largest_difference(pictures.whole, pictures.parts, 4 * PIXELS);
}

static const Looks all_looks[] = {
    {.isosurfaces = 2},
    {.isosurfaces = 3, .transfer = 1},
    {.isosurfaces = 2, .light = 1, .transfer = 1},
    {.slices = 2},
    {.slices = 2, .transfer = 1},
    {.isosurfaces = 3, .slices = 2, .light = 1, .transfer = 1},
    {.rows = 1, .transfer = 1},
    {.rows = 1, .isosurfaces = 2, .slices = 1, .light = 1, .transfer = 1},
};
enum { LOOKS = sizeof all_looks / sizeof *all_looks };

static void looks_of_parts_are_those_of_the_whole(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(7, 0.5);
  for (int kind = 0; kind < 3; ++kind) {
    const TetcastAssociation association = (TetcastAssociation)kind;
    Partition whole = partition_of_kind(fixture.context, &cube, CUT_BOXES, 1, association);
    for (int cut = 0; cut < CUTS; ++cut) {
      Partition parts = partition_of_kind(fixture.context, &cube, (Cut)cut, 7, association);
      for (int i = 0; i < LOOKS; ++i) {
        const Looks *looks = &all_looks[i];
        if ((looks->rows && association != TETCAST_POINT) || (looks->isosurfaces && association == TETCAST_CELL))
          continue;
        const TetcastCamera cameras[3] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5),
                                          camera_of(0.43, 0.52, 0.61, 1, 0.2, 0), parallel(0.5, 0.5, 3, 1.25)};
        for (int j = 0; j < 3; ++j) {
          double seen = 0;
          const double off = compare(fixture.context, &whole, &parts, looks, &cameras[j], &seen);
          assert_true(seen > 0.02);
          if (getenv("TETCAST_TEST_PRINT"))
            printf("field %d, cut %d, looks %d, camera %d: off by %.3g\n", kind, cut, i, j, off);
          if (!(off < 8e-15))
            fail_msg("field %d, cut %d, looks %d, camera %d: off by %g", kind, cut, i, j, off);
        }
      }
      partition_end(&parts);
    }
    partition_end(&whole);
  }
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* How many more times a pixel's ray crosses a surface of opacity 0.45 than in the other picture. */
static long more_crossings(int pixel) {
  const double whole = log1p(-pictures.whole[4 * pixel + 3]), parts = log1p(-pictures.parts[4 * pixel + 3]);
  const double more = (parts - whole) / log1p(-0.45);
  assert_true(fabs(more - nearbyint(more)) < 1e-9);
  return lround(more);
}

/* A lattice whose scalar is one coordinate: the isosurface 0.5 and a slice lie in the faces where the parts meet. Rays
 * are aimed at vertices, edges and faces of these. A slice is met once. So is the isosurface, but where a vertex is hit
 * that lies on it: the scalar beside it is above or below by rounding, and may change sides an odd number of times. */
static void surfaces_in_shared_faces_are_found_once(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  for (int axis = 0; axis < 3; ++axis) {
    Cube cube = cube_create(6, 0);
    for (int64_t i = 0; i < cube.vertex_count; ++i)
      cube.values[i] = 0.19 + cube.vertices[3 * i + axis]; /* 0.69 where parts meet */
    Partition whole = partition_of(fixture.context, &cube, CUT_BOXES, 1);
    double seen = 0;
    int often = 0;
    for (int cut = 0; cut < CUTS; ++cut) {
      Partition parts = partition_of(fixture.context, &cube, (Cut)cut, 8);
      for (int i = 0; i < 24; ++i) {
        const double *a = &cube.vertices[3 * (i * 41 % cube.vertex_count)];
        const TetcastCamera camera = i % 2 ? parallel(0.5 + 1.3 * (i % 3), 0.5 + 0.7 * (i % 5), 3, 1.5)
                                           : camera_of(a[0] + 1, a[1] - 2, a[2] + 3, a[0], a[1], a[2]);
        const Looks looks = {.middle = i / 2 % 2, .slices = i / 2 % 2 ? 0 : 1};
        const double off = compare(fixture.context, &whole, &parts, &looks, &camera, &seen);
        for (int pixel = 0; looks.middle && pixel < PIXELS; ++pixel) {
          const long more = more_crossings(pixel);
          if (more % 2)
            fail_msg("axis %d, cut %d, camera %d, pixel %d: crosses %ld times more", axis, cut, i, pixel, more);
          often += more != 0;
        }
        if (!looks.middle && !(off < 1e-14))
          fail_msg("axis %d, cut %d, camera %d: off by %g", axis, cut, i, off);
      }
      partition_end(&parts);
    }
    if (getenv("TETCAST_TEST_PRINT"))
      printf("axis %d: %d rays cross more often or less\n", axis, often);
    assert_true(seen > 3 && often < 50);
    partition_end(&whole);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(looks_of_parts_are_those_of_the_whole),
      cmocka_unit_test(surfaces_in_shared_faces_are_found_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
