/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a dataset is the box of samples.h, or layers of it. */
#ifndef TEST_VTK_BOX_H
#define TEST_VTK_BOX_H

#include <math.h>

#include "common.h"
#include "samples.h"

static inline TetcastDataset *read_with(Fixture *fixture, const char *path, TetcastDatasetDesc desc) {
  TetcastDataset *dataset = NULL;
  fixture->errors = 0;
  fixture->warnings = 0;
  const TetcastStatus status = tetcast_dataset_read(fixture->context, path, &desc, &dataset);
  if (status)
    print_error("%s\n", fixture->message);
  assert_int_equal(status, TETCAST_OK);
  return dataset;
}

static inline void refuse_with(Fixture *fixture, const char *path, TetcastDatasetDesc desc, const char *words) {
  TetcastDataset *dataset = (TetcastDataset *)fixture;
  fixture->errors = 0;
  assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset), TETCAST_ERROR_ARGUMENT);
  assert_null(dataset);
  assert_complaint(fixture, path, words);
}

/* Layers `first` up to `end` of the box: a conforming mesh of that volume, s linear (times `scale`), c of the cell each
 * tetrahedron is in; scale 0 and no c: not looked at. */
static inline void assert_layers(Fixture *fixture, const TetcastDataset *dataset, int first, int end, double scale,
                                 bool cells) {
  TetcastMesh *mesh;
  TetcastMeshHealth health;
  TetcastField *s = NULL, *c = NULL;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  const int layers = end - first;
  assert_true(fabs(health.volume / (3 * layers) - 1) < 1e-12);
  assert_int_equal(health.boundary_faces, 2 * (2 * 3 * 2 + 2 * 3 * layers + 2 * 2 * layers));
  assert_int_equal(health.components, 1);
  assert_int_equal(health.coincident_vertices, 0);
  assert_int_equal(health.unused_vertices, 0);
  if (scale != 0)
    assert_int_equal(tetcast_dataset_field(dataset, "s", &s, NULL), TETCAST_OK);
  if (cells)
    assert_int_equal(tetcast_dataset_field(dataset, "c", &c, NULL), TETCAST_OK);
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); ++i) {
    int64_t v[4];
    double centre[3] = {0, 0, 0};
    tetcast_mesh_tetrahedron(mesh, i, v);
    for (int j = 0; j < 4; ++j) {
      double p[3];
      tetcast_mesh_vertex(mesh, v[j], p);
      for (int k = 0; k < 3; ++k)
        centre[k] += p[k] / 4;
      if (s)
        assert_true(tetcast_field_value(s, v[j]) == scale * (p[0] + 2 * p[1] + 4 * p[2]));
    }
    const double cell = floor(centre[0]) + 3 * floor(centre[1]) + 6 * floor(2 * centre[2]);
    if (c)
      assert_true(tetcast_field_value(c, i) == cell);
  }
  tetcast_field_destroy(&s);
  tetcast_field_destroy(&c);
  tetcast_mesh_destroy(&mesh);
}

static inline TetcastDatasetDesc of_block(const char *block) {
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.block = block;
  return desc;
}

static inline TetcastDatasetDesc of_step(int64_t step) {
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.step = step;
  return desc;
}

static inline TetcastDatasetDesc of_time(double time) {
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.time = time;
  return desc;
}

#endif
