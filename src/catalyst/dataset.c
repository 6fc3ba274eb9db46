/* SPDX-License-Identifier: Apache-2.0 */
#include "dataset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

static struct {
  const ConduitNode *data;
  const char *path, *topology;
  int processes;
} handed_over;

void source_set(const ConduitNode *data, const char *path, const char *topology, int processes) {
  handed_over.data = data;
  handed_over.path = path;
  handed_over.topology = topology;
  handed_over.processes = processes;
}

/* ── meshes ── */

typedef struct Parts {
  Part *list; /* [count] */
  int count, capacity;
  int64_t flat_cells;
} Parts;

static bool is_mesh(const ConduitNode *node) {
  return conduit_at(node, "coordsets") || conduit_at(node, "topologies");
}

/* Reads a mesh, or all meshes among the children of a node and theirs: blocks and domains. */
static bool read_parts(Parts *parts, const ConduitNode *node, const char *path, int depth) {
  if (!is_mesh(node)) {
    bool fine = true;
    for (int64_t i = 0; i < conduit_children(node) && depth < 3 && fine; i++) {
      char *name = conduit_name(conduit_child(node, i));
      char *place = *name ? cli_print("%s/%s", path, name) : cli_print("%s/[%lld]", path, (long long)i);
      fine = read_parts(parts, conduit_child(node, i), place, depth + 1);
      free(place);
      free(name);
    }
    return fine;
  }
  parts->list = cli_grow(parts->list, parts->count, &parts->capacity, sizeof *parts->list);
  Part *part = &parts->list[parts->count++];
  *part = (Part){.path = cli_duplicate(path), .data = node, .cells = tetcast_cells_desc_default()};
  if (!topology_read(part, handed_over.topology))
    return false;
  parts->flat_cells += part->flat_cells;
  if (part->cell_count > 0)
    return fields_read(part);
  part_release(part); /* only what has a volume is drawn */
  parts->count--;
  return true;
}

static bool read_all(TetcastDataset *dataset, bool maybe_empty) {
  Parts parts = {.count = 0};
  bool fine = read_parts(&parts, handed_over.data, dataset->path, 0);
  if (fine && parts.count == 0 && !maybe_empty) {
    cli_error(parts.flat_cells > 0 ? "%s: holds no volume, only surfaces, lines or points" : "%s: holds no cells",
              dataset->path);
    fine = false;
  }
  if (fine && parts.count == 0)
    dataset->part = (Part){.path = cli_duplicate(dataset->path), .cells = tetcast_cells_desc_default()};
  else if (fine && parts.flat_cells > 0)
    cli_warning("cells of surfaces, lines and points are not drawn");
  if (fine && parts.count == 1 && !parts.list[0].hidden) {
    dataset->part = parts.list[0];
    parts.count = 0;
  } else if (fine && parts.count > 0) {
    dataset->part = (Part){.path = cli_duplicate(dataset->path),
                           .topology_name = cli_duplicate(parts.list[0].topology_name),
                           .cells = tetcast_cells_desc_default()};
    fine = parts_unite(parts.list, parts.count, &dataset->part);
    if (fine && dataset->part.cell_count == 0 && !maybe_empty) {
      cli_error("%s: holds no cells but ghosts", dataset->path);
      fine = false;
    }
  }
  for (int i = 0; i < parts.count; i++)
    part_release(&parts.list[i]);
  free(parts.list);
  return fine;
}

/* ── tetrahedra ── */

static bool stretch(TetcastDataset *dataset, const double factors[3]) {
  TetcastArray *vertices = &dataset->part.cells.vertices;
  if (factors[0] == 1 && factors[1] == 1 && factors[2] == 1)
    return true;
  const View first = view_of_array(vertices);
  const int64_t size = view_type_size(first.type), stride = vertices->stride ? vertices->stride : 3 * size;
  char *copy = memory_take(&dataset->memory, 3 * vertices->count, (size_t)size);
  for (int64_t i = 0; i < 3 * vertices->count; i++) {
    const View own = {.data = first.data + i / 3 * stride + i % 3 * size, .type = first.type};
    const double value = view_value(&own, 0) * factors[i % 3];
    const float single = (float)value;
    memcpy(copy + i * size, first.type == VIEW_FLOAT32 ? (const void *)&single : &value, (size_t)size);
    if (!isfinite(first.type == VIEW_FLOAT32 ? (double)single : value)) {
      cli_error("%s: point %lld: coordinate %c is %g, and times %g more than its type holds", dataset->path,
                (long long)(i / 3), "xyz"[i % 3], view_value(&own, 0), factors[i % 3]);
      return false;
    }
  }
  *vertices = (TetcastArray){.data = copy, .type = vertices->type, .count = vertices->count};
  return true;
}

/* The vertices with those that cutting has added behind them. */
static void add_vertices(TetcastDataset *dataset) {
  const TetcastArray *vertices = &dataset->part.cells.vertices;
  const int64_t added = dataset->cut_info.added_vertices, count = vertices->count;
  dataset->vertices = *vertices;
  if (added == 0)
    return;
  const View first = view_of_array(vertices);
  const int64_t size = view_type_size(first.type), stride = vertices->stride ? vertices->stride : 3 * size;
  char *all = memory_take(&dataset->memory, 3 * (count + added), (size_t)size);
  double *more = memory_take(&dataset->memory, 3 * added, sizeof *more);
  for (int64_t i = 0; i < count; i++)
    memcpy(all + 3 * i * size, first.data + i * stride, 3 * (size_t)size);
  tetcast_cut_interpolate(dataset->cut, vertices, 3, more);
  for (int64_t i = 0; i < 3 * added; i++) {
    const float single = (float)more[i];
    memcpy(all + (3 * count + i) * size, first.type == VIEW_FLOAT32 ? (const void *)&single : &more[i], (size_t)size);
  }
  dataset->vertices = (TetcastArray){.data = all, .type = vertices->type, .count = count + added};
}

static void warn_of_cut(const TetcastCutInfo *info) {
  const struct {
    int64_t count;
    const char *text;
  } rows[] = {{info->empty, "have no inside and are left out"},
              {info->oversized, "have more points than their type has: the last ones of each are ignored"},
              {info->folded, "are far from convex or tangled: their tetrahedra overlap"},
              {info->open, "are polyhedra whose faces don't close"}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    if (rows[i].count > 0)
      cli_warning("%lld cells %s", (long long)rows[i].count, rows[i].text);
}

static TetcastStatus make_tetrahedra(TetcastDataset *dataset) {
  if (dataset->part.cell_count == 0) {
    dataset->vertices = (TetcastArray){.type = TETCAST_TYPE_FLOAT64};
    dataset->tetrahedra = (TetcastArray){.type = TETCAST_TYPE_INT32};
    return TETCAST_OK;
  }
  TetcastCellsDesc *cells = &dataset->part.cells;
  if (!cells->types && cells->type == TETCAST_CELL_TETRAHEDRON) {
    dataset->vertices = cells->vertices;
    dataset->tetrahedra = cells->connectivity;
    return TETCAST_OK;
  }
  cells->sources = true;
  const TetcastStatus status = tetcast_cells_cut(dataset->context, cells, &dataset->cut);
  if (status != TETCAST_OK)
    return status;
  tetcast_cut_info(dataset->cut, &dataset->cut_info);
  warn_of_cut(&dataset->cut_info);
  dataset->tetrahedra = tetcast_cut_tetrahedra(dataset->cut);
  add_vertices(dataset);
  if (dataset->tetrahedra.count > 0)
    return TETCAST_OK;
  cli_error("%s: no tetrahedron can be made of its cells", dataset->path);
  return TETCAST_ERROR_DATA;
}

/* ── the functions of a dataset ── */

static void destroy_dataset(TetcastDataset **pointer) {
  TetcastDataset *dataset = *pointer;
  if (!dataset)
    return;
  tetcast_cut_destroy(&dataset->cut);
  for (int i = 0; i < dataset->part.column_count && dataset->selectors; i++)
    free(dataset->selectors[i]);
  free(dataset->selectors);
  part_release(&dataset->part);
  memory_release(&dataset->memory);
  free(dataset->kept);
  free(dataset->path);
  free(dataset);
  *pointer = NULL;
}

static bool points_have(const Part *part, const char *name) {
  for (int i = 0; i < part->column_count; i++)
    if (part->columns[i].association == TETCAST_POINT && !strcmp(part->columns[i].name, name))
      return true;
  return false;
}

static void name_arrays(TetcastDataset *dataset) {
  const Part *part = &dataset->part;
  dataset->selectors = cli_allocate(sizeof *dataset->selectors * (size_t)(part->column_count + 1));
  for (int i = 0; i < part->column_count; i++) {
    const Column *column = &part->columns[i];
    const bool both = column->association == TETCAST_CELL && points_have(part, column->name);
    dataset->selectors[i] = cli_print("%s%s", column->name, both ? ":cell" : "");
  }
}

/* Tells of fields that can't be drawn, unless only others are asked for. */
static void warn_of_faults(const TetcastDataset *dataset, const char *only) {
  for (int i = 0; i < dataset->part.column_count; i++) {
    const Column *column = &dataset->part.columns[i];
    if (column->fault && !only)
      cli_warning("fields/%s is left out: %s", column->name, column->fault);
  }
}

static TetcastStatus read_dataset(TetcastContext *context, const char *path, const TetcastDatasetDesc *desc,
                                  TetcastDataset **result) {
  (void)path;
  TetcastDataset *dataset = cli_allocate(sizeof *dataset);
  *dataset =
      (TetcastDataset){.context = context, .path = cli_duplicate(handed_over.path), .average = desc->cell_to_point};
  TetcastStatus status =
      read_all(dataset, desc->part) && stretch(dataset, desc->stretch) ? make_tetrahedra(dataset) : TETCAST_ERROR_DATA;
  if (status == TETCAST_OK) {
    name_arrays(dataset);
    warn_of_faults(dataset, desc->only);
    *result = dataset;
    return TETCAST_OK;
  }
  destroy_dataset(&dataset);
  return status;
}

/* Array i of those that can be drawn, or that can't. */
static int find_column(const TetcastDataset *dataset, int i, bool fault) {
  for (int k = 0; k < dataset->part.column_count; k++)
    if ((dataset->part.columns[k].fault != NULL) == fault && i-- == 0)
      return k;
  return -1;
}

static bool describe_array(const TetcastDataset *dataset, int i, TetcastDatasetArray *array) {
  const int k = find_column(dataset, i, false);
  if (k < 0)
    return false;
  const Column *column = &dataset->part.columns[k];
  *array = (TetcastDatasetArray){.name = column->name,
                                 .selector = dataset->selectors[k],
                                 .association = column->association,
                                 .components = column->components,
                                 .type = column->type,
                                 .active = column->active};
  return true;
}

static const char *unread_array(const TetcastDataset *dataset, int i) {
  const int k = find_column(dataset, i, true);
  return k < 0 ? NULL : dataset->part.columns[k].name;
}

static TetcastStatus make_mesh(const TetcastDataset *dataset, TetcastMesh **mesh) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = dataset->vertices;
  desc.tetrahedra = dataset->tetrahedra;
  desc.ownership = TETCAST_BORROW;
  return tetcast_mesh_create(dataset->context, &desc, mesh);
}

/* Means over the cells that use a point, component by component, without those that have no finite value. Points that
 * no cell uses, which are not drawn, get the value of another. */
static void average(const TetcastDataset *dataset, const Selection *selection, double *values) {
  const Part *part = &dataset->part;
  const Column *column = selection->column;
  const bool all = selection->component == SELECTION_MAGNITUDE;
  const int width = all ? column->components : 1, first = all ? 0 : selection->component;
  const int64_t points = part->cells.vertices.count;
  Memory own = {0};
  double *sums = memory_take(&own, points * width, sizeof *sums), *tuple = memory_take(&own, width, sizeof *tuple);
  int64_t *counts = memory_take(&own, points, sizeof *counts), *last = memory_take(&own, points, sizeof *last);
  for (int64_t i = 0; i < points * width; i++)
    sums[i] = 0;
  for (int64_t i = 0; i < points; i++) {
    counts[i] = 0;
    last[i] = -1; /* the cell that was at the point last, as some list a point twice */
  }
  for (int64_t i = 0; i < part->cell_count; i++) {
    const uint8_t type = part->cells.types ? part->cells.types[i] : (uint8_t)part->cells.type;
    if (type < TETCAST_CELL_TETRAHEDRON)
      continue;
    bool finite = true;
    for (int k = 0; k < width; k++)
      finite = isfinite(tuple[k] = view_value(&column->component[first + k], i)) && finite;
    for (int64_t j = 0; j < part_cell_size(part, i); j++) {
      const int64_t point = part_cell_node(part, i, j);
      if (point < 0 || point >= points || last[point] == i) /* what is out of range is told of with the mesh */
        continue;
      last[point] = i;
      counts[point] += finite;
      for (int k = 0; k < width && finite; k++)
        sums[point * width + k] += tuple[k];
    }
  }
  double other = 0;
  for (int64_t i = points; i-- > 0;) {
    for (int k = 0; k < width; k++)
      tuple[k] = sums[i * width + k] / (double)counts[i]; /* NaN where there is none */
    values[i] = all ? selection_length(tuple, width) : tuple[0];
    other = counts[i] > 0 ? values[i] : other;
  }
  for (int64_t i = 0; i < points; i++)
    values[i] = last[i] < 0 ? other : values[i];
  memory_release(&own);
}

/* Values of the cells' own, for each tetrahedron, or of all vertices with those that were added. */
static TetcastArray spread(const TetcastDataset *dataset, const TetcastArray *values, bool of_cells, Memory *memory) {
  const View view = view_of_array(values);
  const int64_t size = view_type_size(view.type), added = dataset->cut_info.added_vertices;
  const TetcastArray sources = tetcast_cut_sources(dataset->cut);
  const int64_t count = of_cells ? sources.count : view.count + added;
  char *all = memory_take(memory, count, (size_t)size);
  const int32_t *source = sources.data;
  for (int64_t i = 0; i < (of_cells ? count : view.count); i++)
    memcpy(all + i * size, view.data + (of_cells ? source[i] : i) * view.stride, (size_t)size);
  if (!of_cells) {
    double *more = memory_take(memory, added, sizeof *more);
    const TetcastArray tuples = {.data = view.data, .type = values->type, .count = view.count, .stride = view.stride};
    tetcast_cut_interpolate(dataset->cut, &tuples, 1, more);
    for (int64_t i = 0; i < added; i++) {
      const float single = (float)more[i];
      memcpy(all + (view.count + i) * size, view.type == VIEW_FLOAT32 ? (const void *)&single : &more[i], (size_t)size);
    }
  }
  return (TetcastArray){.data = all, .type = values->type, .count = count};
}

static TetcastStatus make_field(const TetcastDataset *dataset, const char *selector, TetcastField **field,
                                const char **name) {
  Selection selection;
  const TetcastStatus found = selection_find(dataset, selector, &selection);
  if (found != TETCAST_OK)
    return found;
  const Column *column = selection.column;
  const bool averaged = dataset->average && column->association == TETCAST_CELL;
  const bool of_cells = column->association == TETCAST_CELL && !averaged;
  const bool extended = !of_cells && dataset->cut_info.added_vertices > 0;
  TetcastFieldDesc desc = tetcast_field_desc_default();
  Memory own = {0};
  desc.association = of_cells ? TETCAST_CELL : TETCAST_POINT;
  desc.ownership = TETCAST_BORROW;
  if (!averaged && selection.component != SELECTION_MAGNITUDE)
    desc.values = view_array(&column->component[selection.component]);
  if (desc.values.type == TETCAST_TYPE_NONE ||
      (extended && !view_is_real(&column->component[selection.component < 0 ? 0 : selection.component]))) {
    const int64_t count = averaged ? dataset->part.cells.vertices.count : column->component[0].count;
    double *values = memory_take(&own, count, sizeof *values);
    if (averaged)
      average(dataset, &selection, values);
    for (int64_t i = 0; i < count && !averaged; i++)
      values[i] = selection_value(&selection, i);
    desc.values = (TetcastArray){.data = values, .type = TETCAST_TYPE_FLOAT64, .count = count};
    desc.ownership = TETCAST_COPY;
  }
  if (extended || (of_cells && dataset->cut)) {
    desc.values = spread(dataset, &desc.values, of_cells, &own);
    desc.ownership = TETCAST_COPY;
  }
  const TetcastStatus status = tetcast_field_create(dataset->context, &desc, field);
  memory_release(&own);
  if (status == TETCAST_OK && name) {
    const char *base = dataset->selectors[column - dataset->part.columns];
    TetcastDataset *mine = NULL;
    memcpy(&mine, &dataset, sizeof mine); /* whose last selector is kept as long as it */
    free(mine->kept);
    mine->kept = selection.whole                              ? cli_duplicate(base)
                 : selection.component == SELECTION_MAGNITUDE ? cli_print("%s:mag", base)
                                                              : cli_print("%s:%d", base, selection.component);
    *name = mine->kept;
  }
  return status;
}

/* ── what else the command asks of its adapter ── */

static TetcastDatasetDesc default_desc(void) {
  return (TetcastDatasetDesc){.time = (double)NAN, .merge_tolerance = -1, .stretch = {1, 1, 1}};
}

/* Each process reads what is its own, by the same name. */
static TetcastStatus list_parts(TetcastContext *context, const char *path, const TetcastDatasetDesc *desc,
                                TetcastDatasetPart *part, void *user) {
  (void)context, (void)desc;
  for (int i = 0; i < handed_over.processes; i++)
    part(user, path, 1);
  return TETCAST_OK;
}

/* Whether there are cells at all. */
static bool find_type(const TetcastDataset *dataset, int i, const char **name, int64_t *count) {
  (void)name, (void)count;
  return i == 0 && dataset->tetrahedra.count > 0;
}

static bool find_time(const TetcastDataset *dataset, int64_t i, double *time) {
  (void)dataset, (void)i, (void)time;
  return false;
}

static int64_t find_step(const TetcastDataset *dataset) {
  (void)dataset;
  return 0;
}

/* Colour maps in XML are files, which VTK's adapter reads; it is loaded for that. */
static TetcastStatus read_xml(TetcastContext *context, const char *path, TetcastXmlElement *element, void *user) {
  cli_set_source(NULL);
  const CliVtk *vtk = cli_vtk();
  const TetcastStatus status = vtk ? vtk->xml_read(context, path, element, user) : TETCAST_ERROR_UNSUPPORTED;
  cli_set_source(source_functions());
  return status;
}

const CliVtk *source_functions(void) {
  static const CliVtk functions = {.dataset_desc_default = default_desc,
                                   .dataset_read = read_dataset,
                                   .dataset_destroy = destroy_dataset,
                                   .dataset_parts = list_parts,
                                   .dataset_cell_type = find_type,
                                   .dataset_array = describe_array,
                                   .dataset_unread = unread_array,
                                   .dataset_time = find_time,
                                   .dataset_step = find_step,
                                   .dataset_mesh = make_mesh,
                                   .dataset_field = make_field,
                                   .xml_read = read_xml};
  return &functions;
}
