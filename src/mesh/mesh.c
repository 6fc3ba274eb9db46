/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"

enum { GRAIN = 1 << 14 };

/* Both checks name the first fault in the mesh, whichever thread finds it. */
typedef struct Check {
  const TetcastMesh *mesh;
  atomic_llong first_bad;
  _Atomic(unsigned char) *used; /* [vertices]: named by a cell */
} Check;

static void found_bad(Check *check, int64_t i) {
  long long first = atomic_load(&check->first_bad);
  while (i < first && !atomic_compare_exchange_weak(&check->first_bad, &first, i))
    continue;
}

static bool check_vertices(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Check *check = data;
  for (int64_t i = begin; i < end; ++i) {
    double p[3];
    tc_mesh_vertex(check->mesh, i, p);
    if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))
      continue;
    found_bad(check, i);
    break;
  }
  return true;
}

static bool in_range(const TetcastMesh *mesh, int64_t given) {
  return given >= mesh->index_base && given - mesh->index_base < mesh->vertices.count;
}

static bool check_tetrahedra(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Check *check = data;
  const TetcastMesh *mesh = check->mesh;
  for (int64_t i = begin; i < end; ++i) {
    int64_t v[4];
    tc_mesh_given(mesh, i, v);
    for (int k = 0; k < 4; ++k) {
      if (!in_range(mesh, v[k])) {
        found_bad(check, i);
        return true;
      }
      if (!tc_mesh_hides(mesh, i))
        atomic_store_explicit(&check->used[v[k] - mesh->index_base], 1, memory_order_relaxed);
    }
  }
  return true;
}

static TetcastStatus report_vertex(const TetcastMesh *mesh, int64_t i) {
  double p[3];
  tc_mesh_vertex(mesh, i, p);
  return tc_error(mesh->context, TETCAST_ERROR_DATA,
                  "vertex %" PRId64 " has a coordinate that is not finite: (%g, %g, %g)", i + mesh->index_base, p[0],
                  p[1], p[2]);
}

static TetcastStatus report_tetrahedron(const TetcastMesh *mesh, int64_t i) {
  int64_t v[4];
  tc_mesh_given(mesh, i, v);
  int k = 0;
  while (k < 3 && in_range(mesh, v[k]))
    ++k;
  return tc_error(mesh->context, TETCAST_ERROR_DATA,
                  "tetrahedron %" PRId64 " names vertex %" PRId64 ", but there are %" PRId64 " vertices%s",
                  i + mesh->index_base, v[k], mesh->vertices.count,
                  mesh->index_base ? ", counted from 1" : ", counted from 0");
}

/* Up to here, everything that is computed from coordinates stays finite, such as a camera that sees all of them. */
static const double largest_coordinate = 1e300;

static TetcastStatus check_bounds(const TetcastMesh *mesh) {
  for (int k = 0; k < 3; ++k) {
    const double low = mesh->bounds[2 * k], high = mesh->bounds[2 * k + 1];
    if (fmax(fabs(low), fabs(high)) <= largest_coordinate)
      continue;
    return tc_error(mesh->context, TETCAST_ERROR_DATA,
                    "the mesh reaches from %g to %g in %c: coordinates may be %g at most", low, high, "xyz"[k],
                    largest_coordinate);
  }
  return TETCAST_OK;
}

/* The bounds of the vertices that cells use. */
static void take_bounds(TetcastMesh *mesh, const Check *check) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t i = 0; i < mesh->vertices.count; ++i) {
    if (!check->used[i])
      continue;
    double p[3];
    tc_mesh_vertex(mesh, i, p);
    for (int k = 0; k < 3; ++k) {
      low[k] = p[k] < low[k] ? p[k] : low[k];
      high[k] = p[k] > high[k] ? p[k] : high[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    mesh->bounds[2 * k] = low[k] <= high[k] ? low[k] : 0;
    mesh->bounds[2 * k + 1] = low[k] <= high[k] ? high[k] : 0;
  }
}

/* Checks that coordinates are finite and indices in range, and computes the bounds. */
static TetcastStatus examine(TetcastContext *context, TetcastMesh *mesh) {
  Check check = {.mesh = mesh};
  atomic_init(&check.first_bad, INT64_MAX);
  tc_parallel_for(context, mesh->vertices.count, GRAIN, check_vertices, &check, NULL);
  if (check.first_bad < INT64_MAX)
    return report_vertex(mesh, check.first_bad);
  if (!tc_allocate_array(context, (void **)&check.used, mesh->vertices.count, sizeof *check.used, "mesh")) {
    return TETCAST_ERROR_MEMORY;
  }
  memset((void *)check.used, 0, (size_t)mesh->vertices.count);
  tc_parallel_for(context, mesh->tetrahedra.count, GRAIN, check_tetrahedra, &check, NULL);
  const bool ok = check.first_bad == INT64_MAX;
  if (ok)
    take_bounds(mesh, &check);
  tc_release(context, (void *)check.used);
  return ok ? check_bounds(mesh) : report_tetrahedron(mesh, check.first_bad);
}

/* Keeps coordinates that come in one array. */
static TetcastStatus keep_vertices(const TetcastMeshDesc *desc, TetcastMesh *mesh) {
  const TetcastStatus status =
      tc_array_keep(mesh->context, &desc->vertices, 3, desc->ownership, "vertices", &mesh->vertices, &mesh->memory[0]);
  if (!status)
    tc_mesh_set_vertices(mesh, &mesh->vertices);
  return status;
}

/* Keeps coordinates that come in three. */
static TetcastStatus keep_coordinates(const TetcastMeshDesc *desc, TetcastMesh *mesh) {
  TetcastStatus status = TETCAST_OK;
  for (int k = 0; !status && k < 3; ++k) {
    status = tc_array_keep(mesh->context, &desc->coordinates[k], 1, desc->ownership, "coordinates",
                           &mesh->coordinates[k], &mesh->memory[k]);
  }
  mesh->vertices = (TetcastArray){.type = desc->coordinates[0].type, .count = desc->coordinates[0].count};
  return status;
}

static TetcastStatus keep_hidden(const TetcastMeshDesc *desc, TetcastMesh *mesh) {
  mesh->hidden_bits = desc->hidden_bits;
  if (!desc->hidden != !desc->hidden_bits)
    return tc_error(mesh->context, TETCAST_ERROR_ARGUMENT,
                    desc->hidden ? "hidden cells: hidden_bits is 0, which hides none"
                                 : "hidden cells: hidden_bits is not 0, but hidden is NULL");
  if (!desc->hidden)
    return TETCAST_OK;
  mesh->hidden = desc->hidden;
  if (desc->ownership == TETCAST_BORROW || desc->tetrahedra.count == 0)
    return TETCAST_OK;
  if (!tc_allocate_array(mesh->context, &mesh->memory[4], desc->tetrahedra.count, 1, "hidden cells"))
    return TETCAST_ERROR_MEMORY;
  memcpy(mesh->memory[4], desc->hidden, (size_t)desc->tetrahedra.count);
  mesh->hidden = mesh->memory[4];
  return TETCAST_OK;
}

TetcastStatus tc_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **out) {
  const bool apart = !desc->vertices.data;
  const int64_t vertices = apart ? desc->coordinates[0].count : desc->vertices.count;
  if (vertices > TC_MAX_COUNT || desc->tetrahedra.count > TC_MAX_COUNT) {
    return tc_error(context, TETCAST_ERROR_LIMIT,
                    "%" PRId64 " vertices and %" PRId64 " tetrahedra: at most %d of each can be held", vertices,
                    desc->tetrahedra.count, (int)TC_MAX_COUNT);
  }
  TetcastMesh *mesh;
  if (!tc_allocate_array(context, (void **)&mesh, 1, sizeof *mesh, "mesh"))
    return TETCAST_ERROR_MEMORY;
  memset(mesh, 0, sizeof *mesh);
  mesh->context = context;
  mesh->index_base = desc->index_base;
  TetcastStatus status = apart ? keep_coordinates(desc, mesh) : keep_vertices(desc, mesh);
  if (!status) {
    status = tc_array_keep(context, &desc->tetrahedra, 4, desc->ownership, "tetrahedra", &mesh->tetrahedra,
                           &mesh->memory[3]);
  }
  if (!status)
    status = keep_hidden(desc, mesh);
  if (!status)
    status = examine(context, mesh);
  if (status) {
    tc_mesh_destroy(mesh);
    return status;
  }
  *out = mesh;
  return TETCAST_OK;
}

void tc_mesh_destroy(TetcastMesh *mesh) {
  if (!mesh)
    return;
  TetcastContext *context = mesh->context;
  for (size_t i = 0; i < sizeof mesh->memory / sizeof *mesh->memory; ++i)
    tc_release(context, mesh->memory[i]);
  tc_release(context, mesh);
}
