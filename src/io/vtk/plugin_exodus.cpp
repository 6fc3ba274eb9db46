// SPDX-License-Identifier: Apache-2.0
// Exodus II. VTK reads elements with more nodes than it knows of their type as if they had fewer, which shifts all but
// the first: it is told that they are a list of nodes, and what cell these make is found out here.
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

// Where in the list of an element each node of the cell is. Exodus has the edges between bottom and top before those of
// the top, and of a hexahedron's middles first the one inside, then bottom, top, left, right, front, back; what VTK's
// pyramid has beyond its base's is not used.
const signed char in_order[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const signed char hexahedron[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 16, 17,
                                  18, 19, 12, 13, 14, 15, 23, 24, 25, 26, 21, 22, 20};
const signed char wedge[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11, 15, 16, 17};
const signed char pyramid[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0, 0, 0, 0, 0};

// The first three letters of an element's type say what it is, its number of nodes which: at least so many in this
// table, and exactly so many where edges are to have nodes. In other numbers the corners come first, too.
const struct Kind {
  const char *letters;
  int listed, used; // nodes of the element, and of those in use
  int type, size;   // VTK's, and how many nodes that has
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

constexpr int MARK = 128; // types from here on stand for places in the table; no cell of VTK's has such a number
static_assert(static_cast<int>(VTK_NUMBER_OF_CELL_TYPES) <= MARK && MARK + std::size(kinds) <= 256,
              "types and places must not meet");

// The place of a block's kind; −1: no volume, or polyhedra, which VTK reads as they are.
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

  // Has VTK take all nodes of the elements, whatever they make. Returns what is to be said of those that will not be
  // used.
  std::vector<std::string> take_all_nodes() {
    struct Blocks : Metadata { // which only descendants see
      static std::map<int, std::vector<BlockInfoType>> Metadata::*all() { return &Blocks::BlockInfo; }
    };
    std::vector<std::string> remarks, told;
    for (auto &block : (this->Metadata->*Blocks::all())[ELEM_BLOCK]) {
      std::string type = block.TypeName;
      std::transform(type.begin(), type.end(), type.begin(),
                     [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
      const int nodes = block.BdsPerEntry[0], kind = find_kind(type.substr(0, 3), nodes);
      if (block.Size > 0 && nodes < block.PointsPerCell) { // VTK would read beyond the list
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

// The block with the cells that its lists of nodes make.
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
    reader_->SetSqueezePoints(false); // every block has all points of the file
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
    block->SetPoints(first->GetPoints()); // which tells that they are the same
    block->GetPointData()->ShallowCopy(first->GetPointData());
  }
  return blocks;
}

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &options) {
  return std::make_unique<Exodus>(options.displace);
}
