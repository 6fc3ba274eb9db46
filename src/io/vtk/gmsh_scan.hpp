// SPDX-License-Identifier: Apache-2.0
// Gmsh's files piece by piece: text, or numbers as bytes between lines of text.
#ifndef TETCAST_VTK_GMSH_SCAN_HPP
#define TETCAST_VTK_GMSH_SCAN_HPP

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <tetcast/status.h>

namespace tcv {

// A place in a file whose bytes are in memory, from which is read. A copy is a place to come back to.
class GmshCursor {
public:
  GmshCursor(const char *path, const std::string &bytes)
      : path_(path), begin_(bytes.data()), at_(begin_), end_(begin_ + bytes.size()) {}

  // ── lines, which are text in all files ──
  bool
  next_section(std::string *name); // moves on to after the line "$Name" that comes next; false at the end of the file
  void end_section(const std::string &name);  // the line "$EndName" has to come next
  void skip_section(const std::string &name); // to after the line "$EndName", wherever it is
  std::string line();                         // the rest of this one; moves on to the next
  int64_t text_integer(const char *what);
  double text_number(const char *what);

  // ── numbers, which are text or bytes ──
  void begin_bytes() { binary_ = true; } // from here on numbers are bytes
  void swap_bytes() { swapped_ = true; }
  bool binary() const { return binary_; }
  int64_t integer(const char *what); // of four bytes
  int64_t size(const char *what);    // of eight
  double number(const char *what);   // of eight

  // A claimed count, which fails unless the rest of the file can hold that many things of so many bytes, or letters.
  int64_t count(int64_t value, int64_t bytes, int64_t letters, const char *what) const;
  int64_t left() const { return end_ - at_; } // bytes

  [[noreturn]] void fail(const char *format, ...) const
      __attribute__((format(printf, 2, 3))); // with the file's name and the place

private:
  std::pair<const char *, const char *> word(const char *what); // the next, in this line or a later one
  template <typename T> T bytes(const char *what);

  const char *path_, *begin_, *at_, *end_;
  bool binary_ = false, swapped_ = false;
};

// Turns tags, which may be any numbers, into indices from 0. As long as tags ascend by one, nothing is stored.
class GmshTags {
public:
  void add(int64_t tag, int64_t index);
  int64_t find(int64_t tag); // -1: there is no such tag
  bool twice(int64_t *tag);  // whether some tag is there twice

private:
  void sort();

  int64_t first_ = 0, count_ = 0;
  bool sorted_ = true;
  std::vector<std::pair<int64_t, int64_t>> pairs_; // empty while they are first_ … first_ + count_ − 1
};

} // namespace tcv

#endif
