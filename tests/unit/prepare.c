/* SPDX-License-Identifier: Apache-2.0 */
/* Preparing a volume: the adjacency against one that is made in the simplest way, the same for any number of threads,
 * within its memory, and stopped or out of memory at any point. */
#include "support.h"

#include "volume/rows.h"

/* ── meshes ── */

static void shuffle(Cube *cube, uint64_t seed) {
  for (int64_t i = cube->cell_count - 1; i > 0; --i) {
    const int64_t j = (int64_t)(uniform(&seed) * (double)(i + 1));
    for (int k = 0; k < 4; ++k) {
      const int64_t v = cube->cells[4 * i + k];
      cube->cells[4 * i + k] = cube->cells[4 * j + (k + i) % 4];
      cube->cells[4 * j + (k + i) % 4] = v;
    }
  }
}

/* Cells left out and faces of three cells. */
static void damage(Cube *cube, uint64_t seed) {
  for (int i = 0; i < 40; ++i) {
    const int64_t a = (int64_t)(uniform(&seed) * (double)cube->cell_count),
                  b = (int64_t)(uniform(&seed) * (double)cube->cell_count);
    if (i % 4 == 0)
      cube->cells[4 * a] = cube->cells[4 * a + 2];
    else if (i % 4 == 1)
      memcpy(&cube->cells[4 * a], &cube->cells[4 * b], 4 * sizeof *cube->cells);
    else if (i % 4 == 2)
      cube->cells[4 * a] = cube->cells[4 * b + 1];
    else
      memcpy(&cube->cells[4 * a], &cube->cells[4 * b], 3 * sizeof *cube->cells);
  }
}

/* All cells at vertex 0: `side`² squares of two triangles each, seen from it. It is also the first on the curve. */
static Cube fan(int side) {
  const int64_t m = side + 1;
  Cube cube = {m * m + 1, INT64_C(2) * side * side, NULL, NULL, NULL};
  cube.vertices = calloc((size_t)cube.vertex_count * 3, sizeof *cube.vertices);
  cube.values = calloc((size_t)cube.vertex_count, sizeof *cube.values);
  cube.cells = calloc((size_t)cube.cell_count * 4, sizeof *cube.cells);
  for (int64_t i = 0; i < m * m; ++i) {
    const double p[3] = {(double)(i % m) / side, (double)(i / m) / side, 1};
    memcpy(&cube.vertices[3 * (i + 1)], p, sizeof p);
  }
  for (int64_t i = 0; i < cube.cell_count; ++i) {
    const int64_t a = 1 + i / 2 % side + i / 2 / side * m;
    const int64_t cell[4] = {0, a, a + m + 1, i % 2 ? a + 1 : a + m};
    memcpy(&cube.cells[4 * i], cell, sizeof cell);
  }
  return cube;
}

/* ── the simplest way ── */

typedef struct Face {
  uint32_t v[3], cell, k;
} Face;

static int compare_faces(const void *left, const void *right) {
  const Face *a = left, *b = right;
  for (int k = 0; k < 3; ++k) {
    if (a->v[k] != b->v[k])
      return a->v[k] < b->v[k] ? -1 : 1;
  }
  return 0;
}

/* That each face of the cells is joined to the one other that has its vertices, and is on the shell when there is none
 * or more. */
static void check_faces(const TcAdjacency *adjacency) {
  const size_t count = (size_t)adjacency->cell_count * 4;
  Face *faces = malloc((count + 1) * sizeof *faces);
  for (size_t i = 0; i < count; ++i) {
    faces[i].cell = (uint32_t)(i / 4);
    faces[i].k = (uint32_t)(i % 4);
    for (uint32_t j = 0, n = 0; j < 4; ++j) {
      if (j != i % 4)
        faces[i].v[n++] = adjacency->vertices[i / 4][j];
    }
  }
  qsort(faces, count, sizeof *faces, compare_faces);
  int64_t boundary = 0, nonmanifold = 0, shell = 0;
  for (size_t i = 0, n; i < count; i += n) {
    n = 1;
    while (i + n < count && compare_faces(&faces[i], &faces[i + n]) == 0)
      ++n;
    boundary += n == 1;
    nonmanifold += n > 2;
    for (size_t j = i; j < i + n; ++j) {
      const uint32_t neighbor = adjacency->cells[faces[j].cell].neighbor[faces[j].k];
      if (n == 2) {
        assert_int_equal(neighbor, faces[i + (j == i)].cell);
      } else {
        assert_true(neighbor & TC_SHELL);
        const TcShellFace *face = &adjacency->shell[neighbor & ~TC_SHELL];
        assert_true((neighbor & ~TC_SHELL) < adjacency->shell_count);
        assert_memory_equal(face->vertex, faces[j].v, sizeof face->vertex);
        assert_int_equal(face->cell, faces[j].cell);
        ++shell;
      }
    }
  }
  assert_int_equal(boundary, adjacency->boundary);
  assert_int_equal(nonmanifold, adjacency->nonmanifold);
  assert_int_equal(shell, adjacency->shell_count);
  free(faces);
}

static int compare_cells(const void *left, const void *right) {
  const uint32_t *a = left, *b = right;
  for (int k = 0; k < 4; ++k) {
    if (a[k] != b[k])
      return a[k] < b[k] ? -1 : 1;
  }
  return 0;
}

static void take_cell(const Cube *cube, const uint32_t *rank, int64_t i, uint32_t v[4]) {
  for (int k = 0; k < 4; ++k)
    v[k] = rank ? rank[cube->cells[4 * i + k]] : (uint32_t)cube->cells[4 * i + k];
  tc_sort4(v);
}

/* That the cells are the mesh's, each once, in order, and the first of those with the same vertices. */
static void check_cells(const Cube *cube, const uint32_t *rank, const TcAdjacency *adjacency) {
  unsigned char *kept = calloc((size_t)cube->cell_count + 1, 1);
  for (int64_t i = 0; i < adjacency->cell_count; ++i) {
    const uint32_t *v = adjacency->vertices[i];
    uint32_t expected[4];
    take_cell(cube, rank, adjacency->source[i], expected);
    assert_memory_equal(v, expected, sizeof expected);
    assert_true(v[0] < v[1] && v[1] < v[2] && v[2] < v[3]);
    assert_int_equal(adjacency->cells[i].vertex_xor, v[0] ^ v[1] ^ v[2] ^ v[3]);
    assert_true(i == 0 || compare_cells(adjacency->vertices[i - 1], v) < 0);
    kept[adjacency->source[i]] = 1;
  }
  int64_t collapsed = 0, duplicates = 0;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    if (kept[i])
      continue;
    uint32_t v[4];
    take_cell(cube, rank, i, v);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[3]) {
      ++collapsed;
      continue;
    }
    const uint32_t *twin = bsearch(v, adjacency->vertices, (size_t)adjacency->cell_count, sizeof v, compare_cells);
    assert_non_null(twin);
    assert_true(adjacency->source[(twin - adjacency->vertices[0]) / 4] < i);
    ++duplicates;
  }
  assert_int_equal(collapsed, adjacency->collapsed);
  assert_int_equal(duplicates, adjacency->duplicates);
  assert_int_equal(adjacency->cell_count + collapsed + duplicates, cube->cell_count);
  free(kept);
}

/* Against the simplest way, and one number of threads against another; vertices numbered backwards or as they are. */
static void check_adjacency(Cube cube) {
  const int threads[] = {1, 2, 3, 7};
  uint32_t *rank = malloc((size_t)cube.vertex_count * sizeof *rank);
  for (int64_t i = 0; i < cube.vertex_count; ++i)
    rank[i] = (uint32_t)(cube.vertex_count - 1 - i);
  for (int renumbered = 0; renumbered < 2; ++renumbered) {
    Fixture fixture[4];
    TcAdjacency adjacency[4];
    for (int t = 0; t < 4; ++t) {
      assert_int_equal(fixture_begin(&fixture[t], threads[t], 0), TETCAST_OK);
      TetcastMesh *mesh = cube_mesh(fixture[t].context, &cube);
      assert_int_equal(tc_adjacency_build(mesh, renumbered ? rank : NULL, true, NULL, &adjacency[t]), TETCAST_OK);
      tetcast_mesh_destroy(&mesh);
    }
    const TcAdjacency *one = &adjacency[0];
    check_cells(&cube, renumbered ? rank : NULL, one);
    check_faces(one);
    for (int t = 0; t < 4; ++t) {
      const TcAdjacency *other = &adjacency[t];
      const size_t cells = (size_t)one->cell_count;
      assert_int_equal(other->cell_count, one->cell_count);
      assert_int_equal(other->shell_count, one->shell_count);
      assert_int_equal(other->nonmanifold, one->nonmanifold);
      assert_memory_equal(other->cells, one->cells, cells * sizeof *one->cells);
      assert_memory_equal(other->vertices, one->vertices, cells * sizeof *one->vertices);
      assert_memory_equal(other->source, one->source, cells * sizeof *one->source);
      assert_memory_equal(other->shell, one->shell, (size_t)one->shell_count * sizeof *one->shell);
    }
    for (int t = 0; t < 4; ++t) {
      tc_adjacency_clear(&adjacency[t]);
      fixture_end(&fixture[t]);
    }
  }
  free(rank);
  cube_destroy(&cube);
}

static void cubes(void **state) {
  (void)state;
  check_adjacency(cube_create(1, 0));
  Cube cube = cube_create(20, 0.3); /* several pieces for every loop */
  shuffle(&cube, 8);
  check_adjacency(cube);
}

static void damaged_meshes(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed < 60; ++seed) {
    Cube cube = cube_create(seed % 2 ? 3 : 1, 0.3);
    damage(&cube, seed);
    check_adjacency(cube);
  }
  Cube cube = cube_create(20, 0.3);
  damage(&cube, 77);
  memcpy(&cube.cells[4 * 30000], &cube.cells[0], 4 * 4 * sizeof *cube.cells);
  check_adjacency(cube);
  cube = cube_create(2, 0); /* nothing is left */
  memset(cube.cells, 0, (size_t)cube.cell_count * 4 * sizeof *cube.cells);
  check_adjacency(cube);
}

static void many_cells_at_a_vertex(void **state) {
  (void)state;
  check_adjacency(fan(6));
  check_adjacency(fan(40));
  Cube cube = fan(40);
  damage(&cube, 9);
  shuffle(&cube, 9);
  check_adjacency(cube);
}

/* ── a volume ── */

static void any_allocation_may_fail(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    Cube cube = fan(20);
    damage(&cube, 4);
    TetcastVolumeDesc desc = tetcast_volume_desc_default();
    desc.traversal = traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL;
    bool failed = true;
    for (long number = 1; failed; ++number) {
      Fixture fixture;
      assert_int_equal(fixture_begin(&fixture, 3, 0), TETCAST_OK);
      TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
      fixture.fail_at = fixture.allocations + number;
      TetcastVolume *volume;
      const TetcastStatus status = tetcast_volume_create(fixture.context, mesh, &desc, &volume);
      failed = fixture.allocations >= fixture.fail_at;
      if (status) {
        assert_int_equal(status, TETCAST_ERROR_MEMORY);
        assert_non_null(strstr(fixture.message, "memory"));
      }
      assert_true(failed || !status);
      tetcast_volume_destroy(&volume);
      tetcast_mesh_destroy(&mesh);
      fixture_end(&fixture);
    }
    cube_destroy(&cube);
  }
}

typedef struct Listener {
  double last, stop_from; /* fractions */
  int calls;
  bool stopped;
} Listener;

static bool listen(void *user, double fraction) {
  Listener *listener = user;
  assert_true(!listener->stopped && fraction >= listener->last && fraction <= 1);
  listener->last = fraction;
  listener->stopped = fraction >= listener->stop_from;
  ++listener->calls;
  return !listener->stopped;
}

/* How often it is told depends on how long that takes, but that it has come beyond half is told. */
static void progress_goes_up_and_can_stop_it(void **state) {
  (void)state;
  Cube cube = cube_create(20, 0.3);
  for (int hundredth = 200; hundredth >= 0; hundredth -= hundredth > 100 ? 100 : 2) {
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    Listener listener = {.stop_from = hundredth / 100.0};
    TetcastVolumeDesc desc = tetcast_volume_desc_default();
    desc.progress = (TetcastProgress){listen, &listener};
    TetcastVolume *volume;
    const TetcastStatus status = tetcast_volume_create(fixture.context, mesh, &desc, &volume);
    assert_int_equal(status, listener.stopped ? TETCAST_ERROR_CANCELLED : TETCAST_OK);
    assert_true(listener.stopped || (listener.calls > 4 && listener.last > 0.5));
    tetcast_volume_destroy(&volume);
    tetcast_mesh_destroy(&mesh);
    fixture_end(&fixture);
  }
  cube_destroy(&cube);
}

typedef struct Meter {
  long long live, peak;
} Meter;

static void *meter_allocate(void *user, size_t size, size_t alignment) {
  Meter *meter = user;
  char *memory = aligned_alloc(alignment, (size + 2 * alignment - 1) / alignment * alignment);
  if (!memory)
    return NULL;
  memcpy(memory, &size, sizeof size);
  const long long live = __atomic_add_fetch(&meter->live, (long long)size, __ATOMIC_RELAXED);
  if (live > meter->peak)
    meter->peak = live; /* what counts is allocated between loops */
  return memory + alignment;
}

static void meter_release(void *user, void *memory) {
  Meter *meter = user;
  size_t size;
  memcpy(&size, (char *)memory - 64, sizeof size);
  __atomic_sub_fetch(&meter->live, (long long)size, __ATOMIC_RELAXED);
  free((char *)memory - 64);
}

/* Also of a mesh half of whose cells are left out. */
static void memory_is_bounded(void **state) {
  (void)state;
  for (int doubled = 0; doubled < 2; ++doubled) {
    Cube cube = cube_create(24, 0.3);
    shuffle(&cube, 2);
    const size_t half = (size_t)cube.cell_count / 2 * 4;
    if (doubled)
      memcpy(cube.cells + half, cube.cells, half * sizeof *cube.cells);
    Meter meter = {0};
    TetcastContextDesc desc = tetcast_context_desc_default();
    desc.threads = 1;
    desc.allocate = meter_allocate;
    desc.release = meter_release;
    desc.memory_user = &meter;
    TetcastContext *context;
    assert_int_equal(tetcast_context_create(&desc, &context), TETCAST_OK);
    TetcastMesh *mesh = cube_mesh(context, &cube);
    TetcastField *field = field_of(context, cube.values, cube.vertex_count, TETCAST_POINT);
    const long long before = meter.live;
    meter.peak = before;
    TetcastVolume *volume = volume_of(context, mesh, TETCAST_TRAVERSAL_SHELL);
    assert_true(meter.peak - before <= 64 * cube.cell_count);
    TetcastScene *scene = NULL;
    assert_int_equal(tetcast_scene_create(context, volume, &scene), TETCAST_OK);
    const long long before_field = meter.live;
    assert_int_equal(tetcast_scene_set_field(scene, field), TETCAST_OK);
    assert_true(meter.live - before_field <=
                8 * cube.vertex_count + 4096 + cube.cell_count / 8); /* values, clusters' ranges */
    TetcastVolumeInfo info;
    tetcast_volume_info(volume, &info);
    const long long resident = meter.live - before - 4 * info.left_out; /* sources are not moved once more */
    /* Where half of the cells are missing, clusters fall apart, and more of their vertices are kept. */
    const long long clusters = doubled ? (long long)tc_clusters_bytes(&volume->clusters) : 0;
    const long long bound = 24 * info.tetrahedra + 40 * cube.vertex_count + 16 * info.shell_faces + clusters + 4096;
    assert_true(doubled == (info.left_out > 0) && resident <= bound);
    const long long counted = (long long)(info.bytes - tc_embree_bytes(volume->shell.embree));
    assert_true(counted >= resident - 4096 && counted <= bound);
    tetcast_scene_destroy(&scene);
    tetcast_volume_destroy(&volume);
    assert_true(meter.live == before);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
    tetcast_context_destroy(&context);
    cube_destroy(&cube);
  }
}

/* Volumes are the same for any number of threads, whatever order the mesh comes in, and neighbours are near in memory.
 */
static void volumes_are_ordered(void **state) {
  (void)state;
  Cube cube = cube_create(24, 0.3);
  shuffle(&cube, 3);
  Fixture fixture;
  TetcastVolume *first = NULL;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  for (int threads = 1; threads <= 7; ++threads) {
    assert_int_equal(tetcast_context_set_threads(fixture.context, threads), TETCAST_OK);
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
    tetcast_mesh_destroy(&mesh);
    if (!first)
      first = volume;
    const size_t cells = (size_t)volume->cell_count, vertices = (size_t)volume->vertex_count;
    assert_memory_equal(volume->positions, first->positions, vertices * 3 * sizeof(double));
    assert_memory_equal(volume->vertex_source, first->vertex_source, vertices * sizeof *volume->vertex_source);
    assert_memory_equal(volume->adjacency.cells, first->adjacency.cells, cells * sizeof *volume->adjacency.cells);
    if (volume != first)
      tetcast_volume_destroy(&volume);
  }
  int64_t near = 0, joined = 0;
  for (int64_t i = 0; i < first->cell_count; ++i) {
    for (int k = 0; k < 4; ++k) {
      const uint32_t neighbor = first->adjacency.cells[i].neighbor[k];
      if (neighbor & TC_SHELL)
        continue;
      ++joined;
      near += llabs((int64_t)neighbor - i) < 200;
    }
  }
  assert_true(near > joined / 2);
  tetcast_volume_destroy(&first);
  fixture_end(&fixture);
  cube_destroy(&cube);
}

/* That every vertex and cell of the volume is the one of the mesh that it says, and so is each of the rows' values, if
 * any. */
static void check_sources(const TetcastVolume *volume, const Cube *cube, const TcRows *rows, const double *values) {
  uint32_t *rank = malloc((size_t)cube->vertex_count * sizeof *rank);
  for (uint32_t i = 0; i < (uint32_t)cube->vertex_count; ++i) {
    const int64_t vertex = volume->vertex_source[i];
    double position[3];
    tc_volume_vertex(volume, i, position);
    for (int k = 0; k < 3; ++k)
      assert_true(ldexp(position[k], volume->exponent) == cube->vertices[3 * vertex + k]);
    if (values && rows->association == TETCAST_POINT)
      assert_true(tc_rows_value(rows, i, 0) == values[vertex]);
    rank[vertex] = i;
  }
  for (int64_t i = 0; i < volume->cell_count; ++i) {
    const int64_t cell = volume->adjacency.source[i];
    uint32_t v[4];
    take_cell(cube, rank, cell, v);
    assert_int_equal(volume->adjacency.cells[i].vertex_xor, v[0] ^ v[1] ^ v[2] ^ v[3]);
    if (values && rows->association == TETCAST_CELL)
      assert_true(tc_rows_value(rows, i, 0) == values[cell]);
    if (!values || rows->association != TETCAST_CORNER)
      continue;
    for (int k = 0; k < 4; ++k) { /* that of the corner which is the cell's k-th vertex in ascending order */
      int corner = 0;
      while (rank[cube->cells[4 * cell + corner]] != v[k])
        ++corner;
      assert_true(tc_rows_value(rows, i, k) == values[4 * cell + corner]);
    }
  }
  free(rank);
}

/* Values of points, cells and corners find their places, stored in the precision that they came in. */
static void values_find_their_places(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 3, 0), TETCAST_OK);
  Cube cube = cube_create(16, 0.3);
  shuffle(&cube, 5);
  float *vertices = malloc((size_t)cube.vertex_count * 3 * sizeof *vertices);
  for (int64_t i = 0; i < 3 * cube.vertex_count; ++i)
    cube.vertices[i] = (double)(vertices[i] = (float)cube.vertices[i]);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT32, cube.vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube.cells, TETCAST_TYPE_INT64, cube.cell_count, 0};
  TetcastMesh *mesh;
  assert_int_equal(tetcast_mesh_create(fixture.context, &mesh_desc, &mesh), TETCAST_OK);
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.corners = 1;
  TetcastVolume *volume;
  assert_int_equal(tetcast_volume_create(fixture.context, mesh, &volume_desc, &volume), TETCAST_OK);
  assert_false(volume->positions_are_double);
  const int64_t counts[] = {cube.vertex_count, cube.cell_count, 4 * cube.cell_count};
  double *values = malloc((size_t)counts[2] * sizeof *values);
  float *rounded = malloc((size_t)counts[2] * sizeof *rounded);
  for (int association = TETCAST_POINT; association <= TETCAST_CORNER; ++association) {
    for (int is_double = 0; is_double < 2; ++is_double) {
      const int64_t count = counts[association];
      for (int64_t i = 0; i < count; ++i) {
        values[i] = (double)i / 7;
        rounded[i] = (float)values[i];
        if (!is_double)
          values[i] = (double)rounded[i];
      }
      TetcastFieldDesc desc = tetcast_field_desc_default();
      desc.values = (TetcastArray){is_double ? (void *)values : (void *)rounded,
                                   is_double ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32, count, 0};
      desc.association = (TetcastAssociation)association;
      TetcastField *field;
      TcRows *rows;
      assert_int_equal(tetcast_field_create(fixture.context, &desc, &field), TETCAST_OK);
      assert_int_equal(tc_rows_of_scalar(volume, field, &rows), TETCAST_OK);
      assert_int_equal(rows->is_double, is_double);
      assert_int_equal(rows->width, association == TETCAST_CORNER ? 4 : 1);
      check_sources(volume, &cube, rows, values);
      tc_rows_release(rows);
      tetcast_field_destroy(&field);
    }
  }
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  free(vertices), free(values), free(rounded);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Coordinates are scaled without loss, from the largest that there may be to where the scale itself is no number. */
static void any_unit_is_scaled_exactly(void **state) {
  (void)state;
  const int exponents[] = {996, 600, -500, -1022, -1070};
  for (size_t i = 0; i < sizeof exponents / sizeof *exponents; ++i) {
    Cube cube = cube_create(4, 0);
    for (int64_t j = 0; j < 3 * cube.vertex_count; ++j)
      cube.vertices[j] = ldexp(2 * cube.vertices[j] - 1, exponents[i]);
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
    TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
    TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
    tetcast_mesh_destroy(&mesh);
    assert_int_equal(volume->exponent, exponents[i] + 1);
    check_sources(volume, &cube, NULL, NULL);
    tetcast_volume_destroy(&volume);
    fixture_end(&fixture);
    cube_destroy(&cube);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cubes),
      cmocka_unit_test(damaged_meshes),
      cmocka_unit_test(many_cells_at_a_vertex),
      cmocka_unit_test(any_allocation_may_fail),
      cmocka_unit_test(progress_goes_up_and_can_stop_it),
      cmocka_unit_test(memory_is_bounded),
      cmocka_unit_test(volumes_are_ordered),
      cmocka_unit_test(values_find_their_places),
      cmocka_unit_test(any_unit_is_scaled_exactly),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
