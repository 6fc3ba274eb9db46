/* SPDX-License-Identifier: Apache-2.0 */
#include "matter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "adapter.h"
#include "cli.h"

/* How programs call the numbers of blocks and materials; the first of these that there is gives the colours. */
static const char *const label_names[] = {
    "block",     "material",    "materialids",     "materialid",      "material_id", "material_ids", "matid",
    "mat_id",    "mat",         "physical",        "gmsh:physical",   "cell_tags",   "region",       "regionid",
    "region_id", "regions",     "domain",          "subdomain",       "zone",        "zoneid",       "part",
    "partid",    "part_id",     "objectid",        "elementblockids", "blockid",     "block_id",     "attribute",
    "medit:ref", "geometrical", "gmsh:geometrical"};
enum { LABEL_NAMES = sizeof label_names / sizeof *label_names, LABELS_MOST = 1000 };

/* Colours that colour-blind people tell apart, after M. Okabe and K. Ito, on white and on black. */
static const double palette[][3] = {{0.90, 0.62, 0.00}, {0.34, 0.71, 0.91}, {0.00, 0.62, 0.45}, {0.84, 0.37, 0.00},
                                    {0.00, 0.45, 0.70}, {0.80, 0.47, 0.65}, {0.94, 0.89, 0.26}, {0.50, 0.50, 0.50}};
enum { PALETTE = sizeof palette / sizeof *palette };

bool matter_wanted(const TetcastDataset *dataset, const char **label) {
  int best = LABEL_NAMES;
  bool only = true;
  TetcastDatasetArray array;
  *label = NULL;
  for (int i = 0; only && cli_vtk()->dataset_array(dataset, i, &array); i++) {
    const bool whole = !strncmp(array.type, "int", 3) || !strncmp(array.type, "uint", 4);
    only = array.association == TETCAST_CELL && array.components == 1 && whole;
    for (int k = 0; only && k < best; k++)
      if (!strcasecmp(array.name, label_names[k])) {
        best = k;
        *label = array.name;
      }
  }
  if (!only)
    *label = NULL;
  return *label || !cli_vtk()->dataset_array(dataset, 0, &array);
}

TetcastStatus matter_field(TetcastContext *context, const TetcastMesh *mesh, TetcastField **field) {
  const int64_t count = tetcast_mesh_vertex_count(mesh);
  float *ones = cli_allocate(sizeof *ones * (size_t)count);
  for (int64_t i = 0; i < count; i++)
    ones[i] = 1;
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){.data = ones, .type = TETCAST_TYPE_FLOAT32, .count = count};
  const TetcastStatus status = tetcast_field_create(context, &desc, field);
  free(ones);
  return status;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The values that a field has, each once; if there are too many for colours, none. */
static void collect(const TetcastField *field, Matter *matter) {
  const int64_t count = tetcast_field_values(field).count;
  double *labels = cli_allocate(sizeof *labels * (LABELS_MOST + 1)), last = (double)NAN;
  int found = 0;
  for (int64_t i = 0; i < count && found <= LABELS_MOST; i++) {
    const double value = tetcast_field_value(field, i);
    if (value == last || bsearch(&value, labels, (size_t)found, sizeof value, ascending))
      continue;
    last = labels[found++] = value;
    qsort(labels, (size_t)found, sizeof *labels, ascending);
  }
  matter_release(matter);
  matter->labels = labels;
  matter->count = found <= LABELS_MOST ? found : 0;
}

TetcastStatus matter_measure(TetcastContext *context, const TetcastVolume *volume, const TetcastMesh *mesh,
                             const TetcastField *labels, Matter *matter) {
  TetcastField *ones = NULL;
  TetcastScene *scene = NULL;
  TetcastTransferFunction *preset = NULL;
  TetcastStatus status = matter_field(context, mesh, &ones);
  if (status == TETCAST_OK)
    status = tetcast_scene_create(context, volume, &scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_field(scene, ones);
  if (status == TETCAST_OK)
    status = tetcast_scene_create_preset(scene, tetcast_preset_name(0), 1, 1, &preset);
  if (status == TETCAST_OK) {
    int64_t count;
    collect(labels, matter);
    matter->extinction = tetcast_transfer_function_extinction(preset, &count)[1];
  }
  tetcast_transfer_function_destroy(&preset);
  tetcast_scene_destroy(&scene);
  tetcast_field_destroy(&ones);
  return status;
}

/* Two knots for each label: its colour holds half the way to its neighbours. */
static double *step_colors(const Matter *matter) {
  double *knots = cli_allocate(sizeof *knots * 8 * (size_t)matter->count);
  for (int i = 0; i < matter->count; i++) {
    const double own = matter->labels[i], *color = palette[i % PALETTE];
    const double ends[2] = {i > 0 ? own / 2 + matter->labels[i - 1] / 2 : own,
                            i + 1 < matter->count ? own / 2 + matter->labels[i + 1] / 2 : own};
    for (int e = 0; e < 2; e++) {
      knots[4 * (2 * i + e)] = ends[e];
      memcpy(knots + 4 * (2 * i + e) + 1, color, sizeof palette[0]);
    }
  }
  return knots;
}

TetcastStatus matter_shade(TetcastContext *context, const TetcastScene *scene, const Matter *matter, const char *preset,
                           const double range[2], TetcastTransferFunction **transfer_function) {
  const double extinction[2] = {range[0], matter->extinction};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.extinction = extinction;
  desc.extinction_count = 1;
  TetcastTransferFunction *map = NULL;
  double *steps = NULL;
  TetcastStatus status = TETCAST_OK;
  if (preset || matter->count == 0) {
    status = tetcast_scene_create_preset(scene, preset ? preset : tetcast_preset_name(0), range[0], range[1], &map);
    if (status == TETCAST_OK)
      desc.color = tetcast_transfer_function_color(map, &desc.color_count);
  } else {
    desc.color = steps = step_colors(matter);
    desc.color_count = 2 * matter->count;
  }
  if (status == TETCAST_OK)
    status = tetcast_transfer_function_create(context, &desc, transfer_function);
  tetcast_transfer_function_destroy(&map);
  free(steps);
  return status;
}

void matter_release(Matter *matter) {
  free(matter->labels);
  matter->labels = NULL;
  matter->count = 0;
}
