// SPDX-License-Identifier: Apache-2.0
// Reads TetGen's own formats. TetGen's readers print messages, and trust what they read. The functions here check every
// number, and name the line where it is wrong.
#include "plc.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

namespace tetcast_tetgen {
namespace {

// Reads the numbers of a text file line by line. A '#' starts a comment, commas separate numbers as blanks do, and
// empty lines do not count.
class Numbers {
public:
  explicit Numbers(const std::string &path) : path_(path) {
    errno = 0;
    std::unique_ptr<FILE, int (*)(FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    char block[65536];
    std::size_t n = 0;
    while (file && (n = std::fread(block, 1, sizeof block, file.get())) > 0) {
      text_.append(block, n);
    }
    if (!file || std::ferror(file.get())) {
      tetcast_tetgen::fail(TETCAST_ERROR_IO, "%s: %s", path.c_str(), std::strerror(errno));
    }
    at_ = end_of_line_ = next_ = text_.data();
  }

  // Goes to the next line that holds something, unless there is something left in the present one. Returns false at the
  // end of the file.
  bool advance() {
    const char *end = text_.data() + text_.size();
    while (!more()) {
      if (next_ == end) {
        return false;
      }
      at_ = next_;
      const void *newline = std::memchr(at_, '\n', (std::size_t)(end - at_));
      end_of_line_ = newline ? (const char *)newline : end;
      next_ = newline ? end_of_line_ + 1 : end;
      const void *comment = std::memchr(at_, '#', (std::size_t)(end_of_line_ - at_));
      end_of_line_ = comment ? (const char *)comment : end_of_line_;
      line_++;
    }
    return true;
  }

  void next_line(const char *what) {
    if (!advance()) {
      tetcast_tetgen::fail(TETCAST_ERROR_DATA, "%s: the file ends where %s should be: truncated?", path_.c_str(), what);
    }
  }

  void skip_line() { at_ = end_of_line_; }

  // Returns whether there is another number in the line.
  bool more() {
    while (at_ != end_of_line_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == ',')) {
      at_++;
    }
    return at_ != end_of_line_;
  }

  int64_t integer(const char *what, int64_t low, int64_t high) {
    int64_t value = 0;
    number(value, what);
    if (value < low || value > high) {
      fail("%s is %lld, not in [%lld, %lld]", what, (long long)value, (long long)low, (long long)high);
    }
    return value;
  }

  double real(const char *what) {
    double value = 0;
    number(value, what);
    if (!std::isfinite(value)) {
      fail("%s is not finite", what);
    }
    return value;
  }

  [[noreturn]] void fail(const char *format, ...) __attribute__((format(printf, 2, 3))) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    tetcast_tetgen::fail(TETCAST_ERROR_DATA, "%s:%lld: %s", path_.c_str(), (long long)line_, text);
  }

private:
  // Unlike strtod, std::from_chars does not depend on the locale.
  template <typename T> void number(T &value, const char *what) {
    if (!more()) {
      fail("%s is missing", what);
    }
    const char *start = at_ + (*at_ == '+' ? 1 : 0);
    auto [end, error] = std::from_chars(start, end_of_line_, value);
    bool ended = end == end_of_line_ || *end == ' ' || *end == '\t' || *end == '\r' || *end == ',';
    if (error != std::errc() || !ended) {
      fail("%s should be %s number", what, std::is_integral_v<T> ? "a whole" : "a");
    }
    at_ = end;
  }

  std::string path_, text_;
  const char *at_, *end_of_line_, *next_;
  int64_t line_ = 0;
};

// Returns the number of the first point.
int64_t read_points(Numbers &in, std::vector<double> &points, int64_t count, const char *what) {
  int64_t first = 0;
  for (int64_t i = 0; i < count; i++) {
    in.next_line(what);
    int64_t number = in.integer("the number of the point", INT32_MIN, INT32_MAX);
    first = i == 0 ? number : first;
    for (int j = 0; j < 3; j++) {
      points.push_back(in.real("a coordinate"));
    }
    in.skip_line();
  }
  return first;
}

// Reads the list of nodes at the start of a file. Returns the number of the first node, from which all references
// count, or -1 if the list is empty.
int64_t read_nodes(Numbers &in, std::vector<double> &points) {
  in.next_line("the number of points");
  int64_t count = in.integer("the number of points", 0, MAX_COUNT);
  if (in.more() && in.integer("the dimension", 2, 3) != 3) {
    in.fail("points of dimension 2 make no tetrahedra");
  }
  in.skip_line();
  if (count == 0) {
    return -1;
  }
  int64_t first = read_points(in, points, count, "a point");
  if (first != 0 && first != 1) {
    in.fail("points are numbered from 0 or 1, not from %lld", (long long)first);
  }
  return first;
}

std::string stem_of(const std::string &path) {
  return path.substr(0, path.find_last_of('.'));
}

// Reads the corners of one polygon, which may run over several lines.
void read_corners(Numbers &in, Plc &plc, int64_t first) {
  int64_t last = first + (int64_t)(plc.points.size() / 3) - 1;
  in.next_line("a polygon");
  int64_t count = in.integer("the number of corners", 1, MAX_COUNT);
  for (int64_t i = 0; i < count; i++) {
    in.next_line("a corner");
    plc.corners.push_back((int)(in.integer("a corner", first, last) - first));
  }
  in.skip_line();
  plc.polygon_ends.push_back(plc.corners.size());
}

void read_facet(Numbers &in, Plc &plc, int64_t first, bool smesh) {
  if (smesh) {
    read_corners(in, plc, first);
  } else {
    in.next_line("a facet");
    int64_t polygons = in.integer("the number of polygons", 1, MAX_COUNT);
    int64_t holes = in.more() ? in.integer("the number of holes", 0, MAX_COUNT) : 0;
    in.skip_line();
    for (int64_t i = 0; i < polygons; i++) {
      read_corners(in, plc, first);
    }
    read_points(in, plc.facet_holes, holes, "a hole of a facet");
  }
  plc.facets.push_back({plc.polygon_ends.size(), plc.facet_holes.size() / 3});
}

} // namespace

Plc plc_read(const std::string &path) {
  Plc plc;
  Numbers in(path);
  int64_t first = read_nodes(in, plc.points);
  if (first < 0) {
    Numbers nodes(stem_of(path) + ".node");
    first = read_nodes(nodes, plc.points);
  }
  if (first < 0) {
    fail(TETCAST_ERROR_DATA, "%s: there are no points", path.c_str());
  }
  in.next_line("the number of facets");
  int64_t facets = in.integer("the number of facets", 0, MAX_COUNT);
  in.skip_line();
  if (facets == 0) {
    in.fail("there are no facets");
  }
  bool smesh = path.size() >= 6 && path.compare(path.size() - 6, 6, ".smesh") == 0;
  for (int64_t i = 0; i < facets; i++) {
    read_facet(in, plc, first, smesh);
  }
  // The lists of holes and regions may be missing. Regions only matter to meshes with attributes, so they are not read.
  if (in.advance()) {
    int64_t holes = in.integer("the number of holes", 0, MAX_COUNT);
    in.skip_line();
    read_points(in, plc.holes, holes, "a hole");
  }
  return plc;
}

Cells cells_read(const std::string &stem) {
  Cells cells;
  Numbers nodes(stem + ".node");
  int64_t first = read_nodes(nodes, cells.points);
  Numbers in(stem + ".ele");
  in.next_line("the number of tetrahedra");
  int64_t count = in.integer("the number of tetrahedra", 0, MAX_COUNT);
  int64_t corners = in.more() ? in.integer("the number of nodes per tetrahedron", 4, 10) : 4;
  in.skip_line();
  if (count == 0) {
    in.fail("there are no tetrahedra");
  }
  if (corners != 4 && corners != 10) {
    in.fail("tetrahedra have 4 or 10 nodes, not %lld", (long long)corners);
  }
  int64_t last = first + (int64_t)(cells.points.size() / 3) - 1;
  for (int64_t i = 0; i < count; i++) {
    in.next_line("a tetrahedron");
    in.integer("the number of the tetrahedron", INT32_MIN, INT32_MAX);
    for (int j = 0; j < 4; j++) {
      cells.tetrahedra.push_back((int)(in.integer("a node", first, last) - first));
    }
    in.skip_line(); // It holds nodes on edges and attributes, which are not needed.
  }
  return cells;
}

} // namespace tetcast_tetgen
