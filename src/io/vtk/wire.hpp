// SPDX-License-Identifier: Apache-2.0
// What a reader program sends to the library that started it, over a pipe, in the machine's own order of bytes:
// records, each of a letter and its data. Both ends are of one build.
#ifndef TETCAST_VTK_WIRE_HPP
#define TETCAST_VTK_WIRE_HPP

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <vtkDataArray.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

namespace tcv {

// The letters.
enum WireRecord : char {
  WIRE_TRY = 't',   // text: what is tried next, which may end the program: an array's name, or nothing. Number: its
                    // association, −1 without
  WIRE_KNOWN = 'k', // number, text: an array of the file that was not asked for
  WIRE_UNREADABLE = 'l', // number, text, text: an array that can't be read, and why
  WIRE_TIMES = 's',      // number of times, these, the step
  WIRE_WARN = 'w',       // text: a warning of VTK's
  WIRE_BLOCK = 'b',      // text: its name; a block that is not wanted
  WIRE_FLAT = 'f',       // text: its name; a block without volume
  WIRE_GRID = 'g',       // text: its name; grid
  WIRE_END = 'e',        // the end of all records
  WIRE_FAILED = 'x',     // number, text: a status, and what is wrong with the file
  WIRE_OTHER = 'o',      // the file is not of the format
  WIRE_ENDLESS = 'h'     // VTK's reader doesn't end
};

// Sends bytes when there are many, and at flush(). If that fails, it ends the program, as there is nobody to read them.
class WireWriter {
public:
  explicit WireWriter(int file) : file_(file) {}
  void record(WireRecord letter) { bytes(&letter, 1); }
  void number(int64_t value) { bytes(&value, sizeof value); }
  void real(double value) { bytes(&value, sizeof value); }
  void text(const std::string &value);
  void grid(vtkUnstructuredGrid *grid);
  void flush();

private:
  void bytes(const void *data, size_t size);
  void array(vtkDataArray *array); // null is possible; one that was written before is named by its number
  void arrays(vtkDataSetAttributes *attributes);

  int file_;
  std::string buffer_;
  std::map<vtkDataArray *, int64_t> numbers_;
  std::vector<vtkSmartPointer<vtkDataArray>> kept_; // so that no address is used twice
};

// The other end. What is thrown by these is a WireBroken when the program ended in the midst or tells nonsense.
struct WireBroken {};

class WireReader {
public:
  // `alive` tells whether the process is still there; asked where nothing comes for a while: another process may hold
  // the pipe open.
  WireReader(int file, bool (*alive)(int process), int process) : file_(file), alive_(alive), process_(process) {}
  WireRecord record();
  int64_t number();
  double real();
  std::string text();
  vtkSmartPointer<vtkUnstructuredGrid> grid();

private:
  void bytes(void *data, size_t size);
  size_t some(void *data, size_t size);
  vtkSmartPointer<vtkDataArray> array();
  void arrays(vtkDataSetAttributes *attributes);

  int file_;
  bool (*alive_)(int);
  int process_;
  std::vector<char> buffer_;
  size_t at_ = 0, end_ = 0;
  std::vector<vtkSmartPointer<vtkDataArray>> arrays_; // by their numbers
  std::map<vtkDataArray *, vtkSmartPointer<vtkPoints>>
      points_; // of arrays of coordinates: grids that share them keep doing so
};

} // namespace tcv

#endif
