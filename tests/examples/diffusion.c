/* SPDX-License-Identifier: Apache-2.0 */
/* Rendering in situ: heat spreads through a cube, and each time step is rendered in the same process, from the
 * simulation's own arrays. The mesh is handed to tetcast once; a step only replaces the field's values.
 * At the end a strip of snapshots is written: diffusion.png with OpenImageIO, else diffusion.ppm.
 *     cc diffusion.c kuhn.c $(pkg-config --cflags --libs tetcast) -lm -o diffusion
 * or, for PNG, with -DWITH_OPENIMAGEIO and the package tetcast-openimageio. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include <tetcast/tetcast.h>
#ifdef WITH_OPENIMAGEIO
#include <tetcast/image.h>
#else
#include "ppm.h"
#endif

#include "kuhn.h"

enum { N = 16, STEPS = 120, PANELS = 6, SIZE = 128 }; /* small cubes per side, time steps, snapshots, their pixels */

static const double pi = 3.14159265358979323846;
static const double extinction_per_heat = 1.5;
static const double view_height = 1.8; /* more than the cube's diagonal: all of it is in the picture */

/* All that rendering needs; the simulation's arrays are borrowed. */
typedef struct View {
  TetcastContext *context;
  TetcastField *field;
  TetcastVolume *volume;
  TetcastScene *scene;
  TetcastFrame *strip;         /* the whole picture */
  TetcastFrame *panel[PANELS]; /* frames that lie in it side by side */
  double *pixels;              /* [SIZE][PANELS * SIZE][4] */
} View;

static void print_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  (void)severity;
  fprintf(stderr, "diffusion: %s\n", text);
}

static bool make_frames(View *view) {
  view->pixels = calloc((size_t)SIZE * SIZE * PANELS * 4, sizeof *view->pixels);
  if (!view->pixels) {
    return false;
  }
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = SIZE * PANELS;
  desc.height = SIZE;
  desc.pixels = view->pixels;
  if (tetcast_frame_create(view->context, &desc, &view->strip) != TETCAST_OK) {
    return false;
  }
  desc.width = SIZE;
  desc.row_stride = tetcast_frame_row_stride(view->strip);
  for (int i = 0; i < PANELS; i++) {
    desc.pixels = view->pixels + (size_t)i * SIZE * 4;
    if (tetcast_frame_create(view->context, &desc, &view->panel[i]) != TETCAST_OK) {
      return false;
    }
  }
  return true;
}

/* Colour and extinction over the heat u; extinction is proportional to u, so a ray's optical depth measures the heat
 * along it. */
static bool set_transfer_function(View *view) {
  static const double color[][4] = {
      {0.0, 0.05, 0.05, 0.30}, {0.2, 0.45, 0.05, 0.45}, {0.6, 0.90, 0.30, 0.15}, {2.0, 1.00, 0.85, 0.30}};
  const double extinction[][2] = {{0, 0}, {10, 10 * extinction_per_heat}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = &color[0][0];
  desc.color_count = 4;
  desc.extinction = &extinction[0][0];
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer_function = NULL;
  bool ok = tetcast_transfer_function_create(view->context, &desc, &transfer_function) == TETCAST_OK &&
            tetcast_scene_set_transfer_function(view->scene, transfer_function) == TETCAST_OK;
  tetcast_transfer_function_destroy(&transfer_function); /* the scene keeps what it needs */
  return ok;
}

static bool view_make(View *view, const Kuhn *kuhn, const double *u) {
  TetcastContextDesc context_desc = tetcast_context_desc_default();
  context_desc.message = print_message;

  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices =
      (TetcastArray){.data = kuhn->vertices, .type = TETCAST_TYPE_FLOAT64, .count = kuhn->vertex_count};
  mesh_desc.tetrahedra = (TetcastArray){.data = kuhn->cells, .type = TETCAST_TYPE_INT64, .count = kuhn->cell_count};
  mesh_desc.ownership = TETCAST_BORROW;

  /* Borrowed: tetcast_scene_set_field() reads u as it is then. */
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){.data = u, .type = TETCAST_TYPE_FLOAT64, .count = kuhn->vertex_count};
  field_desc.ownership = TETCAST_BORROW;

  TetcastMesh *mesh = NULL;
  bool ok = tetcast_context_create(&context_desc, &view->context) == TETCAST_OK &&
            tetcast_mesh_create(view->context, &mesh_desc, &mesh) == TETCAST_OK &&
            tetcast_volume_create(view->context, mesh, NULL, &view->volume) == TETCAST_OK &&
            tetcast_field_create(view->context, &field_desc, &view->field) == TETCAST_OK &&
            tetcast_scene_create(view->context, view->volume, &view->scene) == TETCAST_OK && //
            set_transfer_function(view) && make_frames(view);
  tetcast_mesh_destroy(&mesh); /* the volume keeps nothing of it */
  return ok;
}

static bool view_render(View *view, int panel) {
  TetcastCamera camera = {.eye = {2.6, -1.9, 1.9},
                          .target = {0.5, 0.5, 0.5},
                          .up = {0, 0, 1},
                          .projection = TETCAST_ORTHOGRAPHIC,
                          .height = view_height};
  return tetcast_scene_set_field(view->scene, view->field) == TETCAST_OK &&
         tetcast_scene_render(view->scene, &camera, NULL, view->panel[panel], NULL) == TETCAST_OK;
}

static bool view_write(View *view) {
#ifdef WITH_OPENIMAGEIO
  return tetcast_image_write(view->context, "diffusion.png", view->strip, NULL) == TETCAST_OK;
#else
  return ppm_write("diffusion.ppm", view->strip, 1) == 0;
#endif
}

static void view_free(View *view) {
  for (int i = 0; i < PANELS; i++) {
    tetcast_frame_destroy(&view->panel[i]);
  }
  tetcast_frame_destroy(&view->strip);
  tetcast_scene_destroy(&view->scene);
  tetcast_field_destroy(&view->field);
  tetcast_volume_destroy(&view->volume);
  tetcast_context_destroy(&view->context);
  free(view->pixels);
}

/* The heat in a panel as the picture shows it: alpha = 1 − exp(−optical depth), and the optical depth of a pixel is
 * extinction_per_heat × the heat along its ray. Summed over all pixels, that is all the heat in the cube. */
static double heat_in_picture(const View *view, int panel) {
  double sum = 0, pixel_area = (view_height / SIZE) * (view_height / SIZE);
  for (int j = 0; j < SIZE; j++) {
    const double *row = view->pixels + ((size_t)j * PANELS + (size_t)panel) * SIZE * 4;
    for (int i = 0; i < SIZE; i++) {
      sum -= log1p(-row[4 * i + 3]);
    }
  }
  return sum * pixel_area / extinction_per_heat;
}

/* ∫ u and ∫ u cos πx over the cube. The first is conserved; the second, the amplitude of the slowest way in which
 * heat evens out between two sides, decays like exp(−π² t). */
static void measure(const Kuhn *kuhn, const double *u, double *heat, double *amplitude) {
  *heat = *amplitude = 0;
  for (int64_t i = 0; i < kuhn->vertex_count; i++) {
    *heat += kuhn->mass[i] * u[i];
    *amplitude += kuhn->mass[i] * u[i] * cos(pi * kuhn->vertices[i][0]);
  }
}

static bool check(bool condition, const char *what) {
  if (!condition) {
    fprintf(stderr, "diffusion: %s\n", what);
  }
  return condition;
}

/* The loop this example is about: advance, render, and see that both tell the same story. */
static bool run(const Kuhn *kuhn, View *view, double *u) {
  double heat, heat_at_start, amplitude, amplitude_at_start, step = kuhn->largest_step;
  measure(kuhn, u, &heat_at_start, &amplitude_at_start);
  for (int k = 0; k <= STEPS; k++) {
    if (k > 0) {
      kuhn_step(kuhn, step, u);
    }
    int panel = k * (PANELS - 1) / STEPS;
    if (!view_render(view, panel)) {
      return false;
    }
    measure(kuhn, u, &heat, &amplitude);
    double seen = heat_in_picture(view, panel);
    if (k % (STEPS / 6) == 0) {
      printf("t = %.4f  heat %.12f  in the picture %.6f  amplitude %.6f\n", k * step, heat, seen, amplitude);
    }
    if (!check(fabs(heat - heat_at_start) < 1e-12 * heat_at_start, "heat is not conserved") ||
        !check(fabs(seen - heat) < 1e-3 * heat, "the picture shows another amount of heat than there is")) {
      return false;
    }
  }
  double rate = -log(amplitude / amplitude_at_start) / (STEPS * step);
  printf("the amplitude decayed at %.3f per unit of time; in theory %.3f\n", rate, pi * pi);
  return check(fabs(rate - pi * pi) < 0.01 * pi * pi, "the amplitude does not decay as it should");
}

int main(void) {
  Kuhn kuhn;
  View view = {0};
  double *u = NULL;
  bool ok = kuhn_make(&kuhn, N) == 0 && (u = calloc((size_t)kuhn.vertex_count, sizeof *u));
  if (ok) {
    for (int64_t i = 0; i < kuhn.vertex_count; i++) { /* a hot spot off the centre */
      const double *p = kuhn.vertices[i];
      double r2 = pow(p[0] - 0.3, 2) + pow(p[1] - 0.4, 2) + pow(p[2] - 0.6, 2);
      u[i] = 8 * exp(-r2 / (2 * 0.13 * 0.13));
    }
    ok = view_make(&view, &kuhn, u) && run(&kuhn, &view, u) && check(view_write(&view), "no picture was written");
  } else {
    fprintf(stderr, "diffusion: out of memory\n");
  }
  view_free(&view);
  kuhn_free(&kuhn);
  free(u);
  return ok ? 0 : 1;
}
