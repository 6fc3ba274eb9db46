/* SPDX-License-Identifier: Apache-2.0 */
#include "stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "clip.h"
#include "json.h"
#include "preset_file.h"
#include "preset_name.h"
#include "progress.h"
#include "surfaces.h"
#include "view.h"

int stage_begin(Stage *stage, const RenderOptions *options) {
  stage->context = cli_context_create((int)options->threads);
  if (!stage->context)
    return CLI_FAILED;
  if (render_options_given(options, OPTION_TRANSFER)) {
    stage->transfer_function = transfer_file_load(stage->context, options, &stage->rows);
    if (!stage->transfer_function)
      return CLI_FAILED;
    if (stage->rows.count > 0 && options->command == COMMAND_CONVERGE) {
      cli_error("--transfer: one with rows is for render only, as the integrators that are compared know none");
      return CLI_FAILED;
    }
    return cli_verdict(CLI_DONE);
  }
  if (render_options_given(options, OPTION_OPACITY_MODEL))
    cli_warning("a preset states extinction: --opacity-model has no effect");
  if (!render_options_direct(options) && preset_name_is_file(render_options_preset(options))) {
    stage->preset = preset_file_load(stage->context, options->preset);
    if (!stage->preset)
      return CLI_FAILED;
  }
  return cli_verdict(CLI_DONE);
}

/* Tells which array is drawn if none was named and there are several. */
static void tell_choice(const Stage *stage) {
  TetcastDatasetArray array, chosen = {.association = TETCAST_POINT};
  char *others = NULL;
  int count = 0;
  for (int i = 0; cli_vtk()->dataset_array(stage->dataset, i, &array); i++) {
    if (!strcmp(array.selector, stage->array)) {
      chosen = array;
      continue;
    }
    if (++count > 8) /* more of them would make the line unreadable */
      continue;
    char *longer = cli_print("%s%s%s", others ? others : "", others ? ", " : "", count == 8 ? "…" : array.selector);
    free(others);
    others = longer;
  }
  if (others)
    cli_note("draws %s array %s; --array chooses another: %s", chosen.association == TETCAST_CELL ? "cell" : "point",
             stage->array, others);
  else
    cli_note("draws %s array %s, the only one", chosen.association == TETCAST_CELL ? "cell" : "point", stage->array);
  free(others);
}

/* The one array that is asked for; NULL: the default, or several. That of the step before is not chosen anew. */
static const char *only_array(const Stage *stage, const RenderOptions *options) {
  const char *extinction = options->extinction, *emission = options->emission;
  if (!render_options_direct(options))
    return stage->array ? stage->array : options->array;
  if (extinction && emission)
    return strcmp(extinction, emission) == 0 ? extinction : NULL;
  return extinction ? extinction : emission;
}

/* Which of several files is asked for, of which each is a step; false after a message. */
static bool choose_file(const RenderOptions *options, const int64_t *step, int64_t asked, int64_t *file) {
  *file = step ? *step : asked < 0 ? asked + options->input_count : asked;
  if (*file >= 0 && *file < options->input_count)
    return true;
  cli_error("--time %s: there are %d files: steps 0 to %d", options->time, options->input_count,
            options->input_count - 1);
  return false;
}

/* What may have been meant where no array has the name, or the name before its last colon; for free(). */
static char *guess_array(const TetcastDataset *dataset, const char *selector) {
  const char *colon = strrchr(selector, ':');
  const size_t base = colon ? (size_t)(colon - selector) : strlen(selector);
  char *word = cli_print("%.*s", (int)base, selector);
  CliGuess guess = {.word = word}, whole = {.word = selector};
  TetcastDatasetArray array;
  bool known = false;
  for (int i = 0, read = 0; !known; i++) {
    const bool is_read = cli_vtk()->dataset_array(dataset, i, &array);
    const char *name = is_read ? array.name : cli_vtk()->dataset_unread(dataset, i - read);
    read += is_read;
    if (!name)
      break;
    known = !strcmp(name, word) || !strcmp(name, selector);
    cli_guess(&guess, name);
    cli_guess(&whole, name);
  }
  char *text = known ? cli_duplicate("") : cli_guess_text(guess.best ? &guess : &whole);
  free(word);
  return text;
}

/* Whether numbers of materials would be drawn as such: unless something is said that takes them for quantities. */
static bool may_be_labels(const RenderOptions *options) {
  return !render_options_given(options, OPTION_TRANSFER) && !render_options_given(options, OPTION_RANGE) &&
         !render_options_given(options, OPTION_LOG) && !render_options_given(options, OPTION_CENTRE) &&
         !render_options_given(options, OPTION_PRESET) && !options->cell_to_point &&
         !render_options_surfaces(options) && render_options_blend(options) == TETCAST_BLEND_COMPOSITE;
}

/* The dataset and its field or coefficients; `step` NULL: the one that the options name. */
static int read_field(Stage *stage, const RenderOptions *options, const int64_t *step) {
  const double start = cli_seconds();
  const CliVtk *vtk = cli_vtk();
  const char *array = NULL;
  TetcastDatasetDesc desc = vtk->dataset_desc_default();
  render_option_dataset(options->block, options->time, options->merge_tolerance, &desc);
  desc.subdivision = (int)options->subdivide;
  desc.cell_to_point = options->cell_to_point;
  desc.no_displacement = options->no_displacement;
  memcpy(desc.stretch, options->stretch, sizeof desc.stretch);
  desc.sources = options->matrix != NULL;
  desc.only = stage->rows.second ? NULL : only_array(stage, options);
  const char *path = stage->path ? stage->path : options->input;
  int64_t file = 0;
  if (stage->path) { /* which has been chosen by block and time */
    desc.part = true;
    desc.block = NULL;
    desc.step = 0;
    desc.time = NAN;
  } else if (options->inputs) {
    if (!choose_file(options, step, desc.step, &file))
      return CLI_FAILED;
    path = options->inputs[file];
    desc.step = 0;
  } else if (step) {
    desc.step = *step;
    desc.time = NAN;
  }
  TetcastStatus status = vtk->dataset_read(stage->context, path, &desc, &stage->dataset);
  const char *label = NULL;
  if (status == TETCAST_OK && stage->path && !vtk->dataset_cell_type(stage->dataset, 0, NULL, NULL))
    return CLI_DONE; /* a part without cells */
  if (status == TETCAST_OK && !stage->array && !stage->uniform && !options->array && !render_options_direct(options))
    stage->uniform = matter_wanted(stage->dataset, &label);
  if (status == TETCAST_OK)
    stage->step = options->inputs ? file : vtk->dataset_step(stage->dataset);
  if (status == TETCAST_OK && render_options_direct(options)) {
    if (!coefficients_read(stage->dataset, options, &stage->coefficients))
      return CLI_FAILED;
  } else if (status == TETCAST_OK && stage->uniform && !stage->array && !label) {
    cli_warning("%s: has no arrays: drawn as uniform matter", options->input);
  } else if (status == TETCAST_OK) {
    if (label)
      cli_warning("%s: has no arrays but labels: drawn as uniform matter in the colours of '%s'", options->input,
                  label);
    const char *selector = stage->array ? stage->array : options->array ? options->array : label;
    char *hint = options->array ? guess_array(stage->dataset, options->array) : NULL;
    const bool chosen = stage->path && stage->array; /* by another part, which has it */
    cli_set_hint(chosen ? "; what it has is transparent" : hint);
    cli_set_lenient(chosen);
    status = vtk->dataset_field(stage->dataset, selector, &stage->field, &array);
    cli_set_lenient(false);
    cli_set_hint(NULL);
    free(hint);
    if (chosen && status == TETCAST_ERROR_ARGUMENT)
      return CLI_DONE;
    if (status == TETCAST_OK && !stage->array) {
      stage->array = cli_duplicate(array);
      if (!options->array)
        tell_choice(stage);
      if (!label && may_be_labels(options))
        stage->uniform = matter_is_label(stage->dataset, stage->array, stage->field);
    }
  }
  if (status == TETCAST_OK && stage->rows.second) {
    status = vtk->dataset_field(stage->dataset, stage->rows.second, &stage->second, &array);
    if (status == TETCAST_OK && tetcast_field_association(stage->second) != TETCAST_CELL) {
      cli_error("%s: second: '%s' is an array of points; expected one of cells, or \"gradient\"",
                options->transfer ? options->transfer : options->scene, stage->rows.second);
      return CLI_FAILED;
    }
  }
  stage->read_seconds = cli_seconds() - start;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

static int read_dataset(Stage *stage, const RenderOptions *options, const int64_t *step) {
  if (!cli_vtk())
    return CLI_FAILED;
  const int code = read_field(stage, options, step);
  if (code != CLI_DONE)
    return code;
  const double start = cli_seconds();
  TetcastStatus status = cli_vtk()->dataset_mesh(stage->dataset, &stage->mesh);
  if (status == TETCAST_OK && stage->uniform && !stage->array && tetcast_mesh_tetrahedron_count(stage->mesh) > 0)
    status = matter_field(stage->context, stage->mesh, &stage->field);
  stage->read_seconds += cli_seconds() - start;
  return status == TETCAST_OK ? cli_verdict(CLI_DONE) : cli_failed(status);
}

int stage_read(Stage *stage, const RenderOptions *options) {
  return read_dataset(stage, options, NULL);
}

int stage_read_step(Stage *stage, const RenderOptions *options, int64_t step) {
  if (stage->mesh && stage->step == step)
    return CLI_DONE;
  stage_drop_dataset(stage);
  return read_dataset(stage, options, &step);
}

static double mean_of(const TetcastField *field) {
  const int64_t count = tetcast_field_values(field).count;
  double sum = 0, finite = 0;
  for (int64_t i = 0; i < count; i++) {
    const double value = tetcast_field_value(field, i);
    if (!isfinite(value))
      continue;
    finite++;
    sum += (value - sum) / finite; /* which can't overflow where the values' own differences don't */
  }
  return sum;
}

int stage_read_values(Stage *stage, const RenderOptions *options, int64_t step, StageValues *values) {
  if (stage->uniform && !stage->array) { /* which is 1 everywhere, in every step */
    *values = (StageValues){.count = 1, .range = {1, 1}, .mean = 1};
    return cli_verdict(CLI_DONE);
  }
  if (!stage->field || stage->step != step) {
    stage_drop_dataset(stage);
    const int code = read_field(stage, options, &step);
    if (code != CLI_DONE)
      return code;
  }
  tetcast_field_range(stage->field, values->range, &values->nonfinite);
  values->count = tetcast_field_values(stage->field).count;
  values->mean = mean_of(stage->field);
  return cli_verdict(CLI_DONE);
}

/* 64 bits that two meshes share by a chance of 2^-64, unless they have the same numbers. */
static uint64_t mix(uint64_t hash, const TetcastArray *array, size_t row) {
  for (int64_t i = 0; i < array->count; i++)
    for (size_t k = 0; k < row; k += sizeof(uint32_t)) {
      uint32_t word;
      memcpy(&word, (const char *)array->data + i * array->stride + k, sizeof word);
      hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
  return hash ^ (uint64_t)array->count;
}

/* Of the mesh, and of the bounds that its volume is made with. */
static uint64_t fingerprint_of(const TetcastMesh *mesh, const double *bounds) {
  const TetcastArray vertices = tetcast_mesh_vertices(mesh), tetrahedra = tetcast_mesh_tetrahedra(mesh);
  const bool wide = tetrahedra.type == TETCAST_TYPE_INT64 || tetrahedra.type == TETCAST_TYPE_UINT64;
  const TetcastArray box = {.data = bounds, .count = bounds ? 1 : 0};
  uint64_t hash = mix(1, &box, 6 * sizeof(double));
  hash = mix(hash, &vertices, 3 * (vertices.type == TETCAST_TYPE_FLOAT64 ? sizeof(double) : sizeof(float)));
  return mix(hash, &tetrahedra, 4 * (wide ? sizeof(int64_t) : sizeof(int32_t)));
}

static TetcastStatus create_volume(Stage *stage, const RenderOptions *options) {
  const uint64_t fingerprint = stage->of_series ? fingerprint_of(stage->mesh, stage->bounds) : 0;
  if (stage->volume && stage->fingerprint == fingerprint)
    return TETCAST_OK;
  tetcast_scene_destroy(&stage->scene);
  tetcast_volume_destroy(&stage->volume);
  stage->fingerprint = fingerprint;
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.traversal = (TetcastTraversal)options->traversal;
  desc.bounds = stage->bounds;
  desc.progress = cli_progress("preparing");
  TetcastStatus status = tetcast_volume_create(stage->context, stage->mesh, &desc, &stage->volume);
  cli_progress_clear();
  return status;
}

/* Whether the preset, a file's, states opacities, and not just colours. */
static bool states_opacities(const Stage *stage) {
  int64_t knots = 2;
  if (stage->preset)
    tetcast_transfer_function_extinction(stage->preset, &knots);
  return knots > 2;
}

/* Whether the transfer function is found from the distribution of values. */
static bool is_designed(const Stage *stage, const RenderOptions *options) {
  if (render_options_direct(options) ||
      (!stage->whole && stage->range[0] == stage->range[1])) /* there is nothing to tell apart */
    return false;
  if (stage->transfer_function || stage->uniform || states_opacities(stage) ||
      render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return false;
  const RangeKind kind = render_options_range(options);
  return (kind != RANGE_FIXED && kind != RANGE_QUANTILES) || options->logarithmic ||
         render_options_given(options, OPTION_CENTRE);
}

/* Whether the values have a logarithm, some of them at least. */
static bool check_logarithm(const Stage *stage) {
  const double *range = stage->whole ? stage->whole : stage->range;
  if (!(range[1] > 0))
    cli_error("--log: array %s has values from %g to %g, and only those above 0 have a logarithm", stage->array,
              range[0], range[1]);
  else if (range[0] < 0)
    cli_warning("--log: array %s has values down to %g, which have no logarithm: drawn as the least that has one",
                stage->array, range[0]);
  return range[1] > 0;
}

DesignDesc stage_design_desc(const Stage *stage, const RenderOptions *options) {
  const RangeKind kind = render_options_range(options);
  return (DesignDesc){.range = kind == RANGE_FIXED       ? options->range
                               : kind == RANGE_QUANTILES ? stage->quantiles
                                                         : NULL,
                      .whole = stage->others ? stage->range : stage->whole,
                      .statistics = stage->others ? stage->others->statistics : NULL,
                      .user = stage->others ? stage->others->ranks : NULL,
                      .logarithmic = options->logarithmic,
                      .diverging = !stage->preset &&
                                   tetcast_preset_kind(render_options_preset(options)) == TETCAST_PRESET_DIVERGING,
                      .center = render_options_given(options, OPTION_CENTRE) ? &options->centre : NULL};
}

/* Finds the values at shares of the volume, and the transfer function but for its colours, while the field is there. */
static int find_design(Stage *stage, const RenderOptions *options, bool designed) {
  const StageOthers *others = stage->others;
  const double *found = stage->quantiles;
  TetcastStatus status = TETCAST_OK;
  if (render_options_range(options) == RANGE_QUANTILES) {
    status = others ? others->quantiles(others->ranks, stage->range, options->range, 2, stage->quantiles)
                    : tetcast_statistics_quantiles(stage->context, stage->mesh, stage->field, options->range, 2,
                                                   stage->quantiles);
    if (status == TETCAST_OK && options->logarithmic && !stage->transfer_function && !(found[0] > 0)) {
      cli_error("--log: the --range of %g%% to %g%% goes from %g to %g in array %s, and only values above 0 have a "
                "logarithm",
                100 * options->range[0], 100 * options->range[1], found[0], found[1], stage->array);
      return CLI_FAILED;
    }
  }
  if (status == TETCAST_OK && designed) {
    const DesignDesc desc = stage_design_desc(stage, options);
    status = design_find(stage->context, stage->mesh, stage->field, &desc, &stage->design);
  }
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* The colours of a design over [0, 1]: of two sides where values have two. */
static TetcastStatus create_map(const Stage *stage, const RenderOptions *options, const Design *design,
                                TetcastTransferFunction **map) {
  const bool diverging = design->map.diverging && !render_options_given(options, OPTION_PRESET);
  return tetcast_transfer_function_create_preset(stage->context,
                                                 diverging ? "coolwarm" : render_options_preset(options), 0, 1, 1, map);
}

TetcastStatus stage_shade_design(const Stage *stage, const RenderOptions *options, const Design *design,
                                 const char *preset, TetcastTransferFunction **transfer_function) {
  const RenderOptions nothing = render_options_default(COMMAND_RENDER);
  TetcastCamera first;
  TetcastTransferFunction *map = NULL, *shape = NULL;
  const StageOthers *others = stage->others;
  if (others && !others->first) /* which knows the design */
    return others->scale(others->ranks, NULL, NULL, transfer_function);
  view_complete(&nothing, stage->info.bounds, &first);
  TetcastStatus status = TETCAST_OK;
  if (preset)
    status = tetcast_transfer_function_create_preset(stage->context, preset, 0, 1, 1, &map);
  else if (!stage->preset)
    status = create_map(stage, options, design, &map);
  if (status == TETCAST_OK)
    status = design_shape(stage->context, design, map ? map : stage->preset, &shape);
  if (others) /* whatever the status is, as they wait */
    status = others->scale(others->ranks, shape, &first, transfer_function);
  else if (status == TETCAST_OK)
    status = tetcast_scene_scale_transfer_function(stage->scene, shape, &first, 0.5, transfer_function);
  tetcast_transfer_function_destroy(&map);
  tetcast_transfer_function_destroy(&shape);
  return status;
}

TetcastStatus stage_preset(const Stage *stage, const RenderOptions *options, const double range[2],
                           TetcastTransferFunction **transfer_function) {
  const StageOthers *others = stage->others;
  if (others)
    return others->fit(others->ranks, stage->preset, render_options_preset(options), range, transfer_function);
  return stage->preset
             ? tetcast_scene_fit_transfer_function(stage->scene, stage->preset, range[0], range[1], transfer_function)
             : tetcast_scene_create_preset(stage->scene, render_options_preset(options), range[0], range[1],
                                           transfer_function);
}

/* The transfer function of a preset, or of the colours of labels, all of which have the same extinction. */
static TetcastStatus make_transfer_function(Stage *stage, const RenderOptions *options, const double range[2]) {
  const bool labelled = stage->uniform && stage->array;
  TetcastTransferFunction **result = &stage->transfer_function, *map = NULL;
  if (!labelled)
    return stage_preset(stage, options, range, result);
  TetcastStatus status = TETCAST_OK;
  if (options->preset || stage->matter.count == 0)
    status = stage_preset(stage, options, range, &map);
  if (status == TETCAST_OK)
    status = matter_shade(stage->context, &stage->matter, map, &options->labels, result);
  tetcast_transfer_function_destroy(&map);
  return status;
}

/* Gives a scene the stage's transfer function, and its surfaces. */
static TetcastStatus show(const Stage *stage, const RenderOptions *options, TetcastScene *scene) {
  TetcastStatus status = TETCAST_OK;
  if (stage->rows.count == 0) /* rows the scene has by now */
    status = render_options_surfaces_alone(options)
                 ? surfaces_set_colors(stage->context, scene, stage->transfer_function)
                 : tetcast_scene_set_transfer_function(scene, stage->transfer_function);
  return status == TETCAST_OK ? surfaces_set(scene, options, stage->transfer_function, stage->range) : status;
}

static TetcastStatus set_transfer_function(Stage *stage, const RenderOptions *options, const double *range) {
  TetcastStatus status = TETCAST_OK;
  if (!stage->transfer_function) {
    if (render_options_range(options) == RANGE_FIXED)
      range = options->range;
    else if (render_options_range(options) == RANGE_QUANTILES)
      range = stage->quantiles;
    memcpy(stage->shown, range, sizeof stage->shown);
    if (stage->designed)
      memcpy(stage->shown, stage->design.map.range, sizeof stage->shown);
    status = stage->designed ? stage_shade_design(stage, options, &stage->design, NULL, &stage->transfer_function)
                             : make_transfer_function(stage, options, range);
  }
  TetcastScene *scene = stage->scene;
  for (int i = 0; status == TETCAST_OK; i++) {
    if (stage->others)
      scene = stage->others->scene(stage->others->ranks, i);
    if (!scene || (i > 0 && !stage->others))
      break;
    status = show(stage, options, scene);
  }
  return status;
}

int stage_check_field(const Stage *stage, const RenderOptions *options) {
  const bool of_cells = stage->field && tetcast_field_association(stage->field) == TETCAST_CELL;
  const char *array = stage->array ? stage->array : "of the mesh";
  if (render_options_given(options, OPTION_ISOSURFACE) && of_cells)
    cli_error("--isosurface: the array %s has a value for each cell; --cell-to-point makes one for points of it",
              array);
  else if (stage->rows.count > 0 && of_cells)
    cli_error(
        "--transfer: one with rows needs an array of points, and %s has a value for each cell; --cell-to-point makes "
        "one for points of it",
        stage->array ? stage->array : "the mesh's");
  else if (render_options_lit(options) && of_cells)
    cli_error("--shade volume: the array %s has a value for each cell, so no gradient; --cell-to-point makes one for "
              "points of it",
              array);
  else if (options->labels.count > 0 && !(stage->uniform && stage->array))
    cli_error("--label: the values of %s are not numbers of materials or blocks: whole ones of cells, at most 256",
              stage->array ? stage->array : "the mesh");
  else
    return CLI_DONE;
  return CLI_FAILED;
}

/* The extinction of what has labels, and these; of a part, these alone. */
static TetcastStatus measure_matter(Stage *stage) {
  if (!stage->bounds)
    return matter_measure(stage->context, stage->volume, stage->mesh, stage->field, &stage->matter);
  matter_collect(stage->field, &stage->matter);
  return TETCAST_OK;
}

TetcastStatus stage_prepare_scene(Stage *stage, const RenderOptions *options) {
  TetcastStatus status = create_volume(stage, options);
  if (status == TETCAST_OK && !stage->scene)
    status = tetcast_scene_create(stage->context, stage->volume, &stage->scene);
  if (status == TETCAST_OK && stage->uniform && stage->array)
    status = measure_matter(stage);
  if (status == TETCAST_OK)
    status = stage->field ? tetcast_scene_set_field(stage->scene, stage->field)
                          : coefficients_set(stage->scene, options, &stage->coefficients);
  if (status == TETCAST_OK && stage->rows.count > 0)
    status = tetcast_scene_set_transfer_rows(stage->scene, stage->rows.row, stage->rows.count, stage->second);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_blend(stage->scene, render_options_blend(options));
  if (status == TETCAST_OK)
    status = clip_scene(stage->scene, options);
  return status;
}

int stage_complete(Stage *stage, const RenderOptions *options) {
  if (!render_options_direct(options) && options->logarithmic && render_options_range(options) != RANGE_FIXED &&
      !check_logarithm(stage))
    return CLI_FAILED;
  if (states_opacities(stage) && (options->logarithmic || render_options_given(options, OPTION_CENTRE))) {
    cli_error("--preset %s: states opacities at places of its own, which neither --log nor --centre moves",
              options->preset);
    return CLI_FAILED;
  }
  const bool designed = is_designed(stage, options);
  stage->designed = designed || (stage->designed && stage->transfer_function); /* which an earlier step has left */
  const StageOthers *others = stage->others;
  int code = CLI_DONE;
  if (!render_options_direct(options) && (!others || others->first))
    code = find_design(stage, options, designed);
  if (others)
    code = others->meet(others->ranks, code);
  if (code != CLI_DONE)
    return code;
  if (stage->nonfinite > 0)
    cli_warning("array %s: %lld values are NaN or infinite; the cells they touch are transparent", stage->array,
                (long long)stage->nonfinite);
  if (view_complete(options, stage->info.bounds, &stage->camera))
    return cli_verdict(CLI_DONE);
  return options->scene ? CLI_FAILED : CLI_USAGE; /* as for a camera that is wrong by itself */
}

int stage_prepare(Stage *stage, const RenderOptions *options) {
  const double start = cli_seconds();
  int code = stage_check_field(stage, options);
  if (code != CLI_DONE)
    return code;
  cli_interrupt_hold(true);
  const TetcastStatus status = stage_prepare_scene(stage, options);
  if (status != TETCAST_OK)
    return cli_failed(status);
  tetcast_volume_info(stage->volume, &stage->info);
  stage->nonfinite = 0;
  if (stage->field)
    tetcast_field_range(stage->field, stage->range, &stage->nonfinite);
  code = stage_complete(stage, options);
  stage->prepare_seconds = cli_seconds() - start;
  return code;
}

int stage_shade(Stage *stage, const RenderOptions *options, const double range[2]) {
  const double start = cli_seconds();
  const TetcastStatus status =
      render_options_direct(options) ? TETCAST_OK : set_transfer_function(stage, options, range);
  stage->prepare_seconds += cli_seconds() - start;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

/* What the colours of a picture are, NULL: there is no single map of them. */
static json_t *transfer_choice(const Stage *stage, const RenderOptions *options) {
  if (!stage->transfer_function || stage->rows.count > 0)
    return NULL;
  const bool labelled = stage->uniform && stage->array;
  json_t *transfer = json_object();
  const char *reason = render_options_given(options, OPTION_TRANSFER) ? "the transfer function was given"
                       : stage->designed                              ? stage->design.reason
                       : labelled ? "numbers of materials or the like: a colour for each"
                                  : "the range that was asked for, or that of all values";
  if (!render_options_given(options, OPTION_TRANSFER) && !labelled) {
    const bool diverging = stage->designed && stage->design.map.diverging;
    const bool chosen = diverging && !render_options_given(options, OPTION_PRESET);
    json_object_set_new(transfer, "preset", cli_json_text(chosen ? "coolwarm" : render_options_preset(options)));
    json_object_set_new(transfer, "range", cli_json_array(stage->shown, 2));
    json_object_set_new(transfer, "scale",
                        json_string(!stage->designed                ? "linear"
                                    : stage->design.map.logarithmic ? "logarithmic"
                                    : diverging                     ? "diverging"
                                                                    : "linear"));
  }
  json_object_set_new(transfer, "why", json_string(reason));
  return transfer;
}

json_t *stage_choices(const Stage *stage, const RenderOptions *options) {
  json_t *choices = json_object(), *view = json_object(), *transfer = transfer_choice(stage, options);
  json_object_set_new(choices, "array", stage->array ? cli_json_text(stage->array) : json_null());
  json_object_set_new(choices, "transfer", transfer ? transfer : json_null());
  json_object_set_new(view, "eye", cli_json_array(stage->camera.eye, 3));
  json_object_set_new(view, "target", cli_json_array(stage->camera.target, 3));
  json_object_set_new(view, "up", cli_json_array(stage->camera.up, 3));
  json_object_set_new(view, "why", json_string(view_reason(options, stage->info.bounds)));
  json_object_set_new(choices, "view", view);
  return choices;
}

void stage_drop_dataset(Stage *stage) {
  tetcast_field_destroy(&stage->field);
  tetcast_field_destroy(&stage->second);
  coefficients_release(&stage->coefficients);
  tetcast_mesh_destroy(&stage->mesh);
  if (stage->dataset)
    cli_vtk()->dataset_destroy(&stage->dataset);
}

void stage_release(Stage *stage) {
  tetcast_scene_destroy(&stage->scene);
  transfer_file_release(&stage->rows);
  tetcast_transfer_function_destroy(&stage->transfer_function);
  tetcast_transfer_function_destroy(&stage->preset);
  tetcast_volume_destroy(&stage->volume);
  stage_drop_dataset(stage);
  tetcast_context_destroy(&stage->context);
  matter_release(&stage->matter);
  free(stage->array);
}
