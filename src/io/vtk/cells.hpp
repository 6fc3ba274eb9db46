// SPDX-License-Identifier: Apache-2.0
// From the cells of a grid to tetrahedra.
#ifndef TETCAST_VTK_CELLS_HPP
#define TETCAST_VTK_CELLS_HPP

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <tetcast/cells.h>

class vtkUnstructuredGrid;

namespace tcv {

struct ContextDeleter {
  void operator()(TetcastContext *context) const;
};
struct CutDeleter {
  void operator()(TetcastCut *cut) const;
};

struct Tetrahedra {
  TetcastArray view = {};                                  // [m, 4] into one of the next two
  vtkSmartPointer<vtkDataArray> connectivity;              // the file's own, when all its cells are tetrahedra
  std::unique_ptr<TetcastContext, ContextDeleter> context; // of the next
  std::unique_ptr<TetcastCut, CutDeleter> cut;
  TetcastArray source = {}; // [m] int32: the cell of the file that each tetrahedron is of; empty: its own
  std::vector<std::pair<const char *, int64_t>> types; // of the file's cells, largest count first
  TetcastCutInfo info = {};                            // all 0 when nothing was cut
};

bool is_volume(int type); // whether cells of this type of VTK's become tetrahedra

struct CutOptions {
  int subdivision = 0; // of curved cells, as in TetcastCellsDesc
  int threads = 0;
};

// `grid` has valid offsets. Fails if it holds no volumetric cell or one that can't be cut. Vertices that are added come
// after the others in `points`, which are the grid's or a copy.
void make_tetrahedra(const char *path, vtkUnstructuredGrid *grid, vtkDataArray *points, const CutOptions &options,
                     Tetrahedra *result);

} // namespace tcv

#endif
