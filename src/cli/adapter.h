/* SPDX-License-Identifier: Apache-2.0 */
/* The adapters. Each is loaded when a run first needs it, as VTK alone consists of hundreds of libraries. */
#ifndef TETCAST_CLI_ADAPTER_H
#define TETCAST_CLI_ADAPTER_H

#include <tetcast/dataset.h>
#include <tetcast/image.h>
#include <tetcast/mpi.h>
#include <tetcast/tetgen.h>

/* X(result, name, parameters) for each function tetcast_NAME of an adapter; adapter.c checks them against the headers.
 */
#define CLI_VTK_FUNCTIONS(X)                                                                                           \
  X(TetcastDatasetDesc, dataset_desc_default, (void))                                                                  \
  X(bool, dataset_format, (int, const char **, const char **))                                                         \
  X(TetcastStatus, dataset_read, (TetcastContext *, const char *, const TetcastDatasetDesc *, TetcastDataset **))      \
  X(TetcastStatus, dataset_parts,                                                                                      \
    (TetcastContext *, const char *, const TetcastDatasetDesc *, TetcastDatasetPart *, void *))                        \
  X(void, dataset_destroy, (TetcastDataset **))                                                                        \
  X(bool, dataset_cell_type, (const TetcastDataset *, int, const char **, int64_t *))                                  \
  X(bool, dataset_array, (const TetcastDataset *, int, TetcastDatasetArray *))                                         \
  X(const char *, dataset_unread, (const TetcastDataset *, int))                                                       \
  X(int64_t, dataset_point_count, (const TetcastDataset *))                                                            \
  X(int64_t, dataset_cell_count, (const TetcastDataset *))                                                             \
  X(TetcastDatasetPieces, dataset_pieces, (const TetcastDataset *))                                                    \
  X(const char *, dataset_block, (const TetcastDataset *, int))                                                        \
  X(bool, dataset_time, (const TetcastDataset *, int64_t, double *))                                                   \
  X(int64_t, dataset_step, (const TetcastDataset *))                                                                   \
  X(TetcastCutInfo, dataset_cut, (const TetcastDataset *))                                                             \
  X(TetcastArray, dataset_sources, (const TetcastDataset *))                                                           \
  X(TetcastStatus, dataset_mesh, (const TetcastDataset *, TetcastMesh **))                                             \
  X(TetcastStatus, dataset_field, (const TetcastDataset *, const char *, TetcastField **, const char **))              \
  X(TetcastStatus, dataset_write,                                                                                      \
    (TetcastContext *, const char *, const TetcastMesh *, int, const char *const *, const TetcastField *const *))      \
  X(TetcastStatus, surface_read, (TetcastContext *, const char *, TetcastSurface *))                                   \
  X(void, surface_release, (TetcastSurface *))                                                                         \
  X(TetcastStatus, xml_read, (TetcastContext *, const char *, TetcastXmlElement *, void *))

#define CLI_TETGEN_FUNCTIONS(X)                                                                                        \
  X(TetcastTetgenDesc, tetgen_desc_default, (void))                                                                    \
  X(TetcastStatus, tetgen_mesh, (TetcastContext *, const TetcastSurface *, const TetcastTetgenDesc *, TetcastMesh **)) \
  X(TetcastStatus, tetgen_mesh_file, (TetcastContext *, const char *, const TetcastTetgenDesc *, TetcastMesh **))

#define CLI_IMAGE_FUNCTIONS(X)                                                                                         \
  X(TetcastImageDesc, image_desc_default, (void))                                                                      \
  X(TetcastStatus, image_write, (TetcastContext *, const char *, const TetcastFrame *, const TetcastImageDesc *))      \
  X(TetcastStatus, image_begin,                                                                                        \
    (TetcastContext *, const char *, const TetcastFrame *, int64_t, const TetcastImageDesc *, TetcastImage **))        \
  X(TetcastStatus, image_add, (TetcastImage *, const TetcastFrame *))                                                  \
  X(TetcastStatus, image_end, (TetcastImage **))                                                                       \
  X(void, image_destroy, (TetcastImage **))                                                                            \
  X(TetcastStatus, image_write_deep, (TetcastContext *, const char *, const TetcastDeep *, TetcastPixelType))          \
  X(TetcastStatus, image_check, (TetcastContext *, const char *, const TetcastImageDesc *))                            \
  X(TetcastStatus, image_read_depth, (TetcastContext *, const char *, int64_t, int64_t, double *))

#define CLI_MPI_FUNCTIONS(X)                                                                                           \
  X(TetcastStatus, mpi_create, (TetcastContext *, int, TetcastMpi **))                                                 \
  X(TetcastStatus, mpi_create_world, (TetcastContext *, TetcastMpi **))                                                \
  X(void, mpi_destroy, (TetcastMpi **))                                                                                \
  X(int, mpi_rank, (const TetcastMpi *))                                                                               \
  X(int, mpi_size, (const TetcastMpi *))                                                                               \
  X(TetcastStatus, mpi_agree, (TetcastMpi *, TetcastStatus))                                                           \
  X(TetcastStatus, mpi_bounds, (TetcastMpi *, double *))                                                               \
  X(TetcastStatus, mpi_range, (TetcastMpi *, double *))                                                                \
  X(TetcastStatus, mpi_sum, (TetcastMpi *, const double *, int64_t, int64_t, double *))                                \
  X(TetcastStatus, mpi_statistics, (TetcastMpi *, const TetcastStatistics *const *, int64_t, TetcastStatistics **))    \
  X(TetcastStatus, mpi_broadcast, (TetcastMpi *, int, void *, int64_t))                                                \
  X(TetcastStatus, mpi_send, (TetcastMpi *, int, const void *, int64_t))                                               \
  X(TetcastStatus, mpi_receive, (TetcastMpi *, int, void *, int64_t))                                                  \
  X(TetcastStatus, mpi_scale_transfer_function,                                                                        \
    (TetcastMpi *, TetcastScene *const *, int64_t, const double *, const TetcastTransferFunction *,                    \
     const TetcastCamera *, double, TetcastTransferFunction **))                                                       \
  X(TetcastStatus, mpi_fit_transfer_function,                                                                          \
    (TetcastMpi *, TetcastScene *const *, int64_t, const double *, const TetcastTransferFunction *, double, double,    \
     TetcastTransferFunction **))                                                                                      \
  X(TetcastStatus, mpi_render,                                                                                         \
    (TetcastMpi *, const TetcastScene *const *, int64_t, const TetcastCamera *, const TetcastRenderDesc *,             \
     TetcastFrame *, TetcastMpiStats *))

/* The functions under the adapter's names without "tetcast_", e.g. vtk->dataset_read(…). */
#define CLI_MEMBER(result, name, parameters) result(*name) parameters;
typedef struct CliVtk {
  CLI_VTK_FUNCTIONS(CLI_MEMBER)
} CliVtk;
typedef struct CliTetgen {
  CLI_TETGEN_FUNCTIONS(CLI_MEMBER)
} CliTetgen;
typedef struct CliImage {
  CLI_IMAGE_FUNCTIONS(CLI_MEMBER)
} CliImage;
typedef struct CliMpi {
  CLI_MPI_FUNCTIONS(CLI_MEMBER)
} CliMpi;
#undef CLI_MEMBER

/* The adapter, loaded at the first call; NULL after a message if it is missing. */
const CliVtk *cli_vtk(void);
const CliTetgen *cli_tetgen(void);
const CliImage *cli_image(void);
const CliMpi *cli_mpi(void);

/* Puts another source of datasets in the place of VTK's adapter (NULL: nothing any more): the functions of `source` are
 * what cli_vtk() has from here on. A source need not have those that write files. */
void cli_set_source(const CliVtk *source);

/* Writes float pixels [height][width][4], red, green, blue and alpha, premultiplied, as an image. */
TetcastStatus cli_write_pixels(TetcastContext *context, const char *path, float *pixels, int64_t width, int64_t height,
                               const TetcastImageDesc *desc);

#endif
