/* SPDX-License-Identifier: Apache-2.0 */
/* Files that claim to hold far more than they do: an error comes soon, and before memory is taken. */
#include "claims.h"

#define HUGE "2147483647"
#define XML(kind, attributes, body)                                                                                    \
  "<VTKFile type='" kind "' version='1.0' byte_order='LittleEndian' header_type='UInt64'><" kind " " attributes        \
  ">" body "</" kind "></VTKFile>"
#define ARRAY(type, name, more, values) "<DataArray type='" type "' Name='" name "' " more ">" values "</DataArray>"
#define ASCII                           "format='ascii'"
#define SOLE                            ARRAY("Float64", "s", ASCII, "1 2 3 4")
#define XYZ                             "0 0 0 1 0 0 0 1 0 0 0 1"
#define POINTS                          "<Points>" ARRAY("Float64", "Points", "NumberOfComponents='3' " ASCII, XYZ) "</Points>"
#define CELLS                                                                                                          \
  "<Cells>" ARRAY("Int64", "connectivity", ASCII, "0 1 2 3") ARRAY("Int64", "offsets", ASCII, "4")                     \
      ARRAY("UInt8", "types", ASCII, "10") "</Cells>"
#define PIECE(points, cells, body)                                                                                     \
  XML("UnstructuredGrid", "", "<Piece NumberOfPoints='" points "' NumberOfCells='" cells "'>" body "</Piece>")
#define DATA(array) PIECE("4", "1", "<PointData>" array "</PointData>" POINTS CELLS)
#define FIELD(array)                                                                                                   \
  XML("UnstructuredGrid", "",                                                                                          \
      "<FieldData>" array "</FieldData><Piece NumberOfPoints='4' NumberOfCells='1'>" POINTS CELLS "</Piece>")

/* Of XML: a header of 8 bytes each in base64. Blocks, size of each, of the last, then each compressed. */
#define ONE_HUGE "/////////38="                     /* 2^63 - 1 */
#define BLOCKS   "////fwAAAAD///9/AAAAAAAAAAAAAAAA" /* 2^31 - 1 blocks of as many bytes */
#define COMPRESSED(attributes, values)                                                                                 \
  "<VTKFile type='UnstructuredGrid' version='1.0' byte_order='LittleEndian' header_type='UInt64' "                     \
  "compressor='vtkZLibDataCompressor'><UnstructuredGrid>"                                                              \
  "<Piece NumberOfPoints='4' NumberOfCells='1'><PointData>" ARRAY(                                                     \
      "Float64", "s", attributes, values) "</PointData>" POINTS CELLS "</Piece></UnstructuredGrid></VTKFile>"

static const struct {
  const char *name, *text, *words;
} xml[] = {
    {"components.vtu", DATA(ARRAY("Float64", "s", "NumberOfComponents='" HUGE "' " ASCII, "1 2 3 4")),
     "array 's' can't be read: it claims " HUGE " components"},
    {"components2.vtu", DATA(ARRAY("Float64", "s", "NumberOfComponents='1000000' " ASCII, "1 2 3 4")),
     "array 's' can't be read"},
    {"components3.vtu", DATA(ARRAY("Float64", "s", "NumberOfComponents='-1' " ASCII, "1 2 3 4")),
     "array 's' can't be read"},
    {"components4.vtu",
     PIECE("4", "1", "<Points>" ARRAY("Float64", "p", "NumberOfComponents='" HUGE "' " ASCII, XYZ) "</Points>" CELLS),
     "claims " HUGE},
    {"components5.vtu",
     PIECE("4", "1",
           POINTS
           "<Cells>" ARRAY("Int64", "connectivity", "NumberOfComponents='" HUGE "' " ASCII, "0 1 2 3") "</Cells>"),
     "claims " HUGE},
    {"tuples.vtu", DATA(ARRAY("Float64", "s", "NumberOfTuples='" HUGE "000' " ASCII, "1 2 3 4")), NULL},
    {"points.vtu", PIECE(HUGE, "1", POINTS CELLS), "which the file can't hold"},
    {"points2.vtu", PIECE("9223372036854775807", "1", POINTS CELLS), "points"},
    {"cells.vtu", PIECE("4", HUGE, POINTS CELLS), "which the file can't hold"},
    {"cells2.vtu", PIECE("4", "-5", POINTS CELLS), "cells"},
    {"offset.vtu",
     PIECE("4", "1",
           POINTS "<Cells>" ARRAY("Int64", "connectivity", ASCII, "0 1 2 3")
               ARRAY("Int64", "offsets", ASCII, "9000000000000000") ARRAY("UInt8", "types", ASCII, "10") "</Cells>"),
     "claims to hold"},
    {"offset2.vtu",
     PIECE("4", "1",
           POINTS "<Cells>" ARRAY("Int64", "connectivity", ASCII, "0 1 2 3")
               ARRAY("Int64", "offsets", ASCII, "1000000000") ARRAY("UInt8", "types", ASCII, "10") "</Cells>"),
     "connectivity"},
    {"plain.vtu", DATA(ARRAY("Float64", "s", "format='binary'", ONE_HUGE)), "less data than it should"},
    {"blocks.vtu", COMPRESSED("format='binary'", BLOCKS), "less data than it should"},
    {"appended.vtu", DATA(ARRAY("Float64", "s", "format='appended' offset='9223372036854775807'", "")),
     "array 's' can't be read"},
    {"field.vtu", FIELD(ARRAY("Float64", "f", "NumberOfTuples='" HUGE "' " ASCII, "1")), NULL},
    {"field2.vtu", FIELD(ARRAY("Float64", "f", "NumberOfComponents='" HUGE "' NumberOfTuples='" HUGE "' " ASCII, "1")),
     NULL},
    {"string.vtu", FIELD(ARRAY("String", "f", "NumberOfTuples='" HUGE "' " ASCII, "65 0")), NULL},
    {"string2.vtu", FIELD(ARRAY("String", "f", "NumberOfTuples='1' " ASCII, "65 0 66 0 67 0 68 0")), NULL},
    {"string3.vtu", DATA(ARRAY("String", "f", "NumberOfComponents='" HUGE "' " ASCII, "65 0") SOLE), NULL},
    {"string4.vtu", DATA(ARRAY("String", "f", ASCII, "65 0 66 0 67 0 68 0 69 0 70 0 71 0 72 0") SOLE), NULL},
    {"key.vtu",
     DATA(ARRAY("Float64", "s", ASCII,
                "1 2 3 4<InformationKey name='L2_NORM_RANGE' location='vtkDataArray' length='" HUGE "'/>")),
     NULL},
    {"key2.vtu",
     DATA(ARRAY("Float64", "s", ASCII,
                "1 2 3 4<InformationKey name='UNITS_LABEL' location='vtkDataArray'><Value index='" HUGE
                "'>1</Value></InformationKey>")),
     NULL},
    {"steps.vtu",
     XML("UnstructuredGrid", "NumberOfTimeSteps='" HUGE "' TimeValues='0 1'",
         "<Piece NumberOfPoints='4' NumberOfCells='1'>" POINTS CELLS "</Piece>"),
     NULL},
    {"pieces.pvtu",
     XML("PUnstructuredGrid", "",
         "<PPointData>" ARRAY("Float64", "s", "NumberOfComponents='" HUGE "'",
                              "") "</PPointData><Piece Source='tuples.vtu'/>"),
     NULL},
    {"extent.vti",
     XML("ImageData", "WholeExtent='0 2000000 0 2000000 0 2000000' Origin='0 0 0' Spacing='1 1 1'",
         "<Piece Extent='0 2000000 0 2000000 0 2000000'><PointData>" SOLE "</PointData></Piece>"),
     "points"},
    {"extent2.vti",
     XML("ImageData", "WholeExtent='0 1000 0 1000 0 1000' Origin='0 0 0' Spacing='1 1 1'",
         "<Piece Extent='0 1000 0 1000 0 1000'></Piece>"),
     "points"},
    {"extent3.vti",
     XML("ImageData", "WholeExtent='0 1 0 1 0 1' Origin='0 0 0' Spacing='1 1 1'",
         "<Piece Extent='-2147483648 2147483647 0 1 0 1'><PointData>" SOLE "</PointData></Piece>"),
     "xtent"},
    {"extent.vtr",
     XML("RectilinearGrid", "WholeExtent='0 " HUGE " 0 1 0 1'",
         "<Piece Extent='0 " HUGE " 0 1 0 1'><Coordinates>" ARRAY("Float64", "x", ASCII, "0 1")
             ARRAY("Float64", "y", ASCII, "0 1") ARRAY("Float64", "z", ASCII, "0 1") "</Coordinates></Piece>"),
     ""},
    {"extent.vts",
     XML("StructuredGrid", "WholeExtent='0 1000 0 1000 0 1000'",
         "<Piece Extent='0 1000 0 1000 0 1000'>" POINTS "</Piece>"),
     ""},
    {"whole.pvti",
     XML("PImageData", "WholeExtent='0 1000000 0 1000000 0 1000000' Origin='0 0 0' Spacing='1 1 1'",
         "<Piece Extent='0 1000000 0 1000000 0 1000000' Source='extent.vti'/>"),
     ""},
    {"blocks.vtm",
     XML("vtkMultiBlockDataSet", "", "<Block index='4294967295'><DataSet index='" HUGE "' file='tuples.vtu'/></Block>"),
     NULL}};

/* Of legacy files; of text after ASCII, and of bytes. */
#define LEGACY(body) "# vtk DataFile Version 3.0\nt\nASCII\nDATASET " body
#define GRID         LEGACY("UNSTRUCTURED_GRID\nPOINTS 4 float\n" XYZ "\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")

static const struct {
  const char *name, *text, *words;
} texts[] = {
    {"points.vtk", LEGACY("UNSTRUCTURED_GRID\nPOINTS " HUGE " float\n" XYZ "\n"), "can't hold"},
    {"cells.vtk", LEGACY("UNSTRUCTURED_GRID\nPOINTS 4 float\n" XYZ "\nCELLS " HUGE " " HUGE "\n4 0 1 2 3\n"),
     "can't hold"},
    {"grid.vtk", LEGACY("STRUCTURED_POINTS\nDIMENSIONS 2000000 2000000 2000000\nORIGIN 0 0 0\nSPACING 1 1 1\n"), ""},
    {"grid2.vtk", LEGACY("STRUCTURED_POINTS\nDIMENSIONS 1000 1000 1000\nORIGIN 0 0 0\nSPACING 1 1 1\n"), ""},
    {"grid3.vtk", LEGACY("RECTILINEAR_GRID\nDIMENSIONS " HUGE " 2 2\nX_COORDINATES " HUGE " float\n0 1\n"), ""},
    {"grid4.vtk", LEGACY("STRUCTURED_GRID\nDIMENSIONS 1000 1000 1000\nPOINTS 1000000000 float\n" XYZ "\n"), ""},
    {"types.vtk", LEGACY("UNSTRUCTURED_GRID\nPOINTS 4 float\n" XYZ "\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES " HUGE "\n10\n"),
     "CELL_TYPES"},
    {"data.vtk", GRID "POINT_DATA " HUGE "\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4\n", ""},
    {"scalars.vtk", GRID "POINT_DATA 4\nSCALARS s float " HUGE "\nLOOKUP_TABLE default\n1 2 3 4\n", "can hold"},
    {"fields.vtk", GRID "POINT_DATA 4\nFIELD f " HUGE "\ns 1 4 float\n1 2 3 4\n", ""},
    {"field.vtk", GRID "POINT_DATA 4\nFIELD f 1\ns " HUGE " " HUGE " float\n1 2 3 4\n", ""},
    {"strings.vtk", GRID "POINT_DATA 4\nFIELD f 1\ns 1 " HUGE " string\na\nb\n", ""},
    {"table.vtk", GRID "POINT_DATA 4\nSCALARS s float 1\nLOOKUP_TABLE t\n1 2 3 4\nLOOKUP_TABLE t " HUGE "\n0 0 0 1\n",
     NULL},
    {"metadata.vtk",
     GRID "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4\nMETADATA\nINFORMATION " HUGE
          "\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA " HUGE " 0 1\n\n",
     NULL},
    {"metadata2.vtk",
     LEGACY("UNSTRUCTURED_GRID\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA " HUGE
            " 0 1\n\nPOINTS 4 float\n" XYZ "\nMETADATA\nINFORMATION " HUGE "\nNAME A LOCATION B\nDATA " HUGE
            " 1\n\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"),
     NULL},
    {"global.vtk",
     LEGACY("UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME " HUGE " " HUGE " double\n0\nPOINTS 4 float\n" XYZ
            "\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"),
     ""},
    {"global2.vtk",
     LEGACY("UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 " HUGE " string\n0\nPOINTS 4 float\n" XYZ
            "\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"),
     ""},
    {"nodes.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" HUGE "\n1 0 0 0\n$EndNodes\n", ""},
    {"elements.msh",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n" HUGE
     "\n1 4 0 1 2 3 4\n$EndElements\n",
     ""},
    {"tags.msh",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 "
     "4 " HUGE " 1 2 3 4\n$EndElements\n",
     ""},
    {"blocks.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n" HUGE " " HUGE " 1 " HUGE "\n3 1 0 " HUGE "\n1\n",
     ""},
    {"entities.msh",
     "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n" HUGE " " HUGE " " HUGE " " HUGE "\n1 0 0 0 " HUGE
     "\n$EndEntities\n",
     ""},
    {"names.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n" HUGE "\n3 1 \"a\"\n$EndPhysicalNames\n", ""},
    {"old.msh", "$NOD\n" HUGE "\n1 0 0 0\n$ENDNOD\n", ""},
    {"a.node", HUGE " 3 " HUGE " 1\n1 0 0 0\n", ""},
    {"b.node", "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", ""},
    {"case.case", "FORMAT\ntype: ensight\nGEOMETRY\nmodel: e.geo\n", ""}};

static const struct {
  const char *name, *text;
} surfaces[] = {
    {"a.off", "OFF\n" HUGE " " HUGE " 0\n0 0 0\n"},
    {"b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" HUGE " 0 1 2\n"},
    {"a.ply", "ply\nformat ascii 1.0\nelement vertex " HUGE
              "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
              "vertex_indices\nend_header\n0 0 0\n"},
    {"b.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 9000000000\nproperty double x\nproperty double "
              "y\nproperty double z\nelement face 9000000000\nproperty list uint int vertex_indices\nend_header\n0000"},
    {"a.vtk", LEGACY("POLYDATA\nPOINTS " HUGE " float\n" XYZ "\nPOLYGONS 1 4\n3 0 1 2\n")},
    {"b.vtk", LEGACY("POLYDATA\nPOINTS 4 float\n" XYZ "\nPOLYGONS " HUGE " " HUGE "\n3 0 1 2\n")},
    {"c.vtk", LEGACY("POLYDATA\nPOINTS 4 float\n" XYZ "\nPOLYGONS 1 4\n" HUGE " 0 1 2\n")},
    {"a.vtp", XML("PolyData", "", "<Piece NumberOfPoints='" HUGE "' NumberOfPolys='1'>" POINTS "</Piece>")},
    {"b.vtp", XML("PolyData", "",
                  "<Piece NumberOfPoints='4' NumberOfPolys='" HUGE "'>" POINTS
                  "<Polys>" ARRAY("Int64", "connectivity", ASCII, "0 1 2")
                      ARRAY("Int64", "offsets", ASCII, "3") "</Polys></Piece>")}};

static void test_xml(void **state) {
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof xml / sizeof *xml; ++i)
    text_file(fixture, xml[i].name, xml[i].text); /* some name others */
  for (size_t i = 0; i < sizeof xml / sizeof *xml; ++i)
    assert_cheap(fixture, in_folder(fixture, xml[i].name), 0, xml[i].words);
}

static void test_texts(void **state) {
  Fixture *fixture = *state;
  text_file(fixture, "a.ele", "1 4\n1 1 2 3 4\n");
  text_file(fixture, "b.ele", HUGE " 4 " HUGE "\n1 1 2 3 4\n");
  text_file(fixture, "e.geo",
            "a\nb\nnode id assign\nelement id assign\ncoordinates\n" HUGE "\n 0.00000e+00 0.00000e+00 0.00000e+00\n");
  for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i)
    assert_cheap(fixture, text_file(fixture, texts[i].name, texts[i].text), 0, texts[i].words);
}

/* Strings of a legacy file of bytes say how long they are: to 2^30 by two bits, 2^64 by none. */
static void test_strings(void **state) {
  static const char head[] =
      "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD f 1\nnames 1 2 string\n";
  Fixture *fixture = *state;
  for (int kind = 0; kind < 4; ++kind) {
    char bytes[256] = "";
    memcpy(bytes, head, sizeof head - 1);
    memset(bytes + sizeof head - 1, 0xff, 64);
    bytes[sizeof head - 1] = (char)(kind << 6 | 0x3f);
    assert_cheap(fixture, file_of(fixture, "s.vtk", bytes, sizeof head - 1 + 64), 0, "");
  }
}

static void test_surfaces(void **state) {
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; ++i)
    assert_cheap(fixture, text_file(fixture, surfaces[i].name, surfaces[i].text), -1, "");
  char stl[100] = "";
  memset(stl + 80, 0xff, 4); /* triangles */
  assert_cheap(fixture, file_of(fixture, "a.stl", stl, sizeof stl), -1, "");
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_xml), TEST(test_texts), TEST(test_strings), TEST(test_surfaces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
