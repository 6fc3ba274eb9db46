/* SPDX-License-Identifier: Apache-2.0 */
#include "render_parse.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tetcast/image.h>
#include <tetcast/transfer_function.h>

#include "cli.h"
#include "color.h"
#include "completion.h"
#include "ray_file.h"
#include "scene_file.h"
#include "series.h"
#include "surface_text.h"
#include "tiles.h"
#include "tour.h"
#include "view.h"

static const char *command_name(const RenderOptions *options) {
  return options->command == COMMAND_RENDER     ? "render"
         : options->command == COMMAND_CAST     ? "cast"
         : options->command == COMMAND_CONVERGE ? "converge"
                                                : "transfer";
}

/* What of the light has nothing to fall on, or doesn't go with the rest. NULL: nothing. */
static const char *find_darkness(const RenderOptions *options) {
  static const OptionSet light = BIT(OPTION_SHADE) | BIT(OPTION_NORMALS) | BIT(OPTION_MATERIAL) | BIT(OPTION_LIGHT);
  if (!render_options_surfaces(options) && !render_options_lit(options)) {
    if (options->given & light)
      return "--shade, --normals, --material, --light: need --isosurface or --surface, on which the light falls, or "
             "--shade volume";
    if (options->shadows || options->ambient_occlusion > 0)
      return "--shadows, --ambient-occlusion: need --shade volume, or a --transfer and --isosurface or --surface";
    return NULL;
  }
  if (options->shadows && options->lights.count == 0)
    return "--shadows: need a --light, as the one at the eye casts no shadow that it sees";
  if ((options->shadows || options->ambient_occlusion > 0 || render_options_lit(options)) &&
      render_options_surfaces_alone(options))
    return "--shade volume or all, --shadows, --ambient-occlusion: need a volume: a --transfer beside the surfaces";
  if (!render_options_lit(options))
    return NULL;
  if (options->command == COMMAND_CONVERGE)
    return "--shade volume: render only, as the integrators that are compared know no light";
  if (render_options_direct(options))
    return "--shade volume: not possible with --extinction or --emission, which are all the light there is";
  if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return "--shade volume: needs --blend composite";
  if (options->integrator && strcmp(options->integrator, "exact"))
    return "--integrator: with --shade volume there is only exact";
  if (render_options_channels(options) & TETCAST_CHANNEL_ERROR)
    return "--channels error: not possible with --shade volume, as light is known at the vertices only";
  return NULL;
}

/* What of coefficients and what of a transfer function doesn't go together. NULL: nothing. */
static const char *find_mixture(const RenderOptions *options) {
  const uint32_t channels = render_options_channels(options);
  const bool of_depth = channels & (TETCAST_CHANNEL_DEPTH | TETCAST_CHANNEL_NORMAL);
  if (of_depth && channels & TETCAST_CHANNEL_ERROR)
    return channels & TETCAST_CHANNEL_DEPTH ? "--channels: error and depth are not possible in one picture"
                                            : "--channels: error and normal are not possible in one picture";
  if (render_options_adaptive(options) && channels)
    return "--channels, --groups: not possible with --adaptive, which interpolates between rays";
  if (render_options_adaptive(options) && render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return "--adaptive: needs --blend composite";
  if (render_options_given(options, OPTION_EDGES) && !render_options_given(options, OPTION_SURFACE))
    return "--edges: needs --surface, on which they are drawn";
  if (render_options_surfaces(options)) {
    if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
      return "--isosurface, --slice, --surface: need --blend composite";
    if (options->integrator && strcmp(options->integrator, "exact"))
      return "--integrator: with --isosurface, --slice or --surface there is only exact";
    if (channels & TETCAST_CHANNEL_ERROR)
      return "--channels error: not possible with --isosurface, --slice or --surface; where a surface is seen edge-on, "
             "rounding decides whether a ray meets it";
  }
  if (options->logarithmic && render_options_range(options) == RANGE_FIXED && !(options->range[0] > 0))
    return "--log: --range must be above 0, where values have a logarithm";
  if ((options->logarithmic || render_options_given(options, OPTION_CENTRE)) &&
      render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return "--log, --centre: with --blend, colours are even in the values from one end of --range to the other";
  const char *light = find_darkness(options);
  if (light)
    return light;
  if (render_options_range(options) == RANGE_QUANTILES && render_options_blend(options) == TETCAST_BLEND_ADDITIVE)
    return "--range of shares: --blend additive has integrals along rays, which are in no range of values";
  if (!render_options_direct(options)) {
    if (render_options_groups(options))
      return "--groups: needs --extinction or --emission";
    if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE) {
      if (options->integrator && strcmp(options->integrator, "exact"))
        return "--integrator: with another --blend than composite there is only exact";
      return channels & ~(uint32_t)(TETCAST_CHANNEL_VALUE | TETCAST_CHANNEL_CELLS)
                 ? "--channels: only value and cells are possible with another --blend than composite"
                 : NULL;
    }
    if (channels & TETCAST_CHANNEL_VALUE)
      return "--channels value: needs --blend maximum, minimum, average or additive";
    const TetcastChannelInfo *info = NULL;
    for (int i = 0;
         (info = tetcast_channel_info(i)) && !(channels & (uint32_t)info->channel && info->needs_coefficients);)
      i++;
    return info ? "--channels: only cells, error, or depth and normal are possible without --extinction or --emission"
                : NULL;
  }
  if (options->integrator && strcmp(options->integrator, "exact"))
    return "--integrator: with --extinction or --emission there is only exact";
  if (of_depth)
    return channels & TETCAST_CHANNEL_DEPTH ? "--channels depth: not possible with --extinction or --emission"
                                            : "--channels normal: not possible with --extinction or --emission";
  if (channels & TETCAST_CHANNEL_VALUE)
    return "--channels value: not possible with --extinction or --emission";
  if (channels & TETCAST_CHANNEL_RADIANCE && !render_options_given(options, OPTION_EMISSION))
    return "--channels radiance: needs --emission";
  if (channels & (TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_TRANSMITTANCE) &&
      !render_options_given(options, OPTION_EXTINCTION))
    return "--channels optical_depth, transmittance: need --extinction";
  return NULL;
}

/* What can't be with a deep picture. NULL: nothing. */
static const char *find_flat(const RenderOptions *options) {
  if (!render_options_deep(options))
    return NULL;
  if (!options->output || !render_option_has_extension(options->output, ".exr"))
    return "--deep: only .exr holds deep pictures";
  if (options->pixel_type != TETCAST_PIXEL_DEFAULT && options->pixel_type != TETCAST_PIXEL_HALF &&
      options->pixel_type != TETCAST_PIXEL_FLOAT)
    return "--deep: needs --pixel-type float or half";
  if (render_options_channels(options))
    return "--channels, --groups: not possible with --deep";
  if (render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return "--deep: needs --blend composite";
  if (options->integrator && strcmp(options->integrator, "exact"))
    return "--integrator: with --deep there is only exact";
  if (render_options_adaptive(options) || (render_options_given(options, OPTION_SAMPLES) && options->samples > 1))
    return "--deep: needs one ray per pixel, without --samples and --adaptive";
  return render_options_given(options, OPTION_OUTLINE) ? "--outline: not possible with --deep" : NULL;
}

/* What can't be with --mpi; of what a scene can't show, the library says so. NULL: nothing. */
static const char *find_alone(const RenderOptions *options) {
  if (!options->mpi)
    return NULL;
  if (series_wanted(options))
    return "--mpi: for one picture, not for those of several inputs, --time all, --orbit and the like";
  return render_options_deep(options) || render_options_given(options, OPTION_TILES)
             ? "--mpi: not possible with --deep or --tiles"
             : NULL;
}

char *render_options_fault(const RenderOptions *options) {
  const char *view = view_fault(options);
  if (!view)
    view = find_mixture(options);
  if (!view)
    view = find_flat(options);
  if (!view)
    view = tour_fault(options);
  if (!view)
    view = tiles_fault(options);
  if (!view)
    view = find_alone(options);
  if (view)
    return cli_duplicate(view);
  if (options->command == COMMAND_CAST) /* what follows is about pictures */
    return NULL;
  TetcastIntegrator integrator = TETCAST_INTEGRATOR_EXACT;
  int n;
  if (options->integrator)
    render_option_integrator(options->integrator, &integrator, &n);
  const bool exactly = render_options_channels(options) & ~(uint32_t)TETCAST_CHANNEL_CELLS;
  if (integrator != TETCAST_INTEGRATOR_EXACT && (options->tolerance > 0 || exactly))
    return cli_print("%s: only the exact integrator knows its error, not %s",
                     exactly ? "--channels error" : "--tolerance", options->integrator);
  if (!render_options_channels(options))
    return NULL;
  const char *output = options->output ? options->output : ".png",
             *asked = options->channels ? "--channels " : "--groups";
  const char *list = options->channels ? options->channels : "";
  if (!render_option_has_extension(output, ".exr") && !render_option_is_tiff(output))
    return cli_print("%s%s: only .exr and .tif hold more channels than colour and alpha, not %s", asked, list,
                     options->output ? output : "the default, a .png");
  return render_options_floating(options) ? NULL
                                          : cli_print("%s%s: needs floating-point pixels, not %s", asked, list,
                                                      render_option_choice(OPTION_PIXEL_TYPE, options->pixel_type));
}

static int set_from_text(RenderOptions *options, OptionId id, const char *text) {
  OptionValue value = {.text = text};
  if (id == OPTION_PRESET && options->command == COMMAND_RENDER && !strcmp(text, "list")) {
    options->list_presets = true;
    return -1;
  }
  if (render_table[id].kind == KIND_NUMBERS || render_table[id].kind == KIND_INTEGERS) {
    value.count = cli_parse_numbers(text, id == OPTION_SIZE ? 'x' : ',', render_table[id].most, value.numbers);
    if (value.count > 0 || (id != OPTION_RANGE && id != OPTION_BACKGROUND)) /* which may be words */
      value.text = NULL;
  } else if (render_table[id].kind == KIND_FLAG) {
    value.count = 1;
    value.numbers[0] = 1;
  }
  const char *other = render_options_claim(options, id);
  if (other)
    return cli_usage_error(command_name(options), "--%s and --%s exclude each other", render_table[id].name, other);
  bool length, error;
  if (id == OPTION_CHANNELS && options->command == COMMAND_CAST && !render_option_ray_channels(text, &length, &error))
    return cli_usage_error("cast", "--channels %s: expected length, error, or both", text);
  const char *reason = render_options_set(options, id, &value);
  return reason ? cli_usage_error(command_name(options), "--%s %s: %s", render_table[id].name, text, reason) : -1;
}

/* A series, a single file, or a usage error: two files that are neither. */
static int set_inputs(RenderOptions *options, int count, char **paths) {
  const char *command = command_name(options);
  render_options_claim(options, OPTION_INPUT);
  for (int i = 0; i < count; i++)
    if (!*paths[i])
      return cli_usage_error(command, "the input is '': expected a path");
  if (count > 1 && options->command != COMMAND_RENDER)
    return cli_usage_error(command, "more than one input: '%s' and '%s'; %s about one step", paths[0], paths[1],
                           options->command == COMMAND_CAST ? "rays are" : "a report is");
  if (render_options_set_inputs(options, count, (const char *const *)paths))
    return -1;
  return cli_usage_error(
      command,
      "more than one input: '%s' and '%s'; steps of a series are numbered (step_1.vtu step_2.vtu), and parts of one "
      "mesh are read by a file that lists them (.pvtu, .vtm or .pvd)",
      paths[0], paths[1]);
}

enum { WORD_HELP = 'h', WORD_OUTPUT = 'o', WORD_OPTION = 256 };

/* What getopt_long() is to know of the options of commands, and which they are; ids may be NULL. */
static void list_words(unsigned commands, struct option words[OPTION_COUNT + 2], OptionId ids[OPTION_COUNT]) {
  int count = 0;
  for (int id = 0; id < OPTION_COUNT; id++) {
    if (id == OPTION_INPUT || !render_option_of_command((OptionId)id, commands))
      continue;
    if (ids)
      ids[count] = (OptionId)id;
    words[count++] = (struct option){render_table[id].name,
                                     render_table[id].kind == KIND_FLAG       ? no_argument
                                     : render_table[id].kind == KIND_OPTIONAL ? optional_argument
                                                                              : required_argument,
                                     NULL, WORD_OPTION + id};
  }
  words[count++] = (struct option){"help", no_argument, NULL, WORD_HELP};
  words[count] = (struct option){NULL, 0, NULL, 0};
}

/* The value of an option that may have none: the next word, if it can be that. */
static const char *take_optional(OptionId id, int argc, char **argv) {
  TetcastBoundary boundary;
  double color[3];
  if (optind >= argc || id == OPTION_LEGEND) /* a title could be any word */
    return "";
  const bool fits = id == OPTION_SURFACE ? surfaces_parse_boundary(argv[optind], &boundary)
                    : id == OPTION_DEEP  ? *argv[optind] && render_option_deep(argv[optind])
                    : id == OPTION_TILES ? render_option_tiles(argv[optind]) > 0
                                         : surfaces_parse_color(argv[optind], color);
  return fits ? argv[optind++] : "";
}

/* The words of the command line; with `scene_only` everything but the options --scene and --help is left for later. */
static int parse_words(RenderOptions *options, int argc, char **argv, bool scene_only) {
  struct option words[OPTION_COUNT + 2];
  const bool casts = options->command == COMMAND_CAST; /* which refuses by name what pictures have */
  list_words(casts ? COMMAND_CAST | COMMAND_RENDER : options->command, words, NULL);

  optind = 0; /* getopt starts anew */
  int code;
  while ((code = getopt_long(argc, argv, ":ho:", words, NULL)) != -1) {
    if (code == '?' || code == ':')
      return cli_bad_option(command_name(options), code, argc, argv, words);
    if (code == WORD_HELP) {
      fputs(options->command == COMMAND_RENDER     ? render_help
            : casts                                ? cast_help
            : options->command == COMMAND_CONVERGE ? converge_help
                                                   : transfer_help,
            stdout);
      return cli_finish_output();
    }
    const OptionId id = code == WORD_OUTPUT ? OPTION_OUTPUT : (OptionId)(code - WORD_OPTION);
    if (code == WORD_OUTPUT && !strcmp(optarg, "utput"))
      return cli_usage_error(command_name(options), "unknown option -output; did you mean --output?");
    if (!render_option_of_command(id, options->command))
      return cli_usage_error("cast", "--%s is about pictures: rays that are cast one by one have none",
                             render_table[id].name);
    const char *text = optarg;
    if (!text && render_table[id].kind == KIND_OPTIONAL)
      text = take_optional(id, argc, argv);
    if (scene_only != (id == OPTION_SCENE))
      continue;
    const int result = set_from_text(options, id, text);
    if (result >= 0)
      return result;
  }
  if (scene_only)
    return -1;
  return optind < argc ? set_inputs(options, argc - optind, argv + optind) : -1;
}

/* A scene file states a picture; what converge takes of it is what is seen, at its own size but in the shape of the
 * picture; what cast takes is the scene without its camera. */
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
    if (id == OPTION_OUTPUT || (id == OPTION_CHANNELS && options->command == COMMAND_CAST) ||
        !render_option_of_command((OptionId)id, options->command)) {
      options->given &= ~BIT(id);
      if (render_option_is_text((OptionId)id)) {
        char **text = (char **)((char *)options + render_table[id].at);
        free(*text);
        *text = NULL;
      }
    }
  options->tolerance = standard.tolerance;
}

/* What of a command line of rays is missing or doesn't go together. NULL: nothing. */
static const char *find_rays_fault(const RenderOptions *options) {
  if (!options->rays)
    return "no rays given: --rays RAYS.csv";
  if (!options->output && !options->matrix)
    return "no output given: -o OUT.csv, or --matrix OUT.mtx";
  if (options->output && !ray_file_is_writable(options->output))
    return "-o: expected a name that ends with .csv or .npy";
  if (render_options_given(options, OPTION_BASIS) && !options->matrix)
    return "--basis: needs --matrix";
  if (options->matrix && (options->clip_count > 0 || render_options_given(options, OPTION_CLIP_BOX)))
    return "--matrix: not possible with --clip and --clip-box; begin and end of rays cut them as well";
  if (options->time && !strcmp(options->time, "all"))
    return "--time all: expected a single step";
  if (options->inputs)
    return "a scene of several inputs: rays are about one step";
  if (render_options_range(options) == RANGE_SERIES)
    return "--range series: expected two numbers, LO not above HI, or step";
  if (render_options_lit(options))
    return "--shade volume: light in the volume is seen from a camera, and rays have none";
  return NULL;
}

/* What of the command line is missing or has no use. -1: nothing, else the exit code. */
static int check_use(const RenderOptions *options) {
  if (options->command == COMMAND_TRANSFER && !options->output)
    return cli_usage_error("transfer", "no file for the transfer function given: -o FUNCTION.json");
  if (options->command == COMMAND_TRANSFER && !render_option_has_extension(options->output, ".json"))
    return cli_usage_error("transfer", "--output %s: expected the name of a .json file; --sheet has the picture",
                           options->output);
  if (options->command == COMMAND_TRANSFER && options->time && !strcmp(options->time, "all"))
    return cli_usage_error("transfer", "--time all: expected a single step");
  if (options->command == COMMAND_TRANSFER && options->inputs)
    return cli_usage_error("transfer", "more than one input: '%s' and '%s'", options->inputs[0], options->inputs[1]);
  if (options->command == COMMAND_TRANSFER && options->range_kind == RANGE_SERIES)
    return cli_usage_error("transfer", "--range series: expected two numbers, LO not above HI, or shares");
  const char *rays = options->command == COMMAND_CAST ? find_rays_fault(options) : NULL;
  if (options->command == COMMAND_CONVERGE && !options->output)
    return cli_usage_error("converge", "no folder for the report given: -o REPORTDIR");
  if (options->command == COMMAND_CONVERGE && options->time && !strcmp(options->time, "all"))
    return cli_usage_error("converge", "--time all: expected a single step");
  if (options->command == COMMAND_CONVERGE && render_options_range(options) == RANGE_SERIES)
    return cli_usage_error("converge", "--range series: expected two numbers, LO not above HI, or step");
  if (options->command == COMMAND_CONVERGE && render_options_blend(options) != TETCAST_BLEND_COMPOSITE)
    return cli_usage_error(
        "converge",
        "--blend %s: values along rays are always exact, there is nothing to compare; a report is about composite",
        render_option_choice(OPTION_BLEND, options->blend));
  if (options->command == COMMAND_CONVERGE && render_options_surfaces(options))
    return cli_usage_error(
        "converge",
        "--isosurface, --slice, --surface: a report is about what integrators make of the volume, without surfaces");
  char *mistaken = options->input ? scene_file_mistaken(options->input) : NULL;
  const int result = mistaken ? cli_usage_error(command_name(options), "%s", mistaken) : -1;
  free(mistaken);
  if (options->inputs && options->time && !strncmp(options->time, "t=", 2))
    return cli_usage_error(command_name(options),
                           "--time %s: files on the command line have no times, only numbers, from 0", options->time);
  if (options->input)
    return result < 0 && rays ? cli_usage_error("cast", "%s", rays) : result;
  if (!options->refine)
    return cli_usage_error(command_name(options), "no input given");
  const OptionSet used = BIT(OPTION_OUTPUT) | BIT(OPTION_THREADS) | BIT(OPTION_QUIET) | BIT(OPTION_STRICT) |
                         BIT(OPTION_REFINE) | BIT(OPTION_NO_PLOTS);
  for (int id = 0; id < OPTION_COUNT; id++)
    if (options->given & ~used & BIT(id))
      return cli_usage_error("converge", "--%s needs an input: --refine has a scene of its own", render_table[id].name);
  return -1;
}

int render_options_parse(RenderOptions *options, int argc, char **argv) {
  int result = parse_words(options, argc, argv, true);
  if (result < 0 && options->scene) {
    options->source = 0;
    if (!scene_file_read(options))
      return CLI_FAILED;
    if (options->command == COMMAND_CONVERGE && render_options_direct(options)) {
      cli_error("%s: a scene of extinction or emission arrays is always exact: there is nothing to compare",
                options->scene);
      return CLI_FAILED;
    }
    take_scene(options);
  }
  options->source = 0;
  if (result < 0)
    result = parse_words(options, argc, argv, false);
  if (result < 0 && options->list_presets)
    return result;
  if (result < 0)
    result = check_use(options);
  char *fault = result < 0 ? render_options_fault(options) : NULL;
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

static const char *channel_word(int i) {
  const TetcastChannelInfo *info = tetcast_channel_info(i);
  return info ? info->name : NULL;
}

static const char *const *words_of(RenderCommand command, OptionId id) {
  static const char *presets[COMPLETION_WORDS], *colors[COMPLETION_WORDS], *channels[COMPLETION_WORDS];
  static const char *const integrators[] = {"exact", "midpoint:", "trapezoid:", "gauss:", "table:", NULL};
  static const char *const ranges[] = {"step", "series", NULL}, *const times[] = {"all", NULL},
                           *const of_rays[] = {"length", "error", NULL};
  switch (id) {
  case OPTION_PRESET:
    return completion_words(preset_word, presets);
  case OPTION_BACKGROUND:
    return completion_words(color_name, colors);
  case OPTION_INTEGRATOR:
    return integrators;
  case OPTION_CHANNELS:
    return command == COMMAND_CAST ? of_rays : completion_words(channel_word, channels);
  case OPTION_RANGE:
    return ranges;
  case OPTION_TIME:
    return times;
  default:
    return render_table[id].names;
  }
}

static int complete(RenderCommand command, CompletionOption list[COMPLETION_OPTIONS]) {
  struct option words[OPTION_COUNT + 2];
  OptionId ids[OPTION_COUNT];
  list_words(command, words, ids);
  const int count = completion_of_words(words, list);
  for (int i = 0; i + 1 < count; i++) { /* but for the last, --help */
    if (render_table[ids[i]].kind == KIND_PATH || ids[i] == OPTION_PRESET)
      list[i].kind = COMPLETION_PATH;
    list[i].words = words_of(command, ids[i]);
  }
  return count;
}

int completion_of_render(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_RENDER, list);
}

int completion_of_transfer(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_TRANSFER, list);
}

int completion_of_converge(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_CONVERGE, list);
}

int completion_of_cast(CompletionOption list[COMPLETION_OPTIONS]) {
  return complete(COMMAND_CAST, list);
}
