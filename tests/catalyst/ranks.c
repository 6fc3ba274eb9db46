/* SPDX-License-Identifier: Apache-2.0 */
/* ranks NAME: a simulation of several processes, which hold three parts of a mesh between them, the last ones perhaps
 * none; pictures are NAME.##.ppm. In its second step the mesh of one process is broken, in its fourth all have moved.
 */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "body.h"

enum { PARTS = 3, STEPS = 5 };

static void describe(const Body *body, int part, conduit_node *data) {
  char name[16];
  snprintf(name, sizeof name, "part%d", part);
  body_describe(body, NULL, conduit_node_fetch(data, name));
}

/* The meshes of this process at a step. */
static conduit_node *step_of(Body *const bodies[PARTS], int step, int rank, int size) {
  conduit_node *params = conduit_node_create();
  conduit_node_set_path_int64(params, "catalyst/state/timestep", step);
  conduit_node_set_path_char8_str(params, "catalyst/channels/grid/type", "multimesh");
  conduit_node *data = conduit_node_fetch(params, "catalyst/channels/grid/data");
  for (int p = 0; p < PARTS; p++) {
    if (p % size != rank)
      continue;
    describe(bodies[p], p, data);
    if (step == 1 && p == 1)
      conduit_node_set_path_char8_str(data, "part1/topologies/mesh/elements/shape", "blob");
  }
  return params;
}

int main(int argc, char **argv) {
  static const int n[3] = {4, 3, 3};
  static const double places[PARTS][3] = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
  static const BodyKind kinds[PARTS] = {BODY_TET, BODY_HEX, BODY_POLYHEDRA};
  int rank, size, provided, wrong = argc < 2;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  Body *bodies[PARTS];
  for (int p = 0; p < PARTS; p++)
    bodies[p] = body_create(kinds[p], n, places[p], 0.2);
  char output[64];
  snprintf(output, sizeof output, "%s.##.ppm", argc > 1 ? argv[1] : "ranks");
  conduit_node *params = conduit_node_create();
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/output", output);
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/scene", "{\"size\": [96, 72], \"quiet\": true}");
  conduit_node_set_path_int64(params, "catalyst/mpi_comm", MPI_Comm_c2f(MPI_COMM_WORLD));
  conduit_node *broken = conduit_node_create(); /* what one of them can't use none of them does */
  conduit_node_set_path_char8_str(broken, "catalyst/tetcast/scene", rank == size - 1 ? "{\"size\": " : "{}");
  conduit_node_set_path_int64(broken, "catalyst/mpi_comm", MPI_Comm_c2f(MPI_COMM_WORLD));
  wrong += catalyst_initialize(broken) == 0;
  wrong += catalyst_finalize(broken) != 0;
  conduit_node_destroy(broken);
  wrong += catalyst_initialize(params) != 0;
  conduit_node_destroy(params);
  for (int step = 0; step < STEPS && !wrong; step++) {
    for (int p = 0; p < PARTS; p++) {
      for (int64_t i = 0; i < bodies[p]->points; i++)
        bodies[p]->t[i] += 0.1 * bodies[p]->x[3 * i];
      for (int64_t i = 0; i < 3 * bodies[p]->points && step == 3; i++)
        bodies[p]->x[i] += i % 3 ? 0 : 0.5;
    }
    params = step_of(bodies, step, rank, size);
    const int code = catalyst_execute(params);
    conduit_node_destroy(params);
    body_forget();
    if ((code != 0) != (step == 1)) { /* the same in all processes */
      fprintf(stderr, "rank %d of %d: step %d: status %d\n", rank, size, step, code);
      wrong++;
    }
  }
  params = conduit_node_create();
  wrong += catalyst_finalize(params) != 0;
  conduit_node_destroy(params);
  for (int p = 0; p < PARTS; p++)
    body_destroy(bodies[p]);
  MPI_Finalize();
  return wrong != 0;
}
