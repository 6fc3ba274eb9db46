/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_MESH_MESH_H
#define TC_MESH_MESH_H

#include <tetcast/field.h>
#include <tetcast/mesh.h>

#include "base/base.h"

struct TetcastMesh {
  TetcastContext *context;
  TetcastArray vertices, tetrahedra;
  void *vertex_memory, *tetrahedron_memory; /* NULL when borrowed */
  double bounds[6];
};

struct TetcastField {
  TetcastContext *context;
  TetcastArray values;
  void *memory; /* NULL when borrowed */
  TetcastAssociation association;
};

/* Vertices and cells are numbered with 31 bits, the top bit of a neighbour marks the shell (volume.h). */
enum { TC_MAX_COUNT = INT32_MAX - 1 };

TetcastStatus tc_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **mesh);
void tc_mesh_destroy(TetcastMesh *mesh);
TetcastStatus tc_field_create(TetcastContext *context, const TetcastFieldDesc *desc, TetcastField **field);
void tc_field_destroy(TetcastField *field);
void tc_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count);
TetcastStatus tc_mesh_health(TetcastContext *context, const TetcastMesh *mesh, TetcastMeshHealth *health);

static inline void tc_mesh_vertex(const TetcastMesh *mesh, int64_t i, double position[3]) {
  for (int k = 0; k < 3; ++k) position[k] = tc_array_double(&mesh->vertices, mesh->vertices.stride, i, k);
}

static inline void tc_mesh_tetrahedron(const TetcastMesh *mesh, int64_t i, int64_t indices[4]) {
  for (int k = 0; k < 4; ++k) indices[k] = tc_array_int64(&mesh->tetrahedra, mesh->tetrahedra.stride, i, k);
}

#endif
