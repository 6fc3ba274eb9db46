/* SPDX-License-Identifier: Apache-2.0 */
/* Gmsh's files: every version and encoding gives the same mesh and arrays; nodes of second order; what is damaged is
 * told where. */
#include "box.h"
#include "gmsh_file.h"

/* A hexahedron with a wedge beside, a pyramid above, and a tetrahedron on that. */
enum { NODES = 12, CELLS = 4, LISTED = 7 };
static const double points[NODES][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},     {1, 0, 1},
                                        {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 0, 1}, {0.5, 0.5, 2}, {1.5, 0.5, 1.5}};
static const double volume = 1 + 0.5 + 1.0 / 3 + 0.125;

static int64_t tag_of(int64_t i, bool sparse) {
  return sparse ? 1000 - 7 * i : i + 1;
}

static const int group_of[2] = {3, 0};

/* A triangle first; the wedge is in two groups, so version 2 lists it twice. */
static void write_mesh(GmshFile *to, bool sparse, int parameters) {
  static const int64_t at[LISTED][8] = {{0, 1, 4},          {0, 1, 2, 3, 4, 5, 6, 7}, {1, 8, 2, 5, 9, 6},
                                        {1, 8, 2, 5, 9, 6}, {4, 5, 6, 7, 10},         {5, 6, 10, 11},
                                        {1, 2, 3}};
  static const int sizes[LISTED] = {3, 8, 6, 6, 5, 4, 3}, types[LISTED] = {2, 5, 6, 6, 7, 4, 2},
                   volumes[LISTED] = {1, 1, 1, 1, 2, 2, 1};
  int64_t tags[NODES], node[LISTED][8];
  GmshElement elements[LISTED];
  int64_t count = 0;
  for (int64_t i = 0; i < NODES; ++i)
    tags[i] = tag_of(i, sparse);
  for (int i = 0; i < LISTED; ++i) {
    if (i == 3 && to->version == 4)
      continue;
    for (int k = 0; k < sizes[i]; ++k)
      node[i][k] = tag_of(at[i][k], sparse);
    elements[count++] = (GmshElement){tag_of(i, sparse),
                                      types[i],
                                      sizes[i],
                                      volumes[i],
                                      i == 3 ? 99 : types[i] == 2 ? 0 : group_of[volumes[i] - 1],
                                      node[i]};
  }
  gmsh_text(to, "$PhysicalNames\n1\n3 3 \"air $End of it\"\n$EndPhysicalNames\n");
  gmsh_entities(to, 2, group_of);
  gmsh_nodes(to, NODES, tags, points, parameters);
  gmsh_elements(to, count, elements);
}

static void write_views(GmshFile *to, bool sparse) {
  int64_t tags[NODES], cells[CELLS];
  static const int place[CELLS] = {1, 2, 4, 5}; /* of the four cells among those listed */
  double s[NODES], v[NODES][3], c[CELLS];
  for (int64_t i = 0; i < NODES; ++i) {
    tags[i] = tag_of(i, sparse);
    s[i] = points[i][0] + 2 * points[i][1] + 4 * points[i][2];
    for (int k = 0; k < 3; ++k)
      v[i][k] = points[i][k];
  }
  for (int i = 0; i < CELLS; ++i)
    cells[i] = tag_of(place[i], sparse), c[i] = 10 + i;
  gmsh_data(to, "NodeData", "s", 0, 1, NODES, tags, 0, s);
  for (int i = 0; i < NODES; ++i)
    s[i] *= 2;
  gmsh_data(to, "NodeData", "s", 1.5, 1, NODES, tags, 0, s);
  gmsh_data(to, "NodeData", "v", 0, 3, NODES - 1, tags + 1, 0, v[1]);
  gmsh_data(to, "ElementData", "c", 0, 1, CELLS, cells, 0, c);
  const double corners[2][8] = {{1, 2, 3, 4, 5, 6, 7, 8}, {10, 20, 30, 40, 50, 60, 70, 80}};
  gmsh_data(to, "ElementNodeData", "hex", 0, 1, 1, cells, 8, corners[0]);
  gmsh_data(to, "ElementNodeData", "wedge", 0, 1, 1, cells + 1, 6, corners[1]);
}

static double value(const TetcastDataset *dataset, const char *selector, int64_t i) {
  TetcastField *field;
  assert_int_equal(tetcast_dataset_field(dataset, selector, &field, NULL), TETCAST_OK);
  const double result = tetcast_field_value(field, i);
  tetcast_field_destroy(&field);
  return result;
}

static void check(Fixture *fixture, const TetcastDataset *dataset, double scale) {
  TetcastMesh *mesh;
  TetcastMeshHealth health;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume / volume - 1) < 1e-12);
  assert_int_equal(health.inverted_cells, 0);
  assert_int_equal(health.components, 1);
  for (int i = 0; i < NODES; ++i) {
    double p[3];
    tetcast_mesh_vertex(mesh, i, p);
    for (int k = 0; k < 3; ++k)
      assert_true(p[k] == points[i][k]);
    assert_true(value(dataset, "s", i) == scale * (p[0] + 2 * p[1] + 4 * p[2]));
    assert_true(i == 0 ? isnan(value(dataset, "v:1", i)) : value(dataset, "v:1", i) == p[1]);
  }
  const int64_t count = tetcast_mesh_tetrahedron_count(mesh);
  for (int64_t i = 0; i < count; ++i) {
    int64_t v[4];
    tetcast_mesh_tetrahedron(mesh, i, v);
    double x = 0, z = 0;
    for (int k = 0; k < 4; ++k)
      x += points[v[k]][0] / 4, z += points[v[k]][2] / 4;
    const int cell = i == count - 1 ? 3 : z > 1 ? 2 : x > 1 ? 1 : 0;
    assert_true(value(dataset, "c", i) == 10 + cell);
    assert_true(value(dataset, "physical", i) == (cell < 2 ? 3 : 0));
  }
  assert_true(value(dataset, "hex", 6) == 7 && isnan(value(dataset, "hex", 8)));
  assert_true(value(dataset, "wedge", 2) == 30 && value(dataset, "wedge", 9) == 50 &&
              isnan(value(dataset, "wedge", 0)));
  tetcast_mesh_destroy(&mesh);
}

static void test_variants(void **state) {
  Fixture *fixture = *state;
  for (int version = 2; version <= 4; version += 2) {
    for (int encoding = GMSH_TEXT; encoding <= GMSH_BIG; ++encoding) {
      for (int variant = 0; variant < 4; ++variant) {
        const bool sparse = variant % 2;
        GmshFile to = gmsh_open(in_folder(fixture, "a.msh"), version, (GmshEncoding)encoding);
        write_mesh(&to, sparse, variant);
        write_views(&to, sparse);
        fclose(to.file);
        for (int step = 0; step < 2; ++step) {
          TetcastDataset *dataset = read_with(fixture, fixture->path, step ? of_time(1.5) : of_step(0));
          assert_int_equal(tetcast_dataset_cell_count(dataset), CELLS + 2);
          assert_int_equal(tetcast_dataset_step(dataset), step);
          check(fixture, dataset, 1 + step);
          tetcast_dataset_destroy(&dataset);
        }
        refuse_with(fixture, fixture->path, of_step(2), "no time step 2; there are steps 0 to 1");
      }
    }
  }
}

/* Subdivision is of curved cells, and neither too fine nor negative. */
static void test_subdivision(void **state) {
  Fixture *fixture = *state;
  static const int wrong[] = {-1, TETCAST_MAX_SUBDIVISION + 1};
  GmshFile to = gmsh_open(in_folder(fixture, "a.msh"), 2, GMSH_TEXT);
  write_mesh(&to, false, 0);
  fclose(to.file);
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  for (int i = 0; i < 2; ++i) {
    TetcastDataset *dataset;
    desc.subdivision = wrong[i];
    assert_int_equal(tetcast_dataset_read(fixture->context, fixture->path, &desc, &dataset), TETCAST_ERROR_ARGUMENT);
    assert_null(dataset);
  }
  desc.subdivision = 3;
  TetcastDataset *dataset = read_with(fixture, fixture->path, desc);
  assert_int_equal(tetcast_dataset_cut(dataset).curved, 0);
  tetcast_dataset_destroy(&dataset);
}

/* The ends of the edges, and corners of the faces, that Gmsh has nodes in the middle of, in its order. */
static const struct {
  int type, corners, edges, faces;
  bool centre;
  int edge[12][2], face[6][4];
  double p[8][3], volume;
} second_order[] = {
    {11,
     4,
     6,
     0,
     false,
     {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}},
     {{0}},
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
     1.0 / 6},
    {17,
     8,
     12,
     0,
     false,
     {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}},
     {{0}},
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
     1},
    {12,
     8,
     12,
     6,
     true,
     {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}},
     {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}},
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
     1},
    {18,
     6,
     9,
     0,
     false,
     {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}},
     {{0}},
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
     0.5},
    {13,
     6,
     9,
     3,
     false,
     {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}},
     {{0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}},
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
     0.5},
    {19,
     5,
     8,
     0,
     false,
     {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}},
     {{0}},
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
     1.0 / 3},
    {14,
     5,
     8,
     1,
     false,
     {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}},
     {{0, 3, 2, 1}},
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
     1.0 / 3},
};

static void test_second_order(void **state) {
  Fixture *fixture = *state;
  for (size_t i = 0; i < sizeof second_order / sizeof *second_order; ++i) {
    double p[27][3];
    int64_t tags[27], count = 0;
    for (; count < second_order[i].corners; ++count)
      memcpy(p[count], second_order[i].p[count], sizeof p[0]);
    for (int e = 0; e < second_order[i].edges; ++e, ++count) {
      const int *end = second_order[i].edge[e];
      for (int k = 0; k < 3; ++k)
        p[count][k] = (p[end[0]][k] + p[end[1]][k]) / 2;
    }
    for (int f = 0; f < second_order[i].faces; ++f, ++count) {
      const int *corner = second_order[i].face[f];
      for (int k = 0; k < 3; ++k)
        p[count][k] = (p[corner[0]][k] + p[corner[1]][k] + p[corner[2]][k] + p[corner[3]][k]) / 4;
    }
    for (int k = 0; second_order[i].centre && k < 3; ++k)
      p[26][k] = 0.5;
    count += second_order[i].centre;
    for (int64_t k = 0; k < count; ++k)
      tags[k] = k + 1;
    const GmshElement element = {1, second_order[i].type, (int)count, 1, 0, tags};
    for (int version = 2; version <= 4; version += 2) {
      GmshFile to = gmsh_open(in_folder(fixture, "b.msh"), version, GMSH_LITTLE);
      gmsh_nodes(&to, count, tags, (const double(*)[3])p, 0);
      gmsh_elements(&to, 1, &element);
      fclose(to.file);
      TetcastDataset *dataset = read_with(fixture, fixture->path, tetcast_dataset_desc_default());
      TetcastMesh *mesh;
      TetcastMeshHealth health;
      assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
      assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
      const TetcastCutInfo info = tetcast_dataset_cut(dataset);
      if (fabs(health.volume / second_order[i].volume - 1) > 1e-12 || health.inverted_cells ||
          health.degenerate_cells || health.unused_vertices || info.folded || info.segments[0] != 2) {
        print_error("type %d: volume %g, %d inverted\n", second_order[i].type, health.volume,
                    (int)health.inverted_cells);
        fail();
      }
      tetcast_mesh_destroy(&mesh);
      tetcast_dataset_destroy(&dataset);
    }
  }
}

#define HEAD "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define FOUR "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
#define ONE  "$Elements\n1\n1 4 2 7 1 1 2 3 4\n$EndElements\n"

static void test_errors(void **state) {
  Fixture *fixture = *state;
  static const struct {
    const char *text;
    TetcastStatus status;
    const char *words;
  } cases[] = {
      {"$MeshFormat\n4 0 8\n$EndMeshFormat\n", TETCAST_ERROR_UNSUPPORTED, "version 4 of Gmsh's format"},
      {"$MeshFormat\n1 0 8\n$EndMeshFormat\n", TETCAST_ERROR_UNSUPPORTED, "version 1 of"},
      {"$MeshFormat\n2.2 1 4\n$EndMeshFormat\n", TETCAST_ERROR_DATA, "numbers of 8 bytes"},
      {"$MeshFormat\n2.2 0", TETCAST_ERROR_DATA, "line 2: truncated: the size of numbers is to come"},
      {HEAD, TETCAST_ERROR_DATA, "holds no elements"},
      {HEAD "$Nodes\n1152921504606846976\n1 0 0 0\n$EndNodes\n", TETCAST_ERROR_DATA,
       "line 5: claims 1152921504606846976 nodes"},
      {HEAD "$Nodes\n-1\n$EndNodes\n", TETCAST_ERROR_DATA, "claims -1 nodes"},
      {HEAD "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n", TETCAST_ERROR_DATA, "two nodes of number 1"},
      {HEAD "$Nodes\n1\n1 0 x 0\n$EndNodes\n", TETCAST_ERROR_DATA, "line 6: a coordinate expected, not 'x'"},
      {HEAD "$Nodes\n2\n1 0 0 0\n$EndNodes\n", TETCAST_ERROR_DATA,
       "line 7: the number of a node expected, not '$EndNodes'"},
      {HEAD "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n", TETCAST_ERROR_DATA, "line 7: section $Nodes is to end here"},
      {HEAD ONE, TETCAST_ERROR_DATA, "there are no nodes before the elements"},
      {HEAD FOUR "$Elements\n1\n1 4 2 7 1 1 2 3 5\n$EndElements\n", TETCAST_ERROR_DATA,
       "element 1 is of node 5, which there is not"},
      {HEAD FOUR "$Elements\n9999\n1 4 2 7 1 1 2 3 4\n$EndElements\n", TETCAST_ERROR_DATA, "claims 9999 elements"},
      {HEAD FOUR "$Elements\n1\n1 2 2 7 1 1 2 3\n$EndElements\n", TETCAST_ERROR_DATA,
       "holds no volumetric cells, only 1 × triangle"},
      {HEAD FOUR ONE ONE, TETCAST_ERROR_DATA, "second section $Elements"},
      {HEAD FOUR ONE "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n1\n1 2\n$EndNod", TETCAST_ERROR_DATA,
       "section $NodeData does not end"},
      {HEAD FOUR "$Elements\n1\n1 90 2 7 1 1 2 3 4\n$EndElements\n", TETCAST_ERROR_UNSUPPORTED,
       "type 90, which are not read: above second order only"},
      {HEAD FOUR "$Elements\n1\n1 99 2 7 1 1 2 3 4\n$EndElements\n", TETCAST_ERROR_UNSUPPORTED,
       "elements of Gmsh's type 99"},
      {"MESH dimension 3 ElemType Tetrahedra Nnode 4\n", TETCAST_ERROR_DATA, "is not a Gmsh file"},
      {"\n", TETCAST_ERROR_DATA, "is not a Gmsh file"},
      {"$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 7 1 5 1 2 3 4\n$ENDELM\n",
       TETCAST_ERROR_DATA, "element 1 has not the 4 nodes of its type"},
      {"$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNOD\n", TETCAST_ERROR_DATA,
       "section $NOD is to end here, with '$ENDNOD'"},
      {HEAD FOUR ONE "$Periodic\n", TETCAST_ERROR_DATA, "section $Periodic does not end"},
      {HEAD FOUR ONE "nonsense\n", TETCAST_ERROR_DATA, "a section is to begin here"},
      {"$MeshFormat\n2.2 1 8\nabcd\n$EndMeshFormat\n", TETCAST_ERROR_DATA, "byte 24: the number 1 is to come"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
    read_bad(fixture, text_file(fixture, "c.msh", cases[i].text), cases[i].status, cases[i].words);
  read_bad(fixture, text_file(fixture, "d.msh", "(0 \"of another program\")\n"), TETCAST_ERROR_DATA,
           "is not a Gmsh file");
  TetcastDataset *dataset =
      read_good(fixture, text_file(fixture, "noname", "$Comments\nany\n$EndComments\n" HEAD FOUR ONE));
  assert_true(value(dataset, NULL, 0) == 7); /* the group */
  tetcast_dataset_destroy(&dataset);
}

/* A view that can't be read is left out, and told of where it was asked for. */
static void test_bad_views(void **state) {
  static const struct {
    const char *view, *words;
  } cases[] = {
      {"$NodeData\n1\n\"bad\"\n1\n0\n3\n0\n1\n1\n5 1\n$EndNodeData\n", "line 24: a value is of node 5"},
      {"$NodeData\n1\n\"bad\"\n1\n0\n3\n0\n1000000\n1\n1 1\n$EndNodeData\n", "values of 1000000 components"},
      {"$NodeData\n1\n\"bad\"\n1\n0\n3\n0\n1\n77\n1 1\n$EndNodeData\n", "claims 77 values"},
      {"$ElementData\n1\n\"bad\"\n1\n0\n3\n0\n1\n1\n1 x\n$EndElementData\n", "a value expected, not 'x'"},
      {"$ElementNodeData\n1\n\"bad\"\n1\n0\n3\n0\n1\n1\n1 5 1 2 3 4 5\n$EndElementNodeData\n", "has values at 5"}};
  Fixture *fixture = *state;
  char text[2048];
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    snprintf(text, sizeof text,
             HEAD FOUR ONE "%s$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n4\n1 6\n2 7\n3 8\n4 9\n$EndNodeData\n",
             cases[i].view);
    fixture->warnings = 0;
    TetcastDataset *dataset = read_good(fixture, text_file(fixture, "v.msh", text));
    assert_int_equal(fixture->warnings, 1);
    if (!strstr(fixture->warning, "array 'bad' is left out") || !strstr(fixture->warning, cases[i].words))
      fail_msg("%s", fixture->warning);
    assert_true(value(dataset, "s", 3) == 9 && value(dataset, "physical", 0) == 7);
    TetcastField *field;
    assert_int_equal(tetcast_dataset_field(dataset, "bad", &field, NULL), TETCAST_ERROR_DATA);
    tetcast_dataset_destroy(&dataset);
    TetcastDatasetDesc desc = tetcast_dataset_desc_default();
    desc.only = "s";
    dataset = read_with(fixture, fixture->path, desc);
    assert_int_equal(fixture->warnings, 0);
    assert_true(value(dataset, NULL, 0) == 6);
    assert_int_equal(tetcast_dataset_field(dataset, "physical", &field, NULL), TETCAST_ERROR_ARGUMENT);
    tetcast_dataset_destroy(&dataset);
  }
}

/* The first version of the format, and text whose header has another size of numbers. */
static void test_old(void **state) {
  Fixture *fixture = *state;
  TetcastDataset *dataset =
      read_good(fixture, text_file(fixture, "o.msh",
                                   "$NOD\n5\n10 0 0 0\n20 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$ENDNOD\n$ELM\n3\n1 2 9 1 "
                                   "3 10 20 3\n7 4 7 1 4 10 20 3 4\n8 4 8 2 4 20 3 4 5\n$ENDELM\n"));
  assert_int_equal(tetcast_dataset_cell_count(dataset), 3);
  assert_true(value(dataset, "physical", 0) == 7 && value(dataset, "physical", 1) == 8);
  TetcastMesh *mesh;
  TetcastMeshHealth health;
  assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
  assert_true(fabs(health.volume - 0.5) < 1e-12);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  dataset = read_good(fixture, text_file(fixture, "o.msh", "$MeshFormat\n2.2 0 4\n$EndMeshFormat\n" FOUR ONE));
  tetcast_dataset_destroy(&dataset);
}

/* Where the nodes of third order are, in thirds, as the reference manual draws them. */
static const int tetrahedron_3[20][3] = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                         {1, 2, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 2}, {0, 0, 1}, {0, 1, 2}, {0, 2, 1},
                                         {1, 0, 2}, {2, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};

/* A hexahedron's corners, then the nodes within edges, faces, and the inside, each from its first corner on as the
 * manual lists these. */
static int hexahedron_place(int i, int axis) {
  static const int corner[8][3] = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0},
                                   {0, 0, 3}, {3, 0, 3}, {3, 3, 3}, {0, 3, 3}};
  static const int edge[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                  {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  static const int face[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};
  if (i < 8)
    return corner[i][axis];
  if (i < 32) { /* two of each */
    const int *ends = edge[(i - 8) / 2], step = 1 + (i - 8) % 2;
    return (corner[ends[0]][axis] * (3 - step) + corner[ends[1]][axis] * step) / 3;
  }
  if (i < 56) { /* four of each: near each of its corners */
    const int *of = face[(i - 32) / 4], k = (i - 32) % 4;
    const int a = corner[of[k]][axis], b = corner[of[(k + 1) % 4]][axis], d = corner[of[(k + 3) % 4]][axis];
    return a + (b - a) / 3 + (d - a) / 3;
  }
  return corner[i - 56][axis] ? 2 : 1;
}

static double cubic(const double p[3]) {
  return 1 + p[0] - 2 * p[1] * p[2] + 3 * p[0] * p[0] * p[1] - p[2] * p[2] * p[2];
}

/* A cell of third order has a cubic function exactly, wherever it is cut; and so has one whose nodes were listed by
 * Gmsh. */
static void test_third_order(void **state) {
  Fixture *fixture = *state;
  for (int shape = 0; shape < 2; ++shape) {
    const int count = shape ? 64 : 20;
    double p[64][3], values[64];
    int64_t tags[64];
    for (int i = 0; i < count; ++i) {
      tags[i] = i + 1;
      for (int k = 0; k < 3; ++k)
        p[i][k] = shape ? hexahedron_place(i, k) / 3.0 : tetrahedron_3[i][k] / 3.0;
      values[i] = cubic(p[i]);
    }
    const GmshElement element = {1, shape ? 92 : 29, count, 1, 0, tags};
    for (int encoding = GMSH_TEXT; encoding <= GMSH_BIG; ++encoding) {
      GmshFile to = gmsh_open(in_folder(fixture, "t.msh"), 4, (GmshEncoding)encoding);
      gmsh_nodes(&to, count, tags, (const double(*)[3])p, 0);
      gmsh_elements(&to, 1, &element);
      gmsh_data(&to, "NodeData", "s", 0, 1, count, tags, 0, values);
      fclose(to.file);
      for (int subdivision = 0; subdivision < 8; subdivision += 7) {
        TetcastDatasetDesc desc = tetcast_dataset_desc_default();
        desc.subdivision = subdivision;
        TetcastDataset *dataset = read_with(fixture, fixture->path, desc);
        TetcastMesh *mesh;
        TetcastField *s;
        TetcastMeshHealth health;
        assert_int_equal(tetcast_dataset_mesh(dataset, &mesh), TETCAST_OK);
        assert_int_equal(tetcast_mesh_health(fixture->context, mesh, &health), TETCAST_OK);
        assert_true(fabs(health.volume - (shape ? 1 : 1.0 / 6)) < 1e-12);
        assert_int_equal(health.degenerate_cells + health.inverted_cells + health.nonmanifold_faces, 0);
        assert_int_equal(tetcast_dataset_field(dataset, "s", &s, NULL), TETCAST_OK);
        for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh); ++i) {
          double at[3];
          tetcast_mesh_vertex(mesh, i, at);
          assert_true(fabs(tetcast_field_value(s, i) - cubic(at)) < 1e-12);
        }
        tetcast_field_destroy(&s);
        tetcast_mesh_destroy(&mesh);
        tetcast_dataset_destroy(&dataset);
      }
    }
  }
}

/* The parts that partitions have of an entity say which groups they are in. */
static void test_partitions(void **state) {
  Fixture *fixture = *state;
  static const char text[] =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 5 0\n$EndEntities\n"
      "$PartitionedEntities\n2\n1\n9 2\n1 0 0 2\n7 0 3 1 1 0 0 0 0\n2 3 1 1 1 0 0 0 1 1 1 1 5 1 7\n3 3 1 2 1 2 0 0 0 1 "
      "1 1 2 6 5 0\n$EndPartitionedEntities\n"
      "$Nodes\n1 5 1 5\n3 2 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
      "$Elements\n2 2 1 2\n3 2 4 1\n1 1 2 3 4\n3 3 4 1\n2 2 3 4 5\n$EndElements\n$GhostElements\n1\n2 2 1 "
      "1\n$EndGhostElements\n";
  TetcastDataset *dataset = read_good(fixture, text_file(fixture, "p.msh", text));
  assert_true(value(dataset, "physical", 0) == 5 && value(dataset, "physical", 1) == 6);
  tetcast_dataset_destroy(&dataset);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(test_variants),   TEST(test_subdivision), TEST(test_second_order),
                                     TEST(test_partitions), TEST(test_errors),      TEST(test_bad_views),
                                     TEST(test_old),        TEST(test_third_order)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
