/* SPDX-License-Identifier: Apache-2.0 */
/* Whatever fails on one rank fails on all, with a message that names it, and none waits for another; after that they go
 * on as if nothing had been. */
#include "pieces.h"

enum { WIDTH = 70, HEIGHT = 40 };

typedef struct World {
  Ranks ranks;
  Cube cube;
  Pieces pieces;
  TetcastCamera camera;
  TetcastFrame *frame;
  double *expected; /* at rank 0, what is to be seen */
} World;

static TetcastStatus render(World *world, const TetcastRenderDesc *desc) {
  return tetcast_mpi_render(world->ranks.mpi, scenes_of(&world->pieces), world->pieces.count, &world->camera, desc,
                            world->frame, NULL);
}

static void check_good(World *world) {
  assert_int_equal(render(world, NULL), TETCAST_OK);
  if (world->frame)
    assert_memory_equal(tetcast_frame_pixels(world->frame), world->expected, WIDTH * HEIGHT * 4 * sizeof(double));
}

static void world_begin(World *world) {
  memset(world, 0, sizeof *world);
  ranks_begin(&world->ranks, world_size());
  TetcastContext *context = world->ranks.fixture.context;
  world->cube = cube_create(5, 0.5);
  world->pieces = pieces_of(context, &world->cube, SPLIT_WAVY, 6, DEAL_IN_TURN, world->ranks.rank, world->ranks.size);
  TetcastTransferFunction *transfer = transfer_of(context, 0.3);
  pieces_set_transfer(&world->pieces, transfer);
  tetcast_transfer_function_destroy(&transfer);
  world->camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  world->frame = frame_at_root(&world->ranks, WIDTH, HEIGHT, TETCAST_TYPE_FLOAT64);
  world->expected = malloc(WIDTH * HEIGHT * 4 * sizeof *world->expected);
  assert_int_equal(render(world, NULL), TETCAST_OK);
  if (world->frame)
    memcpy(world->expected, tetcast_frame_pixels(world->frame), WIDTH * HEIGHT * 4 * sizeof *world->expected);
}

static void world_end(World *world) {
  free(world->expected);
  tetcast_frame_destroy(&world->frame);
  pieces_end(&world->pieces);
  cube_destroy(&world->cube);
  ranks_end(&world->ranks);
}

/* The last message: that of the rank that has failed, or one that names it. */
static void check_message(const World *world, int failed, const char *own, TetcastStatus status) {
  char others[200];
  snprintf(others, sizeof others, "rank %d failed: %s", failed, tetcast_status_string(status));
  const char *message = world->ranks.fixture.message;
  if (world->ranks.rank == failed ? !strstr(message, own) : strcmp(message, others) != 0)
    fail_msg("rank %d says: %s", world->ranks.rank, message);
}

static void agreement(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  assert_int_equal(tetcast_mpi_agree(ranks.mpi, TETCAST_OK), TETCAST_OK);
  assert_int_equal(ranks.fixture.messages, 0);
  for (int low = 0; low < ranks.size; ++low) {
    const bool fails = ranks.rank >= low; /* each with another status */
    const int before = ranks.fixture.messages;
    assert_int_equal(tetcast_mpi_agree(ranks.mpi, fails ? (TetcastStatus)(1 + ranks.rank) : TETCAST_OK), 1 + low);
    assert_int_equal(ranks.fixture.messages, before + !fails);
    char expected[200];
    snprintf(expected, sizeof expected, "rank %d failed: %s", low, tetcast_status_string((TetcastStatus)(1 + low)));
    if (!fails)
      assert_string_equal(ranks.fixture.message, expected);
  }
  ranks_end(&ranks);
}

/* All refuse a picture of which one scene shows something else than the others: another transfer function, an
 * isosurface, a slice, an isosurface in another light. */
static void one_looks_different(World *world, bool fails) {
  enum { TRANSFER, SURFACE, SLICE, LIGHT, LOOKS };
  Pieces *pieces = &world->pieces;
  TetcastScene *const scene = pieces->scenes[0];
  const TetcastIsosurface surface = {.value = 0.5, .color = {1, 1, 1}, .opacity = 0.5};
  const TetcastSlice slice = {.normal = {0, 0, 1}, .offset = 0.5, .opacity = 0.5};
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  TetcastTransferFunction *all = transfer_of(world->ranks.fixture.context, 0.3),
                          *other = transfer_of(world->ranks.fixture.context, 0.4);
  shading.normals = TETCAST_NORMALS_FLAT;
  for (int look = 0; look < LOOKS; ++look) {
    for (int64_t i = 0; i < pieces->count; ++i) {
      assert_int_equal(tetcast_scene_set_shading(pieces->scenes[i], &shading), TETCAST_OK);
      assert_int_equal(tetcast_scene_set_isosurfaces(pieces->scenes[i], &surface, look == LIGHT), TETCAST_OK);
    }
    assert_int_equal(render(world, NULL), TETCAST_OK);
    shading.ambient += 0.1;
    if (fails && look == TRANSFER)
      assert_int_equal(tetcast_scene_set_transfer_function(scene, other), TETCAST_OK);
    if (fails && look == SURFACE)
      assert_int_equal(tetcast_scene_set_isosurfaces(scene, &surface, 1), TETCAST_OK);
    if (fails && look == SLICE)
      assert_int_equal(tetcast_scene_set_slices(scene, &slice, 1), TETCAST_OK);
    if (fails && look == LIGHT)
      assert_int_equal(tetcast_scene_set_shading(scene, &shading), TETCAST_OK);
    assert_int_equal(render(world, NULL), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(world->ranks.fixture.message, "not all scenes show the same"));
    assert_int_equal(tetcast_scene_set_slices(scene, NULL, 0), TETCAST_OK);
    pieces_set_transfer(pieces, all);
  }
  for (int64_t i = 0; i < pieces->count; ++i)
    assert_int_equal(tetcast_scene_set_isosurfaces(pieces->scenes[i], NULL, 0), TETCAST_OK);
  tetcast_transfer_function_destroy(&all);
  tetcast_transfer_function_destroy(&other);
  check_good(world);
}

static void what_is_refused_on_one_rank(void **state) {
  (void)state;
  World world;
  world_begin(&world);
  TetcastContext *context = world.ranks.fixture.context;
  for (int failed = 0; failed < world.ranks.size; ++failed) {
    const bool fails = world.ranks.rank == failed;
    TetcastScene *const scene = world.pieces.scenes[0];
    const int count = world.pieces.count;
    if (fails) /* a scene that is NULL */
      world.pieces.scenes[0] = NULL;
    assert_int_equal(render(&world, NULL), TETCAST_ERROR_ARGUMENT);
    check_message(&world, failed, "scene 0 of rank", TETCAST_ERROR_ARGUMENT);
    world.pieces.scenes[0] = scene;
    if (fails)
      world.pieces.count = -1;
    assert_int_equal(render(&world, NULL), TETCAST_ERROR_ARGUMENT);
    check_message(&world, failed, "-1 scenes", TETCAST_ERROR_ARGUMENT);
    world.pieces.count = count;
    if (fails) /* one that has no fragments */
      assert_int_equal(tetcast_scene_set_blend(scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
    assert_int_equal(render(&world, NULL), TETCAST_ERROR_ARGUMENT);
    check_message(&world, failed, "another blend mode", TETCAST_ERROR_ARGUMENT);
    assert_int_equal(tetcast_scene_set_blend(scene, TETCAST_BLEND_COMPOSITE), TETCAST_OK);
    one_looks_different(&world, fails);
    TetcastRenderDesc desc = tetcast_render_desc_default();
    if (fails)
      desc.cookie = 5;
    assert_int_equal(render(&world, &desc), TETCAST_ERROR_ARGUMENT);
    check_message(&world, failed, "tetcast_render_desc_default()", TETCAST_ERROR_ARGUMENT);
    check_good(&world);
    double bounds[6] = {0, 1, 0, 1, 0, fails ? (double)NAN : 1}, sums[1], one = 1;
    assert_int_equal(tetcast_mpi_bounds(world.ranks.mpi, bounds), TETCAST_ERROR_ARGUMENT);
    assert_int_equal(tetcast_mpi_bounds(world.ranks.mpi, fails ? NULL : bounds), TETCAST_ERROR_ARGUMENT);
    assert_int_equal(tetcast_mpi_range(world.ranks.mpi, fails ? NULL : bounds), TETCAST_ERROR_ARGUMENT);
    assert_int_equal(tetcast_mpi_sum(world.ranks.mpi, fails ? NULL : &one, 1, 1, sums), TETCAST_ERROR_ARGUMENT);
    assert_int_equal(tetcast_mpi_broadcast(world.ranks.mpi, 0, fails ? NULL : &one, 8), TETCAST_ERROR_ARGUMENT);
    if (world.ranks.size > 1)
      assert_int_equal(tetcast_mpi_broadcast(world.ranks.mpi, fails, &one, 8), TETCAST_ERROR_ARGUMENT);
    TetcastMpi *mpi = world.ranks.mpi;
    assert_int_equal(tetcast_mpi_create(fails ? NULL : context, MPI_Comm_c2f(MPI_COMM_WORLD), &mpi),
                     TETCAST_ERROR_ARGUMENT);
    assert_null(mpi);
  }
  world_end(&world);
}

static void what_rank_0_wants_is_checked(void **state) {
  (void)state;
  World world;
  world_begin(&world);
  TetcastContext *context = world.ranks.fixture.context;
  TetcastMpi *mpi = world.ranks.mpi;
  const TetcastScene *const *scenes = scenes_of(&world.pieces);
  const int count = world.pieces.count;
  TetcastRenderDesc desc = tetcast_render_desc_default();
  assert_int_equal(tetcast_mpi_render(mpi, scenes, count, &world.camera, NULL, NULL, NULL), TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "frame is NULL", TETCAST_ERROR_ARGUMENT);
  assert_int_equal(
      tetcast_mpi_render(mpi, scenes, count, world.ranks.rank ? &world.camera : NULL, NULL, world.frame, NULL),
      TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "camera is NULL", TETCAST_ERROR_ARGUMENT);
  const TetcastArray stop = {&world, TETCAST_TYPE_FLOAT64, 3, 0};
  desc.stop = &stop;
  assert_int_equal(render(&world, &desc), TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "stop and start", TETCAST_ERROR_ARGUMENT);
  desc.stop = NULL;
  desc.picture_height = HEIGHT + 5;
  desc.first_row = 6;
  assert_int_equal(render(&world, &desc), TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "40 rows from row 6 of a picture that has 45", TETCAST_ERROR_ARGUMENT);
  desc = tetcast_render_desc_default();
  desc.samples = 4;
  assert_int_equal(render(&world, &desc), TETCAST_ERROR_ARGUMENT);
  world.camera.target[0] = (double)NAN;
  assert_int_equal(render(&world, NULL), TETCAST_ERROR_ARGUMENT);
  world.camera.target[0] = 0.5;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 3;
  frame_desc.channels = TETCAST_CHANNEL_CELLS;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_mpi_render(mpi, scenes, count, &world.camera, NULL, world.ranks.rank ? NULL : frame, NULL),
                   TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "the channel cells", TETCAST_ERROR_ARGUMENT);
  tetcast_frame_destroy(&frame);
  TetcastTransferFunction *shape = gray_of(context, 1), *made = NULL;
  const double bounds[6] = {0, 1, 0, 1, 1, 0};
  assert_int_equal(
      tetcast_mpi_scale_transfer_function(mpi, world.pieces.scenes, count, bounds, shape, &world.camera, 0.5, &made),
      TETCAST_ERROR_ARGUMENT);
  check_message(&world, 0, "bounds from 1 to 0 in z", TETCAST_ERROR_ARGUMENT);
  assert_int_equal(
      tetcast_mpi_scale_transfer_function(mpi, world.pieces.scenes, count, unit_bounds, shape, &world.camera, 1, &made),
      TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_mpi_fit_transfer_function(mpi, world.pieces.scenes, count, unit_bounds, shape, 2, 1, &made),
                   TETCAST_ERROR_ARGUMENT);
  assert_null(made);
  tetcast_transfer_function_destroy(&shape);
  assert_int_equal(tetcast_mpi_set_memory(mpi, 0), TETCAST_ERROR_ARGUMENT);
  check_good(&world);
  world_end(&world);
}

/* ── memory ── */

/* Wherever memory ends on one rank, all say so, unless that rank can do without. In one band, and in several, where
 * others have begun with the next one when it ends. */
static void memory_may_end_on_any_rank(void **state) {
  (void)state;
  World world;
  world_begin(&world);
  Fixture *fixture = &world.ranks.fixture;
  for (int run = 0; run < 2 * world.ranks.size; ++run) {
    const int failed = run / 2;
    assert_int_equal(tetcast_mpi_set_memory(world.ranks.mpi, run % 2 ? 1 : 1 << 28), TETCAST_OK);
    int ended = 1, failures = 0;
    for (long n = 1; ended; n += test_short() ? 7 : 1) {
      fixture->fail_at = world.ranks.rank == failed ? fixture->allocations + n : 0;
      const TetcastStatus status = render(&world, NULL);
      ended = fixture->allocations >= fixture->fail_at;
      MPI_Bcast(&ended, 1, MPI_INT, failed, MPI_COMM_WORLD);
      fixture->fail_at = 0;
      assert_true(status == TETCAST_OK || status == TETCAST_ERROR_MEMORY);
      failures += status != TETCAST_OK;
      if (status)
        check_message(&world, failed, "out of memory", TETCAST_ERROR_MEMORY);
      else if (world.frame) /* that it says it has succeeded is true */
        assert_memory_equal(tetcast_frame_pixels(world.frame), world.expected, WIDTH * HEIGHT * 4 * sizeof(double));
    }
    assert_true(failures > (test_short() ? 1 : run % 2 ? 20 : 10));
    check_good(&world);
  }
  world_end(&world);
}

/* ── progress ── */

typedef struct Watch {
  double last;
  double cancel_at; /* above 1: never */
  int calls;
} Watch;

static bool watch(void *user, double fraction) {
  Watch *w = user;
  assert_true(fraction >= w->last && fraction <= 1 + 1e-12);
  w->last = fraction;
  ++w->calls;
  return fraction < w->cancel_at;
}

static void any_rank_may_cancel(void **state) {
  (void)state;
  World world;
  world_begin(&world);
  for (int small = 0; small < 2; ++small) {
    assert_int_equal(tetcast_mpi_set_memory(world.ranks.mpi, small ? 1 : 1 << 28), TETCAST_OK);
    Watch w = {.cancel_at = 2};
    TetcastRenderDesc desc = tetcast_render_desc_default();
    desc.progress = (TetcastProgress){watch, &w};
    assert_int_equal(render(&world, &desc), TETCAST_OK);
    assert_true(w.calls > 0 && w.last > 0.99);
    for (int failed = 0; failed < world.ranks.size; ++failed) {
      w = (Watch){.cancel_at = world.ranks.rank == failed ? 0.5 : 2};
      assert_int_equal(render(&world, &desc), TETCAST_ERROR_CANCELLED);
    }
    check_good(&world);
  }
  world_end(&world);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(agreement),
      cmocka_unit_test(what_is_refused_on_one_rank),
      cmocka_unit_test(what_rank_0_wants_is_checked),
      cmocka_unit_test(memory_may_end_on_any_rank),
      cmocka_unit_test(any_rank_may_cancel),
  };
  RUN_WITH_MPI(tests);
}
