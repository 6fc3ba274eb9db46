/* SPDX-License-Identifier: Apache-2.0 */
/* world LIBRARY: a program that is not linked with MPI, and loads the library by name, as the command does. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tetcast/context.h>
#include <tetcast/mpi.h>

#define CHECK(good)                                                                                                    \
  do {                                                                                                                 \
    if (!(good)) {                                                                                                     \
      fprintf(stderr, "world: line %d: not so: %s\n", __LINE__, #good);                                                \
      abort();                                                                                                         \
    }                                                                                                                  \
  } while (0)

static void *find(void *library, const char *name) {
  void *function = dlsym(library, name);
  CHECK(function);
  return function;
}

int main(int argc, char **argv) {
  TetcastStatus (*create)(TetcastContext *, TetcastMpi **);
  TetcastStatus (*create_of)(TetcastContext *, int, TetcastMpi **);
  TetcastStatus (*sum)(TetcastMpi *, const double *, int64_t, int64_t, double *);
  int (*rank)(const TetcastMpi *), (*size)(const TetcastMpi *);
  void (*destroy)(TetcastMpi **);
  CHECK(argc == 2);
  void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (!library)
    fprintf(stderr, "%s\n", dlerror());
  CHECK(library);
  *(void **)&create = find(library, "tetcast_mpi_create_world");
  *(void **)&create_of = find(library, "tetcast_mpi_create");
  *(void **)&sum = find(library, "tetcast_mpi_sum");
  *(void **)&rank = find(library, "tetcast_mpi_rank");
  *(void **)&size = find(library, "tetcast_mpi_size");
  *(void **)&destroy = find(library, "tetcast_mpi_destroy");
  TetcastContext *context = NULL;
  TetcastMpi *mpi = NULL, *other = NULL;
  CHECK(tetcast_context_create(NULL, &context) == TETCAST_OK);
  CHECK(create_of(context, 0, &mpi) == TETCAST_ERROR_ARGUMENT && !mpi); /* MPI has not been started */
  CHECK(create(context, &mpi) == TETCAST_OK);
  CHECK(create(context, &other) == TETCAST_OK); /* which doesn't start MPI, and doesn't end it */
  CHECK(rank(mpi) >= 0 && rank(mpi) < size(mpi) && size(other) == size(mpi));
  destroy(&other);
  double one = 1, all = 0;
  CHECK(sum(mpi, &one, 1, 1, &all) == TETCAST_OK && all == size(mpi));
  destroy(&mpi);
  CHECK(!mpi);
  CHECK(create(context, &mpi) == TETCAST_ERROR_ARGUMENT && !mpi); /* MPI has been ended */
  tetcast_context_destroy(&context);
  return 0;
}
