/* SPDX-License-Identifier: Apache-2.0 */
/* One lane: plain numbers, for any processor. Included by lanes.h. */
typedef unsigned TcMask; /* 0 or 1 */

TC_INLINE TcMask tc_mask_of(unsigned bits) {
  return bits & 1;
}
TC_INLINE unsigned tc_bits(TcMask m) {
  return m;
}
TC_INLINE TcMask tc_lt(TcVec a, TcVec b) {
  return a < b;
}
TC_INLINE TcMask tc_le(TcVec a, TcVec b) {
  return a <= b;
}
TC_INLINE TcMask tc_eq(TcVec a, TcVec b) {
  return a == b;
}
TC_INLINE TcMask tc_eq_int(TcInt a, TcInt b) {
  return a == b;
}
TC_INLINE TcMask tc_negative(TcVec a) {
  return signbit(a) != 0;
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
  return m ? a : b;
}
TC_INLINE TcInt tc_select_int(TcMask m, TcInt a, TcInt b) {
  return m ? a : b;
}
TC_INLINE TcWord tc_select_word(TcMask m, TcWord a, TcWord b) {
  return m ? a : b;
}

/* a b + c, rounded twice. */
TC_INLINE TcVec tc_madd(TcVec a, TcVec b, TcVec c) {
  return a * b + c;
}
TC_INLINE TcVec tc_abs(TcVec a) {
  return fabs(a);
}
TC_INLINE TcVec tc_min(TcVec a, TcVec b) {
  return a < b ? a : b;
} /* b if one is NaN */
TC_INLINE TcVec tc_max(TcVec a, TcVec b) {
  return a > b ? a : b;
}
TC_INLINE TcVec tc_sqrt(TcVec a) {
  return sqrt(a);
}

TC_INLINE TcInt tc_bits_of(TcVec a) {
  TcInt n;
  memcpy(&n, &a, sizeof n);
  return n;
}
TC_INLINE TcVec tc_of_bits(TcInt n) {
  TcVec a;
  memcpy(&a, &n, sizeof a);
  return a;
}
TC_INLINE TcVec tc_to_real(TcInt a) {
  return (TcVec)a;
}

/* How many of a, b, c, d are less than x. */
TC_INLINE TcWord tc_rank(TcWord x, TcWord a, TcWord b, TcWord c, TcWord d) {
  return (TcWord)((x > a) + (x > b) + (x > c) + (x > d));
}
TC_INLINE TcMask tc_high_bit(TcWord a) {
  return a >> 31;
}

/* The four numbers at each lane's address become four vectors. */
TC_INLINE void tc_load_records(const TcReal *const at[TC_LANES], TcVec component[4]) {
  for (int k = 0; k < 4; ++k)
    component[k] = at[0][k];
}

/* The same of numbers in single precision. */
TC_INLINE void tc_load_float_records(const float *const at[TC_LANES], TcVec component[4]) {
  for (int k = 0; k < 4; ++k)
    component[k] = (double)at[0][k];
}

/* a d − b c to a relative error of 2⁻⁵¹ (of ½ where it is less than 2⁻¹⁰⁴ of its products), with the exact sign, or
 * zero: the errors of the two products are added to their difference e. If the products are within a factor of two, e
 * is exact (Sterbenz), as is the sum of the errors but for its last bit; else e is at least half of the larger product,
 * and the errors are below its last bits and left out. */
TC_INLINE TcVec tc_determinant(TcVec a, TcVec b, TcVec c, TcVec d) {
  const TcVec p = a * d, q = b * c, e = p - q;
  return fabs(e) > 0.5 * fabs(p) ? e : e + (tc_product_error(a, d, p) - tc_product_error(b, c, q));
}

/* The lanes of v moved up by one, and the last lane of `before` in the first. */
TC_INLINE TcVec tc_shift_in(TcVec before, TcVec v) {
  (void)v;
  return before;
}

/* The inverse: the lanes' four numbers go to each lane's address. */
TC_INLINE void tc_store_records(TcReal *const at[TC_LANES], const TcVec component[4]) {
  for (int k = 0; k < 4; ++k)
    at[0][k] = component[k];
}

TC_INLINE TcMask tc_eq_word(TcWord a, TcWord b) {
  return a == b;
}

/* Two words next to each other in memory, in the place of a number. */
TC_INLINE TcVec tc_two_words(TcWord first, TcWord second) {
  return tc_of_bits((TcInt)((uint64_t)first | (uint64_t)second << 32));
}
