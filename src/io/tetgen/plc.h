// SPDX-License-Identifier: Apache-2.0
// A piecewise linear complex, which TetGen fills with tetrahedra, and where it comes from.
#ifndef TETCAST_IO_TETGEN_PLC_H
#define TETCAST_IO_TETGEN_PLC_H

#include <tetcast/tetgen.h>

#include <cstddef>
#include <string>
#include <vector>

namespace tetcast_tetgen {

// Thrown inside the library, turned into a status and a message at its boundary.
struct Failure {
  TetcastStatus status;
  std::string text;
};

[[noreturn]] void fail(TetcastStatus status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

// TetGen counts in int and keeps four indices per cell in one array.
constexpr int64_t MAX_COUNT = (int64_t{1} << 29) - 1;

struct Facet {
  std::size_t polygons_end; // its polygons are those since the facet before
  std::size_t holes_end;    // likewise, in facet_holes, counted in points
};

struct Plc {
  std::vector<double> points;            // [n][3]
  std::vector<int> corners;              // of all polygons, from 0
  std::vector<std::size_t> polygon_ends; // in corners
  std::vector<Facet> facets;
  std::vector<double> facet_holes; // [][3] points in the holes of facets
  std::vector<double> holes;       // [][3] points in cavities

  void add_triangle(const int triangle[3]);
};

struct Cells {
  std::vector<double> points;
  std::vector<int> tetrahedra; // [m][4], from 0
};

// Checks and copies a surface: only vertices that triangles use, no triangles with a vertex twice.
Plc plc_from_surface(const TetcastSurface &surface);

// .poly and .smesh
Plc plc_read(const std::string &path);

// .node and .ele beside each other
Cells cells_read(const std::string &stem);

} // namespace tetcast_tetgen

#endif
