// SPDX-License-Identifier: Apache-2.0
// Reads Exodus II. If an element has more nodes than VTK knows of its type, VTK reads it as if it had fewer, which
// shifts all elements but the first. So VTK is told here that elements are lists of nodes, and which cells these make
// is found out afterwards.
#include <algorithm>
#include <string>

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkExodusIIReader.h>
#include <vtkExodusIIReaderPrivate.h>
#include <vtkIdTypeArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include "source.hpp"

namespace {

// These tables say at which place in an element's list each node of the cell is. Exodus has the edges between bottom
// and top before those of the top. Of a hexahedron's middles, the one inside comes first, and then those of bottom,
// top, left, right, front and back. Nodes of a pyramid that VTK has beyond the middle of its base are not used.
const signed char in_order[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const signed char hexahedron[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 16, 17,
                                  18, 19, 12, 13, 14, 15, 23, 24, 25, 26, 21, 22, 20};
const signed char wedge[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11, 15, 16, 17};
const signed char pyramid[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0, 0, 0, 0, 0};

// The first three letters of an element's type say what it is, and its number of nodes says which. An element has at
// least as many nodes as its row says, and exactly as many if its edges have nodes. Corners come first whatever the
// number is.
const struct Kind {
  const char *letters;
  int listed, used; // How many nodes the element lists, and how many of them are used.
  int type, size;   // The type for VTK, and how many nodes that has.
  const signed char *order;
} kinds[] = {
    {"TET", 10, 10, VTK_QUADRATIC_TETRA, 10, in_order},
    {"TET", 11, 10, VTK_QUADRATIC_TETRA, 10, in_order},
    {"TET", 14, 10, VTK_QUADRATIC_TETRA, 10, in_order},
    {"TET", 15, 10, VTK_QUADRATIC_TETRA, 10, in_order},
    {"TET", 0, 4, VTK_TETRA, 4, in_order},
    {"PYR", 13, 13, VTK_QUADRATIC_PYRAMID, 13, in_order},
    {"PYR", 14, 14, VTK_TRIQUADRATIC_PYRAMID, 19, pyramid},
    {"PYR", 18, 14, VTK_TRIQUADRATIC_PYRAMID, 19, pyramid},
    {"PYR", 19, 14, VTK_TRIQUADRATIC_PYRAMID, 19, pyramid},
    {"PYR", 0, 5, VTK_PYRAMID, 5, in_order},
    {"WED", 15, 15, VTK_QUADRATIC_WEDGE, 15, wedge},
    {"WED", 16, 15, VTK_QUADRATIC_WEDGE, 15, wedge},
    {"WED", 18, 18, VTK_BIQUADRATIC_QUADRATIC_WEDGE, 18, wedge},
    {"WED", 20, 15, VTK_QUADRATIC_WEDGE, 15, wedge},
    {"WED", 21, 15, VTK_QUADRATIC_WEDGE, 15, wedge},
    {"WED", 0, 6, VTK_WEDGE, 6, in_order},
    {"HEX", 20, 20, VTK_QUADRATIC_HEXAHEDRON, 20, hexahedron},
    {"HEX", 21, 20, VTK_QUADRATIC_HEXAHEDRON, 20, hexahedron},
    {"HEX", 26, 20, VTK_QUADRATIC_HEXAHEDRON, 20, hexahedron},
    {"HEX", 27, 27, VTK_TRIQUADRATIC_HEXAHEDRON, 27, hexahedron},
    {"HEX", 0, 8, VTK_HEXAHEDRON, 8, in_order},
};

constexpr int MARK = 128; // Types from here on are rows of the table. No cell of VTK has such a number.
static_assert(static_cast<int>(VTK_NUMBER_OF_CELL_TYPES) <= MARK && MARK + std::size(kinds) <= 256,
              "types and places must not meet");

// Returns the row of a block's kind, or −1 if it is no volume, or if it has polyhedra, which VTK reads as they are.
int find_kind(const std::string &letters, int nodes) {
  for (size_t i = 0; i < std::size(kinds); ++i) {
    if (letters == kinds[i].letters && (kinds[i].listed == nodes || (kinds[i].listed == 0 && nodes >= kinds[i].used)))
      return static_cast<int>(i);
  }
  return -1;
}

using Metadata = vtkExodusIIReaderPrivate;

class Reader : public vtkExodusIIReader {
public:
  static Reader *New() { VTK_STANDARD_NEW_BODY(Reader); }

  // Makes VTK take all nodes of the elements, whatever cells they make. Returns a message about those that will not be
  // used.
  std::vector<std::string> take_all_nodes() {
    struct Blocks : Metadata { // Only classes that are derived from it see it.
      static std::map<int, std::vector<BlockInfoType>> Metadata::*all() { return &Blocks::BlockInfo; }
    };
    std::vector<std::string> remarks, told;
    for (auto &block : (this->Metadata->*Blocks::all())[ELEM_BLOCK]) {
      std::string type = block.TypeName;
      std::transform(type.begin(), type.end(), type.begin(),
                     [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
      const int nodes = block.BdsPerEntry[0], kind = find_kind(type.substr(0, 3), nodes);
      if (block.Size > 0 && nodes < block.PointsPerCell) { // VTK would read beyond the list.
        vtkErrorMacro("block " << block.Id << ": its " << nodes << " nodes don't make an element of type " << type);
        block.Status = 0;
      }
      if (kind < 0)
        continue;
      block.CellType = MARK + kind;
      block.PointsPerCell = nodes;
      const std::string text = "elements of type " + type + ", of " + std::to_string(nodes) + " nodes each: ";
      if (kinds[kind].used == nodes || std::find(told.begin(), told.end(), text) != told.end())
        continue;
      told.push_back(text);
      remarks.push_back(text + "the first " + std::to_string(kinds[kind].used) + ", at corners" +
                        (kinds[kind].listed ? " and edges," : ",") + " are used, the others ignored");
    }
    return remarks;
  }
};

// Returns the block with the cells that its lists of nodes make.
void make_cells(vtkUnstructuredGrid *block) {
  vtkUnsignedCharArray *types = block->GetCellTypesArray();
  const vtkIdType cells = block->GetNumberOfCells();
  if (cells == 0 || !types || types->GetValue(0) < MARK)
    return;
  const Kind &kind = kinds[types->GetValue(0) - MARK];
  vtkNew<vtkIdTypeArray> corners, ends;
  vtkNew<vtkUnsignedCharArray> new_types;
  corners->SetNumberOfValues(cells * kind.size);
  ends->SetNumberOfValues(cells + 1);
  new_types->SetNumberOfValues(cells);
  new_types->FillValue(static_cast<unsigned char>(kind.type));
  for (vtkIdType i = 0; i < cells; ++i) {
    vtkIdType size;
    const vtkIdType *nodes;
    block->GetCells()->GetCellAtId(i, size, nodes);
    for (int k = 0; k < kind.size; ++k)
      corners->SetValue(i * kind.size + k, nodes[kind.order[k]]);
  }
  for (vtkIdType i = 0; i <= cells; ++i)
    ends->SetValue(i, i * kind.size);
  vtkNew<vtkCellArray> list;
  list->SetData(ends, corners);
  block->SetCells(new_types, list);
}

class Exodus : public tcv::Source {
public:
  explicit Exodus(bool displace) { reader_->SetApplyDisplacements(displace); }

  bool open(const std::string &path) override {
    if (!reader_->CanReadFile(path.c_str()))
      return false;
    reader_->SetFileName(path.c_str());
    reader_->UpdateInformation();
    remarks = reader_->take_all_nodes();
    reader_->SetSqueezePoints(false); // Then every block has all points of the file.
    reader_->GenerateObjectIdCellArrayOff();
    reader_->GenerateGlobalElementIdArrayOff();
    reader_->GenerateGlobalNodeIdArrayOff();
    return true;
  }
  std::vector<double> times() override {
    vtkInformation *about = reader_->GetOutputInformation(0);
    const auto key = vtkStreamingDemandDrivenPipeline::TIME_STEPS();
    if (about && about->Has(key))
      times_.assign(about->Get(key), about->Get(key) + about->Length(key));
    return times_;
  }
  std::vector<tcv::ArrayName> arrays() override {
    std::vector<tcv::ArrayName> names;
    for (const int kind : {vtkExodusIIReader::NODAL, vtkExodusIIReader::ELEM_BLOCK}) {
      for (int i = 0; i < reader_->GetNumberOfObjectArrays(kind); ++i) {
        names.push_back(
            {kind == vtkExodusIIReader::NODAL ? TETCAST_POINT : TETCAST_CELL, reader_->GetObjectArrayName(kind, i)});
      }
    }
    return names;
  }
  void enable(const tcv::ArrayName &array, bool on) override {
    const int kind = array.association == TETCAST_POINT ? vtkExodusIIReader::NODAL : vtkExodusIIReader::ELEM_BLOCK;
    reader_->SetObjectArrayStatus(kind, array.name.c_str(), on);
  }
  vtkSmartPointer<vtkDataObject> read(int64_t step) override;

private:
  vtkNew<Reader> reader_;
  std::vector<double> times_;
};

vtkSmartPointer<vtkDataObject> Exodus::read(int64_t step) {
  if (times_.empty())
    reader_->Update();
  else
    reader_->UpdateTimeStep(times_[static_cast<size_t>(step)]);
  auto *output = vtkMultiBlockDataSet::SafeDownCast(reader_->GetOutputDataObject(0));
  auto *blocks =
      output && output->GetNumberOfBlocks() > 0 ? vtkMultiBlockDataSet::SafeDownCast(output->GetBlock(0)) : nullptr;
  if (!blocks)
    return output;
  vtkUnstructuredGrid *first = nullptr;
  for (unsigned i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
    auto *block = vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(i));
    if (!block || block->GetNumberOfPoints() == 0)
      continue;
    make_cells(block);
    first = first ? first : block;
    if (block == first || block->GetNumberOfPoints() != first->GetNumberOfPoints())
      continue;
    block->SetPoints(first->GetPoints()); // That shows that they are the same points.
    block->GetPointData()->ShallowCopy(first->GetPointData());
  }
  return blocks;
}

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &options) {
  return std::make_unique<Exodus>(options.displace);
}
