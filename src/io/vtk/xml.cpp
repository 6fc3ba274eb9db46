// SPDX-License-Identifier: Apache-2.0
#include "attributes.hpp"
#include "common.hpp"
#include "files.hpp"
#include "formats.hpp"
#include "numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <vtkCellData.h>
#include <vtkDataArraySelection.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkInputStream.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
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

constexpr int64_t MOST_POINTS_ALONE = 1 << 21; // The most points of a structured grid that has no arrays.

// Looks at binary data before VTK does. VTK divides by sizes that may be zero, writes blocks that are larger than they
// should be where they don't fit, and accepts data that end early.
class Parser : public vtkXMLDataParser {
public:
  static Parser *New() { VTK_STANDARD_NEW_BODY(Parser); }

  // Returns whether `element` can hold `count` values of so many bits, as far as its header tells. It is asked before
  // memory is taken.
  bool may_hold(vtkXMLDataElement *element, uint64_t count, uint64_t bits, uint64_t file_size) {
    if (is_text(element))
      return count <= file_size / 2 + 1; // Each value takes at least a digit and a blank.
    return count <= UINT64_MAX / 64 && look(element, [&] {
             const uint64_t bytes = (count * bits + 7) / 8;
             if (this->Compressor)
               return blocks_hold(bytes, file_size);
             uint64_t size;
             return read_header(&size, 1) && size >= bytes && bytes <= file_size;
           });
  }

  // Returns whether the values that `element` describes make at least `bytes` bytes.
  bool holds(vtkXMLDataElement *element, uint64_t bytes, uint64_t file_size) {
    return is_text(element) || look(element, [&] {
             return this->Compressor ? blocks_hold(bytes, file_size) : plain_holds(bytes, file_size);
           });
  }

  // Returns the stream, at the place where the values of an element of text begin.
  std::istream &text_of(vtkXMLDataElement *element) {
    this->Stream->clear();
    this->SeekInlineDataPosition(element);
    return *this->Stream;
  }

  static bool is_text(vtkXMLDataElement *element) {
    const char *format = element->GetAttribute("format");
    return !element->GetAttribute("offset") && !(format && std::strcmp(format, "binary") == 0);
  }

private:
  template <typename Look> bool look(vtkXMLDataElement *element, Look &&inside) {
    this->Stream->clear();
    if (element->GetAttribute("offset")) {
      vtkTypeInt64 offset = -1;
      element->GetScalarAttribute("offset", offset);
      if (offset < 0 || offset > INT64_MAX / 2)
        return false;
      this->DataStream = this->AppendedDataStream;
      this->SeekG(this->AppendedDataPosition + offset);
    } else {
      this->DataStream = this->InlineDataStream;
      this->SeekInlineDataPosition(element);
    }
    this->DataStream->SetStream(this->Stream);
    this->DataStream->StartReading();
    const bool good = inside();
    this->DataStream->EndReading();
    this->Stream->clear();
    return good;
  }

  bool read_header(uint64_t *values, size_t count) {
    const size_t word = this->HeaderType == 64 ? 8 : 4;
    unsigned char bytes[3 * 8];
    if (this->DataStream->Read(bytes, count * word) < count * word)
      return false;
    this->PerformByteSwap(bytes, count, word);
    for (size_t i = 0; i < count; ++i) {
      uint32_t narrow;
      std::memcpy(&narrow, bytes + i * word, sizeof narrow);
      values[i] = narrow;
      if (word == 8)
        std::memcpy(&values[i], bytes + i * word, sizeof values[i]);
    }
    return true;
  }

  // Checks compressed data. They begin with the number of blocks, the size of each, the size of a smaller last one (0
  // if there is none), and the size that each block has when it is compressed. None of these is larger than the file.
  // What one compressed byte can become is limited as well: to 1032 bytes for zlib, and in practice to as much for the
  // others.
  bool blocks_hold(uint64_t bytes, uint64_t file_size) {
    uint64_t header[3];
    if (!read_header(header, 3))
      return false;
    const auto [count, size, last] = header;
    if (count == 0)
      return bytes == 0;
    if (count > file_size / 12 + 1 || size == 0 || size > UINT64_MAX / 2 / count || last > size)
      return false;
    if ((last ? (count - 1) * size + last : count * size) < bytes)
      return false;
    uint64_t stored = 0;
    for (uint64_t i = 0; i < count; ++i) {
      uint64_t compressed;
      if (!read_header(&compressed, 1) || compressed > file_size - stored)
        return false;
      stored += compressed;
    }
    return size <= file_size * 16384 && bytes / 16384 <= stored;
  }

  bool plain_holds(uint64_t bytes, uint64_t file_size) {
    uint64_t size;
    if (!read_header(&size, 1) || size < bytes)
      return false;
    if (!this->DataStream->IsA("vtkBase64InputStream")) {
      const vtkTypeInt64 at = this->TellG();
      return at >= 0 && static_cast<uint64_t>(at) <= file_size && bytes <= file_size - static_cast<uint64_t>(at);
    }
    // A letter that does not belong there ends the data.
    std::vector<unsigned char> buffer(std::min<uint64_t>(bytes, 65536));
    while (bytes > 0) {
      const size_t part = std::min<uint64_t>(bytes, buffer.size());
      if (this->DataStream->Read(buffer.data(), part) < part)
        return false;
      bytes -= part;
    }
    return true;
  }
};

// Returns how many bits a value of a type of VTK takes, or 0 if it is no number.
uint64_t bits_of(int type) {
  if (type == VTK_BIT)
    return 1;
  const bool number =
      (type >= VTK_CHAR && type <= VTK_ID_TYPE) || (type >= VTK_SIGNED_CHAR && type <= VTK_UNSIGNED_LONG_LONG);
  return number ? 8 * static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(type)) : 0;
}

bool is_named(vtkXMLDataElement *element, const char *name) {
  return element->GetName() && std::strcmp(element->GetName(), name) == 0;
}

// Checks what VTK leaves unchecked in readers of every kind. Arrays over points and cells that would make VTK fail are
// taken out of the XML before VTK sees them. Those whose values can't be read are left out of the result.
template <typename Base> class Guarded : public Base {
public:
  // Sets which arrays are wanted, and where to note those that can't be read. Both must outlive the reader.
  void set_request(const char *only, std::vector<tcv::UnreadArray> *unread) {
    only_ = only;
    unread_ = unread;
  }

  // Takes arrays whose values could not be read out of the result, and puts in those that needed another type.
  void mend(vtkDataSet *output) {
    for (const tcv::ArrayName &one : unreadable_)
      attributes_of(output, one.association)->RemoveArray(one.name.c_str());
    for (const auto &[association, array] : wider_)
      attributes_of(output, association)->AddArray(array);
    unreadable_.clear();
    wider_.clear();
  }

protected:
  void CreateXMLParser() override {
    if (this->XMLParser)
      this->DestroyXMLParser();
    this->XMLParser = Parser::New();
  }

  int ReadVTKFile(vtkXMLDataElement *element) override {
    element->RemoveAttribute("TimeValues");
    if (!tidy(element, 0))
      return 0;
    const int result = Base::ReadVTKFile(element);
    this->FieldDataElement = nullptr;
    return result;
  }

  // Returns whether piece `piece` has room for what it claims. Arrays that have not are taken out.
  bool claims_fit(vtkXMLDataElement *piece, int64_t points, int64_t cells) {
    for (int i = 0; i < piece->GetNumberOfNestedElements(); ++i) {
      vtkXMLDataElement *group = piece->GetNestedElement(i);
      const bool of_points = is_named(group, "PointData");
      if (of_points || is_named(group, "CellData")) {
        const TetcastAssociation association = of_points ? TETCAST_POINT : TETCAST_CELL;
        for (int k = group->GetNumberOfNestedElements(); k-- > 0;) {
          vtkXMLDataElement *array = group->GetNestedElement(k);
          if (fits(array, of_points ? points : cells))
            continue;
          lose({association, array->GetAttribute("Name")}, "it has less data than it should, or damaged ones");
          group->RemoveNestedElement(array);
        }
        continue;
      }
      const int64_t tuples =
          // How many there are of others is not known, or the number of cells is what counts.
          is_named(group, "Points") ? points : 0;
      for (int k = 0; k < group->GetNumberOfNestedElements(); ++k) {
        vtkXMLDataElement *array = group->GetNestedElement(k);
        const char *name = array->GetAttribute("Name");
        const bool per_cell =
            is_named(group, "Cells") && name && (std::strcmp(name, "offsets") == 0 || std::strcmp(name, "types") == 0);
        if (fits(array, per_cell ? cells : tuples))
          continue;
        vtkErrorMacro("array '" << (name ? name : group->GetName())
                                << "' has less data than it should, or damaged ones");
        return false;
      }
    }
    return true;
  }

  int ReadArrayForPoints(vtkXMLDataElement *element, vtkAbstractArray *array) override {
    return attempt(element, TETCAST_POINT, array, [&] { return Base::ReadArrayForPoints(element, array); });
  }
  int ReadArrayForCells(vtkXMLDataElement *element, vtkAbstractArray *array) override {
    return attempt(element, TETCAST_CELL, array, [&] { return Base::ReadArrayForCells(element, array); });
  }

  int ReadArrayValues(vtkXMLDataElement *element, vtkIdType index, vtkAbstractArray *array, vtkIdType start,
                      vtkIdType count, vtkXMLReader::FieldType type) override {
    const char *name = element->GetAttribute("Name");
    vtkDataArray *numbers = vtkDataArray::SafeDownCast(array);
    const uint64_t bits = numbers ? bits_of(array->GetDataType()) : 0;
    if (bits == 0 || start < 0 || count < 0 || index < 0 || index > array->GetNumberOfValues() - count) {
      vtkErrorMacro("array '" << (name ? name : "") << "' is not of numbers, or of a size it can't have");
      return 0;
    }
    auto *parser = static_cast<Parser *>(this->XMLParser);
    if (Parser::is_text(element) && bits > 1)
      return read_text(element, index, numbers, start, count);
    const uint64_t bytes = (bits * static_cast<uint64_t>(start + count) + 7) / 8;
    if (!parser->holds(element, bytes, static_cast<uint64_t>(tcv::file_size(this->GetFileName())))) {
      vtkErrorMacro("array '" << (name ? name : "") << "' has less data than it should, or damaged ones");
      return 0;
    }
    return Base::ReadArrayValues(element, index, array, start, count, type);
  }

  void lose(const tcv::ArrayName &array, const std::string &reason) {
    if (unread_)
      tcv::note_unread(unread_, array, reason);
  }

private:
  static vtkDataSetAttributes *attributes_of(vtkDataSet *output, TetcastAssociation association) {
    return association == TETCAST_POINT ? static_cast<vtkDataSetAttributes *>(output->GetPointData())
                                        : output->GetCellData();
  }

  // Ghosts, and what curved cells need, are read in any case.
  bool is_wanted(vtkXMLDataElement *group, const char *name) const {
    if (tcv::is_ghost_array(name) || tcv::may_name(only_, name))
      return true;
    for (const char *role : {"RationalWeights", "HigherOrderDegrees"}) {
      const char *of_role = group->GetAttribute(role);
      if (of_role && std::strcmp(of_role, name) == 0)
        return true;
    }
    return false;
  }

  // Takes out what is not wanted or would make VTK crash: notes on the file and on arrays, and arrays over points and
  // cells that are no arrays, or of the wrong kind. Returns false if something that the mesh needs is among these.
  bool tidy(vtkXMLDataElement *element, int depth) {
    if (depth > 16)
      return true; // Nothing of use is nested so deeply.
    for (int i = element->GetNumberOfNestedElements(); i-- > 0;) {
      vtkXMLDataElement *nested = element->GetNestedElement(i);
      const bool of_points = is_named(nested, "PointData"),
                 array = is_named(nested, "DataArray") || is_named(nested, "Array");
      if (is_named(nested, "FieldData") || is_named(nested, "InformationKey")) {
        element->RemoveNestedElement(nested);
      } else if (of_points || is_named(nested, "CellData")) {
        tidy_arrays(nested, of_points ? TETCAST_POINT : TETCAST_CELL);
      } else if (!array) {
        nested->RemoveAttribute("TimeValues");
        if (!tidy(nested, depth + 1))
          return false;
      } else {
        const std::string fault = fault_of(nested);
        if (!fault.empty()) {
          const char *name = nested->GetAttribute("Name");
          vtkErrorMacro("array '" << (name ? name : element->GetName()) << "': " << fault);
          return false;
        }
        nested->RemoveAttribute("TimeStep");
        nested->RemoveAllNestedElements();
      }
    }
    return true;
  }

  void tidy_arrays(vtkXMLDataElement *group, TetcastAssociation association) {
    std::vector<std::string> names;
    for (int i = 0, place = 0; i < group->GetNumberOfNestedElements(); ++place) {
      vtkXMLDataElement *array = group->GetNestedElement(i);
      const char *given = array->GetAttribute("Name"), *step = array->GetAttribute("TimeStep"),
                 *type = array->GetAttribute("type");
      const std::string name = given && *given ? given : "unnamed_" + std::to_string(place);
      const bool text = type && std::strcmp(type, "String") == 0; // Nothing can be made of strings.
      const bool later = step && std::atoi(step) != 0;            // Of several steps the first is read.
      std::string fault;
      if (!text && !later) {
        fault = fault_of(array);
        if (fault.empty() && std::find(names.begin(), names.end(), name) != names.end())
          fault = "it is the second of that name";
        if (!is_wanted(group, name.c_str()))
          lose({association, name}, "");
        else if (!fault.empty())
          lose({association, name}, fault);
      }
      if (text || later || !fault.empty() || !is_wanted(group, name.c_str())) {
        group->RemoveNestedElement(array);
        continue;
      }
      names.push_back(name);
      array->SetAttribute("Name", name.c_str());
      array->RemoveAttribute("TimeStep");
      array->RemoveAllNestedElements();
      ++i;
    }
  }

  // Returns why an element can't be an array of numbers, or nothing if it can.
  static std::string fault_of(vtkXMLDataElement *array) {
    int type = 0;
    const tcv::Doubt doubt; // VTK complains of types that it doesn't know.
    if (!is_named(array, "DataArray") && !is_named(array, "Array"))
      return "it is no array";
    const char *type_name = array->GetAttribute("type"), *components = array->GetAttribute("NumberOfComponents");
    if (!type_name || !array->GetWordTypeAttribute("type", type) || bits_of(type) == 0)
      return std::string("its type is '") + (type_name ? type_name : "") + "'";
    const double count = components ? tcv::number_of(components) : 1;
    if (count >= 1 && count <= MOST_COMPONENTS && count == std::floor(count))
      return "";
    return std::string("it claims ") + components + " components";
  }

  bool fits(vtkXMLDataElement *array, int64_t tuples) {
    int type = 0, components = 1;
    array->GetWordTypeAttribute("type", type);
    array->GetScalarAttribute("NumberOfComponents", components);
    const auto count = static_cast<uint64_t>(tuples) * static_cast<uint64_t>(std::max(components, 1));
    return static_cast<Parser *>(this->XMLParser)
        ->may_hold(array, count, bits_of(type), static_cast<uint64_t>(tcv::file_size(this->GetFileName())));
  }

  // Reads an array. One over points or cells that can't be read is noted, and has no other consequence.
  template <typename Read>
  int attempt(vtkXMLDataElement *element, TetcastAssociation association, vtkAbstractArray *array, Read &&read) {
    const char *name = element->GetAttribute("Name");
    const bool over_these =
        element->GetParent() && is_named(element->GetParent(), association == TETCAST_POINT ? "PointData" : "CellData");
    if (!over_these || !name || tcv::is_ghost_array(name))
      return read(); // Nothing can be done without this one.
    overflowed_ = false;
    std::string reason;
    {
      const tcv::Doubt doubt;
      if (!read() || doubt.failed())
        reason = doubt.error().empty() ? "its data are damaged" : doubt.error();
    }
    if (!reason.empty()) {
      unreadable_.push_back({association, name});
      lose({association, name}, reason);
    } else if (overflowed_) {
      widen(element, association, array);
    }
    return 1;
  }

  // Values that claim to be of single precision, but need double, are read again.
  void widen(vtkXMLDataElement *element, TetcastAssociation association, vtkAbstractArray *array) {
    auto wide = vtkSmartPointer<vtkDoubleArray>::New();
    wide->SetName(array->GetName());
    wide->SetNumberOfComponents(array->GetNumberOfComponents());
    wide->CopyComponentNames(array);
    wide->SetNumberOfTuples(array->GetNumberOfTuples());
    if (read_text(element, 0, wide, 0, wide->GetNumberOfValues()))
      wider_.emplace_back(association, wide);
  }

  // Reads a part of a structured grid row by row. Values that come before the part are passed over.
  int read_text(vtkXMLDataElement *element, vtkIdType index, vtkDataArray *array, vtkIdType start, vtkIdType count) {
    if (text_element_ != element || text_at_ > start) {
      static_cast<Parser *>(this->XMLParser)->text_of(element);
      text_at_ = 0;
    } else {
      this->Stream->clear();
      this->Stream->seekg(text_place_);
    }
    text_element_ = element;
    tcv::NumberReader reader(*this->Stream, '<');
    std::vector<double> passed(static_cast<size_t>(std::min<vtkIdType>(start - text_at_, 4096)));
    while (text_at_ < start) {
      const auto part = std::min<int64_t>(start - text_at_, static_cast<int64_t>(passed.size()));
      if (reader.read(passed.data(), part) < part)
        return too_few(element, array, reader, start);
      text_at_ += part;
    }
    int64_t have = 0;
    switch (array->GetDataType()) {
      vtkTemplateMacro(have = reader.read(static_cast<VTK_TT *>(array->GetVoidPointer(index)), count));
    default:
      break;
    }
    text_at_ += have;
    text_place_ = this->Stream->tellg();
    overflowed_ = overflowed_ || (reader.overflowed() && start == 0 && count == array->GetNumberOfValues());
    if (have < count)
      return too_few(element, array, reader, start + have);
    array->Modified();
    return 1;
  }

  int too_few(vtkXMLDataElement *element, vtkDataArray *, const tcv::NumberReader &reader, int64_t have) {
    const char *name = element->GetAttribute("Name");
    text_element_ = nullptr;
    const bool of_cells =
        name && (!std::strcmp(name, "connectivity") || !std::strcmp(name, "offsets") || !std::strcmp(name, "types"));
    if (reader.word().empty() && of_cells)
      return 0; // VTK reports this itself.
    if (reader.word().empty())
      vtkErrorMacro("array '" << (name ? name : "") << "' has only " << have << " values: it is too short");
    else
      vtkErrorMacro("array '" << (name ? name : "") << "': value " << have << " is '" << reader.word().substr(0, 40)
                              << "', which is not a number of its type");
    return 0;
  }

  enum { MOST_COMPONENTS = 1 << 20 };

  const char *only_ = nullptr;
  std::vector<tcv::UnreadArray> *unread_ = nullptr;
  std::vector<tcv::ArrayName> unreadable_;
  std::vector<std::pair<TetcastAssociation, vtkSmartPointer<vtkDataArray>>> wider_;
  bool overflowed_ = false;
  const vtkXMLDataElement *text_element_ =
      nullptr; // Its text was read up to value text_at_, which is at text_place_ in the file.
  vtkIdType text_at_ = 0;
  std::istream::pos_type text_place_ = 0;
};

// Checks counts, because VTK allocates and clears as much as a header claims before it looks for the data, and takes
// negative counts as they are.
template <typename Base> class Checked : public Guarded<Base> {
public:
  static Checked *New() { VTK_STANDARD_NEW_BODY(Checked); }

  int pieces() const { return this->NumberOfPieces; }

protected:
  int ReadPiece(vtkXMLDataElement *element) override {
    if (!Base::ReadPiece(element))
      return 0;
    const vtkIdType points = this->GetNumberOfPointsInPiece(this->Piece),
                    cells = this->GetNumberOfCellsInPiece(this->Piece);
    // Even the best compressed mesh stays far below this.
    const int64_t limit = 256 * tcv::file_size(this->GetFileName());
    if (points >= 0 && cells >= 0 && points <= limit && cells <= limit)
      return this->claims_fit(element, points, cells);
    vtkErrorMacro("piece " << this->Piece << " claims " << points << " points and " << cells
                           << " cells, which the file can't hold");
    return 0;
  }
};

// Checks structured grids, which have extents instead of counts, and whose pieces have to cover the whole.
template <typename Base> class Structured : public Guarded<Base> {
public:
  static Structured *New() { VTK_STANDARD_NEW_BODY(Structured); }

protected:
  int ReadPiece(vtkXMLDataElement *element) override {
    if (!Base::ReadPiece(element))
      return 0;
    const int *extent = this->PieceExtents + 6 * this->Piece;
    const double points = size(extent, 1), cells = size(extent, 0);
    if (points < 1e15)
      return this->claims_fit(element, static_cast<int64_t>(points), static_cast<int64_t>(cells));
    vtkErrorMacro("piece " << this->Piece << " claims " << points << " points, which the file can't hold");
    return 0;
  }

  int ReadPrimaryElement(vtkXMLDataElement *element) override {
    if (!Base::ReadPrimaryElement(element))
      return 0;
    // This happens before any piece is read, because an array of equal values is compressed to a thousandth and less.
    const double limit = 4096.0 * static_cast<double>(tcv::file_size(this->GetFileName()));
    const double points = size(this->WholeExtent, 1);
    const double cells = size(this->WholeExtent, 0);
    if (points < 1 || points > limit) {
      vtkErrorMacro("the whole extent is of " << points << " points, which the file can't hold");
      return 0;
    }
    unify(this->PointDataElements, TETCAST_POINT);
    unify(this->CellDataElements, TETCAST_CELL);
    double covered = 0;
    for (int i = 0; i < this->NumberOfPieces; ++i) {
      const int *extent = this->PieceExtents + 6 * i;
      for (int k = 0; k < 3; ++k) {
        if (extent[2 * k] >= this->WholeExtent[2 * k] && extent[2 * k + 1] <= this->WholeExtent[2 * k + 1] &&
            extent[2 * k] <= extent[2 * k + 1])
          continue;
        vtkErrorMacro("the extent of piece " << i << " is not within the whole extent");
        return 0;
      }
      covered += size(extent, 0);
    }
    if (covered >= cells)
      return 1;
    vtkErrorMacro("the pieces have " << covered << " of the " << cells << " cells of the whole extent");
    return 0;
  }

private:
  static const char *text(vtkXMLDataElement *array, const char *attribute, const char *otherwise) {
    const char *value = array->GetAttribute(attribute);
    return value ? value : otherwise;
  }
  static bool alike(vtkXMLDataElement *a, vtkXMLDataElement *b) {
    return std::strcmp(text(a, "type", ""), text(b, "type", "")) == 0 &&
           std::strcmp(text(a, "NumberOfComponents", "1"), text(b, "NumberOfComponents", "1")) == 0;
  }
  static vtkXMLDataElement *find(vtkXMLDataElement *group, const std::string &name) {
    for (int i = 0; group && i < group->GetNumberOfNestedElements(); ++i) {
      if (name == text(group->GetNestedElement(i), "Name", ""))
        return group->GetNestedElement(i);
    }
    return nullptr;
  }

  // Leaves out arrays that are not the same in all pieces, because VTK takes the arrays of the first piece, one after
  // the other, for those of all.
  void unify(vtkXMLDataElement **groups, TetcastAssociation association) {
    std::vector<std::string> names; // All names that are in any of the pieces.
    for (int i = 0; i < this->NumberOfPieces; ++i) {
      for (int k = 0; groups[i] && k < groups[i]->GetNumberOfNestedElements(); ++k) {
        const std::string name = text(groups[i]->GetNestedElement(k), "Name", "");
        if (std::find(names.begin(), names.end(), name) == names.end())
          names.push_back(name);
      }
    }
    for (const std::string &name : names) {
      vtkXMLDataElement *first = find(groups[0], name);
      bool good = first != nullptr;
      for (int i = 1; good && i < this->NumberOfPieces; ++i) {
        vtkXMLDataElement *other = find(groups[i], name);
        good = other && alike(first, other);
      }
      if (!good)
        this->lose({association, name}, "it is not in all pieces, or not of the same type");
      for (int i = 0; i < this->NumberOfPieces; ++i) {
        const vtkSmartPointer<vtkXMLDataElement> array = find(groups[i], name);
        if (!array)
          continue;
        groups[i]->RemoveNestedElement(array);
        if (good)
          groups[i]->AddNestedElement(array); // It goes to the end, so that the order is the same in all pieces.
      }
    }
  }

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

  // Adds to each piece the arrays that only others have. VTK takes the arrays of the first piece for those of all: it
  // passes over others, and puts the values of one array into another one that it expects in its place.
  void SetupOutputInformation(vtkInformation *information) override {
    Checked::SetupOutputInformation(information);
    for (int i = 0; i < this->NumberOfPieces; ++i) { // Arrays that are there already stay as they are.
      add_all(this->PointDataElements[i], this->PointDataArraySelection);
      add_all(this->CellDataElements[i], this->CellDataArraySelection);
    }
  }
  void SetupOutputData() override { // Pieces are read one by one.
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
      if (name)
        selection->AddArray(name);
    }
  }

  Numbers numbers(vtkXMLDataElement *element, int64_t count) {
    const auto values = vtkSmartPointer<vtkAbstractArray>::Take(this->CreateArray(element));
    vtkDataArray *array = vtkDataArray::SafeDownCast(values);
    if (!array || array->GetNumberOfComponents() != 1)
      return nullptr;
    array->SetNumberOfTuples(count);
    if (!this->ReadArrayValues(element, 0, array, 0, count, CELL_DATA))
      return nullptr;
    const auto result = Numbers::New();
    result->DeepCopy(array);
    return result;
  }

  // Checks the faces of polyhedra, because VTK goes through them, and writes to them, without looking where they end.
  bool faces_fit() {
    vtkXMLDataElement *cells = this->CellElements[this->Piece];
    const int64_t count = this->NumberOfCells[this->Piece];
    vtkXMLDataElement *of_faces = this->FindDataArrayWithName(cells, "faces");
    vtkXMLDataElement *of_ends = this->FindDataArrayWithName(cells, "faceoffsets");
    if (!of_faces || !of_ends || count == 0)
      return true; // VTK notices itself what is missing.
    const Numbers ends = numbers(of_ends, count);
    int64_t size = 0; // VTK takes the last end for the size.
    for (int64_t i = 0; ends && i < count; ++i)
      size = ends->GetValue(i) > -1 ? ends->GetValue(i) : size;
    const Numbers faces = ends ? numbers(of_faces, size) : nullptr;
    int64_t at = 0;
    for (int64_t i = 0; faces && i < count; ++i) {
      if (ends->GetValue(i) < 0)
        continue;
      const int64_t cell_faces = at < size ? faces->GetValue(at++) : -1;
      if (cell_faces < 0)
        at = -1;
      for (int64_t face = 0; at >= 0 && face < cell_faces; ++face) {
        const int64_t corners = at < size ? faces->GetValue(at++) : -1;
        at = corners < 0 || corners > size - at ? -1 : at + corners;
      }
      if (at < 0)
        break;
    }
    if (faces && at == size)
      return true;
    vtkErrorMacro("the faces of the polyhedra in piece " << this->Piece << " don't match their offsets");
    return false;
  }
};

// Returns what the reader makes of the file. For `unread` see set_request().
template <typename Reader>
auto read(const char *path, const char *only = nullptr, std::vector<tcv::UnreadArray> *unread = nullptr) {
  vtkNew<Reader> reader;
  reader->SetFileName(path);
  reader->set_request(only, unread);
  reader->Update();
  reader->mend(reader->GetOutput());
  return vtkSmartPointer<std::remove_pointer_t<decltype(reader->GetOutput())>>(reader->GetOutput());
}

template <typename Reader> void read_structured(const tcv::Reading &reading, tcv::Contents *contents) {
  const char *path = reading.path.c_str();
  const auto grid = tcv::captured(
      reading.context, path, [&] { return read<Structured<Reader>>(path, reading.desc->only, &contents->unread); });
  const int64_t arrays = grid->GetPointData()->GetNumberOfArrays() + grid->GetCellData()->GetNumberOfArrays();
  // The file holds nothing of these points but their number.
  if (arrays == 0 && grid->GetNumberOfPoints() > MOST_POINTS_ALONE) {
    tcv::fail(TETCAST_ERROR_DATA, "%s: claims %lld points, and has no data for them", path,
              static_cast<long long>(grid->GetNumberOfPoints()));
  }
  tcv::add_grid(reading, reading.block, grid, contents);
}

} // namespace

namespace tcv {

void read_vtu(const Reading &reading, Contents *contents) {
  const auto pieces = captured(reading.context, reading.path.c_str(), [&] {
    std::vector<Grid> grids;
    vtkNew<GridReader> reader;
    reader->SetFileName(reading.path.c_str());
    reader->set_request(reading.desc->only, &contents->unread);
    reader->UpdateInformation();
    const int count = std::max(reader->pieces(), 1);
    for (int i = 0; i < count; ++i) {
      if (!reader->UpdatePiece(i, count, 0))
        break; // The reason has been reported already.
      reader->mend(reader->GetOutput());
      grids.push_back(Grid::New());
      grids.back()->ShallowCopy(reader->GetOutput());
    }
    return grids;
  });
  for (const Grid &grid : pieces)
    add_grid(reading, reading.block, grid, contents);
}

void read_vti(const Reading &reading, Contents *contents) {
  read_structured<vtkXMLImageDataReader>(reading, contents);
}
void read_vtr(const Reading &reading, Contents *contents) {
  read_structured<vtkXMLRectilinearGridReader>(reading, contents);
}
void read_vts(const Reading &reading, Contents *contents) {
  read_structured<vtkXMLStructuredGridReader>(reading, contents);
}

// Reads a surface without its arrays.
vtkSmartPointer<vtkPolyData> read_vtp(const char *path) {
  return read<Checked<vtkXMLPolyDataReader>>(path, "");
}

} // namespace tcv
