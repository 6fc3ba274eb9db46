/* SPDX-License-Identifier: Apache-2.0 */
/* Two packets walked as one in single precision, for a tolerance that allows it: what tolerance.h says of it is measured here, ray by ray, and
 * rays for which it is too much are walked again in double precision.
 *
 * Vertices are projected in double precision, then rounded: a number in single precision is that exact near the ray, however far away the
 * origin is. As the rounded point is the same in every cell at the vertex, and edges are decided on exactly, this is a walk through a mesh
 * whose vertices are moved by 2^−24 of their distance from the ray: as watertight as any. */
#ifndef TC_RENDER_PACKET_SINGLE_H
#define TC_RENDER_PACKET_SINGLE_H

#include "base/simd_single.h"

#ifdef TC_HAVE_SINGLE

#include <float.h>

typedef struct SinglePoints {
  TcFloats x, y, z, s;
  TcWords id;
} SinglePoints;

/* A lane's piece each, as TcPieces.single_rows has it. */
typedef struct SinglePieces {
  TcFloats low, high, from, extinction, rise, color[3], color_rise[3], above, below, unused[3];
} SinglePieces;

/* TcParts */
typedef struct SingleParts {
  SinglePieces piece;
  TcWords at;
  TcFloats length, s0, done;
  TcFloatMask pending, filled;
} SingleParts;

typedef struct Single {
  Packet *packet; /* [2] */
  SinglePoints v[3];
  TcFloats edge[3], z, s, seen;
  TcWords cell, from;
  TcFloats color[3], depth, transmittance; /* of the block under way; packet[].lights has the finished ones */
  TcFloats before;                         /* optical depth of the finished blocks */
  TcFloats variation;                      /* Σ |s₁ − s₀| */
  TcFloats shift;                          /* Σ of how far depths at the shell are from those in double precision */
  float margin;                            /* what rounding may hide of each */
  int64_t steps;
  SingleParts parts;
  unsigned active, starting, ended, again, stopped, redo;
  unsigned met; /* lanes whose rays meet the mesh */
} Single;

typedef struct SingleStep {
  TcFives cells[2];
  SinglePoints q;
} SingleStep;

#define TC_SINGLE_CONSTANT(x) tcf_set((float)(x))
#define EACH_HALF TC_UNROLLED for (int h = 0; h < 2; ++h)

/* ── the walk ── */

TC_INLINE SinglePoints single_project(const TetcastVolume *volume, const bool wide, const Packet packet[2], TcWords id) {
  TcVec x[2], y[2], z[2], s[2];
  EACH_HALF {
    TcVec component[4];
    const TcWord half = tcf_half_words(id, h);
    tc_load_vertices(volume, wide, packet[h].rays.kz, half, component);
    const TcPoints p = tc_project_components(&packet[h].rays, component, half);
    x[h] = p.x, y[h] = p.y, z[h] = p.z, s[h] = p.s;
  }
  return (SinglePoints){tcf_join(x), tcf_join(y), tcf_join(z), tcf_join(s), id};
}

static __attribute__((noinline)) TcFloats single_ties(const SinglePoints *a, const SinglePoints *b, TcFloats e, unsigned lanes) {
  for (; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const TcPoint c = {(double)a->x[i], (double)a->y[i], 0, 0, a->id[i]}, d = {(double)b->x[i], (double)b->y[i], 0, 0, b->id[i]};
    const double edge = tc_edge(&c, &d);
    e[i] = copysignf(fmaxf(fabsf((float)edge), FLT_MIN), edge > 0 ? 1 : -1);
  }
  return e;
}

/* tc_edges(), by Kahan's difference of products (Jeannerod, Louvet, Muller, 2013): to a relative error of 2^−23 with the exact sign, unless a
 * product underflows. What comes out as good as zero is looked at in double precision, where it does not. */
TC_INLINE void single_edges(TcFloatMask active, const SinglePoints *const a[3], const SinglePoints *const b[3], TcFloats e[3]) {
  TcFloatMask zero[3];
  for (int k = 0; k < 3; ++k) {
    const TcFloats p = a[k]->y * b[k]->x;
    e[k] = tcf_msub(a[k]->x, b[k]->y, p) - tcf_msub(a[k]->y, b[k]->x, p);
    zero[k] = tcf_vanishes(e[k]);
  }
  if (!tcf_any(tcf_and(active, tcf_or(tcf_or(zero[0], zero[1]), zero[2])))) return;
  for (int k = 0; k < 3; ++k) {
    const unsigned lanes = tcf_bits(tcf_and(active, zero[k]));
    if (!lanes) continue;
    const SinglePoints c = *a[k], d = *b[k];
    e[k] = single_ties(&c, &d, e[k], lanes);
  }
}

TC_INLINE void single_cross(Single *single) {
  const SinglePoints *v = single->v;
  const TcFloats *edge = single->edge, inverse = 1 / (edge[0] + edge[1] + edge[2]);
  single->z = tcf_madd(edge[1], v[0].z, tcf_madd(edge[2], v[1].z, edge[0] * v[2].z)) * inverse;
  single->s = tcf_madd(edge[1], v[0].s, tcf_madd(edge[2], v[1].s, edge[0] * v[2].s)) * inverse;
}

TC_INLINE SinglePoints single_select(TcFloatMask m, SinglePoints a, SinglePoints b) {
  return (SinglePoints){tcf_select(m, a.x, b.x), tcf_select(m, a.y, b.y), tcf_select(m, a.z, b.z), tcf_select(m, a.s, b.s),
                        tcf_select_words(m, a.id, b.id)};
}

TC_INLINE void single_step_cells(const TetcastVolume *volume, TcFloatMask active, const Single *single, SingleStep *step) {
  const uint32_t *cells = (const uint32_t *)(const void *)volume->adjacency.cells;
  const TcWords zero = {0}, cell = tcf_select_words(active, single->cell, zero);
  EACH_HALF step->cells[h] = tc_load_fives(cells, tcf_half_words(cell, h));
  const TcWords all = tcf_join_words(tc_fives_first(&step->cells[0]), tc_fives_first(&step->cells[1]));
  step->q.id = tcf_select_words(active, all ^ single->v[0].id ^ single->v[1].id ^ single->v[2].id, zero);
}

/* tc_step_out() */
TC_INLINE TcFloatMask single_step_out(TcFloatMask active, const SingleStep *step, Single *single) {
  SinglePoints *v = single->v;
  const SinglePoints q = step->q;
  TcFloats e[3];
  single_edges(active, (const SinglePoints *const[]){&v[0], &v[1], &v[2]}, (const SinglePoints *const[]){&q, &q, &q}, e);
  TcFloatMask positive[3], out[3];
  for (int k = 0; k < 3; ++k) positive[k] = tcf_and(active, tcf_lt(tcf_set(0), e[k]));
  for (int k = 0; k < 3; ++k) out[k] = tcf_and_not(positive[(k + 2) % 3], positive[(k + 1) % 3]);
  const TcWords left = tcf_select_words(out[0], v[0].id, tcf_select_words(out[1], v[1].id, v[2].id));
  const TcWords minus_rank =
    (tcf_above(left, q.id) + tcf_above(left, v[0].id)) + (tcf_above(left, v[1].id) + tcf_above(left, v[2].id));
  TcWord next[2];
  EACH_HALF next[h] = tc_fives_ranked(&step->cells[h], tcf_half_words(minus_rank, h));
  single->cell = tcf_select_words(active, tcf_join_words(next[0], next[1]), single->cell);
  for (int k = 0; k < 3; ++k) {
    const TcFloats edge = tcf_select(out[(k + 1) % 3], e[k], single->edge[k]);
    single->edge[k] = tcf_select(out[k], -e[(k + 1) % 3], edge);
    v[k] = single_select(out[k], q, v[k]);
  }
  single_cross(single);
  return tcf_and_not(active, tcf_or(tcf_or(out[0], out[1]), out[2]));
}

/* ── light ── */

static void single_begin_block(Single *single) {
  for (int k = 0; k < 3; ++k) single->color[k] = tcf_set(0);
  single->depth = tcf_set(0);
  single->transmittance = tcf_set(1);
}

static __attribute__((noinline)) void single_end_block(const bool colored, Single *single) {
  TcVec depth[2];
  EACH_HALF {
    TcLights *lights = &single->packet[h].lights;
    for (int k = 0; colored && k < 3; ++k) lights->color[k] += lights->transmittance * tcf_half(single->color[k], h);
    lights->depth += tcf_half(single->depth, h);
    if (colored) lights->transmittance = tc_exp(-lights->depth);
    depth[h] = lights->depth;
  }
  single->before = tcf_join(depth);
  single_begin_block(single);
}

/* Segments too deep for tc_segment_thin(). */
static __attribute__((noinline)) void single_deep(TcFloatMask mask, const TcFloats ends[2], TcFloats weight[3]) {
  TcSegments segments[2];
  EACH_HALF {
    const TcVec a = tcf_half(ends[0], h), a1 = tcf_half(ends[1], h);
    segments[h] = tc_segments(tc_mask_of(tcf_bits(mask) >> h * TC_LANES & ((1U << TC_LANES) - 1)), a, a1, 0.5 * a + 0.5 * a1, 0);
  }
  weight[0] = tcf_join((const TcVec[]){segments[0].w0, segments[1].w0});
  weight[1] = tcf_join((const TcVec[]){segments[0].w1, segments[1].w1});
  weight[2] = tcf_join((const TcVec[]){segments[0].transmittance, segments[1].transmittance});
}

TC_INLINE void single_thin(TcFloats t, TcFloats d, TcFloats weight[3]) {
  TcFloats alpha, difference;
  TC_SEGMENTS_THIN(t, d, alpha, difference, tcf_madd, TC_SINGLE_CONSTANT);
  weight[0] = 0.5F * (alpha - difference);
  weight[1] = 0.5F * (alpha + difference);
  weight[2] = 1 - alpha;
}

/* Parts of segments in one piece; of length 0 in lanes not in `mask`. */
TC_INLINE void single_add_part(const bool colored, Single *single, const SinglePieces *piece, float thin, TcFloatMask mask, TcFloats length,
                               TcFloats s0, TcFloats s1) {
  const TcFloats near = s0 - piece->from, far = s1 - piece->from, zero = tcf_set(0);
  const TcFloats a = tcf_max(tcf_madd(near, piece->rise, piece->extinction), zero) * length;
  const TcFloats a1 = tcf_max(tcf_madd(far, piece->rise, piece->extinction), zero) * length;
  const TcFloats t = 0.5F * (a + a1);
  single->depth += t;
  if (!colored) return;
  TcFloats weight[3];
  if (!tcf_any(tcf_and(mask, tcf_lt(tcf_set(thin), t)))) {
    single_thin(t, 0.5F * (a1 - a), weight);
  } else {
    const TcFloats ends[2] = {a, a1};
    single_deep(mask, ends, weight);
  }
  const TcFloats w0 = single->transmittance * weight[0], w1 = single->transmittance * weight[1];
  const TcFloats sum = w0 + w1, moment = tcf_madd(w0, near, w1 * far);
  for (int k = 0; k < 3; ++k) {
    single->color[k] = tcf_madd(sum, piece->color[k], tcf_madd(moment, piece->color_rise[k], single->color[k]));
  }
  single->transmittance *= weight[2];
}

static void single_load_pieces(const TcPieces *pieces, SingleParts *parts) {
  TcFloats word[TC_PIECE_WORDS];
  _Static_assert(sizeof parts->piece == sizeof word, "loaded as records of four");
  tcf_load_records(pieces->single_rows[0], parts->at * TC_PIECE_WORDS, TC_PIECE_WORDS / 4, word);
  memcpy(&parts->piece, word, sizeof parts->piece);
  const TcFloats zero = tcf_set(0);
  parts->filled = tcf_or(tcf_lt(zero, parts->piece.extinction), tcf_lt(zero, parts->piece.rise));
}

/* tc_parts_locate(): there are no jumps, so of two pieces that meet at a knot either will do. */
static __attribute__((noinline)) void single_locate(const TcPieces *pieces, TcFloatMask mask, SingleParts *parts) {
  TcWords at = {0};
  if (pieces->count <= 32) {
    for (int64_t i = 0; i < pieces->count; ++i) {
      at += tcf_select_words(tcf_le(tcf_set((float)pieces->knots[i]), parts->done), (TcWords){0} + 1, (TcWords){0});
    }
  } else {
    for (unsigned lanes = tcf_bits(mask); lanes; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      at[i] = (uint32_t)tc_piece_above(pieces, (double)parts->done[i]);
    }
  }
  parts->at = tcf_select_words(mask, at, parts->at);
  single_load_pieces(pieces, parts);
}

/* tc_parts_next() */
static __attribute__((noinline)) void single_next(const TcPieces *pieces, TcFloatMask crossing, const TcFloats *end, SingleParts *parts) {
  typedef int32_t Ints __attribute__((vector_size(4 * TC_SINGLES)));
  const TcFloats s1 = *end;
  const TcFloatMask up = tcf_le(parts->s0, s1);
  const TcFloats next = tcf_select(up, parts->piece.above, parts->piece.below);
  const TcFloatMask valid = tcf_and(crossing, tcf_and(tcf_le(tcf_set(0), next), tcf_le(next, tcf_set((float)pieces->count))));
  parts->at = tcf_select_words(valid, (TcWords)__builtin_convertvector(next, Ints), parts->at);
  single_load_pieces(pieces, parts);
  const SinglePieces *piece = &parts->piece;
  const TcFloatMask reached = tcf_or(tcf_and(up, tcf_lt(piece->low, s1)), tcf_and_not(tcf_lt(s1, piece->high), up));
  const TcFloatMask further = tcf_or(tcf_and(up, tcf_lt(piece->high, s1)), tcf_and_not(tcf_lt(s1, piece->low), up));
  parts->pending = tcf_and(tcf_and(valid, reached), tcf_or(parts->filled, further));
  parts->done = tcf_select(parts->pending, tcf_select(up, piece->low, piece->high), parts->done);
}

/* tc_lights_add() */
TC_INLINE void single_add(const bool colored, Single *single, const TcPieces *pieces, float thin, TcFloatMask mask, TcFloats s1) {
  SingleParts *parts = &single->parts;
  const SinglePieces *piece = &parts->piece;
  const TcFloats zero = tcf_set(0);
  const TcFloatMask here = tcf_and(tcf_le(piece->low, tcf_min(parts->done, s1)), tcf_le(tcf_max(parts->done, s1), piece->high));
  TcFloatMask crossing = tcf_mask_of(0);
  TcFloats length = parts->length, end = s1;
  if (tcf_any(tcf_or(tcf_and_not(mask, here), parts->pending))) {
    const TcFloatMask up = tcf_le(parts->s0, s1);
    const TcFloatMask misplaced = tcf_and_not(mask, tcf_and(tcf_le(piece->low, parts->done), tcf_le(parts->done, piece->high)));
    if (tcf_any(misplaced)) single_locate(pieces, misplaced, parts);
    crossing = tcf_and(mask, tcf_or(tcf_and(up, tcf_lt(piece->high, s1)), tcf_and_not(tcf_lt(s1, piece->low), up)));
    end = tcf_select(crossing, tcf_select(up, piece->high, piece->low), s1);
    const TcFloats whole = tcf_abs(s1 - parts->s0);
    length *= tcf_select(tcf_lt(zero, whole), tcf_abs(end - parts->done) / whole, tcf_set(1));
  }
  if (tcf_any(tcf_and(mask, parts->filled))) {
    single_add_part(colored, single, piece, thin, mask, tcf_select(mask, length, zero), tcf_select(mask, parts->done, piece->from),
                    tcf_select(mask, end, piece->from));
  }
  parts->pending = tcf_mask_of(0);
  if (tcf_any(crossing)) single_next(pieces, crossing, &s1, parts);
}

/* add_light(): from depth z and scalar s on. */
TC_INLINE void single_add_light(const bool colored, const TcPieces *pieces, TcFloatMask moved, TcFloats z, TcFloats s, Single *single,
                                TcWorker *worker) {
  const TcFloats from = single->seen, zero = tcf_set(0);
  moved = tcf_and(moved, tcf_lt(from, single->z));
  worker->segments += __builtin_popcount(tcf_bits(moved));
  single->seen = tcf_select(moved, single->z, from);
  const TcFloatMask behind = tcf_and(moved, tcf_lt(z, from));
  if (tcf_any(behind)) {
    const TcFloats w = (from - z) / (single->z - z);
    s = tcf_select(behind, (1 - w) * s + w * single->s, s);
  }
  SingleParts *parts = &single->parts;
  single->variation += tcf_select(moved, tcf_abs(single->s - s), zero);
  parts->length = tcf_select(moved, single->z - from, parts->length);
  parts->s0 = tcf_select(moved, s, parts->s0);
  parts->done = tcf_select(moved, s, parts->done);
  single_add(colored, single, pieces, (float)worker->tolerance.thin, tcf_or(moved, parts->pending), single->s);
}

/* ── setting out, arriving ── */

/* The lanes of `starting` set out: those for which the ray crosses the face also where its vertices are rounded to. */
static void single_set_out(const TcShell *shell, const bool wide, Single *single) {
  const TcWords zero = {0};
  TcWords id[3] = {zero, zero, zero}, cell = zero;
  TcFloats depth = tcf_set(0), near = tcf_set(0);
  for (unsigned lanes = single->starting; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes), j = i % TC_LANES;
    const Packet *packet = &single->packet[i / TC_LANES];
    const TcSpan *span = &packet->spans[j].data[packet->next[j] - 1];
    const TcShellFace *face = &shell->faces[span->id];
    for (int k = 0; k < 3; ++k) id[k][i] = face->vertex[k];
    cell[i] = face->cell;
    depth[i] = (float)span->begin;
    near[i] = (float)packet->rays.near[j];
  }
  SinglePoints v[3];
  for (int k = 0; k < 3; ++k) v[k] = single_project(shell->volume, wide, single->packet, id[k]);
  TcFloats e[3];
  const TcFloatMask mask = tcf_mask_of(single->starting);
  single_edges(mask, (const SinglePoints *const[]){&v[0], &v[1], &v[2]}, (const SinglePoints *const[]){&v[1], &v[2], &v[0]}, e);
  const TcFloatMask turn = tcf_lt(e[0], tcf_set(0));
  const SinglePoints second = single_select(turn, v[2], v[1]), third = single_select(turn, v[1], v[2]);
  const TcFloats edge[3] = {tcf_select(turn, -e[2], e[0]), tcf_select(turn, -e[1], e[1]), tcf_select(turn, -e[0], e[2])};
  single->v[0] = single_select(mask, v[0], single->v[0]);
  single->v[1] = single_select(mask, second, single->v[1]);
  single->v[2] = single_select(mask, third, single->v[2]);
  for (int k = 0; k < 3; ++k) single->edge[k] = tcf_select(mask, edge[k], single->edge[k]);
  single->cell = tcf_select_words(mask, cell, single->cell);
  single_cross(single);
  single->shift += tcf_select(mask, tcf_abs(single->z - depth) + single->margin, tcf_set(0));
  single->seen = tcf_select(mask, tcf_max(single->z, near), single->seen);
  const TcFloats least = tcf_min(tcf_min(edge[0], edge[1]), edge[2]);
  single->redo |= single->starting & tcf_bits(tcf_le(least, tcf_set(0)));
  single->active |= single->starting & ~single->redo;
  single->starting = single->again = 0;
  for (unsigned lanes = single->active; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes), j = i % TC_LANES;
    const Packet *packet = &single->packet[i / TC_LANES];
    if (packet->spans[j].count - packet->next[j] > 1) single->again |= 1U << i;
  }
}

/* The lanes of `ended` must be at the next of the faces that their rays cross; they may set out anew from the one behind it. */
static void single_arrive(const TcShell *shell, Single *single) {
  const TcWords vertex_xor = single->v[0].id ^ single->v[1].id ^ single->v[2].id;
  single->active &= ~single->ended;
  for (; single->ended; single->ended &= single->ended - 1) {
    const int i = __builtin_ctz(single->ended), j = i % TC_LANES;
    Packet *packet = &single->packet[i / TC_LANES];
    const TcSpans *spans = &packet->spans[j];
    const TcSpan *end = &spans->data[packet->next[j]];
    if (packet->next[j] == spans->count || !tc_shell_face_is(&shell->faces[end->id], single->from[i], vertex_xor[i])) {
      single->redo |= 1U << i;
      continue;
    }
    single->shift[i] += fabsf(single->z[i] - (float)end->begin) + single->margin;
    if (++packet->next[j] == spans->count) continue;
    ++packet->next[j];
    single->starting |= 1U << i;
  }
}

/* at_shell() */
TC_INLINE unsigned single_at_shell(const TcShell *shell, TcFloatMask active, TcWords cell) {
  const unsigned ended = tcf_bits(tcf_and(active, tcf_high_bit(cell)));
  if (!shell->visible) return ended;
  uint32_t at[TC_SINGLES];
  memcpy(at, &cell, sizeof at);
  return ended | invisible(shell, tcf_bits(active) & ~ended, at);
}

/* advance(), of two pairs of packets. */
TC_INLINE void single_advance(const TcShell *shell, const bool wide, const bool colored, const TcPieces *pieces, TcWorker *worker,
                              Single *single) {
  TcFloatMask active[TC_PACKETS];
  bool halt = true;
  TC_EACH_PACKET {
    if (single[i].starting) single_set_out(shell, wide, &single[i]);
    active[i] = tcf_mask_of(single[i].active & ~single[i].ended);
    halt = halt && !single[i].active; /* none of those that were to set out could */
  }
  while (!halt) {
    SingleStep step[TC_PACKETS];
    TcFloats z[TC_PACKETS], s[TC_PACKETS];
    TcFloatMask walking[TC_PACKETS], lost[TC_PACKETS];
    TC_EACH_PACKET {
      walking[i] = tcf_and_not(active[i], single[i].parts.pending);
      z[i] = single[i].z;
      s[i] = single[i].s;
      single[i].from = tcf_select_words(walking[i], single[i].cell, single[i].from);
      single_step_cells(shell->volume, walking[i], &single[i], &step[i]);
    }
    TC_EACH_PACKET step[i].q = single_project(shell->volume, wide, single[i].packet, step[i].q.id);
    TC_EACH_PACKET lost[i] = single_step_out(walking[i], &step[i], &single[i]);
    TC_EACH_PACKET single_add_light(colored, pieces, tcf_and_not(walking[i], lost[i]), z[i], s[i], &single[i], worker);
    TC_EACH_PACKET {
      if (++single[i].steps % 64 == 0) single_end_block(colored, &single[i]);
      const TcFloatMask opaque = tcf_and(active[i], tcf_lt(tcf_set((float)worker->tolerance.opaque), single[i].before + single[i].depth));
      if (tcf_any(tcf_or(lost[i], opaque))) {
        single[i].stopped |= tcf_bits(opaque);
        single[i].redo |= tcf_bits(lost[i]);
        active[i] = tcf_and_not(active[i], tcf_or(lost[i], opaque));
        single[i].parts.pending = tcf_and(single[i].parts.pending, active[i]);
        single[i].active &= ~(tcf_bits(lost[i]) | tcf_bits(opaque));
        halt = halt || !single[i].active;
      }
      const TcFloatMask ready = tcf_and_not(active[i], single[i].parts.pending);
      active[i] = tcf_and_not(active[i], tcf_mask_of(single_at_shell(shell, ready, single[i].cell)));
      const unsigned ended = single[i].active & ~tcf_bits(active[i]);
      halt = halt || (ended && (ended == single[i].active || ended & single[i].again));
    }
  }
  TC_EACH_PACKET {
    single[i].ended = single[i].active & ~tcf_bits(active[i]);
    if (single[i].ended == single[i].active || single[i].ended & single[i].again) single_arrive(shell, &single[i]);
  }
}

static void single_begin(float margin, Packet packet[2], Single *single) {
  memset(single, 0, sizeof *single);
  single->packet = packet;
  single->margin = margin;
  single->starting = single->met = packet[0].starting | packet[1].starting << TC_LANES;
  single->parts.piece.low = tcf_set(1); /* and `high` is 0: nothing is there */
  single_begin_block(single);
}

/* The packet's rays in `lanes` from the start, in double precision. */
static void walk_again(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, unsigned lanes, Packet *packet) {
  Advance *const step = advance_for(shell->volume, pieces);
  Packet packets[TC_PACKETS], *again = &packets[0];
  memset(packets, 0, sizeof packets);
  *again = *packet;
  again->stopped = 0;
  again->steps = 0;
  again->seen = tc_set(0);
  tc_lights_begin(&again->lights);
  for (unsigned left = lanes; left; left &= left - 1) {
    const int i = __builtin_ctz(left);
    again->next[i] = 0;
    if (next_start(&again->spans[i], &again->next[i], &again->face[i])) again->starting |= 1U << i;
  }
  while (packet_runs(again)) step(shell, pieces, worker, packets);
  tc_lights_end_block(!pieces->one_color, &again->lights);
  const TcMask mask = tc_mask_of(lanes);
  for (int k = 0; k < 3; ++k) packet->lights.color[k] = tc_select(mask, again->lights.color[k], packet->lights.color[k]);
  packet->lights.depth = tc_select(mask, again->lights.depth, packet->lights.depth);
  packet->lights.transmittance = tc_select(mask, again->lights.transmittance, packet->lights.transmittance);
  packet->stopped = (packet->stopped & ~lanes) | again->stopped;
  if (again->steps > packet->steps) packet->steps = again->steps;
}

/* Hands the light over to the two packets; lanes in which it may be too far off are walked again. */
static void single_end(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Single *single) {
  const TcTolerance *tolerance = &worker->tolerance;
  single_end_block(!pieces->one_color, single);
  EACH_HALF {
    Packet *packet = &single->packet[h];
    const unsigned all = (1U << TC_LANES) - 1;
    const unsigned met = single->met >> h * TC_LANES & all;
    unsigned again = single->redo >> h * TC_LANES & all;
    packet->starting = 0;
    packet->stopped = single->stopped >> h * TC_LANES & all;
    packet->steps = single->steps;
    const TcVec bound = tolerance->single_fixed + tolerance->per_variation * tcf_half(single->variation, h) +
                        tolerance->per_shift * tcf_half(single->shift, h);
    again = met & (again | ~tc_bits(tc_le(bound, tc_set(tolerance->single_most))));
    packet->single = tc_select(tc_mask_of(met & ~again), bound, tc_set(0));
    if (again) walk_again(shell, pieces, worker, again, packet);
  }
}

/* All four packets, to their ends. */
TC_INLINE void single_run(const TcShell *shell, const bool wide, const bool colored, const TcPieces *pieces, TcWorker *worker, Packet *packet) {
  Single single[TC_PACKETS];
  const float margin = (float)(0x1p-22 * shell->volume->radius);
  TC_EACH_PACKET single_begin(margin, packet + 2 * i, &single[i]);
  for (bool runs = true; runs;) {
    single_advance(shell, wide, colored, pieces, worker, single);
    runs = false;
    TC_EACH_PACKET runs = runs || single[i].starting || single[i].active;
  }
  for (int i = 0; i < TC_PACKETS; ++i) single_end(shell, pieces, worker, &single[i]);
}

#define SINGLE(name, wide, colored)                                                                                            \
  static __attribute__((noinline)) void name(const TcShell *shell, const TcPieces *pieces, TcWorker *worker, Packet *packet) { \
    single_run(shell, wide, colored, pieces, worker, packet);                                                                  \
  }
SINGLE(single_depth_narrow, false, false)
SINGLE(single_depth_wide, true, false)
SINGLE(single_color_narrow, false, true)
SINGLE(single_color_wide, true, true)

static Advance *single_advance_for(const TetcastVolume *volume, const TcPieces *pieces) {
  static Advance *const ways[2][2] = {{single_depth_narrow, single_depth_wide}, {single_color_narrow, single_color_wide}};
  return ways[!pieces->one_color][volume->vertices_are_double];
}

#endif
#endif
