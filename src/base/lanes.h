/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of numbers, with a ray in each lane. Code that is written with them is compiled several times. The build
 * defines TC_LANES, the number of lanes: 1 (a vector is a plain number), 4 or 8 doubles, 8 or 16 floats. And it defines
 * TC_SINGLE: 0 for double precision, 1 for single precision.
 *
 * Arithmetic is written with operators. Whatever else needs an instruction of its own is below, and in one file for
 * each instruction set. */
#ifndef TC_BASE_LANES_H
#define TC_BASE_LANES_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if !defined(TC_LANES) || !defined(TC_SINGLE)
#error "TC_LANES and TC_SINGLE say what lanes there are"
#endif

#define TC_INLINE static inline __attribute__((always_inline))
/* Unused as well, as no file that is compiled for lanes uses all of these functions. */
#define TC_NOINLINE    static __attribute__((noinline, unused))
#define TC_LIKELY(x)   __builtin_expect(!!(x), 1)
#define TC_UNLIKELY(x) __builtin_expect(!!(x), 0)

/* Stands before a loop over lanes or packets that is to be unrolled, so that the instructions of its rounds mix. */
#if defined(__clang__)
#define TC_UNROLLED _Pragma("clang loop unroll(full)")
#else
#define TC_UNROLLED _Pragma("GCC unroll 16")
#endif

#if TC_SINGLE
typedef float TcReal;
typedef int32_t TcInteger; /* as wide as a TcReal */
#define TC_REAL_MIN FLT_MIN
#else
typedef double TcReal;
typedef int64_t TcInteger;
#define TC_REAL_MIN DBL_MIN
#endif

/* TcVec has real numbers in its lanes, TcInt integers of the same width, TcWord indices of 32 bits. TcMask is a set of
 * lanes. */
#if TC_LANES == 1
typedef TcReal TcVec;
typedef TcInteger TcInt;
typedef uint32_t TcWord;
#define TC_AT(vector, lane) (*((void)(lane), &(vector))) /* one lane of any of these */
#else
typedef TcReal TcVec __attribute__((vector_size(TC_LANES * sizeof(TcReal))));
typedef TcInteger TcInt __attribute__((vector_size(TC_LANES * sizeof(TcInteger))));
typedef uint32_t TcWord __attribute__((vector_size(TC_LANES * sizeof(uint32_t))));
#define TC_AT(vector, lane) ((vector)[lane])
#endif

/* TcWide has doubles in its lanes, whatever a TcVec has. Rays are set up with it. */
#if TC_LANES == 1
typedef double TcWide;
#else
typedef double TcWide __attribute__((vector_size(TC_LANES * sizeof(double))));
#endif

#define TC_EACH_LANE for (int l = 0; l < TC_LANES; ++l)

enum { TC_ALL_LANES = (1 << TC_LANES) - 1 };

/* Four numbers next to each other in memory: a vertex, a quarter of a row. */
typedef TcReal TcRecord __attribute__((vector_size(4 * sizeof(TcReal))));

TC_INLINE TcVec tc_set(TcReal x) {
  return x - (TcVec){0};
}
TC_INLINE TcInt tc_set_int(TcInteger x) {
  return x - (TcInt){0};
}
TC_INLINE TcWide tc_set_wide(double x) {
  return x - (TcWide){0};
}
TC_INLINE TcWord tc_set_word(uint32_t x) {
  return x - (TcWord){0};
}
TC_INLINE TcVec tc_load(const TcReal *from) {
  TcVec v;
  memcpy(&v, from, sizeof v);
  return v;
}
TC_INLINE TcWord tc_load_word(const uint32_t *from) {
  TcWord v;
  memcpy(&v, from, sizeof v);
  return v;
}
TC_INLINE void tc_store(TcReal *to, TcVec v) {
  memcpy(to, &v, sizeof v);
}
TC_INLINE void tc_store_word(uint32_t *to, TcWord v) {
  memcpy(to, &v, sizeof v);
}

/* Stands between storing an array as a vector and reading it lane by lane. Without it, the compiler would extract lanes
 * from the vector instead of reading them from memory, which takes longer. */
#define TC_IN_MEMORY(array) __asm__ volatile("" : "+m"(array))

#if TC_LANES == 1
#include "base/exact.h"
#include "base/lanes_one.h"
#elif defined(__AVX512F__)
#include "base/lanes_avx512.h"
#else
#include "base/lanes_avx2.h"
#endif

/* ── functions that are made of the former ── */

TC_INLINE TcMask tc_all(void) {
  return tc_mask_of(TC_ALL_LANES);
}
TC_INLINE TcMask tc_none(void) {
  return tc_mask_of(0);
}
TC_INLINE TcMask tc_gt(TcVec a, TcVec b) {
  return tc_lt(b, a);
}
TC_INLINE unsigned tc_wide_le(TcWide a, TcWide b) { /* bits of lanes */
  unsigned bits = 0;
#if TC_LANES == 1
  bits = a <= b;
#elif defined(__AVX512F__)
  for (int i = 0; i < TC_LANES / 8; ++i) {
    bits |= (unsigned)_mm512_cmp_pd_mask(_mm512_loadu_pd((const double *)&a + 8 * i),
                                         _mm512_loadu_pd((const double *)&b + 8 * i), _CMP_LE_OQ)
            << 8 * i;
  }
#else
  for (int i = 0; i < TC_LANES / 4; ++i) {
    const __m256d less = _mm256_cmp_pd(_mm256_loadu_pd((const double *)&a + 4 * i),
                                       _mm256_loadu_pd((const double *)&b + 4 * i), _CMP_LE_OQ);
    bits |= (unsigned)_mm256_movemask_pd(less) << 4 * i;
  }
#endif
  return bits;
}
TC_INLINE TcWide tc_sqrt_wide(TcWide a) {
#if TC_LANES == 1
  return sqrt(a);
#else
  TcWide root;
  for (int i = 0; i < TC_LANES / 4; ++i)
    _mm256_storeu_pd((double *)&root + 4 * i, _mm256_sqrt_pd(_mm256_loadu_pd((const double *)&a + 4 * i)));
  return root;
#endif
}
TC_INLINE TcVec tc_real_of_wide(TcWide a) {
#if TC_LANES == 1
  return (TcVec)a;
#else
  return __builtin_convertvector(a, TcVec);
#endif
}
TC_INLINE bool tc_any(TcMask m) {
  return tc_bits(m) != 0;
}
TC_INLINE TcVec tc_select3(TcMask m, TcVec a, TcMask n, TcVec b, TcVec c) {
  return tc_select(m, a, tc_select(n, b, c));
}

/* Σ c[i] xⁱ, i < n, by Horner; unrolled where n and c are constants. */
TC_INLINE TcVec tc_polynomial(TcVec x, const double *c, int n) {
  TcVec sum = tc_set((TcReal)c[n - 1]);
  for (int i = n - 2; i >= 0; --i)
    sum = tc_madd(sum, x, tc_set((TcReal)c[i]));
  return sum;
}

/* The whole number nearest to a, |a| < 2⁵¹ (single precision: 2²²); *whole is the same as a real. */
TC_INLINE TcInt tc_nearest(TcVec a, TcVec *whole) {
  const TcVec shift = tc_set((TcReal)(TC_SINGLE ? 0x1.8p23 : 0x1.8p52)), sum = a + shift;
  *whole = sum - shift;
  return tc_bits_of(sum) - tc_bits_of(shift);
}

/* 2ⁿ for n in [−1022, 1023] (single precision: [−126, 127]). */
TC_INLINE TcVec tc_power_of_two(TcInt n) {
  return tc_of_bits(TC_SINGLE ? (n + 127) << 23 : (n + 1023) << (TC_SINGLE ? 0 : 52));
}

/* e^x for x ≤ 0 to 1.5 ulp, gradually to 0 below −708 (single precision: −87): e^r 2ⁿ with |r| ≤ ln 2 / 2, by Taylor's
 * series up to r¹³, what is left out being below 2⁻⁵⁷, or up to r⁷, below 2⁻²⁷. */
TC_INLINE TcVec tc_exp(TcVec x) {
  static const double c[] = {
      1,         1,          1. / 2,      1. / 6,       1. / 24,       1. / 120,       1. / 720,
      1. / 5040, 1. / 40320, 1. / 362880, 1. / 3628800, 1. / 39916800, 1. / 479001600, 1. / 6227020800};
  x = tc_max(x, tc_set(TC_SINGLE ? -170 : -1400)); /* where both powers of two are in range, and their product is not */
  TcVec n, half_n;
  const TcInt whole = tc_nearest(x * (TcReal)0x1.71547652b82fep0, &n), half = tc_nearest((TcReal)0.5 * n, &half_n);
  /* ln 2 in two parts, the first of which has few enough bits for the product to be exact. */
  TcVec r = tc_madd(n, tc_set((TcReal)(TC_SINGLE ? -0x1.62ep-1 : -0x1.62e42feep-1)), x);
  r = tc_madd(n, tc_set((TcReal)(TC_SINGLE ? -0x1.0bfbe8p-15 : -0x1.a39ef35793c76p-33)), r);
  return tc_polynomial(r, c, TC_SINGLE ? 8 : 14) * tc_power_of_two(half) * tc_power_of_two(whole - half);
}

#endif
