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

/* What a file holds: tetrahedra (other volumetric cells are cut into them on reading), and arrays over points and
 * cells. Immutable; may be read from several threads at a time. */
typedef struct TetcastDataset TetcastDataset;

/* What to read of a file. */
typedef struct TetcastDatasetDesc {
  uint32_t cookie;        /* set by tetcast_dataset_desc_default(); catches an uninitialised struct */
  const char *block;      /* of a file of several blocks those of this name, or in the group of this name; NULL: all */
  int64_t step;           /* of a file of several time steps this one, from 0; negative: from the end, -1 is the last */
  double time;            /* the step at this time instead; NaN: none asked for */
  double merge_tolerance; /* negative: only points of different pieces are merged, where they coincide exactly. Else all
                             points no further than this apart, in the file's unit of length; 0: all that coincide
                             exactly */
  const char *only;   /* of the arrays none is read but those that this selector may name, see tetcast_dataset_field(),
                       * and no other that is damaged is told of; legacy .vtk files have to be read whole; NULL: all */
  bool cell_to_point; /* fields of cell arrays are of points: at each the plain mean over the file's cells that use it,
                       * component by component; only volumetric cells count, and not those whose value is NaN or
                       * infinite */
  int subdivision;    /* what each edge of a curved cell is cut into, to TETCAST_MAX_SUBDIVISION; 0: as its nodes lie */
  bool no_displacement; /* points are where an Exodus file has them at first; else they are moved by its displacements
                         * of the step: the first   vector of the points whose name begins with "dis", in any case of
                         * letters */
} TetcastDatasetDesc;

/* All blocks, the first step, no tolerance, curved cells cut as their nodes lie. */
TETCAST_API TetcastDatasetDesc tetcast_dataset_desc_default(void);

/* Format i = 0, 1, … of those that can be read: what it is called, and the usual ends of its files' names, e.g. ".ex2
 * .exo .e". Static storage; either may be NULL. False beyond the last. */
TETCAST_API bool tetcast_dataset_format(int i, const char **name, const char **extensions);

/* Reads a file in one of these formats; which one is told by content, then by extension. desc NULL: the default.
 * TETCAST_ERROR_IO: can't be opened. TETCAST_ERROR_DATA: truncated, damaged, no mesh, no cells, only surface cells,
 * indices out of range. TETCAST_ERROR_ARGUMENT: has no such block or step; the message lists those there are. The
 * reader library's own complaints become part of the message.
 *
 * An array that can't be read costs nothing else: it is left out with one warning, which names it and says why; only
 * where none of the arrays can be read is the file an error. What a file says of sizes is held against what it holds
 * before memory is taken: an error comes after no more than four times the file's size and 256 MB. Any thread may read
 * at any time, whatever the others do.
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

/* Frees the dataset and sets *dataset to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_dataset_destroy(TetcastDataset **dataset);

/* How many cells of type i = 0, 1, … the file has, largest count first; name e.g. "tetrahedron", "hexahedron",
 * "triangle", static storage. False beyond the last. Counted as they are in the file, before anything is cut, but
 * without ghosts and those left out for their coordinates. */
TETCAST_API bool tetcast_dataset_cell_type(const TetcastDataset *dataset, int i, const char **name, int64_t *count);

typedef struct TetcastDatasetArray {
  const char *name;     /* valid while the dataset lives */
  const char *selector; /* what selects it, see tetcast_dataset_field(): its name, or "NAME:cell" where that is a point
                           array's; as long */
  TetcastAssociation association; /* of points or cells */
  int components;                 /* ≥ 1 */
  const char *type;               /* as the file has it, e.g. "float64", "int32"; static storage */
  bool active;                    /* the file marks it as its active scalars */
} TetcastDatasetArray;

/* Describes numeric array i = 0, 1, …, in the file's order, point arrays first. False beyond the last. A file of
 * several blocks without any array has the cell array "block": the number of each cell's block in
 * tetcast_dataset_block(). */
TETCAST_API bool tetcast_dataset_array(const TetcastDataset *dataset, int i, TetcastDatasetArray *array);

/* The name of array i = 0, 1, … that the file has and that was not read: it is not the one that the description asked
 * for, or it can't be read. Valid while the dataset lives. NULL beyond the last. */
TETCAST_API const char *tetcast_dataset_unread(const TetcastDataset *dataset, int i);

/* Number of the file's points, and of its cells of any kind, of all pieces, before any are merged or left out. */
TETCAST_API int64_t tetcast_dataset_point_count(const TetcastDataset *dataset);
TETCAST_API int64_t tetcast_dataset_cell_count(const TetcastDataset *dataset);

typedef struct TetcastDatasetPieces {
  int64_t pieces;           /* that were put together; 1 for a file that is not in pieces */
  int64_t surfaces;         /* pieces left out, as they hold no volumetric cell; not counted anywhere else */
  int64_t ghost_cells;      /* cells left out: copies of other pieces' cells, or blanked */
  int64_t ghost_points;     /* points left out that only those used */
  int64_t merged_points;    /* points that became one with another */
  int64_t differing_points; /* of those the ones at which a point array had several values */
  int64_t nonfinite_points; /* points left out, as a coordinate is NaN or infinite */
  int64_t nonfinite_cells;  /* cells left out, as they use such points */
} TetcastDatasetPieces;

/* What became of the pieces. NULL: all 0. */
TETCAST_API TetcastDatasetPieces tetcast_dataset_pieces(const TetcastDataset *dataset);

/* The name of block i = 0, 1, … of the file, e.g. "fluid/zone 1" within a group, whether it was read or not; valid
 * while the dataset lives. NULL beyond the last, and for files without blocks. */
TETCAST_API const char *tetcast_dataset_block(const TetcastDataset *dataset, int i);

/* The time of step i = 0, 1, … of the file, ascending. False beyond the last, and for files without time steps. */
TETCAST_API bool tetcast_dataset_time(const TetcastDataset *dataset, int64_t i, double *time);

/* The step that was read; 0 for files without. */
TETCAST_API int64_t tetcast_dataset_step(const TetcastDataset *dataset);

/* What cutting its cells came to, all 0 when all of them were tetrahedra already. Vertices that were added come after
 * the file's points. */
TETCAST_API TetcastCutInfo tetcast_dataset_cut(const TetcastDataset *dataset);

/* The tetrahedra. Arrays may be the dataset's own: it must outlive the mesh, which the caller destroys. */
TETCAST_API TetcastStatus tetcast_dataset_mesh(const TetcastDataset *dataset, TetcastMesh **mesh);

/* The scalar that `selector` names: "NAME", with ":point" or ":cell" behind it where both have an array of that name
 * (else that of the points is meant), and with a component behind that: ":2" (from 0), ":x" (by the name that the file
 * gives it; else x, y, z of two or three components, xx, yy, zz, xy, yz, xz of six and xx, xy, … zz of nine; in any
 * case of letters) or ":mag" (Euclidean length), which is also what an array of several is taken by where none is
 * named. An array whose name contains colons is found by its whole name first.
 *
 * NULL: the active scalars, of the points before the cells. Else an array that varies over what is drawn, of these one
 * of points before one of cells, and of these a scalar before a vector, the first in the file's order. Constant ones,
 * and then those that number points or cells (global ids), come only when there is nothing else.
 *
 * A file without arrays is TETCAST_ERROR_DATA. An unknown name or component is TETCAST_ERROR_ARGUMENT and the
 * message lists those there are. Cell arrays follow the tetrahedra the cells were cut into, or are
 * averaged if the description asked for that. The dataset must outlive the field,
 * which the caller destroys. `name` (may be NULL) receives the selector that selects the same again, valid while the
 * dataset lives. */
TETCAST_API TetcastStatus tetcast_dataset_field(const TetcastDataset *dataset, const char *selector,
                                                TetcastField **field, const char **name);

/* Writes a mesh and its fields as .vtu (appended raw, zlib-compressed). names[i] names fields[i]. The file appears
 * whole or not at all. Fields must have as many values as the mesh has vertices or cells. count may be 0, names and
 * fields then NULL. */
TETCAST_API TetcastStatus tetcast_dataset_write(TetcastContext *context, const char *path, const TetcastMesh *mesh,
                                                int count, const char *const *names, const TetcastField *const *fields);

/* Reads a closed or open surface of triangles (polygons are cut into them; coincident points merged exactly): .stl
 * (ASCII and binary), .ply, .off, .obj, .vtp and legacy .vtk. Freed with tetcast_surface_release(). */
TETCAST_API TetcastStatus tetcast_surface_read(TetcastContext *context, const char *path, TetcastSurface *surface);
TETCAST_API void tetcast_surface_release(TetcastSurface *surface);

#ifdef __cplusplus
}
#endif

#endif
