/* SPDX-License-Identifier: Apache-2.0 */
/* Finds which cells meet at which faces. Cells are sorted by their smallest vertex, and an index of them by their
 * second vertex. All faces with a given smallest vertex are then found in two places, and are matched, one smallest
 * vertex after the other, in a hash table that fits the innermost cache. If vertices are numbered along a curve through
 * space, the order of the cells follows the curve as well.
 *
 * Bytes per cell: 20 for the result, in whose place the vertices of the mesh's cells are until they are sorted; 8 for
 * records, which are sorted by way of memory that is needed only before or afterwards; 16 for the sorted cells'
 * vertices and 4 for their sources. That is 48 in all, of which 24 stay. The caller's arrays come on top: 4 per vertex
 * for the ranks, 20 or 36 per vertex for the volume, which is about 6 or 7 per cell. Only if nearly all cells meet at
 * one vertex, more is needed, up to 144. */
#include "mesh/adjacency.h"

#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/order.h"
#include "mesh/stage.h"

enum { GRAIN = 1 << 14, VERTEX_GRAIN = 1 << 11, AHEAD = 32, SMALL_BITS = 10 };

/* While faces are linked: a face that has been seen in one cell so far, and one of three cells or more. */
#define FACE_OF_ONE  TC_SHELL
#define FACE_OF_MANY (TC_SHELL | 1)

typedef struct Build {
  TetcastContext *context;
  const TetcastMesh *mesh;
  const uint32_t *rank;
  TcAdjacency *result;
  int64_t mesh_cell_count, cell_count, vertex_count;
  uint32_t (
      *unsorted)[4]; /* [mesh_cell_count]: the vertices of each of the mesh's cells, ascending; where `cells` will be */
  uint64_t *records; /* [mesh_cell_count]: keys are vertices, values are cells */
  uint32_t (
      *vertices)[4]; /* [cell_count], room for mesh_cell_count: of each cell, ascending; cells in ascending order */
  uint32_t *source;
  TcCell *cells;
  int64_t *shell_begin; /* [pieces of GRAIN cells]: the first shell face */
  atomic_llong hidden, collapsed, duplicates, boundary, nonmanifold;
  atomic_bool out_of_memory;
} Build;

/* ── cells in order ── */

/* Renumbers cells and makes records of them by their smallest vertex. Hidden ones, and those with a vertex twice,
 * go to the end. */
static bool read_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  int64_t collapsed = 0, hidden = 0;
  for (int64_t i = begin; i < end; ++i) {
    uint32_t *v = build->unsorted[i];
    tc_mesh_cell(build->mesh, i, v);
    if (build->rank) {
      for (int k = 0; k < 4; ++k)
        v[k] = build->rank[v[k]];
    }
    tc_sort4(v);
    const bool hides = tc_mesh_hides(build->mesh, i), flat = (v[0] == v[1]) | (v[1] == v[2]) | (v[2] == v[3]);
    hidden += hides;
    collapsed += flat & !hides;
    build->records[i] = tc_record((flat | hides) ? (uint32_t)build->vertex_count : v[0], (uint32_t)i);
  }
  atomic_fetch_add(&build->hidden, hidden);
  atomic_fetch_add(&build->collapsed, collapsed);
  return true;
}

/* A cell whose smallest vertex is known: the others and where it comes from, in the order of their weight. */
typedef struct Entry {
  uint64_t high, low;
} Entry;

static bool is_less(const Entry *a, const Entry *b) {
  return a->high != b->high ? a->high < b->high : a->low < b->low;
}

static int compare_entries(const void *a, const void *b) {
  return is_less(b, a) - is_less(a, b);
}

static void sort_entries(Entry *entries, int64_t count) {
  if (count > 48) {
    qsort(entries, (size_t)count, sizeof *entries, compare_entries);
    return;
  }
  for (int64_t i = 1; i < count; ++i) {
    const Entry entry = entries[i];
    int64_t j = i;
    for (; j > 0 && is_less(&entry, &entries[j - 1]); --j)
      entries[j] = entries[j - 1];
    entries[j] = entry;
  }
}

/* Takes the cells of records [begin, end), which have the same smallest vertex, and sorts them by the others. */
static bool take_run(Build *build, int64_t begin, int64_t end) {
  enum { SMALL = 128 };
  Entry small[SMALL], *entries = small;
  const int64_t count = end - begin;
  if (count > SMALL) {
    entries = tc_allocate(build->context, count, sizeof *entries);
    if (!entries)
      return false;
  }
  for (int64_t i = 0; i < count; ++i) {
    const uint32_t source = tc_record_value(build->records[begin + i]), *v = build->unsorted[source];
    entries[i] = (Entry){(uint64_t)v[1] << 32 | v[2], (uint64_t)v[3] << 32 | source};
  }
  sort_entries(entries, count);
  int64_t duplicates = 0;
  for (int64_t i = 0; i < count; ++i) {
    const Entry *entry = &entries[i];
    const uint32_t v[4] = {tc_record_key(build->records[begin]), (uint32_t)(entry->high >> 32), (uint32_t)entry->high,
                           (uint32_t)(entry->low >> 32)};
    memcpy(build->vertices[begin + i], v, sizeof v);
    build->source[begin + i] = (uint32_t)entry->low;
    duplicates += i > 0 && entry->high == entry[-1].high && entry->low >> 32 == entry[-1].low >> 32;
  }
  if (duplicates)
    atomic_fetch_add(&build->duplicates, duplicates);
  if (entries != small)
    tc_release(build->context, entries);
  return true;
}

/* Runs that begin in [begin, end). */
static bool take_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  const uint64_t *records = build->records;
  int64_t i = begin;
  while (i > 0 && i < end && tc_record_key(records[i]) == tc_record_key(records[i - 1]))
    ++i;
  while (i < end) {
    int64_t j = i + 1;
    while (j < build->cell_count && tc_record_key(records[j]) == tc_record_key(records[i]))
      ++j;
    for (int64_t k = i; k < j && k + AHEAD < build->cell_count; ++k) {
      __builtin_prefetch(build->unsorted[tc_record_value(records[k + AHEAD])]);
    }
    if (!take_run(build, i, j)) {
      atomic_store(&build->out_of_memory, true);
      return false;
    }
    i = j;
  }
  return true;
}

/* Leaves out cells with the same vertices as another one. The first of them in the mesh stays. */
static void drop_duplicates(Build *build) {
  int64_t count = 0;
  for (int64_t i = 0; i < build->cell_count; ++i) {
    if (count > 0 && memcmp(build->vertices[count - 1], build->vertices[i], sizeof *build->vertices) == 0)
      continue;
    memmove(build->vertices[count], build->vertices[i], sizeof *build->vertices);
    build->source[count++] = build->source[i];
  }
  build->cell_count = count;
}

/* ── faces ── */

/* Makes records of cells by their second vertex. */
static bool take_seconds(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  for (int64_t i = begin; i < end; ++i)
    build->records[i] = tc_record(build->vertices[i][1], (uint32_t)i);
  return true;
}

/* Marks all faces as not joined to another yet. */
static bool begin_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  for (int64_t i = begin; i < end; ++i) {
    const uint32_t *v = build->vertices[i];
    build->cells[i] = (TcCell){v[0] ^ v[1] ^ v[2] ^ v[3], {FACE_OF_ONE, FACE_OF_ONE, FACE_OF_ONE, FACE_OF_ONE}};
  }
  return true;
}

/* A face's number is 4 · cell + k: it is opposite the cell's k-th smallest vertex. */
static uint32_t *neighbor_of(Build *build, uint64_t number) {
  return &build->cells[number >> 2].neighbor[number & 3];
}

static uint32_t face_smallest(const Build *build, uint64_t number) {
  return build->vertices[number >> 2][(number & 3) == 0];
}

/* The two larger vertices of a face. */
static uint64_t face_key(const Build *build, uint64_t number) {
  const uint32_t *v = build->vertices[number >> 2];
  const unsigned k = number & 3;
  return (uint64_t)v[k < 2 ? 2 : 1] << 32 | v[k < 3 ? 3 : 2];
}

/* Joins a face with `first`, an earlier face with the same vertices. */
static void join(Build *build, uint64_t first, uint64_t number) {
  uint32_t *neighbor = neighbor_of(build, first);
  if (*neighbor == FACE_OF_ONE) {
    *neighbor = (uint32_t)(number >> 2);
    *neighbor_of(build, number) = (uint32_t)(first >> 2);
    return;
  }
  if (*neighbor != FACE_OF_MANY) { /* so far of two cells; they share no other face */
    uint64_t second = (uint64_t)*neighbor * 4;
    while (face_smallest(build, second) != face_smallest(build, first) ||
           face_key(build, second) != face_key(build, first))
      ++second;
    *neighbor_of(build, second) = *neighbor = FACE_OF_MANY;
    atomic_fetch_add(&build->nonmanifold, 1);
  }
  *neighbor_of(build, number) = FACE_OF_MANY;
}

/* Faces with one smallest vertex, by a hash of their keys. */
typedef struct Table {
  struct {
    uint64_t key, number;
  } * entries;
  uint64_t *slots; /* [2^bits]: stamp << 32 | entry */
  uint32_t stamp;  /* slots with another stamp are empty, so that they need not be cleared for each vertex */
  uint32_t count;
  int bits;
} Table;

static inline void put_face(Build *build, Table *table, uint32_t b, uint32_t c, uint64_t number) {
  const uint64_t key = (uint64_t)b << 32 | c, mask = (UINT64_C(1) << table->bits) - 1;
  uint64_t slot = key * UINT64_C(0x9e3779b97f4a7c15) >> (64 - table->bits);
  for (; table->slots[slot] >> 32 == table->stamp; slot = (slot + 1) & mask) {
    const uint32_t i = (uint32_t)table->slots[slot];
    if (table->entries[i].key != key)
      continue;
    join(build, table->entries[i].number, number);
    return;
  }
  table->slots[slot] = (uint64_t)table->stamp << 32 | table->count;
  table->entries[table->count].key = key;
  table->entries[table->count++].number = number;
}

/* One vertex's faces: those of cells [begin, end) but the first of each, and the first of the cells in records [second,
 * second_end). */
static void put_faces(Build *build, Table *shared, int64_t begin, int64_t end, int64_t second, int64_t second_end) {
  Table table = *shared; /* which may stay in registers */
  ++table.stamp;
  for (int64_t i = begin; i < end; ++i) {
    const uint32_t *v = build->vertices[i];
    put_face(build, &table, v[2], v[3], (uint64_t)i * 4 + 1);
    put_face(build, &table, v[1], v[3], (uint64_t)i * 4 + 2);
    put_face(build, &table, v[1], v[2], (uint64_t)i * 4 + 3);
  }
  for (int64_t j = second; j < second_end; ++j) {
    const uint32_t i = tc_record_value(build->records[j]), *v = build->vertices[i];
    put_face(build, &table, v[2], v[3], (uint64_t)i * 4);
  }
  shared->stamp = table.stamp;
}

static bool link_vertex(Build *build, Table *small, int64_t begin, int64_t end, int64_t second, int64_t second_end) {
  const int64_t count = 3 * (end - begin) + (second_end - second);
  int bits = 5;
  while (INT64_C(1) << bits < 2 * count)
    ++bits;
  if (bits <= SMALL_BITS) {
    small->bits = bits;
    put_faces(build, small, begin, end, second, second_end);
    return true;
  }
  Table table = {.slots = tc_allocate(build->context, INT64_C(1) << bits, sizeof *table.slots),
                 .entries = tc_allocate(build->context, count, sizeof *table.entries),
                 .bits = bits};
  const bool ok = table.slots && table.entries;
  if (ok) {
    memset(table.slots, 0, sizeof *table.slots << bits);
    put_faces(build, &table, begin, end, second, second_end);
  }
  tc_release(build->context, table.slots);
  tc_release(build->context, table.entries);
  return ok;
}

/* The first cell whose smallest vertex is ≥ vertex. */
static int64_t find_cell(const Build *build, uint32_t vertex) {
  int64_t low = 0, high = build->cell_count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (build->vertices[middle][0] < vertex)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Matches all faces whose smallest vertex is in [begin, end). */
static bool link_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  int64_t cell = find_cell(build, (uint32_t)begin),
          record = tc_find_record(build->records, build->cell_count, (uint32_t)begin);
  uint64_t slots[1 << SMALL_BITS] = {0}, entries[1 << SMALL_BITS]; /* half as many of two words each */
  Table small = {.slots = slots, .entries = (void *)entries};
  for (uint32_t vertex = (uint32_t)begin; vertex < (uint32_t)end; ++vertex) {
    const int64_t first_cell = cell, first_record = record;
    while (cell < build->cell_count && build->vertices[cell][0] == vertex)
      ++cell;
    while (record < build->cell_count && tc_record_key(build->records[record]) == vertex)
      ++record;
    if (!link_vertex(build, &small, first_cell, cell, first_record, record)) {
      atomic_store(&build->out_of_memory, true);
      return false;
    }
  }
  return true;
}

/* ── shell ── */

static bool is_shell(uint32_t neighbor) {
  return neighbor & TC_SHELL;
}

static bool count_shell(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  int64_t count = 0, boundary = 0;
  for (int64_t i = begin; i < end; ++i) {
    for (int k = 0; k < 4; ++k) {
      count += is_shell(build->cells[i].neighbor[k]);
      boundary += build->cells[i].neighbor[k] == FACE_OF_ONE;
    }
  }
  build->shell_begin[begin / GRAIN] = count;
  atomic_fetch_add(&build->boundary, boundary);
  return true;
}

/* Gives each shell face its number and its record. */
static bool take_shell(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  int64_t next = build->shell_begin[begin / GRAIN];
  for (int64_t i = begin; i < end; ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!is_shell(build->cells[i].neighbor[k]))
        continue;
      TcShellFace *face = &build->result->shell[next];
      for (int j = 0, n = 0; j < 4; ++j) {
        if (j != k)
          face->vertex[n++] = build->vertices[i][j];
      }
      face->cell = (uint32_t)i;
      build->cells[i].neighbor[k] = TC_SHELL | (uint32_t)next++;
    }
  }
  return true;
}

static TetcastStatus make_shell(Build *build) {
  TetcastContext *context = build->context;
  TcAdjacency *result = build->result;
  const int64_t pieces = (build->cell_count + GRAIN - 1) / GRAIN;
  if (!tc_allocate_array(context, (void **)&build->shell_begin, pieces, sizeof *build->shell_begin, "boundary faces")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(context, build->cell_count, GRAIN, count_shell, build, NULL);
  for (int64_t i = 0; i < pieces; ++i) {
    const int64_t count = build->shell_begin[i];
    build->shell_begin[i] = result->shell_count;
    result->shell_count += count;
  }
  if (result->shell_count > TC_MAX_COUNT) {
    return tc_error(context, TETCAST_ERROR_LIMIT, "%lld boundary faces: at most %d can be held",
                    (long long)result->shell_count, (int)TC_MAX_COUNT);
  }
  if (!tc_allocate_array(context, (void **)&result->shell, result->shell_count, sizeof *result->shell,
                         "boundary faces")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(context, build->cell_count, GRAIN, take_shell, build, NULL);
  return TETCAST_OK;
}

/* ── all of it ── */

static TetcastStatus stopped(const Build *build, TetcastStatus status) {
  if (!atomic_load(&build->out_of_memory))
    return status;
  return tc_error(build->context, TETCAST_ERROR_MEMORY, "out of memory: adjacency of %lld cells",
                  (long long)build->mesh_cell_count);
}

/* `scratch` is unused memory of the same size. */
static TetcastStatus sort_records(Build *build, int64_t count, void *scratch) {
  uint64_t *sorted = build->records, *other = scratch;
  const TetcastStatus status = tc_sort_records(build->context, &sorted, &other, count, (uint32_t)build->vertex_count);
  if (sorted != build->records)
    memcpy(build->records, sorted, (size_t)count * sizeof *sorted);
  return status;
}

static TetcastStatus sort_cells(Build *build, const TetcastProgress *progress) {
  TetcastContext *context = build->context;
  const int64_t all = build->mesh_cell_count;
  if (!tc_allocate_array(context, (void **)&build->cells, all + 1, sizeof *build->cells, "cells") ||
      !tc_allocate_array(context, (void **)&build->records, all, sizeof *build->records, "cells") ||
      !tc_allocate_array(context, (void **)&build->vertices, all, sizeof *build->vertices, "cells")) {
    return TETCAST_ERROR_MEMORY;
  }
  build->unsorted = (uint32_t(*)[4])(void *)build->cells;
  TcStage stage;
  TetcastStatus status = tc_parallel_for(context, all, GRAIN, read_cells, build, tc_stage(&stage, progress, 0, 0.2));
  if (!status)
    status = sort_records(build, all, build->vertices);
  if (status)
    return status;
  build->cell_count = all - atomic_load(&build->hidden) - atomic_load(&build->collapsed);
  if (!tc_allocate_array(context, (void **)&build->source, build->cell_count, sizeof *build->source, "cells")) {
    return TETCAST_ERROR_MEMORY;
  }
  status = tc_parallel_for(context, build->cell_count, GRAIN, take_cells, build, tc_stage(&stage, progress, 0.2, 0.5));
  if (status)
    return stopped(build, status);
  if (atomic_load(&build->duplicates) > 0)
    drop_duplicates(build);
  if (build->cell_count == all)
    return TETCAST_OK;
  tc_release(context, build->cells);
  return tc_allocate_array(context, (void **)&build->cells, build->cell_count + 1, sizeof *build->cells, "cells")
             ? TETCAST_OK
             : TETCAST_ERROR_MEMORY;
}

static TetcastStatus link(Build *build, const TetcastProgress *progress) {
  TetcastContext *context = build->context;
  TcStage stage;
  tc_parallel_for(context, build->cell_count, GRAIN, take_seconds, build, NULL);
  TetcastStatus status = sort_records(build, build->cell_count, build->cells);
  if (!status)
    status =
        tc_parallel_for(context, build->cell_count, GRAIN, begin_cells, build, tc_stage(&stage, progress, 0.5, 0.6));
  if (status)
    return status;
  status = tc_parallel_for(context, build->vertex_count, VERTEX_GRAIN, link_cells, build,
                           tc_stage(&stage, progress, 0.6, 0.9));
  if (status)
    return stopped(build, status);
  tc_release(context, build->records);
  build->records = NULL;
  return make_shell(build);
}

TetcastStatus tc_adjacency_build(const TetcastMesh *mesh, const uint32_t *rank, bool keep_vertices,
                                 const TetcastProgress *progress, TcAdjacency *result) {
  memset(result, 0, sizeof *result);
  result->context = mesh->context;
  Build build = {.context = mesh->context,
                 .mesh = mesh,
                 .rank = rank,
                 .result = result,
                 .mesh_cell_count = mesh->tetrahedra.count,
                 .vertex_count = mesh->vertices.count};
  TetcastStatus status = sort_cells(&build, progress);
  if (!status)
    status = link(&build, progress);
  result->cell_count = build.cell_count;
  result->cells = build.cells;
  result->source = build.source;
  result->hidden = atomic_load(&build.hidden);
  result->collapsed = atomic_load(&build.collapsed);
  result->duplicates = atomic_load(&build.duplicates);
  result->boundary = atomic_load(&build.boundary);
  result->nonmanifold = atomic_load(&build.nonmanifold);
  if (keep_vertices)
    result->vertices = build.vertices;
  else
    tc_release(build.context, build.vertices);
  tc_release(build.context, build.records);
  tc_release(build.context, build.shell_begin);
  if (status)
    tc_adjacency_clear(result);
  return status;
}

void tc_adjacency_drop_links(TcAdjacency *adjacency) {
  tc_release(adjacency->context, adjacency->cells);
  tc_release(adjacency->context, adjacency->shell);
  adjacency->cells = NULL;
  adjacency->shell = NULL;
  adjacency->shell_count = 0;
}

void tc_adjacency_clear(TcAdjacency *adjacency) {
  tc_release(adjacency->context, adjacency->vertices);
  tc_release(adjacency->context, adjacency->cells);
  tc_release(adjacency->context, adjacency->shell);
  tc_release(adjacency->context, adjacency->source);
  memset(adjacency, 0, sizeof *adjacency);
}
