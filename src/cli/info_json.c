/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>

#include "cli.h"
#include "info.h"
#include "json.h"

static json_t *range_object(const Info *info, const InfoRange *range) {
  const double ends[2] = {range->low, range->high};
  json_t *object = json_object();
  json_object_set_new(object, "range", cli_json_array(ends, 2));
  json_object_set_new(object, "nonfinite", json_integer(range->nonfinite));
  json_t *quantiles = info->statistics ? json_array() : NULL;
  for (int i = 0; quantiles && i < INFO_QUANTILES; i++) { /* NaN, where no value is finite, is null */
    json_t *pair = json_array(), *value = json_real(range->quantiles[i]);
    json_array_append_new(pair, json_real(info_shares[i]));
    json_array_append_new(pair, value ? value : json_null());
    json_array_append_new(quantiles, pair);
  }
  if (quantiles)
    json_object_set_new(object, "quantiles", quantiles);
  return object;
}

static json_t *array_object(const Info *info, const InfoArray *array) {
  json_t *object = json_object();
  json_object_set_new(object, "name", cli_json_text(array->about.name));
  json_object_set_new(object, "selector", cli_json_text(array->about.selector));
  json_object_set_new(object, "association", json_string(array->about.association == TETCAST_CELL ? "cell" : "point"));
  json_object_set_new(object, "type", json_string(array->about.type));
  json_object_set_new(object, "components", json_integer(array->about.components));
  json_object_set_new(object, "active", json_boolean(array->about.active));
  const InfoRange *range = array->about.components == 1 ? &array->component[0] : &array->magnitude;
  json_object_update_new(object, range_object(info, range));
  if (array->about.components > 1 && array->components > 0) {
    json_t *list = json_array();
    for (int i = 0; i < array->components; i++)
      json_array_append_new(list, range_object(info, &array->component[i]));
    json_object_set_new(object, "component_ranges", list);
  }
  return object;
}

static json_t *health_object(const TetcastMeshHealth *health) {
  json_t *object = json_object();
  json_object_set_new(object, "components", json_integer(health->components));
  json_object_set_new(object, "boundary_faces", json_integer(health->boundary_faces));
  json_object_set_new(object, "nonmanifold_faces", json_integer(health->nonmanifold_faces));
  json_object_set_new(object, "degenerate_cells", json_integer(health->degenerate_cells));
  json_object_set_new(object, "inverted_cells", json_integer(health->inverted_cells));
  json_object_set_new(object, "duplicate_cells", json_integer(health->duplicate_cells));
  json_object_set_new(object, "unused_vertices", json_integer(health->unused_vertices));
  json_object_set_new(object, "coincident_vertices", json_integer(health->coincident_vertices));
  json_object_set_new(object, "volume", json_real(health->volume));
  json_object_set_new(object, "boundary_area", json_real(health->boundary_area));
  return object;
}

static json_t *pieces_object(const TetcastDatasetPieces *pieces) {
  json_t *object = json_object();
  json_object_set_new(object, "count", json_integer(pieces->pieces));
  json_object_set_new(object, "without_volume", json_integer(pieces->surfaces));
  json_object_set_new(object, "ghost_cells", json_integer(pieces->ghost_cells));
  json_object_set_new(object, "ghost_points", json_integer(pieces->ghost_points));
  json_object_set_new(object, "merged_points", json_integer(pieces->merged_points));
  json_object_set_new(object, "differing_points", json_integer(pieces->differing_points));
  json_object_set_new(object, "nonfinite_points", json_integer(pieces->nonfinite_points));
  json_object_set_new(object, "nonfinite_cells", json_integer(pieces->nonfinite_cells));
  return object;
}

static void set_steps_and_blocks(const Info *info, json_t *root) {
  json_t *times = json_array(), *blocks = json_array();
  double time;
  for (int64_t i = 0; info->vtk->dataset_time(info->dataset, i, &time); i++)
    json_array_append_new(times, json_real(time));
  json_object_set_new(root, "times", times);
  json_object_set_new(root, "step", json_integer(info->vtk->dataset_step(info->dataset)));
  for (int i = 0; info->vtk->dataset_block(info->dataset, i); i++)
    json_array_append_new(blocks, cli_json_text(info->vtk->dataset_block(info->dataset, i)));
  json_object_set_new(root, "blocks", blocks);
  const TetcastDatasetPieces pieces = info->vtk->dataset_pieces(info->dataset);
  json_object_set_new(root, "pieces", pieces_object(&pieces));
}

static json_t *cut_object(const TetcastCutInfo *cut) {
  json_t *object = json_object();
  json_object_set_new(object, "cells", json_integer(cut->cells));
  json_object_set_new(object, "added_vertices", json_integer(cut->added_vertices));
  json_object_set_new(object, "curved", json_integer(cut->curved));
  json_object_set_new(object, "segments", json_pack("[ii]", cut->segments[0], cut->segments[1]));
  json_object_set_new(object, "centred", json_integer(cut->centred));
  json_object_set_new(object, "collapsed", json_integer(cut->collapsed));
  json_object_set_new(object, "inverted", json_integer(cut->inverted));
  json_object_set_new(object, "folded", json_integer(cut->folded));
  json_object_set_new(object, "open", json_integer(cut->open));
  json_object_set_new(object, "empty", json_integer(cut->empty));
  json_object_set_new(object, "oversized", json_integer(cut->oversized));
  return object;
}

void info_print_json(const Info *info) {
  json_t *root = json_object();
  json_object_set_new(root, "file", cli_json_text(info->path));
  set_steps_and_blocks(info, root);
  json_object_set_new(root, "points", json_integer(info->vtk->dataset_point_count(info->dataset)));
  json_object_set_new(root, "cells", json_integer(info->vtk->dataset_cell_count(info->dataset)));
  json_t *types = json_object();
  const char *name;
  int64_t count;
  for (int i = 0; info->vtk->dataset_cell_type(info->dataset, i, &name, &count); i++)
    json_object_set_new(types, name, json_integer(count));
  json_object_set_new(root, "cell_types", types);
  json_object_set_new(root, "tetrahedra", json_integer(info->tetrahedra));
  const TetcastCutInfo cut = info->vtk->dataset_cut(info->dataset);
  json_object_set_new(root, "cut", cut_object(&cut));
  json_object_set_new(root, "vertices", json_integer(info->vertices));
  json_object_set_new(root, "bounds", cli_json_array(info->bounds, 6));
  json_t *arrays = json_array();
  for (int i = 0; i < info->array_count; i++)
    json_array_append_new(arrays, array_object(info, &info->arrays[i]));
  json_object_set_new(root, "arrays", arrays);
  json_object_set_new(root, "health", health_object(&info->health));
  if (json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0)
    putchar('\n');
  else
    cli_error("cannot write to standard output");
  json_decref(root);
}
