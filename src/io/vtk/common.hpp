// SPDX-License-Identifier: Apache-2.0
// What the files of this adapter share: errors, VTK's complaints, telling formats apart, checking VTK's results.
#ifndef TETCAST_VTK_COMMON_HPP
#define TETCAST_VTK_COMMON_HPP

#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/status.h>

#include "io/floating.hpp"

class vtkCellArray;
class vtkDataArray;
class vtkPoints;

namespace tcv {

// What the inside throws and the fence at the C interface turns into a status and a message.
struct Failure {
  TetcastStatus status;
  std::string text;
};

[[noreturn]] void fail(TetcastStatus status, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Runs `body`; no exception leaves it. `path` names the file in messages that come from no Failure.
template <typename Body> TetcastStatus fence(TetcastContext *context, const char *path, Body &&body) noexcept {
  const FloatingPoint guard;
  try {
    body();
    return TETCAST_OK;
  } catch (const Failure &failure) {
    return tetcast_context_error(context, failure.status, "%s", failure.text.c_str());
  } catch (const std::bad_alloc &) {
    return tetcast_context_error(context, TETCAST_ERROR_MEMORY,
                                 "%s: not enough memory for what it holds or claims to hold", path);
  } catch (const std::exception &exception) {
    return tetcast_context_error(context, TETCAST_ERROR_DATA, "%s: %s", path, exception.what());
  } catch (...) {
    return tetcast_context_error(context, TETCAST_ERROR_DATA, "%s: unknown exception", path);
  }
}

// While an object lives, VTK's messages on this thread come here and are printed nowhere. A thread has one at a time.
class Capture {
public:
  Capture();
  ~Capture();
  Capture(const Capture &) = delete;
  Capture &operator=(const Capture &) = delete;

  bool failed() const { return failed_; }
  const std::string &error() const { return error_; }     // the first error; empty if there was none
  const std::string &warning() const { return warning_; } // the first; empty if there was none
  void add(const char *text, bool is_error) noexcept;

private:
  friend class Doubt;
  bool failed_ = false;
  std::string error_, warning_;
};

// While an object lives, errors of this thread's capture are put aside: for reading something that may fail without the
// rest failing.
class Doubt {
public:
  Doubt();
  ~Doubt();
  Doubt(const Doubt &) = delete;
  Doubt &operator=(const Doubt &) = delete;

  bool failed() const;
  std::string error() const;

private:
  Capture *capture_; // null: there is none
  bool failed_ = false;
  std::string error_; // of before
};

// Returns the result of `read`. Fails if VTK reports an error while it runs, and passes on VTK's warnings.
template <typename Read> auto captured(TetcastContext *context, const char *path, Read &&read) {
  const Capture capture;
  auto result = read();
  if (capture.failed())
    fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s", path, capture.error().c_str());
  if (!capture.warning().empty()) {
    tetcast_context_message(context, TETCAST_SEVERITY_WARNING, "%s: %s", path, capture.warning().c_str());
  }
  return result;
}

// Fails unless `path` is a readable, non-empty regular file. Returns its first bytes, at most 64 KiB.
std::string file_head(const char *path);
std::string file_contents(const char *path);
int64_t file_size(const char *path); // 0 if there is no such file

// The kind of file that the content tells: "VTKFile UnstructuredGrid", "vtk POLYDATA", "PLY", "OFF", "STL", "HDF5",
// "NetCDF",
// "" …
std::string file_kind(const std::string &head);
bool is_surface(const std::string &kind);
bool parse_number(const char *first, const char *last,
                  double *value);                            // decimal, the same in every locale; false: is none
double number_of(const std::string &text);                   // decimal, the same in every locale; NaN: is none
bool has_extension(const char *path, const char *extension); // ".vtu", in any case of letters

// Refuses content that none of this call's readers can read.
[[noreturn]] void refuse(const char *path, const std::string &kind, const char *wanted, const char *extensions);

// Each of these fails with the first fault and its place.
int64_t first_nonfinite(vtkDataArray *data);               // value, of all components; -1: there is none
void check_dimension(const char *path, vtkPoints *points); // three coordinates each
void check_points(const char *path, vtkPoints *points);    // and finite ones
void check_cells(const char *path, vtkCellArray *cells, int64_t point_count, const char *what); // -1: offsets alone

TetcastType type_of(const vtkDataArray *array);   // NONE for types TetcastType lacks
const char *type_name(const vtkDataArray *array); // "float64", "int8" …; static storage
TetcastArray view_of(vtkDataArray *array);        // type must not be NONE
int64_t type_size(TetcastType type);

} // namespace tcv

#endif
