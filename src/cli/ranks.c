/* SPDX-License-Identifier: Apache-2.0 */
#include "ranks.h"

#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cli.h"
#include "json.h"
#include "progress.h"
#include "ranks_parts.h"

typedef struct Ranks Ranks;

static TetcastStatus broadcast(const Ranks *ranks, int root, void *data, size_t bytes) {
  return ranks->mpi->mpi_broadcast(ranks->world, root, data, (int64_t)bytes);
}

/* ── what a stage asks of others ── */

/* What rank 0 wants of the others: statistics, or (bins 0) that they go on with this exit code. */
typedef struct Request {
  double range[2];
  int32_t bins, code;
} Request;

/* The statistics of all parts of all ranks. */
static TetcastStatus gather(const Ranks *ranks, const Request *request, TetcastStatistics **statistics) {
  TetcastStatistics **own = cli_allocate(sizeof(TetcastStatistics *) * (size_t)(ranks->count + 1));
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  memcpy(desc.range, request->range, sizeof desc.range);
  desc.bins = request->bins;
  TetcastStatus status = TETCAST_OK;
  int count = 0;
  cli_set_apart(true);
  for (int i = 0; i < ranks->count && status == TETCAST_OK; i++) {
    const Stage *part = &ranks->parts[i];
    if (!part->scene || !part->field)
      continue;
    status = tetcast_statistics_create(part->context, part->mesh, part->field, &desc, &own[count]);
    count += status == TETCAST_OK;
  }
  cli_set_apart(false);
  status = ranks->mpi->mpi_agree(ranks->world, status);
  if (status == TETCAST_OK)
    status = ranks->mpi->mpi_statistics(ranks->world, (const TetcastStatistics *const *)own, count, statistics);
  while (count > 0)
    tetcast_statistics_destroy(ranks->context, &own[--count]);
  free(own);
  return status;
}

static TetcastStatus ask_statistics(void *user, const TetcastStatisticsDesc *desc, TetcastStatistics **statistics) {
  const Ranks *ranks = user;
  Request request = {.range = {desc->range[0], desc->range[1]}, .bins = desc->bins};
  const TetcastStatus status = broadcast(ranks, 0, &request, sizeof request);
  return status == TETCAST_OK ? gather(ranks, &request, statistics) : status;
}

static int meet(void *user, int code) {
  const Ranks *ranks = user;
  Request request = {.code = code};
  for (;;) {
    const TetcastStatus status = broadcast(ranks, 0, &request, sizeof request);
    if (status != TETCAST_OK)
      return cli_failed(status);
    if (request.bins == 0)
      return request.code;
    TetcastStatistics *statistics = NULL;
    gather(ranks, &request, &statistics); /* where it fails, rank 0 says so */
    tetcast_statistics_destroy(ranks->context, &statistics);
  }
}

/* The value that a share of the volume lies below: the bin that has it is divided again and again. */
static TetcastStatus find_quantile(Ranks *ranks, const double range[2], double share, double *value) {
  enum { BINS = 4096 };
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  double low = range[0], high = range[1];
  desc.bins = BINS;
  *value = low;
  while (low < high) {
    TetcastStatistics *statistics = NULL;
    desc.range[0] = low;
    desc.range[1] = high;
    const TetcastStatus status = ask_statistics(ranks, &desc, &statistics);
    if (status != TETCAST_OK)
      return status;
    const double wanted = share * statistics->total, *volume = statistics->volume;
    double passed = statistics->below;
    int bin = 0;
    while (bin < BINS - 1 && !(volume[bin] > 0 && passed + volume[bin] >= wanted))
      passed += volume[bin++];
    const double part = volume[bin] > 0 ? fmin(fmax((wanted - passed) / volume[bin], 0), 1) : 0;
    const double from = (double)bin / BINS, to = (bin + 1.0) / BINS;
    const double next[2] = {low * (1 - from) + high * from, low * (1 - to) + high * to};
    *value = next[0] * (1 - part) + next[1] * part;
    tetcast_statistics_destroy(ranks->context, &statistics);
    if (!(next[0] > low || next[1] < high)) /* it can't be divided further */
      break;
    low = next[0];
    high = next[1];
  }
  return TETCAST_OK;
}

static TetcastStatus ask_quantiles(void *user, const double range[2], const double *shares, int count, double *values) {
  TetcastStatus status = TETCAST_OK;
  for (int i = 0; i < count && status == TETCAST_OK; i++)
    status = find_quantile(user, range, shares[i], &values[i]);
  return status;
}

static TetcastStatus scale(void *user, const TetcastTransferFunction *shape, const TetcastCamera *camera,
                           TetcastTransferFunction **transfer_function) {
  const Ranks *ranks = user;
  return ranks->mpi->mpi_scale_transfer_function(ranks->world, ranks->scenes, ranks->scene_count, ranks->bounds, shape,
                                                 camera, 0.5, transfer_function);
}

static TetcastStatus fit(void *user, const TetcastTransferFunction *shape, const char *preset, const double range[2],
                         TetcastTransferFunction **transfer_function) {
  const Ranks *ranks = user;
  TetcastTransferFunction *map = NULL;
  if (ranks->rank == 0 && !shape) /* where that fails, the call below does on all ranks */
    tetcast_transfer_function_create_preset(ranks->context, preset, 0, 1, 1, &map);
  const TetcastStatus status =
      ranks->mpi->mpi_fit_transfer_function(ranks->world, ranks->scenes, ranks->scene_count, ranks->bounds,
                                            shape ? shape : map, range[0], range[1], transfer_function);
  tetcast_transfer_function_destroy(&map);
  return status;
}

static TetcastScene *scene_at(void *user, int i) {
  const Ranks *ranks = user;
  return i < ranks->scene_count ? ranks->scenes[i] : NULL;
}

/* ── start and end ── */

/* A number that one of these variables of the environment has; `otherwise` where none does. */
static int number_of_environment(const char *const *names, int otherwise) {
  for (; *names; names++) {
    const char *text = getenv(*names);
    double value;
    if (text && cli_parse_number(text, &value) && value >= 0 && value < 1e9)
      return (int)value;
  }
  return otherwise;
}

static bool foreseen;

void ranks_foresee(int argc, char **argv) {
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", NULL};
  for (int i = 1; i < argc; i++)
    foreseen = foreseen || !strcmp(argv[i], "--mpi");
  if (foreseen)
    cli_set_rank(number_of_environment(names, 0));
}

bool ranks_foreseen(void) {
  return foreseen;
}

void ranks_wait(Stage *stage) {
  TetcastMpi *world = NULL;
  if (!foreseen || stage->others)
    return;
  cli_interrupt_hold(true);
  if (!stage->context)
    stage->context = cli_context_create(1);
  if (stage->context && cli_mpi() && cli_mpi()->mpi_create_world(stage->context, &world) == TETCAST_OK)
    cli_mpi()->mpi_destroy(&world);
}

int ranks_started(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_SIZE", NULL};
  const int size = number_of_environment(names, 1);
  return size > 1 ? size : 1;
}

void ranks_warn(void) {
  static const char *const numbers[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", NULL};
  const int size = ranks_started();
  if (!foreseen && size > 1 && number_of_environment(numbers, 0) == 0)
    cli_warning("this is one of %d processes, each of which makes the whole picture; --mpi shares it out", size);
}

int ranks_threads(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", NULL};
  const int processors = (int)sysconf(_SC_NPROCESSORS_ONLN);
  const int neighbours = number_of_environment(names, 1);
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_COUNT(&allowed) < processors)
    return CPU_COUNT(&allowed); /* mpirun has shared them out */
  return neighbours > 1 && processors > neighbours ? processors / neighbours : neighbours > 1 ? 1 : 0;
}

static int begin(Stage *stage, const CliMpi *mpi, TetcastMpi *world, int code) {
  Ranks *ranks = cli_allocate(sizeof *ranks);
  *ranks = (Ranks){.context = stage->context,
                   .mpi = mpi,
                   .world = world,
                   .rank = mpi->mpi_rank(world),
                   .size = mpi->mpi_size(world)};
  ranks->others = (StageOthers){.ranks = ranks,
                                .first = ranks->rank == 0,
                                .statistics = ask_statistics,
                                .quantiles = ask_quantiles,
                                .meet = meet,
                                .scale = scale,
                                .fit = fit,
                                .scene = scene_at};
  stage->others = &ranks->others;
  cli_set_rank(ranks->rank);
  return ranks_agree(stage, code);
}

int ranks_begin(Stage *stage, const RenderOptions *options, int code) {
  if (!options->mpi || !stage->context)
    return code;
  const CliMpi *mpi = cli_mpi();
  TetcastMpi *world = NULL;
  if (!mpi)
    return CLI_FAILED;
  const TetcastStatus status = mpi->mpi_create_world(stage->context, &world);
  return status == TETCAST_OK ? begin(stage, mpi, world, code) : cli_failed(status);
}

int ranks_join(Stage *stage, int communicator) {
  const CliMpi *mpi = cli_mpi();
  TetcastMpi *world = NULL;
  if (!mpi)
    return CLI_FAILED;
  const TetcastStatus status = mpi->mpi_create(stage->context, communicator, &world);
  return status == TETCAST_OK ? begin(stage, mpi, world, CLI_DONE) : cli_failed(status);
}

int ranks_size(const Stage *stage) {
  return stage->others ? ranks_of(stage)->size : 1;
}

int ranks_share_number(const Stage *stage, int64_t *number) {
  const TetcastStatus status = stage->others ? broadcast(ranks_of(stage), 0, number, sizeof *number) : TETCAST_OK;
  return status == TETCAST_OK ? CLI_DONE : cli_failed(status);
}

void ranks_drop(Stage *stage) {
  Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return;
  for (int i = 0; i < ranks->count; i++) {
    Stage *part = &ranks->parts[i];
    tetcast_scene_destroy(&part->scene);
    if (i == 0 && stage->of_series && part->volume) { /* which serves the next step, if it has the same mesh */
      tetcast_volume_destroy(&ranks->kept);
      ranks->kept = part->volume;
      ranks->kept_fingerprint = part->fingerprint;
      part->volume = NULL;
    }
    tetcast_volume_destroy(&part->volume);
    stage_drop_dataset(part);
    matter_release(&part->matter);
    free(part->array);
    free((char *)part->path);
  }
  free(ranks->parts);
  free(ranks->scenes);
  ranks->parts = NULL;
  ranks->scenes = NULL;
  ranks->count = ranks->scene_count = 0;
  tetcast_scene_destroy(&stage->scene); /* what stands in for the whole */
  tetcast_volume_destroy(&stage->volume);
}

void ranks_end(Stage *stage) {
  Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return;
  cli_interrupt_hold(true); /* for good: the first rank that has gone makes mpirun end the others */
  ranks_drop(stage);
  tetcast_volume_destroy(&ranks->kept);
  ranks->mpi->mpi_destroy(&ranks->world);
  stage->others = NULL;
  free(ranks);
}

int ranks_agree(const Stage *stage, int code) {
  const Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return code;
  cli_set_apart(false);
  if (cli_interrupted())
    code = 128 + cli_interrupted();
  /* The largest code, and the lowest rank that has one but has not said why. */
  double codes[2] = {code, code}, failed[2] = {NAN, NAN};
  if (code != CLI_DONE && !cli_said())
    failed[0] = failed[1] = ranks->rank;
  TetcastStatus status = ranks->mpi->mpi_range(ranks->world, codes);
  if (status == TETCAST_OK)
    status = ranks->mpi->mpi_range(ranks->world, failed);
  if (status != TETCAST_OK)
    return code != CLI_DONE ? code : cli_failed(status);
  if (ranks->rank == 0 && failed[0] > 0 && codes[1] < 128 && failed[0] < ranks->size)
    cli_error("rank %d failed", (int)failed[0]);
  return (int)codes[1];
}

bool ranks_first(const Stage *stage) {
  return !stage->others || stage->others->first;
}

/* ── reading ── */

typedef struct FileList {
  char **path;    /* [count] */
  int64_t *bytes; /* [count] */
  int count, capacity;
} FileList;

static void add_file(void *user, const char *path, int64_t bytes) {
  FileList *list = user;
  int capacity = list->capacity;
  list->path = cli_grow(list->path, list->count, &capacity, sizeof *list->path);
  list->bytes = cli_grow(list->bytes, list->count, &list->capacity, sizeof *list->bytes);
  list->path[list->count] = cli_duplicate(path);
  list->bytes[list->count++] = bytes;
}

static void release_list(FileList *list) {
  for (int i = 0; i < list->count; i++)
    free(list->path[i]);
  free(list->path);
  free(list->bytes);
}

/* A text of one rank, which may be NULL, becomes that of all. */
static TetcastStatus share_text(const Ranks *ranks, int root, char **text) {
  int64_t size = *text ? (int64_t)strlen(*text) + 1 : 0;
  TetcastStatus status = broadcast(ranks, root, &size, sizeof size);
  if (status != TETCAST_OK || size == 0)
    return status;
  if (ranks->rank != root) {
    free(*text);
    *text = cli_allocate((size_t)size);
  }
  return broadcast(ranks, root, *text, (size_t)size);
}

/* Rank 0's list becomes that of all. */
static TetcastStatus share_list(const Ranks *ranks, FileList *list) {
  int64_t sizes[2] = {list->count, 0}; /* how many paths, and how long they are together */
  for (int i = 0; i < list->count; i++)
    sizes[1] += (int64_t)strlen(list->path[i]) + 1;
  TetcastStatus status = broadcast(ranks, 0, sizes, sizeof sizes);
  if (status != TETCAST_OK || sizes[0] == 0)
    return status;
  char *paths = cli_allocate((size_t)sizes[1]), *next = paths;
  for (int i = 0; i < list->count; next += strlen(next) + 1)
    strcpy(next, list->path[i++]);
  int64_t *bytes = cli_allocate(sizeof *bytes * (size_t)sizes[0]);
  if (list->count > 0)
    memcpy(bytes, list->bytes, sizeof *bytes * (size_t)sizes[0]);
  status = broadcast(ranks, 0, bytes, sizeof *bytes * (size_t)sizes[0]);
  if (status == TETCAST_OK)
    status = broadcast(ranks, 0, paths, (size_t)sizes[1]);
  next = paths;
  for (int64_t i = 0; i < sizes[0] && status == TETCAST_OK && ranks->rank > 0; i++) {
    add_file(list, next, bytes[i]);
    next += strlen(next) + 1;
  }
  free(bytes);
  free(paths);
  return status;
}

/* Reads a file of the list as a part. */
static int read_part(Stage *stage, const RenderOptions *options, const FileList *list, int i, Stage **part) {
  *part = ranks_add(stage);
  (*part)->path = cli_duplicate(list->path[i]);
  return stage_read(*part, options);
}

static bool has_cells(const Stage *part) {
  return part->mesh && tetcast_mesh_tetrahedron_count(part->mesh) > 0;
}

/* The first part that has cells, the largest before others, says which array is drawn where none was named: its rank
 * reads it before the others read theirs. Returns its place in `order` or, negative, what went wrong. */
static int choose(Stage *stage, const RenderOptions *options, const FileList *list, const int *order,
                  const int *owner) {
  Ranks *ranks = ranks_of(stage);
  for (int k = 0; k < list->count; k++) {
    const int root = owner[order[k]];
    int32_t found[3] = {CLI_DONE, false, false}; /* the exit code, whether there are cells, and no array */
    if (root == ranks->rank) {
      Stage *part;
      cli_set_apart(true);
      found[0] = read_part(stage, options, list, order[k], &part);
      cli_set_apart(false);
      if (found[0] == CLI_DONE && has_cells(part)) {
        found[1] = true;
        found[2] = stage->uniform = part->uniform;
        free(stage->array);
        stage->array = part->array ? cli_duplicate(part->array) : NULL;
      }
    }
    TetcastStatus status = broadcast(ranks, root, found, sizeof found);
    if (status == TETCAST_OK && found[0] != CLI_DONE)
      return -found[0];
    if (status == TETCAST_OK)
      status = share_text(ranks, root, &stage->array);
    if (status != TETCAST_OK)
      return -cli_failed(status);
    stage->uniform = found[2];
    if (found[1])
      return k;
  }
  cli_error("%s: the files that it lists hold no cells", options->input);
  return -CLI_FAILED;
}

/* Each rank reads its pieces, one by one. */
static int read_pieces(Stage *stage, const RenderOptions *options, const FileList *list) {
  Ranks *ranks = ranks_of(stage);
  if (options->cell_to_point || options->merge_tolerance >= 0) {
    cli_error("%s: --cell-to-point and --merge-tolerance need what is beside a piece, and with --mpi each is read by "
              "itself",
              options->input);
    return CLI_FAILED;
  }
  int *order = cli_allocate(sizeof *order * 2 * (size_t)list->count), *owner = order + list->count, own = 0;
  ranks_spread(list->bytes, list->count, ranks->size, order, owner);
  for (int i = 0; i < list->count; i++)
    own += owner[i] == ranks->rank;
  ranks_reserve(ranks, own);
  const int chosen = choose(stage, options, list, order, owner);
  int code = chosen < 0 ? -chosen : CLI_DONE;
  cli_set_apart(true);
  for (int k = chosen + 1; k < list->count && code == CLI_DONE; k++) {
    Stage *part;
    if (owner[order[k]] == ranks->rank)
      code = read_part(stage, options, list, order[k], &part);
  }
  cli_set_apart(false);
  free(order);
  ranks->all_parts = list->count;
  return ranks_agree(stage, code);
}

/* Rank 0 reads it all, and the others get their parts. */
static int read_whole(Stage *stage, const RenderOptions *options) {
  Ranks *ranks = ranks_of(stage);
  int code = CLI_DONE;
  if (ranks->rank == 0)
    code = stage_read(stage, options);
  code = ranks_agree(stage, code);
  if (code != CLI_DONE)
    return code;
  int32_t uniform = stage->uniform;
  TetcastStatus status = broadcast(ranks, 0, &uniform, sizeof uniform);
  stage->uniform = uniform;
  if (status == TETCAST_OK)
    status = share_text(ranks, 0, &stage->array);
  code = status == TETCAST_OK ? ranks_split(stage) : cli_failed(status);
  stage_drop_dataset(stage);
  return ranks_agree(stage, code);
}

int ranks_read(Stage *stage, const RenderOptions *options) {
  Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return stage_read(stage, options);
  const double start = cli_seconds();
  FileList list = {0};
  int code = cli_vtk() ? CLI_DONE : CLI_FAILED;
  if (code == CLI_DONE && ranks->rank == 0) {
    TetcastDatasetDesc desc = cli_vtk()->dataset_desc_default();
    render_option_dataset(options->block, options->time, -1, &desc);
    const TetcastStatus status = cli_vtk()->dataset_parts(stage->context, options->input, &desc, add_file, &list);
    code = status == TETCAST_OK ? CLI_DONE : cli_failed(status);
  }
  code = ranks_agree(stage, code);
  if (code == CLI_DONE) {
    const TetcastStatus status = share_list(ranks, &list);
    code = ranks_agree(stage, status == TETCAST_OK ? CLI_DONE : cli_failed(status));
  }
  if (code == CLI_DONE)
    code = list.count > 1 ? read_pieces(stage, options, &list) : read_whole(stage, options);
  release_list(&list);
  stage->read_seconds = cli_seconds() - start;
  return code == CLI_DONE ? ranks_agree(stage, cli_verdict(CLI_DONE)) : code;
}

/* ── preparing ── */

/* Bounds that nothing lies in. */
static void set_empty(double bounds[6]) {
  for (int k = 0; k < 6; k++)
    bounds[k] = k % 2 ? -INFINITY : INFINITY;
}

static void add_bounds(const double own[6], double bounds[6]) {
  for (int k = 0; k < 6; k++)
    bounds[k] = k % 2 ? fmax(bounds[k], own[k]) : fmin(bounds[k], own[k]);
}

/* The bounds of the whole: also of what is transparent for lack of the array. */
static TetcastStatus find_bounds(Ranks *ranks) {
  set_empty(ranks->bounds);
  for (int i = 0; i < ranks->count; i++) {
    double own[6];
    if (!has_cells(&ranks->parts[i]))
      continue;
    tetcast_mesh_bounds(ranks->parts[i].mesh, own);
    add_bounds(own, ranks->bounds);
  }
  return ranks->mpi->mpi_bounds(ranks->world, ranks->bounds);
}

/* The range of a part's values, an empty one where none is finite, and how many are not. */
static void find_range(Stage *part) {
  tetcast_field_range(part->field, part->range, &part->nonfinite);
  if (part->nonfinite == tetcast_field_values(part->field).count) {
    part->range[0] = INFINITY;
    part->range[1] = -INFINITY;
  }
}

/* The volumes and scenes of this rank's parts. What was read is kept for the design, if there is to be one. */
static int prepare_scenes(Stage *stage, const RenderOptions *options) {
  Ranks *ranks = ranks_of(stage);
  int code = CLI_DONE;
  ranks->scenes = cli_allocate(sizeof(TetcastScene *) * (size_t)(ranks->count + 1));
  cli_set_apart(true);
  for (int i = 0; i < ranks->count && code == CLI_DONE; i++) {
    Stage *part = &ranks->parts[i];
    if (!has_cells(part) || (!part->field && !render_options_direct(options)))
      continue;
    part->bounds = ranks->bounds;
    cli_progress_part("preparing", (double)i / ranks->count, (i + 1.0) / ranks->count);
    const TetcastStatus status = stage_prepare_scene(part, options);
    if (status != TETCAST_OK)
      code = cli_failed(status);
    else
      ranks->scenes[ranks->scene_count++] = part->scene;
    if (part->field)
      find_range(part);
    if (stage->transfer_function || render_options_direct(options))
      stage_drop_dataset(part);
  }
  cli_progress_clear();
  cli_progress_part(NULL, 0, 1);
  code = cli_verdict(code);
  cli_set_apart(false);
  return code;
}

/* The numbers of the whole: what volumes have, and the values. */
static TetcastStatus sum_up(Stage *stage, const RenderOptions *options) {
  Ranks *ranks = ranks_of(stage);
  enum { VERTICES, TETRAHEDRA, LEFT_OUT, WELDED, SHELL, BYTES, AREA, NONFINITE, SUMS };
  double own[SUMS] = {0}, sums[SUMS], range[2] = {INFINITY, -INFINITY}, groups[2] = {0, 0};
  for (int i = 0; i < ranks->count; i++) {
    const Stage *part = &ranks->parts[i];
    if (part->scene) {
      TetcastVolumeInfo info;
      tetcast_volume_info(part->volume, &info);
      own[VERTICES] += (double)info.vertices;
      own[TETRAHEDRA] += (double)info.tetrahedra;
      own[LEFT_OUT] += (double)info.left_out;
      own[WELDED] += (double)info.welded;
      own[SHELL] += (double)info.shell_faces;
      own[BYTES] += (double)info.bytes;
      stage->info.traversal = info.traversal;
      groups[1] = fmax(groups[1], tetcast_scene_groups(part->scene));
    }
    if (part->scene && !render_options_direct(options)) {
      own[NONFINITE] += (double)part->nonfinite;
      range[0] = fmin(range[0], part->range[0]);
      range[1] = fmax(range[1], part->range[1]);
    }
  }
  TetcastStatus status = ranks->mpi->mpi_sum(ranks->world, own, 1, SUMS, sums);
  if (status == TETCAST_OK)
    status = ranks->mpi->mpi_range(ranks->world, range);
  if (status == TETCAST_OK)
    status = ranks->mpi->mpi_range(ranks->world, groups);
  if (status != TETCAST_OK)
    return status;
  ranks->groups = (int)groups[1];
  stage->info.vertices = (int64_t)sums[VERTICES];
  stage->info.tetrahedra = (int64_t)sums[TETRAHEDRA];
  stage->info.left_out = (int64_t)sums[LEFT_OUT];
  stage->info.welded = (int64_t)sums[WELDED];
  stage->info.shell_faces = (int64_t)sums[SHELL];
  stage->info.bytes = (size_t)sums[BYTES];
  memcpy(stage->info.bounds, ranks->bounds, sizeof ranks->bounds);
  stage->nonfinite = (int64_t)sums[NONFINITE];
  for (int i = 0; i < 2; i++)
    stage->range[i] = range[0] <= range[1] ? range[i] : 0;
  return TETCAST_OK;
}

/* A scene of one cell that reaches from one end of the bounds to the other along each axis. */
static TetcastStatus stand_in(Stage *stage) {
  static const int corner[4][3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
  static const int32_t tetrahedron[4] = {0, 1, 2, 3};
  double vertices[4][3];
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++)
      vertices[i][k] = stage->info.bounds[2 * k + corner[i][k]];
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){.data = vertices, .type = TETCAST_TYPE_FLOAT64, .count = 4};
  desc.tetrahedra = (TetcastArray){.data = tetrahedron, .type = TETCAST_TYPE_INT32, .count = 1};
  TetcastMesh *mesh = NULL;
  TetcastStatus status = tetcast_mesh_create(stage->context, &desc, &mesh);
  if (status == TETCAST_OK)
    status = tetcast_volume_create(stage->context, mesh, NULL, &stage->volume);
  if (status == TETCAST_OK)
    status = tetcast_scene_create(stage->context, stage->volume, &stage->scene);
  tetcast_mesh_destroy(&mesh);
  return status;
}

/* ── labels ── */

/* Labels on their way: how many, negative where there is no part that could have some. */
typedef struct Labels {
  double count, label[MATTER_LABELS];
} Labels;

/* The labels of all parts of all ranks. */
static TetcastStatus share_labels(Stage *stage) {
  const Ranks *ranks = ranks_of(stage);
  Matter *matter = &stage->matter;
  Labels labels = {.count = -1};
  TetcastStatus status = TETCAST_OK;
  matter_release(matter);
  for (int i = 0; i < ranks->count; i++)
    if (ranks->parts[i].matter.labels)
      matter_unite(&ranks->parts[i].matter, matter);
  for (int r = 1; r < ranks->size && ranks->rank == 0 && status == TETCAST_OK; r++) {
    status = ranks->mpi->mpi_receive(ranks->world, r, &labels, sizeof labels);
    if (status == TETCAST_OK && labels.count >= 0)
      matter_unite(&(Matter){.labels = labels.label, .count = (int)labels.count}, matter);
  }
  if (matter->labels) {
    labels.count = matter->count;
    memcpy(labels.label, matter->labels, sizeof *labels.label * (size_t)matter->count);
  }
  if (ranks->rank > 0)
    status = ranks->mpi->mpi_send(ranks->world, 0, &labels, sizeof labels);
  if (status == TETCAST_OK)
    status = broadcast(ranks, 0, &labels, sizeof labels);
  if (status == TETCAST_OK && ranks->rank > 0) {
    matter_release(matter);
    matter_unite(&(Matter){.labels = labels.label, .count = (int)labels.count}, matter);
  }
  return status;
}

/* As matter_measure() does it for one mesh: the extinction of a scalar that is 1 everywhere, and then labels again. */
static int measure_matter(Stage *stage) {
  const Ranks *ranks = ranks_of(stage);
  static const double one[2] = {1, 1};
  TetcastStatus status = TETCAST_OK;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < ranks->count && status == TETCAST_OK; i++) {
      Stage *part = &ranks->parts[i];
      TetcastField *ones = NULL;
      if (!part->scene)
        continue;
      if (pass == 0)
        status = matter_field(stage->context, part->mesh, &ones);
      if (status == TETCAST_OK)
        status = tetcast_scene_set_field(part->scene, pass == 0 ? ones : part->field);
      tetcast_field_destroy(&ones);
    }
    const int code = ranks_agree(stage, status == TETCAST_OK ? CLI_DONE : cli_failed(status));
    if (code != CLI_DONE)
      return code;
    if (pass == 0) {
      TetcastTransferFunction *preset = NULL;
      int64_t count;
      status = fit(ranks_of(stage), NULL, tetcast_preset_name(0), one, &preset);
      if (status == TETCAST_OK)
        stage->matter.extinction = tetcast_transfer_function_extinction(preset, &count)[1];
      tetcast_transfer_function_destroy(&preset);
    }
  }
  status = share_labels(stage);
  return ranks_agree(stage, status == TETCAST_OK ? CLI_DONE : cli_failed(status));
}

int ranks_prepare(Stage *stage, const RenderOptions *options) {
  Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return stage_prepare(stage, options);
  const double start = cli_seconds();
  int code = CLI_DONE;
  for (int i = 0; i < ranks->count && code == CLI_DONE; i++)
    code = stage_check_field(&ranks->parts[i], options);
  cli_interrupt_hold(true);
  TetcastStatus status = find_bounds(ranks);
  if (status != TETCAST_OK)
    code = cli_failed(status);
  code = ranks_agree(stage, code);
  if (code == CLI_DONE)
    code = ranks_agree(stage, prepare_scenes(stage, options));
  if (code == CLI_DONE) {
    status = sum_up(stage, options);
    if (status == TETCAST_OK && ranks->rank == 0)
      status = stand_in(stage);
    code = ranks_agree(stage, status == TETCAST_OK ? CLI_DONE : cli_failed(status));
  }
  if (code == CLI_DONE && stage->uniform && stage->array)
    code = measure_matter(stage);
  if (code == CLI_DONE)
    code = ranks_agree(stage, stage_complete(stage, options));
  for (int i = 0; i < ranks->count; i++)
    stage_drop_dataset(&ranks->parts[i]);
  stage->prepare_seconds = cli_seconds() - start;
  return code;
}

/* ── the picture ── */

int ranks_groups(const Stage *stage) {
  const Ranks *ranks = ranks_of(stage);
  return ranks ? ranks->groups : tetcast_scene_groups(stage->scene);
}

/* Cells that are in several pieces are seen twice, and hide what is behind them twice. */
static void check_overlap(const Ranks *ranks) {
  double size = 0;
  for (int k = 0; k < 3; k++)
    size = hypot(size, ranks->bounds[2 * k + 1] - ranks->bounds[2 * k]);
  if (ranks->rank == 0 && ranks->stats.overlap > 1e-9 * size)
    cli_warning("parts of the mesh overlap by up to %.3g, of %.3g that it measures: some cells are in several pieces, "
                "as ghosts are that no vtkGhostType marks, or cells overlap",
                ranks->stats.overlap, size);
}

TetcastStatus ranks_render(const Stage *stage, const TetcastRenderDesc *desc, TetcastFrame *frame,
                           TetcastRenderStats *stats) {
  Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return tetcast_scene_render(stage->scene, &stage->camera, desc, frame, stats);
  const TetcastStatus status = ranks->mpi->mpi_render(ranks->world, (const TetcastScene *const *)ranks->scenes,
                                                      ranks->scene_count, &stage->camera, desc, frame, &ranks->stats);
  if (status != TETCAST_OK)
    return status;
  *stats = (TetcastRenderStats){.segments = ranks->stats.segments,
                                .lost = ranks->stats.lost,
                                .isa = ranks->stats.isa,
                                .precision = "double",
                                .error = NAN};
  if (frame)
    stats->rays = tetcast_frame_width(frame) * tetcast_frame_height(frame);
  check_overlap(ranks);
  return status;
}

json_t *ranks_stats(const Stage *stage) {
  const Ranks *ranks = ranks_of(stage);
  if (!ranks)
    return NULL;
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  double resident[2] = {(double)usage.ru_maxrss * 1024, (double)usage.ru_maxrss * 1024}; /* Linux counts in KiB */
  ranks->mpi->mpi_range(ranks->world, resident);
  const TetcastMpiStats *s = &ranks->stats;
  json_t *object = json_object();
  json_object_set_new(object, "count", json_integer(ranks->size));
  json_object_set_new(object, "parts", json_integer(ranks->all_parts));
  json_object_set_new(object, "fragments", json_integer(s->fragments));
  json_object_set_new(object, "overlap", json_real(s->overlap));
  json_object_set_new(object, "bytes", json_integer(s->bytes));
  json_object_set_new(object, "most_bytes", json_integer(s->most_bytes));
  json_object_set_new(object, "memory", json_integer(s->memory));
  json_object_set_new(object, "most_peak_rss_bytes", json_integer((json_int_t)resident[1]));
  json_object_set_new(object, "bands", json_integer(s->bands));
  json_object_set_new(object, "fragment_seconds", json_real(s->render_seconds));
  json_object_set_new(object, "wait_seconds", json_real(s->wait_seconds));
  json_object_set_new(object, "exchange_seconds", json_real(s->exchange_seconds));
  json_object_set_new(object, "composite_seconds", json_real(s->composite_seconds));
  json_object_set_new(object, "gather_seconds", json_real(s->gather_seconds));
  return object;
}
