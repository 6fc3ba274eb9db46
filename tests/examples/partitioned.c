/* SPDX-License-Identifier: Apache-2.0 */
/* A program of several MPI processes, each with its own part of a mesh, that makes one picture: partitioned.ppm.
 *     mpicc partitioned.c $(pkg-config --cflags --libs tetcast-mpi tetcast) -lm -o partitioned
 *     mpirun -n 4 ./partitioned */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <mpi.h>

#include <tetcast/mpi.h>
#include <tetcast/tetcast.h>

#include "ppm.h"

/* A rank's part: as many small cubes of six tetrahedra as it has columns of, all of them in y and z. The columns lean,
 * so that parts are not what a plane separates. Numbers of vertices are the rank's own. */
typedef struct Part {
  int64_t vertex_count, cell_count;
  double (*vertices)[3];
  int64_t (*cells)[4];
  double *values;
} Part;

enum { N = 24 }; /* small cubes along a side of all */

static void set_vertex(Part *part, int64_t vertex, int i, int j, int k) {
  double *p = part->vertices[vertex];
  p[0] = (i + 1.5 * sin(0.4 * j) + 1.5 * cos(0.3 * k)) / N;
  p[1] = (double)j / N;
  p[2] = (double)k / N;
  part->values[vertex] =
      exp(-12 * ((p[0] - 0.5) * (p[0] - 0.5) + (p[1] - 0.4) * (p[1] - 0.4))) * (0.6 + 0.4 * cos(9 * p[2]));
}

/* The columns from `first` up to `last`. */
static int part_make(Part *part, int first, int last) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int columns = last - first;
  const int64_t step[3] = {1, columns + 1, (int64_t)(columns + 1) * (N + 1)};
  int64_t vertex = 0, cell = 0;
  part->vertex_count = step[2] * (N + 1);
  part->cell_count = (int64_t)6 * columns * N * N;
  part->vertices = calloc((size_t)part->vertex_count, sizeof *part->vertices);
  part->values = calloc((size_t)part->vertex_count, sizeof *part->values);
  part->cells = calloc((size_t)part->cell_count + 1, sizeof *part->cells);
  if (!part->vertices || !part->values || !part->cells) {
    return 0;
  }
  for (int k = 0; k <= N; k++) {
    for (int j = 0; j <= N; j++) {
      for (int i = 0; i <= columns; i++, vertex++) {
        set_vertex(part, vertex, first + i, j, k);
        for (int o = 0; o < 6 && i < columns && j < N && k < N; o++, cell++) {
          int64_t corner = vertex;
          for (int v = 0; v < 4; v++) {
            part->cells[cell][v] = corner;
            corner += v < 3 ? step[orders[o][v]] : 0;
          }
        }
      }
    }
  }
  return 1;
}

static void part_free(Part *part) {
  free(part->vertices);
  free(part->cells);
  free(part->values);
}

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)severity;
  fprintf(stderr, "partitioned, rank %d: %s\n", *(int *)user, text);
}

/* What is common to all ranks: what the mesh and its values reach over. A part without cells has no bounds. */
static TetcastStatus find_extent(TetcastMpi *mpi, const Part *part, double bounds[6], double range[2]) {
  range[0] = bounds[0] = bounds[2] = bounds[4] = INFINITY;
  range[1] = bounds[1] = bounds[3] = bounds[5] = -INFINITY;
  for (int64_t i = 0; i < part->vertex_count && part->cell_count > 0; i++) {
    for (int k = 0; k < 3; k++) {
      bounds[2 * k] = fmin(bounds[2 * k], part->vertices[i][k]);
      bounds[2 * k + 1] = fmax(bounds[2 * k + 1], part->vertices[i][k]);
    }
    range[0] = fmin(range[0], part->values[i]);
    range[1] = fmax(range[1], part->values[i]);
  }
  TetcastStatus status = tetcast_mpi_bounds(mpi, bounds);
  return status ? status : tetcast_mpi_range(mpi, range);
}

/* The scene of this rank's part. The bounds are those of all parts: rays then pass from one to another without a gap.
 */
static TetcastStatus make_scene(TetcastContext *context, const Part *part, const double bounds[6],
                                TetcastVolume **volume, TetcastScene **scene) {
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices =
      (TetcastArray){.data = part->vertices, .type = TETCAST_TYPE_FLOAT64, .count = part->vertex_count};
  mesh_desc.tetrahedra = (TetcastArray){.data = part->cells, .type = TETCAST_TYPE_INT64, .count = part->cell_count};
  mesh_desc.ownership = TETCAST_BORROW; /* until the volume has been made */
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){.data = part->values, .type = TETCAST_TYPE_FLOAT64, .count = part->vertex_count};
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.bounds = bounds;
  TetcastStatus status = tetcast_mesh_create(context, &mesh_desc, &mesh);
  if (!status)
    status = tetcast_field_create(context, &field_desc, &field);
  if (!status)
    status = tetcast_volume_create(context, mesh, &volume_desc, volume);
  if (!status)
    status = tetcast_scene_create(context, *volume, scene);
  if (!status)
    status = tetcast_scene_set_field(*scene, field);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  return status;
}

/* One transfer function for all: the colours of a map over the range of all values, as dense as suits the whole. */
static TetcastStatus find_look(TetcastContext *context, TetcastMpi *mpi, TetcastScene *const *scenes, int64_t count,
                               const double bounds[6], const double range[2], TetcastTransferFunction **look) {
  TetcastTransferFunction *shape = NULL;
  TetcastStatus status = tetcast_transfer_function_create_preset(context, "viridis", 0, 1, 1, &shape);
  status = tetcast_mpi_agree(mpi, status); /* all go on, or none */
  if (!status)
    status = tetcast_mpi_fit_transfer_function(mpi, scenes, count, bounds, shape, range[0], range[1], look);
  tetcast_transfer_function_destroy(&shape);
  for (int64_t i = 0; !status && i < count; i++)
    status = tetcast_scene_set_transfer_function(scenes[i], *look);
  return tetcast_mpi_agree(mpi, status);
}

/* Renders, and writes the picture at rank 0, which alone has one. */
static TetcastStatus make_picture(TetcastContext *context, TetcastMpi *mpi, TetcastScene *const *scenes, int64_t count,
                                  const double bounds[6]) {
  const int root = tetcast_mpi_rank(mpi) == 0;
  const TetcastCamera camera = tetcast_camera_default(bounds, 1);
  TetcastFrame *frame = NULL;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 300;
  TetcastMpiStats stats;
  TetcastStatus status = root ? tetcast_frame_create(context, &desc, &frame) : TETCAST_OK;
  status = tetcast_mpi_agree(mpi, status);
  if (!status)
    status = tetcast_mpi_render(mpi, (const TetcastScene *const *)scenes, count, &camera, NULL, frame, &stats);
  if (!status && root) {
    printf("%d ranks: %lld fragments, %lld lost\n", tetcast_mpi_size(mpi), (long long)stats.fragments,
           (long long)stats.lost);
    if (ppm_write("partitioned.ppm", frame, 1))
      status = tetcast_context_error(context, TETCAST_ERROR_IO, "partitioned.ppm can't be written");
  }
  tetcast_frame_destroy(&frame);
  return tetcast_mpi_agree(mpi, status);
}

int main(int argc, char **argv) {
  int rank, size, level;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);

  Part part = {0};
  double bounds[6], range[2];
  TetcastContext *context = NULL;
  TetcastMpi *mpi = NULL;
  TetcastVolume *volume = NULL;
  TetcastScene *scene = NULL;
  TetcastTransferFunction *look = NULL;
  TetcastContextDesc context_desc = tetcast_context_desc_default();
  context_desc.message = print_message;
  context_desc.message_user = &rank;
  context_desc.threads = 1; /* where a node has a rank for each core */

  TetcastStatus status = tetcast_context_create(&context_desc, &context);
  if (!status)
    status = tetcast_mpi_create(context, MPI_Comm_c2f(MPI_COMM_WORLD), &mpi);
  if (status) /* the other ranks can't be told yet */
    MPI_Abort(MPI_COMM_WORLD, 1);

  if (!part_make(&part, N * rank / size, N * (rank + 1) / size))
    status = tetcast_context_error(context, TETCAST_ERROR_MEMORY, "no memory for a part");
  status = tetcast_mpi_agree(mpi, status);
  if (!status)
    status = find_extent(mpi, &part, bounds, range);
  if (!status && part.cell_count > 0) /* more ranks than columns: some have nothing, and take part all the same */
    status = make_scene(context, &part, bounds, &volume, &scene);
  status = tetcast_mpi_agree(mpi, status);
  if (!status)
    status = find_look(context, mpi, &scene, scene ? 1 : 0, bounds, range, &look);
  if (!status)
    status = make_picture(context, mpi, &scene, scene ? 1 : 0, bounds);

  tetcast_transfer_function_destroy(&look);
  tetcast_scene_destroy(&scene);
  tetcast_volume_destroy(&volume);
  part_free(&part);
  tetcast_mpi_destroy(&mpi);
  tetcast_context_destroy(&context);
  MPI_Finalize();
  return status ? 1 : 0;
}
