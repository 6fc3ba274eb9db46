/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_OPTICS_TRANSFER_H
#define TC_OPTICS_TRANSFER_H

#include <tetcast/transfer_function.h>

#include "base/base.h"
#include "optics/segment.h"

/* Extinction and colour at a scalar: κ, r, g, b. */
typedef struct TcOptics {
  double extinction, color[3];
} TcOptics;

/* One linear piece between two neighbouring knots of either list. */
typedef struct TcPiece {
  double low, high; /* scalars at its ends; the outermost pieces are constant and end at ∓infinity */
  TcOptics at_low, at_high;
  double inverse; /* 1 / (high − low), which may be infinite; 0 for a constant piece */
  int64_t filled_above,
      filled_below; /* the nearest piece that has extinction, this one included; count + 1, −1: none */
  bool constant;
} TcPiece;

/* A piece as kernels load it, in either precision: a row of numbers. Extinction and colour at a scalar s of the piece
 * are extinction + ((s − from) scale) rise,   colour + ((s − from) scale) color_rise. `from` is the end where
 * extinction is least, so that (s − from) rise ≥ 0: nothing cancels, and extinction is good to four units in the last
 * place. `scale` is 1, but where a piece is so narrow or so wide that a slope would overflow or underflow: kernels that
 * don't know of that may not be used then (TcPieces.scaled). `above` and `below` are the next pieces either way,
 * several without extinction passed at once; count + 1, −1: none. These two are integers as wide as the row's other
 * numbers. */
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
  TC_PIECE_STEEP, /* how much light changes with the scalar in the piece, at most: 2.1 C |rise| + largest colour_rise ·
                     largest extinction; C: tolerance.h */
  TC_PIECE_BESIDE, /* the same, of the pieces below and above */
  TC_PIECE_JUMP,   /* how much it changes at once at the piece's ends, at most: 2.1 C Δextinction + Δcolour · largest
                      extinction */
  TC_PIECE_WORDS = 20
};

/* As many pieces as a vector of AVX-512 has lanes may be looked up by a permutation: word k of piece i is
 * columns[k][i]. */
enum { TC_LOOKUP_F64 = 8, TC_LOOKUP_F32 = 16 };

/* count + 1 pieces between count distinct knots: piece i ends at knot[i], piece i + 1 begins there. */
typedef struct TcPieces {
  int64_t count;
  const double *knots; /* [count], ascending */
  const TcPiece *pieces;
  double (*rows_f64)[TC_PIECE_WORDS]; /* [count + 1]: the same as rows */
  float (*rows_f32)[TC_PIECE_WORDS];
  _Alignas(64) double columns_f64[TC_PIECE_WORDS][TC_LOOKUP_F64]; /* up to so many pieces: the rows, turned */
  _Alignas(64) float columns_f32[TC_PIECE_WORDS][TC_LOOKUP_F32];
  double largest[3]; /* of each colour component, where there is any extinction */
  bool one_color;    /* the colour is `largest` wherever there is any extinction */
  bool scaled;       /* a row's `scale` is not 1 */
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

/* What is larger counts as this: extinctions in the volume's unit of length, where no cell is longer than 4, and
 * colours. So neither a segment's depth, nor its light, nor a sum of them over a ray and over all samples of a pixel
 * overflows. */
#define TC_LARGEST_EXTINCTION 0x1p1000
#define TC_LARGEST_COLOR      0x1p500

/* Bound on the magnitude of scalars as the volume stores them: interpolation between them doesn't overflow. */
#define TC_LARGEST_SCALAR 0x1p1000

TetcastStatus tc_transfer_create(TetcastContext *context, const TetcastTransferFunctionDesc *desc,
                                 TetcastTransferFunction **out);
TetcastStatus tc_transfer_copy(TetcastContext *context, const TetcastTransferFunction *source,
                               TetcastTransferFunction **out);

/* A copy with pieces in other units: scalars times 2^−value_exponent, lengths times 2^−length_exponent, so extinction
 * times 2^length_exponent. */
TetcastStatus tc_transfer_rescale(TetcastContext *context, const TetcastTransferFunction *source, int value_exponent,
                                  int length_exponent, TetcastTransferFunction **out);
void tc_transfer_destroy(TetcastTransferFunction *transfer);

/* Colour map `name` over [low, high] with an extinction that rises from 0 to `extinction`. */
TetcastStatus tc_transfer_create_preset(TetcastContext *context, const char *name, double low, double high,
                                        double extinction, TetcastTransferFunction **out);
const char *tc_preset_name(int i);

/* Optical depth beyond which e^−τ is zero in double precision: what lies behind can't change a bit of the colour. */
#define TC_OPAQUE_DEPTH 746.0

/* Depth from which 1 − e^−τ is 1 in double precision. */
#define TC_NEARLY_OPAQUE 37.5

/* Piece with low ≤ s < high: at a knot, the later one. */
int64_t tc_piece_above(const TcPieces *pieces, double s);
/* Piece with low < s ≤ high: where a scalar that falls from s finds itself. */
int64_t tc_piece_below(const TcPieces *pieces, double s);

/* Extinction and colour at a scalar of a piece. */
TcOptics tc_piece_at(const TcPiece *piece, double s);
/* The same in the piece where the scalar is; at a knot, the later one. */
TcOptics tc_pieces_at(const TcPieces *pieces, double s);

#endif
