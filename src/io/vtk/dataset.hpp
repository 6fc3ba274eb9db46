// SPDX-License-Identifier: Apache-2.0
#ifndef TETCAST_VTK_DATASET_HPP
#define TETCAST_VTK_DATASET_HPP

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <tetcast/dataset.h>

#include "cells.hpp"
#include "contents.hpp"

namespace tcv {

struct Array {
  std::string name, selector; // the selector that names it and no other
  TetcastAssociation association;
  vtkSmartPointer<vtkDataArray> data;
  bool active;
  bool number; // identifies points or cells: shown on request only
};

} // namespace tcv

// A dataset keeps VTK's arrays, but not its grid.
struct TetcastDataset {
  TetcastContext *context = nullptr;
  std::string path;
  int64_t point_count = 0, cell_count = 0; // of the file
  TetcastDatasetPieces pieces = {};
  std::vector<std::string> blocks;
  std::vector<double> times;
  int64_t step = 0;
  vtkSmartPointer<vtkDataArray> points; // float32 or float64
  tcv::Tetrahedra tetrahedra;
  std::vector<tcv::Array> arrays;       // point arrays first
  std::vector<tcv::UnreadArray> unread; // arrays of the file that were not read
  // The corners and the types of the file's cells; null unless cell arrays are averaged.
  vtkSmartPointer<vtkCellArray> corners;
  vtkSmartPointer<vtkUnsignedCharArray> types;
  mutable std::mutex mutex;                // guards the next
  mutable std::set<std::string> selectors; // that were handed out
};

#endif
