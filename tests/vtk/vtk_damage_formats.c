/* SPDX-License-Identifier: Apache-2.0 */
/* Files of the other formats, cut short and with bits and digits changed: an error or a mesh, soon and in little
 * memory. */
#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>

#include "cases.h"
#include "damage.h"
#include "gmsh_file.h"
#include "samples.h"

/* A reader that does not come back within this many seconds hangs; so many as other work of the machine, and a
 * sanitizer, slow it down as well. */
enum { PATIENCE = 400 };

static char last[600]; /* what is read */

static int streams[2] = {-1, -1}; /* the real standard output and error, while they go elsewhere */

static void restore_streams(void) {
  for (int i = 0; i < 2; ++i) {
    if (streams[i] < 0)
      continue;
    dup2(streams[i], i + 1);
    close(streams[i]);
    streams[i] = -1;
  }
}

static void hangs(int signal) {
  (void)signal;
  static const char text[] = "hangs: ";
  restore_streams();
  if (write(2, text, sizeof text - 1) < 0 || write(2, last, strlen(last)) < 0 || write(2, "\n", 1) < 0)
    _exit(1);
  _exit(1);
}

static int tear_down_streams(void **state) {
  alarm(0);
  restore_streams();
  return tear_down(state);
}

/* Nothing may be printed, and it may not take long. */
static void use_soon(Fixture *fixture, const char *opened) {
  int printed = 0, ends[2];
  snprintf(last, sizeof last, "%s/%s", fixture->folder, opened);
  fflush(stdout);
  assert_int_equal(pipe(ends), 0);
  assert_int_equal(fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
  for (int i = 0; i < 2; ++i) {
    streams[i] = dup(i + 1);
    dup2(ends[1], i + 1);
  }
  signal(SIGALRM, hangs);
  alarm(PATIENCE);
  use(fixture, last);
  alarm(0);
  fflush(stdout);
  restore_streams();
  ioctl(ends[0], FIONREAD, &printed);
  close(ends[0]);
  close(ends[1]);
  assert_int_equal(printed, 0);
}

/* Damages file `name`, and opens `opened`, which is or needs it. */
static void damage(Fixture *fixture, const char *name, const char *opened, int most) {
  const int times = getenv("TETCAST_TEST_SHORT") ? most / 4 : most;
  char path[600];
  snprintf(path, sizeof path, "%s", in_folder(fixture, name));
  size_t size;
  char *bytes = contents(path, &size), *changed = malloc(size);
  assert_int_equal(use(fixture, in_folder(fixture, opened)), TETCAST_OK);
  for (int k = 0; k < times; ++k) {
    file_of(fixture, name, bytes, size * (size_t)k / (size_t)times);
    use_soon(fixture, opened);
  }
  uint32_t seed = 3;
  for (int k = 0; k < 4 * times; ++k) {
    const size_t range = k % 2 && size > 2000 ? 2000 : size; /* half of them in the header */
    memcpy(changed, bytes, size);
    for (int j = 0; j <= k % 3; ++j) {
      size_t at = next_random(&seed) % range;
      if (k % 4 < 2) {
        changed[at] = (char)(changed[at] ^ (1 << next_random(&seed) % 8));
        continue;
      }
      for (int tries = 0; tries < 5000 && (bytes[at] < '0' || bytes[at] > '9'); ++tries)
        at = next_random(&seed) % range;
      changed[at] = "0123456789-"[next_random(&seed) % 11];
    }
    file_of(fixture, name, changed, size);
    use_soon(fixture, opened);
  }
  file_of(fixture, name, bytes, size);
  free(bytes);
  free(changed);
}

static void test_structured(void **state) {
  Fixture *fixture = *state;
  static const char *const names[] = {"i.vti", "r.vtr", "s.vts", "i.vtk", "r.vtk", "s.vtk"};
  for (int i = 0; i < 6; ++i) {
    for (int mode = SAMPLE_ASCII; mode <= SAMPLE_RAW; ++mode) {
      if (i >= 3 && mode > SAMPLE_BINARY)
        break;
      sample_structured(in_folder(fixture, names[i]), names[i][0], (SampleMode)mode);
      damage(fixture, names[i], names[i], 40);
    }
  }
}

static void test_lists(void **state) {
  Fixture *fixture = *state;
  sample_layers(in_folder(fixture, "a.vtu"), 0, 2, GHOST_TYPES);
  sample_layers(in_folder(fixture, "b.vtu"), 2, 4, GHOST_LEVELS);
  text_file(fixture, "p.pvtu",
            "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid GhostLevel=\"1\"><Piece "
            "Source=\"a.vtu\"/>"
            "<Piece Source=\"b.vtu\"/></PUnstructuredGrid></VTKFile>\n");
  text_file(fixture, "t.pvd",
            "<VTKFile type=\"Collection\" version=\"0.1\"><Collection><DataSet timestep=\"1\" file=\"a.vtu\"/>"
            "<DataSet timestep=\"20\" file=\"b.vtu\"/></Collection></VTKFile>\n");
  text_file(
      fixture, "t.series",
      "{\"file-series-version\": \"1.0\", \"files\": [{\"name\": \"a.vtu\", \"time\": 1}, {\"name\": \"\\u0062.vtu\", "
      "\"time\": 2e1}], \"x\": [true, null, [{}]]}\n");
  static const char *const lists[] = {"p.pvtu", "t.pvd", "t.series"};
  for (int i = 0; i < 3; ++i)
    damage(fixture, lists[i], lists[i], 100);
  damage(fixture, "a.vtu", "p.pvtu", 40);
  sample_blocks(in_folder(fixture, "m.vtm"));
  damage(fixture, "m.vtm", "m.vtm", 60);
  char folder[600];
  snprintf(folder, sizeof folder, "rm -rf '%s/m'", fixture->folder);
  assert_int_equal(system(folder), 0);
}

static void test_tetgen(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "t.node", "5 3 1 1\n1 0 0 0 5 0\n2 1 0 0 6 0\n3 0 1 0 7 1\n4 0 0 1 8 1\n5 1 1 1 8 1\n");
  text_file(fixture, "t.ele", "2 4 1\n1 1 2 3 4 9\n2 2 3 4 5 9\n");
  damage(fixture, "t.node", "t.ele", 60);
  damage(fixture, "t.ele", "t.node", 60);
}

static void test_gmsh(void **state) {
  Fixture *fixture = *state;
  static const double p[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  static const int64_t node[5] = {1, 2, 3, 4, 5}, element[2] = {8, 9};
  static const GmshElement elements[2] = {{8, 4, 4, 1, 3, node}, {9, 4, 4, 1, 3, node + 1}};
  static const double values[8] = {1, 2, 3, 4, 5, 6, 7, 8};
  for (int version = 2; version <= 4; version += 2) {
    for (int encoding = GMSH_TEXT; encoding <= GMSH_BIG; ++encoding) {
      GmshFile to = gmsh_open(in_folder(fixture, "g.msh"), version, (GmshEncoding)encoding);
      gmsh_entities(&to, 1, &elements[0].group);
      gmsh_nodes(&to, 5, node, p, 0);
      gmsh_elements(&to, 2, elements);
      gmsh_data(&to, "NodeData", "a", 0, 1, 5, node, 0, values);
      gmsh_data(&to, "ElementData", "b", 1, 3, 2, element, 0, values);
      gmsh_data(&to, "ElementNodeData", "c", 0, 1, 2, element, 4, values);
      fclose(to.file);
      damage(fixture, "g.msh", "g.msh", 40);
    }
  }
}

/* Those whose reader is VTK's, in a plugin. */
static void test_ensight(void **state) {
  Fixture *fixture = *state;
  const char *path = write_ensight(fixture);
  TetcastDataset *dataset;
  if (tetcast_dataset_read(fixture->context, path, NULL, &dataset) == TETCAST_ERROR_UNSUPPORTED)
    skip();
  tetcast_dataset_destroy(&dataset);
  damage(fixture, "a.case", "a.case", 20);
  damage(fixture, "a.geo", "a.case", 20);
  damage(fixture, "a.s0", "a.case", 5);
}

static void test_openfoam(void **state) {
  Fixture *fixture = *state;
  const char *path = write_openfoam(fixture);
  TetcastDataset *dataset;
  const bool known = tetcast_dataset_read(fixture->context, path, NULL, &dataset) != TETCAST_ERROR_UNSUPPORTED;
  tetcast_dataset_destroy(&dataset);
  static const char *const names[] = {"system/controlDict",
                                      "constant/polyMesh/points",
                                      "constant/polyMesh/faces",
                                      "constant/polyMesh/owner",
                                      "constant/polyMesh/neighbour",
                                      "constant/polyMesh/boundary",
                                      "0/p"};
  for (int i = 0; known && i < 7; ++i)
    damage(fixture, names[i], "case.foam", 8);
  remove_openfoam(fixture);
  if (!known)
    skip();
}

static void test_exodus(void **state) {
  Fixture *fixture = *state;
  if (!sample_exodus(in_folder(fixture, "box.ex2")))
    skip();
  damage(fixture, "box.ex2", "box.ex2", 20);
}

static void test_cgns(void **state) {
  Fixture *fixture = *state;
  if (!sample_cgns(in_folder(fixture, "box.cgns")))
    skip();
  damage(fixture, "box.cgns", "box.cgns", 25);
}

static void test_vtkhdf(void **state) {
  Fixture *fixture = *state;
  size_t size;
  char *bytes = contents(data_path(fixture, "cells/can-vtu.hdf"), &size);
  file_of(fixture, "can.hdf", bytes, size);
  free(bytes);
  TetcastDataset *dataset;
  if (tetcast_dataset_read(fixture->context, fixture->path, NULL, &dataset) == TETCAST_ERROR_UNSUPPORTED)
    skip();
  tetcast_dataset_destroy(&dataset);
  damage(fixture, "can.hdf", "can.hdf", 25);
}

/* Of all there was to read. What a sanitizer holds back of freed memory does not count. */
static void test_memory(void **state) {
  (void)state;
#ifndef __SANITIZE_ADDRESS__
  const int who[] = {RUSAGE_SELF, RUSAGE_CHILDREN};
  for (int i = 0; i < 2; ++i) {
    struct rusage usage;
    assert_int_equal(getrusage(who[i], &usage), 0);
    print_message("%s: at most %ld MB\n", i ? "programs" : "this process", usage.ru_maxrss / 1024);
    assert_true(usage.ru_maxrss < 256 * 1024); /* and four times files of some kilobytes */
  }
#endif
}

#undef TEST
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down_streams)

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_structured), TEST(test_lists),    TEST(test_tetgen), TEST(test_gmsh),
                                     TEST(test_ensight),    TEST(test_openfoam), TEST(test_exodus), TEST(test_cgns),
                                     TEST(test_vtkhdf),     TEST(test_memory)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
