/* SPDX-License-Identifier: Apache-2.0 */
/* Which rank composites which pixels, and how fragments and pixels come there and back.
 *
 * A band of rows is cut into units of TC_MPI_UNIT pixels of one row, which ranks own in turn. So each has as many as
 * another, from all over the picture, whatever the number of ranks; and fragments, which come by ascending pixels, need
 * not be looked at one by one. A rank's units, one below the other, are the frame that it composites into. */
#ifndef TC_MPI_SHARE_H
#define TC_MPI_SHARE_H

#include "communicator.h"

enum {
  TC_MPI_UNIT = 64,
  /* Bands begin at multiples of so many rows. Pictures are rendered in squares with such sides, and how rays of one
   * square are grouped decides how their sums are rounded. */
  TC_MPI_ROWS = 16
};

/* The rows of the frame from which fragments come and to which pixels go. */
typedef struct TcMpiBand {
  int64_t width, first, rows;
  /* The number of units in a row, plus 1 if that is even: so one rank doesn't own what lies on a vertical line where
   * the number of ranks is a power of two. Beyond the row's end units have no pixels, and are owned nevertheless. */
  int64_t units;
} TcMpiBand;

enum { TC_MPI_PLANES = 5 };

/* The arrays of a frame, its pixels and then its channels. */
typedef struct TcMpiPlanes {
  int count;
  TetcastChannel channel[TC_MPI_PLANES]; /* from the second one on */
  int64_t size[TC_MPI_PLANES];           /* the bytes that a pixel has in each */
  int64_t bytes;                         /* in all of them */
} TcMpiPlanes;

/* Those of frames as the view has them, whose channels are such as only scenes with coefficients have. */
TcMpiPlanes tc_mpi_planes(const TcMpiView *view);

/* The bytes of a fragment and its row. */
int64_t tc_mpi_fragment_size(const TetcastMpi *mpi);

/* The bytes that this rank sends to others. */
int64_t tc_mpi_sent(const TetcastMpi *mpi);

/* A band; rows beyond the most that a rank can own units of are left out. */
TcMpiBand tc_mpi_band(const TetcastMpi *mpi, int64_t width, int64_t first, int64_t rows);

/* How many units a rank owns. */
int64_t tc_mpi_owned(const TcMpiBand *band, int rank, int ranks);

/* Adds fragments of the band to the boxes of the ranks that own their pixels, and numbers pixels as these do. */
TetcastStatus tc_mpi_post(TetcastMpi *mpi, const TcMpiBand *band, TetcastFragmentList list);

/* Makes known how much comes from whom, and makes room for it; all ranks must call it, whatever has happened to them
 * before. */
TetcastStatus tc_mpi_announce(TetcastMpi *mpi);

/* Sends and receives fragments. */
TetcastStatus tc_mpi_exchange(TetcastMpi *mpi);

/* The lists that have come to this rank, and how many; to be freed. NULL: out of memory. */
TetcastStatus tc_mpi_lists(TetcastMpi *mpi, TetcastFragmentList **lists, int64_t *count);

/* Makes room for the pixels that rank 0 collects from the others, at rank 0, and for the messages they come by. */
TetcastStatus tc_mpi_prepare_gather(TetcastMpi *mpi, const TcMpiBand *band, const TcMpiPlanes *planes);

/* Sends all planes of `own`, this rank's units, to rank 0, which puts all into its `frame`. `own` is NULL if there are
 * none. */
TetcastStatus tc_mpi_gather(TetcastMpi *mpi, const TcMpiBand *band, const TcMpiPlanes *planes, const TetcastFrame *own,
                            TetcastFrame *frame);

#endif
