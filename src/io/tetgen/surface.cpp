// SPDX-License-Identifier: Apache-2.0
#include "plc.h"

#include <algorithm>
#include <cmath>

namespace tetcast_tetgen {

void Plc::add_triangle(const int triangle[3]) {
  corners.insert(corners.end(), triangle, triangle + 3);
  polygon_ends.push_back(corners.size());
  facets.push_back({polygon_ends.size(), facet_holes.size() / 3});
}

namespace {

void check_counts(const TetcastSurface &surface) {
  if (surface.vertex_count < 0 || surface.triangle_count < 0 || surface.hole_count < 0 ||
      (surface.vertex_count > 0 && !surface.vertices) || (surface.triangle_count > 0 && !surface.triangles) ||
      (surface.hole_count > 0 && !surface.holes)) {
    fail(TETCAST_ERROR_ARGUMENT, "the surface has a negative count or lacks an array");
  }
  if (surface.vertex_count > MAX_COUNT || surface.triangle_count > MAX_COUNT || surface.hole_count > MAX_COUNT) {
    fail(TETCAST_ERROR_LIMIT, "the surface has more than %lld vertices or triangles", (long long)MAX_COUNT);
  }
  if (surface.triangle_count == 0) {
    fail(TETCAST_ERROR_DATA, "the surface has no triangles");
  }
}

void check_finite(const double *points, int64_t count, const char *what) {
  for (int64_t i = 0; i < 3 * count; i++) {
    if (!std::isfinite(points[i])) {
      fail(TETCAST_ERROR_DATA, "%s %lld of the surface has a coordinate that is not finite", what, (long long)(i / 3));
    }
  }
}

// Refuses an open surface. It encloses nothing, and TetGen would return nothing without a message. Edges of three
// triangles or more, as where bodies touch or membranes end, are left to TetGen.
void check_closed(const Plc &plc) {
  std::vector<uint64_t> edges;
  edges.reserve(plc.corners.size());
  for (std::size_t i = 0; i < plc.corners.size(); i += 3) {
    for (std::size_t j = 0; j < 3; j++) {
      auto [a, b] = std::minmax(plc.corners[i + j], plc.corners[i + (j + 1) % 3]);
      edges.push_back((uint64_t)(uint32_t)a << 32 | (uint32_t)b);
    }
  }
  std::sort(edges.begin(), edges.end());
  int64_t open = 0;
  uint64_t first = 0;
  for (std::size_t i = 0, next; i < edges.size(); i = next) {
    for (next = i + 1; next < edges.size() && edges[next] == edges[i]; next++) {}
    if (next - i == 1 && open++ == 0) {
      first = edges[i];
    }
  }
  if (open > 0) {
    const double *p = &plc.points[3 * (first >> 32)];
    fail(TETCAST_ERROR_DATA, "the surface is open: %lld edge%s only one triangle, the first at (%g, %g, %g)",
         (long long)open, open == 1 ? " has" : "s have", p[0], p[1], p[2]);
  }
}

} // namespace

Plc plc_from_surface(const TetcastSurface &surface) {
  check_counts(surface);
  check_finite(surface.vertices, surface.vertex_count, "vertex");
  check_finite(surface.holes, surface.hole_count, "the point in hole");
  Plc plc;
  std::vector<int> renumbered((std::size_t)surface.vertex_count, -1);
  for (int64_t i = 0; i < surface.triangle_count; i++) {
    const int64_t *triangle = surface.triangles + 3 * i;
    for (int j = 0; j < 3; j++) {
      if (triangle[j] < 0 || triangle[j] >= surface.vertex_count) {
        fail(TETCAST_ERROR_DATA, "triangle %lld of the surface refers to vertex %lld of %lld", (long long)i,
             (long long)triangle[j], (long long)surface.vertex_count);
      }
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      continue; // The triangle is only a line, and the triangles on its two sides meet without it.
    }
    int corners[3];
    for (int j = 0; j < 3; j++) {
      int &number = renumbered[(std::size_t)triangle[j]];
      if (number < 0) {
        number = (int)(plc.points.size() / 3);
        plc.points.insert(plc.points.end(), surface.vertices + 3 * triangle[j], surface.vertices + 3 * triangle[j] + 3);
      }
      corners[j] = number;
    }
    plc.add_triangle(corners);
  }
  if (plc.facets.empty()) {
    fail(TETCAST_ERROR_DATA, "the surface has no triangle with an area");
  }
  plc.holes.assign(surface.holes, surface.holes + 3 * surface.hole_count);
  check_closed(plc);
  return plc;
}

} // namespace tetcast_tetgen
