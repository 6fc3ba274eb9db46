// SPDX-License-Identifier: Apache-2.0
// Reads meshes by TetGen: points in .node and tetrahedra in .ele, numbered from 0 or 1. Attributes and markers become
// arrays.
#include <algorithm>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>

#include "common.hpp"
#include "formats.hpp"
#include "surface.hpp"

namespace {

using Arrays = std::vector<vtkSmartPointer<vtkDoubleArray>>;

struct Header {
  int64_t count, width, attributes, markers;
};

Header read_header(tcv::Scanner *scanner, int64_t limit) {
  Header header = {0, 0, 0, 0};
  if (!scanner->next_line())
    scanner->truncated("lines", 0, 1);
  int64_t *const fields[] = {&header.count, &header.width, &header.attributes, &header.markers};
  for (int i = 0; i < 4; ++i) {
    if (i < 2)
      *fields[i] = scanner->integer("a count");
    else if (!scanner->at_end())
      *fields[i] = scanner->integer("a count");
    if (*fields[i] < 0 || *fields[i] > limit) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: line %d: claims a count of %lld, which the file can't hold", scanner->path(),
                scanner->line(), static_cast<long long>(*fields[i]));
    }
  }
  return header;
}

// Reads the number at the start of the next line, and fails unless it is the next in order.
void begin_row(tcv::Scanner *scanner, int64_t i, int64_t count, const char *what, int64_t *base) {
  if (!scanner->next_line())
    scanner->truncated(what, i, count);
  const int64_t number = scanner->integer("a number");
  if (i == 0)
    *base = number;
  if ((*base == 0 || *base == 1) && number == *base + i)
    return;
  tcv::fail(TETCAST_ERROR_DATA, "%s: line %d: number %lld where %lld is to come", scanner->path(), scanner->line(),
            static_cast<long long>(number), static_cast<long long>(i == 0 ? 0 : *base + i));
}

Arrays make_arrays(const Header &header, const std::string &name, const char *marker) {
  Arrays arrays;
  for (int64_t i = 0; i < header.attributes + (header.markers > 0); ++i) {
    arrays.push_back(vtkSmartPointer<vtkDoubleArray>::New());
    arrays.back()->SetName(i < header.attributes ? (name + std::to_string(i)).c_str() : marker);
    arrays.back()->SetNumberOfTuples(header.count);
  }
  return arrays;
}

// Notes an array that has something in it which is no number. It is left out in the end.
void read_values(tcv::Scanner *scanner, int64_t i, TetcastAssociation association, const Arrays &arrays,
                 std::vector<tcv::UnreadArray> *unread) {
  for (const auto &array : arrays) {
    const std::string word = scanner->word();
    double value;
    if (tcv::parse_number(word.data(), word.data() + word.size(), &value)) {
      array->SetValue(i, value);
      continue;
    }
    tcv::note_unread(unread, {association, array->GetName()},
                     "line " + std::to_string(scanner->line()) + ": a value expected, not '" + word.substr(0, 40) +
                         "'");
  }
}

// Adds the arrays that are asked for and could be read.
void add_arrays(const Arrays &arrays, TetcastAssociation association, const char *only, vtkDataSetAttributes *target,
                std::vector<tcv::UnreadArray> *unread) {
  for (const auto &array : arrays) {
    const tcv::ArrayName name = {association, array->GetName()};
    const bool bad =
        std::any_of(unread->begin(), unread->end(), [&](const tcv::UnreadArray &one) { return one.array == name; });
    if (bad)
      continue;
    if (tcv::may_name(only, name.name))
      target->AddArray(array);
    else
      tcv::note_unread(unread, name, "");
  }
}

int64_t read_nodes(const std::string &path, const char *only, vtkUnstructuredGrid *grid,
                   std::vector<tcv::UnreadArray> *unread) {
  const std::string text = tcv::file_contents(path.c_str());
  tcv::Scanner scanner(path.c_str(), text);
  const auto size = static_cast<int64_t>(text.size());
  const Header header = read_header(&scanner, size);
  if (header.width != 3)
    tcv::fail(TETCAST_ERROR_DATA, "%s: holds points of %lld dimensions, not 3", path.c_str(),
              static_cast<long long>(header.width));
  if (header.attributes > 0 && header.count > size / header.attributes)
    scanner.truncated("points", 0, header.count);
  vtkNew<vtkDoubleArray> positions;
  positions->SetNumberOfComponents(3);
  positions->SetNumberOfTuples(header.count);
  const Arrays arrays = make_arrays(header, "attribute_", "marker");
  int64_t base = 0;
  for (int64_t i = 0; i < header.count; ++i) {
    begin_row(&scanner, i, header.count, "points", &base);
    for (int k = 0; k < 3; ++k)
      positions->SetValue(3 * i + k, scanner.number("a coordinate"));
    read_values(&scanner, i, TETCAST_POINT, arrays, unread);
  }
  vtkNew<vtkPoints> points;
  points->SetData(positions);
  grid->SetPoints(points);
  add_arrays(arrays, TETCAST_POINT, only, grid->GetPointData(), unread);
  return base;
}

void read_elements(const std::string &path, int64_t base, const char *only, vtkUnstructuredGrid *grid,
                   std::vector<tcv::UnreadArray> *unread) {
  const std::string text = tcv::file_contents(path.c_str());
  tcv::Scanner scanner(path.c_str(), text);
  const auto size = static_cast<int64_t>(text.size());
  const Header header = read_header(&scanner, size);
  if (header.width != 4) {
    tcv::fail(TETCAST_ERROR_UNSUPPORTED, "%s: holds elements of %lld points; only tetrahedra of 4 are read",
              path.c_str(), static_cast<long long>(header.width));
  }
  if (header.attributes > 0 && header.count > size / header.attributes)
    scanner.truncated("tetrahedra", 0, header.count);
  vtkNew<vtkIdTypeArray> indices, ends;
  indices->SetNumberOfValues(4 * header.count);
  ends->SetNumberOfValues(header.count + 1);
  ends->SetValue(0, 0);
  Header plain = header;
  plain.markers = 0;
  const Arrays arrays = make_arrays(plain, "region_", "");
  int64_t first = 0;
  for (int64_t i = 0; i < header.count; ++i) {
    begin_row(&scanner, i, header.count, "tetrahedra", &first);
    for (int k = 0; k < 4; ++k)
      indices->SetValue(4 * i + k, scanner.integer("the number of a point") - base);
    read_values(&scanner, i, TETCAST_CELL, arrays, unread);
    ends->SetValue(i + 1, 4 * (i + 1));
  }
  vtkNew<vtkCellArray> cells;
  cells->SetData(ends, indices);
  vtkNew<vtkUnsignedCharArray> types;
  types->SetNumberOfValues(header.count);
  types->FillValue(VTK_TETRA);
  grid->SetCells(types, cells);
  add_arrays(arrays, TETCAST_CELL, only, grid->GetCellData(), unread);
}

} // namespace

namespace tcv {

void read_tetgen(const Reading &reading, Contents *contents) {
  const std::string stem = reading.path.substr(0, reading.path.rfind('.'));
  auto grid = Grid::New();
  const int64_t base = read_nodes(stem + ".node", reading.desc->only, grid, &contents->unread);
  read_elements(stem + ".ele", base, reading.desc->only, grid, &contents->unread);
  add_grid(reading, reading.block, grid, contents);
}

} // namespace tcv
