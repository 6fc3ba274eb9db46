/* SPDX-License-Identifier: Apache-2.0 */
/* The reference computes in a type wider than the renderer's double: long double, or __float128 as a check on that. */
#ifndef TETCAST_REFERENCE_REAL_H
#define TETCAST_REFERENCE_REAL_H

#include <cmath>

#ifdef TETCAST_REFERENCE_QUAD
#include <quadmath.h>
#endif

namespace reference {

using Extended = long double;

inline Extended square_root(Extended x) {
  return std::sqrt(x);
}
inline Extended exponential(Extended x) {
  return std::exp(x);
}
inline Extended exponential_minus_one(Extended x) {
  return std::expm1(x);
}
inline Extended logarithm_one_plus(Extended x) {
  return std::log1p(x);
}
inline Extended tangent(Extended x) {
  return std::tan(x);
}
inline Extended cosine(Extended x) {
  return std::cos(x);
}

#ifdef TETCAST_REFERENCE_QUAD
__extension__ typedef __float128 Quad;

inline Quad square_root(Quad x) {
  return sqrtq(x);
}
inline Quad exponential(Quad x) {
  return expq(x);
}
inline Quad exponential_minus_one(Quad x) {
  return expm1q(x);
}
inline Quad logarithm_one_plus(Quad x) {
  return log1pq(x);
}
inline Quad tangent(Quad x) {
  return tanq(x);
}
inline Quad cosine(Quad x) {
  return cosq(x);
}
#endif

template <class Real> Real absolute(Real x) {
  return x < 0 ? -x : x;
}

/* π to more digits than either type has. */
template <class Real> Real pi() {
  return Real(0x1.921fb54442d18p+1) + (Real(0x1.1a62633145c07p-53) - Real(0x1.f1976b7ed8fbcp-109));
}

template <class Real> struct Vector { Real x, y, z; };

template <class Real> Vector<Real> vector_from(const double p[3]) {
  return {Real(p[0]), Real(p[1]), Real(p[2])};
}

template <class Real> Vector<Real> operator+(Vector<Real> a, Vector<Real> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real> Vector<Real> operator-(Vector<Real> a, Vector<Real> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real> Vector<Real> operator*(Real s, Vector<Real> a) {
  return {s * a.x, s * a.y, s * a.z};
}

template <class Real> Real dot(Vector<Real> a, Vector<Real> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Real> Vector<Real> cross(Vector<Real> a, Vector<Real> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Real> Vector<Real> normalized(Vector<Real> a) {
  return (1 / square_root(dot(a, a))) * a;
}

} // namespace reference

#endif
