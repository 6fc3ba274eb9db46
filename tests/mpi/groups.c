/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces with coefficients on several ranks: pixels and channels of all groups are those of the whole mesh, and have
 * the same bits whoever has which piece. */
#include "../unit/group_parts.h"
#include "pieces.h"

enum { WIDTH = 150, HEIGHT = 61, PIXELS = WIDTH * HEIGHT };

/* One group, and more than fill the lanes of a vector; one extinction for all; none. */
static const Groups kinds[] = {{1, 1, 0, 3}, {3, 3, 2, 0.5}, {19, 19, 0, 4}, {1, 10, 1, 6}, {0, 2, 0, 2}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static Part part_with_groups(TetcastContext *context, const Cube *cube, const int *owner, int which, const void *of,
                             uint64_t *seed) {
  return group_part(context, cube, owner, which, of, seed);
}

static Pieces group_pieces(TetcastContext *context, const Cube *cube, Split split, int count, const Groups *groups,
                           Deal deal, int rank, int ranks) {
  return pieces_made(context, cube, split, count, deal, rank, ranks, part_with_groups, groups);
}

static TetcastFrame *frame_of(TetcastContext *context, TetcastType type, uint32_t channels, int groups) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  desc.type = type;
  desc.channels = channels;
  desc.groups = groups;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

/* A frame at rank 0, NULL elsewhere, of what the pieces are. */
static TetcastFrame *render(Ranks *ranks, const Pieces *pieces, const TetcastCamera *camera, TetcastType type,
                            uint32_t channels, int groups, TetcastMpiStats *stats) {
  const TetcastRenderDesc desc = render_desc();
  TetcastFrame *frame = ranks->rank ? NULL : frame_of(ranks->fixture.context, type, channels, groups);
  assert_int_equal(tetcast_mpi_render(ranks->mpi, scenes_of(pieces), pieces->count, ranks->rank ? NULL : camera, &desc,
                                      frame, stats),
                   TETCAST_OK);
  assert_int_equal(stats->lost, 0);
  assert_true(stats->overlap < 1e-14);
  return frame;
}

static void pieces_are_the_whole(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  for (int i = 0; i < KINDS; ++i) {
    Cube cube = i % 2 ? hollow_create(6) : cube_create(5, 0.5);
    Pieces whole = group_pieces(context, &cube, SPLIT_BOXES, 1, &kinds[i], DEAL_IN_TURN, 0, 1);
    const TetcastCamera camera =
        i % 3 ? camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5) : camera_of(0.43, 0.52, 0.61, 1, 0.2, 0);
    const TetcastRenderDesc desc = render_desc();
    const int groups = group_count(&kinds[i]);
    TetcastFrame *one = frame_of(context, TETCAST_TYPE_FLOAT64, group_channels | TETCAST_CHANNEL_ERROR, groups);
    if (ranks.rank == 0)
      assert_int_equal(tetcast_scene_render(whole.scenes[0], &camera, &desc, one, NULL), TETCAST_OK);
    for (int split = 0; split < SPLITS; ++split) {
      Pieces pieces = group_pieces(context, &cube, (Split)split, 3 + 4 * i, &kinds[i], (Deal)((i + split) % DEALS),
                                   ranks.rank, ranks.size);
      TetcastMpiStats stats;
      TetcastFrame *all = render(&ranks, &pieces, &camera, TETCAST_TYPE_FLOAT64, group_channels, groups, &stats);
      if (all)
        check_groups(one, all, kinds[i].size);
      tetcast_frame_destroy(&all);
      pieces_end(&pieces);
    }
    tetcast_frame_destroy(&one);
    pieces_end(&whole);
    cube_destroy(&cube);
  }
  ranks_end(&ranks);
}

/* ── bits ── */

enum { GROUPS = 11, PLANES = 5 };
static const Groups many = {GROUPS, GROUPS, 0, 3};
static const int64_t middle = 2500000; /* bytes, which are enough for a few bands */

/* The pixels, or one of the channels; NULL: the frame doesn't have it. *size: the bytes. */
static const void *plane_of(const TetcastFrame *frame, int plane, size_t *size) {
  const size_t number = tetcast_frame_type(frame) == TETCAST_TYPE_FLOAT32 ? sizeof(float) : sizeof(double);
  *size = PIXELS * number * (size_t)(plane == 0 ? 4 : plane == 4 ? 1 : GROUPS);
  return plane ? tetcast_frame_channel(frame, (TetcastChannel)(TETCAST_CHANNEL_RADIANCE << (plane - 1)))
               : tetcast_frame_pixels(frame);
}

/* Keeps a picture that has all channels, or compares one with that which is kept. */
static void keep_or_compare(const TetcastFrame *frame, void *kept[PLANES]) {
  for (int i = 0; i < PLANES; ++i) {
    size_t size;
    const void *plane = plane_of(frame, i, &size);
    if (plane && kept[i])
      assert_memory_equal(plane, kept[i], size);
    if (kept[i])
      continue;
    kept[i] = malloc(size);
    memcpy(kept[i], plane, size);
  }
}

/* Renders the same pieces on the first `count` ranks, all bits of which are as they are kept. */
static void check_bits(int count, const Cube *cube, Deal deal, int64_t memory, TetcastType type, uint32_t channels,
                       void *kept[PLANES]) {
  Ranks ranks;
  ranks_begin(&ranks, count);
  if (ranks.mpi) {
    Pieces pieces = group_pieces(ranks.fixture.context, cube, SPLIT_WAVY, 7, &many, deal, ranks.rank, ranks.size);
    const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    assert_int_equal(tetcast_mpi_set_memory(ranks.mpi, memory), TETCAST_OK);
    for (int again = 0; again < 2; ++again) {
      TetcastMpiStats stats;
      TetcastFrame *frame = render(&ranks, &pieces, &camera, type, channels, GROUPS, &stats);
      const int most = (HEIGHT + 15) / 16;
      assert_true(memory == 1 ? stats.bands == most : stats.memory <= memory);
      assert_true(memory == middle && count == 1 ? stats.bands > 1 : memory < 1 << 28 || stats.bands == 1);
      assert_true((stats.bytes > 0) == (count > 1) && stats.most_bytes <= 2 * stats.bytes);
      if (count == 1 && stats.bands == 1 && type == TETCAST_TYPE_FLOAT64) { /* all, twice those of the largest piece… */
        const int64_t numbers = 3 * 64 * HEIGHT * (4 + 3 * GROUPS + 1) + PIXELS; /* … and what pixels have */
        assert_true(stats.memory >= stats.fragments * 9 / 7 * (56 + 16 * GROUPS) + numbers * 8);
      }
      if (frame)
        keep_or_compare(frame, kept);
      tetcast_frame_destroy(&frame);
    }
    pieces_end(&pieces);
  }
  ranks_end(&ranks);
}

static void bits_are_the_same(void **state) {
  (void)state;
  void *kept[2][PLANES] = {{NULL}};
  Cube cube = hollow_create(6);
  for (int count = 1; count <= world_size(); ++count) {
    for (int deal = 0; deal < DEALS; ++deal) {
      const TetcastType type = deal % 2 ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64;
      check_bits(count, &cube, (Deal)deal, INT64_C(1) << 28, type, group_channels, kept[deal % 2]);
      check_bits(count, &cube, (Deal)deal, middle, type, group_channels, kept[deal % 2]);
    }
    check_bits(count, &cube, DEAL_IN_TURN, 1, TETCAST_TYPE_FLOAT32, TETCAST_CHANNEL_OPTICAL_DEPTH, kept[1]);
    check_bits(count, &cube, DEAL_LAST, 1, TETCAST_TYPE_FLOAT64, 0, kept[0]);
  }
  for (int i = 0; i < 2 * PLANES; ++i)
    free(kept[i / PLANES][i % PLANES]);
  cube_destroy(&cube);
}

/* Rows of a larger picture are its rows, next to each other or not. */
static void rows_of_a_picture(void **state) {
  (void)state;
  enum { FIRST = 16, ROWS = 20, STRIDE = 7 * 4 };
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  Cube cube = cube_create(5, 0.5);
  Pieces pieces = group_pieces(context, &cube, SPLIT_BOXES, 6, &many, DEAL_IN_TURN, ranks.rank, ranks.size);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastMpiStats stats;
  TetcastFrame *all = render(&ranks, &pieces, &camera, TETCAST_TYPE_FLOAT64, group_channels, GROUPS, &stats),
               *rows = NULL;
  TetcastRenderDesc desc = render_desc();
  desc.picture_height = HEIGHT;
  desc.first_row = FIRST;
  static double pixels[ROWS][4 * WIDTH + STRIDE];
  TetcastFrameDesc frame = tetcast_frame_desc_default();
  frame.width = WIDTH;
  frame.height = ROWS;
  frame.channels = group_channels;
  frame.groups = GROUPS;
  frame.pixels = pixels;
  frame.row_stride = sizeof pixels[0];
  assert_int_equal(tetcast_frame_create(context, &frame, &rows), TETCAST_OK);
  assert_int_equal(
      tetcast_mpi_render(ranks.mpi, scenes_of(&pieces), pieces.count, &camera, &desc, ranks.rank ? NULL : rows, NULL),
      TETCAST_OK);
  for (int i = 1; all && i < PLANES; ++i) {
    size_t size;
    const char *whole = plane_of(all, i, &size);
    assert_memory_equal(plane_of(rows, i, &size), whole + size / HEIGHT * FIRST, size / HEIGHT * ROWS);
  }
  for (int y = 0; all && y < ROWS; ++y)
    assert_memory_equal(pixels[y], (const double *)tetcast_frame_pixels(all) + (size_t)(4 * WIDTH * (y + FIRST)),
                        4 * WIDTH * sizeof(double));
  tetcast_frame_destroy(&all);
  tetcast_frame_destroy(&rows);
  pieces_end(&pieces);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

/* Where there is nothing, everything passes. */
static void nothing_is_transparent(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  const Pieces none = {.count = 0};
  TetcastMpiStats stats;
  TetcastFrame *frame = render(&ranks, &none, &camera, TETCAST_TYPE_FLOAT64, group_channels, GROUPS, &stats);
  for (int i = 0; frame && i < PLANES; ++i) {
    size_t size;
    const double *plane = plane_of(frame, i, &size);
    for (size_t k = 0; k < size / sizeof *plane; ++k)
      assert_true(plane[k] == (i == 3));
  }
  tetcast_frame_destroy(&frame);
  ranks_end(&ranks);
}

/* ── what is refused ── */

/* All ranks say the same, or that it is rank 0 that does. */
static void refuse(Ranks *ranks, const Pieces *pieces, uint32_t channels, int groups, bool of_root, const char *text) {
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = frame_of(ranks->fixture.context, TETCAST_TYPE_FLOAT64, channels, groups);
  assert_int_equal(tetcast_mpi_render(ranks->mpi, scenes_of(pieces), pieces->count, &camera, NULL, frame, NULL),
                   TETCAST_ERROR_ARGUMENT);
  assert_string_equal(ranks->fixture.message, of_root && ranks->rank ? "rank 0 failed: invalid argument" : text);
  tetcast_frame_destroy(&frame);
}

/* Scenes that don't go together, or not with the frame; between them, pictures of one kind and the other. */
static void scenes_must_have_the_same_groups(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  Cube cube = cube_create(5, 0.5);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  Pieces plain = pieces_of(context, &cube, SPLIT_WAVY, 6, DEAL_IN_TURN, ranks.rank, ranks.size),
         pieces = group_pieces(context, &cube, SPLIT_WAVY, 6, &many, DEAL_IN_TURN, ranks.rank, ranks.size),
         others = group_pieces(context, &cube, SPLIT_WAVY, 6, &kinds[1], DEAL_IN_TURN, ranks.rank, ranks.size);
  TetcastTransferFunction *transfer = transfer_of(context, 0.3);
  pieces_set_transfer(&plain, transfer);
  void *kept[PLANES] = {NULL};
  for (int odd = 0; odd < ranks.size; ++odd) {
    Pieces mixed = pieces;
    TetcastMpiStats stats;
    if (ranks.rank == odd)
      mixed.scenes[0] = others.scenes[0];
    refuse(&ranks, &mixed, group_channels, GROUPS, false,
           "scenes of 3 groups and of 11: all must have the same coefficients");
    if (ranks.rank == odd)
      mixed.scenes[0] = plain.scenes[0];
    refuse(&ranks, &mixed, 0, 1, false, "scenes of 0 groups and of 11: all must have the same coefficients");
    refuse(&ranks, &pieces, TETCAST_CHANNEL_RADIANCE, 3, false, "a frame of 3 groups, but the scenes have 11");
    refuse(&ranks, &plain, TETCAST_CHANNEL_PATH_LENGTH, 3, false,
           "with a transfer function there is no channel path_length");
    refuse(&ranks, &pieces, TETCAST_CHANNEL_ERROR, 3, true,
           "the channel error is not possible with parts on several ranks");
    TetcastFrame *frame = render(&ranks, &pieces, &camera, TETCAST_TYPE_FLOAT64, group_channels, GROUPS, &stats);
    if (frame)
      keep_or_compare(frame, kept);
    tetcast_frame_destroy(&frame);
    frame = render(&ranks, &plain, &camera, TETCAST_TYPE_FLOAT64, 0, 1, &stats);
    tetcast_frame_destroy(&frame);
    frame = render(&ranks, &others, &camera, TETCAST_TYPE_FLOAT64, TETCAST_CHANNEL_PATH_LENGTH, 1, &stats);
    tetcast_frame_destroy(&frame);
  }
  for (int i = 0; i < PLANES; ++i)
    free(kept[i]);
  tetcast_transfer_function_destroy(&transfer);
  pieces_end(&plain);
  pieces_end(&pieces);
  pieces_end(&others);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces_are_the_whole),
      cmocka_unit_test(bits_are_the_same),
      cmocka_unit_test(rows_of_a_picture),
      cmocka_unit_test(nothing_is_transparent),
      cmocka_unit_test(scenes_must_have_the_same_groups),
  };
  RUN_WITH_MPI(tests);
}
