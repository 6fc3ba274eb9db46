// SPDX-License-Identifier: Apache-2.0
#include "cells.hpp"
#include "common.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

namespace {

// These say what is done with a cell: nothing, it is cut into tetrahedra, or the file is refused.
enum Way { IGNORED, CUT, REFUSED };

struct CellType {
  int id;
  const char *name;
  Way way;
  int points; // 0 stands for any number.
};

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
    {VTK_TETRA, "tetrahedron", CUT, 4},
    {VTK_VOXEL, "voxel", CUT, 8},
    {VTK_HEXAHEDRON, "hexahedron", CUT, 8},
    {VTK_WEDGE, "wedge", CUT, 6},
    {VTK_PYRAMID, "pyramid", CUT, 5},
    {VTK_PENTAGONAL_PRISM, "pentagonal prism", CUT, 10},
    {VTK_HEXAGONAL_PRISM, "hexagonal prism", CUT, 12},
    {VTK_QUADRATIC_EDGE, "quadratic line", IGNORED, 0},
    {VTK_QUADRATIC_TRIANGLE, "quadratic triangle", IGNORED, 0},
    {VTK_QUADRATIC_QUAD, "quadratic quadrilateral", IGNORED, 0},
    {VTK_QUADRATIC_TETRA, "quadratic tetrahedron", CUT, 10},
    {VTK_QUADRATIC_HEXAHEDRON, "quadratic hexahedron", CUT, 20},
    {VTK_QUADRATIC_WEDGE, "quadratic wedge", CUT, 15},
    {VTK_QUADRATIC_PYRAMID, "quadratic pyramid", CUT, 13},
    {VTK_BIQUADRATIC_QUAD, "biquadratic quadrilateral", IGNORED, 0},
    {VTK_TRIQUADRATIC_HEXAHEDRON, "triquadratic hexahedron", CUT, 27},
    {VTK_QUADRATIC_LINEAR_QUAD, "quadratic-linear quadrilateral", IGNORED, 0},
    {VTK_QUADRATIC_LINEAR_WEDGE, "quadratic-linear wedge", CUT, 12},
    {VTK_BIQUADRATIC_QUADRATIC_WEDGE, "biquadratic-quadratic wedge", CUT, 18},
    {VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, "biquadratic-quadratic hexahedron", CUT, 24},
    {VTK_BIQUADRATIC_TRIANGLE, "biquadratic triangle", IGNORED, 0},
    {VTK_CUBIC_LINE, "cubic line", IGNORED, 0},
    {VTK_QUADRATIC_POLYGON, "quadratic polygon", IGNORED, 0},
    {VTK_TRIQUADRATIC_PYRAMID, "triquadratic pyramid", CUT, 19},
    {VTK_CONVEX_POINT_SET, "convex point set", REFUSED, 0},
    {VTK_POLYHEDRON, "polyhedron", CUT, 0},
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
    {VTK_LAGRANGE_TETRAHEDRON, "Lagrange tetrahedron", CUT, 0},
    {VTK_LAGRANGE_HEXAHEDRON, "Lagrange hexahedron", CUT, 0},
    {VTK_LAGRANGE_WEDGE, "Lagrange wedge", CUT, 0},
    {VTK_LAGRANGE_PYRAMID, "Lagrange pyramid", REFUSED, 0},
    {VTK_BEZIER_CURVE, "Bezier curve", IGNORED, 0},
    {VTK_BEZIER_TRIANGLE, "Bezier triangle", IGNORED, 0},
    {VTK_BEZIER_QUADRILATERAL, "Bezier quadrilateral", IGNORED, 0},
    {VTK_BEZIER_TETRAHEDRON, "Bezier tetrahedron", CUT, 0},
    {VTK_BEZIER_HEXAHEDRON, "Bezier hexahedron", CUT, 0},
    {VTK_BEZIER_WEDGE, "Bezier wedge", CUT, 0},
    {VTK_BEZIER_PYRAMID, "Bezier pyramid", REFUSED, 0},
};

const CellType *find_type(int id) {
  for (const CellType &type : cell_types) {
    if (type.id == id)
      return &type;
  }
  return nullptr;
}

using TypeTable = std::array<const CellType *, 256>; // An entry is null if there is no such type.

// Counts the cells of each type, and refuses a mesh that no tetrahedra could be made from.
void survey(const char *path, vtkUnstructuredGrid *grid, tcv::Tetrahedra *result) {
  const vtkUnsignedCharArray *types = grid->GetCellTypesArray();
  const int64_t cells = grid->GetNumberOfCells();
  if (!types || types->GetNumberOfValues() != cells) {
    tcv::fail(TETCAST_ERROR_DATA, "%s: has %lld cells but types of %lld", path, static_cast<long long>(cells),
              static_cast<long long>(types ? types->GetNumberOfValues() : 0));
  }
  TypeTable table = {};
  for (const CellType &type : cell_types)
    table[static_cast<size_t>(type.id)] = &type;
  std::array<int64_t, 256> counts = {};
  vtkCellArray *connectivity = grid->GetCells();
  for (int64_t i = 0; i < cells; ++i) {
    const unsigned char id = types->GetValue(i);
    const CellType *type = table[id];
    const long long cell = i;
    if (!type)
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: there is no cell type %d", path, cell, id);
    const long long points = connectivity->GetCellSize(i);
    if (points < type->points) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: a %s has %d points, not %lld", path, cell, type->name, type->points,
                points);
    }
    ++counts[id];
  }
  bool volumetric = false;
  const CellType *refused = nullptr;
  for (size_t id = 0; id < counts.size(); ++id) {
    if (!counts[id])
      continue;
    result->types.emplace_back(table[id]->name, counts[id]);
    volumetric = volumetric || table[id]->way != IGNORED;
    if (table[id]->way == REFUSED)
      refused = table[id];
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
}

// Returns a view of numbers of any type. If TetcastType lacks their type, they are copied to `storage` first. Without
// an array the view is empty.
TetcastArray numbers_of(vtkDataArray *array, std::vector<double> *storage) {
  if (!array)
    return {};
  if (tcv::type_of(array) != TETCAST_TYPE_NONE)
    return tcv::view_of(array);
  const int components = array->GetNumberOfComponents();
  storage->resize(static_cast<size_t>(array->GetNumberOfTuples()) * static_cast<size_t>(components));
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
    array->GetTuple(i, storage->data() + static_cast<size_t>(i) * static_cast<size_t>(components));
  }
  TetcastArray view = {};
  view.data = storage->data();
  view.type = TETCAST_TYPE_FLOAT64;
  view.count = array->GetNumberOfTuples();
  return view;
}

void cut_all(const char *path, vtkUnstructuredGrid *grid, vtkDataArray *points, const tcv::CutOptions &options,
             tcv::Tetrahedra *result) {
  std::vector<double> orders, rational; // These must outlive the call that reads them.
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = tcv::view_of(points);
  desc.types = grid->GetCellTypesArray()->GetPointer(0);
  desc.offsets = tcv::view_of(grid->GetCells()->GetOffsetsArray());
  desc.connectivity = tcv::view_of(grid->GetCells()->GetConnectivityArray());
  if (grid->GetFaces() && grid->GetFaceLocations()) {
    desc.faces = tcv::view_of(grid->GetFaces());
    desc.face_offsets = tcv::view_of(grid->GetFaceLocations());
  }
  vtkDataArray *degrees = grid->GetCellData()->GetHigherOrderDegrees();
  vtkDataArray *weights = grid->GetPointData()->GetRationalWeights();
  if (degrees && degrees->GetNumberOfComponents() == 3 && degrees->GetNumberOfTuples() == grid->GetNumberOfCells()) {
    desc.orders = numbers_of(degrees, &orders);
  }
  if (weights && weights->GetNumberOfComponents() == 1 && weights->GetNumberOfTuples() == points->GetNumberOfTuples()) {
    desc.rational = numbers_of(weights, &rational);
  }
  desc.subdivision = options.subdivision;
  desc.sources = options.sources || grid->GetCellData()->GetNumberOfArrays() > 0;

  // Messages of the library shall begin with the name of the file, so a context of our own catches them.
  try {
    result->context.emplace(options.threads);
    tetcast::check(tetcast_cells_cut(*result->context, &desc, result->cut.out()));
  } catch (const tetcast::Error &error) {
    if (error.status() == TETCAST_ERROR_MEMORY)
      throw std::bad_alloc();
    tcv::fail(error.status(), "%s: %s", path, error.what());
  }
  tetcast_cut_info(result->cut, &result->info);
}

// A wedge of 21 nodes has 15 of them behind its six corners, and programs do not agree about their order. This table
// has a row for each place in the order of VTK. `corners` is a set of bits: in a straight wedge, the node lies in the
// middle of these corners. `node` is the index of that node in three orders: that of VTK, that of Exodus but with the
// sides before the other faces, and that of Exodus.
constexpr int WEDGE_NODES = 21;
struct WedgePlace {
  unsigned corners;
  std::array<int, 3> node;
};
const std::array<WedgePlace, WEDGE_NODES - 6> wedge_places = {{{003, {6, 6, 6}},
                                                               {006, {7, 7, 7}},
                                                               {005, {8, 8, 8}},
                                                               {030, {9, 12, 12}},
                                                               {060, {10, 13, 13}},
                                                               {050, {11, 14, 14}},
                                                               {011, {12, 9, 9}},
                                                               {022, {13, 10, 10}},
                                                               {044, {14, 11, 11}},
                                                               {007, {15, 18, 16}},
                                                               {070, {16, 19, 17}},
                                                               {033, {17, 15, 20}},
                                                               {066, {18, 16, 18}},
                                                               {055, {19, 17, 19}},
                                                               {077, {20, 20, 15}}}};

// Returns how far the nodes are from where they would be in a straight wedge, if they come in this order: the sum of
// the squared distances.
double disorder(vtkDataArray *points, const vtkIdType *nodes, size_t order) {
  double sum = 0;
  for (const WedgePlace &place : wedge_places) {
    double middle[3] = {}, node[3];
    int count = 0;
    for (unsigned i = 0; i < 6; ++i) {
      if (!(place.corners >> i & 1))
        continue;
      double corner[3];
      points->GetTuple(nodes[i], corner);
      for (int k = 0; k < 3; ++k)
        middle[k] += corner[k];
      ++count;
    }
    points->GetTuple(nodes[place.node[order]], node);
    for (int k = 0; k < 3; ++k)
      sum += (node[k] - middle[k] / count) * (node[k] - middle[k] / count);
  }
  return sum;
}

// Puts the nodes of each wedge of 21 nodes in the order of VTK. They are taken to come in the order in which they are
// closest to their places in a straight wedge.
void order_wedges(vtkUnstructuredGrid *grid, vtkDataArray *points) {
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    vtkIdType size;
    const vtkIdType *nodes;
    if (grid->GetCellTypesArray()->GetValue(cell) != VTK_LAGRANGE_WEDGE ||
        grid->GetCells()->GetCellSize(cell) != WEDGE_NODES)
      continue;
    grid->GetCells()->GetCellAtId(cell, size, nodes);
    if (std::any_of(nodes, nodes + size,
                    [&](vtkIdType node) { return node < 0 || node >= points->GetNumberOfTuples(); }))
      continue; // The index is reported later.
    size_t best = 0;
    for (size_t order = 1; order < 3; ++order) {
      if (disorder(points, nodes, order) < disorder(points, nodes, best))
        best = order;
    }
    std::array<vtkIdType, WEDGE_NODES> ordered;
    std::copy(nodes, nodes + 6, ordered.begin());
    for (size_t i = 0; i < wedge_places.size(); ++i)
      ordered[6 + i] = nodes[wedge_places[i].node[best]];
    if (best > 0)
      grid->GetCells()->ReplaceCellAtId(cell, WEDGE_NODES, ordered.data());
  }
}

// Appends the vertices that cutting has added to the points.
void add_points(const tcv::Tetrahedra &tetrahedra, vtkDataArray *points) {
  const int64_t added = tetrahedra.info.added_vertices, count = points->GetNumberOfTuples();
  if (added == 0)
    return;
  std::vector<double> positions(3 * static_cast<size_t>(added));
  const TetcastArray view = tcv::view_of(points);
  tetcast_cut_interpolate(tetrahedra.cut, &view, 3, positions.data());
  if (!points->Resize(count + added))
    throw std::bad_alloc();
  for (int64_t i = 0; i < added; ++i)
    points->InsertNextTuple(positions.data() + 3 * i);
}

} // namespace

namespace tcv {

bool is_volume(int type) {
  const CellType *found = find_type(type);
  return found && found->way != IGNORED;
}

void make_tetrahedra(const char *path, vtkUnstructuredGrid *grid, vtkDataArray *points, const CutOptions &options,
                     Tetrahedra *result) {
  survey(path, grid, result);
  if (result->types.size() == 1 && result->types[0].first == find_type(VTK_TETRA)->name &&
      grid->GetCells()->GetNumberOfConnectivityIds() == 4 * grid->GetNumberOfCells()) {
    result->connectivity = grid->GetCells()->GetConnectivityArray();
    result->view = view_of(result->connectivity);
    result->view.count = grid->GetNumberOfCells();
    return;
  }
  order_wedges(grid, points);
  cut_all(path, grid, points, options, result);
  add_points(*result, points);
  result->view = tetcast_cut_tetrahedra(result->cut);
  result->source = tetcast_cut_sources(result->cut);
  if (result->view.count == 0)
    fail(TETCAST_ERROR_DATA, "%s: no tetrahedron can be made of its cells", path);
}

} // namespace tcv
