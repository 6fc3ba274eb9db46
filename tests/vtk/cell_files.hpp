// SPDX-License-Identifier: Apache-2.0
// Files of one cell of one type, in each format that has such cells.
#ifndef TEST_VTK_CELL_FILES_HPP
#define TEST_VTK_CELL_FILES_HPP

#include <array>
#include <string>
#include <vector>

// A cell about the origin, of VTK's type and order of nodes, with the point array s = x + 2y + 4z; of OpenFOAM the cell
// array p = 7.
struct CellSample {
  int type;
  std::vector<std::array<double, 3>> points;
  std::vector<std::vector<int>> faces; // corners, counterclockwise from outside; of straight cells alone
  double volume;
};

// Empty points: there is no such cell.
CellSample cell_sample(int type);

// Writes to `folder` what the format whose first extension this is takes. The file to be read; "" if it has no such
// cells, or the build can't write it.
std::string write_cell(const CellSample &cell, const std::string &extension, const std::string &folder);

double value_at(const std::array<double, 3> &p);

#endif
