/* SPDX-License-Identifier: Apache-2.0 */
/* Reading surfaces, and XML that is none. */
#include <math.h>

#include "common.h"

static TetcastSurface surface_good(Fixture *fixture, const char *path) {
  TetcastSurface surface;
  fixture->errors = 0;
  const TetcastStatus status = tetcast_surface_read(fixture->context, path, &surface);
  if (status)
    print_error("%s\n", fixture->message);
  assert_int_equal(status, TETCAST_OK);
  for (int64_t i = 0; i < 3 * surface.triangle_count; ++i) {
    assert_true(surface.triangles[i] >= 0 && surface.triangles[i] < surface.vertex_count);
  }
  return surface;
}

static double area(const TetcastSurface *surface) {
  double sum = 0;
  for (int64_t i = 0; i < surface->triangle_count; ++i) {
    const double *p[3];
    for (int j = 0; j < 3; ++j)
      p[j] = surface->vertices + 3 * surface->triangles[3 * i + j];
    double u[3], v[3];
    for (int k = 0; k < 3; ++k) {
      u[k] = p[1][k] - p[0][k];
      v[k] = p[2][k] - p[0][k];
    }
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  return sum;
}

#define PLY_VERTEX "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE   "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define LEGACY     "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\n"

/* One square, in every format; a point that coincides with another, and one that nothing uses, go. */
static void test_formats(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *name, *text;
  } cases[] = {
      {"a.stl", "solid vertex\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 1 1 0\n "
                "endloop\n endfacet\n"
                " facet normal 0 0 1\n outer loop\n vertex -0 0 0\n vertex 1.0 +1 0\n vertex 0e5 1 0\n endloop\n "
                "endfacet\nendsolid vertex\n"},
      {"A.OFF", "OFF\n# a comment\n5 1 0\n0 0 0\n1 0 0\n\n1 1 0\n0 1 0\n7 7 7\n4 0 1 2 3  255 0 0\n"},
      {"b.off", "COFF 4 2 5\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n3 0 2 3\n"},
      {"a.obj",
       "# comment\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nvt 0 0\nvn 0 0 1\nf 1/1 2/1/1 3//1 -2\n"},
      {"b.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 \\\r\n3 4\r\n"},
      {"a.ply", "ply\nformat ascii 1.0\ncomment c\n" PLY_VERTEX PLY_FACE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"},
      {"a.vtk", LEGACY
       "LINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n"},
      {"b.vtk", LEGACY "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"},
      {"a.vtp",
       "<VTKFile type='PolyData' version='0.1' byte_order='LittleEndian'><PolyData><Piece NumberOfPoints='4' "
       "NumberOfPolys='1'>"
       "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 1 1 0 0 1 "
       "0</DataArray></Points><Polys>"
       "<DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 3</DataArray>"
       "<DataArray type='Int32' Name='offsets' format='ascii'>4</DataArray></Polys></Piece></PolyData></VTKFile>"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastSurface surface = surface_good(fixture, text_file(fixture, cases[i].name, cases[i].text));
    assert_int_equal(surface.vertex_count, 4);
    assert_int_equal(surface.triangle_count, 2);
    assert_int_equal(surface.hole_count, 0);
    assert_true(area(&surface) == 1);
    tetcast_surface_release(&surface);
    assert_null(surface.vertices);
    tetcast_surface_release(&surface);
  }
  tetcast_surface_release(NULL);
}

/* Puts a number of `size` bytes at *at, in the byte order asked for. */
static void put(unsigned char **at, const void *value, size_t size, bool big) {
  const unsigned char *bytes = value;
  for (size_t i = 0; i < size; ++i)
    *(*at)++ = bytes[big ? size - 1 - i : i];
}

static void test_binary_formats(void **state) {
  Fixture *fixture = *state;
  static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int big = 0; big < 2; ++big) {
    unsigned char bytes[1024], *at = bytes;
    at += sprintf((char *)at,
                  "ply\nformat binary_%s_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double x\n"
                  "property double y\nproperty double z\n" PLY_FACE,
                  big ? "big" : "little");
    for (int i = 0; i < 4; ++i) {
      *at++ = 7;
      for (int k = 0; k < 3; ++k)
        put(&at, &corners[i][k], 8, big);
    }
    *at++ = 4;
    for (int32_t i = 0; i < 4; ++i)
      put(&at, &i, 4, big);
    const size_t size = (size_t)(at - bytes);
    TetcastSurface surface = surface_good(fixture, file_of(fixture, "a.ply", bytes, size));
    assert_true(surface.triangle_count == 2 && area(&surface) == 1);
    tetcast_surface_release(&surface);
    for (size_t part = 0; part < size; ++part) {
      assert_int_not_equal(tetcast_surface_read(fixture->context, file_of(fixture, "b.ply", bytes, part), &surface),
                           TETCAST_OK);
    }
  }
  /* Binary STL whose title begins with "solid". */
  unsigned char bytes[84 + 100] = "solid but binary", *at = bytes + 80;
  const uint32_t count = 2;
  put(&at, &count, 4, false);
  for (int i = 0; i < 2; ++i) {
    at += 12;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        const float value = (float)corners[j ? j + i : 0][k];
        put(&at, &value, 4, false);
      }
    }
    at += 2;
  }
  TetcastSurface surface = surface_good(fixture, file_of(fixture, "a.stl", bytes, sizeof bytes));
  assert_true(surface.triangle_count == 2 && surface.vertex_count == 4 && area(&surface) == 1);
  tetcast_surface_release(&surface);
  fixture->errors = 0;
  assert_int_equal(tetcast_surface_read(fixture->context, file_of(fixture, "b.stl", bytes, sizeof bytes - 1), &surface),
                   TETCAST_ERROR_DATA);
  assert_complaint(fixture, "b.stl", "truncated: holds 1 of 2 triangles");
  memset(bytes + 80, 0, 4); /* a writer that didn't know how many */
  surface = surface_good(fixture, file_of(fixture, "c.stl", bytes, sizeof bytes));
  assert_int_equal(surface.triangle_count, 2);
  tetcast_surface_release(&surface);
}

/* A polygon with a bay is cut inside itself; one that has lost its area still closes the surface. */
static void test_polygons(void **state) {
  Fixture *fixture = *state;
  TetcastSurface surface = surface_good(
      fixture,
      text_file(fixture, "bay.off", "OFF\n7 1 0\n0 0 0\n4 0 0\n4 4 0\n3 4 0\n3 1 0\n1 1 0\n0 4 0\n7 0 1 2 3 4 5 6\n"));
  assert_int_equal(surface.triangle_count, 5);
  assert_true(fabs(area(&surface) - 8.5) < 1e-12); /* 16 − 6 − 1.5 */
  tetcast_surface_release(&surface);
  surface = surface_good(
      fixture, text_file(fixture, "flat.off", "OFF\n5 2 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n4 0 1 2 3\n3 0 1 4\n"));
  assert_int_equal(surface.triangle_count, 3);
  tetcast_surface_release(&surface);
}

static void test_defects(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *name, *text, *words;
  } cases[] = {
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "ends after 2 of 3 vertices"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "ends after 0 of 1 faces"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", "line 4: a coordinate expected, not 'x'"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "point 1: coordinate z is"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 1e999\n0 1 0\n3 0 1 2\n", "point 1: coordinate z is inf"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "polygon 0: a point index is out of range (there are 3 points)"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n99999999 0 1 2\n", "line 6"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n", "no triangles"},
      {"a.off", "OFF\n-3 1 0\n", "numbers of vertices and faces expected"},
      {"a.off", "OFF\n", "numbers of vertices and faces expected"},
      {"a.off", "OFF\n99999999999999999999 1 0\n", "numbers of vertices and faces expected"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "out of range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "out of range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "out of range"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 a\n", "line 4"},
      {"a.obj", "v 0 0\n", "line 1"},
      {"a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "truncated"},
      {"a.stl", "nothing of the kind", "truncated"},
      {"a.ply", "ply\nformat ascii 1.0\n" PLY_VERTEX PLY_FACE "0 0 0\n1 0 0\n1 1 0\n", "ends after 3 of 4 vertex"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty foo x\nend_header\n0 0 0\n", "line 4"},
      {"a.ply", "ply\nformat middle_endian 1.0\n" PLY_VERTEX PLY_FACE, "line 2"},
      {"a.ply", "ply\n" PLY_VERTEX PLY_FACE, "no format"},
      {"a.ply", "ply\nformat ascii 1.0\n" PLY_VERTEX, "header does not end"},
      {"a.ply", "ply\nformat ascii 1.0\n" PLY_VERTEX PLY_FACE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 7\n",
       "out of range"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "coordinate y is"},
      {"a.vtk", LEGACY "POLYGONS 1 5\n4 0 1 2 9\n", "polygon 0: point index 9 is out of range"},
      {"a.vtk", LEGACY "POLYGONS 1 5\n7 0 1 2 3\n", "cell 0 does not fit"},
      {"a.vtk", LEGACY, "no triangles"},
      {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n",
       "UNSTRUCTURED_GRID, not a surface"},
      {"a.xyz", "0 0 0\n", "not a file of a surface in a known format"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastSurface surface;
    fixture->errors = 0;
    const TetcastStatus status =
        tetcast_surface_read(fixture->context, text_file(fixture, cases[i].name, cases[i].text), &surface);
    assert_int_equal(status, TETCAST_ERROR_DATA);
    assert_complaint(fixture, fixture->path, cases[i].words);
    assert_null(surface.vertices);
    assert_int_equal(surface.triangle_count, 0);
  }
  TetcastSurface surface;
  assert_int_equal(tetcast_surface_read(fixture->context, in_folder(fixture, "missing.stl"), &surface),
                   TETCAST_ERROR_IO);
  assert_int_equal(tetcast_surface_read(fixture->context, NULL, &surface), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_surface_read(fixture->context, "a.stl", NULL), TETCAST_ERROR_ARGUMENT);
}

/* Closed surfaces: V − E + F = 2 − 2g, so that V − F/2 is the same as before reading. */
static void test_others_files(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *name;
    int64_t vertices, triangles;
  } cases[] = {{"surfaces/bear.off", 13826, 27648},
               {"surfaces/knot2.off", 5760, 11520},
               {"surfaces/pliers_binary.stl", 5356, 10708}};
  for (int i = 0; i < 3; ++i) {
    TetcastSurface surface = surface_good(fixture, data_path(fixture, cases[i].name));
    assert_int_equal(surface.vertex_count, cases[i].vertices);
    assert_int_equal(surface.triangle_count, cases[i].triangles);
    tetcast_surface_release(&surface);
  }
}

static void count_element(void *user, int depth, const char *name, const char *const *attributes) {
  int *counts = user;
  ++counts[depth];
  for (; *attributes; attributes += 2)
    counts[3] += !strcmp(name, "b") && !strcmp(attributes[0], "x") && !strcmp(attributes[1], "1 & 2");
}

/* Elements of any XML file come with their depth and attributes. */
static void test_elements(void **state) {
  Fixture *fixture = *state;
  int counts[4] = {0};
  assert_int_equal(tetcast_xml_read(fixture->context,
                                    text_file(fixture, "a.xml", "<a>text<b x='1 &amp; 2' y='3'/><b><c/></b></a>"),
                                    count_element, counts),
                   TETCAST_OK);
  assert_true(counts[0] == 1 && counts[1] == 2 && counts[2] == 1 && counts[3] == 1);
  const char *const damaged[] = {"", "<a>", "<a></b>", "a", "<a b></a>"};
  for (size_t i = 0; i < sizeof damaged / sizeof *damaged; ++i) {
    fixture->errors = 0;
    assert_int_equal(tetcast_xml_read(fixture->context, text_file(fixture, "a.xml", damaged[i]), count_element, counts),
                     TETCAST_ERROR_DATA);
    assert_int_equal(fixture->errors, 1);
  }
  assert_int_equal(tetcast_xml_read(fixture->context, in_folder(fixture, "missing.xml"), count_element, counts),
                   TETCAST_ERROR_IO);
  assert_int_equal(tetcast_xml_read(fixture->context, NULL, count_element, counts), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_xml_read(fixture->context, "a.xml", NULL, counts), TETCAST_ERROR_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_formats), TEST(test_binary_formats), TEST(test_polygons),
                                     TEST(test_defects), TEST(test_others_files),   TEST(test_elements)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
