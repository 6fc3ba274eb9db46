// SPDX-License-Identifier: Apache-2.0
// Puts the arrays of pieces together, for the one grid that is made of the pieces.
#ifndef TETCAST_VTK_ATTRIBUTES_HPP
#define TETCAST_VTK_ATTRIBUTES_HPP

#include "points.hpp"

class vtkDataArray;
class vtkDataSetAttributes;

namespace tcv {

// Merged points at which pieces have different values.
struct Differences {
  int64_t points = 0;
  std::string array; // the first array that has different values
};

// Adds the arrays to `grid`, which has its points and cells, and warns of what is missing. Those of the wrong length
// are noted as unread.
void join_arrays(const Reading &reading, const std::vector<Piece> &pieces, const std::vector<PieceMap> &maps,
                 vtkUnstructuredGrid *grid, Differences *differences, std::vector<UnreadArray> *unread);

bool is_ghost_array(const std::string &name);
bool numbers_things(vtkDataSetAttributes *attributes, vtkDataArray *array); // identifies points or cells

// Whether an array has a value for each of `count` points or cells; notes it as unread if not. `place` is empty if the
// file has only one.
bool has_length(const std::string &place, const ArrayName &name, vtkDataArray *array, int64_t count,
                std::vector<UnreadArray> *unread);

} // namespace tcv

#endif
