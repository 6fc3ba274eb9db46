// SPDX-License-Identifier: Apache-2.0
#include <vtkExodusIIReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include "plugin_read.hpp"
#include "selector.hpp"

void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result) {
  vtkNew<vtkExodusIIReader> reader;
  if (!reader->CanReadFile(request->path.c_str())) return;
  reader->SetFileName(request->path.c_str());
  result->object = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  reader->UpdateInformation();
  reader->SetSqueezePoints(false); // every block has all points of the file
  reader->GenerateObjectIdCellArrayOff();
  reader->GenerateGlobalElementIdArrayOff();
  reader->GenerateGlobalNodeIdArrayOff();
  for (const int kind : {vtkExodusIIReader::NODAL, vtkExodusIIReader::ELEM_BLOCK}) {
    reader->SetAllArrayStatus(kind, 1);
    for (int i = 0; i < reader->GetNumberOfObjectArrays(kind); ++i) {
      if (!tcv::may_name(request->only, reader->GetObjectArrayName(kind, i))) reader->SetObjectArrayStatus(kind, i, 0);
    }
  }
  tcv::read_step(reader, *request, result);
  auto *output = vtkMultiBlockDataSet::SafeDownCast(result->object);
  auto *blocks = output && output->GetNumberOfBlocks() > 0 ? vtkMultiBlockDataSet::SafeDownCast(output->GetBlock(0)) : nullptr;
  if (!blocks) return;
  vtkUnstructuredGrid *first = nullptr;
  for (unsigned i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
    auto *block = vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(i));
    if (!block || block->GetNumberOfPoints() == 0) continue;
    first = first ? first : block;
    if (block == first || block->GetNumberOfPoints() != first->GetNumberOfPoints()) continue;
    block->SetPoints(first->GetPoints()); // which tells that they are the same
    block->GetPointData()->ShallowCopy(first->GetPointData());
  }
  result->object = blocks;
}
