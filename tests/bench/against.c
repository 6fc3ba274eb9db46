/* SPDX-License-Identifier: Apache-2.0 */
/* tetcast_bench_against [OPTION]… THIS OTHER: measures two builds of libtetcast in turn, frame by frame; see README.md.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "library.h"
#include "machine.h"
#include "program.h"

enum { MESHES = 4, MOST_RESULTS = 128, GROUPS = 8 };

/* Names of scenes, see scenes.c. */
static const char *const meshes[MESHES] = {"cube-200k", "cube-1.6m", "cube-5m", "shell-650k"};
static const char *const small_meshes[] = {"cube-1k", "cube-1k-double", "shell-3k"};

/* Pictures through a transfer function. */
static const struct Case {
  const char *name;
  const Transfer *transfer;
  TetcastProjection projection;
  const char *isa; /* as stats name it */
  double tolerance;
  double reach[MESHES]; /* how many times as fast as the former version, d0add48, it is to be; 0: not laid down */
} cases[] = {
    {"soft", &transfer_soft, TETCAST_ORTHOGRAPHIC, "avx512", 0, {1.5, 1.4, 1.3, 1.5}},
    {"soft, perspective", &transfer_soft, TETCAST_PERSPECTIVE, "avx512", 0, {1.5, 1.4, 1.3, 1.5}},
    {"soft", &transfer_soft, TETCAST_ORTHOGRAPHIC, "avx2", 0, {1.45, 1.35, 1.3, 1.45}},
    {"sharp", &transfer_sharp, TETCAST_ORTHOGRAPHIC, "avx512", 0, {1.3, 1.3, 1.2, 1.4}},
    {"soft, tolerance 1e-3", &transfer_soft, TETCAST_ORTHOGRAPHIC, "avx512", 1e-3, {1.4, 1.35, 1.25, 1.8}},
    {"soft", &transfer_soft, TETCAST_ORTHOGRAPHIC, "scalar", 0, {1.1, 1.1, 1.1, 1.1}},
    {"depth alone", &transfer_linear, TETCAST_ORTHOGRAPHIC, "avx512", 0, {0}},
};
enum { CASES = sizeof cases / sizeof *cases };

typedef struct Options {
  bool small;
  int rounds;   /* 0: as many as `least` takes */
  double least; /* seconds that a row is measured for */
  int pixels;   /* width and height */
  const char *only, *folder, *this_name, *other_name;
  double text[2]; /* bytes of code and constants, of THIS and of OTHER; 0: unknown */
} Options;

/* A line of the tables: one ratio. */
typedef struct Result {
  const char *mesh, *what, *isa[2], *unit; /* isa: of what is compared, and of what it is compared with */
  int64_t cells;
  double amount[2];        /* of each, in the unit */
  double ratio, low, high; /* median and quartiles over the rounds */
  double reach;            /* 0: none */
  bool at_least;           /* whether more is better */
  double difference; /* of the pictures, at most; NaN: one has a number where the other has none; < 0: none compared */
  int rounds;
} Result;

typedef struct Report {
  const Options *options;
  FILE *csv;
  Result results[MOST_RESULTS];
  int count;
} Report;

/* ── the report ── */

static bool reached(const Result *r) {
  return r->at_least ? r->ratio >= r->reach : r->ratio <= r->reach;
}

static void report_head(Report *report) {
  const Options *options = report->options;
  machine_describe(report->csv);
  machine_load(report->csv, "at the beginning");
  fprintf(report->csv, "# this build: %s\n# the other build: %s\n", options->this_name, options->other_name);
  fprintf(report->csv, "mesh,tetrahedra,what,isa,isa_other,unit,amount,amount_other,ratio,ratio_q1,ratio_q3,reach,"
                       "difference,rounds\n");
}

static void report_add(Report *report, const Result *r) {
  must(report->count < MOST_RESULTS, "too many rows");
  report->results[report->count++] = *r;
  fprintf(report->csv, "%s,%lld,\"%s\",%s,%s,%s,%.5g,%.5g,%.4f,%.4f,%.4f,", r->mesh, (long long)r->cells, r->what,
          r->isa[0], r->isa[1], r->unit, r->amount[0], r->amount[1], r->ratio, r->low, r->high);
  if (r->reach > 0) {
    fprintf(report->csv, "%g", r->reach);
  }
  if (r->difference < 0) { /* NaN is written */
    fprintf(report->csv, ",,%d\n", r->rounds);
  } else {
    fprintf(report->csv, ",%.3g,%d\n", r->difference, r->rounds);
  }
  fflush(report->csv);
  fprintf(stderr, "%s%s%s%s%s: %.4g, against %.4g %s: %.3f [%.3f, %.3f]", r->mesh, r->mesh[0] ? ", " : "", r->what,
          r->isa[0][0] ? ", " : "", r->isa[0], r->amount[0], r->amount[1], r->unit, r->ratio, r->low, r->high);
  if (r->difference >= 0) {
    fprintf(stderr, ", pictures differ by %.1e", r->difference);
  }
  fputc('\n', stderr);
}

/* The lines that describe the machine, "# NAME: VALUE", as a list. */
static void put_machine(FILE *from, FILE *to) {
  char line[1024];
  rewind(from);
  while (fgets(line, sizeof line, from)) {
    if (line[0] == '#') {
      fprintf(to, "* %s", line + 2);
    }
  }
}

static void put_row(FILE *file, const Result *r) {
  const bool bold = r->reach > 0 && !reached(r);
  fprintf(file, "| %s | %s | %s", r->mesh, r->what, r->isa[0]);
  if (strcmp(r->isa[0], r->isa[1]) != 0) {
    fprintf(file, " / %s", r->isa[1]);
  }
  fprintf(file, " | %.4g | %.4g %s | %s%.2f%s", r->amount[0], r->amount[1], r->unit, bold ? "**" : "", r->ratio,
          bold ? "**" : "");
  if (r->rounds > 0) {
    fprintf(file, " | %.2f – %.2f", r->low, r->high);
  } else {
    fprintf(file, " |");
  }
  if (r->reach > 0) {
    fprintf(file, " | %s %g", r->at_least ? "≥" : "≤", r->reach);
  } else {
    fprintf(file, " |");
  }
  if (r->difference < 0) {
    fprintf(file, " |");
  } else {
    fprintf(file, r->difference == 0 ? " | 0" : " | %.0e", r->difference);
  }
  if (r->rounds > 0) {
    fprintf(file, " | %d |\n", r->rounds);
  } else {
    fprintf(file, " | |\n");
  }
}

static void report_tables(const Report *report) {
  static const char *const titles[2] = {"This build against the other: how many times as fast",
                                        "One thing against another: how many times as much"};
  char path[4096];
  snprintf(path, sizeof path, "%s/against.md", report->options->folder);
  FILE *file = fopen(path, "w");
  must(file != NULL, "against.md can't be written");
  fprintf(file, "# Against another build\n\n");
  machine_load(report->csv, "at the end");
  put_machine(report->csv, file);
  fprintf(
      file,
      "\nOne thread, %d² pixels, orthographic where not in perspective, exact where no tolerance is named. All of a "
      "row are drawn in one process, in turn, frame by frame, and timed in seconds of CPU; a time is the median. A "
      "ratio is taken in each round; here are the median and the quartiles, bold where what is to be reached isn't. "
      "Where two kernels are named, the first made what stands under \"is\".\n",
      report->options->pixels);
  for (int table = 0; table < 2; table++) {
    fprintf(file,
            "\n## %s\n\n| mesh | what | kernel | is | against | ratio | quartiles | to reach | pictures differ by | "
            "rounds |\n"
            "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
            titles[table]);
    for (int i = 0; i < report->count; i++) {
      if (report->results[i].at_least == (table == 0)) {
        put_row(file, &report->results[i]);
      }
    }
  }
  must(fclose(file) == 0, "against.md can't be written");
}

/* ── measuring ── */

/* A picture by both builds, this one first. */
typedef struct Pair {
  Picture by[2];
  double difference; /* of the pictures, at most, in any round */
} Pair;

/* Draws pairs in turn, forwards and backwards, so that whatever else the machine does meets all of them alike, and
 * compares the pictures of each after each round. */
static void measure(const Options *options, Pair *pairs, int count, const TetcastCamera *camera) {
  enum { FEWEST = 5 };
  double spent = 0;
  for (int i = 0; i < 2 * count; i++) {
    picture_draw(&pairs[i / 2].by[i % 2], camera); /* the first frame makes what later ones use again */
  }
  const int least = options->rounds > 0 ? options->rounds : FEWEST;
  for (int round = 0; round < SAMPLES && (round < least || (options->rounds == 0 && spent < options->least)); round++) {
    for (int i = 0; i < 2 * count; i++) {
      const int at = round % 2 == 0 ? i : 2 * count - 1 - i;
      Picture *picture = &pairs[at / 2].by[at % 2];
      const double cpu = picture_draw(picture, camera);
      sample_add(&picture->cpu, cpu);
      spent += cpu;
    }
    for (int i = 0; i < count; i++) {
      const double difference = picture_difference(&pairs[i].by[0], &pairs[i].by[1]);
      pairs[i].difference = difference <= pairs[i].difference ? pairs[i].difference : difference; /* a NaN is kept */
    }
  }
}

static void set_ratios(Result *result, const Sample *ratios) {
  result->ratio = sample_median(ratios);
  result->low = sample_quantile(ratios, 0.25);
  result->high = sample_quantile(ratios, 0.75);
  result->rounds = ratios->count;
}

/* What two pictures took for each cell that a ray crosses. */
static Result result_of(const Picture *first, const Picture *second, const char *mesh, const char *what) {
  return (Result){.mesh = mesh,
                  .cells = first->stage->mesh->cell_count,
                  .what = what,
                  .unit = "ns a cell",
                  .isa = {first->stats.isa, second->stats.isa},
                  .amount = {picture_per_segment(first), picture_per_segment(second)},
                  .difference = -1};
}

static void report_pair(Report *report, const Pair *pair, const char *mesh, const char *what, double reach) {
  const Picture *first = &pair->by[0], *second = &pair->by[1];
  Result result = result_of(first, second, mesh, what);
  result.at_least = true;
  result.reach = reach;
  result.difference = pair->difference;
  Sample ratios = {0};
  for (int i = 0; i < first->cpu.count; i++) {
    sample_add(&ratios, second->cpu.values[i] / first->cpu.values[i]);
  }
  set_ratios(&result, &ratios);
  report_add(report, &result);
}

/* Both builds' stages, and what rows are made of. */
typedef struct Arena {
  Report *report;
  const char *mesh; /* its name */
  int place;        /* among those with goals; -1: none of them */
  Stage stages[2];
} Arena;

static double reach_of(const Arena *arena, double reach) {
  return arena->place >= 0 ? reach : 0;
}

static void close_pairs(Pair *pairs, int count) {
  for (int i = 0; i < 2 * count; i++) {
    picture_close(&pairs[i / 2].by[i % 2]);
  }
}

static void run_case(Arena *arena, const struct Case *c) {
  const Options *options = arena->report->options;
  Pair pair = {0};
  bool usable = true;
  for (int i = 0; i < 2; i++) {
    picture_open_transfer(&pair.by[i], &arena->stages[i], c->transfer, options->pixels);
    pair.by[i].desc.tolerance = c->tolerance;
    usable = picture_use(&pair.by[i], c->isa) && usable;
  }
  if (usable) {
    const TetcastCamera camera = scene_camera(c->projection);
    measure(options, &pair, 1, &camera);
    report_pair(arena->report, &pair, arena->mesh, c->name,
                reach_of(arena, c->reach[arena->place < 0 ? 0 : arena->place]));
  } else {
    fprintf(stderr, "%s, %s, %s: left out, not both builds have it on this processor\n", arena->mesh, c->name, c->isa);
  }
  close_pairs(&pair, 1);
}

/* Coefficients of one and of GROUPS groups, beside a transfer function of one piece; each by the fastest kernels that
 * there are for it. */
static void run_groups(Arena *arena) {
  enum { TRANSFER, ONE, ALL, PAIRS };
  static const char *const names[PAIRS] = {"one piece, two colours", "coefficients, 1 group", "coefficients, 8 groups"};
  const Options *options = arena->report->options;
  Pair pairs[PAIRS] = {0};
  for (int i = 0; i < 2; i++) {
    picture_open_transfer(&pairs[TRANSFER].by[i], &arena->stages[i], &transfer_blend, options->pixels);
    picture_open_groups(&pairs[ONE].by[i], &arena->stages[i], 1, options->pixels);
    picture_open_groups(&pairs[ALL].by[i], &arena->stages[i], GROUPS, options->pixels);
  }
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  measure(options, pairs, PAIRS, &camera);
  for (int i = 0; i < PAIRS; i++) {
    report_pair(arena->report, &pairs[i], arena->mesh, names[i], 0);
  }
  const Picture *transfer = &pairs[TRANSFER].by[0], *one = &pairs[ONE].by[0], *all = &pairs[ALL].by[0];
  Result group = result_of(one, transfer, arena->mesh, "1 group, against one piece with two colours");
  Result further = result_of(all, one, arena->mesh, "each further group, against the first");
  Sample ratios[2] = {0};
  for (int i = 0; i < one->cpu.count; i++) {
    const double first = one->cpu.values[i] / (double)one->stats.segments;
    sample_add(&ratios[0], first * (double)transfer->stats.segments / transfer->cpu.values[i]);
    sample_add(&ratios[1], (all->cpu.values[i] / (double)all->stats.segments - first) / (GROUPS - 1) / first);
  }
  further.amount[0] = (further.amount[0] - further.amount[1]) / (GROUPS - 1);
  group.reach = reach_of(arena, 1.2);
  further.reach = reach_of(arena, 0.25);
  set_ratios(&group, &ratios[0]);
  set_ratios(&further, &ratios[1]);
  report_add(arena->report, &group);
  report_add(arena->report, &further);
  close_pairs(pairs, PAIRS);
}

static const SceneDesc *scene_named(const char *name) {
  int i = 0;
  while (scene_get(i) && strcmp(scene_get(i)->name, name) != 0) {
    i++;
  }
  return scene_get(i);
}

static void run_mesh(Report *report, const char *name, int place, const char *body, const Library libraries[2]) {
  const SceneDesc *scene = scene_named(name);
  must(scene != NULL, "there is no such scene");
  if (scene->n == 0 && !body) {
    fprintf(stderr, "%s: left out, needs TetGen\n", name);
    return;
  }
  char path[4096];
  must((size_t)snprintf(path, sizeof path, "%s/%s.mesh", report->options->folder, name) < sizeof path,
       "a path is too long");
  BenchMesh mesh;
  must(scene->n > 0 || scene_make_body(scene, body, path), "TetGen made no mesh");
  must(scene_load(&mesh, scene, path), "a mesh can't be read, or there is no memory for it");
  remove(path);
  Arena arena = {.report = report, .mesh = name, .place = place};
  for (int i = 0; i < 2; i++) {
    stage_open(&arena.stages[i], &libraries[i], &mesh);
  }
  for (int i = 0; i < CASES; i++) {
    run_case(&arena, &cases[i]);
  }
  run_groups(&arena);
  for (int i = 0; i < 2; i++) {
    stage_close(&arena.stages[i]);
  }
  bench_mesh_release(&mesh);
}

static void report_text(Report *report) {
  const double *text = report->options->text;
  if (!(text[0] > 0 && text[1] > 0)) {
    fprintf(stderr, "the size of the code: left out, it isn't known\n");
    return;
  }
  const double ratio = text[0] / text[1];
  const Result result = {.mesh = "",
                         .what = "libtetcast's code and constants, against the other build's",
                         .isa = {"", ""},
                         .unit = "KiB",
                         .amount = {text[0] / 1024, text[1] / 1024},
                         .ratio = ratio,
                         .low = ratio,
                         .high = ratio,
                         .reach = report->options->small ? 0 : 1.3,
                         .difference = -1};
  report_add(report, &result);
}

/* Pictures that one of the builds has no number in, and, of one and the same build, those that differ at all. */
static bool all_is_well(const Report *report, const Library libraries[2]) {
  const bool same = libraries[0].handle == libraries[1].handle;
  bool well = report->count > 0;
  for (int i = 0; i < report->count; i++) {
    const Result *r = &report->results[i];
    if (isnan(r->difference) || (same && r->difference > 0)) {
      fprintf(stderr, "tetcast_bench: %s, %s, %s: the pictures differ by %g\n", r->mesh, r->what, r->isa[0],
              r->difference);
      well = false;
    }
  }
  return well;
}

/* ── the command line ── */

static void usage(const char *what) {
  fprintf(stderr,
          "tetcast_bench_against: %s\n"
          "usage: tetcast_bench_against [OPTION]… THIS OTHER\n"
          "Draws the same pictures with two libraries, libtetcast.so of two builds, and writes against.csv and "
          "against.md.\n"
          "  --small             tiny meshes and pictures: does it still work?\n"
          "  --scene NAME        only this mesh\n"
          "  --rounds N          every picture is drawn N times [for 8 seconds, 5 to 64 times]\n"
          "  --text BYTES BYTES  how large the two libraries' code is\n"
          "  --names THIS OTHER  what the results call them\n"
          "  -o DIR              where to write [.]\n",
          what);
  exit(2);
}

/* The arguments of option i, as many as it takes. */
static char **values_of(int argc, char **argv, int *i, int count) {
  if (argc - 1 - *i < count) {
    usage("an option's value is missing");
  }
  char **values = argv + *i + 1;
  *i += count;
  return values;
}

static void parse(int argc, char **argv, Options *options, const char *paths[2]) {
  int count = 0;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--small") == 0) {
      options->small = true;
      options->rounds = 2;
      options->pixels = 64;
    } else if (strcmp(argv[i], "--scene") == 0) {
      options->only = *values_of(argc, argv, &i, 1);
    } else if (strcmp(argv[i], "--rounds") == 0) {
      options->rounds = atoi(*values_of(argc, argv, &i, 1));
    } else if (strcmp(argv[i], "--text") == 0) {
      char **values = values_of(argc, argv, &i, 2);
      options->text[0] = atof(values[0]);
      options->text[1] = atof(values[1]);
    } else if (strcmp(argv[i], "--names") == 0) {
      char **values = values_of(argc, argv, &i, 2);
      options->this_name = values[0];
      options->other_name = values[1];
    } else if (strcmp(argv[i], "-o") == 0) {
      options->folder = *values_of(argc, argv, &i, 1);
    } else if (argv[i][0] == '-' || count == 2) {
      usage(argv[i]);
    } else {
      paths[count++] = argv[i];
    }
  }
  if (count != 2) {
    usage("two libraries are needed");
  }
}

int main(int argc, char **argv) {
  Options options = {.least = 8, .pixels = 512, .folder = ".", .this_name = "unnamed", .other_name = "unnamed"};
  const char *paths[2];
  parse(argc, argv, &options, paths);
  Library libraries[2];
  for (int i = 0; i < 2; i++) {
    library_open(&libraries[i], paths[i]);
  }
  char path[4096], *beside = program_folder(argv[0]), *body = program_find(beside, "tetcast_bench_body");
  snprintf(path, sizeof path, "%s/against.csv", options.folder);
  Report *report = calloc(1, sizeof *report);
  must(report != NULL, "no memory");
  report->options = &options;
  report->csv = fopen(path, "w+");
  must(report->csv != NULL, "against.csv can't be written");
  report_head(report);
  const char *const *names = options.small ? small_meshes : meshes;
  const int count = options.small ? sizeof small_meshes / sizeof *small_meshes : MESHES;
  if (options.only) {
    int place = MESHES - 1;
    while (place >= 0 && strcmp(meshes[place], options.only) != 0) {
      place--;
    }
    run_mesh(report, options.only, place, body, libraries);
  }
  for (int i = 0; i < count && !options.only; i++) {
    run_mesh(report, names[i], options.small ? -1 : i, body, libraries);
  }
  report_text(report);
  report_tables(report);
  const bool well = all_is_well(report, libraries);
  must(fclose(report->csv) == 0, "against.csv can't be written");
  free(report);
  free(beside);
  free(body);
  return well ? 0 : 1;
}
