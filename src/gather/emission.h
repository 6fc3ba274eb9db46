/* SPDX-License-Identifier: Apache-2.0 */
/* Emission and absorption through a transfer function: ∫ c κ e^−τ dt, exactly. Segments are composited front to back
 * within blocks of 64 steps, and blocks are composited into the total, so that rounding grows with a block's length
 * plus the number of blocks instead of with the number of segments.
 *
 * Without TC_COLORED the transfer function has one colour only. A ray's colour is then that colour times its opacity,
 * so it is enough to gather the optical depth, an integral of a function that is linear in pieces. */
#ifndef TC_GATHER_EMISSION_H
#define TC_GATHER_EMISSION_H

#include "gather/lit.h"
#include "gather/pieces.h"
#include "gather/seam.h"
#include "gather/second.h"
#include "gather/surfaces.h"
#include "optics/segment_lanes.h"

typedef struct TcEmission {
  /* The block under way. */
  TcVec block_color[3], block_depth, block_transmittance;
  int block_parts;
  /* The optical depth of the finished blocks. */
  TcVec before;
  /* The piece of the transfer function that each lane was in last. It is kept from packet to packet, as neighbouring
   * rays begin at similar values. */
  TcLanePieces piece;
  /* With TC_BOUND: the error that comes from the places where rays meet faces; in single precision the sum of
   * TcPassage.spread, which tc_emission_end() turns into that error. */
  TcVec moved;
  /* The finished blocks, in double precision always. */
  _Alignas(64) double color[3][TC_LANES], depth[TC_LANES], transmittance[TC_LANES];
  /* With TC_SURFACES: where the lanes are among the surfaces. */
  TcLayers layers;
  /* With TC_LIT: the light at the face where the lanes are. */
  TcLit lit;
  /* With TC_SECOND: the places among the rows of the cells that the lanes are in. */
  TcVec place;
} TcEmission;

TC_INLINE void tc_emission_begin(const TcGatherJob *job, TcEmission *e) {
  for (int k = 0; k < 3; ++k)
    e->block_color[k] = tc_set(0);
  e->block_depth = e->before = tc_set(0);
  e->block_transmittance = tc_set(1);
  e->moved = tc_set(0);
  e->block_parts = 0;
  if (job->surfaces)
    tc_layers_begin(&e->layers);
  memset(e->color, 0, sizeof e->color);
  memset(e->depth, 0, sizeof e->depth);
  for (int l = 0; l < TC_LANES; ++l)
    e->transmittance[l] = 1;
}

/* Adds the block under way to the finished ones and begins another, unless it was the last. In single precision, the
 * transmittance of all blocks before is e to a rounded depth d, which is off by at most d + 3 units of 2⁻²⁴; as e^−d d
 * < 1 − e^−d, that adds up to no more than 4 of the units of tc_tolerance_single(). */
TC_NOINLINE void tc_emission_end_block(const unsigned on, TcEmission *e, bool last) {
#if TC_SINGLE
  TcReal color[3][TC_LANES], depth[TC_LANES], before[TC_LANES];
  for (int k = 0; k < 3; ++k)
    tc_store(color[k], e->block_color[k]);
  tc_store(depth, e->block_depth);
  for (int l = 0; l < TC_LANES; ++l) {
    for (int k = 0; k < 3; ++k)
      e->color[k][l] += e->transmittance[l] * (double)color[k][l];
    e->depth[l] += (double)depth[l];
    before[l] = (TcReal)e->depth[l];
  }
  e->before = tc_load(before);
  if (last)
    return;
  if (on & TC_COLORED) {
    tc_store(depth, tc_exp(-e->before));
    for (int l = 0; l < TC_LANES; ++l)
      e->transmittance[l] = (double)depth[l];
  }
#else
  e->before += e->block_depth;
  tc_store(e->depth, e->before);
  if (on & TC_COLORED) {
    const TcVec transmittance = tc_load(e->transmittance);
    for (int k = 0; k < 3; ++k)
      tc_store(e->color[k], tc_madd(transmittance, e->block_color[k], tc_load(e->color[k])));
  }
  if (last)
    return;
  if (on & TC_COLORED) {
    const TcVec through = tc_exp(-e->before);
    tc_store(e->transmittance, on & TC_SURFACES ? through * e->layers.veil : through);
  }
#endif
  for (int k = 0; k < 3; ++k)
    e->block_color[k] = tc_set(0);
  e->block_depth = tc_set(0);
  e->block_transmittance = tc_set(1);
  e->block_parts = 0;
}

/* Adds the error of parts of segments over which the integral of the scalar's error is `spread` (tolerance.h). */
TC_INLINE void tc_emission_move(TcEmission *e, TcMask mask, TcVec length, TcVec s0, TcVec s1, TcVec spread) {
#if TC_SINGLE
  (void)length, (void)s0, (void)s1;
  e->moved += tc_select(mask, spread, tc_set(0));
#else
  const TcLanePieces *piece = &e->piece;
  const TcVec zero = tc_set(0), error = spread / length, change = tc_abs(s1 - s0), twice = spread + spread;
  TcVec moved = spread * piece->steep;
  const TcMask near = tc_or(tc_le(tc_min(s0, s1) - piece->low, error), tc_le(piece->high - tc_max(s0, s1), error));
  /* The length over which the scalar is within its error of a knot. */
  const TcVec over = tc_select(tc_lt(twice, change * length), twice / change, length);
  moved += tc_select(near, over * tc_madd(error, piece->beside, piece->jump), zero);
  e->moved += tc_select(tc_and(mask, tc_lt(zero, length)), moved, zero);
#endif
}

#if !TC_SINGLE
/* Adds the light of parts of segments that are lit (lit.h); `near` and `far` as in tc_emission_part(). */
TC_INLINE void tc_emission_lit(const unsigned on, TcEmission *e, const TcLitSegments *segments, TcVec near, TcVec far,
                               const TcLitEnds *lit) {
  const TcLanePieces *piece = &e->piece;
  const TcVec before = e->block_transmittance, w0 = before * segments->w0, w1 = before * segments->w1,
              across = before * segments->middle * (far - near), moment0 = w0 * near, moment1 = w1 * far;
  TcVec sum = w0, moment = w0, highlight = w0;
  TC_UNROLLED for (int k = 0; k < 3; ++k) {
    if (k == 0 || on & TC_TINTED) {
      const int h = k + TC_LIGHT_WIDTH(on) / 2;
      const TcVec l0 = lit->near.at[k], l1 = lit->far.at[k];
      sum = tc_madd(w0, l0, w1 * l1);
      moment = tc_madd(moment0, l0, moment1 * l1) - across * (l1 - l0);
      highlight = tc_madd(w0, lit->near.at[h], w1 * lit->far.at[h]);
    }
    e->block_color[k] += tc_madd(sum, piece->color[k], tc_madd(moment, piece->color_rise[k], highlight));
  }
  e->block_transmittance -= w0 + w1;
}
#endif

/* Adds parts of segments that lie within the lanes' pieces. Lanes to which nothing is to be added are given a length of
 * 0 and the scalar piece->from. `lit` is the light at their ends with TC_LIT. */
TC_INLINE void tc_emission_part(const unsigned on, TcEmission *e, TcReal thin, TcMask mask, TcVec length, TcVec s0,
                                TcVec s1, const TcLitEnds *lit) {
  const TcLanePieces *piece = &e->piece;
  TcVec near = s0 - piece->from, far = s1 - piece->from;
  if (on & TC_SCALED)
    near *= piece->scale, far *= piece->scale;
  const TcVec a = tc_madd(near, piece->rise, piece->extinction) * length,
              a1 = tc_madd(far, piece->rise, piece->extinction) * length;
  const TcVec half_a = (TcReal)0.5 * a, half_a1 = (TcReal)0.5 * a1, depth = half_a + half_a1;
  e->block_depth += depth;
  if (on & TC_SURFACES)
    tc_layers_descend(&e->layers, mask, a, a1, depth, length);
  if (!(on & TC_COLORED))
    return;
#if !TC_SINGLE
  if (on & TC_LIT) {
    const TcLitSegments lit_segments = tc_segments_lit(mask, a, a1, depth, half_a1 - half_a);
    tc_emission_lit(on, e, &lit_segments, near, far, lit);
    return;
  }
#endif
  (void)lit;
  const TcSegments segments = tc_segments(mask, a, a1, depth, half_a1 - half_a, thin);
  const TcVec w0 = e->block_transmittance * segments.w0, w1 = e->block_transmittance * segments.w1, sum = w0 + w1;
  const TcVec moment = tc_madd(w0, near, w1 * far);
  for (int k = 0; k < 3; ++k) {
    e->block_color[k] = tc_madd(sum, piece->color[k], tc_madd(moment, piece->color_rise[k], e->block_color[k]));
  }
  e->block_transmittance -= sum;
}

/* Adds segments of which some cross knots, one part between two knots after the other. The lengths of parts are
 * computed from differences of scalars instead of differences of positions along the segment, so that nothing cancels.
 */
TC_NOINLINE void tc_emission_parts(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask mask,
                                   const TcVec *whole_length, const TcVec *begin, const TcVec *end, const TcVec *spread,
                                   const TcLitEnds *lit) {
  const TcPieces *pieces = job->pieces;
  TcLanePieces *piece = &e->piece;
  const TcVec zero = tc_set(0), length = *whole_length, s0 = *begin, s1 = *end, whole = tc_abs(s1 - s0);
  const TcMask up = tc_le(s0, s1), flat = tc_eq(whole, zero);
  const TcVec ratio = 1 / whole;
  TcVec done = s0;
  const TcMask rising = tc_and(up, tc_and(tc_le(piece->low, done), tc_lt(done, piece->high)));
  const TcMask falling = tc_and_not(tc_and(tc_lt(piece->low, done), tc_le(done, piece->high)), up);
  const TcMask misplaced = tc_and_not(mask, tc_or(rising, falling));
  if (tc_any(misplaced)) {
    tc_pieces_locate(pieces, misplaced, &done, piece);
    if (on & TC_SECOND)
      tc_second_load(job->second, e->place, piece);
  }
  for (;;) {
    const TcMask crossing =
        tc_and(mask, tc_or(tc_and(up, tc_lt(piece->high, s1)), tc_and_not(tc_lt(s1, piece->low), up)));
    const TcVec to = tc_select(crossing, tc_select(up, piece->high, piece->low), s1);
    const TcVec fraction = tc_select(flat, tc_set(1), tc_abs(to - done) * ratio), part = length * fraction;
    if (on & TC_BOUND)
      tc_emission_move(e, mask, part, done, to, *spread * fraction);
    if (tc_any(tc_and(mask, piece->filled))) {
      if (++e->block_parts == 64)
        tc_emission_end_block(on, e, false);
      TcLitEnds part_lit, *between = NULL;
      if (on & TC_LIT) {
        between = &part_lit;
        tc_lit_between(on, lit, tc_select(flat, zero, tc_abs(done - s0) * ratio),
                       tc_select(flat, tc_set(1), tc_abs(to - s0) * ratio), &part_lit);
      }
      tc_emission_part(on, e, (TcReal)job->tolerance.thin, mask, tc_select(mask, part, zero),
                       tc_select(mask, done, piece->from), tc_select(mask, to, piece->from), between);
    }
    if (on & TC_SURFACES)
      e->layers.position += tc_select(mask, part, zero);
    if (!tc_any(crossing))
      return;
    const TcInt next = tc_select_int(up, piece->above, piece->below);
    const TcVec number = tc_to_real(next);
    const TcMask valid = tc_and(crossing, tc_and(tc_le(zero, number), tc_le(number, tc_set((TcReal)pieces->count))));
    tc_pieces_load(pieces, tc_select_int(valid, next, piece->at), piece);
    if (on & TC_SECOND)
      tc_second_load(job->second, e->place, piece);
    const TcMask reached = tc_or(tc_and(up, tc_lt(piece->low, s1)), tc_and_not(tc_lt(s1, piece->high), up));
    const TcMask further = tc_or(tc_and(up, tc_lt(piece->high, s1)), tc_and_not(tc_lt(s1, piece->low), up));
    mask = tc_and(tc_and(valid, reached), tc_or(piece->filled, further));
    if (!tc_any(mask))
      return;
    done = tc_select(mask, tc_select(up, piece->low, piece->high), done);
  }
}

/* A stretch of segments, from the scalar s0 to s1, with the light at its ends if TC_LIT. */
TC_INLINE void tc_emission_stretch(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask mask,
                                   TcVec whole_length, TcVec s0, TcVec s1, TcVec spread, const TcLitEnds *lit) {
  TcLanePieces *piece = &e->piece;
  /* A cell with a NaN at any vertex is transparent; its two faces have all four vertices between them. */
  mask = tc_and(mask, tc_and(tc_eq(s0, s0), tc_eq(s1, s1)));
  const TcVec least = tc_min(s0, s1), most = tc_max(s0, s1);
  const TcMask here = tc_and(tc_and(tc_le(piece->low, least), tc_lt(least, piece->high)), tc_le(most, piece->high));
  if (on & TC_CELLS) {
    const TcMask misplaced = tc_and_not(mask, here);
    if (TC_UNLIKELY(tc_any(misplaced))) {
      const TcVec value = s0;
      tc_pieces_locate(job->pieces, misplaced, &value, piece);
    }
  } else if (TC_UNLIKELY(tc_any(tc_and_not(mask, here)))) {
    const TcVec length = whole_length, begin = s0, end = s1, spread_of_all = spread;
    tc_emission_parts(on, job, e, mask, &length, &begin, &end, &spread_of_all, lit);
    return;
  } else if (on & TC_BOUND) {
    tc_emission_move(e, mask, whole_length, s0, s1, spread);
  }
  if (!tc_any(tc_and(mask, piece->filled)))
    return;
  const TcVec length = tc_select(mask, whole_length, tc_set(0));
  s0 = tc_select(mask, s0, piece->from);
  if (!(on & TC_CELLS)) {
    tc_emission_part(on, e, (TcReal)job->tolerance.thin, mask, length, s0, tc_select(mask, s1, piece->from), lit);
    return;
  }
  TcVec near = s0 - piece->from;
  if (on & TC_SCALED)
    near *= piece->scale;
  const TcVec depth = tc_madd(near, piece->rise, piece->extinction) * length;
  e->block_depth += depth;
  if (on & TC_SURFACES)
    tc_layers_descend(&e->layers, mask, depth, depth, depth, length);
  if (!(on & TC_COLORED))
    return;
  const TcVec weight = e->block_transmittance * tc_segments_opacity(depth), moment = weight * near;
  for (int k = 0; k < 3; ++k) {
    e->block_color[k] = tc_madd(weight, piece->color[k], tc_madd(moment, piece->color_rise[k], e->block_color[k]));
  }
  e->block_transmittance -= weight;
}

/* The lanes of `mask` meet surfaces. */
TC_INLINE void tc_emission_surface(TcEmission *e, TcMask mask, const TcMeeting *meeting) {
  const TcVec opacity = tc_select(mask, meeting->opacity, tc_set(0)), weight = e->block_transmittance * opacity;
  for (int k = 0; k < 3; ++k)
    e->block_color[k] = tc_madd(weight, tc_select(mask, meeting->color[k], tc_set(0)), e->block_color[k]);
  e->block_transmittance -= weight;
  e->layers.veil -= e->layers.veil * opacity;
}

/* The lanes of `mask` are at the boundary, with the scalar s; those that enter are at the first face of the passage,
 * others at the last. Where the scalar is NaN, nothing is seen. */
TC_NOINLINE void tc_emission_boundary(const TcGatherJob *job, TcEmission *e, TcMask mask, const TcPassage *passage,
                                      bool enter, const TcVec *s) {
  if (!(job->surfaces->boundary.opacity > 0))
    return;
  TcMeeting meeting;
  memset(&meeting, 0, sizeof meeting);
  mask = tc_and(mask, tc_eq(*s, *s));
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    tc_meet_boundary(job, passage, l, enter, (double)TC_AT(*s, l), &meeting);
  }
  tc_emission_surface(e, mask, &meeting);
  const TcVec depth = enter ? passage->entry->z : passage->walk->at.z;
  if (job->surfaces->depth)
    tc_layers_step(&e->layers, mask, &meeting, &depth);
}

/* The lanes of `mask` meet an isosurface or, those of `slices`, a slice, at `fraction` of what counts of their cells.
 */
TC_NOINLINE void tc_emission_within(const TcGatherJob *job, TcEmission *e, TcMask mask, TcMask slices, TcMask up,
                                    const TcPassage *passage, const TcVec *fraction, const TcVec *s) {
  TcMeeting meeting;
  memset(&meeting, 0, sizeof meeting);
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes), rises = tc_bits(up) >> l & 1, i = e->layers.below[l] - !rises;
    if (tc_bits(slices) >> l & 1) {
      tc_meet_slice(job, passage, &e->layers, l, (double)TC_AT(*s, l), &meeting);
    } else {
      tc_meet_isosurface(job, passage, l, i, rises, (double)TC_AT(*fraction, l), &meeting);
      tc_layers_set(job->surfaces, &e->layers, l, rises ? i + 1 : i);
    }
  }
  tc_emission_surface(e, mask, &meeting);
  const TcVec depth = tc_madd(*fraction, tc_select(mask, passage->length, tc_set(0)), passage->begin);
  if (job->surfaces->depth)
    tc_layers_step(&e->layers, mask, &meeting, &depth);
  if (tc_any(slices))
    tc_layers_next_slice(job->surfaces, passage->walk, slices, true, e->layers.slice, &e->layers);
}

/* Segments of which some meet surfaces: stretch after stretch. `mask` are the lanes for which a length of what they
 * crossed counts. Which isosurfaces are met depends on the sides of faces alone, so one that lies in a cell whose
 * length is rounded to 0 is met all the same; where it is met follows from differences of scalars, as with knots. A
 * slice is met at its depth, which is in one of the half-open intervals that make up a ray. */
TC_NOINLINE void tc_emission_meet(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask mask,
                                  const TcVec *scalar0, const TcVec *scalar1, const TcPassage *passage,
                                  const TcLitEnds *lit) {
  TcLayers *layers = &e->layers;
  const TcPacket *walk = passage->walk;
  const TcVec zero = tc_set(0), one = tc_set(1), s0 = *scalar0, s1 = *scalar1, ratio = 1 / tc_abs(s1 - s0);
  const TcVec low = tc_min(s0, s1), high = tc_max(s0, s1);
  const TcVec length = tc_select(mask, passage->length, zero), spread = on & TC_BOUND ? passage->spread : zero;
  const TcMask valid = tc_and(passage->crossed, tc_and(tc_eq(s0, s0), tc_eq(s1, s1))), flat = tc_eq(s0, s1);
  const TcMask before = tc_lt(walk->at.z, walk->rays.begin);
  tc_layers_forget(layers, tc_and(passage->crossed, tc_or(before, tc_and_not(tc_all(), valid))));
  const TcMask here = tc_and_not(valid, before), unknown = tc_and(here, tc_layers_unknown(on, layers, s0));
  tc_layers_locate(job->surfaces, layers, unknown, s0);
  tc_layers_next_slice(job->surfaces, walk, unknown, false, passage->begin, layers);
  const TcMask entering = tc_and(here, layers->entering);
  tc_emission_boundary(job, e, tc_and(entering, tc_le(walk->rays.begin, passage->entry->z)), passage, true, &s0);
  layers->entering = tc_and_not(layers->entering, passage->crossed);
  const TcMask to_the_end = tc_eq(passage->end, walk->rays.end);
  TcVec from = s0, done = zero;
  TcMask left = here, even = flat; /* those whose stretches are told by their lengths, not by the scalar */
  for (;;) {
    const TcMask up = tc_and(left, tc_le(layers->high, s1)), down = tc_and(left, tc_lt(s1, layers->low)),
                 crossing = tc_or(up, down);
    const TcVec value = tc_select(up, layers->high, tc_select(down, layers->low, s1));
    /* Where a cell was left out, the scalar may be behind the surface already. */
    TcVec to = tc_max(low, tc_min(high, value));
    TcVec at = tc_select(crossing, tc_select(flat, done, tc_abs(to - s0) * ratio), one);
    const TcMask sliced =
        tc_and(tc_le(passage->begin, layers->slice),
               tc_or(tc_lt(layers->slice, passage->end), tc_and(to_the_end, tc_le(layers->slice, passage->end))));
    const TcVec slice_at = tc_max(done, (layers->slice - passage->begin) / passage->length);
    const TcMask first =
        tc_and(tc_and(tc_and(left, mask), sliced), tc_or(tc_lt(slice_at, at), tc_and_not(sliced, crossing)));
    to = tc_select(first, tc_max(low, tc_min(high, tc_madd(slice_at, s1 - s0, s0))), to);
    at = tc_select(first, tc_min(slice_at, one), at);
    even = tc_or(even, first);
    const TcVec share = tc_select(even, at - done, tc_abs(to - from) * ratio);
    layers->position = tc_madd(done, length, passage->begin);
    TcLitEnds stretch_lit, *between = NULL;
    if (on & TC_LIT) {
      between = &stretch_lit;
      tc_lit_between(on, lit, done, at, between);
    }
    tc_emission_stretch(on, job, e, tc_and(mask, left), length * share, from, to, spread * share, between);
    const TcMask met = tc_or(crossing, first);
    if (!tc_any(met))
      break;
    tc_emission_within(job, e, met, first, up, passage, &at, &to);
    from = tc_select(met, to, from);
    done = tc_select(met, at, done);
    left = met;
  }
  const TcMask out = tc_and(tc_and(here, tc_mask_of(passage->leaving)), tc_le(walk->at.z, walk->rays.end));
  if (tc_any(out))
    tc_emission_boundary(job, e, out, passage, false, &s1);
}

/* Lanes that have more to do with surfaces in this segment than to look whether there are any. */
TC_INLINE TcMask tc_emission_meets(const unsigned on, const TcGatherJob *job, const TcEmission *e, TcMask mask,
                                   TcVec s0, TcVec s1, const TcPassage *passage) {
  const TcLayers *layers = &e->layers;
  TcMask meets = tc_and_not(passage->crossed, tc_and(tc_le(layers->low, s1), tc_lt(s1, layers->high)));
  meets = tc_or(meets, tc_and(mask, tc_le(layers->slice, passage->end)));
  if (on & TC_CORNERS)
    meets = tc_or(meets, tc_and(passage->crossed, tc_layers_unknown(on, layers, s0)));
  if (TC_UNLIKELY(passage->leaving && job->surfaces->boundary.opacity > 0))
    meets = tc_or(meets, tc_and(passage->crossed, tc_mask_of(passage->leaving)));
  return meets;
}

/* The light at the ends of what counts of the cells just crossed. */
TC_INLINE void tc_emission_light(const unsigned on, const TcGatherJob *job, TcEmission *e, const TcPassage *passage,
                                 TcLitEnds *lit) {
  lit->near = e->lit;
  tc_lit_face(on, job->lights, passage->walk, &lit->far);
  for (int j = 0; j < TC_LIGHT_WIDTH(on); ++j) /* lanes that rest are at no face */
    e->lit.at[j] = lit->far.at[j] = tc_select(passage->crossed, lit->far.at[j], e->lit.at[j]);
  if (TC_UNLIKELY(passage->partial)) {
    const TcLitEnds whole = *lit;
    tc_lit_between(on, &whole, passage->from, passage->to, lit);
  }
}

TC_INLINE void tc_emission_segment(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask mask,
                                   const TcPassage *passage) {
  TcVec s0 = passage->s0, s1 = passage->s1;
  if (on & TC_CELLS)
    s0 = s1 = tc_cell_values(job, on & TC_SURFACES ? passage->crossed : mask, passage->cell);
  if (on & TC_SECOND) {
    e->place = tc_second_cells(on, job->second, passage->cell);
    tc_second_load(job->second, e->place, &e->piece);
  }
  TcLitEnds ends, *lit = NULL;
  if (on & TC_LIT) {
    lit = &ends;
    tc_emission_light(on, job, e, passage, lit);
  }
  if (on & TC_SURFACES && TC_UNLIKELY(tc_any(tc_emission_meets(on, job, e, mask, s0, s1, passage)))) {
    const TcVec scalar0 = s0, scalar1 = s1;
    tc_emission_meet(on, job, e, mask, &scalar0, &scalar1, passage, lit);
    return;
  }
  if (on & TC_SURFACES)
    e->layers.position = passage->begin;
  tc_emission_stretch(on, job, e, mask, passage->length, s0, s1, on & TC_BOUND ? passage->spread : tc_set(0), lit);
}

TC_INLINE void tc_emission_enter(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask mask,
                                 const TcPacket *walk) {
  if (on & TC_LIT) {
    TcLit lit;
    tc_lit_face(on, job->lights, walk, &lit);
    for (int j = 0; j < TC_LIGHT_WIDTH(on); ++j)
      e->lit.at[j] = tc_select(mask, lit.at[j], e->lit.at[j]);
  }
  if (job->surfaces) {
    tc_layers_forget(&e->layers, mask);
    e->layers.entering = tc_or(e->layers.entering, mask);
  }
}

/* The lanes that are complete: those whose optical depth is beyond the tolerance's, or so large that whatever follows
 * changes no channel by half a unit in the last place. */
TC_INLINE TcMask tc_emission_complete(const unsigned on, const TcGatherJob *job, TcEmission *e, TcMask active,
                                      int64_t steps) {
  if (TC_UNLIKELY(steps % 64 == 0))
    tc_emission_end_block(on, e, false);
  const TcVec depth = e->before + e->block_depth;
  const TcReal opaque = (TcReal)job->tolerance.opaque, nearly = (TcReal)TC_NEARLY_OPAQUE;
  TcMask near = tc_and(active, tc_gt(depth, tc_set(opaque < nearly ? opaque : nearly)));
  if (on & TC_SURFACES)
    near = tc_or(near, tc_and(active, tc_eq(e->layers.veil, tc_set(0))));
  if (TC_LIKELY(!tc_any(near)) || !(on & TC_COLORED) || TC_SINGLE)
    return near;
#if !TC_SINGLE
  TcMask done = tc_gt(depth, tc_set(nearly));
  const TcVec before = tc_load(e->transmittance), left = before * e->block_transmittance;
  for (int k = 0; k < 3; ++k) {
    const TcVec color = tc_madd(before, e->block_color[k], tc_load(e->color[k]));
    double largest = job->pieces->largest[k];
    if (on & TC_LIT)
      largest = job->lights->factor * largest + job->lights->highlight;
    if (on & TC_SURFACES)
      largest = fmax(largest, job->surfaces->largest[k]);
    done = tc_and(done, tc_le(left * largest, 0x1p-54 * color));
  }
  if (on & TC_SURFACES)
    done = tc_or(done, tc_eq(e->layers.veil, tc_set(0)));
  return tc_and(active, tc_or(done, tc_gt(depth, tc_set(opaque))));
#endif
}

/* The sums are red, green, blue, alpha; if they are wanted, the depth and whether there is one, and its normal. */
TC_INLINE void tc_emission_end(const unsigned on, const TcGatherJob *job, TcEmission *e, const TcEnding *ending,
                               double (*sums)[TC_LANES]) {
  tc_emission_end_block(on, e, true);
  TcVec opacity = tc_segments_opacity(e->before);
  if (on & TC_SURFACES)
    opacity = tc_madd(opacity, e->layers.veil, 1 - e->layers.veil);
  TcReal alpha[TC_LANES];
  tc_store(alpha, opacity);
  TC_EACH_LANE sums[3][l] = (double)alpha[l];
  for (int k = 0; k < 3; ++k) {
    if (on & TC_COLORED)
      memcpy(sums[k], e->color[k], sizeof e->color[k]);
    else
      TC_EACH_LANE sums[k][l] = sums[3][l] * job->pieces->largest[k];
  }
  for (int l = 0; on & TC_SURFACES && job->surfaces->depth && l < TC_LANES; ++l) {
    const double depth = (double)TC_AT(e->layers.depth, l);
    sums[5][l] = depth < INFINITY;
    sums[4][l] = depth < INFINITY ? depth + TC_AT(ending->start, l) : 0;
    for (int k = 0; job->surfaces->normal && k < 3; ++k)
      sums[6 + k][l] = (double)TC_AT(e->layers.normal[k], l);
  }
  if (!(on & TC_BOUND))
    return;
  TC_EACH_LANE {
    const double moved = (double)TC_AT(e->moved, l) * (TC_SINGLE ? job->tolerance.per_spread : 1) +
                         job->tolerance.per_shift * (double)TC_AT(ending->shift, l);
    sums[4][l] =
        tc_tolerance_bound(&job->tolerance, e->depth[l], ending->stopped >> l & 1, sums[3][l], ending->steps, moved);
  }
}

#endif
