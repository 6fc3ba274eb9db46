/* SPDX-License-Identifier: Apache-2.0 */
/* The meshes of the benchmark, the same on every machine. */
#ifndef BENCH_MESH_H
#define BENCH_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/array.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct BenchMesh {
  TetcastType type; /* of coordinates and scalars: float32 or float64 */
  int64_t vertex_count, cell_count;
  void *vertices; /* [vertex_count][3] */
  void *scalars;  /* [vertex_count], a smooth function of the position, in [0, 1] */
  int32_t (*cells)[4];
} BenchMesh;

/* The unit cube as n³ small ones of six tetrahedra each (Kuhn), inner vertices moved at random by up to a fifth of an
 * edge, which turns no cell over. False when there is no memory. */
bool bench_mesh_cube(BenchMesh *mesh, int n, TetcastType type);

/* Memory for a mesh, and the scalars for vertices that are in place. */
bool bench_mesh_allocate(BenchMesh *mesh, TetcastType type, int64_t vertices, int64_t cells);
void bench_mesh_set_scalars(BenchMesh *mesh);
void bench_mesh_release(BenchMesh *mesh);

/* A file of this program's own, read into arrays that are exactly as large as the mesh, so that a process's peak memory
 * is known. */
bool bench_mesh_save(const BenchMesh *mesh, const char *path);
bool bench_mesh_load(BenchMesh *mesh, const char *path);

/* Coordinate k of vertex i. */
double bench_mesh_coordinate(const BenchMesh *mesh, int64_t i, int k);
void bench_mesh_set_vertex(BenchMesh *mesh, int64_t i, const double position[3]);
double bench_mesh_scalar(const BenchMesh *mesh, int64_t i);

#ifdef __cplusplus
}
#endif

#endif
