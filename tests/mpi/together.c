/* SPDX-License-Identifier: Apache-2.0 */
/* What ranks find out together is what one finds out of the whole mesh, with the same bits whoever has which piece. */
#include "pieces.h"

/* ── messages, bounds, ranges ── */

static void messages_arrive(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  enum { COUNT = 100000 };
  double *numbers = malloc(COUNT * sizeof *numbers);
  for (int root = 0; root < ranks.size; ++root) {
    for (int i = 0; i < COUNT; ++i)
      numbers[i] = ranks.rank == root ? i + 0.5 * root : 0;
    assert_int_equal(tetcast_mpi_broadcast(ranks.mpi, root, numbers, COUNT * sizeof *numbers), TETCAST_OK);
    for (int i = 0; i < COUNT; ++i)
      assert_true(numbers[i] == i + 0.5 * root);
  }
  assert_int_equal(tetcast_mpi_broadcast(ranks.mpi, 0, NULL, 0), TETCAST_OK);
  for (int i = 1; i < ranks.size; ++i) {
    for (int64_t bytes = 0; bytes <= 80000; bytes += 40000) {
      if (ranks.rank == 0) {
        assert_int_equal(tetcast_mpi_send(ranks.mpi, i, numbers, bytes), TETCAST_OK);
      } else if (ranks.rank == i) {
        memset(numbers, 0, COUNT * sizeof *numbers);
        assert_int_equal(tetcast_mpi_receive(ranks.mpi, 0, numbers, bytes), TETCAST_OK);
        for (int k = 0; k < COUNT; ++k)
          assert_true(numbers[k] == (k < bytes / 8 ? k + 0.5 * (ranks.size - 1) : 0));
      }
    }
    if (ranks.rank == 0) { /* another number of bytes than is expected, and then one that is */
      assert_int_equal(tetcast_mpi_send(ranks.mpi, i, numbers, 4000), TETCAST_OK);
      assert_int_equal(tetcast_mpi_send(ranks.mpi, i, numbers + 5, 8), TETCAST_OK);
    } else if (ranks.rank == i) {
      char expected[200];
      assert_int_equal(tetcast_mpi_receive(ranks.mpi, 0, numbers, 8), TETCAST_ERROR_IO);
      snprintf(expected, sizeof expected, "rank 0 has sent 4000 bytes, and rank %d expects 8", i);
      assert_string_equal(ranks.fixture.message, expected);
      assert_int_equal(tetcast_mpi_receive(ranks.mpi, 0, numbers, 8), TETCAST_OK);
      assert_true(numbers[0] == 5 + 0.5 * (ranks.size - 1));
    }
  }
  assert_int_equal(tetcast_mpi_send(ranks.mpi, ranks.rank, numbers, 8), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_mpi_receive(ranks.mpi, ranks.size, numbers, 8), TETCAST_ERROR_ARGUMENT);
  free(numbers);
  ranks_end(&ranks);
}

static void bounds_are_those_of_all(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  const double last = ranks.size - 1, own = ranks.rank;
  double bounds[6] = {-own, own, 5 - own, 6, 1e-300, 1e300};
  assert_int_equal(tetcast_mpi_bounds(ranks.mpi, bounds), TETCAST_OK);
  const double expected[6] = {-last + 0., last, 5 - last, 6, 1e-300, 1e300};
  assert_memory_equal(bounds, expected, sizeof bounds); /* no −0 either */
  double none[6] = {1, 2, 3, ranks.rank ? 2 : 4, 5, 6};
  assert_int_equal(tetcast_mpi_bounds(ranks.mpi, none), TETCAST_OK);
  assert_true(none[0] == 1 && none[3] == 4 && none[5] == 6);
  none[2] = 7;
  assert_int_equal(tetcast_mpi_bounds(ranks.mpi, none), TETCAST_OK);
  for (int k = 0; k < 6; ++k)
    assert_true(none[k] == (k % 2 ? -(double)INFINITY : (double)INFINITY));
  double range[2] = {ranks.rank == ranks.size - 1 ? -3 : (double)NAN, 7};
  assert_int_equal(tetcast_mpi_range(ranks.mpi, range), TETCAST_OK);
  assert_true(range[0] == -3 && range[1] == 7);
  range[0] = ranks.rank % 2 ? 0. : -0., range[1] = ranks.rank % 2 ? -0. : 0.;
  assert_int_equal(tetcast_mpi_range(ranks.mpi, range), TETCAST_OK);
  assert_true(range[0] == 0 && !signbit(range[0]) && range[1] == 0 && !signbit(range[1]));
  range[0] = 2, range[1] = 1;
  assert_int_equal(tetcast_mpi_range(ranks.mpi, range), TETCAST_OK);
  assert_true(range[0] == (double)INFINITY && range[1] == -(double)INFINITY);
  ranks_end(&ranks);
}

/* ── sums ── */

enum { PARTS = 23, SUMS = 5000 };

/* Some values that differ much, some that nearly cancel, and some special ones. */
static double value_of(int part, int i) {
  uint64_t seed = (uint64_t)(part * SUMS + i);
  uniform(&seed);
  const double x = uniform(&seed) - 0.5;
  if (i % 5 == 0)
    return x * pow(10, 300 * (2 * uniform(&seed) - 1));
  if (i % 5 == 1) /* pairs cancel, and what remains is much smaller */
    return part == PARTS - 1 ? 1e-17 * (i + 1) : (part % 2 ? -1 : 1) * (1 + part / 2 * 0.37);
  if (i % 5 == 2)
    return part == i % PARTS         ? (i % 3 ? (double)INFINITY : (double)NAN)
           : part == 3 && i % 7 == 0 ? -(double)INFINITY
                                     : x;
  if (i % 5 == 3)
    return part % 3 ? 0x1p-1074 * part : -0.;
  return x * 1e-3;
}

static void check_sums(int count, Deal deal, double *expected) {
  Ranks ranks;
  ranks_begin(&ranks, count);
  if (ranks.mpi) {
    double *values = malloc(PARTS * SUMS * sizeof *values), *sums = malloc(SUMS * sizeof *sums);
    int64_t parts = 0;
    for (int p = 0; p < PARTS; ++p) {
      if (!has_piece(p, PARTS, deal, ranks.rank, ranks.size))
        continue;
      for (int i = 0; i < SUMS; ++i)
        values[parts * SUMS + i] = value_of(p, i);
      ++parts;
    }
    assert_int_equal(tetcast_mpi_sum(ranks.mpi, parts ? values : NULL, parts, SUMS, sums), TETCAST_OK);
    if (count == 1 && deal == 0 && ranks.rank == 0)
      memcpy(expected, sums, SUMS * sizeof *sums);
    assert_int_equal(tetcast_mpi_broadcast(ranks.mpi, 0, expected, SUMS * sizeof *expected), TETCAST_OK);
    assert_memory_equal(sums, expected, SUMS * sizeof *sums);
    free(values);
    free(sums);
  }
  ranks_end(&ranks);
}

static void sums_do_not_depend_on_ranks(void **state) {
  (void)state;
  static double expected[SUMS];
  for (int count = 1; count <= world_size(); ++count) {
    for (int deal = 0; deal < DEALS; ++deal)
      check_sums(count, (Deal)deal, expected);
  }
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  for (int i = 0; i < SUMS && rank == 0; ++i) { /* and are right */
    double most = 0;
    long double sum = 0; /* good to 2^−60 of the largest */
    for (int p = 0; p < PARTS; ++p) {
      sum += (long double)value_of(p, i);
      most = fmax(most, fabs(value_of(p, i)));
    }
    if (i % 5 == 1)
      assert_true(fabs(expected[i] - 1e-17 * (i + 1)) <= 1e-15 * 1e-17 * (i + 1));
    else if (isfinite(sum))
      assert_true(fabs(expected[i] - (double)sum) <= 0x1p-52 * fabs((double)sum) + 0x1p-58 * most);
    else
      assert_true(isnan(sum) ? isnan(expected[i]) : expected[i] == (double)sum);
  }
}

static void wrong_sums_are_refused(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  double values[8] = {1, 2, 3, 4, 5, 6, 7, 8}, sums[8];
  if (ranks.size > 1)
    assert_int_equal(tetcast_mpi_sum(ranks.mpi, values, 1, 4 + (ranks.rank == 1), sums), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_mpi_sum(ranks.mpi, values, ranks.rank == ranks.size - 1 ? -1 : 1, 4, sums),
                   TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_mpi_sum(ranks.mpi, values, 2, 4, ranks.rank == 0 ? NULL : sums), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_mpi_sum(ranks.mpi, NULL, 0, 0, NULL), TETCAST_OK);
  assert_int_equal(tetcast_mpi_sum(ranks.mpi, NULL, 0, 3, sums), TETCAST_OK);
  assert_true(sums[0] == 0 && sums[2] == 0);
  assert_int_equal(tetcast_mpi_sum(ranks.mpi, values, 2, 4, sums), TETCAST_OK);
  for (int i = 0; i < 4; ++i)
    assert_true(sums[i] == ranks.size * (values[i] + values[4 + i]));
  ranks_end(&ranks);
}

/* ── statistics ── */

static TetcastStatisticsDesc wanted(int gradient_bins) {
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  desc.range[0] = 0.2;
  desc.range[1] = 0.9;
  desc.bins = 100;
  desc.gradient_bins = gradient_bins;
  if (gradient_bins)
    desc.gradient_range[1] = 5;
  return desc;
}

/* The statistics of the pieces that this rank has; returns how many. */
static int statistics_of(const Ranks *ranks, const Cube *cube, Deal deal, int pieces, int gradient_bins,
                         TetcastStatistics **made) {
  TetcastContext *context = ranks->fixture.context;
  const TetcastStatisticsDesc desc = wanted(gradient_bins);
  int *owner = split_cells(cube, SPLIT_WAVY, pieces), count = 0;
  double *values = malloc((size_t)cube->vertex_count * sizeof *values);
  for (int i = 0; i < pieces; ++i) {
    uint64_t seed = 1;
    TetcastMesh *mesh = NULL;
    if (has_piece(i, pieces, deal, ranks->rank, ranks->size))
      mesh = mesh_of_owner(context, cube, owner, i, &seed, values);
    if (!mesh)
      continue;
    TetcastField *field = field_of(context, values, tetcast_mesh_vertex_count(mesh), TETCAST_POINT);
    assert_int_equal(tetcast_statistics_create(context, mesh, field, &desc, &made[count++]), TETCAST_OK);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
  }
  free(values);
  free(owner);
  return count;
}

enum { NUMBERS = 4 + 100 + 2 * 101 + 100 * 9 };

static void numbers_of(const TetcastStatistics *s, double numbers[NUMBERS]) {
  memcpy(numbers, &(double[4]){s->total, s->unknown, s->below, s->above}, 4 * sizeof *numbers);
  memcpy(numbers + 4, s->volume, 100 * sizeof *numbers);
  memcpy(numbers + 104, s->area, 101 * sizeof *numbers);
  memcpy(numbers + 205, s->gradient, 101 * sizeof *numbers);
  if (s->joint)
    memcpy(numbers + 306, s->joint, 900 * sizeof *numbers);
}

static void check_statistics(int count, const Cube *cube, Deal deal, int gradient_bins, double *expected) {
  Ranks ranks;
  ranks_begin(&ranks, count);
  if (ranks.mpi) {
    TetcastStatistics *parts[7], *whole = NULL;
    double numbers[NUMBERS] = {0};
    const int parts_count = statistics_of(&ranks, cube, deal, 7, gradient_bins, parts);
    assert_int_equal(tetcast_mpi_statistics(ranks.mpi, parts_count ? (const TetcastStatistics *const *)parts : NULL,
                                            parts_count, &whole),
                     TETCAST_OK);
    assert_int_equal(whole->bins, 100);
    assert_int_equal(whole->gradient_bins, gradient_bins);
    assert_true(whole->range[0] == 0.2 && whole->range[1] == 0.9);
    numbers_of(whole, numbers);
    if (count == 1 && deal == 0)
      memcpy(expected, numbers, sizeof numbers);
    assert_int_equal(tetcast_mpi_broadcast(ranks.mpi, 0, expected, sizeof numbers), TETCAST_OK);
    assert_memory_equal(numbers, expected, sizeof numbers);
    if (count == 1) {
      TetcastStatistics *one[1];
      double of_one[NUMBERS] = {0};
      Ranks alone = ranks;
      assert_int_equal(statistics_of(&alone, cube, DEAL_IN_TURN, 1, gradient_bins, one), 1);
      numbers_of(one[0], of_one);
      assert_true(of_one[0] > 0.99);
      for (int i = 0; i < NUMBERS; ++i)
        assert_true(fabs(of_one[i] - numbers[i]) <= 1e-14 * (1 + fabs(of_one[i])));
      tetcast_statistics_destroy(ranks.fixture.context, &one[0]);
    }
    for (int i = 0; i < parts_count; ++i)
      tetcast_statistics_destroy(ranks.fixture.context, &parts[i]);
    tetcast_statistics_destroy(ranks.fixture.context, &whole);
  }
  ranks_end(&ranks);
}

static void statistics_are_those_of_the_whole(void **state) {
  (void)state;
  Cube cube = cube_create(5, 0.5);
  static double expected[NUMBERS];
  for (int joint = 0; joint < 2; ++joint) {
    for (int count = 1; count <= world_size(); ++count) {
      for (int deal = 0; deal < DEALS; ++deal)
        check_statistics(count, &cube, (Deal)deal, joint ? 9 : 0, expected);
    }
  }
  cube_destroy(&cube);
}

static void statistics_must_go_together(void **state) {
  (void)state;
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  Cube cube = cube_create(2, 0.5);
  TetcastStatistics *parts[2], *whole = NULL;
  assert_int_equal(tetcast_mpi_statistics(ranks.mpi, NULL, 0, &whole), TETCAST_ERROR_ARGUMENT);
  assert_null(whole);
  const bool last = ranks.rank == ranks.size - 1;
  if (ranks.rank == 0)
    assert_int_equal(statistics_of(&ranks, &cube, DEAL_FIRST, 1, 0, parts), 1);
  Ranks alone = ranks;
  alone.rank = 0, alone.size = 1;
  if (last)
    assert_int_equal(statistics_of(&alone, &cube, DEAL_FIRST, 1, 9, parts + (ranks.rank == 0)), 1);
  const int count = (ranks.rank == 0) + last;
  assert_int_equal(tetcast_mpi_statistics(ranks.mpi, (const TetcastStatistics *const *)parts, count, &whole),
                   TETCAST_ERROR_ARGUMENT);
  assert_null(whole);
  for (int i = 0; i < count; ++i)
    tetcast_statistics_destroy(ranks.fixture.context, &parts[i]);
  cube_destroy(&cube);
  ranks_end(&ranks);
}

/* ── transfer functions ── */

static const double bounds_of_cube[6] = {0, 1, 0, 1, 0, 1};

static void check_equal(const TetcastTransferFunction *a, const TetcastTransferFunction *b, double most_off) {
  int64_t colors, other_colors, extinctions, other_extinctions;
  const double *color = tetcast_transfer_function_color(a, &colors),
               *other_color = tetcast_transfer_function_color(b, &other_colors);
  const double *extinction = tetcast_transfer_function_extinction(a, &extinctions),
               *other_extinction = tetcast_transfer_function_extinction(b, &other_extinctions);
  assert_true(colors == other_colors && extinctions == other_extinctions);
  assert_memory_equal(color, other_color, (size_t)colors * 4 * sizeof *color);
  for (int64_t i = 0; i < 2 * extinctions; ++i)
    assert_true(fabs(extinction[i] - other_extinction[i]) <= most_off * fabs(other_extinction[i]));
}

/* 0: a scaled one, 1: one fitted, 2: one without extinction, 3: one of which nothing is seen. */
static TetcastTransferFunction *make_together(Ranks *ranks, Pieces *pieces, int kind) {
  TetcastContext *context = ranks->fixture.context;
  TetcastTransferFunction *shape = kind == 2 ? gray_of(context, 0) : transfer_of(context, kind ? 1 : 1e20),
                          *made = NULL;
  const TetcastCamera camera = kind == 3 ? camera_of(2, 2, 3, 7, 8, 9) : camera_of(2.1, 1.7, 3.3, 0.5, 0.4, 0.5);
  if (kind == 1) {
    assert_int_equal(tetcast_mpi_fit_transfer_function(ranks->mpi, pieces->scenes, pieces->count,
                                                       ranks->rank ? NULL : bounds_of_cube, ranks->rank ? NULL : shape,
                                                       ranks->rank ? 9 : 0.1, ranks->rank ? 1 : 0.8, &made),
                     TETCAST_OK);
  } else {
    assert_int_equal(tetcast_mpi_scale_transfer_function(
                         ranks->mpi, pieces->scenes, pieces->count, ranks->rank ? NULL : bounds_of_cube,
                         ranks->rank ? NULL : shape, ranks->rank ? NULL : &camera, ranks->rank ? 7 : 0.97, &made),
                     TETCAST_OK);
  }
  tetcast_transfer_function_destroy(&shape);
  return made;
}

static TetcastTransferFunction *make_alone(TetcastContext *context, const Cube *cube, int kind) {
  Pieces whole = pieces_of(context, cube, SPLIT_BOXES, 1, DEAL_IN_TURN, 0, 1);
  TetcastTransferFunction *shape = kind == 2 ? gray_of(context, 0) : transfer_of(context, kind ? 1 : 1e20),
                          *made = NULL;
  const TetcastCamera camera = kind == 3 ? camera_of(2, 2, 3, 7, 8, 9) : camera_of(2.1, 1.7, 3.3, 0.5, 0.4, 0.5);
  if (kind == 1)
    assert_int_equal(tetcast_scene_fit_transfer_function(whole.scenes[0], shape, 0.1, 0.8, &made), TETCAST_OK);
  else
    assert_int_equal(tetcast_scene_scale_transfer_function(whole.scenes[0], shape, &camera, 0.97, &made), TETCAST_OK);
  tetcast_transfer_function_destroy(&shape);
  pieces_end(&whole);
  return made;
}

static void transfer_functions_are_those_of_the_whole(void **state) {
  (void)state;
  Cube cube = cube_create(6, 0.5);
  for (int kind = 0; kind < 4; ++kind) {
    double expected[100] = {0}; /* at rank 0, the extinctions found by the first ranks */
    int64_t number = 0;
    for (int count = 1; count <= world_size(); ++count) {
      Ranks ranks;
      ranks_begin(&ranks, count);
      if (ranks.mpi) {
        Pieces pieces = pieces_of(ranks.fixture.context, &cube, SPLIT_SCATTER, 5, (Deal)(count % 3), ranks.rank, count);
        TetcastTransferFunction *all = make_together(&ranks, &pieces, kind),
                                *one = make_alone(ranks.fixture.context, &cube, kind);
        check_equal(all, one, 1e-12);
        int64_t knots;
        const double *extinction = tetcast_transfer_function_extinction(all, &knots);
        if (count == 1)
          memcpy(expected, extinction, (size_t)knots * 2 * sizeof *expected);
        number = 2 * knots;
        assert_int_equal(tetcast_mpi_broadcast(ranks.mpi, 0, expected, number * (int64_t)sizeof *expected), TETCAST_OK);
        assert_memory_equal(expected, extinction, (size_t)number * sizeof *expected);
        tetcast_transfer_function_destroy(&all);
        tetcast_transfer_function_destroy(&one);
        pieces_end(&pieces);
      }
      ranks_end(&ranks);
    }
  }
  cube_destroy(&cube);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(messages_arrive),
      cmocka_unit_test(bounds_are_those_of_all),
      cmocka_unit_test(sums_do_not_depend_on_ranks),
      cmocka_unit_test(wrong_sums_are_refused),
      cmocka_unit_test(statistics_are_those_of_the_whole),
      cmocka_unit_test(statistics_must_go_together),
      cmocka_unit_test(transfer_functions_are_those_of_the_whole),
  };
  RUN_WITH_MPI(tests);
}
