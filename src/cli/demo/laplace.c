/* SPDX-License-Identifier: Apache-2.0 */
#include "laplace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

typedef struct Face {
  int64_t sorted[3];
  int64_t outward[3]; /* the same vertices, counter-clockwise as seen from outside */
} Face;

/* K u = f: a row of K sums to zero, so that a cell is known by its six entries off the diagonal. */
typedef struct System {
  int64_t vertex_count, cell_count;
  double (*vertices)[3];
  int64_t (*cells)[4];
  double (*entries)[6]; /* of vertex pairs 01 02 03 12 13 23 */
  double *volumes;
  Face *boundary;
  int64_t boundary_count;
  double *diagonal;
  double *source; /* f */
  bool *fixed;    /* u is given */
  double *u;
} System;

static const int pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static void subtract(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[i] - b[i];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Gradients of the four barycentric coordinates; the cell's volume with its sign. */
static double gradients(const System *system, int64_t cell, double g[4][3]) {
  const int64_t *v = system->cells[cell];
  double e[3][3];
  for (int i = 0; i < 3; i++)
    subtract(system->vertices[v[i + 1]], system->vertices[v[0]], e[i]);
  cross(e[1], e[2], g[1]);
  cross(e[2], e[0], g[2]);
  cross(e[0], e[1], g[3]);
  const double six_volumes = dot(e[0], g[1]);
  for (int k = 0; k < 3; k++) {
    for (int i = 1; i < 4; i++)
      g[i][k] = six_volumes != 0 ? g[i][k] / six_volumes : 0;
    g[0][k] = -(g[1][k] + g[2][k] + g[3][k]);
  }
  return six_volumes / 6;
}

static void assemble(System *system) {
  for (int64_t i = 0; i < system->cell_count; i++) {
    double g[4][3];
    const double volume = fabs(gradients(system, i, g));
    const int64_t *v = system->cells[i];
    system->volumes[i] = volume;
    for (int p = 0; p < 6; p++)
      system->entries[i][p] = volume * dot(g[pairs[p][0]], g[pairs[p][1]]);
    for (int j = 0; j < 4; j++)
      system->diagonal[v[j]] += volume * dot(g[j], g[j]);
  }
}

static int compare_faces(const void *a, const void *b) {
  const int64_t *s = ((const Face *)a)->sorted, *t = ((const Face *)b)->sorted;
  for (int i = 0; i < 3; i++)
    if (s[i] != t[i])
      return s[i] < t[i] ? -1 : 1;
  return 0;
}

/* The faces that one cell alone has. */
static void find_boundary(System *system) {
  static const int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const int64_t count = 4 * system->cell_count;
  Face *faces = cli_allocate(sizeof *faces * (size_t)count);
  for (int64_t i = 0; i < count; i++) {
    double g[4][3];
    const int64_t *v = system->cells[i / 4];
    const bool inverted = gradients(system, i / 4, g) < 0;
    for (int j = 0; j < 3; j++)
      faces[i].outward[inverted ? 2 - j : j] = faces[i].sorted[j] = v[corners[i % 4][j]];
    int64_t *s = faces[i].sorted;
    for (int j = 0; j < 3; j++) { /* three numbers in order after 01, 12, 01 */
      const int k = j % 2;
      const int64_t low = s[k] < s[k + 1] ? s[k] : s[k + 1], high = s[k] < s[k + 1] ? s[k + 1] : s[k];
      s[k] = low;
      s[k + 1] = high;
    }
  }
  qsort(faces, (size_t)count, sizeof *faces, compare_faces);
  for (int64_t i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && compare_faces(&faces[i], &faces[next]) == 0; next++) {}
    if (next - i == 1)
      faces[system->boundary_count++] = faces[i];
  }
  system->boundary = faces;
}

static int64_t find_root(int64_t *parents, int64_t i) {
  while (parents[i] != i)
    i = parents[i] = parents[parents[i]];
  return i;
}

/* Fixes u = 0 on all surfaces and 1 on those of cavities, which are the connected parts of the boundary that enclose a
 * negative volume. Returns whether there are any. */
static bool fix_surfaces(System *system) {
  int64_t *parents = cli_allocate(sizeof *parents * (size_t)system->vertex_count);
  double *volumes = cli_allocate(sizeof *volumes * (size_t)system->vertex_count);
  for (int64_t i = 0; i < system->vertex_count; i++) {
    parents[i] = i;
    volumes[i] = 0;
  }
  for (int64_t i = 0; i < system->boundary_count; i++)
    for (int j = 1; j < 3; j++)
      parents[find_root(parents, system->boundary[i].sorted[0])] = find_root(parents, system->boundary[i].sorted[j]);
  for (int64_t i = 0; i < system->boundary_count; i++) {
    double x[3][3], normal[3];
    for (int j = 0; j < 3; j++)
      subtract(system->vertices[system->boundary[i].outward[j]], system->vertices[system->boundary[0].outward[0]],
               x[j]);
    cross(x[0], x[1], normal);
    volumes[find_root(parents, system->boundary[i].sorted[0])] += dot(normal, x[2]);
  }
  bool cavities = false;
  for (int64_t i = 0; i < 3 * system->boundary_count; i++) {
    const int64_t vertex = system->boundary[i / 3].sorted[i % 3];
    const bool cavity = volumes[find_root(parents, vertex)] < 0;
    system->fixed[vertex] = true;
    system->u[vertex] = cavity ? 1 : 0;
    cavities = cavities || cavity;
  }
  free(parents);
  free(volumes);
  return cavities;
}

/* Fixes u = x where the body begins and ends along x. */
static void fix_ends(System *system, const double bounds[6]) {
  const double tolerance = 1e-9 * (bounds[1] - bounds[0]);
  for (int64_t i = 0; i < system->vertex_count; i++) {
    const double x = system->vertices[i][0];
    system->fixed[i] = x <= bounds[0] + tolerance || x >= bounds[1] - tolerance;
    system->u[i] = x;
  }
}

/* y = K x on vertices that are free, 0 on others */
static void multiply(const System *system, const double *x, double *y) {
  memset(y, 0, sizeof *y * (size_t)system->vertex_count);
  for (int64_t i = 0; i < system->cell_count; i++) {
    const int64_t *v = system->cells[i];
    for (int p = 0; p < 6; p++) {
      const int64_t a = v[pairs[p][0]], b = v[pairs[p][1]];
      const double flux = system->entries[i][p] * (x[b] - x[a]);
      y[a] += flux;
      y[b] -= flux;
    }
  }
  for (int64_t i = 0; i < system->vertex_count; i++)
    if (system->fixed[i])
      y[i] = 0;
}

/* Conjugate gradients with the diagonal as preconditioner, from the u there is. */
static TetcastStatus solve(TetcastContext *context, System *system) {
  enum { MOST = 20000 };
  const int64_t n = system->vertex_count;
  double *r = cli_allocate(sizeof *r * 3 * (size_t)n), *p = r + n, *kp = p + n;
  multiply(system, system->u, kp);
  double rz = 0;
  for (int64_t i = 0; i < n; i++) {
    r[i] = system->fixed[i] ? 0 : system->source[i] - kp[i];
    p[i] = system->diagonal[i] > 0 ? r[i] / system->diagonal[i] : 0;
    rz += r[i] * p[i];
  }
  const double goal = 1e-20 * rz;
  int step = 0;
  for (; rz > goal && step < MOST; step++) {
    multiply(system, p, kp);
    double pkp = 0, next = 0;
    for (int64_t i = 0; i < n; i++)
      pkp += p[i] * kp[i];
    const double along = rz / pkp;
    for (int64_t i = 0; i < n; i++) {
      system->u[i] += along * p[i];
      r[i] -= along * kp[i];
      next += system->diagonal[i] > 0 ? r[i] * r[i] / system->diagonal[i] : 0;
    }
    for (int64_t i = 0; i < n; i++)
      p[i] = (system->diagonal[i] > 0 ? r[i] / system->diagonal[i] : 0) + next / rz * p[i];
    rz = next;
  }
  free(r);
  return rz <= goal
             ? TETCAST_OK
             : tetcast_context_error(context, TETCAST_ERROR_DATA, "the field did not converge in %d steps", (int)MOST);
}

/* |∇u| at the vertices, from the gradients of the cells around each, weighted by volume */
static void speeds(const System *system, double *values) {
  double(*sums)[4] = cli_allocate(sizeof *sums * (size_t)system->vertex_count);
  memset(sums, 0, sizeof *sums * (size_t)system->vertex_count);
  for (int64_t i = 0; i < system->cell_count; i++) {
    double g[4][3];
    gradients(system, i, g);
    const int64_t *v = system->cells[i];
    for (int j = 0; j < 4; j++) {
      for (int k = 0; k < 3; k++)
        for (int corner = 0; corner < 4; corner++)
          sums[v[j]][k] += system->volumes[i] * system->u[v[corner]] * g[corner][k];
      sums[v[j]][3] += system->volumes[i];
    }
  }
  for (int64_t i = 0; i < system->vertex_count; i++)
    values[i] = sums[i][3] > 0 ? sqrt(dot(sums[i], sums[i])) / sums[i][3] : 0;
  free(sums);
}

static System create(const TetcastMesh *mesh) {
  System system = {.vertex_count = tetcast_mesh_vertex_count(mesh), .cell_count = tetcast_mesh_tetrahedron_count(mesh)};
  const size_t n = (size_t)system.vertex_count, m = (size_t)system.cell_count;
  system.vertices = cli_allocate(n * sizeof *system.vertices);
  system.cells = cli_allocate(m * sizeof *system.cells);
  system.entries = cli_allocate(m * sizeof *system.entries);
  system.volumes = cli_allocate(m * sizeof *system.volumes);
  system.diagonal = cli_allocate(n * sizeof *system.diagonal);
  system.source = cli_allocate(n * sizeof *system.source);
  system.fixed = cli_allocate(n * sizeof *system.fixed);
  system.u = cli_allocate(n * sizeof *system.u);
  for (size_t i = 0; i < n; i++) {
    tetcast_mesh_vertex(mesh, (int64_t)i, system.vertices[i]);
    system.diagonal[i] = system.source[i] = system.u[i] = 0;
    system.fixed[i] = false;
  }
  for (size_t i = 0; i < m; i++)
    tetcast_mesh_tetrahedron(mesh, (int64_t)i, system.cells[i]);
  return system;
}

TetcastStatus laplace_solve(TetcastContext *context, const TetcastMesh *mesh, LaplaceProblem problem, double *values) {
  double bounds[6];
  tetcast_mesh_bounds(mesh, bounds);
  System system = create(mesh);
  assemble(&system);
  find_boundary(&system);
  TetcastStatus status = TETCAST_OK;
  if (problem == LAPLACE_FLOW)
    fix_ends(&system, bounds);
  else if (!fix_surfaces(&system) && problem == LAPLACE_HEAT)
    status = tetcast_context_error(context, TETCAST_ERROR_DATA, "heat comes from cavities, and the body has none");
  if (problem == LAPLACE_GLOW)
    for (int64_t i = 0; i < 4 * system.cell_count; i++) {
      system.source[system.cells[i / 4][i % 4]] += system.volumes[i / 4] / 4;
      system.u[system.cells[i / 4][i % 4]] = 0;
    }
  if (status == TETCAST_OK)
    status = solve(context, &system);
  if (problem == LAPLACE_FLOW)
    speeds(&system, values);
  else
    memcpy(values, system.u, sizeof *values * (size_t)system.vertex_count);
  double peak = 0;
  for (int64_t i = 0; i < system.vertex_count; i++)
    peak = fmax(peak, values[i]);
  for (int64_t i = 0; i < system.vertex_count && problem == LAPLACE_GLOW && peak > 0; i++)
    values[i] /= peak;
  void *const arrays[] = {system.vertices, system.cells,  system.entries, system.volumes, system.boundary,
                          system.diagonal, system.source, system.fixed,   system.u};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    free(arrays[i]);
  return status;
}
