/* SPDX-License-Identifier: Apache-2.0 */
/* A jittered cube with whatever field on it, and the rays through the pixels of a picture of it, written anew: what
 * tests of looks compare with closed forms. */
#ifndef WORLD_H
#define WORLD_H

#include "support.h"

typedef struct World {
  Fixture fixture;
  Cube cube;
  TetcastVolume *volume;
  TetcastScene *scene;
} World;

static inline void world_begin(World *world, int n, double jitter, double scale, TetcastTraversal traversal) {
  assert_int_equal(fixture_begin(&world->fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = world->fixture.context;
  world->cube = cube_create(n, jitter);
  for (int64_t i = 0; i < 3 * world->cube.vertex_count; ++i)
    world->cube.vertices[i] *= scale;
  TetcastMesh *mesh = cube_mesh(context, &world->cube);
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = traversal;
  desc.corners = 1;
  world->volume = NULL;
  world->scene = NULL;
  assert_int_equal(tetcast_volume_create(context, mesh, &desc, &world->volume), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(context, world->volume, &world->scene), TETCAST_OK);
  tetcast_mesh_destroy(&mesh);
  TetcastTransferFunction *transfer = gray_of(context, 0); /* which hides nothing */
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

static inline void world_end(World *world) {
  tetcast_scene_destroy(&world->scene);
  tetcast_volume_destroy(&world->volume);
  cube_destroy(&world->cube);
  fixture_end(&world->fixture);
}

static inline int64_t count_of(const Cube *cube, TetcastAssociation association) {
  return association == TETCAST_POINT ? cube->vertex_count : cube->cell_count * (association == TETCAST_CORNER ? 4 : 1);
}

static inline void set_values(World *world, const double *values, TetcastAssociation association) {
  TetcastField *field = field_of(world->fixture.context, values, count_of(&world->cube, association), association);
  assert_int_equal(tetcast_scene_set_field(world->scene, field), TETCAST_OK);
  tetcast_field_destroy(&field);
}

/* The ray through the middle of a pixel of a picture, from the eye on, as camera.h has it; the direction is a unit
 * vector. */
static inline void ray_of(const TetcastCamera *camera, int width, int height, int pixel, double eye[3],
                          double direction[3]) {
  double forward[3], right[3], up[3], length = 0;
  for (int k = 0; k < 3; ++k)
    forward[k] = camera->target[k] - camera->eye[k];
  for (int k = 0; k < 3; ++k)
    length += forward[k] * forward[k];
  for (int k = 0; k < 3; ++k)
    forward[k] /= sqrt(length);
  length = 0;
  for (int k = 0; k < 3; ++k)
    right[k] = forward[(k + 1) % 3] * camera->up[(k + 2) % 3] - forward[(k + 2) % 3] * camera->up[(k + 1) % 3];
  for (int k = 0; k < 3; ++k)
    length += right[k] * right[k];
  for (int k = 0; k < 3; ++k)
    right[k] /= sqrt(length);
  for (int k = 0; k < 3; ++k)
    up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3];
  const bool parallel = camera->projection == TETCAST_ORTHOGRAPHIC;
  const double half = parallel ? camera->height / 2 : tan(camera->fovy * acos(-1) / 360);
  const double u = ((pixel % width + 0.5) / width * 2 - 1 + camera->center[0]) * half * width / height,
               v = (1 - (pixel / width + 0.5) / height * 2 + camera->center[1]) * half;
  length = 0;
  for (int k = 0; k < 3; ++k) {
    const double shift = u * right[k] + v * up[k];
    eye[k] = camera->eye[k] + (parallel ? shift : 0);
    direction[k] = forward[k] + (parallel ? 0 : shift);
    length += direction[k] * direction[k];
  }
  for (int k = 0; k < 3; ++k)
    direction[k] /= sqrt(length);
}

static inline TetcastCamera parallel(double x, double y, double z, double height) {
  return (TetcastCamera){.eye = {x, y, z},
                         .target = {0.5, 0.5, 0.5},
                         .up = {0, 1, 0},
                         .projection = TETCAST_ORTHOGRAPHIC,
                         .height = height};
}

/* Lets each allocation in turn fail while fragments are made and composited: that is told, and nothing is lost. */
static inline void run_out_of_memory(World *world, const TetcastCamera *camera, int width, int height,
                                     TetcastFrame *frame) {
  TetcastStatus status = TETCAST_ERROR_MEMORY;
  for (long n = 1; status; ++n) {
    TetcastFragments *fragments = NULL;
    const long live = world->fixture.live;
    world->fixture.fail_at = world->fixture.allocations + n;
    status = tetcast_fragments_create(world->fixture.context, &fragments);
    if (!status)
      status = tetcast_scene_render_fragments(world->scene, camera, NULL, width, height, fragments, NULL);
    if (!status) {
      const TetcastFragmentList list = tetcast_fragments_list(fragments);
      status = tetcast_fragments_composite(world->fixture.context, &list, 1, frame, NULL);
    }
    assert_true(status == TETCAST_OK || status == TETCAST_ERROR_MEMORY);
    tetcast_fragments_destroy(&fragments);
    assert_true(world->fixture.live >= live && world->fixture.live < live + 20); /* what the scene keeps */
  }
  world->fixture.fail_at = 0;
}

#endif
