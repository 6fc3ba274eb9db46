// SPDX-License-Identifier: Apache-2.0
// Reading files of volume meshes.
#include "dataset.hpp"
#include "attributes.hpp"
#include "common.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkPointData.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnstructuredGrid.h>

using namespace tcv;

static void take_points(vtkUnstructuredGrid *grid, TetcastDataset *dataset) {
  dataset->points = grid->GetPoints()->GetData();
  const TetcastType type = type_of(dataset->points);
  if (type != TETCAST_TYPE_FLOAT32 && type != TETCAST_TYPE_FLOAT64) {
    const auto doubles = vtkSmartPointer<vtkDoubleArray>::New();
    doubles->DeepCopy(dataset->points);
    dataset->points = doubles;
  }
}

template <typename T> static void stretch(T *values, int64_t count, const double factors[3], const char *path) {
  for (int64_t i = 0; i < 3 * count; ++i) {
    const T value = static_cast<T>(static_cast<double>(values[i]) * factors[i % 3]);
    if (!std::isfinite(value))
      fail(TETCAST_ERROR_DATA, "%s: point %lld: coordinate %c is %g, and times %g more than its type holds", path,
           static_cast<long long>(i / 3), "xyz"[i % 3], static_cast<double>(values[i]), factors[i % 3]);
    values[i] = value;
  }
}

static void stretch_points(const double factors[3], TetcastDataset *dataset) {
  const TetcastArray view = view_of(dataset->points);
  if (factors[0] == 1 && factors[1] == 1 && factors[2] == 1)
    return;
  void *values = dataset->points->GetVoidPointer(0);
  if (view.type == TETCAST_TYPE_FLOAT32)
    stretch(static_cast<float *>(values), view.count, factors, dataset->path.c_str());
  else
    stretch(static_cast<double *>(values), view.count, factors, dataset->path.c_str());
}

static void take_arrays(vtkDataSetAttributes *attributes, TetcastAssociation association, int64_t count,
                        TetcastDataset *dataset) {
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
    vtkDataArray *data = attributes->GetArray(i); // It is null for an array of strings.
    if (!data || data->GetNumberOfComponents() < 1)
      continue;
    const std::string name = data->GetName() ? data->GetName() : "";
    if (is_ghost_array(name) || !has_length("", {association, name}, data, count, &dataset->unread))
      continue;
    dataset->arrays.push_back(
        {name, name, association, data, data == attributes->GetScalars(), numbers_things(attributes, data)});
  }
}

// Fails if a point of a cell is so far away that nothing could be computed with it. The library would notice as well,
// but it does not know the name of the file.
static void check_reach(const TetcastDataset *dataset) {
  const double most = 1e300;
  auto *points = vtkDoubleArray::FastDownCast(dataset->points);
  if (!points)
    return; // Single precision does not reach that far.
  const double *values = points->GetPointer(0);
  const vtkIdType count = points->GetNumberOfValues();
  if (std::none_of(values, values + count, [&](double value) { return std::fabs(value) > most; }))
    return;
  const TetcastArray &view = dataset->tetrahedra.view;
  for (int64_t i = 0; i < 4 * view.count; ++i) {
    const bool wide = type_size(view.type) == 8;
    const int64_t point =
        wide ? static_cast<const int64_t *>(view.data)[i] : static_cast<const int32_t *>(view.data)[i];
    for (int64_t k = 3 * point; k < 3 * point + 3; ++k) {
      if (std::fabs(values[k]) <= most)
        continue;
      fail(TETCAST_ERROR_DATA, "%s: point %lld: coordinate %c is %g: meshes may reach to %g at most",
           dataset->path.c_str(), static_cast<long long>(point), "xyz"[k % 3], values[k], most);
    }
  }
}

static bool has_array(const TetcastDataset *dataset, const ArrayName &array) {
  return std::any_of(dataset->arrays.begin(), dataset->arrays.end(),
                     [&](const Array &one) { return one.association == array.association && one.name == array.name; });
}

// Adds ":cell" to the selector of each cell array whose name would find a point array.
static void tell_apart(TetcastDataset *dataset) {
  for (Array &array : dataset->arrays) {
    if (array.association == TETCAST_CELL && has_array(dataset, {TETCAST_POINT, array.name}))
      array.selector += ":cell";
  }
}

// Leaves out the arrays that can't be read, with a warning, as long as there is any other array. Those that were not
// asked for are left out without a warning.
static void report_unread(const TetcastDataset *dataset, const char *only) {
  const UnreadArray *first = nullptr;
  std::string names;
  int count = 0;
  for (const UnreadArray &one : dataset->unread) {
    const bool asked_for = may_name(only, one.array.name) && (!only || has_array(dataset, one.array));
    if (one.reason.empty() || (!asked_for && !dataset->arrays.empty()))
      continue;
    first = first ? first : &one;
    names += (names.empty() ? "'" : ", '") + one.array.name + "'";
    ++count;
  }
  if (!first)
    return;
  const char *path = dataset->path.c_str(), *reason = first->reason.c_str();
  if (dataset->arrays.empty()) {
    fail(TETCAST_ERROR_DATA, "%s: %s array '%s' can't be read: %s", path, word_of(first->array.association),
         first->array.name.c_str(), reason);
  }
  if (count == 1) {
    tetcast_context_message(dataset->context, TETCAST_SEVERITY_WARNING, "%s: array %s is left out: %s", path,
                            names.c_str(), reason);
    return;
  }
  tetcast_context_message(dataset->context, TETCAST_SEVERITY_WARNING, "%s: %d arrays are left out: %s; the first: %s",
                          path, count, names.c_str(), reason);
}

static Contents read_pieces_of(const Reading &reading) {
  const char *path = reading.path.c_str(), *block = reading.desc->block;
  Contents contents;
  read_contents(reading, &contents);
  if (contents.times.empty())
    choose_step(reading.path, *reading.desc, {}); // This fails unless the file has no other step.
  if (block && (contents.pieces.empty() || contents.blocks.empty())) {
    std::string list;
    for (const std::string &name : contents.blocks)
      list += (list.empty() ? "there are: " : ", ") + name;
    fail(TETCAST_ERROR_ARGUMENT, "%s: has no block '%s' with a volume; %s", path, block,
         list.empty() ? "it is not of blocks" : list.c_str());
  }
  if (contents.pieces.empty() && !reading.desc->part) {
    fail(TETCAST_ERROR_DATA, "%s: %s", path,
         contents.surfaces > 0 ? "holds no volume, only surfaces or flat grids" : "holds no cells");
  }
  return contents;
}

static bool has_arrays(vtkDataSetAttributes *attributes) {
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
    if (attributes->GetArray(i) && !is_ghost_array(attributes->GetArrayName(i) ? attributes->GetArrayName(i) : ""))
      return true;
  }
  return false;
}

// Adds an array with the number of each cell's block, if nothing else in the file tells one part of the mesh from
// another.
static void number_blocks(std::vector<Piece> *pieces) {
  bool several = false;
  for (const Piece &piece : *pieces) {
    if (piece.block < 0 || has_arrays(piece.grid->GetPointData()) || has_arrays(piece.grid->GetCellData()))
      return;
    several = several || piece.block != pieces->front().block;
  }
  for (size_t i = 0; several && i < pieces->size(); ++i) {
    const auto numbers = vtkSmartPointer<vtkTypeInt32Array>::New();
    numbers->SetName("block");
    numbers->SetNumberOfValues((*pieces)[i].grid->GetNumberOfCells());
    numbers->FillValue((*pieces)[i].block);
    (*pieces)[i].grid->GetCellData()->AddArray(numbers);
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
    if (row.count == 0)
      continue;
    tetcast_context_message(dataset->context, TETCAST_SEVERITY_WARNING, "%s: %lld cells %s", dataset->path.c_str(),
                            static_cast<long long>(row.count), row.text);
  }
}

static void warn_of_nonfinite(const TetcastDataset *dataset) {
  const TetcastDatasetPieces &pieces = dataset->pieces;
  if (pieces.nonfinite_points == 0)
    return;
  tetcast_context_message(dataset->context, TETCAST_SEVERITY_WARNING,
                          "%s: %lld points have coordinates that are NaN or infinite: they are left out, and so are "
                          "%lld cells that use them",
                          dataset->path.c_str(), static_cast<long long>(pieces.nonfinite_points),
                          static_cast<long long>(pieces.nonfinite_cells));
}

static void read_dataset(TetcastContext *context, const char *path, const TetcastDatasetDesc &desc,
                         TetcastDataset *dataset) {
  const Reading reading = {context, &desc, path, "", 0};
  Contents contents = read_pieces_of(reading);
  dataset->context = context;
  dataset->path = path;
  dataset->pieces.surfaces = contents.surfaces;
  dataset->blocks = std::move(contents.blocks);
  dataset->times = std::move(contents.times);
  dataset->step = contents.step;
  dataset->unread = std::move(contents.unread);
  if (!desc.only || std::string(desc.only) == "block")
    number_blocks(&contents.pieces);
  const Grid grid =
      contents.pieces.empty() ? nullptr : unite(reading, &contents.pieces, &dataset->pieces, &dataset->unread);
  if (desc.part && (!grid || grid->GetNumberOfCells() == 0)) {
    dataset->points = vtkSmartPointer<vtkDoubleArray>::New();
    dataset->points->SetNumberOfComponents(3);
    dataset->tetrahedra.view.type = TETCAST_TYPE_INT32;
    return;
  }
  const int64_t points = grid->GetNumberOfPoints(), cells = grid->GetNumberOfCells();
  const TetcastDatasetPieces &pieces = dataset->pieces;
  if (cells == 0 && pieces.nonfinite_cells > 0) {
    fail(TETCAST_ERROR_DATA, "%s: holds no cells without coordinates that are NaN or infinite", path);
  }
  if (cells == 0)
    fail(TETCAST_ERROR_DATA, "%s: holds no cells%s", path, pieces.ghost_cells > 0 ? " but ghosts" : "");
  warn_of_nonfinite(dataset);
  dataset->point_count = points + pieces.ghost_points + pieces.nonfinite_points + pieces.merged_points;
  dataset->cell_count = cells + pieces.ghost_cells + pieces.nonfinite_cells;
  take_points(grid, dataset);
  stretch_points(desc.stretch, dataset);
  {
    const Capture capture; // Cutting cells may make VTK complain as well.
    CutOptions options;
    options.subdivision = desc.subdivision;
    options.sources = desc.sources;
    options.threads = tetcast_context_threads(context);
    make_tetrahedra(path, grid, dataset->points, options, &dataset->tetrahedra);
  }
  check_reach(dataset);
  warn_of_cut(dataset);
  if (desc.cell_to_point) {
    dataset->corners = grid->GetCells();
    dataset->types = grid->GetCellTypesArray();
  }
  take_arrays(grid->GetPointData(), TETCAST_POINT, points, dataset);
  take_arrays(grid->GetCellData(), TETCAST_CELL, cells, dataset);
  tell_apart(dataset);
  report_unread(dataset, desc.only);
}

static constexpr uint32_t desc_cookie = 0x74636473; // These bytes spell "tcds".

TetcastDatasetDesc tetcast_dataset_desc_default(void) {
  TetcastDatasetDesc desc = {};
  desc.cookie = desc_cookie;
  desc.time = std::numeric_limits<double>::quiet_NaN();
  desc.merge_tolerance = -1;
  std::fill(desc.stretch, desc.stretch + 3, 1.0);
  return desc;
}

TetcastStatus tetcast_dataset_read(TetcastContext *context, const char *path, const TetcastDatasetDesc *desc,
                                   TetcastDataset **dataset) {
  const FloatingPoint guard;
  if (dataset)
    *dataset = nullptr;
  if (!context || !path || !dataset) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_read: context, path and dataset must not be NULL");
  }
  const TetcastDatasetDesc all = desc ? *desc : tetcast_dataset_desc_default();
  if (all.cookie != desc_cookie)
    return tetcast_context_error(
        context, TETCAST_ERROR_ARGUMENT,
        "tetcast_dataset_read: the description was not made by tetcast_dataset_desc_default()");
  if (std::isinf(all.time) || !std::isfinite(all.merge_tolerance)) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_read: time %g or merge_tolerance %g is not a finite number", all.time,
                                 all.merge_tolerance);
  }
  if (all.subdivision < 0 || all.subdivision > TETCAST_MAX_SUBDIVISION) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_read: subdivision %d is not from 0 to %d", all.subdivision,
                                 TETCAST_MAX_SUBDIVISION);
  }
  for (const double factor : all.stretch) {
    if (!(factor > 0) || std::isinf(factor))
      return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                   "tetcast_dataset_read: the stretch %g is not a finite number above 0", factor);
  }
  return fence(context, path, [&] {
    auto result = std::make_unique<TetcastDataset>();
    read_dataset(context, path, all, result.get());
    *dataset = result.release();
  });
}

TetcastStatus tetcast_dataset_parts(TetcastContext *context, const char *path, const TetcastDatasetDesc *desc,
                                    TetcastDatasetPart *part, void *user) {
  const FloatingPoint guard;
  if (!context || !path || !part) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_dataset_parts: context, path and part must not be NULL");
  }
  const TetcastDatasetDesc all = desc ? *desc : tetcast_dataset_desc_default();
  if (all.cookie != desc_cookie)
    return tetcast_context_error(
        context, TETCAST_ERROR_ARGUMENT,
        "tetcast_dataset_parts: the description was not made by tetcast_dataset_desc_default()");
  return fence(context, path, [&] {
    std::vector<std::string> files;
    Contents contents;
    contents.files = &files;
    read_contents({context, &all, path, "", 0}, &contents);
    for (const std::string &file : files)
      part(user, file.c_str(), file_size(file.c_str()));
  });
}

void tetcast_dataset_destroy(TetcastDataset **dataset) {
  if (!dataset)
    return;
  delete *dataset;
  *dataset = nullptr;
}

bool tetcast_dataset_cell_type(const TetcastDataset *dataset, int i, const char **name, int64_t *count) {
  if (!dataset || i < 0 || static_cast<size_t>(i) >= dataset->tetrahedra.types.size())
    return false;
  const auto &type = dataset->tetrahedra.types[static_cast<size_t>(i)];
  if (name)
    *name = type.first;
  if (count)
    *count = type.second;
  return true;
}

bool tetcast_dataset_array(const TetcastDataset *dataset, int i, TetcastDatasetArray *array) {
  if (!dataset || !array || i < 0 || static_cast<size_t>(i) >= dataset->arrays.size())
    return false;
  const Array &source = dataset->arrays[static_cast<size_t>(i)];
  array->name = source.name.c_str();
  array->selector = source.selector.c_str();
  array->association = source.association;
  array->components = source.data->GetNumberOfComponents();
  array->type = type_name(source.data);
  array->active = source.active;
  return true;
}

const char *tetcast_dataset_unread(const TetcastDataset *dataset, int i) {
  return dataset && i >= 0 && static_cast<size_t>(i) < dataset->unread.size()
             ? dataset->unread[static_cast<size_t>(i)].array.name.c_str()
             : nullptr;
}

int64_t tetcast_dataset_point_count(const TetcastDataset *dataset) {
  return dataset ? dataset->point_count : 0;
}
int64_t tetcast_dataset_cell_count(const TetcastDataset *dataset) {
  return dataset ? dataset->cell_count : 0;
}

TetcastDatasetPieces tetcast_dataset_pieces(const TetcastDataset *dataset) {
  return dataset ? dataset->pieces : TetcastDatasetPieces();
}

const char *tetcast_dataset_block(const TetcastDataset *dataset, int i) {
  return dataset && i >= 0 && static_cast<size_t>(i) < dataset->blocks.size()
             ? dataset->blocks[static_cast<size_t>(i)].c_str()
             : nullptr;
}

bool tetcast_dataset_time(const TetcastDataset *dataset, int64_t i, double *time) {
  if (!dataset || i < 0 || static_cast<size_t>(i) >= dataset->times.size())
    return false;
  if (time)
    *time = dataset->times[static_cast<size_t>(i)];
  return true;
}

int64_t tetcast_dataset_step(const TetcastDataset *dataset) {
  return dataset ? dataset->step : 0;
}

TetcastCutInfo tetcast_dataset_cut(const TetcastDataset *dataset) {
  return dataset ? dataset->tetrahedra.info : TetcastCutInfo();
}

TetcastArray tetcast_dataset_sources(const TetcastDataset *dataset) {
  return dataset ? dataset->tetrahedra.source : TetcastArray();
}

TetcastStatus tetcast_dataset_mesh(const TetcastDataset *dataset, TetcastMesh **mesh) {
  if (mesh)
    *mesh = nullptr;
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
