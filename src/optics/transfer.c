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
        return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s knot %" PRId64 " is not finite", what,
                        i);
      }
      if (k > 0 && (knot[k] < 0 || knot[k] > largest)) {
        return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s knot %" PRId64 " at %g is %s: %g", what,
                        i, knot[0], knot[k] < 0 ? "negative" : "above 1", knot[k]);
      }
    }
    if (i > 0 && knot[0] < knot[-knots->width]) {
      return tc_error(context, TETCAST_ERROR_ARGUMENT,
                      "transfer function: %s knots are not sorted: knot %" PRId64 " at %g comes after %g", what, i,
                      knot[0], knot[-knots->width]);
    }
    if (i > 1 && knot[0] == knot[-2 * knots->width]) {
      return tc_error(context, TETCAST_ERROR_ARGUMENT, "transfer function: %s has more than two knots at %g", what,
                      knot[0]);
    }
  }
  return TETCAST_OK;
}

static void interpolate(const Knots *knots, int64_t i, double x, double *values) {
  const double *a = knots->data + i * knots->width, *b = a + knots->width;
  const double part = isfinite(b[0] - a[0]) ? 1 : 0.5; /* halves of differences that are too large */
  const double whole = part * b[0] - part * a[0], w = (part * x - part * a[0]) / whole,
               v = (part * b[0] - part * x) / whole;
  for (int k = 1; k < knots->width; ++k)
    values[k - 1] = v * a[k] + w * b[k];
}

/* Values just above x. */
static void limit_above(const Knots *knots, double x, double *values) {
  int64_t i = 0; /* first knot > x */
  while (i < knots->count && knots->data[i * knots->width] <= x)
    ++i;
  if (i > 0 && (i == knots->count || knots->data[(i - 1) * knots->width] == x))
    --i;
  else if (i > 0) {
    interpolate(knots, i - 1, x, values);
    return;
  }
  memcpy(values, knots->data + i * knots->width + 1, (size_t)(knots->width - 1) * sizeof *values);
}

/* Values just below x. */
static void limit_below(const Knots *knots, double x, double *values) {
  int64_t i = 0; /* first knot ≥ x */
  while (i < knots->count && knots->data[i * knots->width] < x)
    ++i;
  if (i == knots->count)
    --i;
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

/* Merges the scalars of both lists of knots, clamped to ±limit; those that are equal times 2^−exponent become one. */
static int64_t merge_knots(const Knots *a, const Knots *b, double limit, int exponent, double *merged) {
  int64_t i = 0, j = 0, n = 0;
  while (i < a->count || j < b->count) {
    const double x = i < a->count ? a->data[i * a->width] : INFINITY,
                 y = j < b->count ? b->data[j * b->width] : INFINITY;
    const double next = fmax(-limit, fmin(x <= y ? x : y, limit));
    if (x <= y)
      ++i;
    else
      ++j;
    if (n == 0 || ldexp(merged[n - 1], -exponent) != ldexp(next, -exponent))
      ++n;
    merged[n - 1] = next;
  }
  return n;
}

static bool is_empty(const TcPiece *piece) {
  return piece->at_low.extinction == 0 && piece->at_high.extinction == 0;
}

/* The number of the piece that rays go to from piece i, above or below it. Several pieces without extinction in turn
 * are passed at once. −1 or count + 1 if there is none. */
static int64_t next_piece(const TcPieces *pieces, int64_t i, int step) {
  const int64_t next = i + step, second = next + step;
  if (second < 0 || second > pieces->count || !is_empty(&pieces->pieces[next]) || !is_empty(&pieces->pieces[second]))
    return next;
  return step > 0 ? pieces->pieces[next].filled_above : pieces->pieces[next].filled_below;
}

/* 1, or the power of two that makes the piece's width one in [1, 2), where a slope would overflow or lose digits
 * without. */
static double scale_of(const TcPiece *piece) {
  if (piece->constant)
    return 1;
  const double width = piece->high - piece->low, *at[2] = {&piece->at_low.extinction, piece->at_low.color};
  const double *to[2] = {&piece->at_high.extinction, piece->at_high.color};
  int exponent;
  frexp(width, &exponent);
  for (int k = 0; k < 4; ++k) {
    const double rise = fabs(to[k > 0][k > 0 ? k - 1 : 0] - at[k > 0][k > 0 ? k - 1 : 0]) / width;
    if (rise > 0 && !(rise > DBL_MIN && rise < DBL_MAX / 2))
      return ldexp(1, 1 - exponent > 1023 ? 1023 : 1 - exponent);
  }
  return width < DBL_MIN ? ldexp(1, 1023) : 1;
}

/* 2.1 C Δκ + Δc κ over the two optics, with C the largest colour and at least 1, κ the larger extinction. */
static double change(const TcPieces *pieces, const TcOptics *a, const TcOptics *b) {
  const double most = fmax(a->extinction, b->extinction),
               largest = fmax(1, fmax(pieces->largest[0], fmax(pieces->largest[1], pieces->largest[2])));
  double color = 0;
  for (int k = 0; most > 0 && k < 3; ++k)
    color = fmax(color, fabs(a->color[k] - b->color[k]));
  return 2.1 * largest * fabs(a->extinction - b->extinction) + color * most;
}

static double steepness(const TcPieces *pieces, int64_t i) {
  if (i < 0 || i > pieces->count || pieces->pieces[i].constant)
    return 0;
  const TcPiece *piece = &pieces->pieces[i];
  return change(pieces, &piece->at_low, &piece->at_high) / (piece->high - piece->low);
}

static double jump(const TcPieces *pieces, int64_t i) {
  const TcPiece *piece = &pieces->pieces[i];
  const double below = i > 0 ? change(pieces, &piece[-1].at_high, &piece->at_low) : 0;
  return fmax(below, i < pieces->count ? change(pieces, &piece->at_high, &piece[1].at_low) : 0);
}

static void make_row(TcPieces *pieces, int64_t i) {
  const TcPiece *piece = &pieces->pieces[i];
  const bool rises = piece->at_low.extinction <= piece->at_high.extinction;
  const TcOptics *from = rises ? &piece->at_low : &piece->at_high, *to = rises ? &piece->at_high : &piece->at_low;
  const double scale = scale_of(piece);
  const double width = (rises ? piece->high - piece->low : piece->low - piece->high) * scale;
  double word[TC_PIECE_WORDS] = {[TC_PIECE_LOW] = piece->low,
                                 [TC_PIECE_HIGH] = piece->high,
                                 [TC_PIECE_FROM] = rises ? piece->low : piece->high,
                                 [TC_PIECE_EXTINCTION] = from->extinction,
                                 [TC_PIECE_FILLED] = !is_empty(piece),
                                 [TC_PIECE_SCALE] = scale,
                                 [TC_PIECE_STEEP] = steepness(pieces, i),
                                 [TC_PIECE_BESIDE] = fmax(steepness(pieces, i - 1), steepness(pieces, i + 1)),
                                 [TC_PIECE_JUMP] = jump(pieces, i)};
  if (piece->constant)
    word[TC_PIECE_FROM] = isfinite(piece->low) ? piece->low : isfinite(piece->high) ? piece->high : 0;
  else
    word[TC_PIECE_RISE] = (to->extinction - from->extinction) / width;
  for (int k = 0; k < 3; ++k) {
    word[TC_PIECE_COLOR + k] = from->color[k];
    if (!piece->constant)
      word[TC_PIECE_COLOR_RISE + k] = (to->color[k] - from->color[k]) / width;
  }
  if (scale != 1)
    pieces->scaled = true;
  for (int k = 0; k < TC_PIECE_WORDS; ++k) {
    pieces->rows_f64[i][k] = word[k];
    pieces->rows_f32[i][k] = (float)fmax(-FLT_MAX, fmin(word[k], FLT_MAX)); /* beyond: not used (tolerance.h) */
  }
  const int64_t next[2] = {next_piece(pieces, i, 1), next_piece(pieces, i, -1)};
  const int32_t next_f32[2] = {(int32_t)next[0], (int32_t)next[1]};
  memcpy(&pieces->rows_f64[i][TC_PIECE_ABOVE], next, sizeof next);
  memcpy(&pieces->rows_f32[i][TC_PIECE_ABOVE], next_f32, sizeof next_f32);
  for (int k = 0; k < TC_PIECE_WORDS; ++k) { /* copied as they are: some are no reals */
    if (i < TC_LOOKUP_F64)
      memcpy(&pieces->columns_f64[k][i], &pieces->rows_f64[i][k], sizeof(double));
    if (i < TC_LOOKUP_F32)
      memcpy(&pieces->columns_f32[k][i], &pieces->rows_f32[i][k], sizeof(float));
  }
}

/* Computes what follows from the pieces. */
static void look_at_pieces(TetcastTransferFunction *transfer) {
  TcPieces *pieces = &transfer->pieces;
  memset(pieces->largest, 0, sizeof pieces->largest);
  pieces->scaled = false;
  pieces->one_color = true;
  int64_t above = pieces->count + 1, below = -1;
  for (int64_t i = pieces->count; i >= 0; --i) {
    if (!is_empty(&transfer->piece[i]))
      above = i;
    transfer->piece[i].filled_above = above;
  }
  for (int64_t i = 0; i <= pieces->count; ++i) {
    TcPiece *piece = &transfer->piece[i];
    if (!is_empty(piece))
      below = i;
    piece->filled_below = below;
    piece->inverse = piece->constant ? 0 : 1 / (piece->high - piece->low);
    if (is_empty(piece))
      continue;
    for (int k = 0; k < 3; ++k) {
      pieces->largest[k] = fmax(pieces->largest[k], fmax(piece->at_low.color[k], piece->at_high.color[k]));
    }
  }
  for (int64_t i = 0; i <= pieces->count; ++i) {
    const TcPiece *piece = &transfer->piece[i];
    for (int k = 0; !is_empty(piece) && k < 3; ++k) {
      if (piece->at_low.color[k] != pieces->largest[k] || piece->at_high.color[k] != pieces->largest[k])
        pieces->one_color = false;
    }
    make_row(pieces, i);
  }
}

/* Converts to other units, clamped to the largest extinction and colour. */
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
    if (i > 0)
      piece->at_low = optics_limit(&extinction, &color, x[i - 1], limit_above);
    if (i < n)
      piece->at_high = optics_limit(&extinction, &color, x[i], limit_below);
    if (i == 0)
      piece->at_low = piece->at_high;
    if (i == n)
      piece->at_high = piece->at_low;
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
  transfer->pieces.count = n;
  transfer->pieces.knots = transfer->knots;
  transfer->pieces.pieces = transfer->piece;
  look_at_pieces(transfer);
}

static double extinction_of(const TetcastTransferFunctionDesc *desc, double opacity) {
  if (desc->opacity_model != TETCAST_OPACITY_UNIT_DISTANCE)
    return opacity / desc->unit_distance;
  const double largest = 1 - 0x1p-53;
  return -log1p(-(opacity < largest ? opacity : largest)) / desc->unit_distance;
}

static TetcastStatus check_desc(TetcastContext *context, const TetcastTransferFunctionDesc *desc) {
  const Knots color = {desc->color, desc->color_count, 4};
  TetcastStatus status = check_knots(context, &color, "color", INFINITY);
  if (status)
    return status;
  if ((desc->extinction != NULL) == (desc->opacity != NULL)) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT,
                    "transfer function: either extinction or opacity is needed, not %s",
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
      status = tc_error(context, TETCAST_ERROR_ARGUMENT,
                        "transfer function: unit distance %g is too small: the extinction of opacity "
                        "knot %" PRId64 " overflows",
                        desc->unit_distance, i);
    }
  }
  return status;
}

static TetcastStatus create(TetcastContext *context, const TetcastTransferFunctionDesc *desc, int value_exponent,
                            int length_exponent, TetcastTransferFunction **out) {
  const TetcastStatus status = check_desc(context, desc);
  if (status)
    return status;
  const int64_t count = desc->extinction ? desc->extinction_count : desc->opacity_count;
  const int64_t most = desc->color_count + count;
  TetcastTransferFunction *transfer;
  if (!tc_allocate_array(context, (void **)&transfer, 1, sizeof *transfer, "transfer function"))
    return TETCAST_ERROR_MEMORY;
  memset(transfer, 0, sizeof *transfer);
  transfer->context = context;
  TcPieces *pieces = &transfer->pieces;
  transfer->color_count = desc->color_count;
  transfer->extinction_count = count;
  if (!tc_allocate_array(context, (void **)&transfer->color, desc->color_count, 4 * sizeof(double),
                         "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->extinction, count, 2 * sizeof(double), "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->knots, most, sizeof(double), "transfer function") ||
      !tc_allocate_array(context, (void **)&transfer->piece, most + 1, sizeof *transfer->piece, "transfer function") ||
      !tc_allocate_array(context, (void **)&pieces->rows_f64, most + 1, sizeof *pieces->rows_f64,
                         "transfer function") ||
      !tc_allocate_array(context, (void **)&pieces->rows_f32, most + 1, sizeof *pieces->rows_f32,
                         "transfer function")) {
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
  if (!transfer)
    return;
  TetcastContext *context = transfer->context;
  tc_release(context, transfer->color);
  tc_release(context, transfer->extinction);
  tc_release(context, transfer->knots);
  tc_release(context, transfer->piece);
  tc_release(context, transfer->pieces.rows_f64);
  tc_release(context, transfer->pieces.rows_f32);
  tc_release(context, transfer);
}

int64_t tc_piece_above(const TcPieces *pieces, double s) {
  int64_t low = 0, high = pieces->count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (pieces->knots[middle] <= s)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

int64_t tc_piece_below(const TcPieces *pieces, double s) {
  int64_t low = 0, high = pieces->count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (pieces->knots[middle] < s)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* In a piece that is not constant, at low ≤ s ≤ high. Both ends come out exactly, and a width may be denormal. */
static TcOptics optics_at(const TcPiece *piece, double s) {
  const double width = piece->high - piece->low, w = (s - piece->low) / width, v = (piece->high - s) / width;
  TcOptics optics;
  optics.extinction = v * piece->at_low.extinction + w * piece->at_high.extinction;
  for (int k = 0; k < 3; ++k)
    optics.color[k] = v * piece->at_low.color[k] + w * piece->at_high.color[k];
  return optics;
}

TcOptics tc_piece_at(const TcPiece *piece, double s) {
  return piece->constant ? piece->at_low : optics_at(piece, s);
}

TcOptics tc_pieces_at(const TcPieces *pieces, double s) {
  return tc_piece_at(&pieces->pieces[tc_piece_above(pieces, s)], s);
}

/* The shape's knots over [low, high]. Where that is so narrow that knots fall on each other, the first of them; of a
 * step both. How many there are. */
static int64_t stretch_knots(const Knots *knots, double low, double high, double *out) {
  int64_t count = 0;
  const int width = knots->width;
  for (int64_t i = 0; i < knots->count; ++i) {
    const double *knot = knots->data + i * width, value = knot[0] == 1 ? high : low * (1 - knot[0]) + high * knot[0];
    double *next = out + count * width;
    const bool above = count == 0 || value > next[-width], step = i > 0 && knot[0] == knot[-width];
    if (!above && (!step || (count > 1 && next[-2 * width] == next[-width])))
      continue;
    memcpy(next, knot, (size_t)width * sizeof *next);
    next[0] = above ? value : next[-width];
    ++count;
  }
  return count;
}

TetcastStatus tc_transfer_stretch(TetcastContext *context, const TetcastTransferFunction *shape, double low,
                                  double high, double extinction, TetcastTransferFunction **out) {
  const Knots color = {shape->color, shape->color_count, 4};
  const Knots extinctions = {shape->extinction, shape->extinction_count, 2};
  double *knots, largest = 0;
  if (!tc_allocate_array(context, (void **)&knots, 4 * color.count + 2 * extinctions.count, sizeof *knots, "knots"))
    return TETCAST_ERROR_MEMORY;
  double *ramp = knots + 4 * color.count;
  for (int64_t i = 0; i < extinctions.count; ++i)
    largest = fmax(largest, extinctions.data[2 * i + 1]);
  TetcastTransferFunctionDesc desc = {.color = knots, .color_count = 1, .extinction = ramp, .extinction_count = 1};
  if (low < high) {
    desc.color_count = stretch_knots(&color, low, high, knots);
    desc.extinction_count = stretch_knots(&extinctions, low, high, ramp);
  } else {
    limit_above(&color, 0.5, knots + 1);
    ramp[1] = largest;
    knots[0] = ramp[0] = low;
  }
  for (int64_t i = 0; largest > 0 && i < desc.extinction_count; ++i)
    ramp[2 * i + 1] = ramp[2 * i + 1] / largest * extinction;
  const TetcastStatus status = tc_transfer_create(context, &desc, out);
  tc_release(context, knots);
  return status;
}
