// SPDX-License-Identifier: Apache-2.0
// From a file of any format to the pieces it holds, and from these to one grid.
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
  int block = -1; // the number of its block among all there are; -1: it is of none
};

// What a file holds, of that what was asked for.
struct Contents {
  std::vector<Piece> pieces;
  std::vector<std::string> blocks; // names of all there are
  std::vector<double> times;       // of all steps, ascending
  int64_t step = 0;
  int64_t surfaces = 0;            // parts that were left out as they are known to be no volume
  std::vector<UnreadArray> unread; // arrays that there are in the file and not in the pieces
};

// One file being read, perhaps on behalf of another that lists it.
struct Reading {
  TetcastContext *context;
  const TetcastDatasetDesc *desc;
  std::string path;
  std::string block; // that the file is in another, "" if it is none
  int depth;         // of files that list files
};

// Reads in whatever format the file is in, and adds to `contents`.
void read_contents(const Reading &reading, Contents *contents);
void read_part(const Reading &of, const std::string &path, const std::string &block, Contents *contents);

// Adds a grid of any kind.
void add_grid(const Reading &reading, const std::string &block, vtkDataSet *grid, Contents *contents);

// Adds the name of a block there is, of which the pieces come one after the other.
void list_block(const std::string &block, Contents *contents);

// Whether block `path` is asked for by --block `name` (NULL: all are): it has these components, one after the other.
bool block_wanted(const std::string &path, const char *name);

// Which of the steps is asked for; fails if there is no such.
int64_t choose_step(const std::string &path, const TetcastDatasetDesc &desc, const std::vector<double> &times);

// A structured grid as hexahedra, with the arrays it has; null for flat ones and other kinds of dataset.
Grid to_hexahedra(const std::string &place, vtkDataSet *dataset);

// Puts the pieces together, which are consumed. A lone piece without ghosts stays as it is. Arrays of the wrong length
// are noted as unread.
Grid unite(const Reading &reading, std::vector<Piece> *pieces, TetcastDatasetPieces *counts,
           std::vector<UnreadArray> *unread);

} // namespace tcv

#endif
