/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of a mesh whose parts are on the processes of an MPI program: target tetcast::mpi, library libtetcast-mpi.
 *
 * Each process, here a rank, has some scenes, or none: parts of the mesh of any shape, each cell in one of them only,
 * their volumes made with the same TetcastVolumeDesc.bounds (tetcast_mpi_bounds() finds them). What rays have in the
 * parts goes to those ranks that composite it (fragments.h), pixels go to rank 0: the picture is that of the whole mesh
 * up to rounding, and has the same bits however the parts are shared out among ranks, and however many ranks there are.
 *
 * This header needs no MPI's: a communicator is passed as MPI_Comm_c2f() has it, which is what Fortran has. MPI must
 * have been started with MPI_THREAD_FUNNELED or more, as tetcast computes on threads of its own; only the thread that
 * makes a call here calls MPI. Ranks must run the same version of this library, on processors with the same
 * representation of numbers.
 *
 * What is called collective must be called by all ranks of the communicator, in the same order. It succeeds in all of
 * them or in none: if it fails in one, because of its arguments, its data or its memory, all return an error, those
 * that have none of their own with a message that names the lowest rank that has. Only if MPI itself fails, which most
 * programs don't survive, is that not promised; then the status is TETCAST_ERROR_IO, and MPI's message is given. If a
 * rank dies, it is for MPI to end the others, as mpirun does. */
#ifndef TETCAST_MPI_H
#define TETCAST_MPI_H

#include <stdint.h>

#include <tetcast/camera.h>
#include <tetcast/context.h>
#include <tetcast/frame.h>
#include <tetcast/scene.h>
#include <tetcast/statistics.h>
#include <tetcast/status.h>
#include <tetcast/transfer_function.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The ranks that work together, and memory that is kept from picture to picture. One call at a time. */
typedef struct TetcastMpi TetcastMpi;

/* Collective. Makes it for the ranks of a communicator, MPI_Comm_c2f(comm) or a Fortran program's communicator, which
 * is duplicated: messages don't get into those of the program. It must be an intracommunicator. MPI must have been
 * started (TETCAST_ERROR_ARGUMENT). */
TETCAST_API TetcastStatus tetcast_mpi_create(TetcastContext *context, int communicator, TetcastMpi **mpi);

/* Collective. Makes it for all ranks of the program. If MPI has not been started yet, this call starts it, and
 * tetcast_mpi_destroy() ends it: for programs that are not linked with MPI themselves. An MPI that has been ended is
 * TETCAST_ERROR_ARGUMENT. */
TETCAST_API TetcastStatus tetcast_mpi_create_world(TetcastContext *context, TetcastMpi **mpi);

/* Collective. Frees it and sets *mpi to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_mpi_destroy(TetcastMpi **mpi);

/* The number of this rank, in [0, tetcast_mpi_size()). */
TETCAST_API int tetcast_mpi_rank(const TetcastMpi *mpi);

/* The number of ranks. */
TETCAST_API int tetcast_mpi_size(const TetcastMpi *mpi);

/* Sets about how many bytes tetcast_mpi_render() may need on a rank for what it renders, sends, receives and collects,
 * at least 1; the smallest number of all ranks holds. Default: 268435456, 256 MiB. Pictures are made in bands of so
 * many rows as fit, by what the last picture from there has needed, or a small one that is rendered first; a band that
 * turns out not to fit is made anew in smaller ones, down to 16 rows. Pictures have the same bits whatever it is.
 * Smaller bands take longer, as vertices are projected for each. */
TETCAST_API TetcastStatus tetcast_mpi_set_memory(TetcastMpi *mpi, int64_t bytes);

/* Collective. Makes what happened to one rank known to all: returns TETCAST_OK if all ranks pass it; else all return
 * the status of the lowest rank that passes another one. Ranks that pass TETCAST_OK get a message then, which names
 * that rank. */
TETCAST_API TetcastStatus tetcast_mpi_agree(TetcastMpi *mpi, TetcastStatus own);

/* Collective. Replaces a rank's bounds, xmin, xmax, ymin, ymax, zmin, zmax, by those of all ranks. A rank that has
 * nothing passes a minimum above its maximum along some axis; if none has anything, all get ∞, −∞ three times. NaN is
 * TETCAST_ERROR_ARGUMENT. */
TETCAST_API TetcastStatus tetcast_mpi_bounds(TetcastMpi *mpi, double bounds[6]);

/* Collective. Replaces a rank's range, minimum and maximum, by that of all ranks. A rank that has no values passes a
 * minimum above the maximum, or NaN; if none has values, all get ∞, −∞. */
TETCAST_API TetcastStatus tetcast_mpi_range(TetcastMpi *mpi, double range[2]);

/* Collective. Adds up values [parts][count] of all parts of all ranks to sums [count], which all ranks get, with the
 * same bits however parts are shared out and in whatever order they come. `parts` may be 0 and `values` NULL then;
 * `count` ≥ 0 must be the same for all ranks (TETCAST_ERROR_ARGUMENT). Sums are those of the exact sum, but for one
 * rounding, and for what is below 2^−120 of the largest of the values that are added up. Sums of infinities and NaN are
 * as by addition. At most 2^22 parts in all (TETCAST_ERROR_LIMIT). */
TETCAST_API TetcastStatus tetcast_mpi_sum(TetcastMpi *mpi, const double *values, int64_t parts, int64_t count,
                                          double *sums);

/* Collective. Adds up the statistics of all parts of all ranks, parts [count], to those of the whole, with the same
 * bits however parts are shared out. They must have been made with the same ranges, stated and not left to be found,
 * and the same numbers of bins (TETCAST_ERROR_ARGUMENT). A rank may have none: count is 0 and `parts` may be NULL then;
 * at least one must have some (TETCAST_ERROR_ARGUMENT). All ranks get the result, each destroys its own by
 * tetcast_statistics_destroy(). */
TETCAST_API TetcastStatus tetcast_mpi_statistics(TetcastMpi *mpi, const TetcastStatistics *const *parts, int64_t count,
                                                 TetcastStatistics **whole);

/* Collective. Sends `bytes` ≥ 0 bytes of rank `root` to all others. Both numbers must be the same for all
 * (TETCAST_ERROR_ARGUMENT). */
TETCAST_API TetcastStatus tetcast_mpi_broadcast(TetcastMpi *mpi, int root, void *data, int64_t bytes);

/* Sends `bytes` ≥ 0 bytes to rank `to`, another one, which calls tetcast_mpi_receive() with the same number: it may
 * wait for that. Messages between two ranks arrive in the order in which they are sent. An error on one side does not
 * become known to the other by itself. */
TETCAST_API TetcastStatus tetcast_mpi_send(TetcastMpi *mpi, int to, const void *data, int64_t bytes);

/* Receives what rank `from`, another one, sends by tetcast_mpi_send(). Another number of bytes than is sent is
 * TETCAST_ERROR_IO. */
TETCAST_API TetcastStatus tetcast_mpi_receive(TetcastMpi *mpi, int from, void *data, int64_t bytes);

/* Collective. Makes the transfer function that tetcast_scene_scale_transfer_function() makes for one scene, up to
 * rounding, for all parts of all ranks: scenes [count], each with a field. `scenes` may be NULL where count is 0.
 * `bounds`: those that the volumes were made with. The scenes' own transfer functions are not used, but are replaced;
 * surfaces and clips would count, and are to be set later. bounds, shape, camera and opacity of rank 0 hold; for others
 * they may be NULL and 0. All ranks get the result, with the same bits however parts are shared out; each destroys its
 * own. */
TETCAST_API TetcastStatus tetcast_mpi_scale_transfer_function(TetcastMpi *mpi, TetcastScene *const *scenes,
                                                              int64_t count, const double bounds[6],
                                                              const TetcastTransferFunction *shape,
                                                              const TetcastCamera *camera, double opacity,
                                                              TetcastTransferFunction **transfer_function);

/* Collective. Likewise the transfer function that tetcast_scene_fit_transfer_function() makes for one scene. bounds,
 * shape, low and high of rank 0 hold. */
TETCAST_API TetcastStatus tetcast_mpi_fit_transfer_function(TetcastMpi *mpi, TetcastScene *const *scenes, int64_t count,
                                                            const double bounds[6],
                                                            const TetcastTransferFunction *shape, double low,
                                                            double high, TetcastTransferFunction **transfer_function);

/* What was done to make a picture; the same on all ranks. */
typedef struct TetcastMpiStats {
  /* The number of cells crossed over a length > 0, summed over rays and parts. */
  int64_t segments;
  /* The number of rays whose walk ended before the boundary of a part. Anything but 0 is a defect of tetcast. */
  int64_t lost;
  /* The number of fragments of all parts. */
  int64_t fragments;
  /* The largest length over which a fragment overlaps those before it (tetcast_fragments_composite()), in the mesh's
   * unit: far above rounding where cells are in several parts. */
  double overlap;
  /* The number of bytes that ranks have sent each other, fragments and pixels, summed over ranks. */
  int64_t bytes;
  /* The largest number of bytes that one rank has sent and received. */
  int64_t most_bytes;
  /* The largest number of bytes that one rank needed at a time (tetcast_mpi_set_memory()). */
  int64_t memory;
  /* The number of bands that the picture was made in. */
  int64_t bands;
  /* The number of bands that were made in vain before, as they didn't fit into memory. */
  int64_t redone;
  /* The time in seconds, of the rank that took longest, for rendering fragments, and sorting them by owner. */
  double render_seconds;
  /* Likewise for waiting until all ranks have rendered theirs. */
  double wait_seconds;
  /* Likewise for sending and receiving them. */
  double exchange_seconds;
  /* Likewise for compositing them. */
  double composite_seconds;
  /* Likewise for collecting pixels at rank 0. */
  double gather_seconds;
  /* The name of the instruction set that was used: "scalar", "avx2" or "avx512". In static storage, never NULL. */
  const char *isa;
} TetcastMpiStats;

/* Collective. Renders all parts of all ranks, scenes [count], into every pixel of rank 0's `frame`; `scenes` may be
 * NULL where count is 0. All scenes must have the same look (tetcast_scene_look()) and coefficients of as many groups
 * (TETCAST_ERROR_ARGUMENT), and show what has fragments (tetcast_scene_render_fragments()). Rank 0's camera and frame
 * hold; for others they may be NULL. `desc` may be NULL: rank 0's holds, but for isa, of which the smallest of all
 * ranks' holds, as does the smallest that all processors have; and for progress, which each rank may have. Cancelled by
 * one rank, all return TETCAST_ERROR_CANCELLED. Rows of a larger picture (TetcastRenderDesc.picture_height) are
 * possible; `stop` and `start` are TETCAST_ERROR_ARGUMENT. Of channels, the frame may have those that only scenes with
 * coefficients have, and must have as many groups as these; others are TETCAST_ERROR_ARGUMENT. `stats` may be NULL.
 * After an error the frame's pixels and channels are unspecified. */
TETCAST_API TetcastStatus tetcast_mpi_render(TetcastMpi *mpi, const TetcastScene *const *scenes, int64_t count,
                                             const TetcastCamera *camera, const TetcastRenderDesc *desc,
                                             TetcastFrame *frame, TetcastMpiStats *stats);

#ifdef __cplusplus
}
#endif

#endif
