/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L /* mkdtemp, fileno */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <unistd.h>

#include <tetcast/tetcast.h>
#include <tetcast/tetgen.h>

/* TetGen leaks its work space when it gives up: what the leak sanitizer asks for, unused without it. */
TETCAST_API const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
  return "leak:tetgenmesh\n";
}

/* ── surfaces ── */

enum { MOST = 64 };

typedef struct Body {
  double vertices[MOST][3];
  int64_t triangles[2 * MOST][3];
  double holes[4][3];
  TetcastSurface surface;
} Body;

static TetcastSurface *surface(Body *body) {
  body->surface.vertices = body->vertices[0];
  body->surface.triangles = body->triangles[0];
  body->surface.holes = body->holes[0];
  return &body->surface;
}

static void add_box(Body *body, double low, double high) {
  static const int sides[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const int64_t first = body->surface.vertex_count;
  for (int i = 0; i < 8; i++, body->surface.vertex_count++)
    for (int j = 0; j < 3; j++)
      body->vertices[first + i][j] = i >> j & 1 ? high : low;
  for (int i = 0; i < 12; i++, body->surface.triangle_count++)
    for (int j = 0; j < 3; j++)
      body->triangles[body->surface.triangle_count][j] = first + sides[i][j];
}

static void add_hole(Body *body, double x) {
  for (int j = 0; j < 3; j++)
    body->holes[body->surface.hole_count][j] = x;
  body->surface.hole_count++;
}

/* ── what comes of them ── */

static char message[2048];
static int message_count;

static void receive(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  snprintf(message, sizeof message, "%s", text);
  message_count++;
}

static TetcastContext *context;

static int set_up(void **state) {
  (void)state;
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.message = receive;
  return tetcast_context_create(&desc, &context) == TETCAST_OK ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  tetcast_context_destroy(&context);
  return 0;
}

typedef struct Measure {
  double volume, largest, worst_ratio, mean_ratio;
  int64_t inverted;
} Measure;

static double distance(const double *a, const double *b) {
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* Cramer's rule for the centre: 2 (xᵢ − x₀) · c = |xᵢ − x₀|². */
static double determinant(double m[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static Measure measure(const TetcastMesh *mesh) {
  Measure result = {0};
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); i++) {
    int64_t corners[4];
    double x[4][3], m[3][3], c[3], shortest = HUGE_VAL;
    tetcast_mesh_tetrahedron(mesh, i, corners);
    for (int j = 0; j < 4; j++)
      tetcast_mesh_vertex(mesh, corners[j], x[j]);
    for (int j = 0; j < 4; j++)
      for (int k = 0; k < j; k++)
        shortest = fmin(shortest, distance(x[j], x[k]));
    for (int j = 0; j < 9; j++)
      m[j / 3][j % 3] = x[j / 3 + 1][j % 3] - x[0][j % 3];
    const double d = determinant(m);
    for (int k = 0; k < 3; k++) {
      double n[3][3];
      memcpy(n, m, sizeof n);
      for (int j = 0; j < 3; j++)
        n[j][k] = (m[j][0] * m[j][0] + m[j][1] * m[j][1] + m[j][2] * m[j][2]) / 2;
      c[k] = determinant(n) / d + x[0][k];
    }
    result.volume += fabs(d) / 6;
    result.largest = fmax(result.largest, fabs(d) / 6);
    result.worst_ratio = fmax(result.worst_ratio, distance(c, x[0]) / shortest);
    result.mean_ratio += distance(c, x[0]) / shortest / (double)tetcast_mesh_tetrahedron_count(mesh);
    result.inverted += d <= 0;
  }
  return result;
}

static TetcastMesh *fill(Body *body, double quality, double max_volume) {
  TetcastTetgenDesc desc = tetcast_tetgen_desc_default();
  desc.quality = quality;
  desc.max_volume = max_volume;
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_tetgen_mesh(context, surface(body), &desc, &mesh), TETCAST_OK);
  assert_non_null(mesh);
  return mesh;
}

static void refuse(Body *body, TetcastStatus status, const char *text) {
  TetcastMesh *mesh = (TetcastMesh *)&mesh;
  message_count = 0;
  assert_int_equal(tetcast_tetgen_mesh(context, surface(body), NULL, &mesh), status);
  assert_null(mesh);
  assert_int_equal(message_count, 1);
  if (!strstr(message, text))
    fail_msg("\"%s\" should contain \"%s\"", message, text);
}

/* ── tests ── */

static void test_bounds_are_kept(void **state) {
  (void)state;
  static const double settings[][2] = {{2, 0}, {1.4, 0}, {1.2, 0}, {2, 0.01}, {1.2, 0.001}, {0, 0.003}};
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
    Body body = {0};
    add_box(&body, -1, 2);
    add_box(&body, 0.2, 0.7);
    add_hole(&body, 0.5);
    TetcastMesh *mesh = fill(&body, settings[i][0], settings[i][1]);
    const Measure is = measure(mesh);
    assert_true(fabs(is.volume - (27 - 0.125)) < 1e-10);
    assert_int_equal(is.inverted, 0);
    /* TetGen warrants a ratio of 2 and more; below, it leaves a few cells at the surface as they are */
    if (settings[i][0] >= 2)
      assert_true(is.worst_ratio <= settings[i][0] * (1 + 1e-9));
    if (settings[i][0] > 0)
      assert_true(is.mean_ratio <= settings[i][0]);
    if (settings[i][1] > 0)
      assert_true(is.largest <= settings[i][1] * (1 + 1e-9));
    tetcast_mesh_destroy(&mesh);
  }
}

static void test_without_bounds_no_vertex_is_added(void **state) {
  (void)state;
  Body body = {0};
  add_box(&body, 0, 1);
  TetcastMesh *mesh = fill(&body, 0, 0);
  assert_int_equal(tetcast_mesh_vertex_count(mesh), 8);
  tetcast_mesh_destroy(&mesh);
}

static void test_cavities(void **state) {
  (void)state;
  Body body = {0};
  add_box(&body, 0, 4);
  add_box(&body, 1, 2);
  add_box(&body, 2.5, 3);
  add_hole(&body, 1.5);
  TetcastMesh *mesh = fill(&body, 1.4, 0);
  assert_true(fabs(measure(mesh).volume - 63) < 1e-9);
  tetcast_mesh_destroy(&mesh);
  add_hole(&body, 2.75);
  mesh = fill(&body, 1.4, 0);
  assert_true(fabs(measure(mesh).volume - 62.875) < 1e-9);
  TetcastMeshHealth health;
  assert_int_equal(tetcast_mesh_health(context, mesh, &health), TETCAST_OK);
  assert_int_equal(health.components, 1);
  assert_int_equal(health.degenerate_cells + health.inverted_cells, 0);
  assert_int_equal(health.nonmanifold_faces + health.unused_vertices, 0);
  assert_true(fabs(health.boundary_area - (96 + 6 + 1.5)) < 1e-9);
  tetcast_mesh_destroy(&mesh);
  add_hole(&body, 0.5); /* in the body itself */
  refuse(&body, TETCAST_ERROR_DATA, "nothing inside");
}

static void test_any_unit_of_length(void **state) {
  (void)state;
  static const double units[] = {1e-300, 1e-150, 1e-9, 1e9, 1e150, 1e300};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    Body body = {0};
    add_box(&body, -units[i], units[i]);
    TetcastMesh *mesh = fill(&body, 1.4, 0);
    for (int64_t v = 0; v < tetcast_mesh_vertex_count(mesh); v++) {
      double x[3];
      tetcast_mesh_vertex(mesh, v, x);
      for (int j = 0; j < 3; j++)
        assert_true(fabs(x[j]) <= units[i]);
    }
    tetcast_mesh_destroy(&mesh);
  }
  Body far = {0};
  add_box(&far, 1e9, 1e9 + 1);
  TetcastMesh *mesh = fill(&far, 1.4, 0.01);
  assert_true(fabs(measure(mesh).volume - 1) < 1e-6);
  tetcast_mesh_destroy(&mesh);
}

static void test_lines_and_stray_vertices_do_not_matter(void **state) {
  (void)state;
  Body body = {0};
  for (int i = 0; i < 5; i++)
    body.vertices[body.surface.vertex_count++][0] = 0.1 * i;
  add_box(&body, 0, 1);
  const int64_t line[3] = {5, 12, 5};
  memcpy(body.triangles[body.surface.triangle_count++], line, sizeof line);
  TetcastMesh *mesh = fill(&body, 0, 0);
  assert_int_equal(tetcast_mesh_vertex_count(mesh), 8);
  tetcast_mesh_destroy(&mesh);
}

static void test_open_surfaces(void **state) {
  (void)state;
  Body body = {0};
  add_box(&body, 0, 1);
  body.surface.triangle_count--;
  refuse(&body, TETCAST_ERROR_DATA, "the surface is open: 3 edges have only one triangle");
  body.surface.triangle_count = 1;
  refuse(&body, TETCAST_ERROR_DATA, "open");
}

/* TetGen frees its memory twice on these unless kept from it: more than once, and a good surface after. */
static void test_self_intersections(void **state) {
  (void)state;
  for (int i = 0; i < 3; i++) {
    Body body = {0};
    add_box(&body, 0, 1);
    add_box(&body, 0.5, 1.5 + i);
    refuse(&body, TETCAST_ERROR_DATA, "the surface intersects itself");
  }
  Body crossed = {0}; /* one corner pushed through the opposite side */
  add_box(&crossed, 0, 1);
  crossed.vertices[0][0] = crossed.vertices[0][1] = 0.4;
  crossed.vertices[0][2] = 3;
  refuse(&crossed, TETCAST_ERROR_DATA, "the surface intersects itself");
  Body body = {0};
  add_box(&body, 0, 1);
  TetcastMesh *mesh = fill(&body, 1.4, 0);
  assert_true(fabs(measure(mesh).volume - 1) < 1e-12);
  tetcast_mesh_destroy(&mesh);
}

static void test_bad_values(void **state) {
  (void)state;
  static const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3; i++) {
    Body body = {0};
    add_box(&body, 0, 1);
    body.vertices[5][1] = bad[i];
    refuse(&body, TETCAST_ERROR_DATA, "vertex 5 ");
    body.vertices[5][1] = 0;
    add_hole(&body, bad[i]);
    refuse(&body, TETCAST_ERROR_DATA, "hole 0 ");
  }
  Body body = {0};
  refuse(&body, TETCAST_ERROR_DATA, "no triangles");
  add_box(&body, 0, 1);
  body.triangles[7][2] = 8;
  refuse(&body, TETCAST_ERROR_DATA, "triangle 7 of the surface refers to vertex 8 of 8");
  body.triangles[7][2] = -1;
  refuse(&body, TETCAST_ERROR_DATA, "triangle 7 ");
  body.surface.vertex_count = INT64_MAX;
  refuse(&body, TETCAST_ERROR_LIMIT, "more than");
  body.surface.vertex_count = -1;
  refuse(&body, TETCAST_ERROR_ARGUMENT, "negative");

  Body point = {0};
  add_box(&point, 3, 3);
  refuse(&point, TETCAST_ERROR_DATA, "flat");
  Body flat = {0}; /* closed, and encloses nothing */
  add_box(&flat, 0, 1);
  for (int i = 0; i < 8; i++)
    flat.vertices[i][2] = 0;
  refuse(&flat, TETCAST_ERROR_DATA, "flat");
  for (int i = 0; i < 8; i++)
    flat.vertices[i][2] = flat.vertices[i][0] + flat.vertices[i][1];
  refuse(&flat, TETCAST_ERROR_DATA, "plane");
}

static void test_bad_arguments(void **state) {
  (void)state;
  Body body = {0};
  add_box(&body, 0, 1);
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_tetgen_mesh(context, NULL, NULL, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_tetgen_mesh(NULL, surface(&body), NULL, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_tetgen_mesh(context, surface(&body), NULL, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_tetgen_mesh_file(context, NULL, NULL, &mesh), TETCAST_ERROR_ARGUMENT);
  const TetcastTetgenDesc zero = {0};
  assert_int_equal(tetcast_tetgen_mesh(context, surface(&body), &zero, &mesh), TETCAST_ERROR_ARGUMENT);
  static const double bad[][2] = {{1, 0}, {0.5, 0}, {-2, 0}, {NAN, 0}, {INFINITY, 0}, {2, -1}, {2, NAN}, {2, INFINITY}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    TetcastTetgenDesc desc = tetcast_tetgen_desc_default();
    desc.quality = bad[i][0];
    desc.max_volume = bad[i][1];
    assert_int_equal(tetcast_tetgen_mesh(context, surface(&body), &desc, &mesh), TETCAST_ERROR_ARGUMENT);
    assert_null(mesh);
  }
  TetcastTetgenDesc desc = tetcast_tetgen_desc_default();
  desc.max_volume = 1e-12;
  assert_int_equal(tetcast_tetgen_mesh(context, surface(&body), &desc, &mesh), TETCAST_ERROR_LIMIT);
}

static void test_nothing_is_printed(void **state) {
  (void)state;
  fflush(stdout);
  const int saved = dup(STDOUT_FILENO);
  FILE *file = tmpfile();
  dup2(fileno(file), STDOUT_FILENO);
  Body body = {0};
  add_box(&body, 0, 1);
  TetcastMesh *mesh = fill(&body, 1.4, 0.01);
  tetcast_mesh_destroy(&mesh);
  add_box(&body, 0, 1); /* of facets that are there twice TetGen tells even when it is to be quiet */
  refuse(&body, TETCAST_ERROR_DATA, "intersects");
  printf("after");
  fflush(stdout);
  dup2(saved, STDOUT_FILENO);
  close(saved);
  char text[100] = {0};
  rewind(file);
  assert_int_equal(fread(text, 1, sizeof text, file), 5);
  assert_string_equal(text, "after");
  fclose(file);
}

/* ── files ── */

static char folder[64];

static int make_folder(void **state) {
  snprintf(folder, sizeof folder, "/tmp/tetcast-tetgen-XXXXXX");
  return mkdtemp(folder) ? set_up(state) : -1;
}

static int remove_folder(void **state) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  return system(command) + tear_down(state);
}

static const char *write_text(const char *name, const char *text, size_t size) {
  static char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, size, file), size);
  fclose(file);
  return path;
}

static TetcastStatus read_text(const char *name, const char *text, TetcastMesh **mesh) {
  message_count = 0;
  return tetcast_tetgen_mesh_file(context, write_text(name, text, strlen(text)), NULL, mesh);
}

static void accept_text(const char *name, const char *text, double volume) {
  TetcastMesh *mesh = NULL;
  if (read_text(name, text, &mesh) != TETCAST_OK)
    fail_msg("%s: %s", name, message);
  assert_true(fabs(measure(mesh).volume - volume) < 1e-9);
  tetcast_mesh_destroy(&mesh);
}

static void refuse_text(const char *name, const char *text, TetcastStatus status, const char *expected) {
  TetcastMesh *mesh = (TetcastMesh *)&mesh;
  assert_int_equal(read_text(name, text, &mesh), status);
  assert_null(mesh);
  assert_int_equal(message_count, 1);
  char stem[64];
  snprintf(stem, sizeof stem, "/%.*s.", (int)strcspn(name, "."), name);
  if (!strstr(message, expected) || !strstr(message, stem))
    fail_msg("\"%s\" should contain \"%s\" and \"%s\"", message, stem, expected);
}

#define BOX_POINTS  "0 0 0 0\n1 2 0 0\n2 2 2 0\n3 0 2 0\n4 0 0 2\n5 2 0 2\n6 2 2 2\n7 0 2 2\n"
#define SIDES       "4 0 1 2 3\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"
#define INNER       "8 .5 .5 .5\n9 1 .5 .5\n10 .5 1 .5\n11 .5 .5 1\n"
#define INNER_SIDES "3 8 9 10\n3 8 9 11\n3 9 10 11\n3 8 10 11\n"

static const char cavity[] =
    "# a box with a cavity\n12 3 0 0\n" BOX_POINTS INNER "\n10 0\n" SIDES INNER_SIDES "1\n0 .6 .6 .6\n0\n";

static void test_smesh(void **state) {
  (void)state;
  accept_text("a.smesh", "8 3 0 0\n" BOX_POINTS "6 0\n" SIDES "0\n", 8);
  accept_text("a.smesh", "8 3 0 0\r\n" BOX_POINTS "6\n" SIDES, 8); /* the rest left out */
  accept_text("a.smesh", cavity, 8 - 1. / 48);
  accept_text("a.smesh",
              "8 3 1 1 # attributes, markers\n0,0,0,0,5,1\n1 +2 0 0 5 1\n2 2. 2e0 0 5 1\n3 0 2 0 5 1\n4 0 0 2 5 1\n"
              "5 2 0 2 5 1 # last column\n\n6 2 2 2 5 1\n7 0 2 2 5 1\n6 1\n4 0 1\n 2 3 1\n4 4 5 6 7 1\n"
              "4 0 1 5 4 1\n4 1 2 6 5 1\n4 2 3 7 6 1\n4 3 0 4 7 1\n0\n",
              8);
  accept_text("a.smesh", /* numbered from 1 */
              "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n4\n3 1 2 3\n3 1 2 4\n3 2 3 4\n3 3 1 4\n", 1. / 6);
  write_text("b.node", "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", 37);
  accept_text("b.smesh", "0\n4\n3 1 2 3\n3 1 2 4\n3 2 3 4\n3 3 1 4\n", 1. / 6);
}

static void test_poly(void **state) {
  (void)state;
  /* a tunnel from bottom to top: two facets with a hole each */
  accept_text("a.poly",
              "16 3 0 0\n" BOX_POINTS
              "8 .5 .5 0\n9 1 .5 0\n10 1 1 0\n11 .5 1 0\n12 .5 .5 2\n13 1 .5 2\n14 1 1 2\n15 .5 1 2\n"
              "10 1\n2 1 5\n4 0 1 2 3\n4 8 9 10 11\n1 .75 .75 0\n2 1 5\n4 4 5 6 7\n4 12 13 14 15\n1 .75 .75 2\n"
              "1\n4 0 1 5 4\n1\n4 1 2 6 5\n1\n4 2 3 7 6\n1\n4 3 0 4 7\n"
              "1\n4 8 9 13 12\n1\n4 9 10 14 13\n1\n4 10 11 15 14\n1\n4 11 8 12 15\n"
              "0\n1\n1 .1 .1 .1 7 -1\n",
              8 - 0.5);
}

static void test_node_and_ele(void **state) {
  (void)state;
  static const char nodes[] = "5 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n";
  static const char cells[] = "2 4 1\n1 1 2 3 4 9\n2 2 3 4 5 9\n";
  write_text("m.node", nodes, sizeof nodes - 1);
  accept_text("m.ele", cells, 0.5);
  accept_text("m.node", nodes, 0.5);
  refuse_text("m.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 6\n", TETCAST_ERROR_DATA, "m.ele:3: a node is 6, not in [1, 5]");
  refuse_text("m.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 0\n", TETCAST_ERROR_DATA, ":3:");
  refuse_text("m.ele", "2 4 0\n1 1 2 3 4\n", TETCAST_ERROR_DATA, "truncated");
  refuse_text("m.ele", "2 5 0\n1 1 2 3 4 5\n", TETCAST_ERROR_DATA, "4 or 10 nodes");
  refuse_text("m.ele", "0 4 0\n", TETCAST_ERROR_DATA, "no tetrahedra");
  refuse_text("m.ele", "", TETCAST_ERROR_DATA, "truncated");
  refuse_text("alone.node", nodes, TETCAST_ERROR_IO, "alone.ele");
  write_text("none.node", "0 3\n", 4);
  refuse_text("none.ele", cells, TETCAST_ERROR_DATA, "none.ele:2:");
}

static void test_bad_files(void **state) {
  (void)state;
  refuse_text("a.smesh", "8 3\n" BOX_POINTS "6 0\n4 0 1 2 8\n", TETCAST_ERROR_DATA,
              ":11: a corner is 8, not in [0, 7]");
  refuse_text("a.smesh", "8 3\n" BOX_POINTS "6 0\n4 0 1 2 x\n", TETCAST_ERROR_DATA,
              ":11: a corner should be a whole number");
  refuse_text("a.smesh", "2 3\n0 0 0 0\n1 nan 0 0\n", TETCAST_ERROR_DATA, ":3: a coordinate is not finite");
  refuse_text("a.smesh", "2 3\n0 0 0 0\n1 1e999 0 0\n", TETCAST_ERROR_DATA, ":3:");
  refuse_text("a.smesh", "2 3\n0 0 0 0\n1 0 0\n", TETCAST_ERROR_DATA, ":3: a coordinate is missing");
  refuse_text("a.smesh", "2 3\n7 0 0 0\n8 0 0 0\n", TETCAST_ERROR_DATA, "numbered from 0 or 1");
  refuse_text("a.smesh", "4 2\n0 0 0\n", TETCAST_ERROR_DATA, ":1: points of dimension 2");
  refuse_text("a.smesh", "99999999999999999999 3\n", TETCAST_ERROR_DATA, ":1:");
  refuse_text("a.smesh", "500000000 3\n0 0 0 0\n", TETCAST_ERROR_DATA, "truncated");
  refuse_text("a.smesh", "-4 3\n", TETCAST_ERROR_DATA, ":1:");
  refuse_text("a.smesh", "8 3\n" BOX_POINTS "0 0\n", TETCAST_ERROR_DATA, "no facets");
  refuse_text("a.smesh", "8 3\n" BOX_POINTS "5 0\n" SIDES, TETCAST_ERROR_DATA, "");
  refuse_text("a.smesh", "8 3\n" BOX_POINTS "1\n4 0 1 2 3\n", TETCAST_ERROR_DATA, "");
  refuse_text("a.poly", "8 3\n" BOX_POINTS "1\n2\n4 0 1 2 3\n", TETCAST_ERROR_DATA, "truncated");
  refuse_text("a.poly", "8 3\n" BOX_POINTS "1\n0\n", TETCAST_ERROR_DATA, "polygons");
  refuse_text("lone.poly", "0 3\n1\n1\n3 0 1 2\n", TETCAST_ERROR_IO, "lone.node");
  refuse_text("a.smesh", "", TETCAST_ERROR_DATA, "truncated");
  refuse_text("a.smesh", "#\n \n\n#", TETCAST_ERROR_DATA, "truncated");
  refuse_text("a.off", "OFF\n", TETCAST_ERROR_ARGUMENT, "");
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_tetgen_mesh_file(context, "/nowhere/a.poly", NULL, &mesh), TETCAST_ERROR_IO);
  assert_non_null(strstr(message, "/nowhere/a.poly"));
  assert_int_equal(tetcast_tetgen_mesh_file(context, folder, NULL, &mesh), TETCAST_ERROR_ARGUMENT);
}

/* Every beginning of a file, and every file with one byte changed, gives a mesh or a message. */
static void test_truncated_and_damaged(void **state) {
  (void)state;
  const size_t size = sizeof cavity - 1;
  for (size_t i = 0; i < size; i++) {
    TetcastMesh *mesh = NULL;
    message_count = 0;
    const TetcastStatus status = tetcast_tetgen_mesh_file(context, write_text("t.smesh", cavity, i), NULL, &mesh);
    assert_true(status == TETCAST_OK ? mesh != NULL : message_count == 1 && !mesh);
    tetcast_mesh_destroy(&mesh);
  }
  static const char nodes[] = "5 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n";
  for (size_t i = 0; i < sizeof nodes - 1; i++)
    for (const char *c = "\n 09-+.e#x\377"; *c; c++) {
      char changed[sizeof nodes];
      memcpy(changed, nodes, sizeof nodes);
      changed[i] = *c;
      write_text("d.node", changed, sizeof nodes - 1);
      TetcastMesh *mesh = NULL;
      const TetcastStatus status = read_text("d.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n", &mesh);
      assert_true(status == TETCAST_OK ? mesh != NULL : message_count == 1 && !mesh);
      tetcast_mesh_destroy(&mesh);
    }
}

int main(void) {
  const struct CMUnitTest surfaces[] = {
      cmocka_unit_test(test_bounds_are_kept),    cmocka_unit_test(test_without_bounds_no_vertex_is_added),
      cmocka_unit_test(test_cavities),           cmocka_unit_test(test_any_unit_of_length),
      cmocka_unit_test(test_open_surfaces),      cmocka_unit_test(test_lines_and_stray_vertices_do_not_matter),
      cmocka_unit_test(test_self_intersections), cmocka_unit_test(test_bad_values),
      cmocka_unit_test(test_bad_arguments),      cmocka_unit_test(test_nothing_is_printed),
  };
  const struct CMUnitTest files[] = {
      cmocka_unit_test(test_smesh),
      cmocka_unit_test(test_poly),
      cmocka_unit_test(test_node_and_ele),
      cmocka_unit_test(test_bad_files),
      cmocka_unit_test(test_truncated_and_damaged),
  };
  return cmocka_run_group_tests(surfaces, set_up, tear_down) +
         cmocka_run_group_tests(files, make_folder, remove_folder);
}
