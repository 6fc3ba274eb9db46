/* SPDX-License-Identifier: Apache-2.0 */
/* The cells that rays cross: those of brute force, weights that give back places and line integrals, sums that are
 * lengths. */
#include "lines.h"

enum { RAYS = 500 };

/* All crossings of all rays, in one list. */
typedef struct All {
  int64_t rays, count, capacity;
  int64_t offsets[RAYS * 4 + 1];
  TetcastCrossing *crossings;
  int calls, most; /* so many calls are allowed */
} All;

static bool collect(void *user, const TetcastTrace *trace) {
  All *all = user;
  assert_int_equal(trace->first, all->rays);
  assert_true(trace->count >= 1);
  const int64_t more = trace->offsets[trace->count];
  if (all->count + more > all->capacity) {
    all->capacity = 2 * (all->count + more);
    all->crossings = realloc(all->crossings, (size_t)all->capacity * sizeof *all->crossings);
  }
  if (more > 0)
    memcpy(all->crossings + all->count, trace->crossings, (size_t)more * sizeof *all->crossings);
  for (int64_t i = 0; i <= trace->count; ++i)
    all->offsets[all->rays + i] = all->count + trace->offsets[i];
  all->rays += trace->count;
  all->count += more;
  return ++all->calls != all->most;
}

static TetcastTraceDesc trace_desc(void) {
  TetcastTraceDesc desc = tetcast_trace_desc_default();
  desc.isa = render_desc().isa;
  return desc;
}

static All *trace_all(const TetcastVolume *volume, const Lines *lines) {
  All *all = calloc(1, sizeof *all);
  const TetcastRays rays = rays_of(lines);
  const TetcastTraceDesc desc = trace_desc();
  assert_int_equal(tetcast_volume_trace(volume, &rays, &desc, collect, all), TETCAST_OK);
  assert_int_equal(all->rays, lines->count);
  return all;
}

static void all_destroy(All *all) {
  free(all->crossings);
  free(all);
}

/* What a crossing says of itself: its vertices are those of the cell, its weights those of the places where it begins
 * and ends. */
static void check_crossing(const Cube *cube, const Lines *lines, int64_t ray, const TetcastCrossing *c, double size) {
  assert_true(c->cell < (uint64_t)cube->cell_count);
  for (int k = 0; k < 4; ++k) {
    bool found = false;
    for (int j = 0; j < 4; ++j)
      found = found || cube->cells[4 * (int64_t)c->cell + j] == c->vertex[k];
    for (int j = 0; j < k; ++j)
      assert_true(c->vertex[j] != c->vertex[k]);
    assert_true(found);
  }
  double reach = size;
  for (int k = 0; k < 3; ++k)
    reach = fmax(reach, fabs(lines->origin[ray][k]));
  assert_true(c->length > 0 && c->begin <= c->end);
  assert_true(c->begin >= lines->begin[ray] && c->end <= lines->end[ray]);
  for (int e = 0; e < 2; ++e) {
    const double t = e ? c->end : c->begin;
    double sum = 0;
    for (int j = 0; j < 4; ++j) {
      assert_true(c->weight[e][j] >= -1e-15);
      sum += c->weight[e][j];
    }
    assert_true(fabs(sum - 1) <= 1e-14);
    for (int k = 0; k < 3; ++k) {
      Real place = 0;
      for (int j = 0; j < 4; ++j)
        place += (Real)c->weight[e][j] * cube->vertices[3 * (int64_t)c->vertex[j] + k];
      const Real off = fabsl(place - (lines->origin[ray][k] + (Real)t * lines->direction[ray][k]));
      if (!(off <= 3e-14L * reach))
        fail_msg("ray %lld: a place is off by %Lg", (long long)ray, off);
    }
  }
}

/* The crossings of a ray against the plain way: the same cells but for slivers, lengths, sums, and line integrals of a
 * field of points and of one of cells by both bases. */
static void check_ray(const Cube *cube, const double *cell_values, const Lines *lines, int64_t ray,
                      const TetcastCrossing *crossings, int64_t count, double size) {
  const double *eye = lines->origin[ray], *d = lines->direction[ray];
  const Real unit = sqrtl((Real)d[0] * d[0] + (Real)d[1] * d[1] + (Real)d[2] * d[2]);
  double *found = calloc((size_t)cube->cell_count, sizeof *found);
  Real length = 0, of_points = 0, of_cells = 0, basis = 0, last = -INFINITY;
  for (int64_t i = 0; i < count; ++i) {
    const TetcastCrossing *c = &crossings[i];
    check_crossing(cube, lines, ray, c, size);
    found[c->cell] += c->length;
    length += c->length;
    of_cells += c->length * (Real)cell_values[c->cell];
    for (int k = 0; k < 4; ++k) {
      const Real integral = c->length * ((Real)c->weight[0][k] + c->weight[1][k]) / 2;
      basis += integral;
      of_points += integral * cube->values[c->vertex[k]];
    }
    assert_true(c->begin >= last - 1e-13 * size / unit);
    last = c->begin;
  }
  Real plain_length = 0, plain_points = 0, plain_cells = 0;
  for (int64_t cell = 0; cell < cube->cell_count; ++cell) {
    Real from, to, volume, plain = 0;
    cross_cell(cube, cell, eye, d, &from, &to);
    from = fmaxl(from, lines->begin[ray]);
    to = fminl(to, lines->end[ray]);
    if (to > from) {
      const Linear linear = linear_of(cube, cell, cube->values, &volume);
      plain = (to - from) * unit;
      plain_points += plain * value_at(&linear, eye, d, (from + to) / 2);
      plain_cells += plain * cell_values[cell];
      plain_length += plain;
    }
    if (!(fabsl(plain - found[cell]) <= 1e-13L * size))
      fail_msg("ray %lld, cell %lld: %.17g instead of %.17Lg", (long long)ray, (long long)cell, found[cell], plain);
  }
  assert_true(fabsl(length - plain_length) <= 1e-13L * size);
  assert_true(fabsl(basis - length) <= 1e-14L * size);
  assert_true(fabsl(of_points - plain_points) <= 1e-13L * size);
  assert_true(fabsl(of_cells - plain_cells) <= 1e-13L * size);
  free(found);
}

static double *values_of_cells(const Cube *cube) {
  uint64_t seed = 3;
  double *values = malloc((size_t)cube->cell_count * sizeof *values);
  for (int64_t i = 0; i < cube->cell_count; ++i)
    values[i] = uniform(&seed);
  return values;
}

static void as_brute_force(void **state) {
  (void)state;
  static const double scales[] = {1, 1e30, 1e-30};
  for (int traversal = 0; traversal < 2; ++traversal) {
    for (int s = 0; s < 3; ++s) {
      World world;
      world_begin(&world, 4, 0.4, scales[s], (TetcastTraversal)traversal);
      double *values = values_of_cells(&world.cube);
      Lines lines = random_lines(RAYS, scales[s], 13);
      for (int i = 0; i < RAYS; i += 2) {
        lines.begin[i] = 5 + 0.1 * (i % 7);
        lines.end[i] = lines.begin[i] + 0.05 * (i % 11);
      }
      for (int i = 1; i < RAYS; i += 14)
        lines.begin[i] = -INFINITY;
      All *all = trace_all(world.volume, &lines);
      for (int64_t i = 0; i < RAYS; ++i) {
        if (lines.begin[i] >= 0) /* where the plain way begins */
          check_ray(&world.cube, values, &lines, i, all->crossings + all->offsets[i],
                    all->offsets[i + 1] - all->offsets[i], scales[s]);
      }
      all_destroy(all);
      lines_destroy(&lines);
      free(values);
      world_end(&world);
    }
  }
}

/* Through vertices, along edges and in faces: each length counts once, in one of the cells there. */
static void along_vertices_edges_and_faces(void **state) {
  (void)state;
  for (int jitter = 0; jitter < 2; ++jitter) {
    World world;
    world_begin(&world, 4, 0.4 * jitter, 1, TETCAST_TRAVERSAL_SHELL);
    set_values(&world, world.cube.values, TETCAST_POINT);
    assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_ADDITIVE), TETCAST_OK);
    Lines lines = special_lines(&world.cube, RAYS, 19);
    double length[RAYS], integral[RAYS];
    const TetcastRays rays = rays_of(&lines);
    assert_int_equal(
        tetcast_scene_cast(world.scene, &rays, NULL, &(TetcastCastResult){.length = length, .value = integral}, NULL),
        TETCAST_OK);
    All *all = trace_all(world.volume, &lines);
    for (int64_t i = 0; i < RAYS; ++i) {
      double sum = 0, by_points = 0, most = 0;
      for (int64_t j = all->offsets[i]; j < all->offsets[i + 1]; ++j) {
        const TetcastCrossing *c = &all->crossings[j];
        check_crossing(&world.cube, &lines, i, c, 1);
        sum += c->length;
        for (int k = 0; k < 4; ++k)
          by_points += c->length * (c->weight[0][k] + c->weight[1][k]) / 2 * world.cube.values[c->vertex[k]];
      }
      most = fmax(sum, 1);
      assert_true(fabs(sum - length[i]) <= 1e-13 * most);
      assert_true(fabs(by_points - (isnan(integral[i]) ? 0 : integral[i])) <= 1e-13 * most);
      const double *d = lines.direction[i];
      assert_true(i % 4 != 3 || length[i] > 0.1 * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    }
    all_destroy(all);
    lines_destroy(&lines);
    world_end(&world);
  }
}

/* Cells with points of their own, which lie where others do: the numbers are those of the cell. */
static void torn_cells(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(3, 0.4), torn = {.vertex_count = 4 * cube.cell_count, .cell_count = cube.cell_count};
  torn.vertices = malloc((size_t)torn.vertex_count * 3 * sizeof *torn.vertices);
  torn.cells = malloc((size_t)torn.vertex_count * sizeof *torn.cells);
  torn.values = malloc((size_t)torn.vertex_count * sizeof *torn.values);
  for (int64_t i = 0; i < torn.vertex_count; ++i) {
    const int64_t from = cube.cells[i];
    torn.cells[i] = torn.vertex_count - 1 - i;
    memcpy(&torn.vertices[3 * torn.cells[i]], &cube.vertices[3 * from], 3 * sizeof *torn.vertices);
    torn.values[torn.cells[i]] = cube.values[from] + 0.1 * (double)(i / 4 % 3); /* jumps from cell to cell */
  }
  TetcastMesh *mesh = cube_mesh(fixture.context, &torn);
  TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
  tetcast_mesh_destroy(&mesh);
  double *values = values_of_cells(&torn);
  Lines lines = random_lines(RAYS, 1, 53);
  All *all = trace_all(volume, &lines);
  for (int64_t i = 0; i < RAYS; ++i)
    check_ray(&torn, values, &lines, i, all->crossings + all->offsets[i], all->offsets[i + 1] - all->offsets[i], 1);
  all_destroy(all);
  lines_destroy(&lines);
  free(values);
  tetcast_volume_destroy(&volume);
  cube_destroy(&torn);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* From an origin so far away that t has few digits left, lengths have all of theirs. */
static void from_far_away(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  Lines lines = lines_create(100);
  uint64_t seed = 59;
  for (int64_t i = 0; i < 100; ++i) {
    for (int k = 0; k < 3; ++k) {
      lines.origin[i][k] = k == i % 3 ? -0x1p30 : uniform(&seed);
      lines.direction[i][k] = k == i % 3;
    }
  }
  All *all = trace_all(world.volume, &lines);
  for (int64_t i = 0; i < 100; ++i) {
    double sum = 0;
    for (int64_t j = all->offsets[i]; j < all->offsets[i + 1]; ++j)
      sum += all->crossings[j].length;
    assert_true(fabs(sum - 1) <= 1e-14);
  }
  all_destroy(all);
  lines_destroy(&lines);
  world_end(&world);
}

/* ── many rays and few ── */

/* How vertices are read depends on how many rays there are, and each lane's list of crossings grows with them: none of
 * that shows in any bit. */
static void each_ray_as_by_itself(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, traversal == TETCAST_TRAVERSAL_SHELL ? 14 : 5, 0.4, 1, (TetcastTraversal)traversal);
    Lines lines = random_lines(4 * RAYS, 1, 71);
    for (int64_t i = 0; i < lines.count; i += 3)
      lines.end[i] = lines.begin[i] + 4;
    All *all = trace_all(world.volume, &lines);
    for (int64_t i = 0; i < lines.count; ++i) {
      const Lines line = {1, &lines.origin[i], &lines.direction[i], &lines.begin[i], &lines.end[i]};
      All *one = trace_all(world.volume, &line);
      assert_int_equal(one->count, all->offsets[i + 1] - all->offsets[i]);
      if (one->count > 0)
        assert_memory_equal(one->crossings, all->crossings + all->offsets[i],
                            (size_t)one->count * sizeof *one->crossings);
      all_destroy(one);
    }
    all_destroy(all);
    lines_destroy(&lines);
    world_end(&world);
  }
}

/* ── threads, what is refused ── */

static void same_bits_by_any_threads(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  Lines lines = random_lines(4 * RAYS, 1, 61);
  use_threads(world.fixture.context, 1);
  All *one = trace_all(world.volume, &lines);
  use_threads(world.fixture.context, 5);
  All *five = trace_all(world.volume, &lines);
  assert_int_equal(one->count, five->count);
  assert_memory_equal(one->offsets, five->offsets, sizeof one->offsets);
  assert_memory_equal(one->crossings, five->crossings, (size_t)one->count * sizeof *one->crossings);
  /* Without weights all else is the same. */
  All *plain = calloc(1, sizeof *plain);
  const TetcastRays rays = rays_of(&lines);
  TetcastTraceDesc desc = trace_desc();
  desc.weights = 0;
  assert_int_equal(tetcast_volume_trace(world.volume, &rays, &desc, collect, plain), TETCAST_OK);
  assert_memory_equal(one->offsets, plain->offsets, sizeof one->offsets);
  for (int64_t i = 0; i < one->count; ++i) {
    TetcastCrossing wanted = one->crossings[i];
    memset(wanted.vertex, 0, sizeof wanted.vertex);
    memset(wanted.weight, 0, sizeof wanted.weight);
    const TetcastCrossing *got = &plain->crossings[i];
    assert_true(got->cell == wanted.cell && got->begin == wanted.begin && got->end == wanted.end &&
                got->length == wanted.length);
    assert_memory_equal(got->vertex, wanted.vertex, sizeof wanted.vertex);
    assert_memory_equal(got->weight, wanted.weight, sizeof wanted.weight);
  }
  all_destroy(one);
  all_destroy(five);
  all_destroy(plain);
  lines_destroy(&lines);
  world_end(&world);
}

static void what_is_refused(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.4, 1, TETCAST_TRAVERSAL_SHELL);
  Lines lines = random_lines(4 * RAYS, 1, 67);
  TetcastRays rays = rays_of(&lines);
  All *all = calloc(1, sizeof *all);
  assert_int_equal(tetcast_volume_trace(NULL, &rays, NULL, collect, all), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_volume_trace(world.volume, NULL, NULL, collect, all), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_volume_trace(world.volume, &rays, NULL, NULL, all), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_volume_trace(world.volume, &rays, &(TetcastTraceDesc){0}, collect, all),
                   TETCAST_ERROR_ARGUMENT);
  memset(lines.direction[7], 0, sizeof lines.direction[7]);
  assert_int_equal(tetcast_volume_trace(world.volume, &rays, NULL, collect, all), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world.fixture.message, "ray 7: the direction is 0, 0, 0"));
  lines.direction[7][0] = 1;
  assert_int_equal(all->calls, 0);
  all->most = 2;
  use_threads(world.fixture.context, 1);
  assert_int_equal(tetcast_volume_trace(world.volume, &rays, NULL, collect, all), TETCAST_ERROR_CANCELLED);
  assert_int_equal(all->calls, 2);
  const TetcastRays none = tetcast_rays_default();
  assert_int_equal(tetcast_volume_trace(world.volume, &none, NULL, collect, all), TETCAST_OK);
  assert_int_equal(all->calls, 2);
  all_destroy(all);
  lines_destroy(&lines);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(as_brute_force),
      cmocka_unit_test(along_vertices_edges_and_faces),
      cmocka_unit_test(torn_cells),
      cmocka_unit_test(from_far_away),
      cmocka_unit_test(each_ray_as_by_itself),
      cmocka_unit_test(same_bits_by_any_threads),
      cmocka_unit_test(what_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
