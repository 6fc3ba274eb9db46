// SPDX-License-Identifier: Apache-2.0
// Legacy .vtk files. VTK's own loops over their sections write beyond their memory when counts or cells are damaged;
// its functions for single words and arrays are sound once the counts are, and do the work here.
#include "common.hpp"
#include "files.hpp"
#include "formats.hpp"

#include <cstdio>
#include <cstring>

#include <vtkByteSwap.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataReader.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>

namespace {

using CellArray = vtkSmartPointer<vtkCellArray>;

class Reader : public vtkDataReader {
public:
  static Reader *New() { VTK_STANDARD_NEW_BODY(Reader); }
  using vtkDataReader::DecodeString;
};

class LegacyFile {
public:
  explicit LegacyFile(const char *path) : path_(path), size_(tcv::file_size(path)) {
    if (!reader_->OpenVTKFile(path) || !reader_->ReadHeader(path) || !next() || !is("dataset") || !next()) damaged("the header");
  }
  LegacyFile(const char *path, const char *type) : LegacyFile(path) {
    if (!is(type)) damaged("the header");
  }
  ~LegacyFile() { reader_->CloseVTKFile(); }
  LegacyFile(const LegacyFile &) = delete;
  LegacyFile &operator=(const LegacyFile &) = delete;

  bool next() { return reader_->ReadString(word_) != 0; } // to the next keyword
  bool is(const char *keyword) { return std::strcmp(reader_->LowerCase(word_), keyword) == 0; }

  // The sections that every dataset may have. False for others.
  bool common_section(vtkPointSet *dataset) {
    if (is("field")) {
      read_field(nullptr);
    } else if (is("metadata")) {
      skip_metadata();
    } else if (is("points") && dataset) {
      const int64_t points = count("POINTS");
      if (!reader_->ReadPointCoordinates(dataset, points)) damaged("POINTS");
    } else {
      return false;
    }
    return true;
  }

  CellArray cells(const char *section) {
    auto result = CellArray::New();
    const int64_t cells = count(section), size = count(section);
    if (reader_->GetFileMajorVersion() >= 5) {
      const auto offsets = part("offsets", cells), indices = part("connectivity", size);
      if (cells > 0 && !result->SetData(offsets, indices)) damaged(section);
      return result;
    }
    std::vector<int> stream(static_cast<size_t>(size));
    if (!reader_->ReadCellsLegacy(size, stream.data())) damaged(section);
    vtkNew<vtkIdTypeArray> offsets, indices;
    offsets->SetNumberOfValues(cells + 1);
    offsets->SetValue(0, 0);
    indices->SetNumberOfValues(size < cells ? 0 : size - cells);
    int64_t at = 0, used = 0;
    for (int64_t i = 0; i < cells; ++i) {
      const int64_t corners = at < size ? stream[static_cast<size_t>(at++)] : -1;
      if (corners < 0 || corners > size - at || used + corners > indices->GetNumberOfValues()) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: %s: cell %lld does not fit into the %lld numbers there are", path_, section,
                  static_cast<long long>(i), static_cast<long long>(size));
      }
      for (int64_t j = 0; j < corners; ++j) indices->SetValue(used++, stream[static_cast<size_t>(at++)]);
      offsets->SetValue(i + 1, used);
    }
    result->SetData(offsets, indices);
    return result;
  }

  vtkSmartPointer<vtkUnsignedCharArray> cell_types() {
    const int64_t size = count("CELL_TYPES");
    std::vector<int> types(static_cast<size_t>(size));
    if (reader_->GetFileType() == VTK_BINARY) {
      char line[256];
      reader_->GetIStream()->getline(line, sizeof line); // what is left of the keyword's line
      reader_->GetIStream()->read(reinterpret_cast<char *>(types.data()), static_cast<std::streamsize>(size * 4));
      if (!*reader_->GetIStream()) damaged("CELL_TYPES");
      vtkByteSwap::Swap4BERange(types.data(), types.size());
    } else {
      for (int &type : types) {
        if (!reader_->Read(&type)) damaged("CELL_TYPES");
      }
    }
    auto result = vtkSmartPointer<vtkUnsignedCharArray>::New();
    result->SetNumberOfValues(size);
    for (int64_t i = 0; i < size; ++i) {
      const int type = types[static_cast<size_t>(i)];
      if (type < 0 || type > 255) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: there is no cell type %d", path_, static_cast<long long>(i),
                  type);
      }
      result->SetValue(i, static_cast<unsigned char>(type));
    }
    return result;
  }

  // Of structured grids: DIMENSIONS, and what is evenly spaced.
  void dimensions(int result[3]) {
    int64_t points = 1;
    for (int k = 0; k < 3; ++k) {
      const int64_t value = count("DIMENSIONS");
      points = value <= 0 || points > 4096 * size_ / value ? 0 : points * value;
      result[k] = static_cast<int>(value);
      if (points == 0 || value > INT32_MAX) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: DIMENSIONS claim more points than the file can hold, or none", path_);
      }
    }
  }
  void numbers(const char *section, double result[3]) {
    for (int k = 0; k < 3; ++k) {
      if (!reader_->Read(result + k)) damaged(section);
    }
  }
  vtkSmartPointer<vtkDataArray> coordinates(const char *section, int64_t wanted) {
    const int64_t values_here = count(section);
    if (values_here != wanted) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: %s are %lld, not %lld", path_, section, static_cast<long long>(values_here),
                static_cast<long long>(wanted));
    }
    const AbstractArray array = values(word(section), wanted, 1);
    vtkSmartPointer<vtkDataArray> result = vtkDataArray::SafeDownCast(array);
    if (!result) damaged(section);
    return result;
  }

  // From the keyword POINT_DATA or CELL_DATA to the end of the file.
  void attributes(vtkDataSet *dataset) {
    vtkDataSetAttributes *target = nullptr;
    int64_t have = 0;
    do {
      const bool points = is("point_data");
      if (points || is("cell_data")) {
        const char *section = points ? "POINT_DATA" : "CELL_DATA";
        target = dataset->GetPointData();
        if (!points) target = dataset->GetCellData();
        have = points ? dataset->GetNumberOfPoints() : dataset->GetNumberOfCells();
        const int64_t values = count(section);
        if (values != have) {
          tcv::fail(TETCAST_ERROR_DATA, "%s: %s for %lld %s, but there are %lld", path_, section,
                    static_cast<long long>(values), points ? "points" : "cells", static_cast<long long>(have));
        }
      } else if (!target) {
        damaged("the keyword", word_);
      } else {
        attribute(target, have);
      }
    } while (next());
  }

  [[noreturn]] void damaged(const char *section, const char *word = "") const {
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s%s%s can't be read", path_, section, *word ? " " : "",
              word);
  }

private:
  using AbstractArray = vtkSmartPointer<vtkAbstractArray>;

  void attribute(vtkDataSetAttributes *target, int64_t have) {
    static const struct {
      const char *keyword;
      int components, attribute;
    } plain[] = {
        {"vectors", 3, vtkDataSetAttributes::VECTORS},      {"normals", 3, vtkDataSetAttributes::NORMALS},
        {"tensors", 9, vtkDataSetAttributes::TENSORS},      {"tensors6", 6, vtkDataSetAttributes::TENSORS},
        {"global_ids", 1, vtkDataSetAttributes::GLOBALIDS}, {"pedigree_ids", 1, vtkDataSetAttributes::PEDIGREEIDS},
        {"edge_flags", 1, vtkDataSetAttributes::EDGEFLAG}};
    if (is("scalars")) return read_scalars(target, have);
    if (is("field")) return read_field(target);
    if (is("metadata")) return skip_metadata();
    if (is("lookup_table")) return skip_lookup_table();
    if (is("color_scalars")) {
      const std::string name = word("COLOR_SCALARS");
      const int64_t components = count("COLOR_SCALARS");
      add(target, name, values(reader_->GetFileType() == VTK_BINARY ? "unsigned_char" : "float", have, components), -1);
      return;
    }
    if (is("texture_coordinates")) {
      const std::string name = word("TEXTURE_COORDINATES");
      const int64_t components = count("TEXTURE_COORDINATES");
      add(target, name, values(word("TEXTURE_COORDINATES"), have, components), -1);
      return;
    }
    for (const auto &entry : plain) {
      if (!is(entry.keyword)) continue;
      const std::string name = word(entry.keyword);
      add(target, name, values(word(entry.keyword), have, entry.components), entry.attribute);
      return;
    }
    damaged("the keyword", word_);
  }

  // SCALARS name type [components], then perhaps LOOKUP_TABLE name. (VTK demands the latter.)
  void read_scalars(vtkDataSetAttributes *target, int64_t have) {
    char line[256], name[256] = "", type[256] = "";
    int components = 1;
    if (!reader_->ReadLine(line) || std::sscanf(line, "%255s %255s %d", name, type, &components) < 2)
      damaged("SCALARS");
    if (word("SCALARS") != "LOOKUP_TABLE" && !is("lookup_table")) damaged("SCALARS", name);
    word("LOOKUP_TABLE");
    add(target, name, values(type, have, components), vtkDataSetAttributes::SCALARS);
  }

  // FIELD name count, then for each array its name, components, tuples and type. No target: only passes.
  void read_field(vtkDataSetAttributes *target) {
    word("FIELD");
    const int64_t arrays = count("FIELD");
    for (int64_t i = 0; i < arrays; ++i) {
      std::string name = word("FIELD");
      while (is("metadata")) { // of the array before
        skip_metadata();
        name = word("FIELD");
      }
      if (name == "NULL_ARRAY") continue;
      const int64_t components = count("FIELD"), tuples = count("FIELD");
      const AbstractArray array = values(word("FIELD"), tuples, components);
      if (target) add(target, name, array, -1);
    }
  }

  void skip_lookup_table() {
    word("LOOKUP_TABLE");
    values(reader_->GetFileType() == VTK_BINARY ? "unsigned_char" : "float", count("LOOKUP_TABLE"), 4);
  }

  void skip_metadata() { // ends with an empty line
    char line[256];
    reader_->ReadLine(line);
    while (reader_->ReadLine(line) && line[0] != '\0') {}
  }

  vtkSmartPointer<vtkDataArray> part(const char *keyword, int64_t size) {
    if (!next() || !is(keyword)) damaged("the list of cells");
    const AbstractArray array = values(word(keyword), size, 1);
    vtkSmartPointer<vtkDataArray> numbers = vtkDataArray::SafeDownCast(array);
    if (!numbers) damaged("the list of cells");
    const int type = numbers->GetDataType();
    if (type != VTK_INT && type != VTK_LONG && type != VTK_LONG_LONG && type != VTK_ID_TYPE)
      damaged("the list of cells");
    return numbers;
  }

  AbstractArray values(const std::string &type, int64_t tuples, int64_t components) {
    if (components < 1 || components > 8 * size_ || tuples > 8 * size_ / components) { // bits: eight a byte
      tcv::fail(TETCAST_ERROR_DATA, "%s: an array of %lld × %lld values is more than the file can hold", path_,
                static_cast<long long>(tuples), static_cast<long long>(components));
    }
    const auto array = AbstractArray::Take(reader_->ReadArray(type.c_str(), tuples, components));
    if (!array || array->GetNumberOfTuples() != tuples) damaged("an array of type", type.c_str());
    return array;
  }

  void add(vtkDataSetAttributes *target, const std::string &name, vtkAbstractArray *array, int attribute) {
    std::vector<char> decoded(name.size() + 1); // %20 and the like
    reader_->DecodeString(decoded.data(), name.c_str());
    array->SetName(decoded.data());
    const int index = target->AddArray(array);
    if (attribute >= 0 && !target->GetAbstractAttribute(attribute)) target->SetActiveAttribute(index, attribute);
  }

  std::string word(const char *section) {
    if (!next()) damaged(section);
    return word_;
  }

  int64_t count(const char *section) {
    vtkIdType value = -1;
    if (!reader_->Read(&value)) damaged(section);
    if (value < 0 || value > size_) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: %s claims a count of %lld, which the file can't hold", path_, section,
                static_cast<long long>(value));
    }
    return value;
  }

  const char *path_;
  int64_t size_;
  vtkNew<Reader> reader_;
  char word_[256] = "";
};

// Polyhedra are written as a stream: number of faces, then for each face its number of points and the points.
void check_face_streams(const char *path, vtkUnsignedCharArray *types, vtkCellArray *cells, int64_t point_count) {
  for (int64_t i = 0; i < cells->GetNumberOfCells(); ++i) {
    if (types->GetValue(i) != VTK_POLYHEDRON) continue;
    vtkIdType size;
    const vtkIdType *stream;
    cells->GetCellAtId(i, size, stream);
    int64_t at = 1;
    bool good = size > 0 && stream[0] >= 4;
    for (int64_t face = 0; good && face < stream[0]; ++face) {
      const int64_t corners = at < size ? stream[at++] : -1;
      good = corners >= 3 && corners <= size - at;
      for (int64_t j = 0; good && j < corners; ++j, ++at) good = stream[at] >= 0 && stream[at] < point_count;
    }
    if (!good || at != size) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: the list of the polyhedron's faces is damaged", path,
                static_cast<long long>(i));
    }
  }
}

// Offsets within the list; indices are checked by whoever uses them.
void check_offsets(const char *path, vtkCellArray *cells) { tcv::check_cells(path, cells, INT64_MAX, "cell"); }

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const char *path) {
  LegacyFile file(path, "unstructured_grid");
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  CellArray cells;
  vtkSmartPointer<vtkUnsignedCharArray> types;
  while (file.next()) {
    if (file.common_section(grid)) continue;
    if (file.is("cells")) {
      cells = file.cells("CELLS");
    } else if (file.is("cell_types")) {
      types = file.cell_types();
      if (!cells || cells->GetNumberOfCells() != types->GetNumberOfValues()) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: CELL_TYPES of %lld cells, but CELLS has %lld", path,
                  static_cast<long long>(types->GetNumberOfValues()),
                  static_cast<long long>(cells ? cells->GetNumberOfCells() : 0));
      }
      // Only now the grid knows its cells: polyhedra hide other numbers in their list of points.
      check_offsets(path, cells);
      check_face_streams(path, types, cells, grid->GetNumberOfPoints());
      grid->SetCells(types, cells);
    } else {
      file.attributes(grid);
      break;
    }
  }
  if (cells && !types) tcv::fail(TETCAST_ERROR_DATA, "%s: truncated: there are CELLS, but no CELL_TYPES", path);
  return grid;
}

vtkSmartPointer<vtkDataSet> read_image(LegacyFile *file) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  while (file->next()) {
    double numbers[3];
    int dimensions[3];
    if (file->common_section(nullptr)) continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      image->SetDimensions(dimensions);
    } else if (file->is("origin")) {
      file->numbers("ORIGIN", numbers);
      image->SetOrigin(numbers);
    } else if (file->is("spacing") || file->is("aspect_ratio")) {
      file->numbers("SPACING", numbers);
      image->SetSpacing(numbers);
    } else {
      file->attributes(image);
      break;
    }
  }
  return image;
}

vtkSmartPointer<vtkDataSet> read_rectilinear(LegacyFile *file) {
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  int dimensions[3] = {0, 0, 0};
  while (file->next()) {
    if (file->common_section(nullptr)) continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      grid->SetDimensions(dimensions);
    } else if (file->is("x_coordinates")) {
      grid->SetXCoordinates(file->coordinates("X_COORDINATES", dimensions[0]));
    } else if (file->is("y_coordinates")) {
      grid->SetYCoordinates(file->coordinates("Y_COORDINATES", dimensions[1]));
    } else if (file->is("z_coordinates")) {
      grid->SetZCoordinates(file->coordinates("Z_COORDINATES", dimensions[2]));
    } else {
      file->attributes(grid);
      break;
    }
  }
  vtkDataArray *const axes[3] = {grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates()};
  for (int k = 0; k < 3; ++k) { // VTK has one of a single value where there is none
    if (axes[k]->GetNumberOfTuples() != dimensions[k]) file->damaged("the list of coordinates");
  }
  return grid;
}

vtkSmartPointer<vtkDataSet> read_structured(LegacyFile *file) {
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  int dimensions[3];
  while (file->next()) {
    if (file->common_section(grid)) continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      grid->SetDimensions(dimensions);
    } else {
      file->attributes(grid);
      break;
    }
  }
  return grid;
}

} // namespace

namespace tcv {

void read_legacy_grid(const Reading &reading, Contents *contents) {
  const auto grid = captured(reading.context, reading.path.c_str(), [&] { return read_grid(reading.path.c_str()); });
  add_grid(reading, reading.block, grid, contents);
}

void read_legacy_structured(const Reading &reading, Contents *contents) {
  const auto grid = captured(reading.context, reading.path.c_str(), [&] {
    LegacyFile file(reading.path.c_str());
    if (file.is("rectilinear_grid")) return read_rectilinear(&file);
    return file.is("structured_grid") ? read_structured(&file) : read_image(&file);
  });
  add_grid(reading, reading.block, grid, contents);
}

vtkSmartPointer<vtkPolyData> read_legacy_surface(const char *path) {
  LegacyFile file(path, "polydata");
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  while (file.next()) {
    if (file.common_section(surface)) continue;
    if (file.is("polygons")) surface->SetPolys(file.cells("POLYGONS"));
    else if (file.is("triangle_strips")) surface->SetStrips(file.cells("TRIANGLE_STRIPS"));
    else if (file.is("vertices") || file.is("lines")) file.cells("VERTICES or LINES");
    else if (file.is("cell_data") || file.is("point_data")) break; // a surface is its shape here
    else file.damaged("a section");
  }
  return surface;
}

} // namespace tcv
