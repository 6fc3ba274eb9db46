/* SPDX-License-Identifier: Apache-2.0 */
/* The shell: the faces at which rays enter and leave what can be seen. For a whole volume, it is the mesh's boundary.
 * Where a transfer function leaves parts invisible, or a clip cuts some off, it is the boundary of the visible clusters
 * or cells. Embree then takes rays past what is empty, as in Avila, Sobierajski, Kaufman: Towards a comprehensive
 * volume visualization system (PARC), 1992. */
#ifndef TC_VOLUME_SHELL_H
#define TC_VOLUME_SHELL_H

#include <tetcast/isosurface.h>

#include "optics/transfer.h"
#include "volume/clip.h"
#include "volume/rows.h"

/* What a shell is made for. */
typedef struct TcShellOf {
  const TetcastVolume *volume;
  const TcRows *rows;                   /* a field's values; NULL: all is visible that the clip leaves */
  const TcPieces *pieces;               /* the transfer function, with `rows` */
  const TetcastIsosurface *isosurfaces; /* [isosurface_count], with `rows`; their values ascend */
  int isosurface_count;
  const TcHalfSpace *clip; /* [clip_count] */
  int clip_count;
} TcShellOf;

/* Makes the shell of those clusters that are visible through the transfer function or have some of the isosurfaces in
 * them, without the cells that lie outside of the clip, and builds Embree's hierarchy over it. If nearly all is
 * visible, or nothing would be gained, *shell becomes the volume's own shell and owns nothing. */
TetcastStatus tc_shell_build(const TcShellOf *of, TcShell *shell);
void tc_shell_clear(TcShell *shell);

#endif
