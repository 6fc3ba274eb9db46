/* SPDX-License-Identifier: Apache-2.0 */
/* Fields of a mesh: its arrays, and which of its cells are ghosts. */
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "part.h"

/* VTK's bits of ghosts that are not drawn: copies of another part's cells, refined and hidden ones; and hidden points.
 */
enum { GHOST_CELLS = 1 | 8 | 32, GHOST_POINTS = 2 };

Column *part_add_column(Part *part, const char *name) {
  part->columns = cli_grow(part->columns, part->column_count, &part->column_capacity, sizeof *part->columns);
  Column *column = &part->columns[part->column_count++];
  *column = (Column){.name = cli_duplicate(name), .type = ""};
  return column;
}

static void release_column(Column *column) {
  for (int k = 0; column->names && k < column->components; k++)
    free(column->names[k]);
  free(column->names);
  free(column->component);
  free(column->fault);
  free(column->name);
}

void part_release(Part *part) {
  for (int i = 0; i < part->column_count; i++)
    release_column(&part->columns[i]);
  free(part->columns);
  free(part->topology_name);
  free(part->path);
  memory_release(&part->memory);
  *part = (Part){.path = NULL};
}

int64_t part_cell_size(const Part *part, int64_t i) {
  const TetcastCellsDesc *cells = &part->cells;
  if (cells->offsets.type == TETCAST_TYPE_NONE)
    return cells->type == TETCAST_CELL_HEXAHEDRON    ? 8
           : cells->type == TETCAST_CELL_WEDGE       ? 6
           : cells->type == TETCAST_CELL_PYRAMID     ? 5
           : cells->type == TETCAST_CELL_TETRAHEDRON ? 4
                                                     : 0;
  const View offsets = view_of_array(&cells->offsets);
  return view_index(&offsets, i + 1) - view_index(&offsets, i);
}

int64_t part_cell_node(const Part *part, int64_t i, int64_t k) {
  const TetcastCellsDesc *cells = &part->cells;
  const View nodes = view_of_array(&cells->connectivity);
  if (cells->offsets.type == TETCAST_TYPE_NONE) {
    const View own = {.data = nodes.data + i * (cells->connectivity.stride
                                                    ? cells->connectivity.stride
                                                    : part_cell_size(part, i) * view_type_size(nodes.type)),
                      .type = nodes.type,
                      .stride = view_type_size(nodes.type)};
    return view_index(&own, k);
  }
  const View offsets = view_of_array(&cells->offsets);
  return view_index(&nodes, view_index(&offsets, i) + k);
}

/* ── ghosts ── */

/* What a number of a field of ghosts stands for: as its metadata replaces it. */
static int64_t replaced(const View *from, const View *to, int64_t mark) {
  for (int64_t i = 0; i < from->count && i < to->count; i++)
    if (view_index(from, i) == mark)
      return view_index(to, i);
  return mark;
}

static void hide_cells_of(Part *part, const uint8_t *points) {
  for (int64_t i = 0; i < part->cell_count; i++)
    for (int64_t k = part_cell_size(part, i); k > 0 && !part->hidden[i]; k--) {
      const int64_t node = part_cell_node(part, i, k - 1);
      part->hidden[i] = node >= 0 && node < part->cells.vertices.count && points[node]; /* others are told of later */
    }
}

/* Marks the cells that a field of ghosts says are some. */
static bool take_ghosts(Part *part, const ConduitNode *field, const char *name, const ConduitNode *metadata,
                        bool of_points) {
  View marks, from = {.data = NULL}, to = {.data = NULL};
  const int64_t count = of_points ? part->cells.vertices.count : part->cell_count;
  const ConduitNode *values = conduit_at(field, "values");
  if (!values || !conduit_view(values, &marks) || marks.count != count) {
    cli_error("%s/fields/%s/values: expected a number for each of %lld %s, as they say which are ghosts", part->path,
              name, (long long)count, of_points ? "points" : "cells");
    return false;
  }
  if (conduit_at(metadata, "values_to_replace") && conduit_at(metadata, "replacement_values")) {
    conduit_view(conduit_at(metadata, "values_to_replace"), &from);
    conduit_view(conduit_at(metadata, "replacement_values"), &to);
  }
  const bool any = !strcmp(name, "ascent_ghosts"); /* which has other marks: all but 0 are ghosts */
  Memory own = {0};
  uint8_t *points = of_points ? memory_take(&own, count, 1) : NULL;
  if (!part->hidden) {
    part->hidden = memory_take(&part->memory, part->cell_count, 1);
    memset(part->hidden, 0, (size_t)part->cell_count);
  }
  for (int64_t i = 0; i < count; i++) {
    const int64_t mark = replaced(&from, &to, (int64_t)view_value(&marks, i));
    const bool ghost = any ? mark != 0 : (mark & (of_points ? GHOST_POINTS : GHOST_CELLS)) != 0;
    if (of_points)
      points[i] = ghost;
    else
      part->hidden[i] |= ghost;
  }
  if (of_points)
    hide_cells_of(part, points);
  memory_release(&own);
  return true;
}

/* ── arrays ── */

/* The components of a field, each of `count` values. What is wrong, for free(); NULL: nothing. */
static char *take_components(Column *column, const ConduitNode *values, int64_t count) {
  const int64_t children = conduit_children(values);
  column->components = children > 0 ? (int)children : 1;
  column->component = cli_allocate(sizeof *column->component * (size_t)column->components);
  if (children > 1 && !conduit_is_list(values)) {
    column->names = cli_allocate(sizeof *column->names * (size_t)children);
    for (int k = 0; k < column->components; k++)
      column->names[k] = conduit_name(conduit_child(values, k));
  }
  for (int k = 0; k < column->components; k++) {
    View *view = &column->component[k];
    if (!conduit_view(children > 0 ? conduit_child(values, k) : values, view))
      return cli_duplicate("its values are not numbers");
    column->type = k == 0 || !strcmp(column->type, view_type_name(view->type)) ? view_type_name(view->type) : "float64";
    if (view->count != count)
      return cli_print("it has %lld values for %lld %s", (long long)view->count, (long long)count,
                       column->association == TETCAST_CELL ? "cells" : "points");
  }
  return NULL;
}

static void take_array(Part *part, const ConduitNode *field, const char *name, const char *association,
                       const char *attribute) {
  const ConduitNode *values = conduit_at(field, "values");
  Column *column = part_add_column(part, name);
  const bool of_cells = association && !strcmp(association, "element");
  column->association = of_cells ? TETCAST_CELL : TETCAST_POINT;
  column->active = attribute && !strcmp(attribute, "Scalars");
  column->numbers = attribute && (!strcmp(attribute, "GlobalIds") || !strcmp(attribute, "PedigreeIds"));
  if (!of_cells && (!association || strcmp(association, "vertex")))
    column->fault = cli_print("its association is '%s', expected vertex or element", association ? association : "");
  else if (!values)
    column->fault = cli_duplicate("it has no values");
  else
    column->fault = take_components(column, values, of_cells ? part->cell_count : part->cells.vertices.count);
}

/* Takes a field, if it is of cells or is not, as is asked for. */
static bool take_field(Part *part, const ConduitNode *field, const char *name, bool of_cells) {
  const char *topology = conduit_text(conduit_at(field, "topology"));
  const char *association = conduit_text(conduit_at(field, "association"));
  if (topology && strcmp(topology, part->topology_name))
    return true;
  if ((association && !strcmp(association, "element")) != of_cells)
    return true;
  char *path = cli_print("state/metadata/vtk_fields/%s", name);
  const ConduitNode *metadata = conduit_at(part->data, path);
  const char *attribute = conduit_text(conduit_at(metadata, "attribute_type"));
  free(path);
  if (!strcmp(name, "ascent_ghosts") || !strcmp(name, "vtkGhostType") || (attribute && !strcmp(attribute, "Ghosts")))
    return take_ghosts(part, field, name, metadata, !of_cells);
  take_array(part, field, name, association, attribute);
  return true;
}

bool fields_read(Part *part) {
  const ConduitNode *fields = conduit_at(part->data, "fields");
  bool fine = true;
  for (int of_cells = 0; of_cells < 2; of_cells++)
    for (int64_t i = 0; i < conduit_children(fields) && fine; i++) {
      char *name = conduit_name(conduit_child(fields, i));
      fine = take_field(part, conduit_child(fields, i), name, of_cells);
      free(name);
    }
  return fine;
}
