/* SPDX-License-Identifier: Apache-2.0 */
#include "jobs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How the mesh is shared out; the part that is measured is one of eight, but of the whole. */
typedef enum Share { WHOLE, BOX, WAVES, SCATTER, SHARES } Share;

static const char *const share_names[SHARES] = {"the whole", "a box", "a slab with wavy faces", "an eighth at random"};

/* What is seen of it. */
typedef enum Look { PLAIN, SURFACES, GROUP, GROUPS, LOOKS } Look;

static const struct {
  const char *name;
  int surfaces, groups;
} looks[LOOKS] = {{"", 0, 0}, {" with isosurfaces", 2, 0}, {" with coefficients", 0, 1}, {" with 8 groups", 0, 8}};

/* A part, as a picture and as fragments, which are measured by turns. */
typedef struct Measure {
  Share share;
  Look look;
  Times times[2];
  TetcastRenderStats stats[2];
} Measure;

static bool has_cell(const BenchMesh *mesh, Share share, int64_t cell, uint64_t *seed) {
  double at[3] = {0, 0, 0};
  for (int j = 0; j < 4; j++) {
    for (int k = 0; k < 3; k++)
      at[k] += 0.25 * bench_mesh_coordinate(mesh, mesh->cells[cell][j], k);
  }
  *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  const double place = 8 * (at[0] + 0.15 * sin(9 * at[1]) + 0.1 * cos(11 * at[2]));
  switch (share) {
  case BOX:
    return at[0] < 0.5 && at[1] < 0.5 && at[2] < 0.5;
  case WAVES:
    return place >= 3 && place < 4;
  case SCATTER:
    return *seed >> 61 == 0;
  default:
    return true;
  }
}

/* The part's cells, and the vertices that they use. */
static void make_part(const BenchMesh *mesh, Share share, BenchMesh *part) {
  int32_t *number = calloc((size_t)mesh->vertex_count, sizeof *number), vertices = 0;
  must(number != NULL && bench_mesh_allocate(part, mesh->type, mesh->vertex_count, mesh->cell_count), "no memory");
  uint64_t seed = 5;
  part->cell_count = 0;
  for (int64_t i = 0; i < mesh->cell_count; i++) {
    if (!has_cell(mesh, share, i, &seed))
      continue;
    for (int j = 0; j < 4; j++) {
      const int32_t vertex = mesh->cells[i][j];
      if (number[vertex] == 0) {
        double position[3];
        for (int k = 0; k < 3; k++)
          position[k] = bench_mesh_coordinate(mesh, vertex, k);
        bench_mesh_set_vertex(part, vertices, position);
        number[vertex] = ++vertices;
      }
      part->cells[part->cell_count][j] = number[vertex] - 1;
    }
    part->cell_count++;
  }
  part->vertex_count = vertices;
  bench_mesh_set_scalars(part);
  free(number);
}

static void must_be_ok(TetcastStatus status) {
  must(status == TETCAST_OK, "tetcast failed");
}

/* The scene of a part, with the bounds of the whole. */
static void open_part(Tet *tet, const BenchMesh *whole, const BenchMesh *part) {
  double bounds[6] = {INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY};
  for (int64_t i = 0; i < whole->vertex_count; i++) {
    for (int k = 0; k < 3; k++) {
      bounds[2 * k] = fmin(bounds[2 * k], bench_mesh_coordinate(whole, i, k));
      bounds[2 * k + 1] = fmax(bounds[2 * k + 1], bench_mesh_coordinate(whole, i, k));
    }
  }
  tet_open(tet, part, 1);
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.bounds = bounds;
  must_be_ok(tetcast_volume_create(tet->context, tet->mesh, &desc, &tet->volume));
  must_be_ok(tetcast_scene_create(tet->context, tet->volume, &tet->scene));
  must_be_ok(tetcast_scene_set_field(tet->scene, tet->field));
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.normals = TETCAST_NORMALS_FLAT;
  must_be_ok(tetcast_scene_set_shading(tet->scene, &shading));
  tet_transfer(tet, &transfer_soft);
}

/* Repeated while that is a matter of moments, as measure_frame() does it. */
static Clock measure_fragments(const Job *job, Tet *tet, const TetcastCamera *camera, TetcastFragments *fragments,
                               TetcastRenderStats *stats) {
  const int pixels = job->options->pixels;
  Times times = {0};
  double sum = 0;
  do {
    const Clock start = clock_now();
    must_be_ok(tetcast_scene_render_fragments(tet->scene, camera, NULL, pixels, pixels, fragments, stats));
    const Clock time = clock_since(start);
    times_add(&times, time);
    sum += time.wall;
  } while (sum < job->options->least && times.wall.count < SAMPLES);
  return times_median(&times);
}

/* The scalar as extinction and emission of each group. */
static void set_groups(Tet *tet, int count) {
  const TetcastField *fields[TETCAST_MAX_GROUPS];
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  for (int i = 0; i < count; i++)
    fields[i] = tet->field;
  desc.extinction = desc.emission = fields;
  desc.extinction_count = desc.emission_count = count;
  must_be_ok(tetcast_scene_set_coefficients(tet->scene, &desc));
}

static void measure_part(const Job *job, Measure *measure) {
  static const TetcastIsosurface surfaces[2] = {{0.4, {1, 0.5, 0}, 0.3}, {0.6, {0, 0.5, 1}, 0.3}};
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  BenchMesh part;
  Tet tet;
  TetcastFragments *fragments = NULL;
  make_part(job->mesh, measure->share, &part);
  open_part(&tet, job->mesh, &part);
  must_be_ok(tetcast_scene_set_isosurfaces(tet.scene, surfaces, looks[measure->look].surfaces));
  if (looks[measure->look].groups)
    set_groups(&tet, looks[measure->look].groups);
  must_be_ok(tetcast_fragments_create(tet.context, &fragments));
  TetcastFrame *frame = tet_frame(&tet, job->options->pixels, TETCAST_TYPE_FLOAT64, 0);
  for (int round = 0; round < job->scene->rounds; round++) {
    times_add(&measure->times[0], measure_frame(job, &tet, &camera, NULL, frame, &measure->stats[0]));
    times_add(&measure->times[1], measure_fragments(job, &tet, &camera, fragments, &measure->stats[1]));
  }
  tetcast_fragments_destroy(&fragments);
  tetcast_frame_destroy(&frame);
  tet_close(&tet);
  bench_mesh_release(&part);
}

void job_parts(const Job *job) {
  Row row = job->row;
  row.task = "parts";
  row.threads = 1;
  row.pixels = job->options->pixels;
  for (int i = 0; i < LOOKS * SHARES; i++) {
    Measure measure = {.share = (Share)(i % SHARES), .look = (Look)(i / SHARES)};
    char name[64];
    measure_part(job, &measure);
    snprintf(name, sizeof name, "%s%s", share_names[measure.share], looks[measure.look].name);
    row.what = name;
    for (int j = 0; j < 2; j++) {
      row.renderer = j == 0 ? "frame" : "fragments";
      row.isa = measure.stats[j].isa;
      row.precision = measure.stats[j].precision;
      row.times = &measure.times[j];
      row.crossed = measure.stats[j].segments;
      row_write(&row);
    }
  }
}
