/* SPDX-License-Identifier: Apache-2.0 */
/* A first program: four tetrahedra in memory, rendered to minimal.ppm.
 *     cc minimal.c $(pkg-config --cflags --libs tetcast) -o minimal */
#include <stdio.h>

#include <tetcast/tetcast.h>

#include "ppm.h"

/* tetcast never prints: the sentence that explains an error comes here, if anywhere. */
static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  fprintf(stderr, "minimal: %s\n", text);
}

int main(void) {
  /* An octahedron, cut into four tetrahedra around its axis, and a scalar that falls from 1 at the top to 0 below. */
  const double vertices[6][3] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const int tetrahedra[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}};
  const float scalar[6] = {1, 0, 0.5f, 0.5f, 0.5f, 0.5f};

  /* What each scalar looks like: blue to orange, and ever denser: extinction is per unit of length. */
  const double color[2][4] = {{0, 0.1, 0.3, 0.9}, {1, 1.0, 0.5, 0.1}};
  const double extinction[2][2] = {{0, 0.2}, {1, 3.0}};

  TetcastContext *context = NULL;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastVolume *volume = NULL;
  TetcastTransferFunction *transfer_function = NULL;
  TetcastScene *scene = NULL;
  TetcastFrame *frame = NULL;

  TetcastContextDesc context_desc = tetcast_context_desc_default();
  context_desc.message = print_message;

  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){.data = vertices, .type = TETCAST_TYPE_FLOAT64, .count = 6};
  mesh_desc.tetrahedra = (TetcastArray){.data = tetrahedra, .type = TETCAST_TYPE_INT32, .count = 4};

  TetcastFieldDesc field_desc = tetcast_field_desc_default(); /* one value per vertex; copied */
  field_desc.values = (TetcastArray){.data = scalar, .type = TETCAST_TYPE_FLOAT32, .count = 6};

  TetcastTransferFunctionDesc transfer_desc = tetcast_transfer_function_desc_default();
  transfer_desc.color = &color[0][0];
  transfer_desc.color_count = 2;
  transfer_desc.extinction = &extinction[0][0];
  transfer_desc.extinction_count = 2;

  TetcastFrameDesc frame_desc = tetcast_frame_desc_default(); /* double, memory of its own */
  frame_desc.width = 256;
  frame_desc.height = 256;

  TetcastCamera camera = {.eye = {2, -5, 2.5}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy = 24};
  TetcastRenderStats stats = {0};

  /* Each call hands its result out through the last pointer and returns a status; && stops at the first that fails. */
  int ok = tetcast_context_create(&context_desc, &context) == TETCAST_OK &&
           tetcast_mesh_create(context, &mesh_desc, &mesh) == TETCAST_OK &&
           tetcast_field_create(context, &field_desc, &field) == TETCAST_OK &&
           tetcast_volume_create(context, mesh, NULL, &volume) == TETCAST_OK &&
           tetcast_transfer_function_create(context, &transfer_desc, &transfer_function) == TETCAST_OK &&
           tetcast_scene_create(context, volume, &scene) == TETCAST_OK &&
           tetcast_scene_set_field(scene, field) == TETCAST_OK &&
           tetcast_scene_set_transfer_function(scene, transfer_function) == TETCAST_OK &&
           tetcast_frame_create(context, &frame_desc, &frame) == TETCAST_OK &&
           tetcast_scene_render(scene, &camera, NULL, frame, &stats) == TETCAST_OK;
  if (ok) {
    printf("%lld rays crossed %lld cells\n", (long long)stats.rays, (long long)stats.segments);
    if (ppm_write("minimal.ppm", frame, 1)) {
      fprintf(stderr, "minimal: minimal.ppm can't be written\n");
      ok = 0;
    }
  }

  /* In the reverse order; what was never made is NULL, which is fine. */
  tetcast_frame_destroy(&frame);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer_function);
  tetcast_volume_destroy(&volume);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  tetcast_context_destroy(&context);
  return ok ? 0 : 1;
}
