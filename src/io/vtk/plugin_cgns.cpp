// SPDX-License-Identifier: Apache-2.0
#include <vtkCGNSReader.h>
#include <vtkNew.h>

#include "plugin_read.hpp"

void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result) {
  vtkNew<vtkCGNSReader> reader;
  if (!reader->CanReadFile(request->path.c_str())) return;
  reader->SetFileName(request->path.c_str());
  reader->UpdateInformation();
  reader->EnableAllBases();
  reader->EnableAllPointArrays();
  reader->EnableAllCellArrays();
  reader->DoublePrecisionMeshOn();
  tcv::read_step(reader, *request, result);
}
