/* SPDX-License-Identifier: Apache-2.0 */
#include "series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli.h"
#include "file.h"
#include "fileset.h"
#include "folder.h"
#include "progress.h"
#include "scene_file.h"
#include "sight.h"
#include "tour.h"
#include "writer.h"

typedef struct Series {
  Run *run;
  Tour tour;          /* of frames of one step, which then are counted in place of steps */
  int64_t count;      /* the number of steps in the file */
  int64_t begin, end; /* the steps to be rendered */
  int64_t todo, made; /* how many pictures there are to make, and how many of these are made */
  Writer writer;
  json_t *written; /* the entry of the picture that the writer writes */
  double *times;   /* [count]: the time of each step; NULL if the file has none */
  double range[2];
  int64_t densest; /* the step whose values are the largest on average */
  json_t *entries; /* the steps' entries in the statistics */
  TetcastCamera camera;
  int64_t loaded; /* the step that the volume is made of; -1 if there is none yet */
  bool held;      /* whether interruptions wait */
  bool shown;     /* whether some picture shows something */
  char *fault;    /* why the first picture shows nothing; NULL if it shows something */
  char label[64], place[32];
} Series;

/* ── names ── */

/* Where in a name the number goes: "##…" or "%4d", "%04d". Its length, 0: nowhere. */
static size_t find_number(const char *path, size_t *at, int *width) {
  const char *name = cli_path_name(path);
  for (const char *c = name; *c; c++) {
    const size_t hashes = strspn(c, "#");
    size_t length = 0;
    *width = 0;
    if (hashes >= 2) {
      *width = (int)(hashes < 64 ? hashes : 64);
      length = hashes;
    } else if (*c == '%') {
      const size_t digits = strspn(c + 1, "0123456789");
      if (digits <= 3 && c[1 + digits] == 'd') {
        length = digits + 2;
        *width = atoi(c + 1) < 64 ? atoi(c + 1) : 64;
      }
    }
    *at = (size_t)(c - path);
    if (length > 0)
      return length;
  }
  return 0;
}

static bool has_number(const RenderOptions *options) {
  size_t at;
  int width;
  return render_options_given(options, OPTION_OUTPUT) && find_number(options->output, &at, &width) > 0;
}

static bool is_all(const RenderOptions *options) {
  if (tour_of(options).count > 0)
    return true;
  return options->time ? !strcmp(options->time, "all") : has_number(options) || options->inputs;
}

bool series_wanted(const RenderOptions *options) {
  return is_all(options) || has_number(options) || render_options_range(options) == RANGE_SERIES;
}

char *series_name(const RenderOptions *options, int64_t step) {
  const char *output = options->output;
  size_t at;
  int width;
  const size_t length = find_number(output, &at, &width);
  if (length > 0)
    return cli_print("%.*s%0*lld%s", (int)at, output, width, (long long)step, output + at + length);
  if (!is_all(options))
    return cli_duplicate(output);
  if (options->inputs && !render_options_given(options, OPTION_OUTPUT) &&
      tour_of(options).count == 0) /* which have numbers already */
    return picture_default_output(options->inputs[step]);
  const char *dot = strrchr(cli_path_name(output), '.');
  const int stem = (int)(dot ? (size_t)(dot - output) : strlen(output));
  return cli_print("%.*s.%04lld%s", stem, output, (long long)step, output + stem);
}

/* ── steps ── */

static void show_step(Series *series, const char *what, int64_t step) {
  snprintf(series->label, sizeof series->label, "%s %lld/%lld", what, (long long)step + 1, (long long)series->count);
  const char *unit = series->tour.count > 0 ? "frame" : "step";
  snprintf(series->place, sizeof series->place, "%s %lld", unit, (long long)step);
  cli_set_place(series->count > 1 ? series->place : NULL);
}

/* While a step is read, signals end the process at once. From its preparation on they wait until the work in progress
 * is finished. */
static void let_go(Series *series) {
  if (!series->held)
    return;
  series->held = false;
  cli_progress_clear();
  cli_interrupt_hold(false);
}

/* Reads the step and prepares its volume, unless that has been done. */
static int load(Series *series, int64_t step) {
  Stage *stage = &series->run->stage;
  const RenderOptions *options = &series->run->options;
  if (series->loaded == step || (series->tour.count > 0 && series->loaded >= 0))
    return CLI_DONE;
  let_go(series);
  int code = stage_read_step(stage, options, series->tour.count > 0 ? stage->step : step);
  if (code != CLI_DONE)
    return code;
  series->held = true;
  code = stage_prepare(stage, options);
  stage_drop_dataset(stage);
  series->loaded = step;
  return code;
}

/* No picture may replace another file of the run, or another picture. */
static int check_names(const Series *series) {
  const RenderOptions *options = &series->run->options;
  FileSet files = {0};
  fileset_add_options(&files, options);
  for (int64_t i = series->begin; i < series->end; i++) {
    char *path = series_name(options, i);
    fileset_add(&files, "the picture", path, true);
    free(path);
  }
  const int code = fileset_check(&files, "render");
  return code < 0 ? CLI_DONE : code;
}

/* How many steps there are, and which are asked for. */
static int find_steps(Series *series) {
  Stage *stage = &series->run->stage;
  const RenderOptions *options = &series->run->options;
  const int code = stage_read(stage, options);
  if (code != CLI_DONE)
    return code;
  double time;
  while (cli_vtk()->dataset_time(stage->dataset, series->count, &time))
    series->count++;
  if (series->count > 0)
    series->times = cli_allocate(sizeof *series->times * (size_t)series->count);
  for (int64_t i = 0; i < series->count; i++)
    cli_vtk()->dataset_time(stage->dataset, i, &series->times[i]);
  if (series->count == 0)
    series->count = 1;
  if (series->tour.count > 0) {
    free(series->times);
    series->times = NULL;
    series->count = series->tour.count;
  } else if (options->inputs) { /* each may know of steps of its own, of which its first counts */
    free(series->times);
    series->times = NULL;
    series->count = options->input_count;
  }
  series->begin = is_all(options) ? 0 : stage->step;
  series->end = is_all(options) ? series->count : stage->step + 1;
  return check_names(series);
}

/* The range of the values of all steps. Meshes are not prepared for that. */
static int find_range(Series *series) {
  series->range[0] = INFINITY;
  series->range[1] = -INFINITY;
  double densest = -INFINITY;
  for (int64_t i = 0; i < series->count; i++) {
    show_step(series, "range", i);
    StageValues values;
    const int code = stage_read_values(&series->run->stage, &series->run->options, i, &values);
    if (code != CLI_DONE)
      return code;
    if (values.nonfinite < values.count) {
      series->range[0] = fmin(series->range[0], values.range[0]);
      series->range[1] = fmax(series->range[1], values.range[1]);
    }
    if (values.nonfinite < values.count && values.mean > densest) {
      densest = values.mean;
      series->densest = i;
    }
    cli_progress_part(series->label, (double)i / (double)series->count, (double)(i + 1) / (double)series->count);
    cli_progress_show(1);
  }
  if (series->range[0] > series->range[1])
    series->range[0] = series->range[1] = 0;
  cli_progress_clear();
  cli_progress_part(NULL, 0, 1);
  return CLI_DONE;
}

/* What all steps share: transfer function and camera. */
static int find_scene(Series *series) {
  Stage *stage = &series->run->stage;
  const RenderOptions *options = &series->run->options;
  const RangeKind kind = render_options_range(options);
  int code = CLI_DONE;
  if (series->tour.count > 0) {
    code = load(series, 0);
    if (code == CLI_DONE)
      code = stage_shade(stage, options, stage->range);
    series->camera = stage->camera;
    return code;
  }
  if (!stage->transfer_function && kind != RANGE_STEP && !render_options_direct(options)) {
    if (kind != RANGE_FIXED)
      code = find_range(series);
    stage->whole = kind != RANGE_FIXED ? series->range : NULL;
    if (code == CLI_DONE)
      code = load(series, series->densest);
    if (code == CLI_DONE)
      code = stage_shade(stage, options, series->range);
  }
  if (code == CLI_DONE)
    code = load(series, 0);
  series->camera = stage->camera;
  return code;
}

/* ── pictures ── */

static json_t *entry_of(const Series *series, int64_t step, const char *path, bool kept) {
  json_t *entry = json_object();
  json_object_set_new(entry, series->tour.count > 0 ? "frame" : "step", json_integer(step));
  if (series->tour.count == 0)
    json_object_set_new(entry, "time", series->times ? json_real(series->times[step]) : json_null());
  json_object_set_new(entry, "output", cli_json_text(path));
  json_object_set_new(entry, "kept", json_boolean(kept));
  if (!kept)
    json_object_update_new(entry, picture_stats(series->run));
  return entry;
}

static bool same_content(const char *left, const char *right) {
  FILE *a = fopen(left, "rb"), *b = fopen(right, "rb");
  bool same = a && b;
  while (same) {
    char from_a[4096], from_b[4096];
    const size_t size = fread(from_a, 1, sizeof from_a, a);
    same = fread(from_b, 1, sizeof from_b, b) == size && !memcmp(from_a, from_b, size);
    if (size < sizeof from_a)
      break;
  }
  if (a)
    fclose(a);
  if (b)
    fclose(b);
  return same;
}

/* Pictures of a former run go with those of this one if one of them is what this run makes of its step. */
static int check_former(Series *series, const char *path) {
  const char *dot = strrchr(cli_path_name(path), '.');
  char *name = cli_print("again%s", dot ? dot : "");
  const char *const files[] = {name, NULL};
  Folder folder = {.target = cli_duplicate(path), .files = files}; /* beside it, and gone with this run */
  int code = folder_begin(&folder) ? CLI_DONE : CLI_FAILED;
  char *again = code == CLI_DONE ? cli_print("%s/%s", folder.temporary, name) : NULL;
  if (code == CLI_DONE)
    code = picture_write(series->run, again);
  if (code == CLI_DONE && !same_content(again, path)) {
    cli_error("--resume: '%s' is not the picture that would be made now: settings or data were others; without "
              "--resume all are made anew",
              path);
    code = CLI_FAILED;
  }
  folder_release(&folder);
  free(again);
  free(name);
  return code;
}

/* Waits until the picture before is written. */
static int finish_writing(Series *series) {
  const int code = writer_end(&series->writer);
  if (series->written)
    json_object_set_new(series->written, "write_seconds", json_real(series->writer.seconds));
  series->written = NULL;
  return code;
}

/* What a step needs before it is rendered; frames of a tour have it all, but for the camera. */
static int prepare_step(Series *series, int64_t step) {
  const RenderOptions *options = &series->run->options;
  Stage *stage = &series->run->stage;
  if (series->tour.count > 0) {
    stage->camera = tour_camera(&series->tour, &series->camera, step);
    return CLI_DONE;
  }
  if (render_options_range(options) == RANGE_STEP)
    tetcast_transfer_function_destroy(&stage->transfer_function);
  const int code = load(series, step);
  stage->camera = series->camera;
  return code == CLI_DONE ? stage_shade(stage, options, stage->range) : code;
}

static int render_step(Series *series, int64_t step, const char *path, bool kept) {
  Run *run = series->run;
  const double steps = (double)series->todo, done = (double)series->made++ / steps;
  const double prepared = series->tour.count > 0 ? done : done + 0.3 / steps;
  show_step(series, series->tour.count > 0 ? "frame" : "step", step);
  cli_progress_part(series->label, done, prepared);
  int code = prepare_step(series, step);
  cli_progress_part(series->label, prepared, done + 1 / steps);
  if (code == CLI_DONE)
    code = picture_render(run);
  if (code == CLI_DONE && !series->shown) { /* a single step may well be empty */
    char *fault = sight_fault(run);
    series->shown = !fault;
    if (series->fault)
      free(fault);
    else
      series->fault = fault;
  }
  if (code == CLI_DONE && kept)
    return check_former(series, path);
  if (code == CLI_DONE)
    code = finish_writing(series);
  if (code == CLI_DONE)
    code = writer_begin(&series->writer, run, path);
  return code;
}

/* Size of the picture that a former run has made of the step, 0: none, or it is not to be kept. */
static off_t size_kept(const Series *series, int64_t step) {
  char *path = series_name(&series->run->options, step);
  struct stat status;
  const bool kept = series->run->options.resume && stat(path, &status) == 0 && S_ISREG(status.st_mode);
  free(path);
  return kept ? status.st_size : 0;
}

/* The largest of the pictures that are kept shows most; a first one may be empty, whatever the settings. */
static int check_kept(Series *series) {
  int64_t largest = series->begin;
  for (int64_t i = series->begin; i < series->end; i++)
    if (size_kept(series, i) > size_kept(series, largest))
      largest = i;
  for (int64_t i = series->begin; i < series->end; i++)
    series->todo += size_kept(series, i) == 0;
  if (size_kept(series, largest) == 0)
    return CLI_DONE;
  series->todo++;
  char *path = series_name(&series->run->options, largest);
  const int code = render_step(series, largest, path, true);
  free(path);
  return code;
}

static int render_steps(Series *series) {
  int code = check_kept(series);
  for (int64_t i = series->begin; i < series->end && code == CLI_DONE; i++) {
    char *path = series_name(&series->run->options, i);
    const bool kept = size_kept(series, i) > 0;
    series->shown = series->shown || kept;
    if (!kept)
      code = render_step(series, i, path, false);
    json_t *entry = entry_of(series, i, path, kept);
    json_array_append_new(series->entries, entry);
    series->written = kept ? series->written : entry;
    free(path);
    if (cli_interrupted())
      code = CLI_FAILED;
  }
  const int last = finish_writing(series);
  code = code == CLI_DONE ? last : code;
  cli_progress_clear();
  cli_progress_part(NULL, 0, 1);
  if (code == CLI_DONE && !series->shown && series->fault) {
    cli_warning("of all %s: %s", series->tour.count > 0 ? "frames" : "steps", series->fault);
    code = cli_verdict(code);
  }
  return code;
}

static int write_files(const Series *series) {
  const RenderOptions *options = &series->run->options;
  const Stage *stage = &series->run->stage;
  const bool own = render_options_range(options) == RANGE_STEP;
  if (options->save_scene &&
      !scene_file_write(options, stage->array, &series->camera, own ? NULL : stage->transfer_function,
                        stage->rows.source, own ? NULL : stage->shown))
    return CLI_FAILED;
  if (!options->stats)
    return CLI_DONE;
  json_t *root = json_object();
  json_object_set(root, series->tour.count > 0 ? "frames" : "steps", series->entries);
  return cli_json_write(options->stats, root) ? CLI_DONE : CLI_FAILED;
}

int series_perform(Run *run) {
  Series series = {.run = run, .tour = tour_of(&run->options), .loaded = -1, .entries = json_array()};
  run->stage.of_series = series.tour.count == 0;
  int code = find_steps(&series);
  picture_await_image(run);
  if (code == CLI_DONE)
    code = find_scene(&series);
  if (code == CLI_DONE)
    code = picture_create_frame(run, (int64_t)run->options.size[0], (int64_t)run->options.size[1]);
  if (code == CLI_DONE)
    code = render_steps(&series);
  if (code == CLI_DONE)
    code = write_files(&series);
  cli_set_place(NULL);
  writer_release(&series.writer);
  json_decref(series.entries);
  free(series.times);
  free(series.fault);
  return code;
}
