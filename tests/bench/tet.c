/* SPDX-License-Identifier: Apache-2.0 */
#include "tet.h"

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  fprintf(stderr, "tetcast_bench: %s\n", text);
}

static void must_be_ok(TetcastStatus status, const char *what) {
  if (status != TETCAST_OK) {
    fprintf(stderr, "tetcast_bench: %s: %s\n", what, tetcast_status_string(status));
  }
  must(status == TETCAST_OK, "tetcast failed");
}

void tet_open(Tet *tet, const BenchMesh *mesh, int threads) {
  *tet = (Tet){0};
  TetcastContextDesc context = tetcast_context_desc_default();
  context.threads = threads;
  context.message = print_message;
  must_be_ok(tetcast_context_create(&context, &tet->context), "context");

  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){.data = mesh->vertices, .type = mesh->type, .count = mesh->vertex_count};
  desc.tetrahedra = (TetcastArray){.data = mesh->cells, .type = TETCAST_TYPE_INT32, .count = mesh->cell_count};
  desc.ownership = TETCAST_BORROW;
  must_be_ok(tetcast_mesh_create(tet->context, &desc, &tet->mesh), "mesh");

  TetcastFieldDesc field = tetcast_field_desc_default();
  field.values = (TetcastArray){.data = mesh->scalars, .type = mesh->type, .count = mesh->vertex_count};
  field.ownership = TETCAST_BORROW;
  must_be_ok(tetcast_field_create(tet->context, &field, &tet->field), "field");
}

void tet_close(Tet *tet) {
  tetcast_scene_destroy(&tet->scene);
  tetcast_volume_destroy(&tet->volume);
  tetcast_field_destroy(&tet->field);
  tetcast_mesh_destroy(&tet->mesh);
  tetcast_context_destroy(&tet->context);
}

Clock tet_prepare(Tet *tet) {
  tetcast_scene_destroy(&tet->scene);
  tetcast_volume_destroy(&tet->volume);
  Clock start = clock_now();
  must_be_ok(tetcast_volume_create(tet->context, tet->mesh, NULL, &tet->volume), "volume");
  must_be_ok(tetcast_scene_create(tet->context, tet->volume, &tet->scene), "scene");
  must_be_ok(tetcast_scene_set_field(tet->scene, tet->field), "set field");
  return clock_since(start);
}

Clock tet_transfer(Tet *tet, const Transfer *transfer) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  transfer_fill(&desc, transfer);
  TetcastTransferFunction *function = NULL;
  Clock start = clock_now();
  must_be_ok(tetcast_transfer_function_create(tet->context, &desc, &function), "transfer function");
  must_be_ok(tetcast_scene_set_transfer_function(tet->scene, function), "set transfer function");
  Clock time = clock_since(start);
  tetcast_transfer_function_destroy(&function);
  return time;
}

TetcastFrame *tet_frame(Tet *tet, int pixels, TetcastType type, uint32_t channels) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = pixels;
  desc.type = type;
  desc.channels = channels;
  TetcastFrame *frame = NULL;
  must_be_ok(tetcast_frame_create(tet->context, &desc, &frame), "frame");
  return frame;
}

Clock tet_render(Tet *tet, const TetcastCamera *camera, const TetcastRenderDesc *desc, TetcastFrame *frame,
                 TetcastRenderStats *stats) {
  Clock start = clock_now();
  must_be_ok(tetcast_scene_render(tet->scene, camera, desc, frame, stats), "render");
  return clock_since(start);
}
