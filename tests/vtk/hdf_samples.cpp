// SPDX-License-Identifier: Apache-2.0
#include "hdf_samples.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <vtk_hdf5.h>

namespace {

class File {
public:
  File(const char *path, const std::string &type) : file_(H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {
    root_ = H5Gcreate2(file_, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const int64_t version[2] = {2, 0};
    attribute("Version", H5T_NATIVE_INT64, version, 2);
    const hid_t text = H5Tcopy(H5T_C_S1), single = H5Screate(H5S_SCALAR);
    H5Tset_size(text, type.size() ? type.size() : 1);
    H5Tset_strpad(text, H5T_STR_NULLPAD);
    const hid_t kind = H5Acreate2(root_, "Type", text, single, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(kind, text, type.c_str());
    H5Aclose(kind);
    H5Sclose(single);
    H5Tclose(text);
  }
  ~File() {
    H5Gclose(root_);
    H5Fclose(file_);
  }
  template <typename T> void attribute(const char *name, hid_t type, const T *values, hsize_t count) {
    const hid_t space = H5Screate_simple(1, &count, nullptr),
                attribute = H5Acreate2(root_, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, values);
    H5Aclose(attribute);
    H5Sclose(space);
  }
  // A dataset at a path; groups on the way are made.
  void write(const std::string &name, hid_t file_type, hid_t memory_type, const void *values,
             const std::vector<hsize_t> &size, bool chunked = false) {
    const hid_t links = H5Pcreate(H5P_LINK_CREATE), layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    if (chunked)
      H5Pset_chunk(layout, static_cast<int>(size.size()), std::vector<hsize_t>(size.size(), 1).data());
    const hid_t set = H5Dcreate2(root_, name.c_str(), file_type, space, links, layout, H5P_DEFAULT);
    if (values)
      H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(links);
    H5Pclose(layout);
  }
  void integers(const std::string &name, const std::vector<int64_t> &values, bool column = false) {
    std::vector<hsize_t> size = {values.size()};
    if (column)
      size.push_back(1);
    write(name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), size);
  }
  void doubles(const std::string &name, const std::vector<double> &values, std::vector<hsize_t> size = {}) {
    if (size.empty())
      size = {values.size()};
    write(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), size);
  }

private:
  hid_t file_, root_;
};

// The lists of all parts, one after the other.
struct Lists {
  std::vector<int64_t> points, cells, ids, connectivity, offsets;
  std::vector<double> positions, h, c;
  std::vector<uint8_t> types;

  // Cubes [first, end) of a step.
  void add_part(int first, int end, int step) {
    const double scale = 1 + step;
    for (int i = first; i <= end; ++i) {
      for (int k = 0; k < 4; ++k) {
        const double p[3] = {double(i), double(k % 2), scale * (k / 2)};
        positions.insert(positions.end(), p, p + 3);
        h.push_back(scale * (p[0] + 2 * p[1] + 4 * p[2]));
      }
    }
    offsets.push_back(0);
    for (int i = first; i < end; ++i) {
      const int64_t at = 4 * (i - first), corners[8] = {at, at + 4, at + 5, at + 1, at + 2, at + 6, at + 7, at + 3};
      connectivity.insert(connectivity.end(), corners, corners + 8);
      offsets.push_back(8 * (i - first + 1));
      types.push_back(12);
      c.push_back(10 * step + i);
    }
    points.push_back(4 * (end - first + 1));
    cells.push_back(end - first);
    ids.push_back(8 * (end - first));
  }
  void write(File *file) const {
    file->integers("NumberOfPoints", points);
    file->integers("NumberOfCells", cells);
    file->integers("NumberOfConnectivityIds", ids);
    file->integers("Connectivity", connectivity);
    file->integers("Offsets", offsets);
    file->doubles("Points", positions, {positions.size() / 3, 3});
    file->write("Types", H5T_STD_U8LE, H5T_NATIVE_UINT8, types.data(), {types.size()});
    file->doubles("PointData/h", h);
    file->doubles("CellData/c", c);
  }
};

void write_steps(File *file, const std::vector<int64_t> &parts, const std::vector<int64_t> &part,
                 const std::vector<int64_t> &point, const std::vector<int64_t> &cell, const std::vector<int64_t> &id,
                 const std::vector<int64_t> &h, const std::vector<int64_t> &c) {
  file->doubles("Steps/Values", {0, 0.5, 1});
  if (!parts.empty())
    file->integers("Steps/NumberOfParts", parts);
  file->integers("Steps/PartOffsets", part);
  file->integers("Steps/PointOffsets", point);
  file->integers("Steps/CellOffsets", cell, true);
  file->integers("Steps/ConnectivityIdOffsets", id, true);
  file->integers("Steps/PointDataOffsets/h", h);
  file->integers("Steps/CellDataOffsets/c", c);
}

} // namespace

void hdf_sample_cubes(const char *path, HdfSteps steps) {
  File file(path, "UnstructuredGrid");
  Lists lists;
  if (steps == HDF_NO_STEPS) {
    lists.add_part(0, 2, 0);
    lists.add_part(2, 5, 0);
    return lists.write(&file);
  }
  if (steps == HDF_MOVING) {
    lists.add_part(0, 2, 0);
    lists.add_part(0, 2, 1);
    lists.add_part(2, 3, 1);
    lists.add_part(0, 4, 2);
    lists.write(&file);
    const std::vector<int64_t> points = {0, 12, 32}, cells = {0, 2, 5};
    return write_steps(&file, {1, 2, 1}, {0, 1, 3}, points, cells, {0, 16, 40}, points, cells);
  }
  const bool listed = steps == HDF_STILL_LISTED;
  lists.add_part(0, 2, 0);
  for (int step = 1; step < 3; ++step) { // the values alone
    Lists more;
    more.add_part(0, 2, step);
    for (double &h : more.h)
      h = 0;
    for (size_t i = 0; i < more.h.size(); ++i)
      more.h[i] = (1 + step) * lists.h[i];
    lists.h.insert(lists.h.end(), more.h.begin(), more.h.end());
    lists.c.insert(lists.c.end(), more.c.begin(), more.c.end());
    if (!listed)
      continue;
    lists.points.push_back(12);
    lists.cells.push_back(2);
    lists.ids.push_back(16);
  }
  lists.write(&file);
  write_steps(&file, listed ? std::vector<int64_t>{1, 1, 1} : std::vector<int64_t>(),
              listed ? std::vector<int64_t>{0, 1, 2} : std::vector<int64_t>{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0},
              {0, 12, 24}, {0, 2, 4});
}

void hdf_sample_image(const char *path, bool steps) {
  File file(path, "ImageData");
  const int64_t extent[6] = {0, 2, 0, 1, 0, 1};
  const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
  file.attribute("WholeExtent", H5T_NATIVE_INT64, extent, 6);
  file.attribute("Origin", H5T_NATIVE_DOUBLE, origin, 3);
  file.attribute("Spacing", H5T_NATIVE_DOUBLE, spacing, 3);
  std::vector<double> h, c, still;
  for (int step = 0; step < (steps ? 2 : 1); ++step) {
    for (int i = 0; i < 12; ++i)
      h.push_back((1 + step) * (i % 3 + 2 * (i / 3 % 2) + 4 * (i / 6)));
    for (int i = 0; i < 2; ++i)
      c.push_back(10 * step + i);
  }
  for (int i = 0; i < 12; ++i)
    still.push_back(7);
  if (steps) {
    file.doubles("PointData/h", h, {2, 2, 2, 3});
    file.doubles("CellData/c", c, {2, 1, 1, 2});
    file.doubles("Steps/Values", {0, 0.5, 1});
    file.integers("Steps/PointDataOffsets/h", {0, 1, 0});
    file.integers("Steps/CellDataOffsets/c", {0, 1, 0});
  } else {
    file.doubles("PointData/h", h, {2, 2, 3});
    file.doubles("CellData/c", c, {1, 1, 2});
  }
  file.doubles("PointData/still", still, {2, 2, 3});
}

void hdf_sample_types(const char *path) {
  File file(path, "UnstructuredGrid");
  Lists lists;
  lists.add_part(0, 2, 0);
  lists.write(&file);
  std::vector<double> good;
  std::vector<int8_t> truth;
  std::vector<float> half;
  std::vector<int64_t> pair;
  for (int i = 0; i < 12; ++i) {
    good.push_back(i);
    truth.push_back(i % 2);
    half.push_back(0.5f * static_cast<float>(i));
    pair.insert(pair.end(), {i, i});
  }
  file.doubles("PointData/good", good);
  const hid_t truths = H5Tenum_create(H5T_STD_I8LE), halves = H5Tcopy(H5T_IEEE_F32LE), text = H5Tcopy(H5T_C_S1),
              both = H5Tcreate(H5T_COMPOUND, 16);
  int8_t value = 0;
  H5Tenum_insert(truths, "FALSE", &value);
  value = 1;
  H5Tenum_insert(truths, "TRUE", &value);
  H5Tset_fields(halves, 15, 10, 5, 0, 10);
  H5Tset_size(halves, 2);
  H5Tset_ebias(halves, 15);
  H5Tset_size(text, 1);
  H5Tinsert(both, "a", 0, H5T_STD_I64LE);
  H5Tinsert(both, "b", 8, H5T_STD_I64LE);
  file.write("PointData/truth", truths, truths, truth.data(), {12});
  file.write("PointData/half", halves, H5T_NATIVE_FLOAT, half.data(), {12});
  file.write("PointData/big", H5T_STD_I32BE, H5T_NATIVE_DOUBLE, good.data(), {12});
  file.write("PointData/text", text, text, "abcdefghijkl", {12});
  file.write("PointData/pair", both, both, pair.data(), {12});
  file.doubles("PointData/short", {1, 2, 3});
  file.write("PointData/claim", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, nullptr, {12, 1000000000}, true);
  H5Tclose(truths);
  H5Tclose(halves);
  H5Tclose(text);
  H5Tclose(both);
}

void hdf_sample_type(const char *path, const char *type) {
  File file(path, type);
}

void hdf_sample_damaged(const char *path, const char *name, long long value) {
  hdf_sample_cubes(path, HDF_MOVING);
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT),
              set = H5Dopen2(file, (std::string("VTKHDF/") + name).c_str(), H5P_DEFAULT);
  const hid_t all = H5Dget_space(set);
  std::vector<long long> values(static_cast<size_t>(H5Sget_simple_extent_npoints(all)));
  H5Dread(set, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  values[1] = value;
  H5Dwrite(set, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(all);
  H5Dclose(set);
  H5Fclose(file);
}
