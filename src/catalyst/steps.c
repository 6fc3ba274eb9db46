/* SPDX-License-Identifier: Apache-2.0 */
#include "steps.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/progress.h"
#include "cli/ranks.h"
#include "cli/render.h"
#include "cli/series.h"
#include "cli/sight.h"
#include "communicator.h"
#include "dataset.h"
#include "settings.h"

static struct {
  Run run;
  Settings settings; /* whose options are run's */
  bool ready;
  int64_t calls, pictures, last; /* calls of execute, and the step of the last picture */
  char *path;                    /* of the last picture */
  char *place;                   /* what messages are about */
  TetcastCamera camera;          /* of the first picture, and of all others */
  bool shown;                    /* whether some picture shows something */
  char *fault;                   /* why the first picture shows nothing; NULL: it shows something */
} steps;

/* Makes the stage, over all processes of the simulation if it has several: each has a part of the mesh then. `code` is
 * what came before: its agreed value is returned, as the others wait for this process whatever is wrong with it. */
static int join(const ConduitNode *params, RenderOptions *options, int code) {
  Stage *stage = &steps.run.stage;
  const ConduitNode *node = conduit_at(params, "catalyst/mpi_comm");
  const int64_t processes = communicator_size(node);
  int64_t communicator = 0;
  if (processes > 1 && !conduit_integer(node, &communicator)) { /* each would write under the same name */
    cli_error("catalyst/mpi_comm: expected what MPI_Comm_c2f() returns, as the simulation has %lld processes",
              (long long)processes);
    return CLI_FAILED;
  }
  if (processes > 1 && render_options_deep(options)) {
    cli_error("catalyst/tetcast: deep: not possible over several processes");
    code = CLI_FAILED;
  }
  if (processes > 1 && options->threads == 0)
    options->threads = ranks_threads();
  if (code == CLI_DONE)
    code = stage_begin(stage, options);
  else if (processes > 1)
    stage->context = cli_context_create((int)options->threads);
  if (processes < 2 || !stage->context)
    return code;
  const int joined = ranks_join(stage, (int)communicator);
  return joined == CLI_DONE ? ranks_agree(stage, code) : joined;
}

int steps_begin(const ConduitNode *params) {
  steps_end();
  cli_forget_errors();
  cli_warn_once(); /* what is so in each step */
  cli_set_source(source_functions());
  const bool fine = settings_read(&steps.settings, params);
  steps.run.options = steps.settings.options;
  RenderOptions *options = &steps.run.options;
  cli_set_quiet(options->quiet);
  cli_set_strict(options->strict);
  steps.run.stage.of_series = true;
  const int code = join(params, options, fine ? CLI_DONE : CLI_FAILED);
  if (code != CLI_DONE)
    return fine ? STEPS_FAILED : STEPS_INVALID;
  render_choose_background(options);
  steps.ready = true;
  return STEPS_DONE;
}

int steps_end(void) {
  int code = STEPS_DONE;
  cli_forget_errors();
  if (steps.ready && steps.pictures > 0 && !steps.shown && steps.fault) {
    cli_warning("of all steps: %s", steps.fault);
    code = cli_verdict(CLI_DONE) == CLI_DONE ? STEPS_DONE : STEPS_FAILED;
  }
  cli_set_place(NULL);
  render_release(&steps.run);
  cli_set_rank(0);
  settings_release(&steps.settings);
  free(steps.path);
  free(steps.place);
  free(steps.fault);
  memset(&steps, 0, sizeof steps);
  cli_set_source(NULL);
  return code;
}

/* ── what a step is about ── */

/* The number of the step: that which the simulation tells, else how many calls there were before. */
static int64_t number_of(const ConduitNode *params) {
  int64_t number = steps.calls;
  if (!conduit_integer(conduit_at(params, "catalyst/state/timestep"), &number))
    conduit_integer(conduit_at(params, "catalyst/state/cycle"), &number);
  return number;
}

static bool is_drawn(const ConduitNode *channel) {
  const char *type = conduit_text(conduit_at(channel, "type"));
  return type && (!strcmp(type, "mesh") || !strcmp(type, "multimesh"));
}

/* Data of the channel that is named, or of the first that has a mesh; steps.place becomes its path. NULL after a
 * message. */
static const ConduitNode *find_data(const ConduitNode *params) {
  const ConduitNode *channels = conduit_at(params, "catalyst/channels"), *channel = NULL;
  const char *wanted = steps.settings.channel;
  char *name = NULL, *list = cli_duplicate("");
  for (int64_t i = 0; i < conduit_children(channels) && !channel; i++) {
    const ConduitNode *one = conduit_child(channels, i);
    free(name);
    name = conduit_name(one);
    channel = (wanted ? !strcmp(name, wanted) : is_drawn(one)) ? one : NULL;
    char *longer = cli_print("%s%s%s", list, *list ? ", " : "", name);
    free(list);
    list = longer;
  }
  const char *type = conduit_text(conduit_at(channel, "type"));
  const ConduitNode *data = conduit_at(channel, "data");
  if (!channels)
    cli_error("catalyst/channels: there are none");
  else if (!channel && wanted)
    cli_error("catalyst/channels: there is no channel '%s'; there are: %s", wanted, list);
  else if (!channel)
    cli_error("catalyst/channels: none has the type mesh or multimesh; there are: %s", list);
  else if (!is_drawn(channel))
    cli_error("catalyst/channels/%s/type: expected mesh or multimesh, not '%s'", name, type ? type : "");
  else if (!data)
    cli_error("catalyst/channels/%s: has no data", name);
  if (channel && is_drawn(channel) && data) {
    cli_set_place(NULL);
    free(steps.place);
    steps.place = cli_print("catalyst/channels/%s/data", name);
    cli_set_place(steps.place);
  } else {
    data = NULL;
  }
  free(name);
  free(list);
  return data;
}

/* ── pictures ── */

/* Reads the mesh and prepares the scene, after which nothing of the simulation's is in use. */
static int prepare(const ConduitNode *data) {
  Stage *stage = &steps.run.stage;
  RenderOptions *options = &steps.run.options;
  free(options->input);
  options->input = cli_duplicate(steps.place);
  if (!render_options_given(options, OPTION_TRANSFER)) /* each step has its own, as a picture of it alone */
    tetcast_transfer_function_destroy(&stage->transfer_function);
  source_set(data, steps.place, steps.settings.topology, ranks_size(stage));
  int code = ranks_read(stage, options);
  if (code == CLI_DONE)
    code = ranks_prepare(stage, options);
  stage_drop_dataset(stage);
  if (code == CLI_DONE)
    code = ranks_agree(stage, stage_shade(stage, options, stage->range));
  if (code == CLI_DONE && steps.pictures == 0)
    steps.camera = stage->camera;
  stage->camera = steps.camera;
  return code;
}

static void look(void) {
  if (steps.shown) /* a single step may well be empty */
    return;
  char *fault = sight_fault(&steps.run);
  steps.shown = !fault;
  if (steps.fault)
    free(fault);
  else
    steps.fault = fault;
}

static int begin_picture(void) {
  Run *run = &steps.run;
  if (!run->image && render_check_image(run) != CLI_DONE) {
    run->image = NULL; /* which is to be checked again */
    return CLI_FAILED;
  }
  return picture_create_frame(run, (int64_t)run->options.size[0], (int64_t)run->options.size[1]);
}

static int make_picture(const char *path) {
  Run *run = &steps.run;
  const bool first = ranks_first(&run->stage);
  int code = ranks_agree(&run->stage, first ? begin_picture() : CLI_DONE);
  if (code == CLI_DONE)
    code = ranks_agree(&run->stage, picture_render(run));
  if (code == CLI_DONE && first) {
    look();
    code = picture_write(run, path);
  }
  return ranks_agree(&run->stage, code);
}

/* Only what a mesh that stays the same would have to be prepared for again is kept. */
static void drop(void) {
  Run *run = &steps.run;
  tetcast_frame_destroy(&run->frame);
  deep_release(&run->deep);
  run->deep = (Deep){.layers = NULL};
  tetcast_scene_destroy(&run->stage.scene);
  ranks_drop(&run->stage);
}

int steps_execute(const ConduitNode *params) {
  if (!steps.ready)
    return STEPS_FAILED; /* initialize has said why */
  cli_forget_errors();
  int64_t number = number_of(params);
  steps.calls++;
  if (ranks_share_number(&steps.run.stage, &number) != CLI_DONE)
    return STEPS_FAILED;
  if (number % steps.settings.every != 0)
    return STEPS_DONE;
  const ConduitNode *data = find_data(params);
  if (ranks_agree(&steps.run.stage, data ? CLI_DONE : CLI_FAILED) != CLI_DONE)
    return STEPS_INVALID;
  int code = prepare(data);
  char *path = series_name(&steps.run.options, number);
  if (code == CLI_DONE)
    code = make_picture(path);
  drop();
  if (code == CLI_DONE) {
    free(steps.path);
    steps.path = path;
    steps.last = number;
    steps.pictures++;
  } else {
    free(path);
  }
  return code == CLI_DONE ? STEPS_DONE : STEPS_FAILED;
}

void steps_results(ConduitNode *params) {
  conduit_set_integer(params, "catalyst/tetcast/steps", steps.calls);
  conduit_set_integer(params, "catalyst/tetcast/pictures", steps.pictures);
  if (steps.pictures == 0)
    return;
  const RunStats *stats = &steps.run.stats;
  conduit_set_text(params, "catalyst/tetcast/picture", steps.path);
  conduit_set_integer(params, "catalyst/tetcast/step", steps.last);
  conduit_set_number(params, "catalyst/tetcast/read_seconds", stats->read_seconds);
  conduit_set_number(params, "catalyst/tetcast/prepare_seconds", stats->prepare_seconds);
  conduit_set_number(params, "catalyst/tetcast/render_seconds", stats->render_seconds[0]);
  conduit_set_number(params, "catalyst/tetcast/write_seconds", stats->write_seconds);
}
