/* SPDX-License-Identifier: Apache-2.0 */
/* Emission and absorption along one ray by quadrature:
 *     C = ∫ c κ exp(−∫κ) dt,   α = 1 − exp(−∫κ dt)
 * Segments are cut where the transfer function bends; within a piece κ and c are linear in t, so that the optical depth
 * is a quadratic, known exactly, and the outer integral is left to Gauss and Legendre. */
#ifndef TETCAST_REFERENCE_OPTICS_H
#define TETCAST_REFERENCE_OPTICS_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "real.h"
#include "scene.h"

namespace reference {

/* Part of a ray inside one cell: arc length and the scalar at both ends, linear in between. */
template <class Real> struct Segment {
  Real t0, t1;
  Real s0, s1;
};

/* A piecewise linear function with N components, constant beyond its first and last knot. */
template <class Real, int N> struct Curve {
  std::vector<Real> knots;
  std::vector<std::array<Real, N>> values;

  /* The value at s of the straight line that holds around `near`; where a knot lies, of the one that begins there. */
  std::array<Real, N> line(Real near, Real s) const {
    const size_t above = size_t(std::upper_bound(knots.begin(), knots.end(), near) - knots.begin());
    if (above == 0)
      return values.front();
    if (above == knots.size())
      return values.back();
    const Real part = (s - knots[above - 1]) / (knots[above] - knots[above - 1]);
    std::array<Real, N> result;
    for (size_t i = 0; i < N; i++)
      result[i] = (1 - part) * values[above - 1][i] + part * values[above][i];
    return result;
  }
};

template <class Real> struct Optics {
  Curve<Real, 3> color;
  Curve<Real, 1> extinction;

  explicit Optics(const Transfer &transfer) {
    for (const auto &knot : transfer.color) {
      color.knots.push_back(knot[0]);
      color.values.push_back({Real(knot[1]), Real(knot[2]), Real(knot[3])});
    }
    for (const auto &knot : transfer.extinction) {
      extinction.knots.push_back(knot[0]);
      extinction.values.push_back({Real(knot[1])});
    }
    for (const auto &knot : transfer.opacity) {
      const Real unit = transfer.unit_distance;
      const double opacity = transfer.linear_opacity ? knot[1] : std::min(knot[1], 1 - 0x1p-53);
      extinction.knots.push_back(knot[0]);
      extinction.values.push_back(
          {transfer.linear_opacity ? opacity / unit : -logarithm_one_plus(-Real(opacity)) / unit});
    }
  }
};

/* Nodes and weights on [0, 1]: roots of the Legendre polynomial by Newton's method. */
template <class Real> struct Quadrature {
  static constexpr int count = 20;
  std::array<Real, count> node, weight;

  Quadrature() {
    for (int i = 0; i < count; i++) {
      Real x = cosine(pi<Real>() * (i + Real(0.75)) / (count + Real(0.5)));
      Real slope = 0;
      for (int step = 0; step < 10; step++) {
        Real before = 1, here = x;
        for (int k = 2; k <= count; k++) {
          const Real next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
          before = here;
          here = next;
        }
        slope = count * (before - x * here) / (1 - x * x);
        x -= here / slope;
      }
      node[size_t(i)] = (1 - x) / 2;
      weight[size_t(i)] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

template <class Real> class Integral {
public:
  explicit Integral(const Optics<Real> &optics) : optics_(optics) {}

  bool opaque() const { return depth_ > 70; } /* exp(−70) < 1e-30 */

  /* Segments must come in the order of t. */
  void add(const Segment<Real> &segment) {
    const Real low = std::min(segment.s0, segment.s1), high = std::max(segment.s0, segment.s1);
    const Real length = segment.t1 - segment.t0;
    if (low == high) {
      add_piece(length, low, low);
      return;
    }
    cuts_.assign({low, high});
    for (const auto *knots : {&optics_.color.knots, &optics_.extinction.knots})
      for (Real knot : *knots)
        if (low < knot && knot < high)
          cuts_.push_back(knot);
    std::sort(cuts_.begin(), cuts_.end());
    if (segment.s0 > segment.s1)
      std::reverse(cuts_.begin(), cuts_.end());
    for (size_t i = 1; i < cuts_.size(); i++)
      if (cuts_[i] != cuts_[i - 1])
        add_piece(length * absolute(cuts_[i] - cuts_[i - 1]) / (high - low), cuts_[i - 1], cuts_[i]);
  }

  /* Red, green, blue (premultiplied), alpha. */
  std::array<Real, 4> rgba() const { return {color_[0], color_[1], color_[2], -exponential_minus_one(-depth_)}; }

private:
  /* No knot strictly between s0 and s1. */
  void add_piece(Real length, Real s0, Real s1) {
    const Real middle = s0 + (s1 - s0) / 2;
    const Real k0 = optics_.extinction.line(middle, s0)[0], k1 = optics_.extinction.line(middle, s1)[0];
    const auto c0 = optics_.color.line(middle, s0), c1 = optics_.color.line(middle, s1);
    const Real a = k0 * length, b = (k1 - k0) * length;
    if (a == 0 && b == 0)
      return;
    Real u = 0;
    while (u < 1 && !opaque()) {
      /* the part over which the optical depth grows by one: here·δ + b·δ²/2 = 1 */
      const Real here = a + b * u;
      const Real discriminant = here * here + 2 * b;
      Real part = 1 - u;
      if (discriminant > 0 && here + square_root(discriminant) > 0)
        part = std::min(part, 2 / (here + square_root(discriminant)));
      add_part(u, part, a, b, c0, c1);
      u = part == 1 - u ? Real(1) : u + part;
    }
  }

  void add_part(Real u, Real part, Real a, Real b, const std::array<Real, 3> &c0, const std::array<Real, 3> &c1) {
    static const Quadrature<Real> rule;
    const Real before = exponential(-depth_);
    const Real here = a + b * u;
    for (size_t j = 0; j < rule.count; j++) {
      const Real d = part * rule.node[j];
      const Real emitted = before * rule.weight[j] * part * (here + b * d) * exponential(-d * (here + b * d / 2));
      for (size_t i = 0; i < 3; i++)
        color_[i] += emitted * ((1 - (u + d)) * c0[i] + (u + d) * c1[i]);
    }
    depth_ += part * (here + b * part / 2);
  }

  const Optics<Real> &optics_;
  std::vector<Real> cuts_;
  std::array<Real, 3> color_{};
  Real depth_ = 0;
};

} // namespace reference

#endif
