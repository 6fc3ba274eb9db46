/* SPDX-License-Identifier: Apache-2.0 */
#include "communicator.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TAG = 1, MOST_MAXIMA = 7 };

/* ── statuses ── */

TetcastStatus tc_mpi_check(TetcastMpi *mpi, int code, const char *function) {
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  if (code == MPI_SUCCESS)
    return TETCAST_OK;
  MPI_Error_string(code, text, &length);
  return tetcast_context_error(mpi->context, TETCAST_ERROR_IO, "rank %d: %s failed: %s", mpi->rank, function, text);
}

/* The lower the rank, the larger is the number that stands for its error, and the largest is what all get. */
TetcastStatus tc_mpi_agree(TetcastMpi *mpi, TetcastStatus own, int64_t *maxima, int count) {
  int64_t mine[1 + MOST_MAXIMA], all[1 + MOST_MAXIMA];
  mine[0] = own ? (int64_t)(mpi->size - mpi->rank) << 8 | own : 0;
  for (int i = 0; i < count; ++i)
    mine[1 + i] = maxima[i];
  const TetcastStatus status =
      tc_mpi_check(mpi, MPI_Allreduce(mine, all, 1 + count, MPI_INT64_T, MPI_MAX, mpi->comm), "MPI_Allreduce");
  if (status)
    return own ? own : status;
  for (int i = 0; i < count; ++i)
    maxima[i] = all[1 + i];
  if (!all[0])
    return TETCAST_OK;
  const TetcastStatus agreed = (TetcastStatus)(all[0] & 255);
  if (!own)
    tetcast_context_error(mpi->context, agreed, "rank %d failed: %s", mpi->size - (int)(all[0] >> 8),
                          tetcast_status_string(agreed));
  return agreed;
}

TetcastStatus tetcast_mpi_agree(TetcastMpi *mpi, TetcastStatus own) {
  return mpi ? tc_mpi_agree(mpi, own, NULL, 0) : TETCAST_ERROR_ARGUMENT;
}

/* ── instruction sets ── */

void tc_mpi_note_isa(const char *name, int64_t isa[2]) {
  const int64_t number = !strcmp(name, "scalar") ? TETCAST_ISA_SCALAR
                         : !strcmp(name, "avx2") ? TETCAST_ISA_AVX2
                                                 : TETCAST_ISA_AVX512;
  isa[0] = isa[0] > number ? isa[0] : number;
  isa[1] = isa[1] > -number ? isa[1] : -number;
}

bool tc_mpi_one_isa(TetcastMpi *mpi, const int64_t isa[2]) {
  const bool one = isa[0] == INT64_MIN || isa[0] == -isa[1];
  if (!one)
    mpi->isa = (TetcastIsa)-isa[1];
  return one;
}

/* ── buffers ── */

TetcastStatus tc_mpi_grow(TetcastMpi *mpi, TcMpiBuffer *buffer, int64_t bytes) {
  if (bytes <= buffer->capacity)
    return TETCAST_OK;
  const int64_t capacity = bytes > buffer->capacity / 4 * 5 ? bytes : buffer->capacity / 4 * 5;
  char *data = (uint64_t)capacity <= SIZE_MAX ? realloc(buffer->data, (size_t)capacity) : NULL;
  if (!data)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY,
                                 "rank %d: out of memory: %" PRId64 " bytes of fragments or pixels", mpi->rank,
                                 capacity);
  buffer->data = data;
  buffer->capacity = capacity;
  return TETCAST_OK;
}

void tc_mpi_release(TcMpiBuffer *buffer) {
  free(buffer->data);
  *buffer = (TcMpiBuffer){0};
}

void tc_mpi_forget(TetcastMpi *mpi) {
  tetcast_fragments_destroy(&mpi->fragments);
  for (int i = 0; mpi->outboxes && mpi->row_boxes && i < mpi->size; ++i) {
    tc_mpi_release(&mpi->outboxes[i]);
    tc_mpi_release(&mpi->row_boxes[i]);
  }
  tc_mpi_release(&mpi->inbox);
  tc_mpi_release(&mpi->row_inbox);
  tc_mpi_release(&mpi->pixels);
}

/* ── its life ── */

/* Frees all of it. */
static void release(TetcastMpi *mpi) {
  tc_mpi_forget(mpi);
  free(mpi->requests);
  free(mpi->outboxes);
  free(mpi->row_boxes);
  free(mpi->counts);
  free(mpi);
}

/* All that is this rank's own; NULL: out of memory. */
static TetcastMpi *prepare(TetcastContext *context, MPI_Comm comm) {
  TetcastMpi *mpi = calloc(1, sizeof *mpi);
  if (!mpi)
    return NULL;
  *mpi = (TetcastMpi){.context = context, .memory = INT64_C(1) << 28};
  MPI_Comm_rank(comm, &mpi->rank);
  MPI_Comm_size(comm, &mpi->size);
  mpi->outboxes = calloc((size_t)mpi->size, sizeof *mpi->outboxes);
  mpi->row_boxes = calloc((size_t)mpi->size, sizeof *mpi->row_boxes);
  mpi->counts = calloc(2 * (size_t)mpi->size, sizeof *mpi->counts);
  if (mpi->outboxes && mpi->row_boxes && mpi->counts)
    return mpi;
  release(mpi);
  return NULL;
}

/* The duplicate comes first, as it is what ranks can agree by that one of them has failed. */
static TetcastStatus create(TetcastContext *context, MPI_Comm comm, bool ends_mpi, TetcastMpi **out) {
  TetcastMpi shortage = {.context = context};
  MPI_Comm own = MPI_COMM_NULL;
  int between = 0;
  MPI_Comm_rank(comm, &shortage.rank);
  MPI_Comm_size(comm, &shortage.size);
  TetcastStatus status = tc_mpi_check(&shortage, MPI_Comm_test_inter(comm, &between), "MPI_Comm_test_inter");
  if (!status && between)
    status = tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "the communicator is one between two groups");
  if (!status)
    status = tc_mpi_check(&shortage, MPI_Comm_dup(comm, &own), "MPI_Comm_dup");
  if (status)
    return status;
  MPI_Comm_set_errhandler(own, MPI_ERRORS_RETURN);
  TetcastMpi *mpi = context && out ? prepare(context, own) : NULL;
  if (!context || !out)
    status = tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "context or mpi is NULL");
  else if (!mpi)
    status = tetcast_context_error(context, TETCAST_ERROR_MEMORY, "rank %d: out of memory", shortage.rank);
  shortage.comm = own;
  status = tc_mpi_agree(&shortage, status, NULL, 0);
  if (status) {
    if (mpi)
      release(mpi);
    MPI_Comm_free(&own);
    return status;
  }
  mpi->comm = own;
  mpi->ends_mpi = ends_mpi;
  *out = mpi;
  return TETCAST_OK;
}

/* Whether MPI can be used now; if it has not been started, `started` is false. */
static TetcastStatus look(TetcastContext *context, int *started) {
  int ended = 0;
  *started = 0;
  MPI_Finalized(&ended);
  MPI_Initialized(started);
  return ended ? tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "MPI has been ended") : TETCAST_OK;
}

TetcastStatus tetcast_mpi_create(TetcastContext *context, int communicator, TetcastMpi **mpi) {
  int started;
  if (mpi)
    *mpi = NULL;
  const TetcastStatus status = look(context, &started);
  if (status)
    return status;
  if (!started)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "MPI has not been started");
  const MPI_Comm comm = MPI_Comm_f2c((MPI_Fint)communicator);
  if (comm == MPI_COMM_NULL)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "the communicator is MPI_COMM_NULL");
  return create(context, comm, false, mpi);
}

TetcastStatus tetcast_mpi_create_world(TetcastContext *context, TetcastMpi **mpi) {
  int started, level;
  if (mpi)
    *mpi = NULL;
  TetcastStatus status = look(context, &started);
  if (status)
    return status;
  if (!started && MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS)
    return tetcast_context_error(context, TETCAST_ERROR_IO, "MPI can't be started");
  status = create(context, MPI_COMM_WORLD, !started, mpi);
  if (status && !started)
    MPI_Finalize();
  return status;
}

void tetcast_mpi_destroy(TetcastMpi **mpi) {
  int ended = 0;
  if (!mpi || !*mpi)
    return;
  const bool ends_mpi = (*mpi)->ends_mpi;
  MPI_Finalized(&ended);
  if (!ended)
    MPI_Comm_free(&(*mpi)->comm);
  release(*mpi);
  if (!ended && ends_mpi)
    MPI_Finalize();
  *mpi = NULL;
}

int tetcast_mpi_rank(const TetcastMpi *mpi) {
  return mpi->rank;
}

int tetcast_mpi_size(const TetcastMpi *mpi) {
  return mpi->size;
}

TetcastStatus tetcast_mpi_set_memory(TetcastMpi *mpi, int64_t bytes) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  if (bytes < 1)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%" PRId64 " bytes of memory, must be above 0",
                                 bytes);
  mpi->memory = bytes;
  return TETCAST_OK;
}

/* ── messages ── */

TetcastStatus tc_mpi_reserve(TetcastMpi *mpi, int64_t requests) {
  if (requests <= mpi->request_capacity)
    return TETCAST_OK;
  MPI_Request *grown = requests <= INT32_MAX ? realloc(mpi->requests, (size_t)requests * sizeof *grown) : NULL;
  if (!grown)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: %" PRId64 " messages",
                                 mpi->rank, requests);
  mpi->requests = grown;
  mpi->request_capacity = requests;
  return TETCAST_OK;
}

static int piece_of(int64_t bytes, int64_t from) {
  return (int)(bytes - from < TC_MPI_PIECE ? bytes - from : TC_MPI_PIECE);
}

TetcastStatus tc_mpi_start_send(TetcastMpi *mpi, int to, const void *data, int64_t bytes) {
  for (int64_t at = 0; at < bytes; at += TC_MPI_PIECE) {
    MPI_Request *request = &mpi->requests[mpi->request_count];
    const TetcastStatus status = tc_mpi_check(
        mpi, MPI_Isend((const char *)data + at, piece_of(bytes, at), MPI_BYTE, to, TAG, mpi->comm, request),
        "MPI_Isend");
    if (status)
      return status;
    ++mpi->request_count;
  }
  return TETCAST_OK;
}

TetcastStatus tc_mpi_start_receive(TetcastMpi *mpi, int from, void *data, int64_t bytes) {
  for (int64_t at = 0; at < bytes; at += TC_MPI_PIECE) {
    MPI_Request *request = &mpi->requests[mpi->request_count];
    const TetcastStatus status = tc_mpi_check(
        mpi, MPI_Irecv((char *)data + at, piece_of(bytes, at), MPI_BYTE, from, TAG, mpi->comm, request), "MPI_Irecv");
    if (status)
      return status;
    ++mpi->request_count;
  }
  return TETCAST_OK;
}

TetcastStatus tc_mpi_finish(TetcastMpi *mpi) {
  const int count = (int)mpi->request_count;
  mpi->request_count = 0;
  return tc_mpi_check(mpi, MPI_Waitall(count, mpi->requests, MPI_STATUSES_IGNORE), "MPI_Waitall");
}

TetcastStatus tc_mpi_broadcast(TetcastMpi *mpi, int root, void *data, int64_t bytes) {
  TetcastStatus status = TETCAST_OK;
  for (int64_t at = 0; !status && at < bytes; at += TC_MPI_PIECE)
    status =
        tc_mpi_check(mpi, MPI_Bcast((char *)data + at, piece_of(bytes, at), MPI_BYTE, root, mpi->comm), "MPI_Bcast");
  return status;
}

TetcastStatus tetcast_mpi_broadcast(TetcastMpi *mpi, int root, void *data, int64_t bytes) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  TetcastStatus status = TETCAST_OK;
  int64_t same[4] = {root, -(int64_t)root, bytes, -bytes};
  if (root < 0 || root >= mpi->size)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "rank %d does not exist", root);
  else if (bytes < 0 || (bytes > 0 && !data))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%" PRId64 " bytes%s to broadcast", bytes,
                                   data ? "" : ", and no place,");
  status = tc_mpi_agree(mpi, status, same, 4);
  if (!status && (same[0] != -same[1] || same[2] != -same[3]))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "a broadcast from ranks %" PRId64 " and %" PRId64 ", of %" PRId64 " and %" PRId64
                                   " bytes: ranks differ",
                                   -same[1], same[0], -same[3], same[2]);
  return status ? status : tc_mpi_broadcast(mpi, root, data, bytes);
}

static TetcastStatus check_message(TetcastMpi *mpi, int other, const void *data, int64_t bytes) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  if (other < 0 || other >= mpi->size || other == mpi->rank)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "rank %d can't be reached from rank %d", other,
                                 mpi->rank);
  if (bytes < 0 || (bytes > 0 && !data))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "a message of %" PRId64 " bytes%s", bytes,
                                 data ? "" : " at NULL");
  return TETCAST_OK;
}

/* The number of bytes goes first, so that a receiver that expects another one doesn't wait for ever. */
TetcastStatus tetcast_mpi_send(TetcastMpi *mpi, int to, const void *data, int64_t bytes) {
  TetcastStatus status = check_message(mpi, to, data, bytes);
  if (!status)
    status = tc_mpi_check(mpi, MPI_Send(&bytes, 1, MPI_INT64_T, to, TAG, mpi->comm), "MPI_Send");
  for (int64_t at = 0; !status && at < bytes; at += TC_MPI_PIECE)
    status = tc_mpi_check(mpi, MPI_Send((const char *)data + at, piece_of(bytes, at), MPI_BYTE, to, TAG, mpi->comm),
                          "MPI_Send");
  return status;
}

/* Takes what was sent out of the way. */
static TetcastStatus drop(TetcastMpi *mpi, int from, int64_t bytes) {
  TcMpiBuffer buffer = {0};
  TetcastStatus status = tc_mpi_grow(mpi, &buffer, bytes < TC_MPI_PIECE ? bytes : TC_MPI_PIECE);
  for (int64_t at = 0; !status && at < bytes; at += TC_MPI_PIECE)
    status = tc_mpi_check(
        mpi, MPI_Recv(buffer.data, piece_of(bytes, at), MPI_BYTE, from, TAG, mpi->comm, MPI_STATUS_IGNORE), "MPI_Recv");
  tc_mpi_release(&buffer);
  return status;
}

TetcastStatus tetcast_mpi_receive(TetcastMpi *mpi, int from, void *data, int64_t bytes) {
  int64_t sent = 0;
  TetcastStatus status = check_message(mpi, from, data, bytes);
  if (!status)
    status = tc_mpi_check(mpi, MPI_Recv(&sent, 1, MPI_INT64_T, from, TAG, mpi->comm, MPI_STATUS_IGNORE), "MPI_Recv");
  if (!status && sent != bytes) {
    status = drop(mpi, from, sent);
    return status ? status
                  : tetcast_context_error(mpi->context, TETCAST_ERROR_IO,
                                          "rank %d has sent %" PRId64 " bytes, and rank %d expects %" PRId64, from,
                                          sent, mpi->rank, bytes);
  }
  for (int64_t at = 0; !status && at < bytes; at += TC_MPI_PIECE)
    status = tc_mpi_check(
        mpi, MPI_Recv((char *)data + at, piece_of(bytes, at), MPI_BYTE, from, TAG, mpi->comm, MPI_STATUS_IGNORE),
        "MPI_Recv");
  return status;
}

/* ── minima and maxima ── */

/* Replaces pairs of a minimum and a maximum by those of all ranks. Zeros get one sign, as which of two is the smaller
 * would depend on their order. */
static TetcastStatus spread(TetcastMpi *mpi, double *pairs, int count) {
  double all[6];
  for (int i = 0; i < 2 * count; ++i)
    pairs[i] = (i % 2 ? pairs[i] : -pairs[i]) + 0.;
  const TetcastStatus status =
      tc_mpi_check(mpi, MPI_Allreduce(pairs, all, 2 * count, MPI_DOUBLE, MPI_MAX, mpi->comm), "MPI_Allreduce");
  for (int i = 0; !status && i < 2 * count; ++i)
    pairs[i] = (i % 2 ? all[i] : -all[i]) + 0.;
  return status;
}

TetcastStatus tetcast_mpi_bounds(TetcastMpi *mpi, double bounds[6]) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  double all[6];
  TetcastStatus status =
      bounds ? TETCAST_OK : tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "bounds is NULL");
  bool none = false;
  for (int i = 0; !status && i < 6; ++i) {
    if (isnan(bounds[i]))
      status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "rank %d: bounds[%d] is NaN", mpi->rank, i);
    none = none || (i % 2 && bounds[i - 1] > bounds[i]);
  }
  status = tc_mpi_agree(mpi, status, NULL, 0);
  for (int i = 0; !status && i < 6; ++i)
    all[i] = none ? (i % 2 ? -(double)INFINITY : (double)INFINITY) : bounds[i];
  if (!status)
    status = spread(mpi, all, 3);
  if (!status)
    memcpy(bounds, all, sizeof all);
  return status;
}

TetcastStatus tetcast_mpi_range(TetcastMpi *mpi, double range[2]) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  TetcastStatus status =
      range ? TETCAST_OK : tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "range is NULL");
  status = tc_mpi_agree(mpi, status, NULL, 0);
  if (status)
    return status;
  double all[2] = {range[0], range[1]};
  if (!(all[0] <= all[1])) {
    all[0] = (double)INFINITY;
    all[1] = -(double)INFINITY;
  }
  status = spread(mpi, all, 1);
  if (!status)
    memcpy(range, all, sizeof all);
  return status;
}
