/* SPDX-License-Identifier: Apache-2.0 */
/* The shell: the faces at which rays enter and leave what can be seen. Of a whole volume, it is the mesh's boundary;
 * where a transfer function leaves parts invisible, that of the clusters that are not. Rays then pass what is empty in
 * Embree, as in Avila, Sobierajski, Kaufman: Towards a comprehensive volume visualization system (PARC), 1992. */
#ifndef TC_VOLUME_SHELL_H
#define TC_VOLUME_SHELL_H

#include <tetcast/isosurface.h>

#include "optics/transfer.h"
#include "volume/rows.h"

/* The faces between clusters that are visible through a transfer function, or have isosurfaces in them, and what is
 * not, with Embree over them. When
 * (nearly) all is visible, or nothing would be gained, *shell is the volume's own and owns nothing. */
TetcastStatus tc_shell_build(const TcRows *rows, const TcPieces *pieces, const TetcastIsosurface *isosurfaces,
                             int isosurface_count, TcShell *shell);
void tc_shell_clear(TcShell *shell);

#endif
