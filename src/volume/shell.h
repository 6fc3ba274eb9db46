/* SPDX-License-Identifier: Apache-2.0 */
/* The shell: the faces at which rays enter and leave what can be seen. For a whole volume, it is the mesh's boundary.
 * Where a transfer function leaves parts invisible, it is the boundary of the visible clusters. Embree then takes rays
 * past what is empty, as in Avila, Sobierajski, Kaufman: Towards a comprehensive volume visualization system (PARC),
 * 1992. */
#ifndef TC_VOLUME_SHELL_H
#define TC_VOLUME_SHELL_H

#include <tetcast/isosurface.h>

#include "optics/transfer.h"
#include "volume/rows.h"

/* Makes the shell of the clusters that are visible through a transfer function or have some of the isosurfaces in them,
 * whose values ascend, and builds Embree's hierarchy over it. If nearly all is visible, or nothing would be gained,
 * *shell becomes the volume's own shell and owns nothing. */
TetcastStatus tc_shell_build(const TcRows *rows, const TcPieces *pieces, const TetcastIsosurface *isosurfaces,
                             int isosurface_count, TcShell *shell);
void tc_shell_clear(TcShell *shell);

#endif
