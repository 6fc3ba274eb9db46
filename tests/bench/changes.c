/* SPDX-License-Identifier: Apache-2.0 */
#include "jobs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ── memory ── */

void job_memory(const Job *job) {
  Row row = job->row;
  row.task = "memory";
  row.renderer = "tetcast";
  row.threads = 2;
  Tet tet;
  tet_open(&tet, job->mesh, row.threads);
  double before = peak_bytes();
  tet_prepare(&tet);
  row.peak = peak_bytes() - before;
  TetcastVolumeInfo info;
  tetcast_volume_info(tet.volume, &info);
  row.resident = (double)info.bytes;
  row.shell_faces = info.shell_faces;
  row_write(&row);
  tet_close(&tet);
}

void job_memory_vtk(const Job *job) {
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  Row row = job->row;
  row.task = "memory";
  row.renderer = "VTK";
  row.threads = 1;
  Caster *caster = caster_create(job->mesh);
  double before = peak_bytes();
  must(caster && caster_view(caster, &camera, job->options->pixels, job->options->pixels), "VTK has no memory");
  row.peak = peak_bytes() - before;
  row_write(&row);
  caster_destroy(caster);
}

/* ── another transfer function ── */

/* What a change costs: setting it, and by how much the next picture, a small one, takes longer than the one after that.
 */
static void change(const Job *job, Tet *tet, const char *what, const Transfer *from, const Transfer *to, int threads) {
  enum { SMALL = 32 };
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  Row row = job->row;
  row.task = "transfer function";
  row.what = what;
  row.renderer = "tetcast exact";
  row.threads = threads;
  must(tetcast_context_set_threads(tet->context, threads) == TETCAST_OK, "threads");
  TetcastFrame *frame = tet_frame(tet, SMALL, TETCAST_TYPE_FLOAT64, 0);
  Times all = {0};
  for (int round = 0; round < job->scene->rounds; round++) {
    tet_transfer(tet, from);
    tet_render(tet, &camera, NULL, frame, NULL);
    Clock set = tet_transfer(tet, to);
    Clock first = tet_render(tet, &camera, NULL, frame, NULL);
    Clock later = measure_frame(job, tet, &camera, NULL, frame, NULL);
    times_add(&all, (Clock){.wall = set.wall + fmax(0, first.wall - later.wall),
                            .cpu = set.cpu + fmax(0, first.cpu - later.cpu)});
  }
  row.times = &all;
  row_write(&row);
  tetcast_frame_destroy(&frame);
}

void job_visible(const Job *job) {
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  const double threshold = scene_threshold(job->mesh, 0.01);
  must(!isnan(threshold), "no memory");
  const Transfer everything = transfer_above(-0.5), few = transfer_above(threshold);
  Tet tet;
  tet_open(&tet, job->mesh, 2);
  tet_prepare(&tet);
  for (int threads = 1; threads <= 2; threads++) {
    change(job, &tet, "all visible before and after", &transfer_soft, &transfer_softer, threads);
    change(job, &tet, "from all visible to 1 %", &everything, &few, threads);
    change(job, &tet, "from 1 % visible to all", &few, &everything, threads);
  }

  must(tetcast_context_set_threads(tet.context, 1) == TETCAST_OK, "threads");
  Times times[2] = {0};
  TetcastRenderStats stats[2];
  TetcastFrame *frame = tet_frame(&tet, job->options->pixels, TETCAST_TYPE_FLOAT64, 0);
  for (int round = 0; round < job->scene->rounds; round++) {
    for (int i = 0; i < 2; i++) {
      tet_transfer(&tet, i == 0 ? &everything : &few);
      tet_render(&tet, &camera, NULL, frame, NULL); /* so that nothing is left to be made */
      times_add(&times[i], measure_frame(job, &tet, &camera, NULL, frame, &stats[i]));
    }
  }
  Row row = job->row;
  row.task = "frame";
  row.renderer = "tetcast exact";
  row.threads = 1;
  row.pixels = job->options->pixels;
  for (int i = 0; i < 2; i++) {
    row.what = i == 0 ? "100 % visible" : "1 % visible";
    row.isa = stats[i].isa;
    row.precision = stats[i].precision;
    row.times = &times[i];
    row.crossed = stats[i].segments;
    row_write(&row);
  }
  tetcast_frame_destroy(&frame);
  tet_close(&tet);
}

/* ── features ── */

/* A picture like that through transfer_linear but for one thing. */
typedef struct Feature {
  const char *name;
  const Transfer *transfer;
  int values;       /* 0: the points', 1: the cells', 2: the same everywhere */
  TetcastType type; /* of the frame; none: double */
  uint32_t channels;
  int samples;     /* 0: one */
  int isosurfaces; /* so many, opaque and lit, with nothing else to see; negative: half-transparent, in the volume */
  Times times;
  TetcastRenderStats stats;
  TetcastBlend blend;
  int planes; /* 1: clipped to `oblique` */
  bool left;  /* of the mesh without the cells that lie beyond `oblique` */
  TetcastShade shade;
  bool shadows;
  int rows;        /* 0: a transfer function of one dimension; else of so many rows */
  int edges;       /* 1: the boundary's triangles; 2: the boundary without its triangles */
  bool part;       /* only the middle of rays counts */
  double adaptive; /* rays are cast where pixels differ by so much, from every fourth pixel on; 0: everywhere */
} Feature;

/* At equal distances over the range of the scalar. */
static void set_isosurfaces(Tet *tet, int count) {
  TetcastIsosurface list[8];
  const int surfaces = abs(count);
  for (int i = 0; i < surfaces; i++) {
    list[i] = (TetcastIsosurface){
        .value = isosurface_value(i, surfaces), .color = {0.9, 0.5, 0.2}, .opacity = count < 0 ? 0.5 : 1};
  }
  must(tetcast_scene_set_isosurfaces(tet->scene, list, surfaces) == TETCAST_OK, "isosurfaces");
}

/* A light of its own if there are shadows, else one at the eye. */
static void set_light(Tet *tet, const Feature *feature) {
  static const TetcastLight light = {{1, 2, 1.5}, {1, 1, 1}};
  TetcastShadingDesc desc = tetcast_shading_desc_default();
  desc.shade = feature->shade ? feature->shade : TETCAST_SHADE_SURFACES;
  desc.lights = &light;
  desc.light_count = desc.shadows = feature->shadows;
  must(tetcast_scene_set_shading(tet->scene, &desc) == TETCAST_OK, "set shading");
}

/* Rows at values of the gradient: the same colours and a little more extinction in each. */
static void set_rows(Tet *tet, const Feature *feature) {
  TetcastTransferRow rows[8];
  TetcastTransferFunction *made[8] = {NULL};
  for (int i = 0; i < feature->rows; i++) {
    Transfer transfer = *feature->transfer;
    for (int j = 0; j < transfer.opacity_count; j++)
      transfer.opacity[j][1] *= 0.5 + 0.5 * i / feature->rows;
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    transfer_fill(&desc, &transfer);
    must(tetcast_transfer_function_create(tet->context, &desc, &made[i]) == TETCAST_OK, "row");
    rows[i] = (TetcastTransferRow){.at = 2 * i, .transfer_function = made[i]};
  }
  must(tetcast_scene_set_transfer_rows(tet->scene, rows, feature->rows, NULL) == TETCAST_OK, "set rows");
  for (int i = 0; i < feature->rows; i++)
    tetcast_transfer_function_destroy(&made[i]);
}

static void set_lines(Tet *tet, int edges) {
  const TetcastBoundary boundary = {.opacity = 1, .colored = 1, .color = {1, 1, 1}, .edges = edges == 1};
  must(tetcast_scene_set_boundary(tet->scene, edges ? &boundary : NULL) == TETCAST_OK, "boundary");
}

/* Its plane goes through the middle and cuts off what is next to the camera. */
static const TetcastHalfSpace oblique = {{-0.3, 0.5, -0.8}, -0.3};

/* A mesh of those cells that the clip leaves, with the same vertices. */
static void mesh_left(const BenchMesh *mesh, BenchMesh *left) {
  must(bench_mesh_allocate(left, mesh->type, mesh->vertex_count, mesh->cell_count), "no memory");
  left->cell_count = 0;
  for (int64_t i = 0; i < mesh->cell_count; i++) {
    bool inside = false;
    for (int j = 0; j < 4; j++) {
      double value = -oblique.offset;
      for (int k = 0; k < 3; k++)
        value += oblique.normal[k] * bench_mesh_coordinate(mesh, mesh->cells[i][j], k);
      inside = inside || value >= 0;
    }
    if (inside)
      memcpy(left->cells[left->cell_count++], mesh->cells[i], sizeof *left->cells);
  }
  for (int64_t i = 0; i < mesh->vertex_count; i++) {
    double position[3];
    for (int k = 0; k < 3; k++)
      position[k] = bench_mesh_coordinate(mesh, i, k);
    bench_mesh_set_vertex(left, i, position);
  }
  bench_mesh_set_scalars(left);
}

static TetcastField *make_field(Tet *tet, const BenchMesh *mesh, int values, double *memory) {
  const bool cells = values == 1;
  const int64_t count = cells ? mesh->cell_count : mesh->vertex_count;
  for (int64_t i = 0; i < count; i++) {
    memory[i] = values == 2 ? 0.5 : bench_mesh_scalar(mesh, cells ? mesh->cells[i][0] : i);
  }
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){.data = memory, .type = TETCAST_TYPE_FLOAT64, .count = count};
  desc.association = cells ? TETCAST_CELL : TETCAST_POINT;
  TetcastField *field = NULL;
  must(tetcast_field_create(tet->context, &desc, &field) == TETCAST_OK, "field");
  return field;
}

/* The distances [2][pixels] between which rays are near the middle of what the camera sees. */
static double *middle_of_rays(const TetcastCamera *camera, int64_t pixels) {
  double *ends = calloc((size_t)(2 * pixels), sizeof *ends), square = 0;
  must(ends != NULL, "no memory");
  for (int k = 0; k < 3; k++)
    square += (camera->target[k] - camera->eye[k]) * (camera->target[k] - camera->eye[k]);
  for (int64_t i = 0; i < 2 * pixels; i++)
    ends[i] = sqrt(square) + (i < pixels ? -0.1 : 0.1);
  return ends;
}

/* Measures a picture of one feature, once more. `ends`: those of middle_of_rays(). */
static void measure_feature(const Job *job, Tet *tet, Feature *feature, TetcastField *const fields[3],
                            const double *ends) {
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  const int64_t pixels = (int64_t)job->options->pixels * job->options->pixels;
  const TetcastArray from = {ends, TETCAST_TYPE_FLOAT64, pixels, 0},
                     to = {ends + pixels, TETCAST_TYPE_FLOAT64, pixels, 0};
  must(tetcast_scene_set_field(tet->scene, fields[feature->values]) == TETCAST_OK, "set field");
  if (feature->rows > 0)
    set_rows(tet, feature);
  else
    tet_transfer(tet, feature->transfer);
  set_light(tet, feature);
  set_isosurfaces(tet, feature->isosurfaces);
  must(tetcast_scene_set_blend(tet->scene, feature->blend) == TETCAST_OK, "set blend");
  must(tetcast_scene_set_clip(tet->scene, &oblique, feature->planes) == TETCAST_OK, "set clip");
  set_lines(tet, feature->edges);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.samples = feature->samples > 0 ? feature->samples : 1;
  desc.adaptive_epsilon = feature->adaptive;
  desc.adaptive_coarse = feature->adaptive > 0 ? 4 : 0;
  desc.start = feature->part ? &from : NULL;
  desc.stop = feature->part ? &to : NULL;
  const TetcastType type = feature->type ? feature->type : TETCAST_TYPE_FLOAT64;
  TetcastFrame *frame = tet_frame(tet, job->options->pixels, type, feature->channels);
  tet_render(tet, &camera, NULL, frame, NULL);
  times_add(&feature->times, measure_frame(job, tet, &camera, &desc, frame, &feature->stats));
  tetcast_frame_destroy(&frame);
}

void job_features(const Job *job) {
  Transfer colors = transfer_linear, knots = transfer_soft, clear = transfer_linear;
  for (int i = 0; i < clear.opacity_count; i++)
    clear.opacity[i][1] = 0;
  colors.color_count = transfer_soft.color_count;
  knots.color_count = 1;
  for (int i = 0; i < transfer_soft.color_count; i++) {
    for (int k = 0; k < 4; k++) {
      colors.color[i][k] = transfer_soft.color[i][k];
    }
  }
  Feature features[] = {
      {.name = "one piece and one colour", .transfer = &transfer_linear},
      {.name = "colours with knots", .transfer = &colors},
      {.name = "extinction with knots", .transfer = &knots},
      {.name = "both with knots", .transfer = &transfer_soft},
      {.name = "field of cells", .transfer = &transfer_linear, .values = 1},
      {.name = "field the same everywhere", .transfer = &transfer_linear, .values = 2},
      {.name = "channel of error bounds", .transfer = &transfer_linear, .channels = TETCAST_CHANNEL_ERROR},
      {.name = "frame of float", .transfer = &transfer_linear, .type = TETCAST_TYPE_FLOAT32},
      {.name = "4 samples a pixel", .transfer = &transfer_linear, .samples = 4},
      {.name = "maximum", .transfer = &transfer_linear, .blend = TETCAST_BLEND_MAXIMUM},
      {.name = "average", .transfer = &transfer_linear, .blend = TETCAST_BLEND_AVERAGE},
      {.name = "additive", .transfer = &transfer_linear, .blend = TETCAST_BLEND_ADDITIVE},
      {.name = "clip by a plane through the middle", .transfer = &transfer_linear, .planes = 1},
      {.name = "both with knots and a clip", .transfer = &transfer_soft, .planes = 1},
      {.name = "a mesh of what this clip leaves", .transfer = &transfer_linear, .left = true},
      {.name = "both with knots in a mesh of what this clip leaves", .transfer = &transfer_soft, .left = true},
      {.name = "3 opaque lit isosurfaces alone", .transfer = &clear, .isosurfaces = 3},
      {.name = "3 lit isosurfaces in the volume", .transfer = &transfer_linear, .isosurfaces = -3},
      {.name = "one piece and two colours", .transfer = &transfer_blend},
      {.name = "light in the volume", .transfer = &transfer_blend, .shade = TETCAST_SHADE_ALL},
      {.name = "light in the volume and knots", .transfer = &transfer_soft, .shade = TETCAST_SHADE_ALL},
      {.name = "light in the volume with shadows",
       .transfer = &transfer_blend,
       .shade = TETCAST_SHADE_ALL,
       .shadows = true},
      {.name = "two dimensions of 4 rows", .transfer = &transfer_blend, .rows = 4},
      {.name = "two dimensions of 4 rows with knots", .transfer = &transfer_soft, .rows = 4},
      {.name = "adaptive to 0.01 from 4th pixels on", .transfer = &transfer_linear, .adaptive = 0.01},
      {.name = "a part of each ray", .transfer = &transfer_linear, .part = true},
      {.name = "boundary", .transfer = &clear, .edges = 2},
      {.name = "boundary with edges", .transfer = &clear, .edges = 1},
      {.name = "channel of depth", .transfer = &transfer_linear, .channels = TETCAST_CHANNEL_DEPTH},
      {.name = "channel of normals", .transfer = &transfer_linear, .channels = TETCAST_CHANNEL_NORMAL},
      {.name = "channel of cells", .transfer = &transfer_linear, .channels = TETCAST_CHANNEL_CELLS},
  };
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  Tet tet, of_left;
  BenchMesh left;
  mesh_left(job->mesh, &left);
  tet_open(&tet, job->mesh, 1);
  tet_prepare(&tet);
  tet_open(&of_left, &left, 1);
  tet_prepare(&of_left);
  const int64_t most =
      job->mesh->cell_count > job->mesh->vertex_count ? job->mesh->cell_count : job->mesh->vertex_count;
  double *memory = calloc((size_t)most, sizeof *memory);
  must(memory != NULL, "no memory");
  TetcastField *fields[3];
  for (int i = 0; i < 3; i++) {
    fields[i] = make_field(&tet, job->mesh, i, memory);
  }
  free(memory);
  TetcastField *const left_fields[3] = {of_left.field, NULL, NULL};
  double *ends = middle_of_rays(&camera, (int64_t)job->options->pixels * job->options->pixels);
  const int count = sizeof features / sizeof *features;
  for (int round = 0; round < job->scene->rounds; round++) {
    for (int i = 0; i < count; i++) {
      if (features[i].left)
        measure_feature(job, &of_left, &features[i], left_fields, ends);
      else
        measure_feature(job, &tet, &features[i], fields, ends);
    }
  }
  Row row = job->row;
  row.task = "feature";
  row.renderer = "tetcast exact";
  row.threads = 1;
  row.pixels = job->options->pixels;
  for (int i = 0; i < count; i++) {
    row.what = features[i].name;
    row.isa = features[i].stats.isa;
    row.precision = features[i].stats.precision;
    row.times = &features[i].times;
    row.crossed = features[i].stats.segments;
    row_write(&row);
  }
  free(ends);
  for (int i = 0; i < 3; i++) {
    tetcast_field_destroy(&fields[i]);
  }
  tet_close(&tet);
  tet_close(&of_left);
  bench_mesh_release(&left);
}
