/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_OPTICS_TRANSFER_H
#define TC_OPTICS_TRANSFER_H

#include <tetcast/transfer_function.h>

#include "base/base.h"
#include "optics/segment.h"

/* Extinction and colour at a value of the scalar. */
typedef struct TcOptics {
  double extinction, color[3];
} TcOptics;

/* A piece of a transfer function: from one knot, of the colour or of the extinction, to the next. Both are linear in
 * it. */
typedef struct TcPiece {
  double low, high;         /* the scalar at its ends; the outermost pieces are constant and end at ∓infinity */
  TcOptics at_low, at_high; /* extinction and colour at its ends */
  double inverse;           /* 1 / (high − low), which may be infinite; 0 for a constant piece */
  int64_t filled_above;     /* the first piece with extinction from this one upwards; count + 1 if there is none */
  int64_t filled_below;     /* the first piece with extinction from this one downwards; −1 if there is none */
  bool constant;            /* whether extinction and colour are the same at both ends */
} TcPiece;

/* A piece as kernels load it, in either precision: a row of numbers. At a scalar s of the piece,
 *
 *     the extinction is extinction + ((s − from) scale) rise,
 *     the colour is color + ((s − from) scale) color_rise.
 *
 * `from` is the end where the extinction is least, so that (s − from) rise ≥ 0. So nothing cancels, and the error of
 * the extinction is at most four units in the last place. `scale` is 1, unless the scalar's range in the piece is so
 * small or so large that a slope would overflow or underflow; then only kernels with TC_SCALED may be used
 * (TcPieces.scaled). `above` and `below` are the numbers of the next pieces either way; where several in turn have no
 * extinction, that of the last of them. Beyond the ends they are count + 1 and −1. These two are integers as wide as
 * the other numbers. */
enum {
  TC_PIECE_LOW,
  TC_PIECE_HIGH,
  TC_PIECE_FROM,
  TC_PIECE_EXTINCTION,
  TC_PIECE_RISE,
  TC_PIECE_COLOR,
  TC_PIECE_COLOR_RISE = TC_PIECE_COLOR + 3,
  TC_PIECE_FILLED = TC_PIECE_COLOR_RISE + 3, /* 1 if there is any extinction, else 0 */
  TC_PIECE_SCALE,
  TC_PIECE_ABOVE,
  TC_PIECE_BELOW,
  /* The most that light changes with the scalar in the piece: 2.1 C |rise| + (largest color_rise) · (largest
   * extinction), with C as in tolerance.h. */
  TC_PIECE_STEEP,
  TC_PIECE_BESIDE, /* the same of the pieces below and above, whichever is larger */
  /* The most that light jumps at the piece's ends: 2.1 C Δextinction + Δcolour · (largest extinction). */
  TC_PIECE_JUMP,
  TC_PIECE_WORDS = 20 /* the length of a row */
};

/* If a transfer function has no more pieces than a vector of AVX-512 has lanes, a permutation looks them up in columns:
 * word k of piece i is columns[k][i]. */
enum { TC_LOOKUP_F64 = 8, TC_LOOKUP_F32 = 16 };

/* The pieces of a transfer function: count + 1 of them between count distinct knots. Piece i ends at knots[i], where
 * piece i + 1 begins. */
typedef struct TcPieces {
  int64_t count;
  const double *knots; /* [count], ascending */
  const TcPiece *pieces;
  double (*rows_f64)[TC_PIECE_WORDS]; /* [count + 1]: the pieces as rows */
  float (*rows_f32)[TC_PIECE_WORDS];
  _Alignas(64) double columns_f64[TC_PIECE_WORDS][TC_LOOKUP_F64]; /* the rows of up to so many pieces, transposed */
  _Alignas(64) float columns_f32[TC_PIECE_WORDS][TC_LOOKUP_F32];
  double largest[3]; /* the largest of each colour component, where there is any extinction */
  bool one_color;    /* the colour is `largest` wherever there is any extinction */
  bool scaled;       /* whether some row's `scale` is not 1 */
} TcPieces;

struct TetcastTransferFunction {
  TetcastContext *context;
  int64_t color_count, extinction_count;
  double *color;      /* [color_count][4] */
  double *extinction; /* [extinction_count][2] */
  double *knots;
  TcPiece *piece;
  TcPieces pieces;
};

/* Extinctions, in the volume's unit of length, and colours that are larger count as this. As no cell is longer than 4
 * in this unit, neither a segment's depth, nor its light, nor a sum of them over a ray and over all samples of a pixel
 * overflows. */
#define TC_LARGEST_EXTINCTION 0x1p1000
#define TC_LARGEST_COLOR      0x1p500

/* A bound on the magnitude of scalars as the volume stores them, so that interpolation doesn't overflow. */
#define TC_LARGEST_SCALAR 0x1p1000

TetcastStatus tc_transfer_create(TetcastContext *context, const TetcastTransferFunctionDesc *desc,
                                 TetcastTransferFunction **out);
TetcastStatus tc_transfer_copy(TetcastContext *context, const TetcastTransferFunction *source,
                               TetcastTransferFunction **out);

/* Makes a copy with pieces in other units: scalars times 2^−value_exponent and lengths times 2^−length_exponent, so
 * that extinctions are times 2^length_exponent. */
TetcastStatus tc_transfer_rescale(TetcastContext *context, const TetcastTransferFunction *source, int value_exponent,
                                  int length_exponent, TetcastTransferFunction **out);
void tc_transfer_destroy(TetcastTransferFunction *transfer);

/* Makes a transfer function of a shape over [0, 1]: over [low, high], with `extinction` in place of its largest
 * extinction, in proportion. Where low is high, it is the colour of 0.5 and the largest extinction. */
TetcastStatus tc_transfer_stretch(TetcastContext *context, const TetcastTransferFunction *shape, double low,
                                  double high, double extinction, TetcastTransferFunction **out);

/* Makes a transfer function of colour map `name` over [low, high] with an extinction that rises from 0 to `extinction`.
 */
TetcastStatus tc_transfer_create_preset(TetcastContext *context, const char *name, double low, double high,
                                        double extinction, TetcastTransferFunction **out);
const char *tc_preset_name(int i);
TetcastPresetKind tc_preset_kind(const char *name);

/* The optical depth beyond which e^−τ is zero in double precision, so that what lies behind can't change the colour. */
#define TC_OPAQUE_DEPTH 746.0

/* The optical depth from which 1 − e^−τ is 1 in double precision. */
#define TC_NEARLY_OPAQUE 37.5

/* The number of the piece with low ≤ s < high: at a knot, the later one. */
int64_t tc_piece_above(const TcPieces *pieces, double s);
/* The number of the piece with low < s ≤ high, in which a scalar is that falls from s. */
int64_t tc_piece_below(const TcPieces *pieces, double s);

/* Extinction and colour at a scalar of a piece. */
TcOptics tc_piece_at(const TcPiece *piece, double s);
/* Extinction and colour at a scalar, by the piece that it lies in; at a knot, the later one. */
TcOptics tc_pieces_at(const TcPieces *pieces, double s);

#endif
