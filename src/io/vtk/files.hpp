// SPDX-License-Identifier: Apache-2.0
// VTK's readers of its own formats of surfaces, with the checks of counts that they leave out.
#ifndef TETCAST_VTK_FILES_HPP
#define TETCAST_VTK_FILES_HPP

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace tcv {

// Each is to be called with a Capture alive, which tells whether VTK is content.
vtkSmartPointer<vtkPolyData> read_vtp(const char *path);
vtkSmartPointer<vtkPolyData> read_legacy_surface(const char *path);

void check_netcdf(const char *path); // fails where the file is shorter than it says

} // namespace tcv

#endif
