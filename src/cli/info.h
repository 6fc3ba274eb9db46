/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_INFO_H
#define TETCAST_CLI_INFO_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/mesh.h>

#include "adapter.h"

enum { INFO_COMPONENTS = 9 }; /* arrays of more are shown by magnitude alone */

enum { INFO_QUANTILES = 7 };
extern const double info_shares[INFO_QUANTILES];

typedef struct InfoRange {
  double low, high;
  int64_t nonfinite;
  double quantiles[INFO_QUANTILES]; /* below which info_shares of the volume lie; with --statistics */
} InfoRange;

typedef struct InfoArray {
  TetcastDatasetArray about;
  int components; /* with a range each */
  InfoRange component[INFO_COMPONENTS];
  InfoRange magnitude; /* of arrays of several components */
} InfoArray;

/* What is in a file. */
typedef struct Info {
  const char *path;
  const CliVtk *vtk;
  TetcastDatasetDesc desc;
  bool statistics; /* whether quantiles are wanted */
  TetcastContext *context;
  TetcastDataset *dataset;
  TetcastMesh *mesh;
  int64_t tetrahedra, vertices;
  double bounds[6];
  TetcastMeshHealth health;
  int array_count;
  InfoArray *arrays;
} Info;

/* Writes it as JSON to standard output. */
void info_print_json(const Info *info);

#endif
