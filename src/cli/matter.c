/* SPDX-License-Identifier: Apache-2.0 */
#include "matter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "adapter.h"
#include "cli.h"
#include "surface_text.h"

/* How programs call the numbers of blocks and materials; the first of these that there is gives the colours. */
static const char *const label_names[] = {
    "block",     "material",    "materialids",     "materialid",      "material_id", "material_ids", "matid",
    "mat_id",    "mat",         "physical",        "gmsh:physical",   "cell_tags",   "region",       "regionid",
    "region_id", "regions",     "domain",          "subdomain",       "zone",        "zoneid",       "part",
    "partid",    "part_id",     "objectid",        "elementblockids", "blockid",     "block_id",     "attribute",
    "medit:ref", "geometrical", "gmsh:geometrical"};
enum { LABEL_NAMES = sizeof label_names / sizeof *label_names, LABELS_FEW = 32 };

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

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The values that a field has, each once; if there are too many for colours, none. */
void matter_collect(const TetcastField *field, Matter *matter) {
  const int64_t count = tetcast_field_values(field).count;
  double *labels = cli_allocate(sizeof *labels * (MATTER_LABELS + 1)), last = (double)NAN;
  int found = 0;
  for (int64_t i = 0; i < count && found <= MATTER_LABELS; i++) {
    const double value = tetcast_field_value(field, i);
    if (value == last || bsearch(&value, labels, (size_t)found, sizeof value, ascending))
      continue;
    last = labels[found++] = value;
    qsort(labels, (size_t)found, sizeof *labels, ascending);
  }
  matter_release(matter);
  matter->labels = labels;
  matter->count = found <= MATTER_LABELS ? found : 0;
}

void matter_unite(const Matter *other, Matter *matter) {
  double *labels = cli_allocate(sizeof *labels * (size_t)(matter->count + other->count + 1));
  int count = 0, i = 0, k = 0;
  while (i < matter->count || k < other->count) {
    const bool own = k == other->count || (i < matter->count && matter->labels[i] <= other->labels[k]);
    const double value = own ? matter->labels[i++] : other->labels[k++];
    if (count == 0 || labels[count - 1] != value)
      labels[count++] = value;
  }
  const bool fine = count <= MATTER_LABELS && other->count > 0 && (matter->count > 0 || !matter->labels);
  matter_release(matter);
  matter->labels = labels;
  matter->count = fine ? count : 0;
}

bool matter_is_label(const TetcastDataset *dataset, const char *selector, const TetcastField *field) {
  TetcastDatasetArray array;
  if (tetcast_field_association(field) != TETCAST_CELL)
    return false;
  for (int i = 0; cli_vtk()->dataset_array(dataset, i, &array); i++) {
    const bool whole = !strncmp(array.type, "int", 3) || !strncmp(array.type, "uint", 4);
    if (strcmp(array.selector, selector) || array.association != TETCAST_CELL || array.components != 1 || !whole)
      continue;
    Matter matter = {.labels = NULL};
    matter_collect(field, &matter);
    const int count = matter.count;
    matter_release(&matter);
    bool named = false;
    for (int k = 0; k < LABEL_NAMES; k++)
      named = named || !strcasecmp(array.name, label_names[k]);
    if (named && count == 0)
      cli_note("array %s has more than %d labels: drawn as numbers", array.name, MATTER_LABELS);
    return count > 0 && (named || count <= LABELS_FEW);
  }
  return false;
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
    matter_collect(labels, matter);
    matter->extinction = tetcast_transfer_function_extinction(preset, &count)[1];
  }
  tetcast_transfer_function_destroy(&preset);
  tetcast_scene_destroy(&scene);
  tetcast_field_destroy(&ones);
  return status;
}

/* Two knots for each label: its numbers, `width` of them, hold half the way to its neighbours. */
static double *make_steps(const Matter *matter, const double *numbers, size_t width) {
  double *knots = cli_allocate(sizeof *knots * 2 * (width + 1) * (size_t)matter->count);
  for (int i = 0; i < matter->count; i++) {
    const double own = matter->labels[i];
    const double ends[2] = {i > 0 ? own / 2 + matter->labels[i - 1] / 2 : own,
                            i + 1 < matter->count ? own / 2 + matter->labels[i + 1] / 2 : own};
    for (int e = 0; e < 2; e++) {
      double *knot = knots + (width + 1) * (size_t)(2 * i + e);
      knot[0] = ends[e];
      memcpy(knot + 1, numbers + (size_t)i * width, width * sizeof *knot);
    }
  }
  return knots;
}

/* The colours of labels, and their extinctions relative to that of all: what is said of them, else a palette's. */
static void find_looks(const Matter *matter, const TetcastTransferFunction *palette, const TextList *said,
                       double *colors, double *extinctions) {
  int64_t palette_knots;
  const double *steps = tetcast_transfer_function_color(palette, &palette_knots);
  for (int i = 0; i < matter->count; i++) {
    memcpy(colors + 3 * i, steps + 8 * (i % (palette_knots / 2)) + 1, 3 * sizeof *colors);
    extinctions[i] = matter->extinction;
  }
  for (int k = 0; k < said->count; k++) {
    TetcastIsosurface look;
    bool colored;
    surfaces_parse(said->text[k], &look, &colored);
    const double *label =
        bsearch(&look.value, matter->labels, (size_t)matter->count, sizeof *matter->labels, ascending);
    if (!label) {
      cli_warning("--label %s: no cell has the number %g", said->text[k], look.value);
      continue;
    }
    const ptrdiff_t i = label - matter->labels;
    if (colored)
      memcpy(colors + 3 * i, look.color, sizeof look.color);
    if (strchr(said->text[k], ':') &&
        (!colored || look.opacity < 1)) /* of what half hides with the common extinction */
      extinctions[i] = matter->extinction * -log2(fmax(1 - look.opacity, 1.0 / 1024));
  }
}

TetcastStatus matter_shade(TetcastContext *context, const Matter *matter, const TetcastTransferFunction *map,
                           const TextList *said, TetcastTransferFunction **transfer_function) {
  const double extinction[2] = {0, matter->extinction};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.extinction = extinction;
  desc.extinction_count = 1;
  double *steps = NULL, *extinction_steps = NULL;
  TetcastStatus status = TETCAST_OK;
  if (map) {
    desc.color = tetcast_transfer_function_color(map, &desc.color_count);
  } else {
    TetcastTransferFunction *palette = NULL;
    double *colors = cli_allocate(sizeof *colors * 4 * (size_t)matter->count), *own = colors + 3 * matter->count;
    status = tetcast_transfer_function_create_preset(context, "okabe-ito", 0, 1, 0, &palette);
    if (status == TETCAST_OK) {
      find_looks(matter, palette, said, colors, own);
      desc.color = steps = make_steps(matter, colors, 3);
      desc.color_count = 2 * matter->count;
    }
    if (status == TETCAST_OK && said->count > 0) {
      desc.extinction = extinction_steps = make_steps(matter, own, 1);
      desc.extinction_count = 2 * matter->count;
    }
    tetcast_transfer_function_destroy(&palette);
    free(colors);
  }
  if (status == TETCAST_OK)
    status = tetcast_transfer_function_create(context, &desc, transfer_function);
  free(steps);
  free(extinction_steps);
  return status;
}

void matter_release(Matter *matter) {
  free(matter->labels);
  matter->labels = NULL;
  matter->count = 0;
}
