/* SPDX-License-Identifier: Apache-2.0 */
/* A simulation that looks at each of its steps for days: between steps nothing is kept but what serves the next one,
 * and it does not grow, whatever is made of a step. */
#include <malloc.h>
#include <unistd.h>

#include "support.h"

enum { W = 24, H = 16, RAYS = 60 };

/* All that a simulation keeps from step to step. */
typedef struct Kept {
  Fixture fixture;
  int64_t bytes; /* that the library has, for the user's hooks */
  Cube cube;
  TetcastVolume *volume;
  TetcastScene *scene;
  TetcastFrame *frame;
  TetcastFragments *fragments;
  double lines[RAYS][6];
} Kept;

static void *allocate(void *user, size_t size, size_t alignment) {
  Kept *kept = user;
  void *memory = fixture_allocate(&kept->fixture, size, alignment);
  __atomic_add_fetch(&kept->bytes, (int64_t)malloc_usable_size(memory), __ATOMIC_RELAXED);
  return memory;
}

static void release(void *user, void *memory) {
  Kept *kept = user;
  __atomic_add_fetch(&kept->bytes, -(int64_t)malloc_usable_size(memory), __ATOMIC_RELAXED);
  fixture_release(&kept->fixture, memory);
}

static void begin(Kept *kept) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = 2;
  desc.message = fixture_message;
  desc.message_user = &kept->fixture;
  desc.allocate = allocate;
  desc.release = release;
  desc.memory_user = kept;
  assert_int_equal(tetcast_context_create(&desc, &kept->fixture.context), TETCAST_OK);
  TetcastContext *context = kept->fixture.context;
  kept->cube = cube_create(6, 0.3);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){kept->cube.vertices, TETCAST_TYPE_FLOAT64, kept->cube.vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){kept->cube.cells, TETCAST_TYPE_INT64, kept->cube.cell_count, 0};
  mesh_desc.ownership = TETCAST_BORROW;
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(context, &mesh_desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_volume_create(context, mesh, NULL, &kept->volume), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  assert_int_equal(tetcast_scene_create(context, kept->volume, &kept->scene), TETCAST_OK);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &kept->frame), TETCAST_OK);
  assert_int_equal(tetcast_fragments_create(context, &kept->fragments), TETCAST_OK);
  uint64_t seed = 5;
  for (int i = 0; i < RAYS * 6; ++i)
    kept->lines[i / 6][i % 6] = i % 6 < 3 ? uniform(&seed) : uniform(&seed) - 0.5;
}

/* The same two fields by turns, so that every second step needs the same memory. */
static void step(Kept *kept, int number) {
  TetcastContext *context = kept->fixture.context;
  const Cube *cube = &kept->cube;
  for (int64_t i = 0; i < cube->vertex_count; ++i)
    cube->values[i] = sin(9 * cube->vertices[3 * i] + number % 2) * cos(7 * cube->vertices[3 * i + 1]);
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){cube->values, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.ownership = TETCAST_BORROW;
  TetcastField *field = NULL;
  TetcastTransferFunction *transfer = NULL;
  double range[2];
  assert_int_equal(tetcast_field_create(context, &desc, &field), TETCAST_OK);
  tetcast_field_range(field, range, NULL);
  assert_int_equal(tetcast_transfer_function_create_preset(context, "viridis", range[0], range[1], 3, &transfer),
                   TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(kept->scene, field), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(kept->scene, transfer), TETCAST_OK);
  tetcast_field_destroy(&field);
  tetcast_transfer_function_destroy(&transfer);
  const TetcastCamera camera = {.eye = {2.6, -1.9, 1.9},
                                .target = {0.5, 0.5, 0.5},
                                .up = {0, 0, 1},
                                .fovy = 30,
                                .projection = TETCAST_PERSPECTIVE};
  TetcastRenderDesc render = tetcast_render_desc_default();
  render.tolerance = number % 2 ? 0 : 1e-3;
  assert_int_equal(tetcast_scene_render(kept->scene, &camera, &render, kept->frame, NULL), TETCAST_OK);
  assert_int_equal(tetcast_scene_render_fragments(kept->scene, &camera, NULL, W, H, kept->fragments, NULL), TETCAST_OK);
  const TetcastFragmentList list = tetcast_fragments_list(kept->fragments);
  assert_int_equal(tetcast_fragments_composite(context, &list, 1, kept->frame, NULL), TETCAST_OK);
  TetcastRays rays = tetcast_rays_default();
  rays.origins = (TetcastArray){kept->lines[0], TETCAST_TYPE_FLOAT64, RAYS, sizeof kept->lines[0]};
  rays.directions = (TetcastArray){kept->lines[0] + 3, TETCAST_TYPE_FLOAT64, RAYS, sizeof kept->lines[0]};
  double depth[RAYS];
  const TetcastCastResult result = {.optical_depth = depth};
  assert_int_equal(tetcast_scene_cast(kept->scene, &rays, NULL, &result, NULL), TETCAST_OK);
}

static void end(Kept *kept) {
  tetcast_fragments_destroy(&kept->fragments);
  tetcast_frame_destroy(&kept->frame);
  tetcast_scene_destroy(&kept->scene);
  tetcast_volume_destroy(&kept->volume);
  tetcast_context_destroy(&kept->fixture.context);
  cube_destroy(&kept->cube);
  assert_int_equal(kept->fixture.live, 0);
  assert_true(kept->bytes == 0);
}

/* The pages of memory that the process has. */
static long pages(void) {
  long size = 0, resident = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file) {
    if (fscanf(file, "%ld %ld", &size, &resident) != 2)
      resident = 0;
    fclose(file);
  }
  return resident;
}

static void a_thousand_steps_keep_nothing(void **state) {
  (void)state;
  Kept kept = {0};
  begin(&kept);
  for (int i = 0; i < 100; ++i)
    step(&kept, i);
  const long live = kept.fixture.live, before = pages();
  const int64_t bytes = kept.bytes;
  for (int i = 100; i < 1100; ++i)
    step(&kept, i);
  assert_int_equal(kept.fixture.live, live);
  assert_true(kept.bytes == bytes);
  /* What lies beneath the library, Embree and threads: less than a page in ten steps. A sanitizer keeps freed memory.
   */
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  assert_in_range(pages() - before > 0 ? pages() - before : 0, 0, 100);
#else
  (void)before;
#endif
  end(&kept);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_thousand_steps_keep_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
