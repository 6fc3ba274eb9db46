/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static TetcastStatus check_vertices(TetcastContext *context, const TetcastMesh *mesh) {
  for (int64_t i = 0; i < mesh->vertices.count; ++i) {
    double p[3];
    tc_mesh_vertex(mesh, i, p);
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) {
      return tc_error(context, TETCAST_ERROR_DATA, "vertex %" PRId64 " has a coordinate that is not finite: (%g, %g, %g)", i,
                      p[0], p[1], p[2]);
    }
  }
  return TETCAST_OK;
}

/* Checks the indices and, on the way, takes the bounds of the vertices they name. */
static TetcastStatus check_tetrahedra(TetcastContext *context, TetcastMesh *mesh) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t i = 0; i < mesh->tetrahedra.count; ++i) {
    int64_t v[4];
    tc_mesh_tetrahedron(mesh, i, v);
    for (int j = 0; j < 4; ++j) {
      if (v[j] < 0 || v[j] >= mesh->vertices.count) {
        return tc_error(context, TETCAST_ERROR_DATA,
                        "tetrahedron %" PRId64 " names vertex %" PRId64 ", but there are %" PRId64 " vertices", i, v[j],
                        mesh->vertices.count);
      }
      double p[3];
      tc_mesh_vertex(mesh, v[j], p);
      for (int k = 0; k < 3; ++k) {
        low[k] = fmin(low[k], p[k]);
        high[k] = fmax(high[k], p[k]);
      }
    }
  }
  for (int k = 0; k < 3; ++k) {
    mesh->bounds[2 * k] = mesh->tetrahedra.count ? low[k] : 0;
    mesh->bounds[2 * k + 1] = mesh->tetrahedra.count ? high[k] : 0;
  }
  return TETCAST_OK;
}

TetcastStatus tc_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **out) {
  if (desc->vertices.count > TC_MAX_COUNT || desc->tetrahedra.count > TC_MAX_COUNT) {
    return tc_error(context, TETCAST_ERROR_LIMIT, "%" PRId64 " vertices and %" PRId64 " tetrahedra: at most %d of each can be held",
                    desc->vertices.count, desc->tetrahedra.count, (int)TC_MAX_COUNT);
  }
  TetcastMesh *mesh;
  if (!tc_allocate_array(context, (void **)&mesh, 1, sizeof *mesh, "mesh")) return TETCAST_ERROR_MEMORY;
  memset(mesh, 0, sizeof *mesh);
  mesh->context = context;
  TetcastStatus status =
    tc_array_keep(context, &desc->vertices, 3, desc->ownership, "vertices", &mesh->vertices, &mesh->vertex_memory);
  if (!status) {
    status = tc_array_keep(context, &desc->tetrahedra, 4, desc->ownership, "tetrahedra", &mesh->tetrahedra,
                           &mesh->tetrahedron_memory);
  }
  if (!status) status = check_vertices(context, mesh);
  if (!status) status = check_tetrahedra(context, mesh);
  if (status) {
    tc_mesh_destroy(mesh);
    return status;
  }
  *out = mesh;
  return TETCAST_OK;
}

void tc_mesh_destroy(TetcastMesh *mesh) {
  if (!mesh) return;
  TetcastContext *context = mesh->context;
  tc_release(context, mesh->vertex_memory);
  tc_release(context, mesh->tetrahedron_memory);
  tc_release(context, mesh);
}
