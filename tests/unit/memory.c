/* SPDX-License-Identifier: Apache-2.0 */
/* Every allocation of the library made to fail in turn, in every public call that allocates: the call reports it, leaks
 * nothing, leaves what there was as it was, and does its work when it is made again. */
#include "support.h"

enum { W = 16, H = 12 };

/* One run through a scenario, of whose allocations one fails. */
typedef struct Run {
  Fixture fixture;
  bool failed;  /* a call has reported it */
  uint64_t sum; /* of all results */
} Run;

static void note(Run *run, const void *data, size_t bytes) {
  const unsigned char *byte = data;
  for (size_t i = 0; i < bytes; ++i)
    run->sum = (run->sum ^ byte[i]) * UINT64_C(1099511628211);
}

/* After a call with this status: whether it has to be made again. */
static bool again(Run *run, TetcastStatus status, const char *call) {
  Fixture *fixture = &run->fixture;
  if (!status)
    return false;
  if (status != TETCAST_ERROR_MEMORY || !strstr(fixture->message, "out of memory") || fixture->fail_at == 0 ||
      fixture->allocations < fixture->fail_at) {
    fail_msg("%s: status %d, \"%s\" at allocation %ld of which number %ld fails", call, (int)status, fixture->message,
             fixture->allocations, fixture->fail_at);
  }
  run->failed = true;
  fixture->fail_at = 0;
  return true;
}

/* Makes the call, which stores something in `out` or NULL; if memory fails, again. */
#define MAKE(run, out, call)                                                                                           \
  do {                                                                                                                 \
    const long live = (run)->fixture.live;                                                                             \
    const TetcastStatus first = (call);                                                                                \
    if (again(run, first, #call)) {                                                                                    \
      assert_null(out);                                                                                                \
      assert_int_equal((run)->fixture.live, live);                                                                     \
      assert_int_equal((call), TETCAST_OK);                                                                            \
    }                                                                                                                  \
  } while (0)
/* The same where the result goes into what there is. */
#define CALL(run, call)                                                                                                \
  do {                                                                                                                 \
    const TetcastStatus first = (call);                                                                                \
    if (again(run, first, #call))                                                                                      \
      assert_int_equal((call), TETCAST_OK);                                                                            \
  } while (0)

/* ── cells ── */

/* Curved cells, so that there are added vertices before the counting, and polyhedra with two faces in a plane, each of
 * which gets a vertex. */
typedef struct Cells {
  double vertices[2000][3];
  int64_t connectivity[2000], offsets[200], faces[8000], face_offsets[200];
  uint8_t types[200];
  int64_t vertex_count, node_count, cell_count, face_count;
} Cells;

static void add_vertex(Cells *cells, double x, double y, double z) {
  double *p = cells->vertices[cells->vertex_count];
  p[0] = x, p[1] = y, p[2] = z;
  cells->connectivity[cells->node_count++] = cells->vertex_count++;
}

static void end_cell(Cells *cells, TetcastCellType type) {
  cells->types[cells->cell_count++] = (uint8_t)type;
  cells->offsets[cells->cell_count] = cells->node_count;
}

static void make_cells(Cells *cells, int curved, int polyhedra) {
  static const double corner[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  static const int edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  static const int box[] = {7, 3, 0, 3, 1, 3, 3, 2, 1, 4, 4, 5, 6, 7, 4, 0, 1,
                            5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7};
  memset(cells, 0, sizeof *cells);
  for (int i = 0; i < curved; ++i) {
    const double x = -3.0 * i - 3;
    for (int k = 0; k < 4; ++k)
      add_vertex(cells, x + corner[k][0], corner[k][1], corner[k][2]);
    for (int e = 0; e < 6; ++e) {
      const double *a = corner[edge[e][0]], *b = corner[edge[e][1]];
      add_vertex(cells, x + 0.5 * a[0] + 0.5 * b[0], 0.5 * a[1] + 0.5 * b[1], 0.5 * a[2] + 0.5 * b[2]);
    }
    end_cell(cells, TETCAST_CELL_QUADRATIC_TETRAHEDRON);
  }
  for (int i = 0; i < polyhedra; ++i) {
    const int64_t first = cells->vertex_count;
    static const double at[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (int k = 0; k < 8; ++k)
      add_vertex(cells, 2.0 * i + at[k][0], at[k][1], at[k][2]);
    cells->face_offsets[cells->cell_count] = cells->face_count;
    cells->faces[cells->face_count++] = box[0];
    for (size_t k = 1; k < sizeof box / sizeof *box;) {
      const int corners = box[k++];
      cells->faces[cells->face_count++] = corners;
      for (int c = 0; c < corners; ++c)
        cells->faces[cells->face_count++] = first + box[k++];
    }
    end_cell(cells, TETCAST_CELL_POLYHEDRON);
  }
}

static void cut_cells(Run *run, int curved, int polyhedra, bool sources) {
  Cells *cells = malloc(sizeof *cells);
  make_cells(cells, curved, polyhedra);
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){cells->vertices, TETCAST_TYPE_FLOAT64, cells->vertex_count, 0};
  desc.types = cells->types;
  desc.offsets = (TetcastArray){cells->offsets, TETCAST_TYPE_INT64, cells->cell_count + 1, 0};
  desc.connectivity = (TetcastArray){cells->connectivity, TETCAST_TYPE_INT64, cells->node_count, 0};
  desc.faces = (TetcastArray){cells->faces, TETCAST_TYPE_INT64, cells->face_count, 0};
  desc.face_offsets = (TetcastArray){cells->face_offsets, TETCAST_TYPE_INT64, cells->cell_count, 0};
  desc.subdivision = 3;
  desc.sources = sources;
  TetcastCut *cut = (TetcastCut *)&desc;
  MAKE(run, cut, tetcast_cells_cut(run->fixture.context, &desc, &cut));
  TetcastCutInfo info;
  tetcast_cut_info(cut, &info);
  note(run, &info, sizeof info);
  const TetcastArray tetrahedra = tetcast_cut_tetrahedra(cut);
  note(run, tetrahedra.data, (size_t)tetrahedra.count * 4 * sizeof(int32_t));
  double *added = malloc((size_t)(3 * info.added_vertices + 1) * sizeof *added);
  assert_true(tetcast_cut_interpolate(cut, &desc.vertices, 3, added));
  note(run, added, (size_t)(3 * info.added_vertices) * sizeof *added);
  free(added);
  tetcast_cut_destroy(&cut);
  free(cells);
}

static void curved_and_polyhedra(Run *run) {
  cut_cells(run, 1, 150, true);
}
static void polyhedra_alone(Run *run) {
  cut_cells(run, 0, 60, false);
}
static void curved_alone(Run *run) {
  cut_cells(run, 60, 0, true);
}

/* ── pictures ── */

typedef struct Kind {
  TetcastTraversal traversal;
  TetcastAssociation association;
  TetcastOwnership ownership;
  TetcastIntegrator integrator;
  double tolerance;
  bool preset, narrow, coefficients, health, replaced, statistics, lit, rows;
} Kind;

static void narrow_transfer(Run *run, TetcastTransferFunction **transfer, bool narrow) {
  static const double color[][4] = {{0, 1, 0, 0}, {0.5, 0, 1, 0}, {1, 0, 0, 1}},
                      extinction[2][2][2] = {{{0.1, 0}, {1, 5}}, {{0.93, 0}, {0.97, 5}}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.color_count = 3;
  desc.extinction = extinction[narrow][0];
  desc.extinction_count = 2;
  MAKE(run, *transfer, tetcast_transfer_function_create(run->fixture.context, &desc, transfer));
}

static void set_coefficients(Run *run, TetcastScene *scene, const TetcastField *field) {
  const TetcastField *fields[3] = {field, field, field};
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = desc.emission = fields;
  desc.extinction_count = desc.emission_count = 3;
  CALL(run, tetcast_scene_set_coefficients(scene, &desc));
}

/* Of the field on its mesh. */
static void find_statistics(Run *run, const TetcastMesh *mesh, const TetcastField *field) {
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  desc.gradient_bins = 4;
  TetcastStatistics *statistics = (TetcastStatistics *)&desc;
  static const double shares[] = {0.25, 0.5};
  double values[2];
  MAKE(run, statistics, tetcast_statistics_create(run->fixture.context, mesh, field, &desc, &statistics));
  CALL(run, tetcast_statistics_quantiles(run->fixture.context, mesh, field, shares, 2, values));
  note(run, statistics->volume, (size_t)statistics->bins * sizeof(double));
  note(run, values, sizeof values);
  tetcast_statistics_destroy(run->fixture.context, &statistics);
}

/* Light in the volume, with shadows; of a colour where there are rows. */
static void set_light(Run *run, TetcastScene *scene, const Kind *kind) {
  const TetcastLight light = {.direction = {1, 2, 3}, .color = {1, 1, kind->rows ? 0.5 : 1}};
  TetcastShadingDesc desc = tetcast_shading_desc_default();
  desc.shade = TETCAST_SHADE_ALL;
  desc.lights = &light;
  desc.light_count = desc.shadows = 1;
  desc.occlusion_rays = 3;
  CALL(run, tetcast_scene_set_shading(scene, &desc));
}

/* A transfer function, or rows with it at both. */
static void set_transfer(Run *run, TetcastScene *scene, const Kind *kind, const TetcastTransferFunction *transfer) {
  const TetcastTransferRow rows[2] = {{.at = 0.5, .transfer_function = transfer},
                                      {.at = 2, .transfer_function = transfer}};
  if (kind->rows)
    CALL(run, tetcast_scene_set_transfer_rows(scene, rows, 2, NULL));
  else
    CALL(run, tetcast_scene_set_transfer_function(scene, transfer));
}

static void render(Run *run, const Kind *kind, TetcastScene *scene) {
  TetcastContext *context = run->fixture.context;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.groups = 3;
  if (kind->coefficients)
    frame_desc.channels = TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_RADIANCE;
  else if (kind->integrator == TETCAST_INTEGRATOR_EXACT && !kind->lit && !kind->rows)
    frame_desc.channels = TETCAST_CHANNEL_ERROR;
  TetcastFrame *frame = (TetcastFrame *)&frame_desc;
  MAKE(run, frame, tetcast_frame_create(context, &frame_desc, &frame));
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.integrator = kind->integrator;
  desc.integrator_n = 4;
  desc.tolerance = kind->tolerance;
  desc.samples = kind->tolerance > 0 ? 16 : 1; /* so many that looking for the field's steepness is worth it */
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  const long live = run->fixture.live;
  const TetcastStatus status = tetcast_scene_render(scene, &camera, &desc, frame, NULL);
  if (again(run, status, "render")) {
    assert_true(run->fixture.live <= live + 20); /* what the scene keeps of its preparation */
    assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, NULL), TETCAST_OK);
  }
  note(run, tetcast_frame_pixels(frame), W * H * 4 * sizeof(double));
  tetcast_frame_destroy(&frame);
}

static void whole_picture(Run *run, const Kind *kind) {
  TetcastContext *context = run->fixture.context;
  Cube cube = cube_create(4, 0.5);
  cube.cells[0] = cube.cells[1]; /* a cell that is left out, and another */
  memcpy(&cube.cells[8], &cube.cells[12], 4 * sizeof *cube.cells);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){cube.vertices, TETCAST_TYPE_FLOAT64, cube.vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube.cells, TETCAST_TYPE_INT64, cube.cell_count, 0};
  mesh_desc.ownership = kind->ownership;
  TetcastMesh *mesh = (TetcastMesh *)&cube;
  MAKE(run, mesh, tetcast_mesh_create(context, &mesh_desc, &mesh));
  if (kind->health) {
    TetcastMeshHealth health;
    CALL(run, tetcast_mesh_health(context, mesh, &health));
    note(run, &health, sizeof health);
  }
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.traversal = kind->traversal;
  TetcastVolume *volume = (TetcastVolume *)&cube;
  MAKE(run, volume, tetcast_volume_create(context, mesh, &volume_desc, &volume));
  double *values = calloc((size_t)cube.cell_count, sizeof *values);
  const int64_t count = kind->association == TETCAST_POINT ? cube.vertex_count : cube.cell_count;
  memcpy(values, cube.values, (size_t)cube.vertex_count * sizeof *values);
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){values, TETCAST_TYPE_FLOAT64, count, 0};
  field_desc.association = kind->association;
  field_desc.ownership = kind->ownership;
  TetcastField *field = (TetcastField *)&cube;
  MAKE(run, field, tetcast_field_create(context, &field_desc, &field));
  if (kind->statistics)
    find_statistics(run, mesh, field);
  TetcastScene *scene = (TetcastScene *)&cube;
  MAKE(run, scene, tetcast_scene_create(context, volume, &scene));
  CALL(run, tetcast_scene_set_field(scene, field));
  TetcastTransferFunction *transfer = (TetcastTransferFunction *)&cube;
  if (kind->preset)
    MAKE(run, transfer, tetcast_scene_create_preset(scene, "magma", 0, 1, &transfer));
  else
    narrow_transfer(run, &transfer, kind->narrow);
  if (kind->coefficients)
    set_coefficients(run, scene, field);
  else
    set_transfer(run, scene, kind, transfer);
  if (kind->lit)
    set_light(run, scene, kind);
  render(run, kind, scene);
  if (kind->replaced) { /* the scene is prepared anew */
    CALL(run, tetcast_scene_set_field(scene, field));
    if (kind->coefficients)
      set_coefficients(run, scene, field);
    else
      set_transfer(run, scene, kind, transfer);
    render(run, kind, scene);
  }
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_field_destroy(&field);
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  free(values);
  cube_destroy(&cube);
}

static void preset(Run *run) {
  whole_picture(run, &(Kind){.preset = true, .health = true, .replaced = true});
}
static void faces(Run *run) {
  whole_picture(run, &(Kind){.traversal = TETCAST_TRAVERSAL_FACES, .ownership = TETCAST_BORROW});
}
static void visible_clusters(Run *run) {
  whole_picture(run, &(Kind){.narrow = true, .replaced = true});
}
static void cell_field(Run *run) {
  whole_picture(run, &(Kind){.association = TETCAST_CELL, .preset = true});
}
static void coefficients(Run *run) {
  whole_picture(run, &(Kind){.coefficients = true, .replaced = true});
}
static void coefficients_of_cells(Run *run) {
  whole_picture(run, &(Kind){.coefficients = true, .association = TETCAST_CELL, .traversal = TETCAST_TRAVERSAL_FACES});
}
static void single_precision(Run *run) {
  whole_picture(run, &(Kind){.tolerance = 0.05});
}
static void lit(Run *run) {
  whole_picture(run, &(Kind){.lit = true, .replaced = true, .statistics = true});
}
static void lit_rows(Run *run) {
  whole_picture(run, &(Kind){.lit = true, .rows = true, .replaced = true});
}
static void rows_of_faces(Run *run) {
  whole_picture(run, &(Kind){.rows = true, .traversal = TETCAST_TRAVERSAL_FACES});
}
static void table(Run *run) {
  whole_picture(run, &(Kind){.integrator = TETCAST_INTEGRATOR_TABLE});
}
static void gauss(Run *run) {
  whole_picture(run, &(Kind){.integrator = TETCAST_INTEGRATOR_GAUSS});
}

/* ── rays ── */

static bool note_trace(void *user, const TetcastTrace *trace) {
  note(user, trace->offsets, (size_t)trace->count * sizeof *trace->offsets);
  note(user, trace->crossings, (size_t)trace->offsets[trace->count] * sizeof *trace->crossings);
  return true;
}

/* What any rays gather, and what they cross. */
static void rays(Run *run) {
  enum { RAYS = 300 };
  TetcastContext *context = run->fixture.context;
  Cube cube = cube_create(3, 0.3);
  double lines[RAYS][6], numbers[RAYS * 7];
  uint64_t seed = 9;
  for (int i = 0; i < RAYS * 6; ++i)
    lines[i / 6][i % 6] = i % 6 < 3 ? uniform(&seed) : uniform(&seed) - 0.5;
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){cube.vertices, TETCAST_TYPE_FLOAT64, cube.vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube.cells, TETCAST_TYPE_INT64, cube.cell_count, 0};
  TetcastMesh *mesh = (TetcastMesh *)&cube;
  MAKE(run, mesh, tetcast_mesh_create(context, &mesh_desc, &mesh));
  TetcastVolume *volume = (TetcastVolume *)&cube;
  MAKE(run, volume, tetcast_volume_create(context, mesh, NULL, &volume));
  TetcastRays list = tetcast_rays_default();
  list.origins = (TetcastArray){lines[0], TETCAST_TYPE_FLOAT64, RAYS, sizeof lines[0]};
  list.directions = (TetcastArray){lines[0] + 3, TETCAST_TYPE_FLOAT64, RAYS, sizeof lines[0]};
  uint64_t before = run->sum;
  const TetcastStatus traced = tetcast_volume_trace(volume, &list, NULL, note_trace, run);
  if (again(run, traced, "tetcast_volume_trace")) {
    run->sum = before;
    assert_int_equal(tetcast_volume_trace(volume, &list, NULL, note_trace, run), TETCAST_OK);
  }
  TetcastField *field = (TetcastField *)&cube;
  TetcastFieldDesc desc = tetcast_field_desc_default();
  desc.values = (TetcastArray){cube.values, TETCAST_TYPE_FLOAT64, cube.vertex_count, 0};
  MAKE(run, field, tetcast_field_create(context, &desc, &field));
  TetcastScene *scene = (TetcastScene *)&cube;
  MAKE(run, scene, tetcast_scene_create(context, volume, &scene));
  CALL(run, tetcast_scene_set_field(scene, field));
  TetcastTransferFunction *transfer = (TetcastTransferFunction *)&cube;
  narrow_transfer(run, &transfer, false);
  CALL(run, tetcast_scene_set_transfer_function(scene, transfer));
  const TetcastCastResult result = {
      .color = numbers, .optical_depth = numbers + 4 * RAYS, .length = numbers + 5 * RAYS, .error = numbers + 6 * RAYS};
  CALL(run, tetcast_scene_cast(scene, &list, NULL, &result, NULL));
  note(run, numbers, sizeof numbers);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_field_destroy(&field);
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
}

/* ── all of them ── */

static const struct {
  const char *name;
  void (*run)(Run *run);
} scenarios[] = {
    {"curved cells and polyhedra", curved_and_polyhedra},
    {"polyhedra", polyhedra_alone},
    {"curved cells", curved_alone},
    {"preset", preset},
    {"faces", faces},
    {"visible clusters", visible_clusters},
    {"cell field", cell_field},
    {"coefficients", coefficients},
    {"coefficients of cells", coefficients_of_cells},
    {"single precision", single_precision},
    {"light in the volume", lit},
    {"light and rows", lit_rows},
    {"rows of faces", rows_of_faces},
    {"table", table},
    {"gauss", gauss},
    {"rays", rays},
};

static void any_allocation_may_fail(void **state) {
  (void)state;
  for (size_t s = 0; s < sizeof scenarios / sizeof *scenarios; ++s) {
    for (int threads = 1; threads <= (s == 0 || s == 3 ? 3 : 1); threads += 2) {
      uint64_t wanted = 0;
      long fail_at = 0, reported = 0; /* none fails the first time; that of the context itself is number 1 */
      for (;; fail_at += 1 + (fail_at == 0)) {
        Run run = {.sum = UINT64_C(1469598103934665603)};
        assert_int_equal(fixture_begin(&run.fixture, threads, fail_at), TETCAST_OK);
        scenarios[s].run(&run);
        reported += run.failed;
        const bool all = fail_at > 0 && run.fixture.allocations < fail_at;
        if (fail_at == 0)
          wanted = run.sum;
        if (run.sum != wanted)
          fail_msg("%s, %d threads: another result after allocation %ld failed", scenarios[s].name, threads, fail_at);
        fixture_end(&run.fixture); /* nothing leaks */
        if (all)
          break;
      }
      /* Done without: memory for threads, and lists that are made later when there is none now. */
      if (!(fail_at > 8 && reported >= (fail_at - 2) / 2))
        fail_msg("%s: %ld failures of %ld reported", scenarios[s].name, reported, fail_at - 2);
    }
  }
}

static void a_context_needs_memory(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 1), TETCAST_ERROR_MEMORY);
  assert_null(fixture.context);
  assert_int_equal(fixture.live, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_context_needs_memory),
                                     cmocka_unit_test(any_allocation_may_fail)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
