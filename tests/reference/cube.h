/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_REFERENCE_CUBE_H
#define TETCAST_REFERENCE_CUBE_H

#include <array>
#include <functional>
#include <random>

#include "scene.h"

namespace reference {

/* The unit cube in n³ cubes of six tetrahedra, with `field` at the vertices; vertices inside are moved by up to
 * `jitter` of an edge. */
inline Mesh cube(int n, double jitter, const std::function<double(const std::array<double, 3> &)> &field) {
  std::mt19937 random(7);
  const auto move = [&] { return ((random() & 0xffff) / 32768.0 - 1) * jitter / n; }; /* the same with any library */
  Mesh mesh;
  const int m = n + 1;
  for (int i = 0; i < m * m * m; i++) {
    const int index[3] = {i % m, i / m % m, i / m / m};
    std::array<double, 3> p;
    for (size_t k = 0; k < 3; k++)
      p[k] = double(index[k]) / n + (index[k] > 0 && index[k] < n ? move() : 0);
    mesh.points.push_back(p);
    mesh.values.push_back(field(p));
  }
  static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int step[3] = {1, m, m * m};
  for (int i = 0; i < n * n * n; i++)
    for (const auto &order : orders) {
      std::array<int64_t, 4> cell{i % n + m * (i / n % n) + m * m * (i / n / n)};
      for (size_t k = 0; k < 3; k++)
        cell[k + 1] = cell[k] + step[order[k]];
      mesh.cells.push_back(cell);
    }
  return mesh;
}

} // namespace reference

#endif
