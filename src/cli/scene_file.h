/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_SCENE_FILE_H
#define TETCAST_CLI_SCENE_FILE_H

#include <stdbool.h>

#include <tetcast/camera.h>
#include <tetcast/transfer_function.h>

#include "render_options.h"

/* Sets what options->scene_object states, or if there is none, the file options->scene. False after a message. */
bool scene_file_read(RenderOptions *options);

/* What a file is that was given as a mesh, if it is a scene or a transfer function, and by which option it is to be
 * given, for free(); NULL: it is something else. */
char *scene_file_mistaken(const char *path);

/* Writes options->save_scene: everything that makes the picture again, bit for bit. transfer_function NULL: each step
 * of a series has one of its own, by the preset. `rows`: the file of one with rows, else NULL. `range`: that of the
 * preset where isosurfaces alone are seen; NULL: each step's own. False after a message. */
bool scene_file_write(const RenderOptions *options, const char *array, const TetcastCamera *camera,
                      const TetcastTransferFunction *transfer_function, const json_t *rows, const double range[2]);

/* A transfer function as its files and scene files have it, of one dimension. */
json_t *scene_file_transfer(const TetcastTransferFunction *transfer_function);

#endif
