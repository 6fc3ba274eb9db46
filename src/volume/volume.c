/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/volume.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/order.h"
#include "mesh/stage.h"
#include "volume/fold.h"

/* A volume takes 25 bytes per cell (20 for the cell, 4 for its source, 1 for its share of a cluster), 16 or 28 per
 * vertex (its position and its source), 16 per shell face, and what Embree allocates; a field that scenes show takes 4
 * or 8 per vertex. Preparing it takes at most 48 bytes per cell and 4 per vertex in addition (adjacency.c), which are
 * freed before Embree begins. */

enum { GRAIN = 1 << 14 };

static bool shell_only(const TetcastVolume *volume) {
  return volume->traversal == TETCAST_TRAVERSAL_SHELL;
}

static void grow(const TetcastVolume *volume, uint32_t vertex, double low[3], double high[3]) {
  double v[3];
  tc_volume_vertex(volume, vertex, v);
  for (int k = 0; k < 3; ++k) {
    low[k] = v[k] < low[k] ? v[k] : low[k];
    high[k] = v[k] > high[k] ? v[k] : high[k];
  }
}

void tc_shell_bounds(const void *user, uint32_t i, double low[3], double high[3]) {
  const TcShell *shell = user;
  const uint32_t *vertices = shell->faces ? shell->faces[i].vertex : shell->volume->adjacency.vertices[i];
  for (int k = 0; k < 3; ++k) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
  }
  for (int j = 0; j < (shell->faces ? 3 : 4); ++j)
    grow(shell->volume, vertices[j], low, high);
}

/* What the loops over vertices need. */
typedef struct Take {
  const TetcastVolume *volume;
  const TetcastMesh *mesh;
  double scale[2]; /* coordinates are multiplied with both; their product could overflow */
  uint32_t *rank;
} Take;

static bool take_positions(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  const TetcastVolume *volume = take->volume;
  for (int64_t i = begin; i < end; ++i) {
    double p[3];
    tc_mesh_vertex(take->mesh, volume->vertex_source[i], p);
    for (int k = 0; k < 3; ++k) {
      const double x = tc_without_tiny(p[k] * take->scale[0] * take->scale[1]);
      if (volume->positions_are_double)
        ((double *)volume->positions)[3 * i + k] = x;
      else
        ((float *)volume->positions)[3 * i + k] = (float)x;
    }
  }
  return true;
}

static bool take_ranks(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i)
    take->rank[take->volume->vertex_source[i]] = (uint32_t)i;
  return true;
}

static TetcastStatus take_vertices(TetcastVolume *volume, const TetcastMesh *mesh, const double bounds[6]) {
  double largest = 0;
  for (int k = 0; k < 6; ++k)
    largest = fmax(largest, fabs(bounds[k]));
  if (largest > 0)
    frexp(largest, &volume->exponent);
  volume->positions_are_double = mesh->vertices.type == TETCAST_TYPE_FLOAT64;
  const size_t size = volume->positions_are_double ? sizeof(double) : sizeof(float);
  if (!tc_allocate_array(volume->context, &volume->positions, 3 * volume->vertex_count + 1, size, "vertices")) {
    return TETCAST_ERROR_MEMORY;
  }
  memset((char *)volume->positions + 3 * (size_t)volume->vertex_count * size, 0, size);
  const int half = -volume->exponent / 2;
  Take take = {.volume = volume, .mesh = mesh, .scale = {ldexp(1, half), ldexp(1, -volume->exponent - half)}};
  tc_parallel_for(volume->context, volume->vertex_count, GRAIN, take_positions, &take, NULL);
  double diagonal2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double low = ldexp(bounds[2 * k], -volume->exponent), high = ldexp(bounds[2 * k + 1], -volume->exponent);
    volume->center[k] = 0.5 * low + 0.5 * high;
    diagonal2 += (high - low) * (high - low);
  }
  /* Coordinates are at most 1, so what is added covers the rounding of the centre and of distances to it. */
  volume->radius = 0.5 * sqrt(diagonal2) * (1 + 0x1p-48) + 0x1p-50;
  return TETCAST_OK;
}

static bool take_corners(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i) {
    uint32_t v[4], order = 0;
    tc_mesh_cell(take->mesh, take->volume->adjacency.source[i], v);
    for (int k = 0; k < 4; ++k)
      v[k] = take->rank[v[k]];
    for (int k = 0; k < 4; ++k) {
      const int place = (v[k] > v[0]) + (v[k] > v[1]) + (v[k] > v[2]) + (v[k] > v[3]);
      order |= (uint32_t)k << 2 * place;
    }
    take->volume->corner_order[i] = (uint8_t)order;
  }
  return true;
}

static bool take_corner_vertices(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i) {
    uint32_t v[4];
    tc_mesh_cell(take->mesh, take->volume->adjacency.source[i], v);
    for (int k = 0; k < 4; ++k) {
      const uint32_t own = take->rank[v[k]];
      const int place =
          (own > take->rank[v[0]]) + (own > take->rank[v[1]]) + (own > take->rank[v[2]]) + (own > take->rank[v[3]]);
      take->volume->corner_vertices[i][place] = v[k];
    }
  }
  return true;
}

/* The mesh's vertices in faces of one cell, in the volume's order: cells meet there if their vertices lie at one place.
 */
static TetcastStatus shell_vertices(const TetcastVolume *volume, uint32_t **out, int64_t *count) {
  uint8_t *used;
  const int64_t shell = volume->adjacency.shell_count,
                most = 3 * shell < volume->vertex_count ? 3 * shell : volume->vertex_count;
  if (!tc_allocate_array(volume->context, (void **)&used, volume->vertex_count, 1, "vertices of the boundary"))
    return TETCAST_ERROR_MEMORY;
  if (!tc_allocate_array(volume->context, (void **)out, most, sizeof **out, "vertices of the boundary")) {
    tc_release(volume->context, used);
    return TETCAST_ERROR_MEMORY;
  }
  memset(used, 0, (size_t)volume->vertex_count);
  for (int64_t i = 0; i < shell; ++i) {
    for (int k = 0; k < 3; ++k)
      used[volume->adjacency.shell[i].vertex[k]] = 1;
  }
  *count = 0;
  for (int64_t i = 0; i < volume->vertex_count; ++i) {
    if (used[i])
      (*out)[(*count)++] = volume->vertex_source[i];
  }
  tc_release(volume->context, used);
  return TETCAST_OK;
}

/* Lets cells meet at vertices that lie at one place. If cells share all their vertices, this only takes a look at the
 * vertices of the boundary. */
static TetcastStatus join_cells(TetcastVolume *volume, const double bounds[6], Take *take) {
  uint32_t *vertices = NULL;
  int64_t count = 0;
  TetcastStatus status = shell_vertices(volume, &vertices, &count);
  if (!status)
    status = tc_weld(take->mesh, bounds, vertices, count, &volume->welds, &volume->weld_count);
  tc_release(volume->context, vertices);
  if (status || volume->weld_count == 0)
    return status;
  for (int64_t i = 0; i < volume->weld_count; ++i)
    take->rank[volume->welds[i].vertex] = take->rank[volume->welds[i].with];
  tc_adjacency_clear(&volume->adjacency);
  status = tc_adjacency_build(take->mesh, take->rank, true, NULL, &volume->adjacency);
  const int64_t cells = volume->adjacency.cell_count;
  if (status)
    return status;
  if (!tc_allocate_array(volume->context, (void **)&volume->corner_vertices, cells, sizeof *volume->corner_vertices,
                         "corners")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(volume->context, cells, GRAIN, take_corner_vertices, take, NULL);
  return TETCAST_OK;
}

static TetcastStatus order_corners(TetcastVolume *volume, Take *take) {
  const int64_t count = volume->adjacency.cell_count;
  if (!tc_allocate_array(volume->context, (void **)&volume->corner_order, count, 1, "corners"))
    return TETCAST_ERROR_MEMORY;
  tc_parallel_for(volume->context, count, GRAIN, take_corners, take, NULL);
  return TETCAST_OK;
}

/* Builds the adjacency, with vertices numbered as in volume->vertex_source. */
static TetcastStatus take_cells(TetcastVolume *volume, const TetcastMesh *mesh, const double bounds[6], bool corners,
                                const TetcastProgress *progress) {
  Take take = {.volume = volume, .mesh = mesh};
  if (!tc_allocate_array(volume->context, (void **)&take.rank, volume->vertex_count, sizeof *take.rank, "vertices")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(volume->context, volume->vertex_count, GRAIN, take_ranks, &take, NULL);
  TcAdjacency *adjacency = &volume->adjacency;
  TetcastStatus status = tc_adjacency_build(mesh, take.rank, true, progress, adjacency);
  if (!status)
    status = join_cells(volume, bounds, &take);
  if (!status && corners)
    status = order_corners(volume, &take);
  tc_release(volume->context, take.rank);
  if (status || !shell_only(volume))
    return status;
  const uint32_t end = (uint32_t)adjacency->cell_count; /* lanes without a ray are in this cell and stay in it */
  adjacency->cells[adjacency->cell_count] = (TcCell){0, {end, end, end, end}};
  status = tc_clusters_build(volume->context, adjacency, (const uint32_t(*)[4])adjacency->vertices, &volume->clusters);
  volume->folds = tc_adjacency_folds(adjacency, volume->positions, volume->positions_are_double);
  tc_release(volume->context, adjacency->vertices);
  adjacency->vertices = NULL;
  return status;
}

static double triangle_area(const TetcastVolume *volume, const uint32_t vertex[3]) {
  double p[3][3], e[2][3];
  for (int j = 0; j < 3; ++j)
    tc_volume_vertex(volume, vertex[j], p[j]);
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 3; ++k)
      e[j][k] = p[j + 1][k] - p[0][k];
  }
  const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
               z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
  return 0.5 * sqrt(x * x + y * y + z * z);
}

static void describe(TetcastVolume *volume, const TetcastMesh *mesh) {
  TetcastVolumeInfo *info = &volume->info;
  info->vertices = volume->vertex_count;
  info->tetrahedra = volume->cell_count;
  info->welded = volume->weld_count;
  info->left_out = volume->mesh_cell_count - volume->cell_count;
  memcpy(info->bounds, mesh->bounds, sizeof info->bounds);
  info->shell_faces = shell_only(volume) ? volume->adjacency.shell_count : volume->cell_count;
  info->traversal = volume->traversal;
  double area = 0;
  for (int64_t i = 0; i < volume->adjacency.shell_count; ++i)
    area += triangle_area(volume, volume->adjacency.shell[i].vertex);
  info->boundary_area = ldexp(ldexp(area, volume->exponent), volume->exponent);
}

static TetcastStatus build(TetcastVolume *volume, const TetcastMesh *mesh, const TetcastVolumeDesc *desc) {
  TcStage stage;
  const double *bounds = desc->bounds ? desc->bounds : mesh->bounds;
  TetcastStatus status = tc_order_vertices(mesh, &volume->vertex_source);
  if (!status)
    status = take_vertices(volume, mesh, bounds);
  if (!status)
    status = take_cells(volume, mesh, bounds, desc->corners, tc_stage(&stage, &desc->progress, 0.1, 1));
  if (status)
    return status;
  volume->cell_count = volume->adjacency.cell_count;
  if (volume->cell_count == 0) {
    return tc_error(volume->context, TETCAST_ERROR_DATA,
                    "the mesh has no cell with an inside (%" PRId64 " tetrahedra, %" PRId64 " of them hidden)",
                    volume->mesh_cell_count, volume->adjacency.hidden);
  }
  const int64_t faulty = volume->mesh_cell_count - volume->cell_count - volume->adjacency.hidden;
  if (faulty > 0) {
    tc_warning(volume->context,
               "%" PRId64 " tetrahedra left out: %" PRId64 " with a vertex twice, %" PRId64 " duplicates of others",
               faulty, volume->adjacency.collapsed, volume->adjacency.duplicates);
  }
  if (volume->adjacency.nonmanifold > 0 && shell_only(volume)) {
    tc_warning(
        volume->context,
        "%" PRId64
        " faces have three cells or more, which overlap then: the traversal of faces is right, the shell's may not be",
        volume->adjacency.nonmanifold);
  }
  describe(volume, mesh);
  if (!shell_only(volume))
    tc_adjacency_drop_links(&volume->adjacency);
  volume->shell = (TcShell){.volume = volume, .faces = volume->adjacency.shell, .count = volume->info.shell_faces};
  return tc_embree_create(volume->context, volume->shell.count, volume->center, volume->radius, tc_shell_bounds,
                          &volume->shell, &volume->shell.embree);
}

TetcastStatus tc_volume_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastVolumeDesc *desc,
                               TetcastVolume **out) {
  if (mesh->tetrahedra.count == 0)
    return tc_error(context, TETCAST_ERROR_DATA, "the mesh has no tetrahedra");
  TetcastVolume *volume;
  if (!tc_allocate_array(context, (void **)&volume, 1, sizeof *volume, "volume"))
    return TETCAST_ERROR_MEMORY;
  memset(volume, 0, sizeof *volume);
  volume->context = context;
  volume->traversal = desc->traversal;
  volume->is_part = desc->bounds != NULL;
  volume->vertex_count = mesh->vertices.count;
  volume->mesh_cell_count = mesh->tetrahedra.count;
  TetcastStatus status = tc_shared_create(context, &volume->shared);
  if (!status)
    status = build(volume, mesh, desc);
  if (status) {
    tc_volume_destroy(volume);
    return status;
  }
  *out = volume;
  return TETCAST_OK;
}

void tc_volume_destroy(TetcastVolume *volume) {
  if (!volume)
    return;
  TetcastContext *context = volume->context;
  tc_embree_destroy(volume->shell.embree);
  tc_clusters_clear(&volume->clusters);
  if (volume->adjacency.context)
    tc_adjacency_clear(&volume->adjacency);
  tc_release(context, volume->positions);
  tc_release(context, volume->vertex_source);
  tc_release(context, volume->corner_order);
  tc_release(context, volume->corner_vertices);
  tc_release(context, volume->welds);
  tc_shared_destroy(volume->shared);
  tc_release(context, volume);
}

void tc_volume_each_cell(const TetcastVolume *volume, void visit(void *data, const uint32_t vertex[4]), void *data) {
  if (volume->traversal == TETCAST_TRAVERSAL_FACES) {
    for (int64_t i = 0; i < volume->cell_count; ++i)
      visit(data, volume->adjacency.vertices[i]);
    return;
  }
  for (int64_t c = 0; c < volume->clusters.count; ++c) {
    uint32_t vertices[TC_CLUSTER][4];
    const int count = tc_cluster_cells(&volume->clusters, &volume->adjacency, c, vertices);
    for (int i = 0; i < count; ++i)
      visit(data, vertices[i]);
  }
}

void tc_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info) {
  *info = volume->info;
  const size_t position = 3 * (volume->positions_are_double ? sizeof(double) : sizeof(float));
  const TcAdjacency *adjacency = &volume->adjacency;
  const size_t cells = (size_t)volume->cell_count, shell = (size_t)adjacency->shell_count;
  info->bytes = sizeof *volume + (size_t)volume->vertex_count * (position + sizeof *volume->vertex_source) +
                tc_embree_bytes(volume->shell.embree) + tc_clusters_bytes(&volume->clusters) +
                (adjacency->cells ? cells * sizeof *adjacency->cells : 0) +
                (adjacency->shell ? shell * sizeof *adjacency->shell : 0) +
                (adjacency->vertices ? cells * sizeof *adjacency->vertices : 0) +
                (adjacency->source ? cells * sizeof *adjacency->source : 0) + (volume->corner_order ? cells : 0) +
                (volume->corner_vertices ? cells * sizeof *volume->corner_vertices : 0) +
                (size_t)volume->weld_count * sizeof *volume->welds + tc_shared_bytes(volume->shared);
}
