/* SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <tetcast/tetcast.h>

#include "adapter.h"
#include "cli.h"
#include "completion.h"
#include "demo/fields.h"
#include "file.h"

static const char help_text[] = "Usage: tetcast mesh SURFACE -o OUT.vtu [options]\n"
                                "\n"
                                "Fills a closed surface with tetrahedra, using TetGen. SURFACE: .off .stl .ply .obj\n"
                                ".vtp, or TetGen's own .poly and .smesh, which can have holes; .node with .ele is a\n"
                                "mesh already and is only converted.\n"
                                "\n"
                                "  -o, --output FILE     .vtu\n"
                                "      --quality R       largest ratio of circumradius to shortest edge, above 1;\n"
                                "                        default 1.4, 0: any. Cells in sharp corners of the surface\n"
                                "                        may exceed it; with less than 1.2 it may never end\n"
                                "      --max-volume V    largest volume of a tetrahedron\n"
                                "      --field NAME[:…]  attach one of these scalars to the vertices:\n";

static const char more_help_text[] = "      --single          coordinates and scalar in single precision\n"
                                     "      --strict          a warning is an error: nothing is written\n"
                                     "      --quiet           no summary, no warnings\n"
                                     "  -h, --help            this text\n"
                                     "\n"
                                     "Example:\n"
                                     "  tetcast mesh ball.off --max-volume 2 --field hydrogen:4,2,0 -o orbital.vtu\n";

typedef struct Job {
  const char *surface, *output;
  double quality, max_volume;
  bool quality_given, with_field, single;
  FieldSpec field;
} Job;

static bool ends_with(const char *text, const char *end) {
  const size_t n = strlen(text), m = strlen(end);
  return n >= m && strcasecmp(text + n - m, end) == 0;
}

/* ── what the mesh is like ── */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Circumradius by shortest edge. From corner 0, the centre is Σ |a|² (b × c) / 2 a·(b × c) over its edges a, b, c in
 * turn. */
static double radius_edge_ratio(double x[4][3]) {
  double shortest = HUGE_VAL, longest = 0, e[3][3], normal[3], center[3] = {0, 0, 0};
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      const double length = hypot(hypot(x[i][0] - x[j][0], x[i][1] - x[j][1]), x[i][2] - x[j][2]);
      shortest = fmin(shortest, length);
      longest = fmax(longest, length);
    }
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      e[i][k] = (x[i + 1][k] - x[0][k]) / longest; /* for coordinates whose squares would overflow */
  for (int i = 0; i < 3; i++) {
    cross(e[(i + 1) % 3], e[(i + 2) % 3], normal);
    for (int k = 0; k < 3; k++)
      center[k] += dot(e[i], e[i]) * normal[k];
  }
  const double six_volumes = fabs(dot(e[2], (cross(e[0], e[1], normal), normal)));
  return sqrt(dot(center, center)) / (2 * six_volumes) * (longest / shortest);
}

static void print_summary(const Job *job, const TetcastMesh *mesh) {
  double worst = 0;
  const int64_t count = tetcast_mesh_tetrahedron_count(mesh);
  for (int64_t i = 0; i < count; i++) {
    int64_t corners[4];
    double x[4][3];
    tetcast_mesh_tetrahedron(mesh, i, corners);
    for (int j = 0; j < 4; j++)
      tetcast_mesh_vertex(mesh, corners[j], x[j]);
    const double ratio = radius_edge_ratio(x);
    worst = isnan(ratio) ? HUGE_VAL : fmax(worst, ratio);
  }
  printf("%s: %" PRId64 " vertices, %" PRId64 " tetrahedra, worst radius-edge ratio %.3g\n", job->output,
         tetcast_mesh_vertex_count(mesh), count, worst);
}

/* ── the work, in a process of its own ── */

typedef enum Phase { PHASE_READ, PHASE_MESH, PHASE_FIELD, PHASE_WRITE, PHASE_END } Phase;

/* What TetGen says when it dies on an assertion would stand beside our own message: standard error is put aside. */
static int hide_errors(FILE **aside) {
  *aside = tmpfile();
  const int saved = *aside ? fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3) : -1;
  if (saved >= 0)
    dup2(fileno(*aside), STDERR_FILENO);
  return saved;
}

static void show_errors(FILE *aside, int saved) {
  if (saved >= 0) {
    dup2(saved, STDERR_FILENO);
    close(saved);
    rewind(aside);
    for (int c; (c = getc(aside)) != EOF;)
      fputc(c, stderr);
  }
  if (aside)
    fclose(aside);
}

static TetcastStatus make_mesh(const Job *job, TetcastContext *context, const CliVtk *vtk, const CliTetgen *tetgen,
                               volatile int *phase, TetcastMesh **mesh) {
  TetcastTetgenDesc desc = tetgen->tetgen_desc_default();
  if (job->quality_given)
    desc.quality = job->quality;
  desc.max_volume = job->max_volume;
  const bool own_format = ends_with(job->surface, ".poly") || ends_with(job->surface, ".smesh") ||
                          ends_with(job->surface, ".node") || ends_with(job->surface, ".ele");
  TetcastSurface surface = {0};
  TetcastStatus status = own_format ? TETCAST_OK : vtk->surface_read(context, job->surface, &surface);
  if (status != TETCAST_OK)
    return status;
  *phase = PHASE_MESH;
  FILE *aside;
  const int saved = hide_errors(&aside);
  if (own_format) {
    status = tetgen->tetgen_mesh_file(context, job->surface, &desc, mesh);
  } else {
    cli_set_place(job->surface);
    status = tetgen->tetgen_mesh(context, &surface, &desc, mesh);
    cli_set_place(NULL);
    vtk->surface_release(&surface);
  }
  show_errors(aside, saved);
  return status;
}

/* Makes the same mesh with its coordinates in single precision. */
static TetcastStatus make_single(TetcastContext *context, TetcastMesh **mesh) {
  const int64_t count = tetcast_mesh_vertex_count(*mesh);
  float(*vertices)[3] = cli_allocate(sizeof *vertices * (size_t)count);
  for (int64_t i = 0; i < count; i++) {
    double x[3];
    tetcast_mesh_vertex(*mesh, i, x);
    for (int j = 0; j < 3; j++)
      vertices[i][j] = (float)x[j];
  }
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){.data = vertices, .type = TETCAST_TYPE_FLOAT32, .count = count};
  desc.tetrahedra = tetcast_mesh_tetrahedra(*mesh);
  desc.index_base = tetcast_mesh_index_base(*mesh);
  TetcastMesh *single = NULL;
  const TetcastStatus status = tetcast_mesh_create(context, &desc, &single);
  free(vertices);
  tetcast_mesh_destroy(mesh);
  *mesh = single;
  return status;
}

static TetcastStatus make_field(const Job *job, TetcastContext *context, const TetcastMesh *mesh,
                                TetcastField **field) {
  const int64_t count = tetcast_mesh_vertex_count(mesh);
  double *values = cli_allocate(sizeof *values * (size_t)count);
  TetcastStatus status = field_compute(context, mesh, &job->field, values);
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){.data = values, .type = TETCAST_TYPE_FLOAT64, .count = count};
  if (job->single) {
    for (int64_t i = 0; i < count; i++) { /* in place: byte 4 i lies before byte 8 i */
      const float value = (float)values[i];
      memcpy((char *)values + sizeof value * (size_t)i, &value, sizeof value);
    }
    desc.values.type = TETCAST_TYPE_FLOAT32;
  }
  if (status == TETCAST_OK)
    status = tetcast_field_create(context, &desc, field);
  free(values);
  return status;
}

static int work(const Job *job, const sigset_t *interruptions, volatile int *phase) {
  TetcastContext *context = cli_context_create(0);
  const CliTetgen *tetgen = context ? cli_tetgen() : NULL;
  const CliVtk *vtk = tetgen ? cli_vtk() : NULL;
  if (!vtk)
    return CLI_FAILED;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastStatus status = make_mesh(job, context, vtk, tetgen, phase, &mesh);
  *phase = PHASE_FIELD;
  if (status == TETCAST_OK && job->single)
    status = make_single(context, &mesh);
  if (status == TETCAST_OK && job->with_field)
    status = make_field(job, context, mesh, &field);
  if (status == TETCAST_OK && cli_verdict(CLI_DONE) == CLI_DONE) {
    *phase = PHASE_WRITE;
    sigprocmask(SIG_BLOCK, interruptions, NULL); /* as a temporary file would be left otherwise */
    const char *const names[] = {job->field.name};
    const TetcastField *const fields[] = {field};
    status = vtk->dataset_write(context, job->output, mesh, job->with_field ? 1 : 0, names, fields);
  }
  int code = status == TETCAST_OK ? cli_verdict(CLI_DONE) : cli_failed(status);
  if (code == CLI_DONE && !cli_quiet()) {
    print_summary(job, mesh);
    code = cli_finish_output();
  }
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  tetcast_context_destroy(&context);
  *phase = PHASE_END;
  return code;
}

/* ── the process that watches it ── */

/* The signals that end the command, but for those it was told to ignore. */
static void list_interruptions(sigset_t *set) {
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  sigemptyset(set);
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
    struct sigaction action;
    if (sigaction(signals[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN)
      sigaddset(set, signals[i]);
  }
}

static int interrupted(int signal_number) {
  cli_error("interrupted");
  return 128 + signal_number;
}

static int explain(const Job *job, int status, int phase, const sigset_t *interruptions) {
  if (WIFEXITED(status) && phase == PHASE_END)
    return WEXITSTATUS(status);
  if (WIFSIGNALED(status) && sigismember(interruptions, WTERMSIG(status)) == 1)
    return interrupted(WTERMSIG(status));
  if (WIFEXITED(status) && phase != PHASE_MESH) /* after a message */
    return WEXITSTATUS(status) ? WEXITSTATUS(status) : CLI_FAILED;
  const char *how = !WIFSIGNALED(status)          ? "it ended the process"
                    : WTERMSIG(status) == SIGKILL ? "killed; out of memory?"
                                                  : strsignal(WTERMSIG(status));
  if (phase == PHASE_MESH)
    cli_error("%s: TetGen gave up on it (%s); is it free of self-intersections?", job->surface, how);
  else
    cli_error("%s: %s failed (%s)", phase == PHASE_WRITE ? job->output : job->surface,
              phase == PHASE_WRITE   ? "writing"
              : phase == PHASE_FIELD ? "computing the field"
                                     : "reading",
              how);
  return CLI_FAILED;
}

/* TetGen may end its process in ways that nothing can catch, so it runs in a process of its own. */
static int run(const Job *job) {
  volatile int *phase = mmap(NULL, sizeof *phase, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  sigset_t interruptions, awaited, former;
  list_interruptions(&interruptions);
  awaited = interruptions;
  sigaddset(&awaited, SIGCHLD);
  sigprocmask(SIG_BLOCK, &awaited, &former);
  const pid_t parent = getpid();
  const pid_t child = phase == MAP_FAILED ? -1 : fork();
  if (child < 0) {
    cli_error("cannot start a process: %s", strerror(errno));
    return CLI_FAILED;
  }
  if (child == 0) {
    for (int number = 1; number < NSIG; number++)
      if (sigismember(&interruptions, number) == 1)
        signal(number, SIG_DFL); /* the parent says what happened */
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent)
      _exit(CLI_FAILED);
    sigprocmask(SIG_SETMASK, &former, NULL);
    const int code = work(job, &interruptions, phase);
    fflush(NULL);
    _exit(code);
  }
  int status, caught = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    const int number = sigwaitinfo(&awaited, NULL);
    if (number > 0 && number != SIGCHLD) {
      caught = number;
      kill(child, number);
    }
  }
  return caught ? interrupted(caught) : explain(job, status, *phase, &interruptions);
}

/* ── the command line ── */

static int parse_limit(const char *option, const char *text, double above, double *value) {
  if (cli_parse_number(text, value) && (*value > above || *value == 0))
    return -1;
  return cli_usage_error("mesh", "%s %s: expected a number above %g, or 0 for none", option, text, above);
}

static int parse_option(Job *job, int code) {
  switch (code) {
  case 'o':
    job->output = optarg;
    return -1;
  case 'q':
    job->quality_given = true;
    return parse_limit("--quality", optarg, 1, &job->quality);
  case 'v':
    return parse_limit("--max-volume", optarg, 0, &job->max_volume);
  case 'f':
    job->with_field = true;
    return field_parse(optarg, &job->field);
  case 's':
    job->single = true;
    return -1;
  case 'S':
    cli_set_strict(true);
    return -1;
  default:
    cli_set_quiet(true);
    return -1;
  }
}

static const struct option words[] = {{"output", required_argument, NULL, 'o'},
                                      {"quality", required_argument, NULL, 'q'},
                                      {"max-volume", required_argument, NULL, 'v'},
                                      {"field", required_argument, NULL, 'f'},
                                      {"single", no_argument, NULL, 's'},
                                      {"quiet", no_argument, NULL, 'Q'},
                                      {"help", no_argument, NULL, 'h'},
                                      {"strict", no_argument, NULL, 'S'},
                                      {NULL, 0, NULL, 0}};

int completion_of_mesh(CompletionOption list[COMPLETION_OPTIONS]) {
  static const char *fields[COMPLETION_WORDS];
  const int count = completion_of_words(words, list);
  for (int i = 0; i < count; i++)
    if (!strcmp(list[i].name, "field"))
      list[i].words = completion_words(field_name, fields);
  return count;
}

static int parse(int argc, char **argv, Job *job) {
  optind = 0;
  int code;
  while ((code = getopt_long(argc, argv, ":ho:", words, NULL)) != -1) {
    if (code == '?' || code == ':')
      return cli_bad_option("mesh", code, argc, argv, words);
    if (code == 'h') {
      fputs(help_text, stdout);
      field_print_help();
      fputs(more_help_text, stdout);
      return cli_finish_output();
    }
    const int result = parse_option(job, code);
    if (result >= 0)
      return result;
  }
  if (optind == argc)
    return cli_usage_error("mesh", "no surface given");
  if (optind + 1 < argc)
    return cli_usage_error("mesh", "more than one surface: '%s' and '%s'", argv[optind], argv[optind + 1]);
  job->surface = argv[optind];
  if (!job->output)
    return cli_usage_error("mesh", "no output given: -o OUT.vtu");
  CliFile surface = cli_file_identify(job->surface), output = cli_file_identify(job->output);
  const bool same = cli_file_same(&surface, &output);
  cli_file_forget(&surface);
  cli_file_forget(&output);
  if (same)
    return cli_usage_error("mesh", "the surface and --output are the same file, '%s'", job->output);
  if (!ends_with(job->output, ".vtu"))
    return cli_usage_error("mesh", "--output %s: expected the name of a .vtu file", job->output);
  return -1;
}

int tetcast_cli_mesh(int argc, char **argv) {
  Job job = {0};
  const int code = parse(argc, argv, &job);
  if (code >= 0)
    return code;
  cli_file_tidy(job.output);
  if (!cli_file_check(job.output))
    return CLI_FAILED;
  return run(&job);
}
