/* SPDX-License-Identifier: Apache-2.0 */
/* Reading and writing files of meshes and fields through VTK: target tetcast::vtk, library libtetcast-vtk. */
#ifndef TETCAST_DATASET_H
#define TETCAST_DATASET_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/cells.h>
#include <tetcast/context.h>
#include <tetcast/field.h>
#include <tetcast/mesh.h>
#include <tetcast/status.h>
#include <tetcast/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The contents of a file: tetrahedra (other volumetric cells are cut into them on reading), and arrays over points and
 * cells. Immutable; may be read from several threads at a time. */
typedef struct TetcastDataset TetcastDataset;

/* What to read of a file. */
typedef struct TetcastDatasetDesc {
  /* Set by tetcast_dataset_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The name of the blocks to read, or of a group of blocks, in a file of several. NULL (the default): all blocks. */
  const char *block;
  /* The number of the step to read in a file of several time steps, from 0. Negative numbers count from the end, -1
   * being the last. Default: 0. */
  int64_t step;
  /* The time of the step to read, in place of its number. Default: NaN, the number counts. */
  double time;
  /* All points no further than this apart are merged, in the file's unit of length; 0: all that coincide exactly. If it
   * is negative, points are merged only if they are of different pieces and coincide exactly. Default: -1. */
  double merge_tolerance;
  /* A selector (tetcast_dataset_field()): only arrays that it may name are read, and nothing is told of damage to
   * others. Legacy .vtk files are always read whole. NULL (the default): all arrays are read. */
  const char *only;
  /* Whether fields of cell arrays are turned into fields of points. At each point, the value is the mean over the
   * file's volumetric cells that use it, component by component, without cells whose value is NaN or infinite.
   * Default: false. */
  bool cell_to_point;
  /* The number of pieces that each edge of a curved cell is cut into, at most TETCAST_MAX_SUBDIVISION. Default: 0, as
   * many as the edge's nodes make. */
  int subdivision;
  /* Whether points stay where an Exodus file has them at first. If not, they are moved by the step's displacements: the
   * first vector of the points whose name begins with "dis", in upper or lower case. Default: false. */
  bool no_displacement;
  /* Factors > 0 on the coordinates x, y and z, after points are moved and merged and before cells are cut: everything
   * is then in the stretched system. Values of arrays stay as they are, those of vectors, too. A coordinate that its
   * type can't hold then is TETCAST_ERROR_DATA. Default: 1, 1, 1. */
  double stretch[3];
  /* Whether tetcast_dataset_sources() is wanted, which takes 4 bytes for each tetrahedron where cells are cut. Default:
   * false. */
  bool sources;
  /* Whether the file is one of several that make up a mesh (tetcast_dataset_parts()), each of which is read by itself.
   * If it holds no volumetric cells, or none but ghosts, it is a dataset without tetrahedra then, not an error. And of
   * cells that are cut, faces are cut by their corners' coordinates, so that cells of two files cut the face between
   * them in the same way; for that, points are sorted. Where faces bulge, or fields are not linear in space, that is
   * another way than that of the mesh as a whole, and no worse. (On the lattices of curved cells, points of two files
   * may differ by rounding.) Default: false. */
  bool part;
} TetcastDatasetDesc;

/* Makes a desc of all blocks, all arrays and the first step, with every setting at its default. */
TETCAST_API TetcastDatasetDesc tetcast_dataset_desc_default(void);

/* Describes format i = 0, 1, … of those that can be read: its name, and the usual ends of its files' names, such as
 * ".ex2 .exo .e". Both are in static storage; either pointer may be NULL. False beyond the last. */
TETCAST_API bool tetcast_dataset_format(int i, const char **name, const char **extensions);

/* Reads a file in one of these formats, which is told by the file's content, then by its extension. `desc` may be NULL
 * (defaults). A file that can't be opened is TETCAST_ERROR_IO; one that is truncated or damaged, or has no mesh, no
 * volumetric cells, or indices out of range, is TETCAST_ERROR_DATA; a block or step that it doesn't have is
 * TETCAST_ERROR_ARGUMENT, and the message lists those it has. The reader library's own complaints become part of the
 * message.
 *
 * An array that can't be read is left out with one warning, which names it and says why; the rest of the file is read.
 * Only if none of its arrays can be read is the file an error. Sizes that a file claims are compared with its real size
 * before memory is allocated, so that reading a damaged file takes no more memory than four times its size and 256 MB.
 * Any thread may read at any time, whatever the others do.
 *
 * Exodus, VTKHDF, EnSight, CGNS and OpenFOAM files are read by programs of their own (tetcast-vtk-exodus …), which may
 * crash without harm to the caller. They are started by posix_spawn() from the folder that the environment's
 * TETCAST_LIBEXEC names; else from libexec/tetcast beside the folder of the library, wherever that was moved to.
 * Without the program its formats are TETCAST_ERROR_UNSUPPORTED, and the message says where it was looked for. What the
 * caller does with SIGCHLD, SIGPIPE and waitpid() makes no difference.
 *
 * Structured grids become hexahedra. Of a file in pieces or blocks, ghost cells (vtkGhostType, vtkGhostLevels: copies
 * of another piece's cells) and blanked ones are left out, as are pieces without volume, and coincident points of
 * different pieces become one, so that the mesh is that of the whole. Where pieces disagree about a point's value, the
 * piece first in the file wins that does not call the point a duplicate; where some pieces lack an array, it is NaN,
 * which is drawn transparent. Points with coordinates that are NaN or infinite are left out, and so are the cells that
 * use them. A warning says how often each of these was so. */
TETCAST_API TetcastStatus tetcast_dataset_read(TetcastContext *context, const char *path,
                                               const TetcastDatasetDesc *desc, TetcastDataset **dataset);

/* Is told of a file that another one lists: its path, and its size in bytes, 0 if it is not there. The path is valid
 * during the call only. */
typedef void TetcastDatasetPart(void *user, const char *path, int64_t bytes);

/* Tells which files a file in pieces or blocks, or a step of a series, consists of, so that each can be read by itself:
 * calls part(user, …) for each file that tetcast_dataset_read() would read for `desc` (NULL: defaults), in that order,
 * but not for surfaces. Only block, step and time of `desc` count; they have no meaning for the files then. None is
 * told of a file that lists no others. Reading one of them with TetcastDatasetDesc.part reads its part of the mesh. */
TETCAST_API TetcastStatus tetcast_dataset_parts(TetcastContext *context, const char *path,
                                                const TetcastDatasetDesc *desc, TetcastDatasetPart *part, void *user);

/* Frees the dataset and sets *dataset to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_dataset_destroy(TetcastDataset **dataset);

/* Tells how many cells of type i = 0, 1, … the file has, largest count first. The name is such as "tetrahedron",
 * "hexahedron" or "triangle", in static storage. False beyond the last. Cells are counted as they are in the file,
 * before anything is cut, but without ghosts and without those left out for their coordinates. */
TETCAST_API bool tetcast_dataset_cell_type(const TetcastDataset *dataset, int i, const char **name, int64_t *count);

/* Describes an array of a file. */
typedef struct TetcastDatasetArray {
  /* The array's name. Valid while the dataset lives, never NULL. */
  const char *name;
  /* The selector that names it (tetcast_dataset_field()): its name, or "NAME:cell" where points have an array of that
   * name as well. Valid while the dataset lives, never NULL. */
  const char *selector;
  /* Whether it has values of points or of cells. */
  TetcastAssociation association;
  /* The number of components of each value, ≥ 1. */
  int components;
  /* The type of its numbers in the file, such as "float64" or "int32". In static storage, never NULL. */
  const char *type;
  /* Whether the file marks it as its active scalars. */
  bool active;
} TetcastDatasetArray;

/* Describes numeric array i = 0, 1, …, in the file's order, point arrays first. False beyond the last. A file of
 * several blocks without any array has the cell array "block": the number of each cell's block in
 * tetcast_dataset_block(). */
TETCAST_API bool tetcast_dataset_array(const TetcastDataset *dataset, int i, TetcastDatasetArray *array);

/* The name of array i = 0, 1, … of those in the file that were not read, as the desc didn't ask for them or as they
 * can't be read. Valid while the dataset lives. NULL beyond the last. */
TETCAST_API const char *tetcast_dataset_unread(const TetcastDataset *dataset, int i);

/* The number of points in all pieces of the file, before any are merged or left out. */
TETCAST_API int64_t tetcast_dataset_point_count(const TetcastDataset *dataset);

/* The number of cells of any kind in all pieces of the file, before any are left out. */
TETCAST_API int64_t tetcast_dataset_cell_count(const TetcastDataset *dataset);

/* What became of the pieces of a file. */
typedef struct TetcastDatasetPieces {
  /* The number of pieces that were put together; 1 for a file that is not in pieces. */
  int64_t pieces;
  /* The number of pieces left out as they hold no volumetric cell. They are not counted anywhere else. */
  int64_t surfaces;
  /* The number of cells left out as they are copies of other pieces' cells, or blanked. */
  int64_t ghost_cells;
  /* The number of points left out as only such cells use them. */
  int64_t ghost_points;
  /* The number of points that became one with another point. */
  int64_t merged_points;
  /* The number of merged points at which some point array had several values. */
  int64_t differing_points;
  /* The number of points left out as a coordinate is NaN or infinite. */
  int64_t nonfinite_points;
  /* The number of cells left out as they use such points. */
  int64_t nonfinite_cells;
} TetcastDatasetPieces;

/* Tells what became of the pieces. All numbers are 0 if `dataset` is NULL. */
TETCAST_API TetcastDatasetPieces tetcast_dataset_pieces(const TetcastDataset *dataset);

/* The name of block i = 0, 1, … of the file, e.g. "fluid/zone 1" within a group, whether it was read or not; valid
 * while the dataset lives. NULL beyond the last, and for files without blocks. */
TETCAST_API const char *tetcast_dataset_block(const TetcastDataset *dataset, int i);

/* The time of step i = 0, 1, … of the file, ascending. False beyond the last, and for files without time steps. */
TETCAST_API bool tetcast_dataset_time(const TetcastDataset *dataset, int64_t i, double *time);

/* The number of the step that was read; 0 for files without time steps. */
TETCAST_API int64_t tetcast_dataset_step(const TetcastDataset *dataset);

/* Tells what cutting the file's cells has come to; all numbers are 0 if all cells were tetrahedra already. Vertices
 * that were added come after the file's points. */
TETCAST_API TetcastCutInfo tetcast_dataset_cut(const TetcastDataset *dataset);

/* [t] int32: the cell that each tetrahedron of the mesh is a part of, counted as the file has them, from 0, without
 * those left out. None if the desc did not ask for it (it may be there nevertheless), and where all cells are
 * tetrahedra: each is its own. Valid while the dataset lives. */
TETCAST_API TetcastArray tetcast_dataset_sources(const TetcastDataset *dataset);

/* Makes a mesh of the tetrahedra, which the caller destroys. The mesh may refer to arrays of the dataset, which must
 * outlive it. */
TETCAST_API TetcastStatus tetcast_dataset_mesh(const TetcastDataset *dataset, TetcastMesh **mesh);

/* Makes a field of the scalar that `selector` names, which the caller destroys. A selector is the array's name, "NAME";
 * then ":point" or ":cell", which may be left out unless both have an array of that name and the cells' is meant; then
 * a component, ":2" by number (from 0), ":x" by name, or ":mag" for the Euclidean length, which is also taken of an
 * array of several components if none is named. Components have the names that the file gives them; if it gives none,
 * they are x, y, z of two or three, xx, yy, zz, xy, yz, xz of six, and xx, xy, … zz of nine. Upper and lower case are
 * the same. An array whose name contains colons is found by its whole name first.
 *
 * If `selector` is NULL, the field is that of the file's active scalars, of points before those of cells. If the file
 * marks none, it is an array that varies over what is drawn: one of points before one of cells, and of these a scalar
 * before a vector, and of these the first in the file. Constant arrays are taken only if there are no others, and
 * arrays that number points or cells (global ids) only if there is nothing else at all.
 *
 * A file without arrays is TETCAST_ERROR_DATA. An unknown name or component is TETCAST_ERROR_ARGUMENT, and the message
 * lists those there are. Values of a cell are those of all tetrahedra that it was cut into, unless the desc asked for
 * means at points. The dataset must outlive the field. `name` (may be NULL) receives a selector that names the same
 * scalar again, valid while the dataset lives. */
TETCAST_API TetcastStatus tetcast_dataset_field(const TetcastDataset *dataset, const char *selector,
                                                TetcastField **field, const char **name);

/* Writes a mesh and its fields as .vtu (appended raw, zlib-compressed). names[i] names fields[i]. Cells that the mesh
 * hides are written with a mark in vtkGhostType, by which readers hide them. The file appears whole or not at all.
 * Fields must have as many values as the mesh has vertices or cells. count may be 0, names and fields then NULL. */
TETCAST_API TetcastStatus tetcast_dataset_write(TetcastContext *context, const char *path, const TetcastMesh *mesh,
                                                int count, const char *const *names, const TetcastField *const *fields);

/* Reads a closed or open surface of triangles (polygons are cut into them; coincident points merged exactly): .stl
 * (ASCII and binary), .ply, .off, .obj, .vtp and legacy .vtk. Freed with tetcast_surface_release(). */
TETCAST_API TetcastStatus tetcast_surface_read(TetcastContext *context, const char *path, TetcastSurface *surface);

/* Frees the arrays of a surface that tetcast_surface_read() has filled, and sets it to zero. */
TETCAST_API void tetcast_surface_release(TetcastSurface *surface);

/* Is told of an element of an XML file where it begins: how many others it lies in, its name, and its attributes, each
 * a name and a value, NULL behind the last. All are valid during the call only. */
typedef void TetcastXmlElement(void *user, int depth, const char *name, const char *const *attributes);

/* Reads an XML file of any kind, calling element(user, …) for each element in turn; what stands between them is passed
 * over. The file may turn out to be damaged (TETCAST_ERROR_DATA) when some were told already. */
TETCAST_API TetcastStatus tetcast_xml_read(TetcastContext *context, const char *path, TetcastXmlElement *element,
                                           void *user);

#ifdef __cplusplus
}
#endif

#endif
