/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of sight as numbers: what a fan of rays, such as those of an interferometer, sees of a density in a cube; then
 * the weights by which vertices' values make up these numbers, as inversion needs them: a row of a matrix for each ray.
 *     cc sight.c kuhn.c $(pkg-config --cflags --libs tetcast) -lm -o sight */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <tetcast/tetcast.h>

#include "kuhn.h"

enum { N = 8, RAYS = 7, VERTICES = (N + 1) * (N + 1) * (N + 1) };

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  fprintf(stderr, "sight: %s\n", text);
}

/* The rays start at one point outside of the cube, and spread. */
static void make_fan(double origins[RAYS][3], double directions[RAYS][3]) {
  for (int i = 0; i < RAYS; i++) {
    const double angle = 0.11 * (i - (RAYS - 1) / 2);
    const double origin[3] = {-1, 0.5, 0.47}, direction[3] = {cos(angle), sin(angle), 0.02};
    memcpy(origins[i], origin, sizeof origin);
    memcpy(directions[i], direction, sizeof direction);
  }
}

/* A row for each ray: what the ray crosses, times the values that the vertices have, is the integral. */
typedef struct Matrix {
  double row[RAYS][VERTICES];
} Matrix;

/* Is given the cells that some of the rays cross. In a cell the density is linear, and its integral is the length times
 * the mean of the densities at both ends, which are the vertices' densities by their barycentric weights there. */
static bool add_rows(void *user, const TetcastTrace *trace) {
  Matrix *matrix = user;
  for (int64_t i = 0; i < trace->count; i++) {
    for (int64_t j = trace->offsets[i]; j < trace->offsets[i + 1]; j++) {
      const TetcastCrossing *crossing = &trace->crossings[j];
      for (int k = 0; k < 4; k++) {
        matrix->row[trace->first + i][crossing->vertex[k]] +=
            crossing->length * (crossing->weight[0][k] + crossing->weight[1][k]) / 2;
      }
    }
  }
  return true;
}

/* Extinction is the density itself, so that the optical depth is its integral. */
static bool show_density(TetcastContext *context, TetcastScene *scene) {
  static const double color[1][4] = {{0, 1, 1, 1}}, extinction[2][2] = {{0, 0}, {10, 10}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = &color[0][0];
  desc.color_count = 1;
  desc.extinction = &extinction[0][0];
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer_function = NULL;
  bool ok = tetcast_transfer_function_create(context, &desc, &transfer_function) == TETCAST_OK &&
            tetcast_scene_set_transfer_function(scene, transfer_function) == TETCAST_OK;
  tetcast_transfer_function_destroy(&transfer_function);
  return ok;
}

int main(void) {
  static Matrix matrix;
  Kuhn kuhn;
  double density[VERTICES], origins[RAYS][3], directions[RAYS][3], integral[RAYS];
  if (kuhn_make(&kuhn, N) != 0) {
    fprintf(stderr, "sight: out of memory\n");
    return 1;
  }
  for (int64_t i = 0; i < kuhn.vertex_count; i++) {
    const double *p = kuhn.vertices[i];
    density[i] = exp(-8 * ((p[0] - 0.4) * (p[0] - 0.4) + (p[1] - 0.6) * (p[1] - 0.6) + (p[2] - 0.5) * (p[2] - 0.5)));
  }
  make_fan(origins, directions);

  TetcastContext *context = NULL;
  TetcastMesh *mesh = NULL;
  TetcastVolume *volume = NULL;
  TetcastField *field = NULL;
  TetcastScene *scene = NULL;
  TetcastContextDesc context_desc = tetcast_context_desc_default();
  context_desc.message = print_message;
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){.data = kuhn.vertices, .type = TETCAST_TYPE_FLOAT64, .count = kuhn.vertex_count};
  mesh_desc.tetrahedra = (TetcastArray){.data = kuhn.cells, .type = TETCAST_TYPE_INT64, .count = kuhn.cell_count};
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){.data = density, .type = TETCAST_TYPE_FLOAT64, .count = kuhn.vertex_count};

  TetcastRays rays = tetcast_rays_default();
  rays.origins = (TetcastArray){.data = origins, .type = TETCAST_TYPE_FLOAT64, .count = RAYS};
  rays.directions = (TetcastArray){.data = directions, .type = TETCAST_TYPE_FLOAT64, .count = RAYS};
  TetcastCastResult result = {.optical_depth = integral}; /* and nothing else, which isn't computed then */

  int ok = tetcast_context_create(&context_desc, &context) == TETCAST_OK &&
           tetcast_mesh_create(context, &mesh_desc, &mesh) == TETCAST_OK &&
           tetcast_volume_create(context, mesh, NULL, &volume) == TETCAST_OK &&
           tetcast_field_create(context, &field_desc, &field) == TETCAST_OK &&
           tetcast_scene_create(context, volume, &scene) == TETCAST_OK &&
           tetcast_scene_set_field(scene, field) == TETCAST_OK && show_density(context, scene) &&
           tetcast_scene_cast(scene, &rays, NULL, &result, NULL) == TETCAST_OK &&
           tetcast_volume_trace(volume, &rays, NULL, add_rows, &matrix) == TETCAST_OK;
  for (int i = 0; ok && i < RAYS; i++) {
    double product = 0;
    int entries = 0;
    for (int64_t j = 0; j < kuhn.vertex_count; j++) {
      product += matrix.row[i][j] * density[j];
      entries += matrix.row[i][j] != 0;
    }
    printf("ray %d: integral of the density %.15f, of which %d vertices have a part\n", i, integral[i], entries);
    if (!(fabs(product - integral[i]) <= 1e-13 * (1 + integral[i]))) {
      fprintf(stderr, "sight: by the matrix it is %.15f\n", product);
      ok = 0;
    }
  }

  tetcast_scene_destroy(&scene);
  tetcast_field_destroy(&field);
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  tetcast_context_destroy(&context);
  kuhn_free(&kuhn);
  return ok ? 0 : 1;
}
