// SPDX-License-Identifier: Apache-2.0
// OpenFOAM cases: the path is that of an empty file in the case's folder, as ParaView has it.
#include <vtkNew.h>
#include <vtkOpenFOAMReader.h>

#include "plugin_read.hpp"

void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result) {
  vtkNew<vtkOpenFOAMReader> reader;
  reader->SetFileName(request->path.c_str());
  reader->SetCreateCellToPoint(false); // fields are as the file has them
  reader->SetDecomposePolyhedra(false);
  tcv::read_step(reader, *request, result);
}
