/* SPDX-License-Identifier: Apache-2.0 */
/* A simulation that speaks Catalyst, and the command beside it. */
#ifndef SIMULATION_H
#define SIMULATION_H

#include <stdarg.h>
#include <stddef.h>

#include <setjmp.h>

#include <cmocka.h>

#include "body.h"

/* What the last call has said on standard error, without notes. */
extern char said[65536];

/* A folder of its own to work in, which is the current one from here on, and that folder removed. */
int simulation_enter(void **state);
int simulation_leave(void **state);

/* catalyst_initialize() with a scene (NULL: none) and a name for pictures; its code. */
int simulation_begin(const char *scene, const char *output);

/* The node of initialize, for simulation_begin_with(), which frees it. */
conduit_node *simulation_params(const char *scene, const char *output);
int simulation_begin_with(conduit_node *params);

/* The node of a step with the number; simulation_mesh() is the mesh of channel grid in it. */
conduit_node *simulation_step(int64_t number);
conduit_node *simulation_mesh(conduit_node *step);

/* catalyst_execute(); its code. Frees the node, and what bodies keep. */
int simulation_run(conduit_node *step);
int simulation_end(void);

/* One step of a mesh with a scene, as picture.0000.exr; nothing may go wrong, and nothing is said but `words`, NULL: at
 * all. `mesh` NULL: the body as it is described by default. */
void simulation_draw(const char *scene, conduit_node *step, const char *words);

/* Runs the command: `tetcast render INPUT --scene … -o OUTPUT`. */
void simulation_render(const char *input, const char *scene, const char *output);

/* Fails unless both files are the same, and hold something. */
void simulation_compare(const char *one, const char *other);

/* The body as a file and in memory give the same picture. The step is used up. */
void simulation_agree(const Body *body, conduit_node *step, const char *scene, const char *words);

#endif
