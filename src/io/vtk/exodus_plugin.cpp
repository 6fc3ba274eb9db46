// SPDX-License-Identifier: Apache-2.0
// Exodus files, in a library of its own: VTK's reader of them brings NetCDF, HDF5 and more, which no other format needs.
#include <vector>

#include <vtkCellData.h>
#include <vtkExecutive.h>
#include <vtkExodusIIReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include "exodus.hpp"

// All element blocks as one grid. The reader is told to leave every block all points of the file, so that blocks share them.
static vtkSmartPointer<vtkUnstructuredGrid> merge(vtkMultiBlockDataSet *blocks) {
  auto merged = vtkSmartPointer<vtkUnstructuredGrid>::New();
  std::vector<vtkUnstructuredGrid *> parts;
  for (unsigned i = 0; blocks && i < blocks->GetNumberOfBlocks(); ++i) {
    auto *part = vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(i));
    if (part && part->GetNumberOfCells() > 0) parts.push_back(part);
  }
  if (parts.empty()) return merged;
  merged->SetPoints(parts[0]->GetPoints());
  merged->GetPointData()->ShallowCopy(parts[0]->GetPointData());
  merged->Allocate();
  vtkNew<vtkIdList> ids;
  for (vtkUnstructuredGrid *part : parts) {
    for (vtkIdType cell = 0; cell < part->GetNumberOfCells(); ++cell) {
      part->GetCellPoints(cell, ids);
      merged->InsertNextCell(part->GetCellType(cell), ids);
    }
  }
  // Cell arrays that all blocks have.
  for (int i = 0; i < parts[0]->GetCellData()->GetNumberOfArrays(); ++i) {
    vtkDataArray *first = parts[0]->GetCellData()->GetArray(i);
    if (!first || !first->GetName()) continue;
    auto all = vtkSmartPointer<vtkDataArray>::Take(first->NewInstance());
    all->SetName(first->GetName());
    all->SetNumberOfComponents(first->GetNumberOfComponents());
    for (vtkUnstructuredGrid *part : parts) {
      vtkDataArray *data = part->GetCellData()->GetArray(first->GetName());
      if (!data || data->GetDataType() != first->GetDataType() ||
          data->GetNumberOfComponents() != first->GetNumberOfComponents()) {
        all = nullptr;
        break;
      }
      all->InsertTuples(all->GetNumberOfTuples(), data->GetNumberOfTuples(), 0, data);
    }
    if (all) merged->GetCellData()->AddArray(all);
  }
  return merged;
}

vtkUnstructuredGrid *tetcast_vtk_exodus_read(const char *path) {
  vtkNew<vtkExodusIIReader> reader;
  if (!reader->CanReadFile(path)) return nullptr;
  reader->SetFileName(path);
  if (!reader->GetExecutive()->UpdateInformation()) return vtkUnstructuredGrid::New();
  reader->SetSqueezePoints(false);
  reader->GenerateObjectIdCellArrayOff();
  reader->GenerateGlobalElementIdArrayOff();
  reader->GenerateGlobalNodeIdArrayOff();
  reader->SetAllArrayStatus(vtkExodusIIReader::NODAL, 1);
  reader->SetAllArrayStatus(vtkExodusIIReader::ELEM_BLOCK, 1);
  reader->Update();
  auto *output = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutputDataObject(0));
  auto *blocks = output && output->GetNumberOfBlocks() > 0 ? vtkMultiBlockDataSet::SafeDownCast(output->GetBlock(0)) : nullptr;
  const auto merged = merge(blocks);
  merged->Register(nullptr);
  return merged;
}
