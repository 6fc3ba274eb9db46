/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes whose cells bring their own points, a few units in the last place apart, are those whose cells share them: no
 * gap, no layer seen twice, in either precision; values that jump from cell to cell stay each cell's own; cells that
 * are thin by themselves stay as they are. */
#include "support.h"

enum { W = 61, H = 47, CELLS = 5 };

/* The cube's cells, each with four points of its own, moved by up to `units` last places of the largest coordinate. */
typedef struct Torn {
  int64_t count; /* of points: four for each cell */
  double *vertices, *values, *jumping;
  float *rounded; /* the vertices in single precision */
  int64_t *cells;
} Torn;

static Torn torn_of(const Cube *cube, double offset, int units, bool single) {
  uint64_t seed = 11;
  Torn torn = {.count = 4 * cube->cell_count};
  torn.vertices = malloc((size_t)torn.count * 3 * sizeof *torn.vertices);
  torn.rounded = malloc((size_t)torn.count * 3 * sizeof *torn.rounded);
  torn.values = malloc((size_t)torn.count * sizeof *torn.values);
  torn.jumping = malloc((size_t)torn.count * sizeof *torn.jumping);
  torn.cells = malloc((size_t)torn.count * sizeof *torn.cells);
  const double unit =
      ldexp(single ? 0x1p-24 : 0x1p-53, ilogb(offset + 1) + 1); /* ulps of numbers just below the next power of two */
  for (int64_t i = 0; i < torn.count; ++i) {
    torn.cells[i] = i;
    torn.values[i] = cube->values[cube->cells[i]];
    torn.jumping[i] = torn.values[i] + 0.2 * ((double)(i / 4 % 7) / 7 - 0.5);
    for (int k = 0; k < 3; ++k) {
      double x = cube->vertices[3 * cube->cells[i] + k] + offset;
      if (single)
        x = (double)(float)x;
      x += unit * floor((units + 1) * uniform(&seed));
      torn.vertices[3 * i + k] = x;
      torn.rounded[3 * i + k] = (float)x;
    }
  }
  return torn;
}

static void torn_destroy(Torn *torn) {
  free(torn->vertices);
  free(torn->rounded);
  free(torn->values);
  free(torn->jumping);
  free(torn->cells);
}

static TetcastVolume *torn_volume(TetcastContext *context, const Torn *torn, TetcastTraversal traversal, bool single) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = single ? (TetcastArray){torn->rounded, TETCAST_TYPE_FLOAT32, torn->count, 0}
                         : (TetcastArray){torn->vertices, TETCAST_TYPE_FLOAT64, torn->count, 0};
  desc.tetrahedra = (TetcastArray){torn->cells, TETCAST_TYPE_INT64, torn->count / 4, 0};
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(context, &desc, &mesh), TETCAST_OK);
  TetcastVolume *volume = volume_of(context, mesh, traversal);
  tetcast_mesh_destroy(&mesh);
  return volume;
}

/* The whole cube with its field of points, moved by the offset. */
static Body whole_body(TetcastContext *context, const Cube *cube, double offset, bool single) {
  Cube moved = *cube;
  moved.vertices = malloc((size_t)cube->vertex_count * 3 * sizeof *moved.vertices);
  for (int64_t i = 0; i < 3 * cube->vertex_count; ++i) {
    moved.vertices[i] = cube->vertices[i] + offset;
    if (single)
      moved.vertices[i] = (double)(float)moved.vertices[i];
  }
  const Body body = cube_body(context, &moved, TETCAST_TRAVERSAL_SHELL);
  free(moved.vertices);
  return body;
}

static void cells_meet(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  for (int i = 0; i < 32; ++i) {
    const bool single = i & 1, regular = i & 2, faces = i & 4;
    const double offset = i & 8 ? 1000 : 0;
    const int units = i & 16 ? 3 : 0;
    Cube cube = cube_create(CELLS, regular ? 0 : 0.5);
    Torn torn = torn_of(&cube, offset, units, single);
    Body whole = whole_body(fixture.context, &cube, offset, single);
    Body body = {torn_volume(fixture.context, &torn, faces ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, single),
                 field_of(fixture.context, torn.values, torn.count, TETCAST_POINT)};
    TetcastVolumeInfo info, whole_info;
    tetcast_volume_info(body.volume, &info);
    tetcast_volume_info(whole.volume, &whole_info);
    assert_int_equal(info.welded, torn.count - cube.vertex_count);
    assert_int_equal(whole_info.welded, 0);
    if (!faces)
      assert_int_equal(info.shell_faces, whole_info.shell_faces);
    TetcastTransferFunction *transfer = gray_of(fixture.context, 2);
    /* Along an axis, where the regular cube's rays run in faces and edges, and from the side. */
    for (int view = 0; view < 2; ++view) {
      TetcastCamera camera =
          view ? camera_of(offset + 2.1, offset + 1.7, offset + 3.3, offset + 0.5, offset + 0.5, offset + 0.5)
               : camera_of(offset + 0.5, offset + 0.5, offset + 3, offset + 0.5, offset + 0.5, offset + 0.5);
      camera.projection = view ? TETCAST_PERSPECTIVE : TETCAST_ORTHOGRAPHIC;
      camera.height = 1.2;
      double *wanted = picture(fixture.context, &whole, transfer, &camera, W, H, NULL);
      double *pixels = picture(fixture.context, &body, transfer, &camera, W, H, NULL);
      /* Points are up to three units from where the whole cube has them; rays may pass its outer edges on another side.
       */
      const double least = (single ? 1e-6 : 1e-14) * (1 + offset);
      int off = 0;
      for (int p = 0; p < W * H; ++p)
        off += !(fabs(pixels[4 * p + 3] - wanted[4 * p + 3]) <= 20 * least);
      if (off > 0)
        fail_msg("case %d, view %d: %d pixels differ", i, view, off);
      free(pixels);
      free(wanted);
    }
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&body);
    body_destroy(&whole);
    torn_destroy(&torn);
    cube_destroy(&cube);
  }
  fixture_end(&fixture);
}

/* A field that jumps is what a field of corners is. */
static void values_jump(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(CELLS, 0.5);
  TetcastMesh *mesh = cube_mesh(fixture.context, &cube);
  TetcastVolumeDesc desc = tetcast_volume_desc_default();
  desc.corners = 1;
  for (int units = 0; units < 4; units += 3) {
    Torn torn = torn_of(&cube, 0, units, false);
    torn.jumping[77] = NAN;
    Body body = {torn_volume(fixture.context, &torn, TETCAST_TRAVERSAL_SHELL, false),
                 field_of(fixture.context, torn.jumping, torn.count, TETCAST_POINT)};
    Body corners = {NULL, field_of(fixture.context, torn.jumping, torn.count, TETCAST_CORNER)};
    assert_int_equal(tetcast_volume_create(fixture.context, mesh, &desc, &corners.volume), TETCAST_OK);
    TetcastTransferFunction *transfer = transfer_of(fixture.context, 1);
    const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    double *wanted = picture(fixture.context, &corners, transfer, &camera, W, H, NULL);
    double *pixels = picture(fixture.context, &body, transfer, &camera, W, H, NULL);
    for (int p = 0; p < 4 * W * H; ++p)
      assert_true(fabs(pixels[p] - wanted[p]) <= 1e-11);
    /* It does jump: the picture is another one than that without. */
    Body smooth = {corners.volume, field_of(fixture.context, torn.values, torn.count, TETCAST_CORNER)};
    double *other = picture(fixture.context, &smooth, transfer, &camera, W, H, NULL);
    assert_true(largest_difference(other, pixels, 4 * W * H) > 1e-3);
    free(other);
    tetcast_field_destroy(&smooth.field);
    /* Coefficients can't, and say so. */
    TetcastScene *scene = NULL;
    assert_int_equal(tetcast_scene_create(fixture.context, body.volume, &scene), TETCAST_OK);
    TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
    coefficients.emission = (const TetcastField *const *)&body.field;
    coefficients.emission_count = 1;
    assert_int_equal(tetcast_scene_set_coefficients(scene, &coefficients), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(fixture.message, "at one place"));
    tetcast_scene_destroy(&scene);
    free(pixels);
    free(wanted);
    tetcast_transfer_function_destroy(&transfer);
    body_destroy(&corners);
    body_destroy(&body);
    torn_destroy(&torn);
  }
  tetcast_mesh_destroy(&mesh);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Vertices of one cell stay two, however near. */
static void thin_cells_stay(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  const double up = nextafter(0.7, 1),
               vertices[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 0.7}, {0.1, 0.1, up}};
  const int64_t cells[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT64, 5, 0};
  desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT64, 2, 0};
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_OK);
  TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
  TetcastVolumeInfo info;
  tetcast_volume_info(volume, &info);
  assert_int_equal(info.welded, 0);
  assert_int_equal(info.tetrahedra, 2);
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

/* Cells that are four units in the last place wide by themselves: none of their vertices is another one. */
static void small_cells_stay(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  Cube cube = cube_create(4, 0);
  float *vertices = malloc((size_t)cube.vertex_count * 3 * sizeof *vertices);
  for (uint64_t seed = 1, end = seed + 8; seed < end; ++seed) {
    uint64_t random = seed;
    for (int64_t i = 0; i < 3 * cube.vertex_count; ++i) /* where the unit in the last place is 1/16 */
      vertices[i] = (float)(1e6 + cube.vertices[i] + 0.2 * (uniform(&random) - 0.5));
    TetcastMeshDesc desc = tetcast_mesh_desc_default();
    desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT32, cube.vertex_count, 0};
    desc.tetrahedra = (TetcastArray){cube.cells, TETCAST_TYPE_INT64, cube.cell_count, 0};
    TetcastMesh *mesh = NULL;
    assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_OK);
    TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
    TetcastVolumeInfo info;
    tetcast_volume_info(volume, &info);
    assert_int_equal(info.welded, 0);
    tetcast_volume_destroy(&volume);
    tetcast_mesh_destroy(&mesh);
  }
  free(vertices);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Cells of any vertices, some of them twice, many vertices at few places: whatever is welded, all that has an inside is
 * there. */
static void any_cells(void **state) {
  (void)state;
  uint64_t seed = 5;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  for (int round = 0; round < 400; ++round) {
    enum { VERTICES = 24, SOME = 40 };
    double vertices[VERTICES][3];
    int64_t cells[SOME][4];
    for (int i = 0; i < VERTICES; ++i) {
      for (int k = 0; k < 3; ++k)
        vertices[i][k] = floor(3 * uniform(&seed)) / 2;
    }
    for (int i = 0; i < SOME; ++i) {
      for (int k = 0; k < 4; ++k)
        cells[i][k] = i ? (int64_t)(uniform(&seed) * VERTICES) : k;
    }
    TetcastMeshDesc desc = tetcast_mesh_desc_default();
    desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT64, VERTICES, 0};
    desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT64, SOME, 0};
    TetcastMesh *mesh = NULL;
    assert_int_equal(tetcast_mesh_create(fixture.context, &desc, &mesh), TETCAST_OK);
    TetcastVolume *volume = volume_of(fixture.context, mesh, TETCAST_TRAVERSAL_SHELL);
    TetcastVolumeInfo info;
    tetcast_volume_info(volume, &info);
    int whole = 0; /* cells of four vertices, of which duplicates may be left out */
    for (int i = 0; i < SOME; ++i) {
      bool twice = false;
      for (int k = 1; k < 4; ++k) {
        for (int j = 0; j < k; ++j)
          twice = twice || cells[i][j] == cells[i][k];
      }
      whole += !twice;
    }
    assert_true(info.tetrahedra <= whole && info.tetrahedra >= 1 && info.welded < VERTICES);
    tetcast_volume_destroy(&volume);
    tetcast_mesh_destroy(&mesh);
  }
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cells_meet), cmocka_unit_test(values_jump),
                                     cmocka_unit_test(thin_cells_stay), cmocka_unit_test(small_cells_stay),
                                     cmocka_unit_test(any_cells)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
