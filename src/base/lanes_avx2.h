/* SPDX-License-Identifier: Apache-2.0 */
/* Four doubles or eight floats, with AVX2 and FMA. Included by lanes.h. */
#include <immintrin.h>

typedef TcInt TcMask; /* −1 or 0 a lane */

#if TC_SINGLE
typedef __m256 TcRegister;
#define TC_PS(name, ...) _mm256_##name##_ps(__VA_ARGS__)
#else
typedef __m256d TcRegister;
#define TC_PS(name, ...) _mm256_##name##_pd(__VA_ARGS__)
#endif
#define TC_R(vector) ((TcRegister)(vector))

TC_INLINE TcMask tc_mask_of(unsigned bits) {
#if TC_SINGLE
  const TcInt bit = {1, 2, 4, 8, 16, 32, 64, 128};
#else
  const TcInt bit = {1, 2, 4, 8};
#endif
  return ((TcInteger)bits & bit) == bit;
}
TC_INLINE unsigned tc_bits(TcMask m) {
  return (unsigned)TC_PS(movemask, TC_R(m));
}
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) {
  return (TcMask)TC_PS(cmp, TC_R(a), TC_R(b), _CMP_LT_OQ);
}
TC_INLINE TcMask tc_le(TcVec a, TcVec b) {
  return (TcMask)TC_PS(cmp, TC_R(a), TC_R(b), _CMP_LE_OQ);
}
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) {
  return (TcMask)TC_PS(cmp, TC_R(a), TC_R(b), _CMP_EQ_OQ);
}
TC_INLINE TcMask tc_eq_int(TcInt a, TcInt b) {
  return a == b;
}
TC_INLINE TcMask tc_negative(TcVec a) {
  return (TcInt)a < 0;
}
TC_INLINE TcMask tc_and(TcMask a, TcMask b) {
  return a & b;
}
TC_INLINE TcMask tc_or(TcMask a, TcMask b) {
  return a | b;
}
TC_INLINE TcMask tc_and_not(TcMask a, TcMask b) {
  return a & ~b;
}
TC_INLINE TcVec tc_select(TcMask m, TcVec a, TcVec b) {
  return (TcVec)TC_PS(blendv, TC_R(b), TC_R(a), TC_R(m));
}
TC_INLINE TcInt tc_select_int(TcMask m, TcInt a, TcInt b) {
  return (TcInt)tc_select(m, (TcVec)a, (TcVec)b);
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
#if TC_SINGLE
  return (TcWord)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
#else
  const __m128 low = (__m128)_mm256_castsi256_si128((__m256i)m), high = (__m128)_mm256_extracti128_si256((__m256i)m, 1);
  return (TcWord)_mm_blendv_ps((__m128)b, (__m128)a, _mm_shuffle_ps(low, high, 0x88));
#endif
}
TC_INLINE TcVec tc_madd(TcVec a, TcVec b, TcVec c) {
  return (TcVec)TC_PS(fmadd, TC_R(a), TC_R(b), TC_R(c));
}
TC_INLINE TcVec tc_msub(TcVec a, TcVec b, TcVec c) {
  return (TcVec)TC_PS(fmsub, TC_R(a), TC_R(b), TC_R(c));
}
TC_INLINE TcInt tc_bits_of(TcVec a) {
  return (TcInt)a;
}
TC_INLINE TcVec tc_of_bits(TcInt n) {
  return (TcVec)n;
}
TC_INLINE TcVec tc_abs(TcVec a) {
  return (TcVec)((TcInt)a & (TC_SINGLE ? INT32_MAX : INT64_MAX));
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
#define TC_ABOVE(y) _mm256_cmpgt_epi32((__m256i)x, (__m256i)(y))
#else
#define TC_ABOVE(y) _mm_cmpgt_epi32((__m128i)x, (__m128i)(y))
#endif
  const TcWord ab = (TcWord)TC_ABOVE(a) + (TcWord)TC_ABOVE(b), cd = (TcWord)TC_ABOVE(c) + (TcWord)TC_ABOVE(d);
#undef TC_ABOVE
  return -(ab + cd);
}
TC_INLINE TcMask tc_high_bit(TcWord a) {
#if TC_SINGLE
  return (TcInt)a < 0;
#else
  return (TcInt)_mm256_cvtepi32_epi64((__m128i)a) < 0;
#endif
}

/* The four numbers at each lane's address become four vectors: loads and shuffles, as gather instructions take longer.
 */
TC_INLINE void tc_load_records(const TcReal *const at[TC_LANES], TcVec component[4]) {
#if TC_SINGLE
  __m256 r[4]; /* lanes j and j + 4: a 4 × 4 transpose in each half */
  for (int j = 0; j < 4; ++j)
    r[j] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at[j])), _mm_loadu_ps(at[j + 4]), 1);
  const __m256d a = (__m256d)_mm256_unpacklo_ps(r[0], r[1]), b = (__m256d)_mm256_unpackhi_ps(r[0], r[1]);
  const __m256d c = (__m256d)_mm256_unpacklo_ps(r[2], r[3]), d = (__m256d)_mm256_unpackhi_ps(r[2], r[3]);
  component[0] = (TcVec)_mm256_unpacklo_pd(a, c);
  component[1] = (TcVec)_mm256_unpackhi_pd(a, c);
  component[2] = (TcVec)_mm256_unpacklo_pd(b, d);
  component[3] = (TcVec)_mm256_unpackhi_pd(b, d);
#else
  /* Halves of two lanes in each register, then a 2 × 2 transpose in each half. */
  __m256d front[2], back[2];
  for (int j = 0; j < 2; ++j) {
    front[j] = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(at[j])), _mm_loadu_pd(at[j + 2]), 1);
    back[j] = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(at[j] + 2)), _mm_loadu_pd(at[j + 2] + 2), 1);
  }
  component[0] = (TcVec)_mm256_unpacklo_pd(front[0], front[1]);
  component[1] = (TcVec)_mm256_unpackhi_pd(front[0], front[1]);
  component[2] = (TcVec)_mm256_unpacklo_pd(back[0], back[1]);
  component[3] = (TcVec)_mm256_unpackhi_pd(back[0], back[1]);
#endif
}

#if !TC_SINGLE
/* The inverse: the lanes' four numbers go to each lane's address. */
TC_INLINE void tc_store_records(TcReal *const at[TC_LANES], const TcVec component[4]) {
  for (int j = 0; j < 2; ++j) { /* the even lanes, the odd ones */
    const __m256d a = j ? _mm256_unpackhi_pd(TC_R(component[0]), TC_R(component[1]))
                        : _mm256_unpacklo_pd(TC_R(component[0]), TC_R(component[1]));
    const __m256d b = j ? _mm256_unpackhi_pd(TC_R(component[2]), TC_R(component[3]))
                        : _mm256_unpacklo_pd(TC_R(component[2]), TC_R(component[3]));
    _mm256_storeu_pd(at[j], _mm256_permute2f128_pd(a, b, 0x20));
    _mm256_storeu_pd(at[j + 2], _mm256_permute2f128_pd(a, b, 0x31));
  }
}

TC_INLINE TcMask tc_eq_word(TcWord a, TcWord b) {
  return (TcMask)_mm256_cvtepi32_epi64(_mm_cmpeq_epi32((__m128i)a, (__m128i)b));
}

/* Two words next to each other in memory, in the place of a number. */
TC_INLINE TcVec tc_two_words(TcWord first, TcWord second) {
  const __m256i low = _mm256_cvtepu32_epi64((__m128i)first), high = _mm256_cvtepu32_epi64((__m128i)second);
  return (TcVec)_mm256_or_si256(low, _mm256_slli_epi64(high, 32));
}
#endif

#if !TC_SINGLE
/* The same of numbers in single precision. */
TC_INLINE void tc_load_float_records(const float *const at[TC_LANES], TcVec component[4]) {
  /* A 4 × 4 transpose. */
  const __m128 a = _mm_loadu_ps(at[0]), b = _mm_loadu_ps(at[1]), c = _mm_loadu_ps(at[2]), d = _mm_loadu_ps(at[3]);
  const __m128 front = _mm_unpacklo_ps(a, b), back = _mm_unpackhi_ps(a, b), next_front = _mm_unpacklo_ps(c, d),
               next_back = _mm_unpackhi_ps(c, d);
  component[0] = (TcVec)_mm256_cvtps_pd(_mm_movelh_ps(front, next_front));
  component[1] = (TcVec)_mm256_cvtps_pd(_mm_movehl_ps(next_front, front));
  component[2] = (TcVec)_mm256_cvtps_pd(_mm_movelh_ps(back, next_back));
  component[3] = (TcVec)_mm256_cvtps_pd(_mm_movehl_ps(next_back, back));
}
#endif

/* a d − b c by Kahan's difference of products (Jeannerod, Louvet, Muller, 2013): to a relative error of two units in
 * the last place, so with the exact sign, or zero, as long as nothing underflows. */
TC_INLINE TcVec tc_determinant(TcVec a, TcVec b, TcVec c, TcVec d) {
  const TcVec q = b * c;
  return tc_msub(a, d, q) - tc_msub(b, c, q);
}

#if !TC_SINGLE
/* The lanes of v moved up by one, and the last lane of `before` in the first. */
TC_INLINE TcVec tc_shift_in(TcVec before, TcVec v) {
  const __m256d middle = _mm256_permute2f128_pd(TC_R(before), TC_R(v), 0x21);
  return (TcVec)_mm256_shuffle_pd(middle, TC_R(v), 5);
}
#endif
