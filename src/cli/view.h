/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_VIEW_H
#define TETCAST_CLI_VIEW_H

#include <tetcast/camera.h>

#include "render_options.h"

/* What is wrong with a camera that is wholly given, NULL: nothing. */
const char *view_fault(const RenderOptions *options);

/* The camera of the options, what they leave open completed so that all within `bounds` is seen: along -z, or along +y
 * or -x where the bounds are too flat to be seen along -z. False after a message. */
/* Why the camera is where view_complete() puts it, in words. */
const char *view_reason(const RenderOptions *options, const double bounds[6]);

bool view_complete(const RenderOptions *options, const double bounds[6], TetcastCamera *camera);

#endif
