/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts cells into tetrahedra. This is done twice: first only to count them, then into memory of the right size. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/cut.h"

enum { GRAIN = 4096, BATCH = 32 };

/* How much a block of cells is cut into; later, where the block's part of the result begins. */
typedef struct Block {
  int64_t tetrahedra, centres, entries;
  TetcastCutInfo info;
} Block;

/* Memory for one cell. Every array has room for `room` elements, tets.p for one more. */
typedef struct Scratch {
  int64_t room;
  void *memory;
  TcTets tets;
  uint32_t *node;                 /* the cell's nodes, as listed */
  uint32_t *size, *corner, *link; /* of a polyhedron */
  bool *turned;
  TcEdge *edge;
  uint32_t *point; /* of a lattice */
  double *weight;
} Scratch;

typedef struct Cutter {
  TetcastContext *context;
  const TetcastCellsDesc *desc;
  TetcastMesh mesh; /* for its vertices */
  int64_t cell_count, vertex_count;
  int64_t offset_stride, node_stride, face_stride, place_stride;
  Scratch *scratch; /* [threads] */
  Block *blocks;
  TcHexahedra hexahedra;
  uint8_t
      *ways; /* [cell_count]: 1 + that of a hexahedron that the table cuts, found the first time; 0: any other cell */
  TetcastCut *cut;
  atomic_llong first_bad;
  bool writes; /* whether this is the second time */
} Cutter;

/* A cell as loaded. */
typedef struct Cell {
  int64_t index, nodes; /* nodes listed */
  unsigned type;
  bool curved, oversized, open;
  bool collapsed; /* a curved one with a corner twice */
  TcShape shape;
  TcLattice lattice;
} Cell;

typedef enum Fault { FINE = 0, NOTHING, BAD_OFFSETS, BAD_NODES, BAD_INDEX, BAD_FACES, NO_MEMORY } Fault;

/* ── memory ── */

static bool reserve(Cutter *cutter, Scratch *scratch, int64_t room) {
  if (room <= scratch->room)
    return true;
  room = room < 2 * scratch->room ? 2 * scratch->room : room;
  TcTets *tets = &scratch->tets;
  const size_t each =
      sizeof *tets->p + sizeof *scratch->weight + sizeof *scratch->edge + sizeof *tets->tet + 6 * sizeof(uint32_t) + 1;
  tc_release(cutter->context, scratch->memory);
  scratch->room = 0;
  if (!tc_allocate_array(cutter->context, &scratch->memory, room + 1, each, "cells"))
    return false;
  scratch->room = room;
  const size_t n = (size_t)room + 1;
  char *at = scratch->memory; /* what needs more alignment comes first */
#define TAKE(array) (array) = (void *)at, at += n * sizeof *(array)
  TAKE(tets->p);
  TAKE(scratch->weight);
  TAKE(scratch->edge);
  TAKE(tets->tet);
  TAKE(tets->id);
  TAKE(scratch->node);
  TAKE(scratch->size);
  TAKE(scratch->corner);
  TAKE(scratch->link);
  TAKE(scratch->point);
  TAKE(scratch->turned);
#undef TAKE
  return true;
}

/* ── one cell as the caller has it ── */

static const struct {
  unsigned type, nodes;
  TcShapeName shape;
} straight[] = {
    {TETCAST_CELL_TETRAHEDRON, 4, TC_TETRAHEDRON},
    {TETCAST_CELL_VOXEL, 8, TC_HEXAHEDRON},
    {TETCAST_CELL_HEXAHEDRON, 8, TC_HEXAHEDRON},
    {TETCAST_CELL_WEDGE, 6, TC_WEDGE},
    {TETCAST_CELL_PYRAMID, 5, TC_PYRAMID},
    {TETCAST_CELL_PENTAGONAL_PRISM, 10, TC_PENTAGONAL_PRISM},
    {TETCAST_CELL_HEXAGONAL_PRISM, 12, TC_HEXAGONAL_PRISM},
};

enum { STRAIGHT = sizeof straight / sizeof *straight };

static unsigned type_of(const Cutter *cutter, int64_t i) {
  return cutter->desc->types ? cutter->desc->types[i] : (unsigned)cutter->desc->type;
}

int64_t tc_cell_nodes(unsigned type) {
  for (int k = 0; k < STRAIGHT; ++k) {
    if (straight[k].type == type)
      return straight[k].nodes;
  }
  return tc_is_curved(type) ? tc_curved_nodes(type) : 0;
}

/* An integer of a packed array, most often of this type. */
static inline int64_t integer_at(const TetcastArray *array, int64_t stride, int64_t i) {
  if (array->type != TETCAST_TYPE_INT64)
    return tc_array_int64(array, stride, i, 0);
  int64_t value;
  memcpy(&value, (const char *)array->data + i * stride, sizeof value);
  return value;
}

/* Where the cell's nodes are in the connectivity, and how many. */
static bool find_nodes(const Cutter *cutter, int64_t i, int64_t *begin, int64_t *count) {
  const TetcastCellsDesc *desc = cutter->desc;
  *begin = integer_at(&desc->offsets, cutter->offset_stride, i);
  const int64_t end = integer_at(&desc->offsets, cutter->offset_stride, i + 1);
  *count = end - *begin;
  return *begin >= 0 && end >= *begin && end <= desc->connectivity.count;
}

/* The first `count` of the nodes that begin there, to `id`. */
static Fault read_nodes(const Cutter *cutter, int64_t i, int64_t begin, int64_t count, uint32_t *id) {
  const TetcastArray *nodes = &cutter->desc->connectivity;
  const bool apart = cutter->desc->offsets.count == 0; /* a tuple a cell */
  bool beyond = false;
  for (int64_t k = 0; k < count; ++k) {
    const int64_t node = apart ? tc_array_int64(nodes, cutter->node_stride, i, (int)k)
                               : tc_array_int64(nodes, cutter->node_stride, begin + k, 0);
    beyond |= node < 0 || node >= cutter->vertex_count;
    id[k] = (uint32_t)node;
  }
  return beyond ? BAD_INDEX : FINE;
}

static int compare_ids(const void *left, const void *right) {
  const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
  return (a > b) - (a < b);
}

/* The place of a vertex among the ascending ones of a polyhedron; −1 if it is none of them. */
static int64_t place_of(const uint32_t *id, int64_t count, int64_t vertex) {
  int64_t low = 0, high = count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (id[middle] < vertex)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && id[low] == vertex ? low : -1;
}

/* The faces of polyhedron i, whose nodes are in scratch->node, as a shape between its vertices in scratch->tets.id.
 */
static Fault load_polyhedron(Cutter *cutter, int64_t i, Scratch *scratch, Cell *cell) {
  const TetcastArray *faces = &cutter->desc->faces;
  const int64_t end = faces->count, stride = cutter->face_stride;
  if (i >= cutter->desc->face_offsets.count)
    return BAD_FACES;
  int64_t at = tc_array_int64(&cutter->desc->face_offsets, cutter->place_stride, i, 0);
  if (at < 0 || at >= end)
    return BAD_FACES;
  const int64_t count = tc_array_int64(faces, stride, at++, 0), begin = at;
  if (count < 4 || count > end)
    return BAD_FACES;
  int64_t corners = 0;
  for (int64_t face = 0; face < count; ++face) {
    const int64_t size = at < end ? tc_array_int64(faces, stride, at, 0) : 0;
    if (size < 3 || size >= end - at)
      return BAD_FACES;
    corners += size;
    at += size + 1;
  }
  const int64_t room = corners > cell->nodes ? corners : cell->nodes;
  if (room > scratch->room) { /* the nodes that were read are gone then, and are read again */
    int64_t first, nodes;
    find_nodes(cutter, i, &first, &nodes);
    if (!reserve(cutter, scratch, room))
      return NO_MEMORY;
    read_nodes(cutter, i, first, nodes, scratch->node);
  }
  uint32_t *id = scratch->tets.id, unique = 0;
  qsort(scratch->node, (size_t)cell->nodes, sizeof *scratch->node, compare_ids);
  for (int64_t k = 0; k < cell->nodes; ++k) {
    if (k == 0 || scratch->node[k] != id[unique - 1])
      id[unique++] = scratch->node[k];
  }
  at = begin;
  for (int64_t face = 0, corner = 0; face < count; ++face) {
    const int64_t size = tc_array_int64(faces, stride, at++, 0);
    scratch->size[face] = (uint32_t)size;
    for (int64_t k = 0; k < size; ++k) {
      const int64_t place = place_of(id, unique, tc_array_int64(faces, stride, at++, 0));
      if (place < 0)
        return BAD_FACES;
      scratch->corner[corner++] = (uint32_t)place;
    }
  }
  cell->shape = (TcShape){.corners = unique,
                          .faces = (uint32_t)count,
                          .size = scratch->size,
                          .corner = scratch->corner,
                          .either_way = true,
                          .turned = scratch->turned};
  cell->open = !tc_orient_faces(&cell->shape, scratch->edge, scratch->link);
  return FINE;
}

static Fault load_curved(Cutter *cutter, int64_t i, int64_t begin, Scratch *scratch, Cell *cell) {
  const TetcastCellsDesc *desc = cutter->desc;
  double order[3];
  const int64_t stride = tc_array_stride(&desc->orders, 3);
  for (int k = 0; k < 3 && i < desc->orders.count; ++k)
    order[k] = tc_array_double(&desc->orders, stride, i, k);
  /* Zeros count as not given: files have them for cells of a fixed order. */
  const bool given = i < desc->orders.count && order[0] >= 1;
  if (!tc_lattice_make(cell->type, cell->nodes, given ? order : NULL, desc->subdivision, &cell->lattice))
    return BAD_NODES;
  const int64_t size = tc_lattice_size(&cell->lattice);
  if (!reserve(cutter, scratch, size > cell->lattice.nodes ? size : cell->lattice.nodes))
    return NO_MEMORY;
  const Fault fault = read_nodes(cutter, i, begin, cell->lattice.nodes, scratch->node);
  cell->collapsed = tc_has_twice(scratch->node, tc_shape(cell->lattice.shape)->corners);
  return fault;
}

/* The node of a curved cell at a point of its lattice; −1 if there is none. */
static int node_at(const Cell *cell, const int at[3], const uint32_t *ids) {
  const int node = cell->collapsed ? tc_lattice_shared_node(&cell->lattice, at, ids, cell->index) : -1;
  return node >= 0 ? node : tc_lattice_node(&cell->lattice, at);
}

/* A voxel's nodes have x fastest, where a hexahedron's go round. */
static void swap_voxel(uint32_t *id) {
  for (int j = 2; j < 8; j += 4) {
    const uint32_t swap = id[j];
    id[j] = id[j + 1];
    id[j + 1] = swap;
  }
}

/* Reads cell i: nodes of straight ones and polyhedra to scratch->tets.id, of curved ones to scratch->node. */
static Fault load(Cutter *cutter, int64_t i, Scratch *scratch, Cell *cell) {
  const TetcastCellsDesc *desc = cutter->desc;
  const unsigned type = type_of(cutter, i);
  int k = 0;
  while (k < STRAIGHT && straight[k].type != type)
    ++k;
  *cell = (Cell){.index = i, .type = type, .curved = k == STRAIGHT && tc_is_curved(type)};
  if (k == STRAIGHT && !cell->curved && type != TETCAST_CELL_POLYHEDRON)
    return NOTHING;
  if (desc->hidden && (desc->hidden[i] & desc->hidden_bits))
    return NOTHING;
  const int64_t needed = tc_cell_nodes(type);
  int64_t begin = 0;
  cell->nodes = needed;
  if (desc->offsets.count && !find_nodes(cutter, i, &begin, &cell->nodes))
    return BAD_OFFSETS;
  if (cell->nodes < needed)
    return BAD_NODES;
  cell->oversized = needed && cell->nodes > needed;
  if (cell->curved)
    return load_curved(cutter, i, begin, scratch, cell);
  if (k == STRAIGHT) {
    if (!reserve(cutter, scratch, cell->nodes))
      return NO_MEMORY;
    const Fault fault = read_nodes(cutter, i, begin, cell->nodes, scratch->node);
    return fault ? fault : load_polyhedron(cutter, i, scratch, cell);
  }
  cell->shape = *tc_shape(straight[k].shape);
  uint32_t *id = scratch->tets.id;
  const Fault fault = read_nodes(cutter, i, begin, needed, id);
  if (type == TETCAST_CELL_VOXEL)
    swap_voxel(id);
  return fault;
}

static TetcastStatus report(Cutter *cutter, int64_t i) {
  Cell cell;
  const Fault fault = load(cutter, i, &cutter->scratch[0], &cell);
  switch (fault) {
  case BAD_OFFSETS:
    return tc_error(cutter->context, TETCAST_ERROR_DATA,
                    "cell %" PRId64 ": its offsets are descending or beyond the end of the list of nodes", i);
  case BAD_NODES:
    return tc_error(cutter->context, TETCAST_ERROR_DATA,
                    "cell %" PRId64 ": %" PRId64 " nodes don't make a cell of type %u", i, cell.nodes, cell.type);
  case BAD_INDEX:
    return tc_error(cutter->context, TETCAST_ERROR_DATA,
                    "cell %" PRId64 " names a vertex out of range: there are %" PRId64 ", counted from 0", i,
                    cutter->vertex_count);
  case BAD_FACES:
    return tc_error(cutter->context, TETCAST_ERROR_DATA,
                    "cell %" PRId64 ": the list of the polyhedron's faces is damaged", i);
  default:
    return TETCAST_ERROR_MEMORY; /* has been reported */
  }
}

/* ── vertices on the lattices of curved cells ── */

static void position(const Cutter *cutter, uint32_t id, double p[3]) {
  if (id < cutter->vertex_count)
    tc_mesh_vertex(&cutter->mesh, id, p);
  else
    memcpy(p, cutter->cut->points.p[id - cutter->vertex_count], 3 * sizeof *p);
}

/* Appends the point to those added. */
static bool add_point(Cutter *cutter, const Cell *cell, const int at[3], const TcPointKey *key, Scratch *scratch) {
  const TetcastCellsDesc *desc = cutter->desc;
  const TcLattice *lattice = &cell->lattice;
  TcCutPoints *points = &cutter->cut->points;
  if (points->count == points->point_room || points->entries + lattice->nodes > points->entry_room) {
    const int64_t count = points->count + 1, entries = points->entries + lattice->nodes;
    if (!tc_cut_points_reserve(points, 2 * count, 2 * entries))
      return false;
  }
  tc_lattice_weights(lattice, at, scratch->weight);
  double sum = 0, p[3] = {0, 0, 0}, first[3];
  tc_mesh_vertex(&cutter->mesh, scratch->node[0], first);
  int64_t entries = 0;
  uint32_t *source = points->source + points->entries;
  double *weight = points->weight + points->entries;
  for (int k = 0; k < lattice->nodes; ++k) {
    const uint32_t node = scratch->node[k];
    double w = scratch->weight[k];
    if (w == 0)
      continue;
    if (lattice->bezier && desc->rational.count)
      w *= tc_array_double(&desc->rational, tc_array_stride(&desc->rational, 1), node, 0);
    source[entries] = node;
    weight[entries++] = w;
    sum += w;
  }
  for (int64_t k = 0; k < entries; ++k) {
    double q[3];
    tc_mesh_vertex(&cutter->mesh, source[k], q);
    weight[k] /= sum; /* is 1 but for rational cells and rounding */
    for (int c = 0; c < 3; ++c)
      p[c] += weight[k] * (q[c] - first[c]);
  }
  for (int c = 0; c < 3; ++c)
    p[c] += first[c];
  return tc_cut_points_add(points, key, p, entries);
}

/* Cells are looked at one after the other, as the first cell that has a point gives it its number. */
static TetcastStatus add_lattices(Cutter *cutter) {
  Scratch *scratch = &cutter->scratch[0];
  TcCutPoints *points = &cutter->cut->points;
  bool curved[256];
  for (unsigned type = 0; type < 256; ++type)
    curved[type] = tc_is_curved(type);
  for (int64_t i = 0; i < cutter->cell_count; ++i) {
    if (!curved[type_of(cutter, i) & 255])
      continue;
    Cell cell;
    const Fault fault = load(cutter, i, scratch, &cell);
    if (fault == NOTHING)
      continue;
    if (fault)
      return report(cutter, i);
    int at[3] = {-1, 0, 0};
    while (tc_lattice_next(&cell.lattice, at)) {
      if (node_at(&cell, at, scratch->node) >= 0)
        continue;
      const TcPointKey key = tc_lattice_key(&cell.lattice, at, scratch->node, i);
      if (tc_cut_points_find(points, &key) >= 0)
        continue;
      if (cutter->vertex_count + points->count >= TC_MAX_COUNT) {
        return tc_error(cutter->context, TETCAST_ERROR_LIMIT, "subdividing curved cells makes more than %d vertices",
                        (int)TC_MAX_COUNT);
      }
      if (!add_point(cutter, &cell, at, &key, scratch))
        return TETCAST_ERROR_MEMORY;
    }
  }
  return TETCAST_OK;
}

/* ── a cell's tetrahedra ── */

/* The entries of a vertex among those added: itself, or what it is made of. */
static int64_t entries_of(const Cutter *cutter, uint32_t id) {
  if (id < cutter->vertex_count)
    return 1;
  const int64_t *start = cutter->cut->points.start + (id - cutter->vertex_count);
  return start[1] - start[0];
}

static void write_centre(Cutter *cutter, const TcShape *shape, const TcTets *tets, int64_t index, int64_t entry) {
  TcCutPoints *points = &cutter->cut->points;
  if (index > points->count)
    points->start[index] = entry; /* the first has it already, and may be looked at by others */
  for (uint32_t k = 0; k < shape->corners; ++k) {
    const uint32_t id = tets->id[k];
    if (id < cutter->vertex_count) {
      points->source[entry] = id;
      points->weight[entry++] = 1.0 / shape->corners;
      continue;
    }
    const int64_t *start = points->start + (id - cutter->vertex_count);
    for (int64_t from = start[0]; from < start[1]; ++from, ++entry) {
      points->source[entry] = points->source[from];
      points->weight[entry] = points->weight[from] / shape->corners;
    }
  }
}

/* The unit in which to look at a cell with these nodes: 1, or if volumes could overflow or underflow, a cell's largest
 * coordinate. */
static int unit_of(const Cutter *cutter, const uint32_t *id, int64_t count) {
  double largest = 0;
  for (int64_t k = 0; k < count; ++k) {
    double p[3];
    tc_mesh_vertex(&cutter->mesh, id[k], p);
    largest = fmax(largest, fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2]))));
  }
  int exponent = 0;
  if ((largest > 0 && largest < 0x1p-200) || (largest > 0x1p300 && isfinite(largest)))
    frexp(largest, &exponent);
  return exponent;
}

/* Counts or writes what tets->id is cut into. */
static void emit(Cutter *cutter, const TcShape *shape, TcTets *tets, int64_t cell, Block *block) {
  for (uint32_t k = 0; k < shape->corners; ++k) {
    position(cutter, tets->id[k], tets->p[k]);
    for (int c = 0; tets->exponent && c < 3; ++c)
      tets->p[k][c] = ldexp(tets->p[k][c], -tets->exponent);
  }
  tc_cut_shape(shape, tets);
  int64_t entries = 0;
  for (uint32_t k = 0; tets->centred && k < shape->corners; ++k)
    entries += entries_of(cutter, tets->id[k]);
  if (cutter->writes) {
    TetcastCut *cut = cutter->cut;
    if (tets->centred)
      write_centre(cutter, shape, tets, block->centres, block->entries);
    const uint32_t centre = (uint32_t)(cutter->vertex_count + block->centres);
    for (int64_t t = 0; t < tets->count; ++t) {
      int32_t *to = cut->tetrahedra[block->tetrahedra + t];
      for (int k = 0; k < 4; ++k) {
        const uint32_t corner = tets->tet[t][k];
        to[k] = (int32_t)(corner < shape->corners ? tets->id[corner] : centre);
      }
      if (cut->sources)
        cut->sources[block->tetrahedra + t] = (int32_t)cell;
    }
  }
  block->tetrahedra += tets->count;
  block->centres += tets->centred;
  block->entries += entries;
}

/* A curved cell on its way through its straight parts. */
typedef struct Curved {
  Cutter *cutter;
  Scratch *scratch;
  Block *block;
  int64_t cell;
  double positive, negative;
} Curved;

static void cut_part(void *user, TcShapeName name, const uint32_t *points) {
  Curved *curved = user;
  const TcShape *shape = tc_shape(name);
  TcTets *tets = &curved->scratch->tets;
  for (uint32_t k = 0; k < shape->corners; ++k)
    tets->id[k] = curved->scratch->point[points[k]];
  emit(curved->cutter, shape, tets, curved->cell, curved->block);
  curved->positive += tets->positive;
  curved->negative += tets->negative;
}

static void cut_curved(Cutter *cutter, const Cell *cell, Scratch *scratch, Block *block) {
  const TcLattice *lattice = &cell->lattice;
  int at[3] = {-1, 0, 0};
  while (tc_lattice_next(lattice, at)) {
    const int node = node_at(cell, at, scratch->node);
    uint32_t *point = &scratch->point[tc_lattice_index(lattice, at)];
    if (node >= 0) {
      *point = scratch->node[node];
    } else {
      const TcPointKey key = tc_lattice_key(lattice, at, scratch->node, cell->index);
      *point = (uint32_t)(cutter->vertex_count + tc_cut_points_find(&cutter->cut->points, &key));
    }
  }
  Curved curved = {cutter, scratch, block, cell->index, 0, 0};
  tc_lattice_parts(lattice, cut_part, &curved);
  scratch->tets.positive = curved.positive;
  scratch->tets.negative = curved.negative;
  TetcastCutInfo *info = &block->info;
  ++info->curved;
  for (int k = 0; k < 3; ++k) {
    const int segments = lattice->segments[k];
    info->segments[0] = info->segments[0] == 0 || segments < info->segments[0] ? segments : info->segments[0];
    info->segments[1] = segments > info->segments[1] ? segments : info->segments[1];
  }
}

static void cut_cell(Cutter *cutter, const Cell *cell, Scratch *scratch, Block *block) {
  const Block before = *block;
  TcTets *tets = &scratch->tets;
  tets->exponent = cell->curved ? unit_of(cutter, scratch->node, cell->lattice.nodes)
                                : unit_of(cutter, tets->id, cell->shape.corners);
  if (cell->curved)
    cut_curved(cutter, cell, scratch, block);
  else
    emit(cutter, &cell->shape, tets, cell->index, block);
  if (cutter->writes)
    return;
  const TcShape *shape = cell->curved ? tc_shape(cell->lattice.shape) : &cell->shape;
  TetcastCutInfo *info = &block->info;
  ++info->cells;
  info->centred += block->centres - before.centres;
  info->empty += block->tetrahedra == before.tetrahedra;
  info->collapsed += !shape->turned && tc_has_twice(cell->curved ? scratch->node : tets->id, shape->corners);
  info->inverted += !shape->either_way && tets->negative > tets->positive;
  info->folded += tc_is_folded(tets->positive, tets->negative);
  info->open += cell->open;
  info->oversized += cell->oversized;
}

/* ── hexahedra by table: most meshes of them have no faults, so that this is all it takes ── */

/* Reads the nodes of hexahedron i. False if it has a fault that has to be told. */
static inline bool read_hexahedron(const Cutter *cutter, int64_t i, uint32_t id[8]) {
  const TetcastCellsDesc *desc = cutter->desc;
  const TetcastArray *nodes = &desc->connectivity;
  int64_t begin = 0, count = 8, stride = cutter->node_stride;
  if (desc->hidden && (desc->hidden[i] & desc->hidden_bits))
    return false;
  if (desc->offsets.count) {
    if (!find_nodes(cutter, i, &begin, &count) || count != 8)
      return false;
  } else {
    begin = i;
  }
  const char *at = (const char *)nodes->data + begin * stride;
  if (!desc->offsets.count)
    stride = (int64_t)tc_type_size(nodes->type);
  uint64_t largest = 0;
  if (nodes->type == TETCAST_TYPE_INT64) {
    for (int k = 0; k < 8; ++k) {
      int64_t node;
      memcpy(&node, at + k * stride, sizeof node);
      id[k] = (uint32_t)node;
      largest = (uint64_t)node > largest ? (uint64_t)node : largest;
    }
  } else if (nodes->type == TETCAST_TYPE_INT32) {
    for (int k = 0; k < 8; ++k) {
      memcpy(&id[k], at + k * stride, sizeof id[k]);
      largest = id[k] > largest ? id[k] : largest;
    }
  } else {
    return false;
  }
  if (type_of(cutter, i) == TETCAST_CELL_VOXEL)
    swap_voxel(id);
  return largest < (uint64_t)cutter->vertex_count;
}

/* Counts the tetrahedra of those of the cells [begin, end) that the table cuts. Their vertices are all prefetched
 * first, so that memory is waited for once. */
static void count_hexahedra(Cutter *cutter, int64_t begin, int64_t end, Block *block) {
  uint32_t id[BATCH][8];
  int way[BATCH];
  int64_t at[BATCH];
  int n = 0;
  for (int64_t i = begin; i < end; ++i) {
    const unsigned type = type_of(cutter, i);
    if ((type != TETCAST_CELL_HEXAHEDRON && type != TETCAST_CELL_VOXEL) || !read_hexahedron(cutter, i, id[n]))
      continue;
    for (int k = 0; k < 8; ++k)
      __builtin_prefetch((const char *)cutter->mesh.vertices.data + id[n][k] * cutter->mesh.vertices.stride);
    way[n] = tc_hexahedra_find(&cutter->hexahedra, id[n]);
    at[n] = i;
    ++n;
  }
  for (int m = 0; m < n; ++m) {
    double p[8][3];
    for (int k = 0; k < 8; ++k)
      tc_mesh_vertex(&cutter->mesh, id[m][k], p[k]);
    const bool fits = tc_hexahedra_fits(&cutter->hexahedra, way[m], (const double(*)[3])p);
    cutter->ways[at[m]] = (uint8_t)(fits ? 1 + way[m] : 0);
    block->tetrahedra += fits ? cutter->hexahedra.count[way[m]] : 0;
    block->info.cells += fits;
  }
}

static void write_hexahedron(const Cutter *cutter, int64_t i, Block *block) {
  uint32_t id[8];
  read_hexahedron(cutter, i, id);
  const int way = cutter->ways[i] - 1, count = cutter->hexahedra.count[way];
  TetcastCut *cut = cutter->cut;
  for (int t = 0; t < count; ++t) {
    int32_t *to = cut->tetrahedra[block->tetrahedra + t];
    const uint8_t *corner = cutter->hexahedra.tet[way][t];
    for (int k = 0; k < 4; ++k)
      to[k] = (int32_t)id[corner[k]];
  }
  for (int t = 0; cut->sources && t < count; ++t)
    cut->sources[block->tetrahedra + t] = (int32_t)i;
  block->tetrahedra += count;
}

static bool cut_block(void *data, int64_t begin, int64_t end, int worker) {
  Cutter *cutter = data;
  Scratch *scratch = &cutter->scratch[worker];
  Block block = cutter->blocks[begin / GRAIN];
  for (int64_t i = begin; i < end; ++i) {
    if (!cutter->writes && (i - begin) % BATCH == 0)
      count_hexahedra(cutter, i, i + BATCH < end ? i + BATCH : end, &block);
    if (cutter->ways[i]) {
      if (cutter->writes)
        write_hexahedron(cutter, i, &block);
      continue;
    }
    Cell cell;
    const Fault fault = load(cutter, i, scratch, &cell);
    if (fault == NOTHING)
      continue;
    if (fault) {
      long long first = atomic_load(&cutter->first_bad);
      while (i < first && !atomic_compare_exchange_weak(&cutter->first_bad, &first, i))
        continue;
      return fault != NO_MEMORY;
    }
    cut_cell(cutter, &cell, scratch, &block);
  }
  cutter->blocks[begin / GRAIN] = block;
  return true;
}

/* ── all of it ── */

static void add_info(TetcastCutInfo *sum, const TetcastCutInfo *part) {
  sum->cells += part->cells;
  sum->curved += part->curved;
  sum->centred += part->centred;
  sum->collapsed += part->collapsed;
  sum->inverted += part->inverted;
  sum->folded += part->folded;
  sum->open += part->open;
  sum->empty += part->empty;
  sum->oversized += part->oversized;
  if (part->segments[0] && (!sum->segments[0] || part->segments[0] < sum->segments[0]))
    sum->segments[0] = part->segments[0];
  if (part->segments[1] > sum->segments[1])
    sum->segments[1] = part->segments[1];
}

/* Computes from the blocks' counts where each begins, and allocates the memory. */
static TetcastStatus lay_out(Cutter *cutter) {
  TetcastCut *cut = cutter->cut;
  TcCutPoints *points = &cut->points;
  Block next = {.centres = points->count, .entries = points->entries};
  for (int64_t b = 0; b * GRAIN < cutter->cell_count; ++b) {
    const Block block = cutter->blocks[b];
    cutter->blocks[b] = next;
    next.tetrahedra += block.tetrahedra;
    next.centres += block.centres;
    next.entries += block.entries;
    add_info(&cut->info, &block.info);
  }
  cut->info.tetrahedra = next.tetrahedra;
  cut->info.added_vertices = next.centres;
  if (next.tetrahedra > TC_MAX_COUNT || cutter->vertex_count + next.centres > TC_MAX_COUNT) {
    return tc_error(cutter->context, TETCAST_ERROR_LIMIT,
                    "cutting the cells makes %" PRId64 " tetrahedra of %" PRId64
                    " vertices: at most %d of each can be held",
                    next.tetrahedra, cutter->vertex_count + next.centres, (int)TC_MAX_COUNT);
  }
  if (!tc_cut_points_reserve(points, next.centres, next.entries))
    return TETCAST_ERROR_MEMORY;
  points->start[next.centres] = next.entries;
  if (!tc_allocate_array(cutter->context, (void **)&cut->tetrahedra, next.tetrahedra, sizeof *cut->tetrahedra,
                         "tetrahedra") ||
      (cutter->desc->sources && !tc_allocate_array(cutter->context, (void **)&cut->sources, next.tetrahedra,
                                                   sizeof *cut->sources, "tetrahedra's cells"))) {
    return TETCAST_ERROR_MEMORY;
  }
  return TETCAST_OK;
}

static TetcastStatus pass(Cutter *cutter) {
  atomic_init(&cutter->first_bad, INT64_MAX);
  const TetcastStatus status = tc_parallel_for(cutter->context, cutter->cell_count, GRAIN, cut_block, cutter, NULL);
  if (status)
    return TETCAST_ERROR_MEMORY;
  return cutter->first_bad < INT64_MAX ? report(cutter, cutter->first_bad) : TETCAST_OK;
}

static TetcastStatus run(Cutter *cutter, int threads) {
  TetcastContext *context = cutter->context;
  const int64_t blocks = (cutter->cell_count + GRAIN - 1) / GRAIN;
  if (!tc_allocate_array(context, (void **)&cutter->scratch, threads, sizeof *cutter->scratch, "cells"))
    return TETCAST_ERROR_MEMORY;
  memset(cutter->scratch, 0, (size_t)threads * sizeof *cutter->scratch);
  for (int i = 0; i < threads; ++i) {
    if (!reserve(cutter, &cutter->scratch[i], 64))
      return TETCAST_ERROR_MEMORY;
  }
  if (!tc_allocate_array(context, (void **)&cutter->blocks, blocks, sizeof *cutter->blocks, "cells"))
    return TETCAST_ERROR_MEMORY;
  memset(cutter->blocks, 0, (size_t)blocks * sizeof *cutter->blocks);
  if (!tc_allocate_array(context, (void **)&cutter->ways, cutter->cell_count, 1, "cells"))
    return TETCAST_ERROR_MEMORY;
  memset(cutter->ways, 0, (size_t)cutter->cell_count);
  tc_hexahedra_make(&cutter->hexahedra);
  TetcastStatus status = add_lattices(cutter);
  if (!status)
    status = pass(cutter);
  if (!status)
    status = lay_out(cutter);
  cutter->writes = true;
  if (!status)
    status = pass(cutter);
  if (status)
    return status; /* the lists may lack room for what was counted */
  TcCutPoints *points = &cutter->cut->points;
  points->count = cutter->cut->info.added_vertices;
  points->entries = points->start ? points->start[points->count] : 0;
  tc_cut_points_forget_keys(points);
  return TETCAST_OK;
}

TetcastStatus tc_cells_cut(TetcastContext *context, const TetcastCellsDesc *desc, TetcastCut **out) {
  Cutter cutter = {.context = context, .desc = desc, .vertex_count = desc->vertices.count};
  cutter.cell_count = desc->offsets.count ? desc->offsets.count - 1 : desc->connectivity.count;
  if (cutter.vertex_count > TC_MAX_COUNT || cutter.cell_count > TC_MAX_COUNT) {
    return tc_error(context, TETCAST_ERROR_LIMIT,
                    "%" PRId64 " cells of %" PRId64 " vertices: at most %d of each can be held", cutter.cell_count,
                    cutter.vertex_count, (int)TC_MAX_COUNT);
  }
  TetcastArray vertices = desc->vertices;
  vertices.stride = tc_array_stride(&vertices, 3);
  tc_mesh_set_vertices(&cutter.mesh, &vertices);
  cutter.offset_stride = tc_array_stride(&desc->offsets, 1);
  cutter.node_stride =
      tc_array_stride(&desc->connectivity, desc->offsets.count ? 1 : (int)tc_cell_nodes((unsigned)desc->type));
  cutter.face_stride = tc_array_stride(&desc->faces, 1);
  cutter.place_stride = tc_array_stride(&desc->face_offsets, 1);
  TetcastCut *cut;
  if (!tc_allocate_array(context, (void **)&cut, 1, sizeof *cut, "cut"))
    return TETCAST_ERROR_MEMORY;
  *cut = (TetcastCut){.context = context, .vertex_count = cutter.vertex_count, .points = {.context = context}};
  cutter.cut = cut;
  const int threads = tc_context_threads(context);
  const TetcastStatus status = run(&cutter, threads);
  for (int i = 0; cutter.scratch && i < threads; ++i)
    tc_release(context, cutter.scratch[i].memory);
  tc_release(context, cutter.scratch);
  tc_release(context, cutter.blocks);
  tc_release(context, cutter.ways);
  if (status) {
    tc_cut_destroy(cut);
    return status;
  }
  *out = cut;
  return TETCAST_OK;
}
