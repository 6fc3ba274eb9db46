/* SPDX-License-Identifier: Apache-2.0 */
#include "ranks_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

typedef struct Ranks Ranks;

/* ── sharing out ── */

typedef struct Work {
  int64_t size;
  int number;
} Work;

static int larger_first(const void *a, const void *b) {
  const Work *x = a, *y = b;
  return x->size != y->size ? (x->size < y->size) - (x->size > y->size) : x->number - y->number;
}

void ranks_spread(const int64_t *work, int count, int ranks, int *order, int *owner) {
  Work *sorted = cli_allocate(sizeof *sorted * (size_t)count);
  int64_t *load = cli_allocate(sizeof *load * (size_t)ranks);
  memset(load, 0, sizeof *load * (size_t)ranks);
  for (int i = 0; i < count; i++)
    sorted[i] = (Work){.size = work[i], .number = i};
  qsort(sorted, (size_t)count, sizeof *sorted, larger_first);
  for (int k = 0; k < count; k++) {
    int least = 0;
    for (int r = 1; r < ranks; r++)
      least = load[r] < load[least] ? r : least;
    order[k] = sorted[k].number;
    owner[order[k]] = least;
    load[least] += sorted[k].size + 1; /* whatever a file holds, opening it is work */
  }
  free(load);
  free(sorted);
}

void ranks_reserve(Ranks *ranks, int count) {
  ranks->parts = cli_allocate(sizeof *ranks->parts * (size_t)(count + 1));
}

Stage *ranks_add(Stage *stage) {
  Stage *part = &ranks_of(stage)->parts[ranks_of(stage)->count++];
  *part = (Stage){.context = stage->context,
                  .rows = stage->rows,
                  .array = stage->array ? cli_duplicate(stage->array) : NULL,
                  .uniform = stage->uniform,
                  .of_series = stage->of_series};
  if (ranks_of(stage)->count == 1) {
    part->volume = ranks_of(stage)->kept;
    part->fingerprint = ranks_of(stage)->kept_fingerprint;
    ranks_of(stage)->kept = NULL;
  }
  return part;
}

/* ── splitting ── */

/* Component k of tuple i of an array. (The library's functions for one of them take longer than all that is done with
 * it here.) */
static double number_at(const TetcastArray *array, int64_t i, int k, int components) {
  static const size_t sizes[] = {0, 4, 8, 4, 4, 8, 8};
  const size_t size = sizes[array->type];
  const char *at =
      (const char *)array->data + (array->stride ? array->stride : (int64_t)size * components) * i + size * (size_t)k;
  union {
    float f;
    double d;
    int32_t i32;
    uint32_t u32;
    int64_t i64;
    uint64_t u64;
  } u;
  memcpy(&u, at, size);
  switch (array->type) {
  case TETCAST_TYPE_FLOAT32:
    return (double)u.f;
  case TETCAST_TYPE_FLOAT64:
    return u.d;
  case TETCAST_TYPE_INT32:
    return u.i32;
  case TETCAST_TYPE_UINT32:
    return u.u32;
  case TETCAST_TYPE_INT64:
    return (double)u.i64;
  default:
    return (double)u.u64;
  }
}

static int32_t corner_of(const TetcastArray *tetrahedra, int64_t cell, int k) {
  return (int32_t)number_at(tetrahedra, cell, k, 4); /* a mesh has fewer vertices */
}

/* Cells in an order that is cut in two again and again. */
typedef struct Cells {
  float (*middle)[3]; /* [all]: where cells are, in the mesh's bounds */
  int32_t *number;    /* [all]: which cell comes at a place */
  float *key;         /* [all]: of the cell at a place, where its middle is along the axis by which places are found */
} Cells;

/* Whether the cell at one place comes before that at another: by key, and where that is the same, by number. */
static bool before(const Cells *cells, int64_t a, int64_t b) {
  return cells->key[a] != cells->key[b] ? cells->key[a] < cells->key[b] : cells->number[a] < cells->number[b];
}

static void exchange(Cells *cells, int64_t a, int64_t b) {
  const int32_t number = cells->number[a];
  const float key = cells->key[a];
  cells->number[a] = cells->number[b];
  cells->key[a] = cells->key[b];
  cells->number[b] = number;
  cells->key[b] = key;
}

/* Moves cells of places [begin, end) until none before `middle` comes after one from there on. */
static void part_at(Cells *cells, int64_t begin, int64_t end, int64_t middle) {
  while (end - begin > 1) {
    exchange(cells, begin + (end - begin) / 2, end - 1); /* the one that the others are compared with */
    int64_t place = begin;
    for (int64_t i = begin; i < end - 1; i++)
      if (before(cells, i, end - 1))
        exchange(cells, i, place++);
    exchange(cells, place, end - 1);
    if (place == middle)
      return;
    if (place < middle)
      begin = place + 1;
    else
      end = place;
  }
}

/* Where the middles of all cells are in the mesh's bounds, in units of their longest side. */
static void find_middles(const TetcastMesh *mesh, float (*middle)[3]) {
  const TetcastArray vertices = tetcast_mesh_vertices(mesh), tetrahedra = tetcast_mesh_tetrahedra(mesh);
  double bounds[6], side = 0;
  tetcast_mesh_bounds(mesh, bounds);
  for (int k = 0; k < 3; k++)
    side = fmax(side, bounds[2 * k + 1] - bounds[2 * k]);
  for (int64_t i = 0; i < tetrahedra.count; i++)
    for (int k = 0; k < 3; k++) {
      double sum = 0;
      for (int j = 0; j < 4; j++)
        sum += number_at(&vertices, corner_of(&tetrahedra, i, j), k, 3) / 4 - bounds[2 * k] / 4;
      middle[i][k] = side > 0 ? (float)(sum / side) : 0;
    }
}

/* Halves the cells of places [begin, end) across the longest side of the box that their middles lie in, and each half
 * again, until there are so many parts, a power of two. Part i ends at ends[i]. */
static void halve(Cells *cells, int64_t begin, int64_t end, int parts, int64_t *ends) {
  if (parts == 1) {
    *ends = end;
    return;
  }
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t i = begin; i < end; i++) {
    const float *middle = cells->middle[cells->number[i]];
    for (int k = 0; k < 3; k++) {
      low[k] = fminf(low[k], middle[k]);
      high[k] = fmaxf(high[k], middle[k]);
    }
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    axis = high[k] - low[k] > high[axis] - low[axis] ? k : axis;
  for (int64_t i = begin; i < end; i++)
    cells->key[i] = cells->middle[cells->number[i]][axis];
  const int64_t half = begin + (end - begin) / 2;
  part_at(cells, begin, end, half);
  halve(cells, begin, half, parts / 2, ends);
  halve(cells, half, end, parts / 2, ends + parts / 2);
}

static int ascending(const void *a, const void *b) {
  const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* ── a part in memory, as it is sent ── */

enum { MOST_FIELDS = 2 + 2 * TETCAST_MAX_GROUPS };

/* What there is; the arrays follow. */
typedef struct Header {
  int64_t vertices, tetrahedra;
  int32_t wide;                                /* whether coordinates are doubles */
  int32_t field, second, extinction, emission; /* how many fields of each kind */
  struct {
    int32_t association, wide;
  } fields[MOST_FIELDS];
} Header;

typedef struct Packet {
  Header header;
  void *vertices;            /* [vertices][3] */
  int32_t (*tetrahedra)[4];  /* [tetrahedra] */
  void *values[MOST_FIELDS]; /* of each field */
} Packet;

static int field_count(const Header *header) {
  return header->field + header->second + header->extinction + header->emission;
}

static int64_t value_count(const Header *header, int i) {
  const int32_t association = header->fields[i].association;
  return association == TETCAST_POINT    ? header->vertices
         : association == TETCAST_CORNER ? 4 * header->tetrahedra
                                         : header->tetrahedra;
}

static size_t width(int32_t wide) {
  return wide ? sizeof(double) : sizeof(float);
}

/* The fields of a stage, in the order of Header. */
static int list_fields(Stage *stage, TetcastField **fields[MOST_FIELDS]) {
  int count = 0;
  if (stage->field)
    fields[count++] = &stage->field;
  if (stage->second)
    fields[count++] = &stage->second;
  for (int i = 0; i < stage->coefficients.extinction_count; i++)
    fields[count++] = &stage->coefficients.extinction[i];
  for (int i = 0; i < stage->coefficients.emission_count; i++)
    fields[count++] = &stage->coefficients.emission[i];
  return count;
}

/* Makes room for what the header says. */
static void allocate(Packet *packet) {
  const Header *header = &packet->header;
  packet->vertices = cli_allocate(3 * width(header->wide) * (size_t)header->vertices + 1);
  packet->tetrahedra = cli_allocate(sizeof *packet->tetrahedra * (size_t)header->tetrahedra + 1);
  for (int i = 0; i < field_count(header); i++)
    packet->values[i] = cli_allocate(width(header->fields[i].wide) * (size_t)value_count(header, i) + 1);
}

static void release(Packet *packet) {
  free(packet->vertices);
  free(packet->tetrahedra);
  for (int i = 0; i < field_count(&packet->header); i++)
    free(packet->values[i]);
}

static void put(void *array, int32_t wide, int64_t i, double value) {
  if (wide)
    ((double *)array)[i] = value;
  else
    ((float *)array)[i] = (float)value; /* which it came from */
}

/* What a packet is filled from. */
typedef struct Source {
  Stage *stage; /* that has all of the mesh */
  TetcastArray vertices, tetrahedra;
  int32_t *place; /* [all vertices]: the vertex's number in the part, plus 1; else 0 */
  int32_t *used;  /* [all vertices]: those of the part, ascending */
} Source;

/* Finds the vertices of these cells and numbers them in their order. */
static int64_t number_vertices(Source *source, const int32_t *cells, int64_t count) {
  int64_t used = 0;
  for (int64_t i = 0; i < count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t corner = corner_of(&source->tetrahedra, cells[i], k);
      if (source->place[corner])
        continue;
      source->place[corner] = 1;
      source->used[used++] = corner;
    }
  qsort(source->used, (size_t)used, sizeof *source->used, ascending);
  for (int64_t i = 0; i < used; i++)
    source->place[source->used[i]] = (int32_t)(i + 1);
  return used;
}

static void fill_values(const Source *source, const int32_t *cells, const TetcastField *field, int i, Packet *packet) {
  const Header *header = &packet->header;
  const TetcastArray values = tetcast_field_values(field);
  const int32_t association = header->fields[i].association;
  for (int64_t k = 0; k < value_count(header, i); k++) {
    const int64_t from = association == TETCAST_POINT    ? source->used[k]
                         : association == TETCAST_CORNER ? 4 * (int64_t)cells[k / 4] + k % 4
                                                         : cells[k];
    put(packet->values[i], header->fields[i].wide, k, number_at(&values, from, 0, 1));
  }
}

/* Fills a packet with these cells, ascending, and what is theirs. */
static void pack(Source *source, const int32_t *cells, int64_t count, Packet *packet) {
  Stage *stage = source->stage;
  TetcastField **fields[MOST_FIELDS];
  Header *header = &packet->header;
  *packet = (Packet){.header = {.vertices = number_vertices(source, cells, count),
                                .tetrahedra = count,
                                .wide = source->vertices.type == TETCAST_TYPE_FLOAT64,
                                .field = stage->field != NULL,
                                .second = stage->second != NULL,
                                .extinction = stage->coefficients.extinction_count,
                                .emission = stage->coefficients.emission_count}};
  const int kinds = list_fields(stage, fields);
  for (int i = 0; i < kinds; i++) {
    header->fields[i].association = (int32_t)tetcast_field_association(*fields[i]);
    header->fields[i].wide = tetcast_field_values(*fields[i]).type != TETCAST_TYPE_FLOAT32;
  }
  allocate(packet);
  for (int64_t i = 0; i < 3 * header->vertices; i++)
    put(packet->vertices, header->wide, i, number_at(&source->vertices, source->used[i / 3], (int)(i % 3), 3));
  for (int64_t i = 0; i < 4 * count; i++)
    packet->tetrahedra[i / 4][i % 4] = source->place[corner_of(&source->tetrahedra, cells[i / 4], (int)(i % 4))] - 1;
  for (int i = 0; i < kinds; i++)
    fill_values(source, cells, *fields[i], i, packet);
  for (int64_t i = 0; i < header->vertices; i++)
    source->place[source->used[i]] = 0;
}

/* Sends a packet (to ≥ 0) or receives one (from ≥ 0). */
static TetcastStatus pass(const Ranks *ranks, Packet *packet, int to, int from) {
  const CliMpi *mpi = ranks->mpi;
  TetcastStatus status = to >= 0 ? mpi->mpi_send(ranks->world, to, &packet->header, sizeof packet->header)
                                 : mpi->mpi_receive(ranks->world, from, &packet->header, sizeof packet->header);
  if (status != TETCAST_OK)
    return status;
  if (to < 0)
    allocate(packet);
  const Header *header = &packet->header;
  const int fields = field_count(header);
  for (int i = -2; i < fields && status == TETCAST_OK; i++) {
    void *data = i == -2 ? packet->vertices : i == -1 ? (void *)packet->tetrahedra : packet->values[i];
    const size_t bytes = i == -2   ? 3 * width(header->wide) * (size_t)header->vertices
                         : i == -1 ? sizeof *packet->tetrahedra * (size_t)header->tetrahedra
                                   : width(header->fields[i].wide) * (size_t)value_count(header, i);
    status = to >= 0 ? mpi->mpi_send(ranks->world, to, data, (int64_t)bytes)
                     : mpi->mpi_receive(ranks->world, from, data, (int64_t)bytes);
  }
  return status;
}

static TetcastType type_of(int32_t wide) {
  return wide ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
}

/* Makes a part of a packet, which isn't needed then. */
static TetcastStatus unpack(Stage *stage, const Packet *packet) {
  const Header *header = &packet->header;
  Stage *part = ranks_add(stage);
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){packet->vertices, type_of(header->wide), header->vertices, 0};
  desc.tetrahedra = (TetcastArray){packet->tetrahedra, TETCAST_TYPE_INT32, header->tetrahedra, 0};
  TetcastStatus status = tetcast_mesh_create(stage->context, &desc, &part->mesh);
  TetcastField *made[MOST_FIELDS];
  int count = 0;
  for (; count < field_count(header) && status == TETCAST_OK; count++) {
    TetcastFieldDesc field = tetcast_field_desc_default();
    field.association = (TetcastAssociation)header->fields[count].association;
    field.values =
        (TetcastArray){packet->values[count], type_of(header->fields[count].wide), value_count(header, count), 0};
    status = tetcast_field_create(stage->context, &field, &made[count]);
  }
  if (status != TETCAST_OK) {
    while (count > 1)
      tetcast_field_destroy(&made[--count - 1]);
    return status;
  }
  TetcastField **next = made;
  part->field = header->field ? *next++ : NULL;
  part->second = header->second ? *next++ : NULL;
  part->coefficients.extinction_count = header->extinction;
  part->coefficients.emission_count = header->emission;
  for (int i = 0; i < header->extinction; i++)
    part->coefficients.extinction[i] = *next++;
  for (int i = 0; i < header->emission; i++)
    part->coefficients.emission[i] = *next++;
  return TETCAST_OK;
}

/* ── all of it ── */

/* Fills and sends each part, or keeps it. */
static TetcastStatus send_parts(Stage *stage, const int *owner) {
  Ranks *ranks = ranks_of(stage);
  const int64_t all = tetcast_mesh_tetrahedron_count(stage->mesh), points = tetcast_mesh_vertex_count(stage->mesh);
  Cells cells = {.middle = cli_allocate(sizeof *cells.middle * (size_t)all),
                 .number = cli_allocate(sizeof *cells.number * (size_t)all),
                 .key = cli_allocate(sizeof *cells.key * (size_t)all)};
  int64_t ends[RANKS_SPLIT];
  for (int64_t i = 0; i < all; i++)
    cells.number[i] = (int32_t)i;
  find_middles(stage->mesh, cells.middle);
  halve(&cells, 0, all, RANKS_SPLIT, ends);
  free(cells.key);
  free(cells.middle);
  Source source = {.stage = stage,
                   .vertices = tetcast_mesh_vertices(stage->mesh),
                   .tetrahedra = tetcast_mesh_tetrahedra(stage->mesh),
                   .place = cli_allocate(sizeof *source.place * (size_t)points),
                   .used = cli_allocate(sizeof *source.used * (size_t)points)};
  memset(source.place, 0, sizeof *source.place * (size_t)points);
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; i < RANKS_SPLIT && status == TETCAST_OK; i++) {
    int32_t *first = cells.number + (i > 0 ? ends[i - 1] : 0);
    const int64_t count = ends[i] - (i > 0 ? ends[i - 1] : 0);
    Packet packet;
    qsort(first, (size_t)count, sizeof *first, ascending);
    pack(&source, first, count, &packet);
    status = owner[i] == 0 ? unpack(stage, &packet) : pass(ranks, &packet, owner[i], -1);
    release(&packet);
  }
  free(source.used);
  free(source.place);
  free(cells.number);
  return status;
}

static TetcastStatus receive_parts(Stage *stage, const int *owner) {
  Ranks *ranks = ranks_of(stage);
  TetcastStatus status = TETCAST_OK, fault = TETCAST_OK;
  for (int i = 0; i < RANKS_SPLIT && status == TETCAST_OK; i++) {
    if (owner[i] != ranks->rank)
      continue;
    Packet packet = {.header = {0}};
    status = pass(ranks, &packet, -1, 0);
    if (status == TETCAST_OK && fault == TETCAST_OK)
      fault = unpack(stage, &packet); /* the rest is received nevertheless, as it is sent */
    release(&packet);
  }
  return status == TETCAST_OK ? fault : status;
}

int ranks_split(Stage *stage) {
  Ranks *ranks = ranks_of(stage);
  int owner[RANKS_SPLIT], own = 0;
  for (int i = 0; i < RANKS_SPLIT; i++) { /* parts beside each other to one rank */
    owner[i] = (int)((int64_t)i * ranks->size / RANKS_SPLIT);
    own += owner[i] == ranks->rank;
  }
  ranks_reserve(ranks, own);
  ranks->all_parts = RANKS_SPLIT;
  cli_set_apart(true);
  const TetcastStatus status = ranks->rank == 0 ? send_parts(stage, owner) : receive_parts(stage, owner);
  const int code = status == TETCAST_OK ? CLI_DONE : cli_failed(status);
  cli_set_apart(false);
  return code;
}
