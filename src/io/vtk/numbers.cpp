// SPDX-License-Identifier: Apache-2.0
#include "numbers.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include <vtkType.h>

#include "common.hpp"

namespace tcv {

bool NumberReader::next_word() {
  using Traits = std::streambuf::traits_type;
  word_.clear();
  int c = in_.sgetc();
  while (c != Traits::eof() && c <= ' ' && c != stop_)
    c = in_.snextc();
  while (c != Traits::eof() && c > ' ' && c != stop_ && word_.size() < 4096) {
    word_ += static_cast<char>(c);
    c = in_.snextc();
  }
  return !word_.empty();
}

// Changes words such as "1.5d3", "1.#INF" and "-1.#IND", which Fortran and C on Windows write, into what can be read as
// a number.
static bool parse_foreign(std::string *word, double *value) {
  const size_t mark = word->find('#'), exponent = word->find_first_of("dD");
  if (mark == std::string::npos) {
    if (exponent == std::string::npos || exponent == 0)
      return false;
    (*word)[exponent] = 'e';
    return parse_number(word->data(), word->data() + word->size(), value);
  }
  const std::string kind = word->substr(mark + 1, 3);
  if (kind != "INF" && kind != "IND" && kind != "QNA" && kind != "SNA")
    return false;
  *value = kind == "INF" ? ((*word)[0] == '-' ? -HUGE_VAL : HUGE_VAL) : std::numeric_limits<double>::quiet_NaN();
  return true;
}

static bool parse_real(const std::string &word, double *value) {
  if (parse_number(word.data(), word.data() + word.size(), value))
    return true;
  std::string copy = word;
  return parse_foreign(&copy, value);
}

template <typename T> static bool parse(const std::string &word, T *value, bool *overflowed) {
  if constexpr (std::is_floating_point_v<T>) {
    double real;
    if (!parse_real(word, &real))
      return false;
    *value = static_cast<T>(real);
    *overflowed = *overflowed || (std::isinf(*value) && std::isfinite(real));
    return true;
  } else {
    using Wide = std::conditional_t<std::is_signed_v<T>, long long, unsigned long long>;
    Wide whole = 0;
    const char *first = word.data() + (word[0] == '+'), *last = word.data() + word.size();
    const auto [end, error] = std::from_chars(first, last, whole);
    if (error == std::errc() && end == last && whole >= std::numeric_limits<T>::min() &&
        whole <= std::numeric_limits<T>::max()) {
      *value = static_cast<T>(whole);
      return true;
    }
    double real; // Integers may be written as "3.0" or "1e3".
    if (!parse_real(word, &real) || real != std::floor(real) || std::fabs(real) >= 9007199254740992.0)
      return false;
    if (real < static_cast<double>(std::numeric_limits<T>::min()) ||
        real > static_cast<double>(std::numeric_limits<T>::max()))
      return false;
    *value = static_cast<T>(real);
    return true;
  }
}

template <typename T> int64_t NumberReader::read(T *values, int64_t count) {
  for (int64_t i = 0; i < count; ++i) {
    if (!next_word() || !parse(word_, values + i, &overflowed_))
      return i;
  }
  return count;
}

template int64_t NumberReader::read(float *, int64_t);
template int64_t NumberReader::read(double *, int64_t);
template int64_t NumberReader::read(char *, int64_t);
template int64_t NumberReader::read(signed char *, int64_t);
template int64_t NumberReader::read(unsigned char *, int64_t);
template int64_t NumberReader::read(short *, int64_t);
template int64_t NumberReader::read(unsigned short *, int64_t);
template int64_t NumberReader::read(int *, int64_t);
template int64_t NumberReader::read(unsigned int *, int64_t);
template int64_t NumberReader::read(long *, int64_t);
template int64_t NumberReader::read(unsigned long *, int64_t);
template int64_t NumberReader::read(long long *, int64_t);
template int64_t NumberReader::read(unsigned long long *, int64_t);

} // namespace tcv
