/* SPDX-License-Identifier: Apache-2.0 */
#include "communicator.h"

#include <dlfcn.h>
#include <string.h>

#include "cli/ranks.h"

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

int64_t communicator_size(const ConduitNode *node) {
  int64_t handle;
  const int64_t size = conduit_integer(node, &handle) ? size_by_mpi(handle) : 0;
  return size > 0 ? size : ranks_started();
}
