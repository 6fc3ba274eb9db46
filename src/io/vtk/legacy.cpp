// SPDX-License-Identifier: Apache-2.0
// Legacy .vtk files. VTK's own loops over their sections write beyond their memory when counts or cells are damaged; its
// functions for the single parts are sound and do the work here.
#include "common.hpp"
#include "files.hpp"

#include <cstring>

#include <vtkByteSwap.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDataReader.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>

namespace {

using CellArray = vtkSmartPointer<vtkCellArray>;

class LegacyFile {
public:
  LegacyFile(const char *path, const char *type) : path_(path), size_(tcv::file_size(path)) {
    reader_->ReadAllScalarsOn(); // else the first of each kind only
    reader_->ReadAllVectorsOn();
    reader_->ReadAllNormalsOn();
    reader_->ReadAllTensorsOn();
    reader_->ReadAllColorScalarsOn();
    reader_->ReadAllTCoordsOn();
    reader_->ReadAllFieldsOn();
    if (!reader_->OpenVTKFile(path) || !reader_->ReadHeader(path) || !next() || !is("dataset") || !next() || !is(type)) {
      damaged("the header");
    }
  }
  ~LegacyFile() { reader_->CloseVTKFile(); }
  LegacyFile(const LegacyFile &) = delete;
  LegacyFile &operator=(const LegacyFile &) = delete;

  bool next() { return reader_->ReadString(word_) != 0; } // to the next keyword
  bool is(const char *keyword) { return std::strcmp(reader_->LowerCase(word_), keyword) == 0; }

  // The sections that every dataset may have. False for others.
  bool common_section(vtkPointSet *dataset) {
    if (is("field")) {
      const auto field = vtkSmartPointer<vtkFieldData>::Take(reader_->ReadFieldData());
      if (!field) damaged("the field");
    } else if (is("metadata")) {
      char line[256];
      while (reader_->ReadLine(line) && line[0] != '\0') {}
    } else if (is("points")) {
      if (!reader_->ReadPointCoordinates(dataset, count("POINTS"))) damaged("POINTS");
    } else {
      return false;
    }
    return true;
  }

  CellArray cells(const char *section) {
    auto result = CellArray::New();
    if (reader_->GetFileMajorVersion() >= 5) {
      if (!reader_->ReadCells(result)) damaged(section);
      return result ? result : CellArray::New();
    }
    const int64_t cells = count(section), size = count(section);
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
        tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: there is no cell type %d", path_, static_cast<long long>(i), type);
      }
      result->SetValue(i, static_cast<unsigned char>(type));
    }
    return result;
  }

  // POINT_DATA or CELL_DATA and what follows: the last thing in a file.
  void attributes(vtkDataSet *dataset) {
    const bool points = is("point_data");
    if (!points && !is("cell_data")) damaged("the keyword", word_);
    const int64_t have = points ? dataset->GetNumberOfPoints() : dataset->GetNumberOfCells();
    const int64_t values = count(points ? "POINT_DATA" : "CELL_DATA");
    if (values != have) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: %s for %lld %s, but there are %lld", path_, points ? "POINT_DATA" : "CELL_DATA",
                static_cast<long long>(values), points ? "points" : "cells", static_cast<long long>(have));
    }
    const int done = points ? reader_->ReadPointData(dataset, have) : reader_->ReadCellData(dataset, have);
    if (!done) damaged(points ? "POINT_DATA" : "CELL_DATA");
  }

  [[noreturn]] void damaged(const char *section, const char *word = "") const {
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s%s%s can't be read", path_, section, *word ? " " : "", word);
  }

private:
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
  vtkNew<vtkDataReader> reader_;
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
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: the list of the polyhedron's faces is damaged", path, static_cast<long long>(i));
    }
  }
}

// Offsets within the list; indices are checked by whoever uses them.
void check_offsets(const char *path, vtkCellArray *cells) { tcv::check_cells(path, cells, INT64_MAX, "cell"); }

} // namespace

namespace tcv {

vtkSmartPointer<vtkUnstructuredGrid> read_legacy_grid(const char *path) {
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
        fail(TETCAST_ERROR_DATA, "%s: CELL_TYPES of %lld cells, but CELLS has %lld", path,
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
  if (cells && !types) fail(TETCAST_ERROR_DATA, "%s: truncated: there are CELLS, but no CELL_TYPES", path);
  return grid;
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
