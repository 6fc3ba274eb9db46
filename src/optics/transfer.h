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
  double inverse; /* 1 / (high − low); 0 for a constant piece */
  double filled_above, filled_below; /* the nearest piece that has extinction, this one included; count + 1, −1: none */
  bool constant;
} TcPiece;

/* A piece as packets load it, all doubles: low, high; the same again for interpolation, 0 if it is constant; inverse; 1 if it is constant, else 0;
 * extinction at low, at high; colour at low; at high; the next pieces above and below (count + 1, −1: none), several without extinction passed.
 * In single precision: low, high; low again, 0 if it is constant; extinction there, and its slope; colour there, and its slope; the next
 * pieces; three words unused. */
enum { TC_PIECE_WORDS = 16 };

/* count + 1 pieces between count distinct knots: piece i ends at knot[i], piece i + 1 begins there. */
typedef struct TcPieces {
  int64_t count;
  const double *knots; /* [count], ascending */
  const TcPiece *pieces;
  double (*rows)[TC_PIECE_WORDS];      /* the same for packets */
  float (*single_rows)[TC_PIECE_WORDS]; /* … in single precision */
  double largest[3]; /* of each colour component, where there is any extinction */
  bool one_color;    /* the colour is `largest` wherever there is any extinction */
  bool narrow;       /* a piece is so narrow that `inverse` overflows */
} TcPieces;

struct TetcastTransferFunction {
  TetcastContext *context;
  int64_t color_count, extinction_count;
  double *color;      /* [color_count][4] */
  double *extinction; /* [extinction_count][2] */
  double *knots;
  TcPiece *piece;
  double (*row)[TC_PIECE_WORDS];
  float (*single_row)[TC_PIECE_WORDS];
  TcPieces pieces;
};

/* What is larger counts as this: extinctions in the volume's unit of length, where no cell is longer than 4, and
 * colours. So neither a segment's depth, nor its light, nor a sum of them over a ray and over all samples of a pixel
 * overflows. */
#define TC_LARGEST_EXTINCTION 0x1p1000
#define TC_LARGEST_COLOR      0x1p500

/* Bound on the magnitude of scalars as the volume stores them: interpolation between them doesn't overflow. */
#define TC_LARGEST_SCALAR 0x1p1000

TetcastStatus tc_transfer_create(TetcastContext *context, const TetcastTransferFunctionDesc *desc, TetcastTransferFunction **out);
TetcastStatus tc_transfer_copy(TetcastContext *context, const TetcastTransferFunction *source, TetcastTransferFunction **out);

/* A copy with pieces in other units: scalars times 2^−value_exponent, lengths times 2^−length_exponent, so extinction
 * times 2^length_exponent. */
TetcastStatus tc_transfer_rescale(TetcastContext *context, const TetcastTransferFunction *source, int value_exponent,
                                  int length_exponent, TetcastTransferFunction **out);
void tc_transfer_destroy(TetcastTransferFunction *transfer);

/* Colour map `name` over [low, high] with an extinction that rises from 0 to `extinction`. */
TetcastStatus tc_transfer_create_preset(TetcastContext *context, const char *name, double low, double high, double extinction,
                                        TetcastTransferFunction **out);
const char *tc_preset_name(int i);

/* Light gathered along a ray, front to back. Segments are composited in blocks, and blocks into the total, so that rounding
 * grows with the block's length plus the number of blocks, not with the number of segments: with 10⁵ segments the relative error
 * stays below (64 + 10⁵/64) · 2⁻⁵³ · O(1) ≈ 2e-13 even where all roundings point the same way. */
typedef struct TcLight {
  double color[3], depth, transmittance;                   /* total of the finished blocks */
  double block_color[3], block_depth, block_transmittance; /* of the block under way */
  int block_length;
  double thin;                                             /* depth up to which a segment may be evaluated by tc_segment_thin() */
  double opaque;                                           /* depth beyond which the light is complete */
  bool stopped;                                            /* there may have been more behind */
} TcLight;

/* Optical depth beyond which e^−τ is zero in double precision: what lies behind can't change a bit of the colour. */
#define TC_OPAQUE_DEPTH 746.0

/* Depth from which 1 − e^−τ is 1 in double precision. */
#define TC_NEARLY_OPAQUE 37.5

/* With a tolerance's limits; exact: −1, TC_OPAQUE_DEPTH. */
static inline TcLight tc_light_begin(double thin, double opaque) {
  return (TcLight){.transmittance = 1, .block_transmittance = 1, .thin = thin, .opaque = opaque};
}

/* Whether the light is complete: beyond light->opaque, or so deep that what is left changes no channel by half an ulp. Notes it. */
bool tc_light_opaque(TcLight *light, const TcPieces *pieces);

/* Piece with low ≤ s < high: at a knot, the later one. */
int64_t tc_piece_above(const TcPieces *pieces, double s);
/* Piece with low < s ≤ high: where a scalar that falls from s finds itself. */
int64_t tc_piece_below(const TcPieces *pieces, double s);

/* Adds what a segment of length `length` > 0 with scalars s0 → s1 (finite, linear in between) emits and absorbs. */
void tc_light_add(TcLight *light, const TcPieces *pieces, double length, double s0, double s1);

/* Adds a segment of constant scalar s (finite). */
void tc_light_add_constant(TcLight *light, const TcPieces *pieces, double length, double s);


/* Extinction and colour at a scalar; at a knot, the later one's. */
TcOptics tc_pieces_at(const TcPieces *pieces, double s);

/* Calls `function` for each part of a segment between knots, with what holds at the part's two ends. */
typedef void TcEndsFunction(const void *data, TcLight *light, const TcOptics *near, const TcOptics *far, double length);
void tc_light_split(TcLight *light, const TcPieces *pieces, double length, double s0, double s1, TcEndsFunction *function,
                    const void *data);

/* Adds a segment whose integral is known. */
void tc_light_add_segment(TcLight *light, const TcSegment *segment, const double near[3], const double far[3]);

/* Premultiplied colour and opacity of all that was added. */
void tc_light_end(TcLight *light, double rgba[4]);

#endif
