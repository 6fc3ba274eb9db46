// SPDX-License-Identifier: Apache-2.0
// A surface as its readers fill it.
#ifndef TETCAST_VTK_SURFACE_HPP
#define TETCAST_VTK_SURFACE_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tcv {

// Points, and polygons one after the other, as a file has them.
struct Polygons {
  std::vector<double> points;   // [n][3]
  std::vector<int64_t> corners; // indices of points
  std::vector<size_t> ends;     // polygon i is corners[ends[i − 1] … ends[i])

  int64_t point_count() const { return static_cast<int64_t>(points.size() / 3); }
  void end_polygon() { ends.push_back(corners.size()); }
};

// Words and numbers of a text, line by line. Numbers are read the same in every locale.
class Scanner {
public:
  Scanner(const char *path, const std::string &text) : path_(path), at_(text.data()), end_(at_ + text.size()) {}

  bool next_line();   // to the next line that is neither empty nor a comment (#); false at the end
  std::string word(); // the next of this line; "" at its end
  bool at_end();      // of the line
  double number(const char *what);
  int64_t integer(const char *what);
  int line() const { return line_; }
  const char *path() const { return path_; }
  [[noreturn]] void truncated(const char *what, int64_t have, int64_t want) const;

private:
  const char *path_, *at_, *end_, *word_ = nullptr, *line_end_ = nullptr;
  int line_ = 0;
};

Polygons read_stl(const char *path);
Polygons read_off(const char *path);
Polygons read_obj(const char *path);
Polygons read_ply(const char *path);

} // namespace tcv

#endif
