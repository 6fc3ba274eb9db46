/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/weld.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A hash table of the cells of a grid, which are four times as wide as the tolerance. Each has a list of the vertices
 * in it that have no earlier one at their place. */
typedef struct Grid {
  const TetcastMesh *mesh;
  double tolerance[3];
  uint64_t mask;
  uint32_t *first; /* [mask + 1]: a vertex's number in the list of candidates, plus one; 0: none */
  uint32_t *next;  /* [count] */
} Grid;

enum { NONE = 0 };

void tc_weld_tolerance(const TetcastMesh *mesh, const double bounds[6], double tolerance[3]) {
  const double unit = mesh->vertices.type == TETCAST_TYPE_FLOAT64 ? DBL_EPSILON : (double)FLT_EPSILON;
  for (int k = 0; k < 3; ++k) {
    const double largest = fmax(fabs(bounds[2 * k]), fabs(bounds[2 * k + 1]));
    int exponent;
    frexp(largest, &exponent); /* below 2^exponent, where units are half of the epsilon times that */
    tolerance[k] = largest > 0 ? ldexp(4 * 0.5 * unit, exponent) : 0;
  }
}

/* The grid's cell at this place along one axis; where all coordinates are 0, there is one. */
static double place_of(double x, double tolerance) {
  return tolerance > 0 ? floor(x / (4 * tolerance)) : 0;
}

static uint64_t hash_of(const Grid *grid, const double at[3]) {
  uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) {
    hash = (hash ^ (uint64_t)(int64_t)at[k]) * UINT64_C(0x9E3779B97F4A7C15);
    hash ^= hash >> 29;
  }
  return hash & grid->mask;
}

static bool is_near(const Grid *grid, uint32_t vertex, const double p[3]) {
  double q[3];
  tc_mesh_vertex(grid->mesh, vertex, q);
  const double *tolerance = grid->tolerance;
  return fabs(p[0] - q[0]) <= tolerance[0] && fabs(p[1] - q[1]) <= tolerance[1] && fabs(p[2] - q[2]) <= tolerance[2];
}

/* The one of the vertices in the grid that lies within the tolerance of p, as its number plus one; the latest, if there
 * are several. */
static uint32_t find(const Grid *grid, const uint32_t *vertices, const double p[3]) {
  double low[3], high[3], at[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = place_of(p[k] - grid->tolerance[k], grid->tolerance[k]);
    high[k] = place_of(p[k] + grid->tolerance[k], grid->tolerance[k]);
  }
  for (int corner = 0; corner < 8; ++corner) {
    bool seen = false; /* with another corner */
    for (int k = 0; k < 3; ++k) {
      at[k] = corner >> k & 1 ? high[k] : low[k];
      seen = seen || (corner >> k & 1 && high[k] == low[k]);
    }
    for (uint32_t i = seen ? NONE : grid->first[hash_of(grid, at)]; i != NONE; i = grid->next[i - 1]) {
      if (is_near(grid, vertices[i - 1], p))
        return i;
    }
  }
  return NONE;
}

static void add(Grid *grid, uint32_t number, const double p[3]) {
  double at[3];
  for (int k = 0; k < 3; ++k)
    at[k] = place_of(p[k], grid->tolerance[k]);
  uint32_t *first = &grid->first[hash_of(grid, at)];
  grid->next[number - 1] = *first;
  *first = number;
}

/* Fills with[i] for those that lie where an earlier one does, NONE for others; how many. */
static int64_t find_all(Grid *grid, const uint32_t *vertices, int64_t count, uint32_t *with) {
  int64_t found = 0;
  for (int64_t i = 0; i < count; ++i) {
    double p[3];
    tc_mesh_vertex(grid->mesh, vertices[i], p);
    with[i] = find(grid, vertices, p);
    if (with[i] == NONE)
      add(grid, (uint32_t)i + 1, p);
    else
      ++found;
  }
  return found;
}

/* Six times the volume of a tetrahedron. Its vertices are so near to each other that their differences are exact, or
 * so far apart that it doesn't matter. */
static double six_volumes(double p[4][3]) {
  double a[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      a[i][k] = p[i + 1][k] - p[0][k];
  }
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* Whether a cell becomes another one if its vertices v take the places of the vertices `to`: its volume is no longer
 * the same but for an eighth. */
static bool is_deformed(const TetcastMesh *mesh, const uint32_t v[4], const uint32_t to[4]) {
  double before[4][3], after[4][3];
  for (int k = 0; k < 4; ++k) {
    tc_mesh_vertex(mesh, v[k], before[k]);
    tc_mesh_vertex(mesh, to[k], after[k]);
  }
  if (memcmp(before, after, sizeof before) == 0)
    return false;
  const double was = six_volumes(before), is = six_volumes(after);
  return !(fabs(is - was) <= 0.125 * fabs(was));
}

/* Marks those with which vertices of one cell would become one, though the cell has two of them, or that would deform a
 * cell. `place`: for each of the mesh's vertices its number among the candidates plus one. */
static void find_thin_cells(const TetcastMesh *mesh, const uint32_t *vertices, const uint32_t *place,
                            const uint32_t *with, uint32_t *thin) {
  for (int64_t i = 0; i < mesh->tetrahedra.count; ++i) {
    uint32_t v[4], own[4], is[4], to[4];
    bool moves = false;
    if (tc_mesh_hides(mesh, i))
      continue;
    tc_mesh_cell(mesh, i, v);
    for (int k = 0; k < 4; ++k) {
      own[k] = place[v[k]];
      is[k] = own[k] != NONE && with[own[k] - 1] != NONE ? with[own[k] - 1] : own[k];
      to[k] = is[k] != own[k] ? vertices[is[k] - 1] : v[k];
      moves = moves || is[k] != own[k];
    }
    if (!moves)
      continue;
    const bool deformed = is_deformed(mesh, v, to);
    for (int k = 0; k < 4; ++k) {
      if (deformed && is[k] != own[k])
        thin[is[k] - 1] = 1;
    }
    for (int k = 1; k < 4; ++k) {
      for (int j = 0; j < k; ++j) {
        if (is[j] != NONE && is[j] == is[k] && own[j] != own[k])
          thin[is[j] - 1] = 1;
      }
    }
  }
}

static TetcastStatus weld(Grid *grid, const uint32_t *vertices, int64_t count, uint32_t *with, TcWeld **welds,
                          int64_t *weld_count) {
  const TetcastMesh *mesh = grid->mesh;
  int64_t found = find_all(grid, vertices, count, with);
  if (found == 0)
    return TETCAST_OK;
  uint32_t *place;
  if (!tc_allocate_array(mesh->context, (void **)&place, mesh->vertices.count, sizeof *place, "vertices at one place"))
    return TETCAST_ERROR_MEMORY;
  memset(place, 0, (size_t)mesh->vertices.count * sizeof *place);
  for (int64_t i = 0; i < count; ++i)
    place[vertices[i]] = (uint32_t)i + 1;
  uint32_t *const thin = grid->next; /* which has done its work */
  memset(thin, 0, (size_t)count * sizeof *thin);
  find_thin_cells(mesh, vertices, place, with, thin);
  tc_release(mesh->context, place);
  for (int64_t i = 0; i < count; ++i) {
    if (with[i] == NONE || !thin[with[i] - 1])
      continue;
    with[i] = NONE;
    --found;
  }
  if (found == 0)
    return TETCAST_OK;
  if (!tc_allocate_array(mesh->context, (void **)welds, found, sizeof **welds, "vertices at one place"))
    return TETCAST_ERROR_MEMORY;
  for (int64_t i = 0; i < count; ++i) {
    if (with[i] != NONE)
      (*welds)[(*weld_count)++] = (TcWeld){vertices[i], vertices[with[i] - 1]};
  }
  return TETCAST_OK;
}

TetcastStatus tc_weld(const TetcastMesh *mesh, const double bounds[6], const uint32_t *vertices, int64_t count,
                      TcWeld **welds, int64_t *weld_count) {
  TetcastContext *context = mesh->context;
  Grid grid = {.mesh = mesh, .mask = 1};
  tc_weld_tolerance(mesh, bounds, grid.tolerance);
  *welds = NULL;
  *weld_count = 0;
  while (grid.mask < 2 * (uint64_t)count)
    grid.mask *= 2;
  uint32_t *with = NULL;
  TetcastStatus status = TETCAST_ERROR_MEMORY;
  if (tc_allocate_array(context, (void **)&grid.first, (int64_t)grid.mask, sizeof *grid.first,
                        "vertices at one place") &&
      tc_allocate_array(context, (void **)&grid.next, count, sizeof *grid.next, "vertices at one place") &&
      tc_allocate_array(context, (void **)&with, count, sizeof *with, "vertices at one place")) {
    memset(grid.first, 0, (size_t)grid.mask * sizeof *grid.first);
    --grid.mask;
    status = weld(&grid, vertices, count, with, welds, weld_count);
  }
  tc_release(context, grid.first);
  tc_release(context, grid.next);
  tc_release(context, with);
  return status;
}
