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

static int64_t row_size(const TetcastMpi *mpi) {
  return 2 * (int64_t)mpi->groups * (int64_t)sizeof(double);
}

int64_t tc_mpi_fragment_size(const TetcastMpi *mpi) {
  return (int64_t)sizeof(TetcastFragment) + row_size(mpi);
}

int64_t tc_mpi_sent(const TetcastMpi *mpi) {
  int64_t bytes = 0;
  for (int i = 0; i < mpi->size; ++i)
    bytes += i == mpi->rank ? 0 : mpi->outboxes[i].bytes + mpi->row_boxes[i].bytes;
  return bytes;
}

/* Adds so many bytes to a box. */
static TetcastStatus put(TetcastMpi *mpi, TcMpiBuffer *box, const void *from, int64_t bytes) {
  const TetcastStatus status = tc_mpi_grow(mpi, box, box->bytes + bytes);
  if (status || bytes == 0)
    return status;
  memcpy(box->data + box->bytes, from, (size_t)bytes);
  box->bytes += bytes;
  return TETCAST_OK;
}

/* Fragments of one unit, list[begin, end), go to one rank, in which its pixels are in a row. */
static TetcastStatus post_unit(TetcastMpi *mpi, const TcMpiBand *band, const TetcastFragmentList *list, int64_t begin,
                               int64_t end) {
  const TetcastFragment *from = list->data + begin;
  const int64_t x = from->pixel % band->width, unit = from->pixel / band->width * band->units + x / TC_MPI_UNIT;
  const int64_t moved = unit / mpi->size * TC_MPI_UNIT + x % TC_MPI_UNIT - from->pixel, count = end - begin;
  TcMpiBuffer *box = &mpi->outboxes[unit % mpi->size];
  TetcastStatus status = put(mpi, box, from, count * (int64_t)sizeof *from);
  if (status)
    return status;
  TetcastFragment *to = (TetcastFragment *)(void *)(box->data + box->bytes) - count;
  for (int64_t i = 0; i < count; ++i)
    to[i].pixel += moved;
  if (mpi->groups == 0)
    return TETCAST_OK;
  return put(mpi, &mpi->row_boxes[unit % mpi->size], list->groups + 2 * mpi->groups * begin, count * row_size(mpi));
}

TetcastStatus tc_mpi_post(TetcastMpi *mpi, const TcMpiBand *band, TetcastFragmentList list) {
  for (int64_t begin = 0, end; begin < list.count; begin = end) {
    const int64_t pixel = list.data[begin].pixel, x = pixel % band->width, row_end = pixel - x + band->width;
    int64_t unit_end = pixel - x % TC_MPI_UNIT + TC_MPI_UNIT;
    if (unit_end > row_end)
      unit_end = row_end;
    for (end = begin + 1; end < list.count && list.data[end].pixel < unit_end;)
      ++end;
    const TetcastStatus status = post_unit(mpi, band, &list, begin, end);
    if (status)
      return status;
  }
  return TETCAST_OK;
}

/* How many bytes the rows of so many bytes of fragments have. */
static int64_t rows_of(const TetcastMpi *mpi, int64_t bytes) {
  return bytes / (int64_t)sizeof(TetcastFragment) * row_size(mpi);
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
    requests += tc_mpi_pieces(rows_of(mpi, sent[i])) + tc_mpi_pieces(rows_of(mpi, received[i]));
  }
  status = tc_mpi_grow(mpi, &mpi->inbox, bytes);
  if (!status)
    status = tc_mpi_grow(mpi, &mpi->row_inbox, rows_of(mpi, bytes));
  mpi->inbox.bytes = status ? 0 : bytes;
  mpi->row_inbox.bytes = rows_of(mpi, mpi->inbox.bytes);
  return status ? status : tc_mpi_reserve(mpi, requests);
}

/* From each rank come fragments, and then their rows. */
TetcastStatus tc_mpi_exchange(TetcastMpi *mpi) {
  const int64_t *received = mpi->counts + mpi->size;
  TetcastStatus status = TETCAST_OK;
  for (int64_t i = 0, at = 0; !status && i < mpi->size; at += received[i++]) {
    status = tc_mpi_start_receive(mpi, (int)i, mpi->inbox.data + at, received[i]);
    if (!status && mpi->groups > 0)
      status = tc_mpi_start_receive(mpi, (int)i, mpi->row_inbox.data + rows_of(mpi, at), rows_of(mpi, received[i]));
  }
  /* Each begins with the rank that follows it, so that not all send to the same one. */
  for (int i = 1; !status && i < mpi->size; ++i) {
    const int to = (mpi->rank + i) % mpi->size;
    status = tc_mpi_start_send(mpi, to, mpi->outboxes[to].data, mpi->outboxes[to].bytes);
    if (!status && mpi->groups > 0)
      status = tc_mpi_start_send(mpi, to, mpi->row_boxes[to].data, mpi->row_boxes[to].bytes);
  }
  const TetcastStatus finished = tc_mpi_finish(mpi);
  return status ? status : finished;
}

/* Cuts what lies in a box, and in that of its rows, into lists of ascending pixels: a new one begins where pixels
 * descend. `lists` may be NULL. Returns how many. */
static int64_t cut_lists(const TetcastMpi *mpi, const TcMpiBuffer *box, const TcMpiBuffer *rows,
                         TetcastFragmentList *lists) {
  const TetcastFragment *fragments = (const TetcastFragment *)(const void *)box->data;
  const int64_t count = box->bytes / (int64_t)sizeof *fragments;
  int64_t lists_count = 0;
  for (int64_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && fragments[end].pixel >= fragments[end - 1].pixel;)
      ++end;
    if (lists) {
      lists[lists_count] = (TetcastFragmentList){.data = fragments + begin, .count = end - begin};
      lists[lists_count].group_count = mpi->groups;
      if (mpi->groups > 0)
        lists[lists_count].groups = (const double *)(const void *)rows->data + 2 * mpi->groups * begin;
    }
    ++lists_count;
  }
  return lists_count;
}

TetcastStatus tc_mpi_lists(TetcastMpi *mpi, TetcastFragmentList **lists, int64_t *count) {
  const TcMpiBuffer *own = &mpi->outboxes[mpi->rank], *own_rows = &mpi->row_boxes[mpi->rank];
  const int64_t of_own = cut_lists(mpi, own, own_rows, NULL);
  *count = of_own + cut_lists(mpi, &mpi->inbox, &mpi->row_inbox, NULL);
  *lists = calloc((size_t)*count + 1, sizeof **lists);
  if (!*lists)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: fragments", mpi->rank);
  cut_lists(mpi, own, own_rows, *lists);
  cut_lists(mpi, &mpi->inbox, &mpi->row_inbox, *lists + of_own);
  return TETCAST_OK;
}

/* ── pixels ── */

TcMpiPlanes tc_mpi_planes(const TcMpiView *view) {
  const int64_t number = view->type == TETCAST_TYPE_FLOAT32 ? sizeof(float) : sizeof(double);
  TcMpiPlanes planes = {.count = 1, .size = {4 * number}, .bytes = 4 * number};
  const TetcastChannelInfo *info;
  for (int i = 0; (info = tetcast_channel_info(i)) && planes.count < TC_MPI_PLANES; ++i) {
    if (!(view->channels & info->channel))
      continue;
    planes.channel[planes.count] = info->channel;
    planes.size[planes.count] = number * (info->of_groups ? view->frame_groups : info->components);
    planes.bytes += planes.size[planes.count++];
  }
  return planes;
}

/* The data of a plane, and the bytes from row to row. */
static char *plane_of(const TetcastFrame *frame, const TcMpiPlanes *planes, int plane, int64_t *stride) {
  *stride = plane == 0 ? tetcast_frame_row_stride(frame) : tetcast_frame_width(frame) * planes->size[plane];
  return (char *)(uintptr_t)(plane == 0 ? tetcast_frame_pixels(frame)
                                        : tetcast_frame_channel(frame, planes->channel[plane]));
}

TetcastStatus tc_mpi_prepare_gather(TetcastMpi *mpi, const TcMpiBand *band, const TcMpiPlanes *planes) {
  int64_t bytes = 0, requests = 0;
  for (int i = 0; i < mpi->size; ++i) {
    const int64_t pixels = tc_mpi_owned(band, i, mpi->size) * TC_MPI_UNIT;
    if (mpi->rank == 0 && i > 0)
      bytes += pixels * planes->bytes;
    for (int p = 0; (mpi->rank == 0 || i == mpi->rank) && p < planes->count; ++p)
      requests += tc_mpi_pieces(pixels * planes->size[p]);
  }
  const TetcastStatus status = tc_mpi_grow(mpi, &mpi->pixels, bytes);
  mpi->pixels.bytes = status ? 0 : bytes;
  return status ? status : tc_mpi_reserve(mpi, requests);
}

/* Puts a plane of a rank's units where it belongs. The frame's pixels are const only to those who look at pictures;
 * this is who makes them. */
static void put_units(const TetcastMpi *mpi, const TcMpiBand *band, int rank, const TcMpiPlanes *planes, int plane,
                      const char *from, TetcastFrame *frame) {
  int64_t stride;
  char *to = plane_of(frame, planes, plane, &stride);
  const int64_t size = planes->size[plane], owned = tc_mpi_owned(band, rank, mpi->size);
  for (int64_t i = 0; i < owned; ++i) {
    const int64_t unit = i * mpi->size + rank, x = unit % band->units * TC_MPI_UNIT;
    const int64_t count = band->width - x < TC_MPI_UNIT ? band->width - x : TC_MPI_UNIT;
    if (count > 0)
      memcpy(to + (band->first + unit / band->units) * stride + x * size, from + i * TC_MPI_UNIT * size,
             (size_t)(count * size));
  }
}

/* The bytes that a rank's units have in a plane. */
static int64_t units_bytes(const TetcastMpi *mpi, const TcMpiBand *band, int rank, int64_t size) {
  return tc_mpi_owned(band, rank, mpi->size) * TC_MPI_UNIT * size;
}

TetcastStatus tc_mpi_gather(TetcastMpi *mpi, const TcMpiBand *band, const TcMpiPlanes *planes, const TetcastFrame *own,
                            TetcastFrame *frame) {
  TetcastStatus status = TETCAST_OK;
  int64_t at = 0, stride;
  for (int p = 0; mpi->rank > 0 && own && !status && p < planes->count; ++p)
    status = tc_mpi_start_send(mpi, 0, plane_of(own, planes, p, &stride),
                               units_bytes(mpi, band, mpi->rank, planes->size[p]));
  for (int i = 1; mpi->rank == 0 && i < mpi->size; ++i) {
    for (int p = 0; !status && p < planes->count; ++p) {
      const int64_t bytes = units_bytes(mpi, band, i, planes->size[p]);
      status = tc_mpi_start_receive(mpi, i, mpi->pixels.data + at, bytes);
      at += bytes;
    }
  }
  const TetcastStatus finished = tc_mpi_finish(mpi);
  if (status || finished)
    return status ? status : finished;
  at = 0;
  for (int i = 0; mpi->rank == 0 && i < mpi->size; ++i) {
    for (int p = 0; p < planes->count; ++p) {
      if (i == 0 && own)
        put_units(mpi, band, 0, planes, p, plane_of(own, planes, p, &stride), frame);
      if (i == 0)
        continue;
      put_units(mpi, band, i, planes, p, mpi->pixels.data + at, frame);
      at += units_bytes(mpi, band, i, planes->size[p]);
    }
  }
  return TETCAST_OK;
}
