/* SPDX-License-Identifier: Apache-2.0 */
/* Arrays: what isn't asked for can't stop what is, which is drawn when none is named, and how one is. */
#include <math.h>

#include "cases.h"
#include "samples.h"

/* A tetrahedron with an array `good` at its points, 1 2 3 4, one in the cell, 5, and what else is given, in any of
 * these formats. */
static const char *vtu(Fixture *fixture, const char *point_arrays, const char *cell_arrays) {
  static char text[20000];
  snprintf(text, sizeof text,
           "<VTKFile type='UnstructuredGrid' version='0.1' byte_order='LittleEndian'><UnstructuredGrid><Piece "
           "NumberOfPoints='4' NumberOfCells='1'>"
           "<PointData>%s<DataArray type='Float64' Name='good' format='ascii'>1 2 3 4</DataArray></PointData>"
           "<CellData>%s<DataArray type='Float32' Name='cell' format='ascii'>5</DataArray></CellData>"
           "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 0 1 0 0 0 "
           "1</DataArray></Points>"
           "<Cells><DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 3</DataArray><DataArray "
           "type='Int32' Name='offsets' format='ascii'>4"
           "</DataArray><DataArray type='UInt8' Name='types' "
           "format='ascii'>10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
           point_arrays, cell_arrays);
  return text_file(fixture, "a.vtu", text);
}

static const char *legacy(Fixture *fixture, const char *point_arrays) {
  static char text[8192];
  snprintf(
      text, sizeof text,
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS "
      "1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
      "POINT_DATA 4\n%sSCALARS good double\nLOOKUP_TABLE default\n1 2 3 4\nCELL_DATA 1\nFIELD f 1\ncell 1 1 float\n5\n",
      point_arrays);
  return text_file(fixture, "a.vtk", text);
}

static TetcastDataset *read_only(Fixture *fixture, const char *path, const char *only) {
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  TetcastDataset *dataset;
  desc.only = only;
  fixture->errors = fixture->warnings = 0;
  fixture->message[0] = fixture->warning[0] = '\0';
  if (tetcast_dataset_read(fixture->context, path, &desc, &dataset) != TETCAST_OK)
    fail_msg("%s", fixture->message);
  return dataset;
}

static double value_of(Fixture *fixture, const TetcastDataset *dataset, const char *selector, int64_t i) {
  TetcastField *field;
  if (tetcast_dataset_field(dataset, selector, &field, NULL) != TETCAST_OK)
    fail_msg("%s", fixture->message);
  const double value = tetcast_field_value(field, i);
  tetcast_field_destroy(&field);
  return value;
}

static void refuse_field(Fixture *fixture, const TetcastDataset *dataset, const char *selector, TetcastStatus status,
                         const char *words) {
  TetcastField *field;
  fixture->errors = 0;
  assert_int_equal(tetcast_dataset_field(dataset, selector, &field, NULL), status);
  assert_int_equal(fixture->errors, 1);
  if (!strstr(fixture->message, words))
    fail_msg("'%s' lacks '%s'", fixture->message, words);
}

static bool is_unread(const TetcastDataset *dataset, const char *name) {
  const char *unread;
  for (int i = 0; (unread = tetcast_dataset_unread(dataset, i)); ++i)
    if (!strcmp(unread, name))
      return true;
  return false;
}

/* The file has `good` and `cell` and a warning that says `words` about `name`, which can't be had; who doesn't ask for
 * it hears nothing of it. */
static void assert_left_out(Fixture *fixture, const char *path, const char *name, const char *words) {
  char named[64];
  snprintf(named, sizeof named, "'%s'", name);
  TetcastDataset *dataset = read_only(fixture, path, NULL);
  assert_int_equal(fixture->warnings, 1);
  if (!strstr(fixture->warning, named) || !strstr(fixture->warning, words))
    fail_msg("'%s' lacks '%s' or '%s'", fixture->warning, named, words);
  for (int i = 0; i < 4; ++i)
    assert_true(value_of(fixture, dataset, "good", i) == i + 1);
  assert_true(value_of(fixture, dataset, "cell", 0) == 5);
  if (!strstr(words, "second")) {
    refuse_field(fixture, dataset, name, TETCAST_ERROR_DATA, words);
    assert_true(is_unread(dataset, name));
  }
  assert_false(is_unread(dataset, "good"));
  assert_null(tetcast_dataset_unread(dataset, -1));
  tetcast_dataset_destroy(&dataset);
  dataset = read_only(fixture, path, "good");
  assert_int_equal(fixture->warnings, 0);
  assert_true(value_of(fixture, dataset, NULL, 3) == 4);
  refuse_field(fixture, dataset, "none", TETCAST_ERROR_ARGUMENT, name);
  tetcast_dataset_destroy(&dataset);
  if (strstr(words, "second"))
    return;
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  desc.only = name;
  fixture->errors = 0;
  const TetcastStatus status = tetcast_dataset_read(fixture->context, path, &desc, &dataset);
  if (status == TETCAST_OK) { /* a format whose arrays are all read */
    refuse_field(fixture, dataset, name, TETCAST_ERROR_DATA, words);
    tetcast_dataset_destroy(&dataset);
    return;
  }
  assert_int_equal(status, TETCAST_ERROR_DATA);
  assert_int_equal(fixture->errors, 1);
  if (!strstr(fixture->message, words))
    fail_msg("'%s' lacks '%s'", fixture->message, words);
}

#define BAD(type, more, values) "<DataArray type='" type "' Name='bad' " more ">" values "</DataArray>"

static void test_xml(void **state) {
  static const struct {
    const char *array, *words;
  } cases[] = {
      {BAD("Float64", "format='ascii'", "1 2 3"), "3 values: it is too short"},
      {BAD("Float64", "format='ascii'", "1 2 x 4"), "value 2 is 'x'"},
      {BAD("Int32", "format='ascii'", "1 2 3 4.5"), "value 3 is '4.5'"},
      {BAD("UInt8", "format='ascii'", "1 2 3 256"), "value 3 is '256'"},
      {BAD("Float64", "format='ascii' NumberOfComponents='2147483647'", "1 2 3 4"), "claims 2147483647 components"},
      {BAD("Float64", "format='ascii' NumberOfComponents='0'", "1 2 3 4"), "claims 0 components"},
      {BAD("Float64", "format='ascii' NumberOfComponents='-3'", "1 2 3 4"), "claims -3 components"},
      {BAD("Float64", "format='ascii' NumberOfComponents='1000000'", "1 2 3 4"), "less data"},
      {BAD("Float64", "format='binary'", "AAAAAA=="), "less data"},
      {BAD("Float64", "format='binary'", "IAAAAA!AAAAAAAA"), "less data"},
      {BAD("Float64", "format='appended' offset='12345678901234'", ""), "less data"},
      {BAD("Float64", "format='appended' offset='-9223372036854775807'", ""), "less data"},
      {BAD("Float128", "format='ascii'", "1 2 3 4"), "its type is 'Float128'"},
      {"<DataArray Name='bad' format='ascii'>1 2 3 4</DataArray>", "its type is ''"},
      {"<Text type='Float64' Name='bad' format='ascii'>1 2 3 4</Text>", "it is no array"},
      {"<DataArray type='Float64' Name='bad' format='ascii'>1 2 3 4</DataArray><DataArray type='Float64' Name='bad' "
       "format='ascii'>5 6 7 8</DataArray>",
       "the second of that name"}};
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    assert_left_out(fixture, vtu(fixture, cases[i].array, ""), "bad", cases[i].words);
    if (!strstr(cases[i].words, "value") && !strstr(cases[i].words, "data"))
      assert_left_out(fixture, vtu(fixture, "", cases[i].array), "bad", cases[i].words);
  }
  TetcastDataset *dataset = read_only(fixture, vtu(fixture, cases[15].array, ""), NULL);
  assert_true(value_of(fixture, dataset, "bad", 3) == 4); /* the first */
  tetcast_dataset_destroy(&dataset);
  /* The word for what is said of all. */
  dataset = read_only(fixture,
                      vtu(fixture,
                          BAD("Float64", "format='ascii'",
                              "1") "<DataArray type='Int8' Name='worse' format='ascii'>999 1 1 1</DataArray>",
                          ""),
                      NULL);
  assert_int_equal(fixture->warnings, 1);
  assert_non_null(strstr(fixture->warning, "2 arrays are left out: 'bad', 'worse'"));
  tetcast_dataset_destroy(&dataset);
}

/* Texts are no numbers: nothing is said of them, and VTK does not see them, which writes beyond its memory where there
 * are too many. */
static void test_strings(void **state) {
  Fixture *fixture = *state;
  char text[8192];
  for (int many = 0; many < 2; ++many) {
    char values[4000] = "";
    for (int i = 0; i < (many ? 600 : 3); ++i)
      strcat(values, "65 0 ");
    snprintf(text, sizeof text, "<Array type='String' Name='bad' NumberOfComponents='%d' format='ascii'>%s</Array>",
             many ? 1 : 1000000, values);
    TetcastDataset *dataset = read_only(fixture, vtu(fixture, text, text), NULL);
    assert_int_equal(fixture->warnings, 0);
    assert_true(value_of(fixture, dataset, "good", 3) == 4);
    tetcast_dataset_destroy(&dataset);
  }
  const char *path =
      legacy(fixture, "FIELD f 3\na 1 2 string\none\ntwo%20words\nb 1 4 float\n6 7 8 9\nc 1 1 utf8_string\nx\n");
  TetcastDataset *dataset = read_only(fixture, path, NULL);
  assert_int_equal(fixture->warnings, 0);
  assert_true(value_of(fixture, dataset, "b", 3) == 9);
  assert_true(value_of(fixture, dataset, "good", 3) == 4);
  tetcast_dataset_destroy(&dataset);
}

/* Names that are missing are made up, by the place of the array. */
static void test_unnamed(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset = read_only(fixture,
                                      vtu(fixture,
                                          "<DataArray type='Float64' format='ascii'>6 7 8 9</DataArray><DataArray "
                                          "type='Int8' Name='' format='ascii'>1 2 3 10</DataArray>",
                                          ""),
                                      NULL);
  assert_int_equal(fixture->warnings, 0);
  assert_true(value_of(fixture, dataset, "unnamed_0", 3) == 9);
  assert_true(value_of(fixture, dataset, "unnamed_1", 3) == 10);
  tetcast_dataset_destroy(&dataset);
}

/* Numbers that C++'s streams stop at, as text in either of VTK's formats. What single precision can't hold is double.
 */
static void test_numbers(void **state) {
  static const struct {
    const char *text;
    double value;
  } words[] = {{"nan", NAN},     {"NaN", NAN},       {"-nan", NAN},       {"nan(ind)", NAN},      {"-1.#IND", NAN},
               {"1.#QNAN", NAN}, {"inf", INFINITY},  {"-inf", -INFINITY}, {"Infinity", INFINITY}, {"1.#INF", INFINITY},
               {"1e50", 1e50},   {"-3e300", -3e300}, {"1e-50", 1e-50},    {"1e999", INFINITY},    {"1.5d3", 1500},
               {"2.5D-1", 0.25}, {"+7", 7},          {"1e-400", 0}};
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
    for (int format = 0; format < 4; ++format) {
      char text[512];
      const char *type = format % 2 ? "double" : "float", *path;
      if (format < 2) {
        snprintf(text, sizeof text, "SCALARS a %s\nLOOKUP_TABLE default\n1 %s 2 3\n", type, words[i].text);
        path = legacy(fixture, text);
      } else {
        snprintf(text, sizeof text, "<DataArray type='%s' Name='a' format='ascii'>1 %s 2 3</DataArray>",
                 format % 2 ? "Float64" : "Float32", words[i].text);
        path = vtu(fixture, text, "");
      }
      TetcastDataset *dataset = read_only(fixture, path, NULL);
      const double value = value_of(fixture, dataset, "a", 1), expected = words[i].value;
      const bool rounds = format % 2 == 0 && fabs(expected) < 1e-37; /* single precision: 0 */
      if (!(isnan(expected) ? isnan(value) : rounds ? value == 0 : value == expected))
        fail_msg("%s of type %s is %g", words[i].text, type, value);
      assert_true(value_of(fixture, dataset, "a", 3) == 3);
      assert_true(value_of(fixture, dataset, "good", 3) == 4);
      tetcast_dataset_destroy(&dataset);
    }
  }
  /* Coordinates, too: the point is left out. */
  TetcastDataset *dataset =
      read_only(fixture,
                text_file(fixture, "p.vtk",
                          "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 "
                          "0 0 1 0 0 0 1 nan 0 1e50\n"
                          "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n"),
                NULL);
  assert_int_equal(tetcast_dataset_pieces(dataset).nonfinite_cells, 1);
  tetcast_dataset_destroy(&dataset);
}

static void test_legacy(void **state) {
  static const struct {
    const char *array, *name, *words;
  } cases[] = {{"SCALARS bad float\nLOOKUP_TABLE default\n1 2 x 4\n", "bad", "line 14: 'x' is not a number"},
               {"SCALARS bad float\nLOOKUP_TABLE default\n1 2 3\n", "bad", "3 of 4 values"},
               {"SCALARS bad int\nLOOKUP_TABLE default\n1 2 3.5 4\n", "bad", "'3.5' is not a number of its type"},
               {"VECTORS bad float\n1 2 3 4 5 6 7 8 9 10 11\n", "bad", "11 of 12 values"},
               {"SCALARS bad frog\nLOOKUP_TABLE default\n1 2 3 4\n", "bad", "no type 'frog'"},
               {"SCALARS bad float -3\nLOOKUP_TABLE default\n1 2 3 4\n", "bad", "more than the file can hold"},
               {"FIELD f 2\nfine 1 4 int\n9 8 7 6\nbad 1 4 float\n1 2 y 4\n", "bad", "line 16: 'y'"},
               {"FIELD f 2\nbad 1 4 float\n1 2 y 4\nfine 1 4 int\n9 8 7 6\n", "bad", "line 14: 'y'"},
               {"FIELD f 1\nbad 1 4 float\n1 2 3\n", "bad", "3 of 4 values"},
               {"FIELD f 1\nbad 1 3 float\n1 2 3\n", "bad", "it has 3 values for 4 points"},
               {"FIELD f 1\nbad 1 99999999 float\n1 2 3 4\n", "bad", "FIELD claims a count of 99999999"},
               {"SCALARS bad float\nLOOKUP_TABLE default\n1 2 3 4\nSCALARS bad float\nLOOKUP_TABLE default\n5 6 7 8\n",
                "bad", "the second of that name"},
               {"SPECTRA bad float\n1 2 3 4\n", "spectra", "can't be read"}};
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const char *path = legacy(fixture, cases[i].array);
    assert_left_out(fixture, path, cases[i].name, cases[i].words);
    if (!strstr(cases[i].array, "fine"))
      continue;
    TetcastDataset *dataset = read_only(fixture, path, NULL);
    assert_true(value_of(fixture, dataset, "fine", 3) == 6);
    tetcast_dataset_destroy(&dataset);
  }
}

/* SCALARS with the line LOOKUP_TABLE and without it, as text and as bytes; among these some that look like anything. */
static void test_no_lookup_table(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset =
      read_only(fixture, legacy(fixture, "SCALARS a float 1\n6 7 8 9\nSCALARS b int\n1 2 3 10\n"), NULL);
  assert_int_equal(fixture->warnings, 0);
  assert_true(value_of(fixture, dataset, "a", 0) == 6 && value_of(fixture, dataset, "a", 3) == 9);
  assert_true(value_of(fixture, dataset, "b", 0) == 1 && value_of(fixture, dataset, "good", 3) == 4);
  tetcast_dataset_destroy(&dataset);
  static const char *const firsts[] = {"\n\n\n\n", "LOOK", "   \n", "\0\0\0\x01", "l00k"};
  for (int k = 0; k < 5; ++k) {
    for (int table = 0; table < 2; ++table) {
      FILE *file = fopen(in_folder(fixture, "b.vtk"), "wb");
      fputs("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n", file);
      static const unsigned char one[4] = {0x3f, 0x80, 0, 0}, zero[4] = {0};
      for (int i = 0; i < 12; ++i)
        fwrite(i == 3 || i == 7 || i == 11 ? one : zero, 1, 4, file);
      fputs("\nCELLS 1 5\n", file);
      for (int i = 0; i < 5; ++i)
        fwrite((unsigned char[4]){0, 0, 0, (unsigned char)(i ? i - 1 : 4)}, 1, 4, file);
      fputs("\nCELL_TYPES 1\n", file);
      fwrite((unsigned char[4]){0, 0, 0, 10}, 1, 4, file);
      fprintf(file, "\nPOINT_DATA 4\nSCALARS a int\n%s", table ? "LOOKUP_TABLE default\n" : "");
      fwrite(firsts[k], 1, 4, file);
      for (int i = 1; i < 4; ++i)
        fwrite((unsigned char[4]){0, 0, 0, (unsigned char)i}, 1, 4, file);
      fputs("\nSCALARS c unsigned_char\nLOOKUP_TABLE default\nabcd\n", file);
      fclose(file);
      dataset = read_only(fixture, fixture->path, NULL);
      const unsigned char *first = (const unsigned char *)firsts[k];
      assert_true(
          value_of(fixture, dataset, "a", 0) ==
          (double)(int32_t)((uint32_t)first[0] << 24 | (uint32_t)first[1] << 16 | (uint32_t)first[2] << 8 | first[3]));
      assert_true(value_of(fixture, dataset, "a", 3) == 3);
      assert_true(value_of(fixture, dataset, "c", 3) == 'd');
      tetcast_dataset_destroy(&dataset);
    }
  }
}

/* A field with something that only OpenFOAM itself understands: the others are read, of each step. */
static void test_openfoam(void **state) {
  static const char *const bad[] = {
      ("dimensions [0 0 0 1 0 0 0];\ninternalField uniform 1;\nboundaryField\n{\n"
       " #includeEtc \"caseDicts/setConstraintTypes\"\n}\n"),
      "dimensions [0 0 0 1 0 0 0];\ninternalField #codeStream\n{\n code #{ x #};\n};\nboundaryField\n{\n}\n",
      "#include \"nowhere\"\ndimensions [0 0 0 1 0 0 0];\ninternalField uniform $value;\nboundaryField\n{\n}\n",
      "dimensions [0 0 0 1 0 0 0];\ninternalField nonuniform List<scalar>\n3\n(\n1\n2\n3\n)\n;\nboundaryField\n{\n}\n",
      "dimensions [0 0 0 1 0 0 0];\ninternalField nonuniform List<scalar>\n2\n(\n1\n"};
  Fixture *fixture = *state;
  const char *extensions;
  bool known = false;
  for (int i = 0; !known && tetcast_dataset_format(i, NULL, &extensions); ++i)
    known = strcmp(extensions, ".foam") == 0;
  if (!known)
    skip();
  write_openfoam(fixture);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    char text[1024];
    snprintf(text, sizeof text, FOAM("volScalarField", "T") "%s", bad[i]);
    text_file(fixture, "0/T", text);
    snprintf(text, sizeof text, FOAM("volScalarField", "U") "%s", bad[i]);
    text_file(fixture, "0/U", text);
    const char *path = in_folder(fixture, "case.foam");
    TetcastDataset *dataset = read_only(fixture, path, NULL);
    assert_int_equal(fixture->warnings, 1);
    if (!strstr(fixture->warning, "2 arrays are left out: 'T', 'U'"))
      fail_msg("%s", fixture->warning);
    assert_true(value_of(fixture, dataset, NULL, 0) == 1);
    refuse_field(fixture, dataset, "T", TETCAST_ERROR_DATA, "cell array 'T' can't be read: ");
    tetcast_dataset_destroy(&dataset);
    dataset = read_only(fixture, path, "p");
    assert_int_equal(fixture->warnings, 0);
    assert_true(value_of(fixture, dataset, "p", 0) == 1);
    refuse_field(fixture, dataset, "k", TETCAST_ERROR_ARGUMENT, "there are: p (cells), T (cells), U (cells)");
    tetcast_dataset_destroy(&dataset);
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.only = "T";
    fixture->errors = 0;
    assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset), TETCAST_ERROR_DATA);
    assert_complaint(fixture, path, "cell array 'T' can't be read");
    desc.only = NULL;
    desc.step = 1; /* where it is not */
    fixture->warnings = 0;
    assert_int_equal(tetcast_dataset_read(fixture->context, path, &desc, &dataset), TETCAST_OK);
    assert_int_equal(fixture->warnings, 0);
    assert_true(value_of(fixture, dataset, "p", 0) == 3);
    tetcast_dataset_destroy(&dataset);
  }
  remove_openfoam(fixture);
}

#define ARRAY(type, name, more, values)                                                                                \
  "<DataArray type='" type "' Name='" name "' format='ascii' " more ">" values "</DataArray>"
#define VECTOR(name, values) ARRAY("Float64", name, "NumberOfComponents='3'", values)

/* Which array is drawn when none is named, beside one at the points that varies, `good`, and one in the cell, `cell`.
 */
static void test_default(void **state) {
  static const struct {
    const char *points, *cells, *name;
  } cases[] = {{ARRAY("Float64", "phase", "", "0 0 0 0"), "", "good"},
               {ARRAY("Float64", "T", "", "0 1 0 0"), "", "T"},
               {ARRAY("Float64", "hole", "", "nan nan 3 nan"), "", "good"},
               {VECTOR("v", "0 0 0 1 0 0 0 0 0 0 0 0"), "", "good"},
               {"", ARRAY("Int32", "part", "", "7"), "good"}};
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    TetcastDataset *dataset = read_only(fixture, vtu(fixture, cases[i].points, cases[i].cells), NULL);
    TetcastField *field;
    const char *name;
    assert_int_equal(tetcast_dataset_field(dataset, NULL, &field, &name), TETCAST_OK);
    assert_string_equal(name, cases[i].name);
    tetcast_field_destroy(&field);
    tetcast_dataset_destroy(&dataset);
  }
  /* Two tetrahedra and a triangle, without `good`: what varies in cells that are drawn. */
  static const struct {
    const char *attributes, *name;
  } others[] = {
      {"<PointData>" ARRAY("Float32", "a", "", "1 1 1 1 1") "</PointData><CellData>" ARRAY("Float32", "b", "",
                                                                                           "1 2 2") "</CellData>",
       "b"},
      {"<PointData>" ARRAY("Float32", "a", "", "1 1 1 1 1") "</PointData><CellData>" ARRAY("Float32", "b", "",
                                                                                           "1 1 2") "</CellData>",
       "a"},
      {"<PointData>" VECTOR("a", "1 2 3 1 2 3 1 2 3 1 2 3 2 1 3") "</PointData><CellData>" ARRAY("Float32", "b", "",
                                                                                                 "1 2 2") "</CellData>",
       "b"},
      {"<PointData>" VECTOR("a", "1 2 3 1 2 3 1 2 3 1 2 3 9 9 9") "</PointData><CellData>" ARRAY("Float32", "b", "",
                                                                                                 "1 1 2") "</CellData>",
       "a"},
      {"<PointData>" VECTOR("a", "1 2 3 1 2 3 1 2 3 1 2 3 9 9 9") "</PointData><CellData>" ARRAY("Float32", "b", "",
                                                                                                 "1 2 2") "</CellData>",
       "a"},
      {"<PointData>" VECTOR("a", "1 2 3 1 2 3 1 2 3 1 2 3 9 9 9") ARRAY(
           "Float32", "s", "", "1 1 1 1 2") "</PointData><CellData>" ARRAY("Float32", "b", "", "1 2 2") "</CellData>",
       "s"},
      {"<PointData Scalars='a'>" ARRAY("Float32", "a", "", "1 1 1 1 1")
           ARRAY("Float32", "c", "", "1 2 3 4 5") "</PointData>",
       "a"},
      {"<PointData GlobalIds='a'>" ARRAY("Int64", "a", "", "1 2 3 4 5")
           ARRAY("Float32", "c", "", "1 1 1 1 1") "</PointData>",
       "c"}};
  for (size_t i = 0; i < sizeof others / sizeof *others; ++i) {
    char text[4096];
    snprintf(text, sizeof text,
             "<VTKFile type='UnstructuredGrid' version='0.1' byte_order='LittleEndian'><UnstructuredGrid><Piece "
             "NumberOfPoints='5' NumberOfCells='3'>%s"
             "<Points>" VECTOR("Points", "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1") "</Points><Cells>" ARRAY(
                 "Int32", "connectivity", "", "0 1 2 3 1 2 3 4 0 1 2") ARRAY("Int32", "offsets", "", "4 8 11")
                 ARRAY("UInt8", "types", "", "10 10 5") "</Cells></Piece></UnstructuredGrid></VTKFile>",
             others[i].attributes);
    TetcastDataset *dataset = read_only(fixture, text_file(fixture, "o.vtu", text), NULL);
    TetcastField *field;
    const char *name;
    assert_int_equal(tetcast_dataset_field(dataset, NULL, &field, &name), TETCAST_OK);
    if (strcmp(name, others[i].name) != 0)
      fail_msg("%s instead of %s of case %zu", name, others[i].name, i);
    tetcast_field_destroy(&field);
    tetcast_dataset_destroy(&dataset);
  }
}

/* Arrays of one name at the points and in the cells, components by name. */
static void test_selectors(void **state) {
  static const struct {
    const char *selector, *again;
    double value; /* of the first point or tetrahedron */
  } good[] = {{"p", "p", 6},
              {"p:point", "p", 6},
              {"p:cell", "p:cell", 60},
              {"v:x", "v:0", 3},
              {"v:Y", "v:1", 4},
              {"v:z", "v:2", 12},
              {"v:mag", "v:mag", 13},
              {"v:cell:x", "v:cell:0", 30},
              {"v:x:cell", "v:cell:0", 30},
              {"v:cell:mag", "v:cell:mag", 50},
              {"v:point:2", "v:2", 12},
              {"v:cell", "v:cell", 50},
              {"n:b", "n:1", 2},
              {"n:0", "n:0", 1},
              {"t:yz", "t:4", 5},
              {"good:0", "good:0", 1},
              {"good:point", "good", 1},
              {"cell:cell", "cell", 5},
              {"w:y", "w:y", 8}};
  static const char *const bad[] = {"v:w",       "v:xx",       "n:x", "t:zz:x", "p:cell:point",
                                    "good:cell", "cell:point", "v:",  "p:x",    "t:x"};
  Fixture *fixture = *state;
  const char *path =
      vtu(fixture,
          ARRAY("Float64", "p", "", "6 7 8 9") VECTOR("v", "3 4 12 0 0 0 0 0 0 0 0 0")
              ARRAY("Int8", "n", "NumberOfComponents='2' ComponentName0='a' ComponentName1='B'", "1 2 3 4 5 6 7 8")
                  ARRAY("Int8", "w:y", "", "8 8 8 9")
                      ARRAY("Int8", "t", "NumberOfComponents='6'", "1 2 3 4 5 6 1 2 3 4 5 6 1 2 3 4 5 6 1 2 3 4 5 6"),
          ARRAY("Float64", "p", "", "60") VECTOR("v", "30 0 40"));
  TetcastDataset *dataset = read_only(fixture, path, NULL);
  assert_int_equal(fixture->warnings, 0);
  for (size_t i = 0; i < sizeof good / sizeof *good; ++i) {
    TetcastField *field;
    const char *again;
    fixture->message[0] = '\0';
    if (tetcast_dataset_field(dataset, good[i].selector, &field, &again) != TETCAST_OK)
      fail_msg("%s: %s", good[i].selector, fixture->message);
    assert_string_equal(again, good[i].again);
    assert_true(tetcast_field_value(field, 0) == good[i].value);
    tetcast_field_destroy(&field);
    assert_true(value_of(fixture, dataset, again, 0) == good[i].value);
  }
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
    refuse_field(fixture, dataset, bad[i], TETCAST_ERROR_ARGUMENT, "there are: ");
  TetcastDatasetArray array;
  int apart = 0;
  for (int i = 0; tetcast_dataset_array(dataset, i, &array); ++i) {
    const bool twin =
        array.association == TETCAST_CELL && (strcmp(array.name, "p") == 0 || strcmp(array.name, "v") == 0);
    char expected[64];
    snprintf(expected, sizeof expected, "%s%s", array.name, twin ? ":cell" : "");
    assert_string_equal(array.selector, expected);
    apart += twin;
  }
  assert_int_equal(apart, 2);
  tetcast_dataset_destroy(&dataset);
  dataset = read_only(fixture, path, "p:cell"); /* which reads both, as the name is the same */
  assert_true(value_of(fixture, dataset, "p:cell", 0) == 60);
  tetcast_dataset_destroy(&dataset);
}

/* A structured grid of text in two pieces, of which arrays are not the same: VTK takes one's for the other's. */
static void test_structured_pieces(void **state) {
  Fixture *fixture = *state;
  const char *path = text_file(
      fixture, "p.vti",
      "<VTKFile type='ImageData' version='0.1' byte_order='LittleEndian'><ImageData WholeExtent='0 2 0 1 0 1' "
      "Origin='0 0 0' Spacing='1 1 1'>"
      "<Piece Extent='0 1 0 1 0 1'><PointData>" ARRAY("Float32", "a", "", "0 1 2 3 4 5 6 7")
          ARRAY("Float32", "b", "", "0 1 0 1 0 1 0 1") ARRAY("Float32", "only", "", "1 1 1 1 1 1 1 1")
              ARRAY("Float32", "other", "",
                    "1 1 1 1 1 1 1 1") "</PointData></Piece>"
                                       "<Piece Extent='1 2 0 1 0 1'><PointData>" ARRAY("Int32", "other", "",
                                                                                       "1 1 1 1 1 1 1 1")
                                           ARRAY("Float32", "b", "", "1 2 1 2 1 2 1 2") ARRAY(
                                               "Float32", "a", "",
                                               "1 12 3 nan 5 1e50 7 18") "</PointData></Piece></ImageData></VTKFile>");
  TetcastDataset *dataset = read_only(fixture, path, NULL);
  assert_int_equal(fixture->warnings, 1);
  assert_non_null(strstr(fixture->warning, "2 arrays are left out: 'only', 'other'"));
  static const double a[12] = {0, 1, 12, 2, 3, NAN, 4, 5, INFINITY, 6, 7, 18};
  for (int i = 0; i < 12; ++i) {
    const double value = value_of(fixture, dataset, "a", i);
    assert_true(isnan(a[i]) ? isnan(value) : value == a[i]);
    assert_true(value_of(fixture, dataset, "b", i) == i % 3);
  }
  tetcast_dataset_destroy(&dataset);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(test_xml),       TEST(test_strings),          TEST(test_unnamed),  TEST(test_numbers),
      TEST(test_legacy),    TEST(test_no_lookup_table),  TEST(test_openfoam), TEST(test_default),
      TEST(test_selectors), TEST(test_structured_pieces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
