/* SPDX-License-Identifier: Apache-2.0 */
#include "stage.h"

#include <stdlib.h>

#include "cli.h"
#include "progress.h"
#include "transfer_file.h"
#include "view.h"

int stage_begin(Stage *stage, const RenderOptions *options) {
  stage->context = cli_context_create((int)options->threads);
  if (!stage->context)
    return CLI_FAILED;
  if (render_options_given(options, OPTION_TRANSFER)) {
    stage->transfer_function = transfer_file_load(stage->context, options);
    if (!stage->transfer_function)
      return CLI_FAILED;
  } else if (render_options_given(options, OPTION_OPACITY_MODEL)) {
    cli_warning("a preset states extinction: --opacity-model has no effect");
  }
  return CLI_DONE;
}

int stage_read(Stage *stage, const RenderOptions *options) {
  const double start = cli_seconds();
  const CliVtk *vtk = cli_vtk();
  if (!vtk)
    return CLI_FAILED;
  const char *array = NULL;
  TetcastDatasetDesc desc = vtk->dataset_desc_default();
  render_option_dataset(options->block, options->time, options->merge_tolerance, &desc);
  desc.subdivision = (int)options->subdivide;
  TetcastStatus status = vtk->dataset_read(stage->context, options->input, &desc, &stage->dataset);
  if (status == TETCAST_OK)
    status = vtk->dataset_field(stage->dataset, options->array, &stage->field, &array);
  if (status == TETCAST_OK) {
    stage->array = cli_duplicate(array);
    status = vtk->dataset_mesh(stage->dataset, &stage->mesh);
  }
  stage->read_seconds = cli_seconds() - start;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

static TetcastStatus create_volume(Stage *stage, const RenderOptions *options) {
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = (TetcastTraversal)options->traversal;
  desc.progress = cli_progress("preparing");
  TetcastStatus status = tetcast_volume_create(stage->context, stage->mesh, &desc, &stage->volume);
  cli_progress_clear();
  if (status == TETCAST_OK)
    status = tetcast_volume_set_field(stage->volume, stage->field);
  if (status == TETCAST_OK)
    tetcast_volume_info(stage->volume, &stage->info);
  return status;
}

static TetcastStatus create_scene(Stage *stage, const RenderOptions *options) {
  TetcastStatus status = TETCAST_OK;
  if (!stage->transfer_function) {
    const double *range = render_options_given(options, OPTION_RANGE) ? options->range : stage->info.field_range;
    const char *preset = render_options_given(options, OPTION_PRESET) ? options->preset : "viridis";
    status = tetcast_transfer_function_create_preset(stage->context, stage->volume, preset, range[0], range[1],
                                                     &stage->transfer_function);
  }
  if (status == TETCAST_OK)
    status = tetcast_scene_create(stage->context, stage->volume, &stage->scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(stage->scene, stage->transfer_function);
  return status;
}

int stage_prepare(Stage *stage, const RenderOptions *options) {
  const double start = cli_seconds();
  cli_interrupt_hold(true);
  TetcastStatus status = create_volume(stage, options);
  if (status != TETCAST_OK)
    return cli_failed(status);
  if (stage->info.field_nonfinite > 0)
    cli_warning("array %s: %lld values are NaN or infinite; the cells they touch are transparent", stage->array,
                (long long)stage->info.field_nonfinite);
  if (!view_complete(options, stage->info.bounds, &stage->camera))
    return CLI_FAILED;
  status = create_scene(stage, options);
  stage->prepare_seconds = cli_seconds() - start;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

void stage_drop_dataset(Stage *stage) {
  tetcast_field_destroy(&stage->field);
  tetcast_mesh_destroy(&stage->mesh);
  if (stage->dataset)
    cli_vtk()->dataset_destroy(&stage->dataset);
}

void stage_release(Stage *stage) {
  tetcast_scene_destroy(&stage->scene);
  tetcast_transfer_function_destroy(&stage->transfer_function);
  tetcast_volume_destroy(&stage->volume);
  stage_drop_dataset(stage);
  tetcast_context_destroy(&stage->context);
  free(stage->array);
}
