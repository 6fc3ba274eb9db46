/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers emission and absorption where extinction κ and emission j are fields, in groups: ∫ j e^−τ dt and τ = ∫ κ dt
 * of each group, exactly. A group's results don't depend on which other groups there are, except for their last bit.
 *
 * If there are few groups, they are integrated one after the other, with a ray in each lane. If there are many, rays
 * are integrated one after the other, with a group in each lane: a vertex's values lie next to each other in memory, so
 * that they can be loaded as vectors.
 *
 * The sums are, for each group, the radiance in the volume's unit of length and times emission_scale (so that no sum
 * along a ray overflows), the optical depth and the transmittance; then the length of the path; then the mean opacity,
 * over the groups that have an extinction of their own; and with TC_BOUND a bound on the error of colour and opacity.
 */
#ifndef TC_GATHER_COEFFICIENTS_H
#define TC_GATHER_COEFFICIENTS_H

#include "gather/length.h"
#include "optics/segment_lanes.h"
#include "volume/coefficients.h"

/* What is gathered in the lanes of a vector: of one group for all rays, or of one ray for TC_LANES groups. As in
 * TcEmission, segments are composited in blocks. */
typedef struct TcBeam {
  TcVec radiance, depth, transmittance;                   /* of the finished blocks; depth is the optical depth */
  TcVec block_radiance, block_depth, block_transmittance; /* of the block under way */
  TcVec emitted;                                          /* with TC_BOUND: Σ |radiance| as it is seen */
  TcVec depth_error, radiance_error;                      /* with TC_BOUND: bounds on errors of depth and radiance */
} TcBeam;

typedef struct TcGroups {
  bool by_rays; /* whether rays are integrated one after the other, with a group in each lane */
  int blocks;   /* by_rays: the number of vectors of TC_LANES groups */
  int columns;  /* by_rays: the number of values of a ray */
  TcBeam *beam; /* [groups]; by_rays: [TC_LANES rays][blocks] */
  /* [values][TC_LANES]; by_rays: [TC_LANES rays][columns]. The values at the face where rays have entered their cells,
   * and at the face where they have left them; and with TC_BOUND the difference between the largest and the smallest
   * value at the vertices of the latter. */
  double *near, *far, *range;
  /* [values][3][TC_LANES], not by_rays: the values at the vertices of the faces where rays are; and these vertices. */
  double *held;
  TcWord id[3];
  TcLength length;
} TcGroups;

/* Whether rays can be integrated one after the other: the values of groups that follow each other must lie next to each
 * other in memory, and there must be enough groups to fill a vector. */
TC_INLINE bool tc_groups_by_rays(const TcCoefficients *c) {
  if (TC_LANES == 1 || 2 * c->groups < TC_LANES)
    return false;
  for (int list = 0; list < 2; ++list) {
    const int *slots = c->slots + list * c->groups;
    for (int g = 1; g < c->groups; ++g) {
      if (slots[g] != slots[0] && slots[g] != slots[0] + g)
        return false;
    }
  }
  return true;
}

TC_INLINE int tc_groups_blocks(const TcCoefficients *c) {
  return (c->groups + TC_LANES - 1) / TC_LANES;
}

/* How many doubles a packet's TcGroups refers to. */
static size_t tc_groups_size(const TcCoefficients *c) {
  const size_t beams = tc_groups_by_rays(c) ? TC_LANES * (size_t)tc_groups_blocks(c) : (size_t)c->groups;
  return beams * sizeof(TcBeam) / sizeof(double) + 6 * TC_LANES * ((size_t)tc_coefficients_values(c) + TC_LANES);
}

/* Lets a packet's TcGroups refer to that many doubles at `memory`. */
static void tc_groups_place(const TcCoefficients *c, double *memory, TcGroups *groups) {
  groups->by_rays = tc_groups_by_rays(c);
  groups->blocks = tc_groups_blocks(c);
  groups->columns = tc_coefficients_values(c) + TC_LANES; /* vectors reach beyond the last value */
  groups->beam = (TcBeam *)(void *)memory;
  groups->near =
      memory + (groups->by_rays ? TC_LANES * groups->blocks : c->groups) * (int64_t)(sizeof(TcBeam) / sizeof(double));
  groups->far = groups->near + TC_LANES * groups->columns;
  groups->range = groups->far + TC_LANES * groups->columns;
  groups->held = groups->range + TC_LANES * groups->columns;
}

TC_INLINE void tc_groups_begin(const TcGatherJob *job, TcGroups *groups) {
  const int beams = groups->by_rays ? TC_LANES * groups->blocks : job->coefficients->groups;
  memset(groups->beam, 0, (size_t)beams * sizeof *groups->beam);
  for (int i = 0; i < beams; ++i)
    groups->beam[i].transmittance = groups->beam[i].block_transmittance = tc_set(1);
  tc_length_begin(job, &groups->length);
}

/* ── values at faces ── */

/* TC_LANES values that lie next to each other. */
TC_INLINE TcVec tc_groups_load(const TcRows *rows, int64_t first) {
  if (rows->is_double)
    return tc_load((const double *)rows->data + first);
#if TC_LANES == 1
  return (double)((const float *)rows->data)[first];
#else
  typedef float Floats __attribute__((vector_size(TC_LANES * sizeof(float))));
  Floats floats;
  memcpy(&floats, (const float *)rows->data + first, sizeof floats);
  return __builtin_convertvector(floats, TcVec);
#endif
}

/* The value in one column of each lane's row. */
TC_INLINE TcVec tc_groups_gather(const TcRows *rows, const int64_t row[TC_LANES], int column) {
  TcVec v = tc_set(0);
  if (rows->is_double) {
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) TC_AT(v, l) = ((const double *)rows->data)[row[l] + column];
  } else {
    TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) TC_AT(v, l) = (double)((const float *)rows->data)[row[l] + column];
  }
  return v;
}

/* Interpolates the values of points where the rays of `mask` are, with a group in each lane. */
TC_INLINE void tc_groups_at_rays(const unsigned on, const TcRows *rows, const TcGroups *groups, TcMask mask,
                                 const TcPacket *walk, double *values) {
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    TcVec weight[3];
    int64_t row[3];
    for (int k = 0; k < 3; ++k) {
      weight[k] = tc_set(TC_AT(walk->at.barycentric[k], l));
      row[k] = (int64_t)TC_AT(walk->v[k].id, l) * rows->width;
    }
    for (int i = 0; i < rows->width; i += TC_LANES) {
      const TcVec v[3] = {tc_groups_load(rows, row[0] + i), tc_groups_load(rows, row[1] + i),
                          tc_groups_load(rows, row[2] + i)};
      tc_store(values + l * groups->columns + i, tc_weighted(weight, v[0], v[1], v[2]));
      if (on & TC_BOUND)
        tc_store(groups->range + l * groups->columns + i, tc_most3(v[0], v[1], v[2]) - tc_least3(v[0], v[1], v[2]));
    }
  }
}

/* The lanes in which a and b differ. */
TC_INLINE TcMask tc_groups_differ(TcWord a, TcWord b) {
  const TcWord bits = a ^ b;
  return tc_high_bit(bits | (0 - bits)); /* one of a number that isn't 0 and its negative is negative */
}

/* Looks up the values at all three vertices of the faces where rays are, and holds them, with a ray in each lane; lanes
 * without a ray have vertices, too. */
TC_NOINLINE void tc_groups_hold_all(const TcRows *rows, TcGroups *groups, const TcPacket *walk) {
  for (int k = 0; k < 3; ++k) {
    groups->id[k] = walk->v[k].id;
    int64_t row[TC_LANES];
    for (int l = 0; l < TC_LANES; ++l)
      row[l] = (int64_t)TC_AT(walk->v[k].id, l) * rows->width;
    for (int i = 0; i < rows->width; ++i)
      tc_store(groups->held + (i * 3 + k) * TC_LANES, tc_groups_gather(rows, row, i));
  }
}

/* The same at the next face, which the rays of `mask` have come to. A step along a path brings one new vertex into the
 * face, in place of another, and only that is looked up; in lanes without a new one any is. Where cells are crossed one
 * by one, more may be new. */
TC_INLINE void tc_groups_hold(const TcRows *rows, TcGroups *groups, TcMask mask, const TcPacket *walk) {
  TcMask fresh[3];
  for (int k = 0; k < 3; ++k)
    fresh[k] = tc_groups_differ(groups->id[k], walk->v[k].id);
  const TcMask several = tc_or(tc_and(fresh[0], fresh[1]), tc_and(tc_or(fresh[0], fresh[1]), fresh[2]));
  if (TC_UNLIKELY(tc_any(tc_and(mask, several)))) {
    tc_groups_hold_all(rows, groups, walk);
    return;
  }
  for (int k = 0; k < 3; ++k)
    groups->id[k] = walk->v[k].id;
  const TcWord id = tc_select_word(fresh[0], groups->id[0], tc_select_word(fresh[1], groups->id[1], groups->id[2]));
  int64_t row[TC_LANES];
  TC_UNROLLED for (int l = 0; l < TC_LANES; ++l) row[l] = (int64_t)TC_AT(id, l) * rows->width;
  for (int i = 0; i < rows->width; ++i) {
    double *const held = groups->held + i * 3 * TC_LANES;
    const TcVec value = tc_groups_gather(rows, row, i);
    for (int k = 0; k < 3; ++k)
      tc_store(held + k * TC_LANES, tc_select(fresh[k], value, tc_load(held + k * TC_LANES)));
  }
}

/* Interpolates the values that are held where rays are. */
TC_INLINE void tc_groups_at_lanes(const unsigned on, const TcRows *rows, const TcGroups *groups, const TcPacket *walk,
                                  double *values) {
  for (int i = 0; i < rows->width; ++i) {
    const double *const held = groups->held + i * 3 * TC_LANES;
    const TcVec v[3] = {tc_load(held), tc_load(held + TC_LANES), tc_load(held + 2 * TC_LANES)};
    tc_store(values + i * TC_LANES, tc_weighted(walk->at.barycentric, v[0], v[1], v[2]));
    if (on & TC_BOUND)
      tc_store(groups->range + i * TC_LANES, tc_most3(v[0], v[1], v[2]) - tc_least3(v[0], v[1], v[2]));
  }
}

TC_NOINLINE void tc_groups_enter(const unsigned on, const TcGatherJob *job, TcGroups *groups, TcMask mask,
                                 const TcPacket *walk) {
  (void)on;
  const TcRows *rows = job->coefficients->points;
  if (!rows)
    return;
  if (groups->by_rays) {
    tc_groups_at_rays(0, rows, groups, mask, walk, groups->near);
    return;
  }
  tc_groups_hold_all(rows, groups, walk);
  tc_groups_at_lanes(0, rows, groups, walk, groups->near);
}

/* Stores the values of the cells that the rays of `mask` have crossed. */
TC_INLINE void tc_groups_in(const TcCoefficients *c, TcGroups *groups, TcMask mask, const uint32_t cell[TC_LANES]) {
  const int first = c->points ? c->points->width : 0;
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    for (int i = 0; i < c->cells->width; ++i) {
      const int at = groups->by_rays ? l * groups->columns + first + i : (first + i) * TC_LANES + l;
      groups->near[at] = groups->far[at] = tc_rows_value(c->cells, cell[l], i);
      groups->range[at] = 0;
    }
  }
}

/* ── integration ── */

/* The segments over which is integrated, in the lanes of a vector. */
typedef struct TcStretch {
  TcMask mask;
  TcVec length, from, to; /* from, to: the part of the cell that counts, as fractions, if it is `partial` */
  /* With TC_BOUND: ∫ |error of f| dt is at most |f| · spread_own + (range of f) · spread_range. */
  TcVec spread_own, spread_range;
  bool partial;
} TcStretch;

/* A value at both ends of a segment, and a bound on the integral of its error. */
typedef struct TcEnds {
  TcVec near, far, spread;
} TcEnds;

TC_INLINE TcEnds tc_groups_ends(const unsigned on, const TcGroups *groups, int at, bool same,
                                const TcStretch *stretch) {
  const TcVec v0 = same ? tc_set(groups->near[at]) : tc_load(groups->near + at),
              v1 = same ? tc_set(groups->far[at]) : tc_load(groups->far + at);
  TcEnds ends = {.near = v0, .far = v1};
  if (TC_UNLIKELY(stretch->partial)) {
    ends.near = tc_madd(stretch->from, v1 - v0, v0);
    ends.far = tc_madd(stretch->to - 1, v1 - v0, v1);
  }
  if (on & TC_BOUND) {
    const TcVec range = (same ? tc_set(groups->range[at]) : tc_load(groups->range + at)) + tc_abs(v1 - v0);
    ends.spread = tc_madd(tc_max(tc_abs(v0), tc_abs(v1)) + range, stretch->spread_own, range * stretch->spread_range);
  }
  return ends;
}

TC_INLINE TcEnds tc_groups_scaled(const unsigned on, TcEnds ends, double scale) {
  ends.near *= scale;
  ends.far *= scale;
  if (on & TC_BOUND)
    ends.spread *= scale;
  return ends;
}

/* What a segment absorbs: its optical depth, a bound on the error of it, and the moments for its emission (segment.h).
 */
typedef struct TcAbsorption {
  TcMask valid;
  TcVec depth, spread;
  TcLaneMoments moments;
} TcAbsorption;

TC_INLINE TcAbsorption tc_groups_absorb(const unsigned on, const TcCoefficients *c, const TcEnds *kappa,
                                        const TcStretch *stretch) {
  const TcVec zero = tc_set(0), most = tc_set(TC_LARGEST_EXTINCTION), length = stretch->length;
  TcVec a = tc_min(most, kappa->near * c->scale[0] * c->scale[1]) * length; /* NaN stays NaN */
  TcVec a1 = tc_min(most, kappa->far * c->scale[0] * c->scale[1]) * length;
  TcAbsorption absorption = {.valid = tc_and(stretch->mask, tc_and(tc_eq(a, a), tc_eq(a1, a1))), .spread = zero};
  a = tc_select(absorption.valid, a, zero);
  a1 = tc_select(absorption.valid, a1, zero);
  absorption.depth = 0.5 * a + 0.5 * a1;
  if (c->emission_count)
    absorption.moments = tc_moments(absorption.valid, a, a1);
  if (on & TC_BOUND)
    absorption.spread = tc_select(absorption.valid, kappa->spread * c->scale[0] * c->scale[1], zero);
  return absorption;
}

TC_INLINE void tc_groups_emit(const unsigned on, const TcEnds *emission, const TcAbsorption *absorption,
                              const TcStretch *stretch, TcBeam *beam) {
  const TcVec zero = tc_set(0), before = beam->block_transmittance;
  TcVec radiance =
      stretch->length * tc_madd(emission->near, absorption->moments.m0, emission->far * absorption->moments.m1);
  const TcMask valid = tc_and(absorption->valid, tc_eq(radiance, radiance));
  /* Rays may end at this optical depth. Whether a ray does depends on others, so what lies behind must never count. */
  const TcMask reached = tc_le(beam->depth + beam->block_depth, tc_set(TC_OPAQUE_DEPTH));
  radiance = tc_select(tc_and(valid, reached), radiance, zero);
  beam->block_radiance = tc_madd(before, radiance, beam->block_radiance);
  beam->block_transmittance *= tc_select(valid, absorption->moments.transmittance, tc_set(1));
  beam->block_depth += tc_select(valid, absorption->depth, zero);
  if (on & TC_BOUND) {
    const TcVec seen = beam->transmittance * before;
    beam->emitted = tc_madd(seen, tc_abs(radiance), beam->emitted);
    beam->depth_error += absorption->spread;
    beam->radiance_error = tc_madd(seen, tc_select(valid, emission->spread, zero), beam->radiance_error);
  }
}

TC_INLINE void tc_groups_dim(const unsigned on, const TcAbsorption *absorption, TcBeam *beam) {
  beam->block_depth += absorption->depth;
  if (on & TC_BOUND)
    beam->depth_error += absorption->spread;
}

/* Integrates all groups one after the other. An extinction that several groups in turn have is evaluated once. */
TC_INLINE void tc_groups_by_group(const unsigned on, const TcCoefficients *c, TcGroups *groups,
                                  const TcStretch *stretch) {
  TcAbsorption absorption;
  for (int g = 0; g < c->groups; ++g) {
    const int extinction = c->slots[g], emission = c->slots[c->groups + g];
    if (g == 0 || extinction != c->slots[g - 1]) {
      TcEnds kappa = {tc_set(0), tc_set(0), tc_set(0)};
      if (extinction >= 0)
        kappa = tc_groups_ends(on, groups, extinction * TC_LANES, false, stretch);
      absorption = tc_groups_absorb(on, c, &kappa, stretch);
    }
    if (emission < 0) {
      tc_groups_dim(on, &absorption, &groups->beam[g]);
      continue;
    }
    const TcEnds ends =
        tc_groups_scaled(on, tc_groups_ends(on, groups, emission * TC_LANES, false, stretch), c->emission_scale);
    tc_groups_emit(on, &ends, &absorption, stretch, &groups->beam[g]);
  }
}

/* The same in a function of its own, for fragments: it is large, and the call costs them less than it costs frames. */
TC_NOINLINE void tc_groups_by_group_apart(const unsigned on, const TcCoefficients *c, TcGroups *groups,
                                          const TcStretch *stretch) {
  tc_groups_by_group(on, c, groups, stretch);
}

/* Integrates all groups of ray `l`, TC_LANES groups at a time. Beyond the last group, lanes have values of whatever
 * lies there, negative ones among them, which no extinction may be. */
TC_INLINE void tc_groups_of_ray(const unsigned on, const TcCoefficients *c, TcGroups *groups, int l,
                                TcStretch *stretch) {
  const int extinction = c->slots[0], emission = c->slots[c->groups], first = l * groups->columns;
  const bool one_extinction = c->extinction_count == 1, one_emission = c->emission_count == 1;
  for (int block = 0; block < groups->blocks; ++block) {
    const int g = block * TC_LANES;
    if (TC_UNLIKELY(c->groups - g < TC_LANES))
      stretch->mask = tc_mask_of((1U << (c->groups - g)) - 1);
    TcBeam *beam = &groups->beam[l * groups->blocks + block];
    TcEnds kappa = {tc_set(0), tc_set(0), tc_set(0)};
    if (extinction >= 0)
      kappa = tc_groups_ends(on, groups, first + extinction + (one_extinction ? 0 : g), one_extinction, stretch);
    const TcAbsorption absorption = tc_groups_absorb(on, c, &kappa, stretch);
    if (emission < 0) {
      tc_groups_dim(on, &absorption, beam);
      continue;
    }
    const TcEnds ends = tc_groups_scaled(
        on, tc_groups_ends(on, groups, first + emission + (one_emission ? 0 : g), one_emission, stretch),
        c->emission_scale);
    tc_groups_emit(on, &ends, &absorption, stretch, beam);
  }
}

/* A group in each lane, one ray after the other. */
TC_NOINLINE void tc_groups_ray_by_ray(const unsigned on, const TcCoefficients *c, TcGroups *groups, TcMask mask,
                                      const TcStretch *all) {
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    TcStretch ray = {.mask = tc_all(),
                     .length = tc_set(TC_AT(all->length, l)),
                     .from = tc_set(TC_AT(all->from, l)),
                     .to = tc_set(TC_AT(all->to, l)),
                     .partial = all->partial,
                     .spread_own = on & TC_BOUND ? tc_set(TC_AT(all->spread_own, l)) : tc_set(0),
                     .spread_range = on & TC_BOUND ? tc_set(TC_AT(all->spread_range, l)) : tc_set(0)};
    tc_groups_of_ray(on, c, groups, l, &ray);
  }
}

TC_INLINE void tc_groups_segment(const unsigned features, const TcGatherJob *job, TcGroups *groups, TcMask mask,
                                 const TcPassage *passage) {
  /* TC_PARTS matters to the walk alone: what is called is the same with it and without. */
  const unsigned on = features & ~(unsigned)TC_PARTS;
  const TcCoefficients *c = job->coefficients;
  if (c->points && groups->by_rays) {
    tc_groups_at_rays(on, c->points, groups, passage->crossed, passage->walk, groups->far);
  } else if (c->points) {
    tc_groups_hold(c->points, groups, passage->crossed, passage->walk);
    tc_groups_at_lanes(on, c->points, groups, passage->walk, groups->far);
  }
  if (c->cells)
    tc_groups_in(c, groups, mask, passage->cell);
  tc_length_segment(on, job, &groups->length, mask, passage);
  TcStretch all;
  all.mask = mask;
  all.length = passage->length;
  all.from = passage->from;
  all.to = passage->to;
  all.partial = passage->partial;
  all.spread_own = on & TC_BOUND ? passage->length * job->rounding : tc_set(0);
  all.spread_range = on & TC_BOUND ? passage->spread : tc_set(0);
  if (groups->by_rays || features & TC_PARTS) {
    const TcStretch stored = all; /* what is called takes it from memory, what is inlined from registers */
    if (groups->by_rays)
      tc_groups_ray_by_ray(on, c, groups, mask, &stored);
    else
      tc_groups_by_group_apart(on, c, groups, &stored);
  } else {
    tc_groups_by_group(on, c, groups, &all);
  }
  double *const near = groups->near;
  groups->near = groups->far;
  groups->far = near;
}

TC_NOINLINE void tc_groups_end_blocks(const TcGatherJob *job, TcGroups *groups) {
  const int beams = groups->by_rays ? TC_LANES * groups->blocks : job->coefficients->groups;
  for (int i = 0; i < beams; ++i) {
    TcBeam *b = &groups->beam[i];
    b->radiance += b->transmittance * b->block_radiance;
    b->depth += b->block_depth;
    b->transmittance = tc_exp(-b->depth);
    b->block_radiance = b->block_depth = tc_set(0);
    b->block_transmittance = tc_set(1);
  }
}

/* The beam of ray l and group g, and the lane that it is in. */
TC_INLINE TcBeam *tc_groups_beam(const TcGroups *groups, int l, int g) {
  return &groups->beam[groups->by_rays ? l * groups->blocks + g / TC_LANES : g];
}
TC_INLINE int tc_groups_lane(const TcGroups *groups, int l, int g) {
  return groups->by_rays ? g % TC_LANES : l;
}

/* A member of it. */
#define tc_groups_of(groups, l, g, member) TC_AT(tc_groups_beam(groups, l, g)->member, tc_groups_lane(groups, l, g))

/* The lanes in `active` all of whose groups have an optical depth τ at which e^−τ is zero in double precision. */
TC_NOINLINE TcMask tc_groups_are_complete(const TcGatherJob *job, TcGroups *groups, TcMask active) {
  unsigned complete = tc_bits(active);
  for (unsigned lanes = complete; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    for (int g = 0; g < job->coefficients->groups && complete >> l & 1; ++g) {
      if (!(tc_groups_of(groups, l, g, depth) + tc_groups_of(groups, l, g, block_depth) > TC_OPAQUE_DEPTH))
        complete &= ~(1U << l);
    }
  }
  return tc_mask_of(complete);
}

TC_INLINE TcMask tc_groups_complete(const unsigned on, const TcGatherJob *job, TcGroups *groups, TcMask active,
                                    int64_t steps) {
  (void)on;
  if (TC_LIKELY(steps % 16 != 0))
    return tc_none();
  if (steps % 64 == 0)
    tc_groups_end_blocks(job, groups);
  return job->to_the_end ? tc_none() : tc_groups_are_complete(job, groups, active);
}

/* A bound on the error of a group's opacity and radiance (tolerance.h), in the mesh's unit of length. */
static double tc_groups_bound(const TcGatherJob *job, const TcGroups *groups, const TcEnding *ending, int l, int g) {
  const TcCoefficients *c = job->coefficients;
  /* Where what is seen jumps, at the shell, at faces of cells that have coefficients of their own, at the ends of the
   * ray's interval, more or less of it may be seen. */
  const double shift = (double)TC_AT(ending->shift, l),
               dimmed = fmin(TC_LARGEST_EXTINCTION, c->largest[g] * c->scale[0] * c->scale[1]) * shift,
               shone = c->largest[c->groups + g] * c->emission_scale * shift;
  const double rounding = tc_rounding(ending->steps), depth_error = tc_groups_of(groups, l, g, depth_error) + dimmed;
  const double opacity = depth_error + rounding * -expm1(-tc_groups_of(groups, l, g, depth)),
               growth = depth_error < 700 ? exp(depth_error) : INFINITY;
  const double emitted = tc_groups_of(groups, l, g, emitted) * (1 + rounding) * growth;
  const double radiance =
      growth * (tc_groups_of(groups, l, g, radiance_error) + shone) + emitted * (depth_error + rounding);
  return fmax(opacity < 1 ? opacity : 1, c->emission_count ? ldexp(radiance, job->exponent + c->emission_exponent) : 0);
}

TC_NOINLINE void tc_groups_end(const unsigned on, const TcGatherJob *job, TcGroups *groups, const TcEnding *ending,
                               double (*sums)[TC_LANES]) {
  const TcCoefficients *c = job->coefficients;
  const int distinct = c->extinction_count; /* the number of groups with a transmittance of their own */
  tc_groups_end_blocks(job, groups);
  for (int l = 0; l < TC_LANES; ++l) {
    double opacity = 0, bound = 0;
    for (int g = 0; g < c->groups; ++g) {
      sums[3 * g][l] = tc_groups_of(groups, l, g, radiance);
      sums[3 * g + 1][l] = tc_groups_of(groups, l, g, depth);
      sums[3 * g + 2][l] = tc_groups_of(groups, l, g, transmittance);
      if (g < distinct)
        opacity -= expm1(-sums[3 * g + 1][l]) / distinct;
      if (on & TC_BOUND)
        bound = fmax(bound, tc_groups_bound(job, groups, ending, l, g));
    }
    sums[3 * c->groups][l] = (double)TC_AT(groups->length.sum, l);
    sums[3 * c->groups + 1][l] = opacity;
    if (on & TC_BOUND)
      sums[3 * c->groups + 2][l] = bound;
  }
}

#endif
