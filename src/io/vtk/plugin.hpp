// SPDX-License-Identifier: Apache-2.0
// Formats whose readers bring libraries of their own: each is in a plugin libtetcast-vtk-NAME.so beside this library, which is loaded
// when such a file is read.
#ifndef TETCAST_VTK_PLUGIN_HPP
#define TETCAST_VTK_PLUGIN_HPP

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <vtkDataObject.h>
#include <vtkSmartPointer.h>

namespace tcv {

struct PluginRequest {
  std::string path;
  const char *only; // of the description
  std::function<int64_t(const std::vector<double> &times)> choose; // the step to be read; throws if there is no such
};

struct PluginResult {
  vtkSmartPointer<vtkDataObject> object; // null: not of this format
  std::vector<double> times;
  int64_t step = 0;
};

using PluginRead = void (*)(const PluginRequest *request, PluginResult *result);

bool plugin_exists(const char *name);

} // namespace tcv

// What every plugin has.
extern "C" __attribute__((visibility("default"))) void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result);

#endif
