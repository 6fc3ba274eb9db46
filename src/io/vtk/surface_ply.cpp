// SPDX-License-Identifier: Apache-2.0
// Reads PLY. (The reader of VTK 9.1 crashes on a header that it does not know.)
#include "common.hpp"
#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

enum Encoding { TEXT, LITTLE, BIG };

struct Property {
  std::string name;
  char type;           // This is i for signed, u for unsigned and f for floating.
  int size;            // The number of bytes.
  char count_type = 0; // The type of the number in front of a list.
  int count_size = 0;  // The size of that number; 0: it is no list.
};

struct Element {
  std::string name;
  int64_t count;
  std::vector<Property> properties;
};

bool parse_type(const std::string &name, char *type, int *size) {
  static const struct {
    const char *name;
    char type;
    int size;
  } types[] = {{"char", 'i', 1},  {"uchar", 'u', 1},  {"short", 'i', 2},   {"ushort", 'u', 2},
               {"int", 'i', 4},   {"uint", 'u', 4},   {"float", 'f', 4},   {"double", 'f', 8},
               {"int8", 'i', 1},  {"uint8", 'u', 1},  {"int16", 'i', 2},   {"uint16", 'u', 2},
               {"int32", 'i', 4}, {"uint32", 'u', 4}, {"float32", 'f', 4}, {"float64", 'f', 8}};
  for (const auto &entry : types) {
    if (name != entry.name)
      continue;
    *type = entry.type;
    *size = entry.size;
    return true;
  }
  return false;
}

// Reads the lines of the header up to end_header. `body` receives where the data begin.
std::vector<Element> parse_header(const char *path, const std::string &bytes, Encoding *encoding, size_t *body) {
  size_t end = bytes.find("\nend_header");
  const size_t newline = end == std::string::npos ? end : bytes.find('\n', end + 1);
  if (newline == std::string::npos)
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated: the header does not end", path);
  *body = newline + 1;
  const std::string header = bytes.substr(0, end);
  tcv::Scanner scanner(path, header);
  std::vector<Element> elements;
  bool known = false;
  while (scanner.next_line()) {
    const std::string keyword = scanner.word();
    bool good = true;
    if (keyword == "format") {
      const std::string format = scanner.word();
      known = true;
      if (format == "ascii")
        *encoding = TEXT;
      else if (format == "binary_little_endian")
        *encoding = LITTLE;
      else if (format == "binary_big_endian")
        *encoding = BIG;
      else
        good = false;
    } else if (keyword == "element") {
      const std::string name = scanner.word();
      elements.push_back({name, scanner.integer("a count"), {}});
      good = elements.back().count >= 0;
    } else if (keyword == "property") {
      Property property = {};
      std::string type = scanner.word();
      if (type == "list") {
        good = parse_type(scanner.word(), &property.count_type, &property.count_size) && property.count_type != 'f';
        type = scanner.word();
      }
      good = good && parse_type(type, &property.type, &property.size) && !elements.empty();
      property.name = scanner.word();
      if (good)
        elements.back().properties.push_back(property);
    }
    if (!good)
      tcv::fail(TETCAST_ERROR_DATA, "%s: line %d: can't be understood", path, scanner.line());
  }
  if (!known)
    tcv::fail(TETCAST_ERROR_DATA, "%s: the header names no format", path);
  return elements;
}

// Reads values one after the other, whatever the encoding is.
class Values {
public:
  Values(const char *path, const std::string &bytes, size_t body, Encoding encoding)
      : encoding_(encoding), text_(encoding == TEXT ? bytes.substr(body) : std::string()), scanner_(path, text_),
        at_(bytes.data() + body), end_(bytes.data() + bytes.size()) {}

  void begin(const Element &element, int64_t i) {
    if (encoding_ == TEXT && !scanner_.next_line())
      scanner_.truncated(element.name.c_str(), i, element.count);
  }

  double value(const Element &element, int64_t i, char type, int size) {
    if (encoding_ == TEXT)
      return scanner_.number("a number");
    if (end_ - at_ < size)
      scanner_.truncated(element.name.c_str(), i, element.count);
    unsigned char bytes[8];
    std::memcpy(bytes, at_, static_cast<size_t>(size));
    at_ += size;
    if (encoding_ == BIG)
      std::reverse(bytes, bytes + size);
    return decode(bytes, type, size);
  }

private:
  template <typename T> static double as(const unsigned char *bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }
  static double decode(const unsigned char *bytes, char type, int size) {
    if (type == 'f')
      return size == 4 ? as<float>(bytes) : as<double>(bytes);
    if (type == 'u')
      return size == 1 ? as<uint8_t>(bytes) : size == 2 ? as<uint16_t>(bytes) : as<uint32_t>(bytes);
    return size == 1 ? as<int8_t>(bytes) : size == 2 ? as<int16_t>(bytes) : as<int32_t>(bytes);
  }

  Encoding encoding_;
  std::string text_;
  tcv::Scanner scanner_;
  const char *at_, *end_;
};

// Reads a number that counts or indexes. If it is out of range, it becomes −1, which later checks refuse.
int64_t whole(double value) {
  return value >= 0 && value <= 1e15 && value == std::floor(value) ? static_cast<int64_t>(value) : -1;
}

} // namespace

namespace tcv {

Polygons read_ply(const char *path) {
  const std::string bytes = file_contents(path);
  Encoding encoding = TEXT;
  size_t body = 0;
  const std::vector<Element> elements = parse_header(path, bytes, &encoding, &body);
  Values values(path, bytes, body, encoding);
  Polygons result;
  for (const Element &element : elements) {
    if (element.properties.empty())
      continue; // Nothing is stored, whatever the count says.
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    if (element.name == "tristrips")
      fail(TETCAST_ERROR_UNSUPPORTED, "%s: triangle strips in PLY can't be read", path);
    for (int64_t i = 0; i < element.count; ++i) {
      values.begin(element, i);
      double position[3] = {NAN, NAN, NAN};
      for (const Property &property : element.properties) {
        const bool corners = faces && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (property.count_size == 0) {
          const double value = values.value(element, i, property.type, property.size);
          if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
            position[property.name[0] - 'x'] = value;
          }
          continue;
        }
        const int64_t count = whole(values.value(element, i, property.count_type, property.count_size));
        if (count < 0)
          fail(TETCAST_ERROR_DATA, "%s: %s %lld: bad count", path, element.name.c_str(), static_cast<long long>(i));
        for (int64_t j = 0; j < count; ++j) {
          const double value = values.value(element, i, property.type, property.size);
          if (corners)
            result.corners.push_back(whole(value));
        }
        if (corners)
          result.end_polygon();
      }
      if (vertices)
        result.points.insert(result.points.end(), position, position + 3);
    }
  }
  return result;
}

} // namespace tcv
