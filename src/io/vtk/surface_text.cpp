// SPDX-License-Identifier: Apache-2.0
// Reads STL, OFF and OBJ. VTK has no reader of OFF, and its readers of the others need a rendering library that would
// have to be loaded at each start.
#include "common.hpp"
#include "surface.hpp"

#include <charconv>
#include <cmath>
#include <cstring>

namespace tcv {

bool Scanner::next_line() {
  while (at_ < end_) {
    ++line_;
    word_ = at_;
    const void *newline = std::memchr(at_, '\n', static_cast<size_t>(end_ - at_));
    line_end_ = newline ? static_cast<const char *>(newline) : end_;
    at_ = newline ? line_end_ + 1 : end_;
    const void *comment = std::memchr(word_, '#', static_cast<size_t>(line_end_ - word_));
    if (comment)
      line_end_ = static_cast<const char *>(comment);
    while (word_ < line_end_ && static_cast<unsigned char>(*word_) <= ' ')
      ++word_;
    if (word_ < line_end_)
      return true;
  }
  word_ = line_end_ = end_;
  return false;
}

std::string Scanner::word() {
  while (word_ < line_end_ && static_cast<unsigned char>(*word_) <= ' ')
    ++word_;
  const char *start = word_;
  while (word_<line_end_ &&static_cast<unsigned char>(*word_)> ' ')
    ++word_;
  return std::string(start, word_);
}

bool Scanner::at_end() {
  while (word_ < line_end_ && static_cast<unsigned char>(*word_) <= ' ')
    ++word_;
  return word_ == line_end_;
}

double Scanner::number(const char *what) {
  const std::string text = word();
  double value;
  if (!parse_number(text.data(), text.data() + text.size(), &value)) {
    fail(TETCAST_ERROR_DATA, "%s: line %d: %s expected, not '%.40s'", path_, line_, what, text.c_str());
  }
  return value;
}

int64_t Scanner::integer(const char *what) {
  const std::string text = word();
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) {
    fail(TETCAST_ERROR_DATA, "%s: line %d: %s expected, not '%.40s'", path_, line_, what, text.c_str());
  }
  return value;
}

void Scanner::truncated(const char *what, int64_t have, int64_t want) const {
  fail(TETCAST_ERROR_DATA, "%s: truncated: ends after %lld of %lld %s", path_, static_cast<long long>(have),
       static_cast<long long>(want), what);
}

// ── STL ──

static Polygons read_stl_text(const char *path, const std::string &text) {
  Polygons result;
  Scanner scanner(path, text);
  bool ended = false;
  while (scanner.next_line()) {
    const std::string word = scanner.word();
    if (word == "vertex") {
      for (int i = 0; i < 3; ++i)
        result.points.push_back(scanner.number("a coordinate"));
      result.corners.push_back(result.point_count() - 1);
    } else if (word == "endloop") {
      result.end_polygon();
    }
    ended = word == "endsolid";
  }
  if (!ended)
    fail(TETCAST_ERROR_DATA, "%s: truncated: the last line is not 'endsolid'", path);
  return result;
}

static Polygons read_stl_binary(const char *path, const std::string &bytes, uint32_t claimed) {
  const size_t header = 84, facet = 50;
  const size_t whole = bytes.size() < header ? 0 : (bytes.size() - header) / facet;
  // Programs that write while they compute leave 0, or all ones, in place of the count.
  const size_t count = claimed == 0 || claimed == UINT32_MAX ? whole : claimed;
  if (bytes.size() < header || count > whole) {
    fail(TETCAST_ERROR_DATA, "%s: truncated: holds %zu of %zu triangles", path, whole, count);
  }
  Polygons result;
  result.points.reserve(9 * count);
  for (size_t i = 0; i < count; ++i) {
    float corners[9];
    std::memcpy(corners, &bytes[header + facet * i + 12], sizeof corners); // The corners follow the normal.
    for (float value : corners)
      result.points.push_back(static_cast<double>(value));
    for (size_t j = 0; j < 3; ++j)
      result.corners.push_back(static_cast<int64_t>(3 * i + j));
    result.end_polygon();
  }
  return result;
}

Polygons read_stl(const char *path) {
  const std::string bytes = file_contents(path);
  uint32_t claimed = 0;
  if (bytes.size() >= 84)
    std::memcpy(&claimed, &bytes[80], sizeof claimed);
  const bool binary_size = bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<size_t>(claimed);
  // Binary files may begin with "solid", too.
  const bool text = !binary_size && bytes.compare(0, 5, "solid") == 0 && bytes.find('\0') == std::string::npos;
  return text ? read_stl_text(path, bytes) : read_stl_binary(path, bytes, claimed);
}

// ── OFF ──

Polygons read_off(const char *path) {
  const std::string text = file_contents(path);
  Scanner scanner(path, text);
  Polygons result;
  scanner.next_line();
  const std::string keyword = scanner.word();
  std::string first = scanner.word();
  if (first == "BINARY" || keyword.find_first_of("4n") != std::string::npos) {
    fail(TETCAST_ERROR_UNSUPPORTED, "%s: binary and higher-dimensional OFF files can't be read", path);
  }
  if (first.empty()) {
    scanner.next_line();
    first = scanner.word();
  }
  int64_t points = 0, faces = 0;
  const auto parsed = std::from_chars(first.data(), first.data() + first.size(), points);
  if (parsed.ec == std::errc())
    faces = scanner.integer("the number of faces");
  if (parsed.ec != std::errc() || points < 0 || faces < 0) {
    fail(TETCAST_ERROR_DATA, "%s: line %d: numbers of vertices and faces expected", path, scanner.line());
  }
  // There is one vertex or face a line. Normals and colours may follow the coordinates or indices, and are passed over.
  for (int64_t i = 0; i < points; ++i) {
    if (!scanner.next_line())
      scanner.truncated("vertices", i, points);
    for (int j = 0; j < 3; ++j)
      result.points.push_back(scanner.number("a coordinate"));
  }
  for (int64_t i = 0; i < faces; ++i) {
    if (!scanner.next_line())
      scanner.truncated("faces", i, faces);
    const int64_t corners = scanner.integer("a number of corners");
    for (int64_t j = 0; j < corners; ++j)
      result.corners.push_back(scanner.integer("a vertex index"));
    result.end_polygon();
  }
  return result;
}

// ── OBJ ──

Polygons read_obj(const char *path) {
  const std::string text = file_contents(path);
  Scanner scanner(path, text);
  Polygons result;
  while (scanner.next_line()) {
    const std::string keyword = scanner.word();
    if (keyword == "v") {
      for (int j = 0; j < 3; ++j)
        result.points.push_back(scanner.number("a coordinate"));
    } else if (keyword == "f") {
      for (std::string word = scanner.word(); !word.empty(); word = scanner.word()) {
        if (word == "\\") { // The face goes on in the next line.
          if (!scanner.next_line())
            break;
          continue;
        }
        // It is written "7", "7/1", "7//3" or "7/1/3", counted from 1, or from the end if it is negative.
        int64_t index = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
        if (error != std::errc() || (end != word.data() + word.size() && *end != '/')) {
          fail(TETCAST_ERROR_DATA, "%s: line %d: a vertex index expected, not '%.40s'", path, scanner.line(),
               word.c_str());
        }
        result.corners.push_back(index < 0 ? result.point_count() + index : index - 1);
      }
      result.end_polygon();
    }
  }
  return result;
}

} // namespace tcv
