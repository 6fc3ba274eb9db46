/* SPDX-License-Identifier: Apache-2.0 */
/* Contexts, statuses, and every allocation of a whole rendering made to fail in turn. */
#include "support.h"

static void statuses_have_words(void **state) {
  (void)state;
  for (int i = 0; i < TETCAST_STATUS_COUNT; ++i) {
    assert_string_not_equal(tetcast_status_string((TetcastStatus)i), "unknown status");
  }
  assert_string_equal(tetcast_status_string(TETCAST_STATUS_COUNT), "unknown status");
  assert_string_equal(tetcast_version_string(), TETCAST_VERSION_STRING);
  assert_true(tetcast_embree_version_string()[0] >= '3');
}

static void contexts(void **state) {
  (void)state;
  TetcastContext *context = (TetcastContext *)&state;
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = -1;
  assert_int_equal(tetcast_context_create(&desc, &context), TETCAST_ERROR_ARGUMENT);
  assert_null(context);
  desc = (TetcastContextDesc){0};
  assert_int_equal(tetcast_context_create(&desc, &context), TETCAST_ERROR_ARGUMENT);
  desc = tetcast_context_desc_default();
  desc.allocate = fixture_allocate; /* without its partner */
  assert_int_equal(tetcast_context_create(&desc, &context), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_context_create(NULL, &context), TETCAST_OK);
  assert_true(tetcast_context_threads(context) >= 1);
  assert_int_equal(tetcast_context_set_threads(context, 3), TETCAST_OK);
  assert_int_equal(tetcast_context_threads(context), 3);
  assert_int_equal(tetcast_context_set_threads(context, -3), TETCAST_ERROR_ARGUMENT);
  tetcast_context_destroy(&context);
  tetcast_context_destroy(&context);
  tetcast_context_destroy(NULL);
}

/* Everything there is, once; stops at the first error and cleans up. */
static TetcastStatus everything(Fixture *fixture, const Cube *cube, TetcastTraversal traversal) {
  TetcastContext *context = fixture->context;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastVolume *volume = NULL;
  TetcastTransferFunction *transfer = NULL;
  TetcastScene *scene = NULL;
  TetcastFrame *frame = NULL;
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){cube->values, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.traversal = traversal;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 20;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastMeshHealth health;
  TetcastStatus status = tetcast_mesh_create(context, &mesh_desc, &mesh);
  if (!status)
    status = tetcast_mesh_health(context, mesh, &health);
  if (!status)
    status = tetcast_volume_create(context, mesh, &volume_desc, &volume);
  if (!status)
    status = tetcast_field_create(context, &field_desc, &field);
  if (!status)
    status = tetcast_scene_create(context, volume, &scene);
  if (!status)
    status = tetcast_scene_set_field(scene, field);
  if (!status)
    status = tetcast_scene_create_preset(scene, "magma", 0, 1, &transfer);
  if (!status)
    status = tetcast_scene_set_transfer_function(scene, transfer);
  if (!status)
    status = tetcast_frame_create(context, &frame_desc, &frame);
  if (!status)
    status = tetcast_scene_render(scene, &camera, NULL, frame, NULL);
  tetcast_frame_destroy(&frame);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_volume_destroy(&volume);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  return status;
}

static void any_allocation_may_fail(void **state) {
  (void)state;
  Cube cube = cube_create(3, 0.5);
  /* a vertex in more cells than a small bucket of faces holds, and cells that are left out */
  cube.cells[0] = cube.cells[1];
  memcpy(&cube.cells[8], &cube.cells[12], 4 * sizeof *cube.cells);
  for (int traversal = 0; traversal < 2; ++traversal) {
    long fail_at = 1;
    for (;; ++fail_at) {
      Fixture fixture;
      TetcastStatus status = fixture_begin(&fixture, 2, fail_at);
      if (status) {
        assert_int_equal(status, TETCAST_ERROR_MEMORY);
        assert_int_equal(fail_at, 1);
        continue;
      }
      status = everything(&fixture, &cube, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
      const bool failed = fixture.allocations >= fail_at;
      if (status) {
        assert_int_equal(status, TETCAST_ERROR_MEMORY);
        assert_non_null(strstr(fixture.message, "memory"));
      }
      fixture_end(&fixture); /* nothing leaks */
      if (!failed) {
        assert_int_equal(status, TETCAST_OK);
        break;
      }
    }
    assert_true(fail_at > 20);
  }
  cube_destroy(&cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(statuses_have_words),
      cmocka_unit_test(contexts),
      cmocka_unit_test(any_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
