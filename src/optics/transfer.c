/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/transfer.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* A list of knots: `width` doubles each, the scalar first. */
typedef struct Knots {
  const double *data;
  int64_t count;
  int width;
} Knots;

static TetcastStatus check_knots(TetcastContext *context, const Knots *knots, const char *what, double largest) {
  if (!knots->data || knots->count < 1) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s needs at least one knot", what);
  }
  for (int64_t i = 0; i < knots->count; ++i) {
    const double *knot = knots->data + i * knots->width;
    for (int k = 0; k < knots->width; ++k) {
      if (!isfinite(knot[k])) {
        return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s knot %" PRId64 " is not finite", what, i);
      }
      if (k > 0 && (knot[k] < 0 || knot[k] > largest)) {
        return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s knot %" PRId64 " at %g is %s: %g", what, i,
                        knot[0], knot[k] < 0 ? "negative" : "above 1", knot[k]);
      }
    }
    if (i > 0 && knot[0] < knot[-knots->width]) {
      return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s knots are not sorted: knot %" PRId64
                      " at %g comes after %g", what, i, knot[0], knot[-knots->width]);
    }
    if (i > 1 && knot[0] == knot[-2 * knots->width]) {
      return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s has more than two knots at %g", what, knot[0]);
    }
  }
  return TETCAST_OK;
}

static void interpolate(const Knots *knots, int64_t i, double x, double *values) {
  const double *a = knots->data + i * knots->width, *b = a + knots->width;
  const double part = isfinite(b[0] - a[0]) ? 1 : 0.5; /* halves of differences that are too large */
  const double whole = part * b[0] - part * a[0], w = (part * x - part * a[0]) / whole,
               v = (part * b[0] - part * x) / whole;
  for (int k = 1; k < knots->width; ++k) values[k - 1] = v * a[k] + w * b[k];
}

/* Values just above x. */
static void limit_above(const Knots *knots, double x, double *values) {
  int64_t i = 0; /* first knot > x */
  while (i < knots->count && knots->data[i * knots->width] <= x) ++i;
  if (i > 0 && (i == knots->count || knots->data[(i - 1) * knots->width] == x)) --i;
  else if (i > 0) {
    interpolate(knots, i - 1, x, values);
    return;
  }
  memcpy(values, knots->data + i * knots->width + 1, (size_t)(knots->width - 1) * sizeof *values);
}

/* Values just below x. */
static void limit_below(const Knots *knots, double x, double *values) {
  int64_t i = 0; /* first knot ≥ x */
  while (i < knots->count && knots->data[i * knots->width] < x) ++i;
  if (i == knots->count) --i;
  else if (i > 0 && knots->data[i * knots->width] != x) {
    interpolate(knots, i - 1, x, values);
    return;
  }
  memcpy(values, knots->data + i * knots->width + 1, (size_t)(knots->width - 1) * sizeof *values);
}

static TcOptics optics_limit(const Knots *extinction, const Knots *color, double x,
                             void limit(const Knots *, double, double *)) {
  TcOptics optics;
  limit(extinction, x, &optics.extinction);
  limit(color, x, optics.color);
  return optics;
}

/* The scalars of both lists, those beyond ±limit brought there, that are distinct times 2^−exponent. */
static int64_t merge_knots(const Knots *a, const Knots *b, double limit, int exponent, double *merged) {
  int64_t i = 0, j = 0, n = 0;
  while (i < a->count || j < b->count) {
    const double x = i < a->count ? a->data[i * a->width] : INFINITY, y = j < b->count ? b->data[j * b->width] : INFINITY;
    const double next = fmax(-limit, fmin(x <= y ? x : y, limit));
    if (x <= y) ++i;
    else ++j;
    if (n == 0 || ldexp(merged[n - 1], -exponent) != ldexp(next, -exponent))
      ++n;
    merged[n - 1] = next;
  }
  return n;
}

static bool is_empty(const TcPiece *piece) { return piece->at_low.extinction == 0 && piece->at_high.extinction == 0; }

/* Where rays go from piece i, the next above or below: several pieces without extinction are passed at once. −1, count + 1: none. */
static double next_piece(const TcPieces *pieces, int64_t i, int step) {
  const int64_t next = i + step, second = next + step;
  if (second < 0 || second > pieces->count || !is_empty(&pieces->pieces[next]) || !is_empty(&pieces->pieces[second])) return (double)next;
  return step > 0 ? pieces->pieces[next].filled_above : pieces->pieces[next].filled_below;
}

static void make_row(const TcPieces *pieces, int64_t i, double row[TC_PIECE_WORDS]) {
  const TcPiece *piece = &pieces->pieces[i];
  const TcOptics *a = &piece->at_low, *b = &piece->at_high;
  const bool constant = piece->constant;
  const double words[TC_PIECE_WORDS] = {piece->low, piece->high, constant ? 0 : piece->low, constant ? 0 : piece->high, piece->inverse, constant,
                                        a->extinction, b->extinction, a->color[0], a->color[1], a->color[2], b->color[0], b->color[1], b->color[2],
                                        next_piece(pieces, i, 1), next_piece(pieces, i, -1)};
  memcpy(row, words, sizeof words);
}

static void make_single_row(const TcPiece *piece, const double row[TC_PIECE_WORDS], float single[TC_PIECE_WORDS]) {
  const TcOptics *a = &piece->at_low, *b = &piece->at_high;
  const double words[TC_PIECE_WORDS] = {row[0], row[1], row[2], a->extinction, (b->extinction - a->extinction) * piece->inverse, a->color[0],
                                        a->color[1], a->color[2], (b->color[0] - a->color[0]) * piece->inverse,
                                        (b->color[1] - a->color[1]) * piece->inverse, (b->color[2] - a->color[2]) * piece->inverse, row[14], row[15]};
  for (int k = 0; k < TC_PIECE_WORDS; ++k) single[k] = (float)fmax(-FLT_MAX, fmin(words[k], FLT_MAX)); /* beyond: not used (tolerance.h) */
}

/* What follows from the pieces as they are. */
static void look_at_pieces(TetcastTransferFunction *transfer) {
  TcPieces *pieces = &transfer->pieces;
  memset(pieces->largest, 0, sizeof pieces->largest);
  pieces->narrow = false;
  pieces->one_color = true;
  double above = (double)pieces->count + 1, below = -1;
  for (int64_t i = pieces->count; i >= 0; --i) {
    if (!is_empty(&transfer->piece[i])) above = (double)i;
    transfer->piece[i].filled_above = above;
  }
  for (int64_t i = 0; i <= pieces->count; ++i) {
    TcPiece *piece = &transfer->piece[i];
    if (!is_empty(piece)) below = (double)i;
    piece->filled_below = below;
    piece->inverse = piece->constant ? 0 : 1 / (piece->high - piece->low);
    if (!isfinite(piece->inverse)) pieces->narrow = true;
    if (is_empty(piece)) continue;
    for (int k = 0; k < 3; ++k) {
      pieces->largest[k] = fmax(pieces->largest[k], fmax(piece->at_low.color[k], piece->at_high.color[k]));
    }
  }
  for (int64_t i = 0; i <= pieces->count; ++i) {
    const TcPiece *piece = &transfer->piece[i];
    for (int k = 0; !is_empty(piece) && k < 3; ++k) {
      if (piece->at_low.color[k] != pieces->largest[k] || piece->at_high.color[k] != pieces->largest[k]) pieces->one_color = false;
    }
    make_row(pieces, i, transfer->row[i]);
    make_single_row(piece, transfer->row[i], transfer->single_row[i]);
  }
}

/* In other units, and not above what is computed with. */
static void scale_optics(TcOptics *optics, int length_exponent) {
  optics->extinction = fmin(ldexp(optics->extinction, length_exponent), TC_LARGEST_EXTINCTION);
  for (int k = 0; k < 3; ++k)
    optics->color[k] = fmin(optics->color[k], TC_LARGEST_COLOR);
}

/* The pieces, scalars times 2^−value_exponent and lengths times 2^−length_exponent: powers of two, no bit changes. No
 * scalar is beyond ±TC_LARGEST_SCALAR in these units: there, knots farther away are replaced by what holds at that
 * limit, so that their distances don't overflow. */
static void make_pieces(TetcastTransferFunction *transfer, int value_exponent, int length_exponent) {
  const Knots color = {transfer->color, transfer->color_count, 4};
  const Knots extinction = {transfer->extinction, transfer->extinction_count, 2};
  const double limit = fmin(ldexp(TC_LARGEST_SCALAR, value_exponent), DBL_MAX);
  const int64_t n = merge_knots(&color, &extinction, limit, value_exponent, transfer->knots);
  double *x = transfer->knots;
  for (int64_t i = 0; i <= n; ++i) {
    TcPiece *piece = &transfer->piece[i];
    if (i > 0) piece->at_low = optics_limit(&extinction, &color, x[i - 1], limit_above);
    if (i < n) piece->at_high = optics_limit(&extinction, &color, x[i], limit_below);
    if (i == 0) piece->at_low = piece->at_high;
    if (i == n) piece->at_high = piece->at_low;
    scale_optics(&piece->at_low, length_exponent);
    scale_optics(&piece->at_high, length_exponent);
  }
  for (int64_t i = 0; i < n; ++i)
    x[i] = ldexp(x[i], -value_exponent);
  for (int64_t i = 0; i <= n; ++i) {
    TcPiece *piece = &transfer->piece[i];
    piece->low = i > 0 ? x[i - 1] : -INFINITY;
    piece->high = i < n ? x[i] : INFINITY;
    const TcOptics *a = &piece->at_low, *b = &piece->at_high;
    piece->constant = a->extinction == b->extinction && a->color[0] == b->color[0] && a->color[1] == b->color[1] &&
                      a->color[2] == b->color[2];
  }
  transfer->pieces = (TcPieces){.count = n, .knots = transfer->knots, .pieces = transfer->piece, .rows = transfer->row,
                                 .single_rows = transfer->single_row};
  look_at_pieces(transfer);
}

static double extinction_of(const TetcastTransferFunctionDesc *desc, double opacity) {
  if (desc->opacity_model != TETCAST_OPACITY_UNIT_DISTANCE) return opacity / desc->unit_distance;
  const double largest = 1 - 0x1p-53;
  return -log1p(-(opacity < largest ? opacity : largest)) / desc->unit_distance;
}

static TetcastStatus check_desc(TetcastContext *context, const TetcastTransferFunctionDesc *desc) {
  const Knots color = {desc->color, desc->color_count, 4};
  TetcastStatus status = check_knots(context, &color, "color", INFINITY);
  if (status) return status;
  if ((desc->extinction != NULL) == (desc->opacity != NULL)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: either extinction or opacity is needed, not %s",
                    desc->opacity ? "both" : "none");
  }
  if (desc->extinction) {
    const Knots extinction = {desc->extinction, desc->extinction_count, 2};
    return check_knots(context, &extinction, "extinction", INFINITY);
  }
  if (!(desc->unit_distance > 0) || !isfinite(desc->unit_distance)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: unit distance %g is not a positive length",
                    desc->unit_distance);
  }
  const Knots opacity = {desc->opacity, desc->opacity_count, 2};
  status = check_knots(context, &opacity, "opacity", 1);
  for (int64_t i = 0; !status && i < desc->opacity_count; ++i) {
    if (!isfinite(extinction_of(desc, desc->opacity[2 * i + 1]))) {
      status = tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: unit distance %g is too small: the extinction of opacity "
                        "knot %" PRId64 " overflows", desc->unit_distance, i);
    }
  }
  return status;
}

static TetcastStatus create(TetcastContext *context, const TetcastTransferFunctionDesc *desc, int value_exponent,
                            int length_exponent, TetcastTransferFunction **out) {
  const TetcastStatus status = check_desc(context, desc);
  if (status) return status;
  const int64_t count = desc->extinction ? desc->extinction_count : desc->opacity_count;
  const int64_t most = desc->color_count + count;
  TetcastTransferFunction *transfer;
  if (!tc_allocate_array(context, (void **)&transfer, 1, sizeof *transfer, "transfer function")) return TETCAST_ERROR_MEMORY;
  memset(transfer, 0, sizeof *transfer);
  transfer->context = context;
  transfer->color_count = desc->color_count;
  transfer->extinction_count = count;
  if (!tc_allocate_array(context, (void **)&transfer->color, desc->color_count, 4 * sizeof(double), "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->extinction, count, 2 * sizeof(double), "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->knots, most, sizeof(double), "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->piece, most + 1, sizeof *transfer->piece, "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->row, most + 1, sizeof *transfer->row, "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->single_row, most + 1, sizeof *transfer->single_row, "transfer function")) {
    tc_transfer_destroy(transfer);
    return TETCAST_ERROR_MEMORY;
  }
  memcpy(transfer->color, desc->color, (size_t)desc->color_count * 4 * sizeof(double));
  for (int64_t i = 0; i < count; ++i) {
    const double *knot = (desc->extinction ? desc->extinction : desc->opacity) + 2 * i;
    transfer->extinction[2 * i] = knot[0];
    transfer->extinction[2 * i + 1] = desc->extinction ? knot[1] : extinction_of(desc, knot[1]);
  }
  make_pieces(transfer, value_exponent, length_exponent);
  *out = transfer;
  return TETCAST_OK;
}

TetcastStatus tc_transfer_create(TetcastContext *context, const TetcastTransferFunctionDesc *desc,
                                 TetcastTransferFunction **out) {
  return create(context, desc, 0, 0, out);
}

TetcastStatus tc_transfer_rescale(TetcastContext *context, const TetcastTransferFunction *source, int value_exponent,
                                  int length_exponent, TetcastTransferFunction **out) {
  const TetcastTransferFunctionDesc desc = {.color = source->color,
                                            .color_count = source->color_count,
                                            .extinction = source->extinction,
                                            .extinction_count = source->extinction_count};
  return create(context, &desc, value_exponent, length_exponent, out);
}

TetcastStatus tc_transfer_copy(TetcastContext *context, const TetcastTransferFunction *source,
                               TetcastTransferFunction **out) {
  return tc_transfer_rescale(context, source, 0, 0, out);
}

void tc_transfer_destroy(TetcastTransferFunction *transfer) {
  if (!transfer) return;
  TetcastContext *context = transfer->context;
  tc_release(context, transfer->color);
  tc_release(context, transfer->extinction);
  tc_release(context, transfer->knots);
  tc_release(context, transfer->piece);
  tc_release(context, transfer->row);
  tc_release(context, transfer->single_row);
  tc_release(context, transfer);
}
