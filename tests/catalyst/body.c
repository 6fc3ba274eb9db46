/* SPDX-License-Identifier: Apache-2.0 */
#include "body.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int sides[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
/* Kuhn's six, which neighbouring cubes cut alike. */
static const int tets[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
static const int wedges[2][6] = {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};

static int64_t point_of(const Body *b, int i, int j, int k) {
  return i + (b->n[0] + 1) * (j + (int64_t)(b->n[1] + 1) * k);
}

static void add_cell(Body *b, int type, int count, const int64_t *nodes) {
  b->types[b->cells] = (uint8_t)type;
  const int64_t at = b->offsets[b->cells++];
  memcpy(b->nodes + at, nodes, sizeof *nodes * (size_t)count);
  b->offsets[b->cells] = at + count;
}

/* Faces of neighbours are one: that towards lower numbers is of the cell whose point is the first. */
static void add_polyhedron(Body *b, int64_t *known, const int cube[3], const int64_t at[8]) {
  int64_t *own = b->cell_faces + 6 * b->cells, unique[8];
  int count = 0;
  for (int s = 0; s < 6; s++) {
    const int axis = s / 2;
    int place[3] = {cube[0], cube[1], cube[2]};
    place[axis] += s % 2;
    int64_t *face = &known[3 * point_of(b, place[0], place[1], place[2]) + axis];
    if (*face < 0) {
      *face = b->faces;
      for (int c = 0; c < 4; c++)
        b->face_nodes[4 * b->faces + c] = at[sides[s][c]];
      b->faces++;
    }
    own[s] = *face;
    for (int c = 0; c < 4; c++) {
      bool found = false;
      for (int i = 0; i < count; i++)
        found = found || unique[i] == b->face_nodes[4 * *face + c];
      if (!found)
        unique[count++] = b->face_nodes[4 * *face + c];
    }
  }
  add_cell(b, 42, 8, unique);
}

static void fill_cube(Body *b, int64_t *known, const int cube[3]) {
  const int64_t number = cube[0] + cube[1] + cube[2];
  int64_t at[8], cell[8];
  for (int c = 0; c < 8; c++)
    at[c] = point_of(b, cube[0] + corners[c][0], cube[1] + corners[c][1], cube[2] + corners[c][2]);
  BodyKind kind = b->kind;
  if (kind == BODY_MIXED)
    kind = number % 4 == 0 ? BODY_HEX : number % 4 == 1 ? BODY_POLYHEDRA : number % 4 == 2 ? BODY_TET : BODY_WEDGE;
  if (kind == BODY_HEX)
    add_cell(b, 12, 8, at);
  for (int i = 0; kind == BODY_TET && i < 6; i++) {
    for (int c = 0; c < 4; c++)
      cell[c] = at[tets[i][c]];
    add_cell(b, 10, 4, cell);
  }
  for (int i = 0; kind == BODY_WEDGE && i < 2; i++) {
    for (int c = 0; c < 6; c++)
      cell[c] = at[wedges[i][c]];
    add_cell(b, 13, 6, cell);
  }
  for (int i = 0; kind == BODY_PYRAMID && i < 6; i++) {
    for (int c = 0; c < 4; c++)
      cell[c] = at[sides[i][c]];
    cell[4] = b->points - 1 - (cube[0] + b->n[0] * (cube[1] + (int64_t)b->n[1] * cube[2]));
    for (int k = 0; k < 3; k++) {
      b->x[3 * cell[4] + k] = 0;
      for (int c = 0; c < 8; c++)
        b->x[3 * cell[4] + k] += b->x[3 * at[c] + k] / 8;
    }
    add_cell(b, 14, 5, cell);
  }
  if (kind == BODY_POLYHEDRA)
    add_polyhedron(b, known, cube, at);
  if (b->kind == BODY_MIXED && number % 4 == 3) { /* a triangle, which is not drawn */
    cell[0] = at[0], cell[1] = at[1], cell[2] = at[2];
    add_cell(b, 5, 3, cell);
  }
}

Body *body_create(BodyKind kind, const int n[3], const double origin[3], double phase) {
  Body *b = calloc(1, sizeof *b);
  const int64_t cubes = (int64_t)n[0] * n[1] * n[2], most = 7 * cubes;
  b->kind = kind;
  memcpy(b->n, n, sizeof b->n);
  b->points = (int64_t)(n[0] + 1) * (n[1] + 1) * (n[2] + 1);
  const int64_t lattice = b->points;
  b->points += kind == BODY_PYRAMID ? cubes : 0;
  b->x = malloc(sizeof *b->x * (size_t)(3 * b->points));
  b->types = malloc((size_t)most);
  b->offsets = calloc((size_t)most + 1, sizeof *b->offsets);
  b->nodes = malloc(sizeof *b->nodes * (size_t)(8 * most));
  b->cell_faces = calloc((size_t)(6 * most), sizeof *b->cell_faces);
  b->face_nodes = malloc(sizeof *b->face_nodes * (size_t)(24 * cubes));
  int64_t *known = malloc(sizeof *known * (size_t)(3 * lattice));
  memset(known, -1, sizeof *known * (size_t)(3 * lattice));
  for (int k = 0; k <= n[2]; k++)
    for (int j = 0; j <= n[1]; j++)
      for (int i = 0; i <= n[0]; i++) {
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; a++)
          b->x[3 * point_of(b, i, j, k) + a] = origin[a] + at[a];
      }
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++)
        fill_cube(b, known, (const int[3]){i, j, k});
  free(known);
  b->t = malloc(sizeof *b->t * (size_t)b->points);
  b->v = malloc(sizeof *b->v * (size_t)(3 * b->points));
  b->c = malloc(sizeof *b->c * (size_t)b->cells);
  b->m = malloc(sizeof *b->m * (size_t)b->cells);
  for (int64_t i = 0; i < b->points; i++) {
    const double *p = b->x + 3 * i;
    b->t[i] = sin(0.9 * p[0] + phase) * cos(0.7 * p[1]) + 0.2 * p[2];
    for (int a = 0; a < 3; a++)
      b->v[3 * i + a] = cos(p[a] + phase) + 0.1 * a;
  }
  for (int64_t i = 0; i < b->cells; i++) {
    const double *p = b->x + 3 * b->nodes[b->offsets[i]];
    b->c[i] = cos(p[0] + 0.5 * p[1] + phase) + 0.01 * (double)(i % 7);
    b->m[i] = (int32_t)(3 + (int64_t)(p[0] - origin[0]) % 3);
  }
  return b;
}

void body_destroy(Body *b) {
  free(b->x);
  free(b->types);
  free(b->offsets);
  free(b->nodes);
  free(b->cell_faces);
  free(b->face_nodes);
  free(b->t);
  free(b->v);
  free(b->c);
  free(b->m);
  free(b->ghost_cells);
  free(b->ghost_points);
  free(b);
}

/* ── a file ── */

static void put_array(FILE *f, const char *type, const char *name, int components) {
  fprintf(f, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", type, name,
          components);
}

static void put_reals(FILE *f, const char *type, const char *name, int components, const double *values,
                      int64_t count) {
  put_array(f, type, name, components);
  for (int64_t i = 0; i < count * components; i++)
    fprintf(f, "%.17g\n", values[i]);
  fputs("</DataArray>\n", f);
}

static void put_bytes(FILE *f, const char *name, const uint8_t *values, int64_t count) {
  put_array(f, "UInt8", name, 1);
  for (int64_t i = 0; i < count; i++)
    fprintf(f, "%d\n", values[i]);
  fputs("</DataArray>\n", f);
}

static void put_faces(FILE *f, const Body *b) {
  int64_t end = 0;
  put_array(f, "Int64", "faces", 1);
  for (int64_t i = 0; i < b->cells; i++) {
    if (b->types[i] != 42)
      continue;
    fputs("6\n", f);
    for (int s = 0; s < 6; s++) {
      const int64_t *face = b->face_nodes + 4 * b->cell_faces[6 * i + s];
      fprintf(f, "4 %lld %lld %lld %lld\n", (long long)face[0], (long long)face[1], (long long)face[2],
              (long long)face[3]);
    }
  }
  fputs("</DataArray>\n", f);
  put_array(f, "Int64", "faceoffsets", 1);
  for (int64_t i = 0; i < b->cells; i++) {
    end += b->types[i] == 42 ? 31 : 0;
    fprintf(f, "%lld\n", b->types[i] == 42 ? (long long)end : -1LL);
  }
  fputs("</DataArray>\n", f);
}

void body_write(const Body *b, const char *path) {
  FILE *f = fopen(path, "w");
  fprintf(f,
          "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
          "<Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\"><PointData>\n",
          (long long)b->points, (long long)b->cells);
  put_reals(f, "Float64", "T", 1, b->t, b->points);
  put_reals(f, "Float64", "V", 3, b->v, b->points);
  if (b->ghost_points)
    put_bytes(f, "vtkGhostType", b->ghost_points, b->points);
  fputs("</PointData><CellData>\n", f);
  put_reals(f, "Float64", "C", 1, b->c, b->cells);
  put_array(f, "Int32", "M", 1);
  for (int64_t i = 0; i < b->cells; i++)
    fprintf(f, "%d\n", b->m[i]);
  fputs("</DataArray>\n", f);
  if (b->ghost_cells)
    put_bytes(f, "vtkGhostType", b->ghost_cells, b->cells);
  fputs("</CellData><Points>\n", f);
  put_reals(f, b->single ? "Float32" : "Float64", "Points", 3, b->x, b->points);
  fputs("</Points><Cells>\n", f);
  put_array(f, "Int64", "connectivity", 1);
  for (int64_t i = 0; i < b->offsets[b->cells]; i++)
    fprintf(f, "%lld\n", (long long)b->nodes[i]);
  fputs("</DataArray>\n", f);
  put_array(f, "Int64", "offsets", 1);
  for (int64_t i = 0; i < b->cells; i++)
    fprintf(f, "%lld\n", (long long)b->offsets[i + 1]);
  fputs("</DataArray>\n", f);
  put_bytes(f, "types", b->types, b->cells);
  if (b->faces > 0)
    put_faces(f, b);
  fputs("</Cells></Piece></UnstructuredGrid></VTKFile>\n", f);
  fclose(f);
}

/* ── a simulation's memory ── */

static void *kept[4096];
static int kept_count;

void *body_keep(int64_t count, int64_t size) {
  if (kept_count == 4096)
    abort();
  return kept[kept_count++] = calloc((size_t)count + 1, (size_t)size);
}

void body_forget(void) {
  while (kept_count > 0)
    free(kept[--kept_count]);
}

static void put_index(char *at, StandinType type, int64_t value) {
  const int32_t narrow = (int32_t)value;
  const int16_t small = (int16_t)value;
  if (type == STANDIN_INT64 || type == STANDIN_UINT64)
    memcpy(at, &value, sizeof value);
  else if (type == STANDIN_INT16 || type == STANDIN_UINT16)
    memcpy(at, &small, sizeof small);
  else
    memcpy(at, &narrow, sizeof narrow);
}

static void set_indices(conduit_node *node, const char *path, const BodyView *view, const int64_t *values,
                        int64_t count) {
  const StandinType type = view->index ? view->index : STANDIN_INT32;
  const int64_t stride = view->spread ? 16 : standin_size(type);
  char *data = body_keep(count, stride);
  for (int64_t i = 0; i < count; i++)
    put_index(data + i * stride, type, values[i]);
  standin_set(node, path, type, data, count, stride);
}

static void set_coordinates(const Body *b, BodyLayout layout, conduit_node *mesh) {
  static const char *const paths[3] = {"coordsets/coords/values/x", "coordsets/coords/values/y",
                                       "coordsets/coords/values/z"};
  const StandinType type = b->single ? STANDIN_FLOAT32 : STANDIN_FLOAT64;
  const int64_t size = standin_size(type);
  const int64_t stride = layout == LAYOUT_APART ? size : layout == LAYOUT_INTERLEAVED ? 3 * size : 5 * size;
  const int64_t apart = layout == LAYOUT_APART ? size * b->points : size;
  char *data = body_keep(5 * b->points, size);
  for (int64_t i = 0; i < b->points; i++)
    for (int k = 0; k < 3; k++) {
      const float single = (float)b->x[3 * i + k];
      memcpy(data + i * stride + k * apart, b->single ? (const void *)&single : &b->x[3 * i + k], (size_t)size);
    }
  conduit_node_set_path_char8_str(mesh, "coordsets/coords/type", "explicit");
  for (int k = 0; k < 3; k++)
    standin_set(mesh, paths[k], type, data + k * apart, b->points, stride);
}

void body_describe_fields(const Body *b, conduit_node *mesh) {
  static const char *const components[3] = {"fields/V/values/x", "fields/V/values/y", "fields/V/values/z"};
  static const char *const names[4] = {"T", "V", "C", "M"};
  for (int i = 0; i < 4; i++) {
    char path[64];
    snprintf(path, sizeof path, "fields/%s/association", names[i]);
    conduit_node_set_path_char8_str(mesh, path, i < 2 ? "vertex" : "element");
    snprintf(path, sizeof path, "fields/%s/topology", names[i]);
    conduit_node_set_path_char8_str(mesh, path, "mesh");
  }
  conduit_node_set_path_external_float64_ptr(mesh, "fields/T/values", b->t, b->points);
  for (int k = 0; k < 3; k++)
    standin_set(mesh, components[k], STANDIN_FLOAT64, b->v + k, b->points, 24);
  conduit_node_set_path_external_float64_ptr(mesh, "fields/C/values", b->c, b->cells);
  conduit_node_set_path_external_int32_ptr(mesh, "fields/M/values", b->m, b->cells);
}

static void describe_polyhedra(const Body *b, const BodyView *view, conduit_node *mesh) {
  int64_t *offsets = body_keep(b->faces, sizeof *offsets), *sizes = body_keep(b->faces, sizeof *sizes);
  for (int64_t i = 0; i < b->faces; i++) {
    offsets[i] = 4 * i;
    sizes[i] = 4;
  }
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/subelements/shape", "polygonal");
  set_indices(mesh, "topologies/mesh/subelements/connectivity", view, b->face_nodes, 4 * b->faces);
  set_indices(mesh, "topologies/mesh/subelements/sizes", view, sizes, b->faces);
  if (!view->no_offsets)
    set_indices(mesh, "topologies/mesh/subelements/offsets", view, offsets, b->faces);
}

void body_describe(const Body *b, const BodyView *view, conduit_node *mesh) {
  static const char *const shapes[] = {"tet", "hex", "wedge", "pyramid", "mixed", "polyhedral"};
  static const char *const names[] = {"tet", "hex", "wedge", "polyhedral", "tri"};
  static const int64_t numbers[] = {10, 12, 13, 42, 5};
  const BodyView plain = {.layout = LAYOUT_APART};
  view = view ? view : &plain;
  set_coordinates(b, view->layout, mesh);
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/type", "unstructured");
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/coordset", "coords");
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/elements/shape", shapes[b->kind]);
  body_describe_fields(b, mesh);
  if (b->kind < BODY_MIXED) {
    set_indices(mesh, "topologies/mesh/elements/connectivity", view, b->nodes, b->offsets[b->cells]);
    return;
  }
  int64_t *entries = body_keep(8 * b->cells, sizeof *entries), *sizes = body_keep(b->cells, sizeof *sizes),
          *offsets = body_keep(b->cells, sizeof *offsets), *types = body_keep(b->cells, sizeof *types), end = 0;
  for (int64_t i = 0; i < b->cells; i++) {
    const bool polyhedron = b->types[i] == 42;
    offsets[i] = end;
    sizes[i] = polyhedron ? 6 : b->offsets[i + 1] - b->offsets[i];
    memcpy(entries + end, polyhedron ? b->cell_faces + 6 * i : b->nodes + b->offsets[i],
           sizeof *entries * (size_t)sizes[i]);
    end += sizes[i];
    types[i] = b->types[i];
  }
  set_indices(mesh, "topologies/mesh/elements/connectivity", view, entries, end);
  set_indices(mesh, "topologies/mesh/elements/sizes", view, sizes, b->cells);
  if (!view->no_offsets)
    set_indices(mesh, "topologies/mesh/elements/offsets", view, offsets, b->cells);
  for (int i = 0; i < 5 && b->kind == BODY_MIXED; i++) {
    char path[64];
    snprintf(path, sizeof path, "topologies/mesh/elements/shape_map/%s", names[i]);
    conduit_node_set_path_int64(mesh, path, numbers[i]);
  }
  if (b->kind == BODY_MIXED)
    set_indices(mesh, "topologies/mesh/elements/shapes", view, types, b->cells);
  describe_polyhedra(b, view, mesh);
}

void body_describe_grid(const Body *b, const char *type, conduit_node *mesh) {
  static const char *const dims[3] = {"coordsets/coords/dims/i", "coordsets/coords/dims/j", "coordsets/coords/dims/k"},
                           *const origin[3] = {"coordsets/coords/origin/x", "coordsets/coords/origin/y",
                                               "coordsets/coords/origin/z"},
                           *const axes[3] = {"coordsets/coords/values/x", "coordsets/coords/values/y",
                                             "coordsets/coords/values/z"},
                           *const elements[3] = {"topologies/mesh/elements/dims/i", "topologies/mesh/elements/dims/j",
                                                 "topologies/mesh/elements/dims/k"};
  body_describe_fields(b, mesh);
  if (!strcmp(type, "structured"))
    set_coordinates(b, LAYOUT_APART, mesh);
  else
    conduit_node_set_path_char8_str(mesh, "coordsets/coords/type", type);
  int64_t step = 1;
  for (int k = 0; k < 3; k++) {
    if (!strcmp(type, "uniform")) {
      conduit_node_set_path_int64(mesh, dims[k], b->n[k] + 1);
      conduit_node_set_path_float64(mesh, origin[k], b->x[k]);
    } else if (!strcmp(type, "rectilinear")) {
      standin_set(mesh, axes[k], STANDIN_FLOAT64, b->x + k, b->n[k] + 1, 24 * step);
    } else {
      conduit_node_set_path_int64(mesh, elements[k], b->n[k]);
    }
    step *= b->n[k] + 1;
  }
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/type", type);
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/coordset", "coords");
}
