/* SPDX-License-Identifier: Apache-2.0 */
/* The tally of one instruction set: this file is compiled once for each, with TC_LANES and TC_LANES_NAME given by the
 * build (CMakeLists.txt). First, a vector holds so many tetrahedra, then so many edges between bins of one tetrahedron.
 * No multiplication is fused with an addition here, so that all instruction sets give the same bits. */
#include "volume/tally.h"

#include "base/lanes.h"

/* So many cells are gathered into arrays before vectors are loaded from these. */
enum { CELLS = 64 };

/* With d = s₃ − s₀, the density of values at v is 3 q / d, and the share of the volume below v is its integral. q is a
 * quadratic B-spline with the knots s₀ … s₃. With tᵢ, from 0 to 1, the place of v between the knots sᵢ and sᵢ₊₁, it is
 *
 *     b₀ t₀²     b₀ (1 − t₁)² + 2 (1 − t₁) t₁ + b₂ t₁²     b₂ (1 − t₂)²
 *
 * where b₀ = (s₁ − s₀) / (s₂ − s₀) and b₂ = (s₃ − s₂) / (s₃ − s₁), and its integral is a sum of three cubic polynomials
 * of t₀, t₁ and t₂, each with the constant 0. All of these quotients are at most 1 and have differences of neighbouring
 * numbers in them alone, so that nothing cancels or overflows. */
typedef struct Block {
  double position[4][3][CELLS];
  double s[4][CELLS]; /* the values; once measured, ascending, and the last one NaN if one of them is not finite */
  double volume[CELLS], gradient[CELLS], place[CELLS];
  double per_value[3][CELLS]; /* 1 / (sᵢ₊₁ − sᵢ) */
  double b0[CELLS], b2[CELLS], q[2][CELLS];
  double first[CELLS], middle[3][CELLS], last[CELLS]; /* the volume below v by powers of tᵢ */
  double area[CELLS];                                 /* of the isosurface, over q */
} Block;

/* ── tetrahedra in vectors ── */

TC_INLINE double real_at(const char *from, bool wide) {
  double x;
  float narrow;
  if (wide) {
    memcpy(&x, from, sizeof x);
    return x;
  }
  memcpy(&narrow, from, sizeof narrow);
  return (double)narrow;
}

TC_INLINE void gather_positions(const TetcastArray coordinates[3], uint32_t vertex[CELLS][4], bool wide, Block *block) {
  for (int l = 0; l < CELLS; ++l) {
    for (int k = 0; k < 4; ++k) {
      for (int j = 0; j < 3; ++j) {
        const TetcastArray *of = &coordinates[j];
        block->position[k][j][l] = real_at((const char *)of->data + vertex[l][k] * of->stride, wide);
      }
    }
  }
}

TC_INLINE void gather_point_values(const TetcastArray *values, uint32_t vertex[CELLS][4], bool wide, Block *block) {
  const char *data = values->data;
  const int64_t stride = values->stride;
  for (int l = 0; l < CELLS; ++l) {
    for (int k = 0; k < 4; ++k)
      block->s[k][l] = real_at(data + vertex[l][k] * stride, wide);
  }
}

static void gather_values(const TetcastField *field, int64_t begin, int count, uint32_t vertex[CELLS][4],
                          Block *block) {
  if (field->association == TETCAST_POINT && field->values.type == TETCAST_TYPE_FLOAT32) {
    gather_point_values(&field->values, vertex, false, block);
  } else if (field->association == TETCAST_POINT && field->values.type == TETCAST_TYPE_FLOAT64) {
    gather_point_values(&field->values, vertex, true, block);
  } else {
    for (int l = 0; l < count; ++l) {
      for (int k = 0; k < 4; ++k)
        block->s[k][l] = tc_field_at(field, field->association == TETCAST_POINT  ? vertex[l][k]
                                            : field->association == TETCAST_CELL ? begin + l
                                                                                 : 4 * (begin + l) + k);
    }
  }
}

/* Cells beyond `count`, at the end of the mesh, have the first vertex four times, and hidden cells one of theirs. */
static void gather(const TcTally *tally, int64_t begin, int count, Block *block) {
  uint32_t vertex[CELLS][4];
  for (int l = 0; l < count; ++l) {
    tc_mesh_cell(tally->mesh, begin + l, vertex[l]);
    for (int k = 1; tc_mesh_hides(tally->mesh, begin + l) && k < 4; ++k)
      vertex[l][k] = vertex[l][0];
  }
  memset(vertex[count], 0, (size_t)(CELLS - count) * sizeof *vertex);
  if (tally->mesh->vertices.type == TETCAST_TYPE_FLOAT32)
    gather_positions(tally->mesh->coordinates, vertex, false, block);
  else
    gather_positions(tally->mesh->coordinates, vertex, true, block);
  gather_values(tally->field, begin, count, vertex, block);
}

TC_INLINE void cross(const TcVec a[3], const TcVec b[3], TcVec c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

TC_INLINE TcVec dot(const TcVec a[3], const TcVec b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TC_INLINE void order(TcVec *a, TcVec *b) {
  const TcVec smaller = tc_min(*a, *b);
  *b = tc_max(*a, *b);
  *a = smaller;
}

/* The volumes and gradients, by the formula of gradients.h. */
TC_INLINE void measure_volume(const TcTally *tally, Block *block, int l, const TcVec s[4]) {
  TcVec p[4][3], edge[3][3], across[3], sum[3], determinant = tc_set(0);
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 3; ++j)
      p[k][j] = tc_load(&block->position[k][j][l]) * tally->length_factor[0] * tally->length_factor[1];
  }
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j)
      edge[k][j] = p[k + 1][j] - p[0][j];
  }
  for (int k = 0; k < 3; ++k) {
    cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across);
    if (k == 0)
      determinant = dot(edge[0], across);
    for (int j = 0; j < 3; ++j)
      sum[j] = k == 0 ? (s[1] - s[0]) * across[j] : sum[j] + (s[k + 1] - s[0]) * across[j];
  }
  const TcVec six_volumes = tc_abs(determinant);
  tc_store(&block->volume[l], six_volumes * (1. / 6));
  if (tally->surfaces || tally->rows > 0 || tally->steepest)
    tc_store(&block->gradient[l],
             tc_select(tc_lt(tc_set(0), six_volumes), tc_sqrt(dot(sum, sum)) / six_volumes, tc_set(0)));
}

/* Puts the values in order, and finds what needs no spline. */
TC_INLINE void measure(const TcTally *tally, Block *block, int l) {
  const TcVec most = tc_set(0x1p1022); /* so that differences don't overflow */
  TcVec s[4], wrong = tc_set(0);
  for (int k = 0; k < 4; ++k) {
    s[k] = tc_load(&block->s[k][l]);
    wrong = wrong + s[k] * 0; /* NaN as soon as a value is not finite */
    s[k] = tc_max(tc_min(s[k] * tally->value_factor[0] * tally->value_factor[1], most), -most);
  }
  measure_volume(tally, block, l, s);
  order(&s[0], &s[1]);
  order(&s[2], &s[3]);
  order(&s[0], &s[2]);
  order(&s[1], &s[3]);
  order(&s[1], &s[2]);
  const TcVec place = (s[0] - tally->edges[0]) * tally->per_value + 0.5;
  tc_store(&block->place[l], tc_min(tc_max(place, tc_set(0)), tc_set(tally->place_count - 1)));
  s[3] = s[3] + wrong;
  for (int k = 0; k < 4; ++k)
    tc_store(&block->s[k][l], s[k]);
}

/* The reciprocals of two numbers, with one division. Numbers below 2⁻⁵⁰⁰, of a largest value near 1, are taken for
 * that, so that nothing overflows: 0 times its reciprocal is 0. */
TC_INLINE void invert(TcVec a, TcVec b, TcVec *inverse_a, TcVec *inverse_b) {
  const TcVec least = tc_set(0x1p-500), c = tc_max(a, least), d = tc_max(b, least), inverse = 1 / (c * d);
  *inverse_a = inverse * d;
  *inverse_b = inverse * c;
}

TC_INLINE void find_splines(Block *block, int l) {
  TcVec s[4], r10, r21, r32, r20, r31, r30;
  for (int k = 0; k < 4; ++k)
    s[k] = tc_load(&block->s[k][l]);
  invert(s[1] - s[0], s[3] - s[2], &r10, &r32);
  invert(s[2] - s[0], s[3] - s[1], &r20, &r31);
  invert(s[2] - s[1], s[3] - s[0], &r21, &r30);
  const TcVec volume = tc_load(&block->volume[l]), middle = volume * ((s[2] - s[1]) * r30), b0 = (s[1] - s[0]) * r20,
              b2 = (s[3] - s[2]) * r31;
  tc_store(&block->per_value[0][l], r10);
  tc_store(&block->per_value[1][l], r21);
  tc_store(&block->per_value[2][l], r32);
  tc_store(&block->b0[l], b0);
  tc_store(&block->b2[l], b2);
  tc_store(&block->q[0][l], 2 * (1 - b0));
  tc_store(&block->q[1][l], b0 - 2 + b2);
  tc_store(&block->first[l], volume * (b0 * ((s[1] - s[0]) * r30)));
  tc_store(&block->middle[0][l], middle * (3 * b0));
  tc_store(&block->middle[1][l], middle * (3 * (1 - b0)));
  tc_store(&block->middle[2][l], middle * (b0 - 2 + b2));
  tc_store(&block->last[l], volume * (b2 * ((s[3] - s[2]) * r30)));
  tc_store(&block->area[l], 3 * volume * (tc_load(&block->gradient[l]) * r30));
}

/* ── edges in vectors ── */

/* q at edges v > s₀ and the volumes below them; at s₃, q is its limit from below, and beyond it is 0. One lane computes
 * the polynomials of one piece alone. */
TC_INLINE TcVec splines_at(const Block *block, int l, TcVec v, TcVec *below) {
  const TcVec s3 = tc_set(block->s[3][l]);
  const TcMask beyond2 = tc_lt(tc_set(block->s[2][l]), v),
               middle = tc_and_not(tc_lt(tc_set(block->s[1][l]), v), beyond2);
  TcVec q = tc_set(0);
  *below = q;
  if (TC_LANES > 1 || !tc_any(middle)) { /* the outer two are a constant and a power of the distance from s₀ or s₃ */
    const TcVec t = (tc_min(v, s3) - tc_select(beyond2, s3, tc_set(block->s[0][l]))) *
                    tc_select(beyond2, tc_set(block->per_value[2][l]), tc_set(block->per_value[0][l]));
    const TcVec square = t * t;
    q = tc_select(beyond2, tc_set(block->b2[l]), tc_set(block->b0[l])) * square;
    *below = tc_select(beyond2, tc_set(block->volume[l]), tc_set(0)) +
             tc_select(beyond2, tc_set(block->last[l]), tc_set(block->first[l])) * (square * t);
  }
  if (TC_LANES > 1 || tc_any(middle)) {
    const TcVec t = (v - block->s[1][l]) * block->per_value[1][l];
    q = tc_select(middle, block->b0[l] + t * (block->q[0][l] + t * block->q[1][l]), q);
    *below = tc_select(
        middle, block->first[l] + t * (block->middle[0][l] + t * (block->middle[1][l] + t * block->middle[2][l])),
        *below);
  }
  return tc_max(q, tc_set(0));
}

TC_INLINE void add(double *to, TcVec v) {
  tc_store(to, tc_load(to) + v);
}

/* Adds a cell that has edges between its values, the first of which is edges[i]. At its largest value a cell has the
 * isosurface still, at its smallest no more. */
TC_INLINE void add_crossed(const TcTally *tally, const Block *block, int l, int i, double *joint, TcTallySums *sums) {
  const double *edges = tally->edges;
  double *volumes = sums->volume, *areas = sums->area, *gradients = sums->gradient;
  const double s3 = block->s[3][l];
  const TcVec area_over_q = tc_set(block->area[l]), gradient = tc_set(block->gradient[l]);
  TcVec before = tc_set(0);
  do {
    TcVec below;
    const TcVec q = splines_at(block, l, tc_load(&edges[i]), &below), volume = below - tc_shift_in(before, below);
    add(&volumes[i], volume);
    if (joint)
      add(&joint[i], volume);
    if (areas) {
      const TcVec area = q * area_over_q;
      add(&areas[i], area);
      add(&gradients[i], area * gradient);
    }
    before = below;
    i += TC_LANES;
  } while (edges[i - 1] < s3);
}

/* The first edge above the smallest value, found by halving without a branch, which would be guessed wrong half of the
 * time. */
TC_INLINE int first_above(const TcTally *tally, const Block *block, int l) {
  const int place = (int)block->place[l];
  int i = tally->places[place];
  for (int count = tally->places[place + 1] - i; count > 0;) {
    const int half = count / 2, above = tally->edges[i + half] <= block->s[0][l];
    i += above * (half + 1);
    count = (count - above) / 2;
  }
  return i;
}

static double *row_of(const TcTally *tally, double gradient, TcTallySums *sums) {
  const double place = (gradient - tally->least_gradient) * tally->rows_per_gradient;
  const int row = !(place > 0) ? 0 : place < tally->rows ? (int)place : tally->rows - 1;
  return sums->joint + (int64_t)row * tc_tally_width(tally);
}

static void add_cells(const TcTally *tally, Block *block, int count, TcTallySums *sums) {
  int splines = 0; /* so many cells have splines so far */
  for (int l = 0; l < count; ++l) {
    const double s0 = block->s[0][l], s3 = block->s[3][l], volume = block->volume[l];
    if (isnan(s3)) {
      sums->unknown += volume;
      continue;
    }
    sums->total += volume;
    if (tally->steepest && block->gradient[l] > sums->steepest)
      sums->steepest = block->gradient[l];
    int i = first_above(tally, block, l);
    double *joint = tally->rows > 0 ? row_of(tally, block->gradient[l], sums) : NULL;
    if (s0 < s3 && tally->edges[i] <= s3) {
      for (; splines <= l; splines += TC_LANES)
        find_splines(block, splines);
      add_crossed(tally, block, l, i, joint, sums);
      continue;
    }
    if (s0 == s3 && s0 == tally->edges[tally->bins]) /* the range's upper end belongs to the last bin */
      i = tally->bins;
    sums->volume[i] += volume;
    if (joint)
      joint[i] += volume;
  }
}

#define NAME_OF(name) tc_tally_##name
#define NAME(name)    NAME_OF(name)

void NAME(TC_LANES_NAME)(const TcTally *tally, int64_t begin, int64_t end, TcTallySums *sums) {
  _Alignas(64) Block block = {0};
  for (; begin < end; begin += CELLS) {
    const int count = end - begin < CELLS ? (int)(end - begin) : CELLS;
    gather(tally, begin, count, &block);
    for (int l = 0; l < CELLS; l += TC_LANES)
      measure(tally, &block, l);
    add_cells(tally, &block, count, sums);
  }
}
