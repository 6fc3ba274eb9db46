/* SPDX-License-Identifier: Apache-2.0 */
#include "matrix.h"

#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"
#include "progress.h"

typedef struct Entry {
  int64_t column;
  double value;
} Entry;

typedef struct Matrix {
  Basis basis;
  const int32_t *source; /* of each tetrahedron the file's cell; NULL: its own number */
  FILE *out;
  int64_t entries; /* that were written */
  Entry *row;      /* [capacity]: of the row under way */
  int64_t count, capacity;
} Matrix;

static void add(Matrix *matrix, int64_t column, double value) {
  if (matrix->count == matrix->capacity) {
    matrix->capacity = matrix->capacity ? 2 * matrix->capacity : 1024;
    matrix->row = realloc(matrix->row, (size_t)matrix->capacity * sizeof *matrix->row);
    if (!matrix->row) {
      cli_error("out of memory");
      exit(CLI_FAILED);
    }
  }
  matrix->row[matrix->count++] = (Entry){column, value};
}

static int by_column(const void *a, const void *b) {
  const int64_t x = ((const Entry *)a)->column, y = ((const Entry *)b)->column;
  return (x > y) - (x < y);
}

/* Entries of one column become one, their sum. */
static void print_row(Matrix *matrix, int64_t ray) {
  if (matrix->count > 0)
    qsort(matrix->row, (size_t)matrix->count, sizeof *matrix->row, by_column);
  for (int64_t i = 0; i < matrix->count;) {
    const int64_t column = matrix->row[i].column;
    double sum = 0;
    for (; i < matrix->count && matrix->row[i].column == column; i++)
      sum += matrix->row[i].value;
    fprintf(matrix->out, "%lld %lld %.17g\n", (long long)ray + 1, (long long)column + 1, sum);
    matrix->entries++;
  }
  matrix->count = 0;
}

/* On an edge, and at a vertex, weights that are 0 may be the smallest numbers there are. */
static const double nothing = 0x1p-900;

static bool take(void *user, const TetcastTrace *trace) {
  Matrix *matrix = user;
  for (int64_t i = 0; i < trace->count; i++) {
    for (int64_t j = trace->offsets[i]; j < trace->offsets[i + 1]; j++) {
      const TetcastCrossing *c = &trace->crossings[j];
      if (matrix->basis == BASIS_CELLS)
        add(matrix, matrix->source ? matrix->source[c->cell] : (int64_t)c->cell, c->length);
      for (int k = 0; matrix->basis == BASIS_POINTS && k < 4; k++) {
        const double mean = 0.5 * (c->weight[0][k] + c->weight[1][k]);
        if (mean > nothing)
          add(matrix, c->vertex[k], c->length * mean);
      }
    }
    print_row(matrix, trace->first + i);
  }
  return !cli_interrupted();
}

/* How many columns there are: cells of the file, or points of the mesh. */
static int64_t columns_of(const Stage *stage, Basis basis) {
  if (basis == BASIS_POINTS)
    return tetcast_mesh_vertices(stage->mesh).count;
  const TetcastDatasetPieces pieces = cli_vtk()->dataset_pieces(stage->dataset);
  return cli_vtk()->dataset_cell_count(stage->dataset) - pieces.ghost_cells - pieces.nonfinite_cells;
}

int matrix_write(const Stage *stage, const RenderOptions *options, Basis basis, const RayFile *rays) {
  enum { SIZES = 64 };
  CliText *text = cli_text_begin();
  const TetcastArray sources = cli_vtk()->dataset_sources(stage->dataset);
  Matrix matrix = {.basis = basis, .source = sources.data, .out = text->file};
  fprintf(text->file, "%%%%MatrixMarket matrix coordinate real general\n%% a row a ray, a column a %s\n",
          basis == BASIS_CELLS ? "cell" : "point");
  fflush(text->file);
  const size_t at = text->size; /* the sizes come here, once they are known */
  fprintf(text->file, "%*s\n", SIZES - 1, "");
  TetcastTraceDesc desc = tetcast_trace_desc_default();
  desc.weights = basis == BASIS_POINTS;
  desc.isa = (TetcastIsa)options->isa;
  desc.progress = cli_progress("tracing");
  const TetcastRays list = ray_file_rays(rays);
  const TetcastStatus status = tetcast_volume_trace(stage->volume, &list, &desc, take, &matrix);
  cli_progress_clear();
  free(matrix.row);
  fflush(text->file);
  char sizes[SIZES + 1];
  const int length = snprintf(sizes, sizeof sizes, "%lld %lld %lld", (long long)rays->count,
                              (long long)columns_of(stage, basis), (long long)matrix.entries);
  if (!ferror(text->file))
    memcpy(text->memory + at, sizes, (size_t)length);
  if (status == TETCAST_OK)
    return cli_text_write(text, NULL, options->matrix) ? CLI_DONE : CLI_FAILED;
  cli_text_drop(text);
  return cli_failed(status);
}
