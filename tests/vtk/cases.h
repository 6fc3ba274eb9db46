/* SPDX-License-Identifier: Apache-2.0 */
/* Cases of several files. */
#ifndef TEST_VTK_CASES_H
#define TEST_VTK_CASES_H

#include <sys/stat.h>

#include "common.h"

/* EnSight Gold, two steps of one tetrahedron; the geometry stays. Returns the path of the case. */
static inline const char *write_ensight(Fixture *fixture) {
  text_file(
      fixture, "a.geo",
      "one\ntetrahedron\nnode id assign\nelement id assign\npart\n         1\nsolid\ncoordinates\n         4\n"
      " 0.00000e+00\n 1.00000e+00\n 0.00000e+00\n 0.00000e+00\n 0.00000e+00\n 0.00000e+00\n 1.00000e+00\n 0.00000e+00\n"
      " 0.00000e+00\n 0.00000e+00\n 0.00000e+00\n 1.00000e+00\ntetra4\n         1\n         1         2         3      "
      "   4\n");
  static const char *const values[2] = {" 1.00000e+00\n 2.00000e+00\n 3.00000e+00\n 4.00000e+00\n",
                                        " 5.00000e+00\n 6.00000e+00\n 7.00000e+00\n 8.00000e+00\n"};
  char text[256];
  for (int i = 0; i < 2; ++i) {
    snprintf(text, sizeof text, "s\npart\n         1\ncoordinates\n%s", values[i]);
    text_file(fixture, i ? "a.s1" : "a.s0", text);
  }
  return text_file(
      fixture, "a.case",
      "FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: a.geo\n\nVARIABLE\nscalar per node: 1 s a.s*\n\n"
      "TIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\nfilename increment: 1\ntime values: 0.5 2\n");
}

#define FOAM(class, object) "FoamFile\n{\n version 2.0;\n format ascii;\n class " class ";\n object " object ";\n}\n"

/* An OpenFOAM case of two cubes side by side, with two steps. */
static inline const char *write_openfoam(Fixture *fixture) {
  static const char *const folders[] = {"system", "constant", "constant/polyMesh", "0", "0.5"};
  for (int i = 0; i < 5; ++i)
    assert_int_equal(mkdir(in_folder(fixture, folders[i]), 0700), 0);
  text_file(fixture, "system/controlDict",
            FOAM("dictionary", "controlDict") "startFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1;\n"
                                              "deltaT 0.5;\nwriteControl runTime;\nwriteInterval 0.5;\n");
  text_file(fixture, "constant/polyMesh/points",
            FOAM("vectorField", "points") "12\n(\n(0 0 0)\n(1 0 0)\n(2 0 0)\n(0 1 0)\n(1 1 0)\n(2 1 0)\n(0 0 1)\n(1 0 "
                                          "1)\n(2 0 1)\n(0 1 1)\n(1 1 1)\n(2 1 1)\n)\n");
  text_file(fixture, "constant/polyMesh/faces",
            FOAM("faceList", "faces") "11\n(\n4(1 4 10 7)\n4(0 6 9 3)\n4(0 1 7 6)\n4(3 9 10 4)\n4(0 3 4 1)\n4(6 7 10 "
                                      "9)\n4(2 5 11 8)\n4(1 2 8 7)\n4(4 10 11 5)\n"
                                      "4(1 4 5 2)\n4(7 8 11 10)\n)\n");
  text_file(fixture, "constant/polyMesh/owner",
            FOAM("labelList", "owner") "11\n(\n0\n0\n0\n0\n0\n0\n1\n1\n1\n1\n1\n)\n");
  text_file(fixture, "constant/polyMesh/neighbour", FOAM("labelList", "neighbour") "1\n(\n1\n)\n");
  text_file(fixture, "constant/polyMesh/boundary",
            FOAM("polyBoundaryMesh", "boundary") "1\n(\nwalls\n{\n type wall;\n nFaces 10;\n startFace 1;\n}\n)\n");
  for (int i = 0; i < 2; ++i) {
    char text[512];
    snprintf(text, sizeof text,
             FOAM("volScalarField",
                  "p") "dimensions [0 2 -2 0 0 0 0];\ninternalField nonuniform List<scalar>\n2\n(\n%d\n%d\n)\n;\n"
                       "boundaryField\n{\n walls\n {\n type zeroGradient;\n }\n}\n",
             1 + 2 * i, 2 + 2 * i);
    text_file(fixture, i ? "0.5/p" : "0/p", text);
  }
  return text_file(fixture, "case.foam", "");
}

static inline void remove_openfoam(const Fixture *fixture) {
  char command[600];
  snprintf(command, sizeof command, "cd '%s' && rm -rf system constant 0 0.5", fixture->folder);
  assert_int_equal(system(command), 0);
}

#endif
