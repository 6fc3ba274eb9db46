/* SPDX-License-Identifier: Apache-2.0 */
#include "render_options.h"

#include <float.h>
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
#include "numbered.h"
#include "preset_name.h"
#include "surface_text.h"

/* A picture is made by a transfer function or from coefficients. */
#define DIRECT (BIT(OPTION_EXTINCTION) | BIT(OPTION_EMISSION) | BIT(OPTION_GROUPS))
#define TRANSFER                                                                                                       \
  (BIT(OPTION_ARRAY) | BIT(OPTION_TRANSFER) | BIT(OPTION_PRESET) | BIT(OPTION_RANGE) | BIT(OPTION_LABEL) |             \
   BIT(OPTION_LOG) | BIT(OPTION_CENTRE) | BIT(OPTION_OPACITY_MODEL) | BIT(OPTION_BLEND) | BIT(OPTION_ISOSURFACE) |     \
   BIT(OPTION_SLICE) | BIT(OPTION_SURFACE) | BIT(OPTION_EDGES) | BIT(OPTION_LEGEND))

/* What is about pictures alone, and what all commands have but converge. */
#define PICTURES (COMMAND_RENDER | COMMAND_CONVERGE)
#define EXACTLY  (COMMAND_RENDER | COMMAND_CAST)

/* Order of the library's enumerations. */
static const char *const opacity_models[] = {"unit-distance", "vtk-unstructured", "ospray", NULL};
static const char *const blends[] = {"composite", "maximum", "minimum", "average", "additive", NULL};
static const char *const shades[] = {"none", "surfaces", "volume", "all", NULL};
static const char *const normals[] = {"smooth", "flat", NULL};
static const char *const views[] = {"iso", "+x", "-x", "+y", "-y", "+z", "-z", NULL};
static const char *const isas[] = {"auto", "scalar", "avx2", "avx512", NULL};
static const char *const traversals[] = {"shell", "faces", NULL};
static const char *const bases[] = {"cells", "points", NULL}; /* of Basis */
static const char *const pixel_types[] = {"", "uint8", "uint16", "half", "float", "double", NULL};

const RenderRow render_table[OPTION_COUNT] = {
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
    [OPTION_STRETCH] = {"stretch", KIND_NUMBERS, AT(stretch), 3, 3, DBL_MIN, DBL_MAX,
                        .form = "expected three factors x,y,z above 0"},
    [OPTION_TRANSFER] = {"transfer", KIND_PATH, AT(transfer),
                         .excludes = BIT(OPTION_PRESET) | BIT(OPTION_RANGE) | BIT(OPTION_LABEL) | BIT(OPTION_LOG) |
                                     BIT(OPTION_CENTRE) | DIRECT,
                         .form = "expected a transfer function or the path of one"},
    [OPTION_PRESET] = {"preset", KIND_TEXT, AT(preset), .excludes = BIT(OPTION_TRANSFER) | DIRECT,
                       .form = "expected a name, or FILE or FILE:NAME of ParaView's"},
    [OPTION_RANGE] =
        {"range", KIND_NUMBERS, AT(range), 2, 2, -DBL_MAX, DBL_MAX, .excludes = BIT(OPTION_TRANSFER) | DIRECT,
         .form = "expected two numbers, LO not above HI, or shares of the volume as 1%,99%, or step, or series"},
    [OPTION_LOG] = {"log", KIND_FLAG, AT(logarithmic), .excludes = BIT(OPTION_TRANSFER) | BIT(OPTION_CENTRE) | DIRECT,
                    .form = "expected true or false"},
    [OPTION_CENTRE] = {"centre", KIND_NUMBERS, AT(centre), 1, 1, -DBL_MAX, DBL_MAX,
                       .excludes = BIT(OPTION_TRANSFER) | BIT(OPTION_LOG) | DIRECT, .form = "expected a number"},
    [OPTION_LABEL] = {"label", KIND_LIST, AT(labels), .most = 256, .excludes = BIT(OPTION_TRANSFER) | DIRECT,
                      .form =
                          "expected NUMBER[:COLOUR][:OPACITY], a name or #rrggbb or r,g,b, and a number from 0 to 1"},
    [OPTION_OPACITY_MODEL] = {"opacity-model", KIND_CHOICE, AT(opacity_model), .names = opacity_models,
                              .excludes = DIRECT, .form = "expected unit-distance, vtk-unstructured or ospray"},
    [OPTION_EXTINCTION] = {"extinction", KIND_TEXT, AT(extinction), .excludes = TRANSFER, .only = EXACTLY,
                           .form = "expected NAME, NAME:component or NAME:mag"},
    [OPTION_EMISSION] = {"emission", KIND_TEXT, AT(emission), .excludes = TRANSFER, .only = EXACTLY,
                         .form = "expected NAME, NAME:component or NAME:mag"},
    [OPTION_GROUPS] = {"groups", KIND_FLAG, AT(groups), .excludes = TRANSFER, .only = EXACTLY,
                       .form = "expected true or false"},
    [OPTION_BLEND] = {"blend", KIND_CHOICE, AT(blend), .names = blends, .excludes = DIRECT,
                      .form = "expected composite, maximum, minimum, average or additive"},
    [OPTION_ISOSURFACE] =
        {"isosurface", KIND_LIST, AT(isosurfaces), .most = TETCAST_MAX_ISOSURFACES, .excludes = DIRECT,
         .form = "expected VALUE[:COLOUR][:OPACITY], a number, a name or #rrggbb or r,g,b, and a number from 0 to 1"},
    [OPTION_SLICE] = {"slice", KIND_LIST, AT(slices), .most = TETCAST_MAX_SLICES, .excludes = DIRECT,
                      .form = "expected nx,ny,nz,d[:OPACITY]: four numbers, nx,ny,nz not 0,0,0, and one from 0 to 1"},
    [OPTION_SURFACE] = {"surface", KIND_OPTIONAL, AT(surface), .excludes = DIRECT,
                        .form = "expected [COLOUR][:OPACITY], a name, #rrggbb or r,g,b, and a number from 0 to 1"},
    [OPTION_EDGES] = {"edges", KIND_OPTIONAL, AT(edges), .excludes = DIRECT, .only = COMMAND_RENDER,
                      .form = "expected nothing, or a colour: a name, #rrggbb or r,g,b"},
    [OPTION_OUTLINE] = {"outline", KIND_OPTIONAL, AT(outline), .only = COMMAND_RENDER,
                        .form = "expected nothing, or a colour: a name, #rrggbb or r,g,b"},
    [OPTION_LEGEND] = {"legend", KIND_OPTIONAL, AT(legend), .excludes = BIT(OPTION_BARE) | DIRECT,
                       .only = COMMAND_RENDER, .form = "expected nothing, or the title"},
    [OPTION_BARE] = {"bare", KIND_FLAG, AT(bare), .excludes = BIT(OPTION_LEGEND), .only = COMMAND_RENDER,
                     .form = "expected true or false"},
    [OPTION_SHADE] = {"shade", KIND_CHOICE, AT(shade), .names = shades,
                      .form = "expected none, surfaces, volume or all"},
    [OPTION_NORMALS] = {"normals", KIND_CHOICE, AT(normals), .names = normals, .form = "expected smooth or flat"},
    [OPTION_MATERIAL] = {"material", KIND_NUMBERS, AT(material), 4, 4, 0, 10000,
                         .form = "expected ambient,diffuse,specular,exponent: four numbers from 0, the last from 1 to "
                                 "10000"},
    [OPTION_LIGHT] = {"light", KIND_LIST, AT(lights), .most = TETCAST_MAX_LIGHTS,
                      .form = "expected x,y,z[:COLOUR]: where it comes from, not 0,0,0, and a name, #rrggbb or r,g,b"},
    [OPTION_SHADOWS] = {"shadows", KIND_FLAG, AT(shadows), .form = "expected true or false"},
    [OPTION_AMBIENT_OCCLUSION] = {"ambient-occlusion", KIND_INTEGERS, AT(ambient_occlusion), 1, 1, 0, 4096,
                                  .form = "expected a whole number of directions from 1 to 4096, or 0: without"},
    [OPTION_CLIP] = {"clip", KIND_NUMBERS, AT(clip), 4, 4, -DBL_MAX, DBL_MAX,
                     .form = "expected four numbers nx,ny,nz,d, of which nx,ny,nz are not all zero"},
    [OPTION_CLIP_BOX] = {"clip-box", KIND_NUMBERS, AT(clip_box), 6, 6, -DBL_MAX, DBL_MAX,
                         .form = "expected six numbers x0,x1,y0,y1,z0,z1, the first of each pair not above the second"},
    [OPTION_STOP_DEPTH] = {"stop-depth", KIND_PATH, AT(stop_depth), .only = COMMAND_RENDER, .form = "expected a path"},
    [OPTION_EYE] = {"eye", KIND_NUMBERS, AT(eye), 3, 3, -DBL_MAX, DBL_MAX, .only = PICTURES,
                    .excludes = BIT(OPTION_VIEW) | BIT(OPTION_AZIMUTH) | BIT(OPTION_ELEVATION) | BIT(OPTION_ZOOM),
                    .form = "expected three numbers x,y,z"},
    [OPTION_TARGET] = {"target", KIND_NUMBERS, AT(target), 3, 3, -DBL_MAX, DBL_MAX, .only = PICTURES,
                       .form = "expected three numbers x,y,z"},
    [OPTION_UP] = {"up", KIND_NUMBERS, AT(up), 3, 3, -DBL_MAX, DBL_MAX, .only = PICTURES,
                   .form = "expected three numbers x,y,z, not all zero"},
    [OPTION_FOVY] = {"fovy", KIND_NUMBERS, AT(fovy), 1, 1, 1e-6, 179.999999, .excludes = BIT(OPTION_ORTHO),
                     .only = PICTURES, .form = "expected an angle between 0 and 180 degrees"},
    [OPTION_VIEW] = {"view", KIND_CHOICE, AT(view), .names = views, .only = PICTURES,
                     .excludes = BIT(OPTION_EYE) | BIT(OPTION_AZIMUTH) | BIT(OPTION_ELEVATION),
                     .form = "expected iso, or the direction that is looked along: +x, -x, +y, -y, +z or -z"},
    [OPTION_AZIMUTH] = {"azimuth", KIND_NUMBERS, AT(azimuth), 1, 1, -1e6, 1e6, .only = PICTURES,
                        .excludes = BIT(OPTION_EYE) | BIT(OPTION_VIEW), .form = "expected an angle in degrees"},
    [OPTION_ELEVATION] = {"elevation", KIND_NUMBERS, AT(elevation), 1, 1, -90, 90, .only = PICTURES,
                          .excludes = BIT(OPTION_EYE) | BIT(OPTION_VIEW),
                          .form = "expected an angle from -90 to 90 degrees"},
    [OPTION_ZOOM] = {"zoom", KIND_NUMBERS, AT(zoom), 1, 1, 1e-6, 1e6, .only = PICTURES,
                     .excludes = BIT(OPTION_EYE) | BIT(OPTION_ORTHO), .form = "expected a factor from 1e-6 to 1e6"},
    [OPTION_ORTHO] = {"ortho", KIND_NUMBERS, AT(ortho), 1, 1, DBL_MIN, DBL_MAX, .only = PICTURES,
                      .excludes = BIT(OPTION_FOVY) | BIT(OPTION_ZOOM), .form = "expected a height above 0"},
    [OPTION_ORBIT] = {"orbit", KIND_TEXT, AT(orbit), .excludes = BIT(OPTION_DOLLY), .only = COMMAND_RENDER,
                      .form = "expected N[:DEGREES]: how many pictures, from 1 to 1000000, and an angle"},
    [OPTION_DOLLY] = {"dolly", KIND_TEXT, AT(dolly), .excludes = BIT(OPTION_ORBIT), .only = COMMAND_RENDER,
                      .form = "expected N[:FACTOR]: how many pictures, from 1 to 1000000, and a factor above 0"},
    [OPTION_SIZE] = {"size", KIND_INTEGERS, AT(size), 2, 2, 1, 1 << 20, .only = PICTURES,
                     .form = "expected WxH: whole numbers from 1 to 1048576, no more than 2^30 pixels"},
    [OPTION_TILES] = {"tiles", KIND_OPTIONAL, AT(tiles), .only = COMMAND_RENDER,
                      .form = "expected nothing, or a whole number of rows from 1 to 1048576"},
    [OPTION_SAMPLES] = {"samples", KIND_INTEGERS, AT(samples), 1, 1, 1, 65536, .excludes = BIT(OPTION_ADAPTIVE),
                        .only = COMMAND_RENDER, .form = "expected a whole number from 1 to 65536"},
    [OPTION_ADAPTIVE] = {"adaptive", KIND_NUMBERS, AT(adaptive), 1, 3, 0, DBL_MAX, .excludes = BIT(OPTION_SAMPLES),
                         .only = COMMAND_RENDER,
                         .form = "expected EPS[,COARSE[,FINE]]: a number, 0 or above, a power of two from 1 to 64, and "
                                 "a whole number from 1 to 65536"},
    [OPTION_BACKGROUND] = {"background", KIND_NUMBERS, AT(background), 3, 4, 0, 1, .only = COMMAND_RENDER,
                           .form =
                               "expected r,g,b or r,g,b,a from 0 to 1, a name such as white, transparent or soft, or "
                               "#rrggbb"},
    [OPTION_EXPOSURE] = {"exposure", KIND_NUMBERS, AT(exposure), 1, 1, -1000, 1000, .only = COMMAND_RENDER,
                         .form = "expected a number of stops from -1000 to 1000"},
    [OPTION_INTEGRATOR] =
        {"integrator", KIND_TEXT, AT(integrator), .only = COMMAND_RENDER,
         .form = "expected exact, midpoint:N, trapezoid:N, gauss:N (N to 16) or table:N (N from 2 to 4096)"},
    [OPTION_TOLERANCE] = {"tolerance", KIND_NUMBERS, AT(tolerance), 1, 1, 0, DBL_MAX, .only = COMMAND_RENDER,
                          .form = "expected a number, 0 or above"},
    [OPTION_CHANNELS] = {"channels", KIND_TEXT, AT(channels), .only = EXACTLY,
                         .form = "expected error, or depth, normal, or value, or of radiance, optical_depth, "
                                 "transmittance, path_length some; "
                                 "and cells"},
    [OPTION_DEEP] = {"deep", KIND_OPTIONAL, AT(deep), .only = COMMAND_RENDER,
                     .form = "expected nothing, or a whole number from 1 to 1024"},
    [OPTION_TRAVERSAL] = {"traversal", KIND_CHOICE, AT(traversal), .names = traversals,
                          .form = "expected shell or faces"},
    [OPTION_ISA] = {"isa", KIND_CHOICE, AT(isa), .names = isas, .form = "expected auto, scalar, avx2 or avx512"},
    [OPTION_THREADS] = {"threads", KIND_INTEGERS, AT(threads), 1, 1, 0, 4096,
                        .form = "expected a whole number from 0 (all) to 4096"},
    [OPTION_REPEAT] = {"repeat", KIND_INTEGERS, AT(repeat), 1, 1, 1, 1e6, .only = PICTURES,
                       .form = "expected a whole number from 1 to 1000000"},
    [OPTION_PIXEL_TYPE] = {"pixel-type", KIND_CHOICE, AT(pixel_type), .names = pixel_types, .only = COMMAND_RENDER,
                           .form = "expected uint8, uint16, half, float or double"},
    [OPTION_STATS] = {"stats", KIND_PATH, AT(stats), .only = COMMAND_RENDER, .form = "expected a path"},
    [OPTION_SCENE] = {"scene", KIND_PATH, AT(scene), .form = "expected a path"},
    [OPTION_SAVE_SCENE] = {"save-scene", KIND_PATH, AT(save_scene), .only = COMMAND_RENDER, .form = "expected a path"},
    [OPTION_RESUME] = {"resume", KIND_FLAG, AT(resume), .only = COMMAND_RENDER, .form = "expected true or false"},
    [OPTION_MPI] = {"mpi", KIND_FLAG, AT(mpi), .only = COMMAND_RENDER, .form = "expected true or false"},
    [OPTION_STRICT] = {"strict", KIND_FLAG, AT(strict), .form = "expected true or false"},
    [OPTION_QUIET] = {"quiet", KIND_FLAG, AT(quiet), .form = "expected true or false"},
    [OPTION_REFINE] = {"refine", KIND_FLAG, AT(refine), .only = COMMAND_CONVERGE},
    [OPTION_NO_PLOTS] = {"no-plots", KIND_FLAG, AT(no_plots), .only = COMMAND_CONVERGE},
    [OPTION_RAYS] = {"rays", KIND_PATH, AT(rays), .only = COMMAND_CAST, .form = "expected a path"},
    [OPTION_MATRIX] = {"matrix", KIND_PATH, AT(matrix), .only = COMMAND_CAST, .form = "expected a path"},
    [OPTION_BASIS] = {"basis", KIND_CHOICE, AT(basis), .names = bases, .only = COMMAND_CAST,
                      .form = "expected cells or points"},
    [OPTION_SHEET] = {"sheet", KIND_PATH, AT(sheet), .only = COMMAND_TRANSFER, .form = "expected a path"},
    [OPTION_TAKE] = {"take", KIND_INTEGERS, AT(take), 1, 1, 1, 100, .only = COMMAND_TRANSFER,
                     .form = "expected the number of a candidate"},
    [OPTION_PLOTS] = {"plots", KIND_PATH, AT(plots), .only = COMMAND_TRANSFER, .form = "expected a path"},
};

_Static_assert(OPTION_COUNT <= 128, "sets of options are 128 bits");

/* What the command transfer has of the others' options: what is read, and from where it is seen. */
static const OptionSet of_transfer =
    BIT(OPTION_INPUT) | BIT(OPTION_OUTPUT) | BIT(OPTION_ARRAY) | BIT(OPTION_BLOCK) | BIT(OPTION_TIME) |
    BIT(OPTION_MERGE_TOLERANCE) | BIT(OPTION_CELL_TO_POINT) | BIT(OPTION_SUBDIVIDE) | BIT(OPTION_NO_DISPLACEMENT) |
    BIT(OPTION_STRETCH) | BIT(OPTION_PRESET) | BIT(OPTION_RANGE) | BIT(OPTION_LOG) | BIT(OPTION_CENTRE) |
    BIT(OPTION_CLIP) | BIT(OPTION_CLIP_BOX) | BIT(OPTION_EYE) | BIT(OPTION_TARGET) | BIT(OPTION_UP) | BIT(OPTION_FOVY) |
    BIT(OPTION_VIEW) | BIT(OPTION_AZIMUTH) | BIT(OPTION_ELEVATION) | BIT(OPTION_ZOOM) | BIT(OPTION_ORTHO) |
    BIT(OPTION_SIZE) | BIT(OPTION_TRAVERSAL) | BIT(OPTION_ISA) | BIT(OPTION_THREADS) | BIT(OPTION_STRICT) |
    BIT(OPTION_QUIET);

bool render_option_of_command(OptionId id, unsigned commands) {
  const unsigned only = render_table[id].only;
  if (commands & COMMAND_TRANSFER && (of_transfer >> id & 1 || only & COMMAND_TRANSFER))
    return true;
  commands &= ~(unsigned)COMMAND_TRANSFER;
  return commands && (!only || only & commands);
}

RenderOptions render_options_default(RenderCommand command) {
  RenderOptions options = {.command = command,
                           .size = {1024, 768},
                           .samples = 1,
                           .background = {1, 1, 1, 1},
                           .zoom = 1,
                           .repeat = 1,
                           .merge_tolerance = -1,
                           .stretch = {1, 1, 1}};
  if (command == COMMAND_TRANSFER) {
    options.size[0] = 288;
    options.size[1] = 216;
  }
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

static void clear_list(TextList *list) {
  for (int i = 0; i < list->count; i++)
    free(list->text[i]);
  free(list->text);
  *list = (TextList){0};
}

void render_options_release(RenderOptions *options) {
  clear_list(&options->isosurfaces);
  clear_list(&options->slices);
  clear_list(&options->lights);
  clear_list(&options->labels);
  for (int id = 0; id < OPTION_COUNT; id++)
    if (render_option_is_text((OptionId)id))
      free(*(char **)((char *)options + render_table[id].at));
  json_decref(options->transfer_object);
  free(options->clip);
  release_inputs(options);
}

OptionId render_option_find(const char *key) {
  for (int id = 0; id < OPTION_COUNT; id++) {
    const char *a = render_table[id].name, *b = key;
    while (*a && (*a == *b || (*a == '-' && *b == '_'))) {
      a++;
      b++;
    }
    if (!*a && !*b)
      return render_option_of_command((OptionId)id, COMMAND_RENDER) ? (OptionId)id : OPTION_COUNT;
  }
  return OPTION_COUNT;
}

const char *render_option_key(OptionId id) {
  const bool of_runs = id == OPTION_SCENE || id == OPTION_SAVE_SCENE || id == OPTION_MPI; /* and of no picture */
  return render_option_of_command(id, COMMAND_RENDER) && !of_runs ? render_table[id].name : NULL;
}

bool render_option_is_path(OptionId id) {
  return render_table[id].kind == KIND_PATH;
}

bool render_option_is_flag(OptionId id) {
  return render_table[id].kind == KIND_FLAG;
}

bool render_option_is_text(OptionId id) {
  const OptionKind kind = render_table[id].kind;
  return kind == KIND_TEXT || kind == KIND_PATH || kind == KIND_OPTIONAL;
}

bool render_option_is_list(OptionId id) {
  return render_table[id].kind == KIND_LIST;
}

const char *render_option_choice(OptionId id, int value) {
  return render_table[id].names[value];
}

const char *render_options_claim(RenderOptions *options, OptionId id) {
  for (int other = 0; other < OPTION_COUNT; other++)
    if (options->source & render_table[id].excludes & BIT(other))
      return render_table[other].name;
  if (render_option_is_list(id) && !(options->source & BIT(id))) /* of another source */
    clear_list((TextList *)((char *)options + render_table[id].at));
  if (id == OPTION_CLIP && !(options->source & BIT(id)))
    options->clip_count = 0; /* those of another source are replaced */
  options->given = (options->given & ~render_table[id].excludes) | BIT(id);
  options->source |= BIT(id);
  return NULL;
}

static const char *check_preset(const char *name) {
  static char reason[512];
  if (preset_name_is_file(name) || tetcast_preset_kind(name) != TETCAST_PRESET_NONE)
    return NULL;
  size_t length =
      (size_t)snprintf(reason, sizeof reason, "there is no such preset, nor is it a .json or .xml; there are");
  CliGuess guess = {.word = name};
  for (int i = 0; tetcast_preset_name(i); i++) {
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
  } integrators[] = {
      {"exact", 0, 0}, {"midpoint:", 1, 1 << 20}, {"trapezoid:", 1, 1 << 20}, {"gauss:", 1, 16}, {"table:", 2, 4096}};
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

static uint32_t channel_bit(const char *name, size_t length) {
  const TetcastChannelInfo *info;
  for (int i = 0; (info = tetcast_channel_info(i)); i++)
    if (strlen(info->name) == length && !strncmp(info->name, name, length))
      return (uint32_t)info->channel;
  return 0;
}

int render_option_channel_list(const char *text, TetcastChannel channels[32]) {
  uint32_t all = 0;
  for (int count = 0;;) {
    const size_t length = strcspn(text, ",");
    const uint32_t bit = channel_bit(text, length);
    if (!bit || all & bit)
      return 0;
    all |= bit;
    channels[count++] = (TetcastChannel)bit;
    if (!text[length])
      return count;
    text += length + 1;
  }
}

bool render_option_ray_channels(const char *text, bool *length, bool *error) {
  *length = *error = false;
  for (;;) {
    const size_t size = strcspn(text, ",");
    bool *named = size == 6 && !strncmp(text, "length", size)  ? length
                  : size == 5 && !strncmp(text, "error", size) ? error
                                                               : NULL;
    if (!named || *named)
      return false;
    *named = true;
    if (!text[size])
      return true;
    text += size + 1;
  }
}

uint32_t render_option_channels(const char *text) {
  TetcastChannel list[32];
  uint32_t channels = 0;
  for (int i = render_option_channel_list(text, list); i > 0; i--)
    channels |= (uint32_t)list[i - 1];
  return channels;
}

int render_option_deep(const char *text) {
  double number = 32;
  if (*text && !cli_parse_number(text, &number))
    return 0;
  return number >= 1 && number <= 1024 && number == floor(number) ? (int)number : 0;
}

int render_option_tiles(const char *text) {
  double number = 0;
  if (!*text)
    return 0;
  return cli_parse_number(text, &number) && number >= 1 && number <= 1 << 20 && number == floor(number) ? (int)number
                                                                                                        : -1;
}

bool render_option_tour(OptionId id, const char *text, double numbers[2]) {
  numbers[1] = id == OPTION_DOLLY ? 2 : 360;
  return cli_parse_numbers(text, ':', 2, numbers) > 0 && numbers[0] >= 1 && numbers[0] <= 1e6 &&
         numbers[0] == floor(numbers[0]) && (id == OPTION_ORBIT || numbers[1] > 0);
}

int render_options_deep(const RenderOptions *options) {
  return render_options_given(options, OPTION_DEEP) ? render_option_deep(options->deep) : 0;
}

bool render_options_groups(const RenderOptions *options) {
  return render_options_given(options, OPTION_GROUPS) && options->groups;
}

uint32_t render_options_channels(const RenderOptions *options) {
  bool length, error;
  if (options->command == COMMAND_CAST)
    return options->channels && render_option_ray_channels(options->channels, &length, &error) && error
               ? TETCAST_CHANNEL_ERROR
               : 0;
  if (options->channels)
    return render_option_channels(options->channels);
  if (!render_options_groups(options))
    return 0;
  return render_options_given(options, OPTION_EMISSION) ? TETCAST_CHANNEL_RADIANCE : TETCAST_CHANNEL_TRANSMITTANCE;
}

bool render_option_has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length > tail && !strcasecmp(path + length - tail, extension);
}

bool render_option_is_tiff(const char *path) {
  return render_option_has_extension(path, ".tif") || render_option_has_extension(path, ".tiff");
}

bool render_options_floating(const RenderOptions *options) {
  if (options->pixel_type != TETCAST_PIXEL_DEFAULT)
    return options->pixel_type >= TETCAST_PIXEL_HALF;
  return options->output &&
         (render_option_has_extension(options->output, ".exr") || render_option_is_tiff(options->output) ||
          render_option_has_extension(options->output, ".hdr") ||
          render_option_has_extension(options->output, ".rgbe"));
}

void render_options_soften(RenderOptions *options) {
  static const double middle[4] = {0.88, 0.905, 0.94, 1};
  options->soft = 1;
  memcpy(options->background, middle, sizeof middle);
}

bool render_options_decorated(const RenderOptions *options) {
  return options->command == COMMAND_RENDER && !options->bare && !options->scene && !render_options_floating(options) &&
         !render_options_direct(options);
}

double render_options_gain(const RenderOptions *options) {
  return render_options_floating(options) ? 1 : exp2(options->exposure);
}

static const char *set_numbers(OptionId id, void *at, const OptionValue *value) {
  const double *numbers = value->numbers;
  if (value->text || value->count < render_table[id].least || value->count > render_table[id].most)
    return render_table[id].form;
  for (int i = 0; i < value->count; i++)
    if (!(numbers[i] >= render_table[id].low && numbers[i] <= render_table[id].high) ||
        (render_table[id].kind == KIND_INTEGERS && numbers[i] != floor(numbers[i])))
      return render_table[id].form;
  if ((id == OPTION_SIZE && numbers[0] * numbers[1] > 0x1p30) || (id == OPTION_RANGE && numbers[0] > numbers[1]) ||
      (id == OPTION_MATERIAL && numbers[3] < 1) ||
      (id == OPTION_UP && numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0) ||
      (id == OPTION_CLIP_BOX && (numbers[0] > numbers[1] || numbers[2] > numbers[3] || numbers[4] > numbers[5])))
    return render_table[id].form;
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
    snprintf(reason, sizeof reason, "%s%s", render_table[id].form, hint);
    free(hint);
    return reason;
  }
  memcpy(rgba, color, sizeof color);
  return NULL;
}

/* A colour, or "soft". */
static const char *set_background(RenderOptions *options, const OptionValue *value) {
  options->soft = value->text && !strcmp(value->text, "soft");
  if (!options->soft)
    return set_color(OPTION_BACKGROUND, options->background, value);
  render_options_soften(options);
  return NULL;
}

static const char *set_choice(OptionId id, void *at, const OptionValue *value) {
  for (int i = 0; value->text && *value->text && render_table[id].names[i]; i++) {
    if (!strcmp(value->text, render_table[id].names[i])) {
      memcpy(at, &i, sizeof i);
      return NULL;
    }
  }
  return render_table[id].form;
}

static const char *add_to_list(OptionId id, TextList *list, const OptionValue *value) {
  TetcastIsosurface isosurface;
  TetcastLight light;
  TetcastSlice slice;
  bool colored;
  const char *text = value->text;
  if (!text || !(id == OPTION_LIGHT   ? surfaces_parse_light(text, &light)
                 : id == OPTION_SLICE ? surfaces_parse_slice(text, &slice)
                                      : surfaces_parse(text, &isosurface, &colored)))
    return render_table[id].form;
  if (list->count == render_table[id].most)
    return "there are too many of them";
  char **longer = cli_allocate(sizeof *longer * (size_t)(list->count + 1));
  if (list->count > 0)
    memcpy(longer, list->text, sizeof *longer * (size_t)list->count);
  longer[list->count] = cli_duplicate(value->text);
  free(list->text);
  *list = (TextList){longer, list->count + 1};
  return NULL;
}

/* "1%,99%" as shares. */
static bool parse_shares(const char *text, double shares[2]) {
  char *numbers = cli_duplicate(text);
  int signs = 0, kept = 0;
  for (int i = 0; text[i]; i++) {
    const bool sign = text[i] == '%' && (text[i + 1] == ',' || !text[i + 1]);
    signs += sign;
    if (!sign)
      numbers[kept++] = text[i];
  }
  numbers[kept] = 0;
  const bool fine = signs == 2 && cli_parse_numbers(numbers, ',', 2, shares) == 2 && shares[0] >= 0 &&
                    shares[0] < shares[1] && shares[1] <= 100;
  free(numbers);
  shares[0] /= 100;
  shares[1] /= 100;
  return fine;
}

static const char *set_range(RenderOptions *options, const OptionValue *value) {
  double shares[2];
  if (value->text && parse_shares(value->text, shares)) {
    memcpy(options->range, shares, sizeof shares);
    options->range_kind = RANGE_QUANTILES;
    return NULL;
  }
  const bool step = value->text && !strcmp(value->text, "step"), series = value->text && !strcmp(value->text, "series");
  const char *reason = step || series ? NULL : set_numbers(OPTION_RANGE, options->range, value);
  if (!reason)
    options->range_kind = step ? RANGE_STEP : series ? RANGE_SERIES : RANGE_FIXED;
  return reason;
}

static const char *set_adaptive(double adaptive[3], const OptionValue *value) {
  double given[3] = {0, 4, 1};
  const char *reason = set_numbers(OPTION_ADAPTIVE, given, value);
  if (reason)
    return reason;
  const double coarse = given[1], fine = given[2];
  if (!(coarse >= 1 && coarse <= 64 && exp2(floor(log2(coarse))) == coarse) ||
      !(fine >= 1 && fine <= 65536 && fine == floor(fine)))
    return render_table[OPTION_ADAPTIVE].form;
  memcpy(adaptive, given, sizeof given);
  return NULL;
}

/* One half-space more. */
static const char *add_half_space(RenderOptions *options, const OptionValue *value) {
  const double *n = value->numbers;
  if (value->text || value->count != 4 || (n[0] == 0 && n[1] == 0 && n[2] == 0))
    return render_table[OPTION_CLIP].form;
  options->clip = cli_grow(options->clip, options->clip_count, &options->clip_capacity, sizeof *options->clip);
  options->clip[options->clip_count++] = (TetcastHalfSpace){.normal = {n[0], n[1], n[2]}, .offset = n[3]};
  return NULL;
}

const char *render_options_set(RenderOptions *options, OptionId id, const OptionValue *value) {
  void *at = (char *)options + render_table[id].at;
  if (id == OPTION_RANGE)
    return set_range(options, value);
  if (id == OPTION_BACKGROUND)
    return set_background(options, value);
  if (id == OPTION_ADAPTIVE)
    return set_adaptive(options->adaptive, value);
  if (id == OPTION_CLIP)
    return add_half_space(options, value);
  switch (render_table[id].kind) {
  case KIND_NUMBERS:
  case KIND_INTEGERS:
    return set_numbers(id, at, value);
  case KIND_CHOICE:
    return set_choice(id, at, value);
  case KIND_LIST:
    return add_to_list(id, at, value);
  case KIND_FLAG:
    *(int *)at = value->count == 1 && value->numbers[0] != 0;
    return NULL;
  default:
    if (!value->text || (!*value->text && render_table[id].kind != KIND_OPTIONAL))
      return render_table[id].form;
    TetcastBoundary boundary;
    double color[3];
    if (id == OPTION_SURFACE && !surfaces_parse_boundary(value->text, &boundary))
      return render_table[id].form;
    if (id == OPTION_DEEP && !render_option_deep(value->text))
      return render_table[id].form;
    if ((id == OPTION_EDGES || id == OPTION_OUTLINE) && *value->text && !surfaces_parse_color(value->text, color))
      return render_table[id].form;
    if (id == OPTION_TILES && render_option_tiles(value->text) < 0)
      return render_table[id].form;
    double tour[2];
    if ((id == OPTION_ORBIT || id == OPTION_DOLLY) && !render_option_tour(id, value->text, tour))
      return render_table[id].form;
    TetcastIntegrator integrator;
    int n;
    const char *reason = id == OPTION_PRESET ? check_preset(value->text) : NULL;
    if (id == OPTION_INTEGRATOR && !render_option_integrator(value->text, &integrator, &n))
      reason = render_table[id].form;
    bool length, error;
    if (id == OPTION_CHANNELS && !render_option_channels(value->text) &&
        !(options->command == COMMAND_CAST && render_option_ray_channels(value->text, &length, &error)))
      reason = render_table[id].form;
    if (id == OPTION_TIME && !render_option_dataset(NULL, value->text, -1, &(TetcastDatasetDesc){0}))
      reason = render_table[id].form;
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
