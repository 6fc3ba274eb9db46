// SPDX-License-Identifier: Apache-2.0
#include "wire.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <poll.h>
#include <unistd.h>

#include <vtkBitArray.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

namespace tcv {

// The attributes of VTK that are of use here. An array has a bit for each of them, in this order.
static const int roles[] = {vtkDataSetAttributes::SCALARS, vtkDataSetAttributes::GLOBALIDS,
                            vtkDataSetAttributes::PEDIGREEIDS, vtkDataSetAttributes::HIGHERORDERDEGREES,
                            vtkDataSetAttributes::RATIONALWEIGHTS};

enum : size_t { CHUNK = 1 << 20 };

// ── the program ──

void WireWriter::flush() {
  for (size_t done = 0; done < buffer_.size();) {
    const ssize_t size = write(file_, buffer_.data() + done, buffer_.size() - done);
    if (size < 0 && errno != EINTR)
      _exit(1);
    done += size > 0 ? static_cast<size_t>(size) : 0;
  }
  buffer_.clear();
}

void WireWriter::bytes(const void *data, size_t size) {
  for (const char *at = static_cast<const char *>(data); size > 0;) {
    const size_t part = std::min<size_t>(size, CHUNK);
    buffer_.append(at, part);
    at += part;
    size -= part;
    if (buffer_.size() >= CHUNK)
      flush();
  }
}

void WireWriter::text(const std::string &value) {
  number(static_cast<int64_t>(value.size()));
  bytes(value.data(), value.size());
}

void WireWriter::array(vtkDataArray *given) {
  if (!given)
    return number(-1);
  const auto [entry, is_new] = numbers_.emplace(given, static_cast<int64_t>(numbers_.size()));
  number(entry->second);
  if (!is_new)
    return;
  kept_.push_back(given);
  vtkSmartPointer<vtkDataArray> values = given;
  if (!given->HasStandardMemoryLayout() ||
      given->GetDataType() == VTK_BIT) { // Numbers are sent one after the other, and each has whole bytes.
    const int type = given->GetDataType() == VTK_BIT ? VTK_UNSIGNED_CHAR : given->GetDataType();
    values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    values->DeepCopy(given);
  }
  const int components = values->GetNumberOfComponents();
  const int64_t tuples = values->GetNumberOfTuples();
  number(values->GetDataType());
  number(components);
  number(tuples);
  text(given->GetName() ? given->GetName() : "");
  number(given->HasAComponentName() ? components : 0);
  for (int k = 0; given->HasAComponentName() && k < components; ++k)
    text(given->GetComponentName(k) ? given->GetComponentName(k) : "");
  if (tuples > 0)
    bytes(values->GetVoidPointer(0), static_cast<size_t>(tuples * components * values->GetDataTypeSize()));
}

void WireWriter::arrays(vtkDataSetAttributes *attributes) {
  std::vector<vtkDataArray *> numeric;
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
    if (attributes->GetArray(i))
      numeric.push_back(attributes->GetArray(i));
  }
  number(static_cast<int64_t>(numeric.size()));
  for (vtkDataArray *one : numeric) {
    int64_t bits = 0;
    for (size_t k = 0; k < std::size(roles); ++k)
      bits |= attributes->GetAbstractAttribute(roles[k]) == one ? int64_t{1} << k : 0;
    number(bits);
    array(one);
  }
}

void WireWriter::grid(vtkUnstructuredGrid *grid) {
  array(grid->GetPoints() ? grid->GetPoints()->GetData() : nullptr);
  array(grid->GetCellTypesArray());
  vtkCellArray *cells = grid->GetCells();
  array(cells ? cells->GetOffsetsArray() : nullptr);
  array(cells ? cells->GetConnectivityArray() : nullptr);
  array(grid->GetFaces());
  array(grid->GetFaceLocations());
  arrays(grid->GetPointData());
  arrays(grid->GetCellData());
}

// ── the library ──

size_t WireReader::some(void *data, size_t size) {
  for (bool gone = false;;) {
    pollfd wait = {file_, POLLIN, 0};
    const int ready = poll(&wait, 1, gone ? 0 : 250);
    if (ready < 0 && errno != EINTR)
      throw WireBroken();
    if (ready <= 0) {
      if (gone)
        throw WireBroken();
      gone = ready == 0 && !alive_(process_); // What the program wrote at last has still to be read.
      continue;
    }
    const ssize_t got = read(file_, data, size);
    if (got > 0)
      return static_cast<size_t>(got);
    if (got == 0 || errno != EINTR)
      throw WireBroken();
  }
}

void WireReader::bytes(void *data, size_t size) {
  for (char *to = static_cast<char *>(data); size > 0;) {
    if (at_ == end_ && size >= CHUNK) { // Large arrays are read to where they belong at once.
      const size_t got = some(to, size);
      to += got;
      size -= got;
      continue;
    }
    if (at_ == end_) {
      buffer_.resize(CHUNK);
      at_ = 0;
      end_ = some(buffer_.data(), buffer_.size());
    }
    const size_t part = std::min(size, end_ - at_);
    std::memcpy(to, buffer_.data() + at_, part);
    at_ += part;
    to += part;
    size -= part;
  }
}

WireRecord WireReader::record() {
  char letter;
  bytes(&letter, 1);
  return static_cast<WireRecord>(letter);
}

int64_t WireReader::number() {
  int64_t value;
  bytes(&value, sizeof value);
  return value;
}

double WireReader::real() {
  double value;
  bytes(&value, sizeof value);
  return value;
}

std::string WireReader::text() {
  const int64_t size = number();
  if (size < 0 || size > (1 << 20))
    throw WireBroken();
  std::string value(static_cast<size_t>(size), '\0');
  bytes(&value[0], value.size());
  return value;
}

static bool is_type(int64_t type) {
  return type >= VTK_CHAR && type <= VTK_ID_TYPE ? type != VTK_VOID
                                                 : type >= VTK_SIGNED_CHAR && type <= VTK_UNSIGNED_LONG_LONG;
}

vtkSmartPointer<vtkDataArray> WireReader::array() {
  const int64_t place = number();
  if (place < 0)
    return nullptr;
  if (place < static_cast<int64_t>(arrays_.size()))
    return arrays_[static_cast<size_t>(place)];
  const int64_t type = number(), components = number(), tuples = number();
  if (place != static_cast<int64_t>(arrays_.size()) || !is_type(type) || components < 1 || components > INT32_MAX ||
      tuples < 0)
    throw WireBroken();
  auto result = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(static_cast<int>(type)));
  const auto width = static_cast<int64_t>(result->GetDataTypeSize());
  if (tuples > INT64_MAX / 16 / components)
    throw WireBroken();
  result->SetName(text().c_str());
  result->SetNumberOfComponents(static_cast<int>(components));
  const int64_t names = number();
  for (int64_t k = 0; k < names && k < components; ++k) {
    const std::string name = text();
    if (!name.empty())
      result->SetComponentName(k, name.c_str());
  }
  result->SetNumberOfTuples(tuples);
  if (tuples > 0)
    bytes(result->GetVoidPointer(0), static_cast<size_t>(tuples * components * width));
  arrays_.push_back(result);
  return result;
}

void WireReader::arrays(vtkDataSetAttributes *attributes) {
  for (int64_t count = number(); count > 0; --count) {
    const int64_t bits = number();
    const auto one = array();
    if (!one)
      throw WireBroken();
    const int index = attributes->AddArray(one);
    for (size_t k = 0; k < std::size(roles); ++k) {
      if (bits >> k & 1)
        attributes->SetActiveAttribute(index, roles[k]);
    }
  }
}

static vtkSmartPointer<vtkCellArray> cells_of(vtkDataArray *offsets, vtkDataArray *connectivity) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  if (!offsets || !connectivity || offsets->GetNumberOfTuples() == 0)
    return cells;
  if (offsets->GetNumberOfComponents() != 1 || connectivity->GetNumberOfComponents() != 1 ||
      !cells->SetData(offsets, connectivity))
    throw WireBroken();
  return cells;
}

vtkSmartPointer<vtkUnstructuredGrid> WireReader::grid() {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  const auto coordinates = array(), types = array(), offsets = array(), connectivity = array(), faces = array(),
             starts = array();
  if (coordinates) {
    auto &points = points_[coordinates];
    if (!points) {
      points = vtkSmartPointer<vtkPoints>::New();
      points->SetData(coordinates);
    }
    grid->SetPoints(points);
  }
  auto *const kinds = vtkUnsignedCharArray::SafeDownCast(types);
  if (types && !kinds)
    throw WireBroken();
  if (kinds) {
    grid->SetCells(kinds, cells_of(offsets, connectivity), vtkIdTypeArray::SafeDownCast(starts),
                   vtkIdTypeArray::SafeDownCast(faces));
  }
  arrays(grid->GetPointData());
  arrays(grid->GetCellData());
  return grid;
}

} // namespace tcv
