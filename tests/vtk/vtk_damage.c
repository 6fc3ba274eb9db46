/* SPDX-License-Identifier: Apache-2.0 */
/* Files that are damaged, truncated or something else. */
#include <fcntl.h>

#include "damage.h"

#define POINTS                                                                                                         \
  "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
#define CELL "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
#define XML(points, cells, body)                                                                                       \
  "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"                  \
  "<Piece NumberOfPoints=\"" points "\" NumberOfCells=\"" cells "\">" body "</Piece></UnstructuredGrid></VTKFile>"
#define ARRAY(type, name, values)                                                                                      \
  "<DataArray type=\"" type "\" Name=\"" name "\" format=\"ascii\">" values "</DataArray>"
#define XYZ(values)                                                                                                    \
  "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">" values "</DataArray></Points>"
#define CELLS(connectivity, offsets, types)                                                                            \
  "<Cells>" ARRAY("Int32", "connectivity", connectivity) ARRAY("Int32", "offsets", offsets)                            \
      ARRAY("UInt8", "types", types) "</Cells>"
#define FOUR XYZ("0 0 0 1 0 0 0 1 0 0 0 1")

static void test_defects(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *name, *text, *words;
  } cases[] = {
      {"empty.vtu", "", "empty"},
      {"picture.png", "\x89PNG\r\n", "not a file of a volume mesh"},
      {"text.vtu", "hello\n", "XML"},
      {"text.vtk", "hello\n", "header"},
      {"header.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n", "truncated"},
      {"polydata.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n",
       "POLYDATA, not a volume mesh: a surface"},
      {"table.vtu", "<VTKFile type=\"Table\"></VTKFile>", "Table, not a volume mesh"},
      {"image.vti", "<VTKFile type=\"ImageData\"></VTKFile>", "ImageData"},
      {"surface.stl", "solid a\nfacet normal 0 0 1\n", "STL data, not a volume mesh"},
      {"nopoints.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" CELL, "no points"},
      {"nocells.vtk", POINTS, "no cells"},
      {"notypes.vtk", POINTS "CELLS 1 5\n4 0 1 2 3\n", "CELL_TYPES"},
      {"types.vtk", POINTS "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n", "CELL_TYPES of 2 cells"},
      {"unknown.vtk", POINTS "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n77777\n", "cell 0: there is no cell type 77777"},
      {"unknown2.vtk", POINTS "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n200\n", "cell 0: there is no cell type 200"},
      {"surface.vtk", POINTS "CELLS 2 8\n3 0 1 2\n3 1 2 3\nCELL_TYPES 2\n5 5\n",
       "no volumetric cells, only 2 × triangle"},
      {"short.vtk", POINTS "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n", "cell 0: a tetrahedron has 4 points, not 3"},
      {"range.vtk", POINTS "CELLS 1 5\n4 0 1 2 5\nCELL_TYPES 1\n10\n", "cell 0: point index 5 is out of range"},
      {"negative.vtk", POINTS "CELLS 1 5\n4 0 1 -2 3\nCELL_TYPES 1\n10\n",
       "cell 0: point index -2 is out of range (there are 5 points)"},
      {"stream.vtk", POINTS "CELLS 1 5\n400 0 1 2 3\nCELL_TYPES 1\n10\n", "cell 0 does not fit"},
      {"stream2.vtk", POINTS "CELLS 1 5\n-4 0 1 2 3\nCELL_TYPES 1\n10\n", "cell 0 does not fit"},
      {"count.vtk", POINTS "CELLS 9999999999 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "can't hold"},
      {"count2.vtk", POINTS "CELLS -1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "can't hold"},
      {"word.vtk", POINTS "CELLZ 1 5\n", "cellz"},
      {"values.vtk", POINTS CELL "POINT_DATA 4\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n",
       "'a' can't be read: it has 4 values for 5 points"},
      {"length.vtk", POINTS CELL "POINT_DATA 5\nFIELD f 1\na 1 3 float\n1 2 3\n",
       "'a' can't be read: it has 3 values for 5 points"},
      {"cells.vtk", POINTS CELL "CELL_DATA 1\nFIELD f 1\nb 1 2 float\n1 2\n",
       "'b' can't be read: it has 2 values for 1 cells"},
      {"few.vtk", POINTS CELL "POINT_DATA 5\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n", "it has 4 of 5 values"},
      {"minus.vtk", POINTS CELL "POINT_DATA 5\nSCALARS a float -3\nLOOKUP_TABLE default\n1 2 3 4 5\n",
       "more than the file can hold"},
      {"minus2.vtk", POINTS CELL "POINT_DATA 5\nFIELD f 1\na -1 5 float\n1 2 3 4 5\n", "FIELD claims a count of -1"},
      {"minus3.vtk", POINTS CELL "POINT_DATA 5\nFIELD f 1\na 1 -5 float\n1 2 3 4 5\n", "FIELD claims a count of -5"},
      {"minus4.vtk", POINTS CELL "POINT_DATA 5\nLOOKUP_TABLE t -4\n", "LOOKUP_TABLE claims a count of -4"},
      {"type.vtk", POINTS CELL "POINT_DATA 5\nVECTORS a frog\n1 2 3 4 5\n", "frog"},
      {"keyword.vtk", POINTS CELL "POINT_DATA 5\nSKALARS a float\n1 2 3 4 5\n", "skalars"},
      {"faces.vtk", POINTS "CELLS 1 8\n7 4 3 0 1 2 3 0\nCELL_TYPES 1\n42\n",
       "cell 0: the list of the polyhedron's faces"},
      {"lagrange.vtk", POINTS "CELLS 1 6\n5 0 1 2 3 3\nCELL_TYPES 1\n71\n", "cell 0: 5 nodes don't make a cell"},
      {"pyramid.vtk", POINTS "CELLS 1 6\n5 0 1 2 3 3\nCELL_TYPES 1\n74\n", "Lagrange pyramid, which can't be cut"},
      {"few.vtu", XML("4", "1", XYZ("0 0 0 1 0 0") CELLS("0 1 2 3", "4", "10")), "too short"},
      {"inf.vtu",
       XML("4", "1",
           "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">"
           "MAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIB/AAAAAAAAAAAAAAAAAACAPw==</DataArray></Points>" CELLS(
               "0 1 2 3", "4", "10")),
       "no cells without coordinates that are NaN or infinite"},
      {"offsets.vtu", XML("4", "1", FOUR CELLS("0 1 2 3", "-4", "10")), "offsets"},
      {"offsets2.vtu", XML("4", "1", FOUR CELLS("0 1 2 3", "400", "10")), "connectivity"},
      {"range.vtu", XML("4", "1", FOUR CELLS("0 1 2 4", "4", "10")),
       "cell 0: point index 4 is out of range (there are 4 points)"},
      {"line.vtu", XML("4", "1", FOUR CELLS("0 1", "2", "3")), "only 1 × line"},
      {"none.vtu", XML("4", "0", FOUR CELLS("", "", "")), "no cells"},
      {"nothing.vtu", XML("0", "0", ""), ""},
      {"huge.vtu", XML("4", "99999999999", FOUR CELLS("0 1 2 3", "4", "10")),
       "99999999999 cells, which the file can't hold"},
      {"huge2.vtu", XML("99999999999", "1", FOUR CELLS("0 1 2 3", "4", "10")), "99999999999 points"},
      {"minus.vtu", XML("4", "-1", FOUR CELLS("0 1 2 3", "4", "10")), "-1 cells, which the file can't hold"},
      {"open.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>", "XML"},
      {"base64.vtu",
       XML("4", "1",
           "<PointData><DataArray type=\"Float32\" Name=\"a\" "
           "format=\"binary\">EAAAAAA!AAAAAAAAAAAAAAAAAA==</DataArray>"
           "</PointData>" FOUR CELLS("0 1 2 3", "4", "10")),
       "'a'"},
      {"blocks.vtu", /* one block, of no size, the last of 16 bytes */
       "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\" "
       "compressor=\"vtkZLibDataCompressor\">"
       "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData><DataArray type=\"Float32\" "
       "Name=\"a\" "
       "format=\"binary\">AQAAAAAAAAAQAAAACAAAAA==eJwDAAAAAAE=</DataArray></PointData>" FOUR CELLS(
           "0 1 2 3", "4", "10") "</Piece></UnstructuredGrid></VTKFile>",
       "'a' can't be read: it has less data"},
      {"pieces.pvtu",
       "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid><PPoints><PDataArray type=\"Float32\" "
       "NumberOfComponents=\"3\"/></PPoints><Piece Source=\"gone.vtu\"/></PUnstructuredGrid></VTKFile>",
       "gone.vtu: can't be opened"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const TetcastStatus status = strstr(cases[i].name, "pyramid")            ? TETCAST_ERROR_UNSUPPORTED
                                 : strstr(cases[i].words, "can't be opened") ? TETCAST_ERROR_IO
                                                                             : TETCAST_ERROR_DATA;
    read_bad(fixture, text_file(fixture, cases[i].name, cases[i].text), status, cases[i].words);
  }
  read_bad(fixture, in_folder(fixture, "missing.vtu"), TETCAST_ERROR_IO, "No such file");
  read_bad(fixture, fixture->folder, TETCAST_ERROR_IO, "is a folder");
  read_bad(fixture, "/dev/null", TETCAST_ERROR_IO, "not a regular file");
  static const char hdf[] = "\x89HDF\r\n\x1a\n", netcdf[] = "CDF\x01\0\0\0";
  read_bad(fixture, file_of(fixture, "a.e", hdf, sizeof hdf), TETCAST_ERROR_UNSUPPORTED, "HDF5");
  read_bad(fixture, file_of(fixture, "a.ex2", netcdf, sizeof netcdf), TETCAST_ERROR_DATA, "NetCDF");
}

/* A cell with more points than its type has is read, with a warning. */
static void test_oversized_cells(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset =
      read_good(fixture, text_file(fixture, "a.vtk", POINTS "CELLS 1 6\n5 0 1 2 3 4\nCELL_TYPES 1\n10\n"));
  assert_int_equal(fixture->warnings, 1);
  TetcastMesh *mesh;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  int64_t v[4];
  tetcast_mesh_tetrahedron(mesh, 0, v);
  assert_true(v[0] == 0 && v[1] == 1 && v[2] == 2 && v[3] == 3);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
}

static void test_arguments(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset = (TetcastDataset *)fixture;
  assert_int_equal(tetcast_dataset_read(fixture->context, NULL, NULL, &dataset), TETCAST_ERROR_ARGUMENT);
  assert_null(dataset);
  assert_int_equal(tetcast_dataset_read(fixture->context, "a.vtu", NULL, NULL), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_read(NULL, "a.vtu", NULL, &dataset), TETCAST_ERROR_ARGUMENT);
  TetcastMesh *mesh;
  TetcastField *field;
  assert_int_equal(tetcast_dataset_mesh(NULL, &mesh), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_dataset_field(NULL, NULL, &field, NULL), TETCAST_ERROR_ARGUMENT);
}

/* VTK prints its complaints through a window and a logger: neither may reach the terminal. */
static void test_silence(void **state) {
  Fixture *fixture = *state;
  char log[600];
  snprintf(log, sizeof log, "%s", in_folder(fixture, "log"));
  fflush(stdout);
  const int file = open(log, O_CREAT | O_WRONLY, 0600), out = dup(1), err = dup(2);
  assert_true(file >= 0);
  dup2(file, 1);
  dup2(file, 2);
  TetcastDataset *dataset;
  const TetcastStatus first = tetcast_dataset_read(
      fixture->context, text_file(fixture, "a.vtu", XML("4", "1", FOUR CELLS("0 1 2", "4", "10"))), NULL, &dataset);
  const TetcastStatus second = tetcast_dataset_read(
      fixture->context, text_file(fixture, "a.vtk", POINTS "CELLS 1 5\n4 0 1 2 x\n"), NULL, &dataset);
  fflush(stdout);
  fflush(stderr);
  dup2(out, 1);
  dup2(err, 2);
  close(out);
  close(err);
  assert_int_equal(lseek(file, 0, SEEK_END), 0);
  close(file);
  assert_int_equal(first, TETCAST_ERROR_DATA);
  assert_int_equal(second, TETCAST_ERROR_DATA);
}

static const char *const samples[] = {
    "encodings/ascii.vtu",
    "encodings/appraw_le_uint32_zlib.vtu",
    "encodings/appraw_be_uint64_none.vtu",
    "encodings/app64_le_uint32_none.vtu",
    "encodings/inline64_be_uint64_lz4.vtu",
    "encodings/appraw_le_uint32_lzma.vtu",
    "encodings/legacy42_ascii.vtk",
    "encodings/legacy42_binary.vtk",
    "encodings/legacy51_ascii.vtk",
    "encodings/legacy51_binary.vtk",
    "cells/polyhedron2pieces.vtu",
    "cells/supportedElementsAsVTKPolyhedra.vtk",
};
enum { SAMPLES = sizeof samples / sizeof *samples };

static void test_truncation(void **state) {
  Fixture *fixture = *state;
  for (int i = 0; i < SAMPLES; ++i) {
    size_t size;
    char *bytes = contents(data_path(fixture, samples[i]), &size);
    const bool legacy = strstr(samples[i], ".vtk") != NULL;
    for (size_t part = 0; part < 60; ++part) {
      const char *path = file_of(fixture, legacy ? "cut.vtk" : "cut.vtu", bytes, size * part / 60);
      const TetcastStatus status = use(fixture, path);
      /* A legacy file may end between two sections. */
      if (!legacy)
        assert_int_not_equal(status, TETCAST_OK);
    }
    /* The end of appended raw data, behind which only the closing tags follow. */
    for (size_t cut = 40; cut < 100; ++cut) {
      const char *path = file_of(fixture, legacy ? "cut.vtk" : "cut.vtu", bytes, size - cut);
      const TetcastStatus status = use(fixture, path);
      if (!legacy && cut > 60)
        assert_int_not_equal(status, TETCAST_OK);
    }
    free(bytes);
  }
}

static void test_flipped_bits(void **state) {
  Fixture *fixture = *state;
  uint32_t seed = 1;
  for (int i = 0; i < SAMPLES; ++i) {
    size_t size;
    char *bytes = contents(data_path(fixture, samples[i]), &size);
    for (int k = 0; k < 120; ++k) {
      const size_t range = k % 2 && size > 3000 ? 3000 : size; /* half of them in the header */
      const size_t at = next_random(&seed) % range;
      const char old = bytes[at];
      bytes[at] = (char)(old ^ (1 << next_random(&seed) % 8));
      use(fixture, file_of(fixture, strstr(samples[i], ".vtk") ? "flip.vtk" : "flip.vtu", bytes, size));
      bytes[at] = old;
    }
    free(bytes);
  }
}

/* Digits that become others make wrong counts and indices. */
static void test_changed_digits(void **state) {
  Fixture *fixture = *state;
  uint32_t seed = 7;
  for (int i = 0; i < SAMPLES; ++i) {
    size_t size;
    char *bytes = contents(data_path(fixture, samples[i]), &size), *changed = malloc(size);
    for (int k = 0; k < 60; ++k) {
      memcpy(changed, bytes, size);
      for (int j = 0; j < 3; ++j) {
        size_t at = next_random(&seed) % size;
        for (int tries = 0; tries < 5000 && (bytes[at] < '0' || bytes[at] > '9'); ++tries)
          at = next_random(&seed) % size;
        changed[at] = "0123456789-"[next_random(&seed) % 11];
      }
      use(fixture, file_of(fixture, strstr(samples[i], ".vtk") ? "digit.vtk" : "digit.vtu", changed, size));
    }
    free(bytes);
    free(changed);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(test_defects),    TEST(test_oversized_cells), TEST(test_arguments),      TEST(test_silence),
      TEST(test_truncation), TEST(test_flipped_bits),    TEST(test_changed_digits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
