// SPDX-License-Identifier: Apache-2.0
#include "gmsh_scan.hpp"

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "common.hpp"

namespace tcv {

static bool blank(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

void GmshCursor::fail(const char *format, ...) const {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (binary_)
    tcv::fail(TETCAST_ERROR_DATA, "%s: byte %lld: %s", path_, static_cast<long long>(at_ - begin_), text);
  tcv::fail(TETCAST_ERROR_DATA, "%s: line %lld: %s", path_, static_cast<long long>(1 + std::count(begin_, at_, '\n')),
            text);
}

// ── lines ──

std::string GmshCursor::line() {
  const void *newline = std::memchr(at_, '\n', static_cast<size_t>(end_ - at_));
  const char *start = at_, *stop = newline ? static_cast<const char *>(newline) : end_;
  at_ = newline ? stop + 1 : end_;
  while (stop > start && blank(stop[-1]))
    --stop;
  while (start < stop && blank(*start))
    ++start;
  return std::string(start, stop);
}

bool GmshCursor::next_section(std::string *name) {
  while (at_ < end_ && blank(*at_))
    ++at_;
  if (at_ == end_)
    return false;
  if (*at_ != '$')
    fail("a section is to begin here, with its name after a $");
  *name = line().substr(1);
  return true;
}

void GmshCursor::end_section(const std::string &name) {
  while (at_ < end_ && blank(*at_))
    ++at_;
  // Version 1 writes the end in capitals.
  const std::string wanted = (name == "NOD" || name == "ELM" ? "$END" : "$End") + name;
  if (at_ == end_)
    fail("truncated: '%.40s' is to come", wanted.c_str());
  if (static_cast<size_t>(end_ - at_) < wanted.size() || std::memcmp(at_, wanted.data(), wanted.size()) != 0) {
    fail("section $%.40s is to end here, with '%.40s'", name.c_str(), wanted.c_str());
  }
  line();
}

void GmshCursor::skip_section(const std::string &name) {
  const std::string wanted = "$End" + name;
  const auto found = std::search(at_, end_, wanted.begin(), wanted.end());
  if (found == end_)
    fail("truncated: section $%.40s does not end", name.c_str());
  at_ = found;
  line();
}

std::pair<const char *, const char *> GmshCursor::word(const char *what) {
  while (at_ < end_ && blank(*at_))
    ++at_;
  const char *start = at_;
  while (at_ < end_ && !blank(*at_))
    ++at_;
  if (start == at_)
    fail("truncated: %s is to come", what);
  return {start, at_};
}

int64_t GmshCursor::text_integer(const char *what) {
  const auto [first, last] = word(what);
  int64_t value = 0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error == std::errc() && end == last)
    return value;
  at_ = first;
  fail("%s expected, not '%.*s'", what, static_cast<int>(std::min<int64_t>(last - first, 40)), first);
}

double GmshCursor::text_number(const char *what) {
  const auto [first, last] = word(what);
  double value;
  if (parse_number(first, last, &value))
    return value;
  at_ = first;
  fail("%s expected, not '%.*s'", what, static_cast<int>(std::min<int64_t>(last - first, 40)), first);
}

// ── numbers ──

template <typename T> T GmshCursor::bytes(const char *what) {
  unsigned char raw[sizeof(T)];
  if (left() < static_cast<int64_t>(sizeof(T)))
    fail("truncated: %s is to come", what);
  std::memcpy(raw, at_, sizeof raw);
  at_ += sizeof raw;
  if (swapped_)
    std::reverse(raw, raw + sizeof raw);
  T value;
  std::memcpy(&value, raw, sizeof value);
  return value;
}

int64_t GmshCursor::integer(const char *what) {
  if (binary_)
    return bytes<int32_t>(what);
  const int64_t value = text_integer(what);
  if (value < INT32_MIN || value > INT32_MAX)
    fail("%s of %lld is out of range", what, static_cast<long long>(value));
  return value;
}

int64_t GmshCursor::size(const char *what) {
  return binary_ ? bytes<int64_t>(what) : text_integer(what);
}
double GmshCursor::number(const char *what) {
  return binary_ ? bytes<double>(what) : text_number(what);
}

int64_t GmshCursor::count(int64_t value, int64_t bytes, int64_t letters, const char *what) const {
  const int64_t each = std::max<int64_t>(binary_ ? bytes : letters, 1);
  if (value < 0 || value > left() / each)
    fail("claims %lld %s, which the file can't hold", static_cast<long long>(value), what);
  return value;
}

// ── tags ──

void GmshTags::add(int64_t tag, int64_t index) {
  if (pairs_.empty()) {
    if (count_ == 0)
      first_ = tag;
    if (index == count_ && first_ <= INT64_MAX - count_ && tag == first_ + count_) {
      ++count_;
      return;
    }
    for (int64_t i = 0; i < count_; ++i)
      pairs_.emplace_back(first_ + i, i);
  }
  sorted_ = sorted_ && (pairs_.empty() || pairs_.back().first < tag);
  pairs_.emplace_back(tag, index);
}

void GmshTags::sort() {
  if (!sorted_)
    std::sort(pairs_.begin(), pairs_.end());
  sorted_ = true;
}

int64_t GmshTags::find(int64_t tag) {
  if (pairs_.empty())
    return tag >= first_ && tag - first_ < count_ ? tag - first_ : -1;
  sort();
  const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), std::make_pair(tag, INT64_MIN));
  return found != pairs_.end() && found->first == tag ? found->second : -1;
}

bool GmshTags::twice(int64_t *tag) {
  sort();
  for (size_t i = 1; i < pairs_.size(); ++i) {
    if (pairs_[i].first != pairs_[i - 1].first)
      continue;
    *tag = pairs_[i].first;
    return true;
  }
  return false;
}

} // namespace tcv
