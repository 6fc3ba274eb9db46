/* SPDX-License-Identifier: Apache-2.0 */
/* Measures tetcast beside VTK's unstructured ray caster; see README.md. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "jobs.h"
#include "machine.h"
#include "program.h"

static const char help[] =
    "usage: tetcast_bench [OPTION]…\n"
    "Writes results.csv. run.sh calls it and makes tables and plots.\n"
    "  --small          tiny meshes and pictures, one round: does it still work?\n"
    "  --large          also the mesh of 12 million tetrahedra\n"
    "  --scene NAME     only this mesh\n"
    "  --rounds N       every renderer is measured N times instead of 1 to 5\n"
    "  --pictures       also write the pictures, as .ppm\n"
    "  -o DIR           where to write [.]\n"
    "  --bin DIR        where tetcast, tetcast_bench_body and tetcast_bench_plain are [beside this program]\n";

static void usage(const char *what) {
  fprintf(stderr, "tetcast_bench: %s\n%s", what, help);
  exit(2);
}

static void path_of(char *path, size_t size, const Options *options, const char *name, const char *extension) {
  must((size_t)snprintf(path, size, "%s/%s%s", options->scratch, name, extension) < size, "a path is too long");
}

/* Does one job in a process of its own. */
static bool run_job(const Options *options, const SceneDesc *scene, void (*work)(const Job *)) {
  pid_t child = fork();
  if (child != 0) {
    return program_wait(child);
  }
  BenchMesh mesh;
  char path[4096];
  path_of(path, sizeof path, options, scene->name, ".mesh");
  must(scene_load(&mesh, scene, path), "a mesh can't be read, or there is no memory for it");
  snprintf(path, sizeof path, "%s/results.csv", options->folder);
  FILE *file = fopen(path, "a");
  must(file != NULL, "results.csv can't be written");
  const Job job = {.options = options,
                   .scene = scene,
                   .mesh = &mesh,
                   .row = row_empty(file, scene->name, mesh.cell_count, mesh.vertex_count)};
  work(&job);
  bench_mesh_release(&mesh);
  must(fclose(file) == 0, "results.csv can't be written");
  free((char *)options->tetcast); /* the parent's; so that a leak that is found is one */
  free((char *)options->plain);
  free((char *)options->body);
  exit(0);
}

static bool run_scene(const Options *options, const SceneDesc *scene) {
  static const struct {
    void (*work)(const Job *);
    unsigned needs;
    const char *name;
  } jobs[] = {{job_memory, 0, "memory"},
              {job_memory_vtk, 0, "VTK's memory"},
              {job_frames, 0, "frames"},
              {job_visible, SCENE_VISIBLE, "transfer functions"},
              {job_features, SCENE_FEATURES, "features"},
              {job_numbers, SCENE_FEATURES, "statistics"},
              {job_rays, SCENE_FEATURES, "rays"},
              {job_parts, SCENE_FEATURES, "parts"},
              {job_file, SCENE_FILE, "files"},
              {job_cells, SCENE_CELLS, "cutting cells"}};
  if (scene->n == 0 && !options->body) {
    fprintf(stderr, "%s: skipped, needs TetGen\n", scene->name);
    return true;
  }
  char path[4096];
  path_of(path, sizeof path, options, scene->name, ".mesh");
  bool ok = scene->n > 0 || scene_make_body(scene, options->body, path);
  for (size_t i = 0; i < sizeof jobs / sizeof *jobs && ok; i++) {
    if ((scene->work & jobs[i].needs) == jobs[i].needs) {
      fprintf(stderr, "%s: %s\n", scene->name, jobs[i].name);
      ok = run_job(options, scene, jobs[i].work);
    }
  }
  if (!ok) {
    fprintf(stderr, "tetcast_bench: %s failed\n", scene->name);
  }
  remove(path);
  return ok;
}

static void write_head(const Options *options, bool end) {
  char path[4096];
  snprintf(path, sizeof path, "%s/results.csv", options->folder);
  FILE *file = fopen(path, end ? "a" : "w");
  must(file != NULL, "results.csv can't be written");
  if (!end) {
    machine_describe(file);
    fprintf(file, "# tetcast %s, Embree %s, VTK %s\n", tetcast_version_string(), tetcast_embree_version_string(),
            caster_vtk_version());
  }
  machine_load(file, end ? "at the end" : "at the beginning");
  if (!end) {
    row_write_names(file);
  }
  must(fclose(file) == 0, "results.csv can't be written");
}

int main(int argc, char **argv) {
  Options options = {.run = RUN_NORMAL, .pixels = 512, .least = 0.3, .folder = "."};
  const char *only = NULL, *bin = NULL;
  for (int i = 1; i < argc; i++) {
    const bool more = i + 1 < argc;
    if (strcmp(argv[i], "--small") == 0) {
      options.run = RUN_SMALL;
      options.pixels = 64;
      options.least = 0;
    } else if (strcmp(argv[i], "--large") == 0) {
      options.run = RUN_LARGE;
    } else if (strcmp(argv[i], "--pictures") == 0) {
      options.pictures = true;
    } else if (strcmp(argv[i], "--scene") == 0 && more) {
      only = argv[++i];
    } else if (strcmp(argv[i], "--rounds") == 0 && more && atoi(argv[i + 1]) >= 1) {
      options.rounds = atoi(argv[++i]);
    } else if (strcmp(argv[i], "-o") == 0 && more) {
      options.folder = argv[++i];
    } else if (strcmp(argv[i], "--bin") == 0 && more) {
      bin = argv[++i];
    } else if (strcmp(argv[i], "--help") == 0) {
      fputs(help, stdout);
      return 0;
    } else {
      usage(argv[i]);
    }
  }
  char *beside = program_folder(argv[0]);
  bin = bin ? bin : beside;
  options.scratch = options.folder;
  options.tetcast = program_find(bin, "tetcast");
  options.plain = program_find(bin, "tetcast_bench_plain");
  options.body = program_find(bin, "tetcast_bench_body");
  write_head(&options, false);
  bool ok = true, any = false;
  for (int i = 0; scene_get(i); i++) {
    SceneDesc scene = *scene_get(i);
    if (only ? strcmp(scene.name, only) == 0 : (scene.runs & options.run) != 0) {
      any = true;
      scene.rounds = options.rounds > 0 ? options.rounds : scene.rounds;
      ok = run_scene(&options, &scene) && ok;
    }
  }
  write_head(&options, true);
  free((char *)options.tetcast);
  free((char *)options.plain);
  free((char *)options.body);
  free(beside);
  if (!any) {
    usage("there is no such scene");
  }
  return ok ? 0 : 1;
}
