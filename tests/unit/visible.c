/* SPDX-License-Identifier: Apache-2.0 */
/* Empty space is left out and nothing else: pictures where few clusters can be seen against those by the other
 * traversal, which leaves nothing out. */
#include "support.h"

#include "render/render.h"

enum { N = 16, SIZE = 40 };

/* A peak of extinction at `at`. */
static TetcastTransferFunction *peak_of(TetcastContext *context, double at, double width, double height) {
  const double color[2][4] = {{0, 1, 0.5, 0.2}, {1, 0.2, 0.4, 1}};
  const double extinction[3][2] = {{at - width, 0}, {at, height}, {at + width, 0}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = 2;
  desc.extinction = extinction[0];
  desc.extinction_count = 3;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

typedef struct Pair {
  TetcastVolume *volume[2]; /* shell, faces */
  TetcastScene *scene[2];
} Pair;

static void set_fields(Pair *pair, const TetcastField *field) {
  for (int i = 0; i < 2; ++i)
    assert_int_equal(tetcast_scene_set_field(pair->scene[i], field), TETCAST_OK);
}

/* Both pictures from outside and from within, each camera by another kernel, and by the next one at the next call;
 * returns the share of segments that were walked. */
static double compare(TetcastContext *context, Pair *pair, const TetcastTransferFunction *transfer, bool left_out) {
  const TetcastCamera cameras[] = {camera_of(2.2, 1.7, 2.9, 0.5, 0.5, 0.5), camera_of(0.5, 0.45, 0.52, 0.1, 0.9, 0.7),
                                   camera_of(0.5, 0.5, 4, 0.5, 0.5, 0.5)};
  double *rgba[2];
  int64_t segments[2] = {0, 0};
  static int round;
  ++round;
  TetcastFrame *frames[2] = {NULL, NULL};
  for (int i = 0; i < 2; ++i) {
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = desc.height = SIZE;
    assert_int_equal(tetcast_frame_create(context, &desc, &frames[i]), TETCAST_OK);
    rgba[i] = (double *)tetcast_frame_pixels(frames[i]);
    if (transfer)
      assert_int_equal(tetcast_scene_set_transfer_function(pair->scene[i], transfer), TETCAST_OK);
  }
  for (size_t c = 0; c < sizeof cameras / sizeof *cameras; ++c) {
    for (int isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
      if ((isa + (int)c + round) % 3 != 0) /* each in its turn */
        continue;
      for (int i = 0; i < 2; ++i) {
        TetcastRenderDesc desc = tetcast_render_desc_default();
        desc.isa = (TetcastIsa)isa;
        TetcastRenderStats stats;
        assert_int_equal(tetcast_scene_render(pair->scene[i], &cameras[c], &desc, frames[i], &stats), TETCAST_OK);
        assert_int_equal(stats.lost, 0);
        segments[i] += stats.segments;
      }
      assert_true(largest_difference(rgba[0], rgba[1], 4 * SIZE * SIZE) < 1e-13);
    }
  }
  assert_int_equal(pair->scene[0]->prepared->shell.visible != NULL, left_out);
  for (int i = 0; i < 2; ++i)
    tetcast_frame_destroy(&frames[i]);
  return (double)segments[0] / (double)segments[1];
}

static Pair pair_of(TetcastContext *context, const Cube *cube) {
  Pair pair;
  TetcastMesh *mesh = cube_mesh(context, cube);
  for (int i = 0; i < 2; ++i) {
    pair.volume[i] = volume_of(context, mesh, i ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    assert_int_equal(tetcast_scene_create(context, pair.volume[i], &pair.scene[i]), TETCAST_OK);
  }
  tetcast_mesh_destroy(&mesh);
  return pair;
}

static void pair_end(Pair *pair) {
  for (int i = 0; i < 2; ++i) {
    tetcast_scene_destroy(&pair->scene[i]);
    tetcast_volume_destroy(&pair->volume[i]);
  }
}

static void nothing_visible_is_left_out(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(N, 0.4);
  Pair pair = pair_of(fixture.context, &cube);
  TetcastField *field = field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT);
  set_fields(&pair, field);
  static const double at[] = {0.02, 0.05, 0.5, 0.98, 0.9, 2};
  static const bool left_out[] = {true, true, false,
                                  true, true, true}; /* in the middle of the range too much is visible */
  for (size_t i = 0; i < sizeof at / sizeof *at; ++i) {
    TetcastTransferFunction *transfer = peak_of(fixture.context, at[i], i == 2 ? 0.3 : 0.02, i % 2 ? 1e4 : 20);
    const double share = compare(fixture.context, &pair, transfer, left_out[i]);
    assert_true(left_out[i] ? share < 0.5 : share > 0.9);
    if (at[i] > 1.5)
      assert_true(share == 0);
    tetcast_transfer_function_destroy(&transfer);
  }
  tetcast_field_destroy(&field);
  pair_end(&pair);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* The same transfer function sees something else in another field, also one of cells and one with NaN. */
static void a_new_field_is_seen(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(N, 0.4);
  Pair pair = pair_of(fixture.context, &cube);
  TetcastTransferFunction *transfer = peak_of(fixture.context, 0.05, 0.03, 30);
  double *values = malloc((size_t)cube.cell_count * sizeof *values);
  for (int round = 0; round < 5; ++round) {
    const TetcastAssociation association = round == 3 ? TETCAST_CELL : TETCAST_POINT;
    const int64_t count = association == TETCAST_CELL ? cube.cell_count : cube.vertex_count;
    for (int64_t i = 0; i < count; ++i) {
      if (association == TETCAST_CELL)
        values[i] = i < 2 * 6 * N * N ? 0.05 : 1; /* the two lowest layers */
      else
        values[i] = round == 1 ? 1 - cube.values[i] : cube.values[i];
      if (round == 2 && i % 50 == 0)
        values[i] = NAN;
      if (round == 4)
        values[i] = 0.05; /* all is visible */
    }
    TetcastField *field = field_of(fixture.context, values, count, association);
    set_fields(&pair, field);
    tetcast_field_destroy(&field);
    const double share = compare(fixture.context, &pair, round == 0 ? transfer : NULL, round != 4);
    assert_true(share > 0 && (round == 4 ? share > 0.9 : share < 0.6));
  }
  free(values);
  tetcast_transfer_function_destroy(&transfer);
  pair_end(&pair);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* The number of cells that have, for each half-space, a vertex in it. */
static int64_t count_left(const Cube *cube, const TetcastHalfSpace *clip, int count) {
  int64_t left = 0;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    bool kept = true;
    for (int j = 0; j < count; ++j) {
      bool inside = false;
      for (int k = 0; k < 4; ++k) {
        const double *x = cube->vertices + 3 * cube->cells[4 * i + k], *n = clip[j].normal;
        inside = inside || n[0] * x[0] + n[1] * x[1] + n[2] * x[2] >= clip[j].offset - 1e-9;
      }
      kept = kept && inside;
    }
    left += kept;
  }
  return left;
}

/* Cells beyond a clip are left out, and no others: slanted planes, some along faces, more of them than are looked at in
 * one go; also together with a transfer function that leaves little visible, with a blend mode, and once the clip is
 * gone. */
static void what_a_clip_cuts_off_is_left_out(void **state) {
  (void)state;
  static const TetcastHalfSpace slanted[] = {{{-0.3, 0.5, -0.8}, -0.35}},
                                faces[] = {{{0, 0, 1}, 0.5}, {{-1, 0, 0}, -0.75}, {{1, 0, 0}, 0.125}},
                                edge[] = {{{0, 0, 1}, 1}}, beyond[] = {{{0, 1, 0}, 1.5}}, little[] = {{{1, 1, 1}, 0.2}};
  TetcastHalfSpace ball[13];
  for (int i = 0; i < 13; ++i) {
    const double a = 2.4 * i, z = -1 + 2 * (i + 0.5) / 13, r = sqrt(1 - z * z);
    ball[i] = (TetcastHalfSpace){{r * cos(a), r * sin(a), z}, 0};
    for (int k = 0; k < 3; ++k)
      ball[i].offset += 0.5 * ball[i].normal[k];
    ball[i].offset -= 0.3;
  }
  static const bool cuts[] = {true, true, true, true, true, false};
  const TetcastHalfSpace *clip[] = {slanted, faces, edge, beyond, ball, little};
  static const int count[] = {1, 3, 1, 1, 13, 1};
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  for (int regular = 0; regular < 2; ++regular) {
    Cube cube = cube_create(N, regular ? 0 : 0.4);
    Pair pair = pair_of(fixture.context, &cube);
    TetcastField *field = field_of(fixture.context, cube.values, cube.vertex_count, TETCAST_POINT);
    set_fields(&pair, field);
    TetcastTransferFunction *all = peak_of(fixture.context, 0.5, 2, 3), *few = peak_of(fixture.context, 0.05, 0.03, 30);
    for (size_t i = 0; i < sizeof count / sizeof *count; ++i) {
      if (test_short() && i % 4 != (size_t)regular)
        continue;
      for (int j = 0; j < 2; ++j)
        assert_int_equal(tetcast_scene_set_clip(pair.scene[j], clip[i], count[i]), TETCAST_OK);
      /* Rays have only points in common with what is left at the edge: of these rounding decides. */
      const int last = clip[i] == edge ? TETCAST_BLEND_COMPOSITE : TETCAST_BLEND_AVERAGE;
      for (int blend = TETCAST_BLEND_COMPOSITE; blend <= last; ++blend) {
        for (int j = 0; j < 2; ++j)
          assert_int_equal(tetcast_scene_set_blend(pair.scene[j], (TetcastBlend)blend), TETCAST_OK);
        compare(fixture.context, &pair, all, cuts[i]);
        if (cuts[i]) {
          const int64_t left = count_left(&cube, clip[i], count[i]);
          assert_int_equal(pair.scene[0]->prepared->shell.visible_cells, left);
        }
      }
      for (int j = 0; j < 2; ++j)
        assert_int_equal(tetcast_scene_set_blend(pair.scene[j], TETCAST_BLEND_COMPOSITE), TETCAST_OK);
      compare(fixture.context, &pair, few, true);
      for (int j = 0; j < 2; ++j)
        assert_int_equal(tetcast_scene_set_clip(pair.scene[j], NULL, 0), TETCAST_OK);
      compare(fixture.context, &pair, NULL, true);
      compare(fixture.context, &pair, all, false);
    }
    tetcast_transfer_function_destroy(&all);
    tetcast_transfer_function_destroy(&few);
    tetcast_field_destroy(&field);
    pair_end(&pair);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* Every cell's vertices follow from the seeds of its cluster, on meshes of all shapes. */
static void seeds_know_their_clusters(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 3, 0), TETCAST_OK);
  uint64_t seed = 4;
  for (int round = 0; round < 20; ++round) {
    Cube cube = cube_create(1 + round % 6, 0.5);
    for (int64_t i = 0; i < cube.cell_count / 3 * (round % 3); ++i) { /* holes: cells twice are left out */
      memcpy(cube.cells + 4 * (int64_t)(uniform(&seed) * (double)cube.cell_count), cube.cells, 4 * sizeof *cube.cells);
    }
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    TcAdjacency adjacency;
    TcClusters clusters;
    assert_int_equal(tc_adjacency_build(mesh, NULL, true, NULL, &adjacency), TETCAST_OK);
    const uint32_t(*vertices)[4] = (const uint32_t(*)[4])adjacency.vertices;
    assert_int_equal(tc_clusters_build(fixture.context, &adjacency, vertices, &clusters), TETCAST_OK);
    int64_t cells = 0;
    for (int64_t c = 0; c < clusters.count; ++c) {
      uint32_t found[TC_CLUSTER][4];
      const int count = tc_cluster_cells(&clusters, &adjacency, c, found);
      assert_memory_equal(found, vertices[c << TC_CLUSTER_BITS], (size_t)count * sizeof *found);
      cells += count;
    }
    assert_int_equal(cells, adjacency.cell_count);
    tc_clusters_clear(&clusters);
    tc_adjacency_clear(&adjacency);
    tetcast_mesh_destroy(&mesh);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nothing_visible_is_left_out), cmocka_unit_test(a_new_field_is_seen),
      cmocka_unit_test(what_a_clip_cuts_off_is_left_out), cmocka_unit_test(seeds_know_their_clusters)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
