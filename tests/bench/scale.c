/* SPDX-License-Identifier: Apache-2.0 */
/* scale N SIZE PARTITION PIECES THREADS [FRAMES]: how long a picture of SIZE² pixels of a cube of 6 N³ tetrahedra takes
 * on the ranks that run this, and what goes between them: of the fastest of FRAMES. PARTITION: boxes, wavy or scatter,
 * into so many PIECES, which ranks have in turn; THREADS for each rank. One line of numbers, whose names are printed by
 * `scale` without arguments.
 */
#define MOST_PIECES 4096
#include "../mpi/pieces.h"

#include <sys/resource.h>

static const char *const names[SPLITS] = {"boxes", "wavy", "scatter"};

/* Peak memory of this process in bytes. */
static double peak_memory(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return 1024. * (double)usage.ru_maxrss;
}

static int by_time(const void *a, const void *b) {
  const double x = ((const double *)a)[0], y = ((const double *)b)[0];
  return (x > y) - (x < y);
}

/* What the volumes of this rank's pieces need. */
static double volume_memory(const Pieces *pieces) {
  double bytes = 0;
  for (int i = 0; i < pieces->count; ++i) {
    TetcastVolumeInfo info;
    tetcast_volume_info(pieces->part[i].volume, &info);
    bytes += (double)info.bytes;
  }
  return bytes;
}

/* The share of the pixels that see the mesh. */
static double seen_of(const TetcastFrame *frame, int64_t pixels) {
  const double *rgba = tetcast_frame_pixels(frame);
  int64_t seen = 0;
  for (int64_t i = 0; i < pixels; ++i)
    seen += rgba[4 * i + 3] > 0;
  return (double)seen;
}

typedef struct Run {
  int n, pieces, threads, frames;
  int64_t size;
  Split split;
} Run;

static void report(const Run *run, const Ranks *ranks, const TetcastFrame *frame, const double best[6],
                   const TetcastMpiStats *stats, const double memory[2]) {
  const double seen = seen_of(frame, run->size * run->size);
  printf("%s %d %d %d %lld %lld %.4f %lld %lld %lld %lld %.0f %.0f %.4f %.4f %.4f %.4f %.4f %.4f %lld %.1e\n",
         names[run->split], ranks->size, run->threads, run->pieces, (long long)(6 * (int64_t)run->n * run->n * run->n),
         (long long)run->size, (double)stats->fragments / seen, (long long)stats->bytes, (long long)stats->most_bytes,
         (long long)stats->memory, (long long)stats->bands, memory[0], memory[1], best[0], best[1], best[2], best[3],
         best[4], best[5], (long long)stats->lost, stats->overlap);
}

static int measure(const Run *run) {
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  TetcastContext *context = ranks.fixture.context;
  assert_int_equal(tetcast_context_set_threads(context, run->threads), TETCAST_OK);
  Cube cube = cube_create(run->n, 0.4);
  static Pieces pieces;
  pieces = pieces_of(context, &cube, run->split, run->pieces, DEAL_IN_TURN, ranks.rank, ranks.size);
  cube_destroy(&cube);
  TetcastTransferFunction *transfer = transfer_of(context, 0.1);
  pieces_set_transfer(&pieces, transfer);
  tetcast_transfer_function_destroy(&transfer);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrame *frame = frame_at_root(&ranks, run->size, run->size, TETCAST_TYPE_FLOAT64);
  double(*times)[6] = calloc((size_t)run->frames, sizeof *times);
  TetcastMpiStats stats;
  for (int i = -1; i < run->frames; ++i) { /* the first one allocates, and learns how much memory a pixel needs */
    MPI_Barrier(MPI_COMM_WORLD);
    const double begin = MPI_Wtime();
    if (tetcast_mpi_render(ranks.mpi, scenes_of(&pieces), pieces.count, &camera, NULL, frame, &stats) != TETCAST_OK)
      return 1;
    if (i >= 0)
      memcpy(times[i],
             &(double[6]){MPI_Wtime() - begin, stats.render_seconds, stats.wait_seconds, stats.exchange_seconds,
                          stats.composite_seconds, stats.gather_seconds},
             sizeof *times);
  }
  qsort(times, (size_t)run->frames, sizeof *times, by_time);
  const double memory[2] = {peak_memory(), volume_memory(&pieces)};
  double most[2];
  MPI_Reduce(memory, most, 2, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  if (ranks.rank == 0)
    report(run, &ranks, frame, times[0], &stats, most);
  free(times);
  tetcast_frame_destroy(&frame);
  pieces_end(&pieces);
  ranks_end(&ranks);
  return 0;
}

int main(int argc, char **argv) {
  if (argc < 6) {
    puts("partition ranks threads pieces cells size fragments_per_ray bytes most_bytes memory bands peak_bytes "
         "volume_bytes "
         "frame_s render_s wait_s exchange_s composite_s gather_s lost overlap");
    return argc > 1;
  }
  int level;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  Run run = {.n = atoi(argv[1]),
             .size = atoi(argv[2]),
             .pieces = atoi(argv[4]),
             .threads = atoi(argv[5]),
             .frames = argc > 6 ? atoi(argv[6]) : 5};
  while (run.split < SPLITS && strcmp(names[run.split], argv[3]) != 0)
    ++run.split;
  if (run.split == SPLITS || run.pieces < 1 || run.pieces > MOST_PIECES || run.n < 1 || run.frames < 1) {
    fputs("scale: see the first lines of its source\n", stderr);
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  const int failed = measure(&run);
  MPI_Finalize();
  return failed;
}
