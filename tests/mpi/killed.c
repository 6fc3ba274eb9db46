/* SPDX-License-Identifier: Apache-2.0 */
/* killed RANK: this rank is killed in the middle of a picture; the others go on, and are ended by mpirun. */
#include <signal.h>
#include <unistd.h>

#include "pieces.h"

static bool die(void *user, double fraction) {
  if (*(bool *)user && fraction > 0.2)
    raise(SIGKILL);
  return true;
}

int main(int argc, char **argv) {
  int level;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  Ranks ranks;
  ranks_begin(&ranks, world_size());
  bool dies = argc > 1 && ranks.rank == atoi(argv[1]);
  Cube cube = cube_create(5, 0.5);
  Pieces pieces = pieces_of(ranks.fixture.context, &cube, SPLIT_WAVY, 6, DEAL_IN_TURN, ranks.rank, ranks.size);
  TetcastTransferFunction *transfer = transfer_of(ranks.fixture.context, 0.3);
  pieces_set_transfer(&pieces, transfer);
  TetcastFrame *frame = frame_at_root(&ranks, 200, 200, TETCAST_TYPE_FLOAT64);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.progress = (TetcastProgress){die, &dies};
  puts("a picture is begun");
  fflush(stdout);
  tetcast_mpi_render(ranks.mpi, scenes_of(&pieces), pieces.count, &camera, &desc, frame, NULL);
  puts("a picture was made");
  MPI_Finalize();
  return 0;
}
