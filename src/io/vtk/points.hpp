// SPDX-License-Identifier: Apache-2.0
// Finds where the points of pieces go in the one grid that is made of them.
#ifndef TETCAST_VTK_POINTS_HPP
#define TETCAST_VTK_POINTS_HPP

#include <memory>

#include <vtkPoints.h>

#include "contents.hpp"

namespace tcv {

struct PieceMap {
  std::vector<unsigned char> dropped_cells, dropped_points; // empty: none
  std::vector<unsigned char> point_marks;                   // vtkDataSetAttributes::PointGhostTypes; empty: none
  std::shared_ptr<std::vector<int64_t>> to;                 // the point of the grid that each point becomes; -1: none
  int64_t ghost_cells = 0, ghost_points = 0, nonfinite_cells = 0, nonfinite_points = 0;
  bool repeats = false; // has the points of the piece before, and its `to`

  bool keeps_cell(size_t i) const { return dropped_cells.empty() || !dropped_cells[i]; }
};

// Marks the points with a coordinate that is not finite; the cells that use them are dropped with them.
void drop_nonfinite(vtkUnstructuredGrid *grid, PieceMap *map);

// Fills `to`, counts the points that became one with another, and returns the points of the whole.
vtkSmartPointer<vtkPoints> merge_points(const std::vector<Piece> &pieces, double tolerance, std::vector<PieceMap> *maps,
                                        int64_t *merged);

// Puts the points of the whole in the order of their coordinates, x first, and changes `to` of all pieces accordingly.
// So what goes by the order of points is the same in all files that have them.
void sort_points(vtkPoints *points, std::vector<PieceMap> *maps);

} // namespace tcv

#endif
