/* SPDX-License-Identifier: Apache-2.0 */
/* tetcast as the benchmark uses it; any failure ends the program. */
#ifndef BENCH_TET_H
#define BENCH_TET_H

#include <tetcast/tetcast.h>

#include "mesh.h"
#include "rows.h"
#include "scenes.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Tet {
  TetcastContext *context;
  TetcastMesh *mesh;
  TetcastField *field;
  TetcastVolume *volume;
  TetcastScene *scene;
} Tet;

/* A context and a view of the mesh's arrays, which must stay. */
void tet_open(Tet *tet, const BenchMesh *mesh, int threads);
void tet_close(Tet *tet);

/* From mesh and field to a scene that lacks its transfer function, replacing an earlier one; the time without the
 * freeing. */
Clock tet_prepare(Tet *tet);

/* Gives the scene a transfer function. */
Clock tet_transfer(Tet *tet, const Transfer *transfer);

/* Another frame for pictures of pixels², and a picture into it. */
TetcastFrame *tet_frame(Tet *tet, int pixels, TetcastType type, uint32_t channels);
Clock tet_render(Tet *tet, const TetcastCamera *camera, const TetcastRenderDesc *desc, TetcastFrame *frame,
                 TetcastRenderStats *stats); /* desc, stats: may be NULL */

#ifdef __cplusplus
}
#endif

#endif
