/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <tetcast/tetcast.h>

#include "adapter.h"
#include "cli.h"
#include "file.h"
#include "progress.h"
#include "render_options.h"
#include "scene_file.h"
#include "stats.h"
#include "transfer_file.h"
#include "view.h"

/* A run of the command; each step returns an exit code. */
typedef struct Run {
  RenderOptions options;
  const CliImage *image;
  TetcastImageDesc image_desc;
  TetcastContext *context;
  TetcastVolume *volume;
  TetcastTransferFunction *transfer_function;
  TetcastScene *scene;
  TetcastFrame *frame;
  TetcastCamera camera;
  char *array; /* what was read, as --array would name it */
  RunStats stats;
} Run;

static bool has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length > tail && !strcasecmp(path + length - tail, extension);
}

/* Whether the pixels will be floating-point, which hold no background. */
static bool floating_output(const RenderOptions *options) {
  if (options->pixel_type != TETCAST_PIXEL_DEFAULT)
    return options->pixel_type >= TETCAST_PIXEL_HALF;
  return has_extension(options->output, ".exr") || has_extension(options->output, ".tif") ||
         has_extension(options->output, ".tiff") || has_extension(options->output, ".hdr");
}

/* The name of the input with .png, in the current folder. */
static char *default_output(const char *input) {
  const char *name = cli_path_name(input);
  const char *dot = strrchr(name, '.');
  return cli_print("%.*s.png", (int)(dot && dot != name ? (size_t)(dot - name) : strlen(name)), name);
}

/* All that can be known to fail before the mesh is read. */
static int check(Run *run) {
  RenderOptions *options = &run->options;
  if (!options->output)
    options->output = default_output(options->input);
  run->context = cli_context_create((int)options->threads);
  if (!run->context)
    return CLI_FAILED;
  if (render_options_given(options, OPTION_TRANSFER)) {
    run->transfer_function = transfer_file_load(run->context, options);
    if (!run->transfer_function)
      return CLI_FAILED;
  } else if (render_options_given(options, OPTION_OPACITY_MODEL)) {
    cli_warning("a preset states extinction: --opacity-model has no effect");
  }
  if ((options->stats && !cli_file_check(options->stats)) ||
      (options->save_scene && !cli_file_check(options->save_scene)))
    return CLI_FAILED;
  if (options->source >> OPTION_BACKGROUND & 1 && floating_output(options)) /* on the command line, that is */
    cli_warning("--background has no effect: floating-point pixels hold the picture without background");
  run->image = cli_image();
  if (!run->image)
    return CLI_FAILED;
  run->image_desc = run->image->image_desc_default();
  run->image_desc.pixel_type = (TetcastPixelType)options->pixel_type;
  memcpy(run->image_desc.background, options->background, sizeof options->background);
  const TetcastStatus status = run->image->image_check(run->context, options->output, &run->image_desc);
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

static void warn_about_field(const Run *run) {
  const TetcastVolumeInfo *info = &run->stats.volume;
  if (info->field_nonfinite > 0)
    cli_warning("array %s: %lld values are NaN or infinite; the cells they touch are transparent", run->array,
                (long long)info->field_nonfinite);
}

static TetcastStatus prepare(Run *run, const TetcastMesh *mesh, const TetcastField *field) {
  const double start = cli_seconds();
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = (TetcastTraversal)run->options.traversal;
  desc.progress = cli_progress("preparing");
  TetcastStatus status = tetcast_volume_create(run->context, mesh, &desc, &run->volume);
  cli_progress_clear();
  if (status == TETCAST_OK)
    status = tetcast_volume_set_field(run->volume, field);
  if (status == TETCAST_OK)
    tetcast_volume_info(run->volume, &run->stats.volume);
  run->stats.prepare_seconds = cli_seconds() - start;
  return status;
}

/* Reads the input and prepares the volume, after which nothing of the dataset stays in memory. */
static int load(Run *run) {
  const double start = cli_seconds();
  const CliVtk *vtk = cli_vtk();
  if (!vtk)
    return CLI_FAILED;
  TetcastDataset *dataset = NULL;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  const char *array = NULL;
  TetcastStatus status = vtk->dataset_read(run->context, run->options.input, &dataset);
  if (status == TETCAST_OK)
    status = vtk->dataset_field(dataset, run->options.array, &field, &array);
  if (status == TETCAST_OK) {
    run->array = cli_duplicate(array);
    status = vtk->dataset_mesh(dataset, &mesh);
  }
  run->stats.read_seconds = cli_seconds() - start;
  cli_interrupt_hold(true);
  if (status == TETCAST_OK)
    status = prepare(run, mesh, field);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  vtk->dataset_destroy(&dataset);
  if (status != TETCAST_OK)
    return cli_failed(status);
  warn_about_field(run);
  return CLI_DONE;
}

static int set_scene(Run *run) {
  const RenderOptions *options = &run->options;
  const double start = cli_seconds();
  TetcastStatus status = TETCAST_OK;
  if (!run->transfer_function) {
    const double *range = render_options_given(options, OPTION_RANGE) ? options->range : run->stats.volume.field_range;
    const char *preset = render_options_given(options, OPTION_PRESET) ? options->preset : "viridis";
    status = tetcast_transfer_function_create_preset(run->context, run->volume, preset, range[0], range[1],
                                                     &run->transfer_function);
  }
  if (status == TETCAST_OK)
    status = tetcast_scene_create(run->context, run->volume, &run->scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(run->scene, run->transfer_function);
  run->stats.prepare_seconds += cli_seconds() - start;

  if (status == TETCAST_OK) {
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = (int64_t)options->size[0];
    desc.height = (int64_t)options->size[1];
    desc.type = options->pixel_type == TETCAST_PIXEL_DOUBLE ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
    status = tetcast_frame_create(run->context, &desc, &run->frame);
  }
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

static int render(Run *run) {
  RunStats *stats = &run->stats;
  stats->threads = tetcast_context_threads(run->context);
  stats->repeats = (int)run->options.repeat;
  stats->render_seconds = cli_allocate(sizeof(double) * (size_t)stats->repeats);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.samples = (int)run->options.samples;
  if (run->options.integrator)
    render_option_integrator(run->options.integrator, &desc.integrator, &desc.integrator_n);
  for (int i = 0; i < stats->repeats; i++) {
    const double start = cli_seconds();
    desc.progress = cli_progress("rendering");
    const TetcastStatus status = tetcast_scene_render(run->scene, &run->camera, &desc, run->frame, &stats->render);
    stats->render_seconds[i] = cli_seconds() - start;
    cli_progress_clear();
    if (status != TETCAST_OK || cli_interrupted())
      return cli_failed(status);
  }
  if (stats->render.lost > 0)
    cli_warning(
        "%lld of %lld rays were lost on their way through the mesh: the picture has faults there, please report this",
        (long long)stats->render.lost, (long long)stats->render.rays);
  return CLI_DONE;
}

static int write_files(Run *run) {
  const RenderOptions *options = &run->options;
  const double start = cli_seconds();
  const TetcastStatus status = run->image->image_write(run->context, options->output, run->frame, &run->image_desc);
  run->stats.write_seconds = cli_seconds() - start;
  if (status != TETCAST_OK)
    return cli_failed(status);
  if (options->save_scene && !scene_file_write(options, run->array, &run->camera, run->transfer_function))
    return CLI_FAILED;
  if (options->stats && !stats_write(options->stats, &run->stats))
    return CLI_FAILED;
  return CLI_DONE;
}

static int perform(Run *run) {
  cli_interrupt_hold(true); /* checks put files in folders for a moment */
  int code = check(run);
  cli_interrupt_hold(false);
  if (cli_interrupted())
    code = CLI_FAILED;
  if (code == CLI_DONE)
    code = load(run);
  if (code == CLI_DONE && !view_complete(&run->options, run->stats.volume.bounds, &run->camera))
    code = CLI_FAILED;
  if (code == CLI_DONE)
    code = set_scene(run);
  if (code == CLI_DONE)
    code = render(run);
  if (code == CLI_DONE)
    code = write_files(run);
  return code;
}

int tetcast_cli_render(int argc, char **argv) {
  Run run = {.options = render_options_default()};
  int code = render_options_parse(&run.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(run.options.quiet);
    code = perform(&run);
  }
  tetcast_frame_destroy(&run.frame);
  tetcast_scene_destroy(&run.scene);
  tetcast_transfer_function_destroy(&run.transfer_function);
  tetcast_volume_destroy(&run.volume);
  tetcast_context_destroy(&run.context);
  free(run.stats.render_seconds);
  free(run.array);
  render_options_release(&run.options);
  if (cli_interrupted()) {
    fputs("tetcast: error: interrupted\n", stderr);
    return 128 + cli_interrupted();
  }
  return code;
}
