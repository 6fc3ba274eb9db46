// SPDX-License-Identifier: Apache-2.0
// Writes meshes and fields as .vtu.
#include "common.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkTypeUInt32Array.h>
#include <vtkTypeUInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <tetcast/dataset.h>

using namespace tcv;

using DataArray = vtkSmartPointer<vtkDataArray>;

static DataArray new_array(TetcastType type) {
  switch (type) {
  case TETCAST_TYPE_FLOAT32:
    return vtkSmartPointer<vtkFloatArray>::New();
  case TETCAST_TYPE_FLOAT64:
    return vtkSmartPointer<vtkDoubleArray>::New();
  case TETCAST_TYPE_INT32:
    return vtkSmartPointer<vtkTypeInt32Array>::New();
  case TETCAST_TYPE_UINT32:
    return vtkSmartPointer<vtkTypeUInt32Array>::New();
  case TETCAST_TYPE_INT64:
    return vtkSmartPointer<vtkTypeInt64Array>::New();
  case TETCAST_TYPE_UINT64:
    return vtkSmartPointer<vtkTypeUInt64Array>::New();
  case TETCAST_TYPE_NONE:
    break;
  }
  fail(TETCAST_ERROR_ARGUMENT, "array of unknown type %d", static_cast<int>(type));
}

// Refers to the values if they lie next to each other, and copies them otherwise.
static DataArray wrap(const TetcastArray &values, int components) {
  const DataArray array = new_array(values.type);
  array->SetNumberOfComponents(components);
  const int64_t tuple = type_size(values.type) * components;
  if (values.count > 0 && (values.stride == 0 || values.stride == tuple)) {
    // The 1 says that VTK does not free it.
    array->SetVoidArray(const_cast<void *>(values.data), values.count * components, 1);
    return array;
  }
  array->SetNumberOfTuples(values.count);
  char *target = static_cast<char *>(array->GetVoidPointer(0));
  for (int64_t i = 0; i < values.count; ++i) {
    std::memcpy(target + i * tuple, static_cast<const char *>(values.data) + i * values.stride,
                static_cast<size_t>(tuple));
  }
  return array;
}

template <typename Offsets> static vtkSmartPointer<vtkCellArray> cells_of(vtkDataArray *connectivity, int64_t count) {
  vtkNew<Offsets> offsets;
  offsets->SetNumberOfValues(count + 1);
  for (int64_t i = 0; i <= count; ++i)
    offsets->SetValue(i, static_cast<typename Offsets::ValueType>(4 * i));
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  connectivity->SetNumberOfComponents(1); // For VTK it is a flat list.
  if (!cells->SetData(offsets, connectivity))
    fail(TETCAST_ERROR_DATA, "VTK refuses the mesh's indices");
  return cells;
}

static vtkSmartPointer<vtkCellArray> make_cells(const TetcastMesh *mesh) {
  const TetcastArray tetrahedra = tetcast_mesh_tetrahedra(mesh);
  const int64_t count = tetrahedra.count;
  const bool as_they_are = tetcast_mesh_index_base(mesh) == 0;
  if (as_they_are && tetrahedra.type == TETCAST_TYPE_INT32 && count <= INT32_MAX / 4) {
    return cells_of<vtkTypeInt32Array>(wrap(tetrahedra, 4), count);
  }
  if (as_they_are && tetrahedra.type == TETCAST_TYPE_INT64)
    return cells_of<vtkTypeInt64Array>(wrap(tetrahedra, 4), count);
  vtkNew<vtkTypeInt64Array> indices; // VTK knows no unsigned indices of that kind, and none that count from 1.
  indices->SetNumberOfComponents(4);
  indices->SetNumberOfTuples(count);
  for (int64_t i = 0; i < count; ++i) {
    int64_t tetrahedron[4];
    tetcast_mesh_tetrahedron(mesh, i, tetrahedron);
    for (int j = 0; j < 4; ++j)
      indices->SetValue(4 * i + j, tetrahedron[j]);
  }
  return cells_of<vtkTypeInt64Array>(indices, count);
}

// Escapes a name for XML, because VTK writes names as they are.
static std::string xml_name(const char *name) {
  std::string result;
  for (const char *c = name; *c; ++c) {
    if (static_cast<unsigned char>(*c) < ' ')
      fail(TETCAST_ERROR_ARGUMENT, "a field's name has control characters");
    if (*c == '&')
      result += "&amp;";
    else if (*c == '<')
      result += "&lt;";
    else if (*c == '"')
      result += "&quot;";
    else
      result += *c;
  }
  return result;
}

static void add_field(vtkUnstructuredGrid *grid, const TetcastMesh *mesh, const char *name, const TetcastField *field) {
  const bool points = tetcast_field_association(field) == TETCAST_POINT;
  const int64_t wanted = points ? tetcast_mesh_vertex_count(mesh) : tetcast_mesh_tetrahedron_count(mesh);
  const TetcastArray values = tetcast_field_values(field);
  if (values.count != wanted) {
    fail(TETCAST_ERROR_ARGUMENT, "field '%s' has %lld values for %lld %s", name, static_cast<long long>(values.count),
         static_cast<long long>(wanted), points ? "vertices" : "cells");
  }
  vtkDataSetAttributes *attributes = grid->GetPointData();
  if (!points)
    attributes = grid->GetCellData();
  const std::string written = xml_name(name);
  if (attributes->HasArray(written.c_str()))
    fail(TETCAST_ERROR_ARGUMENT, "two fields are called '%s'", name);
  const DataArray array = wrap(values, 1);
  array->SetName(written.c_str());
  attributes->AddArray(array);
  if (!attributes->GetScalars())
    attributes->SetActiveScalars(written.c_str()); // Readers show the first array by default.
}

// Coordinates that come in arrays apart are put together.
static DataArray make_points(const TetcastMesh *mesh) {
  const TetcastArray vertices = tetcast_mesh_vertices(mesh);
  if (vertices.data || vertices.count == 0)
    return wrap(vertices, 3);
  const DataArray points = new_array(vertices.type);
  points->SetNumberOfComponents(3);
  points->SetNumberOfTuples(vertices.count);
  for (int64_t i = 0; i < vertices.count; ++i) {
    double position[3];
    tetcast_mesh_vertex(mesh, i, position);
    points->SetTuple(i, position);
  }
  return points;
}

// Marks the cells that the mesh hides, as VTK marks them.
static void add_hidden(vtkUnstructuredGrid *grid, const TetcastMesh *mesh) {
  const int64_t count = tetcast_mesh_tetrahedron_count(mesh);
  int64_t first = 0;
  while (first < count && !tetcast_mesh_hides(mesh, first))
    ++first;
  if (first == count)
    return;
  vtkNew<vtkUnsignedCharArray> marks;
  marks->SetName(vtkDataSetAttributes::GhostArrayName());
  marks->SetNumberOfTuples(count);
  for (int64_t i = 0; i < count; ++i)
    marks->SetValue(i, tetcast_mesh_hides(mesh, i) ? vtkDataSetAttributes::HIDDENCELL : 0);
  grid->GetCellData()->AddArray(marks);
}

static vtkSmartPointer<vtkUnstructuredGrid> make_grid(const TetcastMesh *mesh, int count, const char *const *names,
                                                      const TetcastField *const *fields) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetData(make_points(mesh));
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, make_cells(mesh));
  add_hidden(grid, mesh);
  for (int i = 0; i < count; ++i) {
    if (!names[i] || !*names[i] || !fields[i])
      fail(TETCAST_ERROR_ARGUMENT, "field %d or its name is missing", i);
    add_field(grid, mesh, names[i], fields[i]);
  }
  return grid;
}

// Returns the error that kept a file from being written, or 0 if nothing keeps it now. VTK looks at errno too late,
// when other calls have changed it. So this function writes as many bytes as the file could have had, until that fails.
int why_not_written(const char *path, unsigned long kibibytes) {
  static const char zeros[65536] = {};
  const int file = open(path, O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  int error = file < 0 ? errno : 0;
  for (uint64_t left = uint64_t{kibibytes} * 1024 + sizeof zeros; error == 0 && left > 0;) {
    const ssize_t written = write(file, zeros, std::min<uint64_t>(left, sizeof zeros));
    if (written > 0)
      left -= static_cast<uint64_t>(written);
    else if (errno != EINTR)
      error = errno;
  }
  if (file >= 0)
    close(file);
  return error;
}

// Returns the file that a path stands for: an existing file at the end of all links, or the place that a link to
// nothing leads to.
std::string followed(std::string path) {
  char target[PATH_MAX];
  if (realpath(path.c_str(), target))
    return target;
  for (int i = 0; i < 40; ++i) { // The system follows as many links.
    const ssize_t length = readlink(path.c_str(), target, sizeof target);
    if (length <= 0)
      break;
    const size_t slash = target[0] == '/' ? std::string::npos : path.rfind('/');
    path = (slash == std::string::npos ? "" : path.substr(0, slash + 1)) +
           std::string(target, static_cast<size_t>(length));
  }
  return path;
}

// A new, empty file beside the target, which is removed with this object unless it has become the target. Its name and
// its lock (flock) tell a file that is being written from the left-over of a killed process, which has no lock.
class Temporary {
public:
  explicit Temporary(const char *target) : target_(followed(target)) {
    static std::atomic<unsigned> counter{0};
    struct stat former;
    const bool exists = stat(target, &former) == 0;
    if (exists && !S_ISREG(former.st_mode)) {
      fail(TETCAST_ERROR_IO, "%s: can't be written: is %s", target,
           S_ISDIR(former.st_mode) ? "a folder" : "not a regular file");
    }
    const size_t slash = target_.rfind('/');
    const std::string folder = slash == std::string::npos ? "" : target_.substr(0, slash + 1);
    while (lock_ < 0) {
      path_ = folder + ".tetcast-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".vtu";
      lock_ = open(path_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, exists ? former.st_mode & 0777 : 0666);
      if (lock_ < 0 && errno != EEXIST)
        fail(TETCAST_ERROR_IO, "%s: can't be written: %s", target, std::strerror(errno));
      struct stat own;
      const bool locked = lock_ >= 0 && (flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK);
      if (locked && (fstat(lock_, &own) != 0 || own.st_nlink > 0))
        continue;
      if (lock_ >= 0)
        close(lock_); // Another process took it for a left-over before it had its lock.
      lock_ = -1;
    }
    if (exists) { // A file that is replaced keeps its mode and, where that is allowed, its owner.
      const bool owned = fchown(lock_, former.st_uid, former.st_gid) == 0;
      fchmod(lock_, former.st_mode & (owned ? 07777 : 0777));
    }
  }
  ~Temporary() {
    if (!path_.empty())
      unlink(path_.c_str());
    if (lock_ >= 0)
      close(lock_);
  }
  Temporary(const Temporary &) = delete;
  Temporary &operator=(const Temporary &) = delete;

  const char *path() const { return path_.c_str(); }

  void become_target() {
    if (std::rename(path_.c_str(), target_.c_str()) != 0) {
      fail(TETCAST_ERROR_IO, "%s: can't be written: %s", target_.c_str(), std::strerror(errno));
    }
    path_.clear();
  }

private:
  std::string target_, path_;
  int lock_ = -1; // The descriptor of the file, which holds the lock.
};

static void write_grid(const char *path, vtkUnstructuredGrid *grid, const Capture &capture) {
  Temporary temporary(path);
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName(temporary.path());
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  writer->SetHeaderTypeToUInt64();
  const bool written = writer->Write() == 1 && !capture.failed();
  if (!written) {
    const unsigned long code = writer->GetErrorCode();
    const int error = why_not_written(temporary.path(), grid->GetActualMemorySize());
    const char *reason = "VTK does not say why";
    if (error != 0)
      reason = std::strerror(error);
    else if (code == vtkErrorCode::OutOfDiskSpaceError)
      reason = std::strerror(ENOSPC);
    else if (code != vtkErrorCode::NoError)
      reason = vtkErrorCode::GetStringFromErrorCode(code);
    else if (!capture.error().empty())
      reason = capture.error().c_str();
    fail(TETCAST_ERROR_IO, "%s: can't be written: %s", path, reason);
  }
  temporary.become_target();
}

TetcastStatus tetcast_dataset_write(TetcastContext *context, const char *path, const TetcastMesh *mesh, int count,
                                    const char *const *names, const TetcastField *const *fields) {
  if (!context || !path || !mesh || count < 0 || (count > 0 && (!names || !fields))) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_write: context, path, mesh, names and fields must not be NULL");
  }
  return fence(context, path, [&] {
    const Capture capture;
    vtkSmartPointer<vtkUnstructuredGrid> grid;
    try {
      grid = make_grid(mesh, count, names, fields);
    } catch (Failure &failure) {
      failure.text = std::string(path) + ": " + failure.text;
      throw;
    }
    write_grid(path, grid, capture);
  });
}
