// SPDX-License-Identifier: Apache-2.0
// EnSight 6 and Gold, binary and ASCII.
#include <vtkGenericEnSightReader.h>
#include <vtkNew.h>

#include "plugin_read.hpp"

void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result) {
  vtkNew<vtkGenericEnSightReader> reader;
  const size_t slash = request->path.rfind('/'); // the reader looks for the other files in the folder it is given
  if (slash != std::string::npos) reader->SetFilePath(request->path.substr(0, slash + 1).c_str());
  reader->SetCaseFileName(request->path.substr(slash == std::string::npos ? 0 : slash + 1).c_str());
  tcv::read_step(reader, *request, result);
}
