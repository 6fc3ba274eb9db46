// SPDX-License-Identifier: Apache-2.0
// Turns the cells of a grid into tetrahedra.
#ifndef TETCAST_VTK_CELLS_HPP
#define TETCAST_VTK_CELLS_HPP

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <tetcast/cells.h>
#include <tetcast/tetcast.hpp>

class vtkUnstructuredGrid;

namespace tcv {

struct Tetrahedra {
  TetcastArray view = {};                     // [m, 4]: a view of one of the next two
  vtkSmartPointer<vtkDataArray> connectivity; // the file's own array, if all its cells are tetrahedra
  std::optional<tetcast::Context> context;    // the context of `cut`
  tetcast::Cut cut;
  // [m] int32: the file's cell that each tetrahedron is a part of; empty if all its cells are tetrahedra.
  TetcastArray source = {};
  std::vector<std::pair<const char *, int64_t>> types; // the types of the file's cells, largest count first
  TetcastCutInfo info = {};                            // all 0 if nothing was cut
};

bool is_volume(int type); // whether cells of this type of VTK's become tetrahedra

struct CutOptions {
  int subdivision = 0;  // as in TetcastCellsDesc
  bool sources = false; // are wanted whatever the arrays
  int threads = 0;
};

// `grid` has valid offsets. Fails if it holds no volumetric cell or one that can't be cut. Vertices that are added come
// after the others in `points`, which are the grid's or a copy.
void make_tetrahedra(const char *path, vtkUnstructuredGrid *grid, vtkDataArray *points, const CutOptions &options,
                     Tetrahedra *result);

} // namespace tcv

#endif
