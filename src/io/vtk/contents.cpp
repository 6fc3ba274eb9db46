// SPDX-License-Identifier: Apache-2.0
// Collects the grids that the objects of VTK consist of.
#include "contents.hpp"

namespace tcv {

void list_block(const std::string &block, Contents *contents) {
  if (!block.empty() && (contents->blocks.empty() || contents->blocks.back() != block))
    contents->blocks.push_back(block);
}

void add_grid(const Reading &reading, const std::string &block, vtkDataSet *dataset, Contents *contents) {
  if (!dataset)
    return;
  std::string place = reading.path;
  if (!block.empty()) {
    list_block(block, contents);
    if (!block_wanted(block, reading.desc->block))
      return;
    place += ": block '" + block + "'";
  }
  Grid grid = vtkUnstructuredGrid::SafeDownCast(dataset);
  if (!grid)
    grid = to_hexahedra(place, dataset);
  if (grid)
    contents->pieces.push_back({place, grid, block.empty() ? -1 : static_cast<int>(contents->blocks.size()) - 1});
  else
    ++contents->surfaces;
}

} // namespace tcv
