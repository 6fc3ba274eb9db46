/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of damaged files share. */
#ifndef TEST_VTK_DAMAGE_H
#define TEST_VTK_DAMAGE_H

#include "common.h"

/* Reads, and uses everything it gets. */
static inline TetcastStatus use(Fixture *fixture, const char *path) {
  TetcastDataset *dataset;
  fixture->errors = 0;
  const TetcastStatus status = tetcast_dataset_read(fixture->context, path, NULL, &dataset);
  assert_int_equal(fixture->errors, status != TETCAST_OK);
  if (status)
    return status;
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  TetcastDatasetArray array;
  for (int i = 0; tetcast_dataset_array(dataset, i, &array); ++i) {
    TetcastField *field;
    double range[2];
    if (tetcast_dataset_field(dataset, array.name, &field, NULL))
      continue;
    tetcast_field_range(field, range, NULL);
    tetcast_field_destroy(&field);
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  return TETCAST_OK;
}

/* Numbers of a fixed sequence. */
static inline uint32_t next_random(uint32_t *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return *seed >> 8;
}

#endif
