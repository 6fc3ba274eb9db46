/* SPDX-License-Identifier: Apache-2.0 */
/* tetcast cast: what rays gather, one by one, and the matrix of what they cross. */
#include <stdio.h>
#include <stdlib.h>

#include <tetcast/tetcast.h>

#include "cli.h"
#include "file.h"
#include "fileset.h"
#include "matrix.h"
#include "progress.h"
#include "ray_file.h"
#include "render_parse.h"
#include "stage.h"

typedef struct Cast {
  RenderOptions options;
  RayFile rays;
  Stage stage;
  /* Columns, and the memory of what is in them. */
  RayColumn *columns;
  int column_count;
  TetcastCastResult result;
} Cast;

/* All that can be known to fail before anything is read, and the rays. */
static int check(Cast *cast) {
  const RenderOptions *options = &cast->options;
  FileSet files = {0};
  fileset_add_options(&files, options);
  fileset_add(&files, "--output", options->output, true);
  const int code = fileset_check(&files, "cast");
  if (code >= 0)
    return code;
  const char *const outputs[] = {options->output, options->matrix};
  for (int i = 0; i < 2; i++) {
    if (outputs[i])
      cli_file_tidy(outputs[i]);
    if (outputs[i] && !cli_file_check(outputs[i]))
      return CLI_FAILED;
  }
  return ray_file_read(options->rays, &cast->rays) ? stage_begin(&cast->stage, options) : CLI_FAILED;
}

/* Memory for so many numbers a ray; each of them is a column, of these names. */
static double *add_columns(Cast *cast, const char *const *names, int count, int group) {
  double *numbers = cli_allocate((size_t)(cast->rays.count * count + 1) * sizeof *numbers);
  for (int i = 0; i < count; i++) {
    RayColumn *column = &cast->columns[cast->column_count++];
    *column = (RayColumn){.numbers = numbers + i, .stride = count};
    if (group < 0)
      snprintf(column->name, sizeof column->name, "%s", names[i]);
    else
      snprintf(column->name, sizeof column->name, "%s_%d", names[0], i);
  }
  return numbers;
}

/* Of each group its columns come next to each other. */
static void add_groups(Cast *cast, int groups) {
  static const char *const names[] = {"radiance", "optical_depth", "transmittance"};
  double **const numbers[] = {&cast->result.radiance, &cast->result.group_optical_depth, &cast->result.transmittance};
  const int first = cast->column_count;
  RayColumn *sorted = cli_allocate((size_t)(3 * groups) * sizeof *sorted);
  for (int i = 0; i < 3; i++)
    *numbers[i] = add_columns(cast, &names[i], groups, 0);
  for (int i = 0; i < 3 * groups; i++)
    sorted[i] = cast->columns[first + i % 3 * groups + i / 3];
  for (int i = 0; i < 3 * groups; i++)
    cast->columns[first + i] = sorted[i];
  free(sorted);
}

static void plan_columns(Cast *cast) {
  static const char *const color[] = {"red", "green", "blue", "alpha"}, *const depth = "optical_depth",
                           *const value = "value", *const length = "length", *const error = "error";
  const int groups = tetcast_scene_groups(cast->stage.scene);
  bool wants_length = false, wants_error = false;
  if (cast->options.channels)
    render_option_ray_channels(cast->options.channels, &wants_length, &wants_error);
  cast->columns = cli_allocate((size_t)(7 + 3 * groups) * sizeof *cast->columns);
  cast->result.color = add_columns(cast, color, 4, -1);
  if (render_options_blend(&cast->options) == TETCAST_BLEND_COMPOSITE)
    cast->result.optical_depth = add_columns(cast, &depth, 1, -1);
  else
    cast->result.value = add_columns(cast, &value, 1, -1);
  if (groups > 0)
    add_groups(cast, groups);
  if (wants_length)
    cast->result.length = add_columns(cast, &length, 1, -1);
  if (wants_error)
    cast->result.error = add_columns(cast, &error, 1, -1);
}

static int write_results(Cast *cast) {
  const RenderOptions *options = &cast->options;
  plan_columns(cast);
  TetcastCastDesc desc = tetcast_cast_desc_default();
  desc.isa = (TetcastIsa)options->isa;
  desc.progress = cli_progress("casting");
  const TetcastRays rays = ray_file_rays(&cast->rays);
  TetcastRenderStats stats;
  const TetcastStatus status = tetcast_scene_cast(cast->stage.scene, &rays, &desc, &cast->result, &stats);
  cli_progress_clear();
  if (status != TETCAST_OK)
    return cli_failed(status);
  if (stats.lost > 0)
    cli_warning("%lld rays were lost on their way through the mesh: please report this", (long long)stats.lost);
  const int code = cli_verdict(CLI_DONE);
  if (code != CLI_DONE)
    return code;
  return ray_file_write(options->output, cast->columns, cast->column_count, cast->rays.count) ? CLI_DONE : CLI_FAILED;
}

/* What the data has, if nothing was said. */
static Basis basis_of(const Cast *cast) {
  const Stage *stage = &cast->stage;
  if (render_options_given(&cast->options, OPTION_BASIS))
    return (Basis)cast->options.basis;
  const TetcastField *field = stage->field                               ? stage->field
                              : stage->coefficients.extinction_count > 0 ? stage->coefficients.extinction[0]
                                                                         : stage->coefficients.emission[0];
  return tetcast_field_association(field) == TETCAST_CELL ? BASIS_CELLS : BASIS_POINTS;
}

static int perform(Cast *cast) {
  cli_interrupt_hold(true); /* checks put files in folders for a moment */
  int code = check(cast);
  cli_interrupt_hold(false);
  if (code == CLI_DONE)
    code = stage_read(&cast->stage, &cast->options);
  if (code == CLI_DONE)
    code = stage_prepare(&cast->stage, &cast->options);
  if (code == CLI_DONE && cast->options.output)
    code = stage_shade(&cast->stage, &cast->options, cast->stage.range);
  if (code == CLI_DONE && cast->options.matrix)
    code = matrix_write(&cast->stage, &cast->options, basis_of(cast), &cast->rays);
  stage_drop_dataset(&cast->stage);
  if (code == CLI_DONE && cast->options.output)
    code = write_results(cast);
  return code;
}

static void release(Cast *cast) {
  double *const numbers[] = {cast->result.color,
                             cast->result.optical_depth,
                             cast->result.length,
                             cast->result.error,
                             cast->result.value,
                             cast->result.radiance,
                             cast->result.group_optical_depth,
                             cast->result.transmittance};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    free(numbers[i]);
  free(cast->columns);
  ray_file_release(&cast->rays);
  stage_release(&cast->stage);
  render_options_release(&cast->options);
}

int tetcast_cli_cast(int argc, char **argv) {
  Cast cast = {.options = render_options_default(COMMAND_CAST)};
  int code = render_options_parse(&cast.options, argc, argv);
  if (code < 0) {
    cli_set_quiet(cast.options.quiet);
    cli_set_strict(cast.options.strict);
    code = perform(&cast);
  }
  release(&cast);
  if (cli_interrupted()) {
    fputs("tetcast: error: interrupted\n", stderr);
    return 128 + cli_interrupted();
  }
  return code;
}
