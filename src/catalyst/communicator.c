/* SPDX-License-Identifier: Apache-2.0 */
#include "communicator.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* The same under all kinds of MPI: communicators are pointers (Open MPI) or numbers (MPICH), which pass for pointers.
 */
typedef void *FromFortran(int communicator);
typedef int SizeOf(void *communicator, int *size);

static int64_t size_by_mpi(int64_t handle) {
  void *from_fortran = dlsym(RTLD_DEFAULT, "MPI_Comm_f2c"), *size_of = dlsym(RTLD_DEFAULT, "MPI_Comm_size");
  FromFortran *convert = NULL;
  SizeOf *measure = NULL;
  void *communicator = NULL;
  int size = 0;
  if (!size_of)
    return 0;
  memcpy(&convert, &from_fortran, sizeof convert);
  memcpy(&measure, &size_of, sizeof measure);
  if (convert)
    communicator = convert((int)handle);
  else
    memcpy(&communicator, &handle, sizeof communicator);
  return measure(communicator, &size) == 0 ? size : 0;
}

static int64_t size_by_environment(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_SIZE", NULL};
  double size;
  for (int i = 0; names[i]; i++)
    if (getenv(names[i]) && cli_parse_number(getenv(names[i]), &size) && size >= 1 && size < 1e9)
      return (int64_t)size;
  return 1;
}

int64_t communicator_size(const ConduitNode *node) {
  int64_t handle;
  const int64_t size = conduit_integer(node, &handle) ? size_by_mpi(handle) : 0;
  return size > 0 ? size : size_by_environment();
}
