/* SPDX-License-Identifier: Apache-2.0 */
#include "render_options.h"

#include <float.h>
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <tetcast/image.h>
#include <tetcast/transfer_function.h>

#include "cli.h"
#include "color.h"
#include "completion.h"
#include "numbered.h"
#include "scene_file.h"
#include "view.h"

typedef enum OptionKind { KIND_TEXT, KIND_PATH, KIND_NUMBERS, KIND_INTEGERS, KIND_CHOICE, KIND_FLAG } OptionKind;

#define BIT(id)    (UINT64_C(1) << (id))
#define AT(member) offsetof(RenderOptions, member)

/* A picture is made by a transfer function or from coefficients. */
#define DIRECT   (BIT(OPTION_EXTINCTION) | BIT(OPTION_EMISSION) | BIT(OPTION_GROUPS))
#define TRANSFER                                                                                                        \
  (BIT(OPTION_ARRAY) | BIT(OPTION_TRANSFER) | BIT(OPTION_PRESET) | BIT(OPTION_RANGE) | BIT(OPTION_OPACITY_MODEL) | \
   BIT(OPTION_BLEND))

/* Order of the library's enumerations. */
static const char *const opacity_models[] = {"unit-distance", "vtk-unstructured", "ospray", NULL};
static const char *const blends[] = {"composite", "maximum", "minimum", "average", "additive", NULL};
static const char *const isas[] = {"auto", "scalar", "avx2", "avx512", NULL};
static const char *const traversals[] = {"shell", "faces", NULL};
static const char *const pixel_types[] = {"", "uint8", "uint16", "half", "float", "double", NULL};

static const struct {
  const char *name;
  OptionKind kind;
  size_t at;                /* where the value goes in RenderOptions */
  int least, most;          /* how many numbers */
  double low, high;         /* bounds of each */
  const char *const *names; /* of a choice */
  uint64_t excludes;
  RenderCommand only; /* of this command alone, 0: of both */
  const char *form; /* what is expected */
} table[OPTION_COUNT] = {
    [OPTION_INPUT] = {"input", KIND_PATH, AT(input), .form = "expected a path"},
    [OPTION_OUTPUT] = {"output", KIND_PATH, AT(output), .form = "expected a path"},
    [OPTION_ARRAY] = {"array", KIND_TEXT, AT(array), .excludes = DIRECT,
                      .form = "expected NAME, NAME:point, NAME:cell, NAME:component or NAME:mag"},
    [OPTION_BLOCK] = {"block", KIND_TEXT, AT(block), .form = "expected the name of a block"},
    [OPTION_TIME] = {"time", KIND_TEXT, AT(time),
                     .form = "expected a step, from 0 (or -1, the last, and back), t=TIME, or all"},
    [OPTION_MERGE_TOLERANCE] = {"merge-tolerance", KIND_NUMBERS, AT(merge_tolerance), 1, 1, 0, DBL_MAX,
                                .form = "expected a distance, 0 or above"},
    [OPTION_CELL_TO_POINT] = {"cell-to-point", KIND_FLAG, AT(cell_to_point), .form = "expected true or false"},
    [OPTION_SUBDIVIDE] = {"subdivide", KIND_INTEGERS, AT(subdivide), 1, 1, 0, TETCAST_MAX_SUBDIVISION,
                          .form = "expected a whole number from 1 to 16, or 0: as the nodes lie"},
    [OPTION_NO_DISPLACEMENT] = {"no-displacement", KIND_FLAG, AT(no_displacement), .form = "expected true or false"},
    [OPTION_TRANSFER] = {"transfer", KIND_PATH, AT(transfer),
                         .excludes = BIT(OPTION_PRESET) | BIT(OPTION_RANGE) | DIRECT,
                         .form = "expected a transfer function or the path of one"},
    [OPTION_PRESET] = {"preset", KIND_TEXT, AT(preset), .excludes = BIT(OPTION_TRANSFER) | DIRECT,
                       .form = "expected a name"},
    [OPTION_RANGE] = {"range", KIND_NUMBERS, AT(range), 2, 2, -DBL_MAX, DBL_MAX,
                      .excludes = BIT(OPTION_TRANSFER) | DIRECT,
                      .form = "expected two numbers, LO not above HI, or step, or series"},
    [OPTION_OPACITY_MODEL] = {"opacity-model", KIND_CHOICE, AT(opacity_model), .names = opacity_models,
                              .excludes = DIRECT, .form = "expected unit-distance, vtk-unstructured or ospray"},
    [OPTION_EXTINCTION] = {"extinction", KIND_TEXT, AT(extinction), .excludes = TRANSFER, .only = COMMAND_RENDER,
                           .form = "expected NAME, NAME:component or NAME:mag"},
    [OPTION_EMISSION] = {"emission", KIND_TEXT, AT(emission), .excludes = TRANSFER, .only = COMMAND_RENDER,
                         .form = "expected NAME, NAME:component or NAME:mag"},
    [OPTION_GROUPS] = {"groups", KIND_FLAG, AT(groups), .excludes = TRANSFER, .only = COMMAND_RENDER,
                       .form = "expected true or false"},
    [OPTION_BLEND] = {"blend", KIND_CHOICE, AT(blend), .names = blends, .excludes = DIRECT,
                      .form = "expected composite, maximum, minimum, average or additive"},
    [OPTION_EYE] = {"eye", KIND_NUMBERS, AT(eye), 3, 3, -DBL_MAX, DBL_MAX, .form = "expected three numbers x,y,z"},
    [OPTION_TARGET] = {"target", KIND_NUMBERS, AT(target), 3, 3, -DBL_MAX, DBL_MAX,
                       .form = "expected three numbers x,y,z"},
    [OPTION_UP] = {"up", KIND_NUMBERS, AT(up), 3, 3, -DBL_MAX, DBL_MAX,
                   .form = "expected three numbers x,y,z, not all zero"},
    [OPTION_FOVY] = {"fovy", KIND_NUMBERS, AT(fovy), 1, 1, 1e-6, 179.999999, .excludes = BIT(OPTION_ORTHO),
                     .form = "expected an angle between 0 and 180 degrees"},
    [OPTION_ORTHO] = {"ortho", KIND_NUMBERS, AT(ortho), 1, 1, DBL_MIN, DBL_MAX, .excludes = BIT(OPTION_FOVY),
                      .form = "expected a height above 0"},
    [OPTION_SIZE] = {"size", KIND_INTEGERS, AT(size), 2, 2, 1, 1 << 20,
                     .form = "expected WxH: whole numbers from 1 to 1048576, no more than 2^30 pixels"},
    [OPTION_SAMPLES] = {"samples", KIND_INTEGERS, AT(samples), 1, 1, 1, 65536, .only = COMMAND_RENDER,
                        .form = "expected a whole number from 1 to 65536"},
    [OPTION_BACKGROUND] = {"background", KIND_NUMBERS, AT(background), 3, 4, 0, 1, .only = COMMAND_RENDER,
                           .form = "expected r,g,b or r,g,b,a from 0 to 1, a name such as white or transparent, or "
                                    "#rrggbb"},
    [OPTION_INTEGRATOR] =
        {"integrator", KIND_TEXT, AT(integrator), .only = COMMAND_RENDER,
         .form = "expected exact, midpoint:N, trapezoid:N, gauss:N (N to 16) or table:N (N from 2 to 4096)"},
    [OPTION_TOLERANCE] = {"tolerance", KIND_NUMBERS, AT(tolerance), 1, 1, 0, DBL_MAX, .only = COMMAND_RENDER,
                          .form = "expected a number, 0 or above"},
    [OPTION_CHANNELS] = {"channels", KIND_TEXT, AT(channels), .only = COMMAND_RENDER,
                         .form = "expected error, or value, or of radiance, optical_depth, transmittance and path_length some"},
    [OPTION_TRAVERSAL] = {"traversal", KIND_CHOICE, AT(traversal), .names = traversals,
                          .form = "expected shell or faces"},
    [OPTION_ISA] = {"isa", KIND_CHOICE, AT(isa), .names = isas,
                    .form = "expected auto, scalar, avx2 or avx512"},
    [OPTION_THREADS] = {"threads", KIND_INTEGERS, AT(threads), 1, 1, 0, 4096,
                        .form = "expected a whole number from 0 (all) to 4096"},
    [OPTION_REPEAT] = {"repeat", KIND_INTEGERS, AT(repeat), 1, 1, 1, 1e6,
                       .form = "expected a whole number from 1 to 1000000"},
    [OPTION_PIXEL_TYPE] = {"pixel-type", KIND_CHOICE, AT(pixel_type), .names = pixel_types, .only = COMMAND_RENDER,
                           .form = "expected uint8, uint16, half, float or double"},
    [OPTION_STATS] = {"stats", KIND_PATH, AT(stats), .only = COMMAND_RENDER, .form = "expected a path"},
    [OPTION_SCENE] = {"scene", KIND_PATH, AT(scene), .form = "expected a path"},
    [OPTION_SAVE_SCENE] = {"save-scene", KIND_PATH, AT(save_scene), .only = COMMAND_RENDER, .form = "expected a path"},
    [OPTION_RESUME] = {"resume", KIND_FLAG, AT(resume), .only = COMMAND_RENDER, .form = "expected true or false"},
    [OPTION_STRICT] = {"strict", KIND_FLAG, AT(strict), .form = "expected true or false"},
    [OPTION_QUIET] = {"quiet", KIND_FLAG, AT(quiet), .form = "expected true or false"},
    [OPTION_REFINE] = {"refine", KIND_FLAG, AT(refine), .only = COMMAND_CONVERGE},
    [OPTION_NO_PLOTS] = {"no-plots", KIND_FLAG, AT(no_plots), .only = COMMAND_CONVERGE},
};

static bool of_command(OptionId id, RenderCommand command) {
  return !table[id].only || table[id].only == command;
}

static const char *command_name(const RenderOptions *options) {
  return options->command == COMMAND_RENDER ? "render" : "converge";
}

RenderOptions render_options_default(RenderCommand command) {
  RenderOptions options = {.command = command, .size = {1024, 768}, .samples = 1, .background = {1, 1, 1, 1}, .repeat = 1,
                           .merge_tolerance = -1};
  if (command == COMMAND_CONVERGE) {
    options.size[0] = 256;
    options.size[1] = 192;
    options.repeat = 3;
  }
  return options;
}

static void release_inputs(RenderOptions *options) {
  for (int i = 0; i < options->input_count; i++)
    free(options->inputs[i]);
  free(options->inputs);
  options->inputs = NULL;
  options->input_count = 0;
}

void render_options_release(RenderOptions *options) {
  for (int id = 0; id < OPTION_COUNT; id++)
    if (table[id].kind == KIND_TEXT || table[id].kind == KIND_PATH)
      free(*(char **)((char *)options + table[id].at));
  json_decref(options->transfer_object);
  release_inputs(options);
}

OptionId render_option_find(const char *key) {
  for (int id = 0; id < OPTION_COUNT; id++) {
    const char *a = table[id].name, *b = key;
    while (*a && (*a == *b || (*a == '-' && *b == '_'))) {
      a++;
      b++;
    }
    if (!*a && !*b)
      return of_command((OptionId)id, COMMAND_RENDER) ? (OptionId)id : OPTION_COUNT;
  }
  return OPTION_COUNT;
}

const char *render_option_key(OptionId id) {
  return of_command(id, COMMAND_RENDER) && id != OPTION_SCENE && id != OPTION_SAVE_SCENE ? table[id].name : NULL;
}

bool render_option_is_path(OptionId id) {
  return table[id].kind == KIND_PATH;
}

bool render_option_is_flag(OptionId id) {
  return table[id].kind == KIND_FLAG;
}

const char *render_option_choice(OptionId id, int value) {
  return table[id].names[value];
}

const char *render_options_claim(RenderOptions *options, OptionId id) {
  for (int other = 0; other < OPTION_COUNT; other++)
    if (options->source & table[id].excludes & BIT(other))
      return table[other].name;
  options->given = (options->given & ~table[id].excludes) | BIT(id);
  options->source |= BIT(id);
  return NULL;
}

static const char *set_preset_name(const char *name) {
  static char reason[512];
  size_t length = (size_t)snprintf(reason, sizeof reason, "there is no such preset; there are");
  CliGuess guess = {.word = name};
  for (int i = 0; tetcast_preset_name(i); i++) {
    if (!strcmp(name, tetcast_preset_name(i)))
      return NULL;
    cli_guess(&guess, tetcast_preset_name(i));
    if (length < sizeof reason)
      length += (size_t)snprintf(reason + length, sizeof reason - length, " %s", tetcast_preset_name(i));
  }
  char *hint = cli_guess_text(&guess);
  if (length < sizeof reason)
    snprintf(reason + length, sizeof reason - length, "%s", hint);
  free(hint);
  return reason;
}

bool render_option_integrator(const char *text, TetcastIntegrator *integrator, int *n) {
  static const struct {
    const char *name;
    int least, most;
  } integrators[] = {{"exact", 0, 0}, {"midpoint:", 1, 1 << 20}, {"trapezoid:", 1, 1 << 20}, {"gauss:", 1, 16}, {"table:", 2, 4096}};
  for (int i = 0; i < 5; i++) {
    const size_t length = strlen(integrators[i].name);
    double number = 0;
    if (strncmp(text, integrators[i].name, length))
      continue;
    if (i == 0 ? text[length] != 0 : cli_parse_numbers(text + length, ',', 1, &number) != 1)
      return false;
    *integrator = (TetcastIntegrator)i;
    *n = number >= integrators[i].least && number <= integrators[i].most ? (int)number : -1;
    return *n == number;
  }
  return false;
}

bool render_option_dataset(const char *block, const char *time, double merge_tolerance, TetcastDatasetDesc *desc) {
  desc->block = block;
  desc->merge_tolerance = merge_tolerance;
  double number = 0;
  if (!time || !strcmp(time, "all"))
    return true;
  if (!strncmp(time, "t=", 2))
    return cli_parse_number(time + 2, &desc->time);
  if (!cli_parse_number(time, &number) || number != floor(number) || fabs(number) > 1e15)
    return false;
  desc->step = (int64_t)number;
  return true;
}

static const struct {
  const char *name;
  uint32_t bit;
} channel_names[] = {{"error", TETCAST_CHANNEL_ERROR},
                     {"radiance", TETCAST_CHANNEL_RADIANCE},
                     {"optical_depth", TETCAST_CHANNEL_OPTICAL_DEPTH},
                     {"transmittance", TETCAST_CHANNEL_TRANSMITTANCE},
                     {"path_length", TETCAST_CHANNEL_PATH_LENGTH},
                     {"value", TETCAST_CHANNEL_VALUE}};

static uint32_t channel_bit(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof channel_names / sizeof *channel_names; i++)
    if (strlen(channel_names[i].name) == length && !strncmp(channel_names[i].name, name, length))
      return channel_names[i].bit;
  return 0;
}

uint32_t render_option_channels(const char *text) {
  uint32_t channels = 0;
  for (;;) {
    const size_t length = strcspn(text, ",");
    const uint32_t bit = channel_bit(text, length);
    if (!bit || channels & bit)
      return 0;
    channels |= bit;
    if (!text[length])
      return channels;
    text += length + 1;
  }
}

static bool groups_given(const RenderOptions *options) {
  return render_options_given(options, OPTION_GROUPS) && options->groups;
}

uint32_t render_options_channels(const RenderOptions *options) {
  if (options->channels)
    return render_option_channels(options->channels);
  if (!groups_given(options))
    return 0;
  return render_options_given(options, OPTION_EMISSION) ? TETCAST_CHANNEL_RADIANCE : TETCAST_CHANNEL_TRANSMITTANCE;
}

static bool has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length > tail && !strcasecmp(path + length - tail, extension);
}

static bool is_tiff(const char *path) {
  return has_extension(path, ".tif") || has_extension(path, ".tiff");
}

bool render_options_floating(const RenderOptions *options) {
  if (options->pixel_type != TETCAST_PIXEL_DEFAULT)
    return options->pixel_type >= TETCAST_PIXEL_HALF;
  return options->output && (has_extension(options->output, ".exr") || is_tiff(options->output) ||
                             has_extension(options->output, ".hdr") || has_extension(options->output, ".rgbe"));
}

/* What of coefficients and what of a transfer function doesn't go together. NULL: nothing. */
static const char *find_mixture(const RenderOptions *options) {
  const uint32_t channels = render_options_channels(options);
  if (!render_options_direct(options)) {
    if (groups_given(options))
      return "--groups: needs --extinction or --emission";
    if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE) {
      if (options->integrator && strcmp(options->integrator, "exact"))
        return "--integrator: with another --blend than composite there is only exact";
      return channels & ~(uint32_t)TETCAST_CHANNEL_VALUE ? "--channels: only value is possible with another --blend than composite" : NULL;
    }
    if (channels & TETCAST_CHANNEL_VALUE)
      return "--channels value: needs --blend maximum, minimum, average or additive";
    return channels & ~(uint32_t)TETCAST_CHANNEL_ERROR ? "--channels: only error is possible without --extinction or --emission" : NULL;
  }
  if (options->integrator && strcmp(options->integrator, "exact"))
    return "--integrator: with --extinction or --emission there is only exact";
  if (channels & TETCAST_CHANNEL_VALUE)
    return "--channels value: not possible with --extinction or --emission";
  if (channels & TETCAST_CHANNEL_ERROR)
    return "--channels error: not possible with --extinction or --emission";
  if (channels & TETCAST_CHANNEL_RADIANCE && !render_options_given(options, OPTION_EMISSION))
    return "--channels radiance: needs --emission";
  if (channels & (TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_TRANSMITTANCE) && !render_options_given(options, OPTION_EXTINCTION))
    return "--channels optical_depth, transmittance: need --extinction";
  return NULL;
}

/* What is wrong with options that are in order one by one (for free()), NULL: nothing. */
static char *find_fault(const RenderOptions *options) {
  const char *view = view_fault(options);
  if (!view)
    view = find_mixture(options);
  if (view)
    return cli_duplicate(view);
  TetcastIntegrator integrator = TETCAST_INTEGRATOR_EXACT;
  int n;
  if (options->integrator)
    render_option_integrator(options->integrator, &integrator, &n);
  if (integrator != TETCAST_INTEGRATOR_EXACT && (options->tolerance > 0 || options->channels))
    return cli_print("%s: only the exact integrator knows its error, not %s",
                     options->channels ? "--channels error" : "--tolerance", options->integrator);
  if (!render_options_channels(options))
    return NULL;
  const char *output = options->output ? options->output : ".png", *asked = options->channels ? "--channels " : "--groups";
  const char *list = options->channels ? options->channels : "";
  if (!has_extension(output, ".exr") && !is_tiff(output))
    return cli_print("%s%s: only .exr and .tif hold more channels than colour and alpha, not %s", asked, list,
                     options->output ? output : "the default, a .png");
  return render_options_floating(options)
           ? NULL
           : cli_print("%s%s: needs floating-point pixels, not %s", asked, list,
                       render_option_choice(OPTION_PIXEL_TYPE, options->pixel_type));
}

static const char *set_numbers(OptionId id, void *at, const OptionValue *value) {
  const double *numbers = value->numbers;
  if (value->text || value->count < table[id].least || value->count > table[id].most)
    return table[id].form;
  for (int i = 0; i < value->count; i++)
    if (!(numbers[i] >= table[id].low && numbers[i] <= table[id].high) ||
        (table[id].kind == KIND_INTEGERS && numbers[i] != floor(numbers[i])))
      return table[id].form;
  if ((id == OPTION_SIZE && numbers[0] * numbers[1] > 0x1p30) || (id == OPTION_RANGE && numbers[0] > numbers[1]) ||
      (id == OPTION_UP && numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0))
    return table[id].form;
  memcpy(at, numbers, sizeof(double) * (size_t)value->count);
  if (id == OPTION_BACKGROUND && value->count == 3)
    ((double *)at)[3] = 1;
  return NULL;
}

static const char *set_color(OptionId id, double rgba[4], const OptionValue *value) {
  double color[4];
  if (!value->text)
    return set_numbers(id, rgba, value);
  if (!color_parse(value->text, color)) {
    static char reason[256];
    CliGuess guess = {.word = value->text};
    for (int i = 0; color_name(i); i++)
      cli_guess(&guess, color_name(i));
    char *hint = cli_guess_text(&guess);
    snprintf(reason, sizeof reason, "%s%s", table[id].form, hint);
    free(hint);
    return reason;
  }
  memcpy(rgba, color, sizeof color);
  return NULL;
}

static const char *set_choice(OptionId id, void *at, const OptionValue *value) {
  for (int i = 0; value->text && *value->text && table[id].names[i]; i++) {
    if (!strcmp(value->text, table[id].names[i])) {
      memcpy(at, &i, sizeof i);
      return NULL;
    }
  }
  return table[id].form;
}

static const char *set_range(RenderOptions *options, const OptionValue *value) {
  const bool step = value->text && !strcmp(value->text, "step"), series = value->text && !strcmp(value->text, "series");
  const char *reason = step || series ? NULL : set_numbers(OPTION_RANGE, options->range, value);
  if (!reason)
    options->range_kind = step ? RANGE_STEP : series ? RANGE_SERIES : RANGE_FIXED;
  return reason;
}

const char *render_options_set(RenderOptions *options, OptionId id, const OptionValue *value) {
  void *at = (char *)options + table[id].at;
  if (id == OPTION_RANGE)
    return set_range(options, value);
  if (id == OPTION_BACKGROUND)
    return set_color(id, at, value);
  switch (table[id].kind) {
  case KIND_NUMBERS:
  case KIND_INTEGERS:
    return set_numbers(id, at, value);
  case KIND_CHOICE:
    return set_choice(id, at, value);
  case KIND_FLAG:
    *(int *)at = value->count == 1 && value->numbers[0] != 0;
    return NULL;
  default:
    if (!value->text || !*value->text)
      return table[id].form;
    TetcastIntegrator integrator;
    int n;
    const char *reason = id == OPTION_PRESET ? set_preset_name(value->text) : NULL;
    if (id == OPTION_INTEGRATOR && !render_option_integrator(value->text, &integrator, &n))
      reason = table[id].form;
    if (id == OPTION_CHANNELS && !render_option_channels(value->text))
      reason = table[id].form;
    if (id == OPTION_TIME && !render_option_dataset(NULL, value->text, -1, &(TetcastDatasetDesc){0}))
      reason = table[id].form;
    if (!reason) {
      char **text = at;
      free(*text);
      *text = cli_duplicate(value->text);
      if (id == OPTION_TRANSFER) {
        json_decref(options->transfer_object);
        options->transfer_object = NULL;
      }
    }
    return reason;
  }
}

bool render_options_set_inputs(RenderOptions *options, int count, const char *const *paths) {
  RenderOptions taken = {.inputs = cli_allocate(sizeof *taken.inputs * (size_t)count), .input_count = count};
  for (int i = 0; i < count; i++)
    taken.inputs[i] = cli_duplicate(paths[i]);
  const bool fine = count == 1 || numbered_sort(taken.inputs, count);
  if (fine) {
    free(options->input);
    options->input = cli_duplicate(taken.inputs[0]);
    release_inputs(options);
  }
  if (fine && count > 1) {
    options->inputs = taken.inputs;
    options->input_count = count;
  } else {
    release_inputs(&taken);
  }
  return fine;
}

static int set_from_text(RenderOptions *options, OptionId id, const char *text) {
  OptionValue value = {.text = text};
  if (table[id].kind == KIND_NUMBERS || table[id].kind == KIND_INTEGERS) {
    value.count = cli_parse_numbers(text, id == OPTION_SIZE ? 'x' : ',', table[id].most, value.numbers);
    if (value.count > 0 || (id != OPTION_RANGE && id != OPTION_BACKGROUND)) /* which may be words */
      value.text = NULL;
  } else if (table[id].kind == KIND_FLAG) {
    value.count = 1;
    value.numbers[0] = 1;
  }
  const char *other = render_options_claim(options, id);
  if (other)
    return cli_usage_error(command_name(options), "--%s and --%s exclude each other", table[id].name, other);
  const char *reason = render_options_set(options, id, &value);
  return reason ? cli_usage_error(command_name(options), "--%s %s: %s", table[id].name, text, reason) : -1;
}

/* A series, a single file, or a usage error: two files that are neither. */
static int set_inputs(RenderOptions *options, int count, char **paths) {
  const char *command = command_name(options);
  render_options_claim(options, OPTION_INPUT);
  for (int i = 0; i < count; i++)
    if (!*paths[i])
      return cli_usage_error(command, "the input is '': expected a path");
  if (count > 1 && options->command == COMMAND_CONVERGE)
    return cli_usage_error(command, "more than one input: '%s' and '%s'; a report is about one step", paths[0],
                           paths[1]);
  if (render_options_set_inputs(options, count, (const char *const *)paths))
    return -1;
  return cli_usage_error(
      command,
      "more than one input: '%s' and '%s'; steps of a series are numbered (step_1.vtu step_2.vtu), and parts of one "
      "mesh are read by a file that lists them (.pvtu, .vtm or .pvd)",
      paths[0], paths[1]);
}

enum { WORD_HELP = 'h', WORD_OUTPUT = 'o', WORD_OPTION = 256 };

/* What getopt_long() is to know of a command's options, and which they are; ids may be NULL. */
static void list_words(RenderCommand command, struct option words[OPTION_COUNT + 2], OptionId ids[OPTION_COUNT]) {
  int count = 0;
  for (int id = 0; id < OPTION_COUNT; id++) {
    if (id == OPTION_INPUT || !of_command((OptionId)id, command))
      continue;
    if (ids)
      ids[count] = (OptionId)id;
    words[count++] = (struct option){table[id].name, table[id].kind == KIND_FLAG ? no_argument : required_argument,
                                     NULL, WORD_OPTION + id};
  }
  words[count++] = (struct option){"help", no_argument, NULL, WORD_HELP};
  words[count] = (struct option){NULL, 0, NULL, 0};
}

/* The words of the command line; with `scene_only` everything but the options --scene and --help is left for later. */
static int parse_words(RenderOptions *options, int argc, char **argv, bool scene_only) {
  struct option words[OPTION_COUNT + 2];
  list_words(options->command, words, NULL);

  optind = 0; /* getopt starts anew */
  int code;
  while ((code = getopt_long(argc, argv, ":ho:", words, NULL)) != -1) {
    if (code == '?' || code == ':')
      return cli_bad_option(command_name(options), code, argc, argv, words);
    if (code == WORD_HELP) {
      fputs(options->command == COMMAND_RENDER ? render_help : converge_help, stdout);
      return cli_finish_output();
    }
    const OptionId id = code == WORD_OUTPUT ? OPTION_OUTPUT : (OptionId)(code - WORD_OPTION);
    if (code == WORD_OUTPUT && !strcmp(optarg, "utput"))
      return cli_usage_error(command_name(options), "unknown option -output; did you mean --output?");
    if (scene_only != (id == OPTION_SCENE))
      continue;
    const int result = set_from_text(options, id, optarg);
    if (result >= 0)
      return result;
  }
  if (scene_only)
    return -1;
  return optind < argc ? set_inputs(options, argc - optind, argv + optind) : -1;
}

/* A scene file states a picture; what converge takes of it is what is seen, at its own size but in the shape of the picture. */
static void take_scene(RenderOptions *options) {
  if (options->command == COMMAND_RENDER)
    return;
  const RenderOptions standard = render_options_default(options->command);
  if (render_options_given(options, OPTION_SIZE)) {
    const double pixels = standard.size[0] * standard.size[1];
    const double aspect = options->size[0] / options->size[1];
    options->size[0] = fmin(fmax(round(sqrt(pixels * aspect)), 1), 1 << 20);
    options->size[1] = fmin(fmax(round(sqrt(pixels / aspect)), 1), 1 << 20);
  }
  options->repeat = standard.repeat;
  for (int id = 0; id < OPTION_COUNT; id++)
    if (id == OPTION_OUTPUT || !of_command((OptionId)id, options->command)) {
      options->given &= ~BIT(id);
      if (table[id].kind == KIND_TEXT || table[id].kind == KIND_PATH) {
        char **text = (char **)((char *)options + table[id].at);
        free(*text);
        *text = NULL;
      }
    }
  options->tolerance = standard.tolerance;
}

/* What of the command line is missing or has no use. -1: nothing, else the exit code. */
static int check_use(const RenderOptions *options) {
  if (options->command == COMMAND_CONVERGE && !options->output)
    return cli_usage_error("converge", "no folder for the report given: -o REPORTDIR");
  if (options->command == COMMAND_CONVERGE && options->time && !strcmp(options->time, "all"))
    return cli_usage_error("converge", "--time all: expected a single step");
  if (options->command == COMMAND_CONVERGE && render_options_range(options) == RANGE_SERIES)
    return cli_usage_error("converge", "--range series: expected two numbers, LO not above HI, or step");
  if (options->command == COMMAND_CONVERGE && render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return cli_usage_error("converge", "--blend %s: values along rays are always exact, there is nothing to compare; a report is about composite",
                           render_option_choice(OPTION_BLEND, options->blend));
  char *mistaken = options->input ? scene_file_mistaken(options->input) : NULL;
  const int result = mistaken ? cli_usage_error(command_name(options), "%s", mistaken) : -1;
  free(mistaken);
  if (options->inputs && options->time && !strncmp(options->time, "t=", 2))
    return cli_usage_error(command_name(options),
                           "--time %s: files on the command line have no times, only numbers, from 0", options->time);
  if (options->input)
    return result;
  if (!options->refine)
    return cli_usage_error(command_name(options), "no input given");
  const uint64_t used = BIT(OPTION_OUTPUT) | BIT(OPTION_THREADS) | BIT(OPTION_QUIET) | BIT(OPTION_STRICT) | BIT(OPTION_REFINE) |
                        BIT(OPTION_NO_PLOTS);
  for (int id = 0; id < OPTION_COUNT; id++)
    if (options->given & ~used & BIT(id))
      return cli_usage_error("converge", "--%s needs an input: --refine has a scene of its own", table[id].name);
  return -1;
}

int render_options_parse(RenderOptions *options, int argc, char **argv) {
  int result = parse_words(options, argc, argv, true);
  if (result < 0 && options->scene) {
    options->source = 0;
    if (!scene_file_read(options))
      return CLI_FAILED;
    if (options->command == COMMAND_CONVERGE && render_options_direct(options)) {
      cli_error("%s: a scene of extinction or emission arrays is always exact: there is nothing to compare", options->scene);
      return CLI_FAILED;
    }
    take_scene(options);
  }
  options->source = 0;
  if (result < 0)
    result = parse_words(options, argc, argv, false);
  if (result < 0)
    result = check_use(options);
  char *fault = result < 0 ? find_fault(options) : NULL;
  if (fault && options->scene) {
    cli_error("%s", fault);
    result = CLI_FAILED;
  } else if (fault) {
    result = cli_usage_error(command_name(options), "%s", fault);
  }
  free(fault);
  return result;
}

/* ── completion ── */

static const char *preset_word(int i) {
  return tetcast_preset_name(i);
}

static const char *const *words_of(OptionId id) {
  static const char *presets[COMPLETION_WORDS], *colors[COMPLETION_WORDS];
  static const char *const integrators[] = {"exact", "midpoint:", "trapezoid:", "gauss:", "table:", NULL};
  static const char *const channels[] = {"error", "radiance", "optical_depth", "transmittance", "path_length", "value", NULL};
  static const char *const ranges[] = {"step", "series", NULL}, *const times[] = {"all", NULL};
  switch (id) {
  case OPTION_PRESET:
    return completion_words(preset_word, presets);
  case OPTION_BACKGROUND:
    return completion_words(color_name, colors);
  case OPTION_INTEGRATOR:
    return integrators;
  case OPTION_CHANNELS:
    return channels;
  case OPTION_RANGE:
    return ranges;
  case OPTION_TIME:
    return times;
  default:
    return table[id].names;
  }
}

static int complete(RenderCommand command, CompletionOption list[COMPLETION_OPTIONS]) {
  struct option words[OPTION_COUNT + 2];
  OptionId ids[OPTION_COUNT];
  list_words(command, words, ids);
  const int count = completion_of_words(words, list);
  for (int i = 0; i + 1 < count; i++) { /* but for the last, --help */
    if (table[ids[i]].kind == KIND_PATH)
      list[i].kind = COMPLETION_PATH;
    list[i].words = words_of(ids[i]);
  }
  return count;
}

int completion_of_render(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_RENDER, list);
}

int completion_of_converge(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_CONVERGE, list);
}
