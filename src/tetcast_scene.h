/* SPDX-License-Identifier: Apache-2.0 */
/* What the functions that render scenes check alike. */
#ifndef TC_TETCAST_SCENE_H
#define TC_TETCAST_SCENE_H

#include "render/render.h"

/* Whether the scene is complete, and can be rendered from this camera as the desc says into such a frame, of which the
 * size and the channels count. None of these may be NULL. */
TetcastStatus tc_check_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                              const TetcastFrame *frame);

#endif
