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
  int component = MAGNITUDE; // It is 0 for an array of one component.
  bool whole = true;         // True if the selector says nothing about components.
};

static double scalar_of(vtkDataArray *data, vtkIdType tuple, int component);

// ── the array drawn when none is named ──

// Returns whether the numbers that would be drawn of an array differ from each other.
static bool varies(const TetcastDataset *dataset, const Array &array) {
  const int component = array.data->GetNumberOfComponents() == 1 ? 0 : MAGNITUDE;
  const auto *cells =
      static_cast<const int32_t *>(array.association == TETCAST_CELL ? dataset->tetrahedra.source.data : nullptr);
  const vtkIdType count = cells ? dataset->tetrahedra.source.count : array.data->GetNumberOfTuples();
  double first = std::nan("");
  for (vtkIdType i = 0; i < count; ++i) {
    const double value = scalar_of(array.data, cells ? cells[i] : i, component);
    if (!std::isfinite(value))
      continue;
    if (std::isnan(first))
      first = value;
    if (value != first)
      return true;
  }
  return false;
}

// Returns the array that is drawn if none is named. The active scalars come first. Without them, arrays that vary come
// before constant ones, arrays of points before arrays of cells, and scalars before vectors. Arrays that number points
// or cells come last.
static const Array *default_array(const TetcastDataset *dataset) {
  const Array *best = nullptr;
  int best_rank = 0;
  for (const Array &array : dataset->arrays) {
    if (array.active && array.data->GetNumberOfComponents() == 1)
      return &array;
    const bool shows = !array.number && varies(dataset, array);
    const int rank = 1 + 8 * !array.number + 4 * shows + 2 * (array.association == TETCAST_POINT) +
                     (array.data->GetNumberOfComponents() == 1);
    if (rank > best_rank)
      best = &array;
    best_rank = std::max(rank, best_rank);
  }
  return best;
}

// ── the one that is named ──

// What a selector may say behind the name of the array. Both are empty if it does not.
struct Suffixes {
  std::string association, component; // Empty if nothing is said.
};

static const Array *find_array(const TetcastDataset *dataset, const std::string &name, const std::string &association) {
  for (const Array &array : dataset->arrays) { // Arrays of points come first.
    if (array.name == name && (association.empty() || association == word_of(array.association)))
      return &array;
  }
  return nullptr;
}

// Returns the array with the longest name that the selector begins with, and what the selector says behind the name.
static const Array *find_named(const TetcastDataset *dataset, const std::string &selector, Suffixes *suffixes) {
  std::string name = selector;
  for (;;) {
    const Array *array = find_array(dataset, name, suffixes->association);
    if (array)
      return array;
    const size_t colon = name.rfind(':');
    if (colon == std::string::npos)
      return nullptr;
    const std::string suffix = name.substr(colon + 1);
    if ((suffix == "point" || suffix == "cell") && suffixes->association.empty())
      suffixes->association = suffix;
    else if (suffixes->component.empty() && !suffix.empty())
      suffixes->component = suffix;
    else
      return nullptr;
    name.resize(colon);
  }
}

// Fails with a message that lists the arrays there are, or says why the array that is named can't be read.
[[noreturn]] static void unknown(const TetcastDataset *dataset, const std::string &selector) {
  std::string list; // It names all arrays that there are.
  for (const Array &array : dataset->arrays) {
    const int components = array.data->GetNumberOfComponents();
    std::string about = array.association == TETCAST_CELL ? "cells" : "";
    if (components > 1)
      about += (about.empty() ? "" : ", ") + std::to_string(components) + " components";
    list += (list.empty() ? "" : ", ") + array.name + (about.empty() ? "" : " (" + about + ")");
  }
  for (const UnreadArray &one : dataset->unread) {
    const bool cells = one.array.association == TETCAST_CELL;
    const char *about =
        one.reason.empty() ? (cells ? " (cells)" : "") : (cells ? " (cells, can't be read)" : " (can't be read)");
    list += (list.empty() ? "" : ", ") + one.array.name + about;
    if (one.reason.empty() || !may_name(selector.c_str(), one.array.name))
      continue;
    fail(TETCAST_ERROR_DATA, "%s: %s array '%s' can't be read: %s", dataset->path.c_str(),
         word_of(one.array.association), one.array.name.c_str(), one.reason.c_str());
  }
  if (list.empty())
    fail(TETCAST_ERROR_DATA, "%s: has no arrays over points or cells", dataset->path.c_str());
  fail(TETCAST_ERROR_ARGUMENT, "%s: has no array '%s'; there are: %s", dataset->path.c_str(), selector.c_str(),
       list.c_str());
}

static std::string lower_case(std::string text) {
  for (char &c : text)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// Returns the names of an array's components: those that the file gives, or else the usual ones. The list is empty if
// there are neither.
static std::vector<std::string> component_names(vtkDataArray *data) {
  static const std::vector<std::string> usual[] = {{"x", "y"},
                                                   {"x", "y", "z"},
                                                   {"xx", "yy", "zz", "xy", "yz", "xz"},
                                                   {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"}};
  const auto components = static_cast<size_t>(data->GetNumberOfComponents());
  std::vector<std::string> names(components);
  bool any = false;
  for (size_t k = 0; data->HasAComponentName() && k < components; ++k) {
    const char *name = data->GetComponentName(static_cast<vtkIdType>(k));
    if (name)
      names[k] = lower_case(name);
    any = any || name;
  }
  for (const auto &set : usual) {
    if (!any && set.size() == components)
      return set;
  }
  return any ? names : std::vector<std::string>();
}

// Returns the component that a suffix stands for. The suffix is a number, a name in upper or lower case, or "mag".
static int find_component(const TetcastDataset *dataset, const Array &array, const std::string &part) {
  if (part == "mag")
    return MAGNITUDE;
  const int components = array.data->GetNumberOfComponents();
  const bool digits = part.size() < 9 && part.find_first_not_of("0123456789") == std::string::npos;
  if (digits && std::stoi(part) < components)
    return std::stoi(part);
  std::string list;
  const auto names = component_names(array.data);
  for (size_t k = 0; k < names.size(); ++k) {
    if (names[k] == lower_case(part))
      return static_cast<int>(k);
    list += (k ? ", " : " (") + names[k];
  }
  fail(TETCAST_ERROR_ARGUMENT, "%s: array '%s' has no component '%s'; there are: 0 to %d%s and mag",
       dataset->path.c_str(), array.name.c_str(), part.c_str(), components - 1,
       list.empty() ? "" : (list + ")").c_str());
}

static Selection select(const TetcastDataset *dataset, const char *selector) {
  Selection selection;
  Suffixes suffixes;
  selection.array = selector ? find_named(dataset, selector, &suffixes) : default_array(dataset);
  if (!selection.array)
    unknown(dataset, selector ? selector : "");
  if (!suffixes.component.empty())
    selection.component = find_component(dataset, *selection.array, suffixes.component);
  else if (selection.array->data->GetNumberOfComponents() == 1)
    selection.component = 0;
  selection.whole = suffixes.component.empty();
  return selection;
}

static double length_of(const double *values, int count) {
  double sum = 0, largest = 0;
  for (int i = 0; i < count; ++i) {
    sum += values[i] * values[i];
    largest = std::max(largest, std::fabs(values[i]));
  }
  if ((sum > 1e-280 && sum < 1e280) || largest == 0 || !std::isfinite(largest))
    return std::sqrt(sum);
  sum = 0; // The sum of squares has overflowed or underflowed, so it is found again from scaled numbers.
  for (int i = 0; i < count; ++i)
    sum += (values[i] / largest) * (values[i] / largest);
  return largest * std::sqrt(sum);
}

static double scalar_of(vtkDataArray *data, vtkIdType tuple, int component) {
  if (component != MAGNITUDE)
    return data->GetComponent(tuple, component);
  const int components = data->GetNumberOfComponents();
  double few[9];
  std::vector<double> many(components > 9 ? static_cast<size_t>(components) : 0);
  double *values = components > 9 ? many.data() : few;
  data->GetTuple(tuple, values);
  return length_of(values, components);
}

// Returns the selected scalar of every tuple of the array in the file, as double.
static std::vector<double> computed(const Selection &selection) {
  vtkDataArray *data = selection.array->data;
  std::vector<double> values(static_cast<size_t>(data->GetNumberOfTuples()));
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = scalar_of(data, static_cast<vtkIdType>(i), selection.component);
  return values;
}

// Turns the selected scalar of a cell array into one of points: each point gets the mean over the cells that use it.
// Points that no cell uses get the value of some other point. As they are not drawn, any value will do, and so no value
// counts as missing.
static std::vector<double> averaged(const TetcastDataset *dataset, const Selection &selection) {
  vtkDataArray *data = selection.array->data;
  const bool whole = selection.component == MAGNITUDE;
  const int first = whole ? 0 : selection.component, components = whole ? data->GetNumberOfComponents() : 1;
  const auto width = static_cast<size_t>(components);
  const auto points =
      static_cast<size_t>(dataset->points->GetNumberOfTuples() - dataset->tetrahedra.info.added_vertices);
  std::vector<double> sums(points * width), tuple(width);
  std::vector<int32_t> counts(points);
  std::vector<int64_t> last(points, -1); // The cell that was at each point last, because some cells list a point twice.
  for (vtkIdType cell = 0; cell < data->GetNumberOfTuples(); ++cell) {
    if (!is_volume(dataset->types->GetValue(cell)))
      continue;
    for (int k = 0; k < components; ++k)
      tuple[static_cast<size_t>(k)] = data->GetComponent(cell, first + k);
    const bool finite = std::all_of(tuple.begin(), tuple.end(), [](double value) { return std::isfinite(value); });
    vtkIdType size;
    const vtkIdType *corners;
    dataset->corners->GetCellAtId(cell, size, corners);
    for (vtkIdType j = 0; j < size; ++j) {
      const auto point = static_cast<size_t>(corners[j]);
      if (last[point] == cell)
        continue;
      last[point] = cell;
      if (!finite)
        continue;
      ++counts[point];
      for (size_t k = 0; k < width; ++k)
        sums[point * width + k] += tuple[k];
    }
  }
  std::vector<double> values(points);
  double other = 0;
  for (size_t i = points; i-- > 0;) {
    for (size_t k = 0; k < width; ++k)
      tuple[k] = sums[i * width + k] / counts[i]; // This is NaN if no cell uses the point.
    values[i] = whole ? length_of(tuple.data(), components) : tuple[0];
    if (counts[i] > 0)
      other = values[i];
  }
  for (size_t i = 0; i < points; ++i)
    values[i] = last[i] < 0 ? other : values[i];
  return values;
}

// Returns, for each tetrahedron, the value of the cell that it was cut from.
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

// Returns the values of all vertices, the last of which are those that cutting has added. Values of type float stay
// float, and all others become double.
static std::vector<char> extended(const TetcastArray &values, const Tetrahedra &tetrahedra) {
  const size_t count = static_cast<size_t>(values.count), added = static_cast<size_t>(tetrahedra.info.added_vertices);
  const size_t size = static_cast<size_t>(type_size(values.type)), stride = static_cast<size_t>(values.stride);
  std::vector<double> more(added);
  tetcast_cut_interpolate(tetrahedra.cut, &values, 1, more.data());
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
    desc.values.count =
        extend ? desc.values.count + dataset->tetrahedra.info.added_vertices : dataset->tetrahedra.view.count;
    desc.values.stride = 0;
    desc.ownership = TETCAST_COPY;
  }
  return tetcast_field_create(dataset->context, &desc, field);
}

static const char *kept_name(const TetcastDataset *dataset, const Selection &selection) {
  std::string name = selection.array->selector;
  if (!selection.whole)
    name += selection.component == MAGNITUDE ? ":mag" : ":" + std::to_string(selection.component);
  const std::lock_guard<std::mutex> lock(dataset->mutex);
  return dataset->selectors.insert(name).first->c_str();
}

TetcastStatus tetcast_dataset_field(const TetcastDataset *dataset, const char *selector, TetcastField **field,
                                    const char **name) {
  if (field)
    *field = nullptr;
  if (name)
    *name = nullptr;
  if (!dataset || !field) {
    return tetcast_context_error(dataset ? dataset->context : nullptr, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_field: dataset and field must not be NULL");
  }
  TetcastStatus status = TETCAST_OK;
  const TetcastStatus thrown = fence(dataset->context, dataset->path.c_str(), [&] {
    const Selection selection = select(dataset, selector);
    const char *kept = kept_name(dataset, selection);
    status = make_field(dataset, selection, field);
    if (name && status == TETCAST_OK)
      *name = kept;
  });
  return thrown ? thrown : status;
}
