/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of single precision, twice as many lanes as simd.h's: those of two vectors of doubles, one after the other. */
#ifndef TC_BASE_SIMD_SINGLE_H
#define TC_BASE_SIMD_SINGLE_H

#include "base/simd.h"

#if defined(TC_SIMD_AVX512) || defined(TC_SIMD_AVX2)
#define TC_HAVE_SINGLE 1

enum { TC_SINGLES = 2 * TC_LANES };

typedef float TcFloats __attribute__((vector_size(4 * TC_SINGLES)));
typedef uint32_t TcWords __attribute__((vector_size(4 * TC_SINGLES)));

TC_INLINE TcFloats tcf_set(float x) { return x - (TcFloats){0}; }

#if defined(TC_SIMD_AVX512)

typedef __mmask16 TcFloatMask;
TC_INLINE TcFloatMask tcf_mask_of(unsigned bits) { return (TcFloatMask)bits; }
TC_INLINE unsigned tcf_bits(TcFloatMask m) { return m; }
TC_INLINE TcFloatMask tcf_lt(TcFloats a, TcFloats b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ); }
TC_INLINE TcFloatMask tcf_le(TcFloats a, TcFloats b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ); }
TC_INLINE TcFloatMask tcf_and(TcFloatMask a, TcFloatMask b) { return a & b; }
TC_INLINE TcFloatMask tcf_or(TcFloatMask a, TcFloatMask b) { return a | b; }
TC_INLINE TcFloatMask tcf_and_not(TcFloatMask a, TcFloatMask b) { return (TcFloatMask)(a & ~b); }
TC_INLINE TcFloats tcf_select(TcFloatMask m, TcFloats a, TcFloats b) {
  TcFloats result = (TcFloats)_mm512_mask_blend_ps(m, (__m512)b, (__m512)a);
  __asm__("" : "+v"(result)); /* as tc_select() */
  return result;
}
TC_INLINE TcWords tcf_select_words(TcFloatMask m, TcWords a, TcWords b) {
  return (TcWords)_mm512_mask_blend_epi32(m, (__m512i)b, (__m512i)a);
}
TC_INLINE TcFloats tcf_madd(TcFloats a, TcFloats b, TcFloats c) { return (TcFloats)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c); }
TC_INLINE TcFloats tcf_msub(TcFloats a, TcFloats b, TcFloats c) { return (TcFloats)_mm512_fmsub_ps((__m512)a, (__m512)b, (__m512)c); }
TC_INLINE TcFloats tcf_min(TcFloats a, TcFloats b) { return (TcFloats)_mm512_min_ps((__m512)a, (__m512)b); }
TC_INLINE TcFloats tcf_max(TcFloats a, TcFloats b) { return (TcFloats)_mm512_max_ps((__m512)a, (__m512)b); }
/* The lanes whose number is zero or denormal. */
TC_INLINE TcFloatMask tcf_vanishes(TcFloats a) { return _mm512_fpclass_ps_mask((__m512)a, 0x26); }
/* −1 where a > b, both less than 2³¹, else 0. */
TC_INLINE TcWords tcf_above(TcWords a, TcWords b) { return (TcWords)_mm512_movm_epi32(_mm512_cmpgt_epi32_mask((__m512i)a, (__m512i)b)); }
TC_INLINE TcFloatMask tcf_high_bit(TcWords a) { return _mm512_movepi32_mask((__m512i)a); }

TC_INLINE TcFloats tcf_join(const TcVec half[2]) {
  return (TcFloats)_mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps((__m512d)half[0])), _mm512_cvtpd_ps((__m512d)half[1]), 1);
}
TC_INLINE TcWords tcf_join_words(TcWord low, TcWord high) {
  return (TcWords)_mm512_inserti32x8(_mm512_castsi256_si512((__m256i)low), (__m256i)high, 1);
}
TC_INLINE TcVec tcf_half(TcFloats a, int i) {
  return (TcVec)_mm512_cvtps_pd(i ? _mm512_extractf32x8_ps((__m512)a, 1) : _mm512_castps512_ps256((__m512)a));
}
TC_INLINE TcWord tcf_half_words(TcWords a, int i) {
  return (TcWord)(i ? _mm512_extracti32x8_epi32((__m512i)a, 1) : _mm512_castsi512_si256((__m512i)a));
}

#else

typedef __m256 TcFloatMask;
TC_INLINE TcFloatMask tcf_mask_of(unsigned bits) {
  const TcWords bit = {1, 2, 4, 8, 16, 32, 64, 128};
  return (TcFloatMask)((bits & bit) == bit);
}
TC_INLINE unsigned tcf_bits(TcFloatMask m) { return (unsigned)_mm256_movemask_ps(m); }
TC_INLINE TcFloatMask tcf_lt(TcFloats a, TcFloats b) { return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ); }
TC_INLINE TcFloatMask tcf_le(TcFloats a, TcFloats b) { return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LE_OQ); }
TC_INLINE TcFloatMask tcf_and(TcFloatMask a, TcFloatMask b) { return _mm256_and_ps(a, b); }
TC_INLINE TcFloatMask tcf_or(TcFloatMask a, TcFloatMask b) { return _mm256_or_ps(a, b); }
TC_INLINE TcFloatMask tcf_and_not(TcFloatMask a, TcFloatMask b) { return _mm256_andnot_ps(b, a); }
TC_INLINE TcFloats tcf_select(TcFloatMask m, TcFloats a, TcFloats b) { return (TcFloats)_mm256_blendv_ps((__m256)b, (__m256)a, m); }
TC_INLINE TcWords tcf_select_words(TcFloatMask m, TcWords a, TcWords b) { return (TcWords)_mm256_blendv_ps((__m256)b, (__m256)a, m); }
TC_INLINE TcFloats tcf_madd(TcFloats a, TcFloats b, TcFloats c) { return (TcFloats)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c); }
TC_INLINE TcFloats tcf_msub(TcFloats a, TcFloats b, TcFloats c) { return (TcFloats)_mm256_fmsub_ps((__m256)a, (__m256)b, (__m256)c); }
TC_INLINE TcFloats tcf_min(TcFloats a, TcFloats b) { return (TcFloats)_mm256_min_ps((__m256)a, (__m256)b); }
TC_INLINE TcFloats tcf_max(TcFloats a, TcFloats b) { return (TcFloats)_mm256_max_ps((__m256)a, (__m256)b); }
TC_INLINE TcFloatMask tcf_vanishes(TcFloats a) {
  return _mm256_cmp_ps((__m256)((TcWords)a & INT32_MAX), (__m256)tcf_set(0x1p-126F), _CMP_LT_OQ);
}
TC_INLINE TcWords tcf_above(TcWords a, TcWords b) { return (TcWords)_mm256_cmpgt_epi32((__m256i)a, (__m256i)b); }
TC_INLINE TcFloatMask tcf_high_bit(TcWords a) { return (TcFloatMask)a; } /* the sign is all that counts */

TC_INLINE TcFloats tcf_join(const TcVec half[2]) {
  return (TcFloats)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps((__m256d)half[0])), _mm256_cvtpd_ps((__m256d)half[1]), 1);
}
TC_INLINE TcWords tcf_join_words(TcWord low, TcWord high) {
  return (TcWords)_mm256_inserti128_si256(_mm256_castsi128_si256((__m128i)low), (__m128i)high, 1);
}
TC_INLINE TcVec tcf_half(TcFloats a, int i) {
  return (TcVec)_mm256_cvtps_pd(i ? _mm256_extractf128_ps((__m256)a, 1) : _mm256_castps256_ps128((__m256)a));
}
TC_INLINE TcWord tcf_half_words(TcWords a, int i) {
  return (TcWord)(i ? _mm256_extracti128_si256((__m256i)a, 1) : _mm256_castsi256_si128((__m256i)a));
}

#endif

/* Four floats from each of base[offset[i]], base[offset[i] + 4], …, as tc_load_records(). */
TC_INLINE void tcf_load_records(const float *base, TcWords offset, const int count, TcFloats component[]) {
  uint32_t at[TC_SINGLES];
  memcpy(at, &offset, sizeof at);
  for (int k = 0; k < count; ++k) {
    TcNarrow r[TC_SINGLES];
    for (int i = 0; i < TC_SINGLES; ++i) memcpy(&r[i], base + (size_t)at[i] + 4 * k, sizeof r[i]);
    TcFloats *c = component + 4 * k;
#if defined(TC_SIMD_AVX512)
    __m512 four[4]; /* lanes 4 i … 4 i + 3 */
    for (int i = 0; i < 4; ++i) {
      four[i] = _mm512_insertf32x4(_mm512_castps128_ps512((__m128)r[4 * i]), (__m128)r[4 * i + 1], 1);
      four[i] = _mm512_insertf32x4(four[i], (__m128)r[4 * i + 2], 2);
      four[i] = _mm512_insertf32x4(four[i], (__m128)r[4 * i + 3], 3);
    }
    const __m512i first = _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29);
    const __m512i last = _mm512_setr_epi32(2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31);
    const __m512 low01 = _mm512_permutex2var_ps(four[0], first, four[1]), high01 = _mm512_permutex2var_ps(four[2], first, four[3]);
    const __m512 low23 = _mm512_permutex2var_ps(four[0], last, four[1]), high23 = _mm512_permutex2var_ps(four[2], last, four[3]);
    c[0] = (TcFloats)_mm512_shuffle_f32x4(low01, high01, 0x44);
    c[1] = (TcFloats)_mm512_shuffle_f32x4(low01, high01, 0xEE);
    c[2] = (TcFloats)_mm512_shuffle_f32x4(low23, high23, 0x44);
    c[3] = (TcFloats)_mm512_shuffle_f32x4(low23, high23, 0xEE);
#else
    __m256 pair[4]; /* lanes i and i + 4: a 4 × 4 transpose in each half */
    for (int i = 0; i < 4; ++i) pair[i] = _mm256_insertf128_ps(_mm256_castps128_ps256((__m128)r[i]), (__m128)r[i + 4], 1);
    const __m256 a = _mm256_unpacklo_ps(pair[0], pair[1]), b = _mm256_unpackhi_ps(pair[0], pair[1]);
    const __m256 d = _mm256_unpacklo_ps(pair[2], pair[3]), e = _mm256_unpackhi_ps(pair[2], pair[3]);
    c[0] = (TcFloats)_mm256_shuffle_ps(a, d, 0x44);
    c[1] = (TcFloats)_mm256_shuffle_ps(a, d, 0xEE);
    c[2] = (TcFloats)_mm256_shuffle_ps(b, e, 0x44);
    c[3] = (TcFloats)_mm256_shuffle_ps(b, e, 0xEE);
#endif
  }
}

TC_INLINE TcFloats tcf_abs(TcFloats a) { return (TcFloats)((TcWords)a & INT32_MAX); }
TC_INLINE int tcf_any(TcFloatMask m) { return tcf_bits(m) != 0; }

#endif
#endif
