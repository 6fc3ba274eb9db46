/* SPDX-License-Identifier: Apache-2.0 */
/* One mesh of Conduit's blueprint as the library takes it: its arrays in place where that can be. What can't be drawn
 * is told by one line that names the path. */
#ifndef TETCAST_CATALYST_PART_H
#define TETCAST_CATALYST_PART_H

#include <tetcast/cells.h>
#include <tetcast/field.h>

#include "conduit.h"

/* An array of points or cells. */
typedef struct Column {
  char *name;
  TetcastAssociation association;
  int components;
  View *component; /* [components] */
  char **names;    /* [components]: what they are called; NULL: x, y, z and the like */
  const char *type;
  bool active;  /* marked as that which is to be drawn */
  bool numbers; /* numbers points or cells */
  char *fault;  /* why it can't be drawn; NULL: it can */
} Column;

typedef struct Part {
  char *path; /* of the mesh, such as catalyst/channels/grid/data */
  const ConduitNode *data, *topology;
  char *topology_name;
  TetcastCellsDesc cells; /* its vertices, and cells of any types; offsets are none where all are of one type */
  int64_t cell_count;
  int64_t flat_cells; /* of surfaces, lines and points, which are not drawn */
  uint8_t *hidden;    /* [cell_count]: 1 where a cell is a ghost; NULL: none is */
  Column *columns;    /* [column_count], those of points first */
  int column_count, column_capacity;
  Memory memory;
} Part;

/* Each returns false after a message. `path` names the coordinates. */
bool coordinates_read(Part *part, const ConduitNode *coordset, const char *path, int64_t grid[3]);

/* Chooses the topology that is named, or (NULL) the first that has cells with a volume; with its cells and vertices.
 * True without cells: it has none, or only flat ones. */
bool topology_read(Part *part, const char *name);

/* Takes the arrays of the topology; those that can't be drawn have a fault. Ghosts become part->hidden. */
bool fields_read(Part *part);

/* A column more, of zeros but for its name. */
Column *part_add_column(Part *part, const char *name);

void part_release(Part *part);

/* Makes one of several, whose points become one where they coincide but are of different parts, without ghosts and the
 * points that only they use. The parts are released. */
bool parts_unite(Part *parts, int count, Part *whole);

/* Node `k` of cell i, of `part_cell_size()` nodes. */
int64_t part_cell_size(const Part *part, int64_t i);
int64_t part_cell_node(const Part *part, int64_t i, int64_t k);

#endif
