// SPDX-License-Identifier: Apache-2.0
#include "cells.hpp"
#include "common.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <string>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkOrderedTriangulator.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

namespace {

enum Way { IGNORED, TETRAHEDRON, ORDERED, OWN, REFUSED }; // how a cell becomes tetrahedra

struct CellType {
  int id;
  const char *name;
  Way way;
  int points; // 0: any number
};

// Linear cells are cut by the order of their point indices, so that neighbours agree about the diagonal of the face
// between them. Nonlinear cells and polyhedra cut themselves, which agrees for them, while the ordered way does not.
const CellType cell_types[] = {
    {VTK_EMPTY_CELL, "empty cell", IGNORED, 0},
    {VTK_VERTEX, "vertex", IGNORED, 0},
    {VTK_POLY_VERTEX, "poly-vertex", IGNORED, 0},
    {VTK_LINE, "line", IGNORED, 0},
    {VTK_POLY_LINE, "polyline", IGNORED, 0},
    {VTK_TRIANGLE, "triangle", IGNORED, 0},
    {VTK_TRIANGLE_STRIP, "triangle strip", IGNORED, 0},
    {VTK_POLYGON, "polygon", IGNORED, 0},
    {VTK_PIXEL, "pixel", IGNORED, 0},
    {VTK_QUAD, "quadrilateral", IGNORED, 0},
    {VTK_TETRA, "tetrahedron", TETRAHEDRON, 4},
    {VTK_VOXEL, "voxel", ORDERED, 8},
    {VTK_HEXAHEDRON, "hexahedron", ORDERED, 8},
    {VTK_WEDGE, "wedge", ORDERED, 6},
    {VTK_PYRAMID, "pyramid", ORDERED, 5},
    {VTK_PENTAGONAL_PRISM, "pentagonal prism", ORDERED, 10},
    {VTK_HEXAGONAL_PRISM, "hexagonal prism", ORDERED, 12},
    {VTK_QUADRATIC_EDGE, "quadratic line", IGNORED, 0},
    {VTK_QUADRATIC_TRIANGLE, "quadratic triangle", IGNORED, 0},
    {VTK_QUADRATIC_QUAD, "quadratic quadrilateral", IGNORED, 0},
    {VTK_QUADRATIC_TETRA, "quadratic tetrahedron", OWN, 10},
    {VTK_QUADRATIC_HEXAHEDRON, "quadratic hexahedron", OWN, 20},
    {VTK_QUADRATIC_WEDGE, "quadratic wedge", OWN, 15},
    {VTK_QUADRATIC_PYRAMID, "quadratic pyramid", OWN, 13},
    {VTK_BIQUADRATIC_QUAD, "biquadratic quadrilateral", IGNORED, 0},
    {VTK_TRIQUADRATIC_HEXAHEDRON, "triquadratic hexahedron", OWN, 27},
    {VTK_QUADRATIC_LINEAR_QUAD, "quadratic-linear quadrilateral", IGNORED, 0},
    {VTK_QUADRATIC_LINEAR_WEDGE, "quadratic-linear wedge", OWN, 12},
    {VTK_BIQUADRATIC_QUADRATIC_WEDGE, "biquadratic-quadratic wedge", OWN, 18},
    {VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, "biquadratic-quadratic hexahedron", OWN, 24},
    {VTK_BIQUADRATIC_TRIANGLE, "biquadratic triangle", IGNORED, 0},
    {VTK_CUBIC_LINE, "cubic line", IGNORED, 0},
    {VTK_QUADRATIC_POLYGON, "quadratic polygon", IGNORED, 0},
    {VTK_TRIQUADRATIC_PYRAMID, "triquadratic pyramid", OWN, 19},
    {VTK_CONVEX_POINT_SET, "convex point set", REFUSED, 0},
    {VTK_POLYHEDRON, "polyhedron", OWN, 0},
    {VTK_PARAMETRIC_CURVE, "parametric curve", IGNORED, 0},
    {VTK_PARAMETRIC_SURFACE, "parametric surface", IGNORED, 0},
    {VTK_PARAMETRIC_TRI_SURFACE, "parametric triangle", IGNORED, 0},
    {VTK_PARAMETRIC_QUAD_SURFACE, "parametric quadrilateral", IGNORED, 0},
    {VTK_PARAMETRIC_TETRA_REGION, "parametric tetrahedron", REFUSED, 0},
    {VTK_PARAMETRIC_HEX_REGION, "parametric hexahedron", REFUSED, 0},
    {VTK_HIGHER_ORDER_EDGE, "higher-order line", IGNORED, 0},
    {VTK_HIGHER_ORDER_TRIANGLE, "higher-order triangle", IGNORED, 0},
    {VTK_HIGHER_ORDER_QUAD, "higher-order quadrilateral", IGNORED, 0},
    {VTK_HIGHER_ORDER_POLYGON, "higher-order polygon", IGNORED, 0},
    {VTK_HIGHER_ORDER_TETRAHEDRON, "higher-order tetrahedron", REFUSED, 0},
    {VTK_HIGHER_ORDER_WEDGE, "higher-order wedge", REFUSED, 0},
    {VTK_HIGHER_ORDER_PYRAMID, "higher-order pyramid", REFUSED, 0},
    {VTK_HIGHER_ORDER_HEXAHEDRON, "higher-order hexahedron", REFUSED, 0},
    {VTK_LAGRANGE_CURVE, "Lagrange curve", IGNORED, 0},
    {VTK_LAGRANGE_TRIANGLE, "Lagrange triangle", IGNORED, 0},
    {VTK_LAGRANGE_QUADRILATERAL, "Lagrange quadrilateral", IGNORED, 0},
    {VTK_LAGRANGE_TETRAHEDRON, "Lagrange tetrahedron", REFUSED, 0},
    {VTK_LAGRANGE_HEXAHEDRON, "Lagrange hexahedron", REFUSED, 0},
    {VTK_LAGRANGE_WEDGE, "Lagrange wedge", REFUSED, 0},
    {VTK_LAGRANGE_PYRAMID, "Lagrange pyramid", REFUSED, 0},
    {VTK_BEZIER_CURVE, "Bezier curve", IGNORED, 0},
    {VTK_BEZIER_TRIANGLE, "Bezier triangle", IGNORED, 0},
    {VTK_BEZIER_QUADRILATERAL, "Bezier quadrilateral", IGNORED, 0},
    {VTK_BEZIER_TETRAHEDRON, "Bezier tetrahedron", REFUSED, 0},
    {VTK_BEZIER_HEXAHEDRON, "Bezier hexahedron", REFUSED, 0},
    {VTK_BEZIER_WEDGE, "Bezier wedge", REFUSED, 0},
    {VTK_BEZIER_PYRAMID, "Bezier pyramid", REFUSED, 0},
};

const CellType *find_type(int id) {
  for (const CellType &type : cell_types) {
    if (type.id == id) return &type;
  }
  return nullptr;
}

using TypeTable = std::array<const CellType *, 256>; // null: no such type

// Counts the types and refuses cells that nothing could be made of.
TypeTable survey(const char *path, vtkUnstructuredGrid *grid, tcv::Tetrahedra *result) {
  const vtkUnsignedCharArray *types = grid->GetCellTypesArray();
  const int64_t cells = grid->GetNumberOfCells();
  if (!types || types->GetNumberOfValues() != cells) {
    tcv::fail(TETCAST_ERROR_DATA, "%s: has %lld cells but types of %lld", path, static_cast<long long>(cells),
              static_cast<long long>(types ? types->GetNumberOfValues() : 0));
  }
  TypeTable table = {};
  for (const CellType &type : cell_types) table[static_cast<size_t>(type.id)] = &type;
  std::array<int64_t, 256> counts = {};
  vtkCellArray *connectivity = grid->GetCells();
  for (int64_t i = 0; i < cells; ++i) {
    const unsigned char id = types->GetValue(i);
    const CellType *type = table[id];
    const long long cell = i;
    if (!type) tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: there is no cell type %d", path, cell, id);
    const long long points = connectivity->GetCellSize(i);
    if (points < type->points) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: a %s has %d points, not %lld", path, cell, type->name, type->points,
                points);
    }
    result->oversized += type->points && points > type->points;
    ++counts[id];
  }
  bool volumetric = false;
  const CellType *refused = nullptr;
  for (size_t id = 0; id < counts.size(); ++id) {
    if (!counts[id]) continue;
    result->types.emplace_back(table[id]->name, counts[id]);
    volumetric = volumetric || table[id]->way != IGNORED;
    if (table[id]->way == REFUSED) refused = table[id];
  }
  std::stable_sort(result->types.begin(), result->types.end(), [](auto &a, auto &b) { return a.second > b.second; });
  if (refused)
    tcv::fail(TETCAST_ERROR_UNSUPPORTED, "%s: holds cells of type %s, which can't be cut yet", path, refused->name);
  if (!volumetric) {
    std::string list;
    for (const auto &[name, count] : result->types) {
      list += (list.empty() ? "" : ", ") + std::to_string(count) + " × " + name;
    }
    tcv::fail(TETCAST_ERROR_DATA, "%s: holds no volumetric cells, only %s", path, list.c_str());
  }
  return table;
}

// VTK walks the faces of a polyhedron unchecked.
void check_polyhedron(const char *path, vtkUnstructuredGrid *grid, int64_t i, vtkIdType size, const vtkIdType *points) {
  const vtkIdTypeArray *faces = grid->GetFaces(), *locations = grid->GetFaceLocations();
  const int64_t end = faces ? faces->GetNumberOfValues() : 0;
  int64_t at = locations && i < locations->GetNumberOfValues() ? locations->GetValue(i) : -1;
  const int64_t count = at >= 0 && at < end ? faces->GetValue(at) : -1;
  bool good = count >= 4 && count <= end;
  ++at;
  for (int64_t face = 0; good && face < count; ++face) {
    const int64_t corners = at < end ? faces->GetValue(at) : -1;
    good = corners >= 3 && corners < end - at;
    for (int64_t j = 1; good && j <= corners; ++j) {
      good = std::find(points, points + size, faces->GetValue(at + j)) != points + size;
    }
    at += corners + 1;
  }
  if (!good) {
    tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: the list of the polyhedron's faces is damaged", path,
              static_cast<long long>(i));
  }
}

class Cutter {
public:
  explicit Cutter(tcv::Tetrahedra *result, bool keep_source) : result_(result), keep_source_(keep_source) {
    triangulator_->PreSortedOff();
    triangulator_->UseTemplatesOn();
  }

  void tetrahedron(int64_t cell, const vtkIdType *points) { emit(cell, points); }

  // As vtkDataSetTriangleFilter does it.
  void ordered(int64_t i, vtkGenericCell *cell, int count) {
    static const int upside_down[6] = {3, 4, 5, 0, 1, 2}; // VTK's wedge faces the other way than its other cells
    double *parametric = cell->GetParametricCoords();
    triangulator_->InitTriangulation(0, 1, 0, 1, 0, 1, count);
    for (int j = 0; j < count; ++j) {
      const int k = cell->GetCellType() == VTK_WEDGE ? upside_down[j] : j;
      double position[3];
      cell->GetPoints()->GetPoint(k, position);
      triangulator_->InsertPoint(cell->GetPointId(k), position, parametric + 3 * j, 0);
    }
    triangulator_->TemplateTriangulate(cell->GetCellType(), count, cell->GetNumberOfEdges());
    pieces_->Reset();
    triangulator_->AddTetras(0, pieces_);
    const int64_t pieces = pieces_->GetNumberOfCells();
    for (int64_t piece = 0; piece < pieces; ++piece) {
      vtkIdType size;
      const vtkIdType *points;
      pieces_->GetCellAtId(piece, size, points);
      cut(i, points);
    }
    result_->uncut += pieces == 0;
  }

  void own(int64_t i, vtkGenericCell *cell) {
    cell->Triangulate(0, ids_, positions_);
    const int64_t pieces = ids_->GetNumberOfIds() / 4;
    for (int64_t piece = 0; piece < pieces; ++piece) cut(i, ids_->GetPointer(4 * piece));
    result_->uncut += pieces == 0;
  }

private:
  // Cells that have a point twice (a wedge written as a hexahedron) give flat pieces, which nothing can be seen of.
  void cut(int64_t cell, const vtkIdType *p) {
    if (p[0] != p[1] && p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3] && p[2] != p[3]) emit(cell, p);
  }

  void emit(int64_t cell, const vtkIdType *points) {
    for (int j = 0; j < 4; ++j) result_->cut.push_back(static_cast<int32_t>(points[j]));
    if (keep_source_) result_->source.push_back(static_cast<int32_t>(cell));
  }

  tcv::Tetrahedra *result_;
  bool keep_source_;
  vtkNew<vtkOrderedTriangulator> triangulator_;
  vtkNew<vtkCellArray> pieces_;
  vtkNew<vtkIdList> ids_;
  vtkNew<vtkPoints> positions_;
};

// Copies that another piece of a distributed mesh has as well, and cells that are switched off.
bool is_ghost(const vtkUnsignedCharArray *ghosts, int64_t cell) {
  const int hidden =
      vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::REFINEDCELL | vtkDataSetAttributes::HIDDENCELL;
  return ghosts && (ghosts->GetValue(cell) & hidden);
}

void cut_all(const char *path, vtkUnstructuredGrid *grid, const TypeTable &table, const vtkUnsignedCharArray *ghosts,
             tcv::Tetrahedra *result) {
  const int64_t cells = grid->GetNumberOfCells();
  if (cells >= INT32_MAX || grid->GetNumberOfPoints() >= INT32_MAX) {
    tcv::fail(TETCAST_ERROR_LIMIT, "%s: %lld cells and %lld points are more than can be addressed", path,
              static_cast<long long>(cells), static_cast<long long>(grid->GetNumberOfPoints()));
  }
  size_t estimate = 0;
  for (const auto &[name, count] : result->types) {
    const std::string type = name;
    estimate += static_cast<size_t>(count) * (type == "hexahedron" || type == "voxel" ? 6 : type == "wedge" ? 3 : 1);
  }
  const bool keep_source = grid->GetCellData()->GetNumberOfArrays() > 0;
  result->cut.reserve(4 * estimate);
  if (keep_source) result->source.reserve(estimate);

  Cutter cutter(result, keep_source);
  vtkNew<vtkGenericCell> cell;
  for (int64_t i = 0; i < cells; ++i) {
    const CellType &type = *table[grid->GetCellTypesArray()->GetValue(i)];
    if (type.way == IGNORED || is_ghost(ghosts, i)) continue;
    vtkIdType size;
    const vtkIdType *points;
    grid->GetCells()->GetCellAtId(i, size, points);
    if (type.way == TETRAHEDRON) {
      cutter.tetrahedron(i, points);
      continue;
    }
    if (type.id == VTK_POLYHEDRON) check_polyhedron(path, grid, i, size, points);
    grid->GetCell(i, cell);
    if (type.way == ORDERED) cutter.ordered(i, cell, type.points);
    else cutter.own(i, cell);
  }
}

} // namespace

namespace tcv {

void make_tetrahedra(const char *path, vtkUnstructuredGrid *grid, Tetrahedra *result) {
  const TypeTable table = survey(path, grid, result);
  const auto *ghosts = vtkUnsignedCharArray::SafeDownCast(grid->GetCellData()->GetAbstractArray("vtkGhostType"));
  if (ghosts && (ghosts->GetNumberOfComponents() != 1 || ghosts->GetNumberOfTuples() != grid->GetNumberOfCells())) {
    ghosts = nullptr;
  }
  bool any_ghost = false;
  for (int64_t i = 0; ghosts && i < grid->GetNumberOfCells() && !any_ghost; ++i) any_ghost = is_ghost(ghosts, i);

  if (result->types.size() == 1 && result->types[0].first == find_type(VTK_TETRA)->name && !any_ghost &&
      !result->oversized) {
    result->connectivity = grid->GetCells()->GetConnectivityArray();
    result->view = view_of(result->connectivity);
    result->view.count = grid->GetNumberOfCells();
    return;
  }
  cut_all(path, grid, table, ghosts, result);
  result->view.data = result->cut.data();
  result->view.type = TETCAST_TYPE_INT32;
  result->view.count = static_cast<int64_t>(result->cut.size() / 4);
  if (result->view.count == 0) fail(TETCAST_ERROR_DATA, "%s: no tetrahedron can be made of its cells", path);
}

} // namespace tcv
