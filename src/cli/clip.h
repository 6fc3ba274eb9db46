/* SPDX-License-Identifier: Apache-2.0 */
/* What --clip and --clip-box say. */
#ifndef TETCAST_CLI_CLIP_H
#define TETCAST_CLI_CLIP_H

#include "json.h"
#include "render_options.h"

/* The half-spaces of a scene file: a list of them, or a single one. NULL, or why the value can't be. */
const char *clip_add_all(RenderOptions *options, const json_t *json);

/* All half-spaces of both options, for free(); NULL: there are none. */
TetcastHalfSpace *clip_half_spaces(const RenderOptions *options, int *count);

/* Clips the scene as the options say. */
TetcastStatus clip_scene(TetcastScene *scene, const RenderOptions *options);

/* Puts the options into a scene file. */
void clip_write(const RenderOptions *options, json_t *scene);

#endif
