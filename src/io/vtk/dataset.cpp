// SPDX-License-Identifier: Apache-2.0
// Reading files of volume meshes.
#include "dataset.hpp"
#include "common.hpp"
#include "files.hpp"

#include <memory>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

using namespace tcv;

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

// A format is one row. Content tells (file_kind); the extension only where content is silent.
static const struct {
  const char *kind;
  const char *extension;
  Grid (*read)(const char *path);
} readers[] = {
    {"VTKFile UnstructuredGrid", ".vtu", read_vtu},
    {"VTKFile PUnstructuredGrid", ".pvtu", read_pvtu},
    {"vtk UNSTRUCTURED_GRID", ".vtk", read_legacy_grid},
    {"NetCDF", ".ex2", read_exodus},
    {"HDF5", ".exo", read_exodus},
};

static Grid read_grid(TetcastContext *context, const char *path) {
  const std::string kind = file_kind(file_head(path));
  std::string extensions;
  for (const auto &reader : readers) {
    extensions += (extensions.empty() ? "" : ", ") + std::string(reader.extension);
    if (kind.empty() ? !has_extension(path, reader.extension) : kind != reader.kind) continue;
    const Capture capture;
    const Grid grid = reader.read(path);
    if (capture.failed()) fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s", path, capture.error().c_str());
    if (!capture.warning().empty()) {
      tetcast_context_message(context, TETCAST_SEVERITY_WARNING, "%s: %s", path, capture.warning().c_str());
    }
    return grid;
  }
  refuse(path, kind, "a volume mesh", extensions.c_str());
}

static void take_points(const char *path, vtkUnstructuredGrid *grid, TetcastDataset *dataset) {
  if (!grid || grid->GetNumberOfCells() == 0) fail(TETCAST_ERROR_DATA, "%s: holds no cells", path);
  if (grid->GetNumberOfPoints() == 0) fail(TETCAST_ERROR_DATA, "%s: holds no points", path);
  check_points(path, grid->GetPoints());
  dataset->points = grid->GetPoints()->GetData();
  const TetcastType type = type_of(dataset->points);
  if (type != TETCAST_TYPE_FLOAT32 && type != TETCAST_TYPE_FLOAT64) {
    const auto doubles = vtkSmartPointer<vtkDoubleArray>::New();
    doubles->DeepCopy(dataset->points);
    dataset->points = doubles;
  }
  dataset->point_count = grid->GetNumberOfPoints();
  dataset->cell_count = grid->GetNumberOfCells();
}

static void take_arrays(const char *path, vtkDataSetAttributes *attributes, TetcastAssociation association,
                        int64_t count, std::vector<Array> *arrays) {
  const char *what = association == TETCAST_POINT ? "point" : "cell";
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
    vtkDataArray *data = attributes->GetArray(i); // null for strings
    if (!data || data->GetNumberOfComponents() < 1) continue;
    const std::string name = data->GetName() ? data->GetName() : "";
    if (name == "vtkGhostType") continue;
    if (data->GetNumberOfTuples() != count) {
      fail(TETCAST_ERROR_DATA, "%s: %s array '%s' has %lld values for %lld %ss", path, what, name.c_str(),
           static_cast<long long>(data->GetNumberOfTuples()), static_cast<long long>(count), what);
    }
    const bool number = data == attributes->GetGlobalIds() || data == attributes->GetPedigreeIds() ||
                        name == "vtkOriginalPointIds" || name == "vtkOriginalCellIds";
    arrays->push_back({name, association, data, data == attributes->GetScalars(), number});
  }
}

static void warn_of_cut(const TetcastDataset *dataset) {
  const TetcastCutInfo &info = dataset->tetrahedra.info;
  const struct {
    int64_t count;
    const char *text;
  } rows[] = {{info.empty, "have no inside and are left out"},
              {info.oversized, "have more points than their type has: the last ones of each are ignored"},
              {info.folded, "are far from convex or tangled: their tetrahedra overlap"},
              {info.open, "are polyhedra whose faces don't close"}};
  for (const auto &row : rows) {
    if (row.count == 0) continue;
    tetcast_context_message(dataset->context, TETCAST_SEVERITY_WARNING, "%s: %lld cells %s", dataset->path.c_str(),
                            static_cast<long long>(row.count), row.text);
  }
}

static void read_dataset(TetcastContext *context, const char *path, TetcastDataset *dataset) {
  const Grid grid = read_grid(context, path);
  dataset->context = context;
  dataset->path = path;
  take_points(path, grid, dataset);
  check_cells(path, grid->GetCells(), dataset->point_count, "cell");
  {
    const Capture capture; // cutting may complain as well
    CutOptions options;
    options.threads = tetcast_context_threads(context);
    make_tetrahedra(path, grid, dataset->points, options, &dataset->tetrahedra);
  }
  warn_of_cut(dataset);
  take_arrays(path, grid->GetPointData(), TETCAST_POINT, dataset->point_count, &dataset->arrays);
  take_arrays(path, grid->GetCellData(), TETCAST_CELL, dataset->cell_count, &dataset->arrays);
}

TetcastStatus tetcast_dataset_read(TetcastContext *context, const char *path, TetcastDataset **dataset) {
  if (dataset) *dataset = nullptr;
  if (!context || !path || !dataset) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_read: context, path and dataset must not be NULL");
  }
  return fence(context, path, [&] {
    auto result = std::make_unique<TetcastDataset>();
    read_dataset(context, path, result.get());
    *dataset = result.release();
  });
}

void tetcast_dataset_destroy(TetcastDataset **dataset) {
  if (!dataset) return;
  delete *dataset;
  *dataset = nullptr;
}

bool tetcast_dataset_cell_type(const TetcastDataset *dataset, int i, const char **name, int64_t *count) {
  if (!dataset || i < 0 || static_cast<size_t>(i) >= dataset->tetrahedra.types.size()) return false;
  const auto &type = dataset->tetrahedra.types[static_cast<size_t>(i)];
  if (name) *name = type.first;
  if (count) *count = type.second;
  return true;
}

bool tetcast_dataset_array(const TetcastDataset *dataset, int i, TetcastDatasetArray *array) {
  if (!dataset || !array || i < 0 || static_cast<size_t>(i) >= dataset->arrays.size()) return false;
  const Array &source = dataset->arrays[static_cast<size_t>(i)];
  array->name = source.name.c_str();
  array->association = source.association;
  array->components = source.data->GetNumberOfComponents();
  array->type = type_name(source.data);
  array->active = source.active;
  return true;
}

int64_t tetcast_dataset_point_count(const TetcastDataset *dataset) { return dataset ? dataset->point_count : 0; }
int64_t tetcast_dataset_cell_count(const TetcastDataset *dataset) { return dataset ? dataset->cell_count : 0; }

TetcastCutInfo tetcast_dataset_cut(const TetcastDataset *dataset) {
  return dataset ? dataset->tetrahedra.info : TetcastCutInfo();
}

TetcastStatus tetcast_dataset_mesh(const TetcastDataset *dataset, TetcastMesh **mesh) {
  if (mesh) *mesh = nullptr;
  if (!dataset || !mesh) {
    return tetcast_context_error(dataset ? dataset->context : nullptr, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_mesh: dataset and mesh must not be NULL");
  }
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = view_of(dataset->points);
  desc.tetrahedra = dataset->tetrahedra.view;
  desc.ownership = TETCAST_BORROW;
  return tetcast_mesh_create(dataset->context, &desc, mesh);
}
