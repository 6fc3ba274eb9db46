/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static size_t size_of(TetcastType type) {
  return type == TETCAST_TYPE_FLOAT32 ? sizeof(float) : sizeof(double);
}

bool bench_mesh_allocate(BenchMesh *mesh, TetcastType type, int64_t vertices, int64_t cells) {
  *mesh = (BenchMesh){.type = type, .vertex_count = vertices, .cell_count = cells};
  mesh->vertices = calloc((size_t)vertices, 3 * size_of(type));
  mesh->scalars = calloc((size_t)vertices, size_of(type));
  mesh->cells = calloc((size_t)cells, sizeof *mesh->cells);
  if (mesh->vertices && mesh->scalars && mesh->cells) {
    return true;
  }
  bench_mesh_release(mesh);
  return false;
}

void bench_mesh_release(BenchMesh *mesh) {
  free(mesh->vertices);
  free(mesh->scalars);
  free(mesh->cells);
  *mesh = (BenchMesh){0};
}

double bench_mesh_coordinate(const BenchMesh *mesh, int64_t i, int k) {
  return mesh->type == TETCAST_TYPE_FLOAT32 ? (double)((const float(*)[3])mesh->vertices)[i][k]
                                            : ((const double(*)[3])mesh->vertices)[i][k];
}

double bench_mesh_scalar(const BenchMesh *mesh, int64_t i) {
  return mesh->type == TETCAST_TYPE_FLOAT32 ? (double)((const float *)mesh->scalars)[i]
                                            : ((const double *)mesh->scalars)[i];
}

void bench_mesh_set_vertex(BenchMesh *mesh, int64_t i, const double position[3]) {
  for (int k = 0; k < 3; k++) {
    if (mesh->type == TETCAST_TYPE_FLOAT32) {
      ((float(*)[3])mesh->vertices)[i][k] = (float)position[k];
    } else {
      ((double(*)[3])mesh->vertices)[i][k] = position[k];
    }
  }
}

/* A few waves across the unit cube, slanted so that no level set is parallel to a face of it. */
void bench_mesh_set_scalars(BenchMesh *mesh) {
  for (int64_t i = 0; i < mesh->vertex_count; i++) {
    double x = bench_mesh_coordinate(mesh, i, 0), y = bench_mesh_coordinate(mesh, i, 1),
           z = bench_mesh_coordinate(mesh, i, 2);
    double s = 0.5 + 0.25 * sin(5 * x + 2 * y + 1) * cos(4 * y - z) + 0.25 * sin(6 * z + 3 * x * y);
    if (mesh->type == TETCAST_TYPE_FLOAT32) {
      ((float *)mesh->scalars)[i] = (float)s;
    } else {
      ((double *)mesh->scalars)[i] = s;
    }
  }
}

/* Uniform in [−1, 1), a function of i and k alone (Steele, Lea, Flood 2014: SplitMix64). */
static double noise(int64_t i, int k) {
  uint64_t z = ((uint64_t)i * 3 + (uint64_t)k + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

bool bench_mesh_cube(BenchMesh *mesh, int n, TetcastType type) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int64_t m = n + 1, step[3] = {1, m, m * m};
  if (!bench_mesh_allocate(mesh, type, m * m * m, (int64_t)n * n * n * 6)) {
    return false;
  }
  int64_t cell = 0;
  for (int64_t vertex = 0; vertex < mesh->vertex_count; vertex++) {
    const int64_t at[3] = {vertex % m, vertex / m % m, vertex / (m * m)};
    double position[3];
    for (int k = 0; k < 3; k++) {
      double shift = at[k] == 0 || at[k] == n ? 0 : 0.2 * noise(vertex, k); /* the cube's sides stay flat */
      position[k] = ((double)at[k] + shift) / n;
    }
    bench_mesh_set_vertex(mesh, vertex, position);
    for (int o = 0; o < 6 && at[0] < n && at[1] < n && at[2] < n; o++, cell++) {
      int64_t corner = vertex;
      for (int v = 0; v < 4; v++) {
        mesh->cells[cell][v] = (int32_t)corner;
        corner += v < 3 ? step[orders[o][v]] : 0;
      }
    }
  }
  bench_mesh_set_scalars(mesh);
  return true;
}

typedef struct Header {
  char magic[8];
  int64_t type, vertex_count, cell_count;
} Header;

static const char magic[8] = "tcbench1";

bool bench_mesh_save(const BenchMesh *mesh, const char *path) {
  FILE *file = fopen(path, "wb");
  if (!file) {
    return false;
  }
  Header header = {.type = mesh->type, .vertex_count = mesh->vertex_count, .cell_count = mesh->cell_count};
  for (int i = 0; i < 8; i++) {
    header.magic[i] = magic[i];
  }
  const size_t vertices = (size_t)mesh->vertex_count, cells = (size_t)mesh->cell_count;
  bool ok = fwrite(&header, sizeof header, 1, file) == 1 &&
            fwrite(mesh->vertices, 3 * size_of(mesh->type), vertices, file) == vertices &&
            fwrite(mesh->scalars, size_of(mesh->type), vertices, file) == vertices &&
            fwrite(mesh->cells, sizeof *mesh->cells, cells, file) == cells;
  return fclose(file) == 0 && ok;
}

bool bench_mesh_load(BenchMesh *mesh, const char *path) {
  *mesh = (BenchMesh){0};
  FILE *file = fopen(path, "rb");
  if (!file) {
    return false;
  }
  Header header;
  bool ok = fread(&header, sizeof header, 1, file) == 1;
  for (int i = 0; i < 8; i++) {
    ok = ok && header.magic[i] == magic[i];
  }
  ok = ok && bench_mesh_allocate(mesh, (TetcastType)header.type, header.vertex_count, header.cell_count);
  if (ok) {
    const size_t vertices = (size_t)mesh->vertex_count, cells = (size_t)mesh->cell_count;
    ok = fread(mesh->vertices, 3 * size_of(mesh->type), vertices, file) == vertices &&
         fread(mesh->scalars, size_of(mesh->type), vertices, file) == vertices &&
         fread(mesh->cells, sizeof *mesh->cells, cells, file) == cells;
  }
  fclose(file);
  if (!ok) {
    bench_mesh_release(mesh);
  }
  return ok;
}
