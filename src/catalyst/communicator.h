/* SPDX-License-Identifier: Apache-2.0 */
/* The MPI that the simulation may have, without its headers. */
#ifndef TETCAST_CATALYST_COMMUNICATOR_H
#define TETCAST_CATALYST_COMMUNICATOR_H

#include "conduit.h"

/* How many processes the simulation has: of the communicator that the node names as MPI_Comm_c2f() does (NULL: none
 * does), else as the environment that mpirun leaves says. 1 where neither tells. */
int64_t communicator_size(const ConduitNode *node);

#endif
