// SPDX-License-Identifier: Apache-2.0
#include "attributes.hpp"
#include "common.hpp"
#include "files.hpp"
#include "formats.hpp"
#include "selector.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include <vtkDataArraySelection.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkInputStream.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

namespace {

// Looks at binary data before VTK does, which divides by sizes that may be zero, writes blocks that are larger than
// they should be where they don't fit, and is content with the start of data that end early.
class Parser : public vtkXMLDataParser {
public:
  static Parser *New() { VTK_STANDARD_NEW_BODY(Parser); }

  // Whether the values that `element` describes make at least `bytes` bytes.
  bool holds(vtkXMLDataElement *element, uint64_t bytes, uint64_t file_size) {
    const char *format = element->GetAttribute("format");
    if (element->GetAttribute("offset")) {
      vtkTypeInt64 offset = 0;
      element->GetScalarAttribute("offset", offset);
      this->DataStream = this->AppendedDataStream;
      this->Stream->clear();
      this->SeekG(this->AppendedDataPosition + offset);
    } else if (format && std::strcmp(format, "binary") == 0) {
      this->DataStream = this->InlineDataStream;
      this->SeekInlineDataPosition(element);
    } else {
      return true; // text, which VTK reads with care
    }
    this->DataStream->SetStream(this->Stream);
    this->DataStream->StartReading();
    const bool good = this->Compressor ? blocks_hold(bytes, file_size) : plain_holds(bytes, file_size);
    this->DataStream->EndReading();
    this->Stream->clear();
    return good;
  }

private:
  bool read_header(uint64_t *values, size_t count) {
    const size_t word = this->HeaderType == 64 ? 8 : 4;
    unsigned char bytes[3 * 8];
    if (this->DataStream->Read(bytes, count * word) < count * word) return false;
    this->PerformByteSwap(bytes, count, word);
    for (size_t i = 0; i < count; ++i) {
      uint32_t narrow;
      std::memcpy(&narrow, bytes + i * word, sizeof narrow);
      values[i] = narrow;
      if (word == 8) std::memcpy(&values[i], bytes + i * word, sizeof values[i]);
    }
    return true;
  }

  // Number of blocks, size of each, size of a smaller last one (0: there is none).
  bool blocks_hold(uint64_t bytes, uint64_t file_size) {
    uint64_t header[3];
    if (!read_header(header, 3)) return false;
    const auto [count, size, last] = header;
    if (count == 0) return bytes == 0;
    if (count > file_size || size == 0 || size > UINT64_MAX / count || last > size) return false;
    return (last ? (count - 1) * size + last : count * size) >= bytes;
  }

  bool plain_holds(uint64_t bytes, uint64_t file_size) {
    uint64_t size;
    if (!read_header(&size, 1) || size < bytes) return false;
    if (!this->DataStream->IsA("vtkBase64InputStream")) {
      const vtkTypeInt64 at = this->TellG();
      return at >= 0 && static_cast<uint64_t>(at) <= file_size && bytes <= file_size - static_cast<uint64_t>(at);
    }
    std::vector<unsigned char> buffer(std::min<uint64_t>(bytes, 65536)); // a letter that is none ends the data
    while (bytes > 0) {
      const size_t part = std::min<uint64_t>(bytes, buffer.size());
      if (this->DataStream->Read(buffer.data(), part) < part) return false;
      bytes -= part;
    }
    return true;
  }
};

// What VTK leaves unchecked in readers of every kind.
template <typename Base> class Guarded : public Base {
public:
  void set_only(const char *selector) { only_ = selector; } // of the description; must outlive the reader

protected:
  void SetupOutputInformation(vtkInformation *information) override {
    Base::SetupOutputInformation(information);
    leave_out_unwanted();
  }

  void leave_out_unwanted() {
    for (int i = 0; only_ && i < this->NumberOfPieces; ++i) {
      leave_out(this->PointDataElements[i], this->PointDataArraySelection);
      leave_out(this->CellDataElements[i], this->CellDataArraySelection);
    }
  }

  void CreateXMLParser() override {
    if (this->XMLParser) this->DestroyXMLParser();
    this->XMLParser = Parser::New();
  }

  int ReadVTKFile(vtkXMLDataElement *element) override {
    const int result = Base::ReadVTKFile(element);
    this->FieldDataElement = nullptr; // notes on the whole file: not wanted, and VTK crashes on those of unknown type
    return result;
  }

  int ReadArrayValues(vtkXMLDataElement *element, vtkIdType index, vtkAbstractArray *array, vtkIdType start,
                      vtkIdType count, vtkXMLReader::FieldType type) override {
    uint64_t bits = 0; // of a value; strings have any length
    if (array->GetDataType() == VTK_BIT) bits = 1;
    else if (array->GetDataType() != VTK_STRING) bits = 8 * static_cast<uint64_t>(array->GetDataTypeSize());
    const uint64_t bytes = (bits * static_cast<uint64_t>(std::max<vtkIdType>(start + count, 0)) + 7) / 8;
    const auto file_size = static_cast<uint64_t>(tcv::file_size(this->GetFileName()));
    if (!static_cast<Parser *>(this->XMLParser)->holds(element, bytes, file_size)) {
      const char *name = element->GetAttribute("Name");
      vtkErrorMacro("array '" << (name ? name : "") << "' has less data than it should, or damaged ones");
      return 0;
    }
    return Base::ReadArrayValues(element, index, array, start, count, type);
  }

private:
  // Ghosts, and what curved cells need, are read at any rate.
  void leave_out(vtkXMLDataElement *arrays, vtkDataArraySelection *selection) {
    for (int i = 0; arrays && i < arrays->GetNumberOfNestedElements(); ++i) {
      const char *name = arrays->GetNestedElement(i)->GetAttribute("Name");
      if (!name || tcv::is_ghost_array(name) || tcv::may_name(only_, name)) continue;
      bool needed = false;
      for (const char *role : {"RationalWeights", "HigherOrderDegrees"}) {
        const char *of_role = arrays->GetAttribute(role);
        needed = needed || (of_role && std::strcmp(of_role, name) == 0);
      }
      if (!needed) selection->DisableArray(name);
    }
  }

  const char *only_ = nullptr;
};

// VTK allocates and clears what a header claims before it looks for the data, and takes negative counts as they are.
template <typename Base> class Checked : public Guarded<Base> {
public:
  static Checked *New() { VTK_STANDARD_NEW_BODY(Checked); }

  int pieces() const { return this->NumberOfPieces; }

protected:
  int ReadPiece(vtkXMLDataElement *element) override {
    if (!Base::ReadPiece(element)) return 0;
    const vtkIdType points = this->GetNumberOfPointsInPiece(this->Piece),
                    cells = this->GetNumberOfCellsInPiece(this->Piece);
    const int64_t limit = 256 * tcv::file_size(this->GetFileName()); // compressed, the best mesh stays far below
    if (points >= 0 && cells >= 0 && points <= limit && cells <= limit) return 1;
    vtkErrorMacro("piece " << this->Piece << " claims " << points << " points and " << cells
                           << " cells, which the file can't hold");
    return 0;
  }
};

// Structured grids: extents instead of counts, and pieces that have to cover the whole.
template <typename Base> class Structured : public Guarded<Base> {
public:
  static Structured *New() { VTK_STANDARD_NEW_BODY(Structured); }

protected:
  int ReadPrimaryElement(vtkXMLDataElement *element) override {
    if (!Base::ReadPrimaryElement(element)) return 0;
    // Before any piece is read: an array of equal values is compressed to a thousandth and less.
    const double limit = 4096.0 * static_cast<double>(tcv::file_size(this->GetFileName()));
    const double points = size(this->WholeExtent, 1);
    const double cells = size(this->WholeExtent, 0);
    if (points < 1 || points > limit) {
      vtkErrorMacro("the whole extent is of " << points << " points, which the file can't hold");
      return 0;
    }
    double covered = 0;
    for (int i = 0; i < this->NumberOfPieces; ++i) {
      const int *extent = this->PieceExtents + 6 * i;
      for (int k = 0; k < 3; ++k) {
        if (extent[2 * k] >= this->WholeExtent[2 * k] && extent[2 * k + 1] <= this->WholeExtent[2 * k + 1] && extent[2 * k] <= extent[2 * k + 1]) continue;
        vtkErrorMacro("the extent of piece " << i << " is not within the whole extent");
        return 0;
      }
      covered += size(extent, 0);
    }
    if (covered >= cells) return 1;
    vtkErrorMacro("the pieces have " << covered << " of the " << cells << " cells of the whole extent");
    return 0;
  }

private:
  static double size(const int *extent, int more) {
    double product = 1;
    for (int k = 0; k < 3; ++k) {
      const double length = static_cast<double>(extent[2 * k + 1]) - extent[2 * k] + more;
      product *= length < 0 ? 0 : length;
    }
    return product;
  }
};

class GridReader : public Checked<vtkXMLUnstructuredGridReader> {
public:
  static GridReader *New() { VTK_STANDARD_NEW_BODY(GridReader); }

protected:
  int ReadPieceData() override { return faces_fit() ? vtkXMLUnstructuredGridReader::ReadPieceData() : 0; }

  // VTK takes the first piece's arrays for those of all: it passes over others, and puts the values of one into another that it expects
  // in its place.
  void SetupOutputInformation(vtkInformation *information) override {
    Checked::SetupOutputInformation(information);
    for (int i = 0; i < this->NumberOfPieces; ++i) { // those there are already stay as they are
      add_all(this->PointDataElements[i], this->PointDataArraySelection);
      add_all(this->CellDataElements[i], this->CellDataArraySelection);
    }
    leave_out_unwanted();
  }
  void SetupOutputData() override { // pieces are read one by one
    const int piece = this->StartPiece < this->NumberOfPieces ? this->StartPiece : 0;
    std::swap(this->PointDataElements[0], this->PointDataElements[piece]);
    std::swap(this->CellDataElements[0], this->CellDataElements[piece]);
    vtkXMLUnstructuredGridReader::SetupOutputData();
    std::swap(this->PointDataElements[0], this->PointDataElements[piece]);
    std::swap(this->CellDataElements[0], this->CellDataElements[piece]);
  }

private:
  using Numbers = vtkSmartPointer<vtkIdTypeArray>;

  static void add_all(vtkXMLDataElement *arrays, vtkDataArraySelection *selection) {
    for (int i = 0; arrays && i < arrays->GetNumberOfNestedElements(); ++i) {
      const char *name = arrays->GetNestedElement(i)->GetAttribute("Name");
      if (name) selection->AddArray(name);
    }
  }

  Numbers numbers(vtkXMLDataElement *element, int64_t count) {
    const auto values = vtkSmartPointer<vtkAbstractArray>::Take(this->CreateArray(element));
    vtkDataArray *array = vtkDataArray::SafeDownCast(values);
    if (!array || array->GetNumberOfComponents() != 1) return nullptr;
    array->SetNumberOfTuples(count);
    if (!this->ReadArrayValues(element, 0, array, 0, count, CELL_DATA)) return nullptr;
    const auto result = Numbers::New();
    result->DeepCopy(array);
    return result;
  }

  // VTK walks the faces of polyhedra, and writes to them, without looking where they end.
  bool faces_fit() {
    vtkXMLDataElement *cells = this->CellElements[this->Piece];
    const int64_t count = this->NumberOfCells[this->Piece];
    vtkXMLDataElement *of_faces = this->FindDataArrayWithName(cells, "faces");
    vtkXMLDataElement *of_ends = this->FindDataArrayWithName(cells, "faceoffsets");
    if (!of_faces || !of_ends || count == 0) return true; // what is missing is noticed by VTK
    const Numbers ends = numbers(of_ends, count);
    int64_t size = 0; // as VTK takes it: the last end there is
    for (int64_t i = 0; ends && i < count; ++i) size = ends->GetValue(i) > -1 ? ends->GetValue(i) : size;
    const Numbers faces = ends ? numbers(of_faces, size) : nullptr;
    int64_t at = 0;
    for (int64_t i = 0; faces && i < count; ++i) {
      if (ends->GetValue(i) < 0) continue;
      const int64_t cell_faces = at < size ? faces->GetValue(at++) : -1;
      if (cell_faces < 0) at = -1;
      for (int64_t face = 0; at >= 0 && face < cell_faces; ++face) {
        const int64_t corners = at < size ? faces->GetValue(at++) : -1;
        at = corners < 0 || corners > size - at ? -1 : at + corners;
      }
      if (at < 0) break;
    }
    if (faces && at == size) return true;
    vtkErrorMacro("the faces of the polyhedra in piece " << this->Piece << " don't match their offsets");
    return false;
  }
};

template <typename Reader> auto read(const char *path, const char *only = nullptr) {
  vtkNew<Reader> reader;
  reader->SetFileName(path);
  reader->set_only(only);
  reader->Update();
  return vtkSmartPointer<std::remove_pointer_t<decltype(reader->GetOutput())>>(reader->GetOutput());
}

template <typename Reader> void read_structured(const tcv::Reading &reading, tcv::Contents *contents) {
  const auto grid = tcv::captured(reading.context, reading.path.c_str(), [&] { return read<Structured<Reader>>(reading.path.c_str(), reading.desc->only); });
  tcv::add_grid(reading, reading.block, grid, contents);
}

} // namespace

namespace tcv {

void read_vtu(const Reading &reading, Contents *contents) {
  const auto pieces = captured(reading.context, reading.path.c_str(), [&] {
    std::vector<Grid> grids;
    vtkNew<GridReader> reader;
    reader->SetFileName(reading.path.c_str());
    reader->set_only(reading.desc->only);
    reader->UpdateInformation();
    const int count = std::max(reader->pieces(), 1);
    for (int i = 0; i < count; ++i) {
      if (!reader->UpdatePiece(i, count, 0)) break; // has been said why
      grids.push_back(Grid::New());
      grids.back()->ShallowCopy(reader->GetOutput());
    }
    return grids;
  });
  for (const Grid &grid : pieces) add_grid(reading, reading.block, grid, contents);
}

void read_vti(const Reading &reading, Contents *contents) { read_structured<vtkXMLImageDataReader>(reading, contents); }
void read_vtr(const Reading &reading, Contents *contents) { read_structured<vtkXMLRectilinearGridReader>(reading, contents); }
void read_vts(const Reading &reading, Contents *contents) { read_structured<vtkXMLStructuredGridReader>(reading, contents); }

vtkSmartPointer<vtkPolyData> read_vtp(const char *path) { return read<Checked<vtkXMLPolyDataReader>>(path); }

} // namespace tcv
