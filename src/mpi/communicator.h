/* SPDX-License-Identifier: Apache-2.0 */
/* The ranks, and messages between them. Whatever may fail on one rank alone is done before tc_mpi_agree(), a fixed
 * point that all ranks come to with their statuses; what lies between two of them only sends and receives, so that no
 * rank waits for one that has given up. */
#ifndef TC_MPI_COMMUNICATOR_H
#define TC_MPI_COMMUNICATOR_H

#include <stdbool.h>
#include <stdint.h>

#include <mpi.h>

#include <tetcast/fragments.h>
#include <tetcast/mpi.h>

/* A message of more bytes than that is sent in pieces: MPI before 4 counts in int. Tests have smaller ones. */
#ifndef TC_MPI_PIECE
#define TC_MPI_PIECE (INT64_C(1) << 30)
#endif

/* An array of bytes that grows. */
typedef struct TcMpiBuffer {
  char *data;
  int64_t bytes, capacity;
} TcMpiBuffer;

/* What a picture is taken from, its rows of a larger one, and what a pixel of it has. */
typedef struct TcMpiView {
  TetcastCamera camera;
  int64_t width, height, picture_height, first_row;
  int64_t type, channels, frame_groups; /* as in TetcastFrameDesc; groups of 1 without channels */
} TcMpiView;

struct TetcastMpi {
  TetcastContext *context;
  MPI_Comm comm;
  int rank, size;
  bool ends_mpi; /* this object has started MPI */
  int64_t memory;
  MPI_Request *requests; /* [request_capacity], of which request_count are under way */
  int64_t request_count, request_capacity;
  /* Kept from picture to picture. */
  TetcastFragments *fragments;
  TcMpiBuffer *outboxes;  /* [size], the fragments that go to each rank */
  TcMpiBuffer *row_boxes; /* [size], with coefficients, their rows: what TetcastFragmentList.groups has of each */
  TcMpiBuffer inbox;      /* the fragments that have come, from rank after rank */
  TcMpiBuffer row_inbox;  /* their rows */
  TcMpiBuffer pixels;     /* at rank 0, what it collects */
  int64_t *counts;        /* [2 · size] */
  double bytes_per_pixel; /* that the last picture's densest band needed on the rank that needed most */
  TcMpiView view;         /* of the last picture, at rank 0 */
  int groups;             /* of its coefficients; 0 without */
  TetcastIsa isa;         /* the largest instruction set that all ranks have; AUTO: no difference is known */
};

/* Sends the message that MPI has for a code; TETCAST_OK for MPI_SUCCESS, else TETCAST_ERROR_IO. */
TetcastStatus tc_mpi_check(TetcastMpi *mpi, int code, const char *function);

/* As tetcast_mpi_agree(); besides, maxima [count ≤ 7] become the largest of all ranks, if it succeeds. */
TetcastStatus tc_mpi_agree(TetcastMpi *mpi, TetcastStatus own, int64_t *maxima, int count);

/* Notes the instruction set that something was rendered with in isa[2], which begin as INT64_MIN: the largest, and the
 * smallest times −1. */
void tc_mpi_note_isa(const char *name, int64_t isa[2]);

/* Whether all ranks have used the same, by the largest of their isa[2]. If not, no larger one than the smallest is to
 * be used from now on. */
bool tc_mpi_one_isa(TetcastMpi *mpi, const int64_t isa[2]);

/* How many requests a message of so many bytes takes. */
static inline int64_t tc_mpi_pieces(int64_t bytes) {
  return bytes / TC_MPI_PIECE + (bytes % TC_MPI_PIECE != 0);
}

/* Makes room for so many requests under way. */
TetcastStatus tc_mpi_reserve(TetcastMpi *mpi, int64_t requests);

/* Start to send or receive; there must be room for the requests. */
TetcastStatus tc_mpi_start_send(TetcastMpi *mpi, int to, const void *data, int64_t bytes);
TetcastStatus tc_mpi_start_receive(TetcastMpi *mpi, int from, void *data, int64_t bytes);

/* Waits until all that was started has been done. */
TetcastStatus tc_mpi_finish(TetcastMpi *mpi);

/* Broadcasts, without checks. */
TetcastStatus tc_mpi_broadcast(TetcastMpi *mpi, int root, void *data, int64_t bytes);

/* Makes room for so many bytes in all, of which buffer->bytes are kept. */
TetcastStatus tc_mpi_grow(TetcastMpi *mpi, TcMpiBuffer *buffer, int64_t bytes);
void tc_mpi_release(TcMpiBuffer *buffer);

/* Frees what is kept from picture to picture. */
void tc_mpi_forget(TetcastMpi *mpi);

#endif
