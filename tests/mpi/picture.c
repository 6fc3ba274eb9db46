/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of pieces on several ranks are those of the whole mesh, and have the same bits whoever has which piece. */
#include "pieces.h"

enum { WIDTH = 150, HEIGHT = 61, PIXELS = WIDTH * HEIGHT };

static const double most_off = 5e-15;
static const int64_t middle = 800000; /* bytes, which are enough for a few bands */

static TetcastCamera parallel(double x, double y, double z, double height) {
  return (TetcastCamera){.eye = {x, y, z},
                         .target = {0.5, 0.5, 0.5},
                         .up = {0, 1, 0.1},
                         .projection = TETCAST_ORTHOGRAPHIC,
                         .height = height};
}

static bool ascend(void *user, double fraction) {
  double *last = user;
  assert_true(fraction >= *last && fraction <= 1);
  *last = fraction;
  return true;
}

/* Renders pieces; at rank 0 the pixels, to be freed. */
static double *render(Ranks *ranks, const Pieces *pieces, const TetcastCamera *camera, int64_t width, int64_t height,
                      TetcastMpiStats *stats) {
  TetcastRenderDesc desc = render_desc();
  double last = 0;
  desc.progress = (TetcastProgress){ascend, &last};
  TetcastFrame *frame = frame_at_root(ranks, width, height, TETCAST_TYPE_FLOAT64);
  double *pixels = NULL;
  assert_int_equal(tetcast_mpi_render(ranks->mpi, scenes_of(pieces), pieces->count, ranks->rank ? NULL : camera, &desc,
                                      frame, stats),
                   TETCAST_OK);
  assert_true(last > 0.99);
  assert_int_equal(stats->lost, 0);
  assert_true(stats->overlap < 1e-14);
  if (frame) {
    pixels = malloc((size_t)(width * height) * 4 * sizeof *pixels);
    memcpy(pixels, tetcast_frame_pixels(frame), (size_t)(width * height) * 4 * sizeof *pixels);
  }
  tetcast_frame_destroy(&frame);
  return pixels;
}

/* The whole mesh by one scene. */
static double *whole_of(TetcastContext *context, const Cube *cube, const TetcastTransferFunction *transfer,
                        const TetcastCamera *camera, int64_t width, int64_t height, TetcastRenderStats *stats) {
  Pieces whole = pieces_of(context, cube, SPLIT_BOXES, 1, DEAL_IN_TURN, 0, 1);
  double *pixels = malloc((size_t)(width * height) * 4 * sizeof *pixels);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  const TetcastRenderDesc how = render_desc();
  pieces_set_transfer(&whole, transfer);
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(whole.scenes[0], camera, &how, frame, stats), TETCAST_OK);
  tetcast_frame_destroy(&frame);
  pieces_end(&whole);
  return pixels;
}

/* Compares a picture of pieces with that of the whole. */
static void check_picture(Ranks *ranks, const Cube *cube, Split split, int count,
                          const TetcastTransferFunction *transfer, const TetcastCamera *camera, int64_t width,
                          int64_t height) {
  TetcastContext *context = ranks->fixture.context;
  Pieces pieces =
      pieces_of(context, cube, split, count, (Deal)((count + (int)split) % DEALS), ranks->rank, ranks->size);
  TetcastMpiStats stats;
  pieces_set_transfer(&pieces, transfer);
  double *all = render(ranks, &pieces, camera, width, height, &stats);
  pieces_end(&pieces);
  if (ranks->rank > 0)
    return;
  TetcastRenderStats of_whole;
  double *one = whole_of(context, cube, transfer, camera, width, height, &of_whole);
  const double off = largest_difference(one, all, (size_t)(width * height) * 4);
  if (!(off <= most_off))
    fail_msg("%d ranks, split %d, %d pieces: off by %g", ranks->size, split, count, off);
  assert_string_equal(stats.isa, of_whole.isa);
  free(one);
  free(all);
}

static void pieces_are_the_whole(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  for (int mesh = 0; mesh < 3; ++mesh) {
    Cube cube = mesh == 2 ? hollow_create(7) : cube_create(mesh ? 7 : 5, mesh ? 0.5 : 0);
    for (int i = 0; i < repetitions(4); ++i) {
      const TetcastCamera camera = i % 3 == 0   ? camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5)
                                   : i % 3 == 1 ? camera_of(0.43, 0.52, 0.61, 1, 0.2, 0)
                                                : parallel(0.5, 0.5, 3, 1.25);
      TetcastTransferFunction *transfer =
          i > 1 ? transfer_of(ranks.fixture.context, 0.3) : gray_of(ranks.fixture.context, i % 2 ? 0.5 : 40);
      for (int split = 0; split < SPLITS; ++split) {
        check_picture(&ranks, &cube, (Split)split, 1 + i * 4 + mesh, transfer, &camera, WIDTH, HEIGHT);
        check_picture(&ranks, &cube, (Split)split, 3 + 9 * mesh, transfer, &camera, 65 - 64 * (i % 2), 3 + i);
      }
      tetcast_transfer_function_destroy(&transfer);
    }
    cube_destroy(&cube);
  }
  ranks_end(&ranks);
}

enum { SIDE = 17 };

/* As in tests of parts in one process: along axes and diagonals of the grid, then to vertices. */
static TetcastCamera aimed_camera(int i, const Cube *cube) {
  if (i < 3) {
    TetcastCamera camera = parallel(0.5, 0.5, 0.5, SIDE / 8.0);
    camera.eye[i] = 3;
    camera.up[0] = i == 1, camera.up[1] = i != 1, camera.up[2] = 0;
    return camera;
  }
  if (i < 6)
    return parallel(i == 3 ? 0.5 : 3, 3, 3 - 5 * (i == 5), 2);
  const double *eye = cube->vertices + 3 * (i * 7 % cube->vertex_count),
               *target = cube->vertices + 3 * (i * 31 % cube->vertex_count);
  return camera_of(eye[0], eye[1], eye[2] + (i % 3 ? 2 : 0), target[0], target[1], target[2]);
}

/* Rays through what pieces share: a crossing that is lost, or found twice, changes the ray's length. */
static void nothing_is_lost_between_ranks(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  TetcastTransferFunction *transfer = gray_of(context, 1);
  for (int jittered = 0; jittered < 2; ++jittered) {
    Cube cube = cube_create(4, jittered ? 0.5 : 0);
    for (int split = 0; split < SPLITS; ++split) {
      Pieces pieces = pieces_of(context, &cube, (Split)split, split == 1 ? 5 : 8, DEAL_IN_TURN, ranks.rank, ranks.size);
      pieces_set_transfer(&pieces, transfer);
      for (int i = 0; i < repetitions(30); ++i) {
        const TetcastCamera camera = aimed_camera(i, &cube);
        TetcastMpiStats stats;
        TetcastRenderStats of_whole;
        double *all = render(&ranks, &pieces, &camera, SIDE, SIDE, &stats);
        if (ranks.rank > 0)
          continue;
        double *one = whole_of(context, &cube, transfer, &camera, SIDE, SIDE, &of_whole);
        for (int p = 0; p < SIDE * SIDE; ++p) {
          const double off = log1p(-one[4 * p + 3]) - log1p(-all[4 * p + 3]);
          if (!(fabs(off) < 1e-14))
            fail_msg("split %d, camera %d, pixel %d: length is off by %g", split, i, p, off);
        }
        free(one);
        free(all);
      }
      pieces_end(&pieces);
    }
    cube_destroy(&cube);
  }
  tetcast_transfer_function_destroy(&transfer);
  ranks_end(&ranks);
}

/* ── bits ── */

/* Renders the same pieces on the first `count` ranks and compares with `expected`, of rank 0. */
static void check_bits(int count, const Cube *cube, Deal deal, int64_t memory, int threads, double *expected) {
  Ranks ranks;
  ranks_begin(&ranks, count);
  if (ranks.mpi) {
    TetcastContext *context = ranks.fixture.context;
    Pieces pieces = pieces_of(context, cube, SPLIT_WAVY, 7, deal, ranks.rank, ranks.size);
    TetcastTransferFunction *transfer = transfer_of(context, 0.3);
    const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    pieces_set_transfer(&pieces, transfer);
    assert_int_equal(tetcast_context_set_threads(context, threads), TETCAST_OK);
    assert_int_equal(tetcast_mpi_set_memory(ranks.mpi, memory), TETCAST_OK);
    for (int again = 0; again < 2; ++again) { /* the second picture begins with what the first one has taught */
      TetcastMpiStats stats;
      double *pixels = render(&ranks, &pieces, &camera, WIDTH, HEIGHT, &stats);
      const int most = (HEIGHT + 15) / 16;
      assert_true(stats.bands >= 1 && stats.bands <= most);
      assert_true(memory > 1 || stats.bands == most);
      assert_true(memory < 1 << 28 || stats.bands == 1);
      assert_true(memory != middle || stats.memory <= memory);
      assert_true((stats.bytes > 0) == (count > 1) && stats.most_bytes <= 2 * stats.bytes);
      if (pixels && isnan(expected[0]))
        memcpy(expected, pixels, PIXELS * 4 * sizeof *pixels);
      else if (pixels)
        assert_memory_equal(expected, pixels, PIXELS * 4 * sizeof *pixels);
      free(pixels);
    }
    tetcast_transfer_function_destroy(&transfer);
    pieces_end(&pieces);
  }
  ranks_end(&ranks);
}

static void bits_are_the_same(void **state) {
  (void)state;
  static double expected[4 * PIXELS];
  Cube cube = hollow_create(7);
  expected[0] = (double)NAN;
  for (int count = 1; count <= world_size(); ++count) {
    for (int deal = 0; deal < DEALS; ++deal) {
      check_bits(count, &cube, (Deal)deal, INT64_C(1) << 28, 2, expected);
      check_bits(count, &cube, (Deal)deal, middle, 1, expected);
    }
    check_bits(count, &cube, DEAL_IN_TURN, 1, 3, expected);
  }
  cube_destroy(&cube);
}

/* Rays with many fragments: what is stated holds, in the first picture and where one has far more than the last. */
static void memory_is_kept_to(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  Cube cube = cube_create(9, 0.4);
  Pieces pieces = pieces_of(context, &cube, SPLIT_SCATTER, 20, DEAL_IN_TURN, ranks.rank, ranks.size);
  TetcastTransferFunction *transfer = gray_of(context, 0.1), *nothing = gray_of(context, 0);
  const TetcastCamera camera = parallel(0.6, 0.7, 3, 0.4);
  double *pictures[4];
  TetcastMpiStats stats[4];
  assert_int_equal(tetcast_mpi_set_memory(ranks.mpi, INT64_C(1) << 40), TETCAST_OK);
  for (int i = 0; i < 4; ++i) { /* 1: the first picture, 2: of nothing, 3: of everything again */
    const int64_t memory = stats[0].memory / 2;
    if (i == 1) {
      tetcast_mpi_destroy(&ranks.mpi);
      assert_int_equal(tetcast_mpi_create(context, MPI_Comm_c2f(MPI_COMM_WORLD), &ranks.mpi), TETCAST_OK);
      assert_int_equal(tetcast_mpi_set_memory(ranks.mpi, ranks.rank == ranks.size - 1 ? memory : 2 * memory),
                       TETCAST_OK);
    }
    pieces_set_transfer(&pieces, i == 2 ? nothing : transfer);
    pictures[i] = render(&ranks, &pieces, &camera, WIDTH, HEIGHT, &stats[i]);
    assert_true(i == 0 || (stats[i].memory <= memory && (i == 2 || stats[i].memory > memory / 8)));
    if (ranks.rank == 0 && i % 2)
      assert_memory_equal(pictures[0], pictures[i], PIXELS * 4 * sizeof(double));
    assert_true(i == 2 || (stats[0].fragments == stats[i].fragments && stats[0].segments == stats[i].segments));
  }
  assert_true(stats[0].bands == 1 && stats[1].bands > 2 && stats[2].fragments == 0 && stats[3].bands > 2);
  assert_true(stats[0].redone == 0 && stats[1].redone == 0 && stats[2].redone == 0 && stats[3].redone > 0);
  for (int i = 0; i < 4; ++i)
    free(pictures[i]);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_transfer_function_destroy(&nothing);
  pieces_end(&pieces);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

/* The pieces, all of them, composited here, by one lane. */
static TetcastFrame *composited(Ranks *ranks, const Pieces *all, const TetcastCamera *camera,
                                const TetcastRenderDesc *desc, TetcastType type) {
  TetcastContext *context = ranks->fixture.context;
  TetcastFragments *made[6];
  TetcastFragmentList lists[6];
  TetcastFrame *frame = frame_at_root(ranks, WIDTH, HEIGHT, type);
  TetcastRenderDesc how = *desc;
  how.isa = TETCAST_ISA_SCALAR;
  for (int i = 0; i < all->count; ++i) {
    assert_int_equal(tetcast_fragments_create(context, &made[i]), TETCAST_OK);
    assert_int_equal(tetcast_scene_render_fragments(scenes_of(all)[i], camera, &how, WIDTH, HEIGHT, made[i], NULL),
                     TETCAST_OK);
    lists[i] = tetcast_fragments_list(made[i]);
  }
  assert_int_equal(tetcast_fragments_composite(context, lists, all->count, frame, NULL), TETCAST_OK);
  for (int i = 0; i < all->count; ++i)
    tetcast_fragments_destroy(&made[i]);
  return frame;
}

/* Rows of a larger picture, in a frame of either type whose rows lie apart, by ranks of which the last may use one lane
 * only. */
static void check_frame(Ranks *ranks, const Pieces *pieces, const Pieces *all, TetcastType type, int64_t memory) {
  static double pixels[HEIGHT][WIDTH + 3][4];
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  const size_t size = 4 * (type == TETCAST_TYPE_FLOAT32 ? sizeof(float) : sizeof(double));
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  desc.type = type;
  desc.pixels = pixels;
  desc.row_stride = (WIDTH + 3) * (int64_t)size;
  TetcastRenderDesc how = render_desc();
  how.picture_height = 2 * HEIGHT;
  how.first_row = 30;
  if (ranks->rank == ranks->size - 1)
    how.isa = TETCAST_ISA_SCALAR;
  TetcastFrame *frame = NULL;
  TetcastMpiStats stats;
  memset(pixels, 0, sizeof pixels);
  assert_int_equal(tetcast_frame_create(ranks->fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_mpi_set_memory(ranks->mpi, memory), TETCAST_OK);
  assert_int_equal(tetcast_mpi_render(ranks->mpi, scenes_of(pieces), pieces->count, &camera, &how,
                                      ranks->rank ? NULL : frame, &stats),
                   TETCAST_OK);
  assert_string_equal(stats.isa, "scalar");
  if (ranks->rank == 0) {
    TetcastFrame *other = composited(ranks, all, &camera, &how, type);
    const char *rows = (const char *)pixels, *expected = tetcast_frame_pixels(other);
    static const char nothing[3 * 4 * sizeof(double)];
    for (int y = 0; y < HEIGHT; ++y, rows += desc.row_stride, expected += WIDTH * size) {
      assert_memory_equal(rows, expected, WIDTH * size);
      assert_memory_equal(rows + WIDTH * size, nothing, 3 * size);
    }
    tetcast_frame_destroy(&other);
  }
  tetcast_frame_destroy(&frame);
}

static void frames_are_of_any_kind(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  Cube cube = cube_create(6, 0.5);
  Pieces pieces = pieces_of(context, &cube, SPLIT_BOXES, 6, DEAL_IN_TURN, ranks.rank, ranks.size),
         all = pieces_of(context, &cube, SPLIT_BOXES, 6, DEAL_IN_TURN, 0, 1);
  TetcastTransferFunction *transfer = transfer_of(context, 0.3);
  pieces_set_transfer(&pieces, transfer);
  pieces_set_transfer(&all, transfer);
  for (int i = 0; i < 4; ++i)
    check_frame(&ranks, &pieces, &all, i % 2 ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64, i / 2 ? 100000 : 1 << 28);
  tetcast_transfer_function_destroy(&transfer);
  pieces_end(&pieces);
  pieces_end(&all);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

/* ── what there is nothing of, and what there is twice ── */

static void nothing_is_black(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = frame_at_root(&ranks, WIDTH, HEIGHT, TETCAST_TYPE_FLOAT64);
  TetcastMpiStats stats;
  if (frame)
    memset((void *)(uintptr_t)tetcast_frame_pixels(frame), 1, PIXELS * 4 * sizeof(double));
  assert_int_equal(tetcast_mpi_render(ranks.mpi, NULL, 0, &camera, NULL, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.fragments, 0);
  for (int i = 0; frame && i < 4 * PIXELS; ++i)
    assert_true(((const double *)tetcast_frame_pixels(frame))[i] == 0);
  tetcast_frame_destroy(&frame);
  ranks_end(&ranks);
}

/* A mesh of the cells of one piece, and those of others that share a vertex with it, as ghosts. */
static TetcastMesh *mesh_with_ghosts(TetcastContext *context, const Cube *cube, const int *owner, int which,
                                     bool hide) {
  bool *touched = calloc((size_t)cube->vertex_count, sizeof *touched);
  int64_t *cells = malloc((size_t)cube->cell_count * 4 * sizeof *cells), count = 0;
  uint8_t *hidden = malloc((size_t)cube->cell_count);
  for (int64_t i = 0; i < 4 * cube->cell_count; ++i)
    touched[cube->cells[i]] = touched[cube->cells[i]] || owner[i / 4] == which;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    const int64_t *cell = cube->cells + 4 * i;
    if (touched[cell[0]] || touched[cell[1]] || touched[cell[2]] || touched[cell[3]]) {
      memcpy(cells + 4 * count, cell, 4 * sizeof *cells);
      hidden[count++] = owner[i] == which ? 0 : 1;
    }
  }
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.type = TETCAST_CELL_TETRAHEDRON;
  desc.connectivity = (TetcastArray){cells, TETCAST_TYPE_INT64, count, 0};
  desc.hidden = hidden;
  desc.hidden_bits = hide ? 1 : 0;
  TetcastCut *cut = NULL;
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_cells_cut(context, &desc, &cut), TETCAST_OK);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = desc.vertices;
  mesh_desc.tetrahedra = tetcast_cut_tetrahedra(cut);
  assert_int_equal(tetcast_mesh_create(context, &mesh_desc, &mesh), TETCAST_OK);
  tetcast_cut_destroy(&cut);
  free(touched);
  free(cells);
  free(hidden);
  return mesh;
}

/* Ghosts that are hidden do nothing; those that are not show up as an overlap. */
static void ghosts_do_nothing(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  Cube cube = cube_create(6, 0.5);
  int *owner = split_cells(&cube, SPLIT_WAVY, 4);
  TetcastTransferFunction *transfer = gray_of(context, 1);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  for (int hide = 0; hide < 2; ++hide) {
    Pieces pieces = {.count = 0};
    for (int i = ranks.rank; i < 4; i += ranks.size) {
      TetcastMesh *mesh = mesh_with_ghosts(context, &cube, owner, i, hide);
      TetcastVolumeDesc desc = tetcast_volume_desc_default();
      Part *part = &pieces.part[pieces.count];
      desc.bounds = unit_bounds;
      assert_int_equal(tetcast_volume_create(context, mesh, &desc, &part->volume), TETCAST_OK);
      assert_int_equal(tetcast_scene_create(context, part->volume, &part->scene), TETCAST_OK);
      TetcastField *field = field_of(context, cube.values, cube.vertex_count, TETCAST_POINT);
      assert_int_equal(tetcast_scene_set_field(part->scene, field), TETCAST_OK);
      tetcast_field_destroy(&field);
      tetcast_mesh_destroy(&mesh);
      pieces.scenes[pieces.count++] = part->scene;
    }
    TetcastFrame *frame = frame_at_root(&ranks, WIDTH, HEIGHT, TETCAST_TYPE_FLOAT64);
    TetcastMpiStats stats;
    pieces_set_transfer(&pieces, transfer);
    assert_int_equal(tetcast_mpi_render(ranks.mpi, scenes_of(&pieces), pieces.count, &camera, NULL, frame, &stats),
                     TETCAST_OK);
    if (hide)
      assert_true(stats.overlap < 1e-14);
    else
      assert_true(stats.overlap > 0.1);
    if (frame && hide) {
      TetcastRenderStats of_whole;
      double *one = whole_of(context, &cube, transfer, &camera, WIDTH, HEIGHT, &of_whole);
      assert_true(largest_difference(one, tetcast_frame_pixels(frame), 4 * PIXELS) <= most_off);
      assert_int_equal(stats.segments, of_whole.segments);
      free(one);
    }
    tetcast_frame_destroy(&frame);
    pieces_end(&pieces);
  }
  free(owner);
  tetcast_transfer_function_destroy(&transfer);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces_are_the_whole),   cmocka_unit_test(nothing_is_lost_between_ranks),
      cmocka_unit_test(bits_are_the_same),      cmocka_unit_test(memory_is_kept_to),
      cmocka_unit_test(frames_are_of_any_kind), cmocka_unit_test(nothing_is_black),
      cmocka_unit_test(ghosts_do_nothing),
  };
  RUN_WITH_MPI(tests);
}
