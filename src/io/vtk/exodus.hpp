// SPDX-License-Identifier: Apache-2.0
#ifndef TETCAST_VTK_EXODUS_HPP
#define TETCAST_VTK_EXODUS_HPP

#include <vtkUnstructuredGrid.h>

// What the plugin libtetcast-vtk-exodus.so has: the file's element blocks at its first time as one grid, which the caller releases;
// null: the file isn't one of Exodus.
extern "C" __attribute__((visibility("default"))) vtkUnstructuredGrid *tetcast_vtk_exodus_read(const char *path);

#endif
