/* SPDX-License-Identifier: Apache-2.0 */
#include "traverse/volume.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/order.h"
#include "mesh/stage.h"
#include "optics/transfer.h"
#include "traverse/rayspace.h"

/* Resident: 25 bytes per cell (20, its source, and its share of a cluster), 20 or 36 per vertex (the record and its source), 16 per shell face and what Embree
 * takes. While preparing, 48 per cell and 4 per vertex more at most (adjacency.c); Embree begins when that is given back. */

enum { GRAIN = 1 << 14, AHEAD = 32 };

static bool shell_only(const TetcastVolume *volume) { return volume->traversal == TETCAST_TRAVERSAL_SHELL; }

static void grow(const TetcastVolume *volume, uint32_t vertex, double low[3], double high[3]) {
  double v[4];
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
  for (int j = 0; j < (shell->faces ? 3 : 4); ++j) grow(shell->volume, vertices[j], low, high);
}

/* What the loops over vertices and cells need. */
typedef struct Take {
  const TetcastVolume *volume;
  const TetcastMesh *mesh;
  const TetcastField *field;
  void *vertices; /* where to, of this precision */
  bool is_double;
  double scale[2]; /* their product is the power of two to multiply with, which alone could overflow */
  uint32_t *rank;
} Take;

static void put(const Take *take, int64_t i, int k, double x) {
  if (take->is_double) ((double *)take->vertices)[4 * i + k] = x;
  else ((float *)take->vertices)[4 * i + k] = (float)x;
}

/* Scaled coordinates, a value of zero. */
static bool take_positions(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i) {
    double p[3];
    tc_mesh_vertex(take->mesh, take->volume->vertex_source[i], p);
    for (int k = 0; k < 3; ++k) put(take, i, k, tc_without_tiny(p[k] * take->scale[0] * take->scale[1]));
    put(take, i, 3, 0);
  }
  return true;
}

static bool take_ranks(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  for (int64_t i = begin; i < end; ++i) take->rank[take->volume->vertex_source[i]] = (uint32_t)i;
  return true;
}

static TetcastStatus take_vertices(TetcastVolume *volume, const TetcastMesh *mesh) {
  double largest = 0;
  for (int k = 0; k < 6; ++k) largest = fmax(largest, fabs(mesh->bounds[k]));
  if (largest > 0) frexp(largest, &volume->exponent);
  volume->mesh_is_double = volume->vertices_are_double = mesh->vertices.type == TETCAST_TYPE_FLOAT64;
  const size_t size = volume->vertices_are_double ? sizeof(double) : sizeof(float);
  if (!tc_allocate_array(volume->context, &volume->vertices, volume->vertex_count, 4 * size, "vertices")) {
    return TETCAST_ERROR_MEMORY;
  }
  const int half = -volume->exponent / 2;
  Take take = {.volume = volume, .mesh = mesh, .vertices = volume->vertices, .is_double = volume->vertices_are_double,
               .scale = {ldexp(1, half), ldexp(1, -volume->exponent - half)}};
  tc_parallel_for(volume->context, volume->vertex_count, GRAIN, take_positions, &take, NULL);
  double diagonal2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double low = ldexp(mesh->bounds[2 * k], -volume->exponent), high = ldexp(mesh->bounds[2 * k + 1], -volume->exponent);
    volume->center[k] = 0.5 * low + 0.5 * high;
    diagonal2 += (high - low) * (high - low);
  }
  /* Coordinates are at most 1: what is added covers the rounding of the centre and of distances to it. */
  volume->radius = 0.5 * sqrt(diagonal2) * (1 + 0x1p-48) + 0x1p-50;
  return TETCAST_OK;
}

/* The adjacency in the numbering of volume->vertex_source. */
static TetcastStatus take_cells(TetcastVolume *volume, const TetcastMesh *mesh, const TetcastProgress *progress) {
  Take take = {.volume = volume};
  if (!tc_allocate_array(volume->context, (void **)&take.rank, volume->vertex_count, sizeof *take.rank, "vertices")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(volume->context, volume->vertex_count, GRAIN, take_ranks, &take, NULL);
  TcAdjacency *adjacency = &volume->adjacency;
  TetcastStatus status = tc_adjacency_build(mesh, take.rank, true, progress, adjacency);
  tc_release(volume->context, take.rank);
  if (status || !shell_only(volume)) return status;
  status = tc_clusters_build(volume->context, adjacency, (const uint32_t(*)[4])adjacency->vertices, &volume->clusters);
  tc_release(volume->context, adjacency->vertices);
  adjacency->vertices = NULL;
  return status;
}

static double triangle_area(const TetcastVolume *volume, const uint32_t vertex[3]) {
  double p[3][4], e[2][3];
  for (int j = 0; j < 3; ++j) tc_volume_vertex(volume, vertex[j], p[j]);
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 3; ++k) e[j][k] = p[j + 1][k] - p[0][k];
  }
  const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
               z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
  return 0.5 * sqrt(x * x + y * y + z * z);
}

static void describe(TetcastVolume *volume, const TetcastMesh *mesh) {
  TetcastVolumeInfo *info = &volume->info;
  info->vertices = volume->vertex_count;
  info->tetrahedra = volume->cell_count;
  info->left_out = volume->mesh_cell_count - volume->cell_count;
  memcpy(info->bounds, mesh->bounds, sizeof info->bounds);
  info->shell_faces = shell_only(volume) ? volume->adjacency.shell_count : volume->cell_count;
  info->traversal = volume->traversal;
  double area = 0;
  for (int64_t i = 0; i < volume->adjacency.shell_count; ++i) area += triangle_area(volume, volume->adjacency.shell[i].vertex);
  info->boundary_area = ldexp(ldexp(area, volume->exponent), volume->exponent);
}

static TetcastStatus build(TetcastVolume *volume, const TetcastMesh *mesh, const TetcastVolumeDesc *desc) {
  TcStage stage;
  TetcastStatus status = tc_order_vertices(mesh, &volume->vertex_source);
  if (!status) status = take_vertices(volume, mesh);
  if (!status) status = take_cells(volume, mesh, tc_stage(&stage, &desc->progress, 0.1, 1));
  if (status) return status;
  volume->cell_count = volume->adjacency.cell_count;
  if (volume->cell_count == 0) {
    return tc_error(volume->context, TETCAST_ERROR_DATA, "the mesh has no cell with an inside (%" PRId64 " tetrahedra)",
                    volume->mesh_cell_count);
  }
  if (volume->cell_count < volume->mesh_cell_count) {
    tc_warning(volume->context, "%" PRId64 " tetrahedra left out: %" PRId64 " with a vertex twice, %" PRId64
               " duplicates of others", volume->mesh_cell_count - volume->cell_count, volume->adjacency.collapsed,
               volume->adjacency.duplicates);
  }
  if (volume->adjacency.nonmanifold > 0 && shell_only(volume)) {
    tc_warning(volume->context, "%" PRId64 " faces have three cells or more, which overlap then: the traversal of faces is right, the shell's may not be",
               volume->adjacency.nonmanifold);
  }
  describe(volume, mesh);
  if (!shell_only(volume)) tc_adjacency_drop_links(&volume->adjacency);
  volume->shell = (TcShell){.volume = volume, .faces = volume->adjacency.shell, .count = volume->info.shell_faces};
  return tc_embree_create(volume->context, volume->shell.count, volume->center, volume->radius, tc_shell_bounds, &volume->shell,
                          &volume->shell.embree);
}

TetcastStatus tc_volume_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastVolumeDesc *desc,
                               TetcastVolume **out) {
  if (mesh->tetrahedra.count == 0) return tc_error(context, TETCAST_ERROR_DATA, "the mesh has no tetrahedra");
  TetcastVolume *volume;
  if (!tc_allocate_array(context, (void **)&volume, 1, sizeof *volume, "volume")) return TETCAST_ERROR_MEMORY;
  memset(volume, 0, sizeof *volume);
  volume->context = context;
  volume->traversal = desc->traversal;
  volume->vertex_count = mesh->vertices.count;
  volume->mesh_cell_count = mesh->tetrahedra.count;
  const TetcastStatus status = build(volume, mesh, desc);
  if (status) {
    tc_volume_destroy(volume);
    return status;
  }
  *out = volume;
  return TETCAST_OK;
}

void tc_volume_destroy(TetcastVolume *volume) {
  if (!volume) return;
  TetcastContext *context = volume->context;
  tc_embree_destroy(volume->shell.embree);
  tc_clusters_clear(&volume->clusters);
  if (volume->adjacency.context) tc_adjacency_clear(&volume->adjacency);
  tc_release(context, volume->vertices);
  tc_release(context, volume->vertex_source);
  tc_release(context, volume->cell_values);
  tc_release(context, volume);
}

/* The value as it is stored. */
static double value_of(const Take *take, int64_t i) {
  const double s = tc_field_at(take->field, i);
  return isfinite(s) ? s * take->scale[0] : (double)NAN;
}

static bool take_point_values(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  const TetcastVolume *volume = take->volume;
  for (int64_t i = begin; i < end; ++i) {
    if (take->vertices != volume->vertices) { /* of another precision than before */
      double v[4];
      tc_volume_vertex(volume, (uint32_t)i, v);
      for (int k = 0; k < 3; ++k) put(take, i, k, v[k]);
    }
    put(take, i, 3, value_of(take, volume->vertex_source[i]));
  }
  return true;
}

static TetcastStatus set_point_field(TetcastVolume *volume, Take *take) {
  TetcastContext *context = volume->context;
  take->is_double = volume->mesh_is_double || take->field->values.type != TETCAST_TYPE_FLOAT32;
  take->vertices = volume->vertices;
  const size_t size = 4 * (take->is_double ? sizeof(double) : sizeof(float));
  if (take->is_double != volume->vertices_are_double &&
      !tc_allocate_array(context, &take->vertices, volume->vertex_count, size, "vertices")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(context, volume->vertex_count, GRAIN, take_point_values, take, NULL);
  if (take->vertices != volume->vertices) tc_release(context, volume->vertices);
  volume->vertices = take->vertices;
  volume->vertices_are_double = take->is_double;
  tc_release(context, volume->cell_values);
  volume->cell_values = NULL;
  return TETCAST_OK;
}

static bool take_cell_values(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Take *take = data;
  const TetcastVolume *volume = take->volume;
  const TetcastArray *values = &take->field->values;
  const uint32_t *source = volume->adjacency.source;
  for (int64_t i = begin; i < end; ++i) {
    if (i + AHEAD < end) __builtin_prefetch((const char *)values->data + source[i + AHEAD] * values->stride);
    volume->cell_values[i] = value_of(take, source[i]);
  }
  return true;
}

static TetcastStatus set_cell_field(TetcastVolume *volume, Take *take) {
  if (!volume->cell_values && !tc_allocate_array(volume->context, (void **)&volume->cell_values, volume->cell_count,
                                                 sizeof(double), "cell values")) {
    return TETCAST_ERROR_MEMORY;
  }
  tc_parallel_for(volume->context, volume->cell_count, GRAIN, take_cell_values, take, NULL);
  return TETCAST_OK;
}

TetcastStatus tc_volume_set_field(TetcastVolume *volume, const TetcastField *field) {
  const bool point = field->association == TETCAST_POINT;
  const int64_t wanted = point ? volume->vertex_count : volume->mesh_cell_count;
  if (field->values.count != wanted) {
    return tc_error(volume->context, TETCAST_ERROR_ARGUMENT, "the field has %" PRId64 " values, the mesh %" PRId64 " %s",
                    field->values.count, wanted, point ? "vertices" : "tetrahedra");
  }
  double range[2];
  int64_t nonfinite;
  tc_field_range(field, range, &nonfinite);
  const double largest = fmax(fabs(range[0]), fabs(range[1]));
  const bool tiny = largest > 0 && largest < ldexp(1, -TC_TINY_FIELD);
  const int exponent = tiny ? -TC_TINY_FIELD : largest > TC_LARGEST_SCALAR ? TC_HUGE_FIELD : 0;
  Take take = {.volume = volume, .field = field, .scale = {ldexp(1, -exponent)}};
  const TetcastStatus status = point ? set_point_field(volume, &take) : set_cell_field(volume, &take);
  if (status) return status;
  volume->value_exponent = exponent;
  volume->association = field->association;
  volume->has_field = true;
  ++volume->field_number;
  tc_clusters_set_field(&volume->clusters, volume);
  memcpy(volume->info.field_range, range, sizeof range);
  volume->info.field_nonfinite = nonfinite;
  return TETCAST_OK;
}

void tc_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info) {
  *info = volume->info;
  const size_t record = 4 * (volume->vertices_are_double ? sizeof(double) : sizeof(float));
  const TcAdjacency *adjacency = &volume->adjacency;
  const size_t cells = (size_t)volume->cell_count, shell = (size_t)adjacency->shell_count;
  info->bytes = sizeof *volume + (size_t)volume->vertex_count * (record + sizeof *volume->vertex_source) + tc_embree_bytes(volume->shell.embree) + tc_clusters_bytes(&volume->clusters) +
                (adjacency->cells ? cells * sizeof *adjacency->cells : 0) +
                (adjacency->shell ? shell * sizeof *adjacency->shell : 0) +
                (adjacency->vertices ? cells * sizeof *adjacency->vertices : 0) +
                (adjacency->source ? cells * sizeof *adjacency->source : 0) +
                (volume->cell_values ? cells * sizeof *volume->cell_values : 0);
}
