// SPDX-License-Identifier: Apache-2.0
// Turns structured grids into hexahedra.
#include <climits>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include "common.hpp"
#include "contents.hpp"

namespace {

// Finds the number of points along each axis. Returns false for other kinds of dataset.
bool dimensions_of(vtkDataSet *dataset, int dimensions[3]) {
  if (auto *image = vtkImageData::SafeDownCast(dataset))
    image->GetDimensions(dimensions);
  else if (auto *rectilinear = vtkRectilinearGrid::SafeDownCast(dataset))
    rectilinear->GetDimensions(dimensions);
  else if (auto *structured = vtkStructuredGrid::SafeDownCast(dataset))
    structured->GetDimensions(dimensions);
  else
    return false;
  return true;
}

vtkSmartPointer<vtkPoints> points_of(vtkDataSet *dataset, int64_t count) {
  if (auto *structured = vtkStructuredGrid::SafeDownCast(dataset))
    return structured->GetPoints();
  vtkNew<vtkDoubleArray> positions;
  positions->SetNumberOfComponents(3);
  positions->SetNumberOfTuples(count);
  for (int64_t i = 0; i < count; ++i)
    dataset->GetPoint(i, positions->GetPointer(3 * i));
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(positions);
  return points;
}

// Lists the corners in the order of VTK's hexahedron. Cells go along x first, then y, then z.
template <typename Indices> void connect(const int64_t points[3], int64_t cells, Indices *indices, Indices *ends) {
  using T = typename Indices::ValueType;
  indices->SetNumberOfValues(8 * cells);
  ends->SetNumberOfValues(cells + 1);
  const int64_t row = points[0], layer = points[0] * points[1];
  T *corner = indices->GetPointer(0);
  for (int64_t k = 0; k + 1 < points[2]; ++k) {
    for (int64_t j = 0; j + 1 < points[1]; ++j) {
      for (int64_t i = 0; i + 1 < points[0]; ++i) {
        const int64_t at = i + row * j + layer * k;
        for (const int64_t offset :
             {int64_t{0}, int64_t{1}, row + 1, row, layer, layer + 1, layer + row + 1, layer + row}) {
          *corner++ = static_cast<T>(at + offset);
        }
      }
    }
  }
  for (int64_t i = 0; i <= cells; ++i)
    ends->SetValue(i, static_cast<T>(8 * i));
}

} // namespace

namespace tcv {

Grid to_hexahedra(const std::string &place, vtkDataSet *dataset) {
  int dimensions[3];
  if (!dimensions_of(dataset, dimensions))
    return nullptr;
  int64_t points[3], count = 1, cells = 1;
  for (int k = 0; k < 3; ++k) {
    points[k] = dimensions[k];
    if (points[k] < 2)
      return nullptr; // It is a surface, a line or a point.
    count *= points[k];
    cells *= points[k] - 1;
    if (count >= INT32_MAX) {
      fail(TETCAST_ERROR_LIMIT, "%s: a grid of %d × %d × %d points is more than can be addressed", place.c_str(),
           dimensions[0], dimensions[1], dimensions[2]);
    }
  }
  if (dataset->GetNumberOfPoints() != count) {
    fail(TETCAST_ERROR_DATA, "%s: has %lld points for a grid of %lld", place.c_str(),
         static_cast<long long>(dataset->GetNumberOfPoints()), static_cast<long long>(count));
  }
  auto grid = Grid::New();
  grid->SetPoints(points_of(dataset, count));
  vtkNew<vtkCellArray> connectivity;
  if (8 * cells < INT32_MAX) {
    vtkNew<vtkTypeInt32Array> indices, ends;
    connect(points, cells, indices.Get(), ends.Get());
    connectivity->SetData(ends, indices);
  } else {
    vtkNew<vtkIdTypeArray> indices, ends;
    connect(points, cells, indices.Get(), ends.Get());
    connectivity->SetData(ends, indices);
  }
  vtkNew<vtkUnsignedCharArray> types;
  types->SetNumberOfValues(cells);
  types->FillValue(VTK_HEXAHEDRON);
  grid->SetCells(types, connectivity);
  grid->GetPointData()->ShallowCopy(dataset->GetPointData());
  grid->GetCellData()->ShallowCopy(dataset->GetCellData());
  return grid;
}

} // namespace tcv
