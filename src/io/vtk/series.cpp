// SPDX-License-Identifier: Apache-2.0
// Reads ParaView's .series files, which are JSON: {"file-series-version": "1.0", "files": [{"name": "a.vtu", "time":
// 0.5}, …]}. Whatever else they hold is passed over.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "common.hpp"
#include "formats.hpp"
#include "lists.hpp"

namespace {

class Json {
public:
  Json(const char *path, const std::string &text) : path_(path), text_(text) {}

  [[noreturn]] void damaged() const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    tcv::fail(TETCAST_ERROR_DATA, "%s:%lld: truncated or damaged: is not the JSON of a file series", path_,
              static_cast<long long>(line));
  }

  char peek() {
    while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) && text_[at_])
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c)
      return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c))
      damaged();
  }

  // Calls `use(key)` for each member of an object, which takes the value.
  template <typename Use> void object(Use &&use) {
    expect('{');
    if (take('}'))
      return;
    do {
      const std::string key = string();
      expect(':');
      use(key);
    } while (take(','));
    expect('}');
  }
  template <typename Use> void array(Use &&use) {
    expect('[');
    if (take(']'))
      return;
    do
      use();
    while (take(','));
    expect(']');
  }

  std::string string() {
    expect('"');
    std::string result;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] != '\\')
        result += text_[at_];
      else if (++at_ < text_.size())
        escape(&result);
    }
    if (at_ >= text_.size())
      damaged();
    ++at_;
    return result;
  }

  double number() {
    peek();
    const size_t length = std::min(text_.find_first_not_of("+-.0123456789eE", at_), text_.size()) - at_;
    const double value = tcv::number_of(text_.substr(at_, length));
    if (!std::isfinite(value))
      damaged();
    at_ += length;
    return value;
  }

  void skip(int depth = 0) {
    if (depth > 64)
      damaged();
    const char c = peek();
    if (c == '{')
      return object([&](const std::string &) { skip(depth + 1); });
    if (c == '[')
      return array([&] { skip(depth + 1); });
    if (c == '"') {
      string();
      return;
    }
    for (const char *word : {"true", "false", "null"}) {
      if (text_.compare(at_, std::strlen(word), word) != 0)
        continue;
      at_ += std::strlen(word);
      return;
    }
    number();
  }

private:
  void escape(std::string *result) { // It is called at the letter behind the backslash.
    static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
    const char letter = text_[at_];
    const char *found = letter ? std::strchr(letters, letter) : nullptr;
    if (found) {
      *result += meanings[found - letters];
      return;
    }
    unsigned code = 0;
    if (letter != 'u' || at_ + 4 >= text_.size())
      damaged();
    for (int i = 0; i < 4; ++i) {
      const char digit[2] = {text_[++at_], '\0'};
      if (!std::strchr("0123456789abcdefABCDEF", digit[0]) || !digit[0])
        damaged();
      code = code * 16 + static_cast<unsigned>(std::strtoul(digit, nullptr, 16));
    }
    if (code == 0 || (code >= 0xD800 && code < 0xE000))
      damaged(); // Names of files have no such characters.
    if (code < 0x80)
      *result += static_cast<char>(code);
    else if (code < 0x800)
      *result += {static_cast<char>(0xC0 | code >> 6), static_cast<char>(0x80 | (code & 63))};
    else
      *result += {static_cast<char>(0xE0 | code >> 12), static_cast<char>(0x80 | (code >> 6 & 63)),
                  static_cast<char>(0x80 | (code & 63))};
  }

  const char *path_;
  const std::string &text_;
  size_t at_ = 0;
};

} // namespace

namespace tcv {

void read_series(const Reading &reading, Contents *contents) {
  const std::string text = file_contents(reading.path.c_str());
  Json json(reading.path.c_str(), text);
  std::vector<Step> steps;
  const auto file = [&] {
    // If there are no times, the numbers of the steps stand for them.
    Step step = {static_cast<double>(steps.size()), ""};
    json.object([&](const std::string &key) {
      if (key == "name")
        step.path = json.string();
      else if (key == "time")
        step.time = json.number();
      else
        json.skip();
    });
    if (step.path.empty())
      json.damaged();
    step.path = beside(reading.path, step.path);
    steps.push_back(step);
  };
  json.object([&](const std::string &key) {
    if (key == "files")
      json.array(file);
    else
      json.skip();
  });
  read_steps(reading, std::move(steps), true, contents);
}

} // namespace tcv
