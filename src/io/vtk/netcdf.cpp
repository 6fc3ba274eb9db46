// SPDX-License-Identifier: Apache-2.0
// Checks whether a NetCDF file in one of the classic formats (CDF-1, 2 and 5) is as long as its header says. The NetCDF
// library reads zeros where a file was cut off, without a warning. The formats are described in "NetCDF Classic Format
// Specification" by Unidata.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <sys/stat.h>

#include "common.hpp"
#include "files.hpp"

namespace {

struct Header {
  std::FILE *file;
  const char *path;
  int64_t size;     // The size of the file.
  int version;      // This is 1, 2 or 5.
  uint64_t records; // The length of the one unlimited dimension.
  std::vector<uint64_t> dimensions;

  [[noreturn]] void damaged() const {
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: its NetCDF header ends or makes no sense at byte %lld",
              path, static_cast<long long>(std::ftell(file)));
  }
  uint64_t number(int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) {
      const int byte = std::fgetc(file);
      if (byte == EOF)
        damaged();
      value = value << 8 | static_cast<uint64_t>(byte);
    }
    return value;
  }
  // Each thing that is counted takes at least a byte, so the file can't have more of them than bytes.
  uint64_t count() {
    const uint64_t value = number(version == 5 ? 8 : 4);
    if (value > static_cast<uint64_t>(size))
      damaged();
    return value;
  }
  void skip(uint64_t bytes) {
    bytes = (bytes + 3) / 4 * 4;
    const int64_t at = std::ftell(file);
    if (at < 0 || bytes > static_cast<uint64_t>(size - at))
      damaged();
    if (std::fseek(file, static_cast<long>(bytes), SEEK_CUR) != 0)
      damaged();
  }
  void name() { skip(count()); }
  static uint64_t type_size(uint64_t type) {
    static const uint64_t sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < 12 ? sizes[type] : 0;
  }
  void attributes() {
    number(4);
    for (uint64_t i = count(); i > 0; --i) {
      name();
      const uint64_t type = number(4), values = count();
      if (type_size(type) == 0)
        damaged();
      skip(values * type_size(type));
    }
  }
};

struct Variable {
  uint64_t begin, bytes; // How many bytes the variable, or one record of it, has.
  bool record;
};

// Returns a · b, or the largest number there is if that overflows.
uint64_t product(uint64_t a, uint64_t b) {
  return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

Variable read_variable(Header &header) {
  header.name();
  Variable variable = {0, 1, false};
  for (uint64_t i = 0, n = header.count(); i < n; ++i) {
    const uint64_t dimension = header.count();
    if (dimension >= header.dimensions.size())
      header.damaged();
    const uint64_t length = header.dimensions[dimension];
    if (length == 0 && i == 0)
      variable.record = true; // This is the unlimited dimension.
    else
      variable.bytes = product(variable.bytes, length);
  }
  header.attributes();
  const uint64_t type = Header::type_size(header.number(4));
  if (type == 0)
    header.damaged();
  variable.bytes = product(variable.bytes, type);
  // This is the size of the variable, which says less than its dimensions do.
  header.number(header.version == 5 ? 8 : 4);
  variable.begin = header.number(header.version == 1 ? 4 : 8);
  return variable;
}

} // namespace

namespace tcv {

void check_netcdf(const char *path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path, "rb"), std::fclose);
  struct stat status;
  if (!file || fstat(fileno(file.get()), &status) != 0)
    fail(TETCAST_ERROR_IO, "%s: can't be read", path);
  Header header = {file.get(), path, status.st_size, 0, 0, {}};
  const uint64_t magic = header.number(4);
  header.version = static_cast<int>(magic & 0xff);
  if (magic >> 8 != 0x434446)
    return; // The file is one of HDF5, which checks its files itself.
  const bool large = header.version == 5;
  header.records = header.number(large ? 8 : 4);
  if (header.records == (large ? UINT64_MAX : UINT32_MAX))
    header.records = 0; // The file is being written, and has as many records as there are bytes for.
  header.number(4);
  for (uint64_t i = header.count(); i > 0; --i) {
    header.name();
    header.dimensions.push_back(header.number(large ? 8 : 4));
  }
  header.attributes();
  header.number(4);
  std::vector<Variable> variables;
  uint64_t record_bytes = 0, record_variables = 0;
  for (uint64_t i = header.count(); i > 0; --i) {
    variables.push_back(read_variable(header));
    if (!variables.back().record)
      continue;
    ++record_variables;
    const uint64_t padded = variables.back().bytes / 4 * 4 + (variables.back().bytes % 4 ? 4 : 0);
    record_bytes = padded > UINT64_MAX - record_bytes ? UINT64_MAX : record_bytes + padded;
  }
  if (record_variables == 1) { // If only one variable has records, they are not padded.
    for (const Variable &variable : variables)
      record_bytes = variable.record ? variable.bytes : record_bytes;
  }
  for (const Variable &variable : variables) {
    if (variable.record && header.records == 0)
      continue;
    const uint64_t before = variable.record ? product(header.records - 1, record_bytes) : 0;
    const uint64_t total = static_cast<uint64_t>(status.st_size);
    if (variable.bytes > total || before > total - variable.bytes || variable.begin > total - variable.bytes - before) {
      fail(TETCAST_ERROR_DATA, "%s: truncated: it has %llu bytes, and its header speaks of more", path,
           static_cast<unsigned long long>(total));
    }
  }
}

} // namespace tcv
