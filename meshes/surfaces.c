/* SPDX-License-Identifier: Apache-2.0 */
/* Writes the surfaces that the datasets of this folder are made from, as .smesh files into the folder given. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { MOST_POINTS = 200000, MOST_FACETS = 400000, MOST_HOLES = 16 };

/* Facets of three or four corners. */
static double points[MOST_POINTS][3];
static int facets[MOST_FACETS][4];
static double holes[MOST_HOLES][3];
static int point_count, facet_count, hole_count;

static void start(void) {
  point_count = facet_count = hole_count = 0;
}

static int add_point(double x, double y, double z) {
  if (point_count == MOST_POINTS)
    exit(1);
  points[point_count][0] = x;
  points[point_count][1] = y;
  points[point_count][2] = z;
  return point_count++;
}

/* d < 0: a triangle */
static void add_facet(int a, int b, int c, int d) {
  if (facet_count == MOST_FACETS)
    exit(1);
  const int facet[4] = {a, b, c, d};
  memcpy(facets[facet_count++], facet, sizeof facet);
}

static void add_hole(double x, double y, double z) {
  const double hole[3] = {x, y, z};
  memcpy(holes[hole_count++], hole, sizeof hole);
}

static void write_smesh(const char *folder, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  if (!file) {
    perror(path);
    exit(1);
  }
  fprintf(file, "%d 3 0 0\n", point_count);
  for (int i = 0; i < point_count; i++)
    fprintf(file, "%d %.9g %.9g %.9g\n", i, points[i][0], points[i][1], points[i][2]);
  fprintf(file, "%d 0\n", facet_count);
  for (int i = 0; i < facet_count; i++) {
    const int *f = facets[i];
    if (f[3] < 0)
      fprintf(file, "3 %d %d %d\n", f[0], f[1], f[2]);
    else
      fprintf(file, "4 %d %d %d %d\n", f[0], f[1], f[2], f[3]);
  }
  fprintf(file, "%d\n", hole_count);
  for (int i = 0; i < hole_count; i++)
    fprintf(file, "%d %.9g %.9g %.9g\n", i, holes[i][0], holes[i][1], holes[i][2]);
  if (fclose(file) != 0) {
    perror(path);
    exit(1);
  }
}

/* An octahedron whose faces are cut into n² triangles each, on a sphere. */
static void add_sphere(const double center[3], double radius, int n) {
  static int index[2][512][512]; /* of points of the two halves; those of the equator are shared */
  for (int side = 0; side < 2; side++)
    for (int i = -n; i <= n; i++)
      for (int j = -n + abs(i); j <= n - abs(i); j++) {
        const int k = n - abs(i) - abs(j);
        /* equal angles rather than equal lengths, or triangles near the corners would be half as large */
        const double x = sin(pi / 2 * i / n), y = sin(pi / 2 * j / n), z = sin(pi / 2 * k / n) * (side ? -1 : 1);
        const double scale = radius / sqrt(x * x + y * y + z * z);
        index[side][i + n][j + n] =
            side && k == 0 ? index[0][i + n][j + n]
                           : add_point(center[0] + scale * x, center[1] + scale * y, center[2] + scale * z);
      }
  for (int side = 0; side < 2; side++)
    for (int sx = -1; sx <= 1; sx += 2)
      for (int sy = -1; sy <= 1; sy += 2)
        for (int i = 0; i < n; i++)
          for (int j = 0; j + i < n; j++) {
#define AT(di, dj) index[side][n + sx * (i + (di))][n + sy * (j + (dj))]
            add_facet(AT(0, 0), AT(1, 0), AT(0, 1), -1);
            if (i + j + 1 < n)
              add_facet(AT(1, 0), AT(1, 1), AT(0, 1), -1);
#undef AT
          }
}

typedef struct Tube {
  int p, q;             /* it winds p times around the z axis, and q times around … */
  double ring, winding; /* … the circle of radius `ring` about that axis, at distance `winding` from it */
  double thickness;     /* its own radius */
  int n, m;             /* pairs of triangles along and around it */
} Tube;

/* With p = 2, q = 3: a trefoil knot. */
static void add_tube(Tube tube) {
  const int first = point_count;
  for (int i = 0; i < tube.n; i++) {
    const double u = 2 * pi * tube.p * i / tube.n, v = 2 * pi * tube.q * i / tube.n;
    const double r = tube.ring + tube.winding * cos(v);
    /* normal of the torus that the curve lies on, tangent of the curve, and what is perpendicular to both */
    const double normal[3] = {cos(v) * cos(u), cos(v) * sin(u), sin(v)};
    const double du = r * tube.p, dv = tube.winding * tube.q;
    const double t[3] = {-du * sin(u) - dv * sin(v) * cos(u), du * cos(u) - dv * sin(v) * sin(u), dv * cos(v)};
    const double length = sqrt(du * du + dv * dv);
    const double side[3] = {(t[1] * normal[2] - t[2] * normal[1]) / length,
                            (t[2] * normal[0] - t[0] * normal[2]) / length,
                            (t[0] * normal[1] - t[1] * normal[0]) / length};
    for (int j = 0; j < tube.m; j++) {
      const double w = 2 * pi * j / tube.m;
      double x[3] = {r * cos(u), r * sin(u), tube.winding * sin(v)};
      for (int k = 0; k < 3; k++)
        x[k] += tube.thickness * (cos(w) * normal[k] + sin(w) * side[k]);
      add_point(x[0], x[1], x[2]);
    }
  }
  for (int i = 0; i < tube.n; i++)
    for (int j = 0; j < tube.m; j++) {
      const int a = first + i * tube.m + j, b = first + (i + 1) % tube.n * tube.m + j;
      const int c = first + (i + 1) % tube.n * tube.m + (j + 1) % tube.m, d = first + i * tube.m + (j + 1) % tube.m;
      add_facet(a, b, c, -1);
      add_facet(a, c, d, -1);
    }
}

static void add_box(double x, double y, double z) {
  const int first = point_count;
  for (int i = 0; i < 8; i++)
    add_point(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
  static const int sides[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  for (int i = 0; i < 6; i++)
    add_facet(first + sides[i][0], first + sides[i][1], first + sides[i][2], first + sides[i][3]);
}

static void add_cavity(double x, double y, double z, double radius, int n) {
  const double center[3] = {x, y, z};
  add_sphere(center, radius, n);
  add_hole(x, y, z);
}

static const double origin[3] = {0, 0, 0};

static void ball(const char *folder) {
  start();
  add_sphere(origin, 36, 22);
  write_smesh(folder, "ball.smesh");
}

/* a cold box around seven hot balls */
static void box(const char *folder) {
  start();
  add_box(1.5, 1, 1);
  add_cavity(0, 0, 0, 0.32, 10);
  add_cavity(0.85, 0.35, 0.2, 0.2, 7);
  add_cavity(-0.85, -0.3, -0.3, 0.24, 8);
  add_cavity(0.45, -0.55, -0.45, 0.16, 6);
  add_cavity(-0.45, 0.5, 0.5, 0.18, 6);
  add_cavity(-1.15, 0.5, -0.1, 0.12, 5);
  add_cavity(1.1, -0.5, 0.4, 0.14, 5);
  write_smesh(folder, "box.smesh");
}

static void trefoil(const char *folder) {
  start();
  add_tube((Tube){.p = 2, .q = 3, .ring = 2, .winding = 0.9, .thickness = 0.48, .n = 240, .m = 20});
  write_smesh(folder, "trefoil.smesh");
}

static void shell(const char *folder) {
  start();
  add_sphere(origin, 1, 18);
  add_sphere(origin, 0.55, 10);
  add_hole(0, 0, 0);
  write_smesh(folder, "shell.smesh");
}

int main(int argc, char **argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  ball(argv[1]);
  box(argv[1]);
  trefoil(argv[1]);
  shell(argv[1]);
  return 0;
}
