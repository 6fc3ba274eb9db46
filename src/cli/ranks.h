/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures over the processes of mpirun, --mpi. Each process, a rank, runs the same command line through the same
 * steps, with parts of the mesh: pieces of a file in pieces, or parts that a file is split into. Rank 0 alone speaks
 * for all, designs, and writes.
 *
 * A step that may fail on one rank ends with ranks_agree(), so that all go on or none does. What is said of the stage
 * without ranks is what happens where there is no --mpi, so that callers need not ask. */
#ifndef TETCAST_CLI_RANKS_H
#define TETCAST_CLI_RANKS_H

#include <jansson.h>

#include "render_options.h"
#include "stage.h"

/* Before options are looked at: if --mpi is among the words, messages that all ranks have are those of rank 0, as far
 * as the environment tells which rank this is. */
void ranks_foresee(int argc, char **argv);

/* Whether it is among them. */
bool ranks_foreseen(void);

/* Where a rank has failed before MPI was started: the first one that has gone makes mpirun end the others, which may
 * have to say what is wrong yet, or have hardly begun. So they wait for each other. */
void ranks_wait(Stage *stage);

/* How many threads a rank has where nothing is said: its share of the machine. */
int ranks_threads(void);

/* How many processes the program has, as the environment tells that mpirun makes; 1 where it says nothing. */
int ranks_started(void);

/* Warns where several processes of an MPI program do the same, as --mpi was forgotten. */
void ranks_warn(void);

/* Starts MPI, if --mpi is given. `code` is what came before: its agreed value is returned. */
int ranks_begin(Stage *stage, const RenderOptions *options, int code);

/* The same for the processes of a program that has started MPI: those of a communicator, as MPI_Comm_c2f() has it. An
 * exit code. What follows is for such a program alone, which makes one picture after the other. */
int ranks_join(Stage *stage, int communicator);
int ranks_size(const Stage *stage);

/* Rank 0's number becomes that of all. An exit code. */
int ranks_share_number(const Stage *stage, int64_t *number);

/* After a picture: what has been read and prepared is freed, but for the volume of the first part, which serves the
 * next step if that has the same mesh. Without ranks: nothing. */
void ranks_drop(Stage *stage);

/* Ends MPI and frees the parts. Without ranks: nothing. */
void ranks_end(Stage *stage);

/* The exit code that all ranks have from here on: the largest, or that of an interruption. Where no rank has said why,
 * rank 0 does. Without ranks: `code`. */
int ranks_agree(const Stage *stage, int code);

/* Whether this rank is the one that speaks and writes. Without ranks: true. */
bool ranks_first(const Stage *stage);

/* stage_read() and stage_prepare(), or the same for this rank's parts, and the whole's numbers in the stage.
 * stage->scene is then one of a single cell, which has the bounds of the whole, for what is drawn round it. */
int ranks_read(Stage *stage, const RenderOptions *options);
int ranks_prepare(Stage *stage, const RenderOptions *options);

/* tetcast_scene_groups(), or that of the parts of all ranks. */
int ranks_groups(const Stage *stage);

/* tetcast_scene_render(), or that over all ranks into rank 0's frame. */
TetcastStatus ranks_render(const Stage *stage, const TetcastRenderDesc *desc, TetcastFrame *frame,
                           TetcastRenderStats *stats);

/* Of the last picture, for the statistics; called by all ranks. NULL without ranks. */
json_t *ranks_stats(const Stage *stage);

#endif
