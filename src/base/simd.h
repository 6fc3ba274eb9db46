/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of doubles and what kernels do with them, for the instruction set that the file is compiled for: AVX-512, AVX2 with FMA, or
 * anything else by GCC's and Clang's vector extensions. Arithmetic is written with operators; multiply-adds are explicit. */
#ifndef TC_BASE_SIMD_H
#define TC_BASE_SIMD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__)
#define TC_SIMD_AVX512 1
#include <immintrin.h>
#elif defined(__AVX2__) && defined(__FMA__)
#define TC_SIMD_AVX2 1
#include <immintrin.h>
#endif

#if defined(TC_SIMD_AVX512)
enum { TC_LANES = 8 };
#else
enum { TC_LANES = 4 };
#endif

typedef double TcVec __attribute__((vector_size(8 * TC_LANES)));     /* doubles */
typedef int64_t TcLong __attribute__((vector_size(8 * TC_LANES)));   /* 64-bit integers */
typedef uint32_t TcWord __attribute__((vector_size(4 * TC_LANES)));  /* indices */
typedef double TcRecord __attribute__((vector_size(32)));            /* a vertex: x, y, z, s */

#define TC_INLINE static inline __attribute__((always_inline))

TC_INLINE TcVec tc_set(double x) { return x - (TcVec){0}; }
TC_INLINE TcWord tc_set_word(uint32_t x) { return x - (TcWord){0}; }

/* ── masks: one bit or one vector element a lane ── */

#if defined(TC_SIMD_AVX512)

typedef __mmask8 TcMask;
TC_INLINE TcMask tc_mask_of(unsigned bits) { return (TcMask)bits; }
TC_INLINE unsigned tc_bits(TcMask m) { return m; }
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) { return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ); }
TC_INLINE TcMask tc_le(TcVec a, TcVec b) { return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ); }
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) { return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_EQ_OQ); }
TC_INLINE TcMask tc_and(TcMask a, TcMask b) { return a & b; }
TC_INLINE TcMask tc_or(TcMask a, TcMask b) { return a | b; }
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) { return (TcMask)(a & ~b); }
TC_INLINE TcVec tc_select(TcMask m, TcVec a, TcVec b) {
  TcVec result = (TcVec)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
  /* Keeps the compiler from turning this, and what stores it, into a masked store, from which loads have to wait. */
  __asm__("" : "+v"(result));
  return result;
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) { return (TcWord)_mm256_mask_blend_epi32(m, (__m256i)b, (__m256i)a); }

#elif defined(TC_SIMD_AVX2)

typedef __m256d TcMask;
TC_INLINE TcMask tc_mask_of(unsigned bits) {
  const TcLong bit = {1, 2, 4, 8};
  return (TcMask)(((int64_t)bits & bit) == bit);
}
TC_INLINE unsigned tc_bits(TcMask m) { return (unsigned)_mm256_movemask_pd(m); }
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) { return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ); }
TC_INLINE TcMask tc_le(TcVec a, TcVec b) { return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LE_OQ); }
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) { return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_EQ_OQ); }
TC_INLINE TcMask tc_and(TcMask a, TcMask b) { return _mm256_and_pd(a, b); }
TC_INLINE TcMask tc_or(TcMask a, TcMask b) { return _mm256_or_pd(a, b); }
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) { return _mm256_andnot_pd(b, a); }
TC_INLINE TcVec tc_select(TcMask m, TcVec a, TcVec b) { return (TcVec)_mm256_blendv_pd((__m256d)b, (__m256d)a, m); }
TC_INLINE __m128 tc_narrow_mask(TcMask m) { /* a 32-bit element a lane */
  const __m128 low = _mm_castpd_ps(_mm256_castpd256_pd128(m)), high = _mm_castpd_ps(_mm256_extractf128_pd(m, 1));
  return _mm_shuffle_ps(low, high, 0x88);
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
  return (TcWord)_mm_blendv_ps((__m128)b, (__m128)a, tc_narrow_mask(m));
}

#else

typedef TcLong TcMask;
TC_INLINE TcMask tc_mask_of(unsigned bits) {
  const TcLong bit = {1, 2, 4, 8};
  return ((int64_t)bits & bit) == bit;
}
TC_INLINE unsigned tc_bits(TcMask m) { return (unsigned)((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8)); }
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) { return a < b; }
TC_INLINE TcMask tc_le(TcVec a, TcVec b) { return a <= b; }
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) { return a == b; }
TC_INLINE TcMask tc_and(TcMask a, TcMask b) { return a & b; }
TC_INLINE TcMask tc_or(TcMask a, TcMask b) { return a | b; }
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) { return a & ~b; }
TC_INLINE TcVec tc_select(TcMask m, TcVec a, TcVec b) { return (TcVec)((m & (TcLong)a) | (~m & (TcLong)b)); }
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
  const TcWord n = __builtin_convertvector(m, TcWord);
  return (n & a) | (~n & b);
}

#endif

TC_INLINE TcMask tc_all(void) { return tc_mask_of((1U << TC_LANES) - 1); }
TC_INLINE TcMask tc_gt(TcVec a, TcVec b) { return tc_lt(b, a); }
TC_INLINE int tc_any(TcMask m) { return tc_bits(m) != 0; }

/* ── arithmetic ── */

/* a b + c; rounded once where the instruction set can, which may change the last bit. */
TC_INLINE TcVec tc_madd(TcVec a, TcVec b, TcVec c) {
#if defined(TC_SIMD_AVX512)
  return (TcVec)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#elif defined(TC_SIMD_AVX2)
  return (TcVec)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#else
  return a * b + c;
#endif
}

/* tc_product_error() */
TC_INLINE TcVec tc_product_errors(TcVec a, TcVec b, TcVec p) {
#if defined(TC_SIMD_AVX512)
  return (TcVec)_mm512_fmsub_pd((__m512d)a, (__m512d)b, (__m512d)p);
#elif defined(TC_SIMD_AVX2)
  return (TcVec)_mm256_fmsub_pd((__m256d)a, (__m256d)b, (__m256d)p);
#elif defined(FP_FAST_FMA)
  TcVec error;
  for (int i = 0; i < TC_LANES; ++i) error[i] = fma(a[i], b[i], -p[i]);
  return error;
#else
  const TcVec c = 0x1.0000002p27 * a, d = 0x1.0000002p27 * b;
  const TcVec a_high = c - (c - a), a_low = a - a_high, b_high = d - (d - b), b_low = b - b_high;
  return ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low;
#endif
}

TC_INLINE TcVec tc_abs(TcVec a) { return (TcVec)((TcLong)a & INT64_MAX); }
#if defined(TC_SIMD_AVX512)
TC_INLINE TcVec tc_min(TcVec a, TcVec b) { return (TcVec)_mm512_min_pd((__m512d)a, (__m512d)b); } /* b if one is NaN */
TC_INLINE TcVec tc_max(TcVec a, TcVec b) { return (TcVec)_mm512_max_pd((__m512d)a, (__m512d)b); }
#elif defined(TC_SIMD_AVX2)
TC_INLINE TcVec tc_min(TcVec a, TcVec b) { return (TcVec)_mm256_min_pd((__m256d)a, (__m256d)b); }
TC_INLINE TcVec tc_max(TcVec a, TcVec b) { return (TcVec)_mm256_max_pd((__m256d)a, (__m256d)b); }
#else
TC_INLINE TcVec tc_min(TcVec a, TcVec b) { return tc_select(tc_lt(a, b), a, b); }
TC_INLINE TcVec tc_max(TcVec a, TcVec b) { return tc_select(tc_gt(a, b), a, b); }
#endif

TC_INLINE TcVec tc_sqrt(TcVec a) {
#if defined(TC_SIMD_AVX512)
  return (TcVec)_mm512_sqrt_pd((__m512d)a);
#elif defined(TC_SIMD_AVX2)
  return (TcVec)_mm256_sqrt_pd((__m256d)a);
#else
  for (int i = 0; i < TC_LANES; ++i) a[i] = sqrt(a[i]);
  return a;
#endif
}

/* 2ⁿ for whole n in [−1022, 1023]. */
TC_INLINE TcVec tc_power_of_two(TcLong n) { return (TcVec)((n + 1023) << 52); }

TC_INLINE TcLong tc_to_long(TcVec a) { return __builtin_convertvector(a, TcLong); }

/* −1 where a > b, both less than 2³¹, else 0. */
TC_INLINE TcWord tc_above(TcWord a, TcWord b) {
#if defined(TC_SIMD_AVX512)
  return (TcWord)_mm256_cmpgt_epi32((__m256i)a, (__m256i)b);
#elif defined(TC_SIMD_AVX2)
  return (TcWord)_mm_cmpgt_epi32((__m128i)a, (__m128i)b);
#else
  typedef int32_t Int __attribute__((vector_size(4 * TC_LANES)));
  return (TcWord)((Int)a > (Int)b);
#endif
}

/* The lanes whose highest bit is set. */
TC_INLINE TcMask tc_high_bit(TcWord a) {
#if defined(TC_SIMD_AVX512)
  return _mm256_movepi32_mask((__m256i)a);
#elif defined(TC_SIMD_AVX2)
  return (TcMask)_mm256_cvtepi32_epi64((__m128i)a); /* the sign is all that counts */
#else
  typedef int32_t Int __attribute__((vector_size(4 * TC_LANES)));
  return __builtin_convertvector((Int)a < 0, TcLong);
#endif
}

/* ── memory ── */

/* One record of five words a lane, words 1 to 4 still to be chosen from. Loads and permutations, as gather instructions take longer. */
typedef struct TcFives {
#if defined(TC_SIMD_AVX512)
  __m512i pair[4]; /* of lanes i and i + 4: eight words from each record on */
#else
  TcWord word[5]; /* the rows of the records' words, turned into columns */
#endif
} TcFives;

/* The records at `index`. May read 12 bytes beyond a record. */
TC_INLINE TcFives tc_load_fives(const uint32_t *words, TcWord index) {
  TcFives fives;
#if defined(TC_SIMD_AVX512)
  const __m512i wide = _mm512_cvtepu32_epi64((__m256i)index), offset = _mm512_add_epi64(_mm512_slli_epi64(wide, 2), _mm512_slli_epi64(wide, 4));
  int64_t at[8];
  memcpy(at, &offset, sizeof at);
  const char *bytes = (const char *)words;
  for (int i = 0; i < 4; ++i) {
    fives.pair[i] = _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_loadu_si256((const __m256i *)(const void *)(bytes + at[i]))),
                                       _mm256_loadu_si256((const __m256i *)(const void *)(bytes + at[i + 4])), 1);
  }
#else
  const uint32_t *record[4];
  TcWord row[4];
  for (int i = 0; i < 4; ++i) {
    record[i] = words + 5 * (size_t)index[i];
    memcpy(&row[i], record[i] + 1, sizeof row[i]);
  }
  fives.word[0] = (TcWord){*record[0], *record[1], *record[2], *record[3]};
  const TcWord a = __builtin_shufflevector(row[0], row[1], 0, 4, 1, 5), b = __builtin_shufflevector(row[2], row[3], 0, 4, 1, 5);
  const TcWord c = __builtin_shufflevector(row[0], row[1], 2, 6, 3, 7), d = __builtin_shufflevector(row[2], row[3], 2, 6, 3, 7);
  fives.word[1] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
  fives.word[2] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
  fives.word[3] = __builtin_shufflevector(c, d, 0, 1, 4, 5);
  fives.word[4] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
#endif
  return fives;
}

#if defined(TC_SIMD_AVX512)
/* Word `at`, less than 8, of each record. */
TC_INLINE TcWord tc_fives_word(const TcFives *fives, __m256i at) {
  const __m256i base = _mm256_setr_epi32(0, 16, 0, 16, 8, 24, 8, 24);
  const __m512i index = _mm512_castsi256_si512(_mm256_add_epi32(base, at));
  const __m256i front = _mm512_castsi512_si256(_mm512_permutex2var_epi32(fives->pair[0], index, fives->pair[1]));
  const __m256i back = _mm512_castsi512_si256(_mm512_permutex2var_epi32(fives->pair[2], index, fives->pair[3]));
  return (TcWord)_mm256_blend_epi32(front, back, 0xCC);
}
#endif

TC_INLINE TcWord tc_fives_first(const TcFives *fives) {
#if defined(TC_SIMD_AVX512)
  return tc_fives_word(fives, _mm256_setzero_si256());
#else
  return fives->word[0];
#endif
}

/* Word 1 + rank; the rank, up to 3, comes as −rank: a sum of comparisons. */
TC_INLINE TcWord tc_fives_ranked(const TcFives *fives, TcWord minus_rank) {
#if defined(TC_SIMD_AVX512)
  return tc_fives_word(fives, (__m256i)(1 - minus_rank));
#else
  const TcWord rank = -minus_rank, *word = fives->word, odd = -(rank & 1), upper = -(rank >> 1);
  const TcWord low = (word[2] & odd) | (word[1] & ~odd), high = (word[4] & odd) | (word[3] & ~odd);
  return (high & upper) | (low & ~upper);
#endif
}

/* The four components of one record a lane. */
TC_INLINE void tc_transpose(const TcRecord record[TC_LANES], TcVec component[4]) {
#if defined(TC_SIMD_AVX512)
  __m512d pair[4];
  for (int i = 0; i < 4; ++i) {
    pair[i] = _mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)record[i]), (__m256d)record[i + 4], 1);
  }
  /* pair[i] = (record i | record i + 4): a 4 × 4 transpose in each half. */
  const __m512d a = _mm512_unpacklo_pd(pair[0], pair[1]), b = _mm512_unpackhi_pd(pair[0], pair[1]);
  const __m512d c = _mm512_unpacklo_pd(pair[2], pair[3]), d = _mm512_unpackhi_pd(pair[2], pair[3]);
  const __m512i front = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), back = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  component[0] = (TcVec)_mm512_permutex2var_pd(a, front, c);
  component[1] = (TcVec)_mm512_permutex2var_pd(b, front, d);
  component[2] = (TcVec)_mm512_permutex2var_pd(a, back, c);
  component[3] = (TcVec)_mm512_permutex2var_pd(b, back, d);
#else
  const TcVec a = __builtin_shufflevector(record[0], record[1], 0, 4, 2, 6), b = __builtin_shufflevector(record[0], record[1], 1, 5, 3, 7);
  const TcVec c = __builtin_shufflevector(record[2], record[3], 0, 4, 2, 6), d = __builtin_shufflevector(record[2], record[3], 1, 5, 3, 7);
  component[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  component[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  component[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  component[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
#endif
}

/* Components 0, 1, 2 become those along kx, ky, kz: kx = (kz + 1) % 3, ky = (kz + 2) % 3. */
TC_INLINE void tc_turn(int kz, TcVec component[3]) {
  const TcVec x = component[0], y = component[1], z = component[2];
  switch (kz) { /* the same for many packets: well predicted */
  case 0: component[0] = y, component[1] = z, component[2] = x; break;
  case 1: component[0] = z, component[1] = x, component[2] = y; break;
  default: break;
  }
}

typedef float TcNarrow __attribute__((vector_size(16))); /* a vertex in single precision */

/* tc_transpose() and tc_turn(): shuffled first, as half as long vectors. */
TC_INLINE void tc_transpose_narrow(const TcNarrow record[TC_LANES], int kz, TcVec component[4]) {
#if defined(TC_SIMD_AVX512)
#define TC_COLUMN(k) (k), (k) + 4, (k) + 8, (k) + 12, (k) + 16, (k) + 20, (k) + 24, (k) + 28
  static const _Alignas(64) int32_t columns[3][2][16] = {{{TC_COLUMN(1), TC_COLUMN(2)}, {TC_COLUMN(0), TC_COLUMN(3)}},
                                                         {{TC_COLUMN(2), TC_COLUMN(0)}, {TC_COLUMN(1), TC_COLUMN(3)}},
                                                         {{TC_COLUMN(0), TC_COLUMN(1)}, {TC_COLUMN(2), TC_COLUMN(3)}}};
#undef TC_COLUMN
  __m512 half[2];
  for (int i = 0; i < 2; ++i) {
    half[i] = _mm512_insertf32x4(_mm512_castps128_ps512((__m128)record[4 * i]), (__m128)record[4 * i + 1], 1);
    half[i] = _mm512_insertf32x4(half[i], (__m128)record[4 * i + 2], 2);
    half[i] = _mm512_insertf32x4(half[i], (__m128)record[4 * i + 3], 3);
  }
  for (int k = 0; k < 4; k += 2) {
    const __m512 pair = _mm512_permutex2var_ps(half[0], _mm512_load_si512(columns[kz][k / 2]), half[1]);
    component[k] = (TcVec)_mm512_cvtps_pd(_mm512_castps512_ps256(pair));
    component[k + 1] = (TcVec)_mm512_cvtps_pd(_mm512_extractf32x8_ps(pair, 1));
  }
#else
  const TcNarrow a = __builtin_shufflevector(record[0], record[1], 0, 4, 1, 5), b = __builtin_shufflevector(record[2], record[3], 0, 4, 1, 5);
  const TcNarrow c = __builtin_shufflevector(record[0], record[1], 2, 6, 3, 7), d = __builtin_shufflevector(record[2], record[3], 2, 6, 3, 7);
  component[0] = __builtin_convertvector(__builtin_shufflevector(a, b, 0, 1, 4, 5), TcVec);
  component[1] = __builtin_convertvector(__builtin_shufflevector(a, b, 2, 3, 6, 7), TcVec);
  component[2] = __builtin_convertvector(__builtin_shufflevector(c, d, 0, 1, 4, 5), TcVec);
  component[3] = __builtin_convertvector(__builtin_shufflevector(c, d, 2, 3, 6, 7), TcVec);
  tc_turn(kz, component);
#endif
}

/* Four doubles from each of base[offset[i]], base[offset[i] + 4], …: component[4 k + j][i] is double j of record k of lane i. Loads and
 * shuffles, as above. `count`, of records, is a constant wherever this is used. */
TC_INLINE void tc_load_records(const double *base, TcLong offset, const int count, TcVec component[]) {
  int64_t at[TC_LANES];
  memcpy(at, &offset, sizeof at);
  for (int k = 0; k < count; ++k) {
    TcRecord record[TC_LANES];
    for (int i = 0; i < TC_LANES; ++i) memcpy(&record[i], base + at[i] + 4 * k, sizeof record[i]);
    tc_transpose(record, component + 4 * k);
  }
}

/* The whole number nearest to a, |a| < 2⁵¹; as a double. */
TC_INLINE TcLong tc_nearest(TcVec a, TcVec *whole) {
  const TcVec shift = tc_set(0x1.8p52), sum = a + shift;
  *whole = sum - shift;
  return (TcLong)sum - (TcLong)shift;
}

TC_INLINE TcLong tc_select_long(TcMask m, TcLong a, TcLong b) { return (TcLong)tc_select(m, (TcVec)a, (TcVec)b); }

#endif
