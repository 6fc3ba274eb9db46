/* SPDX-License-Identifier: Apache-2.0 */
/* The formats of meshes whose texts are read here and not by VTK alone, and lists of files. FUZZ_FORMAT is one of those
 * below. */
#include <stdbool.h>
#include <string.h>

#include <tetcast/dataset.h>
#include <tetcast/scene.h>
#include <tetcast/volume.h>

#include "fuzz.h"

#define GMSH   1
#define TETGEN 2
#define SERIES 3
#define PVD    4
#define LEGACY 5
#define XML    6

#define MESH                                                                                                           \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"          \
  "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 7 1 2 3 4 5\n$EndElements\n"

const char *const fuzz_seeds[] = {
#if FUZZ_FORMAT == GMSH
    MESH "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n2\n1 3\n2 4\n$EndNodeData\n$ElementData\n1\n\"e\"\n1\n1\n3\n1\n3\n1\n2 1 "
         "2 3\n$EndElementData\n"
         "$ElementNodeData\n1\n\"c\"\n1\n0\n3\n0\n1\n1\n1 4 1 2 3 4\n$EndElementNodeData\n",
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 9 \"a\"\n$EndPhysicalNames\n$Entities\n1 0 0 1\n7 0 0 "
    "0 0\n1 0 0 0 1 1 1 1 9 1 -2\n"
    "$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 "
    "1 4 1\n1 1 2 3 4\n$EndElements\n",
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n1\n0\n0 0 0 1\n1 3 1 1 1 0 0 0 1 1 1 1 9 "
    "0\n$EndPartitionedEntities\n",
    "$Comments\nx\n$EndComments\n$MeshFormat\n2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 "
    ".5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n"
    "9 0 .5 .5\n10 .5 0 .5\n$EndNodes\n$Elements\n1\n1 11 0 1 2 3 4 5 6 7 8 9 10\n$EndElements\n",
    "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 7 7 4 1 2 3 4\n$ENDELM\n",
#elif FUZZ_FORMAT == TETGEN
    "5 3 1 1\n1 0 0 0 5 0\n2 1 0 0 6 0\n3 0 1 0 7 1\n4 0 0 1 8 1\n5 1 1 1 8 1\n%2 4 1\n1 1 2 3 4 9\n2 2 3 4 5 9\n",
    "# of points\n4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n%1 4\n0 0 1 2 3\n",
#elif FUZZ_FORMAT == SERIES
    "{\"file-series-version\": \"1.0\", \"files\": [{\"name\": \"part.msh\", \"time\": 1}, {\"name\": "
    "\"p\\u0061rt.msh\", \"time\": 2e1}],"
    " \"x\": [true, null, [{}], -1.5e-3, \"\\ud83d\\ude00\\n\"]}\n",
#elif FUZZ_FORMAT == LEGACY
    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 "
    "1e0\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    "POINT_DATA 4\nSCALARS s float\n1 nan -inf 1e99\nSCALARS c unsigned_char 2\nLOOKUP_TABLE t\n1 2 3 4 5 6 7 "
    "8\nLOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\n"
    "VECTORS v double\n1 2 3 4 5 6 7 8 9 10 11 12\nTENSORS6 t float\n1 2 3 4 5 6 1 2 3 4 5 6 1 2 3 4 5 6 1 2 3 4 5 "
    "6\nNORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0\n"
    "TEXTURE_COORDINATES x 2 float\n1 2 3 4 5 6 7 8\nCOLOR_SCALARS r 3\n1 0 .5 1 0 .5 1 0 .5 1 0 .5\nGLOBAL_IDS g "
    "vtkIdType\n1 2 3 4\nCELL_DATA 1\n"
    "FIELD f 2\na 1 1 int\n7\nb 2 1 string\nx\ny%20z\n",
    "# vtk DataFile Version 5.1\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 "
    "1\nMETADATA\nINFORMATION 1\nNAME k LOCATION vtkDataArray\n"
    "DATA 2 0 1\n\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES "
    "1\n10\nCELL_DATA 1\nFIELD FieldData 1\na 1 1 double\n2\n"
    "METADATA\nCOMPONENT_NAMES\nu\n\n",
    "# vtk DataFile Version 2.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 "
    "1\nPOINT_DATA 8\nSCALARS s short\n1 2 3 4 5 6 7 8\n",
#elif FUZZ_FORMAT == XML
    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\"><UnstructuredGrid><FieldData><Array type=\"String\" Name=\"n\""
    " NumberOfTuples=\"1\" format=\"ascii\">97 98 0 99 0</Array></FieldData><Piece NumberOfPoints=\"4\" "
    "NumberOfCells=\"1\"><PointData Scalars=\"s\"><DataArray"
    " type=\"Float32\" Name=\"s\" format=\"ascii\">1 nan 1e99 4</DataArray><DataArray type=\"Int16\" Name=\"v\" "
    "NumberOfComponents=\"2\" format=\"appended\""
    " offset=\"0\"/><DataArray type=\"String\" Name=\"t\" format=\"ascii\">65 0 66 "
    "0</DataArray></PointData><CellData><DataArray type=\"Float64\" Name=\"c\""
    " format=\"binary\">CAAAAAAAAAAAAAAAAADwPw==</DataArray></CellData><Points><DataArray type=\"Float32\" "
    "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0"
    " 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 "
    "3</DataArray><DataArray type=\"Int32\" Name=\"offsets\""
    " format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
    "format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid><AppendedData"
    " encoding=\"base64\">_EAAAAAAAAAABAAIAAwAEAAUABgAHAAgA</AppendedData></VTKFile>\n",
    "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"BigEndian\"><ImageData WholeExtent=\"0 1 0 1 0 1\" "
    "Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece"
    " Extent=\"0 1 0 1 0 1\"><PointData><DataArray type=\"Int32\" Name=\"s\" format=\"ascii\">1 2 3 4 5 6 7 "
    "8</DataArray></PointData></Piece></ImageData></VTKFile>\n",
#else
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection><DataSet timestep=\"0.5\" "
    "part=\"0\" file=\"part.msh\"/>"
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
#elif FUZZ_FORMAT == LEGACY
  return fuzz_file("in.vtk", data, size);
#elif FUZZ_FORMAT == XML
  return fuzz_file("in.vtu", data, size);
#else
  return fuzz_file("in.pvd", data, size);
#endif
}

/* Content tells the format, and those of others end in VTK's readers. */
static bool is_ours(const uint8_t *data, size_t size) {
#if FUZZ_FORMAT == GMSH
  return size > 0 && data[0] == '$';
#elif FUZZ_FORMAT == TETGEN
  return size > 0 &&
         (strchr("0123456789 -%\n", data[0]) || (size > 2 && memcmp(data, "# v", 3) != 0 && data[0] == '#'));
#elif FUZZ_FORMAT == SERIES
  return size > 0 && data[0] == '{';
#elif FUZZ_FORMAT == LEGACY
  return size > 26 && memcmp(data, "# vtk DataFile Version ", 23) == 0;
#elif FUZZ_FORMAT == XML
  return size > 8 && memcmp(data, "<VTKFile", 8) == 0;
#else
  static const char kind[] = "<VTKFile type=\"Collection\"";
  const size_t length = sizeof kind - 1;
  return size > 64 && (memcmp(data, kind, length) == 0 || memcmp(data + 22, kind, length) == 0);
#endif
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!context) {
    const TetcastContextDesc desc = {.cookie = tetcast_context_desc_default().cookie, .threads = 1};
    if (tetcast_context_create(&desc, &context) != TETCAST_OK)
      return 0;
    fuzz_file("part.msh", MESH, sizeof MESH - 1);
  }
  if (!is_ours(data, size))
    return 0;
  TetcastDataset *dataset;
  if (tetcast_dataset_read(context, write_input(data, size), NULL, &dataset) != TETCAST_OK)
    return 0;
  TetcastMesh *mesh;
  TetcastVolume *volume;
  TetcastField *field;
  TetcastScene *scene;
  if (tetcast_dataset_mesh(dataset, &mesh) == TETCAST_OK &&
      tetcast_volume_create(context, mesh, NULL, &volume) == TETCAST_OK) {
    if (tetcast_scene_create(context, volume, &scene) == TETCAST_OK) {
      if (tetcast_dataset_field(dataset, NULL, &field, NULL) == TETCAST_OK)
        tetcast_scene_set_field(scene, field);
      tetcast_field_destroy(&field);
      tetcast_scene_destroy(&scene);
    }
    tetcast_volume_destroy(&volume);
  }
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  return 0;
}
