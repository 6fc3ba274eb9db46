// SPDX-License-Identifier: Apache-2.0
// Gmsh lists the corners of an element first, then the nodes on its edges, on its faces, and inside. The nodes on a
// face or inside form an element of lower order, and are listed in the same way (see "Node ordering" in the reference
// manual of Gmsh, and the elements that Gmsh writes).
#include "gmsh_order.hpp"

#include <array>

#include <vtkHigherOrderHexahedron.h>
#include <vtkHigherOrderTetra.h>

namespace {

using Place = std::array<int, 3>; // A place in a lattice that has as many segments as the order is.
using Places = std::vector<Place>;

// Returns the place that is one of `n` equal steps away from `at`, towards each of the others.
Place inwards(const Place &at, std::initializer_list<Place> others, int n) {
  Place result = at;
  for (const Place &other : others) {
    for (size_t k = 0; k < 3; ++k)
      result[k] += (other[k] - at[k]) / n;
  }
  return result;
}

void list_edge(const Place &a, const Place &b, int n, Places *out) {
  for (int step = 1; step < n; ++step) {
    Place place = a;
    for (size_t k = 0; k < 3; ++k)
      place[k] += (b[k] - a[k]) / n * step;
    out->push_back(place);
  }
}

void list_triangle(const Place &a, const Place &b, const Place &c, int n, Places *out);
void list_in_triangle(const Place &a, const Place &b, const Place &c, int n, Places *out) {
  if (n >= 3)
    list_triangle(inwards(a, {b, c}, n), inwards(b, {a, c}, n), inwards(c, {a, b}, n), n - 3, out);
}
void list_triangle(const Place &a, const Place &b, const Place &c, int n, Places *out) {
  out->push_back(a);
  if (n == 0)
    return;
  out->insert(out->end(), {b, c});
  list_edge(a, b, n, out);
  list_edge(b, c, n, out);
  list_edge(c, a, n, out);
  list_in_triangle(a, b, c, n, out);
}

void list_quadrilateral(const Place &a, const Place &b, const Place &c, const Place &d, int n, Places *out);
void list_in_quadrilateral(const Place &a, const Place &b, const Place &c, const Place &d, int n, Places *out) {
  if (n >= 2)
    list_quadrilateral(inwards(a, {b, d}, n), inwards(b, {a, c}, n), inwards(c, {b, d}, n), inwards(d, {a, c}, n),
                       n - 2, out);
}
void list_quadrilateral(const Place &a, const Place &b, const Place &c, const Place &d, int n, Places *out) {
  out->push_back(a);
  if (n == 0)
    return;
  out->insert(out->end(), {b, c, d});
  list_edge(a, b, n, out);
  list_edge(b, c, n, out);
  list_edge(c, d, n, out);
  list_edge(d, a, n, out);
  list_in_quadrilateral(a, b, c, d, n, out);
}

void list_tetrahedron(const std::array<Place, 4> &v, int n, Places *out) {
  static const size_t edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}},
                      faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}};
  out->push_back(v[0]);
  if (n == 0)
    return;
  out->insert(out->end(), v.begin() + 1, v.end());
  for (const auto &edge : edges)
    list_edge(v[edge[0]], v[edge[1]], n, out);
  for (const auto &face : faces)
    list_in_triangle(v[face[0]], v[face[1]], v[face[2]], n, out);
  if (n < 4)
    return;
  list_tetrahedron({inwards(v[0], {v[1], v[2], v[3]}, n), inwards(v[1], {v[0], v[2], v[3]}, n),
                    inwards(v[2], {v[0], v[1], v[3]}, n), inwards(v[3], {v[0], v[1], v[2]}, n)},
                   n - 4, out);
}

void list_hexahedron(const std::array<Place, 8> &v, int n, Places *out) {
  static const size_t edges[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                      {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  static const size_t faces[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};
  static const size_t beside[8][3] = {{1, 3, 4}, {0, 2, 5}, {1, 3, 6}, {0, 2, 7},
                                      {0, 5, 7}, {1, 4, 6}, {2, 5, 7}, {3, 4, 6}};
  out->push_back(v[0]);
  if (n == 0)
    return;
  out->insert(out->end(), v.begin() + 1, v.end());
  for (const auto &edge : edges)
    list_edge(v[edge[0]], v[edge[1]], n, out);
  for (const auto &face : faces)
    list_in_quadrilateral(v[face[0]], v[face[1]], v[face[2]], v[face[3]], n, out);
  if (n < 2)
    return;
  std::array<Place, 8> inner;
  for (size_t k = 0; k < 8; ++k)
    inner[k] = inwards(v[k], {v[beside[k][0]], v[beside[k][1]], v[beside[k][2]]}, n);
  list_hexahedron(inner, n - 2, out);
}

} // namespace

namespace tcv {

std::vector<short> gmsh_tetrahedron(int n) {
  Places places;
  list_tetrahedron({{{0, 0, 0}, {n, 0, 0}, {0, n, 0}, {0, 0, n}}}, n, &places);
  std::vector<short> order(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const Place &p = places[i];
    const vtkIdType shares[4] = {p[0], p[1], p[2], n - p[0] - p[1] - p[2]};
    order[static_cast<size_t>(vtkHigherOrderTetra::Index(shares, n))] = static_cast<short>(i);
  }
  return order;
}

std::vector<short> gmsh_hexahedron(int n) {
  Places places;
  list_hexahedron({{{0, 0, 0}, {n, 0, 0}, {n, n, 0}, {0, n, 0}, {0, 0, n}, {n, 0, n}, {n, n, n}, {0, n, n}}}, n,
                  &places);
  std::vector<short> order(places.size());
  const int orders[3] = {n, n, n};
  for (size_t i = 0; i < places.size(); ++i) {
    const Place &p = places[i];
    order[static_cast<size_t>(vtkHigherOrderHexahedron::PointIndexFromIJK(p[0], p[1], p[2], orders))] =
        static_cast<short>(i);
  }
  return order;
}

} // namespace tcv
