/* SPDX-License-Identifier: Apache-2.0 */
/* Rounding errors of sums and products, exactly, as numbers. */
#ifndef TC_BASE_EXACT_H
#define TC_BASE_EXACT_H

#include <math.h>

/* a + b − s, where s is a + b rounded (Knuth). */
static inline double tc_sum_error(double a, double b, double s) {
  const double t = s - a;
  return (a - (s - t)) + (b - t);
}

/* a b − p, where p is a b rounded, whose error may not underflow. */
static inline double tc_product_error(double a, double b, double p) {
#ifdef FP_FAST_FMA
  return fma(a, b, -p);
#else /* Dekker, Veltkamp: halves of 26 bits, whose products are exact. |a|, |b| < 2^995 */
  const double c = 0x1.0000002p27 * a, d = 0x1.0000002p27 * b;
  const double a_high = c - (c - a), a_low = a - a_high, b_high = d - (d - b), b_low = b - b_high;
  return ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low;
#endif
}

#endif
