// SPDX-License-Identifier: Apache-2.0
// Cutting hexahedra into tetrahedra, beside VTK's filter.
#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDataSetTriangleFilter.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>

#include <tetcast/cells.h>

#include "jobs.h"

namespace {

// n³ cubes, as VTK has them, with vertices numbered along x, y and z or at random. VTK's filter remembers how it cut a
// cell whose vertices were in the same order, which all are in the first case.
void make_cubes(int n, bool shuffled, vtkUnstructuredGrid *grid) {
  const vtkIdType m = n + 1;
  std::vector<vtkIdType> number(static_cast<size_t>(m * m * m));
  std::iota(number.begin(), number.end(), vtkIdType{0});
  if (shuffled)
    std::shuffle(number.begin(), number.end(), std::mt19937_64(1));
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(m * m * m);
  for (vtkIdType i = 0; i < m * m * m; ++i) {
    points->SetPoint(number[static_cast<size_t>(i)], static_cast<double>(i % m), static_cast<double>(i / m % m),
                     static_cast<double>(i / (m * m)));
  }
  vtkNew<vtkCellArray> cells;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const vtkIdType a = i + m * (j + m * k), b = a + m * m;
        vtkIdType corners[8] = {a, a + 1, a + m + 1, a + m, b, b + 1, b + m + 1, b + m};
        for (vtkIdType &corner : corners)
          corner = number[static_cast<size_t>(corner)];
        cells->InsertNextCell(8, corners);
      }
    }
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_HEXAHEDRON, cells);
}

int64_t cut(vtkUnstructuredGrid *grid) {
  TetcastContextDesc about = tetcast_context_desc_default();
  about.threads = 1;
  TetcastContext *context = nullptr;
  TetcastCut *result = nullptr;
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices.data = grid->GetPoints()->GetVoidPointer(0);
  desc.vertices.type = TETCAST_TYPE_FLOAT64;
  desc.vertices.count = grid->GetNumberOfPoints();
  desc.connectivity.data = grid->GetCells()->GetConnectivityArray()->GetVoidPointer(0);
  desc.connectivity.type = grid->GetCells()->IsStorage64Bit() ? TETCAST_TYPE_INT64 : TETCAST_TYPE_INT32;
  desc.connectivity.count = grid->GetNumberOfCells();
  must(tetcast_context_create(&about, &context) == TETCAST_OK &&
           tetcast_cells_cut(context, &desc, &result) == TETCAST_OK,
       "hexahedra can't be cut");
  const int64_t count = tetcast_cut_tetrahedra(result).count;
  tetcast_cut_destroy(&result);
  tetcast_context_destroy(&context);
  return count;
}

int64_t cut_by_vtk(vtkUnstructuredGrid *grid) {
  vtkNew<vtkDataSetTriangleFilter> filter;
  filter->SetInputData(grid);
  filter->Update();
  return filter->GetOutput()->GetNumberOfCells();
}

void measure(const Job *job, bool shuffled) {
  vtkNew<vtkUnstructuredGrid> grid;
  make_cubes(job->scene->n, shuffled, grid);
  const int64_t hexahedra = grid->GetNumberOfCells();
  Times times[2] = {};
  for (int round = 0; round < job->scene->rounds; ++round) {
    for (int who = 0; who < 2; ++who) {
      const Clock start = clock_now();
      const int64_t count = who == 0 ? cut(grid) : cut_by_vtk(grid);
      times_add(&times[who], clock_since(start));
      must(count >= 5 * hexahedra && count <= 6 * hexahedra, "hexahedra were not cut into five or six");
    }
  }
  for (int who = 0; who < 2; ++who) {
    Row row = job->row;
    row.task = "cut";
    row.what = shuffled ? "numbered at random" : "numbered in order";
    row.renderer = who == 0 ? "tetcast" : "VTK";
    row.threads = 1;
    row.times = &times[who];
    row_write(&row);
  }
}

} // namespace

extern "C" void job_cells(const Job *job) {
  measure(job, false);
  measure(job, true);
}
