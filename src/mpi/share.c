/* SPDX-License-Identifier: Apache-2.0 */
#include "share.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 1 << 20 }; /* of a frame */

/* ── who owns what ── */

TcMpiBand tc_mpi_band(const TetcastMpi *mpi, int64_t width, int64_t first, int64_t rows) {
  const int64_t units = ((width + TC_MPI_UNIT - 1) / TC_MPI_UNIT) | 1;
  const int64_t most = (int64_t)MOST_ROWS * mpi->size / units / TC_MPI_ROWS * TC_MPI_ROWS;
  return (TcMpiBand){width, first, rows < most ? rows : most, units};
}

int64_t tc_mpi_owned(const TcMpiBand *band, int rank, int ranks) {
  return (band->rows * band->units - rank + ranks - 1) / ranks;
}

/* ── fragments ── */

/* Fragments of one unit go to one rank, in which its pixels are in a row. */
static TetcastStatus post_unit(TetcastMpi *mpi, const TcMpiBand *band, const TetcastFragment *from, int64_t count) {
  const int64_t x = from->pixel % band->width, unit = from->pixel / band->width * band->units + x / TC_MPI_UNIT;
  const int64_t moved = unit / mpi->size * TC_MPI_UNIT + x % TC_MPI_UNIT - from->pixel;
  TcMpiBuffer *box = &mpi->outboxes[unit % mpi->size];
  const TetcastStatus status = tc_mpi_grow(mpi, box, box->bytes + count * (int64_t)sizeof *from);
  if (status)
    return status;
  TetcastFragment *to = (TetcastFragment *)(void *)(box->data + box->bytes);
  memcpy(to, from, (size_t)count * sizeof *from);
  for (int64_t i = 0; i < count; ++i)
    to[i].pixel += moved;
  box->bytes += count * (int64_t)sizeof *from;
  return TETCAST_OK;
}

TetcastStatus tc_mpi_post(TetcastMpi *mpi, const TcMpiBand *band, TetcastFragmentList list) {
  for (int64_t begin = 0, end; begin < list.count; begin = end) {
    const int64_t pixel = list.data[begin].pixel, x = pixel % band->width, row_end = pixel - x + band->width;
    int64_t unit_end = pixel - x % TC_MPI_UNIT + TC_MPI_UNIT;
    if (unit_end > row_end)
      unit_end = row_end;
    for (end = begin + 1; end < list.count && list.data[end].pixel < unit_end;)
      ++end;
    const TetcastStatus status = post_unit(mpi, band, list.data + begin, end - begin);
    if (status)
      return status;
  }
  return TETCAST_OK;
}

/* What this rank sends itself stays where it is. */
TetcastStatus tc_mpi_announce(TetcastMpi *mpi) {
  int64_t *sent = mpi->counts, *received = sent + mpi->size, bytes = 0, requests = 0;
  for (int i = 0; i < mpi->size; ++i)
    sent[i] = i == mpi->rank ? 0 : mpi->outboxes[i].bytes;
  TetcastStatus status =
      tc_mpi_check(mpi, MPI_Alltoall(sent, 1, MPI_INT64_T, received, 1, MPI_INT64_T, mpi->comm), "MPI_Alltoall");
  if (status)
    return status;
  for (int i = 0; i < mpi->size; ++i) {
    bytes += received[i];
    requests += tc_mpi_pieces(sent[i]) + tc_mpi_pieces(received[i]);
  }
  status = tc_mpi_grow(mpi, &mpi->inbox, bytes);
  mpi->inbox.bytes = status ? 0 : bytes;
  return status ? status : tc_mpi_reserve(mpi, requests);
}

TetcastStatus tc_mpi_exchange(TetcastMpi *mpi) {
  const int64_t *received = mpi->counts + mpi->size;
  TetcastStatus status = TETCAST_OK;
  for (int64_t i = 0, at = 0; !status && i < mpi->size; at += received[i++])
    status = tc_mpi_start_receive(mpi, (int)i, mpi->inbox.data + at, received[i]);
  /* Each begins with the rank that follows it, so that not all send to the same one. */
  for (int i = 1; !status && i < mpi->size; ++i) {
    const int to = (mpi->rank + i) % mpi->size;
    status = tc_mpi_start_send(mpi, to, mpi->outboxes[to].data, mpi->outboxes[to].bytes);
  }
  const TetcastStatus finished = tc_mpi_finish(mpi);
  return status ? status : finished;
}

/* Cuts what lies in a buffer into lists of ascending pixels: a new one begins where pixels descend. `lists` may be
 * NULL. Returns how many. */
static int64_t cut_lists(const char *data, int64_t bytes, TetcastFragmentList *lists) {
  const TetcastFragment *fragments = (const TetcastFragment *)(const void *)data;
  const int64_t count = bytes / (int64_t)sizeof *fragments;
  int64_t lists_count = 0;
  for (int64_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && fragments[end].pixel >= fragments[end - 1].pixel;)
      ++end;
    if (lists)
      lists[lists_count] = (TetcastFragmentList){fragments + begin, end - begin};
    ++lists_count;
  }
  return lists_count;
}

TetcastStatus tc_mpi_lists(TetcastMpi *mpi, TetcastFragmentList **lists, int64_t *count) {
  const TcMpiBuffer *own = &mpi->outboxes[mpi->rank], *others = &mpi->inbox;
  const int64_t of_own = cut_lists(own->data, own->bytes, NULL);
  *count = of_own + cut_lists(others->data, others->bytes, NULL);
  *lists = calloc((size_t)*count + 1, sizeof **lists);
  if (!*lists)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: fragments", mpi->rank);
  cut_lists(own->data, own->bytes, *lists);
  cut_lists(others->data, others->bytes, *lists + of_own);
  return TETCAST_OK;
}

/* ── pixels ── */

static int64_t pixel_size(TetcastType type) {
  return 4 * (int64_t)(type == TETCAST_TYPE_FLOAT32 ? sizeof(float) : sizeof(double));
}

TetcastStatus tc_mpi_prepare_gather(TetcastMpi *mpi, const TcMpiBand *band, TetcastType type) {
  const int64_t unit_bytes = TC_MPI_UNIT * pixel_size(type);
  int64_t bytes = 0, requests = tc_mpi_pieces(tc_mpi_owned(band, mpi->rank, mpi->size) * unit_bytes);
  for (int i = 1; mpi->rank == 0 && i < mpi->size; ++i) {
    bytes += tc_mpi_owned(band, i, mpi->size) * unit_bytes;
    requests += tc_mpi_pieces(tc_mpi_owned(band, i, mpi->size) * unit_bytes);
  }
  const TetcastStatus status = tc_mpi_grow(mpi, &mpi->pixels, bytes);
  mpi->pixels.bytes = status ? 0 : bytes;
  return status ? status : tc_mpi_reserve(mpi, requests);
}

/* Puts the units of a rank where they belong. The frame's pixels are const only to those who look at pictures; this is
 * who makes them. */
static void put_units(const TetcastMpi *mpi, const TcMpiBand *band, int rank, int64_t size, const char *from,
                      TetcastFrame *frame) {
  char *pixels = (char *)(uintptr_t)tetcast_frame_pixels(frame);
  const int64_t stride = tetcast_frame_row_stride(frame), owned = tc_mpi_owned(band, rank, mpi->size);
  for (int64_t i = 0; i < owned; ++i) {
    const int64_t unit = i * mpi->size + rank, x = unit % band->units * TC_MPI_UNIT;
    const int64_t count = band->width - x < TC_MPI_UNIT ? band->width - x : TC_MPI_UNIT;
    if (count > 0)
      memcpy(pixels + (band->first + unit / band->units) * stride + x * size, from + i * TC_MPI_UNIT * size,
             (size_t)(count * size));
  }
}

TetcastStatus tc_mpi_gather(TetcastMpi *mpi, const TcMpiBand *band, TetcastType type, const TetcastFrame *own,
                            TetcastFrame *frame) {
  const int64_t size = pixel_size(type), unit_bytes = TC_MPI_UNIT * size;
  TetcastStatus status = TETCAST_OK;
  int64_t at = 0;
  if (mpi->rank > 0 && own)
    status =
        tc_mpi_start_send(mpi, 0, tetcast_frame_pixels(own), tc_mpi_owned(band, mpi->rank, mpi->size) * unit_bytes);
  for (int i = 1; mpi->rank == 0 && !status && i < mpi->size; ++i) {
    const int64_t bytes = tc_mpi_owned(band, i, mpi->size) * unit_bytes;
    status = tc_mpi_start_receive(mpi, i, mpi->pixels.data + at, bytes);
    at += bytes;
  }
  const TetcastStatus finished = tc_mpi_finish(mpi);
  if (status || finished)
    return status ? status : finished;
  at = 0;
  for (int i = 0; mpi->rank == 0 && i < mpi->size; ++i) {
    if (i == 0 && own)
      put_units(mpi, band, 0, size, tetcast_frame_pixels(own), frame);
    if (i == 0)
      continue;
    put_units(mpi, band, i, size, mpi->pixels.data + at, frame);
    at += tc_mpi_owned(band, i, mpi->size) * unit_bytes;
  }
  return TETCAST_OK;
}
