// SPDX-License-Identifier: Apache-2.0
// Reads the pieces of a file of any format, and puts them together to one grid.
#ifndef TETCAST_VTK_CONTENTS_HPP
#define TETCAST_VTK_CONTENTS_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <tetcast/dataset.h>

#include "arrays.hpp"

class vtkDataSet;

namespace tcv {

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

struct Piece {
  std::string place; // for messages: the file, and the block where there are several
  Grid grid;
  int block = -1; // the number of its block among all blocks of the file; -1 if it is of no block
};

// The contents of a file, as far as they were asked for.
struct Contents {
  std::vector<Piece> pieces;
  std::vector<std::string> blocks; // the names of all blocks
  std::vector<double> times;       // the times of all steps, ascending
  int64_t step = 0;
  int64_t surfaces = 0;            // the number of parts left out as they have no volume
  std::vector<UnreadArray> unread; // arrays of the file that the pieces don't have
  std::vector<std::string> *files =
      nullptr; // where the files that are listed go, which are not read then; null: they are read
};

// One file being read, perhaps on behalf of another that lists it.
struct Reading {
  TetcastContext *context;
  const TetcastDatasetDesc *desc;
  std::string path;
  std::string block; // that the file is in another, "" if it is none
  int depth;         // how many files that list files lead to it
};

// Reads in whatever format the file is in, and adds to `contents`.
void read_contents(const Reading &reading, Contents *contents);
void read_part(const Reading &of, const std::string &path, const std::string &block, Contents *contents);

// Adds a grid of any kind.
void add_grid(const Reading &reading, const std::string &block, vtkDataSet *grid, Contents *contents);

// Adds the name of a block, whose pieces follow.
void list_block(const std::string &block, Contents *contents);

// Whether block `path` is asked for by --block `name` (NULL: all are): it has these components, one after the other.
bool block_wanted(const std::string &path, const char *name);

// The number of the step that is asked for. Fails if there is no such step.
int64_t choose_step(const std::string &path, const TetcastDatasetDesc &desc, const std::vector<double> &times);

// Turns a structured grid into hexahedra, with its arrays. Null for flat grids and other kinds of dataset.
Grid to_hexahedra(const std::string &place, vtkDataSet *dataset);

// Puts the pieces together, which are consumed. A lone piece without ghosts stays as it is, unless its points have to
// be sorted. Arrays of the wrong length are noted as unread. Null for a part (TetcastDatasetDesc) without volume.
Grid unite(const Reading &reading, std::vector<Piece> *pieces, TetcastDatasetPieces *counts,
           std::vector<UnreadArray> *unread);

} // namespace tcv

#endif
