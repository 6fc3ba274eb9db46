// SPDX-License-Identifier: Apache-2.0
// Choosing one scalar of a dataset.
#include "common.hpp"
#include "dataset.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace tcv;

static const int MAGNITUDE = -1;

struct Selection {
  const Array *array = nullptr;
  int component = MAGNITUDE; // 0 for arrays of one
};

static const Array *find_array(const TetcastDataset *dataset, const std::string &name) {
  for (const Array &array : dataset->arrays) { // point arrays come first
    if (array.name == name) return &array;
  }
  return nullptr;
}

static const Array *default_array(const TetcastDataset *dataset) {
  const auto first = [&](auto &&wanted) -> const Array * {
    const auto found = std::find_if(dataset->arrays.begin(), dataset->arrays.end(), wanted);
    return found == dataset->arrays.end() ? nullptr : &*found;
  };
  const Array *array = first([](const Array &a) { return a.active; });
  if (!array) array = first([](const Array &a) { return a.data->GetNumberOfComponents() == 1 && !a.number; });
  if (!array) array = first([](const Array &a) { return !a.number; });
  return array ? array : first([](const Array &) { return true; });
}

[[noreturn]] static void unknown(const TetcastDataset *dataset, const char *selector) {
  std::string list;
  for (const Array &array : dataset->arrays) {
    list += (list.empty() ? "" : ", ") + array.name + (array.association == TETCAST_CELL ? " (cells" : "");
    const int components = array.data->GetNumberOfComponents();
    if (components > 1) {
      list += (array.association == TETCAST_CELL ? ", " : " (") + std::to_string(components) + " components)";
    } else if (array.association == TETCAST_CELL) {
      list += ")";
    }
  }
  fail(TETCAST_ERROR_ARGUMENT, "%s: has no array '%s'; there are: %s", dataset->path.c_str(), selector, list.c_str());
}

static Selection select(const TetcastDataset *dataset, const char *selector) {
  if (dataset->arrays.empty() && !dataset->only.empty())
    fail(TETCAST_ERROR_ARGUMENT, "%s: has no array '%s'", dataset->path.c_str(), dataset->only.c_str());
  if (dataset->arrays.empty())
    fail(TETCAST_ERROR_DATA, "%s: has no arrays over points or cells", dataset->path.c_str());
  Selection selection;
  selection.array = selector ? find_array(dataset, selector) : default_array(dataset);
  if (selection.array) {
    if (selection.array->data->GetNumberOfComponents() == 1) selection.component = 0;
    return selection;
  }
  const char *colon = std::strrchr(selector, ':');
  if (colon) selection.array = find_array(dataset, std::string(selector, colon));
  if (!selection.array) unknown(dataset, selector);
  const char *part = colon + 1;
  if (std::strcmp(part, "mag") == 0) return selection;
  const int components = selection.array->data->GetNumberOfComponents();
  const size_t digits = std::strspn(part, "0123456789");
  const int number = digits > 0 && digits < 9 && part[digits] == '\0' ? std::stoi(part) : components;
  if (number >= components) {
    fail(TETCAST_ERROR_ARGUMENT, "%s: array '%s' has no component '%s'; there are: 0 to %d and mag",
         dataset->path.c_str(), selection.array->name.c_str(), part, components - 1);
  }
  selection.component = number;
  return selection;
}

static double length_of(const double *values, int count) {
  double sum = 0, largest = 0;
  for (int i = 0; i < count; ++i) {
    sum += values[i] * values[i];
    largest = std::max(largest, std::fabs(values[i]));
  }
  if ((sum > 1e-280 && sum < 1e280) || largest == 0 || !std::isfinite(largest)) return std::sqrt(sum);
  sum = 0; // the squares over- or underflow
  for (int i = 0; i < count; ++i) sum += (values[i] / largest) * (values[i] / largest);
  return largest * std::sqrt(sum);
}

// The selected scalar of every tuple of the file, as double.
static std::vector<double> computed(const Selection &selection) {
  vtkDataArray *data = selection.array->data;
  const int components = data->GetNumberOfComponents();
  std::vector<double> tuple(static_cast<size_t>(components)), values(static_cast<size_t>(data->GetNumberOfTuples()));
  for (size_t i = 0; i < values.size(); ++i) {
    data->GetTuple(static_cast<vtkIdType>(i), tuple.data());
    values[i] = selection.component == MAGNITUDE ? length_of(tuple.data(), components)
                                                 : tuple[static_cast<size_t>(selection.component)];
  }
  return values;
}

// What the cells that use each point have on average: the selected scalar of a cell array, as one of points. Those that no cell uses get
// the value of another: they are not drawn, and no value is missing.
static std::vector<double> averaged(const TetcastDataset *dataset, const Selection &selection) {
  vtkDataArray *data = selection.array->data;
  const bool whole = selection.component == MAGNITUDE;
  const int first = whole ? 0 : selection.component, components = whole ? data->GetNumberOfComponents() : 1;
  const auto width = static_cast<size_t>(components);
  const auto points = static_cast<size_t>(dataset->points->GetNumberOfTuples() - dataset->tetrahedra.info.added_vertices);
  std::vector<double> sums(points * width), tuple(width);
  std::vector<int32_t> counts(points);
  std::vector<int64_t> last(points, -1); // the cell that was there last: some have a point twice
  for (vtkIdType cell = 0; cell < data->GetNumberOfTuples(); ++cell) {
    if (!is_volume(dataset->types->GetValue(cell))) continue;
    for (int k = 0; k < components; ++k) tuple[static_cast<size_t>(k)] = data->GetComponent(cell, first + k);
    const bool finite = std::all_of(tuple.begin(), tuple.end(), [](double value) { return std::isfinite(value); });
    vtkIdType size;
    const vtkIdType *corners;
    dataset->corners->GetCellAtId(cell, size, corners);
    for (vtkIdType j = 0; j < size; ++j) {
      const auto point = static_cast<size_t>(corners[j]);
      if (last[point] == cell) continue;
      last[point] = cell;
      if (!finite) continue;
      ++counts[point];
      for (size_t k = 0; k < width; ++k) sums[point * width + k] += tuple[k];
    }
  }
  std::vector<double> values(points);
  double other = 0;
  for (size_t i = points; i-- > 0;) {
    for (size_t k = 0; k < width; ++k) tuple[k] = sums[i * width + k] / counts[i]; // NaN where there are none
    values[i] = whole ? length_of(tuple.data(), components) : tuple[0];
    if (counts[i] > 0) other = values[i];
  }
  for (size_t i = 0; i < points; ++i) values[i] = last[i] < 0 ? other : values[i];
  return values;
}

// The value of its cell for each tetrahedron.
static std::vector<char> gathered(const TetcastArray &values, const TetcastArray &sources) {
  const size_t size = static_cast<size_t>(type_size(values.type));
  const size_t stride = values.stride ? static_cast<size_t>(values.stride) : size;
  const auto *source = static_cast<const int32_t *>(sources.data);
  std::vector<char> result(static_cast<size_t>(sources.count) * size);
  for (size_t i = 0; i < static_cast<size_t>(sources.count); ++i) {
    std::memcpy(&result[i * size], static_cast<const char *>(values.data) + static_cast<size_t>(source[i]) * stride,
                size);
  }
  return result;
}

// The values of all vertices, those that cutting added last: float stays float, anything else becomes double.
static std::vector<char> extended(const TetcastArray &values, const Tetrahedra &tetrahedra) {
  const size_t count = static_cast<size_t>(values.count), added = static_cast<size_t>(tetrahedra.info.added_vertices);
  const size_t size = static_cast<size_t>(type_size(values.type)), stride = static_cast<size_t>(values.stride);
  std::vector<double> more(added);
  tetcast_cut_interpolate(tetrahedra.cut.get(), &values, 1, more.data());
  std::vector<char> result((count + added) * size);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(&result[i * size], static_cast<const char *>(values.data) + i * stride, size);
  }
  for (size_t i = 0; i < added; ++i) {
    const float single = static_cast<float>(more[i]);
    const void *value = values.type == TETCAST_TYPE_FLOAT32 ? static_cast<const void *>(&single) : &more[i];
    std::memcpy(&result[(count + i) * size], value, size);
  }
  return result;
}

static TetcastStatus make_field(const TetcastDataset *dataset, const Selection &selection, TetcastField **field) {
  TetcastFieldDesc desc = tetcast_field_desc_default();
  const bool average = selection.array->association == TETCAST_CELL && dataset->corners;
  desc.association = average ? TETCAST_POINT : selection.array->association;
  desc.ownership = TETCAST_BORROW;
  vtkDataArray *data = selection.array->data;
  std::vector<double> values;
  const bool extend = desc.association == TETCAST_POINT && dataset->tetrahedra.info.added_vertices > 0;
  const TetcastType type = type_of(data);
  const bool real = type == TETCAST_TYPE_FLOAT32 || type == TETCAST_TYPE_FLOAT64;
  if (!average && type != TETCAST_TYPE_NONE && selection.component != MAGNITUDE && (real || !extend)) {
    desc.values = view_of(data);
    const int64_t size = type_size(desc.values.type);
    desc.values.stride = size * data->GetNumberOfComponents();
    desc.values.data = static_cast<const char *>(desc.values.data) + size * selection.component;
  } else {
    values = average ? averaged(dataset, selection) : computed(selection);
    desc.values.data = values.data();
    desc.values.type = TETCAST_TYPE_FLOAT64;
    desc.values.stride = sizeof(double);
    desc.values.count = static_cast<int64_t>(values.size());
    desc.ownership = TETCAST_COPY;
  }
  std::vector<char> made;
  if (extend || (desc.association == TETCAST_CELL && dataset->tetrahedra.connectivity == nullptr)) {
    made = extend ? extended(desc.values, dataset->tetrahedra) : gathered(desc.values, dataset->tetrahedra.source);
    desc.values.data = made.data();
    desc.values.count = extend ? desc.values.count + dataset->tetrahedra.info.added_vertices : dataset->tetrahedra.view.count;
    desc.values.stride = 0;
    desc.ownership = TETCAST_COPY;
  }
  return tetcast_field_create(dataset->context, &desc, field);
}

static const char *kept_name(const TetcastDataset *dataset, const Selection &selection, bool whole) {
  std::string name = selection.array->name;
  if (!whole) name += selection.component == MAGNITUDE ? ":mag" : ":" + std::to_string(selection.component);
  const std::lock_guard<std::mutex> lock(dataset->mutex);
  return dataset->selectors.insert(name).first->c_str();
}

TetcastStatus tetcast_dataset_field(const TetcastDataset *dataset, const char *selector, TetcastField **field,
                                    const char **name) {
  if (field) *field = nullptr;
  if (name) *name = nullptr;
  if (!dataset || !field) {
    return tetcast_context_error(dataset ? dataset->context : nullptr, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_field: dataset and field must not be NULL");
  }
  TetcastStatus status = TETCAST_OK;
  const TetcastStatus thrown = fence(dataset->context, dataset->path.c_str(), [&] {
    const Selection selection = select(dataset, selector);
    const char *kept = kept_name(dataset, selection, !selector || selection.array->name == selector);
    status = make_field(dataset, selection, field);
    if (name && status == TETCAST_OK) *name = kept;
  });
  return thrown ? thrown : status;
}
