/* SPDX-License-Identifier: Apache-2.0 */
#include "info.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <tetcast/tetcast.h>

#include "cli.h"
#include "completion.h"
#include "render_options.h"
#include "scene_file.h"

static const char help_text[] =
    "Usage: tetcast info INPUT [options]\n"
    "       tetcast info --formats\n"
    "\n"
    "Shows what is in a mesh file: time steps, blocks, cells by type, arrays with their ranges and numbers of NaN\n"
    "and infinite values, bounds, and the health of the tetrahedra that the cells are cut into.\n"
    "\n"
    "      --json               as JSON, for scripts\n"
    "      --statistics         also the values below which shares of the volume lie, exactly\n"
    "      --block NAME         only this block, or group of blocks\n"
    "      --time STEP          of a series this step, from 0, the default; -1 is the last; or t=TIME\n"
    "      --merge-tolerance D  points no further apart become one; default: only those of different pieces, if they\n"
    "                           coincide\n"
    "      --cell-to-point      ranges of cell arrays are those of their averages at the points\n"
    "      --strict             fails with the reader's first warning, or with what of the list is a defect\n"
    "      --no-displacement    an Exodus file's points as they are at first, not moved by its displacements\n"
    "      --subdivide N        cuts each edge of a curved cell into N; default: as its nodes lie\n"
    "      --formats            lists the formats that can be read\n"
    "  -h, --help               this text\n"
    "\n"
    "Ghosts are cells that another piece has as well, or blanked ones: they are left out. Values of cell arrays\n"
    "are counted per tetrahedron. In the list of health only the number of components and of boundary faces are\n"
    "properties of every mesh; anything else is worth a look, but none keeps it from being rendered.\n"
    "\n"
    "Example:\n"
    "  tetcast info flow.vtu\n";

const double info_shares[INFO_QUANTILES] = {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};

static TetcastStatus get_range(const Info *info, const char *selector, InfoRange *range) {
  TetcastField *field = NULL;
  TetcastStatus status = info->vtk->dataset_field(info->dataset, selector, &field, NULL);
  if (status == TETCAST_OK) {
    double bounds[2];
    tetcast_field_range(field, bounds, &range->nonfinite);
    range->low = bounds[0];
    range->high = bounds[1];
    if (info->statistics)
      status =
          tetcast_statistics_quantiles(info->context, info->mesh, field, info_shares, INFO_QUANTILES, range->quantiles);
  }
  tetcast_field_destroy(&field);
  return status;
}

static TetcastStatus get_ranges(const Info *info, InfoArray *array) {
  const char *name = array->about.selector;
  if (array->about.components == 1) {
    array->components = 1;
    return get_range(info, name, &array->component[0]);
  }
  array->components = array->about.components <= INFO_COMPONENTS ? array->about.components : 0;
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; i <= array->components && status == TETCAST_OK; i++) {
    const bool last = i == array->components;
    char *selector = last ? cli_print("%s:mag", name) : cli_print("%s:%d", name, i);
    status = get_range(info, selector, last ? &array->magnitude : &array->component[i]);
    free(selector);
  }
  return status;
}

static TetcastStatus get_arrays(Info *info) {
  TetcastDatasetArray about;
  while (info->vtk->dataset_array(info->dataset, info->array_count, &about))
    info->array_count++;
  info->arrays = cli_allocate(sizeof *info->arrays * (size_t)info->array_count);
  memset(info->arrays, 0, sizeof *info->arrays * (size_t)info->array_count);
  for (int i = 0; i < info->array_count; i++) {
    InfoArray *array = &info->arrays[i];
    info->vtk->dataset_array(info->dataset, i, &array->about);
    const TetcastStatus status = get_ranges(info, array);
    if (status != TETCAST_OK)
      return status;
  }
  return TETCAST_OK;
}

static TetcastStatus get_info(Info *info) {
  TetcastStatus status = info->vtk->dataset_read(info->context, info->path, &info->desc, &info->dataset);
  if (status == TETCAST_OK)
    status = info->vtk->dataset_mesh(info->dataset, &info->mesh);
  if (status == TETCAST_OK)
    status = get_arrays(info);
  if (status == TETCAST_OK) {
    info->tetrahedra = tetcast_mesh_tetrahedron_count(info->mesh);
    info->vertices = tetcast_mesh_vertex_count(info->mesh);
    tetcast_mesh_bounds(info->mesh, info->bounds);
    status = tetcast_mesh_health(info->context, info->mesh, &info->health);
  }
  tetcast_mesh_destroy(&info->mesh);
  return status;
}

/* The values below which shares of the volume lie, in a line of their own. */
static void print_quantiles(const InfoRange *range, int indent) {
  printf("%*sof the volume", indent + 4, "");
  for (int i = 0; i < INFO_QUANTILES; i++)
    printf("  %g %%: %.4g", 100 * info_shares[i], range->quantiles[i]);
  putchar('\n');
}

static void print_range(const InfoRange *range, const char *label) {
  printf("%-3s [%.9g, %.9g]", label, range->low, range->high);
  if (range->nonfinite > 0)
    printf("  %" PRId64 " NaN or infinite", range->nonfinite);
  putchar('\n');
}

static void print_arrays(const Info *info) {
  int width = 4;
  for (int i = 0; i < info->array_count; i++) {
    const int length = (int)strlen(info->arrays[i].about.selector);
    width = length > width && length <= 40 ? length : width;
  }
  puts(info->array_count ? "arrays" : "arrays        none: drawn as uniform matter");
  for (int i = 0; i < info->array_count; i++) {
    const InfoArray *array = &info->arrays[i];
    const int indent = printf("  %-5s  %-*s  %-7s  ", array->about.association == TETCAST_CELL ? "cell" : "point",
                              width, array->about.selector, array->about.type);
    const InfoRange *last = array->about.components == 1 ? &array->component[0] : &array->magnitude;
    for (int c = 0; array->about.components > 1 && c < array->components; c++) {
      char label[16];
      snprintf(label, sizeof label, ":%d", c);
      print_range(&array->component[c], label);
      if (info->statistics)
        print_quantiles(&array->component[c], indent);
      printf("%*s", indent, "");
    }
    print_range(last, array->about.components == 1 ? "" : "mag");
    if (info->statistics)
      print_quantiles(last, indent);
  }
}

static void print_health(const TetcastMeshHealth *health) {
  const struct {
    const char *name;
    int64_t count;
  } rows[] = {{"components", health->components},
              {"boundary faces", health->boundary_faces},
              {"non-manifold faces", health->nonmanifold_faces},
              {"degenerate cells", health->degenerate_cells},
              {"inverted cells", health->inverted_cells},
              {"duplicate cells", health->duplicate_cells},
              {"unused vertices", health->unused_vertices},
              {"coincident vertices", health->coincident_vertices}};
  puts("health");
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    printf("  %-20s %" PRId64 "\n", rows[i].name, rows[i].count);
  printf("  %-20s %.9g\n", "volume", health->volume);
  printf("  %-20s %.9g\n", "boundary area", health->boundary_area);
}

static void print_steps(const Info *info) {
  double time, last = 0;
  int64_t steps = 0;
  while (info->vtk->dataset_time(info->dataset, steps, &time)) {
    last = time;
    steps++;
  }
  if (steps == 0)
    return;
  const int64_t step = info->vtk->dataset_step(info->dataset);
  double first = 0;
  info->vtk->dataset_time(info->dataset, 0, &first);
  info->vtk->dataset_time(info->dataset, step, &time);
  printf("time steps    %" PRId64 ", from t=%.9g to t=%.9g; this is step %" PRId64 ", t=%.9g\n", steps, first, last,
         step, time);
}

static void print_blocks(const Info *info) {
  for (int i = 0; info->vtk->dataset_block(info->dataset, i); i++)
    printf("%-13s %s\n", i ? "" : "blocks", info->vtk->dataset_block(info->dataset, i));
}

/* Tells the faults of a mesh and of its values in one line. */
static void report_defects(const Info *info) {
  const TetcastMeshHealth *health = &info->health;
  const bool mixed = health->inverted_cells > 0 && health->inverted_cells < info->tetrahedra - health->degenerate_cells;
  int64_t nonfinite = 0;
  for (int i = 0; i < info->array_count; i++) {
    const InfoArray *array = &info->arrays[i];
    nonfinite += array->about.components == 1 ? array->component[0].nonfinite : array->magnitude.nonfinite;
  }
  const struct {
    const char *name;
    int64_t count;
  } rows[] = {{"tetrahedra without volume", health->degenerate_cells},
              {"tetrahedra inverted and others not", mixed ? health->inverted_cells : 0},
              {"tetrahedra that another one equals", health->duplicate_cells},
              {"faces of three tetrahedra or more", health->nonmanifold_faces},
              {"values that are NaN or infinite", nonfinite}};
  char *list = cli_duplicate("");
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (rows[i].count == 0)
      continue;
    char *longer = cli_print("%s%s%" PRId64 " %s", list, *list ? ", " : "", rows[i].count, rows[i].name);
    free(list);
    list = longer;
  }
  if (*list)
    cli_warning("%s: %s", info->path, list);
  free(list);
}

/* Counts of rare things are shown only if they are not 0. */
static void print_some(const char *name, int64_t count, const char *unit) {
  if (count > 0)
    printf("  %-20s %" PRId64 "%s\n", name, count, unit);
}

/* Tells how the cells became tetrahedra. */
static void print_cut(const TetcastCutInfo *cut) {
  const struct {
    const char *name;
    int64_t count;
  } rows[] = {{"curved cells", cut->curved},        {"added vertices", cut->added_vertices},
              {"collapsed cells", cut->collapsed},  {"inverted cells", cut->inverted},
              {"overlapping cells", cut->folded},   {"open polyhedra", cut->open},
              {"cells without inside", cut->empty}, {"oversized cells", cut->oversized}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (rows[i].count == 0)
      continue;
    printf("  %-20s %" PRId64, rows[i].name, rows[i].count);
    if (i == 0 && cut->segments[0] < cut->segments[1])
      printf(", edges in %d to %d", cut->segments[0], cut->segments[1]);
    else if (i == 0)
      printf(", edges in %d", cut->segments[0]);
    putchar('\n');
  }
}

static void print_text(const Info *info) {
  printf("file          %s\n", info->path);
  print_steps(info);
  print_blocks(info);
  const TetcastDatasetPieces pieces = info->vtk->dataset_pieces(info->dataset);
  if (pieces.pieces > 1 || pieces.surfaces > 0)
    printf("pieces        %" PRId64 "\n", pieces.pieces);
  print_some("without volume", pieces.surfaces, ", left out");
  printf("points        %" PRId64 "\n", info->vtk->dataset_point_count(info->dataset));
  print_some("merged", pieces.merged_points, "");
  print_some("of differing values", pieces.differing_points, "");
  print_some("of ghosts alone", pieces.ghost_points, "");
  print_some("NaN or infinite", pieces.nonfinite_points, ", left out");
  printf("cells         %" PRId64 "\n", info->vtk->dataset_cell_count(info->dataset));
  const char *name;
  int64_t count;
  for (int i = 0; info->vtk->dataset_cell_type(info->dataset, i, &name, &count); i++)
    printf("  %-20s %" PRId64 "\n", name, count);
  print_some("ghost", pieces.ghost_cells, "");
  print_some("NaN or infinite", pieces.nonfinite_cells, ", left out");
  printf("tetrahedra    %" PRId64 "\n", info->tetrahedra);
  const TetcastCutInfo cut = info->vtk->dataset_cut(info->dataset);
  print_cut(&cut);
  for (int i = 0; i < 3; i++)
    printf("%-13s %c [%.9g, %.9g]\n", i ? "" : "bounds", "xyz"[i], info -> bounds[2 * i], info -> bounds[2 * i + 1]);
  print_arrays(info);
  print_health(&info->health);
}

static int print_formats(void) {
  const CliVtk *vtk = cli_vtk();
  if (!vtk)
    return CLI_FAILED;
  const char *name, *extensions;
  for (int i = 0; vtk->dataset_format(i, &name, &extensions); i++)
    printf("%-28s %s\n", name, extensions);
  return cli_finish_output();
}

/* The options of the command line. */
typedef struct Request {
  const char *path, *block, *time;
  double merge_tolerance;
  bool json, formats, strict, cell_to_point, no_displacement, statistics;
  int subdivide;
} Request;

static const struct option words[] = {{"json", no_argument, NULL, 'j'},
                                      {"formats", no_argument, NULL, 'f'},
                                      {"statistics", no_argument, NULL, 'q'},
                                      {"block", required_argument, NULL, 'b'},
                                      {"time", required_argument, NULL, 't'},
                                      {"merge-tolerance", required_argument, NULL, 'm'},
                                      {"strict", no_argument, NULL, 'S'},
                                      {"cell-to-point", no_argument, NULL, 'c'},
                                      {"no-displacement", no_argument, NULL, 'd'},
                                      {"subdivide", required_argument, NULL, 's'},
                                      {"help", no_argument, NULL, 'h'},
                                      {NULL, 0, NULL, 0}};

int completion_of_info(CompletionOption list[COMPLETION_OPTIONS]) {
  return completion_of_words(words, list);
}

static int parse(int argc, char **argv, Request *request) {
  *request = (Request){.merge_tolerance = -1};
  TetcastDatasetDesc desc;
  optind = 0;
  double number;
  int code;
  while ((code = getopt_long(argc, argv, ":h", words, NULL)) != -1) {
    switch (code) {
    case 'h':
      fputs(help_text, stdout);
      return cli_finish_output();
    case 's':
      if (!cli_parse_number(optarg, &number) || !(number >= 0 && number <= TETCAST_MAX_SUBDIVISION) ||
          number != (int)number)
        return cli_usage_error("info", "--subdivide %s: expected a whole number from 1 to %d, or 0: as the nodes lie",
                               optarg, TETCAST_MAX_SUBDIVISION);
      request->subdivide = (int)number;
      break;
    case 'j':
      request->json = true;
      break;
    case 'f':
      request->formats = true;
      break;
    case 'q':
      request->statistics = true;
      break;
    case 'S':
      request->strict = true;
      break;
    case 'c':
      request->cell_to_point = true;
      break;
    case 'd':
      request->no_displacement = true;
      break;
    case 'b':
      if (!*optarg)
        return cli_usage_error("info", "--block: expected the name of a block");
      request->block = optarg;
      break;
    case 't':
      if (!strcmp(optarg, "all") || !render_option_dataset(NULL, optarg, -1, &desc))
        return cli_usage_error("info", "--time %s: expected a step, from 0 (or -1, the last, and back), or t=TIME",
                               optarg);
      request->time = optarg;
      break;
    case 'm':
      if (!cli_parse_number(optarg, &request->merge_tolerance) || request->merge_tolerance < 0)
        return cli_usage_error("info", "--merge-tolerance %s: expected a distance, 0 or above", optarg);
      break;
    default:
      return cli_bad_option("info", code, argc, argv, words);
    }
  }
  if (request->formats)
    return optind < argc ? cli_usage_error("info", "--formats takes no input") : -1;
  if (optind == argc)
    return cli_usage_error("info", "no input given");
  if (optind + 1 < argc)
    return cli_usage_error("info", "more than one input: '%s' and '%s'", argv[optind], argv[optind + 1]);
  request->path = argv[optind];
  char *mistaken = scene_file_mistaken(request->path);
  const int result = mistaken ? cli_usage_error("info", "%s", mistaken) : -1;
  free(mistaken);
  return result;
}

int tetcast_cli_info(int argc, char **argv) {
  Request request;
  int code = parse(argc, argv, &request);
  if (code >= 0)
    return code;
  if (request.formats)
    return print_formats();
  Info info = {.path = request.path};
  info.context = cli_context_create(0);
  info.statistics = request.statistics;
  info.vtk = info.context ? cli_vtk() : NULL;
  code = CLI_FAILED;
  cli_set_strict(request.strict);
  if (info.vtk) {
    info.desc = info.vtk->dataset_desc_default();
    render_option_dataset(request.block, request.time, request.merge_tolerance, &info.desc);
    info.desc.cell_to_point = request.cell_to_point;
    info.desc.no_displacement = request.no_displacement;
    info.desc.subdivision = request.subdivide;
    const TetcastStatus status = get_info(&info);
    if (status == TETCAST_OK && request.strict)
      report_defects(&info);
    if (cli_verdict(CLI_DONE) != CLI_DONE) {
      code = CLI_FAILED;
    } else if (status == TETCAST_OK) {
      (request.json ? info_print_json : print_text)(&info);
      code = cli_finish_output();
    } else {
      code = cli_failed(status);
    }
    info.vtk->dataset_destroy(&info.dataset);
  }
  free(info.arrays);
  tetcast_context_destroy(&info.context);
  return code;
}
