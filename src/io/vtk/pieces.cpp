// SPDX-License-Identifier: Apache-2.0
// Makes one grid of several. Ghosts are left out, and points of different pieces that coincide become one.
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkGenericCell.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include "attributes.hpp"
#include "cells.hpp"
#include "common.hpp"
#include "contents.hpp"
#include "points.hpp"

namespace {

using tcv::PieceMap;

// Returns the marks of points or cells that are ghosts, or nothing if there are none. Older files say instead at which
// level a cell is a ghost.
std::vector<unsigned char> ghost_marks(vtkDataSetAttributes *attributes, int64_t count) {
  std::vector<unsigned char> marks;
  for (const char *name : {"vtkGhostType", "vtkGhostLevels"}) {
    vtkDataArray *array = attributes->GetArray(name);
    if (!array || array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != count)
      continue;
    const bool levels = std::strcmp(name, "vtkGhostLevels") == 0;
    bool any = false;
    std::vector<unsigned char> found(static_cast<size_t>(count));
    for (int64_t i = 0; i < count; ++i) {
      const double value = array->GetComponent(i, 0);
      const int mark = value > 0 && value < 256 ? static_cast<int>(value) : 0;
      found[static_cast<size_t>(i)] =
          static_cast<unsigned char>(levels && mark ? vtkDataSetAttributes::DUPLICATECELL : mark);
      any = any || mark;
    }
    if (any)
      return found;
  }
  return marks;
}

template <typename Use> void each_cell(vtkUnstructuredGrid *grid, Use &&use) {
  const int64_t cells = grid->GetNumberOfCells();
  for (int64_t i = 0; i < cells; ++i) {
    vtkIdType size;
    const vtkIdType *points;
    grid->GetCells()->GetCellAtId(i, size, points);
    use(static_cast<size_t>(i), size, points);
  }
}

// Marks the cells and points that are to be left out.
void find_ghosts(vtkUnstructuredGrid *grid, PieceMap *map) {
  const int hidden =
      vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::REFINEDCELL | vtkDataSetAttributes::HIDDENCELL;
  const auto cells = ghost_marks(grid->GetCellData(), grid->GetNumberOfCells());
  map->point_marks = ghost_marks(grid->GetPointData(), grid->GetNumberOfPoints());
  const auto &points = map->point_marks;
  const auto blanked = [&](vtkIdType i) { return points[static_cast<size_t>(i)] & vtkDataSetAttributes::HIDDENPOINT; };
  if (cells.empty() && points.empty())
    return;

  enum : unsigned char { UNUSED, OF_GHOSTS, OF_CELLS };
  std::vector<unsigned char> used(static_cast<size_t>(grid->GetNumberOfPoints()), UNUSED);
  map->dropped_cells.assign(static_cast<size_t>(grid->GetNumberOfCells()), 0);
  each_cell(grid, [&](size_t i, vtkIdType size, const vtkIdType *corners) {
    bool ghost = !cells.empty() && cells[i] & hidden;
    if (!points.empty())
      ghost = ghost || std::any_of(corners, corners + size, blanked);
    map->dropped_cells[i] = ghost;
    map->ghost_cells += ghost;
    for (vtkIdType j = 0; j < size; ++j) {
      auto &use = used[static_cast<size_t>(corners[j])];
      use = std::max(use, static_cast<unsigned char>(ghost ? OF_GHOSTS : OF_CELLS));
    }
  });
  if (map->ghost_cells == 0) {
    map->dropped_cells.clear();
    return;
  }
  map->dropped_points.resize(used.size());
  for (size_t i = 0; i < used.size(); ++i) {
    map->dropped_points[i] = used[i] == OF_GHOSTS;
    map->ghost_points += used[i] == OF_GHOSTS;
  }
}

bool has_volume(vtkUnstructuredGrid *grid) {
  bool present[256] = {};
  vtkUnsignedCharArray *types = grid->GetCellTypesArray();
  for (int64_t i = 0; types && i < types->GetNumberOfValues(); ++i)
    present[types->GetValue(i)] = true;
  for (int type = 0; type < 256; ++type) {
    if (!present[type])
      continue;
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    if (!cell || cell->GetCellDimension() == 3)
      return true; // VTK has no such cell, and it is refused later.
  }
  return false;
}

// Returns whether a grid has cells other than tetrahedra.
bool needs_cuts(vtkUnstructuredGrid *grid) {
  vtkUnsignedCharArray *types = grid->GetCellTypesArray();
  for (int64_t i = 0; types && i < types->GetNumberOfValues(); ++i) {
    if (types->GetValue(i) != VTK_TETRA && tcv::is_volume(types->GetValue(i)))
      return true;
  }
  return false;
}

// ── cells ──

struct Size {
  int64_t cells = 0, corners = 0;
};

template <typename Indices>
vtkSmartPointer<vtkCellArray> connect(const std::vector<tcv::Piece> &pieces, const std::vector<PieceMap> &maps,
                                      Size size) {
  using T = typename Indices::ValueType;
  vtkNew<Indices> indices, ends;
  indices->SetNumberOfValues(size.corners);
  ends->SetNumberOfValues(size.cells + 1);
  T *index = indices->GetPointer(0), *end = ends->GetPointer(0);
  T used = 0;
  *end++ = 0;
  for (size_t p = 0; p < pieces.size(); ++p) {
    each_cell(pieces[p].grid, [&](size_t i, vtkIdType corners, const vtkIdType *points) {
      if (!maps[p].keeps_cell(i))
        return;
      for (vtkIdType j = 0; j < corners; ++j)
        *index++ = static_cast<T>((*maps[p].to)[static_cast<size_t>(points[j])]);
      used = static_cast<T>(used + corners);
      *end++ = used;
    });
  }
  auto result = vtkSmartPointer<vtkCellArray>::New();
  result->SetData(ends, indices);
  return result;
}

[[noreturn]] void bad_faces(const std::string &place, size_t cell) {
  tcv::fail(TETCAST_ERROR_DATA, "%s: cell %zu: the list of the polyhedron's faces is damaged", place.c_str(), cell);
}

// Appends the faces of the polyhedra in the form of VTK: the number of faces, and then for each face its number of
// points and the points.
void add_faces(const tcv::Piece &piece, const PieceMap &map, vtkIdTypeArray *faces, vtkIdTypeArray *starts) {
  vtkIdTypeArray *source = piece.grid->GetFaces(), *at_cell = piece.grid->GetFaceLocations();
  const int64_t end = source ? source->GetNumberOfValues() : 0, points = static_cast<int64_t>(map.to->size());
  const vtkUnsignedCharArray *types = piece.grid->GetCellTypesArray();
  for (int64_t i = 0; i < piece.grid->GetNumberOfCells(); ++i) {
    const auto cell = static_cast<size_t>(i);
    if (!map.keeps_cell(cell))
      continue;
    if (types->GetValue(i) != VTK_POLYHEDRON) {
      starts->InsertNextValue(-1);
      continue;
    }
    int64_t at = at_cell && i < at_cell->GetNumberOfValues() ? at_cell->GetValue(i) : -1;
    const int64_t count = at >= 0 && at < end ? source->GetValue(at++) : -1;
    if (count < 0 || count > end)
      bad_faces(piece.place, cell);
    starts->InsertNextValue(faces->GetNumberOfValues());
    faces->InsertNextValue(count);
    for (int64_t face = 0; face < count; ++face) {
      const int64_t corners = at < end ? source->GetValue(at++) : -1;
      if (corners < 0 || corners > end - at)
        bad_faces(piece.place, cell);
      faces->InsertNextValue(corners);
      for (int64_t j = 0; j < corners; ++j) {
        const int64_t point = source->GetValue(at++);
        if (point < 0 || point >= points || (*map.to)[static_cast<size_t>(point)] < 0)
          bad_faces(piece.place, cell);
        faces->InsertNextValue((*map.to)[static_cast<size_t>(point)]);
      }
    }
  }
}

void set_cells(const std::vector<tcv::Piece> &pieces, const std::vector<PieceMap> &maps, int64_t points,
               vtkUnstructuredGrid *grid) {
  Size size;
  bool polyhedra = false;
  vtkNew<vtkUnsignedCharArray> types;
  for (size_t p = 0; p < pieces.size(); ++p) {
    const vtkUnsignedCharArray *own = pieces[p].grid->GetCellTypesArray();
    each_cell(pieces[p].grid, [&](size_t i, vtkIdType corners, const vtkIdType *) {
      if (!maps[p].keeps_cell(i))
        return;
      const unsigned char type = own->GetValue(static_cast<vtkIdType>(i));
      types->InsertNextValue(type);
      polyhedra = polyhedra || type == VTK_POLYHEDRON;
      size.corners += corners;
      ++size.cells;
    });
  }
  const bool narrow = size.corners < INT32_MAX && points < INT32_MAX;
  const auto cells =
      narrow ? connect<vtkTypeInt32Array>(pieces, maps, size) : connect<vtkIdTypeArray>(pieces, maps, size);
  if (!polyhedra)
    return grid->SetCells(types, cells);
  vtkNew<vtkIdTypeArray> faces, starts;
  for (size_t p = 0; p < pieces.size(); ++p)
    add_faces(pieces[p], maps[p], faces, starts);
  grid->SetCells(types, cells, starts, faces);
}

// ── checks ──

void check_piece(const tcv::Piece &piece) {
  const char *place = piece.place.c_str();
  vtkUnstructuredGrid *grid = piece.grid;
  if (grid->GetNumberOfPoints() == 0)
    tcv::fail(TETCAST_ERROR_DATA, "%s: holds no points", place);
  tcv::check_dimension(place, grid->GetPoints());
  tcv::check_cells(place, grid->GetCells(), grid->GetNumberOfPoints(), "cell");
  const vtkUnsignedCharArray *types = grid->GetCellTypesArray();
  if (!types || types->GetNumberOfValues() != grid->GetNumberOfCells()) {
    tcv::fail(TETCAST_ERROR_DATA, "%s: has %lld cells but types of %lld", place,
              static_cast<long long>(grid->GetNumberOfCells()),
              static_cast<long long>(types ? types->GetNumberOfValues() : 0));
  }
}

void warn_of_differences(const tcv::Reading &reading, const tcv::Differences &differences, int64_t merged) {
  if (differences.points == 0)
    return;
  tetcast_context_message(reading.context, TETCAST_SEVERITY_WARNING,
                          "%s: at %lld of %lld merged points the pieces have different values, first of '%s': those of "
                          "the first piece are taken",
                          reading.path.c_str(), static_cast<long long>(differences.points),
                          static_cast<long long>(merged), differences.array.c_str());
}

} // namespace

namespace tcv {

Grid unite(const Reading &reading, std::vector<Piece> *pieces, TetcastDatasetPieces *counts,
           std::vector<UnreadArray> *unread) {
  const bool lone = pieces->size() == 1;
  for (const Piece &piece : *pieces) { // An empty piece only says that a part of a machine had no work.
    if (piece.grid->GetNumberOfCells() > 0)
      check_piece(piece);
  }
  const auto useless = [&](const Piece &piece) { return !has_volume(piece.grid); };
  const bool part = reading.desc->part;
  if (part || (!lone && !std::all_of(pieces->begin(), pieces->end(), useless))) {
    const auto end = std::remove_if(pieces->begin(), pieces->end(), useless);
    counts->surfaces += std::distance(end, pieces->end());
    pieces->erase(end, pieces->end());
  }
  counts->pieces = static_cast<int64_t>(pieces->size());
  if (pieces->empty())
    return nullptr;
  const bool sorted =
      part && std::any_of(pieces->begin(), pieces->end(), [](const Piece &piece) { return needs_cuts(piece.grid); });

  std::vector<PieceMap> maps(pieces->size());
  for (size_t p = 0; p < maps.size(); ++p) {
    if ((*pieces)[p].grid->GetNumberOfCells() == 0)
      continue;
    find_ghosts((*pieces)[p].grid, &maps[p]);
    counts->ghost_cells += maps[p].ghost_cells;
    counts->ghost_points += maps[p].ghost_points;
    drop_nonfinite((*pieces)[p].grid, &maps[p]);
    counts->nonfinite_cells += maps[p].nonfinite_cells;
    const bool repeats =
        // Blocks of Exodus share their points.
        p > 0 && (*pieces)[p].grid->GetPoints() == (*pieces)[p - 1].grid->GetPoints();
    if (!repeats)
      counts->nonfinite_points += maps[p].nonfinite_points;
  }
  if (maps.size() == 1 && counts->ghost_cells == 0 && counts->nonfinite_points == 0 &&
      reading.desc->merge_tolerance < 0 && !sorted)
    return (*pieces)[0].grid;

  auto grid = Grid::New();
  grid->SetPoints(merge_points(*pieces, reading.desc->merge_tolerance, &maps, &counts->merged_points));
  if (sorted)
    sort_points(grid->GetPoints(), &maps);
  set_cells(*pieces, maps, grid->GetNumberOfPoints(), grid);
  Differences differences;
  join_arrays(reading, *pieces, maps, grid, &differences, unread);
  counts->differing_points = differences.points;
  warn_of_differences(reading, differences, counts->merged_points);
  pieces->clear();
  return grid;
}

} // namespace tcv
