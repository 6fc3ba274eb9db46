// SPDX-License-Identifier: Apache-2.0
// Reads VTKHDF: images, and unstructured grids in parts, with time steps or without. It uses the HDF5 library, because
// the reader of VTK 9.1 knows of no steps, and refuses a file if it does not know the type of one array. The format is
// described at docs.vtk.org, "VTKHDF format specification".
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkMultiPieceDataSet.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtk_hdf5.h>

#include "common.hpp"
#include "source.hpp"

namespace {

// An object of HDF5 that is closed in the end.
class Handle {
public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0)
      close_(id_);
  }
  Handle(const Handle &) = delete;
  Handle &operator=(const Handle &) = delete;
  operator hid_t() const { return id_; }
  bool is_there() const { return id_ >= 0; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

using Sizes = std::vector<hsize_t>;

Sizes sizes_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = space.is_there() ? H5Sget_simple_extent_ndims(space) : -1;
  Sizes sizes(static_cast<size_t>(std::max(rank, 0)));
  if (rank > 0)
    H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return sizes;
}

bool has_link(hid_t where, const std::string &name) {
  return H5Lexists(where, name.c_str(), H5P_DEFAULT) > 0;
}

// Returns the type in memory for values of the type in the file, or VTK_VOID if there is none. Half precision becomes
// single precision, and false and true become 0 and 1.
struct Memory {
  int vtk;
  hid_t type;
};

Memory memory_of(hid_t file_type) {
  switch (H5Tget_class(file_type)) {
  case H5T_FLOAT:
    return H5Tget_size(file_type) <= 4 ? Memory{VTK_FLOAT, H5T_NATIVE_FLOAT} : Memory{VTK_DOUBLE, H5T_NATIVE_DOUBLE};
  case H5T_ENUM: {
    const Handle base(H5Tget_super(file_type), H5Tclose);
    return base.is_there() ? memory_of(base) : Memory{VTK_VOID, -1};
  }
  case H5T_INTEGER: {
    const bool is_signed = H5Tget_sign(file_type) != H5T_SGN_NONE;
    switch (H5Tget_size(file_type)) {
    case 1:
      return is_signed ? Memory{VTK_SIGNED_CHAR, H5T_NATIVE_SCHAR} : Memory{VTK_UNSIGNED_CHAR, H5T_NATIVE_UCHAR};
    case 2:
      return is_signed ? Memory{VTK_SHORT, H5T_NATIVE_SHORT} : Memory{VTK_UNSIGNED_SHORT, H5T_NATIVE_USHORT};
    case 3:
    case 4:
      return is_signed ? Memory{VTK_INT, H5T_NATIVE_INT} : Memory{VTK_UNSIGNED_INT, H5T_NATIVE_UINT};
    case 5:
    case 6:
    case 7:
    case 8:
      return is_signed ? Memory{VTK_LONG_LONG, H5T_NATIVE_LLONG} : Memory{VTK_UNSIGNED_LONG_LONG, H5T_NATIVE_ULLONG};
    default:
      return {VTK_VOID, -1};
    }
  }
  default:
    return {VTK_VOID, -1};
  }
}

// Why an array, or something that is needed, can't be read.
struct Unreadable {
  std::string reason;
};

// Returns whether the file has as much data as a dataset claims. A filter can make a thousand values of a byte, but no
// more.
bool is_stored(hid_t dataset, uint64_t bytes) {
  const Handle settings(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = settings.is_there() ? H5Pget_layout(settings) : H5D_LAYOUT_ERROR;
  if (layout != H5D_CHUNKED && layout != H5D_CONTIGUOUS)
    return layout != H5D_LAYOUT_ERROR; // The data are compact, or in other files.
  if (layout == H5D_CONTIGUOUS && H5Pget_external_count(settings) > 0)
    return true;
  return bytes / 4096 <= H5Dget_storage_size(dataset) || bytes <= 65536;
}

// Reads the tuples [start, start + count) of a dataset. As many of its first dimensions as `start` has are those of the
// tuples, x last; the others are components.
vtkSmartPointer<vtkDataArray> read_tuples(hid_t where, const std::string &name, const Sizes &start,
                                          const Sizes &count) {
  const Handle dataset(has_link(where, name) ? H5Dopen2(where, name.c_str(), H5P_DEFAULT) : -1, H5Dclose);
  if (!dataset.is_there())
    throw Unreadable{"there is no such dataset"};
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const Memory memory = type.is_there() ? memory_of(type) : Memory{VTK_VOID, -1};
  if (memory.vtk == VTK_VOID)
    throw Unreadable{"its values are no numbers"};
  const Sizes sizes = sizes_of(dataset);
  if (sizes.size() < count.size() || sizes.size() > count.size() + 1)
    throw Unreadable{"it has " + std::to_string(sizes.size()) + " dimensions"};
  Sizes from = start, extent = count;
  const hsize_t components = sizes.size() > count.size() ? sizes.back() : 1;
  if (sizes.size() > count.size()) {
    from.push_back(0);
    extent.push_back(components);
  }
  uint64_t tuples = 1;
  for (size_t k = 0; k < count.size(); ++k) {
    if (start[k] > sizes[k] || count[k] > sizes[k] - start[k])
      throw Unreadable{"it has fewer values than it should"};
    if (count[k] != 0 && tuples > INT64_MAX / 64 / count[k])
      throw Unreadable{"it claims more values than there can be"};
    tuples *= count[k];
  }
  if (components < 1 || components > INT32_MAX || (tuples != 0 && components > INT64_MAX / 64 / tuples))
    throw Unreadable{"it claims " + std::to_string(components) + " components"};
  auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(memory.vtk));
  if (!is_stored(dataset, tuples * components * static_cast<uint64_t>(values->GetDataTypeSize())))
    throw Unreadable{"it claims more values than there is data"};
  values->SetName(name.substr(name.rfind('/') + 1).c_str());
  values->SetNumberOfComponents(static_cast<int>(components));
  values->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  if (tuples == 0)
    return values;
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const Handle target(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, extent.data(), nullptr) < 0 ||
      H5Dread(dataset, memory.type, target, space, H5P_DEFAULT, values->GetVoidPointer(0)) < 0) {
    throw Unreadable{"the HDF5 library fails on it"};
  }
  return values;
}

class Hdf : public tcv::Source {
public:
  bool open(const std::string &path) override;
  std::vector<double> times() override;
  std::vector<tcv::ArrayName> arrays() override;
  void enable(const tcv::ArrayName &array, bool on) override;
  vtkSmartPointer<vtkDataObject> read(int64_t step) override;

private:
  [[noreturn]] void damaged(const std::string &what, const std::string &why) const {
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s: %s", path_.c_str(), what.c_str(), why.c_str());
  }
  // Reads what has to be there, and fails if that is not possible.
  vtkSmartPointer<vtkDataArray> needed(const std::string &name, hsize_t start, hsize_t count) const {
    try {
      return read_tuples(root(), name, {start}, {count});
    } catch (const Unreadable &unreadable) {
      damaged(name, unreadable.reason);
    }
  }
  std::vector<int64_t> integers(const std::string &name, hsize_t start, hsize_t count) const;
  int64_t step_integer(const std::string &name, int64_t step, int64_t otherwise) const;
  template <size_t N> std::array<double, N> attribute(const char *name, const std::array<double, N> &otherwise) const;
  void add_arrays(vtkDataSet *dataset, int64_t step,
                  const std::function<void(TetcastAssociation, Sizes *, Sizes *)> &place);
  vtkSmartPointer<vtkDataObject> read_image(int64_t step);
  vtkSmartPointer<vtkDataObject> read_grid(int64_t step);
  vtkSmartPointer<vtkCellArray> read_cells(hsize_t cells, hsize_t ids, hsize_t connectivity,
                                           const std::vector<hsize_t> &starts) const;
  hid_t root() const { return *root_; }
  bool has_steps() const { return !times_.empty(); }

  std::string path_, type_;
  std::unique_ptr<Handle> file_, root_;
  std::vector<double> times_;
  std::vector<tcv::ArrayName> wanted_;
};

// ── what there is ──

std::string text_attribute(hid_t where, const char *name) {
  const Handle attribute(H5Aexists(where, name) > 0 ? H5Aopen(where, name, H5P_DEFAULT) : -1, H5Aclose);
  const Handle type(attribute.is_there() ? H5Aget_type(attribute) : -1, H5Tclose);
  if (!type.is_there() || H5Tget_class(type) != H5T_STRING)
    return "";
  if (H5Tis_variable_str(type) > 0) {
    char *text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || !text)
      return "";
    const std::string result = text;
    H5free_memory(text);
    return result;
  }
  std::string text(std::min<size_t>(H5Tget_size(type), 4096), '\0');
  if (text.size() != H5Tget_size(type) || text.empty() || H5Aread(attribute, type, &text[0]) < 0)
    return "";
  return text.substr(0, text.find('\0'));
}

bool Hdf::open(const std::string &path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  path_ = path;
  file_ = std::make_unique<Handle>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file_->is_there() || !has_link(*file_, "VTKHDF"))
    return false;
  root_ = std::make_unique<Handle>(H5Gopen2(*file_, "VTKHDF", H5P_DEFAULT), H5Gclose);
  if (!root_->is_there())
    return false;
  type_ = text_attribute(root(), "Type");
  while (!type_.empty() && type_.back() == ' ')
    type_.pop_back();
  if (type_ == "UnstructuredGrid" || type_ == "ImageData")
    return true;
  if (type_.empty())
    damaged("attribute Type", "can't be read");
  if (type_ == "PolyData") {
    tcv::fail(TETCAST_ERROR_DATA, "%s: holds PolyData, not a volume mesh: a surface", path.c_str());
  }
  tcv::fail(TETCAST_ERROR_UNSUPPORTED,
            "%s: holds a %s, which is not read from VTKHDF files: only UnstructuredGrid and ImageData are",
            path.c_str(), type_.c_str());
}

std::vector<double> Hdf::times() {
  if (!has_link(root(), "Steps"))
    return {};
  const Handle steps(H5Gopen2(root(), "Steps", H5P_DEFAULT), H5Gclose);
  const Handle dataset(steps.is_there() && has_link(steps, "Values") ? H5Dopen2(steps, "Values", H5P_DEFAULT) : -1,
                       H5Dclose);
  const Sizes sizes = dataset.is_there() ? sizes_of(dataset) : Sizes();
  if (sizes.size() != 1 || sizes[0] == 0)
    damaged("Steps/Values", "is not a list of times");
  const auto values = needed("Steps/Values", 0, sizes[0]);
  times_.clear();
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
    times_.push_back(values->GetComponent(i, 0));
  return times_;
}

std::vector<tcv::ArrayName> Hdf::arrays() {
  std::vector<tcv::ArrayName> names;
  for (const TetcastAssociation association : {TETCAST_POINT, TETCAST_CELL}) {
    const char *group = association == TETCAST_POINT ? "PointData" : "CellData";
    const Handle data(has_link(root(), group) ? H5Gopen2(root(), group, H5P_DEFAULT) : -1, H5Gclose);
    H5G_info_t about;
    if (!data.is_there() || H5Gget_info(data, &about) < 0)
      continue;
    for (hsize_t i = 0; i < about.nlinks; ++i) {
      char name[4096];
      if (H5Lget_name_by_idx(data, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT) > 0)
        names.push_back({association, name});
    }
  }
  return names;
}

void Hdf::enable(const tcv::ArrayName &array, bool on) {
  const auto found = std::find(wanted_.begin(), wanted_.end(), array);
  if (found != wanted_.end())
    wanted_.erase(found);
  if (on)
    wanted_.push_back(array);
}

// ── numbers ──

std::vector<int64_t> Hdf::integers(const std::string &name, hsize_t start, hsize_t count) const {
  const auto values = needed(name, start, count);
  std::vector<int64_t> result;
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
    const double value = values->GetComponent(i, 0);
    if (!(value >= 0 && value < 9e15))
      damaged(name, "has a count that is none");
    result.push_back(static_cast<int64_t>(value));
  }
  return result;
}

// Reads the number of one step from a list that may be missing.
int64_t Hdf::step_integer(const std::string &name, int64_t step, int64_t otherwise) const {
  const std::string path = "Steps/" + name;
  for (size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1)) {
    if (!has_link(root(), path.substr(0, slash)))
      return otherwise;
  }
  return has_link(root(), path) ? integers(path, static_cast<hsize_t>(step), 1)[0] : otherwise;
}

template <size_t N>
std::array<double, N> Hdf::attribute(const char *name, const std::array<double, N> &otherwise) const {
  const Handle attribute(H5Aexists(root(), name) > 0 ? H5Aopen(root(), name, H5P_DEFAULT) : -1, H5Aclose);
  if (!attribute.is_there())
    return otherwise;
  const Handle space(H5Aget_space(attribute), H5Sclose);
  std::array<double, N> values;
  if (H5Sget_simple_extent_npoints(space) != N || H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()) < 0)
    damaged(name, "is not of the size it should be");
  return values;
}

// ── datasets ──

// Adds the arrays. `place` says where the tuples of an array begin, and how many there are.
void Hdf::add_arrays(vtkDataSet *dataset, int64_t step,
                     const std::function<void(TetcastAssociation, Sizes *, Sizes *)> &place) {
  for (const tcv::ArrayName &array : wanted_) {
    const bool of_points = array.association == TETCAST_POINT;
    const std::string name = (of_points ? "PointData/" : "CellData/") + array.name;
    Sizes start, count;
    place(array.association, &start, &count);
    try {
      if (has_steps()) { // The file says where the values of this step begin, or of which step they are.
        const int64_t shift =
            step_integer((of_points ? "PointDataOffsets/" : "CellDataOffsets/") + array.name, step, -1);
        if (shift >= 0)
          start[0] += static_cast<hsize_t>(shift);
        else if (type_ == "ImageData")
          start[0] = static_cast<hsize_t>(step);
        else
          start[0] += static_cast<hsize_t>(step_integer(of_points ? "PointOffsets" : "CellOffsets", step, 0));
      }
      vtkSmartPointer<vtkDataArray> values;
      try {
        values = read_tuples(root(), name, start, count);
      } catch (const Unreadable &) {
        if (!has_steps() || type_ != "ImageData")
          throw;
        values = read_tuples(root(), name, {start.begin() + 1, start.end()},
                             {count.begin() + 1, count.end()}); // The values are the same for all steps.
      }
      (of_points ? static_cast<vtkDataSetAttributes *>(dataset->GetPointData()) : dataset->GetCellData())
          ->AddArray(values);
    } catch (const Unreadable &error) {
      tcv::note_unread(&unreadable, array, error.reason);
    }
  }
}

vtkSmartPointer<vtkDataObject> Hdf::read_image(int64_t step) {
  const auto extent = attribute<6>("WholeExtent", {1, 0, 1, 0, 1, 0});
  const auto origin = attribute<3>("Origin", {0, 0, 0}), spacing = attribute<3>("Spacing", {1, 1, 1});
  const auto direction = attribute<9>("Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1});
  int whole[6];
  double points = 1;
  for (size_t k = 0; k < 6; ++k) {
    if (!(extent[k] > -1e9 && extent[k] < 1e9))
      damaged("WholeExtent", "is beyond all bounds");
    whole[k] = static_cast<int>(extent[k]);
    points *= k % 2 ? extent[k] - extent[k - 1] + 1 : 1;
  }
  if (!(points >= 1))
    damaged("WholeExtent", "is of no points");
  if (points > 4096.0 * static_cast<double>(tcv::file_size(path_.c_str())))
    damaged("WholeExtent", "is of more points than the file can hold");
  vtkNew<vtkImageData> image;
  image->SetExtent(whole);
  image->SetOrigin(origin[0], origin[1], origin[2]);
  image->SetSpacing(spacing[0], spacing[1], spacing[2]);
  image->SetDirectionMatrix(direction.data());
  add_arrays(image, step, [&](TetcastAssociation association, Sizes *start, Sizes *count) {
    if (has_steps()) { // The first dimension is time.
      start->push_back(0);
      count->push_back(1);
    }
    for (int k = 2; k >= 0; --k) {
      const int length = whole[2 * k + 1] - whole[2 * k] + (association == TETCAST_POINT);
      start->push_back(0);
      count->push_back(static_cast<hsize_t>(std::max(length, association == TETCAST_POINT ? 0 : 1)));
    }
  });
  return image;
}

// Reads the cells. The list of offsets begins anew in each part, and has one number more than the part has cells. Where
// the list of a part begins so depends on the number of parts before it, which programs count differently if the mesh
// stays the same for several steps. Of the candidates in `starts`, the one whose numbers fit is right.
vtkSmartPointer<vtkCellArray> Hdf::read_cells(hsize_t cells, hsize_t ids, hsize_t connectivity,
                                              const std::vector<hsize_t> &starts) const {
  auto list = vtkSmartPointer<vtkCellArray>::New();
  vtkNew<vtkIdTypeArray> corners;
  corners->DeepCopy(needed("Connectivity", connectivity, ids));
  for (const hsize_t start : starts) {
    vtkNew<vtkIdTypeArray> ends;
    try {
      ends->DeepCopy(read_tuples(root(), "Offsets", {start}, {cells + 1}));
    } catch (const Unreadable &unreadable) {
      if (start == starts.back())
        damaged("Offsets", unreadable.reason);
      continue;
    }
    const vtkIdType *end = ends->GetPointer(0);
    if (end[0] != 0 || end[cells] != static_cast<vtkIdType>(ids) || !std::is_sorted(end, end + cells + 1))
      continue;
    list->SetData(ends, corners);
    return list;
  }
  damaged("Offsets", "they don't fit the list of the cells' points");
}

vtkSmartPointer<vtkDataObject> Hdf::read_grid(int64_t step) {
  const Handle dataset(has_link(root(), "NumberOfCells") ? H5Dopen2(root(), "NumberOfCells", H5P_DEFAULT) : -1,
                       H5Dclose);
  const Sizes sizes = dataset.is_there() ? sizes_of(dataset) : Sizes();
  if (sizes.size() != 1)
    damaged("NumberOfCells", "is not a list");
  hsize_t part = 0, parts = sizes[0], point = 0, cell = 0, id = 0;
  if (has_steps()) {
    const auto of_step = [&](const char *name, int64_t otherwise) {
      return static_cast<hsize_t>(step_integer(name, step, otherwise));
    };
    part = of_step("PartOffsets", 0);
    parts = of_step("NumberOfParts", 1);
    point = of_step("PointOffsets", 0);
    cell = of_step("CellOffsets", 0);
    id = of_step("ConnectivityIdOffsets", 0);
  }
  const auto points = integers("NumberOfPoints", part, parts), cells = integers("NumberOfCells", part, parts);
  const auto ids = integers("NumberOfConnectivityIds", part, parts);
  const auto before = integers("NumberOfCells", 0, sizes[0]);
  hsize_t parts_before = 0, sum = 0; // How many parts come before this step's, and how many cells these have.
  while (sum < cell && parts_before < before.size())
    sum += static_cast<hsize_t>(before[parts_before++]);
  vtkNew<vtkMultiPieceDataSet> pieces;
  hsize_t points_done = 0, cells_done = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto n = static_cast<hsize_t>(points[i]), m = static_cast<hsize_t>(cells[i]),
               k = static_cast<hsize_t>(ids[i]);
    vtkNew<vtkUnstructuredGrid> grid;
    if (n > 0 && m > 0) {
      vtkNew<vtkPoints> positions;
      const auto coordinates = needed("Points", point + points_done, n);
      if (coordinates->GetNumberOfComponents() != 3)
        damaged("Points", "have not three coordinates");
      positions->SetData(coordinates);
      grid->SetPoints(positions);
      vtkNew<vtkUnsignedCharArray> types;
      types->DeepCopy(needed("Types", cell + cells_done, m));
      if (std::find(types->GetPointer(0), types->GetPointer(0) + m, VTK_POLYHEDRON) != types->GetPointer(0) + m) {
        tcv::fail(TETCAST_ERROR_UNSUPPORTED, "%s: holds polyhedra, which are not read from VTKHDF files",
                  path_.c_str());
      }
      const hsize_t shift = cell + cells_done + i;
      grid->SetCells(types, read_cells(m, k, id, {shift + part, shift + parts_before, shift}));
      add_arrays(grid, step, [&](TetcastAssociation association, Sizes *start, Sizes *count) {
        *start = {association == TETCAST_POINT ? points_done : cells_done};
        *count = {association == TETCAST_POINT ? n : m};
      });
    }
    pieces->SetPiece(static_cast<unsigned>(i), grid);
    points_done += n;
    cells_done += m;
    id += k;
  }
  return pieces;
}

vtkSmartPointer<vtkDataObject> Hdf::read(int64_t step) {
  return type_ == "ImageData" ? read_image(step) : read_grid(step);
}

} // namespace

std::unique_ptr<tcv::Source> tcv::make_source(const SourceOptions &) {
  return std::make_unique<Hdf>();
}
