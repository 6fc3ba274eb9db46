/* SPDX-License-Identifier: Apache-2.0 */
/* What a first picture shows, in numbers. `looks make FOLDER` writes files of fields that are hard to show, and
 * `looks measure FILE SCENE` looks at a file with the view and the transfer function that a scene file states. It
 * prints the numbers as one line, and ends with 1 if they are not those of a picture to show. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include <tetcast/dataset.h>
#include <tetcast/tetcast.h>

/* ── fields ── */

static double hash(int x, int y, int z) {
  uint32_t h = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u;
  h = (h ^ h >> 16) * 0x45d9f3bu;
  return (double)((h ^ h >> 16) & 0xffffff) / 0x1000000;
}

static double radius(const double p[3]) {
  return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static double gauss(double x, double width) {
  return exp(-x * x / (width * width));
}

static double concentrated(const double p[3]) {
  return gauss(radius(p), 0.15);
}
static double decades(const double p[3]) {
  return pow(10, -6.5 * radius(p));
}
static double with_signs(const double p[3]) {
  return sin(4 * p[0]) * cos(3 * p[1]) * sin(5 * p[2] + 1);
}
static double constant(const double p[3]) {
  return 7 + 0 * p[0];
}
static double two_values(const double p[3]) {
  return radius(p) < 0.6 ? 5 : 2;
}
static double thin_shell(const double p[3]) {
  return gauss(radius(p) - 0.7, 0.05);
}
static double holes(const double p[3]) {
  return fabs(sin(3 * p[0]) * sin(3 * p[1]) * sin(3 * p[2])) > 0.5 ? (double)NAN : p[2] + 0.2 * p[0];
}
static double boundary_layer(const double p[3]) {
  return 300 * (1 - exp(-(p[2] + 1) / 0.08));
}
static double linear(const double p[3]) {
  return 20 + 3 * p[0];
}
static double waves(const double p[3]) {
  return cos(9 * radius(p)) * gauss(radius(p), 0.8) + 0.3;
}
static double outlier(const double p[3]) {
  return radius(p) < 0.04 ? 1e6 : sin(3 * p[0]) + sin(2 * p[1]) + sin(4 * p[2]) + 4;
}
static double noise(const double p[3]) {
  return hash((int)floor(30 * p[0]), (int)floor(30 * p[1]), (int)floor(30 * p[2]));
}
static double front(const double p[3]) {
  return 1 / (1 + exp(-25 * (p[0] + 0.3 * sin(3 * p[1]))));
}
static double sparse(const double p[3]) {
  return fmax(0, gauss(p[0] - 0.4, 0.3) * gauss(p[1], 0.3) - 0.3);
}
static double offset(const double p[3]) {
  return 101325 + 0.5 * p[2] + gauss(radius(p), 0.4);
}
static double negative(const double p[3]) {
  return -250 + 40 * sin(2 * p[0]) * p[1];
}
static double one_sided(const double p[3]) {
  return 0.3 - p[2] + 2 * gauss(radius(p), 0.3);
}
static double tails(const double p[3]) {
  return tan(1.55 * sin(2 * p[0] + p[1] + 0.5 * p[2]));
}
static double density(const double p[3]) {
  double sum = 1e-30;
  for (int i = 0; i < 8; ++i) {
    const double q[3] = {p[0] - 1.6 * hash(i, 1, 0) + 0.8, p[1] - 1.6 * hash(i, 2, 0) + 0.8,
                         p[2] - 1.6 * hash(i, 3, 0) + 0.8};
    sum += pow(radius(q) + 0.02, -4);
  }
  return 1e-24 * sum;
}

typedef enum Shape { CUBE, SLAB, SHEET, ROD, TINY } Shape;

static const struct Sample {
  const char *name;
  double (*value)(const double p[3]);
  Shape shape;
  bool of_cells;
} samples[] = {{"concentrated", concentrated, CUBE, false},
               {"decades", decades, CUBE, false},
               {"signs", with_signs, CUBE, false},
               {"constant", constant, CUBE, false},
               {"two_values", two_values, CUBE, true},
               {"thin_shell", thin_shell, CUBE, false},
               {"holes", holes, CUBE, false},
               {"boundary_layer", boundary_layer, CUBE, false},
               {"linear", linear, CUBE, false},
               {"waves", waves, CUBE, false},
               {"outlier", outlier, CUBE, false},
               {"noise", noise, CUBE, false},
               {"front", front, CUBE, false},
               {"sparse", sparse, CUBE, false},
               {"offset", offset, CUBE, false},
               {"negative", negative, CUBE, false},
               {"one_sided", one_sided, CUBE, false},
               {"tails", tails, CUBE, false},
               {"density", density, CUBE, false},
               {"slab", with_signs, SLAB, false},
               {"sheet", waves, SHEET, false},
               {"rod", density, ROD, false},
               {"tiny", front, TINY, false},
               {"cells", waves, CUBE, true}};

enum { SAMPLES = sizeof samples / sizeof *samples, N = 20 };

/* The unit cube around 0 in 6 N³ tetrahedra, as a legacy file of VTK. */
static bool write_sample(const char *folder, const struct Sample *sample) {
  static const double extents[][3] = {{1, 1, 1}, {1, 0.8, 0.15}, {1, 1, 0.005}, {4, 0.2, 0.2}, {1e-9, 1e-9, 1e-9}};
  static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.vtk", folder, sample->name);
  FILE *file = fopen(path, "w");
  if (!file)
    return false;
  const double *extent = extents[sample->shape];
  fprintf(file, "# vtk DataFile Version 3.0\n%s\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n", sample->name,
          (N + 1) * (N + 1) * (N + 1));
  for (int i = 0; i < (N + 1) * (N + 1) * (N + 1); ++i) {
    const int at[3] = {i % (N + 1), i / (N + 1) % (N + 1), i / (N + 1) / (N + 1)};
    for (int k = 0; k < 3; ++k)
      fprintf(file, "%.9g ", extent[k] * (2.0 * at[k] / N - 1));
    fputc('\n', file);
  }
  const int cells = 6 * N * N * N;
  fprintf(file, "CELLS %d %d\n", cells, 5 * cells);
  for (int c = 0; c < cells; ++c) {
    const int corner[3] = {c / 6 % N, c / 6 / N % N, c / 6 / N / N}, step[3] = {1, N + 1, (N + 1) * (N + 1)};
    const int first = corner[0] + step[1] * corner[1] + step[2] * corner[2], *order = orders[c % 6];
    const int vertex[4] = {first, first + step[order[0]], first + step[order[0]] + step[order[1]],
                           first + step[0] + step[1] + step[2]};
    fprintf(file, "4 %d %d %d %d\n", vertex[0], vertex[1], vertex[2], vertex[3]);
  }
  fprintf(file, "CELL_TYPES %d\n", cells);
  for (int c = 0; c < cells; ++c)
    fputs("10\n", file);
  const int count = sample->of_cells ? cells : (N + 1) * (N + 1) * (N + 1);
  fprintf(file, "%s_DATA %d\nSCALARS %s double 1\nLOOKUP_TABLE default\n", sample->of_cells ? "CELL" : "POINT", count,
          sample->name);
  for (int i = 0; i < count; ++i) {
    const int n = sample->of_cells ? N : N + 1, j = sample->of_cells ? i / 6 : i;
    const double half = sample->of_cells ? 0.5 : 0;
    const double p[3] = {2 * (j % n + half) / N - 1, 2 * (j / n % n + half) / N - 1, 2 * (j / n / n + half) / N - 1};
    const double value = sample->value(p);
    if (isnan(value))
      fputs("nan\n", file);
    else
      fprintf(file, "%.9g\n", value);
  }
  return fclose(file) == 0;
}

/* ── what a picture shows ── */

enum { W = 160, H = 120, BANDS = 20 };

typedef struct Look {
  TetcastContext *context;
  TetcastVolume *volume;
  TetcastScene *scene;
  TetcastCamera camera;
  double *color, *extinction; /* knots of the scene file */
  int64_t colors, extinctions;
} Look;

static void must(bool fine, const char *what) {
  if (!fine) {
    fprintf(stderr, "looks: %s\n", what);
    exit(2);
  }
}

static double *knots_of(const json_t *list, int width, int64_t *count) {
  *count = (int64_t)json_array_size(list);
  double *knots = malloc(sizeof *knots * (size_t)(*count * width + 1));
  for (int64_t i = 0; i < *count; ++i)
    for (int k = 0; k < width; ++k)
      knots[i * width + k] = json_number_value(json_array_get(json_array_get(list, (size_t)i), (size_t)k));
  return knots;
}

static void read_vector(const json_t *list, double v[3]) {
  for (size_t k = 0; k < 3; ++k)
    v[k] = json_number_value(json_array_get(list, k));
}

/* Renders with these colours; the frame is the caller's. */
static TetcastFrame *shoot(const Look *look, const double *color, int64_t count) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = count;
  desc.extinction = look->extinction;
  desc.extinction_count = look->extinctions;
  TetcastTransferFunction *transfer = NULL;
  must(tetcast_transfer_function_create(look->context, &desc, &transfer) == TETCAST_OK, "transfer function");
  must(tetcast_scene_set_transfer_function(look->scene, transfer) == TETCAST_OK, "scene");
  tetcast_transfer_function_destroy(&transfer);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.type = TETCAST_TYPE_FLOAT32;
  frame_desc.channels = TETCAST_CHANNEL_CELLS;
  TetcastFrame *frame = NULL;
  must(tetcast_frame_create(look->context, &frame_desc, &frame) == TETCAST_OK, "frame");
  must(tetcast_scene_render(look->scene, &look->camera, NULL, frame, NULL) == TETCAST_OK, "render");
  return frame;
}

/* The largest red, green and blue in a picture whose matter has colour 1 from low to high, of each alone. */
static void find_seen(const Look *look, double band[3][2], double seen[3]) {
  double color[3][12][4]; /* each component has four steps: they are merged by value */
  double edges[6];
  int count = 0;
  for (int b = 0; b < 3; ++b)
    edges[2 * b] = band[b][0], edges[2 * b + 1] = band[b][1];
  for (int i = 0; i < 6; ++i) /* ascending */
    for (int j = i + 1; j < 6; ++j)
      if (edges[j] < edges[i]) {
        const double swap = edges[i];
        edges[i] = edges[j];
        edges[j] = swap;
      }
  double(*knot)[4] = color[0];
  for (int i = 0; i < 6; ++i) {
    if (i > 0 && edges[i] == edges[i - 1])
      continue;
    for (int side = 0; side < 2; ++side) {
      knot[count][0] = edges[i];
      for (int b = 0; b < 3; ++b)
        knot[count][b + 1] =
            side ? edges[i] >= band[b][0] && edges[i] < band[b][1] : edges[i] > band[b][0] && edges[i] <= band[b][1];
      ++count;
    }
  }
  TetcastFrame *frame = shoot(look, knot[0], count);
  const float *pixels = tetcast_frame_pixels(frame);
  for (int b = 0; b < 3; ++b) {
    seen[b] = 0;
    for (int i = 0; i < W * H; ++i)
      seen[b] = fmax(seen[b], (double)pixels[4 * i + b]);
  }
  tetcast_frame_destroy(&frame);
}

/* The value at a place on the colour map: its knots are equally far from each other there. */
static double value_at(const Look *look, double place) {
  const double at = place * (double)(look->colors - 1);
  const int64_t i = (int64_t)fmin(floor(at), (double)look->colors - 2);
  return look->color[4 * i] + (at - (double)i) * (look->color[4 * i + 4] - look->color[4 * i]);
}

/* How many values a field has, up to 9. */
static int count_values(const TetcastField *field) {
  double found[9];
  int count = 0;
  const int64_t values = tetcast_field_values(field).count;
  for (int64_t i = 0; i < values && count < 9; ++i) {
    int k = 0;
    while (k < count && found[k] != tetcast_field_value(field, i))
      ++k;
    if (k == count)
      found[count++] = tetcast_field_value(field, i);
  }
  return count;
}

static int judge(const Look *look, const char *name, const TetcastMesh *mesh, const TetcastField *field) {
  TetcastFrame *frame = shoot(look, look->color, look->colors);
  const float *pixels = tetcast_frame_pixels(frame), *cells = tetcast_frame_channel(frame, TETCAST_CHANNEL_CELLS);
  int covered = 0, opaque = 0, bands = 0;
  double mean = 0;
  for (int i = 0; i < W * H; ++i)
    if (cells[i] > 0) {
      ++covered;
      opaque += pixels[4 * i + 3] > 0.99f;
      mean += (double)pixels[4 * i + 3];
    }
  mean /= covered > 0 ? covered : 1;
  tetcast_frame_destroy(&frame);
  static const double shares[2] = {0.02, 0.98}, least = 1.5 / 255;
  double ends[2], range[2], seen[3];
  tetcast_field_range(field, range, NULL);
  must(tetcast_statistics_quantiles(look->context, mesh, field, shares, 2, ends) == TETCAST_OK, "quantiles");
  const bool varied = look->colors > 1 && range[0] < range[1] && count_values(field) > 8;
  for (int k = 0; varied && k < BANDS; k += 3) {
    double band[3][2];
    for (int b = 0; b < 3; ++b) {
      band[b][0] = value_at(look, fmin(1, (double)(k + b) / BANDS));
      band[b][1] = value_at(look, fmin(1, (k + b + 1.0) / BANDS));
    }
    find_seen(look, band, seen);
    for (int b = 0; b < 3 && k + b < BANDS; ++b)
      bands += seen[b] >= least;
  }
  double low = 1, high = 1;
  if (range[0] < range[1]) {
    const double width = range[1] - range[0], far = fabs(range[0]) + fabs(range[1]);
    double band[3][2] = {{range[0] - width - far, fmax(ends[0], nextafter(range[0], range[1]))},
                         {fmin(ends[1], nextafter(range[1], range[0])), range[1] + width + far},
                         {range[0], range[0]}};
    find_seen(look, band, seen);
    low = seen[0];
    high = seen[1];
  }
  const bool fine = covered > W * H / 50 && opaque <= 0.1 * covered && mean >= 0.25 && mean <= 0.7 &&
                    (!varied || bands >= 0.6 * BANDS) && low >= least && high >= least;
  printf("| %s | %.0f %% | %.2f | %.1f %% | ", name, 100.0 * covered / (W * H), mean,
         covered ? 100.0 * opaque / covered : 0);
  if (varied)
    printf("%.0f %% | ", 100.0 * bands / BANDS);
  else
    printf("– | ");
  printf("%.3f | %.3f |%s\n", low, high, fine ? "" : " **no**");
  return fine ? 0 : 1;
}

static int measure(const char *path, const char *scene_path) {
  Look look = {0};
  TetcastDataset *dataset = NULL;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  json_t *scene = json_load_file(scene_path, 0, NULL);
  must(scene != NULL, "no scene");
  const json_t *transfer = json_object_get(scene, "transfer"), *camera = json_object_get(scene, "camera");
  look.color = knots_of(json_object_get(transfer, "color"), 4, &look.colors);
  look.extinction = knots_of(json_object_get(transfer, "extinction"), 2, &look.extinctions);
  look.camera.fovy = json_number_value(json_object_get(camera, "fovy"));
  read_vector(json_object_get(camera, "eye"), look.camera.eye);
  read_vector(json_object_get(camera, "target"), look.camera.target);
  read_vector(json_object_get(camera, "up"), look.camera.up);
  const char *array = json_string_value(json_object_get(scene, "array"));
  must(tetcast_context_create(NULL, &look.context) == TETCAST_OK, "context");
  TetcastDatasetDesc desc = tetcast_dataset_desc_default();
  must(tetcast_dataset_read(look.context, path, &desc, &dataset) == TETCAST_OK, "dataset");
  must(tetcast_dataset_field(dataset, array, &field, NULL) == TETCAST_OK, "field");
  must(tetcast_dataset_mesh(dataset, &mesh) == TETCAST_OK, "mesh");
  must(tetcast_volume_create(look.context, mesh, NULL, &look.volume) == TETCAST_OK, "volume");
  must(tetcast_scene_create(look.context, look.volume, &look.scene) == TETCAST_OK, "scene");
  must(tetcast_scene_set_field(look.scene, field) == TETCAST_OK, "scene's field");
  const char *name = strrchr(path, '/');
  char title[512];
  snprintf(title, sizeof title, "%s, %s", name ? name + 1 : path, array);
  const int result = judge(&look, title, mesh, field);
  tetcast_scene_destroy(&look.scene);
  tetcast_volume_destroy(&look.volume);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  tetcast_context_destroy(&look.context);
  json_decref(scene);
  free(look.color);
  free(look.extinction);
  return result;
}

int main(int argc, char **argv) {
  if (argc == 3 && !strcmp(argv[1], "make")) {
    for (int i = 0; i < SAMPLES; ++i)
      must(write_sample(argv[2], &samples[i]), "a file can't be written");
    return 0;
  }
  if (argc == 4 && !strcmp(argv[1], "measure"))
    return measure(argv[2], argv[3]);
  fputs("usage: looks make FOLDER | looks measure FILE SCENE\n", stderr);
  return 2;
}
