/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a picture shows anything of what is in the mesh, and if not, why. */
#ifndef TETCAST_CLI_SIGHT_H
#define TETCAST_CLI_SIGHT_H

#include "picture.h"

/* Looks at the picture that has been rendered. NULL: something can be seen, and not only the outermost layer of a wall.
 * Else one sentence about why not, for free(). That costs a look at pixels, as a rule at a few; only where they show
 * nothing, or nothing but opaque ones, the cause is found by small pictures of the same scene. */
char *sight_fault(const Run *run);

#endif
