/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "optics/segment.h"
#include "optics/transfer.h"

enum { BLOCK = 64 };

static void end_block(TcLight *light) {
  for (int k = 0; k < 3; ++k) {
    light->color[k] += light->transmittance * light->block_color[k];
    light->block_color[k] = 0;
  }
  light->depth += light->block_depth;
  light->transmittance = exp(-light->depth);
  light->block_depth = 0;
  light->block_transmittance = 1;
  light->block_length = 0;
}

void tc_light_add_segment(TcLight *light, const TcSegment *segment, const double near[3], const double far[3]) {
  for (int k = 0; k < 3; ++k) {
    light->block_color[k] += light->block_transmittance * (near[k] * segment->w0 + far[k] * segment->w1);
  }
  light->block_transmittance *= segment->transmittance;
  light->block_depth += segment->depth;
  if (++light->block_length == BLOCK) end_block(light);
}

bool tc_light_opaque(TcLight *light, const TcPieces *pieces) {
  const double depth = light->depth + light->block_depth;
  if (depth <= light->opaque && depth <= TC_NEARLY_OPAQUE) return false;
  light->stopped = depth > TC_NEARLY_OPAQUE;
  const double left = light->transmittance * light->block_transmittance;
  for (int k = 0; k < 3; ++k) {
    const double color = light->color[k] + light->transmittance * light->block_color[k];
    if (left * pieces->largest[k] > 0x1p-54 * color) light->stopped = false;
  }
  if (depth > light->opaque) light->stopped = true;
  return light->stopped;
}

int64_t tc_piece_above(const TcPieces *pieces, double s) {
  int64_t low = 0, high = pieces->count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (pieces->knots[middle] <= s) low = middle + 1;
    else high = middle;
  }
  return low;
}

int64_t tc_piece_below(const TcPieces *pieces, double s) {
  int64_t low = 0, high = pieces->count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (pieces->knots[middle] < s) low = middle + 1;
    else high = middle;
  }
  return low;
}

/* In a piece that is not constant, at low ≤ s ≤ high. Both ends come out exactly, and a width may be denormal. */
static TcOptics optics_at(const TcPiece *piece, double s) {
  const double width = piece->high - piece->low, w = (s - piece->low) / width, v = (piece->high - s) / width;
  TcOptics optics;
  optics.extinction = v * piece->at_low.extinction + w * piece->at_high.extinction;
  for (int k = 0; k < 3; ++k) optics.color[k] = v * piece->at_low.color[k] + w * piece->at_high.color[k];
  return optics;
}

TcOptics tc_pieces_at(const TcPieces *pieces, double s) {
  const TcPiece *piece = &pieces->pieces[tc_piece_above(pieces, s)];
  return piece->constant ? piece->at_low : optics_at(piece, s);
}

/* What is done with the part of a segment that lies in one piece. */
typedef void PartFunction(const void *data, TcLight *light, const TcPiece *piece, double length, double s0, double s1);

static void add_exact(const void *data, TcLight *light, const TcPiece *piece, double length, double s0, double s1) {
  (void)data;
  if (piece->constant) {
    if (piece->at_low.extinction == 0) return; /* transparent: nothing happens on it */
    const double depth = piece->at_low.extinction * length;
    const TcSegment segment = depth <= light->thin ? tc_segment_thin(depth, depth) : tc_segment_constant(depth);
    tc_light_add_segment(light, &segment, piece->at_low.color, piece->at_low.color);
    return;
  }
  const TcOptics near = optics_at(piece, s0), far = optics_at(piece, s1);
  if (near.extinction == 0 && far.extinction == 0) return;
  const double a = near.extinction * length, a1 = far.extinction * length;
  const TcSegment segment = 0.5 * a + 0.5 * a1 <= light->thin ? tc_segment_thin(a, a1) : tc_segment(a, a1);
  tc_light_add_segment(light, &segment, near.color, far.color);
}

/* Cuts a segment at the knots. The lengths of parts come from differences of scalars, not of positions along the segment: nothing
 * cancels. Inlined with the part's function. */
static inline void split(TcLight *light, const TcPieces *pieces, double length, double s0, double s1, PartFunction *add,
                         const void *data) {
  const double whole = fabs(s1 - s0);
  if (s0 <= s1) {
    const TcPiece *piece = &pieces->pieces[tc_piece_above(pieces, s0)];
    if (piece->high >= s1) {
      add(data, light, piece, length, s0, s1);
      return;
    }
    for (; s0 < s1; ++piece) {
      const double end = piece->high < s1 ? piece->high : s1;
      add(data, light, piece, length * ((end - s0) / whole), s0, end);
      s0 = end;
    }
  } else {
    const TcPiece *piece = &pieces->pieces[tc_piece_below(pieces, s0)];
    if (piece->low <= s1) {
      add(data, light, piece, length, s0, s1);
      return;
    }
    for (; s0 > s1; --piece) {
      const double end = piece->low > s1 ? piece->low : s1;
      add(data, light, piece, length * ((s0 - end) / whole), s0, end);
      s0 = end;
    }
  }
}

void tc_light_add(TcLight *light, const TcPieces *pieces, double length, double s0, double s1) {
  split(light, pieces, length, s0, s1, add_exact, NULL);
}

void tc_light_add_constant(TcLight *light, const TcPieces *pieces, double length, double s) {
  add_exact(NULL, light, &pieces->pieces[tc_piece_above(pieces, s)], length, s, s);
}

typedef struct Ends {
  TcEndsFunction *function;
  const void *data;
} Ends;

static void add_ends(const void *data, TcLight *light, const TcPiece *piece, double length, double s0, double s1) {
  const Ends *ends = data;
  const TcOptics near = piece->constant ? piece->at_low : optics_at(piece, s0);
  const TcOptics far = piece->constant ? piece->at_low : optics_at(piece, s1);
  ends->function(ends->data, light, &near, &far, length);
}

void tc_light_split(TcLight *light, const TcPieces *pieces, double length, double s0, double s1, TcEndsFunction *function,
                    const void *data) {
  const Ends ends = {function, data};
  split(light, pieces, length, s0, s1, add_ends, &ends);
}

void tc_light_end(TcLight *light, double rgba[4]) {
  end_block(light);
  for (int k = 0; k < 3; ++k) rgba[k] = light->color[k];
  rgba[3] = -expm1(-light->depth);
}
