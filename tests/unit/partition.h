/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh, cut as programs share it out, each of them a mesh with numbers of its own, and a scene of it. */
#ifndef PARTITION_H
#define PARTITION_H

#include "support.h"

/* How cells are dealt out: to boxes, to slabs with wavy faces, or at random. */
typedef enum Cut { CUT_BOXES, CUT_WAVES, CUT_SCATTER, CUTS } Cut;

typedef struct Part {
  TetcastVolume *volume; /* NULL: it has no cells */
  TetcastScene *scene;
} Part;

enum { MOST_PARTS = 8 };

typedef struct Partition {
  int count;
  Part part[MOST_PARTS];
} Partition;

static const double unit_bounds[6] = {0, 1, 0, 1, 0, 1};

static inline int owner_of(const Cube *cube, int64_t cell, Cut cut, int count, uint64_t *seed) {
  double at[3] = {0, 0, 0};
  for (int j = 0; j < 4; ++j) {
    for (int k = 0; k < 3; ++k)
      at[k] += 0.25 * cube->vertices[3 * cube->cells[4 * cell + j] + k];
  }
  const double random = uniform(seed), place = at[0] + 0.15 * sin(9 * at[1]) + 0.1 * cos(11 * at[2]) + 1;
  if (cut == CUT_SCATTER)
    return (int)(count * random);
  if (cut == CUT_WAVES)
    return (int)(count * (place - floor(place)));
  return ((int)(2 * at[0]) + 2 * (int)(2 * at[1]) + 4 * (int)(2 * at[2])) % count;
}

/* The mesh of the cells of one owner, with the vertices that they use, in an order of its own. NULL: it has no cells.
 * `values`: those of the vertices, [cube->vertex_count], of which the first are set. */
static inline TetcastMesh *mesh_of_owner(TetcastContext *context, const Cube *cube, const int *owner, int which,
                                         uint64_t *seed, double *values) {
  const size_t most = (size_t)cube->vertex_count;
  int64_t *local = malloc(most * sizeof *local), *ids = malloc(most * sizeof *ids), vertices = 0, cells = 0;
  double *positions = malloc(3 * most * sizeof *positions);
  int64_t *tetrahedra = malloc((size_t)cube->cell_count * 4 * sizeof *tetrahedra);
  memset(local, 0, most * sizeof *local);
  for (int64_t i = 0; i < 4 * cube->cell_count; ++i) {
    if (owner[i / 4] == which && !local[cube->cells[i]]) {
      local[cube->cells[i]] = 1;
      ids[vertices++] = cube->cells[i];
    }
  }
  for (int64_t i = vertices - 1; i > 0; --i) { /* shuffled */
    const int64_t j = (int64_t)((double)(i + 1) * uniform(seed)), id = ids[i];
    ids[i] = ids[j];
    ids[j] = id;
  }
  for (int64_t i = 0; i < vertices; ++i) {
    local[ids[i]] = i;
    memcpy(positions + 3 * i, cube->vertices + 3 * ids[i], 3 * sizeof *positions);
    values[i] = cube->values[ids[i]];
  }
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    for (int k = 0; owner[i] == which && k < 4; ++k)
      tetrahedra[4 * cells + k] = local[cube->cells[4 * i + k]];
    cells += owner[i] == which;
  }
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){positions, TETCAST_TYPE_FLOAT64, vertices, 0};
  desc.tetrahedra = (TetcastArray){tetrahedra, TETCAST_TYPE_INT64, cells, 0};
  TetcastMesh *mesh = NULL;
  if (cells)
    assert_int_equal(tetcast_mesh_create(context, &desc, &mesh), TETCAST_OK);
  free(local);
  free(ids);
  free(positions);
  free(tetrahedra);
  return mesh;
}

/* The values of the cells of one owner, or of their corners, which jump from cell to cell. */
static inline void values_of_owner(const Cube *cube, const int *owner, int which, TetcastAssociation association,
                                   double *values) {
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    if (owner[i] != which)
      continue;
    const double own = 0.5 + 0.5 * sin(0.7 * (double)i);
    for (int k = 0; association == TETCAST_CORNER && k < 4; ++k)
      *values++ = 0.9 * cube->values[cube->cells[4 * i + k]] + 0.1 * own;
    if (association == TETCAST_CELL)
      *values++ = own;
  }
}

/* A part, with the field of the cube's values, or those of cells. */
static inline Part part_of_kind(TetcastContext *context, const Cube *cube, const int *owner, int which,
                                TetcastAssociation association, uint64_t *seed) {
  Part part = {NULL, NULL};
  const int64_t most = 4 * cube->cell_count + cube->vertex_count;
  double *values = malloc((size_t)most * sizeof *values);
  TetcastMesh *mesh = mesh_of_owner(context, cube, owner, which, seed, values);
  if (mesh) {
    TetcastVolumeDesc desc = tetcast_volume_desc_default();
    desc.bounds = unit_bounds;
    desc.corners = association == TETCAST_CORNER;
    assert_int_equal(tetcast_volume_create(context, mesh, &desc, &part.volume), TETCAST_OK);
    assert_int_equal(tetcast_scene_create(context, part.volume, &part.scene), TETCAST_OK);
    int64_t count = tetcast_mesh_vertex_count(mesh);
    if (association != TETCAST_POINT) {
      values_of_owner(cube, owner, which, association, values);
      count = tetcast_mesh_tetrahedron_count(mesh) * (association == TETCAST_CORNER ? 4 : 1);
    }
    TetcastField *field = field_of(context, values, count, association);
    assert_int_equal(tetcast_scene_set_field(part.scene, field), TETCAST_OK);
    tetcast_field_destroy(&field);
    tetcast_mesh_destroy(&mesh);
  }
  free(values);
  return part;
}

static inline Part part_of(TetcastContext *context, const Cube *cube, const int *owner, int which, uint64_t *seed) {
  return part_of_kind(context, cube, owner, which, TETCAST_POINT, seed);
}

static inline Partition partition_of_kind(TetcastContext *context, const Cube *cube, Cut cut, int count,
                                          TetcastAssociation association) {
  Partition partition = {.count = count};
  uint64_t seed = 11 + (uint64_t)count;
  int *owner = malloc((size_t)cube->cell_count * sizeof *owner);
  for (int64_t i = 0; i < cube->cell_count; ++i)
    owner[i] = owner_of(cube, i, cut, count, &seed);
  for (int i = 0; i < count; ++i)
    partition.part[i] = part_of_kind(context, cube, owner, i, association, &seed);
  free(owner);
  return partition;
}

static inline Partition partition_of(TetcastContext *context, const Cube *cube, Cut cut, int count) {
  return partition_of_kind(context, cube, cut, count, TETCAST_POINT);
}

static inline void part_end(Part *part) {
  tetcast_scene_destroy(&part->scene);
  tetcast_volume_destroy(&part->volume);
}

static inline void partition_end(Partition *partition) {
  for (int i = 0; i < partition->count; ++i)
    part_end(&partition->part[i]);
}

#endif
