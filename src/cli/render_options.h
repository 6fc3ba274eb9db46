/* SPDX-License-Identifier: Apache-2.0 */
/* What a picture is made of, from the command line and from a scene file: one table, one check of values for both, and
 * for both commands that render. */
#ifndef TETCAST_CLI_RENDER_OPTIONS_H
#define TETCAST_CLI_RENDER_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include <tetcast/dataset.h>
#include <tetcast/scene.h>

typedef enum OptionId {
  OPTION_INPUT,
  OPTION_OUTPUT,
  OPTION_ARRAY,
  OPTION_BLOCK,
  OPTION_TIME,
  OPTION_MERGE_TOLERANCE,
  OPTION_CELL_TO_POINT,
  OPTION_SUBDIVIDE,
  OPTION_NO_DISPLACEMENT,
  OPTION_STRETCH,
  OPTION_TRANSFER,
  OPTION_PRESET,
  OPTION_RANGE,
  OPTION_LABEL,
  OPTION_LOG,
  OPTION_CENTRE,
  OPTION_OPACITY_MODEL,
  OPTION_EXTINCTION,
  OPTION_EMISSION,
  OPTION_GROUPS,
  OPTION_BLEND,
  OPTION_ISOSURFACE,
  OPTION_SLICE,
  OPTION_SURFACE,
  OPTION_EDGES,
  OPTION_OUTLINE,
  OPTION_LEGEND,
  OPTION_BARE,
  OPTION_SHADE,
  OPTION_NORMALS,
  OPTION_MATERIAL,
  OPTION_LIGHT,
  OPTION_SHADOWS,
  OPTION_AMBIENT_OCCLUSION,
  OPTION_CLIP,
  OPTION_CLIP_BOX,
  OPTION_STOP_DEPTH,
  OPTION_EYE,
  OPTION_TARGET,
  OPTION_UP,
  OPTION_FOVY,
  OPTION_VIEW,
  OPTION_AZIMUTH,
  OPTION_ELEVATION,
  OPTION_ZOOM,
  OPTION_ORTHO,
  OPTION_ORBIT,
  OPTION_DOLLY,
  OPTION_SIZE,
  OPTION_TILES,
  OPTION_SAMPLES,
  OPTION_ADAPTIVE,
  OPTION_BACKGROUND,
  OPTION_EXPOSURE,
  OPTION_INTEGRATOR,
  OPTION_TOLERANCE,
  OPTION_CHANNELS,
  OPTION_DEEP,
  OPTION_TRAVERSAL,
  OPTION_ISA,
  OPTION_THREADS,
  OPTION_REPEAT,
  OPTION_PIXEL_TYPE,
  OPTION_STATS,
  OPTION_SCENE,
  OPTION_SAVE_SCENE,
  OPTION_RESUME,
  OPTION_MPI,
  OPTION_STRICT,
  OPTION_QUIET,
  OPTION_REFINE,
  OPTION_NO_PLOTS,
  OPTION_SHEET,
  OPTION_TAKE,
  OPTION_PLOTS,
  OPTION_RAYS,
  OPTION_MATRIX,
  OPTION_BASIS,
  OPTION_COUNT
} OptionId;

/* A set of options, bit 1 << OptionId for each. */
__extension__ typedef unsigned __int128 OptionSet;

/* Bits of a set. */
typedef enum RenderCommand {
  COMMAND_RENDER = 1,
  COMMAND_CONVERGE = 2,
  COMMAND_CAST = 4,
  COMMAND_TRANSFER = 8
} RenderCommand;

/* The kinds of range that --range can name. */
typedef enum RangeKind { RANGE_DEFAULT, RANGE_FIXED, RANGE_QUANTILES, RANGE_STEP, RANGE_SERIES } RangeKind;

/* What an option has that may be given several times. */
typedef struct TextList {
  char **text; /* [count] */
  int count;
} TextList;

typedef struct RenderOptions {
  RenderCommand command;
  /* NULL unless given */
  char *input, *output, *array, *block, *time, *transfer, *preset, *extinction, *emission, *integrator, *channels,
      *surface, *edges, *outline, *legend, *deep, *stats, *scene, *save_scene, *stop_depth, *orbit, *dolly, *tiles,
      *sheet, *plots, *rays, *matrix;
  char **inputs; /* [input_count] of several files, the steps of a series; input is the first. NULL: one file */
  int input_count;
  json_t *transfer_object;    /* of a scene file; instead of transfer */
  const json_t *scene_object; /* what the scene file holds, or a scene that `scene` is only a name of; NULL: not read */
  const char *scene_folder;   /* what paths in it are relative to; NULL: the folder of the file */
  TetcastHalfSpace *clip;     /* [clip_count] */
  int clip_count, clip_capacity;
  double clip_box[6]; /* x0, x1, y0, … */
  double stretch[3], exposure, take;
  double range[2], centre, eye[3], target[3], up[3], fovy, azimuth, elevation, zoom, ortho, size[2], samples,
      background[4], tolerance, threads, repeat;
  double material[4], adaptive[3]; /* epsilon, coarse, fine */
  TextList isosurfaces, slices, lights, labels;
  double merge_tolerance; /* negative unless given */
  RangeKind range_kind;   /* RANGE_FIXED: options->range; RANGE_QUANTILES: these shares of the volume */
  double subdivide, ambient_occlusion;
  int opacity_model, blend, shade, normals, view, traversal, isa, pixel_type; /* values of the library's enumerations */
  int cell_to_point, no_displacement, quiet, strict, resume, refine, no_plots, groups, shadows, logarithmic, bare, soft,
      mpi;
  int list_presets; /* instead of a picture */
  int basis;        /* a Basis */
  OptionSet given;  /* those that have a value from command line or scene file */
  OptionSet source; /* the same for the source being read alone */
} RenderOptions;

/* A value as both sources can state it. */
typedef struct OptionValue {
  const char *text; /* NULL: numbers */
  int count;
  double numbers[6];
} OptionValue;

RenderOptions render_options_default(RenderCommand command);
void render_options_release(RenderOptions *options);

static inline bool render_options_given(const RenderOptions *options, OptionId id) {
  return options->given >> id & 1;
}

/* The option of a scene file's key, e.g. "pixel_type" or "pixel-type"; OPTION_COUNT: none. */
OptionId render_option_find(const char *key);
/* The key of an option in a scene file, NULL: it has none. */
const char *render_option_key(OptionId id);
bool render_option_is_path(OptionId id);
bool render_option_is_flag(OptionId id);
/* Whether its value is a text, which the options own. */
bool render_option_is_text(OptionId id);
/* Whether it may be given several times, each adding to what it has. */
bool render_option_is_list(OptionId id);

/* The name of a choice's value. */
const char *render_option_choice(OptionId id, int value);

/* What --integrator names: "exact", or "midpoint:4" and the like. False: neither. */
bool render_option_integrator(const char *text, TetcastIntegrator *integrator, int *n);

/* What --block, --time and --merge-tolerance say (NULL, NULL, negative: nothing). False: the time is neither a step,
 * e.g. "3", nor a time, e.g. "t=0.5", nor "all", which leaves the first step. */
bool render_option_dataset(const char *block, const char *time, double merge_tolerance, TetcastDatasetDesc *desc);

/* What --range says; RANGE_DEFAULT where it is not given, or given up for a transfer function. */
static inline RangeKind render_options_range(const RenderOptions *options) {
  return render_options_given(options, OPTION_RANGE) ? options->range_kind : RANGE_DEFAULT;
}

/* The colour map where no transfer function is given. */
static inline const char *render_options_preset(const RenderOptions *options) {
  return render_options_given(options, OPTION_PRESET) ? options->preset : "viridis";
}

/* Whether extinction or emission come from arrays of their own. */
static inline bool render_options_direct(const RenderOptions *options) {
  return render_options_given(options, OPTION_EXTINCTION) || render_options_given(options, OPTION_EMISSION);
}

/* The blend mode. */
static inline TetcastBlend render_options_blend(const RenderOptions *options) {
  return render_options_given(options, OPTION_BLEND) ? (TetcastBlend)options->blend : TETCAST_BLEND_COMPOSITE;
}

/* Whether there are surfaces of any kind. */
static inline bool render_options_surfaces(const RenderOptions *options) {
  return render_options_given(options, OPTION_ISOSURFACE) || render_options_given(options, OPTION_SLICE) ||
         render_options_given(options, OPTION_SURFACE);
}

/* Whether light falls on the volume. */
static inline bool render_options_lit(const RenderOptions *options) {
  return render_options_given(options, OPTION_SHADE) && options->shade & TETCAST_SHADE_VOLUME;
}

/* Whether surfaces are all there is to see: no transfer function was given beside them. */
static inline bool render_options_surfaces_alone(const RenderOptions *options) {
  return render_options_surfaces(options) && !render_options_given(options, OPTION_TRANSFER);
}

/* Makes the background soft: a bit brighter below, and darker above, than the colour that stands for it here. */
void render_options_soften(RenderOptions *options);

/* Whether a picture that nothing was said about has a box, a legend and a soft background: one for people to look at.
 */
bool render_options_decorated(const RenderOptions *options);

/* How many parts the rays of a deep picture have; 0: it is none. */
int render_options_deep(const RenderOptions *options);

/* The number of parts that a text says, 32 where it is empty; 0: it says none. */
int render_option_deep(const char *text);

/* Whether rays are cast only where the picture has something to show. */
static inline bool render_options_adaptive(const RenderOptions *options) {
  return render_options_given(options, OPTION_ADAPTIVE);
}

/* The number of rows that --tiles says, 0 where its text is empty; -1: it says none. */
int render_option_tiles(const char *text);

/* What --orbit or --dolly says: how many pictures, and the degrees or the factor. False: neither N nor N:AMOUNT. */
bool render_option_tour(OptionId id, const char *text, double numbers[2]);

/* The TetcastChannel bits of a list as --channels has it, 0: there is something else in it. */
uint32_t render_option_channels(const char *text);

/* The same one by one, in the order of the list; returns how many there are. */
int render_option_channel_list(const char *text, TetcastChannel channels[32]);

/* What --channels of rays names: "length", "error" or both. False: anything else. */
bool render_option_ray_channels(const char *text, bool *length, bool *error);

/* Those of the frame; --groups alone means the radiance, or the transmittance when nothing is emitted. */
uint32_t render_options_channels(const RenderOptions *options);

/* Whether the pixels of options->output will be floating-point, which hold no background. */
bool render_options_floating(const RenderOptions *options);

/* The factor on colours where pixels are integers; else 1. */
double render_options_gain(const RenderOptions *options);

/* Sets the input, or several as the steps of a series: their names differ in one number, by which they are sorted.
 * False: they are no such series, and nothing is set. */
bool render_options_set_inputs(RenderOptions *options, int count, const char *const *paths);

/* Sets an option, or adds to its list. NULL, or why the value can't be (static storage or inside the options). */
const char *render_options_set(RenderOptions *options, OptionId id, const OptionValue *value);

/* Notes that the current source gives an option, and takes back what excludes it of another source. NULL, or the name
 * of an option of the same source that excludes it. */
const char *render_options_claim(RenderOptions *options, OptionId id);

/* ── the table, for what reads the command line ── */

typedef enum OptionKind {
  KIND_TEXT,
  KIND_PATH,
  KIND_NUMBERS,
  KIND_INTEGERS,
  KIND_CHOICE,
  KIND_FLAG,
  KIND_LIST,
  KIND_OPTIONAL
} OptionKind;

#define BIT(id)    ((OptionSet)1 << (id))
#define AT(member) offsetof(RenderOptions, member)

typedef struct RenderRow {
  const char *name;
  OptionKind kind;
  size_t at;                /* where the value goes in RenderOptions */
  int least, most;          /* how many numbers */
  double low, high;         /* bounds of each */
  const char *const *names; /* of a choice */
  OptionSet excludes;
  unsigned only;    /* of these commands alone, RenderCommand; 0: of all, but of transfer only if it is among its own */
  const char *form; /* what is expected */
} RenderRow;

extern const RenderRow render_table[OPTION_COUNT];

/* Whether it is of any of these commands. */
bool render_option_of_command(OptionId id, unsigned commands);

/* What the name of a picture ends with. */
bool render_option_has_extension(const char *path, const char *extension);
bool render_option_is_tiff(const char *path);

/* Whether --groups is given and is yes. */
bool render_options_groups(const RenderOptions *options);

#endif
