// SPDX-License-Identifier: Apache-2.0
// Collecting the grids that VTK's objects are made of.
#include "contents.hpp"

#include <vtkCompositeDataSet.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiPieceDataSet.h>

#include "common.hpp"

namespace tcv {

void list_block(const std::string &block, Contents *contents) {
  if (!block.empty() && (contents->blocks.empty() || contents->blocks.back() != block)) contents->blocks.push_back(block);
}

void add_grid(const Reading &reading, const std::string &block, vtkDataSet *dataset, Contents *contents) {
  if (!dataset) return;
  std::string place = reading.path;
  if (!block.empty()) {
    list_block(block, contents);
    if (!block_wanted(block, reading.desc->block)) return;
    place += ": block '" + block + "'";
  }
  Grid grid = vtkUnstructuredGrid::SafeDownCast(dataset);
  if (!grid) grid = to_hexahedra(place, dataset);
  if (grid) contents->pieces.push_back({place, grid, block.empty() ? -1 : static_cast<int>(contents->blocks.size()) - 1});
  else ++contents->surfaces;
}

// Children of a group that have no name go by their number, pieces of a block by the block's name.
static void add_child(const Reading &reading, const std::string &path, vtkDataObject *object, Contents *contents) {
  if (auto *pieces = vtkMultiPieceDataSet::SafeDownCast(object)) {
    for (unsigned i = 0; i < pieces->GetNumberOfPieces(); ++i) add_child(reading, path, pieces->GetPieceAsDataObject(i), contents);
    return;
  }
  auto *blocks = vtkMultiBlockDataSet::SafeDownCast(object);
  if (!blocks) return add_grid(reading, path, vtkDataSet::SafeDownCast(object), contents);
  for (unsigned i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
    vtkInformation *about = blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr;
    const char *name = about && about->Has(vtkCompositeDataSet::NAME()) ? about->Get(vtkCompositeDataSet::NAME()) : nullptr;
    const std::string own = name && *name ? name : std::to_string(i);
    add_child(reading, path.empty() ? own : path + "/" + own, blocks->GetBlock(i), contents);
  }
}

void add_object(const Reading &reading, vtkDataObject *object, Contents *contents) {
  add_child(reading, reading.block, object, contents);
}

} // namespace tcv
