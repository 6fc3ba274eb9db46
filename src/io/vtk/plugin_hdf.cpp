// SPDX-License-Identifier: Apache-2.0
// VTKHDF: images, and unstructured grids in partitions.
#include <vtkHDFReader.h>
#include <vtkMultiPieceDataSet.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtk_hdf5.h>

#include "plugin_read.hpp"

// How many partitions the file has; an image has one.
static int64_t partitions(const char *path) {
  H5E_auto2_t print;
  void *user;
  H5Eget_auto2(H5E_DEFAULT, &print, &user);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  hsize_t count = 1;
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t data = file >= 0 ? H5Dopen2(file, "/VTKHDF/NumberOfCells", H5P_DEFAULT) : -1;
  const hid_t space = data >= 0 ? H5Dget_space(data) : -1;
  if (space >= 0 && H5Sget_simple_extent_ndims(space) == 1) H5Sget_simple_extent_dims(space, &count, nullptr);
  if (space >= 0) H5Sclose(space);
  if (data >= 0) H5Dclose(data);
  if (file >= 0) H5Fclose(file);
  H5Eset_auto2(H5E_DEFAULT, print, user);
  return count > 0 && count < 1000000 ? static_cast<int64_t>(count) : 1;
}

void tetcast_vtk_plugin_read(const tcv::PluginRequest *request, tcv::PluginResult *result) {
  const char *path = request->path.c_str();
  vtkNew<vtkHDFReader> reader;
  if (!reader->CanReadFile(path)) return;
  reader->SetFileName(path);
  result->times = tcv::times_of(reader);
  result->step = request->choose(result->times);
  const int count = static_cast<int>(partitions(path));
  vtkNew<vtkMultiPieceDataSet> pieces;
  for (int i = 0; i < count; ++i) {
    if (!reader->UpdatePiece(i, count, 0)) break; // has been said why
    vtkDataObject *output = reader->GetOutputDataObject(0);
    const auto piece = vtkSmartPointer<vtkDataObject>::Take(output->NewInstance());
    piece->ShallowCopy(output);
    pieces->SetPiece(static_cast<unsigned>(i), piece);
  }
  result->object = pieces;
}
