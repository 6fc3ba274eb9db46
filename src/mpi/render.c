/* SPDX-License-Identifier: Apache-2.0 */
/* A picture, band by band: each rank renders its parts to fragments, these go to those who own their pixels, who
 * composite them, and pixels go to rank 0. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "share.h"

/* Of the memory, bands are to take so much, as their rows may have more than is expected. */
static const double filling = 0.9;

/* Before a picture from elsewhere there is a trial one, smaller by this in both directions. */
enum { TRIAL = 16 };

/* What rank 0 wants, and all get. */
typedef struct Order {
  TcMpiView view;
  TetcastRenderDesc desc;
  int known; /* not 0: the last picture was taken from there as well, and tells how much memory this one needs */
} Order;

/* What is said of progress: that of this rank's own scenes, each of which has its share of the band. */
typedef struct Told {
  TetcastProgress user;
  double begin, share, reached;
} Told;

typedef struct Picture {
  TetcastMpi *mpi;
  const TetcastScene *const *scenes;
  int64_t count;
  Order order;
  TcMpiPlanes planes;
  TetcastFrame *frame; /* at rank 0 */
  Told told;
  /* What has gone wrong since ranks last agreed: they may wait for this one, which goes on until they do it again. */
  TetcastStatus pending;
  TetcastMpiStats stats; /* of this rank */
} Picture;

/* ── the order ── */

static TetcastStatus check_parts(TetcastMpi *mpi, const TetcastScene *const *scenes, int64_t count) {
  if (count < 0 || (count > 0 && !scenes))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%" PRId64 " scenes%s", count,
                                 scenes ? "" : " that are NULL");
  for (int64_t i = 0; i < count; ++i) {
    if (!scenes[i])
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "scene %" PRId64 " of rank %d is NULL", i,
                                   mpi->rank);
  }
  return TETCAST_OK;
}

static TetcastStatus check_frame(TetcastMpi *mpi, const TetcastFrame *frame) {
  if (!frame)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "frame is NULL at rank 0");
  const TetcastChannelInfo *info;
  for (int i = 0; (info = tetcast_channel_info(i)); ++i) {
    if (tetcast_frame_channel(frame, info->channel) && !info->needs_coefficients)
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "the channel %s is not possible with parts on several ranks", info->name);
  }
  return TETCAST_OK;
}

/* Notes what a pixel of the frame has. */
static void note_channels(const TetcastFrame *frame, TcMpiView *view) {
  const TetcastChannelInfo *info;
  view->type = tetcast_frame_type(frame);
  view->frame_groups = 1;
  for (int i = 0; (info = tetcast_channel_info(i)); ++i) {
    if (tetcast_frame_channel(frame, info->channel)) {
      view->channels |= info->channel;
      view->frame_groups = tetcast_frame_groups(frame);
    }
  }
}

static TetcastStatus set_order(TetcastMpi *mpi, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                               const TetcastFrame *frame, Order *order) {
  TetcastStatus status = check_frame(mpi, frame);
  if (!status && !camera)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "camera is NULL at rank 0");
  if (!status && (desc->stop || desc->start))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "stop and start are not possible with parts on several ranks");
  if (status)
    return status;
  TcMpiView view = {.camera = *camera,
                    .width = tetcast_frame_width(frame),
                    .height = tetcast_frame_height(frame),
                    .picture_height = desc->picture_height ? desc->picture_height : tetcast_frame_height(frame),
                    .first_row = desc->first_row};
  note_channels(frame, &view);
  *order = (Order){.view = view, .desc = *desc};
  order->known = mpi->bytes_per_pixel > 0 && memcmp(&view, &mpi->view, sizeof view) == 0;
  memcpy(&mpi->view, &view, sizeof view);
  const int64_t rows = order->view.picture_height - order->view.height;
  if (order->view.first_row < 0 || order->view.first_row > rows)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                 "%" PRId64 " rows from row %" PRId64 " of a picture that has %" PRId64,
                                 order->view.height, order->view.first_row, order->view.picture_height);
  return TETCAST_OK;
}

/* The largest number of groups of this rank's scenes, and the smallest times −1; INT64_MIN where there is none. And the
 * same of their looks. */
static void find_looks(const Picture *picture, int64_t groups[2], int64_t looks[2]) {
  groups[0] = groups[1] = looks[0] = looks[1] = INT64_MIN;
  for (int64_t i = 0; i < picture->count; ++i) {
    const int64_t own = tetcast_scene_groups(picture->scenes[i]), look = tetcast_scene_look(picture->scenes[i]);
    groups[0] = own > groups[0] ? own : groups[0];
    groups[1] = -own > groups[1] ? -own : groups[1];
    looks[0] = look > looks[0] ? look : looks[0];
    looks[1] = -look > looks[1] ? -look : looks[1];
  }
}

/* Whether all scenes show the same, in as many groups, and the frame has as many, by the largest of all ranks' two
 * numbers each. All ranks come to the same here. */
static TetcastStatus check_looks(Picture *picture, const int64_t groups[2], const int64_t looks[2]) {
  TetcastMpi *mpi = picture->mpi;
  Order *order = &picture->order;
  const TcMpiView *view = &order->view;
  const bool none = groups[0] == INT64_MIN; /* there are no scenes */
  const int64_t count = none ? view->frame_groups : groups[0];
  if (!none && groups[0] != -groups[1])
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                 "scenes of %" PRId64 " groups and of %" PRId64 ": all must have the same coefficients",
                                 -groups[1], groups[0]);
  if (!none && looks[0] != -looks[1])
    return tetcast_context_error(
        mpi->context, TETCAST_ERROR_ARGUMENT,
        "not all scenes show the same: transfer functions, isosurfaces, their light and slices "
        "must be those of all ranks");
  const TetcastChannelInfo *info;
  for (int i = 0; (info = tetcast_channel_info(i)); ++i) {
    if (view->channels & info->channel && count == 0)
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "with a transfer function there is no channel %s", info->name);
    if (view->channels & info->channel && info->of_groups && view->frame_groups != count)
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "a frame of %" PRId64 " groups, but the scenes have %" PRId64, view->frame_groups,
                                   count);
  }
  order->known = order->known && mpi->groups == count;
  mpi->groups = (int)count;
  picture->planes = tc_mpi_planes(view);
  return TETCAST_OK;
}

/* Brings rank 0's order to all, with the smallest memory and instruction set of all. */
static TetcastStatus share_order(Picture *picture, const TetcastCamera *camera, const TetcastRenderDesc *desc) {
  TetcastMpi *mpi = picture->mpi;
  const TetcastRenderDesc defaults = tetcast_render_desc_default();
  Order *order = &picture->order;
  TetcastStatus status = check_parts(mpi, picture->scenes, picture->count);
  if (!desc)
    desc = &defaults;
  if (!status && desc->cookie != defaults.cookie)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "desc was not made by tetcast_render_desc_default()");
  if (!status && mpi->rank == 0)
    status = set_order(mpi, camera, desc, picture->frame, order);
  const int64_t isa = desc->isa == TETCAST_ISA_AUTO ? TETCAST_ISA_AVX512 : desc->isa;
  int64_t least[6] = {-mpi->memory, -isa};
  if (!status)
    find_looks(picture, least + 2, least + 4);
  status = tc_mpi_agree(mpi, status, least, 6);
  if (!status)
    status = tc_mpi_broadcast(mpi, 0, order, sizeof *order);
  mpi->memory = status ? mpi->memory : -least[0];
  order->desc.isa = (TetcastIsa)-least[1];
  if (mpi->isa != TETCAST_ISA_AUTO && mpi->isa < order->desc.isa)
    order->desc.isa = mpi->isa;
  picture->told.user = desc->progress;
  return status ? status : check_looks(picture, least + 2, least + 4);
}

/* ── a rank's own parts ── */

static bool tell(void *data, double fraction) {
  Told *told = data;
  told->reached = fmin(1, fmax(told->reached, told->begin + told->share * fraction));
  return !told->user.function || told->user.function(told->user.user, told->reached);
}

/* What a band has needed, and found, on this rank. */
typedef struct Yield {
  int64_t memory, fragments, segments, lost;
  int64_t isa[2]; /* tc_mpi_note_isa() */
} Yield;

static TetcastStatus render_part(Picture *picture, const TcMpiBand *band, const TetcastScene *scene, Yield *yield) {
  TetcastMpi *mpi = picture->mpi;
  TetcastRenderDesc desc = picture->order.desc;
  TetcastRenderStats stats;
  desc.picture_height = picture->order.view.picture_height;
  desc.first_row = picture->order.view.first_row + band->first;
  desc.progress = (TetcastProgress){tell, &picture->told};
  TetcastStatus status = mpi->fragments ? TETCAST_OK : tetcast_fragments_create(mpi->context, &mpi->fragments);
  if (!status)
    status = tetcast_scene_render_fragments(scene, &picture->order.view.camera, &desc, band->width, band->rows,
                                            mpi->fragments, &stats);
  if (status)
    return status;
  const TetcastFragmentList list = tetcast_fragments_list(mpi->fragments);
  const int64_t needed =
      2 * list.count * tc_mpi_fragment_size(mpi) + band->width * band->rows * (int64_t)sizeof(int64_t);
  yield->memory = yield->memory > needed ? yield->memory : needed;
  yield->fragments += list.count;
  yield->segments += stats.segments;
  yield->lost += stats.lost;
  tc_mpi_note_isa(stats.isa, yield->isa);
  return tc_mpi_post(mpi, band, list);
}

/* Renders all parts into the boxes. */
static TetcastStatus render_parts(Picture *picture, const TcMpiBand *band, Yield *yield) {
  TetcastMpi *mpi = picture->mpi;
  TetcastStatus status = TETCAST_OK;
  const double height = (double)picture->order.view.height, begin = (double)band->first / height;
  const double share = (double)band->rows / height;
  for (int i = 0; i < mpi->size; ++i)
    mpi->outboxes[i].bytes = mpi->row_boxes[i].bytes = 0;
  for (int64_t i = 0; !status && i < picture->count; ++i) {
    picture->told.begin = begin + share * (double)i / (double)picture->count;
    picture->told.share = share / (double)picture->count;
    status = render_part(picture, band, picture->scenes[i], yield);
  }
  picture->told.begin = begin;
  picture->told.share = share;
  if (!status && !tell(&picture->told, 1))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_CANCELLED, "cancelled");
  for (int i = 0; i < mpi->size; ++i) {
    yield->memory += mpi->outboxes[i].bytes + mpi->row_boxes[i].bytes;
    if (status)
      mpi->outboxes[i].bytes = mpi->row_boxes[i].bytes = 0;
  }
  return status;
}

/* ── a band ── */

/* The frame of a rank's own units. */
static TetcastStatus create_units(const Picture *picture, const TcMpiBand *band, TetcastFrame **frame) {
  const TetcastMpi *mpi = picture->mpi;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = TC_MPI_UNIT;
  desc.height = tc_mpi_owned(band, mpi->rank, mpi->size);
  desc.type = (TetcastType)picture->order.view.type;
  desc.channels = (uint32_t)picture->order.view.channels;
  desc.groups = (int)picture->order.view.frame_groups;
  return desc.height > 0 ? tetcast_frame_create(mpi->context, &desc, frame) : TETCAST_OK;
}

static TetcastStatus composite(Picture *picture, TetcastFrame *units) {
  TetcastFragmentList *lists = NULL;
  int64_t count = 0;
  double overlap = 0;
  if (!units)
    return TETCAST_OK;
  TetcastStatus status = tc_mpi_lists(picture->mpi, &lists, &count);
  if (!status)
    status = tetcast_fragments_composite(picture->mpi->context, lists, count, units, &overlap);
  free(lists);
  picture->stats.overlap = fmax(picture->stats.overlap, overlap);
  return status;
}

/* The exchange of a band that all have rendered, and what follows. No rank may leave it early. */
static TetcastStatus finish_band(Picture *picture, const TcMpiBand *band, TetcastFrame *units) {
  TetcastMpi *mpi = picture->mpi;
  TetcastMpiStats *stats = &picture->stats;
  const int64_t unit_bytes = TC_MPI_UNIT * picture->planes.bytes;
  const int64_t pixels = mpi->rank > 0 ? tc_mpi_owned(band, mpi->rank, mpi->size) * unit_bytes : 0;
  const double begin = MPI_Wtime();
  TetcastStatus status = tc_mpi_exchange(mpi);
  if (status)
    return status;
  const double exchanged = MPI_Wtime();
  status = composite(picture, units);
  const double composited = MPI_Wtime();
  const TetcastStatus gathered = tc_mpi_gather(mpi, band, &picture->planes, units, picture->frame);
  stats->exchange_seconds += exchanged - begin;
  stats->composite_seconds += composited - exchanged;
  stats->gather_seconds += MPI_Wtime() - composited;
  stats->bytes += tc_mpi_sent(mpi) + pixels;
  stats->most_bytes += tc_mpi_sent(mpi) + mpi->inbox.bytes + mpi->row_inbox.bytes + pixels + mpi->pixels.bytes;
  return status ? status : gathered;
}

/* How a band that all ranks have rendered goes on. */
typedef enum Verdict { VERDICT_GOOD, VERDICT_TOO_LARGE, VERDICT_OTHER_ISA } Verdict;

/* Agrees on that, and on the most memory that a rank needs for it. */
static TetcastStatus judge(Picture *picture, TetcastStatus own, const TcMpiBand *band, const Yield *yield,
                           Verdict *verdict, int64_t *memory) {
  TetcastMpi *mpi = picture->mpi;
  int64_t most[3] = {*memory, yield->isa[0], yield->isa[1]};
  const TetcastStatus status = tc_mpi_agree(mpi, own, most, 3);
  if (status)
    return status;
  *memory = most[0];
  *verdict = tc_mpi_one_isa(mpi, most + 1) ? VERDICT_GOOD : VERDICT_OTHER_ISA;
  if (most[1] != INT64_MIN) /* it was that, or is to be */
    picture->order.desc.isa = (TetcastIsa)-most[2];
  if (*verdict == VERDICT_GOOD && *memory > mpi->memory && band->rows > TC_MPI_ROWS)
    *verdict = VERDICT_TOO_LARGE;
  return TETCAST_OK;
}

/* Renders a band, and, if nothing speaks against it, completes it. `memory`: the most that a rank needs for it. */
static TetcastStatus make_band(Picture *picture, const TcMpiBand *band, Verdict *verdict, int64_t *memory) {
  TetcastMpi *mpi = picture->mpi;
  TetcastMpiStats *stats = &picture->stats;
  TetcastFrame *units = NULL;
  Yield yield = {.isa = {INT64_MIN, INT64_MIN}};
  const double begin = MPI_Wtime();
  TetcastStatus status = picture->pending ? picture->pending : render_parts(picture, band, &yield);
  const double rendered = MPI_Wtime();
  const TetcastStatus announced = tc_mpi_announce(mpi);
  status = status ? status : announced;
  if (!status)
    status = tc_mpi_prepare_gather(mpi, band, &picture->planes);
  if (!status)
    status = create_units(picture, band, &units);
  const int64_t units_bytes = tc_mpi_owned(band, mpi->rank, mpi->size) * TC_MPI_UNIT * picture->planes.bytes;
  *memory = yield.memory + mpi->inbox.bytes + mpi->row_inbox.bytes + mpi->pixels.bytes + units_bytes;
  stats->render_seconds += rendered - begin;
  status = judge(picture, status, band, &yield, verdict, memory);
  stats->wait_seconds += MPI_Wtime() - rendered;
  if (!status && *verdict == VERDICT_GOOD) {
    stats->fragments += yield.fragments;
    stats->segments += yield.segments;
    stats->lost += yield.lost;
    ++stats->bands;
    stats->memory = stats->memory > *memory ? stats->memory : *memory;
    picture->pending = finish_band(picture, band, units);
  }
  tetcast_frame_destroy(&units);
  return status;
}

/* ── the picture ── */

/* So many rows, or fewer, in whole steps. */
static int64_t whole_steps(int64_t rows) {
  return rows > TC_MPI_ROWS ? rows / TC_MPI_ROWS * TC_MPI_ROWS : TC_MPI_ROWS;
}

/* How many rows fit, by what a pixel has needed so far. */
static int64_t rows_that_fit(const Picture *picture, double bytes_per_pixel) {
  const double rows = filling * (double)picture->mpi->memory / (bytes_per_pixel * (double)picture->order.view.width);
  return rows >= (double)picture->order.view.height ? picture->order.view.height : whole_steps((int64_t)rows);
}

/* How many fragments a pixel of the trial picture's densest row has on this rank: of all scenes, and of the scene that
 * has most. */
typedef struct Density {
  double all, one;
} Density;

static TetcastStatus try_scene(Picture *picture, const TetcastScene *scene, int64_t *rows, Density *density) {
  TetcastMpi *mpi = picture->mpi;
  const Order *order = &picture->order;
  const int64_t width = (order->view.width + TRIAL - 1) / TRIAL,
                height = (order->view.picture_height + TRIAL - 1) / TRIAL;
  TetcastRenderDesc desc = order->desc;
  desc.picture_height = desc.first_row = 0;
  desc.progress = (TetcastProgress){NULL, NULL}; /* rank 0's own */
  TetcastStatus status = mpi->fragments ? TETCAST_OK : tetcast_fragments_create(mpi->context, &mpi->fragments);
  if (!status)
    status = tetcast_scene_render_fragments(scene, &order->view.camera, &desc, width, height, mpi->fragments, NULL);
  if (status)
    return status;
  const TetcastFragmentList list = tetcast_fragments_list(mpi->fragments);
  for (int64_t begin = 0, end; begin < list.count; begin = end) {
    const int64_t row = list.data[begin].pixel / width;
    for (end = begin + 1; end < list.count && list.data[end].pixel < (row + 1) * width;)
      ++end;
    rows[row] += end - begin;
    density->one = fmax(density->one, (double)(end - begin) / (double)width);
    density->all = fmax(density->all, (double)rows[row] / (double)width);
  }
  return TETCAST_OK;
}

/* Finds how many bytes a pixel of the densest rows will need on the rank that needs most, by the trial picture: twice
 * the fragments of one scene, where they are rendered, all of the rank's own, and as many of others at most, as these
 * are shared out evenly; a count, and the pixel itself twice. */
static TetcastStatus try_out(Picture *picture, double *bytes_per_pixel) {
  TetcastMpi *mpi = picture->mpi;
  Density density = {0, 0};
  const int64_t height = (picture->order.view.picture_height + TRIAL - 1) / TRIAL;
  int64_t *rows = calloc((size_t)height, sizeof *rows);
  TetcastStatus status = TETCAST_OK;
  if (!rows)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: rows", mpi->rank);
  for (int64_t i = 0; !status && i < picture->count; ++i)
    status = try_scene(picture, picture->scenes[i], rows, &density);
  free(rows);
  int64_t bytes = (int64_t)ceil((2 * density.one + 2 * density.all) * (double)tc_mpi_fragment_size(mpi));
  status = tc_mpi_agree(mpi, status, &bytes, 1);
  *bytes_per_pixel = (double)(bytes + (int64_t)sizeof(int64_t) + 2 * picture->planes.bytes);
  return status;
}

/* All ranks come to the same numbers here, as they come from what they have agreed upon: what the densest rows have
 * needed, of this picture and, at its beginning, of the last or the trial one. */
static TetcastStatus make_bands(Picture *picture) {
  TetcastMpi *mpi = picture->mpi;
  const Order *order = &picture->order;
  double most = 0, expected = mpi->bytes_per_pixel;
  TetcastStatus status = order->known ? TETCAST_OK : try_out(picture, &expected);
  for (int64_t first = 0; !status && first < order->view.height;) {
    Verdict verdict;
    int64_t memory;
    const int64_t left = order->view.height - first, rows = rows_that_fit(picture, expected);
    const TcMpiBand band = tc_mpi_band(mpi, order->view.width, first, rows < left ? rows : left);
    status = make_band(picture, &band, &verdict, &memory);
    if (status || verdict == VERDICT_OTHER_ISA)
      continue;
    const double needed = (double)memory / ((double)band.rows * (double)band.width);
    expected = fmax(expected, needed);
    if (verdict == VERDICT_TOO_LARGE) {
      ++picture->stats.redone;
      tc_mpi_forget(mpi);
      continue;
    }
    first += band.rows;
    most = fmax(most, needed);
  }
  if (!status)
    status = tc_mpi_agree(mpi, picture->pending, NULL, 0);
  if (!status)
    mpi->bytes_per_pixel = most;
  return status;
}

static const char *isa_name(TetcastIsa isa) {
  return isa == TETCAST_ISA_AVX512 ? "avx512" : isa == TETCAST_ISA_AVX2 ? "avx2" : "scalar";
}

/* What all ranks have done. */
static TetcastStatus share_stats(Picture *picture, TetcastMpiStats *result) {
  TetcastMpi *mpi = picture->mpi;
  TetcastMpiStats *stats = &picture->stats;
  int64_t sums[4] = {stats->segments, stats->lost, stats->fragments, stats->bytes}, all[4];
  double largest[7] = {stats->overlap,           stats->render_seconds,    stats->wait_seconds,
                       stats->exchange_seconds,  stats->composite_seconds, stats->gather_seconds,
                       (double)stats->most_bytes},
         most[7];
  TetcastStatus status =
      tc_mpi_check(mpi, MPI_Allreduce(sums, all, 4, MPI_INT64_T, MPI_SUM, mpi->comm), "MPI_Allreduce");
  if (!status)
    status = tc_mpi_check(mpi, MPI_Allreduce(largest, most, 7, MPI_DOUBLE, MPI_MAX, mpi->comm), "MPI_Allreduce");
  if (!status && result)
    *result = (TetcastMpiStats){.segments = all[0],
                                .lost = all[1],
                                .fragments = all[2],
                                .overlap = most[0],
                                .bytes = all[3],
                                .most_bytes = (int64_t)most[6],
                                .memory = stats->memory,
                                .bands = stats->bands,
                                .redone = stats->redone,
                                .render_seconds = most[1],
                                .wait_seconds = most[2],
                                .exchange_seconds = most[3],
                                .composite_seconds = most[4],
                                .gather_seconds = most[5],
                                .isa = isa_name(picture->order.desc.isa)};
  return status;
}

TetcastStatus tetcast_mpi_render(TetcastMpi *mpi, const TetcastScene *const *scenes, int64_t count,
                                 const TetcastCamera *camera, const TetcastRenderDesc *desc, TetcastFrame *frame,
                                 TetcastMpiStats *stats) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  Picture picture = {.mpi = mpi, .scenes = scenes, .count = count, .frame = frame};
  TetcastStatus status = share_order(&picture, camera, desc);
  if (!status)
    status = make_bands(&picture);
  if (status)
    return status;
  return share_stats(&picture, stats);
}
