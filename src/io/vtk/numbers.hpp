// SPDX-License-Identifier: Apache-2.0
// Reads numbers as text from streams, also those that C++'s own reading refuses: NaN and infinities as any program
// writes them, numbers beyond the range of a type, Fortran's exponents.
#ifndef TETCAST_VTK_NUMBERS_HPP
#define TETCAST_VTK_NUMBERS_HPP

#include <cstdint>
#include <istream>
#include <string>

namespace tcv {

class NumberReader {
public:
  // Words end at blanks, and at the letter `stop`, which is not read.
  NumberReader(std::istream &in, char stop = '\0') : in_(*in.rdbuf()), stop_(stop) {}

  // Reads up to `count` values; returns how many there were before the text's end or a word that is none, which word()
  // then is. T is any of VTK's types of numbers.
  template <typename T> int64_t read(T *values, int64_t count);

  const std::string &word() const { return word_; } // empty: the text has ended
  bool overflowed() const { return overflowed_; }   // a finite number became infinite in T

private:
  bool next_word();

  std::streambuf &in_;
  char stop_;
  std::string word_;
  bool overflowed_ = false;
};

} // namespace tcv

#endif
