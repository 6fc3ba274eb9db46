/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_RENDER_CAST_H
#define TC_RENDER_CAST_H

#include <tetcast/cast.h>

/* The rays have been checked (rays.h), and the scene is one that has what is asked for. */
TetcastStatus tc_scene_cast(const TetcastScene *scene, const TetcastRays *rays, const TetcastCastDesc *desc,
                            const TetcastCastResult *result, TetcastRenderStats *stats);

TetcastStatus tc_volume_trace(const TetcastVolume *volume, const TetcastRays *rays, const TetcastTraceDesc *desc,
                              TetcastTraceFunction *function, void *user);

#endif
