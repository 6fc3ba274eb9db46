/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/adjacency.h"

static void subtract(const double a[3], const double b[3], double d[3]) {
  for (int k = 0; k < 3; ++k)
    d[k] = a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A mesh seen in units of its largest coordinate, a power of two: products of coordinates then neither overflow nor,
 * where they matter, underflow. */
typedef struct Scaled {
  const TetcastMesh *mesh;
  int exponent;
  double scale[2]; /* their product is 2^−exponent, which alone could overflow */
} Scaled;

static Scaled scaled(const TetcastMesh *mesh) {
  Scaled s = {.mesh = mesh};
  double largest = 0;
  for (int k = 0; k < 6; ++k)
    largest = fmax(largest, fabs(mesh->bounds[k]));
  if (largest > 0)
    frexp(largest, &s.exponent);
  const int half = -s.exponent / 2;
  s.scale[0] = ldexp(1, half);
  s.scale[1] = ldexp(1, -s.exponent - half);
  return s;
}

static void scaled_vertex(const Scaled *s, int64_t i, double p[3]) {
  tc_mesh_vertex(s->mesh, i, p);
  for (int k = 0; k < 3; ++k)
    p[k] = p[k] * s->scale[0] * s->scale[1];
}

/* (v1 − v0) × (v2 − v0) · (v3 − v0) / 6 */
static double signed_volume(const Scaled *mesh, const int64_t v[4]) {
  double p[4][3], e[3][3], n[3];
  for (int k = 0; k < 4; ++k)
    scaled_vertex(mesh, v[k], p[k]);
  for (int k = 0; k < 3; ++k)
    subtract(p[k + 1], p[0], e[k]);
  cross(e[0], e[1], n);
  return dot(n, e[2]) / 6;
}

static double triangle_area(const Scaled *mesh, const uint32_t v[3]) {
  double p[3][3], e[2][3], n[3];
  for (int k = 0; k < 3; ++k)
    scaled_vertex(mesh, v[k], p[k]);
  for (int k = 0; k < 2; ++k)
    subtract(p[k + 1], p[0], e[k]);
  cross(e[0], e[1], n);
  return sqrt(dot(n, n)) / 2;
}

/* Number of sets of cells connected through faces, by a flood fill that keeps its frontier in one array. */
static TetcastStatus count_components(TetcastContext *context, const TcAdjacency *adjacency, int64_t *count) {
  const int64_t n = adjacency->cell_count;
  uint32_t *stack = NULL;
  unsigned char *seen = NULL;
  TetcastStatus status = TETCAST_ERROR_MEMORY;
  if (tc_allocate_array(context, (void **)&stack, n, sizeof *stack, "components") &&
      tc_allocate_array(context, (void **)&seen, n, 1, "components")) {
    memset(seen, 0, (size_t)n);
    *count = 0;
    for (int64_t start = 0; start < n; ++start) {
      if (seen[start])
        continue;
      ++*count;
      int64_t depth = 0;
      stack[depth++] = (uint32_t)start;
      seen[start] = 1;
      while (depth > 0) {
        const TcCell *cell = &adjacency->cells[stack[--depth]];
        for (int k = 0; k < 4; ++k) {
          const uint32_t next = cell->neighbor[k];
          if ((next & TC_SHELL) || seen[next])
            continue;
          seen[next] = 1;
          stack[depth++] = next;
        }
      }
    }
    status = TETCAST_OK;
  }
  tc_release(context, stack);
  tc_release(context, seen);
  return status;
}

typedef struct Point {
  double p[3];
} Point;

static int compare_points(const void *left, const void *right) {
  const Point *a = left, *b = right;
  for (int k = 0; k < 3; ++k) {
    if (a->p[k] != b->p[k])
      return a->p[k] < b->p[k] ? -1 : 1;
  }
  return 0;
}

static TetcastStatus examine_vertices(TetcastContext *context, const TetcastMesh *mesh, TetcastMeshHealth *health) {
  const int64_t n = mesh->vertices.count;
  unsigned char *used = NULL;
  Point *points = NULL;
  TetcastStatus status = TETCAST_ERROR_MEMORY;
  if (tc_allocate_array(context, (void **)&used, n, 1, "vertices") &&
      tc_allocate_array(context, (void **)&points, n, sizeof *points, "vertices")) {
    memset(used, 0, (size_t)n);
    for (int64_t i = 0; i < mesh->tetrahedra.count; ++i) {
      int64_t v[4];
      if (tc_mesh_hides(mesh, i))
        continue;
      tc_mesh_tetrahedron(mesh, i, v);
      for (int k = 0; k < 4; ++k)
        used[v[k]] = 1;
    }
    size_t count = 0;
    for (int64_t i = 0; i < n; ++i) {
      if (used[i])
        tc_mesh_vertex(mesh, i, points[count++].p);
    }
    health->unused_vertices = n - (int64_t)count;
    qsort(points, count, sizeof *points, compare_points);
    for (size_t i = 1; i < count; ++i)
      health->coincident_vertices += compare_points(&points[i], &points[i - 1]) == 0;
    status = TETCAST_OK;
  }
  tc_release(context, used);
  tc_release(context, points);
  return status;
}

TetcastStatus tc_mesh_health(TetcastContext *context, const TetcastMesh *mesh, TetcastMeshHealth *health) {
  memset(health, 0, sizeof *health);
  TcAdjacency adjacency;
  TetcastStatus status = tc_adjacency_build(mesh, NULL, false, NULL, &adjacency);
  if (status)
    return status;
  health->duplicate_cells = adjacency.duplicates;
  health->nonmanifold_faces = adjacency.nonmanifold;
  const Scaled unit = scaled(mesh);
  for (int64_t i = 0; i < mesh->tetrahedra.count; ++i) {
    int64_t v[4];
    if (tc_mesh_hides(mesh, i))
      continue;
    tc_mesh_tetrahedron(mesh, i, v);
    const double volume = signed_volume(&unit, v);
    health->degenerate_cells += volume == 0;
    health->inverted_cells += volume < 0;
    health->volume += fabs(volume);
  }
  for (int64_t i = 0; i < adjacency.shell_count; ++i)
    health->boundary_area += triangle_area(&unit, adjacency.shell[i].vertex);
  health->volume = ldexp(ldexp(ldexp(health->volume, unit.exponent), unit.exponent), unit.exponent);
  health->boundary_area = ldexp(ldexp(health->boundary_area, unit.exponent), unit.exponent);
  health->boundary_faces = adjacency.boundary;
  status = count_components(context, &adjacency, &health->components);
  tc_adjacency_clear(&adjacency);
  if (!status)
    status = examine_vertices(context, mesh, health);
  return status;
}
