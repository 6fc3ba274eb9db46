/* SPDX-License-Identifier: Apache-2.0 */
/* The edges of the mesh's bounding box, drawn over a picture and behind it.
 *
 * The box is convex and the mesh lies in it. So nothing of the mesh is before an edge of a face that shows its outside,
 * and nothing behind any other edge: no depth needs to be compared, and what hides an edge, or is hidden by it, is
 * exactly what a ray would find. */
#ifndef TC_RENDER_OUTLINE_H
#define TC_RENDER_OUTLINE_H

#include "render/render.h"

/* Draws the outline into a picture of the volume from this camera whose rays stop at these distances (NULL: they
 * don't): into the frame, which has the rows from `first_row` on of a picture with `height`. */
void tc_outline_draw(const TetcastVolume *volume, const TcView *view, const TetcastArray *stop, const double color[3],
                     int64_t height, int64_t first_row, TetcastFrame *frame);

#endif
