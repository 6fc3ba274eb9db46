// SPDX-License-Identifier: Apache-2.0
// From the cells of a grid to tetrahedra.
#ifndef TETCAST_VTK_CELLS_HPP
#define TETCAST_VTK_CELLS_HPP

#include <cstdint>
#include <utility>
#include <vector>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <tetcast/array.h>

class vtkUnstructuredGrid;

namespace tcv {

struct Tetrahedra {
  TetcastArray view = {};                     // [m, 4] into one of the next two
  vtkSmartPointer<vtkDataArray> connectivity; // the file's own, when all its cells are tetrahedra
  std::vector<int32_t> cut;
  std::vector<int32_t> source; // the cell of the file that each tetrahedron is of; empty: its own
  std::vector<std::pair<const char *, int64_t>> types; // of the file's cells, largest count first
  int64_t uncut = 0;                                   // volumetric cells that gave no tetrahedron
  int64_t oversized = 0; // volumetric cells with more points than their type has: the rest is ignored
};

// `grid` has valid offsets and indices (check_cells). Fails if it holds no volumetric cell or one that can't be cut.
void make_tetrahedra(const char *path, vtkUnstructuredGrid *grid, Tetrahedra *result);

} // namespace tcv

#endif
