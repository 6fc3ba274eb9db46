/* SPDX-License-Identifier: Apache-2.0 */
/* tetcast_bench_body shell|torus CELLS FILE: fills a surface with about CELLS tetrahedra by TetGen and writes what
 * bench_mesh_load() reads. A program of its own because of TetGen's licence and because of the memory that meshing
 * takes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tetcast/tetgen.h>

#include "mesh.h"

static const double pi = 3.14159265358979323846;

/* A surface under construction, its memory large enough for what comes. */
static void add_vertex(TetcastSurface *surface, double x, double y, double z) {
  double *vertex = surface->vertices + 3 * surface->vertex_count++;
  vertex[0] = 0.5 + x;
  vertex[1] = 0.5 + y;
  vertex[2] = 0.5 + z;
}

static void add_triangle(TetcastSurface *surface, int64_t a, int64_t b, int64_t c) {
  int64_t *triangle = surface->triangles + 3 * surface->triangle_count++;
  triangle[0] = a;
  triangle[1] = b;
  triangle[2] = c;
}

static void add_quad(TetcastSurface *surface, int64_t a, int64_t b, int64_t c, int64_t d) {
  add_triangle(surface, a, b, c);
  add_triangle(surface, a, c, d);
}

/* Where vertex j of quarter q of ring i lies: 4 · min(i, 2n − i) vertices to a ring, one at each pole. */
static int64_t on_sphere(int64_t first, int n, int i, int q, int j) {
  const int64_t m = i <= n ? i : 2 * n - i,
                before = i <= n ? 2 * m * (m - 1) + 1 : (int64_t)4 * n * n + 1 - 2 * m * (m + 1);
  return first + (i == 0 ? 0 : m == 0 ? (int64_t)4 * n * n + 1 : before + (q * m + j) % (4 * m));
}

/* 2n rings of triangles, arranged as on an octahedron and so all about of one size: 8n². */
static void add_sphere(TetcastSurface *surface, double radius, int n) {
  const int64_t first = surface->vertex_count;
  for (int i = 0; i <= 2 * n; i++) {
    const int m = i <= n ? i : 2 * n - i, count = m == 0 ? 1 : 4 * m;
    for (int j = 0; j < count; j++) {
      const double theta = pi * i / (2 * n), phi = 2 * pi * j / count;
      add_vertex(surface, radius * sin(theta) * cos(phi), radius * sin(theta) * sin(phi), radius * cos(theta));
    }
  }
  for (int i = 0; i < n; i++) {
    for (int q = 0; q < 4; q++) {
      for (int j = 0; j <= i; j++) { /* between ring i and the longer ring i + 1; then their mirror images */
        const int mi = 2 * n - i, mo = mi - 1;
        add_triangle(surface, on_sphere(first, n, i, q, j), on_sphere(first, n, i + 1, q, j),
                     on_sphere(first, n, i + 1, q, j + 1));
        add_triangle(surface, on_sphere(first, n, mi, q, j), on_sphere(first, n, mo, q, j + 1),
                     on_sphere(first, n, mo, q, j));
        if (j < i) {
          add_triangle(surface, on_sphere(first, n, i, q, j), on_sphere(first, n, i + 1, q, j + 1),
                       on_sphere(first, n, i, q, j + 1));
          add_triangle(surface, on_sphere(first, n, mi, q, j), on_sphere(first, n, mi, q, j + 1),
                       on_sphere(first, n, mo, q, j + 1));
        }
      }
    }
  }
}

static void add_torus(TetcastSurface *surface, double large, double small, int around, int across) {
  for (int i = 0; i < around; i++) {
    for (int j = 0; j < across; j++) {
      const double phi = 2 * pi * i / around, theta = 2 * pi * j / across, r = large + small * cos(theta);
      add_vertex(surface, r * cos(phi), r * sin(phi), small * sin(theta));
      const int64_t next = (i + 1) % around, up = (j + 1) % across;
      add_quad(surface, (int64_t)i * across + j, next * across + j, next * across + up, (int64_t)i * across + up);
    }
  }
}

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  fprintf(stderr, "tetcast_bench_body: %s\n", text);
}

static bool keep(const TetcastMesh *from, const char *path) {
  BenchMesh mesh;
  const int64_t vertices = tetcast_mesh_vertex_count(from), cells = tetcast_mesh_tetrahedron_count(from);
  if (!bench_mesh_allocate(&mesh, TETCAST_TYPE_FLOAT32, vertices, cells)) {
    return false;
  }
  for (int64_t i = 0; i < vertices; i++) {
    double position[3];
    tetcast_mesh_vertex(from, i, position);
    bench_mesh_set_vertex(&mesh, i, position);
  }
  for (int64_t i = 0; i < cells; i++) {
    int64_t corners[4];
    tetcast_mesh_tetrahedron(from, i, corners);
    for (int k = 0; k < 4; k++) {
      mesh.cells[i][k] = (int32_t)corners[k];
    }
  }
  bench_mesh_set_scalars(&mesh);
  bool ok = bench_mesh_save(&mesh, path);
  bench_mesh_release(&mesh);
  return ok;
}

int main(int argc, char **argv) {
  const double cells = argc == 4 ? atof(argv[2]) : 0;
  const bool shell = argc == 4 && strcmp(argv[1], "shell") == 0;
  if (!(cells >= 100) || (!shell && strcmp(argv[1], "torus") != 0)) {
    fprintf(stderr, "usage: tetcast_bench_body shell|torus CELLS FILE\n");
    return 2;
  }
  const double outer = 0.5, inner = 0.3, large = 0.34, small = 0.15;
  const double volume = shell ? 4 * pi / 3 * (pow(outer, 3) - pow(inner, 3)) : 2 * pi * pi * large * small * small;
  /* Triangles as large as the faces of cells of this size; TetGen makes twice as many cells as that would be. */
  const double mean = volume / (0.5 * cells), edge = cbrt(mean * 6 * sqrt(2.));
  const int rings = (int)(pi / 2 * outer / edge) + 2, inside = (int)(pi / 2 * inner / edge) + 2;
  const int around = (int)(2 * pi * large / edge) + 8, across = (int)(2 * pi * small / edge) + 6;
  const size_t most = shell ? 8 * (size_t)(rings * rings + inside * inside) : 2 * (size_t)around * (size_t)across;
  double hole[3] = {0.5, 0.5, 0.5};
  TetcastSurface surface = {.vertices = calloc(most, 3 * sizeof(double)),
                            .triangles = calloc(most, 3 * sizeof(int64_t)),
                            .hole_count = shell,
                            .holes = hole};
  if (!surface.vertices || !surface.triangles) {
    fprintf(stderr, "tetcast_bench_body: no memory\n");
    return 1;
  }
  if (shell) {
    add_sphere(&surface, outer, rings);
    add_sphere(&surface, inner, inside);
  } else {
    add_torus(&surface, large, small, around, across);
  }
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.message = print_message;
  TetcastTetgenDesc tetgen = tetcast_tetgen_desc_default();
  tetgen.max_volume = 1.9 * mean;
  TetcastContext *context = NULL;
  TetcastMesh *mesh = NULL;
  bool ok = tetcast_context_create(&desc, &context) == TETCAST_OK &&
            tetcast_tetgen_mesh(context, &surface, &tetgen, &mesh) == TETCAST_OK;
  if (ok && !keep(mesh, argv[3])) {
    fprintf(stderr, "tetcast_bench_body: %s can't be written\n", argv[3]);
    ok = false;
  }
  if (ok) {
    fprintf(stderr, "%s: %lld tetrahedra\n", argv[1], (long long)tetcast_mesh_tetrahedron_count(mesh));
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_context_destroy(&context);
  free(surface.vertices);
  free(surface.triangles);
  return ok ? 0 : 1;
}
