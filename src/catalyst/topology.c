/* SPDX-License-Identifier: Apache-2.0 */
/* Topologies: unstructured ones of one shape or of several, and grids. */
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "part.h"

/* Blueprint's names, with VTK's numbers and orders of nodes, which all programs take them to have. */
typedef struct Shape {
  const char *name;
  uint8_t type;
  int nodes; /* 0: any number */
  bool flat;
} Shape;

static const Shape shapes[] = {{"tet", TETCAST_CELL_TETRAHEDRON, 4, false},
                               {"hex", TETCAST_CELL_HEXAHEDRON, 8, false},
                               {"wedge", TETCAST_CELL_WEDGE, 6, false},
                               {"pyramid", TETCAST_CELL_PYRAMID, 5, false},
                               {"polyhedral", TETCAST_CELL_POLYHEDRON, 0, false},
                               {"polyhedron", TETCAST_CELL_POLYHEDRON, 0, false},
                               {"point", 1, 1, true},
                               {"vertex", 1, 1, true},
                               {"line", 3, 2, true},
                               {"tri", 5, 3, true},
                               {"quad", 9, 4, true},
                               {"polygonal", 7, 0, true},
                               {"polygon", 7, 0, true}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static const Shape *find_shape(const char *name) {
  for (int i = 0; name && i < SHAPES; i++)
    if (!strcmp(name, shapes[i].name))
      return &shapes[i];
  return NULL;
}

static bool refuse_shape(const char *path, const char *name) {
  cli_error("%s: unknown shape '%s': expected tet, hex, wedge, pyramid, polyhedral or mixed", path, name ? name : "");
  return false;
}

/* Cells as blueprint has them: each with a place and a number of entries in the connectivity. */
typedef struct Elements {
  char *path; /* of the topology */
  int64_t count;
  const uint8_t *types; /* [count] */
  View connectivity, sizes;
  const int64_t *starts; /* [count] */
} Elements;

static bool take_integers(const ConduitNode *node, const char *path, const char *name, View *view) {
  const ConduitNode *leaf = conduit_at(node, name);
  if (leaf && conduit_view(leaf, view) && (!view_is_real(view) || view->count == 0))
    return true;
  cli_error(leaf ? "%s/%s: expected whole numbers" : "%s: has no %s", path, name);
  return false;
}

/* As the library takes integers: tuples of so many that lie next to each other, of 32 or 64 bits. */
static TetcastArray tuples_of(Memory *memory, const View *view, int size) {
  TetcastArray array = view_array(view);
  const int64_t bytes = view_type_size(view->type);
  array.count = view->count / size;
  array.stride = size == 1 ? view->stride : bytes * size;
  if (array.type != TETCAST_TYPE_NONE && (size == 1 || view->stride == bytes))
    return array;
  int64_t *copy = memory_take(memory, view->count, sizeof *copy);
  for (int64_t i = 0; i < view->count; i++)
    copy[i] = view_index(view, i);
  return (TetcastArray){.data = copy, .type = TETCAST_TYPE_INT64, .count = array.count};
}

/* Where each of the parts begins that have these sizes: as the offsets say, or one after the other. */
static bool find_starts(Memory *memory, const ConduitNode *node, const char *path, Elements *e) {
  View offsets = {.data = NULL};
  const bool given = conduit_at(node, "offsets") != NULL;
  if (!take_integers(node, path, "connectivity", &e->connectivity) || !take_integers(node, path, "sizes", &e->sizes) ||
      (given && !take_integers(node, path, "offsets", &offsets)))
    return false;
  e->count = e->sizes.count;
  if (given && offsets.count < e->count) {
    cli_error("%s: has %lld sizes, but %lld offsets", path, (long long)e->count, (long long)offsets.count);
    return false;
  }
  int64_t *starts = memory_take(memory, e->count, sizeof *starts), end = 0;
  for (int64_t i = 0; i < e->count; i++) {
    const int64_t size = view_index(&e->sizes, i);
    starts[i] = given ? view_index(&offsets, i) : end;
    if (starts[i] < 0 || size < 0 || starts[i] > e->connectivity.count || size > e->connectivity.count - starts[i]) {
      cli_error("%s: element %lld has the entries %lld to %lld, but connectivity has %lld", path, (long long)i,
                (long long)starts[i], (long long)(starts[i] + size - 1), (long long)e->connectivity.count);
      return false;
    }
    end = starts[i] + size;
  }
  e->starts = starts;
  return true;
}

/* ── polyhedra ── */

/* Whether all faces are there that polyhedra name. */
static bool check_faces(const Elements *e, const Elements *faces) {
  for (int64_t i = 0; i < e->count; i++)
    for (int64_t k = 0; e->types[i] == TETCAST_CELL_POLYHEDRON && k < view_index(&e->sizes, i); k++) {
      const int64_t face = view_index(&e->connectivity, e->starts[i] + k);
      if (face >= 0 && face < faces->count)
        continue;
      cli_error("%s/elements/connectivity: element %lld has face %lld, but there are %lld faces", e->path, (long long)i,
                (long long)face, (long long)faces->count);
      return false;
    }
  return true;
}

/* Adds the corners of a face to the nodes of its cell, each once: `last` has the cell that each vertex was in last. */
static bool add_corners(const Elements *faces, int64_t face, int64_t cell, int64_t *last, int64_t vertices,
                        int64_t **node, int64_t **list) {
  const int64_t size = view_index(&faces->sizes, face);
  *(*list)++ = size;
  for (int64_t k = 0; k < size; k++) {
    const int64_t vertex = view_index(&faces->connectivity, faces->starts[face] + k);
    if (vertex < 0 || vertex >= vertices) {
      cli_error("%s/connectivity: face %lld has vertex %lld, but there are %lld vertices", faces->path, (long long)face,
                (long long)vertex, (long long)vertices);
      return false;
    }
    *(*list)++ = vertex;
    if (last[vertex] != cell)
      *(*node)++ = vertex;
    last[vertex] = cell;
  }
  return true;
}

/* Writes nodes in place of faces, and the faces as a list of their own. */
static bool connect_polyhedra(Part *part, const Elements *e, const Elements *faces) {
  int64_t nodes = 0, entries = 0;
  for (int64_t i = 0; i < e->count; i++) {
    const int64_t size = view_index(&e->sizes, i);
    int64_t corners = size;
    if (e->types[i] == TETCAST_CELL_POLYHEDRON) {
      corners = 0;
      for (int64_t k = 0; k < size; k++)
        corners += view_index(&faces->sizes, view_index(&e->connectivity, e->starts[i] + k));
      entries += 1 + size + corners;
    }
    nodes += corners;
  }
  const int64_t vertices = part->cells.vertices.count;
  int64_t *offset = memory_take(&part->memory, e->count + 1, sizeof *offset),
          *place = memory_take(&part->memory, e->count, sizeof *place),
          *first = memory_take(&part->memory, nodes, sizeof *first),
          *list = memory_take(&part->memory, entries, sizeof *list), *node = first, *next = list;
  Memory own = {0};
  int64_t *last = memory_take(&own, vertices, sizeof *last);
  bool fine = true;
  for (int64_t i = 0; i < vertices; i++)
    last[i] = -1;
  for (int64_t i = 0; i < e->count && fine; i++) {
    const int64_t size = view_index(&e->sizes, i);
    offset[i] = node - first;
    place[i] = next - list;
    if (e->types[i] == TETCAST_CELL_POLYHEDRON)
      *next++ = size;
    for (int64_t k = 0; k < size && fine; k++) {
      const int64_t entry = view_index(&e->connectivity, e->starts[i] + k);
      if (e->types[i] == TETCAST_CELL_POLYHEDRON)
        fine = add_corners(faces, entry, i, last, vertices, &node, &next);
      else
        *node++ = entry;
    }
  }
  memory_release(&own);
  offset[e->count] = node - first;
  TetcastCellsDesc *cells = &part->cells;
  cells->offsets = (TetcastArray){.data = offset, .type = TETCAST_TYPE_INT64, .count = e->count + 1};
  cells->connectivity = (TetcastArray){.data = first, .type = TETCAST_TYPE_INT64, .count = offset[e->count]};
  cells->face_offsets = (TetcastArray){.data = place, .type = TETCAST_TYPE_INT64, .count = e->count};
  cells->faces = (TetcastArray){.data = list, .type = TETCAST_TYPE_INT64, .count = next - list};
  return fine;
}

static bool read_faces(Part *part, const Elements *e) {
  Elements faces = {.path = cli_print("%s/subelements", e->path)};
  const ConduitNode *node = conduit_at(part->topology, "subelements");
  if (!node)
    cli_error("%s: has no subelements, which the faces of polyhedra are", e->path);
  const bool fine = node && find_starts(&part->memory, node, faces.path, &faces) && check_faces(e, &faces) &&
                    connect_polyhedra(part, e, &faces);
  free(faces.path);
  return fine;
}

/* ── several shapes ── */

/* Cells without polyhedra, in place if one follows the other. */
static void connect_in_place(Part *part, const Elements *e) {
  int64_t *offset = memory_take(&part->memory, e->count + 1, sizeof *offset), end = 0;
  bool dense = true;
  for (int64_t i = 0; i < e->count; i++) {
    dense = dense && e->starts[i] == end;
    offset[i] = end;
    end += view_index(&e->sizes, i);
  }
  offset[e->count] = end;
  part->cells.offsets = (TetcastArray){.data = offset, .type = TETCAST_TYPE_INT64, .count = e->count + 1};
  part->cells.connectivity = tuples_of(&part->memory, &e->connectivity, 1);
  if (dense)
    return;
  int64_t *copy = memory_take(&part->memory, end, sizeof *copy);
  for (int64_t i = 0; i < e->count; i++)
    for (int64_t k = 0; k < offset[i + 1] - offset[i]; k++)
      copy[offset[i] + k] = view_index(&e->connectivity, e->starts[i] + k);
  part->cells.connectivity = (TetcastArray){.data = copy, .type = TETCAST_TYPE_INT64, .count = end};
}

/* The numbers that shapes have in a map of them. */
typedef struct ShapeMap {
  struct {
    int64_t number;
    const Shape *shape;
  } entry[64];
  int count;
} ShapeMap;

static bool read_map(const ConduitNode *elements, const char *path, ShapeMap *map) {
  const ConduitNode *node = conduit_at(elements, "shape_map");
  if (!node) {
    cli_error("%s: has no shape_map, which tells what the numbers of shapes are", path);
    return false;
  }
  for (int64_t i = 0; i < conduit_children(node) && map->count < 64; i++) {
    char *name = conduit_name(conduit_child(node, i));
    const Shape *shape = find_shape(name);
    int64_t number = 0;
    const bool fine = conduit_integer(conduit_child(node, i), &number);
    if (!fine)
      cli_error("%s/shape_map/%s: expected a whole number", path, name);
    else if (!shape)
      cli_error("%s/shape_map: unknown shape '%s'", path, name);
    free(name);
    if (!fine || !shape)
      return false;
    map->entry[map->count].number = number;
    map->entry[map->count++].shape = shape;
  }
  return true;
}

static bool read_types(Part *part, const ConduitNode *elements, const char *path, Elements *e, bool *polyhedra) {
  ShapeMap map = {.count = 0};
  View numbers;
  if (!read_map(elements, path, &map) || !take_integers(elements, path, "shapes", &numbers))
    return false;
  if (numbers.count != e->count) {
    cli_error("%s: has %lld shapes, but %lld sizes", path, (long long)numbers.count, (long long)e->count);
    return false;
  }
  uint8_t *types = memory_take(&part->memory, e->count, sizeof *types);
  for (int64_t i = 0, k = 0; i < e->count; i++) {
    const int64_t number = view_index(&numbers, i);
    for (int tried = 0; tried < map.count && map.entry[k].number != number; tried++)
      k = (k + 1) % map.count;
    if (map.count == 0 || map.entry[k].number != number) {
      cli_error("%s/shapes: element %lld has the shape %lld, which shape_map does not name", path, (long long)i,
                (long long)number);
      return false;
    }
    types[i] = map.entry[k].shape->type;
    *polyhedra = *polyhedra || types[i] == TETCAST_CELL_POLYHEDRON;
    part->flat_cells += map.entry[k].shape->flat;
  }
  e->types = types;
  return true;
}

/* Elements of several shapes, or (`shape` not NULL) of one that have no fixed number of nodes. */
static bool read_mixed(Part *part, const ConduitNode *elements, const char *path, const Shape *shape) {
  Elements e = {.path = cli_print("%.*s", (int)(strrchr(path, '/') - path), path)};
  bool polyhedra = shape != NULL;
  bool fine = find_starts(&part->memory, elements, path, &e);
  if (fine && shape) {
    uint8_t *types = memory_take(&part->memory, e.count, sizeof *types);
    memset(types, shape->type, (size_t)e.count);
    e.types = types;
  } else if (fine) {
    fine = read_types(part, elements, path, &e, &polyhedra);
  }
  part->cell_count = e.count;
  part->cells.types = e.types;
  if (fine && polyhedra)
    fine = read_faces(part, &e);
  else if (fine)
    connect_in_place(part, &e);
  free(e.path);
  return fine;
}

/* ── all kinds ── */

static bool read_unstructured(Part *part, const char *topology) {
  const ConduitNode *elements = conduit_at(part->topology, "elements");
  const char *name = conduit_text(conduit_at(elements, "shape"));
  char *path = cli_print("%s/elements", topology);
  const Shape *shape = find_shape(name);
  View connectivity;
  bool fine = true;
  if (!name || (!shape && strcmp(name, "mixed"))) {
    char *place = cli_print("%s/shape", path);
    fine = refuse_shape(place, name);
    free(place);
  } else if (!shape || shape->type == TETCAST_CELL_POLYHEDRON) {
    fine = read_mixed(part, elements, path, shape);
  } else if ((fine = take_integers(elements, path, "connectivity", &connectivity))) {
    part->cell_count = connectivity.count / shape->nodes;
    if (connectivity.count % shape->nodes) {
      cli_error("%s/connectivity: has %lld numbers, which is no multiple of the %d of a %s", path,
                (long long)connectivity.count, shape->nodes, shape->name);
      fine = false;
    }
    part->cells.type = (TetcastCellType)shape->type;
    part->cells.connectivity = tuples_of(&part->memory, &connectivity, shape->nodes);
  }
  free(path);
  return fine;
}

/* Hexahedra between the points of a grid, whose cells go along i first, then j, then k. */
static void connect_grid(Part *part, const int64_t grid[3]) {
  if (grid[0] < 2 || grid[1] < 2 || grid[2] < 2) { /* a surface, a line or a point */
    part->flat_cells = grid[0] > 0 && grid[1] > 0;
    return;
  }
  const int64_t row = grid[0], layer = grid[0] * grid[1], cells = (grid[0] - 1) * (grid[1] - 1) * (grid[2] - 1);
  const int64_t corner[8] = {0, 1, row + 1, row, layer, layer + 1, layer + row + 1, layer + row};
  int32_t *node = memory_take(&part->memory, 8 * cells, sizeof *node);
  part->cell_count = cells;
  part->cells.type = TETCAST_CELL_HEXAHEDRON;
  part->cells.connectivity = (TetcastArray){.data = node, .type = TETCAST_TYPE_INT32, .count = cells};
  for (int64_t k = 0; k + 1 < grid[2]; k++)
    for (int64_t j = 0; j + 1 < grid[1]; j++)
      for (int64_t i = 0; i + 1 < grid[0]; i++)
        for (int c = 0; c < 8; c++)
          *node++ = (int32_t)(i + row * j + layer * k + corner[c]);
}

static bool read_structured(Part *part, const char *topology) {
  static const char *const dims[3] = {"elements/dims/i", "elements/dims/j", "elements/dims/k"};
  int64_t grid[3] = {0, 0, 0}, points = 1;
  if (conduit_at(part->topology, "elements/dims/strides") || conduit_at(part->topology, "elements/dims/offsets")) {
    cli_error("%s/elements/dims: strides and offsets in a structured topology are not supported", topology);
    return false;
  }
  for (int k = 0; k < 3; k++) {
    const ConduitNode *node = conduit_at(part->topology, dims[k]);
    if (!node && k > 0)
      break;
    if (!node || !conduit_integer(node, &grid[k]) || grid[k] < 0 || grid[k] >= INT32_MAX) {
      cli_error("%s/%s: expected a whole number of elements", topology, dims[k]);
      return false;
    }
    grid[k]++;
    points = points > INT32_MAX ? points : points * grid[k];
  }
  if (points != part->cells.vertices.count) {
    cli_error("%s/elements/dims: a grid of %lld points, but its coordinates are of %lld", topology, (long long)points,
              (long long)part->cells.vertices.count);
    return false;
  }
  connect_grid(part, grid);
  return true;
}

/* Cells and coordinates of the topology that was chosen. */
static bool read_chosen(Part *part, const char *path, const char *type) {
  const char *name = conduit_text(conduit_at(part->topology, "coordset"));
  char *place = cli_print("%s/coordsets/%s", part->path, name ? name : "");
  const ConduitNode *coordset = name ? conduit_at(part->data, place + strlen(part->path) + 1) : NULL;
  int64_t grid[3];
  bool fine = false;
  if (!name)
    cli_error("%s: has no coordset", path);
  else if (!coordset)
    cli_error("%s/coordset: there is no coordset '%s'", path, name);
  else
    fine = coordinates_read(part, coordset, place, grid);
  free(place);
  if (!fine)
    return false;
  if (!strcmp(type, "unstructured"))
    return read_unstructured(part, path);
  if (!strcmp(type, "structured"))
    return read_structured(part, path);
  if (grid[0] == 0 && part->cells.vertices.count > 0) {
    cli_error("%s/type: %s, but its coordinates are explicit", path, type);
    return false;
  }
  connect_grid(part, grid);
  return true;
}

/* Whether a topology is of surfaces, lines or points by its kind; 0 or 1, or -1 after a message. */
static int is_flat(const ConduitNode *topology, const char *path, const char **type) {
  static const char *const types[] = {"unstructured", "uniform", "rectilinear", "structured"};
  *type = conduit_text(conduit_at(topology, "type"));
  const char *name = conduit_text(conduit_at(topology, "elements/shape"));
  const Shape *shape = find_shape(name);
  if (*type && !strcmp(*type, "points"))
    return 1;
  for (int i = 0; i < 4 && *type; i++)
    if (!strcmp(*type, types[i]))
      return i == 0 && shape && shape->flat;
  cli_error("%s/type: expected unstructured, uniform, rectilinear or structured, not '%s'", path, *type ? *type : "");
  return -1;
}

/* As if the topology were not there. */
static void leave_out(Part *part) {
  free(part->topology_name);
  part->topology_name = NULL;
  part->cell_count = 0;
  part->cells = tetcast_cells_desc_default();
}

bool topology_read(Part *part, const char *name) {
  const ConduitNode *topologies = conduit_at(part->data, "topologies");
  if (!topologies) {
    cli_error("%s: has no topologies", part->path);
    return false;
  }
  const int64_t count = conduit_children(topologies);
  for (int64_t i = 0; i < count; i++) {
    const char *type;
    char *own = conduit_name(conduit_child(topologies, i));
    if (name && strcmp(name, own)) {
      free(own);
      continue;
    }
    char *path = cli_print("%s/topologies/%s", part->path, own);
    const int64_t before = part->flat_cells;
    part->topology = conduit_child(topologies, i);
    part->topology_name = own;
    const int flat = is_flat(part->topology, path, &type);
    const bool fine = flat > 0 || (flat == 0 && read_chosen(part, path, type));
    free(path);
    if (!fine)
      return false;
    part->flat_cells += flat;
    if (part->cell_count > part->flat_cells - before)
      return true;
    leave_out(part);
  }
  if (!name || part->topology)
    return true;
  cli_error("%s/topologies: there is no topology '%s'", part->path, name);
  return false;
}
