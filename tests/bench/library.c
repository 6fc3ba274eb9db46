/* SPDX-License-Identifier: Apache-2.0 */
#include "library.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_GROUPS = 8 };

/* ISO C has no conversion of a symbol's address to a function's; POSIX says that both are represented alike. */
static bool find(const Library *library, const char *name, void *function) {
  void *symbol = dlsym(library->handle, name);
  memcpy(function, &symbol, sizeof symbol);
  return symbol != NULL;
}

static void find_or_end(const Library *library, const char *name, void *function) {
  if (!find(library, name, function)) {
    fprintf(stderr, "tetcast_bench: %s has no %s\n", library->path, name);
    exit(1);
  }
}

void library_open(Library *library, const char *path) {
  *library = (Library){.path = path, .handle = dlopen(path, RTLD_NOW | RTLD_LOCAL)};
  if (!library->handle) {
    fprintf(stderr, "tetcast_bench: %s\n", dlerror());
    exit(1);
  }
#define LIBRARY_FIND(name) find_or_end(library, "tetcast_" #name, &library->name);
  LIBRARY_FUNCTIONS(LIBRARY_FIND)
#undef LIBRARY_FIND
  if (!find(library, "tetcast_scene_set_field", &library->scene_set_field)) {
    find_or_end(library, "tetcast_volume_set_field", &library->volume_set_field);
  }
}

static void must_be_ok(const Stage *stage, TetcastStatus status, const char *what) {
  if (status != TETCAST_OK) {
    fprintf(stderr, "tetcast_bench: %s: %s failed\n", stage->api->path, what);
    exit(1);
  }
}

/* ── a mesh ── */

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  const Stage *stage = user;
  (void)severity;
  if (!stage->quiet) {
    fprintf(stderr, "tetcast_bench: %s: %s\n", stage->api->path, text);
  }
}

static TetcastField *make_field(const Stage *stage, const void *values, TetcastType type) {
  const Library *library = stage->api;
  TetcastFieldDesc desc = library->field_desc_default();
  desc.values = (TetcastArray){.data = values, .type = type, .count = stage->mesh->vertex_count};
  TetcastField *field = NULL;
  must_be_ok(stage, library->field_create(stage->context, &desc, &field), "field_create");
  return field;
}

void stage_open(Stage *stage, const Library *library, const BenchMesh *mesh) {
  *stage = (Stage){.api = library, .mesh = mesh};
  TetcastContextDesc context = library->context_desc_default();
  context.threads = 1;
  context.message = print_message;
  context.message_user = stage;
  must_be_ok(stage, library->context_create(&context, &stage->context), "context_create");
  TetcastMeshDesc desc = library->mesh_desc_default();
  desc.vertices = (TetcastArray){.data = mesh->vertices, .type = mesh->type, .count = mesh->vertex_count};
  desc.tetrahedra = (TetcastArray){.data = mesh->cells, .type = TETCAST_TYPE_INT32, .count = mesh->cell_count};
  desc.ownership = TETCAST_BORROW;
  must_be_ok(stage, library->mesh_create(stage->context, &desc, &stage->tet), "mesh_create");
  must_be_ok(stage, library->volume_create(stage->context, stage->tet, NULL, &stage->volume), "volume_create");
  stage->field = make_field(stage, mesh->scalars, mesh->type);
  if (library->volume_set_field) {
    must_be_ok(stage, library->volume_set_field(stage->volume, stage->field), "volume_set_field");
  }
}

void stage_close(Stage *stage) {
  const Library *library = stage->api;
  library->volume_destroy(&stage->volume);
  library->field_destroy(&stage->field);
  library->mesh_destroy(&stage->tet);
  library->context_destroy(&stage->context);
}

/* ── a picture ── */

static TetcastFrame *make_frame(const Stage *stage, int pixels, int groups) {
  TetcastFrameDesc desc = stage->api->frame_desc_default();
  desc.width = desc.height = pixels;
  desc.type = TETCAST_TYPE_FLOAT64;
  if (groups > 0) {
    desc.channels = TETCAST_CHANNEL_RADIANCE;
    desc.groups = groups;
  }
  TetcastFrame *frame = NULL;
  must_be_ok(stage, stage->api->frame_create(stage->context, &desc, &frame), "frame_create");
  return frame;
}

static void begin(Picture *picture, Stage *stage, int pixels, int groups) {
  const Library *library = stage->api;
  *picture = (Picture){.stage = stage, .pixels = pixels, .groups = groups, .desc = library->render_desc_default()};
  must_be_ok(stage, library->scene_create(stage->context, stage->volume, &picture->scene), "scene_create");
  picture->frame = make_frame(stage, pixels, groups);
}

void picture_open_transfer(Picture *picture, Stage *stage, const Transfer *transfer, int pixels) {
  const Library *library = stage->api;
  begin(picture, stage, pixels, 0);
  if (library->scene_set_field) {
    must_be_ok(stage, library->scene_set_field(picture->scene, stage->field), "scene_set_field");
  }
  TetcastTransferFunctionDesc desc = library->transfer_function_desc_default();
  transfer_fill(&desc, transfer);
  TetcastTransferFunction *function = NULL;
  must_be_ok(stage, library->transfer_function_create(stage->context, &desc, &function), "transfer_function_create");
  must_be_ok(stage, library->scene_set_transfer_function(picture->scene, function), "scene_set_transfer_function");
  library->transfer_function_destroy(&function);
}

/* Extinction of a group as transfer_linear has it, and somewhat more of it in each further one; an emission that dims
 * what has more. */
static void fill_group(const BenchMesh *mesh, int group, double *extinction, double *emission) {
  for (int64_t i = 0; i < mesh->vertex_count; i++) {
    const double s = bench_mesh_scalar(mesh, i);
    extinction[i] = (1 + group / 8.) * (s + 1) / 3 / transfer_linear.unit_distance;
    emission[i] = (1 - group / 16.) * (1.5 - s);
  }
}

void picture_open_groups(Picture *picture, Stage *stage, int groups, int pixels) {
  const Library *library = stage->api;
  begin(picture, stage, pixels, groups);
  must(groups <= MOST_GROUPS, "too many groups");
  const size_t count = (size_t)stage->mesh->vertex_count;
  double *values = calloc(2 * count * (size_t)groups, sizeof *values);
  must(values != NULL, "no memory for coefficients");
  TetcastField *fields[2][MOST_GROUPS];
  for (int g = 0; g < groups; g++) {
    double *extinction = values + 2 * count * (size_t)g, *emission = extinction + count;
    fill_group(stage->mesh, g, extinction, emission);
    fields[0][g] = make_field(stage, extinction, TETCAST_TYPE_FLOAT64);
    fields[1][g] = make_field(stage, emission, TETCAST_TYPE_FLOAT64);
  }
  TetcastCoefficientsDesc desc = library->coefficients_desc_default();
  desc.extinction = (const TetcastField *const *)fields[0];
  desc.emission = (const TetcastField *const *)fields[1];
  desc.extinction_count = desc.emission_count = groups;
  must_be_ok(stage, library->scene_set_coefficients(picture->scene, &desc), "scene_set_coefficients");
  for (int g = 0; g < groups; g++) {
    library->field_destroy(&fields[0][g]);
    library->field_destroy(&fields[1][g]);
  }
  free(values);
}

void picture_close(Picture *picture) {
  const Library *library = picture->stage->api;
  library->frame_destroy(&picture->frame);
  library->scene_destroy(&picture->scene);
}

/* The numbers in TetcastIsa have changed and are asked for: each draws a pixel, and stats say by what. */
bool picture_use(Picture *picture, const char *isa) {
  enum { MOST = 8 };
  const TetcastCamera camera = scene_camera(TETCAST_ORTHOGRAPHIC);
  Stage *stage = picture->stage;
  const Library *library = stage->api;
  TetcastFrame *frame = make_frame(stage, 1, picture->groups);
  bool found = false;
  stage->quiet = true; /* of the first number that is none */
  for (int i = 1; i <= MOST && !found; i++) {
    TetcastRenderStats stats;
    picture->desc.isa = (TetcastIsa)i;
    if (library->scene_render(picture->scene, &camera, &picture->desc, frame, &stats) != TETCAST_OK) {
      break;
    }
    found = strcmp(stats.isa, isa) == 0;
  }
  stage->quiet = false;
  library->frame_destroy(&frame);
  return found;
}

double picture_draw(Picture *picture, const TetcastCamera *camera) {
  const Library *library = picture->stage->api;
  const Clock start = clock_now();
  TetcastStatus status = library->scene_render(picture->scene, camera, &picture->desc, picture->frame, &picture->stats);
  const double cpu = clock_since(start).cpu;
  must_be_ok(picture->stage, status, "scene_render");
  must(picture->stats.lost == 0, "tetcast lost a ray");
  return cpu;
}

/* Numbers alike, NaN being like NaN alone. */
static double difference(const double *a, const double *b, size_t count) {
  double largest = 0;
  for (size_t i = 0; i < count && !isnan(largest); i++) {
    const double d = a[i] == b[i] || (isnan(a[i]) && isnan(b[i])) ? 0 : fabs(a[i] - b[i]);
    largest = d <= largest ? largest : d; /* a NaN is kept */
  }
  return largest;
}

double picture_difference(const Picture *a, const Picture *b) {
  const Library *of_a = a->stage->api, *of_b = b->stage->api;
  const size_t count = (size_t)a->pixels * (size_t)a->pixels;
  double largest = difference(of_a->frame_pixels(a->frame), of_b->frame_pixels(b->frame), 4 * count);
  if (a->groups > 0 && !isnan(largest)) {
    const double channel =
        difference(of_a->frame_channel(a->frame, TETCAST_CHANNEL_RADIANCE),
                   of_b->frame_channel(b->frame, TETCAST_CHANNEL_RADIANCE), count * (size_t)a->groups);
    largest = channel <= largest ? largest : channel;
  }
  return largest;
}

double picture_per_segment(const Picture *picture) {
  return 1e9 * sample_median(&picture->cpu) / (double)picture->stats.segments;
}
