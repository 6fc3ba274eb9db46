/* SPDX-License-Identifier: Apache-2.0 */
/* The formats of meshes that are read here and not by VTK, and lists of files. FUZZ_FORMAT is one of those below. */
#include <stdbool.h>
#include <string.h>

#include <tetcast/dataset.h>
#include <tetcast/scene.h>
#include <tetcast/volume.h>

#include "fuzz.h"

#define GMSH 1
#define TETGEN 2
#define SERIES 3
#define PVD 4

#define MESH                                                                                                                               \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"                              \
  "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 7 1 2 3 4 5\n$EndElements\n"

const char *const fuzz_seeds[] = {
#if FUZZ_FORMAT == GMSH
  MESH "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n2\n1 3\n2 4\n$EndNodeData\n$ElementData\n1\n\"e\"\n1\n1\n3\n1\n3\n1\n2 1 2 3\n$EndElementData\n"
       "$ElementNodeData\n1\n\"c\"\n1\n0\n3\n0\n1\n1\n1 4 1 2 3 4\n$EndElementNodeData\n",
  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 9 \"a\"\n$EndPhysicalNames\n$Entities\n1 0 0 1\n7 0 0 0 0\n1 0 0 0 1 1 1 1 9 1 -2\n"
  "$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n",
  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n1\n0\n0 0 0 1\n1 3 1 1 1 0 0 0 1 1 1 1 9 0\n$EndPartitionedEntities\n",
  "$Comments\nx\n$EndComments\n$MeshFormat\n2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n"
  "9 0 .5 .5\n10 .5 0 .5\n$EndNodes\n$Elements\n1\n1 11 0 1 2 3 4 5 6 7 8 9 10\n$EndElements\n",
#elif FUZZ_FORMAT == TETGEN
  "5 3 1 1\n1 0 0 0 5 0\n2 1 0 0 6 0\n3 0 1 0 7 1\n4 0 0 1 8 1\n5 1 1 1 8 1\n%2 4 1\n1 1 2 3 4 9\n2 2 3 4 5 9\n",
  "# of points\n4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n%1 4\n0 0 1 2 3\n",
#elif FUZZ_FORMAT == SERIES
  "{\"file-series-version\": \"1.0\", \"files\": [{\"name\": \"part.msh\", \"time\": 1}, {\"name\": \"p\\u0061rt.msh\", \"time\": 2e1}],"
  " \"x\": [true, null, [{}], -1.5e-3, \"\\ud83d\\ude00\\n\"]}\n",
#else
  "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection><DataSet timestep=\"0.5\" part=\"0\" file=\"part.msh\"/>"
  "<DataSet timestep=\"2\" file=\"part.msh\"/></Collection></VTKFile>\n",
#endif
  NULL};

static TetcastContext *context;

static const char *write_input(const uint8_t *data, size_t size) {
#if FUZZ_FORMAT == GMSH
  return fuzz_file("in.msh", data, size);
#elif FUZZ_FORMAT == TETGEN
  const uint8_t *mark = memchr(data, '%', size); /* points, then tetrahedra */
  const size_t first = mark ? (size_t)(mark - data) : size, next = mark ? first + 1 : size;
  fuzz_file("in.ele", data + next, size - next);
  return fuzz_file("in.node", data, first);
#elif FUZZ_FORMAT == SERIES
  return fuzz_file("in.vtu.series", data, size);
#else
  return fuzz_file("in.pvd", data, size);
#endif
}

/* Content tells the format, and those of others end in VTK's readers. */
static bool is_ours(const uint8_t *data, size_t size) {
#if FUZZ_FORMAT == GMSH
  return size > 0 && data[0] == '$';
#elif FUZZ_FORMAT == TETGEN
  return size > 0 && (strchr("0123456789 -%\n", data[0]) || (size > 2 && memcmp(data, "# v", 3) != 0 && data[0] == '#'));
#elif FUZZ_FORMAT == SERIES
  return size > 0 && data[0] == '{';
#else
  static const char kind[] = "<VTKFile type=\"Collection\"";
  const size_t length = sizeof kind - 1;
  return size > 64 && (memcmp(data, kind, length) == 0 || memcmp(data + 22, kind, length) == 0);
#endif
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!context) {
    const TetcastContextDesc desc = {.cookie = tetcast_context_desc_default().cookie, .threads = 1};
    if (tetcast_context_create(&desc, &context) != TETCAST_OK) return 0;
    fuzz_file("part.msh", MESH, sizeof MESH - 1);
  }
  if (!is_ours(data, size)) return 0;
  TetcastDataset *dataset;
  if (tetcast_dataset_read(context, write_input(data, size), NULL, &dataset) != TETCAST_OK) return 0;
  TetcastMesh *mesh;
  TetcastVolume *volume;
  TetcastField *field;
  TetcastScene *scene;
  if (tetcast_dataset_mesh(dataset, &mesh) == TETCAST_OK && tetcast_volume_create(context, mesh, NULL, &volume) == TETCAST_OK) {
    if (tetcast_scene_create(context, volume, &scene) == TETCAST_OK) {
      if (tetcast_dataset_field(dataset, NULL, &field, NULL) == TETCAST_OK) tetcast_scene_set_field(scene, field);
      tetcast_field_destroy(&field);
      tetcast_scene_destroy(&scene);
    }
    tetcast_volume_destroy(&volume);
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  return 0;
}
