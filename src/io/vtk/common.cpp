// SPDX-License-Identifier: Apache-2.0
#include "common.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include <strings.h>
#include <sys/stat.h>

#include <vtkAOSDataArrayTemplate.h>
#include <vtkCellArray.h>
#include <vtkPoints.h>

namespace tcv {

void fail(TetcastStatus status, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (length < static_cast<int>(sizeof text))
    throw Failure{status, text};
  // The text is longer than usual, as it has a list of many array names.
  std::string whole(static_cast<size_t>(length) + 1, '\0');
  va_start(arguments, format);
  std::vsnprintf(&whole[0], whole.size(), format, arguments);
  va_end(arguments);
  whole.pop_back();
  throw Failure{status, std::move(whole)};
}

// ── files ──

using File = std::unique_ptr<FILE, int (*)(FILE *)>;

static File open_file(const char *path, int64_t *size) {
  struct stat status;
  File file(std::fopen(path, "rb"), std::fclose);
  if (!file || fstat(fileno(file.get()), &status) != 0) {
    fail(TETCAST_ERROR_IO, "%s: can't be opened: %s", path, std::strerror(errno));
  }
  if (S_ISDIR(status.st_mode))
    fail(TETCAST_ERROR_IO, "%s: is a folder", path);
  if (!S_ISREG(status.st_mode))
    fail(TETCAST_ERROR_IO, "%s: is not a regular file", path);
  if (status.st_size == 0)
    fail(TETCAST_ERROR_DATA, "%s: is empty", path);
  *size = status.st_size;
  return file;
}

static std::string read_start(const char *path, int64_t limit) {
  int64_t size = 0;
  const File file = open_file(path, &size);
  std::string text(static_cast<size_t>(std::min(size, limit)), '\0');
  text.resize(std::fread(&text[0], 1, text.size(), file.get()));
  if (std::ferror(file.get()))
    fail(TETCAST_ERROR_IO, "%s: can't be read: %s", path, std::strerror(errno));
  return text;
}

std::string file_head(const char *path) {
  return read_start(path, 65536);
}
std::string file_contents(const char *path) {
  return read_start(path, INT64_MAX);
}

int64_t file_size(const char *path) {
  struct stat status;
  return path && stat(path, &status) == 0 ? static_cast<int64_t>(status.st_size) : 0;
}

static bool begins_with(const std::string &text, const char *start) {
  return text.compare(0, std::strlen(start), start) == 0;
}

static std::string upper_case(std::string text) {
  for (char &c : text)
    c = (c >= 'a' && c <= 'z') ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

static std::string word_at(const std::string &text, size_t *position) {
  const char *blank = " \t\r\n";
  const size_t start = std::min(text.find_first_not_of(blank, *position), text.size());
  *position = std::min(text.find_first_of(blank, start), text.size());
  return text.substr(start, *position - start);
}

// Returns the value of the attribute `type` of the element VTKFile, or "" if there is none.
static std::string xml_type(const std::string &head) {
  const size_t element = head.find("<VTKFile");
  const size_t end = head.find('>', element);
  if (element == std::string::npos || end == std::string::npos)
    return "";
  const std::string tag = head.substr(element, end - element);
  size_t at = tag.find("type");
  while (at != std::string::npos && std::strchr(" \t\r\n", tag[at - 1]) == nullptr)
    at = tag.find("type", at + 1);
  const size_t quote = at == std::string::npos ? at : tag.find_first_of("\"'", at);
  if (quote == std::string::npos)
    return "";
  const size_t close = tag.find(tag[quote], quote + 1);
  return close == std::string::npos ? "" : tag.substr(quote + 1, close - quote - 1);
}

// A legacy file begins with a title and the word ASCII or BINARY, and then says "DATASET type".
static std::string legacy_type(const std::string &head) {
  size_t at = 0;
  for (int line = 0; line < 2 && at != std::string::npos; ++line)
    at = head.find('\n', at + (line > 0));
  if (at == std::string::npos)
    return "";
  word_at(head, &at);
  const std::string keyword = upper_case(word_at(head, &at));
  return keyword == "DATASET" ? upper_case(word_at(head, &at)) : keyword;
}

// An EnSight case has "FORMAT" on a line of its own, and then "type: ensight".
static bool is_ensight(const std::string &head) {
  size_t at = begins_with(head, "FORMAT") ? 0 : head.find("\nFORMAT");
  if (at == std::string::npos)
    return false;
  at = head.find("type:", at);
  return at != std::string::npos && upper_case(head.substr(at, 40)).find("ENSIGHT") != std::string::npos;
}

std::string file_kind(const std::string &head) {
  const size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string::npos)
    return "";
  if (head[first] == '<')
    return head.find("<VTKFile") == std::string::npos ? "" : "VTKFile " + xml_type(head);
  if (head[first] == '{')
    return "JSON";
  if (begins_with(head, "$MeshFormat") || begins_with(head, "$NOD") ||
      (begins_with(head, "$Comments") && head.find("\n$MeshFormat") != std::string::npos))
    return "Gmsh";
  if (begins_with(head, "# vtk DataFile"))
    return "vtk " + legacy_type(head);
  if (begins_with(head, "\x89HDF")) { // The names of the top-level groups come early in the file.
    const auto has = [&](const char *name) { return head.find(name) != std::string::npos; };
    return has("VTKHDF") ? "HDF5 VTKHDF" : has("CGNSLibraryVersion") ? "HDF5 CGNS" : "HDF5";
  }
  if (begins_with(head, "@(#)ADF Database"))
    return "ADF";
  if (begins_with(head, "CDF\x01") || begins_with(head, "CDF\x02") || begins_with(head, "CDF\x05"))
    return "NetCDF";
  if (begins_with(head, "ply\n") || begins_with(head, "ply\r"))
    return "PLY";
  if (is_ensight(head))
    return "EnSight";
  size_t at = 0;
  const std::string word = word_at(head, &at);
  if (word.size() <= 8 && word.size() >= 3 && word.compare(word.size() - 3, 3, "OFF") == 0)
    return "OFF";
  if (word == "solid" && head.find("facet") != std::string::npos && head.find('\0') == std::string::npos)
    return "STL";
  return "";
}

bool has_extension(const char *path, const char *extension) {
  const size_t length = std::strlen(path), tail = std::strlen(extension);
  return length > tail && strcasecmp(path + length - tail, extension) == 0;
}

bool is_surface(const std::string &kind) {
  for (const char *surface : {"VTKFile PolyData", "VTKFile PPolyData", "vtk POLYDATA", "PLY", "STL", "OFF"}) {
    if (kind == surface)
      return true;
  }
  return false;
}

bool parse_number(const char *first, const char *last, double *value) {
  if (first != last && *first == '+')
    ++first;
  const auto [end, error] = std::from_chars(first, last, *value);
  if (end != last || first == last)
    return false;
  // The number is beyond the range of double: a tiny one becomes zero, and a huge one becomes an infinity, which is
  // refused later.
  if (error == std::errc::result_out_of_range) {
    const std::string text(first, last);
    *value = text.find("e-") != std::string::npos || text.find("E-") != std::string::npos ? 0 : HUGE_VAL;
  }
  return error != std::errc::invalid_argument;
}

double number_of(const std::string &text) {
  size_t at = 0;
  const std::string word = word_at(text, &at);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && !word.empty() ? value : std::nan("");
}

void refuse(const char *path, const std::string &kind, const char *wanted, const char *extensions) {
  if (kind.empty()) {
    fail(TETCAST_ERROR_DATA, "%s: is not a file of %s in a known format (%s)", path, wanted, extensions);
  }
  if (kind == "HDF5" || kind == "NetCDF") {
    fail(TETCAST_ERROR_UNSUPPORTED, "%s: is in a format on top of %s, which this version does not read", path,
         kind.c_str());
  }
  if (kind == "vtk " || kind == "VTKFile ") {
    fail(TETCAST_ERROR_DATA, "%s: does not say what kind of dataset it holds; truncated?", path);
  }
  const size_t space = kind.find(' ');
  const bool vtk = space != std::string::npos;
  const bool fillable = std::strcmp(wanted, "a volume mesh") == 0 && is_surface(kind);
  fail(TETCAST_ERROR_DATA, "%s: holds %s%s, not %s%s", path, vtk ? kind.c_str() + space + 1 : kind.c_str(),
       vtk ? "" : " data", wanted,
       fillable ? ": a surface, which tetcast mesh fills with tetrahedra if it is closed" : "");
}

// ── what VTK hands out ──

template <typename T> static int64_t find_nonfinite(const T *values, int64_t count) {
  int64_t i = 0;
  while (i < count && std::isfinite(values[i]))
    ++i;
  return i < count ? i : -1;
}

int64_t first_nonfinite(vtkDataArray *data) {
  const int64_t count = data->GetNumberOfComponents() * static_cast<int64_t>(data->GetNumberOfTuples());
  if (auto *floats = vtkAOSDataArrayTemplate<float>::FastDownCast(data))
    return find_nonfinite(floats->GetPointer(0), count);
  if (auto *doubles = vtkAOSDataArrayTemplate<double>::FastDownCast(data))
    return find_nonfinite(doubles->GetPointer(0), count);
  return -1; // These are integers.
}

void check_dimension(const char *path, vtkPoints *points) {
  const int components = points->GetData()->GetNumberOfComponents();
  if (components != 3)
    fail(TETCAST_ERROR_DATA, "%s: points have %d components, not 3", path, components);
}

void check_points(const char *path, vtkPoints *points) {
  check_dimension(path, points);
  const int64_t i = first_nonfinite(points->GetData());
  if (i < 0)
    return;
  fail(TETCAST_ERROR_DATA, "%s: point %lld: coordinate %c is %g", path, static_cast<long long>(i / 3), "xyz"[i % 3],
       points -> GetData() -> GetComponent(i / 3, static_cast<int>(i % 3)));
}

template <typename ArrayType>
static void check_cells_of(const char *path, ArrayType *offsets, ArrayType *indices, int64_t point_count,
                           const char *what) {
  const int64_t count = static_cast<int64_t>(offsets->GetNumberOfValues()) - 1;
  const int64_t size = indices->GetNumberOfValues();
  if (count < 0)
    return;
  const auto *offset = offsets->GetPointer(0);
  const auto *index = indices->GetPointer(0);
  if (offset[0] != 0)
    fail(TETCAST_ERROR_DATA, "%s: the first offset into the %ss' points is not 0", path, what);
  for (int64_t i = 0; i < count; ++i) {
    const long long cell = i;
    if (offset[i + 1] < offset[i] || offset[i + 1] > size) {
      fail(TETCAST_ERROR_DATA, "%s: %s %lld: offset %lld is %s", path, what, cell,
           static_cast<long long>(offset[i + 1]),
           offset[i + 1] > size ? "beyond the end of the list of points" : "less than the one before");
    }
    for (int64_t j = offset[i]; point_count >= 0 && j < offset[i + 1]; ++j) {
      if (index[j] < 0 || index[j] >= point_count) {
        fail(TETCAST_ERROR_DATA, "%s: %s %lld: point index %lld is out of range (there are %lld points)", path, what,
             cell, static_cast<long long>(index[j]), static_cast<long long>(point_count));
      }
    }
  }
}

void check_cells(const char *path, vtkCellArray *cells, int64_t point_count, const char *what) {
  if (cells->IsStorage64Bit()) {
    check_cells_of(path, cells->GetOffsetsArray64(), cells->GetConnectivityArray64(), point_count, what);
  } else {
    check_cells_of(path, cells->GetOffsetsArray32(), cells->GetConnectivityArray32(), point_count, what);
  }
}

// ── types ──

const char *type_name(const vtkDataArray *array) {
  static const char *const integers[2][4] = {{"int8", "int16", "int32", "int64"},
                                             {"uint8", "uint16", "uint32", "uint64"}};
  int row = 0;
  switch (array->GetDataType()) {
  case VTK_FLOAT:
    return "float32";
  case VTK_DOUBLE:
    return "float64";
  case VTK_BIT:
    return "bit";
  case VTK_UNSIGNED_CHAR:
  case VTK_UNSIGNED_SHORT:
  case VTK_UNSIGNED_INT:
  case VTK_UNSIGNED_LONG:
  case VTK_UNSIGNED_LONG_LONG:
    row = 1;
    break;
  default:
    break;
  }
  const int size = array->GetDataTypeSize();
  return integers[row][size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : 3];
}

TetcastType type_of(const vtkDataArray *array) {
  static const struct {
    const char *name;
    TetcastType type;
  } types[] = {{"float32", TETCAST_TYPE_FLOAT32}, {"float64", TETCAST_TYPE_FLOAT64}, {"int32", TETCAST_TYPE_INT32},
               {"uint32", TETCAST_TYPE_UINT32},   {"int64", TETCAST_TYPE_INT64},     {"uint64", TETCAST_TYPE_UINT64}};
  const char *name = type_name(array);
  for (const auto &entry : types) {
    if (std::strcmp(name, entry.name) == 0 && array->HasStandardMemoryLayout())
      return entry.type;
  }
  return TETCAST_TYPE_NONE;
}

int64_t type_size(TetcastType type) {
  const bool wide = type == TETCAST_TYPE_FLOAT64 || type == TETCAST_TYPE_INT64 || type == TETCAST_TYPE_UINT64;
  return wide ? 8 : 4;
}

TetcastArray view_of(vtkDataArray *array) {
  const int64_t count = array->GetNumberOfTuples();
  TetcastArray view = {};
  view.data = count ? array->GetVoidPointer(0) : nullptr;
  view.type = type_of(array);
  view.count = count;
  return view;
}

} // namespace tcv
