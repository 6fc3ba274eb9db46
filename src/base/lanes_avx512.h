/* SPDX-License-Identifier: Apache-2.0 */
/* Eight doubles or sixteen floats, with AVX-512. Included by lanes.h. */
#include <immintrin.h>

#if TC_SINGLE
#define TC_PS(name, ...) _mm512_##name##_ps(__VA_ARGS__)
typedef __mmask16 TcMask;
typedef __m512 TcRegister;
#define TC_WORD_IS_512
#else
#define TC_PS(name, ...) _mm512_##name##_pd(__VA_ARGS__)
typedef __mmask8 TcMask;
typedef __m512d TcRegister;
#endif
#define TC_R(vector) ((TcRegister)(vector))

TC_INLINE TcMask tc_mask_of(unsigned bits) {
  return (TcMask)bits;
}
TC_INLINE unsigned tc_bits(TcMask m) {
  return m;
}
#if TC_SINGLE
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) {
  return _mm512_cmp_ps_mask(TC_R(a), TC_R(b), _CMP_LT_OQ);
}
TC_INLINE TcMask tc_le(TcVec a, TcVec b) {
  return _mm512_cmp_ps_mask(TC_R(a), TC_R(b), _CMP_LE_OQ);
}
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) {
  return _mm512_cmp_ps_mask(TC_R(a), TC_R(b), _CMP_EQ_OQ);
}
TC_INLINE TcMask tc_eq_int(TcInt a, TcInt b) {
  return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}
TC_INLINE TcMask tc_negative(TcVec a) {
  return _mm512_movepi32_mask((__m512i)a);
}
TC_INLINE TcMask tc_and(TcMask a, TcMask b) {
  return (TcMask)(a & b);
}
TC_INLINE TcMask tc_or(TcMask a, TcMask b) {
  return (TcMask)(a | b);
}
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) {
  return (TcMask)(a & ~b);
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
  return (TcWord)_mm512_mask_blend_epi32(m, (__m512i)b, (__m512i)a);
}
TC_INLINE TcVec tc_madd(TcVec a, TcVec b, TcVec c) {
  return (TcVec)_mm512_fmadd_ps(TC_R(a), TC_R(b), TC_R(c));
}
TC_INLINE TcVec tc_msub(TcVec a, TcVec b, TcVec c) {
  return (TcVec)_mm512_fmsub_ps(TC_R(a), TC_R(b), TC_R(c));
}
#else
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) {
  return _mm512_cmp_pd_mask(TC_R(a), TC_R(b), _CMP_LT_OQ);
}
TC_INLINE TcMask tc_le(TcVec a, TcVec b) {
  return _mm512_cmp_pd_mask(TC_R(a), TC_R(b), _CMP_LE_OQ);
}
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) {
  return _mm512_cmp_pd_mask(TC_R(a), TC_R(b), _CMP_EQ_OQ);
}
TC_INLINE TcMask tc_eq_int(TcInt a, TcInt b) {
  return _mm512_cmpeq_epi64_mask((__m512i)a, (__m512i)b);
}
TC_INLINE TcMask tc_negative(TcVec a) {
  return _mm512_movepi64_mask((__m512i)a);
}
TC_INLINE TcMask tc_and(TcMask a, TcMask b) {
  return (TcMask)(a & b);
}
TC_INLINE TcMask tc_or(TcMask a, TcMask b) {
  return (TcMask)(a | b);
}
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) {
  return (TcMask)(a & ~b);
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
  return (TcWord)_mm256_mask_blend_epi32(m, (__m256i)b, (__m256i)a);
}
TC_INLINE TcVec tc_madd(TcVec a, TcVec b, TcVec c) {
  return (TcVec)_mm512_fmadd_pd(TC_R(a), TC_R(b), TC_R(c));
}
TC_INLINE TcVec tc_msub(TcVec a, TcVec b, TcVec c) {
  return (TcVec)_mm512_fmsub_pd(TC_R(a), TC_R(b), TC_R(c));
}
#endif

TC_INLINE TcVec tc_select(TcMask m, TcVec a, TcVec b) {
  TcVec result = (TcVec)TC_PS(mask_blend, m, TC_R(b), TC_R(a));
  /* Keeps the compiler from turning this, and what stores it, into a masked store, from which loads have to wait. */
  __asm__("" : "+v"(result));
  return result;
}
TC_INLINE TcInt tc_bits_of(TcVec a) {
  return (TcInt)a;
}
TC_INLINE TcVec tc_of_bits(TcInt n) {
  return (TcVec)n;
}
TC_INLINE TcInt tc_select_int(TcMask m, TcInt a, TcInt b) {
  return (TcInt)tc_select(m, (TcVec)a, (TcVec)b);
}
TC_INLINE TcVec tc_abs(TcVec a) {
  return (TcVec)TC_PS(abs, TC_R(a));
}
TC_INLINE TcVec tc_min(TcVec a, TcVec b) {
  return (TcVec)TC_PS(min, TC_R(a), TC_R(b));
} /* b if one is NaN */
TC_INLINE TcVec tc_max(TcVec a, TcVec b) {
  return (TcVec)TC_PS(max, TC_R(a), TC_R(b));
}
TC_INLINE TcVec tc_sqrt(TcVec a) {
  return (TcVec)TC_PS(sqrt, TC_R(a));
}
TC_INLINE TcVec tc_to_real(TcInt a) {
  return __builtin_convertvector(a, TcVec);
}

/* How many of a, b, c, d are less than x; all are below 2³¹. */
TC_INLINE TcWord tc_rank(TcWord x, TcWord a, TcWord b, TcWord c, TcWord d) {
#if TC_SINGLE
  const __m512i one = _mm512_set1_epi32(1), X = (__m512i)x;
  __m512i rank = _mm512_maskz_mov_epi32(_mm512_cmpgt_epi32_mask(X, (__m512i)a), one);
  rank = _mm512_mask_add_epi32(rank, _mm512_cmpgt_epi32_mask(X, (__m512i)b), rank, one);
  rank = _mm512_mask_add_epi32(rank, _mm512_cmpgt_epi32_mask(X, (__m512i)c), rank, one);
  return (TcWord)_mm512_mask_add_epi32(rank, _mm512_cmpgt_epi32_mask(X, (__m512i)d), rank, one);
#else
  const __m256i X = (__m256i)x;
  const __m256i ab = _mm256_add_epi32(_mm256_cmpgt_epi32(X, (__m256i)a), _mm256_cmpgt_epi32(X, (__m256i)b));
  const __m256i cd = _mm256_add_epi32(_mm256_cmpgt_epi32(X, (__m256i)c), _mm256_cmpgt_epi32(X, (__m256i)d));
  return (TcWord)_mm256_sub_epi32(_mm256_setzero_si256(), _mm256_add_epi32(ab, cd));
#endif
}
TC_INLINE TcMask tc_high_bit(TcWord a) {
#if TC_SINGLE
  return _mm512_movepi32_mask((__m512i)a);
#else
  return _mm256_movepi32_mask((__m256i)a);
#endif
}

/* The four numbers at each lane's address become four vectors: loads and shuffles, as gather instructions take longer.
 */
TC_INLINE void tc_load_records(const TcReal *const at[TC_LANES], TcVec component[4]) {
#if TC_SINGLE
  __m512 r[4]; /* lanes j, j + 4, j + 8, j + 12: a 4 × 4 transpose in each quarter */
  for (int j = 0; j < 4; ++j) {
    r[j] = _mm512_castps128_ps512(_mm_loadu_ps(at[j]));
    r[j] = _mm512_insertf32x4(r[j], _mm_loadu_ps(at[j + 4]), 1);
    r[j] = _mm512_insertf32x4(r[j], _mm_loadu_ps(at[j + 8]), 2);
    r[j] = _mm512_insertf32x4(r[j], _mm_loadu_ps(at[j + 12]), 3);
  }
  const __m512d a = (__m512d)_mm512_unpacklo_ps(r[0], r[1]), b = (__m512d)_mm512_unpackhi_ps(r[0], r[1]);
  const __m512d c = (__m512d)_mm512_unpacklo_ps(r[2], r[3]), d = (__m512d)_mm512_unpackhi_ps(r[2], r[3]);
  component[0] = (TcVec)_mm512_unpacklo_pd(a, c);
  component[1] = (TcVec)_mm512_unpackhi_pd(a, c);
  component[2] = (TcVec)_mm512_unpacklo_pd(b, d);
  component[3] = (TcVec)_mm512_unpackhi_pd(b, d);
#else
  __m512d r[4]; /* lanes j and j + 4: a 4 × 4 transpose in each half */
  for (int j = 0; j < 4; ++j) {
    r[j] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(at[j])), _mm256_loadu_pd(at[j + 4]), 1);
  }
  const __m512d a = _mm512_unpacklo_pd(r[0], r[1]), b = _mm512_unpackhi_pd(r[0], r[1]);
  const __m512d c = _mm512_unpacklo_pd(r[2], r[3]), d = _mm512_unpackhi_pd(r[2], r[3]);
  const __m512i front = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13),
                back = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  component[0] = (TcVec)_mm512_permutex2var_pd(a, front, c);
  component[1] = (TcVec)_mm512_permutex2var_pd(b, front, d);
  component[2] = (TcVec)_mm512_permutex2var_pd(a, back, c);
  component[3] = (TcVec)_mm512_permutex2var_pd(b, back, d);
#endif
}

#if !TC_SINGLE
/* The same of numbers in single precision. */
TC_INLINE void tc_load_float_records(const float *const at[TC_LANES], TcVec component[4]) {
  __m256 r[4]; /* lanes j and j + 4: a 4 × 4 transpose in each half */
  for (int j = 0; j < 4; ++j)
    r[j] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at[j])), _mm_loadu_ps(at[j + 4]), 1);
  const __m256d a = (__m256d)_mm256_unpacklo_ps(r[0], r[1]), b = (__m256d)_mm256_unpackhi_ps(r[0], r[1]);
  const __m256d c = (__m256d)_mm256_unpacklo_ps(r[2], r[3]), d = (__m256d)_mm256_unpackhi_ps(r[2], r[3]);
  component[0] = (TcVec)_mm512_cvtps_pd((__m256)_mm256_unpacklo_pd(a, c));
  component[1] = (TcVec)_mm512_cvtps_pd((__m256)_mm256_unpackhi_pd(a, c));
  component[2] = (TcVec)_mm512_cvtps_pd((__m256)_mm256_unpacklo_pd(b, d));
  component[3] = (TcVec)_mm512_cvtps_pd((__m256)_mm256_unpackhi_pd(b, d));
}
#endif

/* a d − b c by Kahan's difference of products (Jeannerod, Louvet, Muller, 2013): to a relative error of two units in
 * the last place, so with the exact sign, or zero, as long as nothing underflows. */
TC_INLINE TcVec tc_determinant(TcVec a, TcVec b, TcVec c, TcVec d) {
  const TcVec q = b * c;
  return tc_msub(a, d, q) - tc_msub(b, c, q);
}

/* As many entries as a register has: each lane's, by a permutation. */
#define TC_HAVE_LOOKUP 1
TC_INLINE TcVec tc_lookup(const TcReal table[TC_LANES], TcInt at) {
#if TC_SINGLE
  return (TcVec)_mm512_permutexvar_ps((__m512i)at, _mm512_loadu_ps(table));
#else
  return (TcVec)_mm512_permutexvar_pd((__m512i)at, _mm512_loadu_pd(table));
#endif
}

/* The lanes of m one after the other from the first lane on, and the inverse: the first lanes of v in place of the
 * lanes of m of `others`. */
#define TC_HAVE_COMPRESS 1
TC_INLINE TcVec tc_compress(TcMask m, TcVec v) {
  return (TcVec)TC_PS(maskz_compress, m, TC_R(v));
}
TC_INLINE TcVec tc_expand(TcMask m, TcVec v, TcVec others) {
  return (TcVec)TC_PS(mask_expand, TC_R(others), m, TC_R(v));
}

#if !TC_SINGLE
/* The inverse of loading records: the lanes' four numbers go to each lane's address. */
TC_INLINE void tc_store_records(TcReal *const at[TC_LANES], const TcVec component[4]) {
  const __m512i front = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13),
                back = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  for (int j = 0; j < 2; ++j) { /* the even lanes, the odd ones */
    const __m512d a = j ? _mm512_unpackhi_pd(TC_R(component[0]), TC_R(component[1]))
                        : _mm512_unpacklo_pd(TC_R(component[0]), TC_R(component[1]));
    const __m512d b = j ? _mm512_unpackhi_pd(TC_R(component[2]), TC_R(component[3]))
                        : _mm512_unpacklo_pd(TC_R(component[2]), TC_R(component[3]));
    const __m512d outer = _mm512_permutex2var_pd(a, front, b), inner = _mm512_permutex2var_pd(a, back, b);
    _mm256_storeu_pd(at[j], _mm512_castpd512_pd256(outer));
    _mm256_storeu_pd(at[j + 2], _mm512_castpd512_pd256(inner));
    _mm256_storeu_pd(at[j + 4], _mm512_extractf64x4_pd(outer, 1));
    _mm256_storeu_pd(at[j + 6], _mm512_extractf64x4_pd(inner, 1));
  }
}

TC_INLINE TcMask tc_eq_word(TcWord a, TcWord b) {
  return _mm256_cmpeq_epi32_mask((__m256i)a, (__m256i)b);
}

/* Two words next to each other in memory, in the place of a number. */
TC_INLINE TcVec tc_two_words(TcWord first, TcWord second) {
  const __m512i low = _mm512_cvtepu32_epi64((__m256i)first), high = _mm512_cvtepu32_epi64((__m256i)second);
  return (TcVec)_mm512_or_si512(low, _mm512_slli_epi64(high, 32));
}

/* The lanes of v moved up by one, and the last lane of `before` in the first. */
TC_INLINE TcVec tc_shift_in(TcVec before, TcVec v) {
  return (TcVec)_mm512_alignr_epi64((__m512i)v, (__m512i)before, 7);
}
#endif
