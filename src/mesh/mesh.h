/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_MESH_MESH_H
#define TC_MESH_MESH_H

#include <string.h>

#include <tetcast/field.h>
#include <tetcast/mesh.h>

#include "base/base.h"

struct TetcastMesh {
  TetcastContext *context;
  TetcastArray vertices, tetrahedra;
  TetcastArray coordinates[3]; /* x, y, z; of `vertices`, or apart, where its data is NULL */
  const uint8_t *hidden;       /* [tetrahedra]: bits that may hide the cell; NULL: none is hidden */
  uint8_t hidden_bits;         /* those of `hidden` that count */
  void *memory[5];             /* of these arrays; NULL when borrowed */
  double bounds[6];
  int index_base; /* the number that the tetrahedra have for the first vertex, 0 or 1 */
};

struct TetcastField {
  TetcastContext *context;
  TetcastArray values;
  void *memory; /* NULL when borrowed */
  TetcastAssociation association;
  int64_t serial; /* > 0, of this field alone */
};

/* Vertices and cells are numbered with 31 bits, the top bit of a neighbour marks the shell (volume.h). */
enum { TC_MAX_COUNT = INT32_MAX - 1 };

TetcastStatus tc_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **mesh);
void tc_mesh_destroy(TetcastMesh *mesh);
TetcastStatus tc_field_create(TetcastContext *context, const TetcastFieldDesc *desc, TetcastField **field);
void tc_field_destroy(TetcastField *field);
void tc_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count);
TetcastStatus tc_mesh_health(TetcastContext *context, const TetcastMesh *mesh, TetcastMeshHealth *health);

/* Lets a mesh have coordinates that are in one array, with a stride: x, y and z are views of it. */
static inline void tc_mesh_set_vertices(TetcastMesh *mesh, const TetcastArray *vertices) {
  mesh->vertices = *vertices;
  for (int k = 0; k < 3; ++k) {
    mesh->coordinates[k] = *vertices;
    if (vertices->data)
      mesh->coordinates[k].data = (const char *)vertices->data + (size_t)k * tc_type_size(vertices->type);
  }
}

static inline void tc_mesh_vertex(const TetcastMesh *mesh, int64_t i, double position[3]) {
  for (int k = 0; k < 3; ++k) {
    const TetcastArray *of = &mesh->coordinates[k];
    const char *at = (const char *)of->data + i * of->stride; /* need not be aligned */
    if (of->type == TETCAST_TYPE_FLOAT64) {
      memcpy(&position[k], at, sizeof *position);
    } else {
      float p;
      memcpy(&p, at, sizeof p);
      position[k] = (double)p;
    }
  }
}

static inline bool tc_mesh_hides(const TetcastMesh *mesh, int64_t i) {
  return mesh->hidden && mesh->hidden[i] & mesh->hidden_bits;
}

/* The vertices of a cell as they were given: counted from the index base, and perhaps not checked yet. */
static inline void tc_mesh_given(const TetcastMesh *mesh, int64_t i, int64_t indices[4]) {
  if (mesh->tetrahedra.type == TETCAST_TYPE_INT32) {
    int32_t v[4];
    memcpy(v, (const char *)mesh->tetrahedra.data + i * mesh->tetrahedra.stride, sizeof v);
    for (int k = 0; k < 4; ++k)
      indices[k] = v[k];
  } else {
    for (int k = 0; k < 4; ++k)
      indices[k] = tc_array_int64(&mesh->tetrahedra, mesh->tetrahedra.stride, i, k);
  }
}

/* The vertices of a cell that has been checked, counted from 0. */
static inline void tc_mesh_tetrahedron(const TetcastMesh *mesh, int64_t i, int64_t indices[4]) {
  tc_mesh_given(mesh, i, indices);
  for (int k = 0; k < 4; ++k)
    indices[k] -= mesh->index_base;
}

/* The same as indices of 31 bits, whatever type they came in. */
static inline void tc_mesh_cell(const TetcastMesh *mesh, int64_t i, uint32_t vertices[4]) {
  const char *tuple = (const char *)mesh->tetrahedra.data + i * mesh->tetrahedra.stride;
  if (mesh->tetrahedra.type == TETCAST_TYPE_INT32 || mesh->tetrahedra.type == TETCAST_TYPE_UINT32) {
    memcpy(vertices, tuple, 4 * sizeof *vertices);
  } else {
    uint64_t v[4];
    memcpy(v, tuple, sizeof v);
    for (int k = 0; k < 4; ++k)
      vertices[k] = (uint32_t)v[k];
  }
  for (int k = 0; k < 4; ++k)
    vertices[k] -= (uint32_t)mesh->index_base;
}

static inline double tc_field_at(const TetcastField *field, int64_t i) {
  const char *value = (const char *)field->values.data + i * field->values.stride;
  if (field->values.type == TETCAST_TYPE_FLOAT64) {
    double s;
    memcpy(&s, value, sizeof s);
    return s;
  }
  if (field->values.type == TETCAST_TYPE_FLOAT32) {
    float s;
    memcpy(&s, value, sizeof s);
    return (double)s;
  }
  return tc_array_double(&field->values, field->values.stride, i, 0);
}

#endif
