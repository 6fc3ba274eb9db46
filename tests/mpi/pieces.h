/* SPDX-License-Identifier: Apache-2.0 */
/* What tests on several ranks share: the ranks, and pieces of a mesh that are dealt out to them. All ranks make the
 * same whole mesh and run the same test; each keeps the scenes of its own pieces. A test that fails on one rank ends
 * the program (CMOCKA_TEST_ABORT), and mpirun the others. */
#ifndef PIECES_H
#define PIECES_H

#include <mpi.h>

#include <tetcast/mpi.h>

#include "../unit/partition.h"

/* How cells are dealt out to pieces: to boxes, to cells of a Voronoi diagram with wavy faces, at random; as a solver
 * does it, as a graph partitioner does it, and as bad as can be. */
typedef enum Split { SPLIT_BOXES, SPLIT_WAVY, SPLIT_SCATTER, SPLITS } Split;

/* How pieces are dealt out to ranks: in turn, to the last rank, or to the first ones. */
typedef enum Deal { DEAL_IN_TURN, DEAL_LAST, DEAL_FIRST, DEALS } Deal;

#ifndef MOST_PIECES
#define MOST_PIECES 40
#endif

typedef struct Pieces {
  int count; /* of this rank */
  Part part[MOST_PIECES];
  TetcastScene *scenes[MOST_PIECES];
} Pieces;

static inline void middle_of(const Cube *cube, int64_t cell, double at[3]) {
  for (int k = 0; k < 3; ++k) {
    at[k] = 0;
    for (int j = 0; j < 4; ++j)
      at[k] += 0.25 * cube->vertices[3 * cube->cells[4 * cell + j] + k];
  }
}

/* Halves the box along its axes in turn. */
static inline int box_of(const double at[3], int count) {
  double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  int first = 0;
  for (int axis = 0; count > 1; axis = (axis + 1) % 3) {
    const int half = count / 2;
    const double cut = low[axis] + (high[axis] - low[axis]) * half / count;
    if (at[axis] < cut) {
      high[axis] = cut;
      count = half;
    } else {
      low[axis] = cut;
      first += half;
      count -= half;
    }
  }
  return first;
}

static inline int wavy_of(const double at[3], int count) {
  uint64_t seed = 99;
  double nearest = INFINITY;
  int found = 0;
  for (int i = 0; i < count; ++i) {
    double distance = 0;
    for (int k = 0; k < 3; ++k)
      distance += pow(at[k] + 0.05 * sin(15 * at[(k + 1) % 3]) - uniform(&seed), 2);
    if (distance < nearest)
      nearest = distance, found = i;
  }
  return found;
}

/* [cell_count], to be freed: the piece of each cell. */
static inline int *split_cells(const Cube *cube, Split split, int count) {
  int *owner = malloc((size_t)cube->cell_count * sizeof *owner);
  uint64_t seed = 5;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    double at[3];
    middle_of(cube, i, at);
    owner[i] = split == SPLIT_BOXES  ? box_of(at, count)
               : split == SPLIT_WAVY ? wavy_of(at, count)
                                     : (int)(count * uniform(&seed));
  }
  return owner;
}

static inline bool has_piece(int piece, int pieces, Deal deal, int rank, int ranks) {
  (void)pieces;
  return rank == (deal == DEAL_IN_TURN ? piece % ranks : deal == DEAL_LAST ? ranks - 1 : piece % ((ranks + 1) / 2));
}

/* Makes a piece, or none if it has no cells. */
typedef Part PieceMaker(TetcastContext *context, const Cube *cube, const int *owner, int which, const void *of,
                        uint64_t *seed);

/* The pieces of this rank, each made by `make` of `of`; those without cells are left out. */
static inline Pieces pieces_made(TetcastContext *context, const Cube *cube, Split split, int count, Deal deal, int rank,
                                 int ranks, PieceMaker *make, const void *of) {
  Pieces pieces = {.count = 0};
  int *owner = split_cells(cube, split, count);
  for (int i = 0; i < count; ++i) {
    uint64_t seed = 17 + (uint64_t)i;
    if (!has_piece(i, count, deal, rank, ranks))
      continue;
    const Part part = make(context, cube, owner, i, of, &seed);
    if (!part.scene)
      continue;
    pieces.part[pieces.count] = part;
    pieces.scenes[pieces.count++] = part.scene;
  }
  free(owner);
  return pieces;
}

static inline Part plain_part(TetcastContext *context, const Cube *cube, const int *owner, int which, const void *of,
                              uint64_t *seed) {
  (void)of;
  return part_of(context, cube, owner, which, seed);
}

static inline Pieces pieces_of(TetcastContext *context, const Cube *cube, Split split, int count, Deal deal, int rank,
                               int ranks) {
  return pieces_made(context, cube, split, count, deal, rank, ranks, plain_part, NULL);
}

static inline void pieces_set_transfer(Pieces *pieces, const TetcastTransferFunction *transfer) {
  for (int i = 0; i < pieces->count; ++i)
    assert_int_equal(tetcast_scene_set_transfer_function(pieces->scenes[i], transfer), TETCAST_OK);
}

static inline const TetcastScene *const *scenes_of(const Pieces *pieces) {
  return (const TetcastScene *const *)pieces->scenes;
}

static inline void pieces_end(Pieces *pieces) {
  for (int i = 0; i < pieces->count; ++i)
    part_end(&pieces->part[i]);
  pieces->count = 0;
}

/* The cube without the cells in two balls, which make it hollow and dent it: rays enter it several times. */
static inline Cube hollow_create(int n) {
  Cube cube = cube_create(n, 0.5);
  int64_t kept = 0;
  for (int64_t i = 0; i < cube.cell_count; ++i) {
    double at[3];
    middle_of(&cube, i, at);
    const double inner = hypot(hypot(at[0] - 0.5, at[1] - 0.45), at[2] - 0.55),
                 outer = hypot(hypot(at[0] - 1, at[1] - 0.6), at[2] - 0.4);
    if (inner > 0.25 && outer > 0.3)
      memmove(cube.cells + 4 * kept++, cube.cells + 4 * i, 4 * sizeof *cube.cells);
  }
  cube.cell_count = kept;
  return cube;
}

/* ── ranks ── */

typedef struct Ranks {
  Fixture fixture;
  TetcastMpi *mpi;
  int rank, size;
} Ranks;

/* The first `count` ranks of the program. On the others `mpi` is NULL, and there is nothing to do. */
static inline void ranks_begin(Ranks *ranks, int count) {
  MPI_Comm comm;
  int world;
  MPI_Comm_rank(MPI_COMM_WORLD, &world);
  MPI_Comm_split(MPI_COMM_WORLD, world < count ? 0 : MPI_UNDEFINED, world, &comm);
  assert_int_equal(fixture_begin(&ranks->fixture, 2, 0), TETCAST_OK);
  ranks->mpi = NULL;
  ranks->rank = world;
  ranks->size = count;
  if (world < count) {
    assert_int_equal(tetcast_mpi_create(ranks->fixture.context, MPI_Comm_c2f(comm), &ranks->mpi), TETCAST_OK);
    MPI_Comm_free(&comm); /* it has a duplicate */
    assert_int_equal(tetcast_mpi_rank(ranks->mpi), world);
    assert_int_equal(tetcast_mpi_size(ranks->mpi), count);
  }
}

static inline void ranks_end(Ranks *ranks) {
  tetcast_mpi_destroy(&ranks->mpi);
  fixture_end(&ranks->fixture);
  MPI_Barrier(MPI_COMM_WORLD);
}

static inline int world_size(void) {
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/* With AddressSanitizer, leaks are looked for before MPI ends, and what MPI itself doesn't give back is left out. */
#if defined(__SANITIZE_ADDRESS__)
int __lsan_do_recoverable_leak_check(void);
void __lsan_disable(void);
void __lsan_enable(void);
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
  return "leak:libmpi\nleak:libopen-pal\nleak:libopen-rte\nleak:libpmix\nleak:libhwloc\n";
}
#else
#define __lsan_do_recoverable_leak_check() 0
#define __lsan_disable()                   (void)0
#define __lsan_enable()                    (void)0
#endif

/* Runs tests with MPI. */
#define RUN_WITH_MPI(tests)                                                                                            \
  int level, failed;                                                                                                   \
  __lsan_disable();                                                                                                    \
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);                                                          \
  __lsan_enable();                                                                                                     \
  failed = cmocka_run_group_tests(tests, NULL, NULL);                                                                  \
  failed += __lsan_do_recoverable_leak_check();                                                                        \
  MPI_Finalize();                                                                                                      \
  return failed

/* A frame at rank 0, NULL elsewhere. */
static inline TetcastFrame *frame_at_root(const Ranks *ranks, int64_t width, int64_t height, TetcastType type) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.type = type;
  TetcastFrame *frame = NULL;
  if (ranks->rank == 0)
    assert_int_equal(tetcast_frame_create(ranks->fixture.context, &desc, &frame), TETCAST_OK);
  return frame;
}

#endif
