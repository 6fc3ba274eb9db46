/* SPDX-License-Identifier: Apache-2.0 */
#include "kuhn.h"

#include <math.h>
#include <stdlib.h>

static void subtract(const double a[3], const double b[3], double d[3]) {
  for (int k = 0; k < 3; k++) {
    d[k] = a[k] - b[k];
  }
}

static void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Vertices on a regular grid; each small cube is cut into the six tetrahedra that walk from its lowest corner to its
 * highest along one axis after the other, in the six possible orders (Kuhn). Neighbouring cubes' diagonals meet. */
static void make_cells(Kuhn *kuhn, int n) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int64_t step[3] = {1, n + 1, (int64_t)(n + 1) * (n + 1)};
  int64_t vertex = 0, cell = 0;
  for (int k = 0; k <= n; k++) {
    for (int j = 0; j <= n; j++) {
      for (int i = 0; i <= n; i++, vertex++) {
        kuhn->vertices[vertex][0] = (double)i / n;
        kuhn->vertices[vertex][1] = (double)j / n;
        kuhn->vertices[vertex][2] = (double)k / n;
        for (int o = 0; o < 6 && i < n && j < n && k < n; o++, cell++) {
          int64_t corner = vertex;
          for (int v = 0; v < 4; v++) {
            kuhn->cells[cell][v] = corner;
            corner += v < 3 ? step[orders[o][v]] : 0;
          }
        }
      }
    }
  }
}

/* The gradient of a linear hat function is the normal of the face opposite its vertex, divided by six times the cell's
 * volume (times two for the face's area): all that the element matrix needs. */
static void assemble(Kuhn *kuhn, double *row_sum) {
  for (int64_t cell = 0; cell < kuhn->cell_count; cell++) {
    const int64_t *v = kuhn->cells[cell];
    double e1[3], e2[3], e3[3], gradient[4][3];
    subtract(kuhn->vertices[v[1]], kuhn->vertices[v[0]], e1);
    subtract(kuhn->vertices[v[2]], kuhn->vertices[v[0]], e2);
    subtract(kuhn->vertices[v[3]], kuhn->vertices[v[0]], e3);
    cross(e2, e3, gradient[1]);
    cross(e3, e1, gradient[2]);
    cross(e1, e2, gradient[3]);
    double volume6 = dot(e1, gradient[1]), volume = fabs(volume6) / 6;
    for (int k = 0; k < 3; k++) {
      for (int i = 1; i < 4; i++) {
        gradient[i][k] /= volume6;
      }
      gradient[0][k] = -(gradient[1][k] + gradient[2][k] + gradient[3][k]);
    }
    double *entry = kuhn->stiffness[cell];
    for (int i = 0; i < 4; i++) {
      kuhn->mass[v[i]] += volume / 4;
      for (int j = i; j < 4; j++, entry++) {
        *entry = volume * dot(gradient[i], gradient[j]);
        row_sum[v[i]] += fabs(*entry);
        row_sum[v[j]] += i == j ? 0 : fabs(*entry);
      }
    }
  }
}

int kuhn_make(Kuhn *kuhn, int n) {
  int64_t vertices = (int64_t)(n + 1) * (n + 1) * (n + 1), cells = (int64_t)n * n * n * 6;
  *kuhn = (Kuhn){.vertex_count = vertices, .cell_count = cells};
  kuhn->vertices = calloc((size_t)vertices, sizeof *kuhn->vertices);
  kuhn->cells = calloc((size_t)cells, sizeof *kuhn->cells);
  kuhn->mass = calloc((size_t)vertices, sizeof *kuhn->mass);
  kuhn->stiffness = calloc((size_t)cells, sizeof *kuhn->stiffness);
  kuhn->rate = calloc((size_t)vertices, sizeof *kuhn->rate);
  if (!kuhn->vertices || !kuhn->cells || !kuhn->mass || !kuhn->stiffness || !kuhn->rate) {
    return -1;
  }
  make_cells(kuhn, n);
  assemble(kuhn, kuhn->rate); /* for a moment, rate holds the rows' sums of |K| */
  kuhn->largest_step = INFINITY;
  for (int64_t i = 0; i < vertices; i++) { /* Gershgorin: no eigenvalue of M⁻¹K is beyond the largest row sum */
    kuhn->largest_step = fmin(kuhn->largest_step, kuhn->mass[i] / kuhn->rate[i]);
  }
  return 0;
}

void kuhn_free(Kuhn *kuhn) {
  free(kuhn->vertices);
  free(kuhn->cells);
  free(kuhn->mass);
  free(kuhn->stiffness);
  free(kuhn->rate);
}

void kuhn_step(const Kuhn *kuhn, double step, double *u) {
  for (int64_t i = 0; i < kuhn->vertex_count; i++) {
    kuhn->rate[i] = 0;
  }
  for (int64_t cell = 0; cell < kuhn->cell_count; cell++) {
    const int64_t *v = kuhn->cells[cell];
    const double *entry = kuhn->stiffness[cell];
    for (int i = 0; i < 4; i++) {
      for (int j = i; j < 4; j++, entry++) {
        kuhn->rate[v[i]] += *entry * u[v[j]];
        kuhn->rate[v[j]] += i == j ? 0 : *entry * u[v[i]];
      }
    }
  }
  for (int64_t i = 0; i < kuhn->vertex_count; i++) {
    u[i] -= step * kuhn->rate[i] / kuhn->mass[i];
  }
}
